//! Strips that meet: the seam curves come first, every strip is the developable surface that connects its two seams.
//!
//! *Method.* Independent strips along the level lines of a function (\[SE06\] carried on) leave gaps between
//! neighbours. Here every level line `x(s)` gets an offset `a(s)` along the surface's normal; the seam
//! `y = x + a N` is one smooth curve ([`Seam`]). The developable that connects two neighbouring seams has the rulings
//! with a common tangent plane at both ends ([`connecting()`]); it contains both seams, so that neighbours meet whatever
//! the offsets are. Offsets start from theory (a best-fitting strip of width ω is off by `κ ω²/16` at its edges) and
//! are then chosen for all strips together so that the largest distance is smallest ([`network()`]).
//!
//! Where two strips cross, the intersection is a common edge without any change of theirs ([`Height`]).
//!
//! Seams across the rulings are creases: two developables that are tangent along a curve across their rulings are the
//! same surface. The angle is about `4 √(ε κ)`.
//!
//! Not guaranteed here: any distance (see `certify`); that a connecting developable exists. The dual splines that
//! come out contain the seams up to their fit, see [`Laid::seam_distance`](network::Laid::seam_distance).

pub(crate) mod base_line;
pub(crate) mod connecting;
pub(crate) mod consensus;
mod feet;
mod form;
pub(crate) mod height;
pub(crate) mod network;
pub(crate) mod seam;

pub(crate) use base_line::{base_line, BaseLine, BasePoint};
pub use consensus::Line;
pub(crate) use consensus::{consensus, AgreedLine, Agreeing, ConsensusOptions, LinePoint};
pub use height::Height;
pub(crate) use network::{network, Laid, NetworkOptions, StripBetween};
pub use seam::Seam;
