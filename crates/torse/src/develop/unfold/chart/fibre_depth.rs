//! Where the neutral fibre lies along a face without closed form: its depth by the bend of every ruling, inflections, and the
//! stretches that are bent one way.

use super::ruled::{FlatRuling, Ruled, RulingJet, HAIR, STEPS};
use super::{Chart, Kind};
use crate::develop::bends::DevelopedRuling;
use crate::geom::Vec2;
use crate::num::quadrature::GAUSS_4;

/// A stretch of a face that is bent one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::develop::unfold) struct Stretch {
    /// Shares of the turn of the face between which it lies.
    pub turn: [f64; 2],
    /// Its share of the way across the rulings.
    pub way: f64,
    /// Whether it is hollow, seen from outside.
    pub hollow: bool,
}

/// Turn (rad) of the normal over a step, or over a stretch, below which the sheet is not bent: rounding of what files hold.
const STRAIGHT: f64 = 1e-9;
/// Halvings that find an inflection: to the bit.
const HALVINGS: usize = 60;
/// Parts of a strip over which depths are averaged.
const PARTS: usize = 4;

impl Chart {
    /// The ruling at a share of the turn, in the plane and in space, with its radii as `radii` finds them at the ends of its image;
    /// `None` for faces in closed form, whose lines tell all of them, and for faces with edges.
    pub(in crate::develop::unfold) fn exact(
        &self,
        share: f64,
        radii: impl Fn(&FlatRuling, [Vec2; 2]) -> [f64; 2],
    ) -> Option<DevelopedRuling> {
        let Kind::Ruled(r) = &self.kind else { return None };
        if !r.jumps.is_empty() {
            return None;
        }
        let flat = r.ruling(share, 0.0)?;
        let (_, s, _) = r.turned(share)?;
        let (l, ends) = (r.line(s)?, r.ruling_ends(s)?);
        let e = l.n.cross(&l.w);
        let images = ends.map(|x| r.flat_on(s, &x));
        Some(DevelopedRuling {
            flat: images,
            space: ends.map(|x| x - l.n * flat.depth),
            across: e * l.dp.dot(&e).signum(),
            normal: l.n,
            radii: radii(&flat, images),
        })
    }
}

impl RulingJet {
    /// Curvature across the ruling, 1/mm: negative where the face is hollow, seen from outside.
    pub(super) fn curvature(&self) -> f64 {
        let e = self.n.cross(&self.w);
        self.dn.dot(&e) / self.dp.dot(&e)
    }
}

impl Ruled {
    /// Depth (mm) of the neutral fibre below a ruling.
    pub(super) fn depth_of(&self, line: &RulingJet) -> f64 {
        let curvature = line.curvature();
        self.fibre.depth(curvature.abs().recip(), curvature < 0.0)
    }

    /// The same below an edge that turns by `turn` (rad), in the middle of three knots: that of a sheet which is bent as much between
    /// the middles of the spans beside it.
    pub(super) fn depth_about(&self, [a, at, b]: [f64; 3], turn: f64) -> Option<f64> {
        let way = |end: f64| {
            let l = self.line(0.5 * (at + end))?;
            Some(0.5 * (end - at).abs() * l.dp.dot(&l.n.cross(&l.w)))
        };
        let way = way(a)? + way(b)?;
        Some(self.fibre.depth((way / turn).abs(), way * turn < 0.0))
    }

    /// Mean depth (mm) between two rulings without knots or inflections between them, by the turn of the normal.
    pub(super) fn depth_between(&self, [a, b]: [f64; 2]) -> f64 {
        if !self.fibre.varies() {
            return self.fibre.depth(f64::INFINITY, true);
        }
        let hair = HAIR * (b - a);
        let (lo, hi) = (a + hair, b - hair);
        let bent = |s: f64| self.line(s).map_or((0.0, 0.0), |l| (l.dn.norm(), self.depth_of(&l)));
        let place = |k: usize| lo + (hi - lo) * k as f64 / PARTS as f64;
        let whole = |f: &mut dyn FnMut(f64) -> f64| -> f64 {
            (0..PARTS).map(|k| GAUSS_4.integrate(place(k), place(k + 1), &mut *f)).sum()
        };
        let turn = whole(&mut |s| bent(s).0);
        let mean = whole(&mut |s| bent(s).0 * bent(s).1) / turn;
        if mean.is_finite() {
            mean
        } else {
            bent(0.5 * (a + b)).1
        }
    }

    /// The knots with the inflections between them.
    pub(super) fn with_inflections(&self) -> Vec<f64> {
        let mut out = vec![self.breaks[0]];
        for w in self.breaks.windows(2) {
            let width = w[1] - w[0];
            let bent = |s: f64| self.line(s).filter(|l| l.dn.norm() * width > STRAIGHT).map(|l| l.curvature() < 0.0);
            let mut before: Option<(f64, bool)> = None;
            for k in 0..STEPS {
                let s = w[0] + width * (k as f64 + 0.5) / STEPS as f64;
                let Some(hollow) = bent(s) else { continue };
                if let Some((from, _)) = before.filter(|b| b.1 != hollow) {
                    let (mut lo, mut hi) = (from, s);
                    for _ in 0..HALVINGS {
                        let m = 0.5 * (lo + hi);
                        let there = self.line(m).map_or(hollow, |l| l.curvature() < 0.0);
                        *(if there == hollow { &mut hi } else { &mut lo }) = m;
                    }
                    out.push(hi);
                }
                before = Some((s, hollow));
            }
            out.push(w[1]);
        }
        out
    }

    /// See [`super::Chart::stretches`]; what turns by rounding goes with its neighbours.
    pub(super) fn stretches(&self) -> Vec<Stretch> {
        let whole = self.nodes[self.nodes.len() - 1].1.bent;
        let mut out: Vec<(f64, f64, bool)> = Vec::new();
        let mut start = 0.0;
        let mut way = 0.0;
        for (k, w) in self.nodes.windows(2).enumerate() {
            let ((a, p), (b, q)) = (w[0], w[1]);
            way += (q.base - p.base).norm();
            if q.bent - p.bent <= STRAIGHT {
                continue;
            }
            let Some(l) = self.line(0.5 * (a + b)) else { continue };
            let hollow = match self.jumps.iter().find(|j| j.node == k + 1) {
                Some(j) => j.turn * l.dp.dot(&l.n.cross(&l.w)) < 0.0,
                None => l.curvature() < 0.0,
            };
            match out.last_mut() {
                Some(last) if last.2 == hollow => (last.0, last.1) = (q.bent, last.1 + way),
                _ => out.push((q.bent, way, hollow)),
            }
            way = 0.0;
        }
        let ways: f64 = out.iter().map(|s| s.1).sum();
        let count = out.len();
        let stretch = |(k, (end, way, hollow)): (usize, (f64, f64, bool))| {
            let from = start / whole;
            start = end;
            Stretch { turn: [from, if k + 1 == count { 1.0 } else { end / whole }], way: way / ways, hollow }
        };
        out.into_iter().enumerate().map(stretch).collect()
    }
}
