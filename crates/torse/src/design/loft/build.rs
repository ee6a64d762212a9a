//! Strips along a run of rulings: fans and facets exactly, the rest as quintic splines whose error is watched.
//!
//! *Method* \[W15, 5.4\]. The run is cut where either rail comes to a corner or a new piece. Where one rail rests, the
//! strip is the exact cone (or plane) over the other's stretch. Where the parameters of both rails are related
//! linearly, it is exactly ruled between the given splines. Otherwise both parameters are functions of the mean of
//! their shares w; rulings are found by Newton's method, and rails fitted by quintic Hermite pieces (ends, end
//! derivatives, two points inside), halved until rails and twist are good enough. Pieces join with continuous
//! tangents; knots of the rails become breaks.

use super::branches::Branch;
use super::track::{Segment, Track};
use super::LoftError;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::SplineError;
use crate::torse::form::PanelKind;
use crate::torse::rail::{jet, Rail, RailPart};
use crate::torse::strip::Strip;

/// Knobs of [`follow`] and `strips_along_path`.
#[derive(Clone, Copy, Debug)]
pub struct BuildOptions {
    /// Distance that fitted rails may stray from the given ones at equal parameters, mm; no default.
    pub rail_tolerance: f64,
    /// Twist that fitted rulings may have, rad; default 1e-6.
    pub twist_tolerance: f64,
    /// Whether rulings are polished to exact coplanarity; default true. False for paths of least twist.
    pub exact: bool,
}

impl BuildOptions {
    /// Defaults with a rail tolerance (mm).
    pub fn new(rail_tolerance: f64) -> Self {
        Self { rail_tolerance, twist_tolerance: TWIST, exact: true }
    }
}

/// A strip with the parts of the rails that it was made from.
#[derive(Clone, Debug)]
pub struct BuiltStrip {
    /// The strip.
    pub strip: Strip,
    /// Its rails' parts of the given rails.
    pub rails: [RailPart; 2],
}

/// Parameter steps below which a rail rests.
const REST: f64 = 1e-9;
/// Steps of a resting rail (rounding of crossings), and of the other one, where a fan is meant.
const STILL: f64 = 1e-11;
/// See [`STILL`].
const MOVES: f64 = 1e-4;
/// Steps of a path of least twist in which a rail must rest to make a fan: fewer are the stairs of a slanted path.
const LONG: usize = 12;
/// Deviation from a linear relation of the parameters that is rounding.
const LINEAR: f64 = 1e-11;
/// Stations from which on their relation is that of all rulings: any two are related linearly.
const TELLING: usize = 5;
/// Distance from a knot, in parameters, that is rounding.
const KNOT: f64 = 1e-10;
/// Share of a run within which a knot counts as its end: a shorter span has no direction, for rulings at the end are
/// known to no more than this.
const AT_END: f64 = 1e-5;
/// Halvings of a span.
const DEEPEST: usize = 9;
/// Most spans of a strip: at so many, halving on would take longer than anybody waits.
const MOST_SPANS: usize = 800;
/// Samples per span where rails and twist are looked at.
const PROBES: usize = 8;
/// Angles and relative lengths below which a strip is called a plane, cylinder or cone.
const SAME_KIND: f64 = 1e-8;
/// Twist (rad) that fitted rulings may have: a micrometre over a metre, far below what any bend shows, far above
/// rounding.
const TWIST: f64 = 1e-6;
/// Share of both slopes of f below which their difference is rounding: the path runs along the zero line's own
/// tangent, and no step across it is known.
const ALONG: f64 = 1e-9;
/// Steps across a run, as a share of it, that vanish in the rounding of its parameters.
const LAST_DIGIT: f64 = 1e-16;
/// Breaks nearer than this share of a run are one: knots of both rails met at once, as well as bisection finds them.
const SAME_BREAK: f64 = 1e-7;

/// Strips along a branch, in order; the first rail is `v = 0`.
///
/// # Errors
/// Data that no spline can hold.
pub fn follow(
    rails: [&Rail; 2],
    branch: &Branch,
    options: &BuildOptions,
    control: &Control,
) -> Result<Vec<BuiltStrip>, LoftError> {
    strips_along_path(rails, &branch.stations, branch.closed, options, control)
}

