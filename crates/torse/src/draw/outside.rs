//! Names of narrow parts in drawings: on the drawing beside the part, with a line to it, clear of all cuts and of each other.
//!
//! Places are tried as those of all letters of drawings are, see [`super::labels`]: from points of the outline outwards, the
//! nearest first, and the first free one is taken.

use super::labels::{Labels, Lettering, TextPlace};
use super::stroke_font;
use crate::geom::box_tree::BoxTree;
use crate::geom::polygon::inside;
use crate::geom::{BBox, Vec2};

/// A part whose name has no room on it.
#[derive(Clone, Debug)]
pub(super) struct Unnamed {
    /// Its number among the outlines of all parts.
    pub part: usize,
    /// What is written: the name, and lines in smaller letters below it.
    pub lines: Vec<String>,
}

/// Height of capitals of these names against the length of the longest part, which gaps between parts go with, and its limits,
/// mm.
const HEIGHT_SHARE: f64 = 0.006;
/// See [`HEIGHT_SHARE`].
const HEIGHT: (f64, f64) = (2.5, 12.0);
/// Height of the lines below a name against it.
const SMALL: f64 = 0.7;
/// Distance of the lines of words from each other against their height.
const LINE: f64 = 1.6;
/// Space about the words against the height of the name.
const CLEAR: f64 = 0.4;
/// Points of an outline from which a line to a name is tried, besides its outermost ones.
const FEET: usize = 32;
/// Distance from the outline at which the line to a name begins, against the height of the name: no stroke touches a cut.
const OFF: f64 = 0.3;
/// First distance of the words from the outline against the height, and by what it grows.
const AWAY: (f64, f64) = (1.0, 1.6);

/// The names that have no room on their parts, in the order of `unnamed`; `None` for those without any free place.
/// `outlines` are those of all parts, at most a little (mm) rough.
pub(super) fn names(unnamed: &[Unnamed], outlines: &[Vec<Vec<Vec2>>]) -> Vec<Option<Vec<Lettering>>> {
    let boxes: Vec<BBox> = outlines.iter().map(|o| BBox::of_flat(o.iter().flatten())).collect();
    let longest = boxes.iter().map(|b| (b.max - b.min).max()).filter(|x| x.is_finite()).fold(0.0, f64::max);
    let height = (HEIGHT_SHARE * longest).clamp(HEIGHT.0, HEIGHT.1);
    let sides = outlines.iter().flatten().flat_map(|o| (0..o.len()).map(|k| [o[k], o[(k + 1) % o.len()]]));
    let labels = Labels::new(sides.collect());
    let parts = BoxTree::new(boxes.len(), &|k| boxes[k]);
    let mut drawing = NamedDrawing { outlines, labels, named: Vec::new(), parts, height, longest };
    unnamed.iter().map(|u| drawing.put(u)).collect()
}

/// The drawing so far.
struct NamedDrawing<'a> {
    outlines: &'a [Vec<Vec<Vec2>>],
    /// What names keep off: outlines, and the names put so far with the lines to them.
    labels: Labels,
    /// Boxes around these names, each with its line.
    named: Vec<BBox>,
    /// Over the boxes of all parts.
    parts: BoxTree,
    height: f64,
    longest: f64,
}

