//! Time of composites that one pulls on: a cold start and a step of a drag, on one core. Six cubic strips of 12 pieces have
//! 534 free coordinates and 504 rulings, six of 236 pieces have 9942 and 9912. The first line of each says how many
//! iterations a run takes.

use std::io::Write;
use torse::control::Control;
use torse::design::composite::{BoundaryCurve, Composite, Handle, Hold, Options, RuledStrip, Session, StripShape};
use torse::geom::Vec3;
use torse::num::gauss_newton::Status;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;

fn main() {
    for pieces in PIECES {
        let mut session = waves(pieces);
        let cold = session.settle(&Control::default());
        let steps: Vec<usize> = (1..=4).map(|k| pull(&mut session, k)).collect();
        // A closed pipe leaves nobody to tell.
        let _ = writeln!(
            std::io::stdout(),
            "6 x {pieces}: {} free, {}, cold start {} iterations, steps {steps:?}",
            session.free(),
            if session.is_banded() { "band" } else { "sparse" },
            cold.iterations
        );
    }
    divan::main();
}

const STRIPS: usize = 6;
const PIECES: [usize; 2] = [12, 236];

/// `c_k(g) = (2g, k/P, sin(2πg + 0.7 k/P)/4 + 0.15 g k/P)` with four corners and the middle of the first curve held, the
/// middle moved by (0, −0.04, 0.1) at once.
fn waves(pieces: usize) -> Session {
    let mut values = vec![0.0; 4];
    (1..pieces).for_each(|i| values.extend([i as f64 / pieces as f64; 2]));
    values.extend([1.0; 4]);
    let count = values.len() - 4;
    let knots = Knots::new(3, values, count).expect("knots");
    let mut c = Composite::default();
    for k in 0..=STRIPS {
        let y = k as f64 / STRIPS as f64;
        let at = |i: usize| {
            let g = knots.values()[i + 1..i + 4].iter().sum::<f64>() / 3.0;
            [2.0 * g, y, 0.25 * (std::f64::consts::TAU * g + 0.7 * y).sin() + 0.15 * g * y]
        };
        let curve = Curve { knots: knots.clone(), control: (0..count).map(at).collect() };
        if k == 0 || k == STRIPS {
            for u in [0.0, 1.0] {
                c.handles.push(Handle::point(&format!("c{k}"), u, curve.point(u).into()));
            }
        }
        c.curves.push(BoundaryCurve { name: format!("c{k}"), curve, fixed: false });
    }
    for k in 0..STRIPS {
        c.strips.push(RuledStrip {
            name: format!("s{k}"),
            sides: [format!("c{k}"), format!("c{}", k + 1)],
            shape: StripShape::Developable { margin: 0.02 },
        });
    }
    c.handles.push(Handle::point("c0", 0.5, middle(&c) + Vec3::new(0.0, -0.04, 0.1)));
    Session::new(c, Options::default()).expect("a session")
}

fn middle(c: &Composite) -> Vec3 {
    c.curves[0].curve.point(0.5).into()
}

/// Drags the middle to the k-th place and answers the number of iterations.
fn pull(session: &mut Session, k: usize) -> usize {
    let to = middle(session.composite()) + Vec3::new(0.0, -0.04, 0.1) + Vec3::new(0.0, -0.008, 0.02) * k as f64;
    session.set_handle(4, Hold::Point(to)).expect("a handle");
    let report = session.step(&Control::default());
    assert_eq!(report.status, Status::Converged);
    report.iterations
}

#[divan::bench(args = PIECES)]
fn cold_start(b: divan::Bencher, pieces: usize) {
    b.with_inputs(|| waves(pieces)).bench_local_values(|mut session| {
        let report = session.settle(&Control::default());
        assert_eq!(report.status, Status::Converged);
        session
    });
}

/// There and back, so that every step is as long as the others.
#[divan::bench(args = PIECES)]
fn drag_step(b: divan::Bencher, pieces: usize) {
    let mut session = waves(pieces);
    session.settle(&Control::default());
    let mut k = 0;
    b.bench_local(|| {
        k = 1 - k;
        pull(&mut session, k)
    });
}
