//! From measured points to strips \[PW99, 4.3\]: estimates, regions without creases, torses of their pieces, strips under the
//! points of each; judged, and made narrower where points are beyond the tolerance.

use super::regression;
use crate::certify::points::{points as certified, PointCertificate};
use crate::control::Control;
use crate::develop::mesh_border;
use crate::fit::cloud::core;
use crate::fit::cloud::estimates::{estimates, Estimates};
use crate::fit::cloud::extent::{assigned, polished, strip, widened};
use crate::fit::cloud::facets::{facet_points, FacetPoint};
use crate::fit::cloud::pieces::{is_wide, pieces, PieceOptions};
use crate::fit::cloud::regions::{regions, Region};
use crate::fit::cloud::CloudError;
use crate::fit::near::samples::Fit;
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::num::hash::HashMap;
use crate::reason::{Reason, StripReason};
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// What strips under points must be like.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScanOptions {
    /// Largest distance of a point from the strips, mm.
    pub tolerance: f64,
    /// Places at which the surface is estimated.
    pub places: usize,
    /// Strips at most.
    pub max_strips: usize,
    /// What is asked of regression curves.
    pub limits: Option<RegressionLimits>,
}

/// Strips under measured points, judged.
#[derive(Clone, Debug)]
pub(crate) struct Scanned {
    /// The strips.
    pub strips: Vec<Strip>,
    /// What is proven of the points.
    pub certificate: PointCertificate,
    /// Points without strip, in words.
    pub skipped: Vec<StripReason>,
    /// Noise of the measurement, mm.
    pub noise: f64,
    /// Points too far from others to belong to a surface.
    pub lonely: usize,
    /// What is known between the corners of a coarse mesh; `None` where the points are no corners of one.
    pub between: Option<Between>,
    /// Of a coarse mesh the facets of each strip.
    pub facets: Vec<Vec<u32>>,
}

/// Strips under measured points; those of coarse meshes are guided by points between their corners (see
/// `fit::cloud::facets`), and only the corners are judged.
///
/// # Errors
/// See [`CloudError`].
pub(crate) fn scanned(cloud: &Cloud, options: &ScanOptions, control: &Control) -> Result<Scanned, CloudError> {
    // 1. What the surface is like, in coordinates that are small where the file's are not.
    control.report("estimating", 0.0, format!("{} points", cloud.points.len()));
    let shift = far_off(&cloud.points);
    let inside = facet_points(cloud, GUIDES);
    let moved = guided(&cloud.points, &inside, shift);
    let found = estimates(&moved, options.places)?;
    // 2. Pieces that one torse follows.
    control.report("fitting", 0.2, String::new());
    let slack = GUIDE_SLACK * bulge(&inside);
    let placed = Placed { points: moved.len(), shift, slack };
    let regions = regions_of(&found, options.tolerance, slack);
    // 3. Strips under the points of each piece, 4. with their proof.
    let given = Given { points: &moved, judged: cloud.points.len(), facets: &cloud.triangles, inside: &inside };
    let attempt = |narrow: bool| {
        let mut skipped = Vec::new();
        let fits = torses(&found, &regions, placed, (options, narrow), control, &mut skipped);
        control.report("trimming", 0.6, format!("{} pieces", fits.len()));
        let (strips, facets) = strips(&found, &given, fits, options, &mut skipped);
        let strips: Vec<Strip> = match shift {
            Some(c) => strips.into_iter().map(|s| s.moved(&c)).collect(),
            None => strips,
        };
        let certificate = certified(&strips, &cloud.points, control);
        (certificate, strips, skipped, facets)
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
    let (certificate, strips, skipped, facets) = done;
    let lonely = found.of_point.iter().take(cloud.points.len()).filter(|e| e.is_none()).count();
    let between = (!inside.is_empty()).then(|| between(&strips, &inside, options.tolerance, control));
    Ok(Scanned { strips, certificate, skipped, noise: found.noise, lonely, between, facets })
}

/// Points of regions smaller than this share of the cloud are left to the other strips, if these are near.
const CRUMB: f64 = 0.01;

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

/// What is known of strips between the corners of a coarse mesh; all of it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// How far a smooth sheet through the corners may lie off the triangles, mm, estimated.
    pub bulge_estimate: f64,
    /// How far triangles lie from the strips at most, mm; parts without strip left out.
    pub off_estimate: f64,
    /// Places at which that was sampled.
    pub places: usize,
    /// Share of the places without a strip near them, and one of these; `None` if there are none.
    pub bare: Option<(f64, Vec3)>,
}

