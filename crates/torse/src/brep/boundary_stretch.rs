//! The boundary of a face as stretches along its file's edges: exact curves of space with the place of every point in the
//! parameter plane.
//!
//! The trim of a face is a polygon; the file's curves go with it ([`FileBoundary`](crate::brep::face::FileBoundary)). A
//! stretch is a smooth stretch of one such curve, with the polygon as the guide that tells copies on closed surfaces apart.

use crate::brep::face::Face;
use crate::brep::nearest_on_curve::refine;
use crate::brep::space_curve::SpaceCurve;
use crate::geom::Vec3;
use crate::spline::curve::Curve;

/// A smooth stretch of the boundary of a face, material on the left seen against the outward normal.
#[derive(Clone, Debug)]
pub struct BoundaryStretch {
    /// Number of the file's edge; 0 for sides that the file has no edge for, such as a seam that the reader cut.
    pub entity: u64,
    /// Its curve; `None` where it is the image of a line of the parameter plane.
    curve: Option<Curve<4>>,
    /// Parameters of the curve in the direction of the stretch with places in the parameter plane; two at least.
    nodes: Vec<(f64, [f64; 2])>,
}

/// Tangents that turn by more than this (rad) within an edge are a corner: files print ten digits, polylines turn more.
const KINK: f64 = 1e-4;
/// Share of a curve's domain beside a knot where its direction is taken: far enough that rounding of the points leaves
/// five digits of it.
const BESIDE: f64 = 1e-6;
/// Shares of an edge closer than this are one.
const SAME_SHARE: f64 = 1e-9;

impl BoundaryStretch {
    /// Point of space and place in the parameter plane at `s` in [0, 1].
    pub fn at(&self, face: &Face, s: f64) -> (Vec3, [f64; 2]) {
        let (first, last) = (self.nodes[0].0, self.nodes[self.nodes.len() - 1].0);
        let t = first + (last - first) * s.clamp(0.0, 1.0);
        let uv = self.place(t);
        match &self.curve {
            Some(c) => (affine(c, t), uv),
            None => (face.surface.point(uv[0], uv[1]), uv),
        }
    }

    /// Its curve (homogeneous, mm) and the parameters at both ends; `None` where it has none of its own.
    pub fn curve(&self) -> Option<(&Curve<4>, [f64; 2])> {
        Some((self.curve.as_ref()?, [self.nodes[0].0, self.nodes[self.nodes.len() - 1].0]))
    }

    /// Both ends.
    pub fn ends(&self, face: &Face) -> [Vec3; 2] {
        [self.at(face, 0.0).0, self.at(face, 1.0).0]
    }

    /// Length (mm), by chords.
    pub fn length_estimate(&self, face: &Face) -> f64 {
        /// Chords.
        const CHORDS: usize = 24;
        let points: Vec<Vec3> = (0..=CHORDS).map(|k| self.at(face, k as f64 / CHORDS as f64).0).collect();
        points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
    }

    /// Share of the stretch where it passes nearest to `x`, and the distance there.
    pub fn nearest(&self, face: &Face, x: &Vec3) -> (f64, f64) {
        /// Starts.
        const STARTS: usize = 32;
        let distance = |s: f64| (self.at(face, s).0 - x).norm();
        let start = (0..=STARTS).map(|k| k as f64 / STARTS as f64).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let mut s = start.unwrap_or(0.0);
        if let Some(c) = &self.curve {
            let (first, last) = (self.nodes[0].0, self.nodes[self.nodes.len() - 1].0);
            let limits = (first.min(last), first.max(last));
            let curve = SpaceCurve::Spline(c.clone());
            let (t, _) = refine(|t| curve.jet(t), x, first + (last - first) * s, Some(limits));
            s = ((t - first) / (last - first)).clamp(0.0, 1.0);
        } else {
            let mut step = 1.0 / STARTS as f64;
            while step > SAME_SHARE {
                step *= 0.5;
                for q in [s - step, s + step] {
                    if (0.0..=1.0).contains(&q) && distance(q) < distance(s) {
                        s = q;
                    }
                }
            }
        }
        (s, distance(s))
    }

