//! Cone splines flattened and bent: closed forms, circles to circles \[LP98\].
//!
//! *Method*: the sector of a cone turns by φ sin γ in the plane; chains of sectors are placed one after the other. The
//! plane is seen from the side of the normals: rulings and the forward direction are right-handed.

use super::arcs::{arcs, rectangle_around, PlaneCurve};
use super::overlap::{overlap, OutlinePoint};
use crate::geom::Vec2;
use crate::patchwork::panel::Border;
use crate::patchwork::pattern::{Contour, ContourVertex, Pattern, Side};
use crate::torse::cone::spline::{ConeSpline, Segment, Shape};

/// One segment in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatSegment {
    /// Image of the first element's point, mm.
    pub origin: Vec2,
    /// Angle of the first ruling, rad.
    pub angle: f64,
    /// Turn of the rulings over the segment, rad; 0 for cylinders and plane strips.
    pub turn: f64,
    /// Signed distance of `origin` from the apex along the first ruling; `None` where rulings are parallel.
    pub distance: Option<f64>,
    /// Width where rulings are parallel, mm.
    pub width: f64,
    /// Edge coordinates, see [`Segment::edges`].
    segment: Segment,
}

impl FlatSegment {
    /// Image of the point `(f, r)`: isometric.
    pub fn point(&self, f: f64, r: f64) -> Vec2 {
        let (s, c) = self.angle.sin_cos();
        let local = match self.distance {
            Some(d) => {
                let a = self.turn * f;
                let h = (0.5 * a).sin();
                // Distances from the apex may be huge; differences are formed first.
                Vec2::new(-2.0 * h * h * (d + r) + r, a.sin() * (d + r))
            }
            None => Vec2::new(r, self.width * f),
        };
        self.origin + Vec2::new(c * local.x - s * local.y, s * local.x + c * local.y)
    }

    /// Derivatives of [`FlatSegment::point`] by f and by r.
    pub fn derivatives(&self, f: f64, r: f64) -> [Vec2; 2] {
        let (s, c) = (self.angle + self.turn * f).sin_cos();
        let across = self.distance.map_or(self.width, |d| (d + r) * self.turn);
        [Vec2::new(-s, c) * across, Vec2::new(c, s)]
    }

    /// The common point of the rulings.
    pub fn apex(&self) -> Option<Vec2> {
        let (s, c) = self.angle.sin_cos();
        self.distance.map(|d| self.origin - Vec2::new(c, s) * d)
    }

    /// Angle of the last ruling, rad.
    pub fn end_angle(&self) -> f64 {
        self.angle + self.turn
    }
}

/// Flattens a chain: `origin` is the image of the first element's point, `angle` that of its ruling.
///
/// *Guarantee*: an isometry of every segment and smooth across joints, to rounding: no integration.
/// *Not guaranteed*: that the pattern does not overlap itself.
pub fn develop(spline: &ConeSpline, origin: Vec2, angle: f64) -> Vec<FlatSegment> {
    let mut out: Vec<FlatSegment> = Vec::with_capacity(spline.segments.len());
    for s in &spline.segments {
        let (origin, angle) = match (out.last(), out.len()) {
            (Some(last), n) => {
                let end = spline.segments[n - 1].end();
                let slide = (s.start.point - end.point).dot(&end.direction);
                (last.point(1.0, slide), last.end_angle())
            }
            (None, _) => (origin, angle),
        };
        let (distance, width) = match s.shape {
            Shape::Cone { distance, .. } => (Some(distance), 0.0),
            Shape::Cylinder { radius, angle } => (None, -radius * angle),
            Shape::Flat { width } => (None, width),
        };
        out.push(FlatSegment { origin, angle, turn: s.shape.flat_angle(), distance, width, segment: *s });
    }
    out
}

/// How a chain is unbent, from s = 0 (as it is) to s = 1 (plane).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Bending {
    /// sin γ grows linearly to 1, as in \[LP98\].
    Sine,
    /// The curvature across the rulings shrinks linearly, on cones and cylinders alike.
    #[default]
    Curvature,
}

