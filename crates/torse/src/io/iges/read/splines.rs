//! Spline surfaces: rational (128) and parametric (114).

use super::curves::{bernstein, evened, power_degree, range, without_excess};
use super::patch::Patch;
use super::records::{Entry, Fault};
use crate::brep::raw::{SurfaceDeviation, SurfaceKind};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::geom::{BBox, Vec3};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Control points farther away than this are damage.
const FARTHEST: f64 = 1e12;

fn patch(surface: Surface, deviation: SurfaceDeviation) -> Patch {
    let support = SupportSurface::Spline(SplineSupport::new(surface));
    Patch { deviation, ..Patch::exact(support, SurfaceKind::Spline) }
}

/// Rational B-spline surface; one that does not state the range of its parameters has all of it.
pub(super) fn rational(e: &Entry) -> Result<Patch, Fault> {
    let [k1, k2, m1, m2] = [e.count(1)?, e.count(2)?, e.count(3)?, e.count(4)?];
    let (nu, nv) = (k1 + 1, k2 + 1);
    let count = nu.saturating_mul(nv);
    let (first, second) = (k1 + m1 + 2, k2 + m2 + 2);
    let knots_u = e.numbers(10, first)?;
    let knots_v = e.numbers(10 + first, second)?;
    let weights = evened(e.numbers(10 + first + second, count)?);
    let after = 10 + first + second + count;
    let points = e.numbers(after, count.saturating_mul(3))?;
    let after = after + 3 * count;
    let stated = [e.number(after)?, e.number(after + 1)?, e.number(after + 2)?, e.number(after + 3)?];
    // The file runs along the first parameter, we along the second.
    let mut control = Vec::with_capacity(count);
    for i in 0..nu {
        for k in (0..nv).map(|j| j * nu + i) {
            let (p, w) = (&points[3 * k..3 * k + 3], weights[k]);
            if w <= 0.0 {
                let what = format!("weight {} of the surface D{} is {w}; it must be positive", k + 1, e.number);
                return Err(Fault::new(e.number, what));
            }
            control.push([w * p[0], w * p[1], w * p[2], w]);
        }
    }
    let surface = built([m1, m2], [knots_u, knots_v], control)
        .and_then(|s| cut(s, stated))
        .map_err(|why| Fault::new(e.number, format!("B-spline surface D{}: {why}", e.number)))?;
    let far = surface.control.iter().flatten().any(|x| x.abs() > FARTHEST);
    if far {
        return Err(Fault::new(e.number, format!("the surface D{} has coordinates that are absurd", e.number)));
    }
    Ok(patch(surface, SurfaceDeviation::NONE))
}

/// A surface from homogeneous control points, rows along v; knots that occur too often are thinned where they can be.
fn built(degree: [usize; 2], [u, v]: [Vec<f64>; 2], control: Vec<[f64; 4]>) -> Result<Surface, SplineError> {
    let nv = v.len().saturating_sub(degree[1] + 1);
    let (u, control) = without_excess(degree[0], u, control, nv.max(1));
    let nu = u.len().saturating_sub(degree[0] + 1);
    let turned: Vec<[f64; 4]> = (0..nv).flat_map(|j| (0..nu).map(move |i| i * nv + j)).map(|k| control[k]).collect();
    let (v, turned) = without_excess(degree[1], v, turned, nu.max(1));
    let nv = v.len().saturating_sub(degree[1] + 1);
    let control: Vec<[f64; 4]> = (0..nu).flat_map(|i| (0..nv).map(move |j| j * nu + i)).map(|k| turned[k]).collect();
    let (knots_u, knots_v) = (Knots::new(degree[0], u, nu)?, Knots::new(degree[1], v, nv)?);
    if let Some(index) = control.iter().position(|c| c.iter().any(|x| !x.is_finite())) {
        return Err(SplineError::Control { index, reason: "not finite".into() });
    }
    let rational = control.iter().any(|c| c[3] != 1.0);
    Ok(Surface { knots_u, knots_v, control, rational })
}

