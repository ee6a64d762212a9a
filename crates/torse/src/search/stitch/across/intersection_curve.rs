//! The curve in which two torses intersect beside an edge of the model, and the points that several torses have in common.
//!
//! *Method*: Newton steps from the edge to the tangent planes at the feet of both torses (\[SE06\] carried on), in planes
//! square to the edge. Where tangent planes nearly agree the steps are damped. Nothing is judged here.

use crate::geom::Vec3;
use crate::search::stitch::strip_pair::{CURVE, EDGE};
use crate::spline::curve::Curve;
use crate::spline::lsq;
use crate::torse::form::Torse;
use nalgebra::Matrix3;

/// Steps of a point towards the planes, at most.
const STEPS: usize = 30;
/// Damping of the steps against unit normals: directions in which planes change by less are left as they are.
const DAMPING: f64 = 1e-4;
/// Steps end below this share of the coordinates: rounding of the feet.
const SETTLED: f64 = 1e-15;
/// Distance from a torse that is left, as a share of the length, at most: below what edges may stray.
const ON_TORSE: f64 = 1e-9;
/// Where torses hardly cross: what a way counts against a distance, as for seams inside faces, and what is left then.
pub(super) const HARDLY: (f64, f64) = (1e-3, 5e-7);
/// Share of its domain by which a torse may be continued: panels end a tolerance or two beyond their faces.
const BEYOND: f64 = 0.1;
/// Places on an edge of a border, and on the whole border, at least.
const PLACES: (usize, usize) = (6, 600);
/// Ends of a curve are led to their vertices over this multiple of the way that they are off along it.
const FADE: f64 = 8.0;

/// A torse with the parameter of the ruling where it was last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near<'a> {
    pub torse: &'a Torse,
    pub t: f64,
}

impl Near<'_> {
    /// Unit normal of the tangent plane at the foot of a point, and the distance from it.
    pub fn plane(&mut self, x: &Vec3) -> Option<(Vec3, f64)> {
        self.t = self.torse.foot_within(x, self.t, BEYOND)?;
        let r = self.torse.ruling(self.t);
        Some((r.normal, r.normal.dot(&(x - r.point))))
    }

    /// Height (mm) of the torse over a point, about, along a normal of the face.
    pub fn height(&mut self, x: &Vec3, normal: &Vec3) -> Option<f64> {
        let (n, off) = self.plane(x)?;
        let along = n.dot(normal);
        Some(-off * along.signum()).filter(|h| h.is_finite())
    }
}

/// The point that all torses have in common near `x`, within the plane through `x` square to `across` if there is one, and
/// the largest distance (mm) left from a torse; ways count `sideways` of distances from torses. The torses remember their rulings.
pub(super) fn common_point(torses: &mut [Near], x: &Vec3, across: Option<&Vec3>, sideways: f64) -> Option<(Vec3, f64)> {
    let (start, mut x) = (*x, *x);
    let mut left = f64::INFINITY;
    for _ in 0..STEPS {
        let mut matrix = Matrix3::identity() * (DAMPING * DAMPING);
        let mut right = Vec3::zeros();
        let mut add = |n: &Vec3, off: f64| {
            matrix += n * n.transpose();
            right -= n * off;
        };
        left = 0.0;
        for torse in torses.iter_mut() {
            let (n, off) = torse.plane(&x)?;
            left = f64::max(left, off.abs());
            add(&n, off);
        }
        if let Some(n) = across {
            add(n, n.dot(&(x - start)));
        }
        matrix += Matrix3::identity() * (sideways * sideways);
        right -= (x - start) * (sideways * sideways);
        let step = matrix.cholesky()?.solve(&right);
        if !step.iter().all(|s| s.is_finite()) {
            return None;
        }
        x += step;
        if step.norm() <= SETTLED * (1.0 + x.amax()) {
            break;
        }
    }
    Some((x, left))
}

/// The edge of the model over a border, and how far from it panels may end.
pub(super) struct Model<'a> {
    /// Places along the edge, those of its vertices at every `parts`-th.
    pub points: &'a [Vec3],
    /// See [`Model::points`].
    pub parts: usize,
    /// Where the curve begins and ends.
    pub ends: [Vec3; 2],
    /// Largest distance (mm) of the curve from the edge.
    pub reach: f64,
}

/// Parts into which each of `edges` edges of a border is cut.
pub(super) fn parts(edges: usize) -> usize {
    PLACES.0.max(PLACES.1.div_ceil(edges))
}

/// A curve over [0, 1] with the parameters of the vertices of a border.
#[derive(Clone, Debug)]
pub(super) struct IntersectionCurve {
    pub curve: Curve<3>,
    /// Parameters of all places.
    pub at: Vec<f64>,
    /// The range of rulings of either torse that the curve uses.
    pub rulings: [[f64; 2]; 2],
}

/// The curve in which two torses intersect beside an edge, or which is near both all along where they hardly cross. `None` where
/// there is none near enough.
pub(super) fn intersection_curve(torses: [Near; 2], beside: &Model) -> Option<IntersectionCurve> {
    intersection_curve_within(torses, beside, (0.0, ON_TORSE))
        .or_else(|| intersection_curve_within(torses, beside, HARDLY))
}

