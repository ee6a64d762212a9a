//! A torse made ready for many foot points: power form per span, local coordinates, no allocation per evaluation.

use crate::geom::{Frame, Vec3};
use crate::spline::pieces::{span_of, Pieces};
use crate::torse::form::Torse;

/// The fast form of a torse.
#[derive(Clone, Debug)]
pub(crate) enum PowerForm {
    /// `(f, a)` and the quintic pieces of g, in the coordinates of the frame.
    Primal {
        /// Local coordinates.
        frame: Frame,
        /// Profile and ruling slope.
        profile: Pieces<2>,
        /// Coefficients of g in powers of the distance from the span's start.
        slope: Vec<[f64; 6]>,
    },
    /// Profile of a cylinder, in the coordinates of the frame.
    Cylinder {
        /// Local coordinates.
        frame: Frame,
        /// Components `(x, z)`.
        profile: Pieces<2>,
    },
    /// Planes in world coordinates.
    Dual {
        /// Components of `(n, h)`.
        planes: Pieces<4>,
    },
}

/// Tangent plane `n·X = h` and its motion `n' = c m`, `h' = c k`, `m' = dm`, `k' = dk`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneJet {
    pub n: Vec3,
    pub h: f64,
    pub m: Vec3,
    pub k: f64,
    pub dm: Vec3,
    pub dk: f64,
    pub c: f64,
}

impl PlaneJet {
    /// Foot function `|n|²(m·q − k) − (n·q − h)(n·m)`.
    #[inline]
    pub fn foot_function(&self, q: &Vec3) -> f64 {
        let (mu, phi) = (self.m.dot(q) - self.k, self.n.dot(q) - self.h);
        self.n.norm_squared() * mu - phi * self.n.dot(&self.m)
    }
}

/// Antiderivative of `f' a'` on a span, as coefficients of degree 0..=5 (constant term 0), from the powers of f and a.
#[inline]
pub(crate) fn slope_integral(f: &[f64; 4], a: &[f64; 4]) -> [f64; 6] {
    let d = |c: &[f64; 4]| [c[1], 2.0 * c[2], 3.0 * c[3]];
    let (p, q) = (d(f), d(a));
    let mut out = [0.0; 6];
    for i in 0..3 {
        for j in 0..3 {
            out[i + j + 1] += p[i] * q[j];
        }
    }
    for (k, o) in out.iter_mut().enumerate().skip(2) {
        *o /= k as f64;
    }
    out
}

/// Value of a quintic in power form.
#[inline]
pub(crate) fn quintic(c: &[f64; 6], x: f64) -> f64 {
    c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))))
}

/// How far a torse is from being singular, in units of length; infinite where nothing threatens.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RegularityMargin {
    /// Radius of curvature across the ruling.
    pub bend_radius: f64,
    /// Distance along the ruling to the regression curve.
    pub clearance: f64,
}

impl RegularityMargin {
    /// What is kept of the room that the feet `points`, `feet` have: the wanted one, or nearly as much as there is.
    pub fn kept(self, power_form: &PowerForm, points: &[Vec3], feet: &[f64]) -> Self {
        // Share of the room at hand that steps may not use up.
        const KEPT: f64 = 0.8;
        // Share of the wanted room that they may not use up where it is at hand.
        const NEEDED: f64 = 0.4;
        let now = Self::least(power_form, points, feet);
        let kept = |wanted: f64, now: f64| wanted.min((KEPT * now).max(now.min(NEEDED * wanted)));
        Self { bend_radius: kept(self.bend_radius, now.bend_radius), clearance: kept(self.clearance, now.clearance) }
    }

    /// The least room at the feet of points.
    pub fn least(power_form: &PowerForm, points: &[Vec3], feet: &[f64]) -> Self {
        let most = Self { bend_radius: f64::INFINITY, clearance: f64::INFINITY };
        points.iter().zip(feet).map(|(q, &t)| power_form.margin(q, t)).fold(most, |least, now| Self {
            bend_radius: least.bend_radius.min(now.bend_radius),
            clearance: least.clearance.min(now.clearance),
        })
    }

    /// Whether a torse has this room at the foot `t` of `q`.
    pub fn granted(&self, power_form: &PowerForm, q: &Vec3, t: f64) -> bool {
        if self.bend_radius <= 0.0 && self.clearance <= 0.0 {
            return true;
        }
        let now = power_form.margin(q, t);
        now.bend_radius >= self.bend_radius && now.clearance >= self.clearance
    }

