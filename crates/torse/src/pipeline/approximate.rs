//! The main job: faces in, certified developable panels and flat patterns out.
//!
//! Reads like the page that describes it: cover every face, build the panels as they will be exported, have them
//! judged, cut what is refused, develop the rest.

use super::cover::{cover, Cover, CoverOptions, State};
use super::outcome::{Outcome, Skipped, Status};
use crate::certify::{self, Certificate};
use crate::control::Control;
use crate::fit::boundary;
use crate::geom::BBox;
use crate::surface::face::Face;
use crate::surface::panel::{Panel, Patchwork};
use rayon::prelude::*;
use std::time::Instant;

/// What the main job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Deviation bound to reach between model and panels, mm.
    pub tolerance: f64,
    /// Largest number of panels on any face; default none.
    pub max_panels: Option<usize>,
    /// Name of the input for reports, without folder.
    pub input: String,
}

/// Why the job cannot be done at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ApproximateError {
    /// Nothing to approximate.
    #[error("there is no face to approximate; {0}")]
    NoFaces(String),
    /// Tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// Tolerance too small to be proven in double precision.
    #[error(
        "a tolerance of {tolerance:.3e} mm is below what double precision can certify on a model of {size:.1} mm; \
         ask for at least {least:.1e} mm"
    )]
    Precision {
        /// Asked for, mm.
        tolerance: f64,
        /// Diagonal of the model, mm.
        size: f64,
        /// Smallest tolerance, mm.
        least: f64,
    },
    /// Limit of panels that cannot be kept.
    #[error("the greatest number of panels must be at least 1")]
    MaxPanels,
}

/// Share of the model's size below which no tolerance is accepted (certificate specification, 3).
const PRECISION: f64 = 1e-10;
/// Share of the tolerance that a trim curve may stray from the region's border.
const TRIM_SHARE: f64 = 1.0 / 250.0;
/// Rounds of cutting panels that the judge refuses as built.
const ROUNDS: usize = 5;
/// Factor on the tolerance from one attempt to the next when the number of panels is limited.
const COARSER: f64 = 1.6;

