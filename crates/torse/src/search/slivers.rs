//! No slivers: panels that are much narrower than their neighbours, or than the shop can handle, are given to a
//! neighbour, or share the place of one with it, where that can be proven.

use super::build::too_large;
use super::cover::without_sliver;
use super::laid::{Laid, Task};
use std::collections::{BTreeMap, BTreeSet};

/// Share of the mean width of the widest neighbour below which a panel is a sliver, where no least width is asked for.
const SLIVER: f64 = 0.1;

/// Panels without slivers, as far as that can be proven.
pub(super) fn widened(task: &Task, mut laid: Laid) -> Laid {
    // Slivers that nothing could be done about.
    let mut kept = BTreeSet::new();
    while let Some(label) = narrowest(task, &laid, &kept) {
        if task.control.stopped() {
            break;
        }
        let options = task.options_with(&laid.seams);
        let next = without_sliver(task.face, &options, task.control, &laid.state, label);
        let next = next.map(|state| task.laid(state, laid.seams.clone()));
        match next.filter(|n| better(task, n, &laid)) {
            Some(next) => laid = next,
            None => drop(kept.insert(label)),
        }
    }
    laid
}

/// Whether panels are no more than before, all of them good, and fit the sheet.
fn better(task: &Task, next: &Laid, laid: &Laid) -> bool {
    let count = |l: &Laid| l.built.patchwork.panels.len();
    let widths = |l: &Laid| mean_widths(l).into_values().fold(f64::INFINITY, f64::min);
    next.accepted
        && (count(next) < count(laid) || (count(next) == count(laid) && widths(next) > widths(laid)))
        && too_large(&next.built, &task.options.limits).is_empty()
}

/// Mean widths of panels by label, mm.
fn mean_widths(laid: &Laid) -> BTreeMap<u32, f64> {
    let panels = &laid.built.patchwork.panels;
    laid.built.patterns.iter().filter_map(|p| Some((panels[p.panel].label()?, p.mean_width()))).collect()
}

/// The narrowest sliver but for those that must stay.
fn narrowest(task: &Task, laid: &Laid, kept: &BTreeSet<u32>) -> Option<u32> {
    let widths = mean_widths(laid);
    let mut widest: BTreeMap<u32, f64> = BTreeMap::new();
    for (a, b) in laid.state.partition.neighbours().into_keys() {
        for (a, b) in [(a, b), (b, a)] {
            let width = widths.get(&b).copied().unwrap_or(0.0);
            let most = widest.entry(a).or_insert(0.0);
            *most = most.max(width);
        }
    }
    let least = |label: &u32| match task.options.limits.min_width {
        Some(least) => least,
        None => SLIVER * widest.get(label).copied().unwrap_or(0.0),
    };
    let slivers = widths.iter().filter(|(l, w)| !kept.contains(l) && **w < least(l));
    slivers.min_by(|a, b| a.1.total_cmp(b.1)).map(|(l, _)| *l)
}
