//! Loops on closed surfaces: brought together in the unwrapped plane, closed at poles, and cut along a seam
//! (a parameter line) where they wind around the surface.

use super::error::TrimError;
use super::pcurve::TracedLoop;
use super::polygon::{Polygon, Side};
use crate::brep::parameter_map::ParameterMap;
use crate::brep::support_surface::SupportSurface;
use crate::spline::knots::SAME_PARAMETER;

/// A seam to cut along: the line where the natural parameter `axis` is `at`, up to periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seam {
    /// 0: a line u = at, 1: a line v = at.
    pub axis: usize,
    /// Natural parameter.
    pub at: f64,
}

/// How the region is to be made from the chains.
pub(super) struct Plan {
    /// Seam to cut along, if any.
    pub seam: Option<Seam>,
    /// Whether clockwise polygons are holes whatever their place.
    pub sense_matters: bool,
}

/// Shifts the chains by periods to where they belong together and adds the closing lines at poles.
///
/// On a surface without border a loop bounds either side of it: its sense alone says which. `marked_outer` says that the
/// file's senses are not to be relied on and that one of the loops is the outer one.
pub(super) fn plan(
    support: &SupportSurface,
    chains: &mut Vec<TracedLoop>,
    marked_outer: bool,
    label: &mut u32,
) -> Result<Plan, TrimError> {
    let periods = support.periods();
    let sense_matters = support.is_nearly_closed() && !marked_outer;
    if chains.iter().all(|c| c.winding == [0, 0]) {
        let areas: Vec<f64> = chains.iter().map(|c| rough(c).area()).collect();
        let holes_only = sense_matters && areas.iter().all(|&a| a < 0.0);
        if holes_only && !support.is_closed() {
            return Err(TrimError::EitherSide);
        }
        if !holes_only {
            gather(chains, &areas, &periods);
            into_domain(support, chains, &periods);
            return Ok(Plan { seam: None, sense_matters });
        }
        if let [Some(p), Some(q)] = periods {
            return around_holes(support, chains, [p, q], label);
        }
    }
    let turns = |k: usize| chains.iter().any(|c| c.winding[k] != 0);
    let axis = match (turns(0), turns(1)) {
        (true, true) => return Err(TrimError::OpenWinding),
        (false, true) => 1,
        (true, false) => 0,
        // Holes in a whole surface between two poles.
        (false, false) => usize::from(periods[0].is_none()),
    };
    let period = periods[axis].ok_or(TrimError::OpenWinding)?;
    if chains.iter().any(|c| c.winding[axis].abs() > 1) {
        return Err(TrimError::OpenWinding);
    }
    close_at_poles(support, chains, axis, period, label)?;
    order_across(chains, (axis, period), periods[1 - axis])?;
    Ok(Plan { seam: Some(Seam { axis, at: quiet_line(support, chains, axis, period).0 }), sense_matters: true })
}

/// A whole torus (or doubly closed spline) with holes: cut along two quiet lines into a rectangle.
fn around_holes(
    support: &SupportSurface,
    chains: &mut Vec<TracedLoop>,
    periods: [f64; 2],
    label: &mut u32,
) -> Result<Plan, TrimError> {
    let mut start = [0.0; 2];
    for axis in 0..2 {
        let (at, crossings) = quiet_line(support, chains, axis, periods[axis]);
        if crossings > 0 {
            return Err(TrimError::OpenWinding);
        }
        start[axis] = at;
    }
    for c in chains.iter_mut() {
        let middle = [0, 1].map(|k| mean(c, k));
        c.shift([0, 1].map(|k| -((middle[k] - start[k]) / periods[k]).floor() * periods[k]));
    }
    let [u, v] = start;
    let [p, q] = periods;
    let corners = vec![[u, v], [u + p, v], [u + p, v + q], [u, v + q]];
    chains.push(TracedLoop { pcurves: Vec::new(), line: Some((corners, *label)), winding: [0, 0], edges: Vec::new() });
    *label += 4;
    Ok(Plan { seam: None, sense_matters: false })
}

