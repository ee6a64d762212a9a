//! Why the main job cannot be done at all.

use crate::geom::coarse::Loose;
use crate::search::cover::CurveError;

/// Panels of one face; more take hours.
pub(super) const MOST_PANELS: f64 = 1000.0;

/// Why the job cannot be done at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ApproximateError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// Nothing to approximate.
    #[error("there is no face to approximate; {0}")]
    NoFaces(String),
    /// Tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// Tolerance too small to be proven in double precision.
    #[error(
        "a tolerance of {tolerance:.3e} mm is below what double precision can certify on a model of {size:.1} mm; \
         ask for at least {least:.1e} mm"
    )]
    Precision {
        /// Asked for, mm.
        tolerance: f64,
        /// Diagonal of the model, mm.
        size: f64,
        /// Smallest tolerance, mm.
        least: f64,
    },
    /// A limit of sheet or material that is not a positive length.
    #[error("the {name} must be a positive length, not {value} mm")]
    Limit {
        /// Which one.
        name: &'static str,
        /// Asked for, mm.
        value: f64,
    },
    /// A limit that asks for more panels than can be laid.
    #[error(
        "the {name} asks for about {count:.0} panels on face #{entity}, more than the {MOST_PANELS:.0} that can be laid; \
         allow more there, or a larger tolerance"
    )]
    TooMany {
        /// Which limit.
        name: &'static str,
        /// About how many panels that would be.
        count: f64,
        /// The face in the file.
        entity: u64,
    },
    /// A least width above the greatest.
    #[error("the least width, {least} mm, is above the greatest, {greatest} mm")]
    Widths {
        /// Least, mm.
        least: f64,
        /// Greatest, mm.
        greatest: f64,
    },
    /// A least width that no pattern can have that is short enough.
    #[error(
        "the least width, {least} mm, is no less than the greatest length, {longest} mm: no pattern is wider than it is long"
    )]
    WiderThanLong {
        /// Least width, mm.
        least: f64,
        /// Greatest length, mm.
        longest: f64,
    },
    /// A least width that no face has.
    #[error(
        "the least width, {least} mm, is more than any face allows: the largest is a panel of {widest:.0} mm at most"
    )]
    TooNarrow {
        /// Least width, mm.
        least: f64,
        /// Greatest mean width of a panel on the largest face, mm.
        widest: f64,
    },
    /// Angle of smooth edges that is none.
    #[error("the angle of smooth edges must lie between 0 and 90 degrees, not at {0}")]
    SmoothAngle(f64),
    /// A plane for a seam that no face meets, or that is none.
    #[error(
        "no seam can run in plane {index}, {at:.6} mm from the origin: the model lies between {lo:.6} mm and {hi:.6} mm \
         in its direction"
    )]
    SeamPlane {
        /// Number of the plane among those given, from 1.
        index: usize,
        /// Its distance from the origin, mm.
        at: f64,
        /// Where the model begins along the plane's normal, mm.
        lo: f64,
        /// Where it ends, mm.
        hi: f64,
    },
    /// A direction or guide curve of no length.
    #[error("the direction that strips are to follow has no length, or is not finite")]
    Guide,
    /// A curve that no panel can be laid along, on any face.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// Limit of panels that cannot be kept.
    #[error("the greatest number of panels must be at least 1")]
    MaxPanels,
}
