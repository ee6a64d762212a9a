//! Boundary curves traced on a surface: feet of samples, unwrapped over periods, held together at poles; then chords.

use super::error::TrimError;
use super::polygon::{Polygon, Side};
use crate::brep::face::{FileEdge, FilePiece, VANISHED};
use crate::brep::parameter_map::ParameterMap;
use crate::brep::raw::{PlaneTrace, RawEdge, RawLoop};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::SupportSurface;
use crate::brep::swept::Pole;
use crate::brep::unroll;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::SAME_PARAMETER;

/// Gaps between edges above this share of the boundary's extent are an open boundary.
const GAP_SHARE: f64 = 2e-2;
/// Edges farther from the surface than this share of the boundary's extent do not belong to it.
const OFF_SURFACE_SHARE: f64 = 5e-2;
/// Where vertices of the file, or the uncertainty that it states, say that edges meet or lie on their surface, this share
/// of the boundary's extent is allowed instead. What is moved is part of the bound of the trim.
const LOOSEST_SHARE: f64 = 0.2;
/// Curves shorter than this share of the boundary's extent are points, and points nearer than that to a pole are on it.
pub(super) const POINT_SHARE: f64 = 1e-7;
/// Ways round that miss a whole period by less than this share of it are one: points on poles are known to
/// [`POINT_SHARE`].
pub(super) const WHOLE_PERIOD: f64 = 1e-7;
/// Share of the last sample step before a pole at which the direction of arrival is seen: near the tangent's, and far
/// above [`POINT_SHARE`].
const BEFORE_POLE: f64 = 1e-3;
/// Gaps between consecutive edges up to this share of the extent are closed by moving both ends to the middle.
const WELD_SHARE: f64 = 1e-4;
/// Ends nearer to the surface than this share of the extent lie on it, though the edge between them leaves it.
const ENDS_SHARE: f64 = 1e-3;
/// Ends that are moved to the middle of a gap may move the other end of their chord by so many times the gap, if it went on there.
const TURNED: f64 = 1e3;
/// Natural parameters nearer than this share of a period are of one lift of a point, others of another.
const SAME_LIFT: f64 = 0.02;
/// Chords of one face at most.
const MOST_CHORDS: usize = 200_000;
/// Halvings of one sample interval at most: 2⁻¹⁴ of an edge is finer than any honest curve needs.
const DEEPEST: u32 = 14;
/// So many intervals of one piece that halving to the end does not bring within the tolerance are corners and jumps of a
/// curve; where there are more, feet scatter (on surfaces a million times larger than the face, say), …
const VAIN: usize = 256;
/// … and so many halvings are enough: finer chords would follow the scatter, and cost minutes.
const DEEPEST_IN_VAIN: u32 = 6;

/// Which ends of edges are moved to the middle of the gap between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Welds {
    /// Those whose chords are not turned by it.
    Straight,
    /// All that are near enough.
    All,
}

/// One piece of an edge with samples in the unwrapped natural parameter plane.
#[derive(Clone, Debug)]
pub(super) struct Pcurve {
    /// Number of the edge in the file.
    pub edge: u64,
    /// Label of its chords.
    pub label: u32,
    /// Number of the piece of the edge that it is.
    piece: usize,
    arc: Arc,
    /// Where the file's vertices put the ends, if it begins or ends its edge.
    vertices: [Option<Vec3>; 2],
    trace: Option<PlaneTrace>,
    ts: Vec<f64>,
    /// Samples.
    pub qs: Vec<[f64; 2]>,
    poles: [Option<Pole>; 2],
    /// Label of the side along a pole that follows the pcurve.
    joint: Option<u32>,
}

/// A closed loop in the unwrapped plane: it ends where it began, up to `winding` periods.
#[derive(Clone, Debug)]
pub(super) struct TracedLoop {
    /// The pieces in order; empty for straight lines.
    pub pcurves: Vec<Pcurve>,
    /// Straight lines that the reader adds: corners, and the label of the first side (the others follow). A line along
    /// a pole has two corners, the second a period away.
    pub line: Option<(Vec<[f64; 2]>, u32)>,
    /// Turns in u and v.
    pub winding: [i32; 2],
    /// The edges of the loop, those too that are points; none for straight lines.
    pub edges: Vec<FileEdge>,
}

/// The chords of a chain.
pub(super) struct Chords {
    /// Their polygon; a winding one closes over the period.
    pub polygon: Polygon,
    /// Largest distance between curve and chord at the samples, and widest gap that was closed, mm.
    pub deviation: f64,
}

