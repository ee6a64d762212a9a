//! The cutter's drawing: patterns placed side by side, every letter a stroke, sorted by what the machine does with
//! it. Curves of outlines stay lines and arcs. Lengths in mm, y upwards.

use super::labels::{is_underlined, upright, Labels, UNDERLINE};
pub use super::labels::{Lettering, TextPlace};
use super::outside::{self, Unnamed};
use super::scene::{titled, NOT_CERTIFIED};
use super::{flat, stroke_font};
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::num::parallel;
use crate::patchwork::pattern::{BendSense, Contour, ContourVertex, MarkLine, Pattern, Placement};

/// All patterns of a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// One entry per pattern.
    pub pieces: Vec<DrawnPattern>,
    /// Smallest x and y of anything drawn.
    pub min: Vec2,
    /// Largest x and y of anything drawn.
    pub max: Vec2,
    /// Unit of the coordinates in files; everything here is in mm.
    pub unit: LengthUnit,
    /// A square of known size, not to be cut.
    pub test_square: Option<TestSquare>,
}

/// A square by which the shop sees the scale of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct TestSquare {
    /// Corners, counter-clockwise, mm.
    pub corners: [Vec2; 4],
    /// Its size in words.
    pub texts: Vec<Lettering>,
}

/// One pattern as drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnPattern {
    /// Name of the panel.
    pub name: String,
    /// Outer outline, closed.
    pub outer: Option<Contour>,
    /// Outlines of holes, closed.
    pub inner: Vec<Contour>,
    /// Rulings: do not cut.
    pub rulings: Vec<[Vec2; 2]>,
    /// Which way the sheet bends about each ruling; flat where nothing is said.
    pub senses: Vec<BendSense>,
    /// Lines where bent zones begin and end: do not cut.
    pub extents: Vec<[Vec2; 2]>,
    /// Outlines of formed features: do not cut.
    pub formed: Vec<Contour>,
    /// Lines in which planes cut the part: do not cut.
    pub sections: Vec<MarkLine>,
    /// Curves of the model that lie on the part: do not cut.
    pub curves: Vec<MarkLine>,
    /// Matching marks: short lines from the outline inwards.
    pub marks: Vec<[Vec2; 2]>,
    /// The panel's name, words below it, and the marks' labels.
    pub texts: Vec<Lettering>,
    /// Whether the part must not be cut: it is not certified.
    pub marked: bool,
}

impl DrawnPattern {
    /// Strokes of all that is written on it.
    pub(crate) fn strokes(&self) -> impl Iterator<Item = Vec<Vec2>> + '_ {
        Lettering::all(&self.texts)
    }

    /// The rulings about which the sheet bends in a sense.
    pub(crate) fn bent(&self, sense: BendSense) -> impl Iterator<Item = &[Vec2; 2]> {
        let of = move |k: usize| self.senses.get(k).copied().unwrap_or_default();
        self.rulings.iter().enumerate().filter(move |(k, _)| of(*k) == sense).map(|(_, r)| r)
    }
}

/// Decimals of millimetres to which files tell letters, whose lines no part depends on.
pub(crate) const LETTER_DECIMALS: usize = 3;
/// Chord error (share of the pattern's length) of the outlines on which the place of the name is sought.
const ROUGH: f64 = 1e-3;
/// The same as a share of the pattern's mean width: names keep off the outlines of narrow parts.
const ROUGH_ACROSS: f64 = 0.01;
/// Largest height of capitals of a name, mm.
const NAME_HEIGHT: f64 = 40.0;
/// Least height of capitals of a name on its part, mm: the smallest lettering of technical drawings (ISO 3098). Where there is no
/// room for that, the name stands beside the part.
const LEAST_NAME: f64 = 1.8;
/// Height of a name against the radius of the free circle in which it stands.
const NAME_SHARE: f64 = 0.5;
/// Width of a name against that radius.
const NAME_WIDTH: f64 = 1.6;
/// Height of the words that say from where the part is seen against that of its name.
const SIDE_SHARE: f64 = 0.35;
/// Width of these words against the radius of the circle.
const SIDE_WIDTH: f64 = 1.2;
/// Distance of lines of words from each other against their height.
const LINE: f64 = 1.6;
/// Height of the marks' labels against the same radius, and its limits, mm: readable, but small beside the part.
const LABEL_SHARE: f64 = 0.05;
/// See [`LABEL_SHARE`].
const LABEL_HEIGHT: (f64, f64) = (1.5, 10.0);
/// On tiny parts labels are no taller than this share of the radius, readable or not.
const LABEL_MOST: f64 = 0.2;
/// Distance of the words about a part that must not be cut from its name, against their height.
const WORDS_GAP: f64 = 0.6;
/// Length of a mark against the height of its label.
const TICK: f64 = 1.5;
/// Share of their size to which words about cutting shrink at most, where the circle is narrow.
const LEAST_WORDS: f64 = 0.4;
/// Sizes in which the words in the circle are tried.
const SHRUNK: [f64; 6] = [1.0, 0.85, 0.7, 0.55, 0.4, 0.25];
/// Sizes in which the label of a mark is tried.
const SMALLER: [f64; 3] = [1.0, 0.75, 0.5];
/// Distances from the mark, against the height, at which its label is tried.
const DEEPER: [f64; 4] = [1.0, 2.2, 4.0, -0.9];
/// Distance of the test square from the parts, mm.
const SQUARE_GAP: f64 = 10.0;
/// Height of the words in it against its side.
const SQUARE_WORDS: f64 = 0.12;

