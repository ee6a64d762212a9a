//! The outline of measured points in the plane, and patterns cut back to it.
//!
//! *Method.* The alpha shape \[EKS83\]: of the Delaunay triangles of the points, those with small circumcircles belong to the sheet;
//! their border is the outline. "Small" is measured by the triangles themselves, which know the spacing of the points.
//! *Not guaranteed*: anything between the points; a sheet may end up to a spacing outside of its outermost points.

use crate::geom::rectangle::smallest_rectangle;
use crate::geom::Vec2;
use crate::patchwork::pattern::{Contour, ContourVertex, Pattern};
use spade::{DelaunayTriangulation, Point2, Triangulation as _};
use std::collections::HashMap;

/// Circumradius up to which triangles belong to the sheet, in median circumradii: gaps between points that fell at random
/// are hardly ever wider, and a notch or a hole of a few spacings is seen.
const ALPHA: f64 = 4.0;
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
    /// Largest distance (mm) of a place of the outline from the nearest point, and at most the distance by which points
    /// that belong to it lie outside.
    pub distance_estimate: f64,
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
    let mut radii: Vec<f64> = net.inner_faces().map(|f| f.circumcircle().1.sqrt()).collect();
    let middle = radii.len() / 2;
    if radii.is_empty() {
        return None;
    }
    let median = *radii.select_nth_unstable_by(middle, f64::total_cmp).1;
    let alpha = ALPHA * median;
    let kept: Vec<bool> =
        net.all_faces().map(|f| f.as_inner().is_some_and(|f| f.circumcircle().1.sqrt() <= alpha)).collect();
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
    let holes: Vec<&Vec<Vec2>> = loops.iter().filter(|l| area(l) < 0.0 && inside(&[&outer], &l[0])).collect();
    let least = std::f64::consts::PI * (HOLE * alpha).powi(2);
    let (cut, closed): (Vec<&Vec<Vec2>>, Vec<&Vec<Vec2>>) = holes.into_iter().partition(|h| -area(h) >= least);
    // Corners of the outer polygon are neither inside nor outside by counting crossings.
    let corners: std::collections::HashSet<[u64; 2]> = outer.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
    let around = Inside::of(&outer);
    let out = |p: &&Vec2| !corners.contains(&[p.x.to_bits(), p.y.to_bits()]) && !around.holds(p);
    let stray = taken.iter().filter(out).count();
    if stray as f64 > STRAY * taken.len() as f64 {
        return None;
    }
    let longest = |l: &Vec<Vec2>| (0..l.len()).map(|k| (l[(k + 1) % l.len()] - l[k]).norm()).fold(0.0, f64::max);
    let off = STRAIGHT * median;
    let all: Vec<&Vec<Vec2>> = std::iter::once(&outer).chain(cut).collect();
    Some(ScanOutline {
        distance_estimate: 0.5 * all.iter().map(|l| longest(l)).fold(0.0, f64::max) + off + left_out,
        loops: all.into_iter().map(|l| straightened(l, off)).collect(),
        // Circumradius of a right-angled half of a square with this side.
        spacing: std::f64::consts::SQRT_2 * median,
        closed: closed.len(),
        stray,
    })
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
    let mut seen = std::collections::HashSet::new();
    let taken: Vec<Vec2> =
        finite().filter(|p| seen.insert((**p - low).map(|x| (x / cell) as i64).data.0)).copied().collect();
    let left_out = if taken.len() < finite().count() { std::f64::consts::SQRT_2 * cell } else { 0.0 };
    (taken, left_out)
}

