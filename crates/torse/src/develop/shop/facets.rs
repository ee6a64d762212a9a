//! Kinks of a part for the press brake, in an order, and how far the kinked part is from the curved one
//! (docs/algorithms/shop.md, "Facets").
//!
//! *Method*. The flat part is folded about its kinks by their angles and laid on the curved part by the best rigid motion;
//! places that belong together are compared. On a circular cylinder of radius R kinked at every angle θ the facets keep the
//! lengths of the arcs, so that they touch a circle of radius (Rθ/2) cot(θ/2): the closed form that tests compare with.

use super::laid::{Laid, Spot};
use super::roll::outlines;
use crate::develop::bends::sagitta;
use crate::develop::refold::compare::{best_motion, samples};
use crate::develop::refold::drawn::FlatPart;
use crate::geom::placement::Placement;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::{Bend, BendSense, Pattern};

/// A kink of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink {
    /// First and last of the lines drawn that it consists of: pieces between holes.
    pub lines: [usize; 2],
    /// How the sheet bends about it.
    pub bend: Bend,
    /// Place in the proposed sequence, from 1: from both ends of the part inwards, by turns.
    pub order: usize,
    /// Distance from the kink before, square to it, through the middle of this one; from the edge of the part for the first,
    /// mm. Not a number where there is nothing to measure from.
    pub from_last: f64,
    /// Length, pieces and holes between them, mm.
    pub length: f64,
    ruling: Spot,
}

impl Kink {
    /// Index of its panel, or face, within the part.
    pub fn panel(&self) -> usize {
        self.ruling.panel
    }
}

/// A part that is kinked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faceted {
    /// Its kinks along the part.
    pub kinks: Vec<Kink>,
    /// Greatest distance of a place of the kinked part from where it is on the curved part, after the best rigid motion, mm;
    /// sampled.
    pub displacement_estimate: f64,
    /// Greatest height of an arc over its facet, mm: R (1 − cos θ/2) with the greatest radius of each kink; sampled.
    pub sagitta_estimate: f64,
}

/// Share of a panel's rulings within which lines are pieces of one.
const ONE_LINE: f64 = 1e-7;

/// The kinks of a part, from the lines of its pattern. `None` for parts without any.
///
/// Of a part of faces that have maps of their own every rolled face is kinked by itself, and compared with itself: its flat image is
/// folded and laid on the surface that is drawn, which is the neutral fibre where there is one.
pub(crate) fn faceted(laid: &Laid, pattern: &Pattern) -> Option<Faceted> {
    let mut kinks = kinks(laid, pattern);
    if kinks.is_empty() {
        return None;
    }
    let mut displacement_estimate = 0.0_f64;
    let groups = if laid.is_of_faces() { laid.all_rolled().into_iter().map(Some).collect() } else { vec![None] };
    let mut first = 0;
    for group in groups {
        let is_own = |k: &&Kink| group.is_none_or(|panel| k.ruling.panel == panel);
        let count = kinks[first..].iter().take_while(is_own).count();
        let own = &mut kinks[first..first + count];
        for (k, kink) in own.iter_mut().enumerate() {
            // 1, 3, 5, … from the first end, 2, 4, 6, … from the last.
            let from_end = count - 1 - k;
            kink.order = first + if k <= from_end { 2 * k + 1 } else { 2 * from_end + 2 };
        }
        let off = if count > 0 { displacement(laid, group, pattern, own) } else { 0.0 };
        // What is not known of one face is not known of the part.
        let known = !off.is_nan() && !displacement_estimate.is_nan();
        displacement_estimate = if known { displacement_estimate.max(off) } else { f64::NAN };
        first += count;
    }
    let sagitta_estimate = kinks.iter().map(|k| sagitta(&k.bend)).fold(0.0, f64::max);
    Some(Faceted { displacement_estimate, sagitta_estimate, kinks })
}

