//! Curves: lines, arcs, conics, polylines, parametric and rational splines, and chains of these.

use super::placing;
use super::records::DEEPEST;
use super::records::{Entry, Fault, Records};
use crate::brep::conic;
use crate::brep::ruled::spline_of;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::geom::{Frame, Vec3};
use crate::num::binomial::binomial;
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use std::f64::consts::TAU;

/// Reads geometry in the numbers of the file; units come with the placement of faces.
#[derive(Clone, Copy)]
pub(super) struct Geometry<'r> {
    /// The file.
    pub records: &'r Records,
}

/// Pieces of a curve in the direction of travel, each with the number of its entity.
pub(super) type Path = Vec<(u64, Arc)>;

/// Coordinates above this are damage, and their products would overflow.
const FARTHEST: f64 = 1e12;
/// Knots of a spline of which those in excess are looked for.
const MOST_KNOTS: usize = 20_000;
/// Pieces of one chain at most.
const MOST_PIECES: usize = 100_000;
/// Ranges that leave a spline's domain by less than this share end with it.
const ON_END: f64 = 1e-9;
/// A segment is turned round where that brings it nearer by this factor to the one before.
const CLEARLY: f64 = 1e-2;

/// Types of curves.
pub(super) fn is_curve(kind: u32) -> bool {
    matches!(kind, 100 | 102 | 104 | 106 | 110 | 112 | 126 | 130)
}

impl Geometry<'_> {
    /// The entity with a number.
    pub fn get(&self, id: u64) -> Result<&Entry, Fault> {
        self.records.get(id)
    }

    /// A curve with the transformation of its own.
    pub fn path(&self, id: u64, depth: u32) -> Result<Path, Fault> {
        let e = self.get(id)?;
        if depth > DEEPEST {
            return Err(Fault::new(id, format!("D{id} is defined in a circle or too deeply")));
        }
        let one = |arc: Result<Arc, Fault>| arc.map(|a| vec![(id, a)]);
        let local = match e.kind {
            100 => one(circle(e)),
            102 => self.chain(e, depth),
            104 => one(conic_arc(e)),
            106 => one(polyline(e)),
            110 => one(line(e)),
            112 => one(parametric(e)),
            126 => one(rational(e)),
            141 | 142 => Err(Fault::new(id, format!("the boundary D{id} is used as a curve, which is not read"))),
            130 => Err(Fault::new(id, format!("the offset curve D{id} (type 130) is not read"))),
            other => Err(Fault::new(id, format!("D{id} is of type {other}, not a curve that is read"))),
        }?;
        if local.iter().any(|(_, a)| !sane(a)) {
            return Err(Fault::new(id, format!("the curve D{id} has coordinates that are absurd")));
        }
        placing::path(local, &placing::of_entry(self.records, e)?)
    }

    /// The pieces of a composite curve.
    fn chain(&self, e: &Entry, depth: u32) -> Result<Path, Fault> {
        let n = e.count(1)?;
        let mut out = Vec::new();
        for p in e.pointers(2, n)? {
            // Points may stand between the curves.
            if matches!(self.records.kind(p), 116 | 132) {
                continue;
            }
            out.extend(self.path(p, depth + 1)?);
            if out.len() > MOST_PIECES {
                return Err(Fault::new(e.number, format!("the chain D{} has too many pieces", e.number)));
            }
        }
        if out.is_empty() {
            return Err(Fault::new(e.number, format!("the chain D{} has no pieces", e.number)));
        }
        Ok(following(out))
    }

    /// A curve that a surface is made from, as one curve: chains become one spline.
    pub fn single(&self, id: u64, depth: u32) -> Result<Arc, Fault> {
        let mut path = self.path(id, depth + 1)?;
        if path.len() == 1 {
            return Ok(path.swap_remove(0).1);
        }
        let arcs: Vec<Arc> = path.into_iter().map(|p| p.1).collect();
        let curve = joined(&arcs).map_err(|e| Fault::new(id, format!("the chain D{id}: {e}")))?;
        let (from, to) = curve.domain();
        Ok(Arc { curve: SpaceCurve::Spline(curve), from, to })
    }

    /// A point (116), with its transformation.
    pub fn point(&self, id: u64) -> Result<Vec3, Fault> {
        let e = self.get(id)?;
        if e.kind != 116 {
            return Err(Fault::new(id, format!("D{id} is of type {}, not a point", e.kind)));
        }
        Ok(placing::of_entry(self.records, e)?.point(&vec3(e, 1)?))
    }

    /// A direction (123), with its transformation; unit length.
    pub fn direction(&self, id: u64) -> Result<Vec3, Fault> {
        let e = self.get(id)?;
        if e.kind != 123 {
            return Err(Fault::new(id, format!("D{id} is of type {}, not a direction", e.kind)));
        }
        let d = placing::of_entry(self.records, e)?.linear * vec3(e, 1)?;
        d.try_normalize(0.0).ok_or_else(|| Fault::new(id, format!("the direction D{id} has no length")))
    }
}

