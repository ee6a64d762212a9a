//! The flat pattern of a chain of untrimmed strips that share rulings, by the isometric map of `map` \[DC76\].
//!
//! Every strip is developed by itself and moved so that its first ruling falls on the last ruling of the strip
//! before. Outline as lines and arcs, rulings, marks at equal lengths along both rails.

use super::arcs::{self, PlaneCurve};
use super::bends::{self, DevelopedRuling, Plane, ProfileLine, TurnProfile};
use super::map::Development;
use super::overlap::{overlap, OutlinePoint};
use super::view::Drawn;
use super::DevelopError;
use crate::geom::rectangle::smallest_rectangle;
use crate::geom::Vec2;
use crate::num::quadrature::GAUSS_4;
use crate::patchwork::panel::Border;
use crate::patchwork::pattern::{Bend, Contour, ContourVertex, Mark, MarkPlace, Pattern, Side, ViewSide};
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Knobs of [`pattern`].
#[derive(Clone, Copy, Debug)]
pub struct StripOptions {
    /// Distance allowed between the contour drawn and the exact outline, mm; no default (a tenth of the job's
    /// tolerance at most).
    pub contour_tolerance: f64,
    /// Distance between the rulings drawn, mm along the middle of the pattern; default none: as `drawn` says.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks along each rail, mm; default none: 8 over its length. 0 for no marks.
    pub mark_spacing: Option<f64>,
    /// +1 to see the pattern from the side to which ruling × rail points, −1 from the other; default 1.
    pub side: f64,
    /// How patterns are drawn; their side of the model is that of `super::view::viewed`.
    pub drawn: Drawn,
}

impl StripOptions {
    /// Defaults with a contour tolerance (mm).
    pub fn new(contour_tolerance: f64) -> Self {
        Self { contour_tolerance, ruling_spacing: None, mark_spacing: None, side: 1.0, drawn: Drawn::default() }
    }

    /// Options of a job with a tolerance (mm) and the distances that were asked for between rulings and between marks (mm).
    pub(crate) fn of_job(tolerance: f64, [ruling_spacing, mark_spacing]: [Option<f64>; 2], drawn: Drawn) -> Self {
        let drawn = Drawn { bends: drawn.bends.of_job(tolerance), ..drawn };
        Self { ruling_spacing, mark_spacing, drawn, ..Self::new(CONTOUR_SHARE * tolerance) }
    }
}

/// Share of a job's tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Share of the pattern's size by which end rulings of neighbours may differ: beyond rounding they are no chain.
const JOINT: f64 = 1e-6;
/// Share of the pattern's size by which points must be apart in space to overlap in the plane.
const APART: f64 = 1e-3;
/// Turn of the outline (rad) at a joint from which it is called a corner.
const CORNER: f64 = 1e-6;
/// Marks over a pattern where no spacing is given.
const MARKS: f64 = 8.0;
/// Most rulings or marks drawn: more than anybody can use, and no spacing can exhaust the memory.
const MOST_DRAWN: f64 = 4000.0;
/// Lines and marks up to this share of the length are drawn; one beyond would be the end itself, rounded.
const BEFORE_END: f64 = 1.0 - 1e-9;

/// The least distance between rulings or marks on a pattern whose longer side is so long.
pub(crate) fn least_spacing(length: f64) -> f64 {
    length / MOST_DRAWN
}

/// Samples per span for lengths along the middle.
const SAMPLES: usize = 16;
/// Stations over the breadth of a strip where the isometry is measured.
const ACROSS: [f64; 5] = [0.0, 0.05, 0.5, 0.95, 1.0];

/// A strip in the plane: its map and where the chain puts it.
pub(super) struct Laid<'a> {
    pub(super) strip: &'a Strip,
    pub(super) development: Development,
    turn: (f64, f64),
    offset: Vec2,
}

impl Laid<'_> {
    fn vector(&self, v: &Vec2) -> Vec2 {
        let (s, c) = self.turn;
        Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
    }

    /// Motion of the strip's own image within the chain: cosine and sine of the turn, move.
    pub(super) fn motion(&self) -> ([f64; 2], Vec2) {
        ([self.turn.1, self.turn.0], self.offset)
    }

    pub(super) fn map(&self, u: f64, v: f64) -> Vec2 {
        self.vector(&self.development.map(u, v)) + self.offset
    }
}

