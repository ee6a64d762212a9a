//! Strips that follow sequences of rulings or planes \[PW99\]: fitted at several aims, judged, the best kept and made simple.

use super::fewest::{fewest, simplest};
use super::regression;
use super::ruled_face::{is_simplest, no_simpler, GivenFace};
use crate::certify::elements::{elements as certified, ElementCertificate};
use crate::control::Control;
use crate::fit::elements::extent::strip;
use crate::fit::elements::sequence::{sequence_pieces, torses, SequenceOptions, SequencePiece};
use crate::reason::{Reason, StripReason};
use crate::torse::contact::ContactElement;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;
use std::ops::Range;

/// Shares of the tolerance that fits aim at in turn: the proof compares rulings, the fit distances of points.
const AIMS: [f64; 3] = [0.8, 0.4, 0.15];

/// What strips of sequences must be like.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StripsAsked {
    /// Largest distance of an element, mm.
    pub tolerance: f64,
    /// What is asked of regression curves.
    pub limits: Option<RegressionLimits>,
    /// Whether the first and the last element of each strip are kept exactly.
    pub fix_ends: bool,
    /// Weight of bending against the data as a share; none: strips follow the data.
    pub smoothing: Option<f64>,
}

impl StripsAsked {
    /// Options of the fits at a tolerance (mm) and a number of strips.
    fn fits(&self, tolerance: f64, max_pieces: usize, limits: Option<RegressionLimits>) -> SequenceOptions {
        let plain = SequenceOptions::new(tolerance);
        let smoothing = self.smoothing.unwrap_or(plain.smoothing);
        SequenceOptions { max_pieces, limits, smoothing, fix_ends: self.fix_ends, ..plain }
    }
}

/// What is fitted at once: estimates of the same elements, and the face that they come from.
pub(crate) struct ElementSequence {
    /// Name.
    pub name: String,
    /// Estimates of the elements, each of all of them.
    pub estimates: Vec<Vec<ContactElement>>,
    /// The face, if there is one.
    pub face: Option<GivenFace>,
}

/// Shares of the tolerance that strips of faces may use at the rulings, in turn: what lies between these and along the border
/// needs the rest, where it is farther away.
const AT_RULINGS: [f64; 4] = [1.0, 0.8, 0.5, 0.25];

/// As [`strips_of_sequence`] for the sequence of a face: nearer at its rulings until they are near between them, too.
pub(crate) fn strips_of_face(
    sequence: &mut ElementSequence,
    most: usize,
    options: &StripsAsked,
    control: &Control,
) -> SequenceStrips {
    let estimates = sequence.estimates.clone();
    let mut best: Option<SequenceStrips> = None;
    for share in AT_RULINGS {
        sequence.estimates.clone_from(&estimates);
        let asked = StripsAsked { tolerance: share * options.tolerance, ..options.clone() };
        let found = strips_of_sequence(sequence, most, &asked, control);
        let off = sequence.face.as_ref().map_or(0.0, |f| f.off_between(&found.strips, control));
        let near = off <= options.tolerance;
        // Finer attempts that miss rulings are none.
        if best.is_some() && !(near && found.missed.is_empty()) {
            continue;
        }
        best = Some(found);
        if near || control.stopped() {
            break;
        }
    }
    best.unwrap_or_else(|| strips_of_sequence(sequence, most, options, control))
}

/// Strips of one sequence.
pub(crate) struct SequenceStrips {
    /// The strips.
    pub strips: Vec<Strip>,
    /// The elements that they were fitted to: one of the estimates.
    pub elements: Vec<ContactElement>,
    /// Of each strip those that it was fitted to.
    pub ranges: Vec<Range<usize>>,
    /// Elements without a strip, and why.
    pub missed: Vec<(Range<usize>, StripReason)>,
    /// Whether the strip is the face as it was.
    pub is_face: bool,
}

