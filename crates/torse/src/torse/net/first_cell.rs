//! Nets from their first cell: the curve and the first two control points of the opposite boundary, and Aumann's
//! Bézier nets as the special case without interior knots.
//!
//! *Method.* The cell gives λ and μ, hence M* and Λ* \[FJ07, 18\], hence the whole net. For Bézier curves λ and μ are the
//! same for all cells \[FJ07, corollary 1\].

use super::control_net::{homogeneous, paper_knots, Net, NetError};
use super::shape::Shape;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// Distance of the fourth point from the plane of the other three, as a share of the cell's size, up to which the
/// cell counts as plane: well above rounding of coordinates with nine digits.
const PLANE: f64 = 1e-9;
/// Sine of the angle between the sides of a cell below which they count as parallel.
const PARALLEL: f64 = 1e-9;

/// The polynomial net through `curve` whose opposite boundary begins with the control points `d_0`, `d_1`.
///
/// *Input*: `d_1` in the plane of `c_0`, `c_1`, `d_0` up to 1e-9 of the cell's size; it is moved into that plane.
///
/// # Errors
/// A cell that is not plane or has parallel sides at `c_0`; M* in the middle of the domain or on a knot.
pub fn from_first_cell(curve: &Curve<3>, d_0: &Vec3, d_1: &Vec3) -> Result<Net, NetError> {
    let point = |i: usize| Vec3::from(curve.control[i]);
    let (side, rise, diagonal) = (point(1) - point(0), d_0 - point(0), d_1 - point(0));
    let size = side.norm().max(rise.norm()).max(diagonal.norm());
    if !size.is_finite() {
        return Err(NetError::Cell { reason: "has a point that is not finite".into() });
    }
    let normal = side.cross(&rise);
    if normal.norm() <= PARALLEL * side.norm() * rise.norm() {
        return Err(NetError::Cell {
            reason: "is degenerate: c_0, c_1 and d_0 lie on a line; move d_0 out of the curve's first tangent".into(),
        });
    }
    let off = diagonal.dot(&normal) / normal.norm();
    if off.abs() > PLANE * size {
        return Err(NetError::Cell {
            reason: format!("is not plane: d_1 lies {off} mm off the plane of c_0, c_1 and d_0; move it by that much"),
        });
    }
    // d_1 − c_0 = λ (c_1 − c_0) + μ (d_0 − c_0), solved in the plane.
    let square = normal.norm_squared();
    let lambda = diagonal.cross(&rise).dot(&normal) / square;
    let mu = side.cross(&diagonal).dot(&normal) / square;
    let (n, u) = (curve.knots.degree(), paper_knots(&curve.knots));
    let shape = Shape::from_cell(curve.domain(), u[0], u[n], lambda, mu)
        .ok_or(NetError::Shape { m: f64::INFINITY, kappa: f64::NAN })?;
    let c = homogeneous(curve);
    Net::from_first(c, [rise.x, rise.y, rise.z, 0.0], shape)
}

/// Aumann's developable Bézier net over `[0, 1]`: the curve with control points `polygon`, the first point `d_0` of
/// the opposite one, and every cell `d_i = (1 − λ − μ) c_{i−1} + λ c_i + μ d_{i−1}`.
///
/// # Errors
/// Fewer than two control points; `μ = −1`, for which M* is the middle of the domain; μ = 0.
pub fn aumann(polygon: &[Vec3], d_0: &Vec3, lambda: f64, mu: f64) -> Result<Net, NetError> {
    let degree = polygon.len().saturating_sub(1);
    let knots = Knots::uniform(degree, 1, 0.0, 1.0)?;
    let curve = Curve { knots, control: polygon.iter().map(|p| [p.x, p.y, p.z]).collect() };
    let shape = Shape::from_cell((0.0, 1.0), 0.0, 1.0, lambda, mu)
        .ok_or(NetError::Shape { m: f64::INFINITY, kappa: lambda })?;
    Net::through(&curve, d_0, shape)
}
