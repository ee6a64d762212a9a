//! The simplest strip for a run of rulings or planes: fits over few spans are proposed, the proof decides, and of those
//! within the tolerance the one with the fewest control points along is taken.
//!
//! *Method.* For each kind of torse (type (3) and types (1), (2) of \[PW99\], and profiles) spans are added by
//! half until a strip is proven to be within the tolerance, then taken back by bisection. *Not guaranteed*: that no
//! strip with fewer control points exists.

use super::regression;
use crate::certify::elements::elements as certified;
use crate::certify::regression::{regression as regular, RegressionVerdict};
use crate::control::Control;
use crate::fit::elements::extent::{strip as strip_of, strip_by_slope};
use crate::fit::elements::sequence::{samples, SequenceOptions};
use crate::fit::elements::span_series::{PlaneSeries, SlopeSeries};
use crate::fit::near::primal::primal;
use crate::fit::near::primal::PrimalOptions;
use crate::torse::contact::ContactElement;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;

/// Share of the tolerance at which fits may end: the proof compares rulings part by part, which costs a little.
const AIM: f64 = 0.9;
/// Spans looked at, at most.
const MOST_SPANS: usize = 64;

/// Control points along a strip.
pub(crate) fn count(strip: &Strip) -> usize {
    strip.patch.knots_u.control_count()
}

/// A way to make a strip over a number of spans, with the fewest control points that it can have.
struct Kind<'a> {
    propose: Box<dyn Fn(usize) -> Option<Strip> + 'a>,
    fewest: fn(usize) -> usize,
}

/// What a strip must be, and the best one so far with its control points and its bound.
struct Search<'a> {
    elements: &'a [ContactElement],
    tolerance: f64,
    limits: Option<&'a RegressionLimits>,
    best: (usize, f64, Option<Strip>),
}

impl Search<'_> {
    /// Whether a strip is within the tolerance, regular, and keeps to the limits; if so, it may become the best.
    fn holds(&mut self, strip: Strip) -> bool {
        // Most strips fail; some of the elements, the last one among them, show that soon.
        const TRIED_FIRST: usize = 12;
        let step = self.elements.len().div_ceil(TRIED_FIRST).max(1);
        let some: Vec<ContactElement> = self.elements.iter().rev().step_by(step).copied().collect();
        if bound(&strip, &some) > self.tolerance {
            return false;
        }
        let bound = bound(&strip, self.elements);
        let holds = bound <= self.tolerance
            && regular(&strip, &RegressionLimits::default()) == RegressionVerdict::Clear
            && regression::keeps(&strip, self.limits);
        let count = count(&strip);
        if holds && (count, bound) < (self.best.0, self.best.1) {
            self.best = (count, bound, Some(strip));
        }
        holds
    }

    /// Spans by half more until a strip holds, then back by bisection.
    fn fewest_spans(&mut self, kind: &Kind, control: &Control) {
        let (mut bad, mut enough) = (0, None);
        let mut spans = 1;
        while spans <= MOST_SPANS.min(self.elements.len()) && (kind.fewest)(spans) < self.best.0 && !control.stopped() {
            if (kind.propose)(spans).is_some_and(|s| self.holds(s)) {
                enough = Some(spans);
                break;
            }
            bad = spans;
            // The last one looked at is the largest that could still be simpler.
            let next = spans + spans.div_ceil(2);
            let last = (spans + 1..next).rev().find(|n| (kind.fewest)(*n) < self.best.0);
            spans = if (kind.fewest)(next) < self.best.0 { next } else { last.unwrap_or(next) };
        }
        while let Some(good) = enough.filter(|e| *e > bad + 1 && !control.stopped()) {
            let middle = bad.midpoint(good);
            if (kind.propose)(middle).is_some_and(|s| self.holds(s)) {
                enough = Some(middle);
            } else {
                bad = middle;
            }
        }
    }
}

