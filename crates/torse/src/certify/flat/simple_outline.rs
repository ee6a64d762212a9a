//! Whether the outline drawn of a flat part meets itself, so that the sheet would have to be in two layers.
//!
//! *Theorem* \[certificate, 6\]. The map of a part to the plane is an immersion, so that it covers a place as often as the image of
//! the border winds about it. Where the outline drawn is simple, and its holes lie apart inside it, its winding is one inside
//! and none outside; the image runs within the distance proven of the drawing beside it, and winds alike about every place
//! that is farther from it. So nothing lies in two layers but, at most, in a band of that width along the cut.
//!
//! *Method.* Arcs are cut into chords that rise less than a share of the tolerance over them; exact predicates decide of the
//! polygon \[S97\].

use crate::certify::simple::polygons_are_simple;
use crate::geom::Vec2;
use crate::patchwork::pattern::{Contour, Pattern};
use crate::reason::FlatFault;

/// Share of the tolerance by which an arc may rise over the chords that stand for it.
const RISE: f64 = 0.01;

/// Sine of the angle by which a spike may not be closed: what rounding of places makes of none.
const SPIKE: f64 = 1e-9;

/// Shows that the outline of a pattern does not meet itself; `tolerance` in mm.
///
/// # Errors
/// That it does, or comes too near to tell.
pub(in crate::certify) fn outline_is_simple(pattern: &Pattern, tolerance: f64) -> Result<(), FlatFault> {
    let ring = |c: &Contour| without_spikes(chords(c, RISE * tolerance));
    let rings: Vec<Vec<[f64; 2]>> = pattern.contours.iter().map(ring).collect();
    // The greatest first, holes the other way round.
    let mut rings: Vec<(f64, Vec<[f64; 2]>)> = rings.into_iter().map(|r| (doubled_area(&r), r)).collect();
    rings.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    for (k, (area, ring)) in rings.iter_mut().enumerate() {
        if (*area > 0.0) != (k == 0) {
            ring.reverse();
        }
    }
    let rings: Vec<Vec<[f64; 2]>> = rings.into_iter().map(|r| r.1).collect();
    polygons_are_simple(&rings).map_err(|_| FlatFault::Meets)
}

/// A polygon without the places where it runs back on itself, as beside a sharp bend that takes more from the outside than
/// it needs; no place lies inside such a spike.
fn without_spikes(mut ring: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let sub = |p: [f64; 2], q: [f64; 2]| Vec2::new(p[0] - q[0], p[1] - q[1]);
    // Places that are doubled are tips of spikes without length.
    let is_spike = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let (to, back) = (sub(b, a), sub(c, b));
        b == c || to.dot(&back) < 0.0 && to.perp(&back).abs() <= SPIKE * to.norm() * back.norm()
    };
    let tip = |ring: &[[f64; 2]]| {
        let n = ring.len();
        (0..n).find(|k| is_spike(ring[(k + n - 1) % n], ring[*k], ring[(k + 1) % n]))
    };
    while let Some(k) = tip(&ring) {
        ring.remove(k);
    }
    ring
}

/// A contour as a polygon: arcs as chords over which they rise less than `rise` (mm).
fn chords(contour: &Contour, rise: f64) -> Vec<[f64; 2]> {
    /// Chords of an arc at most.
    const MOST_CHORDS: f64 = 256.0;
    let v = &contour.vertices;
    let mut out = Vec::new();
    for k in 0..v.len() {
        let (a, b) = (v[k].point, v[(k + 1) % v.len()].point);
        out.push([a.x, a.y]);
        let (chord, bulge) = (b - a, v[k].bulge);
        if bulge == 0.0 || chord.norm_squared() == 0.0 {
            continue;
        }
        // A bulge is the tangent of a quarter of the angle of its arc.
        let (angle, left) = (4.0 * bulge.atan(), Vec2::new(-chord.y, chord.x));
        let centre = a + chord * 0.5 + left * (0.25 * (1.0 / bulge - bulge));
        let radius = (a - centre).norm();
        let step = 2.0 * (1.0 - (rise / radius).min(1.0)).acos();
        let parts = (angle.abs() / step).ceil().clamp(1.0, MOST_CHORDS) as usize;
        for i in 1..parts {
            let (sin, cos) = (angle * i as f64 / parts as f64).sin_cos();
            let r = a - centre;
            out.push([centre.x + cos * r.x - sin * r.y, centre.y + sin * r.x + cos * r.y]);
        }
    }
    out
}

