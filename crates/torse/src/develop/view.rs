//! From which side patterns of strips are seen: outside by the rule of `outward`, whatever the order of rails was
//! (docs/algorithms/panels.md, "The side that is seen").

use super::bends::BendSpacing;
use crate::geom::outward::{middle, outward};
use crate::geom::Vec3;
use crate::num::parallel;
use crate::patchwork::outside::outward as faces_outward;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::pattern::{Pattern, ViewSide};
use crate::torse::cone::spline::ConeSpline;
use crate::torse::strip::Strip;

/// How patterns are drawn; default: seen from outside, lines every 5°.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Side of the model from which they are seen; default outside.
    pub view: ViewSide,
    /// How far apart rulings are drawn; default every 5° of turn, within a hundredth and a twentieth of the length.
    pub bends: BendSpacing,
}

/// Places along a strip, and across it, at which its sides are looked at.
const PLACES: (usize, usize) = (24, 3);

/// Points of a strip with its normals, as long as the area that they stand for, on the side to which ruling × rail points.
pub(crate) fn sides(strip: &Strip) -> Vec<(Vec3, Vec3)> {
    let (a, b) = strip.domain();
    let share = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    (0..PLACES.0 * PLACES.1)
        .map(|k| {
            let u = a + (b - a) * share(k / PLACES.1, PLACES.0);
            let j = strip.patch.jet(u, share(k % PLACES.1, PLACES.1));
            (j.p, j.dv.cross(&j.du) * ((b - a) / (PLACES.0 * PLACES.1) as f64))
        })
        .collect()
}

/// As [`sides`] for a chain of cones, on the side of its normals.
pub(crate) fn cone_sides(spline: &ConeSpline) -> Vec<(Vec3, Vec3)> {
    let mut out = Vec::new();
    for s in &spline.segments {
        for k in 0..PLACES.0 {
            let at = |k: usize| k as f64 / PLACES.0 as f64;
            let f = 0.5 * (at(k) + at(k + 1));
            let (lo, hi) = (s.edge(0, f), s.edge(1, f));
            let middle = 0.5 * (lo + hi);
            let area = (s.point(at(k + 1), middle) - s.point(at(k), middle)).norm() * (hi - lo).abs();
            out.push((s.point(f, middle), s.element(f).normal * area));
        }
    }
    out
}

/// A pattern of a chain of cones, developed on the side of its normals, as it is seen from the side that is wanted; outside
/// is away from its own middle.
pub(crate) fn cones_viewed(pattern: Pattern, spline: &ConeSpline, view: ViewSide) -> Pattern {
    let all = cone_sides(spline);
    let seen = if outward(&all, &middle(&all)) > 0.0 { ViewSide::Outside } else { ViewSide::Inside };
    seen_from(Pattern { view: seen, ..pattern }, view)
}

/// Middle of all strips of a job.
pub(crate) fn centre(strips: &[Strip]) -> Vec3 {
    let all: Vec<(Vec3, Vec3)> = strips.iter().flat_map(sides).collect();
    middle(&all)
}

/// A pattern of a chain of strips, developed with `side`, as it is seen from the side of the model that is wanted;
/// `centre` is the middle of all strips.
pub(crate) fn viewed(pattern: Pattern, chain: &[&Strip], side: f64, centre: &Vec3, view: ViewSide) -> Pattern {
    let all: Vec<(Vec3, Vec3)> = chain.iter().flat_map(|s| sides(s)).map(|(x, n)| (x, n * side)).collect();
    let seen = if outward(&all, centre) > 0.0 { ViewSide::Outside } else { ViewSide::Inside };
    seen_from(Pattern { view: seen, ..pattern }, view)
}

/// Patterns of panels on faces seen from the side that is wanted. They come as seen from the side to which the file says
/// that a face looks.
pub(crate) fn panels_viewed(patchwork: &Patchwork, patterns: Vec<Pattern>, view: ViewSide) -> Vec<Pattern> {
    let outward = faces_outward(patchwork);
    let wanted = |pattern: Pattern| {
        let face = patchwork.panels[pattern.panel].face();
        let of = face.and_then(|f| Some((outward.get(f)?, patchwork.faces.get(f)?)));
        let as_outside = of.is_some_and(|(outward, face)| (*outward < 0.0) == face.reversed);
        let seen = if as_outside { ViewSide::Outside } else { ViewSide::Inside };
        seen_from(Pattern { view: seen, ..pattern }, view)
    };
    parallel::map(patterns, wanted)
}

/// A pattern as it is seen from the side that is wanted.
pub(crate) fn seen_from(pattern: Pattern, view: ViewSide) -> Pattern {
    if pattern.view == view {
        pattern
    } else {
        pattern.turned_over()
    }
}
