//! Minimax fitting of any family of torses: Gauss–Newton steps with Lawson weights first, then sequential linear
//! minimax steps, with exchange of the worst samples. Knows the families only through the trait `Family`.
//!
//! *Departure from the specification* (C1.5, B3.5), which uses Lawson's weights alone: near the optimum the linearised
//! minimax problem is solved by an interior-point method, which costs about ten Lawson steps and ends within a
//! percent of the optimum, where Lawson's weights need dozens.

use crate::control::Control;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::minimax;

/// Share of the tolerance at which a fit is good enough to stop.
pub(crate) const GOAL: f64 = 0.9;

/// Options of [`refit`](super::refit::refit).
#[derive(Clone, Debug)]
pub struct RefitOptions {
    /// Wanted distance, mm: the iteration ends early below it.
    pub tolerance: f64,
    /// Samples that take part at first; 220.
    pub max_samples: usize,
    /// Wanted radius of curvature at the samples, mm; 0. Kept as far as it is at hand.
    pub bend_radius: f64,
    /// Ends the iteration early with the best torse so far; never.
    pub control: Control,
}

impl RefitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_samples: 220, bend_radius: 0.0, control: Control::default() }
    }
}

/// A torse with unknown coefficients near given samples. Lengths are scaled to about unit size.
pub(crate) trait Family {
    /// Number of coefficients.
    fn unknowns(&self) -> usize;
    /// Length of the run of coefficients that one sample depends on.
    fn width(&self) -> usize;
    /// Signed distances of the samples `active` at the coefficients `x`, into `out`; the feet found are remembered as
    /// trial. `false` if a foot is missing or the torse is not regular there.
    fn residuals(&mut self, x: &[f64], active: &[usize], out: &mut Vec<f64>) -> bool;
    /// Adopts the trial feet as the starting points of the next ones.
    fn adopt(&mut self, active: &[usize]);
    /// The starting points of feet, of all samples.
    fn feet(&mut self) -> &mut Vec<f64>;
    /// Which of the samples have no regular foot, or too little room, at the coefficients `x`; adopts the feet of the
    /// others.
    fn irregular(&mut self, x: &[f64], samples: &[usize]) -> Vec<usize>;
    /// Derivatives of the distances at the coefficients and feet last given to `residuals`.
    fn jacobian(&mut self, x: &[f64], active: &[usize], residual: &[f64], rows: &mut Rows);
    /// Soft conditions (gauges, smoothness): rows and their residuals at `x`, balanced against `count` samples whose
    /// largest distance is `error`.
    fn soft(&self, x: &[f64], count: usize, error: f64, rows: &mut Rows, residual: &mut Vec<f64>);
    /// Rows that measure how unevenly a step changes the torse; they act on steps only, so they slow wiggles down but
    /// decide nothing in the end. Weights suit distances of unit weight.
    fn fairness(&self, rows: &mut Rows);
    /// Share of fairness that least-squares steps with equal weights need.
    fn firmness(&self) -> f64;
    /// Share of the step `d` that is short enough for the linearisation, in (0, 1].
    fn step_share(&self, x: &[f64], d: &[f64]) -> f64;
    /// Whether to end early with the best torse so far.
    fn stopped(&self) -> bool {
        false
    }
}

/// Trial lengths of a Gauss–Newton step.
const SHARES: [f64; 4] = [1.0, 0.4, 0.16, 0.064];

/// Damping at first: share of the normal matrix's diagonal that is added to it.
const DAMPING: f64 = 1e-3;
/// Damping at its least: what samples determine is then known to a millionth, and what they do not stays finite.
const LEAST_DAMPING: f64 = 1e-6;
/// Error, as a share of the size, for which the weights of soft conditions are made.
const SUITED: f64 = 1e-3;
/// Share of their weights that they keep where errors vanish: unknowns that no sample sees stay determined.
const LEAST_WEIGHT: f64 = 1e-6;