/// How patterns are drawn for the cutter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawingOptions {
    /// Name of the job, on every part; default none.
    pub title: String,
    /// Name that each part has in the model, below its own, in the order of the patterns; default none.
    pub sources: Vec<String>,
    /// What else is written on each part, in the order of the patterns; default nothing.
    pub words: Vec<PartWords>,
    /// Unit of coordinates in files and of sizes in words; default mm.
    pub unit: LengthUnit,
    /// Whether a square of known size is drawn beside the parts, by which the shop sees the scale; default no.
    pub test_square: bool,
}

/// What is written on a part besides its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartWords {
    /// Lines below the name.
    pub lines: Vec<String>,
    /// What is written beside bends, and lines of the pattern beside which it may stand, the best first.
    pub bends: Vec<(Vec<[Vec2; 2]>, String)>,
}

/// Draws patterns at their places; patterns without a placement stay where they are, those without an entry in `marked`
/// are good to cut.
///
/// Names stand in the largest free circle, with the job, the side from which the part is seen and its size below them;
/// labels stand behind their marks. All words are upright and keep off cuts, marks and each other. What has no room on a narrow
/// part, its name and the words below it, stands beside it, with a line to it; a label of a mark for which there is no room is
/// left out.
pub fn drawing(patterns: &[Pattern], placements: &[Placement], marked: &[bool], options: &DrawingOptions) -> Drawing {
    let mut d = Drawing { unit: options.unit, ..Drawing::default() };
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    let stay = Placement { angle: 0.0, offset: Vec2::zeros() };
    let drawn: Vec<Drawn> = parallel::map(patterns.iter().enumerate(), |(i, pattern)| {
        let placement = placements.get(i).unwrap_or(&stay);
        piece(pattern, placement, (marked.get(i).copied().unwrap_or(false), i), options)
    });
    let unnamed: Vec<Unnamed> = drawn
        .iter()
        .enumerate()
        .filter(|(_, d)| !d.beside.is_empty())
        .map(|(part, d)| Unnamed { part, lines: d.beside.clone() })
        .collect();
    let (pieces, outlines): (Vec<_>, Vec<_>) = drawn.into_iter().map(|d| (d.piece, d.outlines)).unzip();
    d.pieces = pieces;
    for (u, texts) in unnamed.iter().zip(outside::names(&unnamed, &outlines)) {
        d.pieces[u.part].texts.extend(texts.into_iter().flatten());
    }
    for piece in &d.pieces {
        for c in piece.outer.iter().chain(&piece.inner) {
            extend(c, &mut low, &mut high);
        }
        let lines = piece.rulings.iter().chain(&piece.marks).flatten().copied();
        for p in piece.strokes().flatten().chain(lines) {
            (low, high) = (low.inf(&p), high.sup(&p));
        }
    }
    if low.x <= high.x {
        (d.min, d.max) = (low, high);
        if options.test_square {
            d.test_square = Some(square_below(&mut d, options.unit));
        }
    }
    d
}

/// A square of known size below everything drawn, with its size in words.
fn square_below(d: &mut Drawing, unit: LengthUnit) -> TestSquare {
    let (side, words) = match unit {
        LengthUnit::Millimetre => (100.0, "100 MM"),
        LengthUnit::Inch => (4.0 * unit.mm(), "4 IN"),
    };
    let corner = d.min - Vec2::new(0.0, side + SQUARE_GAP);
    d.min.y = corner.y;
    d.max.x = d.max.x.max(corner.x + side);
    let mut labels = Labels::new(Vec::new());
    let middle = corner + Vec2::repeat(0.5 * side);
    labels.write(words, &TextPlace { middle, along: Vec2::x(), height: SQUARE_WORDS * side });
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner + Vec2::new(x, y) * side);
    TestSquare { corners, texts: labels.texts }
}

