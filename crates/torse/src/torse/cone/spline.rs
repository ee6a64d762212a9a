//! Cone splines: smooth chains of pieces of right circular cones, cylinders and planes \[LP98\].
//!
//! A segment is given by the frame of its first ruling and three numbers, not by its vertex: so pieces whose vertex is
//! far away (almost cylinders) are as exact as the others. Formulae: docs/algorithms/cones.md.

use crate::geom::Vec3;
use crate::torse::g1_element::G1Element;

/// What a segment is cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Right circular cone; a plane sector where `cos_gamma` is 0.
    ///
    /// The vertex is `point − distance e`, the axis `w = cos γ e + sin γ n` (`sin γ > 0`).
    Cone {
        /// Signed distance of the first element's point from the vertex along its ruling, mm.
        distance: f64,
        /// Cosine of the angle between ruling and axis.
        cos_gamma: f64,
        /// Sine of that angle, `n·w`, positive.
        sin_gamma: f64,
        /// Signed turn about the axis from the first ruling to the last, rad.
        angle: f64,
    },
    /// Right circular cylinder: axis direction e, axis point `point − radius n`.
    Cylinder {
        /// Signed radius, positive where the normal points away from the axis, mm.
        radius: f64,
        /// Signed turn about e from the first ruling to the last, rad.
        angle: f64,
    },
    /// Plane strip between parallel rulings.
    Flat {
        /// Distance of the last ruling from the first, forward, mm.
        width: f64,
    },
}

/// One piece: from its first to its last ruling, and along the rulings between two edges.
///
/// Coordinates on a segment are `(f, r)`: `f` from 0 on the first ruling to 1 on the last is the share of the turn,
/// `r` the signed distance (mm) along the ruling from the circular arc that starts in `start.point` and cuts all
/// rulings at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// First ruling with its tangent plane.
    pub start: G1Element,
    /// Cone, cylinder or plane.
    pub shape: Shape,
    /// Coordinate r of the lower and of the upper edge on the first, the middle and the last ruling, mm. The edges in
    /// between are the plane sections (conics) through these points; circles where the three are equal.
    pub edges: [[f64; 3]; 2],
}

/// A smooth chain of segments: each begins with the ruling and the tangent plane with which the one before ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConeSpline {
    /// Segments in the order of the parameter.
    pub segments: Vec<Segment>,
}

/// Whether a number is greater than zero, which one that is not a number is not.
fn positive(x: f64) -> bool {
    x > 0.0
}

/// `(1 − cos x, sin x)` without cancellation.
fn turn(x: f64) -> (f64, f64) {
    let h = (0.5 * x).sin();
    (2.0 * h * h, x.sin())
}

impl Shape {
    /// Whether the piece is plane.
    pub fn is_plane(&self) -> bool {
        match self {
            Self::Cone { cos_gamma, .. } => *cos_gamma == 0.0,
            Self::Cylinder { .. } => false,
            Self::Flat { .. } => true,
        }
    }

    /// "cone", "cylinder" or "plane".
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cylinder { .. } => "cylinder",
            _ if self.is_plane() => "plane",
            _ => "cone",
        }
    }

    /// Signed turn about the axis, rad; 0 for a plane strip.
    pub fn angle(&self) -> f64 {
        match self {
            Self::Cone { angle, .. } | Self::Cylinder { angle, .. } => *angle,
            Self::Flat { .. } => 0.0,
        }
    }

    /// Turn of the rulings in the development, rad: φ sin γ.
    pub fn flat_angle(&self) -> f64 {
        match self {
            Self::Cone { sin_gamma, angle, .. } => angle * sin_gamma,
            _ => 0.0,
        }
    }
}

impl Segment {
    /// A segment whose edges are the arc of `start.point` itself.
    pub fn new(start: G1Element, shape: Shape) -> Self {
        Self { start, shape, edges: [[0.0; 3]; 2] }
    }

    /// Vertex of the cone; `None` for cylinders and plane strips.
    pub fn vertex(&self) -> Option<Vec3> {
        match self.shape {
            Shape::Cone { distance, .. } => Some(self.start.at(-distance)),
            _ => None,
        }
    }

