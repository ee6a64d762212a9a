//! The borders of all labels of a face, shared by the panels on both sides: chains of the partition, the edges and lines on
//! which panels end, loops of a label, feet on its torse (certificate specification, section 5).

use super::creases::Creases;
use super::feet::feet_along;
use crate::brep::face::Face;
use crate::fit::panels::chains::{self, BorderStretch, Right};
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::patchwork::partition::Partition;
use crate::spline::curve::Curve;
use crate::torse::convert::ConvertError;
use crate::torse::form::{PanelKind, Torse};
use std::collections::BTreeSet;

/// A torse for a label.
#[derive(Clone, Copy, Debug)]
pub struct Assigned<'a> {
    /// Label of the triangles.
    pub label: u32,
    /// Developable surface near them.
    pub torse: &'a Torse,
    /// What it is, for people.
    pub kind: PanelKind,
}

/// Knobs of [`panels`](super::panels).
#[derive(Clone, Copy, Debug)]
pub struct BoundaryOptions {
    /// Distance allowed between trimming curves and foot points of the border, mm; no default (about a two
    /// hundredth of the job's tolerance).
    pub trim_tolerance: f64,
    /// Distance allowed between trimming curves and their edges in space, mm; no default (about a hundredth of
    /// `trim_tolerance`).
    pub edge_tolerance: f64,
}

/// Why a label cannot become a panel.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// No triangles, or several pieces.
    #[error("it has {outer} outer borders; a panel needs exactly one")]
    Pieces {
        /// Label concerned.
        label: u32,
        /// Number of outer loops.
        outer: usize,
    },
    /// The border touches itself in a vertex.
    #[error("its border touches itself")]
    Pinch {
        /// Label concerned.
        label: u32,
        /// Parameters of the vertex.
        uv: [f64; 2],
    },
    /// No foot point on the torse.
    #[error("its border is too far from its panel")]
    Foot {
        /// Label concerned.
        label: u32,
        /// Parameters of the place.
        uv: [f64; 2],
    },
    /// The torse cannot be written as a patch.
    #[error("{source}")]
    Convert {
        /// Label concerned.
        label: u32,
        /// Why.
        source: ConvertError,
    },
    /// A trimming curve is not a valid spline.
    #[error("{source}")]
    Spline {
        /// Label concerned.
        label: u32,
        /// Why.
        source: crate::spline::SplineError,
    },
}

impl BoundaryError {
    /// Parameters of the place, where it is known.
    pub fn uv(&self) -> Option<[f64; 2]> {
        match self {
            Self::Pinch { uv, .. } | Self::Foot { uv, .. } => Some(*uv),
            Self::Pieces { .. } | Self::Convert { .. } | Self::Spline { .. } => None,
        }
    }

    /// The label that caused the trouble.
    pub fn label(&self) -> u32 {
        match self {
            Self::Pieces { label, .. }
            | Self::Pinch { label, .. }
            | Self::Foot { label, .. }
            | Self::Convert { label, .. }
            | Self::Spline { label, .. } => *label,
        }
    }
}

/// The borders of all labels of a face, shared by the panels on both sides.
pub struct Borders<'a> {
    pub(super) face: &'a Face,
    pub(super) partition: &'a Partition,
    pub(super) points: Vec<Vec3>,
    pub(super) chains: Vec<BorderStretch>,
    pub(super) seams: Vec<u32>,
    /// For every vertex how far (mm) the polyline bends away from a smooth one there.
    pub(super) bend: HashMap<u32, f64>,
    /// Edges that both sides of a chain take as they are.
    pub(super) shared: HashMap<usize, SharedEdge>,
    pub(super) creases: Creases<'a>,
    /// Number of seams.
    pub seam_count: usize,
}

/// One edge in space for both sides of a chain, over [0, 1] along the chain.
#[derive(Clone, Debug)]
pub(super) struct SharedEdge {
    pub(super) edge: Curve<3>,
    pub(super) parameters: Vec<f64>,
}

/// A border between two labels, as seen by those who make seams.
#[derive(Clone, Debug)]
pub struct SeamChain {
    /// Number of the chain, for [`Borders::share`].
    pub chain: usize,
    /// Number of the seam.
    pub seam: u32,
    /// Labels on the left and on the right.
    pub labels: [u32; 2],
    /// Vertices in order.
    pub vertices: Vec<u32>,
    /// Length of the polyline in space, mm.
    pub length: f64,
}

/// A border of a label that is one of the face.
#[derive(Clone, Debug)]
pub(crate) struct TrimChain {
    /// Number of the chain, for [`Borders::share`].
    pub chain: usize,
    /// Label beside it, on its left.
    pub label: u32,
    /// Number of the trimming edge.
    pub edge: u32,
    /// Vertices in order.
    pub vertices: Vec<u32>,
    /// Length of the polyline in space, mm.
    pub length: f64,
}