/// Strips along any path of rulings, both parameters (of the tracks) not decreasing.
///
/// # Errors
/// As [`follow`].
pub(crate) fn strips_along_path(
    [a, b]: [&Rail; 2],
    stations: &[[f64; 2]],
    closed: bool,
    options: &BuildOptions,
    control: &Control,
) -> Result<Vec<BuiltStrip>, LoftError> {
    let (ta, tb) = (Track::new(a), Track::new(b));
    let mut out = Vec::new();
    for stretch in stretches(stations, closed, options.exact) {
        let (p, q) = (stretch[0], stretch[stretch.len() - 1]);
        // A rail that rests at its very end rests on its last segment.
        let base = [(0, &ta), (1, &tb)].map(|(d, track)| {
            let x = (0.5 * (p[d] + q[d])).floor();
            if track.rail.closed {
                x
            } else {
                x.clamp(0.0, track.end() - 1.0)
            }
        });
        let local: Vec<[f64; 2]> = stretch.iter().map(|s| [0, 1].map(|d| (s[d] - base[d]).clamp(0.0, 1.0))).collect();
        let (sa, sb) = (ta.locate(base[0] + 0.5).0, tb.locate(base[1] + 0.5).0);
        let built = match (sa, sb) {
            (Segment::Piece(i), Segment::Piece(j)) => between_pieces([a, b], [i, j], &local, options, control)?,
            (Segment::Piece(i), Segment::Corner { point, after, .. }) => {
                fan(a, i, [local[0][0], local[local.len() - 1][0]], point, after, 0)?
            }
            (Segment::Corner { point, after, .. }, Segment::Piece(j)) => {
                fan(b, j, [local[0][1], local[local.len() - 1][1]], point, after, 1)?
            }
            (Segment::Corner { .. }, Segment::Corner { .. }) => None,
        };
        out.extend(built);
    }
    for (k, s) in out.iter_mut().enumerate() {
        s.strip.name = format!("A-{:02}", k + 1);
    }
    Ok(out)
}

/// Cuts a path at the ends of segments; a closed path within one segment of each is cut in the middle.
fn stretches(stations: &[[f64; 2]], closed: bool, exact: bool) -> Vec<Vec<[f64; 2]>> {
    let resting = resting(stations, exact);
    let mut out: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut now: Vec<[f64; 2]> = Vec::new();
    let mut before = None;
    for (k, s) in stations.iter().enumerate() {
        let Some(&last) = now.last() else {
            now.push(*s);
            continue;
        };
        if s[0] - last[0] <= REST && s[1] - last[1] <= REST && k + 1 < stations.len() {
            continue;
        }
        // Where a rail comes to rest or starts again, a fan begins or ends.
        if now.len() > 1 && resting[k - 1] != before {
            out.push(std::mem::replace(&mut now, vec![last]));
        }
        before = resting[k - 1];
        // Ends of segments passed between two stations become stations.
        let mut cuts: Vec<f64> = Vec::new();
        for d in 0..2 {
            let step = s[d] - last[d];
            let mut x = last[d].floor() + 1.0;
            while step > 0.0 && x < s[d] - REST {
                if x > last[d] + REST {
                    cuts.push((x - last[d]) / step);
                }
                x += 1.0;
            }
        }
        cuts.sort_by(f64::total_cmp);
        for c in cuts {
            let m = [0, 1].map(|d| {
                let x = last[d] + (s[d] - last[d]) * c;
                if (x - x.round()).abs() < REST {
                    x.round()
                } else {
                    x
                }
            });
            now.push(m);
            out.push(std::mem::replace(&mut now, vec![m]));
        }
        now.push(*s);
        let whole = |x: f64| (x - x.round()).abs() < REST;
        let moved = |d: usize| s[d] - now[0][d] > REST;
        let ends = (whole(s[0]) && moved(0)) || (whole(s[1]) && moved(1));
        if ends && k + 1 < stations.len() {
            out.push(std::mem::replace(&mut now, vec![*s]));
        }
    }
    let moves = |s: &[[f64; 2]]| (0..2).any(|d| s[s.len() - 1][d] - s[0][d] > REST);
    if now.len() > 1 && moves(&now) {
        out.push(now);
    }
    if closed && out.len() == 1 && out[0].len() > 4 {
        let half = out[0].len() / 2;
        let second = out[0][half..].to_vec();
        out[0].truncate(half + 1);
        out.push(second);
    }
    out
}

