//! What is proven of parts that are laid flat, through panels or by their maps, and the claims that come of it.

use crate::brep::body::SMOOTH;
use crate::brep::face::{Face, FileEdge, VANISHED};
use crate::brep::recognised_surface::{bounds, rulings};
use crate::certify::claim::{Claim, Subject, UpperBound, What};
use crate::certify::unfolded::{unfolded, Unfolded, UnfoldedProof};
use crate::control::Control;
use crate::develop::unfold::bends::SheetBend;
use crate::develop::unfold::part::FlatPart;
use crate::develop::view::panels_viewed;
use crate::patchwork::pattern::Pattern;
use crate::reason::{FaceReason, Item, Reason};
use crate::search::strips::face_panel::{laid_face, LaidFace};

/// What is proven of a part: distance of its faces, of its drawing, gaps inside, change of lengths.
const BOUNDS: [fn(&UnfoldedProof) -> UpperBound; 4] = [
    UnfoldedProof::map_surface_distance,
    UnfoldedProof::drawing_distance,
    UnfoldedProof::joint_gap,
    UnfoldedProof::strain,
];

/// The claims that [`BOUNDS`] are.
fn claims_of(subject: Subject, [map_surface, drawing, gap, strain]: [UpperBound; 4], tolerance: f64) -> Vec<Claim> {
    let within = |what, bound| Claim::at_most(what, subject, bound).within(tolerance);
    vec![
        within(What::MapSurfaceDistance, map_surface),
        within(What::DrawingDistance, drawing),
        within(What::JointGap, gap),
        Claim::at_most(What::LengthError, subject, strain),
    ]
}

/// What is claimed of the whole, which is the largest of what is claimed of its parts, and of every part.
pub(super) fn claims(
    parts: &[FlatPart],
    proofs: &[UnfoldedProof],
    faults: &[Option<FaceReason>],
    tolerance: f64,
) -> Vec<Claim> {
    let bound = |of: fn(&UnfoldedProof) -> UpperBound| UpperBound::largest(proofs.iter().map(of));
    let whole = match parts.is_empty() {
        true => Vec::new(),
        false => claims_of(Subject::Whole, [0, 1, 2, 3].map(|k| bound(BOUNDS[k])), tolerance),
    };
    let mut claims: Vec<Claim> = whole.into_iter().map(Claim::told_of_parts).collect();
    claims.extend(parts.iter().zip(proofs).enumerate().flat_map(|(k, (part, proof))| {
        let mut of_part = claims_of(Subject::Part(k), BOUNDS.map(|of| of(proof)), tolerance);
        // How far lengths change must be known, however little is asked of it.
        if proof.strain() == UpperBound::UNKNOWN {
            of_part.push(Claim::objection(Subject::Part(k), not_shown(part)));
        }
        if let Some(fault) = &faults[k] {
            of_part.push(Claim::objection(
                Subject::Part(k),
                Reason::of(Item::Part(part.pattern.name.clone()), fault.clone()),
            ));
        }
        of_part.into_iter().map(move |c| match c.is_unknown() {
            true => c.because(not_shown(part)),
            false if c.what() == What::Objection => c,
            false => c.because(Reason::from(FaceReason::BeyondTolerance { part: part.pattern.name.clone() })),
        })
    }));
    claims
}

/// Why a part is not proven.
fn not_shown(part: &FlatPart) -> Reason {
    Reason::of(Item::Part(part.pattern.name.clone()), FaceReason::NoImage)
}

/// What is proven of a part; where that is not enough, and a panel helps, the part is laid flat anew through it.
pub(super) fn proven(
    part: &mut FlatPart,
    faces: &[Face],
    tolerance: f64,
    control: &Control,
) -> (Option<LaidFace>, UnfoldedProof) {
    let own = assessed(part, faces, tolerance);
    if own.is_within(tolerance) {
        return (None, own);
    }
    match through_panel(part, faces, tolerance, control) {
        Some(laid) => {
            let proof = UnfoldedProof::through_panel(&laid.certificate, &laid.flat);
            (Some(laid), proof)
        }
        None => (None, own),
    }
}

