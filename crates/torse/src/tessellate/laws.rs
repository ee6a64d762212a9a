//! Laws of triangles: meshes of strips lie inside what they stand for, fit together, and show how surfaces bend.

use super::diagnostics::{curvature, joints, strip_curvature};
use super::strip::{border_line, grid, mesh, ruling_lines};
use crate::brep::support_surface::SupportSurface;
use crate::geom::generated::{frame, powers_of_ten};
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::patchwork::generated::{free_cone, round_cone};
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use proptest::prelude::*;

fn area(mesh: &Mesh) -> f64 {
    let of = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|k| mesh.positions[k as usize]);
        0.5 * (q - p).cross(&(r - p)).norm()
    };
    mesh.triangles.iter().map(of).sum()
}

fn even(strip: &Strip, parts: usize) -> Vec<f64> {
    let (a, b) = strip.domain();
    (0..=parts).map(|k| a + (b - a) * k as f64 / parts as f64).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn meshes_of_round_cones_grow_towards_their_area(cone in round_cone()) {
        let whole = cone.area();
        let areas = [1usize, 2, 8].map(|refined| {
            // Equal turns between the grid's rulings are those of equal parts, up to the parameters of the pieces.
            area(&mesh(&cone.strip, &even(&cone.strip, 8 * refined), &[0.0, 1.0], &[]))
        });
        let hair = 1e-9 * whole;
        prop_assert!(areas[0] <= areas[1] + hair && areas[1] <= areas[2] + hair && areas[2] <= whole + hair, "{areas:?}");
        // What chords lose goes with the square of their turn, which is at most a third more than the mean.
        let step = 1.35 * cone.turn / 64.0;
        prop_assert!(areas[2] >= whole * (1.0 - step * step) - hair, "{areas:?} {whole}");
        let (u, v) = grid(&cone.strip);
        let picture = mesh(&cone.strip, &u, &v, &[]);
        prop_assert!((area(&picture) - whole).abs() < 1e-3 * whole);
        // Normals are those of the surface, all to one side.
        for (p, n) in picture.positions.iter().zip(&picture.normals) {
            let jet = cone.surface.jet(cone.surface.foot(p, None));
            prop_assert!((jet.p - p).norm() < 1e-8 && jet.du.cross(&jet.dv).normalize().dot(n) > 1.0 - 1e-9);
        }
    }

    #[test]
    fn meshes_of_parts_of_a_strip_share_their_border(strip in free_cone(), cut in 1usize..7) {
        let u = even(&strip, 8);
        let v = [0.0, 0.4, 1.0];
        let [first, last, whole] = [&u[..=cut], &u[cut..], &u[..]].map(|u| mesh(&strip, u, &v, &[]));
        prop_assert_eq!(&first.positions[3 * cut..], &last.positions[..3]);
        prop_assert!((area(&first) + area(&last) - area(&whole)).abs() < 1e-9 * area(&whole));
        // Every edge inside is run through once each way, those at the border once: the mesh has no gap and no fold.
        let mut runs = std::collections::BTreeMap::new();
        for t in &whole.triangles {
            for k in 0..3 {
                *runs.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        prop_assert!(runs.values().all(|n| *n == 1));
        let open = runs.keys().filter(|(a, b)| !runs.contains_key(&(*b, *a))).count();
        prop_assert_eq!(open, 2 * (u.len() - 1) + 2 * (v.len() - 1));
        // Developable: no curvature beside that of the sheet's own bending.
        let bent = strip_curvature(&strip, &u, &v);
        prop_assert!(bent.iter().all(|k| k.abs() < 1e-9), "{bent:?}");
    }

    #[test]
    fn rulings_drawn_are_as_far_apart_as_asked(cone in round_cone(), share in 0.003..0.4f64) {
        let middle = 0.5 * (cone.radii[0] + cone.radii[1]) * cone.turn;
        let lines = ruling_lines(&cone.strip, share * middle);
        prop_assert!((lines.len() as f64 - 1.0 / share).abs() <= 1.5, "{} for {share}", lines.len());
        for w in lines.windows(2) {
            let step = (w[1][0] + w[1][1] - w[0][0] - w[0][1]).norm() * 0.5;
            // A chord is shorter than its arc; rulings inside a cell of the grid are interpolated.
            prop_assert!(step < 1.01 * share * middle && step > 0.7 * share * middle, "{step}");
        }
        for [p, q] in &lines {
            prop_assert!(((q - p).norm() - cone.length).abs() < 1e-8);
        }
        let border = border_line(&cone.strip);
        prop_assert_eq!(border.first(), border.last());
    }

    #[test]
    fn curvature_is_that_of_the_closed_form(
        frame in frame(100.0), size in powers_of_ten(-2.0..3.0), thin in powers_of_ten(-2.0..0.0),
        at in [0.05..0.95f64, 0.05..0.95],
    ) {
        let torus = SupportSurface::Torus { frame, major: size, minor: thin * size * 0.9 };
        let (patch, maps) = torus.to_spline((0.1, 1.5), (-2.0, 2.0)).expect("a torus");
        let q = [0.1 + 1.4 * at[0], -2.0 + 4.0 * at[1]];
        let found = curvature(&patch.jet(maps[0].forward(q[0]), maps[1].forward(q[1])));
        let minor = thin * size * 0.9;
        let wanted = q[1].cos() / (minor * (size + minor * q[1].cos()));
        prop_assert!((found - wanted).abs() < 1e-6 / (minor * size), "{found} {wanted}");
    }

    #[test]
    fn the_angle_of_a_hinge_is_that_between_its_wings(
        frame in frame(1e3), fold in powers_of_ten(-6.0..0.19), way in any::<bool>(), parts in 1usize..6,
    ) {
        let at = |x: f64, y: f64, z: f64| frame.to_world(&Vec3::new(x, y, z));
        let (s, c) = (if way { fold } else { -fold }).sin_cos();
        let quad = |end: [Vec3; 2]| {
            Strip::quad("w", PanelKind::Cylinder, [at(0.0, 0.0, 0.0), end[0]], [at(90.0, 0.0, 0.0), end[1]]).expect("a quad")
        };
        let flat = quad([at(0.0, 40.0, 0.0), at(90.0, 40.0, 0.0)]);
        let wing = quad([at(0.0, -50.0 * c, 50.0 * s), at(90.0, -50.0 * c, 50.0 * s)]);
        let meshes = [&flat, &wing].map(|s| mesh(s, &even(s, parts), &[0.0, 1.0], &[]));
        let found = joints(&[&meshes[0], &meshes[1]], 0.01);
        prop_assert_eq!(found.len(), parts);
        let length: f64 = found.iter().map(|(ends, _)| (ends[1] - ends[0]).norm()).sum();
        prop_assert!((length - 90.0).abs() < 1e-9);
        prop_assert!(found.iter().all(|(_, angle)| (angle - fold).abs() < 1e-9), "{found:?}");
    }
}