/// The chain's samples as a polygon of natural parameters.
fn rough(c: &TracedLoop) -> Polygon {
    let points: Vec<[f64; 2]> = c.nodes().copied().collect();
    let edge = vec![Side::added(0); points.len()];
    Polygon { points, edge }
}

/// Shifts the smaller loops by periods into the largest.
fn gather(chains: &mut [TracedLoop], areas: &[f64], periods: &[Option<f64>; 2]) {
    let Some(largest) = (0..chains.len()).max_by(|&i, &j| areas[i].abs().total_cmp(&areas[j].abs())) else { return };
    let outer = rough(&chains[largest]);
    for i in (0..chains.len()).filter(|&i| i != largest) {
        let Some(&x) = chains[i].nodes().next() else { continue };
        let steps = |k: usize| -> Vec<f64> {
            periods[k].map_or(vec![0.0], |p| [0, 1, -1, 2, -2].map(|n| f64::from(n) * p).to_vec())
        };
        let found = steps(0)
            .into_iter()
            .flat_map(|a| steps(1).into_iter().map(move |b| [a, b]))
            .find(|d| outer.contains([x[0] + d[0], x[1] + d[1]]));
        if let Some(d) = found {
            chains[i].shift(d);
        }
    }
}

/// Shifts all chains by whole periods so that they begin in the domain of a spline.
fn into_domain(support: &SupportSurface, chains: &mut [TracedLoop], periods: &[Option<f64>; 2]) {
    let SupportSurface::Spline(s) = support else { return };
    let (u, v) = s.surface.domain();
    for (k, start) in [(0, u.0), (1, v.0)] {
        let Some(p) = periods[k] else { continue };
        let lo = chains.iter().flat_map(TracedLoop::nodes).map(|q| q[k]).fold(f64::INFINITY, f64::min);
        let d = -((lo - start) / p + SAME_PARAMETER).floor() * p;
        let mut by = [0.0; 2];
        by[k] = d;
        chains.iter_mut().for_each(|c| c.shift(by));
    }
}

/// Mean of the natural parameter `k` over a chain.
fn mean(c: &TracedLoop, k: usize) -> f64 {
    let (n, s) = c.nodes().fold((0.0, 0.0), |(n, s), q| (n + 1.0, s + q[k]));
    if n > 0.0 {
        s / n
    } else {
        0.0
    }
}

/// Adds lines at poles where windings do not sum to nothing.
fn close_at_poles(
    support: &SupportSurface,
    chains: &mut Vec<TracedLoop>,
    axis: usize,
    period: f64,
    label: &mut u32,
) -> Result<(), TrimError> {
    let across = 1 - axis;
    let sum: i32 = chains.iter().map(|c| c.winding[axis]).sum();
    let poles: Vec<f64> = support.poles().iter().filter(|p| p.axis == across).map(|p| p.value).collect();
    let mut wanted = Vec::new(); // (winding of the line, value)
    let winding: Vec<&TracedLoop> = chains.iter().filter(|c| c.winding[axis] != 0).collect();
    let reach =
        |f: fn(f64, f64) -> f64, start: f64| winding.iter().flat_map(|c| c.nodes()).map(|q| q[across]).fold(start, f);
    let (lo, hi) = (reach(f64::min, f64::INFINITY), reach(f64::max, f64::NEG_INFINITY));
    // For a seam in u, a line turning downward closes above; for one in v it closes on the side of low u.
    let closes_high = |turn: i32| (turn < 0) == (axis == 0);
    let mut need = |turn: i32| -> Result<(), TrimError> {
        let value = if closes_high(turn) {
            poles.iter().copied().filter(|&p| p >= hi).fold(f64::INFINITY, f64::min)
        } else {
            poles.iter().copied().filter(|&p| p <= lo).fold(f64::NEG_INFINITY, f64::max)
        };
        if value.is_finite() {
            wanted.push((turn, value));
            Ok(())
        } else {
            Err(TrimError::OpenWinding)
        }
    };
    match sum {
        0 if winding.is_empty() => {
            // A whole sphere, or another surface between two poles, with holes.
            let (Some(a), Some(b)) = (poles.iter().copied().reduce(f64::min), poles.iter().copied().reduce(f64::max))
            else {
                return Err(TrimError::OpenWinding);
            };
            let up = if axis == 0 { 1 } else { -1 };
            wanted.extend([(up, a), (-up, b)]);
        }
        0 => {}
        1 | -1 => need(-sum)?,
        _ => return Err(TrimError::OpenWinding),
    }
    for (turn, value) in wanted {
        let mut ends = [[value; 2]; 2];
        ends[0][axis] = 0.0;
        ends[1][axis] = f64::from(turn) * period;
        let mut winding = [0; 2];
        winding[axis] = turn;
        chains.push(TracedLoop {
            pcurves: Vec::new(),
            line: Some((ends.to_vec(), *label)),
            winding,
            edges: Vec::new(),
        });
        *label += 1;
    }
    Ok(())
}