/// Three coordinates from field `k` on.
pub(super) fn vec3(e: &Entry, k: usize) -> Result<Vec3, Fault> {
    Ok(Vec3::new(e.number(k)?, e.number(k + 1)?, e.number(k + 2)?))
}

/// Whether a piece has finite ends and is no farther away than anything real.
fn sane(a: &Arc) -> bool {
    let (p, q) = a.ends();
    let control = match &a.curve {
        SpaceCurve::Spline(c) => c.control.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs())),
        SpaceCurve::Ellipse { a, b, .. } | SpaceCurve::Hyperbola { a, b, .. } => a.max(*b),
        SpaceCurve::Parabola { focal, .. } => *focal,
        SpaceCurve::Line { .. } | SpaceCurve::Traced(_) => 0.0,
    };
    a.from.is_finite() && a.to.is_finite() && p.amax() <= FARTHEST && q.amax() <= FARTHEST && control <= FARTHEST
}

/// Circular arc: counter-clockwise in a plane z = const.
fn circle(e: &Entry) -> Result<Arc, Fault> {
    let x = e.numbers(1, 7)?;
    let origin = Vec3::new(x[1], x[2], x[0]);
    let radius = (x[3] - x[1]).hypot(x[4] - x[2]);
    if radius <= 0.0 || radius > FARTHEST {
        return Err(Fault::new(e.number, format!("the arc D{} has the radius {radius}", e.number)));
    }
    let from = (x[4] - x[2]).atan2(x[3] - x[1]);
    let way = ((x[6] - x[2]).atan2(x[5] - x[1]) - from).rem_euclid(TAU);
    let way = if way < conic::WHOLE_TURN || TAU - way < conic::WHOLE_TURN { TAU } else { way };
    let frame = Frame { origin, ..Frame::world() };
    Ok(Arc { curve: SpaceCurve::Ellipse { frame, a: radius, b: radius }, from, to: from + way })
}

fn conic_arc(e: &Entry) -> Result<Arc, Fault> {
    let x = e.numbers(1, 11)?;
    conic::arc(&x[..6], x[6], [x[7], x[8]], [x[9], x[10]])
        .ok_or_else(|| Fault::new(e.number, format!("the equation of D{} is that of no conic", e.number)))
}

fn line(e: &Entry) -> Result<Arc, Fault> {
    let (p, q) = (vec3(e, 1)?, vec3(e, 4)?);
    if e.form != 0 {
        return Err(Fault::new(e.number, format!("D{} is an endless line", e.number)));
    }
    if (q - p).norm() <= 0.0 {
        return Err(Fault::new(e.number, format!("the line D{} has no length", e.number)));
    }
    Ok(Arc { curve: SpaceCurve::Line { origin: p, direction: q - p }, from: 0.0, to: 1.0 })
}

/// Copious data as a chain of straight pieces, parametrised by the numbers of its corners.
fn polyline(e: &Entry) -> Result<Arc, Fault> {
    if !matches!(e.form, 1..=3 | 11..=13 | 63) {
        return Err(Fault::new(e.number, format!("copious data of form {} (D{}) are no curve", e.form, e.number)));
    }
    let (flag, n) = (e.integer(1)?, e.count(2)?);
    let (start, width) = match flag {
        1 => (4, 2),
        2 => (3, 3),
        3 => (3, 6),
        _ => return Err(Fault::new(e.number, format!("D{} has the interpretation flag {flag}", e.number))),
    };
    let z = if flag == 1 { e.number(3)? } else { 0.0 };
    let x = e.numbers(start, n.saturating_mul(width))?;
    let mut points: Vec<Vec3> =
        x.chunks_exact(width).map(|c| Vec3::new(c[0], c[1], if flag == 1 { z } else { c[2] })).collect();
    if e.form == 63 && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    points.dedup();
    let n = points.len();
    if n < 2 {
        return Err(Fault::new(e.number, format!("the polyline D{} has fewer than two different points", e.number)));
    }
    let mut knots = vec![0.0];
    knots.extend((0..n).map(|i| i as f64));
    knots.push((n - 1) as f64);
    let control = points.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect();
    whole(Curve::new(1, knots, control)).map_err(|w| Fault::new(e.number, w.to_string()))
}

