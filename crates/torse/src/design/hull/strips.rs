//! Exact strips along the chains of a hull: fans and facets as cones and planes, the rest as between any two rails
//! \[W15, 5.4\].

use super::chains::RulingChain;
use super::tip::towards_tip;
use super::{Hull, HullError};
use crate::control::Control;
use crate::design::loft::build::{between_pieces, BuildOptions, BuiltStrip};
use crate::design::loft::LoftError;
use crate::num::parallel;
use crate::torse::form::PanelKind;
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;

/// A strip of the hull's boundary with the rails that it lies between.
#[derive(Clone, Debug)]
pub struct HullStrip {
    /// Strip and parts of the rails.
    pub built: BuiltStrip,
    /// Curves of `v = 0` and `v = 1`.
    pub rails: [usize; 2],
    /// Whether the curve is run through backwards; pieces and parameters are those of the curve reversed.
    pub turned: [bool; 2],
}

/// Strips that share rulings, in order.
#[derive(Clone, Debug, Default)]
pub struct HullPart {
    /// Its strips.
    pub strips: Vec<HullStrip>,
    /// Planar triangles, if the part is none but a facet.
    pub facet: Option<Strip>,
    /// Whether the last ruling is the first.
    pub closed: bool,
    /// Tips that were cut off, before the first and behind the last strip.
    pub tips: [Option<Tip>; 2],
}

/// The arc of a curve beyond the last ruling towards a tip, where a strip is cut off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// The curve.
    pub rail: usize,
    /// Parameters of the arc's ends, increasing; on closed curves they go on beyond the domain.
    pub arc: [f64; 2],
}

/// Lengths of rulings, shares of the curve's size, at which a strip towards a tip is cut: the shorter rulings are, the less
/// is known of their direction, and what cannot be proven of the last ones must not spoil the rest.
const TIP_CUTS: [f64; 4] = [0.2, 0.06, 0.02, 0.006];
/// Stations before a place where rulings turn round at which a strip is cut: the ruling there touches the curve, and nothing can be
/// proven of the strip beside it.
const TURN_CUTS: [usize; 3] = [1, 3, 9];
/// Parameter steps below which a run has no extent.
const REST: f64 = 1e-9;
/// Distance from the end of a piece within which a ruling is taken to end there: what would be left is no strip. The
/// ruling turns by the same share of itself, far less than a strip may be twisted.
const AT_END: f64 = 1e-7;

/// Strips of all chains, and single facets as triangles. Where rulings shrink to a point, the strip ends as soon as
/// the rest of the curve lies within `tip` (mm) of one (sampled). A control that says stop leaves the rest out.
///
/// # Errors
/// Data that no spline can hold.
pub fn strips(
    rails: &[Rail],
    hull: &Hull,
    tip: f64,
    options: &BuildOptions,
    control: &Control,
) -> Result<Vec<HullPart>, HullError> {
    let reversed: Vec<Rail> = rails.iter().map(Rail::reversed).collect();
    let made = |chain| {
        if control.stopped() {
            Ok(HullPart::default())
        } else {
            part((rails, &reversed), chain, tip, options, control)
        }
    };
    let mut out = parallel::map(hull.chains.iter(), made).into_iter().collect::<Result<Vec<HullPart>, HullError>>()?;
    for &f in &hull.single {
        let [p, q, r] = hull.facets[f].map(|c| c.point);
        let facet = Strip::quad("", PanelKind::Plane, [p, q], [p, r])?;
        out.push(HullPart { facet: Some(facet), ..HullPart::default() });
    }
    out.retain(|p| p.facet.is_some() || !p.strips.is_empty());
    Ok(out)
}

