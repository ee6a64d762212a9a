//! From measured points to developable strips: estimate, segment, fit, prove, develop.

use crate::answer::note::{FitNote, Note, Outlines};
use crate::answer::skipped::Skipped;
use crate::answer::{Answer, Job, PointMap};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::certify::flat::FlatCertificate;
use crate::certify::points::{points as certified, PointCertificate};
use crate::control::Control;
use crate::develop::map::Development;
use crate::develop::scanned::{cut_back, outline};
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::fit::cloud::core;
use crate::fit::cloud::estimates::{estimates, Estimates};
use crate::fit::cloud::extent::{assigned, polished, strip, widened};
use crate::fit::cloud::facets::{facet_points, FacetPoint};
use crate::fit::cloud::pieces::{is_wide, pieces, PieceOptions};
use crate::fit::cloud::regions::{regions, Region};
use crate::fit::cloud::CloudError;
use crate::fit::near::samples::Fit;
use crate::geom::cloud::Cloud;
use crate::geom::coarse::{Coarse, Loose};
use crate::geom::{Vec2, Vec3};
use crate::io::words::note::beyond_limits;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::search::strips::cut::{cut, judged, lengths, refused};
use crate::search::strips::judgement::SQUARE_METRES;
use crate::search::strips::regression;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;
use std::borrow::Cow;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// Largest distance of a measured point from the strips, mm.
    pub tolerance: f64,
    /// Name of the input, for files.
    pub input: String,
    /// Places at which the surface is estimated; 3000.
    pub places: usize,
    /// Strips at most; 64.
    pub max_strips: usize,
    /// What is asked of regression curves; nothing beyond regular strips.
    pub limits: Option<RegressionLimits>,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl FitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64, input: &str) -> Self {
        Self { tolerance, input: input.into(), places: 3000, max_strips: 64, limits: None, drawn: Drawn::default() }
    }
}

/// Points of regions smaller than this share of the cloud are left to the other strips, if these are near.
const CRUMB: f64 = 0.01;

