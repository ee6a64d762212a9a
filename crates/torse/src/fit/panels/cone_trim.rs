//! Cone splines cut along an outline: holes, slanting edges and trims of the surface that a chain stands for.
//!
//! *Method*: the outline is carried to the chain by perpendiculars, the region is triangulated with the joints as
//! lines, and every border between two pieces or of one piece becomes one edge, so that neighbours share it. Pieces
//! stay exact cones, cylinders and planes \[LP98\].

use super::chains::{chains, loops as cycles, BorderStretch, Right};
use super::trim::{edge, trim, Waypoint};
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::patchwork::partition::Partition;
use crate::patchwork::triangulate::{triangulate, TriangulateError};
use crate::spline::SplineError;
use crate::torse::cone::chart::{Blank, ConeChart};
use crate::torse::cone::distance::forward_of;
use crate::torse::cone::part::{ConePart, PartCurve, PartEdge, PartFace};
use crate::torse::cone::spline::ConeSpline;
use std::collections::BTreeSet;

/// A corner of the outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePoint {
    /// Place, mm.
    pub point: Vec3,
    /// Number of the border's edge to the next corner.
    pub edge: u32,
}

/// Options of [`cone_part`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeTrimOptions {
    /// Distance allowed between the outline and the edges, mm; no default.
    pub outline: f64,
    /// Distance allowed between edges and surfaces, mm; no default.
    pub edge: f64,
}

/// Why a chain cannot be cut along an outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConeTrimError {
    /// The outline is no outline on the chain.
    #[error("the outline does not bound a region of the cones: {0}")]
    Region(#[from] TriangulateError),
    /// A segment that turns too far, or a region that reaches a vertex.
    #[error("segment {segment}: {source}")]
    Segment {
        /// Number of the segment.
        segment: usize,
        /// Reason.
        source: SplineError,
    },
    /// An outline that touches itself at a point.
    #[error("the outline touches itself on segment {segment}; part the region there")]
    Pinch {
        /// Number of the segment.
        segment: usize,
    },
    /// An offset beyond the vertex.
    #[error("segment {segment}: its offset by {delta} mm would reach its vertex; a thinner sheet would help")]
    Offset {
        /// Number of the segment.
        segment: usize,
        /// The offset, mm.
        delta: f64,
    },
    /// An empty chain.
    #[error("the chain has no segments")]
    Empty,
}

/// Least number of waypoints of an edge, less one.
const LEAST_WAYPOINTS: usize = 12;
/// Lines of the triangulation to a segment.
const LINES: usize = 8;
/// The same, at most, for the whole chain.
const MOST_LINES: usize = 2000;

