//! The cutter's drawing: patterns placed side by side, every letter a stroke, sorted by what the machine does with
//! it. Curves of outlines stay lines and arcs. Lengths in mm, y upwards.

use super::scene::NOT_CERTIFIED;
use super::{flat, stroke_font};
use crate::geom::Vec2;
use crate::patchwork::pattern::{BendSense, Contour, ContourVertex, Mark, Pattern, Placement};

/// All patterns of a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// One entry per pattern.
    pub pieces: Vec<Piece>,
    /// Smallest x and y of anything drawn.
    pub min: Vec2,
    /// Largest x and y of anything drawn.
    pub max: Vec2,
}

/// One pattern as drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
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
    /// Matching marks: short lines from the outline inwards.
    pub marks: Vec<[Vec2; 2]>,
    /// Strokes of the panel's name and of the marks' labels.
    pub text: Vec<Vec<Vec2>>,
    /// Whether the part must not be cut: it is not certified.
    pub marked: bool,
}

impl Piece {
    /// The rulings about which the sheet bends in a sense.
    pub fn bent(&self, sense: BendSense) -> impl Iterator<Item = &[Vec2; 2]> {
        let of = move |k: usize| self.senses.get(k).copied().unwrap_or_default();
        self.rulings.iter().enumerate().filter(move |(k, _)| of(*k) == sense).map(|(_, r)| r)
    }
}

/// Chord error (share of the pattern's length) of the outlines on which the place of the name is sought.
const ROUGH: f64 = 1e-3;
/// Largest height of capitals of a name, mm.
const NAME_HEIGHT: f64 = 40.0;
/// Height of a name against the radius of the free circle in which it stands.
const NAME_SHARE: f64 = 0.5;
/// Width of a name against that radius.
const NAME_WIDTH: f64 = 1.6;
/// Height of the words that say from where the part is seen against that of its name.
const SIDE_SHARE: f64 = 0.35;
/// Width of these words against the radius of the circle.
const SIDE_WIDTH: f64 = 1.3;
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
/// Length of a full stop against the height of the letters: a machine skips strokes of no length.
const DOT: f64 = 0.12;

