//! Faces with sharp edges of their own, knot lines across which the tangent plane jumps, as one face on each side: a profile that
//! was drawn as a polyline and extruded is planes that meet in edges.

use super::cut;
use super::polygon::{self, Polygon, Side};
use crate::brep::face::{Face, FileBoundary, FileEdge, TrimLoop, VANISHED};
use crate::brep::recognised_surface::bounds;
use crate::num::parallel;
use crate::spline::surface::Surface;
use std::sync::Arc;

/// A knot line at which a face has two tangent planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crease {
    /// 0: a line u = at, 1: a line v = at.
    pub axis: usize,
    /// Parameter.
    pub at: f64,
    /// Greatest angle between the tangent planes, rad.
    pub turn: f64,
    /// How far away the next crease or the end of the face is, on the side where it is nearer, mm; by a chord.
    pub breadth_estimate: f64,
}

/// Places of a line where tangent planes are compared.
const PLACES: usize = 24;
/// Share of the domain that lies between a knot line and the places where normals are taken.
const BESIDE: f64 = 1e-8;

/// Knot lines across which the normal turns by more than `angle` (rad), at samples within the box `[u0, u1, v0, v1]`.
pub(crate) fn creases(surface: &Surface, within: [f64; 4], angle: f64) -> Vec<Crease> {
    let normal = |p: [f64; 2]| surface.jet(p[0], p[1]).normal().try_normalize(0.0);
    let [u0, u1, v0, v1] = within;
    let (du, dv) = surface.domain();
    // Where control points coincide, simple knots are creases too.
    let (in_u, in_v) = (surface.knots_u.breaks(), surface.knots_v.breaks());
    let mut out = Vec::new();
    for (axis, lines, domain, across, along) in [(0, in_u, du, (u0, u1), (v0, v1)), (1, in_v, dv, (v0, v1), (u0, u1))] {
        let mut found: Vec<Crease> = Vec::new();
        let beside = BESIDE * (domain.1 - domain.0);
        for at in lines.into_iter().filter(|t| *t > across.0 && *t < across.1) {
            let turn = |k: usize| {
                let s = along.0 + (along.1 - along.0) * (k as f64 + 0.5) / PLACES as f64;
                let sides = [at - beside, at + beside].map(|t| normal(if axis == 0 { [t, s] } else { [s, t] }));
                Some(sides[0]?.angle(&sides[1]?))
            };
            let turn = (0..PLACES).filter_map(turn).fold(0.0, f64::max);
            if turn > angle {
                found.push(Crease { axis, at, turn, breadth_estimate: 0.0 });
            }
        }
        let middle = 0.5 * (along.0 + along.1);
        let point = |t: f64| if axis == 0 { surface.point(t, middle) } else { surface.point(middle, t) };
        let ends: Vec<f64> = found.iter().map(|c| c.at).collect();
        for (k, c) in found.iter_mut().enumerate() {
            let before = if k == 0 { across.0 } else { ends[k - 1] };
            let after = ends.get(k + 1).copied().unwrap_or(across.1);
            c.breadth_estimate =
                [before, after].map(|t| (point(t) - point(c.at)).norm()).into_iter().fold(f64::INFINITY, f64::min);
        }
        out.extend(found);
    }
    out
}

/// Faces cut at creases.
pub(crate) struct Uncreased {
    /// All faces: those without creases as they were, and the pieces of the others.
    pub faces: Vec<Face>,
    /// Numbers in the file of those that were cut.
    pub cut: Vec<u64>,
    /// Number of their pieces.
    pub pieces: usize,
}

/// Faces cut at those of their creases of more than `angle` (rad) that `wanted` names, where they can be cut. Regions stay what
/// they are, but for the rounding of corners on the cut, and surfaces to the bit where the knot is a full one;
/// [`Face::joint_bound`] says what rounding may else move. What the trim of a face misses must be proven before: a piece follows
/// but a part of the file's edges.
pub(crate) fn uncreased(faces: Vec<Face>, angle: f64, wanted: impl Fn(&Face, &Crease) -> bool + Sync) -> Uncreased {
    let each: Vec<Vec<Face>> = parallel::map(faces, |face| {
        let mut found = creases(&face.surface, bounds(&face), angle);
        found.retain(|c| wanted(&face, c));
        let cut = |f: Face, c| in_two(&f, c).unwrap_or_else(|| vec![f]);
        found.iter().fold(vec![face], |pieces, c| pieces.into_iter().flat_map(|f| cut(f, c)).collect())
    });
    let cut: Vec<&Vec<Face>> = each.iter().filter(|p| p.len() > 1).collect();
    let (numbers, pieces) = (cut.iter().map(|p| p[0].entity).collect(), cut.iter().map(|p| p.len()).sum());
    Uncreased { cut: numbers, pieces, faces: each.into_iter().flatten().collect() }
}