/// Fits developable strips to measured points.
///
/// *Input*: finite points in mm, at least 30, not in a line; no order, no normals needed. Of a coarse mesh (see
/// [`crate::fit::cloud::facets`]) points between its corners guide the fit; judged are the corners, and a part of the
/// mesh without strip is an objection.
/// *Result*: certified if every point is proven to lie within the tolerance; otherwise the points that are not are
/// counted and the worst is named. Strips cover what was measured and are not joined to each other.
///
/// # Errors
/// See [`CloudError`].
///
/// # Example
/// ```
/// use torse::geom::{cloud::Cloud, Vec3};
/// let point = |k: i32| Vec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
/// let scan = Cloud { points: (0..400).map(point).collect(), ..Cloud::default() };
/// let answer = torse::fit(&scan, &torse::FitOptions::new(0.1, "sheet"), &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(cloud: &Cloud, options: &FitOptions, control: &Control) -> Result<Answer, CloudError> {
    let clock = std::time::Instant::now();
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(CloudError::Tolerance(options.tolerance));
    }
    if let Some(fault) = options.limits.as_ref().and_then(regression::fault) {
        return Err(CloudError::Limits(fault));
    }
    // A few points that lie far away do not count.
    let extent = core(&cloud.points);
    if let Some(fault) = Coarse::of(extent.min.amax().max(extent.max.amax()), options.tolerance) {
        return Err(fault.into());
    }
    Loose::check(extent.diagonal(), options.tolerance)?;
    // 1. What the surface is like, in coordinates that are small where the file's are not.
    control.report("estimating", 0.0, format!("{} points", cloud.points.len()));
    let shift = far_off(&cloud.points);
    let inside = facet_points(cloud, GUIDES);
    let moved = guided(&cloud.points, &inside, shift);
    let found = estimates(&moved, options.places)?;
    // 2. Pieces that one torse follows.
    control.report("fitting", 0.2, String::new());
    let mut notes = Vec::new();
    let slack = GUIDE_SLACK * bulge(&inside);
    let placed = Placed { points: moved.len(), shift, slack };
    let regions = regions_of(&found, options.tolerance, slack);
    // 3. Strips under the points of each piece, 4. with their proof.
    let given = Given { points: &moved, judged: cloud.points.len() };
    let attempt = |narrow: bool| {
        let mut skipped = Vec::new();
        let fits = torses(&found, &regions, placed, Asked { options, narrow }, control, &mut skipped);
        control.report("trimming", 0.6, format!("{} pieces", fits.len()));
        let strips = strips(&found, &given, fits, options, &mut skipped);
        let strips: Vec<Strip> = match shift {
            Some(c) => strips.into_iter().map(|s| s.moved(&c)).collect(),
            None => strips,
        };
        let certificate = certified(&strips, &cloud.points, control);
        (certificate, strips, skipped)
    };
    // Between the corners of coarse meshes nothing holds torses that turn far.
    let mut done = attempt(!inside.is_empty());
    // Where they do not reach all points, less turned ones may.
    let wide = regions.iter().any(|r| is_wide(r.normals.iter().copied()));
    let beyond = done.0.beyond(options.tolerance);
    if inside.is_empty() && wide && beyond > 0 && !control.stopped() {
        let again = attempt(true);
        if again.0.beyond(options.tolerance) < beyond {
            done = again;
        }
    }
    let (certificate, strips, skipped) = done;
    drop(moved);
    // 5. Flat parts.
    control.report("developing", 0.9, String::new());
    let chains: Vec<Part> = (strips.iter().enumerate())
        .map(|(i, s)| Part { name: s.name.clone(), first: i, count: 1, missing: String::new() })
        .collect();
    let flat = StripOptions { drawn: options.drawn, ..StripOptions::new(0.1 * options.tolerance) };
    let (parts, mut patterns) = cut(&strips, &chains, &flat);
    let mut flat_proof = judged(&strips, &parts, &patterns, options.tolerance);
    let stretched = refused(&parts, &patterns, &flat_proof, options.tolerance);
    if inside.is_empty() && !control.stopped() {
        let near = NEAR * options.tolerance;
        let outlined = outlined(&strips, &parts, &mut patterns, (&certificate, near), flat.side);
        notes.push(Note::Fit(outlined));
        // Nothing is proven of outlines that follow points.
        let cut_back = |f: FlatCertificate| {
            let own = patterns.iter().any(|p| p.panel == f.panel() && p.contour_error.is_nan());
            if own {
                f.without_outline()
            } else {
                f
            }
        };
        flat_proof = flat_proof.into_iter().map(cut_back).collect();
    } else {
        notes.push(Note::Fit(FitNote::WholePatterns));
    }
    let flat_area: f64 = patterns.iter().map(|p| p.area).sum::<f64>() * SQUARE_METRES;
    if strips.len() > 1 {
        notes.push(Note::Unjoined);
    }
    let lonely = found.of_point.iter().take(cloud.points.len()).filter(|e| e.is_none()).count();
    if lonely > 0 {
        notes.push(Note::Fit(FitNote::Lonely { count: lonely }));
    }
    let fields = fields(&strips, &certificate, options.tolerance);
    let whole = Subject::Whole;
    let worst = certificate.worst_bound();
    let mut claims = vec![
        Claim::count(Counted::Points, whole, cloud.points.len()),
        Claim::at_most(What::PointDistance, whole, worst).within(options.tolerance).because(too_far(
            &strips,
            &certificate,
            &cloud.points,
            options.tolerance,
            control,
        )),
        Claim::count(Counted::Beyond, whole, certificate.beyond(options.tolerance)),
    ];
    claims.push(Claim::measured(What::FlatArea, whole, flat_area));
    claims.extend(lengths(&patterns, &flat_proof));
    claims.extend(stretched.into_iter().map(|reason| Claim::objection(whole, reason)));
    if inside.is_empty() {
        claims.push(Claim::measured(What::Noise, whole, found.noise));
    } else {
        let (note, bare) = between(&strips, &inside, cloud, options.tolerance, control);
        notes.push(Note::Fit(note));
        claims.extend(bare.map(|reason| Claim::objection(whole, reason)));
    }
    let broken = regression::broken(&strips, options.limits.as_ref());
    notes.extend(options.limits.iter().cloned().map(Note::Limits));
    notes.extend(broken.iter().cloned().map(Note::Broken));
    if worst.value() <= options.tolerance {
        claims.extend(broken.iter().map(|b| Claim::objection(whole, beyond_limits(b))));
    }
    claims.extend(claims_of_strips(&strips, &certificate, options.tolerance));
    Ok(Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields,
        points: PointMap {
            places: cloud.points.clone(),
            values: certificate.signed_estimates().to_vec(),
            worst: certificate.worst(),
        },
        meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: options.tolerance },
        parts,
        patterns,
        flat: flat_proof,
        notes,
        skipped: skipped.into_iter().map(Skipped::from).collect(),
        seconds: clock.elapsed().as_secs_f64(),
        ..Answer::new(Job::Fit, &options.input, options.tolerance)
    })
}