/// A stretch of an outline: a rail between two knots, or a ruling.
struct Edge<'a, 'b> {
    laid: &'a Laid<'b>,
    from: [f64; 2],
    to: [f64; 2],
}

impl Edge<'_, '_> {
    fn at(&self, s: f64) -> [f64; 2] {
        if s >= 1.0 {
            return self.to;
        }
        [0, 1].map(|k| self.from[k] + (self.to[k] - self.from[k]) * s)
    }

    /// Integral over [0, 1]: in 16 parts or more of 4 Gauss points, none of which crosses a knot.
    fn integral(&self, mut f: impl FnMut(f64) -> f64) -> f64 {
        const PARTS: usize = 16;
        let (from, to) = (self.from[0], self.to[0]);
        let knots = self.laid.strip.patch.knots_u.breaks().into_iter().map(|k| (k - from) / (to - from));
        let mut breaks: Vec<f64> = knots.filter(|s| *s > 0.0 && *s < 1.0).chain([0.0, 1.0]).collect();
        breaks.sort_by(f64::total_cmp);
        let parts = PARTS.div_ceil(breaks.len() - 1).max(2);
        let mut sum = 0.0;
        for w in breaks.windows(2) {
            let at = |k: usize| w[0] + (w[1] - w[0]) * k as f64 / parts as f64;
            sum += (0..parts).map(|k| GAUSS_4.integrate(at(k), at(k + 1), &mut f)).sum::<f64>();
        }
        sum
    }
}

impl PlaneCurve for Edge<'_, '_> {
    fn place(&self, s: f64) -> Vec2 {
        let [u, v] = self.at(s);
        self.laid.map(u, v)
    }

    fn velocity(&self, s: f64) -> Vec2 {
        let [u, v] = self.at(s);
        let d = self.laid.development.tangent(u, v, self.to[0] - self.from[0], self.to[1] - self.from[1]);
        self.laid.vector(&d)
    }
}

