//! Laws of drawings: chords as near as asked, everything at its place and inside the extents told, words clear of each other.

use super::camera::{Camera, Rect};
use super::colour::{bytes, hex, panel};
use super::drawing::{drawing, DrawingOptions, Lettering, TextPlace};
use super::flat::{contour_points, pieces};
use super::labels::{upright, Labels};
use super::reflection::reflected;
use super::stroke_font::width;
use crate::geom::generated::{flat_vector, frame, powers_of_ten, vector};
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::{Contour, ContourVertex, Mark, MarkPlace, Pattern, Placement};
use proptest::prelude::*;

/// A star-shaped outline of a few sides, some of which are arcs, about a place.
fn outline() -> impl Strategy<Value = Contour> {
    (proptest::collection::vec((20.0..100.0f64, -0.3..0.3f64, any::<bool>()), 3..9), flat_vector()).prop_map(
        |(spokes, at)| {
            let n = spokes.len() as f64;
            let vertex = |(k, (radius, bulge, straight)): (usize, &(f64, f64, bool))| {
                let (s, c) = (std::f64::consts::TAU * k as f64 / n).sin_cos();
                let point = at * 1000.0 + Vec2::new(c, s) * *radius;
                ContourVertex { point, bulge: if *straight { 0.0 } else { bulge / n }, corner: true }
            };
            Contour { vertices: spokes.iter().enumerate().map(vertex).collect() }
        },
    )
}

