//! Lines to be marked, from points that follow each other: lines and arcs through some of them, as few as keep to all.
//!
//! *Method*. A polygon whose points lie on one circle is that circle. Else, from one corner of the polygon to the next, the line or the arc
//! through the first, the middle and the last point is taken that reaches farthest within the distance, sought by doubling and
//! halving. It is compared with the points and the middles between them.
//! *Guarantee*: joints are points that were given, and the distance answered is that of all points and middles.
//! *Not guaranteed*: tangents agree where two pieces join only as far as the distance forces them to; corners may be missed by as much.

use super::arcs::distance_to_arc;
use crate::geom::Vec2;
use crate::patchwork::pattern::{ContourVertex, MarkLine};
use std::f64::consts::PI;

/// Turn (rad) of a polygon at a point above which this is a corner: points are close enough that no smooth curve turns so much
/// between them, but for one that is hardly larger than the distance.
const CORNER: f64 = 0.3;
/// Length of an arc against that of a line within the same distance up to which the line is taken.
const LONGER: f64 = 1.5;
/// Length of a polygon against that of the piece that stands for it above which it runs to and fro.
const STRAYS: f64 = 1.05;
/// Share of the distance within which the ends of a polygon are one place.
const ONE_PLACE: f64 = 1e-3;
/// Bulge of an arc at most, of about two radians: where longer ones run is told badly by radii, which SVG files have.
const LONGEST: f64 = 0.55;
/// Bulge of a quarter of a circle.
const QUARTER: f64 = std::f64::consts::SQRT_2 - 1.0;
/// Points of a polygon that may be a circle at least.
const ROUND: usize = 8;
/// Factor by which a step grows while the end of a piece is sought.
const GROWTH: usize = 2;
/// Steps in a row without a piece after which no farther one is looked for.
const MISSES: usize = 3;

/// The line or arc between two points.
#[derive(Clone, Copy)]
struct Reach {
    /// Index of its last point.
    end: usize,
    bulge: f64,
    length: f64,
    /// Distance of the points and middles between, mm.
    off: f64,
}

/// A polygon of at least two points, with its lengths from the first one.
struct Polygon<'a> {
    points: &'a [Vec2],
    at: Vec<f64>,
}

/// Lines and arcs within `tolerance` (mm) of points that follow each other and of the middles between them, and the greatest distance
/// (mm) of these.
pub(super) fn marked(label: &str, points: &[Vec2], tolerance: f64) -> (MarkLine, f64) {
    // No tangents are kept, so every joint may be a corner.
    let joint = |point: Vec2, bulge: f64| ContourVertex { point, bulge, corner: true };
    let mut points = points.to_vec();
    points.dedup();
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return (MarkLine { label: label.into(), ..MarkLine::default() }, 0.0);
    };
    let gap = (last - first).norm();
    let closed = points.len() > ROUND && gap <= ONE_PLACE * tolerance;
    if closed {
        let end = points.len() - 1;
        points[end] = first;
    }
    let polygon = Polygon::new(&points);
    if let Some((centre, turn, off)) = polygon.round(tolerance).filter(|_| closed) {
        let arm = first - centre;
        let across = Vec2::new(-arm.y, arm.x) * turn;
        let joints = [arm, across, -arm, -across].map(|a| joint(centre + a, turn * QUARTER)).to_vec();
        return (MarkLine { label: label.into(), joints, closed }, off + gap);
    }
    let mut joints = Vec::new();
    let mut off = 0.0_f64;
    let mut corners = polygon.corners();
    corners.push(points.len() - 1);
    let mut from = 0;
    for to in corners {
        while from < to {
            let piece = polygon.farthest(from, to, tolerance);
            joints.push(joint(points[from], piece.bulge));
            off = off.max(piece.off);
            from = piece.end;
        }
    }
    if !closed {
        joints.push(joint(last, 0.0));
    }
    (MarkLine { label: label.into(), joints, closed }, if closed { off + gap } else { off })
}

impl<'a> Polygon<'a> {
    fn new(points: &'a [Vec2]) -> Self {
        let mut at = vec![0.0];
        for w in points.windows(2) {
            at.push(at[at.len() - 1] + (w[1] - w[0]).norm());
        }
        Self { points, at }
    }

    /// Its inner corners.
    fn corners(&self) -> Vec<usize> {
        let p = self.points;
        let turn = |k: &usize| {
            let (a, b) = (p[*k] - p[k - 1], p[k + 1] - p[*k]);
            a.perp(&b).atan2(a.dot(&b)).abs()
        };
        (1..p.len().saturating_sub(1)).filter(|k| turn(k) > CORNER).collect()
    }

