//! Strips that meet: a covered face is laid anew until neighbours end on common edges, as far as that can be certified.
//!
//! Order of the attempts: all strips in one program; strips as they are, with their borders where they intersect; strips
//! between seam curves, also between other levels; strips that agree about the seams that are still open, then about all;
//! the same from covers that leave room. The best panels are kept, and those of the cover if nothing better can be proven.

use super::consensus::{agree, Agreement};
use super::intersection::{pair, Intersections};
use super::relevel;
use super::seams::{self, Meeting, SharedSeam};
use crate::brep::face::Face;
use crate::certify::flat::flat;
use crate::certify::{Known, PanelCertificate, SeamCertificate, SeamStatus};
use crate::control::Control;
use crate::fit::near::samples::Fit;
use crate::fit::panels::boundary::Borders;
use crate::patchwork::panel::Panel;
use crate::search::build::{borders, build, build_on, limits_missed, smooth_borders, too_large, Built, Joined, Kept};
use crate::search::cover::{cover, CoverOptions, State};
use crate::search::joint::{self, Further};
use crate::torse::form::{PanelKind, Torse};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Rounds of laying strips that meet, without those that were refused.
const MEETINGS: usize = 4;
/// Times that the program over all strips is solved again with places where panels were too far away.
const REFINEMENTS: usize = 2;
/// Places where less than the reciprocal of this share of the tolerance is left are lost to trimming curves, not to distance.
const MOST_COUNTED: f64 = 1.5;
/// Places that count more than this have lost part of the tolerance to ends of panels.
const ENDS: f64 = 1.02;
/// Rounds of moving borders to intersections, without those that were refused.
const INTERSECTIONS: usize = 8;
/// Weights of gaps against distances in turn, each with the gap that needs no more, as a share of the tolerance: one edge,
/// then seams that are not apart.
const WEIGHTS: [(f64, f64); 2] = [(50.0, 0.0), (7.0, APART)];
/// Times that bands between seams get other levels.
const LEVELLINGS: usize = 3;
/// Times that strips agree, each with firmer ones in place of those that were ill shaped.
const AGREEMENTS: usize = 3;
/// Factor on the firmness of strips from one time to the next.
const FIRMER: f64 = 10.0;
/// Seams with a larger gap, as a share of the tolerance, do not meet.
const APART: f64 = 0.25;
/// Panels that are refused and stay within this multiple of the tolerance are too far away, not ill shaped.
const NEAR: f64 = 1.1;
/// Shares of the tolerance of covers that leave room for joining.
const ROOM: [f64; 4] = [0.94, 0.8, 0.65, 0.5];
/// Share of the panels by which these may become more, at least one, where seams stay apart.
const MORE: f64 = 1.0 / 3.0;
/// Openness with which nothing more is tried.
const SETTLED: f64 = 0.3;
/// Openness that every further panel must save.
const WORTH: f64 = 0.5;

/// A face whose strips are to meet.
struct Attempts<'a> {
    index: usize,
    face: &'a Face,
    tolerance: f64,
    /// Limits of sheet and material, seams that must stay.
    wanted: &'a CoverOptions,
    control: &'a Control,
    /// What was proven on the way.
    known: Known,
    /// Labels whose flat patterns are not proven without common edges either.
    unproven: BTreeSet<u32>,
    /// The best so far.
    best: Built,
}

/// The same panels laid anew so that neighbours meet, as far as that can be certified; as they are where it cannot.
pub(crate) fn met(
    index: usize,
    face: &Face,
    state: &State,
    built: Built,
    wanted: &CoverOptions,
    control: &Control,
) -> Built {
    let tolerance = built.certificate.tolerance;
    let unproven = unproven(&built, control).into_iter().collect();
    let mut attempts =
        Attempts { index, face, tolerance, wanted, control, known: Known::default(), unproven, best: built };
    attempts.all(state);
    attempts.best
}