/// Develops a chain of strips, each beginning with the ruling that ends the one before, into one pattern.
///
/// `index` and `name` are those of the piece. Marks are labelled A1, A2, … along the rail v = 0 and B1, B2, … along
/// the rail v = 1, at equal lengths from the first ruling.
/// *Guarantee*: the contour is closed and counter-clockwise; corners are exact images.
/// *Measured, not proven*: `isometry_error` (greatest strain at stations of the map), `contour_error`.
///
/// # Errors
/// No strip, a patch that is not regular, neighbours whose rulings differ, a pattern that overlaps itself.
#[expect(clippy::too_many_lines, reason = "one development with its state")]
pub fn pattern(strips: &[&Strip], index: usize, name: &str, options: &StripOptions) -> Result<Pattern, DevelopError> {
    let laid = lay(strips, index, options.side)?;
    let (Some(first), Some(last)) = (laid.first(), laid.last()) else { return Err(DevelopError::Missing(index)) };
    // 1. Outline: rail A, last ruling, rail B backwards, first ruling.
    let rail = |v: f64| {
        let mut edges = Vec::new();
        for l in laid.iter().filter(|l| !l.strip.is_point(v as usize)) {
            let breaks = l.strip.patch.knots_u.breaks();
            edges.extend(smooth_stretches(l, &breaks, v));
        }
        edges
    };
    let along = |l: &Laid| l.strip.domain();
    let mut edges: Vec<(usize, Edge)> = rail(0.0).into_iter().map(|e| (0, e)).collect();
    edges.push((1, Edge { laid: last, from: [along(last).1, 0.0], to: [along(last).1, 1.0] }));
    let back = rail(1.0).into_iter().rev().map(|e| (2, Edge { laid: e.laid, from: e.to, to: e.from }));
    edges.extend(back);
    edges.push((3, Edge { laid: first, from: [along(first).0, 1.0], to: [along(first).0, 0.0] }));

    let samples: Vec<OutlinePoint> = edges.iter().flat_map(|(_, e)| outline_samples(e, strips)).collect();
    let flat: Vec<Vec2> = samples.iter().map(|s| s.flat).collect();
    let rectangle = smallest_rectangle(&flat).ok_or(DevelopError::Missing(index))?;
    if let Some((a, b)) = overlap(&[samples], (APART * rectangle.length).max(4.0 * options.contour_tolerance)) {
        return Err(DevelopError::Overlap { t: 0.5 * (a + b) });
    }
    let origin = flat[0];
    let area: f64 = edges.iter().map(|(_, e)| e.integral(|s| 0.5 * (e.place(s) - origin).perp(&e.velocity(s)))).sum();
    // 2. Contour of lines and arcs.
    let mirrored = area < 0.0;
    let (mut vertices, mut contour_error): (Vec<ContourVertex>, f64) = (Vec::new(), 0.0);
    let mut before: Option<Vec2> = None;
    for (_, e) in &edges {
        let (pieces, error) = arcs::arcs(e, options.contour_tolerance);
        contour_error = contour_error.max(error);
        let turns = before.is_none_or(|d: Vec2| {
            let v = e.velocity(0.0);
            d.perp(&v).atan2(d.dot(&v)).abs() > CORNER
        });
        for (k, p) in pieces.iter().enumerate() {
            vertices.push(ContourVertex { point: p.point, bulge: p.bulge, corner: k == 0 && turns });
        }
        before = Some(e.velocity(1.0));
    }
    if mirrored {
        let n = vertices.len();
        vertices = (0..n)
            .map(|k| {
                let (here, left) = (&vertices[(n - k) % n], &vertices[(2 * n - k - 1) % n]);
                ContourVertex { point: here.point, bulge: -left.bulge, corner: here.corner }
            })
            .collect();
    }
    let contours = vec![Contour { vertices }];
    let size = arcs::rectangle_around(&contours).unwrap_or(rectangle);
    // 3. Rulings, marks, sides.
    let (rulings, bends) = rulings(&laid, options, rectangle.length, contour_error);
    let marks = marks(&laid, options.mark_spacing, if mirrored { -1.0 } else { 1.0 });
    let mut sides: Vec<Side> = Vec::new();
    for side in 0..4u32 {
        let of: Vec<&Edge> = edges.iter().filter(|e| e.0 == side as usize).map(|e| &e.1).collect();
        let length: f64 = of.iter().map(|e| e.integral(|s| e.velocity(s).norm())).sum();
        if let Some(e) = of.get(of.len() / 2) {
            let s = if of.len().is_multiple_of(2) { 0.0 } else { 0.5 };
            sides.push(Side { border: Border::Trim { edge: side }, middle: e.place(s), length });
        }
    }
    if mirrored {
        sides.reverse();
    }
    let isometry_error = laid.iter().fold(0.0_f64, |m, l| {
        let point = [0, 1].map(|side| l.strip.is_point(side));
        l.development.stations().flat_map(|t| ACROSS.map(|v| (t, v))).fold(m, |m, (t, v)| {
            // The apex of a fan has no tangent plane to measure in.
            let apex = (v < 0.5 && point[0]) || (v > 0.5 && point[1]);
            m.max(l.development.strain(t, if apex { 0.5 } else { v }))
        })
    });
    Ok(Pattern {
        panel: index,
        name: name.into(),
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
        area: area.abs(),
        area_in_space: strips.iter().map(|s| s.area_estimate()).sum(),
        isometry_error,
        contour_error,
        width: size.width,
        length: size.length,
    })
}

