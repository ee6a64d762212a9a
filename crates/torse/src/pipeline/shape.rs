//! `shape`: strips of splines between curves, pulled by handles, as developable panels.
//!
//! Reads like the page that describes it: set up the composite, settle it, move handles, polish, have it judged, develop.

use crate::answer::note::Note;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::constraint::reference::{FaceReference, PointReference, Reference};
use crate::design::composite::{
    At, BoundaryCurve, Composite, CompositeError, Edge, Handle, Hold, Join, Length, Options as SessionOptions, Place,
    RuledStrip, Session, Smoothness, Strength, StripShape, Target,
};
use crate::design::loft::build::{classified, BuiltStrip};
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::geom::cloud::Cloud;
use crate::geom::coarse::Loose;
use crate::geom::{BBox, Vec3};
use crate::io::shape::{EdgeKind, HandleRecord, JoinRecord, PlaneRecord, ShapeFile, Smooth, TargetRecord};
use crate::io::{cloud, step};
use crate::num::gauss_newton::Status;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::{claims as flat_claims, crowded, cut, judged as flat_judged};
use crate::search::strips::judgement::{judge, Candidate};
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::rail::{Rail, RailPart};
use crate::torse::strip::{homogeneous, Strip};
use crate::Control;
use std::sync::Arc;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between held places and their targets, and between fixed curves and strips, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the rails, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "shape".into(),
            twist_tolerance: 1e-5,
            ruling_spacing: None,
            mark_spacing: None,
            drawn: Drawn::default(),
        }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A tolerance that is none.
    #[error("the tolerance {0} is not a positive finite length")]
    Tolerance(f64),
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A composite that cannot be set up.
    #[error("{}{source}", .source.at().map(At::path).map_or(String::new(), |p| p + ": "))]
    Composite {
        /// Why.
        source: CompositeError,
    },
    /// A target that cannot be read.
    #[error("$.targets[{index}]: {reason}")]
    Target {
        /// Its index.
        index: usize,
        /// Why.
        reason: String,
    },
    /// A move that cannot be made.
    #[error("$.moves[{index}]: {source}")]
    Move {
        /// Its index.
        index: usize,
        /// Why.
        source: CompositeError,
    },
    /// A strip without a spline.
    #[error("a strip could not be made: {0}")]
    Spline(#[from] SplineError),
}

impl From<CompositeError> for ShapeError {
    fn from(source: CompositeError) -> Self {
        Self::Composite { source }
    }
}

/// Residual of the polish, as a share of the size: some digits beyond what twist is asked for.
const POLISHED: f64 = 1e-11;
/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Points of a guide.
const GUIDE_POINTS: usize = 200;

/// Strips between curves that keep what is held, judged and developed.
///
/// `load` answers the contents of files that targets name.
///
/// *Guarantee.* `Certified` only if the twist of every strip is proven to stay below `twist_tolerance`, no ruling meets the
/// regression curve within a strip (proven), every held place is within the tolerance of its target (measured), fixed
/// curves are proven to be kept within it, and every part has a pattern. Everything else is `Uncertified` with the reason.
///
/// # Errors
/// Anything in the job that does not make sense, with its place: `$.handles[2].curve`.
///
/// # Example
/// ```
/// let job = torse::io::shape::read(include_bytes!("../../../../data/pulled_hull.json"), "hull", None)?;
/// let nothing = |name: &str| Err(format!("no file {name}"));
/// let answer = torse::shape(&job, &torse::Shape::new(0.5), &nothing, &torse::Control::default())?;
/// assert_eq!(answer.patchwork.panels.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn shape(
    job: &ShapeFile,
    options: &Options,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    control: &Control,
) -> Result<Answer, ShapeError> {
    let start = Instant::now();
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(ShapeError::Tolerance(options.tolerance));
    }
    let points: Vec<Vec3> = job.curves.iter().flat_map(|c| c.1.control.iter().map(|p| Vec3::from(*p))).collect();
    Loose::check(BBox::of(&points).diagonal(), options.tolerance)?;
    let composite = composite(job, load)?;
    let mut notes = Vec::new();
    let mut session = Session::new(composite, SessionOptions::default())?;
    control.report("settling", 0.1, "");
    let settled = session.settle(control);
    notes.push(Note::Solved { step: None, report: settled });
    for (index, m) in job.moves.iter().enumerate() {
        let source = |source| ShapeError::Move { index, source };
        let from = session.composite().handles.get(m.handle).map(|h| h.hold);
        let to = held(m.point, m.tangent, m.plane);
        let (Some(from), Some(to)) = (from, to) else { continue };
        let mut told = false;
        for k in 1..=m.steps {
            if control.stopped() {
                break;
            }
            session.set_handle(m.handle, between(&from, &to, k as f64 / m.steps as f64)).map_err(source)?;
            let report = session.step(control);
            if report.status != Status::Converged && !std::mem::replace(&mut told, true) {
                notes.push(Note::Solved { step: Some((index, k)), report });
            }
        }
        control.report("moving", 0.1 + 0.5 * (index + 1) as f64 / job.moves.len() as f64, "");
    }
    control.report("polishing", 0.6, "");
    let polished = session.polish(POLISHED, control)?;
    notes.push(Note::Met { residual: polished.residual });
    control.report("judging", 0.7, "");
    judged(&session, options, notes, start)
}

