//! `hull`: developables on the boundary of the convex hull of curves.
//!
//! Reads like the page that describes it: find the rulings on which the hull rests, make exact strips along them, have
//! rails and twist judged, develop.

use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::certify::rails::twist_bound;
use crate::control::Control;
use crate::design::hull::sparse::sparse;
use crate::design::hull::strips::{strips, HullPart, HullStrip};
use crate::design::hull::{hull as rulings_of_hull, Hull, HullError};
use crate::design::loft::build::BuildOptions;
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::coarse::Loose;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::{claims as flat_claims, crowded, cut_until, judged as flat_judged};
use crate::search::strips::judgement::{findings, summed, Candidate, Found, SQUARE_METRES};
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use rayon::prelude::*;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and curves, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Points per curve with which the search begins; default 256.
    pub samples: usize,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the curves, mm; default none: 8 over the length.
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
            input: "hull".into(),
            samples: 256,
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: 1e-5,
            drawn: Drawn::default(),
        }
    }
}

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Share of the tolerance by which splines with few knots may stray from curves with many.
const FOLLOW_SHARE: f64 = 0.1;
/// Strips of one span each that are written within a second; more are not written once the job was asked to stop.
const SOON: usize = 2000;
/// Strips left out that are named; more are counted.
const NAMED: usize = 12;
/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;

/// The developables on the boundary of the convex hull of curves, judged and developed. Planar pieces bounded by a
/// single planar curve are left open, and named.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the curves, its twist
/// is proven to stay below `twist_tolerance`, no ruling meets the regression curve between its ends (proven), and every
/// part has a pattern. *Not guaranteed*: that features finer than the samples are seen.
///
/// # Errors
/// No curves, curves in one plane, a tolerance that is not positive.
///
/// # Example
/// ```
/// use torse::io::curves::CurveOptions;
/// let square = include_bytes!("../../../../data/duct_square.dxf");
/// let round = include_bytes!("../../../../data/duct_round.dxf");
/// let curves = [
///     torse::read_curve(square, &CurveOptions::new("square"))?.0,
///     torse::read_curve(round, &CurveOptions::new("round"))?.0,
/// ];
/// let answer = torse::hull(&curves, &torse::Hull::new(0.1), &torse::Control::default())?;
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hull(curves: &[Rail], options: &Options, control: &Control) -> Result<Answer, HullError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(HullError::Tolerance(tolerance));
    }
    Loose::check(Rail::extent(&curves.iter().collect::<Vec<_>>()), tolerance)?;
    control.report("looking for rulings", 0.1, "");
    // Curves through very many points by their likes with few knots; judged are the given ones.
    let followed: Vec<Rail> = curves.par_iter().map(|c| sparse(c, FOLLOW_SHARE * tolerance, control)).collect();
    let found = rulings_of_hull(&followed, options.samples, control)?;
    control.report("fitting", 0.4, "");
    let mut build = BuildOptions::new(RAIL_SHARE * tolerance);
    build.twist_tolerance = TWIST_SHARE * options.twist_tolerance;
    let mut made = strips(&followed, &found, tolerance, &build, control)?;
    let changed: Vec<bool> = curves.iter().zip(&followed).map(|(c, f)| c != f).collect();
    for s in made.iter_mut().flat_map(|p| &mut p.strips) {
        for d in (0..2).filter(|d| changed[s.rails[*d]]) {
            // No longer the curve itself: a degree above the first says so.
            let part = &mut s.built.rails[d].parameter;
            *part = part.elevated()?;
        }
    }
    control.report("judging", 0.7, "");
    let mut notes = notes(curves, &found, &made, tolerance);
    let mut kept = kept(curves, made, options, control, &mut notes);
    // A span costs about a tenth of a strip.
    let spans: usize = kept.strips.iter().map(|s| s.patch.knots_u.breaks().len() - 1).sum();
    if control.stopped() && kept.strips.len() + spans / 10 > SOON {
        let found = kept.strips.len();
        kept = Kept { skipped: kept.skipped, ..Kept::default() };
        kept.missing.push(format!("{found} strips were found, too many to be laid flat and written after a stop"));
    }
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        drawn: options.drawn,
        ..StripOptions::new(CONTOUR_SHARE * tolerance)
    };
    let (parts, patterns) = cut_until(&kept.strips, &kept.parts, &flat, control);
    let flat_proof = flat_judged(&kept.strips, &parts, &patterns, tolerance);
    notes.extend(crowded(&patterns, &flat).into_iter().map(Note::Crowded));
    let whole = Subject::Whole;
    let mut claims = kept.claims;
    claims.push(Claim::count(Counted::Strips, whole, kept.strips.len()));
    claims.extend(flat_claims(&parts, &patterns, &flat_proof, tolerance));
    let stopped = control.stopped().then(|| "the job was stopped early".to_owned());
    claims.extend(kept.missing.into_iter().chain(stopped).map(|reason| Claim::objection(whole, reason)));
    claims.extend(kept.of_strips);
    Ok(Answer {
        claims,
        patchwork: Patchwork::of_strips(kept.strips),
        fields: kept.fields,
        meaning: kept.meaning,
        parts,
        patterns,
        flat: flat_proof,
        guides: curves.iter().map(|r| Guide { name: r.name.clone(), points: r.samples(200) }).collect(),
        notes,
        skipped: kept.skipped.into_iter().map(Skipped::from).collect(),
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Hull, &options.input, options.tolerance)
    })
}

