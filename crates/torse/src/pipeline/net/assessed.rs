//! Strips of nets before their judge, laid flat, as an answer.

use super::options::Options;
use crate::answer::note::{NetNote, Note};
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, NetNumber, Subject, What};
use crate::design::loft::build::BuiltStrip;
use crate::develop::strip::StripOptions;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{Curves, Reason, StripReason};
use crate::search::strips::assessment::{assess, Candidate};
use crate::search::strips::cut::laid;
use crate::torse::net::{NetKind, Regularity, TaperedNet};
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use std::time::Instant;

/// What was found.
#[derive(Default)]
pub(super) struct Nets {
    /// The nets, one after the other along the curve.
    pub nets: Vec<TaperedNet>,
    /// What is said of them.
    pub claims: Vec<Claim>,
    /// What people should know of them.
    pub notes: Vec<NetNote>,
    /// Why there are none.
    pub missing: Vec<Reason>,
}

/// Where the regression curve lies against a strip.
fn tell_regression(name: &str, net: &TaperedNet, notes: &mut Vec<NetNote>) {
    let (a, b) = net.net.domain();
    let at = [net.regression(a), net.regression(b)];
    let strip = name.to_owned();
    if !(at[0].is_finite() && at[1].is_finite()) {
        notes.push(NetNote::NoRegression { strip });
        return;
    }
    let apex = matches!(net.net.kind(), NetKind::Cone { .. });
    notes.push(NetNote::Regression { strip, apex, linear: !apex && net.is_constant(), at });
}

/// Judges and develops strips.
pub(super) fn assessed(
    rail: &Rail,
    given: &Rail,
    built: Vec<BuiltStrip>,
    found: Nets,
    options: &Options,
    start: Instant,
) -> Answer {
    let Nets { nets, mut claims, mut notes, mut missing } = found;
    let pieces: Vec<Candidate> =
        built.iter().enumerate().map(|(index, built)| Candidate { index, built, rails: [Some(rail), None] }).collect();
    let assessment = assess(&pieces, [What::FromCurve(0), What::FromCurve(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    for (s, net) in built.iter().zip(&nets) {
        tell_regression(&s.strip.name, net, &mut notes);
        let strip = s.strip.name.clone();
        let on = |u: f64, v: f64| s.strip.patch.point(u, v);
        let reason = match net.regularity() {
            Regularity::Regular => continue,
            Regularity::Regression { u, v } => StripReason::NetRegression { strip, u, v, at: on(u, v) },
            Regularity::TangentRuling { u } => {
                StripReason::TangentRuling { strip, curve: given.name.clone(), u, at: on(u, 0.0) }
            }
            Regularity::Weight { index, weight } => StripReason::Weight { strip, weight, index },
        };
        missing.push(reason.into());
    }
    missing.extend(assessment.missing.iter().filter(|_| missing.is_empty()).cloned().collect::<Vec<_>>());
    let strips: Vec<Strip> = built.into_iter().map(|s| s.strip).collect();
    let flat = StripOptions::of_job(options.tolerance, [options.ruling_spacing, options.mark_spacing], options.drawn);
    let chains: Vec<Part> = (!strips.is_empty()).then(|| Part::new("A", 0, strips.len())).into_iter().collect();
    let laid = laid(&strips, &chains, &flat, options.tolerance);
    let mut notes: Vec<Note> = notes.into_iter().map(Note::Net).collect();
    notes.extend(laid.crowded.iter().copied().map(Note::Crowded));
    if let Some(net) = nets.first() {
        let shape = net.net.shape();
        let stars = [(NetNumber::MStar, shape.m_star()), (NetNumber::LambdaStar, shape.lambda_star())];
        let numbers = if shape.m == 0.0 { [(NetNumber::M, 0.0), (NetNumber::Kappa, shape.kappa)] } else { stars };
        claims.extend(numbers.map(|(number, x)| Claim::given(What::NetShape(number), whole, x)));
    }
    if !strips.is_empty() {
        let off = assessment.off[0];
        let reason = StripReason::Stray {
            by: off.value(),
            from: Curves::One(given.name.clone()),
            most: assessment.farthest[0].clone(),
        };
        let kept = Claim::at_most(What::FromCurve(0), whole, off).within(options.tolerance);
        claims.push(kept.because(Reason::from(reason)));
        claims.extend(assessment.whole().into_iter().filter(|c| !matches!(c.what(), What::Count(_))));
    }
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    if !laid.parts.is_empty() {
        claims.extend(laid.claims());
    }
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(assessment.claims);
    Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields: assessment.fields,
        meaning: assessment.meaning,
        guides: vec![Guide::of(given)],
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::of_flat(Job::Net, &options.input, options.tolerance, laid)
    }
}