/// The composite that a file describes.
fn composite(job: &ShapeFile, load: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> Result<Composite, ShapeError> {
    let place = |p: &crate::io::shape::PlaceRecord| Place { curve: p.curve.clone(), u: p.u };
    let strip = |s: &crate::io::shape::StripRecord| RuledStrip {
        name: s.name.clone(),
        sides: s.sides.clone(),
        shape: if s.planar { StripShape::Planar } else { StripShape::Developable { margin: s.margin } },
    };
    let curve = |(name, curve, fixed): &(String, Curve<3>, bool)| BoundaryCurve {
        name: name.clone(),
        curve: curve.clone(),
        fixed: *fixed,
    };
    let target = |(index, t): (usize, &TargetRecord)| {
        let reference = reference(t, load).map_err(|reason| ShapeError::Target { index, reason })?;
        Ok(Target { strips: t.strips.clone(), reference, weight: t.weight })
    };
    Ok(Composite {
        curves: job.curves.iter().map(curve).collect(),
        strips: job.strips.iter().map(strip).collect(),
        joins: job.joins.iter().filter_map(join).collect(),
        handles: job.handles.iter().filter_map(handle).collect(),
        lengths: job
            .lengths
            .iter()
            .map(|l| Length { between: [place(&l.between[0]), place(&l.between[1])], length: l.length })
            .collect(),
        targets: job.targets.iter().enumerate().map(target).collect::<Result<_, ShapeError>>()?,
    })
}

fn join(j: &JoinRecord) -> Option<Join> {
    match (&j.ruling, &j.curve, j.edge) {
        (Some([first, second]), ..) => {
            let smoothness = match j.smoothness {
                Some(Smooth::G0) => Smoothness::G0,
                Some(Smooth::G2) => Smoothness::G2,
                Some(Smooth::G1) | None => Smoothness::G1,
            };
            Some(Join::Ruling { first: first.clone(), second: second.clone(), smoothness })
        }
        (None, Some(curve), Some(edge)) => {
            let edge = if edge == EdgeKind::Fold { Edge::Fold } else { Edge::Smooth };
            Some(Join::Curve { curve: curve.clone(), edge })
        }
        _ => None,
    }
}

fn handle(h: &HandleRecord) -> Option<Handle> {
    Some(Handle {
        place: Place { curve: h.curve.clone(), u: h.u },
        hold: held(h.point, h.tangent, h.plane)?,
        strength: h.pull.map_or(Strength::Exact, Strength::Pull),
    })
}

fn held(point: Option<[f64; 3]>, tangent: Option<[f64; 3]>, plane: Option<PlaneRecord>) -> Option<Hold> {
    let plane = plane.map(|p| Hold::Plane { point: p.point.into(), normal: p.normal.into() });
    point.map(|p| Hold::Point(p.into())).or(tangent.map(|t| Hold::Tangent(t.into()))).or(plane)
}

/// A hold on the way from one to another of its kind; of two kinds, the other.
fn between(from: &Hold, to: &Hold, share: f64) -> Hold {
    let mix = |a: &Vec3, b: &Vec3| a + (b - a) * share;
    let turn = |a: &Vec3, b: &Vec3| a.normalize() + (b.normalize() - a.normalize()) * share;
    match (from, to) {
        (Hold::Point(a), Hold::Point(b)) => Hold::Point(mix(a, b)),
        (Hold::Tangent(a), Hold::Tangent(b)) => Hold::Tangent(turn(a, b)),
        (Hold::Plane { point: a, normal: n }, Hold::Plane { point: b, normal: m }) => {
            Hold::Plane { point: mix(a, b), normal: turn(n, m) }
        }
        _ => *to,
    }
}

/// The surface that a target names.
fn reference(t: &TargetRecord, load: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> Result<Arc<dyn Reference>, String> {
    let points = |cloud: Cloud| -> Result<Arc<dyn Reference>, String> {
        match PointReference::new(cloud) {
            Some(p) => Ok(Arc::new(p)),
            None => Err("it has no points, or triangles between points that are not there".into()),
        }
    };
    let Some(file) = &t.file else {
        let places = t.points.iter().map(|p| Vec3::from(*p)).collect();
        return points(Cloud { points: places, triangles: t.triangles.clone() });
    };
    let bytes = load(file)?;
    let lower = file.to_ascii_lowercase();
    if lower.ends_with(".step") || lower.ends_with(".stp") {
        let model = step::read::read(&bytes).map_err(|e| e.to_string())?;
        if model.faces.is_empty() {
            return Err(format!("{file} holds no face that can be read"));
        }
        return Ok(Arc::new(FaceReference::new(model.faces.into_iter().map(|f| f.surface).collect())));
    }
    points(cloud::read(file, &bytes, None).map_err(|e| e.to_string())?)
}

/// Distance of every held place from what it is held to, with the handle's words.
fn off(session: &Session) -> Vec<(String, f64)> {
    let mut out = Vec::new();
    for (k, h) in session.composite().handles.iter().enumerate() {
        let Some(curve) = session.composite().curve(&h.place.curve).and_then(|c| session.curve(c)) else { continue };
        let [p, d, _] = curve.jet(h.place.u).map(Vec3::from);
        let what = format!("handle {k} on {}", h.place.curve);
        match h.hold {
            Hold::Point(target) => out.push((what, (p - target).norm())),
            Hold::Plane { point, normal } => out.push((what, normal.normalize().dot(&(p - point)).abs())),
            // Over the length of the control polygon's side there, a direction is off by so much.
            Hold::Tangent(t) => out.push((what, d.cross(&t.normalize()).norm() / curve.knots.degree() as f64)),
        }
    }
    out
}

/// A strip as the judge takes it, with the fixed curves that it must keep.
struct Made {
    built: BuiltStrip,
    rails: [Option<Rail>; 2],
}

fn made(session: &Session, strip: Strip, index: usize) -> Result<Made, SplineError> {
    let composite = session.composite();
    let linear = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0], [1.0]])?;
    let part = RailPart { piece: 0, parameter: linear };
    let rails = composite.strips[index].sides.each_ref().map(|name| {
        let given = &composite.curves[composite.curve(name)?];
        let rail = given.fixed.then(|| Rail::new(name, &[homogeneous(&given.curve)]).ok()).flatten()?;
        // A fixed curve with corners is no single piece; its control points are kept all the same.
        (rail.pieces.len() == 1).then_some(rail)
    });
    Ok(Made { built: BuiltStrip { strip: classified(strip), rails: [part.clone(), part] }, rails })
}