/// Cuts a chain along closed outlines (even-odd rule; corners dense enough that chords are good).
///
/// *Input*: corners near the chain. *Guarantee*: pieces share their joints; all vertices lie on the chain up to
/// rounding; edges within `edge` of it. *Not guaranteed*: the distance of the outline, which is measured at its
/// corners ([`ConePart::outline_estimate`]).
///
/// # Errors
/// See [`ConeTrimError`].
#[expect(clippy::too_many_lines, reason = "one walk round a border with its state")]
pub fn cone_part(
    spline: &ConeSpline,
    outlines: &[Vec<OutlinePoint>],
    options: &ConeTrimOptions,
) -> Result<ConePart, ConeTrimError> {
    let count = spline.segments.len();
    let chart = ConeChart::new(spline);
    // 1. The outline in the coordinates of the chain.
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut carried = Vec::with_capacity(outlines.len());
    for l in outlines {
        let (mut corners, mut edges) = (Vec::with_capacity(l.len()), Vec::with_capacity(l.len()));
        let mut guess = None;
        let first = beginning(&chart, l, count);
        for k in (first..l.len()).chain(0..first) {
            let p = &l[k];
            let q = match guess {
                None => chart.nearest(&p.point),
                // Corners are close to each other.
                Some(guess) => chart.foot(&p.point, guess),
            };
            let q = q.ok_or(ConeTrimError::Empty)?;
            let at = q[0].max(0.0) as usize;
            guess = Some(at);
            corners.push(q);
            edges.push(p.edge);
            let next = &l[(k + 1) % l.len()].point;
            let end = chart.foot(next, at).ok_or(ConeTrimError::Empty)?;
            for crossing in crossings(spline, &chart, [&p.point, next], [q[0], end[0]]) {
                corners.push(crossing);
                edges.push(p.edge);
            }
        }
        range = corners.iter().fold(range, |r, q| [r[0].min(q[1]), r[1].max(q[1])]);
        carried.push((corners, edges));
    }
    // 2. Triangles, labelled by their segments; every label one connected piece.
    let lines = LINES.min(MOST_LINES / count.max(1)).max(1);
    let across: Vec<f64> = (0..=count * lines).map(|k| k as f64 / lines as f64).collect();
    let mut partition = triangulate(&carried, &across, &range)?;
    for t in 0..partition.triangles.len() {
        let x = partition.corners(t).iter().map(|c| c[0]).sum::<f64>() / 3.0;
        partition.labels[t] = (x.max(0.0) as u32).min(count as u32 - 1);
    }
    let mut segment_of: HashMap<u32, usize> = HashMap::default();
    for label in partition.distinct_labels() {
        for piece in partition.split_components(label) {
            segment_of.insert(piece, label as usize);
        }
    }
    let mut labels: Vec<(usize, u32)> = segment_of.iter().map(|(&l, &s)| (s, l)).collect();
    labels.sort_unstable();
    // 3. Blanks.
    let mut part = ConePart::default();
    let mut face_of: HashMap<u32, usize> = HashMap::default();
    for &(segment, label) in &labels {
        let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
        for v in partition.region_vertices(label) {
            let r = chart.within(segment, partition.vertices[v as usize])[1];
            reach = [reach[0].min(r), reach[1].max(r)];
        }
        let blank = Blank::new(&spline.segments[segment], reach[0], reach[1])
            .map_err(|source| ConeTrimError::Segment { segment, source })?;
        face_of.insert(label, part.faces.len());
        let mesh = mesh(&partition, label, &chart, segment, spline);
        part.faces.push(PartFace { segment, blank, loops: Vec::new(), mesh });
    }
    // 4. Edges.
    let points: Vec<Vec3> = partition.vertices.iter().map(|q| chart.point(*q).unwrap_or_else(Vec3::zeros)).collect();
    let scale = [mean_width(spline, &range, &chart), 1.0];
    let border = |a: u32, b: u32| partition.trim_edges.get(&(a, b)).copied().unwrap_or(0);
    let all = chains(&partition, &points, scale, &border, &|_, _, _| 1.0, &BTreeSet::new());
    let mut vertex_of: HashMap<u32, usize> = HashMap::default();
    for chain in &all {
        let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]].map(|v| {
            *vertex_of.entry(v).or_insert_with(|| {
                part.vertices.push(points[v as usize]);
                part.places.push(chart.on_segment(partition.vertices[v as usize]));
                part.vertices.len() - 1
            })
        });
        let face = face_of.get(&chain.left).copied().unwrap_or(0);
        let (curve, border) = match chain.right {
            Right::Label(_) => (PartCurve::Ruling, None),
            Right::Trim(number) if straight(chain, &partition, scale[0], options.edge) => {
                (PartCurve::Ruling, Some(number))
            }
            Right::Trim(number) => {
                let (curve, off) = free(chain, &partition, &chart, &part.faces[face], face, options)
                    .map_err(|source| ConeTrimError::Segment { segment: part.faces[face].segment, source })?;
                part.outline_estimate = part.outline_estimate.max(off);
                (curve, Some(number))
            }
        };
        part.edges.push(PartEdge { start: ends[0], end: ends[1], curve, border });
    }
    // 5. Loops.
    for &(segment, label) in &labels {
        let k = face_of[&label];
        part.faces[k].loops = loops_of(&partition, label, &all).ok_or(ConeTrimError::Pinch { segment })?;
    }
    Ok(part)
}

