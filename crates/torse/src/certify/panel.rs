//! The proof for one panel: distance, boundary, rounding, developability and simple loops, put together.
//!
//! *Theorem* \[certificate, 1\], in the form of [`boundary`](super::boundary): with D, δ, η the bounds of distance,
//! boundary and rounding, and κ the curvature of the torse along the boundary, the trimmed panel in the file and its
//! part of the face are within `√((D + κδ²/2)² + δ²) + η` of each other, in both directions. Where faces of the file
//! were joined, their points moved by at most a known bound (`Face::joint_bound`), which is added to η: the bound is
//! one to the faces of the file. So is the bound of [`edges`](super::edges): a panel bounded by its edges in space
//! instead of its trimming curves is as near.

use super::boundary::{Boundary, RunBound};
use super::certificate::PanelParts;
use super::coverage::loops_bound_triangles;
use super::developable::{developability, trim_boxes, Developability, ANGLE_LIMIT};
use super::distance::{judge, way_total, Curl, DistanceOptions, Feet, JudgementParts};
use super::edges::edge_bound;
use super::family::Family;
use super::prepared::Prepared;
use super::rounding::rounding_bound;
use super::ruled::{Ruled, RuledJets};
use super::seams::SeamSide;
use super::simple::{loops_are_simple, stays_within};
use super::verdict::{Obstruction, Verdict};
use super::written::reserve;
use crate::control::Control;
use crate::geom::place_in_words;
use crate::num::interval::Interval;
use crate::patchwork::panel::{Coedge, Panel, PanelTrim};
use crate::patchwork::partition::Partition;
use crate::spline::surface::Surface;
use crate::torse::form::Torse;
use rayon::prelude::*;

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
}

/// Everything proven about a panel, and its patch ready for the seams.
pub(super) fn panel_certificate(
    panel: &Panel,
    ground: &Ground,
    tolerance: f64,
    control: &Control,
) -> (PanelParts, Option<RuledJets>) {
    let &Ground { partition, prepared, moved } = ground;
    let mut out = PanelParts::blank();
    let Some(trim) = &panel.trim else {
        out.reason = "the panel covers no face".into();
        return (out, None);
    };
    let Some(torse) = trim.form.torse() else {
        out.reason = "the panel is not developable".into();
        return (out, None);
    };
    let triangles = region(partition, trim.label);
    let (Some(family), Some(ruled)) = (Family::new(torse), Ruled::new(&panel.strip.patch)) else {
        out.reason =
            "the torse is not a C¹ spline of degree at most 3, or the patch is not ruled with positive weights".into();
        return (out, None);
    };
    if triangles.is_empty() {
        out.reason = "the panel has no region".into();
        return (out, None);
    }
    let mut reasons = Vec::new();
    let shape = patch_bounds(&mut out, panel, &family, &ruled, &mut reasons);
    let origin = [family.origin.x, family.origin.y, family.origin.z];
    let jets = RuledJets::new(&ruled, &origin);
    let boundary = Boundary { family: &family, jets: &jets, prepared, tolerance };
    let edge = boundary_bounds(trim, (partition, prepared.surface), &boundary, &mut reasons);
    out.boundary_bound = edge.delta.unwrap_or(f64::INFINITY);

    // The edges in space that go with the trimming curves.
    match edges(panel, &jets, tolerance) {
        Some(bound) => out.edge_bound = bound,
        None => reasons.push("an edge in space cannot be compared with its trimming curve".into()),
    }

    // Distance, within what boundary, edges and rounding have left of the tolerance.
    let beside = if out.edge_bound.is_finite() { out.edge_bound } else { 0.0 };
    let eta = (Interval::point(out.rounding_bound) + Interval::point(moved) + Interval::point(beside)).hi;
    let mismatch = Mismatch { delta: edge.delta.unwrap_or(0.0), curvature: edge.curvature, eta };
    let region = Region { prepared, torse, triangles: &triangles, tolerance, control };
    let (judgement, feet) = region.judged(&mismatch, &mut out, &mut reasons);
    if let Verdict::Holds { bound } = judgement.verdict {
        out.distance_bound = bound;
        // Of the torse at the feet and of the patch within its trimming curves, whichever is less.
        out.min_bend_radius = judgement.min_bend_radius.min(shape.bend_radius);
        let clearance = judgement.regression_clearance.min(shape.clearance);
        if let Some(b) = edge.runs.iter().find(|b| !b.agrees_with(&feet)) {
            let uv = b.start.0;
            reasons.push(format!("a trimming curve belongs to another foot at {}", at(prepared.surface, uv)));
        } else if edge.delta.is_some() && out.edge_bound.is_finite() {
            out.deviation_bound = mismatch.with(&judgement.curl).total(bound);
            out.regression_clearance = clearance;
        }
    }
    if reasons.is_empty() && out.deviation_bound <= tolerance {
        out.certified = true;
    } else if reasons.is_empty() {
        reasons.push(format!("the bound {:.6} mm exceeds the tolerance", out.deviation_bound));
    }
    out.reason = reasons.join("; ");
    (out, Some(jets))
}

