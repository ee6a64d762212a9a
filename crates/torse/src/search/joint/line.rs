//! Seam lines on a face: where neighbouring regions meet, how they may slide, and where they lie after a step.
//!
//! *Method* ([joint](super)). A line is a spline of parameters, sampled at equal arc lengths. It slides along its
//! conormal; towards an end on the border of the face the way turns until it runs along that border. Ends where several
//! lines meet are moved by unknowns of their own, which fade along the lines.

use super::form::Foot;
use crate::brep::face::Face;
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use crate::spline::lsq;

/// Points of a line, at least, and for each span of the strips beside it: what no point sees between them grows into waves.
const POINTS: (usize, usize) = (121, 2);
/// Functions of a slide.
pub(super) const SLIDES: usize = 12;
/// Share of a line along which its ends make themselves felt.
const FADE: f64 = 0.15;
/// The same for vertices, mm per tolerance.
const VERTEX_FADE: f64 = 60.0;
/// Least cosine between the border of the face and the conormal at an end that slides along it.
const LEAST_CROSSING: f64 = 0.2;
/// Cosine of the turn at a corner of the face's border, at least.
const CORNER: f64 = 0.95;
/// Spans of the spline of a line at most, points for each at least, and points of a line to begin with.
const SPANS: (usize, usize, usize) = (12, 4, 16);

/// Spans at most of a line that must stay where it is: others slide, and may begin smoother than borders are.
const HELD: usize = 48;

/// What happens at an end of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// It slides along the border of the face.
    Border,
    /// It stays.
    Fixed,
    /// It goes with a vertex.
    Vertex(usize),
}

/// A point of a line.
#[derive(Clone, Debug)]
pub(super) struct LinePoint {
    /// Share of the line's length.
    pub share: f64,
    pub uv: [f64; 2],
    pub x: Vec3,
    /// Unit normal of the face.
    pub normal: Vec3,
    /// Unit tangent of the line.
    pub tangent: Vec3,
    /// Direction of a slide, and of the two unknowns of a vertex.
    pub slide: Vec3,
    pub axes: [Vec3; 2],
    /// How much the vertices at both ends count.
    pub blend: [f64; 2],
    /// Feet on both strips.
    pub feet: [Option<Foot>; 2],
    /// Between both strips: the point, its feet, and the direction in which heights are counted.
    pub middle: Option<Middle>,
}

/// The middle of two strips over a point of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Middle {
    pub z: Vec3,
    pub feet: [Foot; 2],
    pub up: Vec3,
}

impl Middle {
    /// Height of the second strip over the first, mm.
    pub fn gap(&self) -> f64 {
        let [a, b] = self.feet;
        a.distance / a.normal.dot(&self.up) - b.distance / b.normal.dot(&self.up)
    }
}

/// A line between two strips, of which the first is on the left.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub strips: [usize; 2],
    pub ends: [End; 2],
    /// Whether it must stay where it is.
    pub held: bool,
    /// How many points it has.
    pub count: usize,
    pub points: Vec<LinePoint>,
    pub length: f64,
}

/// How wide a strip should be at a point of one of its lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Width {
    pub line: usize,
    pub point: usize,
    /// 0 on the left of the line, 1 on its right.
    pub side: usize,
    /// mm.
    pub wanted: f64,
}

/// Knots of slides over [0, 1].
pub(super) fn slide_knots() -> Option<Knots> {
    Knots::uniform(3, SLIDES - 3, 0.0, 1.0).ok()
}

/// Values of the four functions of a slide that count at a share of the line, and the first of them.
pub(super) fn slide_functions(knots: &Knots, share: f64) -> (usize, [f64; 4]) {
    let b = knots.basis(share, 0);
    (b.first, std::array::from_fn(|j| b.rows[0][j]))
}

impl Line {
    /// A line between strips, without points so far.
    pub fn bare(strips: [usize; 2], ends: [End; 2], held: bool) -> Self {
        Self { strips, ends, held, count: POINTS.0, points: Vec::new(), length: 0.0 }
    }

    /// The line with as many points as strips of so many spans need.
    pub fn for_spans(mut self, spans: usize, face: &Face, tolerance: f64) -> Option<Self> {
        let count = POINTS.0.max(POINTS.1 * spans + 1);
        if count == self.count {
            return Some(self);
        }
        self.count = count;
        let uv: Vec<[f64; 2]> = self.points.iter().map(|p| p.uv).collect();
        self.through(face, &uv, tolerance)
    }

