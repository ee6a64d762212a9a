//! The radius to which a part is rolled, along the part (docs/algorithms/shop.md, "Rolling").

use super::laid::{Laid, Spot};
use crate::develop::refold::drawn::polygon;
use crate::geom::Vec2;
use crate::patchwork::pattern::{Pattern, ViewSide};
use std::ops::Range;

/// A ruling of a part with the radii of the sheet there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollStation {
    /// Index of the panel, or face, within the part.
    pub panel: usize,
    /// Distance from the first ruling, square to the rulings along the middle of the part, mm.
    pub position: f64,
    /// The ruling as it lies in the pattern, from edge to edge.
    pub ends: [Vec2; 2],
    /// Radius of curvature at both ends, mm; infinite where the sheet is flat.
    pub radii: [f64; 2],
    /// Turn of the sheet from the first ruling, rad; positive towards the eye.
    pub turn: f64,
}

/// Stations of a table: equal parts of the way.
const PARTS: usize = 24;
/// Turn (rad) on a way as long as the part below which the sheet is flat: as for bend lines.
const FLAT: f64 = 1e-3;

/// The outlines of a pattern as polygons.
pub(in crate::develop) fn outlines(pattern: &Pattern, size: f64) -> Vec<Vec<Vec2>> {
    let contour = |c: &crate::patchwork::pattern::Contour| {
        let joints: Vec<(Vec2, f64)> = c.vertices.iter().map(|v| (v.point, v.bulge)).collect();
        polygon(&joints, size)
    };
    pattern.contours.iter().map(contour).collect()
}

/// Radii at equal distances along a part, first and last ruling among them; none of a part that is flat throughout. Of a part of
/// faces that have maps of their own along each of its rolled faces.
///
/// *Input*: a part with its maps, seen from the side of its pattern. *Measured, not proven.*
pub(crate) fn roll_table(laid: &Laid, pattern: &Pattern) -> Vec<RollStation> {
    if !laid.is_of_faces() {
        return along(laid, 0..laid.len(), &outlines(pattern, laid.size()), up(laid, pattern));
    }
    // Normals of faces are those towards the eye that sees their outside.
    let up = if pattern.view == ViewSide::Outside { 1.0 } else { -1.0 };
    let own = |k: usize| laid.face(k).map_or_else(Vec::new, |f| along(laid, k..k + 1, &f.region.loops, up));
    laid.all_rolled().into_iter().flat_map(own).collect()
}

/// Radii along panels that follow each other, inside polygons of the drawing.
fn along(laid: &Laid, panels: Range<usize>, loops: &[Vec<Vec2>], up: f64) -> Vec<RollStation> {
    let rulings = RulingOnTheWay::of(laid, panels, loops);
    let Some(length) = rulings.last().map(|c| c.position).filter(|l| *l > 0.0) else { return Vec::new() };
    let mut out = Vec::new();
    for k in 0..=PARTS {
        let at = length * k as f64 / PARTS as f64;
        let i = rulings.partition_point(|c| c.position < at).clamp(1, rulings.len() - 1);
        let (a, b) = (&rulings[i - 1], &rulings[i]);
        let share = if b.position > a.position { (at - a.position) / (b.position - a.position) } else { 1.0 };
        let (panel, t) = if a.panel == b.panel { (a.panel, a.t + (b.t - a.t) * share) } else { (b.panel, b.t) };
        let pieces = laid.inside(panel, t, loops);
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { continue };
        let spots = [first[0], last[1]].map(|s| Spot { panel, t, s });
        let radius = |spot: &Spot| {
            let r = laid.radius(spot);
            if r * FLAT > laid.size() {
                f64::INFINITY
            } else {
                r
            }
        };
        out.push(RollStation {
            panel,
            position: at,
            ends: [laid.flat(&spots[0]), laid.flat(&spots[1])],
            radii: [radius(&spots[0]), radius(&spots[1])],
            turn: up * (a.turn + (b.turn - a.turn) * share),
        });
    }
    let bent = out.iter().any(|s| s.radii.iter().any(|r| r.is_finite()));
    if bent {
        out
    } else {
        Vec::new()
    }
}

/// +1 where turns towards the side to which R_t × R_v points bring the sheet up to the eye, −1 where down.
fn up(laid: &Laid, pattern: &Pattern) -> f64 {
    use crate::patchwork::pattern::BendSense;
    // A line that is drawn tells.
    let told = pattern.rulings.iter().zip(&pattern.bends).filter(|(_, b)| b.sense != BendSense::Flat);
    let widest = told.max_by(|a, b| a.1.angle.total_cmp(&b.1.angle));
    let sign = widest.and_then(|([a, b], bend)| {
        let spot = laid.spot(&((a + b) * 0.5))?;
        let sense = if bend.sense == BendSense::Up { 1.0 } else { -1.0 };
        let j = laid.patch(spot.panel)?.jet(spot.t, laid.v(&spot)?);
        Some(sense * j.normal().dot(&j.duu).signum())
    });
    sign.unwrap_or(1.0)
}