/// Share of their weights with which soft conditions count: they shrink with the error, so that they never decide it.
pub(super) fn balance(error: f64) -> f64 {
    (error / SUITED).clamp(LEAST_WEIGHT, 1.0)
}

/// A promise to lower the largest distance by less than this share is none: the gap of the linear problem is larger.
const NO_GAIN: f64 = 1e-4;

/// Rounds of exchange, and of repairs: in each, samples join.
const ROUNDS: usize = 4;

/// A fit under way.
pub(crate) struct Descent<'a, F: Family> {
    /// The family.
    pub family: &'a mut F,
    /// Coefficients.
    pub x: Vec<f64>,
    /// Samples that take part.
    pub active: Vec<usize>,
    /// Their distances at `x`.
    pub residual: Vec<f64>,
    /// Largest of them.
    pub worst: f64,
    weights: Vec<f64>,
    /// Whether the weights differ.
    weighted: bool,
    rows: Rows,
    soft_rows: Rows,
    soft_residual: Vec<f64>,
    trial: Vec<f64>,
    trial_x: Vec<f64>,
    step: Vec<f64>,
    matrix: BandMatrix,
    work: minimax::Workspace,
    damping: f64,
    stiffness: f64,
}

impl<'a, F: Family> Descent<'a, F> {
    /// A fit that starts at `x`. `None` if the torse is not regular there.
    pub fn new(family: &'a mut F, x: Vec<f64>, active: Vec<usize>) -> Option<Self> {
        let mut residual = Vec::new();
        if !family.residuals(&x, &active, &mut residual) {
            return None;
        }
        family.adopt(&active);
        let (n, w) = (family.unknowns(), family.width());
        Some(Self {
            worst: largest(&residual),
            weights: vec![1.0; active.len()],
            weighted: false,
            family,
            x,
            active,
            residual,
            rows: Rows::new(n, w),
            soft_rows: Rows::new(n, w),
            soft_residual: Vec::new(),
            trial: Vec::new(),
            trial_x: Vec::new(),
            step: Vec::new(),
            matrix: BandMatrix::zeros(n, w),
            work: minimax::Workspace::new(),
            damping: DAMPING,
            stiffness: 1.0,
        })
    }

    /// Root of the mean squared distance.
    pub fn rms(&self) -> f64 {
        (self.residual.iter().map(|r| r * r).sum::<f64>() / self.residual.len().max(1) as f64).sqrt()
    }

    /// Lawson's rule: weights grow with the distances.
    pub fn reweight(&mut self) {
        // Share of its weight that a sample without distance keeps, and the least weight.
        const KEPT: f64 = 0.05;
        const FLOOR: f64 = 1e-4;
        if self.worst <= 0.0 {
            return;
        }
        self.weighted = true;
        let mut sum = 0.0;
        for (w, r) in self.weights.iter_mut().zip(&self.residual) {
            *w *= KEPT + r.abs() / self.worst;
            sum += *w;
        }
        let scale = self.weights.len() as f64 / sum;
        for w in &mut self.weights {
            *w = (*w * scale).max(FLOOR);
        }
    }

    /// Fills rows, soft rows and the quadratic part of the soft conditions times `scale`.
    /// Fairness counts with the share `firmness` of its weight.
    fn linearise(&mut self, scale: f64, firmness: f64) {
        self.rows.clear();
        self.family.jacobian(&self.x, &self.active, &self.residual, &mut self.rows);
        self.soft_rows.clear();
        self.soft_residual.clear();
        self.family.soft(&self.x, self.active.len(), self.worst, &mut self.soft_rows, &mut self.soft_residual);
        let n = self.family.unknowns();
        self.matrix.clear();
        for i in 0..self.soft_rows.len() {
            self.matrix.add_row(&self.soft_rows, i, scale);
        }
        self.step.clear();
        self.step.resize(n, 0.0);
        for i in 0..self.soft_rows.len() {
            self.soft_rows.scatter(i, scale * self.soft_residual[i], &mut self.step);
        }
        self.soft_rows.clear();
        self.family.fairness(&mut self.soft_rows);
        let stiff = scale * (firmness * self.stiffness).powi(2) * self.active.len() as f64;
        for i in 0..self.soft_rows.len() {
            self.matrix.add_row(&self.soft_rows, i, stiff);
        }
    }

