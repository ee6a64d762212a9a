//! Tensor-product B-spline surfaces of space, polynomial and rational.

use super::knots::Knots;
use super::{SplineError, MAX_DEGREE};
use crate::geom::placement::Placement;
use crate::geom::{BBox, Vec3};

/// Sine of the angle between the parameter lines below which they are one line and give no normal: thousands of
/// rounding errors of their product.
pub(crate) const NO_NORMAL: f64 = 1e-12;

/// A surface `S(u, v) = Σ w_ij P_ij N_i(u) N_j(v) / Σ w_ij N_i(u) N_j(v)`.
///
/// # Example
/// ```
/// use torse::{geom::Vec3, spline::{knots::Knots, surface::Surface}};
/// let line = Knots::clamped(1, &[0.0, 1.0])?;
/// let corners = [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 4.0]].map(Vec3::from);
/// let saddle = Surface::new(line.clone(), line, &corners, None)?;
/// let j = saddle.jet(0.5, 0.5);
/// assert_eq!((j.p.z, j.duv.z), (1.0, 4.0));
/// assert!(j.normal().dot(&j.du).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Knots and degree in u.
    pub knots_u: Knots,
    /// Knots and degree in v.
    pub knots_v: Knots,
    /// Homogeneous control points `(w x, w y, w z, w)`, row-major: index `i * n_v + j`, lengths in mm.
    pub control: Vec<[f64; 4]>,
    /// Whether any weight differs from 1.
    pub rational: bool,
}

/// Point and partial derivatives up to order two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJet {
    /// S.
    pub p: Vec3,
    /// ∂S/∂u.
    pub du: Vec3,
    /// ∂S/∂v.
    pub dv: Vec3,
    /// ∂²S/∂u².
    pub duu: Vec3,
    /// ∂²S/∂u∂v.
    pub duv: Vec3,
    /// ∂²S/∂v².
    pub dvv: Vec3,
}

impl SurfaceJet {
    /// S_u × S_v, not normalised.
    pub fn normal(&self) -> Vec3 {
        self.du.cross(&self.dv)
    }

    /// `[n·S_uu, n·S_uv, n·S_vv]`: the second fundamental form where `n` is the unit normal. About [`Self::normal`] as it is,
    /// the length of that is in each of the three.
    pub fn second_form(&self, n: &Vec3) -> [f64; 3] {
        [n.dot(&self.duu), n.dot(&self.duv), n.dot(&self.dvv)]
    }
}

/// Evaluates with loops of known length for the degrees that nearly all surfaces have, `$otherwise` for the rest.
macro_rules! by_degree {
    ($surface:expr, $u:expr, $v:expr, $take:expr, $otherwise:expr) => {
        match ($surface.knots_u.degree(), $surface.knots_v.degree()) {
            (1, 1) => $take($surface.fixed_degree_jet::<2, 2>($u, $v)),
            (1, 2) => $take($surface.fixed_degree_jet::<2, 3>($u, $v)),
            (1, 3) => $take($surface.fixed_degree_jet::<2, 4>($u, $v)),
            (2, 1) => $take($surface.fixed_degree_jet::<3, 2>($u, $v)),
            (2, 2) => $take($surface.fixed_degree_jet::<3, 3>($u, $v)),
            (2, 3) => $take($surface.fixed_degree_jet::<3, 4>($u, $v)),
            (3, 1) => $take($surface.fixed_degree_jet::<4, 2>($u, $v)),
            (3, 2) => $take($surface.fixed_degree_jet::<4, 3>($u, $v)),
            (3, 3) => $take($surface.fixed_degree_jet::<4, 4>($u, $v)),
            (4, 1) => $take($surface.fixed_degree_jet::<5, 2>($u, $v)),
            (4, 4) => $take($surface.fixed_degree_jet::<5, 5>($u, $v)),
            (5, 1) => $take($surface.fixed_degree_jet::<6, 2>($u, $v)),
            (5, 5) => $take($surface.fixed_degree_jet::<6, 6>($u, $v)),
            (7, 1) => $take($surface.fixed_degree_jet::<8, 2>($u, $v)),
            _ => $otherwise,
        }
    };
}

