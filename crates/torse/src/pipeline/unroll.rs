//! The job of `torse unroll`: bodies of sheet and other developable faces as flat patterns.

#[cfg(test)]
mod tests;

use crate::answer::note::{Note, UnrollNote};
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Job};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::certify::claim::UpperBound;
use crate::certify::claim::{Claim, Subject, What};
use crate::certify::unfolded::{unfolded, Unfolded, UnfoldedProof};
use crate::develop::bends::Facets;
use crate::develop::unfold::allowance::{KFactor, KFactorError};
use crate::develop::unfold::part::{flat_parts, FlatPart, PartOptions};
use crate::geom::coarse::is_tolerance;
use crate::io::model::Model;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::face_panel::face_panels;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

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
}

impl UnrollOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, k: KFactor::default(), surfaces: false, input: "model".into(), facets: None }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnrollError {
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
    /// A K-factor that cannot be meant.
    #[error(transparent)]
    KFactor(#[from] KFactorError),
    /// No thickness, but a K-factor for it.
    #[error("a K-factor is for sheets with thickness; leave it out where faces are surfaces")]
    KWithoutThickness,
    /// Nothing can be laid flat.
    #[error("none of the {bodies} bodies can be unrolled; the first: {reason}")]
    Nothing {
        /// Number of bodies.
        bodies: usize,
        /// Why the first cannot.
        reason: String,
    },
}

/// Flat parts of a model, without panels in space; `faces` of the parts are indices into `faces`. The second list says
/// what is left out.
///
/// # Errors
/// See [`UnrollError`].
pub fn flat_parts_of(faces: &[Face], options: &UnrollOptions) -> Result<(Vec<FlatPart>, Vec<Skipped>), UnrollError> {
    if !is_tolerance(options.tolerance) {
        return Err(UnrollError::Tolerance(options.tolerance));
    }
    options.k.check()?;
    if options.surfaces && options.k != KFactor::default() {
        return Err(UnrollError::KWithoutThickness);
    }
    let mut bodies: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (k, f) in faces.iter().enumerate() {
        bodies.entry(f.body).or_default().push(k);
    }
    let asked = PartOptions {
        tolerance: options.tolerance,
        k: options.k.clone(),
        surfaces: options.surfaces,
        facets: options.facets,
    };
    let names = names(faces, &bodies);
    let bodies: Vec<Vec<usize>> = bodies.into_values().collect();
    let made: Vec<_> = (bodies.par_iter().zip(&names))
        .map(|(body, name)| flat_parts(&body.iter().map(|k| &faces[*k]).collect::<Vec<_>>(), name, &asked))
        .collect();
    let (mut parts, mut left) = (Vec::new(), Vec::new());
    for ((found, body), name) in made.into_iter().zip(&bodies).zip(&names) {
        parts.extend(found.parts.into_iter().map(|mut p| {
            p.faces.iter_mut().for_each(|f| *f = body[*f]);
            p
        }));
        left.extend(found.left.into_iter().map(|(face, reason)| match face.map(|k| &faces[body[k]]) {
            Some(f) => Skipped::of_file(f.entity, format!("{name}: {reason}"), Some(area_estimate(f))),
            None => Skipped::from(format!("{name}: {reason}")),
        }));
    }
    for (k, p) in parts.iter_mut().enumerate() {
        p.pattern.panel = k;
    }
    if parts.is_empty() {
        let reason = left.first().map_or_else(|| "it has no faces".into(), |l: &Skipped| l.reason.clone());
        return Err(UnrollError::Nothing { bodies: bodies.len(), reason });
    }
    Ok((parts, left))
}

/// Lays every body of a model flat.
///
/// *Guarantee*: [`crate::certify::claim::Status::Certified`] only where every face that is laid flat is proven to lie on its
/// plane, cylinder or cone, and every outline to be its flat image, within the tolerance, and nothing is left out.
/// *Not guaranteed*: that parts do not overlap themselves between samples.
///
/// # Errors
/// See [`UnrollError`].
///
/// # Example
/// ```
/// let pipe = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.05) };
/// let answer = torse::unroll(&pipe, &options)?;
/// assert_eq!((answer.status(), answer.patterns.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unroll(model: &Model, options: &UnrollOptions) -> Result<Answer, UnrollError> {
    let start = Instant::now();
    let (parts, left) = flat_parts_of(&model.faces, options)?;
    // 1. The skins in space: one panel for each face, in the order of the parts.
    let mut patchwork = Patchwork::default();
    let mut made_of: Vec<Part> = Vec::new();
    for part in &parts {
        let first = patchwork.panels.len();
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
    // 2. What is proven: faces against the surfaces that are laid flat, drawings and inner edges against these.
    let proofs: Vec<UnfoldedProof> = parts.par_iter().map(|p| judged(p, &model.faces, options.tolerance)).collect();
    let bound = |of: fn(&UnfoldedProof) -> UpperBound| UpperBound::largest(proofs.iter().map(of));
    let within = |what, bound| Claim::at_most(what, Subject::Whole, bound).within(options.tolerance);
    let mut claims = vec![
        within(What::CarrierDistance, bound(UnfoldedProof::carrier_distance)),
        within(What::DrawingDistance, bound(UnfoldedProof::drawing_distance)),
        within(What::JointGap, bound(UnfoldedProof::joint_gap)),
        Claim::at_most(What::LengthError, Subject::Whole, bound(UnfoldedProof::strain)),
    ];
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
    answer.seconds = start.elapsed().as_secs_f64();
    Ok(answer)
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

/// Names of bodies: that of their part, numbered where several bodies have one.
fn names(faces: &[Face], bodies: &BTreeMap<u32, Vec<usize>>) -> Vec<String> {
    let plain = |body: &Vec<usize>| {
        let name = body.iter().map(|k| faces[*k].part.as_str()).find(|n| !n.is_empty());
        name.unwrap_or("part").to_owned()
    };
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    bodies.values().for_each(|b| *count.entry(plain(b)).or_default() += 1);
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    let numbered = |body: &Vec<usize>| {
        let name = plain(body);
        let k = used.entry(name.clone()).or_default();
        *k += 1;
        if count.get(&name) == Some(&1) {
            name
        } else {
            format!("{name} {k}")
        }
    };
    bodies.values().map(numbered).collect()
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
