//! The result of a shape: judged, laid flat, put together.

use super::apart::{curves_moved, from_taken};
use super::joined::joins;
use super::moved::Moved;
use super::options::ShapeError;
use super::targets::{targets, Asked};
use super::unmet::unmet;
use crate::answer::note::Note;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Demand, Evidence, Subject, What};
use crate::control::Control;
use crate::design::composite::{Composite, Join, Session, Smoothness, StripShape};
use crate::design::loft::build::{classified, BuiltStrip};
use crate::develop::strip::StripOptions;
use crate::draw::field::PanelField;
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{Curves, JobReason, Reason, StripReason, Unlaid};
use crate::search::strips::assessment::{assess, Assessment, Candidate};
use crate::search::strips::cut::laid;
use crate::search::strips::regression;
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::form::PanelKind;
use crate::torse::rail::{Rail, RailPart};
use crate::torse::strip::{homogeneous, Strip};

/// Points of a guide.
const GUIDE_POINTS: usize = 200;
/// Stations per ruled strip where its twist is measured for colours.
const STATIONS: usize = 64;

/// A strip as the judge takes it, with the fixed curves that it must keep.
struct Made {
    built: BuiltStrip,
    rails: [Option<Rail>; 2],
}

fn made(composite: &Composite, strip: Strip, index: usize) -> Result<Made, SplineError> {
    let linear = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0], [1.0]])?;
    let part = RailPart { piece: 0, parameter: linear };
    let rails = [0, 1].map(|side: usize| {
        // Planar pieces between corners have no curves of their own.
        let name = &composite.strips.get(index)?.sides[side];
        let given = &composite.curves[composite.curve(name)?];
        let rail = given.fixed.then(|| Rail::new(name, &[homogeneous(&given.curve)]).ok()).flatten()?;
        // A fixed curve with corners is no single piece; its control points are kept all the same.
        (rail.pieces.len() == 1).then_some(rail)
    });
    let strip = if strip.kind == PanelKind::Torse { classified(strip) } else { strip };
    Ok(Made { built: BuiltStrip { strip, rails: [part.clone(), part] }, rails })
}

/// Chains of strips that go on smoothly, as parts that are cut from one sheet; ruled strips are not.
fn chains(composite: &Composite, strips: &[Strip]) -> Vec<Part> {
    let mut out: Vec<Part> = Vec::new();
    for (k, s) in strips.iter().enumerate().filter(|(_, s)| s.kind != PanelKind::Ruled) {
        let goes_on = k > 0 && follows(composite, &strips[k - 1].name, &s.name);
        match out.last_mut() {
            Some(last) if goes_on && last.first + last.count == k => last.count += 1,
            _ => out.push(Part::new(&s.name, k, 1)),
        }
    }
    out
}

/// Whether one strip goes on smoothly after the last ruling of another.
fn follows(composite: &Composite, one: &str, other: &str) -> bool {
    composite.joins.iter().any(|j| {
        matches!(j, Join::Ruling { first, second, smoothness }
            if *smoothness != Smoothness::G0 && first == one && second == other)
    })
}

/// Strips that go on smoothly one behind the other, whatever their order in the job; else in that order.
fn in_chains(composite: &Composite, mut left: Vec<Made>) -> Vec<Made> {
    let mut out: Vec<Made> = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let after = |name: &str, m: &Made| follows(composite, name, &m.built.strip.name);
        let next = out.last().and_then(|o| left.iter().position(|m| after(&o.built.strip.name, m)));
        // The first that follows none of the others; in rings the first of all.
        let begins = |m: &Made| left.iter().all(|o| !after(&o.built.strip.name, m));
        let next = next.or_else(|| left.iter().position(begins)).unwrap_or(0);
        out.push(left.remove(next));
    }
    out
}

/// Measured twist of a ruled strip, degrees, for colours.
fn twists(strip: &Strip) -> PanelField {
    let (a, b) = strip.domain();
    let u: Vec<f64> = (0..=STATIONS).map(|k| a + (b - a) * k as f64 / STATIONS as f64).collect();
    let values = u.iter().flat_map(|&u| [strip.twist(u).to_degrees(); 2]).collect();
    PanelField { u, v: vec![0.0, 1.0], values }
}

/// Fields of all strips in order: those of the judged ones, and those of ruled ones.
fn fields(all: &[Made], assessment: &Assessment) -> Vec<PanelField> {
    let mut judged = assessment.fields.iter();
    let of = |m: &Made| match m.built.strip.kind {
        PanelKind::Ruled => Some(twists(&m.built.strip)),
        _ => judged.next().cloned(),
    };
    all.iter().filter_map(of).collect()
}

