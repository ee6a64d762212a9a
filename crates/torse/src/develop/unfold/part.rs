//! A body as flat parts: sheet recognised, the better skin unfolded, drawn.

use super::bends::{bends, BendKind, SheetBend};
use super::outline::{image, outlines, Outline};
use super::sheet::{open, sheet, Sheet};
use super::tree::{unfold, Cut, CutReason, Piece, UnfoldOptions};
use super::{allowance::KFactor, outline::contour_area};
use crate::brep::body::{oriented, Body};
use crate::brep::carrier::Carrier;
use crate::brep::face::Face;
use crate::geom::rectangle::smallest_rectangle;
use crate::geom::Vec2;
use crate::patchwork::image::Stroke;
use crate::patchwork::pattern::{Bend, Contour, Pattern, ViewSide};
use std::collections::HashSet;

/// A flat part.
#[derive(Clone, Debug)]
pub struct FlatPart {
    /// The drawing, seen from outside the skin that was unfolded; `panel` is for the caller.
    pub pattern: Pattern,
    /// Its bends.
    pub bends: Vec<SheetBend>,
    /// Outlines of formed features, to be marked and not cut.
    pub formed: Vec<Contour>,
    /// Indices (among the faces given) of the skin faces that it is made of; the first is the root.
    pub faces: Vec<usize>,
    /// Entity numbers of edges of the file that were cut to lay it flat, with the reason.
    pub cuts: Vec<(u64, CutReason)>,
    /// Thickness, mm; 0 for surfaces.
    pub thickness: f64,
    /// What every line and arc of the outlines is drawn for.
    pub strokes: Vec<Stroke>,
    /// Both sides of edges inside the part, as lines between their ends: joints.
    pub joints: Vec<Stroke>,
}

/// The parts of one body.
#[derive(Clone, Debug, Default)]
pub struct BodyParts {
    /// The parts; empty if there are none, then `left` says why.
    pub parts: Vec<FlatPart>,
    /// Faces left out with the reason: index among the faces given, `None` for the body as a whole.
    pub left: Vec<(Option<usize>, String)>,
}

/// How bodies are laid flat.
#[derive(Clone, Debug, PartialEq)]
pub struct PartOptions {
    /// Distance (mm) between contours drawn and exact outlines; no default.
    pub tolerance: f64,
    /// Where the neutral fibre lies; default 0.44 (ANSI).
    pub k: KFactor,
    /// Takes all faces as surfaces without thickness; default false.
    pub surfaces: bool,
}

/// The flat parts of the faces of one body.
///
/// *Input*: faces of one solid or sheet, mm. *Guarantee*: every face is in a part, an edge of the sheet, or named in
/// `left`. Contours are closed, the outer one first and counter-clockwise. *Measured, not proven*: that carriers are
/// exact, that parts do not overlap themselves.
pub fn flat_parts(faces: &[&Face], name: &str, options: &PartOptions) -> BodyParts {
    let mut out = BodyParts::default();
    let given = Body::new(faces.to_vec());
    let turned = oriented(&given);
    let body = turned.as_ref().map_or(given, |all| Body::new(all.iter().collect()));
    let found = match options.surfaces {
        true => open(&body),
        false => match sheet(&body) {
            Ok(found) => found,
            Err(e) => {
                out.left.push((None, e.to_string()));
                return out;
            }
        },
    };
    let asked = UnfoldOptions { k: options.k.clone(), tolerance: options.tolerance, thickness: found.local.clone() };
    let sides = found.skins.iter().filter(|s| !s.is_empty()).map(|skin| Side::of(&body, skin, &asked));
    let best = sides.min_by(|a, b| a.rank().partial_cmp(&b.rank()).unwrap_or(std::cmp::Ordering::Equal));
    let left: Vec<usize> = best.iter().flat_map(|b| &b.left).chain(&found.others).copied().collect();
    for group in groups(&body, &left) {
        let more = if group.len() > 1 { format!(" ({} faces that hang together)", group.len()) } else { String::new() };
        out.left.push((Some(group[0]), format!("{}{more}", why(&body, group[0], &found))));
    }
    let Some(best) = best else { return out };
    let count = best.pieces.len();
    for (k, (piece, outlines)) in best.pieces.iter().zip(best.outlines).enumerate() {
        let name = if count > 1 { format!("{name}-{}", k + 1) } else { name.to_owned() };
        out.parts.push(part(&body, piece, outlines, (&found, &name)));
    }
    out
}