/// The chain at the stage `s` of its bending into the plane; the first ruling and its tangent plane stay.
///
/// *Guarantee*: isometric at every stage, `s = 0` is the input, `s = 1` plane (rounding).
pub fn bent(spline: &ConeSpline, s: f64, bending: Bending) -> ConeSpline {
    let s = s.clamp(0.0, 1.0);
    let mut out: Vec<Segment> = Vec::with_capacity(spline.segments.len());
    for (i, segment) in spline.segments.iter().enumerate() {
        let start = match out.last() {
            None => segment.start,
            Some(last) => {
                let before = spline.segments[i - 1].end();
                let slide = (segment.start.point - before.point).dot(&before.direction);
                let mut end = last.end();
                end.point = end.at(slide);
                end
            }
        };
        out.push(Segment { start, shape: bent_shape(&segment.shape, s, bending), edges: segment.edges });
    }
    ConeSpline { segments: out }
}

fn bent_shape(shape: &Shape, s: f64, bending: Bending) -> Shape {
    match *shape {
        Shape::Cone { distance, cos_gamma, sin_gamma, angle } => {
            let (sine, cosine) = match bending {
                Bending::Sine => {
                    let k = (1.0 - s) * sin_gamma + s;
                    (k, cos_gamma.signum() * ((1.0 - k) * (1.0 + k)).max(0.0).sqrt())
                }
                Bending::Curvature => {
                    let (c, k) = ((1.0 - s) * cos_gamma, sin_gamma);
                    let length = c.hypot(k);
                    (k / length, c / length)
                }
            };
            let cos_gamma = if s >= 1.0 { 0.0 } else { cosine };
            Shape::Cone { distance, cos_gamma, sin_gamma: sine, angle: angle * sin_gamma / sine }
        }
        Shape::Cylinder { radius, angle } if s < 1.0 => {
            Shape::Cylinder { radius: radius / (1.0 - s), angle: angle * (1.0 - s) }
        }
        Shape::Cylinder { radius, angle } => Shape::Flat { width: -radius * angle },
        flat @ Shape::Flat { .. } => flat,
    }
}

/// An edge of a flat segment as a plane curve.
struct FlatEdge<'a> {
    flat: &'a FlatSegment,
    side: usize,
    backwards: bool,
}

impl FlatEdge<'_> {
    fn at(&self, f: f64) -> Vec2 {
        self.flat.point(f, self.flat.segment.edge(self.side, f))
    }
}

impl PlaneCurve for FlatEdge<'_> {
    fn place(&self, s: f64) -> Vec2 {
        self.at(if self.backwards { 1.0 - s } else { s })
    }

    fn velocity(&self, s: f64) -> Vec2 {
        // The edge is a smooth closed form; a central difference of this width is good to ten digits.
        const STEP: f64 = 1e-4;
        let f = if self.backwards { 1.0 - s } else { s };
        let d = (self.at(f - 2.0 * STEP) - self.at(f + 2.0 * STEP) + (self.at(f + STEP) - self.at(f - STEP)) * 8.0)
            / (12.0 * STEP);
        if self.backwards {
            -d
        } else {
            d
        }
    }
}

