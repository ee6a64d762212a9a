//! The isometric map of a developable patch to the plane.
//!
//! *Method*: with a directrix c(t), unit rulings e(t) and b ⟂ e in the tangent plane, developability means
//! e' = ω b, and the tangent plane's own parallel transport turns rulings at the same rate. Hence in the plane the
//! ruling has the angle φ with φ' = ω = e'·b, and the directrix has the velocity (c'·e) ê(φ) + (c'·b) b̂(φ): two
//! quadratures, no differential equation \[DC76\]. Both are done with
//! Chebyshev series on pieces that are halved until the series end in rounding noise.

use crate::geom::{Vec2, Vec3};
use crate::spline::surface::Surface;

use super::DevelopError;

/// Nodes and coefficients per piece.
const N: usize = 16;
/// Tail of a series, relative to the size of the patch, below which a piece is accepted.
const TAIL: f64 = 1e-13;
/// The same, relative to the coordinates of the patch: what rounding leaves of them wherever it lies.
const ROUNDING: f64 = 4e-15;
/// Halvings of a knot span at most; 2⁻¹² of a span is far below what a cubic torse can need.
const DEEPEST: usize = 12;
/// Where the middle of a ruling moves across it by less than this share of all its motion, the patch folds there: the
/// rest is rounding.
const ALONG: f64 = 1e-12;

/// Flattening of a ruled developable patch: `(t, r)` to the plane.
#[derive(Clone, Debug)]
pub struct Development {
    patch: Surface,
    pieces: Vec<ChebyshevPiece>,
    /// +1 if the plane is seen from the side of R_t × R_r reversed, see [`Development::new`].
    side: f64,
}

/// Chebyshev series of angle and directrix on [a, b].
#[derive(Clone, Debug)]
struct ChebyshevPiece {
    a: f64,
    b: f64,
    angle: [f64; N + 1],
    x: [f64; N + 1],
    y: [f64; N + 1],
}

/// Directrix, ruling and their derivatives in space.
struct Moving {
    c: Vec3,
    dc: Vec3,
    e: Vec3,
    de: Vec3,
    b: Vec3,
}

impl Development {
    /// Develops a patch with `degree_v = 1`.
    ///
    /// `upwards`: +1 to look at the panel from the side to which e × R_t points (e: ruling in the direction of
    /// growing r), −1 from the other side.
    ///
    /// *Guarantee*: lengths agree with the patch to about 1e-10 relative where the patch is developable; see
    /// [`Development::strain`] for the figure measured.
    ///
    /// # Errors
    /// A ruling without length, or a regression point on the middle of the patch.
    pub fn new(patch: &Surface, upwards: f64) -> Result<Self, DevelopError> {
        Self::offset(patch, upwards, 0.0)
    }

    /// The same for the surface that lies `offset` (mm, positive towards the eye) beside the patch: places of the patch stand
    /// for those beside them. Rulings and tangent planes keep their directions, and the directrix goes `offset n'·b` on
    /// across the rulings, where `n` is the normal (docs/algorithms/shop.md, "The neutral fibre"). *Not guaranteed*: that the
    /// other surface is regular; and [`Development::strain`] compares with the patch, not with it.
    ///
    /// # Errors
    /// See [`Development::new`].
    pub fn offset(patch: &Surface, upwards: f64, offset: f64) -> Result<Self, DevelopError> {
        let mut out = Self { patch: patch.clone(), pieces: Vec::new(), side: upwards.signum() };
        let bbox = patch.bbox();
        let size = bbox.diagonal();
        let enough = (TAIL * size).max(ROUNDING * bbox.min.amax().max(bbox.max.amax()));
        let nodes: [f64; N] = std::array::from_fn(|k| (std::f64::consts::PI * (k as f64 + 0.5) / N as f64).cos());
        let (mut angle, mut place) = (0.0, Vec2::zeros());
        let mut stack: Vec<(f64, f64, usize)> =
            patch.knots_u.breaks().windows(2).rev().map(|w| (w[0], w[1], 0)).collect();
        while let Some((a, b, depth)) = stack.pop() {
            let (m, h) = (0.5 * (a + b), 0.5 * (b - a));
            let mut rate = [0.0; N];
            let mut speed = [(0.0, 0.0); N];
            for k in 0..N {
                let f = out.moving(m + h * nodes[k])?;
                rate[k] = h * f.de.dot(&f.b);
                let beside = if offset == 0.0 { 0.0 } else { offset * out.bending(m + h * nodes[k], &f) };
                speed[k] = (h * f.dc.dot(&f.e), h * (f.dc.dot(&f.b) + beside));
            }
            let turning = series(&rate);
            let angles = integral(&turning, angle);
            let mut vx = [0.0; N];
            let mut vy = [0.0; N];
            for k in 0..N {
                let (s, c) = clenshaw(&angles, nodes[k]).sin_cos();
                let (p, q) = speed[k];
                vx[k] = p * c - q * s;
                vy[k] = p * s + q * c;
            }
            let (vx, vy) = (series(&vx), series(&vy));
            let tail = |c: &[f64; N]| c[N - 1].abs().max(c[N - 2].abs());
            let error = (tail(&turning) * size).max(tail(&vx)).max(tail(&vy));
            if error > enough && depth < DEEPEST {
                stack.push((m, b, depth + 1));
                stack.push((a, m, depth + 1));
                continue;
            }
            let piece = ChebyshevPiece { a, b, angle: angles, x: integral(&vx, place.x), y: integral(&vy, place.y) };
            angle = clenshaw(&piece.angle, 1.0);
            place = Vec2::new(clenshaw(&piece.x, 1.0), clenshaw(&piece.y, 1.0));
            out.pieces.push(piece);
        }
        Ok(out)
    }

