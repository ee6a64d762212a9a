//! Points in which common edges of faces end: each is on all torses whose panels end there in common edges.

use super::intersection_curve::{common_point, Near, HARDLY};
use super::places::{Common, Ground};
use crate::geom::Vec3;
use crate::patchwork::panel::Coedge;
use crate::search::build::Built;
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};

/// Distance (share of the tolerance) up to which a point is on all its torses.
const ON_ALL: f64 = 1e-7;
/// Torses that have one point in common, whatever they are.
const GENERIC: usize = 3;

/// A place on the border of a panel's region, and the ruling on which the panel ends there.
type OnBorder = (Vec3, f64);

/// Panels of faces, by face and label.
pub(super) struct Torses<'a> {
    of: BTreeMap<(usize, u32), (&'a Torse, Vec<OnBorder>)>,
}

impl<'a> Torses<'a> {
    pub fn of(built: &[&'a Built]) -> Self {
        let mut of = BTreeMap::new();
        for (face, b) in built.iter().enumerate() {
            let (surface, partition) = (&b.patchwork.faces[0].surface, &b.patchwork.partitions[0]);
            for panel in &b.patchwork.panels {
                let Some((trim, torse)) = panel.trim.as_ref().and_then(|t| Some((t, t.form.torse()?))) else {
                    continue;
                };
                let runs = trim.loops.iter().flatten();
                let place = |v: u32, s: f64, run: &Coedge| {
                    let [a, b] = partition.vertices[v as usize];
                    (surface.point(a, b), run.trim.point(s)[0])
                };
                let rulings =
                    runs.flat_map(|r| r.vertices.iter().zip(&r.parameters).map(move |(v, s)| place(*v, *s, r)));
                of.insert((face, trim.label), (torse, rulings.collect()));
            }
        }
        Self { of }
    }

    /// A torse with the ruling near a point of its panel's border.
    pub fn near(&self, of: (usize, u32), x: &Vec3) -> Option<Near<'a>> {
        let (torse, rulings) = self.of.get(&of)?;
        let t = rulings.iter().min_by(|a, b| (a.0 - x).norm_squared().total_cmp(&(b.0 - x).norm_squared()))?.1;
        Some(Near { torse, t })
    }
}

/// A seam between panels of one face.
#[derive(Clone, Debug)]
pub(super) struct InnerSeam {
    /// Vertices of its border.
    pub vertices: Vec<u32>,
    /// Labels on both sides.
    pub labels: [u32; 2],
    /// Where the edge begins and ends in which both panels do, if there is one.
    pub ends: Option<[Vec3; 2]>,
}

/// A point in which edges end.
#[derive(Clone, Debug, Default)]
pub(super) struct Corner {
    /// Vertices of faces that lie there.
    pub at: BTreeSet<(usize, u32)>,
    /// Edges that end there, by their numbers, and whether they begin there.
    pub edges: Vec<(usize, bool)>,
    /// Faces and numbers of the seams inside faces that end there, and whether they begin there.
    pub seams: Vec<(usize, usize, bool)>,
    /// Panels that end there in common edges.
    pub panels: BTreeSet<(usize, u32)>,
    /// Where the edges of these seams end now.
    pub known: Vec<Vec3>,
    /// Where it is.
    pub place: Vec3,
}

/// Corners of common edges.
pub(super) struct Corners {
    pub all: Vec<Corner>,
    of: BTreeMap<(usize, u32), usize>,
}

impl Corners {
    /// The corners of the edges of these numbers, with the seams inside faces that end there.
    pub fn of(all: &[Common], edges: &[usize], seams: &[Vec<InnerSeam>]) -> Self {
        let mut out = Self { all: Vec::new(), of: BTreeMap::new() };
        for &e in edges {
            let Common { faces, chains, turned } = &all[e];
            let ends = |k: usize| [chains[k].vertices[0], chains[k].vertices[chains[k].vertices.len() - 1]];
            let (a, mut b) = (ends(0), ends(1));
            if *turned {
                b.reverse();
            }
            for k in 0..2 {
                let corner = out.joined([(faces[0], a[k]), (faces[1], b[k])]);
                out.all[corner].edges.push((e, k == 0));
                out.all[corner].panels.extend([0, 1].map(|s: usize| (faces[s], chains[s].label)));
            }
        }
        for (face, seams) in seams.iter().enumerate() {
            for (k, InnerSeam { vertices, labels, ends }) in seams.iter().enumerate() {
                for (v, first) in [(vertices[0], true), (vertices[vertices.len() - 1], false)] {
                    let Some(&corner) = out.of.get(&(face, v)) else { continue };
                    out.all[corner].seams.push((face, k, first));
                    if let Some(ends) = ends {
                        out.all[corner].panels.extend(labels.map(|l| (face, l)));
                        out.all[corner].known.push(ends[usize::from(!first)]);
                    }
                }
            }
        }
        out
    }