/// For every step, the rail that rests while the other one moves. Paths of least twist move one rail at a time: there,
/// only long rests count.
fn resting(stations: &[[f64; 2]], exact: bool) -> Vec<Option<usize>> {
    let mut out: Vec<Option<usize>> = stations
        .windows(2)
        .map(|w| {
            let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            (0..2).find(|&k| d[k] <= STILL && d[1 - k] > MOVES)
        })
        .collect();
    if !exact {
        let mut k = 0;
        while k < out.len() {
            let end = (k..out.len()).find(|&i| out[i] != out[k]).unwrap_or(out.len());
            if end - k < LONG {
                out[k..end].fill(None);
            }
            k = end;
        }
    }
    out
}

/// The exact cone (or plane triangle) over a stretch of a piece.
fn fan(
    rail: &Rail,
    piece: usize,
    range: [f64; 2],
    apex: Vec3,
    apex_after: usize,
    side: usize,
) -> Result<Option<BuiltStrip>, LoftError> {
    let [t0, t1] = range.map(|t| at_knot(&rail.pieces[piece], t));
    if t1 - t0 <= REST {
        return Ok(None);
    }
    let base = rail.pieces[piece].restricted(t0, t1)?;
    let point = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[apex.x, apex.y, apex.z, 1.0]; 2])?;
    let strip = if side == 0 {
        Strip::between("", PanelKind::Cone, &base, &point)?
    } else {
        Strip::between("", PanelKind::Cone, &point, &base)?
    };
    let moving = RailPart { piece, parameter: linear(t0, t1)? };
    let resting = RailPart { piece: apex_after, parameter: linear(1.0, 1.0)? };
    let rails = if side == 0 { [moving, resting] } else { [resting, moving] };
    Ok(Some(BuiltStrip { strip: classified(strip), rails }))
}

/// The parameter, or the knot that it misses by rounding: a span of that width would have no direction.
fn at_knot(c: &Curve<4>, t: f64) -> f64 {
    c.knots.breaks().into_iter().find(|k| (k - t).abs() <= KNOT).unwrap_or(t)
}

fn linear(t0: f64, t1: f64) -> Result<Curve<1>, SplineError> {
    Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[t0], [t1]])
}

/// The strip between two smooth pieces. When the control says stop, spans stay as they are found.
pub(crate) fn between_pieces(
    [a, b]: [&Rail; 2],
    [i, j]: [usize; 2],
    stations: &[[f64; 2]],
    options: &BuildOptions,
    control: &Control,
) -> Result<Option<BuiltStrip>, LoftError> {
    let (ca, cb) = (&a.pieces[i], &b.pieces[j]);
    let stations: Vec<[f64; 2]> = stations.iter().map(|s| [at_knot(ca, s[0]), at_knot(cb, s[1])]).collect();
    let stations = &stations[..];
    let (p, q) = (stations[0], stations[stations.len() - 1]);
    let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
    if dx <= REST && dy <= REST {
        return Ok(None);
    }
    if dy <= REST {
        let mut built = fan(a, i, [p[0], q[0]], jet(cb, p[1])[0], j, 0)?;
        if let Some(s) = &mut built {
            s.rails[1].parameter = linear(p[1], p[1])?;
        }
        return Ok(built);
    }
    if dx <= REST {
        let mut built = fan(b, j, [p[1], q[1]], jet(ca, p[0])[0], i, 1)?;
        if let Some(s) = &mut built {
            s.rails[0].parameter = linear(p[0], p[0])?;
        }
        return Ok(built);
    }
    let off = stations.iter().map(|s| ((s[0] - p[0]) / dx - (s[1] - p[1]) / dy).abs()).fold(0.0, f64::max);
    if off <= LINEAR && (stations.len() >= TELLING || is_linear(ca, cb, stations, options.exact)) {
        let strip = Strip::between("", PanelKind::Torse, &ca.restricted(p[0], q[0])?, &cb.restricted(p[1], q[1])?)?;
        let rails = [
            RailPart { piece: i, parameter: linear(p[0], q[0])? },
            RailPart { piece: j, parameter: linear(p[1], q[1])? },
        ];
        return Ok(Some(BuiltStrip { strip: classified(strip), rails }));
    }
    let path = Path::new(ca, cb, stations, options.exact);
    let mut spans = Vec::new();
    for w in path.breaks(control).windows(2) {
        path.span(w[0], w[1], 0, (options, control), &mut spans);
    }
    let mut values = vec![0.0; 6];
    for s in spans.iter().skip(1) {
        values.extend([s.from; 4]);
    }
    values.extend([1.0; 6]);
    let count = spans.len();
    fn joined<const D: usize>(spans: &[Span], pick: impl Fn(&Span) -> [[f64; D]; 6]) -> Vec<[f64; D]> {
        let mut out = Vec::with_capacity(4 * spans.len() + 2);
        for (k, s) in spans.iter().enumerate() {
            let c = pick(s);
            if k == 0 {
                out.push(c[0]);
            }
            out.extend_from_slice(&c[1..5]);
            if k + 1 == spans.len() {
                out.push(c[5]);
            }
        }
        out
    }
    let knots = Knots::new(5, values, 4 * count + 2)?;
    let rail = |side: usize| Curve { knots: knots.clone(), control: joined(&spans, |s| s.rails[side]) };
    let strip = Strip::polynomial("", PanelKind::Torse, &rail(0), &rail(1))?;
    let part = |side: usize, piece: usize| RailPart {
        piece,
        parameter: Curve { knots: knots.clone(), control: joined(&spans, |s| s.parameters[side]) },
    };
    Ok(Some(BuiltStrip { strip: classified(strip), rails: [part(0, i), part(1, j)] }))
}

