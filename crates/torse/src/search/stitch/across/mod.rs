//! Panels that meet along borders of faces: where faces meet at an angle, the panels on both sides intersect near the edge of the
//! model, and both end in that curve; where a face closes, both ends of it are such an edge, with a panel or two beside it.
//!
//! *Method*: borders that lie along each other are cut at the same places; panels on both sides are ended in the curve
//! in which their torses intersect (`intersection_curve`), in points that all of them have in common where several end. The panels that
//! this changes are built anew and proven again. What is refused is left as it was, with what hangs on it, until all of the
//! rest is proven. Nothing is judged here.

mod heights;
mod intersection_curve;
mod likely;
mod places;
mod vertices;

use crate::certify::{known_of, Known, SeamStatus};
use crate::control::Control;
use crate::fit::panels::boundary::TrimChain;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::patchwork::panel::Border;
use crate::search::build::{limits_missed, rebuilt, Built, Rebuilding};
use crate::search::cover::Limits;
use crate::search::joint::Meeting;
use crate::search::stitch::openness::unproven;
use crate::search::stitch::seams::{kept, SharedSeam};
use crate::torse::form::Torse;
use heights::{corner_counts, counts, meetings};
use intersection_curve::{ended_anew, intersection_curve, parts, IntersectionCurve, Model};
use likely::{at_least, Ending};
use places::{common, cut, shares_along, Common, Ground};
use std::collections::{BTreeMap, BTreeSet};
use vertices::{Corner, Corners, InnerSeam, Torses};

/// Rounds without the edges that were refused, at most: most of them cost no proof.
const ROUNDS: usize = 64;
/// Edges farther than this multiple of the tolerance from the model's are not worth a proof.
const REACH: f64 = 1.0;

/// Panels of faces, some of which end in common edges.
#[derive(Default)]
pub(crate) struct Across {
    /// The faces that change.
    pub built: Vec<Option<Built>>,
    /// Length (mm) of the common edges.
    pub length: f64,
    /// All edges at which faces meet, and what it takes for panels to meet there.
    pub edges: Vec<Beside>,
    /// For each face its corners with two others, and what distances of panels should count there for them to meet.
    pub corners: Vec<Vec<(Vec3, f64)>>,
}

/// What it takes for panels to meet along an edge of the model.
pub(crate) struct Beside {
    /// Numbers of the faces.
    pub faces: [usize; 2],
    /// Whether panels do not meet.
    pub open: bool,
    /// Places at which strips on both sides must be equally high; none where faces fold back.
    pub meetings: Option<Vec<Meeting>>,
    /// Places with what distances must count for panels to meet whatever those on the other side are; none where faces turn
    /// little.
    pub counts: Option<Vec<(Vec3, f64)>>,
}

/// The panels of faces, those beside edges at which faces meet at an angle ended in common edges, as far as that can be proven.
/// `tolerance` in mm.
pub(crate) fn met_across(built: &[&Built], tolerance: f64, limits: &Limits, control: &Control) -> Across {
    let nothing = || Across { built: built.iter().map(|_| None).collect(), ..Across::default() };
    if control.stopped() {
        return nothing();
    }
    let mut grounds: Vec<Ground> = built.iter().map(|b| ground(b)).collect();
    cut(&mut grounds, tolerance);
    let all = common(&grounds, tolerance);
    if all.is_empty() {
        return nothing();
    }
    let known: Vec<Known> = parallel::map(built.iter(), |b| known_of(&b.certificate, &b.patchwork));
    let attempt = Attempt { built, grounds, all, known, tolerance, limits, control, torses: Torses::of(built) };
    let mut refused = BTreeSet::new();
    let mut out = nothing();
    for _ in 0..ROUNDS {
        if control.stopped() || refused.len() == attempt.all.len() {
            break;
        }
        match attempt.made(&refused) {
            Ok(found) => {
                out.built = found;
                let met = (0..attempt.all.len()).filter(|e| !refused.contains(e));
                out.length = met.map(|e| attempt.all[e].chains[0].length).sum();
                break;
            }
            Err(bad) => refused.extend(bad),
        }
    }
    if out.length <= 0.0 {
        refused = (0..attempt.all.len()).collect();
    }
    attempt.beside_edges(&refused, &mut out);
    out
}

fn ground(built: &Built) -> Ground<'_> {
    let Built { patchwork, .. } = built;
    Ground { face: &patchwork.faces[0], partition: patchwork.partitions[0].clone(), cuts: BTreeSet::new() }
}

