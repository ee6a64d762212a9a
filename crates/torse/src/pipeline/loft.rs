//! `loft`: the developable between two rails.
//!
//! Reads like the page that describes it: find all branches of common tangent planes, follow the best one, fit it,
//! have rails and twist judged, develop; where there is no branch, take the strip of least twist and say so.

mod assessed;
mod options;
#[cfg(test)]
mod tests;

use crate::answer::note::{LoftNote, Note};
use crate::answer::Answer;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::design::loft::alternatives::{alternatives, greatest_twist};
use crate::design::loft::branches::{Branch, BranchType};
use crate::design::loft::build::{follow, strips_along_path, BuildOptions, BuiltStrip};
use crate::design::loft::least_twist::{LeastTwistOptions, TwistPath};
use crate::design::loft::orientation::{is_candidate, oriented, seamed};
use crate::design::loft::{apart, LoftError};
use crate::geom::coarse::{is_tolerance, Loose};
use crate::search::strips::exact_chain::{exact_chain, ExactChain};
use crate::search::strips::loft_ends::{extended, note_ends, shares, with_ends};
use crate::torse::rail::Rail;
use assessed::{assessed, FINEST};
pub use options::{Choice, Ends, Extension, Options};
use std::time::Instant;

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;
/// Least share of both rails that an exact branch must use to be chosen without being asked for.
const LEAST_COVERAGE: f64 = 0.5;
/// Share of the tolerance within which rails count as in one plane.
const FLAT_SHARE: f64 = 0.1;
/// Alternatives that are listed; of least twist, also those that are looked for.
const ALTERNATIVES: usize = 5;

/// The developable between two rails, fitted, judged and developed.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the rails given, its
/// twist is proven (see `certify::rails::twist_bound`) to stay below `twist_tolerance`, no ruling meets the
/// regression curve between the rails (proven), and every part has a pattern. Everything else is `Uncertified` with the
/// reason.
///
/// # Errors
/// Rails that touch, no branch where one is demanded, fixed rulings out of order, a tolerance that is not positive.
///
/// # Example
/// ```
/// use torse::geom::Vec3;
/// use torse::torse::rail::Rail;
/// let low = Rail::polyline("low", &[Vec3::zeros(), Vec3::new(300.0, 0.0, 0.0)])?;
/// let high = Rail::polyline("high", &[Vec3::new(20.0, 0.0, 80.0), Vec3::new(250.0, 0.0, 90.0)])?;
/// let answer = torse::loft(&low, &high, &torse::Loft::new(0.1), &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn loft(a: &Rail, b: &Rail, options: &Options, control: &Control) -> Result<Answer, LoftError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !is_tolerance(tolerance) {
        return Err(LoftError::Tolerance(tolerance));
    }
    Loose::check(Rail::extent(&[a, b]), tolerance)?;
    apart(a, b)?;
    control.report("looking for branches", 0.1, "");
    let given = [a, b];
    let mut notes = Vec::new();
    notes.extend(unlike(a, b));
    let (mut a, b) = match options.ends {
        Ends::Extend => (extended(a, options.extension), extended(b, options.extension)),
        _ => (a.clone(), b.clone()),
    };
    let by_branches = options.fixed.is_empty() && options.choice != Choice::LeastTwist;
    let (mut b, found, turned) = oriented(&a, b, by_branches);
    notes.extend(turned.then(|| LoftNote::Backwards { rail: b.name.clone() }));
    let regular: Vec<&Branch> = found.iter().filter(|f| is_candidate(f)).collect();
    notes.extend(told([&a, &b], &regular, options.ends));
    let doubles = found.iter().filter(|f| f.kind == BranchType::DoubleCone).count();
    notes.extend((doubles > 0).then_some(LoftNote::Doubles { count: doubles }));
    let chosen = chosen_branch(&regular, options)?;
    if chosen.is_none() && by_branches && options.choice == Choice::Exact {
        return Err(LoftError::NoBranch { a: a.name.clone(), b: b.name.clone(), count: found.len() });
    }
    control.report("fitting", 0.4, "");
    let size = a.bbox().diagonal().max(b.bbox().diagonal());
    let mut build = BuildOptions::new((RAIL_SHARE * tolerance).max(FINEST * size));
    build.twist_tolerance = TWIST_SHARE * options.twist_tolerance;
    // What a stopped job falls back on is fitted all the same.
    let unhurried = Control::default();
    let (strips, closed) = match chosen {
        Some(branch) if branch.closed => {
            let (turned, branch) = seamed(&a, &b, branch, options.alternative)?;
            [a, b] = turned;
            (follow([&a, &b], &branch, &build, &unhurried)?, true)
        }
        Some(branch) => {
            let mut ends = Vec::new();
            let whole = with_ends(&a, &b, branch, options.ends, &mut ends);
            note_ends(&a, &b, &whole, options.ends, &mut ends);
            notes.extend(ends.into_iter().map(LoftNote::Ends));
            (follow([&a, &b], &whole, &build, &unhurried)?, whole.closed)
        }
        None => {
            notes.push(LoftNote::LeastTwist);
            let path = chosen_path(&a, &b, options, &mut notes)?;
            build.exact = false;
            (along_path([&a, &b], &path, &build)?, path.closed)
        }
    };
    let rails = [&a, &b];
    let strips = if chosen.is_some() {
        control.report("making strips exactly developable", 0.6, "");
        let ExactChain { strips, exact, ruled } = exact_chain(strips, rails, tolerance, control);
        notes.extend((!exact.is_empty()).then_some(LoftNote::Exact(exact)));
        notes.extend(ruled.into_iter().map(|(strip, why)| LoftNote::Ruled { strip, why }));
        strips
    } else {
        strips
    };
    control.report("judging", 0.7, "");
    let mut answer = assessed([&rails, &given], strips, closed, options, notes, start);
    if answer.status() != Status::Certified && Rail::in_one_plane(&given, FLAT_SHARE * tolerance) {
        answer.notes.push(Note::Loft(LoftNote::OnePlane));
    }
    Ok(answer)
}

