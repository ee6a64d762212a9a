//! Strips over plane profiles, which may have inflections; see [`super::strip`].

use super::form::{Band, Foot, Form, Tie};
use crate::fit::near::exact::LEAST_SLANT;
use crate::geom::{Frame, Vec3};
use crate::num::runs::Runs;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::spline::pieces::Pieces;
use crate::torse::form::{DualTorse, PrimalTorse, Torse};

/// Samples of a spline per span of another that takes its place.
pub(super) const PER_SPAN: usize = 8;
/// Spans of the profile per span of the rulings' slope.
const SLOPE: usize = 2;
/// Nodes and weights of the quadrature that is exact up to degree five.
const NODES: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// A strip over a profile on equal spans, its rulings' slope on half as many.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    torse: Torse,
    slopes: Knots,
    /// Coefficients over the profile's knots of each function of the slope.
    refined: Vec<Vec<f64>>,
    half_width: f64,
    /// For every break, `∫ B' a'` of all functions of the profile and `∫ f' A'` of all of the slope from the start.
    before: Vec<Vec<f64>>,
}

/// What a ruling is in the coordinates of a frame.
struct Crossing {
    t: f64,
    value: [f64; 2],
    g: f64,
}

impl Profile {
    /// A primal torse anew on equal spans over a range.
    pub fn new(p: &PrimalTorse, range: (f64, f64), spans: usize) -> Option<Self> {
        let pieces = Pieces::of(p.profile())?;
        let start = pieces.domain().0;
        // The slope g goes on outside the domain as its polynomials do.
        let product = |t: f64| {
            let d = pieces.jet(t)[1];
            d[0] * d[1]
        };
        let beta =
            if range.0 >= start { p.functions(range.0)[5] } else { p.beta() - integral(product, range.0, start) };
        let at = equally_spaced(range, PER_SPAN * spans);
        let values: Vec<[f64; 2]> = at.iter().map(|&t| pieces.jet(t)[0]).collect();
        Self::through(p.frame, range, spans, &at, &values, beta)
    }

    /// The same strip, nearly, as an envelope of planes over a range of parameters.
    pub fn of_planes(d: &DualTorse, range: (f64, f64), spans: usize) -> Option<Self> {
        let pieces = Pieces::of(&d.planes)?;
        let torse = Torse::Dual(DualTorse { planes: pieces.on(range.0, range.1, 0.0).to_curve().ok()? });
        let count = PER_SPAN * spans;
        let lines: Vec<_> = equally_spaced(range, count).into_iter().map(|t| torse.ruling(t)).collect();
        let mean = |f: &dyn Fn(usize) -> Vec3| (0..lines.len()).map(f).sum::<Vec3>().try_normalize(0.0);
        let y = mean(&|k| lines[k].direction)?;
        let up = mean(&|k| lines[k].normal)?;
        let z = (up - y * up.dot(&y)).try_normalize(0.0)?;
        let origin = lines.iter().map(|l| l.point).sum::<Vec3>() / lines.len() as f64;
        let frame = Frame { origin, x: y.cross(&z), y, z };
        let crossing = |l: &crate::torse::form::Ruling| {
            let (p, d) = (frame.to_local(&l.point), frame.vector_to_local(&l.direction));
            let q = p - d * (p.y / d.y);
            (d.y.abs() >= LEAST_SLANT).then(|| Crossing { t: q.x, value: [q.z, d.x / d.y], g: d.z / d.y })
        };
        let mut all: Vec<Crossing> = lines.iter().map(crossing).collect::<Option<_>>()?;
        if all[0].t > all[all.len() - 1].t {
            all.reverse();
        }
        let at: Vec<f64> = all.iter().map(|c| c.t).collect();
        if at.windows(2).any(|w| w[0] >= w[1]) {
            return None;
        }
        let values: Vec<[f64; 2]> = all.iter().map(|c| c.value).collect();
        let range = (at[0], at[count]);
        let out = Self::through(frame, range, spans, &at, &values, 0.0)?;
        // The slope g is what profile and rulings say but for a constant.
        let beta = all.iter().map(|c| c.g - out.primal().functions(c.t)[5]).sum::<f64>() / all.len() as f64;
        Self::through(frame, range, spans, &at, &values, beta)
    }

