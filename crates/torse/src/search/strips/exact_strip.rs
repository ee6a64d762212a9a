//! Strips between rails as exactly developable surfaces: their tangent planes fitted by a spline of planes, cut along the
//! rails.
//!
//! *Method.* The tangent planes of a fitted strip, exact at its rails, are approximated by a cubic spline of planes
//! \[PW99, (9)\] that keeps the first and the last ruling with their planes. Its envelope is developable whatever the fit
//! is like; knots are doubled until the rails are near enough, and a proof decides.

use crate::certify::rails::{rail_bound, twist_bound};
use crate::control::Control;
use crate::design::loft::build::BuiltStrip;
use crate::design::loft::on_torse::between_rails;
use crate::fit::planes::frame::{frame_of_normals, STEEPEST};
use crate::fit::planes::linear_system::{planes, ruling_condition, slope_weight, PlaneDatum, PlanesOptions};
use crate::fit::planes::Freedom;
use crate::geom::measure::Measure;
use crate::geom::{Frame, Vec3};
use crate::spline::knots::Knots;
use crate::torse::dual::{graph_in, plane_through};
use crate::torse::rail::{jet, Rail, RailPart};
use crate::torse::strip::Strip;

/// Multiplicities of the knots at breaks of the fitted strip that are tried, with the most spans. The rails' own knots
/// are among the breaks: planes along cubic rails have no second derivative there, so that simple knots converge slowly;
/// but they give a patch with continuous derivatives.
const TRIALS: [(usize, usize); 2] = [(1, 160), (2, 640)];
/// Rounds of refinement.
const ROUNDS: usize = 8;
/// Order of the distance from the rails in the length of a span.
const ORDER: f64 = 0.25;
/// Parts into which a span is cut at once, at most.
const PARTS: usize = 4;
/// Distance, as a share of the strip, within which breaks are one.
const NEAR: f64 = 1e-6;
/// Tangent planes per span.
const PLANES: usize = 6;
/// Share of the tolerance that samples of the rails may stray: what is between samples needs the rest.
const SAMPLED: f64 = 0.7;
/// Fewest spans.
const FEWEST: usize = 3;
/// Stations where inflections are looked for.
const STATIONS: usize = 400;
/// Halvings towards an inflection: to the last digit.
const DIGITS: usize = 52;
/// Parts of a span at whose ends it is sampled.
const SAMPLES: usize = 6;
/// Halvings of a strip whose tangent planes turn too far for one frame.
const HALVINGS: usize = 3;
/// Sums of unit vectors shorter than this have no direction to be trusted: they point against each other.
const NO_MEAN: f64 = 1e-3;

/// An exactly developable piece, and how far it is proven to lie from the rails.
#[derive(Clone, Debug)]
pub(crate) struct ExactStrip {
    /// The strip with its stretches of the rails.
    pub built: BuiltStrip,
    /// Spans of the spline of planes.
    pub spans: usize,
    /// Proven distance from both rails, mm.
    pub off: f64,
}

/// Why there is no exactly developable strip, in words that follow "as an exact one,". Lengths in mm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExactError {
    /// The job was stopped before it was looked for.
    #[error("it was not looked for: the job was stopped early")]
    NotLookedFor,
    /// Rails that the strip was not made from.
    #[error("its rails do not belong to it")]
    Rails,
    /// A ruling without tangent plane.
    #[error("it has rulings without tangent plane")]
    NoPlane,
    /// Tangent planes that turn too far.
    #[error("its tangent planes turn too far")]
    PlanesTurn,
    /// Rulings that turn too far.
    #[error("its rulings turn too far")]
    RulingsTurn,
    /// The search was stopped; the nearest strip was so far from the rails.
    #[error("the search was stopped early, {0:.1e} mm from the rails")]
    Stopped(f64),
    /// The nearest strip is so far from the rails.
    #[error("it would stray {0:.1e} mm from the rails")]
    Strays(f64),
    /// A step that failed, in its own words.
    #[error("{0}")]
    Step(String),
}

impl ExactError {
    /// The reason of a step that failed.
    fn of(reason: impl std::error::Error) -> Self {
        Self::Step(reason.to_string())
    }
}