/// Develops every strip and joins them along their common rulings.
pub(super) fn lay<'a>(strips: &[&'a Strip], index: usize, side: f64) -> Result<Vec<Laid<'a>>, DevelopError> {
    let mut out: Vec<Laid> = Vec::with_capacity(strips.len());
    for strip in strips {
        let development = Development::new(&strip.patch, side)?;
        let mut laid = Laid { strip, development, turn: (0.0, 1.0), offset: Vec2::zeros() };
        if let Some(before) = out.last() {
            let (u, t) = (strip.domain().0, before.strip.domain().1);
            let (here, there) = (strip.ruling(u), before.strip.ruling(t));
            let size = strip.patch.bbox().diagonal().max(before.strip.patch.bbox().diagonal());
            let gap = (here[0] - there[0]).norm().max((here[1] - there[1]).norm());
            if gap.is_nan() || gap > JOINT * size {
                return Err(DevelopError::Apart { piece: index, strip: strip.name.clone(), gap });
            }
            let (d, to) = (laid.map(u, 1.0) - laid.map(u, 0.0), before.map(t, 1.0) - before.map(t, 0.0));
            let angle = d.perp(&to).atan2(d.dot(&to));
            laid.turn = angle.sin_cos();
            // The middle between the ends: where v is one half, the weights of both rails decide.
            let middle = |l: &Laid, u: f64| (l.map(u, 0.0) + l.map(u, 1.0)) * 0.5;
            laid.offset = middle(before, t) - middle(&laid, u);
        }
        out.push(laid);
    }
    Ok(out)
}

/// Stretches of a rail between places where it may have a kink: knots as often as the degree.
fn smooth_stretches<'a, 'b>(laid: &'a Laid<'b>, breaks: &[f64], v: f64) -> Vec<Edge<'a, 'b>> {
    let kinks = laid.strip.patch.c0_lines().0;
    let mut ends = vec![breaks[0]];
    ends.extend(kinks);
    ends.push(breaks[breaks.len() - 1]);
    ends.windows(2).map(|w| Edge { laid, from: [w[0], v], to: [w[1], v] }).collect()
}

/// Samples of a stretch of the outline; rulings of later strips are counted on from those of earlier ones.
fn outline_samples(e: &Edge, strips: &[&Strip]) -> Vec<OutlinePoint> {
    let number = strips.iter().position(|s| std::ptr::eq(*s, e.laid.strip)).unwrap_or(0) as f64;
    let parts = if e.from[0] == e.to[0] { 1 } else { 12 * e.laid.strip.patch.knots_u.breaks().len().max(4) };
    let (a, b) = e.laid.strip.domain();
    (0..parts)
        .map(|k| {
            let [u, v] = e.at(k as f64 / parts as f64);
            let flat = e.laid.map(u, v);
            OutlinePoint { flat, space: e.laid.strip.patch.point(u, v), t: number + (u - a) / (b - a) }
        })
        .collect()
}

/// Lengths along the line `v` of the chain: strip, parameter and length so far.
fn stations(laid: &[Laid], v: f64) -> Vec<(usize, f64, f64)> {
    let mut out = Vec::new();
    let mut length = 0.0;
    for (k, l) in laid.iter().enumerate() {
        let mut last: Option<Vec2> = None;
        for w in l.strip.patch.knots_u.breaks().windows(2) {
            for i in 0..=SAMPLES {
                let u = w[0] + (w[1] - w[0]) * i as f64 / SAMPLES as f64;
                let p = l.map(u, v);
                length += last.map_or(0.0, |q| (p - q).norm());
                last = Some(p);
                out.push((k, u, length));
            }
        }
    }
    out
}

/// Strip and parameter at a length along [`stations`].
fn at_length(stations: &[(usize, f64, f64)], length: f64) -> (usize, f64) {
    let i = stations.partition_point(|s| s.2 < length).clamp(1, stations.len() - 1);
    let (a, b) = (stations[i - 1], stations[i]);
    if a.0 != b.0 || b.2 <= a.2 {
        return (b.0, b.1);
    }
    (b.0, a.1 + (b.1 - a.1) * ((length - a.2) / (b.2 - a.2)).clamp(0.0, 1.0))
}