    fn soft_cost(&mut self, x: &[f64]) -> f64 {
        self.soft_rows.clear();
        self.soft_residual.clear();
        self.family.soft(x, self.active.len(), self.worst, &mut self.soft_rows, &mut self.soft_residual);
        self.soft_residual.iter().map(|r| r * r).sum()
    }

    fn cost(&self, residual: &[f64]) -> f64 {
        residual.iter().zip(&self.weights).map(|(r, w)| w * r * r).sum()
    }

    /// Tries `x + share · step`; `true` if regular, with the residuals in `trial`.
    fn attempt(&mut self, share: f64) -> bool {
        self.trial_x.clear();
        self.trial_x.extend(self.x.iter().zip(&self.step).map(|(x, d)| x + share * d));
        self.trial_x.iter().all(|v| v.is_finite())
            && self.family.residuals(&self.trial_x, &self.active, &mut self.trial)
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.x, &mut self.trial_x);
        std::mem::swap(&mut self.residual, &mut self.trial);
        self.worst = largest(&self.residual);
        self.family.adopt(&self.active);
    }

    /// One weighted Gauss–Newton step. `false` if no trial length lowers the cost.
    pub fn gauss_newton(&mut self) -> bool {
        let firmness = if self.weighted { 1.0 } else { self.family.firmness() };
        self.linearise(1.0, firmness);
        for i in 0..self.rows.len() {
            let w = self.weights[i];
            self.matrix.add_row(&self.rows, i, w);
            self.rows.scatter(i, w * self.residual[i], &mut self.step);
        }
        self.stabilise();
        for d in &mut self.step {
            *d = -*d;
        }
        let before = self.cost(&self.residual) + self.soft_residual.iter().map(|r| r * r).sum::<f64>();
        if !self.matrix.factorise() {
            return false;
        }
        self.matrix.solve(&mut self.step);
        let limit = self.family.step_share(&self.x, &self.step);
        for (k, share) in SHARES.into_iter().enumerate() {
            if self.attempt(share * limit) {
                let trial_x = std::mem::take(&mut self.trial_x);
                let soft = self.soft_cost(&trial_x);
                self.trial_x = trial_x;
                if self.cost(&self.trial) + soft < before {
                    self.accept();
                    if k > 0 {
                        self.stiffness *= 4.0;
                    }
                    return true;
                }
            }
        }
        self.stiffness *= 16.0;
        false
    }

    /// A trace of the diagonal keeps coefficients without data at rest.
    fn stabilise(&mut self) {
        const SHARE: f64 = 1e-10;
        let n = self.matrix.size();
        let mean = (0..n).map(|i| self.matrix.diagonal(i)).sum::<f64>() / n.max(1) as f64;
        for i in 0..n {
            self.matrix.add_diagonal(i, SHARE * mean);
        }
    }

    /// One step of the linearised minimax problem with adaptive damping. Result: relative gain of the largest
    /// distance, 0 if none.
    pub fn minimax(&mut self) -> f64 {
        // Gap of the linear problem: well below the gain at which steps end.
        const GAP: f64 = 2e-3;
        // Trials with growing damping and stiffness, before a step is given up.
        const TRIALS: usize = 5;
        let before = self.worst;
        if before <= 0.0 {
            return 0.0;
        }
        for _ in 0..TRIALS {
            if self.family.stopped() {
                return 0.0;
            }
            // Lawson's optimum is that of ½ Σ w r² / e with Σ w = 1, which gives the scale of the soft conditions.
            let scale = 1.0 / (self.active.len() as f64 * before);
            self.linearise(scale, 1.0);
            let n = self.matrix.size();
            let mut squares = vec![0.0; n];
            for i in 0..self.rows.len() {
                let (first, row) = self.rows.row(i);
                for (s, a) in squares[first..].iter_mut().zip(row) {
                    *s += a * a;
                }
            }
            for (i, s) in squares.iter().enumerate() {
                self.matrix.add_diagonal(i, self.damping * scale * s);
            }
            self.stabilise();
            let linear = std::mem::take(&mut self.step);
            let mut step = Vec::new();
            let predicted =
                minimax::step(&self.rows, &self.residual, (&self.matrix, &linear), GAP, &mut self.work, &mut step);
            self.step = step;
            let Some(predicted) = predicted else {
                self.damping = (self.damping * 10.0).max(DAMPING);
                continue;
            };
            if predicted > before * (1.0 - NO_GAIN) {
                return 0.0;
            }
            let limit = self.family.step_share(&self.x, &self.step);
            let mut regular = false;
            for share in [1.0, 0.4] {
                if self.attempt(share * limit) {
                    regular = true;
                    let now = largest(&self.trial);
                    if now < before {
                        let kept = (before - now) / (before - predicted);
                        if kept > 0.75 {
                            self.damping = (0.2 * self.damping).max(LEAST_DAMPING);
                            // With a tenth as the least steps gain more, but torses are less even: a fuselage at
                            // 10 mm got 6 strips for 5, a hypar at 1 mm 23 for 21.
                            self.stiffness = (0.5 * self.stiffness).max(1.0);
                        } else if kept < 0.25 {
                            self.damping *= 5.0;
                            self.stiffness *= 2.0;
                        }
                        self.accept();
                        return (before - now) / before;
                    }
                }
            }
            if regular {
                self.damping *= 25.0;
            }
            self.stiffness *= 4.0;
        }
        0.0
    }

    /// Minimax steps until the gain is small or the largest distance is at most `enough`.
    pub fn polish(&mut self, steps: usize, enough: f64) {
        // A step that gains less ends the fit: the optimum is then within about the same share.
        const SMALL: f64 = 4e-3;
        for _ in 0..steps {
            if self.worst <= enough || self.family.stopped() {
                break;
            }
            if self.minimax() < SMALL {
                if self.stiffness <= 1.0 && self.damping <= DAMPING {
                    break;
                }
                // Earlier trouble may hold the steps back.
                self.stiffness = (0.1 * self.stiffness).max(1.0);
                self.damping = (0.1 * self.damping).max(DAMPING);
            }
        }
    }

    /// Minimax over `all` samples: polishes, looks at all, takes the worst in, again. The largest distance over all is
    /// the result; `None` if the torse is not regular at some sample that did not take part.
    pub fn exchange(&mut self, all: &[usize], rounds: usize, enough: f64) -> Option<f64> {
        // Samples taken in per round, and the excess over the support's own error that is not worth a round.
        const ADDED: usize = 25;
        const EXCESS: f64 = 1.01;
        const STEPS: usize = 8;
        // Returns towards the start of a round before the start itself is taken again.
        const BACK: usize = 4;
        let mut residual = Vec::new();
        let mut result = None;
        for round in 0..=rounds {
            let start = (self.x.clone(), self.family.feet().clone());
            self.polish(STEPS, enough);
            let mut back = 0;
            let mut bad = Vec::new();
            while !self.family.residuals(&self.x, all, &mut residual) {
                // Not regular at some sample that did not take part: half way back.
                if back == BACK {
                    return result;
                }
                if back == 0 {
                    bad = self.family.irregular(&self.x, all);
                }
                back += 1;
                self.family.feet().clone_from(&start.1);
                for (x, s) in self.x.iter_mut().zip(&start.0) {
                    *x = if back == BACK { *s } else { 0.5 * (*x + s) };
                }
            }
            self.family.adopt(all);
            let worst = largest(&residual);
            result = Some(worst);
            if back > 0 {
                // Where it was not regular it will be watched.
                let stride = bad.len().div_ceil(ADDED).max(1);
                self.include(bad.into_iter().step_by(stride));
            }
            if round == rounds || worst <= enough || worst <= EXCESS * self.worst || self.family.stopped() {
                break;
            }
            let mut beyond: Vec<(f64, usize)> =
                residual.iter().zip(all).map(|(r, &i)| (r.abs(), i)).filter(|b| b.0 > self.worst).collect();
            beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
            // Every second or third of the excess, so that one peak does not take all places.
            let stride = beyond.len().div_ceil(ADDED).max(1);
            self.include(beyond.iter().step_by(stride).map(|b| b.1));
        }
        result
    }

    /// Takes further samples into the fit.
    pub fn include(&mut self, more: impl Iterator<Item = usize>) {
        self.active.extend(more);
        self.active.sort_unstable();
        self.active.dedup();
        self.weights.clear();
        self.weights.resize(self.active.len(), 1.0);
        let mut residual = std::mem::take(&mut self.residual);
        self.family.residuals(&self.x, &self.active, &mut residual);
        self.residual = residual;
        self.worst = largest(&self.residual);
    }
}