/// One skin of a sheet, unfolded.
struct Side {
    pieces: Vec<Piece>,
    outlines: Vec<Vec<Outline>>,
    left: Vec<usize>,
}

impl Side {
    fn of(body: &Body, skin: &[usize], asked: &UnfoldOptions) -> Self {
        let (pieces, left) = unfold(body, skin, asked);
        let outlines = pieces.iter().map(|p| outlines(body, p, asked.tolerance)).collect();
        Self { pieces, outlines, left }
    }

    /// Less is better: faces left out, pieces, sharp bends seen from outside; then more area, which is the side without
    /// countersinks.
    fn rank(&self) -> (usize, usize, usize, f64) {
        let outside = self.pieces.iter().flat_map(|p| &p.folds).filter(|f| f.meeting.convex).count();
        let area: f64 = self.outlines.iter().flatten().map(|o| o.area).sum();
        (self.left.len(), self.pieces.len(), outside, -area)
    }
}

/// Faces in groups that hang together; one that is not developable comes first in its group.
fn groups(body: &Body, faces: &[usize]) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = faces.to_vec();
    open.sort_unstable();
    let mut out = Vec::new();
    while let Some(first) = open.first().copied() {
        let mut group = vec![first];
        open.remove(0);
        let mut k = 0;
        while k < group.len() {
            let near: Vec<usize> = body.of_face(group[k]).filter_map(|h| body.beyond(h)).collect();
            let (mut joined, rest) = open.iter().partition(|f| near.contains(f));
            group.append(&mut joined);
            open = rest;
            k += 1;
        }
        group.sort_by_key(|f| (body.carriers[*f].is_developable(), *f));
        out.push(group);
    }
    out
}

/// Why a face is not part of a flat pattern.
fn why(body: &Body, face: usize, found: &Sheet) -> String {
    match &body.carriers[face] {
        Carrier::Curved(d) => d.words(),
        c if found.thickness > 0.0 => format!(
            "the {} is neither a skin nor an edge of the sheet of {:.3} mm: a feature formed or milled into it, or a bend \
             of a radius below the thickness",
            c.name(),
            found.thickness
        ),
        c => format!("the {} could not be laid flat", c.name()),
    }
}

/// The drawing of a piece.
fn part(body: &Body, piece: &Piece, outlines: Vec<Outline>, (found, name): (&Sheet, &str)) -> FlatPart {
    let others: HashSet<usize> = found.others.iter().copied().collect();
    let formed =
        |o: &Outline| o.area < 0.0 && o.halves.iter().all(|h| body.beyond(*h).is_some_and(|g| others.contains(&g)));
    let bends = bends(body, piece, found.thickness);
    let (marks, contours): (Vec<Outline>, Vec<Outline>) = outlines.into_iter().partition(formed);
    let mut pattern = Pattern {
        name: name.to_owned(),
        view: ViewSide::Outside,
        area: contours.iter().map(|o| contour_area(&o.contour)).sum(),
        contour_error: contours.iter().map(|o| o.error).fold(0.0, f64::max),
        ..Pattern::default()
    };
    // The neutral surface keeps its area.
    pattern.area_in_space = pattern.area;
    let points: Vec<Vec2> = piece.faces.iter().flat_map(|p| p.region.loops.iter().flatten().copied()).collect();
    if let Some(r) = smallest_rectangle(&points) {
        (pattern.width, pattern.length) = (r.width, r.length);
    }
    let strokes = contours.iter().chain(&marks).flat_map(|o| o.strokes.iter().cloned()).collect();
    pattern.contours = contours.into_iter().map(|o| o.contour).collect();
    for b in &bends {
        let each = if b.kind == BendKind::Rolled { b.angle / b.lines.len() as f64 } else { b.angle };
        for l in &b.lines {
            pattern.rulings.push(*l);
            pattern.bends.push(Bend { sense: b.sense, angle: each, radii: [b.inside_radius; 2] });
        }
    }
    let joints = piece.inner.iter().map(|h| Stroke {
        start: piece.place(body, *h, 0.0),
        end: piece.place(body, *h, 1.0),
        bulge: 0.0,
        images: image(body, piece, *h, [0.0, 1.0]).map(|i| vec![i]),
    });
    let joints = joints.collect();
    let number = |c: &Cut| (body.halves[c.half].run.entity, c.reason);
    FlatPart {
        pattern,
        bends,
        formed: marks.into_iter().map(|o| o.contour).collect(),
        faces: piece.faces.iter().map(|p| p.face).collect(),
        cuts: piece.cuts.iter().map(number).collect(),
        thickness: found.thickness,
        strokes,
        joints,
    }
}

