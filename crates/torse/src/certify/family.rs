//! A torse as its family of tangent planes, in the form that all kinds share and that proofs need.
//!
//! Planes `n(t)·X = h(t)` with `n' = σ m`, `h' = σ k`; ruling `n·X = h, m·X = k`. Dual torse: `σ = 1`, `m = n'`,
//! `k = h'`. Primal torse \[mixed, C1.4\] (frame coordinates): `n = (−f', a f' − g, 1)`, `h = f − t f'`, `m = (−1, a, 0)`,
//! `k = −t`, `σ = f''`: finite at inflections `f'' = 0`. Cylinder: n and m of unit length, σ the turn of its profile
//! ([`CylinderTorse`](crate::torse::form::CylinderTorse)). With `F = n·X − h`, `μ = m·X − k` the exact foot function is
//! `E(X, t) = |n|² μ − F (n·m)`, linear in `X`; where `E = 0`, `F/|n|` is the signed distance from `X` to the ruling.
//!
//! The frame of a primal torse or a cylinder consists of f64 numbers and is orthonormal only up to rounding. The torse is taken as
//! the image `o + R q` of its local form. Linear forms carry over exactly with `R⁻ᵀ`; local lengths times
//! [`Family::metric`] bound lengths in space.

mod cubic;
mod profile;

use self::cubic::{pieces, Cubic};
use self::profile::Profile;
use super::ruled::rough;
use super::vector::{add, cross, dot, exact, scale, V3};
use crate::geom::Vec3;
use crate::num::bernstein::Scalar;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::torse::form::Torse;

/// Frames less orthonormal than this (Frobenius norm of RᵀR − I) are refused: far above rounding, far below use.
const FRAME_ERROR_LIMIT: f64 = 1e-9;

/// Polynomial functions of one knot span, in powers of `x = (t − a)/(b − a) − ½`.
#[derive(Clone, Debug)]
enum Functions<S> {
    /// `f`, `a` cubic, `g` quintic.
    Primal { f: Cubic<S>, a: Cubic<S>, g: [S; 6] },
    /// `(n, h)` cubic.
    Dual { c: [Cubic<S>; 4] },
    /// Profile `(x, z)` of a cylinder, cubic.
    Cylinder { x: Cubic<S>, z: Cubic<S> },
}

/// One knot span.
#[derive(Clone, Debug)]
struct Span<S> {
    /// 1/(b − a).
    inverse: S,
    functions: Functions<S>,
}

/// Everything about the plane at one parameter (or over an interval of parameters). Vectors in world axes, positions
/// relative to [`Family::origin`]; scalars belong to the local metric.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane<S> {
    /// Normal n.
    pub n: V3<S>,
    /// Second linear form m, `n' = σ m`.
    pub m: V3<S>,
    /// m'.
    pub dm: V3<S>,
    /// σ.
    pub sigma: S,
    /// |n|².
    pub nn: S,
    /// n·m.
    pub nm: S,
    /// |m|².
    pub mm: S,
    /// n·m'.
    pub ndm: S,
    /// h.
    pub h: S,
    /// k.
    pub k: S,
    /// k'.
    pub dk: S,
}

impl<S: Scalar> Plane<S> {
    /// `F = n·X − h`.
    #[inline]
    pub fn f(&self, x: &V3<S>) -> S {
        dot(&self.n, x) - self.h
    }

    /// `μ = m·X − k`.
    #[inline]
    pub fn mu(&self, x: &V3<S>) -> S {
        dot(&self.m, x) - self.k
    }

    /// `M = |n|² m − (n·m) n`, the gradient of E.
    #[inline]
    pub fn gradient(&self) -> V3<S> {
        [
            self.nn * self.m[0] - self.nm * self.n[0],
            self.nn * self.m[1] - self.nm * self.n[1],
            self.nn * self.m[2] - self.nm * self.n[2],
        ]
    }

    /// `E = |n|² μ − F (n·m)`.
    #[inline]
    pub fn foot(&self, f: S, mu: S) -> S {
        self.nn * mu - f * self.nm
    }