impl TracedLoop {
    /// All samples.
    pub fn nodes(&self) -> impl Iterator<Item = &[f64; 2]> {
        let line = self.line.iter().flat_map(|l| l.0.iter());
        self.pcurves.iter().flat_map(|s| s.qs.iter()).chain(line)
    }

    /// Leaves out curves that are run there and back one after the other: they bound nothing. Writers cut surfaces that close
    /// both ways so, and leave slits in others.
    pub fn without_slits(mut self, periods: [Option<f64>; 2]) -> Self {
        let mut kept: Vec<Pcurve> = Vec::with_capacity(self.pcurves.len());
        for p in self.pcurves.drain(..) {
            match kept.last() {
                Some(last) if last.is_run_back_by(&p, periods) => drop(kept.pop()),
                _ => kept.push(p),
            }
        }
        // The loop may begin within a slit.
        let inner =
            (0..kept.len() / 2).take_while(|&i| kept[kept.len() - 1 - i].is_run_back_by(&kept[i], periods)).count();
        self.pcurves = kept.drain(inner..kept.len() - inner).collect();
        self.edges.retain(|e| self.pcurves.iter().any(|p| p.label == e.label));
        self
    }

    /// Moves the chain in the parameter plane.
    pub fn shift(&mut self, d: [f64; 2]) {
        let line = self.line.iter_mut().flat_map(|l| l.0.iter_mut());
        for q in self.pcurves.iter_mut().flat_map(|s| s.qs.iter_mut()).chain(line) {
            *q = [q[0] + d[0], q[1] + d[1]];
        }
    }
}

/// The surface that loops are traced on, and how far from it and from each other edges may be.
pub(super) struct Ground<'a> {
    support: &'a SupportSurface,
    periods: [Option<f64>; 2],
    poles: Vec<Pole>,
    /// Extent of the boundary, mm.
    size: f64,
    /// Distance below which the file calls points the same, at most [`LOOSEST_SHARE`] of the extent. mm.
    uncertainty: f64,
}

impl<'a> Ground<'a> {
    /// The ground of a face whose boundary has the extent `size` (mm).
    pub fn new(support: &'a SupportSurface, size: f64, uncertainty: f64) -> Self {
        let uncertainty = uncertainty.min(LOOSEST_SHARE * size);
        Self { support, periods: support.periods(), poles: support.poles(), size, uncertainty }
    }

    /// The widest gap between two edges that is closed: more where their vertices are one point.
    fn widest_gap(&self, before: Option<Vec3>, after: Option<Vec3>) -> f64 {
        let same = (WELD_SHARE * self.size).max(self.uncertainty);
        match before.zip(after) {
            Some((p, q)) if (p - q).norm() <= same => LOOSEST_SHARE * self.size,
            _ => (GAP_SHARE * self.size).max(self.uncertainty),
        }
    }

    /// The largest distance from the surface at which an edge still belongs to it: more where its ends lie on it.
    fn farthest(&self, ends: [f64; 2]) -> f64 {
        let on = (ENDS_SHARE * self.size).max(self.uncertainty);
        if ends.iter().all(|d| *d <= on) {
            LOOSEST_SHARE * self.size
        } else {
            (OFF_SURFACE_SHARE * self.size).max(self.uncertainty)
        }
    }
}

/// The lift of `x` nearest to `near`.
fn lifted(x: f64, near: f64, period: Option<f64>) -> f64 {
    match period {
        Some(p) => x + ((near - x) / p).round() * p,
        None => x,
    }
}

