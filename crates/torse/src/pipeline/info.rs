//! What a face is like: size, area, curvature. Measured, not proven: every number is an estimate.
//!
//! Curvatures from the fundamental forms \[DC76\]; areas from [`crate::brep::area`].

use crate::brep::area::area_estimate;
use crate::brep::face::{Face, TrimLoop};
use crate::geom::{BBox, Vec3};
use crate::num::parallel;
use crate::spline::surface::SurfaceJet;

/// Samples per direction of the parameter plane at which curvature is looked at.
const GRID: usize = 32;

/// Sine of the angle between S_u and S_v, and relative length of either, below which a sample is taken for a pole
/// or a collapsed edge and has no curvature.
const DEGENERATE: f64 = 1e-7;

/// Curvature times size below which a face counts as flat, and product of curvatures times size² below which it
/// counts as developable. Far below what any sheet shows, far above the rounding of second derivatives.
const FLAT: f64 = 1e-6;

/// Curvature times size (squared for Gaussian curvature) that is rounding error of second derivatives, shown as zero.
const ROUNDING: f64 = 1e-9;

/// Smallest and largest value met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

impl Range {
    fn include(&mut self, x: f64) {
        self.min = self.min.min(x);
        self.max = self.max.max(x);
    }

    const EMPTY: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };

    /// Zero where nothing was met, and for what is not above `noise`.
    fn cleared(self, noise: f64) -> Self {
        let clear = |x: f64| if x.is_finite() && x.abs() > noise { x } else { 0.0 };
        Self { min: clear(self.min), max: clear(self.max) }
    }

    fn magnitude(&self) -> f64 {
        self.min.abs().max(self.max.abs())
    }
}

/// What was measured on a face. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceInfo {
    /// Kind of the surface in the file, for people.
    pub kind: &'static str,
    /// Number of inner loops.
    pub holes: usize,
    /// Box around samples of the face.
    pub bbox_estimate: BBox,
    /// Area of the trimmed face, mm².
    pub area_estimate: f64,
    /// Range of the smaller principal curvature, 1/mm, positive where the surface bends towards its normal.
    pub curvature_min: Range,
    /// Range of the larger principal curvature, 1/mm.
    pub curvature_max: Range,
    /// Range of the Gaussian curvature, 1/mm².
    pub gaussian: Range,
}

impl FaceInfo {
    /// Whether the face bends in one direction or two, in words.
    pub fn character(&self) -> &'static str {
        let size = self.bbox_estimate.diagonal();
        let flat = self.curvature_min.magnitude().max(self.curvature_max.magnitude()) * size <= FLAT;
        let (low, high) = (self.gaussian.min * size * size, self.gaussian.max * size * size);
        match (low < -FLAT, high > FLAT) {
            _ if flat => "flat",
            (false, false) => "developable",
            (false, true) => "dome-like",
            (true, false) => "saddle-like",
            (true, true) => "dome-like in parts, saddle-like in parts",
        }
    }

    /// Smallest radius of curvature met, mm; `None` for a flat face.
    pub fn smallest_radius(&self) -> Option<f64> {
        let k = self.curvature_min.magnitude().max(self.curvature_max.magnitude());
        (k * self.bbox_estimate.diagonal() > FLAT).then(|| 1.0 / k)
    }
}

/// Measures faces, each on its own, on all cores.
///
/// # Example
/// ```
/// let plate = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// assert_eq!(torse::measure(&plate.faces)[0].character(), "developable");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn measure(faces: &[Face]) -> Vec<FaceInfo> {
    parallel::map(faces.iter(), measure_face)
}

/// Measures one face.
///
/// *Cost*: some hundred surface evaluations per side of the trim, and `GRID²`.
pub(crate) fn measure_face(face: &Face) -> FaceInfo {
    let s = &face.surface;
    let mut bbox_estimate = BBox::empty();
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for trim in &face.loops {
        for (p, q) in sides(trim) {
            // Straight sides may run across the whole face: look inside them too.
            for k in 0..4 {
                let x = k as f64 / 4.0;
                bbox_estimate.include(&s.point(p[0] + x * (q[0] - p[0]), p[1] + x * (q[1] - p[1])));
            }
            for d in 0..2 {
                low[d] = low[d].min(p[d]);
                high[d] = high[d].max(p[d]);
            }
        }
    }
    let (mut kmin, mut kmax, mut gaussian) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
    let sign = if face.reversed { -1.0 } else { 1.0 };
    for i in 0..GRID {
        let v = low[1] + (high[1] - low[1]) * (i as f64 + 0.5) / GRID as f64;
        let inside = crossings(&face.loops, v);
        for j in 0..GRID {
            let u = low[0] + (high[0] - low[0]) * (j as f64 + 0.5) / GRID as f64;
            if inside.iter().filter(|&&x| x > u).count() % 2 == 0 {
                continue;
            }
            let jet = s.jet(u, v);
            bbox_estimate.include(&jet.p);
            if let Some((k1, k2)) = principal_curvatures(&jet) {
                let (a, b) = (sign * k1, sign * k2);
                kmin.include(a.min(b));
                kmax.include(a.max(b));
                gaussian.include(k1 * k2);
            }
        }
    }
    let noise = ROUNDING / bbox_estimate.diagonal();
    FaceInfo {
        kind: face.kind.name(),
        holes: face.loops.len().saturating_sub(1),
        bbox_estimate,
        area_estimate: area_estimate(face),
        curvature_min: kmin.cleared(noise),
        curvature_max: kmax.cleared(noise),
        gaussian: gaussian.cleared(noise * noise / ROUNDING),
    }
}

