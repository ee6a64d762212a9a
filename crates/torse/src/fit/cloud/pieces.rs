//! Pieces of a region that one torse follows: as few as greed finds.
//!
//! *Method.* A torse is fitted to the whole region; where it is not near enough, the estimates are sorted across the
//! rulings (the direction in space along which normals change most) and the longest beginning that a torse can
//! follow is found by bisection, then the rest likewise (the segmentation of \[PW99, 4.3\], made by fits). Torses
//! are those over a plane profile, so that planes, cylinders, cones and inflections are included, and dual splines.

use super::estimates::Estimates;
use super::regions::Region;
use crate::control::Control;
use crate::fit::elements::sequence::{controlled_of_cloud, dual_of_cloud, keeps_limits, SequenceOptions};
use crate::fit::near::primal::{primal, PrimalOptions};
use crate::fit::near::samples::{Fit, Sample};
use crate::geom::Vec3;
use crate::torse::form::PanelKind;
use crate::torse::zone::RegressionLimits;
use nalgebra::{Matrix3, SymmetricEigen};

/// Options of [`pieces`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PieceOptions {
    /// Largest distance of an estimate from its torse, mm.
    pub tolerance: f64,
    /// Distance below which a fit need not be improved, mm.
    pub enough: f64,
    /// Pieces at most; 64.
    pub max_pieces: usize,
    /// Estimates of a piece at least; 8.
    pub fewest: usize,
    /// What is asked of regression curves; nothing beyond a regular strip.
    pub limits: Option<RegressionLimits>,
    /// Whether normals of a piece must keep within 65° of their mean, and regions are cut into such parts first; false.
    pub narrow: bool,
}

impl PieceOptions {
    /// The defaults with a tolerance and a distance that is near enough, mm.
    pub fn new(tolerance: f64, enough: f64) -> Self {
        Self { tolerance, enough, max_pieces: 64, fewest: 8, limits: None, narrow: false }
    }
}

/// Part of a region with its torse.
#[derive(Clone, Debug)]
pub(crate) struct CloudPiece {
    /// Estimates that belong to it.
    pub members: Vec<u32>,
    /// Torses that follow it, the nearest to its estimates first; empty where nothing fits.
    pub fits: Vec<Fit>,
    /// Where nothing fits because of the regression curve: the distance (mm) of the nearest torse found that keeps to the
    /// limits, infinite if none was found.
    pub kept_off: Option<f64>,
}

/// What was found for a part of a region.
#[derive(Default)]
struct Found {
    fits: Vec<Fit>,
    kept_off: Option<f64>,
}

