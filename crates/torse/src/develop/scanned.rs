//! The outline of measured points in the plane, and patterns cut back to it.
//!
//! *Method.* The alpha shape \[EKS83\]: of the Delaunay triangles of the points, those with small circumcircles belong to the sheet;
//! their border is the outline. "Small" is measured by the triangles themselves, which know the spacing of the points.
//! The outline is carried to the patch of the strip: there it is a polygon of the parameter plane, and its corners are places
//! of measured points. *Not guaranteed*: anything between the points; a sheet may end up to a spacing outside of its
//! outermost points. How far the outline keeps from the points is judged elsewhere.

use super::map::Development;
use crate::geom::inside::Inside;
use crate::geom::polygon::area;
use crate::geom::rectangle::smallest_rectangle;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::panel::{Border, Coedge};
use crate::patchwork::pattern::{Contour, ContourVertex, Pattern};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use spade::{DelaunayTriangulation, Point2, Triangulation as _};
use std::collections::{HashMap, HashSet};

/// Circumradius up to which triangles belong to the sheet, in median circumradii: gaps between points that fell at random
/// are hardly ever wider, and a notch or a hole of a few spacings is seen.
const ALPHA: f64 = 4.0;
/// The same in median circumradii by area of what hangs together: that of the stretches between the lines of a scanner, some of
/// which are twice as wide as others.
const LINES: f64 = 2.5;
/// Share of the area at which a radius is typical, and that at which a side is told as spacing: of points that fell at random the
/// large triangles have more of the area than of the points.
const HALF: f64 = 0.5;
const TOLD: f64 = 0.25;
/// Steps in which the circumradius grows where points lie in many lines, and by what factor.
const WIDENED: usize = 12;
const WIDER: f64 = 1.5;
/// Radius (in the same measure as [`ALPHA`], times it) of a circle with the area of the smallest hole that is cut out.
const HOLE: f64 = 1.25;
/// Share of the median circumradius by which corners may lie off the outline that is drawn.
const STRAIGHT: f64 = 0.1;
/// Cells over the longer side of the points; one point of each is taken.
const CELLS: f64 = 500.0;
/// Share of the points that may lie outside of the outline: more are another part of the sheet.
const STRAY: f64 = 0.01;
/// Fewest points that have an outline.
const FEWEST: usize = 30;

/// The outline of points.
#[derive(Clone, Debug)]
pub(crate) struct ScanOutline {
    /// Closed polygons: the outer one counter-clockwise, then holes clockwise.
    pub loops: Vec<Vec<Vec2>>,
    /// Typical distance between neighbouring points, mm.
    pub spacing: f64,
    /// What an outline of this kind keeps to, mm: no point farther outside than the first, no place inside farther from the
    /// points than the second.
    pub keeps: [f64; 2],
    /// Holes too small to be cut out.
    pub closed: usize,
    /// Points apart from the others, outside of the outline.
    pub stray: usize,
}

/// The outline of points of the plane; `None` where they are too few, lie in a line, or in parts that are apart.
pub fn outline(points: &[Vec2]) -> Option<ScanOutline> {
    let (taken, left_out) = thinned(points);
    if taken.len() < FEWEST {
        return None;
    }
    let sites = taken.iter().map(|p| Point2::new(p.x, p.y)).collect();
    let net = DelaunayTriangulation::<Point2<f64>>::bulk_load(sites).ok()?;
    let shapes: Vec<Shape> = net.inner_faces().map(|f| Shape::of(f.positions().map(|p| Vec2::new(p.x, p.y)))).collect();
    let mut radii: Vec<f64> = shapes.iter().map(|s| s.radius).collect();
    let middle = radii.len() / 2;
    if radii.is_empty() {
        return None;
    }
    let median = *radii.select_nth_unstable_by(middle, f64::total_cmp).1;
    let mut alpha = wide_enough(&shapes, ALPHA * median);
    // Lines whose points stray by more than these are apart have most of their triangles inside themselves.
    for _ in 0..WIDENED {
        if let Some(found) = outline_at(&net, &taken, (alpha, STRAIGHT * median, left_out)) {
            let kept = shapes.iter().filter(|s| s.radius <= alpha);
            let spacing = by_area(kept.map(|s| (s.second, s.area)), TOLD);
            return Some(ScanOutline { spacing, ..found });
        }
        let kept = || shapes.iter().filter(|s| s.radius <= alpha);
        if !are_lines(&net, alpha, kept().map(|s| s.area).sum()) {
            return None;
        }
        alpha = wide_enough(&shapes, WIDER * alpha);
    }
    None
}