    /// Direction of the axis: `n·w > 0` for cones, e for cylinders, the normal for planes.
    pub fn axis(&self) -> Vec3 {
        match self.shape {
            Shape::Cone { cos_gamma, sin_gamma, .. } => {
                self.start.direction * cos_gamma + self.start.normal * sin_gamma
            }
            Shape::Cylinder { .. } => self.start.direction,
            Shape::Flat { .. } => self.start.normal,
        }
    }

    /// Ruling and tangent plane at the share `f` of the turn, at the place `r = 0`.
    ///
    /// *Guarantee*: relative accuracy of the displacement from `start`, however far the vertex is.
    pub fn element(&self, f: f64) -> G1Element {
        let s = &self.start;
        let (local, [e, p, n]) = match self.shape {
            Shape::Cone { distance, cos_gamma: c, sin_gamma: k, angle } => {
                let (v, w) = turn(angle * f);
                // e(φ) − e, p(φ), n(φ) in the frame of the first ruling.
                let de = Vec3::new(-v * k * k, w * k, v * k * c);
                let p = Vec3::new(-w * k, 1.0 - v, w * c);
                let n = Vec3::new(v * k * c, -w * c, 1.0 - v * c * c);
                (de * distance, [Vec3::x() + de, p, n])
            }
            Shape::Cylinder { radius, angle } => {
                let (v, w) = turn(angle * f);
                let (p, n) = (Vec3::new(0.0, 1.0 - v, w), Vec3::new(0.0, -w, 1.0 - v));
                (Vec3::new(0.0, -w, -v) * radius, [Vec3::x(), p, n])
            }
            Shape::Flat { width } => (Vec3::new(0.0, width * f, 0.0), [Vec3::x(), Vec3::y(), Vec3::z()]),
        };
        G1Element {
            point: s.point + s.to_world(&local),
            direction: s.to_world(&e),
            forward: s.to_world(&p),
            normal: s.to_world(&n),
        }
    }

    /// Last ruling and tangent plane, at `r = 0`.
    pub fn end(&self) -> G1Element {
        self.element(1.0)
    }

    /// The point `(f, r)`.
    pub fn point(&self, f: f64, r: f64) -> Vec3 {
        self.element(f).at(r)
    }

    /// Coordinate r of an edge (0 lower, 1 upper) at the share `f`: the plane section through its three points.
    ///
    /// *Method*: along a plane section of a cone the reciprocal of the distance from the vertex is
    /// `a + b cos φ + c sin φ`, on a cylinder r itself; on a plane strip a parabola.
    pub fn edge(&self, side: usize, f: f64) -> f64 {
        let [a, m, b] = self.edges[side];
        // Circles, and pieces that do not turn.
        if a == m && m == b {
            return a;
        }
        let (full, distance) = match self.shape {
            Shape::Cone { distance, angle, .. } => (angle, Some(distance)),
            Shape::Cylinder { angle, .. } => (angle, None),
            Shape::Flat { .. } => {
                let x = 2.0 * f - 1.0;
                return m + 0.5 * (b - a) * x + (0.5 * (a + b) - m) * x * x;
            }
        };
        // g = g_m + B sin ψ + C (1 − cos ψ) about the middle ruling, ψ from −full/2 to full/2.
        let (vh, wh) = turn(0.5 * full);
        let (v, w) = turn(full * (f - 0.5));
        match distance {
            None => m + 0.5 * (b - a) / wh * w + (0.5 * (a + b) - m) / vh * v,
            Some(d) => {
                // 1/t relative to the middle, without large numbers cancelling: t = d + r,
                // 1/t − 1/t_m = −(r − r_m)/(t t_m).
                let tm = d + m;
                let (ga, gb) = (-(a - m) / ((d + a) * tm), -(b - m) / ((d + b) * tm));
                let g = 0.5 * (gb - ga) / wh * w + 0.5 * (ga + gb) / vh * v;
                // t = 1/(1/t_m + g)
                m - g * tm * tm / (1.0 + g * tm)
            }
        }
    }