/// Proven distance of the elements from a strip, mm.
fn bound(strip: &Strip, elements: &[ContactElement]) -> f64 {
    certified(std::slice::from_ref(strip), elements, &Control::default()).worst_bound().value()
}

/// The strip with the fewest control points along (of equal ones: with the smallest bound) that is proven to lie within
/// the tolerance of all elements, to be regular, and to keep to the limits; `found` if there is none.
pub(crate) fn fewest(found: Strip, elements: &[ContactElement], wanted: &SequenceOptions, control: &Control) -> Strip {
    // A strip that is not within the tolerance is no match for one that is, if there may be one.
    const HOPELESS: f64 = 3.0;
    let reached = bound(&found, elements);
    if reached.is_nan() || reached > HOPELESS * wanted.tolerance {
        return found;
    }
    let control_points = if reached <= wanted.tolerance { count(&found) } else { 3 * MOST_SPANS };
    let name = found.name.clone();
    search(&name, (control_points, reached, None), elements, wanted, control).unwrap_or(found)
}

/// As [`fewest`] among strips with few control points, with nothing found before.
pub(crate) fn simplest(
    name: &str,
    elements: &[ContactElement],
    wanted: &SequenceOptions,
    control: &Control,
) -> Option<Strip> {
    const MOST_CONTROL_POINTS: usize = 36;
    search(name, (MOST_CONTROL_POINTS, f64::INFINITY, None), elements, wanted, control)
}

/// What is better than the best so far, over all kinds.
fn search(
    name: &str,
    best: (usize, f64, Option<Strip>),
    elements: &[ContactElement],
    wanted: &SequenceOptions,
    control: &Control,
) -> Option<Strip> {
    let (tolerance, limits) = (wanted.tolerance, wanted.limits.as_ref());
    let mut search = Search { elements, tolerance, limits, best };
    // Only splines of type (2) keep given ends.
    let slopes = if wanted.fix_ends { None } else { SlopeSeries::of(elements, wanted) };
    let planes = PlaneSeries::of(elements, wanted);
    let mut kinds: Vec<Kind> = Vec::new();
    // What mostly succeeds with few spans comes first: it saves the others most of their attempts.
    if let Some(series) = &planes {
        kinds.push(of_planes(name, series, None, elements));
    }
    if let Some(series) = &slopes {
        for rulings in [false, true] {
            let propose = move |n: usize| strip_by_slope(name, &series.fit(n, rulings)?, tolerance, elements);
            kinds.push(Kind { propose: Box::new(propose), fewest: |n| 2 + 2 * n });
        }
    }
    if let Some(series) = planes.as_ref().filter(|s| s.polishes()) {
        kinds.push(of_planes(name, series, Some(AIM * tolerance), elements));
    }
    if wanted.polishes() && elements.iter().all(ContactElement::has_ruling) {
        let samples = samples(elements);
        let propose = move |n: usize| {
            let (profile_spans, ruling_spans) = (n + 1, 1 + n % 2);
            let wanted = PrimalOptions { profile_spans, ruling_spans, ..PrimalOptions::new(AIM * tolerance) };
            strip_of(name, &primal(&samples, &wanted)?, elements).ok()
        };
        // Planes, cylinders and cones come with fewer spans than general profiles.
        kinds.push(Kind { propose: Box::new(propose), fewest: |n| if n == 1 { 4 } else { 6 + 3 * n } });
    }
    for kind in &kinds {
        search.fewest_spans(kind, control);
    }
    search.best.2
}

/// Strips of types (1) and (2), polished up to a distance (mm) or as they come.
fn of_planes<'a>(
    name: &'a str,
    series: &'a PlaneSeries,
    polish: Option<f64>,
    elements: &'a [ContactElement],
) -> Kind<'a> {
    let propose = move |n: usize| strip_of(name, &series.fit(n, polish)?, elements).ok();
    Kind { propose: Box::new(propose), fewest: |n| 2 + 3 * n }
}
