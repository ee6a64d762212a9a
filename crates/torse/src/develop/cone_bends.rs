//! How the sheet of a chain of cones bends: lines about which it turns by equal angles, drawn inside the outline, with their
//! radii. Where one piece passes into the next nothing bends more than elsewhere.

use super::bends::{self, BendSpacing, DevelopedRuling, Plane, ProfileLine, TurnProfile};
use super::cones::develop;
use super::shop::roll::outlines;
use super::shop::sections::clipped;
use crate::geom::Vec2;
use crate::patchwork::pattern::Pattern;
use crate::torse::cone::part::{ConePart, PartCurve, PartEdge};
use crate::torse::cone::spline::{ConeSpline, Segment, Shape};

/// Places on a segment at which its planes are looked at: it turns evenly.
const PLACES: usize = 64;
/// Share of the pattern's length below which pieces of lines are not drawn.
const SHORTEST: f64 = 0.002;

/// Samples of an edge where a part's reach is sought.
const SAMPLES: usize = 12;

/// A place on a chain: segment and share of its turn.
type ChainPlace = (usize, f64);

/// Draws the bend lines of a chain, or of what a part of it reaches, into a pattern that has its contours and sizes. It is seen
/// from the side of the normals.
pub(crate) fn draw_bends(pattern: &mut Pattern, spline: &ConeSpline, part: Option<&ConePart>, spacing: &BendSpacing) {
    let flats = develop(spline, Vec2::zeros(), 0.0);
    let whole = flats.len().checked_sub(1).map(|last| [(0, 0.0), (last, 1.0)]);
    let Some([first, last]) = part.map_or(whole, range) else { return };
    let mut profile: TurnProfile<ChainPlace> = TurnProfile::new();
    let mut before: Option<Plane> = None;
    for k in first.0..=last.0 {
        let Some(segment) = spline.segments.get(k) else { continue };
        let (from, to) = (if k == first.0 { first.1 } else { 0.0 }, if k == last.0 { last.1 } else { 1.0 });
        let middle = |f: f64| 0.5 * (segment.edge(0, f) + segment.edge(1, f));
        for i in usize::from(before.is_some())..=PLACES {
            let at = |i: usize| from + (to - from) * i as f64 / PLACES as f64;
            let (plane, step) = (plane(segment, at(i)), i.saturating_sub(1));
            let length = segment.point(at(i), middle(at(i))) - segment.point(at(step), middle(at(step)));
            let turn = before.map_or(0.0, |b| b.turn(&plane));
            profile.push((k, at(i)), (turn, None), length.dot(&plane.across).abs());
            before = Some(plane);
        }
    }
    if profile.len() < 2 {
        return;
    }
    let place = |line: &ProfileLine| {
        let [(j, a), (k, b)] = profile.around(line.after)?;
        // A segment begins where the one before ends.
        let a = if j == k { a } else { 0.0 };
        Some((k, a + (b - a) * line.share))
    };
    let exact = |line: &ProfileLine, _| {
        let (k, f) = place(line)?;
        let (segment, flat) = (spline.segments.get(k)?, flats.get(k)?);
        let ends = [segment.edge(0, f), segment.edge(1, f)];
        let Plane { normal, across } = plane(segment, f);
        let radii = ends.map(|r| radius(segment, r));
        Some(DevelopedRuling {
            flat: ends.map(|r| flat.point(f, r)),
            space: ends.map(|r| segment.point(f, r)),
            across,
            normal,
            radii,
        })
    };
    let loops = outlines(pattern, pattern.length);
    let inset = pattern.contour_error.max(0.0);
    let draw = |asked: &BendSpacing| {
        let (mut rulings, mut bent) = (Vec::new(), Vec::new());
        for line in bends::dense(&profile, profile.lines(asked, pattern.length), asked, pattern.length, &exact) {
            let Some(ruling) = exact(&line, false) else { continue };
            let [a, b] = ruling.flat;
            for piece in clipped(&[a, b], &loops) {
                let (Some(&p), Some(&q)) = (piece.first(), piece.last()) else { continue };
                let length = (q - p).norm();
                if length > SHORTEST * pattern.length + 2.0 * inset {
                    let d = (q - p) * (inset / length);
                    rulings.push([p + d, q - d]);
                    // Radii grow evenly along a ruling.
                    let [r, s] = ruling.radii;
                    let at = |x: &Vec2| {
                        let share = (x - a).dot(&(b - a)) / (b - a).norm_squared();
                        if r.is_finite() {
                            r + (s - r) * share
                        } else {
                            r
                        }
                    };
                    bent.push(line.bend([[at(&p), at(&q)]; 2]));
                }
            }
        }
        (rulings, bent)
    };
    (pattern.rulings, pattern.bends) = bends::kept_low(spacing, draw);
}