/// The cutting pattern of a chain: a closed contour of lines and true arcs, without bend lines.
///
/// Circular edges (constant r) become exactly one arc for a segment; other edges (plane sections, whose images are no
/// circles) become arcs within `contour_tolerance` (mm).
pub fn cone_pattern(spline: &ConeSpline, name: &str, contour_tolerance: f64) -> Pattern {
    let flats = develop(spline, Vec2::zeros(), 0.0);
    let mut pattern = Pattern { name: name.to_owned(), ..Pattern::default() };
    let (Some(first), Some(last)) = (flats.first(), flats.last()) else { return pattern };
    let mut vertices: Vec<ContourVertex> = Vec::new();
    // Counter-clockwise, forward being the plane's y on the first ruling: along the upper edge, back along the lower.
    let corner = |f: &FlatSegment, share: f64, side: usize| f.point(share, f.segment.edge(side, share));
    vertices.push(ContourVertex { point: corner(first, 0.0, 0), bulge: 0.0, corner: true });
    let walk = |flats: &mut dyn Iterator<Item = &FlatSegment>, side: usize, vertices: &mut Vec<ContourVertex>| -> f64 {
        let backwards = side == 0;
        let mut error = 0.0_f64;
        let mut at_corner = true;
        for flat in flats {
            let [a, m, b] = flat.segment.edges[side];
            if a == m && m == b {
                let turn = if backwards { -flat.turn } else { flat.turn };
                let point = corner(flat, if backwards { 1.0 } else { 0.0 }, side);
                vertices.push(ContourVertex { point, bulge: (0.25 * turn).tan(), corner: at_corner });
            } else {
                let (pieces, off) = arcs(&FlatEdge { flat, side, backwards }, contour_tolerance);
                error = error.max(off);
                for p in pieces {
                    vertices.push(ContourVertex { point: p.point, bulge: p.bulge, corner: at_corner });
                    at_corner = false;
                }
            }
            at_corner = false;
        }
        error
    };
    let upper = walk(&mut flats.iter(), 1, &mut vertices);
    vertices.push(ContourVertex { point: corner(last, 1.0, 1), bulge: 0.0, corner: true });
    let lower = walk(&mut flats.iter().rev(), 0, &mut vertices);
    // The lower edge ends where the contour began.
    pattern.contour_error = upper.max(lower);
    pattern.area = area(&vertices);
    pattern.area_in_space = pattern.area;
    let ends = [(first, 0.0), (last, 1.0)];
    for (edge, (f, share)) in ends.into_iter().enumerate() {
        let (a, b) = (corner(f, share, 0), corner(f, share, 1));
        pattern.sides.push(Side {
            border: Border::Trim { edge: edge as u32 },
            middle: (a + b) * 0.5,
            length: (b - a).norm(),
        });
    }
    pattern.contours.push(Contour { vertices });
    if let Some(r) = rectangle_around(&pattern.contours) {
        (pattern.width, pattern.length) = (r.width, r.length);
    }
    pattern
}

/// Points of each edge of a segment at which overlaps are sought.
const OVERLAP_SAMPLES: usize = 8;

/// Whether the flat pattern of a chain overlaps itself (outline sampled; `apart` as in `overlap`).
pub(crate) fn overlaps(spline: &ConeSpline, apart: f64) -> bool {
    let flats = develop(spline, Vec2::zeros(), 0.0);
    let mut outline = Vec::new();
    for side in [1, 0] {
        let mut run: Vec<OutlinePoint> = Vec::new();
        for (i, (s, flat)) in spline.segments.iter().zip(&flats).enumerate() {
            let last = if i + 1 == flats.len() { OVERLAP_SAMPLES } else { OVERLAP_SAMPLES - 1 };
            run.extend((0..=last).map(|k| {
                let f = k as f64 / OVERLAP_SAMPLES as f64;
                let r = s.edge(side, f);
                OutlinePoint { flat: flat.point(f, r), space: s.point(f, r), t: i as f64 + f }
            }));
        }
        if side == 0 {
            run.reverse();
        }
        outline.extend(run);
    }
    overlap(&[outline], apart).is_some()
}

