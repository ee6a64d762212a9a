//! The flat cutting pattern of a panel: outline of lines and arcs, rulings, matching marks, measures.
//!
//! Method: the isometric map of `map`, biarcs of `arcs`; conventions of the drawing as in the users' survey, section
//! 3.1 (closed contours, arcs instead of many points, seams marked on both neighbours at equal places).

use super::arcs::{self, PlaneCurve};
use super::bends::{self, BendSpacing, DevelopedRuling, Plane, ProfileLine, TurnProfile};
use super::map::Development;
use super::outline::{outside, FlatCoedge};
use super::overlap::{overlap, OutlinePoint};
use super::DevelopError;
use crate::geom::rectangle::smallest_rectangle;
use crate::geom::{Vec2, Vec3};
use crate::num::parallel;
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Border, Coedge, Panel, Patchwork};
use crate::patchwork::pattern::{Bend, Contour, ContourVertex, Mark, MarkPlace, Pattern, Side, ViewSide};
use crate::patchwork::seam::Seam;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;

/// Knobs of [`pattern`].
#[derive(Clone, Copy, Debug)]
pub struct PatternOptions {
    /// Distance allowed between the contour drawn and the exact outline, mm; no default (a tenth of the job's
    /// tolerance at most).
    pub contour_tolerance: f64,
    /// How far apart rulings are drawn; default every 5° of turn, within a hundredth and a twentieth of the length.
    pub bends: BendSpacing,
    /// Distance between matching marks as a share of the face's diagonal; default 0.12. Every seam gets 1 to 9.
    pub mark_spacing: f64,
}

impl PatternOptions {
    /// Defaults with a contour tolerance (mm).
    pub fn new(contour_tolerance: f64) -> Self {
        Self { contour_tolerance, bends: BendSpacing::default(), mark_spacing: MARK_SPACING }
    }
}

/// Distance between marks as a share of the face's diagonal.
pub(super) const MARK_SPACING: f64 = 0.12;
/// Share of the pattern's size by which points must be apart in space to overlap in the plane.
const APART: f64 = 1e-3;
/// Rulings shorter than this share of the pattern are not drawn.
const SHORTEST_RULING: f64 = 0.01;

/// Develops one panel, seen from the outside of its face.
///
/// *Guarantee*: contours are closed, the outer one counter-clockwise, holes clockwise; ends of runs are exact images;
/// marks of both sides of a seam belong to the same points of the face's border polyline.
/// *Measured, not proven*: `isometry_error` (greatest strain at stations of the map, on both boundary curves, in the
/// middle and along the outline), `contour_error` (48 samples per biarc, plus 2 %).
///
/// # Errors
/// A patch that is not regular; a pattern that overlaps itself, with the ruling to cut along.
#[expect(clippy::too_many_lines, reason = "one pattern, part by part")]
pub fn pattern(patchwork: &Patchwork, panel: usize, options: &PatternOptions) -> Result<Pattern, DevelopError> {
    let missing = DevelopError::Missing(panel);
    let (Some(p), index) = (patchwork.panels.get(panel), panel) else { return Err(missing) };
    let (Some(face), Some(partition)) = (patchwork.face_of(p), patchwork.partition_of(p)) else {
        return Err(missing);
    };
    // 1. Map to the plane, seen from outside.
    let place = |v: u32| {
        let [u, v] = partition.vertices[v as usize];
        face.surface.point(u, v)
    };
    let (development, side) = developed(patchwork, p)?;
    let loops: Vec<Vec<FlatCoedge>> = p
        .loops()
        .iter()
        .map(|l| l.iter().filter(|r| !r.is_point()).map(|r| FlatCoedge::new(&development, &p.strip.patch, r)).collect())
        .collect();
    let outer = loops.first().filter(|l| !l.is_empty()).ok_or(missing)?;
    // 2. Samples of the outline: measures, overlap.
    let samples: Vec<Vec<OutlinePoint>> =
        loops.iter().map(|l| l.iter().flat_map(|r| r.samples(&p.strip.patch, 6, 48)).collect()).collect();
    let flat: Vec<Vec2> = samples[0].iter().map(|s| s.flat).collect();
    let rectangle = smallest_rectangle(&flat).ok_or(DevelopError::Missing(index))?;
    if let Some((a, b)) = overlap(&samples, (APART * rectangle.length).max(4.0 * options.contour_tolerance)) {
        return Err(DevelopError::Overlap { t: 0.5 * (a + b) });
    }
    let origin = flat[0];
    let flat_area: f64 = loops.iter().flatten().map(|r| r.flat_area(&origin)).sum();
    let area_in_space: f64 = loops.iter().flatten().map(|r| r.area_in_space(&p.strip.patch)).sum();
    // Loops run with the material on their left on the parameter plane, which is seen from behind if the face's
    // normal is reversed.
    let mirrored = flat_area < 0.0;
    // 3. Contours.
    let mut contour_error = 0.0_f64;
    let mut contours = Vec::new();
    for l in &loops {
        let mut vertices = Vec::new();
        for run in l {
            let (pieces, error) = arcs::arcs(run, options.contour_tolerance);
            contour_error = contour_error.max(error);
            for (k, piece) in pieces.iter().enumerate() {
                vertices.push(ContourVertex { point: piece.point, bulge: piece.bulge, corner: k == 0 });
            }
        }
        if mirrored {
            vertices = reversed(&vertices);
        }
        contours.push(Contour { vertices });
    }
    let size = arcs::rectangle_around(&contours).unwrap_or(rectangle);
    // 4. Rulings, marks, sides.
    let (rulings, bends) = if p.strip.kind == PanelKind::Plane {
        (Vec::new(), Vec::new())
    } else {
        let insets = [contour_error, SHORTEST_RULING * rectangle.length];
        bend_lines(&development, p, side, (&options.bends, rectangle.length), insets)
    };
    let spacing = options.mark_spacing * face.surface.bbox().diagonal();
    let mut marks = Vec::new();
    let shared: Vec<Seam> = patchwork
        .seams()
        .into_iter()
        .filter(|s| s.sides.iter().any(|side| side.panel == index) && s.is_shared())
        .collect();
    for run in loops.iter().flatten() {
        if let Border::Seam { seam, forward } = run.run.border {
            for (k, s) in mark_places(run.run, forward, &place, spacing) {
                let t = run.velocity(s);
                let t = if mirrored { -t } else { t };
                let n = Vec2::new(-t.y, t.x);
                let norm = n.norm();
                if norm > 0.0 {
                    // Where panels meet, the angle to which they are joined is of use beside the mark.
                    let along = if forward { s } else { 1.0 - s };
                    let kink = shared.iter().find(|c| c.seam == seam).map(|c| c.kink(along).to_degrees());
                    let angle = kink.map_or_else(String::new, |a| format!(" {a:.1}deg"));
                    let label = format!("S{seam}.{k}{angle}");
                    marks.push(Mark { point: run.place(s), inward: n / norm, label, on: MarkPlace::Seam, apart: 0.0 });
                }
            }
        }
    }
    let mut sides: Vec<Side> = outer
        .iter()
        .map(|r| Side { border: r.run.border, middle: r.place(r.half_way()), length: r.length() })
        .collect();
    if mirrored {
        sides.reverse();
    }
    Ok(Pattern {
        panel,
        name: p.strip.name.clone(),
        contours,
        view: ViewSide::Outside,
        rulings,
        bends,
        extents: Vec::new(),
        formed: Vec::new(),
        sections: Vec::new(),
        curves: Vec::new(),
        marks,
        sides,
        area: flat_area.abs(),
        area_in_space: area_in_space.abs(),
        isometry_error: isometry_error(&development, p),
        contour_error,
        width: size.width,
        length: size.length,
    })
}

