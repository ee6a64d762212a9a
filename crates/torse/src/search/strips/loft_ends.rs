//! What becomes of the ends of rails: trimmed, joined by fans, or extended; and how much of each rail is used.
//!
//! *Method* of extensions: the tangent at the end, or the osculating circle there \[W15, 1.2\]. A straight extension
//! lies in one plane through any ruling, so that nothing but a triangle leads along it; a bent one has rulings of its
//! own.

use crate::brep::space_curve::SpaceCurve;
use crate::design::loft::branches::Branch;
use crate::design::loft::build::BuiltStrip;
use crate::design::loft::orientation::WHOLE;
use crate::design::loft::track::Track;
use crate::geom::Frame;
use crate::spline::curve::Curve;
use crate::torse::rail::{jet, tangent, Rail};

/// What becomes of rails that the developable does not use from end to end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// They are trimmed: the strip ends where one rail ends.
    #[default]
    Trim,
    /// The rest of a rail is joined to the other's end by a cone.
    Fan,
    /// Rails are extended beyond their ends until both are used from end to end, as far as tangent planes lead.
    Extend,
}

/// How rails go on beyond their ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extension {
    /// Along the circle that osculates the end.
    #[default]
    Curve,
    /// Along the end tangent.
    Line,
}

/// What people should know of the ends of a strip between two rails. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum EndNote {
    /// Both rails have a rest at one end: the cones over them meet in a crease.
    BothRest {
        /// Whether that is the end, not the start.
        at_end: bool,
    },
    /// A rail is extended.
    Extended {
        /// Its name.
        rail: String,
        /// By how much before its start.
        before: f64,
        /// By how much behind its end.
        behind: f64,
    },
    /// A rail is not used from end to end.
    Used {
        /// Its name.
        rail: String,
        /// Length at which the strip begins.
        from: f64,
        /// Length at which it ends.
        to: f64,
        /// Length of the rail.
        total: f64,
        /// Why it ends there, or what would lead on.
        leads: Leads,
    },
}

/// Why a strip ends before its rail does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leads {
    /// The extension of the other rail ends before.
    ExtensionEnds,
    /// No common tangent planes lead on.
    NoPlanes,
    /// The other rail ends, which could be extended or joined by a fan.
    OtherRail,
}

/// What rounding leaves of a piece, in its parameter: no cone of its own, as a fan of nanometres bends about nothing, and no step.
const REST: f64 = 1e-7;
/// Extension of rails beyond each end, as a share of their length.
const EXTENSION: f64 = 0.5;
/// Turn (rad) of an extension at most: beyond a quarter a circle leads back.
const TURN: f64 = 1.2;
/// Turn (rad) of a whole extension below which it is straight.
const STRAIGHT: f64 = 1e-6;

/// The rail with a piece beyond both ends; closed rails stay as they are.
pub(crate) fn extended(rail: &Rail, how: Extension) -> Rail {
    if rail.closed {
        return rail.clone();
    }
    let l = EXTENSION * rail.length();
    let (first, last) = (&rail.pieces[0], &rail.pieces[rail.pieces.len() - 1]);
    let before = beyond(first, 0.0, l, how).reversed();
    let mut pieces = vec![before];
    pieces.extend(rail.pieces.iter().cloned());
    pieces.push(beyond(last, 1.0, l, how));
    Rail { name: rail.name.clone(), pieces, closed: false }
}

/// The continuation by the length `l` of a curve on [0, 1] beyond its end `t`, away from it; on [0, 1].
fn beyond(c: &Curve<4>, t: f64, l: f64, how: Extension) -> Curve<4> {
    let [p, d, s] = jet(c, t);
    let outward = tangent(c, t) * if t > 0.5 { 1.0 } else { -1.0 };
    let bend = (s - outward * s.dot(&outward)) / d.norm_squared();
    let turn = bend.norm() * l;
    if how == Extension::Curve && turn > STRAIGHT && turn.is_finite() {
        let radius = 1.0 / bend.norm();
        let towards = bend.normalize();
        // The circle begins opposite its centre.
        let frame = Frame { origin: p + towards * radius, x: -towards, y: outward, z: (-towards).cross(&outward) };
        let arc = SpaceCurve::Ellipse { frame, a: radius, b: radius }.to_spline(0.0, turn.min(TURN));
        if let Some(piece) = arc.ok().and_then(|(arc, _)| Rail::new("", &[arc]).ok()).and_then(|r| r.as_one().ok()?) {
            return piece;
        }
    }
    let q = p + outward * l;
    let control = [p, q].map(|x| [x.x, x.y, x.z, 1.0]).to_vec();
    let knots = crate::spline::knots::Knots::uniform(1, 1, 0.0, 1.0);
    knots.map_or_else(|_| c.clone(), |knots| Curve { knots, control })
}

