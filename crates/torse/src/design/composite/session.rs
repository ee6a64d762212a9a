//! A composite while somebody pulls on it.

use super::build::{build, Form};
use super::built::{describe, Built, HandleAt, Item};
use super::check::{facet_item, handle_item, hold, strip_item, CompositeError};
use super::facet::places;
use super::handle::Hold;
use super::{Composite, Options, StripShape};
use crate::constraint::proximity::Scale;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::gauss_newton::{Kept, Outcome, Schedule, Solver, Status};
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// How a step ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Why it stopped.
    pub status: Status,
    /// Iterations used.
    pub iterations: usize,
    /// Largest hard row, as a share of the size of all curves.
    pub residual: f64,
    /// Where the step did not converge: the class of conditions that keeps the residual, and the item.
    pub obstacle: Option<(String, String)>,
}

/// Newton steps of a polish at most.
const POLISH_STEPS: usize = 60;

/// A composite with the state of its solver. Steps after the first that converge allocate nothing; searches for nearest points
/// of targets do.
///
/// *Guarantee.* After a step that converged, conditions are met to the tolerance at the places where they are asked for.
/// What lies between is exact up to that, for developability; how far, is for the judge.
pub struct Session {
    composite: Composite,
    options: Options,
    pub(super) solver: Solver,
    items: Vec<Item>,
    points: Vec<Vec<u32>>,
    handles: Vec<HandleAt>,
    scale: Scale,
    polisher: Option<(Solver, Vec<Item>)>,
    good: Good,
}

/// The last state that met all conditions.
#[derive(Default)]
struct Good {
    /// Whether there is one.
    known: bool,
    values: Kept,
    /// What handles held to.
    holds: Vec<Hold>,
}

impl Session {
    /// Sets up unknowns and structure; curves stay as given until the first step.
    ///
    /// # Errors
    /// Anything in the composite that does not make sense, by name; see [`CompositeError`].
    pub fn new(composite: Composite, options: Options) -> Result<Self, CompositeError> {
        let Built { system, start, points, handles, items, scale } = build(&composite, &options, Form::K)?;
        let solver = Solver::new(system, start)?;
        let good = Good::default();
        Ok(Self { composite, options, solver, items, points, handles, scale, polisher: None, good })
    }

    /// The composite as it was given.
    pub fn composite(&self) -> &Composite {
        &self.composite
    }

    /// The composite with the curves as they are now: where a session with other handles or joins begins.
    pub fn snapshot(&self) -> Composite {
        let mut out = self.composite.clone();
        for (k, c) in out.curves.iter_mut().enumerate() {
            c.curve.control = self.control_points(k).map(|p| p.into()).collect();
        }
        out
    }

    /// Number of free coordinates.
    pub fn free(&self) -> usize {
        self.solver.free()
    }

    /// Whether the equations are solved as a band; otherwise by a sparse factorisation.
    pub fn is_banded(&self) -> bool {
        self.solver.is_banded()
    }

    /// Moves a handle, which must hold what it held before (a point, a tangent or a plane).
    ///
    /// # Errors
    /// No such handle, numbers that make no sense.
    pub fn set_handle(&mut self, index: usize, to: Hold) -> Result<(), CompositeError> {
        let wrong = || CompositeError::NoHandle { index, kind: to.name() };
        let handle = self.composite.handles.get(index).ok_or_else(wrong)?;
        hold(&handle_item(index, handle), &to)?;
        if std::mem::discriminant(&handle.hold) != std::mem::discriminant(&to) {
            return Err(wrong());
        }
        let local = |p: Vec3| (p - self.scale.origin) / self.scale.size;
        match (self.handles.get(index), to) {
            (Some(&(HandleAt::Control(k) | HandleAt::Vector(k))), Hold::Point(p)) => put(&mut self.solver, k, local(p)),
            (Some(&HandleAt::Vector(k)), Hold::Tangent(t)) => put(&mut self.solver, k, t.normalize()),
            (Some(&HandleAt::Plane(o, n)), Hold::Plane { point, normal }) => {
                put(&mut self.solver, o, local(point));
                put(&mut self.solver, n, normal.normalize());
            }
            _ => return Err(wrong()),
        }
        if let Some(h) = self.composite.handles.get_mut(index) {
            h.hold = to;
        }
        Ok(())
    }

