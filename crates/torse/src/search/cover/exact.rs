//! What is developable already stays what it is: the torse of the surface itself, tried before any other
//! (docs/algorithms/cover.md, "What is developable already").

use super::covered_face::Cover;
use super::job::{CoverOptions, Job, DISTANCE_SHARE};
use super::region::{Density, Region};
use crate::brep::face::Face;
use crate::brep::rulings::Rulings;
use crate::certify::distance::{distance, DistanceOptions};
use crate::certify::Verdict;
use crate::control::Control;
use crate::fit::near::exact::{exact, ExactOptions};
use crate::fit::near::samples::Fit;
use crate::search::apex::SLACK;
use crate::torse::form::Torse;
use std::sync::Arc;

/// Share of the tolerance below which the torse is not made finer.
const GOAL: f64 = 5e-3;

/// Share of the tolerance at which the proof is aimed: the rest of what it bounds is left for trims and rounding.
const AIM: f64 = 0.3;
/// The proof's bound over a cell in which the normal turns by δ is about this multiple of δ² times the cell's length along
/// the rulings, as measured on cylinders and cones.
const LOSS: f64 = 1.5;
/// Turn of the normal (rad) from line to line of the triangulation at least and at most.
const TURN: (f64, f64) = (0.003, 0.04);
/// Length of cells along the rulings as a share of these, at most: longer ones would ask for more of them across.
const LENGTH: f64 = 1.0 / 8.0;
/// Factor by which the radius of curvature grows over a cell along the rulings, at most: from about 4 on folds
/// cannot be excluded.
const GROWTH: f64 = 2.0;
/// Cells along the rulings of cones are at most so many radii of curvature long: what bounds how normals of rational surfaces turn
/// is coarse where rulings are long against that.
const LONG: f64 = 2.0;
/// Share of the angle between rulings, laid flat, that counts as a turn of the normal: shallow cones bend little, but cells of
/// them that span an eighth of the way round are no good.
const SPREAD: f64 = 0.3;
/// Places between knots where curvatures are looked at.
const PLACES: usize = 32;
/// Cells along a ruling at most.
const MOST_ROWS: usize = 100;

/// Whether a face is developable as it is, within a small share of the tolerance (mm), in a form of its own: measured,
/// not proven.
pub(crate) fn is_developable(face: &Face, tolerance: f64) -> bool {
    // Most faces have no rulings among their parameter lines, which is seen at once.
    let Some(rulings) = Rulings::of(&face.surface, bounds(face), SLACK * tolerance) else { return false };
    let Ok(cover) = Cover::of_face(face, f64::INFINITY) else { return false };
    exact(&rulings, &cover.region(0).samples(), &asked(tolerance)).is_some()
}

/// Whether a face is developable and bends without jumps of its curvature: planes and bends of a plate are not one.
pub(crate) fn is_smoothly_developable(face: &Face, tolerance: f64) -> bool {
    let Some(rulings) = Rulings::of(&face.surface, bounds(face), SLACK * tolerance) else { return false };
    let breaks = rulings.breaks();
    let smooth = breaks[1..breaks.len() - 1].iter().all(|&s| !rulings.bends_anew(s));
    smooth && is_developable(face, tolerance)
}

/// Box around a face's loops in the parameter plane.
fn bounds(face: &Face) -> [f64; 4] {
    let outer = face.loops.iter().flat_map(|l| &l.points);
    let none = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    outer.fold(none, |b, p| [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])])
}

fn asked(tolerance: f64) -> ExactOptions {
    ExactOptions { goal: GOAL * tolerance, accepted: SLACK * tolerance }
}

/// A developable face as one panel, or one for each part into which seams asked for cut it, proven. `None` where it is
/// not developable along its parameter lines, where limits forbid its torse, or where panels shall follow curves.
pub(in crate::search) fn exactly_covered(face: &Face, options: &CoverOptions, control: &Control) -> Option<Cover> {
    if options.facets || !options.layout.curves.is_empty() {
        return None;
    }
    let cover = exactly(exact_regions(face, options, [&[], &[]])?, options, control)?;
    (cover.panels.len() <= options.max_panels).then_some(cover)
}

/// A developable face triangulated along its parameter lines, among them such of constant u and v, and parted along seams asked for and
/// where it touches itself. `None` where it is not developable along its parameter lines.
pub(in crate::search) fn exact_regions(face: &Face, options: &CoverOptions, among: [&[f64]; 2]) -> Option<Cover> {
    let rulings = Rulings::of(&face.surface, bounds(face), SLACK * options.tolerance)?;
    let [u, v] = lines(&rulings, options.tolerance)?;
    let mut cover = Cover::on_lines(face, with_lines(u, among[0]), with_lines(v, among[1])).ok()?;
    cover.partition.split_components(0);
    cover.cut_along_seams(&options.layout, options.tolerance);
    cover.part_where_touching(rulings.is_swapped());
    Some(cover)
}

/// Share of the way between two lines within which a third is left out: triangles beside it would be too thin to be judged.
const BESIDE_LINE: f64 = 0.2;