    /// The line through parameters in order. `None` for a line without length or normals.
    pub fn through(&self, face: &Face, uv: &[[f64; 2]], tolerance: f64) -> Option<Self> {
        let surface = &face.surface;
        let mut uv = uv.to_vec();
        while uv.len() < SPANS.2 {
            uv = uv.windows(2).flat_map(|w| [w[0], between(w[0], w[1], 0.5)]).chain(uv.last().copied()).collect();
        }
        let places: Vec<[f64; 3]> = uv.iter().map(|p| surface.point(p[0], p[1]).into()).collect();
        let shares = lsq::chord_parameters(&places);
        let most = if self.held { HELD } else { SPANS.0 };
        let spans = most.min(uv.len() / SPANS.1).max(1);
        let curve = lsq::fit(&uv, &shares, &Knots::uniform(3, spans, 0.0, 1.0).ok()?).ok()?.curve;
        // Equal arc lengths from a table.
        let count = 4 * (self.count - 1);
        let at: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
        let ((u0, u1), (v0, v1)) = surface.domain();
        let place = |t: f64| {
            let [u, v] = curve.point(t);
            [u.clamp(u0, u1), v.clamp(v0, v1)]
        };
        let table: Vec<Vec3> = at.iter().map(|&t| place(t)).map(|[u, v]| surface.point(u, v)).collect();
        let mut sums = vec![0.0];
        table.windows(2).for_each(|w| sums.push(sums[sums.len() - 1] + (w[1] - w[0]).norm()));
        let length = sums[count];
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let mut points = Vec::with_capacity(self.count);
        for i in 0..self.count {
            let share = i as f64 / (self.count - 1) as f64;
            let k = sums.partition_point(|s| *s < share * length).clamp(1, count);
            let t = at[k - 1] + (at[k] - at[k - 1]) * ((share * length - sums[k - 1]) / (sums[k] - sums[k - 1]));
            let [_, d, _] = curve.jet(t);
            let p = place(t);
            let j = surface.jet(p[0], p[1]);
            let normal = j.normal().try_normalize(0.0)?;
            let tangent = (j.du * d[0] + j.dv * d[1]).try_normalize(0.0)?;
            let first = j.du.try_normalize(0.0)?;
            points.push(LinePoint {
                share,
                uv: p,
                x: j.p,
                normal,
                tangent,
                slide: normal.cross(&tangent),
                axes: [first, normal.cross(&first)],
                blend: [0.0; 2],
                feet: [None; 2],
                middle: None,
            });
        }
        let mut out = Self { points, length, ..self.clone() };
        out.fade(face, tolerance);
        Some(out)
    }

    /// Directions of slides near the ends, and how far vertices count.
    fn fade(&mut self, face: &Face, tolerance: f64) {
        let vertex = FADE.max(VERTEX_FADE * tolerance / self.length).min(1.0);
        for (e, end) in self.ends.into_iter().enumerate() {
            let at = if e == 0 { 0 } else { self.count - 1 };
            let p = &self.points[at];
            let crossing = match end {
                End::Border => border_tangent(face, p).and_then(|t| {
                    let across = t.dot(&p.slide);
                    (across.abs() >= LEAST_CROSSING).then_some(t.dot(&p.tangent) / across)
                }),
                _ => None,
            };
            for p in &mut self.points {
                let from = if e == 0 { p.share } else { 1.0 - p.share };
                let near = |reach: f64| (1.0 - from / reach).max(0.0).powi(2);
                match crossing {
                    Some(shear) => p.slide += p.tangent * (shear * near(FADE)),
                    None => p.slide *= 1.0 - near(FADE),
                }
                if matches!(end, End::Vertex(_)) {
                    p.blend[e] = near(vertex);
                }
            }
        }
        if self.held {
            self.points.iter_mut().for_each(|p| p.slide = Vec3::zeros());
        }
    }

