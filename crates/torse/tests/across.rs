//! Faces that meet at an angle: the panels on both sides end in one edge, which is on both of them.

use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify::{self, SeamStatus};
use torse::control::Control;
use torse::geom::Vec3;
use torse::patchwork::panel::{Border, Coedge, Panel};
use torse::pipeline::approximate::{of_faces, Options};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::Status;

/// Faces of a cube of 600 mm, the first `count` of three that meet in one corner, each bulging by this much (mm).
fn cube(bulges: [f64; 3], count: usize) -> Vec<Surface> {
    const SIZE: f64 = 600.0;
    let face = |k: usize| {
        let knots = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
        let points: Vec<Vec3> = (0..9)
            .map(|i| {
                let (u, v) = (0.5 * SIZE * f64::from(i / 3), 0.5 * SIZE * f64::from(i % 3));
                // The middle of a biquadratic patch rises by a quarter of its middle control point.
                let w = if i == 4 { SIZE + 4.0 * bulges[k] } else { SIZE };
                [Vec3::new(u, v, w), Vec3::new(w, u, v), Vec3::new(v, w, u)][k]
            })
            .collect();
        Surface::new(knots.clone(), knots, &points, None).expect("a surface")
    };
    (0..count).map(face).collect()
}

fn approximated(surfaces: Vec<Surface>, reversed: &[bool], tolerance: f64) -> Answer {
    let face = |(surface, &reversed): (Surface, &bool)| {
        let mut face = Face::untrimmed(surface);
        face.reversed = reversed;
        face
    };
    let faces = surfaces.into_iter().zip(reversed).map(face).collect();
    let answer = of_faces(faces, Vec::new(), &Options::new(tolerance), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified);
    answer
}

/// Numbers of panels, of seams inside faces and of joints between faces; all that meets is looked at again.
fn counted(answer: &Answer) -> [usize; 3] {
    let p = answer.patchwork();
    let certificate = answer.certificate().expect("a certificate");
    assert!(certificate.is_of(p));
    for (s, proof) in p.seams().iter().zip(&certificate.seams).filter(|s| s.0.seam as usize >= p.seam_count) {
        assert!(s.is_shared() && proof.status == SeamStatus::Exact && proof.panels == s.sides.map(|s| s.panel));
        let place = |panel: &Panel, uv: [f64; 2]| panel.strip.patch.point(uv[0], uv[1]);
        let mut lengths = [0.0; 2];
        let mut before: Option<[Vec3; 2]> = None;
        for k in 0..=400 {
            let t = f64::from(k) / 400.0;
            let on = [s.sides[0].run.trim.point(t), s.sides[1].run.trim.point(s.opposite(t))];
            let now = [place(s.sides[0].of, on[0]), place(s.sides[1].of, on[1])];
            assert!((now[0] - now[1]).norm() <= proof.gap_bound, "{} {}", (now[0] - now[1]).norm(), proof.gap_bound);
            for (i, b) in before.iter().flatten().enumerate() {
                lengths[i] += (now[i] - b).norm();
            }
            before = Some(now);
        }
        assert!((lengths[0] - lengths[1]).abs() < 1e-6 * lengths[0], "{lengths:?}");
        // Marks with one label on both sides.
        let marked = |panel: usize| {
            let pattern = answer.patterns().iter().find(|p| p.panel == panel).expect("a pattern");
            let of = |l: &&str| l.starts_with(&format!("S{}.", s.seam));
            let mut labels: Vec<&str> = pattern.marks.iter().map(|m| m.label.as_str()).filter(of).collect();
            labels.sort_unstable();
            labels
        };
        let [a, b] = s.sides.map(|s| marked(s.panel));
        assert!(!a.is_empty() && a == b && a[0].ends_with("deg"), "{a:?} {b:?}");
    }
    [p.panels.len(), p.seam_count, p.joint_count]
}

#[test]
fn panels_of_two_faces_end_in_one_edge_however_these_are_oriented() {
    // Apart, the panels would be a millimetre away from each other.
    assert_eq!(counted(&approximated(cube([4.0, 3.0, 0.0], 2), &[false; 2], 3.0)), [2, 0, 1]);
    let mut faces = cube([4.0, 3.0, 0.0], 2);
    faces[1] = faces[1].reversed_u();
    let answer = approximated(faces, &[false, true], 3.0);
    assert_eq!(counted(&answer), [2, 0, 1]);
    let seams = answer.patchwork().seams();
    assert!(!seams[0].turned);
}