/// See [`intersection_curve`]; with what ways count against distances, and what is left as a share of the length at most.
fn intersection_curve_within(
    mut torses: [Near; 2],
    beside: &Model,
    (sideways, allowed): (f64, f64),
) -> Option<IntersectionCurve> {
    let points = beside.points;
    let last = points.len() - 1;
    let tangent = |i: usize| {
        let (a, b) = (i.saturating_sub(beside.parts), (i + beside.parts).min(last));
        (points[b] - points[a]).try_normalize(0.0)
    };
    let mut along = vec![0.0];
    for w in points.windows(2) {
        along.push(along[along.len() - 1] + (w[1] - w[0]).norm());
    }
    let length = along[last];
    // Near its ends the curve makes way to where it is to begin and end.
    let offs = [(0, beside.ends[0]), (last, beside.ends[1])];
    let offs = offs.map(|(i, x)| tangent(i).map(|t| t.dot(&(x - points[i]))));
    let [first, second] = [offs[0]?, offs[1]?];
    let fade = |off: f64, way: f64| {
        let width = (FADE * off.abs()).min(length);
        if width > 0.0 {
            off * (1.0 - way / width).max(0.0)
        } else {
            0.0
        }
    };
    let mut rulings = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let mut places: Vec<[f64; 3]> = Vec::with_capacity(points.len());
    for (i, p) in points.iter().enumerate() {
        let n = tangent(i)?;
        let x = p + n * (fade(first, along[i]) + fade(second, length - along[i]));
        let (y, left) = common_point(&mut torses, &x, Some(&n), sideways)?;
        if left > allowed * length || (y - x).norm() > beside.reach {
            return None;
        }
        for (range, near) in rulings.iter_mut().zip(&torses) {
            *range = [range[0].min(near.t), range[1].max(near.t)];
        }
        let y = match i {
            0 => beside.ends[0],
            i if i == last => beside.ends[1],
            _ => y,
        };
        places.push(y.into());
    }
    let (curve, at) = fitted(&places)?;
    Some(IntersectionCurve { curve, at, rulings })
}

/// A curve over [0, 1] through the ends of places and near all of them, and the parameter of each; `None` where it strays.
pub(super) fn fitted(places: &[[f64; 3]]) -> Option<(Curve<3>, Vec<f64>)> {
    let length: f64 = places.windows(2).map(|w| (Vec3::from(w[1]) - Vec3::from(w[0])).norm()).sum();
    let at = lsq::chord_parameters(places);
    if at.windows(2).any(|w| w[0] >= w[1]) {
        return None;
    }
    let fit = lsq::fit_within(places, &at, CURVE.0, EDGE.0 * length, CURVE.1).ok()?;
    (fit.error <= EDGE.1 * length).then_some((fit.curve, at))
}

/// A seam inside a face that ends, or begins, in another point of its curve continued: the curve anew, and the parameters of
/// its vertices. `None` where the point is not on it.
pub(super) fn ended_anew(
    edge: &Curve<3>,
    parameters: &[f64],
    ends: [Option<Vec3>; 2],
    torses: [Near; 2],
) -> Option<(Curve<3>, Vec<f64>)> {
    let old = [0.0, 1.0];
    let mut shift = [0.0; 2];
    let wide = edge.extended(-BEYOND, 1.0 + BEYOND).ok()?;
    for k in 0..2 {
        if let Some(x) = &ends[k] {
            shift[k] = foot_on(&wide, x, old[k])? - old[k];
        }
    }
    if shift.iter().any(|s| s.abs() >= BEYOND) {
        return None;
    }
    let fade = |off: f64, way: f64| {
        let width = (FADE * off.abs()).min(1.0);
        if width > 0.0 {
            off * (1.0 - way / width).max(0.0)
        } else {
            0.0
        }
    };
    let moved = |s: f64| s + fade(shift[0], s) + fade(shift[1], 1.0 - s);
    let count = PLACES.1;
    let mut near = torses;
    let mut places: Vec<[f64; 3]> = Vec::with_capacity(count + 1);
    for i in 0..=count {
        let s = moved(i as f64 / count as f64);
        let x = Vec3::from(wide.point(s));
        let x = if (0.0..=1.0).contains(&s) { x } else { common_point(&mut near, &x, None, 0.0)?.0 };
        places.push(x.into());
    }
    for (slot, end) in [(0, ends[0]), (count, ends[1])] {
        places[slot] = end.map_or(edge.control[if slot == 0 { 0 } else { edge.control.len() - 1 }], Into::into);
    }
    let (curve, at) = fitted(&places)?;
    let new = |s: &f64| {
        let i = (s * count as f64).floor().clamp(0.0, (count - 1) as f64);
        let share = s * count as f64 - i;
        let i = i as usize;
        at[i] + (at[i + 1] - at[i]) * share
    };
    let mut parameters: Vec<f64> = parameters.iter().map(new).collect();
    let n = parameters.len();
    (parameters[0], parameters[n - 1]) = (0.0, 1.0);
    parameters.windows(2).all(|w| w[0] < w[1]).then_some((curve, parameters))
}

/// Parameter of the place on a curve nearest to a point, by Newton steps from a guess.
fn foot_on(curve: &Curve<3>, x: &Vec3, guess: f64) -> Option<f64> {
    let (a, b) = curve.domain();
    let mut s = guess;
    for _ in 0..STEPS {
        let j = curve.jet(s).map(Vec3::from);
        let step = (x - j[0]).dot(&j[1]) / j[1].norm_squared();
        if !step.is_finite() {
            return None;
        }
        s = (s + step).clamp(a, b);
        if step.abs() <= SETTLED {
            break;
        }
    }
    Some(s)
}
