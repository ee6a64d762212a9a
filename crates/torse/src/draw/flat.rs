//! Flat patterns as polylines on the sheet, for pictures. Cutting files keep the arcs; this does not.

use crate::geom::polygon::{distance, inside};
use crate::geom::Vec2;
use crate::patchwork::pattern::{Bend, Contour, MarkLine, Pattern, ViewSide};

/// A pattern placed on the sheet, drawn with straight pieces. Lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatPiece {
    /// Index of the panel.
    pub panel: usize,
    /// Name of the panel.
    pub name: String,
    /// Closed outlines, outer first; the last point is joined to the first.
    pub outlines: Vec<Vec<Vec2>>,
    /// Rulings.
    pub rulings: Vec<[Vec2; 2]>,
    /// How the sheet bends about each.
    pub bends: Vec<Bend>,
    /// Lines where bent zones begin and end.
    pub extents: Vec<[Vec2; 2]>,
    /// Outlines of formed features.
    pub formed: Vec<Vec<Vec2>>,
    /// Lines in which planes cut the part.
    pub sections: Vec<Vec<Vec2>>,
    /// Curves of the model that lie on the part.
    pub curves: Vec<Vec<Vec2>>,
    /// Side of the model from which the pattern is seen.
    pub view: ViewSide,
    /// Matching marks: place, unit vector into the panel.
    pub marks: Vec<[Vec2; 2]>,
    /// Centre of a large circle inside the outline: place of the name.
    pub label: Vec2,
    /// Radius of that circle.
    pub room: f64,
    /// Whether the pattern must not be cut: it is not certified.
    pub marked: bool,
}

/// Patterns rotated (rad, counter-clockwise) and then moved, arcs replaced by chords at most `chord_error` (mm)
/// away from them. Patterns without a placement stay where they are.
pub(crate) fn pieces(patterns: &[Pattern], placements: &[(f64, Vec2)], chord_error: f64) -> Vec<FlatPiece> {
    patterns
        .iter()
        .enumerate()
        .map(|(i, pattern)| {
            let (angle, offset) = placements.get(i).copied().unwrap_or((0.0, Vec2::zeros()));
            let (sin, cos) = angle.sin_cos();
            let turn = |v: Vec2| Vec2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
            let place = |p: Vec2| turn(p) + offset;
            let points = |c: &Contour| contour_points(c, chord_error).into_iter().map(place).collect();
            let line = |l: &MarkLine| line_points(l, chord_error).into_iter().map(place).collect();
            let outlines: Vec<Vec<Vec2>> = pattern.contours.iter().map(points).collect();
            let (label, room) = roomy_place(&outlines);
            FlatPiece {
                panel: pattern.panel,
                name: pattern.name.clone(),
                outlines,
                rulings: pattern.rulings.iter().map(|r| r.map(place)).collect(),
                bends: pattern.bends.clone(),
                extents: pattern.extents.iter().map(|r| r.map(place)).collect(),
                formed: pattern.formed.iter().map(points).collect(),
                sections: pattern.sections.iter().map(line).collect(),
                curves: pattern.curves.iter().map(line).collect(),
                view: pattern.view,
                marks: pattern.marks.iter().map(|m| [place(m.point), turn(m.inward)]).collect(),
                label,
                room,
                marked: false,
            }
        })
        .collect()
}