/// Traces a loop; nothing if it is shorter than a point. `label` counts the edges of the face.
pub(super) fn trace(ground: &Ground, l: &RawLoop, label: &mut u32) -> Result<Option<TracedLoop>, TrimError> {
    let periods = ground.periods;
    let mut pcurves: Vec<Pcurve> = Vec::new();
    let mut edges = Vec::new();
    for e in &l.edges {
        for (piece, arc) in e.path.iter().enumerate() {
            let trace = e.trace.as_ref().filter(|_| e.path.len() == 1);
            let found = follow(ground, arc, trace, (e.entity, *label))?;
            let first = e.vertices.map(|v| v[0]).filter(|_| piece == 0);
            let last = e.vertices.map(|v| v[1]).filter(|_| piece + 1 == e.path.len());
            pcurves.extend(found.map(|s| Pcurve { piece, vertices: [first, last], ..s }));
        }
        edges.push(FileEdge { entity: e.entity, label: *label, pieces: pieces_of(&e.path) });
        *label += 1;
    }
    if pcurves.is_empty() {
        return Ok(None);
    }
    // Lift every pcurve to where the one before ended.
    let n = pcurves.len();
    let start = pcurves[0].qs[0];
    let mut end = pcurves[0].end();
    for i in 0..n {
        let (before, after) = (pcurves[i].edge, pcurves[(i + 1) % n].edge);
        let gap = (pcurves[i].arc.ends().1 - pcurves[(i + 1) % n].arc.ends().0).norm();
        if gap > ground.widest_gap(pcurves[i].vertices[1], pcurves[(i + 1) % n].vertices[0]) {
            return Err(TrimError::Gap { before, after, gap });
        }
        let next = &pcurves[(i + 1) % n];
        let mut target = [0, 1].map(|k| lifted(next.qs[0][k], end[k], periods[k]));
        if let (Some(p), Some(_)) = (pcurves[i].poles[1], next.poles[0]) {
            let free = 1 - p.axis;
            if let Some(period) = periods[free] {
                target[free] = end[free] + turn_at_pole(&pcurves[i], &p, next.qs[0][free] - end[free], period);
            }
            pcurves[i].joint = Some(*label);
            *label += 1;
        }
        if i + 1 == n {
            let winding = [0, 1].map(|k| periods[k].map_or(0, |p| ((target[k] - start[k]) / p).round() as i32));
            return Ok(Some(TracedLoop { pcurves, line: None, winding, edges }));
        }
        let next = &mut pcurves[i + 1];
        let d = [target[0] - next.qs[0][0], target[1] - next.qs[0][1]];
        for q in &mut next.qs {
            *q = [q[0] + d[0], q[1] + d[1]];
        }
        end = next.end();
    }
    Ok(None)
}

/// The step along a pole's side with the material on the left: `difference` up to whole periods, of the sign that the
/// side of the pole asks for; a full turn if the difference is none.
fn turn_at_pole(pcurve: &Pcurve, pole: &Pole, difference: f64, period: f64) -> f64 {
    let inner = pcurve.qs[pcurve.qs.len() / 2][pole.axis];
    let high = inner < pole.value;
    // Counter-clockwise: along v = low upward in u, u = high upward in v, v = high downward in u, u = low downward in v.
    let upward = (pole.axis == 1) != high;
    let rest = difference.rem_euclid(period);
    let none = rest < WHOLE_PERIOD * period || rest > (1.0 - WHOLE_PERIOD) * period;
    match (upward, none) {
        (true, true) => period,
        (true, false) => rest,
        (false, true) => -period,
        (false, false) => rest - period,
    }
}

impl Pcurve {
    /// Whether `other` runs along the same way on the surface in the opposite direction. Where the surface closes one way only it must
    /// be the same curve: no proof looks at what is left out.
    fn is_run_back_by(&self, other: &Self, periods: [Option<f64>; 2]) -> bool {
        let middle = |a: &Arc| a.curve.point(0.5 * (a.from + a.to));
        let (p, q) = (self.arc.ends(), other.arc.ends());
        let near = WELD_SHARE * ((middle(&self.arc) - p.0).norm() + (middle(&self.arc) - p.1).norm());
        let apart = |x: Vec3, y: Vec3| (x - y).norm() > near;
        let lifts = |d: f64, period: Option<f64>| period.is_some_and(|p| d.abs() > SAME_LIFT * p);
        let far = |a: [f64; 2], b: [f64; 2]| (0..2).any(|k| lifts(a[k] - b[k], periods[k]));
        let (first, last) = (self.qs[0], self.end());
        let same = self.arc.curve == other.arc.curve && [self.arc.from, self.arc.to] == [other.arc.to, other.arc.from];
        (same || periods.iter().all(Option::is_some))
            && !apart(p.0, q.1)
            && !apart(p.1, q.0)
            && !apart(middle(&self.arc), middle(&other.arc))
            && !far(first, other.end())
            && !far(last, other.qs[0])
    }

    fn end(&self) -> [f64; 2] {
        self.qs[self.qs.len() - 1]
    }

