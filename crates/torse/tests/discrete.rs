//! Discrete torses and decompositions through the public interface: sequences of planes with known shapes, and laws
//! that hold for all strips.

use proptest::prelude::*;
use torse::certify::quads::gap_bound;
use torse::control::Control;
use torse::design::discrete::planarise::{planarise, Hold, PlanariseOptions, PlanariseStatus};
use torse::design::discrete::subdivide::{subdivide, SubdivideOptions};
use torse::fit::elements::decompose::{decompose, DecomposeOptions};
use torse::geom::Vec3;
use torse::torse::kind::TangentPlane;
use torse::torse::quad_strip::QuadStrip;

#[test]
fn recorded_sequences_of_planes_are_told_apart() {
    let cases: serde_json::Value = serde_json::from_str(include_str!("data/decompose.json")).expect("json");
    for case in cases.as_array().expect("cases") {
        let number = |v: &serde_json::Value| v.as_f64().expect("a number");
        let planes: Vec<TangentPlane> = case["planes"]
            .as_array()
            .expect("planes")
            .iter()
            .map(|p| TangentPlane {
                normal: Vec3::new(number(&p[0]), number(&p[1]), number(&p[2])),
                // Recorded as n·x + n₀ = 0.
                offset: -number(&p[3]),
            })
            .collect();
        let noise = number(&case["noise"]).max(1e-7);
        let runs = decompose(&planes, &DecomposeOptions { noise, ..DecomposeOptions::default() }).expect("runs");
        let names: Vec<&str> = runs.iter().map(|r| r.shape.name()).collect();
        let labels: Vec<&str> = case["labels"].as_array().expect("labels").iter().filter_map(|l| l.as_str()).collect();
        assert_eq!(names, labels);
        for (run, place) in runs[1..].iter().zip(case["breaks"].as_array().expect("breaks")) {
            assert!((run.first as f64 - number(place)).abs() <= 2.0);
        }
    }
}

/// The strip whose limit has continuous curvature: a circle's polygon and a smaller, turned one that rises.
#[test]
fn bends_of_the_recorded_strip_jump_less_with_every_level() {
    let a = (0..6).map(|k| 0.4 * f64::from(k)).map(|t| Vec3::new(t.cos(), t.sin(), 0.0)).collect();
    let b = [
        [1.4700998667618626, 0.158935464636049, 1.0],
        [1.2380034223645173, 0.4517139787160284, 1.08],
        [0.8104534588022096, 0.6731767878463173, 1.16],
        [0.2549507143503612, 0.7883597839907682, 1.24],
        [-0.3408031420396307, 0.7790781047025561, 1.32],
        [-0.8827516758830187, 0.6467971230556722, 1.4],
    ];
    let strip = QuadStrip::new(a, b.map(Vec3::from).to_vec()).expect("a strip");
    let done = subdivide(&strip, &SubdivideOptions::new(6, Hold::Nothing), &Control::default()).expect("levels");
    assert!(done.plane() && done.levels.iter().all(|l| l.warp <= 1e-12 && l.steps <= 25));
    for w in done.levels[2..].windows(2) {
        assert!(w[1].bend_jump <= 0.75 * w[0].bend_jump);
    }
    assert!(done.levels[6].bend_jump < 0.1 * done.levels[1].bend_jump);
}

/// Strips about a curved band, each point moved a little.
fn strips() -> impl Strategy<Value = QuadStrip> {
    let moves = proptest::collection::vec(-0.06f64..0.06, 6 * 12);
    (2usize..12, 0.1f64..0.35, -0.3f64..0.4, 1e-3f64..1e4, moves).prop_map(|(n, step, turn, scale, moves)| {
        let side = |k: usize, radius: f64, z: f64, turn: f64| -> Vec<Vec3> {
            (0..n)
                .map(|i| {
                    let (s, c) = (step * i as f64 + turn).sin_cos();
                    let m = &moves[6 * i + 3 * k..6 * i + 3 * k + 3];
                    (Vec3::new(radius * c, radius * s, z) + Vec3::new(m[0], m[1], m[2]) * step) * scale
                })
                .collect()
        };
        QuadStrip::new(side(0, 1.0, 0.0, 0.0), side(1, 1.3, 0.9, turn)).expect("rulings have length")
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn planarised_strips_are_plane_and_develop_without_strain(strip in strips()) {
        let done = planarise(&strip, &PlanariseOptions::default(), &Control::default()).expect("an answer");
        prop_assert!(done.status == PlanariseStatus::Plane, "{:?} {:e}", done.status, done.warp);
        let s = &done.strip;
        let size = s.size();
        prop_assert!(s.largest_warp() <= 1e-12);
        for i in 0..s.quads() {
            prop_assert!(gap_bound(s, i).value() <= 1e-11 * size);
        }
        let [a, b] = s.development();
        for i in 0..s.quads() {
            for (flat, space) in [
                ((a[i + 1] - a[i]).norm(), (s.a()[i + 1] - s.a()[i]).norm()),
                ((b[i + 1] - b[i]).norm(), (s.b()[i + 1] - s.b()[i]).norm()),
                ((b[i + 1] - a[i]).norm(), (s.b()[i + 1] - s.a()[i]).norm()),
            ] {
                prop_assert!((flat - space).abs() <= 1e-12 * size);
            }
        }
    }

    #[test]
    fn a_corner_moved_out_of_its_plane_is_seen(strip in strips(), share in 0.0f64..1.0) {
        let plane = planarise(&strip, &PlanariseOptions::default(), &Control::default()).expect("an answer").strip;
        let i = ((plane.quads() as f64 * share) as usize).min(plane.quads() - 1);
        let (n, _) = plane.plane(i).expect("a plane");
        let far = 1e-3 * plane.size();
        let mut a = plane.a().to_vec();
        a[i + 1] += n * far;
        let moved = QuadStrip::new(a, plane.b().to_vec()).expect("a strip");
        prop_assert!(gap_bound(&moved, i).value() > 0.1 * far);
    }
}
