//! Trimmed cone splines: pieces of cones, cylinders and planes with holes and slanting edges, sharing their joints
//! \[LP98\].

use super::chart::Blank;
use super::spline::ConeSpline;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::spline::curve::Curve;

/// A boundary curve of one piece, or a joint between two.
#[derive(Clone, Debug)]
pub struct PartEdge {
    /// First vertex.
    pub start: usize,
    /// Last vertex.
    pub end: usize,
    /// What the curve is.
    pub curve: PartCurve,
    /// Number of the boundary's edge that it lies on; `None` for joints.
    pub border: Option<u32>,
}

/// The curve of an edge.
#[derive(Clone, Debug)]
pub enum PartCurve {
    /// The straight stretch of a ruling between the vertices.
    Ruling,
    /// Any other.
    Free {
        /// Piece on whose blank it lies.
        face: usize,
        /// The curve in the parameter plane of that blank's patch, domain [0, 1].
        trim: Curve<2>,
        /// The same curve in space, mm, same parameter.
        space: Curve<3>,
    },
}

/// A trimmed piece of one segment.
#[derive(Clone, Debug)]
pub struct PartFace {
    /// Number of the segment in the chain.
    pub segment: usize,
    /// What the piece is cut from.
    pub blank: Blank,
    /// Loops of edges with their sense, outer first: counter-clockwise seen from the side of the normals.
    pub loops: Vec<Vec<(usize, bool)>>,
    /// Triangles for pictures.
    pub mesh: Mesh,
}

/// A trimmed chain.
#[derive(Clone, Debug, Default)]
pub struct ConePart {
    /// Corners and ends of edges: segment, and coordinates (f, r) there, mm.
    pub places: Vec<(usize, [f64; 2])>,
    /// The same in space, mm.
    pub vertices: Vec<Vec3>,
    /// Edges.
    pub edges: Vec<PartEdge>,
    /// Pieces in the order of their segments; a segment may give several or none.
    pub faces: Vec<PartFace>,
    /// Largest distance measured (mm) between the outline given, carried to the chain, and the edges.
    pub outline_estimate: f64,
}

/// A chain with a name, whole or trimmed.
#[derive(Clone, Debug)]
pub struct ConeBody {
    /// Name of the face or panel that it stands for.
    pub name: String,
    /// The chain between its own edges.
    pub spline: ConeSpline,
    /// What is cut from it; `None` where the edges of the chain are the outline.
    pub part: Option<ConePart>,
}

impl ConePart {
    /// How often each edge is used, and in which sense last.
    fn uses(&self) -> Vec<(usize, bool)> {
        let mut out = vec![(0, true); self.edges.len()];
        for &(e, forward) in self.faces.iter().flat_map(|f| f.loops.iter().flatten()) {
            out[e] = (out[e].0 + 1, forward);
        }
        out
    }

    /// The outline: closed loops of the edges that only one piece uses, each with its sense, the part on the left seen
    /// from the side of the normals.
    pub fn outline(&self) -> Vec<Vec<(usize, bool)>> {
        let ends = |&(e, forward): &(usize, bool)| {
            let e = &self.edges[e];
            if forward {
                (e.start, e.end)
            } else {
                (e.end, e.start)
            }
        };
        let uses = self.uses();
        let mut left: Vec<(usize, bool)> =
            uses.iter().enumerate().filter(|(_, u)| u.0 == 1).map(|(e, u)| (e, u.1)).collect();
        left.reverse();
        let mut out = Vec::new();
        while let Some(first) = left.pop() {
            let (begin, mut at) = ends(&first);
            let mut cycle = vec![first];
            while at != begin {
                let Some(k) = left.iter().rposition(|u| ends(u).0 == at) else { break };
                let next = left.remove(k);
                at = ends(&next).1;
                cycle.push(next);
            }
            out.push(cycle);
        }
        out
    }

    /// A loop of edges as a closed polyline, for pictures.
    pub fn polyline(&self, cycle: &[(usize, bool)]) -> Vec<Vec3> {
        const PARTS: usize = 40;
        let mut out = Vec::new();
        for &(k, forward) in cycle {
            let e = &self.edges[k];
            match &e.curve {
                PartCurve::Ruling => out.push(self.vertices[if forward { e.start } else { e.end }]),
                PartCurve::Free { space, .. } => out.extend((0..PARTS).map(|i| {
                    let s = i as f64 / PARTS as f64;
                    Vec3::from(space.point(if forward { s } else { 1.0 - s }))
                })),
            }
        }
        out.extend(out.first().copied());
        out
    }

    /// Edges between two pieces.
    pub fn joints(&self) -> Vec<usize> {
        self.uses().iter().enumerate().filter(|(_, u)| u.0 > 1).map(|(e, _)| e).collect()
    }

    /// The pieces of the segments `from` up to `to`, not included; joints at both ends become edges.
    pub fn between(&self, from: usize, to: usize) -> Self {
        let faces = self.faces.iter().filter(|f| f.segment >= from && f.segment < to).cloned().collect::<Vec<_>>();
        let mut out = Self { faces, ..self.clone() };
        // Curves name their piece by its number.
        let gone = self.faces.iter().take_while(|f| f.segment < from).count();
        for e in &mut out.edges {
            if let PartCurve::Free { face, .. } = &mut e.curve {
                *face = face.saturating_sub(gone);
            }
        }
        out
    }
}