    /// The parts before and after `s`.
    pub fn split(&self, s: f64) -> [Self; 2] {
        let (first, last) = (self.nodes[0].0, self.nodes[self.nodes.len() - 1].0);
        let t = first + (last - first) * s;
        let node = (t, self.place(t));
        let before = |q: f64| (q < t) == (first < t) && (q - t).abs() > SAME_SHARE * (last - first).abs();
        let after = |q: f64| !before(q) && (q - t).abs() > SAME_SHARE * (last - first).abs();
        let head = self.nodes.iter().filter(|n| before(n.0)).copied().chain([node]).collect();
        let tail = std::iter::once(node).chain(self.nodes.iter().filter(|n| after(n.0)).copied()).collect();
        [head, tail].map(|nodes| Self { nodes, ..self.clone() })
    }

    fn reversed(mut self) -> Self {
        self.nodes.reverse();
        self
    }

    /// Place in the parameter plane at the curve's parameter `t`.
    fn place(&self, t: f64) -> [f64; 2] {
        let n = &self.nodes;
        let rising = n[n.len() - 1].0 >= n[0].0;
        let k = n.partition_point(|q| if rising { q.0 <= t } else { q.0 >= t }).clamp(1, n.len() - 1);
        let ((a, p), (b, q)) = (n[k - 1], n[k]);
        let x = if a == b { 0.0 } else { ((t - a) / (b - a)).clamp(0.0, 1.0) };
        [p[0] + (q[0] - p[0]) * x, p[1] + (q[1] - p[1]) * x]
    }
}

/// The stretches of a face, loop by loop in the order of the face's loops, each loop with the material on its left seen
/// against the outward normal.
pub(crate) fn boundary_stretches(face: &Face) -> Vec<Vec<BoundaryStretch>> {
    let loops = (0..face.loops.len()).map(|l| {
        let mut out: Vec<BoundaryStretch> = pieces(face, l).into_iter().flat_map(split_at_kinks).collect();
        if face.reversed {
            out.reverse();
            out = out.into_iter().map(BoundaryStretch::reversed).collect();
        }
        out
    });
    loops.collect()
}

/// What a side of the trim follows: its edge's index in the file's loops and piece, and the parameters at both ends.
struct Followed<'a> {
    entity: u64,
    curve: Option<&'a Curve<4>>,
    /// Equal for sides that may be one stretch.
    key: (u32, usize),
    ends: [f64; 2],
}

fn followed(face: &Face, l: usize, side: usize) -> Followed<'_> {
    let label = face.loops[l].edge[side];
    let edge = face.boundary.as_ref().and_then(|b| {
        let edge = b.loops.iter().flatten().find(|e| e.label == label)?;
        Some((edge, *b.along.get(l)?.get(side)?))
    });
    let Some((edge, [from, to])) = edge else {
        return Followed { entity: 0, curve: None, key: (label, usize::MAX), ends: [0.0, 1.0] };
    };
    let line = Followed { entity: edge.entity, curve: None, key: (label, usize::MAX), ends: [0.0, 1.0] };
    let Some(pieces) = edge.pieces.as_ref() else { return line };
    let piece = ((0.5 * (from + to)).max(0.0) as usize).min(pieces.len().saturating_sub(1));
    let Some(p) = pieces.get(piece) else { return line };
    let at = |x: f64| p.from + (p.to - p.from) * (x - piece as f64).clamp(0.0, 1.0);
    Followed { entity: edge.entity, curve: Some(&p.curve), key: (label, piece), ends: [at(from), at(to)] }
}