#[cfg(test)]
mod tests {
    use crate::brep::face::Face;
    use crate::certify::strokes::strokes;
    use crate::develop::unfold::allowance::KFactor;
    use crate::develop::unfold::bends::BendKind;
    use crate::develop::unfold::part::{flat_parts, BodyParts, FlatPart, PartOptions};
    use crate::develop::unfold::specimens::{quarter, rectangle, round_surface, BentSheet, Stretch};
    use crate::develop::unfold::tree::CutReason;
    use crate::geom::Vec3;
    use crate::patchwork::pattern::BendSense;
    use std::f64::consts::{FRAC_PI_2, PI};

    const TOLERANCE: f64 = 1e-3;

    fn flat(faces: &[Face], k: f64) -> BodyParts {
        let options = PartOptions { tolerance: TOLERANCE, k: KFactor::Ansi(k), surfaces: false };
        flat_parts(&faces.iter().collect::<Vec<_>>(), "part", &options)
    }

    /// The only part, with nothing left out and its drawing proven.
    fn only(made: BodyParts) -> FlatPart {
        assert!(made.left.is_empty(), "{:?}", made.left);
        assert_eq!(made.parts.len(), 1);
        let part = made.parts.into_iter().next().expect("a part");
        let (drawn, joints) = (strokes(&part.strokes, TOLERANCE), strokes(&part.joints, TOLERANCE));
        assert!(drawn.drawn_bound().value() <= TOLERANCE && drawn.strain_bound().value() < 1e-12, "{drawn:?}");
        assert!(joints.drawn_bound().value() < 1e-9 && joints.strain_bound().value() < 1e-12, "{joints:?}");
        part
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
    }

    #[test]
    fn a_bracket_is_as_long_as_its_neutral_fibre() {
        let (t, r, k, angle, w) = (2.0, 3.0, 0.4, 1.2, 30.0);
        for sign in [1.0, -1.0] {
            let profile = [Stretch::Line(40.0), Stretch::Bend(sign * angle, r), Stretch::Line(25.0)];
            let part = only(flat(&BentSheet::new(t, &profile, &[0.0, w], &[]).faces(), k));
            let length = 40.0 + (r + k * t) * angle + 25.0;
            near(part.thickness, t);
            near(part.pattern.area, length * w);
            near(part.pattern.length, length);
            near(part.pattern.width, w);
            assert_eq!(part.pattern.contours.len(), 1);
            assert_eq!(part.pattern.contours[0].vertices.len(), 4, "straight sides are one line each");
            let [bend] = part.bends.as_slice() else { panic!("one bend") };
            assert_eq!((bend.kind, bend.lines.len(), bend.extents.len()), (BendKind::Bend, 1, 2));
            near(bend.angle, angle);
            near(bend.inside_radius, r);
            near(bend.allowance, (r + k * t) * angle);
            near(bend.length, w);
            // The bend line lies half way between its extents.
            let middle = |l: &[crate::geom::Vec2; 2]| (l[0] + l[1]) * 0.5;
            let between = (middle(&bend.extents[0]) + middle(&bend.extents[1])) * 0.5;
            assert!((middle(&bend.lines[0]) - between).norm() < 1e-9);
        }
    }

