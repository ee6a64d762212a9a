//! The family of dual torses: unknown control planes of a cubic spline (dual-and-approximation specification, B3.5).

use super::basis::{cubic, Basis};
use super::descent::{balance, Family};
use super::power_form::{widened, PowerForm, RegularityMargin};
use super::samples::REGULAR_DUAL;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::least_squares::Rows;
use crate::spline::knots::Knots;
use crate::spline::pieces::{span_of, Pieces};

/// A place where the gauges hold: `n·n0 = 1` fixes the length of n, `n·e = 0` the speed at which the planes turn about
/// their rulings; both are mere changes of the description.
#[derive(Clone, Copy, Debug)]
struct Gauge {
    t: f64,
    n0: Vec3,
    e: Vec3,
}

/// Weight of the third differences of a step (see the primal family's).
const FAIR: f64 = 0.1;

/// Weight of the second differences of a step's control planes: they keep coefficients without samples in line.
const STEP: f64 = 3e-3;

/// The family; coefficient `4 j + c` is component c of control plane j.
#[derive(Clone, Debug)]
pub(crate) struct EnvelopeFamily {
    /// Samples in scaled coordinates.
    pub points: Vec<Vec3>,
    /// Foot of each sample.
    pub feet: Vec<f64>,
    breaks: Vec<f64>,
    basis: Basis,
    gauges: Vec<Gauge>,
    trial: Vec<f64>,
    /// Steps after which a sample has less room are refused.
    margin: RegularityMargin,
    /// Ends fits early.
    pub control: Control,
}

impl EnvelopeFamily {
    /// From now on the torse keeps the wanted room at the samples, or nearly as much as it has at `x`.
    pub fn keep_margin(&mut self, x: &[f64], wanted: RegularityMargin) {
        self.margin = wanted.kept(&self.power_form(x), &self.points, &self.feet);
    }

    /// The family with the spans of `start`, its gauges taken from there, and the coefficients of `start`. Feet are
    /// guessed from the rulings unless given.
    pub fn new(points: Vec<Vec3>, feet: Option<Vec<f64>>, start: Pieces<4>) -> Option<(Self, Vec<f64>)> {
        // Gauges per span: enough to fix each control plane.
        const GAUGES: usize = 2;
        let breaks = start.breaks.clone();
        let basis = Basis::spline(&Knots::clamped(3, &breaks).ok()?, &breaks);
        let x = coefficients(&basis, &breaks, &start);
        let power_form = PowerForm::Dual { planes: start };
        let feet = feet.unwrap_or_else(|| {
            let guesses = power_form.guesses();
            points.iter().map(|q| guesses.guess(q)).collect()
        });
        let mut gauges = Vec::new();
        for w in breaks.windows(2) {
            for k in 0..GAUGES {
                let t = w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / GAUGES as f64;
                let j = power_form.jet(t);
                let nn = j.n.norm_squared();
                if !(nn > 0.0 && nn.is_finite()) {
                    return None;
                }
                // The direction perpendicular to ruling and normal.
                let turn = j.m - j.n * (j.n.dot(&j.m) / nn);
                gauges.push(Gauge { t, n0: j.n / nn, e: turn.try_normalize(0.0).unwrap_or_default() });
            }
        }
        let (margin, control) = (RegularityMargin::default(), Control::default());
        Some((Self { points, feet, breaks, basis, gauges, trial: Vec::new(), margin, control }, x))
    }

    /// Planes with the coefficients `x`.
    fn planes(&self, x: &[f64]) -> Pieces<4> {
        let power = (0..self.breaks.len() - 1).map(|s| {
            let mut out = [[0.0; 4]; 4];
            for j in 0..4 {
                let c = &x[4 * (self.basis.first[s] + j)..][..4];
                for (k, row) in out.iter_mut().enumerate() {
                    let p = self.basis.power[s][j][k];
                    for d in 0..4 {
                        row[d] += p * c[d];
                    }
                }
            }
            out
        });
        Pieces { power: power.collect(), breaks: self.breaks.clone() }
    }

    /// Rows with the third differences of all components, span by span.
    fn differences(&self, weight: f64, rows: &mut Rows) {
        for s in 0..self.breaks.len() - 1 {
            let h = self.breaks[s + 1] - self.breaks[s];
            for d in 0..4 {
                let (_, row) = rows.push(4 * self.basis.first[s]);
                for j in 0..4 {
                    row[4 * j + d] = weight * h.powi(3) * 6.0 * self.basis.power[s][j][3];
                }
            }
        }
    }

    /// Fast form of the torse with the coefficients `x`.
    pub fn power_form(&self, x: &[f64]) -> PowerForm {
        PowerForm::Dual { planes: self.planes(x) }
    }

