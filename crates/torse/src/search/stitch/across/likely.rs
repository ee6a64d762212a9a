//! What no proof will accept: panels that are too far from their face at places for where they are to end.
//!
//! Near a border the proof counts the distance D of a panel from its face and the way δ from where it ends by itself to where it
//! ends now as `√(D² + δ²)`, for whole triangles (docs/algorithms/certificate.md). What that is at vertices and middles of the
//! triangles along a border is no more than what it finds.

use super::intersection_curve::Near;
use super::places::Ground;
use crate::geom::Vec3;
use crate::patchwork::partition::centroid;
use crate::spline::curve::Curve;
use std::collections::BTreeMap;

/// Feet are elsewhere where a curve that is within the tolerance of a border is farther away than this multiple of it from them.
const ELSEWHERE: f64 = 2.0;

/// A border that is to end on a curve.
pub(super) struct Ending<'a> {
    /// Vertices of the border.
    pub vertices: &'a [u32],
    /// Label beside it.
    pub label: u32,
    /// The curve.
    pub curve: &'a Curve<3>,
    /// Parameters of the vertices on it.
    pub parameters: &'a [f64],
}

/// The most that a panel of this torse, which keeps to a tolerance (mm) by itself, is away from its face beside its border, for
/// where it ends; zero where that is not known.
pub(super) fn at_least(ground: &Ground, of: &Ending, torse: &Near, tolerance: f64) -> f64 {
    let partition = &ground.partition;
    let place = |p: [f64; 2]| ground.face.surface.point(p[0], p[1]);
    let mut near = *torse;
    let mut ways: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    for (&v, &s) in of.vertices.iter().zip(of.parameters) {
        let x = place(partition.vertices[v as usize]);
        let Some((n, off)) = near.plane(&x) else { return 0.0 };
        // Along the ruling and across it, as the proof goes.
        let off = Vec3::from(of.curve.point(s)) - (x - n * off);
        if off.norm() > ELSEWHERE * tolerance {
            return 0.0;
        }
        let along = off.dot(&near.torse.ruling(near.t).direction).abs();
        let way = along + (off.norm_squared() - along * along).max(0.0).sqrt();
        ways.insert(v, (way, near.t));
    }
    let mut most = 0.0;
    let beside = partition.triangles.iter().zip(&partition.labels).enumerate().filter(|(_, (_, &l))| l == of.label);
    for (k, (triangle, _)) in beside {
        let way = triangle.iter().filter_map(|v| ways.get(v)).copied().reduce(|a, b| if a.0 > b.0 { a } else { b });
        let Some((way, t)) = way else { continue };
        let corners = partition.corners(k);
        let places = corners.into_iter().chain([centroid(corners)]).map(place);
        // What is farther away has its foot elsewhere: these panels are proven.
        let far = |x: Vec3| Near { t, ..*torse }.plane(&x).map_or(0.0, |p| p.1.abs());
        let far = |x: Vec3| Some(far(x)).filter(|d| *d <= tolerance).unwrap_or(0.0);
        most = f64::max(most, places.map(far).fold(0.0, f64::max).hypot(way));
    }
    most
}