/// Drops steps at both ends in which no rail proper is followed: an extension alone leads nowhere. `open` tells which
/// rails have extensions as first and last segment, and their last parameter.
fn without_idle_ends(stations: &mut Vec<[f64; 2]>, open: [(bool, f64); 2]) {
    let idle = |p: &[f64; 2], q: &[f64; 2]| {
        (0..2).all(|d| {
            let (extends, end) = open[d];
            let inside = |x: f64| if extends { x.clamp(1.0, end - 1.0) } else { x };
            inside(q[d]) - inside(p[d]) <= REST
        })
    };
    let first = stations.windows(2).position(|w| !idle(&w[0], &w[1]));
    let last = stations.windows(2).rposition(|w| !idle(&w[0], &w[1]));
    if let (Some(first), Some(last)) = (first, last) {
        *stations = stations[first..=last + 1].to_vec();
    }
}

/// The run with what `ends` asks for.
pub(crate) fn with_ends(a: &Rail, b: &Rail, branch: &Branch, ends: Ends, notes: &mut Vec<EndNote>) -> Branch {
    let mut out = branch.clone();
    let (ta, tb) = (Track::new(a).end(), Track::new(b).end());
    match ends {
        Ends::Fan if !branch.closed => {
            // One rail rests at its end while the other is used up.
            let (first, last) = (out.stations[0], out.stations[out.stations.len() - 1]);
            // Cones over the rests of both rails have different tangent planes where they meet.
            if first[0] > REST && first[1] > REST && !a.closed && !b.closed {
                notes.push(EndNote::BothRest { at_end: false });
            }
            if last[0] < ta - REST && last[1] < tb - REST && !a.closed && !b.closed {
                notes.push(EndNote::BothRest { at_end: true });
            }
            for start in corner_stations(first[0], 0.0, false).into_iter().filter(|_| !a.closed) {
                out.stations.insert(0, [start, out.stations[0][1]]);
            }
            for start in corner_stations(first[1], 0.0, false).into_iter().filter(|_| !b.closed) {
                out.stations.insert(0, [out.stations[0][0], start]);
            }
            for end in corner_stations(last[0], ta, true).into_iter().filter(|_| !a.closed) {
                out.stations.push([end, out.stations[out.stations.len() - 1][1]]);
            }
            for end in corner_stations(last[1], tb, true).into_iter().filter(|_| !b.closed) {
                out.stations.push([out.stations[out.stations.len() - 1][0], end]);
            }
        }
        Ends::Extend if !branch.closed => {
            // From where either rail proper begins to where the last of them ends. Extensions are the first and last
            // segments.
            let begun = |s: &[f64; 2]| (!a.closed && s[0] >= 1.0) || (!b.closed && s[1] >= 1.0);
            let over = |s: &[f64; 2]| (a.closed || s[0] >= ta - 1.0) && (b.closed || s[1] >= tb - 1.0);
            let n = out.stations.len();
            let first = out.stations.iter().position(begun).unwrap_or(0);
            let last = out.stations.iter().position(over).unwrap_or(n - 1);
            if first < last {
                out.stations = out.stations[first..=last].to_vec();
            }
            without_idle_ends(&mut out.stations, [(!a.closed, ta), (!b.closed, tb)]);
        }
        _ => {}
    }
    out
}

/// Stations from `from` to `to`, ends of segments included, `from` not.
fn corner_stations(from: f64, to: f64, upwards: bool) -> Vec<f64> {
    let mut out = Vec::new();
    let mut x = from;
    while if upwards { x < to - REST } else { x > to + REST } {
        x = if upwards { ((x + REST).floor() + 1.0).min(to) } else { ((x - REST).ceil() - 1.0).max(to) };
        out.push(x);
    }
    out
}

/// Lengths of a rail over a run: of the rail itself, and of its extensions before and behind. `extended` says whether the
/// first and last pieces are extensions.
pub(crate) fn lengths(rail: &Rail, from: f64, to: f64, extended: bool) -> ([f64; 2], [f64; 2]) {
    let track = Track::new(rail);
    let at = |x: f64| rail.length_to(track.rail_parameter(x));
    let n = rail.pieces.len() as f64;
    let (start, end) = if extended { (rail.length_to(1.0), rail.length_to(n - 1.0)) } else { (0.0, rail.length()) };
    let (x, y) = (at(from), at(to));
    ([x.clamp(start, end) - start, y.clamp(start, end) - start], [(start - x).max(0.0), (y - end).max(0.0)])
}

/// Shares of both rails themselves that a run uses.
pub(crate) fn shares(a: &Rail, b: &Rail, branch: &Branch, ends: Ends) -> [f64; 2] {
    if ends != Ends::Extend {
        return branch.coverage;
    }
    let (first, last) = (branch.stations[0], branch.stations[branch.stations.len() - 1]);
    [(0, a), (1, b)].map(|(d, rail): (usize, &Rail)| {
        if rail.closed {
            return branch.coverage[d];
        }
        let n = rail.pieces.len() as f64;
        let total = rail.length_to(n - 1.0) - rail.length_to(1.0);
        let ([x, y], _) = lengths(rail, first[d], last[d], true);
        (y - x) / total
    })
}

