//! The flat pattern of a surface at a constant distance from the panels: that of the neutral fibre of a sheet
//! (docs/algorithms/shop.md, "The neutral fibre").
//!
//! *Method*. The offset of a developable has the same rulings' directions and the same tangent planes' directions, so its flat
//! rulings have the same angles: where `b` is the unit vector across the rulings and `n` the normal, offsetting by d changes
//! the velocity of the flat directrix by `d (n'·b)` along the flat `b`. Hence every flat ruling is moved as it is, by
//! `d G(t)` with `G' = (n'·b) b`: a quadrature. Outlines are moved point by point and fitted anew by lines and arcs.

use super::laid::Laid;
use crate::develop::arcs::{arcs, rectangle_around, ArcPiece, PlaneCurve};
use crate::develop::unfold::outline::contour_area;
use crate::geom::Vec2;
use crate::num::quadrature::GAUSS_4;
use crate::patchwork::pattern::{Contour, ContourVertex, Mark, MarkLine, Pattern, ViewSide};

/// The moves of the rulings of a part, for an offset of 1 mm towards the eye.
struct Moves<'a, 'b> {
    laid: &'b Laid<'a>,
    /// Parameters and moves at the stations of every panel.
    rows: Vec<Vec<(f64, Vec2)>>,
}

impl<'a, 'b> Moves<'a, 'b> {
    fn new(laid: &'b Laid<'a>) -> Self {
        let mut out = Self { laid, rows: Vec::new() };
        let mut here = Vec2::zeros();
        for sheet in 0..laid.len() {
            let mut rows: Vec<(f64, Vec2)> = Vec::new();
            for t in laid.stations(sheet) {
                if let Some((before, _)) = rows.last() {
                    here += out.between(sheet, *before, t);
                }
                rows.push((t, here));
            }
            out.rows.push(rows);
        }
        out
    }

    /// Velocity of the move: `(n'·b) b`.
    fn rate(&self, sheet: usize, t: f64) -> Vec2 {
        let Some(patch) = self.laid.patch(sheet) else { return Vec2::zeros() };
        let j = patch.jet(t, 0.5);
        let [p, q] = self.laid.ruling_in_space(sheet, t);
        let [a, b] = self.laid.ruling(sheet, t);
        let (Some(e), Some(way)) = ((q - p).try_normalize(0.0), (b - a).try_normalize(0.0)) else {
            return Vec2::zeros();
        };
        let across = j.du - e * e.dot(&j.du);
        let speed = across.norm();
        // The side of the flat ruling to which it goes on, and with that the normal towards the eye.
        let step = STEP * self.rows_range(sheet);
        let [c, d] = self.laid.ruling(sheet, t + step);
        let onwards = way.perp(&((c + d) - (a + b))).signum();
        let n = e.cross(&across) * (onwards / speed);
        let rate = -n.dot(&j.duu) / speed;
        if rate.is_finite() {
            Vec2::new(-way.y, way.x) * (onwards * rate)
        } else {
            Vec2::zeros()
        }
    }

    fn rows_range(&self, sheet: usize) -> f64 {
        self.laid.patch(sheet).map_or(0.0, |p| p.knots_u.domain().1 - p.knots_u.domain().0)
    }

    fn between(&self, sheet: usize, a: f64, b: f64) -> Vec2 {
        let part = |f: fn(Vec2) -> f64| GAUSS_4.integrate(a, b, &mut |t| f(self.rate(sheet, t)));
        Vec2::new(part(|v| v.x), part(|v| v.y))
    }

    /// Move of the ruling through a point of the drawing; zero where there is none.
    fn at(&self, q: &Vec2) -> Vec2 {
        let Some(spot) = self.laid.spot(q) else { return Vec2::zeros() };
        let rows = &self.rows[spot.panel];
        let k = rows.partition_point(|r| r.0 <= spot.t).clamp(1, rows.len());
        let Some((t, move_)) = rows.get(k - 1) else { return Vec2::zeros() };
        move_ + self.between(spot.panel, *t, spot.t)
    }
}

/// Share of a panel's rulings by which the direction onwards is looked for.
const STEP: f64 = 1e-5;
/// Points on every line or arc of an outline.
const POINTS: usize = 8;
/// Share of a line or arc by which derivatives are taken: the cube root of what rounding leaves of places found by iteration.
const DIFFERENCE: f64 = 1e-3;

/// A moved stretch of an outline between two corners: cubic pieces through moved points with their tangents, over the
/// length of the outline as it was.
struct MovedStretch {
    knots: Vec<f64>,
    points: Vec<Vec2>,
    tangents: Vec<Vec2>,
}

