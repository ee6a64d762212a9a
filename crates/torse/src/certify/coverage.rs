//! Whether the panels' regions add up to the faces exactly.
//!
//! A question of counting \[certificate, 5\]: all triangles are positively oriented (exact predicate), inner edges are
//! used by exactly two triangles in opposite directions, and the edges used once are the face's trimming polygons,
//! subdivided. Then the winding numbers of the triangles add up to that of the face at every point. A subdivided side
//! is compared as a chain: the polygon's corners occur in order, bit by bit, and the vertices between them lie on the
//! side up to rounding. The partition is the definition of the trimmed region from there on; the rounding of such a
//! vertex is at most [`ON_SIDE`] of the size of the parameter box, and what it moves in space is counted as part of the bound.

use super::distance::key;
use crate::brep::face::Face;
use crate::num::hash::{HashMap, HashSet};
use crate::patchwork::panel::{Border, Coedge, Panel, PanelTrim};
use crate::patchwork::partition::Partition;
use crate::reason::CoverFault;
use robust::{orient2d, Coord};

/// How far, relative to the face's parameter box, the vertices that subdivide a trimming side may lie off it:
/// a few roundings.
const ON_SIDE: f64 = 1e-12;

/// Rounding of that distance, in the same measure.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Whether the triangles of a partition cover the face exactly once. The result bounds how far, in u and in v, its border
/// lies off the trimming polygons.
///
/// # Errors
/// What is wrong.
#[expect(clippy::too_many_lines, reason = "one walk over all borders, which fills one table")]
pub(super) fn partition_covers(face: &Face, partition: &Partition) -> Result<[f64; 2], CoverFault> {
    let (v, t) = (&partition.vertices, &partition.triangles);
    if partition.labels.len() != t.len() {
        return Err(CoverFault::Labels);
    }
    let mut edges: HashMap<(u32, u32), bool> = HashMap::with_capacity_and_hasher(3 * t.len(), Default::default());
    for (i, triangle) in t.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = triangle.map(|k| v.get(k as usize)) else {
            return Err(CoverFault::NoVertex(i));
        };
        let at = |p: &[f64; 2]| Coord { x: p[0], y: p[1] };
        // Written so that it is refused too where a corner is not a number.
        let positive = orient2d(at(a), at(b), at(c)) > 0.0;
        if !positive {
            return Err(CoverFault::Orientation(i, *a));
        }
        for k in 0..3 {
            if edges.insert((triangle[k], triangle[(k + 1) % 3]), true).is_some() {
                return Err(CoverFault::Repeats(i));
            }
        }
    }
    // Edges without their opposite: the boundary.
    let mut next: HashMap<u32, Vec<u32>> = HashMap::default();
    let mut open = 0usize;
    for &(a, b) in edges.keys() {
        if !edges.contains_key(&(b, a)) {
            next.entry(a).or_default().push(b);
            open += 1;
        }
    }
    // Walk every trimming polygon along these edges and use them up.
    let by_place: HashMap<(u64, u64), u32> = v.iter().enumerate().map(|(i, p)| (key(p), i as u32)).collect();
    if by_place.len() != v.len() {
        return Err(CoverFault::SamePlace);
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in face.loops.iter().flat_map(|l| &l.points) {
        for d in 0..2 {
            low[d] = low[d].min(p[d]);
            high[d] = high[d].max(p[d]);
        }
    }
    let scale = [0, 1].map(|d: usize| (high[d] - low[d]).max(low[d].abs()).max(high[d].abs()));
    let mut farthest = 0.0f64;
    for (l, polygon) in face.loops.iter().enumerate() {
        let n = polygon.points.len();
        for i in 0..n {
            let (p, q) = (polygon.points[i], polygon.points[(i + 1) % n]);
            if key(&p) == key(&q) {
                continue;
            }
            let (Some(&start), Some(&end)) = (by_place.get(&key(&p)), by_place.get(&key(&q))) else {
                return Err(CoverFault::NoCorner(i, l));
            };
            let side = [(q[0] - p[0]) / scale[0], (q[1] - p[1]) / scale[1]];
            let squared = side[0] * side[0] + side[1] * side[1];
            let (mut here, mut progress) = (start, 0.0);
            while here != end {
                // Of several ways on (where the boundary touches itself) the one along the side.
                let options = next.get_mut(&here).filter(|o| !o.is_empty());
                let Some(options) = options else {
                    return Err(CoverFault::Ends(i, l));
                };
                let offset = |k: u32| {
                    let x = v[k as usize];
                    let d = [(x[0] - p[0]) / scale[0], (x[1] - p[1]) / scale[1]];
                    let along = (d[0] * side[0] + d[1] * side[1]) / squared;
                    ((d[0] * side[1] - d[1] * side[0]).abs() / squared.sqrt(), along)
                };
                let best = (0..options.len())
                    .filter(|&o| {
                        let (off, along) = offset(options[o]);
                        off <= ON_SIDE && along > progress && along <= 1.0 + ON_SIDE
                    })
                    .min_by(|&a, &b| offset(options[a]).1.total_cmp(&offset(options[b]).1));
                let Some(best) = best else {
                    return Err(CoverFault::Leaves(i, l));
                };
                here = options.swap_remove(best);
                let (off, along) = offset(here);
                farthest = farthest.max(off);
                progress = along;
                open -= 1;
            }
        }
    }
    if open > 0 {
        return Err(CoverFault::Open(open));
    }
    // What was measured is rounded by a few units in the last place.
    Ok(scale.map(|s| (farthest + ROUNDING) * s))
}

