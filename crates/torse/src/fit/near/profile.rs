//! The family of primal torses over one frame: unknown profile f, ruling slope a and start value of g, with the
//! analytic derivatives of the distance (mixed-curvature specification, C1.3).

use super::basis::{cubic, Basis};
use super::descent::{balance, Family};
use super::power_form::{quintic, slope_integral, widened, PowerForm, RegularityMargin};
use crate::control::Control;
use crate::geom::{Frame, Vec3};
use crate::num::least_squares::Rows;
use crate::spline::knots::Knots;
use crate::spline::pieces::{span_of, Pieces};

/// Smallest `1 + y a'` at which a step is accepted; above the bound of the final torse.
const REGULAR: f64 = 0.1;

/// Weight of the third differences of a step of f (and of the second differences of that of a): minimax fits may wiggle
/// where the samples are far from the largest distance; a wiggle of ten times the error then costs half a percent of it.
const FAIR: f64 = 0.015;
/// Samples count as reaching this far from the profile plane, with the extent in x as unit: rulings always weigh
/// something.
const LEAST_REACH: f64 = 1e-9;
/// Share of a span inside which its ends are looked at: there, rounding cannot take the neighbour's polynomial for
/// its own.
const INSIDE: f64 = 1e-3;

/// Which functions the ruling slope a may be.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Slopes {
    /// Cylinders.
    Constant,
    /// Cones.
    Affine,
    /// Cubic spline with these breaks (among those of the profile).
    Spline(Vec<f64>),
}

/// The family; coefficients are those of f, then those of a, then g at the start of the domain.
#[derive(Clone, Debug)]
pub(crate) struct ProfileFamily {
    /// Samples in local coordinates.
    pub points: Vec<Vec3>,
    /// Foot of each sample.
    pub feet: Vec<f64>,
    /// Ends of the spans.
    pub breaks: Vec<f64>,
    f: Basis,
    a: Basis,
    slopes: Slopes,
    trial: Vec<f64>,
    /// Largest |y| of the samples.
    reach: f64,
    /// Steps after which a sample has less room are refused.
    margin: RegularityMargin,
    /// Ends fits early.
    pub control: Control,
}

impl ProfileFamily {
    /// The family over `points` with the spans `breaks`. `None` for breaks that do not increase.
    pub fn new(points: Vec<Vec3>, feet: Vec<f64>, breaks: Vec<f64>, slopes: Slopes) -> Option<Self> {
        let f = Basis::spline(&Knots::clamped(3, &breaks).ok()?, &breaks);
        let a = Self::slope_basis(&breaks, &slopes)?;
        let reach = points.iter().fold(LEAST_REACH, |m, q| m.max(q.y.abs()));
        let margin = RegularityMargin::default();
        let control = Control::default();
        Some(Self { points, feet, breaks, f, a, slopes, trial: Vec::new(), reach, margin, control })
    }

    fn slope_basis(breaks: &[f64], slopes: &Slopes) -> Option<Basis> {
        Some(match slopes {
            Slopes::Constant => Basis::polynomial(false, breaks),
            Slopes::Affine => Basis::polynomial(true, breaks),
            Slopes::Spline(coarse) => Basis::spline(&Knots::clamped(3, coarse).ok()?, breaks),
        })
    }

    /// The same samples with other spans and slopes, and the coefficients nearest to those of `x`.
    pub fn changed(&self, x: &[f64], breaks: Vec<f64>, slopes: Slopes) -> Option<(Self, Vec<f64>)> {
        let power_form = self.power_form(x);
        let PowerForm::Primal { profile, .. } = &power_form else { return None };
        let f = Basis::spline(&Knots::clamped(3, &breaks).ok()?, &breaks);
        let a = Self::slope_basis(&breaks, &slopes)?;
        let mut y = f.project(&breaks, |t| profile.jet(t)[0][0]);
        y.extend(a.project(&breaks, |t| profile.jet(t)[0][1]));
        y.push(power_form.slope(breaks[0]));
        let family = Self { f, a, slopes, breaks, trial: Vec::new(), ..self.clone() };
        Some((family, y))
    }

    /// Coefficients of the member nearest to the given functions and start value of g.
    pub fn coefficients(&self, profile: &Pieces<2>, beta: f64) -> Vec<f64> {
        let mut x = self.f.project(&self.breaks, |t| profile.jet(t)[0][0]);
        x.extend(self.a.project(&self.breaks, |t| profile.jet(t)[0][1]));
        x.push(beta);
        x
    }

    /// Fast form of the torse with the coefficients `x`, in the samples' own coordinates.
    pub fn power_form(&self, x: &[f64]) -> PowerForm {
        let (nf, na) = (self.f.count, self.a.count);
        let power = (0..self.breaks.len() - 1).map(|s| {
            let f = self.f.combine(s, &x[..nf]);
            let a = self.a.combine(s, &x[nf..nf + na]);
            std::array::from_fn(|k| [f[k], a[k]])
        });
        let profile = Pieces { power: power.collect(), breaks: self.breaks.clone() };
        PowerForm::primal(Frame::world(), profile, x[nf + na])
    }