/// Exactly developable strips in place of a fitted one, end to end, within the tolerance (mm) of both rails (proven);
/// they begin and end on its first and last ruling.
///
/// *Guarantee*: developable by construction, up to rounding; no regression point between the rails (proven).
///
/// # Errors
/// Why there is none.
pub(crate) fn exact_strips(
    built: &BuiltStrip,
    rails: [&Rail; 2],
    tolerance: f64,
    control: &Control,
) -> Result<Vec<ExactStrip>, ExactError> {
    let (a, b) = built.strip.domain();
    let rulings = RailRulings::new(built, rails).ok_or(ExactError::Rails)?;
    let inflections = rulings.inflections(a, b);
    let mut ends = vec![(a, false)];
    ends.extend(inflections.into_iter().map(|u| (u, true)));
    ends.push((b, false));
    let mut out = Vec::new();
    for w in ends.windows(2) {
        let part = Part { from: w[0].0, to: w[1].0, still: [w[0].1, w[1].1] };
        out.extend(over(&rulings, &part, tolerance, 0, control)?);
    }
    Ok(out)
}

/// A part of a strip, and whether its tangent planes stand still at its ends: inflection rulings.
#[derive(Clone, Copy)]
struct Part {
    from: f64,
    to: f64,
    still: [bool; 2],
}

/// Over a part of the strip, in halves where planes turn too far.
fn over(
    rulings: &RailRulings,
    part: &Part,
    tolerance: f64,
    depth: usize,
    control: &Control,
) -> Result<Vec<ExactStrip>, ExactError> {
    let Part { from, to, still } = *part;
    let normals: Vec<Vec3> = (0..=4 * PLANES)
        .map(|k| rulings.at(cut(from, to, k, 4 * PLANES)).map(|c| c.normal))
        .collect::<Option<_>>()
        .ok_or(ExactError::NoPlane)?;
    let frame = frame_of_normals(&normals).ok().filter(|f| f.min_cosine > STEEPEST);
    let Some(frame) = frame else {
        if depth == HALVINGS {
            return Err(ExactError::PlanesTurn);
        }
        let middle = 0.5 * (from + to);
        let first = Part { from, to: middle, still: [still[0], false] };
        let second = Part { from: middle, to, still: [false, still[1]] };
        let mut out = over(rulings, &first, tolerance, depth + 1, control)?;
        out.extend(over(rulings, &second, tolerance, depth + 1, control)?);
        return Ok(out);
    };
    let mut why = ExactError::PlanesTurn;
    for (multiplicity, most) in TRIALS {
        match refined(rulings, &frame.frame, part, (multiplicity, most), tolerance, control) {
            Ok(one) => return Ok(vec![one]),
            Err(reason) => why = reason,
        }
    }
    Err(why)
}

/// Spans halved, or cut into more parts, where the rails are too far, until a strip is near enough.
fn refined(
    rulings: &RailRulings,
    frame: &Frame,
    part: &Part,
    (multiplicity, most): (usize, usize),
    tolerance: f64,
    control: &Control,
) -> Result<ExactStrip, ExactError> {
    // Knots of the planes on [0, 1], with their multiplicity.
    let Part { from, to, .. } = *part;
    let mut breaks = vec![(0.0, 4)];
    let inner = rulings.built.strip.patch.knots_u.breaks();
    let inside = inner.iter().map(|u| (u - from) / (to - from)).filter(|t| *t > NEAR && *t < 1.0 - NEAR);
    breaks.extend(inside.map(|t| (t, multiplicity)));
    // Knots of both rails that are met at once are one.
    breaks.dedup_by(|b, a| b.0 - a.0 < NEAR);
    breaks.push((1.0, 4));
    // Conditions at both ends need planes of their own.
    while breaks.len() <= FEWEST {
        let halves = breaks.windows(2).flat_map(|w| [w[0], (0.5 * (w[0].0 + w[1].0), 1)]).collect::<Vec<_>>();
        breaks = halves.into_iter().chain([(1.0, 4)]).collect();
    }
    let mut goal = SAMPLED * tolerance;
    let mut nearest = f64::INFINITY;
    for _ in 0..ROUNDS {
        if control.stopped() {
            return Err(ExactError::Stopped(nearest));
        }
        let (built, strays) = attempt(rulings, frame, part, &breaks)?;
        let stray = strays.iter().copied().fold(0.0, f64::max);
        nearest = nearest.min(stray);
        if stray <= goal {
            match proven(&built, rulings.rails, tolerance, control) {
                Some(off) => return Ok(ExactStrip { built, spans: breaks.len() - 1, off }),
                None => goal *= 0.5,
            }
        }
        let mut next = vec![breaks[0]];
        for (w, stray) in breaks.windows(2).zip(&strays) {
            let parts = if *stray > goal { ((stray / goal).powf(ORDER).ceil() as usize).clamp(2, PARTS) } else { 1 };
            next.extend((1..parts).map(|k| (cut(w[0].0, w[1].0, k, parts), 1)));
            next.push(w[1]);
        }
        if next.len() > most || next.len() == breaks.len() {
            break;
        }
        breaks = next;
    }
    Err(ExactError::Strays(nearest))
}

