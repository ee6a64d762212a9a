//! Laws of curves and surfaces of files: splines made of them, feet on them and offsets of them, slim, flat and far away.

use super::offset::of_support;
use super::parameter_map::ParameterMap;
use super::space_curve::{Arc, SpaceCurve};
use super::support_surface::SupportSurface;
use crate::geom::generated::{frame, powers_of_ten, vector};
use crate::geom::{Frame, Vec3};
use proptest::prelude::*;

/// How far places are off by rounding where numbers are so large.
fn rounding(size: f64, origin: &Vec3) -> f64 {
    1e-13 * (size + origin.norm())
}

/// A conic of size 1, some of them nearly segments or nearly lines.
fn conic() -> impl Strategy<Value = (SpaceCurve, f64)> {
    (frame(1e4), powers_of_ten(-4.0..0.0), 0usize..4).prop_map(|(frame, slim, which)| {
        let curve = match which {
            0 => SpaceCurve::Ellipse { frame, a: 1.0, b: slim },
            1 => SpaceCurve::Ellipse { frame, a: slim, b: 1.0 },
            2 => SpaceCurve::Parabola { frame, focal: slim },
            _ => SpaceCurve::Hyperbola { frame, a: slim, b: 1.0 },
        };
        (curve, frame.origin.norm())
    })
}