/// Bound of the distance between edges in space and trimming curves, over all runs that files have edges for.
pub(super) fn edges(panel: &Panel, jets: &RuledJets, tolerance: f64) -> Option<f64> {
    let runs: Vec<_> = panel.loops().iter().flatten().filter(|r| !r.is_point()).collect();
    let bound = |run: &&Coedge| edge_bound(SeamSide { jets, trim: &run.trim }, &run.edge, tolerance);
    let bounds: Vec<_> = runs.par_iter().map(bound).collect();
    bounds.into_iter().try_fold(0.0f64, |most, b| b.filter(|b| !b.is_nan()).map(|b| most.max(b)))
}

/// The file's patch against the exact torse; developability and regularity from the file's control points.
fn patch_bounds(
    out: &mut PanelParts,
    panel: &Panel,
    family: &Family,
    ruled: &Ruled,
    reasons: &mut Vec<String>,
) -> Developability {
    match rounding_bound(family, ruled) {
        Some(bound) => out.rounding_bound = (bound + reserve(&panel.strip.patch)) * (1.0 + 4.0 * f64::EPSILON),
        None => reasons.push("the patch cannot be compared with the exact torse".into()),
    }
    let shape = developability(ruled, &trim_boxes(panel.loops().iter().flatten().map(|r| &r.trim)));
    out.developability_bound = shape.angle;
    if shape.angle > ANGLE_LIMIT {
        reasons.push(format!("tangent planes along a ruling may differ by {:.1e} rad", shape.angle));
    } else if !shape.regular {
        reasons.push("the regression curve may lie inside the patch".into());
    }
    shape
}

/// What was shown about a panel's boundary.
struct Edge {
    runs: Vec<RunBound>,
    /// Bound of the mismatch, mm, if there is one.
    delta: Option<f64>,
    curvature: f64,
}

/// A place on a surface in words.
fn at(surface: &Surface, uv: [f64; 2]) -> String {
    place_in_words(&surface.point(uv[0], uv[1]))
}

/// A length with three digits.
fn short(x: f64) -> String {
    let digits = if x > 0.0 && x.is_finite() { (2 - x.log10().floor() as i32).clamp(0, 12) } else { 3 };
    format!("{x:.*}", digits as usize)
}

/// The trimming curves: near the images of the region's boundary, all around the region, simple, and on the patch.
fn boundary_bounds(
    trim: &PanelTrim,
    (partition, surface): (&Partition, &Surface),
    boundary: &Boundary,
    reasons: &mut Vec<String>,
) -> Edge {
    let runs: Vec<_> = trim.loops.iter().flatten().collect();
    let bounds: Vec<_> = runs.par_iter().map(|run| boundary.run_bound(run, &partition.vertices)).collect();
    let mut edge = Edge { runs: Vec::with_capacity(bounds.len()), delta: Some(0.0), curvature: 0.0 };
    for b in bounds {
        match b {
            Ok(b) => {
                edge.delta = edge.delta.map(|d| d.max(b.bound));
                edge.curvature = edge.curvature.max(b.curvature);
                edge.runs.push(b);
            }
            Err(obstacle) => {
                reasons.push(format!("{} at {}", obstacle.reason, at(surface, obstacle.uv)));
                edge.delta = None;
                break;
            }
        }
    }
    if let Err(reason) = loops_bound_triangles(partition, trim) {
        reasons.push(reason);
    }
    let curves: Vec<Vec<_>> = trim.loops.iter().map(|l| l.iter().map(|r| &r.trim).collect()).collect();
    if let Err(reason) = loops_are_simple(&curves) {
        reasons.push(reason.into());
    }
    let (t0, t1) = boundary.jets.domain();
    if !curves.iter().flatten().all(|c| stays_within(c, [t0, 0.0], [t1, 1.0])) {
        reasons.push("a trimming curve leaves the patch".into());
    }
    edge
}

/// The part of a face that a panel stands for.
struct Region<'a> {
    prepared: &'a Prepared<'a>,
    torse: &'a Torse,
    triangles: &'a [[[f64; 2]; 3]],
    tolerance: f64,
    control: &'a Control,
}

