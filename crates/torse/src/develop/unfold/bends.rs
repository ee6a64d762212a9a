//! Where a piece is bent: centre lines and extents, angles, radii, allowances, and an order to bend in.

use super::chart::{FlatRuling, Stretch};
use super::region::{FlatRegion, POINT};
use super::tree::{Placed, UnfoldedPiece};
use crate::brep::body::Body;
use crate::brep::recognised_surface::RecognisedSurface;
use crate::develop::bends::{dense_cells, kept_low, BendSpacing, Cell, Facets, Lines};
use crate::geom::segment::same_segment;
use crate::geom::Vec2;
use crate::patchwork::pattern::{Bend, BendSense};

/// How the sheet is bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BendKind {
    /// About one line, with a radius.
    Bend,
    /// About a sharp edge.
    Fold,
    /// Back onto itself, nearly or wholly.
    Hem,
    /// Over many lines: large radii, cones and other curved faces.
    Rolled,
}

impl BendKind {
    /// The kind with a [`BendKind::name`].
    pub(crate) fn named(name: &str) -> Option<Self> {
        [Self::Bend, Self::Fold, Self::Hem, Self::Rolled].into_iter().find(|kind| kind.name() == name)
    }

    /// Lower-case name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bend => "bend",
            Self::Fold => "fold",
            Self::Hem => "hem",
            Self::Rolled => "rolled",
        }
    }
}

/// One bend of a piece.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetBend {
    /// How.
    pub kind: BendKind,
    /// Centre lines, in parts where holes lie between: one line of a bend, several of a rolled face.
    pub lines: Vec<[Vec2; 2]>,
    /// How the sheet bends about each of the lines.
    pub bends: Vec<Bend>,
    /// Rulings that the lines stand for, holes or not, which share the turn of a rolled face.
    pub rulings: usize,
    /// Lines where the bent zone begins and ends; none for folds.
    pub extents: Vec<[Vec2; 2]>,
    /// Which way, as the piece lies before the eye.
    pub sense: BendSense,
    /// Whole turn, rad.
    pub angle: f64,
    /// Inside radius, mm; infinite where it is not one number.
    pub inside_radius: f64,
    /// Least inside radius (mm) by the lines, where it is not one number; 0 where they run to a tip.
    pub least_inside_radius: f64,
    /// K used: depth of the neutral fibre as a share of the thickness.
    pub k: f64,
    /// Breadth of the bent zone in the flat (mm): length of the neutral fibre. Not a number where it varies.
    pub allowance: f64,
    /// Length along the centre line, all its parts and the holes between them, mm.
    pub length: f64,
    /// Place in a sequence that begins with the outermost bends, counted from 1.
    pub order: usize,
    /// Entity numbers of the edges that a fold is about, as far as the file has them.
    pub edges: Vec<u64>,
    /// Of a rolled face its number within the part.
    pub face: Option<usize>,
    /// Steps of the outer face from the root.
    steps: usize,
}

/// Bends turn back onto the sheet from here on, rad.
const HEM: f64 = 170.0 * std::f64::consts::PI / 180.0;
/// Inside radii of hems, in thicknesses, at most: wider ones are curls.
const CURL: f64 = 3.0;
/// Inside radii above so many thicknesses are rolled or pressed in many steps: no common tool of a press brake is so wide.
const ROLLED: f64 = 12.0;
/// Whole numbers of lines may be exceeded by this share of one before another is drawn.
const HAIR: f64 = 0.01;
/// Lines of a rolled face at most.
const MOST_LINES: usize = 400;
/// Lines that are apart by less than this share of the body are one.
const ONE_LINE: f64 = 1e-5;
/// Bends about one line are one if their angles differ by less (rad): what the table prints.
const ONE_ANGLE: f64 = 1e-4 * std::f64::consts::PI / 180.0;
/// And their radii and allowances by less (mm).
const ONE_LENGTH: f64 = 1e-4;

