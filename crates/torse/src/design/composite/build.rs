//! From a composite to unknowns and rows.

use super::built::{Built, HandleAt, Item};
use super::check::{check, curve_item, handle_item, CompositeError, SAME};
use super::freedom::too_much;
use super::handle::{Handle, Hold, Strength};
use super::identify::{identified, Identified};
use super::{Composite, Edge, Join, Options, StripShape};
use crate::constraint::border::AtBorder;
use crate::constraint::coplanarity::{InPlane, Unit};
use crate::constraint::developability::{samples, KForm, NForm, StripPoints};
use crate::constraint::distance::Distance;
use crate::constraint::fairness::{across, differences, greville};
use crate::constraint::handle::{OnPlane, Parallel, Vanish};
use crate::constraint::proximity::Proximity;
use crate::constraint::stencil::Stencil;
use crate::geom::Vec3;
use crate::num::gauss_newton::{Role, System};

/// Share of the margin that rulings keep beyond it where they are asked: between them the regression curve comes nearer, and
/// a proof needs room.
const ROOM: f64 = 0.1;

/// Places on a ruling that is a border, as shares of it.
const ON_RULING: [f64; 3] = [0.25, 0.5, 0.75];

/// Places begin no farther than this share of the size from the border that they are drawn to: what is farther away is not
/// meant to be that border.
const REACH: f64 = 0.25;

/// Which equations say that a ruling is torsal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// With a bound for the regression curve, for editing.
    K,
    /// With a normal, for the polish.
    N,
}

/// Weight of places as they were given beside differences of control points: of ruled strips, and of developables, which targets
/// must lead farther.
const STAY: [f64; 2] = [2.0, 0.5];

pub(super) struct Builder<'a> {
    pub composite: &'a Composite,
    options: &'a Options,
    form: Form,
    /// Curves of both sides, by strip.
    pub sides: Vec<[usize; 2]>,
    pub built: Built,
}

/// Sets up a composite.
pub(super) fn build(composite: &Composite, options: &Options, form: Form) -> Result<Built, CompositeError> {
    check(composite)?;
    let Identified { start, points, scale } = identified(composite);
    let system = System::new(start.len());
    let built = Built { system, start, points, handles: Vec::new(), items: Vec::new(), scale };
    let curve = |name: &String| composite.curve(name).unwrap_or(0);
    let sides = composite.strips.iter().map(|s| s.sides.each_ref().map(curve)).collect();
    let mut b = Builder { composite, options, form, sides, built };
    b.fixed_curves()?;
    (0..composite.handles.len()).try_for_each(|k| b.handle(k))?;
    (0..composite.strips.len()).for_each(|k| b.strip(k));
    (0..composite.facets.len()).for_each(|k| b.facet(k));
    (0..composite.joins.len()).for_each(|k| b.join(k));
    (0..composite.lengths.len()).for_each(|k| b.length(k));
    (0..composite.targets.len()).for_each(|k| b.target(k));
    b.fairness();
    let (conditions, free) = (b.built.system.conditions().sum(), b.built.system.free());
    if conditions > free && !options.redundant {
        let (item, help) = too_much(composite, &b.built);
        return Err(CompositeError::OverDetermined { item, conditions, free, help });
    }
    Ok(b.built)
}

