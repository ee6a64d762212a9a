//! Laws of files: what is written is read back, number for number or to the digits printed; bounds are printed on the safe side.

use super::artwork::{self, is_as_written, Artwork, PointRow};
use super::json::Report;
use super::words::numbers::{number_bound, number_least};
use super::{cad, cloud, drawings, dxf, iges, quads, step, svg, threedm};
use crate::certify::written;
use crate::draw::drawing::{drawing, DrawingOptions};
use crate::geom::generated::{flat_vector, powers_of_ten, vector};
use crate::geom::unit::LengthUnit;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::generated::{free_cone, round_cone};
use crate::patchwork::panel::Patchwork;
use crate::patchwork::pattern::{Contour, ContourVertex, Mark, MarkLine, MarkPlace, Pattern, Placement};
use proptest::prelude::*;

/// Numbers of any size that a model may have, with all their digits.
fn coordinate() -> impl Strategy<Value = f64> + Clone {
    (powers_of_ten(-12.0..7.0), any::<bool>()).prop_map(|(x, minus)| if minus { -x } else { x })
}

fn points(most: usize) -> impl Strategy<Value = Vec<Vec3>> {
    proptest::collection::vec([coordinate(), coordinate(), coordinate()].prop_map(Vec3::from), 2..most)
}

/// A number as sentences have it.
fn read_back(text: &str) -> f64 {
    text.replace('\u{2212}', "-").parse().expect("a number")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn printed_bounds_are_on_the_safe_side(x in powers_of_ten(-14.0..12.0), few in 0u32..4) {
        // Some numbers have few digits themselves.
        let unit = 10f64.powf(x.log10().floor() - f64::from(few));
        let x = if few == 3 { x } else { (x / unit).round() * unit };
        let (most, least) = (read_back(&number_bound(x)), read_back(&number_least(x)));
        // Numbers printed are those nearest to what the digits say.
        prop_assert!(most >= x * (1.0 - 1e-15) && least <= x * (1.0 + 1e-15), "{least} {x} {most}");
        prop_assert!(x < 1e-12 || (most <= x * 1.011 && least >= x * 0.989), "{least} {x} {most}");
        prop_assert!(number_bound(x).chars().filter(char::is_ascii_digit).count() < 16);
    }

    #[test]
    fn points_of_tables_and_meshes_are_read_number_for_number(points in points(12), kind in 0usize..5) {
        let row = |p: &Vec3, between: &str| format!("{}{between}{}{between}{}", p.x, p.y, p.z);
        let lines = |between: &str| points.iter().map(|p| row(p, between)).collect::<Vec<_>>().join("\n");
        let (name, text) = match kind {
            0 => ("a.xyz", lines(" ")),
            1 => ("a.csv", format!("x,y,z\n{}\n", lines(","))),
            // A comma is the decimal sign where semicolons separate.
            2 => ("a.csv", lines(" ; ").replace('.', ",").replace(" ; ", ";")),
            3 => ("a.obj", points.iter().map(|p| format!("v {}\n", row(p, " "))).collect()),
            _ => {
                let turned: Vec<String> = points.iter().map(|p| row(&p.zyx(), "\t")).collect();
                ("a.txt", format!("# a scan\nz_mm\ty_mm\tx_mm\n{}", turned.join("\n")))
            }
        };
        let found = cloud::read(name, text.as_bytes(), Some(1.0)).expect("points");
        prop_assert_eq!(&found.points, &points, "{}", text);
    }

    #[test]
    fn triangles_of_stl_files_keep_their_corners(
        points in points(9), pick in proptest::collection::vec([0usize..99, 0..99, 0..99], 1..12),
    ) {
        let single = |p: &Vec3| p.map(|x| f64::from(x as f32));
        let corners: Vec<[Vec3; 3]> = pick.iter().map(|t| t.map(|k| single(&points[k % points.len()]))).collect();
        let mut binary = vec![b' '; 80];
        binary.extend((corners.len() as u32).to_le_bytes());
        let mut text = String::from("solid a\n");
        for t in &corners {
            binary.extend([0u8; 12]);
            text.push_str("facet normal 0 0 0\nouter loop\n");
            for p in t {
                p.iter().for_each(|x| binary.extend((*x as f32).to_le_bytes()));
                text.push_str(&format!("vertex {} {} {}\n", p.x, p.y, p.z));
            }
            binary.extend([0u8; 2]);
            text.push_str("endloop\nendfacet\n");
        }
        text.push_str("endsolid a\n");
        for bytes in [binary, text.into_bytes()] {
            let found = cloud::read("a.stl", &bytes, Some(1.0)).expect("triangles");
            let back: Vec<[Vec3; 3]> = found.triangles.iter().map(|t| t.map(|k| found.points[k as usize])).collect();
            prop_assert_eq!(&back, &corners);
            // Every corner once.
            let distinct = found.points.iter().enumerate().all(|(k, p)| !found.points[..k].contains(p));
            prop_assert!(distinct);
        }
    }

    #[test]
    fn points_carried_over_are_read_back_to_their_digits(
        rows in proptest::collection::vec(
            (1usize..9999, "[A-Za-z0-9 ,;.\"-]{0,9}", proptest::option::of(vector()), 0.0..9.0f64), 1..9,
        ),
    ) {
        let rows: Vec<PointRow> = rows.into_iter().map(|(line, part, place, distance)| {
            let distance = if place.is_some() { distance } else { f64::NAN };
            PointRow { line, part, place: place.map(|p| p * 1000.0), distance }
        }).collect();
        let bytes = artwork::csv(&rows, false);
        prop_assert!(is_as_written(&bytes));
        prop_assume!(rows.iter().any(|r| r.place.is_some()));
        let Ok(Artwork::Points(found, blank)) = artwork::read("a.csv", &bytes, 1.0) else {
            return Err(TestCaseError::fail(String::from_utf8_lossy(&bytes).into_owned()));
        };
        let wanted: Vec<(usize, Vec3)> =
            rows.iter().enumerate().filter_map(|(k, r)| Some((k + 2, r.place?))).collect();
        prop_assert_eq!(found.len() + blank.len(), rows.len());
        for ((line, p), (number, q)) in found.iter().zip(&wanted) {
            prop_assert!(line == number && (p - q).amax() <= 0.51e-9, "{p} {q}");
        }
    }
}