    /// The same in units of `unit`.
    pub fn scaled(self, unit: f64) -> Self {
        Self { bend_radius: self.bend_radius / unit, clearance: self.clearance / unit }
    }
}

/// The interval in which feet may lie while the fit is under way.
pub(crate) fn widened((lo, hi): (f64, f64)) -> (f64, f64) {
    const BEYOND: f64 = 0.15;
    (lo - BEYOND * (hi - lo), hi + BEYOND * (hi - lo))
}

impl PowerForm {
    /// The fast form of a torse whose splines are at most cubic; `None` otherwise.
    pub fn of(torse: &Torse) -> Option<Self> {
        match torse {
            Torse::Primal(p) => Some(Self::primal(p.frame, Pieces::of(p.profile())?, p.beta())),
            Torse::Dual(d) => Some(Self::Dual { planes: Pieces::of(&d.planes)? }),
            Torse::Cylinder(c) => Some(Self::Cylinder { frame: c.frame, profile: Pieces::of(&c.profile)? }),
        }
    }

    /// The primal form with `g = beta` at the start of the domain.
    pub fn primal(frame: Frame, profile: Pieces<2>, beta: f64) -> Self {
        let mut slope = Vec::with_capacity(profile.power.len());
        let mut start = beta;
        for (s, c) in profile.power.iter().enumerate() {
            let mut g = slope_integral(&c.map(|v| v[0]), &c.map(|v| v[1]));
            g[0] = start;
            start = quintic(&g, profile.breaks[s + 1] - profile.breaks[s]);
            slope.push(g);
        }
        Self::Primal { frame, profile, slope }
    }

