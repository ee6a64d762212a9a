//! Contours of a piece: the runs that are not inside it, chained, as lines and true arcs.

use super::region::POINT;
use super::tree::{Placed, UnfoldedPiece};
use crate::brep::body::Body;
use crate::develop::arcs::{arcs, circle, PlaneCurve};
use crate::geom::Vec2;
use crate::patchwork::image::{EdgeImage, JointImage, MapStrip, Stroke};
use crate::patchwork::pattern::{Contour, ContourVertex};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use std::collections::HashSet;

/// A contour with what it follows.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Lines and arcs.
    pub contour: Contour,
    /// Runs in order.
    pub halves: Vec<usize>,
    /// Signed area, mm²: positive for outer contours.
    pub area: f64,
    /// Largest distance (mm) between drawn and exact outline, measured.
    pub error: f64,
    /// What every line and arc is drawn for.
    pub strokes: Vec<Stroke>,
}

/// A vertex of a contour that follows a run.
#[derive(Clone, Copy, Debug)]
struct Station {
    vertex: ContourVertex,
    /// Number of the run in the outline, and share of it.
    run: usize,
    share: f64,
    /// Whether the piece that leaves it joins two runs and follows none.
    bridge: bool,
}

/// A run in the plane.
struct FlatStretch<'a> {
    body: &'a Body<'a>,
    placed: &'a Placed,
    half: usize,
}

/// Step for derivatives along a run: at 1e-5 rounding and the term left out are both some 1e-10 of the length.
const STEP: f64 = 1e-5;

impl PlaneCurve for FlatStretch<'_> {
    fn place(&self, s: f64) -> Vec2 {
        let h = &self.body.halves[self.half];
        let (x, uv) = h.stretch.at(self.body.faces[h.face], s);
        self.placed.motion.apply(&self.placed.chart.flat(&x, Some(uv)))
    }

    fn velocity(&self, s: f64) -> Vec2 {
        let at = |k: f64| self.place(s + k * STEP);
        if s < STEP {
            (at(1.0) * 4.0 - at(2.0) - at(0.0) * 3.0) / (2.0 * STEP)
        } else if s > 1.0 - STEP {
            (at(0.0) * 3.0 + at(-2.0) - at(-1.0) * 4.0) / (2.0 * STEP)
        } else {
            (at(1.0) - at(-1.0)) / (2.0 * STEP)
        }
    }
}

/// Ends of runs farther apart than this share of the body are joined by a line: allowances of sharp bends.
const GAP: f64 = 1e-6;

/// The contours of a piece, outer ones first.
pub fn outlines(body: &Body, piece: &UnfoldedPiece, tolerance: f64) -> Vec<Outline> {
    let mut open: Vec<usize> = piece.faces.iter().flat_map(|p| body.of_face(p.face)).collect();
    open.retain(|h| !piece.inner.contains(h) && body.halves[*h].length > POINT * body.size);
    open.sort_unstable();
    let mut seen: HashSet<usize> = HashSet::new();
    let mut out = Vec::new();
    for &start in &open {
        if seen.contains(&start) {
            continue;
        }
        let mut halves = Vec::new();
        let mut h = start;
        while seen.insert(h) {
            halves.push(h);
            h = following(body, piece, h);
        }
        out.push(outline(body, piece, halves, tolerance));
    }
    out.sort_by(|a, b| b.area.total_cmp(&a.area));
    out
}

/// The run after a run on the boundary of the piece: at inner edges the way goes on along the neighbour.
fn following(body: &Body, piece: &UnfoldedPiece, half: usize) -> usize {
    let mut h = body.halves[half].next;
    for _ in 0..body.halves.len() {
        let point = body.halves[h].length <= POINT * body.size;
        match body.halves[h].twin.filter(|_| piece.inner.contains(&h)) {
            Some(twin) => h = body.halves[twin].next,
            None if point => h = body.halves[h].next,
            None => break,
        }
    }
    h
}

/// Share of the tolerance within which arcs are laid along edges whose images are only enclosed.
const PROVEN: f64 = 0.9;