/// Whether rulings between few stations are where a linear relation has them.
fn is_linear(a: &Curve<4>, b: &Curve<4>, stations: &[[f64; 2]], exact: bool) -> bool {
    let path = Path::new(a, b, stations, exact);
    [0.25, 0.5, 0.75].into_iter().all(|w| {
        let share = |d: usize| (path.at(w).0[d] - path.from[d]) / path.extent[d];
        (share(0) - share(1)).abs() <= LINEAR
    })
}

/// A run between two smooth pieces as a function of w ∈ [0, 1].
struct Path<'a> {
    curves: [&'a Curve<4>; 2],
    from: [f64; 2],
    extent: [f64; 2],
    /// `w`, `d` of the stations: shares of both parameters are `w + d` and `w − d`.
    stations: Vec<[f64; 2]>,
    exact: bool,
}

/// A fitted span.
struct Span {
    from: f64,
    rails: [[[f64; 3]; 6]; 2],
    parameters: [[[f64; 1]; 6]; 2],
}

impl<'a> Path<'a> {
    fn new(a: &'a Curve<4>, b: &'a Curve<4>, stations: &[[f64; 2]], exact: bool) -> Self {
        let (p, q) = (stations[0], stations[stations.len() - 1]);
        let extent = [q[0] - p[0], q[1] - p[1]];
        let mut shares: Vec<[f64; 2]> = Vec::with_capacity(stations.len());
        for s in stations {
            let (x, y) = ((s[0] - p[0]) / extent[0], (s[1] - p[1]) / extent[1]);
            let (w, d) = (0.5 * (x + y), 0.5 * (x - y));
            if shares.last().is_none_or(|l| w > l[0]) {
                shares.push([w, d]);
            }
        }
        if !exact {
            shares = thinned(&shares);
        }
        Self { curves: [a, b], from: p, extent, stations: shares, exact }
    }

    /// Parameters of both pieces at `w`, and their derivatives.
    fn at(&self, w: f64) -> ([f64; 2], [f64; 2]) {
        let (mut d, slope) = self.guess(w);
        let parameters = |d: f64| [self.from[0] + self.extent[0] * (w + d), self.from[1] + self.extent[1] * (w - d)];
        let ends = w <= 0.0 || w >= 1.0;
        if !self.exact {
            return (parameters(d), [self.extent[0] * (1.0 + slope), self.extent[1] * (1.0 - slope)]);
        }
        let start = d;
        let mut rate = slope;
        for _ in 0..8 {
            let [x, y] = parameters(d);
            let (a, b) = (jet(self.curves[0], x), jet(self.curves[1], y));
            let r = b[0] - a[0];
            let f = a[1].cross(&b[1]).dot(&r);
            let (fx, fy) = (self.extent[0] * a[2].cross(&b[1]).dot(&r), self.extent[1] * a[1].cross(&b[2]).dot(&r));
            // f(x(w + d), y(w − d)) = 0.
            let (along, across) = (fx + fy, fx - fy);
            if across.abs() <= ALONG * (fx.abs() + fy.abs()) || !across.is_finite() {
                break;
            }
            rate = -along / across;
            if ends {
                break;
            }
            let step = -f / across;
            d += step;
            if step.abs() <= LAST_DIGIT {
                break;
            }
        }
        // A step that leaves the neighbourhood has found another branch.
        if (d - start).abs() > 0.05 || d.is_nan() {
            d = start;
        }
        // Both parameters grow along the run.
        let rate = if rate.is_finite() { rate.clamp(-1.0, 1.0) } else { slope };
        (parameters(d), [self.extent[0] * (1.0 + rate), self.extent[1] * (1.0 - rate)])
    }