/// What people should know of the search.
fn notes(curves: &[Rail], found: &Hull, made: &[HullPart], tolerance: f64) -> Vec<Note> {
    let mut notes: Vec<Note> = Vec::new();
    for &r in &found.lids {
        notes.push(Note::Lid { curve: curves[r].name.clone() });
    }
    let used = |r: usize| made.iter().flat_map(|p| &p.strips).any(|s| s.rails.contains(&r));
    for (_, c) in curves.iter().enumerate().filter(|(r, _)| !used(*r)) {
        notes.push(Note::Inside { curve: c.name.clone() });
    }
    let tips: usize = made.iter().map(|p| p.tips).sum();
    if tips > 0 {
        notes.push(Note::Tips { count: tips, tolerance });
    }
    notes
}

/// Strips with bounded errors, as they are written, and the names of the others.
#[derive(Default)]
struct Kept {
    strips: Vec<Strip>,
    fields: Vec<PanelField>,
    meaning: FieldMeaning,
    parts: Vec<Part>,
    skipped: Vec<String>,
    claims: Vec<Claim>,
    of_strips: Vec<Claim>,
    missing: Vec<String>,
}

/// Judges parts. A strip of which nothing is proven would be cut from sheet in vain: it is named and not written, and
/// the strips on both sides of it are parts of their own.
fn kept(curves: &[Rail], mut made: Vec<HullPart>, options: &Options, control: &Control, notes: &mut Vec<Note>) -> Kept {
    for (k, part) in made.iter_mut().enumerate() {
        for (i, s) in part.strips.iter_mut().enumerate() {
            s.built.strip.name = format!("{}-{:02}", part_name(k), i + 1);
        }
        if let Some(facet) = &mut part.facet {
            facet.name = format!("{}-01", part_name(k));
        }
    }
    let reversed: Vec<Rail> = curves.iter().map(Rail::reversed).collect();
    let candidate = |s: &'_ HullStrip| -> [Option<&Rail>; 2] {
        [0, 1].map(|d: usize| Some(if s.turned[d] { &reversed[s.rails[d]] } else { &curves[s.rails[d]] }))
    };
    let all: Vec<Candidate> = made
        .iter()
        .flat_map(|p| &p.strips)
        .map(|s| Candidate { index: 0, built: &s.built, rails: candidate(s) })
        .collect();
    let found = findings(&all, options.twist_tolerance, control);
    let mut out = Kept::default();
    let mut written: Vec<(Candidate, &Found)> = Vec::new();
    let mut judged = all.iter().zip(&found);
    let mut facets = Vec::new();
    for (k, part) in made.iter().enumerate() {
        let name = part_name(k);
        let mut runs: Vec<(usize, usize)> = Vec::new();
        let mut joined = false;
        for (c, f) in judged.by_ref().take(part.strips.len()) {
            if !f.is_bounded() {
                let name = &c.built.strip.name;
                out.skipped.push(format!(
                    "strip {name}: nothing bounds its distance from the curves or its twist; not written"
                ));
                joined = false;
                continue;
            }
            let index = out.strips.len();
            written.push((Candidate { index, ..*c }, f));
            out.strips.push(c.built.strip.clone());
            out.fields.push(PanelField::default());
            match runs.last_mut().filter(|_| joined) {
                Some(run) => run.1 += 1,
                None => runs.push((index, 1)),
            }
            joined = true;
        }
        if part.closed && runs.len() == 1 && runs[0].1 == part.strips.len() {
            notes.push(Note::CutOpen { part: Some(name.clone()) });
        }
        if let Some(facet) = &part.facet {
            facets.push((out.strips.len(), facet));
            runs.push((out.strips.len(), 1));
            out.fields.push(PanelField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![0.0; 4] });
            out.strips.push(facet.clone());
        }
        for (i, &(first, count)) in runs.iter().enumerate() {
            let name = if runs.len() > 1 { format!("{name}.{}", i + 1) } else { name.clone() };
            out.parts.push(Part { name, first, count, missing: String::new() });
        }
    }
    let skipped = out.skipped.len();
    if skipped > NAMED {
        out.skipped.truncate(NAMED);
        out.skipped.push(format!("{} more strips: nothing bounds them either", skipped - NAMED));
    }
    if skipped > 0 {
        out.missing.push(match skipped {
            1 => "1 strip has no proof and is not written".to_owned(),
            n => format!("{n} strips have no proof and are not written"),
        });
    }
    let judgement = summed(&written, [What::FromSide(0), What::FromSide(1)], options.twist_tolerance);
    out.missing.extend(judgement.missing.iter().cloned());
    for ((c, _), field) in written.iter().zip(&judgement.fields) {
        out.fields[c.index] = field.clone();
    }
    if judgement.counts[0] > 0 {
        let off = judgement.off[0].max(judgement.off[1]);
        out.claims.push(
            Claim::at_most(What::FromCurves, Subject::Whole, off)
                .within(options.tolerance)
                .because(format!("the strips stray up to {:.4} mm from the curves", off.value())),
        );
    }
    out.claims.extend(judgement.whole());
    out.of_strips = judgement.claims;
    for (index, facet) in facets {
        out.of_strips.extend(facet_claims(index, facet, options.twist_tolerance));
    }
    out.meaning = judgement.meaning;
    if out.strips.is_empty() {
        out.missing.push("the hull has no developable strips between smooth curves".into());
    }
    out
}