/// What the proof of a part does not see: loops of the file that its faces do not follow, and bends of which the bend table
/// does not tell.
pub(super) fn fault(part: &FlatPart, faces: &[Face], through_panel: bool) -> Option<FaceReason> {
    let lost = part.faces.iter().find_map(|f| {
        let (face, boundary) = (&faces[*f], faces[*f].boundary.as_ref()?);
        let followed = |label: u32| face.loops.iter().any(|l| l.edge.contains(&label));
        // A loop that runs there and back bounds nothing in the file either.
        let is_slit = |l: &[FileEdge]| l.iter().all(|e| l.iter().filter(|o| o.entity == e.entity).count() == 2);
        let is_followed = |l: &[FileEdge]| l.iter().any(|e| followed(e.label)) || l.iter().all(|e| e.label == VANISHED);
        let is_lost = |l: &&Vec<FileEdge>| !is_followed(l) && !is_slit(l);
        let edge = boundary.loops.iter().find(is_lost)?.first()?.entity;
        Some(FaceReason::LoopLost { entity: face.entity, edge })
    });
    // A panel has bend lines of its own.
    lost.or_else(|| if through_panel { None } else { kink(part, faces) })
}

/// The sharpest edge inside the faces of a part that have no closed map.
fn kink(part: &FlatPart, faces: &[Face]) -> Option<FaceReason> {
    let ruled = part.faces.iter().zip(&part.maps).filter(|(_, map)| map.is_none()).map(|(f, _)| &faces[*f]);
    let kinks = ruled.filter_map(|face| {
        let (at, turn) = rulings(face)?.kink(SMOOTH)?;
        Some((turn, FaceReason::Kinked { entity: face.entity, turn, at }))
    });
    kinks.max_by(|p, q| p.0.total_cmp(&q.0)).map(|k| k.1)
}

/// A surface of one face whose map has no closed form, laid flat anew through a panel that is proven; `None` for other parts,
/// and where that cannot be proven.
fn through_panel(part: &mut FlatPart, faces: &[Face], tolerance: f64, control: &Control) -> Option<LaidFace> {
    let ([_], [None]) = (part.faces.as_slice(), part.maps.as_slice()) else { return None };
    if part.sheet.thickness > 0.0 || control.stopped() {
        return None;
    }
    let laid = laid_face(&part.outside_of(0, faces), &part.pattern.name, tolerance)?;
    let seen = panels_viewed(&laid.patchwork, vec![laid.pattern.clone()], part.pattern.view).pop()?;
    part.pattern = Pattern { panel: part.pattern.panel, ..seen };
    // A panel is that of the surface itself.
    part.sheet.given = None;
    renamed(&mut part.sheet.bends, &part.pattern);
    Some(laid)
}

/// The bend table names the lines that are drawn: of a face that is bent both ways those of every stretch.
fn renamed(bends: &mut [SheetBend], pattern: &Pattern) {
    bends.iter_mut().for_each(|b| b.lines.clear());
    let mut at = 0;
    for (line, drawn) in pattern.rulings.iter().zip(&pattern.bends) {
        while at + 1 < bends.len() && bends[at].sense != drawn.sense {
            at += 1;
        }
        if let Some(bend) = bends.get_mut(at) {
            bend.lines.push(*line);
        }
    }
    bends.iter_mut().for_each(|b| b.rulings = b.lines.len());
}

/// A part before its judge.
pub(super) fn assessed(part: &FlatPart, faces: &[Face], tolerance: f64) -> UnfoldedProof {
    let asked = Unfolded {
        faces: part.faces.iter().map(|f| &faces[*f]).collect(),
        bounds: part.faces.iter().map(|f| bounds(&faces[*f])).collect(),
        maps: &part.maps,
        strips: &part.strips,
        thickness: part.sheet.given.as_ref().map_or(part.sheet.thickness, |s| s.thickness),
        pattern: &part.pattern,
        strokes: &part.strokes,
        joints: &part.joints,
        allowances: &part.allowances,
    };
    unfolded(&asked, tolerance)
}