/// Checks that one winding loop is on the material side of the other; on doubly closed surfaces shifts it there, and
/// the holes in between.
fn order_across(
    chains: &mut [TracedLoop],
    (axis, period): (usize, f64),
    period_across: Option<f64>,
) -> Result<(), TrimError> {
    let across = 1 - axis;
    let sign = if axis == 0 { 1 } else { -1 };
    let find = |turn: i32| {
        let hits: Vec<usize> = (0..chains.len()).filter(|&i| chains[i].winding[axis] == turn).collect();
        (hits.len() == 1).then(|| hits[0])
    };
    let (Some(low), Some(high)) = (find(sign), find(-sign)) else {
        return if period_across.is_some() { Err(TrimError::OpenWinding) } else { Ok(()) };
    };
    let ([a, coarse_a], [b, coarse_b]) = (level(&chains[low], axis, period), level(&chains[high], axis, period));
    let doubt = DOUBT * ((a - coarse_a).abs() + (b - coarse_b).abs());
    let Some(p) = period_across else {
        return if a < b + doubt { Ok(()) } else { Err(TrimError::OpenWinding) };
    };
    let mut by = [0.0; 2];
    let height = (b - a).rem_euclid(p);
    let height = if height < SAME_PARAMETER * p { p } else { height };
    // A thin band, or all but a thin one?
    if height < doubt || (height < p && height > p - doubt) {
        return Err(TrimError::EitherSide);
    }
    by[across] = a + height - b;
    chains[high].shift(by);
    let between = |q: [f64; 2]| above(&chains[low], axis, period, q) && !above(&chains[high], axis, period, q);
    let mut moves = Vec::new();
    for i in (0..chains.len()).filter(|&i| i != low && i != high) {
        let Some(&q) = chains[i].nodes().next() else { continue };
        let raised = |n: i32| {
            let mut x = q;
            x[across] += f64::from(n) * p;
            x
        };
        let near = ((a - q[across]) / p).round() as i32;
        if let Some(n) = (near - 2..=near + 3).find(|&n| between(raised(n))) {
            moves.push((i, f64::from(n) * p));
        }
    }
    for (i, way) in moves {
        by[across] = way;
        chains[i].shift(by);
    }
    Ok(())
}

/// What the means of a loop by all of its nodes and by every other one differ by, times this, is what they may be off.
const DOUBT: f64 = 2.0;

