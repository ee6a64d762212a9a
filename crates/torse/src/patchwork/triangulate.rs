//! Triangulation of a polygon with holes that respects the lines of a grid.

use super::partition::Partition;
use crate::num::hash::{HashMap, HashSet};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};
use std::collections::VecDeque;

/// Polygon corners this close to a grid line (share of the grid's extent) are moved onto it. Far below the accuracy
/// of any trim, and it keeps triangles from crossing knot lines by a hair.
pub(super) const SNAP: f64 = 1e-10;

/// Why a region could not be triangulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TriangulateError {
    /// Fewer than three different corners.
    #[error("trim loop {0} has fewer than three different corners")]
    Degenerate(usize),
    /// Loops cross or touch themselves or each other.
    #[error("trim loops cross or touch near ({u}, {v}) in the parameter plane; repair the face's boundary in CAD")]
    Crossing {
        /// Place.
        u: f64,
        /// Place.
        v: f64,
    },
    /// Nothing inside.
    #[error("the trim loops enclose no area")]
    Empty,
    /// A coordinate is not finite.
    #[error("a corner of trim loop {0} is not a finite number")]
    NotFinite(usize),
}

/// Triangulates the region inside `loops` (outer and holes, even-odd rule). Each loop: corners, and for each side
/// (from corner `i` to `i + 1`) a number that border edges inherit. No triangle crosses a line of the grid
/// (`lines_u`, `lines_v` increasing, covering the loops); all triangles carry the label 0.
///
/// # Errors
/// Degenerate, crossing or empty loops.
#[expect(clippy::too_many_lines, reason = "one sweep with its state")]
pub(crate) fn triangulate(
    loops: &[(Vec<[f64; 2]>, Vec<u32>)],
    lines_u: &[f64],
    lines_v: &[f64],
) -> Result<Partition, TriangulateError> {
    let extent = |l: &[f64]| l.last().copied().unwrap_or(1.0) - l.first().copied().unwrap_or(0.0);
    let (eu, ev) = (extent(lines_u).abs().max(f64::MIN_POSITIVE), extent(lines_v).abs().max(f64::MIN_POSITIVE));
    let mut points = Points::default();
    let mut sides: Vec<(u32, u32, u32)> = Vec::new();
    // Sides, split at the grid lines.
    for (k, (corners, numbers)) in loops.iter().enumerate() {
        if corners.iter().flatten().any(|x| !x.is_finite()) {
            return Err(TriangulateError::NotFinite(k));
        }
        let snapped: Vec<[f64; 2]> =
            corners.iter().map(|c| [snap(c[0], lines_u, SNAP * eu), snap(c[1], lines_v, SNAP * ev)]).collect();
        let before = sides.len();
        for i in 0..snapped.len() {
            let (a, b) = (snapped[i], snapped[(i + 1) % snapped.len()]);
            let mut chain = vec![(0.0, points.index(a))];
            for s in crossings(a[0], b[0], lines_u, SNAP * eu) {
                chain.push((s.0, points.index([s.1, a[1] + (b[1] - a[1]) * s.0])));
            }
            for s in crossings(a[1], b[1], lines_v, SNAP * ev) {
                let u = a[0] + (b[0] - a[0]) * s.0;
                chain.push((s.0, points.index([u, s.1])));
            }
            chain.push((1.0, points.index(b)));
            chain.sort_by(|x, y| x.0.total_cmp(&y.0));
            for w in chain.windows(2) {
                if w[0].1 != w[1].1 {
                    sides.push((w[0].1, w[1].1, numbers.get(i).copied().unwrap_or(0)));
                }
            }
        }
        if sides.len() < before + 3 {
            return Err(TriangulateError::Degenerate(k));
        }
    }
    let border: HashMap<(u32, u32), u32> = sides.iter().map(|&(a, b, e)| ((a.min(b), a.max(b)), e)).collect();
    if border.len() != sides.len() {
        let [u, v] = points.list[sides[0].0 as usize];
        return Err(TriangulateError::Crossing { u, v });
    }
    for &u in lines_u {
        for &v in lines_v {
            points.index([u, v]);
        }
    }
    // Delaunay in scaled coordinates, so that cells are about square.
    let (su, sv) = (lines_u.len() as f64 / eu, lines_v.len() as f64 / ev);
    let mut cdt: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
    let mut handle = Vec::with_capacity(points.list.len());
    let mut back: HashMap<usize, u32> = HashMap::with_capacity_and_hasher(points.list.len(), Default::default());
    for (i, p) in points.list.iter().enumerate() {
        let h = cdt.insert(Point2::new(p[0] * su, p[1] * sv)).map_err(|_| TriangulateError::NotFinite(0))?;
        back.entry(h.index()).or_insert(i as u32);
        handle.push(h);
    }
    for &(a, b, _) in &sides {
        let (ha, hb) = (handle[a as usize], handle[b as usize]);
        if ha != hb {
            if !cdt.can_add_constraint(ha, hb) {
                let [u, v] = points.list[a as usize];
                return Err(TriangulateError::Crossing { u, v });
            }
            cdt.add_constraint(ha, hb);
        }
    }
    for axis in 0..2 {
        for chain in points.on_lines(if axis == 0 { lines_u } else { lines_v }, axis) {
            for w in chain.windows(2) {
                let (ha, hb) = (handle[w[0] as usize], handle[w[1] as usize]);
                if ha != hb && cdt.can_add_constraint(ha, hb) {
                    cdt.add_constraint(ha, hb);
                }
            }
        }
    }
    // Inside or outside, by crossing borders from the outer face.
    let vertex = |h: usize| back[&h];
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for f in cdt.inner_faces() {
        faces.push(f.vertices().map(|v| vertex(v.index())));
    }
    let mut left: HashMap<(u32, u32), usize> = HashMap::with_capacity_and_hasher(3 * faces.len(), Default::default());
    for (i, &f) in faces.iter().enumerate() {
        for e in super::partition::edges(f) {
            left.insert(e, i);
        }
    }
    let is_border = |a: u32, b: u32| border.contains_key(&(a.min(b), a.max(b)));
    let mut inside: Vec<Option<bool>> = vec![None; faces.len()];
    let mut queue = VecDeque::new();
    for (i, &f) in faces.iter().enumerate() {
        for (a, b) in super::partition::edges(f) {
            if !left.contains_key(&(b, a)) && inside[i].is_none() {
                inside[i] = Some(is_border(a, b));
                queue.push_back(i);
            }
        }
    }
    while let Some(i) = queue.pop_front() {
        for (a, b) in super::partition::edges(faces[i]) {
            if let Some(&j) = left.get(&(b, a)) {
                if inside[j].is_none() {
                    inside[j] = Some(inside[i].unwrap_or(false) ^ is_border(a, b));
                    queue.push_back(j);
                }
            }
        }
    }
    // Collect, dropping unused vertices.
    let mut out = Partition::default();
    let mut used: HashMap<u32, u32> = HashMap::default();
    let kept: HashSet<usize> = (0..faces.len()).filter(|&i| inside[i] == Some(true)).collect();
    for i in 0..faces.len() {
        if !kept.contains(&i) {
            continue;
        }
        let tri = faces[i].map(|v| {
            *used.entry(v).or_insert_with(|| {
                out.vertices.push(points.list[v as usize]);
                out.vertices.len() as u32 - 1
            })
        });
        let [p, q, r] = tri.map(|v| out.vertices[v as usize]).map(|p| robust::Coord { x: p[0], y: p[1] });
        if robust::orient2d(p, q, r) <= 0.0 {
            return Err(TriangulateError::Crossing { u: p.x, v: p.y });
        }
        out.triangles.push(tri);
        out.labels.push(0);
        for ((a, b), (x, y)) in super::partition::edges(faces[i]).into_iter().zip(super::partition::edges(tri)) {
            let outer = left.get(&(b, a)).is_none_or(|j| !kept.contains(j));
            if outer {
                out.trim_edges.insert((x, y), border.get(&(a.min(b), a.max(b))).copied().unwrap_or(0));
            }
        }
    }
    if out.triangles.is_empty() {
        return Err(TriangulateError::Empty);
    }
    Ok(out)
}