/// Rising parameters of lines and further ones between them, where these are not next to one that is there.
fn with_lines(mut lines: Vec<f64>, more: &[f64]) -> Vec<f64> {
    for &x in more {
        let k = lines.partition_point(|l| *l < x);
        let Some([lo, hi]) = k.checked_sub(1).and_then(|i| Some([*lines.get(i)?, *lines.get(k)?])) else { continue };
        let share = (x - lo) / (hi - lo);
        if share > BESIDE_LINE && share < 1.0 - BESIDE_LINE {
            lines.insert(k, x);
        }
    }
    lines
}

impl Cover {
    /// Parts regions whose border touches itself, as around holes that touch each other: a panel has one border that does not. Cut
    /// is along the ruling through the place; where holes lie side by side, so that they touch that ruling, across it too.
    fn part_where_touching(&mut self, swapped: bool) {
        let ruling = usize::from(swapped);
        for selects in [ruling, 1 - ruling] {
            let mut labels = self.partition.distinct_labels();
            while let Some(label) = labels.pop() {
                let bounds = self.region(label).bounds();
                let (lo, hi) = (bounds[2 * selects], bounds[2 * selects + 1]);
                let touching = self.partition.touching(label).into_iter();
                let mut places = touching.map(|v| self.partition.vertices[v as usize][selects]);
                // A line beside which all of the region lies parts nothing.
                let Some(place) = places.find(|p| lo < *p && *p < hi) else { continue };
                self.touched = true;
                let fresh = self.partition.fresh_label();
                self.cut(label, fresh, |p| p[selects] - place);
                let pieces = [label, fresh].map(|l| self.region(l).cells().len());
                // What snaps to vertices may part nothing after all.
                if pieces.iter().all(|n| *n > 0) {
                    labels.extend(self.partition.split_components(label));
                    labels.extend(self.partition.split_components(fresh));
                }
            }
        }
    }
}

/// The regions of a developable face with the torses of the surface itself, each as long as its region, proven.
pub fn exactly(mut cover: Cover, options: &CoverOptions, control: &Control) -> Option<Cover> {
    let face = Arc::clone(&cover.face);
    let job = Job::new(&face, options, control);
    for label in cover.partition.distinct_labels() {
        let fit = job.exact(cover.region(label))?;
        cover.panels.insert(label, fit);
    }
    Some(cover)
}

/// Places between two knots with the turn of the normal from the first of them to each.
type Turns = (Vec<f64>, Vec<f64>);

/// Lines of constant u and v of a triangulation on which the proof loses little: at equal turns of the normal across the
/// rulings, and along them at lengths that are short against the radius of curvature there.
fn lines(rulings: &Rulings, tolerance: f64) -> Option<[Vec<f64>; 2]> {
    let breaks = rulings.breaks();
    let (mut radius, mut length) = ([f64::INFINITY; 2], 0.0_f64);
    let mut turns: Vec<Turns> = Vec::new();
    for w in breaks.windows(2) {
        let at: Vec<f64> = (0..=PLACES).map(|k| w[0] + (w[1] - w[0]) * k as f64 / PLACES as f64).collect();
        let mut turn = vec![0.0];
        let mut before = rulings.line(at[0])?;
        for s in at.windows(2) {
            let here = rulings.line(s[1])?;
            let angle = before.normal.angle(&here.normal);
            let breadths = rulings.breadths(0.5 * (s[0] + s[1]))?;
            if angle > f64::EPSILON.sqrt() {
                radius = [0, 1].map(|k: usize| radius[k].min(breadths[k] * (s[1] - s[0]) / angle));
            }
            length = length.max(here.length);
            let spread = SPREAD * before.direction.angle(&here.direction);
            turn.push(turn[turn.len() - 1] + angle.max(spread));
            before = here;
        }
        turns.push((at, turn));
    }
    let along = cells_along_rulings(radius, length, (LENGTH * length).min(AIM * tolerance / (LOSS * TURN.0.powi(2))));
    let longest = along.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max) * length;
    let wanted = (AIM * tolerance / (LOSS * longest)).sqrt();
    let step = if wanted.is_finite() { wanted.clamp(TURN.0, TURN.1) } else { TURN.1 };
    let (lo, hi) = rulings.reach();
    let place = |x: &f64| if *x >= 1.0 { hi } else { lo + (hi - lo) * x };
    Some(rulings.lines(across(&turns, step), along.iter().map(place).collect()))
}

/// Shares of the way along rulings of this `length` (mm) at which cells begin and end, each no longer than `most` (mm). Radii of
/// curvature grow evenly from one end to the other; towards the sharp one cells become shorter.
fn cells_along_rulings(radius: [f64; 2], length: f64, most: f64) -> Vec<f64> {
    let sharp = usize::from(radius[1] < radius[0]);
    let (least, rise) = (radius[sharp], (radius[1 - sharp] - radius[sharp]) / length);
    let mut at = vec![0.0];
    let mut here = 0.0;
    while here < length && at.len() <= MOST_ROWS {
        let grown = (GROWTH - 1.0) * (least + rise * here) / rise;
        here += if grown > 0.0 { most.min(grown).min(LONG * (least + rise * here)) } else { most };
        at.push(here);
    }
    // The last of them ends where the rulings do; a sharp end at their end is seen from there.
    let shares = at.iter().map(|x| if *x == here { 1.0 } else { x / here });
    match sharp {
        0 => shares.collect(),
        _ => shares.rev().map(|x| 1.0 - x).collect(),
    }
}