    /// Rows with the third differences of f and the second differences of a, span by span.
    fn differences(&self, third: f64, second: f64, rows: &mut Rows) {
        let spans = self.breaks.len() - 1;
        let nf = self.f.count;
        for s in 0..spans {
            let h = self.breaks[s + 1] - self.breaks[s];
            let (_, row) = rows.push(0);
            for j in 0..self.f.active {
                row[self.f.first[s] + j] = third * h.powi(3) * 6.0 * self.f.power[s][j][3];
            }
        }
        let Slopes::Spline(coarse) = &self.slopes else { return };
        let h = (self.breaks[spans] - self.breaks[0]) / (coarse.len() - 1) as f64;
        for w in coarse.windows(2) {
            // The second derivative at both ends of every coarse span.
            for t in [w[0] + INSIDE * (w[1] - w[0]), w[1] - INSIDE * (w[1] - w[0])] {
                let s = span_of(&self.breaks, t);
                let u = t - self.breaks[s];
                let (_, row) = rows.push(0);
                for j in 0..self.a.active {
                    let p = &self.a.power[s][j];
                    row[nf + self.a.first[s] + j] = second * h * h * (2.0 * p[2] + 6.0 * u * p[3]);
                }
            }
        }
    }

    /// From now on the torse keeps the wanted room at the samples, or nearly as much as it has at `x`.
    pub fn keep_margin(&mut self, x: &[f64], wanted: RegularityMargin) {
        self.margin = wanted.kept(&self.power_form(x), &self.points, &self.feet);
    }

    /// Smallest and largest foot.
    pub fn foot_range(&self) -> (f64, f64) {
        self.feet.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)))
    }
}

impl Family for ProfileFamily {
    fn stopped(&self) -> bool {
        self.control.stopped()
    }

    fn unknowns(&self) -> usize {
        self.f.count + self.a.count + 1
    }

    fn width(&self) -> usize {
        self.unknowns()
    }

    fn residuals(&mut self, x: &[f64], active: &[usize], out: &mut Vec<f64>) -> bool {
        let power_form = self.power_form(x);
        let range = widened(power_form.domain());
        out.clear();
        self.trial.clear();
        for &i in active {
            let q = &self.points[i];
            let Some(t) = power_form.foot(q, self.feet[i], range) else { return false };
            let (d, regular) = power_form.distance(q, t);
            if !(regular > REGULAR && d.is_finite() && self.margin.granted(&power_form, q, t)) {
                return false;
            }
            out.push(d);
            self.trial.push(t);
        }
        true
    }

    fn feet(&mut self) -> &mut Vec<f64> {
        &mut self.feet
    }