/// Faces whose panels are to meet.
struct Attempt<'a> {
    built: &'a [&'a Built],
    grounds: Vec<Ground<'a>>,
    all: Vec<Common>,
    known: Vec<Known>,
    tolerance: f64,
    limits: &'a Limits,
    control: &'a Control,
    torses: Torses<'a>,
}

/// A common edge: its curve, the edge for both sides, and how far its panels are at least from their faces then.
type Edge = (IntersectionCurve, [SharedSeam; 2], f64);

/// What changes on a face.
#[derive(Default)]
struct Change {
    /// Edges for borders of the face, and seams that end anew.
    edges: Vec<SharedSeam>,
    /// Rulings that panels use besides, by label.
    rulings: BTreeMap<u32, [f64; 2]>,
}

impl Change {
    fn uses(&mut self, label: u32, [from, to]: [f64; 2]) {
        let range = self.rulings.entry(label).or_insert([from, to]);
        *range = [range[0].min(from), range[1].max(to)];
    }
}

impl Attempt<'_> {
    /// The faces with all common edges but those that were refused. Errors are edges to do without.
    fn made(&self, refused: &BTreeSet<usize>) -> Result<Vec<Option<Built>>, Vec<usize>> {
        let wanted: Vec<usize> = (0..self.all.len()).filter(|e| !refused.contains(e)).collect();
        let seams: Vec<Vec<InnerSeam>> = self.seams();
        let mut corners = Corners::of(&self.all, &wanted, &seams);
        self.without_clashes(&corners, &seams)?;
        let bad = corners.placed(&self.all, &self.grounds, &self.torses, self.tolerance);
        if !bad.is_empty() {
            return Err(bad);
        }
        let mut changes: Vec<Change> = self.built.iter().map(|_| Change::default()).collect();
        self.edges(&wanted, &corners, &mut changes)?;
        self.ends(&corners, &seams, &mut changes)?;
        let made: Vec<Option<(Built, BTreeSet<u32>)>> =
            parallel::map(changes.iter().enumerate(), |(face, change)| self.rebuilt(face, change));
        let bad: BTreeSet<usize> = made
            .iter()
            .enumerate()
            .filter_map(|(face, m)| Some((face, m.as_ref()?)))
            .flat_map(|(face, m)| self.beside(face, m, &wanted, &corners))
            .collect();
        if !bad.is_empty() {
            return Err(bad.into_iter().collect());
        }
        let mut found: Vec<Option<Built>> = made.into_iter().map(|m| m.map(|m| m.0)).collect();
        self.name(&wanted, &mut found);
        Ok(found)
    }

    /// Seams inside faces: vertices, labels, and whether both panels have one edge.
    fn seams(&self) -> Vec<Vec<InnerSeam>> {
        let of = |(b, g): (&&Built, &Ground)| {
            let borders = g.borders();
            let ends = |s: &SharedSeam| Some([*s.edge.control.first()?, *s.edge.control.last()?].map(Vec3::from));
            let shared: BTreeMap<usize, Option<[Vec3; 2]>> =
                kept(&b.patchwork, &borders).iter().map(|s| (s.chain, ends(s))).collect();
            let chains = borders.seam_chains().into_iter();
            chains
                .map(|c| InnerSeam {
                    ends: shared.get(&c.chain).copied().flatten(),
                    vertices: c.vertices,
                    labels: c.labels,
                })
                .collect()
        };
        self.built.iter().zip(&self.grounds).map(of).collect()
    }

    /// Where a seam that is not one edge ends at common edges on both of its sides these end apart: the shorter is left.
    fn without_clashes(&self, corners: &Corners, seams: &[Vec<InnerSeam>]) -> Result<(), Vec<usize>> {
        let mut bad = Vec::new();
        for corner in &corners.all {
            for &(face, seam, _) in corner.seams.iter().filter(|s| seams[s.0][s.1].ends.is_none()) {
                let of = |label: u32| {
                    corner.edges.iter().map(|e| e.0).find(|&e| {
                        let Common { faces, chains, .. } = &self.all[e];
                        (0..2).any(|k| faces[k] == face && chains[k].label == label)
                    })
                };
                let [a, b] = seams[face][seam].labels.map(of);
                if let (Some(a), Some(b)) = (a, b) {
                    let length = |e: usize| self.all[e].chains[0].length;
                    bad.push(if length(a) < length(b) { a } else { b });
                }
            }
        }
        if bad.is_empty() {
            Ok(())
        } else {
            Err(bad)
        }
    }

    /// Common edges, for the faces on both sides.
    fn edges(&self, wanted: &[usize], corners: &Corners, changes: &mut [Change]) -> Result<(), Vec<usize>> {
        let found: Vec<Option<Edge>> = parallel::map(wanted.iter(), |&e| self.edge(&self.all[e], corners));
        let bad: Vec<usize> = wanted.iter().zip(&found).filter(|f| f.1.is_none()).map(|f| *f.0).collect();
        if !bad.is_empty() {
            return Err(bad);
        }
        // Of edges that end in one point the worst is to be done without: the others may then end elsewhere.
        let most: BTreeMap<usize, f64> = wanted.iter().zip(found.iter().flatten()).map(|(&e, f)| (e, f.2)).collect();
        let is_worst = |e: &usize| {
            let own = corners.all.iter().filter(|c| c.edges.iter().any(|x| x.0 == *e));
            own.flat_map(|c| &c.edges).all(|x| most.get(&x.0).is_none_or(|m| *m <= most[e]))
        };
        let bad: Vec<usize> = wanted.iter().copied().filter(|e| most[e] > self.tolerance && is_worst(e)).collect();
        if !bad.is_empty() {
            return Err(bad);
        }
        for (&e, (found, sides, _)) in wanted.iter().zip(found.into_iter().flatten()) {
            for (k, side) in sides.into_iter().enumerate() {
                let change = &mut changes[self.all[e].faces[k]];
                change.uses(self.all[e].chains[k].label, found.rulings[k]);
                change.edges.push(side);
            }
        }
        Ok(())
    }

    /// One common edge, for both sides.
    fn edge(&self, of: &Common, corners: &Corners) -> Option<Edge> {
        let [a, b] = &of.chains;
        let edges = a.vertices.len() - 1;
        let parts = parts(edges);
        let points = self.grounds[of.faces[0]].places(&a.vertices, parts);
        let corner = |v: u32| corners.at(of.faces[0], v).map(|c| c.place);
        let ends = [corner(a.vertices[0])?, corner(a.vertices[edges])?];
        let near = |k: usize| self.torses.near((of.faces[k], of.chains[k].label), &points[0]);
        let beside = Model { points: &points, parts, ends, reach: REACH * self.tolerance };
        let found = intersection_curve([near(0)?, near(1)?], &beside)?;
        let mut others = self.grounds[of.faces[1]].places(&b.vertices, 1);
        if of.turned {
            others.reverse();
        }
        let parameter = |share: f64| {
            let i = (share.floor() as usize).min(found.at.len() - 2);
            found.at[i] + (found.at[i + 1] - found.at[i]) * (share - i as f64)
        };
        let mut second: Vec<f64> = shares_along(&points, &others).into_iter().map(parameter).collect();
        if second.windows(2).any(|w| w[0] >= w[1]) {
            return None;
        }
        let mut curve = found.curve.clone();
        if of.turned {
            curve = curve.reversed();
            second = second.iter().rev().map(|s| 1.0 - s).collect();
        }
        let first = found.at.iter().copied().step_by(parts).collect();
        let side = |chain: &TrimChain, edge, parameters| SharedSeam {
            chain: chain.chain,
            labels: [chain.label; 2],
            edge,
            parameters,
        };
        let sides = [side(a, found.curve.clone(), first), side(b, curve, second)];
        let mut most = 0.0;
        for (k, SharedSeam { edge, parameters, .. }) in sides.iter().enumerate() {
            let TrimChain { vertices, label, .. } = &of.chains[k];
            let ending = Ending { vertices, label: *label, curve: edge, parameters };
            let ground = &self.grounds[of.faces[k]];
            let first = self.torses.near((of.faces[k], *label), &ground.places(&vertices[..1], 1)[0])?;
            most = f64::max(most, at_least(ground, &ending, &first, self.tolerance));
        }
        Some((found, sides, most))
    }

    /// Seams inside faces that end in corners of common edges, ended there.
    fn ends(&self, corners: &Corners, seams: &[Vec<InnerSeam>], changes: &mut [Change]) -> Result<(), Vec<usize>> {
        let touched: BTreeSet<usize> = corners
            .all
            .iter()
            .flat_map(|c| c.seams.iter().filter(|s| seams[s.0][s.1].ends.is_some()).map(|s| s.0))
            .collect();
        let mut bad = Vec::new();
        for face in touched {
            let borders = self.grounds[face].borders();
            for mut seam in kept(&self.built[face].patchwork, &borders) {
                let chains = borders.seam_chains();
                let Some(chain) = chains.iter().find(|c| c.chain == seam.chain) else { continue };
                let last = chain.vertices.len() - 1;
                let at = [chain.vertices[0], chain.vertices[last]].map(|v| corners.at(face, v));
                if at.iter().all(Option::is_none) {
                    continue;
                }
                let x = seam.edge.control[0].into();
                let near = seam.labels.map(|l| self.torses.near((face, l), &x));
                let [Some(p), Some(q)] = near else { continue };
                match ended_anew(&seam.edge, &seam.parameters, at.map(|c| c.map(|c| c.place)), [p, q]) {
                    Some((edge, parameters)) => {
                        (seam.edge, seam.parameters) = (edge, parameters);
                        for (label, near) in seam.labels.iter().zip([p, q]) {
                            changes[face].uses(*label, near.torse.domain().into());
                        }
                        changes[face].edges.push(seam);
                    }
                    None => bad.extend(at.iter().flatten().flat_map(|c| c.edges.iter().map(|e| e.0))),
                }
            }
        }
        if bad.is_empty() {
            Ok(())
        } else {
            Err(bad)
        }
    }

    /// A face with its changes, and the labels that are refused: not proven, or worse than they were. `None` without changes.
    fn rebuilt(&self, face: usize, change: &Change) -> Option<(Built, BTreeSet<u32>)> {
        if change.edges.is_empty() {
            return None;
        }
        let (old, ground) = (self.built[face], &self.grounds[face]);
        let new: BTreeSet<u32> = (old.patchwork.partitions[0].vertices.len() as u32..)
            .take(ground.partition.vertices.len() - old.patchwork.partitions[0].vertices.len())
            .collect();
        let mut torses: BTreeMap<u32, Torse> = BTreeMap::new();
        let borders = ground.borders();
        let split = borders
            .trim_chains()
            .into_iter()
            .filter(|c| c.vertices.iter().any(|v| new.contains(v)) || change.edges.iter().any(|e| e.chain == c.chain));
        let labels: BTreeSet<u32> = split.map(|c| c.label).chain(change.rulings.keys().copied()).collect();
        for panel in &old.patchwork.panels {
            let Some(trim) = panel.trim.as_ref().filter(|t| labels.contains(&t.label)) else { continue };
            let rulings = change.rulings.get(&trim.label);
            match trim.form.torse().and_then(|t| continued(t, rulings)) {
                Some(torse) => drop(torses.insert(trim.label, torse)),
                // The other side of its edges must hear of it.
                None => return Some((old.clone(), BTreeSet::from([trim.label]))),
            }
        }
        let mut edges = kept(&old.patchwork, &borders);
        edges.retain(|e| change.edges.iter().all(|c| c.chain != e.chain));
        edges.extend(change.edges.iter().cloned());
        let asked = Rebuilding {
            partition: &ground.partition,
            cuts: &ground.cuts,
            edges: &edges,
            torses: &torses,
            known: &self.known[face],
        };
        let (next, mut refused) = rebuilt(old, &asked, self.control);
        if refused.is_empty() {
            refused.extend(self.worse(old, &next, &labels));
        }
        Some((next, refused))
    }

    /// Labels for which something is worse than it was.
    fn worse(&self, old: &Built, next: &Built, changed: &BTreeSet<u32>) -> BTreeSet<u32> {
        let exact = |b: &Built| b.certificate.seams.iter().map(|s| s.status).collect::<Vec<_>>();
        let rank = |s: &SeamStatus| match s {
            SeamStatus::Exact => 0,
            SeamStatus::Tolerance => 1,
            SeamStatus::Open => 2,
        };
        let mut out = BTreeSet::new();
        for (k, (was, is)) in exact(old).iter().zip(&exact(next)).enumerate() {
            if rank(is) > rank(was) {
                out.extend(next.certificate.seams[k].panels.iter().filter_map(|&p| next.patchwork.panels[p].label()));
            }
        }
        if next.certificate.seams.len() < old.certificate.seams.len() {
            out.extend(changed);
        }
        let missed = |b: &Built| limits_missed(&b.patchwork, &b.certificate, &b.patterns, self.limits).panels;
        let before = missed(old);
        let label = |k: &usize| next.patchwork.panels[*k].label();
        out.extend(missed(next).iter().filter(|k| !before.contains(k)).filter_map(label));
        let flat = unproven(next, self.control);
        if !flat.is_empty() {
            let before = unproven(old, self.control);
            out.extend(flat.into_iter().filter(|l| !before.contains(l)));
        }
        out
    }

    /// Edges beside panels that are refused, the nearest to where these are too far from their face if it is known; else edges that
    /// their seams depend on.
    fn beside(&self, face: usize, made: &(Built, BTreeSet<u32>), wanted: &[usize], corners: &Corners) -> Vec<usize> {
        let (built, labels) = made;
        let sides = |e: &usize| {
            let Common { faces, chains, .. } = &self.all[*e];
            faces.iter().zip(chains).filter(|(f, _)| **f == face).map(|(_, c)| c)
        };
        let mut out = Vec::new();
        for label in labels {
            let own = wanted.iter().filter(|e| sides(e).any(|c| c.label == *label));
            let k = built.patchwork.panels.iter().position(|p| p.label() == Some(*label));
            let place = k.and_then(|k| built.certificate.panels.get(k)?.too_far).map(|(uv, _)| {
                let surface = &built.patchwork.faces[0].surface;
                surface.point(uv[0], uv[1])
            });
            let Some(x) = place else {
                out.extend(own);
                continue;
            };
            let away = |e: &usize| {
                let points = sides(e).flat_map(|c| self.grounds[face].places(&c.vertices, 1));
                points.map(|p| (p - x).norm_squared()).fold(f64::INFINITY, f64::min)
            };
            out.extend(own.min_by(|a, b| away(a).total_cmp(&away(b))));
        }
        if out.is_empty() {
            let ends = corners.all.iter().filter(|c| labels.iter().any(|l| c.panels.contains(&(face, *l))));
            out.extend(ends.flat_map(|c| &c.edges).map(|e| e.0));
        }
        if out.is_empty() && !labels.is_empty() {
            out.extend(wanted.iter().filter(|e| sides(e).next().is_some()));
        }
        out
    }

    /// What it takes for panels to meet; `open` are the edges at which they do not.
    fn beside_edges(&self, open: &BTreeSet<usize>, out: &mut Across) {
        if open.is_empty() {
            return;
        }
        let beside = |(e, of): (usize, &Common)| {
            // Where a face closes it does not turn.
            let turns = of.faces[0] != of.faces[1];
            Beside {
                faces: of.faces,
                open: open.contains(&e),
                meetings: if turns { meetings(e, of, &self.grounds) } else { None },
                counts: if turns { counts(of, &self.grounds, &self.torses) } else { None },
            }
        };
        out.edges = parallel::map(self.all.iter().enumerate(), beside);
        let edges: Vec<usize> = (0..self.all.len()).collect();
        let corners = Corners::of(&self.all, &edges, &self.seams());
        let of = |face: usize| corners.all.iter().filter_map(|c| self.corner_counts(c, face)).collect();
        out.corners = (0..self.built.len()).map(of).collect();
    }

    /// Where a corner of three faces is in one of them, and what distances count there.
    fn corner_counts(&self, corner: &Corner, face: usize) -> Option<(Vec3, f64)> {
        let here = corner.at.iter().find(|at| at.0 == face)?;
        let normals: BTreeMap<usize, Vec3> =
            corner.at.iter().map(|&(f, v)| (f, self.grounds[f].normals(&[v], 1)[0])).collect();
        let normals: Vec<Vec3> = normals.into_values().collect();
        Some((self.grounds[face].places(&[here.1], 1)[0], corner_counts(normals.try_into().ok()?)?))
    }

    /// Tells both sides of each edge of the other.
    fn name(&self, wanted: &[usize], found: &mut [Option<Built>]) {
        for (joint, &e) in (0u32..).zip(wanted) {
            let Common { faces, chains, turned } = &self.all[e];
            for k in 0..2 {
                let Some(built) = &mut found[faces[k]] else { continue };
                let runs = built.patchwork.panels.iter_mut().flat_map(|p| p.loops_mut().iter_mut().flatten());
                for run in runs.filter(|r| r.vertices == chains[k].vertices) {
                    let edge = chains[k].edge;
                    run.border = Border::Joint { joint, edge, first: k == 0, forward: k == 0 || !turned };
                }
            }
        }
    }
}

/// The torse as far as it is used: as it is, or continued where that is beyond its ends.
fn continued(torse: &Torse, rulings: Option<&[f64; 2]>) -> Option<Torse> {
    let (t0, t1) = torse.domain();
    let [a, b] = rulings.copied().unwrap_or([t0, t1]);
    if a >= t0 && b <= t1 {
        return Some(torse.clone());
    }
    let hair = HAIR * (t1 - t0);
    torse.restricted(if a < t0 { a - hair } else { t0 }, if b > t1 { b + hair } else { t1 })
}

/// Share of its domain by which a torse that is continued goes on beyond the last ruling that is used.
const HAIR: f64 = 1e-3;