    /// The corner with both vertices.
    fn joined(&mut self, vertices: [(usize, u32); 2]) -> usize {
        let known: BTreeSet<usize> = vertices.iter().filter_map(|v| self.of.get(v).copied()).collect();
        let one = known.first().copied().unwrap_or_else(|| {
            self.all.push(Corner::default());
            self.all.len() - 1
        });
        for other in known.into_iter().skip(1) {
            let Corner { at, edges, panels, .. } = std::mem::take(&mut self.all[other]);
            self.of.extend(at.iter().map(|v| (*v, one)));
            let into = &mut self.all[one];
            into.at.extend(at);
            into.edges.extend(edges);
            into.panels.extend(panels);
        }
        for v in vertices {
            self.of.insert(v, one);
            self.all[one].at.insert(v);
        }
        one
    }

    /// The corner at a vertex of a face.
    pub fn at(&self, face: usize, vertex: u32) -> Option<&Corner> {
        self.of.get(&(face, vertex)).map(|&k| &self.all[k])
    }

    /// Puts every corner where it belongs; result: edges to do without, where panels have no point in common.
    pub fn placed(&mut self, all: &[Common], grounds: &[Ground], torses: &Torses, tolerance: f64) -> Vec<usize> {
        let mut bad = Vec::new();
        for corner in &mut self.all {
            if corner.edges.is_empty() {
                continue;
            }
            if let Some(worst) = place(corner, all, grounds, torses, tolerance) {
                bad.push(worst);
            }
        }
        bad
    }
}

/// Puts a corner where its panels meet. Where they do not the shortest edge is to be done without.
fn place(corner: &mut Corner, all: &[Common], grounds: &[Ground], torses: &Torses, tolerance: f64) -> Option<usize> {
    let shortest =
        |e: &&(usize, bool), f: &&(usize, bool)| all[e.0].chains[0].length.total_cmp(&all[f.0].chains[0].length);
    let worst = corner.edges.iter().min_by(shortest).map(|e| e.0);
    let places: Vec<Vec3> = corner.at.iter().map(|&(f, v)| grounds[f].places(&[v], 1)[0]).collect();
    let middle = places.iter().sum::<Vec3>() / places.len() as f64;
    let near: Option<Vec<Near>> = corner.panels.iter().map(|p| torses.near(*p, &middle)).collect();
    let Some(mut near) = near else { return worst };
    // Along a single edge the place is free: square to it. Where a panel meets itself its own torse alone says nothing.
    let across = (near.len() < GENERIC).then(|| {
        let side = |e: usize, k: usize| (all[e].faces[k], all[e].chains[k].label);
        let of_two = corner.edges.iter().find(|e| side(e.0, 0) != side(e.0, 1));
        let (e, begins) = *of_two.unwrap_or(&corner.edges[0]);
        let Common { faces, chains, .. } = &all[e];
        let v = &chains[0].vertices;
        let closes = [true, false].iter().all(|begins| corner.edges.contains(&(e, *begins)));
        let pair = match (closes, begins) {
            (true, _) => [v[v.len() - 2], v[1]],
            (_, true) => [v[0], v[1]],
            (_, false) => [v[v.len() - 2], v[v.len() - 1]],
        };
        let p = grounds[faces[0]].places(&pair, 1);
        (p[1] - p[0]).normalize()
    });
    // Where torses hardly cross, or more than three meet, the place is near all of them.
    let length = corner.edges.iter().map(|e| all[e.0].chains[0].length).fold(f64::INFINITY, f64::min);
    let exactly = [(0.0, ON_ALL * tolerance), (HARDLY.0, HARDLY.1 * length)];
    // Where a face closes its seams may end in one point already.
    let is_there = |x: &&Vec3| {
        let mut torses = near.iter().copied();
        let allowed = exactly[1].1;
        corner.known.iter().all(|y| (*x - y).norm() <= allowed)
            && torses.all(|mut n| n.plane(x).is_some_and(|p| p.1.abs() <= allowed))
    };
    let ended = corner.known.iter().find(is_there).copied();
    let mut anew = |(sideways, allowed): (f64, f64)| {
        let (x, left) = common_point(&mut near, &middle, across.as_ref(), sideways)?;
        (left <= allowed && (x - middle).norm() <= 2.0 * tolerance).then_some(x)
    };
    match ended.or_else(|| exactly.into_iter().find_map(&mut anew)) {
        Some(x) => {
            corner.place = x;
            None
        }
        None => worst,
    }
}