/// Mean of the parameter across a loop that winds around, over the parameter along: by all of its nodes, and by every other one.
fn level(c: &TracedLoop, axis: usize, period: f64) -> [f64; 2] {
    let whole = f64::from(c.winding[axis]) * period;
    let nodes: Vec<[f64; 2]> = c.nodes().copied().collect();
    let mean = |step: usize| {
        let mut taken: Vec<[f64; 2]> = nodes.iter().step_by(step).copied().collect();
        let Some(&first) = taken.first() else { return 0.0 };
        let mut end = first;
        end[axis] += whole;
        taken.push(end);
        let area = |w: &[[f64; 2]]| 0.5 * (w[0][1 - axis] + w[1][1 - axis]) * (w[1][axis] - w[0][axis]);
        taken.windows(2).map(area).sum::<f64>() / whole
    };
    [mean(1), mean(2)]
}

/// Whether a place lies above a loop that winds around once: a line straight down from it crosses the loop an odd number of times.
fn above(c: &TracedLoop, axis: usize, period: f64, q: [f64; 2]) -> bool {
    let across = 1 - axis;
    let mut nodes: Vec<[f64; 2]> = c.nodes().copied().collect();
    let Some(&first) = nodes.first() else { return false };
    let mut end = first;
    end[axis] += f64::from(c.winding[axis]) * period;
    nodes.push(end);
    let mut crossings = 0;
    for w in nodes.windows(2) {
        let (lo, hi) = (w[0][axis].min(w[1][axis]), w[0][axis].max(w[1][axis]));
        // All copies of the side that may lie below.
        let (from, to) = (((lo - q[axis]) / period).floor() as i32, ((hi - q[axis]) / period).ceil() as i32);
        for n in from..=to {
            let at = q[axis] + f64::from(n) * period;
            if (w[0][axis] <= at) != (w[1][axis] <= at) {
                let s = (at - w[0][axis]) / (w[1][axis] - w[0][axis]);
                crossings += usize::from(w[0][across] + s * (w[1][across] - w[0][across]) < q[across]);
            }
        }
    }
    crossings % 2 == 1
}

/// A parameter line that the chains cross least, and how often: the seam of the surface or the start of a loop if that
/// is no worse.
fn quiet_line(support: &SupportSurface, chains: &[TracedLoop], axis: usize, period: f64) -> (f64, usize) {
    let mut candidates = Vec::new();
    if let SupportSurface::Spline(s) = support {
        candidates.push(if axis == 0 { s.surface.domain().0 .0 } else { s.surface.domain().1 .0 });
    }
    candidates.extend(
        chains.iter().filter(|c| c.winding[axis] != 0).filter_map(|c| c.pcurves.first()).map(|s| s.qs[0][axis]),
    );
    let start = candidates.first().copied().unwrap_or(0.0);
    candidates.extend((0..60).map(|i| start + period * (f64::from(i) + 0.437) / 60.0));
    let crossings = |at: f64| -> usize {
        chains
            .iter()
            .map(|c| {
                let mut cells: Vec<f64> =
                    c.nodes().map(|q| ((q[axis] - at) / period + SAME_PARAMETER).floor()).collect();
                if let Some(&first) = cells.first() {
                    cells.push(first + f64::from(c.winding[axis]));
                }
                cells.windows(2).map(|w| (w[1] - w[0]).abs() as usize).sum::<usize>()
            })
            .sum()
    };
    let mut best = (usize::MAX, start);
    for at in candidates {
        let n = crossings(at);
        if n < best.0 {
            best = (n, at);
        }
    }
    (best.1, best.0)
}

/// A line of constant first parameter along which polygons are cut, with its copies a period apart; lines without copies cut
/// the plane in two.
#[derive(Clone, Copy, Debug)]
struct Cutter {
    at: f64,
    period: Option<f64>,
}

impl Cutter {
    /// A corner within rounding of a copy, on it; lines without copies move nothing.
    fn snapped(&self, x: [f64; 2]) -> [f64; 2] {
        let Some(period) = self.period else { return x };
        let line = self.at + ((x[0] - self.at) / period).round() * period;
        if (x[0] - line).abs() <= SAME_PARAMETER * period {
            [line, x[1]]
        } else {
            x
        }
    }

