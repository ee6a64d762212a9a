//! `loft`: the developable between two rails.
//!
//! Reads like the page that describes it: find all branches of common tangent planes, follow the best one, fit it,
//! have rails and twist judged, develop; where there is no branch, take the strip of least twist and say so.

use crate::answer::note::{ExactPiece, LoftNote, Note};
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::control::Control;
use crate::design::loft::alternatives::{alternatives, greatest_twist};
use crate::design::loft::branches::{branches, Branch, BranchOptions, BranchType, Direction};
use crate::design::loft::build::{along, follow, BuildOptions, BuiltStrip};
use crate::design::loft::least_twist::{LeastTwistOptions, TwistPath};
use crate::design::loft::track::{Segment, Track};
use crate::design::loft::{apart, LoftError};
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::geom::coarse::Loose;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::{claims as flat_claims, crowded, cut, judged as flat_judged};
use crate::search::strips::exact_strip::{exact_strips, ExactError};
use crate::search::strips::judgement::{judge, Candidate};
use crate::search::strips::loft_ends::{extended, note_ends, past_ends, shares, used, with_ends, WHOLE};
pub use crate::search::strips::loft_ends::{Ends, Extension};
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use std::time::Instant;

/// How rulings are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// An exact branch where one covers enough of the rails, else least twist.
    #[default]
    Auto,
    /// An exact branch, or an error.
    Exact,
    /// The strip of least twist.
    LeastTwist,
}

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and rails, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// See [`Ends`]; default fan: both rails are used whole.
    pub ends: Ends,
    /// See [`Extension`]; default curve.
    pub extension: Extension,
    /// See [`Choice`]; default auto.
    pub choice: Choice,
    /// Which of the branches found, or of the strips of least twist where there is none or these are asked for, best
    /// first, from 1; default 1.
    pub alternative: usize,
    /// Rulings to be used, as shares of both rails' lengths; default none. With any, the strip of least twist is made.
    pub fixed: Vec<[f64; 2]>,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the rails, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "loft".into(),
            ends: Ends::Fan,
            extension: Extension::Curve,
            choice: Choice::Auto,
            alternative: 1,
            fixed: Vec::new(),
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: 1e-5,
            drawn: Drawn::default(),
        }
    }
}

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Share of the tolerance within which exactly developable strips must keep to the rails; beyond it a ruled spline with
/// a small twist is taken, which keeps to a tenth.
const EXACT_SHARE: f64 = 0.5;
/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Drawings are asked to keep to at least this multiple of what their outlines were made for: proofs follow a chain of
/// strips less tightly than outlines do, up to ten times over a duct of eight.
const DRAWN: f64 = 16.0;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;
/// Least share of both rails that an exact branch must use to be chosen without being asked for.
const ENOUGH: f64 = 0.5;
/// Rails are fitted no finer than this share of their size, and flat outlines drawn no finer than ten thousand times
/// that: digits beyond are rounding, and work for them would have no end.
const FINEST: f64 = 1e-13;
/// Alternatives of least twist that are looked for and listed.
const ALTERNATIVES: usize = 5;

