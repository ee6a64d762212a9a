//! A strip under way in the form that it came in \[PW99\]: planes of a dual torse, or profile and rulings of a primal one,
//! which may have inflections. Coordinates are its own, of about unit size.

use crate::fit::near::descent::Family;
use crate::fit::near::directions::MARGIN;
use crate::fit::near::dual::Scale;
use crate::fit::near::envelope::EnvelopeFamily;
use crate::fit::near::power_form::Sheet;
use crate::fit::near::primal;
use crate::fit::near::profile::{ProfileFamily, Slopes};
use crate::fit::near::samples::{error, Sample};
use crate::geom::{Frame, Vec3};
use crate::num::least_squares::Rows;
use crate::spline::pieces::Pieces;
use crate::torse::form::{DualTorse, PanelKind, Torse};

/// Spans of a profile, and of the slopes of its rulings, as shares of the spans of planes.
const PRIMAL: [f64; 2] = [0.5, 0.25];

/// The family of torses that a strip is taken from.
#[derive(Clone)]
pub(super) enum Form {
    /// Control planes.
    Dual(EnvelopeFamily, Scale),
    /// Profile and slopes in a frame, with the unit of length (mm).
    Primal(ProfileFamily, Frame, f64),
}

macro_rules! either {
    ($form:expr, $family:ident => $value:expr) => {
        match $form {
            Form::Dual($family, _) => $value,
            Form::Primal($family, ..) => $value,
        }
    };
}

impl Form {
    /// The form of a torse over points (mm) around the samples, and its coefficients.
    pub fn of(torse: &Torse, samples: &[Sample], points: &[Vec3]) -> Option<(Self, Vec<f64>)> {
        match torse {
            Torse::Dual(d) => {
                let scale = Scale::of(samples)?;
                let mut planes = d.planes.clone();
                for c in &mut planes.control {
                    *c = scale.plane(c);
                }
                let points = points.iter().map(|x| scale.point(x)).collect();
                let (family, x) = EnvelopeFamily::new(points, None, Pieces::of(&planes)?)?;
                Some((Self::Dual(family, scale), x))
            }
            Torse::Primal(p) => {
                let (family, x, unit) = primal::scaled(p, PanelKind::Torse, points)?;
                Some((Self::Primal(family, p.frame, unit), x))
            }
        }
    }

    /// The same strip (nearly) on as many equal spans as suit its form.
    pub fn refitted(&self, x: &[f64], spans: usize) -> Option<(Self, Vec<f64>)> {
        match self {
            Self::Dual(family, scale) => {
                let (family, x) = family.refitted(x, spans, MARGIN)?;
                Some((Self::Dual(family, *scale), x))
            }
            Self::Primal(family, frame, unit) => {
                let (a, b) = family.foot_range();
                let (lo, hi) = (a - MARGIN * (b - a), b + MARGIN * (b - a));
                let [profile, slopes] = PRIMAL.map(|share| ((share * spans as f64) as usize).max(2));
                // Breaks of the slopes are among those of the profile.
                let parts = profile.div_ceil(slopes);
                let breaks: Vec<f64> =
                    (0..=parts * slopes).map(|i| lo + (hi - lo) * i as f64 / (parts * slopes) as f64).collect();
                let coarse = breaks.iter().step_by(parts).copied().collect();
                let (family, x) = family.changed(x, breaks, Slopes::Spline(coarse))?;
                Some((Self::Primal(family, *frame, *unit), x))
            }
        }
    }

    /// A point (mm) in the strip's own coordinates.
    pub fn point(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Dual(_, scale) => scale.point(x),
            Self::Primal(_, frame, unit) => frame.to_local(x) / *unit,
        }
    }

    /// The unit of length, mm.
    pub fn unit(&self) -> f64 {
        match self {
            Self::Dual(_, scale) => scale.unit,
            Self::Primal(_, _, unit) => *unit,
        }
    }

    /// Fast form in the strip's own coordinates.
    pub fn sheet(&self, x: &[f64]) -> Sheet {
        either!(self, family => family.sheet(x))
    }

    /// Unit normal, in space, of the ruling that is the foot of a point.
    pub fn normal(&self, sheet: &Sheet, index: usize) -> Vec3 {
        let n = sheet.jet(self.found()[index]).n.normalize();
        match self {
            Self::Dual(..) => n,
            Self::Primal(_, frame, _) => frame.vector_to_world(&n),
        }
    }

    /// Points in the strip's own coordinates.
    pub fn points(&self) -> &[Vec3] {
        either!(self, family => &family.points)
    }

    /// See [`Form::points`].
    pub fn points_mut(&mut self) -> &mut [Vec3] {
        either!(self, family => &mut family.points)
    }

    /// Feet of the points.
    pub fn found(&self) -> &[f64] {
        either!(self, family => &family.feet)
    }

    /// The strip in mm on a domain that reaches a little beyond its feet, and the largest distance of a sample, mm.
    pub fn finished(&self, x: &[f64], samples: &[Sample]) -> Option<(Torse, f64)> {
        match self {
            Self::Dual(family, scale) => {
                let Sheet::Dual { planes } = family.sheet(x) else { return None };
                let (a, b) =
                    family.feet.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
                let (lo, hi) = planes.domain();
                let margin = MARGIN * (b - a);
                let shortest = 0.25 * (hi - lo) / planes.power.len() as f64;
                let mut planes = planes.on(a - margin, b + margin, shortest).to_curve().ok()?;
                for c in &mut planes.control {
                    *c = scale.plane_back(c);
                }
                let torse = Torse::Dual(DualTorse { planes });
                let error = error(&torse, samples)?.0;
                Some((torse, error))
            }
            Self::Primal(family, frame, unit) => {
                let fit = primal::finished(*frame, *unit, family, x, PanelKind::Torse, samples)?;
                Some((fit.torse, fit.error))
            }
        }
    }
}

impl Family for Form {
    fn unknowns(&self) -> usize {
        either!(self, family => family.unknowns())
    }

    fn width(&self) -> usize {
        either!(self, family => family.width())
    }

    fn residuals(&mut self, x: &[f64], active: &[usize], out: &mut Vec<f64>) -> bool {
        either!(self, family => family.residuals(x, active, out))
    }

    fn adopt(&mut self, active: &[usize]) {
        either!(self, family => family.adopt(active));
    }

    fn feet(&mut self) -> &mut Vec<f64> {
        either!(self, family => &mut family.feet)
    }

    fn irregular(&mut self, x: &[f64], samples: &[usize]) -> Vec<usize> {
        either!(self, family => family.irregular(x, samples))
    }

    fn jacobian(&mut self, x: &[f64], active: &[usize], residual: &[f64], rows: &mut Rows) {
        either!(self, family => family.jacobian(x, active, residual, rows));
    }

    fn soft(&self, x: &[f64], count: usize, error: f64, rows: &mut Rows, residual: &mut Vec<f64>) {
        either!(self, family => family.soft(x, count, error, rows, residual));
    }

    fn fairness(&self, rows: &mut Rows) {
        either!(self, family => family.fairness(rows));
    }

    fn firmness(&self) -> f64 {
        either!(self, family => family.firmness())
    }

    fn step_share(&self, x: &[f64], d: &[f64]) -> f64 {
        either!(self, family => family.step_share(x, d))
    }
}