/// The bends of a piece, in the order of its faces.
///
/// Rolled faces are kinked as `spacing` says, or have a line at every step of turn, and more where the part could not be bent back
/// from these. Folds along curves are drawn as chords within a share of the `tolerance` (mm).
pub(crate) fn bends(
    body: &Body,
    piece: &UnfoldedPiece,
    thickness: f64,
    spacing: &BendSpacing,
    tolerance: f64,
) -> Vec<SheetBend> {
    let mut out: Vec<SheetBend> = Vec::new();
    let spacing = shared(piece, spacing);
    let near = (CHORD * tolerance).max(CURVED * ONE_LINE * body.size);
    for placed in &piece.faces {
        if matches!(body.recognised[placed.face], RecognisedSurface::Plane(_)) {
            continue;
        }
        for bend in of_face(body, piece, placed, (thickness, &spacing), near) {
            match out.iter_mut().find(|b| one_line(b, &bend, ONE_LINE * body.size)) {
                Some(b) => {
                    b.lines.extend(bend.lines);
                    b.bends.extend(bend.bends);
                    between_others(&mut b.extents, bend.extents, ONE_LINE * body.size);
                    b.steps = b.steps.min(bend.steps);
                }
                None => out.push(bend),
            }
        }
    }
    for fold in &piece.folds {
        let (h, twin) = (fold.half, body.halves[fold.half].twin.unwrap_or(fold.half));
        let lines = chords(&|s| (piece.place(body, h, s) + piece.place(body, twin, 1.0 - s)) * 0.5, near);
        let steps = [h, twin].iter().filter_map(|h| piece.placed(body.halves[*h].face)).map(|p| p.steps).max();
        let sense = if fold.meeting.convex { BendSense::Down } else { BendSense::Up };
        let bend = SheetBend {
            kind: BendKind::Fold,
            bends: vec![Bend::of(sense, fold.meeting.angle, [0.0; 2]); lines.len()],
            rulings: lines.len(),
            lines,
            extents: Vec::new(),
            sense,
            angle: fold.meeting.angle,
            inside_radius: 0.0,
            least_inside_radius: 0.0,
            k: fold.k,
            allowance: fold.allowance,
            length: 0.0,
            order: 0,
            edges: vec![body.halves[h].stretch.entity].into_iter().filter(|e| *e > 0).collect(),
            face: None,
            steps: steps.unwrap_or(0),
        };
        match out.iter_mut().find(|b| one_line(b, &bend, ONE_LINE * body.size)) {
            Some(b) => {
                b.lines.extend(bend.lines);
                b.bends.extend(bend.bends);
                b.edges.extend(bend.edges);
            }
            None => out.push(bend),
        }
    }
    for b in out.iter_mut().filter(|b| b.kind != BendKind::Rolled) {
        b.length = reach(&b.lines);
    }
    let mut sequence: Vec<usize> = (0..out.len()).collect();
    sequence.sort_by(|a, b| (out[*b].steps.cmp(&out[*a].steps)).then(out[*a].length.total_cmp(&out[*b].length)));
    for (k, b) in sequence.into_iter().enumerate() {
        out[b].order = k + 1;
    }
    out
}

/// The spacing for each of the faces that are bent without closed form, which share what the part may be off.
fn shared(piece: &UnfoldedPiece, spacing: &BendSpacing) -> BendSpacing {
    let count = piece.faces.iter().filter(|p| p.chart.closed().is_none()).count();
    BendSpacing { within: spacing.within / count.max(1) as f64, ..*spacing }
}

/// Share of the tolerance within which chords keep to a curved fold.
const CHORD: f64 = 0.25;
/// Times that a fold must be off a straight line by as much as lines of one bend may be apart to be curved.
const CURVED: f64 = 2.0;
/// Chords of a curved fold at most.
const MOST_CHORDS: usize = 256;

/// Chords of a curve over [0, 1], as many as keep within `near` (mm) of its places half way between: one of a straight line.
fn chords(place: &dyn Fn(f64) -> Vec2, near: f64) -> Vec<[Vec2; 2]> {
    let mut count = 1;
    loop {
        let at = |k: usize| place(0.5 * k as f64 / count as f64);
        let points: Vec<Vec2> = (0..=2 * count).map(at).collect();
        let off = points.windows(3).step_by(2).map(|w| {
            let way = (w[2] - w[0]).try_normalize(0.0).unwrap_or_else(Vec2::x);
            way.perp(&(w[1] - w[0])).abs()
        });
        if count == MOST_CHORDS || off.fold(0.0, f64::max) <= near {
            return points.iter().step_by(2).copied().collect::<Vec<_>>().windows(2).map(|w| [w[0], w[1]]).collect();
        }
        count *= 2;
    }
}

/// Distance between the farthest ends of collinear segments; of chords of a curve their length.
fn reach(lines: &[[Vec2; 2]]) -> f64 {
    let follow = lines.len() > 1 && lines.windows(2).all(|w| w[0][1] == w[1][0]);
    if follow {
        return lines.iter().map(|l| (l[1] - l[0]).norm()).sum();
    }
    let Some(way) = lines.first().and_then(|l| (l[1] - l[0]).try_normalize(0.0)) else { return 0.0 };
    let along = |f: fn(f64, f64) -> f64, start: f64| lines.iter().flatten().map(|p| p.dot(&way)).fold(start, f);
    along(f64::max, f64::NEG_INFINITY) - along(f64::min, f64::INFINITY)
}

