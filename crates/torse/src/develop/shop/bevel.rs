//! How the edges of plates are bevelled along seams, so that they meet in the middle of their angle
//! (docs/algorithms/shop.md, "Bevels").

use crate::geom::Vec3;
use crate::patchwork::outside::outward;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::seam::{Seam, SeamSide};

/// A place on a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BevelStation {
    /// Distance from the beginning of the seam along it, mm, about.
    pub position: f64,
    /// Angle between the panels, rad: positive for a ridge, seen from outside, negative for a valley.
    pub kink: f64,
}

impl BevelStation {
    /// Angle by which the edges of both plates lean from square, rad; not negative.
    pub fn bevel(&self) -> f64 {
        0.5 * self.kink.abs()
    }

    /// By how much the inside of each plate ends before its outside, mm: negative in valleys.
    pub fn setback(&self, thickness: f64) -> f64 {
        thickness * (0.5 * self.kink).tan()
    }
}

/// The bevels along a seam or joint.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamBevel {
    /// Name of the seam or joint, as its marks have it.
    pub name: String,
    /// Names of the panels or parts on both sides.
    pub between: [String; 2],
    /// Thickness of their sheet, mm, if they have one of their own.
    pub thickness: Option<f64>,
    /// Stations along it.
    pub stations: Vec<BevelStation>,
}

/// Parts of a seam between stations.
pub(crate) const PARTS: usize = 12;

/// Bevels of all seams between panels of faces; sampled.
pub(crate) fn bevels(patchwork: &Patchwork) -> Vec<SeamBevel> {
    let out = outward(patchwork);
    let of = |s: &Seam| {
        let sign = |side: &SeamSide| side.of.face().and_then(|f| out.get(f)).copied().unwrap_or(1.0);
        let signs = [sign(&s.sides[0]), sign(&s.sides[1])];
        let length = s.length();
        let station = |k: usize| {
            let share = k as f64 / PARTS as f64;
            BevelStation { position: length * share, kink: kink(s, signs, share) }
        };
        SeamBevel {
            name: format!("S{}", s.seam),
            between: s.sides.map(|side| side.of.strip.name.clone()),
            thickness: None,
            stations: (0..=PARTS).map(station).collect(),
        }
    };
    patchwork.seams().iter().map(of).collect()
}

/// Signed angle between the panels of a seam at a share of its way.
fn kink(seam: &Seam, signs: [f64; 2], share: f64) -> f64 {
    let normal = |k: usize| {
        let side = &seam.sides[k];
        let mirrored = if side.of.mirrored() { -1.0 } else { 1.0 };
        side.normal(if k == 0 { share } else { seam.opposite(share) }) * mirrored
    };
    // About the face's normal loops run counter-clockwise: inwards is square to the way on the left.
    let way = Vec3::from(seam.sides[0].run.edge.jet(share)[1]);
    let inwards = normal(0).cross(&way);
    let (a, b) = (normal(0) * signs[0], normal(1) * signs[1]);
    let angle = a.cross(&b).norm().atan2(a.dot(&b));
    // Along a ridge the first panel falls away from the plane of the second.
    if b.dot(&inwards) > 0.0 {
        -angle
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ridges_are_cut_back_inside_and_valleys_outside() {
        let ridge = BevelStation { position: 0.0, kink: 0.2 };
        let valley = BevelStation { position: 0.0, kink: -0.2 };
        assert!((ridge.bevel() - 0.1).abs() < 1e-15 && (valley.bevel() - 0.1).abs() < 1e-15);
        assert!((ridge.setback(5.0) - 5.0 * 0.1f64.tan()).abs() < 1e-15);
        assert_eq!(valley.setback(5.0), -ridge.setback(5.0));
    }
}
