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
//! | [`refold()`] | | a folder of a result | its parts bent back and compared with the panels |
//! | [`read_map`] | | a folder of a result | points and curves between panels and patterns |
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
//! Lengths are millimetres, angles radians. Nothing is opened or printed. Vectors are those of [`nalgebra`].
//!
//! # What stands here
//!
//! What these functions take and return stands at the root too, in four groups; the modules have what is inside of it:
//!
//! - **Verbs**: [`read`] and its like make data of bytes, the jobs of the table make answers of data, [`files`] makes bytes of
//!   an answer.
//! - **What goes in**: a [`Model`], curves ([`Rail`]), points ([`Cloud`]), rulings and planes ([`Given`]), and the options of the
//!   jobs, whose fields are public. Every tolerance is given; everything else has a default.
//! - **What comes out**: an [`Answer`]. Its [`Patchwork`] holds the panels in space, its [`Part`]s and [`Pattern`]s what is cut.
//!   A [`Claim`] says one thing of the whole or of a panel and whether that is proven, and the [`Status`] follows from the
//!   claims alone; the [`Certificate`] is the proof in full. [`Note`]s, [`Skipped`] items and [`Reason`]s are data without
//!   sentences. An error says that a question was ill-posed; every job has its own.
//! - **Control**: [`Control`] carries [`Progress`] out of long work and the wish to stop into it.
//!
//! # Floors
//!
//! Data travels one way: read → model → fit or design → certify → develop → write. From the bottom:
//! [`num`], [`geom`], [`spline`]; the nouns [`brep`] (what CAD files hold), [`torse`] (exact developables) and
//! [`patchwork`] (a whole in pieces); [`constraint`] (equations over unknown points); the sibling verbs [`mod@fit`],
//! [`design`], [`certify`] and [`develop`], then [`tessellate`] and [`draw`]; [`search`], which lets the judge decide about what was proposed; [`answer`], [`io`] and
//! [`pipeline`]. A floor uses only lower ones; `tests/tidy.rs` keeps it so.

// Verbs.
pub use io::cad::{read, read_with};
pub use io::curves::read as read_curve;
pub use io::step::read::read as read_step;
pub use pipeline::approximate::approximate;
pub use pipeline::cones::of_faces as cones;
pub use pipeline::deliver::files;
pub use pipeline::elements::{fit_elements, fit_faces};
pub use pipeline::fit::fit;
pub use pipeline::hull::hull;
pub use pipeline::info::measure;
pub use pipeline::loft::loft;
pub use pipeline::map_artwork::read_map;
pub use pipeline::net::net;
pub use pipeline::planarise::planarise;
pub use pipeline::refold::refold;
pub use pipeline::ruled::of_faces as ruled;
pub use pipeline::shape::shape;
pub use pipeline::unroll::unroll;

// What goes in: data.
pub use brep::face::Face;
pub use geom::cloud::Cloud;
pub use io::curves::CurveOptions;
pub use io::model::{Model, ReadOptions};
pub use io::shape::ShapeFile;
pub use torse::contact::Given;
pub use torse::quad_strip::QuadStrip;
pub use torse::rail::Rail;

// What goes in: options of the jobs, and what they are made of.
pub use design::discrete::planarise::Hold as PlanariseHold;
pub use develop::bends::{BendSpacing, Facets};
pub use develop::shop::thickness::{Sheet, SheetSide};
pub use develop::unfold::allowance::KFactor;
pub use develop::unfold::tree::Joins;
pub use develop::view::Drawn;
pub use pipeline::approximate::Options as Approximate;
pub use pipeline::cones::ConesOptions;
pub use pipeline::elements::ElementFitOptions;
pub use pipeline::fit::FitOptions;
pub use pipeline::hull::Options as Hull;
pub use pipeline::loft::{Choice as LoftChoice, Ends as LoftEnds, Extension as LoftExtension, Options as Loft};
pub use pipeline::net::{Condition as NetCondition, Options as Net};
pub use pipeline::planarise::Options as Planarise;
pub use pipeline::ruled::{RuledOptions, Strips as RuledStrips};
pub use pipeline::shape::Options as Shape;
pub use pipeline::unroll::UnrollOptions;
pub use search::cover::{Layout, Limits};
pub use torse::zone::RegressionLimits;

// What comes out: answers, and what they hold.
pub use answer::note::Note;
pub use answer::shop::Shop;
pub use answer::skipped::Skipped;
pub use answer::{Answer, Cones as ExactCones, CutFiles, Guide, Job, PointMap, Stage};
pub use certify::claim::{Claim, Counted, Demand, Evidence, LowerBound, Status, Subject, Unit, UpperBound, What};
pub use certify::flat::FlatCertificate;
pub use certify::written::WrittenCertificate;
pub use certify::{Certificate, SeamStatus};
pub use develop::unfold::joints::PartJoint;
pub use develop::unfold::part::SheetPart;
pub use develop::unfold::placed_face::{PlacedChart, PlacedFace};
pub use draw::field::{FieldMeaning, PanelField};
pub use io::bundle::File;
pub use patchwork::panel::{Panel, Patchwork};
pub use patchwork::part::Part;
pub use patchwork::pattern::Pattern;
pub use pipeline::info::FaceInfo;
pub use pipeline::map_artwork::ArtworkMap;
pub use pipeline::refold::RefoldAnswer;
pub use pipeline::ruled::RuledAnswer;
pub use reason::Reason;
pub use search::build::AlongCurve;
pub use torse::form::PanelKind;
pub use torse::strip::Strip;

// What comes out: errors of the verbs.
pub use design::hull::HullError;
pub use design::loft::LoftError;
pub use fit::cloud::CloudError;
pub use io::bundle::BundleError;
pub use io::cad::ReadError;
pub use io::curves::CurveError;
pub use io::result_folder::FolderError;
pub use io::step::read::ReadError as ReadStepError;
pub use pipeline::approximate::ApproximateError;
pub use pipeline::cones::ConesJobError;
pub use pipeline::elements::ElementFitError;
pub use pipeline::map_artwork::MapError;
pub use pipeline::net::NetJobError;
pub use pipeline::planarise::PlanariseError;
pub use pipeline::ruled::RuledError;
pub use pipeline::shape::ShapeError;
pub use pipeline::unroll::UnrollError;

// Control.
pub use control::{Control, Progress};

pub use nalgebra;

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