    /// `E_t = σ (n·m) μ + |n|² μ_t − F (σ |m|² + n·m')`.
    #[inline]
    pub fn foot_slope(&self, f: S, mu: S, dmu: S) -> S {
        self.sigma * self.nm * mu + self.nn * dmu - f * (self.sigma * self.mm + self.ndm)
    }
}

/// Enclosures over an interval of parameters, for points near a given one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranges {
    /// σ over the interval.
    pub sigma: Interval,
    /// m' over the interval, world axes.
    pub dm: V3<Interval>,
    /// `m'·X − k'` over the interval at the given point, as one linear form.
    pub dmu: Interval,
}

/// Bernstein coefficients of both linear forms of the rulings, over an interval.
pub(super) struct Forms {
    /// n.
    pub n: [Vec<Interval>; 3],
    /// h, of the degree of n.
    pub h: Vec<Interval>,
    /// m.
    pub m: [Vec<Interval>; 3],
    /// k, of the degree of m.
    pub k: Vec<Interval>,
    /// How much longer both are than those of [`Plane`].
    pub scale: Interval,
}

/// A torse prepared for proofs.
#[derive(Clone, Debug)]
pub(super) struct Family {
    breaks: Vec<f64>,
    spans: Vec<Span<Interval>>,
    quick: Vec<Span<f64>>,
    primal: bool,
    /// Rows: images of the frame's axes as linear forms, `R⁻ᵀ`.
    axes: [V3<Interval>; 3],
    quick_axes: [V3<f64>; 3],
    /// Origin of positions.
    pub origin: Vec3,
    /// At least the largest factor by which the frame stretches or shrinks lengths, ≥ 1.
    pub metric: f64,
}

impl Family {
    /// As [`Family::about`] the origin of the model.
    #[cfg(test)]
    pub fn new(torse: &Torse) -> Option<Self> {
        Self::about(torse, &Vec3::zeros())
    }

    /// Prepares a torse, with positions relative to a given place where it has no frame of its own. Enclosures over intervals of
    /// parameters widen with the distance from that place: they say nothing of a panel far from it, nor of the tip of a cone
    /// beside it. `None` when the torse is not a C¹ spline of degree at most three or its frame is not orthonormal.
    pub fn about(torse: &Torse, place: &Vec3) -> Option<Self> {
        let knots = match torse {
            Torse::Primal(p) => &p.profile().knots,
            Torse::Dual(d) => &d.planes.knots,
            Torse::Cylinder(c) => &c.profile.knots,
        };
        let (t0, t1) = knots.domain();
        let degree = knots.degree();
        let smooth = knots.distinct().into_iter().all(|(t, m)| t <= t0 || t >= t1 || m < degree);
        if degree > 3 || !smooth {
            return None;
        }
        let breaks = knots.breaks();
        let mut spans = Vec::with_capacity(breaks.len());
        let (mut axes, mut metric) = ([[Interval::ZERO; 3]; 3], 1.0f64);
        let origin;
        match torse {
            Torse::Primal(p) => {
                let mut g = Interval::point(p.beta());
                let profile: Vec<[Interval; 2]> = p.profile().control.iter().map(|c| c.map(Interval::point)).collect();
                for w in breaks.windows(2) {
                    let [f, a] = pieces(knots, &profile, w[0], w[1]);
                    let inverse = Interval::ONE / (Interval::point(w[1]) - Interval::point(w[0]));
                    let (span, end) = primal_span(f, a, g, inverse);
                    spans.push(span);
                    g = end;
                }
                origin = p.frame.origin;
                (axes, metric) = frame_forms(&[p.frame.x, p.frame.y, p.frame.z])?;
            }
            Torse::Dual(d) => {
                origin = *place;
                let moved = exact::<Interval>(place);
                let planes: Vec<[Interval; 4]> = d.planes.control.iter().map(|c| about(c, &moved)).collect();
                for w in breaks.windows(2) {
                    let inverse = Interval::ONE / (Interval::point(w[1]) - Interval::point(w[0]));
                    let c = pieces(knots, &planes, w[0], w[1]);
                    spans.push(Span { inverse, functions: Functions::Dual { c } });
                }
            }
            Torse::Cylinder(c) => {
                let profile: Vec<[Interval; 2]> = c.profile.control.iter().map(|c| c.map(Interval::point)).collect();
                for w in breaks.windows(2) {
                    let inverse = Interval::ONE / (Interval::point(w[1]) - Interval::point(w[0]));
                    let [x, z] = pieces(knots, &profile, w[0], w[1]);
                    spans.push(Span { inverse, functions: Functions::Cylinder { x, z } });
                }
                origin = c.frame.origin;
                (axes, metric) = frame_forms(&[c.frame.x, c.frame.y, c.frame.z])?;
            }
        }
        let quick = spans.iter().map(Span::middle).collect();
        let quick_axes = axes.map(|r| r.map(Interval::mid));
        Some(Self { breaks, spans, quick, primal: matches!(torse, Torse::Primal(_)), axes, quick_axes, origin, metric })
    }