impl Region<'_> {
    fn judge(&self, tolerance: f64) -> (JudgementParts, Feet) {
        let options = DistanceOptions::default();
        judge(self.prepared, self.torse, self.triangles, tolerance, &options, self.control)
    }

    /// The distance, within what boundary and rounding have left of the tolerance; if that cannot be shown, within a
    /// multiple of it, with the reason.
    fn judged(&self, mismatch: &Mismatch, out: &mut PanelParts, reasons: &mut Vec<String>) -> (JudgementParts, Feet) {
        let mut budget = mismatch.budget(self.tolerance);
        // What joining or trimming moved may be unknown: neither is a budget then.
        if budget.is_nan() || budget <= 0.0 {
            reasons.push("rounding and trimming curves use up the tolerance".into());
            budget = self.tolerance;
        }
        let (mut judgement, mut feet) = self.judge(budget);
        if let Verdict::Holds { bound } = judgement.verdict {
            // Where the region folds at its rim, ways are longer: less is left.
            let longer = mismatch.with(&judgement.curl);
            let less = longer.budget(self.tolerance);
            if judgement.curl.way > 0.0 && longer.total(bound) > self.tolerance && less > 0.0 {
                budget = less;
                (judgement, feet) = self.judge(budget);
            }
        }
        match &judgement.verdict {
            Verdict::Holds { .. } => {}
            Verdict::Fails { uv, distance } => {
                let place = format!("{} mm away at {}", short(distance.abs()), at(self.prepared.surface, *uv));
                if distance.abs() > self.tolerance {
                    out.witness = Some((*uv, *distance));
                    reasons.push(format!("the face is {place}"));
                } else {
                    reasons
                        .push(format!("the face is {place}; rounding and trimming curves leave {} mm", short(budget)));
                }
            }
            Verdict::Undecided { uv, reason } => {
                reasons.push(format!("{} at {}", words(*reason), at(self.prepared.surface, *uv)));
            }
        }
        out.cells = judgement.cells;
        for factor in SECOND_LOOKS {
            if matches!(judgement.verdict, Verdict::Holds { .. }) || self.control.stopped() {
                break;
            }
            (judgement, feet) = self.judge(factor * budget);
        }
        out.cells = out.cells.max(judgement.cells);
        (judgement, feet)
    }
}

/// What boundary, edges and rounding add to the distance.
#[derive(Clone, Copy, Debug)]
struct Mismatch {
    delta: f64,
    curvature: f64,
    eta: f64,
}

impl Mismatch {
    /// `√((D + κδ²/2)² + δ²) + η`, rounded up.
    fn total(&self, distance: f64) -> f64 {
        way_total(distance, self.delta, self.curvature, self.eta)
    }

    /// The mismatch where a region folds at its rim: ways to the trimming curves are longer by the ways to the rim.
    fn with(&self, curl: &Curl) -> Self {
        Self {
            delta: (Interval::point(self.delta) + Interval::point(curl.way)).hi,
            curvature: self.curvature.max(curl.curvature),
            ..*self
        }
    }

    /// A distance for which [`Mismatch::total`] stays within the tolerance; not positive when there is none.
    fn budget(&self, tolerance: f64) -> f64 {
        // A few roundings, each of a unit in the last place of the tolerance.
        const ROUNDING: f64 = 16.0 * f64::EPSILON;
        let rest = tolerance * (1.0 - ROUNDING) - self.eta;
        if rest <= self.delta || rest.is_nan() {
            return 0.0;
        }
        let square = self.delta * self.delta;
        (rest * rest - square).sqrt() - 0.5 * self.curvature * square - ROUNDING * tolerance
    }
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

/// What a resistance means.
fn words(reason: Obstruction) -> &'static str {
    match reason {
        Obstruction::Foot => "no unique regular foot on the torse could be shown",
        Obstruction::Fold => "the foot map may fold over",
        Obstruction::Degenerate => "the surface's parametrisation degenerates, or a triangle crosses a knot line",
        Obstruction::Bound => "the bound stays above the tolerance",
        Obstruction::Budget => "too many triangles were needed",
        Obstruction::Stopped => "the proof was stopped",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_keeps_the_total_within_the_tolerance() {
        for (delta, curvature, eta) in [(0.0, 0.0, 0.0), (0.07, 0.5, 1e-9), (0.5, 0.1, 1e-3), (0.9, 0.0, 0.05)] {
            let m = Mismatch { delta, curvature, eta };
            let d = m.budget(1.0);
            assert!(d > 0.0 && m.total(d) <= 1.0 && m.total(d) > 1.0 - 1e-12, "{m:?} {d}");
        }
        assert!(Mismatch { delta: 1.0, curvature: 0.0, eta: 0.0 }.budget(1.0) <= 0.0);
        assert!(Mismatch { delta: 0.0, curvature: 0.0, eta: f64::INFINITY }.budget(1.0) <= 0.0);
    }
}
