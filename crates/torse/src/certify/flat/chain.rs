//! The flat pattern of a chain of untrimmed strips as drawn, against the strips: one map of all of them that keeps
//! lengths, the outline, rulings, marks.
//!
//! *Theorem* \[certificate, 8\]: there is a map of the strips to the plane, each beginning with the very image of the ruling
//! that ends the one before, that changes no length by more than the factor `1 ± strain_bound`, such that the lines and
//! arcs drawn are within `outline_bound` of the image of the chain's border and it of them: rails, first and last ruling,
//! in their order. In space the strips that meet in the plane are within `gap_bound` of each other. Every ruling drawn lies
//! within `ruling_bound` of the image of one, every mark within `mark_bound` of the image of a rail. The strips and the
//! drawing are the data; how the drawing was made is not looked at. Which side is seen is found from the drawing.

use super::matching::{directed, laid_on, motion_of, Walk};
use super::outline::{chain_bound, Image, Motion};
use super::rails::{FlatRails, Start};
use super::senses::{against, seen};
use super::simple_outline::outline_is_simple;
use super::{DrawnRulings, FlatCertificate};
use crate::certify::ruled::Ruled;
use crate::certify::vector::length_bound;
use crate::control::Control;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Contour, Pattern};
use crate::reason::{FlatFault, Of};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;

/// A bound of this share of the tolerance is good enough for a ruling or a mark: no strip is looked for that gives less.
pub(super) const GOOD_BOUND: f64 = 1e-3;

/// A motion that moves nothing.
pub(super) const STILL: Motion = Motion { turn: [1.0, 0.0], from: [0.0; 2], to: [0.0; 2] };

/// A strip in the plane.
struct Link {
    rails: FlatRails,
    points: [bool; 2],
}

/// A stretch of the border of a chain: a rail or a ruling of one of its strips.
struct BorderSide {
    link: usize,
    trim: Curve<2>,
    is_rail: bool,
}

/// A chain in the plane.
struct Laid {
    links: Vec<Link>,
    runs: Vec<BorderSide>,
    /// Distance in space that the plane closes at one joint at most, and in all.
    gap: f64,
    gaps: f64,
}

/// Proves what is claimed about flat patterns of chains of strips: one certificate per pattern, in order, with the number
/// of its part. `tolerance` (mm): the drawing may be off by that much, strain over the length of the pattern and gaps of
/// joints included.
///
/// *Guarantee*: the theorem at the head of this file. *Not* guaranteed: that marks are equally far apart, which side of the sheet is called its outside.
///
/// *Cost*: about 0.1 ms per span, 20 µs per line or arc.
pub fn strip_parts(
    strips: &[Strip],
    parts: &[Part],
    patterns: &[Pattern],
    tolerance: f64,
    control: &Control,
) -> Vec<FlatCertificate> {
    let one = |pattern: &Pattern| {
        let part = parts.get(pattern.panel);
        let chain = part.and_then(|p| strips.get(p.first..p.first.checked_add(p.count)?)).unwrap_or_default();
        FlatCertificate::judged(pattern.panel, tolerance, |out| {
            if control.stopped() {
                return Err(FlatFault::Stopped);
            }
            judged(out, chain, pattern, tolerance)?;
            outline_is_simple(pattern, tolerance)
        })
    };
    parallel::map(patterns.iter(), one)
}

