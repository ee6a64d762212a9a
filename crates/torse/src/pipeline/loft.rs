//! `loft`: the developable between two rails.
//!
//! Reads like the page that describes it: find all branches of common tangent planes, follow the best one, fit it,
//! have rails and twist judged, develop; where there is no branch, take the strip of least twist and say so.

use super::cut::cut;
use super::outcome::Status;
use super::sheets::{Basis, FieldMeaning, Figure, FlatPart, Guide, Sheets, StripField};
use crate::certify::rails::rail_bound;
use crate::control::Control;
use crate::design::loft::branches::{branches, Branch, BranchOptions, BranchType, Direction};
use crate::design::loft::build::{along, follow, BuildOptions, BuiltStrip};
use crate::design::loft::least_twist::{least_twist, LeastTwistOptions};
use crate::design::loft::track::Track;
use crate::design::loft::{apart, LoftError};
use crate::develop::strip::StripOptions;
use crate::geom::Vec3;
use crate::surface::rail::Rail;
use crate::surface::strip::Strip;
use std::time::Instant;

/// What becomes of rails that the developable does not use from end to end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// They are trimmed: the strip ends where one rail ends.
    #[default]
    Trim,
    /// The rest of a rail is joined to the other's end by a cone.
    Fan,
    /// Rails are extended along their end tangents until both are used from end to end.
    Extend,
}

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
    /// See [`Ends`]; default trim.
    pub ends: Ends,
    /// See [`Choice`]; default auto.
    pub choice: Choice,
    /// Which of the branches found, best first, from 1; default 1.
    pub alternative: usize,
    /// Rulings to be used, as shares of both rails' lengths; default none. With any, the strip of least twist is made.
    pub fixed: Vec<[f64; 2]>,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the rails, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "loft".into(),
            ends: Ends::Trim,
            choice: Choice::Auto,
            alternative: 1,
            fixed: Vec::new(),
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: 1e-5,
        }
    }
}

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;
/// Least share of both rails that an exact branch must use to be chosen without being asked for.
const ENOUGH: f64 = 0.5;
/// Share of a rail that may be left over without a word.
const WHOLE: f64 = 1e-6;
/// Extension of rails beyond each end, as a share of their length.
const EXTENSION: f64 = 0.5;
/// Stations per strip where twist and clearance are measured.
const STATIONS: usize = 64;

