//! Developability of a ruling of the strip between two curves, in two forms \[W15\].

mod k_form;
mod n_form;

pub(crate) use k_form::KForm;
pub(crate) use n_form::NForm;

use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::spline::knots::Knots;

/// Two boundary curves over the same knots: their control points as first unknowns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StripPoints<'a> {
    /// Common knots.
    pub knots: &'a Knots,
    /// Control points of the curve `v = 0`.
    pub a: &'a [u32],
    /// Control points of the curve `v = 1`.
    pub b: &'a [u32],
}

impl StripPoints<'_> {
    /// Combinations `a'`, `b'`, `b − a` at `u`; derivatives with respect to `u/unit`.
    pub fn ruling(&self, u: f64, unit: f64) -> [Stencil; 3] {
        let [a, da, _] = Stencil::jet(self.knots, self.a, u, unit);
        let [b, db, _] = Stencil::jet(self.knots, self.b, u, unit);
        [da, db, b.minus(&a)]
    }
}

/// Number of rulings in one polynomial piece of degree `d` whose developability makes the piece developable: the
/// determinant of `a'`, `b'` and `b − a` has degree `3d − 3`, for its leading term cancels.
pub(crate) fn samples_per_interval(degree: usize) -> usize {
    (3 * degree).saturating_sub(2)
}

/// Parameters at which developability of all pieces is asked for: Chebyshev points inside every piece, with the length
/// of the piece.
pub(crate) fn samples(knots: &Knots) -> Vec<(f64, f64)> {
    let count = samples_per_interval(knots.degree());
    let mut out = Vec::new();
    for w in knots.breaks().windows(2) {
        let h = w[1] - w[0];
        out.extend((0..count).map(|k| {
            let c = (std::f64::consts::PI * (k as f64 + 0.5) / count as f64).cos();
            (w[0] + 0.5 * h * (1.0 - c), h)
        }));
    }
    out
}

/// Vectors `a'`, `b'`, `b − a` of a block over [`StripPoints::ruling`].
fn vectors(support: &Support, x: &[f64]) -> [Vec3; 3] {
    [0, 1, 2].map(|k| support.vector(k, x))
}

/// Free numbers that a strip of the given degree gains per polynomial piece: six per new pair of control points, less the
/// conditions. Negative where developability asks for more than there is (degree 3 with simple knots).
pub(crate) fn freedom_per_interval(degree: usize, multiplicity: usize) -> isize {
    6 * multiplicity as isize - samples_per_interval(degree) as isize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::bernstein;

    #[test]
    fn determinant_of_a_piece_has_degree_3d_minus_3() {
        // Power coefficients of det(a', b', b − a) for curves of degree d: those above 3d − 3 vanish, that one does not.
        for d in 2..=5usize {
            let coefficient =
                |k: usize| (0..=d).map(|i| (((k + 2) * (i + 1) * (i + 3)) as f64 * 0.61).sin()).collect::<Vec<f64>>();
            let (a, b): (Vec<_>, Vec<_>) = (0..3).map(|k| (coefficient(k), coefficient(k + 7))).unzip();
            let r: Vec<Vec<f64>> = (0..3).map(|k| bernstein::difference(&b[k], &a[k])).collect();
            let slope = |c: &[Vec<f64>]| c.iter().map(|c| bernstein::derivative(c)).collect::<Vec<_>>();
            let (da, db) = (slope(&a), slope(&b));
            let mut det: Option<Vec<f64>> = None;
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                let cross =
                    bernstein::difference(&bernstein::product(&da[j], &db[k]), &bernstein::product(&da[k], &db[j]));
                let term = bernstein::product(&cross, &r[i]);
                det = Some(det.map_or(term.clone(), |s| bernstein::sum(&s, &term)));
            }
            let det = det.expect("terms");
            // The k-th forward difference of Bernstein coefficients is the k-th power coefficient up to a factor.
            let forward = |order: usize| {
                let mut c = det.clone();
                (0..order).for_each(|_| c = c.windows(2).map(|w| w[1] - w[0]).collect());
                c[0].abs()
            };
            assert_eq!(det.len() - 1, 3 * d - 2, "nominal degree");
            assert!(forward(3 * d - 2) < 1e-10 && forward(3 * d - 3) > 1e-6, "degree {d}");
            assert_eq!(samples_per_interval(d), 3 * d - 2);
        }
    }

    #[test]
    fn freedom_is_counted() {
        let counted = [(3, 1, -1), (3, 2, 5), (2, 1, 2), (4, 2, 2), (5, 3, 5)];
        assert!(counted.iter().all(|&(d, m, free)| freedom_per_interval(d, m) == free));
    }
}