    /// Whether both sides may have a place: ways along a line without copies stay on the side that they come from.
    fn is_on(&self, x: [f64; 2]) -> bool {
        self.period.is_none() && x[0] == self.at
    }

    /// Number of the cell that begins at or before a place: 0 from the line on.
    fn cell(&self, x: [f64; 2]) -> f64 {
        let Some(period) = self.period else { return if x[0] >= self.at { 0.0 } else { -1.0 } };
        let k = ((x[0] - self.at) / period).round();
        // The same expression as above, so that snapped corners compare exactly.
        if x[0] >= self.at + k * period {
            k
        } else {
            k - 1.0
        }
    }

    /// Where cell `k` begins.
    fn begin(&self, k: f64) -> f64 {
        self.at + self.period.map_or(0.0, |p| k * p)
    }

    /// A place of cell `k` in the first copy.
    fn local(&self, x: [f64; 2], k: f64) -> [f64; 2] {
        [x[0] - self.period.map_or(0.0, |p| k * p), x[1]]
    }

    /// Where the first copy of a cell begins, or ends.
    fn border(&self, far: bool) -> f64 {
        self.at + if far { self.period.unwrap_or(0.0) } else { 0.0 }
    }
}

/// A stretch of a polygon between two crossings of the seam, shifted to the cell right of the seam.
struct Stretch {
    points: Vec<[f64; 2]>,
    edge: Vec<Side>,
    /// Whether it begins (ends) on the far side of the cell.
    far: [bool; 2],
}

/// Cuts polygons (in spline parameters) along the seam. Every answer lies between the seam and its next copy.
pub(super) fn cut_polygons(
    polygons: &[Polygon],
    chains: &[TracedLoop],
    seam: &Seam,
    map: &[ParameterMap; 2],
    periods: [Option<f64>; 2],
    label: &mut u32,
) -> Result<Vec<Polygon>, TrimError> {
    let period = periods[seam.axis].ok_or(TrimError::OpenWinding)?;
    let cutter = Cutter { at: map[seam.axis].forward(seam.at), period: Some(period) };
    let turns = chains.iter().map(|c| c.winding[seam.axis]);
    cut(&mut polygons.iter().zip(turns), cutter, seam.axis, label)
}

/// Cuts closed polygons (in spline parameters) in two along the line where the parameter `axis` is `at`. Nothing is moved.
pub(super) fn in_two(polygons: &[Polygon], axis: usize, at: f64, label: &mut u32) -> Result<Vec<Polygon>, TrimError> {
    cut(&mut polygons.iter().map(|p| (p, 0)), Cutter { at, period: None }, axis, label)
}

/// Polygons, and how often each winds around, cut. The sides along the cut have labels of their own.
fn cut(
    polygons: &mut dyn Iterator<Item = (&Polygon, i32)>,
    cutter: Cutter,
    axis: usize,
    label: &mut u32,
) -> Result<Vec<Polygon>, TrimError> {
    let labels = [*label, *label + 1];
    *label += 2;
    let mut whole = Vec::new();
    let mut stretches = Vec::new();
    for (p, turn) in polygons {
        let (p, turn) = upright(p, turn, axis);
        split(&p, turn, cutter, &mut stretches, &mut whole);
    }
    whole.extend(linked(stretches, labels)?);
    Ok(whole.into_iter().map(|p| upright(&p, 0, axis).0).collect())
}

/// Exchanges the axes for a seam in v, keeping the material on the left.
fn upright(p: &Polygon, turn: i32, axis: usize) -> (Polygon, i32) {
    if axis == 0 {
        return (p.clone(), turn);
    }
    let mut q = Polygon { points: p.points.iter().map(|x| [x[1], x[0]]).collect(), edge: p.edge.clone() };
    q.reverse();
    (q, -turn)
}