/// The contour along runs.
fn outline(body: &Body, piece: &UnfoldedPiece, halves: Vec<usize>, tolerance: f64) -> Outline {
    let mut stations: Vec<Station> = Vec::new();
    let mut error = 0.0_f64;
    let mut end: Option<Vec2> = None;
    let first = piece.place(body, halves[0], 0.0);
    for (number, &half) in halves.iter().enumerate() {
        let Some(placed) = piece.placed(body.halves[half].face) else { continue };
        let run = FlatStretch { body, placed, half };
        join(&mut stations, &mut error, (end, run.place(0.0)), (number, GAP * body.size));
        let (pieces, off) = whole_arc(&run, tolerance).unwrap_or_else(|| {
            // The proof of maps without closed form adds what it does not know of them.
            let share = if placed.chart.closed().is_some() { 1.0 } else { PROVEN };
            let (pieces, off) = arcs(&run, share * tolerance);
            let vertex = |(k, p): (usize, &crate::develop::arcs::ArcPiece)| ContourVertex {
                point: p.point,
                bulge: p.bulge,
                corner: k == 0,
            };
            (pieces.iter().enumerate().map(vertex).collect(), off)
        });
        error = error.max(off);
        let mut share = 0.0;
        for vertex in pieces {
            share = nearest(&run, &vertex.point, share);
            stations.push(Station { vertex, run: number, share, bridge: false });
        }
        end = Some(run.place(1.0));
    }
    join(&mut stations, &mut error, (end, first), (halves.len(), GAP * body.size));
    to_bend_lines(body, piece, &halves, &mut stations);
    let stations = simpler(stations);
    let strokes = strokes(body, piece, &halves, &stations);
    let bridges = stations.iter().map(|s| s.bridge);
    let lines = stations.iter().map(|s| s.vertex).zip(strokes);
    let (vertices, strokes) = straight_on(lines.zip(bridges).collect(), GAP * body.size);
    let contour = Contour { vertices };
    Outline { area: contour_area(&contour), contour, halves, error, strokes }
}

/// Where the next run begins apart from the end of the last, a line joins them; what is less is part of the error.
fn join(stations: &mut Vec<Station>, error: &mut f64, way: (Option<Vec2>, Vec2), (run, gap): (usize, f64)) {
    let (Some(end), next) = way else { return };
    let apart = (next - end).norm();
    if apart > gap {
        let vertex = ContourVertex { point: end, bulge: 0.0, corner: true };
        stations.push(Station { vertex, run: run.saturating_sub(1), share: 1.0, bridge: true });
    } else {
        *error = error.max(apart);
    }
}

/// Outside a sharp bend both faces reach to its edge, beyond what the bend is made of, and the way from one to the other goes back:
/// straight runs then end at the line about which the sheet is bent, half way between both images of the edge.
fn to_bend_lines(body: &Body, piece: &UnfoldedPiece, halves: &[usize], stations: &mut [Station]) {
    let n = stations.len();
    let run = |number: usize| {
        let half = halves[number % halves.len()];
        Some(FlatStretch { body, placed: piece.placed(body.halves[half].face)?, half })
    };
    for k in (0..n).filter(|_| n > 3) {
        let [before, bridge, after, next] = [n - 1, 0, 1, 2].map(|j| stations[(k + j) % n]);
        let joins = bridge.bridge && !before.bridge && !after.bridge;
        if !joins || before.vertex.bulge != 0.0 || after.vertex.bulge != 0.0 {
            continue;
        }
        let (from, to) = (bridge.vertex.point, after.vertex.point);
        let (back, middle) = (to - from, (from + to) * 0.5);
        // Where a line passes the bend line, if it does so against the way back.
        let passes = |a: Vec2, b: Vec2| {
            let (start, whole) = (back.dot(&(middle - a)), back.dot(&(b - a)));
            let share = start / whole;
            (whole < 0.0 && share > 0.0 && share < 1.0).then(|| a + (b - a) * share)
        };
        let meet = passes(before.vertex.point, from).zip(passes(to, next.vertex.point));
        let Some((((end, start), run), next_run)) = meet.zip(run(bridge.run)).zip(run(after.run)) else { continue };
        let first = if before.run == bridge.run { before.share } else { 0.0 };
        let share = nearest(&run, &end, first);
        let point = |v: ContourVertex, point: Vec2| ContourVertex { point, ..v };
        stations[k] = Station { vertex: point(bridge.vertex, end), share, ..bridge };
        let share = nearest(&next_run, &start, after.share);
        stations[(k + 1) % n] = Station { vertex: point(after.vertex, start), share, ..after };
    }
}