    /// Parameter interval.
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Primal { profile, .. } | Self::Cylinder { profile, .. } => profile.domain(),
            Self::Dual { planes } => planes.domain(),
        }
    }

    /// Coordinates in which the other functions take points.
    #[inline]
    pub fn local(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Primal { frame, .. } | Self::Cylinder { frame, .. } => frame.to_local(x),
            Self::Dual { .. } => *x,
        }
    }

    /// `g(t)` of a primal torse, 0 for others.
    #[inline]
    pub fn slope(&self, t: f64) -> f64 {
        match self {
            Self::Primal { profile, slope, .. } => {
                let s = span_of(&profile.breaks, t);
                quintic(&slope[s], t - profile.breaks[s])
            }
            Self::Dual { .. } | Self::Cylinder { .. } => 0.0,
        }
    }

    /// Tangent plane and derivatives at `t`.
    #[inline(always)]
    pub fn jet(&self, t: f64) -> PlaneJet {
        match self {
            Self::Primal { profile, slope, .. } => {
                let s = span_of(&profile.breaks, t);
                let (u, c) = (t - profile.breaks[s], &profile.power[s]);
                let f = c[0][0] + u * (c[1][0] + u * (c[2][0] + u * c[3][0]));
                let f1 = c[1][0] + u * (2.0 * c[2][0] + u * 3.0 * c[3][0]);
                let f2 = 2.0 * c[2][0] + 6.0 * u * c[3][0];
                let a = c[0][1] + u * (c[1][1] + u * (c[2][1] + u * c[3][1]));
                let a1 = c[1][1] + u * (2.0 * c[2][1] + u * 3.0 * c[3][1]);
                let n = Vec3::new(-f1, a * f1 - quintic(&slope[s], u), 1.0);
                let m = Vec3::new(-1.0, a, 0.0);
                PlaneJet { n, h: f - t * f1, m, k: -t, dm: Vec3::new(0.0, a1, 0.0), dk: -1.0, c: f2 }
            }
            Self::Cylinder { profile, .. } => {
                let [p, p1, p2] = profile.jet(t);
                let speed = p1[0].hypot(p1[1]);
                let (x, z) = (p1[0] / speed, p1[1] / speed);
                let c = (x * p2[1] - z * p2[0]) / speed;
                let (n, m) = (Vec3::new(-z, 0.0, x), Vec3::new(-x, 0.0, -z));
                let h = x * p[1] - z * p[0];
                PlaneJet { n, h, m, k: -(x * p[0] + z * p[1]), dm: n * -c, dk: -c * h - speed, c }
            }
            Self::Dual { planes } => {
                let [p, p1, p2] = planes.jet(t);
                let v = |c: [f64; 4]| Vec3::new(c[0], c[1], c[2]);
                PlaneJet { n: v(p), h: p[3], m: v(p1), k: p1[3], dm: v(p2), dk: p2[3], c: 1.0 }
            }
        }
    }

    /// Parameter of the foot of the perpendicular from `q` near `guess`, by Newton steps on the exact foot equation;
    /// `None` if it does not settle inside `range`.
    pub fn foot(&self, q: &Vec3, guess: f64, range: (f64, f64)) -> Option<f64> {
        // Newton steps halve the digits left; this many allow for a poor guess.
        const STEPS: usize = 24;
        // Relative to the range: the error after a Newton step is about the square of the step.
        const SETTLED: f64 = 1e-7;
        let width = range.1 - range.0;
        let mut t = guess.clamp(range.0, range.1);
        let mut outside = 0;
        for _ in 0..STEPS {
            let (e, slope) = self.foot_function(q, t);
            let step = -e / slope;
            if !step.is_finite() {
                return None;
            }
            let step = step.clamp(-0.2 * width, 0.2 * width);
            let next = t + step;
            t = next.clamp(range.0, range.1);
            if step.abs() <= SETTLED * width {
                return Some(t);
            }
            if next != t {
                outside += 1;
                if outside > 2 {
                    return None;
                }
            }
        }
        None
    }

    /// The foot of `q` with the smallest distance among all that a table of the foot function shows; for the rare
    /// points for which the nearby guess fails.
    pub fn nearest_foot(&self, q: &Vec3) -> Option<f64> {
        self.nearest_foot_of(q, &self.plane_table())
    }

    /// The planes of the table that [`PowerForm::nearest_foot`] looks at: made once for many points.
    pub fn plane_table(&self) -> Vec<(f64, PlaneJet)> {
        let breaks = match self {
            Self::Primal { profile, .. } | Self::Cylinder { profile, .. } => &profile.breaks,
            Self::Dual { planes } => &planes.breaks,
        };
        table(breaks).map(|t| (t, self.jet(t))).collect()
    }

    /// See [`PowerForm::nearest_foot`].
    pub fn nearest_foot_of(&self, q: &Vec3, planes: &[(f64, PlaneJet)]) -> Option<f64> {
        let mut best: Option<(f64, f64)> = None;
        let mut before: Option<(f64, f64)> = None;
        for &(t, ref plane) in planes {
            let e = plane.foot_function(q);
            if let Some((s, f)) = before {
                if f * e <= 0.0 {
                    let middle = if f == e { t } else { s + (t - s) * f / (f - e) };
                    if let Some(root) = self.foot(q, middle, self.domain()) {
                        let d = self.distance(q, root).0.abs();
                        if best.is_none_or(|b| d < b.0) {
                            best = Some((d, root));
                        }
                    }
                }
            }
            before = Some((t, e));
        }
        best.map(|b| b.1)
    }

    /// Exact foot function `|n|²(m·q − k) − (n·q − h)(n·m)` and its derivative.
    #[inline]
    pub fn foot_function(&self, q: &Vec3, t: f64) -> (f64, f64) {
        let j = self.jet(t);
        let (mu, dmu) = (j.m.dot(q) - j.k, j.dm.dot(q) - j.dk);
        let phi = j.n.dot(q) - j.h;
        let (nn, nm) = (j.n.norm_squared(), j.n.dot(&j.m));
        let value = j.foot_function(q);
        let slope = j.c * nm * mu + nn * dmu - phi * (j.c * j.m.norm_squared() + j.n.dot(&j.dm));
        (value, slope)
    }

    /// Signed distance of `q` from the tangent plane at its foot `t`, and the regularity there: `1 + y a'` for a primal
    /// torse, `(N''·X − H'')/|N|` for a dual one, the speed of the profile for a cylinder, at the foot point.
    #[inline]
    pub fn distance(&self, q: &Vec3, t: f64) -> (f64, f64) {
        let j = self.jet(t);
        let norm = j.n.norm();
        let d = (j.n.dot(q) - j.h) / norm;
        let foot = q - j.n * (d / norm);
        let regular = j.dm.dot(&foot) - j.dk;
        (d, if matches!(self, Self::Dual { .. }) { regular / norm } else { regular })
    }

    /// At the foot `t` of `q`: radius of curvature across the ruling, and distance along it to the regression curve.
    pub fn margin(&self, q: &Vec3, t: f64) -> RegularityMargin {
        let j = self.jet(t);
        let nn = j.n.norm_squared();
        let foot = q - j.n * ((j.n.dot(q) - j.h) / nn);
        let regular = (j.dm.dot(&foot) - j.dk).abs();
        let nm = j.n.dot(&j.m);
        let across = j.c.abs() * (j.m.norm_squared() - nm * nm / nn);
        let ruling = j.n.cross(&j.m);
        RegularityMargin {
            bend_radius: nn.sqrt() * regular / across,
            clearance: regular * ruling.norm() / j.dm.dot(&ruling).abs(),
        }
    }

    /// First guesses of feet.
    pub fn guesses(&self) -> Guesses {
        match self {
            Self::Primal { profile, .. } => {
                let slopes = table(&profile.breaks).map(|t| (t, profile.jet(t)[0][1]));
                Guesses { rulings: Vec::new(), slopes: slopes.collect() }
            }
            Self::Cylinder { profile, .. } => {
                let point = |[x, z]: [f64; 2]| Vec3::new(x, 0.0, z);
                let rulings = table(&profile.breaks).map(|t| (t, point(profile.jet(t)[0]), Vec3::y()));
                Guesses { rulings: rulings.collect(), slopes: Vec::new() }
            }
            Self::Dual { planes } => {
                let rulings = table(&planes.breaks).filter_map(|t| {
                    let j = self.jet(t);
                    let e = j.n.cross(&j.m);
                    let point = (j.m.cross(&e) * j.h + e.cross(&j.n) * j.k) / e.norm_squared();
                    let direction = e.normalize();
                    (point.x.is_finite() && direction.x.is_finite()).then_some((t, point, direction))
                });
                Guesses { rulings: rulings.collect(), slopes: Vec::new() }
            }
        }
    }
}

