//! The smallest largest distance under a quadratic price: `min τ + ½ Σ w (g + Jx)² + ½ r|x|²` with `|d + Dx| ≤ τ`,
//! `|x| ≤ limits` and `Rx ≤ room`.
//!
//! *Method*: Mehrotra's predictor and corrector \[NW06, 14.2 and 16.6\]. The Newton matrix is that of the price and of
//! weighted rows of D, in blocks, bordered by τ, which is eliminated last. Primal points stay feasible. Rows with the same columns
//! are dense matrices together: 57 000 rows of a saddle with 33 strips make 2 400 of them.

use super::block_matrix::{BlockMatrix, Structure};
use super::runs::{Bundles, Runs};

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

/// Iterations at most; regular programs need 10 to 30, and what others have come to by then leads nowhere.
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
    /// The minimum; `None` for numbers that are not finite, without rows, or if it is not reached after so many iterations.
    pub fn solve(&self) -> Option<Minimum> {
        let (m, n) = (self.hard.len(), self.limits.len());
        if m == 0 || n == 0 {
            return None;
        }
        let structure = Structure::new(&self.groups, &[&self.hard, &self.soft, &self.bounded]);
        let rows = Rows::new(self);
        let mut price = BlockMatrix::zeros(&structure);
        let mut gradient = vec![0.0; n];
        price.add(&rows.soft, &rows.weights);
        rows.soft.scatter(&rows.pulls, &mut gradient);
        (0..n).for_each(|j| price.add_diagonal(j, self.ridge));
        let mut matrix = price.clone();
        let mut x = vec![0.0; n];
        let mut tau = ROOM.0 * self.distances.iter().fold(0.0, |a: f64, d| a.max(d.abs())) + ROOM.1;
        let even = 0.5 / m as f64;
        let mut slack = rows.slacks(&self.limits, tau);
        let mean = even * slack[0].iter().chain(&slack[1]).sum::<f64>() / (2 * m) as f64;
        let limits: Vec<f64> = self.limits.iter().map(|u| mean / u).collect();
        let room = rows.room.iter().map(|r| mean / r).collect();
        let mut z: All = [vec![even; m], vec![even; m], limits.clone(), limits, room];
        let total = (2 * m + 2 * n + rows.room.len()) as f64;
        for iteration in 0..ITERATIONS {
            let gap: f64 = pairs(&slack, &z).map(|(s, z)| s * z).sum();
            let rest = rows.residual((&x, self.ridge), &z, &gradient);
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
            let mut border = vec![0.0; n];
            let both =
                |sign: f64| -> Vec<f64> { weight[0].iter().zip(&weight[1]).map(|(a, b)| a + sign * b).collect() };
            let sums = both(1.0);
            let corner = sums.iter().sum();
            matrix.add(&rows.hard, &sums);
            rows.hard.scatter(&both(-1.0), &mut border);
            (0..n).for_each(|j| matrix.add_diagonal(j, weight[2][j] + weight[3][j]));
            matrix.add(&rows.bounded, &weight[4]);
            if !matrix.factorise() {
                return (iteration > 0).then_some(Minimum { x, largest: tau, iterations: iteration });
            }
            let mut bent = border.clone();
            matrix.solve(&mut bent);
            let newton = Newton { matrix: &matrix, border: &border, bent: &bent, corner, rest: &rest };
            // 2. Predictor, corrector.
            let aim = families(|k| slack[k].iter().zip(&z[k]).map(|(s, z)| -s * z).collect());
            let (dx, dt) = newton.step(&rows, &slack, &z, &aim);
            let (ds, dz) = rows.changes(&dx, dt, &slack, &z, &aim);
            let share = reach(&slack, &ds).min(reach(&z, &dz)).min(1.0);
            let left: f64 = (0..FAMILIES)
                .flat_map(|k| (0..slack[k].len()).map(move |i| (k, i)))
                .map(|(k, i)| (slack[k][i] + share * ds[k][i]) * (z[k][i] + share * dz[k][i]))
                .sum();
            let centre = (left / gap).powi(3) * gap / total;
            let aim = families(|k| {
                (0..slack[k].len()).map(|i| centre - slack[k][i] * z[k][i] - ds[k][i] * dz[k][i]).collect()
            });
            let (dx, dt) = newton.step(&rows, &slack, &z, &aim);
            let (ds, dz) = rows.changes(&dx, dt, &slack, &z, &aim);
            let share = (SHORT * reach(&slack, &ds).min(reach(&z, &dz))).min(1.0);
            // 3. The step.
            x.iter_mut().zip(&dx).for_each(|(x, d)| *x += share * d);
            tau += share * dt;
            for k in 0..FAMILIES {
                z[k].iter_mut().zip(&dz[k]).for_each(|(z, d)| *z += share * d);
                slack[k].iter_mut().zip(&ds[k]).for_each(|(s, d)| *s += share * d);
            }
        }
        None
    }
}