/// The developable between two rails, fitted, judged and developed.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the rails given, its
/// twist is proven (see [`Strip::twist_bound`]) to stay below `twist_tolerance`, no regression point lies on a strip
/// (measured), and every part has a pattern. Everything else is `Uncertified` with the reason.
///
/// # Errors
/// Rails that touch, no branch where one is demanded, fixed rulings out of order, a tolerance that is not positive.
pub fn loft(a: &Rail, b: &Rail, options: &Options, control: &Control) -> Result<Sheets, LoftError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(LoftError::Tolerance(tolerance));
    }
    apart(a, b)?;
    control.report("looking for branches", 0.1, "");
    let given = [a, b];
    let mut notes = Vec::new();
    let (a, b) = match options.ends {
        Ends::Extend => (extended(a), extended(b)),
        _ => (a.clone(), b.clone()),
    };
    let (b, found) = oriented(&a, b, options, &mut notes);
    let regular: Vec<&Branch> = found
        .iter()
        .filter(|f| {
            f.kind == BranchType::Regular && f.direction == Direction::Same && f.coverage[0].max(f.coverage[1]) > WHOLE
        })
        .collect();
    for (k, f) in regular.iter().enumerate().take(5) {
        notes.push(format!(
            "alternative {}: regular, uses {:.2} % of {} and {:.2} % of {}{}",
            k + 1,
            100.0 * f.coverage[0],
            a.name,
            100.0 * f.coverage[1],
            b.name,
            if f.closed { ", closed" } else { "" }
        ));
    }
    let doubles = found.iter().filter(|f| f.kind == BranchType::DoubleCone).count();
    if doubles > 0 {
        notes.push(format!("{doubles} branches have their regression points between the rails and are not used"));
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
                None if options.alternative > 1 => {
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
    let mut build = BuildOptions::new(RAIL_SHARE * tolerance);
    build.twist_tolerance = TWIST_SHARE * options.twist_tolerance;
    let (strips, closed) = match chosen {
        Some(branch) => {
            let whole = with_ends(&a, &b, branch, options.ends);
            note_ends(&a, &b, &whole, options.ends, &mut notes);
            (follow(&a, &b, &whole, &build)?, whole.closed)
        }
        None => {
            notes.push("no branch of common tangent planes was used: this is the strip of least twist, and it is not developable unless its twist says so".into());
            let path = least_twist(
                &a,
                &b,
                &LeastTwistOptions { fixed: options.fixed.clone(), ..LeastTwistOptions::default() },
            )?;
            build.exact = false;
            (along(&a, &b, &path.stations, path.closed, &build)?, path.closed)
        }
    };
    control.report("judging", 0.7, "");
    let rails = [&a, &b];
    Ok(judged(&rails, &given, strips, closed, options, notes, start))
}

/// Turns the second rail round where the best branch runs against it.
fn oriented(a: &Rail, b: Rail, options: &Options, notes: &mut Vec<String>) -> (Rail, Vec<Branch>) {
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
    notes.push(format!("{} is run through backwards", b.name));
    let found = branches(a, &turned, &BranchOptions::default());
    (turned, found)
}

/// The rail with straight pieces beyond both ends; closed rails stay as they are.
fn extended(rail: &Rail) -> Rail {
    if rail.closed {
        return rail.clone();
    }
    let track = Track::new(rail);
    let (first, last) = (track.at(0.0), track.at(track.end()));
    let l = EXTENSION * rail.length();
    let line = |p: Vec3, q: Vec3| {
        let knots = rail.pieces[0].knots.clone();
        let n = knots.control_count();
        // The same degree and knots as any other piece: Greville points of a line.
        let degree = knots.degree();
        let control = (0..n)
            .map(|i| {
                let t = knots.values()[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
                let x = p + (q - p) * t;
                [x.x, x.y, x.z, 1.0]
            })
            .collect();
        crate::spline::curve::Curve { knots, control }
    };
    let mut pieces = vec![line(first.point - first.tangent * l, first.point)];
    pieces.extend(rail.pieces.iter().cloned());
    pieces.push(line(last.point, last.point + last.tangent * l));
    Rail { name: rail.name.clone(), pieces, closed: false }
}

/// The run with what `ends` asks for.
fn with_ends(a: &Rail, b: &Rail, branch: &Branch, ends: Ends) -> Branch {
    let mut out = branch.clone();
    let (ta, tb) = (Track::new(a).end(), Track::new(b).end());
    match ends {
        Ends::Fan if !branch.closed => {
            // One rail rests at its end while the other is used up.
            let (first, last) = (out.stations[0], out.stations[out.stations.len() - 1]);
            for start in corner_stations(first[0], 0.0, false).into_iter().filter(|_| !a.closed) {
                out.stations.insert(0, [start, out.stations[0][1]]);
            }
            for start in corner_stations(first[1], 0.0, false).into_iter().filter(|_| !b.closed) {
                out.stations.insert(0, [out.stations[0][0], start]);
            }
            for end in corner_stations(last[0], ta, true).into_iter().filter(|_| !a.closed) {
                out.stations.push([end, out.stations[out.stations.len() - 1][1]]);
            }
            for end in corner_stations(last[1], tb, true).into_iter().filter(|_| !b.closed) {
                out.stations.push([out.stations[out.stations.len() - 1][0], end]);
            }
        }
        Ends::Extend if !branch.closed => {
            // From where either rail proper begins to where the last of them ends. Extensions are the first and last
            // segments.
            let begun = |s: &[f64; 2]| (!a.closed && s[0] >= 1.0) || (!b.closed && s[1] >= 1.0);
            let over = |s: &[f64; 2]| (a.closed || s[0] >= ta - 1.0) && (b.closed || s[1] >= tb - 1.0);
            let n = out.stations.len();
            let first = out.stations.iter().position(begun).unwrap_or(0);
            let last = out.stations.iter().position(over).unwrap_or(n - 1);
            if first < last {
                out.stations = out.stations[first..=last].to_vec();
            }
        }
        _ => {}
    }
    out
}

/// Stations from `from` to `to`, ends of segments included, `from` not.
fn corner_stations(from: f64, to: f64, upwards: bool) -> Vec<f64> {
    const REST: f64 = 1e-9;
    let mut out = Vec::new();
    let mut x = from;
    while if upwards { x < to - REST } else { x > to + REST } {
        x = if upwards { ((x + REST).floor() + 1.0).min(to) } else { ((x - REST).ceil() - 1.0).max(to) };
        out.push(x);
    }
    out
}

/// Says what is left over or added at the ends.
fn note_ends(a: &Rail, b: &Rail, branch: &Branch, ends: Ends, notes: &mut Vec<String>) {
    if branch.closed {
        return;
    }
    let (first, last) = (branch.stations[0], branch.stations[branch.stations.len() - 1]);
    for (d, rail) in [(0, a), (1, b)] {
        if rail.closed {
            continue;
        }
        let track = Track::new(rail);
        let at = |x: f64| rail.length_to(track.rail_parameter(x));
        let total = rail.length();
        let (from, to) = (at(first[d]), at(last[d]));
        if ends == Ends::Extend {
            let extra = total * EXTENSION / (1.0 + 2.0 * EXTENSION);
            let (before, behind) = (extra - from, to - (total - extra));
            if before > WHOLE * total || behind > WHOLE * total {
                notes.push(format!(
                    "{} is extended by {:.3} mm at its start and {:.3} mm at its end",
                    rail.name,
                    before.max(0.0),
                    behind.max(0.0)
                ));
            }
        } else if from > WHOLE * total || total - to > WHOLE * total {
            notes.push(format!(
                "{} is used from {from:.3} mm to {to:.3} mm of its length of {total:.3} mm; extend the other rail, or ask for fans or extension at the ends",
                rail.name
            ));
        }
    }
}

/// Judges and develops strips.
fn judged(
    rails: &[&Rail; 2],
    given: &[&Rail; 2],
    built: Vec<BuiltStrip>,
    closed: bool,
    options: &Options,
    mut notes: Vec<String>,
    start: Instant,
) -> Sheets {
    let mut missing: Vec<String> = Vec::new();
    let (mut strip_figures, mut fields) = (Vec::new(), Vec::new());
    let mut worst = [0.0_f64; 2];
    let (mut worst_twist, mut sampled_twist, mut least) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for s in &built {
        let off: Vec<f64> = (0..2)
            .map(|side| rail_bound(&s.strip, side, rails[side], &s.rails[side]).unwrap_or(f64::INFINITY))
            .collect();
        for (w, o) in worst.iter_mut().zip(&off) {
            *w = w.max(*o);
        }
        let (u0, u1) = s.strip.domain();
        let at: Vec<f64> = (0..=STATIONS).map(|k| u0 + (u1 - u0) * k as f64 / STATIONS as f64).collect();
        let twists: Vec<f64> = at.iter().map(|&u| s.strip.twist(u)).collect();
        let twist = twists.iter().copied().fold(0.0, f64::max);
        let fan = s.strip.is_point(0) || s.strip.is_point(1);
        let clearance = if fan {
            f64::INFINITY
        } else {
            at.iter().map(|&u| s.strip.regression_clearance(u)).fold(f64::INFINITY, f64::min)
        };
        let bound = s.strip.twist_bound().unwrap_or(f64::INFINITY);
        worst_twist = worst_twist.max(bound);
        sampled_twist = sampled_twist.max(twist);
        least = least.min(clearance);
        if clearance <= 0.0 {
            missing.push(format!("strip {} has regression points between its rails", s.strip.name));
        }
        strip_figures.push(vec![
            Figure::new(format!("from {}", rails[0].name), off[0], "mm", Basis::Proven),
            Figure::new(format!("from {}", rails[1].name), off[1], "mm", Basis::Proven),
            Figure::new("sine of twist, bound", bound, "", Basis::Proven),
            Figure::new("twist", twist.to_degrees(), "°", Basis::Measured),
            Figure::new("regression clearance", clearance, "mm", Basis::Measured),
            Figure::new("area", s.strip.area_estimate() * 1e-6, "m²", Basis::Measured),
        ]);
        let values = twists.iter().flat_map(|t| [t.to_degrees(); 2]).collect();
        fields.push(StripField { u: at, v: vec![0.0, 1.0], values });
    }
    for (side, w) in worst.iter().enumerate() {
        if *w > options.tolerance {
            missing.push(format!("the strips stray up to {w:.4} mm from {}", rails[side].name));
        }
    }
    if worst_twist > options.twist_tolerance {
        missing.push(format!(
            "twist up to {:.3e}° (measured), proven bound {:.3e}, where {:.3e} rad count as developable",
            sampled_twist.to_degrees(),
            worst_twist,
            options.twist_tolerance
        ));
    }
    let strips: Vec<Strip> = built.into_iter().map(|s| s.strip).collect();
    if strips.is_empty() {
        missing.push("no strip could be made".into());
    }
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        ..StripOptions::new(CONTOUR_SHARE * options.tolerance)
    };
    let whole = FlatPart { name: "A".into(), first: 0, count: strips.len(), missing: String::new() };
    let (parts, patterns) = cut(&strips, &[whole], &flat);
    missing.extend(parts.iter().filter(|p| !p.missing.is_empty()).map(|p| format!("part {}: {}", p.name, p.missing)));
    if closed {
        notes.push("the strip is closed; its flat part is cut open along the first ruling".into());
    }
    let isometry = patterns.iter().map(|p| p.isometry_error).fold(0.0, f64::max);
    let figures = vec![
        Figure::new(format!("from {}", rails[0].name), worst[0], "mm", Basis::Proven),
        Figure::new(format!("from {}", rails[1].name), worst[1], "mm", Basis::Proven),
        Figure::new("sine of twist, bound", worst_twist, "", Basis::Proven),
        Figure::new("twist", sampled_twist.to_degrees(), "°", Basis::Measured),
        Figure::new("regression clearance", least, "mm", Basis::Measured),
        Figure::new("strips", strips.len() as f64, "", Basis::Given),
        Figure::new("flat area", patterns.iter().map(|p| p.area * 1e-6).sum(), "m²", Basis::Measured),
        Figure::new("length error of patterns", isometry, "", Basis::Measured),
    ];
    let guides = given.iter().map(|r| Guide { name: r.name.clone(), points: r.samples(200) }).collect();
    let limit = fields
        .iter()
        .flat_map(|f| &f.values)
        .fold(0.0, |m: f64, x| m.max(*x))
        .max(options.twist_tolerance.to_degrees());
    Sheets {
        job: "loft".into(),
        input: options.input.clone(),
        tolerance: options.tolerance,
        status: match missing.first() {
            None => Status::Certified,
            Some(_) => Status::Uncertified(missing.join("; ")),
        },
        strips,
        strip_figures,
        fields,
        meaning: FieldMeaning { name: "twist".into(), unit: "°".into(), limit },
        parts,
        patterns,
        guides,
        figures,
        notes,
        skipped: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
    }
}
