//! Which side of every face is the outside of the model: a rule that asks for the shape alone, not for the direction in
//! which a face was drawn.
//!
//! Looks at the triangles of the partitions; a rule, not a proof.

use super::panel::Patchwork;
use super::partition::Partition;
use crate::geom::outward::{middle, outward as outside_of_sheet};
use crate::geom::{BBox, Vec3};
use crate::spline::surface::Surface;
use std::collections::BTreeMap;

/// Triangles of each face from which rays are sent.
const PROBES: usize = 5;
/// Share of rays that may say nothing in a model that counts as closed.
const LOST: f64 = 0.1;
/// Rays lean by such shares of their length, so that they miss the edges of triangles.
const LEAN: [f64; 2] = [0.013, 0.007];
/// Rays begin this share of the model's size beside their triangle.
const BESIDE: f64 = 1e-7;
/// Share of what could be, above which a face looks clearly away from the middle.
const CLEAR: f64 = 0.2;

/// A face as triangles.
pub(super) struct Hull {
    triangles: Vec<[Vec3; 3]>,
    bbox: BBox,
    /// Centres of the triangles with their normals, as long as their areas, on the side of S_u × S_v.
    pub(super) sides: Vec<(Vec3, Vec3)>,
}

/// For each face +1 if S_u × S_v points out of the model, −1 if into it.
///
/// *Rule*. Of a closed body outside is where rays leave it. Faces of an open one look away from the middle of all faces
/// of their part; where one of them does not clearly do so, the rule of `geom::outward` decides for each.
pub fn outward(patchwork: &Patchwork) -> Vec<f64> {
    let hulls: Vec<Hull> = (0..patchwork.faces.len()).map(|f| Hull::of(patchwork, f)).collect();
    let mut parts: BTreeMap<(u32, &str), Vec<usize>> = BTreeMap::new();
    for (k, f) in patchwork.faces.iter().enumerate() {
        parts.entry((f.body, f.part.as_str())).or_default().push(k);
    }
    let mut out = vec![1.0; hulls.len()];
    for faces in parts.values() {
        let hulls: Vec<&Hull> = faces.iter().map(|&k| &hulls[k]).collect();
        let signs = closed(&hulls).unwrap_or_else(|| open(&hulls));
        for (&k, sign) in faces.iter().zip(signs) {
            out[k] = sign;
        }
    }
    out
}

impl Hull {
    fn of(patchwork: &Patchwork, face: usize) -> Self {
        patchwork.partitions.get(face).map_or_else(Self::none, |p| Self::new(&patchwork.faces[face].surface, p))
    }

    /// Of a face without triangles: no ray meets it.
    pub(super) fn none() -> Self {
        Self { triangles: Vec::new(), bbox: BBox::empty(), sides: Vec::new() }
    }

    /// The triangles of a partition of a face.
    pub(super) fn new(surface: &Surface, partition: &Partition) -> Self {
        let mut out = Self { triangles: Vec::new(), bbox: BBox::empty(), sides: Vec::new() };
        let points: Vec<Vec3> = partition.vertices.iter().map(|v| surface.point(v[0], v[1])).collect();
        for (t, corners) in partition.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            // Triangles run about S_u × S_v in the parameter plane.
            let [p, q, r] = partition.corners(t);
            let sense = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum();
            out.sides.push(((a + b + c) / 3.0, 0.5 * sense * (b - a).cross(&(c - a))));
            out.triangles.push([a, b, c]);
            for x in [a, b, c] {
                out.bbox.include(&x);
            }
        }
        out
    }

    /// Times that a ray meets the face.
    fn hits(&self, from: &Vec3, way: &Vec3) -> usize {
        if !meets_box(&self.bbox, from, way) {
            return 0;
        }
        self.triangles.iter().filter(|t| meets(t, from, way).is_some()).count()
    }

    /// Where a ray first meets the face: the multiple of `way`, and the unit normal on the side of S_u × S_v.
    pub(super) fn first_hit(&self, from: &Vec3, way: &Vec3) -> Option<(f64, Vec3)> {
        if !meets_box(&self.bbox, from, way) {
            return None;
        }
        let hits = self.triangles.iter().zip(&self.sides).filter_map(|(t, s)| Some((meets(t, from, way)?, s.1)));
        hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(far, n)| (far, n.normalize()))
    }
}

/// Signs by rays; `None` where these do not say that the faces enclose something.
fn closed(hulls: &[&Hull]) -> Option<Vec<f64>> {
    let mut all = BBox::empty();
    for h in hulls {
        all.include(&h.bbox.min);
        all.include(&h.bbox.max);
    }
    let size = all.diagonal();
    let (mut rays, mut lost) = (0, 0);
    let mut out = Vec::new();
    for h in hulls {
        let mut sum = 0.0;
        for probe in 0..PROBES {
            let Some((x, n)) = h.sides.get((2 * probe + 1) * h.sides.len() / (2 * PROBES)) else { continue };
            let Some(n) = n.try_normalize(0.0) else { continue };
            let across = n.cross(&if n.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() }).normalize();
            let lean = across * LEAN[0] + n.cross(&across) * LEAN[1];
            let odd = |side: f64| {
                let (from, way) = (x + n * (side * BESIDE * size), n * side + lean);
                hulls.iter().map(|h| h.hits(&from, &way)).sum::<usize>() % 2 == 1
            };
            rays += 1;
            match (odd(1.0), odd(-1.0)) {
                (false, true) => sum += 1.0,
                (true, false) => sum -= 1.0,
                _ => lost += 1,
            }
        }
        out.push(if sum < 0.0 { -1.0 } else { 1.0 });
    }
    (rays > 0 && (lost as f64) <= LOST * rays as f64).then_some(out)
}

/// Signs of faces that enclose nothing.
fn open(hulls: &[&Hull]) -> Vec<f64> {
    let centre = middle(hulls.iter().flat_map(|h| &h.sides));
    let away = |h: &Hull| {
        let (flux, most) = h.sides.iter().fold((0.0, 0.0), |(flux, most), (x, n)| {
            let d = x - centre;
            (flux + n.dot(&d), most + n.norm() * d.norm())
        });
        flux / most
    };
    let clear = hulls.iter().all(|h| away(h).abs() > CLEAR);
    let sign = |h: &&Hull| {
        if clear {
            away(h).signum()
        } else {
            // Each about its own middle: neighbours in a wavy sheet are not to differ for lying to its left and right.
            outside_of_sheet(&h.sides, &middle(&h.sides))
        }
    };
    hulls.iter().map(sign).collect()
}

/// Whether a ray meets a box.
fn meets_box(b: &BBox, from: &Vec3, way: &Vec3) -> bool {
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for d in 0..3 {
        let (p, q) = ((b.min[d] - from[d]) / way[d], (b.max[d] - from[d]) / way[d]);
        // Not a number where the ray runs in a side of the box: that side then says nothing.
        near = near.max(p.min(q));
        far = far.min(p.max(q));
    }
    near <= far
}

/// Where a ray meets a triangle: the multiple of `way`, if it is positive.
fn meets(t: &[Vec3; 3], from: &Vec3, way: &Vec3) -> Option<f64> {
    let (e, f) = (t[1] - t[0], t[2] - t[0]);
    let h = way.cross(&f);
    let det = e.dot(&h);
    if det == 0.0 {
        return None;
    }
    let s = from - t[0];
    let u = s.dot(&h) / det;
    let q = s.cross(&e);
    let v = way.dot(&q) / det;
    let far = f.dot(&q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && far > 0.0).then_some(far)
}