    /// Ways in which a point goes with the line's unknowns: `(vertex, axis or slide)`; mm per mm.
    pub fn vertex_ways(&self, p: &LinePoint) -> impl Iterator<Item = (usize, [Vec3; 2])> {
        let blend = p.blend;
        let axes = p.axes;
        // A line from a vertex to itself goes with it as a whole.
        let same = self.ends[0] == self.ends[1];
        self.ends.into_iter().enumerate().filter_map(move |(e, end)| match end {
            End::Vertex(v) if !(same && e == 1) && blend[e] > 0.0 => Some((v, axes.map(|a| a * blend[e]))),
            _ => None,
        })
    }

    /// The line after each of its points went a way (mm) along the face.
    pub fn moved(&self, face: &Face, way: impl Fn(&LinePoint) -> Vec3, tolerance: f64) -> Option<Self> {
        let ((u0, u1), (v0, v1)) = face.surface.domain();
        let mut uv: Vec<[f64; 2]> = Vec::with_capacity(self.count);
        for p in &self.points {
            let [du, dv] = parameters(face, p.uv, &way(p))?;
            uv.push([(p.uv[0] + du).clamp(u0, u1), (p.uv[1] + dv).clamp(v0, v1)]);
        }
        for (e, end) in self.ends.into_iter().enumerate() {
            let at = if e == 0 { 0 } else { self.count - 1 };
            match end {
                End::Border => uv[at] = nearest_border(face, uv[at])?.0,
                End::Fixed => uv[at] = self.points[at].uv,
                End::Vertex(_) => {}
            }
        }
        self.through(face, &uv, tolerance)
    }
}

fn between(p: [f64; 2], q: [f64; 2], share: f64) -> [f64; 2] {
    [p[0] + (q[0] - p[0]) * share, p[1] + (q[1] - p[1]) * share]
}

/// Change of the parameters for a way (mm) in the tangent plane.
fn parameters(face: &Face, p: [f64; 2], way: &Vec3) -> Option<[f64; 2]> {
    let j = face.surface.jet(p[0], p[1]);
    let (e, f, g) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
    let (a, b) = (j.du.dot(way), j.dv.dot(way));
    let det = e * g - f * f;
    let out = [(a * g - b * f) / det, (b * e - a * f) / det];
    out.iter().all(|x| x.is_finite()).then_some(out)
}

/// The nearest point of the face's border in the metric at `p`, with the direction of the border there: both directions at
/// a corner.
fn nearest_border(face: &Face, p: [f64; 2]) -> Option<([f64; 2], Vec<[f64; 2]>)> {
    let j = face.surface.jet(p[0], p[1]);
    let size = |d: [f64; 2]| (j.du * d[0] + j.dv * d[1]).norm();
    let mut best: Option<(f64, [f64; 2], Vec<[f64; 2]>)> = None;
    for l in &face.loops {
        let n = l.points.len();
        for i in 0..n {
            let (a, b) = (l.points[i], l.points[(i + 1) % n]);
            let (d, off) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let (along, away) = (j.du * d[0] + j.dv * d[1], j.du * off[0] + j.dv * off[1]);
            let share = (away.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            if !share.is_finite() {
                continue;
            }
            let q = between(a, b, share);
            let distance = size([p[0] - q[0], p[1] - q[1]]);
            if best.as_ref().is_none_or(|b| distance < b.0) {
                let mut directions = vec![d];
                let near = |s: f64| s * size(d) <= CORNER_REACH * face.surface.bbox().diagonal();
                if near(share) {
                    let c = l.points[(i + n - 1) % n];
                    directions.push([a[0] - c[0], a[1] - c[1]]);
                }
                if near(1.0 - share) {
                    let c = l.points[(i + 2) % n];
                    directions.push([c[0] - b[0], c[1] - b[1]]);
                }
                best = Some((distance, q, directions));
            }
        }
    }
    best.map(|b| (b.1, b.2))
}

/// Share of the face's size within which an end lies on a corner of its border.
const CORNER_REACH: f64 = 1e-6;

/// Unit tangent of the face's border at the end of a line; `None` at a corner.
fn border_tangent(face: &Face, p: &LinePoint) -> Option<Vec3> {
    let j = face.surface.jet(p.uv[0], p.uv[1]);
    let directions = nearest_border(face, p.uv)?.1;
    let mut all = directions.iter().filter_map(|d| (j.du * d[0] + j.dv * d[1]).try_normalize(0.0));
    let first = all.next()?;
    all.all(|t| t.dot(&first) > CORNER).then_some(first)
}
