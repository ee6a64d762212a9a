//! Polygons of the parameter plane: area, inside, nesting, and the test that nothing touches.

use robust::{orient2d, Coord};

/// What a side of a polygon follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Side {
    /// Label of the edge.
    pub label: u32,
    /// Place along the edge where the side begins: number of the edge's piece and share of that; 0 on added sides.
    pub from: f64,
    /// Place where it ends.
    pub to: f64,
}

impl Side {
    /// A side that no edge of the file goes with.
    pub fn added(label: u32) -> Self {
        Self { label, from: 0.0, to: 0.0 }
    }

    /// The parts before and after a share of the side.
    pub fn cut(self, share: f64) -> [Self; 2] {
        let at = self.from + share * (self.to - self.from);
        [Self { to: at, ..self }, Self { from: at, ..self }]
    }
}

/// A closed polygon with what the side that leaves each corner follows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Polygon {
    /// Corners; the last is joined to the first.
    pub points: Vec<[f64; 2]>,
    /// The side from `points[i]` to `points[i + 1]`.
    pub edge: Vec<Side>,
}

impl Polygon {
    /// Signed area, positive counter-clockwise.
    pub fn area(&self) -> f64 {
        let Some(o) = self.points.first() else { return 0.0 };
        let n = self.points.len();
        let cross = |i: usize| {
            let (p, q) = (self.points[i], self.points[(i + 1) % n]);
            (p[0] - o[0]) * (q[1] - o[1]) - (q[0] - o[0]) * (p[1] - o[1])
        };
        0.5 * (0..n).map(cross).sum::<f64>()
    }

    /// Whether a point lies inside, by crossings of the ray towards +u.
    pub fn contains(&self, x: [f64; 2]) -> bool {
        let n = self.points.len();
        let mut inside = false;
        for i in 0..n {
            let (p, q) = (self.points[i], self.points[(i + 1) % n]);
            if (p[1] > x[1]) != (q[1] > x[1]) {
                let side = orientation(p, q, x);
                if (side > 0.0) == (q[1] > p[1]) && side.abs() > 0.0 {
                    inside = !inside;
                }
            }
        }
        inside
    }

    /// Makes the polygon run the other way.
    pub fn reverse(&mut self) {
        // Sides keep their labels: corner i of the reversed polygon is left by the side that entered it before.
        self.points.reverse();
        self.edge.reverse();
        self.edge.rotate_left(1);
        self.edge.iter_mut().for_each(|s| std::mem::swap(&mut s.from, &mut s.to));
    }
}

fn orientation(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let at = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    orient2d(at(a), at(b), at(c))
}

/// Loops of a polygon smaller than this share of its area, made by overlapping ends of edges, are cut off.
const LOOP_SHARE: f64 = 1e-5;
/// Corners closer than this share of the polygon's extent are one.
const SAME_POINT: f64 = 1e-11;
/// Polygons of less area than this share of their box have none: the rounding of the sum.
const NO_AREA: f64 = 1e-15;

/// Removes corners that are the same to the bit, and spikes; `None` if no area remains. The region stays what it is.
pub(super) fn without_repeated(mut p: Polygon) -> Option<Polygon> {
    let width = widths(&p);
    if !(width[0] > 0.0 && width[1] > 0.0) {
        return None;
    }
    drop_repeated(&mut p, width, 0.0);
    (p.points.len() >= 3 && p.area() != 0.0).then_some(p)
}

/// Widths of the box around a polygon.
fn widths(p: &Polygon) -> [f64; 2] {
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for q in &p.points {
        for k in 0..2 {
            lo[k] = lo[k].min(q[k]);
            hi[k] = hi[k].max(q[k]);
        }
    }
    [hi[0] - lo[0], hi[1] - lo[1]]
}

