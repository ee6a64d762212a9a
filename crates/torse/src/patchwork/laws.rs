//! Laws of wholes in pieces: cutting loses nothing and leaves no gap, and lines run backwards are the same lines.

use super::partition::{edges, Partition};
use super::pattern::{ContourVertex, MarkLine, Placement};
use super::triangulate::triangulate;
use crate::geom::generated::{flat_vector, powers_of_ten};
use crate::geom::Vec2;
use proptest::prelude::*;

fn area(corners: [[f64; 2]; 3]) -> f64 {
    let [a, b, c] = corners.map(Vec2::from);
    0.5 * (b - a).perp(&(c - a))
}

fn area_of(p: &Partition, triangles: &[usize]) -> f64 {
    triangles.iter().map(|t| area(p.corners(*t))).sum()
}

fn whole(p: &Partition) -> f64 {
    area_of(p, &(0..p.triangles.len()).collect::<Vec<_>>())
}

/// Every triangle counter-clockwise, every directed edge once, and those without a neighbour the trimming edges.
fn conforms(p: &Partition) -> bool {
    let directed = p.adjacency();
    let once = directed.len() == 3 * p.triangles.len();
    let inner = |e: &(u32, u32)| directed.contains_key(&(e.1, e.0));
    let border = directed.keys().filter(|e| !inner(e)).count();
    let trimmed = p.trim_edges.keys().all(|e| directed.contains_key(e) && !inner(e));
    once && trimmed && border == p.trim_edges.len() && (0..p.triangles.len()).all(|t| area(p.corners(t)) > 0.0)
}