    fn irregular(&mut self, x: &[f64], samples: &[usize]) -> Vec<usize> {
        let power_form = self.power_form(x);
        let range = widened(power_form.domain());
        let mut out = Vec::new();
        for &i in samples {
            let q = &self.points[i];
            match power_form.foot(q, self.feet[i], range) {
                Some(t) if power_form.distance(q, t).1 > REGULAR && self.margin.granted(&power_form, q, t) => {
                    self.feet[i] = t
                }
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

    /// `∂d/∂f_j = −(B_j + y ∫B_j' a')/|n|`, `∂d/∂a_j = −y (∫f' B_j' − f' B_j)/|n|`, `∂d/∂β = −y/|n|` at the foot, where
    /// y is that of the foot point: exact to first order.
    fn jacobian(&mut self, x: &[f64], active: &[usize], residual: &[f64], rows: &mut Rows) {
        let (nf, na) = (self.f.count, self.a.count);
        let power_form = self.power_form(x);
        let PowerForm::Primal { profile, .. } = &power_form else { return };
        let spans = self.breaks.len() - 1;
        // Integrals from the start of the domain to each break, and on the spans.
        let mut before_f = vec![0.0; (spans + 1) * nf];
        let mut before_a = vec![0.0; (spans + 1) * na];
        let mut on_f = Vec::with_capacity(spans);
        let mut on_a = Vec::with_capacity(spans);
        for s in 0..spans {
            let h = self.breaks[s + 1] - self.breaks[s];
            let c = &profile.power[s];
            let (f, a) = (c.map(|v| v[0]), c.map(|v| v[1]));
            before_f.copy_within(s * nf..(s + 1) * nf, (s + 1) * nf);
            before_a.copy_within(s * na..(s + 1) * na, (s + 1) * na);
            let mut pf = [[0.0; 6]; 4];
            for j in 0..self.f.active {
                pf[j] = slope_integral(&self.f.power[s][j], &a);
                before_f[(s + 1) * nf + self.f.first[s] + j] += quintic(&pf[j], h);
            }
            let mut pa = [[0.0; 6]; 4];
            for j in 0..self.a.active {
                pa[j] = slope_integral(&f, &self.a.power[s][j]);
                before_a[(s + 1) * na + self.a.first[s] + j] += quintic(&pa[j], h);
            }
            on_f.push(pf);
            on_a.push(pa);
        }
        for (&i, r) in active.iter().zip(residual) {
            let t = self.feet[i];
            let s = span_of(&self.breaks, t);
            let u = t - self.breaks[s];
            let jet = power_form.jet(t);
            let norm = jet.n.norm();
            let y = self.points[i].y - r * jet.n.y / norm;
            let scale = -1.0 / norm;
            let f1 = -jet.n.x;
            let (_, row) = rows.push(0);
            for (o, b) in row[..nf].iter_mut().zip(&before_f[s * nf..]) {
                *o = scale * y * b;
            }
            for j in 0..self.f.active {
                row[self.f.first[s] + j] += scale * (cubic(&self.f.power[s][j], u) + y * quintic(&on_f[s][j], u));
            }
            for (o, b) in row[nf..nf + na].iter_mut().zip(&before_a[s * na..]) {
                *o = scale * y * b;
            }
            for j in 0..self.a.active {
                let value = quintic(&on_a[s][j], u) - f1 * cubic(&self.a.power[s][j], u);
                row[nf + self.a.first[s] + j] += scale * y * value;
            }
            row[nf + na] = scale * y;
        }
    }

    fn soft(&self, x: &[f64], count: usize, error: f64, rows: &mut Rows, residual: &mut Vec<f64>) {
        // Weights of the prototype (C1.5) for third differences of f, second differences of a and a itself.
        const THIRD: f64 = 3e-3;
        const SECOND: f64 = 0.02;
        const SIZE: f64 = 1e-6;
        let balance = balance(error);
        let nf = self.f.count;
        let root = (count as f64).sqrt();
        let third = balance * THIRD / (nf as f64).sqrt();
        let second = balance * SECOND * self.reach / root;
        let size = balance * SIZE * root * self.reach;
        self.differences(third * root, second * root, rows);
        for j in 0..self.a.count {
            rows.push(0).1[nf + j] = size;
        }
        residual.extend((0..rows.len()).map(|i| rows.dot(i, x)));
    }

    fn fairness(&self, rows: &mut Rows) {
        self.differences(FAIR, FAIR * self.reach, rows);
    }

    fn firmness(&self) -> f64 {
        // Least squares are fair by themselves.
        0.05
    }

    fn step_share(&self, _x: &[f64], d: &[f64]) -> f64 {
        // Largest change of the profile's slope, of g, and of the shift y a of the rulings' ends, in one step; the
        // extent in x is 1.
        const LARGEST: f64 = 0.3;
        let (nf, na) = (self.f.count, self.a.count);
        let mut most = d[nf + na].abs();
        for s in 0..self.breaks.len() - 1 {
            most = most.max(self.f.combine(s, &d[..nf])[1].abs());
        }
        for c in &d[nf..nf + na] {
            most = most.max(c.abs() * self.reach.max(0.3));
        }
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
        let breaks: Vec<f64> = (0..=6).map(|i| -0.6 + 0.2 * i as f64).collect();
        let coarse = vec![breaks[0], breaks[2], breaks[4], breaks[6]];
        let points: Vec<Vec3> = (0..12)
            .map(|i| {
                let (x, y) = (-0.5 + i as f64 / 11.0, 0.3 * ((i * 7 % 5) as f64 / 4.0 - 0.5));
                Vec3::new(x, y, 0.2 * x * x + 0.05 * y + 0.02 * (3.0 * x).sin())
            })
            .collect();
        let feet = points.iter().map(|q| q.x).collect();
        let mut family = ProfileFamily::new(points, feet, breaks.clone(), Slopes::Spline(coarse)).expect("family");
        let n = family.unknowns();
        let x: Vec<f64> = (0..n).map(|i| 0.1 * (i as f64 * 1.3).sin()).collect();
        let active: Vec<usize> = (0..12).collect();
        let (mut r, mut lo, mut hi) = (Vec::new(), Vec::new(), Vec::new());
        assert!(family.residuals(&x, &active, &mut r));
        family.adopt(&active);
        let mut rows = Rows::new(n, n);
        family.jacobian(&x, &active, &r, &mut rows);
        let h = 1e-6;
        for j in 0..n {
            let mut y = x.clone();
            y[j] += h;
            assert!(family.residuals(&y, &active, &mut hi));
            y[j] -= 2.0 * h;
            assert!(family.residuals(&y, &active, &mut lo));
            for i in 0..active.len() {
                let fd = (hi[i] - lo[i]) / (2.0 * h);
                assert!((fd - rows.row(i).1[j]).abs() < 1e-7, "sample {i}, coefficient {j}: {fd} {}", rows.row(i).1[j]);
            }
        }
    }
}