/// Adds lines where a part of a bend begins and ends to those of the others: what lies between both parts is none.
fn between_others(all: &mut Vec<[Vec2; 2]>, own: Vec<[Vec2; 2]>, near: f64) {
    for l in own {
        let same = |k: &[Vec2; 2]| same_segment(k, &l, near).is_some();
        match all.iter().position(same) {
            Some(k) => drop(all.swap_remove(k)),
            None => all.push(l),
        }
    }
}

/// Whether two bends are parts of one: equal turns about one line.
fn one_line(a: &SheetBend, b: &SheetBend, tolerance: f64) -> bool {
    let near = |p: f64, q: f64| (p - q).abs() <= ONE_LENGTH;
    let alike = a.kind == b.kind
        && a.sense == b.sense
        && (a.angle - b.angle).abs() <= ONE_ANGLE
        && near(a.inside_radius, b.inside_radius)
        && near(a.allowance, b.allowance);
    let (Some(l), Some(m)) = (a.lines.first(), b.lines.first()) else { return false };
    let Some(way) = (l[1] - l[0]).try_normalize(0.0) else { return false };
    alike && a.kind != BendKind::Rolled && m.iter().all(|p| way.perp(&(p - l[0])).abs() <= tolerance)
}

/// The bends that a face is: one, or one for every stretch that is bent one way; `near` as of [`chords`].
fn of_face(
    body: &Body,
    piece: &UnfoldedPiece,
    placed: &Placed,
    (thickness, spacing): (f64, &BendSpacing),
    near: f64,
) -> Vec<SheetBend> {
    let turn = placed.chart.turn();
    let cylinder = matches!(body.recognised[placed.face], RecognisedSurface::Cylinder { .. });
    let between = body.of_face(placed.face).filter(|h| piece.inner.contains(h) && is_plane(body, *h)).count();
    let narrow = if thickness > 0.0 { placed.inside_radius <= ROLLED * thickness } else { between > 1 };
    let kind = match cylinder && narrow && between > 0 {
        true if turn >= HEM && placed.inside_radius <= CURL * thickness => BendKind::Hem,
        true => BendKind::Bend,
        false => BendKind::Rolled,
    };
    let region = FlatRegion::of(body, placed.face, &placed.chart);
    // Ends of faces in a point are no lines.
    let is_line = |h: &usize| piece.inner.contains(h) && body.halves[*h].length > POINT * body.size;
    let extents = body.of_face(placed.face).filter(is_line);
    let mut extents: Vec<[Vec2; 2]> = extents.flat_map(|h| chords(&|s| piece.place(body, h, s), near)).collect();
    let allowance = if cylinder { turn * placed.chart.neutral_radius() } else { f64::NAN };
    let length = if cylinder { region.max.y - region.min.y } else { f64::NAN };
    // Within faces that go on into others it is told where the bend changes its direction.
    let inflection = |stretch: &Stretch| -> Vec<[Vec2; 2]> {
        let at = placed.chart.rulings_between([stretch.turn[0]; 2], 1);
        let lines = at.iter().flat_map(|r| region.line(&r.at, &r.way));
        lines.map(|l| l.map(|p| placed.motion.apply(&p))).collect()
    };
    let goes_on = !extents.is_empty();
    let mut before = 0.0;
    let stretches = placed.chart.stretches();
    let number = piece.faces.iter().position(|p| p.face == placed.face);
    let cells =
        if kind == BendKind::Rolled { cells(piece, placed, &region, (&stretches, spacing)) } else { Vec::new() };
    let one = |stretch: Stretch| {
        if goes_on && stretch.turn[0] > 0.0 {
            extents.extend(inflection(&stretch));
        }
        let within = |c: &&Cell| (stretch.turn[0]..stretch.turn[1]).contains(&c.middle());
        let own: Vec<Cell> = cells.iter().filter(within).copied().collect();
        let drawn = Drawn::of(placed, &region, (&stretch, kind, before), (cylinder, spacing, &own));
        let angle = turn * (stretch.turn[1] - stretch.turn[0]);
        before += if stretch.hollow { angle } else { -angle };
        SheetBend {
            kind,
            lines: drawn.lines,
            bends: drawn.bends,
            rulings: drawn.rulings,
            extents: std::mem::take(&mut extents),
            sense: sense(stretch.hollow),
            angle,
            inside_radius: if cylinder { placed.inside_radius } else { f64::INFINITY },
            least_inside_radius: drawn.least_inside_radius,
            k: drawn.k,
            allowance,
            length,
            order: 0,
            edges: Vec::new(),
            face: number.filter(|_| kind == BendKind::Rolled),
            steps: placed.steps,
        }
    };
    stretches.into_iter().map(one).collect()
}

