//! What a net is asked for.

use crate::develop::view::Drawn;
use crate::geom::Vec3;
use crate::search::strips::assessment::TWIST_TOLERANCE;

/// What decides the net besides its curve and first ruling. The curve's parameter runs from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The last ruling lies on the line in this direction (any length), on this side of the curve.
    LastRuling {
        /// Direction.
        direction: Vec3,
        /// Length of the last ruling, mm; none: it follows from the surface.
        width: Option<f64>,
    },
    /// The free parameters in stable form, see [`crate::torse::net::Shape`].
    Shape {
        /// `1/(M* − 1/2)`; 0 for cones.
        m: f64,
        /// `(Λ* − M*) m`; 0 for cylinders.
        kappa: f64,
    },
    /// The free parameters of the paper.
    Stars {
        /// Λ*.
        lambda_star: f64,
        /// M*.
        m_star: f64,
    },
}

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and curve, mm; no default.
    pub tolerance: f64,
    /// The first ruling, from the curve to the opposite edge, mm; no default.
    pub first_ruling: Vec3,
    /// What else decides; no default.
    pub condition: Condition,
    /// Name of the input for reports.
    pub input: String,
    /// The stretch of the curve that is used; beyond 0 and 1 the surface is continued. Default 0 to 1.
    pub along: [f64; 2],
    /// Which of the regular polynomial solutions, best first, from 1; default 1.
    pub alternative: usize,
    /// Whether only one polynomial net will do, neither rational nor split; default false.
    pub polynomial: bool,
    /// Whether the strip may be made narrower to stay clear of its regression curve; default true.
    pub shorten: bool,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the curve, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm), the first ruling (mm) and the condition.
    pub fn new(tolerance: f64, first_ruling: Vec3, condition: Condition) -> Self {
        Self {
            tolerance,
            first_ruling,
            condition,
            input: "net".into(),
            along: [0.0, 1.0],
            alternative: 1,
            polynomial: false,
            shorten: true,
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: TWIST_TOLERANCE,
            drawn: Drawn::default(),
        }
    }
}