    /// The same torse (nearly) on `spans` equal spans that reach `margin` of the feet's range beyond the feet.
    pub fn refitted(&self, x: &[f64], spans: usize, margin: f64) -> Option<(Self, Vec<f64>)> {
        let (a, b) = self.feet.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
        let (lo, hi) = (a - margin * (b - a), b + margin * (b - a));
        if lo.is_nan() || hi.is_nan() || hi <= lo {
            return None;
        }
        let breaks: Vec<f64> = (0..=spans).map(|i| lo + (hi - lo) * i as f64 / spans as f64).collect();
        let basis = Basis::spline(&Knots::clamped(3, &breaks).ok()?, &breaks);
        let x = coefficients(&basis, &breaks, &self.planes(x));
        let bare = Self {
            points: Vec::new(),
            feet: Vec::new(),
            breaks,
            basis,
            gauges: Vec::new(),
            trial: Vec::new(),
            margin: RegularityMargin::default(),
            control: Control::default(),
        };
        let (family, x) = Self::new(self.points.clone(), Some(self.feet.clone()), bare.planes(&x))?;
        Some((Self { control: self.control.clone(), ..family }, x))
    }
}

/// Control planes nearest to the given ones.
fn coefficients(basis: &Basis, breaks: &[f64], planes: &Pieces<4>) -> Vec<f64> {
    let mut x = vec![0.0; 4 * basis.count];
    for d in 0..4 {
        for (j, v) in basis.project(breaks, |t| planes.jet(t)[0][d]).into_iter().enumerate() {
            x[4 * j + d] = v;
        }
    }
    x
}

impl Family for EnvelopeFamily {
    fn stopped(&self) -> bool {
        self.control.stopped()
    }

    fn unknowns(&self) -> usize {
        4 * self.basis.count
    }

    fn width(&self) -> usize {
        16
    }

    fn residuals(&mut self, x: &[f64], active: &[usize], out: &mut Vec<f64>) -> bool {
        let power_form = self.power_form(x);
        let range = widened(power_form.domain());
        out.clear();
        self.trial.clear();
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for &i in active {
            let q = &self.points[i];
            let Some(t) = power_form.foot(q, self.feet[i], range) else { return false };
            let (d, regular) = power_form.distance(q, t);
            if !d.is_finite() || !self.margin.granted(&power_form, q, t) {
                return false;
            }
            least = least.min(regular);
            most = most.max(regular);
            out.push(d);
            self.trial.push(t);
        }
        least.max(-most) > REGULAR_DUAL * least.abs().max(most.abs())
    }

    fn feet(&mut self) -> &mut Vec<f64> {
        &mut self.feet
    }

    fn irregular(&mut self, x: &[f64], samples: &[usize]) -> Vec<usize> {
        let power_form = self.power_form(x);
        let range = widened(power_form.domain());
        let feet: Vec<Option<(f64, f64)>> = samples
            .iter()
            .map(|&i| {
                let q = &self.points[i];
                let t = power_form.foot(q, self.feet[i], range)?;
                self.margin.granted(&power_form, q, t).then(|| (t, power_form.distance(q, t).1))
            })
            .collect();
        let regular = || feet.iter().flatten().map(|f| f.1);
        let most = regular().fold(0.0, |m: f64, r| m.max(r.abs()));
        // The side of the regression curve on which most samples lie.
        let side = if 2 * regular().filter(|r| *r > 0.0).count() >= samples.len() { 1.0 } else { -1.0 };
        let mut out = Vec::new();
        for (&i, foot) in samples.iter().zip(&feet) {
            match foot {
                Some((t, r)) if side * r > REGULAR_DUAL * most => self.feet[i] = *t,
                _ => out.push(i),
            }
        }
        out
    }

    fn adopt(&mut self, active: &[usize]) {
        for (&i, &t) in active.iter().zip(&self.trial) {
            self.feet[i] = t;
        }
    }

    /// `∂d/∂(n_j, h_j) = B_j(t) (Y, −1)/|n|` with the foot point Y.
    fn jacobian(&mut self, x: &[f64], active: &[usize], residual: &[f64], rows: &mut Rows) {
        let power_form = self.power_form(x);
        for (&i, r) in active.iter().zip(residual) {
            let t = self.feet[i];
            let s = span_of(&self.breaks, t);
            let u = t - self.breaks[s];
            let n = power_form.jet(t).n;
            let norm = n.norm();
            let foot = self.points[i] - n * (r / norm);
            let (_, row) = rows.push(4 * self.basis.first[s]);
            for j in 0..4 {
                let b = cubic(&self.basis.power[s][j], u) / norm;
                row[4 * j..4 * j + 4].copy_from_slice(&[b * foot.x, b * foot.y, b * foot.z, -b]);
            }
        }
    }

