//! Curves of an archive: pieces in order, each with the parameters that the file gives it.

use super::bytes::{fault, Cursor, Fault, Reading};
use super::classes::Class;
use super::records::{self, Object};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::geom::placement::Placement;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use std::f64::consts::TAU;

/// Curves of curves of curves…: real files stay below 4.
const DEEPEST: u32 = 16;
/// Coordinates above this many mm (a million kilometres) are damage, and their products would overflow.
const FARTHEST: f64 = 1e12;
/// Parameters within this share of a domain are one: what the mapping of intervals rounds.
const SAME_PARAMETER: f64 = 1e-9;
/// Directions that differ by a larger angle (rad) make a corner: what eight printed digits lose.
const CORNER: f64 = 1e-6;
/// Axes of circles and planes may differ from orthonormal ones by this much: what eight printed digits lose.
const SKEW: f64 = 1e-6;

/// A curve of the file, in mm or, in a parameter plane, in parameters of a surface.
#[derive(Clone, Debug)]
pub(super) struct FileCurve {
    pieces: Vec<CurvePiece>,
}

/// A piece of a curve: the file's parameter runs over `domain` while the natural one runs from the first to the second
/// of `natural`, linearly.
#[derive(Clone, Debug)]
struct CurvePiece {
    curve: SpaceCurve,
    natural: [f64; 2],
    domain: [f64; 2],
}

impl CurvePiece {
    fn at(&self, t: f64) -> f64 {
        let [a, b] = self.domain;
        let s = ((t - a) / (b - a)).clamp(0.0, 1.0);
        let [p, q] = self.natural;
        match s {
            s if s <= SAME_PARAMETER => p,
            s if s >= 1.0 - SAME_PARAMETER => q,
            s => p + s * (q - p),
        }
    }
}

impl FileCurve {
    /// Parameters of the file.
    pub fn domain(&self) -> [f64; 2] {
        let (first, last) = (&self.pieces[0], &self.pieces[self.pieces.len() - 1]);
        [first.domain[0], last.domain[1]]
    }

    /// The whole curve.
    pub fn whole(&self) -> Vec<Arc> {
        self.pieces.iter().map(|p| Arc { curve: p.curve.clone(), from: p.natural[0], to: p.natural[1] }).collect()
    }

    /// The part between two parameters of the file, the first the smaller.
    pub fn part(&self, [a, b]: [f64; 2]) -> Reading<Vec<Arc>> {
        let [lo, hi] = self.domain();
        let hair = SAME_PARAMETER * (hi - lo);
        if !(a >= lo - hair && b <= hi + hair && b - a > hair) {
            return fault(format!("the part from {a} to {b} of a curve from {lo} to {hi} is asked for"));
        }
        let inside = self.pieces.iter().filter(|p| p.domain[1] > a + hair && p.domain[0] < b - hair);
        Ok(inside.map(|p| Arc { curve: p.curve.clone(), from: p.at(a), to: p.at(b) }).collect())
    }

    /// The same curve with other parameters.
    fn over(mut self, [a, b]: [f64; 2]) -> Self {
        let [lo, hi] = self.domain();
        let last = self.pieces.len() - 1;
        let map = |t: f64| a + (b - a) * ((t - lo) / (hi - lo));
        for (i, p) in self.pieces.iter_mut().enumerate() {
            p.domain = p.domain.map(map);
            if i == 0 {
                p.domain[0] = a;
            }
            if i == last {
                p.domain[1] = b;
            }
        }
        self
    }

    /// The only piece, as a curve with the ends of its natural parameter; several pieces become one spline with the
    /// parameters of the file.
    pub fn single(&self) -> Reading<(SpaceCurve, [f64; 2])> {
        match &self.pieces[..] {
            [p] => Ok((p.curve.clone(), p.natural)),
            _ => {
                let c = self.spline()?;
                let (a, b) = c.domain();
                Ok((SpaceCurve::Spline(c), [a, b]))
            }
        }
    }

