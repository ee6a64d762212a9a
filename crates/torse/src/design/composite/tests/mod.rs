//! Drags and polishes.

mod bad_input;
mod joins;
mod ruled;

use super::*;
use crate::constraint::fairness::greville;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::gauss_newton::Status;
use crate::spline::knots::Knots;
use std::f64::consts::PI;

/// Clamped knots on [0, 1] with inner knots repeated.
pub(super) fn knots(degree: usize, intervals: usize, multiplicity: usize) -> Knots {
    let mut values = vec![0.0; degree + 1];
    for i in 1..intervals {
        values.extend(std::iter::repeat_n(i as f64 / intervals as f64, multiplicity));
    }
    values.extend(vec![1.0; degree + 1]);
    let control = values.len() - degree - 1;
    Knots::new(degree, values, control).expect("knots")
}

/// Strips that are not developable: `c_k(g) = (2g, k/P, sin(2πg + 0.7 k/P)/4 + 0.15 g k/P)` at the Greville abscissae.
pub(super) fn waves(strips: usize, knots: &Knots) -> Composite {
    let mut out = Composite::default();
    for k in 0..=strips {
        let y = k as f64 / strips as f64;
        let point = |g: &f64| [2.0 * g, y, 0.25 * (2.0 * PI * g + 0.7 * y).sin() + 0.15 * g * y];
        let control = greville(knots).iter().map(point).collect();
        let curve = Curve { knots: knots.clone(), control };
        out.curves.push(BoundaryCurve { name: format!("c{k}"), curve, fixed: false });
    }
    for k in 0..strips {
        out.strips.push(RuledStrip {
            name: format!("s{k}"),
            sides: [format!("c{k}"), format!("c{}", k + 1)],
            shape: StripShape::Developable { margin: 0.02 },
        });
    }
    for k in [0, strips] {
        let c = &out.curves[k];
        for (u, p) in [(0.0, c.curve.control[0]), (1.0, c.curve.control[c.curve.control.len() - 1])] {
            out.handles.push(Handle::point(&format!("c{k}"), u, p.into()));
        }
    }
    out
}

/// Largest twist (rad) over dense rulings, and the least clearance of the regression curve as a share of the ruling.
pub(super) fn twist(session: &Session) -> (f64, f64) {
    let (mut worst, mut clearance) = (0.0_f64, f64::INFINITY);
    for s in session.strips().expect("strips") {
        for i in 0..=600 {
            let u = i as f64 / 600.0;
            worst = worst.max(s.twist(u));
            let [a, b] = s.ruling(u);
            clearance = clearance.min(s.regression_clearance(u) / (b - a).norm());
        }
    }
    (worst, clearance)
}

/// With the handle at the middle of the first curve, last in the list.
pub(super) fn waves_with_handle(strips: usize, knots: &Knots) -> (Composite, Vec3) {
    let mut c = waves(strips, knots);
    let at = Vec3::from(c.curves[0].curve.point(0.5));
    c.handles.push(Handle::point("c0", 0.5, at));
    (c, at)
}

#[test]
fn a_drag_takes_few_iterations_and_stays_developable() {
    let (c, start) = waves_with_handle(3, &knots(3, 6, 2));
    let last = c.handles.len() - 1;
    let mut session = Session::new(c, Options::default()).expect("a session");
    let control = Control::default();
    let first = session.settle(&control);
    assert_eq!(first.status, Status::Converged, "{first:?}");
    for k in 1..=12 {
        let to = start + Vec3::new(0.0, -0.008, 0.02) * f64::from(k);
        session.set_handle(last, Hold::Point(to)).expect("a handle");
        let report = session.step(&control);
        let (angle, clearance) = twist(&session);
        assert_eq!(report.status, Status::Converged, "step {k}: {report:?}");
        assert!(report.iterations <= 8 && angle < 2e-5 && clearance > 0.02, "step {k}");
        let at = session.curve(0).expect("a curve").point(0.5);
        assert!((Vec3::from(at) - to).norm() < 1e-5);
    }
    let report = session.polish(1e-11, &control).expect("a polish");
    assert!(report.residual < 1e-10 && twist(&session).0 < 1e-9, "{report:?}");
}

