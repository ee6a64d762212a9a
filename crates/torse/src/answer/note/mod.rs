//! What people should know of the input and of a job, as data: numbers and names, no prose. [`crate::io::words::note()`]
//! makes the sentences.

mod fit;
mod loft;
mod net;
pub mod reader;
mod shop;
mod unroll;

use crate::brep::trim::crease::Uncreased;
use crate::certify::claim::UpperBound;
pub use crate::design::composite::Report as SolveReport;
pub(crate) use crate::design::discrete::subdivide::LevelReport;
pub use crate::patchwork::skins::Skin;
use crate::reason::Item;
pub(crate) use crate::search::strips::cut::Crowded;
pub use crate::search::strips::cut::Lines;
pub(crate) use crate::search::strips::regression::Broken;
use crate::torse::zone::RegressionLimits;
pub(crate) use fit::Outlines;
pub use fit::{Became, Between, FaceNote, FitNote, SplineSize};
pub(crate) use loft::{EndNote, ExactPiece, Leads, LoftNote};
pub use net::{NetNote, Quality, Route};
pub use reader::ReaderNote;
pub(crate) use shop::{LeastRadius, OffsetSide, ShopNote, TooTight};
pub use shop::{Material, Sheet};
pub(crate) use unroll::{OffFaces, UnrollNote};

/// Something that people should know of the input or of the job.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// What a reader says of its file.
    Input(ReaderNote),
    /// Faces were chosen from a file.
    Chosen {
        /// Faces taken.
        count: usize,
        /// Faces of the file.
        all: usize,
    },
    /// A sheet drawn as a body is covered on both sides, although one skin could be asked for.
    BothSkins {
        /// The body.
        body: BodyName,
        /// Thickness, mm, estimated.
        thickness: f64,
        /// Faces of the outer skin, of the inner one, and of the sides.
        faces: [usize; 3],
    },
    /// One skin of a sheet drawn as a body was taken.
    OneSkin {
        /// The body.
        body: BodyName,
        /// Thickness, mm, estimated.
        thickness: f64,
        /// Which skin.
        skin: Skin,
        /// Faces of the skin.
        kept: usize,
        /// Faces of the body.
        all: usize,
    },
    /// Faces of the file with sharp edges of their own are taken as one face on each side of these.
    Creased {
        /// Their numbers in the file.
        faces: Vec<u64>,
        /// As how many faces they count.
        pieces: usize,
    },
    /// Panels of different faces, or both ends of one that closes, do not meet along a joint: the one with the largest gap.
    Apart {
        /// Its name, as on the marks.
        joint: String,
        /// Names of the patterns on both sides.
        between: [String; 2],
        /// Largest distance (mm) of marks that belong together.
        gap_estimate: f64,
    },
    /// No panel along a curve could be certified.
    NoPanelAlong {
        /// Name of the curve.
        curve: String,
    },
    /// Strips run in the direction of a curve, fewer than those laid along it and on from there would be.
    DirectionOf {
        /// Name of the curve.
        curve: String,
    },
    /// The file of cones holds exact surfaces.
    ExactFaces,
    /// Strips are ruled, not developable.
    NotDevelopable,
    /// Several strips are fitted one by one.
    Unjoined,
    /// What was asked of regression curves.
    Limits(RegressionLimits),
    /// A regression curve that does not keep to what was asked.
    Broken(Broken),
    /// Lines were asked for nearer to each other than they are drawn.
    Crowded(Crowded),
    /// A closed part is cut open along its first ruling.
    CutOpen {
        /// Name of the part; `None` where there is only one.
        part: Option<String>,
    },
    /// Of lofts.
    Loft(LoftNote),
    /// A curve, or a part of it, lies in a plane on which the hull rests, and that planar piece is left open.
    Lid {
        /// Name of the curve.
        curve: String,
        /// Whether all of the curve does.
        whole: bool,
    },
    /// A curve that lies inside the hull of the others.
    Inside {
        /// Name of the curve.
        curve: String,
    },
    /// Tips of hulls are cut off where rulings become too short.
    Tips {
        /// How many.
        count: usize,
        /// How far the curves beyond the last rulings are proven to lie from these at most, mm.
        within: f64,
    },
    /// Of nets.
    Net(NetNote),
    /// How a solve of a composite ended.
    Solved {
        /// The move and its step, both counted from their job's beginning; `None` for the first shape.
        step: Option<(usize, usize)>,
        /// How it ended.
        report: SolveReport,
    },
    /// How exactly conditions of a composite are met.
    Met {
        /// Largest residual as a share of the size.
        residual: f64,
    },
    /// A handle that pulls is not where it pulls to.
    GaveWay {
        /// Which.
        handle: Item,
        /// How far it is off, mm.
        off: f64,
    },
    /// Strips of a composite were taken from strips without a certificate.
    TakenUncertified {
        /// Their names.
        names: Vec<String>,
    },
    /// Some strips of a composite are ruled and have no flat patterns.
    RuledStrips {
        /// How many.
        count: usize,
    },
    /// Two pieces of a composite that meet.
    Joint {
        /// Its number, from 0.
        index: usize,
        /// Names of the pieces.
        between: [String; 2],
        /// Distance of both sides, mm.
        gap: UpperBound,
        /// Angle between the tangent planes along it, rad.
        angle: UpperBound,
        /// Whether they should go on smoothly.
        smooth: bool,
    },
    /// How near strips are to a target.
    Target {
        /// Its index.
        index: usize,
        /// Distance of the strips from it, mm.
        there: UpperBound,
        /// Distance of all of it from the strips, mm.
        back: UpperBound,
        /// Whether it consists of points, so that only the second is known.
        points: bool,
    },
    /// What one level of subdivision and planarisation did.
    Level {
        /// The level, from 0.
        level: usize,
        /// What it did.
        report: LevelReport,
    },
    /// Of flat parts.
    Unroll(UnrollNote),
    /// Of sheet and work.
    Shop(ShopNote),
    /// Of strips fitted to points, rulings, planes and faces.
    Fit(FitNote),
}

impl Note {
    /// What faces that were cut count as; `None` where none was.
    pub(crate) fn creased(found: &Uncreased) -> Option<Self> {
        (!found.cut.is_empty()).then(|| Self::Creased { faces: found.cut.clone(), pieces: found.pieces })
    }
}

/// What a body is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyName {
    /// Name of its part; empty if it has none.
    pub part: String,
    /// Entity number of one of its faces.
    pub entity: u64,
}
