//! B-spline developable nets: exactly developable strips between two B-spline curves of any degree, knots and number
//! of pieces, polynomial or rational \[FJ07\].
//!
//! A net is a curve `c`, one ruling, and a [`Shape`]; everything else follows from the recursion
//! `g(u_i) e_{i+1} = g(u_{i+n}) e_i + κ (c_{i+1} − c_i)`, which is (13) of the paper without infinities. It is applied
//! to homogeneous points, so that rational nets are covered by the same lines: the paper leaves that open.

use super::shape::Shape;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Value of `|g(u_i)|` below which M* counts as lying on the knot `u_i`: there the recursion divides rounding by
/// nothing.
const ON_KNOT: f64 = 1e-12;

/// Data that do not make a developable net.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetError {
    /// m or κ is not a finite number.
    #[error("shape m = {m}, kappa = {kappa}: both must be finite; M* must not be the middle of the curve's domain")]
    Shape {
        /// m as given.
        m: f64,
        /// κ as given.
        kappa: f64,
    },
    /// M* coincides with a knot, so a cell cannot be closed.
    #[error("M* = {m_star} lies on knot {index} of the curve, so cell {index} has no fourth point; move M* off the knots, best outside the domain")]
    OnKnot {
        /// Index of the knot in the paper's count.
        index: usize,
        /// M*.
        m_star: f64,
    },
    /// The ruling given is zero or not finite.
    #[error("the {which} ruling has no direction: ({}, {}, {})", .vector[0], .vector[1], .vector[2])]
    Ruling {
        /// "first" or "last".
        which: &'static str,
        /// Coordinates as given.
        vector: [f64; 3],
    },
    /// A weight of the curve is not positive.
    #[error("control point {index} of the curve has weight {weight}; weights must be positive")]
    Weight {
        /// Index of the control point.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// The opposite boundary leaves the range of numbers.
    #[error("control point {index} of the opposite boundary is not finite: M* = {m_star} is too close to a knot")]
    Overflow {
        /// Index of the control point.
        index: usize,
        /// M*.
        m_star: f64,
    },
    /// A first cell that is not plane, or degenerate.
    #[error("the first cell {reason}")]
    Cell {
        /// What is wrong, and what would help.
        reason: String,
    },
    /// The net cannot be written in the form asked for.
    #[error("the net has no such form: {reason}")]
    Form {
        /// What is wrong.
        reason: String,
    },
    /// Not a ruled patch of degree 1 in v with two rows.
    #[error(
        "a patch of degree 1 with two control points along the rulings is needed, not degree {degree} with {rows}"
    )]
    NotRuled {
        /// Degree in v.
        degree: usize,
        /// Number of control points in v.
        rows: usize,
    },
    /// Not a valid spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// What kind of developable a net is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NetKind {
    /// Parallel rulings.
    Cylinder {
        /// Unit direction of the rulings.
        direction: Vec3,
    },
    /// Rulings through one point.
    Cone {
        /// The vertex, mm.
        vertex: Vec3,
    },
    /// Tangent surface of its regression curve.
    Tangent,
}

/// A developable strip between a B-spline curve `c` (`v = 0`) and an opposite boundary `d` (`v = 1`) over the same
/// knots, lengths in mm.
///
/// *Guarantee*: developable up to rounding, whatever the numbers are. *Not guaranteed*: regularity; see
/// [`Net::regularity`].
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    pub(super) curve: Curve<4>,
    /// `E_i = D_i − C_i`, homogeneous.
    pub(super) rulings: Vec<[f64; 4]>,
    pub(super) shape: Shape,
}

impl Net {
    /// The net through `curve` (homogeneous, weight last; all weights 1 for a polynomial curve) whose first ruling
    /// vector is `first` (`D_0 − C_0`, homogeneous: weight 0 for polynomial nets).
    ///
    /// *Method.* The recursion of corollary 2 of \[FJ07\]. *Cost*: linear in the number of control points.
    ///
    /// # Errors
    /// Numbers that are not finite, weights that are not positive, M* on a knot of the curve.
    pub fn from_first(curve: Curve<4>, first: [f64; 4], shape: Shape) -> Result<Self, NetError> {
        check(&curve, &shape, &first, "first")?;
        let (n, u, count) = (curve.knots.degree(), paper_knots(&curve.knots), curve.control.len());
        let mut rulings = Vec::with_capacity(count);
        rulings.push(first);
        let mut e = first;
        for i in 0..count - 1 {
            let below = shape.g(u[i]);
            if below.abs() <= ON_KNOT {
                return Err(NetError::OnKnot { index: i, m_star: shape.m_star() });
            }
            let above = shape.g(u[i + n]);
            let (c, next) = (&curve.control[i], &curve.control[i + 1]);
            for d in 0..4 {
                e[d] = (above * e[d] + shape.kappa * (next[d] - c[d])) / below;
            }
            rulings.push(e);
        }
        finished(curve, rulings, shape)
    }