/// Proves what is claimed about the pattern of a chain: see the head of this file.
pub(super) fn judged(
    out: &mut FlatCertificate,
    chain: &[Strip],
    pattern: &Pattern,
    tolerance: f64,
) -> Result<(), FlatFault> {
    let [contour] = &pattern.contours[..] else { return Err(FlatFault::NotOneLine) };
    if contour.vertices.len() < 2 {
        return Err(FlatFault::NoSides);
    }
    let lay = |side: f64| Laid::new(chain, side).ok_or(FlatFault::NoMap);
    let laid = lay(1.0)?;
    let walk = laid.walk().ok_or(NOWHERE)?;
    let off = |side: f64| fit(&walk, contour, side).map_or(f64::INFINITY, |m| m.1);
    let patches = || chain.iter().map(|s| &s.patch);
    let side = seen(patches(), pattern, tolerance, &off).ok_or(FlatFault::OtherWay)?;
    let laid = if side < 0.0 { lay(side)? } else { laid };
    let blank = out.clone();
    let found = drawn(out, &laid, pattern, tolerance);
    let proven = |c: &FlatCertificate, found: &Result<(), _>| found.is_ok() && c.drawing_bound() <= tolerance;
    if proven(out, &found) || !off(-side).is_finite() || against(patches(), -side, pattern) {
        return found;
    }
    // Outlines that are their own mirror images, as squares are, fit from either side: rulings and marks may tell.
    let mut other = blank;
    let found_there = drawn(&mut other, &lay(-side)?, pattern, tolerance);
    if proven(&other, &found_there) {
        *out = other;
        return found_there;
    }
    found
}

/// Why nothing is shown of a drawing.
const NOWHERE: FlatFault = FlatFault::Nowhere(Of::Strips);

/// Where a contour shows a border seen from a side; outlines are drawn counter-clockwise.
fn fit(walk: &Walk, contour: &Contour, flip: f64) -> Option<(Motion, f64)> {
    motion_of(walk, &directed(contour, walk.turn() * flip < 0.0), flip)
}

/// What is shown of a drawing of a chain seen from one side.
fn drawn(out: &mut FlatCertificate, laid: &Laid, pattern: &Pattern, tolerance: f64) -> Result<(), FlatFault> {
    let contour = &pattern.contours[0];
    let walk = laid.walk().ok_or(NOWHERE)?;
    let motion = fit(&walk, contour, 1.0).ok_or(NOWHERE)?.0;
    let found = laid_on(&walk, &directed(contour, walk.turn() < 0.0), &motion).ok_or(NOWHERE)?;
    out.strain_bound = laid.links.iter().map(|l| l.rails.strain).fold(0.0, f64::max);
    out.gap_bound = laid.gap;
    let pairs: Vec<_> = laid.runs.iter().zip(&found.chains).collect();
    let bounds: Vec<_> =
        parallel::map(pairs.iter(), |(run, vertices)| chain_bound(&laid.image(run, motion), vertices, tolerance));
    let worst = |b: Vec<Option<f64>>| b.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b)));
    let mut missing = Ok(());
    match worst(bounds) {
        Some(bound) => out.outline_bound = bound,
        None => missing = Err(FlatFault::Outline(Of::Strips)),
    }
    let enough = GOOD_BOUND * tolerance;
    let lines: Vec<DrawnRulings> = laid.links.iter().map(|l| DrawnRulings::new(&l.rails, motion)).collect();
    let rulings = parallel::map(pattern.rulings.iter(), |r| ruling_bound(&lines, &r.map(|p| [p.x, p.y]), enough));
    match worst(rulings) {
        Some(bound) => out.ruling_bound = bound,
        None => missing = missing.and(Err(FlatFault::Ruling(Of::Strips))),
    }
    let marks =
        parallel::map(pattern.marks.iter(), |m| laid.mark_bound(&[m.point.x, m.point.y], &walk, motion, enough));
    match worst(marks) {
        Some(bound) => out.mark_bound = bound,
        None => missing = missing.and(Err(FlatFault::MarkOffRail)),
    }
    missing?;
    let change = laid.links.iter().map(|l| l.rails.change()).reduce(|a, b| a.and(&b));
    let change = change.map_or(f64::INFINITY, |c| c.of(pattern.length));
    out.change_bound = (Interval::point(change) + Interval::point(laid.gaps)).hi;
    Ok(())
}