    /// Solves from far away: the first step, or after a large change. Composites in which nothing has to be developable are
    /// solved by weighted least squares, and then moved by the least way to where hard conditions are met.
    pub fn settle(&mut self, control: &Control) -> Report {
        let schedule = match (self.composite.is_ruled(), self.composite.targets.is_empty()) {
            (true, _) => Schedule::steady(self.options.tolerance),
            (false, true) => Schedule::cold(self.options.tolerance),
            (false, false) => Schedule::gentle(self.options.tolerance),
        };
        self.settle_by(&schedule, control)
    }

    /// Solves by a schedule of the caller's.
    pub fn settle_by(&mut self, schedule: &Schedule, control: &Control) -> Report {
        self.solver.begin();
        self.solved(schedule, control)
    }

    /// Solves after handles have moved a little.
    pub fn step(&mut self, control: &Control) -> Report {
        let schedule = match self.composite.is_ruled() {
            true => Schedule::steady(self.options.tolerance),
            false => Schedule::warm(self.options.tolerance),
        };
        self.solved(&schedule, control)
    }

    fn solved(&mut self, schedule: &Schedule, control: &Control) -> Report {
        let mut outcome = self.solver.solve(schedule, control);
        if self.composite.is_ruled() && outcome.status != Status::Cancelled {
            let iterations = outcome.iterations;
            outcome = self.solver.polish(self.options.tolerance, POLISH_STEPS, control);
            outcome.iterations += iterations;
        }
        if outcome.status == Status::Converged {
            self.good.known = true;
            self.solver.keep(&mut self.good.values);
            self.good.holds.clear();
            self.good.holds.extend(self.composite.handles.iter().map(|h| h.hold));
        }
        self.report(&outcome, &self.solver, &self.items)
    }

    /// Brings strips as near to their targets as what is held and a trace of fairness allow; a solve leaves them where their
    /// fading pull ended. Where the conditions are not met any more after that, nothing is changed. *Not guaranteed*: how near.
    pub fn approach(&mut self, control: &Control) -> Report {
        let mut before = Kept::default();
        self.solver.keep(&mut before);
        let near = self.solver.solve(&Schedule::close(self.options.tolerance), control);
        let mut outcome = self.solver.polish(self.options.tolerance, POLISH_STEPS, control);
        outcome.iterations += near.iterations;
        if outcome.status != Status::Converged {
            self.solver.restore(&before);
        }
        self.report(&outcome, &self.solver, &self.items)
    }

    /// Goes back to the state after the last solve that converged, handles included; answers whether there was one.
    pub fn back(&mut self) -> bool {
        if self.good.known {
            self.solver.restore(&self.good.values);
            for (h, hold) in self.composite.handles.iter_mut().zip(&self.good.holds) {
                h.hold = *hold;
            }
        }
        self.good.known
    }

    /// More digits: all conditions to `tolerance`, a share of the size of all curves, by shortest Newton steps. Soft handles
    /// and targets take no part. Where the equations that bound the regression curve do not get there, those of a normal go
    /// on; rulings that would turn over end that.
    ///
    /// # Errors
    /// The system of the normals could not be set up (no memory).
    pub fn polish(&mut self, tolerance: f64, control: &Control) -> Result<Report, CompositeError> {
        let first = self.solver.polish(tolerance, POLISH_STEPS, control);
        if matches!(first.status, Status::Converged | Status::Cancelled) {
            return Ok(self.report(&first, &self.solver, &self.items));
        }
        let (mut polisher, items) = match self.polisher.take() {
            Some(p) => p,
            None => {
                let built = build(&self.composite, &self.options, Form::N)?;
                (Solver::new(built.system, built.start)?, built.items)
            }
        };
        polisher.reset(self.solver.values());
        let second = polisher.polish(tolerance, POLISH_STEPS, control);
        let better = second.status != Status::Flipped && second.residual < first.residual;
        let report = match better {
            true => self.report(&second, &polisher, &items),
            false => self.report(&first, &self.solver, &self.items),
        };
        if better {
            self.solver.reset(polisher.values());
        }
        self.polisher = Some((polisher, items));
        Ok(report)
    }