    /// Whether the vertex lies outside the strip and the segment turns forward: all edge points on one side of the
    /// vertex and the turn in the direction of `forward` (spec of the regular case, \[LP98\] region of interest).
    pub fn fault(&self) -> Option<SegmentFault> {
        let corners = || self.edges.iter().flatten();
        match self.shape {
            Shape::Cone { distance, angle, sin_gamma, .. } => {
                let side = distance.signum();
                if let Some(&r) = corners().find(|&&r| !positive((distance + r) * side)) {
                    return Some(SegmentFault::Vertex { beyond: -(distance + r) * side });
                }
                (!(positive(angle * side) && positive(sin_gamma)))
                    .then_some(SegmentFault::Backward { angle: angle * side })
            }
            Shape::Cylinder { radius, angle } => {
                (!positive(-radius * angle)).then_some(SegmentFault::Backward { angle: -radius.signum() * angle })
            }
            Shape::Flat { width } => (!positive(width)).then_some(SegmentFault::Backward { angle: 0.0 }),
        }
    }

    /// The same piece passed from its last ruling to its first: forward and normal turn over.
    pub fn reversed(&self) -> Self {
        let start = self.end().reversed();
        // Turned over normals: axis −w makes n·w positive again, and the turn about it backwards is positive.
        let shape = match self.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, angle } => {
                Shape::Cone { distance, cos_gamma: -cos_gamma, sin_gamma, angle }
            }
            Shape::Cylinder { radius, angle } => Shape::Cylinder { radius: -radius, angle: -angle },
            flat @ Shape::Flat { .. } => flat,
        };
        let edges = self.edges.map(|[a, m, b]| [b, m, a]);
        Self { start, shape, edges }
    }

    /// Whether both edges are circles about the axis, up to a share of the ruling.
    pub fn is_between_circles(&self, share: f64) -> bool {
        let length = (self.edges[1][0] - self.edges[0][0]).abs();
        self.edges.iter().all(|[a, m, b]| (a - m).abs().max((b - m).abs()) <= share * length)
    }

    /// The parallel surface at the signed distance `delta` along the normal (sheet thickness), rulings to rulings.
    ///
    /// *Guarantee*: exact; the same angles and frames. *Not guaranteed*: that the offset strip stays clear of its
    /// vertex, see [`Segment::fault`].
    pub fn offset(&self, delta: f64) -> Self {
        let mut start = self.start;
        start.point += start.normal * delta;
        let shape = match self.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, angle } => {
                Shape::Cone { distance: distance - delta * cos_gamma / sin_gamma, cos_gamma, sin_gamma, angle }
            }
            Shape::Cylinder { radius, angle } => Shape::Cylinder { radius: radius + delta, angle },
            flat @ Shape::Flat { .. } => flat,
        };
        Self { start, shape, edges: self.edges }
    }

    /// This segment and the next one as one, where both are on one support, with the edges of this one; and how far coordinates
    /// of the next slide on it. `length` is the size of the strip, mm.
    fn joined(&self, next: &Self, length: f64) -> Option<(Self, f64)> {
        /// Supports that differ by less than this (rad, share of the length) are one.
        const SAME: f64 = 1e-9;
        let (a, b) = (self.shape.angle(), next.shape.angle());
        let (shape, share) = match (self.shape, next.shape) {
            (Shape::Cone { distance, cos_gamma, sin_gamma, .. }, Shape::Cone { .. }) => {
                (Shape::Cone { distance, cos_gamma, sin_gamma, angle: a + b }, a / (a + b))
            }
            (Shape::Cylinder { radius, .. }, Shape::Cylinder { .. }) => {
                (Shape::Cylinder { radius, angle: a + b }, a / (a + b))
            }
            (Shape::Flat { width }, Shape::Flat { width: more }) => {
                (Shape::Flat { width: width + more }, width / (width + more))
            }
            _ => return None,
        };
        let whole = Self { start: self.start, shape, edges: self.edges };
        // The longer one ends and passes its joint where the two did.
        let middle = self.end();
        let slide = (next.start.point - middle.point).dot(&next.start.direction);
        let same = whole.end().mismatch(&next.end(), length) <= SAME
            && whole.element(share).mismatch(&middle, length) <= SAME
            && whole.element(0.5 * (1.0 + share)).mismatch(&next.element(0.5), length) <= SAME;
        same.then_some((whole, slide))
    }

    /// The part between the shares `a` and `b` of the turn. Its edges pass through the same points.
    pub fn part(&self, a: f64, b: f64) -> Self {
        let m = 0.5 * (a + b);
        let share = b - a;
        let shape = match self.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, angle } => {
                Shape::Cone { distance, cos_gamma, sin_gamma, angle: angle * share }
            }
            Shape::Cylinder { radius, angle } => Shape::Cylinder { radius, angle: angle * share },
            Shape::Flat { width } => Shape::Flat { width: width * share },
        };
        let edges = [0, 1].map(|side| [a, m, b].map(|f| self.edge(side, f)));
        Self { start: self.element(a), shape, edges }
    }
}