    #[test]
    fn a_channel_bends_one_way_and_a_step_both_ways() {
        let profile = |second: f64| {
            [
                Stretch::Line(20.0),
                Stretch::Bend(FRAC_PI_2, 2.0),
                Stretch::Line(50.0),
                Stretch::Bend(second * FRAC_PI_2, 2.0),
                Stretch::Line(30.0),
            ]
        };
        let length = 100.0 + 2.0 * (2.0 + 0.44 * 1.5) * FRAC_PI_2;
        for (second, alike) in [(1.0, true), (-1.0, false)] {
            let part = only(flat(&BentSheet::new(1.5, &profile(second), &[0.0, 40.0], &[]).faces(), 0.44));
            near(part.pattern.length, length);
            near(part.pattern.area, 40.0 * length);
            assert_eq!(part.bends.len(), 2);
            assert_eq!(part.bends[0].sense == part.bends[1].sense, alike);
            let mut order: Vec<usize> = part.bends.iter().map(|b| b.order).collect();
            order.sort_unstable();
            assert_eq!(order, [1, 2]);
        }
    }

    #[test]
    fn a_window_across_a_bend_stays_open_and_splits_the_bend_line() {
        let profile = [
            Stretch::Line(20.0),
            Stretch::Line(10.0),
            Stretch::Bend(FRAC_PI_2, 2.0),
            Stretch::Line(10.0),
            Stretch::Line(20.0),
        ];
        let holes = [[1, 1], [2, 1], [3, 1]];
        let sheet = BentSheet::new(1.0, &profile, &[0.0, 10.0, 25.0, 40.0], &holes);
        let part = only(flat(&sheet.faces(), 0.5));
        let bent = 2.5 * FRAC_PI_2;
        near(part.pattern.area, 40.0 * (60.0 + bent) - 15.0 * (20.0 + bent));
        assert_eq!(part.pattern.contours.len(), 2, "an outer contour and a hole");
        assert!(part.pattern.contours.iter().all(|c| c.vertices.len() == 4));
        let [bend] = part.bends.as_slice() else { panic!("one bend: {:?}", part.bends) };
        assert_eq!(bend.lines.len(), 2);
        near(bend.length, 40.0);
        assert!(part.cuts.is_empty());
    }

    #[test]
    fn a_tray_of_four_flanges_is_a_cross() {
        let (a, b, r, h) = (60.0, 40.0, 3.0, 15.0);
        // Seen from below, which is outside.
        let mut faces = vec![rectangle(Vec3::zeros(), Vec3::y() * b, Vec3::x() * a)];
        let sides = [
            (Vec3::zeros(), Vec3::x(), -Vec3::y(), a),
            (Vec3::new(a, 0.0, 0.0), Vec3::y(), Vec3::x(), b),
            (Vec3::new(a, b, 0.0), -Vec3::x(), Vec3::y(), a),
            (Vec3::new(0.0, b, 0.0), -Vec3::y(), -Vec3::x(), b),
        ];
        for (corner, along, out, length) in sides {
            // Up: the axis lies above the edge.
            let axis = corner + Vec3::z() * r;
            faces.push(quarter(axis + along * length, -along, -Vec3::z() * r, length));
            let foot = axis + out * r;
            faces.push(rectangle(foot, along * length, Vec3::z() * h));
        }
        let part = only(flat(&faces, 0.44));
        assert_eq!(part.thickness, 0.0);
        let flange = h + r * FRAC_PI_2;
        near(part.pattern.area, a * b + 2.0 * (a + b) * flange);
        assert_eq!(part.pattern.contours[0].vertices.len(), 12);
        assert_eq!((part.bends.len(), part.cuts.len()), (4, 0));
        assert!(part.bends.iter().all(|b| b.kind == BendKind::Bend));
    }

