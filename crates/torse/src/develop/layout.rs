//! Patterns side by side: rows of enclosing rectangles, for drawings that one can look at and cut from. Not a
//! nesting: shapes do not interlock.

use super::arcs;
use crate::geom::rectangle::{smallest_rectangle, Rectangle};
use crate::geom::Vec2;
use crate::surface::pattern::{Pattern, Placement};

/// Least distance between patterns, mm.
const GAP: f64 = 10.0;
/// Least distance between patterns, share of the longest.
const GAP_SHARE: f64 = 0.02;
/// Width of the drawing against its height, roughly.
const ASPECT: f64 = 1.6;

/// Places every pattern, long side along x, without overlap: first placement for the first pattern and so on.
/// The drawing begins at the origin and lies in the first quadrant.
pub fn layout(patterns: &[Pattern]) -> Vec<Placement> {
    let boxes: Vec<Rectangle> = patterns.iter().map(rectangle).collect();
    let longest = boxes.iter().map(|b| b.length).fold(0.0, f64::max);
    let gap = GAP.max(GAP_SHARE * longest);
    let area: f64 = boxes.iter().map(|b| (b.length + gap) * (b.width + gap)).sum();
    let row_length = (ASPECT * area).sqrt().max(longest + gap);
    // Wide ones first, so that rows are filled with the like.
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[b].width.total_cmp(&boxes[a].width).then(a.cmp(&b)));
    let mut out = vec![Placement { angle: 0.0, offset: Vec2::zeros() }; boxes.len()];
    let (mut x, mut y, mut height) = (0.0, 0.0, 0.0_f64);
    for k in order {
        let b = &boxes[k];
        if x > 0.0 && x + b.length > row_length {
            x = 0.0;
            y += height + gap;
            height = 0.0;
        }
        out[k] = Placement { angle: -b.angle, offset: Vec2::new(x, y) - b.corner };
        x += b.length + gap;
        height = height.max(b.width);
    }
    out
}

/// Smallest rectangle around a pattern's outlines.
fn rectangle(pattern: &Pattern) -> Rectangle {
    let mut points = Vec::new();
    for c in &pattern.contours {
        let n = c.vertices.len();
        for k in 0..n {
            let (v, w) = (&c.vertices[k], &c.vertices[(k + 1) % n]);
            points.extend(arcs::points_along(&v.point, &w.point, v.bulge, 1));
        }
    }
    smallest_rectangle(&points).unwrap_or(Rectangle { angle: 0.0, length: 0.0, width: 0.0, corner: Vec2::zeros() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::pattern::{Contour, ContourVertex};

    fn bar(length: f64, width: f64, angle: f64) -> Pattern {
        let (s, c) = angle.sin_cos();
        let vertices = [(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)]
            .map(|(x, y)| ContourVertex {
                point: Vec2::new(5.0 + c * x - s * y, -9.0 + s * x + c * y),
                bulge: 0.0,
                corner: true,
            })
            .to_vec();
        Pattern { contours: vec![Contour { vertices }], ..Pattern::default() }
    }

    #[test]
    fn placed_patterns_keep_their_distance() {
        let patterns: Vec<Pattern> = (0..17)
            .map(|k| bar(100.0 + 40.0 * f64::from(k % 5), 20.0 + 7.0 * f64::from(k % 3), f64::from(k)))
            .collect();
        let placed = layout(&patterns);
        let boxes: Vec<(Vec2, Vec2)> = patterns
            .iter()
            .zip(&placed)
            .map(|(p, q)| {
                p.contours[0].vertices.iter().fold(
                    (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY)),
                    |(lo, hi), v| {
                        let x = q.apply(&v.point);
                        (lo.inf(&x), hi.sup(&x))
                    },
                )
            })
            .collect();
        for (i, a) in boxes.iter().enumerate() {
            assert!(a.0.x > -1e-9 && a.0.y > -1e-9);
            assert!((a.1 - a.0).x >= (a.1 - a.0).y);
            for b in &boxes[i + 1..] {
                let apart = (a.0.x - b.1.x).max(b.0.x - a.1.x).max(a.0.y - b.1.y).max(b.0.y - a.1.y);
                assert!(apart >= GAP - 1e-9, "{apart}");
            }
        }
        assert!(layout(&[]).is_empty());
    }
}