/// The corner from which an outline is followed: the one farthest from both ends of the chain, of a few. Where a chain closes,
/// those on its first ruling lie on the last one too.
fn beginning(chart: &ConeChart, corners: &[OutlinePoint], count: usize) -> usize {
    /// Corners looked at.
    const TRIED: usize = 16;
    let tried = (0..TRIED.min(corners.len())).map(|k| k * corners.len() / TRIED.min(corners.len()));
    let inside = |k: usize| chart.nearest(&corners[k].point).map(|q| q[0].min(count as f64 - q[0]));
    let all = tried.filter_map(|k| Some((k, inside(k)?)));
    all.fold((0, f64::NEG_INFINITY), |best, here| if here.1 > best.1 { here } else { best }).0
}

/// Places where the chord of two corners crosses joints, in its order: chords in coordinates have a kink there, as shares
/// of turn are of different length on both sides. `x` are the first coordinates of both.
fn crossings(spline: &ConeSpline, chart: &ConeChart, [p, q]: [&Vec3; 2], x: [f64; 2]) -> Vec<[f64; 2]> {
    /// A joint nearer to a corner than this share of a segment is that corner.
    const CORNER: f64 = 1e-9;
    let inside = |j: f64| j > x[0].min(x[1]) + CORNER && j < x[0].max(x[1]) - CORNER;
    let mut joints: Vec<usize> = (1..spline.segments.len()).filter(|j| inside(*j as f64)).collect();
    if x[0] > x[1] {
        joints.reverse();
    }
    let place = |j: usize| {
        let [a, b] = [p, q].map(|c| forward_of(&spline.segments[j].start, c));
        let share = a / (a - b);
        let on = (p + (q - p) * share.clamp(0.0, 1.0)).to_owned();
        share.is_finite().then(|| chart.foot(&on, j)).flatten().map(|f| [j as f64, f[1]])
    };
    joints.into_iter().filter_map(place).collect()
}

/// The parallel part at the signed distance `delta` along the normals (sheet thickness): every piece exactly a cone, a
/// cylinder or a plane again, edges over the edges, within `edge` (mm) of the new surfaces.
///
/// # Errors
/// A piece whose offset would reach its vertex.
pub(crate) fn offset(part: &ConePart, delta: f64, edge_tolerance: f64) -> Result<ConePart, ConeTrimError> {
    let mut out = part.clone();
    for f in &mut out.faces {
        let segment = f.segment;
        let moved = f.blank.segment.offset(delta);
        if moved.fault().is_some() {
            return Err(ConeTrimError::Offset { segment, delta });
        }
        f.blank = Blank::of(moved).map_err(|source| ConeTrimError::Segment { segment, source })?;
        for (p, n) in f.mesh.positions.iter_mut().zip(&f.mesh.normals) {
            *p += n * delta;
        }
    }
    let blank_of: HashMap<usize, usize> = out.faces.iter().enumerate().map(|(k, f)| (f.segment, k)).collect();
    for (v, (segment, [f, _])) in out.vertices.iter_mut().zip(&part.places) {
        // Neighbours agree on the normal of their joint.
        if let Some(&k) = blank_of.get(segment) {
            *v += part.faces[k].blank.segment.element(*f).normal * delta;
        }
    }
    for e in &mut out.edges {
        if let PartCurve::Free { face, trim, space } = &mut e.curve {
            let piece = &out.faces[*face];
            let segment = piece.segment;
            *space = edge(&piece.blank.patch, trim, edge_tolerance)
                .map_err(|source| ConeTrimError::Segment { segment, source })?;
        }
    }
    Ok(out)
}

/// Mean length (mm) of a segment across its rulings, in the middle of the region.
fn mean_width(spline: &ConeSpline, range: &[f64; 2], chart: &ConeChart) -> f64 {
    let y = 0.5 * (range[0] + range[1]);
    let ends = |i: usize| {
        let s = &spline.segments[i];
        let r = chart.within(i, [0.0, y])[1];
        (s.point(1.0, r) - s.point(0.0, r)).norm()
    };
    let total: f64 = (0..spline.segments.len()).map(ends).sum();
    total / spline.segments.len().max(1) as f64
}

/// Whether a chain runs along a ruling, up to a distance (mm); `width` is the length of one in x.
fn straight(chain: &BorderStretch, partition: &Partition, width: f64, off: f64) -> bool {
    let x = |v: u32| partition.vertices[v as usize][0];
    chain.vertices.iter().all(|&v| (x(v) - x(chain.vertices[0])).abs() * width <= off)
}