    /// Parameters of the curve as places along the edge: number of the piece and share of its spline.
    fn places(&self, ts: &[f64]) -> Vec<f64> {
        let (lo, hi) = (self.arc.from.min(self.arc.to), self.arc.from.max(self.arc.to));
        let map = self.arc.curve.to_spline(lo, hi).map_or(ParameterMap::Same, |c| c.1);
        let ends = [self.arc.from, self.arc.to].map(|t| map.forward(t));
        let share = |t: f64| ((map.forward(t) - ends[0]) / (ends[1] - ends[0])).clamp(0.0, 1.0);
        ts.iter().map(|&t| self.piece as f64 + share(t)).collect()
    }
}

/// The edges of a loop that is shorter than a point.
pub(super) fn vanished(l: &RawLoop) -> Vec<FileEdge> {
    let edge = |e: &RawEdge| FileEdge { entity: e.entity, label: VANISHED, pieces: pieces_of(&e.path) };
    l.edges.iter().map(edge).collect()
}

/// The pieces of an edge as rational splines; `None` if one has no such form.
fn pieces_of(path: &[Arc]) -> Option<Vec<FilePiece>> {
    path.iter()
        .map(|arc| {
            let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
            if lo == hi {
                // A point is the shortest of lines.
                let p = arc.curve.point(lo);
                let control = vec![[p.x, p.y, p.z, 1.0]; 2];
                let curve = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], control).ok()?;
                return Some(FilePiece { curve, from: 0.0, to: 1.0 });
            }
            let (curve, map) = match &arc.curve {
                SpaceCurve::Spline(c) if lo < c.domain().0 || hi > c.domain().1 => {
                    (unroll::curve(c, (lo, hi)).ok()?, ParameterMap::Same)
                }
                other => other.to_spline(lo, hi).ok()?,
            };
            let (a, b) = curve.domain();
            let [from, to] = [arc.from, arc.to].map(|t| map.forward(t).clamp(a, b));
            Some(FilePiece { curve, from, to })
        })
        .collect()
}

/// Samples one arc. `None` if it is a point.
fn follow(
    ground: &Ground,
    arc: &Arc,
    trace: Option<&PlaneTrace>,
    (edge, label): (u64, u32),
) -> Result<Option<Pcurve>, TrimError> {
    let Ground { support, periods, poles, size, .. } = ground;
    let (support, size) = (*support, *size);
    let stations = arc.curve.stations(arc.from, arc.to);
    // At least eight intervals on an edge: unwrapping needs steps well below half a period.
    let per = (8 / stations.len().saturating_sub(1).max(1)).clamp(3, 8);
    let mut ts = Vec::with_capacity(stations.len() * per);
    for w in stations.windows(2) {
        ts.extend((0..per).map(|i| w[0] + (w[1] - w[0]) * i as f64 / per as f64));
    }
    ts.push(arc.to);
    let points: Vec<Vec3> = ts.iter().map(|&t| arc.curve.point(t)).collect();
    let n = points.len();
    if points.iter().all(|p| (p - points[0]).norm() <= POINT_SHARE * size) || n < 3 {
        return Ok(None);
    }
    let pole_near = |x: &Vec3| poles.iter().find(|p| (p.point - x).norm() <= 10.0 * POINT_SHARE * size).copied();
    let mut qs = vec![[0.0; 2]; n];
    if let Some(trace) = trace.filter(|t| agrees(support, arc, t, size)) {
        // Jumps over a seam are not expected inside a trace.
        for (q, &t) in qs.iter_mut().zip(&ts) {
            *q = trace.at(t);
        }
        let at_poles = [pole_near(&points[0]), pole_near(&points[n - 1])];
        snap(support, &mut qs);
        return Ok(Some(Pcurve {
            edge,
            label,
            piece: 0,
            arc: arc.clone(),
            vertices: [None, None],
            trace: Some(trace.clone()),
            ts,
            qs,
            poles: at_poles,
            joint: None,
        }));
    }
    let mut guess: Option<[f64; 2]> = None;
    for i in 1..n - 1 {
        qs[i] = foot_near(support, &points[i], guess, periods);
        guess = Some(qs[i]);
    }
    let mut at_poles = [None, None];
    for (k, end, inner) in [(0, 0, 1), (1, n - 1, n - 2)] {
        at_poles[k] = pole_near(&points[end]);
        qs[end] = match at_poles[k] {
            Some(pole) => {
                // The direction of arrival: the foot of a point a little before the pole.
                let t = ts[end] + BEFORE_POLE * (ts[inner] - ts[end]);
                let mut q = foot_near(support, &arc.curve.point(t), Some(qs[inner]), periods);
                q[pole.axis] = lifted(pole.value, q[pole.axis], periods[pole.axis]);
                q
            }
            None => foot_near(support, &points[end], Some(qs[inner]), periods),
        };
    }
    let off: Vec<f64> = points.iter().zip(&qs).map(|(x, q)| (support.jet(*q).p - x).norm()).collect();
    let worst = off.iter().copied().fold(0.0, f64::max);
    if worst > ground.farthest([off[0], off[n - 1]]) || off.iter().any(|d| d.is_nan()) {
        return Err(TrimError::OffSurface { edge, distance: worst });
    }
    snap(support, &mut qs);
    let arc = arc.clone();
    let vertices = [None, None];
    Ok(Some(Pcurve { edge, label, piece: 0, arc, vertices, trace: None, ts, qs, poles: at_poles, joint: None }))
}

