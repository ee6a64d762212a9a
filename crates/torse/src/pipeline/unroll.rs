//! The job of `torse unroll`: bodies of sheet and other developable faces as flat patterns.

mod bodies;
mod carried;
mod covered;
mod followed;
mod joined;
mod options;
mod proofs;
mod targets;
#[cfg(test)]
mod tests;

pub use bodies::groups;
use options::UNFOLDED;
pub use options::{TooRound, UnrollError, UnrollOptions};

use crate::answer::joints::apart;
use crate::answer::note::{Note, UnrollNote};
use crate::answer::shop::face_name;
use crate::answer::skipped::left_out;
use crate::answer::{Answer, Job};
use crate::brep::body::SMOOTH;
use crate::brep::face::Face;
use crate::brep::recognised_surface::recognise;
use crate::brep::trim::crease::{uncreased, Crease};
use crate::certify::unfolded::UnfoldedProof;
use crate::control::Control;
use crate::develop::shop::thickness::SheetSide;
use crate::develop::unfold::part::FlatPart;
use crate::develop::unfold::sheet::is_thickness;
use crate::develop::unfold::tree::CutReason;
use crate::geom::coarse::Loose;
use crate::geom::BBox;
use crate::io::model::Model;
use crate::num::parallel;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::FaceReason;
use crate::search::strips::face_panel::{face_panel, LaidFace};
use joined::joined;
#[cfg(test)]
use proofs::assessed;
use proofs::{fault, proven};
use std::collections::HashSet;
use std::time::Instant;

/// Share of the work that is done when all bodies are proven.
const PROVEN: f64 = 0.7;

/// Lays every body of a model flat.
///
/// *Guarantee*: [`crate::certify::claim::Status::Certified`] only where every face that is laid flat is proven to lie on its
/// plane, cylinder or cone, or near a developable panel, and every outline to be its flat image, within the tolerance, and
/// nothing is left out. Of panels that cover faces which are not developable the guarantee of [`crate::pipeline::approximate::of_faces`] holds, within a
/// tolerance of their own.
/// *Not guaranteed*: that parts do not overlap themselves, between samples, where a note says that their outlines touch themselves.
///
/// # Errors
/// See [`UnrollError`].
///
/// # Example
/// ```
/// let pipe = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.05) };
/// let answer = torse::unroll(&pipe, &options, &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.patterns().len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unroll(model: &Model, options: &UnrollOptions, control: &Control) -> Result<Answer, UnrollError> {
    let start = Instant::now();
    let boxes: Vec<BBox> = model.faces.iter().map(|f| f.surface.bbox()).collect();
    Loose::check(BBox::of(boxes.iter().flat_map(|b| [&b.min, &b.max])).diagonal(), options.tolerance)?;
    // What is to be covered is cut there, after its trim was proven.
    let laid = |f: &Face, _: &Crease| options.approximate.is_none() || recognise(f).is_developable();
    let creased = uncreased(model.faces.clone(), SMOOTH, laid);
    let told = Note::creased(&creased);
    let faces = creased.faces;
    let (mut parts, left) = bodies::flat_parts_of(&faces, options, control)?;
    let laid_flat: HashSet<usize> = parts.iter().flat_map(|p| p.faces.iter().copied()).collect();
    // 1. What is proven: faces against the surfaces that are laid flat, drawings and inner edges against these.
    control.report("proving", UNFOLDED, format!("{} parts", parts.len()));
    let (through_panels, proofs): (Vec<Option<LaidFace>>, Vec<UnfoldedProof>) =
        parallel::map(parts.iter_mut(), |p| proven(p, &faces, options.tolerance, control)).into_iter().unzip();
    let joints = joined(&mut parts, &through_panels);
    // 2. The skins in space: one panel for each face, in the order of the parts.
    let mut patchwork = Patchwork::default();
    let mut made_of: Vec<Part> = Vec::new();
    let mut absent: Vec<UnrollNote> = Vec::new();
    control.report("laying out the skins", PROVEN, format!("{} parts", parts.len()));
    let skin = |(part, laid): (&FlatPart, &Option<LaidFace>)| -> Vec<_> {
        let own = if laid.is_some() { 0 } else { part.faces.len() };
        let of = |k: usize| {
            let (face, name) = (part.outside_of(k, &faces), face_name(&part.pattern.name, k));
            (face.entity, face_panel(&face, &name))
        };
        parallel::map(0..own, of)
    };
    let skins: Vec<_> = parallel::map(parts.iter().zip(&through_panels), skin);
    for ((part, laid), panels) in parts.iter().zip(&through_panels).zip(skins) {
        let first = patchwork.panels.len();
        if let Some(laid) = laid {
            patchwork.append(laid.patchwork.clone());
            made_of.push(Part::new(part.pattern.name.clone(), first, 1));
            continue;
        }
        let missing: Vec<u64> = panels.iter().filter(|f| f.1.is_none()).map(|f| f.0).collect();
        if !missing.is_empty() {
            absent.push(UnrollNote::NotInSpace { part: part.pattern.name.clone(), faces: missing });
        }
        panels.into_iter().filter_map(|f| f.1).for_each(|p| patchwork.append(p));
        let name = part.pattern.name.clone();
        made_of.push(Part::new(name, first, patchwork.panels.len() - first));
    }
    let faults: Vec<Option<FaceReason>> =
        parallel::map(parts.iter().zip(&through_panels), |(p, laid)| fault(p, &faces, laid.is_some()));
    let mut claims = self::proofs::claims(&parts, &proofs, &faults, options.tolerance);
    let mut skipped = model.skipped.clone();
    skipped.extend(left);
    claims.extend(left_out(&skipped));
    let mut answer = Answer {
        claims,
        skipped,
        patchwork,
        parts: made_of,
        patterns: parts.iter().map(|p| p.pattern.clone()).collect(),
        notes: model.notes.iter().cloned().chain(told).collect(),
        sheets: parts.iter().map(|p| p.sheet.clone()).collect(),
        joints,
        ..Answer::new(Job::Unroll, &options.input, options.tolerance)
    };
    let touching = parts.iter().zip(&proofs).filter(|p| !p.1.is_in_one_layer()).map(|p| p.0.pattern.name.clone());
    let touching: Vec<String> = touching.collect();
    if !touching.is_empty() {
        answer.notes.push(Note::Unroll(UnrollNote::Touching { parts: touching }));
    }
    answer.notes.extend(notes(&parts, options).into_iter().chain(absent).map(Note::Unroll));
    answer.notes.extend(apart(&answer.patterns, options.tolerance));
    let mut covers = Vec::new();
    if let Some(tolerance) = options.approximate {
        let rest = (0..faces.len()).filter(|k| !laid_flat.contains(k)).map(|k| faces[k].clone()).collect();
        covers = covered::add(&mut answer, rest, (tolerance, !model.curves.is_empty()), control)?;
    }
    let given = (&parts[..], &through_panels[..], &faces[..]);
    let carried = carried::carry(&model.curves, (&mut answer.patterns, covers), given, options.tolerance);
    answer.notes.extend(carried.into_iter().map(Note::Unroll));
    // A part that is laid flat through a panel has that one's map.
    let own =
        |(part, laid): (&mut FlatPart, &Option<LaidFace>)| if laid.is_some() { Vec::new() } else { part.take_faces() };
    answer.laid_faces = parts.iter_mut().zip(&through_panels).map(own).collect();
    answer.seconds = start.elapsed().as_secs_f64();
    Ok(answer)
}

