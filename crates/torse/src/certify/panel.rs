//! The proof for one panel: distance, boundary, rounding, developability and simple loops, put together.
//!
//! *Theorem* \[certificate, 1\], in the form of [`boundary`](super::boundary): with D, δ, η the bounds of distance,
//! boundary and rounding, and κ the curvature of the torse along the boundary, the trimmed panel in the file and its
//! part of the face are within `√((D + κδ²/2)² + δ²) + η` of each other, in both directions. Where faces of the file
//! were joined, their points moved by at most a known bound (`Face::joint_bound`), which is added to η: the bound is
//! one to the faces of the file.

use super::boundary::Boundary;
use super::coverage::loops_bound_triangles;
use super::developable::{developability, trim_boxes, ANGLE_LIMIT};
use super::distance::{judge, DistanceOptions};
use super::family::Family;
use super::prepared::Prepared;
use super::rounding::rounding_bound;
use super::ruled::{Ruled, RuledJets};
use super::simple::{loops_are_simple, stays_within};
use super::{PanelCertificate, Resistance, Verdict};
use crate::control::Control;
use crate::geom::partition::Partition;
use crate::num::interval::Interval;
use crate::spline::surface::Surface;
use crate::surface::panel::Panel;
use rayon::prelude::*;

/// A panel that is not within the tolerance is looked at again with these multiples of it, so that the report can
/// state a bound all the same.
const SECOND_LOOKS: [f64; 4] = [1.1, 1.5, 3.0, 10.0];