/// `rails` are the curves, as given and reversed.
fn part(
    (rails, reversed): (&[Rail], &[Rail]),
    chain: &RulingChain,
    tip: f64,
    options: &BuildOptions,
    control: &Control,
) -> Result<HullPart, HullError> {
    let mut stations = chain.stations.clone();
    let mut joints = chain.joints.clone();
    let one = chain.rails[0] == chain.rails[1];
    if chain.tips[1] && one {
        stations = towards_tip(&rails[chain.rails[0]], stations, tip);
    }
    if chain.tips[0] && one {
        let count = stations.len();
        stations.reverse();
        stations = towards_tip(&rails[chain.rails[0]], stations, tip);
        stations.reverse();
        joints = joints.iter().filter_map(|j| (j + stations.len()).checked_sub(count)).collect();
    }
    let mut tips = [None, None];
    for end in (0..2).filter(|&end| one && chain.tips[end]) {
        let rail = chain.rails[0];
        joints.extend(tip_joints(&rails[rail], &stations, end == 1));
        let s = stations[if end == 1 { stations.len() - 1 } else { 0 }];
        tips[end] = Some(Tip { rail, arc: arc(&rails[rail], s) });
    }
    for end in (0..2).filter(|&end| chain.turns[end]) {
        joints.extend(turn_joints(stations.len(), end == 1));
    }
    joints.retain(|j| *j > 0 && j + 1 < stations.len());
    joints.sort_unstable();
    joints.dedup();
    // Both parameters grow: curves that are followed backwards are reversed.
    let last = stations[stations.len() - 1];
    let turned = [0, 1].map(|d| last[d] < stations[0][d]);
    for d in (0..2).filter(|&d| turned[d]) {
        let n = rails[chain.rails[d]].pieces.len() as f64;
        stations.iter_mut().for_each(|s| s[d] = n - s[d]);
    }
    let of = |d: usize| if turned[d] { &reversed[chain.rails[d]] } else { &rails[chain.rails[d]] };
    let (a, b) = (of(0), of(1));
    let mut out = HullPart { closed: chain.closed, tips, ..HullPart::default() };
    stations.iter_mut().for_each(|s| *s = s.map(rounded));
    let sections = sections(&stations, &joints);
    let strip_of = |section: &Vec<[f64; 2]>| -> Result<Option<HullStrip>, HullError> {
        if control.stopped() {
            return Ok(None);
        }
        let (p, q) = (section[0], section[section.len() - 1]);
        let base = [0, 1].map(|d| (0.5 * (p[d] + q[d])).floor());
        let piece = [0, 1].map(|d: usize| {
            let n = of(d).pieces.len() as f64;
            // A section that rests at the very end of an open curve belongs to its last piece.
            if of(d).closed {
                base[d].rem_euclid(n)
            } else {
                base[d].clamp(0.0, n - 1.0)
            }
        });
        let base = [0, 1].map(|d: usize| if of(d).closed { base[d] } else { piece[d] });
        let local: Vec<[f64; 2]> = section.iter().map(|s| [0, 1].map(|d| (s[d] - base[d]).clamp(0.0, 1.0))).collect();
        let built =
            between_pieces([a, b], piece.map(|p| p as usize), &local, options, control).map_err(|e| match e {
                LoftError::Spline(e) => HullError::Spline(e),
                // Building fails for no other reason.
                _ => HullError::NoCurves,
            })?;
        Ok(built.map(|built| HullStrip { built, rails: chain.rails, turned }))
    };
    let made = parallel::map(sections.iter(), strip_of).into_iter().collect::<Result<Vec<_>, HullError>>()?;
    // A part with a gap is no part.
    if !control.stopped() {
        out.strips = made.into_iter().flatten().collect();
    }
    Ok(out)
}

/// Stations at which strips are cut towards a tip, at the end or at the start.
fn tip_joints(rail: &Rail, stations: &[[f64; 2]], at_end: bool) -> Vec<usize> {
    let size = rail.bbox().diagonal();
    let place = |s: f64| rail.point(if rail.closed { s.rem_euclid(rail.pieces.len() as f64) } else { s });
    let long = |k: usize, share: f64| (place(stations[k][1]) - place(stations[k][0])).norm() >= share * size;
    let first = |share: &f64| match at_end {
        true => (0..stations.len()).rev().find(|k| long(*k, *share)),
        false => (0..stations.len()).find(|k| long(*k, *share)),
    };
    // One station before the end the arc is about four times as high: what cannot be proven may be left off there.
    let last = if at_end { stations.len().checked_sub(2) } else { Some(1) };
    TIP_CUTS.iter().filter_map(first).chain(last).collect()
}

/// Stations at which strips are cut towards a place where rulings turn round, at the end or at the start.
fn turn_joints(stations: usize, at_end: bool) -> impl Iterator<Item = usize> {
    let off = TURN_CUTS.into_iter().filter(move |k| 3 * k < stations);
    off.map(move |k| if at_end { stations - 1 - k } else { k })
}

