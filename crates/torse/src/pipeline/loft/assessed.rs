//! Strips between rails before their judge, laid flat, as an answer.

use super::options::{Ends, Options};
use crate::answer::note::{LoftNote, Note};
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::design::loft::build::BuiltStrip;
use crate::develop::strip::StripOptions;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{Covered, Reason, StripReason};
use crate::search::strips::assessment::{assess, Candidate};
use crate::search::strips::cut::laid;
use crate::search::strips::loft_ends::{past_ends, used};
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use std::time::Instant;

/// Drawings are asked to keep to at least this multiple of what their outlines were made for: proofs follow a chain of
/// strips less tightly than outlines do, up to ten times over a duct of eight.
const DRAWN: f64 = 16.0;
/// Rails are fitted no finer than this share of their size, and flat outlines drawn no finer than ten thousand times
/// that: digits beyond are rounding, and work for them would have no end.
pub(super) const FINEST: f64 = 1e-13;

/// What is covered of rails that are not covered whole, up to the tolerance, and how far strips run past their ends.
fn covered_in_part(
    built: &[BuiltStrip],
    [rails, given]: [&[&Rail; 2]; 2],
    shares: [f64; 2],
    options: &Options,
) -> Option<StripReason> {
    let mut parts = Vec::new();
    for side in 0..2 {
        let (name, whole) = (&rails[side].name, given[side].length());
        if (1.0 - shares[side]) * whole > options.tolerance {
            parts.push((name.clone(), Covered::Share(shares[side])));
        }
        let past = past_ends(built, side, rails[side], options.ends == Ends::Extend);
        if past > options.tolerance {
            parts.push((name.clone(), Covered::Past(past)));
        }
    }
    (!parts.is_empty()).then_some(StripReason::InPart(parts))
}

/// Judges and develops strips.
pub(super) fn assessed(
    [rails, given]: [&[&Rail; 2]; 2],
    built: Vec<BuiltStrip>,
    closed: bool,
    options: &Options,
    notes: Vec<LoftNote>,
    start: Instant,
) -> Answer {
    let pieces: Vec<Candidate> =
        built.iter().enumerate().map(|(index, built)| Candidate { index, built, rails: rails.map(Some) }).collect();
    let assessment = assess(&pieces, [What::FromCurve(0), What::FromCurve(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    let mut claims: Vec<Claim> = (0..2)
        .map(|side| {
            let off = assessment.off[side];
            let most = assessment.farthest[side].clone();
            let reason = StripReason::OffRail { by: off.value(), rail: rails[side].name.clone(), most };
            let kept = Claim::at_most(What::FromCurve(side), whole, off).within(options.tolerance);
            kept.because(Reason::from(reason))
        })
        .collect();
    let mut missing = assessment.missing.clone();
    let shares = [0, 1].map(|d: usize| used(&built, d, rails[d], options.ends == Ends::Extend));
    // What is covered comes first.
    let part = covered_in_part(&built, [rails, given], shares, options);
    claims.splice(0..0, part.map(Claim::in_part));
    let strips: Vec<Strip> = built.into_iter().map(|s| s.strip).collect();
    if strips.is_empty() {
        missing.push(StripReason::None.into());
    }
    let mut flat =
        StripOptions::of_job(options.tolerance, [options.ruling_spacing, options.mark_spacing], options.drawn);
    flat.contour_tolerance = flat.contour_tolerance.max(1e4 * FINEST * size(rails));
    let chain = Part::new("A", 0, strips.len());
    // Nothing is drawn finer than that, however fine the strips are.
    let laid = laid(&strips, &[chain], &flat, options.tolerance.max(DRAWN * flat.contour_tolerance));
    let mut notes: Vec<Note> = notes.into_iter().map(Note::Loft).collect();
    notes.extend(laid.crowded.iter().copied().map(Note::Crowded));
    notes.extend(closed.then_some(Note::CutOpen { part: None }));
    notes.extend(creases(&strips).map(Note::Loft));
    claims.extend((0..2).map(|d| Claim::measured(What::UsedOf(d), whole, 100.0 * shares[d])));
    claims.extend(assessment.whole());
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    claims.extend(laid.claims());
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(assessment.claims);
    Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields: assessment.fields,
        meaning: assessment.meaning,
        guides: given.iter().map(|r| Guide::of(r)).collect(),
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::of_flat(Job::Loft, &options.input, options.tolerance, laid)
    }
}

/// Size of both rails, mm.
fn size(rails: &[&Rail; 2]) -> f64 {
    rails[0].bbox().diagonal().max(rails[1].bbox().diagonal())
}

/// Says where neighbouring strips meet at an angle: developable each by itself, but not smooth together.
fn creases(strips: &[Strip]) -> Option<LoftNote> {
    // Below a tenth of a degree nobody sees or feels an edge.
    const EDGE_DEG: f64 = 0.1;
    let normal = |s: &Strip, u: f64| s.patch.jet(u, 0.5).normal().try_normalize(0.0);
    let angles = strips.windows(2).filter_map(|w| {
        let (n, m) = (normal(&w[0], w[0].domain().1)?, normal(&w[1], w[1].domain().0)?);
        Some((w, n.cross(&m).norm().atan2(n.dot(&m))))
    });
    let all: Vec<_> = angles.filter(|(_, angle)| *angle > EDGE_DEG.to_radians()).collect();
    let (w, angle) = all.iter().max_by(|x, y| x.1.total_cmp(&y.1))?;
    let between = [w[0].name.clone(), w[1].name.clone()];
    Some(LoftNote::Creases { count: all.len(), sharpest: *angle, between })
}