    /// Range of rulings.
    pub fn domain(&self) -> (f64, f64) {
        self.patch.knots_u.domain()
    }

    /// Image of the patch point `(t, r)`, mm.
    pub fn map(&self, t: f64, r: f64) -> Vec2 {
        let (o, angle) = self.directrix(t);
        // Both ends of the ruling say where all of it is.
        let [p, q] = [0.0, 1.0].map(|r| self.patch.homogeneous_point(t, r));
        let on = |r: f64| {
            let h = [0, 1, 2, 3].map(|d: usize| p[d] + (q[d] - p[d]) * r);
            Vec3::new(h[0], h[1], h[2]) / h[3]
        };
        let l = (on(r) - on(0.5)).dot(&(on(1.0) - on(0.0)).normalize());
        o + Vec2::new(angle.cos(), angle.sin()) * l
    }

    /// Image of the tangent vector `R_t dt + R_r dr` at `(t, r)`, from the patch's own derivatives.
    pub fn tangent(&self, t: f64, r: f64, dt: f64, dr: f64) -> Vec2 {
        let Ok(f) = self.moving(t) else { return Vec2::zeros() };
        let (_, angle) = self.directrix(t);
        let j = self.patch.jet(t, r);
        let v = j.du * dt + j.dv * dr;
        let (s, c) = angle.sin_cos();
        let (p, q) = (v.dot(&f.e), v.dot(&f.b));
        Vec2::new(p * c - q * s, p * s + q * c)
    }

    /// Largest relative error of lengths, in any direction, between patch and plane at `(t, r)`.
    ///
    /// Independent of how the map was found: the flat derivatives are those of the series that
    /// [`Development::map`] evaluates, the derivatives in space those of the patch; the answer is the greatest
    /// |σ − 1| over the singular values σ of the map between the two.
    pub fn strain(&self, t: f64, r: f64) -> f64 {
        let Ok(f) = self.moving(t) else { return f64::INFINITY };
        let (piece, x) = self.locate(t);
        let per = 2.0 / (piece.b - piece.a);
        let angle = clenshaw(&piece.angle, x);
        let (s, c) = angle.sin_cos();
        let (along, across) = (Vec2::new(c, s), Vec2::new(-s, c));
        let j = self.patch.jet(t, r);
        let l = (j.p - f.c).dot(&f.e);
        let velocity = Vec2::new(slope(&piece.x, x), slope(&piece.y, x)) * per;
        let ft = velocity + along * (j.du - f.dc).dot(&f.e) + across * (l * slope(&piece.angle, x) * per);
        let fr = along * j.dv.dot(&f.e);
        // Orthonormal coordinates in space: u₁ = R_r/|R_r|, u₂ ⟂ u₁.
        let (nr, tr) = (j.dv.norm(), j.du.dot(&j.dv));
        let p = tr / nr;
        let q = (j.du.norm_squared() - p * p).max(0.0).sqrt();
        let a = fr / nr;
        let b = (ft - a * p) / q;
        // Singular values of the matrix with columns a, b.
        let (g11, g12, g22) = (a.norm_squared(), a.dot(&b), b.norm_squared());
        let (half, root) = (0.5 * (g11 + g22), (0.5 * (g11 - g22)).hypot(g12));
        ((half + root).sqrt() - 1.0).abs().max(((half - root).max(0.0).sqrt() - 1.0).abs())
    }

    /// Flat directrix (r = 1/2) and angle of the ruling at `t`.
    pub fn directrix(&self, t: f64) -> (Vec2, f64) {
        let (piece, x) = self.locate(t);
        (Vec2::new(clenshaw(&piece.x, x), clenshaw(&piece.y, x)), clenshaw(&piece.angle, x))
    }

