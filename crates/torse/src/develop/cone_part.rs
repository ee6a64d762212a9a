//! Flat patterns of trimmed cone splines: the outline through the exact development of every piece \[LP98\], drawn with
//! true arcs.

use super::arcs::{arcs, rectangle_around, PlaneCurve};
use super::cones::{develop, FlatSegment};
use super::overlap::{overlap, OutlinePoint};
use crate::geom::Vec2;
use crate::patchwork::panel::Border;
use crate::patchwork::pattern::{Contour, ContourVertex, Pattern, Side};
use crate::spline::curve::Curve;
use crate::torse::cone::chart::Blank;
use crate::torse::cone::part::{ConePart, PartCurve};
use crate::torse::cone::spline::ConeSpline;

/// An edge in the plane.
struct FlatEdge<'a> {
    blank: &'a Blank,
    flat: &'a FlatSegment,
    trim: &'a Curve<2>,
    forward: bool,
}

impl PlaneCurve for FlatEdge<'_> {
    fn place(&self, s: f64) -> Vec2 {
        let ([f, r], _) = self.blank.coordinates(self.trim.point(if self.forward { s } else { 1.0 - s }));
        self.flat.point(f, r)
    }

    fn velocity(&self, s: f64) -> Vec2 {
        let [q, d, _] = self.trim.jet(if self.forward { s } else { 1.0 - s });
        let ([f, r], [df, dr]) = self.blank.coordinates(q);
        let v = self.flat.derivatives(f, r);
        (v[0] * (df * d[0]) + v[1] * (dr * d[1])) * if self.forward { 1.0 } else { -1.0 }
    }
}

/// Number of the border along a joint at which a chain was cut.
const CUT: u32 = u32::MAX;
/// Samples of an edge where overlaps are sought.
const SAMPLES: usize = 12;
/// Turn between two edges of one border that is still smooth, rad: fitted edges meet with less.
const SMOOTH: f64 = 0.05;

/// The cutting pattern of a trimmed chain: outer contour and holes of lines and true arcs within `contour_tolerance`
/// (mm) of the exact image, without bend lines. The plane is seen from the side of the normals.
///
/// *Guarantee*: exact isometry of every piece. *Not guaranteed*: that the pattern does not overlap itself, see
/// [`overlaps`].
pub(crate) fn part_pattern(spline: &ConeSpline, part: &ConePart, name: &str, contour_tolerance: f64) -> Pattern {
    let flats = develop(spline, Vec2::zeros(), 0.0);
    let place = |v: usize| {
        let (i, [f, r]) = part.places[v];
        flats.get(i).map_or_else(Vec2::zeros, |s| s.point(f, r))
    };
    let mut pattern = Pattern { name: name.to_owned(), ..Pattern::default() };
    let mut contours: Vec<(f64, Contour, Vec<Side>)> = Vec::new();
    for cycle in part.outline() {
        let mut vertices: Vec<ContourVertex> = Vec::new();
        let mut sides: Vec<Side> = Vec::new();
        let mut before: Option<(u32, Vec2)> = None;
        for (k, forward) in cycle {
            let e = &part.edges[k];
            let (a, b) = if forward { (place(e.start), place(e.end)) } else { (place(e.end), place(e.start)) };
            let number = e.border.unwrap_or(CUT);
            let first = vertices.len();
            let (length, tangents, middle);
            match &e.curve {
                PartCurve::Ruling => {
                    vertices.push(ContourVertex { point: a, bulge: 0.0, corner: true });
                    (length, tangents, middle) = ((b - a).norm(), [b - a; 2], (a + b) * 0.5);
                }
                PartCurve::Free { face, trim, .. } => {
                    let piece = &part.faces[*face];
                    let edge = FlatEdge { blank: &piece.blank, flat: &flats[piece.segment], trim, forward };
                    let (list, off) = arcs(&edge, contour_tolerance);
                    pattern.contour_error = pattern.contour_error.max(off);
                    vertices.extend(list.iter().enumerate().map(|(i, p)| ContourVertex {
                        point: if i == 0 { a } else { p.point },
                        bulge: p.bulge,
                        corner: i == 0,
                    }));
                    tangents = [edge.velocity(0.0), edge.velocity(1.0)];
                    middle = edge.place(0.5);
                    let at = |i: usize| edge.place(i as f64 / SAMPLES as f64);
                    length = (0..SAMPLES).map(|i| (at(i + 1) - at(i)).norm()).sum();
                }
            }
            if let Some((same, t)) = before {
                let turn = t.perp(&tangents[0]).atan2(t.dot(&tangents[0]));
                if same == number && turn.abs() < SMOOTH {
                    vertices[first].corner = false;
                }
            }
            before = Some((number, tangents[1]));
            match sides.last_mut() {
                Some(s) if s.border == (Border::Trim { edge: number }) => s.length += length,
                _ => sides.push(Side { border: Border::Trim { edge: number }, middle, length }),
            }
        }
        let contour = Contour { vertices };
        contours.push((super::cones::area(&contour.vertices), contour, sides));
    }
    contours.sort_by(|a, b| b.0.total_cmp(&a.0));
    pattern.area = contours.iter().map(|c| c.0).sum();
    pattern.area_in_space = pattern.area;
    for (i, (_, contour, sides)) in contours.into_iter().enumerate() {
        if i == 0 {
            pattern.sides = sides;
        }
        pattern.contours.push(contour);
    }
    if let Some(r) = rectangle_around(&pattern.contours) {
        (pattern.width, pattern.length) = (r.width, r.length);
    }
    pattern
}

/// Whether the flat pattern of a trimmed chain overlaps itself (outline sampled; `apart` as in `overlap`).
pub(crate) fn overlaps(spline: &ConeSpline, part: &ConePart, apart: f64) -> bool {
    let flats = develop(spline, Vec2::zeros(), 0.0);
    let loops: Vec<Vec<OutlinePoint>> = part
        .outline()
        .iter()
        .map(|cycle| {
            let mut run = Vec::new();
            for &(k, forward) in cycle {
                let e = &part.edges[k];
                let v = if forward { e.start } else { e.end };
                let (i, [f, r]) = part.places[v];
                let at = |i: usize, f: f64, r: f64| {
                    flats.get(i).zip(spline.segments.get(i)).map(|(flat, s)| OutlinePoint {
                        flat: flat.point(f, r),
                        space: s.point(f, r),
                        t: i as f64 + f,
                    })
                };
                run.extend(at(i, f, r));
                if let PartCurve::Free { face, trim, .. } = &e.curve {
                    let piece = &part.faces[*face];
                    run.extend((1..SAMPLES).filter_map(|j| {
                        let s = j as f64 / SAMPLES as f64;
                        let ([f, r], _) = piece.blank.coordinates(trim.point(if forward { s } else { 1.0 - s }));
                        at(piece.segment, f, r)
                    }));
                }
            }
            run
        })
        .collect();
    overlap(&loops, apart).is_some()
}
