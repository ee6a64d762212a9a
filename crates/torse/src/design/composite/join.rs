//! Rows of joins: along rulings, along common curves, at ends of curves \[W15, TBWP16\].

use super::build::Builder;
use super::built::Item;
use super::identify::end;
use super::{Edge, Join, Place, Smoothness, StripShape};
use crate::constraint::coplanarity::Coplanarity;
use crate::constraint::developability::freedom_per_interval;
use crate::constraint::fold::Fold;
use crate::constraint::handle::Vanish;
use crate::constraint::join::{SameCurvature, SameDirection};
use crate::constraint::stencil::Stencil;
use crate::num::gauss_newton::Role;

/// What smooth joins are called where they stand in the way.
const SMOOTH: &str = "smooth joins";
/// The same for folds.
const FOLDS: &str = "folds";
/// Weight of the condition of a fold at places between those where it is held, beside rows of weight one.
const BETWEEN: f64 = 0.3;

impl Builder<'_> {
    pub(super) fn join(&mut self, k: usize) {
        match &self.composite.joins[k] {
            Join::Ruling { first, second, smoothness } => {
                let strips = (self.composite.strip(first), self.composite.strip(second));
                if let (Some(first), Some(second)) = strips {
                    self.ruling(k, first, second, *smoothness);
                }
            }
            Join::Curve { curve, edge } => {
                if let Some(curve) = self.composite.curve(curve) {
                    self.edge(k, curve, *edge);
                }
            }
            Join::Ends { ends, smoothness } => self.ends(k, ends, *smoothness),
        }
    }

    fn ruling(&mut self, k: usize, first: usize, second: usize, smoothness: Smoothness) {
        let ([p, q], [r, s]) = (self.sides[first], self.sides[second]);
        match smoothness {
            Smoothness::G0 => return,
            Smoothness::C1 { ratio } => {
                for (p, q) in [(p, r), (q, s)] {
                    let last = self.built.points[p].len() - 1;
                    self.legs(k, [(p, last), (q, 0)], ratio);
                }
                return;
            }
            Smoothness::G1 | Smoothness::G2 => {}
        }
        let end = self.composite.curves[p].curve.domain().1;
        let begin = self.composite.curves[r].curve.domain().0;
        let skew = [first, second].iter().any(|&s| self.composite.strips[s].shape == StripShape::Ruled);
        if skew && smoothness == Smoothness::G1 {
            let before = [p, q].map(|c| self.jet(c, end)[1].clone());
            let after = [r, s].map(|c| self.jet(c, begin)[1].clone());
            let block = SameDirection::both(before.each_ref(), after.each_ref());
            return self.add(block, Role::Hard, SMOOTH, Item::Join(k));
        }
        let ruling = self.jet(s, begin)[0].clone().minus(&self.jet(r, begin)[0]);
        for (p, q) in [(p, r), (q, s)] {
            let [_, d, e] = self.jet(p, end);
            let [_, f, g] = self.jet(q, begin);
            self.add(SameDirection::new(&d, &f), Role::Hard, SMOOTH, Item::Join(k));
            if smoothness == Smoothness::G2 {
                let block = SameCurvature::new([&d, &e], [&f, &g], &ruling);
                self.add(block, Role::Hard, "joins of equal curvature", Item::Join(k));
            }
        }
    }

    fn edge(&mut self, k: usize, curve: usize, edge: Edge) {
        let name = &self.composite.curves[curve].name;
        let others: Vec<usize> = (0..self.composite.strips.len())
            .filter(|&s| self.composite.strips[s].sides.contains(name))
            .map(|s| {
                let [a, b] = self.sides[s];
                if a == curve {
                    b
                } else {
                    a
                }
            })
            .collect();
        let &[one, two] = &others[..] else { return };
        let knots = &self.composite.curves[curve].curve.knots;
        let degree = knots.degree();
        let inner = knots.distinct();
        let multiplicity = inner.iter().skip(1).rev().skip(1).map(|k| k.1).min().unwrap_or(degree);
        // Two strips and their edge gain three control points where one strip gains two.
        let free = 2 * freedom_per_interval(degree, multiplicity) - 3 * multiplicity as isize;
        let count = match edge {
            Edge::Fold => (free / 2).clamp(1, 2) as usize,
            Edge::Smooth => degree,
        };
        let between = match edge {
            Edge::Fold => 2 * degree,
            Edge::Smooth => 0,
        };
        for w in knots.breaks().windows(2) {
            let places = |count: usize| {
                let at = move |i: usize| w[0] + (w[1] - w[0]) * (i as f64 + 0.5) / count as f64;
                (0..count).map(at)
            };
            for u in places(between) {
                let block = self.fold(curve, [one, two], u);
                self.add(block, Role::Soft { weight: BETWEEN, fades: false }, FOLDS, Item::Join(k));
            }
            for u in places(count) {
                let [c, d, _] = self.jet(curve, u);
                let r = [one, two].map(|o| self.jet(o, u)[0].clone().minus(&c));
                match edge {
                    Edge::Fold => {
                        let block = self.fold(curve, [one, two], u);
                        self.add(block, Role::Hard, FOLDS, Item::Join(k));
                    }
                    Edge::Smooth => {
                        let block = Coplanarity::new(&r[0], &d, &r[1]);
                        self.add(block, Role::Hard, SMOOTH, Item::Join(k));
                    }
                }
            }
        }
    }

    /// The condition of a fold at a place of its curve, with the other sides of both strips.
    fn fold(&self, curve: usize, others: [usize; 2], u: f64) -> Fold {
        let [c, d, e] = self.jet(curve, u);
        let [r, s] = others.map(|o| self.jet(o, u)[0].clone().minus(&c));
        Fold::new(&d, &e, [&r, &s])
    }

    /// Two curves that meet at their ends.
    fn ends(&mut self, k: usize, ends: &[Place; 2], smoothness: Smoothness) {
        let [Some(p), Some(q)] = ends.each_ref().map(|e| end(self.composite, e)) else { return };
        match smoothness {
            Smoothness::G0 | Smoothness::G2 => {}
            Smoothness::C1 { ratio } => self.legs(k, [p, q], ratio),
            Smoothness::G1 => {
                let [d, f] = [p, q].map(|e| self.leg(e));
                self.add(SameDirection::new(&d.times(-1.0), &f), Role::Hard, SMOOTH, Item::Join(k));
            }
        }
    }

    /// The leg of the control polygon that leaves an end.
    pub(super) fn leg(&self, (curve, at): (usize, usize)) -> Stencil {
        let points = &self.built.points[curve];
        let next = if at == 0 { 1 } else { at - 1 };
        Stencil::point(points[next]).minus(&Stencil::point(points[at]))
    }

    /// One leg goes on where the other came from, so many times as long.
    fn legs(&mut self, k: usize, ends: [(usize, usize); 2], ratio: f64) {
        let [before, after] = ends.map(|e| self.leg(e));
        let row = after.plus(&before.times(ratio));
        self.add(Vanish::new(&row, 1.0), Role::Hard, SMOOTH, Item::Join(k));
    }
}
