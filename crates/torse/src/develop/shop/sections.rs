//! Where planes cut the panels, as lines on the flat patterns: frames, waterlines, stations
//! (docs/algorithms/shop.md, "Sections").
//!
//! *Method*. A plane meets every ruling in one place, in closed form; rulings whose ends lie on different sides of it are
//! followed between the places where an end lies in the plane itself, and halved until chords in the drawing keep to a
//! distance. A ruling that lies in the plane is the section.

use super::laid::{Laid, Spot};
use super::pieces::{joined, Near, Piece};
use super::roll::outlines;
use crate::develop::marked::marked;
use crate::develop::unfold::placed_face::PlacedFace;
use crate::geom::polygon::{bounds, distance, inside, sides};
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::{MarkLine, Pattern};

/// A plane that marks panels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SectionPlane {
    /// Unit normal.
    pub normal: Vec3,
    /// Distance from the origin along it, mm.
    pub offset: f64,
    /// Label beside the mark.
    pub label: String,
}

/// Halvings of a stretch of rulings at most: a section nearly along the rulings crosses them all at once.
const DEEPEST: usize = 40;
/// Points of one section on one panel at most: no drawing needs more, and no file can exhaust the memory.
const MOST_POINTS: usize = 4000;
/// Steps by which a ruling is found whose end lies in the plane.
const STEPS: usize = 80;
/// Distance of the lines and arcs drawn for a section from its chords, against that of these from the section: arcs are told from
/// chords by their middles.
const FITTED: f64 = 4.0;
/// Share of the part's size below which ends of stretches are one place, and lines are too short to be drawn.
const SAME: f64 = 1e-7;
/// Sine of the angle below which a plane is parallel to a plane face.
const PARALLEL: f64 = 1e-9;

/// Lines in which planes cut a part, inside its outline, in the order of the planes. Chords keep within `tolerance` (mm) of
/// the section, as far as three places of every chord tell, lines and arcs within four times that of these.
pub fn sections(laid: &Laid, pattern: &Pattern, planes: &[SectionPlane], tolerance: f64) -> Vec<MarkLine> {
    let loops = outlines(pattern, laid.size());
    let mut out = Vec::new();
    for plane in planes {
        let mut lines: Vec<Vec<Vec2>> = Vec::new();
        if laid.is_of_faces() {
            lines = on_faces(laid, (plane, &loops), tolerance);
        } else {
            for stretch in (0..laid.len()).flat_map(|panel| on_panel(laid, panel, plane, tolerance)) {
                for piece in clipped(&stretch, &loops) {
                    join(&mut lines, piece, SAME * laid.size());
                }
            }
        }
        let long = |l: &Vec<Vec2>| l.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>() > SAME * laid.size();
        // A plane along the edge marks what is cut anyway.
        let edge = 2.0 * (tolerance + pattern.contour_error.max(0.0));
        let beside = |l: &Vec<Vec2>| {
            let middles = l.windows(2).map(|w| (w[0] + w[1]) * 0.5);
            middles.chain(l.iter().copied()).any(|p| distance(&loops, &p) > edge)
        };
        lines.retain(|l| long(l) && beside(l));
        out.extend(lines.iter().map(|l| marked(&plane.label, l, FITTED * tolerance).0));
    }
    out
}

/// The lines of a section with faces that have maps of their own: on every face inside its region and inside the outline, joined where
/// faces meet.
fn on_faces(laid: &Laid, (plane, outlines): (&SectionPlane, &[Vec<Vec2>]), tolerance: f64) -> Vec<Vec<Vec2>> {
    let same = SAME * laid.size();
    let mut pieces = Vec::new();
    for (panel, face) in (0..laid.len()).filter_map(|k| Some((k, laid.face(k)?))) {
        let stretches = match face.placed.chart.plane() {
            Some(_) => across_plane(face, plane).into_iter().collect(),
            None => on_panel(laid, panel, plane, tolerance),
        };
        let own = stretches.iter().flat_map(|s| clipped_near(s, &face.region.loops, same));
        let drawn = own.flat_map(|s| clipped_near(&s, outlines, same));
        pieces.extend(drawn.map(|points| {
            let ends = [points[0], points[points.len() - 1]].map(|q| in_space(laid, panel, &q));
            Piece { panel, points, ends }
        }));
    }
    joined(pieces, Near { same, edge: tolerance, fold: laid.widest_fold() })
}

