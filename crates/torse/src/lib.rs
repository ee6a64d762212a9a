//! Torse: developable surfaces, with certified bounds.
//!
//! Every job takes what a reader gives and its options, and returns an [`Answer`]: panels, what is proven of them, flat
//! patterns. [`files`] makes files of it and judges these too.
//!
//! | job | options | from | to |
//! |---|---|---|---|
//! | [`approximate()`] | [`Approximate`] | faces of a CAD model | trimmed panels |
//! | [`cones()`] | [`ConesOptions`] | developable faces | exact cones, cylinders and planes |
//! | [`fit()`] | [`FitOptions`] | measured points | strips |
//! | [`fit_elements`], [`fit_faces`] | [`ElementFitOptions`] | rulings, tangent planes, faces | strips |
//! | [`loft()`] | [`Loft`] | two curves | strips |
//! | [`hull()`] | [`Hull`] | curves | strips on their convex hull |
//! | [`net()`] | [`Net`] | one curve and rulings | strips |
//! | [`shape()`] | [`Shape`] | curves with handles | strips |
//! | [`planarise()`] | [`Planarise`] | a strip of quadrilaterals | plane ones |
//! | [`ruled()`] | [`RuledOptions`] | faces of a CAD model | ruled strips, not developable |
//! | [`unroll()`] | [`UnrollOptions`] | bodies of sheet, developable faces | flat patterns |
//! | [`refold()`](pipeline::refold::refold) | | a folder of a result | its parts bent back and compared with the panels |
//! | [`read_map`](pipeline::map_artwork::read_map) | | a folder of a result | points and curves between panels and patterns |
//!
//! ```no_run
//! let model = torse::read(&std::fs::read("hull.step")?)?;
//! let mut answer = torse::approximate(&model, &torse::Approximate::new(2.0))?;
//! for (name, bytes) in torse::files(&mut answer, "2026-01-31T12:00:00")? {
//!     std::fs::write(name, bytes)?;
//! }
//! println!("{:?}: {} panels", answer.status(), answer.patchwork().panels.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lengths are millimetres, angles radians. Nothing is opened or printed; progress and cancellation go through
//! [`Control`]. Vectors are those of [`nalgebra`].
//!
//! # Floors
//!
//! Data travels one way: read → model → fit or design → certify → develop → write. From the bottom:
//! [`num`], [`geom`], [`spline`]; the nouns [`brep`] (what CAD files hold), [`torse`] (exact developables) and
//! [`patchwork`] (a whole in pieces); [`constraint`] (equations over unknown points); the sibling verbs [`mod@fit`],
//! [`design`], [`certify`] and [`develop`], then [`tessellate`] and [`draw`]; [`search`], which lets the judge decide about what was proposed; [`answer`], [`io`] and
//! [`pipeline`]. A floor uses only lower ones; `tests/tidy.rs` keeps it so.

pub use answer::Answer;
pub use certify::claim::Status;
pub use control::Control;
pub use io::cad::read;
pub use io::curves::read as read_curve;
pub use io::model::Model;
pub use io::step::read::read as read_step;
pub use nalgebra;
pub use pipeline::approximate::{approximate, Options as Approximate};
pub use pipeline::cones::{of_faces as cones, ConesOptions};
pub use pipeline::deliver::files;
pub use pipeline::elements::{fit_elements, fit_faces, ElementFitOptions};
pub use pipeline::fit::{fit, FitOptions};
pub use pipeline::hull::{hull, Options as Hull};
pub use pipeline::info::measure;
pub use pipeline::loft::{loft, Options as Loft};
pub use pipeline::net::{net, Options as Net};
pub use pipeline::planarise::{planarise, Options as Planarise};
pub use pipeline::ruled::{of_faces as ruled, RuledOptions};
pub use pipeline::shape::{shape, Options as Shape};
pub use pipeline::unroll::{unroll, UnrollOptions};

pub mod control;
pub mod num;

pub mod geom;

pub mod reason;
pub mod spline;

pub mod brep;
pub mod torse;

pub mod patchwork;

pub mod constraint;

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