/// What is looked at of a triangle.
struct Shape {
    /// Radius of its circumcircle, mm.
    radius: f64,
    /// Its second longest side, mm: between points of a grid their distance, between dense lines that of the lines.
    second: f64,
    /// Its area, mm².
    area: f64,
}

impl Shape {
    fn of([a, b, c]: [Vec2; 3]) -> Self {
        let mut sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
        let area = 0.5 * (b - a).perp(&(c - a)).abs();
        let radius = sides.iter().product::<f64>() / (4.0 * area);
        sides.sort_by(f64::total_cmp);
        Self { radius: if radius.is_finite() { radius } else { f64::INFINITY }, second: sides[1], area }
    }
}

/// The value below which the triangles that have it or less make up a share of the area.
fn by_area(values: impl Iterator<Item = (f64, f64)>, share: f64) -> f64 {
    let mut all: Vec<(f64, f64)> = values.collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = share * all.iter().map(|v| v.1).sum::<f64>();
    let mut sum = 0.0;
    let reached = all.iter().find(|v| {
        sum += v.1;
        sum >= wanted
    });
    reached.map_or(0.0, |v| v.0)
}

/// A circumradius up to which triangles belong to the sheet, `least` or more: where most of the area that hangs together is of
/// triangles nearly as large, as between the lines of a scanner, some of which are farther apart than others, a larger one.
fn wide_enough(shapes: &[Shape], least: f64) -> f64 {
    let mut alpha = least;
    for _ in 0..WIDENED {
        let own = by_area(shapes.iter().filter(|s| s.radius <= alpha).map(|s| (s.radius, s.area)), HALF);
        if LINES * own <= alpha {
            break;
        }
        alpha = LINES * own;
    }
    alpha
}

/// Whether what hangs together of triangles with circumradii up to `alpha` are many lines: narrower than `alpha` allows gaps to be.
fn are_lines(net: &Net, alpha: f64, area: f64) -> bool {
    let kept = kept(net, alpha);
    let on_border = net.directed_edges().filter(|e| kept[e.face().index()] && !kept[e.rev().face().index()]);
    let border: f64 = on_border.map(|e| e.length_2().sqrt()).sum();
    // Twice the area over the border is the mean width of slim pieces.
    area <= alpha * border
}

/// Which faces of a net are triangles with circumradii up to `alpha`.
fn kept(net: &Net, alpha: f64) -> Vec<bool> {
    net.all_faces().map(|f| f.as_inner().is_some_and(|f| f.circumcircle().1.sqrt() <= alpha)).collect()
}

type Net = DelaunayTriangulation<Point2<f64>>;