/// Largest absolute value.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Gauss–Newton steps, then such steps with Lawson weights; coefficients and largest distance.
pub(crate) fn descended<F: Family>(
    family: &mut F,
    x: Vec<f64>,
    few: &[usize],
    steps: usize,
    weighted: usize,
) -> Option<(Vec<f64>, f64)> {
    // A gain below this share ends the unweighted steps.
    const SMALL: f64 = 0.01;
    let mut d = Descent::new(family, x, few.to_vec())?;
    for _ in 0..steps {
        if d.family.stopped() {
            break;
        }
        let before = d.rms();
        // After a step that failed the next one is stiffer.
        if d.gauss_newton() && d.rms() > (1.0 - SMALL) * before {
            break;
        }
    }
    let mut best = (d.x.clone(), d.worst);
    for _ in 0..weighted {
        d.reweight();
        if d.family.stopped() || !d.gauss_newton() {
            break;
        }
        if d.worst < best.1 {
            best = (d.x.clone(), d.worst);
        }
    }
    let (x, worst) = best;
    let mut residual = Vec::new();
    if family.residuals(&x, few, &mut residual) {
        family.adopt(few);
    }
    Some((x, worst))
}

/// The coefficients `x`, or others found by [`descended`] steps, at which the torse is regular at `all` samples: those
/// where it is not join `few`, and the fit starts again from nearer `safe`. The largest distance among `few` comes along
/// if there were further steps. `None` if this does not end well soon.
pub(crate) fn repaired<F: Family>(
    family: &mut F,
    mut x: Vec<f64>,
    safe: &[f64],
    few: &mut Vec<usize>,
    all: &[usize],
    steps: [usize; 2],
) -> Option<(Vec<f64>, Option<f64>)> {
    // Samples that join per round, and shares of the way back.
    const ADDED: usize = 20;
    const BACK: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];
    let mut worst = None;
    let mut unused = Vec::new();
    for round in 0..=ROUNDS {
        let bad = family.irregular(&x, all);
        if bad.is_empty() {
            return Some((x, worst));
        }
        if round == ROUNDS {
            break;
        }
        few.extend(bad.iter().step_by(bad.len().div_ceil(ADDED)));
        few.sort_unstable();
        few.dedup();
        let start = BACK.iter().find_map(|&back| {
            let x: Vec<f64> = x.iter().zip(safe).map(|(x, s)| x + back * (s - x)).collect();
            family.residuals(&x, few, &mut unused).then_some(x)
        })?;
        let (next, reached) = descended(family, start, few, steps[0], steps[1])?;
        (x, worst) = (next, Some(reached));
    }
    None
}

/// Minimax with exchange over all samples; the largest distance, with `x` replaced.
pub(crate) fn polished<F: Family>(
    family: &mut F,
    x: &mut Vec<f64>,
    few: &[usize],
    all: &[usize],
    goal: f64,
) -> Option<f64> {
    let mut d = Descent::new(family, x.clone(), few.to_vec())?;
    let reached = d.exchange(all, ROUNDS, goal)?;
    *x = d.x;
    Some(reached)
}
