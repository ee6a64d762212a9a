//! The proof for one panel: distance, boundary, rounding, developability and simple loops, put together.
//!
//! *Theorem* \[certificate, 1\], in the form of [`boundary`](super::boundary): with D, δ, η the bounds of distance,
//! boundary and rounding, and κ the curvature of the torse along the boundary, the trimmed panel in the file and its
//! part of the face are within `√((D + κδ²/2)² + δ²) + η` of each other, in both directions. Where faces of the file
//! were joined, their points moved by at most a known bound (`Face::joint_bound`), which is added to η: the bound is
//! one to the faces of the file. So is the bound of [`edges`](super::edges): a panel bounded by its edges in space
//! instead of its trimming curves is as near.

use super::boundary::{Boundary, CoedgeBound, Side};
use super::certificate::PanelParts;
use super::developable::{developability, trim_boxes, Developability, ANGLE_LIMIT};
use super::distance::{judge, DistanceOptions, Judged};
use super::edges::edge_bound;
use super::family::Family;
use super::mismatch::Mismatch;
use super::prepared::Prepared;
use super::rounding::rounding_bound;
use super::ruled::{Ruled, RuledJets};
use super::seams::SeamSide;
use super::simple::{leaves, loops_are_simple};
use super::verdict::Verdict;
use super::written::reserve;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel, PanelTrim};
use crate::patchwork::partition::Partition;
use crate::reason::{LoopFault, PanelFault, Reason};
use crate::spline::surface::Surface;
use crate::torse::form::Torse;

/// A panel that is not within the tolerance is looked at again with these multiples of it, so that the report can
/// state a bound all the same.
const SECOND_LOOKS: [f64; 4] = [1.1, 1.5, 3.0, 10.0];

/// The face that a panel lies on.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub partition: &'a Partition,
    pub prepared: &'a Prepared<'a>,
    /// Bound (mm) of what joining faces moved, and of how far the partition's border lies off the trimming polygons.
    pub moved: f64,
    /// Whether a bound is stated however far the panel is away, and not only if it is near the tolerance.
    pub far: bool,
}

/// Everything proven about a panel, and its patch ready for the seams.
pub(super) fn panel_certificate(
    panel: &Panel,
    (trim, torse): (&PanelTrim, &Torse),
    ground: &Ground,
    tolerance: f64,
    control: &Control,
) -> (PanelParts, Option<RuledJets>) {
    let &Ground { partition, prepared, moved, far } = ground;
    let mut out = PanelParts::blank();
    let triangles = region(partition, trim.label);
    let ruled = Ruled::new(&panel.strip.patch);
    let place = ruled.as_ref().map_or_else(Vec3::zeros, place_on);
    let (Some(family), Some(ruled)) = (Family::about(torse, &place), ruled) else {
        out.reason = Some(PanelFault::NoTorse.into());
        return (out, None);
    };
    if triangles.is_empty() {
        out.reason = Some(PanelFault::NoRegion.into());
        return (out, None);
    }
    let mut reasons = Vec::new();
    let shape = patch_bounds(&mut out, panel, &family, &ruled, &mut reasons);
    let origin = [family.origin.x, family.origin.y, family.origin.z];
    let jets = RuledJets::new(&ruled, &origin);
    let boundary = Boundary { family: &family, jets: &jets, prepared, tolerance };
    let edge = boundary_bounds(trim, (partition, prepared.surface, &panel.strip.patch), &boundary, &mut reasons);
    out.boundary_bound = edge.delta.unwrap_or(f64::INFINITY);

    // The edges in space that go with the trimming curves.
    match edges(panel, &jets, tolerance) {
        Ok(bound) => out.edge_bound = bound,
        Err(at) => reasons.push(PanelFault::Edge(at)),
    }

    // Distance, within what boundary, edges and rounding have left of the tolerance.
    let beside = if out.edge_bound.is_finite() { out.edge_bound } else { 0.0 };
    let eta = (Interval::point(out.rounding_bound) + Interval::point(moved) + Interval::point(beside)).hi;
    let sides: Vec<Side> = edge.runs.iter().flat_map(|r| r.sides.iter().copied()).collect();
    let mismatch = sides.iter().fold(Mismatch::of_rounding(eta), Mismatch::with_side);
    let looks = if far { &SECOND_LOOKS[..] } else { &SECOND_LOOKS[..1] };
    let region = Region { prepared, torse, triangles: &triangles, sides: &sides, tolerance, looks, control };
    let (judged, total) = region.judged(&mismatch, &mut out, &mut reasons);
    if let Verdict::Holds { bound } = judged.parts.verdict {
        out.distance_bound = bound;
        // Of the patch within its trimming curves, which is what is exported.
        out.min_bend_radius = shape.bend_radius;
        if let Some(b) = edge.runs.iter().find(|b| !b.agrees_with(&judged.feet)) {
            let uv = b.start.0;
            reasons.push(PanelFault::OtherFoot(at(prepared.surface, uv)));
        } else if edge.delta.is_some() && out.edge_bound.is_finite() {
            out.deviation_bound = total;
            out.regression_clearance = shape.clearance;
        }
    }
    if reasons.is_empty() && out.deviation_bound <= tolerance {
        out.certified = true;
    } else if reasons.is_empty() {
        reasons.push(PanelFault::TooLarge(out.deviation_bound));
    }
    out.reason = Reason::all(reasons.into_iter().map(Reason::from).collect());
    (out, Some(jets))
}

