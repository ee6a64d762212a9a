//! A tree of boxes about triangles, for nearest points; a point is a triangle with one corner.

use super::segment::share;
use super::{BBox, Vec3};

/// Triangles in a leaf at most.
const LEAF: usize = 4;

#[derive(Clone, Debug)]
struct Node {
    bounds: BBox,
    /// A leaf's triangles, by their range in the order; otherwise both children.
    first: usize,
    count: usize,
    children: [usize; 2],
}

/// The tree. Triangles are handed in with every question, so that the tree does not own them.
#[derive(Clone, Debug)]
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

/// The nearest point of a triangle `(a, b, c)` with its barycentric coordinates.
pub(crate) fn nearest_on_triangle(x: &Vec3, [a, b, c]: [Vec3; 3]) -> [f64; 3] {
    let (u, v, w) = (b - a, c - a, x - a);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let det = uu * vv - uv * uv;
    if det > 0.0 {
        let (s, t) = ((uw * vv - vw * uv) / det, (vw * uu - uw * uv) / det);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return [1.0 - s - t, s, t];
        }
    }
    // The nearest point of the border.
    let corners = [a, b, c];
    let mut best = ([1.0, 0.0, 0.0], f64::INFINITY);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let t = share(&corners[i], &corners[j], x);
        let far = (corners[i] + (corners[j] - corners[i]) * t - x).norm_squared();
        if far < best.1 {
            let mut at = [0.0; 3];
            at[i] = 1.0 - t;
            at[j] = t;
            best = (at, far);
        }
    }
    best.0
}

/// Squared distance of a point from a box.
fn off(b: &BBox, x: &Vec3) -> f64 {
    (b.min - x).sup(&(x - b.max)).sup(&Vec3::zeros()).norm_squared()
}