/// Vertices and strokes without the lines that join runs which meet, and with those runs as one line where they go straight on.
fn straight_on(lines: Vec<((ContourVertex, Stroke), bool)>, gap: f64) -> (Vec<ContourVertex>, Vec<Stroke>) {
    let n = lines.len();
    let meets = |k: usize| lines[k].1 && (lines[k].0 .1.end - lines[k].0 .1.start).norm() <= gap;
    // Begin where nothing is left out.
    let first = (0..n).find(|k| !meets(*k) && !meets((k + n - 1) % n)).unwrap_or(0);
    let mut out: Vec<(ContourVertex, Stroke)> = Vec::with_capacity(n);
    let mut met = false;
    for k in (0..n).map(|k| (first + k) % n) {
        if meets(k) {
            met = true;
            continue;
        }
        let (mut vertex, mut stroke) = lines[k].0.clone();
        if let (true, Some((_, last))) = (met, out.last_mut()) {
            let (a, b) = (last.end - last.start, stroke.end - last.end);
            let straight = last.bulge == 0.0 && stroke.bulge == 0.0 && a.dot(&b) > 0.0;
            if straight && a.perp(&b).abs() <= gap * a.norm() {
                let images = last.images.take().zip(stroke.images.take());
                (last.end, last.images) = (stroke.end, images.map(|(a, b)| [a, b].concat()));
                met = false;
                continue;
            }
            vertex.point = last.end;
            stroke.start = last.end;
        }
        met = false;
        out.push((vertex, stroke));
    }
    out.into_iter().unzip()
}

/// Share of a run, from `from` on, where it passes nearest to a point of it.
fn nearest(run: &FlatStretch, x: &Vec2, from: f64) -> f64 {
    /// Starts.
    const STARTS: usize = 64;
    let far = |s: f64| (run.place(s) - x).norm();
    let at = |k: usize| from + (1.0 - from) * k as f64 / STARTS as f64;
    let Some(k) = (0..=STARTS).min_by(|a, b| far(at(*a)).total_cmp(&far(at(*b)))) else { return from };
    let mut s = at(k);
    for _ in 0..8 {
        let v = run.velocity(s);
        let step = (x - run.place(s)).dot(&v) / v.norm_squared();
        if !step.is_finite() {
            break;
        }
        s = (s + step).clamp(from, 1.0);
    }
    // Both ends are met exactly.
    [from, 1.0].into_iter().find(|e| far(*e) <= far(s)).unwrap_or(s)
}

/// What the lines and arcs between stations are drawn for.
fn strokes(body: &Body, piece: &UnfoldedPiece, halves: &[usize], stations: &[Station]) -> Vec<Stroke> {
    let n = stations.len();
    let stroke = |k: usize| {
        let (a, b) = (&stations[k], &stations[(k + 1) % n]);
        let last = if k + 1 == n { (halves.len(), 0.0) } else { (b.run, b.share) };
        let images = match a.bridge {
            true => Some(Vec::new()),
            false => (a.run..=last.0)
                .filter_map(|r| {
                    let ends = [if r == a.run { a.share } else { 0.0 }, if r == last.0 { last.1 } else { 1.0 }];
                    (ends[0] < ends[1]).then(|| halves.get(r).map(|h| images(body, piece, *h, ends)))?
                })
                .collect::<Option<Vec<_>>>()
                .map(|runs| runs.concat()),
        };
        Stroke { start: a.vertex.point, end: b.vertex.point, bulge: a.vertex.bulge, images }
    };
    (0..n).map(stroke).collect()
}

/// The parameter at a share of the way between two, which rounding must not lead beyond the domain of the curve.
fn at_share([from, to]: [f64; 2], (first, last): (f64, f64), share: f64) -> f64 {
    (from + (to - from) * share).clamp(first, last)
}

/// A part of a run for the judge: one image, or one for each strip of its face; `None` where its map has no closed form.
fn images(body: &Body, piece: &UnfoldedPiece, half: usize, ends: [f64; 2]) -> Option<Vec<EdgeImage>> {
    let h = &body.halves[half];
    let face = piece.faces.iter().position(|p| p.face == h.face)?;
    let placed = &piece.faces[face];
    let (curve, [from, to]) = h.stretch.curve()?;
    let along = |s: f64| at_share([from, to], curve.domain(), s);
    let strips = placed_strips(placed);
    if !strips.is_empty() {
        let at = |share: f64| {
            let (x, uv) = h.stretch.at(body.faces[h.face], share);
            placed.chart.ruling_at(&x, uv)
        };
        let image = |(k, ends): (usize, [f64; 2])| {
            let s = strips[k];
            EdgeImage {
                face,
                curve: curve.clone(),
                map: s.map,
                turn: s.turn,
                shift: s.shift,
                part: ends.map(along),
                // Strips are narrow, and their frames look at their middle.
                angles: [0.0; 2],
            }
        };
        return Some(strip_parts(&strips, &at, ends)?.into_iter().map(image).collect());
    }
    let angle = |s: f64| {
        let (x, uv) = h.stretch.at(body.faces[h.face], s);
        placed.chart.angle(&x, Some(uv)).unwrap_or(0.0)
    };
    let image = EdgeImage {
        face,
        curve: curve.clone(),
        map: placed.chart.closed()?,
        turn: placed.motion.turn,
        shift: placed.motion.shift,
        part: ends.map(along),
        angles: ends.map(angle),
    };
    Some(vec![image])
}