    fn through(
        frame: Frame,
        range: (f64, f64),
        spans: usize,
        at: &[f64],
        values: &[[f64; 2]],
        beta: f64,
    ) -> Option<Self> {
        let spans = spans.next_multiple_of(SLOPE);
        let knots = Knots::uniform(3, spans, range.0, range.1).ok()?;
        let slopes = Knots::uniform(3, spans / SLOPE, range.0, range.1).ok()?;
        let profile: Vec<[f64; 1]> = values.iter().map(|v| [v[0]]).collect();
        let slope: Vec<[f64; 1]> = values.iter().map(|v| [v[1]]).collect();
        let f = lsq::fit(&profile, at, &knots).ok()?.curve;
        let a = lsq::fit(&slope, at, &slopes).ok()?.curve;
        let dense = equally_spaced(range, 4 * spans);
        let refined = (0..slopes.control_count())
            .map(|j| {
                let mut control = vec![[0.0]; slopes.control_count()];
                control[j] = [1.0];
                let one = Curve { knots: slopes.clone(), control };
                let points: Vec<[f64; 1]> = dense.iter().map(|&t| one.point(t)).collect();
                Some(lsq::fit(&points, &dense, &knots).ok()?.curve.control.iter().map(|c| c[0]).collect())
            })
            .collect::<Option<Vec<Vec<f64>>>>()?;
        let control = f
            .control
            .iter()
            .enumerate()
            .map(|(i, c)| [c[0], refined.iter().zip(&a.control).map(|(r, a)| r[i] * a[0]).sum()]);
        let profile = Curve { knots, control: control.collect() };
        let torse = Torse::Primal(PrimalTorse::new(frame, profile, beta));
        Some(Self { torse, slopes, refined, half_width: 1.0, before: Vec::new() }.prepared())
    }

    fn primal(&self) -> &PrimalTorse {
        match &self.torse {
            Torse::Primal(p) => p,
            Torse::Dual(_) | Torse::Cylinder(_) => unreachable!("a profile is a graph"),
        }
    }

    fn counts(&self) -> (usize, usize) {
        (self.primal().profile().control.len(), self.slopes.control_count())
    }

    pub fn lie_on(&mut self, band: &Band) {
        self.half_width = band.half_width;
    }

    /// Adds the integrals of all functions from `from` to `to`, within one span.
    fn integrate(&self, from: f64, to: f64, out: &mut [f64]) {
        let (nf, _) = self.counts();
        let profile = self.primal().profile();
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        // On the span that holds the middle: at its ends, others would answer.
        let (span, coarse) = (profile.knots.span(middle), self.slopes.span(middle));
        for (node, weight) in NODES {
            let t = middle + half * node;
            let (b, c) = (profile.knots.basis_on_span(span, t, 1), self.slopes.basis_on_span(coarse, t, 1));
            let mut slope = [0.0; 2];
            for j in 0..4 {
                (0..2).for_each(|d| slope[d] += b.rows[1][j] * profile.control[b.first + j][d]);
            }
            for j in 0..4 {
                out[b.first + j] += half * weight * b.rows[1][j] * slope[1];
                out[nf + c.first + j] += half * weight * c.rows[1][j] * slope[0];
            }
        }
    }

    fn prepared(mut self) -> Self {
        let breaks = self.torse.breaks();
        let (nf, na) = self.counts();
        let mut sums = vec![vec![0.0; nf + na]];
        for w in breaks.windows(2) {
            let mut next = sums[sums.len() - 1].clone();
            self.integrate(w[0], w[1], &mut next);
            sums.push(next);
        }
        self.before = sums;
        self
    }

    pub fn moved(&self, change: &[f64]) -> Option<Self> {
        let (nf, na) = self.counts();
        let p = self.primal();
        let mut profile = p.profile().clone();
        for (i, c) in profile.control.iter_mut().enumerate() {
            c[0] += change[i];
            c[1] += (0..na).map(|j| self.refined[j][i] * change[nf + j]).sum::<f64>() / self.half_width;
        }
        let beta = p.beta() + change[nf + na] / self.half_width;
        let finite = profile.control.iter().flatten().all(|c| c.is_finite());
        let torse = Torse::Primal(PrimalTorse::new(p.frame, profile, beta));
        finite.then(|| Self { torse, ..self.clone() }.prepared())
    }
}

/// Equally spaced parameters from end to end.
fn equally_spaced((a, b): (f64, f64), count: usize) -> Vec<f64> {
    (0..=count).map(|i| if i == count { b } else { a + (b - a) * i as f64 / count as f64 }).collect()
}