    fn soft(&self, x: &[f64], count: usize, error: f64, rows: &mut Rows, residual: &mut Vec<f64>) {
        // Weights of the gauges for length and turning and of the third differences of the planes.
        const LENGTH: f64 = 1.0;
        const TURN: f64 = 0.05;
        const THIRD: f64 = 1e-3;
        let root = balance(error) * (count as f64 / self.gauges.len() as f64).sqrt();
        for g in &self.gauges {
            let s = span_of(&self.breaks, g.t);
            let u = g.t - self.breaks[s];
            for (v, weight, target) in [(g.n0, LENGTH, 1.0), (g.e, TURN, 0.0)] {
                let (_, row) = rows.push(4 * self.basis.first[s]);
                for j in 0..4 {
                    let b = root * weight * cubic(&self.basis.power[s][j], u);
                    row[4 * j..4 * j + 3].copy_from_slice(&[b * v.x, b * v.y, b * v.z]);
                }
                residual.push(rows.dot(rows.len() - 1, x) - root * weight * target);
            }
        }
        let start = rows.len();
        self.differences(root * THIRD, rows);
        residual.extend((start..rows.len()).map(|i| rows.dot(i, x)));
    }

    fn fairness(&self, rows: &mut Rows) {
        self.differences(FAIR, rows);
        for j in 2..self.basis.count {
            for d in 0..4 {
                let (first, row) = rows.push(4 * (j - 2));
                let at = 4 * (j - 2) - first + d;
                row[at] = STEP;
                row[at + 4] = -2.0 * STEP;
                row[at + 8] = STEP;
            }
        }
    }

    fn firmness(&self) -> f64 {
        // Many spans hold few samples each.
        1.0
    }

    fn step_share(&self, _x: &[f64], d: &[f64]) -> f64 {
        // Largest change of a control plane's normal in one step.
        const LARGEST: f64 = 0.2;
        let most = d.chunks_exact(4).map(|c| (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt()).fold(0.0, f64::max);
        if most > LARGEST {
            LARGEST / most
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_differences() {
        // Tangent planes of a circular cylinder-like strip whose axis turns.
        let breaks: Vec<f64> = (0..=6).map(|i| -0.75 + 0.25 * i as f64).collect();
        let knots = Knots::clamped(3, &breaks).expect("knots");
        let basis = Basis::spline(&knots, &breaks);
        let plane = |t: f64| [t.sin(), 0.1 * t * t, t.cos(), 1.0 - 0.05 * t.powi(3)];
        let mut x = vec![0.0; 4 * basis.count];
        for d in 0..4 {
            for (j, v) in basis.project(&breaks, |t| plane(t)[d]).into_iter().enumerate() {
                x[4 * j + d] = v;
            }
        }
        let points: Vec<Vec3> = (0..10)
            .map(|i| {
                let (t, y) = (-0.6 + 1.2 * i as f64 / 9.0, 0.2 * ((i * 3 % 5) as f64 / 4.0 - 0.5));
                Vec3::new(t.sin(), y, t.cos()) * 1.002
            })
            .collect();
        let bare = EnvelopeFamily {
            points: vec![],
            feet: vec![],
            breaks,
            basis,
            gauges: vec![],
            trial: vec![],
            margin: RegularityMargin::default(),
            control: Control::default(),
        };
        let start = bare.planes(&x);
        let (mut family, x) = EnvelopeFamily::new(points, None, start).expect("family");
        let active: Vec<usize> = (0..10).collect();
        let (mut r, mut lo, mut hi) = (Vec::new(), Vec::new(), Vec::new());
        assert!(family.residuals(&x, &active, &mut r));
        family.adopt(&active);
        let n = family.unknowns();
        let mut rows = Rows::new(n, family.width());
        family.jacobian(&x, &active, &r, &mut rows);
        let h = 1e-6;
        for j in 0..n {
            let mut y = x.clone();
            y[j] += h;
            assert!(family.residuals(&y, &active, &mut hi));
            y[j] -= 2.0 * h;
            assert!(family.residuals(&y, &active, &mut lo));
            for i in 0..active.len() {
                let (first, row) = rows.row(i);
                let exact = if j >= first && j < first + 16 { row[j - first] } else { 0.0 };
                let fd = (hi[i] - lo[i]) / (2.0 * h);
                assert!((fd - exact).abs() < 1e-7, "sample {i}, coefficient {j}: {fd} {exact}");
            }
        }
    }
}