/// The map of a panel to the plane, seen from the side to which its face looks, and what that side is for
/// [`Development::new`].
pub(super) fn developed(patchwork: &Patchwork, panel: &Panel) -> Result<(Development, f64), DevelopError> {
    let face = patchwork.face_of(panel).ok_or(DevelopError::Missing(panel.face().unwrap_or_default()))?;
    let side = outside(panel, face);
    Ok((Development::new(&panel.strip.patch, side)?, side))
}

/// Patterns of [`pattern`] with rulings drawn at the distances that are wanted.
pub(crate) fn with_bends(patchwork: &Patchwork, patterns: Vec<Pattern>, spacing: &BendSpacing) -> Vec<Pattern> {
    parallel::map(patterns, |pattern| bends_anew(patchwork, pattern, spacing))
}

/// A pattern with its rulings drawn at other distances.
fn bends_anew(patchwork: &Patchwork, pattern: Pattern, spacing: &BendSpacing) -> Pattern {
    let Some(panel) = patchwork.panels.get(pattern.panel).filter(|p| p.strip.kind != PanelKind::Plane) else {
        return pattern;
    };
    let Ok((development, side)) = developed(patchwork, panel) else { return pattern };
    let insets = [pattern.contour_error, SHORTEST_RULING * pattern.length];
    let (rulings, bends) = bend_lines(&development, panel, side, (spacing, pattern.length), insets);
    Pattern { rulings, bends, ..pattern }
}

/// The same contour the other way round.
fn reversed(v: &[ContourVertex]) -> Vec<ContourVertex> {
    let n = v.len();
    (0..n)
        .map(|k| {
            let here = &v[(n - k) % n];
            // The piece that left the vertex before now leaves this one.
            let before = &v[(2 * n - k - 1) % n];
            ContourVertex { point: here.point, bulge: -before.bulge, corner: here.corner }
        })
        .collect()
}