/// Where positions are reckoned from: the tip, if there is one, or else the middle of the patch.
pub(super) fn place_on(ruled: &Ruled) -> Vec3 {
    let breaks = ruled.breaks();
    let middle = || ruled.middle(0.5 * (breaks[0] + breaks[breaks.len() - 1]));
    Vec3::from(ruled.tip().unwrap_or_else(middle))
}

/// Bound of the distance between edges in space and trimming curves, over all runs that files have edges for.
///
/// # Errors
/// Where an edge begins that cannot be compared.
pub(super) fn edges(panel: &Panel, jets: &RuledJets, tolerance: f64) -> Result<f64, Vec3> {
    let runs: Vec<_> = panel.loops().iter().flatten().filter(|r| !r.is_point()).collect();
    let bound = |run: &&Coedge| {
        let found = edge_bound(SeamSide { jets, trim: &run.trim }, &run.edge, tolerance).filter(|b| !b.is_nan());
        found.ok_or_else(|| run.edge.control.first().map_or_else(Vec3::zeros, |p| Vec3::from(*p)))
    };
    let bounds: Vec<_> = parallel::map(runs.iter(), bound);
    bounds.into_iter().try_fold(0.0f64, |most, b| Ok(most.max(b?)))
}

/// The file's patch against the exact torse; developability and regularity from the file's control points.
fn patch_bounds(
    out: &mut PanelParts,
    panel: &Panel,
    family: &Family,
    ruled: &Ruled,
    reasons: &mut Vec<PanelFault>,
) -> Developability {
    match rounding_bound(family, ruled) {
        Some(bound) => out.rounding_bound = (bound + reserve(&panel.strip.patch)) * (1.0 + 4.0 * f64::EPSILON),
        None => reasons.push(PanelFault::OffTorse),
    }
    let shape = developability(ruled, &trim_boxes(panel.loops().iter().flatten().map(|r| &r.trim)));
    out.developability_bound = shape.angle;
    if shape.angle > ANGLE_LIMIT {
        reasons.push(PanelFault::Twisted(shape.angle, at(&panel.strip.patch, [shape.worst, 0.5])));
    } else if !shape.regular {
        reasons.push(PanelFault::Regression(at(&panel.strip.patch, [shape.worst, 0.5])));
    }
    shape
}