/// Removes repeated corners, spikes and small loops; `None` if no area remains. One that crosses itself stays so.
pub(super) fn cleaned(mut p: Polygon) -> Option<Polygon> {
    let width = widths(&p);
    if !(width[0] > 0.0 && width[1] > 0.0) {
        return None;
    }
    drop_repeated(&mut p, width, SAME_POINT);
    let mut crossed = true;
    for _ in 0..64 {
        let Some((i, j)) = first_crossing(&[&p]).map(|(a, b)| (a.1.min(b.1), a.1.max(b.1))) else {
            crossed = false;
            break;
        };
        if !cut_loop(&mut p, i, j) {
            break;
        }
        drop_repeated(&mut p, width, SAME_POINT);
    }
    // One that still crosses itself is kept whatever its area, to be refused by name.
    (p.points.len() >= 3 && (crossed || p.area().abs() > NO_AREA * width[0] * width[1])).then_some(p)
}

/// Removes corners that are within a share of the widths of their neighbours, and spikes.
fn drop_repeated(p: &mut Polygon, width: [f64; 2], share: f64) {
    let same = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() <= share * width[k]);
    let mut i = 0;
    while p.points.len() > 2 && i < p.points.len() {
        let n = p.points.len();
        let (before, next) = ((i + n - 1) % n, (i + 1) % n);
        let (a, b, c) = (p.points[before], p.points[i], p.points[next]);
        // A spike: the way back along the way out.
        let back = ((b[0] - a[0]) / width[0] * (c[0] - b[0]) / width[0]
            + (b[1] - a[1]) / width[1] * (c[1] - b[1]) / width[1])
            < 0.0;
        let spike = back && orientation(a, b, c).abs() <= 0.0;
        if same(b, c) || spike {
            p.points.remove(i);
            p.edge.remove(i);
            i = i.saturating_sub(2);
        } else {
            i += 1;
        }
    }
}

/// Cuts off the smaller of the two loops that crossing sides `i < j` make, if it is small.
fn cut_loop(p: &mut Polygon, i: usize, j: usize) -> bool {
    let n = p.points.len();
    let (a, b) = (p.points[i], p.points[(i + 1) % n]);
    let (c, d) = (p.points[j], p.points[(j + 1) % n]);
    let (r, s) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let det = r[0] * s[1] - r[1] * s[0];
    let (x, t) = if det.abs() > 0.0 {
        let t = (((c[0] - a[0]) * s[1] - (c[1] - a[1]) * s[0]) / det).clamp(0.0, 1.0);
        ([a[0] + t * r[0], a[1] + t * r[1]], t)
    } else {
        (b, 1.0)
    };
    let along = s[0] * s[0] + s[1] * s[1];
    let other = if along > 0.0 { ((x[0] - c[0]) * s[0] + (x[1] - c[1]) * s[1]) / along } else { 0.0 };
    let ([before, start], [end, after]) = (p.edge[i].cut(t), p.edge[j].cut(other.clamp(0.0, 1.0)));
    let mut inner = Polygon { points: vec![x], edge: vec![start] };
    inner.points.extend(&p.points[i + 1..=j]);
    inner.edge.extend(&p.edge[i + 1..j]);
    inner.edge.push(end);
    let mut outer = Polygon { points: p.points[..=i].to_vec(), edge: p.edge[..i].to_vec() };
    outer.edge.push(before);
    outer.points.push(x);
    outer.edge.push(after);
    outer.points.extend(&p.points[j + 1..]);
    outer.edge.extend(&p.edge[j + 1..]);
    let (small, large) = if inner.area().abs() < outer.area().abs() { (inner, outer) } else { (outer, inner) };
    if small.area().abs() <= LOOP_SHARE * large.area().abs() {
        *p = large;
        true
    } else {
        false
    }
}

