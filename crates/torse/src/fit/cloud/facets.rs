//! Points between the corners of a coarse mesh, as a guide for fits.
//!
//! *Method.* Facets of CAD meshes are chords: their corners lie on the surface, their insides do not. Every corner of a
//! facet gets the normal of the smooth surface, the mean of the facets around it weighted by their angles, over edges
//! that are no creases. A point of the facet is projected on the planes of the three corners; half the way to the
//! barycentric mean of these projections, it lies on the surface up to the fourth order of the facets' turn (Phong
//! tessellation \[BA08\] with the weight that is exact for circles).
//! *Not guaranteed*: anything. The points are to guide a fit; what is judged are the corners, which are what is given.

use super::regions::CREASE;
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use std::collections::HashMap;

/// A point on a facet and the one that the surface is expected to have near it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FacetPoint {
    /// On the flat facet, mm.
    pub flat: Vec3,
    /// On the surface through the corners, mm.
    pub lifted: Vec3,
    /// Index of the facet.
    pub facet: u32,
}

/// Weight of the projections that lifts chords of a circle onto it.
const LIFT: f64 = 0.5;
/// Corners up to which a mesh is coarse as a whole: fewer say too little about the surface between them.
const COARSE: usize = 1000;
/// Facets are long if their longest edge exceeds the mean distance of corners this many times.
const LONG: f64 = 4.0;
/// Share of the points that must be corners of facets: else a cloud has some facets, but is no mesh.
const OF_MESH: f64 = 0.9;