    /// Middles and ends of the pieces: where the map was built, and places to look at its error.
    pub fn stations(&self) -> impl Iterator<Item = f64> + '_ {
        const INSIDE: [f64; 4] = [0.03, 0.29, 0.55, 0.87];
        self.pieces.iter().flat_map(|p| INSIDE.map(|x| p.a + (p.b - p.a) * x))
    }

    fn locate(&self, t: f64) -> (&ChebyshevPiece, f64) {
        let k = self.pieces.partition_point(|p| p.b < t).min(self.pieces.len() - 1);
        let p = &self.pieces[k];
        (p, ((t - p.a) - (p.b - t)) / (p.b - p.a))
    }

    /// `n'·b`, with the normal towards the eye.
    fn bending(&self, t: f64, f: &Moving) -> f64 {
        // With c' = α e + β b and e' = ω b, n·c'' = β n·b' = −β n'·b.
        -f.e.cross(&f.b).dot(&self.patch.jet(t, 0.5).duu) / f.dc.dot(&f.b)
    }

    fn moving(&self, t: f64) -> Result<Moving, DevelopError> {
        let first = |r: f64| {
            let h = self.patch.homogeneous_jet(t, r, 1);
            let w = 1.0 / h[0][3];
            let p = Vec3::new(h[0][0], h[0][1], h[0][2]) * w;
            (p, (Vec3::new(h[1][0], h[1][1], h[1][2]) - p * h[1][3]) * w)
        };
        let ((p, dp), (q, dq), (c, dc)) = (first(0.0), first(1.0), first(0.5));
        let length = (q - p).norm();
        let e = (q - p) / length;
        let d = dq - dp;
        let de = (d - e * e.dot(&d)) / length;
        let across = dc - e * e.dot(&dc);
        let norm = across.norm();
        if !(length > 0.0 && norm > ALONG * dc.norm()) {
            return Err(DevelopError::Irregular { t });
        }
        Ok(Moving { c, dc, e, de, b: across * (self.side / norm) })
    }
}

/// Chebyshev coefficients from values at the N Chebyshev points.
fn series(values: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|j| {
        let s: f64 =
            (0..N).map(|k| values[k] * (std::f64::consts::PI * j as f64 * (k as f64 + 0.5) / N as f64).cos()).sum();
        s * if j == 0 { 1.0 } else { 2.0 } / N as f64
    })
}

/// Integral of a series with the value `start` at −1.
fn integral(c: &[f64; N], start: f64) -> [f64; N + 1] {
    let at = |k: usize| if k < N { c[k] } else { 0.0 };
    let mut out = [0.0; N + 1];
    for k in 1..=N {
        let before = if k == 1 { 2.0 * c[0] } else { at(k - 1) };
        out[k] = (before - at(k + 1)) / (2.0 * k as f64);
    }
    let left: f64 = (1..=N).map(|k| if k % 2 == 0 { out[k] } else { -out[k] }).sum();
    out[0] = start - left;
    out
}

/// Value of a series at x ∈ [−1, 1].
fn clenshaw(c: &[f64; N + 1], x: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for k in (1..=N).rev() {
        (b1, b2) = (2.0 * x * b1 - b2 + c[k], b1);
    }
    x * b1 - b2 + c[0]
}