/// The outline by triangles with circumradii up to `alpha`; corners may lie `off` it, and points that were not taken
/// `left_out` from those taken. `None` where it leaves out more than strays.
fn outline_at(net: &Net, taken: &[Vec2], (alpha, off, left_out): (f64, f64, f64)) -> Option<ScanOutline> {
    let kept = kept(net, alpha);
    let mut next: HashMap<usize, Vec<usize>> = HashMap::new();
    for e in net.directed_edges() {
        if kept[e.face().index()] && !kept[e.rev().face().index()] {
            next.entry(e.from().index()).or_default().push(e.to().index());
        }
    }
    let place: HashMap<usize, Vec2> =
        net.vertices().map(|v| (v.index(), Vec2::new(v.position().x, v.position().y))).collect();
    let loops: Vec<Vec<Vec2>> =
        closed_walks(next).iter().map(|w| w.iter().filter_map(|i| place.get(i).copied()).collect()).collect();
    let outer = loops.iter().max_by(|a, b| area(a).total_cmp(&area(b))).filter(|l| area(l) > 0.0)?.clone();
    let around = Inside::of([&outer]);
    let holes: Vec<&Vec<Vec2>> = loops.iter().filter(|l| area(l) < 0.0 && around.holds(&l[0])).collect();
    let least = std::f64::consts::PI * (HOLE * alpha).powi(2);
    let key = |p: &Vec2| [p.x.to_bits(), p.y.to_bits()];
    // Holes that meet the border or each other in a corner would leave a sheet that hangs together in a point.
    let mut taken_up: HashSet<[u64; 2]> = outer.iter().map(key).collect();
    let (cut, closed): (Vec<&Vec<Vec2>>, Vec<&Vec<Vec2>>) = holes.into_iter().partition(|h| {
        -area(h) >= least && !h.iter().any(|p| taken_up.contains(&key(p))) && {
            taken_up.extend(h.iter().map(key));
            true
        }
    });
    // Corners of the outer polygon are neither inside nor outside by counting crossings.
    let corners: HashSet<[u64; 2]> = outer.iter().map(key).collect();
    let out = |p: &&Vec2| !corners.contains(&key(p)) && !around.holds(p);
    let stray = taken.iter().filter(out).count();
    if stray as f64 > STRAY * taken.len() as f64 {
        return None;
    }
    let hole = closed.iter().map(|h| half(h)).fold(0.0, f64::max);
    let all: Vec<&Vec<Vec2>> = std::iter::once(&outer).chain(cut).collect();
    let straight: Vec<Vec<Vec2>> = all.iter().map(|l| straightened(l, off)).collect();
    Some(ScanOutline {
        keeps: [alpha + off + left_out, alpha + hole + off + left_out],
        // Straight lines may cut through spikes that lie beside them.
        loops: if crosses(&straight) { all.into_iter().cloned().collect() } else { straight },
        spacing: 0.0,
        closed: closed.len(),
        stray,
    })
}

/// Whether sides of polygons cross.
fn crosses(loops: &[Vec<Vec2>]) -> bool {
    let mut sides: Vec<[Vec2; 2]> =
        loops.iter().flat_map(|l| (0..l.len()).map(|k| [l[k], l[(k + 1) % l.len()]])).collect();
    let low = |s: &[Vec2; 2]| s[0].x.min(s[1].x);
    sides.sort_by(|a, b| low(a).total_cmp(&low(b)));
    let apart = |[a, b]: &[Vec2; 2], [p, q]: &[Vec2; 2]| {
        let d = b - a;
        (d.perp(&(p - a)) > 0.0) == (d.perp(&(q - a)) > 0.0)
    };
    let joined = |s: &[Vec2; 2], t: &[Vec2; 2]| s.iter().any(|p| t.contains(p));
    (0..sides.len()).any(|i| {
        let (s, end) = (&sides[i], sides[i][0].x.max(sides[i][1].x));
        let beside = sides[i + 1..].iter().take_while(|t| low(t) <= end);
        beside.into_iter().any(|t| !joined(s, t) && !apart(s, t) && !apart(t, s))
    })
}

/// Half the width of a polygon: half the shorter side of its smallest rectangle.
fn half(polygon: &[Vec2]) -> f64 {
    smallest_rectangle(polygon).map_or(0.0, |r| 0.5 * r.width)
}

/// One point of each cell, in no other order than given, and how far (mm) the others may be from these.
fn thinned(points: &[Vec2]) -> (Vec<Vec2>, f64) {
    let finite = || points.iter().filter(|p| p.x.is_finite() && p.y.is_finite());
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    for p in finite() {
        (low, high) = (low.inf(p), high.sup(p));
    }
    let cell = (high - low).max() / CELLS;
    if !(cell > 0.0 && cell.is_finite()) {
        return (Vec::new(), 0.0);
    }
    let mut seen = HashSet::new();
    let taken: Vec<Vec2> =
        finite().filter(|p| seen.insert((**p - low).map(|x| (x / cell) as i64).data.0)).copied().collect();
    let left_out = if taken.len() < finite().count() { std::f64::consts::SQRT_2 * cell } else { 0.0 };
    (taken, left_out)
}