/// The developable between two rails, fitted, judged and developed.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the rails given, its
/// twist is proven (see [`crate::certify::rails::twist_bound`]) to stay below `twist_tolerance`, no ruling meets the
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
    if !(tolerance > 0.0 && tolerance.is_finite()) {
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
    let (mut b, found) = oriented(&a, b, options, &mut notes);
    let regular: Vec<&Branch> = found.iter().filter(|f| is_candidate(f)).collect();
    for (k, f) in regular.iter().enumerate().take(5) {
        let share = shares(&a, &b, f, options.ends);
        let rails = [a.name.clone(), b.name.clone()];
        notes.push(LoftNote::Branch { number: k + 1, rails, shares: share, closed: f.closed });
    }
    let doubles = found.iter().filter(|f| f.kind == BranchType::DoubleCone).count();
    if doubles > 0 {
        notes.push(LoftNote::Doubles { count: doubles });
    }
    let chosen = match options.choice {
        Choice::LeastTwist => None,
        _ if !options.fixed.is_empty() => None,
        choice => {
            let branch = regular.get(options.alternative.max(1) - 1);
            let enough = branch.is_some_and(|f| f.coverage[0].min(f.coverage[1]) >= ENOUGH);
            match branch {
                Some(f)
                    if choice == Choice::Exact || options.alternative > 1 || enough || options.ends == Ends::Extend =>
                {
                    Some(*f)
                }
                None if options.alternative > 1 && (choice == Choice::Exact || !regular.is_empty()) => {
                    return Err(LoftError::NoAlternative { asked: options.alternative, count: regular.len() })
                }
                None if choice == Choice::Exact => {
                    return Err(LoftError::NoBranch { a: a.name.clone(), b: b.name.clone(), count: found.len() })
                }
                _ => None,
            }
        }
    };
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
            // Fixed rulings stay: the path is smoothed between them only.
            let mut built = Vec::new();
            let mut first = 0;
            for &last in path.held.iter().chain([&(path.stations.len() - 1)]) {
                let closed = path.closed && path.held.is_empty();
                built.extend(along([&a, &b], &path.stations[first..=last], closed, &build, &unhurried)?);
                first = last;
            }
            for (k, s) in built.iter_mut().enumerate() {
                s.strip.name = format!("A-{:02}", k + 1);
            }
            (built, path.closed)
        }
    };
    let rails = [&a, &b];
    let strips = if chosen.is_some() {
        control.report("making strips exactly developable", 0.6, "");
        exactly(strips, rails, tolerance, control, &mut notes)
    } else {
        strips
    };
    control.report("judging", 0.7, "");
    Ok(judged([&rails, &given], strips, closed, options, notes, start))
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

/// Fitted strips replaced by exactly developable ones where these come near enough to the rails; says which and why not.
fn exactly(
    built: Vec<BuiltStrip>,
    rails: [&Rail; 2],
    tolerance: f64,
    control: &Control,
    notes: &mut Vec<LoftNote>,
) -> Vec<BuiltStrip> {
    let mut out = Vec::with_capacity(built.len());
    let (mut made, mut kept) = (Vec::new(), Vec::new());
    for mut one in built {
        let fitted = one.rails.iter().any(|r| r.parameter.knots.degree() > 1);
        if fitted && control.stopped() {
            kept.push((out.len() + 1, ExactError::NotLookedFor));
        }
        let found = if fitted && !control.stopped() {
            Some(exact_strips(&one, rails, EXACT_SHARE * tolerance, control))
        } else {
            None
        };
        match found {
            Some(Ok(parts)) => {
                for mut p in parts {
                    p.built.strip.name = format!("A-{:02}", out.len() + 1);
                    let strip = p.built.strip.name.clone();
                    made.push(ExactPiece { strip, spans: p.spans, off_bound: p.off });
                    out.push(p.built);
                }
                continue;
            }
            Some(Err(why)) => kept.push((out.len() + 1, why)),
            None => {}
        }
        one.strip.name = format!("A-{:02}", out.len() + 1);
        out.push(one);
    }
    if !made.is_empty() {
        notes.push(LoftNote::Exact(made));
    }
    notes.extend(kept.into_iter().map(|(strip, why)| LoftNote::Ruled { strip, why }));
    out
}