    /// Parameter interval.
    pub fn domain(&self) -> (f64, f64) {
        (self.breaks[0], self.breaks[self.breaks.len() - 1])
    }

    /// Index of the span holding `t`; the ends of the domain belong to the outermost spans.
    #[inline]
    fn span(&self, t: f64) -> usize {
        let inner = &self.breaks[1..self.breaks.len() - 1];
        inner.partition_point(|&b| b <= t)
    }

    /// The plane at `t`, in f64.
    #[inline]
    pub fn quick(&self, t: f64) -> Plane<f64> {
        let i = self.span(t);
        let s = &self.quick[i];
        let x = (t - self.breaks[i]) * s.inverse - 0.5;
        s.plane(x, t, &self.quick_axes)
    }

    /// The plane at `t`, enclosed.
    #[inline]
    pub fn at(&self, t: f64) -> Plane<Interval> {
        self.on_span(self.span(t), Interval::point(t))
    }

    /// The planes over an interval of parameters inside the domain, without regard to dependencies: for coarse bounds.
    pub fn over(&self, t: Interval) -> Plane<Interval> {
        let (first, last) = (self.span(t.lo), self.span(t.hi));
        let mut out = self.on_span(first, self.clip(first, t));
        for i in first + 1..=last {
            out = out.hull(&self.on_span(i, self.clip(i, t)));
        }
        out
    }

    fn clip(&self, i: usize, t: Interval) -> Interval {
        Interval { lo: t.lo.max(self.breaks[i]), hi: t.hi.min(self.breaks[i + 1]).max(t.lo.max(self.breaks[i])) }
    }

    fn on_span(&self, i: usize, t: Interval) -> Plane<Interval> {
        let s = &self.spans[i];
        let x = (t - Interval::point(self.breaks[i])) * s.inverse - Interval::point(0.5);
        s.plane(x, t, &self.axes)
    }

    /// The planes along a curve `t(s)` inside the domain, with derivatives in s; and how [`rough`] they are.
    pub fn along_curve(&self, t: Jet) -> (Plane<Jet>, f64) {
        let (first, last) = (self.span(t.v.lo), self.span(t.v.hi));
        let axes = self.axes.map(|r| r.map(Jet::constant));
        let piece = |i: usize| {
            let span = self.spans[i].lifted();
            let t = Jet { v: self.clip(i, t.v), ..t };
            let x = (t - Jet::from(self.breaks[i])) * span.inverse - Jet::from(0.5);
            span.plane(x, t, &axes)
        };
        let hull = |p: Plane<Jet>, i: usize| p.hull(&piece(i));
        ((first + 1..=last).fold(piece(first), hull), rough(&self.breaks, first..=last, t))
    }

