//! The smallest largest distance under a quadratic price: `min τ + ½ Σ w (g + Jx)² + ½ r|x|²` with `|d + Dx| ≤ τ`,
//! `|x| ≤ limits` and `Rx ≤ room`.
//!
//! *Method*: Mehrotra's predictor and corrector \[NW06, 14.2 and 16.6\]. The Newton matrix is that of the price and of
//! weighted rows of D, in blocks, bordered by τ, which is eliminated last. Primal points stay feasible.

use super::block_matrix::{BlockMatrix, Runs, Structure};

/// A program; lengths in units of the distance that matters.
#[derive(Clone, Debug, Default)]
pub(crate) struct MinimaxProgram {
    /// Sizes of groups of neighbouring unknowns of which few occur together.
    pub groups: Vec<usize>,
    /// Rows D.
    pub hard: Runs,
    /// Distances d.
    pub distances: Vec<f64>,
    /// Rows J.
    pub soft: Runs,
    /// Weights w and residuals g of the rows J.
    pub price: Vec<(f64, f64)>,
    /// Price r of every unknown, positive.
    pub ridge: f64,
    /// Largest size of every unknown, positive.
    pub limits: Vec<f64>,
    /// Rows R.
    pub bounded: Runs,
    /// What each of the rows R may grow by, positive.
    pub room: Vec<f64>,
}

/// The minimum of a program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Minimum {
    /// Unknowns.
    pub x: Vec<f64>,
    /// Largest distance.
    pub largest: f64,
    /// Newton matrices factorised.
    pub iterations: usize,
}

/// Iterations at most; regular programs need 15 to 30.
const ITERATIONS: usize = 60;
/// Share of the way to the boundary that a step takes.
const SHORT: f64 = 0.995;
/// Sum of slacks times multipliers at the end: an upper bound of what is left to gain.
const SETTLED: f64 = 1e-5;
/// Largest component of the gradient's residual at the end.
const BALANCED: f64 = 1e-5;
/// The first τ against the largest distance, and on top of it.
const ROOM: (f64, f64) = (1.2, 0.1);

/// Slacks or multipliers of rows above and below, of limits above and below, of bounded rows.
type All = [Vec<f64>; FAMILIES];
const FAMILIES: usize = 5;

impl MinimaxProgram {
    /// The minimum; `None` for numbers that are not finite, or without rows.
    pub fn solve(&self) -> Option<Minimum> {
        let (m, n) = (self.hard.len(), self.limits.len());
        if m == 0 || n == 0 {
            return None;
        }
        let structure = Structure::new(&self.groups, &[&self.hard, &self.soft, &self.bounded]);
        let mut price = BlockMatrix::zeros(&structure);
        let mut gradient = vec![0.0; n];
        for (i, &(w, g)) in self.price.iter().enumerate() {
            price.add_row(&self.soft, i, w);
            self.soft.scatter(i, w * g, &mut gradient);
        }
        (0..n).for_each(|j| price.add_diagonal(j, self.ridge));
        let mut matrix = price.clone();
        let mut x = vec![0.0; n];
        let mut tau = ROOM.0 * self.distances.iter().fold(0.0, |a: f64, d| a.max(d.abs())) + ROOM.1;
        let even = 0.5 / m as f64;
        let mut slack = self.slacks(&x, tau);
        let mean = even * slack[0].iter().chain(&slack[1]).sum::<f64>() / (2 * m) as f64;
        let limits: Vec<f64> = self.limits.iter().map(|u| mean / u).collect();
        let room = self.room.iter().map(|r| mean / r).collect();
        let mut z: All = [vec![even; m], vec![even; m], limits.clone(), limits, room];
        let total = (2 * m + 2 * n + self.room.len()) as f64;
        for iteration in 0..ITERATIONS {
            let gap: f64 = pairs(&slack, &z).map(|(s, z)| s * z).sum();
            let rest = self.residual(&x, &z, &gradient);
            let unbalanced = rest.iter().fold(0.0, |a: f64, r| a.max(r.abs()));
            if !gap.is_finite() || !unbalanced.is_finite() {
                return None;
            }
            if gap < SETTLED && unbalanced < BALANCED {
                return Some(Minimum { x, largest: tau, iterations: iteration });
            }
            // 1. The Newton matrix.
            matrix.assign(&price);
            let weight: All = families(|k| z[k].iter().zip(&slack[k]).map(|(z, s)| z / s).collect());
            let (mut border, mut corner) = (vec![0.0; n], 0.0);
            for i in 0..m {
                let (a, b) = (weight[0][i], weight[1][i]);
                matrix.add_row(&self.hard, i, a + b);
                self.hard.scatter(i, a - b, &mut border);
                corner += a + b;
            }
            (0..n).for_each(|j| matrix.add_diagonal(j, weight[2][j] + weight[3][j]));
            (0..self.room.len()).for_each(|i| matrix.add_row(&self.bounded, i, weight[4][i]));
            if !matrix.factorise() {
                return (iteration > 0).then_some(Minimum { x, largest: tau, iterations: iteration });
            }
            let mut bent = border.clone();
            matrix.solve(&mut bent);
            let newton = Newton { matrix: &matrix, border: &border, bent: &bent, corner, rest: &rest };
            // 2. Predictor, corrector.
            let aim = families(|k| slack[k].iter().zip(&z[k]).map(|(s, z)| -s * z).collect());
            let (dx, dt) = newton.step(self, &slack, &z, &aim);
            let (ds, dz) = self.changes(&dx, dt, &slack, &z, &aim);
            let share = reach(&slack, &ds).min(reach(&z, &dz)).min(1.0);
            let left: f64 = (0..FAMILIES)
                .flat_map(|k| (0..slack[k].len()).map(move |i| (k, i)))
                .map(|(k, i)| (slack[k][i] + share * ds[k][i]) * (z[k][i] + share * dz[k][i]))
                .sum();
            let centre = (left / gap).powi(3) * gap / total;
            let aim = families(|k| {
                (0..slack[k].len()).map(|i| centre - slack[k][i] * z[k][i] - ds[k][i] * dz[k][i]).collect()
            });
            let (dx, dt) = newton.step(self, &slack, &z, &aim);
            let (ds, dz) = self.changes(&dx, dt, &slack, &z, &aim);
            let share = (SHORT * reach(&slack, &ds).min(reach(&z, &dz))).min(1.0);
            // 3. The step.
            x.iter_mut().zip(&dx).for_each(|(x, d)| *x += share * d);
            tau += share * dt;
            for k in 0..FAMILIES {
                z[k].iter_mut().zip(&dz[k]).for_each(|(z, d)| *z += share * d);
                slack[k].iter_mut().zip(&ds[k]).for_each(|(s, d)| *s += share * d);
            }
        }
        Some(Minimum { x, largest: tau, iterations: ITERATIONS })
    }