/// After twelve moves of a handle: quadratic strips and single cubic ones have all digits, others nearly.
#[test]
fn the_polish_reaches_ten_digits() {
    for (degree, intervals, multiplicity, strips) in [(3, 6, 2, 1), (2, 12, 1, 3), (5, 4, 3, 1), (5, 4, 3, 3)] {
        let (c, start) = waves_with_handle(strips, &knots(degree, intervals, multiplicity));
        let last = c.handles.len() - 1;
        let mut session = Session::new(c, Options::default()).expect("a session");
        let control = Control::default();
        assert_eq!(session.settle(&control).status, Status::Converged);
        for k in 1..=12 {
            let to = start + Vec3::new(0.0, -0.008, 0.02) * f64::from(k);
            session.set_handle(last, Hold::Point(to)).expect("a handle");
            let report = session.step(&control);
            assert!(report.status == Status::Converged && report.iterations <= 8, "degree {degree}: {report:?}");
        }
        let report = session.polish(1e-10, &control).expect("a polish");
        let (angle, clearance) = twist(&session);
        assert!(report.status == Status::Converged && angle < 1e-8, "degree {degree}: {report:?} {angle}");
        assert!(clearance > 0.02);
    }
}

#[test]
fn surfaces_that_are_developable_stay_as_they_are() {
    // A cylinder, a cone, and the tangent surface of (t, t², t³).
    let v = Vec3::new;
    let a = [v(0.0, 0.0, 0.0), v(0.3, 0.5, 0.1), v(0.8, 0.4, 0.0), v(1.0, 0.0, 0.2)];
    let apex = v(0.2, -0.4, 1.5);
    let c = [v(0.0, 0.0, 0.0), v(1.0 / 3.0, 0.0, 0.0), v(2.0 / 3.0, 1.0 / 3.0, 0.0), v(1.0, 1.0, 1.0)];
    let d = [v(1.0, 0.0, 0.0), v(1.0, 2.0 / 3.0, 0.0), v(1.0, 4.0 / 3.0, 1.0), v(1.0, 2.0, 3.0)];
    let all: [[Vec<Vec3>; 2]; 3] = [
        [a.to_vec(), a.iter().map(|p| p + v(0.2, 0.1, 0.9)).collect()],
        [a.to_vec(), a.iter().map(|p| apex + (p - apex) * 3.0).collect()],
        [0.5, 2.0].map(|s| (0..4).map(|i| c[i] + d[i] * s).collect()),
    ];
    for sides in all {
        let names = ["a", "b"];
        let curves = sides.iter().zip(names).map(|(p, name)| BoundaryCurve {
            name: name.into(),
            curve: Curve { knots: knots(3, 1, 1), control: p.iter().map(|p| (*p).into()).collect() },
            fixed: false,
        });
        let strip = RuledStrip {
            name: "s".into(),
            sides: names.map(String::from),
            shape: StripShape::Developable { margin: 0.0 },
        };
        let c = Composite { curves: curves.collect(), strips: vec![strip], ..Composite::default() };
        let mut session = Session::new(c, Options::default()).expect("a session");
        let report = session.polish(1e-12, &Control::default()).expect("a polish");
        assert!(report.status == Status::Converged && report.iterations == 0 && report.residual < 1e-12, "{report:?}");
    }
}

#[test]
fn a_stop_is_heard() {
    let (c, _) = waves_with_handle(1, &knots(2, 6, 1));
    let mut session = Session::new(c, Options::default()).expect("a session");
    let control = Control::default();
    control.cancel();
    assert_eq!(session.settle(&control).status, Status::Cancelled);
    assert_eq!(session.polish(1e-10, &control).expect("a polish").status, Status::Cancelled);
}