/// Cuts flat patterns back to the border of the points within `near` (mm) of their strips, and says so.
fn outlined(
    strips: &[Strip],
    parts: &[Part],
    patterns: &mut [Pattern],
    (certificate, near): (&PointCertificate, f64),
    side: f64,
) -> FitNote {
    let mut whole: Vec<String> = Vec::new();
    let (mut off, mut spacing, mut closed, mut stray, mut holes) = (0.0_f64, 0.0_f64, 0, 0, 0);
    for pattern in patterns.iter_mut() {
        let Some(part) = parts.get(pattern.panel) else { continue };
        let development = strips.get(part.first).and_then(|s| Development::new(&s.patch, side).ok());
        // Patterns are seen from outside or from inside: mirrored where that is the other side.
        let found = development.and_then(|d| {
            let of = |((k, u, v), b): (&(u32, f32, f32), &f64)| {
                (*k as usize == part.first && *b <= near).then(|| d.map(f64::from(*u), f64::from(*v)))
            };
            let mut points: Vec<Vec2> = certificate.places().iter().zip(certificate.bounds()).filter_map(of).collect();
            let is_mirrored = mirrored(pattern, &d)?;
            points.iter_mut().filter(|_| is_mirrored).for_each(|p| p.x = -p.x);
            outline(&points)
        });
        let Some(found) = found else {
            whole.push(part.name.clone());
            continue;
        };
        *pattern = cut_back(pattern, &found);
        (off, spacing) = (off.max(found.distance_estimate), spacing.max(found.spacing));
        (closed, stray, holes) = (closed + found.closed, stray + found.stray, holes + found.loops.len() - 1);
    }
    let outlines =
        (whole.len() < patterns.len()).then_some(Outlines { off_estimate: off, spacing, holes, closed, stray });
    FitNote::Outlined { outlines, whole }
}

/// Whether a pattern is mirrored against the development that it was drawn from: told by the marks along both rails,
/// whose directions along the strip and across it are not parallel. `None` without such marks.
fn mirrored(pattern: &Pattern, development: &Development) -> Option<bool> {
    let rail = |letter: char| -> Vec<Vec2> {
        pattern.marks.iter().filter(|m| m.label.starts_with(letter)).map(|m| m.point).collect()
    };
    let (a, b) = (rail('A'), rail('B'));
    let middle = |l: &[Vec2]| l.iter().sum::<Vec2>() / l.len() as f64;
    let drawn = [a.last()? - a.first()?, middle(&b) - middle(&a)];
    if b.is_empty() || a.len() < 2 {
        return None;
    }
    let (u0, u1) = development.domain();
    let at = |v: f64| [0.25, 0.5, 0.75].map(|s| development.map(u0 + s * (u1 - u0), v));
    let (c, d) = (at(0.0), at(1.0));
    let made = [c[2] - c[0], middle(&d) - middle(&c)];
    let alike = |flip: f64| -> f64 {
        let pair = |(x, y): (&Vec2, &Vec2)| {
            let y = Vec2::new(flip * y.x, y.y);
            x.dot(&y) / (x.norm() * y.norm()).max(f64::MIN_POSITIVE)
        };
        drawn.iter().zip(&made).map(pair).sum()
    };
    Some(alike(-1.0) > alike(1.0))
}

/// Points between the corners of a coarse mesh, about so many.
const GUIDES: usize = 24_000;
/// Share of the bulge of facets by which their guiding points may miss the surface: the fourth order of the turn against
/// the second, for facets that turn by up to 35°.
const GUIDE_SLACK: f64 = 0.1;

/// Points and guiding points, in coordinates from `shift`.
fn guided<'a>(points: &'a [Vec3], inside: &[FacetPoint], shift: Option<Vec3>) -> Cow<'a, [Vec3]> {
    if shift.is_none() && inside.is_empty() {
        return Cow::Borrowed(points);
    }
    let c = shift.unwrap_or_default();
    points.iter().chain(inside.iter().map(|p| &p.lifted)).map(|p| p - c).collect()
}

/// Largest distance of the surface from the facets, as expected from their corners, mm.
fn bulge(inside: &[FacetPoint]) -> f64 {
    inside.iter().map(|p| (p.lifted - p.flat).norm()).fold(0.0, f64::max)
}