/// Turns the second rail round where the best branch runs against it.
fn oriented(a: &Rail, b: Rail, options: &Options, notes: &mut Vec<LoftNote>) -> (Rail, Vec<Branch>) {
    let found = branches(a, &b, &BranchOptions::default());
    let merit = |d: Direction| {
        found
            .iter()
            .filter(|f| f.kind == BranchType::Regular && f.direction == d)
            .map(|f| f.coverage[0].min(f.coverage[1]))
            .fold(0.0, f64::max)
    };
    let ends = |b: &Rail| {
        let n = b.pieces.len() as f64;
        let m = a.pieces.len() as f64;
        (a.point(0.0) - b.point(0.0)).norm() + (a.point(m) - b.point(n)).norm()
    };
    // Where branches do not tell, open rails are joined so that their ends are near.
    let (same, opposite) = (merit(Direction::Same), merit(Direction::Opposite));
    let turned = b.reversed();
    let crossed = !a.closed && !b.closed && ends(&turned) < ends(&b);
    let turn = if options.fixed.is_empty() && options.choice != Choice::LeastTwist && same.max(opposite) > 0.1 {
        opposite > same
    } else {
        crossed
    };
    if !turn {
        return (b, found);
    }
    notes.push(LoftNote::Backwards { rail: b.name.clone() });
    let found = branches(a, &turned, &BranchOptions::default());
    (turned, found)
}

/// Closed rails turned so that both begin where a fan or facet of the closed branch begins: no strip is cut in two by
/// the place where a drawing happens to start. The branch, found once more, begins there too.
fn seamed(a: &Rail, b: &Rail, branch: &Branch, alternative: usize) -> Result<([Rail; 2], Branch), LoftError> {
    const STILL: f64 = 1e-11;
    const MOVES: f64 = 1e-4;
    let as_it_is = || Ok(([a.clone(), b.clone()], branch.clone()));
    let s = &branch.stations;
    let n = s.len() - 1;
    let rests = |k: usize| {
        let (p, q) = (s[k % n], s[k % n + 1]);
        let d = [q[0] - p[0], q[1] - p[1]];
        (0..2).find(|&k| d[k] <= STILL && d[1 - k] > MOVES)
    };
    let corner = |d: usize, x: f64| {
        let track = if d == 0 { Track::new(a) } else { Track::new(b) };
        matches!(track.locate(x.rem_euclid(track.end()) + 1e-9).0, Segment::Piece(_)) && (x - x.round()).abs() < 1e-9
    };
    // A place where a fan about a corner ends: the corner's rail goes on from the beginning of a piece.
    let changes = |k: &usize| rests(k + n - 1) != rests(*k);
    let best = (0..n).filter(changes).max_by_key(|&k| [0, 1].iter().filter(|d| corner(**d, s[k][**d])).count());
    let Some(k) = best else { return as_it_is() };
    let start = |rail: &Rail, x: f64| {
        let track = Track::new(rail);
        rail.started_at(track.rail_parameter(x.rem_euclid(track.end()))).map_err(LoftError::from)
    };
    let (a2, b2) = (start(a, s[k][0])?, start(b, s[k][1])?);
    let again = branches(&a2, &b2, &BranchOptions::default());
    let same = again.into_iter().filter(is_candidate).nth(alternative.max(1) - 1).filter(|f| f.closed);
    let Some(mut found) = same else { return as_it_is() };
    let ends = [Track::new(&a2).end(), Track::new(&b2).end()];
    let off = |s: &[f64; 2]| (0..2).map(|d| (s[d] / ends[d] - (s[d] / ends[d]).round()).abs()).fold(0.0, f64::max);
    let n = found.stations.len() - 1;
    let Some(first) = (0..n).min_by(|&i, &j| off(&found.stations[i]).total_cmp(&off(&found.stations[j]))) else {
        return as_it_is();
    };
    const NEAR: f64 = 1e-7;
    if off(&found.stations[first]) > NEAR {
        return as_it_is();
    }
    // Stations from there on, a period later where the list began anew; both ends exactly at the seams.
    let turns = [0, 1].map(|d: usize| (found.stations[first][d] / ends[d]).round() * ends[d]);
    let mut stations: Vec<[f64; 2]> = (first..=first + n)
        .map(|i| [0, 1].map(|d: usize| found.stations[i % n][d] + if i >= n { ends[d] } else { 0.0 } - turns[d]))
        .collect();
    stations[0] = [0.0; 2];
    stations[n] = ends;
    found.stations = stations;
    Ok(([a2, b2], found))
}