/// Stations cut at joints (in order) and at the ends of pieces.
fn sections(stations: &[[f64; 2]], joints: &[usize]) -> Vec<Vec<[f64; 2]>> {
    let mut out: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut now = vec![stations[0]];
    for k in 1..stations.len() {
        let (last, s) = (stations[k - 1], stations[k]);
        // Ends of pieces passed between two stations.
        let mut cuts: Vec<f64> = Vec::new();
        for d in 0..2 {
            let step = s[d] - last[d];
            let mut x = (last[d] + REST).floor() + 1.0;
            while step > REST && x < s[d] - REST {
                cuts.push((x - last[d]) / step);
                x += 1.0;
            }
        }
        cuts.sort_by(f64::total_cmp);
        for c in cuts {
            let m = [0, 1].map(|d| rounded(last[d] + (s[d] - last[d]) * c));
            now.push(m);
            out.push(std::mem::replace(&mut now, vec![m]));
        }
        now.push(s);
        let ends = (0..2).any(|d| (s[d] - s[d].round()).abs() < REST && s[d] - now[0][d] > REST);
        if (ends || joints.binary_search(&k).is_ok()) && k + 1 < stations.len() {
            out.push(std::mem::replace(&mut now, vec![s.map(rounded)]));
        }
    }
    out.push(now);
    out.retain(|s| s.len() > 1 && (0..2).any(|d| s[s.len() - 1][d] - s[0][d] > REST));
    out
}

/// The arc between both ends of a ruling across which a tip lies.
fn arc(rail: &Rail, s: [f64; 2]) -> [f64; 2] {
    let n = rail.pieces.len() as f64;
    let turns = if rail.closed { ((s[1] - s[0]) / n).round() * n } else { 0.0 };
    [s[0].min(s[1] - turns), s[0].max(s[1] - turns)]
}

