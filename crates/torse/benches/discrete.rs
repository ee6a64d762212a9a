//! Time of planarisation and subdivision of strips of quadrilaterals, and of the decomposition of plane sequences.

use torse::control::Control;
use torse::design::discrete::planarise::{planarise, Hold, PlanariseOptions, Planarised};
use torse::design::discrete::subdivide::{subdivide, SubdivideOptions, Subdivided};
use torse::geom::Vec3;
use torse::surface::quad_strip::QuadStrip;

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
