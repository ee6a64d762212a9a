//! A strip in the joint program: a torse on equal spans with as few unknowns as move it, the change of its distances
//! with them, and the torse after a step.
//!
//! *Method* (\[PW99\], [joint](super)). A torse is two functions of one variable. An envelope of planes has two
//! unknowns per control plane, at its Greville ruling: the turn about the ruling's normal direction in the plane, as the
//! way that this makes half a width from the middle, and the shift; the length of the normal and its tilt along the strip,
//! which move no point to first order, are none. A torse over a profile has those of profile, slope and one constant.

use super::envelope::Envelope;
use super::form::{Band, Foot, Form, Tie};
use super::profile::Profile;
use crate::geom::Vec3;
use crate::num::runs::Runs;
use crate::torse::form::Torse;

/// Share of its domain by which a strip goes on beyond both ends, where a step turns the rulings that were its last.
const GO_ON: f64 = 0.1;

/// A strip under way.
#[derive(Clone, Debug)]
pub(super) enum Strip {
    Planes(Envelope),
    Profile(Profile),
}

impl Strip {
    fn form(&self) -> &dyn Form {
        match self {
            Self::Planes(e) => e,
            Self::Profile(p) => p,
        }
    }

    pub fn torse(&self) -> &Torse {
        self.form().torse()
    }

    pub fn spans(&self) -> usize {
        self.torse().breaks().len() - 1
    }

    pub fn unknowns(&self) -> usize {
        self.form().unknowns()
    }

    pub fn row(&self, column: usize, x: &Vec3, foot: &Foot, scale: f64, out: &mut Runs) {
        self.form().row(column, x, foot, scale, out);
    }

    pub fn regular_row(&self, column: usize, x: &Vec3, foot: &Foot, scale: f64, out: &mut Runs) -> Vec3 {
        self.form().regular_row(column, &foot.least_regular(x), foot.t, scale, out)
    }

    pub fn damping(&self, column: usize, tolerance: f64, tie: &mut Tie) {
        self.form().damping(column, tolerance, tie);
    }

    pub fn sequences(&self) -> Vec<Vec<usize>> {
        self.form().sequences()
    }

    /// The foot of a point near a guess; `side` is −1 where the torse's own normals look away from the face's.
    pub fn foot(&self, x: &Vec3, guess: f64, side: f64) -> Option<Foot> {
        let torse = self.torse();
        let t = torse.foot_within(x, guess, GO_ON)?;
        let ruling = torse.ruling(t);
        let normal = ruling.normal * side;
        let distance = normal.dot(&(x - ruling.point));
        let [below, here] = [x - normal * distance, *x].map(|x| self.form().regular(&x, t));
        let above = here * below.signum() < below.abs();
        let regular = if above { here } else { below };
        (distance.is_finite() && regular.is_finite()).then_some(Foot { t, distance, normal, regular, above })
    }

    /// The strip after a change of its unknowns (mm), with middles and widths of its band. `None` where it degenerates.
    pub fn moved(&self, change: &[f64]) -> Option<Self> {
        match self {
            Self::Planes(e) => e.moved(change).map(Self::Planes),
            Self::Profile(p) => p.moved(change).map(Self::Profile),
        }
    }

    /// The same strip on twice the spans.
    pub fn refined(&self) -> Option<Self> {
        let (torse, spans) = (self.torse(), 2 * self.spans());
        match torse {
            Torse::Dual(d) => Envelope::new(d, torse.domain(), spans).map(Self::Planes),
            Torse::Primal(p) => Profile::new(p, torse.domain(), spans).map(Self::Profile),
            Torse::Cylinder(_) => None,
        }
    }

    /// The strip with another band.
    pub fn on_band(mut self, band: &Band) -> Self {
        match &mut self {
            Self::Planes(e) => e.lie_on(band),
            Self::Profile(p) => p.lie_on(band),
        }
        self
    }
}

/// First guesses of feet: rulings of a torse, three to a span, in segments about its band.
pub(super) struct FootGuesses {
    rulings: Vec<(f64, Vec3, Vec3)>,
}

impl FootGuesses {
    pub fn of(torse: &Torse) -> Self {
        const PER_SPAN: usize = 3;
        let (a, b) = torse.domain();
        let count = PER_SPAN * torse.breaks().len().max(5);
        let at = |i: usize| a + (b - a) * i as f64 / count as f64;
        let of = |t: f64| {
            let r = torse.ruling(t);
            (t, r.point, r.direction)
        };
        Self { rulings: (0..=count).map(at).map(of).filter(|r| r.1.x.is_finite() && r.2.x.is_finite()).collect() }
    }

    /// Parameters of rulings near a point, the nearest first, then each that is nearer than both its neighbours.
    pub fn near(&self, x: &Vec3) -> Vec<f64> {
        let off = |r: &(f64, Vec3, Vec3)| {
            let v = x - r.1;
            v.norm_squared() - v.dot(&r.2).powi(2)
        };
        let all: Vec<f64> = self.rulings.iter().map(off).collect();
        let last = all.len().saturating_sub(1);
        let is_least = |k: &usize| (*k == 0 || all[k - 1] >= all[*k]) && (*k == last || all[k + 1] >= all[*k]);
        let mut least: Vec<usize> = (0..all.len()).filter(is_least).collect();
        least.sort_by(|&a, &b| all[a].total_cmp(&all[b]));
        least.into_iter().map(|k| self.rulings[k].0).collect()
    }
}