fn whole(c: Result<Curve<4>, SplineError>) -> Result<Arc, SplineError> {
    c.map(|c| {
        let (from, to) = c.domain();
        Arc { curve: SpaceCurve::Spline(c), from, to }
    })
}

/// Parametric spline: cubic polynomials in powers of the parameter from each break on.
fn parametric(e: &Entry) -> Result<Arc, Fault> {
    let n = e.count(4)?;
    let breaks = e.numbers(5, n + 1)?;
    let coefficients = e.numbers(6 + n, n.saturating_mul(12))?;
    let degree = power_degree(coefficients.chunks_exact(4));
    let mut control: Vec<[f64; 4]> = Vec::with_capacity(n * degree + 1);
    let mut knots = vec![breaks[0]; degree + 1];
    for (i, c) in coefficients.chunks_exact(12).enumerate() {
        let h = breaks[i + 1] - breaks[i];
        let axes = [0, 1, 2].map(|d| bernstein(&c[4 * d..4 * d + 4], h, degree));
        // The last point of a piece is the first of the next.
        control.truncate(i * degree);
        control.extend((0..=degree).map(|k| [axes[0][k], axes[1][k], axes[2][k], 1.0]));
        knots.extend(std::iter::repeat_n(breaks[i + 1], degree));
    }
    knots.push(breaks[n]);
    whole(Curve::new(degree, knots, control))
        .map_err(|w| Fault::new(e.number, format!("parametric spline D{}: {w}", e.number)))
}

/// The highest power, at least 1, of which any of the coefficient lists has a share.
pub(super) fn power_degree<'a>(lists: impl Iterator<Item = &'a [f64]>) -> usize {
    lists.map(|c| c.iter().rposition(|x| *x != 0.0).unwrap_or(0)).fold(1, usize::max)
}

/// Bernstein coefficients on `[0, h]` of a polynomial given by its powers.
pub(super) fn bernstein(powers: &[f64], h: f64, degree: usize) -> Vec<f64> {
    let term = |k: usize, j: usize| powers[j] * h.powi(j as i32) * binomial(k, j) / binomial(degree, j);
    (0..=degree).map(|k| (0..=k).map(|j| term(k, j)).sum()).collect()
}

/// Rational B-spline curve.
fn rational(e: &Entry) -> Result<Arc, Fault> {
    let (k, degree) = (e.count(1)?, e.count(2)?);
    let knots = e.numbers(7, k + degree + 2)?;
    let weights = e.numbers(9 + k + degree, k + 1)?;
    let points = e.numbers(10 + 2 * k + degree, 3 * (k + 1))?;
    let after = 13 + 5 * k + degree;
    let weights = evened(weights);
    let mut control = Vec::with_capacity(k + 1);
    for (i, (p, w)) in points.chunks_exact(3).zip(&weights).enumerate() {
        if *w <= 0.0 {
            let what = format!("weight {} of the curve D{} is {w}; it must be positive", i + 1, e.number);
            return Err(Fault::new(e.number, what));
        }
        control.push([w * p[0], w * p[1], w * p[2], *w]);
    }
    let (knots, control) = without_excess(degree, knots, control, 1);
    let curve = Curve::new(degree, knots, control)
        .map_err(|w| Fault::new(e.number, format!("B-spline curve D{}: {w}", e.number)))?;
    let (a, b) = curve.domain();
    let stated = (e.number(after)?, e.number(after + 1)?);
    let (from, to) = range(stated, (a, b));
    Ok(Arc { curve: SpaceCurve::Spline(curve), from, to })
}

/// Weights divided by their common value, if they have one.
pub(super) fn evened(weights: Vec<f64>) -> Vec<f64> {
    match weights.first() {
        Some(&w) if w > 0.0 && weights.iter().all(|x| *x == w) => vec![1.0; weights.len()],
        _ => weights,
    }
}