/// Rulings along the middle as the options ask for, and those between the strips, shortened by `inset` at both ends, with
/// how the sheet bends about each; `size` is the length of the pattern.
fn rulings(laid: &[Laid], options: &StripOptions, size: f64, inset: f64) -> (Vec<[Vec2; 2]>, Vec<Bend>) {
    let (profile, joints) = profile(laid, options.side);
    if options.drawn.bends.facets.is_some() {
        return bends::kept_low(&options.drawn.bends, |asked| {
            let lines = profile.lines(asked, size).into_iter().map(|l| (l, true));
            drawn_lines(laid, &profile, lines, inset)
        });
    }
    let spacing = &options.drawn.bends;
    let total = profile.length();
    let mut lines: Vec<ProfileLine> = match options.ruling_spacing.filter(|s| *s > 0.0) {
        Some(spacing) => {
            let step = spacing.max(total / MOST_DRAWN);
            let lengths = (1..).map(|k| step * f64::from(k)).take_while(|l| *l < total * BEFORE_END && step > 0.0);
            profile.lines_at(&lengths.collect::<Vec<_>>(), size)
        }
        None => profile.lines(spacing, size),
    };
    // Lines beside a joint are left out; the joint itself is drawn.
    let near = 0.5 * spacing.least * size;
    let joined: Vec<ProfileLine> = joints.iter().map(|step| profile.within(*step)).collect();
    let apart = |a: &ProfileLine, b: &ProfileLine| (profile.length_at(a) - profile.length_at(b)).abs() > near;
    lines.retain(|l| joined.iter().all(|j| apart(l, j)));
    lines.extend(&joined);
    lines.sort_by(|a, b| a.place().total_cmp(&b.place()));
    lines = profile.parted(lines, size);
    if options.ruling_spacing.is_none() {
        let exact = |line: &ProfileLine, behind| exact(laid, &profile, line, (behind, options.side));
        lines = bends::dense(&profile, lines, spacing, size, &exact);
    }
    let in_planes: Vec<bool> = lines.iter().map(|l| joints.contains(&l.after)).collect();
    drawn_lines(laid, &profile, lines.into_iter().zip(in_planes), inset)
}

/// The ruling of a line, in the plane and in space; of a joint, on the strip behind it or before it.
fn exact(
    laid: &[Laid],
    profile: &TurnProfile<(usize, f64)>,
    line: &ProfileLine,
    (behind, side): (bool, f64),
) -> Option<DevelopedRuling> {
    let [(k, a), (m, b)] = profile.around(line.after)?;
    let (k, u) = match (k == m, behind) {
        (true, _) => (k, a + (b - a) * line.share),
        (false, true) => (m, b),
        (false, false) => (k, a),
    };
    let l = &laid[k];
    let own = super::pattern::ruling(&l.development, &l.strip.patch, u, side)?;
    let flat = [0.0, 1.0].map(|v| l.map(u, v));
    let radii = if l.strip.kind == PanelKind::Plane { [f64::INFINITY; 2] } else { own.radii };
    Some(DevelopedRuling { flat, radii, ..own })
}

/// Lines as they are drawn, shortened by `inset` at both ends, with how the sheet bends about each; in planes only those that
/// are to be drawn there too.
fn drawn_lines(
    laid: &[Laid],
    profile: &TurnProfile<(usize, f64)>,
    lines: impl Iterator<Item = (ProfileLine, bool)>,
    inset: f64,
) -> (Vec<[Vec2; 2]>, Vec<Bend>) {
    let mut out = (Vec::new(), Vec::new());
    for (line, in_planes) in lines {
        let Some([(k, a), (m, b)]) = profile.around(line.after) else { continue };
        let [before, (k, u)] = if k == m { [(k, a + (b - a) * line.share); 2] } else { [(k, a), (m, b)] };
        if laid[k].strip.kind == PanelKind::Plane && !in_planes {
            continue;
        }
        let (a, b) = (laid[k].map(u, 0.0), laid[k].map(u, 1.0));
        let length = (b - a).norm();
        if length > 4.0 * inset {
            let d = (b - a) * (inset / length);
            out.0.push([a + d, b - d]);
            let radii = |(k, u): (usize, f64)| match laid[k].strip.kind {
                PanelKind::Plane => [f64::INFINITY; 2],
                _ => [0.0, 1.0].map(|v| bends::radius(&laid[k].strip.patch, u, v)),
            };
            out.1.push(line.bend([radii(before), radii((k, u))]));
        }
    }
    out
}

