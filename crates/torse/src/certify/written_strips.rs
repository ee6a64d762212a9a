//! Untrimmed strips as a STEP file holds them, against the strips that were judged.
//!
//! A strip is bounded by its rails and end rulings, so that surface and edges both follow from its control points:
//! every number of the file must be one of them. Control points of rational strips are divided by their weights on
//! writing, and strips called plane are written as planes: what these move is bounded, with straight edges as the lines
//! between their vertices \[certificate, 7\].

use super::vector::{cross, dot, length, length_bound, V3};
use super::written::{recorded, surface_moved, Fault, WrittenCertificate};
use crate::num::interval::Interval;
use crate::patchwork::written::{WrittenBase, WrittenCurve, WrittenSide, WrittenStrip};
use crate::reason::{Differs, Item, Near, Reason, WrittenFault};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;

/// Compares the faces of a STEP file with the strips that were judged. The bound is that of the distance of surfaces,
/// edges and vertices from the strips.
pub fn strips(strips: &[&Strip], faces: &[WrittenStrip]) -> WrittenCertificate {
    if faces.len() != strips.len() {
        let (found, wanted) = (faces.len(), strips.len());
        return WrittenCertificate::of(Err(WrittenFault::Number { found, wanted, of: Near::Strips }.into()));
    }
    let found = strips.iter().zip(faces).map(|(strip, face)| {
        if face.name != strip.name {
            return Err(misnamed(face.entity, &face.name, &strip.name));
        }
        strip_moved(strip, face).map_err(|fault| recorded(fault, Item::Strip(strip.name.clone())))
    });
    WrittenCertificate::of(found.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))))
}

/// A face with the name of another thing.
pub(super) fn misnamed(entity: u64, found: &str, wanted: &str) -> Reason {
    WrittenFault::Name { entity, found: found.into(), wanted: wanted.into() }.into()
}

fn strip_moved(strip: &Strip, face: &WrittenStrip) -> Result<f64, Fault> {
    let here = |what: Differs| (face.entity, what.into());
    let mut moved = match &face.surface {
        WrittenBase::Spline(s) => surface_moved(&strip.patch, s).map_err(here)?,
        WrittenBase::Plane { point, normal } => {
            off_plane(&strip.patch, point, normal).ok_or_else(|| here(Differs::NoPlane))?
        }
        _ => return Err(here(Differs::SurfaceKind)),
    };
    // Rail, last ruling, and both others backwards; a rail that is a point has no edge.
    let (net, row) = (&strip.patch.control, strip.patch.row());
    let ruling = |first: usize| {
        Some(Curve { knots: strip.patch.knots_v.clone(), control: net.get(first..first + row)?.to_vec() })
    };
    let last = net.len().saturating_sub(row);
    let sides = [
        (Some(strip.rail(0)), true, strip.is_point(0)),
        (ruling(last), true, false),
        (Some(strip.rail(1)), false, strip.is_point(1)),
        (ruling(0), false, false),
    ];
    let wanted: Vec<_> = sides.into_iter().filter(|s| !s.2).collect();
    if wanted.len() != face.sides.len() {
        return Err(here(Differs::Edges));
    }
    for (k, ((curve, forward, _), side)) in wanted.iter().zip(&face.sides).enumerate() {
        let fault = |what: Differs| (side.entity, what.into());
        if side.forward != *forward {
            return Err(fault(Differs::EdgeSense));
        }
        let before = &face.sides[(k + face.sides.len() - 1) % face.sides.len()];
        if side.vertices[usize::from(!side.forward)] != before.vertices[usize::from(before.forward)] {
            return Err(fault(Differs::Follows));
        }
        let curve = curve.as_ref().ok_or_else(|| fault(Differs::NoRuling))?;
        moved = moved.max(side_moved(curve, side).ok_or_else(|| fault(Differs::Edge))?);
    }
    Ok(moved)
}

/// Bound of the distance of a patch's points from a plane.
pub(super) fn off_plane(patch: &Surface, point: &[f64; 3], normal: &[f64; 3]) -> Option<f64> {
    let n: V3<Interval> = normal.map(Interval::point);
    let size = length(&n);
    if !(size.lo > 0.0 && size.is_finite()) {
        return None;
    }
    let far = |c: &[f64; 4]| {
        let w = difference(&affine(c), point);
        (dot(&w, &n) / size).mag()
    };
    // A point of the patch is a mean of its control points.
    worst(patch.control.iter().map(far))
}

/// The greatest of some numbers; `None` if one of them is not finite.
pub(super) fn worst(numbers: impl IntoIterator<Item = f64>) -> Option<f64> {
    numbers.into_iter().try_fold(0.0f64, |m, x| x.is_finite().then(|| m.max(x)))
}

/// Bound of the distance of an edge's vertices from the ends of the side that it stands for.
pub(super) fn ends_moved(own: &Curve<4>, side: &WrittenSide) -> Option<f64> {
    let (first, last) = (affine(own.control.first()?), affine(own.control.last()?));
    worst(side.vertices.iter().zip([&first, &last]).map(|(vertex, end)| length_bound(&difference(end, vertex))))
}

/// Bound of the distance of an edge and its vertices from the side that it stands for, point by point; `None` for circles.
pub(super) fn side_moved(own: &Curve<4>, side: &WrittenSide) -> Option<f64> {
    let (first, last) = (affine(own.control.first()?), affine(own.control.last()?));
    let ends = ends_moved(own, side)?;
    let curve = match &side.curve {
        WrittenCurve::Line { point, direction } => {
            // The edge is the stretch of the line between its vertices; the side must be straight.
            let straight = own.control.len() == 2;
            let d = direction.map(Interval::point);
            let size = length(&d);
            let off = |p: &V3<Interval>| (length(&cross(&difference(p, point), &d)) / size).hi;
            (straight && size.lo > 0.0 && size.is_finite()).then(|| worst([off(&first), off(&last)]))??
        }
        WrittenCurve::Circle { .. } => return None,
        WrittenCurve::Spline { curve, weights } => {
            let rational = own.control.iter().any(|c| c[3].total_cmp(&1.0).is_ne());
            let same_weights = match weights.len() {
                0 => !rational,
                n => n == own.control.len() && own.control.iter().zip(weights).all(|(c, w)| c[3] == *w && *w > 0.0),
            };
            let same = curve.knots.degree() == own.knots.degree() && curve.knots.values() == own.knots.values();
            let whole = same && same_weights && curve.control.len() == own.control.len();
            let pairs = own.control.iter().zip(&curve.control);
            let far = pairs.map(|(c, p)| length_bound(&difference(&affine(c), p)));
            whole.then(|| worst(far))??
        }
    };
    worst([ends, curve])
}

pub(super) fn affine(c: &[f64; 4]) -> V3<Interval> {
    let rational = c[3].total_cmp(&1.0).is_ne();
    [0, 1, 2]
        .map(|d: usize| if rational { Interval::point(c[d]) / Interval::point(c[3]) } else { Interval::point(c[d]) })
}

pub(super) fn difference(p: &V3<Interval>, q: &[f64; 3]) -> V3<Interval> {
    [0, 1, 2].map(|d: usize| p[d] - Interval::point(q[d]))
}
