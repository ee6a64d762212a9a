//! From torses and labelled triangles to panels and flat patterns: closed forms and what neighbours must share.

use std::collections::HashMap;

use torse::brep::face::Face;
use torse::develop::layout::layout;
use torse::develop::pattern::{pattern, PatternOptions};
use torse::develop::DevelopError;
use torse::fit::panels::boundary::{panels, Assigned, Borders, BoundaryOptions};
use torse::geom::{Frame, Vec2, Vec3};
use torse::patchwork::panel::{Border, Patchwork};
use torse::patchwork::partition::Partition;
use torse::patchwork::pattern::Pattern;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::convert::{patch, Extent};
use torse::torse::form::{DualTorse, PanelKind, PrimalTorse, Ruling, Torse};

/// Grid of n × n cells on a rectangle of the parameter plane, two triangles each; `None` leaves a hole.
fn grid(n: u32, u: (f64, f64), v: (f64, f64), label: impl Fn(f64, f64) -> Option<u32>) -> Partition {
    let mut p = Partition::default();
    let at = |i: u32, r: (f64, f64)| r.0 + (r.1 - r.0) * f64::from(i) / f64::from(n);
    for j in 0..=n {
        for i in 0..=n {
            p.vertices.push([at(i, u), at(j, v)]);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let middle = (f64::from(i) + 0.5, f64::from(j) + 0.5);
            if let Some(l) = label(middle.0 / f64::from(n), middle.1 / f64::from(n)) {
                p.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
                p.labels.extend([l; 2]);
            }
        }
    }
    p
}

/// Number of the straight side of the box that an edge lies on.
fn side(p: &Partition, u: (f64, f64), v: (f64, f64)) -> impl Fn(u32, u32) -> u32 + '_ {
    move |a, b| {
        let [p, q] = [a, b].map(|i| p.vertices[i as usize]);
        let tests = [p[1].max(q[1]) <= v.0, p[0].min(q[0]) >= u.1, p[1].min(q[1]) >= v.1, p[0].max(q[0]) <= u.0];
        tests.iter().position(|x| *x).unwrap_or(4) as u32
    }
}

/// Surface z = x²/200 over [0, 100]².
fn trough() -> Surface {
    let ku = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
    let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let mut p = Vec::new();
    for (x, z) in [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)] {
        p.extend([0.0, 100.0].map(|y| Vec3::new(x, y, z)));
    }
    Surface::new(ku, kv, &p, None).expect("surface")
}

/// The same surface as a torse, a little larger.
fn trough_torse() -> Torse {
    let (a, b) = (-10.0, 110.0);
    let f = |x: f64, y: f64, z: f64| (x * y + y * z + z * x) / 600.0;
    let control = vec![[f(a, a, a), 0.0], [f(a, a, b), 0.0], [f(a, b, b), 0.0], [f(b, b, b), 0.0]];
    let profile = Curve::new(3, vec![a, a, a, a, b, b, b, b], control).expect("profile");
    Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0))
}

/// Arc length of z = x²/200 from 0 to x.
fn arc(x: f64) -> f64 {
    let q = x / 100.0;
    50.0 * (q * (1.0 + q * q).sqrt() + q.asinh())
}

const FINE: BoundaryOptions = BoundaryOptions { trim_tolerance: 1e-3, edge_tolerance: 1e-5 };

fn build(face: Face, partition: Partition, torses: &[(u32, &Torse, PanelKind)]) -> Patchwork {
    let ((u0, u1), (v0, v1)) =
        (bounds(partition.vertices.iter().map(|p| p[0])), bounds(partition.vertices.iter().map(|p| p[1])));
    let assigned: Vec<Assigned> = torses.iter().map(|&(label, torse, kind)| Assigned { label, torse, kind }).collect();
    let trim_edge = side(&partition, (u0, u1), (v0, v1));
    let out = panels((0, &face), &partition, &assigned, &trim_edge, 0, &FINE).expect("panels");
    let (panels, seam_count) = (out.panels, out.seam_count);
    drop(trim_edge);
    Patchwork { faces: vec![face], partitions: vec![partition], panels, seam_count, joint_count: 0 }
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
}

/// Shoelace area of a contour with its arcs' segments.
fn contour_area(p: &Pattern) -> f64 {
    let mut sum = 0.0;
    for c in &p.contours {
        let n = c.vertices.len();
        for k in 0..n {
            let (a, b) = (&c.vertices[k], &c.vertices[(k + 1) % n]);
            sum += 0.5 * a.point.perp(&b.point);
            let half = 2.0 * a.bulge.atan();
            if a.bulge != 0.0 {
                let radius = (b.point - a.point).norm() / (2.0 * half.sin());
                sum += 0.5 * radius * radius * (2.0 * half - (2.0 * half).sin()) * half.signum() * half.signum();
            }
        }
    }
    sum
}

