//! Ruled strips by least squares: legs that go on, planar pieces between them, last good states.

use super::*;

/// A strip of two curves from places at the Greville abscissae.
fn ruled(c: &mut Composite, name: &str, knots: &Knots, at: impl Fn(f64, f64) -> Vec3) {
    let sides = ["a", "b"].map(|side| format!("{name}{side}"));
    for (v, side) in [0.0, 1.0].into_iter().zip(&sides) {
        let control = greville(knots).iter().map(|g| at(*g, v).into()).collect();
        c.curves.push(BoundaryCurve {
            name: side.clone(),
            curve: Curve { knots: knots.clone(), control },
            fixed: false,
        });
    }
    c.strips.push(RuledStrip { name: name.into(), sides, shape: StripShape::Ruled });
}

fn place(curve: &str, u: f64) -> Place {
    Place { curve: curve.into(), u }
}

/// Three arms about a triangle whose corners are not where the arms would put them.
pub(super) fn arms(alpha: Option<f64>) -> Composite {
    let k = knots(3, 3, 2);
    let mut c = Composite::default();
    let corner = |i: usize| {
        let a = 2.0 * PI * i as f64 / 3.0;
        Vec3::new(a.cos(), a.sin(), 0.1 * (i as f64 - 1.0))
    };
    for i in 0..3 {
        let (p, q) = (corner(i), corner((i + 1) % 3));
        let out = (p + q).normalize();
        ruled(&mut c, &format!("s{i}"), &k, |g, v| {
            let end = if v == 0.0 { p } else { q };
            let far = end + out * 2.5 + Vec3::z() * (0.9 - 0.6 * v);
            far + (end - far) * g + Vec3::z() * 0.3 * (PI * g).sin()
        });
        for side in ["a", "b"] {
            let name = format!("s{i}{side}");
            let first = c.curve(&name).map(|k| c.curves[k].curve.control[0]).expect("a curve");
            c.handles.push(Handle::point(&name, 0.0, first.into()));
        }
    }
    for i in 0..3 {
        let ends = [place(&format!("s{i}b"), 1.0), place(&format!("s{}a", (i + 1) % 3), 1.0)];
        c.joins.push(Join::Ends { ends, smoothness: Smoothness::G0 });
    }
    let corners = (0..3).map(|i| place(&format!("s{i}a"), 1.0)).collect();
    c.facets.push(Facet { name: "middle".into(), corners, alpha });
    c
}

#[test]
fn strips_go_on_smoothly_from_a_planar_triangle() {
    for alpha in [None, Some(0.4)] {
        let mut session = Session::new(arms(alpha), Options::default()).expect("a session");
        let control = Control::default();
        let report = session.settle(&control);
        assert_eq!(report.status, Status::Converged, "{alpha:?} {report:?}");
        session.polish(1e-12, &control).expect("a polish");
        let facet = &session.facets().expect("facets")[0];
        let normal = facet.patch.jet(0.5, 0.5).normal().normalize();
        for s in session.strips().expect("strips") {
            // All along the last ruling the tangent plane is that of the triangle.
            for v in [0.0, 0.3, 0.7, 1.0] {
                let n = s.patch.jet(1.0, v).normal().normalize();
                assert!(n.cross(&normal).norm() < 1e-9, "{alpha:?} {} {v}", s.name);
            }
        }
        if alpha.is_some() {
            // Curves leave a corner parallel to the opposite side.
            let c = session.curve(0).expect("a curve");
            let leg = Vec3::from(c.jet(1.0)[1]).normalize();
            let [p, q] = [facet.ruling(1.0)[0], facet.ruling(1.0)[1]];
            assert!(leg.cross(&(q - p).normalize()).norm() < 1e-9);
        }
    }
}

#[test]
fn legs_go_on_so_many_times_as_long() {
    let k = knots(3, 3, 2);
    let mut c = Composite::default();
    let at = |from: f64| move |g: f64, v: f64| Vec3::new(from + g, 0.5 * v, 0.2 * (3.0 * (from + g) + v).sin());
    ruled(&mut c, "s", &k, at(0.0));
    ruled(&mut c, "t", &k, at(1.0));
    let ruling = |smoothness| Join::Ruling { first: "s".into(), second: "t".into(), smoothness };
    c.joins.push(ruling(Smoothness::C1 { ratio: 1.5 }));
    let mut session = Session::new(c.clone(), Options::default()).expect("a session");
    assert_eq!(session.settle(&Control::default()).status, Status::Converged);
    for (p, q) in [(0, 2), (1, 3)] {
        let p: Vec<Vec3> = session.control_points(p).collect();
        let q: Vec<Vec3> = session.control_points(q).collect();
        let n = p.len();
        let off = (q[1] - q[0]) - (p[n - 1] - p[n - 2]) * 1.5;
        assert!(off.norm() < 1e-6 && p[n - 1] == q[0], "{off}");
    }
    let s = session.strips().expect("strips");
    for v in [0.0, 0.4, 1.0] {
        let (n, m) = (s[0].patch.jet(1.0, v).normal().normalize(), s[1].patch.jet(0.0, v).normal().normalize());
        assert!(n.cross(&m).norm() < 1e-5);
    }
    // Curvature is not asked of what is skew; a ratio must be one.
    c.joins[0] = ruling(Smoothness::G2);
    let m = Session::new(c.clone(), Options::default()).err().expect("an error").to_string();
    assert!(m.starts_with("join 0") && m.contains("is for developables"), "{m}");
    c.joins[0] = ruling(Smoothness::C1 { ratio: -1.0 });
    let m = Session::new(c, Options::default()).err().expect("an error").to_string();
    assert!(m.contains("the ratio is -1"), "{m}");
}

#[test]
fn corners_must_be_ends_of_curves() {
    let told = |change: &dyn Fn(&mut Composite)| {
        let mut c = arms(None);
        change(&mut c);
        let e = Session::new(c, Options::default()).err().expect("an error");
        (e.to_string(), e.at().map(At::path).unwrap_or_default())
    };
    let (m, path) = told(&|c| c.facets[0].corners[1].u = 0.5);
    assert!(m.contains("u = 0.5 of 's1a' is no end") && path == "$.facets[0].corners", "{m} {path}");
    let (m, _) = told(&|c| c.facets[0].corners.truncate(2));
    assert!(m.contains("has 2 corners"), "{m}");
    let (m, path) = told(&|c| c.facets[0].corners[2].curve = "nothing".into());
    assert!(m.contains("the curve 'nothing', which does not exist") && path == "$.facets[0].corners", "{m} {path}");
}

#[test]
fn the_last_good_state_comes_back() {
    let mut session = Session::new(arms(None), Options::default()).expect("a session");
    assert!(!session.back(), "there is none yet");
    let control = Control::default();
    assert_eq!(session.settle(&control).status, Status::Converged);
    let before: Vec<Vec3> = session.control_points(3).collect();
    let Hold::Point(at) = session.composite().handles[0].hold else { panic!("a point handle") };
    session.set_handle(0, Hold::Point(at + Vec3::z())).expect("a handle");
    control.cancel();
    assert_eq!(session.step(&control).status, Status::Cancelled);
    assert!(session.back());
    assert_eq!(before, session.control_points(3).collect::<Vec<_>>());
    assert_eq!(session.composite().handles[0].hold, Hold::Point(at));
}