/// The section of a plane with a plane face, across its whole region; `None` where they are parallel.
fn across_plane(face: &PlacedFace, plane: &SectionPlane) -> Option<Vec<Vec2>> {
    let (frame, motion) = (face.placed.chart.plane()?, &face.placed.motion);
    let across = Vec2::new(plane.normal.dot(&frame.x), plane.normal.dot(&frame.y));
    if across.norm() <= PARALLEL {
        return None;
    }
    let foot = across * ((plane.offset - plane.normal.dot(&frame.origin)) / across.norm_squared());
    let (at, way) = (motion.apply(&foot), motion.direction(&Vec2::new(-across.y, across.x).normalize()));
    let (lo, hi) = bounds(&face.region.loops);
    let (middle, reach) = (way.dot(&((lo + hi) * 0.5 - at)), (hi - lo).norm());
    Some(vec![at + way * (middle - reach), at + way * (middle + reach)])
}

/// Where a point of a face's region is in space; not numbers where it is not known.
fn in_space(laid: &Laid, panel: usize, q: &Vec2) -> Vec3 {
    let plane = laid.face(panel).and_then(|f| Some((f.placed.chart.plane()?, &f.placed.motion)));
    match plane {
        Some((frame, motion)) => {
            let p = motion.back(q);
            frame.to_world(&Vec3::new(p.x, p.y, 0.0))
        }
        None => laid.spot_on(panel, q).map_or(Vec3::repeat(f64::NAN), |spot| laid.space(&spot)),
    }
}

/// Stretches of the section with a whole panel.
fn on_panel(laid: &Laid, panel: usize, plane: &SectionPlane, tolerance: f64) -> Vec<Vec<Vec2>> {
    // Heights of both ends of a ruling above the plane.
    let ends = |t: f64| laid.ruling_in_space(panel, t).map(|p| plane.normal.dot(&p) - plane.offset);
    let stations: Vec<f64> = laid.stations(panel).collect();
    let mut out: Vec<Vec<Vec2>> = Vec::new();
    // Rulings in the plane, up to rounding: nothing beside them could be followed.
    let same = SAME * laid.size();
    let level: Vec<bool> = stations.iter().map(|t| ends(*t).iter().all(|x| x.abs() <= same)).collect();
    for (k, t) in stations.iter().enumerate().filter(|(k, _)| level[*k]) {
        // A joint belongs to the panel before it; of a stretch that lies in the plane as a whole nothing is marked.
        let joint = k == 0 && panel > 0 && !laid.is_of_faces();
        let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().any(|j| level.get(j) == Some(&true));
        if !joint && !beside {
            out.push(laid.ruling(panel, *t).to_vec());
        }
    }
    for (w, level) in stations.windows(2).zip(level.windows(2)) {
        if level[0] || level[1] {
            continue;
        }
        let (f, g) = (ends(w[0]), ends(w[1]));
        // Rulings whose one or other end lies in the plane.
        let zero = |k: usize| ((f[k] >= 0.0) != (g[k] >= 0.0)).then(|| root(|t| ends(t)[k], w[0], w[1]));
        let mut at: Vec<f64> = [zero(0), zero(1)].into_iter().flatten().collect();
        at.sort_by(f64::total_cmp);
        if let [a, b] = at[..] {
            // Between rulings that are one to rounding nothing could be followed.
            let (p, q) = (laid.ruling(panel, a), laid.ruling(panel, b));
            if (p[0] - q[0]).norm().max((p[1] - q[1]).norm()) <= same {
                out.push(laid.ruling(panel, 0.5 * (a + b)).to_vec());
                continue;
            }
        }
        at.insert(0, w[0]);
        at.push(w[1]);
        for p in at.windows(2).filter(|p| p[1] > p[0]) {
            let [x, y] = ends(0.5 * (p[0] + p[1]));
            if (x >= 0.0) == (y >= 0.0) {
                continue;
            }
            let place = |t: f64| {
                let [x, y] = ends(t);
                let s = if x == y { 0.5 } else { (x / (x - y)).clamp(0.0, 1.0) };
                laid.flat(&Spot { panel, t, s })
            };
            let mut points = vec![place(p[0])];
            follow(&place, (p[0], p[1]), tolerance, &mut points);
            join(&mut out, points, same);
        }
    }
    out
}

