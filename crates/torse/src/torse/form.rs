//! Developable surfaces in exact forms: a profile with conjugate rulings, a curve in dual space, a general cylinder.
//! The forms and their formulae: docs/algorithms/torses.md, after \[PW99\].

use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::SAME_PARAMETER;

/// Torse over a plane profile; planes, cylinders and cones included (mixed-curvature specification, C1).
///
/// In the coordinates of `frame` (mm): `x = t + y a(t)`, `z = f(t) + y g(t)`, `g(t) = beta + ∫_{t0}^t f' a' ds` with
/// `t0` the start of the domain. Exactly developable for any `f`, `a`: `c = (t, 0, f)`, `e = (a, 1, g)`, `e' = a' c'`.
/// Normal `n = (−f', a f' − g, 1)`, `h = n·c = f − t f'`, `n' = f'' m` with `m = (−1, a, 0)`, `m·c = −t`.
/// Regular where `1 + y a'(t) > 0`; inflections `f'' = 0` are regular rulings.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimalTorse {
    /// Local coordinates; y is the ruling coordinate.
    pub frame: Frame,
    /// Components `(f, a)`, cubic.
    profile: Curve<2>,
    /// Value of g at the start of the domain.
    beta: f64,
    /// Knots inside the domain, ends included, with the values of g there.
    slopes: Vec<(f64, f64)>,
}

/// Torse as the envelope of the planes `n(t)·X = h(t)` (seed 000; certificate specification).
///
/// Regular where `N''·X − H''` has one sign; inflections are not representable.
#[derive(Clone, Debug, PartialEq)]
pub struct DualTorse {
    /// Components `(n_x, n_y, n_z, h)`, cubic, world coordinates in mm, n not normalised.
    pub planes: Curve<4>,
}

/// General cylinder over a parametric profile, which may turn through any angle and inflect: the cross-section of an
/// extrusion, such as an omega profile.
///
/// In the coordinates of `frame` (mm): `(x(t), y, z(t))`. With the speed `r² = x'² + z'²`, the unit normal
/// `n = (−z', 0, x')/r`, the unit tangent turned back `m = −(x', 0, z')/r` and `ω = (x' z'' − z' x'')/r²`: `n' = ω m`,
/// `m' = −ω n`, `h = n·c`, `k = m·c`, `k' = −ω h − r` (docs/algorithms/torses.md; our own). Regular wherever the speed is not
/// zero; inflections are `ω = 0`. Not guaranteed: that the profile has a speed everywhere, and does not cross itself.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderTorse {
    /// Local coordinates; y is the ruling's direction.
    pub frame: Frame,
    /// Components `(x, z)`, cubic, mm.
    pub profile: Curve<2>,
}

/// A developable surface with rulings `t = const`.
#[derive(Clone, Debug, PartialEq)]
pub enum Torse {
    /// Over a plane profile.
    Primal(PrimalTorse),
    /// Envelope of planes.
    Dual(DualTorse),
    /// General cylinder.
    Cylinder(CylinderTorse),
}

/// One ruling with its tangent plane. Which way both point says nothing of the way that the parameter goes: see
/// [`G1Element`](super::g1_element::G1Element).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ruling {
    /// A point of the ruling.
    pub point: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Unit normal of the tangent plane.
    pub normal: Vec3,
}

impl Ruling {
    /// The point at the signed distance `r` from `point`.
    pub fn at(&self, r: f64) -> Vec3 {
        self.point + self.direction * r
    }
}

/// What a panel is, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PanelKind {
    /// All planes equal.
    Plane,
    /// Parallel rulings.
    Cylinder,
    /// Rulings through one point.
    Cone,
    /// General developable.
    Torse,
    /// Ruled, but in general not developable.
    Ruled,
}

impl PanelKind {
    /// Lower-case name used in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Torse => "torse",
            Self::Ruled => "ruled",
        }
    }
}

