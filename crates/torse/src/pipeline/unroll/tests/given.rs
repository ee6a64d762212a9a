//! Surfaces that are given a thickness, and sheet that bends both ways: their flat parts are those of the neutral fibre.

use super::model_of;
use crate::answer::note::{Note, ShopNote};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::{Evidence, Status, What};
use crate::control::Control;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{quarter, rectangle, round_surface};
use crate::geom::Vec3;
use crate::io::model::Model;
use crate::io::step::write::{self as step, Header};
use crate::patchwork::pattern::BendSense;
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::pipeline::workshop::{prepare, Stations, WorkshopOptions};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

const THICKNESS: f64 = 4.0;
const K: f64 = 0.42;
const SIDES: [SheetSide; 3] = [SheetSide::Inside, SheetSide::Middle, SheetSide::Outside];

/// The answer for surfaces of a sheet, with its work.
fn made(model: &Model, (thickness, side, k): (f64, SheetSide, KFactor), stations: Vec<Stations>) -> Answer {
    let sheet = Some(Sheet { thickness, side, k: k.clone() });
    let options = UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(0.01) };
    let mut answer = unroll(model, &options, &Control::default()).expect("an answer");
    let asked =
        WorkshopOptions { thickness: Some(thickness), side, k: Some(k), stations, ..WorkshopOptions::default() };
    prepare(&mut answer, &asked).expect("its work");
    answer
}

/// Inside radius of a part whose surface has a radius.
fn inside(answer: &Answer, radius: f64, side: SheetSide) -> f64 {
    let [low, high] = side.extent(THICKNESS);
    match answer.patterns[0].bends[0].sense {
        BendSense::Up => radius - high,
        _ => radius + low,
    }
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * b.abs(), "{a} {b}");
}

#[test]
fn cylinders_and_cones_are_as_long_as_their_neutral_fibre() {
    let cylinder = || quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
    let flange = rectangle(Vec3::new(50.0, -20.0, 0.0), 20.0 * Vec3::y(), 30.0 * Vec3::z());
    for side in SIDES {
        let sheet = || (THICKNESS, side, KFactor::Ansi(K));
        let across = Stations { normal: Vec3::z(), name: "z".into(), from: 10.0, to: 20.0, step: 10.0 };
        let answer = made(&model_of(vec![cylinder()]), sheet(), vec![across]);
        let length = (inside(&answer, 50.0, side) + K * THICKNESS) * FRAC_PI_2;
        assert_eq!(answer.status(), Status::Certified);
        near(answer.patterns[0].area, length * 30.0);
        assert!(answer.claims.iter().any(|c| c.what() == What::LengthError && c.evidence() == Evidence::Proven));
        // Its work is known: every radius is that of the surface, sections run straight across it.
        assert!(answer.shop.work[0].roll.iter().all(|s| s.radii.iter().all(|r| (r - 50.0).abs() < 1e-6)));
        assert!(!answer.shop.work[0].roll.is_empty());
        let sections = &answer.patterns[0].sections;
        assert_eq!(sections.len(), 2);
        for s in sections {
            let ends = s.joints[s.joints.len() - 1].point - s.joints[0].point;
            assert!((ends.norm() - length).abs() < 1e-4, "{} {length}", ends.norm());
        }
        // With a flange that it goes on into, which keeps its length.
        let chain = made(&model_of(vec![flange.clone(), cylinder()]), sheet(), Vec::new());
        assert_eq!((chain.status(), chain.patterns.len()), (Status::Certified, 1));
        near(chain.patterns[0].area, (length + 20.0) * 30.0);

        let cone = round_surface(50.0, 0.5, (0.0, 40.0));
        let answer = made(&model_of(vec![cone.clone()]), sheet(), Vec::new());
        let plain = made(&model_of(vec![cone]), (THICKNESS, SheetSide::Middle, KFactor::Ansi(0.5)), Vec::new());
        assert_eq!((answer.status(), plain.status()), (Status::Certified, Status::Certified));
        // The offset of a cone at a distance is that cone, moved along its axis.
        let slant = plain.patterns[0].area / (std::f64::consts::PI * (50.0 + 50.0 + 20.0));
        let off = (answer.patterns[0].area - plain.patterns[0].area) / (2.0 * std::f64::consts::PI * slant);
        let expected = inside(&answer, 0.0, side) + K * THICKNESS;
        assert!((off - expected * 0.5_f64.atan().cos()).abs() < 1e-6, "{off} {expected}");
    }
}