/// Distinct points by their bits.
#[derive(Default)]
pub(super) struct Points {
    pub list: Vec<[f64; 2]>,
    of: HashMap<(u64, u64), u32>,
}

impl Points {
    pub fn index(&mut self, p: [f64; 2]) -> u32 {
        // Adding zero turns −0 into +0.
        let p = [p[0] + 0.0, p[1] + 0.0];
        *self.of.entry((p[0].to_bits(), p[1].to_bits())).or_insert_with(|| {
            self.list.push(p);
            self.list.len() as u32 - 1
        })
    }

    /// For each line of one axis the points exactly on it, ordered along it.
    pub fn on_lines(&self, lines: &[f64], axis: usize) -> Vec<Vec<u32>> {
        let of: HashMap<u64, usize> = lines.iter().enumerate().map(|(i, l)| ((l + 0.0).to_bits(), i)).collect();
        let mut out = vec![Vec::new(); lines.len()];
        for (i, p) in self.list.iter().enumerate() {
            if let Some(&k) = of.get(&p[axis].to_bits()) {
                out[k].push(i as u32);
            }
        }
        for chain in &mut out {
            chain.sort_by(|&a, &b| self.list[a as usize][1 - axis].total_cmp(&self.list[b as usize][1 - axis]));
        }
        out
    }
}

