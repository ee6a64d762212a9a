//! Borders between the labels of a partition, cut into smooth chains that both sides share.
//!
//! Purely a matter of the triangulation and of the vertices' places in space: a chain ends where more than two
//! labels or trimming edges meet, at corners, and closed borders get two ends. Since nothing here depends on the
//! panels, both neighbours of a seam see the same vertices and the same parameters.
//! Method: the shared boundary data of the certificate specification, section 5.

use crate::num::hash::HashMap;
use std::collections::{BTreeMap, BTreeSet};

use crate::geom::Vec3;
use crate::patchwork::partition::Partition;

/// What lies on the right of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Right {
    /// Triangles with this label.
    Label(u32),
    /// Nothing: the chain lies on this trimming edge.
    Trim(u32),
}

/// A smooth stretch of border.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BorderStretch {
    /// Vertices in order, label `left` on their left.
    pub vertices: Vec<u32>,
    /// Parameter of every vertex, from 0 to 1, increasing: chord length in the scaled parameter plane, so that a
    /// border that is straight there has constant speed, and the same speed in space on both sides of creases of the
    /// parametrisation.
    pub parameters: Vec<f64>,
    /// Label on the left.
    pub left: u32,
    /// What lies on the right.
    pub right: Right,
    /// Length of the polyline in space, mm; 0 for a border that a pole collapses to a point.
    pub length: f64,
}

/// Smallest turn (rad, 15°) that can be a corner.
const CORNER: f64 = 0.26;
/// A turn (rad, 40°) that is a corner even among its like: the border is too coarse to be called curved.
const SHARP: f64 = 0.70;
/// A corner turns this many times as much as the border beside it.
const OUTSTANDING: f64 = 2.5;
/// Share of the window around a vertex in which at least half of a corner's turn must happen.
const CONCENTRATED: f64 = 0.1;
/// Chains shorter than this share of the model's box are points.
const POINT: f64 = 1e-10;

/// All chains of a partition. `points`: places of the vertices in space (mm); `scale`: mean length in space (mm) of
/// the units of u and v; `trim_edge(a, b)`: number of the trimming edge under a directed border edge; `gain(a, b, c)`:
/// factor by which the length in space per scaled length in the parameter plane jumps at `b` on the way from `a` to `c`,
/// 1 but on creases of the parametrisation; `cuts`: vertices in which chains end besides.
#[expect(clippy::too_many_lines, reason = "one walk along borders with its state")]
pub fn chains(
    partition: &Partition,
    points: &[Vec3],
    scale: [f64; 2],
    trim_edge: &dyn Fn(u32, u32) -> u32,
    gain: &dyn Fn(u32, u32, u32) -> f64,
    cuts: &BTreeSet<u32>,
) -> Vec<BorderStretch> {
    // 1. Border edges, each once: seams with the smaller label on the left.
    let label = label_map(partition);
    let mut border: BTreeMap<(u32, u32), (u32, Right)> = BTreeMap::new();
    for (&(a, b), &l) in &label {
        match label.get(&(b, a)) {
            None => {
                border.insert((a, b), (l, Right::Trim(trim_edge(a, b))));
            }
            Some(&m) if l < m => {
                border.insert((a, b), (l, Right::Label(m)));
            }
            Some(_) => {}
        }
    }
    // 2. Nodes by topology.
    let mut incident: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    for &e in border.keys() {
        incident.entry(e.0).or_default().push(e);
        incident.entry(e.1).or_default().push(e);
    }
    let mut nodes: BTreeSet<u32> =
        incident.iter().filter(|(_, e)| e.len() != 2 || border[&e[0]] != border[&e[1]]).map(|(&v, _)| v).collect();
    nodes.extend(cuts.iter().filter(|v| incident.contains_key(v)));
    let outgoing: HashMap<u32, Vec<(u32, u32)>> =
        incident.iter().map(|(&v, e)| (v, e.iter().copied().filter(|e| e.0 == v).collect::<Vec<_>>())).collect();
    // 3. Polylines from node to node, then closed ones from their first vertex.
    let mut used: BTreeSet<(u32, u32)> = BTreeSet::new();
    let mut polylines = Vec::new();
    let starts: Vec<(u32, u32)> =
        nodes.iter().flat_map(|v| outgoing[v].iter().copied()).chain(border.keys().copied()).collect();
    for start in starts {
        if used.contains(&start) {
            continue;
        }
        let mut line = vec![start.0, start.1];
        used.insert(start);
        nodes.insert(start.0);
        while let Some(&end) = line.last() {
            if nodes.contains(&end) {
                break;
            }
            let Some(&next) = outgoing[&end].iter().find(|e| !used.contains(*e)) else { break };
            used.insert(next);
            line.push(next.1);
        }
        polylines.push((line, border[&start]));
    }
    // 4. Cuts at corners and in closed lines.
    let size = crate::geom::BBox::of(points).diagonal();
    let mut out = Vec::new();
    for (line, (left, right)) in polylines {
        let place: Vec<Vec3> = line.iter().map(|&v| points[v as usize]).collect();
        let mut cuts = corners(&place);
        if line[0] == line[line.len() - 1] && cuts.is_empty() {
            let total = polyline_length(&place);
            let mut l = 0.0;
            let mut middle = line.len() / 2;
            for i in 1..line.len() - 1 {
                l += (place[i] - place[i - 1]).norm();
                if l >= 0.5 * total {
                    middle = i;
                    break;
                }
            }
            cuts.push(middle);
        }
        cuts.insert(0, 0);
        cuts.push(line.len() - 1);
        for w in cuts.windows(2) {
            let vertices = line[w[0]..=w[1]].to_vec();
            let length = polyline_length(&place[w[0]..=w[1]]);
            let length = if length > POINT * size { length } else { 0.0 };
            let mut pace = 1.0;
            let steps: Vec<f64> = (0..vertices.len() - 1)
                .map(|k| {
                    if k > 0 {
                        pace *= gain(vertices[k - 1], vertices[k], vertices[k + 1]);
                    }
                    let [p, q] = [k, k + 1].map(|k| partition.vertices[vertices[k] as usize]);
                    pace * (scale[0] * (q[0] - p[0])).hypot(scale[1] * (q[1] - p[1]))
                })
                .collect();
            let parameters = increasing(&steps);
            out.push(BorderStretch { vertices, parameters, left, right, length });
        }
    }
    out
}