/// What is said of a coarse mesh between its corners, and why the strips are no good there if they are not. All of it is
/// sampled.
fn between(
    strips: &[Strip],
    inside: &[FacetPoint],
    cloud: &Cloud,
    tolerance: f64,
    control: &Control,
) -> (FitNote, Option<String>) {
    let places = |of: fn(&FacetPoint) -> Vec3| inside.iter().map(of).collect::<Vec<_>>();
    let lifted = certified(strips, &places(|p| p.lifted), control);
    let flat = certified(strips, &places(|p| p.flat), control);
    let is_bare = |(p, b): &(&FacetPoint, &f64)| **b > tolerance + (p.lifted - p.flat).norm();
    let bare: Vec<&FacetPoint> = inside.iter().zip(lifted.bounds()).filter(is_bare).map(|(p, _)| p).collect();
    let near = inside.iter().zip(lifted.bounds()).zip(flat.bounds()).filter(|(l, _)| !is_bare(l)).map(|(_, b)| *b);
    let note = FitNote::CoarseMesh {
        corners: cloud.points.len(),
        triangles: cloud.triangles.len(),
        bulge_estimate: bulge(inside),
        off_estimate: near.fold(0.0, f64::max),
        places: inside.len(),
    };
    let reason = bare.get(bare.len() / 2).map(|p| {
        format!(
            "{:.2} % of the places on the mesh have no strip near them, for example around ({:.3}, {:.3}, {:.3})",
            100.0 * bare.len() as f64 / inside.len() as f64,
            p.flat.x,
            p.flat.y,
            p.flat.z
        )
    });
    (note, reason)
}

/// Where coordinates would lose digits to their distance from the origin: the middle of the points, rounded.
fn far_off(points: &[Vec3]) -> Option<Vec3> {
    // Distances from the origin in multiples of the extent up to which nothing is lost that matters.
    const FAR: f64 = 100.0;
    let b = core(points);
    let c = b.center();
    (c.norm() > FAR * b.diagonal() && c.iter().all(|x| x.is_finite())).then(|| c.map(f64::round))
}

/// Regions without creases, of points that may miss the surface by `slack` (mm).
fn regions_of(found: &Estimates, tolerance: f64, slack: f64) -> Vec<Region> {
    // More noise than this many times the usual one, unless it is far below the tolerance, is a crease. Cells that a bent
    // sheet crosses askew have several times the bias of others.
    const ROUGH: f64 = 2.5;
    const UNSEEN: f64 = 0.2;
    regions(found, (ROUGH * found.noise).max(UNSEEN * tolerance) + slack)
}

/// What pieces must be like.
struct Asked<'a> {
    options: &'a FitOptions,
    /// Whether they must turn little.
    narrow: bool,
}

/// What estimates were made of.
#[derive(Clone, Copy)]
struct Placed {
    /// Number of points, guiding ones included.
    points: usize,
    /// Origin of their coordinates.
    shift: Option<Vec3>,
    /// Distance by which guiding points may miss the surface, mm.
    slack: f64,
}

/// Torses with their estimates.
fn torses(
    found: &Estimates,
    regions: &[Region],
    placed: Placed,
    asked: Asked,
    control: &Control,
    skipped: &mut Vec<String>,
) -> Vec<(Vec<u32>, Vec<Fit>)> {
    // Single points reach beyond the noise by this factor even in large clouds.
    const PEAK: f64 = 4.0;
    // Estimates are averages over dozens of points; below this share of the noise they are noise themselves.
    const AVERAGED: f64 = 0.5;
    let Asked { options, narrow } = asked;
    let room = (options.tolerance - PEAK * found.noise).clamp(0.4 * options.tolerance, options.tolerance);
    let Placed { points, shift, slack } = placed;
    let enough = (AVERAGED * found.noise).clamp(0.01 * options.tolerance, 0.3 * options.tolerance).min(room);
    let limits = options.limits.as_ref().map(|l| l.moved(&-shift.unwrap_or_default()));
    let mut out = Vec::new();
    for region in regions {
        let weight: f64 = region.members.iter().map(|&i| found.items[i as usize].weight).sum();
        if weight < CRUMB * points as f64 && !out.is_empty() {
            continue;
        }
        let left = options.max_strips.saturating_sub(out.len());
        let wanted = PieceOptions {
            max_pieces: left,
            limits: limits.clone(),
            narrow,
            ..PieceOptions::new(room + slack, enough)
        };
        for piece in pieces(found, region, &wanted, control) {
            if !piece.fits.is_empty() {
                out.push((piece.members, piece.fits));
                continue;
            }
            let count: f64 = piece.members.iter().map(|&i| found.items[i as usize].weight).sum();
            let c = piece.members.iter().map(|&i| found.items[i as usize].x).sum::<Vec3>()
                / piece.members.len().max(1) as f64
                + shift.unwrap_or_default();
            skipped.push(format!(
                "{count:.0} points around ({:.1}, {:.1}, {:.1}): no developable strip follows them within {} mm{}",
                c.x,
                c.y,
                c.z,
                options.tolerance,
                piece.kept_off.map_or(String::new(), regression::kept_off)
            ));
        }
    }
    out
}