/// Area inside a contour of lines and arcs.
pub(super) fn area(vertices: &[ContourVertex]) -> f64 {
    let origin = vertices.first().map_or(Vec2::zeros(), |v| v.point);
    (0..vertices.len())
        .map(|i| {
            let (v, w) = (&vertices[i], &vertices[(i + 1) % vertices.len()]);
            let (a, b) = (v.point - origin, w.point - origin);
            let chord = (w.point - v.point).norm();
            let sweep = 4.0 * v.bulge.atan();
            let half = (0.5 * sweep).sin();
            let segment = if v.bulge == 0.0 {
                0.0
            } else {
                let radius = 0.5 * chord / half;
                0.5 * radius * radius * (sweep - sweep.sin())
            };
            0.5 * (a.x * b.y - a.y * b.x) + segment
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::torse::cone::pair::{cone_pair, PairOptions};
    use crate::torse::g1_element::G1Element;

    fn element(u: f64) -> G1Element {
        let (s, c) = u.sin_cos();
        let e = Vec3::new(-s, c, 0.6 + 0.3 * u).normalize();
        let d = Vec3::new(-c, -s, 0.3);
        G1Element::new(Vec3::new(c, s, 0.6 * u + 0.15 * u * u) + e * 1.5, e, d - e * e.dot(&d)).expect("element")
    }

    fn chain(reach: f64) -> ConeSpline {
        let mut segments = Vec::new();
        for i in 0..3 {
            let (a, b) = (f64::from(i) * 0.4, f64::from(i + 1) * 0.4);
            segments.extend(cone_pair(&element(a), &element(b), &PairOptions::default()).expect("pair").segments);
        }
        ConeSpline { segments }.with_circular_edges(-reach, reach)
    }

    #[test]
    fn the_map_is_isometric_and_smooth() {
        let spline = chain(0.4);
        let flats = develop(&spline, Vec2::new(3.0, 4.0), 0.3);
        for (s, f) in spline.segments.iter().zip(&flats) {
            for (x, y) in [(0.1, -0.3), (0.8, 0.35)] {
                let h = 1e-5;
                let space = [s.point(x + h, y) - s.point(x - h, y), s.point(x, y + h) - s.point(x, y - h)]
                    .map(|d| d / (2.0 * h));
                let plane = [f.point(x + h, y) - f.point(x - h, y), f.point(x, y + h) - f.point(x, y - h)]
                    .map(|d| d / (2.0 * h));
                for i in 0..2 {
                    for j in 0..2 {
                        assert!((space[i].dot(&space[j]) - plane[i].dot(&plane[j])).abs() < 1e-9);
                    }
                }
            }
        }
        for (i, w) in flats.windows(2).enumerate() {
            let p = w[0].point(1.0, 0.2);
            let slide = (spline.segments[i + 1].start.point - spline.segments[i].end().point)
                .dot(&spline.segments[i].end().direction);
            assert!((w[1].point(0.0, 0.2 - slide) - p).norm() < 1e-13);
        }
    }

    #[test]
    fn bending_keeps_lengths_and_ends_in_the_plane() {
        let spline = chain(0.4);
        for bending in [Bending::Sine, Bending::Curvature] {
            assert!(bent(&spline, 0.0, bending).segments.iter().zip(&spline.segments).all(|(a, b)| (a
                .point(0.7, 0.3)
                - b.point(0.7, 0.3))
            .norm()
                < 1e-13));
            let flat = bent(&spline, 1.0, bending);
            let (o, n) = (flat.segments[0].start.point, flat.segments[0].start.normal);
            let plane = develop(&spline, Vec2::zeros(), 0.0);
            for (s, p) in flat.segments.iter().zip(&plane) {
                let x = s.point(0.6, 0.3);
                assert!((x - o).dot(&n).abs() < 1e-14);
                let local = flat.segments[0].start.to_local(&(x - o));
                assert!((Vec2::new(local.x, local.y) - p.point(0.6, 0.3)).norm() < 1e-13);
            }
            for stage in [0.3, 0.7] {
                let b = bent(&spline, stage, bending);
                assert!(b.mismatch(1.0) < 1e-14);
                for (i, s) in b.segments.iter().enumerate() {
                    let (h, o) = (1e-5, &spline.segments[i]);
                    let speed = |s: &Segment| (s.point(0.4 + h, 0.3) - s.point(0.4 - h, 0.3)).norm() / (2.0 * h);
                    assert!((speed(s) - speed(o)).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn circles_become_single_arcs_and_the_contour_has_the_right_area() {
        let spline = chain(0.4);
        let p = cone_pattern(&spline, "A", 1e-6);
        assert_eq!(p.contour_error, 0.0);
        // One arc per segment and edge, four corners of which two begin an edge.
        assert_eq!(p.contours[0].vertices.len(), 2 * spline.segments.len() + 2);
        let exact: f64 = spline
            .segments
            .iter()
            .map(|s| {
                let Shape::Cone { distance: d, .. } = s.shape else { panic!("cone") };
                let [lower, upper] = s.edges;
                0.5 * s.shape.flat_angle() * ((d + upper[0]).powi(2) - (d + lower[0]).powi(2))
            })
            .sum();
        assert!((p.area - exact).abs() < 1e-12 * exact, "{} {exact}", p.area);
    }
}