/// Derivative of a series at x: T'_k = k U_{k−1}.
fn slope(c: &[f64; N + 1], x: f64) -> f64 {
    let (mut u, mut before) = (1.0, 0.0);
    let mut s = 0.0;
    for k in 1..=N {
        s += k as f64 * c[k] * u;
        (u, before) = (2.0 * x * u - before, u);
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;

    /// Quadratic rational quarter circle of radius `radius` at height `z`.
    fn quarter(radius: f64, z: f64) -> [(Vec3, f64); 3] {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        [(Vec3::new(radius, 0.0, z), 1.0), (Vec3::new(radius, radius, z), h), (Vec3::new(0.0, radius, z), 1.0)]
    }

    fn ruled(a: &[(Vec3, f64)], b: &[(Vec3, f64)], degree: usize) -> Surface {
        let ku = Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let (mut p, mut w) = (Vec::new(), Vec::new());
        for (x, y) in a.iter().zip(b) {
            p.extend([x.0, y.0]);
            w.extend([x.1, y.1]);
        }
        Surface::new(ku, kv, &p, Some(&w)).expect("surface")
    }

    fn worst_strain(d: &Development) -> f64 {
        d.stations().flat_map(|t| [0.0, 0.4, 1.0].map(|r| d.strain(t, r))).fold(0.0, f64::max)
    }

    #[test]
    fn a_cylinder_becomes_a_rectangle() {
        let s = ruled(&quarter(100.0, 0.0), &quarter(100.0, 50.0), 2);
        let d = Development::new(&s, 1.0).expect("a development");
        let c = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(t, r)| d.map(t, r));
        let l = 50.0 * std::f64::consts::PI;
        for (k, want) in [l, 50.0, l, 50.0].into_iter().enumerate() {
            assert!(((c[(k + 1) % 4] - c[k]).norm() - want).abs() < 1e-10 * l);
        }
        assert!(((c[2] - c[0]).norm() - l.hypot(50.0)).abs() < 1e-10 * l);
        assert!(worst_strain(&d) < 1e-11);
    }

    #[test]
    fn a_cone_becomes_a_sector() {
        // Slant 1:2, apex at height 200: slant length of the base circle is hypot(100, 200).
        let s = ruled(&quarter(100.0, 0.0), &quarter(40.0, 120.0), 2);
        let d = Development::new(&s, -1.0).expect("a development");
        let (outer, inner) = (100.0_f64.hypot(200.0), 40.0_f64.hypot(80.0));
        let sector = std::f64::consts::FRAC_PI_2 * 100.0 / outer;
        let chord = (d.map(1.0, 0.0) - d.map(0.0, 0.0)).norm();
        assert!((chord - 2.0 * outer * (0.5 * sector).sin()).abs() < 1e-9);
        let chord = (d.map(1.0, 1.0) - d.map(0.0, 1.0)).norm();
        assert!((chord - 2.0 * inner * (0.5 * sector).sin()).abs() < 1e-9);
        assert!(worst_strain(&d) < 1e-11);
    }

    #[test]
    fn tangents_of_a_helix_become_tangents_of_a_circle() {
        // Twisted cubic-like polynomial curve p with patch p + l p' for l in [1, 2]: the flat regression curve keeps
        // its length and its curvature κ; checked by integrating κ independently.
        let p = |t: f64| {
            [Vec3::new(t, t * t, t * t * t), Vec3::new(1.0, 2.0 * t, 3.0 * t * t), Vec3::new(0.0, 2.0, 6.0 * t)]
        };
        let edge = |l: f64| {
            // Bernstein coefficients of p + l p' from values by interpolation at four nodes.
            let nodes = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
            let basis = |t: f64| {
                let u = 1.0 - t;
                [u * u * u, 3.0 * t * u * u, 3.0 * t * t * u, t * t * t]
            };
            let m = nalgebra::Matrix4::from_fn(|i, j| basis(nodes[i])[j]);
            let f = nalgebra::Matrix4x3::from_fn(|i, j| (p(nodes[i])[0] + p(nodes[i])[1] * l)[j]);
            let c = m.try_inverse().expect("regular") * f;
            (0..4).map(|i| (Vec3::new(c[(i, 0)], c[(i, 1)], c[(i, 2)]), 1.0)).collect::<Vec<_>>()
        };
        let s = ruled(&edge(1.0), &edge(2.0), 3);
        let d = Development::new(&s, 1.0).expect("a development");
        assert!(worst_strain(&d) < 1e-10);
        let mut turn = 0.0;
        let n = 4000;
        for i in 0..n {
            let j = p((f64::from(i) + 0.5) / f64::from(n));
            turn += j[1].cross(&j[2]).norm() / j[1].norm_squared() / f64::from(n);
        }
        let measured = (d.directrix(1.0).1 - d.directrix(0.0).1).abs();
        assert!((measured - turn).abs() < 1e-6);
    }

    #[test]
    fn flat_tangents_match_differences() {
        let s = ruled(&quarter(100.0, 0.0), &quarter(40.0, 120.0), 2);
        let d = Development::new(&s, 1.0).expect("a development");
        let (t, r, dt, dr, h) = (0.37, 0.2, 0.8, -0.5, 1e-6);
        let fd = (d.map(t + h * dt, r + h * dr) - d.map(t - h * dt, r - h * dr)) / (2.0 * h);
        assert!((fd - d.tangent(t, r, dt, dr)).norm() < 1e-5);
    }

    /// What lies beside a cylinder is a cylinder of another radius: its arc grows on the one side and shrinks on the other.
    #[test]
    fn a_surface_beside_a_cylinder_is_as_long_as_its_own_arc() {
        let (radius, distance) = (80.0, 3.0);
        let s = ruled(&quarter(radius, 0.0), &quarter(radius, 50.0), 2);
        let arc = |offset: f64| {
            let d = Development::offset(&s, 1.0, offset).expect("a development");
            (d.map(1.0, 0.5) - d.map(0.0, 0.5)).norm()
        };
        let mut found = [arc(distance), arc(-distance)];
        found.sort_by(f64::total_cmp);
        let quarter = std::f64::consts::FRAC_PI_2;
        for (length, r) in found.into_iter().zip([radius - distance, radius + distance]) {
            assert!((length - quarter * r).abs() < 1e-9 * r, "{length} {r}");
        }
        assert!((arc(0.0) - quarter * radius).abs() < 1e-9 * radius);
    }
}
