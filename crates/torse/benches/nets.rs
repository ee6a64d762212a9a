//! Speed of developable nets: building, regularity, interpolation of end rulings.

use divan::{black_box, Bencher};
use torse::design::interpolate::{interpolate, solvability, EndRulings, Options, Route, Status};
use torse::geom::Vec3;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::torse::net::{homogeneous, Net, Shape};

fn main() {
    divan::main();
}

/// A wavy curve of `degree` with `count` control points.
fn curve(degree: usize, count: usize) -> Curve<4> {
    let knots = Knots::uniform(degree, count - degree, 0.0, 1.0).expect("knots");
    let step = 20.0 / count as f64;
    let control = (0..count)
        .map(|i| i as f64 * step)
        .map(|x| [100.0 * x, 60.0 * (0.35 * x).sin(), 30.0 * (0.2 * x).cos()])
        .collect();
    homogeneous(&Curve { knots, control })
}

#[divan::bench(args = [100, 1000, 10_000])]
fn build(bencher: Bencher, count: usize) {
    let c = curve(3, count);
    let shape = Shape::from_stars((0.0, 1.0), -2.0, -1.5).expect("shape");
    bencher
        .with_inputs(|| c.clone())
        .bench_local_values(|c| black_box(Net::from_first(c, [0.0, 20.0, 400.0, 0.0], shape)));
}

/// The proof that no ruling is tangent to the curve.
#[divan::bench(args = [23, 1000])]
fn regularity(bencher: Bencher, count: usize) {
    let shape = Shape::from_stars((0.0, 1.0), -2.0, -1.5).expect("shape");
    let net = Net::from_first(curve(3, count), [0.0, 20.0, 400.0, 0.0], shape).expect("net");
    bencher.bench_local(|| black_box(net.regularity()));
}

/// Lines that a regular net through the curve holds.
fn rulings(c: &Curve<4>) -> EndRulings {
    let shape = Shape::from_stars((0.0, 1.0), -2.0, -1.5).expect("shape");
    let net = Net::from_first(c.clone(), [0.0, 20.0, 400.0, 0.0], shape).expect("net");
    let direction = |u: f64| net.ruling(u)[1] - net.ruling(u)[0];
    EndRulings { start: direction(0.0), end: direction(1.0) }
}

/// A cubic with 20 pieces: counting the solutions.
#[divan::bench]
fn count_solutions(bencher: Bencher) {
    let c = curve(3, 23);
    let rulings = rulings(&c);
    bencher.bench_local(|| black_box(solvability(&c, &rulings)));
}

/// A cubic with 20 pieces: the whole question, answered by a polynomial net.
#[divan::bench(args = [1, 20])]
fn interpolation(bencher: Bencher, pieces: usize) {
    let c = curve(3, 3 + pieces);
    let rulings = rulings(&c);
    let answer = interpolate(&c, &rulings, &Options::default()).expect("a question");
    assert_eq!(answer.status, Status::Solved(Route::Polynomial));
    bencher.bench_local(|| black_box(interpolate(&c, &rulings, &Options::default())));
}

/// The rational search that follows where no polynomial net exists.
#[divan::bench]
fn rational_interpolation(bencher: Bencher) {
    let mut c = curve(3, 23);
    for (i, p) in c.control.iter_mut().enumerate() {
        let w = 1.0 + 0.1 * (i as f64).sin();
        *p = p.map(|x| w * x);
    }
    let rulings = EndRulings { start: Vec3::new(20.0, -150.0, 400.0), end: Vec3::new(0.0, 180.0, 420.0) };
    let answer = interpolate(&c, &rulings, &Options::default()).expect("a question");
    assert!(answer.status.is_solved(), "{:?}", answer.status);
    bencher.bench_local(|| black_box(interpolate(&c, &rulings, &Options::default())));
}
