//! Strips as envelopes of planes; see [`super::strip`].

use super::form::{Band, Foot, Form, Tie};
use super::profile::PER_SPAN;
use crate::geom::Vec3;
use crate::num::runs::Runs;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::spline::pieces::Pieces;
use crate::torse::form::{DualTorse, Torse};

/// A strip as the envelope of planes on equal spans.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    torse: Torse,
    /// For every control plane the unit ruling at its Greville parameter and the middle of the strip there.
    levers: Vec<(Vec3, Vec3)>,
    half_width: f64,
    /// Rulings at which steps are damped: parameter, and points on the middle and both borders.
    rulings: Vec<(f64, [Vec3; 3])>,
}

impl Envelope {
    /// The planes of a dual torse anew on equal spans over a range.
    pub fn new(d: &DualTorse, range: (f64, f64), spans: usize) -> Option<Self> {
        let pieces = Pieces::of(&d.planes)?;
        let knots = Knots::uniform(3, spans, range.0, range.1).ok()?;
        let count = PER_SPAN * spans;
        let at: Vec<f64> = (0..=count)
            .map(|i| if i == count { range.1 } else { range.0 + (range.1 - range.0) * i as f64 / count as f64 })
            .collect();
        let planes: Vec<[f64; 4]> = at.iter().map(|&t| pieces.jet(t)[0]).collect();
        let planes = lsq::fit(&planes, &at, &knots).ok()?.curve;
        let torse = Torse::Dual(DualTorse { planes });
        Some(Self { torse, levers: Vec::new(), half_width: 1.0, rulings: Vec::new() })
    }

    fn planes(&self) -> &Curve<4> {
        match &self.torse {
            Torse::Dual(d) => &d.planes,
            Torse::Primal(_) | Torse::Cylinder(_) => unreachable!("an envelope is made of planes"),
        }
    }

    /// Parameters at which control planes are felt most.
    pub fn greville(&self) -> Vec<f64> {
        let v = self.planes().knots.values();
        (0..self.planes().control.len()).map(|i| (v[i + 1] + v[i + 2] + v[i + 3]) / 3.0).collect()
    }

    pub fn lie_on(&mut self, band: &Band) {
        self.half_width = band.half_width;
        self.levers = band.rulings.iter().map(|(t, points)| (self.torse.ruling(*t).direction, points[0])).collect();
        self.rulings.clone_from(&band.rulings);
    }

    pub fn moved(&self, change: &[f64]) -> Option<Self> {
        let mut planes = self.planes().clone();
        for ((c, d), (r, o)) in planes.control.iter_mut().zip(change.chunks_exact(2)).zip(&self.levers) {
            let turn = r * (d[0] / self.half_width);
            let h = turn.dot(o) + d[1];
            *c = [c[0] + turn.x, c[1] + turn.y, c[2] + turn.z, c[3] + h];
        }
        let finite = planes.control.iter().flatten().all(|c| c.is_finite());
        finite.then(|| Self { torse: Torse::Dual(DualTorse { planes }), ..self.clone() })
    }

    /// Change of `n·x − h`, or of its derivative, with the unknowns of the control planes that count at `t`.
    fn lifts(&self, x: &Vec3, t: f64, derivative: usize, scale: f64) -> (usize, [f64; 8]) {
        let b = self.planes().knots.basis(t, derivative);
        let mut out = [0.0; 8];
        for j in 0..4 {
            let (r, o) = &self.levers[b.first + j];
            let value = scale * b.rows[derivative][j];
            (out[2 * j], out[2 * j + 1]) = (value * r.dot(&(x - o)) / self.half_width, -value);
        }
        (2 * b.first, out)
    }
}

impl Form for Envelope {
    fn torse(&self) -> &Torse {
        &self.torse
    }

    fn unknowns(&self) -> usize {
        2 * self.planes().control.len()
    }

    fn row(&self, column: usize, x: &Vec3, foot: &Foot, scale: f64, out: &mut Runs) {
        let [a, b, c, _] = self.planes().point(foot.t);
        let n = Vec3::new(a, b, c);
        let (first, values) = self.lifts(x, foot.t, 0, scale * n.dot(&foot.normal).signum() / n.norm());
        out.run(column + first, values);
    }

    /// A change of `n'·X − h'` by c moves the foot; the distance then changes by `c² / 2 g'` more.
    fn damping(&self, column: usize, tolerance: f64, tie: &mut Tie) {
        let weight = tie.damping / (3 * self.rulings.len().max(1)) as f64;
        for (t, points) in &self.rulings {
            let j = self.planes().jet(*t);
            let size = Vec3::new(j[0][0], j[0][1], j[0][2]).norm();
            for x in points {
                let g = self.regular(x, *t).abs().max(f64::MIN_POSITIVE);
                let (first, values) = self.lifts(x, *t, 1, 1.0 / size);
                tie.rows.run(column + first, values);
                tie.end(weight * tolerance / g, 0.0);
            }
        }
    }

    fn sequences(&self) -> Vec<Vec<usize>> {
        let n = self.unknowns();
        vec![(0..n).step_by(2).collect(), (1..n).step_by(2).collect()]
    }

    /// With the foot, which moves by −c/g' where `n'·X − h'` changes by c.
    fn regular_row(&self, column: usize, foot: &Vec3, t: f64, scale: f64, out: &mut Runs) -> Vec3 {
        let planes = self.planes();
        let span = planes.knots.span(t);
        let (a, b) = (planes.knots.values()[span], planes.knots.values()[span + 1]);
        let ends = [a, b].map(|t| planes.knots.basis_on_span(span, t, 2));
        let mut third = [0.0; 4];
        for j in 0..4 {
            let slope = (ends[1].rows[2][j] - ends[0].rows[2][j]) / (b - a);
            (0..4).for_each(|d| third[d] += slope * planes.control[ends[0].first + j][d]);
        }
        let [n, first, second] = planes.jet(t);
        let vector = |c: [f64; 4]| Vec3::new(c[0], c[1], c[2]);
        let value = |c: [f64; 4]| vector(c).dot(foot) - c[3];
        let scale = scale / vector(n).norm();
        let (start, mut values) = self.lifts(foot, t, 2, scale);
        let (_, slopes) = self.lifts(foot, t, 1, scale);
        let moved = value(third) / value(second);
        values.iter_mut().zip(slopes).for_each(|(v, s)| *v -= moved * s);
        out.run(column + start, values);
        (vector(second) - vector(first) * moved) * scale
    }

    fn regular(&self, x: &Vec3, t: f64) -> f64 {
        let j = self.planes().jet(t);
        let v = |c: [f64; 4]| Vec3::new(c[0], c[1], c[2]);
        (v(j[2]).dot(x) - j[2][3]) / v(j[0]).norm()
    }
}