/// The strips that a face is laid flat in, where it lies in the piece.
pub(super) fn placed_strips(placed: &Placed) -> Vec<MapStrip> {
    let [c, s] = placed.motion.turn;
    let place = |own: &MapStrip| {
        let [a, b] = own.turn;
        MapStrip { turn: [c * a - s * b, s * a + c * b], shift: placed.motion.apply(&own.shift), ..*own }
    };
    placed.chart.strips().iter().map(place).collect()
}

/// Numbers of the strips that a part of a run passes through, with the shares between which it does; `at` tells the
/// parameter of the ruling at a share.
fn strip_parts(strips: &[MapStrip], at: &dyn Fn(f64) -> f64, ends: [f64; 2]) -> Option<Vec<(usize, [f64; 2])>> {
    /// Places looked at first.
    const PLACES: usize = 32;
    /// Share of all rulings within which a run keeps to one.
    const ONE_RULING: f64 = 1e-9;
    let (first, last) = (strips.first()?.span[0], strips.last()?.span[1]);
    let strip = |s: f64| strips.partition_point(|k| k.span[1] < s).min(strips.len() - 1);
    let share = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / PLACES as f64;
    let seen: Vec<f64> = (0..=PLACES).map(|k| at(share(k))).collect();
    let (lo, hi) = seen.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |b, s| (b.0.min(*s), b.1.max(*s)));
    if hi - lo <= ONE_RULING * (last - first) {
        return Some(vec![(strip(0.5 * (lo + hi)), ends)]);
    }
    let mut cuts = vec![(ends[0], strip(seen[0]))];
    for k in 0..PLACES {
        let of = [strip(seen[k]), strip(seen[k + 1])];
        changes(&|t| strip(at(t)), [share(k), share(k + 1)], of, &mut cuts);
    }
    let to = |k: usize| cuts.get(k + 1).map_or(ends[1], |c| c.0);
    Some((0..cuts.len()).map(|k| (cuts[k].1, [cuts[k].0, to(k)])).filter(|(_, [a, b])| a < b).collect())
}

/// Where the strip changes between two shares, by halving.
fn changes(strip: &dyn Fn(f64) -> usize, [a, b]: [f64; 2], [i, j]: [usize; 2], out: &mut Vec<(f64, usize)>) {
    /// Shares closer than this are one.
    const SAME_SHARE: f64 = 1e-12;
    if i == j {
        return;
    }
    let m = 0.5 * (a + b);
    if b - a <= SAME_SHARE {
        out.push((m, j));
        return;
    }
    let k = strip(m);
    changes(strip, [a, m], [i, k], out);
    changes(strip, [m, b], [k, j], out);
}

/// Both images of the rulings between the strips of a face.
pub(super) fn strip_joints(piece: &UnfoldedPiece, face: usize) -> Vec<JointImage> {
    let placed = &piece.faces[face];
    let strips = placed_strips(placed);
    let joint = |w: &[MapStrip]| -> Option<JointImage> {
        let at = w[0].span[1];
        let ends = placed.chart.ruling_ends(at)?;
        let curve = Curve {
            knots: Knots::clamped(1, &[0.0, 1.0]).ok()?,
            control: ends.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect(),
        };
        let flat = ends.map(|p| placed.motion.apply(&placed.chart.flat_on_ruling(at, &p)));
        let side = |s: &MapStrip, part: [f64; 2]| {
            let [start, end] = part.map(|t| if t == 0.0 { flat[0] } else { flat[1] });
            let (map, turn, shift) = (s.map, s.turn, s.shift);
            let image = EdgeImage { face, curve: curve.clone(), map, turn, shift, part, angles: [0.0; 2] };
            vec![Stroke { start, end, bulge: 0.0, images: Some(vec![image]) }]
        };
        Some([side(&w[0], [0.0, 1.0]), side(&w[1], [1.0, 0.0])])
    };
    // A joint that cannot be made is one of which nothing is known.
    let unknown = || [vec![Stroke::unknown(Vec2::zeros(), Vec2::x())], vec![Stroke::unknown(Vec2::x(), Vec2::zeros())]];
    strips.windows(2).map(|w| joint(w).unwrap_or_else(unknown)).collect()
}

