//! What does not make sense is named.

use super::*;

/// The message of what is wrong.
fn refused(change: impl FnOnce(&mut Composite)) -> String {
    let mut c = waves(2, &knots(3, 4, 2));
    change(&mut c);
    Session::new(c, Options::default()).err().expect("an error").to_string()
}

#[test]
fn names_that_do_not_exist() {
    let m = refused(|c| c.strips[1].sides[1] = "c9".into());
    assert_eq!(m, "strip 1 's1' names the curve 'c9', which does not exist; there are 'c0', 'c1', 'c2'");
    let m = refused(|c| c.handles[2].place.curve = "rail".into());
    assert!(m.starts_with("handle 2 (point at u = 0 of 'rail') names the curve 'rail'"), "{m}");
    let join = Join::Ruling { first: "s0".into(), second: "s7".into(), smoothness: Smoothness::G1 };
    assert!(refused(|c| c.joins.push(join)).starts_with("join 0 names the strip 's7'"));
    let join = Join::Curve { curve: "c0".into(), edge: Edge::Fold };
    let m = refused(|c| c.joins.push(join));
    assert_eq!(m, "join 0 needs a curve between two strips, but 'c0' belongs to 1");
    assert_eq!(refused(|c| c.curves[2].name = "c0".into()), "two curves are called 'c0'; every name must be used once");
    assert_eq!(Session::new(Composite::default(), Options::default()).err(), Some(CompositeError::Empty));
}

#[test]
fn items_have_paths() {
    let path = |change: &dyn Fn(&mut Composite)| {
        let mut c = waves(2, &knots(3, 4, 2));
        change(&mut c);
        Session::new(c, Options::default()).err().and_then(|e| e.at().map(At::path)).expect("a path")
    };
    assert_eq!(path(&|c| c.handles[2].place.curve = "rail".into()), "$.handles[2].curve");
    assert_eq!(path(&|c| c.handles[1].place.u = 7.0), "$.handles[1].u");
    assert_eq!(path(&|c| c.strips[1].sides[0] = "c7".into()), "$.strips[1].sides");
    assert_eq!(path(&|c| c.curves[0].curve.control[0][2] = f64::NAN), "$.curves[0].points");
}

#[test]
fn handles_on_nothing() {
    let m = refused(|c| c.handles[0].place.u = 1.5);
    assert!(m.contains("holds nothing") && m.contains("from 0 to 1"), "{m}");
    let m = refused(|c| {
        let mut other = c.curves[0].clone();
        other.name = "lonely".into();
        c.curves.push(other);
        c.handles.push(Handle::point("lonely", 0.5, Vec3::zeros()));
    });
    assert!(m.starts_with("handle 4") && m.ends_with("'lonely' bounds no strip"), "{m}");
    let m = refused(|c| c.handles[1].hold = Hold::Point(Vec3::new(f64::NAN, 0.0, 0.0)));
    assert!(m.contains("handle 1") && m.contains("finite"), "{m}");
    assert!(refused(|c| c.handles[1].hold = Hold::Tangent(Vec3::zeros())).contains("must be positive"));
    assert!(refused(|c| c.handles[1].strength = Strength::Pull(-1.0)).contains("the weight is -1"));
}

#[test]
fn points_that_contradict_each_other() {
    let m = refused(|c| {
        let mut other = c.handles[0].clone();
        other.hold = Hold::Point(Vec3::new(0.0, 0.0, 5.0));
        c.handles.push(other);
    });
    assert!(m.starts_with("handle 4") && m.contains("handle 0") && m.contains("contradict"), "{m}");
    let m = refused(|c| {
        c.curves[0].fixed = true;
        c.handles[0].hold = Hold::Point(Vec3::new(0.0, 0.0, 5.0));
    });
    assert!(m.contains("fixed curve 'c0'"), "{m}");
    // At a common ruling, by the names of two curves.
    let m = refused(|c| {
        let mut next: Vec<BoundaryCurve> = c.curves[..2].to_vec();
        for (k, n) in next.iter_mut().enumerate() {
            n.name = format!("d{k}");
            n.curve.control.iter_mut().for_each(|p| p[0] += 2.0);
        }
        c.curves.extend(next);
        let mut t = c.strips[0].clone();
        (t.name, t.sides) = ("t".into(), ["d0".into(), "d1".into()]);
        c.strips.push(t);
        c.joins.push(Join::Ruling { first: "s0".into(), second: "t".into(), smoothness: Smoothness::G1 });
        c.handles.push(Handle::point("d0", 0.0, Vec3::new(2.0, 0.0, 1.0)));
    });
    assert!(m.starts_with("handle 4 (point at u = 0 of 'd0') and handle 1 (point at u = 1 of 'c0') contradict"), "{m}");
    // Two fixed curves that should share an end but do not.
    let m = refused(|c| {
        c.handles.clear();
        for k in 0..2 {
            let mut next = c.curves[k].clone();
            next.name = format!("d{k}");
            next.curve.control.iter_mut().for_each(|p| p[0] += 2.5);
            (next.fixed, c.curves[k].fixed) = (true, true);
            c.curves.push(next);
        }
        let mut t = c.strips[0].clone();
        (t.name, t.sides) = ("t".into(), ["d0".into(), "d1".into()]);
        c.strips.push(t);
        c.joins.push(Join::Ruling { first: "s0".into(), second: "t".into(), smoothness: Smoothness::G0 });
    });
    assert!(m.contains("fixed curve 0 'c0'") && m.contains("fixed curve 3 'd0'") && m.contains("0.5"), "{m}");
}

