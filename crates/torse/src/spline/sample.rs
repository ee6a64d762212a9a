//! Random curves and surfaces for property tests: any degree up to five, repeated and nearly repeated knots.

use super::curve::Curve;
use super::knots::Knots;
use super::surface::Surface;
use crate::geom::Vec3;
use proptest::prelude::*;

/// Clamped knots on [0, 1] with up to four interior values of any allowed multiplicity, not closer than 0.02.
pub(crate) fn any_knots(degrees: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Knots> {
    (degrees, prop::collection::vec((0.02..0.98f64, 1usize..=6), 0..4)).prop_map(|(degree, inner)| {
        let mut inner = inner;
        inner.sort_by(|a, b| a.0.total_cmp(&b.0));
        inner.dedup_by(|b, a| b.0 - a.0 < 0.02);
        let mut values = vec![0.0; degree + 1];
        for (value, multiplicity) in inner {
            values.extend(std::iter::repeat_n(value, multiplicity.min(degree)));
        }
        values.extend(vec![1.0; degree + 1]);
        let control = values.len() - degree - 1;
        Knots::new(degree, values, control).expect("valid knots")
    })
}

/// Curves of space with control points in a cube of half side 10.
pub(crate) fn any_curve() -> impl Strategy<Value = Curve<3>> {
    any_knots(1..=5).prop_flat_map(|knots| {
        let n = knots.control_count();
        prop::collection::vec(prop::array::uniform3(-10.0..10.0f64), n)
            .prop_map(move |control| Curve { knots: knots.clone(), control })
    })
}

/// Rational surfaces with weights between 1/4 and 4.
pub(crate) fn any_surface() -> impl Strategy<Value = Surface> {
    (any_knots(1..=4), any_knots(1..=4)).prop_flat_map(|(ku, kv)| {
        let n = ku.control_count() * kv.control_count();
        prop::collection::vec((prop::array::uniform3(-10.0..10.0f64), -2.0..2.0f64), n).prop_map(move |net| {
            let points: Vec<Vec3> = net.iter().map(|(p, _)| Vec3::new(p[0], p[1], p[2])).collect();
            let weights: Vec<f64> = net.iter().map(|(_, w)| w.exp2()).collect();
            Surface::new(ku.clone(), kv.clone(), &points, Some(&weights)).expect("valid surface")
        })
    })
}