    fn slacks(&self, x: &[f64], tau: f64) -> All {
        let at: Vec<f64> = (0..self.hard.len()).map(|i| self.distances[i] + self.hard.dot(i, x)).collect();
        [
            at.iter().map(|d| tau - d).collect(),
            at.iter().map(|d| tau + d).collect(),
            self.limits.iter().zip(x).map(|(u, x)| u - x).collect(),
            self.limits.iter().zip(x).map(|(u, x)| u + x).collect(),
            self.room.iter().enumerate().map(|(i, r)| r - self.bounded.dot(i, x)).collect(),
        ]
    }

    /// Minus the gradient of the Lagrange function.
    fn residual(&self, x: &[f64], z: &All, gradient: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = (0..x.len()).map(|j| -gradient[j] - self.ridge * x[j] - z[2][j] + z[3][j]).collect();
        for (i, &(w, _)) in self.price.iter().enumerate() {
            self.soft.scatter(i, -w * self.soft.dot(i, x), &mut out);
        }
        for i in 0..self.hard.len() {
            self.hard.scatter(i, z[1][i] - z[0][i], &mut out);
        }
        z[4].iter().enumerate().for_each(|(i, z)| self.bounded.scatter(i, -z, &mut out));
        out
    }

    /// Changes of slacks and multipliers with a step.
    fn changes(&self, dx: &[f64], dt: f64, slack: &All, z: &All, aim: &All) -> (All, All) {
        let along: Vec<f64> = (0..self.hard.len()).map(|i| self.hard.dot(i, dx)).collect();
        let ds: All = [
            along.iter().map(|a| dt - a).collect(),
            along.iter().map(|a| dt + a).collect(),
            dx.iter().map(|d| -d).collect(),
            dx.to_vec(),
            (0..self.room.len()).map(|i| -self.bounded.dot(i, dx)).collect(),
        ];
        let dz = families(|k| (0..ds[k].len()).map(|i| (aim[k][i] - z[k][i] * ds[k][i]) / slack[k][i]).collect());
        (ds, dz)
    }
}

/// The factorised Newton matrix with its border.
struct Newton<'a> {
    matrix: &'a BlockMatrix<'a>,
    border: &'a [f64],
    /// The border times the inverse of the matrix.
    bent: &'a [f64],
    corner: f64,
    rest: &'a [f64],
}

impl Newton<'_> {
    /// The step for products of slacks and multipliers that are to change by `aim`.
    fn step(&self, program: &MinimaxProgram, slack: &All, z: &All, aim: &All) -> (Vec<f64>, f64) {
        let part = |k: usize, i: usize| aim[k][i] / slack[k][i];
        let mut right = self.rest.to_vec();
        // The multipliers of both sides of all rows sum to one.
        let mut last = 1.0;
        for i in 0..z[0].len() {
            let (a, b) = (part(0, i), part(1, i));
            program.hard.scatter(i, b - a, &mut right);
            last -= z[0][i] + z[1][i] + a + b;
        }
        right.iter_mut().enumerate().for_each(|(j, r)| *r += part(3, j) - part(2, j));
        (0..program.room.len()).for_each(|i| program.bounded.scatter(i, -part(4, i), &mut right));
        self.matrix.solve(&mut right);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let dt = (last - dot(self.border, &right)) / (dot(self.border, self.bent) - self.corner);
        right.iter_mut().zip(self.bent).for_each(|(r, b)| *r += dt * b);
        (right, dt)
    }
}

