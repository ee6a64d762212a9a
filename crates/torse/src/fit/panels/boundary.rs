//! From a labelled partition and a torse for every label to panels with exported patches and trimming curves.
//!
//! Method: certificate specification, section 5. The border of a label is a polyline of partition edges; its foot
//! points on the torse are the places that the trimming curves pass. Nothing is judged here.

mod creases;
mod feet;
mod path;
pub mod ruled;

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::chains::{self, Chain, Right};
use super::line_intersection::on_normal;
use super::trim;
use crate::brep::face::Face;
use crate::geom::Vec3;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim};
use crate::patchwork::partition::Partition;
use crate::spline::curve::Curve;
use crate::torse::convert::{self, ConvertError, Extent};
use crate::torse::form::{PanelKind, Torse};
use crate::torse::strip::Strip;
use creases::Creases;
use feet::feet_along;
use path::{Aim, Path};

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

/// Knobs of [`panels`].
#[derive(Clone, Copy, Debug)]
pub struct BoundaryOptions {
    /// Distance allowed between trimming curves and foot points of the border, mm; no default (about a two
    /// hundredth of the job's tolerance).
    pub trim_tolerance: f64,
    /// Distance allowed between trimming curves and their edges in space, mm; no default (about a hundredth of
    /// `trim_tolerance`).
    pub edge_tolerance: f64,
}

/// Panels of one face.
#[derive(Clone, Debug)]
pub struct Panels {
    /// One panel per assigned label, in order.
    pub panels: Vec<Panel>,
    /// For each panel: largest distance (mm) between trimming curves and feet of the border.
    pub trim_deviation_estimates: Vec<f64>,
    /// Number of seams between them.
    pub seam_count: usize,
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

/// Builds the panels of a face.
///
/// *Input*: every label of the partition that is to become a panel, with a torse whose domain contains the feet of
/// its region; `trim_edge(a, b)` is the trimming edge's number under a directed border edge; seams are numbered from
/// `first_seam`.
/// *Guarantee*: both panels of a seam have the same vertices in reverse order and mirrored parameters; consecutive
/// runs of a loop share end points bit by bit.
/// *Not guaranteed*: any distance; simple trimming curves (see `certify`).
///
/// # Errors
/// The first label that cannot become a panel, and why.
pub fn panels(
    (face_index, face): (usize, &Face),
    partition: &Partition,
    assigned: &[Assigned],
    trim_edge: &dyn Fn(u32, u32) -> u32,
    first_seam: u32,
    options: &BoundaryOptions,
) -> Result<Panels, BoundaryError> {
    let borders = Borders::new(face, partition, trim_edge, first_seam);
    let built: Result<Vec<_>, _> = assigned.par_iter().map(|a| borders.panel(face_index, a, options)).collect();
    let (mut panels, trim_deviation_estimates): (Vec<Panel>, Vec<f64>) = built?.into_iter().unzip();
    for (k, p) in panels.iter_mut().enumerate() {
        p.strip.name = panel_name(face_index, k);
    }
    Ok(Panels { panels, trim_deviation_estimates, seam_count: borders.seam_count })
}

/// Name of a panel: the face's letter and the panel's number from one, "A-01".
pub fn panel_name(face_index: usize, panel: usize) -> String {
    format!("{}-{:02}", letters(face_index), panel + 1)
}

/// A, B, …, Z, AA, AB, … for 0, 1, ….
fn letters(index: usize) -> String {
    let mut n = index;
    let mut out = Vec::new();
    loop {
        out.push(char::from(b'A' + (n % 26) as u8));
        if n < 26 {
            break;
        }
        n = n / 26 - 1;
    }
    out.iter().rev().collect()
}

/// The borders of all labels of a face, shared by the panels on both sides.
pub struct Borders<'a> {
    face: &'a Face,
    partition: &'a Partition,
    points: Vec<Vec3>,
    chains: Vec<Chain>,
    seams: Vec<u32>,
    /// For every vertex how far (mm) the polyline bends away from a smooth one there.
    bend: HashMap<u32, f64>,
    /// Edges that both sides of a chain take as they are.
    shared: HashMap<usize, SharedEdge>,
    creases: Creases<'a>,
    /// Labels that end together with their neighbours without any shared edge.
    together: HashSet<u32>,
    /// Directions in which panels end at vertices of these labels' borders.
    leans: HashMap<u32, Vec3>,
    /// Number of seams.
    pub seam_count: usize,
}

