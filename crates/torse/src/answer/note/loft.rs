//! Notes of lofts.

pub(crate) use crate::search::strips::exact_chain::ExactPiece;
pub(crate) use crate::search::strips::exact_strip::ExactError;
pub(crate) use crate::search::strips::loft_ends::{EndNote, Leads};

/// Something that people should know of a loft.
#[derive(Clone, Debug, PartialEq)]
pub enum LoftNote {
    /// Lengths so different that one rail may be in another unit.
    Unlike {
        /// Name of the longer rail.
        long: String,
        /// Name of the shorter one.
        short: String,
        /// Its length by that of the shorter.
        factor: f64,
    },
    /// Both rails lie in one plane, where every plane that touches both is that plane, and there is nothing to follow.
    OnePlane,
    /// A rail is run through backwards.
    Backwards {
        /// Its name.
        rail: String,
    },
    /// A regular branch of common tangent planes.
    Branch {
        /// Its number, from 1, best first.
        number: usize,
        /// Names of the rails.
        rails: [String; 2],
        /// Shares of the rails' lengths that it uses.
        shares: [f64; 2],
        /// Whether it is closed.
        closed: bool,
    },
    /// Branches with regression points between the rails.
    Doubles {
        /// How many.
        count: usize,
    },
    /// No branch was used: this is the strip of least twist.
    LeastTwist,
    /// A strip of least twist among several.
    LeastTwistPath {
        /// Its number, from 1, best first.
        number: usize,
        /// Root of the summed squares of its bends, rad.
        bends: f64,
        /// Greatest twist, rad, measured.
        twist: f64,
        /// Area, mm².
        area: f64,
    },
    /// What became of the ends of rails.
    Ends(EndNote),
    /// Strips that are exactly developable.
    Exact(Vec<ExactPiece>),
    /// A strip that is a ruled spline with a small twist.
    Ruled {
        /// Its number, from 1.
        strip: usize,
        /// Why there is no exact one.
        why: ExactError,
    },
    /// Neighbouring strips meet at an angle.
    Creases {
        /// How often.
        count: usize,
        /// The sharpest angle, rad.
        sharpest: f64,
        /// Names of the strips there.
        between: [String; 2],
    },
}