/// What is said of a triangle whose corners lie on curves: plane by construction.
fn facet_claims(index: usize, facet: &Strip, limit: f64) -> Vec<Claim> {
    let subject = Subject::Panel(index);
    vec![
        Claim::given(What::FromSide(0), subject, 0.0),
        Claim::given(What::FromSide(1), subject, 0.0),
        Claim::at_most(What::Twist, subject, twist_bound(facet, limit, &Control::default()).angle().degrees())
            .within(limit.to_degrees()),
        Claim::measured(What::Twist, subject, 0.0),
        Claim::measured(What::RegressionClearance, subject, f64::INFINITY),
        Claim::measured(What::Area, subject, facet.area_estimate() * SQUARE_METRES),
    ]
}

/// A, B, …, Z, then numbers.
fn part_name(k: usize) -> String {
    match u8::try_from(k) {
        Ok(k) if k < 26 => char::from(b'A' + k).to_string(),
        _ => format!("P{}", k + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::certify::claim::{Evidence, Status};
    use crate::geom::{Frame, Vec3};
    use std::f64::consts::TAU;

    fn ellipse(name: &str, origin: Vec3, a: f64, b: f64) -> Rail {
        let frame = Frame { origin, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new(name, &[c]).expect("rail")
    }

    #[test]
    fn circle_and_ellipse_are_joined_and_certified() {
        let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
        let answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
        assert_eq!(answer.notes.iter().filter(|n| matches!(n, Note::Lid { .. })).count(), 2);
        assert!(!answer.patterns.is_empty());
    }

    #[test]
    fn three_circles_leave_two_planar_triangles() {
        let curves = [0.0, 1.0, 2.0].map(|k: f64| {
            let a = k * TAU / 3.0;
            // Circles about the middle of a triangle's corners, standing upright, turned towards it.
            let frame = Frame {
                origin: Vec3::new(a.cos(), a.sin(), 0.0) * 300.0,
                x: Vec3::new(-a.sin(), a.cos(), 0.0),
                y: Vec3::z(),
                z: Vec3::new(a.cos(), a.sin(), 0.0),
            };
            let (c, _) = SpaceCurve::Ellipse { frame, a: 100.0, b: 100.0 }.to_spline(0.0, TAU).expect("spline");
            Rail::new(&format!("circle {k}"), &[c]).expect("rail")
        });
        let answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{:?} {:?}", answer.claims, answer.notes);
        let upright = |s: &&Strip| {
            let p = s.patch.control.iter().map(|c| c[2] / c[3]).collect::<Vec<_>>();
            p.iter().all(|z| (z.abs() - 100.0).abs() < 1e-9)
        };
        // Planes z = ±100 touch all three circles at their tops and bottoms.
        assert_eq!(answer.strips().filter(upright).count(), 2);
    }

    #[test]
    fn proven_numbers_are_known_and_not_below_measured_ones() {
        let wave = |t: f64| Vec3::new(300.0 * t.cos(), 200.0 * t.sin(), 60.0 * (2.0 * t).cos());
        let cap = |t: f64| Vec3::new(150.0 * t.cos(), 150.0 * t.sin(), 400.0 + 20.0 * (3.0 * t).cos());
        let row = |f: &dyn Fn(f64) -> Vec3| {
            let points: Vec<Vec3> = (0..=60).map(|k| f(TAU * f64::from(k % 60) / 60.0)).collect();
            Rail::through("curve", &points).expect("rail")
        };
        let options = Options { samples: 48, ..Options::new(0.5) };
        let answer = hull(&[row(&wave), row(&cap)], &options, &Control::default()).expect("an answer");
        assert!(answer.claims.iter().all(|c| !c.is_unknown()), "{:?}", answer.claims);
        let twist = |c: &&Claim| c.what() == What::Twist;
        for bound in answer.claims.iter().filter(twist).filter(|c| c.evidence() == Evidence::Proven) {
            let measured = |c: &&Claim| c.evidence() == Evidence::Measured && c.subject() == bound.subject();
            for c in answer.claims.iter().filter(twist).filter(measured) {
                assert!(c.value() <= bound.value(), "{c:?} {bound:?}");
            }
        }
        // What is written has bounds; the rest is named.
        assert!(answer.strips().all(|s| answer.skipped.iter().all(|n| !n.reason.contains(&s.name))));
    }

    #[test]
    fn curves_through_many_points_have_as_few_spans_as_their_shape_needs() {
        let at = |t: f64, a: f64, b: f64, z: f64| Vec3::new(a * t.cos(), b * t.sin(), z);
        let row = |n: u32, a: f64, b: f64, z: f64| {
            let points: Vec<Vec3> = (0..=n).map(|k| at(TAU * f64::from(k % n) / f64::from(n), a, b, z)).collect();
            Rail::through("curve", &points).expect("rail")
        };
        let curves = [row(700, 300.0, 300.0, 0.0), row(500, 500.0, 200.0, 400.0)];
        let options = Options { samples: 64, ..Options::new(0.1) };
        let answer = hull(&curves, &options, &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{:?} {:?}", answer.claims, answer.skipped);
        let spans: usize = answer.strips().map(|s| s.patch.knots_u.breaks().len() - 1).sum();
        assert!(spans < 600, "{spans}");
        // Fitted to the curves, not laid between them.
        assert!(answer.claims.iter().any(|c| c.what() == What::Count(Counted::ExactStrips) && c.value() == 0.0));
    }

    #[test]
    fn a_stopped_job_ends_at_once_and_says_so() {
        let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
        let control = Control::default();
        control.cancel();
        let answer = hull(&curves, &Options::new(0.1), &control).expect("an answer");
        let told = |c: &Claim| c.what() == What::Objection && c.reason().contains("stopped early");
        assert!(answer.patchwork.panels.is_empty() && answer.claims.iter().any(told), "{:?}", answer.claims);
    }

    #[test]
    fn what_has_no_hull_is_refused() {
        let control = Control::default();
        assert_eq!(hull(&[], &Options::new(0.1), &control).err(), Some(HullError::NoCurves));
        let flat = [ellipse("a", Vec3::zeros(), 1.0, 1.0), ellipse("b", Vec3::x() * 5.0, 1.0, 1.0)];
        let e = hull(&flat, &Options::new(0.1), &control).expect_err("flat");
        assert!(e.to_string().contains("a, b"), "{e}");
        assert!(matches!(hull(&flat, &Options::new(f64::NAN), &control), Err(HullError::Tolerance(_))));
    }
}
