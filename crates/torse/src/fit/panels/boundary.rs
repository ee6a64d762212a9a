//! From a labelled partition and a torse for every label to panels with exported patches and trimming curves.
//!
//! Method: certificate specification, section 5. The border of a label is a polyline of partition edges; its foot
//! points on the torse are the places that the trimming curves pass. Nothing is judged here.

mod borders;
mod creases;
mod feet;
mod path;
pub(crate) mod ruled;

use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;

use super::chains::{self, Right};
use super::line_intersection::on_leaning;
use super::trim;
use crate::brep::face::Face;
use crate::geom::Vec3;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim};
use crate::patchwork::partition::Partition;
use crate::torse::convert::{self, Extent};
use crate::torse::form::Torse;
use crate::torse::strip::Strip;
pub use borders::{Assigned, Borders, BoundaryOptions};
pub(crate) use borders::{BoundaryError, SeamChain, TrimChain};
use borders::{Foot, Stretch};
use feet::feet_along;
use path::{Aim, Path};

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
    let built: Result<Vec<_>, _> =
        parallel::map(assigned.iter(), |a| borders.panel(face_index, a, options)).into_iter().collect();
    let (mut panels, trim_deviation_estimates): (Vec<Panel>, Vec<f64>) = built?.into_iter().unzip();
    for (k, p) in panels.iter_mut().enumerate() {
        p.strip.name = panel_name(face_index, k);
    }
    Ok(Panels { panels, trim_deviation_estimates, seam_count: borders.seam_count })
}

/// Name of a panel: the face's letter and the panel's number from one, "A-01".
pub(crate) fn panel_name(face_index: usize, panel: usize) -> String {
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

impl Borders<'_> {
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
                // Where panels end beyond their face, or before it, patches reach there.
                let beyond = self.shared.get(&stretch.chain);
                if let Some(e) = beyond.filter(|_| matches!(self.chains[stretch.chain].right, Right::Trim(_))) {
                    let ends = vertices.iter().zip(&e.parameters).filter_map(|(v, &s)| {
                        let x = Vec3::from(e.edge.point(s));
                        Some((assigned.torse.foot(&x, feet[v].t)?, x))
                    });
                    points.extend(ends);
                    continue;
                }
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
        let on_normals = loops.iter().flatten().any(|s| self.shared.contains_key(&s.chain));
        let mut normal_places = HashMap::default();
        if on_normals {
            let at = |v: u32| self.partition.vertices[v as usize];
            let bad = |v: u32| BoundaryError::Foot { label, uv: at(v) };
            // Vertices of a border that is a point in space (a pole, where the face has no normal) share one place.
            let in_pole: HashSet<u32> =
                loops.iter().flatten().flat_map(|s| self.pole_vertices(s.chain)).copied().collect();
            for (&v, p) in places.iter_mut().filter(|(v, _)| !in_pole.contains(v)) {
                let normal = self.lean(v);
                let x = &self.points[v as usize];
                let (t, x) = on_leaning(x, &normal, assigned.torse, p[0]).ok_or_else(|| bad(v))?;
                *p = [t, convert::parameters(&patch, t, &x)];
            }
            normal_places = places.clone();
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
                    None if on_normals => {
                        Aim::Normals(ends.map(|v| [0, 1].map(|d| places[&v][d] - normal_places[&v][d])))
                    }
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
            if on_normals {
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
            outline: Vec::new(),
        };
        Ok((panel, worst))
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
pub(crate) fn has_patch(face: &Face, partition: &Partition, label: u32, torse: &Torse) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use crate::torse::form::PanelKind;
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
        let mut seams: HashMap<u32, Vec<(bool, Coedge)>> = HashMap::default();
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