    /// Enclosures over `t` (inside the domain) of σ and of m' with `m'·x − k'`; `x` relative to the origin.
    pub fn ranges(&self, t: Interval, x: &V3<Interval>) -> Ranges {
        let (first, last) = (self.span(t.lo), self.span(t.hi));
        let y = if self.primal { dot(&self.axes[1], x) } else { Interval::ZERO };
        let mut out: Option<Ranges> = None;
        for i in first..=last {
            let s = &self.spans[i];
            let c = self.clip(i, t);
            let local =
                |t: f64| (Interval::point(t) - Interval::point(self.breaks[i])) * s.inverse - Interval::point(0.5);
            let (lo, hi) = (local(c.lo), local(c.hi));
            let piece = match &s.functions {
                Functions::Primal { f, a, .. } => {
                    let sigma = f.bend(lo).hull(f.bend(hi));
                    let middle = (lo + hi).scale_exact(0.5);
                    let reach = Interval::symmetric((hi - lo).scale_exact(0.5).mag());
                    // In powers of x − middle, with the slope in x.
                    let [e, g, h] = a.first;
                    let a1 = e + middle * (g + middle * h) + reach * (g + h * 2.0 * (middle + reach));
                    Ranges { sigma, dm: scale(&self.axes[1], a1), dmu: a1 * y + Interval::ONE }
                }
                Functions::Dual { c } => {
                    let second = |x: Interval| [0, 1, 2, 3].map(|d: usize| c[d].bend(x));
                    let (p, q) = (second(lo), second(hi));
                    let form = |v: &[Interval; 4]| v[0] * x[0] + v[1] * x[1] + v[2] * x[2] - v[3];
                    Ranges {
                        sigma: Interval::ONE,
                        dm: [0, 1, 2].map(|d| p[d].hull(q[d])),
                        dmu: form(&p).hull(form(&q)),
                    }
                }
                Functions::Cylinder { x: px, z: pz } => {
                    let at = lo.hull(hi);
                    let p = Profile::at(px, pz, at);
                    // m'·X − k' = r − ω F.
                    let off = [dot(&self.axes[0], x) - p.point[0], dot(&self.axes[2], x) - p.point[1]];
                    let height = p.tangent[0] * off[1] - p.tangent[1] * off[0];
                    Ranges { sigma: p.turn, dm: scale(&p.normal(&self.axes), -p.turn), dmu: p.speed - p.turn * height }
                }
            };
            out = Some(match out {
                None => piece,
                Some(o) => Ranges {
                    sigma: o.sigma.hull(piece.sigma),
                    dm: super::vector::hull(&o.dm, &piece.dm),
                    dmu: o.dmu.hull(piece.dmu),
                },
            });
        }
        out.unwrap_or(Ranges { sigma: Interval::EVERYTHING, dm: [Interval::EVERYTHING; 3], dmu: Interval::EVERYTHING })
    }

    /// Knots, ends of the domain included.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Bernstein coefficients over `[a, b]`, inside one span, of n (world axes), h, m (world axes), k.
    pub fn bernstein(&self, a: f64, b: f64) -> Forms {
        use crate::num::bernstein::{difference, from_powers, product, scaled, with_degree};
        let i = self.span(0.5 * (a + b));
        let s = &self.spans[i];
        let start = Interval::point(self.breaks[i]);
        let place = |t: f64| (Interval::point(t) - start) * s.inverse - Interval::point(0.5);
        let (x0, x1) = (place(a), place(b));
        let over = |c: &[Interval]| from_powers(c, x0, x1);
        match &s.functions {
            Functions::Primal { f, a: ruling, g } => {
                let (f1, f, r, g) = (over(&f.first), over(&f.value), over(&ruling.value), over(g));
                let t = [Interval::point(a), Interval::point(b)];
                let ny = difference(&product(&r, &f1), &g);
                let (nx, one) = (with_degree(&scaled(&f1, -Interval::ONE), 5), vec![Interval::ONE; 6]);
                let world = |x: &[Interval], y: &[Interval], z: &[Interval], d: usize| -> Vec<Interval> {
                    let [ex, ey, ez] = &self.axes;
                    (0..x.len()).map(|i| x[i] * ex[d] + y[i] * ey[d] + z[i] * ez[d]).collect()
                };
                let (mx, zero) = (vec![-Interval::ONE; 4], vec![Interval::ZERO; 4]);
                Forms {
                    n: [0, 1, 2].map(|d| world(&nx, &ny, &one, d)),
                    h: with_degree(&difference(&f, &product(&t, &f1)), 5),
                    m: [0, 1, 2].map(|d| world(&mx, &r, &zero, d)),
                    k: with_degree(&scaled(&t, -Interval::ONE), 3),
                    scale: Interval::ONE,
                }
            }
            Functions::Dual { c } => {
                let [n0, n1, n2, h] = [0, 1, 2, 3].map(|d: usize| over(&c[d].value));
                let [m0, m1, m2, k] = [0, 1, 2, 3].map(|d: usize| over(&c[d].first));
                Forms { n: [n0, n1, n2], h, m: [m0, m1, m2], k, scale: Interval::ONE }
            }
            Functions::Cylinder { x, z } => {
                let ([px, pz], [tx, tz]) = ([over(&x.value), over(&z.value)], [over(&x.first), over(&z.first)]);
                let sum = |a: &[Interval], b: &[Interval]| crate::num::bernstein::sum(a, b);
                let world = |x: &[Interval], z: &[Interval], d: usize| -> Vec<Interval> {
                    let of_axes = x.iter().zip(z).map(|(x, z)| *x * self.axes[0][d] + *z * self.axes[2][d]);
                    with_degree(&of_axes.collect::<Vec<_>>(), 5)
                };
                let minus = |a: &[Interval]| scaled(a, -Interval::ONE);
                let speed = sum(&product(&tx, &tx), &product(&tz, &tz));
                Forms {
                    n: [0, 1, 2].map(|d| world(&minus(&tz), &tx, d)),
                    h: difference(&product(&tx, &pz), &product(&tz, &px)),
                    m: [0, 1, 2].map(|d| world(&minus(&tx), &minus(&tz), d)),
                    k: minus(&sum(&product(&tx, &px), &product(&tz, &pz))),
                    scale: crate::num::bernstein::hull(&speed).sqrt(),
                }
            }
        }
    }