/// Says what is left over or added at the ends.
pub(crate) fn note_ends(a: &Rail, b: &Rail, branch: &Branch, ends: Ends, notes: &mut Vec<EndNote>) {
    if branch.closed {
        return;
    }
    let (first, last) = (branch.stations[0], branch.stations[branch.stations.len() - 1]);
    // Whether an extension was used up.
    let spent = [(0, a), (1, b)]
        .iter()
        .any(|(d, rail)| !rail.closed && (first[*d] <= REST || last[*d] >= Track::new(rail).end() - REST));
    for (d, rail) in [(0, a), (1, b)] {
        if rail.closed {
            continue;
        }
        let extended = ends == Ends::Extend;
        let ([from, to], [before, behind]) = lengths(rail, first[d], last[d], extended);
        let n = rail.pieces.len() as f64;
        let total = if extended { rail.length_to(n - 1.0) - rail.length_to(1.0) } else { rail.length() };
        if before > WHOLE * total || behind > WHOLE * total {
            notes.push(EndNote::Extended { rail: rail.name.clone(), before, behind });
        }
        if from > WHOLE * total || total - to > WHOLE * total {
            let leads = match (extended, spent) {
                (true, true) => Leads::ExtensionEnds,
                (true, false) => Leads::NoPlanes,
                (false, _) => Leads::OtherRail,
            };
            notes.push(EndNote::Used { rail: rail.name.clone(), from, to, total, leads });
        }
    }
}

/// Share of a rail's own length that strips use on one side, each stretch once.
pub(crate) fn used(built: &[BuiltStrip], side: usize, rail: &Rail, extended: bool) -> f64 {
    let own = |k: usize| !extended || rail.closed || (k > 0 && k + 1 < rail.pieces.len());
    let total: f64 = (0..rail.pieces.len()).filter(|k| own(*k)).map(|k| rail.piece_length(k, 1.0)).sum();
    let part = |b: &BuiltStrip| {
        let r = &b.rails[side];
        let c = &r.parameter.control;
        let at = |h: &[f64; 1]| rail.piece_length(r.piece, h[0].clamp(0.0, 1.0));
        match (own(r.piece), c.first(), c.last()) {
            (true, Some(x), Some(y)) => (at(y) - at(x)).abs(),
            _ => 0.0,
        }
    };
    built.iter().map(part).sum::<f64>() / total.max(f64::MIN_POSITIVE)
}

/// Length (mm) of strips on one side that lies on what a rail was extended by.
pub(crate) fn past_ends(built: &[BuiltStrip], side: usize, rail: &Rail, extended: bool) -> f64 {
    if !extended || rail.closed {
        return 0.0;
    }
    let past = |b: &&BuiltStrip| b.rails[side].piece == 0 || b.rails[side].piece + 1 == rail.pieces.len();
    let part = |b: &BuiltStrip| {
        let r = &b.rails[side];
        let at = |h: Option<&[f64; 1]>| h.map_or(0.0, |h| rail.piece_length(r.piece, h[0].clamp(0.0, 1.0)));
        (at(r.parameter.control.last()) - at(r.parameter.control.first())).abs()
    };
    built.iter().filter(past).map(part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    fn arc(to: f64) -> Rail {
        let frame = Frame { origin: Vec3::new(5.0, 6.0, 7.0), ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a: 100.0, b: 100.0 }.to_spline(0.0, to).expect("spline");
        Rail::new("arc", &[c]).expect("rail")
    }

    #[test]
    fn an_arc_goes_on_as_its_circle_or_its_tangent() {
        let rail = arc(1.2);
        let bent = extended(&rail, Extension::Curve);
        assert!((bent.length() - 2.0 * rail.length()).abs() < 1e-6 && bent.pieces.len() == rail.pieces.len() + 2);
        for k in 0..=60 {
            let x = bent.point(f64::from(k) / 60.0 * bent.pieces.len() as f64) - Vec3::new(5.0, 6.0, 7.0);
            assert!((x.norm() - 100.0).abs() < 1e-9 && x.z.abs() < 1e-9);
        }
        let line = extended(&rail, Extension::Line);
        let end = line.point(line.pieces.len() as f64);
        let last = rail.point(rail.pieces.len() as f64);
        assert!((end - last).dot(&(last - Vec3::new(5.0, 6.0, 7.0))).abs() < 1e-6);
        for r in [&bent, &line] {
            for w in r.pieces.windows(2) {
                assert!((jet(&w[0], 1.0)[0] - jet(&w[1], 0.0)[0]).norm() < 1e-12);
                assert!(tangent(&w[0], 1.0).angle(&tangent(&w[1], 0.0)) < 1e-7);
            }
        }
    }

    #[test]
    fn idle_steps_at_the_ends_are_dropped() {
        let mut s = vec![[0.2, 1.0], [0.8, 1.0], [1.0, 1.0], [1.5, 1.6], [2.0, 2.0], [2.7, 2.0]];
        without_idle_ends(&mut s, [(true, 3.0), (true, 3.0)]);
        assert_eq!(s, [[1.0, 1.0], [1.5, 1.6], [2.0, 2.0]]);
    }
}
