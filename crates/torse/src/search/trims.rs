//! Trims as fine as a tolerance asks for, and what is proven of their distance from the file's edges.

use crate::brep::face::Face;
use crate::brep::trim::{self, with_chords};
use crate::certify::claim::UpperBound;
use crate::certify::trims::trim_proof;
use crate::num::parallel;
use crate::reason::{FaceReason, Reason};

/// Share of the tolerance that the proven distance of trims from the file's edges may take.
pub(super) const TRIM_SHARE: f64 = 0.5;
/// Distances of trims from edges below this share of the tolerance are not told apart.
pub(crate) const TRIM_AIM: f64 = 0.002;
/// Share of the tolerance that chords of trims may keep from the file's edges.
const CHORDS_SHARE: f64 = 0.05;

/// Faces whose trims were assessed.
pub struct AssessedTrims {
    /// The faces, with finer trims where the tolerance asks for them.
    pub faces: Vec<Face>,
    /// Greatest distance of a trim from the file's edges, mm.
    pub bound: UpperBound,
    /// Trims that take too much of the tolerance.
    pub missed: Vec<Reason>,
}

/// Faces with trims as fine as the tolerance asks for and the proven distance of these from the file's edges, and where
/// that takes too much of the tolerance.
pub fn assess_trims(faces: Vec<Face>, tolerance: f64) -> AssessedTrims {
    let assessed = parallel::map(faces, |mut face| {
        let replaced = |face: &Face| {
            let bound = face.surface_bound();
            (bound > TRIM_SHARE * tolerance).then(|| FaceReason::Replaced { entity: face.entity, bound }.into())
        };
        if face.boundary.is_none() {
            let bound = trim_proof(&face, TRIM_AIM * tolerance).bound();
            let missed = replaced(&face);
            return (face, (bound, missed));
        }
        if let Some(finer) = with_chords(&face, CHORDS_SHARE * tolerance) {
            face = finer;
        }
        corners_on_knot_lines(&mut face);
        let proof = trim_proof(&face, TRIM_AIM * tolerance);
        let bound = proof.bound();
        face.set_trim_bound(bound.value());
        let trim = || FaceReason::Trim { entity: face.entity, edge: proof.edge(), bound: bound.value() }.into();
        let missed = replaced(&face).or_else(|| (bound.value() > TRIM_SHARE * tolerance).then(trim));
        (face, (bound, missed))
    });
    let (faces, found): (Vec<Face>, Vec<(UpperBound, Option<Reason>)>) = assessed.into_iter().unzip();
    let bound = UpperBound::largest(found.iter().map(|f| f.0));
    AssessedTrims { faces, bound, missed: found.into_iter().filter_map(|f| f.1).collect() }
}

/// A face of a sphere that is bounded by circles about one axis, parametrised about that, with a trim as fine as the tolerance asks
/// for, proven. `None` where it is none, or is so parametrised already.
pub(super) fn about_its_circles(face: &Face, tolerance: f64) -> Option<Face> {
    let mut face = trim::about_its_circles(face, CHORDS_SHARE * tolerance)?;
    corners_on_knot_lines(&mut face);
    let bound = trim_proof(&face, TRIM_AIM * tolerance).bound();
    face.set_trim_bound(bound.value());
    (bound.value() <= TRIM_SHARE * tolerance).then_some(face)
}

/// Share of the parameter range within which a corner of a trim counts as lying on a knot line: a few times the
/// rounding of readers' projections, far below any length that matters.
const ON_LINE: f64 = 1e-9;
/// Moves corners of the trims that miss a knot line, or the coordinate of another corner, by rounding only onto it, so that
/// no triangle crosses a line by a hair. From here on these corners are the definition of the face.
pub(super) fn corners_on_knot_lines(face: &mut Face) {
    for (d, breaks) in [face.surface.knots_u.breaks(), face.surface.knots_v.breaks()].into_iter().enumerate() {
        // No negative zero: corners are compared bit by bit.
        let mut all: Vec<f64> = face.loops.iter().flat_map(|l| &l.points).map(|p| p[d] + 0.0).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let (Some(lo), Some(hi)) = (all.first().copied(), all.last().copied()) else { continue };
        let extent = breaks.iter().fold(hi - lo, |m, k| m.max((k - breaks[0]).abs()));
        // Corners near a knot go there, others that differ by rounding only to the least of them; the outermost
        // ones are lines of the triangulation too.
        let mut to: Vec<(f64, f64)> = Vec::with_capacity(all.len());
        let mut before: Option<f64> = None;
        for x in all {
            let near = |k: f64| (k - x).abs() <= ON_LINE * extent;
            let knot = breaks.iter().copied().find(|&k| near(k));
            let at = knot.or(before.filter(|&b| near(b))).unwrap_or(x);
            before = Some(at);
            to.push((x, at));
        }
        for p in face.loops.iter_mut().flat_map(|l| &mut l.points) {
            p[d] += 0.0;
            if let Ok(k) = to.binary_search_by(|t| t.0.total_cmp(&p[d])) {
                p[d] = to[k].1;
            }
        }
    }
}