/// Label of the triangle on the left of every directed edge.
pub(crate) fn label_map(partition: &Partition) -> HashMap<(u32, u32), u32> {
    let mut map = HashMap::with_capacity_and_hasher(3 * partition.triangles.len(), Default::default());
    for (t, &l) in partition.triangles.iter().zip(&partition.labels) {
        for k in 0..3 {
            map.insert((t[k], t[(k + 1) % 3]), l);
        }
    }
    map
}

/// Closed border loops of one label as vertex cycles, the label on their left. Around a vertex that several fans of
/// the label share, each fan is followed on its own.
pub fn loops(partition: &Partition, label: u32) -> Vec<Vec<u32>> {
    let mut opposite: HashMap<(u32, u32), u32> = HashMap::default();
    let mut edges = Vec::new();
    for (t, &l) in partition.triangles.iter().zip(&partition.labels) {
        if l == label {
            for k in 0..3 {
                opposite.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
                edges.push((t[k], t[(k + 1) % 3]));
            }
        }
    }
    let mut left: BTreeSet<(u32, u32)> =
        edges.iter().copied().filter(|&(a, b)| !opposite.contains_key(&(b, a))).collect();
    let mut out = Vec::new();
    while let Some(start) = left.pop_first() {
        let mut cycle = vec![start.0];
        let mut edge = start;
        loop {
            // Turn around the end of the edge inside the label until the border is met.
            let pivot = edge.1;
            let mut c = opposite[&edge];
            while let Some(&d) = opposite.get(&(c, pivot)) {
                c = d;
            }
            edge = (pivot, c);
            if edge == start || !left.remove(&edge) {
                break;
            }
            cycle.push(edge.0);
        }
        out.push(cycle);
    }
    out
}