/// Points farther from the torse of their piece than this many tolerances are outliers.
const NEAR: f64 = 3.0;

/// Points under strips.
struct Given<'a> {
    /// The points of the file, then those that guide.
    points: &'a [Vec3],
    /// Number of the first: these are judged.
    judged: usize,
}

/// Strips of torses under the points of their estimates.
fn strips(
    found: &Estimates,
    given: &Given,
    fits: Vec<(Vec<u32>, Vec<Fit>)>,
    options: &FitOptions,
    skipped: &mut Vec<String>,
) -> Vec<Strip> {
    let mut owner: Vec<Option<u32>> = vec![None; found.items.len()];
    for (k, (members, _)) in fits.iter().enumerate() {
        members.iter().for_each(|&i| owner[i as usize] = Some(k as u32));
    }
    let points = given.points;
    let mut own: Vec<Vec<Vec3>> = vec![Vec::new(); fits.len()];
    let mut judged = vec![0; fits.len()];
    let fits: Vec<Vec<Fit>> =
        fits.into_iter().map(|(_, f)| f.into_iter().map(|f| widened(&f).unwrap_or(f)).collect()).collect();
    let torses: Vec<&Fit> = fits.iter().filter_map(|f| f.first()).collect();
    let assigned = assigned(found, &owner, &torses, points, NEAR * options.tolerance);
    for (i, (p, k)) in points.iter().zip(assigned).enumerate() {
        if let Some(k) = k {
            own[k as usize].push(*p);
            judged[k as usize] += usize::from(i < given.judged);
        }
    }
    let mut out: Vec<Strip> = Vec::new();
    for ((fits, own), judged) in fits.iter().zip(&own).zip(judged) {
        let name = format!("A-{:02}", out.len() + 1);
        match nearest(&name, fits, &Given { points: own, judged }, options) {
            Ok(s) => out.push(s),
            Err(reason) => skipped.push(format!("{} points have no strip: {reason}", own.len())),
        }
    }
    out
}

/// The strip of the torse with the fewest points beyond the tolerance and the smallest proven distance, among those whose
/// regression curve keeps to the limits if there are any. Where points are beyond, torses are continued over the points
/// themselves.
fn nearest(name: &str, fits: &[Fit], given: &Given, options: &FitOptions) -> Result<Strip, String> {
    let own = given.points;
    // A piece may have no points of its own but those that guide.
    let judged = if given.judged > 0 { &own[..given.judged] } else { own };
    // Points judged for the choice; the strip chosen is judged with all of them later.
    const JUDGED: usize = 20_000;
    let some: Vec<Vec3> = judged.iter().step_by(judged.len().div_ceil(JUDGED).max(1)).copied().collect();
    let mut best: Option<(bool, usize, f64, Strip)> = None;
    let mut reason = String::new();
    let mut look = |fit: &Fit| match strip(name, fit, own, options.tolerance) {
        Ok(s) => {
            let c = certified(std::slice::from_ref(&s), &some, &Control::default());
            let rank =
                (!regression::keeps(&s, options.limits.as_ref()), c.beyond(options.tolerance), c.worst_bound().value());
            if best.as_ref().is_none_or(|b| rank < (b.0, b.1, b.2)) {
                best = Some((rank.0, rank.1, rank.2, s));
            }
            rank.1 == 0
        }
        Err(e) => {
            reason = format!("the {} found gives none: {e}", fit.kind.name());
            false
        }
    };
    let mut done = false;
    for fit in fits {
        done |= look(fit);
    }
    if !done {
        for fit in fits {
            if let Some(again) = polished(fit, &some, options.tolerance) {
                look(&widened(&again).unwrap_or(again));
            }
        }
    }
    best.map(|b| b.3).ok_or(reason)
}

