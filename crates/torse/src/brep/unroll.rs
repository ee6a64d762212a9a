//! Closed splines, unrolled: copies joined over the seam and cut to a range, so that a region may cross it.

use crate::spline::curve::Curve;
use crate::spline::knots::{Knots, SAME_PARAMETER};
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Copies at most; a region that winds more often is refused.
const MOST_COPIES: i64 = 8;

/// The closed curve over `range`, exactly; the curve itself if its domain holds the range.
///
/// # Errors
/// A range of many turns.
pub fn curve(c: &Curve<4>, range: (f64, f64)) -> Result<Curve<4>, SplineError> {
    let Some((knots, rows)) = rows(&c.knots, &c.control, 1, range)? else { return Ok(c.clone()) };
    Ok(Curve { knots, control: rows })
}

/// As [`curve`], along u.
///
/// # Errors
/// A range of many turns.
pub(crate) fn in_u(s: &Surface, range: (f64, f64)) -> Result<Surface, SplineError> {
    let Some((knots_u, control)) = rows(&s.knots_u, &s.control, s.row(), range)? else { return Ok(s.clone()) };
    Ok(Surface { knots_u, knots_v: s.knots_v.clone(), control, rational: s.rational })
}

/// As [`curve`], along v.
///
/// # Errors
/// A range of many turns.
pub(crate) fn in_v(s: &Surface, range: (f64, f64)) -> Result<Surface, SplineError> {
    let (n, m) = (s.knots_u.control_count(), s.row());
    let turned: Vec<[f64; 4]> = (0..m).flat_map(|j| (0..n).map(move |i| i * m + j)).map(|k| s.control[k]).collect();
    let Some((knots_v, control)) = rows(&s.knots_v, &turned, n, range)? else { return Ok(s.clone()) };
    let m = knots_v.control_count();
    let control = (0..n).flat_map(|i| (0..m).map(move |j| j * n + i)).map(|k| control[k]).collect();
    Ok(Surface { knots_u: s.knots_u.clone(), knots_v, control, rational: s.rational })
}

/// Knots in one direction, and control points row by row.
type Rows = (Knots, Vec<[f64; 4]>);

/// Knots and control rows (of `width` points each) over `range`; `None` if the domain holds the range.
fn rows(knots: &Knots, control: &[[f64; 4]], width: usize, range: (f64, f64)) -> Result<Option<Rows>, SplineError> {
    let (a, b) = knots.domain();
    let period = b - a;
    // Rounding of unwrapped parameters must not call for another copy.
    let hair = SAME_PARAMETER * period;
    if range.0 >= a - hair && range.1 <= b + hair {
        return Ok(None);
    }
    let first = ((range.0 - a + hair) / period).floor() as i64;
    let last = ((range.1 - a - hair) / period).ceil() as i64;
    if last - first > MOST_COPIES || last <= first {
        return Err(SplineError::KnotOrder { index: 0, value: range.1 });
    }
    let p = knots.degree();
    // One clamped copy, then copies joined at knots of multiplicity p.
    let (one, points) = cut(knots, control, width, (a, b))?;
    let inner: Vec<f64> = one.values()[p + 1..one.control_count()].to_vec();
    let mut values = vec![a + first as f64 * period; p + 1];
    let mut all: Vec<[f64; 4]> = points[..width].to_vec();
    for k in first..last {
        let shift = k as f64 * period;
        values.extend(inner.iter().map(|t| t + shift));
        values.extend(std::iter::repeat_n(a + (k + 1) as f64 * period, p));
        all.extend_from_slice(&points[width..]);
    }
    values.push(a + last as f64 * period);
    let joined = Knots::new(p, values, all.len() / width)?;
    let (lo, hi) = joined.domain();
    cut(&joined, &all, width, (range.0.max(lo), range.1.min(hi))).map(Some)
}

/// Clamped knots and control rows of the part of a spline over `range` inside its domain, by blossoms.
fn cut(knots: &Knots, control: &[[f64; 4]], width: usize, range: (f64, f64)) -> Result<Rows, SplineError> {
    let p = knots.degree();
    let (a, b) = range;
    let mut values = vec![a; p + 1];
    values.extend(knots.values().iter().copied().filter(|&t| t > a && t < b));
    values.extend(std::iter::repeat_n(b, p + 1));
    let count = values.len() - p - 1;
    let new = Knots::new(p, values, count)?;
    let v = new.values();
    let mut out = Vec::with_capacity(count * width);
    for j in 0..count {
        // A span that the control point acts on: any whose ends differ.
        let span =
            (j..=j + p).find(|&i| v[i + 1] > v[i]).map_or(knots.span(a), |i| knots.span(0.5 * (v[i] + v[i + 1])));
        for k in 0..width {
            let mut net: Vec<[f64; 4]> = (0..=p).map(|i| control[(span - p + i) * width + k]).collect();
            blossom(&mut net, knots.values(), span, &v[j + 1..=j + p]);
            out.push(net[p]);
        }
    }
    Ok((new, out))
}

/// De Boor's scheme with one argument per step; the blossom ends in the last entry of `net`.
fn blossom(net: &mut [[f64; 4]], knots: &[f64], span: usize, args: &[f64]) {
    let p = args.len();
    for (r, &t) in args.iter().enumerate() {
        for j in (r + 1..=p).rev() {
            let i = span - p + j;
            let s = (t - knots[i]) / (knots[i + p - r] - knots[i]);
            for d in 0..4 {
                net[j][d] = (1.0 - s) * net[j - 1][d] + s * net[j][d];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::{Frame, Vec3};
    use std::f64::consts::TAU;

    #[test]
    fn a_closed_curve_continues_over_its_seam() {
        let circle = SpaceCurve::Ellipse { frame: Frame::world(), a: 2.0, b: 1.0 };
        let (spline, _) = circle.to_spline(0.0, TAU).expect("a spline");
        let closed = SpaceCurve::Spline(spline.clone());
        let part = curve(&spline, (5.0, 5.0 + TAU)).expect("unrolled");
        assert_eq!(part.domain(), (5.0, 5.0 + TAU));
        for i in 0..=50 {
            let t = 5.0 + TAU * i as f64 / 50.0;
            let h = part.point(t);
            let p = Vec3::new(h[0], h[1], h[2]) / h[3];
            assert!((p - closed.point(t)).norm() < 1e-13);
        }
    }

    #[test]
    fn unclamped_knots_are_clamped_exactly() {
        let knots = Knots::new(3, (0..=10).map(f64::from).collect(), 7).expect("knots");
        let control: Vec<[f64; 4]> = (0..7).map(|i| [f64::from(i), f64::from(i * i % 5), 0.0, 1.0]).collect();
        let c = Curve { knots: knots.clone(), control: control.clone() };
        let (k, q) = cut(&knots, &control, 1, (3.5, 6.0)).expect("cut");
        let d = Curve { knots: k, control: q };
        for i in 0..=20 {
            let t = 3.5 + 2.5 * f64::from(i) / 20.0;
            assert!((0..2).all(|e| (c.point(t)[e] - d.point(t)[e]).abs() < 1e-13));
        }
    }
}