/// A star-shaped region of the unit square, cut at grid lines, with a hole whose border may be a hair off the outer one; and its area.
fn region() -> impl Strategy<Value = (Partition, f64)> {
    let spokes = proptest::collection::vec(0.25..0.48f64, 3..14);
    (spokes, powers_of_ten(-5.0..-0.3), 1usize..7, 1usize..7, 0.0..1.0f64).prop_map(|(spokes, gap, nu, nv, start)| {
        let n = spokes.len();
        let corner = |k: usize, r: f64| {
            let (s, c) = (std::f64::consts::TAU * (k as f64 + start) / n as f64).sin_cos();
            [0.5 + r * c, 0.5 + r * s]
        };
        let outer: Vec<[f64; 2]> = spokes.iter().enumerate().map(|(k, r)| corner(k, *r)).collect();
        let hole: Vec<[f64; 2]> = spokes.iter().enumerate().map(|(k, r)| corner(k, r * (1.0 - gap))).rev().collect();
        let fan = |l: &[[f64; 2]]| (0..l.len()).map(|k| area([[0.5; 2], l[k], l[(k + 1) % l.len()]])).sum::<f64>();
        let lines = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<f64>>();
        let wanted = fan(&outer) + fan(&hole);
        let numbers = |from: u32| (from..).take(n).collect::<Vec<u32>>();
        let loops = [(outer, numbers(0)), (hole, numbers(100))];
        (triangulate(&loops, &lines(nu), &lines(nv)).expect("a region"), wanted)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn triangles_fill_the_region_and_nothing_else((p, wanted) in region()) {
        prop_assert!(conforms(&p));
        prop_assert!((whole(&p) - wanted).abs() < 1e-9, "{} {wanted}", whole(&p));
        prop_assert_eq!(p.components(&p.region(0), |_, _| true).len(), 1);
        prop_assert!(p.touching(0).is_empty());
    }

    #[test]
    fn cuts_lose_nothing_and_leave_no_gap(
        (mut p, _) in region(), at in flat_vector(), direction in 0.0..6.3f64, bend in -1.0..1.0f64,
    ) {
        let before = whole(&p);
        let centre = Vec2::repeat(0.5) + at * 0.2;
        let n = Vec2::new(direction.cos(), direction.sin());
        // A parabola through the region.
        let height = |x: [f64; 2]| {
            let d = Vec2::from(x) - centre;
            n.dot(&d) + bend * n.perp(&d).powi(2)
        };
        p.cut(0, 1, height);
        prop_assert!(conforms(&p));
        prop_assert!((whole(&p) - before).abs() < 1e-9);
        // On each side what belongs there, up to what is moved into corners.
        for t in 0..p.triangles.len() {
            let [a, b, c] = p.corners(t).map(height);
            let furthest = [a, b, c].into_iter().max_by(|x, y| x.abs().total_cmp(&y.abs())).unwrap_or(0.0);
            prop_assert!((p.labels[t] == 1) == (furthest > 0.0) || furthest.abs() < 0.02, "{furthest}");
        }
        // Borders shared by two labels are told of once, however they are counted.
        let directed = p.adjacency();
        let shared = directed.iter().filter(|(e, t)| {
            directed.get(&(e.1, e.0)).is_some_and(|o| p.labels[*o as usize] > p.labels[**t as usize])
        }).count();
        prop_assert_eq!(p.neighbours().values().sum::<usize>(), shared);
        // Components are the whole, each by itself in one piece.
        let labels: Vec<u32> = p.distinct_labels().into_iter().flat_map(|l| p.split_components(l)).collect();
        let mut sorted = labels.clone();
        sorted.sort_unstable();
        prop_assert_eq!(&sorted, &p.distinct_labels());
        let mut sum = 0.0;
        for l in labels {
            prop_assert_eq!(p.components(&p.region(l), |_, _| true).len(), 1);
            let (part, old) = p.extract(l);
            let own = whole(&part);
            prop_assert!((own - area_of(&p, &p.region(l))).abs() < 1e-15);
            prop_assert_eq!(old, p.region_vertices(l));
            sum += own;
        }
        prop_assert!((sum - before).abs() < 1e-9);
    }

    #[test]
    fn edges_split_anywhere_keep_the_region(
        (mut p, wanted) in region(), each in 1usize..5, share in powers_of_ten(-3.0..-0.01),
    ) {
        let mut middle = crate::num::hash::HashMap::default();
        let mut all: Vec<(u32, u32)> =
            p.triangles.iter().flat_map(|t| edges(*t)).map(|(a, b)| (a.min(b), a.max(b))).collect();
        all.sort_unstable();
        all.dedup();
        for (a, b) in all.into_iter().step_by(each) {
            let [x, y] = [a, b].map(|v| Vec2::from(p.vertices[v as usize]));
            middle.insert((a, b), p.vertices.len() as u32);
            p.vertices.push((x + (y - x) * share).into());
        }
        let (count, added) = (p.triangles.len(), middle.len());
        let open = p.trim_edges.len();
        p.split_edges(&middle);
        // One triangle more for every new place at the border, two for every one inside.
        let at_border = p.trim_edges.len() - open;
        prop_assert_eq!(p.triangles.len(), count + 2 * added - at_border);
        prop_assert!((whole(&p) - wanted).abs() < 1e-9);
        let directed = p.adjacency();
        prop_assert_eq!(directed.len(), 3 * p.triangles.len());
        prop_assert!(p.trim_edges.keys().all(|e| directed.contains_key(e) && !directed.contains_key(&(e.1, e.0))));
    }

    #[test]
    fn lines_run_backwards_and_back_are_themselves(
        joints in proptest::collection::vec((flat_vector(), -2.0..2.0f64), 2..7), closed in any::<bool>(),
        angle in -4.0..4.0f64, by in flat_vector(),
    ) {
        let mut joints: Vec<ContourVertex> =
            joints.into_iter().map(|(point, bulge)| ContourVertex { point, bulge, corner: false }).collect();
        if let Some(last) = joints.last_mut().filter(|_| !closed) {
            last.bulge = 0.0;
        }
        let line = MarkLine { label: "c".into(), joints, closed };
        let (there, back) = (line.contour(), line.reversed().contour());
        prop_assert_eq!(line.reversed().reversed().contour(), there.clone());
        // The same arcs: from the same places to the same places, bent to the other side of the way.
        let arcs = |c: &[ContourVertex], flip: bool| {
            let n = c.len();
            let mut out: Vec<[f64; 5]> = (0..n).map(|k| {
                let (a, b, bulge) = (c[k].point, c[(k + 1) % n].point, c[k].bulge);
                if flip { [b.x, b.y, a.x, a.y, -bulge] } else { [a.x, a.y, b.x, b.y, bulge] }
            }).filter(|a| closed || a[4] != 0.0).collect();
            out.sort_by(|x, y| x.partial_cmp(y).expect("numbers"));
            out
        };
        prop_assert_eq!(arcs(&there.vertices, false), arcs(&back.vertices, true));
        let placement = Placement { angle, offset: by };
        let moved = line.moved(|p| placement.apply(p), false);
        for (p, q) in moved.joints.iter().zip(&line.joints) {
            prop_assert!((placement.turn(&q.point) + by - p.point).norm() < 1e-14 && p.bulge == q.bulge);
        }
        let mirrored = line.moved(|p| Vec2::new(-p.x, p.y), true).moved(|p| Vec2::new(-p.x, p.y), true);
        prop_assert_eq!(mirrored, line);
    }
}