/// What the lines of a rolled face stand for, stretch by stretch: equal parts of its turn, halved where the part could not be bent
/// back from them; none where it is kinked.
fn cells(
    piece: &UnfoldedPiece,
    placed: &Placed,
    region: &FlatRegion,
    (stretches, spacing): (&[Stretch], &BendSpacing),
) -> Vec<Cell> {
    if spacing.facets.is_some() || !spacing.within.is_finite() {
        return Vec::new();
    }
    let mut all = Vec::new();
    for s in stretches {
        let count = rolled_lines(placed, region, s, spacing);
        let share = (s.turn[1] - s.turn[0]) / count as f64;
        let angle = placed.chart.turn() * share * if s.hollow { 1.0 } else { -1.0 };
        let at = |k: usize| s.turn[0] + share * k as f64;
        all.extend((0..count).map(|k| Cell { turn: [at(k), at(k + 1)], angle }));
    }
    let boxes = piece.faces.iter().map(|p| (p.region.min, p.region.max));
    let whole = boxes.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
    let size = whole.map_or(0.0, |(lo, hi)| (hi - lo).norm());
    let exact = |share: f64| placed.chart.exact(share, |r, ends| radii_at(placed, r, ends));
    dense_cells(all, (spacing.within, size), &exact)
}

/// The lines of a stretch of a face, and what they tell of its bend.
struct Drawn {
    lines: Vec<[Vec2; 2]>,
    bends: Vec<Bend>,
    rulings: usize,
    least_inside_radius: f64,
    k: f64,
}

impl Drawn {
    fn of(
        placed: &Placed,
        region: &FlatRegion,
        (stretch, kind, before): (&Stretch, BendKind, f64),
        (cylinder, spacing, cells): (bool, &BendSpacing, &[Cell]),
    ) -> Self {
        let count = |asked: &BendSpacing| match kind {
            BendKind::Rolled => rolled_lines(placed, region, stretch, asked),
            _ => 1,
        };
        let even = |count| placed.chart.rulings_between(stretch.turn, count);
        let of_cells = || cells.iter().flat_map(|c| placed.chart.rulings_between(c.turn, 1)).collect::<Vec<_>>();
        let radius = cylinder.then_some(placed.radius);
        let draw = |asked: &BendSpacing| {
            let rulings = if cells.is_empty() { even(count(asked)) } else { of_cells() };
            lines_of(placed, region, (rulings, before), radius)
        };
        let (lines, bends) = kept_low(spacing, draw);
        // Kinks stand for equal parts of the turn.
        let turn = placed.chart.turn() * (stretch.turn[1] - stretch.turn[0]);
        let number = bends.first().map_or(count(spacing), |b| (turn / b.angle).round() as usize);
        let all = if cells.is_empty() { even(number) } else { of_cells() };
        let inside = |(r, l): (&FlatRuling, [Vec2; 2])| {
            l.map(|p| placed.fibre.inside(surface_radius(r, &p), r.hollow).max(0.0))
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        };
        let stretches = all.iter().flat_map(|r| region.own_lines(r).into_iter().map(move |l| (r, l)));
        let least = stretches.map(inside).fold(f64::INFINITY, f64::min);
        // Of a face bent about one axis there is one K; else the mean of all lines by their turns stands for it.
        let turns: f64 = all.iter().map(|r| r.angle).sum();
        let mean = all.iter().map(|r| r.angle * placed.fibre.share_at(r.depth, r.hollow)).sum::<f64>() / turns;
        let k = if radius.is_some() || mean.is_nan() { placed.k } else { mean };
        let least_inside_radius = if cylinder { placed.inside_radius } else { least };
        Self { lines, bends, rulings: all.len(), least_inside_radius, k }
    }
}

/// Radius (mm) of the face itself at a point of a ruling of its neutral surface.
fn surface_radius(ruling: &FlatRuling, p: &Vec2) -> f64 {
    let below = if ruling.hollow { -ruling.depth } else { ruling.depth };
    (ruling.radius_at(p) + below).max(0.0)
}