/// Whether a branch may be used.
fn is_candidate(f: &Branch) -> bool {
    f.kind == BranchType::Regular && f.direction == Direction::Same && f.coverage[0].max(f.coverage[1]) > WHOLE
}

/// A word on rails whose lengths are so different that one may be in another unit.
fn unlike(a: &Rail, b: &Rail) -> Option<LoftNote> {
    // Between the common units of length lie factors of 10, 12, 25.4 and more; 10 also lies between honest rails.
    const UNLIKE: f64 = 20.0;
    let (x, y) = (a.length(), b.length());
    let (long, short, factor) = if x > y { (a, b, x / y) } else { (b, a, y / x) };
    (factor > UNLIKE).then(|| LoftNote::Unlike { long: long.name.clone(), short: short.name.clone(), factor })
}

/// Size of both rails, mm.
fn size(rails: &[&Rail; 2]) -> f64 {
    rails[0].bbox().diagonal().max(rails[1].bbox().diagonal())
}

/// A length for people: four decimals, powers of ten where these say nothing.
fn length(x: f64) -> String {
    if x >= 1e-3 || x == 0.0 {
        format!("{x:.4}")
    } else {
        format!("{x:.1e}")
    }
}

/// The tolerance that a distance meets, rounded up to two digits.
fn reached(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return x;
    }
    let unit = 10f64.powf(x.log10().floor() - 1.0);
    (x / unit).ceil() * unit
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

/// What is covered of rails that are not covered whole, up to the tolerance, and how far strips run past their ends.
fn covered_in_part(
    built: &[BuiltStrip],
    [rails, given]: [&[&Rail; 2]; 2],
    shares: [f64; 2],
    options: &Options,
) -> Option<String> {
    let mut words = Vec::new();
    for side in 0..2 {
        let (name, whole) = (&rails[side].name, given[side].length());
        if (1.0 - shares[side]) * whole > options.tolerance {
            words.push(format!("{:.2} % of {name}", 100.0 * shares[side]));
        }
        let past = past_ends(built, side, rails[side], options.ends == Ends::Extend);
        if past > options.tolerance {
            words.push(format!("{} mm past the ends of {name}", length(past)));
        }
    }
    (!words.is_empty()).then(|| format!("certified in part: {}", words.join(", ")))
}