/// Everything proven about a panel, and its patch ready for the seams. `moved`: bound (mm) of what joining faces moved.
pub(super) fn panel_certificate(
    panel: &Panel,
    partition: &Partition,
    prepared: &Prepared,
    moved: f64,
    tolerance: f64,
    control: &Control,
) -> (PanelCertificate, Option<RuledJets>) {
    let mut out = PanelCertificate::blank();
    let mut reasons: Vec<String> = Vec::new();
    let triangles = region(partition, panel.label);
    let (Some(family), Some(ruled)) = (Family::new(&panel.torse), Ruled::new(&panel.patch)) else {
        out.reason =
            "the torse is not a C¹ spline of degree at most 3, or the patch is not ruled with positive weights".into();
        return (out, None);
    };
    if triangles.is_empty() {
        out.reason = "the panel has no region".into();
        return (out, None);
    }

    // The file's patch against the exact torse; developability from the file's control points.
    match rounding_bound(&family, &ruled) {
        Some(bound) => out.rounding_bound = (bound + written(&panel.patch)) * (1.0 + 4.0 * f64::EPSILON),
        None => reasons.push("the patch cannot be compared with the exact torse".into()),
    }
    let shape = developability(&ruled, &trim_boxes(panel.loops.iter().flatten().map(|r| &r.trim)));
    out.developability_bound = shape.angle;
    if shape.angle > ANGLE_LIMIT {
        reasons.push(format!("tangent planes along a ruling may differ by {:.1e} rad", shape.angle));
    } else if !shape.regular {
        reasons.push("the regression curve may lie inside the patch".into());
    }

    // Boundary.
    let origin = [family.origin.x, family.origin.y, family.origin.z];
    let jets = RuledJets::new(&ruled, &origin);
    let boundary = Boundary { family: &family, jets: &jets, prepared, tolerance };
    let runs: Vec<_> = panel.loops.iter().flatten().collect();
    let bounds: Vec<_> = runs.par_iter().map(|run| boundary.run_bound(run, &partition.vertices)).collect();
    let (mut delta, mut curvature) = (Some(0.0f64), 0.0f64);
    for b in &bounds {
        match b {
            Ok(b) => {
                delta = delta.map(|d| d.max(b.bound));
                curvature = curvature.max(b.curvature);
            }
            Err(obstacle) => {
                reasons.push(format!("{} at ({:.6}, {:.6})", obstacle.reason, obstacle.uv[0], obstacle.uv[1]));
                delta = None;
                break;
            }
        }
    }
    out.boundary_bound = delta.unwrap_or(f64::INFINITY);
    if let Err(reason) = loops_bound_triangles(partition, panel) {
        reasons.push(reason);
    }
    let curves: Vec<Vec<_>> = panel.loops.iter().map(|l| l.iter().map(|r| &r.trim).collect()).collect();
    if let Err(reason) = loops_are_simple(&curves) {
        reasons.push(reason.into());
    }
    let (t0, t1) = jets.domain();
    if !curves.iter().flatten().all(|c| stays_within(c, [t0, 0.0], [t1, 1.0])) {
        reasons.push("a trimming curve leaves the patch".into());
    }

    // Distance, within what boundary and rounding have left of the tolerance.
    let eta = (Interval::point(out.rounding_bound) + Interval::point(moved)).hi;
    let mismatch = Mismatch { delta: delta.unwrap_or(0.0), curvature, eta };
    let options = DistanceOptions::default();
    let mut budget = mismatch.budget(tolerance);
    if budget <= 0.0 {
        reasons.push("rounding and trimming curves use up the tolerance".into());
        budget = tolerance;
    }
    let (mut judgement, mut feet) = judge(prepared, &panel.torse, &triangles, budget, &options, control);
    match &judgement.verdict {
        Verdict::Holds { .. } => {}
        Verdict::Fails { uv, distance } => {
            let place = format!("{:.6} mm away at ({:.6}, {:.6})", distance.abs(), uv[0], uv[1]);
            if distance.abs() > tolerance {
                out.witness = Some((*uv, *distance));
                reasons.push(format!("the face is {place}"));
            } else {
                reasons.push(format!("the face is {place}; rounding and trimming curves leave {budget:.6} mm"));
            }
        }
        Verdict::Undecided { uv, reason } => {
            reasons.push(format!("{} at ({:.6}, {:.6})", words(*reason), uv[0], uv[1]));
        }
    }
    let cells = judgement.cells;
    if !matches!(judgement.verdict, Verdict::Holds { .. }) {
        for factor in SECOND_LOOKS {
            if control.stopped() {
                break;
            }
            (judgement, feet) = judge(prepared, &panel.torse, &triangles, factor * budget, &options, control);
            if matches!(judgement.verdict, Verdict::Holds { .. }) {
                break;
            }
        }
    }
    out.cells = cells.max(judgement.cells);
    if let Verdict::Holds { bound } = judgement.verdict {
        out.distance_bound = bound;
        out.min_bend_radius = judgement.min_bend_radius;
        out.regression_clearance = judgement.regression_clearance;
        if let Some(b) = bounds.iter().flatten().find(|b| !b.agrees_with(&feet)) {
            let uv = b.start.0;
            reasons.push(format!("a trimming curve belongs to another foot at ({:.6}, {:.6})", uv[0], uv[1]));
        } else if let Some(delta) = delta {
            out.deviation_bound = mismatch.total(bound);
            out.regression_clearance = (out.regression_clearance - delta - out.rounding_bound).max(0.0);
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

/// What boundary and rounding add to the distance.
#[derive(Clone, Copy, Debug)]
struct Mismatch {
    delta: f64,
    curvature: f64,
    eta: f64,
}

impl Mismatch {
    /// `√((D + κδ²/2)² + δ²) + η`, rounded up.
    fn total(&self, distance: f64) -> f64 {
        let square = Interval::point(self.delta).sqr();
        let normal = Interval::point(distance) + (square * self.curvature).scale_exact(0.5);
        ((normal.sqr() + square).sqrt() + Interval::point(self.eta)).hi
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

/// Distance (mm) that writing may add: files hold points divided by their weights, each coordinate rounded once;
/// the surface moves no more than its control points.
fn written(patch: &Surface) -> f64 {
    let b = patch.bbox();
    2.0 * f64::EPSILON * b.min.amax().max(b.max.amax())
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
fn words(reason: Resistance) -> &'static str {
    match reason {
        Resistance::Foot => "no unique regular foot on the torse could be shown",
        Resistance::Fold => "the foot map may fold over",
        Resistance::Degenerate => "the surface's parametrisation degenerates, or a triangle crosses a knot line",
        Resistance::Bound => "the bound stays above the tolerance",
        Resistance::Budget => "too many triangles were needed",
        Resistance::Stopped => "the proof was stopped",
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