    /// Foot function and slope at `x` (relative to the origin), in f64.
    #[inline]
    pub fn quick_foot(&self, x: &V3<f64>, t: f64) -> (f64, f64) {
        let p = self.quick(t);
        let (f, mu) = (p.f(x), p.mu(x));
        (p.foot(f, mu), p.foot_slope(f, mu, dot(&p.dm, x) - p.dk))
    }

    /// Foot parameter near `guess` by Newton steps, in f64; `None` when they leave the domain or do not settle.
    pub fn newton(&self, x: &V3<f64>, guess: f64) -> Option<f64> {
        // Steps stop once they are at the level of rounding; quadratic convergence needs few.
        const STEPS: usize = 12;
        const SETTLED: f64 = 1e-13;
        // Steps below this share of the domain that no longer shrink are rounding too, where feet are ill-conditioned.
        const STALLED: f64 = 1e-9;
        let (t0, t1) = self.domain();
        let width = t1 - t0;
        let mut t = guess.clamp(t0, t1);
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let (e, d) = self.quick_foot(x, t);
            let step = -e / d;
            if !step.is_finite() {
                return None;
            }
            let next = t + step.clamp(-0.2 * width, 0.2 * width);
            if !(next >= t0 - 0.05 * width && next <= t1 + 0.05 * width) {
                return None;
            }
            t = next.clamp(t0, t1);
            let size = step.abs();
            if size <= SETTLED * width || (size <= STALLED * width && size >= last) {
                return ((t - next).abs() <= STALLED * width).then_some(t);
            }
            last = size;
        }
        None
    }

    /// Foot parameter of the nearest ruling among all sign changes seen from `samples` places, in f64.
    pub fn search(&self, x: &V3<f64>, samples: usize) -> Option<f64> {
        let (t0, t1) = self.domain();
        let place = |i: usize| t0 + (t1 - t0) * i as f64 / samples as f64;
        let mut best: Option<(f64, f64)> = None;
        let mut before = self.quick_foot(x, t0).0;
        for i in 1..=samples {
            let now = self.quick_foot(x, place(i)).0;
            if (before <= 0.0) != (now <= 0.0) {
                let (mut a, mut b) = (place(i - 1), place(i));
                for _ in 0..20 {
                    let m = 0.5 * (a + b);
                    if (self.quick_foot(x, m).0 <= 0.0) == (before <= 0.0) {
                        a = m;
                    } else {
                        b = m;
                    }
                }
                if let Some(t) = self.newton(x, 0.5 * (a + b)) {
                    let p = self.quick(t);
                    let d = (p.f(x) / p.nn.sqrt()).abs();
                    if best.is_none_or(|(_, e)| d < e) {
                        best = Some((t, d));
                    }
                }
            }
            before = now;
        }
        best.map(|(t, _)| t)
    }

    /// `n × m`, the direction of the ruling (not of unit length).
    pub fn direction<S: Scalar>(p: &Plane<S>) -> V3<S> {
        cross(&p.n, &p.m)
    }
}