fn part(contour: Contour) -> Pattern {
    let area = 1000.0;
    let first = contour.vertices[0].point;
    let mark = Mark { point: first, inward: Vec2::x(), label: "A1".into(), on: MarkPlace::default(), apart: 0.0 };
    let rulings = vec![[first, contour.vertices[2].point]];
    Pattern { name: "P-01".into(), contours: vec![contour], area, rulings, marks: vec![mark], ..Pattern::default() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn chords_stay_within_what_is_asked(
        a in flat_vector(), way in flat_vector(), long in powers_of_ten(-2.0..4.0), bulge in powers_of_ten(-9.0..2.0),
        left in any::<bool>(), share in powers_of_ten(-3.8..1.0),
    ) {
        let b = a + way * long;
        let bulge = if left { bulge } else { -bulge };
        let vertex = |point: Vec2, bulge: f64| ContourVertex { point, bulge, corner: true };
        let d = b - a;
        let centre = (a + b) * 0.5 + Vec2::new(-d.y, d.x) * (0.25 * (1.0 / bulge - bulge));
        let radius = (a - centre).norm();
        let error = share * radius;
        let points = contour_points(&Contour { vertices: vec![vertex(a, bulge), vertex(b, 0.0)] }, error);
        prop_assert!(points[0] == a && points[points.len() - 1] == b);
        let hair = 1e-12 * (radius + long);
        for w in points.windows(2) {
            // On the arc, and on along it.
            let [p, q] = [w[0] - centre, w[1] - centre];
            prop_assert!((p.norm() - radius).abs() <= hair);
            prop_assert!(points.len() == 2 || p.perp(&q) * bulge > 0.0);
            // The arc over a chord leaves it by less, where the chord is not the one of a nearly whole turn.
            let lower = (p + q).norm() * 0.5;
            prop_assert!(points.len() == 2 || radius - lower <= error * (1.0 + 1e-9) + hair);
        }
        let sagitta = 0.5 * (b - a).norm() * bulge.abs();
        prop_assert!(points.len() > 2 || sagitta <= error * (1.0 + 1e-9) + hair || bulge.abs() < 0.2);
    }

    #[test]
    fn all_of_a_part_is_drawn_at_its_place(contour in outline(), angle in -4.0..4.0f64, by in flat_vector()) {
        let pattern = part(contour);
        let placement = Placement { angle, offset: by * 1e4 };
        let options = DrawingOptions { title: "job".into(), ..DrawingOptions::default() };
        let both = [pattern.clone(), pattern.clone()];
        let found = drawing(&both, &[placement], &[], &options);
        // Without a placement parts stay; the other one is moved with all that is on it.
        let (moved, stays) = (&found.pieces[0], &found.pieces[1]);
        let vertices = |c: &Option<Contour>| c.as_ref().map(|c| c.vertices.clone()).unwrap_or_default();
        prop_assert_eq!(vertices(&stays.outer), pattern.contours[0].vertices.clone());
        for (v, w) in vertices(&moved.outer).iter().zip(&pattern.contours[0].vertices) {
            prop_assert!((v.point - placement.apply(&w.point)).norm() < 1e-9 && v.bulge == w.bulge);
        }
        for (r, s) in moved.rulings.iter().flatten().zip(pattern.rulings.iter().flatten()) {
            prop_assert!((r - placement.apply(s)).norm() < 1e-9);
        }
        // Extents hold every line and every letter, and the arcs of outlines too.
        let hair = 1e-9;
        let inside = |p: &Vec2| {
            p.x >= found.min.x - hair && p.y >= found.min.y - hair && p.x <= found.max.x + hair && p.y <= found.max.y + hair
        };
        for piece in &found.pieces {
            let outlines = piece.outer.iter().flat_map(|c| contour_points(c, 1e-3));
            prop_assert!(outlines.chain(piece.strokes().flatten()).all(|p| inside(&p)));
        }
        // The picture has it at the same place as the cutter's drawing.
        let shown = pieces(&both, &[(placement.angle, placement.offset)], 1e-3);
        for (p, q) in shown[0].outlines[0].iter().zip(&shown[1].outlines[0]) {
            prop_assert!((p - placement.apply(q)).norm() < 1e-8);
        }
        let scale = (shown[0].room - shown[1].room).abs();
        prop_assert!(shown[1].room > 0.0 && scale < 0.2 * shown[1].room, "{} {}", shown[0].room, shown[1].room);
    }

    #[test]
    fn words_that_were_put_keep_clear_of_each_other(
        places in proptest::collection::vec((flat_vector(), 0.0..6.3f64, 1.0..6.0f64), 2..20),
        line in [flat_vector(), flat_vector()],
    ) {
        let line = line.map(|p| p * 40.0);
        let mut labels = Labels::new(vec![line]);
        for (at, angle, height) in &places {
            let along = upright(Vec2::new(angle.cos(), angle.sin()));
            prop_assert!(along.x > -1e-9);
            let place = TextPlace { middle: at * 40.0, along, height: *height };
            let free = labels.is_clear("A-12", &place);
            prop_assert_eq!(labels.put("A-12", [place]), free);
            prop_assert!(!labels.is_clear("A-12", &place));
        }
        let strokes: Vec<Vec<Vec<Vec2>>> = labels.texts.iter().map(Lettering::strokes).collect();
        let segments = |k: usize| strokes[k].iter().flat_map(|s| s.windows(2).map(|w| [w[0], w[1]])).collect::<Vec<_>>();
        let crossing = |[a, b]: [Vec2; 2], [c, d]: [Vec2; 2]| {
            let side = |p: Vec2, q: Vec2, x: Vec2| (q - p).perp(&(x - p));
            side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
        };
        for k in 0..strokes.len() {
            for s in segments(k) {
                prop_assert!(!crossing(s, line));
                prop_assert!((0..k).all(|j| segments(j).into_iter().all(|t| !crossing(s, t))));
            }
        }
    }

    #[test]
    fn cameras_fill_their_rectangle_whatever_the_size_of_the_model(
        points in proptest::collection::vec(vector(), 2..30), direction in vector(), place in frame(1e3),
        size in powers_of_ten(-6.0..6.0),
        wide in 20.0..900.0f64, high in 20.0..900.0f64,
    ) {
        let rect = Rect { x: 7.0, y: -3.0, width: wide, height: high };
        let at = |p: &Vec3| (p + place.origin * 1e-3) * size;
        let moved: Vec<Vec3> = points.iter().map(at).collect();
        let camera = Camera::fitting(moved.iter(), &direction, rect);
        let plain = Camera::fitting(points.iter(), &direction, rect);
        let hair = 1e-6 * (wide + high);
        let (mut low, mut most) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for (p, q) in points.iter().zip(&moved) {
            let (a, b) = (plain.project(p), camera.project(q));
            let near = (a[0] - b[0]).abs() < hair && (a[1] - b[1]).abs() < hair;
            prop_assert!(near && (a[2] - b[2]).abs() < 1e-6, "{a:?} {b:?}");
            (low, most) = (low.inf(&Vec2::new(b[0], b[1])), most.sup(&Vec2::new(b[0], b[1])));
            // Nearer to the eye is deeper in this sense, and lifted lines are nearer.
            prop_assert!(camera.project_towards_eye(q, 1e-3 * camera.distance)[2] > b[2]);
        }
        let room = [wide - (most.x - low.x), high - (most.y - low.y)];
        prop_assert!(room.iter().all(|r| *r > -hair) && room[0].min(room[1]) < hair, "{room:?}");
        prop_assert!((0.5 * (low.x + most.x) - rect.x - 0.5 * wide).abs() < hair);
        prop_assert!((0.5 * (low.y + most.y) - rect.y - 0.5 * high).abs() < hair);
    }

    #[test]
    fn mirrored_rays_are_mirrored_back_and_colours_are_printed_as_bytes(
        ray in vector(), normal in vector(), index in 0usize..5000, text in "[A-Za-z0-9 .,-]{1,12}",
        more in "[A-Z0-9-]{1,6}",
    ) {
        let n = normal.try_normalize(1e-3).unwrap_or_else(Vec3::z);
        let back = reflected(&ray, &n);
        prop_assert!((reflected(&back, &n) - ray).norm() < 1e-14 && (back.norm() - ray.norm()).abs() < 1e-14);
        let colour = panel(index);
        let printed = u32::from_str_radix(&hex(colour)[1..], 16).expect("a number");
        let [r, g, b] = bytes(colour).map(u32::from);
        prop_assert_eq!(printed, (r << 16) | (g << 8) | b);
        // Words after each other take the room of both and one space, at every height alike.
        let space = width(&format!("{text}{more}"), 6.0) - width(&text, 6.0) - width(&more, 6.0);
        prop_assert!((space - 1.9).abs() < 1e-9, "{space}");
        prop_assert!((width(&text, 3.0) * 2.0 - width(&text, 6.0)).abs() < 1e-9);
    }
}
