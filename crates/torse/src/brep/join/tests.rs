use super::turn::{reversed_u, reversed_v, transposed};
use super::{pair, Face, JoinOptions, Vec3};
use crate::brep::face::TrimLoop;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// A shallow bowl of degree (3, 2) with a knot in u, 100 mm wide.
fn bowl() -> Surface {
    let (ku, kv) =
        (Knots::clamped(3, &[0.0, 0.6, 1.0]).expect("knots"), Knots::clamped(2, &[0.0, 1.0]).expect("knots"));
    let points: Vec<Vec3> = (0..15)
        .map(|k| {
            let (x, y) = (25.0 * f64::from(k / 3), 50.0 * f64::from(k % 3));
            Vec3::new(x, y, ((x - 50.0).powi(2) + (y - 50.0).powi(2)) / 200.0)
        })
        .collect();
    Surface::new(ku, kv, &points, None).expect("a surface")
}

/// The quarters of a surface, one transposed, one reversed, one of a degree more.
fn quarters(s: &Surface, u: f64, v: f64) -> Vec<Face> {
    let ((u0, u1), (v0, v1)) = s.domain();
    let part = |a: (f64, f64), b: (f64, f64)| Face::untrimmed(s.restricted(a, b).expect("inside"));
    let mut faces = vec![
        part((u0, u), (v0, v)),
        transposed(&part((u, u1), (v0, v))),
        reversed_u(&part((u0, u), (v, v1))),
        reversed_v(&part((u, u1), (v, v1))),
    ];
    faces[3].surface = faces[3].surface.elevated_v().expect("degree");
    for (k, f) in faces.iter_mut().enumerate() {
        f.entity = 10 + k as u64;
        // Each on a domain of its own.
        let stretch = 1.0 + k as f64;
        for d in 0..2 {
            let knots = if d == 0 { &mut f.surface.knots_u } else { &mut f.surface.knots_v };
            let values = knots.values().iter().map(|x| stretch * x + 3.0).collect();
            *knots = Knots::new(knots.degree(), values, knots.control_count()).expect("knots");
            f.loops.iter_mut().flat_map(|l| &mut l.points).for_each(|p| p[d] = stretch * p[d] + 3.0);
        }
    }
    faces
}

fn options(degrees: f64) -> JoinOptions {
    JoinOptions { angle: degrees.to_radians(), mismatch: 1e-6, turn: f64::INFINITY }
}

fn joined(faces: Vec<Face>, options: &JoinOptions) -> Vec<Face> {
    super::joined(faces, options, &|_, _, _| true)
}

/// Largest distance from samples of the faces to the nearest of a grid of a surface, refined by projection.
fn apart(faces: &[Face], s: &Surface) -> f64 {
    let ((u0, u1), (v0, v1)) = s.domain();
    let mut worst: f64 = 0.0;
    for f in faces {
        let ((a0, a1), (b0, b1)) = f.surface.domain();
        for k in 0..25 {
            let x = f.surface.point(a0 + (a1 - a0) * f64::from(k % 5) / 4.0, b0 + (b1 - b0) * f64::from(k / 5) / 4.0);
            let start = (0..1600)
                .map(|g| (u0 + (u1 - u0) * f64::from(g % 40) / 39.0, v0 + (v1 - v0) * f64::from(g / 40) / 39.0));
            let near = start.min_by(|p, q| (s.point(p.0, p.1) - x).norm().total_cmp(&(s.point(q.0, q.1) - x).norm()));
            let (mut u, mut v) = near.expect("a grid");
            for _ in 0..20 {
                let j = s.jet(u, v);
                let r = x - j.p;
                let (e, f, g) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
                let (a, b) = (j.du.dot(&r), j.dv.dot(&r));
                let det = e * g - f * f;
                u = (u + (a * g - b * f) / det).clamp(u0, u1);
                v = (v + (b * e - a * f) / det).clamp(v0, v1);
            }
            worst = worst.max((s.point(u, v) - x).norm());
        }
    }
    worst
}