/// The curve of a chain on the blank of its piece, and its distance (mm) from the chain's corners.
fn free(
    chain: &BorderStretch,
    partition: &Partition,
    chart: &ConeChart,
    piece: &PartFace,
    face: usize,
    options: &ConeTrimOptions,
) -> Result<(PartCurve, f64), SplineError> {
    // Chords are what the outline is: a few places on long ones determine the curve between their ends.
    let parts = LEAST_WAYPOINTS.div_ceil(chain.vertices.len() - 1);
    let mut waypoints = Vec::with_capacity(parts * chain.vertices.len());
    let mut add = |s: f64, q: [f64; 2]| {
        let place = piece.blank.place(chart.within(piece.segment, q));
        waypoints.push(Waypoint { s, place, allowance: options.outline });
    };
    for (v, s) in chain.vertices.windows(2).zip(chain.parameters.windows(2)) {
        let [a, b] = [v[0], v[1]].map(|v| partition.vertices[v as usize]);
        for k in 0..parts {
            let x = k as f64 / parts as f64;
            add(s[0] + (s[1] - s[0]) * x, [0, 1].map(|d| a[d] + (b[d] - a[d]) * x));
        }
    }
    if let (Some(&v), Some(&s)) = (chain.vertices.last(), chain.parameters.last()) {
        add(s, partition.vertices[v as usize]);
    }
    // Too few waypoints to choose a curve by: more on the chords, which is what the outline is.
    let half = |a: &Waypoint, b: &Waypoint| {
        let place = [0, 1].map(|d| 0.5 * (a.place[d] + b.place[d]));
        Some(Waypoint { s: 0.5 * (a.s + b.s), place, allowance: options.outline })
    };
    let fitted = trim(&piece.blank.patch, waypoints, half)?;
    let space = edge(&piece.blank.patch, &fitted.curve, options.edge)?;
    Ok((PartCurve::Free { face, trim: fitted.curve, space }, fitted.deviation_estimate))
}

/// Loops of a piece, outer first; seen from the side of the normals the chain's coordinates are mirrored.
fn loops_of(partition: &Partition, label: u32, all: &[BorderStretch]) -> Option<Vec<Vec<(usize, bool)>>> {
    let mut of_edge: HashMap<(u32, u32), (usize, bool)> = HashMap::default();
    for (k, c) in all.iter().enumerate() {
        let forward = c.left == label;
        if forward || c.right == Right::Label(label) {
            for w in c.vertices.windows(2) {
                of_edge.insert(if forward { (w[0], w[1]) } else { (w[1], w[0]) }, (k, forward));
            }
        }
    }
    let mut out: Vec<(f64, Vec<(usize, bool)>)> = Vec::new();
    let mut seen = HashSet::default();
    for cycle in cycles(partition, label) {
        let n = cycle.len();
        if cycle.iter().any(|v| !seen.insert(*v)) {
            return None;
        }
        let steps: Vec<(usize, bool)> =
            (0..n).map(|i| of_edge.get(&(cycle[i], cycle[(i + 1) % n])).copied()).collect::<Option<_>>()?;
        let begins = |i: usize| {
            let (k, forward) = steps[i];
            let v = &all[k].vertices;
            cycle[i] == if forward { v[0] } else { v[v.len() - 1] }
        };
        let begin = (0..n).find(|&i| begins(i))?;
        let mut uses: Vec<(usize, bool)> = Vec::new();
        for i in 0..n {
            let j = (begin + i) % n;
            if begins(j) {
                uses.push(steps[j]);
            }
        }
        let corner = |i: usize| partition.vertices[cycle[i % n] as usize];
        let area: f64 = (0..n).map(|i| corner(i)[0] * corner(i + 1)[1] - corner(i + 1)[0] * corner(i)[1]).sum();
        uses = uses.into_iter().rev().map(|(k, f)| (k, !f)).collect();
        out.push((area, uses));
    }
    out.sort_by(|a, b| b.0.total_cmp(&a.0));
    Some(out.into_iter().map(|(_, l)| l).collect())
}

