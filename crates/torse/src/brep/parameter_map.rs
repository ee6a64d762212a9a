//! Natural parameters of conics as parameters of the rational splines that are made of them.

use std::f64::consts::FRAC_PI_2;

/// Share by which a quarter turn may be exceeded by one piece: rounding of full turns must not add a fifth.
const QUARTER_ROUNDING: f64 = 1e-9;

/// How a natural parameter becomes the parameter of the spline made from the curve. Increasing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterMap {
    /// The same number.
    Same,
    /// Pieces of angle `sweep` from `start` on, each parametrised by the tangent of the half angle; the ends of
    /// pieces keep their angle as parameter. Continued periodically.
    Angle {
        /// Angle at which a piece begins.
        start: f64,
        /// Angle of one piece, below π.
        sweep: f64,
    },
    /// One piece of a hyperbola around `middle`, `half` to each side.
    Hyperbolic {
        /// Middle of the natural parameter.
        middle: f64,
        /// Half the width of the natural parameter.
        half: f64,
    },
}

impl ParameterMap {
    /// The spline parameter of the natural parameter `t`.
    pub fn forward(self, t: f64) -> f64 {
        match self {
            Self::Same => t,
            Self::Angle { start, sweep } => {
                let middle = start + ((t - start) / sweep).floor() * sweep + 0.5 * sweep;
                let h = (0.5 * (t - middle)).tan() / (0.25 * sweep).tan();
                middle + 0.5 * sweep * h
            }
            Self::Hyperbolic { middle, half } => middle + half * (0.5 * (t - middle)).tanh() / (0.5 * half).tanh(),
        }
    }

    /// The natural parameter of the spline parameter `u`, and its derivative there.
    pub fn inverse(self, u: f64) -> (f64, f64) {
        match self {
            Self::Same => (u, 1.0),
            Self::Angle { start, sweep } => {
                let middle = start + ((u - start) / sweep).floor() * sweep + 0.5 * sweep;
                let k = (0.25 * sweep).tan();
                let h = (u - middle) / (0.5 * sweep) * k;
                (middle + 2.0 * h.atan(), 2.0 * k / (0.5 * sweep) / (1.0 + h * h))
            }
            Self::Hyperbolic { middle, half } => {
                let k = (0.5 * half).tanh();
                // Beyond the piece the map ends; stay just inside.
                let h = ((u - middle) / half * k).clamp(-0.999_999, 0.999_999);
                (middle + 2.0 * h.atanh(), 2.0 * k / half / (1.0 - h * h))
            }
        }
    }
}

/// Number of pieces of at most a quarter turn that an angle needs.
pub(crate) fn quarter_pieces(angle: f64) -> usize {
    ((angle / (FRAC_PI_2 * (1.0 + QUARTER_ROUNDING))).ceil() as usize).clamp(1, 64)
}

/// Homogeneous control points and clamped knots of the arc of the unit circle `(cos, sin, weight)` from `start`
/// over `pieces` pieces of angle `sweep`.
pub(crate) fn unit_arc(start: f64, sweep: f64, pieces: usize) -> (Vec<f64>, Vec<[f64; 3]>) {
    let mut knots = vec![start; 3];
    let mut control = vec![[start.cos(), start.sin(), 1.0]];
    for i in 0..pieces {
        let (m, e) = (start + (i as f64 + 0.5) * sweep, start + (i as f64 + 1.0) * sweep);
        control.push([m.cos(), m.sin(), (0.5 * sweep).cos()]);
        control.push([e.cos(), e.sin(), 1.0]);
        knots.extend([e, e]);
    }
    knots.push(start + pieces as f64 * sweep);
    (knots, control)
}