/// The k-th of n parts of an interval.
fn cut(a: f64, b: f64, k: usize, n: usize) -> f64 {
    a + (b - a) * k as f64 / n as f64
}

/// Proven distance from both rails, if strip and proof are good.
fn proven(built: &BuiltStrip, rails: [&Rail; 2], tolerance: f64, control: &Control) -> Option<f64> {
    let bound = |d: usize| rail_bound(&built.strip, d, rails[d], &built.rails[d], control);
    let off = bound(0).max(bound(1)).value();
    let shown = twist_bound(&built.strip, ROUNDING, control);
    (off <= tolerance && shown.is_regular() && shown.angle().value() <= ROUNDING).then_some(off)
}

/// The strip's rulings on the rails given.
struct RailRulings<'a> {
    built: &'a BuiltStrip,
    rails: [&'a Rail; 2],
}

/// A ruling on the rails, with the tangent plane of both.
struct RailRuling {
    ends: [Vec3; 2],
    normal: Vec3,
}

impl<'a> RailRulings<'a> {
    fn new(built: &'a BuiltStrip, rails: [&'a Rail; 2]) -> Option<Self> {
        (0..2).all(|d| rails[d].pieces.len() > built.rails[d].piece).then_some(Self { built, rails })
    }

    fn piece(&self, side: usize) -> &'a crate::spline::curve::Curve<4> {
        &self.rails[side].pieces[self.built.rails[side].piece]
    }

    fn parameters(&self, u: f64) -> [f64; 2] {
        [0, 1].map(|d: usize| self.built.rails[d].parameter.point(u)[0].clamp(0.0, 1.0))
    }

    /// Rulings where the tangent planes stand still and turn back: the curvature of the rails out of their planes changes
    /// its sign. Those at the ends do not count.
    fn inflections(&self, from: f64, to: f64) -> Vec<f64> {
        let bend = |u: f64| -> f64 {
            let s = self.parameters(u);
            let Some(c) = self.at(u) else { return 0.0 };
            // Normal curvatures of both rails; straight rails have none.
            (0..2)
                .map(|d| {
                    let j = jet(self.piece(d), s[d]);
                    j[2].dot(&c.normal) / j[1].norm_squared()
                })
                .sum()
        };
        let values: Vec<(f64, f64)> =
            (0..=STATIONS).map(|k| cut(from, to, k, STATIONS)).map(|u| (u, bend(u))).collect();
        let size = values.iter().map(|v| v.1.abs()).fold(0.0, f64::max);
        // A sign beside rounding is none.
        const FLAT: f64 = 1e-9;
        let mut out = Vec::new();
        let mut before: Option<(f64, f64)> = None;
        for v in values.into_iter().filter(|v| v.1.abs() > FLAT * size) {
            if let Some((mut a, sign)) = before.filter(|b| b.1 * v.1 < 0.0) {
                let mut b = v.0;
                for _ in 0..DIGITS {
                    let m = 0.5 * (a + b);
                    if bend(m) * sign > 0.0 {
                        a = m;
                    } else {
                        b = m;
                    }
                }
                out.push(0.5 * (a + b));
            }
            before = Some(v);
        }
        out
    }

    fn at(&self, u: f64) -> Option<RailRuling> {
        let s = self.parameters(u);
        let j = [0, 1].map(|d: usize| jet(self.piece(d), s[d]));
        let ruling = j[1][0] - j[0][0];
        let n = [0, 1].map(|d: usize| j[d][1].cross(&ruling).try_normalize(0.0));
        let normal = (n[0]? + n[1]?).try_normalize(NO_MEAN)?;
        Some(RailRuling { ends: j.map(|j| j[0]), normal })
    }
}