/// Places at equal turns of about `step` (rad), all knots among them.
fn across(turns: &[Turns], step: f64) -> Vec<f64> {
    let mut out: Vec<f64> = turns.first().map(|t| t.0[0]).into_iter().collect();
    for (at, turn) in turns {
        let count = (turn[PLACES] / step).ceil().max(1.0) as usize;
        for k in 1..count {
            let wanted = turn[PLACES] * k as f64 / count as f64;
            let i = turn.partition_point(|&x| x < wanted).clamp(1, PLACES);
            let share = (wanted - turn[i - 1]) / (turn[i] - turn[i - 1]).max(f64::MIN_POSITIVE);
            out.push(at[i - 1] + (at[i] - at[i - 1]) * share.clamp(0.0, 1.0));
        }
        out.push(at[PLACES]);
    }
    out.dedup();
    out
}

impl Job<'_> {
    /// The torse of a region that is developable already, proven; `None` where it is not, or where limits forbid it.
    fn exact(&self, region: Region) -> Option<Arc<Fit>> {
        let tolerance = self.options.tolerance;
        let surface = &self.face.surface;
        let rulings = Rulings::of(surface, region.bounds(), SLACK * tolerance)?;
        let samples = region.dense_samples(Density::Usual);
        let fit = exact(&rulings, &samples, &asked(tolerance))?;
        // What is proven of cells is too little where the surface itself only just keeps the limit; of panels more is.
        let bends = |end: usize| rulings.least_radius_estimate(end).unwrap_or(f64::INFINITY);
        self.keeps(region, &fit.torse, bends(0).min(bends(1))).then(|| Arc::new(fit))
    }

    /// Whether a torse is proven on a region, keeps to the limits there and has a patch; its least radius of curvature (mm) may be known
    /// otherwise, 0 if it is not.
    pub(super) fn keeps(&self, region: Region, torse: &Torse, bend_radius: f64) -> bool {
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let (triangles, options) = (region.triangles(), DistanceOptions::default());
        let judged = distance(&self.prepared, torse, &triangles, allowed, &options, self.control);
        let limits = &self.options.limits;
        let kept = judged.min_bend_radius.max(bend_radius) >= limits.min_bend_radius.unwrap_or(0.0)
            && judged.regression_clearance >= limits.min_clearance.unwrap_or(0.0);
        let holds = matches!(judged.verdict, Verdict::Holds { .. });
        holds && kept && region.has_patch(torse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::TrimLoop;
    use crate::geom::Vec3;
    use crate::spline::{knots::Knots, surface::Surface};

    /// A square hole that stands on a corner.
    fn hole(middle: [f64; 2], edge: u32) -> TrimLoop {
        let corner = |x: f64, y: f64| [middle[0] + 10.0 * x, middle[1] + 10.0 * y];
        let points = vec![corner(-1.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(0.0, -1.0)];
        TrimLoop { points, edge: (edge..edge + 4).collect() }
    }

    /// The trough z = x²/200 over [0, 100]² with holes.
    fn trough(holes: Vec<TrimLoop>) -> Face {
        let k = |degree| Knots::clamped(degree, &[0.0, 100.0]).expect("knots");
        let row = [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)];
        let points: Vec<Vec3> =
            row.into_iter().flat_map(|(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 100.0, z)]).collect();
        let mut face = Face::untrimmed(Surface::new(k(2), k(1), &points, None).expect("surface"));
        face.loops.extend(holes);
        face
    }

    #[test]
    fn lines_are_added_where_they_are_not_next_to_others() {
        assert_eq!(with_lines(vec![0.0, 1.0, 2.0], &[0.5, 1.1, 1.9, 2.5, 1.4]), [0.0, 0.5, 1.0, 1.4, 2.0]);
    }

    #[test]
    fn regions_are_parted_where_holes_touch() {
        let options = CoverOptions::new(0.1);
        // One above the other along a ruling, side by side, and apart: regions at most.
        let cases = [([50.0, 30.0], 2), ([30.0, 50.0], 4), ([20.0, 20.0], 1)];
        for (first, most) in cases {
            let face = trough(vec![hole(first, 10), hole([50.0, 50.0], 20)]);
            let cover = exactly_covered(&face, &options, &Control::default()).expect("a developable face");
            let labels = cover.partition.distinct_labels();
            assert!((2.min(most)..=most).contains(&labels.len()), "{first:?}: {}", labels.len());
            assert!(labels.iter().all(|l| cover.partition.touching(*l).is_empty()), "{first:?}");
        }
    }
}