/// What was shown about a panel's boundary.
struct Edge {
    runs: Vec<CoedgeBound>,
    /// Bound of the mismatch, mm, if there is one.
    delta: Option<f64>,
}

/// A place on a surface.
fn at(surface: &Surface, uv: [f64; 2]) -> Vec3 {
    surface.point(uv[0], uv[1])
}

/// The trimming curves: near the images of the region's boundary, all around the region, simple, and on the patch.
fn boundary_bounds(
    trim: &PanelTrim,
    (partition, surface, patch): (&Partition, &Surface, &Surface),
    boundary: &Boundary,
    reasons: &mut Vec<PanelFault>,
) -> Edge {
    let runs: Vec<_> = trim.loops.iter().flatten().collect();
    let bounds: Vec<_> = parallel::map(runs.iter(), |run| boundary.coedge_bound(run, &partition.vertices));
    let mut edge = Edge { runs: Vec::with_capacity(bounds.len()), delta: Some(0.0) };
    for b in bounds {
        match b {
            Ok(b) => {
                edge.delta = edge.delta.map(|d| b.sides.iter().fold(d, |d, s| d.max(s.bound)));
                edge.runs.push(b);
            }
            Err(obstacle) => {
                reasons.push(PanelFault::TrimAt(obstacle.fault, at(surface, obstacle.uv)));
                edge.delta = None;
                break;
            }
        }
    }
    reasons.extend(loop_faults(trim, patch, boundary.jets.domain()));
    edge
}

/// What could not be shown of trimming curves alone: that they are simple, and stay on their patch.
pub(super) fn loop_faults(trim: &PanelTrim, patch: &Surface, (t0, t1): (f64, f64)) -> Vec<PanelFault> {
    let curves: Vec<Vec<_>> = trim.loops.iter().map(|l| l.iter().map(|r| &r.trim).collect()).collect();
    let placed = |fault: LoopFault, [t, r]: [f64; 2]| {
        // Rulings end where they do, whatever leaves the patch.
        let place = patch.point(t.clamp(t0, t1), r.clamp(0.0, 1.0));
        match place.iter().all(|x| x.is_finite()) {
            true => PanelFault::TrimAt(fault, place),
            false => PanelFault::Trim(fault),
        }
    };
    let refused = loops_are_simple(&curves).err();
    let refused = refused.map(|r| r.at.map_or(PanelFault::Trim(r.fault), |p| placed(r.fault, p)));
    let left = curves.iter().flatten().find_map(|c| leaves(c, [t0, 0.0], [t1, 1.0]));
    refused.into_iter().chain(left.map(|p| placed(LoopFault::Leaves, p))).collect()
}

/// The part of a face that a panel stands for.
struct Region<'a> {
    prepared: &'a Prepared<'a>,
    torse: &'a Torse,
    triangles: &'a [[[f64; 2]; 3]],
    /// Of its boundary; none if one could not be bounded.
    sides: &'a [Side],
    tolerance: f64,
    /// See [`SECOND_LOOKS`].
    looks: &'a [f64],
    control: &'a Control,
}