/// One edge in space for both sides of a chain, over [0, 1] along the chain.
#[derive(Clone, Debug)]
struct SharedEdge {
    edge: Curve<3>,
    parameters: Vec<f64>,
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

impl<'a> Borders<'a> {
    /// Traces the borders.
    pub fn new(face: &'a Face, partition: &'a Partition, trim_edge: &dyn Fn(u32, u32) -> u32, first_seam: u32) -> Self {
        let points: Vec<Vec3> = partition.vertices.iter().map(|v| face.surface.point(v[0], v[1])).collect();
        let mut scale = [0.0; 2];
        for v in &partition.vertices {
            let j = face.surface.jet(v[0], v[1]);
            scale[0] += j.du.norm();
            scale[1] += j.dv.norm();
        }
        let creases = Creases::new(face, scale);
        let gain = |a: u32, b: u32, c: u32| creases.gain([a, b, c].map(|v| partition.vertices[v as usize]));
        let chains = chains::chains(partition, &points, scale, trim_edge, &gain);
        let mut seam_count = 0;
        let mut seams = Vec::new();
        let mut bend = HashMap::new();
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
        Self {
            face,
            partition,
            points,
            chains,
            seams,
            bend,
            shared: HashMap::new(),
            creases,
            together: HashSet::new(),
            leans: HashMap::new(),
            seam_count,
        }
    }

    /// Direction in which panels end on the face's normals at parameters of the face: the sum of its unit normals on all
    /// sides of creases, not normalised; zero where there is none.
    pub fn normal(&self, p: [f64; 2]) -> Vec3 {
        self.creases.normal(p)
    }