impl Builder<'_> {
    /// Value and derivatives of a curve; those with respect to the length of the piece at `u`.
    pub(super) fn jet(&self, curve: usize, u: f64) -> [Stencil; 3] {
        let knots = &self.composite.curves[curve].curve.knots;
        let span = knots.span(u);
        let unit = knots.values()[span + 1] - knots.values()[span];
        Stencil::jet(knots, &self.built.points[curve], u, unit)
    }

    fn local(&self, p: &Vec3) -> Vec3 {
        (p - self.built.scale.origin) / self.built.scale.size
    }

    /// A frozen vector.
    fn given(&mut self, v: Vec3) -> u32 {
        let first = self.built.start.len() as u32;
        for x in v.iter() {
            let k = self.built.system.unknown();
            self.built.system.freeze(k);
            self.built.start.push(*x);
        }
        first
    }

    pub(super) fn add(
        &mut self,
        block: impl crate::num::gauss_newton::Block + 'static,
        role: Role,
        class: &str,
        item: Item,
    ) {
        let class = self.built.system.class(class);
        self.built.system.add(block, role, class);
        self.built.items.push(item);
    }

    pub(super) fn at(&self, p: u32) -> Vec3 {
        Vec3::from_column_slice(&self.built.start[p as usize..p as usize + 3])
    }

    fn freeze(&mut self, p: u32) {
        (p..p + 3).for_each(|k| self.built.system.freeze(k));
    }

    /// Fixed curves: their control points are frozen, unless two of them ask for different places of one.
    fn fixed_curves(&mut self) -> Result<(), CompositeError> {
        for (k, curve) in self.composite.curves.iter().enumerate().filter(|(_, c)| c.fixed) {
            for (i, p) in curve.curve.control.iter().enumerate() {
                let unknown = self.built.points[k][i];
                let distance = (self.local(&Vec3::from(*p)) - self.at(unknown)).norm();
                if distance > SAME {
                    let other = self
                        .composite
                        .curves
                        .iter()
                        .enumerate()
                        .find(|(j, o)| *j != k && o.fixed && self.built.points[*j].contains(&unknown));
                    let second = other.map_or("a join".into(), |(j, o)| format!("fixed curve {j} '{}'", o.name));
                    let distance = 2.0 * distance * self.built.scale.size;
                    let first = curve_item(self.composite, k, "fixed curve");
                    return Err(CompositeError::Contradiction { first, second, distance });
                }
                self.freeze(unknown);
            }
        }
        Ok(())
    }

    /// Rows of a handle, or a frozen control point where the place is one.
    fn handle(&mut self, k: usize) -> Result<(), CompositeError> {
        let h = &self.composite.handles[k];
        let curve = self.composite.curve(&h.place.curve).unwrap_or(0);
        self.not_contradicted(k, h, curve)?;
        let [place, slope, _] = self.jet(curve, h.place.u);
        let role = match h.strength {
            Strength::Exact => Role::Hard,
            Strength::Pull(weight) => Role::Soft { weight, fades: true },
        };
        let (a, b) = self.composite.curves[curve].curve.domain();
        let end = (h.place.u <= a || h.place.u >= b).then(|| {
            let p = &self.built.points[curve];
            if h.place.u <= a {
                p[0]
            } else {
                p[p.len() - 1]
            }
        });
        let at = match (h.hold, end, h.strength) {
            (Hold::Point(target), Some(control), Strength::Exact) => {
                let target = self.local(&target);
                self.freeze(control);
                self.built.start[control as usize..control as usize + 3].copy_from_slice(target.as_slice());
                HandleAt::Control(control)
            }
            (Hold::Point(target), ..) => {
                let target = self.given(self.local(&target));
                self.add(Vanish::at(&place, target), role, "point handles", Item::Handle(k));
                HandleAt::Vector(target)
            }
            (Hold::Tangent(t), ..) => {
                let direction = self.given(t.normalize());
                self.add(Parallel::new(&slope, direction), role, "tangent handles", Item::Handle(k));
                HandleAt::Vector(direction)
            }
            (Hold::Plane { point, normal }, ..) => {
                let (o, n) = (self.given(self.local(&point)), self.given(normal.normalize()));
                self.add(OnPlane::new(&place, o, n), role, "plane handles", Item::Handle(k));
                HandleAt::Plane(o, n)
            }
        };
        self.built.handles.push(at);
        Ok(())
    }

    /// Compares an exact point handle with fixed control points and with the handles before it.
    fn not_contradicted(&self, k: usize, h: &Handle, curve: usize) -> Result<(), CompositeError> {
        let (Hold::Point(target), Strength::Exact) = (h.hold, h.strength) else { return Ok(()) };
        let unit = self.built.scale.size;
        let earlier = &self.composite.handles[..k];
        let same = |o: &Handle| match (o.hold, o.strength) {
            (Hold::Point(p), Strength::Exact) if o.place == h.place => Some((p - target).norm()),
            _ => None,
        };
        let other = earlier.iter().enumerate().find_map(|(j, o)| Some((j, same(o)?)));
        let held = match other {
            Some((j, distance)) => Some((handle_item(j, &earlier[j]).to_string(), distance)),
            None => {
                let mut here = self.jet(curve, h.place.u)[0].clone();
                here.0.retain(|t| t.1 != 0.0);
                let fixed = here.0.iter().all(|t| self.built.system.is_frozen(t.0));
                // At the end of a curve that goes on, a handle of the other curve may hold the same control point.
                let by = here.0.first().map(|t| HandleAt::Control(t.0));
                let by = self.built.handles.iter().position(|a| Some(*a) == by);
                let words =
                    by.map_or(format!("fixed curve '{}'", h.place.curve), |j| handle_item(j, &earlier[j]).to_string());
                fixed.then(|| (words, (here.value(&self.built.start) - self.local(&target)).norm() * unit))
            }
        };
        match held {
            Some((second, distance)) if distance > SAME * unit => {
                Err(CompositeError::Contradiction { first: handle_item(k, h), second, distance })
            }
            _ => Ok(()),
        }
    }

    fn strip(&mut self, k: usize) {
        let [a, b] = self.sides[k];
        let composite = self.composite;
        let knots = &composite.curves[a].curve.knots;
        let margin = match composite.strips[k].shape {
            StripShape::Planar => return self.planar(k, a, b),
            StripShape::Ruled => return,
            StripShape::Developable { margin } => margin * (1.0 + ROOM),
        };
        let (pa, pb) = (self.built.points[a].clone(), self.built.points[b].clone());
        let strip = StripPoints { knots, a: &pa, b: &pb };
        for (u, unit) in samples(knots) {
            let item = Item::Ruling { strip: k, u };
            match self.form {
                Form::K => self.add(KForm::new(strip, u, unit, margin), Role::Hard, "developability", item),
                Form::N => self.add(NForm::new(strip, u, unit), Role::Hard, "developability", item),
            }
        }
    }

    /// A planar strip: an unknown plane with all control points in it.
    fn planar(&mut self, k: usize, a: usize, b: usize) {
        let points: Vec<u32> = self.built.points[a].iter().chain(&self.built.points[b]).copied().collect();
        self.plane(points, Item::Plane { strip: k });
    }

    /// An unknown plane with these points in it.
    pub(super) fn plane(&mut self, mut points: Vec<u32>, item: Item) {
        points.sort_unstable();
        points.dedup();
        let places: Vec<Vec3> = points.iter().map(|&p| self.at(p)).collect();
        let middle = places.iter().sum::<Vec3>() / places.len().max(1) as f64;
        let moment: nalgebra::Matrix3<f64> = places.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
        let eigen = moment.symmetric_eigen();
        let normal: Vec3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        let first = self.built.start.len() as u32;
        (0..4).for_each(|_| {
            self.built.system.unknown();
        });
        self.built.start.extend_from_slice(normal.as_slice());
        self.built.start.push(-normal.dot(&middle));
        self.add(Unit::new(first), Role::Hard, "planarity", item);
        for p in points {
            self.add(InPlane::new(&Stencil::point(p), first, first + 3), Role::Hard, "planarity", item);
        }
    }

    fn length(&mut self, k: usize) {
        let l = &self.composite.lengths[k];
        let place = |p: &super::Place| self.jet(self.composite.curve(&p.curve).unwrap_or(0), p.u)[0].clone();
        let between = place(&l.between[1]).minus(&place(&l.between[0]));
        let block = Distance::new(&between, l.length / self.built.scale.size);
        self.add(block, Role::Hard, "lengths", Item::Length(k));
    }

    fn target(&mut self, k: usize) {
        let t = &self.composite.targets[k];
        let (weight, scale) = (t.weight, self.built.scale);
        let begins = |b: &Self, place: &Stencil| scale.origin + place.value(&b.built.start) * scale.size;
        let mut places = Vec::new();
        for s in 0..self.composite.strips.len() {
            if !(t.strips.is_empty() || t.strips.contains(&self.composite.strips[s].name)) {
                continue;
            }
            let [a, b] = self.sides[s];
            let knots = &self.composite.curves[a].curve.knots;
            let degree = knots.degree();
            for w in knots.breaks().windows(2) {
                for i in 0..=degree {
                    let u = w[0] + (w[1] - w[0]) * (i as f64 + 0.5) / (degree + 1) as f64;
                    let (p, q) = (self.jet(a, u)[0].clone(), self.jet(b, u)[0].clone());
                    for v in [0.0, 0.5, 1.0] {
                        places.push(p.clone().times(1.0 - v).plus(&q.clone().times(v)));
                    }
                }
            }
        }
        let begun: Vec<Vec3> = places.iter().map(|p| begins(self, p)).collect();
        for (place, _) in places.iter().zip(t.reference.meets(&begun)).filter(|p| p.1) {
            let block = Proximity::new(place, t.reference.clone(), scale);
            self.add(block, Role::Soft { weight, fades: true }, "targets", Item::Target(k));
        }
        if let Some(border) = &t.border {
            for place in self.border_places(&t.strips) {
                if border.distance(&begins(self, &place)) > REACH * scale.size {
                    continue;
                }
                let block = AtBorder::new(&place, border.clone(), scale);
                self.add(block, Role::Soft { weight, fades: true }, "targets", Item::Target(k));
            }
        }
    }

    /// Places on the border of the strips with these names, or of all: on curves that one of them has for a side, and on
    /// first and last rulings at which none goes on.
    fn border_places(&self, names: &[String]) -> Vec<Stencil> {
        let composite = self.composite;
        let chosen = |s: &usize| names.is_empty() || names.contains(&composite.strips[*s].name);
        let strips: Vec<usize> = (0..composite.strips.len()).filter(chosen).collect();
        let uses = |c: usize| strips.iter().flat_map(|s| self.sides[*s]).filter(|o| *o == c).count();
        let goes_on = |s: usize, last: bool| {
            let name = &composite.strips[s].name;
            composite.joins.iter().any(|j| match j {
                Join::Ruling { first, second, .. } => {
                    if last {
                        first == name
                    } else {
                        second == name
                    }
                }
                _ => false,
            })
        };
        let mut out = Vec::new();
        for &s in &strips {
            let [a, b] = self.sides[s];
            let knots = &composite.curves[a].curve.knots;
            let per_piece = knots.degree() + 1;
            for c in [a, b].into_iter().filter(|c| uses(*c) == 1) {
                for w in knots.breaks().windows(2) {
                    let at = |i: usize| w[0] + (w[1] - w[0]) * i as f64 / per_piece as f64;
                    out.extend((0..per_piece).map(|i| self.jet(c, at(i))[0].clone()));
                }
            }
            let (first, last) = composite.curves[a].curve.domain();
            for u in [(first, false), (last, true)].into_iter().filter(|e| !goes_on(s, e.1)).map(|e| e.0) {
                let (p, q) = (self.jet(a, u)[0].clone(), self.jet(b, u)[0].clone());
                out.extend(ON_RULING.map(|v| p.clone().times(1.0 - v).plus(&q.clone().times(v))));
            }
        }
        out
    }

    /// Differences along curves and across strips, and a metric in which smooth displacements are short.
    /// A difference, or how far it is from what it was in the curves as given: developables that follow targets are as fair as
    /// they were given, and only what moves them is smoothed.
    fn as_given(&mut self, difference: Stencil) -> Stencil {
        if self.composite.targets.is_empty() || self.composite.is_ruled() {
            return difference;
        }
        let was = difference.value(&self.built.start);
        let was = self.given(was);
        difference.minus(&Stencil::point(was))
    }

    fn fairness(&mut self) {
        let role = Role::Fair { weight: 1.0 };
        for (k, curve) in self.composite.curves.iter().enumerate() {
            let (g, points) = (greville(&curve.curve.knots), self.built.points[k].clone());
            for order in [2, 3] {
                for s in differences(&g, &points, order) {
                    let s = self.as_given(s);
                    self.add(Vanish::new(&s, self.options.fairness), role, "fairness", Item::Fairness);
                }
            }
            let weight = self.options.smoothness * points.len() as f64;
            for s in differences(&g, &points, 2) {
                for d in 0..3 {
                    let row = s.0.iter().map(|t| (t.0 + d, t.1)).collect();
                    self.built.system.measure(weight, row);
                }
            }
        }
        // Targets say nothing of places along them: there, strips stay where they were given.
        if !self.composite.targets.is_empty() {
            let weight = STAY[usize::from(!self.composite.is_ruled())];
            let points: std::collections::BTreeSet<u32> = self.built.points.iter().flatten().copied().collect();
            for p in points {
                let given = self.given(self.at(p));
                let row = Vanish::at(&Stencil::point(p), given);
                self.add(row, Role::Fair { weight }, "fairness", Item::Fairness);
            }
        }
        let folds = |name: &String| {
            let of = |j: &Join| matches!(j, Join::Curve { curve, edge: Edge::Fold } if curve == name);
            self.composite.joins.iter().any(of)
        };
        let folded: Vec<bool> = self.composite.curves.iter().map(|c| folds(&c.name)).collect();
        for (k, strip) in self.composite.strips.iter().enumerate() {
            // Ruled strips, and those beside folds: rulings that follow each other differ little.
            if strip.shape == StripShape::Ruled || self.sides[k].iter().any(|&c| folded[c]) {
                let [a, b] = self.sides[k].map(|c| self.built.points[c].clone());
                for i in 1..a.len() {
                    let row = Stencil(vec![(b[i], 1.0), (a[i], -1.0), (b[i - 1], -1.0), (a[i - 1], 1.0)]);
                    self.add(Vanish::new(&row, self.options.fairness), role, "fairness", Item::Fairness);
                }
            }
        }
        // Strips on both sides of a curve, whichever side of each it is.
        let sides = &self.sides;
        let beside = |(s, t): (usize, usize)| {
            let pairs = [[0, 0], [0, 1], [1, 0], [1, 1]].into_iter();
            let common = pairs.filter(move |[i, j]| sides[s][*i] == sides[t][*j]);
            common.map(move |[i, j]| [sides[s][1 - i], sides[s][i], sides[t][1 - j]])
        };
        let pairs = (0..sides.len()).flat_map(|t| (0..t).map(move |s| (s, t)));
        // Across a fold nothing goes on, nor between two strips that have both curves in common.
        let goes_on = |t: &[usize; 3]| !folded[t[1]] && t[0] != t[2];
        let triples: Vec<[usize; 3]> = pairs.flat_map(beside).filter(goes_on).collect();
        for [a, middle, b] in triples {
            let rows = self.built.points[a].iter().zip(&self.built.points[middle]).zip(&self.built.points[b]);
            let rows: Vec<Stencil> = rows.map(|((p, q), r)| across(*p, *q, *r)).collect();
            for row in rows {
                let row = self.as_given(row);
                self.add(Vanish::new(&row, self.options.fairness), role, "fairness", Item::Fairness);
            }
        }
    }
}
