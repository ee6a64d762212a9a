//! Strips of sequences before their judge, laid flat, as an answer.

use super::ends::Ends;
use super::options::ElementFitOptions;
use crate::answer::note::{FaceNote, FitNote, Note};
use crate::answer::skipped::Skipped;
use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::certify::elements::{elements as certified, ElementCertificate};
use crate::certify::points::points;
use crate::control::Control;
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{self, JobReason, Reason};
use crate::search::strips::cut::laid;
use crate::search::strips::regression;
use crate::torse::contact::ContactElement;
use crate::torse::strip::Strip;
use std::time::Instant;

/// What is given.
#[derive(Clone, Copy)]
pub(super) enum Sort {
    Rulings,
    Planes,
}

impl Sort {
    pub(super) fn one(self) -> &'static str {
        match self {
            Self::Rulings => "ruling",
            Self::Planes => "plane",
        }
    }

    pub(super) fn many(self) -> &'static str {
        match self {
            Self::Rulings => "rulings",
            Self::Planes => "planes",
        }
    }

    pub(super) fn given(self) -> reason::Sort {
        match self {
            Self::Rulings => reason::Sort::Rulings,
            Self::Planes => reason::Sort::Planes,
        }
    }

    pub(super) fn counted(self) -> Counted {
        match self {
            Self::Rulings => Counted::Rulings,
            Self::Planes => Counted::TangentPlanes,
        }
    }
}

/// What was made of all sequences.
#[derive(Default)]
pub(super) struct Made {
    /// Strips.
    pub strips: Vec<Strip>,
    /// The elements that they were fitted to.
    pub all: Vec<ContactElement>,
    /// What became of faces.
    pub became: Vec<FaceNote>,
    /// What was left out.
    pub skipped: Vec<Skipped>,
    /// Where strips should end.
    pub ends: Ends,
}

/// Judges and develops strips.
pub(super) fn assessed(
    made: Made,
    sort: Sort,
    options: &ElementFitOptions,
    control: &Control,
    clock: Instant,
) -> Answer {
    let Made { strips, all, became, skipped, ends } = made;
    let what = sort.many();
    control.report("proving", 0.7, format!("{} {what}", all.len()));
    let certificate = certified(&strips, &all, control);
    let chains = Part::of_each(&strips);
    let drawn = Drawn { bends: options.drawn.bends.of_job(options.tolerance), ..options.drawn };
    let flat = StripOptions { drawn, ..StripOptions::new(0.1 * options.tolerance) };
    let mut laid = laid(&strips, &chains, &flat, options.tolerance);
    let ended = ends.cut(&strips, &mut laid, flat.side, options.tolerance, control);
    let beyond = certificate.beyond(options.tolerance);
    let broken = regression::broken(&strips, options.limits.as_ref());
    let worst = certificate.worst_bound();
    let reason = match certificate.worst() {
        _ if strips.is_empty() => Some(JobReason::Unfollowed(sort.given())),
        _ if control.stopped() => Some(JobReason::NotAllJudged(sort.given())),
        found => found.map(|i| JobReason::Beyond {
            sort: sort.given(),
            beyond,
            all: all.len(),
            tolerance: options.tolerance,
            worst: i,
            at: all[i].centre(),
            away: worst.value(),
        }),
    };
    let whole = Subject::Whole;
    let mut claims = vec![
        Claim::count(sort.counted(), whole, all.len()),
        Claim::at_most(What::ElementDistance, whole, worst).within(options.tolerance).because(reason.map(Reason::from)),
        Claim::count(Counted::Beyond, whole, beyond),
    ];
    // Planes of rulings that were found from these are no data.
    let turned = certificate.most_turned().filter(|_| matches!(sort, Sort::Planes) && !strips.is_empty());
    claims.extend(turned.map(|(index, turn)| {
        let reason = JobReason::Turned { index, angle: turn.value(), limit: options.plane_angle };
        let claim = Claim::at_most(What::ElementAngle, whole, turn.degrees());
        claim.within(options.plane_angle.to_degrees()).because(Reason::from(reason))
    }));
    claims.extend(at_centres(&strips, &all, sort, options.tolerance, control));
    claims.extend(ends.claims(&ended, options.tolerance, control));
    if control.stopped() {
        claims.push(Claim::objection(whole, JobReason::NotAllJudged(sort.given())));
    }
    if worst.value() <= options.tolerance {
        claims.extend(broken.iter().map(|b| Claim::objection(whole, b)));
    }
    claims.extend(laid.lengths());
    claims.extend(laid.refused().into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(claims_of_strips(&strips, &certificate));
    let mut notes: Vec<Note> = options.limits.iter().cloned().map(Note::Limits).collect();
    notes.extend(became.into_iter().map(FitNote::Face).map(Note::Fit));
    notes.extend(broken.into_iter().map(Note::Broken));
    let far = |c: &Claim| c.what() == What::FaceDistance && c.value() > options.tolerance;
    let at_rulings = !ends.of_faces() || claims.iter().any(far);
    notes.extend(at_rulings.then_some(Note::Fit(FitNote::At(sort.counted()))));
    notes.extend(ends.notes(&ended, matches!(sort, Sort::Rulings), control));
    notes.extend((strips.len() > 1).then_some(Note::Unjoined));
    Answer {
        claims,
        fields: fields(&strips, &certificate),
        meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: options.tolerance },
        notes,
        skipped,
        seconds: clock.elapsed().as_secs_f64(),
        patchwork: Patchwork { panels: ended.panels, ..Patchwork::default() },
        ..Answer::of_flat(Job::Fit, &options.input, options.tolerance, laid)
    }
}