/// Whole numbers are met exactly.
fn rounded(x: f64) -> f64 {
    if (x - x.round()).abs() < AT_END {
        x.round()
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::super::hull;
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::{Frame, Vec3};
    use crate::spline::bezier::Bezier;
    use crate::spline::curve::{bezier_pieces, Curve};
    use std::f64::consts::TAU;

    fn circle(r: f64, z: f64) -> Rail {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(0.0, TAU).expect("spline");
        Rail::new("circle", &[c]).expect("rail")
    }

    fn made(rails: &[Rail]) -> Vec<HullPart> {
        of_size(rails, 1.0)
    }

    fn of_size(rails: &[Rail], size: f64) -> Vec<HullPart> {
        let control = Control::default();
        let h = hull(rails, 96, &control).expect("hull");
        strips(rails, &h, 1e-6 * size, &BuildOptions::new(1e-6 * size), &control).expect("strips")
    }

    #[test]
    fn two_circles_are_joined_by_one_ring_of_exact_cones() {
        let parts = made(&[circle(1.0, 0.0), circle(0.5, 1.0)]);
        assert_eq!(parts.len(), 1);
        assert!(parts[0].closed);
        for s in &parts[0].strips {
            assert_eq!(s.built.strip.kind, PanelKind::Cone);
        }
        let area: f64 = parts[0].strips.iter().map(|s| s.built.strip.area_estimate()).sum();
        let exact = std::f64::consts::PI * 1.5 * 1.25f64.sqrt();
        assert!((area - exact).abs() < 1e-9, "{area} {exact}");
    }

    #[test]
    fn square_to_round_is_one_ring_of_four_triangles_and_four_cones() {
        let c = 0.8;
        let corners = [[c, c], [-c, c], [-c, -c], [c, -c], [c, c]].map(|p| Vec3::new(p[0], p[1], 1.5));
        let square = Rail::polyline("square", &corners).expect("square");
        let parts = made(&[circle(1.0, 0.0), square]);
        assert_eq!(parts.len(), 1);
        let all = &parts[0].strips;
        let area: f64 = all.iter().map(|s| s.built.strip.area_estimate()).sum();
        assert!((area - 9.565_584_009_167_319).abs() < 1e-9, "{area}");
        assert_eq!(all.iter().filter(|s| s.built.strip.kind == PanelKind::Plane).count(), 4);
        assert_eq!(all.len(), 8);
    }

    fn area(rails: &[Rail]) -> f64 {
        let parts = made(rails);
        let strips = parts.iter().flat_map(|p| p.strips.iter().map(|s| &s.built.strip).chain(&p.facet));
        strips.map(Strip::area_estimate).sum()
    }

    fn line(points: &[[f64; 3]]) -> Rail {
        Rail::polyline("line", &points.iter().map(|p| Vec3::from(*p)).collect::<Vec<_>>()).expect("line")
    }

    /// Areas by Heron's formula.
    #[test]
    fn edges_of_the_hull_are_passed_on_both_sides() {
        let (x, y) = (line(&[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]), line(&[[50.0, -50.0, 60.0], [50.0, 50.0, 60.0]]));
        // Four triangles of one height.
        let found = area(&[x, y]);
        assert!((found - 200.0 * 50.0_f64.hypot(60.0)).abs() < 1e-6, "{found}");
        let eaves = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 60.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 0.0]];
        let ridge = line(&[[30.0, 30.0, 40.0], [70.0, 30.0, 40.0]]);
        assert!((area(&[line(&eaves), ridge]) - 10_000.0).abs() < 1e-6);
    }

    /// A fan about a point over more than half a circle, and one over the rest.
    #[test]
    fn fans_over_half_a_circle_and_more_go_the_right_way_round() {
        let arc = line(&[[70.0, 0.0, 120.0], [10.0, 0.0, 60.0], [-50.0, 0.0, 120.0]]);
        let found = area(&[circle(100.0, 0.0), arc]);
        // The hull of 4000 points on the circle and of both ends.
        assert!((found - 61_505.82).abs() < 0.02, "{found}");
    }

    /// A circle that stands upright above another one is an edge of the hull down to where its tangent meets a tangent of that.
    #[test]
    fn a_round_edge_of_the_hull_is_passed_on_both_sides() {
        let upright = |r: f64, z: f64| {
            let frame = Frame { origin: Vec3::z() * z, x: Vec3::x(), y: Vec3::z(), z: -Vec3::y() };
            let (c, _) = SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(0.0, TAU).expect("spline");
            Rail::new("upright", &[c]).expect("rail")
        };
        let found = area(&[circle(100.0, 0.0), upright(60.0, 120.0)]);
        // The hull of 4000 points on each has 75 679.79 mm².
        assert!((found - 75_679.80).abs() < 0.02, "{found}");
    }

    /// `(cos t, sin t, ½ cos 2t)` times the size: quartic in homogeneous coordinates.
    fn saddle_loop(size: f64) -> Rail {
        let (c, _) = SpaceCurve::Ellipse { frame: Frame::world(), a: 1.0, b: 1.0 }.to_spline(0.0, TAU).expect("spline");
        let quartics: Vec<Curve<4>> = bezier_pieces(&c)
            .into_iter()
            .map(|(_, _, net)| {
                let b = Bezier::new(net);
                let (x, y, w) = (b.component(0), b.component(1), b.component(3));
                // ½ cos 2t = ½ (x² − y²).
                let z = x.times(&x).minus(&y.times(&y));
                let (xw, yw, ww) = (x.times(&w), y.times(&w), w.times(&w));
                let c = |p: &Bezier<1>, k: usize| size * p.control()[k][0];
                let control = (0..5).map(|k| [c(&xw, k), c(&yw, k), 0.5 * c(&z, k), ww.control()[k][0]]).collect();
                let mut knots = vec![0.0; 5];
                knots.extend([1.0; 5]);
                Curve::new(4, knots, control).expect("quartic")
            })
            .collect();
        Rail::new("saddle", &quartics).expect("rail")
    }

    #[test]
    fn the_hull_of_a_saddle_loop_is_two_cylinders_of_any_size() {
        for size in [1.0, 1e-3, 5000.0] {
            let parts = of_size(&[saddle_loop(size)], size);
            assert_eq!(parts.len(), 2);
            for p in &parts {
                assert_eq!((p.tips.iter().flatten().count(), p.closed), (2, false));
                let area: f64 = p.strips.iter().map(|s| s.built.strip.area_estimate()).sum::<f64>() / size.powi(2);
                // Strips towards tips are too small to tell.
                let large = |s: &&HullStrip| s.built.strip.area_estimate() > 1e-3 * area * size.powi(2);
                assert!(p.strips.iter().filter(large).all(|s| s.built.strip.kind == PanelKind::Cylinder), "{size}");
                // Tips of a millionth are left off.
                assert!((area - 4.317_605_098_244_249).abs() < 1e-6, "{size}: {area}");
            }
        }
    }

    /// A fan about the end of an arc goes on towards it until what is left of the arc is as near to a ruling as asked for.
    #[test]
    fn fans_about_an_end_of_their_own_curve_come_near_it() {
        let bend = |t: f64| [t, t * t, t * t * t];
        let points: Vec<Vec3> = (0..=40).map(|k| Vec3::from(bend(f64::from(k) / 40.0))).collect();
        let parts = made(&[Rail::through("cubic", &points).expect("a rail")]);
        let tips: Vec<[f64; 2]> = parts.iter().flat_map(|p| p.tips).flatten().map(|t| t.arc).collect();
        assert_eq!((parts.len(), tips.len()), (1, 2));
        // Of an arc as long as this, a third of 96 samples, the height is the eighth of the square.
        assert!(tips.iter().all(|[a, b]| (b - a).powi(2) < 4e-5), "{tips:?}");
    }
}
