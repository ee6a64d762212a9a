//! What is proven of the distance between the file's edges and the polygons that trims become: never too little, and
//! little where the file is sound.

use super::text::{Step, Unit};
use torse::brep::face::{Face, FilePiece};
use torse::certify::claim::{Status, What};
use torse::certify::trims::trim_proof;
use torse::control::Control;
use torse::geom::Vec3;
use torse::io::step::read::read;
use torse::io::words;
use torse::pipeline::approximate::{of_faces, Options};
use torse::search::cover::{Layout, Limits};
use torse::search::trims::{assess_trims, AssessedTrims};

const SQUARE: [[f64; 3]; 4] = [[0., 0., 0.], [100., 0., 0.], [100., 100., 0.], [0., 100., 0.]];

fn faces(s: &Step) -> Vec<Face> {
    let m = read(s.text().as_bytes()).expect("a model");
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    m.faces
}

fn on_plane(s: &mut Step, l: u64) -> Face {
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    faces(s).remove(0)
}

/// Greatest distance of points of the file's edges from the polygons: a dense search, refined where it is nearest.
fn sampled(face: &Face) -> f64 {
    let mut sides = Vec::new();
    for l in &face.loops {
        let n = l.points.len();
        sides.extend((0..n).map(|i| (l.edge[i], l.points[i], l.points[(i + 1) % n])));
    }
    let at = |&(_, p, q): &(u32, [f64; 2], [f64; 2]), s: f64| {
        face.surface.point(p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]))
    };
    let boundary = face.boundary.as_ref().expect("edges of the file");
    let mut worst = 0.0_f64;
    for e in boundary.loops.iter().flatten() {
        let own: Vec<_> = sides.iter().filter(|s| s.0 == e.label).collect();
        let places = if own.len() > 20 { 3 } else { 40 };
        for FilePiece { curve, from, to } in e.pieces.iter().flatten() {
            for k in 0..=30 {
                let h = curve.point(from + (to - from) * f64::from(k) / 30.0);
                let x = Vec3::new(h[0], h[1], h[2]) / h[3];
                let mut best = (f64::INFINITY, 0, 0.0);
                for (i, side) in own.iter().enumerate() {
                    for j in 0..=places {
                        let s = f64::from(j) / f64::from(places);
                        let d = (at(side, s) - x).norm();
                        if d < best.0 {
                            best = (d, i, s);
                        }
                    }
                }
                let step = 1.0 / f64::from(places);
                let (mut lo, mut hi) = ((best.2 - step).max(0.0), (best.2 + step).min(1.0));
                for _ in 0..40 {
                    let [a, b] = [1.0, 2.0].map(|t| lo + (hi - lo) * t / 3.0);
                    let [p, q] = [a, b].map(|s| (at(own[best.1], s) - x).norm());
                    best.0 = best.0.min(p).min(q);
                    (lo, hi) = if p < q { (lo, b) } else { (a, hi) };
                }
                worst = worst.max(best.0);
            }
        }
    }
    worst
}

fn status(faces: Vec<Face>, tolerance: f64) -> (Status, String) {
    let options = Options {
        tolerance,
        max_panels: None,
        input: "test".into(),
        limits: Limits::default(),
        layout: Layout::default(),
        meet: false,
        smooth_angle: 0.0,
        drawn: Default::default(),
    };
    let outcome = of_faces(faces, Vec::new(), &options, &Control::default()).expect("an outcome");
    (outcome.status(), words::reason(outcome.claims(), &[]))
}

#[test]
fn bounds_hold_and_follow_the_tolerance() {
    let files: [(&str, &[u8]); 4] = [
        ("cone", include_bytes!("../../../../data/cone_holes.step")),
        ("cylinder", include_bytes!("../../../../data/cylinder_holes.step")),
        ("torus", include_bytes!("../../../../data/torus_piece.step")),
        ("hull", include_bytes!("../../../../data/hull.step")),
    ];
    for (name, bytes) in files {
        for tolerance in [1.0, 0.005] {
            let read = read(bytes).expect("a model").faces;
            assert!(read.iter().all(|f| f.trim_bound().is_infinite()), "{name}: nothing is proven by reading");
            let AssessedTrims { faces: judged, missed, bound } = assess_trims(read, tolerance);
            assert!(judged.iter().all(|f| f.trim_bound() <= bound.value()));
            assert!(missed.is_empty(), "{name} at {tolerance}: {missed:?}");
            for f in &judged {
                assert!(f.trim_bound() <= 0.07 * tolerance, "{name} at {tolerance}: {}", f.trim_bound());
                let seen = sampled(f);
                assert!(
                    seen <= f.trim_bound() && f.trim_bound() <= 1.5 * seen + 0.02 * tolerance,
                    "{name} at {tolerance}: {seen} against {}",
                    f.trim_bound()
                );
            }
        }
    }
}

