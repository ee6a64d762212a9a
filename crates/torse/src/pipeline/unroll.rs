//! The job of `torse unroll`: bodies of sheet and other developable faces as flat patterns.

mod bodies;
mod covered;
#[cfg(test)]
mod tests;

pub use bodies::groups;

use crate::answer::note::{Note, UnrollNote};
use crate::answer::skipped::left_out;
use crate::answer::{Answer, Job};
use crate::brep::face::Face;
use crate::certify::claim::UpperBound;
use crate::certify::claim::{Claim, Subject, What};
use crate::certify::unfolded::{unfolded, Unfolded, UnfoldedProof};
use crate::control::Control;
use crate::develop::bends::Facets;
use crate::develop::unfold::allowance::{KFactor, KFactorError};
use crate::develop::unfold::part::FlatPart;
use crate::develop::view::panels_viewed;
use crate::geom::coarse::Loose;
use crate::geom::BBox;
use crate::io::model::Model;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::pipeline::approximate::ApproximateError;
use crate::search::strips::face_panel::{face_panels, laid_face, LaidFace};
use rayon::prelude::*;
use std::collections::HashSet;
use std::time::Instant;

/// Shares of the work that are done when all bodies are unfolded, and when their skins are laid out.
const UNFOLDED: f64 = 0.5;
const LAID_OUT: f64 = 0.7;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct UnrollOptions {
    /// Distance (mm) between contours drawn and exact outlines; no default. Lines and arcs of the file stay what they are.
    pub tolerance: f64,
    /// Where the neutral fibre lies; default 0.44 (ANSI).
    pub k: KFactor,
    /// Takes all faces as surfaces without thickness; default false.
    pub surfaces: bool,
    /// Name of the input, for the files; default "model".
    pub input: String,
    /// How rolled faces are kinked; default none: lines every 5°.
    pub facets: Option<Facets>,
    /// Distance (mm) within which surfaces that are not developable are covered by panels; default none: they are left out.
    pub approximate: Option<f64>,
}