impl NamedDrawing<'_> {
    fn put(&mut self, unnamed: &Unnamed) -> Option<Vec<Lettering>> {
        // All lines, else the name alone.
        (0..2).find_map(|k| self.put_block(unnamed.part, if k == 0 { &unnamed.lines } else { &unnamed.lines[..1] }))
    }

    fn put_block(&mut self, part: usize, lines: &[String]) -> Option<Vec<Lettering>> {
        let size = |k: usize| if k == 0 { self.height } else { SMALL * self.height };
        let wide = lines.iter().enumerate().map(|(k, l)| stroke_font::width(l, size(k))).fold(0.0, f64::max);
        let tall = self.height + LINE * SMALL * self.height * (lines.len() - 1) as f64;
        let half = Vec2::new(0.5 * wide, 0.5 * tall) + Vec2::repeat(CLEAR * self.height);
        let feet = feet(self.outlines.get(part)?.first()?);
        // Best so that no name stands between another one and its part.
        for apart in [true, false] {
            let mut away = AWAY.0 * self.height;
            while away < self.longest.max(4.0 * self.height) {
                if let Some((middle, leader)) = self.free(&feet, half, away, apart) {
                    self.named.push(whole(middle, half, &leader));
                    self.labels.take_line(leader);
                    self.labels.take(corners(middle, half));
                    return Some(written(lines, middle, (tall, self.height), leader));
                }
                away *= AWAY.1;
            }
        }
        None
    }

    /// The first free place of words of half the size `half` at a distance from the outline, and the line to it.
    fn free(&self, feet: &[Vec2], half: Vec2, away: f64, apart: bool) -> Option<(Vec2, [Vec2; 2])> {
        let step = 0.5f64.sqrt();
        let ways =
            [(0., 1.), (0., -1.), (1., 0.), (-1., 0.), (step, step), (-step, step), (step, -step), (-step, -step)];
        let places = feet.iter().flat_map(|foot| ways.map(|(x, y)| (*foot, Vec2::new(x, y))));
        let place = |(foot, way): (Vec2, Vec2)| {
            let edge = foot + way * away;
            let side = |w: f64| if w == 0.0 { 0.0 } else { w.signum() };
            (edge + half.component_mul(&way.map(side)), [foot + way * (OFF * self.height), edge])
        };
        places.map(place).find(|(middle, leader)| {
            self.labels.is_free(&corners(*middle, half))
                && self.labels.is_free(leader)
                && ![*middle, leader[0]].iter().any(|p| self.is_on_part(p))
                && !(apart && self.named.iter().any(|n| n.meets(&whole(*middle, half, leader))))
        })
    }

    /// Whether a point lies on any part.
    fn is_on_part(&self, p: &Vec2) -> bool {
        self.parts.any_meeting(&BBox::of_flat([p]), &mut |k| inside(&self.outlines[k], p))
    }
}

/// The box around words of half the size `half` and the line to them.
fn whole(middle: Vec2, half: Vec2, leader: &[Vec2; 2]) -> BBox {
    BBox::of_flat(&[middle - half, middle + half, leader[0], leader[1]])
}

/// Corners of a box, counter-clockwise.
fn corners(middle: Vec2, half: Vec2) -> [Vec2; 4] {
    [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| middle + half.component_mul(&Vec2::new(x, y)))
}

/// Lines of words, centred, and the line to them.
fn written(lines: &[String], middle: Vec2, (tall, height): (f64, f64), leader: [Vec2; 2]) -> Vec<Lettering> {
    let mut labels = Labels::new(Vec::new());
    let mut top = middle.y + 0.5 * tall;
    for (k, text) in lines.iter().enumerate() {
        let (height, step) = if k == 0 { (height, height) } else { (SMALL * height, LINE * SMALL * height) };
        top -= step;
        let middle = Vec2::new(middle.x, top + 0.5 * height);
        labels.write(text, &TextPlace { middle, along: Vec2::x(), height });
    }
    labels.texts.push(Lettering::Line(leader));
    labels.texts
}