/// What lies on both sides of a crease; `None` where the face cannot be cut there.
fn in_two(face: &Face, crease: &Crease) -> Option<Vec<Face>> {
    let domain = [face.surface.knots_u.domain(), face.surface.knots_v.domain()];
    let &Crease { axis, at, .. } = crease;
    if !(at > domain[axis].0 && at < domain[axis].1) {
        return None;
    }
    let polygons: Vec<Polygon> = (0..face.loops.len()).map(|k| polygon(face, k)).collect();
    let known = face.boundary.iter().flat_map(|b| b.loops.iter().flatten()).map(|e| e.label);
    let labels = face.loops.iter().flat_map(|l| l.edge.iter().copied()).chain(known).filter(|l| *l != VANISHED);
    let mut label = labels.max().map_or(0, |l| l + 1);
    let cut = cut::in_two(&polygons, axis, at, &mut label).ok()?;
    let cut: Vec<Polygon> = cut.into_iter().filter_map(polygon::without_repeated).collect();
    let knots = if axis == 0 { &face.surface.knots_u } else { &face.surface.knots_v };
    let is_full = knots.distinct().iter().any(|(t, many)| *t == at && *many >= knots.degree());
    let size = face.surface.control.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let moved = if is_full { 0.0 } else { INSERTED * size };
    let mut out = Vec::new();
    for (part, is_side) in [((domain[axis].0, at), -1.0), ((at, domain[axis].1), 1.0)] {
        let here = cut.iter().filter(|p| side(p, axis, at) == is_side).cloned().collect();
        let mut ranges = domain;
        ranges[axis] = part;
        let surface = face.surface.restricted(ranges[0], ranges[1]).ok()?;
        for group in polygon::nested(here, true) {
            if polygon::first_contact(&group).is_some() {
                return None;
            }
            out.push(Face { joint_bound: face.joint_bound + moved, ..piece(face, surface.clone(), group) });
        }
    }
    // Holes that nothing holds are no pieces of the face.
    let area = |f: &[Polygon]| f.iter().map(Polygon::area).sum::<f64>();
    let whole: Vec<Polygon> = out.iter().flat_map(|f| (0..f.loops.len()).map(|k| polygon(f, k))).collect();
    ((area(&whole) - area(&polygons)).abs() <= SAME_AREA * area(&polygons).abs()).then(|| with_loops(out, face))
}

/// Share of the coordinates that knot insertion may move points by rounding: some units in the last place, with a margin.
const INSERTED: f64 = 1e-13;
/// Relative difference of areas that adding up may leave.
const SAME_AREA: f64 = 1e-9;

/// On which side of a line a polygon lies, as a sign.
fn side(p: &Polygon, axis: usize, at: f64) -> f64 {
    let farthest = p.points.iter().map(|q| q[axis] - at).max_by(|a, b| a.abs().total_cmp(&b.abs()));
    farthest.map_or(0.0, f64::signum)
}

/// Loop `k` of a face with what its sides follow.
fn polygon(face: &Face, k: usize) -> Polygon {
    let along = face.boundary.as_ref().and_then(|b| b.along.get(k));
    let side = |(i, label): (usize, &u32)| {
        let [from, to] = along.and_then(|a| a.get(i)).copied().unwrap_or([0.0; 2]);
        Side { label: *label, from, to }
    };
    Polygon { points: face.loops[k].points.clone(), edge: face.loops[k].edge.iter().enumerate().map(side).collect() }
}

/// The part of a face inside an outer polygon and its holes.
fn piece(face: &Face, surface: Surface, group: Vec<Polygon>) -> Face {
    let along = group.iter().map(|p| p.edge.iter().map(|s| [s.from, s.to]).collect()).collect();
    let labels = |p: &Polygon| p.edge.iter().map(|s| s.label).collect();
    let boundary = face.boundary.as_deref().cloned().map(|b| Arc::new(FileBoundary { along, ..b }));
    let loops = group.iter().map(|p| TrimLoop { points: p.points.clone(), edge: labels(p) }).collect();
    Face { surface, loops, boundary, ..face.clone() }
}