/// Points spread over the facets that are too large for their corners to describe the surface, about `count` on all of
/// the mesh. None if the cloud is no mesh, or its corners lie densely enough.
pub(crate) fn facet_points(cloud: &Cloud, count: usize) -> Vec<FacetPoint> {
    let points = &cloud.points;
    let mut used = vec![false; points.len()];
    cloud.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
    let corners = used.iter().filter(|u| **u).count();
    if (corners as f64) < OF_MESH * points.len() as f64 || corners == 0 {
        return Vec::new();
    }
    let corner = |t: &[u32; 3]| t.map(|i| points[i as usize]);
    let area = |t: &[u32; 3]| {
        let [a, b, c] = corner(t);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    let total: f64 = cloud.triangles.iter().map(area).sum();
    let long = if corners < COARSE { 0.0 } else { LONG * (total / corners as f64).sqrt() };
    let step = (total / count.max(1) as f64).sqrt();
    let normals = normals(cloud);
    let mut out = Vec::new();
    for ((t, n), facet) in cloud.triangles.iter().zip(&normals).zip(0..) {
        let [a, b, c] = corner(t);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        if longest > long && n.iter().all(|n| n.norm() > 0.0) {
            spread((facet, &[a, b, c]), n, step, &mut out);
        }
    }
    out
}

/// Points of one facet at distances of about `step`.
fn spread((facet, corners): (u32, &[Vec3; 3]), normals: &[Vec3; 3], step: f64, out: &mut Vec<FacetPoint>) {
    // Rows of one facet at most.
    const MOST_ROWS: f64 = 400.0;
    // Rows run along the edge that leaves the fewest of them: the facet is long and thin as a rule.
    let edge = |k: usize| corners[(k + 1) % 3] - corners[k];
    let base = (0..3).max_by(|&i, &j| edge(i).norm().total_cmp(&edge(j).norm())).unwrap_or(0);
    let [p, q, r] = [base, (base + 1) % 3, (base + 2) % 3];
    let length = edge(base).norm();
    let height = edge(base).cross(&(corners[r] - corners[p])).norm() / length;
    let rows = (height / step).clamp(1.0, MOST_ROWS).ceil() as usize;
    for i in 0..rows {
        // Middles of rows, so that facets that share an edge do not share points.
        let up = (i as f64 + 0.5) / rows as f64;
        let columns = ((1.0 - up) * length / step).clamp(1.0, MOST_ROWS).ceil() as usize;
        for j in 0..columns {
            let along = (1.0 - up) * (j as f64 + 0.5) / columns as f64;
            let mut w = [0.0; 3];
            (w[p], w[q], w[r]) = (1.0 - up - along, along, up);
            let flat = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
            let lift: Vec3 =
                (0..3).map(|k| normals[k] * (normals[k].dot(&(corners[k] - flat)) * w[k])).sum::<Vec3>() * LIFT;
            out.push(FacetPoint { flat, lifted: flat + lift, facet });
        }
    }
}

/// Unit normals of the smooth surface at the corners of every facet; zero for facets of no area.
fn normals(cloud: &Cloud) -> Vec<[Vec3; 3]> {
    let corner = |f: usize| cloud.triangles[f].map(|i| cloud.points[i as usize]);
    let own: Vec<Vec3> = (0..cloud.triangles.len())
        .map(|f| {
            let [a, b, c] = corner(f);
            (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
        })
        .collect();
    let mut around: HashMap<u32, Vec<(usize, f64)>> = HashMap::new();
    for (f, t) in cloud.triangles.iter().enumerate() {
        let p = corner(f);
        for k in 0..3 {
            let angle = (p[(k + 1) % 3] - p[k]).angle(&(p[(k + 2) % 3] - p[k]));
            around.entry(t[k]).or_default().push((f, angle));
        }
    }
    let at = |f: usize, i: u32| -> Vec3 {
        let facets = around.get(&i).map_or(&[][..], Vec::as_slice);
        let smooth = facets.iter().filter(|g| own[f].dot(&own[g.0]).abs() >= CREASE);
        // Facets of meshes may look to either side.
        let sum: Vec3 = smooth.map(|&(g, angle)| own[g] * (angle * own[f].dot(&own[g]).signum())).sum();
        // Around an apex normals turn by more than a crease without one: nothing but the facet itself is known there.
        let apex = facets.iter().any(|g| own[f].dot(&own[g.0]).abs() < CREASE) && is_fan(cloud, facets, &own, i);
        if apex {
            own[f]
        } else {
            sum.try_normalize(0.0).unwrap_or(own[f])
        }
    };
    cloud.triangles.iter().enumerate().map(|(f, t)| t.map(|i| at(f, i))).collect()
}

/// Whether all facets around a corner hang together over edges that are no creases.
fn is_fan(cloud: &Cloud, facets: &[(usize, f64)], own: &[Vec3], at: u32) -> bool {
    let share = |f: usize, g: usize| {
        let common = cloud.triangles[f].iter().filter(|i| cloud.triangles[g].contains(i) && **i != at).count();
        common > 0 && own[f].dot(&own[g]).abs() >= CREASE
    };
    let mut seen = vec![false; facets.len()];
    let mut open = vec![0];
    seen[0] = true;
    while let Some(k) = open.pop() {
        for j in 0..facets.len() {
            if !seen[j] && share(facets[k].0, facets[j].0) {
                seen[j] = true;
                open.push(j);
            }
        }
    }
    seen.iter().all(|s| *s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The wall of a cylinder of radius 100 about z between two rims, with long thin facets.
    fn wall(facets: u32) -> Cloud {
        let mut cloud = Cloud::default();
        for k in 0..facets {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(facets)).sin_cos();
            cloud.points.extend([0.0, 300.0].map(|z| Vec3::new(100.0 * c, 100.0 * s, z)));
            let [a, b] = [2 * k, 2 * ((k + 1) % facets)];
            cloud.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
        cloud
    }

    #[test]
    fn points_of_a_coarse_cylinder_lie_on_it() {
        let found = facet_points(&wall(24), 4000);
        assert!((3000..8000).contains(&found.len()), "{}", found.len());
        let off = |p: &Vec3| (p.x.hypot(p.y) - 100.0).abs();
        let worst = |of: fn(&FacetPoint) -> Vec3| found.iter().map(|p| off(&of(p))).fold(0.0, f64::max);
        // The chord is 100 (1 - cos 7.5°) inside.
        assert!((worst(|p| p.flat) - 0.8555).abs() < 0.02, "{}", worst(|p| p.flat));
        assert!(worst(|p| p.lifted) < 0.015, "{}", worst(|p| p.lifted));
    }

    #[test]
    fn facets_beyond_creases_stay_flat_and_clouds_with_a_facet_are_no_mesh() {
        let cube = wall(4);
        assert!(facet_points(&cube, 400).iter().all(|p| (p.lifted - p.flat).norm() < 1e-9));
        let mut heap = wall(24);
        heap.triangles.truncate(1);
        assert!(facet_points(&heap, 400).is_empty());
        let flat = Cloud { points: vec![Vec3::x(), Vec3::y(), Vec3::y()], triangles: vec![[0, 1, 2]] };
        assert!(facet_points(&flat, 10).is_empty());
    }
}