impl Attempts<'_> {
    fn all(&mut self, state: &State) {
        let tolerance = self.tolerance;
        if let Some(next) = self.joined(state) {
            self.keep(next);
        }
        if self.is_done() {
            return;
        }
        if let Some(next) = self.intersecting(&self.best, state) {
            self.keep(next);
        }
        if self.is_done() {
            return;
        }
        let state = self.on_levels(state);
        let meeting = seams::meet(self.face, &state, &borders(self.face, &state.partition), tolerance);
        self.between_levels(&state, &meeting);
        if self.is_done() {
            return;
        }
        if !meeting.edges.is_empty() {
            self.attempt(&state, &meeting);
        }
        // What follows takes long and would leave more open.
        if openness(&self.best) <= SETTLED {
            return;
        }
        let open = open(&self.best);
        self.agreements(&state, &BTreeMap::new(), WEIGHTS, &|labels| open.contains(&pair(labels)));
        // Where no seam could be made of curves, none will become one edge.
        let first = usize::from(meeting.edges.is_empty());
        self.agreements(&state, &meeting.drafts, WEIGHTS[first..].iter().copied(), &|_| true);
    }

    /// Bands between other levels, where these make strips between seams even.
    fn between_levels(&mut self, state: &State, meeting: &Meeting) {
        let tolerance = self.tolerance;
        let mut rows = meeting.rows.clone();
        let mut levelled = None;
        for _ in 0..LEVELLINGS {
            let from = levelled.as_ref().unwrap_or(state);
            let Some(next) = relevel::evened(self.face, from, &rows).map(|s| self.on_levels(&s)) else { break };
            let meeting = seams::meet(self.face, &next, &borders(self.face, &next.partition), tolerance);
            rows.clone_from(&meeting.rows);
            if rows.iter().all(|r| r.worst() <= 1.0) {
                self.attempt(&next, &meeting);
            }
            if self.is_done() {
                break;
            }
            levelled = Some(next);
        }
    }

    /// Strips that agree about the seams that are wanted. Those that become ill shaped, or do not meet, are made firmer.
    fn agreements(
        &mut self,
        state: &State,
        drafts: &BTreeMap<u32, Torse>,
        weights: impl IntoIterator<Item = (f64, f64)>,
        wanted: &(dyn Fn([u32; 2]) -> bool + Sync),
    ) {
        let tolerance = self.tolerance;
        for (weight, enough) in weights {
            let mut firmness: BTreeMap<u32, f64> = BTreeMap::new();
            for time in 0..AGREEMENTS {
                let before = openness(&self.best);
                if self.is_done() || widest(&self.best) <= enough {
                    return;
                }
                let how = Agreement { drafts, firmness: &firmness, weight, wanted };
                let borders = borders(self.face, &state.partition);
                let Some(agreed) = agree(self.face, state, &borders, &how, tolerance) else { break };
                let ill_shaped = self.attempt(state, &agreed);
                if ill_shaped.is_empty() || (time > 0 && openness(&self.best) >= before) {
                    break;
                }
                ill_shaped.into_iter().for_each(|label| *firmness.entry(label).or_insert(1.0) *= FIRMER);
            }
        }
    }

    /// Builds new strips, and once more with their borders where they intersect. The result: labels of those that should
    /// be firmer.
    fn attempt(&mut self, state: &State, meeting: &Meeting) -> Vec<u32> {
        let (next, ill_shaped) = self.judged(state, meeting);
        if let Some(next) = next {
            let crossed = self.intersecting(&next, state);
            self.keep(next);
            crossed.into_iter().for_each(|c| self.keep(c));
        }
        ill_shaped
    }

    /// Takes panels that are nearer to meeting and miss no more limits.
    fn keep(&mut self, next: Built) {
        let missed =
            |b: &Built| limits_missed(&b.patchwork, &b.certificate, &b.patterns, &self.wanted.limits).reasons.len();
        if openness(&next) < openness(&self.best) && missed(&next) <= missed(&self.best) {
            self.best = next;
        }
    }

    fn is_done(&self) -> bool {
        openness(&self.best) <= 0.0 || self.control.stopped()
    }

    /// A state with smooth borders, those between bands on their levels.
    fn on_levels(&self, state: &State) -> State {
        let partition = smooth_borders(self.face, state.partition.clone(), self.tolerance);
        let state = seams::with_partition(self.face, state, partition);
        seams::on_levels(self.face, &state, &borders(self.face, &state.partition), self.tolerance)
    }

    /// The panels with their borders where they intersect, in place of those along which they do not meet. `None` where
    /// that is not possible, or cannot be proven.
    fn intersecting(&self, built: &Built, state: &State) -> Option<Built> {
        let torses: BTreeMap<u32, &Torse> = built
            .patchwork
            .panels
            .iter()
            .filter_map(|p| p.trim.as_ref())
            .filter_map(|t| Some((t.label, t.form.torse()?)))
            .collect();
        let intersections = Intersections::new(self.face, &torses);
        let base = as_built(self.face, state, built)?;
        let wanted: Vec<[u32; 2]> = open(built).into_iter().filter(|p| !self.is_asked_for(built, *p)).collect();
        self.along(&intersections, &base, wanted, Some(built), None)
    }

    /// Strips of the program over all of them, with their borders under their edges. Places where their panels are too far
    /// away count in it the next time; borders of strips that are refused in the end stay.
    fn joined(&self, state: &State) -> Option<Built> {
        let base = as_built(self.face, state, &self.best)?;
        let stays = |labels: [u32; 2]| self.is_asked_for(&self.best, pair(labels));
        let (mut further, mut ends_count) = (Vec::new(), false);
        for round in 0..=REFINEMENTS {
            let asked = joint::Asked { held: &stays, further: &further, ends_count, tolerance: self.tolerance };
            let chains = borders(self.face, &base.partition).seam_chains();
            let joined = joint::joined(self.face, &base, chains, &asked, self.control)?;
            let mut next = base.clone();
            for (label, torse) in joined.torses {
                let fit = next.panels.get(&label)?;
                let fit = Fit { torse, kind: PanelKind::Torse, ..(**fit).clone() };
                next.panels.insert(label, Arc::new(fit));
            }
            let torses = next.panels.iter().map(|(&l, f)| (l, &f.torse)).collect();
            let edges: Vec<_> = joined.lines.into_iter().filter_map(|l| Some((pair(l.labels), l.edge?))).collect();
            let wanted = edges.iter().map(|e| e.0).collect();
            let vertices = joined.vertices.into_iter().map(|v| (v.labels, v.place)).collect();
            let intersections = Intersections::new(self.face, &torses).along(edges, vertices);
            let next = intersections.with_vertices(&next);
            let mut too_far = Vec::new();
            let first = (round < REFINEMENTS).then_some(&mut too_far);
            let found = self.along(&intersections, &next, wanted, None, first);
            if found.is_some() || too_far.is_empty() {
                return found;
            }
            // Where too little is left at ends of panels, they count everywhere, and single places are found anew.
            if !ends_count && too_far.iter().any(|f| f.counts > ENDS) {
                ends_count = true;
                further.clear();
            } else {
                further.extend(too_far);
            }
        }
        None
    }

    /// The panels of a state with borders where strips intersect, and the edges that panels share already. `None` where that
    /// is not possible, or cannot be proven. With `too_far`, nothing more is tried once panels are too far from the face
    /// somewhere: the places are the result.
    fn along(
        &self,
        intersections: &Intersections,
        base: &State,
        mut wanted: Vec<[u32; 2]>,
        built: Option<&Built>,
        mut too_far: Option<&mut Vec<Further>>,
    ) -> Option<Built> {
        for _ in 0..INTERSECTIONS {
            if self.control.stopped() {
                break;
            }
            let (now, moved) = intersections.cut(base, &wanted);
            if moved.is_empty() {
                break;
            }
            wanted = moved;
            let partition = smooth_borders(self.face, now.partition.clone(), self.tolerance);
            let now = intersections.settled(&seams::with_partition(self.face, &now, partition), &wanted);
            let borders = borders(self.face, &now.partition);
            let (mut edges, spoilt) = intersections.edges(&now, &borders, &wanted);
            if !spoilt.is_empty() {
                wanted.retain(|p| !spoilt.contains(p));
                continue;
            }
            edges.extend(built.into_iter().flat_map(|b| seams::kept(&b.patchwork, &borders)));
            let clashing = clashing(&edges, &borders);
            let before = wanted.len();
            wanted.retain(|p| !clashing.contains(p));
            if wanted.len() < before {
                continue;
            }
            let meeting = Meeting {
                edges,
                together: built.map_or_else(BTreeSet::new, |b| b.together.clone()),
                ..Meeting::default()
            };
            let (next, bad) = self.built_on(&now, (&meeting, &[], &[]));
            let missed = missed(&next);
            if bad.is_empty() && missed.is_empty() {
                return Some(next);
            }
            if let Some(places) = too_far.take() {
                places.extend(places_too_far(&next));
                if !places.is_empty() {
                    break;
                }
            }
            wanted.retain(|p| !missed.contains(p) && !p.iter().any(|l| bad.contains(l)));
            if wanted.len() == before {
                break;
            }
        }
        None
    }

    /// Panels with common edges, and the labels of those that are refused: also for a flat pattern that is not proven, but is
    /// without these edges.
    fn built_on(&self, state: &State, kept: Kept) -> (Built, Vec<u32>) {
        let joined = Joined { kept, known: &self.known };
        let (next, mut bad) = build_on(self.index, self.face, state, self.tolerance, joined);
        if bad.is_empty() {
            bad = unproven(&next, self.control);
            bad.retain(|l| !self.unproven.contains(l));
        }
        (next, bad)
    }

    /// Whether the border between two labels lies in a plane in which a seam must run: such borders stay.
    fn is_asked_for(&self, built: &Built, labels: [u32; 2]) -> bool {
        let planes = &self.wanted.layout.seams;
        let Some(partition) = built.patchwork.partitions.first().filter(|_| !planes.is_empty()) else { return false };
        let seams = built.patchwork.seams();
        let mut runs =
            seams.iter().filter(|s| both(s.sides.map(|s| s.of.label())) == Some(labels)).map(|s| s.sides[0].run);
        let place = |v: &u32| {
            let [a, b] = partition.vertices[*v as usize];
            self.face.surface.point(a, b)
        };
        runs.any(|r| planes.iter().any(|p| r.vertices.iter().all(|v| p.height(&place(v)).abs() <= self.tolerance)))
    }

    /// Panels that meet, but for those that are refused; no panels if not all the others can be proven. Second result: the
    /// labels of those that were ill shaped, else of those that do not meet.
    fn judged(&self, state: &State, meeting: &Meeting) -> (Option<Built>, Vec<u32>) {
        let (count, tolerance) = (self.best.patchwork.panels.len(), self.tolerance);
        let (mut refused, mut dropped, mut ill_shaped) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..MEETINGS {
            let (next, bad) = self.built_on(state, (meeting, &refused, &dropped));
            let whole = next.patchwork.panels.len() == count;
            // An edge that its panels miss is no edge of theirs.
            let label = |k: usize| next.patchwork.panels[k].label();
            let missed = missed(&next);
            if bad.is_empty() && whole && missed.is_empty() && too_large(&next, &self.wanted.limits).is_empty() {
                if ill_shaped.is_empty() {
                    // Strips that came out well and still do not meet.
                    let apart = next.certificate.seams.iter().filter(|s| s.gap_bound > APART * tolerance);
                    ill_shaped.extend(apart.flat_map(|s| s.panels.map(label)).flatten());
                    ill_shaped.sort_unstable();
                    ill_shaped.dedup();
                }
                return (Some(next), ill_shaped);
            }
            // Neighbours of a strip that failed keep their other seams.
            let before = refused.len() + dropped.len();
            let proofs: HashMap<u32, &PanelCertificate> =
                next.patchwork.panels.iter().filter_map(|p| p.label()).zip(&next.certificate.panels).collect();
            for l in bad.into_iter().filter(|l| !refused.contains(l)).collect::<Vec<_>>() {
                refused.push(l);
                if proofs.get(&l).is_none_or(|p| p.deviation_bound > NEAR * tolerance) {
                    ill_shaped.push(l);
                }
            }
            dropped.extend(missed);
            if refused.len() + dropped.len() == before {
                break;
            }
        }
        (None, ill_shaped)
    }
}

