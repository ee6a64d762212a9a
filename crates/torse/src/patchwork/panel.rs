//! Panels: pieces of torses with boundaries, as they are exported; and the patchwork that they make up.

use super::foot_map::FootMap;
use super::partition::Partition;
use crate::brep::face::Face;
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
use crate::torse::strip::Strip;

/// What lies beyond a stretch of a panel's boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Border {
    /// Another panel of the same face; `seam` counts the seams of the patchwork. The neighbour's run has the same
    /// number, the same partition vertices in reverse order and the opposite `forward`.
    Seam {
        /// Number of the seam.
        seam: u32,
        /// Whether this panel's run goes along the seam's own direction.
        forward: bool,
    },
    /// The boundary of the face: number of the file's edge within the face.
    Trim {
        /// Edge number, see `TrimLoop::edge`.
        edge: u32,
    },
    /// The boundary of the face where another panel ends in the same edge in space: of a face that it meets at an angle, or of
    /// its own where that closes, which may be the other end of the panel itself.
    Joint {
        /// Number of the joint among those of the patchwork.
        joint: u32,
        /// Edge number of this face, see `TrimLoop::edge`.
        edge: u32,
        /// Whether this is the first of both sides.
        first: bool,
        /// Whether this panel's run goes along the first one's; always for the first.
        forward: bool,
    },
}

impl Border {
    /// Whether both are the two sides of one seam or joint, and if so whether they run against each other.
    pub fn across(&self, other: &Self) -> Option<bool> {
        match (*self, *other) {
            (Self::Seam { seam, forward }, Self::Seam { seam: s, forward: f }) => {
                (seam == s && forward != f).then_some(true)
            }
            (Self::Joint { joint, first, forward, .. }, Self::Joint { joint: j, first: other, forward: f, .. }) => {
                (joint == j && first != other).then_some(forward != f)
            }
            _ => None,
        }
    }

    /// Whether a panel is beyond that ends in the same edge, or should: not the border of a face alone.
    pub fn has_neighbour(&self) -> bool {
        !matches!(self, Self::Trim { .. })
    }
}

/// A smooth stretch of a panel's boundary, with its direction.
#[derive(Clone, Debug)]
pub struct Coedge {
    /// What lies beyond.
    pub border: Border,
    /// Vertices of the partition along the run, in the panel's direction (material on the left in the (u, v) plane); none
    /// where the panel covers no face.
    pub vertices: Vec<u32>,
    /// Parameter `s` of each vertex on `trim` and `edge`: increasing, from 0 to 1.
    pub parameters: Vec<f64>,
    /// The trimming curve `(t, r)(s)` in the parameter plane of the exported patch, domain [0, 1]: cubic and at least C¹, of
    /// panels that cover no face a polyline; its end points are bitwise those of the neighbouring runs of the loop.
    pub trim: Curve<2>,
    /// The same curve in space, mm, same parameter.
    pub edge: Curve<3>,
}

impl Coedge {
    /// Whether the run is a point (a pole of the input); files have no edge for it.
    pub fn is_point(&self) -> bool {
        let c = &self.trim.control;
        c.iter().all(|p| p == &c[0])
    }
}

/// What a panel is, for the comparison with its face.
#[derive(Clone, Debug)]
pub enum PanelForm {
    /// A developable: the exact surface, equal to the panel's patch up to rounding.
    Torse(Torse),
    /// A ruled surface that need not be developable: where it lies on the face.
    Ruled(FootMap),
}

impl PanelForm {
    /// The exact developable surface, of a panel that has one.
    pub fn torse(&self) -> Option<&Torse> {
        match self {
            Self::Torse(torse) => Some(torse),
            Self::Ruled(_) => None,
        }
    }
}

/// What a panel covers of a face, and where it ends.
#[derive(Clone, Debug)]
pub struct PanelTrim {
    /// Index of the face in the patchwork.
    pub face: usize,
    /// Label of the panel's triangles in the face's partition.
    pub label: u32,
    /// How the panel is compared with the face.
    pub form: PanelForm,
    /// Closed boundary loops, outer first; the coedges of a loop follow each other.
    pub loops: Vec<Vec<Coedge>>,
}