/// Number of lines of a stretch of a rolled face, by its middle ruling.
fn rolled_lines(placed: &Placed, region: &FlatRegion, stretch: &Stretch, spacing: &BendSpacing) -> usize {
    let whole = placed.chart.turn();
    let turn = whole * (stretch.turn[1] - stretch.turn[0]);
    // Breadth across the rulings: area over the length of the middle ruling.
    let middle = placed.chart.rulings(1);
    let middle = middle.iter().flat_map(|r| region.own_lines(r));
    let breadth = stretch.way * region.area().abs() / middle.map(|[a, b]| (b - a).norm()).sum::<f64>();
    let asked = spacing.facets.map_or(turn / spacing.step, |f: Facets| f.needed(turn, breadth, whole));
    ((asked - HAIR).ceil() as usize).clamp(1, MOST_LINES)
}

/// Radii (mm) of a face without closed form at both ends of a line, as its bend lines tell them.
fn radii_at(placed: &Placed, ruling: &FlatRuling, ends: [Vec2; 2]) -> [f64; 2] {
    match placed.is_given {
        true => ends.map(|p| surface_radius(ruling, &p)),
        false => ends.map(|p| ruling.radius_at(&p)),
    }
}

/// The stretches of rulings inside a region, with their bends, after a turn (rad); of cylinders the radius (mm) is known.
fn lines_of(
    placed: &Placed,
    region: &FlatRegion,
    (rulings, before): (Vec<FlatRuling>, f64),
    radius: Option<f64>,
) -> Lines {
    let (mut lines, mut bends, mut turned) = (Vec::new(), Vec::new(), before);
    // What the radii are of: the inside of a body's cylinder, its neutral fibre elsewhere, and surfaces that were given a thickness
    // themselves.
    for r in &rulings {
        let half = if r.hollow { 0.5 * r.angle } else { -0.5 * r.angle };
        turned += half;
        for l in region.own_lines(r) {
            let radii = match radius {
                Some(_) if !placed.is_given => [placed.inside_radius; 2],
                Some(radius) => [radius; 2],
                None => radii_at(placed, r, l),
            };
            bends.push(Bend { turned, ..Bend::of(sense(r.hollow), r.angle, radii) });
            lines.push(l.map(|p| placed.motion.apply(&p)));
        }
        turned += half;
    }
    (lines, bends)
}

/// Hollow faces come up towards the eye.
fn sense(hollow: bool) -> BendSense {
    if hollow {
        BendSense::Up
    } else {
        BendSense::Down
    }
}

/// Whether the face beyond a run is plane.
fn is_plane(body: &Body, half: usize) -> bool {
    body.beyond(half).is_some_and(|g| matches!(body.recognised[g], RecognisedSurface::Plane(_)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_between_parts_of_a_bend_are_none() {
        let line = |x: f64, y: f64| [Vec2::new(x, y), Vec2::new(x + 10.0, y)];
        let turned = |[a, b]: [Vec2; 2]| [b, a];
        // Two parts side by side: each ends above and below, and where the other one begins.
        let across = |x: f64| [Vec2::new(x, 0.0), Vec2::new(x, 5.0)];
        let mut all = vec![line(0.0, 0.0), across(10.0), line(0.0, 5.0)];
        between_others(&mut all, vec![line(10.0, 0.0), turned(across(10.0)), line(10.0, 5.0)], 1e-6);
        all.sort_by(|a, b| (a[0].y, a[0].x).partial_cmp(&(b[0].y, b[0].x)).expect("numbers"));
        assert_eq!(all, [line(0.0, 0.0), line(10.0, 0.0), line(0.0, 5.0), line(10.0, 5.0)]);
    }

    #[test]
    fn bends_about_one_line_are_one_only_if_they_are_alike() {
        let bend = |x: f64, angle: f64, radius: f64| SheetBend {
            kind: BendKind::Bend,
            lines: vec![[Vec2::new(x, 5.0), Vec2::new(x + 40.0, 5.0)]],
            bends: Vec::new(),
            rulings: 1,
            extents: Vec::new(),
            sense: BendSense::Up,
            angle,
            inside_radius: radius,
            least_inside_radius: radius,
            k: 0.44,
            allowance: (radius + 0.88) * angle,
            length: 40.0,
            order: 0,
            edges: Vec::new(),
            face: None,
            steps: 1,
        };
        let first = bend(0.0, 1.5, 2.0);
        assert!(one_line(&first, &bend(60.0, 1.5, 2.0), 1e-3));
        assert!(!one_line(&first, &bend(60.0, 1.5, 4.0), 1e-3));
        assert!(!one_line(&first, &bend(60.0, 1.505, 2.0), 1e-3));
    }
}