impl Region<'_> {
    fn judge(&self, budgets: &[f64]) -> Judged {
        let options = DistanceOptions::default();
        judge(self.prepared, self.torse, self.triangles, budgets, &options, self.control)
    }

    /// The distance, on every triangle within what boundary and rounding have left of the tolerance; if that cannot be shown,
    /// within a multiple of it, with the reason. Second result: the bound of both together.
    fn judged(&self, mismatch: &Mismatch, out: &mut PanelParts, reasons: &mut Vec<PanelFault>) -> (Judged, f64) {
        let local = mismatch.on_triangles(self.prepared, self.triangles, self.sides, self.tolerance);
        let mut budgets: Vec<f64> = local.iter().map(|m| m.budget(self.tolerance)).collect();
        // What joining or trimming moved may be unknown: neither is a budget then.
        let none = |b: &f64| b.is_nan() || *b <= 0.0;
        if budgets.iter().any(none) {
            reasons.push(PanelFault::UsedUp);
            budgets.iter_mut().filter(|b| none(b)).for_each(|b| *b = self.tolerance);
        }
        let mut judged = self.judge(&budgets);
        let mut total = together(&judged, &local);
        if matches!(judged.parts.verdict, Verdict::Holds { .. }) && !judged.folds.is_empty() {
            // Where the region folds at its rim, ways are longer: less is left.
            let longer = |judged: &Judged| {
                Mismatch::with_folds(&local, &judged.folds, (self.prepared, self.triangles), self.tolerance)
            };
            let now = longer(&judged);
            total = together(&judged, &now);
            let less: Vec<f64> = now.iter().map(|m| m.budget(self.tolerance)).collect();
            if total > self.tolerance && !less.iter().any(none) {
                budgets = less;
                judged = self.judge(&budgets);
                total = together(&judged, &longer(&judged));
            }
        }
        match &judged.parts.verdict {
            Verdict::Holds { .. } => {}
            Verdict::Fails { uv, distance } => {
                let left = self.triangles.iter().zip(&budgets).filter(|(t, _)| holds(t, uv));
                let left = left.fold(self.tolerance, |m, (_, b)| m.min(*b));
                out.too_far = Some((*uv, left));
                let (away, at) = (distance.abs(), at(self.prepared.surface, *uv));
                let far = away > self.tolerance;
                if far {
                    out.witness = Some((*uv, *distance));
                }
                reasons.push(PanelFault::TooFar { away, at, left: (!far).then_some(left) });
            }
            Verdict::Undecided { uv, reason } => {
                reasons.push(PanelFault::Obstructed(*reason, at(self.prepared.surface, *uv)));
            }
        }
        out.cells = judged.parts.cells;
        for factor in self.looks {
            if matches!(judged.parts.verdict, Verdict::Holds { .. }) || self.control.stopped() {
                break;
            }
            let wider: Vec<f64> = budgets.iter().map(|b| factor * b).collect();
            judged = self.judge(&wider);
            // Distances may be larger than the mismatch of near sides allows for.
            total = self.whole(mismatch, &judged);
        }
        out.cells = out.cells.max(judged.parts.cells);
        (judged, total)
    }

    /// The bound of distance and mismatch together, wherever either is.
    fn whole(&self, mismatch: &Mismatch, judged: &Judged) -> f64 {
        match judged.parts.verdict {
            Verdict::Holds { bound } => mismatch.with(&judged.parts.curl).total(bound),
            _ => f64::INFINITY,
        }
    }
}

/// The bound of distance and mismatch together, each of the same triangle; infinite unless distances hold.
fn together(judged: &Judged, mismatches: &[Mismatch]) -> f64 {
    match judged.parts.verdict {
        Verdict::Holds { .. } => judged.bounds.iter().zip(mismatches).fold(0.0, |m, (b, own)| m.max(own.total(*b))),
        _ => f64::INFINITY,
    }
}

/// Whether a place lies in a triangle, about.
fn holds(t: &[[f64; 2]; 3], p: &[f64; 2]) -> bool {
    let side = |a: &[f64; 2], b: &[f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let sides = [side(&t[0], &t[1]), side(&t[1], &t[2]), side(&t[2], &t[0])];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// Triangles of a label.
fn region(partition: &Partition, label: u32) -> Vec<[[f64; 2]; 3]> {
    let corner = |&k: &u32| partition.vertices.get(k as usize).copied();
    partition
        .triangles
        .iter()
        .zip(&partition.labels)
        .filter(|(_, &l)| l == label)
        .filter_map(|(t, _)| Some([corner(&t[0])?, corner(&t[1])?, corner(&t[2])?]))
        .collect()
}