#[test]
fn curves_that_do_not_fit() {
    let m = refused(|c| c.strips[0].sides[1] = "c0".into());
    assert_eq!(m, "strip 0 's0': 'c0' and 'c0' coincide, so there is nothing between them");
    let m = refused(|c| c.curves[1].curve.control = c.curves[0].curve.control.clone());
    assert!(m.contains("'c0' and 'c1' coincide"), "{m}");
    let m = refused(|c| c.curves[0] = waves(1, &knots(2, 4, 1)).curves.swap_remove(0));
    assert!(m.starts_with("strip 0 's0': 'c0' and 'c1' have different degrees or knots"), "{m}");
    let m = Session::new(waves(2, &knots(3, 4, 1)), Options::default()).err().expect("an error").to_string();
    assert!(m.contains("degree 3 with knots of multiplicity 1") && m.contains("repeat"), "{m}");
    assert!(refused(|c| c.strips[1].shape = StripShape::Developable { margin: -0.1 }).contains("the margin is -0.1"));
}

#[test]
fn more_conditions_than_unknowns() {
    let m = refused(|c| {
        c.curves.iter_mut().for_each(|b| b.fixed = true);
        c.handles.clear();
    });
    assert!(m.starts_with("fixed curve 1 'c1' asks for more than there is, 56 conditions for 0 free"), "{m}");
    // Many quadratic strips side by side: the strips themselves.
    let m = Session::new(waves(6, &knots(2, 20, 1)), Options::default()).err().expect("an error").to_string();
    assert!(m.starts_with("strip 5 's5' asks for more than there is") && m.contains("higher degree"), "{m}");
    // Points that hold more than a planar strip has.
    let m = refused(|c| {
        c.strips.iter_mut().for_each(|s| s.shape = StripShape::Planar);
        for k in 0..60 {
            c.handles.push(Handle::point("c1", 0.01 + f64::from(k) / 70.0, Vec3::new(f64::from(k), 1.0, 2.0)));
        }
    });
    assert!(m.starts_with("handle ") && m.contains("pull instead"), "{m}");
}

#[test]
fn what_cannot_be_reached_is_named() {
    // The corners of a planar strip are held at places that are in no plane.
    let mut c = waves(1, &knots(2, 3, 1));
    c.strips[0].shape = StripShape::Planar;
    let mut session = Session::new(c, Options::default()).expect("a session");
    session.set_handle(0, Hold::Point(Vec3::new(0.0, 0.0, 1.0))).expect("a handle");
    let report = session.settle(&Control::default());
    assert_eq!(report.status, Status::Stalled);
    let (class, item) = report.obstacle.expect("an obstacle");
    assert!(class == "planarity" && item == "strip 0 's0'", "{class} {item}");
    // A handle holds what it held.
    let error = session.set_handle(0, Hold::Tangent(Vec3::x())).expect_err("no tangent");
    assert_eq!(error, CompositeError::NoHandle { index: 0, kind: "tangent" });
    assert!(session.set_handle(77, Hold::Point(Vec3::x())).is_err());
    assert!(session.set_handle(0, Hold::Point(Vec3::new(f64::INFINITY, 0.0, 0.0))).is_err());
}

#[test]
fn a_snapshot_is_where_another_session_begins() {
    let mut session = Session::new(waves(1, &knots(3, 6, 2)), Options::default()).expect("a session");
    session.settle(&Control::default());
    let mut again = Session::new(session.snapshot(), Options::default()).expect("a session");
    let before = session.curve(1).expect("a curve");
    let report = again.polish(1e-5, &Control::default()).expect("a polish");
    assert_eq!((report.status, report.iterations), (Status::Converged, 0));
    for (p, q) in before.control.iter().zip(&again.curve(1).expect("a curve").control) {
        assert!((Vec3::from(*p) - Vec3::from(*q)).norm() < 1e-12);
    }
}

#[test]
fn pulled_handles_give_way() {
    // Pulled far away while the corners hold: developability wins, the strip goes some of the way.
    let mut c = waves(1, &knots(3, 6, 2));
    let at = Vec3::from(c.curves[0].curve.point(0.5));
    let mut pull = Handle::point("c0", 0.5, at + Vec3::new(0.0, -0.4, 0.6));
    pull.strength = Strength::Pull(0.3);
    c.handles.push(pull);
    let mut session = Session::new(c, Options::default()).expect("a session");
    let report = session.settle(&Control::default());
    assert_eq!(report.status, Status::Converged, "{report:?}");
    let (angle, clearance) = twist(&session);
    assert!(angle < 2e-5 && clearance > 0.02, "{angle} {clearance}");
    let moved = Vec3::from(session.curve(0).expect("a curve").point(0.5)) - at;
    assert!(moved.norm() > 0.2, "{moved}");
}
