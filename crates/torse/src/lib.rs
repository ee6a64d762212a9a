//! Torse: developable surfaces, with certified bounds.
//!
//! Data travels one way: read → model → fit → certify → develop → write. The floors, from the bottom:
//! [`num`], [`geom`], [`spline`], [`surface`], then the sibling verbs [`fit`], [`design`], [`certify`],
//! [`develop`] and [`tessellate`], then [`pipeline`] and [`io`]. A floor uses only lower ones; `tests/tidy.rs` keeps it
//! so.

pub mod control;
pub mod num;

pub mod geom;

pub mod spline;

pub mod surface;

pub mod certify;
pub mod design;
pub mod develop;
pub mod fit;
pub mod tessellate;

pub mod io;
pub mod pipeline;