fn polyline_length(p: &[Vec3]) -> f64 {
    p.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// Increasing parameters from 0 to 1 with the given ratios of steps.
fn increasing(steps: &[f64]) -> Vec<f64> {
    // Share of the mean step that is added to each: parameters increase over steps without length, too.
    const HAIR: f64 = 1e-9;
    let n = steps.len();
    let total: f64 = steps.iter().sum();
    let hair = if total > 0.0 { HAIR * total / n as f64 } else { 1.0 };
    let sum = total + hair * n as f64;
    let mut s = 0.0;
    let mut out = vec![0.0];
    for step in &steps[..n - 1] {
        s += step + hair;
        out.push(s / sum);
    }
    out.push(1.0);
    out
}

/// Interior vertices at which a polyline has a corner, in order.
fn corners(p: &[Vec3]) -> Vec<usize> {
    let n = p.len();
    if n < 3 {
        return Vec::new();
    }
    let mut at = vec![0.0; n];
    for i in 1..n {
        at[i] = at[i - 1] + (p[i] - p[i - 1]).norm();
    }
    let total = at[n - 1];
    let mut steps: Vec<f64> = at.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let window = steps[steps.len() / 2].max(total / 500.0);
    if total <= 0.0 || window <= 0.0 {
        return Vec::new();
    }
    let point = |l: f64| {
        let k = at.partition_point(|&a| a <= l).clamp(1, n - 1);
        let d = at[k] - at[k - 1];
        let s = if d > 0.0 { ((l - at[k - 1]) / d).clamp(0.0, 1.0) } else { 0.0 };
        p[k - 1] + (p[k] - p[k - 1]) * s
    };
    // Turn over the window at arc length l; near the ends of the line the window is one-sided shorter.
    let turn = |l: f64| {
        let (b, f) = ((l - window).max(0.0), (l + window).min(total));
        if l - b < 0.2 * window || f - l < 0.2 * window {
            return 0.0;
        }
        let m = point(l);
        angle(&(m - point(b)), &(point(f) - m))
    };
    let bare: Vec<f64> = (0..n)
        .map(|i| if i == 0 || i == n - 1 { 0.0 } else { angle(&(p[i] - p[i - 1]), &(p[i + 1] - p[i])) })
        .collect();
    let wide: Vec<f64> = (0..n).map(|i| if bare[i] > 0.25 * CORNER { turn(at[i]) } else { 0.0 }).collect();
    let mut out: Vec<usize> = Vec::new();
    let at = &at;
    for i in 1..n - 1 {
        if wide[i] < CORNER {
            continue;
        }
        let near = |reach: f64| (0..n).filter(move |&j: &usize| (at[j] - at[i]).abs() <= reach);
        let concentrated: f64 = near(CONCENTRATED * window).map(|j| bare[j]).sum();
        let greatest = near(0.9 * window).all(|j| (wide[j], j) <= (wide[i], i));
        let beside = turn(at[i] - 2.0 * window).max(turn(at[i] + 2.0 * window));
        if greatest && concentrated > 0.5 * wide[i] && (wide[i] > SHARP || wide[i] > OUTSTANDING * beside) {
            out.push(i);
        }
    }
    out
}

fn angle(a: &Vec3, b: &Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Square of n × n cells, two triangles each, on [0, 1]²; the label of a cell by `label`.
    pub fn grid(n: u32, label: impl Fn(u32, u32) -> u32) -> Partition {
        let mut p = Partition::default();
        for j in 0..=n {
            for i in 0..=n {
                p.vertices.push([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)]);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let a = j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                p.triangles.extend([[a, b, c], [a, c, d]]);
                p.labels.extend([label(i, j); 2]);
            }
        }
        p
    }

    fn flat(p: &Partition) -> Vec<Vec3> {
        p.vertices.iter().map(|v| Vec3::new(v[0], v[1], 0.0)).collect()
    }

    fn side(p: &Partition) -> impl Fn(u32, u32) -> u32 + '_ {
        |a, b| {
            let m = [p.vertices[a as usize], p.vertices[b as usize]];
            if m.iter().all(|v| v[1] < 1e-9) {
                0
            } else if m.iter().all(|v| v[0] > 1.0 - 1e-9) {
                1
            } else if m.iter().all(|v| v[1] > 1.0 - 1e-9) {
                2
            } else {
                3
            }
        }
    }

    #[test]
    fn two_halves_share_one_chain() {
        let p = grid(6, |i, _| u32::from(i >= 3));
        let c = chains(&p, &flat(&p), [1.0; 2], &side(&p), &|_, _, _| 1.0, &BTreeSet::new());
        let seams: Vec<_> = c.iter().filter(|c| matches!(c.right, Right::Label(_))).collect();
        assert_eq!(seams.len(), 1);
        assert_eq!((seams[0].left, seams[0].right, seams[0].vertices.len()), (0, Right::Label(1), 7));
        // Bottom and top are cut by the seam's ends, left and right are whole.
        assert_eq!(c.len(), 1 + 6);
        for c in &c {
            assert!(c.parameters.windows(2).all(|w| w[0] < w[1]));
            assert_eq!((c.parameters[0], c.parameters[c.parameters.len() - 1]), (0.0, 1.0));
        }
    }

    #[test]
    fn an_island_has_corners_and_a_round_one_two_ends() {
        let p = grid(8, |i, j| u32::from((2..6).contains(&i) && (2..6).contains(&j)));
        let c = chains(&p, &flat(&p), [1.0; 2], &side(&p), &|_, _, _| 1.0, &BTreeSet::new());
        assert_eq!(c.iter().filter(|c| c.right == Right::Label(1)).count(), 4);
        let ring: Vec<Vec3> = (0..=40)
            .map(|i| f64::from(i) / 40.0 * std::f64::consts::TAU)
            .map(|a| Vec3::new(a.cos(), a.sin(), 0.0))
            .collect();
        assert!(corners(&ring).is_empty());
        let mut bent: Vec<Vec3> = (0..20).map(|i| Vec3::new(f64::from(i), 0.0, 0.0)).collect();
        bent.extend((1..20).map(|i| Vec3::new(19.0 + 0.9 * f64::from(i), 0.4 * f64::from(i), 0.0)));
        assert_eq!(corners(&bent), vec![19]);
    }

    #[test]
    fn loops_keep_the_label_on_the_left_and_fans_apart() {
        let p = grid(4, |i, j| u32::from(i == j));
        // Diagonal cells touch in vertices only: four separate loops.
        assert_eq!(loops(&p, 1).len(), 4);
        let ring = grid(4, |i, j| u32::from((1..3).contains(&i) && (1..3).contains(&j)));
        let mut lengths: Vec<usize> = loops(&ring, 0).iter().map(Vec::len).collect();
        lengths.sort_unstable();
        assert_eq!(lengths, vec![8, 16]);
    }
}
