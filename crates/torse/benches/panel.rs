//! Panels and patterns: patch, panel with trimming curves, development, flat pattern; by number of spans.

use divan::Bencher;
use torse::brep::face::Face;
use torse::develop::map::Development;
use torse::develop::pattern::{pattern, PatternOptions};
use torse::fit::panels::boundary::{Assigned, Borders, BoundaryOptions};
use torse::geom::Vec3;
use torse::patchwork::panel::Patchwork;
use torse::patchwork::partition::Partition;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::convert::{patch, Extent};
use torse::torse::form::{DualTorse, PanelKind, Torse};

fn main() {
    divan::main();
}

const SPANS: [usize; 2] = [13, 52];

fn torse_with(spans: usize) -> Torse {
    let control = (0..spans + 3)
        .map(|i| {
            let a = 1.5 * (i as f64 - 1.0) / spans as f64;
            [a.cos(), a.sin(), 0.4, 1000.0 + 120.0 * a]
        })
        .collect();
    let knots = Knots::uniform(3, spans, 0.0, 1.0).expect("knots");
    Torse::Dual(DualTorse { planes: Curve { knots, control } })
}

fn extent(torse: &Torse) -> Extent {
    let at = |i: usize, z: f64| {
        let t = 0.05 + 0.9 * i as f64 / 100.0;
        let r = torse.ruling(t);
        (t, r.point + r.direction * ((z - r.point.z) / r.direction.z))
    };
    let border: Vec<(f64, Vec3)> = (0..=100).map(|i| at(i, 0.0)).chain((0..=100).rev().map(|i| at(i, 600.0))).collect();
    Extent { loops: vec![border] }
}

/// A face on the torse with a grid of triangles.
fn work(spans: usize) -> (Torse, Surface, Face, Partition) {
    let torse = torse_with(spans);
    let surface = patch(&torse, &extent(&torse)).expect("a patch");
    let ((a, b), _) = surface.domain();
    let n = 60_u32;
    let mut p = Partition::default();
    for j in 0..=n {
        for i in 0..=n {
            let x = f64::from(i) / f64::from(n);
            p.vertices.push([a + (b - a) * (0.03 + 0.94 * x), 0.1 + 0.8 * f64::from(j) / f64::from(n)]);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let k = j * (n + 1) + i;
            p.triangles.extend([[k, k + 1, k + n + 2], [k, k + n + 2, k + n + 1]]);
            p.labels.extend([0; 2]);
        }
    }
    (torse, surface.clone(), Face::untrimmed(surface), p)
}

/// Number of the side by the direction of the border edge.
fn side(p: &Partition) -> impl Fn(u32, u32) -> u32 + '_ {
    |a, b| {
        let [p, q] = [a, b].map(|i| p.vertices[i as usize]);
        if p[1] < q[1] {
            1
        } else if p[1] > q[1] {
            3
        } else if p[0] < q[0] {
            0
        } else {
            2
        }
    }
}

const OPTIONS: BoundaryOptions = BoundaryOptions { trim_tolerance: 5e-3, edge_tolerance: 1e-4 };

#[divan::bench(args = SPANS)]
fn exported_patch(bencher: Bencher, spans: usize) {
    let torse = torse_with(spans);
    let extent = extent(&torse);
    bencher.bench_local(|| patch(&torse, &extent));
}

#[divan::bench(args = SPANS)]
fn panel_with_trims(bencher: Bencher, spans: usize) {
    let (torse, _, face, partition) = work(spans);
    let trim_edge = side(&partition);
    let borders = Borders::new(&face, &partition, &trim_edge, 0);
    let assigned = Assigned { label: 0, torse: &torse, kind: PanelKind::Torse };
    bencher.bench_local(|| borders.panel(0, &assigned, &OPTIONS));
}

#[divan::bench(args = SPANS)]
fn development(bencher: Bencher, spans: usize) {
    let (_, surface, _, _) = work(spans);
    bencher.bench_local(|| Development::new(&surface, 1.0));
}

#[divan::bench(args = [1.0, 0.1, 0.01])]
fn flat_pattern(bencher: Bencher, tolerance: f64) {
    let (torse, _, face, partition) = work(26);
    let trim_edge = side(&partition);
    let borders = Borders::new(&face, &partition, &trim_edge, 0);
    let assigned = Assigned { label: 0, torse: &torse, kind: PanelKind::Torse };
    let (panel, _) = borders.panel(0, &assigned, &OPTIONS).expect("a panel");
    let faces = vec![face.clone()];
    let partitions = vec![partition.clone()];
    let patchwork = Patchwork { faces, partitions, panels: vec![panel], seam_count: 0, joint_count: 0 };
    bencher.bench_local(|| pattern(&patchwork, 0, &PatternOptions::new(tolerance)));
}