/// Strips for a sequence, `most` at most.
pub(crate) fn strips_of_sequence(
    sequence: &mut ElementSequence,
    most: usize,
    options: &StripsAsked,
    control: &Control,
) -> SequenceStrips {
    let estimates = &sequence.estimates;
    let mut own: Vec<Strip> = Vec::new();
    let given = sequence.face.as_ref().and_then(|f| f.strip.as_ref());
    let given = given.filter(|s| most > 0 && regression::keeps(s, options.limits.as_ref()));
    let mut missed = Vec::new();
    let wanted = options.fits(options.tolerance, 1, options.limits.clone());
    let simple = given.is_some_and(is_simplest);
    // Most sequences are followed by one strip over few spans; the search for these is also the fastest.
    if let Some(elements) = estimates.first().filter(|_| !simple && most > 0 && options.limits.is_none()) {
        own.extend(simplest(&sequence.name, elements, &wanted, control));
    }
    let found = match given {
        _ if simple || !own.is_empty() => None,
        _ => best(estimates, most, options, control),
    };
    let which = found.as_ref().map_or(0, |f| f.0);
    let all = || -> Vec<Range<usize>> { std::iter::once(0..estimates.get(which).map_or(0, Vec::len)).collect() };
    let mut ranges = if own.is_empty() { Vec::new() } else { all() };
    if let Some((_, found)) = found {
        let elements = &estimates[which];
        ranges = found.ranges.clone();
        let reason = |range: &Range<usize>| unfollowed(&elements[range.clone()], options);
        missed.extend(found.missed.into_iter().map(|(range, why)| {
            let why = why.unwrap_or_else(|| reason(&range));
            (range, why)
        }));
        let few =
            found.strips.into_iter().zip(found.ranges).map(|(s, range)| fewest(s, &elements[range], &wanted, control));
        own.extend(few);
    }
    let mut is_face = false;
    if let Some(strip) = given {
        let beyond = certified(&own, &estimates[which], control).beyond(options.tolerance);
        if own.is_empty() || beyond > 0 || no_simpler(&own, strip) {
            is_face = true;
            (own, ranges) = (vec![strip.clone()], all());
            missed.clear();
        }
    }
    SequenceStrips { strips: own, elements: std::mem::take(&mut sequence.estimates[which]), ranges, missed, is_face }
}

/// Strips for one sequence.
struct Attempt {
    strips: Vec<Strip>,
    /// The elements that each strip was fitted to.
    ranges: Vec<Range<usize>>,
    /// Stretches without a strip: the elements, and why torses that were found give none.
    missed: Vec<(Range<usize>, Option<StripReason>)>,
    /// Whether there is nothing because of what is asked of the regression curve.
    kept_off: bool,
    certificate: ElementCertificate,
}

impl Attempt {
    /// Elements beyond the tolerance and regression curves out of bounds, strips, worst bound: less is better.
    fn rank(&self, options: &StripsAsked) -> (usize, usize, f64) {
        let broken = self.strips.iter().filter(|s| !regression::keeps(s, options.limits.as_ref())).count();
        (self.certificate.beyond(options.tolerance) + broken, self.strips.len(), self.certificate.worst_bound().value())
    }
}

/// Room for a regression curve that makes fits regular: a share of the mean length of the rulings, mm.
fn room(elements: &[ContactElement]) -> f64 {
    const SHARE: f64 = 0.05;
    let length = |e: &ContactElement| (e.ends[1] - e.ends[0]).norm().max(2.0 * e.radius);
    SHARE * elements.iter().map(length).sum::<f64>() / elements.len().max(1) as f64
}

/// Strips for a sequence at one aim and with limits of the regression curve.
fn attempt(
    elements: &[ContactElement],
    most: usize,
    aim: f64,
    limits: Option<RegressionLimits>,
    options: &StripsAsked,
    control: &Control,
) -> Attempt {
    let wanted = options.fits(aim * options.tolerance, most, limits);
    let mut strips: Vec<Strip> = Vec::new();
    let (mut ranges, mut missed) = (Vec::new(), Vec::new());
    let pieces = sequence_pieces(elements, &wanted);
    let kept_off = pieces.iter().all(|p| p.kept_off);
    for piece in pieces {
        let own = &elements[piece.range.clone()];
        match nearest("A", &piece, own, options) {
            Ok(s) => {
                strips.push(s);
                ranges.push(piece.range);
            }
            Err(reason) => missed.push((piece.range, reason)),
        }
    }
    let certificate = certified(&strips, elements, control);
    Attempt { strips, ranges, missed, kept_off, certificate }
}

