//! The image of a curve of the parameter plane on a spline surface: exact, piece by piece.
//!
//! Composition of polynomials in Bernstein form on every piece between knot lines \[FR88\].

use crate::spline::bezier::Bezier;
use crate::spline::composite::smooth_breaks;
use crate::spline::curve::Curve;
use crate::spline::knots::SAME_PARAMETER;
use crate::spline::surface::Surface;
use crate::spline::MAX_DEGREE;

/// Pieces at most.
const MOST_PIECES: usize = 2000;

/// `surface(curve(t))` as a rational spline with the parameter of the curve. *Exact* up to rounding and to where knot
/// lines are crossed. `None` where the degree would exceed what the kernel evaluates, or the curve leaves the surface.
pub(crate) fn on_surface(surface: &Surface, curve: &Curve<2>) -> Option<Curve<4>> {
    let (a, b) = curve.domain();
    let degree = (surface.knots_u.degree() + surface.knots_v.degree()) * curve.knots.degree();
    let (du, dv) = surface.domain();
    let inside =
        |x: f64, (lo, hi): (f64, f64)| x >= lo - SAME_PARAMETER * (hi - lo) && x <= hi + SAME_PARAMETER * (hi - lo);
    if degree > MAX_DEGREE || !curve.control.iter().all(|p| inside(p[0], du) && inside(p[1], dv)) {
        return None;
    }
    // The same curve over [0, 1], as the search for crossings wants it.
    let unit: Vec<f64> = curve.knots.values().iter().map(|t| (t - a) / (b - a)).collect();
    let unit = Curve::new(curve.knots.degree(), unit, curve.control.clone()).ok()?;
    let turned = Curve { knots: unit.knots.clone(), control: unit.control.iter().map(|p| [p[1], p[0]]).collect() };
    let mut breaks = smooth_breaks(surface, &unit);
    breaks.extend(smooth_breaks(&surface.transposed(), &turned));
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|y, x| *y - *x <= SAME_PARAMETER);
    *breaks.last_mut()? = 1.0;
    if breaks.len() > MOST_PIECES {
        return None;
    }
    let patches = surface.bezier_patches();
    let columns = surface.knots_v.breaks().len() - 1;
    let (bu, bv) = (surface.knots_u.breaks(), surface.knots_v.breaks());
    let cell = |breaks: &[f64], x: f64| breaks.partition_point(|t| *t <= x).clamp(1, breaks.len() - 1) - 1;
    let mut control: Vec<[f64; 4]> = Vec::new();
    let mut knots = vec![a; degree + 1];
    for w in breaks.windows(2) {
        let piece = unit.restricted(w[0], w[1]).ok()?;
        let middle = unit.point(0.5 * (w[0] + w[1]));
        let patch = patches.get(cell(&bu, middle[0]) * columns + cell(&bv, middle[1]))?;
        let local = |x: f64, (lo, hi): (f64, f64)| (x - lo) / (hi - lo);
        let flat = piece.control.iter().map(|p| [local(p[0], patch.u), local(p[1], patch.v)]).collect();
        let image = patch.compose(&Bezier::new(flat));
        if image.control().len() != degree + 1 || image.control().iter().any(|h| h[3] <= 0.0 || h[3].is_nan()) {
            return None;
        }
        control.extend(image.control().iter().skip(usize::from(!control.is_empty())));
        knots.extend(std::iter::repeat_n(a + (b - a) * w[1], degree));
    }
    knots.push(b);
    let count = knots.len();
    knots[count - degree - 1..].fill(b);
    Curve::new(degree, knots, control).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;

    #[test]
    fn the_image_of_a_curve_is_exact() {
        let ku = Knots::clamped(2, &[0.0, 1.0, 3.0]).expect("knots");
        let kv = Knots::clamped(3, &[0.0, 0.4, 1.0]).expect("knots");
        let points: Vec<Vec3> =
            (0..20).map(|k| Vec3::new((k / 5) as f64, (k % 5) as f64, ((k * k) as f64).sin())).collect();
        let weights: Vec<f64> = (0..20).map(|k| 1.0 + 0.1 * f64::from(k % 3)).collect();
        let s = Surface::new(ku, kv, &points, Some(&weights)).expect("surface");
        let c = Curve::new(2, vec![2., 2., 2., 5., 5., 5.], vec![[0.1, 0.1], [2.9, 0.2], [1.5, 0.9]]).expect("curve");
        let image = on_surface(&s, &c).expect("an image");
        assert_eq!(image.domain(), (2.0, 5.0));
        for i in 0..=60 {
            let t = 2.0 + 3.0 * f64::from(i) / 60.0;
            let (h, q) = (image.point(t), c.point(t));
            let d = Vec3::new(h[0], h[1], h[2]) / h[3] - s.point(q[0], q[1]);
            assert!(d.norm() < 1e-9, "{t}: {:e}", d.norm());
        }
        let out = Curve::new(1, vec![0., 0., 1., 1.], vec![[0.1, 0.1], [3.5, 0.2]]).expect("curve");
        assert!(on_surface(&s, &out).is_none());
    }
}