    /// `d` and its slope by Hermite interpolation of the stations.
    fn guess(&self, w: f64) -> (f64, f64) {
        let s = &self.stations;
        let k = s.partition_point(|p| p[0] <= w).clamp(1, s.len() - 1);
        let (p, q) = (s[k - 1], s[k]);
        let h = q[0] - p[0];
        let secant = |i: usize| (s[i][1] - s[i - 1][1]) / (s[i][0] - s[i - 1][0]);
        let slope = |i: usize| match i {
            0 => secant(1),
            _ if i + 1 == s.len() => secant(i),
            _ => {
                let (l, r) = (s[i][0] - s[i - 1][0], s[i + 1][0] - s[i][0]);
                (secant(i) * r + secant(i + 1) * l) / (l + r)
            }
        };
        let (m0, m1) = (slope(k - 1).clamp(-1.0, 1.0) * h, slope(k).clamp(-1.0, 1.0) * h);
        let t = ((w - p[0]) / h).clamp(0.0, 1.0);
        let (t2, t3) = (t * t, t * t * t);
        let value = (2.0 * t3 - 3.0 * t2 + 1.0) * p[1]
            + (t3 - 2.0 * t2 + t) * m0
            + (3.0 * t2 - 2.0 * t3) * q[1]
            + (t3 - t2) * m1;
        let rate = (6.0 * t2 - 6.0 * t) * (p[1] - q[1]) + (3.0 * t2 - 4.0 * t + 1.0) * m0 + (3.0 * t2 - 2.0 * t) * m1;
        (value, rate / h)
    }

    /// Values of w where one of the rails has a knot, or an approximate path a station. A control that says stop leaves
    /// knots out.
    fn breaks(&self, control: &Control) -> Vec<f64> {
        let mut out = vec![0.0, 1.0];
        for d in 0..2 {
            let met = |t: &f64| {
                let share = (t - self.from[d]) / self.extent[d];
                if share <= AT_END || share >= 1.0 - AT_END || control.stopped() {
                    return None;
                }
                // Shares grow with w: bisection.
                let (mut lo, mut hi) = (0.0, 1.0);
                for _ in 0..60 {
                    let m = 0.5 * (lo + hi);
                    if self.at(m).0[d] < *t {
                        lo = m;
                    } else {
                        hi = m;
                    }
                }
                Some(0.5 * (lo + hi))
            };
            out.extend(
                parallel::map(self.curves[d].knots.breaks().iter(), met).into_iter().flatten().collect::<Vec<f64>>(),
            );
        }
        if !self.exact {
            out.extend(self.stations.iter().map(|s| s[0]));
        }
        out.sort_by(f64::total_cmp);
        out.dedup_by(|b, a| *b - *a <= SAME_BREAK);
        if let Some(last) = out.last_mut() {
            *last = 1.0;
        }
        out
    }

