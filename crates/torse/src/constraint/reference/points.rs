//! Nearest points of triangle meshes and of point clouds, with normals and curvatures from local quadrics.
//!
//! At every point, a plane through its nearest neighbours gives the normal, and a quadric over that plane, fitted by least
//! squares, the curvatures \[CP05\]. Between the corners of a triangle normals are interpolated, and the curvatures of the
//! nearest corner are used.

use super::{principal, Foot, Reference};
use crate::geom::box_tree::{nearest_on_triangle, BoxTree};
use crate::geom::cloud::Cloud;
use crate::geom::{BBox, Vec3};
use nalgebra as na;

/// Neighbours that a quadric is fitted to: twice what it needs.
const NEIGHBOURS: usize = 13;
/// Ratio of the moments across and along neighbours below which these lie on a line.
const LINE: f64 = 1e-6;
/// Curvatures above this share of the inverse distance of the neighbours are noise.
const SHARPEST: f64 = 2.0;

/// What is known at a point.
#[derive(Clone, Copy, Debug)]
struct Local {
    /// Whether its neighbours say where the plane through it is: one point, or points on a line, do not.
    plane: bool,
    normal: Vec3,
    directions: [Vec3; 2],
    curvatures: [f64; 2],
}

/// A mesh, or a cloud where there are no triangles.
pub(crate) struct PointReference {
    cloud: Cloud,
    local: Vec<Local>,
    tree: BoxTree,
}

impl PointReference {
    /// Points with finite coordinates (mm) and triangles between them. `None` without points, or where a triangle names one
    /// that is not there.
    pub fn new(cloud: Cloud) -> Option<Self> {
        let n = cloud.points.len();
        let finite = cloud.points.iter().all(|p| p.iter().all(|c| c.is_finite()));
        if n == 0 || !finite || cloud.triangles.iter().flatten().any(|&i| i as usize >= n) {
            return None;
        }
        let points = &cloud.points;
        let near = BoxTree::new(n, &|i| BBox { min: points[i], max: points[i] });
        let mut given = vec![Vec3::zeros(); n];
        for t in &cloud.triangles {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let area = (b - a).cross(&(c - a));
            t.iter().for_each(|&i| given[i as usize] += area);
        }
        let local = (0..n)
            .map(|i| {
                let around = near.several(&points[i], NEIGHBOURS, &|j| (points[j] - points[i]).norm_squared());
                let around: Vec<Vec3> = around.into_iter().map(|j| points[j] - points[i]).collect();
                quadric(&around, given[i].try_normalize(0.0))
            })
            .collect();
        let tree = match cloud.triangles.is_empty() {
            true => near,
            false => BoxTree::new(cloud.triangles.len(), &|k| {
                BBox::of(cloud.triangles[k].map(|i| points[i as usize]).iter())
            }),
        };
        Some(Self { cloud, local, tree })
    }
}

/// Normal and curvatures of points about the origin.
fn quadric(around: &[Vec3], given: Option<Vec3>) -> Local {
    let moment: na::Matrix3<f64> = around.iter().map(|p| p * p.transpose()).sum();
    let eigen = moment.symmetric_eigen();
    let (least, most) = (eigen.eigenvalues.imin(), eigen.eigenvalues.max());
    let middle = eigen.eigenvalues.sum() - most - eigen.eigenvalues[least];
    let plane = given.is_some() || middle > LINE * most;
    let normal =
        given.unwrap_or_else(|| eigen.eigenvectors.column(least).into_owned().try_normalize(0.0).unwrap_or(Vec3::z()));
    let x = normal.cross(&if normal.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() }).normalize();
    let y = normal.cross(&x);
    let mut flat = Local { plane, normal, directions: [x, y], curvatures: [0.0; 2] };
    let reach = around.iter().map(|p| p.norm()).fold(0.0, f64::max);
    if around.len() < 6 || reach <= 0.0 {
        return flat;
    }
    // z = a x + b y + (l x² + 2 m x y + n y²)/2 in lengths of the reach.
    let mut normal_equations = na::Matrix5::<f64>::zeros();
    let mut right = na::Vector5::<f64>::zeros();
    for p in around {
        let (u, v, w) = (p.dot(&x) / reach, p.dot(&y) / reach, p.dot(&normal) / reach);
        let row = na::Vector5::new(u, v, 0.5 * u * u, u * v, 0.5 * v * v);
        normal_equations += row * row.transpose();
        right += row * w;
    }
    let Some(c) = normal_equations.cholesky().map(|f| f.solve(&right)) else { return flat };
    // The quadric's own tangent plane is the better one.
    let tilted = (normal - x * c[0] - y * c[1]).normalize();
    let slope = (1.0 + c[0] * c[0] + c[1] * c[1]).sqrt();
    let ex = (x + normal * c[0]).normalize();
    let ey = tilted.cross(&ex);
    let (directions, curvatures) =
        principal(c[2] / (slope * reach), c[3] / (slope * reach), c[4] / (slope * reach), [ex, ey]);
    if given.is_none() {
        flat.normal = tilted;
        flat.directions = directions;
    } else {
        flat.directions = directions.map(|d| (d - normal * d.dot(&normal)).try_normalize(0.0).unwrap_or(d));
        flat.directions[1] = normal.cross(&flat.directions[0]);
    }
    if curvatures.iter().all(|k| k.is_finite() && k.abs() * reach < SHARPEST) {
        flat.curvatures = curvatures;
    }
    flat
}