#[test]
fn a_trough_becomes_a_rectangle_with_its_arc_length() {
    let torse = trough_torse();
    let work = build(
        Face::untrimmed(trough()),
        grid(12, (0.0, 1.0), (0.0, 1.0), |_, _| Some(0)),
        &[(0, &torse, PanelKind::Cylinder)],
    );
    let p = pattern(&work, 0, &PatternOptions::new(0.01)).expect("a pattern");
    let l = arc(100.0);
    assert!((p.length - l).abs() < 3e-3 && (p.width - 100.0).abs() < 3e-3, "{} x {}", p.length, p.width);
    assert!((p.area - 100.0 * l).abs() < 0.3 && ((p.area - p.area_in_space) / p.area).abs() < 1e-9);
    assert!(p.isometry_error < 1e-10 && p.contour_error <= 0.0102);
    assert_eq!((p.contours.len(), p.contours[0].vertices.len(), p.sides.len()), (1, 4, 4));
    assert!(p.marks.is_empty());
    assert!(p.rulings.len() >= 20 && p.bends.len() == p.rulings.len());
    for [a, b] in &p.rulings {
        assert!(((b - a).norm() - 100.0).abs() < 0.1);
    }
}

#[test]
fn neighbours_carry_equal_marks_and_holes_stay_holes() {
    let torse = trough_torse();
    let label = |x: f64, y: f64| {
        let hole = (x - 0.75).abs() < 0.13 && (y - 0.5).abs() < 0.13;
        (!hole).then_some(u32::from(x > 0.5))
    };
    let mut partition = grid(16, (0.0, 1.0), (0.0, 1.0), label);
    // The seam: shear the grid so that it is not a ruling.
    for v in &mut partition.vertices {
        v[0] += 0.2 * (v[1] - 0.5) * v[0] * (1.0 - v[0]) * 4.0;
    }
    for reversed in [false, true] {
        let mut face = Face::untrimmed(trough());
        face.reversed = reversed;
        let work =
            build(face, partition.clone(), &[(0, &torse, PanelKind::Cylinder), (1, &torse, PanelKind::Cylinder)]);
        let options = PatternOptions::new(0.02);
        let patterns: Vec<Pattern> = (0..2).map(|k| pattern(&work, k, &options).expect("a pattern")).collect();
        assert_eq!(patterns.iter().map(|p| p.contours.len()).collect::<Vec<_>>(), vec![1, 2]);
        // Areas add up to the arc length times the width less the hole.
        let hole = 100.0 * 0.25;
        let total: f64 = patterns.iter().map(|p| p.area).sum();
        assert!(total < 100.0 * arc(100.0) - 0.9 * hole * 25.0);
        for p in &patterns {
            assert!(((contour_area(p) - p.area) / p.area).abs() < 1e-3, "{} {}", contour_area(p), p.area);
            assert!(((p.area_in_space - p.area) / p.area).abs() < 1e-9);
        }
        let labels = |p: &Pattern| p.marks.iter().map(|m| m.label.clone()).collect::<Vec<_>>();
        let (mut a, mut b) = (labels(&patterns[0]), labels(&patterns[1]));
        a.sort();
        b.sort();
        assert!(!a.is_empty() && a == b);
        // Distances between marks agree, and the sides of the seam have equal lengths.
        let at = |p: &Pattern| p.marks.iter().map(|m| (m.label.clone(), m.point)).collect::<HashMap<_, Vec2>>();
        let (x, y) = (at(&patterns[0]), at(&patterns[1]));
        for l in &a {
            assert!(((x[l] - x[&a[0]]).norm() - (y[l] - y[&a[0]]).norm()).abs() < 0.01);
        }
        let seam = |p: &Pattern| {
            p.sides.iter().filter(|s| matches!(s.border, Border::Seam { .. })).map(|s| s.length).sum::<f64>()
        };
        assert!((seam(&patterns[0]) - seam(&patterns[1])).abs() < 0.01);
        for p in &patterns {
            for m in &p.marks {
                let on = p.contours.iter().flat_map(|c| {
                    (0..c.vertices.len()).map(move |k| {
                        let (v, w) = (&c.vertices[k], &c.vertices[(k + 1) % c.vertices.len()]);
                        torse::develop::arcs::distance_to_arc(&m.point, &v.point, &w.point, v.bulge)
                    })
                });
                assert!(on.fold(f64::INFINITY, f64::min) < 0.03);
                assert!(inside(p, &(m.point + m.inward)) && !inside(p, &(m.point - m.inward)));
            }
            for [a, b] in &p.rulings {
                assert!((1..20).all(|k| inside(p, &(a + (b - a) * (f64::from(k) / 20.0)))));
            }
        }
        let placed = layout(&patterns);
        assert_eq!(placed.len(), 2);
    }
}