/// As [`met`], from covers made for less than the tolerance: what they leave is room for joining. They may have more
/// panels where seams would stay apart, if each of these saves enough.
pub(crate) fn with_room(
    index: usize,
    face: &Face,
    mut best: Built,
    cover_options: &CoverOptions,
    control: &Control,
) -> Built {
    let tolerance = best.certificate.tolerance;
    let count = best.patchwork.panels.len();
    for share in ROOM {
        if openness(&best) <= SETTLED || control.stopped() {
            break;
        }
        let narrow = CoverOptions { tolerance: cover_options.tolerance * share, ..cover_options.clone() };
        let Ok(found) = cover(face, &narrow, control) else { break };
        let (built, refused) = build(index, face, &found.state, tolerance);
        let allowed = if widest(&best) > APART { ((count as f64 * MORE) as usize).max(1) } else { 0 };
        if built.patchwork.panels.len() > count + allowed {
            break;
        }
        if !found.complete || !refused.is_empty() {
            continue;
        }
        if !too_large(&built, &cover_options.limits).is_empty() {
            continue;
        }
        let next = met(index, face, &found.state, built, cover_options, control);
        let further = next.patchwork.panels.len().saturating_sub(best.patchwork.panels.len());
        if openness(&best) > openness(&next) + WORTH * further as f64 {
            best = next;
        }
    }
    best
}