/// What is known between the corners of a coarse mesh with these places.
fn between(strips: &[Strip], inside: &[FacetPoint], tolerance: f64, control: &Control) -> Between {
    let places = |of: fn(&FacetPoint) -> Vec3| inside.iter().map(of).collect::<Vec<_>>();
    let lifted = certified(strips, &places(|p| p.lifted), control);
    let flat = certified(strips, &places(|p| p.flat), control);
    let is_bare = |(p, b): &(&FacetPoint, &f64)| **b > tolerance + (p.lifted - p.flat).norm();
    let bare: Vec<&FacetPoint> = inside.iter().zip(lifted.bounds()).filter(is_bare).map(|(p, _)| p).collect();
    let near = inside.iter().zip(lifted.bounds()).zip(flat.bounds()).filter(|(l, _)| !is_bare(l)).map(|(_, b)| *b);
    Between {
        bulge_estimate: bulge(inside),
        off_estimate: near.fold(0.0, f64::max),
        places: inside.len(),
        bare: bare.get(bare.len() / 2).map(|p| (bare.len() as f64 / inside.len() as f64, p.flat)),
    }
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
    (options, narrow): (&ScanOptions, bool),
    control: &Control,
    skipped: &mut Vec<StripReason>,
) -> Vec<(Vec<u32>, Vec<Fit>)> {
    // Single points reach beyond the noise by this factor even in large clouds.
    const PEAK: f64 = 4.0;
    // Estimates are averages over dozens of points; below this share of the noise they are noise themselves.
    const AVERAGED: f64 = 0.5;
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
            let (tolerance, kept_off) = (options.tolerance, piece.kept_off);
            let why = StripReason::NotFollowed { tolerance, fixed_ends: false, smoothing: None, kept_off };
            skipped.push(StripReason::PointsAround { count, at: c, why: Box::new(why.into()) });
        }
    }
    out
}

/// Points farther from the torse of their piece than this many tolerances are outliers.
pub(crate) const NEAR: f64 = 3.0;

/// Points under strips.
struct Given<'a> {
    /// The points of the file, then those that guide.
    points: &'a [Vec3],
    /// Number of the first: these are judged.
    judged: usize,
    /// Facets between the first.
    facets: &'a [[u32; 3]],
    /// What the others are.
    inside: &'a [FacetPoint],
}

