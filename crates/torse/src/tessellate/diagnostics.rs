//! What shows how surfaces bend and meet: Gauss curvature at vertices, and angles along lines where panels meet. Measured.

use crate::geom::box_tree::BoxTree;
use crate::geom::mesh::Mesh;
use crate::geom::{BBox, Vec3};
use crate::num::hash::HashMap;
use crate::num::parallel;
use crate::spline::surface::SurfaceJet;
use crate::torse::ruled_point::RuledPoint;
use crate::torse::strip::Strip;

/// Gauss curvature (1/mm²) of a strip over a grid, v running fastest; 0 where there is no tangent plane.
pub fn strip_curvature(strip: &Strip, u: &[f64], v: &[f64]) -> Vec<f64> {
    let row = |&s: &f64| {
        let (a, b) = (strip.patch.jet(s, 0.0), strip.patch.jet(s, 1.0));
        let point = RuledPoint::between(a.du, b.du, b.p - a.p);
        let length = (b.p - a.p).norm();
        v.iter().map(move |t| finite(point.gauss_curvature(t * length))).collect::<Vec<f64>>()
    };
    u.iter().flat_map(row).collect()
}

/// Gauss curvature (1/mm²) of a surface; 0 where it has no tangent plane.
pub fn curvature(jet: &SurfaceJet) -> f64 {
    let n = jet.normal();
    let area = n.norm_squared();
    // The second form with the unnormalised normal: two lengths of it too many.
    let [l, m, k] = jet.second_form(&n);
    finite((l * k - m.powi(2)) / (area * area))
}

fn finite(x: f64) -> f64 {
    if x.is_finite() {
        x
    } else {
        0.0
    }
}

/// An edge of a mesh that belongs to one triangle only.
struct Edge {
    panel: usize,
    ends: [Vec3; 2],
    normal: Vec3,
}

/// Edges count as one line if they run alike and are no farther apart than this share of their length, or than what the
/// caller allows.
const BESIDE: f64 = 0.1;
/// Edges of neighbours are looked for as if they were at most so many times as long.
const REACH: f64 = 4.0;
/// Sine of the angle between edges of one line at most.
const ALIKE: f64 = 0.3;

/// Pieces of lines along which meshes meet, with the angle (rad, up to a right angle) between the tangent planes of both;
/// borders may be `apart` (mm).
pub fn joints(meshes: &[&Mesh], apart: f64) -> Vec<([Vec3; 2], f64)> {
    let edges: Vec<Edge> = meshes.iter().enumerate().flat_map(|(k, m)| border(k, m)).collect();
    let boxes = |i: usize| BBox::of(edges[i].ends.iter());
    let tree = BoxTree::new(edges.len(), &boxes);
    let found = |e: &Edge| {
        let middle = (e.ends[0] + e.ends[1]) * 0.5;
        let length = (e.ends[1] - e.ends[0]).norm();
        let off = |i: usize| match &edges[i] {
            other if other.panel == e.panel => f64::INFINITY,
            other => beside(&middle, &other.ends),
        };
        // Edges of other meshes are as long, or several are to one of these.
        let near = apart.max(BESIDE * REACH * length);
        let (i, sq) = tree.nearest_within(&middle, near * near, &off)?;
        let other = &edges[i];
        let longest = length.max((other.ends[1] - other.ends[0]).norm());
        let alike = |p: Vec3, q: Vec3| p.cross(&q).norm() <= ALIKE * p.norm() * q.norm();
        let one =
            sq.sqrt() <= apart.max(BESIDE * longest) && alike(e.ends[1] - e.ends[0], other.ends[1] - other.ends[0]);
        // Every line is told once, by the panel that comes first.
        (other.panel > e.panel && one).then(|| {
            let angle = e.normal.cross(&other.normal).norm().atan2(e.normal.dot(&other.normal).abs());
            (e.ends, angle)
        })
    };
    parallel::map(edges.iter(), found).into_iter().flatten().collect()
}

