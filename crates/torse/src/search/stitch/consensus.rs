//! Strips that agree about their seams: what is left of a covered face where strips laid anew between seam curves do not
//! exist or cannot be proven. Every border between two panels counts, whatever it follows. Nothing is judged here.

use super::seams::{level_chains, origin, stretch, Meeting, SharedSeam};
use crate::brep::face::Face;
use crate::fit::near::samples::Sample;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::fit::seams::{
    base_line, consensus, AgreedLine, Agreeing, BaseLine, ConsensusOptions, Height, Line, LinePoint,
};
use crate::geom::Vec3;
use crate::search::cover::{Density, State};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::torse::form::Torse;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Share of the tolerance that strips may use before they are judged.
const SHARE: f64 = 0.97;
/// A seam whose strips agree within this share of the tolerance becomes one edge of both.
const AGREED: f64 = 0.007;
/// Lines reach beyond the region by this share of their length: border vertices lie on chords of it.
const BEYOND: f64 = 0.01;
/// Spans of a seam curve at most, and points for each at least.
const CURVE_SPANS: (usize, usize) = (48, 4);

/// A line with what its edge needs.
struct Border<'a> {
    chain: &'a SeamChain,
    base: Option<BaseLine>,
    points: Vec<LinePoint>,
}

/// How strips are to agree.
pub(crate) struct Agreement<'a> {
    /// Torses to start from in place of those of the panels.
    pub drafts: &'a BTreeMap<u32, Torse>,
    /// See [`Agreeing::firmness`]; 1 for labels that are not named.
    pub firmness: &'a BTreeMap<u32, f64>,
    /// How much gaps count, see [`ConsensusOptions::weight`].
    pub weight: f64,
    /// Whether the strips of two labels are to agree; strips that are to agree with none stay as they are.
    pub wanted: &'a (dyn Fn([u32; 2]) -> bool + Sync),
}

/// Moves the strips of a covered face until neighbours agree. `state` must have the partition of the borders. `None`
/// where there is nothing to agree about, or some strip cannot take part.
pub(crate) fn agree(face: &Face, state: &State, borders: &Borders, how: &Agreement, tolerance: f64) -> Option<Meeting> {
    let chains = borders.seam_chains();
    // 1. Strips, in an order in which neighbours are near each other.
    let wanted: Vec<bool> = chains.iter().map(|c| c.length > 0.0 && (how.wanted)(c.labels)).collect();
    let mut order = order(state, &chains);
    order.retain(|l| chains.iter().zip(&wanted).any(|(c, w)| *w && c.labels.contains(l)));
    let index: HashMap<u32, usize> = order.iter().enumerate().map(|(k, &l)| (l, k)).collect();
    let samples: Vec<Vec<Sample>> =
        order.iter().map(|&l| state.dense_samples(&face.surface, l, Density::Band)).collect();
    let starts: Vec<Option<&Torse>> =
        order.iter().map(|l| how.drafts.get(l).or_else(|| Some(&state.panels.get(l)?.torse))).collect();
    // 2. Lines.
    let levels: HashMap<usize, u32> =
        level_chains(state, &chains, tolerance).into_iter().map(|c| (c.chain, c.low)).collect();
    let mut found: Vec<Border> = chains
        .par_iter()
        .enumerate()
        .filter(|&(k, c)| wanted[k] && c.labels.iter().all(|l| index.get(l).is_some_and(|&i| starts[i].is_some())))
        .filter_map(|(k, chain)| border(face, state, chain, levels.get(&k).copied()))
        .collect();
    // Only points that both strips reach; beyond the region some are not.
    let heights: Vec<Option<Height>> = starts.iter().map(|t| Height::of((*t)?)).collect();
    found.par_iter_mut().for_each(|b| {
        let [p, q] = b.chain.labels.map(|l| heights[index[&l]].as_ref());
        let reached = |x: &LinePoint| [p, q].iter().flatten().all(|h| h.at(&x.x, &x.n).is_some());
        let first = b.points.iter().position(reached).unwrap_or(b.points.len());
        let last = b.points.iter().rposition(reached).map_or(first, |k| k + 1);
        b.points = b.points[first..last].to_vec();
        // Between both normals offsets are hardly longer than the distances.
        for x in &mut b.points {
            let normals = [p, q].map(|h| h.and_then(|h| h.normal(&x.x, &x.n)));
            if let [Some(a), Some(b)] = normals {
                x.n = (a + b).try_normalize(0.0).unwrap_or(x.n);
            }
        }
    });
    found.retain(|b| b.points.len() >= 2);
    found.sort_by_key(|b| {
        let [a, b] = b.chain.labels.map(|l| index[&l]);
        (a.min(b), a.max(b))
    });
    // 3. Agreement of the strips that can.
    let concerned = |l: &u32| found.iter().any(|b| b.chain.labels.contains(l));
    let taking: Vec<usize> = (0..order.len()).filter(|&k| starts[k].is_some() && concerned(&order[k])).collect();
    let place: HashMap<usize, usize> = taking.iter().enumerate().map(|(i, &k)| (k, i)).collect();
    let strips: Vec<Agreeing> = taking
        .iter()
        .filter_map(|&k| {
            let firmness = how.firmness.get(&order[k]).copied().unwrap_or(1.0);
            Some(Agreeing { torse: starts[k]?, samples: &samples[k], firmness })
        })
        .collect();
    let lines: Vec<Line> = found
        .iter()
        .map(|b| Line { strips: b.chain.labels.map(|l| place[&index[&l]]), points: b.points.clone() })
        .collect();
    if lines.is_empty() {
        return None;
    }
    let options = ConsensusOptions { weight: how.weight, ..ConsensusOptions::new(tolerance * SHARE) };
    let (agreed, lifted) = consensus(&strips, &lines, &options)?;
    let torses: BTreeMap<u32, Torse> =
        taking.iter().zip(agreed).filter_map(|(&k, a)| Some((order[k], a?.torse))).collect();
    let edges = found.iter().zip(&lifted).filter_map(|(b, l)| shared(state, b, l, AGREED * tolerance)).collect();
    let together = torses.keys().copied().collect();
    Some(Meeting { torses, edges, together, ..Meeting::default() })
}