/// What is wrong with a segment.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SegmentFault {
    /// The vertex lies in the strip.
    #[error("its vertex lies {beyond:.3e} mm inside the region of interest")]
    Vertex {
        /// How far inside, mm.
        beyond: f64,
    },
    /// The turn goes backwards.
    #[error("it turns backwards (by {angle:.3e} rad)")]
    Backward {
        /// Turn in the forward sense, rad.
        angle: f64,
    },
}

/// Coordinates of edges that differ by less than this share of the ruling are equal.
const EQUAL: f64 = 1e-12;
/// Turn (rad) of a piece between circles, at most: once about its axis, up to rounding.
pub(crate) const ONCE_AROUND: f64 = std::f64::consts::TAU * (1.0 + 1e-9);

impl ConeSpline {
    /// Number of supports of each kind: cones, cylinders, planes. Neighbours on one support count once; `length` is the size of
    /// the strip, mm.
    pub fn counts(&self, length: f64) -> [usize; 3] {
        let mut out = [0; 3];
        let mut before: Option<&Segment> = None;
        for s in &self.segments {
            if before.and_then(|b| b.joined(s, length)).is_none() {
                out[["cone", "cylinder", "plane"].iter().position(|n| *n == s.shape.name()).unwrap_or(2)] += 1;
            }
            before = Some(s);
        }
        out
    }

    /// Largest mismatch (rad, or distance of lines over `length`) between the end of a segment and the start of the
    /// next: rounding only, where the chain is smooth.
    pub fn mismatch(&self, length: f64) -> f64 {
        self.segments.windows(2).map(|w| w[0].end().mismatch(&w[1].start, length)).fold(0.0, f64::max)
    }

    /// The parallel surface at the signed distance `delta` along the normals: exactly a cone spline again.
    ///
    /// # Errors
    /// The first segment whose offset strip would contain its vertex, with its index.
    pub fn offset(&self, delta: f64) -> Result<Self, (usize, SegmentFault)> {
        let segments: Vec<Segment> = self.segments.iter().map(|s| s.offset(delta)).collect();
        match segments.iter().enumerate().find_map(|(i, s)| s.fault().map(|f| (i, f))) {
            Some(fault) => Err(fault),
            None => Ok(Self { segments }),
        }
    }

    /// The same surface with segments cut so that none turns by more than `limit` (rad) about its axis; those between circles
    /// by no more than `circles`.
    pub(crate) fn with_turns_below(&self, limit: f64, circles: f64) -> Self {
        // A full turn at the most makes this many pieces; more would be no limit but a mistake.
        const MOST_PIECES: f64 = 64.0;
        let mut segments = Vec::with_capacity(self.segments.len());
        for s in &self.segments {
            let limit = if s.is_between_circles(0.0) { circles } else { limit };
            let pieces = (s.shape.angle().abs() / limit).ceil().clamp(1.0, MOST_PIECES) as usize;
            if pieces == 1 {
                segments.push(*s);
                continue;
            }
            let cut = |k: usize| k as f64 / pieces as f64;
            segments.extend((0..pieces).map(|i| s.part(cut(i), cut(i + 1))));
        }
        Self { segments }
    }

