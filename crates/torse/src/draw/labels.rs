//! Letters on parts: upright, clear of cuts, marks and each other, and never to be read the other way up.
//!
//! Every text asks for several places, the best first, and gets the first one whose box is free. A 6 and a 9 are
//! underlined: parts lie about in any direction.

use super::stroke_font;
use crate::geom::box_tree::BoxTree;
use crate::geom::{BBox, Vec2};

/// Place for a text: its middle, its direction of reading (unit vector) and the height of its capitals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextPlace {
    /// Middle of the box.
    pub middle: Vec2,
    /// Direction of reading.
    pub along: Vec2,
    /// Height of capitals, mm.
    pub height: f64,
}

/// What is written on a drawing, from which strokes are made only when they are asked for: parts have hundreds of points of letters.
#[derive(Clone, Debug, PartialEq)]
pub enum Lettering {
    /// Words at a place.
    Words(String, TextPlace),
    /// A line to words.
    Line([Vec2; 2]),
}

impl Lettering {
    /// Its strokes, mm.
    pub(crate) fn strokes(&self) -> Vec<Vec<Vec2>> {
        let (text, place) = match self {
            Self::Words(text, place) => (text, place),
            Self::Line(ends) => return vec![ends.to_vec()],
        };
        let up = Vec2::new(-place.along.y, place.along.x);
        let start =
            place.middle - place.along * (0.5 * stroke_font::width(text, place.height)) - up * (0.5 * place.height);
        let mut strokes = letters(text, place.height);
        strokes.iter_mut().flatten().for_each(|p| *p = start + place.along * p.x + up * p.y);
        strokes
    }

    /// The strokes of several.
    pub(crate) fn all(texts: &[Self]) -> impl Iterator<Item = Vec<Vec2>> + '_ {
        texts.iter().flat_map(Self::strokes)
    }
}

/// What is taken on one part, or on one drawing.
pub(crate) struct Labels {
    lines: Vec<[Vec2; 2]>,
    /// Over the lines.
    tree: BoxTree,
    /// What is taken besides, and the box around each.
    boxes: Vec<([Vec2; 4], BBox)>,
    /// All texts that were put.
    pub texts: Vec<Lettering>,
}

/// Length of a full stop against the height of the letters: a machine skips strokes of no length.
const DOT: f64 = 0.12;
/// Space around letters against their height.
const CLEAR: f64 = 0.25;
/// Distance of an underline below its figure, and how far it reaches, against the height.
pub(super) const UNDERLINE: f64 = 0.22;
/// Cosine below which a direction counts as level: such texts are read from the right.
const LEVEL: f64 = 1e-9;

/// A direction of reading along a line: from left to right, and upwards where the line stands upright.
pub(crate) fn upright(along: Vec2) -> Vec2 {
    if along.x < -LEVEL || (along.x <= LEVEL && along.y < 0.0) {
        -along
    } else {
        along
    }
}

impl Labels {
    /// Texts keep off these lines: outlines, marks.
    pub fn new(lines: Vec<[Vec2; 2]>) -> Self {
        let tree = BoxTree::new(lines.len(), &|k| BBox::of_flat(&lines[k]));
        Self { lines, tree, boxes: Vec::new(), texts: Vec::new() }
    }

    /// Keeps a box, by its corners, free of all that comes later.
    pub fn take(&mut self, corners: [Vec2; 4]) {
        self.boxes.push((corners, BBox::of_flat(&corners)));
    }

    /// The same of a line.
    pub fn take_line(&mut self, [a, b]: [Vec2; 2]) {
        self.take([a, b, b, a]);
    }

    /// Puts a text at the first free place; whether there was one.
    pub fn put(&mut self, text: &str, places: impl IntoIterator<Item = TextPlace>) -> bool {
        let Some(place) = places.into_iter().find(|p| self.is_free(&corners(text, p))) else { return false };
        self.write(text, &place);
        true
    }

    /// Puts a text at a place, free or not.
    pub fn write(&mut self, text: &str, place: &TextPlace) {
        self.texts.push(Lettering::Words(text.to_owned(), *place));
        self.take(corners(text, place));
    }

    /// Whether a place is free for a text.
    pub fn is_clear(&self, text: &str, place: &TextPlace) -> bool {
        self.is_free(&corners(text, place))
    }

    /// Whether a line (two points) or a convex polygon is free.
    pub fn is_free(&self, shape: &[Vec2]) -> bool {
        let here = BBox::of_flat(shape);
        shape.iter().all(|p| p.x.is_finite() && p.y.is_finite())
            && !self.boxes.iter().any(|(b, there)| here.meets(there) && overlap(shape, b))
            && !self.tree.any_meeting(&here, &mut |k| {
                let line = &self.lines[k];
                here.meets(&BBox::of_flat(line)) && overlap(shape, line)
            })
    }
}