    /// The pieces joined to one spline over the file's parameters. Those of arcs are the file's at the ends of pieces.
    pub fn spline(&self) -> Reading<Curve<4>> {
        let pieces = splines(&self.whole())?;
        let degree = pieces.iter().map(|c| c.knots.degree()).max().unwrap_or(1);
        let mut knots = Vec::new();
        let mut control: Vec<[f64; 4]> = Vec::new();
        for (c, p) in pieces.into_iter().zip(&self.pieces) {
            let c = c.elevated_to(degree).map_err(|e| Fault(e.to_string()))?;
            let (a, b) = c.domain();
            let c = c.restricted(a, b).map_err(|e| Fault(e.to_string()))?;
            let inner = &c.knots.values()[degree + 1..c.control.len()];
            let map = |t: f64| p.domain[0] + (p.domain[1] - p.domain[0]) * ((t - a) / (b - a));
            knots.extend(std::iter::repeat_n(p.domain[0], if knots.is_empty() { degree + 1 } else { degree }));
            knots.extend(inner.iter().map(|&t| map(t)));
            // Weights go on without a jump.
            let factor = control.last().map_or(1.0, |last| last[3] / c.control[0][3]);
            let rest = c.control.iter().skip(usize::from(!control.is_empty()));
            control.extend(rest.map(|h| h.map(|x| x * factor)));
        }
        knots.extend(std::iter::repeat_n(self.domain()[1], degree + 1));
        Curve::new(degree, knots, control).map_err(|e| Fault(e.to_string()))
    }

    /// The pieces, polygons cut at their corners.
    pub fn smooth(&self) -> Reading<Vec<Arc>> {
        let mut out = Vec::new();
        for arc in self.whole() {
            match &arc.curve {
                SpaceCurve::Spline(c) => {
                    let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
                    let inside = corners(c).into_iter().filter(|&t| t > lo && t < hi);
                    let mut at: Vec<f64> = std::iter::once(lo).chain(inside).chain([hi]).collect();
                    if arc.to < arc.from {
                        at.reverse();
                    }
                    let cut = |w: &[f64]| {
                        let (a, b) = (w[0].min(w[1]), w[0].max(w[1]));
                        let curve = c.restricted(a, b).map_err(|e| Fault(e.to_string()))?;
                        Ok(Arc { curve: straight(curve), from: w[0], to: w[1] })
                    };
                    out.extend(at.windows(2).map(cut).collect::<Reading<Vec<_>>>()?);
                }
                _ => out.push(arc),
            }
        }
        Ok(out)
    }
}

/// Parameters at which the direction of a spline jumps.
fn corners(c: &Curve<4>) -> Vec<f64> {
    let (p, knots) = (c.knots.degree(), c.knots.values());
    let (a, b) = c.domain();
    let place = |i: usize| c.control.get(i).map(|h| Vec3::new(h[0], h[1], h[2]) / h[3]);
    let mut out = Vec::new();
    for (t, _) in c.knots.distinct().into_iter().filter(|&(t, m)| m >= p && t > a && t < b) {
        // The control point that the spline goes through there, and its neighbours.
        let at = knots.partition_point(|&k| k <= t) - 1 - p;
        let (Some(before), Some(here), Some(after)) = (place(at.wrapping_sub(1)), place(at), place(at + 1)) else {
            continue;
        };
        let (u, v) = (here - before, after - here);
        if u.cross(&v).norm() > CORNER * u.norm() * v.norm() || u.dot(&v) <= 0.0 {
            out.push(t);
        }
    }
    out
}

/// A spline that is one line with constant speed, as such.
fn straight(c: Curve<4>) -> SpaceCurve {
    let ((a, b), even) = (c.domain(), c.control.iter().all(|h| h[3].to_bits() == 1f64.to_bits()));
    match &c.control[..] {
        [p, q] if even => {
            let (p, q) = (Vec3::new(p[0], p[1], p[2]), Vec3::new(q[0], q[1], q[2]));
            let direction = (q - p) / (b - a);
            SpaceCurve::Line { origin: p - direction * a, direction }
        }
        _ => SpaceCurve::Spline(c),
    }
}

/// A curve run through as `arc`, but over the parameters from `from` to `to`; `None` if these are not linear in its own.
pub(super) fn run_over(arc: &Arc, [from, to]: [f64; 2]) -> Option<SpaceCurve> {
    let rate = (arc.to - arc.from) / (to - from);
    match &arc.curve {
        SpaceCurve::Line { origin, direction } => {
            let start = origin + direction * arc.from;
            Some(SpaceCurve::Line { origin: start - direction * (rate * from), direction: direction * rate })
        }
        SpaceCurve::Spline(_) => {
            let along = splines(std::slice::from_ref(arc)).ok()?.pop()?;
            let c = if to < from { along.reversed() } else { along };
            let ((a, b), (lo, hi)) = (c.domain(), (from.min(to), from.max(to)));
            let map = |&t: &f64| if t >= b { hi } else { lo + (t - a) / (b - a) * (hi - lo) };
            let knots = c.knots.values().iter().map(map).collect();
            Curve::new(c.knots.degree(), knots, c.control).ok().map(SpaceCurve::Spline)
        }
        _ => None,
    }
}