fn split(p: &Polygon, turn: i32, cutter: Cutter, stretches: &mut Vec<Stretch>, whole: &mut Vec<Polygon>) {
    let n = p.points.len();
    let Some(first) = (0..n).find(|&i| !cutter.is_on(p.points[i])) else { return };
    let corner = |i: usize| {
        let q = p.points[(first + i) % n];
        cutter.snapped(if first + i < n { q } else { [q[0] + f64::from(turn) * cutter.period.unwrap_or(0.0), q[1]] })
    };
    let mut done: Vec<Stretch> = Vec::new();
    let mut here = cutter.cell(corner(0));
    let mut open = Stretch { points: vec![cutter.local(corner(0), here)], edge: Vec::new(), far: [false; 2] };
    for i in 0..n {
        let (a, b) = (corner(i), corner(i + 1));
        let target = if cutter.is_on(b) { here } else { cutter.cell(b) };
        let mut side = p.edge[(first + i) % n];
        let mut done_share = 0.0;
        while (here - target).abs() > 0.5 {
            let up = target > here;
            let line = cutter.begin(if up { here + 1.0 } else { here });
            let s = if (b[0] - a[0]).abs() > 0.0 { ((line - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0) } else { 0.0 };
            let v = a[1] + s * (b[1] - a[1]);
            // The share of what is left of the side.
            let [before, after] = side.cut(if done_share < 1.0 { (s - done_share) / (1.0 - done_share) } else { 1.0 });
            (side, done_share) = (after, s);
            open.edge.push(before);
            open.points.push([cutter.border(up), v]);
            open.far[1] = up;
            done.push(std::mem::replace(
                &mut open,
                Stretch { points: vec![[cutter.border(!up), v]], edge: Vec::new(), far: [!up, false] },
            ));
            here += if up { 1.0 } else { -1.0 };
        }
        open.edge.push(side);
        open.points.push(cutter.local(b, here));
    }
    if done.is_empty() {
        open.points.pop();
        whole.push(Polygon { points: open.points, edge: open.edge });
        return;
    }
    // The last stretch runs on into the first.
    let head = &mut done[0];
    open.points.pop();
    open.points.append(&mut head.points);
    open.edge.append(&mut head.edge);
    head.points = open.points;
    head.edge = open.edge;
    head.far[0] = open.far[0];
    stretches.append(&mut done);
}

/// Joins stretches along the seam: upward on the far side, downward on the near side, so that the material stays left.
fn linked(mut stretches: Vec<Stretch>, labels: [u32; 2]) -> Result<Vec<Polygon>, TrimError> {
    let mut out = Vec::new();
    while let Some(first) = stretches.pop() {
        let far_first = first.far[0];
        let mut p = Polygon { points: first.points, edge: first.edge };
        let mut far = first.far[1];
        let start = p.points[0][1];
        loop {
            let end = p.points[p.points.len() - 1][1];
            let ahead = |v: f64| if far { v - end } else { end - v };
            let mut best: Option<(f64, Option<usize>)> = None;
            let mut offer = |gap: f64, which: Option<usize>| {
                if gap >= 0.0 && best.is_none_or(|b| gap < b.0) {
                    best = Some((gap, which));
                }
            };
            if far_first == far {
                offer(ahead(start), None);
            }
            for (k, s) in stretches.iter().enumerate().filter(|(_, s)| s.far[0] == far) {
                offer(ahead(s.points[0][1]), Some(k));
            }
            match best {
                None => return Err(TrimError::OpenWinding),
                Some((_, next)) => {
                    p.edge.push(Side::added(labels[usize::from(far)]));
                    match next {
                        None => break,
                        Some(k) => {
                            let s = stretches.swap_remove(k);
                            p.points.extend(s.points);
                            p.edge.extend(s.edge);
                            far = s.far[1];
                        }
                    }
                }
            }
        }
        out.push(p);
    }
    Ok(out)
}