/// The best of several aims, and of several estimates of the same elements (which one is told).
fn best(
    estimates: &[Vec<ContactElement>],
    most: usize,
    options: &StripsAsked,
    control: &Control,
) -> Option<(usize, Attempt)> {
    let mut best: Option<(usize, Attempt)> = None;
    for aim in AIMS {
        for (k, elements) in estimates.iter().enumerate() {
            if control.stopped() && best.is_some() {
                return best;
            }
            // Limits that leave nothing of one estimate leave nothing of the others, which differ little.
            if best.as_ref().is_some_and(|b| b.1.kept_off) {
                return best;
            }
            let mut found = attempt(elements, most, aim, options.limits.clone(), options, control);
            if options.limits.is_none() && !found.missed.is_empty() {
                // Fits without strips mostly come with a regression curve too near: some room makes them regular.
                let room = Some(RegressionLimits { clearance: room(elements), zones: Vec::new() });
                let kept = attempt(elements, most, aim, room, options, control);
                if kept.rank(options) < found.rank(options) {
                    found = kept;
                }
            }
            let (a, b) = (found.rank(options), best.as_ref().map(|b| b.1.rank(options)));
            let done = a.0 == 0 && a.1 == 1;
            let better = b.is_none_or(|b| (a.0, a.1) < (b.0, b.1) || ((a.0, a.1) == (b.0, b.1) && a.2 < b.2));
            if better {
                best = Some((k, found));
            }
            if done {
                return best;
            }
        }
        // Finer aims cost strips; they are for the last elements that are not proven yet, not for hopeless sequences.
        const HOPELESS: f64 = 5.0;
        let (beyond, worst) = best
            .as_ref()
            .map_or((0, 0.0), |(_, b)| (b.certificate.beyond(options.tolerance), b.certificate.worst_bound().value()));
        let many = estimates.first().is_some_and(|e| 2 * beyond > e.len());
        if beyond == 0 || (many && worst > HOPELESS * options.tolerance) {
            break;
        }
    }
    best
}

/// The strip with the smallest proven distance from its elements, among those whose regression curve keeps to the
/// limits if there are any.
///
/// # Errors
/// Why torses give no strip; nothing where there are none.
fn nearest(
    name: &str,
    piece: &SequencePiece,
    own: &[ContactElement],
    options: &StripsAsked,
) -> Result<Strip, Option<StripReason>> {
    let mut best: Option<(bool, f64, Strip)> = None;
    let mut reason = None;
    for fit in &piece.fits {
        match strip(name, fit, own) {
            Ok(s) => {
                let worst = certified(std::slice::from_ref(&s), own, &Control::default()).worst_bound().value();
                let broken = !regression::keeps(&s, options.limits.as_ref());
                if best.as_ref().is_none_or(|b| (broken, worst) < (b.0, b.1)) {
                    best = Some((broken, worst, s));
                }
            }
            Err(e) => {
                reason = Some(StripReason::NoStrip { kind: fit.kind.name(), error: Box::new(Reason::error(&e)) });
            }
        }
    }
    best.map(|b| b.2).ok_or(reason)
}

/// Why no developable follows elements: too far from any, or none keeps to the limits and then how near one comes.
fn unfollowed(own: &[ContactElement], options: &StripsAsked) -> StripReason {
    // Tolerances looked at for the reason, in multiples of the one asked for.
    const WIDER: [f64; 4] = [3.0, 10.0, 100.0, 1e4];
    let StripsAsked { tolerance, fix_ends: fixed_ends, smoothing, .. } = *options;
    let reason = |kept_off| StripReason::NotFollowed { tolerance, fixed_ends, smoothing, kept_off };
    let Some(limits) = &options.limits else { return reason(None) };
    let one = |tolerance: f64, limits: Option<RegressionLimits>| {
        torses(own, &options.fits(tolerance, 1, limits)).into_iter().next().map(|f| f.error)
    };
    if one(options.tolerance, None).is_none() {
        return reason(None);
    }
    let wider = WIDER.iter().find_map(|w| one(w * options.tolerance, Some(limits.clone())));
    reason(Some(wider.unwrap_or(f64::INFINITY)))
}