    /// The same surface with neighbours on one support made one segment, as long as it turns by no more than `limit`
    /// (rad), between circles by no more than `circles`; `length` is the size of the strip, mm. Edges of merged segments are
    /// plane sections through the ends and the joint: those of circles stay as they are, others change.
    pub(crate) fn merged(&self, length: f64, limit: f64, circles: f64) -> Self {
        let mut segments: Vec<Segment> = Vec::with_capacity(self.segments.len());
        for s in &self.segments {
            let joined = segments.last().and_then(|last: &Segment| {
                let (whole, slide) = last.joined(s, length)?;
                let one_circle =
                    |k: usize| s.edges[k].iter().all(|r| (r + slide - last.edges[k][0]).abs() <= EQUAL * length);
                let round = last.is_between_circles(EQUAL) && one_circle(0) && one_circle(1);
                let edges = [0, 1].map(|k| match round {
                    true => [last.edges[k][0]; 3],
                    false => [last.edges[k][0], last.edges[k][2], s.edges[k][2] + slide],
                });
                let fits = whole.shape.angle().abs() <= if round { circles } else { limit };
                fits.then_some(Segment { edges, ..whole })
            });
            match (joined, segments.last_mut()) {
                (Some(whole), Some(last)) => *last = whole,
                _ => segments.push(*s),
            }
        }
        Self { segments }
    }

    /// This chain, merged from another one, cut where that one's joints are: as many segments, each on the support that
    /// it has here, with the other one's edges. `None` if it was not merged from that chain.
    pub(crate) fn cut_like(&self, other: &Self) -> Option<Self> {
        let measure = |s: &Segment| match s.shape {
            Shape::Flat { width } => width,
            _ => s.shape.angle(),
        };
        let mut segments = Vec::with_capacity(other.segments.len());
        for whole in &self.segments {
            // Summed in the order in which they were merged, so that the sums are equal.
            let (from, mut turned) = (segments.len(), vec![0.0_f64]);
            while turned.last().is_some_and(|t| t.total_cmp(&measure(whole)).is_ne()) {
                let next = other.segments.get(from + turned.len() - 1)?;
                turned.push(turned[turned.len() - 1] + measure(next));
            }
            let total = measure(whole);
            for (k, w) in turned.windows(2).enumerate() {
                let edges = other.segments[from + k].edges;
                segments.push(Segment { edges, ..whole.part(w[0] / total, w[1] / total) });
            }
        }
        (segments.len() == other.segments.len()).then_some(Self { segments })
    }

    /// Whether all edges are circles about the axes, up to rounding of their coordinates.
    pub fn has_circular_edges(&self) -> bool {
        self.segments.iter().all(|s| s.is_between_circles(EQUAL))
    }

    /// The chain between two circular arc splines: those that start at the coordinates `lower` and `upper` (mm) of
    /// the first ruling and cut all rulings at right angles. In the development they are arc splines too. Along the
    /// chain they drift towards or away from the vertices: check [`Segment::fault`].
    pub fn with_circular_edges(mut self, lower: f64, upper: f64) -> Self {
        let mut r = [lower, upper];
        for i in 0..self.segments.len() {
            if i > 0 {
                let end = self.segments[i - 1].end();
                let slide = (self.segments[i].start.point - end.point).dot(&end.direction);
                r = r.map(|r| r - slide);
            }
            self.segments[i].edges = r.map(|r| [r; 3]);
        }
        self
    }

    /// The chain passed the other way.
    pub fn reversed(&self) -> Self {
        Self { segments: self.segments.iter().rev().map(Segment::reversed).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start() -> G1Element {
        G1Element::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.2, -0.3), Vec3::new(0.3, 0.0, 1.0)).expect("element")
    }

    fn specimens() -> [Segment; 4] {
        let cone = Shape::Cone { distance: 4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 };
        let far = Shape::Cone { distance: -1e9, cos_gamma: -(1.0f64 - 1e-18).sqrt(), sin_gamma: 1e-9, angle: -0.4 };
        let cylinder = Shape::Cylinder { radius: -2.0, angle: 0.9 };
        let flat = Shape::Flat { width: 0.7 };
        [cone, far, cylinder, flat].map(|shape| {
            let mut s = Segment::new(start(), shape);
            s.edges = [[-1.0, -0.8, -0.9], [1.0, 1.3, 1.2]];
            s
        })
    }