/// One panel: a developable surface, as the ruled patch that is written to files, and its boundary.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Name, unique within the patchwork ("A-03"), kind and patch: u = t (the torse's parameter), v = r ∈ [0, 1] along the
    /// ruling, degree 1 in v; equal to the torse up to rounding.
    pub strip: Strip,
    /// What it covers of a face.
    pub trim: Option<PanelTrim>,
    /// Closed boundary loops of a panel that covers no face, outer first; a panel with neither ends where its patch does, at
    /// two rails and two rulings.
    pub outline: Vec<Vec<Coedge>>,
}

impl From<Strip> for Panel {
    /// The whole strip.
    fn from(strip: Strip) -> Self {
        Self { strip, trim: None, outline: Vec::new() }
    }
}

impl Panel {
    /// Index of the face that it covers a part of.
    pub fn face(&self) -> Option<usize> {
        self.trim.as_ref().map(|t| t.face)
    }

    /// Label of its triangles in the face's partition.
    pub fn label(&self) -> Option<u32> {
        self.trim.as_ref().map(|t| t.label)
    }

    /// Closed boundary loops, outer first; none of a panel that ends where its patch does.
    pub fn loops(&self) -> &[Vec<Coedge>] {
        self.trim.as_ref().map_or(&self.outline, |t| &t.loops)
    }

    /// As [`Panel::loops`], to be changed.
    pub fn loops_mut(&mut self) -> &mut [Vec<Coedge>] {
        self.trim.as_mut().map_or(&mut self.outline, |t| &mut t.loops)
    }

    /// Whether the outer loop runs clockwise in the parameter plane (t, r) of the patch: then the patch's normal
    /// R_t × R_r is opposite to that of the face, about which the loop runs counter-clockwise.
    pub fn mirrored(&self) -> bool {
        // Chords of the trimming curves; cubic pieces deviate too little from four chords to turn the sign.
        const CHORDS: usize = 4;
        let mut twice_area = 0.0;
        for run in self.loops().first().into_iter().flatten() {
            for w in run.trim.knots.breaks().windows(2) {
                let at = |k: usize| run.trim.point(w[0] + (w[1] - w[0]) * k as f64 / CHORDS as f64);
                for k in 0..CHORDS {
                    let (a, b) = (at(k), at(k + 1));
                    twice_area += a[0] * b[1] - a[1] * b[0];
                }
            }
        }
        twice_area < 0.0
    }
}

/// The panels of a whole model, with what they approximate.
#[derive(Clone, Debug, Default)]
pub struct Patchwork {
    /// Input faces.
    pub faces: Vec<Face>,
    /// For each face: its parameter region cut into triangles, each labelled with its panel.
    pub partitions: Vec<Partition>,
    /// All panels.
    pub panels: Vec<Panel>,
    /// Number of seams.
    pub seam_count: usize,
    /// Number of joints: between faces, and where a face closes.
    pub joint_count: usize,
}

impl Patchwork {
    /// Panels that cover no faces and end where their patches do.
    pub fn of_strips(strips: Vec<Strip>) -> Self {
        Self { panels: strips.into_iter().map(Panel::from).collect(), ..Self::default() }
    }

    /// Adds the faces, panels and seams of another patchwork.
    pub fn append(&mut self, other: Self) {
        let (faces, seams) = (self.faces.len(), self.seam_count as u32);
        let joints = self.joint_count as u32;
        self.faces.extend(other.faces);
        self.partitions.extend(other.partitions);
        self.panels.extend(other.panels.into_iter().map(|mut p: Panel| {
            p.trim.iter_mut().for_each(|t| t.face += faces);
            for run in p.loops_mut().iter_mut().flatten() {
                match &mut run.border {
                    Border::Seam { seam, .. } => *seam += seams,
                    Border::Joint { joint, .. } => *joint += joints,
                    Border::Trim { .. } => {}
                }
            }
            p
        }));
        self.seam_count += other.seam_count;
        self.joint_count += other.joint_count;
    }

    /// The face that a panel covers a part of.
    pub fn face_of(&self, panel: &Panel) -> Option<&Face> {
        self.faces.get(panel.face()?)
    }

    /// The triangles of that face.
    pub fn partition_of(&self, panel: &Panel) -> Option<&Partition> {
        self.partitions.get(panel.face()?)
    }
}