/// Bound of the distance of a drawn ruling from the image of one of the strips, those first that are nearest by samples.
pub(super) fn ruling_bound(drawn: &[DrawnRulings], ends: &[[f64; 2]; 2], enough: f64) -> Option<f64> {
    let order = drawn.iter().enumerate().map(|(k, d)| (d.about(ends), k)).collect();
    least(order, enough, |k| drawn[k].bound(ends))
}

/// The least of some bounds: the most promising first, until one is good enough.
fn least(mut order: Vec<(f64, usize)>, enough: f64, bound: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let mut best: Option<f64> = None;
    while let Some(k) = (0..order.len()).min_by(|a, b| order[*a].0.total_cmp(&order[*b].0)) {
        best = bound(order.swap_remove(k).1).into_iter().chain(best).reduce(f64::min);
        if best.is_some_and(|b| b <= enough) {
            break;
        }
    }
    best
}

impl Laid {
    /// Lays strips side by side; `side` ±1 says from which side they are seen.
    fn new(chain: &[Strip], side: f64) -> Option<Self> {
        let mut out = Self { links: Vec::with_capacity(chain.len()), runs: Vec::new(), gap: 0.0, gaps: 0.0 };
        let mut places = None;
        for (k, strip) in chain.iter().enumerate() {
            let Pointed { patch, points, moved, way } = pointed(strip)?;
            let ruled = Ruled::new(&patch)?;
            let used = Interval::new(if points[0] { 1.0 } else { 0.0 }, if points[1] { 0.0 } else { 1.0 });
            let rails = FlatRails::from(&ruled, &|_, _| Some(used), side, &Start { places, points })?;
            places = Some(rails.end());
            out.links.push(Link { rails, points });
            let joint = k.checked_sub(1).map_or(0.0, |before| joint_gap(&chain[before], strip));
            out.gap = out.gap.max(joint).max(moved);
            out.gaps = (Interval::point(out.gaps) + Interval::point(joint) + Interval::point(way)).hi;
        }
        // Rails forwards, the last ruling, the other rails backwards, the first ruling.
        let last = out.links.len().checked_sub(1)?;
        let rail = |k: usize, v: usize| {
            let own = (!out.links[k].points[v]).then(|| out.links[k].rails.breaks().to_vec())?;
            Some((k, own.into_iter().map(|t| [t, v as f64]).collect::<Vec<_>>()))
        };
        let end = |k: usize, t: f64, v: f64| vec![(k, vec![[t, v], [t, 1.0 - v]])];
        let breaks = |k: usize| out.links[k].rails.breaks();
        let (first, behind) = (*breaks(0).first()?, *breaks(last).last()?);
        let back = |(k, mut c): (usize, Vec<[f64; 2]>)| {
            c.reverse();
            (k, c)
        };
        let sides = [
            (true, (0..=last).filter_map(|k| rail(k, 0)).collect()),
            (false, end(last, behind, 0.0)),
            (true, (0..=last).rev().filter_map(|k| rail(k, 1)).map(back).collect()),
            (false, end(0, first, 1.0)),
        ];
        let mut runs = Vec::new();
        for (is_rail, side) in sides {
            for (link, control) in side {
                let at: Vec<f64> = (0..control.len()).map(|i| i as f64 / (control.len() - 1) as f64).collect();
                let trim = Curve { knots: Knots::clamped(1, &at).ok()?, control };
                runs.push(BorderSide { link, trim, is_rail });
            }
        }
        out.runs = runs;
        Some(out)
    }

    /// The border, sampled.
    fn walk(&self) -> Option<Walk> {
        Walk::new(&self.runs.iter().map(|r| self.image(r, STILL)).collect::<Vec<_>>())
    }

    fn image<'a>(&'a self, run: &'a BorderSide, motion: Motion) -> Image<'a> {
        Image { flat: &self.links[run.link].rails, trim: &run.trim, motion }
    }