    #[test]
    fn neighbours_on_one_surface_are_merged_and_others_are_not() {
        for shape in [
            Shape::Cone { distance: 4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 },
            Shape::Cylinder { radius: -2.0, angle: 0.9 },
            Shape::Flat { width: 0.7 },
        ] {
            let mut whole = Segment::new(start(), shape);
            whole.edges = [[-1.0; 3], [0.5; 3]];
            let parts = ConeSpline { segments: vec![whole.part(0.0, 0.3), whole.part(0.3, 1.0)] };
            let merged = parts.merged(2.0, 2.0, 2.0);
            assert_eq!(merged.segments.len(), 1);
            assert!(merged.segments[0].end().mismatch(&whole.end(), 2.0) < 1e-14);
            assert!((merged.segments[0].edge(1, 0.4) - 0.5).abs() < 1e-14);
            assert_eq!(parts.merged(2.0, 0.5, 0.5).segments.len(), if shape.angle() == 0.0 { 1 } else { 2 });
            let mut other = parts.clone();
            other.segments[1].shape = match shape {
                Shape::Cone { distance, cos_gamma, sin_gamma, angle } => {
                    Shape::Cone { distance: distance * 1.001, cos_gamma, sin_gamma, angle }
                }
                Shape::Cylinder { radius, angle } => Shape::Cylinder { radius: radius * 1.001, angle },
                Shape::Flat { .. } => Shape::Cylinder { radius: -5.0, angle: 0.1 },
            };
            assert_eq!(other.merged(2.0, 2.0, 2.0).segments.len(), 2);
        }
    }

    #[test]
    fn frames_turn_about_the_axis() {
        for s in specimens() {
            for f in [0.0, 0.3, 1.0] {
                let g = s.element(f);
                assert!((g.direction.cross(&g.forward) - g.normal).norm() < 1e-14);
                // The tangent plane touches: the derivative of the surface lies in it.
                let d = (s.point(f + 1e-6, 0.7) - s.point(f - 1e-6, 0.7)) / 2e-6;
                assert!(d.dot(&g.normal).abs() < 1e-8 && d.dot(&g.forward) > 0.0, "{s:?}");
                if let (Some(v), Shape::Cone { cos_gamma, .. }) = (s.vertex(), s.shape) {
                    assert!((g.direction.dot(&s.axis()) - cos_gamma).abs() < 1e-15);
                    let off = (v - g.point).cross(&g.direction).norm();
                    assert!(off < 1e-15 * (v - g.point).norm().max(10.0));
                }
            }
            assert_eq!(s.fault(), None);
        }
    }

    #[test]
    fn edges_are_plane_sections() {
        for s in specimens() {
            for side in [0, 1] {
                let p: Vec<Vec3> = [0.0, 0.5, 1.0, 0.2, 0.77].iter().map(|&f| s.point(f, s.edge(side, f))).collect();
                for (k, f) in [0.0, 0.5, 1.0].iter().enumerate() {
                    assert!((s.edge(side, *f) - s.edges[side][k]).abs() < 1e-12);
                }
                if !matches!(s.shape, Shape::Flat { .. }) {
                    let n = (p[1] - p[0]).cross(&(p[2] - p[0])).normalize();
                    assert!(n.dot(&(p[3] - p[0])).abs() < 1e-12 && n.dot(&(p[4] - p[0])).abs() < 1e-12, "{s:?}");
                }
            }
        }
    }

    #[test]
    fn reversing_and_cutting_keep_the_surface() {
        for s in specimens() {
            let r = s.reversed();
            assert_eq!(r.fault(), None);
            for f in [0.0, 0.4, 1.0] {
                assert!((s.point(f, 0.3) - r.point(1.0 - f, 0.3)).norm() < 1e-12, "{s:?}");
                assert!((s.element(f).normal + r.element(1.0 - f).normal).norm() < 1e-14);
                let part = s.part(0.2, 0.8);
                assert!((part.point(f, 0.3) - s.point(0.2 + 0.6 * f, 0.3)).norm() < 1e-12);
                if !matches!(s.shape, Shape::Flat { .. }) {
                    assert!((part.edge(1, f) - s.edge(1, 0.2 + 0.6 * f)).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn offsets_are_parallel() {
        for s in specimens() {
            let o = s.offset(0.25);
            for f in [0.0, 0.4, 1.0] {
                let (g, h) = (s.element(f), o.element(f));
                assert!((h.at(0.3) - g.at(0.3) - g.normal * 0.25).norm() < 1e-12, "{s:?}");
                assert!((g.normal - h.normal).norm() < 1e-15);
            }
        }
    }
}