/// A ruling on the way along a part.
pub(super) struct RulingOnTheWay {
    pub panel: usize,
    pub t: f64,
    /// Way from the first ruling, mm.
    pub position: f64,
    /// Turn from the first ruling, rad; positive where the sheet is hollow on the side of R_t × R_v.
    pub turn: f64,
}

impl RulingOnTheWay {
    /// Rulings of panels that follow each other, as far as they meet polygons of the drawing, in order.
    fn of(laid: &Laid, panels: Range<usize>, loops: &[Vec<Vec2>]) -> Vec<Self> {
        let mut out: Vec<Self> = Vec::new();
        let mut before: Option<(Vec2, [Vec2; 2], crate::geom::Vec3, f64)> = None;
        for panel in panels {
            // Neighbouring patches may look to other sides.
            let side = before.as_ref().map_or(1.0, |(.., n, s)| {
                let first = laid.stations(panel).next().unwrap_or(0.0);
                s * laid.normal(panel, first).map_or(1.0, |m| m.0.dot(n).signum())
            });
            for t in laid.stations(panel) {
                let pieces = laid.inside(panel, t, loops);
                let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { continue };
                let Some((n, rising)) = laid.normal(panel, t) else { continue };
                let ends = laid.ruling(panel, t);
                let middle = ends[0] + (ends[1] - ends[0]) * (0.5 * (first[0] + last[1]));
                let (mut step, mut turn) = (0.0, 0.0);
                if let Some((place, [a, b], m, _)) = &before {
                    // Way square to the mean of both rulings.
                    let way = ((b - a).normalize() + (ends[1] - ends[0]).normalize()).normalize();
                    step = way.perp(&(middle - place)).abs();
                    turn = side * rising * m.angle(&n).min(std::f64::consts::PI - m.angle(&n));
                }
                let (position, turned) = out.last().map_or((0.0, 0.0), |c| (c.position, c.turn));
                out.push(Self { panel, t, position: position + step, turn: turned + turn });
                before = Some((middle, ends, n, side));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::shop::specimens::{cone, cylinder, part_of, pattern_of};

    #[test]
    fn a_cone_is_rolled_to_the_radii_of_its_ends() {
        let (patchwork, pattern) = pattern_of(vec![cone("a", 0.0, 1.0), cone("b", 1.0, 1.7)], 1.0);
        let laid = Laid::of(&patchwork, &part_of(2), &pattern).expect("maps");
        let table = roll_table(&laid, &pattern);
        assert_eq!(table.len(), PARTS + 1);
        // Radius of curvature of a cone: radius of the circle over the cosine of the slope, whose tangent is 1/2.
        let slope = 1.0 / (1.0f64 + 0.25).sqrt();
        for s in &table {
            let [a, b] = s.radii;
            assert!((a - 100.0 / slope).abs() < 1e-3 && (b - 50.0 / slope).abs() < 1e-3, "{s:?}");
        }
        // The tangent plane turns by the angle about the axis times the cosine of the slope.
        let last = table[PARTS];
        assert!((last.turn.abs() - 1.7 * slope).abs() < 1e-3, "{}", last.turn);
        // Half way up the circle has a radius of 75 mm, and its arc is as long on the flat part.
        assert!((last.position - 75.0 * 1.7).abs() < 0.05, "{}", last.position);
        let equal = table.windows(2).map(|w| w[1].position - w[0].position);
        assert!(equal.fold(0.0f64, |m, d| m.max((d - last.position / PARTS as f64).abs())) < 1e-9);
    }

    #[test]
    fn turned_over_the_table_turns_the_other_way_and_ends_with_the_whole_turn() {
        let (patchwork, pattern) = pattern_of(vec![cylinder("a", 0.0, 1.2)], 1.0);
        for (pattern, sign) in [(pattern.clone(), 1.0), (pattern.turned_over(), -1.0)] {
            let laid = Laid::of(&patchwork, &part_of(1), &pattern).expect("maps");
            let table = roll_table(&laid, &pattern);
            let first = pattern.bends[0].sense == crate::patchwork::pattern::BendSense::Up;
            let up = if first { 1.0 } else { -1.0 };
            assert!((table[PARTS].turn - up * 1.2).abs() < 1e-6, "{} {sign}", table[PARTS].turn);
            assert!((table[PARTS].position - 120.0).abs() < 1e-3 && (table[3].radii[0] - 100.0).abs() < 1e-9);
        }
    }
}