/// Lengths of the ruling that the regression curve of a strip should keep off.
fn margin(composite: &Composite, strip: &Strip) -> f64 {
    match composite.strip(&strip.name).map(|k| composite.strips[k].shape) {
        Some(StripShape::Developable { margin }) => margin,
        _ => 0.0,
    }
}

/// Judges and develops what a session has come to.
pub(super) fn assessed(
    session: &Session,
    asked: &Asked,
    moved: Moved,
    control: &Control,
) -> Result<Answer, ShapeError> {
    let (composite, options) = (session.composite(), asked.options);
    let Moved { mut notes, stages, missing: mut missing_moves } = moved;
    let mut strips = session.strips()?;
    strips.extend(session.facets()?);
    let each = strips.into_iter().enumerate().map(|(k, s)| made(composite, s, k));
    let all = in_chains(composite, each.collect::<Result<Vec<_>, _>>()?);
    let developable = all.iter().enumerate().filter(|(_, m)| m.built.strip.kind != PanelKind::Ruled);
    let pieces: Vec<Candidate> = developable
        .map(|(index, m)| Candidate { index, built: &m.built, rails: m.rails.each_ref().map(Option::as_ref) })
        .collect();
    let assessment = assess(&pieces, [What::FromSide(0), What::FromSide(1)], options.twist_tolerance);
    let ruled = all.len() - pieces.len();
    let whole = Subject::Whole;
    let mut claims = Vec::new();
    for side in 0..2 {
        if pieces.iter().any(|p| p.rails[side].is_some()) {
            let most = assessment.farthest[side].clone();
            let reason = StripReason::Stray { by: assessment.off[side].value(), from: Curves::Fixed, most };
            let kept = Claim::at_most(What::FromSide(side), whole, assessment.off[side]);
            claims.push(kept.within(options.tolerance).because(Reason::from(reason)));
        }
    }
    let mut missing = assessment.missing.clone();
    missing.append(&mut missing_moves);
    let (gave_way, unmet) = unmet(session, options.tolerance);
    notes.extend(gave_way);
    missing.extend(unmet);
    let fields = fields(&all, &assessment);
    let mut meaning = assessment.meaning.clone();
    meaning.limit = fields.iter().flat_map(|f| &f.values).fold(meaning.limit, |m, x| m.max(*x));
    let strips: Vec<Strip> = all.into_iter().map(|m| m.built.strip).collect();
    let (joints, told) = joins(composite, &strips, options);
    notes.extend(told);
    claims.extend(joints);
    let (near, told) = targets(&strips, asked, control);
    notes.extend(told);
    claims.extend(near);
    claims.extend(asked.taken.against.iter().cloned());
    claims.extend(from_taken(&strips, session, asked, control));
    claims.extend(curves_moved(session, asked));
    let flat = StripOptions::of_job(options.tolerance, [options.ruling_spacing, options.mark_spacing], options.drawn);
    let laid = laid(&strips, &chains(composite, &strips), &flat, options.tolerance);
    notes.extend(laid.crowded.iter().copied().map(Note::Crowded));
    if ruled < strips.len() {
        let proven = |c: &Claim| matches!(c.what(), What::Count(_) | What::RegressionClearance);
        claims.extend(assessment.whole().into_iter().filter(|c| !proven(c)));
        claims.extend(laid.claims());
    }
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    if ruled > 0 {
        notes.push(Note::RuledStrips { count: ruled });
    }
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    if !claims.iter().any(asks_for_proof) {
        claims.push(Claim::objection(whole, JobReason::NothingAsked));
    }
    claims.extend(assessment.claims.into_iter().filter(|c| c.what() != What::RegressionClearance));
    claims.extend(regression::claims(&strips, &|k| margin(composite, &strips[k])));
    let guides = composite.curves.iter().map(|c| {
        let (a, b) = c.curve.domain();
        let at = |k: usize| Vec3::from(c.curve.point(a + (b - a) * k as f64 / GUIDE_POINTS as f64));
        Guide { name: format!("{} as given", c.name), points: (0..=GUIDE_POINTS).map(at).collect() }
    });
    let mut answer = Answer {
        claims,
        guides: guides.collect(),
        fields,
        meaning,
        notes,
        stages,
        ..Answer::of_flat(Job::Shape, &options.input, options.tolerance, laid)
    };
    // Ruled strips are parts that are not laid flat.
    for (k, s) in strips.iter().enumerate().filter(|(_, s)| s.kind == PanelKind::Ruled) {
        answer.parts.push(Part { missing: Some(Unlaid::Ruled), ..Part::new(&s.name, k, 1) });
    }
    answer.patchwork = Patchwork::of_strips(strips);
    Ok(answer)
}

/// Whether a claim could certify something.
fn asks_for_proof(c: &Claim) -> bool {
    c.evidence() == Evidence::Proven && c.demand() != Demand::None
}