impl Surface {
    /// Checks and stores a surface from affine control points `points[i * n_v + j]` and weights (`None`: all 1).
    ///
    /// # Errors
    /// Knots that do not fit, coordinates that are not finite, weights that are not positive.
    pub fn new(knots_u: Knots, knots_v: Knots, points: &[Vec3], weights: Option<&[f64]>) -> Result<Self, SplineError> {
        let (nu, nv) = (knots_u.control_count(), knots_v.control_count());
        if points.len() != nu * nv || weights.is_some_and(|w| w.len() != nu * nv) {
            return Err(SplineError::Control {
                index: points.len(),
                reason: format!("{nu} x {nv} points and weights are needed"),
            });
        }
        let mut control = Vec::with_capacity(points.len());
        let mut rational = false;
        for (index, p) in points.iter().enumerate() {
            let w = weights.map_or(1.0, |w| w[index]);
            if !(w > 0.0 && w.is_finite()) {
                return Err(SplineError::Control { index, reason: format!("weight {w} is not a positive number") });
            }
            if !(p.x.is_finite() && p.y.is_finite() && p.z.is_finite()) {
                return Err(SplineError::Control { index, reason: "a coordinate is not a finite number".into() });
            }
            rational |= w != 1.0;
            control.push([w * p.x, w * p.y, w * p.z, w]);
        }
        Ok(Self { knots_u, knots_v, control, rational })
    }

    /// Number of control points in v (the row length of `control`).
    #[inline]
    pub fn row(&self) -> usize {
        self.knots_v.control_count()
    }

    /// Domain `((u0, u1), (v0, v1))`.
    pub fn domain(&self) -> ((f64, f64), (f64, f64)) {
        (self.knots_u.domain(), self.knots_v.domain())
    }

    /// Box of the control points, which contains the surface.
    pub fn bbox(&self) -> BBox {
        let mut b = BBox::empty();
        for c in &self.control {
            b.include(&(Vec3::new(c[0], c[1], c[2]) / c[3]));
        }
        b
    }

    /// Homogeneous value and partial derivatives `[S, S_u, S_v, S_uu, S_uv, S_vv]`; no allocation. Derivatives above
    /// `order` are not meaningful.
    pub fn homogeneous_jet(&self, u: f64, v: f64, order: usize) -> [[f64; 4]; 6] {
        by_degree!(self, u, v, |jet| jet, self.any_degree_jet(u, v, order))
    }

    /// [`Surface::homogeneous_jet`] for degrees `N − 1` and `M − 1`.
    #[inline(always)]
    fn fixed_degree_jet<const N: usize, const M: usize>(&self, u: f64, v: f64) -> [[f64; 4]; 6] {
        let (first_u, bu) = self.knots_u.basis_fixed::<N>(u);
        let (first_v, bv) = self.knots_v.basis_fixed::<M>(v);
        let row = self.row();
        // First along v, row by row, then along u: each sum stays in registers.
        let mut t = [[[0.0; 4]; N]; 3];
        for i in 0..N {
            let base = (first_u + i) * row + first_v;
            let net: &[[f64; 4]] = &self.control[base..base + M];
            for k in 0..3 {
                let mut sum = [0.0; 4];
                for j in 0..M {
                    for d in 0..4 {
                        sum[d] += bv[k][j] * net[j][d];
                    }
                }
                t[k][i] = sum;
            }
        }
        let along_u = |b: &[f64; N], t: &[[f64; 4]; N]| {
            let mut sum = [0.0; 4];
            for i in 0..N {
                for d in 0..4 {
                    sum[d] += b[i] * t[i][d];
                }
            }
            sum
        };
        [
            along_u(&bu[0], &t[0]),
            along_u(&bu[1], &t[0]),
            along_u(&bu[0], &t[1]),
            along_u(&bu[2], &t[0]),
            along_u(&bu[1], &t[1]),
            along_u(&bu[0], &t[2]),
        ]
    }

    /// [`Surface::homogeneous_jet`] for any degree.
    fn any_degree_jet(&self, u: f64, v: f64, order: usize) -> [[f64; 4]; 6] {
        let bu = self.knots_u.basis(u, order);
        let bv = self.knots_v.basis(v, order);
        let (p, q, row) = (self.knots_u.degree(), self.knots_v.degree(), self.row());
        let mut out = [[0.0; 4]; 6];
        for i in 0..=p {
            let base = (bu.first + i) * row + bv.first;
            let mut t = [[0.0; 4]; 3];
            for j in 0..=q {
                let c = &self.control[base + j];
                for (k, tk) in t.iter_mut().enumerate().take(order + 1) {
                    let b = bv.rows[k][j];
                    for d in 0..4 {
                        tk[d] += b * c[d];
                    }
                }
            }
            for d in 0..4 {
                out[0][d] += bu.rows[0][i] * t[0][d];
                out[1][d] += bu.rows[1][i] * t[0][d];
                out[2][d] += bu.rows[0][i] * t[1][d];
                out[3][d] += bu.rows[2][i] * t[0][d];
                out[4][d] += bu.rows[1][i] * t[1][d];
                out[5][d] += bu.rows[0][i] * t[2][d];
            }
        }
        out
    }