/// The part of a surface over the stated ranges of its parameters.
fn cut(s: Surface, stated: [f64; 4]) -> Result<Surface, SplineError> {
    let (du, dv) = s.domain();
    let (u, v) = (range((stated[0], stated[1]), du), range((stated[2], stated[3]), dv));
    if (u, v) == (du, dv) {
        return Ok(s);
    }
    s.restricted(u, v)
}

/// Coefficients of one patch of a parametric spline surface: 16 for each coordinate.
const PATCH: usize = 48;

/// Parametric spline surface: bicubic polynomials in powers of the parameters from each corner on. Files hold a row and
/// a column of patches more than there are, with any content, or leave them out.
pub(super) fn parametric(e: &Entry) -> Result<Patch, Fault> {
    let (m, n) = (e.count(3)?, e.count(4)?);
    if m == 0 || n == 0 {
        return Err(Fault::new(e.number, format!("the surface D{} has no patches", e.number)));
    }
    let (tu, tv) = (e.numbers(5, m + 1)?, e.numbers(6 + m, n + 1)?);
    let start = 7 + m + n;
    let there = e.fields.len().saturating_sub(start);
    let padded = there >= PATCH.saturating_mul(m * (n + 1) + n);
    let row = if padded { n + 1 } else { n };
    let count = ((m - 1).saturating_mul(row)).saturating_add(n).saturating_mul(PATCH);
    let all = e.numbers(start, count)?;
    let patch_at = |i: usize, j: usize| &all[(i * row + j) * PATCH..(i * row + j + 1) * PATCH];
    let patches: Vec<&[f64]> = (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| patch_at(i, j)).collect();
    // Powers of the first parameter run first; degrees are the highest that occur.
    let p = power_degree(patches.iter().flat_map(|c| c.chunks_exact(4)));
    let rows: Vec<Vec<f64>> = patches
        .iter()
        .flat_map(|c| c.chunks_exact(16))
        .map(|c| c.chunks_exact(4).map(|r| r.iter().fold(0.0, |s: f64, x| s.max(x.abs()))).collect())
        .collect();
    let q = power_degree(rows.iter().map(Vec::as_slice));
    let (nu, nv) = (m * p + 1, n * q + 1);
    let mut points: Vec<Option<Vec3>> = vec![None; nu * nv];
    let mut gap = 0.0_f64;
    for i in 0..m {
        for j in 0..n {
            let net = bezier_net(patches[i * n + j], [tu[i + 1] - tu[i], tv[j + 1] - tv[j]], [p, q]);
            for (k, x) in net.into_iter().enumerate() {
                let slot = &mut points[(i * p + k / (q + 1)) * nv + j * q + k % (q + 1)];
                // Patches share their sides; where they differ, the first is kept.
                gap = slot.map_or(gap, |old| gap.max((old - x).norm()));
                slot.get_or_insert(x);
            }
        }
    }
    let points: Vec<Vec3> = points.into_iter().flatten().collect();
    let far = points.iter().any(|x| x.amax() > FARTHEST || x.iter().any(|c| c.is_nan()));
    if far {
        return Err(Fault::new(e.number, format!("the surface D{} has coordinates that are absurd", e.number)));
    }
    let size = BBox::of(&points).diagonal();
    if gap > TORN * size {
        let what = format!("the patches of the surface D{} lie {gap:.3e} apart", e.number);
        return Err(Fault::new(e.number, what));
    }
    let u = Smoothed::of(points, nv, &tu, p, SMOOTH * size);
    let v = Smoothed::of(turned(&u.points, nv), u.points.len() / nv, &tv, q, SMOOTH * size);
    let points = turned(&v.points, u.points.len() / nv);
    let surface = Knots::new(p, u.knots, u.points.len() / nv)
        .and_then(|ku| Ok((ku, Knots::new(q, v.knots, v.points.len() / (u.points.len() / nv))?)))
        .and_then(|(ku, kv)| Surface::new(ku, kv, &points, None))
        .map_err(|why| Fault::new(e.number, format!("parametric spline surface D{}: {why}", e.number)))?;
    // A point of the surface is a mean of control points: it moves no more than they did.
    let deviation = gap + u.moved + v.moved;
    Ok(patch(surface, SurfaceDeviation::proven(if deviation > ROUNDED * size { deviation } else { 0.0 })))
}