impl UnrollOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            k: KFactor::default(),
            surfaces: false,
            input: "model".into(),
            facets: None,
            approximate: None,
        }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnrollError {
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A K-factor that cannot be meant.
    #[error(transparent)]
    KFactor(#[from] KFactorError),
    /// No thickness, but a K-factor for it.
    #[error("a K-factor is for sheets with thickness; leave it out where faces are surfaces")]
    KWithoutThickness,
    /// Thickness, but panels for faces without one.
    #[error("panels cover surfaces without thickness only")]
    CoversSurfacesOnly,
    /// Faces that are not developable cannot be covered.
    #[error("faces that are not developable cannot be covered: {0}")]
    Approximate(#[from] ApproximateError),
    /// Nothing can be laid flat.
    #[error("none of the {bodies} bodies can be unrolled; the first: {reason}")]
    Nothing {
        /// Number of bodies.
        bodies: usize,
        /// Why the first cannot.
        reason: String,
    },
}

/// Lays every body of a model flat.
///
/// *Guarantee*: [`crate::certify::claim::Status::Certified`] only where every face that is laid flat is proven to lie on its
/// plane, cylinder or cone, or near a developable panel, and every outline to be its flat image, within the tolerance, and
/// nothing is left out. Of panels that cover faces which are not developable the guarantee of [`crate::pipeline::approximate::of_faces`] holds, within a
/// tolerance of their own.
/// *Not guaranteed*: that parts do not overlap themselves between samples.
///
/// # Errors
/// See [`UnrollError`].
///
/// # Example
/// ```
/// let pipe = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.05) };
/// let answer = torse::unroll(&pipe, &options, &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.patterns.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unroll(model: &Model, options: &UnrollOptions, control: &Control) -> Result<Answer, UnrollError> {
    let start = Instant::now();
    let boxes: Vec<BBox> = model.faces.iter().map(|f| f.surface.bbox()).collect();
    Loose::check(BBox::of(boxes.iter().flat_map(|b| [&b.min, &b.max])).diagonal(), options.tolerance)?;
    let (mut parts, left) = bodies::flat_parts_of(&model.faces, options, control)?;
    let laid_flat: HashSet<usize> = parts.iter().flat_map(|p| p.faces.iter().copied()).collect();
    let through_panels: Vec<Option<LaidFace>> =
        parts.par_iter_mut().map(|p| through_panel(p, &model.faces, options.tolerance, control)).collect();
    // 1. The skins in space: one panel for each face, in the order of the parts.
    let mut patchwork = Patchwork::default();
    let mut made_of: Vec<Part> = Vec::new();
    for (done, (part, laid)) in parts.iter().zip(&through_panels).enumerate() {
        let fraction = UNFOLDED + (LAID_OUT - UNFOLDED) * done as f64 / parts.len() as f64;
        control.report("laying out the skins", fraction, format!("{done} of {} parts", parts.len()));
        let first = patchwork.panels.len();
        if let Some(laid) = laid {
            patchwork.append(laid.patchwork.clone());
            made_of.push(Part::new(part.pattern.name.clone(), first, 1));
            continue;
        }
        let panels: Vec<_> = (part.faces.par_iter().enumerate())
            .map(|(k, f)| {
                let face = model.faces[*f].clone();
                let name = format!("{}-{:02}", part.pattern.name, k + 1);
                face_panels(&face, &name).map(|(partition, panels)| (face, partition, panels))
            })
            .collect();
        for (face, partition, made) in panels.into_iter().flatten() {
            let index = patchwork.faces.len();
            patchwork.panels.extend(made.into_iter().map(|mut p| {
                p.trim.iter_mut().for_each(|t| t.face = index);
                p
            }));
            patchwork.faces.push(face);
            patchwork.partitions.push(partition);
        }
        let name = part.pattern.name.clone();
        made_of.push(Part::new(name, first, patchwork.panels.len() - first));
    }
    control.report("proving", LAID_OUT, format!("{} parts", parts.len()));
    // 2. What is proven: faces against the surfaces that are laid flat, drawings and inner edges against these.
    let proof = |(part, laid): (&FlatPart, &Option<LaidFace>)| match laid {
        Some(l) => UnfoldedProof::through_panel(&l.certificate, &l.flat),
        None => judged(part, &model.faces, options.tolerance),
    };
    let proofs: Vec<UnfoldedProof> = parts.par_iter().zip(&through_panels).map(proof).collect();
    let bound = |of: fn(&UnfoldedProof) -> UpperBound| UpperBound::largest(proofs.iter().map(of));
    let within = |what, bound| Claim::at_most(what, Subject::Whole, bound).within(options.tolerance);
    let mut claims = match parts.is_empty() {
        true => Vec::new(),
        false => vec![
            within(What::CarrierDistance, bound(UnfoldedProof::carrier_distance)),
            within(What::DrawingDistance, bound(UnfoldedProof::drawing_distance)),
            within(What::JointGap, bound(UnfoldedProof::joint_gap)),
            Claim::at_most(What::LengthError, Subject::Whole, bound(UnfoldedProof::strain)),
        ],
    };
    let mut skipped = model.skipped.clone();
    skipped.extend(left);
    claims.extend(left_out(&skipped));
    let mut answer = Answer {
        claims,
        skipped,
        patchwork,
        parts: made_of,
        patterns: parts.iter().map(|p| p.pattern.clone()).collect(),
        notes: model.notes.clone(),
        sheets: parts.iter().map(|p| p.sheet.clone()).collect(),
        ..Answer::new(Job::Unroll, &options.input, options.tolerance)
    };
    answer.notes.extend(notes(&parts, options).into_iter().map(Note::Unroll));
    if let Some(tolerance) = options.approximate {
        let rest = (0..model.faces.len()).filter(|k| !laid_flat.contains(k)).map(|k| model.faces[k].clone()).collect();
        covered::add(&mut answer, rest, tolerance, control)?;
    }
    answer.seconds = start.elapsed().as_secs_f64();
    Ok(answer)
}

/// A surface of one face whose map has no closed form, laid flat anew through a panel that is proven; `None` for other parts,
/// and where that cannot be proven.
fn through_panel(part: &mut FlatPart, faces: &[Face], tolerance: f64, control: &Control) -> Option<LaidFace> {
    let ([face], [None]) = (part.faces.as_slice(), part.maps.as_slice()) else { return None };
    if part.sheet.thickness > 0.0 || control.stopped() {
        return None;
    }
    let laid = laid_face(&faces[*face], &part.pattern.name, tolerance)?;
    let seen = panels_viewed(&laid.patchwork, vec![laid.pattern.clone()], part.pattern.view).pop()?;
    part.pattern = Pattern { panel: part.pattern.panel, ..seen };
    // The bend table names the lines that are drawn.
    if let [bend] = part.sheet.bends.as_mut_slice() {
        bend.lines.clone_from(&part.pattern.rulings);
        bend.rulings = bend.lines.len();
    }
    Some(laid)
}

/// A part before its judge.
fn judged(part: &FlatPart, faces: &[Face], tolerance: f64) -> UnfoldedProof {
    let asked = Unfolded {
        surfaces: part.faces.iter().map(|f| &faces[*f].surface).collect(),
        maps: &part.maps,
        thickness: part.sheet.thickness,
        contours: part.pattern.contours.iter().chain(&part.pattern.formed).collect(),
        strokes: &part.strokes,
        joints: &part.joints,
        allowances: &part.allowances,
    };
    unfolded(&asked, tolerance)
}

/// What people should know of the parts.
fn notes(parts: &[FlatPart], options: &UnrollOptions) -> Vec<UnrollNote> {
    let mut out = Vec::new();
    if parts.iter().any(|p| p.sheet.thickness > 0.0 && !p.sheet.bends.is_empty()) {
        out.push(UnrollNote::NeutralFibre(options.k.clone()));
    }
    for p in parts {
        let part = || p.pattern.name.clone();
        if p.sheet.thickness > 0.0 {
            let (thickness, bends) = (p.sheet.thickness, p.sheet.bends.len());
            out.push(UnrollNote::Sheet { part: part(), thickness, bends });
        }
        out.extend(p.cuts.iter().map(|&(edge, reason)| UnrollNote::Cut { part: part(), edge, reason }));
        if !p.pattern.formed.is_empty() {
            out.push(UnrollNote::Formed { part: part(), count: p.pattern.formed.len() });
        }
    }
    out
}