impl<'a> Borders<'a> {
    /// Traces the borders.
    pub fn new(face: &'a Face, partition: &'a Partition, trim_edge: &dyn Fn(u32, u32) -> u32, first_seam: u32) -> Self {
        Self::cut_at(face, partition, trim_edge, first_seam, &BTreeSet::new())
    }

    /// Traces the borders; chains end in these vertices besides.
    pub(crate) fn cut_at(
        face: &'a Face,
        partition: &'a Partition,
        trim_edge: &dyn Fn(u32, u32) -> u32,
        first_seam: u32,
        cuts: &BTreeSet<u32>,
    ) -> Self {
        let points: Vec<Vec3> = partition.vertices.iter().map(|v| face.surface.point(v[0], v[1])).collect();
        let mut scale = [0.0; 2];
        for v in &partition.vertices {
            let j = face.surface.jet(v[0], v[1]);
            scale[0] += j.du.norm();
            scale[1] += j.dv.norm();
        }
        let creases = Creases::new(face, scale);
        let gain = |a: u32, b: u32, c: u32| creases.gain([a, b, c].map(|v| partition.vertices[v as usize]));
        let chains = chains::chains(partition, &points, scale, trim_edge, &gain, cuts);
        let mut seam_count = 0;
        let mut seams = Vec::new();
        let mut bend = HashMap::default();
        for c in &chains {
            seams.push(first_seam + seam_count as u32);
            if matches!(c.right, Right::Label(_)) {
                seam_count += 1;
            }
            for w in c.vertices.windows(3) {
                // Measured in the surface's tangent plane: edges are straight in (u, v), hence they follow the
                // surface and only their turn inside the surface is a defect.
                let [a, b, d] = [0, 1, 2].map(|k| partition.vertices[w[k] as usize]);
                let j = face.surface.jet(b[0], b[1]);
                let across = |p: [f64; 2]| j.du * (p[0] - a[0]) + j.dv * (p[1] - a[1]);
                let (off, chord) = (across(b), across(d));
                let off = off - chord * (off.dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE));
                bend.insert(w[1], off.norm());
            }
        }
        Self { face, partition, points, chains, seams, bend, shared: HashMap::default(), creases, seam_count }
    }

    /// Direction in which panels end on the face's normals at parameters of the face: the sum of its unit normals on all
    /// sides of creases, not normalised; zero where there is none.
    pub(crate) fn normal(&self, p: [f64; 2]) -> Vec3 {
        self.creases.normal(p)
    }

    /// All borders between two labels.
    pub fn seam_chains(&self) -> Vec<SeamChain> {
        let of = |(k, c): (usize, &BorderStretch)| match c.right {
            Right::Label(right) => Some(SeamChain {
                chain: k,
                seam: self.seams[k],
                labels: [c.left, right],
                vertices: c.vertices.clone(),
                length: c.length,
            }),
            Right::Trim(_) => None,
        };
        self.chains.iter().enumerate().filter_map(of).collect()
    }

    /// All borders of labels that are borders of the face.
    pub(crate) fn trim_chains(&self) -> Vec<TrimChain> {
        let of = |(k, c): (usize, &BorderStretch)| match c.right {
            Right::Trim(edge) if c.length > 0.0 => {
                let vertices = c.vertices.clone();
                Some(TrimChain { chain: k, label: c.left, edge, vertices, length: c.length })
            }
            _ => None,
        };
        self.chains.iter().enumerate().filter_map(of).collect()
    }

    /// Makes both sides of a chain end on one edge in space, given over [0, 1] along the chain with the parameter of
    /// every vertex (0 first, 1 last). Both torses must contain the edge. Their panels end on the normals of the face
    /// along its own boundary, so that edges meet there in one point.
    pub fn share(&mut self, chain: usize, edge: Curve<3>, parameters: Vec<f64>) {
        self.shared.insert(chain, SharedEdge { edge, parameters });
    }

    /// Direction in which panels end at a vertex.
    pub(super) fn lean(&self, v: u32) -> Vec3 {
        self.creases.normal(self.partition.vertices[v as usize])
    }

    /// The same at the fraction `l` of an edge of a border, steady along it.
    pub(super) fn lean_between(&self, a: u32, b: u32, l: f64) -> Vec3 {
        let [p, q] = [a, b].map(|v| self.partition.vertices[v as usize]);
        self.creases.normal_between(p, q, l)
    }

    /// Vertices of a chain that is a point in space; none of others.
    pub(super) fn pole_vertices(&self, chain: usize) -> &[u32] {
        let c = &self.chains[chain];
        if c.length > 0.0 {
            &[]
        } else {
            &c.vertices
        }
    }

    /// Loops of a label as stretches of chains, outer loop first.
    pub(super) fn loops(&self, label: u32) -> Result<Vec<Vec<Stretch>>, BoundaryError> {
        let mut of_edge: HashMap<(u32, u32), Stretch> = HashMap::default();
        for (k, c) in self.chains.iter().enumerate() {
            let forward = c.left == label;
            if !forward && c.right != Right::Label(label) {
                continue;
            }
            for w in c.vertices.windows(2) {
                let e = if forward { (w[0], w[1]) } else { (w[1], w[0]) };
                of_edge.insert(e, Stretch { chain: k, forward });
            }
        }
        let mut seen = HashSet::default();
        let (mut outer, mut holes) = (Vec::new(), Vec::new());
        for cycle in chains::loops(self.partition, label) {
            for &v in &cycle {
                if !seen.insert(v) {
                    return Err(BoundaryError::Pinch { label, uv: self.partition.vertices[v as usize] });
                }
            }
            let n = cycle.len();
            let stretches: Vec<Stretch> =
                (0..n).filter_map(|i| of_edge.get(&(cycle[i], cycle[(i + 1) % n])).copied()).collect();
            // Begin where a chain begins.
            let begin = (0..n)
                .find(|&i| {
                    stretches.get(i).is_some_and(|s| {
                        let c = &self.chains[s.chain].vertices;
                        let first = if s.forward { c[0] } else { c[c.len() - 1] };
                        first == cycle[i]
                    })
                })
                .unwrap_or(0);
            let mut runs: Vec<Stretch> = Vec::new();
            for i in 0..stretches.len() {
                let s = stretches[(begin + i) % stretches.len()];
                if runs.last() != Some(&s) {
                    runs.push(s);
                }
            }
            let area: f64 = (0..n)
                .map(|i| {
                    let (p, q) = (
                        self.partition.vertices[cycle[i] as usize],
                        self.partition.vertices[cycle[(i + 1) % n] as usize],
                    );
                    0.5 * (p[0] * q[1] - p[1] * q[0])
                })
                .sum();
            if area > 0.0 {
                outer.push(runs);
            } else {
                holes.push(runs);
            }
        }
        if outer.len() != 1 {
            return Err(BoundaryError::Pieces { label, outer: outer.len() });
        }
        outer.extend(holes);
        Ok(outer)
    }

    /// Foot of every border vertex, followed along the loops.
    pub(super) fn feet(
        &self,
        label: u32,
        torse: &Torse,
        loops: &[Vec<Stretch>],
    ) -> Result<HashMap<u32, Foot>, BoundaryError> {
        // Vertices of borders without length that follow each other (a pole) are one point.
        let mut same: HashMap<u32, u32> = HashMap::default();
        let points: Vec<&BorderStretch> =
            loops.iter().flatten().map(|s| &self.chains[s.chain]).filter(|c| c.length <= 0.0).collect();
        for _ in 0..points.len() {
            let before = same.clone();
            for c in &points {
                let known = c.vertices.iter().filter_map(|v| same.get(v)).min();
                let one = known.copied().unwrap_or(c.vertices[0]);
                same.extend(c.vertices.iter().map(|&v| (v, one)));
            }
            if same == before {
                break;
            }
        }
        let mut out: HashMap<u32, Foot> = HashMap::default();
        for l in loops {
            let cycle: Vec<u32> = l
                .iter()
                .flat_map(|s| {
                    let mut vertices = s.oriented(&self.chains[s.chain]).0;
                    vertices.pop();
                    vertices
                })
                .collect();
            let one = |v: &u32| same.get(v).copied().unwrap_or(*v);
            let points: Vec<Vec3> = cycle.iter().map(|v| self.points[one(v) as usize]).collect();
            let bad = |k: usize| BoundaryError::Foot { label, uv: self.partition.vertices[one(&cycle[k]) as usize] };
            let feet = feet_along(torse, &points).map_err(bad)?;
            for ((v, x), t) in cycle.iter().zip(&points).zip(feet) {
                let vertex = one(v);
                let known = out.get(&vertex).copied();
                let normal = torse.ruling(t).normal;
                let f = known.unwrap_or(Foot { t, vertex, normal, distance: torse.plane_distance(x, t) });
                out.insert(vertex, f);
                out.insert(*v, f);
            }
        }
        Ok(out)
    }
}

/// A foot point of a border vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) t: f64,
    /// Vertex whose place it belongs to.
    pub(super) vertex: u32,
    pub(super) normal: Vec3,
    pub(super) distance: f64,
}

/// A chain as part of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub(super) chain: usize,
    pub(super) forward: bool,
}

impl Stretch {
    /// Vertices and parameters in the direction of the loop.
    pub(super) fn oriented(&self, chain: &BorderStretch) -> (Vec<u32>, Vec<f64>) {
        if self.forward {
            (chain.vertices.clone(), chain.parameters.clone())
        } else {
            (chain.vertices.iter().rev().copied().collect(), chain.parameters.iter().rev().map(|s| 1.0 - s).collect())
        }
    }
}