/// Scalars that can be hulled.
pub(super) trait Hull: Copy {
    /// Smallest enclosure of both.
    fn with(self, o: Self) -> Self;
}

impl Hull for Interval {
    fn with(self, o: Self) -> Self {
        self.hull(o)
    }
}

impl Hull for Jet {
    fn with(self, o: Self) -> Self {
        self.hull(o)
    }
}

impl<S: Hull> Plane<S> {
    fn hull(&self, o: &Self) -> Self {
        let three = |a: &V3<S>, b: &V3<S>| [a[0].with(b[0]), a[1].with(b[1]), a[2].with(b[2])];
        Self {
            n: three(&self.n, &o.n),
            m: three(&self.m, &o.m),
            dm: three(&self.dm, &o.dm),
            sigma: self.sigma.with(o.sigma),
            nn: self.nn.with(o.nn),
            nm: self.nm.with(o.nm),
            mm: self.mm.with(o.mm),
            ndm: self.ndm.with(o.ndm),
            h: self.h.with(o.h),
            k: self.k.with(o.k),
            dk: self.dk.with(o.dk),
        }
    }
}

impl Span<Interval> {
    fn middle(&self) -> Span<f64> {
        self.map(Interval::mid)
    }

    fn lifted(&self) -> Span<Jet> {
        self.map(Jet::constant)
    }

    fn map<S>(&self, f: impl Fn(Interval) -> S + Copy) -> Span<S> {
        let functions = match &self.functions {
            Functions::Primal { f: profile, a, g } => Functions::Primal { f: profile.map(f), a: a.map(f), g: g.map(f) },
            Functions::Dual { c } => Functions::Dual { c: c.map(|r| r.map(f)) },
            Functions::Cylinder { x, z } => Functions::Cylinder { x: x.map(f), z: z.map(f) },
        };
        Span { inverse: f(self.inverse), functions }
    }
}

impl<S: Scalar> Span<S> {
    #[inline]
    fn plane(&self, x: S, t: S, axes: &[V3<S>; 3]) -> Plane<S> {
        match &self.functions {
            Functions::Primal { f, a, g } => {
                let ([f, f1, sigma], [a, a1, _]) = (f.at(x), a.at(x));
                let g = g[0] + x * (g[1] + x * (g[2] + x * (g[3] + x * (g[4] + x * g[5]))));
                let one = S::from(1.0);
                let ny = a * f1 - g;
                let n = add(&add(&scale(&axes[0], -f1), &scale(&axes[1], ny)), &axes[2]);
                let m = super::vector::sub(&scale(&axes[1], a), &axes[0]);
                Plane {
                    n,
                    m,
                    dm: scale(&axes[1], a1),
                    sigma,
                    nn: f1 * f1 + ny * ny + one,
                    nm: f1 + a * ny,
                    mm: one + a * a,
                    ndm: ny * a1,
                    h: f - t * f1,
                    k: -t,
                    dk: -one,
                }
            }
            Functions::Dual { c } => {
                let v = [c[0].at(x), c[1].at(x), c[2].at(x), c[3].at(x)];
                let n = [v[0][0], v[1][0], v[2][0]];
                let m = [v[0][1], v[1][1], v[2][1]];
                let dm = [v[0][2], v[1][2], v[2][2]];
                Plane {
                    n,
                    m,
                    dm,
                    sigma: S::from(1.0),
                    nn: dot(&n, &n),
                    nm: dot(&n, &m),
                    mm: dot(&m, &m),
                    ndm: dot(&n, &dm),
                    h: v[3][0],
                    k: v[3][1],
                    dk: v[3][2],
                }
            }
            Functions::Cylinder { x: px, z: pz } => touching(&Profile::at(px, pz, x), axes),
        }
    }
}

