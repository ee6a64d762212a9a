//! Nets from and to the other forms of developables: tangent surfaces of a given curve, cones, cylinders; the dual
//! form, exactly; the primal form, with its error.
//!
//! *Method.* The regression curve of a net is a spline `r` of degree `n + 1` over the same knots, and its boundaries
//! are the polar curves `r[uⁿ, M*]` and `r[uⁿ, Λ*]` \[FJ07, theorem 1 read backwards\]. Tangent planes \[PW99\] are
//! products of splines. The primal form is a cubic fit to profile and slopes, see docs/algorithms/torses.md.

use super::control_net::{affine, Net, NetError};
use super::planes::tangent_planes;
use super::shape::Shape;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::torse::form::{DualTorse, PrimalTorse, Torse};

/// Another form of the surface of a net.
#[derive(Clone, Debug, PartialEq)]
pub struct Converted {
    /// The torse. Its parameter is that of the net for the dual form, the abscissa of the profile for the primal one.
    pub torse: Torse,
    /// Largest distance found of points of the net's strip from the torse, mm; at both ends and in the middle of
    /// `SAMPLES_PER_PIECE` rulings per piece.
    pub error_estimate: f64,
}

/// Rulings per piece at which the error of a conversion is measured.
pub const SAMPLES_PER_PIECE: usize = 24;

impl Net {
    /// The strip of the tangent surface of `regression` (degree `n + 1 ≥ 2`) between its polar curves for `M*` (the
    /// curve of the net) and `Λ*`.
    ///
    /// # Errors
    /// Degree below two; `M*` in the middle of the domain; boundary weights that are not positive.
    pub fn tangent_surface(regression: &Curve<4>, lambda_star: f64, m_star: f64) -> Result<Self, NetError> {
        let degree = regression.knots.degree();
        let all = regression.knots.values();
        if degree < 2 {
            return Err(NetError::Form { reason: "its regression curve must be of degree 2 at least".into() });
        }
        let knots = Knots::new(degree - 1, all[1..all.len() - 1].to_vec(), regression.control.len() - 1)?;
        let shape = Shape::from_stars(knots.domain(), lambda_star, m_star)
            .ok_or(NetError::Shape { m: f64::INFINITY, kappa: lambda_star - m_star })?;
        let v = knots.values();
        let polar = |x: f64| -> Vec<[f64; 4]> {
            (0..knots.control_count())
                .map(|i| {
                    // c_i = r[u_i … u_{i+n−1}, x]: the last step of the de Boor scheme on an edge of the polygon.
                    let (left, right) = (v[i], v[i + degree]);
                    let s = (x - left) / (right - left);
                    let (p, q) = (&regression.control[i], &regression.control[i + 1]);
                    std::array::from_fn(|d| (1.0 - s) * p[d] + s * q[d])
                })
                .collect()
        };
        let (control, opposite) = (polar(m_star), polar(lambda_star));
        let rulings = opposite.iter().zip(&control).map(|(d, c)| super::control_net::plus(d, c, -1.0)).collect();
        let curve = Curve { knots, control };
        super::control_net::check_curve(&curve)?;
        Ok(Self::from_parts(curve, rulings, shape))
    }

    /// The cone over `curve` with the given vertex; the first ruling ends at the share `share` of the way from the
    /// curve to the vertex (negative: away from it). Polynomial over a polynomial curve.
    ///
    /// # Errors
    /// Vertex not finite or on the curve's start; share 0 or 1.
    pub fn cone(curve: Curve<4>, vertex: &Vec3, share: f64) -> Result<Self, NetError> {
        let domain = curve.domain();
        let first = curve.control[0];
        if first[3] > 0.0 && curve.control.iter().all(|c| c[3] == first[3]) {
            let to_vertex = (vertex - affine(&first)) * (first[3] * share);
            let e = [to_vertex.x, to_vertex.y, to_vertex.z, 0.0];
            return Self::from_first(curve, e, Shape::new(domain, 0.0, -share));
        }
        let weight = first[3] * share / (1.0 - share);
        let e = [vertex.x * weight, vertex.y * weight, vertex.z * weight, weight];
        Self::from_first(curve, e, Shape::new(domain, 0.0, 0.0))
    }

    /// The cylinder over `curve` whose first ruling is the vector `first`, mm. Over a polynomial curve the opposite
    /// boundary is the curve moved by that vector.
    ///
    /// # Errors
    /// A vector that is zero or not finite.
    pub fn cylinder(curve: Curve<4>, first: &Vec3) -> Result<Self, NetError> {
        let domain = curve.domain();
        let e = first * curve.control[0][3];
        Self::from_first(curve, [e.x, e.y, e.z, 0.0], Shape::new(domain, 0.0, 0.0))
    }

    /// Parameters spread over all pieces.
    fn parameters(&self) -> Vec<f64> {
        let breaks = self.curve().knots.breaks();
        let mut out = vec![breaks[0]];
        for w in breaks.windows(2) {
            out.extend((1..=SAMPLES_PER_PIECE).map(|k| w[0] + (w[1] - w[0]) * k as f64 / SAMPLES_PER_PIECE as f64));
        }
        out
    }
}

