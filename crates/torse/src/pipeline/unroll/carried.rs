//! Curves, points and texts of the model that lie on parts, drawn on their flat patterns.

use crate::answer::note::{OffFaces, UnrollNote};
use crate::brep::face::Face;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::develop::carried::{Carried, CarryOptions, Path, Skin, Target};
use crate::develop::joints::panel_map;
use crate::develop::refold::atlas::{Atlas, PanelPatch};
use crate::develop::unfold::part::FlatPart;
use crate::develop::view::panels_viewed;
use crate::geom::{BBox, Vec2, Vec3};
use crate::io::model::Model;
use crate::patchwork::pattern::{MarkLine, Pattern};
use crate::search::strips::face_panel::LaidFace;
use rayon::prelude::*;
use std::collections::HashSet;

/// Share of the tolerance within which curves are drawn: half of it for chords and half for points left out.
const DRAWN: f64 = 0.25;
/// Points of a curve off the faces at which its distance is measured at most.
const LOOKS: usize = 64;
/// Points on every span of a panel's border.
const BORDER_POINTS: usize = 16;

/// What stands behind the label of a curve on the other skin of the sheet.
const OTHER_SIDE: &str = "(other side)";

/// What is known of a curve after it was carried over.
#[derive(Default)]
struct Found {
    lines: Vec<(usize, Skin, Vec<Vec2>)>,
    along_edge: bool,
    distance: f64,
    deviation: f64,
    off: Option<OffFaces>,
}

/// Draws the curves of a model on the parts that they lie on, within `tolerance` (mm) of faces; what lies on none is told.
pub(super) fn carry(
    curves: &[FreeCurve],
    (parts, laid): (&mut [FlatPart], &[Option<LaidFace>]),
    faces: &[Face],
    tolerance: f64,
) -> Vec<UnrollNote> {
    if curves.is_empty() {
        return Vec::new();
    }
    let targets: Vec<Option<Target>> = parts.par_iter().zip(laid).map(|(p, l)| target(p, l.as_ref(), faces)).collect();
    let found: Vec<Found> = curves.par_iter().map(|c| one(c, &targets, tolerance)).collect();
    let several = curves.iter().any(|c| c.layer != curves[0].layer);
    let mut layers: HashSet<(usize, Skin, &str)> = HashSet::new();
    let mut drawn: Vec<Vec<MarkLine>> = parts.iter().map(|_| Vec::new()).collect();
    for (curve, found) in curves.iter().zip(&found) {
        let mut labelled: HashSet<(usize, Skin)> = HashSet::new();
        for (part, skin, points) in &found.lines {
            let first = labelled.insert((*part, *skin));
            // Curves without names have that of their layer, once on every part, where it tells something.
            let label = match curve.name.as_str() {
                "" if first && several && layers.insert((*part, *skin, &curve.layer)) => curve.layer.clone(),
                name if first => name.to_owned(),
                _ => String::new(),
            };
            let label = match (first, skin) {
                (true, Skin::Other) => format!("{label} {OTHER_SIDE}").trim_start().to_owned(),
                _ => label,
            };
            drawn[*part].push(MarkLine { label, points: points.clone() });
        }
    }
    for ((part, laid), curves) in parts.iter_mut().zip(laid).zip(drawn) {
        part.pattern.curves = match laid {
            // The panel was laid flat as its face looks, and seen as the part is.
            Some(laid) => {
                let own = Pattern { curves, ..laid.pattern.clone() };
                panels_viewed(&laid.patchwork, vec![own], part.pattern.view).pop().map_or_else(Vec::new, |p| p.curves)
            }
            None => curves,
        };
    }
    notes(curves, &found)
}

/// What is said of them.
fn notes(curves: &[FreeCurve], found: &[Found]) -> Vec<UnrollNote> {
    let mut out = Vec::new();
    let carried = || curves.iter().zip(found).filter(|(_, f)| !f.lines.is_empty());
    let points = carried().filter(|(c, _)| matches!(c.shape, FreeShape::Point(_))).count();
    let whole = carried().count();
    if whole > 0 {
        let worst = |of: fn(&Found) -> f64| found.iter().map(of).fold(0.0, f64::max);
        let (distance, deviation) = (worst(|f| f.distance), worst(|f| f.deviation));
        out.push(UnrollNote::Carried { curves: whole - points, points, distance, deviation });
    }
    let other = |f: &Found| f.lines.iter().any(|l| l.1 == Skin::Other);
    let behind: Vec<String> = curves.iter().zip(found).filter(|(_, f)| other(f)).map(|(c, _)| c.called()).collect();
    if !behind.is_empty() {
        out.push(UnrollNote::OtherSide { curves: behind });
    }
    let along: Vec<String> = curves.iter().zip(found).filter(|(_, f)| f.along_edge).map(|(c, _)| c.called()).collect();
    if !along.is_empty() {
        out.push(UnrollNote::AlongEdges { curves: along });
    }
    let off: Vec<OffFaces> = found.iter().filter_map(|f| f.off.clone()).collect();
    if !off.is_empty() {
        out.push(UnrollNote::OffFaces { curves: off });
    }
    out
}