/// The stated range of a parameter, inside the domain; all of it where none is stated.
pub(super) fn range(stated: (f64, f64), domain: (f64, f64)) -> (f64, f64) {
    let (a, b) = domain;
    let hair = ON_END * (b - a);
    let on = |t: f64| {
        if t <= a + hair {
            a
        } else if t >= b - hair {
            b
        } else {
            t
        }
    };
    let (from, to) = (on(stated.0), on(stated.1));
    if from < to {
        (from, to)
    } else {
        domain
    }
}

/// Knots inside the domain that occur more often than the degree, with control points (`width` of them for each knot)
/// that stand on each other: one of each is enough.
pub(super) fn without_excess(
    degree: usize,
    mut knots: Vec<f64>,
    mut control: Vec<[f64; 4]>,
    width: usize,
) -> (Vec<f64>, Vec<[f64; 4]>) {
    let size = control.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut i = 1;
    let few = knots.len() < MOST_KNOTS;
    while few && degree > 0 && i + degree + 1 < knots.len() {
        let excess = knots[i] == knots[i + degree];
        let row = |k: usize| control.get(k * width..(k + 1) * width);
        // The span of equal knots ends one piece at control point i − 1 and begins the next at i.
        let same = match (row(i - 1), row(i)) {
            (Some(p), Some(q)) => p.iter().zip(q).all(|(p, q)| (0..4).all(|d| (p[d] - q[d]).abs() <= ON_END * size)),
            _ => false,
        };
        if excess && same && control.len() > (degree + 1) * width {
            knots.remove(i);
            control.drain(i * width..(i + 1) * width);
        } else {
            i += 1;
        }
    }
    (knots, control)
}

/// Segments that begin nearer to where the one before ends than this share of their extent do follow it.
const TOUCHES: f64 = 1e-6;

/// Segments that follow each other: one that ends where it should begin is turned round.
fn following(mut path: Path) -> Path {
    let turn = |p: &mut (u64, Arc)| p.1 = p.1.reversed();
    for i in 1..path.len() {
        let (start, end) = path[i].1.ends();
        let last = path[i - 1].1.ends().1;
        let (there, back) = ((start - last).norm(), (end - last).norm());
        let middle = path[i].1.curve.point(0.5 * (path[i].1.from + path[i].1.to));
        if there <= TOUCHES * (middle - start).norm() {
            // A closed piece begins and ends there: which way it runs is for the file to say.
            continue;
        }
        if i == 1 {
            // The first has nothing before it: it is turned if that alone makes the second fit.
            let first = path[0].1.ends().0;
            if (start - first).norm().min((end - first).norm()) < CLEARLY * there.min(back) {
                turn(&mut path[0]);
                if (end - first).norm() < CLEARLY * (start - first).norm() {
                    turn(&mut path[1]);
                }
                continue;
            }
        }
        if back < CLEARLY * there {
            turn(&mut path[i]);
        }
    }
    path
}

/// Pieces that follow each other as one spline, each with its own length of parameters.
fn joined(path: &[Arc]) -> Result<Curve<4>, SplineError> {
    let splines = path.iter().map(spline_of).collect::<Result<Vec<_>, _>>()?;
    let degree = splines.iter().map(|c| c.knots.degree()).fold(1, usize::max);
    let mut knots: Vec<f64> = Vec::new();
    let mut control: Vec<[f64; 4]> = Vec::new();
    for c in splines {
        let c = c.elevated_to(degree)?;
        let (a, b) = c.domain();
        let start = knots.last().copied().unwrap_or(a);
        let shifted = |t: &f64| start + (t - a);
        if control.is_empty() {
            knots = vec![start; degree + 1];
        }
        let inner = &c.knots.values()[degree + 1..c.knots.control_count()];
        knots.extend(inner.iter().map(shifted));
        knots.extend(std::iter::repeat_n(shifted(&b), degree));
        // Pieces may have any common factor in their weights.
        let factor = control.last().map_or(1.0, |l| l[3] / c.control[0][3]);
        let scaled = c.control.iter().map(|h| h.map(|x| x * factor));
        control.extend(scaled.skip(usize::from(!control.is_empty())));
    }
    knots.extend(knots.last().copied());
    Curve::new(degree, knots, control)
}