#[test]
fn quarters_of_a_bowl_become_the_bowl() {
    let faces = quarters(&bowl(), 0.37, 0.55);
    let whole = joined(faces.clone(), &options(0.5));
    assert_eq!(whole.len(), 1);
    let f = &whole[0];
    assert!(f.joint_bound() < 1e-9 && f.joint_bound() > 0.0, "{}", f.joint_bound());
    assert!(apart(&faces, &f.surface) < 1e-9);
    assert_eq!(f.parts.iter().map(|p| p.entity).collect::<Vec<_>>(), [10, 11, 12, 13]);
    assert_eq!((f.entity, f.name.as_str()), (10, "#10 + #11 + #12 + #13"));
    assert_eq!(f.loops.len(), 1);
    assert_eq!(f.loops[0].points.len(), 8, "four corners and four ends of joints");
    // Every corner of the loop lies on the rectangle of the domain.
    let ((u0, u1), (v0, v1)) = f.surface.domain();
    assert!(f.loops[0].points.iter().all(|p| p[0] == u0 || p[0] == u1 || p[1] == v0 || p[1] == v1));
    // The surface is smooth across its joints in all but its knots.
    for k in 1..40 {
        let u = u0 + (u1 - u0) * f64::from(k) / 40.0;
        let n = f.surface.jet(u, 0.5 * (v0 + v1)).normal().normalize();
        let m = f.surface.jet(u + 1e-7, 0.5 * (v0 + v1)).normal().normalize();
        assert!((m - n).norm() < 1e-5);
    }
    let outward = |f: &Face, u: f64, v: f64| f.surface.jet(u, v).normal() * if f.reversed { -1.0 } else { 1.0 };
    let p = f.loops[0].points[0];
    assert!(outward(f, p[0], p[1]).z > 0.0, "looks where the first part looks");
}

#[test]
fn nothing_is_joined_at_no_angle_or_across_a_crease() {
    let faces = quarters(&bowl(), 0.5, 0.5);
    assert_eq!(joined(faces.clone(), &options(0.0)).len(), 4);
    let knots = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let roof = |slope: f64| {
        let plane = |points: [Vec3; 4]| {
            Face::untrimmed(Surface::new(knots.clone(), knots.clone(), &points, None).expect("plane"))
        };
        let end = Vec3::new(-10.0, 0.0, 10.0 * slope);
        let left = plane([end, end + Vec3::y() * 9.0, Vec3::zeros(), Vec3::y() * 9.0]);
        let right = plane([Vec3::zeros(), Vec3::y() * 9.0, Vec3::x() * 10.0, Vec3::new(10.0, 9.0, 0.0)]);
        vec![left, right]
    };
    assert_eq!(joined(roof(1f64.to_radians().tan()), &options(0.5)).len(), 2);
    assert_eq!(joined(roof(0.4f64.to_radians().tan()), &options(0.5)).len(), 1);
    // Faces with a crease of their own stay apart.
    let creased = |slope: f64| {
        let halves = Knots::clamped(1, &[0.0, 0.5, 1.0]).expect("knots");
        let lines = [(-20.0, 10.0 * slope), (-10.0, 0.0), (0.0, 0.0)];
        let points: Vec<Vec3> = lines.iter().flat_map(|&(x, z)| [0.0, 9.0].map(|y| Vec3::new(x, y, z))).collect();
        let left = Face::untrimmed(Surface::new(halves, knots.clone(), &points, None).expect("a surface"));
        vec![left, roof(0.0).remove(1)]
    };
    assert_eq!(joined(creased(1f64.to_radians().tan()), &options(0.5)).len(), 2);
    assert_eq!(joined(creased(0.4f64.to_radians().tan()), &options(0.5)).len(), 1);
    // A fold is no smooth edge.
    let mut fold = roof(0.0);
    for c in &mut fold[0].surface.control {
        c[0] = -c[0];
    }
    assert_eq!(joined(fold, &options(0.5)).len(), 2);
}

