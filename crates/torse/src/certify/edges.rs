//! Edges in space against the trimming curves that they accompany.
//!
//! A STEP file holds every edge twice: as a curve in space, which it calls the master, and as a curve in the parameter
//! plane of the patch. `|E(s) − R(θ(s))|` is bounded on [0, 1] as gaps of seams are \[certificate, 5\]: whoever builds the
//! panel's boundary from the one instead of the other moves it by no more than that.

use super::boundary::{clamped, trim_piece};
use super::curve_model::CurveModel;
use super::seams::SeamSide;
use super::vector::{length_bound, V3};
use crate::num::greatest::greatest;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::spline::curve::Curve;

/// Pieces are halved until their enclosures exceed the greatest distance seen by less than this share of the
/// tolerance, half of what edges are made to keep to.
const EXCESS: f64 = 2e-4;

/// Bound (mm) of the distance between an edge in space and its trimming curve on the patch, at equal parameters. `None`
/// if the curve leaves the patch, or the edge is not a clamped spline of finite numbers over [0, 1].
pub(super) fn edge_bound(side: SeamSide, edge: &Curve<3>, tolerance: f64) -> Option<f64> {
    let whole = edge.control.len() == edge.knots.control_count() && edge.knots.degree() > 0;
    if !(whole && clamped(edge) && edge.control.iter().flatten().all(|x| x.is_finite())) {
        return None;
    }
    let mut cuts = side.cuts();
    cuts.extend(edge.knots.breaks());
    greatest(cuts, EXCESS * tolerance, |s0, s1| {
        let in_space: V3<Vec<Interval>> = trim_piece(edge, s0, s1);
        let relative = [0, 1, 2].map(|d: usize| {
            let origin = Interval::point(side.jets.origin[d]);
            in_space[d].iter().map(|&c| c - origin).collect::<Vec<_>>()
        });
        if let (Some(in_space), Some(on_patch)) = (CurveModel::of_bernstein(&relative), side.model(s0, s1, false)) {
            return Some(in_space.minus(&on_patch).size());
        }
        let on_patch = side.over(s0, s1, false)?;
        let last = relative[0].len() - 1;
        let ends = [(0, 0), (1, last)].map(|(k, i)| [0, 1, 2].map(|d: usize| relative[d][i] - on_patch.ends[k][d]));
        let spread = [0, 1, 2].map(|d: usize| {
            let difference = Jet::of_bernstein(&relative[d]) - on_patch.curve[d];
            ends[0][d].hull(ends[1][d]).widen(difference.chord_deviation(on_patch.rough))
        });
        Some((length_bound(&spread), length_bound(&ends[0]).max(length_bound(&ends[1]))))
    })
}

#[cfg(test)]
mod tests {
    use super::super::ruled::{Ruled, RuledJets};
    use super::super::specimens::two_panels;
    use super::*;
    use crate::geom::Vec3;

    #[test]
    fn samples_stay_below_and_a_bump_between_them_is_seen() {
        let p = two_panels(1e-3, 4);
        let panel = &p.panels[0];
        let jets = RuledJets::new(&Ruled::new(&panel.strip.patch).expect("ruled"), &[0.0; 3]);
        for run in panel.loops().iter().flatten() {
            let side = SeamSide { jets: &jets, trim: &run.trim };
            let bound = edge_bound(side, &run.edge, 1e-3).expect("a bound");
            let mut worst = 0.0f64;
            for i in 0..=1000 {
                let s = f64::from(i) / 1000.0;
                let q = run.trim.point(s);
                worst = worst.max((panel.strip.patch.point(q[0], q[1]) - Vec3::from(run.edge.point(s))).norm());
            }
            assert!(worst <= bound && bound < 1.05 * worst + 1e-6, "{worst:e} {bound:e}");
            // A spike between knots so close that no sampling finds it.
            let (a, b) = (0.5123, 0.5123 + 1e-9);
            let mut spiked = run.edge.with_knots(&[a, a, a, b, b, b]).expect("knots");
            let k = spiked.knots.span(0.5 * (a + b)) - 1;
            spiked.control[k][2] += 5.0;
            let seen = edge_bound(side, &spiked, 1e-3).expect("a bound");
            assert!(seen > 1.0, "{seen}");
            spiked.control[k][2] = f64::NAN;
            assert_eq!(edge_bound(side, &spiked, 1e-3), None);
        }
    }
}