impl BoxTree {
    /// A tree over `count` items with these boxes.
    pub fn new(count: usize, bounds: &dyn Fn(usize) -> BBox) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..count as u32).collect() };
        if count > 0 {
            tree.split(0, count, bounds);
        }
        tree
    }

    /// Halves a range at the median of its longest side; the depth is the logarithm of the number of items.
    fn split(&mut self, first: usize, count: usize, bounds: &dyn Fn(usize) -> BBox) -> usize {
        let mut all = BBox::empty();
        for &i in &self.order[first..first + count] {
            let b = bounds(i as usize);
            all.include(&b.min);
            all.include(&b.max);
        }
        let at = self.nodes.len();
        self.nodes.push(Node { bounds: all, first, count, children: [0; 2] });
        if count > LEAF {
            let axis = (all.max - all.min).imax();
            let half = count / 2;
            let key = |i: &u32| bounds(*i as usize).center()[axis];
            self.order[first..first + count].select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)));
            let left = self.split(first, half, bounds);
            let right = self.split(first + half, count - half, bounds);
            self.nodes[at].count = 0;
            self.nodes[at].children = [left, right];
        }
        at
    }

    /// The item with the least squared distance, as `distance` says, and that distance.
    pub fn nearest(&self, x: &Vec3, distance: &dyn Fn(usize) -> f64) -> Option<(usize, f64)> {
        self.nearest_within(x, f64::INFINITY, distance)
    }

    /// The same among items whose squared distance is below `within`.
    pub fn nearest_within(&self, x: &Vec3, within: f64, distance: &dyn Fn(usize) -> f64) -> Option<(usize, f64)> {
        let mut best = None;
        self.visit(x, within, &mut |limit, i| {
            let d = distance(i);
            if d < limit {
                best = Some((i, d));
                return d;
            }
            limit
        });
        best
    }

    /// The items with the least squared distances, nearest first.
    pub fn several(&self, x: &Vec3, wanted: usize, distance: &dyn Fn(usize) -> f64) -> Vec<usize> {
        let mut found: Vec<(f64, usize)> = Vec::with_capacity(wanted + 1);
        self.visit(x, f64::INFINITY, &mut |limit, i| {
            let d = distance(i);
            if d.is_nan() || d >= limit {
                return limit;
            }
            let place = found.partition_point(|f| f.0 <= d);
            found.insert(place, (d, i));
            found.truncate(wanted);
            if found.len() < wanted {
                f64::INFINITY
            } else {
                found[wanted - 1].0
            }
        });
        found.into_iter().map(|f| f.1).collect()
    }

    /// Whether `see` says so of any item whose box may meet another one.
    pub fn any_meeting(&self, with: &BBox, see: &mut dyn FnMut(usize) -> bool) -> bool {
        let mut open = Vec::with_capacity(64);
        open.extend((!self.nodes.is_empty()).then_some(0));
        while let Some(at) = open.pop() {
            let node = &self.nodes[at];
            if !node.bounds.meets(with) {
                continue;
            }
            if node.count == 0 {
                open.extend(node.children);
            } else if self.order[node.first..node.first + node.count].iter().any(|&i| see(i as usize)) {
                return true;
            }
        }
        false
    }

    /// Shows items in boxes nearer than a limit, which the visitor lowers.
    fn visit(&self, x: &Vec3, mut limit: f64, see: &mut dyn FnMut(f64, usize) -> f64) {
        let mut open: Vec<(f64, usize)> = Vec::with_capacity(64);
        if let Some(root) = self.nodes.first() {
            open.push((off(&root.bounds, x), 0));
        }
        while let Some((far, at)) = open.pop() {
            if far >= limit {
                continue;
            }
            let node = &self.nodes[at];
            if node.count > 0 {
                for &i in &self.order[node.first..node.first + node.count] {
                    limit = see(limit, i as usize);
                }
                continue;
            }
            let mut both = node.children.map(|c| (off(&self.nodes[c].bounds, x), c));
            if both[0].0 < both[1].0 {
                both.swap(0, 1);
            }
            open.extend(both);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_list_finds() {
        let points: Vec<Vec3> =
            (0..500).map(|i| Vec3::new((i as f64).sin(), (1.7 * i as f64).cos(), (0.3 * i as f64).sin())).collect();
        let tree = BoxTree::new(points.len(), &|i| BBox { min: points[i], max: points[i] });
        for k in 0..50 {
            let x = Vec3::new((0.9 * k as f64).cos(), (0.4 * k as f64).sin(), 0.2);
            let far = |i: usize| (points[i] - x).norm_squared();
            let mut list: Vec<usize> = (0..500).collect();
            list.sort_by(|&a, &b| far(a).total_cmp(&far(b)));
            assert_eq!(tree.nearest(&x, &far).map(|f| f.0), Some(list[0]));
            assert_eq!(tree.several(&x, 9, &far), list[..9]);
            let around = BBox { min: x - Vec3::repeat(0.3), max: x + Vec3::repeat(0.3) };
            let within = |i: usize| around.meets(&BBox { min: points[i], max: points[i] });
            let mut met: Vec<usize> = Vec::new();
            assert!(!tree.any_meeting(&around, &mut |i| {
                met.extend(within(i).then_some(i));
                false
            }));
            met.sort_unstable();
            assert_eq!(met, (0..500).filter(|i| within(*i)).collect::<Vec<_>>());
            assert_eq!(tree.any_meeting(&around, &mut |i| within(i)), !met.is_empty());
            let least = far(list[0]);
            assert_eq!(tree.nearest_within(&x, 1.01 * least, &far).map(|f| f.0), Some(list[0]));
            assert!(tree.nearest_within(&x, least, &far).is_none());
        }
    }

    #[test]
    fn nearest_points_of_a_triangle() {
        let t = [Vec3::zeros(), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];
        assert_eq!(nearest_on_triangle(&Vec3::new(0.5, 0.5, 3.0), t), [0.5, 0.25, 0.25]);
        assert_eq!(nearest_on_triangle(&Vec3::new(3.0, 3.0, 1.0), t), [0.0, 0.5, 0.5]);
        assert_eq!(nearest_on_triangle(&Vec3::new(-1.0, -1.0, 0.0), t), [1.0, 0.0, 0.0]);
        // All corners in one place.
        assert_eq!(nearest_on_triangle(&Vec3::x(), [Vec3::zeros(); 3]).iter().sum::<f64>(), 1.0);
    }
}
