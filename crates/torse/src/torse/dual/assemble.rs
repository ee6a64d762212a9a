//! B-spline curves from Bézier pieces over given knots: the blossom of a piece at consecutive knots \[R89\].

use crate::spline::bezier::Bezier;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::SplineError;

/// The curve over `knots` that has the given pieces `(a, b, polynomial)`, one for every span, of the degree of the
/// knots. Exact up to rounding if the pieces join as smoothly as the knots say; this is not checked.
///
/// # Errors
/// A number of pieces or a degree that does not fit.
pub(crate) fn from_pieces<const D: usize>(
    knots: Knots,
    pieces: &[(f64, f64, Bezier<D>)],
) -> Result<Curve<D>, SplineError> {
    let p = knots.degree();
    if pieces.len() + 1 != knots.breaks().len() {
        return Err(SplineError::KnotCount { knots: knots.values().len(), control: pieces.len(), degree: p });
    }
    if let Some(piece) = pieces.iter().find(|c| c.2.degree() != p) {
        return Err(SplineError::Degree(piece.2.degree()));
    }
    let v = knots.values();
    let control = (0..knots.control_count())
        .map(|i| {
            let args = &v[i + 1..=i + p];
            let mean = args.iter().sum::<f64>() / p as f64;
            // The piece nearest to the mean of the knots among those that the control point acts on.
            let (a, b, piece) = pieces
                .iter()
                .filter(|(a, b, _)| *b > v[i] && *a < v[i + p + 1])
                .min_by(|x, y| gap(x, mean).total_cmp(&gap(y, mean)))
                .unwrap_or(&pieces[0]);
            let mut c = piece.control().to_vec();
            for (r, t) in args.iter().enumerate() {
                let s = (t - a) / (b - a);
                for k in 0..p - r {
                    c[k] = std::array::from_fn(|d| (1.0 - s) * c[k][d] + s * c[k + 1][d]);
                }
            }
            c[0]
        })
        .collect();
    Ok(Curve { knots, control })
}

fn gap<const D: usize>(piece: &(f64, f64, Bezier<D>), t: f64) -> f64 {
    (piece.0 - t).max(t - piece.1).max(0.0)
}

/// The form of lower degree of a polynomial whose leading coefficient vanishes: from both ends to the middle, so that
/// rounding does not grow. The result is meaningless if the degree is not lower.
pub(super) fn reduced(b: &Bezier<1>) -> Bezier<1> {
    let n = b.degree();
    if n == 0 {
        return b.clone();
    }
    let nf = n as f64;
    let old = b.control();
    let mut c = vec![[0.0]; n];
    let half = n.div_ceil(2);
    for i in 0..half {
        let before = if i == 0 { 0.0 } else { i as f64 * c[i - 1][0] };
        c[i][0] = (nf * old[i][0] - before) / (nf - i as f64);
    }
    for i in (half..n).rev() {
        let after = if i + 1 == n { 0.0 } else { (n - i - 1) as f64 * c[i + 1][0] };
        c[i][0] = (nf * old[i + 1][0] - after) / (i + 1) as f64;
    }
    Bezier::new(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduction_undoes_elevation() {
        let b = Bezier::new(vec![[1.0], [-2.0], [0.5], [3.0], [0.1], [7.0]]);
        for (x, y) in reduced(&b.elevated(1)).control().iter().zip(b.control()) {
            assert!((x[0] - y[0]).abs() < 1e-14);
        }
    }
}