/// The plane that touches a cylinder along the ruling through a place of its profile: n the unit normal, m the unit tangent
/// backwards; `n' = ω m`, `m' = −ω n`.
#[inline]
fn touching<S: Scalar>(p: &Profile<S>, axes: &[V3<S>; 3]) -> Plane<S> {
    let ([x, z], [ex, ez]) = (p.point, p.tangent);
    let n = p.normal(axes);
    let h = ex * z - ez * x;
    let (zero, one) = (S::from(0.0), S::from(1.0));
    Plane {
        n,
        m: scale(&add(&scale(&axes[0], ex), &scale(&axes[2], ez)), -one),
        dm: scale(&n, -p.turn),
        sigma: p.turn,
        nn: one,
        nm: zero,
        mm: one,
        ndm: -p.turn,
        h,
        k: -(ex * x + ez * z),
        dk: -(p.turn * h + p.speed),
    }
}

/// A plane `n·x = h` for positions relative to a place.
fn about(plane: &[f64; 4], place: &V3<Interval>) -> [Interval; 4] {
    let [x, y, z, h] = plane.map(Interval::point);
    let moved = (0..3).any(|d| place[d] != Interval::ZERO);
    [x, y, z, if moved { h - dot(&[x, y, z], place) } else { h }]
}

/// Span of a primal torse with `g` integrated from its value at the start; also the value at the end.
fn primal_span(
    f: Cubic<Interval>,
    a: Cubic<Interval>,
    start: Interval,
    inverse: Interval,
) -> (Span<Interval>, Interval) {
    // g = ∫ f' a' dt with dt = dx / inverse.
    let mut g = [Interval::ZERO; 6];
    for i in 0..3 {
        for j in 0..3 {
            g[i + j + 1] += f.first[i] * a.first[j];
        }
    }
    for (k, c) in g.iter_mut().enumerate().skip(1) {
        *c = *c / Interval::point(k as f64) / inverse;
    }
    let at = |x: f64| {
        let mut s = Interval::ZERO;
        for c in g.iter().rev() {
            s = s * Interval::point(x) + *c;
        }
        s
    };
    let (low, high) = (at(-0.5), at(0.5));
    g[0] = start - low;
    (Span { inverse, functions: Functions::Primal { f, a, g } }, start + (high - low))
}