impl Reference for PointReference {
    /// Of points without triangles: those places that are the nearest ones to a point. A place beside the points would be drawn
    /// to the plane of a point far away.
    fn meets(&self, places: &[Vec3]) -> Vec<bool> {
        let mut out = vec![!self.cloud.triangles.is_empty(); places.len()];
        let tree = BoxTree::new(places.len(), &|i| BBox { min: places[i], max: places[i] });
        for p in self.cloud.points.iter().filter(|_| self.cloud.triangles.is_empty()) {
            if let Some((k, _)) = tree.nearest(p, &|i| (places[i] - p).norm_squared()) {
                out[k] = true;
            }
        }
        out
    }

    fn foot(&self, x: &Vec3, _: Option<&Foot>) -> Option<Foot> {
        let points = &self.cloud.points;
        if self.cloud.triangles.is_empty() {
            let (of, _) = self.tree.nearest(x, &|i| (points[i] - x).norm_squared())?;
            let l = self.local[of];
            // The foot on the plane of the nearest point: the cloud itself has no places between its points. Without a plane,
            // the point.
            let away = x - points[of];
            let normal = if l.plane { l.normal } else { away.try_normalize(0.0).unwrap_or(l.normal) };
            let point = x - normal * normal.dot(&away);
            return Some(Foot { point, normal, directions: l.directions, curvatures: l.curvatures, at: [0.0; 2], of });
        }
        let corners = |k: usize| self.cloud.triangles[k].map(|i| points[i as usize]);
        let place = |k: usize| {
            let c = corners(k);
            let at = nearest_on_triangle(x, c);
            (c[0] * at[0] + c[1] * at[1] + c[2] * at[2], at)
        };
        let (of, _) = self.tree.nearest(x, &|k| (place(k).0 - x).norm_squared())?;
        let (point, at) = place(of);
        let t = self.cloud.triangles[of];
        let mixed: Vec3 = (0..3).map(|k| self.local[t[k] as usize].normal * at[k]).sum();
        let most = (0..3).max_by(|&i, &j| at[i].total_cmp(&at[j])).unwrap_or(0);
        let l = self.local[t[most] as usize];
        let normal = mixed.try_normalize(0.0).unwrap_or(l.normal);
        let e = (l.directions[0] - normal * normal.dot(&l.directions[0])).try_normalize(0.0)?;
        let directions = [e, normal.cross(&e)];
        Some(Foot { point, normal, directions, curvatures: l.curvatures, at: [0.0; 2], of })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid on the cylinder y² + z² = 4 about the x-axis.
    fn cylinder(triangles: bool) -> Cloud {
        let (n, m) = (40, 40);
        let point = |i: usize, j: usize| {
            let a = 0.02 + 0.05 * j as f64;
            Vec3::new(0.1 * i as f64, 2.0 * a.cos(), 2.0 * a.sin())
        };
        let points = (0..n * m).map(|k| point(k / m, k % m)).collect();
        let at = |i: usize, j: usize| (i * m + j) as u32;
        let cells = (0..(n - 1) * (m - 1)).map(|k| (k / (m - 1), k % (m - 1)));
        let both = cells.flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        Cloud { points, triangles: if triangles { both.collect() } else { Vec::new() } }
    }

    #[test]
    fn a_sampled_cylinder_has_its_normals_and_curvatures() {
        for triangles in [true, false] {
            let reference = PointReference::new(cylinder(triangles)).expect("points");
            let x = Vec3::new(2.03, 1.9, 1.3);
            let foot = reference.foot(&x, None).expect("a foot");
            let radial = Vec3::new(0.0, x.y, x.z).normalize();
            assert!(foot.normal.cross(&radial).norm() < 0.03, "{foot:?}");
            assert!((foot.point - Vec3::new(2.03, 2.0 * radial.y, 2.0 * radial.z)).norm() < 0.02, "{foot:?}");
            let bent = usize::from(foot.curvatures[1].abs() > foot.curvatures[0].abs());
            let outward = foot.normal.dot(&radial).signum();
            assert!((foot.curvatures[bent] + outward * 0.5).abs() < 0.02, "{foot:?}");
            assert!(foot.curvatures[1 - bent].abs() < 0.02);
        }
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        assert!(PointReference::new(Cloud::default()).is_none());
        let broken = Cloud { points: vec![Vec3::zeros()], triangles: vec![[0, 0, 1]] };
        assert!(PointReference::new(broken).is_none());
        let single = Cloud { points: vec![Vec3::zeros()], triangles: Vec::new() };
        assert!(PointReference::new(single).expect("a point").foot(&Vec3::x(), None).is_some());
    }
}
