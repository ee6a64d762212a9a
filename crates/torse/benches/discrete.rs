//! Time of planarisation and subdivision of strips of quadrilaterals, and of the decomposition of plane sequences.

use torse::control::Control;
use torse::design::discrete::planarise::{planarise, Hold, PlanariseOptions, Planarised};
use torse::design::discrete::subdivide::{subdivide, SubdivideOptions, Subdivided};
use torse::fit::elements::decompose::{decompose, DecomposeOptions};
use torse::geom::Vec3;
use torse::torse::kind::{EnvelopePiece, TangentPlane};
use torse::torse::quad_strip::QuadStrip;

fn main() {
    divan::main();
}

/// A strip between a circle and a smaller one that is turned and rises; not plane.
fn twisted(quads: usize) -> QuadStrip {
    let t = |k: usize| 2.4 * k as f64 / quads as f64;
    let a = (0..=quads).map(t).map(|t| Vec3::new(t.cos(), t.sin(), 0.0)).collect();
    let b = (0..=quads).map(t).map(|t| {
        let (s, c) = (t + 0.35).sin_cos();
        Vec3::new(0.3 + 0.8 * c, 0.8 * s, 1.0 + 0.2 * t)
    });
    QuadStrip::new(a, b.collect()).expect("a strip")
}

#[divan::bench]
fn five_levels_of_ten_quads(b: divan::Bencher) {
    let strip = twisted(10);
    let options = SubdivideOptions::new(5, Hold::Nothing);
    b.bench(|| -> Subdivided {
        let s = subdivide(divan::black_box(&strip), &options, &Control::default()).expect("levels");
        assert!(s.plane());
        s
    });
}

#[divan::bench(args = [10, 100, 1000])]
fn planarise_quads(b: divan::Bencher, quads: usize) {
    let strip = twisted(quads);
    b.bench(|| -> Planarised {
        planarise(divan::black_box(&strip), &PlanariseOptions::default(), &Control::default()).expect("a strip")
    });
}

/// Tangent planes of a cylinder, a cone and a helix' osculating planes in turn.
fn planes(count: usize) -> Vec<TangentPlane> {
    (0..count)
        .map(|k| {
            let t = 2.0 * k as f64 / count as f64;
            let (s, c) = t.sin_cos();
            let (n, p) = match 3 * k / count {
                0 => (Vec3::new(c, s, 0.0), Vec3::new(1.3 * c, 1.3 * s, 0.0)),
                1 => (Vec3::new(0.8 * c, 0.8 * s, 0.6), Vec3::new(0.2, -0.1, 0.9)),
                _ => (Vec3::new(0.5 * s, -0.5 * c, 1.0), Vec3::new(c, s, 0.5 * t)),
            };
            TangentPlane::through(&p, n.normalize())
        })
        .collect()
}

#[divan::bench(args = [100, 400, 10_000])]
fn decompose_planes(b: divan::Bencher, count: usize) {
    let planes = planes(count);
    b.bench(|| -> Vec<EnvelopePiece> {
        decompose(divan::black_box(&planes), &DecomposeOptions::default()).expect("runs")
    });
}