/// The tangent planes along the middle of the chain, and the steps from strip to strip.
fn profile(laid: &[Laid], side: f64) -> (TurnProfile<(usize, f64)>, Vec<usize>) {
    let mut profile = TurnProfile::new();
    let mut joints = Vec::new();
    let mut before: Option<(Plane, Vec2, (usize, f64))> = None;
    for (k, u, _) in stations(laid, 0.5) {
        let l = &laid[k];
        let Some(plane) = Plane::of(&l.strip.patch, u, 0.5, side) else { continue };
        let x = l.map(u, 0.5);
        let (turn, length) = before.map_or(((0.0, None), 0.0), |(p, y, (j, t))| {
            let seen = p.turn(&plane);
            let turn = if j == k { bends::turn_between(&l.strip.patch, [t, u], side, seen) } else { (seen, None) };
            (turn, (x - y).norm())
        });
        if before.is_some_and(|(_, _, (j, _))| j != k) {
            joints.push(profile.len() - 1);
        }
        profile.push((k, u), turn, length);
        before = Some((plane, x, (k, u)));
    }
    (profile, joints)
}

/// Marks at equal lengths along both rails.
fn marks(laid: &[Laid], spacing: Option<f64>, sign: f64) -> Vec<Mark> {
    let mut out = Vec::new();
    if spacing == Some(0.0) {
        return out;
    }
    for (v, letter) in [(0.0, 'A'), (1.0, 'B')] {
        let stations = stations(laid, v);
        let total = stations.last().map_or(0.0, |s| s.2);
        let step = spacing.filter(|s| *s > 0.0).unwrap_or(total / MARKS).max(total / MOST_DRAWN);
        let mut k = 1;
        while step > 0.0 && step * f64::from(k) < total * BEFORE_END {
            let (i, u) = at_length(&stations, step * f64::from(k));
            let l = &laid[i];
            let t = l.vector(&l.development.tangent(u, v, if v < 0.5 { 1.0 } else { -1.0 }, 0.0)) * sign;
            let norm = t.norm();
            if norm > 0.0 && !l.strip.is_point(v as usize) {
                let inward = Vec2::new(-t.y, t.x) / norm;
                out.push(Mark {
                    point: l.map(u, v),
                    inward,
                    label: format!("{letter}{k}"),
                    on: MarkPlace::Seam,
                    apart: 0.0,
                });
            }
            k += 1;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::curve::Curve;

    /// Quarter circle of radius r about the z-axis, from the angle k · 90°.
    fn quarter(k: usize, radius: f64, z: f64) -> Curve<4> {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let (s, c) = (0.5 * std::f64::consts::PI * k as f64).sin_cos();
        let turn = |x: f64, y: f64, w: f64| [w * radius * (c * x - s * y), w * radius * (s * x + c * y), w * z, w];
        Curve::new(
            2,
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            vec![turn(1.0, 0.0, 1.0), turn(1.0, 1.0, h), turn(0.0, 1.0, 1.0)],
        )
        .expect("arc")
    }

    fn cone(k: usize) -> Strip {
        Strip::between("c", PanelKind::Cone, &quarter(k, 100.0, 0.0), &quarter(k, 50.0, 100.0)).expect("strip")
    }

    #[test]
    fn two_quarters_of_a_cone_make_one_sector() {
        let (a, b) = (cone(0), cone(1));
        let p = pattern(&[&a, &b], 3, "duct", &StripOptions::new(0.01)).expect("pattern");
        let (outer, inner) = (100f64.hypot(200.0), 50f64.hypot(100.0));
        let angle = std::f64::consts::PI * 100.0 / outer;
        let area = 0.5 * angle * (outer * outer - inner * inner);
        assert!((p.area - area).abs() < 1e-7 * area && (p.area_in_space - area).abs() < 1e-7 * area);
        assert!(p.isometry_error < 1e-9 && p.contour_error < 0.01);
        // One arc per quarter and rail would do.
        assert!(p.contours[0].vertices.len() <= 8, "{}", p.contours[0].vertices.len());
        assert_eq!(p.contours[0].vertices.iter().filter(|v| v.corner).count(), 4);
        assert_eq!((p.panel, p.sides.len()), (3, 4));
        assert!(p.rulings.len() >= 19 && p.marks.len() == 14);
    }

    #[test]
    fn strips_with_other_weights_at_their_common_ruling_do_not_slide_along_it() {
        // The same quarter as its other half would have it: weights of one rail three times those of the other.
        let (a, mut b) = (cone(0), cone(1));
        for c in b.patch.control.iter_mut().skip(1).step_by(2) {
            c.iter_mut().for_each(|x| *x *= 3.0);
        }
        let p = pattern(&[&a, &b], 0, "duct", &StripOptions::new(0.01)).expect("pattern");
        let outer = 100f64.hypot(200.0);
        let whole = pattern(&[&a, &cone(1)], 0, "duct", &StripOptions::new(0.01)).expect("pattern");
        assert!((p.area - whole.area).abs() < 1e-9 * whole.area);
        // All of the outer rail lies on one circle.
        let on = |p: &Pattern| p.contours[0].vertices.iter().map(|v| v.point).collect::<Vec<_>>();
        for (x, y) in on(&p).iter().zip(on(&whole)) {
            assert!((x - y).norm() < 1e-9 * outer, "{x} {y}");
        }
    }

    #[test]
    fn areas_of_rails_with_many_waves_are_exact() {
        let rail = |z: f64| {
            let points: Vec<Vec3> = (0..=400)
                .map(|i| {
                    let x = 0.5 * f64::from(i);
                    Vec3::new(x, 3.0 * x.sin(), z)
                })
                .collect();
            crate::spline::through::cubic(&points, [None, None], false).expect("spline")
        };
        let (a, b) = (rail(0.0), rail(60.0));
        let (lo, hi) = a.domain();
        let at = |i: u32| a.point(lo + (hi - lo) * f64::from(i) / 1e5);
        let chord =
            |i: u32| (0..3).map(|d| (at(i + 1)[d] / at(i + 1)[3] - at(i)[d] / at(i)[3]).powi(2)).sum::<f64>().sqrt();
        let length: f64 = (0..100_000).map(chord).sum();
        let flutes = Strip::between("f", PanelKind::Cylinder, &a, &b).expect("strip");
        let p = pattern(&[&flutes], 0, "f", &StripOptions::new(0.01)).expect("pattern");
        assert!((p.area - 60.0 * length).abs() < 1e-6 * p.area, "{} {}", p.area, 60.0 * length);
    }

    #[test]
    fn rulings_keep_the_spacing_asked_for() {
        let a = cone(0);
        let options = StripOptions { ruling_spacing: Some(10.0), mark_spacing: Some(20.0), ..StripOptions::new(0.01) };
        let p = pattern(&[&a], 0, "c", &options).expect("pattern");
        let middle = |r: &[Vec2; 2]| (r[0] + r[1]) * 0.5;
        for w in p.rulings.windows(2) {
            assert!(((middle(&w[1]) - middle(&w[0])).norm() - 10.0).abs() < 0.05);
        }
        assert!(p.marks.iter().any(|m| m.label == "A7") && p.marks.iter().any(|m| m.label == "B3"));
    }

    #[test]
    fn triangles_and_fans_lie_flat_and_their_marks_point_inwards() {
        let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let t = Strip::quad(
            "t",
            PanelKind::Plane,
            [x(0.0, 0.0, 0.0), x(0.0, 0.0, 60.0)],
            [x(80.0, 0.0, 0.0), x(0.0, 0.0, 60.0)],
        )
        .expect("strip");
        let p = pattern(&[&t], 0, "t", &StripOptions::new(0.01)).expect("pattern");
        assert!((p.area - 2400.0).abs() < 1e-9 && p.contours[0].vertices.len() == 3);
        let centre = p.contours[0].vertices.iter().fold(Vec2::zeros(), |s, v| s + v.point / 3.0);
        assert!(p.marks.iter().all(|m| m.inward.dot(&(centre - m.point)) > 0.0));
    }

    #[test]
    fn strips_without_a_common_ruling_are_refused() {
        let (a, b) = (cone(0), cone(2));
        let e = pattern(&[&a, &b], 0, "d", &StripOptions::new(0.01)).expect_err("apart");
        assert!(matches!(e, DevelopError::Apart { .. }));
    }
}