#[test]
fn edges_of_three_faces_end_in_one_point() {
    let answer = approximated(cube([2.5, 2.0, 2.5], 3), &[false; 3], 3.0);
    assert_eq!(counted(&answer), [3, 0, 3]);
    // Each edge ends in the corner, bit by bit.
    let joints = answer.patchwork().seams();
    let ends = |k: usize| {
        let c = &joints[k].sides[0].run.edge.control;
        [c[0].map(f64::to_bits), c[c.len() - 1].map(f64::to_bits)]
    };
    let common: Vec<_> = ends(0).into_iter().filter(|x| ends(1).contains(x) && ends(2).contains(x)).collect();
    assert_eq!(common.len(), 1);
}

#[test]
fn a_seam_ends_on_the_edge_with_another_face() {
    let answer = approximated(cube([14.0, 3.0, 0.0], 2), &[false; 2], 3.0);
    let [panels, seams, joints] = counted(&answer);
    assert!(panels > 2 && seams == panels - 2 && joints >= 1, "{panels} {seams} {joints}");
    let exact = answer.certificate().iter().flat_map(|c| &c.seams).filter(|s| s.status == SeamStatus::Exact).count();
    assert_eq!(exact, seams + joints);
}

#[test]
fn a_joint_whose_sides_come_apart_is_not_exact() {
    let answer = approximated(cube([4.0, 3.0, 0.0], 2), &[false; 2], 3.0);
    let judged = |change: &dyn Fn(&mut Panel)| {
        let mut p = answer.patchwork().clone();
        change(&mut p.panels[1]);
        let whole = certify::patchwork(&p, 3.0, &Control::default());
        (whole.seams.first().map(|s| s.status), whole.certified, answer.certificate().iter().all(|c| c.is_of(&p)))
    };
    assert_eq!(judged(&|_| ()), (Some(SeamStatus::Exact), true, true));
    let joint = |p: &mut Panel, change: &dyn Fn(&mut Coedge)| {
        let runs = p.loops_mut().iter_mut().flatten();
        runs.filter(|r| matches!(r.border, Border::Joint { .. })).for_each(change);
    };
    // The edge of one side moved; the trimming curve moved; the other side forgotten.
    let moved = judged(&|p| joint(p, &|r| r.edge.control[2][0] += 1e-3));
    assert!(moved.0 != Some(SeamStatus::Exact) && !moved.2, "{moved:?}");
    let moved = judged(&|p| {
        joint(p, &|r| {
            let n = r.trim.control.len();
            r.trim.control[n / 2].iter_mut().for_each(|x| *x *= 1.001);
        });
    });
    assert!(moved.0 != Some(SeamStatus::Exact) && !moved.2, "{moved:?}");
    let lost = judged(&|p| joint(p, &|r| r.border = Border::Trim { edge: 0 }));
    assert!(lost.0.is_none() && !lost.1, "{lost:?}");
}

/// Two bulging faces of 2 m beside a curved chine along which they turn by these angles (degrees, at its control points).
fn chine(turns: [f64; 4]) -> Vec<Surface> {
    let spine = [[0.0, 0.0, 0.0], [700.0, 90.0, -15.0], [1400.0, 150.0, 20.0], [2000.0, 160.0, 100.0]].map(Vec3::from);
    // Towards the keel and towards the sheer: width, bulge, side.
    let face = |width: f64, bulge: f64, side: f64| {
        let rows = |i: usize| {
            spine.iter().zip(turns).enumerate().map(move |(k, (p, turn))| {
                let base = (35.0 + 3.0 * k as f64).to_radians();
                let slope = base + side * 0.5 * turn.to_radians();
                let along = Vec3::new(0.0, slope.cos(), slope.sin()) * (side * width * 0.5 * i as f64);
                let inward = Vec3::new(0.0, -base.sin(), base.cos());
                p + along + inward * if i == 2 { bulge } else { 0.0 }
            })
        };
        let points: Vec<Vec3> = (0..3).flat_map(rows).collect();
        let knots = |degree| Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
        Surface::new(knots(2), knots(3), &points, None).expect("a surface")
    };
    // Borders run against each other about normals that look to one side.
    vec![face(300.0, 30.0, -1.0).reversed_u(), face(250.0, 25.0, 1.0)]
}

#[test]
fn panels_of_faces_that_turn_little_end_in_one_edge() {
    for turns in [[3.0; 4], [2.0, 6.0, 12.0, 20.0]] {
        let answer = approximated(chine(turns), &[false; 2], 4.0);
        let [panels, seams, joints] = counted(&answer);
        let alone = |k: usize| {
            let answer = approximated(vec![chine(turns).swap_remove(k)], &[false], 4.0);
            answer.patchwork().panels.len()
        };
        assert_eq!(panels, alone(0) + alone(1));
        let exact =
            answer.certificate().iter().flat_map(|c| &c.seams).filter(|s| s.status == SeamStatus::Exact).count();
        assert!(joints >= 1 && exact == seams + joints, "{turns:?}: {panels} {seams} {joints} {exact}");
    }
}
