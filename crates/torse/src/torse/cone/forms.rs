//! Segments of cone splines as rational Bézier patches of degree (2, 1), and as quadratic curves of planes \[LP98\].

use super::spline::{ConeSpline, Segment, Shape};
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Largest turn of one Bézier patch, rad: the middle weight cos(φ/2) stays above 1/2.
const LARGEST_TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// Bézier planes `(u₀, u)`, meaning `u₀ + u·x = 0`, of a segment: its tangent planes are those of the quadratic curve
/// with these control points; the middle one carries the weight W = cos(φ/2) of the turn φ, negative for turns beyond π
/// (the complementary arcs of the paper).
///
/// *Method*: \[LP98\], the two sign rules of the paper in one. `None` for plane pieces,
/// whose tangent plane does not move.
pub fn dual_planes(segment: &Segment) -> Option<[[f64; 4]; 3]> {
    let plane = |weight: f64, n: &Vec3, x: &Vec3| [-n.dot(x) * weight, n.x * weight, n.y * weight, n.z * weight];
    let (first, last) = (segment.start, segment.end());
    let (n, m) = (first.normal, last.normal);
    match segment.shape {
        Shape::Cone { sin_gamma, angle, .. } if !segment.shape.is_plane() => {
            let w = (0.5 * angle).cos();
            let z = segment.axis() * sin_gamma;
            let b = z + ((n + m) * 0.5 - z) / (w * w);
            // All planes pass through the vertex; its place is read from the point of the ruling.
            let v = segment.vertex()?;
            Some([plane(1.0, &n, &first.point), plane(w, &b, &v), plane(1.0, &m, &last.point)])
        }
        Shape::Cylinder { radius, angle } => {
            let w = (0.5 * angle).cos();
            let b = (n + m) * (0.5 / (w * w));
            // u₀ is linear in n: radius − n·axis point.
            let axis = first.point - n * radius;
            let middle = [-(b.dot(&axis) + radius) * w, b.x * w, b.y * w, b.z * w];
            Some([plane(1.0, &n, &first.point), middle, plane(1.0, &m, &last.point)])
        }
        _ => None,
    }
}

/// A segment as patches of degree 2 across and 1 along the rulings, cut where it turns more than 120°.
///
/// u runs from the first ruling to the last, v from the lower edge to the upper; edges are the segment's own (conics).
/// *Guarantee*: exact up to rounding, weights positive.
///
/// # Errors
/// Edges that make a weight not positive (an edge that runs through the vertex or to infinity).
pub fn patches(segment: &Segment) -> Result<Vec<Surface>, SplineError> {
    let pieces = (segment.shape.angle().abs() / LARGEST_TURN).ceil().clamp(1.0, 16.0) as usize;
    (0..pieces)
        .map(|i| {
            let cut = |k: usize| k as f64 / pieces as f64;
            patch(&if pieces == 1 { *segment } else { segment.part(cut(i), cut(i + 1)) })
        })
        .collect()
}

/// A segment as one patch, as [`patches`], with a knot where that cuts.
///
/// # Errors
/// Those of [`patches`]; pieces whose weights do not agree where they meet, which are those of edges that are no circles.
pub(crate) fn whole_patch(segment: &Segment) -> Result<Surface, SplineError> {
    let pieces = patches(segment)?;
    let [first, others @ ..] = &pieces[..] else { return patch(segment) };
    if others.is_empty() {
        return Ok(first.clone());
    }
    let mut control = first.control.clone();
    for piece in others {
        let joint = control.len() - 2;
        if (0..2).any(|side| control[joint + side][3].total_cmp(&piece.control[side][3]).is_ne()) {
            return Err(SplineError::Control { index: joint, reason: "the pieces have other weights here".into() });
        }
        control.extend_from_slice(&piece.control[2..]);
    }
    let count = pieces.len();
    let mut knots = vec![0.0; 3];
    (1..count).for_each(|k| knots.extend([k as f64 / count as f64; 2]));
    knots.extend([1.0; 3]);
    let points: Vec<Vec3> = control.iter().map(|c| Vec3::new(c[0], c[1], c[2]) / c[3]).collect();
    let weights: Vec<f64> = control.iter().map(|c| c[3]).collect();
    Surface::new(Knots::new(2, knots, control.len() / 2)?, Knots::clamped(1, &[0.0, 1.0])?, &points, Some(&weights))
}

/// All patches of a chain in order.
///
/// # Errors
/// Those of [`patches`].
pub fn all_patches(spline: &ConeSpline) -> Result<Vec<Surface>, SplineError> {
    let mut out = Vec::new();
    for s in &spline.segments {
        out.extend(patches(s)?);
    }
    Ok(out)
}

fn patch(s: &Segment) -> Result<Surface, SplineError> {
    let conics = [edge_conic(s, 0), edge_conic(s, 1)];
    let mut points = Vec::with_capacity(6);
    let mut weights = Vec::with_capacity(6);
    for i in 0..3 {
        for c in &conics {
            points.push(c[i].0);
            weights.push(c[i].1);
        }
    }
    let knots_u = Knots::clamped(2, &[0.0, 1.0])?;
    let knots_v = Knots::clamped(1, &[0.0, 1.0])?;
    Surface::new(knots_u, knots_v, &points, Some(&weights))
}