    /// Fits [w0, w1], in halves where it must, until the control says stop.
    fn span(&self, w0: f64, w1: f64, depth: usize, asked: (&BuildOptions, &Control), out: &mut Vec<Span>) {
        let (options, control) = asked;
        let h = w1 - w0;
        let sample = |w: f64| {
            let (s, ds) = self.at(w);
            let j = [0, 1].map(|d| jet(self.curves[d], s[d]));
            ([0, 1].map(|d| j[d][0]), [0, 1].map(|d| j[d][1] * ds[d]), s, ds)
        };
        let (first, last) = (sample(w0), sample(w1));
        let (third, two) = (sample(w0 + h / 3.0), sample(w0 + 2.0 * h / 3.0));
        let rails = [0, 1].map(|d| {
            hermite(
                [first.0[d], third.0[d], two.0[d], last.0[d]].map(Into::into),
                [first.1[d] * h, last.1[d] * h].map(Into::into),
            )
        });
        let parameters = [0, 1].map(|d| {
            hermite([[first.2[d]], [third.2[d]], [two.2[d]], [last.2[d]]], [[first.3[d] * h], [last.3[d] * h]])
        });
        let good = depth >= DEEPEST
            || control.stopped()
            || (1..PROBES).all(|k| {
                let t = k as f64 / PROBES as f64;
                let want = sample(w0 + h * t).0;
                let got = [0, 1].map(|d| quintic(&rails[d], t));
                let near = (0..2).all(|d| (got[d].0 - want[d]).norm() <= options.rail_tolerance);
                let r = got[1].0 - got[0].0;
                let (x, y) = (got[0].1.cross(&r), got[1].1.cross(&r));
                let twist = x.cross(&y).norm().atan2(x.dot(&y));
                near && (!self.exact || twist <= options.twist_tolerance)
            });
        if good || out.len() >= MOST_SPANS {
            out.push(Span { from: w0, rails, parameters });
            return;
        }
        let m = 0.5 * (w0 + w1);
        self.span(w0, m, depth + 1, asked, out);
        self.span(m, w1, depth + 1, asked, out);
    }
}

/// Every eighth station, averaged over its neighbours: paths of least twist advance in steps.
fn thinned(s: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const STEP: usize = 8;
    let n = s.len();
    if n < 3 * STEP {
        return vec![s[0], s[n - 1]];
    }
    let mut out = vec![s[0]];
    for k in (STEP..n - STEP).step_by(STEP) {
        let window = &s[k - STEP..=k + STEP];
        let sum = window.iter().fold([0.0; 2], |m, p| [m[0] + p[0], m[1] + p[1]]);
        out.push(sum.map(|x| x / window.len() as f64));
    }
    out.push(s[n - 1]);
    out
}

/// Bézier points of the quintic with values at 0, 1/3, 2/3, 1 and derivatives at the ends.
fn hermite<const D: usize>(values: [[f64; D]; 4], ends: [[f64; D]; 2]) -> [[f64; D]; 6] {
    let mut c = [[0.0; D]; 6];
    for d in 0..D {
        let (c0, c5) = (values[0][d], values[3][d]);
        let (c1, c4) = (c0 + ends[0][d] / 5.0, c5 - ends[1][d] / 5.0);
        // At 1/3: (32 c0 + 80 c1 + 80 c2 + 40 c3 + 10 c4 + c5) / 243; at 2/3 mirrored.
        let p = 243.0 * values[1][d] - 32.0 * c0 - 80.0 * c1 - 10.0 * c4 - c5;
        let q = 243.0 * values[2][d] - 32.0 * c5 - 80.0 * c4 - 10.0 * c1 - c0;
        // 80 c2 + 40 c3 = p, 40 c2 + 80 c3 = q.
        let c2 = (2.0 * p - q) / 120.0;
        let c3 = (2.0 * q - p) / 120.0;
        for (k, x) in [c0, c1, c2, c3, c4, c5].into_iter().enumerate() {
            c[k][d] = x;
        }
    }
    c
}

/// Point and derivative of a quintic Bézier curve.
fn quintic(c: &[[f64; 3]; 6], t: f64) -> (Vec3, Vec3) {
    let mut p = c.map(Vec3::from);
    for k in (1..6).rev() {
        if k == 1 {
            let d = (p[1] - p[0]) * 5.0;
            return (p[0] + (p[1] - p[0]) * t, d);
        }
        for i in 0..k {
            p[i] = p[i] + (p[i + 1] - p[i]) * t;
        }
    }
    (p[0], Vec3::zeros())
}