/// Whether every triangle of every partition belongs to exactly one panel.
///
/// # Errors
/// What is wrong.
pub(super) fn labels_have_panels(partitions: &[Partition], panels: &[Panel]) -> Result<(), CoverFault> {
    let mut owners = HashSet::default();
    for p in panels {
        let Some(trim) = p.trim.as_ref().filter(|t| t.face < partitions.len()) else {
            return Err(CoverFault::NoFace(p.strip.name.clone()));
        };
        if !owners.insert((trim.face, trim.label)) {
            return Err(CoverFault::Shared(p.strip.name.clone()));
        }
    }
    for (face, partition) in partitions.iter().enumerate() {
        if let Some(i) = partition.labels.iter().position(|&l| !owners.contains(&(face, l))) {
            return Err(CoverFault::NoPanel(i, face));
        }
    }
    Ok(())
}

/// Whether a panel's loops are exactly the boundary of its triangles.
///
/// # Errors
/// What is wrong.
pub(super) fn loops_bound_triangles(partition: &Partition, trim: &PanelTrim) -> Result<(), CoverFault> {
    let mut edges = HashSet::default();
    let mut others = HashSet::default();
    for (t, &label) in partition.triangles.iter().zip(&partition.labels) {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if label != trim.label {
                others.insert((a, b));
            } else if !edges.remove(&(b, a)) {
                edges.insert((a, b));
            }
        }
    }
    if edges.is_empty() {
        return Err(CoverFault::NoTriangles);
    }
    for (l, runs) in trim.loops.iter().enumerate() {
        for (i, run) in runs.iter().enumerate() {
            let following: &Coedge = &runs[(i + 1) % runs.len()];
            if run.vertices.last() != following.vertices.first() {
                return Err(CoverFault::NotClosed { of: l, run: i });
            }
            for w in run.vertices.windows(2) {
                if !edges.remove(&(w[0], w[1])) {
                    return Err(CoverFault::RunLeaves { of: l, run: i });
                }
                // Seams are where there is a neighbour, and nowhere else.
                let seam = matches!(run.border, Border::Seam { .. });
                if seam != others.contains(&(w[1], w[0])) {
                    return Err(CoverFault::Miscalled { of: l, run: i, seam });
                }
            }
        }
    }
    if edges.is_empty() {
        Ok(())
    } else {
        Err(CoverFault::NoRun(edges.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::TrimLoop;
    use crate::certify::specimens::near_primal;

    /// The unit square with a square hole, in 8 triangles.
    fn holed() -> (Face, Partition) {
        let mut face = Face::untrimmed(near_primal(0.0));
        let outer = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let hole = vec![[0.25, 0.25], [0.25, 0.75], [0.75, 0.75], [0.75, 0.25]];
        face.loops = vec![
            TrimLoop { points: outer.clone(), edge: vec![0, 1, 2, 3] },
            TrimLoop { points: hole.clone(), edge: vec![4; 4] },
        ];
        let vertices = outer.into_iter().chain(hole).collect();
        // Outer 0 1 2 3, hole 4 (lower left) 5 (upper left) 6 (upper right) 7 (lower right).
        let triangles = vec![[0, 1, 4], [4, 1, 7], [1, 2, 7], [7, 2, 6], [2, 3, 6], [6, 3, 5], [3, 0, 5], [5, 0, 4]];
        (face, Partition { vertices, labels: vec![0; triangles.len()], triangles, ..Partition::default() })
    }

    #[test]
    fn a_partition_with_a_hole_covers() {
        let (face, mut p) = holed();
        assert!(partition_covers(&face, &p).is_ok_and(|off| off.iter().all(|x| *x < 1e-14)));
        // A vertex on the lower side, shared by two triangles.
        p.vertices.push([0.5, 0.0]);
        p.triangles[0] = [0, 8, 4];
        p.triangles.push([8, 1, 4]);
        p.labels.push(0);
        assert!(partition_covers(&face, &p).is_ok_and(|off| off.iter().all(|x| *x < 1e-14)));
    }

    #[test]
    fn tampering_is_noticed() {
        let (face, good) = holed();
        let mut p = good.clone();
        p.triangles.pop();
        p.labels.pop();
        assert!(partition_covers(&face, &p).is_err(), "a piece removed");
        let mut p = good.clone();
        p.triangles[3].swap(0, 1);
        assert!(partition_covers(&face, &p).is_err(), "a triangle reversed");
        let mut p = good.clone();
        p.triangles.push([0, 1, 4]);
        p.labels.push(0);
        assert!(partition_covers(&face, &p).is_err(), "a triangle twice");
        let mut p = good.clone();
        p.vertices[6] = [0.75, 0.75 + 1e-9];
        assert!(partition_covers(&face, &p).is_err(), "a corner moved");
        let mut p = good.clone();
        p.vertices.push([0.5, 1e-6]);
        p.triangles[0] = [0, 8, 4];
        p.triangles.push([8, 1, 4]);
        p.labels.push(0);
        assert!(partition_covers(&face, &p).is_err(), "a side dented");
        // By a hair: rounding of coordinates, and counted.
        p.vertices[8] = [0.5, 3e-13];
        assert!(partition_covers(&face, &p).is_ok_and(|off| off[1] >= 3e-13), "a side dented by a hair");
        p.vertices[8] = [0.5, f64::NAN];
        assert!(partition_covers(&face, &p).is_err(), "a vertex that is not a number");
        let mut f = face;
        f.loops.pop();
        assert!(partition_covers(&f, &good).is_err(), "a hole forgotten");
    }
}
