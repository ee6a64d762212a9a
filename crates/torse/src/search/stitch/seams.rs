//! Edges that panels share, and vertices of borders that go under them. Nothing is judged here.

use crate::brep::face::Face;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::spline::curve::Curve;
use std::collections::BTreeSet;

/// An edge in space for a chain of the borders.
#[derive(Clone, Debug)]
pub(crate) struct SharedSeam {
    pub chain: usize,
    pub labels: [u32; 2],
    pub edge: Curve<3>,
    pub parameters: Vec<f64>,
}

/// Labels of two neighbours, in order.
pub(crate) fn pair([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Moves the vertices of borders to places given by border, vertex, and for whether its parameters must stay: vertices on
/// knot lines move along these, ends on a trimming curve only where that runs along a parameter line, and along it. Where
/// triangles would turn over, the vertices around are moved out of the way; vertices for which that is not enough stay too,
/// and are the result.
pub(crate) fn settle(
    face: &Face,
    partition: &mut Partition,
    along: &[&SeamChain],
    place: impl Fn(usize, [f64; 2], [bool; 2]) -> Option<[f64; 2]> + Sync,
) -> BTreeSet<u32> {
    let lines = [face.surface.knots_u.breaks(), face.surface.knots_v.breaks()];
    let mut all: Vec<(usize, u32, bool)> = Vec::new();
    for (k, chain) in along.iter().enumerate() {
        let last = chain.vertices.len() - 1;
        all.extend(chain.vertices.iter().enumerate().map(|(i, &v)| (k, v, i == 0 || i == last)));
    }
    let ends = all.iter().filter(|e| e.2).map(|e| e.1).collect();
    let held = held_by_border(face, partition, &ends);
    let mut waiting: Vec<(u32, [f64; 2])> = parallel::map(all.iter(), |&(k, v, is_end)| {
        let old = partition.vertices[v as usize];
        let mut fixed = [0, 1].map(|d: usize| lines[d].contains(&old[d]));
        if let Some(held) = held.get(&v) {
            if *held == [false; 2] {
                return None;
            }
            fixed = [0, 1].map(|d: usize| fixed[d] || held[d]);
        }
        let stays = fixed == [true; 2] || (is_end && fixed == [false; 2]);
        if stays {
            None
        } else {
            Some((v, place(k, old, fixed)?))
        }
    })
    .into_iter()
    .flatten()
    .collect();
    let mut around: HashMap<u32, Vec<usize>> = waiting.iter().map(|&(v, _)| (v, Vec::new())).collect();
    for (t, corners) in partition.triangles.iter().enumerate() {
        for v in corners {
            if let Some(a) = around.get_mut(v) {
                a.push(t);
            }
        }
    }
    let area = |p: &Partition, t: usize| {
        let [a, b, c] = p.corners(t);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for _ in 0..SETTLINGS {
        waiting.retain(|&(v, new)| {
            let old = partition.vertices[v as usize];
            let before: Vec<f64> = around[&v].iter().map(|&t| area(partition, t)).collect();
            for share in SETTLING_SHARES {
                let to = |d: usize| if share < 1.0 { old[d] + (new[d] - old[d]) * share } else { new[d] };
                // Coordinates on knot lines are the same in both.
                partition.vertices[v as usize] = [to(0), to(1)];
                if around[&v].iter().zip(&before).all(|(&t, b)| area(partition, t) > LEAST_TRIANGLE * b) {
                    return share < 1.0;
                }
            }
            partition.vertices[v as usize] = old;
            true
        });
        if waiting.is_empty() {
            break;
        }
        partition.relax([&lines[0], &lines[1]]);
    }
    waiting.into_iter().map(|w| w.0).collect()
}

/// The parameters that vertices on the border of the face must keep in order to stay on it: where it runs along parameter lines
/// on both sides of them the one that is the same there; both at the corners of the trimming polygons; none of both elsewhere,
/// where there is no way along the border.
fn held_by_border(face: &Face, partition: &Partition, of: &BTreeSet<u32>) -> HashMap<u32, [bool; 2]> {
    let corners: HashSet<[u64; 2]> = face.loops.iter().flat_map(|l| &l.points).map(|p| p.map(f64::to_bits)).collect();
    let left = partition.adjacency();
    let mut out = HashMap::default();
    for &(a, b) in left.keys().filter(|(a, b)| !left.contains_key(&(*b, *a))) {
        for (v, beside) in [(a, b), (b, a)].into_iter().filter(|(v, _)| of.contains(v)) {
            let [p, q] = [v, beside].map(|v| partition.vertices[v as usize]);
            let is_corner = corners.contains(&p.map(f64::to_bits));
            let held: &mut [bool; 2] = out.entry(v).or_insert([true; 2]);
            (0..2).for_each(|d| held[d] &= is_corner || p[d].to_bits() == q[d].to_bits());
        }
    }
    out
}

/// Times that vertices try to settle, at most: some have no room.
const SETTLINGS: usize = 8;
/// Shares of the way that they try each time.
const SETTLING_SHARES: [f64; 3] = [1.0, 0.5, 0.2];
/// Triangles keep this share of their area when vertices move.
const LEAST_TRIANGLE: f64 = 0.05;

/// The edges that panels of a patchwork share, for those borders that are still the same.
pub(crate) fn kept(patchwork: &Patchwork, borders: &Borders) -> Vec<SharedSeam> {
    let seams = patchwork.seams();
    let sides: Vec<_> = seams.iter().filter(|s| s.is_shared()).flat_map(|s| s.sides).collect();
    let same = |c: SeamChain| {
        let run = sides.iter().map(|s| s.run).find(|r| r.vertices == c.vertices)?;
        let (edge, parameters) = (run.edge.clone(), run.parameters.clone());
        Some(SharedSeam { chain: c.chain, labels: c.labels, edge, parameters })
    };
    borders.seam_chains().into_iter().filter_map(same).collect()
}

/// Labels on both sides of edges that end in one vertex of the borders, but in different points.
pub(crate) fn clashing(edges: &[SharedSeam], borders: &Borders) -> Vec<[u32; 2]> {
    let chains = borders.seam_chains();
    // By vertex: the point, bit by bit, and the labels.
    type End = ([u64; 3], [u32; 2]);
    let mut ends: HashMap<u32, Vec<End>> = HashMap::default();
    for e in edges {
        let Some(chain) = chains.iter().find(|c| c.chain == e.chain) else { continue };
        let points = [e.edge.control.first(), e.edge.control.last()];
        for (v, x) in [chain.vertices.first(), chain.vertices.last()].into_iter().zip(points) {
            if let (Some(v), Some(x)) = (v, x) {
                ends.entry(*v).or_default().push((x.map(f64::to_bits), pair(e.labels)));
            }
        }
    }
    let differ = ends.into_values().filter(|e| e.iter().any(|x| x.0 != e[0].0));
    differ.flatten().map(|e| e.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::TrimLoop;
    use crate::geom::Vec3;
    use crate::search::build::borders as borders_of;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    /// A plane with a knot line at u = 0.5, trimmed at v = 0.8, or aslant from there, and a border of two labels up to that
    /// side at the given u.
    fn halved(end: f64, slope: f64) -> (Face, Partition) {
        let (u, v) =
            (Knots::clamped(1, &[0.0, 0.5, 1.0]).expect("knots"), Knots::clamped(1, &[0.0, 1.0]).expect("knots"));
        let points: Vec<Vec3> =
            [0.0, 0.5, 1.0].iter().flat_map(|&x| [0.0, 1.0].map(|y| Vec3::new(x, y, 0.0))).collect();
        let mut face = Face::untrimmed(Surface::new(u, v, &points, None).expect("surface"));
        let top = |u: f64| [u, 0.8 + slope * u];
        let corners = vec![[0.0, 0.0], [1.0, 0.0], top(1.0), top(0.0)];
        face.loops = vec![TrimLoop { points: corners.clone(), edge: vec![0, 1, 2, 3] }];
        let mut vertices = corners;
        vertices.extend([[end, 0.0], top(end)]);
        let triangles = vec![[0, 4, 5], [0, 5, 3], [4, 1, 2], [4, 2, 5]];
        (face, Partition { vertices, labels: vec![0, 0, 1, 1], triangles, ..Partition::default() })
    }

    /// Where the upper end of the border gets to that wants to go up and to the right, as far as its parameters may.
    fn settled(face: &Face, mut partition: Partition) -> [f64; 2] {
        let borders = borders_of(face, &partition);
        let chains = borders.seam_chains();
        let along: Vec<&SeamChain> = chains.iter().collect();
        settle(face, &mut partition, &along, |_, p, fixed| {
            let step = |d: usize| if fixed[d] { p[d] } else { p[d] + 0.1 };
            Some([step(0), step(1)])
        });
        partition.vertices[5]
    }

    #[test]
    fn ends_of_borders_stay_on_the_border_of_the_face() {
        // Where a knot line meets a side that is none it is no way on.
        let (face, partition) = halved(0.5, 0.0);
        assert_eq!(settled(&face, partition), [0.5, 0.8]);
        // Along a side of constant parameter there is one; across any other there is none.
        let (face, partition) = halved(0.25, 0.0);
        assert_eq!(settled(&face, partition), [0.35, 0.8]);
        for end in [0.25, 0.5] {
            let (face, partition) = halved(end, 0.1);
            let before = partition.vertices[5];
            assert_eq!(settled(&face, partition), before);
        }
        // Corners of the trimming polygon stay.
        let (mut face, partition) = halved(0.25, 0.0);
        face.loops[0].points.insert(3, [0.25, 0.8]);
        face.loops[0].edge.push(4);
        assert_eq!(settled(&face, partition), [0.25, 0.8]);
    }
}
