//! Curves, points and texts of the model that lie on parts, drawn on their flat patterns.

use super::covered::Cover;
use super::followed::{one, Found};
use super::targets::target;
use crate::answer::note::{OffFaces, UnrollNote};
use crate::brep::face::Face;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::develop::carried::{Path, Skin, Target};
use crate::develop::unfold::part::FlatPart;
use crate::develop::view::panels_viewed;
use crate::geom::{BBox, Vec3};
use crate::io::model::Model;
use crate::num::parallel;
use crate::patchwork::pattern::{MarkLine, Pattern};
use crate::search::strips::face_panel::LaidFace;
use std::collections::HashSet;

/// What stands behind the label of a curve on the other skin of the sheet.
const OTHER_SIDE: &str = "(other side)";

/// Draws the curves of a model on the parts that they lie on, within `tolerance` (mm) of faces: on `patterns`, those of the parts first,
/// then those of the panels that cover other faces. What lies on none is told.
pub(super) fn carry(
    curves: &[FreeCurve],
    (patterns, covers): (&mut [Pattern], Vec<Cover>),
    (parts, laid, faces): (&[FlatPart], &[Option<LaidFace>], &[Face]),
    tolerance: f64,
) -> Vec<UnrollNote> {
    if curves.is_empty() {
        return Vec::new();
    }
    let mut targets: Vec<Option<Target>> = parallel::map(parts.iter().zip(laid), |(p, l)| target(p, l.as_ref(), faces));
    let (panels, turned): (Vec<Option<Target>>, Vec<bool>) =
        covers.into_iter().map(|c| (c.target, c.is_turned)).unzip();
    targets.extend(panels);
    let found: Vec<Found> = parallel::map(curves.iter(), |c| one(c, &targets, tolerance));
    let drawn = labelled(curves, &found, patterns.len());
    for (k, (pattern, curves)) in patterns.iter_mut().zip(drawn).enumerate() {
        pattern.curves = match laid.get(k) {
            // The panel was laid flat as its face looks, and seen as the part is.
            Some(Some(laid)) => {
                let own = Pattern { curves, ..laid.pattern.clone() };
                panels_viewed(&laid.patchwork, vec![own], pattern.view).pop().map_or_else(Vec::new, |p| p.curves)
            }
            None if turned.get(k - laid.len()) == Some(&true) => {
                Pattern { curves, ..Pattern::default() }.turned_over().curves
            }
            _ => curves,
        };
    }
    let mut out = notes(curves, &found);
    let on_panels: Vec<String> = told(curves, &found, |f| f.lines.iter().any(|l| l.0 >= parts.len()));
    if !on_panels.is_empty() {
        out.push(UnrollNote::OnPanels { curves: on_panels });
    }
    out
}

/// The lines of curves on so many patterns, with their labels.
fn labelled(curves: &[FreeCurve], found: &[Found], count: usize) -> Vec<Vec<MarkLine>> {
    let several = curves.iter().any(|c| c.layer != curves[0].layer);
    let mut layers: HashSet<(usize, Skin, &str)> = HashSet::new();
    let mut drawn: Vec<Vec<MarkLine>> = vec![Vec::new(); count];
    for (curve, found) in curves.iter().zip(found) {
        let mut labelled: HashSet<(usize, Skin)> = HashSet::new();
        let is_text = matches!(curve.shape, FreeShape::Text { .. });
        for (part, skin, line) in &found.lines {
            let first = labelled.insert((*part, *skin));
            // Curves without names have that of their layer, once on every part, where it tells something; texts are words.
            let label = match curve.name.as_str() {
                _ if is_text => String::new(),
                "" if first && several && layers.insert((*part, *skin, &curve.layer)) => curve.layer.clone(),
                name if first => name.to_owned(),
                _ => String::new(),
            };
            let label = match (first, skin) {
                (true, Skin::Other) => format!("{label} {OTHER_SIDE}").trim_start().to_owned(),
                _ => label,
            };
            drawn[*part].push(MarkLine { label, ..line.clone() });
        }
    }
    drawn
}

/// What those curves are called of which something is so.
fn told(curves: &[FreeCurve], found: &[Found], is_so: impl Fn(&Found) -> bool) -> Vec<String> {
    curves.iter().zip(found).filter(|(_, f)| is_so(f)).map(|(c, _)| c.called()).collect()
}

/// What is said of them.
fn notes(curves: &[FreeCurve], found: &[Found]) -> Vec<UnrollNote> {
    let mut out = Vec::new();
    let carried = || curves.iter().zip(found).filter(|(_, f)| !f.lines.is_empty());
    let points = carried().filter(|(c, _)| !matches!(c.shape, FreeShape::Curve(_))).count();
    let whole = carried().count();
    if whole > 0 {
        let worst = |of: fn(&Found) -> f64| found.iter().map(of).fold(0.0, f64::max);
        let (distance, deviation) = (worst(|f| f.distance), worst(|f| f.deviation));
        out.push(UnrollNote::Carried { curves: whole - points, points, distance, deviation });
    }
    let other = |f: &Found| f.lines.iter().any(|l| l.1 == Skin::Other);
    let behind = told(curves, found, other);
    if !behind.is_empty() {
        out.push(UnrollNote::OtherSide { curves: behind });
    }
    let along = told(curves, found, |f| f.along_edge);
    if !along.is_empty() {
        out.push(UnrollNote::AlongEdges { curves: along });
    }
    let off: Vec<OffFaces> = found.iter().filter_map(|f| f.off.clone()).collect();
    if !off.is_empty() {
        out.push(UnrollNote::OffFaces { curves: off });
    }
    out
}

/// The curves of a model for every group of its faces: each with the groups whose faces are nearest by their boxes.
pub(super) fn shared(model: &Model, group: &[usize], count: usize) -> Vec<Vec<FreeCurve>> {
    let mut out: Vec<Vec<FreeCurve>> = vec![Vec::new(); count];
    let boxes: Vec<BBox> = model.faces.iter().map(|f| f.surface.bbox()).collect();
    for curve in &model.curves {
        let own = match &curve.shape {
            FreeShape::Point(x) | FreeShape::Text { at: x, .. } => BBox::of([x]),
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