impl MovedStretch {
    fn of(pieces: &[(Vec2, Vec2, f64)], shift: &dyn Fn(&Vec2) -> Vec2) -> Self {
        let mut out = Self { knots: Vec::new(), points: Vec::new(), tangents: Vec::new() };
        let mut start = 0.0;
        for (k, (a, b, bulge)) in pieces.iter().enumerate() {
            let length = (b - a).norm() * stretch(*bulge);
            let last = usize::from(k + 1 == pieces.len());
            for i in 0..POINTS + last {
                let s = i as f64 / POINTS as f64;
                let moved = |s: f64| {
                    let p = on_piece(a, b, *bulge, s);
                    p + shift(&p)
                };
                let (lo, hi) = ((s - DIFFERENCE).max(0.0), (s + DIFFERENCE).min(1.0));
                let (p, before, after) = (moved(s), moved(lo), moved(hi));
                // At the ends of a piece the difference is one-sided, with the middle for a second order.
                let slope = match (lo < s, s < hi) {
                    (true, true) => (after - before) / (hi - lo),
                    (false, _) => (moved(0.5 * (s + hi)) * 4.0 - p * 3.0 - after) / (hi - s),
                    (_, false) => (p * 3.0 - moved(0.5 * (lo + s)) * 4.0 + before) / (s - lo),
                };
                out.knots.push(start + length * s);
                out.points.push(p);
                out.tangents.push(slope / length);
            }
            start += length;
        }
        out
    }

    /// Index of the piece and share of the way along it.
    fn locate(&self, s: f64) -> (usize, f64) {
        let at = s * self.knots[self.knots.len() - 1];
        let k = self.knots.partition_point(|x| *x <= at).clamp(1, self.knots.len() - 1) - 1;
        (k, ((at - self.knots[k]) / (self.knots[k + 1] - self.knots[k])).clamp(0.0, 1.0))
    }
}

impl PlaneCurve for MovedStretch {
    fn place(&self, s: f64) -> Vec2 {
        let (k, x) = self.locate(s);
        let h = self.knots[k + 1] - self.knots[k];
        let (p, q, d, e) = (self.points[k], self.points[k + 1], self.tangents[k] * h, self.tangents[k + 1] * h);
        let (y, xx) = (1.0 - x, x * x);
        p * (y * y * (1.0 + 2.0 * x)) + q * (xx * (3.0 - 2.0 * x)) + d * (x * y * y) - e * (xx * y)
    }

    fn velocity(&self, s: f64) -> Vec2 {
        let (k, x) = self.locate(s);
        let h = self.knots[k + 1] - self.knots[k];
        let (p, q, d, e) = (self.points[k], self.points[k + 1], self.tangents[k] * h, self.tangents[k + 1] * h);
        let y = 1.0 - x;
        let v = (q - p) * (6.0 * x * y) + d * (y * (1.0 - 3.0 * x)) + e * (x * (3.0 * x - 2.0));
        v * (self.knots[self.knots.len() - 1] / h)
    }
}

/// Length of an arc over that of its chord.
fn stretch(bulge: f64) -> f64 {
    let half = 2.0 * bulge.abs().atan();
    if half.sin() > 0.0 {
        half / half.sin()
    } else {
        1.0
    }
}