/// Chains of strips that go on smoothly, as parts that are cut from one sheet.
fn chains(composite: &Composite) -> Vec<Part> {
    let mut out: Vec<Part> = Vec::new();
    for (k, s) in composite.strips.iter().enumerate() {
        let goes_on = k > 0
            && composite.joins.iter().any(|j| {
                matches!(j, Join::Ruling { first, second, smoothness }
                    if *smoothness != Smoothness::G0 && *first == composite.strips[k - 1].name && *second == s.name)
            });
        match out.last_mut() {
            Some(last) if goes_on => last.count += 1,
            _ => out.push(Part { name: s.name.clone(), first: k, count: 1, missing: String::new() }),
        }
    }
    out
}

/// Judges and develops strips.
fn judged(session: &Session, options: &Options, mut notes: Vec<Note>, start: Instant) -> Result<Answer, ShapeError> {
    let strips = session.strips()?;
    let all = strips.into_iter().enumerate().map(|(k, s)| made(session, s, k)).collect::<Result<Vec<_>, _>>()?;
    let pieces: Vec<Candidate> = all
        .iter()
        .enumerate()
        .map(|(index, m)| Candidate { index, built: &m.built, rails: m.rails.each_ref().map(Option::as_ref) })
        .collect();
    let judgement = judge(&pieces, [What::FromSide(0), What::FromSide(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    let mut claims = Vec::new();
    for side in 0..2 {
        if all.iter().any(|m| m.rails[side].is_some()) {
            let reason = format!("the strips stray up to {:.1e} mm from fixed curves", judgement.off[side].value());
            let kept = Claim::at_most(What::FromSide(side), whole, judgement.off[side]);
            claims.push(kept.within(options.tolerance).because(reason));
        }
    }
    let mut missing = judgement.missing.clone();
    for (what, off) in off(session).into_iter().filter(|h| h.1.is_nan() || h.1 > options.tolerance) {
        missing.push(format!("{what} is {off:.4} mm from where it should be; hold less, or move it in steps"));
    }
    let strips: Vec<Strip> = all.into_iter().map(|m| m.built.strip).collect();
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        drawn: options.drawn,
        ..StripOptions::new(CONTOUR_SHARE * options.tolerance)
    };
    let (parts, patterns) = cut(&strips, &chains(session.composite()), &flat);
    let flat_proof = flat_judged(&strips, &parts, &patterns, options.tolerance);
    notes.extend(crowded(&patterns, &flat).into_iter().map(Note::Crowded));
    claims.extend(judgement.whole().into_iter().filter(|c| !matches!(c.what(), What::Count(_))));
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    claims.extend(flat_claims(&parts, &patterns, &flat_proof, options.tolerance));
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(judgement.claims);
    let guides = session.composite().curves.iter().map(|c| {
        let (a, b) = c.curve.domain();
        let at = |k: usize| Vec3::from(c.curve.point(a + (b - a) * k as f64 / GUIDE_POINTS as f64));
        Guide { name: format!("{} as given", c.name), points: (0..=GUIDE_POINTS).map(at).collect() }
    });
    Ok(Answer {
        claims,
        guides: guides.collect(),
        patchwork: Patchwork::of_strips(strips),
        fields: judgement.fields,
        meaning: judgement.meaning,
        parts,
        patterns,
        flat: flat_proof,
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Shape, &options.input, options.tolerance)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::note::SolveReport;
    use crate::io::shape::read;
    use crate::Status as Certified;

    const JOB: &str = r#"{ "unit": "mm",
        "curves": [
            { "name": "low", "through": [[0, 0, 0], [300, -40, 60], [600, 0, 20], [1000, 40, 0]], "spans": 5 },
            { "name": "high", "through": [[50, 400, 120], [350, 420, 160], [600, 430, 150], [900, 400, 100]], "spans": 5 } ],
        "strips": [ { "name": "A-01", "sides": ["low", "high"] } ],
        "handles": [
            { "curve": "low", "u": 0, "point": [0, 0, 0] }, { "curve": "low", "u": 1, "point": [1000, 40, 0] },
            { "curve": "high", "u": 0, "point": [50, 400, 120] }, { "curve": "high", "u": 1, "point": [900, 400, 100] },
            { "curve": "low", "u": 0.5, "point": [470, -20, 60] } ],
        "moves": [ { "handle": 4, "point": [470, -40, 120], "steps": 4 } ] }"#;

    fn run(text: &str) -> Result<Answer, ShapeError> {
        let job = read(text.as_bytes(), "job", None).expect("a job");
        shape(&job, &Options::new(0.05), &|name| Err(format!("{name} is not there")), &Control::default())
    }

    #[test]
    fn a_job_is_certified_and_has_its_files() {
        let mut answer = run(JOB).expect("an answer");
        let reasons: Vec<_> = answer.claims.iter().filter(|c| c.is_broken()).map(|c| c.reason().to_string()).collect();
        assert_eq!(answer.status(), Certified::Certified, "{reasons:?} {:?}", answer.notes);
        let p = answer.patchwork.panels[0].strip.ruling(0.5)[0];
        assert!((p - Vec3::new(470.0, -40.0, 120.0)).norm() < 1e-3, "{p}");
        let files = crate::files(&mut answer, "2026-01-31T12:00:00").expect("files");
        assert!(files.iter().any(|(name, bytes)| name == "panels.step" && bytes.len() > 1000));
        assert_eq!(answer.status(), Certified::Certified);
    }

    #[test]
    fn what_is_wrong_is_named_by_its_path() {
        let told = |from: &str, to: &str| run(&JOB.replace(from, to)).expect_err(to).to_string();
        let m = told("\"curve\": \"low\", \"u\": 0.5", "\"curve\": \"middle\", \"u\": 0.5");
        assert!(m.starts_with("$.handles[4].curve: handle 4 ") && m.contains("'middle'"), "{m}");
        assert!(told("\"u\": 0.5", "\"u\": 5").starts_with("$.handles[4].u: "));
        assert!(told("[\"low\", \"high\"]", "[\"low\", \"low\"]").starts_with("$.strips[0].sides: "));
        let m = told("\"moves\"", "\"targets\": [ { \"file\": \"scan.ply\" } ], \"moves\"");
        assert_eq!(m, "$.targets[0]: scan.ply is not there");
        let m = told("\"handle\": 4, \"point\"", "\"handle\": 4, \"tangent\"");
        assert_eq!(m, "$.moves[0]: there is no handle 4 that holds a tangent");
    }

    #[test]
    fn what_cannot_be_held_is_not_certified() {
        // Four corners that are in no plane.
        let answer =
            run(&JOB.replace("[\"low\", \"high\"]", "[\"low\", \"high\"], \"planar\": true")).expect("an answer");
        assert_eq!(answer.status(), Certified::Uncertified);
        let stalled = |n: &&Note| match n {
            Note::Solved {
                report: SolveReport { status: Status::Stalled, obstacle: Some((class, _)), .. }, ..
            } => class == "point handles",
            _ => false,
        };
        let told = answer.notes.iter().filter(stalled).count();
        assert_eq!(told, 2, "the first shape and the move, each once: {:?}", answer.notes);
    }
}