/// Labels of panels whose flat patterns are not proven.
fn unproven(built: &Built, control: &Control) -> Vec<u32> {
    let proofs = flat(&built.patchwork, &built.patterns, built.certificate.tolerance, control);
    let open = proofs.iter().filter(|p| !p.holds());
    open.filter_map(|p| built.patchwork.panels.get(p.panel())?.label()).collect()
}

/// How far panels are from meeting: a gap of the tolerance counts one, every seam that is not exact a little besides.
fn openness(built: &Built) -> f64 {
    const EACH: f64 = 0.1;
    let open = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    open.map(|s| EACH + s.gap_bound / built.certificate.tolerance).sum()
}

/// The largest gap of seams that are not one edge, as a share of the tolerance; 0 where all are.
fn widest(built: &Built) -> f64 {
    let open = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    open.fold(0.0, |m, s| s.gap_bound.max(m)) / built.certificate.tolerance
}

/// Labels on both sides of seams that are not one edge.
fn open(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    seams.filter_map(|s| labels(built, s)).collect()
}

/// Labels on both sides of edges that end in one vertex of the borders, but in different points.
fn clashing(edges: &[SharedSeam], borders: &Borders) -> Vec<[u32; 2]> {
    let chains = borders.seam_chains();
    // By vertex: the point, bit by bit, and the labels.
    type End = ([u64; 3], [u32; 2]);
    let mut ends: HashMap<u32, Vec<End>> = HashMap::new();
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

/// Where panels are farther from the face than the proof leaves room for.
fn places_too_far(built: &Built) -> Vec<Further> {
    let panels = built.patchwork.panels.iter().zip(&built.certificate.panels);
    let place = |(panel, proof): (&Panel, &PanelCertificate)| {
        let (uv, left) = proof.too_far?;
        let counts = built.certificate.tolerance / left;
        (counts < MOST_COUNTED).then_some(Further { label: panel.label()?, uv, counts })
    };
    panels.filter_map(place).collect()
}

/// Labels on both sides of edges that their panels miss.
fn missed(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.patchwork.seams().into_iter().zip(&built.certificate.seams);
    let missed = seams.filter(|(s, c)| s.is_shared() && c.status != SeamStatus::Exact);
    missed.filter_map(|(_, c)| labels(built, c)).collect()
}

fn labels(built: &Built, seam: &SeamCertificate) -> Option<[u32; 2]> {
    both(seam.panels.map(|k| built.patchwork.panels[k].label()))
}

/// Two labels in order, if both panels have one.
fn both(labels: [Option<u32>; 2]) -> Option<[u32; 2]> {
    Some(pair([labels[0]?, labels[1]?]))
}

/// The state with the torses and the partition of panels.
fn as_built(face: &Face, state: &State, built: &Built) -> Option<State> {
    let mut out = seams::with_partition(face, state, built.patchwork.partitions.first()?.clone());
    for p in &built.patchwork.panels {
        let trim = p.trim.as_ref()?;
        let fit =
            Fit { torse: trim.form.torse()?.clone(), kind: p.strip.kind, ..(**out.panels.get(&trim.label)?).clone() };
        out.panels.insert(trim.label, Arc::new(fit));
    }
    Some(out)
}