    fn report(&self, outcome: &Outcome, solver: &Solver, items: &[Item]) -> Report {
        let at = outcome.flipped.or(outcome.worst.map(|w| w.block));
        let obstacle = match outcome.status {
            Status::Converged | Status::Cancelled => None,
            _ => at.zip(outcome.worst).map(|(block, worst)| {
                let item = items.get(block).map_or(String::new(), |i| describe(&self.composite, *i));
                (solver.class_name(worst.class).to_string(), item)
            }),
        };
        Report { status: outcome.status, iterations: outcome.iterations, residual: outcome.residual, obstacle }
    }

    /// The length (mm) that residuals are shares of.
    pub(crate) fn size(&self) -> f64 {
        self.scale.size
    }

    /// Control points of a curve, mm.
    pub fn control_points(&self, curve: usize) -> impl Iterator<Item = Vec3> + '_ {
        let x = self.solver.values();
        let points = self.points.get(curve).map_or(&[][..], |p| p);
        points.iter().map(move |&p| {
            let p = p as usize;
            self.scale.origin + Vec3::new(x[p], x[p + 1], x[p + 2]) * self.scale.size
        })
    }

    /// A curve as it is now.
    pub fn curve(&self, curve: usize) -> Option<Curve<3>> {
        let given = &self.composite.curves.get(curve)?.curve;
        Some(Curve { knots: given.knots.clone(), control: self.control_points(curve).map(|p| p.into()).collect() })
    }

    /// All strips as they are now, called by what is asked of them: planes, torses, ruled.
    ///
    /// # Errors
    /// Control points that are not finite.
    pub fn strips(&self) -> Result<Vec<Strip>, CompositeError> {
        let made = |(k, s): (usize, &super::RuledStrip)| {
            let side = |k: usize| self.composite.curve(&s.sides[k]).and_then(|c| self.curve(c));
            let (Some(a), Some(b)) = (side(0), side(1)) else { return Err(CompositeError::Empty) };
            let kind = match s.shape {
                StripShape::Planar => PanelKind::Plane,
                StripShape::Developable { .. } => PanelKind::Torse,
                StripShape::Ruled => PanelKind::Ruled,
            };
            Strip::polynomial(&s.name, kind, &a, &b)
                .map_err(|source| CompositeError::Spline { item: strip_item(&self.composite, k), source })
        };
        self.composite.strips.iter().enumerate().map(made).collect()
    }

    /// All planar pieces as they are now, called planes: from the first corner to the second, and beside it from the last
    /// to the third.
    ///
    /// # Errors
    /// Control points that are not finite.
    pub fn facets(&self) -> Result<Vec<Strip>, CompositeError> {
        let made = |(k, f): (usize, &super::Facet)| {
            let point = |curve: usize, at: usize| self.control_points(curve).nth(at).unwrap_or_else(Vec3::zeros);
            let corners = places(&self.composite, f, point);
            let [a, b, c] = [0, 1, 2].map(|i: usize| corners.get(i).copied().unwrap_or_else(Vec3::zeros));
            let d = corners.get(3).copied().unwrap_or(c);
            Strip::quad(&f.name, PanelKind::Plane, [a, d], [b, c])
                .map_err(|source| CompositeError::Spline { item: facet_item(&self.composite, k), source })
        };
        self.composite.facets.iter().enumerate().map(made).collect()
    }
}

/// Sets three unknowns.
fn put(solver: &mut Solver, first: u32, v: Vec3) {
    (0..3).for_each(|d| solver.set(first + d, v[d as usize]));
}