/// The outermost points of an outline and points along it, at equal distances.
fn feet(outline: &[Vec2]) -> Vec<Vec2> {
    let mut out: Vec<Vec2> = [Vec2::x(), -Vec2::x(), Vec2::y(), -Vec2::y()]
        .iter()
        .filter_map(|way| outline.iter().copied().max_by(|a, b| way.dot(a).total_cmp(&way.dot(b))))
        .collect();
    let side = |k: usize| (outline[k], outline[(k + 1) % outline.len()]);
    let total: f64 = (0..outline.len()).map(|k| (side(k).1 - side(k).0).norm()).sum();
    let (mut next, mut run) = (0.0, 0.0);
    for (a, b) in (0..outline.len()).map(side) {
        let length = (b - a).norm();
        while next < run + length && out.len() < FEET + 4 {
            out.push(a + (b - a) * ((next - run) / length));
            next += total / FEET as f64;
        }
        run += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::drawing::{drawing, DrawingOptions, DrawnPattern};
    use crate::patchwork::pattern::{Contour, ContourVertex, Pattern, Placement};

    /// A strip of 1000 mm, so narrow that no name is legible on it.
    fn strip(k: usize) -> (Pattern, Placement) {
        let corner = |x, y| ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: true };
        let vertices = vec![corner(0., 0.), corner(1000., 0.), corner(1000., 3.), corner(0., 3.)];
        let pattern = Pattern {
            panel: k,
            name: format!("A-{:02}", k + 1),
            contours: vec![Contour { vertices }],
            area: 3000.0,
            length: 1000.0,
            width: 3.0,
            ..Pattern::default()
        };
        (pattern, Placement { angle: 0.0, offset: Vec2::new(0.0, 23.0 * k as f64) })
    }

    /// Corners of the box around outlines.
    fn extent(outlines: &[Vec<Vec2>]) -> [Vec2; 2] {
        let b = BBox::of_flat(outlines.iter().flatten());
        [b.min.xy(), b.max.xy()]
    }

    fn inside(p: &Vec2, y: f64) -> bool {
        p.x >= 0.0 && p.x <= 1000.0 && p.y >= y && p.y <= y + 3.0
    }

    /// Points of a stroke, close to each other.
    fn points(stroke: &[Vec2]) -> Vec<Vec2> {
        let between = |w: &[Vec2]| -> Vec<Vec2> {
            let (a, b) = (w[0], w[1]);
            (0..=50).map(|k| a + (b - a) * (f64::from(k) / 50.0)).collect()
        };
        stroke.windows(2).flat_map(between).collect()
    }

    #[test]
    fn narrow_parts_are_named_beside_clear_of_all_cuts_and_of_each_other() {
        let (patterns, placements): (Vec<_>, Vec<_>) = (0..6).map(strip).unzip();
        let d = drawing(&patterns, &placements, &[false, true], &DrawingOptions::default());
        let boxed = |p: &DrawnPattern| {
            let ends = [Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY)];
            p.strokes().flatten().fold(ends, |[l, h], p| [l.inf(&p), h.sup(&p)])
        };
        for (k, piece) in d.pieces.iter().enumerate() {
            assert!(piece.strokes().count() > 4, "{} has a name", piece.name);
            // But for the warning, which stands on the part at any price.
            if !piece.marked {
                for p in piece.strokes().flat_map(|s| points(&s)) {
                    assert!((0..6).all(|i| !inside(&p, 23.0 * i as f64)), "{} runs over a part at {p}", piece.name);
                }
                let [low, high] = boxed(piece);
                let meets = |[l, h]: [Vec2; 2]| l.x <= high.x && low.x <= h.x && l.y <= high.y && low.y <= h.y;
                assert!(!d.pieces[..k].iter().filter(|p| !p.marked).any(|p| meets(boxed(p))), "{}", piece.name);
                // Legible: capitals of 6 mm and more, and the line to them.
                assert!(high.y - low.y > 5.0 && high.x - low.x > 10.0);
            }
            assert!(piece.strokes().flatten().all(|p| p.x >= d.min.x && p.x <= d.max.x && p.y >= d.min.y));
        }
    }

    #[test]
    fn names_without_their_lines_stand_in_no_other_block() {
        // Small parts so close that not all have room for every line.
        let square = |k: usize| {
            let corner = Vec2::new(19.0 * (k % 4) as f64, 16.0 * (k / 4) as f64);
            vec![[(0., 0.), (12., 0.), (12., 12.), (0., 12.)].map(|(x, y)| corner + Vec2::new(x, y)).to_vec()]
        };
        let outlines: Vec<Vec<Vec<Vec2>>> = (0..16).map(square).collect();
        let lines =
            |k: usize| ["", " OF A MODEL", " SEEN FROM OUTSIDE", " 12.0 X 12.0 MM"].map(|l| format!("{k}{l}")).to_vec();
        let unnamed: Vec<Unnamed> = (0..16).map(|part| Unnamed { part, lines: lines(part) }).collect();
        let found = names(&unnamed, &outlines);
        // The last one is the line to the name.
        let boxed = |t: &Vec<Lettering>| extent(&Lettering::all(&t[..t.len() - 1]).collect::<Vec<_>>());
        let boxes: Vec<[Vec2; 2]> = found.iter().flatten().map(boxed).collect();
        let meet = |[a, b]: &[Vec2; 2], [c, d]: &[Vec2; 2]| a.x <= d.x && c.x <= b.x && a.y <= d.y && c.y <= b.y;
        assert!(boxes.len() > 8);
        for (k, one) in boxes.iter().enumerate() {
            assert!(!boxes[..k].iter().any(|other| meet(one, other)), "{k} {boxes:?}");
        }
    }

    #[test]
    fn names_stay_on_parts_that_have_room() {
        let (mut pattern, placement) = strip(0);
        for v in &mut pattern.contours[0].vertices {
            v.point.y *= 20.0;
        }
        (pattern.area, pattern.width) = (60_000.0, 60.0);
        let d = drawing(&[pattern], &[placement], &[], &DrawingOptions::default());
        let within = |p: &Vec2| p.x > 0.0 && p.x < 1000.0 && p.y > 0.0 && p.y < 60.0;
        assert!(d.pieces[0].strokes().count() > 4 && d.pieces[0].strokes().flatten().all(|p| within(&p)));
    }
}