    /// Bound of the distance of a mark from the image of a rail, those first that are nearest by the samples of a walk.
    fn mark_bound(&self, at: &[f64; 2], walk: &Walk, motion: Motion, enough: f64) -> Option<f64> {
        let rails = self.runs.iter().zip(&walk.runs).enumerate().filter(|(_, (run, _))| run.is_rail);
        let nearest = |samples: &[(f64, [f64; 2])]| -> (f64, f64) {
            let far = |p: &[f64; 2]| {
                let p = motion.about(p);
                (p[0] - at[0]).hypot(p[1] - at[1])
            };
            samples.iter().map(|(s, p)| (far(p), *s)).fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a })
        };
        let seen: Vec<(usize, (f64, f64))> = rails.map(|(k, (_, samples))| (k, nearest(samples))).collect();
        let order = seen.iter().enumerate().map(|(i, s)| (s.1 .0, i)).collect();
        least(order, enough, |i| {
            let (k, (_, s)) = seen[i];
            let image = self.image(&self.runs[k], motion);
            let p = image.point(image.nearest(at, s, 0.0))?;
            let w = [0, 1].map(|d: usize| p[d] - Interval::point(at[d]));
            Some((w[0].sqr() + w[1].sqr()).sqrt().hi)
        })
    }
}

/// A patch whose rails that are points up to rounding are points.
struct Pointed {
    patch: Surface,
    points: [bool; 2],
    /// How far that moves any point, mm.
    moved: f64,
    /// Length of the rails that became points: paths that cross no ruling twice change by no more.
    way: f64,
}

/// Takes rails that stand still up to rounding for points. `None` if both do.
fn pointed(strip: &Strip) -> Option<Pointed> {
    let points = [0, 1].map(|side: usize| strip.is_point(side));
    let mut out = Pointed { patch: strip.patch.clone(), points, moved: 0.0, way: 0.0 };
    if points == [true, true] || strip.patch.row() != 2 {
        return None;
    }
    for side in (0..2).filter(|s| points[*s]) {
        let c = strip.patch.control.get(side)?;
        let tip = [c[0] / c[3], c[1] / c[3], c[2] / c[3]];
        let mut before: Option<[Interval; 3]> = None;
        for c in out.patch.control.iter_mut().skip(side).step_by(2) {
            let here = affine(c);
            // A point of the rail is a mean of its control points, and the rail is no longer than their polygon.
            let off = std::array::from_fn(|d| here[d] - Interval::point(tip[d]));
            out.moved = out.moved.max(length_bound(&off));
            if let Some(b) = before {
                let step = length_bound(&std::array::from_fn(|d| here[d] - b[d]));
                out.way = (Interval::point(out.way) + Interval::point(step)).hi;
            }
            before = Some(here);
            *c = [tip[0], tip[1], tip[2], 1.0];
        }
    }
    out.patch.rational = out.patch.control.iter().any(|c| c[3] != 1.0);
    Some(out)
}

fn affine(c: &[f64; 4]) -> [Interval; 3] {
    [0, 1, 2].map(|d: usize| Interval::point(c[d]) / Interval::point(c[3]))
}