/// Traces this near to their curve are used: a share of the boundary's extent …
const TRACE_SHARE: f64 = 2e-5;
/// … or so many times the distance of the curve itself from the surface. Coarser traces are worse than feet.
const TRACE_FACTOR: f64 = 2.0;
/// Share of the support's domain by which a trace may leave it: what seven printed digits lose.
const BESIDE: f64 = 1e-6;

/// Whether a curve of the parameter plane runs with its curve in space.
fn agrees(support: &SupportSurface, arc: &Arc, trace: &PlaneTrace, size: f64) -> bool {
    if let (Some((a, b)), None) = (trace.curve.domain(), trace.curve.period()) {
        let hair = SAME_PARAMETER * (b - a);
        if arc.from.min(arc.to) < a - hair || arc.from.max(arc.to) > b + hair {
            return false;
        }
    }
    let limits = support.limits();
    (0..=8).all(|i| {
        let t = arc.from + (arc.to - arc.from) * f64::from(i) / 8.0;
        let (x, q) = (arc.curve.point(t), trace.at(t));
        let inside = (0..2).all(|k| {
            limits[k].is_none_or(|(a, b)| {
                let hair = BESIDE * (b - a);
                q[k] >= a - hair && q[k] <= b + hair
            })
        });
        let d = (support.jet(q).p - x).norm();
        let own = || (support.jet(support.foot(&x, Some(q))).p - x).norm();
        inside && (d <= TRACE_SHARE * size || d <= TRACE_FACTOR * own())
    })
}

/// The foot of `x`, lifted to the guess.
fn foot_near(support: &SupportSurface, x: &Vec3, guess: Option<[f64; 2]>, periods: &[Option<f64>; 2]) -> [f64; 2] {
    let q = support.foot(x, guess);
    match guess {
        Some(g) => [0, 1].map(|k| lifted(q[k], g[k], periods[k])),
        None => q,
    }
}

/// Feet within rounding of the support's own end lie on it: printed coordinates have ten digits or so.
const ON_LIMIT: f64 = 1e-8;

fn snap(support: &SupportSurface, qs: &mut [[f64; 2]]) {
    for (k, limit) in support.limits().iter().enumerate() {
        let Some((a, b)) = *limit else { continue };
        for q in qs.iter_mut() {
            for end in [a, b] {
                if (q[k] - end).abs() <= ON_LIMIT * (b - a) {
                    q[k] = end;
                }
            }
        }
    }
}

