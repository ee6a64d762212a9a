//! What the reader of curves is told besides the bytes, and why there may be no rail in a file.

use crate::io::iges::read as iges;
use crate::io::step::read::ReadError;
use crate::io::threedm;
use crate::spline::curve::Curve;
use crate::torse::rail::RailError;

/// What the reader is told besides the bytes.
#[derive(Clone, Debug, Default)]
pub struct CurveOptions {
    /// Name of the rail, for messages.
    pub name: String,
    /// Which curve of the file: entity number of a STEP file (`12/2` where an assembly has it a second time), number in the
    /// directory of an IGES file, layer or handle of a DXF file; empty if it has only one.
    pub select: String,
    /// Length of one unit of the file, mm, where the file does not say (CSV, some DXF); default none.
    pub unit: Option<f64>,
    /// Whether points of a table are corners of a polyline instead of points of a smooth curve; default false.
    pub polyline: bool,
}

impl CurveOptions {
    /// The only curve of a file that says its unit.
    pub fn new(name: &str) -> Self {
        Self { name: name.into(), select: String::new(), unit: None, polyline: false }
    }
}

/// Why there is no rail in a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// The file has no unit and none was given.
    #[error("{0} does not say its unit; give it with --unit mm (or cm, m, in, ft)")]
    NoUnit(String),
    /// The file says another unit than the one given.
    #[error("the unit of {name} is the {file}, but --unit says otherwise; leave --unit out")]
    Unit {
        /// Name.
        name: String,
        /// Unit of the file.
        file: String,
    },
    /// More than one curve, and none was named.
    #[error("{name} holds {count} curves that do not join: {list}; name one as FILE#{first}")]
    Several {
        /// Name.
        name: String,
        /// How many.
        count: usize,
        /// The first few.
        list: String,
        /// The first.
        first: String,
    },
    /// No curve that can be read.
    #[error("{name} holds no curve that can be read{}; draw lines, arcs, circles, polylines or splines", .unread.as_ref().map_or(String::new(), |u| format!(" ({u})")))]
    Nothing {
        /// Name.
        name: String,
        /// What else it holds, and what would help.
        unread: Option<String>,
    },
    /// The curve named is not there.
    #[error("{name} has no curve{}; it has {list}", if .select.is_empty() { String::new() } else { format!(" #{select}") })]
    Missing {
        /// Name.
        name: String,
        /// Asked for.
        select: String,
        /// The first few that there are.
        list: String,
    },
    /// A line of a table that is no point.
    #[error("{name}, line {line}: {reason}")]
    Line {
        /// Name.
        name: String,
        /// Line number from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A damaged file.
    #[error("{name}: {reason}")]
    Damaged {
        /// Name.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// Curves that are no rail.
    #[error(transparent)]
    Rail(#[from] RailError),
    /// Not a readable STEP file.
    #[error("{name}: {source}")]
    Step {
        /// Name.
        name: String,
        /// What is wrong.
        source: ReadError,
    },
    /// Not a readable IGES file.
    #[error("{name}: {source}")]
    Iges {
        /// Name.
        name: String,
        /// What is wrong.
        source: iges::ReadError,
    },
    /// Not a readable 3DM file.
    #[error("{name}: {source}")]
    ThreeDm {
        /// Name.
        name: String,
        /// What is wrong.
        source: threedm::ReadError,
    },
}

/// A curve of a file with the name by which it can be selected.
pub(super) struct Found {
    pub label: String,
    pub curves: Vec<Curve<4>>,
}