/// Lines of a pattern as kinks: pieces of one ruling together, along the part.
fn kinks(laid: &Laid, pattern: &Pattern) -> Vec<Kink> {
    let mut out: Vec<Kink> = Vec::new();
    for (line, [a, b]) in pattern.rulings.iter().enumerate() {
        let bend = pattern.bend(line);
        let Some(spot) = laid.spot_of(line, &[*a, *b]) else { continue };
        let (first, last) = laid.range(spot.panel);
        let size = last - first;
        match out.last_mut() {
            Some(k) if k.ruling.panel == spot.panel && (k.ruling.t - spot.t).abs() <= ONE_LINE * size => {
                k.lines[1] = line;
                k.length = (b - pattern.rulings[k.lines[0]][0]).norm();
            }
            _ => out.push(Kink {
                lines: [line, line],
                bend,
                order: 0,
                from_last: f64::NAN,
                length: (b - a).norm(),
                ruling: spot,
            }),
        }
    }
    out.retain(|k| k.bend.sense != BendSense::Flat);
    for k in (0..out.len()).rev() {
        let [first, last] = out[k].lines.map(|l| pattern.rulings[l]);
        let middle = (first[0] + last[1]) * 0.5;
        let panel = out[k].ruling.panel;
        let before = k.checked_sub(1).filter(|j| !laid.is_of_faces() || out[*j].ruling.panel == panel);
        let [a, b] = match before {
            Some(j) => pattern.rulings[out[j].lines[0]],
            None if laid.is_of_faces() => laid.ruling(panel, laid.range(panel).0),
            None => laid.ruling(0, laid.range(0).0),
        };
        let from: Option<Vec2> = (b - a).try_normalize(0.0).map(|way| a + way * way.dot(&(middle - a)));
        out[k].from_last = from.map_or(f64::NAN, |f| (middle - f).norm());
    }
    out
}

/// A fold: what lies beyond it is moved by the motion.
struct Folded {
    panel: usize,
    t: f64,
    motion: Placement,
}

/// Folds along a part, each with the motion of what lies between it and the next.
fn folded(laid: &Laid, kinks: &[Kink]) -> Option<Vec<Folded>> {
    let mut motion = Placement::identity();
    let mut out = Vec::with_capacity(kinks.len());
    for k in kinks {
        let [a, b] = laid.ruling(k.ruling.panel, k.ruling.t);
        let along = (b - a).try_normalize(0.0)?;
        // Onwards: towards the rulings that follow, or away from those before.
        let (lo, hi) = laid.range(k.ruling.panel);
        let next = if k.ruling.t < 0.5 * (lo + hi) { (hi, 1.0) } else { (lo, -1.0) };
        let middle = |t: f64| {
            let [a, b] = laid.ruling(k.ruling.panel, t);
            (a + b) * 0.5
        };
        let ahead = (middle(k.ruling.t + (next.0 - k.ruling.t) * STEP) - middle(k.ruling.t)) * next.1;
        let onwards = (ahead - along * along.dot(&ahead)).try_normalize(0.0)?;
        let up = if k.bend.sense == BendSense::Up { k.bend.angle } else { -k.bend.angle };
        // About onwards × up, so that onwards turns to the eye.
        let axis = Vec3::new(onwards.y, -onwards.x, 0.0);
        let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), up);
        let foot = Vec3::new(a.x, a.y, 0.0);
        let own = Placement { linear: *turn.matrix(), shift: foot - turn * foot };
        motion = motion.after(&own);
        out.push(Folded { panel: k.ruling.panel, t: k.ruling.t, motion });
    }
    Some(out)
}

/// Share of the way to a panel's end by which the direction onwards is looked for.
const STEP: f64 = 1e-3;

/// Share of the size of a part within which its neutral fibre is at one depth.
const ONE_DEPTH: f64 = 1e-9;

/// The depth (mm) of the surface that is drawn below a panel; `None` where it is not the same everywhere, so that this surface is not
/// at one distance from the panel and the folded pattern has nothing exact to be compared with.
fn depth(laid: &Laid, panel: usize) -> Option<f64> {
    let all = laid.stations(panel).filter_map(|t| laid.depth(panel, t)).map(|d| d.0);
    let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    (hi - lo <= ONE_DEPTH * laid.size()).then_some(lo)
}