/// Approximates faces by developable panels within a tolerance.
///
/// *Method.* [`cover`] per face, in parallel; panels built by [`boundary::panels`]; the proof by
/// [`certify::patchwork`], which shares nothing with the fit; development of every panel.
/// *Guarantee.* The status is [`Status::Certified`] only if the certificate holds for every panel as exported.
/// Ended early by `control` or `max_panels`, the answer holds the best panels found and says why it is not certified.
///
/// # Errors
/// No faces, a tolerance that is not positive or cannot be certified at the size of the model.
pub fn approximate(
    faces: Vec<Face>,
    mut skipped: Vec<Skipped>,
    options: &Options,
    control: &Control,
) -> Result<Outcome, ApproximateError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(ApproximateError::Tolerance(tolerance));
    }
    if options.max_panels == Some(0) {
        return Err(ApproximateError::MaxPanels);
    }
    if faces.is_empty() {
        let why = skipped.first().map_or("the file holds none".to_owned(), |s| format!("#{}: {}", s.entity, s.reason));
        return Err(ApproximateError::NoFaces(why));
    }
    let mut bbox = BBox::empty();
    for f in &faces {
        let b = f.surface.bbox();
        bbox.include(&b.min);
        bbox.include(&b.max);
    }
    let size = bbox.diagonal().max(bbox.min.amax().max(bbox.max.amax()));
    if tolerance < PRECISION * size {
        return Err(ApproximateError::Precision { tolerance, size, least: PRECISION * size });
    }
    let total = faces.len();
    let finished = std::sync::atomic::AtomicUsize::new(0);
    let done: Vec<Result<Built, Skipped>> = faces
        .into_par_iter()
        .map(|face| {
            let built = one_face(face, options, control);
            let n = finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            control.report("faces covered", n as f64 / total as f64, format!("{n} of {total}"));
            built
        })
        .collect();
    let mut patchwork = Patchwork { faces: Vec::new(), partitions: Vec::new(), panels: Vec::new(), seam_count: 0 };
    let mut certificates = Vec::new();
    for built in done {
        match built {
            Ok(b) => {
                certificates.push(b.certificate);
                patchwork.append(b.patchwork);
            }
            Err(s) => skipped.push(s),
        }
    }
    if patchwork.faces.is_empty() {
        let why = skipped.first().map_or(String::new(), |s| format!("#{}: {}", s.entity, s.reason));
        return Err(ApproximateError::NoFaces(why));
    }
    patchwork.name_panels();
    let certificate = certify::join(certificates, tolerance);
    control.report("developing", 1.0, String::new());
    let patterns = super::develop::patterns(&patchwork, tolerance);
    let mut missing = certificate.missing.clone();
    let patterns = match patterns {
        Ok(p) => p,
        Err((p, reasons)) => {
            missing.extend(reasons);
            p
        }
    };
    let status = if certificate.certified && missing.is_empty() {
        Status::Certified
    } else {
        Status::Uncertified(missing.first().cloned().unwrap_or_else(|| "not every panel could be proven".to_owned()))
    };
    Ok(Outcome {
        input: options.input.clone(),
        tolerance,
        status,
        patchwork,
        certificate,
        patterns,
        skipped,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// One face with its panels and their proof.
struct Built {
    patchwork: Patchwork,
    certificate: Certificate,
}

fn one_face(face: Face, options: &Options, control: &Control) -> Result<Built, Skipped> {
    let entity = face.entity;
    let refuse = |reason: String| Skipped { entity, reason };
    let limit = options.max_panels.unwrap_or(usize::MAX);
    let mut cover_options = CoverOptions { tolerance: options.tolerance, max_panels: limit };
    let mut found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    while !found.complete && !control.stopped() {
        // Too many panels: the fewest that were asked for, as near as they can be.
        cover_options.tolerance *= COARSER;
        found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    }
    let Cover { mut state, complete } = found;
    if !complete {
        super::cover::fill(&face, &mut state);
    }
    let mut best: Option<Built> = None;
    for round in 0..=ROUNDS {
        let (panels, seam_count) = boundary::panels(
            &face,
            0,
            &state.partition,
            &torses(&state),
            options.tolerance * TRIM_SHARE,
        )
        .map_err(|e| refuse(e.to_string()))?;
        let patchwork =
            Patchwork { faces: vec![face.clone()], partitions: vec![state.partition.clone()], panels, seam_count };
        // The proof has its own clock: what was found is judged even when time is up.
        let certificate = certify::patchwork(&patchwork, options.tolerance, &Control::default());
        let refused: Vec<u32> = patchwork
            .panels
            .iter()
            .zip(&certificate.panels)
            .filter(|(_, c)| !c.certified)
            .map(|(p, _)| p.label)
            .collect();
        let stop = refused.is_empty()
            || round == ROUNDS
            || control.stopped()
            || cover_options.tolerance > options.tolerance
            || patchwork.panels.len() + refused.len() > limit;
        best = Some(Built { patchwork, certificate });
        if stop {
            break;
        }
        match super::cover::cut_refused(&face, &cover_options, control, &state, &refused) {
            Some(next) => state = next,
            None => break,
        }
    }
    best.ok_or_else(|| refuse("no panel could be built".to_owned()))
}

fn torses(state: &State) -> boundary::Torses {
    state.panels.iter().map(|(&l, fit)| (l, (fit.torse.clone(), fit.kind))).collect()
}

impl Patchwork {
    /// Adds the faces, panels and seams of another patchwork.
    fn append(&mut self, other: Patchwork) {
        let (faces, seams) = (self.faces.len(), self.seam_count as u32);
        self.faces.extend(other.faces);
        self.partitions.extend(other.partitions);
        self.panels.extend(other.panels.into_iter().map(|mut p: Panel| {
            p.face += faces;
            for run in p.loops.iter_mut().flatten() {
                if let crate::surface::panel::Border::Seam { seam, .. } = &mut run.border {
                    *seam += seams;
                }
            }
            p
        }));
        self.seam_count += other.seam_count;
    }

    /// Names panels by face letter and number, …; AA after Z.
    fn name_panels(&mut self) {
        let mut count = vec![0usize; self.faces.len()];
        for p in &mut self.panels {
            count[p.face] += 1;
            p.name = format!("{}-{:02}", letters(p.face), count[p.face]);
        }
    }
}

/// 0 → A, 25 → Z, 26 → AA, …
fn letters(mut k: usize) -> String {
    let mut out = Vec::new();
    loop {
        out.push(b'A' + (k % 26) as u8);
        if k < 26 {
            break;
        }
        k = k / 26 - 1;
    }
    out.reverse();
    out.into_iter().map(char::from).collect()
}

#[cfg(test)]
mod tests {
    use super::letters;

    #[test]
    fn face_letters_run_like_columns_of_a_table() {
        assert_eq!(["A", "Z", "AA", "AZ", "BA"], [0, 25, 26, 51, 52].map(letters).each_ref().map(String::as_str));
    }
}