/// The dual form of a net: its tangent planes as a spline of degree `3n − 1`, with the net's parameter. Exact up to
/// rounding, which the error states.
///
/// # Errors
/// A degree above 8; a corner of the curve; an inflection, where the tangent plane stands still: the dual form cannot
/// represent it (cut the net there, or take the primal form).
pub fn to_dual(net: &Net) -> Result<Converted, NetError> {
    let torse = Torse::Dual(DualTorse { planes: tangent_planes(net)? });
    let mut error_estimate = 0.0f64;
    for u in net.parameters() {
        let r = torse.ruling(u);
        let [c, d] = net.ruling(u);
        for x in [c, (c + d) * 0.5, d] {
            let off = (x - r.point) - r.direction * (x - r.point).dot(&r.direction);
            // Also a ruling that is no number must be seen.
            if !off.norm().is_finite() {
                let reason = format!("its tangent plane stands still at u = {u}");
                return Err(NetError::Form { reason });
            }
            error_estimate = error_estimate.max(off.norm());
        }
    }
    Ok(Converted { torse, error_estimate })
}

/// The primal form of a net, a cubic fit over a plane across the rulings, within about `tolerance` (mm) where
/// `spans` (at most, but one per piece of the net) allow it; the error says what was reached.
///
/// # Errors
/// Rulings that do not meet a common plane in order: strips that turn by more than a right angle.
pub fn to_primal(net: &Net, tolerance: f64, spans: usize) -> Result<Converted, NetError> {
    let fail = |reason: &str| NetError::Form { reason: reason.to_string() };
    // 1. A frame: y along the mean ruling, z along the mean normal.
    let parameters = net.parameters();
    let strip: Vec<[Vec3; 2]> = parameters.iter().map(|&u| net.ruling(u)).collect();
    let y = strip.iter().map(|[c, d]| (d - c).normalize()).sum::<Vec3>();
    let z = parameters.iter().filter_map(|&u| net.normal(u)).sum::<Vec3>();
    let (y, z) = (y.normalize(), z - y * (z.dot(&y) / y.norm_squared()));
    let z = z.normalize();
    let x = y.cross(&z);
    let origin = strip.iter().map(|[c, d]| (c + d) * 0.5).sum::<Vec3>() / strip.len() as f64;
    if !(x.norm() > 0.5 && origin.iter().all(|v| v.is_finite())) {
        return Err(fail("its rulings have no mean direction"));
    }
    let frame = Frame { origin, x, y, z };
    // 2. Where each ruling crosses y = 0, and its slopes there.
    let mut rows = Vec::with_capacity(strip.len());
    for [c, d] in &strip {
        let (p, e) = (frame.to_local(c), frame.vector_to_local(&(d - c)));
        let e = e / e.y;
        let q = p - e * p.y;
        if e.norm().is_nan() || e.norm() > 1e3 {
            return Err(fail("a ruling is nearly parallel to the plane across the mean ruling; cut the net"));
        }
        rows.push((q.x, q.z, e.x, e.z));
    }
    if rows[rows.len() - 1].0 < rows[0].0 {
        rows.reverse();
    }
    if !rows.windows(2).all(|w| w[1].0 > w[0].0) {
        return Err(fail("its rulings do not cross a common plane in order; cut the net"));
    }
    // 3. Fit f and a over t; a is scaled to a length by half the strip's width, so that one tolerance serves both.
    let half = strip.iter().map(|[c, d]| (d - c).norm()).fold(0.0, f64::max) * 0.5;
    let t: Vec<f64> = rows.iter().map(|r| r.0).collect();
    let data: Vec<[f64; 2]> = rows.iter().map(|r| [r.1, r.2 * half]).collect();
    // Where two pieces of the net meet, its rulings are only once differentiable in the profile: double knots there.
    let pieces = (t.len() - 1) / SAMPLES_PER_PIECE;
    let knots_with = |per_piece: usize| {
        let mut values = vec![t[0]; 4];
        for k in 1..pieces * per_piece {
            let at = t[k * SAMPLES_PER_PIECE / per_piece];
            values.extend(std::iter::repeat_n(at, if k % per_piece == 0 { 2 } else { 1 }));
        }
        values.extend([t[t.len() - 1]; 4]);
        let control = values.len() - 4;
        Knots::new(3, values, control)
    };
    let fit = |per_piece: usize| -> Result<_, NetError> {
        lsq::fit(&data, &t, &knots_with(per_piece)?).map_err(|e| fail(&e.to_string()))
    };
    let mut per_piece = 1;
    let mut fitted = fit(per_piece)?;
    // At least three rulings for each span.
    while fitted.error > 0.5 * tolerance && 2 * per_piece * pieces <= spans && 2 * per_piece <= SAMPLES_PER_PIECE / 3 {
        per_piece *= 2;
        fitted = fit(per_piece)?;
    }
    for c in &mut fitted.curve.control {
        c[1] /= half;
    }
    let torse = Torse::Primal(PrimalTorse::new(frame, fitted.curve, rows[0].3));
    // 4. What it amounts to.
    let (t0, t1) = torse.domain();
    let mut error_estimate = 0.0f64;
    for [c, d] in &strip {
        let (p, e) = (frame.to_local(c), frame.vector_to_local(&(d - c)));
        let guess = (p.x - e.x * p.y / e.y).clamp(t0, t1);
        for x in [*c, (c + d) * 0.5, *d] {
            // At the ends the foot may lie a little outside: there the end plane is compared.
            let foot = torse.foot(&x, guess).unwrap_or(guess);
            error_estimate = error_estimate.max(torse.plane_distance(&x, foot).abs());
        }
    }
    Ok(Converted { torse, error_estimate })
}