/// See [`Faceted::displacement_estimate`]; not a number where nothing can be compared. Of one face, or of a part whose panels follow
/// each other.
fn displacement(laid: &Laid, group: Option<usize>, pattern: &Pattern, kinks: &[Kink]) -> f64 {
    let Some(folds) = folded(laid, kinks) else { return f64::NAN };
    let joints = pattern.contours.iter().map(|c| c.vertices.iter().map(|v| v.point).collect()).collect();
    let mut part = FlatPart { loops: outlines(pattern, laid.size()), joints, ..FlatPart::default() };
    let mut below = 0.0;
    if let Some((panel, face)) = group.and_then(|k| Some((k, laid.face(k)?))) {
        let Some(found) = depth(laid, panel) else { return f64::NAN };
        below = found;
        let loops = face.region.loops.clone();
        part = FlatPart { joints: loops.clone(), loops, ..part };
    }
    let pairs: Vec<(Vec3, Vec3)> = samples(&part)
        .into_iter()
        .filter_map(|q| {
            let spot = group.map_or_else(|| laid.spot(&q), |k| laid.spot_on(k, &q))?;
            let before = folds.partition_point(|f| (f.panel, f.t) < (spot.panel, spot.t));
            let here = Vec3::new(q.x, q.y, 0.0);
            let there = before.checked_sub(1).map_or(here, |k| folds[k].motion.point(&here));
            let normal = laid.depth(spot.panel, spot.t)?.1;
            Some((there, laid.space(&spot) - normal * below))
        })
        .collect();
    let Some(motion) = best_motion(&pairs) else { return f64::NAN };
    pairs.iter().map(|(p, q)| (motion.point(p) - q).norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::bends::Facets;
    use crate::develop::shop::specimens::{cone, cylinder, faceted_pattern, part_of};

    #[test]
    fn a_kinked_cylinder_is_as_far_off_as_geometry_says() {
        let turn = 1.6;
        for (count, turned) in [(4, false), (8, true), (16, false)] {
            let (patchwork, pattern) = faceted_pattern(vec![cylinder("a", 0.0, turn)], 1.0, Some(Facets::Count(count)));
            let pattern = if turned { pattern.turned_over() } else { pattern };
            let laid = Laid::of(&patchwork, &part_of(1), &pattern).expect("maps");
            let found = faceted(&laid, &pattern).expect("kinks");
            assert_eq!(found.kinks.len(), count);
            let step = turn / count as f64;
            assert!(found.kinks.iter().all(|k| (k.bend.angle - step).abs() < 1e-6), "{:?}", found.kinks[0]);
            assert!((found.sagitta_estimate - 100.0 * (1.0 - (0.5 * step).cos())).abs() < 1e-6);
            // Facets touch a circle that is smaller by R (1 − (θ/2) cot(θ/2)) ≈ R θ²/12; corners stand as far out as half of it.
            let inwards = 100.0 * (1.0 - 0.5 * step / (0.5 * step).tan());
            let off = found.displacement_estimate;
            assert!((0.4..2.0).contains(&(off / inwards)), "{off} {inwards}");
            // Distances: half a facet from the edge, then whole ones.
            let facet = 100.0 * step;
            assert!((found.kinks[0].from_last - 0.5 * facet).abs() < 0.02 * facet, "{}", found.kinks[0].from_last);
            assert!(found.kinks[1..].iter().all(|k| (k.from_last - facet).abs() < 0.02 * facet));
        }
    }

    #[test]
    fn arcs_stay_as_low_as_asked_for_at_both_ends() {
        for height in [1.0, 0.1] {
            let (_, pattern) = faceted_pattern(vec![cone("a", 0.0, 1.6)], 1.0, Some(Facets::Chord(height)));
            let worst = pattern.bends.iter().map(sagitta).fold(0.0, f64::max);
            assert!(worst <= height && worst > 0.5 * height, "{worst} {height}");
        }
    }

    #[test]
    fn the_sequence_goes_from_both_ends_inwards() {
        let (patchwork, pattern) =
            faceted_pattern(vec![cone("a", 0.0, 1.0), cone("b", 1.0, 1.5)], 1.0, Some(Facets::Count(5)));
        let laid = Laid::of(&patchwork, &part_of(2), &pattern).expect("maps");
        let found = faceted(&laid, &pattern).expect("kinks");
        let order: Vec<usize> = found.kinks.iter().map(|k| k.order).collect();
        assert_eq!(order, [1, 3, 5, 4, 2]);
        assert!(found.displacement_estimate > 0.0 && found.displacement_estimate < found.sagitta_estimate * 2.0);
    }
}