/// Twice the area inside, positive counter-clockwise.
fn doubled_area(ring: &[[f64; 2]]) -> f64 {
    let Some(o) = ring.first() else { return 0.0 };
    let cross = |p: &[f64; 2], q: &[f64; 2]| (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    (0..ring.len()).map(|k| cross(&ring[k], &ring[(k + 1) % ring.len()])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::pattern::ContourVertex;

    fn contour(corners: &[([f64; 2], f64)]) -> Contour {
        let vertex =
            |(p, bulge): &([f64; 2], f64)| ContourVertex { point: Vec2::from(*p), bulge: *bulge, corner: true };
        Contour { vertices: corners.iter().map(vertex).collect() }
    }

    fn judged(contours: Vec<Contour>) -> Result<(), FlatFault> {
        outline_is_simple(&Pattern { contours, ..Pattern::default() }, 0.1)
    }

    #[test]
    fn spikes_without_breadth_are_none() {
        let corners =
            [[0.0, 0.0], [10.0, 0.0], [9.0, 0.0], [20.0, 0.0], [20.0, 5.0], [9.0, 5.0], [10.0, 5.0], [0.0, 5.0]];
        for first in 0..corners.len() {
            let turned: Vec<([f64; 2], f64)> =
                (0..corners.len()).map(|k| (corners[(first + k) % corners.len()], 0.0)).collect();
            assert_eq!(judged(vec![contour(&turned)]), Ok(()), "from {first}");
        }
        // One with breadth is an overlap.
        let broad = [[0.0, 0.0], [10.0, 0.0], [9.0, 0.1], [9.0, -1.0], [20.0, 0.0], [20.0, 5.0], [0.0, 5.0]];
        assert!(judged(vec![contour(&broad.map(|p| (p, 0.0)))]).is_err());
    }

    #[test]
    fn arcs_that_reach_over_another_side_are_seen() {
        let plate =
            |bulge| contour(&[([0.0, 0.0], 0.0), ([100.0, 0.0], 0.0), ([100.0, 20.0], bulge), ([0.0, 20.0], 0.0)]);
        // A bulge of 0.5 rises a quarter of the chord: 25 mm, inwards over the lower side.
        assert_eq!(judged(vec![plate(0.5)]), Ok(()));
        assert!(judged(vec![plate(-0.5)]).is_err());
        assert_eq!(judged(vec![plate(-0.3)]), Ok(()));
    }

    #[test]
    fn a_ring_that_closes_over_itself_and_a_hole_across_the_border_are_seen() {
        // Almost a full turn of a ring: its ends apart, and one over the other.
        let ring = |turn: f64| {
            let at = |r: f64, a: f64| [r * a.cos(), r * a.sin()];
            let quarter = |r: f64, k: f64, bulge: f64| (at(r, 0.25 * k * turn), bulge);
            let bulge = (turn / 16.0).tan();
            let out = (0..=4).map(|k| quarter(100.0, f64::from(k), if k < 4 { bulge } else { 0.0 }));
            let back = (0..=4).rev().map(|k| quarter(60.0, f64::from(k), if k > 0 { -bulge } else { 0.0 }));
            contour(&out.chain(back).collect::<Vec<_>>())
        };
        assert_eq!(judged(vec![ring(6.0)]), Ok(()));
        assert!(judged(vec![ring(6.5)]).is_err());
        let square = |x: f64, s: f64| {
            contour(&[([x, 1.0], 0.0), ([x + s, 1.0], 0.0), ([x + s, 1.0 + s], 0.0), ([x, 1.0 + s], 0.0)])
        };
        let plate = || contour(&[([0.0, 0.0], 0.0), ([10.0, 0.0], 0.0), ([10.0, 10.0], 0.0), ([0.0, 10.0], 0.0)]);
        assert_eq!(judged(vec![plate(), square(1.0, 2.0), square(5.0, 2.0)]), Ok(()));
        assert!(judged(vec![plate(), square(9.0, 2.0)]).is_err());
        assert!(judged(vec![plate(), square(1.0, 2.0), square(2.0, 2.0)]).is_err());
    }
}