/// Groups polygons into regions: each an outer polygon, counter-clockwise, followed by its holes, clockwise. With
/// `by_sense`, clockwise polygons are holes; otherwise the depth of nesting decides.
pub(super) fn nested(mut polygons: Vec<Polygon>, by_sense: bool) -> Vec<Vec<Polygon>> {
    polygons.sort_by(|p, q| q.area().abs().total_cmp(&p.area().abs()));
    let mut parent: Vec<Option<usize>> = Vec::with_capacity(polygons.len());
    let mut depth: Vec<usize> = Vec::with_capacity(polygons.len());
    for i in 0..polygons.len() {
        // The smallest of the larger polygons around it.
        let around = (0..i).rev().find(|&j| holds(&polygons[j], &polygons[i]));
        depth.push(around.map_or(0, |j| depth[j] + 1));
        parent.push(around);
    }
    let mut groups: Vec<(usize, Vec<Polygon>)> = Vec::new();
    for i in 0..polygons.len() {
        let hole = if by_sense { polygons[i].area() < 0.0 } else { depth[i] % 2 == 1 };
        let mut p = polygons[i].clone();
        if (p.area() < 0.0) != hole {
            p.reverse();
        }
        if hole {
            // Its region is that of the nearest enclosing outer polygon.
            let mut owner = parent[i];
            while let Some(j) = owner {
                if let Some(g) = groups.iter_mut().find(|g| g.0 == j) {
                    g.1.push(p);
                    break;
                }
                owner = parent[j];
            }
        } else {
            groups.push((i, vec![p]));
        }
    }
    groups.into_iter().map(|g| g.1).collect()
}

/// Whether most corners of `inner` lie inside `outer`.
fn holds(outer: &Polygon, inner: &Polygon) -> bool {
    let step = (inner.points.len() / 9).max(1);
    let tests: Vec<bool> = inner.points.iter().step_by(step).map(|&x| outer.contains(x)).collect();
    2 * tests.iter().filter(|&&b| b).count() > tests.len()
}

/// Way by which places on sides are moved inwards, as a share of the side, to be clear of a common border.
const INWARDS: f64 = 1e-6;

/// A place that two regions have in common; they may touch.
pub(super) fn first_overlap(groups: &[Vec<Polygon>]) -> Option<[f64; 2]> {
    let outer: Vec<Polygon> = groups.iter().filter_map(|g| g.first().cloned()).collect();
    if outer.len() < 2 {
        return None;
    }
    first_contact(&outer)?;
    let within = |group: &[Polygon], x: [f64; 2]| {
        let (outer, holes) = (&group[0], &group[1..]);
        outer.contains(x) && !holes.iter().any(|h| h.contains(x))
    };
    outer.iter().enumerate().find_map(|(k, p)| {
        let n = p.points.len();
        (0..n).find_map(|i| {
            let (a, b) = (p.points[i], p.points[(i + 1) % n]);
            let d = [b[0] - a[0], b[1] - a[1]];
            // Outer polygons run counter-clockwise: inside is on the left.
            let x = [0.5 * (a[0] + b[0]) - INWARDS * d[1], 0.5 * (a[1] + b[1]) + INWARDS * d[0]];
            let twice = groups.iter().enumerate().any(|(j, g)| j != k && within(g, x));
            (twice && within(&groups[k], x)).then_some(x)
        })
    })
}

/// A place where two sides of the polygons cross or touch that are not neighbours.
pub(super) fn first_contact(group: &[Polygon]) -> Option<[f64; 2]> {
    let refs: Vec<&Polygon> = group.iter().collect();
    first_crossing(&refs).map(|(a, _)| group[a.0].points[a.1])
}

/// The first pair of sides `(polygon, side)` in contact, by a sweep along u.
fn first_crossing(group: &[&Polygon]) -> Option<((usize, usize), (usize, usize))> {
    struct Side {
        of: (usize, usize),
        a: [f64; 2],
        b: [f64; 2],
        lo: [f64; 2],
        hi: [f64; 2],
    }
    let mut sides = Vec::new();
    for (k, p) in group.iter().enumerate() {
        let n = p.points.len();
        for i in 0..n {
            let (a, b) = (p.points[i], p.points[(i + 1) % n]);
            let lo = [a[0].min(b[0]), a[1].min(b[1])];
            let hi = [a[0].max(b[0]), a[1].max(b[1])];
            sides.push(Side { of: (k, i), a, b, lo, hi });
        }
    }
    sides.sort_by(|p, q| p.lo[0].total_cmp(&q.lo[0]));
    let mut active: Vec<usize> = Vec::new();
    for i in 0..sides.len() {
        let s = &sides[i];
        active.retain(|&j| sides[j].hi[0] >= s.lo[0]);
        for &j in &active {
            let t = &sides[j];
            if t.lo[1] > s.hi[1] || s.lo[1] > t.hi[1] {
                continue;
            }
            if contact(s.a, s.b, t.a, t.b, neighbours(group, s.of, t.of)) {
                return Some((s.of, t.of));
            }
        }
        active.push(i);
    }
    None
}