    /// The point that is nearest to half of the way between two.
    fn middle(&self, from: usize, to: usize) -> usize {
        let half = 0.5 * (self.at[from] + self.at[to]);
        let k = self.at.partition_point(|x| *x < half).clamp(from + 1, to);
        if k > from + 1 && half - self.at[k - 1] < self.at[k] - half {
            k - 1
        } else {
            k.min(to - 1)
        }
    }

    /// Its points and middles between two points.
    fn between(&self, from: usize, to: usize) -> impl Iterator<Item = Vec2> + '_ {
        let p = self.points;
        (from..to).flat_map(move |k| [p[k], (p[k] + p[k + 1]) * 0.5]).skip(1)
    }

    /// The piece from one point to another with a bulge, if it keeps within a distance.
    fn piece(&self, [from, to]: [usize; 2], bulge: f64, tolerance: f64) -> Option<Reach> {
        let (a, b) = (self.points[from], self.points[to]);
        let half = 2.0 * bulge.abs().atan();
        let chord = (b - a).norm();
        let length = if bulge == 0.0 { chord } else { chord * half / half.sin() };
        let strays = self.at[to] - self.at[from] > STRAYS * length + tolerance;
        if strays || !length.is_finite() {
            return None;
        }
        let mut off = 0.0_f64;
        for x in self.between(from, to) {
            off = off.max(distance_to_arc(&x, &a, &b, bulge));
            if off.is_nan() || off > tolerance {
                return None;
            }
        }
        Some(Reach { end: to, bulge, length, off })
    }

    /// The line between two points.
    fn line(&self, from: usize, to: usize, tolerance: f64) -> Option<Reach> {
        self.piece([from, to], 0.0, tolerance)
    }

    /// The arc through two points and the middle between them.
    fn arc(&self, from: usize, to: usize, tolerance: f64) -> Option<Reach> {
        if to < from + 2 {
            return None;
        }
        let (a, m, b) = (self.points[from], self.points[self.middle(from, to)], self.points[to]);
        let (u, w) = (a - m, b - m);
        let seen = u.perp(&w).atan2(u.dot(&w));
        // The angle in which the chord is seen from the arc is half a turn less half its sweep.
        let bulge = (0.5 * (PI - seen.abs())).tan() * -seen.signum();
        (bulge != 0.0 && bulge.abs() <= LONGEST).then(|| self.piece([from, to], bulge, tolerance))?
    }

    /// The piece that reaches farthest from a point, and no farther than another one.
    fn farthest(&self, from: usize, most: usize, tolerance: f64) -> Reach {
        let next = Reach { end: from + 1, bulge: 0.0, length: self.at[from + 1] - self.at[from], off: 0.0 };
        let line = sought((from, next), most, |to| self.line(from, to, tolerance));
        if line.end == most {
            return line;
        }
        let arc = sought((from, line), most, |to| self.arc(from, to, tolerance));
        if arc.bulge != 0.0 && (arc.end == most || arc.length > LONGER * line.length) {
            arc
        } else {
            line
        }
    }

    /// Centre, sense (1 or −1) and distance of the circle that it is within a distance, if it is one.
    fn round(&self, tolerance: f64) -> Option<(Vec2, f64, f64)> {
        let n = self.points.len() - 1;
        let whole = self.at[n];
        let place = |share: f64| self.at.partition_point(|x| *x < share * whole).min(n - 1);
        let [a, b, c] = [self.points[0], self.points[place(1.0 / 3.0)], self.points[place(2.0 / 3.0)]];
        let (u, w) = (b - a, c - a);
        let twice = 2.0 * u.perp(&w);
        let from_first =
            Vec2::new(w.y * u.norm_squared() - u.y * w.norm_squared(), u.x * w.norm_squared() - w.x * u.norm_squared());
        let centre = a + from_first / twice;
        let radius = (a - centre).norm();
        let off = self.between(0, n).map(|x| ((x - centre).norm() - radius).abs()).fold(0.0, f64::max);
        let around = (whole - 2.0 * PI * radius).abs() <= (STRAYS - 1.0) * whole;
        (off <= tolerance && around).then_some((centre, twice.signum(), off))
    }
}