/// Integral of a polynomial of degree at most five.
fn integral(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let (m, h) = (0.5 * (a + b), 0.5 * (b - a));
    NODES.iter().map(|(x, w)| h * w * f(m + h * x)).sum()
}

impl Form for Profile {
    fn torse(&self) -> &Torse {
        &self.torse
    }

    fn unknowns(&self) -> usize {
        let (nf, na) = self.counts();
        nf + na + 1
    }

    /// `−(B + y ∫B'a')/|n|` for functions B of the profile, `−y (∫f'A' − f' A)/|n|` for functions A of the slope,
    /// `−y/|n|` for its constant; y is that of the foot.
    fn row(&self, column: usize, x: &Vec3, foot: &Foot, scale: f64, out: &mut Runs) {
        let p = self.primal();
        let (nf, na) = self.counts();
        let [_, f1, _, a, _, g] = p.functions(foot.t);
        let n = Vec3::new(-f1, a * f1 - g, 1.0);
        let up = p.frame.vector_to_world(&n).dot(&foot.normal).signum();
        let y = p.frame.to_local(&(x - foot.normal * foot.distance)).y;
        let scale = -scale * up / n.norm();
        let breaks = self.before.len() - 1;
        let (from, to) = p.profile().knots.domain();
        let share = (foot.t - from) / (to - from) * breaks as f64;
        let span = (share.max(0.0) as usize).min(breaks - 1);
        let start = from + (to - from) * span as f64 / breaks as f64;
        let mut values = self.before[span].clone();
        self.integrate(start, foot.t, &mut values);
        values.iter_mut().for_each(|v| *v *= scale * y);
        let b = p.profile().knots.basis(foot.t, 0);
        let c = self.slopes.basis(foot.t, 0);
        for j in 0..4 {
            values[b.first + j] += scale * b.rows[0][j];
            values[nf + c.first + j] -= scale * y * f1 * c.rows[0][j];
        }
        values[nf..].iter_mut().for_each(|v| *v /= self.half_width);
        values.push(scale * y / self.half_width);
        debug_assert_eq!(values.len(), nf + na + 1);
        out.run(column, values);
    }

    /// To second order the distance changes by `y (f' a + …)` of the changes f and a besides: at most
    /// `½ (a² / ℓ + ℓ f'²)` for any length ℓ, here that of two spans.
    fn damping(&self, column: usize, tolerance: f64, tie: &mut Tie) {
        let (nf, _) = self.counts();
        let breaks = self.torse.breaks();
        let length = 2.0 * (breaks[1] - breaks[0]);
        let weight = tie.damping / breaks.len() as f64;
        let knots = &self.primal().profile().knots;
        for &t in &breaks {
            let (b, c) = (knots.basis(t, 1), self.slopes.basis(t, 0));
            tie.rows.run(column + b.first, b.rows[1][..4].iter().copied());
            tie.end(weight * tolerance * length, 0.0);
            tie.rows.run(column + nf + c.first, c.rows[0][..4].iter().copied());
            tie.end(weight * tolerance / length, 0.0);
        }
    }

    fn sequences(&self) -> Vec<Vec<usize>> {
        let (nf, na) = self.counts();
        vec![(0..nf).collect(), (nf..nf + na).collect()]
    }

    /// `y A' − A y² a''/(1 + y a')` for functions A of the slope: the ruling through the foot, at `t + y a` in the profile's
    /// coordinates, is another one after the change.
    fn regular_row(&self, column: usize, foot: &Vec3, t: f64, scale: f64, out: &mut Runs) -> Vec3 {
        let p = self.primal();
        let y = p.frame.to_local(foot).y;
        let [_, first, second] = p.profile().jet(t).map(|j| j[1]);
        let value = p.profile().point(t)[1];
        let moved = y * second / (1.0 + y * first);
        let c = self.slopes.basis(t, 1);
        let row = scale * y / self.half_width;
        out.run(column + self.counts().0 + c.first, (0..4).map(|j| row * (c.rows[1][j] - moved * c.rows[0][j])));
        (p.frame.y * (first - moved * value) + p.frame.x * moved) * scale
    }

    fn regular(&self, x: &Vec3, t: f64) -> f64 {
        let p = self.primal();
        1.0 + p.frame.to_local(x).y * p.functions(t)[4]
    }
}
