//! Chains of cones as panels with their outlines, for formats that hold nothing but splines.

use super::Cones;
use crate::geom::Vec3;
use crate::patchwork::panel::{Border, Coedge, Panel, Patchwork};
use crate::spline::curve::Curve;
use crate::torse::cone::chart::share;
use crate::torse::cone::part::{ConePart, PartCurve, PartFace};

/// The panels of an answer that are pieces of chains, cut along the outlines of these. What is no such piece, or has an
/// edge without a curve, stays whole.
pub(crate) fn outlined(panels: &Patchwork, cones: &Cones) -> Patchwork {
    let mut out = panels.clone();
    for (panel, &(body, piece)) in out.panels.iter_mut().zip(&cones.pieces) {
        let Some(part) = cones.bodies.get(body).and_then(|b| b.part.as_ref()) else { continue };
        if let Some(cut) = part.faces.get(piece).and_then(|f| cut(panel, part, piece, f)) {
            *panel = cut;
        }
    }
    out
}

/// A trimmed piece.
fn cut(whole: &Panel, part: &ConePart, number: usize, face: &PartFace) -> Option<Panel> {
    let mut outline = Vec::with_capacity(face.loops.len());
    for uses in &face.loops {
        let runs: Option<Vec<Coedge>> = uses.iter().map(|&(edge, forward)| run(part, number, edge, forward)).collect();
        outline.push(runs?);
    }
    let mut panel = whole.clone();
    panel.strip.patch = face.blank.patch.clone();
    panel.outline = outline;
    Some(panel)
}

/// An edge of a piece in the direction of its loop.
fn run(part: &ConePart, number: usize, edge: usize, forward: bool) -> Option<Coedge> {
    let e = part.edges.get(edge)?;
    let (trim, space) = match &e.curve {
        PartCurve::Free { face, trim, space } if *face == number => (trim.clone(), space.clone()),
        PartCurve::Free { .. } => return None,
        PartCurve::Ruling => {
            let ends = [part.vertices.get(e.start)?, part.vertices.get(e.end)?];
            let line = vec![0.0, 0.0, 1.0, 1.0];
            let places = ends.map(|p| place(&part.faces[number], p)).to_vec();
            (Curve::new(1, line.clone(), places).ok()?, Curve::new(1, line, ends.map(|p| (*p).into()).to_vec()).ok()?)
        }
    };
    let (trim, edge_in_space) = if forward { (trim, space) } else { (trim.reversed(), space.reversed()) };
    let border = Border::Trim { edge: edge as u32 };
    Some(Coedge { border, vertices: Vec::new(), parameters: Vec::new(), trim, edge: edge_in_space })
}

/// The place on the patch of a piece of a point of it.
fn place(face: &PartFace, p: &Vec3) -> [f64; 2] {
    let segment = &face.blank.segment;
    let f = share(segment, p);
    let g = segment.element(f);
    face.blank.place([f, (p - g.point).dot(&g.direction)])
}
