//! Laws of rows: slopes are those of the rows wherever they are asked, and what is asked of shapes does not depend on where they lie.

use super::border::Border;
use super::coplanarity::{Coplanarity, InPlane};
use super::derivative_check::check_at;
use super::developability::{samples, KForm, NForm, StripPoints};
use super::distance::Distance;
use super::fold::Fold;
use super::handle::{OnPlane, Parallel};
use super::join::{SameCurvature, SameDirection};
use super::stencil::Stencil;
use crate::geom::generated::{frame, powers_of_ten, vector};
use crate::geom::{Frame, Vec3};
use crate::num::gauss_newton::Block;
use crate::spline::knots::Knots;
use proptest::prelude::*;

/// Points of which the second leaves the first in nearly the same direction as the third, nearer by a share.
fn points() -> impl Strategy<Value = Vec<Vec3>> {
    (proptest::collection::vec(vector(), 8), powers_of_ten(-1.3..0.0)).prop_map(|(mut p, near)| {
        p[2] = p[0] + (p[1] - p[0]) * 1.3 + p[2] * near;
        p
    })
}

fn coordinates(points: &[Vec3]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

fn difference(a: u32, b: u32) -> Stencil {
    Stencil::point(3 * b).minus(&Stencil::point(3 * a))
}

/// Blocks over differences of eight points.
fn blocks() -> Vec<Box<dyn Block>> {
    let d = difference;
    vec![
        Box::new(Distance::new(&d(0, 1), 0.7)),
        Box::new(Coplanarity::new(&d(0, 1), &d(0, 2), &d(0, 3))),
        Box::new(Fold::new(&d(0, 1), &d(2, 4), [&d(0, 3), &d(0, 5)])),
        Box::new(SameDirection::new(&d(0, 1), &d(0, 2))),
        Box::new(SameDirection::both([&d(0, 1), &d(3, 4)], [&d(0, 2), &d(3, 5)])),
        Box::new(SameCurvature::new([&d(0, 1), &d(1, 4)], [&d(0, 2), &d(2, 5)], &d(0, 6))),
    ]
}

/// Values of the unknowns of a block, renewed there, and its private unknowns.
fn begun(block: &mut dyn Block, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let local: Vec<f64> = block.unknowns().iter().map(|&i| x[i as usize]).collect();
    block.refresh(&local);
    let mut own = vec![0.0; block.private()];
    block.begin(&local, &mut own);
    (local, own)
}

fn residual(block: &mut dyn Block, x: &[f64]) -> Vec<f64> {
    let (local, own) = begun(block, x);
    let mut out = vec![0.0; block.rows()];
    block.evaluate(&local, &own, &mut out, None);
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn slopes_are_difference_quotients(points in points(), shift in vector()) {
        let x = coordinates(&points);
        for mut block in blocks() {
            let (local, mut own) = begun(block.as_mut(), &x);
            own.iter_mut().zip(shift.iter()).for_each(|(o, s)| *o += 0.1 * s);
            check_at(block.as_ref(), &local, &own);
        }
        for block in [
            Box::new(Parallel::new(&difference(0, 1), 9)) as Box<dyn Block>,
            Box::new(OnPlane::new(&Stencil::point(3), 6, 9)),
            Box::new(InPlane::new(&Stencil::point(3), 6, 9)),
        ] {
            let local: Vec<f64> = block.unknowns().iter().map(|&i| x[i as usize]).collect();
            check_at(block.as_ref(), &local, &[]);
        }
    }

    #[test]
    fn rows_of_shapes_do_not_change_when_these_are_moved(points in points(), place in frame(10.0)) {
        let moved: Vec<Vec3> = points.iter().map(|p| place.to_world(p)).collect();
        for (mut here, mut there) in blocks().into_iter().zip(blocks()) {
            let (r, s) = (residual(here.as_mut(), &coordinates(&points)), residual(there.as_mut(), &coordinates(&moved)));
            // Rows of a direction turn with it: lengths of three at a time are kept.
            let norms = |r: &[f64]| -> Vec<f64> {
                match r.len() {
                    3 | 6 => r.chunks(3).map(|c| Vec3::from_column_slice(c).norm()).collect(),
                    _ => r.to_vec(),
                }
            };
            for (a, b) in norms(&r).iter().zip(&norms(&s)) {
                prop_assert!((a - b).abs() < 1e-8 * (1.0 + a.abs()), "{r:?} {s:?}");
            }
        }
    }

    #[test]
    fn rows_of_developability_vanish_on_cones_and_on_nothing_twisted(
        control in [vector(), vector(), vector(), vector()], away in vector(), far in powers_of_ten(-0.5..7.0),
        place in frame(10.0), twist in powers_of_ten(-5.0..-1.0),
    ) {
        // A cubic along x, rulings of length about 1 across it towards an apex, which may be as far as that of a cylinder.
        let a: Vec<Vec3> = (0..4).map(|i| Vec3::new(f64::from(i), 0.0, 0.0) + control[i as usize] * 0.3).collect();
        let apex = Vec3::new(1.5, 0.0, 0.0) + Vec3::new(0.3 * away.x, -1.0, 0.3 * away.z) * (far + 0.6);
        // The apex lies behind the first curve.
        let share = 1.0 / (far + 0.6);
        let b: Vec<Vec3> = a.iter().map(|p| p + (p - apex) * share).collect();
        let mut twisted = b.clone();
        twisted[3] += (b[3] - a[3]).cross(&(a[3] - a[0])).normalize() * twist;
        let largest = |b: &[Vec3], frame: &Frame| {
            let knots = Knots::uniform(3, 1, 0.0, 1.0).expect("knots");
            let indices: Vec<u32> = (0..8).map(|i| 3 * i).collect();
            let points: Vec<Vec3> = a.iter().chain(b).map(|p| frame.to_world(p)).collect();
            let x = coordinates(&points);
            let strip = StripPoints { knots: &knots, a: &indices[..4], b: &indices[4..] };
            samples(&knots).into_iter().fold([0.0f64; 2], |worst, (u, unit)| {
                let k = residual(&mut KForm::new(strip, u, unit, 0.0), &x);
                let n = residual(&mut NForm::new(strip, u, unit), &x);
                [(worst[0], k), (worst[1], n)].map(|(w, r)| r.iter().fold(w, |m, x| m.max(x.abs())))
            })
        };
        let [k, n] = largest(&b, &place);
        prop_assert!(k < 1e-12 && n < 1e-12, "{k} {n}");
        let [k, n] = largest(&twisted, &place);
        prop_assert!(k > 0.05 * twist && n > 0.05 * twist, "{k} {n} for {twist}");
    }

    #[test]
    fn distances_from_borders_are_those_of_the_nearest_piece(
        ends in proptest::collection::vec((vector(), vector(), powers_of_ten(-9.0..0.0)), 1..12), x in vector(),
    ) {
        // Some pieces are so short that they are hardly more than points.
        let pieces: Vec<[Vec3; 2]> = ends.iter().map(|(p, d, short)| [*p, p + d * *short]).collect();
        let border = Border::new(pieces.clone()).expect("a border");
        let apart = |[p, q]: &[Vec3; 2]| {
            let least = (0..=4000).map(|k| (p + (q - p) * (f64::from(k) / 4000.0) - x).norm());
            least.fold(f64::INFINITY, f64::min)
        };
        let sampled = pieces.iter().map(apart).fold(f64::INFINITY, f64::min);
        let found = border.distance(&x);
        prop_assert!(found <= sampled + 1e-12 && found > sampled - 4.0 / 4000.0, "{found} {sampled}");
        prop_assert!(pieces.iter().flatten().all(|p| border.distance(p) < 1e-12));
    }
}