/// What is the matter if points are not shown to lie within the tolerance.
fn too_far(strips: &[Strip], c: &PointCertificate, points: &[Vec3], tolerance: f64, control: &Control) -> String {
    if strips.is_empty() {
        return "no developable strip follows the points within the tolerance".into();
    }
    if control.stopped() {
        return "stopped before all points were judged".into();
    }
    let Some((i, p)) = c.worst().and_then(|i| Some((i, points.get(i)?))) else { return String::new() };
    format!(
        "{} of {} points are not within {tolerance} mm; the worst is point {i} at ({:.3}, {:.3}, {:.3}), {:.3} mm away",
        c.beyond(tolerance),
        points.len(),
        p.x,
        p.y,
        p.z,
        c.worst_bound().value()
    )
}

/// Points farther than this many tolerances belong to no strip and are counted for the whole only.
const OF_A_STRIP: f64 = 10.0;

fn claims_of_strips(strips: &[Strip], c: &PointCertificate, tolerance: f64) -> Vec<Claim> {
    let within = OF_A_STRIP * tolerance;
    let mut count = vec![0usize; strips.len()];
    let mut sum = vec![0.0_f64; strips.len()];
    for ((k, _, _), b) in c.places().iter().zip(c.bounds()) {
        let k = *k as usize;
        if k < strips.len() && *b <= within {
            count[k] += 1;
            sum[k] += b * b;
        }
    }
    strips
        .iter()
        .enumerate()
        .flat_map(|(k, strip)| {
            let subject = Subject::Panel(k);
            let mean = (sum[k] / count[k].max(1) as f64).sqrt();
            [
                Claim::count(Counted::Points, subject, count[k]),
                Claim::at_most(What::PointDistance, subject, c.worst_bound_on(k, within)),
                Claim::measured(What::MeanPointDistance, subject, mean),
                regression::claim(k, strip),
            ]
        })
        .collect()
}

/// Mean signed distance of the points around the places of a grid; empty places take their neighbours' mean. Points far
/// beyond the tolerance do not belong to the strip and do not count here; the map of points shows them.
fn fields(strips: &[Strip], c: &PointCertificate, tolerance: f64) -> Vec<PanelField> {
    const FAR: f64 = 10.0;
    const ALONG: usize = 48;
    const ACROSS: usize = 24;
    let (nu, nv) = (ALONG + 1, ACROSS + 1);
    let mut sums = vec![vec![(0.0_f64, 0.0_f64); nu * nv]; strips.len()];
    for ((k, u, v), d) in c.places().iter().zip(c.signed_estimates()) {
        let Some(s) = strips.get(*k as usize) else { continue };
        if d.is_nan() || d.abs() > FAR * tolerance {
            continue;
        }
        let (a, b) = s.domain();
        let at = |x: f64, n: usize| ((x * n as f64).round().clamp(0.0, n as f64)) as usize;
        let cell = at((f64::from(*u) - a) / (b - a), ALONG) * nv + at(f64::from(*v), ACROSS);
        sums[*k as usize][cell].0 += d;
        sums[*k as usize][cell].1 += 1.0;
    }
    let grid = |n: usize, a: f64, b: f64| (0..=n).map(|i| a + (b - a) * i as f64 / n as f64).collect::<Vec<f64>>();
    strips
        .iter()
        .zip(sums)
        .map(|(s, sums)| {
            let mut values: Vec<Option<f64>> = sums.iter().map(|(d, n)| (*n > 0.0).then(|| d / n)).collect();
            // Holes are filled ring by ring.
            while values.iter().any(Option::is_none) && values.iter().any(Option::is_some) {
                let before = values.clone();
                for i in 0..nu {
                    for j in 0..nv {
                        if before[i * nv + j].is_some() {
                            continue;
                        }
                        let around: Vec<f64> = (i.saturating_sub(1)..(i + 2).min(nu))
                            .flat_map(|p| (j.saturating_sub(1)..(j + 2).min(nv)).map(move |q| p * nv + q))
                            .filter_map(|k| before[k])
                            .collect();
                        if !around.is_empty() {
                            values[i * nv + j] = Some(around.iter().sum::<f64>() / around.len() as f64);
                        }
                    }
                }
            }
            let (a, b) = s.domain();
            PanelField {
                u: grid(ALONG, a, b),
                v: grid(ACROSS, 0.0, 1.0),
                values: values.into_iter().map(|v| v.unwrap_or(0.0)).collect(),
            }
        })
        .collect()
}
