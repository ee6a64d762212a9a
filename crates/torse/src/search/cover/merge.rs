//! Cuts in the middle, covers by two, and merging of neighbours (C6, C7).

use super::job::Job;
use super::march::REST;
use super::state::{Density, State};
use crate::fit::near::dual::CentrePoint;
use crate::num::hash::{HashMap, HashSet};
use std::sync::Arc;

/// Directions and bisection steps of the search for two panels.
const TWO_DIRECTIONS: usize = 4;
const TWO_STEPS: usize = 4;

impl State {
    /// The same state with the region `label` given to `to`.
    fn joined(&self, label: u32, to: u32) -> State {
        let mut next = self.clone();
        next.partition.labels.iter_mut().filter(|l| **l == label).for_each(|l| *l = to);
        next
    }
}

impl Job<'_> {
    /// Two panels with a plane cut between them, if that is enough.
    pub(super) fn two(&self, state: &State, label: u32) -> Option<State> {
        let (mean, axes) = state.axes_of_region(label);
        for k in 0..TWO_DIRECTIONS {
            let angle = std::f64::consts::PI * k as f64 / TWO_DIRECTIONS as f64;
            let direction = axes[0] * angle.cos() + axes[1] * angle.sin();
            let along: Vec<f64> = state
                .partition
                .region_vertices(label)
                .into_iter()
                .map(|v| direction.dot(&(state.jets[v as usize].jet.p - mean)))
                .collect();
            let (mut lo, mut hi) =
                along.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
            for _ in 0..TWO_STEPS {
                if self.control.stopped() {
                    return None;
                }
                let at = 0.5 * (lo + hi);
                let mut trial = state.clone();
                let Some(parts) = trial.cut_across(label, &mean, &direction, at) else {
                    break;
                };
                let [low, high] = parts[..] else { break };
                let (a, b) = (self.single(&trial, low, None), self.single(&trial, high, None));
                match (a.accepted, b.accepted) {
                    (Some(a), Some(b)) => {
                        trial.panels.insert(low, a);
                        trial.panels.insert(high, b);
                        return Some(trial);
                    }
                    (None, None) => break,
                    (None, _) => hi = at,
                    (_, None) => lo = at,
                }
            }
        }
        None
    }

    /// Gives a region without a panel to a neighbour whose torse is good for both, but for one that must not have it: the
    /// end of slivers that are too thin to be panels.
    pub(super) fn absorbed(&self, state: &State, label: u32, but: Option<u32>) -> Option<State> {
        self.around(state, label).into_iter().filter(|n| Some(*n) != but).find_map(|n| {
            let mut trial = state.joined(label, n);
            let fit = state.panels.get(&n)?;
            let samples = trial.dense_samples(n, Density::Usual);
            let (error, worst) = crate::fit::near::samples::error(&fit.torse, &samples)?;
            let fit = crate::fit::near::samples::Fit { error, worst, ..(**fit).clone() };
            let proven = self.proven(&trial, n, fit, samples).accepted?;
            trial.panels.insert(n, proven);
            Some(trial)
        })
    }

    /// A region without a panel and a neighbour covered by one new panel, if that is enough.
    pub(super) fn as_one(&self, state: &State, label: u32) -> Option<State> {
        self.around(state, label).into_iter().find_map(|n| {
            let mut trial = state.joined(label, n);
            let fit = self.single(&trial, n, None).accepted?;
            trial.panels.insert(n, fit);
            Some(trial)
        })
    }

    /// A region without a panel and a neighbour covered by two new panels of equal extent, if that is enough.
    pub(super) fn shared(&self, state: &State, label: u32) -> Option<State> {
        self.around(state, label).into_iter().find_map(|n| {
            let mut trial = state.joined(label, n);
            trial.panels.remove(&n);
            self.two(&trial, n)
        })
    }

    /// Neighbours of a region that have panels and may be joined with it, those with the longest common border first.
    fn around(&self, state: &State, label: u32) -> Vec<u32> {
        let mut around: Vec<(usize, u32)> = state
            .partition
            .neighbours()
            .into_iter()
            .filter(|((a, b), _)| *a == label || *b == label)
            .map(|((a, b), shared)| (shared, if a == label { b } else { a }))
            .filter(|(_, n)| state.panels.contains_key(n) && state.same_side(&self.options.layout.seams, label, *n))
            .collect();
        around.sort_unstable_by(|x, y| y.cmp(x));
        around.into_iter().map(|a| a.1).collect()
    }

    /// Centre line of the larger of two bands of one function, for both together (region `both[0]` of `joined`).
    fn common_line(&self, state: &State, joined: &State, both: [u32; 2]) -> Option<Vec<CentrePoint>> {
        let [f, g] = [state.bands.get(&both[0])?, state.bands.get(&both[1])?];
        if !Arc::ptr_eq(f, g) {
            return None;
        }
        let wide = if state.area(both[0]) > state.area(both[1]) { both[0] } else { both[1] };
        let (lo, hi) = state.range(wide, f);
        Some(self.centre(joined, both[0], f, 0.5 * (lo + hi)))
    }

    /// Merges adjacent panels as long as single torses fit their unions.
    pub(super) fn merged(&self, mut state: State) -> State {
        let mut failed: HashSet<(u32, u32)> = HashSet::default();
        loop {
            let areas: HashMap<u32, f64> = state.panels.keys().map(|&l| (l, state.area(l))).collect();
            let mut pairs: Vec<((u32, u32), f64)> = state
                .partition
                .neighbours()
                .into_iter()
                .filter(|(p, shared)| *shared >= 2 && !failed.contains(p))
                .filter(|((a, b), _)| state.same_side(&self.options.layout.seams, *a, *b))
                // Panels along curves stay as they were laid.
                .filter(|((a, b), _)| !state.origins.contains_key(a) && !state.origins.contains_key(b))
                .filter_map(|((a, b), _)| Some(((a, b), areas.get(&a)? + areas.get(&b)?)))
                .collect();
            pairs.sort_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)));
            let mut done = true;
            for ((a, b), _) in pairs {
                if self.control.stopped() {
                    return state;
                }
                let mut trial = state.joined(b, a);
                let small = areas[&a].min(areas[&b]) < REST * areas[&a].max(areas[&b]);
                let line = small.then(|| self.common_line(&state, &trial, [a, b])).flatten();
                let t = self.single(&trial, a, line.as_deref());
                if let Some(fit) = t.accepted {
                    trial.panels.remove(&b);
                    trial.panels.insert(a, Arc::clone(&fit));
                    failed.retain(|&(x, y)| x != a && y != a && x != b && y != b);
                    state = trial;
                    done = false;
                    break;
                }
                failed.insert((a, b));
            }
            if done {
                return state;
            }
        }
    }
}
