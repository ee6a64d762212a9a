//! Torse: developable surfaces, with certified bounds.
//!
//! Data travels one way: read → model → fit or design → certify → develop → write. The floors, from the bottom:
//! [`num`], [`geom`], [`spline`]; the nouns [`brep`] (what CAD files hold), [`torse`] (exact developables) and
//! [`patchwork`] (a whole in pieces); the sibling verbs [`fit`], [`design`], [`certify`] and [`develop`], then
//! [`tessellate`] and [`draw`]; [`search`], which lets the judge decide about what was proposed; [`answer`], [`io`] and
//! [`pipeline`]. A floor uses only lower ones; `tests/tidy.rs` keeps it so.

pub mod control;
pub mod num;

pub mod geom;

pub mod spline;

pub mod brep;
pub mod torse;

pub mod patchwork;

pub mod certify;
pub mod design;
pub mod develop;
pub mod fit;

pub mod draw;
pub mod tessellate;

pub mod search;

pub mod answer;

pub mod io;

pub mod pipeline;