/// Splits a region into pieces. Every estimate belongs to exactly one piece.
pub fn pieces(estimates: &Estimates, region: &Region, options: &PieceOptions, control: &Control) -> Vec<CloudPiece> {
    // Share of a row by which bisection stops.
    const STEPS: usize = 5;
    let samples: Vec<(u32, Sample)> = region
        .members
        .iter()
        .zip(&region.normals)
        .map(|(&i, n)| {
            let e = &estimates.items[i as usize];
            (i, Sample { x: e.x, n: *n, weight: e.weight })
        })
        .collect();
    let mut out: Vec<CloudPiece> = Vec::new();
    let mut waiting = if options.narrow { sectors(samples) } else { vec![Part { own: samples, beside: Vec::new() }] };
    while let Some(Part { own: mut rest, beside }) = waiting.pop() {
        let name = |s: &[(u32, Sample)]| s.iter().map(|p| p.0).collect::<Vec<u32>>();
        if rest.len() < options.fewest || out.len() >= options.max_pieces || control.stopped() {
            out.push(CloudPiece { members: name(&rest), fits: Vec::new(), kept_off: None });
            continue;
        }
        // With its neighbours first, so that it goes on beyond its own.
        let mut found = attempt(&[&rest[..], &beside].concat(), estimates.cell, options);
        if found.fits.is_empty() && !beside.is_empty() {
            found = attempt(&rest, estimates.cell, options);
        }
        if !found.fits.is_empty() {
            out.push(CloudPiece { members: name(&rest), fits: found.fits, kept_off: None });
            continue;
        }
        let axis = across(&rest);
        rest.sort_by(|a, b| axis.dot(&a.1.x).total_cmp(&axis.dot(&b.1.x)));
        if found.kept_off.is_some() && hopeless(&rest, estimates.cell, options) {
            out.push(CloudPiece { members: name(&rest), fits: Vec::new(), kept_off: found.kept_off });
            continue;
        }
        let (mut good, mut bad) = (0, rest.len());
        let mut best = Found::default();
        for _ in 0..STEPS {
            let middle = (good + bad) / 2;
            if middle < options.fewest || middle <= good {
                break;
            }
            let found = attempt(&rest[..middle], estimates.cell, options);
            if found.fits.is_empty() {
                bad = middle;
            } else {
                (good, best) = (middle, found);
            }
        }
        if best.fits.is_empty() {
            // A last try with the smallest piece; if that fails, it is named and left out.
            good = options.fewest.min(rest.len());
            best = attempt(&rest[..good], estimates.cell, options);
        }
        let tail = rest.split_off(good);
        out.push(CloudPiece { members: name(&rest), fits: best.fits, kept_off: best.kept_off });
        if !tail.is_empty() {
            waiting.push(Part { own: tail, beside: Vec::new() });
        }
    }
    out
}

/// Estimates of which a piece is to be made.
struct Part {
    /// Those that belong to it.
    own: Vec<(u32, Sample)>,
    /// Neighbours of other parts, which only take part in the fit.
    beside: Vec<(u32, Sample)>,
}

/// A region that turns far in parts that do not, from ruling to ruling: normals of developables lie near a circle of the
/// Gauss sphere, and equal arcs of it are taken, beginning at its widest gap.
fn sectors(samples: Vec<(u32, Sample)>) -> Vec<Part> {
    use std::f64::consts::TAU;
    // Turn of a part (rad), and of its neighbours on both sides: together less than 65° from its middle.
    const TURN: f64 = 1.6;
    const BESIDE: f64 = 0.3;
    if !is_wide(samples.iter().map(|s| s.1.n)) {
        return vec![Part { own: samples, beside: Vec::new() }];
    }
    let mean = samples.iter().map(|s| s.1.n).sum::<Vec3>() / samples.len() as f64;
    let m: Matrix3<f64> = samples.iter().map(|s| (s.1.n - mean) * (s.1.n - mean).transpose()).sum();
    let e = SymmetricEigen::new(m);
    let axis = e.eigenvectors.column(e.eigenvalues.imin()).into_owned();
    let x = e.eigenvectors.column(e.eigenvalues.imax()).into_owned();
    let y = axis.cross(&x);
    let angles: Vec<f64> = samples.iter().map(|s| s.1.n.dot(&y).atan2(s.1.n.dot(&x))).collect();
    let mut sorted = angles.clone();
    sorted.sort_by(f64::total_cmp);
    let gap = |k: usize| if k == 0 { sorted[0] + TAU - sorted[sorted.len() - 1] } else { sorted[k] - sorted[k - 1] };
    let start = (0..sorted.len()).max_by(|&i, &j| gap(i).total_cmp(&gap(j))).unwrap_or(0);
    let range = TAU - gap(start);
    let count = (range / TURN).ceil().max(1.0);
    let width = range / count;
    let mut out: Vec<Part> = (0..count as usize).map(|_| Part { own: Vec::new(), beside: Vec::new() }).collect();
    for (s, angle) in samples.into_iter().zip(angles) {
        let at = (angle - sorted[start]).rem_euclid(TAU);
        let own = ((at / width) as usize).min(out.len() - 1);
        for (k, part) in out.iter_mut().enumerate() {
            let off = at - (k as f64 + 0.5) * width;
            let off = off.abs().min(TAU - off.abs());
            if k == own {
                part.own.push(s);
            } else if off <= 0.5 * width + BESIDE {
                part.beside.push(s);
            }
        }
    }
    out.retain(|part| !part.own.is_empty());
    out
}

