//! Bodies of a model, each unfolded for itself.

use super::{UnrollError, UnrollOptions, UNFOLDED};
use crate::answer::skipped::Skipped;
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::control::Control;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::part::{flat_parts, BodyParts, FlatPart, PartOptions};
use crate::geom::coarse::is_tolerance;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Why a body is left out of a job that was stopped.
const STOPPED: &str = "the job was stopped before it was unfolded";

/// Flat parts of a model, without panels in space; `faces` of the parts are indices into `faces`. The second list says
/// what is left out: where the job is stopped, bodies that were not begun; not faces that are to be covered.
///
/// # Errors
/// See [`UnrollError`].
pub(super) fn flat_parts_of(
    faces: &[Face],
    options: &UnrollOptions,
    control: &Control,
) -> Result<(Vec<FlatPart>, Vec<Skipped>), UnrollError> {
    if !is_tolerance(options.tolerance) {
        return Err(UnrollError::Tolerance(options.tolerance));
    }
    options.k.check()?;
    if options.surfaces && options.k != KFactor::default() {
        return Err(UnrollError::KWithoutThickness);
    }
    if let Some(approximate) = options.approximate {
        if !options.surfaces {
            return Err(UnrollError::CoversSurfacesOnly);
        }
        if !is_tolerance(approximate) {
            return Err(UnrollError::Tolerance(approximate));
        }
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
    let count = AtomicUsize::new(0);
    let one = |(body, name): (&Vec<usize>, &String)| {
        if control.stopped() {
            return BodyParts { parts: Vec::new(), left: vec![(None, STOPPED.into())] };
        }
        let made = flat_parts(&body.iter().map(|k| &faces[*k]).collect::<Vec<_>>(), name, &asked);
        let done = 1 + count.fetch_add(1, Ordering::Relaxed);
        control.report(
            "unfolding",
            UNFOLDED * done as f64 / bodies.len() as f64,
            format!("{done} of {} bodies", bodies.len()),
        );
        made
    };
    let made: Vec<BodyParts> = bodies.par_iter().zip(&names).map(one).collect();
    let (mut parts, mut left) = (Vec::new(), Vec::new());
    for ((found, body), name) in made.into_iter().zip(&bodies).zip(&names) {
        parts.extend(found.parts.into_iter().map(|mut p| {
            p.faces.iter_mut().for_each(|f| *f = body[*f]);
            p
        }));
        let uncovered = |l: &(Option<usize>, String)| options.approximate.is_none() || l.0.is_none();
        left.extend(found.left.into_iter().filter(uncovered).map(
            |(face, reason)| match face.map(|k| &faces[body[k]]) {
                Some(f) => Skipped::of_file(f.entity, format!("{name}: {reason}"), Some(area_estimate(f))),
                None => Skipped::from(format!("{name}: {reason}")),
            },
        ));
    }
    for (k, p) in parts.iter_mut().enumerate() {
        p.pattern.panel = k;
    }
    if parts.is_empty() && (options.approximate.is_none() || !left.is_empty()) {
        let reason = left.first().map_or_else(|| "it has no faces".into(), |l: &Skipped| l.reason.clone());
        return Err(UnrollError::Nothing { bodies: bodies.len(), reason });
    }
    Ok((parts, left))
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
