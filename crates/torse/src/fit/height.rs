//! A torse as a height over a face, along the face's normals; where the heights of two torses are equal, they intersect.
//!
//! *Method* (\[SE06\] carried on): the foot of a point on the torse from a table of rulings, then Newton steps along the
//! normal.

use crate::fit::near::power_form::{Guesses, PowerForm};
use crate::fit::panels::line_intersection::on_normal;
use crate::geom::Vec3;
use crate::torse::form::Torse;

/// Heights of a torse.
pub struct Height<'a> {
    torse: &'a Torse,
    power_form: PowerForm,
    guesses: Guesses,
}

impl<'a> Height<'a> {
    /// `None` for splines of higher degree than cubic.
    pub fn of(torse: &'a Torse) -> Option<Self> {
        let power_form = PowerForm::of(torse)?;
        let guesses = power_form.guesses();
        Some(Self { torse, power_form, guesses })
    }

    /// Signed length (mm) from `x` (mm) along the unit normal `n` to the torse; `None` where it has no ruling near. *Not
    /// guaranteed*: that the sheet of the torse is the one on the panel's side of the regression curve.
    pub fn at(&self, x: &Vec3, n: &Vec3) -> Option<f64> {
        let q = self.power_form.local(x);
        let guess = self.guesses.guess(&q);
        let along = |guess: f64| on_normal(x, n, self.torse, guess).map(|(_, y)| n.dot(&(y - x)));
        along(guess).or_else(|| along(self.power_form.nearest_foot(&q)?)).filter(|h| h.is_finite())
    }

    /// Whether both are heights of one torse.
    pub fn is_of_the_torse_of(&self, other: &Self) -> bool {
        self.torse == other.torse
    }
}
