//! Laws of what the loops are made of: rails go on smoothly beyond their ends, and what is used of them adds up.

use super::strips::loft_ends::{extended, lengths, Extension};
use crate::design::loft::track::Track;
use crate::geom::generated::{frame, powers_of_ten, vector};
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::torse::rail::{jet, tangent, Rail};
use proptest::prelude::*;

/// An open rail of one cubic along x, or of three that meet in corners, from nearly straight ones to strongly bent ones.
fn rail() -> impl Strategy<Value = Rail> {
    let control = proptest::collection::vec(vector(), 10);
    (control, powers_of_ten(-9.0..0.0), frame(1e3), powers_of_ten(-1.0..3.0), any::<bool>()).prop_map(
        |(control, bend, place, size, single)| {
            let at = |i: usize| {
                let c = control[i];
                let p = Vec3::new(i as f64 + 0.3 * c.x * bend, c.y * bend, c.z * bend) * size;
                let [x, y, z] = place.to_world(&p).into();
                [x, y, z, 1.0]
            };
            let piece = |k: usize| {
                let knots = [[0.0; 4], [1.0; 4]].concat();
                Curve::new(3, knots, (3 * k..3 * k + 4).map(at).collect()).expect("a cubic")
            };
            let pieces: Vec<Curve<4>> = (0..if single { 1 } else { 3 }).map(piece).collect();
            Rail::new("r", &pieces).expect("a rail")
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn rails_go_on_smoothly_beyond_their_ends(rail in rail(), line in any::<bool>()) {
        let how = if line { Extension::Line } else { Extension::Curve };
        let longer = extended(&rail, how);
        prop_assert_eq!(longer.pieces.len(), rail.pieces.len() + 2);
        prop_assert_eq!(&longer.pieces[1..=rail.pieces.len()], &rail.pieces[..]);
        let length = rail.length();
        let n = longer.pieces.len();
        for (a, b, added) in [(0, 1, 0), (n - 2, n - 1, n - 1)] {
            let (p, q) = (&longer.pieces[a], &longer.pieces[b]);
            let ([x, ..], [y, ..]) = (jet(p, 1.0), jet(q, 0.0));
            prop_assert!((x - y).norm() < 1e-9 * length + 1e-12 * x.norm(), "{x} {y}");
            let (s, t) = (tangent(p, 1.0), tangent(q, 0.0));
            prop_assert!((s - t).norm() < 1e-6, "{s} {t}");
            // Half as long as the rail, or a turn of 1.2 rad.
            let own = longer.piece_length(added, 1.0);
            let share = own / (0.5 * length);
            prop_assert!(share < 1.0 + 1e-6 && (!line || share > 1.0 - 1e-6), "{own} {length}");
            let [c, d] = [0.0, 1.0].map(|t| tangent(&longer.pieces[added], t));
            prop_assert!(c.angle(&d) < 1.2 + 1e-6);
            prop_assert!(own > 0.49 * length || c.angle(&d) > 1.19, "{own} {length} {}", c.angle(&d));
        }
    }

    #[test]
    fn what_is_used_of_a_rail_and_added_to_it_is_what_a_run_follows(rail in rail(), ends in [0.0..1.0f64, 0.0..1.0]) {
        let longer = extended(&rail, Extension::Curve);
        let track = Track::new(&longer);
        let (from, to) = (ends[0].min(ends[1]) * track.end(), ends[0].max(ends[1]) * track.end());
        let ([x, y], [before, behind]) = lengths(&longer, from, to, true);
        let followed = track.length_to(to) - track.length_to(from);
        let own = longer.length_to(longer.pieces.len() as f64 - 1.0) - longer.length_to(1.0);
        let near = 1e-6 * longer.length();
        prop_assert!(x >= 0.0 && x <= y && y <= own + near && before >= 0.0 && behind >= 0.0);
        prop_assert!((own - rail.length()).abs() < near, "{own} {}", rail.length());
        // A run inside an extension follows less than what is beyond the end.
        if x < y {
            prop_assert!((before + (y - x) + behind - followed).abs() < near, "{before} {x} {y} {behind} {followed}");
        }
        let ([x, y], none) = lengths(&longer, from, to, false);
        prop_assert!(none == [0.0; 2] && (y - x - followed).abs() < near);
    }
}