/// A curve on all parts.
fn one(curve: &FreeCurve, targets: &[Option<Target>], tolerance: f64) -> Found {
    let mut out = Found::default();
    // Of every part the skin that is laid flat, of sheet the other one too.
    let skins = |target: &Target| match target.is_sheet() {
        true => &[Skin::Laid, Skin::Other][..],
        false => &[Skin::Laid],
    };
    let all = targets.iter().enumerate().filter_map(|(k, t)| t.as_ref().map(|t| (k, t)));
    let all = all.flat_map(|(k, t)| skins(t).iter().map(move |skin| (k, t, *skin)));
    match &curve.shape {
        FreeShape::Point(x) => {
            for (k, target, skin) in all {
                let Some((lines, off)) = target.cross(x, tolerance, skin) else { continue };
                out.lines.extend(lines.into_iter().map(|l| (k, skin, l)));
                out.distance = out.distance.max(off);
            }
            if out.lines.is_empty() {
                let farthest = nearest(targets, x);
                out.off = Some(OffFaces { curve: curve.called(), off: 0.0, length: 0.0, farthest });
            }
        }
        FreeShape::Curve(pieces) => {
            let path = Path::new(pieces);
            let points = path.points();
            let mut on = vec![false; points.len()];
            for (k, target, skin) in all {
                let options = CarryOptions { within: tolerance, chord: DRAWN * tolerance, skin };
                let Carried { lines, along_edge, distance, deviation, on: own } = target.carried(&path, &options);
                out.lines.extend(lines.into_iter().map(|l| (k, skin, l)));
                out.along_edge |= along_edge;
                out.distance = out.distance.max(distance);
                out.deviation = out.deviation.max(deviation);
                on.iter_mut().zip(own).for_each(|(on, own)| *on |= own);
            }
            out.off = off_faces(curve, (&points, &on), targets);
        }
    }
    out
}

/// What of a curve lies on no part.
fn off_faces(curve: &FreeCurve, (points, on): (&[Vec3], &[bool]), targets: &[Option<Target>]) -> Option<OffFaces> {
    let lost: Vec<&Vec3> = points.iter().zip(on).filter(|(_, on)| !**on).map(|(x, _)| x).collect();
    let every = lost.len() / LOOKS + 1;
    let looked = lost.iter().step_by(every).chain(lost.last());
    let farthest = looked.map(|x| nearest(targets, x)).reduce(f64::max)?;
    let chords = || points.windows(2).zip(on.windows(2)).map(|(w, on)| ((w[1] - w[0]).norm(), on[0] && on[1]));
    let length = chords().map(|c| c.0).sum();
    let off = chords().filter(|c| !c.1).map(|c| c.0).sum();
    Some(OffFaces { curve: curve.called(), off, length, farthest })
}

/// Distance (mm) of a point from the nearest part.
fn nearest(targets: &[Option<Target>], x: &Vec3) -> f64 {
    let mut order: Vec<(f64, &Target)> = targets.iter().flatten().map(|t| (t.away(x), t)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    for (least, target) in order {
        if best <= least {
            break;
        }
        best = best.min(target.distance(x));
    }
    best
}

/// A part with its maps.
fn target(part: &FlatPart, laid: Option<&LaidFace>, faces: &[Face]) -> Option<Target> {
    let leap = part.allowances.iter().map(|a| a.abs()).fold(0.0, f64::max);
    let Some(laid) = laid else {
        let atlas = Atlas::placed(part.faces.iter().map(|f| &faces[*f]).zip(&part.places)).ok()?;
        let target = Target::new(atlas, &part.pattern, leap);
        return Some(match part.sheet.thickness > 0.0 {
            true => target.of_sheet(other_skin(part, faces)),
            false => target,
        });
    };
    let panel = laid.patchwork.panels.get(laid.pattern.panel)?;
    let border = |l: &Vec<crate::patchwork::panel::Coedge>| {
        let mut out = Vec::new();
        for r in l {
            for w in r.trim.knots.breaks().windows(2) {
                let at = |k: usize| w[0] + (w[1] - w[0]) * k as f64 / BORDER_POINTS as f64;
                out.extend((0..BORDER_POINTS).map(|k| r.trim.point(at(k))));
            }
        }
        out
    };
    let patch = PanelPatch {
        name: panel.strip.name.clone(),
        surface: panel.strip.patch.clone(),
        loops: panel.loops().iter().map(border).collect(),
        corners: Vec::new(),
    };
    let map = panel_map(&laid.patchwork, laid.pattern.panel)?;
    Some(Target::new(Atlas::mapped(patch, map), &laid.pattern, leap))
}

/// How far (mm) the other skin of a sheet is along the normals of the faces of a part, as these are in the file.
fn other_skin(part: &FlatPart, faces: &[Face]) -> Vec<f64> {
    let of = |(k, face): (usize, &usize)| {
        let thickness = part.sheet.local.get(k).copied().unwrap_or(part.sheet.thickness);
        // Sheet is behind the outside.
        let inwards = faces[*face].reversed != part.sheet.turned.get(k).copied().unwrap_or(false);
        if inwards {
            thickness
        } else {
            -thickness
        }
    };
    part.faces.iter().enumerate().map(of).collect()
}

/// The curves of a model for every group of its faces: each with the groups whose faces are nearest by their boxes.
pub(super) fn shared(model: &Model, group: &[usize], count: usize) -> Vec<Vec<FreeCurve>> {
    let mut out: Vec<Vec<FreeCurve>> = vec![Vec::new(); count];
    let boxes: Vec<BBox> = model.faces.iter().map(|f| f.surface.bbox()).collect();
    for curve in &model.curves {
        let own = match &curve.shape {
            FreeShape::Point(x) => BBox::of([x]),
            FreeShape::Curve(pieces) => BBox::of(&Path::new(pieces).points()),
        };
        let mut near = vec![f64::INFINITY; count];
        for (b, g) in boxes.iter().zip(group) {
            let gap = (own.min - b.max).sup(&(b.min - own.max)).sup(&Vec3::zeros()).norm();
            near[*g] = near[*g].min(gap);
        }
        let least = near.iter().copied().fold(f64::INFINITY, f64::min);
        for (group, _) in out.iter_mut().zip(&near).filter(|(_, n)| **n <= least) {
            group.push(curve.clone());
        }
    }
    out
}