/// Pieces of a path as splines in the direction of travel.
pub(super) fn splines(path: &[Arc]) -> Reading<Vec<Curve<4>>> {
    let one = |arc: &Arc| {
        let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
        let spline = match &arc.curve {
            SpaceCurve::Spline(c) => c.restricted(lo, hi),
            other => other.to_spline(lo, hi).map(|c| c.0),
        };
        let spline = spline.map_err(|e| Fault(e.to_string()))?;
        Ok(if arc.to < arc.from { spline.reversed() } else { spline })
    };
    path.iter().filter(|a| (a.to - a.from).abs() > 0.0).map(one).collect()
}

/// The spline moved by an affine map.
pub(super) fn placed(mut c: Curve<4>, place: &Placement) -> Curve<4> {
    for h in &mut c.control {
        let p = place.linear * Vec3::new(h[0], h[1], h[2]) + place.shift * h[3];
        *h = [p.x, p.y, p.z, h[3]];
    }
    c
}

/// Reads a curve; `scale` is the length of the file's unit in mm, or 1 in a parameter plane.
pub(super) fn curve(object: Object, scale: f64) -> Reading<FileCurve> {
    nested(object, scale, 0)
}

/// Reads a curve of segments that stands without a frame of its own.
pub(super) fn inline(c: &mut Cursor, scale: f64) -> Reading<FileCurve> {
    c.version()?;
    poly(c, scale, 0)
}

fn nested(object: Object, scale: f64, depth: u32) -> Reading<FileCurve> {
    if depth > DEEPEST {
        return fault("a curve is made of curves of curves without end");
    }
    let mut c = object.data;
    let (major, minor) = c.version()?;
    if major != 1 {
        return fault(format!("a curve has the unknown version {major}.{minor}"));
    }
    let out = match object.class {
        Class::LineCurve => line(&mut c, scale)?,
        Class::ArcCurve => arc(&mut c, scale)?,
        Class::PolylineCurve => polyline(&mut c, scale)?,
        Class::NurbsCurve => nurbs(&mut c, scale)?,
        Class::PolyCurve => poly(&mut c, scale, depth)?,
        Class::Other(id) => return fault(format!("a curve of the unknown class {id} is not read")),
        other => return fault(format!("a {} stands where a curve is needed", other.name())),
    };
    c.check()?;
    Ok(out)
}

/// A point in mm.
pub(super) fn point(c: &mut Cursor, scale: f64) -> Reading<Vec3> {
    let p = c.vector()? * scale;
    if p.amax() <= FARTHEST {
        Ok(p)
    } else {
        fault(format!("a point lies {:.3e} mm away from the origin", p.amax()))
    }
}

fn piece(curve: SpaceCurve, natural: [f64; 2], domain: [f64; 2]) -> FileCurve {
    FileCurve { pieces: vec![CurvePiece { curve, natural, domain }] }
}

fn line(c: &mut Cursor, scale: f64) -> Reading<FileCurve> {
    let (p, q) = (point(c, scale)?, point(c, scale)?);
    let domain = c.increasing()?;
    c.skip(4)?;
    if p == q {
        return fault("a line has no length");
    }
    Ok(piece(SpaceCurve::Line { origin: p, direction: q - p }, [0.0, 1.0], domain))
}

fn arc(c: &mut Cursor, scale: f64) -> Reading<FileCurve> {
    let frame = plane(c, scale)?;
    let radius = c.f64()? * scale;
    // Three points that the plane gives too.
    c.skip(72)?;
    let (angles, domain) = (c.increasing()?, c.increasing()?);
    c.skip(4)?;
    if !(radius > 0.0 && radius <= FARTHEST && angles[1] - angles[0] <= TAU * (1.0 + SAME_PARAMETER)) {
        return fault(format!("an arc has the radius {radius} mm and the angles {angles:?}"));
    }
    Ok(piece(SpaceCurve::Ellipse { frame, a: radius, b: radius }, angles, domain))
}

/// A frame from a plane with its equation.
pub(super) fn plane(c: &mut Cursor, scale: f64) -> Reading<Frame> {
    let (origin, x, y) = (point(c, scale)?, c.vector()?, c.vector()?);
    c.skip(24 + 32)?;
    frame(origin, x, y)
}