/// Distance in space of the last ruling of a strip from the first of the next, at equal shares.
fn joint_gap(before: &Strip, next: &Strip) -> f64 {
    let (a, b) = (&before.patch.control, &next.patch.control);
    let gap = |k: usize| match (a.len().checked_sub(2).and_then(|n| a.get(n + k)), b.get(k)) {
        (Some(p), Some(q)) => {
            let (p, q) = (affine(p), affine(q));
            length_bound(&std::array::from_fn(|d| p[d] - q[d]))
        }
        _ => f64::INFINITY,
    };
    gap(0).max(gap(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Vec2, Vec3};
    use crate::patchwork::pattern::ContourVertex;
    use crate::torse::form::PanelKind;

    const TOLERANCE: f64 = 0.01;

    /// A folded strip of a square, a triangle and a square, 100 mm high, with its drawing: the unfolded polygon.
    fn folded() -> (Vec<Strip>, Pattern) {
        let x = Vec3::new;
        let rulings = [
            [x(0.0, 0.0, 0.0), x(0.0, 100.0, 0.0)],
            [x(100.0, 0.0, 0.0), x(100.0, 100.0, 0.0)],
            [x(100.0, 0.0, 0.0), x(100.0, 80.0, 60.0)],
        ];
        // Triangle about the lower end of the second ruling, then a square beside it.
        let across = x(90.0, 0.0, 0.0);
        let last = rulings[2].map(|p| p + across);
        let strips = vec![
            Strip::quad("1", PanelKind::Plane, rulings[0], rulings[1]).expect("strip"),
            Strip::quad("2", PanelKind::Plane, rulings[1], rulings[2]).expect("strip"),
            Strip::quad("3", PanelKind::Plane, rulings[2], last).expect("strip"),
        ];
        // The triangle turns the ruling by the angle between both; beyond it all goes on square to the turned ruling.
        let angle = (rulings[1][1] - rulings[1][0]).angle(&(rulings[2][1] - rulings[2][0]));
        let (s, c) = angle.sin_cos();
        let (low, up) = (Vec2::new(100.0, 0.0), Vec2::new(s, c) * 100.0);
        let ahead = Vec2::new(c, -s) * 90.0;
        let corners = [
            Vec2::zeros(),
            low,
            low + ahead,
            low + ahead + up,
            low + up,
            Vec2::new(100.0, 100.0),
            Vec2::new(0.0, 100.0),
        ];
        let vertices = corners.map(|point| ContourVertex { point, bulge: 0.0, corner: true }).to_vec();
        let rulings = vec![[low, Vec2::new(100.0, 100.0)], [low, low + up]];
        (strips, Pattern { contours: vec![Contour { vertices }], rulings, length: 220.0, ..Pattern::default() })
    }

    fn judge(strips: &[Strip], pattern: &Pattern) -> FlatCertificate {
        let part = Part { name: "A".into(), first: 0, count: strips.len(), missing: None };
        strip_parts(strips, &[part], std::slice::from_ref(pattern), TOLERANCE, &Control::default()).swap_remove(0)
    }

    #[test]
    fn an_unfolded_polygon_is_proven_to_rounding() {
        let (strips, pattern) = folded();
        let found = judge(&strips, &pattern);
        assert!(found.holds(), "{:?}", found.reason());
        assert!(found.outline_bound() < 1e-9 && found.ruling_bound() < 1e-9, "{found:?}");
        assert!(found.strain_bound() < 1e-9 && found.gap_bound() < 1e-9 && found.change_bound() < 1e-6, "{found:?}");
        assert!(judge(&strips, &pattern.turned_over()).holds());
    }

    #[test]
    fn strips_that_do_not_meet_or_do_not_fit_are_seen() {
        let (strips, pattern) = folded();
        // A gap in space of less than the tolerance is told, a greater one refuses.
        for (by, holds) in [(1e-3, true), (0.1, false)] {
            let mut apart = strips.clone();
            apart[2] = apart[2].clone().moved(&(Vec3::y() * by));
            let found = judge(&apart, &pattern);
            assert!(found.gap_bound() >= by && found.gap_bound() < 1.01 * by + 1e-9, "{found:?}");
            assert_eq!(found.holds(), holds, "{by}: {found:?}");
        }
        assert!(!judge(&strips[..2], &pattern).holds() && !judge(&[], &pattern).holds());
        let mut turned = pattern.clone();
        let v = &mut turned.contours[0].vertices;
        (v[2].point, v[3].point) = (v[2].point + Vec2::y(), v[3].point + Vec2::y());
        assert!(!judge(&strips, &turned).holds());
    }
}