    #[test]
    fn faces_that_look_different_ways_are_turned_before_they_are_joined() {
        let (x, y, z) = (Vec3::x() * 10.0, Vec3::y() * 20.0, Vec3::z() * 30.0);
        let floor = rectangle(Vec3::zeros(), x, y);
        for wall in [rectangle(Vec3::zeros(), y, z), rectangle(Vec3::zeros(), z, y)] {
            let part = only(flat(&[floor.clone(), wall], 0.44));
            near(part.pattern.area, 800.0);
            assert_eq!((part.bends.len(), part.faces.len()), (1, 2));
        }
    }

    #[test]
    fn a_closed_box_is_cut_open_along_seven_edges() {
        let (x, y, z) = (Vec3::x() * 10.0, Vec3::y() * 20.0, Vec3::z() * 30.0);
        let o = Vec3::zeros();
        let faces = [
            rectangle(o, y, x),
            rectangle(z, x, y),
            rectangle(o, x, z),
            rectangle(y, z, x),
            rectangle(o, z, y),
            rectangle(x, y, z),
        ];
        let options = PartOptions { tolerance: TOLERANCE, k: KFactor::default(), surfaces: true };
        let part = only(flat_parts(&faces.iter().collect::<Vec<_>>(), "box", &options));
        near(part.pattern.area, 2.0 * (200.0 + 300.0 + 600.0));
        assert_eq!((part.cuts.len(), part.bends.len()), (7, 5));
        assert!(part.cuts.iter().all(|c| c.1 == CutReason::Closes));
        assert!(part.bends.iter().all(|b| b.kind == BendKind::Fold && b.sense == BendSense::Down));
    }

    #[test]
    fn a_frustum_is_a_sector_and_a_pipe_a_rectangle() {
        let (radius, slope, h) = (20.0, 0.3_f64, 40.0);
        let cone = only(flat(&[round_surface(radius, slope, (0.0, h))], 0.44));
        let slant = h * (1.0 + slope * slope).sqrt();
        near(cone.pattern.area, PI * slant * (2.0 * radius + slope * h));
        assert!(cone.bends[0].kind == BendKind::Rolled && cone.bends[0].lines.len() > 60);
        // Two lines and two arcs of one centre, each in two parts at most.
        assert!(cone.pattern.contours[0].vertices.len() <= 6, "{}", cone.pattern.contours[0].vertices.len());
        let pipe = only(flat(&[round_surface(radius, 0.0, (0.0, h))], 0.44));
        near(pipe.pattern.area, 2.0 * PI * radius * h);
        near(pipe.pattern.length, 2.0 * PI * radius);
        assert_eq!(pipe.pattern.contours[0].vertices.len(), 4);
    }

    #[test]
    fn bodies_without_one_thickness_are_refused_with_the_distances_found() {
        // A block: three distances, none of which is that of most of it.
        let profile = [Stretch::Line(30.0)];
        let block = BentSheet::new(28.0, &profile, &[0.0, 29.0], &[]).faces();
        let made = flat(&block, 0.44);
        assert!(made.parts.is_empty());
        let (face, reason) = &made.left[0];
        assert!(face.is_none() && reason.contains("no constant thickness"), "{reason}");
        assert!(reason.contains("28.000") && reason.contains("29.000"), "{reason}");
        // As surfaces they unfold all the same.
        let options = PartOptions { tolerance: TOLERANCE, k: KFactor::default(), surfaces: true };
        let part = only(flat_parts(&block.iter().collect::<Vec<_>>(), "block", &options));
        near(part.pattern.area, 2.0 * (30.0 * 28.0 + 30.0 * 29.0 + 28.0 * 29.0));
    }

