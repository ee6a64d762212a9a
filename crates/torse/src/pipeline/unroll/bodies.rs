//! Bodies of a model, each unfolded for itself.

use super::carried;
use super::options::{UnrollError, UnrollOptions, UNFOLDED};
use crate::answer::skipped::Skipped;
use crate::brep::area::area_estimate;
use crate::brep::body::Body;
use crate::brep::boundary_stretch::boundary_stretches;
use crate::brep::face::Face;
use crate::control::Control;
use crate::develop::bends::BendSpacing;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::part::{flat_parts, BodyParts, FlatPart, PartOptions};
use crate::develop::unfold::sheet::is_open;
use crate::develop::unfold::tree::Joins;
use crate::geom::coarse::is_tolerance;
use crate::geom::BBox;
use crate::io::model::Model;
use crate::io::words;
use crate::num::parallel;
use crate::reason::{Item, Reason, Unlaid};
use std::collections::{BTreeMap, HashSet};
use std::sync::atomic::{AtomicUsize, Ordering};

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
    options.sheet.as_ref().map_or(Ok(()), |s| s.k.check())?;
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
    if let Joins::Named(edges) = &options.joins {
        let known: HashSet<u64> = faces.iter().flat_map(boundary_stretches).flatten().map(|r| r.entity).collect();
        if let Some(edge) = edges.iter().find(|e| !known.contains(e)) {
            return Err(UnrollError::Edge(*edge));
        }
    }
    let bodies = bodies_of(faces, options.tolerance, options.surfaces);
    let asked = PartOptions {
        k: options.k.clone(),
        surfaces: options.surfaces,
        sheet: options.sheet.clone(),
        spacing: BendSpacing { step: options.bend_step, facets: options.facets, ..BendSpacing::default() },
        joins: options.joins.clone(),
        ..PartOptions::new(options.tolerance)
    };
    let names = names(faces, &bodies);
    let count = AtomicUsize::new(0);
    let one = |(body, name): (&Vec<usize>, &String)| {
        if control.stopped() {
            return BodyParts { parts: Vec::new(), left: vec![(None, Unlaid::Stopped)] };
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
    let made: Vec<BodyParts> = parallel::map(bodies.iter().zip(&names), one);
    let (mut parts, mut left) = (Vec::new(), Vec::new());
    for ((found, body), name) in made.into_iter().zip(&bodies).zip(&names) {
        let before = parts.len();
        parts.extend(found.parts.into_iter().map(|mut p| {
            p.faces.iter_mut().for_each(|f| *f = body[*f]);
            p.shared.iter_mut().flat_map(|e| &mut e.parts).for_each(|k| *k += before);
            p
        }));
        let uncovered = |l: &(Option<usize>, Unlaid)| options.approximate.is_none() || l.0.is_none();
        left.extend(found.left.into_iter().filter(uncovered).map(|(face, reason)| {
            let reason = Reason::of(Item::Named(name.clone()), reason);
            match face.map(|k| &faces[body[k]]) {
                Some(f) => Skipped::of_file(f.entity, reason, Some(area_estimate(f))),
                None => Skipped::from(reason),
            }
        }));
    }
    for (k, p) in parts.iter_mut().enumerate() {
        p.pattern.panel = k;
    }
    if parts.is_empty() && (options.approximate.is_none() || !left.is_empty()) {
        let reason = left.first().map_or_else(|| "it has no faces".into(), |l: &Skipped| words::why(&l.reason));
        return Err(UnrollError::Nothing { bodies: bodies.len(), reason });
    }
    Ok((parts, left))
}

/// A model in groups of bodies, at most `count` of them in each, every body under the name that it has in the whole; what was
/// not read and what was noticed goes with the first group. Unrolling one after the other needs memory for one group only.
/// Sheets farther apart than `near` (mm) count as bodies where they are open, or with `surfaces`, for faces without thickness.
pub fn groups(model: Model, count: usize, near: f64, surfaces: bool) -> Vec<Model> {
    let bodies = bodies_of(&model.faces, near, surfaces);
    let names = names(&model.faces, &bodies);
    let mut group: Vec<(usize, &String)> = vec![(0, &model.unit); model.faces.len()];
    for ((k, body), name) in bodies.iter().enumerate().zip(&names) {
        body.iter().for_each(|f| group[*f] = (k / count.max(1), name));
    }
    let number = bodies.len().div_ceil(count.max(1));
    let mut out: Vec<Model> = (0..number).map(|_| like(&model)).collect();
    let of_group: Vec<usize> = group.iter().map(|g| g.0).collect();
    for (own, curves) in out.iter_mut().zip(carried::shared(&model, &of_group, number)) {
        own.curves = curves;
    }
    let put: Vec<(usize, String)> = group.into_iter().map(|(k, name)| (k, name.clone())).collect();
    if let Some(first) = out.first_mut() {
        (first.skipped, first.notes) = (model.skipped, model.notes);
    }
    for (mut face, (k, name)) in model.faces.into_iter().zip(put) {
        face.part = name;
        out[k].faces.push(face);
    }
    out
}

/// A model with the names of another one and nothing in it.
fn like(model: &Model) -> Model {
    Model {
        faces: Vec::new(),
        skipped: Vec::new(),
        unit: model.unit.clone(),
        notes: Vec::new(),
        products: model.products.clone(),
        curves: Vec::new(),
    }
}

/// The faces of every body. A body that is open somewhere, or any with `surfaces`, falls into what can hang together: faces
/// whose boxes are no farther apart than `near` (mm). Shells of a solid that do not touch, as about a hollow, stay one body.
fn bodies_of(faces: &[Face], near: f64, surfaces: bool) -> Vec<Vec<usize>> {
    let mut bodies: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (k, f) in faces.iter().enumerate() {
        bodies.entry(f.body).or_default().push(k);
    }
    let fallen = |body: Vec<usize>| {
        let sheets = sheets(faces, &body, near);
        let open = |sheet: &Vec<usize>| is_open(&Body::new(sheet.iter().map(|k| &faces[*k]).collect()));
        match sheets.len() > 1 && (surfaces || sheets.iter().any(open)) {
            true => sheets,
            false => vec![body],
        }
    };
    bodies.into_values().flat_map(fallen).collect()
}

/// Faces in groups whose boxes touch, in the order of their first faces.
fn sheets(faces: &[Face], body: &[usize], near: f64) -> Vec<Vec<usize>> {
    let mut boxes: Vec<(usize, BBox)> = body.iter().map(|k| faces[*k].surface.bbox()).enumerate().collect();
    boxes.sort_by(|a, b| a.1.min.x.total_cmp(&b.1.min.x));
    let mut first: Vec<usize> = (0..body.len()).collect();
    for (n, (i, a)) in boxes.iter().enumerate() {
        let rest = boxes[n + 1..].iter().take_while(|(_, b)| b.min.x <= a.max.x + near);
        for (j, _) in rest.filter(|(_, b)| (0..3).all(|d| b.min[d] <= a.max[d] + near && a.min[d] <= b.max[d] + near)) {
            let (p, q) = (root(&mut first, *i), root(&mut first, *j));
            first[p.max(q)] = p.min(q);
        }
    }
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (n, face) in body.iter().enumerate() {
        out.entry(root(&mut first, n)).or_default().push(*face);
    }
    out.into_values().collect()
}

/// The first of a group, ways to it shortened.
fn root(first: &mut [usize], mut k: usize) -> usize {
    while first[k] != k {
        first[k] = first[first[k]];
        k = first[k];
    }
    k
}

/// Names of bodies: that of their part, numbered where several bodies have one, and where a body is in several sheets.
fn names(faces: &[Face], bodies: &[Vec<usize>]) -> Vec<String> {
    let plain = |body: &Vec<usize>| {
        let name = body.iter().map(|k| faces[*k].part.as_str()).find(|n| !n.is_empty());
        name.unwrap_or("part").to_owned()
    };
    // Bodies of every name, in order, with the number of their sheets.
    let mut all: BTreeMap<String, Vec<(u32, usize)>> = BTreeMap::new();
    for body in bodies {
        let number = faces[body[0]].body;
        let of_name = all.entry(plain(body)).or_default();
        match of_name.last_mut().filter(|last| last.0 == number) {
            Some(last) => last.1 += 1,
            None => of_name.push((number, 1)),
        }
    }
    let mut used: BTreeMap<(String, u32), usize> = BTreeMap::new();
    let numbered = |body: &Vec<usize>| {
        let (name, number) = (plain(body), faces[body[0]].body);
        let of_name = &all[&name];
        let k = of_name.iter().position(|b| b.0 == number).unwrap_or_default();
        let count = used.entry((name.clone(), number)).or_default();
        *count += 1;
        let whole = if of_name.len() == 1 { name.clone() } else { format!("{name} {}", k + 1) };
        if of_name[k].1 == 1 {
            whole
        } else {
            format!("{whole}-{count}")
        }
    };
    bodies.iter().map(numbered).collect()
}