/// Appends points of a curve from `range.0` (which is there) to `range.1`.
fn follow(place: &dyn Fn(f64) -> Vec2, range: (f64, f64), tolerance: f64, out: &mut Vec<Vec2>) {
    let mut open = vec![(range.0, range.1, 0usize)];
    while let Some((a, b, depth)) = open.pop() {
        let (p, q) = (place(a), place(b));
        let chord = q - p;
        let off = |t: f64| {
            let d = place(t) - p;
            let across = chord.perp(&d).abs() / chord.norm();
            if across.is_finite() {
                across
            } else {
                d.norm()
            }
        };
        let worst = [0.3, 0.5, 0.7].map(|x| off(a + (b - a) * x)).into_iter().fold(0.0, f64::max);
        if worst > tolerance && depth < DEEPEST && out.len() + open.len() < MOST_POINTS {
            let m = 0.5 * (a + b);
            open.push((m, b, depth + 1));
            open.push((a, m, depth + 1));
        } else {
            out.push(q);
        }
    }
}

/// A zero of a function between two places where its signs differ.
fn root(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let first = f(a) >= 0.0;
    for _ in 0..STEPS {
        let m = 0.5 * (a + b);
        if m <= a || m >= b {
            break;
        }
        if (f(m) >= 0.0) == first {
            a = m;
        } else {
            b = m;
        }
    }
    0.5 * (a + b)
}

/// Adds a line, at the end of the last one if it goes on there.
fn join(lines: &mut Vec<Vec<Vec2>>, mut line: Vec<Vec2>, same: f64) {
    let near = |p: Option<&Vec2>, q: Option<&Vec2>| p.zip(q).is_some_and(|(p, q)| (p - q).norm() <= same);
    if let Some(last) = lines.last_mut() {
        if near(last.last(), line.last()) {
            line.reverse();
        }
        if near(last.last(), line.first()) {
            last.extend(line.into_iter().skip(1));
            return;
        }
    }
    lines.push(line);
}

/// The stretches of a line inside polygons.
pub(in crate::develop) fn clipped(line: &[Vec2], loops: &[Vec<Vec2>]) -> Vec<Vec<Vec2>> {
    clipped_near(line, loops, 0.0)
}