/// Judges and develops strips.
fn judged(
    [rails, given]: [&[&Rail; 2]; 2],
    built: Vec<BuiltStrip>,
    closed: bool,
    options: &Options,
    notes: Vec<LoftNote>,
    start: Instant,
) -> Answer {
    let pieces: Vec<Candidate> =
        built.iter().enumerate().map(|(index, built)| Candidate { index, built, rails: rails.map(Some) }).collect();
    let judgement = judge(&pieces, [What::FromCurve(0), What::FromCurve(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    let mut claims: Vec<Claim> = (0..2)
        .map(|side| {
            let off = judgement.off[side];
            Claim::at_most(What::FromCurve(side), whole, off).within(options.tolerance).because(format!(
                "the strips stray up to {} mm from {}; a tolerance of {} mm is met",
                length(off.value()),
                rails[side].name,
                length(reached(off.value()))
            ))
        })
        .collect();
    let mut missing = judgement.missing.clone();
    let shares = [0, 1].map(|d: usize| used(&built, d, rails[d], options.ends == Ends::Extend));
    // What is covered comes first.
    let part = covered_in_part(&built, [rails, given], shares, options);
    claims.splice(0..0, part.map(|reason| Claim::objection(whole, reason)));
    let strips: Vec<Strip> = built.into_iter().map(|s| s.strip).collect();
    if strips.is_empty() {
        missing.push("no strip could be made".into());
    }
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        drawn: options.drawn,
        ..StripOptions::new((CONTOUR_SHARE * options.tolerance).max(1e4 * FINEST * size(rails)))
    };
    let chain = Part { name: "A".into(), first: 0, count: strips.len(), missing: String::new() };
    let (parts, patterns) = cut(&strips, &[chain], &flat);
    // Nothing is drawn finer than that, however fine the strips are.
    let drawable = options.tolerance.max(DRAWN * flat.contour_tolerance);
    let flat_proof = flat_judged(&strips, &parts, &patterns, drawable);
    let mut notes: Vec<Note> = notes.into_iter().map(Note::Loft).collect();
    notes.extend(crowded(&patterns, &flat).into_iter().map(Note::Crowded));
    notes.extend(closed.then_some(Note::CutOpen { part: None }));
    notes.extend(creases(&strips).map(Note::Loft));
    claims.extend((0..2).map(|d| Claim::measured(What::UsedOf(d), whole, 100.0 * shares[d])));
    claims.extend(judgement.whole());
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    claims.extend(flat_claims(&parts, &patterns, &flat_proof, drawable));
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(judgement.claims);
    let guides = given.iter().map(|r| Guide { name: r.name.clone(), points: r.samples(200) }).collect();
    Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields: judgement.fields,
        meaning: judgement.meaning,
        parts,
        patterns,
        flat: flat_proof,
        guides,
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Loft, &options.input, options.tolerance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::note::EndNote;
    use crate::brep::space_curve::SpaceCurve;
    use crate::certify::claim::Status;
    use crate::geom::{Frame, Vec3};
    use crate::io::words;
    use crate::torse::form::PanelKind;
    use std::f64::consts::TAU;

    fn made(a: &Rail, b: &Rail, options: &Options) -> Answer {
        loft(a, b, options, &Control::default()).expect("an answer")
    }

    fn figure(s: &Answer, name: &str) -> f64 {
        let curves: Vec<String> = s.guides.iter().map(|g| g.name.clone()).collect();
        s.claims_of(Subject::Whole).find(|c| words::name(c, &curves) == name).map_or(f64::NAN, Claim::value)
    }

    /// A duct from a square that starts in the middle of an edge to a circle whose seam lies anywhere.
    fn duct(seam: f64) -> (Rail, Rail) {
        let points = [(0.0, -300.0), (300.0, -300.0), (300.0, 300.0), (-300.0, 300.0), (-300.0, -300.0), (0.0, -300.0)];
        let square = Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 0.0))).expect("rail");
        let (s, c) = seam.sin_cos();
        let frame = Frame {
            origin: Vec3::new(50.0, 20.0, 500.0),
            x: Vec3::new(c, s, 0.1).normalize(),
            y: Vec3::new(-s, c, 0.0).normalize(),
            z: Vec3::z(),
        };
        let frame = Frame { z: frame.x.cross(&frame.y), ..frame };
        let (round, _) = SpaceCurve::Ellipse { frame, a: 175.0, b: 175.0 }.to_spline(0.0, TAU).expect("spline");
        (square, Rail::new("round", &[round]).expect("rail"))
    }

    #[test]
    fn a_duct_is_four_triangles_and_four_cones_wherever_its_drawings_start() {
        for seam in [0.0, 0.4, 2.0] {
            let (a, b) = duct(seam);
            let answer = made(&a, &b, &Options::new(1e-6));
            assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
            let count = |kind| answer.strips().filter(|s| s.kind == kind).count();
            assert_eq!(
                (count(PanelKind::Plane), count(PanelKind::Cone), answer.patchwork.panels.len()),
                (4, 4, 8),
                "{seam}"
            );
        }
    }

    #[test]
    fn the_crease_between_two_triangles_is_told() {
        let line = |name: &str, p: Vec3, q: Vec3| Rail::polyline(name, &[p, q]).expect("rail");
        let a = line("a", Vec3::zeros(), Vec3::new(100.0, 0.0, 0.0));
        let b = line("b", Vec3::new(0.0, 100.0, 0.0), Vec3::new(100.0, 100.0, 100.0));
        let answer = made(&a, &b, &Options::new(1e-3));
        let crease = |n: &Note| match n {
            Note::Loft(LoftNote::Creases { count: 1, sharpest, .. }) => Some(sharpest.to_degrees()),
            _ => None,
        };
        let told = answer.notes.iter().find_map(crease);
        assert!(told.is_some_and(|a| (a - 54.7).abs() < 0.1 || (a - 45.0).abs() < 0.1), "{:?}", answer.notes);
        // Smooth ones have none.
        let (a, b) = duct(0.4);
        let smooth = made(&a, &b, &Options::new(1e-3));
        assert!(!smooth.notes.iter().any(|n| matches!(n, Note::Loft(LoftNote::Creases { .. }))));
        let far = line("far", Vec3::new(200.0, 0.0, 0.0), Vec3::new(300.0, 0.0, 0.0));
        let near = line("near", Vec3::zeros(), Vec3::new(100.0, 0.0, 0.0));
        let refused = loft(&near, &far, &Options::new(1e-3), &Control::default());
        assert!(matches!(refused, Err(LoftError::OneLine { .. })), "{refused:?}");
    }

    /// Two arcs over a common cylinder, the second one longer at its end.
    fn arcs() -> (Rail, Rail) {
        let arc = |name: &str, to: f64, z: f64, r: f64| {
            let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
            let (c, _) = SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(0.0, to).expect("spline");
            Rail::new(name, &[c]).expect("rail")
        };
        (arc("short", 1.2, 0.0, 100.0), arc("long", 1.9, 60.0, 80.0))
    }

    #[test]
    fn ends_are_trimmed_fanned_or_extended() {
        let (a, b) = arcs();
        let with = |ends| made(&a, &b, &Options { ends, ..Options::new(0.01) });
        let ring = |r: f64, s: f64, h: f64, angle: f64| 0.5 * angle * (r + s) * (h * h + (r - s) * (r - s)).sqrt();
        let area = |s: &Answer| s.strips().map(Strip::area_estimate).sum::<f64>();
        let trimmed = with(Ends::Trim);
        assert_eq!(trimmed.status(), Status::Uncertified);
        let reason = words::reason(&trimmed.claims, &[]);
        assert!(reason.starts_with("certified in part: 63.16 % of long"), "{reason}");
        // Both edges, 200 mm long in all, may lie up to the tolerance off.
        assert!((area(&trimmed) - ring(100.0, 80.0, 60.0, 1.2)).abs() < 0.01 * 200.0);
        let cut_short =
            |n: &Note| matches!(n, Note::Loft(LoftNote::Ends(EndNote::Used { rail, .. })) if rail == "long");
        assert!(trimmed.notes.iter().any(cut_short), "{:?}", trimmed.notes);
        // The rest of the long rail is joined to the end of the short one.
        let fanned = with(Ends::Fan);
        assert_eq!(fanned.status(), Status::Certified, "{:?} {:?}", fanned.claims, fanned.notes);
        let tip = a.point(1.0);
        let fan: Vec<&Strip> = fanned.strips().filter(|s| s.is_point(0)).collect();
        assert_eq!(fan.len(), 1);
        assert!((fan[0].ruling(0.5)[0] - tip).norm() < 1e-9);
        assert!((fan[0].ruling(1.0)[1] - b.point(1.0)).norm() < 1e-9);
        // The short rail goes on along its tangent.
        let extended = with(Ends::Extend);
        assert_eq!(extended.status(), Status::Uncertified, "past the end");
        let reason = words::reason(&extended.claims, &[]);
        assert!(reason.starts_with("certified in part:") && reason.contains("past the ends of short"), "{reason}");
        let longer = |n: &Note| matches!(n, Note::Loft(LoftNote::Ends(EndNote::Extended { .. })));
        assert!(area(&extended) > area(&trimmed) && extended.notes.iter().any(longer));
    }

    #[test]
    fn alternatives_fixed_rulings_and_least_twist_are_what_was_asked_for() {
        let (a, b) = arcs();
        let e = loft(&a, &b, &Options { alternative: 9, ..Options::new(0.01) }, &Control::default()).expect_err("none");
        assert!(matches!(e, LoftError::NoAlternative { asked: 9, .. }), "{e}");
        let fixed = made(&a, &b, &Options { fixed: vec![[0.5, 0.3]], ..Options::new(0.01) });
        let at = |rail: &Rail, share: f64| {
            let all = (0..=2000).map(|k| f64::from(k) / 2000.0);
            rail.point(
                all.min_by(|s, t| {
                    let off = |s: f64| (rail.length_to(s) - share * rail.length()).abs();
                    off(*s).total_cmp(&off(*t))
                })
                .expect("some"),
            )
        };
        let (p, q) = (at(&a, 0.5), at(&b, 0.3));
        let met = fixed.strips().flat_map(|s| [s.ruling(0.0), s.ruling(1.0)]);
        // Within the step of the search above.
        assert!(met.into_iter().any(|r| (r[0] - p).norm() < 0.1 && (r[1] - q).norm() < 0.1));
        assert!(fixed.status() == Status::Uncertified && fixed.patchwork.panels.len() < 10);
        assert!(figure(&fixed, "twist") > 1e-3, "{:?} {:?}", fixed.claims, fixed.notes);
        let least = made(&a, &b, &Options { choice: Choice::LeastTwist, ..Options::new(0.01) });
        assert!(least.notes.contains(&Note::Loft(LoftNote::LeastTwist)));
    }

    #[test]
    fn tolerances_beyond_rounding_end_soon_and_say_what_is_met() {
        // A circle and an ellipse: no exact spline, so that work would have no end.
        let ring = |name: &str, z: f64, a: f64, b: f64| {
            let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
            let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
            Rail::new(name, &[c]).expect("rail")
        };
        let (a, b) = (ring("a", 0.0, 100.0, 100.0), ring("b", 120.0, 150.0, 60.0));
        let s = made(&a, &b, &Options::new(1e-14));
        assert_eq!(s.status(), Status::Uncertified);
        let reason = words::reason(&s.claims, &[]);
        assert!(reason.contains(" mm is met") && figure(&s, "from a") < 1e-7, "{reason}");
        // An exact one is found at once where the tolerance allows, and is worth its name.
        let s = made(&a, &b, &Options::new(0.01));
        assert!(s.status() == Status::Certified && figure(&s, "twist, bound") < 1e-4, "{:?}", s.claims);
        assert!(s.notes.iter().any(|n| matches!(n, Note::Loft(LoftNote::Exact(_)))), "{:?}", s.notes);
        let stopped = Control::default();
        stopped.cancel();
        let s = loft(&a, &b, &Options::new(0.01), &stopped).expect("an answer");
        let early = |n: &Note| matches!(n, Note::Loft(LoftNote::Ruled { why: ExactError::NotLookedFor, .. }));
        assert!(s.status() == Status::Certified && s.notes.iter().any(early), "{:?}", s.notes);
    }

    #[test]
    fn rails_that_touch_and_bad_tolerances_are_refused() {
        let (a, _) = arcs();
        let e = loft(&a, &a, &Options::new(0.01), &Control::default()).expect_err("the same");
        assert!(e.to_string().contains("short"), "{e}");
        let again = Rail { name: "again".into(), ..a.clone() };
        let e = loft(&a, &again, &Options::new(0.01), &Control::default()).expect_err("the same");
        assert!(e.to_string().contains("short runs along again"), "{e}");
        let crossing = Rail::polyline("crossing", &[a.point(0.5) - Vec3::z() * 9.0, a.point(0.5) + Vec3::z() * 30.0]);
        let e = loft(&a, &crossing.expect("rail"), &Options::new(0.01), &Control::default()).expect_err("touch");
        assert!(matches!(e, LoftError::Touch { .. }), "{e}");
        for t in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(loft(&a, &a, &Options::new(t), &Control::default()), Err(LoftError::Tolerance(_))));
        }
    }
}