/// Share of the tolerance within which lines and arcs keep to an inner edge: those of both sides count in the gap, and nobody draws them.
const INSIDE: f64 = 0.1;

/// Both images of an inner edge: lines and arcs for one, and the same, after the move `gap` of a sharp bend, for the other.
pub(super) fn joint(
    body: &Body,
    piece: &UnfoldedPiece,
    [half, twin]: [usize; 2],
    tolerance: f64,
) -> Option<JointImage> {
    let run = |half: usize| Some(FlatStretch { body, placed: piece.placed(body.halves[half].face)?, half });
    let (near, far) = (run(half)?, run(twin)?);
    let vertices = |run: &FlatStretch| whole_arc(run, tolerance).map(|v| v.0);
    let vertices = vertices(&near).unwrap_or_else(|| {
        let (pieces, _) = arcs(&near, INSIDE * tolerance);
        pieces.iter().map(|p| ContourVertex { point: p.point, bulge: p.bulge, corner: false }).collect()
    });
    let end = near.place(1.0);
    let points: Vec<Vec2> = vertices.iter().map(|v| v.point).chain([end]).collect();
    // Where the vertices lie on both runs; the twin passes them the other way round.
    let gap = 0.5 * ((far.place(1.0) - points[0]) + (far.place(0.0) - end));
    let last = points.len() - 1;
    let (mut here, mut there) = (vec![0.0; last + 1], vec![0.0; last + 1]);
    for k in 1..last {
        here[k] = nearest(&near, &points[k], here[k - 1]);
    }
    here[last] = 1.0;
    for k in 1..last {
        there[k] = nearest(&far, &(points[last - k] + gap), there[k - 1]);
    }
    there[last] = 1.0;
    let side = |half: usize, shares: &[f64], at: &dyn Fn(usize) -> (Vec2, Vec2, f64)| -> Vec<Stroke> {
        let stroke = |k: usize| {
            let (start, end, bulge) = at(k);
            Stroke { start, end, bulge, images: images(body, piece, half, [shares[k], shares[k + 1]]) }
        };
        (0..last).map(stroke).collect()
    };
    let along = |k: usize| (points[k], points[k + 1], vertices[k].bulge);
    let back = |k: usize| (points[last - k] + gap, points[last - k - 1] + gap, -vertices[last - k - 1].bulge);
    Some([side(half, &here, &along), side(twin, &there, &back)])
}

/// Arcs turn by no more than this (rad): the radius and the ends, all that SVG knows of an arc, say little of one that is
/// nearly half a turn.
const MOST_SWEEP: f64 = std::f64::consts::TAU / 3.0;

/// A run that is one line or one circular arc, to what ten digits hold: as such.
fn whole_arc(run: &FlatStretch, tolerance: f64) -> Option<(Vec<ContourVertex>, f64)> {
    /// Samples.
    const SAMPLES: usize = 24;
    /// Share of the tolerance within which the run must keep to the arc.
    const EXACT: f64 = 1e-2;
    /// The same as a share of its length.
    const EXACT_SHARE: f64 = 1e-6;
    let p: Vec<Vec2> = (0..=SAMPLES).map(|k| run.place(k as f64 / SAMPLES as f64)).collect();
    let chords: f64 = p.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let allowed = (EXACT * tolerance).min(EXACT_SHARE * chords);
    let way = (p[SAMPLES] - p[0]).try_normalize(0.0);
    let off = |way: Vec2| p.iter().map(|q| way.perp(&(q - p[0])).abs()).fold(0.0, f64::max);
    if let Some(off) = way.map(off).filter(|o| *o <= allowed) {
        return Some((vec![ContourVertex { point: p[0], bulge: 0.0, corner: true }], off));
    }
    let (a, b, c) = (p[0], p[SAMPLES / 3], p[2 * SAMPLES / 3]);
    let centre = centre(&a, &b, &c)?;
    let radius = (a - centre).norm();
    let off = p.iter().map(|q| ((q - centre).norm() - radius).abs()).fold(0.0, f64::max);
    if off > allowed {
        return None;
    }
    let angle = |u: Vec2, v: Vec2| u.perp(&v).atan2(u.dot(&v));
    let turns: Vec<f64> = p.windows(2).map(|w| angle(w[0] - centre, w[1] - centre)).collect();
    let sweep: f64 = turns.iter().sum();
    if turns.iter().any(|t| t * sweep < 0.0) || sweep.abs() > std::f64::consts::TAU * (1.0 + EXACT_SHARE) {
        return None;
    }
    // A hair more than the most is rounding.
    let count = ((sweep.abs() / MOST_SWEEP) * (1.0 - EXACT_SHARE)).ceil().max(1.0) as usize;
    let step = sweep / count as f64;
    let vertex = |k: usize| {
        let (s, c) = (step * k as f64).sin_cos();
        let v = a - centre;
        let point = if k == 0 { a } else { centre + Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y) };
        ContourVertex { point, bulge: (0.25 * step).tan(), corner: k == 0 }
    };
    Some(((0..count).map(vertex).collect(), off))
}

