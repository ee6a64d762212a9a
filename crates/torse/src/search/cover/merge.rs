//! Cuts in the middle, covers by two, and merging of neighbours (C6, C7).

use super::covered_face::Cover;
use super::job::Job;
use super::march::REST;
use super::region::{Density, Region};
use crate::num::hash::{HashMap, HashSet};
use crate::torse::form::Ruling;
use std::sync::Arc;

/// Directions and bisection steps of the search for two panels.
const TWO_DIRECTIONS: usize = 4;
const TWO_STEPS: usize = 4;

impl Job<'_> {
    /// Two panels with a plane cut between them, if that is enough.
    pub(super) fn two(&self, region: Region) -> Option<Cover> {
        let (mean, axes) = region.axes();
        for k in 0..TWO_DIRECTIONS {
            let angle = std::f64::consts::PI * k as f64 / TWO_DIRECTIONS as f64;
            let direction = axes[0] * angle.cos() + axes[1] * angle.sin();
            let (mut lo, mut hi) = region.extent(&mean, &direction);
            for _ in 0..TWO_STEPS {
                if self.control.stopped() {
                    return None;
                }
                let at = 0.5 * (lo + hi);
                let mut trial = region.cover.clone();
                let Some(parts) = trial.cut_across(region.label, &mean, &direction, at) else {
                    break;
                };
                let [low, high] = parts[..] else { break };
                let (a, b) = (self.single(trial.region(low), None), self.single(trial.region(high), None));
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
    pub(super) fn absorbed(&self, region: Region, but: Option<u32>) -> Option<Cover> {
        self.around(region).into_iter().filter(|n| Some(n.label) != but).find_map(|n| {
            let mut trial = region.joined_to(n.label);
            let fit = n.fit()?;
            let samples = trial.region(n.label).dense_samples(Density::Usual);
            let (error, worst) = crate::fit::near::samples::error(&fit.torse, &samples)?;
            let fit = crate::fit::near::samples::Fit { error, worst, ..(**fit).clone() };
            let proven = self.proven(trial.region(n.label), fit, samples).accepted?;
            trial.panels.insert(n.label, proven);
            Some(trial)
        })
    }

    /// A region without a panel and a neighbour covered by one new panel, if that is enough.
    pub(super) fn as_one(&self, region: Region) -> Option<Cover> {
        self.around(region).into_iter().find_map(|n| {
            let mut trial = region.joined_to(n.label);
            let fit = self.single(trial.region(n.label), None).accepted?;
            trial.panels.insert(n.label, fit);
            Some(trial)
        })
    }

    /// A region without a panel and a neighbour covered by two new panels of equal extent, if that is enough.
    pub(super) fn shared(&self, region: Region) -> Option<Cover> {
        self.around(region).into_iter().find_map(|n| {
            let mut trial = region.joined_to(n.label);
            trial.panels.remove(&n.label);
            self.two(trial.region(n.label))
        })
    }

    /// Neighbours of a region that have panels and may be joined with it, those with the longest common border first.
    fn around<'b>(&self, region: Region<'b>) -> Vec<Region<'b>> {
        let beside = region.neighbours().into_iter().map(|n| region.cover.region(n));
        beside.filter(|n| n.fit().is_some() && region.is_on_same_side_as(*n, &self.options.layout.seams)).collect()
    }

    /// Centre line of the larger of two bands of one function, for both together.
    fn common_line(&self, joined: Region, [a, b]: [Region; 2]) -> Option<Vec<Ruling>> {
        let (f, g) = (a.band()?, b.band()?);
        if !Arc::ptr_eq(f, g) {
            return None;
        }
        let wide = if a.area() > b.area() { a } else { b };
        let (lo, hi) = wide.range(f);
        Some(self.centre(joined, f, 0.5 * (lo + hi)))
    }

    /// Merges adjacent panels as long as single torses fit their unions.
    pub(super) fn merged(&self, mut cover: Cover) -> Cover {
        let mut failed: HashSet<(u32, u32)> = HashSet::default();
        loop {
            let areas: HashMap<u32, f64> = cover.panels.keys().map(|&l| (l, cover.region(l).area())).collect();
            let mut pairs: Vec<((u32, u32), f64)> = cover
                .partition
                .neighbours()
                .into_iter()
                .filter(|(p, shared)| *shared >= 2 && !failed.contains(p))
                .filter(|((a, b), _)| cover.region(*a).is_on_same_side_as(cover.region(*b), &self.options.layout.seams))
                // Panels along curves stay as they were laid.
                .filter(|((a, b), _)| !cover.origins.contains_key(a) && !cover.origins.contains_key(b))
                .filter_map(|((a, b), _)| Some(((a, b), areas.get(&a)? + areas.get(&b)?)))
                .collect();
            pairs.sort_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)));
            let mut done = true;
            for ((a, b), _) in pairs {
                if self.control.stopped() {
                    return cover;
                }
                let mut trial = cover.region(b).joined_to(a);
                let small = areas[&a].min(areas[&b]) < REST * areas[&a].max(areas[&b]);
                let line = small.then(|| self.common_line(trial.region(a), [a, b].map(|l| cover.region(l)))).flatten();
                let t = self.single(trial.region(a), line.as_deref());
                if let Some(fit) = t.accepted {
                    trial.panels.remove(&b);
                    trial.panels.insert(a, Arc::clone(&fit));
                    failed.retain(|&(x, y)| x != a && y != a && x != b && y != b);
                    cover = trial;
                    done = false;
                    break;
                }
                failed.insert((a, b));
            }
            if done {
                return cover;
            }
        }
    }
}