/// Lays chords along a chain in the spline's parameters so that their images stay within `tolerance` of the curves'
/// feet on the surface.
pub(super) fn chords(
    support: &SupportSurface,
    chain: &TracedLoop,
    map: &[ParameterMap; 2],
    (size, tolerance): (f64, f64),
    welds: Welds,
) -> Result<Chords, TrimError> {
    let forward = |q: [f64; 2]| [map[0].forward(q[0]), map[1].forward(q[1])];
    let natural = |p: [f64; 2]| [map[0].inverse(p[0]).0, map[1].inverse(p[1]).0];
    let mut out = Chords { polygon: Polygon::default(), deviation: 0.0 };
    if let Some((ends, label)) = &chain.line {
        // The end of a winding line is its beginning a period on.
        let n = if chain.winding == [0, 0] { ends.len() } else { ends.len() - 1 };
        out.polygon.points = ends[..n].iter().map(|&q| forward(q)).collect();
        out.polygon.edge = (*label..).take(n).map(Side::added).collect();
        return Ok(out);
    }
    let periods = support.periods();
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::with_capacity(chain.pcurves.len());
    let mut places: Vec<Vec<f64>> = Vec::with_capacity(chain.pcurves.len());
    for s in &chain.pcurves {
        let (points, at) = (vec![forward(s.qs[0])], vec![s.ts[0]]);
        let mut w = Walk { support, pcurve: s, map, periods, tolerance, points, at, deviation: 0.0, vain: 0 };
        w.over(0, s.ts.len() - 1)?;
        out.deviation = w.deviation.max(out.deviation);
        pieces.push(w.points);
        places.push(s.places(&w.at));
    }
    // Weld the ends.
    let n = pieces.len();
    let whole: [f64; 2] = [0, 1].map(|k| periods[k].unwrap_or(0.0) * f64::from(chain.winding[k]));
    for i in 0..n {
        let s = &chain.pcurves[i];
        let j = (i + 1) % n;
        let lift = if j == 0 { whole } else { [0.0; 2] };
        let (Some(&a), Some(&b)) = (pieces[i].last(), pieces[j].first()) else { continue };
        let b = [b[0] + lift[0], b[1] + lift[1]];
        let gap = distance(support, s.end(), a, b, map);
        // Beside a point in which parameter lines meet a long step is a short gap: the chord that ends there must not be turned by it.
        let beside = [pieces[i].iter().nth_back(1), pieces[j].get(1)];
        let turned =
            beside.into_iter().flatten().map(|p| distance(support, natural(*p), a, b, map)).fold(0.0, f64::max);
        let straight = welds == Welds::All || turned <= tolerance.max(TURNED * gap);
        if s.joint.is_none() && gap <= WELD_SHARE * size && straight {
            let m = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            if let Some(last) = pieces[i].last_mut() {
                *last = m;
            }
            if let Some(first) = pieces[j].first_mut() {
                *first = [m[0] - lift[0], m[1] - lift[1]];
            }
        }
    }
    for (i, points) in pieces.iter().enumerate() {
        let s = &chain.pcurves[i];
        let j = (i + 1) % n;
        let lift = if j == 0 { whole } else { [0.0; 2] };
        let Some((last, body)) = points.split_last() else { continue };
        out.polygon.points.extend_from_slice(body);
        let along = places[i].windows(2).map(|w| Side { label: s.label, from: w[0], to: w[1] });
        out.polygon.edge.extend(along.take(body.len()));
        let next = pieces[j][0];
        let welded = (0..2).all(|k| (last[k] - next[k] - lift[k]).abs() <= f64::EPSILON * (1.0 + last[k].abs()) * 4.0);
        if !welded {
            out.polygon.points.push(*last);
            if s.joint.is_none() {
                let gap = (s.arc.ends().1 - chain.pcurves[j].arc.ends().0).norm();
                out.deviation = out.deviation.max(gap);
            }
            // A gap that is closed by a chord belongs to the end of the edge before.
            let end = places[i].last().copied().unwrap_or(0.0);
            out.polygon.edge.push(s.joint.map_or(Side { label: s.label, from: end, to: end }, Side::added));
        }
    }
    if out.polygon.points.len() > MOST_CHORDS {
        return Err(TrimError::TooFine(MOST_CHORDS));
    }
    Ok(out)
}

/// Length in space of a short step between the spline parameters `a` and `b`, to first order at the natural `q`.
fn distance(support: &SupportSurface, q: [f64; 2], a: [f64; 2], b: [f64; 2], map: &[ParameterMap; 2]) -> f64 {
    let j = support.jet(q);
    (j.du * (map[0].inverse(a[0]).1 * (b[0] - a[0])) + j.dv * (map[1].inverse(a[1]).1 * (b[1] - a[1]))).norm()
}

/// The state of laying chords along one pcurve.
struct Walk<'a> {
    support: &'a SupportSurface,
    pcurve: &'a Pcurve,
    map: &'a [ParameterMap; 2],
    periods: [Option<f64>; 2],
    tolerance: f64,
    points: Vec<[f64; 2]>,
    /// Parameters of the curve at the points.
    at: Vec<f64>,
    deviation: f64,
    /// Intervals that halving did not bring within the tolerance.
    vain: usize,
}

