//! The convex hull of points of space, with exact signs.
//!
//! Knows nothing of curves: which triangles belong together is not asked here.

use super::Vec3;
use rayon::prelude::*;
use robust::{orient3d, Coord3D};
use std::collections::HashSet;

/// Triangles from which on their signs are looked at on all cores: fewer are done before others have begun.
const MANY_TRIANGLES: usize = 2048;

/// Triangles of the boundary of the convex hull, as indices of the points, counterclockwise seen from outside.
/// Coplanar facets are cut into triangles in no particular way. `None` if all points lie in one plane, or a coordinate
/// is not finite.
///
/// *Method.* Points are added one by one; the triangles that see the new point are replaced by a cone over their
/// horizon. "Sees" is the exact sign of a determinant, so coplanar and collinear points do no harm.
///
/// `stopped` is asked between points: what was added until then is the answer.
///
/// *Cost.* Number of points times number of triangles of the hull, on all cores.
pub(crate) fn convex_hull(points: &[Vec3], stopped: &dyn Fn() -> bool) -> Option<Vec<[usize; 3]>> {
    if points.iter().any(|p| p.iter().any(|x| !x.is_finite())) {
        return None;
    }
    let side = |f: &[usize; 3], p: usize| {
        let c = |i: usize| Coord3D { x: points[i].x, y: points[i].y, z: points[i].z };
        orient3d(c(f[0]), c(f[1]), c(f[2]), c(p))
    };
    // A tetrahedron to begin with: two points far apart, one far from their line, one off the plane.
    let farthest = |measure: &dyn Fn(&Vec3) -> f64| {
        (0..points.len()).max_by(|&i, &j| measure(&points[i]).total_cmp(&measure(&points[j])))
    };
    let a = 0;
    let o = *points.first()?;
    let b = farthest(&|p| (p - o).norm_squared())?;
    let ab = points[b] - o;
    let c = farthest(&|p| (p - o).cross(&ab).norm_squared())?;
    let normal = ab.cross(&(points[c] - o));
    let d = farthest(&|p| (p - o).dot(&normal).abs())?;
    let s = side(&[a, b, c], d);
    if s == 0.0 {
        return None;
    }
    // A positive sign means that d lies below the triangle.
    let [a, b, c] = if s > 0.0 { [a, b, c] } else { [a, c, b] };
    let mut faces = vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
    for p in 0..points.len() {
        if stopped() {
            break;
        }
        let sees = |f: &&[usize; 3]| side(f, p) < 0.0;
        let seen: Vec<[usize; 3]> = if faces.len() < MANY_TRIANGLES {
            faces.iter().filter(sees).copied().collect()
        } else {
            faces.par_iter().filter(sees).copied().collect()
        };
        if seen.is_empty() {
            continue;
        }
        let edges: HashSet<[usize; 2]> = seen.iter().flat_map(sides).collect();
        // Both in the order of the faces.
        let mut next = seen.iter().peekable();
        faces.retain(|f| next.next_if(|s| *s == f).is_none());
        // In the order of the faces, so that the answer does not depend on hashing.
        for [i, j] in seen.iter().flat_map(sides).filter(|[i, j]| !edges.contains(&[*j, *i])) {
            faces.push([i, j, p]);
        }
    }
    Some(faces)
}

/// Directed sides of a triangle.
pub fn sides(f: &[usize; 3]) -> [[usize; 2]; 3] {
    [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_cube_with_points_on_its_faces_is_the_cube() {
        let mut points = Vec::new();
        for x in 0..3 {
            for y in 0..3 {
                for z in 0..3 {
                    points.push(Vec3::new(f64::from(x), f64::from(y), f64::from(z)));
                }
            }
        }
        let hull = convex_hull(&points, &|| false).expect("hull");
        let triangle = |f: &[usize; 3]| (points[f[0]], points[f[1]], points[f[2]]);
        let volume: f64 = hull.iter().map(triangle).map(|(a, b, c)| a.dot(&b.cross(&c)) / 6.0).sum();
        assert!((volume - 8.0).abs() < 1e-14);
        let all: HashSet<[usize; 2]> = hull.iter().flat_map(sides).collect();
        assert!(all.len() == 3 * hull.len() && all.iter().all(|e| all.contains(&[e[1], e[0]])));
    }

    #[test]
    fn points_of_a_plane_have_no_hull() {
        let points: Vec<Vec3> = (0..9).map(|k| Vec3::new(f64::from(k % 3), f64::from(k / 3), 1.0)).collect();
        assert!(convex_hull(&points, &|| false).is_none() && convex_hull(&[], &|| false).is_none());
    }
}
