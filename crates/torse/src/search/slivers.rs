//! No slivers and no prongs: panels that are much narrower or smaller than their neighbours, or narrower than the shop can
//! handle, are given to a neighbour, or share the place of one with it, where that can be proven; so are narrow parts that
//! reach far beyond the rest of a panel.

use super::build::too_large;
use super::cover::Job;
use super::laid::{Laid, Task};
use crate::num::parallel;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the mean width of the widest neighbour below which a panel is a sliver, where no least width is asked for.
const SLIVER: f64 = 0.1;
/// Share of the area of the largest neighbour below which a panel is a sliver.
const SMALL: f64 = 0.05;

/// Panels without slivers and prongs, as far as that can be proven.
pub(super) fn widened(task: &Task, laid: Laid) -> Laid {
    blunted(task, without_slivers(task, laid))
}

/// Panels without parts narrower than a panel must be.
fn blunted(task: &Task, mut laid: Laid) -> Laid {
    // Nobody could have what one panel alone gives away.
    if count(&laid) == 1 || task.control.stopped() {
        return laid;
    }
    let least = |width: f64| task.options.limits.min_width.unwrap_or(SLIVER * width);
    let all: Vec<(u32, f64)> = sizes(&laid).into_iter().map(|(label, [width, _])| (label, least(width))).collect();
    let pronged = parallel::map(all, |p| laid.cover.region(p.0).has_prong(p.1).then_some(p));
    for (label, width) in pronged.into_iter().flatten() {
        if task.control.stopped() {
            break;
        }
        let options = task.options_with(&laid.seams);
        let next = Job::new(task.face, &options, task.control).without_prong(laid.cover.region(label), width);
        let next = next.map(|cover| task.laid(cover, laid.seams.clone()));
        laid = next.filter(|n| is_good(task, n, &laid)).unwrap_or(laid);
    }
    laid
}

fn without_slivers(task: &Task, mut laid: Laid) -> Laid {
    // Slivers that nothing could be done about.
    let mut kept = BTreeSet::new();
    while let Some(label) = narrowest(task, &laid, &kept) {
        if task.control.stopped() {
            break;
        }
        let options = task.options_with(&laid.seams);
        let next = Job::new(task.face, &options, task.control).without_sliver(laid.cover.region(label));
        let next = next.map(|cover| task.laid(cover, laid.seams.clone()));
        match next.filter(|n| is_better(task, n, &laid)) {
            Some(next) => laid = next,
            None => drop(kept.insert(label)),
        }
    }
    laid
}

fn count(laid: &Laid) -> usize {
    laid.built.patchwork.panels.len()
}

/// Whether panels are no more than before, all of them good, and fit the sheet.
fn is_good(task: &Task, next: &Laid, laid: &Laid) -> bool {
    next.accepted && count(next) <= count(laid) && too_large(&next.built, &task.options.limits).is_empty()
}

/// Whether panels are good, and fewer or wider.
fn is_better(task: &Task, next: &Laid, laid: &Laid) -> bool {
    let widths = |l: &Laid| sizes(l).into_values().map(|s| s[0]).fold(f64::INFINITY, f64::min);
    is_good(task, next, laid) && (count(next) < count(laid) || widths(next) > widths(laid))
}

/// Mean widths (mm) and areas (mm²) of panels by label.
fn sizes(laid: &Laid) -> BTreeMap<u32, [f64; 2]> {
    let panels = &laid.built.patchwork.panels;
    laid.built.patterns.iter().filter_map(|p| Some((panels[p.panel].label()?, [p.mean_width(), p.area]))).collect()
}

/// The narrowest sliver but for those that must stay.
fn narrowest(task: &Task, laid: &Laid, kept: &BTreeSet<u32>) -> Option<u32> {
    let sizes = sizes(laid);
    let mut largest: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
    for (a, b) in laid.cover.partition.neighbours().into_keys() {
        for (a, b) in [(a, b), (b, a)] {
            let [width, area] = sizes.get(&b).copied().unwrap_or_default();
            let most = largest.entry(a).or_default();
            *most = [most[0].max(width), most[1].max(area)];
        }
    }
    let is_sliver = |label: &u32, [width, area]: &[f64; 2]| {
        let [widest, most] = largest.get(label).copied().unwrap_or_default();
        *width < task.options.limits.min_width.unwrap_or(SLIVER * widest) || *area < SMALL * most
    };
    let slivers = sizes.iter().filter(|(l, s)| !kept.contains(l) && is_sliver(l, s));
    slivers.min_by(|a, b| a.1[0].total_cmp(&b.1[0])).map(|(l, _)| *l)
}