#[test]
fn a_sheet_without_room_is_refused_and_the_surface_kept() {
    let faces: Vec<Face> = vec![quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0)];
    let refused = SIDES.map(|side| {
        let answer = made(&model_of(faces.clone()), (200.0, side, KFactor::Ansi(K)), Vec::new());
        if answer.status() == Status::Uncertified {
            near(answer.patterns[0].area, 50.0 * FRAC_PI_2 * 30.0);
        }
        answer.status() == Status::Uncertified
    });
    assert_eq!(refused.iter().filter(|r| **r).count(), 2, "{refused:?}");
    // The offset of an apex is a curve.
    let tip = made(
        &model_of(vec![round_surface(50.0, -0.5, (0.0, 100.0))]),
        (4.0, SheetSide::Outside, KFactor::Ansi(K)),
        Vec::new(),
    );
    assert_eq!(tip.status(), Status::Uncertified);
}

/// A cylinder over a profile with one inflection, in its middle: both halves turn by `atan(3/2) + 45°`.
pub(super) fn wave() -> Model {
    let profile = [[0.0, 0.0], [40.0, 60.0], [60.0, -60.0], [100.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let points: Vec<Vec3> = profile.iter().flat_map(|p| [*p, p + 90.0 * Vec3::y()]).collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let surface = Surface::new(knots(3), knots(1), &points, None).expect("a surface");
    let header = Header { name: "wave".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-6 };
    let bytes = step::shells(&header, &[step::Shell::untrimmed("wave", &surface)]).expect("a file");
    crate::read(&bytes).expect("a model")
}

#[test]
fn the_fibre_changes_sides_where_the_bend_does() {
    let model = wave();
    let turn = 1.5_f64.atan() + FRAC_PI_4;
    let area = |k: f64| {
        let answer = made(&model, (2.0, SheetSide::Outside, KFactor::Ansi(k)), Vec::new());
        assert_eq!(answer.status(), Status::Certified);
        let bends = &answer.sheets[0].bends;
        let [first, second] = bends.as_slice() else { panic!("a row each way: {bends:?}") };
        assert!(first.sense != second.sense && first.bends.iter().all(|b| b.sense == first.sense));
        assert!((first.angle - turn).abs() < 1e-6 && (second.angle - turn).abs() < 1e-6);
        assert!((first.k - k).abs() < 1e-9 && (second.k - k).abs() < 1e-9);
        let Some(Note::Shop(ShopNote::OfFibre { .. })) = answer.notes.last() else { panic!("{:?}", answer.notes) };
        answer.patterns[0].area
    };
    let middle = area(0.5);
    for k in [0.3, 0.44] {
        // Shorter outside, longer inside, by K and by the rest of the thickness.
        let expected = 2.0 * turn * (2.0 * k - 1.0) * 90.0;
        assert!((area(k) - middle - expected).abs() < 1e-3, "{} {expected}", area(k) - middle);
    }
}

#[test]
fn k_is_taken_at_the_inside_radius_of_every_ruling() {
    let model = wave();
    let area = |k: KFactor| made(&model, (2.0, SheetSide::Outside, k), Vec::new()).patterns[0].area;
    let share = |k: f64| area(KFactor::Ansi(k));
    // Constant over all radii that there are, then between the least and the greatest.
    let flat = KFactor::Table(vec![[0.0, 0.3], [1e9, 0.3]]);
    assert!((area(flat) - share(0.3)).abs() < 1e-6);
    let rising = area(KFactor::Table(vec![[0.0, 0.3], [200.0, 0.5]]));
    assert!(share(0.31) < rising && rising < share(0.45), "{} {rising} {}", share(0.31), share(0.45));
}