/// The stretches of a line inside polygons, or no farther than `near` (mm) beside their sides.
fn clipped_near(line: &[Vec2], loops: &[Vec<Vec2>], near: f64) -> Vec<Vec<Vec2>> {
    let mut out: Vec<Vec<Vec2>> = Vec::new();
    let mut open: Vec<Vec2> = Vec::new();
    for w in line.windows(2) {
        let (a, d) = (w[0], w[1] - w[0]);
        let mut at = vec![0.0, 1.0];
        for (p, q) in sides(loops) {
            let (s, t) = (d.perp(&(p - a)), d.perp(&(q - a)));
            if (s > 0.0) != (t > 0.0) {
                let x = p + (q - p) * (s / (s - t));
                at.push((x - a).dot(&d) / d.norm_squared());
            }
        }
        // What runs along a side ends where that does.
        let beside = loops.iter().flatten().filter(|p| near > 0.0 && d.perp(&(*p - a)).abs() <= near * d.norm());
        at.extend(beside.map(|p| (p - a).dot(&d) / d.norm_squared()));
        at.retain(|x| (0.0..=1.0).contains(x));
        at.sort_by(f64::total_cmp);
        for x in at.windows(2).filter(|x| x[1] > x[0]) {
            let middle = a + d * (0.5 * (x[0] + x[1]));
            if !inside(loops, &middle) && (near <= 0.0 || distance(loops, &middle) > near) {
                if open.len() > 1 {
                    out.push(std::mem::take(&mut open));
                }
                open.clear();
                continue;
            }
            if open.is_empty() {
                open.push(a + d * x[0]);
            }
            open.push(a + d * x[1]);
        }
    }
    if open.len() > 1 {
        out.push(open);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::arcs::points_along;
    use crate::develop::shop::specimens::{cone, cylinder, part_of, pattern_of};

    /// Length of a line of straight pieces.
    fn length(line: &MarkLine) -> f64 {
        line.joints.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum()
    }

    fn plane(normal: Vec3, offset: f64) -> SectionPlane {
        SectionPlane { normal: normal.normalize(), offset, label: "FR 1".into() }
    }

    #[test]
    fn sections_lie_in_their_plane_and_inside_the_part() {
        let (patchwork, pattern) = pattern_of(vec![cone("a", 0.0, 1.0), cone("b", 1.0, 1.7)], 1.0);
        let laid = Laid::of(&patchwork, &part_of(2), &pattern).expect("maps");
        for at in [plane(Vec3::new(1.0, 0.4, 0.3), 70.0), plane(Vec3::new(0.2, 0.1, 1.0), 60.0)] {
            let found = sections(&laid, &pattern, std::slice::from_ref(&at), 0.01);
            assert_eq!(found.len(), 1, "one line across both panels: {found:?}");
            for w in found[0].joints.windows(2) {
                for share in [0.1, 0.5] {
                    let on = points_along(&w[0].point, &w[1].point, w[0].bulge, 10);
                    let spot = laid.spot(&on[(share * on.len() as f64) as usize]).expect("a place on the part");
                    assert!((at.normal.dot(&laid.space(&spot)) - at.offset).abs() < 0.05);
                }
            }
        }
        assert!(sections(&laid, &pattern, &[plane(Vec3::x(), 500.0)], 0.01).is_empty());
    }

    #[test]
    fn a_plane_along_the_rulings_marks_whole_rulings() {
        let (patchwork, pattern) = pattern_of(vec![cylinder("a", 0.0, 1.2)], 1.0);
        let laid = Laid::of(&patchwork, &part_of(1), &pattern).expect("maps");
        let found = sections(&laid, &pattern, &[plane(Vec3::x(), 90.0)], 0.01);
        assert_eq!((found.len(), found[0].joints.len(), found[0].label.as_str()), (1, 2, "FR 1"));
        assert!((length(&found[0]) - 80.0).abs() < 1e-6);
        // So does one through the ruling at which two panels are joined.
        let (two, both) = pattern_of(vec![cylinder("a", -0.7, 0.0), cylinder("b", 0.0, 0.6)], 1.0);
        let joined = Laid::of(&two, &part_of(2), &both).expect("maps");
        for tilt in [0.0, 1e-13] {
            let found = sections(&joined, &both, &[plane(Vec3::new(0.0, 1.0, tilt), 0.0)], 0.01);
            assert_eq!((found.len(), found[0].joints.len()), (1, 2), "{found:?}");
            assert!((length(&found[0]) - 80.0).abs() < 1e-6);
        }
        // Waterlines of an upright cylinder are straight and as long as the arc.
        assert!(sections(&laid, &pattern, &[plane(Vec3::z(), 80.0), plane(Vec3::z(), 0.0)], 0.01).is_empty());
        let level = sections(&laid, &pattern, &[plane(Vec3::z(), 30.0)], 0.01);
        assert!((length(&level[0]) - 120.0).abs() < 1e-3 && level[0].joints.len() == 2, "{level:?}");
        // One that is nearly along them crosses all heights within few rulings.
        let steep = sections(&laid, &pattern, &[plane(Vec3::new(1.0, 0.0, 1e-4), 90.0)], 0.01);
        assert_eq!(steep.len(), 1);
        assert!((length(&steep[0]) - 80.0).abs() < 1e-3);
    }

    #[test]
    fn lines_end_at_the_outline_and_go_on_behind_holes() {
        let square = |a: f64, b: f64| vec![Vec2::new(a, a), Vec2::new(b, a), Vec2::new(b, b), Vec2::new(a, b)];
        let loops = vec![square(0.0, 10.0), square(4.0, 6.0)];
        let found = clipped(&[Vec2::new(-5.0, 5.0), Vec2::new(2.0, 5.0), Vec2::new(15.0, 5.0)], &loops);
        let ends: Vec<(f64, f64)> = found.iter().map(|l| (l[0].x, l[l.len() - 1].x)).collect();
        assert_eq!(ends, [(0.0, 4.0), (6.0, 10.0)]);
        // Along a side where that is meant, and no farther.
        let along = clipped_near(&[Vec2::new(-5.0, 10.0), Vec2::new(15.0, 10.0)], &loops, 1e-6);
        let ends: Vec<(f64, f64)> = along.iter().map(|l| (l[0].x, l[l.len() - 1].x)).collect();
        assert_eq!(ends, [(0.0, 10.0)]);
    }
}