/// The pieces with the loops of the file that they follow; those that none follows stay with the first.
fn with_loops(mut pieces: Vec<Face>, face: &Face) -> Vec<Face> {
    let follows = |f: &Face, l: &[FileEdge]| l.iter().any(|e| f.loops.iter().any(|own| own.edge.contains(&e.label)));
    let Some(all) = face.boundary.as_ref().map(|b| b.loops.clone()) else { return pieces };
    let followed: Vec<bool> = all.iter().map(|l| pieces.iter().any(|f| follows(f, l))).collect();
    for (k, f) in pieces.iter_mut().enumerate() {
        let own = all.iter().zip(&followed).filter(|(l, followed)| follows(f, l) || (k == 0 && !**followed));
        let own: Vec<Vec<FileEdge>> = own.map(|(l, _)| l.clone()).collect();
        if let Some(b) = f.boundary.as_mut() {
            Arc::make_mut(b).loops = own;
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::area::area_estimate;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;
    use std::f64::consts::FRAC_PI_2;

    /// Planes of breadth 100 in a zigzag of right angles, 70 mm long.
    fn zigzag(count: usize) -> Face {
        let breaks: Vec<f64> = (0..=count).map(|k| k as f64).collect();
        let (ku, kv) = (Knots::clamped(1, &breaks).expect("knots"), Knots::clamped(1, &[0.0, 1.0]).expect("knots"));
        let at = |k: usize| (100.0 * k.div_ceil(2) as f64, 100.0 * (k / 2) as f64);
        let points: Vec<Vec3> =
            (0..=count).map(at).flat_map(|(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 70.0, z)]).collect();
        Face::untrimmed(Surface::new(ku, kv, &points, None).expect("surface"))
    }

    #[test]
    fn planes_of_a_zigzag_come_apart_with_their_holes() {
        let mut face = zigzag(3);
        assert_eq!(creases(&face.surface, [0.0, 3.0, 0.0, 1.0], 0.1).len(), 2);
        assert!((creases(&face.surface, [0.0, 3.0, 0.0, 1.0], 0.1)[0].turn - FRAC_PI_2).abs() < 1e-6);
        assert!(creases(&face.surface, [0.0, 0.9, 0.0, 1.0], 0.1).is_empty());
        // A hole over the first crease, one inside the third plane.
        let hole = |c: [f64; 2], r: f64, label: u32| TrimLoop {
            points: vec![[c[0] - r, c[1]], [c[0], c[1] + r], [c[0] + r, c[1]], [c[0], c[1] - r]],
            edge: (label..label + 4).collect(),
        };
        face.loops.extend([hole([1.0, 0.5], 0.2, 4), hole([2.5, 0.5], 0.1, 8)]);
        let whole = area_estimate(&face);
        let pieces = uncreased(vec![face.clone()], 0.1, |_, _| true).faces;
        assert_eq!(pieces.iter().map(|f| f.loops.len()).collect::<Vec<_>>(), [1, 1, 2]);
        let sum: f64 = pieces.iter().map(area_estimate).sum();
        assert!((sum - whole).abs() < 1e-9 * whole, "{sum} {whole}");
        for (k, f) in pieces.iter().enumerate() {
            let (k, [u0, u1, v0, v1]) = (k as f64, bounds(f));
            assert_eq!([u0, u1, v0, v1], [k, k + 1.0, 0.0, 1.0]);
            assert_eq!(f.surface.domain(), ((k, k + 1.0), (0.0, 1.0)));
            assert_eq!(f.surface.point(k + 0.25, 0.3), face.surface.point(k + 0.25, 0.3));
            assert!(polygon(f, 0).area() > 0.0);
        }
        // Sides keep the labels of the file's edges; those of the cut are new.
        assert!(pieces[1].loops[0].edge.iter().any(|l| (4..8).contains(l)));
        assert!(pieces[1].loops[0].edge.iter().any(|l| *l > 11));
    }

    #[test]
    fn borders_along_a_crease_stay_what_they_are() {
        // An L whose inner corner lies on the crease: one side of it runs along the line.
        let mut face = zigzag(2);
        face.loops[0] = TrimLoop {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [2.0, 0.5], [2.0, 1.0], [0.0, 1.0]],
            edge: (0..6).collect(),
        };
        let pieces = uncreased(vec![face.clone()], 0.1, |_, _| true).faces;
        assert_eq!(pieces.len(), 2);
        let of = |k: usize| (pieces[k].loops[0].points.len(), pieces[k].loops[0].edge.contains(&1));
        assert!(of(0).1);
        assert_eq!(of(1), (4, false));
        let area = |f: &Face| polygon(f, 0).area();
        assert!((area(&pieces[0]) - 1.0).abs() < 1e-15 && (area(&pieces[1]) - 0.5).abs() < 1e-15);
        // A face that a crease only touches has no pieces.
        face.loops[0].points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        face.loops[0].edge.truncate(4);
        assert_eq!(uncreased(vec![face], 0.1, |_, _| true).faces.len(), 1);
    }
}