    /// Point and derivatives up to order two. Parameters outside the domain continue the outermost pieces.
    pub fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let h = self.homogeneous_jet(u, v, 2);
        let a = h.map(|c| Vec3::new(c[0], c[1], c[2]));
        if !self.rational {
            return SurfaceJet { p: a[0], du: a[1], dv: a[2], duu: a[3], duv: a[4], dvv: a[5] };
        }
        let w = h.map(|c| c[3]);
        let r = 1.0 / w[0];
        let p = a[0] * r;
        let du = (a[1] - p * w[1]) * r;
        let dv = (a[2] - p * w[2]) * r;
        SurfaceJet {
            p,
            du,
            dv,
            duu: (a[3] - du * (2.0 * w[1]) - p * w[3]) * r,
            duv: (a[4] - du * w[2] - dv * w[1] - p * w[4]) * r,
            dvv: (a[5] - dv * (2.0 * w[2]) - p * w[5]) * r,
        }
    }

    /// Homogeneous point at `(u, v)`.
    pub fn homogeneous_point(&self, u: f64, v: f64) -> [f64; 4] {
        // Where the degree is known at compile time, what belongs to the derivatives is left out by the compiler.
        by_degree!(self, u, v, |jet: [[f64; 4]; 6]| jet[0], self.any_degree_jet(u, v, 0)[0])
    }

    /// Point at `(u, v)`.
    pub fn point(&self, u: f64, v: f64) -> Vec3 {
        let h = self.homogeneous_point(u, v);
        Vec3::new(h[0], h[1], h[2]) / h[3]
    }

    /// Point and derivatives at a parameter that may lie outside the domain: there the second-order Taylor
    /// polynomial at the nearest point of the domain is used, which stays tame where the last span's polynomial
    /// does not.
    pub fn extended_jet(&self, u: f64, v: f64) -> SurfaceJet {
        let ((u0, u1), (v0, v1)) = self.domain();
        let (cu, cv) = (u.clamp(u0, u1), v.clamp(v0, v1));
        let mut j = self.jet(cu, cv);
        let (a, b) = (u - cu, v - cv);
        j.p += j.du * a + j.dv * b + j.duu * (0.5 * a * a) + j.duv * (a * b) + j.dvv * (0.5 * b * b);
        j.du += j.duu * a + j.duv * b;
        j.dv += j.duv * a + j.dvv * b;
        j
    }

    /// Moves the surface.
    pub fn place(&mut self, placement: &Placement) {
        for c in &mut self.control {
            let p = placement.linear * Vec3::new(c[0], c[1], c[2]) + placement.shift * c[3];
            *c = [p.x, p.y, p.z, c[3]];
        }
    }

    /// Parameter values in u (v) at which the surface is only continuous: interior knots as often as the degree.
    pub fn c0_lines(&self) -> (Vec<f64>, Vec<f64>) {
        let lines = |k: &Knots| {
            let (a, b) = k.domain();
            k.distinct().into_iter().filter(|&(t, m)| m >= k.degree() && t > a && t < b).map(|(t, _)| t).collect()
        };
        (lines(&self.knots_u), lines(&self.knots_v))
    }

    /// Largest supported degree; see `MAX_DEGREE`.
    pub const MAX_DEGREE: usize = MAX_DEGREE;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rational_derivatives_match_differences() {
        let k = Knots::uniform(2, 2, 0.0, 1.0).expect("knots");
        let mut pts = Vec::new();
        let mut w = Vec::new();
        for i in 0..4 {
            for j in 0..4 {
                pts.push(Vec3::new(i as f64, j as f64, ((i * j) as f64).sin()));
                w.push(1.0 + 0.1 * ((i + 2 * j) as f64));
            }
        }
        let s = Surface::new(k.clone(), k, &pts, Some(&w)).expect("surface");
        let (u, v, h) = (0.3, 0.7, 1e-5);
        let j = s.jet(u, v);
        let fd = (s.point(u + h, v) - s.point(u - h, v)) / (2.0 * h);
        assert!((fd - j.du).norm() < 1e-8);
        let fd = (s.jet(u, v + h).du - s.jet(u, v - h).du) / (2.0 * h);
        assert!((fd - j.duv).norm() < 1e-7);
        let fd = (s.jet(u, v + h).dv - s.jet(u, v - h).dv) / (2.0 * h);
        assert!((fd - j.dvv).norm() < 1e-7);
    }
}