/// A net of points with its rows and columns exchanged; rows have `row` points.
fn turned(points: &[Vec3], row: usize) -> Vec<Vec3> {
    (0..row).flat_map(|j| points.iter().skip(j).step_by(row).copied()).collect()
}

/// Rows of Bézier points with breaks at which the derivative does not jump made smooth.
struct Smoothed {
    points: Vec<Vec3>,
    knots: Vec<f64>,
    /// How far a point was moved at most.
    moved: f64,
}

impl Smoothed {
    /// Rows of `width` points, `degree` of them for each span. Where the row at a break is, within `limit`, what those
    /// beside it make of it for a continuous derivative, it is left out and the knot once less: a cubic spline is then
    /// no chain of pieces with creases between.
    fn of(points: Vec<Vec3>, width: usize, breaks: &[f64], degree: usize, limit: f64) -> Self {
        let mut out = Self { points: Vec::with_capacity(points.len()), knots: vec![breaks[0]; degree + 1], moved: 0.0 };
        let row = |k: usize| &points[k * width..(k + 1) * width];
        out.points.extend_from_slice(row(0));
        for i in 1..breaks.len() {
            let last = i * degree;
            (last + 1 - degree..last).for_each(|k| out.points.extend_from_slice(row(k)));
            let mut times = degree;
            if i + 1 < breaks.len() && degree > 1 {
                let (before, after) = (breaks[i] - breaks[i - 1], breaks[i + 1] - breaks[i]);
                let smooth = |k: usize| (row(last - 1)[k] * after + row(last + 1)[k] * before) / (before + after);
                let off = (0..width).map(|k| (smooth(k) - row(last)[k]).norm()).fold(0.0, f64::max);
                if off <= limit {
                    times -= 1;
                    out.moved = out.moved.max(off);
                }
            }
            if times == degree {
                out.points.extend_from_slice(row(last));
            }
            out.knots.extend(std::iter::repeat_n(breaks[i], times));
        }
        out.knots.extend(breaks.last());
        out
    }
}

/// Patches farther apart than this share of the surface are torn.
const TORN: f64 = 1e-3;
/// Sides that differ by less than this share are equal up to rounding.
const ROUNDED: f64 = 1e-12;

/// Derivatives are continuous where that takes no point farther than this share of the surface, which is what
/// coefficients of six digits lose and what chords of a trim may keep from its curves.
const SMOOTH: f64 = 1e-5;

/// Control points of a patch of size `h`, the second parameter running first.
fn bezier_net(coefficients: &[f64], h: [f64; 2], [p, q]: [usize; 2]) -> Vec<Vec3> {
    let mut out = vec![Vec3::zeros(); (p + 1) * (q + 1)];
    for (d, axis) in coefficients.chunks_exact(16).enumerate() {
        // Powers of the second parameter with Bernstein coefficients in the first.
        let lines: Vec<Vec<f64>> = (0..=q).map(|k| bernstein(&axis[4 * k..4 * k + 4], h[0], p)).collect();
        for i in 0..=p {
            let powers: Vec<f64> = lines.iter().map(|l| l[i]).collect();
            for (j, x) in bernstein(&powers, h[1], q).into_iter().enumerate() {
                out[i * (q + 1) + j][d] = x;
            }
        }
    }
    out
}