/// Enclosures of the columns of `R⁻ᵀ` for the matrix R with the given columns, and the factor for lengths.
fn frame_forms(columns: &[Vec3; 3]) -> Option<([V3<Interval>; 3], f64)> {
    let c = columns.map(|v| exact::<Interval>(&v));
    let mut error = Interval::ZERO;
    for i in 0..3 {
        for j in 0..3 {
            let ideal = if i == j { Interval::ONE } else { Interval::ZERO };
            error += (dot(&c[i], &c[j]) - ideal).sqr();
        }
    }
    let error = error.sqrt().hi;
    if error > FRAME_ERROR_LIMIT || error.is_nan() {
        return None;
    }
    // R⁻ᵀ = R (RᵀR)⁻¹ and ‖(RᵀR)⁻¹ − I‖ ≤ e/(1−e), so every entry of R⁻ᵀ − R is at most 2e.
    Some((c.map(|v| v.map(|x| x.widen(2.0 * error))), (1.0 + 2.0 * error).next_up()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
    use crate::torse::form::{CylinderTorse, DualTorse, PrimalTorse};

    pub fn primal() -> Torse {
        let knots = vec![-1., -1., -1., -1., 0., 0.5, 1., 1., 1., 1.];
        let control = vec![[0.3, 0.1], [0.1, 0.0], [-0.2, 0.2], [0.1, 0.3], [0.3, 0.1], [0.5, -0.1]];
        let (s, c) = (0.6, 0.8);
        let frame =
            Frame { origin: Vec3::new(1., 2., 3.), x: Vec3::new(c, s, 0.), y: Vec3::new(-s, c, 0.), z: Vec3::z() };
        Torse::Primal(PrimalTorse::new(frame, Curve::new(3, knots, control).expect("profile"), 0.2))
    }

    pub fn dual() -> Torse {
        let knots = vec![0., 0., 0., 0., 0.4, 1., 1., 1., 1.];
        let control = (0..5)
            .map(|i| {
                let t = i as f64 / 4.0;
                [t.sin(), 0.2 * t * t, t.cos(), 1.0 + 0.1 * t]
            })
            .collect();
        Torse::Dual(DualTorse { planes: Curve::new(3, knots, control).expect("planes") })
    }

    /// A profile that turns through more than half a circle and back, in a frame that is not axis-parallel.
    pub fn cylinder() -> Torse {
        let Torse::Primal(p) = primal() else { unreachable!() };
        let knots = vec![0., 0., 0., 0., 1., 2., 3., 4., 4., 4., 4.];
        let control = vec![[0., 0.], [1., 0.], [2., 0.5], [0.5, 2.], [1.5, 3.], [3., 1.], [2., 0.]];
        Torse::Cylinder(CylinderTorse { frame: p.frame, profile: Curve::new(3, knots, control).expect("profile") })
    }

    #[test]
    fn planes_turn_about_their_second_forms() {
        for torse in [primal(), dual(), cylinder()] {
            let family = Family::new(&torse).expect("family");
            let (t0, t1) = family.domain();
            for i in 1..20 {
                let (t, h) = (t0 + (t1 - t0) * (f64::from(i) + 0.3) / 20.3, 1e-5);
                let (p, before, after) = (family.quick(t), family.quick(t - h), family.quick(t + h));
                let rate = |f: &dyn Fn(&Plane<f64>) -> f64| (f(&after) - f(&before)) / (2.0 * h);
                for d in 0..3 {
                    assert!((rate(&|q| q.n[d]) - p.sigma * p.m[d]).abs() < 1e-6, "n' at {t} of {torse:?}");
                    assert!((rate(&|q| q.m[d]) - p.dm[d]).abs() < 1e-6, "m' at {t} of {torse:?}");
                }
                assert!((rate(&|q| q.h) - p.sigma * p.k).abs() < 1e-6, "h' at {t} of {torse:?}");
                assert!((rate(&|q| q.k) - p.dk).abs() < 1e-6, "k' at {t} of {torse:?}");
                for (found, is) in [(p.nn, dot(&p.n, &p.n)), (p.nm, dot(&p.n, &p.m)), (p.mm, dot(&p.m, &p.m))] {
                    assert!((found - is).abs() < 1e-12, "{torse:?}");
                }
                assert!((p.ndm - dot(&p.n, &p.dm)).abs() < 1e-12, "{torse:?}");
            }
        }
    }

    #[test]
    fn planes_agree_with_the_torse() {
        for torse in [primal(), dual(), cylinder()] {
            let family = Family::new(&torse).expect("family");
            let (t0, t1) = family.domain();
            let x = Vec3::new(1.2, 1.9, 3.3);
            let local = exact::<f64>(&(x - family.origin));
            let enclosed = exact::<Interval>(&(x - family.origin));
            for i in 0..=20 {
                let t = t0 + (t1 - t0) * i as f64 / 20.0;
                let (e, d) = torse.foot_function(&x, t);
                let (q, r) = family.quick_foot(&local, t);
                assert!((e - q).abs() < 1e-12 && (d - r).abs() < 1e-11, "{t}: {e} {q} {d} {r}");
                let p = family.at(t);
                let (f, mu) = (p.f(&enclosed), p.mu(&enclosed));
                let foot = p.foot(f, mu);
                assert!(foot.widen(1e-13).contains(e) && foot.rad() < 1e-11, "{t}: {e} {foot:?}");
                let wide = family.over(Interval::new((t - 0.1).max(t0), (t + 0.1).min(t1)));
                assert!(wide.h.encloses(p.h) && wide.n[1].encloses(p.n[1]) && wide.dk.encloses(p.dk));
                let ranges = family.ranges(Interval::new((t - 0.1).max(t0), (t + 0.1).min(t1)), &enclosed);
                assert!(ranges.sigma.widen(1e-12).encloses(p.sigma));
                assert!(ranges.dmu.widen(1e-12).encloses(dot(&p.dm, &enclosed) - p.dk));
            }
        }
    }

    #[test]
    fn a_skew_frame_is_refused() {
        let Torse::Primal(mut p) = primal() else { unreachable!() };
        p.frame.x *= 1.001;
        assert!(Family::new(&Torse::Primal(p)).is_none());
    }
}