/// A frame whose first two axes are nearly these.
pub(super) fn frame(origin: Vec3, x: Vec3, y: Vec3) -> Reading<Frame> {
    if (x.norm() - 1.0).abs() > SKEW || (y.norm() - 1.0).abs() > SKEW || x.dot(&y).abs() > SKEW {
        return fault("a plane has axes that are not square to each other or not of length 1");
    }
    let x = x.normalize();
    let z = x.cross(&y).normalize();
    Ok(Frame { origin, x, y: z.cross(&x), z })
}

fn polyline(c: &mut Cursor, scale: f64) -> Reading<FileCurve> {
    let n = c.count(24)?;
    let points = (0..n).map(|_| point(c, scale)).collect::<Reading<Vec<Vec3>>>()?;
    let knots = c.numbers()?;
    c.skip(4)?;
    if n < 2 || knots.len() != n {
        return fault(format!("a polyline has {n} points and {} parameters", knots.len()));
    }
    let control = points.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect();
    spline(1, knots, control)
}

/// A spline from knots without the first and the last, which mean nothing.
fn spline(degree: usize, mut knots: Vec<f64>, control: Vec<[f64; 4]>) -> Reading<FileCurve> {
    if let (Some(&first), Some(&last)) = (knots.first(), knots.last()) {
        knots.insert(0, first);
        knots.push(last);
    }
    let c = Curve::new(degree, knots, control).map_err(|e| Fault(format!("a NURBS curve is not usable: {e}")))?;
    let (a, b) = c.domain();
    Ok(piece(SpaceCurve::Spline(c), [a, b], [a, b]))
}

/// A control point with its weight, as files hold it: the coordinates are multiplied by the weight.
pub(super) fn control(c: &mut Cursor, dimension: i32, rational: bool, scale: f64) -> Reading<[f64; 4]> {
    let mut h = [0.0, 0.0, 0.0, 1.0];
    for x in h.iter_mut().take(dimension as usize) {
        *x = c.f64()? * scale;
    }
    if rational {
        h[3] = c.f64()?;
    }
    let reach = h[..3].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if h[3] > 0.0 && reach <= FARTHEST * h[3] {
        Ok(h)
    } else {
        fault(format!("a control point has the weight {} and coordinates up to {reach:.3e} mm", h[3]))
    }
}

/// Checks a dimension of the space, which may be 1 to 3.
pub(super) fn dimension(c: &mut Cursor) -> Reading<(i32, bool)> {
    let (dimension, rational) = (c.i32()?, c.i32()?);
    if (1..=3).contains(&dimension) && (0..=1).contains(&rational) {
        Ok((dimension, rational == 1))
    } else {
        fault(format!("a NURBS form has the dimension {dimension} and the rational flag {rational}"))
    }
}

/// The degree from the order that the file states.
pub(super) fn degree(c: &mut Cursor) -> Reading<usize> {
    let order = c.i32()?;
    match usize::try_from(order) {
        Ok(n) if n >= 2 => Ok(n - 1),
        _ => fault(format!("a NURBS form has the order {order}")),
    }
}

fn nurbs(c: &mut Cursor, scale: f64) -> Reading<FileCurve> {
    let (dimension, rational) = dimension(c)?;
    let degree = degree(c)?;
    c.skip(4 + 8)?;
    c.skip_box()?;
    let knots = c.numbers()?;
    let n = c.count(8 * (dimension as usize + usize::from(rational)))?;
    let points = (0..n).map(|_| control(c, dimension, rational, scale)).collect::<Reading<Vec<_>>>()?;
    spline(degree, knots, points)
}

fn poly(c: &mut Cursor, scale: f64, depth: u32) -> Reading<FileCurve> {
    let n = c.count(1)?;
    c.skip(8)?;
    c.skip_box()?;
    let knots = c.numbers()?;
    if n == 0 || knots.len() != n + 1 {
        return fault(format!("a curve of {n} segments has {} parameters", knots.len()));
    }
    let mut pieces = Vec::new();
    for w in knots.windows(2) {
        if w[0] >= w[1] {
            return fault("the parameters of the segments of a curve do not increase");
        }
        let segment = nested(records::object(c)?, scale, depth + 1)?;
        pieces.extend(segment.over([w[0], w[1]]).pieces);
    }
    Ok(FileCurve { pieces })
}
