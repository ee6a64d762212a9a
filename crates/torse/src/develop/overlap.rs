//! Whether a flat outline overlaps itself. A development is an immersion, so the flat pattern is free of overlaps
//! exactly if its border loops are simple and do not cross each other.

use crate::geom::{Vec2, Vec3};

/// A sample of the outline.
#[derive(Clone, Copy, Debug)]
pub struct OutlinePoint {
    /// Place in the plane.
    pub flat: Vec2,
    /// Place in space.
    pub space: Vec3,
    /// Ruling.
    pub t: f64,
}

/// A crossing of the flat outline with itself: the rulings of both points that fall together.
///
/// *Input*: closed loops of samples. *Method*: all pairs of chords by a sweep over x; crossings whose points are
/// closer than `apart` in space are chords that cut a sharp corner, not overlaps.
/// *Not guaranteed*: overlaps narrower than the chords' distance from the outline.
pub fn overlap(loops: &[Vec<OutlinePoint>], apart: f64) -> Option<(f64, f64)> {
    let mut chords: Vec<(f64, f64, &OutlinePoint, &OutlinePoint)> = Vec::new();
    for l in loops {
        for k in 0..l.len() {
            let (p, q) = (&l[k], &l[(k + 1) % l.len()]);
            chords.push((p.flat.x.min(q.flat.x), p.flat.x.max(q.flat.x), p, q));
        }
    }
    chords.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (i, a) in chords.iter().enumerate() {
        for b in chords[i + 1..].iter().take_while(|b| b.0 <= a.1) {
            let Some((x, y)) = crossing(&a.2.flat, &a.3.flat, &b.2.flat, &b.3.flat) else { continue };
            let p = a.2.space + (a.3.space - a.2.space) * x;
            let q = b.2.space + (b.3.space - b.2.space) * y;
            if (p - q).norm() > apart {
                return Some((a.2.t + (a.3.t - a.2.t) * x, b.2.t + (b.3.t - b.2.t) * y));
            }
        }
    }
    None
}

/// Shares along both segments at which they cross in their interiors.
fn crossing(a: &Vec2, b: &Vec2, c: &Vec2, d: &Vec2) -> Option<(f64, f64)> {
    let (u, v, w) = (b - a, d - c, c - a);
    let det = u.perp(&v);
    if det == 0.0 {
        return None;
    }
    let (x, y) = (w.perp(&v) / det, w.perp(&u) / det);
    (x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0).then_some((x, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Band around a circle, flat, over `turn` radians; in space it climbs.
    fn band(turn: f64) -> Vec<OutlinePoint> {
        let n = 100;
        let point = |radius: f64, k: usize| {
            let a = turn * k as f64 / n as f64;
            let flat = Vec2::new(radius * a.cos(), radius * a.sin());
            OutlinePoint { flat, space: Vec3::new(flat.x, flat.y, 3.0 * a), t: k as f64 / n as f64 }
        };
        (0..=n)
            .map(|k| point(10.0, k))
            .chain((0..=n).rev().map(|k| point(9.0 + 0.5 * k as f64 / n as f64, k)))
            .collect()
    }

    #[test]
    fn a_band_that_closes_overlaps_and_names_a_ruling_between() {
        assert_eq!(overlap(&[band(6.0)], 0.1), None);
        let (a, b) = overlap(&[band(7.0)], 0.1).expect("an overlap");
        assert!((a - b).abs() > 0.8);
    }

    #[test]
    fn chords_that_cut_a_sharp_corner_are_no_overlap() {
        let p = |x: f64, y: f64| OutlinePoint { flat: Vec2::new(x, y), space: Vec3::new(x, y, 0.0), t: x };
        let sliver = vec![p(0.0, 0.0), p(10.0, 1.0), p(10.0, 1.1), p(1.0, 0.0999)];
        assert_eq!(overlap(&[sliver], 0.01), None);
    }
}
