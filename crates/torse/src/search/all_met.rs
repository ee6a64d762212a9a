//! Panels of all faces that meet: within each face, then across edges at which faces meet at an angle or close.

use super::build::Built;
use super::cover::Limits;
use super::face::{Covered, Met};
use super::joint::Meeting;
use super::stitch::across::{met_across, Across, Beside};
use super::stitch::faces_together::met_together;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::parallel;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Where flat patterns have been proven before strips are to meet: of the time that this took, what is left for them then too, and
/// the most.
const FLAT_AGAIN: (f64, Duration) = (2.0, Duration::from_secs(10));

/// The panels of faces, laid anew where neighbours are to meet: after all faces have panels, so that time that is short goes
/// to covers. With a tolerance (mm) and limits, those of different faces too. Second result: what to leave for the proof of flat
/// patterns. `E` says why a face has no panels.
pub(crate) fn all_met<E: Send>(
    mut found: Vec<Result<Covered, E>>,
    across: Option<(f64, &Limits)>,
    control: &Control,
) -> (Vec<Result<Built, E>>, Duration) {
    let total = found.iter().flatten().filter(|c| c.is_apart()).count();
    let finished = AtomicUsize::new(0);
    let start = Instant::now();
    parallel::for_each(found.iter_mut().flatten(), |c| c.assess_flat(control));
    let flat_time = start.elapsed().mul_f64(FLAT_AGAIN.0).min(FLAT_AGAIN.1);
    if total > 0 {
        control.report("joining strips", 0.0, format!("0 of {total}"));
    }
    let until = control.remaining().map(|left| Instant::now() + left.saturating_sub(flat_time));
    let control = until.map_or_else(|| control.clone(), |end| control.clone().until(end));
    let mut met: Vec<Result<Met, E>> = parallel::map(found.into_iter().enumerate(), |(index, covered)| {
        let covered = covered?;
        let counts = covered.is_apart();
        let met = covered.met(index, &control);
        if counts {
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            control.report("joining strips", n as f64 / total as f64, format!("{n} of {total}"));
        }
        Ok(met)
    });
    if let Some(asked) = across {
        across_faces(&mut met, asked, &control);
    }
    (met.into_iter().map(|m| m.map(|m| m.built)).collect(), flat_time)
}

/// Share of edges that may be left open before the strips of all faces go into one program, which costs as much as all before: with
/// a half, bodies of which every other edge stays open anyway took three times as long and gained nothing.
const MOSTLY: f64 = 0.6;

/// Panels of different faces that meet, where these meet at an angle: as they are, and where that is not enough nearer to their
/// faces beside the edges.
fn across_faces<E: Send>(met: &mut [Result<Met, E>], (tolerance, limits): (f64, &Limits), control: &Control) {
    let joined = |built: &[&Built]| met_across(built, tolerance, limits, control);
    let faces: Vec<(usize, &Met)> = met.iter().enumerate().filter_map(|(k, m)| Some((k, m.as_ref().ok()?))).collect();
    let before: Vec<&Built> = faces.iter().map(|f| &f.1.built).collect();
    let first = joined(&before);
    let mut best: Option<Across> = None;
    for together in [false, true] {
        // What faces can do each for itself costs less, and does for most bodies.
        let edges = &best.as_ref().unwrap_or(&first).edges;
        let open = edges.iter().filter(|e| e.open).count();
        if together && open as f64 <= MOSTLY * edges.len() as f64 {
            break;
        }
        let anew = laid_anew(&faces, &first, together, (tolerance, control));
        if anew.iter().any(Option::is_some) {
            let nearer: Vec<&Built> = before.iter().zip(&anew).map(|(b, l)| l.as_ref().unwrap_or(b)).collect();
            let next = joined(&nearer);
            if next.length > best.as_ref().unwrap_or(&first).length {
                best = Some(next);
            }
        }
    }
    let Across { built, .. } = best.unwrap_or(first);
    met.iter_mut().flatten().zip(built).for_each(|(m, b)| b.into_iter().for_each(|b| m.built = b));
}

/// The panels of faces beside edges at which panels do not meet, laid anew so that they may, in one program over all of them
/// (`together`) or each for itself; none for the others, and for those that cannot be proven.
fn laid_anew(
    faces: &[(usize, &Met)],
    first: &Across,
    together: bool,
    (tolerance, control): (f64, &Control),
) -> Vec<Option<Built>> {
    let open = first.edges.iter().filter(|e| e.open && (together && e.meetings.is_some() || e.counts.is_some()));
    let beside: BTreeSet<usize> = open.flat_map(|e| e.faces).filter(|&f| faces[f].1.is_free()).collect();
    if beside.is_empty() {
        return faces.iter().map(|_| None).collect();
    }
    let are_both = |e: &Beside| together && e.faces.iter().all(|f| beside.contains(f)) && e.meetings.is_some();
    let meetings: Vec<Meeting> =
        first.edges.iter().filter(|e| are_both(e)).filter_map(|e| e.meetings.clone()).flatten().collect();
    // Beside faces that stay as they are distances count for themselves.
    let lower = |face: usize| {
        let alone = first.edges.iter().filter(|e| e.faces.contains(&face) && !are_both(e));
        let mut places: Vec<(Vec3, f64)> = alone.filter_map(|e| e.counts.clone()).flatten().collect();
        places.extend(&first.corners[face]);
        move |x: &Vec3| counts(&places, x, tolerance)
    };
    let borders: Vec<_> = (0..faces.len()).map(lower).collect();
    let side = |f: usize| {
        let (index, met) = faces[f];
        beside.contains(&f).then(|| met.side(index, &borders[f]))?
    };
    if together {
        return met_together((0..faces.len()).map(side).collect(), &meetings, control);
    }
    let alone = |f: usize| met_together(vec![side(f)], &[], control).pop().flatten();
    parallel::map(0..faces.len(), alone)
}

/// Places within this share of the reach of the nearest one count too.
const AS_NEAR: f64 = 1e-3;

/// What a distance counts at a place on a border: as at the nearest of the places that are given, within reach of which it is; the
/// most of those that are as near.
fn counts(lower: &[(Vec3, f64)], x: &Vec3, reach: f64) -> f64 {
    let off = |c: &(Vec3, f64)| (c.0 - x).norm();
    let nearest = lower.iter().map(off).fold(f64::INFINITY, f64::min);
    let near = lower.iter().filter(|c| nearest <= reach && off(c) <= nearest + AS_NEAR * reach);
    near.map(|c| c.1).fold(1.0, f64::max)
}