/// Control points and weights of an edge. The three points of either edge lie on the same three lines through the
/// vertex and belong to the same parameter, so that lines of constant u are rulings.
pub(crate) fn edge_conic(s: &Segment, side: usize) -> [(Vec3, f64); 3] {
    let [a, m, b] = s.edges[side];
    let (first, last) = (s.start.at(a), s.end().at(b));
    let local = |e: f64, p: f64| s.start.point + s.start.direction * e + s.start.forward * p;
    match s.shape {
        Shape::Cone { distance, sin_gamma, angle, .. } => {
            let w = (0.5 * angle).cos();
            // Along a plane section the reciprocal distance from the vertex is linear in the direction of the
            // ruling; everything relative to its value in the middle, so that far vertices do no harm.
            let tm = distance + m;
            let (ga, gb) = (-(a - m) / (distance + a), -(b - m) / (distance + b));
            let x = 0.5 * (ga + gb) / w;
            let t = tm / (1.0 - x);
            let beyond = m + tm * x / (1.0 - x);
            let middle = local(beyond, t * (0.5 * angle).tan() * sin_gamma);
            [(first, 1.0 + ga), (middle, w * (1.0 - x)), (last, 1.0 + gb)]
        }
        Shape::Cylinder { radius, angle } => {
            let w = (0.5 * angle).cos();
            let r = 0.5 * (2.0 * m * (1.0 + w) - a - b) / w;
            [(first, 1.0), (local(r, -radius * (0.5 * angle).tan()), w), (last, 1.0)]
        }
        Shape::Flat { width } => [(first, 1.0), (local(2.0 * m - 0.5 * (a + b), 0.5 * width), 1.0), (last, 1.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::g1_element::G1Element;

    fn specimens() -> Vec<Segment> {
        let g = G1Element::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.2, -0.3), Vec3::new(0.3, 0.0, 1.0))
            .expect("element");
        [
            Shape::Cone { distance: 4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 },
            Shape::Cone { distance: -4.0, cos_gamma: -0.8, sin_gamma: 0.6, angle: -2.9 },
            Shape::Cone { distance: 1e9, cos_gamma: 1.0, sin_gamma: 1e-9, angle: 0.7 },
            Shape::Cone { distance: 5.0, cos_gamma: 0.0, sin_gamma: 1.0, angle: 0.7 },
            Shape::Cylinder { radius: -2.0, angle: 0.9 },
            Shape::Flat { width: 0.7 },
        ]
        .into_iter()
        .map(|shape| Segment { edges: [[-1.0, -0.8, -0.9], [1.0, 1.3, 1.2]], ..Segment::new(g, shape) })
        .collect()
    }

    #[test]
    fn patches_lie_on_the_segment_with_its_edges_and_normals() {
        for s in specimens() {
            for (k, patch) in patches(&s).expect("patches").iter().enumerate() {
                let count = patches(&s).expect("patches").len() as f64;
                for u in [0.0, 0.3, 0.5, 0.9, 1.0] {
                    // The share of the turn by bisection on the side of the ruling.
                    let x = patch.point(u, 0.0);
                    let (mut lo, mut hi) = (k as f64 / count, (k as f64 + 1.0) / count);
                    for _ in 0..60 {
                        let f = 0.5 * (lo + hi);
                        let g = s.element(f);
                        if (x - g.point).dot(&g.forward) > 0.0 {
                            lo = f;
                        } else {
                            hi = f;
                        }
                    }
                    let f = 0.5 * (lo + hi);
                    let g = s.element(f);
                    for (v, side) in [(0.0, 0), (1.0, 1)] {
                        assert!((patch.point(u, v) - g.at(s.edge(side, f))).norm() < 1e-11, "{s:?} {u} {v}");
                    }
                    assert!(patch.jet(u, 0.4).normal().normalize().cross(&g.normal).norm() < 1e-8);
                }
            }
        }
    }

    #[test]
    fn bezier_planes_are_the_tangent_planes() {
        for s in specimens().into_iter().filter(|s| !s.shape.is_plane() && s.shape.angle().abs() < 2.0) {
            let planes = dual_planes(&s).expect("planes");
            for t in [0.0, 0.25, 0.5, 1.0] {
                let b = [(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t];
                let u: Vec<f64> = (0..4).map(|d| (0..3).map(|i| b[i] * planes[i][d]).sum()).collect();
                let w = (0.5 * s.shape.angle()).cos();
                let length = (u[1] * u[1] + u[2] * u[2] + u[3] * u[3]).sqrt();
                assert!((length - (b[0] + b[1] * w + b[2])).abs() < 1e-12);
                // Some ruling lies in it.
                let off = |f: f64| {
                    let g = s.element(f);
                    let n = Vec3::new(u[1], u[2], u[3]) / length;
                    (u[0] / length + n.dot(&g.point)).abs() + n.cross(&g.normal).norm()
                };
                let best = (0..=2000).map(|i| off(i as f64 / 2000.0)).fold(9.0, f64::min);
                let far = s.vertex().map_or(1.0, |v| v.norm().max(10.0));
                assert!(best < 2e-3 + 1e-15 * far, "{s:?} {t} {best}");
            }
        }
    }
}