/// Extends a box by a contour, arcs included.
fn extend(contour: &Contour, low: &mut Vec2, high: &mut Vec2) {
    for (i, v) in contour.vertices.iter().enumerate() {
        (*low, *high) = (low.inf(&v.point), high.sup(&v.point));
        if v.bulge == 0.0 {
            continue;
        }
        let (a, b) = (v.point, contour.vertices[(i + 1) % contour.vertices.len()].point);
        let chord = b - a;
        let normal = Vec2::new(-chord.y, chord.x);
        let centre = (a + b) * 0.5 + normal * ((1.0 - v.bulge * v.bulge) / (4.0 * v.bulge));
        let radius = (a - centre).norm();
        for q in [Vec2::x(), -Vec2::x(), Vec2::y(), -Vec2::y()].map(|e| centre + e * radius) {
            // An arc that runs counter-clockwise lies wholly to the right of its chord.
            if normal.dot(&(q - a)) * v.bulge < 0.0 {
                (*low, *high) = (low.inf(&q), high.sup(&q));
            }
        }
    }
}

/// One pattern as drawn.
#[derive(Default)]
struct Drawn {
    piece: DrawnPattern,
    /// Its outlines as polygons.
    outlines: Vec<Vec<Vec2>>,
    /// What has no room on it: its name, and the words below it.
    beside: Vec<String>,
}

/// One pattern where it is placed; whether it must not be cut, and its number.
fn piece(pattern: &Pattern, placement: &Placement, (marked, index): (bool, usize), options: &DrawingOptions) -> Drawn {
    let source = options.sources.get(index).cloned().unwrap_or_default();
    let none = PartWords::default();
    let written = options.words.get(index).unwrap_or(&none);
    let contour = |c: &Contour| Contour {
        vertices: c.vertices.iter().map(|v| ContourVertex { point: placement.apply(&v.point), ..*v }).collect(),
    };
    let line = |l: &[Vec2; 2]| l.map(|p| placement.apply(&p));
    let marked_line = |l: &MarkLine| l.moved(|p| placement.apply(p), false);
    let mut contours = pattern.contours.iter().map(contour);
    let mut piece = DrawnPattern {
        name: pattern.name.clone(),
        outer: contours.next(),
        inner: contours.collect(),
        rulings: pattern.rulings.iter().map(line).collect(),
        senses: pattern.bends.iter().map(|b| b.sense).collect(),
        extents: pattern.extents.iter().map(line).collect(),
        formed: pattern.formed.iter().map(contour).collect(),
        sections: pattern.sections.iter().map(marked_line).collect(),
        curves: pattern.curves.iter().map(marked_line).collect(),
        marked,
        ..DrawnPattern::default()
    };
    // Of the length and of the mean width.
    let long = pattern.length.max(pattern.area.sqrt());
    let chord = (ROUGH * long).min(ROUGH_ACROSS * pattern.area / long);
    let place = [(placement.angle, placement.offset)];
    let rough = flat::pieces(std::slice::from_ref(pattern), &place, chord);
    let Some(rough) = rough.into_iter().next() else { return Drawn { piece, ..Drawn::default() } };
    // Where no circle was found, marks are drawn all the same: their number is compared with what was judged.
    let (place, room) = (rough.label, rough.room.max(LABEL_SHARE * pattern.width));
    let height = (LABEL_SHARE * room).clamp(LABEL_HEIGHT.0, LABEL_HEIGHT.1).min(LABEL_MOST * room);
    for mark in &pattern.marks {
        let foot = placement.apply(&mark.point);
        piece.marks.push([foot, foot + placement.turn(&mark.inward) * (TICK * height)]);
    }
    let cuts = rough.outlines.iter().flat_map(|o| (0..o.len()).map(|k| [o[k], o[(k + 1) % o.len()]]));
    let drawn: Vec<Vec<Vec2>> =
        piece.sections.iter().chain(&piece.curves).map(|l| flat::line_points(l, chord)).collect();
    let strokes = drawn.iter().flat_map(|s| s.windows(2).map(|w| [w[0], w[1]]));
    let mut labels = Labels::new(cuts.chain(piece.marks.iter().copied()).chain(strokes).collect());
    let lines = [options.title.clone(), source, seen_from(pattern), sizes(pattern, options.unit)];
    let lines: Vec<&str> = lines.iter().chain(&written.lines).map(String::as_str).filter(|l| !l.is_empty()).collect();
    let mut beside = Vec::new();
    let has_room = rough.room > 0.0 && words(&mut labels, &pattern.name, &lines, (place, room), marked);
    if !has_room && !pattern.name.is_empty() {
        beside.push(titled(&pattern.name, marked));
        beside.extend(lines.iter().map(|l| (*l).to_owned()));
    }
    for (mark, &[foot, tip]) in pattern.marks.iter().zip(&piece.marks) {
        labels.put(&mark.label, places_behind(&mark.label, foot, tip, height));
    }
    // Clear of the lines of bends, too, where there is room.
    let bent = Labels::new(piece.extents.iter().chain(&piece.rulings).copied().collect());
    for (beside, label) in &written.bends {
        let of = |l: &[Vec2; 2]| places_beside(label, &line(l), height, APART).collect::<Vec<_>>();
        let places: Vec<TextPlace> = beside.iter().flat_map(of).collect();
        let clear = places.iter().copied().filter(|p| bent.is_clear(label, p));
        _ = labels.put(label, clear) || labels.put(label, places.iter().copied());
    }
    let named = pattern.sections.iter().chain(&pattern.curves).zip(&drawn);
    for (k, (mark, line)) in named.enumerate().filter(|(_, (mark, _))| !mark.label.is_empty()) {
        let stands = labels.put(&mark.label, places_beside(&mark.label, line, height, BESIDE));
        // What is left of a plane in a corner needs no name.
        if !stands && k >= pattern.sections.len() && is_small(line, &mark.label, height) {
            labels.put(&mark.label, places_around(&mark.label, line, height));
        }
    }
    piece.texts = labels.texts;
    Drawn { piece, outlines: rough.outlines, beside }
}