/// Stretches of loop `l` before they are split at kinks: sides of one edge that follow each other.
fn pieces(face: &Face, l: usize) -> Vec<BoundaryStretch> {
    let points = &face.loops[l].points;
    let n = points.len();
    let sides: Vec<Followed> = (0..n).map(|k| followed(face, l, k)).collect();
    let joined = |a: &Followed, b: &Followed| {
        let width = |f: &Followed| f.curve.map_or(1.0, |c| c.domain().1 - c.domain().0);
        a.key == b.key && a.curve.is_some() && (a.ends[1] - b.ends[0]).abs() <= SAME_SHARE * width(a)
    };
    // Begin where a stretch does; a loop of one closed stretch may begin anywhere.
    let start = (0..n).find(|&k| !joined(&sides[(k + n - 1) % n], &sides[k])).unwrap_or(0);
    let mut out: Vec<BoundaryStretch> = Vec::new();
    for i in 0..n {
        let k = (start + i) % n;
        let (side, from, to) = (&sides[k], points[k], points[(k + 1) % n]);
        let goes_on = i > 0 && joined(&sides[(k + n - 1) % n], side);
        match out.last_mut() {
            Some(stretch) if goes_on => stretch.nodes.push((side.ends[1], to)),
            // A side that closes a gap between edges is no way along its edge.
            _ if side.ends[0] == side.ends[1] => {}
            _ => {
                let nodes = vec![(side.ends[0], from), (side.ends[1], to)];
                let stretch = BoundaryStretch { entity: side.entity, curve: side.curve.cloned(), nodes };
                out.push(if stretch.curve.is_none() { along_parameter(face, stretch) } else { stretch });
            }
        }
    }
    out
}

/// The stretch with the curve that a line of constant parameter is.
fn along_parameter(face: &Face, stretch: BoundaryStretch) -> BoundaryStretch {
    let (p, q) = (stretch.nodes[0].1, stretch.nodes[stretch.nodes.len() - 1].1);
    let (curve, nodes) = if p[0] == q[0] {
        (face.surface.curve_at_u(p[0]), [p[1], q[1]])
    } else if p[1] == q[1] {
        (face.surface.curve_at_v(p[1]), [p[0], q[0]])
    } else {
        return stretch;
    };
    BoundaryStretch { curve: Some(curve), nodes: vec![(nodes[0], p), (nodes[1], q)], ..stretch }
}

/// The smooth parts of a stretch.
fn split_at_kinks(stretch: BoundaryStretch) -> Vec<BoundaryStretch> {
    let Some(curve) = &stretch.curve else { return vec![stretch] };
    let (first, last) = (stretch.nodes[0].0, stretch.nodes[stretch.nodes.len() - 1].0);
    let width = last - first;
    let degree = curve.knots.degree();
    let sharp = curve.knots.distinct().into_iter().filter(|(t, many)| {
        let s = (t - first) / width;
        *many >= degree && s > SAME_SHARE && s < 1.0 - SAME_SHARE && turn(curve, *t) > KINK
    });
    let mut shares: Vec<f64> = sharp.map(|(t, _)| (t - first) / width).collect();
    shares.sort_by(f64::total_cmp);
    let mut out = Vec::new();
    let (mut rest, mut done) = (stretch, 0.0);
    for s in shares {
        let [head, tail] = rest.split((s - done) / (1.0 - done));
        out.push(head);
        (rest, done) = (tail, s);
    }
    out.push(rest);
    out
}

/// Angle (rad) between the tangents of both sides at a knot.
fn turn(c: &Curve<4>, t: f64) -> f64 {
    let (a, b) = c.domain();
    let h = BESIDE * (b - a);
    let [p, q, r] = [t - h, t, t + h].map(|t| affine(c, t));
    (q - p).angle(&(r - q))
}

fn affine(c: &Curve<4>, t: f64) -> Vec3 {
    let h = c.point(t);
    Vec3::new(h[0], h[1], h[2]) / h[3]
}