/// Points of a contour, arcs cut into chords at most `chord_error` (mm) from them.
pub(crate) fn contour_points(contour: &Contour, chord_error: f64) -> Vec<Vec2> {
    // Finer than this no picture shows, and tiny errors asked for must not make millions of points.
    const MOST_CHORDS: f64 = 200.0;
    let n = contour.vertices.len();
    let mut points = Vec::new();
    for (i, v) in contour.vertices.iter().enumerate() {
        let (a, b) = (v.point, contour.vertices[(i + 1) % n].point);
        points.push(a);
        let sagitta = 0.5 * (b - a).norm() * v.bulge.abs();
        if v.bulge == 0.0 || !sagitta.is_finite() || sagitta <= chord_error {
            continue;
        }
        // Chords of angle α lie r (1 − cos(α/2)) inside an arc of radius r.
        let sweep = 4.0 * v.bulge.atan();
        let radius = 0.25 * (b - a).norm() * (v.bulge.abs() + 1.0 / v.bulge.abs());
        let widest = 2.0 * (1.0 - chord_error / radius).clamp(-1.0, 1.0).acos();
        let count = (sweep.abs() / widest.min(0.5)).ceil().min(MOST_CHORDS) as usize;
        let normal = Vec2::new(a.y - b.y, b.x - a.x);
        let centre = (a + b) * 0.5 + normal * ((1.0 - v.bulge * v.bulge) / (4.0 * v.bulge));
        let spoke = a - centre;
        for k in 1..count {
            let (sin, cos) = (sweep * k as f64 / count as f64).sin_cos();
            points.push(centre + Vec2::new(cos * spoke.x - sin * spoke.y, sin * spoke.x + cos * spoke.y));
        }
    }
    points
}

/// Points of a line from its first to its last one, or to the first again of a closed one, arcs cut into chords as of contours.
pub(crate) fn line_points(line: &MarkLine, chord_error: f64) -> Vec<Vec2> {
    let mut points = contour_points(&line.contour(), chord_error);
    if line.closed {
        points.extend(points.first().copied());
    }
    points
}

/// Centre and radius of a large circle inside the outlines, by a grid search refined once. Radius 0 if none was met.
fn roomy_place(outlines: &[Vec<Vec2>]) -> (Vec2, f64) {
    const GRID: usize = 24;
    let Some(first) = outlines.first().and_then(|o| o.first()) else { return (Vec2::zeros(), 0.0) };
    let (mut low, mut high) = (*first, *first);
    for p in outlines.iter().flatten() {
        (low, high) = (low.inf(p), high.sup(p));
    }
    let mut best = ((low + high) * 0.5, 0.0);
    for _ in 0..2 {
        let step = (high - low) / GRID as f64;
        for i in 0..=GRID {
            for j in 0..=GRID {
                let p = Vec2::new(low.x + i as f64 * step.x, low.y + j as f64 * step.y);
                let d = depth_inside(outlines, p);
                if d > best.1 {
                    best = (p, d);
                }
            }
        }
        (low, high) = (best.0 - step, best.0 + step);
    }
    best
}

/// Distance from `p` to the outlines; 0 outside (even-odd).
fn depth_inside(outlines: &[Vec<Vec2>], p: Vec2) -> f64 {
    if !inside(outlines, &p) {
        return 0.0;
    }
    let least = distance(outlines, &p);
    if least.is_finite() {
        least
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::pattern::ContourVertex;

    fn vertex(x: f64, y: f64, bulge: f64) -> ContourVertex {
        ContourVertex { point: Vec2::new(x, y), bulge, corner: true }
    }

    #[test]
    fn two_half_circles_become_a_circle_within_the_chord_error() {
        let circle = Contour { vertices: vec![vertex(-10.0, 0.0, 1.0), vertex(10.0, 0.0, 1.0)] };
        let points = contour_points(&circle, 0.01);
        assert!(points.len() > 20 && points.len() < 200);
        for (i, p) in points.iter().enumerate() {
            assert!((p.norm() - 10.0).abs() < 1e-9);
            let q = points[(i + 1) % points.len()];
            assert!(((p + q) * 0.5).norm() > 10.0 - 0.0101);
        }
        // Counter-clockwise from (−10, 0): the first arc runs below the axis.
        assert!(points[points.len() / 4].y < 0.0);
    }

    #[test]
    fn the_name_sits_in_the_wide_part_beside_the_hole() {
        let ring = |x: f64, y: f64, w: f64, h: f64| {
            vec![Vec2::new(x, y), Vec2::new(x + w, y), Vec2::new(x + w, y + h), Vec2::new(x, y + h)]
        };
        let (place, room) = roomy_place(&[ring(0.0, 0.0, 30.0, 10.0), ring(1.0, 1.0, 8.0, 8.0)]);
        assert!(place.x > 10.0 && room > 4.0, "{place} {room}");
    }
}