/// Squared distance of a point from a segment.
fn beside(x: &Vec3, [a, b]: &[Vec3; 2]) -> f64 {
    let d = b - a;
    let t = ((x - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
    let t = if t.is_finite() { t } else { 0.0 };
    (a + d * t - x).norm_squared()
}

/// Edges at the border of a mesh, with the mean of the normals at their ends.
fn border(panel: usize, mesh: &Mesh) -> Vec<Edge> {
    let mut used: HashMap<[u32; 2], (u32, [u32; 3])> = HashMap::default();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            used.entry([a.min(b), a.max(b)]).or_insert((0, *t)).0 += 1;
        }
    }
    let at = |k: u32| mesh.positions.get(k as usize).copied();
    let edge = |([a, b], (_, t)): ([u32; 2], (u32, [u32; 3]))| {
        let ends = [at(a)?, at(b)?];
        let [p, q, r] = [at(t[0])?, at(t[1])?, at(t[2])?];
        let flat = (q - p).cross(&(r - p)).try_normalize(0.0)?;
        let known = |k: u32| mesh.normals.get(k as usize).filter(|n| n.norm_squared() > 0.0).copied();
        let normal = match (known(a), known(b)) {
            (Some(n), Some(m)) => (n + m).try_normalize(0.0).unwrap_or(flat),
            _ => flat,
        };
        Some(Edge { panel, ends, normal })
    };
    let mut out: Vec<_> = used.into_iter().filter(|u| u.1 .0 == 1).collect();
    out.sort_by_key(|u| u.0);
    out.into_iter().filter_map(edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::torse::form::PanelKind;

    #[test]
    fn curvatures_are_those_of_the_closed_forms() {
        // z = x y / 100 over 40 × 30: K = −1e-4 / (1 + (x² + y²)/1e4)².
        let x = Vec3::new;
        let strip = Strip::quad(
            "s",
            PanelKind::Ruled,
            [x(0.0, 0.0, 0.0), x(0.0, 30.0, 0.0)],
            [x(40.0, 0.0, 0.0), x(40.0, 30.0, 12.0)],
        );
        let found = strip_curvature(&strip.expect("a strip"), &[0.0, 0.5, 1.0], &[0.0, 1.0]);
        for (k, (x, y)) in
            [(0.0, 0.0), (0.0, 30.0), (20.0, 0.0), (20.0, 30.0), (40.0, 0.0), (40.0, 30.0)].iter().enumerate()
        {
            let wanted = -1e-4 / (1.0 + (x * x + y * y) / 1e4f64).powi(2);
            assert!((found[k] - wanted).abs() < 1e-12, "{k}: {} {wanted}", found[k]);
        }
        let sphere = crate::brep::support_surface::SupportSurface::Sphere { frame: Frame::world(), radius: 50.0 };
        let (surface, _) = sphere.to_spline((0.2, 1.2), (-0.4, 0.5)).expect("a sphere");
        let ((u, _), (v, _)) = surface.domain();
        assert!((curvature(&surface.jet(u + 0.3, v + 0.2)) - 4e-4).abs() < 1e-10);
    }

    #[test]
    fn the_angle_of_a_roof_is_told_once() {
        let half = |sign: f64| Mesh {
            positions: vec![
                Vec3::zeros(),
                Vec3::x() * 90.0,
                Vec3::new(90.0, sign * 40.0, -30.0),
                Vec3::new(0.0, sign * 40.0, -30.0),
            ],
            normals: vec![Vec3::new(0.0, sign * 0.6, 0.8); 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            values: Vec::new(),
        };
        let found = joints(&[&half(1.0), &half(-1.0)], 0.0);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].1 - 2.0 * 0.6f64.asin()).abs() < 1e-12 && found[0].0[1] == Vec3::x() * 90.0);
        assert!(joints(&[&half(1.0)], 0.0).is_empty());
    }
}
