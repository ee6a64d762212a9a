//! Patterns side by side: enclosing rectangles packed onto a sheet, for drawings that one can look at and cut from.
//! Not a nesting: shapes do not interlock.
//!
//! Bottom-left packing under a skyline: each rectangle goes where its lower edge comes to lie lowest, then leftmost. What
//! lies under the skyline is never used again, so that rectangles cannot overlap. Several lengths of the sheet are tried.

use super::arcs;
use crate::geom::rectangle::Rectangle;
use crate::geom::Vec2;
use crate::patchwork::pattern::{Pattern, Placement};

/// Least distance between patterns, mm.
const GAP: f64 = 10.0;
/// Least distance between patterns, share of the longest.
const GAP_SHARE: f64 = 0.02;
/// Least and greatest length of the sheet against its height that are aimed at: it shall fit a screen and a page.
const ASPECT: (f64, f64) = (1.0, 2.6);
/// Lengths of the sheet that are tried within these.
const TRIALS: usize = 24;
/// Patterns above which fewer lengths are tried: the work grows with the square of their number.
const MANY_PATTERNS: usize = 500;

/// Places every pattern, long side along x, without overlap: first placement for the first pattern and so on.
/// The drawing begins at the origin and lies in the first quadrant. Patterns are at least 10 mm and a fiftieth of the
/// longest apart, measured between their enclosing rectangles.
///
/// *Not guaranteed*: the smallest sheet.
pub fn layout(patterns: &[Pattern]) -> Vec<Placement> {
    let boxes: Vec<Rectangle> = patterns.iter().map(rectangle).collect();
    let longest = boxes.iter().map(|b| b.length).fold(0.0, f64::max);
    let gap = GAP.max(GAP_SHARE * longest);
    let area: f64 = boxes.iter().map(|b| (b.length + gap) * (b.width + gap)).sum();
    let orders = [order(&boxes, |b| b.width), order(&boxes, |b| b.length), order(&boxes, |b| b.length * b.width)];
    let trials = if boxes.len() > MANY_PATTERNS { 3 } else { TRIALS };
    let mut best: Option<(f64, Vec<Vec2>)> = None;
    for k in 0..trials {
        let aspect = ASPECT.0 + (ASPECT.1 - ASPECT.0) * k as f64 / (trials - 1) as f64;
        let length = (aspect * area).sqrt().max(longest + gap);
        for order in &orders {
            let corners = pack(&boxes, order, length, gap);
            let extent =
                boxes.iter().zip(&corners).fold(Vec2::zeros(), |m, (b, c)| m.sup(&(c + Vec2::new(b.length, b.width))));
            // A sheet that is too long or too high counts as if it filled the shape that is aimed at.
            let height = extent.y.max(extent.x / ASPECT.1);
            let size = extent.x.max(height * ASPECT.0) * height;
            if best.as_ref().is_none_or(|(least, _)| size < *least) {
                best = Some((size, corners));
            }
        }
    }
    let corners = best.map_or(Vec::new(), |b| b.1);
    boxes.iter().zip(corners).map(|(b, c)| Placement { angle: -b.angle, offset: c - b.corner }).collect()
}

/// Largest first; equals in their own order.
fn order(boxes: &[Rectangle], size: impl Fn(&Rectangle) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| size(&boxes[b]).total_cmp(&size(&boxes[a])).then(a.cmp(&b)));
    order
}

/// Lower left corners of the boxes on a sheet of the given length.
fn pack(boxes: &[Rectangle], order: &[usize], length: f64, gap: f64) -> Vec<Vec2> {
    let mut corners = vec![Vec2::zeros(); boxes.len()];
    // Steps of the skyline from left to right: (start, height); each ends where the next starts.
    let mut skyline = vec![(0.0, 0.0)];
    for &k in order {
        let (w, h) = (boxes[k].length + gap, boxes[k].width + gap);
        let mut place: Option<(f64, f64)> = None;
        for (i, &(x, _)) in skyline.iter().enumerate() {
            // The first step is always tried, so that every box finds a place.
            if i > 0 && x + w > length + gap {
                break;
            }
            let under = skyline[i..].iter().take_while(|s| s.0 < x + w);
            let y = under.map(|s| s.1).fold(0.0, f64::max);
            if place.is_none_or(|p| y < p.1) {
                place = Some((x, y));
            }
        }
        let (x, y) = place.unwrap_or((0.0, 0.0));
        corners[k] = Vec2::new(x, y);
        raise(&mut skyline, x, x + w, y + h);
    }
    corners
}

/// Lifts the skyline to `height` between `from` and `to`.
fn raise(skyline: &mut Vec<(f64, f64)>, from: f64, to: f64, height: f64) {
    let after = skyline.iter().rev().find(|s| s.0 <= to).map_or(0.0, |s| s.1);
    skyline.retain(|s| s.0 < from || s.0 > to);
    let i = skyline.iter().take_while(|s| s.0 < from).count();
    skyline.splice(i..i, [(from, height), (to, after)]);
}

/// Smallest rectangle around a pattern's outline.
fn rectangle(pattern: &Pattern) -> Rectangle {
    arcs::rectangle_around(&pattern.contours).unwrap_or(Rectangle {
        angle: 0.0,
        length: 0.0,
        width: 0.0,
        corner: Vec2::zeros(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points along the contours.
    fn outline(pattern: &Pattern) -> Vec<Vec2> {
        let all = |c: &Contour| {
            let next = c.vertices.iter().cycle().skip(1);
            let pieces = c.vertices.iter().zip(next);
            pieces.flat_map(|(v, w)| arcs::points_along(&v.point, &w.point, v.bulge, 1)).collect::<Vec<_>>()
        };
        pattern.contours.iter().flat_map(all).collect()
    }

    /// Share of the sheet that the patterns fill: their area by that of the rectangle around all of them, holes counted
    /// as cut away. 0 without patterns.
    fn filled(patterns: &[Pattern], placements: &[Placement]) -> f64 {
        let (mut lo, mut hi) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        let mut area = 0.0;
        for (pattern, place) in patterns.iter().zip(placements) {
            area += pattern.area;
            for p in outline(pattern).iter().map(|p| place.apply(p)) {
                (lo, hi) = (lo.inf(&p), hi.sup(&p));
            }
        }
        let sheet = (hi - lo).product();
        if sheet > 0.0 && sheet.is_finite() {
            area / sheet
        } else {
            0.0
        }
    }

    use crate::patchwork::pattern::{Contour, ContourVertex};

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
        // The rectangles fill most of the sheet, the gaps included.
        let sheet = boxes.iter().fold(Vec2::zeros(), |m, b| m.sup(&b.1)) + Vec2::repeat(GAP);
        let with_gaps: f64 = boxes.iter().map(|b| (b.1 - b.0 + Vec2::repeat(GAP)).product()).sum();
        assert!(with_gaps > 0.85 * sheet.product(), "{} of {}", with_gaps, sheet.product());
    }

    #[test]
    fn a_sheet_of_equal_bars_is_filled() {
        let mut patterns = vec![bar(990.0, 190.0, 0.3); 6];
        for p in &mut patterns {
            p.area = 990.0 * 190.0;
        }
        let placed = layout(&patterns);
        assert!(filled(&patterns, &placed) > 0.9, "{}", filled(&patterns, &placed));
        assert!(filled(&[], &[]) == 0.0);
    }
}
