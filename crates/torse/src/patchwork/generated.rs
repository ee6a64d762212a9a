//! Developable strips drawn at random, for laws of the floors above: round and free cones, from nearly flat ones to nearly
//! cylinders, anywhere in space.

use crate::brep::support_surface::SupportSurface;
use crate::geom::generated::{frame, powers_of_ten, vector};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use proptest::prelude::*;

/// A strip of a round cone between two circles, with what is known of it.
#[derive(Clone, Debug)]
pub(crate) struct RoundCone {
    /// The strip; its rulings are lines v of the surface.
    pub strip: Strip,
    /// The surface, whose parameter v is the height of the strip's places.
    pub surface: SupportSurface,
    /// Radii of both circles, mm.
    pub radii: [f64; 2],
    /// Length of the rulings, mm.
    pub length: f64,
    /// Turn about the axis, rad.
    pub turn: f64,
}

impl RoundCone {
    /// Area between the circles, mm².
    pub fn area(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1]) * self.turn * self.length
    }
}

/// Strips of round cones of some 100 mm: slopes from those of cylinders to those of nearly flat discs, turns from slivers to nearly
/// whole ones.
pub(crate) fn round_cone() -> impl Strategy<Value = RoundCone> {
    (frame(1e4), powers_of_ten(-9.0..3.0), 20.0..200.0f64, powers_of_ten(-3.0..0.7), 0.0..1.0f64).prop_map(
        |(frame, slope, radius, turn, start)| {
            let height = 80.0 / slope.hypot(1.0);
            let surface = SupportSurface::Cone { frame, radius, slope };
            let (patch, _) = surface.to_spline((start, start + turn), (0.0, height)).expect("a cone");
            let side = |end: usize| Curve {
                knots: patch.knots_u.clone(),
                control: patch.control.iter().skip(end).step_by(2).copied().collect(),
            };
            let strip = Strip::between("cone", PanelKind::Cone, &side(0), &side(1)).expect("a strip");
            RoundCone { strip, surface, radii: [radius, radius + slope * height], length: 80.0, turn }
        },
    )
}

/// Strips of free cones of some 100 mm between a cubic and its image towards the apex, which lies near the strip or as far as a
/// cylinder's would; some are flat but for a hair.
pub(crate) fn free_cone() -> impl Strategy<Value = Strip> {
    (frame(1e4), [vector(), vector(), vector(), vector()], powers_of_ten(-9.0..0.0), powers_of_ten(2.3..8.0), vector())
        .prop_map(|(frame, jitter, flat, distance, lean)| free_cone_of(&frame, &jitter, flat, (distance, lean)))
}

fn free_cone_of(frame: &Frame, jitter: &[Vec3; 4], flat: f64, (distance, lean): (f64, Vec3)) -> Strip {
    const WIDTH: f64 = 60.0;
    let apex = Vec3::new(50.0 + 0.3 * distance * lean.x, -distance, 0.3 * distance * lean.z * flat);
    let share = WIDTH / distance;
    let (mut near, mut far) = (Vec::new(), Vec::new());
    for (i, j) in jitter.iter().enumerate() {
        let a = Vec3::new(100.0 * i as f64 / 3.0 + 12.0 * j.x, 12.0 * j.y, 40.0 * flat * j.z);
        near.push(<[f64; 3]>::from(frame.to_world(&a)));
        far.push(<[f64; 3]>::from(frame.to_world(&(a + (apex - a) * share))));
    }
    let curve = |control| Curve::new(3, [[0.0; 4], [1.0; 4]].concat(), control).expect("a cubic");
    Strip::polynomial("free", PanelKind::Cone, &curve(near), &curve(far)).expect("a strip")
}