/// One choice of knots: the strip, and how far samples of every span stray from the rails.
fn attempt(
    rulings: &RailRulings,
    frame: &Frame,
    part: &Part,
    breaks: &[(f64, usize)],
) -> Result<(BuiltStrip, Vec<f64>), ExactError> {
    let Part { from, to, still } = *part;
    let values: Vec<f64> = breaks.iter().flat_map(|&(t, m)| std::iter::repeat_n(t, m)).collect();
    let knots = Knots::new(3, values.clone(), values.len() - 4).map_err(ExactError::of)?;
    let spans = breaks.windows(2).flat_map(|w| (0..PLANES).map(|k| cut(w[0].0, w[1].0, k, PLANES)));
    let at: Vec<f64> = spans.chain([1.0]).collect();
    let count = at.len() - 1;
    let all: Vec<RailRuling> =
        at.iter().map(|t| rulings.at(from + (to - from) * t)).collect::<Option<_>>().ok_or(ExactError::NoPlane)?;
    // A frame of the strip's own: planes at the origin would lose digits.
    let centre = all.iter().map(|c| (c.ends[0] + c.ends[1]) * 0.5).sum::<Vec3>() / all.len() as f64;
    let frame = Frame { origin: centre, ..*frame };
    let mut data = Vec::with_capacity(all.len());
    for (k, c) in all.iter().enumerate() {
        let plane = graph_in(&frame, &plane_through(&c.ends[0], &c.normal), k).map_err(ExactError::of)?;
        let plan = c.ends.map(|p| frame.to_local(&p));
        let middle = (plan[0] + plan[1]) * 0.5;
        let radius = 0.5 * (plan[1] - plan[0]).norm();
        let measure = Measure::disc([middle.x, middle.y], radius).map_err(ExactError::of)?;
        let weight = slope_weight(&plane) / measure.mass();
        data.push(PlaneDatum { plane, parameter: at[k], measure, weight });
    }
    let last = knots.control_count() - 1;
    let ruling = |k: usize| {
        let p = all[k].ends.map(|p| frame.to_local(&p));
        let d = (p[1] - p[0]).norm();
        [(p[0].x * p[1].y - p[1].x * p[0].y) / d, (p[0].y - p[1].y) / d, (p[1].x - p[0].x) / d]
    };
    // The planes of the end rulings, and the next control planes through them; where planes stand still, so do the first
    // two, and the third goes through the ruling.
    let mut conditions = Vec::new();
    for (datum, from_end, still) in [(0, false, still[0]), (count, true, still[1])] {
        let (plane, through) = (data[datum].plane, ruling_condition(data[datum].plane, ruling(datum)));
        let index = |k: usize| if from_end { last - k } else { k };
        conditions.push((index(0), Freedom::Fixed(plane)));
        if still {
            conditions.push((index(1), Freedom::Fixed(plane)));
        }
        conditions.push((index(if still { 2 } else { 1 }), through));
    }
    let options = PlanesOptions { conditions, ..PlanesOptions::default() };
    let torse = planes(&data, &knots, &options).map(|f| f.curve).map_err(ExactError::of)?;
    let direction: Vec3 = all.iter().map(|c| (c.ends[1] - c.ends[0]).normalize()).sum();
    let direction = direction.try_normalize(NO_MEAN).ok_or(ExactError::RulingsTurn)?;
    let pieces = [0, 1].map(|d| rulings.piece(d));
    let guess = |t: f64| rulings.parameters(from + (to - from) * t);
    let found = between_rails(&torse, pieces, guess, &frame, &direction, still).map_err(ExactError::of)?;
    let stray = |t: f64| {
        let off = [0, 1].map(|side: usize| {
            let h = found.boundaries[side].point(t);
            let p = Vec3::new(h[0], h[1], h[2]) / h[3];
            (p - jet(pieces[side], found.parameters[side].point(t)[0])[0]).norm()
        });
        off[0].max(off[1])
    };
    let strays = breaks
        .windows(2)
        .map(|w| (1..SAMPLES).map(|k| stray(cut(w[0].0, w[1].0, k, SAMPLES))).fold(0.0, f64::max))
        .collect();
    let old = &rulings.built.strip;
    let [a, b] = &found.boundaries;
    let strip = Strip::between(&old.name, old.kind, a, b).map_err(ExactError::of)?;
    let [x, y] = found.parameters;
    let [first, second] = [0, 1].map(|d: usize| rulings.built.rails[d].piece);
    let rails = [RailPart { piece: first, parameter: x }, RailPart { piece: second, parameter: y }];
    Ok((BuiltStrip { strip, rails }, strays))
}