/// Shares of a line's length at which its label is tried, its middle first.
const ALONG: [f64; 7] = [0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9];
/// Distance of a label's middle from its line, against its height.
const BESIDE: f64 = 0.9;
/// The same where the box about the label is to be clear of the line.
const APART: f64 = 1.05;

/// Where the label of a line may stand: along it, on either side so many heights `away`, smaller.
fn places_beside<'a>(label: &'a str, line: &'a [Vec2], height: f64, away: f64) -> impl Iterator<Item = TextPlace> + 'a {
    let lengths: Vec<f64> = line.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let total: f64 = lengths.iter().sum();
    let at = move |share: f64| {
        let mut rest = share * total;
        let k = lengths.iter().position(|l| {
            let here = rest <= *l;
            rest -= if here { 0.0 } else { *l };
            here
        });
        let (a, b) = k.map_or((line[0], line[line.len() - 1]), |k| (line[k], line[k + 1]));
        let way = (b - a).try_normalize(0.0).unwrap_or_else(Vec2::x);
        (a + way * rest, way)
    };
    let fits = move |h: f64| stroke_font::width(label, h) < total;
    let tried = SMALLER.into_iter().flat_map(|s| ALONG.map(|x| (s, x))).flat_map(|(s, x)| [(s, x, 1.0), (s, x, -1.0)]);
    tried.filter(move |(s, ..)| fits(s * height)).map(move |(s, x, side)| {
        let (p, way) = at(x);
        let along = upright(way);
        let up = Vec2::new(-along.y, along.x);
        TextPlace { middle: p + up * (side * away * s * height), along, height: s * height }
    })
}

/// Extent of a line against the height of its label up to which this may stand around it.
const TINY: f64 = 4.0;
/// Distances of a label from a tiny line, against its height.
const AROUND: [f64; 3] = [0.5, 1.2, 2.5];

/// Whether a line is as small as the cross of a point, or no longer than its label.
fn is_small(line: &[Vec2], label: &str, height: f64) -> bool {
    let (low, high) = bounds(line);
    (high - low).norm() <= stroke_font::width(label, height).max(TINY * height)
}

/// Corners of the box around points.
fn bounds(line: &[Vec2]) -> (Vec2, Vec2) {
    let first = line.first().copied().unwrap_or_else(Vec2::zeros);
    line.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)))
}

/// Where the label of a line that is shorter than it may stand: to the right, to the left, above and below, farther off, smaller.
fn places_around<'a>(label: &'a str, line: &'a [Vec2], height: f64) -> impl Iterator<Item = TextPlace> + 'a {
    let (low, high) = bounds(line);
    let (middle, reach) = ((low + high) * 0.5, 0.5 * (high - low).max());
    let tried = SMALLER.into_iter().flat_map(|share| AROUND.map(|gap| (share, gap)));
    tried.flat_map(move |(share, gap)| {
        let h = share * height;
        let (wide, tall) = (0.5 * stroke_font::width(label, h) + reach + gap * h, 0.5 * h + reach + gap * h);
        let ways = [Vec2::new(wide, 0.0), Vec2::new(-wide, 0.0), Vec2::new(0.0, tall), Vec2::new(0.0, -tall)];
        ways.map(|way| TextPlace { middle: middle + way, along: Vec2::x(), height: h })
    })
}