    /// As [`Net::from_first`], from the last ruling vector. The better way when `g` is larger at the end of the curve
    /// than at its start, because errors then shrink along the recursion.
    ///
    /// # Errors
    /// As [`Net::from_first`].
    pub fn from_last(curve: Curve<4>, last: [f64; 4], shape: Shape) -> Result<Self, NetError> {
        check(&curve, &shape, &last, "last")?;
        let (n, u, count) = (curve.knots.degree(), paper_knots(&curve.knots), curve.control.len());
        let mut rulings = vec![last; count];
        let mut e = last;
        for i in (0..count - 1).rev() {
            let above = shape.g(u[i + n]);
            if above.abs() <= ON_KNOT {
                return Err(NetError::OnKnot { index: i + n, m_star: shape.m_star() });
            }
            let below = shape.g(u[i]);
            let (c, next) = (&curve.control[i], &curve.control[i + 1]);
            for d in 0..4 {
                e[d] = (below * e[d] - shape.kappa * (next[d] - c[d])) / above;
            }
            rulings[i] = e;
        }
        finished(curve, rulings, shape)
    }

    /// The polynomial net through `curve` with the first ruling ending at `d_0`.
    ///
    /// # Errors
    /// As [`Net::from_first`].
    pub fn through(curve: &Curve<3>, d_0: &Vec3, shape: Shape) -> Result<Self, NetError> {
        let c = homogeneous(curve);
        let first = c.control[0];
        Self::from_first(c, [d_0.x - first[0], d_0.y - first[1], d_0.z - first[2], 0.0], shape)
    }

    /// A net from parts that are known to fit.
    pub(super) fn from_parts(curve: Curve<4>, rulings: Vec<[f64; 4]>, shape: Shape) -> Self {
        Self { curve, rulings, shape }
    }

    /// The curve, homogeneous.
    pub fn curve(&self) -> &Curve<4> {
        &self.curve
    }

    /// Ruling vectors `D_i − C_i` of the control net, homogeneous.
    pub fn rulings(&self) -> &[[f64; 4]] {
        &self.rulings
    }

    /// The two numbers of the net.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Degree of the boundary curves.
    pub fn degree(&self) -> usize {
        self.curve.knots.degree()
    }

    /// Domain of the curve.
    pub fn domain(&self) -> (f64, f64) {
        self.curve.domain()
    }

    /// Whether any weight differs from 1.
    pub fn is_rational(&self) -> bool {
        self.curve.control.iter().any(|c| c[3] != 1.0) || self.rulings.iter().any(|e| e[3] != 0.0)
    }

    /// Control points of the opposite boundary, homogeneous.
    pub fn opposite_points(&self) -> Vec<[f64; 4]> {
        self.curve.control.iter().zip(&self.rulings).map(|(c, e)| plus(c, e, 1.0)).collect()
    }

    /// The opposite boundary `d`, homogeneous.
    pub fn opposite(&self) -> Curve<4> {
        Curve { knots: self.curve.knots.clone(), control: self.opposite_points() }
    }

    /// The ruling vectors as a spline, homogeneous.
    pub(crate) fn ruling_curve(&self) -> Curve<4> {
        Curve { knots: self.curve.knots.clone(), control: self.rulings.clone() }
    }

    /// Both ends of ruling `u`, mm.
    pub fn ruling(&self, u: f64) -> [Vec3; 2] {
        let [c, _, e, _] = self.jet(u);
        [affine(&c), affine(&plus(&c, &e, 1.0))]
    }

    /// Homogeneous point of the curve, its derivative, the ruling vector and its derivative at `u`.
    pub(crate) fn jet(&self, u: f64) -> [[f64; 4]; 4] {
        let basis = self.curve.knots.basis(u, 1);
        let mut out = [[0.0; 4]; 4];
        for j in 0..=self.degree() {
            let (c, e) = (&self.curve.control[basis.first + j], &self.rulings[basis.first + j]);
            for k in 0..2 {
                let b = basis.rows[k][j];
                for d in 0..4 {
                    out[k][d] += b * c[d];
                    out[2 + k][d] += b * e[d];
                }
            }
        }
        out
    }

    /// Homogeneous position of the regression point on ruling `u`: 0 on the curve, 1 on the opposite boundary.
    /// For polynomial nets this is the share of the ruling.
    pub fn regression(&self, u: f64) -> f64 {
        self.shape.regression(u)
    }

    /// The regression point of ruling `u`, mm; `None` where it lies at infinity.
    pub fn regression_point(&self, u: f64) -> Option<Vec3> {
        let v = self.regression(u);
        let [c, _, e, _] = self.jet(u);
        // For κ = 0 all rulings go through the point e, which may be at infinity.
        let r = if v.is_finite() { plus(&c, &e, v) } else { e };
        let size = r.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        (r[3].abs() > f64::EPSILON * size).then(|| affine(&r)).filter(|p| p.iter().all(|x| x.is_finite()))
    }