/// Strips of torses under the points of their estimates, and the facets of each.
fn strips(
    found: &Estimates,
    given: &Given,
    fits: Vec<(Vec<u32>, Vec<Fit>)>,
    options: &ScanOptions,
    skipped: &mut Vec<StripReason>,
) -> (Vec<Strip>, Vec<Vec<u32>>) {
    let mut owner: Vec<Option<u32>> = vec![None; found.items.len()];
    for (k, (members, _)) in fits.iter().enumerate() {
        members.iter().for_each(|&i| owner[i as usize] = Some(k as u32));
    }
    let fits: Vec<Vec<Fit>> =
        fits.into_iter().map(|(_, f)| f.into_iter().map(|f| widened(&f).unwrap_or(f)).collect()).collect();
    let torses: Vec<&Fit> = fits.iter().filter_map(|f| f.first()).collect();
    let assigned = assigned(found, &owner, &torses, given.points, NEAR * options.tolerance);
    let (mut out, mut facets): (Vec<Strip>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    for (fits, parts) in fits.iter().zip(owned(given, &assigned, fits.len())) {
        for Owned { points, judged, facets: own } in parts {
            if out.len() >= options.max_strips {
                skipped.push(StripReason::Points(points.len(), None));
                continue;
            }
            let name = format!("A-{:02}", out.len() + 1);
            match nearest(&name, fits, (&points[..], judged), options) {
                Ok(s) => {
                    out.push(s);
                    facets.push(own);
                }
                Err(why) => skipped.push(StripReason::Points(points.len(), why.map(|why| Box::new(why.into())))),
            }
        }
    }
    (out, facets)
}

/// What one strip lies under.
#[derive(Default)]
struct Owned {
    /// Points, those that are judged first.
    points: Vec<Vec3>,
    /// Number of these.
    judged: usize,
    /// Facets of a coarse mesh.
    facets: Vec<u32>,
}

/// What each of `count` torses lies under, given the torse of every point. Of coarse meshes a torse has whole facets, in parts that
/// hang together: the strips of neighbours reach to the same sides of facets.
fn owned(given: &Given, assigned: &[Option<u32>], count: usize) -> Vec<Vec<Owned>> {
    let mut loose: Vec<Owned> = (0..count).map(|_| Owned::default()).collect();
    if given.inside.is_empty() {
        for (p, k) in given.points.iter().zip(assigned) {
            if let Some(own) = k.and_then(|k| loose.get_mut(k as usize)) {
                own.points.push(*p);
            }
        }
        loose.iter_mut().for_each(|own| own.judged = own.points.len());
        return loose.into_iter().map(|own| vec![own]).collect();
    }
    // A facet belongs to the torse of most of the points inside it, or of its corners where it has none.
    let mut votes: Vec<Vec<u32>> = vec![Vec::new(); given.facets.len()];
    for (p, k) in given.inside.iter().zip(&assigned[given.judged..]) {
        votes[p.facet as usize].extend(k);
    }
    let mut of_torse: Vec<Vec<u32>> = vec![Vec::new(); count];
    for ((facet, votes), n) in given.facets.iter().zip(&mut votes).zip(0..) {
        if votes.is_empty() {
            votes.extend(facet.iter().filter_map(|&c| assigned[c as usize]));
        }
        votes.sort_unstable();
        if let Some(most) = votes.chunk_by(|a, b| a == b).max_by_key(|c| c.len()) {
            of_torse[most[0] as usize].push(n);
        }
    }
    with_crumbs(given, &mut of_torse);
    let mut beside: HashMap<u32, Vec<Vec3>> = HashMap::default();
    for (p, place) in given.inside.iter().zip(&given.points[given.judged..]) {
        beside.entry(p.facet).or_default().push(*place);
    }
    let part = |facets: Vec<u32>| {
        let corners: BTreeSet<u32> = facets.iter().flat_map(|&f| given.facets[f as usize]).collect();
        let mut points: Vec<Vec3> = corners.iter().map(|&c| given.points[c as usize]).collect();
        let judged = points.len();
        points.extend(facets.iter().filter_map(|f| beside.get(f)).flatten());
        Owned { points, judged, facets }
    };
    of_torse.into_iter().map(|f| mesh_border::parts(given.facets, &f).into_iter().map(&part).collect()).collect()
}

/// Gives parts of a hundredth of the mesh to the torse beside them, if there is one: near creases a facet is easily mistaken.
fn with_crumbs(given: &Given, of_torse: &mut [Vec<u32>]) {
    let area = |f: &u32| {
        let [a, b, c] = given.facets[*f as usize].map(|c| given.points[c as usize]);
        (b - a).cross(&(c - a)).norm()
    };
    let sides = |f: u32| {
        let t = given.facets[f as usize];
        [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| [a.min(b), a.max(b)])
    };
    let whole: f64 = of_torse.iter().flatten().map(area).sum();
    let all: Vec<(usize, Vec<u32>)> = of_torse
        .iter()
        .enumerate()
        .flat_map(|(k, f)| mesh_border::parts(given.facets, f).into_iter().map(move |p| (k, p)))
        .collect();
    let (crumbs, parts): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|(_, p)| p.iter().map(area).sum::<f64>() < CRUMB * whole);
    let mut owner: HashMap<[u32; 2], usize> = HashMap::default();
    of_torse.iter_mut().for_each(Vec::clear);
    for (k, part) in parts {
        part.iter().flat_map(|&f| sides(f)).for_each(|s| {
            owner.insert(s, k);
        });
        of_torse[k].extend(part);
    }
    for (k, part) in crumbs {
        let mut beside: Vec<usize> =
            part.iter().flat_map(|&f| sides(f)).filter_map(|s| owner.get(&s)).copied().collect();
        beside.sort_unstable();
        let most = beside.chunk_by(|a, b| a == b).max_by_key(|c| c.len()).map_or(k, |c| c[0]);
        of_torse[most].extend(part);
    }
}

/// The strip of the torse with the fewest points beyond the tolerance and the smallest proven distance, among those whose
/// regression curve keeps to the limits if there are any. Where points are beyond, torses are continued over the points
/// themselves.
fn nearest(
    name: &str,
    fits: &[Fit],
    (own, judged): (&[Vec3], usize),
    options: &ScanOptions,
) -> Result<Strip, Option<StripReason>> {
    let judged = &own[..judged];
    // Points judged for the choice; the strip chosen is judged with all of them later.
    const JUDGED: usize = 20_000;
    let some: Vec<Vec3> = judged.iter().step_by(judged.len().div_ceil(JUDGED).max(1)).copied().collect();
    let mut best: Option<(bool, usize, f64, Strip)> = None;
    let mut reason = None;
    let mut try_fit = |fit: &Fit| match strip(name, fit, own, options.tolerance) {
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
            reason = Some(StripReason::NoStrip { kind: fit.kind.name(), error: Box::new(Reason::error(&e)) });
            false
        }
    };
    let mut done = false;
    for fit in fits {
        done |= try_fit(fit);
    }
    if !done {
        for fit in fits {
            if let Some(again) = polished(fit, &some, options.tolerance) {
                try_fit(&widened(&again).unwrap_or(again));
            }
        }
    }
    best.map(|b| b.3).ok_or(reason)
}
