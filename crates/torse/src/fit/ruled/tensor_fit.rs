//! Tensor-product splines near scattered values, by least squares with a trace of fairness, as all systems of \[W15, 2\].

use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::knots::Knots;

/// A value to be met at parameters (s, t).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target<const D: usize> {
    /// Parameters.
    pub at: [f64; 2],
    /// Value.
    pub value: [f64; D],
    /// Weight of the square.
    pub weight: f64,
}

/// Control points (row-major) of the spline with least squares of distances to targets and of changes of slope between
/// control points, the latter with the weight `fair` per target; `None` if that leaves something open.
pub(crate) fn tensor_fit<const D: usize>(
    knots: [&Knots; 2],
    targets: &[Target<D>],
    fair: f64,
) -> Option<Vec<[f64; D]>> {
    let [ks, kt] = knots;
    let (n, row) = (ks.control_count(), kt.control_count());
    let (p, q) = (ks.degree(), kt.degree());
    let size = n * row;
    let width = (2.max(p) * row + 2.max(q) + 1).min(size);
    let mut rows = Rows::new(size, width);
    let mut matrix = BandMatrix::zeros(size, width);
    let mut right = vec![[0.0; D]; size];
    let mut one = |entries: &[(usize, f64)], value: &[f64; D], weight: f64| {
        rows.clear();
        let least = entries.iter().map(|e| e.0).min().unwrap_or(0);
        let (start, line) = rows.push(least);
        for &(k, x) in entries {
            line[k - start] += x;
        }
        matrix.add_row(&rows, 0, weight);
        for &(k, x) in entries {
            for d in 0..D {
                right[k][d] += weight * x * value[d];
            }
        }
    };
    let mut entries = Vec::new();
    for t in targets {
        let (a, b) = (ks.basis(t.at[0], 0), kt.basis(t.at[1], 0));
        entries.clear();
        for i in 0..=p {
            for j in 0..=q {
                entries.push(((a.first + i) * row + b.first + j, a.rows[0][i] * b.rows[0][j]));
            }
        }
        one(&entries, &t.value, t.weight);
    }
    let fair = fair * targets.len().max(1) as f64 / size as f64;
    for (knots, step, lines, next) in [(ks, row, row, 1), (kt, 1, n, row)] {
        for bend in slope_changes(knots) {
            for l in 0..lines {
                let entries = bend.map(|(k, x)| (k * step + l * next, x));
                one(&entries, &[0.0; D], fair);
            }
        }
    }
    if !matrix.factorise() {
        return None;
    }
    let mut out = vec![[0.0; D]; size];
    let mut column = vec![0.0; size];
    for d in 0..D {
        column.iter_mut().zip(&right).for_each(|(c, r)| *c = r[d]);
        matrix.solve(&mut column);
        out.iter_mut().zip(&column).for_each(|(o, c)| o[d] = *c);
    }
    out.iter().flatten().all(|x| x.is_finite()).then_some(out)
}

/// For every three neighbouring control points their shares in the change of slope, times the mean distance of their
/// Greville abscissae: zero for linear functions.
pub(crate) fn slope_changes(knots: &Knots) -> Vec<[(usize, f64); 3]> {
    let (p, n) = (knots.degree(), knots.control_count());
    let g: Vec<f64> = (0..n).map(|i| knots.values()[i + 1..=i + p].iter().sum::<f64>() / p.max(1) as f64).collect();
    (1..n.max(1) - 1)
        .filter_map(|i| {
            let (a, b) = (g[i] - g[i - 1], g[i + 1] - g[i]);
            let h = 0.5 * (a + b);
            (a > 0.0 && b > 0.0).then(|| [(i - 1, h / a), (i, -h / a - h / b), (i + 1, h / b)])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_functions_are_met_and_continued() {
        let (ks, kt) =
            (Knots::uniform(3, 5, 0.0, 2.0).expect("knots"), Knots::uniform(3, 2, -1.0, 1.0).expect("knots"));
        let f = |s: f64, t: f64| [2.0 * s - t, 0.3 + t];
        let targets: Vec<Target<2>> = (0..60)
            .map(|k| [0.1 + 0.9 * (0.37 * f64::from(k)).fract(), 0.8 * (0.61 * f64::from(k)).fract() - 0.6])
            .map(|at| Target { at, value: f(at[0], at[1]), weight: 1.0 })
            .collect();
        let c = tensor_fit([&ks, &kt], &targets, 1e-6).expect("a fit");
        let map = crate::patchwork::foot_map::FootMap { knots_s: ks, knots_t: kt, control: c };
        for at in [[0.5, 0.1], [1.9, 0.9], [0.0, -1.0]] {
            let (x, y) = (map.jet(at[0], at[1]).p, f(at[0], at[1]));
            assert!((0..2).all(|d| (x[d] - y[d]).abs() < 1e-6), "{x:?} {y:?}");
        }
    }
}