/// A part with a hole, marks and lines, some of whose arcs are hardly bent and some more than half round.
fn part() -> impl Strategy<Value = Pattern> {
    let side = (20.0..100.0f64, powers_of_ten(-7.0..-0.5), any::<bool>());
    // SVG tells arcs by their radius, which says little of the centre of one that is half round or nearly so.
    let round = prop_oneof![0.05..0.9f64, 1.1..1.5f64];
    (proptest::collection::vec(side, 3..8), flat_vector(), powers_of_ten(-1.0..1.0), round).prop_map(
        |(spokes, at, size, round)| {
            let n = spokes.len();
            let corner = |k: usize, share: f64| {
                let (s, c) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
                at * 1000.0 + Vec2::new(c, s) * (spokes[k].0 * share * size)
            };
            let vertex = |point, bulge| ContourVertex { point, bulge, corner: true };
            let bulge = |k: usize| if spokes[k].2 { spokes[k].1 / n as f64 } else { 0.0 };
            let outer = Contour { vertices: (0..n).map(|k| vertex(corner(k, 1.0), bulge(k))).collect() };
            let d = Vec2::new(2.0 * size, 0.5 * size);
            let hole = Contour { vertices: vec![vertex(at * 1000.0 + d, -round), vertex(at * 1000.0 - d, -round)] };
            let mark =
                Mark { point: corner(0, 1.0), inward: Vec2::x(), label: "A1".into(), on: MarkPlace::Seam, apart: 0.0 };
            let line = MarkLine::straight("", &[corner(0, 0.3), corner(1, 0.4), corner(2, 0.3)]);
            Pattern {
                name: "P".into(),
                contours: vec![outer, hole],
                rulings: vec![[corner(0, 1.0), corner(n / 2, 1.0)]],
                marks: vec![mark],
                curves: vec![line],
                area: 5000.0 * size * size,
                length: 200.0 * size,
                width: 100.0 * size,
                ..Pattern::default()
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn drawings_are_read_back_to_their_digits(part in part(), inch in any::<bool>(), moved in 0.01..1.0f64) {
        let unit = if inch { LengthUnit::Inch } else { LengthUnit::Millimetre };
        let options = DrawingOptions { unit, ..DrawingOptions::default() };
        let stays = Placement { angle: 0.0, offset: Vec2::zeros() };
        let drawn = drawing(std::slice::from_ref(&part), &[stays], &[], &options);
        let as_dxf = dxf::write(&drawn).expect("a drawing");
        let mut as_svg = Vec::new();
        svg::write(&drawn, &mut as_svg).expect("a drawing");
        for pieces in [drawings::dxf(&as_dxf), drawings::svg(&as_svg)] {
            let pieces = pieces.expect("pieces");
            prop_assert_eq!(pieces.len(), 1);
            prop_assert_eq!((pieces[0].unit, pieces[0].contours.len(), pieces[0].curves.len()), (unit, 2, 1));
            let found = written::drawing(std::slice::from_ref(&part), &pieces);
            prop_assert!(found.reason().is_none() && found.bound() < 1e-4, "{:?} {}", found.reason(), found.bound());
            // What is drawn elsewhere is found to be, no nearer than it is.
            let mut other = part.clone();
            other.contours[0].vertices[1].point.x += moved;
            let off = written::drawing(&[other], &pieces).bound();
            prop_assert!(off > 0.3 * moved, "{off} {moved}");
        }
    }

    #[test]
    fn strips_written_to_exchange_files_are_read_bit_for_bit(free in free_cone(), round in round_cone()) {
        for strip in [free, round.strip] {
            let time = "2026-01-01T00:00:00";
            let header = || step::write::Header { name: "s".into(), time: time.into(), uncertainty: 1e-6 };
            let shell = step::write::Shell::of_strip(&strip);
            let as_step = step::write::shells(&header(), std::slice::from_ref(&shell)).expect("a file");
            let as_rhino = threedm::write::shells(&header(), &[shell]).expect("a file");
            let as_iges = iges::write::panels(&header(), &Patchwork::of_strips(vec![strip.clone()]), &[false]);
            for bytes in [as_step, as_rhino, as_iges] {
                let model = cad::read(&bytes).expect("a model");
                prop_assert!(model.faces.len() == 1 && model.skipped.is_empty(), "{:?}", model.skipped);
                let face = &model.faces[0];
                let size = strip.patch.bbox().diagonal();
                let ((a, b), (c, d)) = strip.patch.domain();
                prop_assert_eq!(face.surface.domain(), strip.patch.domain());
                for (s, t) in [(0.0, 0.0), (0.3, 0.7), (1.0, 0.5), (0.6, 1.0)] {
                    let (u, v) = (a + (b - a) * s, c + (d - c) * t);
                    let (p, q) = (face.surface.point(u, v), strip.patch.point(u, v));
                    // Rational control points are divided by their weights, which rounds them once.
                    prop_assert!((p - q).norm() <= 1e-15 * (size + q.norm()) * 8.0, "{p} {q}");
                }
                if !strip.patch.rational {
                    prop_assert_eq!(&face.surface, &strip.patch);
                }
            }
        }
    }

    #[test]
    fn strips_of_quadrilaterals_are_read_from_both_kinds_of_tables(
        points in points(9), steps in proptest::collection::vec(vector(), 8),
    ) {
        let beside = |(p, s): (&Vec3, &Vec3)| p + (s + Vec3::repeat(2.0)) * (1.0 + p.amax());
        let b: Vec<Vec3> = points.iter().zip(&steps).map(beside).collect();
        let row = |(p, q): (&Vec3, &Vec3)| format!("{};{};{};{};{};{}\n", p.x, p.y, p.z, q.x, q.y, q.z);
        let rows: String = points.iter().zip(&b).map(row).collect();
        let lines = |p: &[Vec3]| p.iter().map(|x| format!("{} {} {}\n", x.x, x.y, x.z)).collect::<String>();
        for (name, text) in [("s.csv", rows), ("s.txt", format!("{}\n{}", lines(&points), lines(&b)))] {
            let found = quads::read(name, text.as_bytes(), Some(1.0)).expect("a strip");
            prop_assert_eq!((found.a(), found.b()), (&points[..], &b[..]));
        }
    }

    #[test]
    fn reports_keep_every_number(values in proptest::collection::vec(any::<f64>(), 8), name in "\\PC{0,12}") {
        let mut report = super::json::tests::sample();
        let mut next = values.iter().copied().cycle();
        let figures = report.panels.iter_mut().flat_map(|p| p.figures.iter_mut()).chain(report.figures.iter_mut());
        for f in figures {
            f.value = next.next().filter(|x| x.is_finite());
        }
        report.seconds = values[0].abs().min(1e300);
        report.seconds = if report.seconds.is_finite() { report.seconds } else { 0.0 };
        report.panels[0].name = name.clone();
        report.reason = name;
        let text = report.to_json().expect("text");
        let back = Report::from_json(&text).expect("a report");
        prop_assert_eq!(back, report);
    }
}