/// The farthest piece from a point that is one, and farther than a first one: by doubling the step, then by halving.
fn sought((from, first): (usize, Reach), most: usize, piece: impl Fn(usize) -> Option<Reach>) -> Reach {
    let (mut best, mut beyond, mut missed, mut step) = (first, most + 1, 0, GROWTH);
    while missed < MISSES {
        let to = (from + step).min(most);
        if to > best.end {
            match piece(to) {
                Some(p) => (best, beyond, missed) = (p, most + 1, 0),
                None => (beyond, missed) = (beyond.min(to), missed + 1),
            }
        }
        if to == most {
            break;
        }
        step *= GROWTH;
    }
    while beyond - best.end > 1 {
        let to = best.end + (beyond - best.end) / 2;
        match piece(to) {
            Some(p) => best = p,
            None => beyond = to,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 0.01;

    fn points(n: usize, at: impl Fn(f64) -> (f64, f64)) -> Vec<Vec2> {
        (0..=n).map(|k| at(k as f64 / n as f64)).map(|(x, y)| Vec2::new(x, y)).collect()
    }

    #[test]
    fn a_line_is_one_line_and_a_circle_one_circle() {
        let (line, off) = marked("A", &points(200, |t| (30.0 * t, 40.0 * t)), TOLERANCE);
        assert_eq!((line.label.as_str(), line.joints.len(), line.closed), ("A", 2, false));
        assert!(line.joints.iter().all(|j| j.bulge == 0.0) && off < 1e-12, "{off}");
        for turn in [1.0, -1.0] {
            let (sin, cos) = (|t: f64| (turn * 2.0 * PI * t).sin(), |t: f64| (turn * 2.0 * PI * t).cos());
            let (circle, off) = marked("", &points(300, |t| (5.0 + 3.0 * cos(t), 3.0 * sin(t))), TOLERANCE);
            let contour = circle.contour();
            let (centre, radius) = contour.circle().expect("a circle");
            assert!(circle.closed && (centre - Vec2::new(5.0, 0.0)).norm() < 1e-9 && (radius - 3.0).abs() < 1e-9);
            // Middles of chords are that far inside.
            assert!(off < 2e-4 && circle.joints.len() == 4 && circle.joints[0].bulge * turn > 0.0, "{off}");
        }
    }

    #[test]
    fn a_slot_is_two_lines_and_few_arcs() {
        let arc = |k: usize, from: f64| {
            let (sin, cos) = (from + PI * k as f64 / 40.0).sin_cos();
            Vec2::new(if from > 0.0 { -10.0 } else { 10.0 } + 4.0 * cos, 4.0 * sin)
        };
        let straight = |from: Vec2, to: Vec2| (0..60).map(move |k| from + (to - from) * (k as f64 / 60.0));
        let right = (0..40).map(|k| arc(k, -0.5 * PI));
        let left = (0..40).map(|k| arc(k, 0.5 * PI));
        let mut all: Vec<Vec2> = straight(Vec2::new(-10.0, -4.0), Vec2::new(10.0, -4.0)).chain(right).collect();
        all.extend(straight(Vec2::new(10.0, 4.0), Vec2::new(-10.0, 4.0)).chain(left));
        all.push(all[0]);
        let (slot, off) = marked("", &all, TOLERANCE);
        assert!(slot.closed && slot.joints.len() <= 8 && off <= TOLERANCE, "{off} {slot:?}");
        assert!(slot.joints.iter().filter(|j| j.bulge > 0.2).count() >= 4, "{slot:?}");
    }

    #[test]
    fn corners_stay_and_curves_need_few_arcs() {
        let zigzag = points(90, |t| (30.0 * t, if t < 0.5 { 20.0 * t } else { 20.0 - 20.0 * t }));
        let (line, _) = marked("", &zigzag, TOLERANCE);
        assert_eq!(line.joints.iter().map(|j| j.point).collect::<Vec<_>>(), [0, 45, 90].map(|k| zigzag[k]));
        let wave = points(2000, |t| (300.0 * t, 20.0 * (12.0 * t).sin()));
        let (line, off) = marked("", &wave, TOLERANCE);
        assert!(line.joints.len() < 45 && off <= TOLERANCE, "{} {off}", line.joints.len());
        // Every point of the wave is near the lines and arcs.
        let near = |p: &Vec2| {
            let pieces = line.joints.windows(2);
            pieces.map(|w| distance_to_arc(p, &w[0].point, &w[1].point, w[0].bulge)).fold(f64::INFINITY, f64::min)
        };
        assert!(wave.iter().map(near).fold(0.0, f64::max) <= off + 1e-12);
    }

    #[test]
    fn few_points_are_joined_by_lines() {
        let (a, b) = (Vec2::new(1.0, 2.0), Vec2::new(3.0, 4.0));
        assert_eq!(marked("", &[a, b], TOLERANCE).0.joints.len(), 2);
        assert_eq!(marked("", &[a, b, a], TOLERANCE).0.joints.len(), 3);
        assert!(marked("", &[], TOLERANCE).0.joints.is_empty());
    }
}