impl Walk<'_> {
    fn forward(&self, q: [f64; 2]) -> [f64; 2] {
        [self.map[0].forward(q[0]), self.map[1].forward(q[1])]
    }

    /// Chords between samples `i` and `j`.
    fn over(&mut self, i: usize, j: usize) -> Result<(), TrimError> {
        let s = self.pcurve;
        if j == i + 1 {
            return self.between((s.ts[i], s.qs[i]), (s.ts[j], s.qs[j]), 0);
        }
        let (a, b) = (self.forward(s.qs[i]), self.forward(s.qs[j]));
        let mut worst = 0.0_f64;
        let mut seen = 0.0_f64;
        for k in i + 1..j {
            let (d, total) = self.deviation_of(s.ts[k], s.qs[k], a, b);
            worst = worst.max(d);
            seen = seen.max(total);
        }
        // Samples may all be near the ends, as beside knots that are near each other.
        if worst <= self.tolerance {
            let (d, total, _) = self.between_ends((s.ts[i], s.qs[i]), (s.ts[j], s.qs[j]));
            worst = d;
            seen = seen.max(total);
        }
        if worst <= self.tolerance {
            self.deviation = self.deviation.max(seen);
            self.points.push(b);
            self.at.push(s.ts[j]);
            return Ok(());
        }
        let m = (i + j) / 2;
        self.over(i, m)?;
        self.over(m, j)
    }

    /// Distances of a quarter, three quarters and half of the way between two samples from their chord: the greatest one of feet and of
    /// points of the curve; and parameter and foot half way.
    fn between_ends(&self, p: (f64, [f64; 2]), q: (f64, [f64; 2])) -> (f64, f64, (f64, [f64; 2])) {
        let (a, b) = (self.forward(p.1), self.forward(q.1));
        let mut worst = 0.0_f64;
        let mut seen = 0.0_f64;
        let mut middle = (0.0, [0.0; 2]);
        for k in [1.0, 3.0, 2.0] {
            let f = 0.25 * k;
            let t = p.0 + f * (q.0 - p.0);
            let guess = [0, 1].map(|k| p.1[k] + f * (q.1[k] - p.1[k]));
            let foot = self.foot(t, guess);
            let (d, total) = self.deviation_of(t, foot, a, b);
            worst = worst.max(d);
            seen = seen.max(total);
            middle = (t, foot);
        }
        (worst, seen, middle)
    }

    /// Chords between two samples, halving where needed.
    fn between(&mut self, p: (f64, [f64; 2]), q: (f64, [f64; 2]), depth: u32) -> Result<(), TrimError> {
        let b = self.forward(q.1);
        let (worst, seen, middle) = self.between_ends(p, q);
        let deepest = if self.vain > VAIN { DEEPEST_IN_VAIN } else { DEEPEST };
        if worst <= self.tolerance || depth >= deepest {
            self.vain += usize::from(worst > self.tolerance);
            self.deviation = self.deviation.max(seen);
            self.points.push(b);
            self.at.push(q.0);
            if self.points.len() > MOST_CHORDS {
                return Err(TrimError::TooFine(MOST_CHORDS));
            }
            return Ok(());
        }
        self.between(p, middle, depth + 1)?;
        self.between(middle, q, depth + 1)
    }

    /// The foot of the curve's point at a parameter, near a guess.
    fn foot(&self, t: f64, guess: [f64; 2]) -> [f64; 2] {
        match &self.pcurve.trace {
            Some(trace) => {
                let q = trace.at(t);
                [0, 1].map(|k| lifted(q[k], guess[k], self.periods[k]))
            }
            None => foot_near(self.support, &self.pcurve.arc.curve.point(t), Some(guess), &self.periods),
        }
    }

    /// Distance in space from the foot `q` to the chord's image, and from it to the curve's own point, to first order at the foot,
    /// which need not be quite below that point: beside a seam searches end.
    fn deviation_of(&self, t: f64, q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> (f64, f64) {
        let j = self.support.jet(q);
        let m = self.forward(q);
        let (du, dv) = (j.du * self.map[0].inverse(m[0]).1, j.dv * self.map[1].inverse(m[1]).1);
        let chord = du * (b[0] - a[0]) + dv * (b[1] - a[1]);
        let along = chord.norm_squared();
        let away = |way: Vec3| {
            let s = if along > 0.0 { (way.dot(&chord) / along).clamp(0.0, 1.0) } else { 0.0 };
            (way - chord * s).norm()
        };
        let offset = du * (m[0] - a[0]) + dv * (m[1] - a[1]);
        (away(offset), away(offset + self.pcurve.arc.curve.point(t) - j.p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SplineSupport;
    use crate::geom::Frame;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use std::f64::consts::FRAC_PI_4;

    /// What a search beside a seam leaves along the chord is no distance of the curve from it.
    #[test]
    fn a_foot_beside_its_point_is_no_distance() {
        let support = SupportSurface::Plane(Frame::world());
        let line = SpaceCurve::Line { origin: Vec3::zeros(), direction: Vec3::x() };
        let arc = Arc { curve: line, from: 0.0, to: 10.0 };
        let ground = Ground::new(&support, 10.0, 0.0);
        let pcurve = follow(&ground, &arc, None, (1, 0)).expect("near the surface").expect("a curve");
        let map = [ParameterMap::Same, ParameterMap::Same];
        let (points, at) = (Vec::new(), Vec::new());
        let (support, pcurve, map) = (&support, &pcurve, &map);
        let walk =
            Walk { support, pcurve, map, periods: [None; 2], tolerance: 1.0, points, at, deviation: 0.0, vain: 0 };
        let total = |height: f64| walk.deviation_of(5.0, [3.75, height], [0.0, height], [10.0, height]).1;
        assert!(total(0.0) < 1e-12 && (total(2.0) - 2.0).abs() < 1e-12, "{} {}", total(0.0), total(2.0));
    }

    /// A circle with a knot close behind another one: the samples on a chord may be at its ends.
    #[test]
    fn chords_are_looked_at_between_samples_too() {
        let support = SupportSurface::Plane(Frame::world());
        let circle = SpaceCurve::Ellipse { frame: Frame::world(), a: 10.0, b: 10.0 };
        let (spline, _) = circle.to_spline(0.0, 1.0).expect("an arc");
        let more: Vec<f64> = (1..40).flat_map(|k| [f64::from(k) / 40.0, f64::from(k) / 40.0 + 1e-7]).collect();
        let spline = spline.with_knots(&more).expect("knots");
        let arc = Arc { curve: SpaceCurve::Spline(spline), from: 0.0, to: 1.0 };
        let ground = Ground::new(&support, 10.0, 0.0);
        let pcurve = follow(&ground, &arc, None, (1, 0)).expect("near the surface").expect("a curve");
        let chain = TracedLoop { pcurves: vec![pcurve], line: None, winding: [0, 0], edges: Vec::new() };
        let map = [ParameterMap::Same, ParameterMap::Same];
        for tolerance in [1e-3, 2e-4, 5e-5, 1e-5] {
            let points =
                chords(&support, &chain, &map, (10.0, tolerance), Welds::Straight).expect("chords").polygon.points;
            let middle = |w: &[[f64; 2]]| 0.5 * (w[0][0] + w[1][0]).hypot(w[0][1] + w[1][1]);
            // Not the chord that closes the polygon.
            let rise = points.windows(2).map(|w| 10.0 - middle(w)).fold(0.0, f64::max);
            assert!(rise <= tolerance, "{rise} {tolerance}");
        }
    }

    /// A cylinder with one control point far away: feet on it scatter by more than chords may be off.
    #[test]
    fn curves_whose_feet_scatter_cost_little() {
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..9 {
            let (sin, cos) = (FRAC_PI_4 * f64::from(i)).sin_cos();
            let w = if i % 2 == 1 { FRAC_PI_4.cos() } else { 1.0 };
            let top = if i == 1 { 6e7 } else { 6.0 };
            points.extend([-1.0, top].map(|z| Vec3::new(2.0 / w * cos, 2.0 / w * sin, z)));
            weights.extend([w, w]);
        }
        let ku = Knots::new(2, vec![0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.], 9).expect("knots");
        let kv = Knots::clamped(1, &[0., 1.]).expect("knots");
        let support =
            SupportSurface::Spline(SplineSupport::new(Surface::new(ku, kv, &points, Some(&weights)).expect("surface")));
        let size = 1e-6 * support.size();
        let ground = Ground::new(&support, size, 0.0);
        let frame = Frame { origin: Vec3::new(0.0, 0.0, 3.0), ..Frame::world() };
        let arc = Arc { curve: SpaceCurve::Ellipse { frame, a: 2.0, b: 2.0 }, from: -0.7, to: 0.7 };
        let pcurve = follow(&ground, &arc, None, (1, 0)).expect("near the surface").expect("a curve");
        let chain = TracedLoop { pcurves: vec![pcurve], line: None, winding: [0, 0], edges: Vec::new() };
        let same = [ParameterMap::Same, ParameterMap::Same];
        let found =
            chords(&support, &chain, &same, (size, 1e-5 * size), Welds::Straight).expect("chords").polygon.points.len();
        assert!(found > VAIN, "the feet do not scatter: {found} chords");
        assert!(found < 16 * VAIN, "{found} chords");
    }
}