/// Sides of a loop.
fn sides(trim: &TrimLoop) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    let n = trim.points.len();
    (0..n).map(move |i| (trim.points[i], trim.points[(i + 1) % n]))
}

/// Values of u at which the line of constant v meets the loops.
fn crossings(loops: &[TrimLoop], v: f64) -> Vec<f64> {
    let mut out = Vec::new();
    for (p, q) in loops.iter().flat_map(sides) {
        if (p[1] > v) != (q[1] > v) {
            out.push(p[0] + (v - p[1]) * (q[0] - p[0]) / (q[1] - p[1]));
        }
    }
    out
}

/// Principal curvatures; `None` where the parametrisation degenerates.
fn principal_curvatures(jet: &SurfaceJet) -> Option<(f64, f64)> {
    let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
    let cross = jet.normal();
    let det = cross.norm_squared();
    if det <= DEGENERATE * DEGENERATE * e * g || e <= DEGENERATE * DEGENERATE * g || g <= DEGENERATE * DEGENERATE * e {
        return None;
    }
    let n: Vec3 = cross / det.sqrt();
    let [l, m, nn] = jet.second_form(&n);
    let gauss = (l * nn - m * m) / det;
    let mean = 0.5 * (e * nn - 2.0 * f * m + g * l) / det;
    let root = (mean * mean - gauss).max(0.0).sqrt();
    // The curvature of larger size first, the other by the product: no cancellation.
    let large = if mean >= 0.0 { mean + root } else { mean - root };
    let small = if large == 0.0 { 0.0 } else { gauss / large };
    Some((small, large))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    /// Half a cylinder of radius 2 and height 3, rational quadratic in u.
    fn half_cylinder() -> Surface {
        let w = std::f64::consts::FRAC_1_SQRT_2;
        let arc = [(2.0, 0.0, 1.0), (2.0, 2.0, w), (0.0, 2.0, 1.0), (-2.0, 2.0, w), (-2.0, 0.0, 1.0)];
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for (x, y, w) in arc {
            for z in [0.0, 3.0] {
                points.push(Vec3::new(x, y, z));
                weights.push(w);
            }
        }
        let ku = Knots::new(2, vec![0., 0., 0., 1., 1., 2., 2., 2.], 5).expect("knots");
        let kv = Knots::uniform(1, 1, 0.0, 1.0).expect("knots");
        Surface::new(ku, kv, &points, Some(&weights)).expect("surface")
    }

    #[test]
    fn a_half_cylinder_is_measured() {
        let info = measure_face(&Face::untrimmed(half_cylinder()));
        let exact = std::f64::consts::PI * 2.0 * 3.0;
        assert!((info.area_estimate - exact).abs() < 1e-9 * exact, "{}", info.area_estimate);
        assert_eq!(info.character(), "developable");
        assert!((info.smallest_radius().expect("curved") - 2.0).abs() < 1e-9);
        assert!((info.bbox_estimate.diagonal() - (16.0f64 + 4.0 + 9.0).sqrt()).abs() < 0.02);
    }

    #[test]
    fn a_plane_is_flat() {
        let k = Knots::uniform(1, 1, 0.0, 1.0).expect("knots");
        let points = [Vec3::zeros(), Vec3::y(), Vec3::x() * 2.0, Vec3::new(2.0, 1.0, 0.0)];
        let info = measure_face(&Face::untrimmed(Surface::new(k.clone(), k, &points, None).expect("plane")));
        assert_eq!(info.character(), "flat");
        assert!(info.smallest_radius().is_none() && (info.area_estimate - 2.0).abs() < 1e-12);
    }
}
