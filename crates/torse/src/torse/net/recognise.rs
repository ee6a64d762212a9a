//! Ruled patches read back as nets, with the deviation of what is read from what was given.
//!
//! *Method.* The recursion of \[FJ07, 13\] in its stable form is linear in m and κ; both are found by least squares over
//! all cells, and the net is built again from the first ruling.

use super::control_net::{plus, Net, NetError};
use super::shape::Shape;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;

/// A net with its distance from the patch that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Recognised {
    /// The exactly developable net.
    pub net: Net,
    /// No point of the net's strip is farther than this from the patch's point with the same parameters, mm (up to
    /// rounding of this number). At rounding's size the patch is such a net; otherwise it is not.
    pub deviation: f64,
}

/// The net nearest to a ruled patch with two rows of control points: the patch's first boundary and first ruling are
/// kept.
///
/// *Not guaranteed*: that a patch whose rows have unrelated weights is recognised, though it may be developable; nor a
/// best net for a patch that is none.
///
/// # Errors
/// A patch that is not of degree 1 along the rulings with two rows.
pub fn recognise(patch: &Surface) -> Result<Recognised, NetError> {
    let (degree, rows) = (patch.knots_v.degree(), patch.row());
    if degree != 1 || rows != 2 {
        return Err(NetError::NotRuled { degree, rows });
    }
    let c: Vec<[f64; 4]> = patch.control.iter().step_by(2).copied().collect();
    let d: Vec<[f64; 4]> = patch.control.iter().skip(1).step_by(2).copied().collect();
    let e: Vec<[f64; 4]> = d.iter().zip(&c).map(|(d, c)| plus(d, c, -1.0)).collect();
    let curve = Curve { knots: patch.knots_u.clone(), control: c };
    let (n, u) = (curve.knots.degree(), super::control_net::paper_knots(&curve.knots));
    let domain = curve.domain();
    let middle = 0.5 * (domain.0 + domain.1);
    // (e_{i+1} − e_i) = m ((u_i − u_m) e_{i+1} − (u_{i+n} − u_m) e_i) + κ (c_{i+1} − c_i).
    let (mut mm, mut mk, mut kk, mut mr, mut kr) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..e.len() - 1 {
        for x in 0..4 {
            let a = (u[i] - middle) * e[i + 1][x] - (u[i + n] - middle) * e[i][x];
            let b = curve.control[i + 1][x] - curve.control[i][x];
            let right = e[i + 1][x] - e[i][x];
            mm += a * a;
            mk += a * b;
            kk += b * b;
            mr += a * right;
            kr += b * right;
        }
    }
    let det = mm * kk - mk * mk;
    let (m, kappa) = if det > f64::EPSILON * mm * kk {
        ((mr * kk - kr * mk) / det, (kr * mm - mr * mk) / det)
    } else {
        (0.0, kr / kk)
    };
    let shape = Shape::new(domain, m, kappa);
    let net = Net::from_first(curve, e[0], shape)?;
    let deviation = apart(&net.opposite_points(), &d);
    Ok(Recognised { net, deviation })
}

/// Bound of the distance between two curves with these homogeneous control points over the same knots.
fn apart(x: &[[f64; 4]], y: &[[f64; 4]]) -> f64 {
    let point = |p: &[f64; 4]| Vec3::new(p[0], p[1], p[2]) / p[3];
    let centre = y.iter().map(point).sum::<Vec3>() / y.len() as f64;
    let radius = y.iter().map(|p| (point(p) - centre).norm()).fold(0.0, f64::max);
    let least = x.iter().map(|p| p[3]).fold(f64::INFINITY, f64::min);
    // x/w_x − y/w_y = ((x − y) − (y/w_y)(w_x − w_y)) / w_x, with y/w_y in the hull.
    let off = x.iter().zip(y).map(|(p, q)| {
        let w = p[3] - q[3];
        let d = Vec3::new(p[0] - q[0], p[1] - q[1], p[2] - q[2]) - centre * w;
        d.norm() + radius * w.abs()
    });
    let worst = off.fold(0.0, f64::max);
    if least > 0.0 {
        worst / least
    } else {
        f64::INFINITY
    }
}
