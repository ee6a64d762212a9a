//! Marks on joints: both panels of a joint carry the same labels at the same places, as both sides of a seam do.

use super::arcs::PlaneCurve;
use super::map::Development;
use super::outline::FlatCoedge;
use super::pattern::{developed, MARK_SPACING};
use crate::geom::{Vec2, Vec3};
use crate::patchwork::joint::{foot, joints, JointSide};
use crate::patchwork::panel::Patchwork;
use crate::patchwork::pattern::{Mark, MarkPlace, Pattern};
use std::collections::HashMap;

/// Patterns with marks on the common edges of faces, "S7.1 62.3deg" on both sides: the number of the seam and the angle between
/// the panels, as on seams inside faces.
pub(crate) fn with_marks_across(patchwork: &Patchwork, mut patterns: Vec<Pattern>) -> Vec<Pattern> {
    let of_panel: HashMap<usize, usize> = patterns.iter().enumerate().map(|(k, p)| (p.panel, k)).collect();
    let diagonal = patchwork.faces.iter().map(|f| f.surface.bbox().diagonal()).fold(0.0, f64::max);
    let mut maps: HashMap<usize, Option<(Development, bool)>> = HashMap::new();
    for seam in patchwork.seams().iter().filter(|s| s.seam as usize >= patchwork.seam_count) {
        for side in &seam.sides {
            maps.entry(side.panel).or_insert_with(|| map(patchwork, side.panel));
        }
        let count = mark_count(seam.length(), diagonal);
        for k in 1..=count {
            let s = k as f64 / (count + 1) as f64;
            let label = format!("S{}.{k} {:.1}deg", seam.seam, seam.kink(s).to_degrees());
            let on = |i: usize| {
                let (development, mirrored) = maps[&seam.sides[i].panel].as_ref()?;
                let side = JointSide { panel: seam.sides[i].panel, run: seam.sides[i].run };
                let at = if i == 0 { s } else { seam.opposite(s) };
                let mark = mark(patchwork, &side, at, (development, *mirrored), &label)?;
                Some((*of_panel.get(&side.panel)?, Mark { on: MarkPlace::Seam, ..mark }))
            };
            // On both sides or on none.
            if let Some(marks) = on(0).zip(on(1)) {
                [marks.0, marks.1].into_iter().for_each(|(k, mark)| patterns[k].marks.push(mark));
            }
        }
    }
    patterns
}

/// Patterns with marks on joints, "J3.1" on both sides; `reach` (mm) is how far from each other the borders of panels may
/// be that are joined: each is within its deviation of the file's edge. Panels that cannot be developed get none.
pub(crate) fn with_joint_marks(patchwork: &Patchwork, mut patterns: Vec<Pattern>, reach: f64) -> Vec<Pattern> {
    let diagonal = patchwork.faces.iter().map(|f| f.surface.bbox().diagonal()).fold(0.0, f64::max);
    let found = joints(patchwork, reach, MARK_SPACING * diagonal);
    let of_panel: HashMap<usize, usize> = patterns.iter().enumerate().map(|(k, p)| (p.panel, k)).collect();
    let mut maps: HashMap<usize, Option<(Development, bool)>> = HashMap::new();
    for (number, joint) in found.iter().enumerate() {
        let both = joint.sides.iter().all(|s| of_panel.contains_key(&s.panel));
        for side in joint.sides.iter().filter(|_| both) {
            maps.entry(side.panel).or_insert_with(|| map(patchwork, side.panel));
        }
        if !both || joint.sides.iter().any(|s| maps[&s.panel].is_none()) {
            continue;
        }
        for (k, pair) in joint.pairs.iter().enumerate() {
            let label = format!("{}.{}", joint_name(number), k + 1);
            let [p, q] = [0, 1].map(|i: usize| Vec3::from(joint.sides[i].run.edge.point(pair[i])));
            let on = |i: usize| {
                let (side, s) = (&joint.sides[i], pair[i]);
                let (development, mirrored) = maps[&side.panel].as_ref()?;
                let mark = mark(patchwork, side, s, (development, *mirrored), &label)?;
                Some(Mark { apart: (p - q).norm(), ..mark })
            };
            // On both sides or on none.
            let Some(marks) = on(0).zip(on(1)) else { continue };
            for (side, mark) in joint.sides.iter().zip([marks.0, marks.1]) {
                patterns[of_panel[&side.panel]].marks.push(mark);
            }
        }
    }
    patterns
}

/// Marks on one side of a seam or joint at most.
const MOST_MARKS: f64 = 9.0;

/// Number of marks on either side of a joint so long (mm), of parts whose largest face has a box of this diagonal (mm).
pub(crate) fn mark_count(length: f64, diagonal: f64) -> usize {
    (length / (MARK_SPACING * diagonal).max(f64::MIN_POSITIVE)).round().clamp(1.0, MOST_MARKS) as usize
}

/// Name of a joint by its number, counted from 0: what the labels of its marks have in common.
pub(crate) fn joint_name(number: usize) -> String {
    format!("J{}", number + 1)
}

/// Places in the plane of places in space on the outline of a panel, each with the unit vector into the panel. `None` where the panel
/// cannot be developed.
pub(crate) fn places_on_outline(patchwork: &Patchwork, panel: usize, places: &[Vec3]) -> Option<Vec<(Vec2, Vec2)>> {
    let (development, mirrored) = map(patchwork, panel)?;
    let runs: Vec<_> = patchwork.panels[panel].loops().iter().flatten().filter(|r| !r.is_point()).collect();
    let on = |x: &Vec3| {
        let feet = runs.iter().map(|run| (*run, foot(run, x)));
        let (run, (s, _)) = feet.min_by(|a, b| a.1 .1.total_cmp(&b.1 .1))?;
        let mark = mark(patchwork, &JointSide { panel, run }, s, (&development, mirrored), "")?;
        Some((mark.point, mark.inward))
    };
    places.iter().map(on).collect()
}

/// The map of a panel to the plane.
pub(crate) fn panel_map(patchwork: &Patchwork, panel: usize) -> Option<Development> {
    map(patchwork, panel).map(|m| m.0)
}

/// The map of a panel to the plane, and whether its outline runs the other way round there.
fn map(patchwork: &Patchwork, panel: usize) -> Option<(Development, bool)> {
    let p = patchwork.panels.get(panel)?;
    let (development, _) = developed(patchwork, p).ok()?;
    let runs = p.loops().iter().flatten().filter(|r| !r.is_point());
    let origin = Vec2::zeros();
    let area: f64 = runs.map(|r| FlatCoedge::new(&development, &p.strip.patch, r).flat_area(&origin)).sum();
    Some((development, area < 0.0))
}

fn mark(
    patchwork: &Patchwork,
    side: &JointSide,
    s: f64,
    (development, mirrored): (&Development, bool),
    label: &str,
) -> Option<Mark> {
    let run = FlatCoedge::new(development, &patchwork.panels[side.panel].strip.patch, side.run);
    let t = if mirrored { -run.velocity(s) } else { run.velocity(s) };
    let inward = Vec2::new(-t.y, t.x).try_normalize(0.0)?;
    Some(Mark { point: run.place(s), inward, label: label.to_owned(), on: MarkPlace::Joint, apart: 0.0 })
}