/// How far the centres of planes' regions are from the strips. Where most lie on these they are places where the planes touch the
/// surface, and all should.
fn at_centres(
    strips: &[Strip],
    all: &[ContactElement],
    sort: Sort,
    tolerance: f64,
    control: &Control,
) -> Option<Claim> {
    let planes: Vec<usize> = (0..all.len()).filter(|k| !all[*k].has_ruling()).collect();
    if !matches!(sort, Sort::Planes) || planes.is_empty() || strips.is_empty() {
        return None;
    }
    let centres: Vec<Vec3> = planes.iter().map(|k| all[*k].centre()).collect();
    let found = points(strips, &centres, control);
    let claim = Claim::at_most(What::CentreDistance, Subject::Whole, found.worst_bound());
    let on = found.bounds().iter().filter(|b| **b <= ON_STRIP * tolerance).count();
    let reason = found.worst().map(|k| {
        let (index, at) = (planes[k], centres[k]);
        Reason::from(JobReason::Before { index, at, away: found.bounds()[k] })
    });
    Some(if 2 * on >= planes.len() { claim.within(tolerance).because(reason) } else { claim })
}

/// Share of the tolerance within which centres of regions lie on a strip and not beside it by chance.
const ON_STRIP: f64 = 0.5;

fn claims_of_strips(strips: &[Strip], c: &ElementCertificate) -> Vec<Claim> {
    let claims = |(k, strip): (usize, &Strip)| {
        let subject = Subject::Panel(k);
        let count = c.places().iter().filter(|p| p.0 as usize == k).count();
        let rail = strip.rail(0);
        [
            Claim::count(Counted::Elements, subject, count),
            Claim::at_most(What::ElementDistance, subject, c.worst_bound_on(k)),
            Claim::count(Counted::Degree, subject, rail.knots.degree()),
            Claim::count(Counted::ControlPoints, subject, rail.control.len()),
            regression::claim(k, strip),
        ]
    };
    strips.iter().enumerate().flat_map(claims).collect()
}

/// The bounds along the strips, the same on all of a ruling.
fn fields(strips: &[Strip], c: &ElementCertificate) -> Vec<PanelField> {
    const ALONG: usize = 48;
    strips
        .iter()
        .enumerate()
        .map(|(k, s)| {
            let (a, b) = s.domain();
            let mut found: Vec<(f64, f64)> = (c.places().iter().zip(c.bounds()))
                .filter(|(p, b)| p.0 as usize == k && b.is_finite())
                .map(|(p, b)| (p.1, *b))
                .collect();
            found.sort_by(|p, q| p.0.total_cmp(&q.0));
            let at = |u: f64| -> f64 {
                let i = found.partition_point(|p| p.0 < u);
                let around = [i.checked_sub(1), Some(i)].into_iter().flatten().filter_map(|i| found.get(i));
                around.min_by(|p, q| (p.0 - u).abs().total_cmp(&(q.0 - u).abs())).map_or(0.0, |p| p.1)
            };
            let u: Vec<f64> = (0..=ALONG).map(|i| a + (b - a) * i as f64 / ALONG as f64).collect();
            let values = u.iter().flat_map(|&u| [at(u); 2]).collect();
            PanelField { u, v: vec![0.0, 1.0], values }
        })
        .collect()
}
