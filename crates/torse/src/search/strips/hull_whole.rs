//! Whether strips are the whole of a convex hull \[W15, 5.4\]: compared with the hull of points on the curves, both ways.

use crate::design::hull::strips::HullPart;
use crate::design::hull::Hull;
use crate::geom::box_tree::{nearest_on_triangle, BoxTree};
use crate::geom::{BBox, Vec3};
use crate::num::parallel;
use crate::spline::surface::Surface;

/// Pieces of a strip on each of its spans, and at least.
const PIECES: (usize, usize) = (4, 8);
/// Strips and hull may be apart by so many times what samples and tolerance explain: where two faces of the hull meet at an
/// angle, the nearest place is farther than the depth.
const SLACK: f64 = 4.0;

/// The greatest distance (mm) between strips and hull, and where, if it is more than the samples and the `tolerance` (mm)
/// explain. Measured in the middle of all triangles of the one and of the other.
pub fn apart(hull: &Hull, made: &[HullPart], tolerance: f64) -> Option<(f64, Vec3)> {
    let patches: Vec<&Surface> = made
        .iter()
        .flat_map(|p| p.strips.iter().map(|s| &s.built.strip.patch).chain(p.facet.iter().map(|f| &f.patch)))
        .collect();
    let (cut, heights): (Vec<Vec<[Vec3; 3]>>, Vec<f64>) =
        parallel::map(patches.iter(), |s| triangles(s)).into_iter().unzip();
    let strips = cut.concat();
    let allowed = SLACK * (hull.sagitta + heights.into_iter().fold(0.0, f64::max) + tolerance);
    let far = [farthest(&hull.triangles, &strips), farthest(&strips, &hull.triangles)];
    far.into_iter().flatten().filter(|f| f.0 > allowed).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// A ruled patch in triangles, and the greatest distance (mm) of its rails from them, measured.
fn triangles(s: &Surface) -> (Vec<[Vec3; 3]>, f64) {
    let count = (PIECES.0 * (s.knots_u.breaks().len() - 1)).max(PIECES.1);
    let ((u0, u1), (v0, v1)) = s.domain();
    let at = |k: f64| [v0, v1].map(|v| s.point(u0 + (u1 - u0) * k / count as f64, v));
    let (mut out, mut height) = (Vec::with_capacity(2 * count), 0.0_f64);
    for k in 0..count {
        let [[a, b], [m, n], [c, d]] = [0.0, 0.5, 1.0].map(|x| at(k as f64 + x));
        height = height.max((m - (a + c) * 0.5).norm()).max((n - (b + d) * 0.5).norm());
        out.extend([[a, c, b], [c, d, b]]);
    }
    (out, height)
}

/// The middle of a triangle that is farthest from other triangles. `None` without triangles; infinitely far from none.
fn farthest(of: &[[Vec3; 3]], from: &[[Vec3; 3]]) -> Option<(f64, Vec3)> {
    let around = |k: usize| {
        let mut b = BBox::empty();
        from[k].iter().for_each(|p| b.include(p));
        b
    };
    let tree = BoxTree::new(from.len(), &around);
    let far = |t: &[Vec3; 3]| {
        let x = (t[0] + t[1] + t[2]) / 3.0;
        let off = |k: usize| {
            let w = nearest_on_triangle(&x, from[k]);
            (from[k][0] * w[0] + from[k][1] * w[1] + from[k][2] * w[2] - x).norm_squared()
        };
        (tree.nearest(&x, &off).map_or(f64::INFINITY, |n| n.1.sqrt()), x)
    };
    parallel::map(of.iter(), far).into_iter().max_by(|a, b| a.0.total_cmp(&b.0))
}