/// Even-odd test against the contours' chords.
fn inside(p: &Pattern, x: &Vec2) -> bool {
    let mut odd = false;
    for c in &p.contours {
        let n = c.vertices.len();
        let points: Vec<Vec2> = (0..n)
            .flat_map(|k| {
                let (v, w) = (&c.vertices[k], &c.vertices[(k + 1) % n]);
                torse::develop::arcs::points_along(&v.point, &w.point, v.bulge, 8)
            })
            .collect();
        for k in 0..points.len() {
            let (a, b) = (points[k], points[(k + 1) % points.len()]);
            if (a.y > x.y) != (b.y > x.y) && x.x < a.x + (x.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                odd = !odd;
            }
        }
    }
    odd
}

/// A dual torse whose normals turn by `turn` with offsets of period one.
fn dual(turn: f64) -> Torse {
    let n = 24;
    let control = (0..n)
        .map(|i| {
            let a = turn * (f64::from(i) - 1.0) / f64::from(n - 3);
            let tilt = 0.4;
            [a.cos(), a.sin(), tilt, 100.0 + 12.0 * a]
        })
        .collect();
    let planes = Curve { knots: Knots::uniform(3, (n - 3) as usize, 0.0, 1.0).expect("knots"), control };
    Torse::Dual(DualTorse { planes })
}

/// Border of the region between two lengths along the rulings of `[a, b]`.
fn ladder(torse: &Torse, a: f64, b: f64, length: impl Fn(&Ruling, bool) -> f64) -> Vec<(f64, Vec3)> {
    let step = |i: i32, up: bool| {
        let t = a + (b - a) * f64::from(i) / 60.0;
        let r = torse.ruling(t);
        (t, r.point + r.direction * length(&r, up))
    };
    (0..=60).map(|i| step(i, false)).chain((0..=60).rev().map(|i| step(i, true))).collect()
}

#[test]
fn a_dual_torse_is_exported_and_developed() {
    let torse = dual(1.5);
    let mut extent = Extent::default();
    extent.loops.push(ladder(
        &torse,
        0.05,
        0.95,
        |r, up| if up { 60.0 - r.point.z } else { -r.point.z } / r.direction.z,
    ));
    let surface = patch(&torse, &extent).expect("a patch");
    let ((t0, t1), _) = surface.domain();
    let (u, v) = ((t0 + 0.02, t1 - 0.02), (0.1, 0.9));
    let face = Face::untrimmed(surface);
    let work = build(
        face,
        grid(20, u, v, |x, y| Some(u32::from((x - 0.5).hypot(y - 0.5) < 0.3))),
        &[(0, &torse, PanelKind::Torse), (1, &torse, PanelKind::Torse)],
    );
    for k in 0..2 {
        let p = pattern(&work, k, &PatternOptions::new(0.05)).expect("a pattern");
        assert!(p.isometry_error < 1e-8, "{}", p.isometry_error);
        assert!(((p.area - p.area_in_space) / p.area).abs() < 1e-8, "{} {}", p.area, p.area_in_space);
    }
}

#[test]
fn a_pattern_that_overlaps_itself_is_refused() {
    // A flat cone-like ribbon that turns by more than a full turn in the plane: nearly horizontal rulings.
    let torse = dual(8.5);
    let Torse::Dual(mut d) = torse else { unreachable!() };
    for c in &mut d.planes.control {
        c[2] = 6.0;
        c[3] *= 0.2;
    }
    let torse = Torse::Dual(d);
    let mut extent = Extent::default();
    extent.loops.push(ladder(&torse, 0.02, 0.98, |_, up| if up { -300.0 } else { -400.0 }));
    let surface = match patch(&torse, &extent) {
        Ok(s) => s,
        Err(e) => panic!("{e}"),
    };
    let ((t0, t1), _) = surface.domain();
    let w = t1 - t0;
    let work = build(
        Face::untrimmed(surface),
        grid(24, (t0 + 0.02 * w, t1 - 0.02 * w), (0.1, 0.9), |_, _| Some(0)),
        &[(0, &torse, PanelKind::Torse)],
    );
    match pattern(&work, 0, &PatternOptions::new(0.05)) {
        Err(DevelopError::Overlap { t }) => assert!(t > t0 && t < t1),
        other => panic!("{other:?}"),
    }
}