/// How two sides of one polygon follow each other: whether the second leaves the corner where the first ends.
#[derive(Clone, Copy, PartialEq)]
enum Neighbours {
    No,
    FirstThenSecond,
    SecondThenFirst,
}

fn neighbours(group: &[&Polygon], s: (usize, usize), t: (usize, usize)) -> Neighbours {
    let n = group[s.0].points.len();
    if s.0 != t.0 {
        Neighbours::No
    } else if (s.1 + 1) % n == t.1 {
        Neighbours::FirstThenSecond
    } else if (t.1 + 1) % n == s.1 {
        Neighbours::SecondThenFirst
    } else {
        Neighbours::No
    }
}

fn contact(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2], relation: Neighbours) -> bool {
    let folded = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        orientation(p, q, r).abs() <= 0.0 && (q[0] - p[0]) * (r[0] - q[0]) + (q[1] - p[1]) * (r[1] - q[1]) < 0.0
    };
    match relation {
        Neighbours::FirstThenSecond => return folded(a, b, d),
        Neighbours::SecondThenFirst => return folded(c, d, b),
        Neighbours::No => {}
    }
    let (o1, o2) = (orientation(a, b, c), orientation(a, b, d));
    let (o3, o4) = (orientation(c, d, a), orientation(c, d, b));
    // Boxes overlap already, so collinear sides touch.
    !((o1 > 0.0 && o2 > 0.0) || (o1 < 0.0 && o2 < 0.0) || (o3 > 0.0 && o4 > 0.0) || (o3 < 0.0 && o4 < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, r: f64) -> Polygon {
        Polygon {
            points: vec![[x - r, y - r], [x + r, y - r], [x + r, y + r], [x - r, y + r]],
            edge: [0, 1, 2, 3].map(Side::added).to_vec(),
        }
    }

    #[test]
    fn nesting_and_sense() {
        let mut hole = square(0.5, 0.0, 0.2);
        hole.edge = [4, 5, 6, 7].map(|label| Side { label, from: 0.0, to: 1.0 }).to_vec();
        let groups = nested(vec![hole.clone(), square(0.0, 0.0, 1.0), square(5.0, 0.0, 0.5)], false);
        assert_eq!(groups.len(), 2);
        assert_eq!(groups[0].len(), 2);
        assert!(groups[0][0].area() > 0.0 && groups[0][1].area() < 0.0);
        // The reversed hole keeps the label of each side.
        let r = &groups[0][1];
        let i = r.points.iter().position(|p| *p == hole.points[1]).expect("corner");
        assert_eq!(r.points[(i + 1) % 4], hole.points[0]);
        assert_eq!(r.edge[i], Side { label: 4, from: 1.0, to: 0.0 });
        assert!(first_contact(&groups[0]).is_none());
        assert!(first_contact(&[square(0.0, 0.0, 1.0), square(1.0, 0.0, 0.3)]).is_some());
    }

    #[test]
    fn small_loops_are_cut_off_and_large_ones_kept() {
        let small = Polygon {
            points: vec![[0., 0.], [1.001, 0.0], [1.0, 0.001], [1.0, -0.001], [1.0, 1.], [0., 1.]],
            edge: [0, 1, 2, 3, 4, 5].map(|label| Side { label, from: 0.0, to: 1.0 }).to_vec(),
        };
        let c = cleaned(small).expect("a polygon");
        assert!(first_contact(std::slice::from_ref(&c)).is_none());
        assert!((c.area() - 1.0).abs() < 1e-5);
        let bow = Polygon { points: vec![[0., 0.], [1., 1.], [1., 0.], [0., 1.]], edge: vec![Side::added(0); 4] };
        assert!(cleaned(bow).is_none_or(|b| first_contact(&[b]).is_some()));
    }
}