    /// Plane, cylinder, cone or tangent surface; the case of (5), (6) and of Λ = M in the paper. Planes are not told
    /// apart.
    pub fn kind(&self) -> NetKind {
        let (a, b) = self.domain();
        let e = self.rulings[0];
        if self.shape.kappa == 0.0 {
            let v = Vec3::new(e[0], e[1], e[2]);
            return if e[3] == 0.0 {
                NetKind::Cylinder { direction: v.normalize() }
            } else {
                NetKind::Cone { vertex: v / e[3] }
            };
        }
        if self.shape.m * (b - a) == 0.0 {
            let r = plus(&self.curve.control[0], &e, -1.0 / self.shape.kappa);
            if r[3] != 0.0 {
                return NetKind::Cone { vertex: affine(&r) };
            }
            return NetKind::Cylinder { direction: Vec3::new(r[0], r[1], r[2]).normalize() };
        }
        NetKind::Tangent
    }

    /// The strip as a ruled patch: `u` selects the ruling, `v` in `[0, 1]` runs along it from the curve to the
    /// opposite boundary. Exact.
    ///
    /// # Errors
    /// A weight of the opposite boundary that is not positive.
    pub fn patch(&self) -> Result<Surface, NetError> {
        ruled(&self.curve, &self.opposite())
    }
}

/// The ruled patch between two curves over the same knots.
pub(super) fn ruled(c: &Curve<4>, d: &Curve<4>) -> Result<Surface, NetError> {
    let knots_v = Knots::new(1, vec![0.0, 0.0, 1.0, 1.0], 2)?;
    let mut control = Vec::with_capacity(2 * c.control.len());
    for (index, (p, q)) in c.control.iter().zip(&d.control).enumerate() {
        if q[3].is_nan() || q[3] <= 0.0 {
            return Err(NetError::Weight { index, weight: q[3] });
        }
        control.push(*p);
        control.push(*q);
    }
    let rational = control.iter().any(|p| p[3] != 1.0);
    Ok(Surface { knots_u: c.knots.clone(), knots_v, control, rational })
}

pub(super) fn check(curve: &Curve<4>, shape: &Shape, ruling: &[f64; 4], which: &'static str) -> Result<(), NetError> {
    if !(shape.m.is_finite() && shape.kappa.is_finite()) {
        return Err(NetError::Shape { m: shape.m, kappa: shape.kappa });
    }
    if ruling.iter().any(|x| !x.is_finite()) || ruling.iter().all(|&x| x == 0.0) {
        return Err(NetError::Ruling { which, vector: [ruling[0], ruling[1], ruling[2]] });
    }
    check_curve(curve)
}

/// Weights positive, coordinates finite.
pub(super) fn check_curve(curve: &Curve<4>) -> Result<(), NetError> {
    for (index, c) in curve.control.iter().enumerate() {
        if c.iter().any(|x| !x.is_finite()) {
            let reason = "a coordinate is not a finite number".to_string();
            return Err(SplineError::Control { index, reason }.into());
        }
        if c[3] <= 0.0 {
            return Err(NetError::Weight { index, weight: c[3] });
        }
    }
    Ok(())
}

pub(super) fn finished(curve: Curve<4>, rulings: Vec<[f64; 4]>, shape: Shape) -> Result<Net, NetError> {
    match rulings.iter().position(|e| e.iter().any(|x| !x.is_finite())) {
        Some(index) => Err(NetError::Overflow { index, m_star: shape.m_star() }),
        None => Ok(Net { curve, rulings, shape }),
    }
}

/// `x + k y`.
pub(super) fn plus(x: &[f64; 4], y: &[f64; 4], k: f64) -> [f64; 4] {
    std::array::from_fn(|d| x[d] + k * y[d])
}

/// The point of space.
pub(super) fn affine(x: &[f64; 4]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2]) / x[3]
}

/// Knots `u_0 … u_{L+n−1}` in the count of \[FJ07\]: all but the first and the last, which never matter.
pub fn paper_knots(knots: &Knots) -> &[f64] {
    let all = knots.values();
    &all[1..all.len() - 1]
}

/// Knots of the kernel from those of \[FJ07\], which omits the first and the last: the end knots are repeated.
///
/// # Errors
/// As [`Knots::new`].
pub fn from_paper_knots(degree: usize, paper: &[f64], control: usize) -> Result<Knots, NetError> {
    let mut values = Vec::with_capacity(paper.len() + 2);
    values.extend(paper.first());
    values.extend_from_slice(paper);
    values.extend(paper.last());
    Ok(Knots::new(degree, values, control)?)
}

/// A polynomial curve in homogeneous form, all weights 1.
pub fn homogeneous(curve: &Curve<3>) -> Curve<4> {
    let control = curve.control.iter().map(|c| [c[0], c[1], c[2], 1.0]).collect();
    Curve { knots: curve.knots.clone(), control }
}