/// Centre of the circle through three points.
fn centre(a: &Vec2, b: &Vec2, c: &Vec2) -> Option<Vec2> {
    let (u, v) = (b - a, c - a);
    let d = 2.0 * u.perp(&v);
    let out =
        a + Vec2::new(v.y * u.norm_squared() - u.y * v.norm_squared(), u.x * v.norm_squared() - v.x * u.norm_squared())
            / d;
    (out.x.is_finite() && out.y.is_finite()).then_some(out)
}

/// Lines that go straight on, and arcs of one circle, as one piece.
fn simpler(v: Vec<Station>) -> Vec<Station> {
    /// Share of the pieces' length within which they must keep to one line or circle.
    const SAME: f64 = 1e-6;
    let mut out: Vec<Station> = Vec::with_capacity(v.len());
    let n = v.len();
    let merged = |last: &Station, here: &Station, c: Vec2| -> Option<f64> {
        let (a, b) = (last.vertex.point, here.vertex.point);
        let (p, q) = (last.vertex.bulge, here.vertex.bulge);
        let length = (b - a).norm() + (c - b).norm();
        if n <= 3 || last.bridge || here.bridge {
            return None;
        }
        if p == 0.0 && q == 0.0 {
            let way = (c - a).try_normalize(0.0)?;
            let on = way.perp(&(b - a)).abs() <= SAME * length && way.dot(&(b - a)) > 0.0 && way.dot(&(c - b)) > 0.0;
            return on.then_some(0.0);
        }
        if p * q <= 0.0 {
            return None;
        }
        let ((o, r), (m, s)) = (circle(&a, &b, p), circle(&b, &c, q));
        let sweep = p.atan() + q.atan();
        let one = (o - m).norm() <= SAME * length && (r - s).abs() <= SAME * length;
        (one && 4.0 * sweep.abs() <= MOST_SWEEP * (1.0 + SAME)).then(|| sweep.tan())
    };
    for k in 0..n {
        let (here, next) = (v[k], v[(k + 1) % n].vertex.point);
        let bulge = out.last().and_then(|last| merged(last, &here, next));
        match (bulge, out.last_mut()) {
            (Some(bulge), Some(last)) => last.vertex.bulge = bulge,
            _ => out.push(here),
        }
    }
    out
}

/// Area inside a contour with its arcs, mm²; negative clockwise.
pub fn contour_area(c: &Contour) -> f64 {
    let v = &c.vertices;
    let Some(o) = v.first().map(|v| v.point) else { return 0.0 };
    let piece = |k: usize| {
        let (a, b) = (&v[k], &v[(k + 1) % v.len()]);
        let straight = 0.5 * (a.point - o).perp(&(b.point - o));
        if a.bulge == 0.0 {
            return straight;
        }
        let sweep = 4.0 * a.bulge.atan();
        let (_, r) = circle(&a.point, &b.point, a.bulge);
        straight + 0.5 * r * r * (sweep - sweep.sin())
    };
    (0..v.len()).map(piece).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of the arc of an ellipse, as a file had them.
    #[test]
    fn parts_of_edges_end_where_the_edges_do() {
        let (first, last) = (0.25461598547677533, 2.8762634051743587);
        let ends = [last, 0.2546159854767751];
        assert_eq!([0.0, 1.0].map(|s| at_share(ends, (first, last), s)), [last, first]);
    }
}