/// Corners of the box around a text, with some space.
fn corners(text: &str, place: &TextPlace) -> [Vec2; 4] {
    let up = Vec2::new(-place.along.y, place.along.x);
    let clear = CLEAR * place.height;
    let half = 0.5 * stroke_font::width(text, place.height) + clear;
    // Underlines and tails reach below the letters.
    let (low, high) = (0.5 * place.height + UNDERLINE * place.height + clear, 0.5 * place.height + clear);
    [(-half, -low), (half, -low), (half, high), (-half, high)].map(|(x, y)| place.middle + place.along * x + up * y)
}

/// Whether two convex polygons (two points: a segment) meet: no side of one separates them.
fn overlap(a: &[Vec2], b: &[Vec2]) -> bool {
    let apart = |p: &[Vec2], q: &[Vec2]| {
        (0..p.len()).any(|k| {
            let d = p[(k + 1) % p.len()] - p[k];
            let n = Vec2::new(-d.y, d.x);
            let range = |r: &[Vec2]| {
                r.iter()
                    .map(|x| n.dot(x))
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)))
            };
            let (r, s) = (range(p), range(q));
            r.1 < s.0 || s.1 < r.0
        })
    };
    !apart(a, b) && !apart(b, a)
}

/// Whether a figure is underlined: upside down it would be another one.
pub(super) fn is_underlined(c: char) -> bool {
    matches!(c, '6' | '9')
}

/// Strokes of a text, without repeated points and without strokes of no length; a 6 and a 9 are underlined.
pub fn letters(text: &str, height: f64) -> Vec<Vec<Vec2>> {
    let mut all = stroke_font::strokes(text, height);
    for stroke in &mut all {
        stroke.dedup();
        if let [p] = stroke[..] {
            let half = Vec2::new(0.5 * DOT * height, 0.0);
            *stroke = vec![p - half, p + half];
        }
    }
    let below = -UNDERLINE * height;
    for (c, [from, to]) in stroke_font::extents(text, height) {
        if is_underlined(c) {
            all.push(vec![Vec2::new(from, below), Vec2::new(to, below)]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, along: Vec2) -> TextPlace {
        TextPlace { middle: Vec2::new(x, y), along, height: 5.0 }
    }

    #[test]
    fn texts_keep_off_lines_and_each_other() {
        let mut l = Labels::new(vec![[Vec2::new(0.0, -50.0), Vec2::new(0.0, 50.0)]]);
        // Across the line, then beside it, then on top of the first.
        assert!(l.put("S1.2", [at(0.0, 0.0, Vec2::x()), at(30.0, 0.0, Vec2::x())]));
        let before = l.texts.clone();
        assert!(Lettering::all(&l.texts).flatten().all(|p| p.x > 0.0));
        assert!(!l.put("S1.3", [at(0.0, 5.0, Vec2::x()), at(31.0, 1.0, Vec2::y())]));
        assert_eq!(l.texts, before);
    }

    #[test]
    fn what_is_taken_is_taken_inside_too() {
        let ring = |half: f64| [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec2::new(x, y) * half);
        let mut l = Labels::new(Vec::new());
        l.take(ring(20.0));
        assert!(!l.is_free(&ring(1.0)) && !l.is_free(&[Vec2::zeros(), Vec2::x()]));
        l.take_line([Vec2::new(30.0, 0.0), Vec2::new(90.0, 60.0)]);
        assert!(!l.is_free(&[Vec2::new(60.0, 20.0), Vec2::new(60.0, 40.0)]));
        assert!(l.is_free(&[Vec2::new(60.0, 10.0), Vec2::new(80.0, 30.0)]));
    }

    #[test]
    fn labels_are_read_from_below_or_from_the_right() {
        assert_eq!(upright(-Vec2::x()), Vec2::x());
        assert_eq!(upright(-Vec2::y()), Vec2::y());
        assert_eq!(upright(Vec2::new(0.6, -0.8)), Vec2::new(0.6, -0.8));
    }

    #[test]
    fn a_six_and_a_nine_are_told_apart_by_a_line_below() {
        let plain = stroke_font::strokes("A-16", 10.0).len();
        let found = letters("A-16", 10.0);
        assert_eq!(found.len(), plain + 1);
        let line = &found[plain];
        assert!(line.iter().all(|p| p.y < 0.0) && line[1].x - line[0].x > 2.0);
        // Under the last figure, not under the first letter.
        assert!(line[0].x > 0.5 * stroke_font::width("A-16", 10.0));
        assert_eq!(letters("A-08", 10.0).len(), stroke_font::strokes("A-08", 10.0).len());
    }
}