#[test]
fn an_edge_that_vanishes_at_the_samples_is_missed_and_told() {
    // Three quartics a x (x - 1/3) (x - 2/3) (x - 1): straight at every third of every span.
    let mut s = Step::new(Unit::Millimetre);
    let shape = [0.0, -1.0 / 18.0, 5.0 / 54.0, -1.0 / 18.0].map(|b| 800.0 * b);
    let points: Vec<String> =
        (0..=12).map(|i| format!("#{}", s.point([100.0 * i as f64 / 12.0, shape[i % 4], 0.0]))).collect();
    let curve = s.add(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',4,({}),.UNSPECIFIED.,.F.,.F.,(5,4,4,5),(0.,1.,2.,3.),.UNSPECIFIED.)",
        points.join(",")
    ));
    let l = s.curve_and_polygon(curve, &SQUARE);
    let face = on_plane(&mut s, l);
    let proof = trim_proof(&face, 1e-3);
    let seen = sampled(&face);
    // The greatest height, 800 · 0.01235, lies between the samples of this test too; where that much is missed the bound
    // need not be tight.
    assert!(seen > 9.4 && (9.87..40.0).contains(&proof.bound().value()), "{proof:?}, {seen}");
    let (status, reason) = status(vec![face], 1.0);
    assert_eq!(status, Status::Uncertified, "10 mm are missing");
    assert!(reason.contains("keep to the file's edges"), "{reason}");
}

#[test]
fn a_spike_does_not_vanish() {
    for width in [0.0, 1e-7] {
        let mut s = Step::new(Unit::Millimetre);
        let mut corners = SQUARE.to_vec();
        corners.splice(1..1, [[50., 0., 0.], [50.0 + 0.5 * width, -100., 0.], [50.0 + width, 0., 0.]]);
        let l = s.polygon(&corners);
        let face = on_plane(&mut s, l);
        let lowest = face.loops[0].points.iter().map(|p| face.surface.point(p[0], p[1]).y).fold(0.0, f64::min);
        let proof = trim_proof(&face, 1e-3);
        assert!(lowest < -99.0 || proof.bound().value() > 99.0, "{width}: {proof:?}, down to {lowest}");
    }
}

#[test]
fn edges_off_their_surface_are_part_of_the_bound() {
    let mut s = Step::new(Unit::Millimetre);
    let corners = SQUARE.map(|[x, y, _]| [x, y, 0.02]);
    let l = s.polygon(&corners);
    let face = on_plane(&mut s, l);
    let bound = trim_proof(&face, 1e-4).bound().value();
    assert!((0.02..0.0201).contains(&bound), "{bound}");
    assert!(status(vec![face.clone()], 1.0).0 == Status::Certified);
    assert!(status(vec![face], 0.03).0 != Status::Certified);
}

/// An edge that runs beside its face is an edge of the flat part too.
#[test]
fn edges_beside_their_face_count_where_it_is_laid_flat() {
    for (off, certified) in [(0.0, true), (0.04, true), (2.0, false)] {
        let mut s = Step::new(Unit::Millimetre);
        let l = s.polygon(&[[0., 0., 0.], [100., 0., 0.], [100., 100., 0.], [50., 100., off], [0., 100., 0.]]);
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        s.face("", plane, &[(l, true)], true);
        let model = read(s.text().as_bytes()).expect("a model");
        let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.1) };
        let answer = torse::unroll(&model, &options, &Control::default()).expect("an answer");
        let far = answer.claim(What::MapSurfaceDistance).map_or(f64::NAN, |c| c.value());
        assert!(off <= far && far < off + 1e-6, "{far} for {off}");
        assert_eq!(answer.status() == Status::Certified, certified, "{off}");
    }
}