/// Where the label of a mark may stand: behind its tip, farther in, to either side, smaller.
fn places_behind(label: &str, foot: Vec2, tip: Vec2, height: f64) -> impl Iterator<Item = TextPlace> {
    let inward = (tip - foot).normalize();
    let right = Vec2::new(inward.y, -inward.x);
    let along = upright(right);
    let half = 0.5 * stroke_font::width(label, 1.0);
    SMALLER.into_iter().flat_map(move |share| {
        let h = share * height;
        DEEPER.into_iter().flat_map(move |deep| {
            [0.0, 1.0, -1.0].map(|side| {
                // Beside the mark, or behind it.
                let middle = tip + inward * (deep * h) + right * (side * (half + 0.7) * h);
                TextPlace { middle, along, height: h }
            })
        })
    })
}

/// A line of words: what it says, its height, and how far above the middle of the circle it stands.
type SizedWords<'a> = (&'a str, f64, f64);

/// The words in the free circle of a part: its name, and in smaller lines its name in the model, the job, from where it is seen
/// and how large it is; and across it that it must not be cut. They shrink together until they are clear of cuts and marks;
/// where they never are, each is left out that is not, but for the words that it must not be cut. Whether the name has room: where
/// it has none, the lines are left out too.
fn words(labels: &mut Labels, name: &str, lines: &[&str], (place, room): (Vec2, f64), marked: bool) -> bool {
    let stood = |(text, height, up): SizedWords<'_>, share: f64| {
        let place = TextPlace { middle: place + Vec2::new(0.0, up * share), along: Vec2::x(), height: height * share };
        (text.to_owned(), place)
    };
    let all = stacked(name, lines, room, marked);
    let legible = SHRUNK.into_iter().filter(|share| share * all[0].1 >= LEAST_NAME);
    let sets: Vec<Vec<_>> = legible.clone().map(|share| all.iter().map(|line| stood(*line, share)).collect()).collect();
    let free = |set: &&Vec<(String, TextPlace)>| set.iter().all(|(text, place)| labels.is_clear(text, place));
    if let Some(set) = sets.iter().find(free) {
        set.iter().for_each(|(text, place)| labels.write(text, place));
        return true;
    }
    let named = labels.put(name, legible.map(|share| stood(all[0], share).1));
    for line in &all[1..] {
        let places = SHRUNK.map(|share| stood(*line, share).1);
        let warning = line.0 == NOT_CERTIFIED;
        let stands = (named || warning) && labels.put(line.0, places);
        // That it must not be cut is said at any price.
        if warning && !stands {
            labels.write(line.0, &places[SHRUNK.len() - 1]);
        }
    }
    named
}