#[test]
fn meshes_lie_on_the_panels() {
    let torse = trough_torse();
    let work = build(
        Face::untrimmed(trough()),
        grid(8, (0.0, 1.0), (0.0, 1.0), |x, _| Some(u32::from(x > 0.5))),
        &[(0, &torse, PanelKind::Cylinder), (1, &torse, PanelKind::Cylinder)],
    );
    let mesh = torse::tessellate::panel::panel_mesh(&work, 1);
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (64, 45));
    for (x, v) in mesh.positions.iter().zip(&mesh.values) {
        assert!((x.z - x.x * x.x / 200.0).abs() < 1e-9 && v.abs() < 1e-9);
    }
    let whole = torse::tessellate::panel::surface_mesh(&work, 0);
    assert!(whole.normals.iter().all(|n| n.z > 0.0));
    let lines = torse::tessellate::panel::ruling_lines(&work.panels[0], 5.0);
    assert_eq!(lines.len(), 10);
    for [a, b] in lines {
        assert!((a - b).x.abs() < 1e-9 && ((a - b).norm() - 100.0).abs() < 1e-6);
    }
    let border = torse::tessellate::panel::border_lines(&work.panels[0], 4);
    assert_eq!(border.len(), 1);
}

#[test]
fn a_pole_is_a_corner() {
    // A triangle as a patch whose side v = 0 is one point.
    let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let p = [(0.0, 0.0), (100.0, 0.0), (0.0, 0.0), (0.0, 100.0)].map(|(x, y)| Vec3::new(x, y, 3.0));
    let face = Face::untrimmed(Surface::new(k.clone(), k, &p, None).expect("surface"));
    let control = vec![[3.0, 0.0]; 4];
    let profile = Curve::new(3, vec![-20., -20., -20., -20., 120., 120., 120., 120.], control).expect("profile");
    let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0));
    let work = build(face, grid(6, (0.0, 1.0), (0.0, 1.0), |_, _| Some(0)), &[(0, &torse, PanelKind::Plane)]);
    assert_eq!(work.panels[0].loops()[0].len(), 4);
    let p = pattern(&work, 0, &PatternOptions::new(0.01)).expect("a pattern");
    assert_eq!((p.contours[0].vertices.len(), p.sides.len(), p.rulings.len()), (3, 3, 0));
    assert!((p.area - 5000.0).abs() < 0.1 && (p.area_in_space - p.area).abs() < 1e-6);
}

/// A pole has no normal, and its points differ by rounding.
#[test]
fn panels_with_a_common_edge_close_at_a_pole() {
    let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let hair = 1e-13;
    let p = [(0.0, 0.0, 3.0), (100.0, 0.0, 20.0), (hair, 0.0, 3.0), (0.0, 100.0, 20.0)];
    let p = p.map(|(x, y, z)| Vec3::new(x, y, z));
    let face = Face::untrimmed(Surface::new(k.clone(), k, &p, None).expect("surface"));
    let range = (0.0, 1.0);
    let partition = grid(6, range, range, |x, _| Some(u32::from(x > 0.5)));
    let trim_edge = side(&partition, range, range);
    // The plane z = 8.
    let control = vec![[8.0, 0.0]; 4];
    let profile = Curve::new(3, vec![-40., -40., -40., -40., 140., 140., 140., 140.], control).expect("profile");
    let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0));
    let closed = |borders: &Borders| {
        for label in [0, 1] {
            let assigned = Assigned { label, torse: &torse, kind: PanelKind::Plane };
            let (panel, _) = borders.panel(0, &assigned, &FINE).expect("a panel");
            let runs = &panel.loops()[0];
            assert_eq!(runs.len(), 4);
            for (k, run) in runs.iter().enumerate() {
                let next = &runs[(k + 1) % runs.len()];
                assert_eq!(run.trim.control.last(), next.trim.control.first(), "run {k} of label {label}");
            }
        }
    };
    let mut borders = Borders::new(&face, &partition, &trim_edge, 0);
    closed(&borders);
    // The same with an edge in the plane for both, from near the pole to near the other end of the seam.
    let seam = borders.seam_chains().remove(0);
    let places = [0, seam.vertices.len() - 1].map(|k| {
        let [u, v] = partition.vertices[seam.vertices[k] as usize];
        let x = face.surface.point(u, v);
        [x.x + 1.0, x.y + 1.5, 8.0]
    });
    let edge = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], places.to_vec()).expect("an edge");
    let count = (seam.vertices.len() - 1) as f64;
    borders.share(seam.chain, edge, (0..seam.vertices.len()).map(|k| k as f64 / count).collect());
    closed(&borders);
}