/// The first and the last place of a chain that a part reaches (sampled).
fn range(part: &ConePart) -> Option<[ChainPlace; 2]> {
    let of_edge = |e: &PartEdge| -> Vec<ChainPlace> {
        let PartCurve::Free { face, trim, .. } = &e.curve else { return Vec::new() };
        let Some(piece) = part.faces.get(*face) else { return Vec::new() };
        let at = |i: usize| piece.blank.coordinates(trim.point(i as f64 / SAMPLES as f64)).0[0];
        (0..=SAMPLES).map(|i| (piece.segment, at(i).clamp(0.0, 1.0))).collect()
    };
    let used: Vec<usize> = part.faces.iter().flat_map(|f| f.loops.iter().flatten()).map(|u| u.0).collect();
    let edges = || used.iter().filter_map(|e| part.edges.get(*e));
    let corners = edges().flat_map(|e| [e.start, e.end]).filter_map(|v| part.places.get(v)).map(|(k, p)| (*k, p[0]));
    let all: Vec<ChainPlace> = corners.chain(edges().flat_map(of_edge)).collect();
    let order = |a: &&ChainPlace, b: &&ChainPlace| (a.0 as f64 + a.1).total_cmp(&(b.0 as f64 + b.1));
    Some([*all.iter().min_by(order)?, *all.iter().max_by(order)?])
}

fn plane(segment: &Segment, f: f64) -> Plane {
    let e = segment.element(f);
    Plane { normal: e.normal, across: e.forward }
}

/// Radius of curvature across the rulings at the coordinate r, mm: `t tan γ` at the distance t from the vertex of a cone.
fn radius(segment: &Segment, r: f64) -> f64 {
    match segment.shape {
        Shape::Cone { distance, cos_gamma, sin_gamma, .. } => ((distance + r) * sin_gamma / cos_gamma).abs(),
        Shape::Cylinder { radius, .. } => radius.abs(),
        Shape::Flat { .. } => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::super::cones::cone_pattern;
    use super::*;
    use crate::geom::Vec3;
    use crate::patchwork::pattern::BendSense;
    use crate::torse::g1_element::G1Element;

    /// Half a turn of a segment that begins at a given place, in two pieces.
    fn halves(shape: impl Fn(f64) -> Shape) -> ConeSpline {
        let start = G1Element { point: Vec3::zeros(), direction: Vec3::x(), forward: Vec3::y(), normal: Vec3::z() };
        let edges = [[0.0; 3], [300.0; 3]];
        let first = Segment { start, shape: shape(1.0), edges };
        let second = Segment { start: first.end(), shape: shape(1.0), edges };
        ConeSpline { segments: vec![first, second] }
    }

    fn drawn(spline: &ConeSpline) -> Pattern {
        let spacing = BendSpacing { greatest: 1.0, ..BendSpacing::default() };
        let mut pattern = cone_pattern(spline, "a", 0.01);
        draw_bends(&mut pattern, spline, None, &spacing);
        pattern
    }

    #[test]
    fn a_pipe_in_pieces_bends_evenly_with_its_own_radius() {
        let half = std::f64::consts::FRAC_PI_2;
        let pipe = drawn(&halves(|_| Shape::Cylinder { radius: -250.0, angle: half }));
        assert_eq!(pipe.rulings.len(), 36, "five degrees each");
        let all: f64 = pipe.bends.iter().map(|b| b.angle).sum();
        assert!((all - 2.0 * half).abs() < 1e-9, "{all}");
        for b in &pipe.bends {
            assert!(b.radii.iter().all(|r| (r - 250.0).abs() < 1e-9), "{b:?}");
            // The normals look to the axis, and the sheet bends towards them.
            assert_eq!(b.sense, BendSense::Up);
        }
        for w in pipe.rulings.windows(2) {
            let step = w[1][0].x.hypot(w[1][0].y) - w[0][0].x.hypot(w[0][0].y);
            assert!((w[1][0] - w[0][0]).norm() - 250.0 * 5.0f64.to_radians() < 1e-6, "{step}");
        }
    }

    #[test]
    fn a_cone_has_radii_that_grow_along_its_lines_and_a_plane_has_no_lines() {
        let (s, c) = 0.4f64.sin_cos();
        let cone = drawn(&halves(|_| Shape::Cone { distance: 100.0, cos_gamma: c, sin_gamma: s, angle: 1.0 }));
        assert!(cone.rulings.len() > 10);
        for b in &cone.bends {
            let mut radii = b.radii;
            radii.sort_by(f64::total_cmp);
            let expected = [100.0, 400.0].map(|t| t * s / c);
            assert!(radii.iter().zip(expected).all(|(r, e)| (r / e - 1.0).abs() < 1e-3), "{radii:?} {expected:?}");
        }
        let plane = drawn(&halves(|_| Shape::Flat { width: 100.0 }));
        assert!(plane.rulings.is_empty() && plane.bends.is_empty());
    }
}