/// Whether limits of the regression curve leave nothing of a row of estimates: a strip that keeps to them does so on
/// every part, so that nothing is to be found where short parts at both ends and in the middle have none.
fn hopeless(row: &[(u32, Sample)], cell: f64, options: &PieceOptions) -> bool {
    // A part in so many, but enough of them for a fit to mean something.
    const PARTS: usize = 12;
    let count = (row.len() / PARTS).max(3 * options.fewest).min(row.len());
    let rest = row.len() - count;
    [0, rest / 2, rest].iter().all(|&from| attempt(&row[from..from + count], cell, options).kept_off.is_some())
}

/// Cosine of the angle from the mean normal beyond which a torse over a plane profile is not tried: 65°.
const TURNED: f64 = 0.422_618_261_740_699_4;

/// Whether unit normals, oriented alike, turn by more than 65° from their mean.
pub(crate) fn is_wide(normals: impl Iterator<Item = Vec3> + Clone) -> bool {
    let mean: Vec3 = normals.clone().sum();
    let mut normals = normals;
    mean.norm() <= 0.0 || normals.any(|n| n.dot(&mean) < TURNED * mean.norm())
}

/// Torses within the tolerance of the estimates: over a plane profile, and a dual spline.
fn attempt(samples: &[(u32, Sample)], cell: f64, options: &PieceOptions) -> Found {
    let samples: Vec<Sample> = samples.iter().map(|s| s.1).collect();
    let mut out = Vec::new();
    let wide = is_wide(samples.iter().map(|s| s.n));
    if wide && options.narrow {
        return Found::default();
    }
    if !wide {
        out.extend(primal(&samples, &PrimalOptions::new(options.enough)));
    }
    let allowed = |f: &Fit| options.limits.as_ref().is_none_or(|l| keeps_limits(&f.torse, &samples, cell, l));
    let simple =
        out.first().is_some_and(|f: &Fit| f.kind != PanelKind::Torse && f.error <= options.tolerance && allowed(f));
    // A plane, cylinder or cone that is near enough is what people expect to get back.
    if !simple {
        out.extend(dual_of_cloud(&samples, cell, &SequenceOptions::new(options.enough)));
    }
    out.retain(|f| f.error <= options.tolerance);
    let mut kept_off = None;
    // With more conditions nothing comes nearer than fits without them.
    if let Some(limits) = options.limits.as_ref().filter(|_| !out.is_empty()) {
        out.retain(|f| keeps_limits(&f.torse, &samples, cell, limits));
        if out.is_empty() {
            let wanted = SequenceOptions::new(options.tolerance);
            let kept = controlled_of_cloud(&samples, cell, limits, &wanted);
            match kept.filter(|f| keeps_limits(&f.torse, &samples, cell, limits)) {
                Some(f) if f.error <= options.tolerance => out.push(f),
                other => kept_off = Some(other.map_or(f64::INFINITY, |f| f.error)),
            }
        }
    }
    out.sort_by(|a, b| a.error.total_cmp(&b.error));
    Found { fits: out, kept_off }
}

/// The direction in space along which normals change most.
fn across(samples: &[(u32, Sample)]) -> Vec3 {
    let count = samples.len() as f64;
    let x: Vec3 = samples.iter().map(|s| s.1.x).sum::<Vec3>() / count;
    let n: Vec3 = samples.iter().map(|s| s.1.n).sum::<Vec3>() / count;
    let m: Matrix3<f64> = samples.iter().map(|s| (s.1.x - x) * (s.1.n - n).transpose()).sum();
    let e = SymmetricEigen::new(m * m.transpose());
    e.eigenvectors.column(e.eigenvalues.imax()).into_owned()
}