/// Point of a line or arc at a share of its length.
fn on_piece(a: &Vec2, b: &Vec2, bulge: f64, s: f64) -> Vec2 {
    let chord = b - a;
    if bulge == 0.0 {
        return a + chord * s;
    }
    let sweep = 4.0 * bulge.atan();
    let centre = (a + b) * 0.5 + Vec2::new(-chord.y, chord.x) * (0.25 * (1.0 / bulge - bulge));
    let (v, (sin, cos)) = (a - centre, (sweep * s).sin_cos());
    centre + Vec2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

/// The pattern of the surface at a distance (mm, positive towards the outside of the model) from the panels of a part, with
/// outlines within `tolerance` (mm). The pattern itself where the distance is 0.
///
/// *Guarantee*: corners and rulings are moved by the quadrature above, to rounding where panels are exactly developable.
/// *Measured, not proven*: `contour_error`, which is that of the outline as it was and that of the new arcs. Folds without
/// radius move nothing. Lengths of sides are not known any more.
pub(crate) fn offset_pattern(laid: &Laid, pattern: &Pattern, distance: f64, tolerance: f64) -> Pattern {
    if distance == 0.0 {
        return pattern.clone();
    }
    let towards = if pattern.view == ViewSide::Outside { distance } else { -distance };
    let moves = Moves::new(laid);
    let shift = |q: &Vec2| moves.at(q) * towards;
    let moved = |runs: &[Vec<(Vec2, Vec2, f64)>]| -> (Vec<ContourVertex>, f64) {
        let (mut vertices, mut error) = (Vec::new(), 0.0_f64);
        for run in runs {
            let (pieces, off) = arcs(&MovedStretch::of(run, &shift), tolerance);
            error = error.max(off);
            let vertex = |(k, p): (usize, &ArcPiece)| ContourVertex { point: p.point, bulge: p.bulge, corner: k == 0 };
            vertices.extend(pieces.iter().enumerate().map(vertex));
        }
        (vertices, error)
    };
    let (contours, errors): (Vec<Contour>, Vec<f64>) = pattern
        .contours
        .iter()
        .map(|c| moved(&runs(&c.vertices, true)))
        .map(|(vertices, off)| (Contour { vertices }, off))
        .unzip();
    let error = errors.into_iter().fold(0.0, f64::max);
    let line = |[a, b]: &[Vec2; 2]| {
        let d = shift(&((a + b) * 0.5));
        [a + d, b + d]
    };
    let marked = |s: &MarkLine| {
        let mut joints = moved(&runs(&s.joints, s.closed)).0;
        // An open line has a last joint that nothing leaves.
        let last = s.joints.last().filter(|_| !s.closed);
        joints.extend(last.map(|j| ContourVertex { point: j.point + shift(&j.point), ..*j }));
        MarkLine { joints, ..s.clone() }
    };
    let rectangle = rectangle_around(&contours);
    Pattern {
        area: contours.iter().map(contour_area).sum(),
        rulings: pattern.rulings.iter().map(line).collect(),
        extents: pattern.extents.iter().map(line).collect(),
        sections: pattern.sections.iter().map(marked).collect(),
        curves: pattern.curves.iter().map(marked).collect(),
        marks: pattern.marks.iter().map(|m| Mark { point: m.point + shift(&m.point), ..m.clone() }).collect(),
        sides: Vec::new(),
        contour_error: pattern.contour_error + error,
        width: rectangle.as_ref().map_or(pattern.width, |r| r.width),
        length: rectangle.as_ref().map_or(pattern.length, |r| r.length),
        contours,
        ..pattern.clone()
    }
}

/// Lines and arcs between joints from corner to corner; of a closed contour without corners, from its first joint.
fn runs(v: &[ContourVertex], closed: bool) -> Vec<Vec<(Vec2, Vec2, f64)>> {
    let first = v.iter().position(|v| v.corner).filter(|_| closed).unwrap_or(0);
    let mut out: Vec<Vec<(Vec2, Vec2, f64)>> = Vec::new();
    for k in 0..v.len() - usize::from(!closed && !v.is_empty()) {
        let (a, b) = (&v[(first + k) % v.len()], &v[(first + k + 1) % v.len()]);
        if a.point == b.point {
            continue;
        }
        match out.last_mut() {
            Some(run) if !a.corner => run.push((a.point, b.point, a.bulge)),
            _ => out.push(vec![(a.point, b.point, a.bulge)]),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::shop::specimens::{cone, cylinder, part_of, pattern_of};

    #[test]
    fn a_cylinder_becomes_as_long_as_its_neutral_fibre() {
        let turn = 1.3;
        for (side, over) in [(1.0, false), (-1.0, false), (1.0, true)] {
            let (patchwork, pattern) = pattern_of(vec![cylinder("a", 0.0, turn)], side);
            let pattern = if over { pattern.turned_over() } else { pattern };
            // The side towards the eye is hollow where lines bend up.
            let hollow = pattern.bends[0].sense == crate::patchwork::pattern::BendSense::Up;
            let outside = (pattern.view == ViewSide::Outside) != hollow;
            let radius = if outside { 103.0 } else { 97.0 };
            let laid = Laid::of(&patchwork, &part_of(1), &pattern).expect("maps");
            let moved = offset_pattern(&laid, &pattern, 3.0, 1e-4);
            assert!((moved.length - radius * turn).abs() < 1e-7, "{} {}", moved.length, radius * turn);
            assert!((moved.width - 80.0).abs() < 1e-9 && moved.contours[0].vertices.len() == 4);
            assert!((moved.area - 80.0 * radius * turn).abs() < 1e-5 * moved.area);
        }
    }

    #[test]
    fn the_offset_of_a_cone_is_a_cone() {
        // The offset cone has the same angle; its apex lies d / sin(half angle) behind, its slants are shifted by
        // d / tan(half angle).
        let turn = 1.5;
        let (patchwork, pattern) = pattern_of(vec![cone("a", 0.0, 0.8), cone("b", 0.8, turn)], 1.0);
        let laid = Laid::of(&patchwork, &part_of(2), &pattern).expect("maps");
        let hollow = pattern.bends[0].sense == crate::patchwork::pattern::BendSense::Up;
        let d = 2.0;
        let moved = offset_pattern(&laid, &pattern, if hollow { -d } else { d }, 1e-4);
        let half = (50.0f64 / 100.0).atan();
        let (inner, outer) = (50.0 / half.sin(), 100.0 / half.sin());
        let more = d / half.tan();
        let angle = turn * half.sin();
        let area = 0.5 * angle * ((outer + more).powi(2) - (inner + more).powi(2));
        assert!((moved.area / area - 1.0).abs() < 1e-6, "{} {area}", moved.area);
        assert!(moved.contour_error < 3e-3);
        let chord = (moved.contours[0].vertices.iter()).map(|v| v.point);
        let far = chord.clone().flat_map(|p| chord.clone().map(move |q| (p - q).norm())).fold(0.0, f64::max);
        let (a, b) = (inner + more, outer + more);
        assert!((far - (a * a + b * b - 2.0 * a * b * angle.cos()).sqrt()).abs() < 1e-6, "{far}");
        // Rulings keep their lengths and angles.
        let way = |r: &[Vec2; 2]| r[1] - r[0];
        assert!(moved.rulings.iter().zip(&pattern.rulings).all(|(a, b)| (way(a) - way(b)).norm() < 1e-9));
    }
}