/// Words below each other in a circle of radius `room`, the name in its middle.
fn stacked<'a>(name: &'a str, lines: &[&'a str], room: f64, marked: bool) -> Vec<SizedWords<'a>> {
    let width = |text: &str| stroke_font::width(text, 1.0).max(1.0);
    let height = (NAME_SHARE * room).min(NAME_WIDTH * room / width(name)).min(NAME_HEIGHT);
    let mut out = vec![(name, height, 0.0)];
    let widest = lines.iter().map(|l| width(l)).fold(1.0, f64::max);
    // No smaller than can be read, if the name is.
    let small = (SIDE_SHARE * height).min(SIDE_WIDTH * room / widest).max(LEAST_NAME.min(height));
    // Lines below keep off the line under a figure.
    let foot = if name.contains(is_underlined) { (0.5 + UNDERLINE) * height } else { 0.5 * height };
    for (k, line) in lines.iter().enumerate() {
        out.push((*line, small, -foot - (1.5 + LINE * k as f64) * small));
    }
    if marked {
        let words = NAME_WIDTH * room / width(NOT_CERTIFIED);
        let below = foot + (1.0 + LINE * lines.len() as f64) * small;
        for (side, away) in [(1.0, 0.5 * height), (-1.0, below)] {
            // As wide as the circle is there.
            let chord = (room * room - (away + (1.0 + WORDS_GAP) * words).powi(2)).max(0.0).sqrt();
            let words = words.min(2.0 * chord / width(NOT_CERTIFIED)).max(LEAST_WORDS * words);
            out.push((NOT_CERTIFIED, words, side * (away + (0.5 + WORDS_GAP) * words)));
        }
    }
    out
}

/// From where a part is seen: without it parts are bent the wrong way.
fn seen_from(pattern: &Pattern) -> String {
    format!("SEEN FROM {}", pattern.view.name().to_uppercase())
}

/// Length and width of a part in words.
fn sizes(pattern: &Pattern, unit: LengthUnit) -> String {
    let decimals = |mm: f64| match unit {
        LengthUnit::Inch => 3,
        LengthUnit::Millimetre if mm < 100.0 => 1,
        LengthUnit::Millimetre => 0,
    };
    let size = |mm: f64| format!("{:.*}", decimals(mm), unit.of(mm));
    format!("{} X {} {}", size(pattern.length), size(pattern.width), unit.sign().to_uppercase())
}

#[cfg(test)]
mod tests {
    use super::super::labels::letters;
    use super::*;
    use crate::patchwork::pattern::{Mark, MarkPlace};

    #[test]
    fn points_are_named_beside_their_crosses() {
        let at = Vec2::new(70.0, 70.0);
        let cross = |d: Vec2, label: &str| MarkLine::straight(label, &[at - d, at + d]);
        let curves = vec![cross(Vec2::x(), "QC 7"), cross(Vec2::y(), "")];
        let bare = vec![cross(Vec2::x(), ""), cross(Vec2::y(), "")];
        let strokes = |curves: Vec<MarkLine>| {
            let pattern = Pattern { curves, ..square("A") };
            let mut drawn = drawing(&[pattern], &[], &[], &DrawingOptions::default());
            drawn.pieces.remove(0).strokes().collect::<Vec<_>>()
        };
        let (named, bare) = (strokes(curves), strokes(bare));
        let own: Vec<Vec2> = named.iter().filter(|s| !bare.contains(s)).flatten().copied().collect();
        // Beside the cross, not on it, and on the part.
        assert!(!own.is_empty() && own.iter().all(|p| (p - at).amax() > 0.5 && (p - at).norm() < 25.0), "{own:?}");
        assert!(own.iter().all(|p| p.x > 0.0 && p.x < 100.0 && p.y > 0.0 && p.y < 100.0));
    }

    #[test]
    fn labels_of_bends_keep_off_their_lines() {
        let [from, middle, to] = [40.0, 42.0, 44.0].map(|x| [Vec2::new(x, 0.0), Vec2::new(x, 100.0)]);
        let pattern = Pattern { rulings: vec![middle], extents: vec![from, to], ..square("A") };
        let strokes = |bends| {
            let words = vec![PartWords { bends, ..PartWords::default() }];
            let options = DrawingOptions { words, ..DrawingOptions::default() };
            drawing(std::slice::from_ref(&pattern), &[], &[], &options).pieces.remove(0).strokes().collect::<Vec<_>>()
        };
        let bare = strokes(Vec::new());
        let named = strokes(vec![(vec![from, to, middle], "1 UP 90 R3".into())]);
        let own: Vec<Vec2> = named.iter().filter(|s| !bare.contains(s)).flatten().copied().collect();
        // On one side of all of them, and not far off.
        assert!(own.len() > 20 && own.iter().all(|p| p.x > 20.0 && p.x < 64.0), "{own:?}");
        assert!(own.iter().all(|p| p.x < 40.0) || own.iter().all(|p| p.x > 44.0), "{own:?}");
    }

    #[test]
    fn lines_below_a_long_name_can_be_read() {
        let found = stacked("MMP_01.00.00.002 Cover flange", &["SEEN FROM OUTSIDE", "601 X 119 MM"], 45.0, false);
        assert!(found[0].1 < 6.0 && found.iter().all(|l| l.1 >= LEAST_NAME), "{found:?}");
        // Below a name that cannot be read they are as high as that.
        let tiny = stacked("B-12", &["SEEN FROM OUTSIDE"], 1.0, false);
        assert!(tiny[1].1 <= tiny[0].1 && tiny[0].1 < LEAST_NAME, "{tiny:?}");
    }

    fn square(name: &str) -> Pattern {
        let corner = |x, y| ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: true };
        Pattern {
            name: name.into(),
            contours: vec![Contour {
                vertices: vec![corner(0., 0.), corner(100., 0.), corner(100., 100.), corner(0., 100.)],
            }],
            rulings: vec![[Vec2::new(50., 0.), Vec2::new(50., 100.)]],
            marks: vec![Mark {
                point: Vec2::new(0., 30.),
                inward: Vec2::x(),
                label: "S1.2".into(),
                on: MarkPlace::Seam,
                apart: 0.0,
            }],
            area: 1e4,
            length: 100.0,
            ..Pattern::default()
        }
    }

    #[test]
    fn everything_follows_the_placement_and_stays_inside_the_part() {
        let placement = Placement { angle: 0.5 * std::f64::consts::PI, offset: Vec2::new(500.0, 200.0) };
        let d = drawing(&[square("A-01")], &[placement], &[], &DrawingOptions::default());
        assert!((d.min - Vec2::new(400.0, 200.0)).norm() < 1e-9 && (d.max - Vec2::new(500.0, 300.0)).norm() < 1e-9);
        let p = &d.pieces[0];
        let [foot, tip] = p.marks[0];
        assert!((foot - Vec2::new(470.0, 200.0)).norm() < 1e-9);
        assert!((tip - foot).normalize().y > 0.999_999);
        assert!((p.rulings[0][1] - Vec2::new(400.0, 250.0)).norm() < 1e-9);
        assert!(p.strokes().count() > 8);
        for s in p.strokes() {
            assert!(s.len() > 1 && s.windows(2).all(|w| w[0] != w[1]));
        }
    }

    #[test]
    fn words_about_cutting_stand_inside_the_part_on_both_sides_of_its_name() {
        let bare = drawing(&[square("A-01")], &[], &[], &DrawingOptions::default());
        let d = drawing(&[square("A-01"), square("A-02")], &[], &[true, false], &DrawingOptions::default());
        assert!(d.pieces[0].marked && !d.pieces[1].marked);
        let before: Vec<Vec<Vec2>> = bare.pieces[0].strokes().collect();
        let added: Vec<Vec<Vec2>> = d.pieces[0].strokes().filter(|s| !before.contains(s)).collect();
        let letters = 2 * letters(NOT_CERTIFIED, 1.0).len();
        // The label of the mark may have moved out of the way.
        assert!((letters..letters + 12).contains(&added.len()), "{}", added.len());
        let words: Vec<&Vec2> = added.iter().flat_map(|s| s.iter()).filter(|p| p.x > 20.0).collect();
        let (low, high) = words.iter().fold((f64::INFINITY, 0.0f64), |(a, b), p| (a.min(p.y), b.max(p.y)));
        let out = words.iter().map(|p| (*p - Vec2::repeat(50.0)).norm()).fold(0.0, f64::max);
        assert!(out < 50.0, "{out}");
        assert!(low < 40.0 && high > 60.0 && high - low > 30.0, "{low} {high}");
    }

    /// Whether two segments cross.
    fn cross(a: &[Vec2], b: &[Vec2]) -> bool {
        let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp(&(r - p));
        side(a[0], a[1], b[0]) * side(a[0], a[1], b[1]) < 0.0 && side(b[0], b[1], a[0]) * side(b[0], b[1], a[1]) < 0.0
    }

    #[test]
    fn words_never_cross_the_cuts_of_narrow_parts() {
        let options = DrawingOptions { title: "A".into(), sources: vec!["B".into()], ..DrawingOptions::default() };
        for width in [2.0, 10.0, 40.0] {
            for name in ["A", "A-01", "A NAME AS LONG AS A SHIP"] {
                let mut p = square(name);
                for v in &mut p.contours[0].vertices {
                    v.point.y *= 0.01 * width;
                }
                p.marks[0].point.y = 0.3 * width;
                (p.area, p.length, p.width) = (100.0 * width, 100.0, width);
                let d = drawing(&[p], &[], &[true], &options);
                let piece = &d.pieces[0];
                let outline: Vec<Vec2> =
                    piece.outer.iter().flat_map(|c| &c.vertices).map(|v| v.point).cycle().take(5).collect();
                let strokes: Vec<Vec<Vec2>> = piece.strokes().collect();
                let crossed =
                    strokes.iter().flat_map(|s| s.windows(2)).filter(|s| outline.windows(2).any(|o| cross(o, s)));
                assert_eq!(crossed.count(), 0, "{name}, {width} mm wide");
                assert!(strokes.len() > letters(name, 1.0).len() + letters(NOT_CERTIFIED, 1.0).len(), "{name} {width}");
            }
        }
    }

    #[test]
    fn lines_below_a_name_keep_off_the_line_under_its_figures() {
        let options = DrawingOptions { title: "BOAT".into(), ..DrawingOptions::default() };
        let d = drawing(&[square("A-69")], &[], &[], &options);
        let level = |s: &&Vec<Vec2>| s.len() == 2 && (s[0].y - s[1].y).abs() < 1e-9;
        let strokes: Vec<Vec<Vec2>> = d.pieces[0].strokes().collect();
        // The underlines are the lowest level strokes of the name, which is written first.
        let name = letters("A-69", 1.0).len();
        let low = |strokes: &[Vec<Vec2>]| strokes.iter().flatten().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let under = low(&strokes[..name]);
        assert_eq!(strokes[..name].iter().filter(level).filter(|s| s[0].y - under < 1e-9).count(), 2);
        let mark = strokes.len() - letters("S1.2", 1.0).len();
        assert!(strokes[name..mark].iter().flatten().all(|p| p.y < under - 0.1));
    }

    #[test]
    fn sizes_in_inches_have_three_decimals() {
        let p = Pattern { length: 80.0, width: 70.0, ..Pattern::default() };
        assert_eq!(sizes(&p, LengthUnit::Inch), "3.150 X 2.756 IN");
        assert_eq!(sizes(&p, LengthUnit::Millimetre), "80.0 X 70.0 MM");
        assert_eq!(sizes(&Pattern { length: 480.25, ..p }, LengthUnit::Millimetre), "480 X 70.0 MM");
    }

    #[test]
    fn parts_say_what_they_are_called_in_the_model() {
        let named = DrawingOptions { sources: vec![String::new(), "BAUTEIL".into()], ..DrawingOptions::default() };
        let strokes = |options: &DrawingOptions| {
            let d = drawing(&[square("A-01"), square("B-01")], &[], &[], options);
            d.pieces.iter().map(|p| p.strokes().count()).collect::<Vec<_>>()
        };
        let bare = strokes(&DrawingOptions::default());
        let added = letters("BAUTEIL", 1.0).len();
        assert_eq!(strokes(&named)[0], bare[0]);
        assert!(strokes(&named)[1] >= bare[1] + added);
    }

    #[test]
    fn the_extent_includes_arcs() {
        let mut p = square("A");
        p.contours[0].vertices[1].bulge = 1.0; // half circle beyond x = 100
        p.contours[0].vertices[3].bulge = -0.2; // towards the inside
        let d = drawing(&[p], &[], &[], &DrawingOptions::default());
        assert!(d.min.norm() < 1e-9 && (d.max - Vec2::new(150.0, 100.0)).norm() < 1e-9);
    }

    #[test]
    fn patterns_without_placement_stay_and_nothing_gives_an_empty_drawing() {
        let d = drawing(&[square("B")], &[], &[false], &DrawingOptions::default());
        assert!((d.max - Vec2::new(100.0, 100.0)).norm() < 1e-9);
        assert_eq!(drawing(&[], &[], &[], &DrawingOptions::default()), Drawing::default());
        let empty = Pattern { name: "empty".into(), ..Pattern::default() };
        assert!(drawing(&[empty], &[], &[true], &DrawingOptions::default()).pieces[0].outer.is_none());
    }

    #[test]
    fn the_test_square_is_as_large_as_it_says_and_beside_the_parts() {
        for (unit, side) in [(LengthUnit::Millimetre, 100.0), (LengthUnit::Inch, 101.6)] {
            let options = DrawingOptions { unit, test_square: true, ..DrawingOptions::default() };
            let d = drawing(&[square("A")], &[], &[], &options);
            let c = d.test_square.as_ref().expect("a square").corners;
            assert!(((c[1] - c[0]).norm() - side).abs() < 1e-12 && ((c[2] - c[1]).norm() - side).abs() < 1e-12);
            assert!(c.iter().all(|p| p.y < 0.0) && d.min.y <= c[0].y);
        }
    }

    #[test]
    fn every_part_says_what_it_is_and_labels_keep_off_its_words() {
        let options = DrawingOptions { title: "BOAT".into(), ..DrawingOptions::default() };
        let bare = drawing(&[square("A-01")], &[], &[], &DrawingOptions::default());
        let titled = drawing(&[square("A-01")], &[], &[], &options);
        assert!(titled.pieces[0].strokes().count() > bare.pieces[0].strokes().count() + 3);
        // Marks all around and too near each other: no two labels on one place, none across the outline.
        let mut p = square("A-02");
        p.marks = (1..40)
            .map(|k| Mark {
                point: Vec2::new(2.5 * f64::from(k), 0.0),
                inward: Vec2::y(),
                label: format!("S1.{k}"),
                on: MarkPlace::Seam,
                apart: 0.0,
            })
            .collect();
        let d = drawing(&[p], &[], &[], &options);
        assert!(d.pieces[0].strokes().flatten().all(|p| p.x > 0.0 && p.x < 100.0 && p.y > 0.0 && p.y < 100.0));
        assert_eq!(d.pieces[0].marks.len(), 39);
    }
}
