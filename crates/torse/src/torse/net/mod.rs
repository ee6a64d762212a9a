//! B-spline developable nets \[FJ07\]: the control net with its recursion ([`Net`]), its regularity and shape numbers, other
//! forms of the same surface, and nets recognised in patches.

mod change;
mod control_net;
mod first_cell;
mod forms;
mod planes;
mod recognise;
mod regular;
mod shape;
mod taper;

pub(crate) use control_net::NetError;
pub use control_net::{from_paper_knots, homogeneous, paper_knots, Net, NetKind};
pub use first_cell::{aumann, from_first_cell};
pub use forms::{to_dual, to_primal, Converted};
pub use recognise::recognise;
pub(crate) use regular::Regularity;
pub use shape::Shape;
pub(crate) use taper::TaperedNet;

#[cfg(test)]
mod tests;