/// Where a part of sheet is of another thickness, if it is anywhere.
fn thinned(p: &FlatPart) -> Option<UnrollNote> {
    let (thickness, all) = (p.sheet.thickness, &p.sheet.local);
    let other: Vec<f64> = all.iter().copied().filter(|t| !is_thickness(*t, thickness)).collect();
    let local = other.iter().copied().max_by(|a, b| (a - thickness).abs().total_cmp(&(b - thickness).abs()))?;
    let part = p.pattern.name.clone();
    (thickness > 0.0).then_some(UnrollNote::Thinned { part, faces: other.len(), of: all.len(), local, thickness })
}

/// What people should know of the parts.
fn notes(parts: &[FlatPart], options: &UnrollOptions) -> Vec<UnrollNote> {
    let mut out = Vec::new();
    if parts.iter().any(|p| p.sheet.thickness > 0.0 && !p.sheet.bends.is_empty()) {
        out.push(UnrollNote::NeutralFibre(options.k.clone()));
    }
    let is_sided = options.sheet.as_ref().is_some_and(|s| s.side != SheetSide::Middle);
    if is_sided && parts.iter().any(|p| p.sheet.thickness > 0.0) {
        out.push(UnrollNote::SideOfBodies);
    }
    for p in parts {
        let part = || p.pattern.name.clone();
        if p.sheet.thickness > 0.0 {
            let (thickness, bends) = (p.sheet.thickness, p.sheet.bends.len());
            out.push(UnrollNote::Sheet { part: part(), thickness, bends });
        }
        out.extend(thinned(p));
        let (asked, own): (Vec<_>, Vec<_>) = p.cuts.iter().partition(|c| c.1 == CutReason::Asked);
        out.extend(own.into_iter().map(|&(edge, reason)| UnrollNote::Cut { part: part(), edge, reason }));
        if !asked.is_empty() {
            out.push(UnrollNote::NotBent { part: part(), edges: asked.into_iter().map(|c| c.0).collect() });
        }
        if !p.slanting.is_empty() {
            out.push(UnrollNote::Slanting { part: part(), faces: p.slanting.clone() });
        }
        if !p.pattern.formed.is_empty() {
            out.push(UnrollNote::Formed { part: part(), count: p.pattern.formed.len() });
        }
    }
    out
}