fn families(f: impl FnMut(usize) -> Vec<f64>) -> All {
    std::array::from_fn(f)
}

fn pairs<'a>(a: &'a All, b: &'a All) -> impl Iterator<Item = (f64, f64)> + 'a {
    a.iter().flatten().copied().zip(b.iter().flatten().copied())
}

/// Largest step that keeps all values positive.
fn reach(values: &All, changes: &All) -> f64 {
    pairs(values, changes).filter(|(_, d)| *d < 0.0).map(|(v, d)| -v / d).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(x: f64) -> [f64; 2] {
        [1.0, x]
    }

    /// The straight line nearest to x² on [0, 1] is x − 1/8, off by 1/8.
    #[test]
    fn the_best_line_for_a_parabola() {
        let mut p = MinimaxProgram { groups: vec![2], ridge: 1e-9, limits: vec![3.0; 2], ..Default::default() };
        for i in 0..=200 {
            let x = f64::from(i) / 200.0;
            p.hard.run(0, line(x));
            p.hard.end();
            p.distances.push(-x * x);
        }
        let found = p.solve().expect("a minimum");
        assert!((found.largest - 0.125).abs() < 2e-5, "{}", found.largest);
        assert!((found.x[0] + 0.125).abs() < 1e-3 && (found.x[1] - 1.0).abs() < 1e-3, "{:?}", found.x);
        assert!(found.iterations < 30);
    }

    /// Two lines on neighbouring intervals that must meet where these do: both parabolas' best heights there.
    #[test]
    fn prices_tie_groups_together() {
        let mut p = MinimaxProgram { groups: vec![2, 2], ridge: 1e-9, limits: vec![9.0; 4], ..Default::default() };
        // y = x² on [0, 1] and on [1, 3]: alone off by 1/8 and by 1/2, above the ends by as much.
        for i in 0..=400 {
            let x = 3.0 * f64::from(i) / 400.0;
            p.hard.run(if x < 1.0 { 0 } else { 2 }, line(x));
            p.hard.end();
            p.distances.push(-x * x);
        }
        p.soft.run(0, line(1.0));
        p.soft.run(2, line(1.0).map(|v| -v));
        p.soft.end();
        p.price.push((1e6, 0.0));
        let found = p.solve().expect("a minimum");
        let at = |k: usize| found.x[k] + found.x[k + 1];
        assert!((found.largest - 0.5).abs() < 3e-3 && (at(0) - at(2)).abs() < 1e-4, "{found:?}");
        assert!((at(2) - 0.5).abs() < 1e-2, "{found:?}");
    }

    /// The best line for a parabola again, where it may not go so far down at 0.
    #[test]
    fn bounded_rows_keep_their_room() {
        let mut p = MinimaxProgram { groups: vec![2], ridge: 1e-9, limits: vec![3.0; 2], ..Default::default() };
        for i in 0..=200 {
            let x = f64::from(i) / 200.0;
            p.hard.run(0, line(x));
            p.hard.end();
            p.distances.push(-x * x);
        }
        // The value at 0 stays above −0.05.
        p.bounded.run(0, [-1.0]);
        p.bounded.end();
        p.room.push(0.05);
        let found = p.solve().expect("a minimum");
        assert!((found.x[0] + 0.05).abs() < 1e-4 && found.largest > 0.126, "{found:?}");
    }

    /// Where the price rules, the answer is that of least squares; where limits do, it stays on them.
    #[test]
    fn prices_and_limits_rule() {
        let mut p = MinimaxProgram { groups: vec![1, 1], ridge: 1e-12, limits: vec![2.0, 0.5], ..Default::default() };
        for j in 0..2 {
            p.hard.run(j, [1e-6]);
            p.hard.end();
            p.distances.push(0.0);
            p.soft.run(j, [1.0]);
            p.soft.end();
            p.price.push((1e3, -1.25));
        }
        let found = p.solve().expect("a minimum");
        assert!((found.x[0] - 1.25).abs() < 1e-4 && (found.x[1] - 0.5).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn nothing_and_nonsense_have_no_minimum() {
        assert!(MinimaxProgram::default().solve().is_none());
        let mut p = MinimaxProgram { groups: vec![1], ridge: 1e-9, limits: vec![1.0], ..Default::default() };
        p.hard.run(0, [f64::NAN]);
        p.hard.end();
        p.distances.push(1.0);
        assert!(p.solve().is_none());
    }
}