/// Triangles of a piece.
fn mesh(partition: &Partition, label: u32, chart: &ConeChart, segment: usize, spline: &ConeSpline) -> Mesh {
    let mut mesh = Mesh::default();
    let mut index: HashMap<u32, u32> = HashMap::default();
    for v in partition.region_vertices(label) {
        let [f, r] = chart.within(segment, partition.vertices[v as usize]);
        let g = spline.segments[segment].element(f);
        index.insert(v, mesh.positions.len() as u32);
        mesh.positions.push(g.at(r));
        mesh.normals.push(g.normal);
    }
    for t in partition.region(label) {
        // Mirrored: the normals look the other way.
        let [a, b, c] = partition.triangles[t].map(|v| index[&v]);
        mesh.triangles.push([a, c, b]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::cone::spline::{Segment, Shape};
    use crate::torse::g1_element::G1Element;

    /// Three pieces of one cylinder about the z axis, normals outwards.
    fn cylinder() -> ConeSpline {
        let g = G1Element::new(Vec3::new(20.0, 0.0, 0.0), Vec3::z(), -Vec3::y()).expect("element");
        let mut spline = ConeSpline::default();
        let mut start = g;
        for _ in 0..3 {
            let s = Segment::new(start, Shape::Cylinder { radius: 20.0, angle: -0.5 });
            start = s.end();
            spline.segments.push(s);
        }
        spline
    }

    #[test]
    fn a_hole_over_a_joint_is_cut_from_both_pieces() {
        let spline = cylinder();
        let chart = ConeChart::new(&spline);
        let at = |place: [f64; 2], edge: u32| OutlinePoint { point: chart.point(place).expect("point"), edge };
        let rectangle: Vec<OutlinePoint> = (0..=24)
            .map(|k| at([3.0 * f64::from(k) / 24.0, 0.0], 0))
            .chain((0..=24).rev().map(|k| at([3.0 * f64::from(k) / 24.0, 40.0], 1)))
            .collect();
        let hole: Vec<OutlinePoint> = (0..120)
            .map(|k| std::f64::consts::TAU * f64::from(k) / 120.0)
            .map(|a| at([1.0 + 0.4 * a.cos(), 20.0 + 4.0 * a.sin()], 7))
            .collect();
        let options = ConeTrimOptions { outline: 1e-3, edge: 1e-6 };
        let part = cone_part(&spline, &[rectangle, hole], &options).expect("part");
        assert_eq!(part.faces.len(), 3);
        assert!(part.outline_estimate <= 1e-3);
        // Area by the development: width 10 each, an ellipse of half axes 4 and 4.
        let area: f64 = part
            .faces
            .iter()
            .flat_map(|f| f.mesh.triangles.iter().map(|t| t.map(|k| f.mesh.positions[k as usize])))
            .map(|[p, q, r]| 0.5 * (q - p).cross(&(r - p)).norm())
            .sum();
        assert!((area - (3.0 * 10.0 * 40.0 - 16.0 * std::f64::consts::PI)).abs() < 1.0, "{area}");
        // Edges lie on the cylinder, every joint is used by two pieces in opposite senses.
        for (k, e) in part.edges.iter().enumerate() {
            let uses: Vec<bool> =
                part.faces.iter().flat_map(|f| f.loops.iter().flatten()).filter(|u| u.0 == k).map(|u| u.1).collect();
            match e.border {
                None => assert!(uses.len() == 2 && uses[0] != uses[1]),
                Some(_) => assert_eq!(uses.len(), 1),
            }
            if let PartCurve::Free { space, .. } = &e.curve {
                for i in 0..=40 {
                    let p = space.point(f64::from(i) / 40.0);
                    let off = (p[0].hypot(p[1]) - 20.0).abs();
                    assert!(off < 2e-6, "{off:e} {k} {i}");
                }
            }
        }
        // The outer surface of a sheet: a wider cylinder, edges over the edges.
        let outer = offset(&part, 1.0, 1e-6).expect("offset");
        assert!(outer.vertices.iter().all(|p| (p.xy().norm() - 21.0).abs() < 1e-9));
        assert!(matches!(offset(&part, -21.0, 1e-6), Err(ConeTrimError::Offset { .. })));
        // One outer loop and the hole; the hole cuts the joint in two.
        let outline = part.outline();
        assert_eq!(outline.len(), 2);
        assert_eq!(part.edges.iter().filter(|e| e.border.is_none()).count(), 3);
    }
}
