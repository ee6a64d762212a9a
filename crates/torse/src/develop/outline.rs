//! The developed border of a panel: every run as a curve of the plane, and measures of the region inside.

use super::arcs::PlaneCurve;
use super::map::Development;
use super::overlap::OutlinePoint;
use crate::brep::face::Face;
use crate::geom::Vec2;
use crate::patchwork::clip::trim_place;
use crate::patchwork::panel::{Coedge, Panel};
use crate::spline::composite::smooth_breaks;
use crate::spline::surface::Surface;

/// One run in the plane.
pub(crate) struct FlatCoedge<'a> {
    development: &'a Development,
    /// The run in space.
    pub run: &'a Coedge,
    /// Ends of its smooth pieces.
    pub breaks: Vec<f64>,
}

impl PlaneCurve for FlatCoedge<'_> {
    fn place(&self, s: f64) -> Vec2 {
        let q = self.parameters(s);
        self.development.map(q[0], q[1])
    }

    fn velocity(&self, s: f64) -> Vec2 {
        let q = self.run.trim.jet(s);
        self.development.tangent(q[0][0], q[0][1], q[1][0], q[1][1])
    }
}

/// Gauss–Legendre nodes and weights on [−1, 1], five of each: exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

impl<'a> FlatCoedge<'a> {
    /// A run of a panel on the panel's patch.
    pub fn new(development: &'a Development, patch: &Surface, run: &'a Coedge) -> Self {
        Self { development, run, breaks: smooth_breaks(patch, &run.trim) }
    }

    /// Parameters (t, r) at `s`; at the ends exactly those shared with the neighbouring runs.
    pub fn parameters(&self, s: f64) -> [f64; 2] {
        trim_place(self.run, s)
    }

    /// `∫ f(s) ds` over the smooth pieces, each in `parts` parts.
    pub fn integral(&self, parts: usize, mut f: impl FnMut(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for w in self.breaks.windows(2) {
            let h = 0.5 * (w[1] - w[0]) / parts as f64;
            for k in 0..parts {
                let m = w[0] + h * (2 * k + 1) as f64;
                sum += GAUSS.iter().map(|(x, g)| g * f(m + h * x)).sum::<f64>() * h;
            }
        }
        sum
    }

    /// Length in the plane, mm.
    pub fn length(&self) -> f64 {
        self.integral(2, |s| self.velocity(s).norm())
    }

    /// Parameter at which half of the length is reached.
    pub fn half_way(&self) -> f64 {
        const STEPS: usize = 64;
        let speed: Vec<f64> = (0..STEPS).map(|k| self.velocity((k as f64 + 0.5) / STEPS as f64).norm()).collect();
        let total: f64 = speed.iter().sum();
        let mut sum = 0.0;
        for (k, v) in speed.iter().enumerate() {
            if sum + v >= 0.5 * total && *v > 0.0 {
                return (k as f64 + (0.5 * total - sum) / v) / STEPS as f64;
            }
            sum += v;
        }
        0.5
    }

    /// Contribution to the flat area, `½ ∫ x dy − y dx` about `origin`.
    pub fn flat_area(&self, origin: &Vec2) -> f64 {
        self.integral(2, |s| 0.5 * (self.place(s) - origin).perp(&self.velocity(s)))
    }

    /// Contribution to the area in space: `−∫ Q dt` with `Q(t, r) = ∫_{1/2}^r |R_t × R_r| dr` (Green).
    pub fn area_in_space(&self, patch: &Surface) -> f64 {
        self.integral(2, |s| {
            let q = self.run.trim.jet(s);
            let (t, r) = (q[0][0], q[0][1]);
            let h = 0.5 * (r - 0.5);
            let inner: f64 = GAUSS.iter().map(|(x, g)| g * patch.jet(t, 0.5 + h * (1.0 + x)).normal().norm()).sum();
            -inner * h * q[1][0]
        })
    }

    /// Samples from the start (included) to the end (not), `parts` per smooth piece and at least `least`.
    pub fn samples(&self, patch: &Surface, parts: usize, least: usize) -> Vec<OutlinePoint> {
        let pieces = self.breaks.len() - 1;
        let parts = parts.max(least.div_ceil(pieces));
        let mut out = Vec::with_capacity(parts * pieces);
        for w in self.breaks.windows(2) {
            for k in 0..parts {
                let s = w[0] + (w[1] - w[0]) * k as f64 / parts as f64;
                let q = self.parameters(s);
                out.push(OutlinePoint { flat: self.place(s), space: patch.point(q[0], q[1]), t: q[0] });
            }
        }
        out
    }
}

/// +1 or −1: the side from which the panel looks as the face looks from its outside, for [`Development::new`]: loops run as
/// those of the face in its parameter plane.
pub fn outside(panel: &Panel, face: &Face) -> f64 {
    if panel.mirrored() == face.reversed {
        -1.0
    } else {
        1.0
    }
}