    /// A face ruled along a direction or to a point over a parabola, without thickness.
    fn over_parabola(to: impl Fn(Vec3) -> Vec3) -> Face {
        let curve = [Vec3::zeros(), Vec3::new(50.0, 0.0, 40.0), Vec3::new(100.0, 0.0, 0.0)];
        let points: Vec<Vec3> = curve.iter().flat_map(|p| [*p, to(*p)]).collect();
        let knots = |degree| crate::spline::knots::Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
        let surface = crate::spline::surface::Surface::new(knots(2), knots(1), &points, None).expect("a surface");
        Face::untrimmed(surface)
    }

    #[test]
    fn general_developables_keep_their_area_and_the_lengths_of_their_edges() {
        let apex = Vec3::new(40.0, 130.0, 10.0);
        let shapes: [(&str, Face); 2] = [
            ("general cylinder", over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0))),
            ("general cone", over_parabola(|p| p + (apex - p) * 0.6)),
        ];
        for (name, face) in shapes {
            assert_eq!(crate::brep::carrier::carrier(&face).name(), name);
            let made = flat(std::slice::from_ref(&face), 0.44);
            assert!(made.left.is_empty());
            let part = &made.parts[0];
            let area = crate::brep::area::area_estimate(&face);
            assert!((part.pattern.area - area).abs() < 1e-5 * area, "{name}: {} {area}", part.pattern.area);
            let length = |a: Vec3, b: Vec3| (a - b).norm();
            let corner = |k: usize| {
                let q = face.loops[0].points[k];
                face.surface.point(q[0], q[1])
            };
            let corners: Vec<_> =
                part.pattern.contours[0].vertices.iter().filter(|v| v.corner).map(|v| v.point).collect();
            assert_eq!(corners.len(), 4);
            // Two sides are rulings: their lengths stay, in space and in the plane.
            let flat_sides: Vec<f64> = (0..4).map(|k| (corners[k] - corners[(k + 1) % 4]).norm()).collect();
            for (p, q) in [(0, 3), (1, 2)] {
                let wanted = length(corner(p), corner(q));
                assert!(
                    flat_sides.iter().any(|s| (s - wanted).abs() < 1e-8 * wanted),
                    "{name}: {flat_sides:?} {wanted}"
                );
            }
            assert!(part.bends[0].kind == BendKind::Rolled && part.bends[0].lines.len() > 10);
        }
    }

    #[test]
    fn twisted_faces_are_named_with_their_twist() {
        let twisted = over_parabola(|p| p + Vec3::new(0.0, 90.0, 0.2 * p.x));
        let made = flat(std::slice::from_ref(&twisted), 0.44);
        assert!(made.parts.is_empty());
        let reason = &made.left[0].1;
        assert!(reason.contains("not developable") && reason.contains("° along a ruling"), "{reason}");
    }

    #[test]
    fn a_drawing_that_is_moved_is_refused_by_the_judge() {
        let profile = [Stretch::Line(40.0), Stretch::Bend(1.0, 3.0), Stretch::Line(25.0)];
        let part = only(flat(&BentSheet::new(2.0, &profile, &[0.0, 30.0], &[]).faces(), 0.44));
        let bad = |change: &dyn Fn(&mut crate::patchwork::image::Stroke)| {
            let mut all = part.strokes.clone();
            change(&mut all[1]);
            strokes(&all, TOLERANCE).drawn_bound().value()
        };
        assert!(bad(&|_| {}) <= TOLERANCE);
        assert!(bad(&|s| s.start.x += 2.0 * TOLERANCE) > TOLERANCE);
        assert!(bad(&|s| s.end.y -= 2.0 * TOLERANCE) > TOLERANCE);
        assert!(bad(&|s| s.bulge = 0.01) > TOLERANCE);
        assert!(bad(&|s| s.images.iter_mut().flatten().for_each(|i| i.shift.x += 2.0 * TOLERANCE)) > TOLERANCE);
        assert!(bad(&|s| s.images = None).is_infinite());
    }
}
