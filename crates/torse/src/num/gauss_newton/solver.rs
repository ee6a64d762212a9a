//! Damped Gauss–Newton steps: increments, gain ratio, a regulariser that falls.

use super::block::Role;
use super::elimination::{substitute, Workspace};
use super::normal_matrix::{NormalMatrix, FROZEN};
use super::status::{Outcome, Residual, Status};
use super::system::{Placed, System, SystemError};
use crate::control::Control;

/// How a solve goes on from step to step. Unknowns are expected to be of the order of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// ε of the first step; default 1e-2 cold, 1e-3 warm.
    pub epsilon: f64,
    /// Factor of ε, and of the weights of soft rows that fade, from step to step; default 0.3 cold, 0.1 warm.
    pub factor: f64,
    /// Least ε; default 1e-5. Weights that fade go on falling.
    pub least: f64,
    /// λ of the first step; default 1e-3 cold, 1e-6 warm.
    pub damping: f64,
    /// Largest absolute value of a hard row that counts as zero; no default.
    pub tolerance: f64,
    /// Largest change of an unknown that counts as settled once ε is at its least; default 1e-3, steady 1e-6.
    pub still: f64,
    /// Iterations at most; default 60 cold and gentle, 20 warm, 50 steady.
    pub iterations: usize,
}

impl Schedule {
    /// For unknowns that are far from a solution.
    pub fn cold(tolerance: f64) -> Self {
        Self {
            epsilon: COLD_EPSILON,
            factor: 0.3,
            least: LEAST_EPSILON,
            damping: COLD_DAMPING,
            tolerance,
            still: FREE_STEP,
            iterations: 60,
        }
    }

    /// For unknowns that soft rows which fade must lead far, as nearest points on a surface do: ε from 3e-2 by 0.6.
    pub fn gentle(tolerance: f64) -> Self {
        Self { epsilon: GENTLE_EPSILON, factor: 0.6, ..Self::cold(tolerance) }
    }

    /// For unknowns near a solution, as after a small move of a handle.
    pub fn warm(tolerance: f64) -> Self {
        Self {
            epsilon: WARM_EPSILON,
            factor: 0.1,
            least: LEAST_EPSILON,
            damping: WARM_DAMPING,
            tolerance,
            still: FREE_STEP,
            iterations: 20,
        }
    }

    /// For rows that are linear but for nearest points: weighted least squares with weights that stay as they are \[W15\],
    /// until nothing moves any more. Soft rows weigh a twentieth of what they say, so that hard ones are nearly kept.
    pub fn steady(tolerance: f64) -> Self {
        Self {
            epsilon: STEADY_EPSILON,
            factor: 1.0,
            least: STEADY_EPSILON,
            damping: WARM_DAMPING,
            tolerance,
            still: STILL,
            iterations: 50,
        }
    }

    /// For unknowns that meet the hard rows and should do best by the soft ones: as [`Schedule::steady`], with a trace of
    /// fairness.
    pub fn close(tolerance: f64) -> Self {
        Self { epsilon: LEAST_EPSILON, least: LEAST_EPSILON, ..Self::steady(tolerance) }
    }
}

/// λ never falls below this: squares of smaller numbers vanish beside one.
const LEAST_DAMPING: f64 = 1e-14;
/// ε of weighted least squares, beside soft rows of weight 0.05 · 0.3: fairness decides where these say nothing.
const STEADY_EPSILON: f64 = 1e-4;
/// Factor of soft rows that fade in weighted least squares, beside hard rows of weight one.
const STEADY_FADE: f64 = 0.05;
/// Change of an unknown that weighted least squares take for none, for unknowns of the order of one.
const STILL: f64 = 1e-6;
/// ε of the first step far from a solution, beside hard rows of weight one: fairness leads where hard rows say nothing.
const COLD_EPSILON: f64 = 1e-2;
/// The same where soft rows must lead far: three times as much, since the unknowns must stay fair on a longer way.
const GENTLE_EPSILON: f64 = 3e-2;
/// The same near a solution: what is fair already needs a tenth of the guidance.
const WARM_EPSILON: f64 = 1e-3;
/// ε at its least, beside hard rows of weight one: its square is far below them and well above the rounding of sums.
const LEAST_EPSILON: f64 = 1e-5;
/// λ of the first step far from a solution, for unknowns of the order of one: its length is not trusted.
const COLD_DAMPING: f64 = 1e-3;
/// λ of the first step near a solution, for unknowns of the order of one: nearly a Newton step, regular all the same.
const WARM_DAMPING: f64 = 1e-6;
/// Refused steps, each with four times the damping, until the solver gives up.
const TRIES: usize = 12;
/// Iterations in which hard rows must fall by [`PROGRESS`].
const PATIENCE: usize = 5;
/// Share by which hard rows must fall within [`PATIENCE`] iterations.
const PROGRESS: f64 = 0.01;
/// A step counts as small below this many square roots of the tolerance: Newton steps square the residual.
const SMALL_STEP: f64 = 1e-3;
/// Once ε is at its least, what still moves is what the hard rows leave free; it counts as settled below this.
const FREE_STEP: f64 = 1e-3;

