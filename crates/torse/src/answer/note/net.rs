//! Notes of nets.

pub use crate::design::interpolate::Quality;
pub use crate::design::interpolate::Route;
use crate::torse::net::Shape;

/// Something that people should know of a developable through one curve.
#[derive(Clone, Debug, PartialEq)]
pub enum NetNote {
    /// A polynomial net that holds both end rulings.
    Candidate {
        /// Its number, from 1, best first.
        number: usize,
        /// Its free parameters.
        shape: Shape,
        /// What it is like.
        quality: Quality,
        /// Least distance from the curve to the regression curve along the rulings, mm; infinite where there is none.
        clearance_estimate: f64,
        /// Length of the last ruling, mm.
        last: f64,
    },
    /// A solution was asked for by its number.
    Asked {
        /// The number, from 1.
        number: usize,
    },
    /// How the net was found.
    Route {
        /// The way.
        route: Route,
        /// Regular polynomial solutions that there are.
        good: usize,
    },
    /// The strip runs over a stretch of the curve, or beyond its ends.
    Stretch {
        /// First and last parameter; those of the curve are 0 and 1.
        along: [f64; 2],
    },
    /// A strip without regression curve.
    NoRegression {
        /// Name of the strip.
        strip: String,
    },
    /// Where the regression curve of a strip lies.
    Regression {
        /// Name of the strip.
        strip: String,
        /// Whether it is one point, the apex of a cone.
        apex: bool,
        /// Whether it runs straight between the values at the ends.
        linear: bool,
        /// Distance from the curve in lengths of the ruling, on the first ruling and on the last; negative behind the curve.
        at: [f64; 2],
    },
}