/// Draws patterns at their places; patterns without a placement stay where they are, those without an entry in `marked`
/// are good to cut.
///
/// Names stand in the largest free circle, labels behind their marks, upright towards the inside of the panel.
pub fn drawing(patterns: &[Pattern], placements: &[Placement], marked: &[bool]) -> Drawing {
    let mut d = Drawing::default();
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    for (i, pattern) in patterns.iter().enumerate() {
        let stay = Placement { angle: 0.0, offset: Vec2::zeros() };
        let placement = placements.get(i).unwrap_or(&stay);
        let rough = flat::pieces(
            std::slice::from_ref(pattern),
            &[(placement.angle, placement.offset)],
            ROUGH * pattern.length.max(pattern.area.sqrt()),
        );
        let (place, room) = rough.first().map_or((Vec2::zeros(), 0.0), |p| (p.label, p.room));
        let mut piece = piece(pattern, placement, place, room);
        if marked.get(i).copied().unwrap_or(false) {
            mark(&mut piece, place, room);
        }
        for c in piece.outer.iter().chain(&piece.inner) {
            extend(c, &mut low, &mut high);
        }
        for p in piece.text.iter().flatten().chain(piece.rulings.iter().chain(&piece.marks).flatten()) {
            (low, high) = (low.inf(p), high.sup(p));
        }
        d.pieces.push(piece);
    }
    if low.x <= high.x {
        (d.min, d.max) = (low, high);
    }
    d
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

/// One pattern; its name goes into the circle about `place` with the radius `room`.
fn piece(pattern: &Pattern, placement: &Placement, place: Vec2, room: f64) -> Piece {
    let mut contours = pattern.contours.iter().map(|c| Contour {
        vertices: c.vertices.iter().map(|v| ContourVertex { point: placement.apply(&v.point), ..*v }).collect(),
    });
    let label_height = (LABEL_SHARE * room).clamp(LABEL_HEIGHT.0, LABEL_HEIGHT.1).min(LABEL_MOST * room);
    let mut piece = Piece {
        name: pattern.name.clone(),
        outer: contours.next(),
        inner: contours.collect(),
        rulings: pattern.rulings.iter().map(|r| r.map(|p| placement.apply(&p))).collect(),
        senses: pattern.bends.iter().map(|b| b.sense).collect(),
        ..Piece::default()
    };
    if room <= 0.0 {
        return piece;
    }
    for mark in &pattern.marks {
        let (foot, inward) = (placement.apply(&mark.point), placement.turn(&mark.inward));
        let tip = foot + inward * (TICK * label_height);
        piece.marks.push([foot, tip]);
        piece.text.extend(label(mark, tip + inward * (0.5 * label_height), inward, label_height));
    }
    let height = name_height(&pattern.name, room);
    let unit_width = stroke_font::width(&pattern.name, 1.0).max(1.0);
    let corner = place - Vec2::new(0.5 * unit_width * height, 0.5 * height);
    let mut put = |text: &str, height: f64, corner: Vec2| {
        piece.text.extend(strokes(text, height).into_iter().map(|s| s.iter().map(|p| corner + p).collect()));
    };
    put(&pattern.name, height, corner);
    // Below it the side of the model from which the part is seen: without it parts are bent the wrong way.
    let words = format!("SEEN FROM {}", pattern.view.name().to_uppercase());
    let unit_width = stroke_font::width(&words, 1.0).max(1.0);
    let small = (SIDE_SHARE * height).min(SIDE_WIDTH * room / unit_width);
    put(&words, small, place - Vec2::new(0.5 * unit_width * small, 0.5 * height + 2.0 * small));
    piece
}

/// Height of the name of a part with a free circle of this radius.
fn name_height(name: &str, room: f64) -> f64 {
    let unit_width = stroke_font::width(name, 1.0).max(1.0);
    (NAME_SHARE * room).min(NAME_WIDTH * room / unit_width).min(NAME_HEIGHT)
}

/// Says across a part that it must not be cut: above and below its name, as large as the free circle allows.
fn mark(piece: &mut Piece, place: Vec2, room: f64) {
    piece.marked = true;
    if room <= 0.0 {
        return;
    }
    let unit_width = stroke_font::width(NOT_CERTIFIED, 1.0);
    let height = NAME_WIDTH * room / unit_width;
    let away = 0.5 * name_height(&piece.name, room) + WORDS_GAP * height;
    for bottom in [away, -away - height] {
        let corner = place + Vec2::new(-0.5 * unit_width * height, bottom);
        piece.text.extend(strokes(NOT_CERTIFIED, height).iter().map(|s| s.iter().map(|p| corner + p).collect()));
    }
}

/// The strokes of a mark's label, centred on the line of the mark, `inward` being up.
fn label(mark: &Mark, bottom: Vec2, inward: Vec2, height: f64) -> Vec<Vec<Vec2>> {
    let right = Vec2::new(inward.y, -inward.x);
    let half = 0.5 * stroke_font::width(&mark.label, height);
    let put = |p: &Vec2| bottom + right * (p.x - half) + inward * p.y;
    strokes(&mark.label, height).iter().map(|s| s.iter().map(put).collect()).collect()
}

/// Strokes of a text, without repeated points and without strokes of no length.
fn strokes(text: &str, height: f64) -> Vec<Vec<Vec2>> {
    let mut all = stroke_font::strokes(text, height);
    for stroke in &mut all {
        stroke.dedup();
        if let [p] = stroke[..] {
            let half = Vec2::new(0.5 * DOT * height, 0.0);
            *stroke = vec![p - half, p + half];
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(name: &str) -> Pattern {
        let corner = |x, y| ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: true };
        Pattern {
            name: name.into(),
            contours: vec![Contour {
                vertices: vec![corner(0., 0.), corner(100., 0.), corner(100., 100.), corner(0., 100.)],
            }],
            rulings: vec![[Vec2::new(50., 0.), Vec2::new(50., 100.)]],
            marks: vec![Mark { point: Vec2::new(0., 30.), inward: Vec2::x(), label: "S1.2".into() }],
            area: 1e4,
            length: 100.0,
            ..Pattern::default()
        }
    }

    #[test]
    fn everything_follows_the_placement_and_stays_inside_the_part() {
        let placement = Placement { angle: 0.5 * std::f64::consts::PI, offset: Vec2::new(500.0, 200.0) };
        let d = drawing(&[square("A-01")], &[placement], &[]);
        assert!((d.min - Vec2::new(400.0, 200.0)).norm() < 1e-9 && (d.max - Vec2::new(500.0, 300.0)).norm() < 1e-9);
        let p = &d.pieces[0];
        let [foot, tip] = p.marks[0];
        assert!((foot - Vec2::new(470.0, 200.0)).norm() < 1e-9);
        assert!((tip - foot).normalize().y > 0.999_999);
        assert!((p.rulings[0][1] - Vec2::new(400.0, 250.0)).norm() < 1e-9);
        assert!(p.text.len() > 8);
        for s in &p.text {
            assert!(s.len() > 1 && s.windows(2).all(|w| w[0] != w[1]));
        }
    }

    #[test]
    fn words_about_cutting_stand_inside_the_part_on_both_sides_of_its_name() {
        let bare = drawing(&[square("A-01")], &[], &[]);
        let d = drawing(&[square("A-01"), square("A-02")], &[], &[true, false]);
        assert!(d.pieces[0].marked && !d.pieces[1].marked);
        let added = &d.pieces[0].text[bare.pieces[0].text.len()..];
        assert_eq!(added.len(), 2 * strokes(NOT_CERTIFIED, 1.0).len());
        let (low, high) = added.iter().flatten().fold((f64::INFINITY, 0.0f64), |(a, b), p| (a.min(p.y), b.max(p.y)));
        assert!(added.iter().flatten().all(|p| (p - Vec2::repeat(50.0)).norm() < 50.0));
        assert!(low < 40.0 && high > 60.0 && high - low > 30.0, "{low} {high}");
    }

    #[test]
    fn the_extent_includes_arcs() {
        let mut p = square("A");
        p.contours[0].vertices[1].bulge = 1.0; // half circle beyond x = 100
        p.contours[0].vertices[3].bulge = -0.2; // towards the inside
        let d = drawing(&[p], &[], &[]);
        assert!(d.min.norm() < 1e-9 && (d.max - Vec2::new(150.0, 100.0)).norm() < 1e-9);
    }

    #[test]
    fn patterns_without_placement_stay_and_nothing_gives_an_empty_drawing() {
        let d = drawing(&[square("B")], &[], &[false]);
        assert!((d.max - Vec2::new(100.0, 100.0)).norm() < 1e-9);
        assert_eq!(drawing(&[], &[], &[]), Drawing::default());
        let empty = Pattern { name: "empty".into(), ..Pattern::default() };
        assert!(drawing(&[empty], &[], &[true]).pieces[0].outer.is_none());
    }
}