/// One block with its place in the solver's memory.
pub(super) struct Slot {
    pub placed: Placed,
    /// Columns of the free unknowns, [`FROZEN`] for others.
    pub columns: Vec<u32>,
    /// See [`NormalMatrix::places`].
    pub places: Vec<u32>,
    pub row: usize,
    pub own: usize,
    pub entry: usize,
    pub triangle: usize,
}

/// Values of all unknowns at some time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    shared: Vec<f64>,
    private: Vec<f64>,
}

/// A system with values of its unknowns and all memory that steps need.
pub(crate) struct Solver {
    pub(super) slots: Vec<Slot>,
    pub(super) classes: Vec<String>,
    pub(super) free: Vec<u32>,
    pub(super) matrix: NormalMatrix,
    metric: Vec<(Vec<u32>, Vec<f64>)>,
    pub(super) x: Vec<f64>,
    pub(super) own: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_own: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: Vec<f64>,
    pub(super) triangles: Vec<f64>,
    pub(super) local: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) step_own: Vec<f64>,
    gram: Vec<f64>,
    pub(super) workspace: Workspace,
}

impl Solver {
    /// Sets up memory and structure; `start` are the values of all shared unknowns.
    ///
    /// # Errors
    /// Blocks that name wrong unknowns or are too large, starting values that do not fit, no memory.
    pub fn new(system: System, start: Vec<f64>) -> Result<Self, SystemError> {
        system.check()?;
        let count = system.len();
        if start.len() != count || start.iter().any(|v| !v.is_finite()) {
            return Err(SystemError::Start { given: start.len(), count });
        }
        let mut column = vec![FROZEN; count];
        let free: Vec<u32> = (0..count as u32).filter(|&i| !system.frozen[i as usize]).collect();
        free.iter().enumerate().for_each(|(k, &i)| column[i as usize] = k as u32);
        let of = |unknowns: &[u32]| unknowns.iter().map(|&i| column[i as usize]).collect::<Vec<u32>>();
        let (mut row, mut own, mut entry, mut triangle, mut most) = (0, 0, 0, 0, 0);
        let mut slots = Vec::with_capacity(system.blocks.len());
        for placed in system.blocks {
            let (shared, rows, private) = (placed.block.unknowns().len(), placed.block.rows(), placed.block.private());
            let columns = of(placed.block.unknowns());
            slots.push(Slot { placed, columns, places: Vec::new(), row, own, entry, triangle });
            row += rows;
            own += private;
            entry += rows * (shared + private);
            triangle += private * (private + shared + 1);
            most = most.max(shared);
        }
        let metric: Vec<(Vec<u32>, Vec<f64>)> = system
            .metric
            .iter()
            .map(|(weight, c)| {
                let unknowns: Vec<u32> = c.iter().map(|t| t.0).filter(|&i| (i as usize) < count).collect();
                (of(&unknowns), c.iter().map(|t| t.1 * weight).collect())
            })
            .collect();
        let free_only = |c: &Vec<u32>| c.iter().copied().filter(|&k| k != FROZEN).collect::<Vec<u32>>();
        let lists: Vec<Vec<u32>> =
            slots.iter().map(|s| free_only(&s.columns)).chain(metric.iter().map(|m| free_only(&m.0))).collect();
        let matrix = NormalMatrix::new(free.len(), lists.iter().map(|l| &l[..]))
            .ok_or(SystemError::Matrix { unknowns: free.len() })?;
        for slot in &mut slots {
            slot.places = matrix.places(&slot.columns);
        }
        // Of the metric, the lower halves of the squares are kept.
        let metric = metric
            .into_iter()
            .map(|(columns, c)| {
                let lower = (0..c.len()).flat_map(|p| (0..=p).map(move |q| (p, q))).map(|(p, q)| c[p] * c[q]).collect();
                (matrix.places(&columns), lower)
            })
            .collect();
        let mut solver = Self {
            slots,
            classes: system.classes,
            matrix,
            metric,
            trial: start.clone(),
            x: start,
            own: vec![0.0; own],
            trial_own: vec![0.0; own],
            residual: vec![0.0; row],
            jacobian: vec![0.0; entry],
            triangles: vec![0.0; triangle],
            local: vec![0.0; most],
            step: vec![0.0; free.len()],
            step_own: vec![0.0; own],
            gram: Vec::with_capacity(most * (most + 1) / 2),
            workspace: Workspace::default(),
            free,
        };
        solver.begin();
        Ok(solver)
    }

