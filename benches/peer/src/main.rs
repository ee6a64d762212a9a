//! Torse's surface evaluation beside curvo's, in one run on one core: bicubic rational surface with 20 × 20 control
//! points, point and all partial derivatives up to order two, at the same random parameters.
//!
//! Both results are compared, allocations are counted, and the program fails when Torse allocates, is wrong, or is
//! less than four times as fast.

use curvo::prelude::NurbsSurface3D;
use nalgebra::Point4;
use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use torse::geom::Vec3;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

/// Counts what is asked of the system's allocator.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed on unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Control points per direction.
const COUNT: usize = 20;
/// Evaluations per round.
const EVALUATIONS: usize = 50_000;
/// Rounds; the best one counts, since the machine may be busy.
const ROUNDS: usize = 40;
/// What is asked for.
const WANTED: f64 = 4.0;

/// A reproducible sequence in [0, 1) (Weyl sequence, golden ratio and its square).
fn parameters() -> Vec<(f64, f64)> {
    (0..EVALUATIONS)
        .map(|i| ((i as f64 * 0.618_033_988_749_895).fract(), (i as f64 * 0.381_966_011_25).fract()))
        .collect()
}

/// Nanoseconds and allocations per call in one round.
fn round(at: &[(f64, f64)], mut f: impl FnMut(f64, f64)) -> (f64, f64) {
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    let start = Instant::now();
    for &(u, v) in at {
        f(u, v);
    }
    let nanoseconds = start.elapsed().as_secs_f64() * 1e9;
    let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
    (nanoseconds / at.len() as f64, allocations as f64 / at.len() as f64)
}

fn main() {
    let knots = Knots::uniform(3, COUNT - 3, 0.0, 1.0).expect("knots");
    let mut points = Vec::new();
    let mut weights = Vec::new();
    let mut rows = Vec::new();
    for i in 0..COUNT {
        let mut row = Vec::new();
        for j in 0..COUNT {
            let (x, y) = (i as f64, j as f64);
            let p = Vec3::new(x, y, (0.7 * x).sin() * (0.5 * y).cos());
            let w = 1.0 + 0.3 * (x + 2.0 * y).sin();
            points.push(p);
            weights.push(w);
            row.push(Point4::new(p.x * w, p.y * w, p.z * w, w));
        }
        rows.push(row);
    }
    let ours = Surface::new(knots.clone(), knots.clone(), &points, Some(&weights)).expect("surface");
    let theirs = NurbsSurface3D::new(3, 3, knots.values().to_vec(), knots.values().to_vec(), rows);
    let at = parameters();

    let mut worst: f64 = 0.0;
    for &(u, v) in at.iter().take(2000) {
        let a = ours.jet(u, v);
        let b = theirs.rational_derivatives(u, v, 2);
        for (x, y) in [
            (a.p, &b[0][0]),
            (a.du, &b[1][0]),
            (a.dv, &b[0][1]),
            (a.duu, &b[2][0]),
            (a.duv, &b[1][1]),
            (a.dvv, &b[0][2]),
        ] {
            worst = worst.max((x - Vec3::new(y.x, y.y, y.z)).norm() / (1.0 + x.norm()));
        }
    }

    // Rounds take turns, so that a busy moment of the machine does not fall on one side only.
    let mut evaluator = theirs.evaluator();
    let (mut torse, mut plain, mut cached) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let (mut torse_allocations, mut plain_allocations) = (0.0, 0.0);
    for _ in 0..ROUNDS {
        let (time, allocations) = round(&at, |u, v| {
            black_box(ours.jet(black_box(u), black_box(v)));
        });
        (torse, torse_allocations) = (torse.min(time), allocations);
        let (time, allocations) = round(&at, |u, v| {
            black_box(theirs.rational_derivatives(black_box(u), black_box(v), 2));
        });
        (plain, plain_allocations) = (plain.min(time), allocations);
        let (time, _) = round(&at, |u, v| {
            black_box(evaluator.rational_derivatives(black_box(u), black_box(v), 2));
        });
        cached = cached.min(time);
    }
    let curvo = plain.min(cached);
    println!("bicubic rational {COUNT} x {COUNT}, point and derivatives up to order two, random parameters");
    println!("  torse   {torse:7.1} ns, {torse_allocations:.1} allocations");
    println!("  curvo   {plain:7.1} ns, {plain_allocations:.1} allocations (its evaluator: {cached:.1} ns)");
    println!("  ratio   {:7.1} ({WANTED} wanted), largest relative difference {worst:.1e}", curvo / torse);
    let good = torse_allocations == 0.0 && curvo >= WANTED * torse && worst < 1e-9;
    std::process::exit(if good { 0 } else { 1 });
}