/// A surface of revolution of size about 1; cones from nearly cylinders to nearly planes, tori from rings to nearly spheres.
fn round() -> impl Strategy<Value = (SupportSurface, Vec3)> {
    (frame(1e3), powers_of_ten(-6.0..6.0), powers_of_ten(-3.0..0.0), 0usize..5).prop_map(
        |(frame, slope, thin, which)| {
            let surface = match which {
                0 => SupportSurface::Plane(frame),
                1 => SupportSurface::Cylinder { frame, radius: 1.0 },
                2 => SupportSurface::Cone { frame, radius: 1.0 + slope, slope },
                3 => SupportSurface::Sphere { frame, radius: 1.0 },
                _ => SupportSurface::Torus { frame, major: 1.0 + thin, minor: 1.0 },
            };
            (surface, frame.origin)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn natural_parameters_come_back_from_those_of_splines(
        start in -7.0..7.0f64, sweep in powers_of_ten(-6.0..0.2), at in -3.0..3.0f64, half in powers_of_ten(-6.0..0.7),
    ) {
        let angle = ParameterMap::Angle { start, sweep };
        let t = start + at * sweep;
        prop_assert!((angle.inverse(angle.forward(t)).0 - t).abs() < 1e-13 * (1.0 + t.abs()));
        // Increasing, and the slope is that of the map.
        let h = 1e-4 * sweep;
        let u = angle.forward(start + (at.floor() + 0.5) * sweep) + 0.3 * sweep;
        let quotient = (angle.inverse(u + h).0 - angle.inverse(u - h).0) / (2.0 * h);
        prop_assert!((quotient - angle.inverse(u).1).abs() < 1e-6 + 1e-15 / h, "{quotient}");
        let bent = ParameterMap::Hyperbolic { middle: start, half };
        let t = start + (at / 3.0) * half;
        prop_assert!((bent.inverse(bent.forward(t)).0 - t).abs() < 1e-12 * (1.0 + t.abs()));
    }

    #[test]
    fn splines_of_conics_are_the_conics(
        (curve, far) in conic(), from in -3.0..3.0f64, sweep in powers_of_ten(-5.0..0.7), share in 0.0..1.0f64,
    ) {
        let (spline, map) = curve.to_spline(from, from + sweep).expect("a spline");
        let t = from + share * sweep;
        let h = spline.point(map.forward(t));
        let (p, wanted) = (Vec3::new(h[0], h[1], h[2]) / h[3], curve.jet(t));
        let size = far + wanted[0].norm() + wanted[1].norm();
        prop_assert!((p - wanted[0]).norm() < 1e-12 * size, "{p} {}", wanted[0]);
        // The way back is the same set of points.
        let arc = Arc { curve: curve.clone(), from, to: from + sweep };
        prop_assert_eq!(arc.reversed().reversed(), arc.clone());
        prop_assert_eq!(arc.reversed().ends(), (arc.ends().1, arc.ends().0));
        // Nearest places of places of the curve are themselves.
        let foot = curve.point(curve.nearest(&wanted[0]));
        prop_assert!((foot - wanted[0]).norm() < 1e-9 * size, "{foot} {}", wanted[0]);
    }

    #[test]
    fn feet_of_places_beside_a_surface_are_as_near_as_where_they_were_put(
        (surface, origin) in round(), u in -3.1..3.1f64, v in -1.3..1.3f64, beside in -0.5..0.5f64,
    ) {
        let jet = surface.jet([u, v]);
        let n = jet.du.cross(&jet.dv).normalize();
        let x = jet.p + n * beside;
        let foot = surface.foot(&x, None);
        let size = jet.p.norm() + jet.du.norm() + jet.dv.norm();
        let found = surface.jet(foot).p;
        // Between the nappes of a cone that is nearly a plane the other one may be nearer.
        let off = (found - x).norm() - beside.abs();
        prop_assert!(off < 10.0 * rounding(size, &origin), "{found} {} {off}", jet.p);
    }

    #[test]
    fn splines_of_surfaces_are_the_surfaces(
        (surface, origin) in round(), u in -3.0..3.0f64, v in -1.3..1.0f64, sweep in powers_of_ten(-4.0..0.5),
        at in [0.0..1.0f64, 0.0..1.0],
    ) {
        let box_of = [(u, u + sweep), (v, v + 0.1 * sweep)];
        let (spline, maps) = surface.to_spline(box_of[0], box_of[1]).expect("a spline");
        let q = [0, 1].map(|k| box_of[k].0 + at[k] * (box_of[k].1 - box_of[k].0));
        let found = spline.point(maps[0].forward(q[0]), maps[1].forward(q[1]));
        let jet = surface.jet(q);
        let size = jet.p.norm() + jet.du.norm() + jet.dv.norm();
        prop_assert!((found - jet.p).norm() < 10.0 * rounding(size, &origin), "{found} {}", jet.p);
    }

    // On the nappe of the cone where its normal S_u × S_v points away from the axis: on the other one it points towards it.
    #[test]
    fn an_offset_and_back_is_where_it_was(
        (surface, origin) in round(), u in -3.1..3.1f64, v in -0.95..1.3f64, distance in -0.9..3.0f64,
    ) {
        let (beside, _) = of_support(&surface, distance, None).expect("an offset");
        let (back, _) = of_support(&beside, -distance, None).expect("an offset back");
        let jet = surface.jet([u, v]);
        let over = jet.p + jet.du.cross(&jet.dv).normalize() * distance;
        let size = over.norm() + jet.du.norm() + jet.dv.norm();
        let near = 10.0 * rounding(size, &origin);
        prop_assert!((beside.jet(beside.foot(&over, None)).p - over).norm() < near);
        prop_assert!((back.jet([u, v]).p - jet.p).norm() < near);
    }

    #[test]
    fn extruded_and_turned_lines_are_the_surfaces_that_they_make(
        place in frame(100.0), tilt in vector(), u in -3.0..3.0f64, v in -1.0..1.0f64,
    ) {
        // A line turned about an axis that it meets or passes: feet of its places are its places.
        let lean = Vec3::new(0.8 * tilt.x, 0.0, 1.0);
        let frame = Frame { ..place };
        let directrix = SpaceCurve::Line {
            origin: frame.to_world(&Vec3::new(1.5, 0.3 * tilt.y, 0.0)), direction: frame.vector_to_world(&lean),
        };
        let turned = SupportSurface::Revolution { directrix: directrix.clone(), frame };
        let drawn = SupportSurface::Extrusion { directrix, direction: frame.y + frame.x * (0.5 * tilt.z) };
        for surface in [turned, drawn] {
            let p = surface.jet([u, v]).p;
            let found = surface.jet(surface.foot(&p, None)).p;
            prop_assert!((found - p).norm() < 1e-9 * (1.0 + p.norm()), "{found} {p}");
        }
    }
}