    /// Values of all shared unknowns.
    pub fn values(&self) -> &[f64] {
        &self.x
    }

    /// Changes the value of an unknown, frozen or free; unknown indices are ignored.
    pub fn set(&mut self, unknown: u32, value: f64) {
        if let Some(x) = self.x.get_mut(unknown as usize) {
            *x = value;
        }
    }

    /// Takes values of all shared unknowns, as many as there are, and starts private ones anew.
    pub fn reset(&mut self, values: &[f64]) {
        if values.len() == self.x.len() {
            self.x.copy_from_slice(values);
            self.begin();
        }
    }

    /// Copies all unknowns, shared and private, into memory that is used again.
    pub fn keep(&self, kept: &mut Kept) {
        kept.shared.clone_from(&self.x);
        kept.private.clone_from(&self.own);
    }

    /// Goes back to unknowns that were kept; nothing happens where they are of another system.
    pub fn restore(&mut self, kept: &Kept) {
        if kept.shared.len() == self.x.len() && kept.private.len() == self.own.len() {
            self.x.copy_from_slice(&kept.shared);
            self.own.copy_from_slice(&kept.private);
        }
    }

    /// Number of free shared unknowns.
    pub fn free(&self) -> usize {
        self.free.len()
    }

    /// Whether the normal equations are banded.
    pub fn is_banded(&self) -> bool {
        self.matrix.is_band()
    }

    /// Name of a class of rows.
    pub fn class_name(&self, class: usize) -> &str {
        self.classes.get(class).map_or("", |c| c)
    }

    /// Gives private unknowns their starting values.
    pub fn begin(&mut self) {
        for slot in &self.slots {
            let block = &slot.placed.block;
            let local = gather(&mut self.local, block.unknowns(), &self.x);
            block.begin(local, &mut self.own[slot.own..slot.own + block.private()]);
        }
    }

    /// Asks all blocks to look anew at what their rows are about.
    fn refresh(&mut self) {
        for slot in &mut self.slots {
            let local = gather(&mut self.local, slot.placed.block.unknowns(), &self.x);
            slot.placed.block.refresh(local);
        }
    }

    /// Steps until the hard rows vanish, or until it is clear that they do not.
    ///
    /// Every accepted step lowers the energy, for the weights and nearest points of that step.
    pub fn solve(&mut self, schedule: &Schedule, control: &Control) -> Outcome {
        let mut lambda = schedule.damping;
        let mut epsilon = schedule.epsilon;
        let mut last_step = f64::INFINITY;
        let mut history = [[f64::INFINITY; 2]; PATIENCE];
        let mut fade = if schedule.factor < 1.0 { 1.0 } else { STEADY_FADE };
        let small = SMALL_STEP * schedule.tolerance.sqrt();
        for iteration in 0..=schedule.iterations {
            if control.stopped() {
                return self.outcome(Status::Cancelled, iteration, last_step);
            }
            self.refresh();
            let energy = self.linearise(epsilon, fade);
            let hard = self.hard();
            control.report("solving", iteration as f64 / schedule.iterations.max(1) as f64, "");
            if let Some(k) = self.flipped() {
                return Outcome { flipped: Some(k), ..self.outcome(Status::Flipped, iteration, last_step) };
            }
            let settled = epsilon <= schedule.least || self.slots.iter().all(|s| matches!(s.placed.role, Role::Hard));
            if hard <= schedule.tolerance && last_step <= if settled { schedule.still } else { small } {
                return self.outcome(Status::Converged, iteration, last_step);
            }
            let earlier = &mut history[iteration % PATIENCE];
            let falls = hard <= (1.0 - PROGRESS) * earlier[0] || energy <= (1.0 - PROGRESS) * earlier[1];
            if settled && hard > schedule.tolerance && !falls {
                return self.outcome(Status::Stalled, iteration, last_step);
            }
            *earlier = if settled { [hard, energy] } else { [f64::INFINITY; 2] };
            if iteration == schedule.iterations {
                break;
            }
            match self.descend(energy, epsilon, fade, &mut lambda) {
                Some(length) => last_step = length,
                None if hard <= schedule.tolerance => {
                    return self.outcome(Status::Converged, iteration, last_step);
                }
                None => return self.outcome(Status::Stalled, iteration, last_step),
            }
            epsilon = (epsilon * schedule.factor).max(schedule.least);
            fade *= schedule.factor;
        }
        self.outcome(Status::MaxIterations, schedule.iterations, last_step)
    }