/// Parameters of a table with three entries per span.
fn table(breaks: &[f64]) -> impl Iterator<Item = f64> {
    let (a, b) = (breaks[0], breaks[breaks.len() - 1]);
    let count = 3 * (breaks.len() - 1).max(4);
    (0..=count).map(move |i| a + (b - a) * i as f64 / count as f64)
}

/// Tables of a torse's rulings: `(t, point, unit direction)`, of a primal one `(t, a(t))`.
#[derive(Clone, Debug)]
pub(crate) struct Guesses {
    rulings: Vec<(f64, Vec3, Vec3)>,
    slopes: Vec<(f64, f64)>,
}

impl Guesses {
    /// First guess of the foot of `q`: the nearest ruling of the table; for a primal one the place
    /// where `x − t − y a(t)` falls through zero (regular there), the nearest to x if there are several.
    pub fn guess(&self, q: &Vec3) -> f64 {
        let mut best = (f64::INFINITY, q.x);
        for (t, point, direction) in &self.rulings {
            let v = q - point;
            let along = v.dot(direction);
            let d = v.norm_squared() - along * along;
            if d < best.0 {
                best = (d, *t);
            }
        }
        let mut before = (0.0, -1.0);
        for (t1, slope) in &self.slopes {
            let ((t0, g0), g1) = (before, q.x - t1 - q.y * slope);
            if g0 >= 0.0 && g1 <= 0.0 && g0 > g1 {
                let t = t0 + (t1 - t0) * g0 / (g0 - g1);
                if (t - q.x).abs() < best.0 {
                    best = ((t - q.x).abs(), t);
                }
            }
            before = (*t1, g1);
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;
    use crate::torse::form::PrimalTorse;

    #[test]
    fn fast_form_agrees_with_the_exact_one() {
        let knots = vec![-1., -1., -1., -1., 0., 1., 1., 1., 1.];
        let control = vec![[0.3, 0.1], [0.1, 0.0], [-0.2, 0.2], [0.3, 0.1], [0.5, -0.1]];
        let profile = Curve::new(3, knots, control).expect("profile");
        let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.2));
        let power_form = PowerForm::of(&torse).expect("cubic");
        let x = Vec3::new(0.2, 0.3, 0.4);
        for t in [-0.9, -0.1, 0.5, 1.0] {
            let (a, b) = (power_form.foot_function(&x, t), torse.foot_function(&x, t));
            assert!((a.0 - b.0).abs() < 1e-13 && (a.1 - b.1).abs() < 1e-12, "{a:?} {b:?}");
        }
        let t = power_form.foot(&x, 0.0, (-1.0, 1.0)).expect("foot");
        assert!((t - torse.foot(&x, 0.0).expect("foot")).abs() < 1e-12);
        assert!((power_form.distance(&x, t).0 - torse.plane_distance(&x, t)).abs() < 1e-13);
    }
}