/// The strip with its kind, told from its rulings and normals at samples.
pub(crate) fn classified(mut strip: Strip) -> Strip {
    const STATIONS: usize = 12;
    let (u0, u1) = strip.domain();
    let at = |k: usize| u0 + (u1 - u0) * (k as f64 + 0.5) / STATIONS as f64;
    let rulings: Vec<[Vec3; 2]> = (0..STATIONS).map(|k| strip.ruling(at(k))).collect();
    let normals: Vec<Vec3> =
        (0..STATIONS).filter_map(|k| strip.patch.jet(at(k), 0.5).normal().try_normalize(0.0)).collect();
    let size = strip.patch.bbox().diagonal();
    let same = |v: &[Vec3]| v.windows(2).all(|w| w[0].cross(&w[1]).norm() <= SAME_KIND);
    let directions: Vec<Vec3> = rulings.iter().filter_map(|r| (r[1] - r[0]).try_normalize(0.0)).collect();
    let apex = || {
        let (p, q) = (rulings[0], rulings[STATIONS / 2]);
        let (d, e) = (directions.first()?, directions.get(STATIONS / 2)?);
        // Point of the first line nearest to the other.
        let c = d.dot(e);
        let w = q[0] - p[0];
        let s = (w.dot(d) - c * w.dot(e)) / (1.0 - c * c);
        Some(p[0] + d * s)
    };
    strip.kind = if same(&normals) {
        PanelKind::Plane
    } else if same(&directions) {
        PanelKind::Cylinder
    } else if apex().is_some_and(|x| {
        rulings
            .iter()
            .zip(&directions)
            .all(|(r, d)| (x - r[0]).cross(d).norm() <= SAME_KIND * size.max((x - r[0]).norm()))
    }) {
        PanelKind::Cone
    } else {
        PanelKind::Torse
    };
    strip
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::design::loft::branches::{branches, BranchOptions};
    use crate::geom::Frame;
    use std::f64::consts::TAU;

    fn ellipse(origin: Vec3, a: f64, b: f64) -> Rail {
        let frame = Frame { origin, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new("ellipse", &[c]).expect("rail")
    }

    fn built(a: &Rail, b: &Rail) -> Vec<BuiltStrip> {
        let found = branches(a, b, &BranchOptions::default());
        follow([a, b], &found[0], &BuildOptions::new(1e-6), &Control::default()).expect("strips")
    }

    #[test]
    fn two_circles_make_an_exact_cone() {
        let strips = built(&ellipse(Vec3::zeros(), 1.0, 1.0), &ellipse(Vec3::new(0.3, 0.0, 1.0), 0.5, 0.5));
        assert_eq!(strips.len(), 2);
        for s in &strips {
            assert_eq!(s.strip.kind, PanelKind::Cone);
            assert!(s.strip.patch.rational && s.strip.twist_bound().expect("bound") < 1e-12);
        }
    }

    #[test]
    fn square_to_round_is_four_facets_and_four_exact_cones() {
        let points = [(0.8, -0.8), (0.8, 0.8), (-0.8, 0.8), (-0.8, -0.8), (0.8, -0.8)];
        let square = Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 1.5))).expect("rail");
        let strips = built(&ellipse(Vec3::zeros(), 1.0, 1.0), &square);
        let area: f64 = strips.iter().map(|s| s.strip.area_estimate()).sum();
        assert!((area - 9.565_584_009_167_319).abs() < 1e-9, "{area}");
        assert!(strips.iter().all(|s| s.strip.is_point(0) || s.strip.is_point(1)));
        let facets: f64 =
            strips.iter().filter(|s| s.strip.kind == PanelKind::Plane).map(|s| s.strip.area_estimate()).sum();
        assert!((facets - 4.0 * 1.210_619_676_033_724_4).abs() < 1e-9);
    }

    #[test]
    fn a_fan_that_begins_beside_a_knot_has_no_span_of_that_width() {
        let circle = ellipse(Vec3::zeros(), 1.0, 1.0);
        for off in [-5e-16, 0.0, 5e-16, 1e-12] {
            let made = fan(&circle, 0, [0.25 + off, 0.75 - off], Vec3::z(), 0, 0).expect("fan").expect("fan");
            assert_eq!(made.strip.patch.knots_u.breaks().len(), 3, "{off:e}");
        }
    }

    #[test]
    fn circle_to_ellipse_is_fitted_to_the_twist_asked_for() {
        let strips = built(&ellipse(Vec3::zeros(), 1.0, 1.0), &ellipse(Vec3::z(), 1.5, 0.6));
        assert!(strips.len() >= 2);
        for s in &strips {
            let bound = s.strip.twist_bound().expect("bound");
            assert!(bound < 1e-5, "{bound}");
            for k in 0..=100 {
                assert!(s.strip.twist(f64::from(k) / 100.0) < 1.5e-6);
            }
        }
    }
}
