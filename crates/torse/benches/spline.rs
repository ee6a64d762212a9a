//! Speed of the spline kernel: evaluation by degree, refinement, Bézier form, bounds, fits.

use divan::{black_box, Bencher};
use torse::geom::Vec3;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::lsq;
use torse::spline::surface::Surface;

fn main() {
    divan::main();
}

/// A rational surface with 20 × 20 control points; `pole`: one side collapsed to a point.
fn surface(degree: usize, pole: bool) -> Surface {
    let knots = Knots::uniform(degree, 20 - degree, 0.0, 1.0).expect("knots");
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for i in 0..20 {
        for j in 0..20 {
            let (x, y) = (f64::from(i), f64::from(j));
            let share = if pole { x / 19.0 } else { 1.0 };
            points.push(Vec3::new(x, y * share, (0.7 * x).sin() * (0.5 * y * share).cos()));
            weights.push(1.0 + 0.3 * (x + 2.0 * y).sin());
        }
    }
    Surface::new(knots.clone(), knots, &points, Some(&weights)).expect("surface")
}

fn curve(degree: usize) -> Curve<3> {
    let knots = Knots::uniform(degree, 20, 0.0, 1.0).expect("knots");
    let control = (0..knots.control_count()).map(|i| [i as f64, (0.7 * i as f64).sin(), 0.0]).collect();
    Curve { knots, control }
}

/// One evaluation at ever other parameters.
fn everywhere(bencher: Bencher, f: impl Fn(f64, f64)) {
    let mut i = 0u32;
    bencher.bench_local(|| {
        i = i.wrapping_add(1);
        f((f64::from(i) * 0.618_033_988_75).fract(), (f64::from(i) * 0.381_966_011_25).fract());
    });
}

#[divan::bench(args = [1, 2, 3, 5, 7])]
fn jet(bencher: Bencher, degree: usize) {
    let s = surface(degree, false);
    everywhere(bencher, |u, v| {
        black_box(s.jet(u, v));
    });
}

#[divan::bench]
fn jet_at_the_pole(bencher: Bencher) {
    let s = surface(3, true);
    everywhere(bencher, |_, v| {
        black_box(s.jet(0.0, v));
    });
}

#[divan::bench(args = [3, 7])]
fn point(bencher: Bencher, degree: usize) {
    let s = surface(degree, false);
    everywhere(bencher, |u, v| {
        black_box(s.point(u, v));
    });
}

#[divan::bench(args = [3, 7])]
fn curve_jet(bencher: Bencher, degree: usize) {
    let c = curve(degree);
    everywhere(bencher, |u, _| {
        black_box(c.jet(u));
    });
}

#[divan::bench]
fn partials_of_order_four(bencher: Bencher) {
    let s = surface(3, false);
    everywhere(bencher, |u, v| {
        black_box(s.partials(u, v, 4));
    });
}

#[divan::bench]
fn bounds_of_a_hundredth(bencher: Bencher) {
    let s = surface(3, false);
    everywhere(bencher, |u, v| {
        black_box(s.bounds((u, u + 0.01), (v, v + 0.01)));
    });
}

#[divan::bench]
fn bezier_patches(bencher: Bencher) {
    let s = surface(3, false);
    bencher.bench_local(|| black_box(s.bezier_patches()));
}

#[divan::bench]
fn knot_insertion(bencher: Bencher) {
    let c = curve(3);
    bencher.bench_local(|| black_box(c.with_knots(&[0.123, 0.456, 0.789])));
}

#[divan::bench(args = [100, 1000])]
fn fit(bencher: Bencher, count: usize) {
    let parameters: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
    let points: Vec<[f64; 3]> = parameters.iter().map(|t| [*t, (9.0 * t).sin(), (5.0 * t).cos()]).collect();
    bencher.bench_local(|| black_box(lsq::fit_within(&points, &parameters, 3, 1e-5, 64)));
}