/// The rows of a program by their columns; what belongs to them is in the same order.
struct Rows {
    hard: Bundles,
    soft: Bundles,
    bounded: Bundles,
    distances: Vec<f64>,
    /// Weights w of the rows J, and w times g.
    weights: Vec<f64>,
    pulls: Vec<f64>,
    room: Vec<f64>,
}

impl Rows {
    fn new(program: &MinimaxProgram) -> Self {
        let [hard, soft] = [&program.hard, &program.soft].map(Bundles::new);
        // What limits keep anyway is left out: two thirds of the rows of a roof of 21 strips.
        let most = |(first, row): (usize, &[f64])| -> f64 {
            row.iter().zip(&program.limits[first..]).map(|(a, limit)| a.abs() * limit).sum()
        };
        let kept = |i: usize| program.bounded.row(i).map(most).sum::<f64>() <= program.room[i];
        let bounded = Bundles::chosen(&program.bounded, |i| !kept(i));
        let (weights, pulls) = soft.ordered(&program.price).into_iter().map(|(w, g)| (w, w * g)).unzip();
        let (distances, room) = (hard.ordered(&program.distances), bounded.ordered(&program.room));
        Self { hard, soft, bounded, distances, weights, pulls, room }
    }

    /// Slacks where nothing has changed yet.
    fn slacks(&self, limits: &[f64], tau: f64) -> All {
        [
            self.distances.iter().map(|d| tau - d).collect(),
            self.distances.iter().map(|d| tau + d).collect(),
            limits.to_vec(),
            limits.to_vec(),
            self.room.clone(),
        ]
    }

    /// Minus the gradient of the Lagrange function, for unknowns and the price of each.
    fn residual(&self, (x, ridge): (&[f64], f64), z: &All, gradient: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = (0..x.len()).map(|j| -gradient[j] - ridge * x[j] - z[2][j] + z[3][j]).collect();
        let priced: Vec<f64> = self.soft.products(x).iter().zip(&self.weights).map(|(j, w)| -w * j).collect();
        self.soft.scatter(&priced, &mut out);
        self.hard.scatter(&z[1].iter().zip(&z[0]).map(|(b, a)| b - a).collect::<Vec<_>>(), &mut out);
        self.bounded.scatter(&z[4].iter().map(|z| -z).collect::<Vec<_>>(), &mut out);
        out
    }

    /// Changes of slacks and multipliers with a step.
    fn changes(&self, dx: &[f64], dt: f64, slack: &All, z: &All, aim: &All) -> (All, All) {
        let along = self.hard.products(dx);
        let ds: All = [
            along.iter().map(|a| dt - a).collect(),
            along.iter().map(|a| dt + a).collect(),
            dx.iter().map(|d| -d).collect(),
            dx.to_vec(),
            self.bounded.products(dx).iter().map(|a| -a).collect(),
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
    fn step(&self, rows: &Rows, slack: &All, z: &All, aim: &All) -> (Vec<f64>, f64) {
        let part = |k: usize, i: usize| aim[k][i] / slack[k][i];
        let mut right = self.rest.to_vec();
        // The multipliers of both sides of all rows sum to one.
        let mut last = 1.0;
        let pulls: Vec<f64> = (0..z[0].len())
            .map(|i| {
                let (a, b) = (part(0, i), part(1, i));
                last -= z[0][i] + z[1][i] + a + b;
                b - a
            })
            .collect();
        rows.hard.scatter(&pulls, &mut right);
        right.iter_mut().enumerate().for_each(|(j, r)| *r += part(3, j) - part(2, j));
        rows.bounded.scatter(&(0..z[4].len()).map(|i| -part(4, i)).collect::<Vec<_>>(), &mut right);
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