/// Labels with panels, neighbours near each other.
fn order(state: &State, chains: &[SeamChain]) -> Vec<u32> {
    let mut near: BTreeMap<u32, Vec<u32>> = state.panels.keys().map(|&l| (l, Vec::new())).collect();
    for c in chains {
        for (a, b) in [(c.labels[0], c.labels[1]), (c.labels[1], c.labels[0])] {
            if let Some(n) = near.get_mut(&a) {
                if !n.contains(&b) {
                    n.push(b);
                }
            }
        }
    }
    let mut out: Vec<u32> = Vec::new();
    // From a label with few neighbours outwards, part by part.
    while let Some((&first, _)) = near.iter().filter(|(l, _)| !out.contains(l)).min_by_key(|(_, n)| n.len()) {
        let mut next = out.len();
        out.push(first);
        while next < out.len() {
            for &l in near.get(&out[next]).into_iter().flatten() {
                if near.contains_key(&l) && !out.contains(&l) {
                    out.push(l);
                }
            }
            next += 1;
        }
    }
    out
}

/// The line under a border: a level line where it follows one, else its vertices.
fn border<'a>(face: &Face, state: &State, chain: &'a SeamChain, low: Option<u32>) -> Option<Border<'a>> {
    if let Some(field) = low.and_then(|l| state.bands.get(&l)) {
        let line = origin(face, state, field, chain).and_then(|o| {
            let beyond = BEYOND * (o.inside.0 + o.inside.1);
            base_line(&face.surface, field, o.seed, o.inside, [beyond; 2])
        });
        if let Some(base) = line {
            let points = base.points.iter().map(|p| LinePoint { s: p.s, x: p.x, n: p.n }).collect();
            return Some(Border { chain, base: Some(base), points });
        }
    }
    let mut points: Vec<LinePoint> = Vec::new();
    for &v in &chain.vertices {
        let j = &state.jets[v as usize];
        let s = points.last().map_or(0.0, |p| p.s + (j.jet.p - p.x).norm());
        if j.normal.norm() > 0.0 && points.last().is_none_or(|p| s > p.s) {
            points.push(LinePoint { s, x: j.jet.p, n: j.normal });
        }
    }
    (points.len() >= 2).then_some(Border { chain, base: None, points })
}

/// The edge of both strips where they agree.
fn shared(state: &State, border: &Border, line: &AgreedLine, allowed: f64) -> Option<SharedSeam> {
    let base = border.base.as_ref().filter(|_| line.gap <= allowed)?;
    let points: Vec<[f64; 3]> = border.points.iter().map(|p| (p.x + p.n * line.offset_at(p.s)).into()).collect();
    let parameters: Vec<f64> = border.points.iter().map(|p| p.s).collect();
    let spans = CURVE_SPANS.0.min(points.len() / CURVE_SPANS.1).max(1);
    let knots = Knots::uniform(5, spans, *parameters.first()?, *parameters.last()?).ok()?;
    let curve: Curve<3> = lsq::fit(&points, &parameters, &knots).ok()?.curve;
    let places: Vec<Vec3> = border.chain.vertices.iter().map(|&v| state.jets[v as usize].jet.p).collect();
    let (edge, parameters) = stretch(&curve, base, &places)?;
    Some(SharedSeam { chain: border.chain.chain, labels: border.chain.labels, edge, parameters })
}