    /// One accepted step and its largest change of an unknown; `None` if no damping makes the energy fall.
    fn descend(&mut self, energy: f64, epsilon: f64, fade: f64, lambda: &mut f64) -> Option<f64> {
        for _ in 0..TRIES {
            let predicted = self.increment(*lambda, epsilon, fade).map(|left| energy - left);
            if let Some(predicted) = predicted {
                self.try_step(1.0);
                let reached = self.energy_at_trial(epsilon, fade);
                if reached < energy {
                    let gain = (energy - reached) / predicted.max(f64::MIN_POSITIVE);
                    let factor = if gain > 0.75 {
                        0.1
                    } else if gain > 0.25 {
                        0.5
                    } else {
                        2.0
                    };
                    *lambda = (*lambda * factor).max(LEAST_DAMPING);
                    std::mem::swap(&mut self.x, &mut self.trial);
                    std::mem::swap(&mut self.own, &mut self.trial_own);
                    return Some(self.step.iter().fold(0.0, |m: f64, d| m.max(d.abs())));
                }
            }
            *lambda = (*lambda * 4.0).max(LEAST_DAMPING);
        }
        None
    }

    /// Values and derivatives of all rows at the present unknowns; answers the energy.
    pub(super) fn linearise(&mut self, epsilon: f64, fade: f64) -> f64 {
        let mut energy = 0.0;
        for slot in &self.slots {
            let block = &slot.placed.block;
            let (rows, private) = (block.rows(), block.private());
            let local = gather(&mut self.local, block.unknowns(), &self.x);
            let out = &mut self.residual[slot.row..slot.row + rows];
            let end = slot.entry + rows * (local.len() + private);
            let own = &self.own[slot.own..slot.own + private];
            block.evaluate(local, own, out, Some(&mut self.jacobian[slot.entry..end]));
            energy += weight(slot.placed.role, epsilon, fade).powi(2) * out.iter().map(|r| r * r).sum::<f64>();
        }
        energy
    }

    /// Energy at the trial unknowns.
    fn energy_at_trial(&mut self, epsilon: f64, fade: f64) -> f64 {
        let mut out = [0.0; super::block::MOST_ROWS];
        let mut energy = 0.0;
        for slot in &self.slots {
            let block = &slot.placed.block;
            let local = gather(&mut self.local, block.unknowns(), &self.trial);
            let own = &self.trial_own[slot.own..slot.own + block.private()];
            let out = &mut out[..block.rows()];
            block.evaluate(local, own, out, None);
            energy += weight(slot.placed.role, epsilon, fade).powi(2) * out.iter().map(|r| r * r).sum::<f64>();
        }
        energy
    }

    /// Solves for the increments; answers the energy that the linear model promises, `None` if λ was too small.
    fn increment(&mut self, lambda: f64, epsilon: f64, fade: f64) -> Option<f64> {
        self.matrix.clear();
        self.step.fill(0.0);
        for slot in &self.slots {
            let factor = weight(slot.placed.role, epsilon, fade);
            if factor == 0.0 {
                continue;
            }
            let block = &slot.placed.block;
            let (rows, private) = (block.rows(), block.private());
            let width = slot.columns.len() + private;
            self.workspace.load(
                &self.jacobian[slot.entry..slot.entry + rows * width],
                &self.residual[slot.row..slot.row + rows],
                private,
                factor,
                lambda.sqrt(),
            );
            self.workspace.eliminate();
            let kept = self.workspace.triangle();
            self.triangles[slot.triangle..slot.triangle + kept.len()].copy_from_slice(kept);
            gram(&self.workspace, slot, &mut self.gram, &mut self.step);
            self.matrix.add(&slot.places, &self.gram);
        }
        self.matrix.add_diagonal(lambda);
        for (places, lower) in &self.metric {
            self.gram.clear();
            self.gram.extend(lower.iter().map(|v| lambda * v));
            self.matrix.add(places, &self.gram);
        }
        if !self.matrix.factorise() {
            return None;
        }
        self.matrix.solve(&mut self.step);
        self.step.iter().all(|d| d.is_finite()).then(|| self.private_steps(epsilon, fade))
    }