/// The best branches, as notes.
fn told(rails: [&Rail; 2], regular: &[&Branch], ends: Ends) -> Vec<LoftNote> {
    let note = |(k, f): (usize, &&Branch)| LoftNote::Branch {
        number: k + 1,
        rails: rails.map(|r| r.name.clone()),
        shares: shares(rails[0], rails[1], f, ends),
        closed: f.closed,
    };
    regular.iter().enumerate().take(ALTERNATIVES).map(note).collect()
}

/// The branch that was asked for, or the best one where it covers enough; `None` where least twist takes its place.
fn chosen_branch<'a>(regular: &[&'a Branch], options: &Options) -> Result<Option<&'a Branch>, LoftError> {
    if options.choice == Choice::LeastTwist || !options.fixed.is_empty() {
        return Ok(None);
    }
    let exact = options.choice == Choice::Exact;
    let Some(branch) = regular.get(options.alternative.max(1) - 1) else {
        if options.alternative > 1 && (exact || !regular.is_empty()) {
            return Err(LoftError::NoAlternative { asked: options.alternative, count: regular.len() });
        }
        return Ok(None);
    };
    let enough = branch.coverage[0].min(branch.coverage[1]) >= LEAST_COVERAGE;
    let asked_for = exact || options.alternative > 1 || options.ends == Ends::Extend;
    Ok((asked_for || enough).then_some(*branch))
}

/// Strips along a path of least twist. Fixed rulings stay: the path is smoothed between them only.
fn along_path(rails: [&Rail; 2], path: &TwistPath, build: &BuildOptions) -> Result<Vec<BuiltStrip>, LoftError> {
    let mut built = Vec::new();
    let mut first = 0;
    for &last in path.held.iter().chain([&(path.stations.len() - 1)]) {
        let closed = path.closed && path.held.is_empty();
        // What a stopped job falls back on is fitted all the same.
        built.extend(strips_along_path(rails, &path.stations[first..=last], closed, build, &Control::default())?);
        first = last;
    }
    for (k, s) in built.iter_mut().enumerate() {
        s.strip.name = format!("A-{:02}", k + 1);
    }
    Ok(built)
}

/// The strip of least twist, or the alternative to it that was asked for; all are listed.
fn chosen_path(a: &Rail, b: &Rail, options: &Options, notes: &mut Vec<LoftNote>) -> Result<TwistPath, LoftError> {
    let wanted = LeastTwistOptions { fixed: options.fixed.clone(), ..LeastTwistOptions::default() };
    let mut found = alternatives(a, b, &wanted, ALTERNATIVES.max(options.alternative))?;
    if found.len() > 1 {
        for (k, p) in found.iter().enumerate() {
            let (bends, twist) = (p.cost.max(0.0).sqrt(), greatest_twist(a, b, p));
            notes.push(LoftNote::LeastTwistPath { number: k + 1, bends, twist, area: p.area });
        }
    }
    if options.alternative > found.len() {
        return Err(LoftError::NoAlternative { asked: options.alternative, count: found.len() });
    }
    Ok(found.swap_remove(options.alternative.max(1) - 1))
}

/// A word on rails whose lengths are so different that one may be in another unit.
fn unlike(a: &Rail, b: &Rail) -> Option<LoftNote> {
    // Between the common units of length lie factors of 10, 12, 25.4 and more; 10 also lies between honest rails.
    const UNLIKE: f64 = 20.0;
    let (x, y) = (a.length(), b.length());
    let (long, short, factor) = if x > y { (a, b, x / y) } else { (b, a, y / x) };
    (factor > UNLIKE).then(|| LoftNote::Unlike { long: long.name.clone(), short: short.name.clone(), factor })
}