/// Closed walks along directed edges; where one comes to a corner again, what lies between is a walk of its own.
pub(super) fn closed_walks(mut next: HashMap<usize, Vec<usize>>) -> Vec<Vec<usize>> {
    let mut starts: Vec<usize> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut out = Vec::new();
    for start in starts {
        while next.get(&start).is_some_and(|n| !n.is_empty()) {
            let (mut walk, mut at, mut now) = (vec![start], HashMap::from([(start, 0)]), start);
            while let Some(to) = next.get_mut(&now).and_then(Vec::pop) {
                if let Some(&from) = at.get(&to) {
                    let done: Vec<usize> = walk.drain(from + 1..).collect();
                    done.iter().for_each(|i| {
                        at.remove(i);
                    });
                    out.push(std::iter::once(to).chain(done).collect::<Vec<usize>>());
                } else {
                    at.insert(to, walk.len());
                    walk.push(to);
                }
                now = to;
            }
        }
    }
    out.retain(|w| w.len() > 2);
    out
}

/// A polygon without the corners that lie within `off` of the line between those kept, see [`needed`].
fn straightened(polygon: &[Vec2], off: f64) -> Vec<Vec2> {
    needed(polygon, off).into_iter().map(|k| polygon[k]).collect()
}

/// The corners of a polygon without those that lie within `off` of the line between those kept, by the method of Douglas and
/// Peucker.
pub(crate) fn needed(polygon: &[Vec2], off: f64) -> Vec<usize> {
    let n = polygon.len();
    let Some(far) = (0..n).max_by(|i, j| {
        let d = |k: usize| (polygon[k] - polygon[0]).norm_squared();
        d(*i).total_cmp(&d(*j))
    }) else {
        return Vec::new();
    };
    let mut keep = vec![false; n];
    (keep[0], keep[far]) = (true, true);
    let mut open = vec![(0, far), (far, n)];
    while let Some((i, j)) = open.pop() {
        let (a, b) = (polygon[i], polygon[j % n]);
        let d = b - a;
        let from = |k: &usize| {
            let t = if d.norm_squared() > 0.0 {
                ((polygon[*k] - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (a + d * t - polygon[*k]).norm()
        };
        let Some(k) = (i + 1..j).max_by(|x, y| from(x).total_cmp(&from(y))) else { continue };
        if from(&k) > off {
            keep[k] = true;
            open.extend([(i, k), (k, j)]);
        }
    }
    (0..n).filter(|k| keep[*k]).collect()
}

/// Turn (rad) from which a corner of the outline is one of the sheet: what a fine outline turns from point to point is not.
const CORNER: f64 = 0.5;

/// A loop of an outline, in the plane and on the patch: the same corners in the same order.
#[derive(Clone, Debug)]
pub(crate) struct CarriedLoop {
    /// As it is drawn; begins with a corner.
    pub contour: Vec<ContourVertex>,
    /// As it bounds the panel: runs from corner to corner.
    pub runs: Vec<Coedge>,
}

/// A flat map as a pattern shows it.
pub(crate) struct Shown<'a> {
    /// The map.
    pub development: &'a Development,
    /// The patch that it lays flat.
    pub patch: &'a Surface,
    /// Whether the pattern is its mirror image.
    pub mirrored: bool,
    /// By how much chords may lie beside what they stand for, in the plane and in space, mm.
    pub chord: f64,
}

/// Halvings of a side of an outline.
const HALVINGS: usize = 12;
/// Steps of Newton's method: places are found from near ones.
const STEPS: usize = 8;

impl Shown<'_> {
    /// Where the pattern shows a place of the patch.
    pub fn flat(&self, at: &[f64; 2]) -> Vec2 {
        let p = self.development.map(at[0], at[1]);
        Vec2::new(if self.mirrored { -p.x } else { p.x }, p.y)
    }

    /// The place on the patch whose image is nearest to `p`, from one near it.
    pub fn place(&self, p: &Vec2, near: [f64; 2]) -> [f64; 2] {
        let (from, to) = self.development.domain();
        let mut at = near;
        for _ in 0..STEPS {
            let slope = |dt: f64, dr: f64| {
                let d = self.development.tangent(at[0], at[1], dt, dr);
                Vec2::new(if self.mirrored { -d.x } else { d.x }, d.y)
            };
            let (a, b, w) = (slope(1.0, 0.0), slope(0.0, 1.0), p - self.flat(&at));
            let det = a.perp(&b);
            let next = [at[0] + w.perp(&b) / det, at[1] + a.perp(&w) / det];
            if !next.iter().all(|x| x.is_finite()) {
                break;
            }
            at = [next[0].clamp(from, to), next[1].clamp(0.0, 1.0)];
        }
        at
    }

    /// Places between two on the patch, after the first: as many as chords need. With `straight` they follow the line
    /// between the images, else the line of the parameter plane.
    fn between(&self, a: [f64; 2], b: [f64; 2], straight: bool, depth: usize, out: &mut Vec<[f64; 2]>) {
        let mut middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let point = |q: &[f64; 2]| self.patch.point(q[0], q[1]);
        let (p, q) = (self.flat(&a), self.flat(&b));
        let off = (self.flat(&middle) - (p + q) * 0.5).norm();
        let rise = (point(&middle) - (point(&a) + point(&b)) * 0.5).norm();
        if depth == HALVINGS || off.max(rise) <= self.chord {
            out.push(b);
            return;
        }
        if straight && off > self.chord {
            middle = self.place(&((p + q) * 0.5), middle);
        }
        self.between(a, middle, straight, depth + 1, out);
        self.between(middle, b, straight, depth + 1, out);
    }

    /// A closed polygon whose corners lie at these places of the patch; `sharp` says which are corners of the sheet.
    pub fn carried(&self, corners: &[([f64; 2], bool)], straight: bool) -> Option<CarriedLoop> {
        let n = corners.len();
        let (mut places, mut is_corner) = (Vec::new(), Vec::new());
        for k in 0..n {
            let start = places.len();
            self.between(corners[k].0, corners[(k + 1) % n].0, straight, 0, &mut places);
            is_corner.resize(places.len(), false);
            // What lies between two corners ends with the second of them.
            if places.len() > start {
                is_corner[places.len() - 1] = corners[(k + 1) % n].1;
            }
        }
        let mut all: Vec<([f64; 2], bool)> = places.into_iter().zip(is_corner).collect();
        all.dedup_by(|b, a| {
            let same = a.0 == b.0;
            a.1 |= same && b.1;
            same
        });
        if all.len() > 1 && all[0].0 == all[all.len() - 1].0 {
            all.pop();
        }
        // Two runs at least: an edge of a file should not end where it begins.
        let m = all.len();
        if all.iter().filter(|p| p.1).count() < 2 {
            [0, m / 2].into_iter().for_each(|k| all.iter_mut().skip(k).take(1).for_each(|p| p.1 = true));
        }
        let first = all.iter().position(|p| p.1)?;
        all.rotate_left(first);
        if m < 3 {
            return None;
        }
        let vertex =
            |(q, corner): &([f64; 2], bool)| ContourVertex { point: self.flat(q), bulge: 0.0, corner: *corner };
        let ends: Vec<usize> = (0..m).filter(|k| all[*k].1).chain([m]).collect();
        let runs = ends.windows(2).map(|w| self.run((w[0]..=w[1]).map(|k| all[k % m].0).collect(), w[0] as u32));
        Some(CarriedLoop { contour: all.iter().map(vertex).collect(), runs: runs.collect::<Option<_>>()? })
    }

    /// A polyline of the parameter plane as a run, with equal shares of its length in space.
    fn run(&self, control: Vec<[f64; 2]>, edge: u32) -> Option<Coedge> {
        let space: Vec<Vec3> = control.iter().map(|q| self.patch.point(q[0], q[1])).collect();
        let mut at = vec![0.0];
        for w in space.windows(2) {
            at.push(at[at.len() - 1] + (w[1] - w[0]).norm());
        }
        let (whole, last) = (at[at.len() - 1], at.len() - 1);
        at.iter_mut().for_each(|s| *s /= whole);
        at[last] = 1.0;
        let knots = Knots::clamped(1, &at).ok()?;
        Some(Coedge {
            border: Border::Trim { edge },
            vertices: Vec::new(),
            parameters: Vec::new(),
            edge: Curve { knots: knots.clone(), control: space.iter().map(|p| [p.x, p.y, p.z]).collect() },
            trim: Curve { knots, control },
        })
    }
}

/// Which corners of a polygon are corners of the sheet.
pub(crate) fn sharp(l: &[Vec2]) -> Vec<bool> {
    let n = l.len();
    let turn = |k: usize| {
        let (p, q) = (l[k] - l[(k + n - 1) % n], l[(k + 1) % n] - l[k]);
        p.perp(&q).atan2(p.dot(&q)).abs() > CORNER
    };
    (0..n).map(turn).collect()
}

/// A pattern cut back to contours of straight lines, the outer one first: its rulings are what lies inside; marks and sides,
/// which belong to the border that was cut away, are left out. `chord` (mm) is by how much lines may lie off the outline.
pub(crate) fn cut_back(pattern: &Pattern, contours: Vec<Contour>, chord: f64) -> Pattern {
    let polygons: Vec<Vec<Vec2>> = contours.iter().map(|c| c.vertices.iter().map(|v| v.point).collect()).collect();
    let loops: Vec<&Vec<Vec2>> = polygons.iter().collect();
    let inside = Inside::of(loops.iter().copied());
    let (mut rulings, mut bends) = (Vec::new(), Vec::new());
    for (k, ruling) in pattern.rulings.iter().enumerate() {
        for piece in pieces_inside((&loops, &inside), ruling) {
            rulings.push(piece);
            bends.push(pattern.bend(k));
        }
    }
    let area: f64 = loops.iter().map(|l| area(l)).sum();
    let (width, length) = loops.first().and_then(|l| smallest_rectangle(l)).map_or((0.0, 0.0), |r| (r.width, r.length));
    Pattern {
        contours,
        rulings,
        bends: if pattern.bends.is_empty() { Vec::new() } else { bends },
        marks: Vec::new(),
        sides: Vec::new(),
        area,
        area_in_space: pattern.area_in_space * area / pattern.area.max(f64::MIN_POSITIVE),
        contour_error: chord,
        width,
        length,
        ..pattern.clone()
    }
}

/// The parts of a segment inside polygons.
fn pieces_inside((loops, inside): (&[&Vec<Vec2>], &Inside), [a, b]: &[Vec2; 2]) -> Vec<[Vec2; 2]> {
    let d = b - a;
    let mut at = vec![0.0, 1.0];
    for l in loops {
        for k in 0..l.len() {
            let (p, q) = (l[k] - a, l[(k + 1) % l.len()] - a);
            let (s, t) = (d.perp(&p), d.perp(&q));
            if (s <= 0.0) != (t <= 0.0) {
                let x = p + (q - p) * (s / (s - t));
                at.push(x.dot(&d) / d.norm_squared());
            }
        }
    }
    at.retain(|t| (0.0..=1.0).contains(t));
    at.sort_by(f64::total_cmp);
    let middle = |w: &[f64]| a + d * (0.5 * (w[0] + w[1]));
    at.windows(2).filter(|w| w[1] > w[0] && inside.holds(&middle(w))).map(|w| [a + d * w[0], a + d * w[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disc of radius 100 with a round hole of radius 30 about (20, 0), points 2 apart.
    fn ring() -> Vec<Vec2> {
        let grid = (-50..=50).flat_map(|i| (-50..=50).map(move |j| Vec2::new(2.0 * f64::from(i), 2.0 * f64::from(j))));
        grid.filter(|p| p.norm() <= 100.0 && (p - Vec2::new(20.0, 0.0)).norm() >= 30.0).collect()
    }

    #[test]
    fn a_ring_of_points_has_its_outline_and_its_hole() {
        let found = outline(&ring()).expect("outline");
        assert_eq!((found.loops.len(), found.closed, found.stray), (2, 0, 0));
        let exact = std::f64::consts::PI * (100.0f64.powi(2) - 30.0f64.powi(2));
        let got: f64 = found.loops.iter().map(|l| area(l)).sum();
        assert!((got / exact - 1.0).abs() < 0.03, "{got} {exact}");
        assert!((found.spacing - 2.0).abs() < 0.1 && found.keeps[0] < 6.5 && found.keeps[1] < 6.5, "{found:?}");
        assert!(found.loops[0].iter().all(|p| p.norm() > 96.0 && p.norm() <= 100.0));
    }

    #[test]
    fn parts_that_are_apart_have_no_common_outline_and_a_stray_point_is_left_out() {
        let mut two = ring();
        two.extend(ring().iter().map(|p| p + Vec2::new(300.0, 0.0)));
        assert!(outline(&two).is_none() && outline(&two[..10]).is_none());
        let mut one = ring();
        one.push(Vec2::new(150.0, 0.0));
        assert_eq!(outline(&one).expect("outline").stray, 1);
    }

    /// Points of lines 15 apart, half a millimetre from each other on them, that stray by up to `astray` to both sides of
    /// their line; a hole about the middle.
    fn lines(astray: f64) -> Vec<Vec2> {
        let line = |j: i32| {
            (0..800).map(move |k| {
                let noise = (f64::from(k * 37 + j * 11) * 12.9898).sin();
                Vec2::new(0.5 * f64::from(k), 15.0 * f64::from(j) + astray * noise)
            })
        };
        (0..14).flat_map(line).filter(|p| (p - Vec2::new(200.0, 100.0)).norm() > 50.0).collect()
    }

    #[test]
    fn lines_of_a_scanner_make_one_sheet_and_their_distance_is_told() {
        for astray in [0.0, 0.05, 0.4, 1.5] {
            let all = lines(astray);
            let found = outline(&all).expect("outline");
            assert_eq!((found.loops.len(), found.stray), (2, 0), "{astray}");
            assert!((10.0..17.0).contains(&found.spacing), "{astray}: {}", found.spacing);
            let size: f64 = found.loops.iter().map(|l| area(l)).sum();
            let exact = 399.5 * 195.0 - std::f64::consts::PI * 2500.0;
            assert!((size / exact - 1.0).abs() < 0.04, "{astray}: {size} {exact}");
            assert!(found.keeps[0] < 45.0, "{astray}: {:?}", found.keeps);
        }
    }

    #[test]
    fn rulings_end_at_the_outline_and_at_the_hole() {
        let found = outline(&ring()).expect("outline");
        let pattern = Pattern {
            rulings: vec![[Vec2::new(-200.0, 0.5), Vec2::new(200.0, 0.5)]],
            area: 2.0 * std::f64::consts::PI * 1e4,
            ..Pattern::default()
        };
        let vertex = |p: &Vec2| ContourVertex { point: *p, bulge: 0.0, corner: false };
        let contour = |l: &Vec<Vec2>| Contour { vertices: l.iter().map(vertex).collect() };
        let cut = cut_back(&pattern, found.loops.iter().map(contour).collect(), 0.0);
        assert_eq!(cut.rulings.len(), 2);
        let xs: Vec<f64> = cut.rulings.iter().flatten().map(|p| p.x).collect();
        for (x, wanted) in xs.iter().zip([-100.0, -10.0, 50.0, 100.0]) {
            assert!((x - wanted).abs() < 4.0, "{xs:?}");
        }
        assert!(cut.length < 200.1 && cut.width > 195.0 && cut.marks.is_empty());
    }
}