pub(super) fn snap(x: f64, lines: &[f64], tolerance: f64) -> f64 {
    let i = lines.partition_point(|&l| l < x);
    for k in [i.wrapping_sub(1), i] {
        if let Some(&l) = lines.get(k) {
            if (l - x).abs() <= tolerance {
                return l;
            }
        }
    }
    x
}

/// Places `(s, line)` strictly inside a side from `a` to `b` at which it meets grid lines.
pub(super) fn crossings(a: f64, b: f64, lines: &[f64], tolerance: f64) -> Vec<(f64, f64)> {
    let (lo, hi) = (a.min(b) + tolerance, a.max(b) - tolerance);
    lines.iter().filter(|&&l| l > lo && l < hi).map(|&l| ((l - a) / (b - a), l)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_and_slanted_sides() {
        let grid: Vec<f64> = (0..=7).map(|i| i as f64 / 7.0).collect();
        let loops = vec![
            (vec![[0.1, 0.1], [0.95, 0.2], [0.8, 0.9], [0.3, 0.85]], vec![0, 1, 2, 3]),
            (vec![[0.4, 0.4], [0.4, 0.6], [0.6, 0.6], [0.6, 0.4]], vec![4, 5, 6, 7]),
        ];
        let p = triangulate(&loops, &grid, &grid).expect("region");
        let shoelace = |c: &[[f64; 2]]| {
            (0..c.len())
                .map(|i| {
                    let (a, b) = (c[i], c[(i + 1) % c.len()]);
                    0.5 * (a[0] * b[1] - a[1] * b[0])
                })
                .sum::<f64>()
        };
        let area: f64 = (0..p.triangles.len()).map(|t| shoelace(&p.corners(t))).sum();
        assert!((area - (shoelace(&loops[0].0) - 0.04)).abs() < 1e-12);
        let numbers: HashSet<u32> = p.trim_edges.values().copied().collect();
        assert_eq!(numbers.len(), 8);
    }

    #[test]
    fn crossing_sides_are_refused() {
        let loops = vec![(vec![[0., 0.], [1., 1.], [1., 0.], [0., 1.]], vec![0; 4])];
        assert!(triangulate(&loops, &[0.0, 1.0], &[0.0, 1.0]).is_err());
    }
}