/// Greatest strain found at stations of the map and along the outline.
fn isometry_error(development: &Development, panel: &Panel) -> f64 {
    // Only rulings and stretches that the panel uses: the patch's margins are not cut.
    let (mut t0, mut t1) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut worst = 0.0_f64;
    for run in panel.loops().iter().flatten() {
        for k in 0..=32 {
            let q = run.trim.point(f64::from(k) / 32.0);
            t0 = t0.min(q[0]);
            t1 = t1.max(q[0]);
            worst = worst.max(development.strain(q[0], q[1]));
        }
    }
    for t in development.stations().filter(|t| *t >= t0 && *t <= t1) {
        for r in [0.05, 0.5, 0.95] {
            worst = worst.max(development.strain(t, r));
        }
    }
    worst
}

/// Marks of a run: number within the seam and parameter on this run. Both sides find the same points of the shared
/// polyline, at equal steps of its length in space.
fn mark_places(run: &Coedge, forward: bool, place: &dyn Fn(u32) -> Vec3, spacing: f64) -> Vec<(usize, f64)> {
    let n = run.vertices.len();
    let order = |k: usize| if forward { k } else { n - 1 - k };
    let points: Vec<Vec3> = (0..n).map(|k| place(run.vertices[order(k)])).collect();
    let mut at = vec![0.0];
    for w in points.windows(2) {
        at.push(at[at.len() - 1] + (w[1] - w[0]).norm());
    }
    let total = at[n - 1];
    let count = (total / spacing.max(f64::MIN_POSITIVE)).round().clamp(1.0, 9.0) as usize;
    (1..=count)
        .map(|k| {
            let l = total * k as f64 / (count + 1) as f64;
            let i = at.partition_point(|&a| a <= l).clamp(1, n - 1);
            let step = at[i] - at[i - 1];
            let x = if step > 0.0 { (l - at[i - 1]) / step } else { 0.0 };
            let (a, b) = (run.parameters[order(i - 1)], run.parameters[order(i)]);
            (k, a + (b - a) * x)
        })
        .collect()
}

/// Places between two knots of the patch, and at least, where the tangent plane is followed.
const PLACES: (usize, usize) = (4, 200);

/// Rulings to be drawn, clipped to the outline and shortened at both ends, with how the sheet bends about each; `side`
/// is that of the development, `spacing` comes with the length of the pattern, `insets` say by how much lines are
/// shortened and which are too short (mm).
fn bend_lines(
    development: &Development,
    panel: &Panel,
    side: f64,
    spacing: (&BendSpacing, f64),
    insets: [f64; 2],
) -> (Vec<[Vec2; 2]>, Vec<Bend>) {
    let clipped = ClippedRulings::new(panel);
    let (t0, t1) = clipped.range();
    let mut ends = vec![t0];
    ends.extend(panel.strip.patch.knots_u.breaks().into_iter().filter(|&t| t > t0 && t < t1));
    ends.push(t1);
    let parts = PLACES.0.max(PLACES.1.div_ceil(ends.len()));
    let patch = &panel.strip.patch;
    let mut profile = TurnProfile::new();
    let mut before: Option<(f64, Plane, Vec3)> = None;
    for w in ends.windows(2) {
        for k in usize::from(before.is_some())..=parts {
            let t = w[0] + (w[1] - w[0]) * k as f64 / parts as f64;
            let Some(plane) = Plane::of(patch, t, 0.5, side) else { continue };
            let x = patch.point(t, 0.5);
            let (turn, length) = before.map_or(((0.0, None), 0.0), |(s, p, y)| {
                let turn = bends::turn_between(patch, [s, t], side, p.turn(&plane));
                (turn, (x - y).dot(&plane.across).abs())
            });
            profile.push(t, turn, length);
            before = Some((t, plane, x));
        }
    }
    let place = |line: &ProfileLine| profile.around(line.after).map(|[a, b]| a + (b - a) * line.share);
    let exact = |line: &ProfileLine, _| ruling(development, patch, place(line)?, side);
    let draw = |asked: &BendSpacing| {
        let (mut rulings, mut bent) = (Vec::new(), Vec::new());
        for line in bends::dense(&profile, profile.lines(asked, spacing.1), asked, spacing.1, &exact) {
            let Some(t) = place(&line) else { continue };
            for (r0, r1) in clipped.at(t) {
                let (a, b) = (development.map(t, r0), development.map(t, r1));
                let length = (b - a).norm();
                if length > insets[1] + 2.0 * insets[0] {
                    let d = (b - a) * (insets[0] / length);
                    rulings.push([a + d, b - d]);
                    bent.push(line.bend([[r0, r1].map(|r| bends::radius(patch, t, r)); 2]));
                }
            }
        }
        (rulings, bent)
    };
    bends::kept_low(spacing.0, draw)
}

/// A ruling of a patch with its image; `side` is that of the development.
pub(super) fn ruling(development: &Development, patch: &Surface, t: f64, side: f64) -> Option<DevelopedRuling> {
    let Plane { normal, across } = Plane::of(patch, t, 0.5, side)?;
    Some(DevelopedRuling {
        flat: [0.0, 1.0].map(|r| development.map(t, r)),
        space: [0.0, 1.0].map(|r| patch.point(t, r)),
        across,
        normal,
        radii: [0.0, 1.0].map(|r| bends::radius(patch, t, r)),
    })
}