#[test]
fn gaps_are_closed_within_the_mismatch_and_counted() {
    let mut faces = quarters(&bowl(), 0.5, 0.5);
    for c in &mut faces[3].surface.control {
        c[2] += 0.01;
    }
    assert_eq!(joined(faces.clone(), &options(0.5)).len(), 3, "the moved quarter stays apart, and its row with it");
    let whole = joined(faces.clone(), &JoinOptions { mismatch: 0.02, ..options(0.5) });
    assert_eq!(whole.len(), 1);
    assert!(whole[0].joint_bound() >= 0.01 && whole[0].joint_bound() < 0.03, "{}", whole[0].joint_bound());
    let met = apart(&faces, &whole[0].surface);
    assert!(met <= whole[0].joint_bound() && met > 1e-3, "{met}");
}

#[test]
fn holes_stay_and_the_common_edge_goes() {
    let mut faces = quarters(&bowl(), 0.5, 0.5);
    faces.truncate(2);
    let ((u0, u1), (v0, v1)) = faces[1].surface.domain();
    let (u, v, r) = (0.5 * (u0 + u1), 0.5 * (v0 + v1), 0.2 * (u1 - u0));
    let hole = TrimLoop { points: vec![[u - r, v], [u, v + r], [u + r, v], [u, v - r]], edge: vec![4; 4] };
    let centre = faces[1].surface.point(u, v);
    faces[1].loops.push(hole);
    let whole = joined(faces, &options(0.5));
    assert_eq!(whole.len(), 1);
    assert_eq!(whole[0].loops.len(), 2);
    assert_eq!(whole[0].loops[0].points.len(), 6);
    let p = &whole[0].loops[1].points;
    let middle = [0, 1].map(|d: usize| 0.25 * (0..4).map(|k| p[k][d]).sum::<f64>());
    assert!((whole[0].surface.point(middle[0], middle[1]) - centre).norm() < 1e-9);
    let area: f64 = (0..4).map(|i| p[i][0] * p[(i + 1) % 4][1] - p[i][1] * p[(i + 1) % 4][0]).sum();
    assert!(area < 0.0, "a hole runs clockwise");
}

#[test]
fn a_ring_stays_open_at_one_edge() {
    // Quarters of a cylinder, rational.
    let half = 0.5f64.sqrt();
    let quarter = |k: f64| {
        let at = |a: f64, r: f64, z: f64| Vec3::new(r * a.cos(), r * a.sin(), z);
        let angles = [k, k + 0.5, k + 1.0].map(|x| x * std::f64::consts::FRAC_PI_2);
        let points: Vec<Vec3> = (0..6)
            .map(|i| at(angles[i / 2], if i / 2 == 1 { 5.0 / half } else { 5.0 }, 10.0 * (i % 2) as f64))
            .collect();
        let weights = [1.0, 1.0, half, half, 1.0, 1.0];
        let (ku, kv) = (Knots::clamped(2, &[0.0, 1.0]).expect("knots"), Knots::clamped(1, &[0.0, 1.0]).expect("knots"));
        Face::untrimmed(Surface::new(ku, kv, &points, Some(&weights)).expect("a surface"))
    };
    let quarters: Vec<Face> = (0..4).map(|k| quarter(f64::from(k))).collect();
    let open = JoinOptions { turn: 200f64.to_radians(), ..options(0.5) };
    assert_eq!(joined(quarters.clone(), &open).len(), 2, "halves that do not close around themselves");
    let none = super::joined(quarters.clone(), &options(0.5), &|_, _, _| false);
    assert_eq!(none.len(), 4, "nothing is worth while");
    let whole = joined(quarters, &options(0.5));
    assert_eq!(whole.len(), 1);
    let f = &whole[0];
    let [p, q] = [f.surface.domain().0 .0, f.surface.domain().0 .1].map(|u| f.surface.point(u, 0.5));
    let ends = pair::ends(&f.surface, 0);
    assert!((p - q).norm() < 1e-9 && (ends[0] - ends[1]).norm() > 9.0, "u runs around");
    let ((u0, u1), _) = f.surface.domain();
    for k in 0..=50 {
        let x = f.surface.point(u0 + (u1 - u0) * f64::from(k) / 50.0, 0.3);
        assert!((x.x.hypot(x.y) - 5.0).abs() < 1e-9);
    }
}