/// `∫ f' a' ds` from `a` to `b` inside one span: three Gauss nodes are exact for degree 5.
fn slope_between(profile: &Curve<2>, a: f64, b: f64) -> f64 {
    const NODE: f64 = 0.774_596_669_241_483_4;
    let (m, h) = (0.5 * (a + b), 0.5 * (b - a));
    let product = |x: f64| {
        let d = profile.jet(m + h * x)[1];
        d[0] * d[1]
    };
    h * (5.0 * product(-NODE) + 8.0 * product(0.0) + 5.0 * product(NODE)) / 9.0
}

impl PrimalTorse {
    /// Torse over a profile with components `(f, a)`, cubic; `beta` is the value of g at the start of its domain.
    pub fn new(frame: Frame, profile: Curve<2>, beta: f64) -> Self {
        let mut g = beta;
        let breaks = profile.knots.breaks();
        let mut slopes = vec![(breaks[0], g)];
        for w in breaks.windows(2) {
            g += slope_between(&profile, w[0], w[1]);
            slopes.push((w[1], g));
        }
        Self { frame, profile, beta, slopes }
    }

    /// Components `(f, a)`, cubic.
    pub fn profile(&self) -> &Curve<2> {
        &self.profile
    }

    /// Value of g at the start of the domain.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// `(f, f', f'', a, a', g)` at `t`; `g` by exact Gauss quadrature of the piecewise quartic `f' a'`.
    pub(crate) fn functions(&self, t: f64) -> [f64; 6] {
        let j = self.profile.jet(t);
        [j[0][0], j[1][0], j[2][0], j[0][1], j[1][1], self.slope(t)]
    }

    /// `g(t) = beta + ∫ f' a'`.
    fn slope(&self, t: f64) -> f64 {
        let inner = &self.slopes[1..self.slopes.len() - 1];
        let (from, g) = self.slopes[inner.partition_point(|k| k.0 <= t)];
        g + slope_between(&self.profile, from, t)
    }
}

/// Point, unit tangent and unit normal of a cylinder's profile, its speed and its turn ω per parameter.
struct ProfileJet {
    point: Vec3,
    tangent: Vec3,
    normal: Vec3,
    speed: f64,
    turn: f64,
}

impl CylinderTorse {
    fn jet(&self, t: f64) -> ProfileJet {
        let j = self.profile.jet(t);
        let speed = j[1][0].hypot(j[1][1]);
        let (x, z) = (j[1][0] / speed, j[1][1] / speed);
        ProfileJet {
            point: Vec3::new(j[0][0], 0.0, j[0][1]),
            tangent: Vec3::new(x, 0.0, z),
            normal: Vec3::new(-z, 0.0, x),
            speed,
            turn: (x * j[2][1] - z * j[2][0]) / speed,
        }
    }
}