    /// All borders between two labels.
    pub fn seam_chains(&self) -> Vec<SeamChain> {
        let of = |(k, c): (usize, &Chain)| match c.right {
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

    /// Makes both sides of a chain end on one edge in space, given over [0, 1] along the chain with the parameter of
    /// every vertex (0 first, 1 last). Both torses must contain the edge. Their panels end on the normals of the face
    /// along its own boundary, so that edges meet there in one point.
    pub fn share(&mut self, chain: usize, edge: Curve<3>, parameters: Vec<f64>) {
        self.shared.insert(chain, SharedEdge { edge, parameters });
    }

    /// Makes the panels of labels end on common lines, not in the feet of their borders: neighbours among them are then
    /// as far apart as their distances from the face differ. The lines run between the normals of both panels, so that
    /// they are hardly longer than the distances. Labels without feet are left out. *Not guaranteed*: that the lines are
    /// within the tolerance where both normals differ much.
    pub fn end_together(&mut self, assigned: &[Assigned]) {
        let found: Vec<(u32, HashMap<u32, Foot>)> = assigned
            .par_iter()
            .filter_map(|a| Some((a.label, self.feet(a.label, a.torse, &self.loops(a.label).ok()?).ok()?)))
            .collect();
        for (label, feet) in found {
            self.together.insert(label);
            for (v, foot) in feet {
                let outward = self.creases.normal(self.partition.vertices[v as usize]);
                let n = if outward.dot(&foot.normal) < 0.0 { -foot.normal } else { foot.normal };
                *self.leans.entry(v).or_insert_with(Vec3::zeros) += n;
            }
        }
    }

    /// Direction in which panels end at a vertex.
    fn lean(&self, v: u32) -> Vec3 {
        self.leans.get(&v).copied().unwrap_or_else(|| self.creases.normal(self.partition.vertices[v as usize]))
    }

    /// The same at the fraction `l` of an edge of a border, steady along it.
    fn lean_between(&self, a: u32, b: u32, l: f64) -> Vec3 {
        let [p, q] = [a, b].map(|v| self.partition.vertices[v as usize]);
        if !self.leans.contains_key(&a) && !self.leans.contains_key(&b) {
            return self.creases.normal_between(p, q, l);
        }
        let [m, n] = [a, b].map(|v| self.lean(v).try_normalize(0.0).unwrap_or_else(Vec3::zeros));
        m * (1.0 - l) + n * l
    }

    /// Builds one panel (named by the caller), with the largest distance (mm) between trimming curves and feet.
    ///
    /// # Errors
    /// As [`panels`].
    #[expect(clippy::too_many_lines, reason = "one walk round a border with its state")]
    pub fn panel(
        &self,
        face_index: usize,
        assigned: &Assigned,
        options: &BoundaryOptions,
    ) -> Result<(Panel, f64), BoundaryError> {
        let label = assigned.label;
        // 1. Loops of runs, outer first.
        let loops = self.loops(label)?;
        // 2. Feet of the border's vertices; a border that is a point in space has one foot.
        let feet = self.feet(label, assigned.torse, &loops)?;
        // 3. The patch around them, and the places in its parameter plane.
        let border = |l: &Vec<Stretch>| {
            let mut points = Vec::new();
            for stretch in l {
                let vertices = stretch.oriented(&self.chains[stretch.chain]).0;
                for v in &vertices[..vertices.len() - 1] {
                    let f = &feet[v];
                    points.push((f.t, self.points[f.vertex as usize] - f.normal * f.distance));
                }
            }
            points
        };
        let extent = Extent { loops: loops.iter().map(border).collect() };
        let patch =
            convert::patch(assigned.torse, &extent).map_err(|source| BoundaryError::Convert { label, source })?;
        let place = |f: &Foot, x: &Vec3| [f.t, convert::parameters(&patch, f.t, x)];
        let mut places: HashMap<u32, [f64; 2]> =
            feet.iter().map(|(&v, f)| (v, place(f, &self.points[f.vertex as usize]))).collect();
        let walled =
            self.together.contains(&label) || loops.iter().flatten().any(|s| self.shared.contains_key(&s.chain));
        let mut walls = HashMap::new();
        if walled {
            let at = |v: u32| self.partition.vertices[v as usize];
            let bad = |v: u32| BoundaryError::Foot { label, uv: at(v) };
            // Vertices of a border that is a point in space (a pole, where the face has no normal) share one place.
            let in_pole: HashSet<u32> =
                loops.iter().flatten().flat_map(|s| self.pole_vertices(s.chain)).copied().collect();
            for (&v, p) in places.iter_mut().filter(|(v, _)| !in_pole.contains(v)) {
                let normal = self.lean(v);
                let x = &self.points[v as usize];
                let (t, x) = on_normal(x, &normal, assigned.torse, p[0]).ok_or_else(|| bad(v))?;
                *p = [t, convert::parameters(&patch, t, &x)];
            }
            walls = places.clone();
            for stretch in loops.iter().flatten() {
                let Some(shared) = self.shared.get(&stretch.chain) else { continue };
                for (&v, &s) in self.chains[stretch.chain].vertices.iter().zip(&shared.parameters) {
                    let x = Vec3::from(shared.edge.point(s));
                    let t = assigned.torse.foot(&x, places[&v][0]).ok_or_else(|| bad(v))?;
                    let place = [t, convert::parameters(&patch, t, &x)];
                    if in_pole.contains(&v) {
                        let pole = feet[&v].vertex;
                        places.iter_mut().filter(|(w, _)| feet[w].vertex == pole).for_each(|(_, p)| *p = place);
                    }
                    places.insert(v, place);
                }
            }
        }
        // 4. Trimming curves.
        let mut worst = 0.0_f64;
        let mut out = Vec::new();
        for l in &loops {
            let mut runs = Vec::new();
            for stretch in l {
                let chain = &self.chains[stretch.chain];
                let (vertices, mut parameters) = stretch.oriented(chain);
                let shared = self.shared.get(&stretch.chain);
                let shared_edge = shared.map(|s| if stretch.forward { s.edge.clone() } else { s.edge.reversed() });
                if let Some(s) = shared {
                    parameters.clone_from(&s.parameters);
                    if !stretch.forward {
                        parameters = s.parameters.iter().rev().map(|s| 1.0 - s).collect();
                    }
                }
                let ends = [vertices[0], vertices[vertices.len() - 1]];
                let aim = match &shared_edge {
                    Some(edge) => Aim::Edge(edge, chain.length),
                    None if walled => Aim::Wall(ends.map(|v| [0, 1].map(|d| places[&v][d] - walls[&v][d]))),
                    None => Aim::Feet,
                };
                let path = Path {
                    aim,
                    borders: self,
                    torse: assigned.torse,
                    patch: &patch,
                    vertices: &vertices,
                    parameters: &parameters,
                    places: &places,
                    options,
                };
                let fitted = if chain.length > 0.0 {
                    trim::trim(&patch, path.waypoints(), |a, b| path.between(a, b))
                } else {
                    trim::point(places[&vertices[0]])
                };
                let fitted = fitted.map_err(|source| BoundaryError::Spline { label, source })?;
                let edge = match shared_edge {
                    Some(edge) => edge,
                    None => trim::edge(&patch, &fitted.curve, options.edge_tolerance)
                        .map_err(|source| BoundaryError::Spline { label, source })?,
                };
                worst = worst.max(fitted.deviation_estimate);
                let border = match chain.right {
                    Right::Trim(edge) => Border::Trim { edge },
                    Right::Label(_) => Border::Seam { seam: self.seams[stretch.chain], forward: stretch.forward },
                };
                runs.push(Coedge { border, vertices, parameters, trim: fitted.curve, edge });
            }
            if walled {
                ends_on_shared_edges(&mut runs, l, &|chain| self.shared.contains_key(&chain));
            }
            out.push(runs);
        }
        let panel = Panel {
            strip: Strip { name: String::new(), kind: assigned.kind, patch },
            trim: Some(PanelTrim {
                face: face_index,
                label,
                form: PanelForm::Torse(assigned.torse.clone()),
                loops: out,
            }),
        };
        Ok((panel, worst))
    }

    /// Vertices of a chain that is a point in space; none of others.
    fn pole_vertices(&self, chain: usize) -> &[u32] {
        let c = &self.chains[chain];
        if c.length > 0.0 {
            &[]
        } else {
            &c.vertices
        }
    }

    /// Loops of a label as stretches of chains, outer loop first.
    fn loops(&self, label: u32) -> Result<Vec<Vec<Stretch>>, BoundaryError> {
        let mut of_edge: HashMap<(u32, u32), Stretch> = HashMap::new();
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
        let mut seen = std::collections::HashSet::new();
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
    fn feet(&self, label: u32, torse: &Torse, loops: &[Vec<Stretch>]) -> Result<HashMap<u32, Foot>, BoundaryError> {
        // Vertices of borders without length that follow each other (a pole) are one point.
        let mut same: HashMap<u32, u32> = HashMap::new();
        let points: Vec<&Chain> =
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
        let mut out: HashMap<u32, Foot> = HashMap::new();
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

/// Ends the edges of runs beside shared edges in the ends of these, bit by bit.
fn ends_on_shared_edges(runs: &mut [Coedge], stretches: &[Stretch], shared: &dyn Fn(usize) -> bool) {
    let n = runs.len();
    for k in 0..n {
        if !shared(stretches[k].chain) {
            continue;
        }
        let ends = [runs[k].edge.control.first().copied(), runs[k].edge.control.last().copied()];
        let (before, after) = ((k + n - 1) % n, (k + 1) % n);
        for (other, end, first) in [(before, ends[0], false), (after, ends[1], true)] {
            let control = &mut runs[other].edge.control;
            let slot = if first { control.first_mut() } else { control.last_mut() };
            if let (Some(slot), Some(end), false) = (slot, end, shared(stretches[other].chain)) {
                *slot = end;
            }
        }
    }
}

/// Whether a patch can be laid around the part of a torse that a region uses: rulings and regression curve leave room
/// for it. A quick look at what [`Borders::panel`] does first, on the border as it is.
pub fn has_patch(face: &Face, partition: &Partition, label: u32, torse: &Torse) -> bool {
    let point = |v: u32| face.surface.point(partition.vertices[v as usize][0], partition.vertices[v as usize][1]);
    let feet = |cycle: Vec<u32>| {
        let points: Vec<Vec3> = cycle.into_iter().map(point).collect();
        let feet = feet_along(torse, &points).ok()?;
        let foot = |(x, t): (Vec3, f64)| (t, x - torse.ruling(t).normal * torse.plane_distance(&x, t));
        Some(points.into_iter().zip(feet).map(foot).collect())
    };
    let Some(loops) = chains::loops(partition, label).into_iter().map(feet).collect() else { return false };
    convert::patch(torse, &Extent { loops }).is_ok()
}

/// A foot point of a border vertex.
#[derive(Clone, Copy, Debug)]
struct Foot {
    t: f64,
    /// Vertex whose place it belongs to.
    vertex: u32,
    normal: Vec3,
    distance: f64,
}

/// A chain as part of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    chain: usize,
    forward: bool,
}

impl Stretch {
    /// Vertices and parameters in the direction of the loop.
    fn oriented(&self, chain: &Chain) -> (Vec<u32>, Vec<f64>) {
        if self.forward {
            (chain.vertices.clone(), chain.parameters.clone())
        } else {
            (chain.vertices.iter().rev().copied().collect(), chain.parameters.iter().rev().map(|s| 1.0 - s).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use crate::torse::form::PrimalTorse;

    /// Parabolic trough z = x²/200 over [0, 100]² as a surface, n × n cells with labels.
    fn trough(n: u32, label: impl Fn(u32, u32) -> u32) -> (Face, Partition) {
        let ku = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let mut p = Vec::new();
        for (x, z) in [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)] {
            for y in [0.0, 100.0] {
                p.push(Vec3::new(x, y, z));
            }
        }
        let face = Face::untrimmed(Surface::new(ku, kv, &p, None).expect("surface"));
        let mut part = Partition::default();
        for j in 0..=n {
            for i in 0..=n {
                part.vertices.push([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)]);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let a = j * (n + 1) + i;
                part.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
                part.labels.extend([label(i, j); 2]);
            }
        }
        (face, part)
    }

    fn cylinder() -> Torse {
        // f = x²/200 as a cubic on one span, slightly beyond the surface.
        let (a, b) = (-10.0, 110.0);
        let f = |x: f64, y: f64, z: f64| (x * y + y * z + z * x) / 600.0;
        let control = vec![[f(a, a, a), 0.0], [f(a, a, b), 0.0], [f(a, b, b), 0.0], [f(b, b, b), 0.0]];
        let profile = Curve::new(3, vec![a, a, a, a, b, b, b, b], control).expect("profile");
        Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0))
    }

    fn side(part: &Partition) -> impl Fn(u32, u32) -> u32 + '_ {
        |a, b| {
            let [p, q] = [a, b].map(|v| part.vertices[v as usize]);
            [p[1].max(q[1]) <= 0.0, p[0].min(q[0]) >= 1.0, p[1].min(q[1]) >= 1.0, true]
                .iter()
                .position(|x| *x)
                .unwrap_or(3) as u32
        }
    }

    #[test]
    fn panels_share_seams_and_close_their_loops() {
        let (face, part) =
            trough(12, |i, j| u32::from(i + j >= 11) + 2 * u32::from((2..4).contains(&i) && (2..4).contains(&j)));
        let torse = cylinder();
        let assigned: Vec<_> =
            [0, 1, 2].map(|label| Assigned { label, torse: &torse, kind: PanelKind::Cylinder }).to_vec();
        let options = BoundaryOptions { trim_tolerance: 0.01, edge_tolerance: 1e-4 };
        let trim_edge = side(&part);
        let out = panels((0, &face), &part, &assigned, &trim_edge, 5, &options).expect("panels");
        assert_eq!(out.panels.iter().map(|p| p.loops().len()).collect::<Vec<_>>(), vec![2, 1, 1]);
        assert_eq!(out.panels[1].strip.name, "A-02");
        let mut seams: HashMap<u32, Vec<(bool, Coedge)>> = HashMap::new();
        for p in &out.panels {
            for l in p.loops() {
                for (k, run) in l.iter().enumerate() {
                    let next = &l[(k + 1) % l.len()];
                    assert_eq!(run.trim.control.last(), next.trim.control.first());
                    assert_eq!(run.edge.control.last(), next.edge.control.first());
                    assert_eq!(run.vertices.last(), next.vertices.first());
                    for (s, v) in run.parameters.iter().zip(&run.vertices) {
                        // The torse is the surface itself: border vertices lie on the edge.
                        let uv = part.vertices[*v as usize];
                        let x = face.surface.point(uv[0], uv[1]);
                        assert!((Vec3::from(run.edge.point(*s)) - x).norm() < 8.0, "staircase smoothed too far");
                    }
                    if let Border::Seam { seam, forward } = run.border {
                        seams.entry(seam).or_default().push((forward, run.clone()));
                    }
                }
            }
        }
        assert_eq!(seams.len(), out.seam_count);
        for (seam, sides) in seams {
            assert!(seam >= 5 && sides.len() == 2 && sides[0].0 != sides[1].0);
            let reversed: Vec<u32> = sides[1].1.vertices.iter().rev().copied().collect();
            assert_eq!(sides[0].1.vertices, reversed);
            let n = sides[0].1.parameters.len();
            for i in 0..n {
                assert!((sides[0].1.parameters[i] + sides[1].1.parameters[n - 1 - i] - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_whole_face_has_four_runs_within_tolerance() {
        let (face, part) = trough(10, |_, _| 0);
        let torse = cylinder();
        let trim_edge = side(&part);
        let options = BoundaryOptions { trim_tolerance: 0.005, edge_tolerance: 1e-4 };
        let assigned = [Assigned { label: 0, torse: &torse, kind: PanelKind::Cylinder }];
        let out = panels((27, &face), &part, &assigned, &trim_edge, 0, &options).expect("a panel");
        let p = &out.panels[0];
        assert_eq!(p.strip.name, "AB-01");
        assert_eq!((p.loops().len(), p.loops()[0].len()), (1, 4));
        assert!(out.trim_deviation_estimates[0] <= 0.005);
        for run in &p.loops()[0] {
            for i in 0..=50 {
                let s = f64::from(i) / 50.0;
                let q = run.trim.point(s);
                let x = Vec3::from(run.edge.point(s));
                assert!((p.strip.patch.point(q[0], q[1]) - x).norm() < 2e-4);
                assert!((x.z - x.x * x.x / 200.0).abs() < 1e-3);
                assert!(q[1] > 0.01 && q[1] < 0.99);
            }
        }
    }

    #[test]
    fn troubles_are_named() {
        let (face, part) = trough(4, |i, j| u32::from(i == j && i % 2 == 0));
        let torse = cylinder();
        let trim_edge = side(&part);
        let options = BoundaryOptions { trim_tolerance: 0.01, edge_tolerance: 1e-4 };
        let one = |label: u32, torse: &Torse| {
            panels((0, &face), &part, &[Assigned { label, torse, kind: PanelKind::Cylinder }], &trim_edge, 0, &options)
                .map(|p| p.panels.len())
        };
        assert_eq!(one(1, &torse), Err(BoundaryError::Pieces { label: 1, outer: 2 }));
        let profile = Curve::new(3, vec![0., 0., 0., 0., 40., 40., 40., 40.], vec![[0.0, 0.0]; 4]).expect("profile");
        let short = PrimalTorse::new(Frame::world(), profile, 0.0);
        assert!(matches!(one(0, &Torse::Primal(short)), Err(BoundaryError::Foot { label: 0, .. })));
    }
}