/// Closed walks along directed edges; where one comes to a corner again, what lies between is a walk of its own.
fn closed_walks(mut next: HashMap<usize, Vec<usize>>) -> Vec<Vec<usize>> {
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

fn area(polygon: &[Vec2]) -> f64 {
    let n = polygon.len();
    let Some(o) = polygon.first() else { return 0.0 };
    (0..n).map(|k| 0.5 * (polygon[k] - o).perp(&(polygon[(k + 1) % n] - o))).sum()
}

/// Whether a point lies inside polygons, even-odd.
fn inside(polygons: &[&Vec<Vec2>], p: &Vec2) -> bool {
    let crosses = |l: &&Vec<Vec2>| (0..l.len()).filter(|&k| passes(&l[k], &l[(k + 1) % l.len()], p)).count();
    polygons.iter().map(crosses).sum::<usize>() % 2 == 1
}

/// Whether a side passes a point on its right.
fn passes(a: &Vec2, b: &Vec2, p: &Vec2) -> bool {
    (a.y <= p.y) != (b.y <= p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
}

/// A polygon whose sides are found by height.
struct Inside<'a> {
    polygon: &'a [Vec2],
    low: f64,
    step: f64,
    rows: Vec<Vec<usize>>,
}

impl<'a> Inside<'a> {
    fn of(polygon: &'a [Vec2]) -> Self {
        let (low, high) = polygon.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.y), h.max(p.y)));
        let step = ((high - low) / CELLS).max(f64::MIN_POSITIVE);
        let mut out = Self { polygon, low, step, rows: vec![Vec::new(); CELLS as usize + 1] };
        for k in 0..polygon.len() {
            let (a, b) = (out.row(polygon[k].y), out.row(polygon[(k + 1) % polygon.len()].y));
            (a.min(b)..=a.max(b)).for_each(|r| out.rows[r].push(k));
        }
        out
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low) / self.step).max(0.0) as usize).min(self.rows.len() - 1)
    }

    fn holds(&self, p: &Vec2) -> bool {
        let l = self.polygon;
        let crossed = |k: &&usize| passes(&l[**k], &l[(**k + 1) % l.len()], p);
        self.rows[self.row(p.y)].iter().filter(crossed).count() % 2 == 1
    }
}

/// A polygon without the corners that lie within `off` of the line between those kept, by the method of Douglas and Peucker.
fn straightened(polygon: &[Vec2], off: f64) -> Vec<Vec2> {
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
    (0..n).filter(|k| keep[*k]).map(|k| polygon[k]).collect()
}

/// Turn (rad) from which a corner of the outline is one of the sheet: what a fine outline turns from point to point is not.
const CORNER: f64 = 0.5;

/// A pattern cut back to the outline: its contours are those of the outline, its rulings what lies inside; marks and sides,
/// which belong to the border that was cut away, are left out.
pub(crate) fn cut_back(pattern: &Pattern, outline: &ScanOutline) -> Pattern {
    let loops: Vec<&Vec<Vec2>> = outline.loops.iter().collect();
    let contour = |l: &&Vec<Vec2>| {
        let n = l.len();
        let vertex = |k: usize| {
            let (p, q) = (l[k] - l[(k + n - 1) % n], l[(k + 1) % n] - l[k]);
            ContourVertex { point: l[k], bulge: 0.0, corner: p.perp(&q).atan2(p.dot(&q)).abs() > CORNER }
        };
        Contour { vertices: (0..n).map(vertex).collect() }
    };
    let (mut rulings, mut bends) = (Vec::new(), Vec::new());
    for (k, ruling) in pattern.rulings.iter().enumerate() {
        for piece in pieces_inside(&loops, ruling) {
            rulings.push(piece);
            bends.push(pattern.bend(k));
        }
    }
    let area: f64 = loops.iter().map(|l| area(l)).sum();
    let (width, length) = smallest_rectangle(loops[0]).map_or((0.0, 0.0), |r| (r.width, r.length));
    Pattern {
        contours: loops.iter().map(contour).collect(),
        rulings,
        bends: if pattern.bends.is_empty() { Vec::new() } else { bends },
        marks: Vec::new(),
        sides: Vec::new(),
        area,
        area_in_space: pattern.area_in_space * area / pattern.area.max(f64::MIN_POSITIVE),
        contour_error: f64::NAN,
        width,
        length,
        ..pattern.clone()
    }
}

/// The parts of a segment inside polygons.
fn pieces_inside(loops: &[&Vec<Vec2>], [a, b]: &[Vec2; 2]) -> Vec<[Vec2; 2]> {
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
    at.windows(2).filter(|w| w[1] > w[0] && inside(loops, &middle(w))).map(|w| [a + d * w[0], a + d * w[1]]).collect()
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
        assert!((found.spacing - 2.0).abs() < 0.1 && found.distance_estimate < 4.0, "{found:?}");
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

    #[test]
    fn rulings_end_at_the_outline_and_at_the_hole() {
        let found = outline(&ring()).expect("outline");
        let pattern = Pattern {
            rulings: vec![[Vec2::new(-200.0, 0.5), Vec2::new(200.0, 0.5)]],
            area: 2.0 * std::f64::consts::PI * 1e4,
            ..Pattern::default()
        };
        let cut = cut_back(&pattern, &found);
        assert_eq!(cut.rulings.len(), 2);
        let xs: Vec<f64> = cut.rulings.iter().flatten().map(|p| p.x).collect();
        for (x, wanted) in xs.iter().zip([-100.0, -10.0, 50.0, 100.0]) {
            assert!((x - wanted).abs() < 4.0, "{xs:?}");
        }
        assert!(cut.length < 200.1 && cut.width > 195.0 && cut.marks.is_empty());
    }
}