impl Torse {
    /// Parameter interval of the rulings.
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Primal(p) => p.profile.domain(),
            Self::Dual(d) => d.planes.domain(),
            Self::Cylinder(c) => c.profile.domain(),
        }
    }

    /// The part over `[a, b]`; beyond the domain the outermost polynomials go on. `None` where there is none.
    pub(crate) fn restricted(&self, a: f64, b: f64) -> Option<Self> {
        Some(match self {
            Self::Primal(p) => Self::Primal(PrimalTorse::new(p.frame, p.profile.extended(a, b).ok()?, p.slope(a))),
            Self::Dual(d) => Self::Dual(DualTorse { planes: d.planes.extended(a, b).ok()? }),
            Self::Cylinder(c) => {
                Self::Cylinder(CylinderTorse { frame: c.frame, profile: c.profile.extended(a, b).ok()? })
            }
        })
    }

    /// Ends of the polynomial pieces.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Primal(p) => p.profile.knots.breaks(),
            Self::Dual(d) => d.planes.knots.breaks(),
            Self::Cylinder(c) => c.profile.knots.breaks(),
        }
    }

    /// Ruling and tangent plane at `t`. For a dual torse the point is the one nearest the origin.
    pub fn ruling(&self, t: f64) -> Ruling {
        match self {
            Self::Primal(p) => {
                let [f, f1, _, a, _, g] = p.functions(t);
                Ruling {
                    point: p.frame.to_world(&Vec3::new(t, 0.0, f)),
                    direction: p.frame.vector_to_world(&Vec3::new(a, 1.0, g)).normalize(),
                    normal: p.frame.vector_to_world(&Vec3::new(-f1, a * f1 - g, 1.0)).normalize(),
                }
            }
            Self::Dual(d) => {
                let j = d.planes.jet(t);
                let (n, m) = (Vec3::new(j[0][0], j[0][1], j[0][2]), Vec3::new(j[1][0], j[1][1], j[1][2]));
                let e = n.cross(&m);
                let point = (m.cross(&e) * j[0][3] + e.cross(&n) * j[1][3]) / e.norm_squared();
                Ruling { point, direction: e.normalize(), normal: n.normalize() }
            }
            Self::Cylinder(c) => {
                let j = c.jet(t);
                Ruling {
                    point: c.frame.to_world(&j.point),
                    direction: c.frame.y,
                    normal: c.frame.vector_to_world(&j.normal),
                }
            }
        }
    }

    /// Foot function of `x` and its t-derivative: zero where the ruling passes through the foot of the
    /// perpendicular from `x` to the torse. Exact form `|n|²(m·X − k) − (n·X − h)(n·m)`.
    pub(crate) fn foot_function(&self, x: &Vec3, t: f64) -> (f64, f64) {
        match self {
            Self::Primal(p) => {
                let q = p.frame.to_local(x);
                let [f, f1, f2, a, a1, g] = p.functions(t);
                let n = Vec3::new(-f1, a * f1 - g, 1.0);
                let m = Vec3::new(-1.0, a, 0.0);
                let dm = Vec3::new(0.0, a1, 0.0);
                let (mu, dmu) = (m.dot(&q) + t, dm.dot(&q) + 1.0);
                let phi = n.dot(&q) - (f - t * f1);
                let (nn, nm) = (n.norm_squared(), n.dot(&m));
                let value = nn * mu - phi * nm;
                let slope = 2.0 * f2 * nm * mu + nn * dmu - f2 * mu * nm - phi * (f2 * m.dot(&m) + n.dot(&dm));
                (value, slope)
            }
            Self::Dual(d) => {
                let j = d.planes.jet(t);
                let v = j.map(|r| Vec3::new(r[0], r[1], r[2]));
                let (mu, dmu) = (v[1].dot(x) - j[1][3], v[2].dot(x) - j[2][3]);
                let phi = v[0].dot(x) - j[0][3];
                let (nn, nm) = (v[0].norm_squared(), v[0].dot(&v[1]));
                let value = nn * mu - phi * nm;
                let slope = nm * mu + nn * dmu - phi * (v[1].norm_squared() + v[0].dot(&v[2]));
                (value, slope)
            }
            Self::Cylinder(c) => {
                let j = c.jet(t);
                let d = c.frame.to_local(x) - j.point;
                (-j.tangent.dot(&d), j.speed - j.turn * j.normal.dot(&d))
            }
        }
    }

    /// Signed distance from `x` to the tangent plane at `t` (the distance to the torse when `t` is the foot).
    pub fn plane_distance(&self, x: &Vec3, t: f64) -> f64 {
        let r = self.ruling(t);
        r.normal.dot(&(x - r.point))
    }

    /// Foot parameter of `x` by Newton steps from `guess`, inside the domain (up to a hair). `None` if the steps
    /// leave the domain or do not settle.
    pub fn foot(&self, x: &Vec3, guess: f64) -> Option<f64> {
        self.foot_within(x, guess, SAME_PARAMETER)
    }

    /// As [`Torse::foot`], on polynomials that go on beyond both ends of the domain by a share of it.
    pub(crate) fn foot_within(&self, x: &Vec3, guess: f64, beyond: f64) -> Option<f64> {
        // Steps below this share of the domain are rounding, …
        const STILL: f64 = 1e-14;
        // … which is larger where the regression curve is near: such feet are as good as they get …
        const SETTLED: f64 = 1e-12;
        // … and so are those whose foot function is only what its own terms leave when they are rounded, as beside the tip of a cone.
        const ROUNDING: f64 = 32.0 * f64::EPSILON;
        let (t0, t1) = self.domain();
        let width = t1 - t0;
        let (lo, hi) = (t0 - beyond * width, t1 + beyond * width);
        let mut t = guess.clamp(lo, hi);
        for _ in 0..30 {
            let (e, d) = self.foot_function(x, t);
            if d == 0.0 || !d.is_finite() {
                return None;
            }
            let step = (-e / d).clamp(-0.2 * width, 0.2 * width);
            let next = t + step;
            if !(next >= lo && next <= hi) {
                return None;
            }
            t = next;
            if step.abs() <= STILL * width {
                return Some(t);
            }
        }
        let (e, d) = self.foot_function(x, t);
        ((e / d).abs() < SETTLED * width || e.abs() <= ROUNDING * self.foot_size(x, t)).then_some(t)
    }

    /// Size of the products of which the foot function is a sum; derivatives are differences of coefficients over spans.
    fn foot_size(&self, x: &Vec3, t: f64) -> f64 {
        match self {
            Self::Primal(p) => {
                let [_, f1, _, a, _, g] = p.functions(t);
                let (n, m) = (Vec3::new(-f1, a * f1 - g, 1.0), Vec3::new(-1.0, a, 0.0));
                n.norm_squared() * m.norm() * (p.frame.to_local(x).norm() + t.abs())
            }
            Self::Dual(d) => {
                let j = d.planes.jet(t);
                let n = Vec3::new(j[0][0], j[0][1], j[0][2]).norm();
                let (knots, (a, b)) = (&d.planes.knots, self.domain());
                let spans = (knots.breaks().len() - 1) as f64;
                let rate = knots.degree() as f64 * spans / (b - a);
                n.powi(2) * rate * (n * x.norm() + j[0][3].abs())
            }
            Self::Cylinder(c) => c.frame.to_local(x).norm() + c.jet(t).point.norm(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_torse() -> Torse {
        let profile = Curve::new(
            3,
            vec![-1., -1., -1., -1., 0., 1., 1., 1., 1.],
            vec![[0.3, 0.1], [0.1, 0.0], [-0.2, 0.2], [0.3, 0.1], [0.5, -0.1]],
        )
        .expect("profile");
        Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.2))
    }

    #[test]
    fn tangent_plane_is_constant_along_a_ruling() {
        let Torse::Primal(p) = sample_torse() else { unreachable!() };
        let point = |t: f64, y: f64| {
            let [f, _, _, a, _, g] = p.functions(t);
            Vec3::new(t + y * a, y, f + y * g)
        };
        for t in [-0.7, 0.2, 0.6] {
            let r = Torse::Primal(p.clone()).ruling(t);
            for y in [-0.5, 0.0, 0.8] {
                let d = (point(t + 1e-6, y) - point(t - 1e-6, y)) / 2e-6;
                assert!(d.dot(&r.normal).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn foot_function_has_the_stated_slope_and_root() {
        let profile =
            Curve::new(3, vec![-1., -1., -1., -1., 1., 1., 1., 1.], vec![[0., 0.], [2., 1.], [-1., 2.], [1., 3.]]);
        let cylinder = CylinderTorse { frame: Frame::world(), profile: profile.expect("profile") };
        for torse in [sample_torse(), Torse::Cylinder(cylinder)] {
            let r = torse.ruling(0.25);
            let x = r.point + r.direction * 0.3 + r.normal * 0.01;
            let t = torse.foot(&x, 0.1).expect("a foot");
            assert!((t - 0.25).abs() < 1e-12);
            assert!((torse.plane_distance(&x, t) - 0.01).abs() < 1e-12);
            let h = 1e-6;
            let d = (torse.foot_function(&x, 0.1 + h).0 - torse.foot_function(&x, 0.1 - h).0) / (2.0 * h);
            assert!((d - torse.foot_function(&x, 0.1).1).abs() < 1e-7);
        }
    }
}