    /// Increments of private unknowns; answers the energy of the linear model.
    fn private_steps(&mut self, epsilon: f64, fade: f64) -> f64 {
        let mut energy = 0.0;
        for slot in &self.slots {
            let factor = weight(slot.placed.role, epsilon, fade);
            let block = &slot.placed.block;
            let (rows, private) = (block.rows(), block.private());
            let width = slot.columns.len() + private;
            let step = &self.step;
            let shared = |j: usize| step.get(slot.columns[j] as usize).copied().unwrap_or(0.0);
            let own = &mut self.step_own[slot.own..slot.own + private];
            if factor == 0.0 {
                own.fill(0.0);
                continue;
            }
            substitute(&self.triangles[slot.triangle..slot.triangle + private * (width + 1)], shared, own);
            for i in 0..rows {
                let row = &self.jacobian[slot.entry + i * width..slot.entry + (i + 1) * width];
                let mut r = self.residual[slot.row + i];
                r += row[..slot.columns.len()].iter().enumerate().map(|(j, v)| v * shared(j)).sum::<f64>();
                r += row[slot.columns.len()..].iter().zip(own.iter()).map(|(v, d)| v * d).sum::<f64>();
                energy += (factor * r).powi(2);
            }
        }
        energy
    }

    /// Fills the trial unknowns: the present ones with a share of the increments.
    pub(super) fn try_step(&mut self, share: f64) {
        self.trial.copy_from_slice(&self.x);
        for (&i, d) in self.free.iter().zip(&self.step) {
            self.trial[i as usize] += share * d;
        }
        for ((t, o), d) in self.trial_own.iter_mut().zip(&self.own).zip(&self.step_own) {
            *t = o + share * d;
        }
    }

    /// Largest absolute value of a hard row as last evaluated.
    pub(super) fn hard(&self) -> f64 {
        self.worst().map_or(0.0, |w| w.1)
    }

    /// Block and value of the largest hard row.
    fn worst(&self) -> Option<(usize, f64)> {
        let hard = self.slots.iter().enumerate().filter(|(_, s)| s.placed.role == Role::Hard);
        let largest = |s: &Slot| {
            let rows = &self.residual[s.row..s.row + s.placed.block.rows()];
            // What is not a number is worse than any number.
            rows.iter().fold(0.0, |m: f64, r| if r.is_nan() { f64::INFINITY } else { m.max(r.abs()) })
        };
        hard.map(|(k, s)| (k, largest(s))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The first block whose unknowns left their side.
    pub(super) fn flipped(&mut self) -> Option<usize> {
        for (k, slot) in self.slots.iter().enumerate() {
            let block = &slot.placed.block;
            let local = gather(&mut self.local, block.unknowns(), &self.x);
            if !block.keeps_side(local, &self.own[slot.own..slot.own + block.private()]) {
                return Some(k);
            }
        }
        None
    }

    /// What is reported at the present unknowns.
    pub(super) fn outcome(&self, status: Status, iterations: usize, last_step: f64) -> Outcome {
        let worst = self.worst().map(|(block, max)| Residual { class: self.slots[block].placed.class, max, block });
        Outcome { status, iterations, residual: self.hard(), worst, flipped: None, last_step }
    }
}

/// Factor of the rows of a role.
fn weight(role: Role, epsilon: f64, fade: f64) -> f64 {
    match role {
        Role::Hard => 1.0,
        Role::Soft { weight, fades: true } => weight * fade,
        Role::Soft { weight, fades: false } => weight,
        Role::Fair { weight } => weight * epsilon,
    }
}

/// Values of some unknowns, in their order.
pub(super) fn gather<'a>(local: &'a mut [f64], unknowns: &[u32], x: &[f64]) -> &'a [f64] {
    let local = &mut local[..unknowns.len()];
    for (l, &i) in local.iter_mut().zip(unknowns) {
        *l = x[i as usize];
    }
    local
}

/// Lower half of `SᵀS` for the reduced rows S of a block, and `−Sᵀr` added to the right-hand side.
pub(super) fn gram(workspace: &Workspace, slot: &Slot, lower: &mut Vec<f64>, right: &mut [f64]) {
    let n = slot.columns.len();
    lower.clear();
    lower.resize(n * (n + 1) / 2, 0.0);
    for row in workspace.reduced() {
        let (s, r) = (&row[..n], row[n]);
        let mut at = 0;
        for p in 0..n {
            if s[p] != 0.0 {
                for (o, v) in lower[at..=at + p].iter_mut().zip(s) {
                    *o += s[p] * v;
                }
                if let Some(b) = right.get_mut(slot.columns[p] as usize) {
                    *b -= s[p] * r;
                }
            }
            at += p + 1;
        }
    }
}
