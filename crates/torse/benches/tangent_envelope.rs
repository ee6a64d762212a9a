//! The envelope of tangent planes along one curve, and the minimal intervals of its rulings (\[SE06\]).

use torse::fit::near::tangent_envelope::{envelope_along, interval};
use torse::io::step::read::read;
use torse::spline::surface::Surface;

const BOWL: &[u8] = include_bytes!("../../../data/half_bowl.step");

/// Tolerance, mm.
const TOLERANCE: f64 = 1.0;

fn main() {
    divan::main();
}

/// The bowl and a curve around it.
fn given(rulings: usize) -> (Surface, Vec<[f64; 2]>) {
    let surface = read(BOWL).expect("a model").faces.remove(0).surface;
    let ((u0, u1), (v0, v1)) = surface.domain();
    let at = |i: usize| u0 + (u1 - u0) * (0.1 + 0.8 * i as f64 / (rulings - 1) as f64);
    let line = (0..rulings).map(|i| [at(i), 0.5 * (v0 + v1)]).collect();
    (surface, line)
}

#[divan::bench(args = [41, 81])]
fn envelope(bencher: divan::Bencher, rulings: usize) {
    let (surface, line) = given(rulings);
    bencher.bench(|| envelope_along(&surface, &line).expect("an envelope").len());
}

#[divan::bench(args = [41, 81])]
fn envelope_and_intervals(bencher: divan::Bencher, rulings: usize) {
    let (surface, line) = given(rulings);
    let reach = surface.bbox().diagonal();
    bencher.bench(|| {
        let points = envelope_along(&surface, &line).expect("an envelope");
        points.iter().map(|p| interval(&surface, p, TOLERANCE, reach)[1]).sum::<f64>()
    });
}
