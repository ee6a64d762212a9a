//! What is ordered of every part: how many, how long its cuts are, how often the beam pierces
//! (docs/algorithms/shop.md, "Orders").

use crate::develop::same::SamePart;
use crate::patchwork::pattern::{Contour, Pattern};

/// How many parts one drawing stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Quantity {
    /// Parts that are cut and bent as drawn; 0 for a part that an earlier one stands for.
    pub as_drawn: usize,
    /// Parts that are cut from the same drawing and are turned over.
    pub turned_over: usize,
}

/// How many parts each drawing stands for, given which earlier one every part equals. All of them together are as many as
/// there are parts.
pub(crate) fn quantities(same: &[Option<SamePart>]) -> Vec<Quantity> {
    let mut out: Vec<Quantity> = vec![Quantity::default(); same.len()];
    for (k, of) in same.iter().enumerate() {
        match of {
            None => out[k].as_drawn += 1,
            Some(of) if of.mirrored => out[of.pattern].turned_over += 1,
            Some(of) => out[of.pattern].as_drawn += 1,
        }
    }
    out
}

/// Length of all cuts of a part, mm: exact for lines and arcs.
pub(crate) fn cut_length(pattern: &Pattern) -> f64 {
    pattern.contours.iter().map(contour_length).sum()
}

/// Length of a closed outline of lines and arcs, mm.
fn contour_length(contour: &Contour) -> f64 {
    let v = &contour.vertices;
    let piece = |k: usize| {
        let chord = (v[(k + 1) % v.len()].point - v[k].point).norm();
        // An arc is longer than its chord by (half sweep)/sin(half sweep).
        let half = 2.0 * v[k].bulge.abs().atan();
        let sine = half.sin();
        if sine > 0.0 {
            chord * half / sine
        } else {
            chord
        }
    };
    (0..v.len()).map(piece).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;
    use crate::patchwork::pattern::ContourVertex;

    #[test]
    fn every_part_is_counted_once() {
        let of = |pattern, mirrored| Some(SamePart { pattern, mirrored });
        let found = quantities(&[None, of(0, false), None, of(0, true), of(2, false), of(0, false)]);
        let plain: Vec<(usize, usize)> = found.iter().map(|q| (q.as_drawn, q.turned_over)).collect();
        assert_eq!(plain, [(3, 1), (0, 0), (2, 0), (0, 0), (0, 0), (0, 0)]);
    }

    #[test]
    fn cuts_along_arcs_are_as_long_as_these() {
        let end = |x: f64, bulge: f64| ContourVertex { point: Vec2::new(x, 0.0), bulge, corner: true };
        let half_disc = Contour { vertices: vec![end(-5.0, 1.0), end(5.0, 0.0)] };
        let pattern = Pattern { contours: vec![half_disc.clone(), half_disc], ..Pattern::default() };
        assert!((cut_length(&pattern) - 2.0 * (10.0 + 5.0 * std::f64::consts::PI)).abs() < 1e-12);
    }
}