/// Twist (rad) that is rounding of an exactly developable strip: intervals make much of it near the regression curve.
const ROUNDING: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::design::loft::branches::{branches, BranchOptions};
    use crate::design::loft::build::{between_pieces, follow, BuildOptions};
    use std::f64::consts::TAU;

    fn ellipse(z: f64, a: f64, b: f64) -> Rail {
        let frame = Frame { origin: Vec3::new(900.0, -300.0, z), ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new("ellipse", &[c]).expect("rail")
    }

    /// A circle and an ellipse: general developables with exact tangent planes known.
    fn fitted() -> ([Rail; 2], Vec<BuiltStrip>) {
        let (a, b) = (ellipse(0.0, 100.0, 100.0), ellipse(120.0, 150.0, 60.0));
        let found = branches(&a, &b, &BranchOptions::default());
        let strips = follow([&a, &b], &found[0], &BuildOptions::new(1e-5), &Control::default()).expect("strips");
        ([a, b], strips)
    }

    #[test]
    fn strips_are_developable_to_rounding_and_keep_their_end_rulings() {
        let ([a, b], strips) = fitted();
        for tolerance in [0.1, 1e-3, 1e-5] {
            for one in &strips {
                let parts = exact_strips(one, [&a, &b], tolerance, &Control::default()).expect("exact");
                for p in &parts {
                    assert!(p.off <= tolerance && p.built.strip.twist_bound().expect("bound") < 1e-9, "{tolerance}");
                    assert!((0..=50).all(|k| p.built.strip.twist(f64::from(k) / 50.0) < 1e-10));
                }
                let ends = [parts[0].built.strip.ruling(0.0), parts[parts.len() - 1].built.strip.ruling(1.0)];
                for (got, want) in ends.iter().zip([one.strip.ruling(0.0), one.strip.ruling(1.0)]) {
                    assert!((0..2).all(|d| (got[d] - want[d]).norm() < 1e-9), "{got:?} {want:?}");
                }
                for w in parts.windows(2) {
                    let (p, q) = (w[0].built.strip.ruling(1.0), w[1].built.strip.ruling(0.0));
                    assert!((0..2).all(|d| (p[d] - q[d]).norm() < 1e-9));
                }
            }
        }
    }

    #[test]
    fn an_inflection_is_a_ruling_where_two_strips_meet_smoothly() {
        // A wave: rails over one cubic, the second one lower and slanting, so that rulings are not parallel.
        let rail = |name: &str, y: f64, lean: f64| {
            let points: Vec<Vec3> = (0..=40)
                .map(|k| f64::from(k) / 20.0 - 1.0)
                .map(|t| Vec3::new(100.0 * t * (1.0 + lean), y, 60.0 * (t * t * t - 0.3 * t) * (1.0 + lean)))
                .collect();
            Rail::through(name, &points).expect("rail")
        };
        let (a, b) = (rail("a", 0.0, 0.0), rail("b", 90.0, -0.3));
        // One rail is the other one scaled: rulings join equal parameters.
        let stations: Vec<[f64; 2]> = (0..5).map(|k| [f64::from(k) / 4.0; 2]).collect();
        let one = between_pieces([&a, &b], [0, 0], &stations, &BuildOptions::new(1e-5), &Control::default())
            .expect("a strip");
        let one = one.expect("a strip");
        let at = RailRulings::new(&one, [&a, &b]).expect("rulings").inflections(0.0, 1.0);
        assert!(at.len() == 1 && (one.strip.ruling(at[0])[0] - a.point(0.5)).norm() < 1e-3, "{at:?}");
        let parts = exact_strips(&one, [&a, &b], 0.01, &Control::default()).expect("exact");
        assert_eq!(parts.len(), 2);
        for p in &parts {
            assert!(p.built.strip.twist_bound().expect("bound") < 1e-9);
        }
        for w in parts.windows(2) {
            let (p, q) = (&w[0].built.strip, &w[1].built.strip);
            let ends = (p.ruling(1.0), q.ruling(0.0));
            assert!((0..2).all(|d| (ends.0[d] - ends.1[d]).norm() < 1e-9));
            let (n, m) = (p.patch.jet(1.0, 0.5).normal(), q.patch.jet(0.0, 0.5).normal());
            assert!(n.angle(&m) < 1e-7, "{}", n.angle(&m));
        }
    }

    #[test]
    fn what_no_envelope_follows_is_refused_with_the_reason() {
        let ([a, b], strips) = fitted();
        let e = exact_strips(&strips[0], [&a, &b], 1e-13, &Control::default()).expect_err("too fine");
        assert!(matches!(e, ExactError::Strays(off) if off > 1e-13), "{e}");
        let stopped = Control::default();
        stopped.cancel();
        let e = exact_strips(&strips[0], [&a, &b], 0.1, &stopped).expect_err("stopped");
        assert!(matches!(e, ExactError::Stopped(_)), "{e}");
        // Rulings between other points of the rails: no tangent planes are common.
        let mut wrong = strips[0].clone();
        for c in &mut wrong.rails[1].parameter.control {
            c[0] = (c[0] + 0.1).min(1.0);
        }
        assert!(exact_strips(&wrong, [&a, &b], 1e-3, &Control::default()).is_err());
    }
}
