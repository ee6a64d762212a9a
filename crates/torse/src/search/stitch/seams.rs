//! Edges that panels share, and vertices of borders that go under them. Nothing is judged here.

use crate::brep::face::Face;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::search::cover::State;
use crate::spline::curve::Curve;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// An edge in space for a chain of the borders.
#[derive(Clone, Debug)]
pub(crate) struct SharedSeam {
    pub chain: usize,
    pub labels: [u32; 2],
    pub edge: Curve<3>,
    pub parameters: Vec<f64>,
}

/// Moves the vertices of borders to places given by border, vertex, and for whether its parameters must stay: vertices on
/// knot lines move along these, ends on a trimming curve that is no knot line stay. Where triangles would turn over, the
/// vertices around are moved out of the way; vertices for which that is not enough stay too, and are the result.
pub(crate) fn settle(
    face: &Face,
    partition: &mut Partition,
    along: &[&SeamChain],
    place: impl Fn(usize, [f64; 2], [bool; 2]) -> Option<[f64; 2]> + Sync,
) -> BTreeSet<u32> {
    let lines = [face.surface.knots_u.breaks(), face.surface.knots_v.breaks()];
    let mut all: Vec<(usize, u32, bool)> = Vec::new();
    for (k, chain) in along.iter().enumerate() {
        let last = chain.vertices.len() - 1;
        all.extend(chain.vertices.iter().enumerate().map(|(i, &v)| (k, v, i == 0 || i == last)));
    }
    let mut waiting: Vec<(u32, [f64; 2])> = all
        .par_iter()
        .filter_map(|&(k, v, is_end)| {
            let old = partition.vertices[v as usize];
            let fixed = [0, 1].map(|d: usize| lines[d].contains(&old[d]));
            let stays = fixed == [true; 2] || (is_end && fixed == [false; 2]);
            if stays {
                None
            } else {
                Some((v, place(k, old, fixed)?))
            }
        })
        .collect();
    let mut around: HashMap<u32, Vec<usize>> = waiting.iter().map(|&(v, _)| (v, Vec::new())).collect();
    for (t, corners) in partition.triangles.iter().enumerate() {
        for v in corners {
            if let Some(a) = around.get_mut(v) {
                a.push(t);
            }
        }
    }
    let area = |p: &Partition, t: usize| {
        let [a, b, c] = p.corners(t);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for _ in 0..SETTLINGS {
        waiting.retain(|&(v, new)| {
            let old = partition.vertices[v as usize];
            let before: Vec<f64> = around[&v].iter().map(|&t| area(partition, t)).collect();
            for share in SETTLING_SHARES {
                let to = |d: usize| if share < 1.0 { old[d] + (new[d] - old[d]) * share } else { new[d] };
                // Coordinates on knot lines are the same in both.
                partition.vertices[v as usize] = [to(0), to(1)];
                if around[&v].iter().zip(&before).all(|(&t, b)| area(partition, t) > LEAST_TRIANGLE * b) {
                    return share < 1.0;
                }
            }
            partition.vertices[v as usize] = old;
            true
        });
        if waiting.is_empty() {
            break;
        }
        partition.relax([&lines[0], &lines[1]]);
    }
    waiting.into_iter().map(|w| w.0).collect()
}

/// Times that vertices try to settle.
const SETTLINGS: usize = 8;
/// Shares of the way that they try each time.
const SETTLING_SHARES: [f64; 3] = [1.0, 0.5, 0.2];
/// Triangles keep this share of their area when vertices move.
const LEAST_TRIANGLE: f64 = 0.05;

/// The edges that panels of a patchwork share, for those borders that are still the same.
pub(crate) fn kept(patchwork: &Patchwork, borders: &Borders) -> Vec<SharedSeam> {
    let seams = patchwork.seams();
    let sides: Vec<_> = seams.iter().filter(|s| s.is_shared()).flat_map(|s| s.sides).collect();
    let same = |c: SeamChain| {
        let run = sides.iter().map(|s| s.run).find(|r| r.vertices == c.vertices)?;
        let (edge, parameters) = (run.edge.clone(), run.parameters.clone());
        Some(SharedSeam { chain: c.chain, labels: c.labels, edge, parameters })
    };
    borders.seam_chains().into_iter().filter_map(same).collect()
}

/// The state with another partition of the same labels.
pub(crate) fn with_partition(face: &Face, state: &State, partition: Partition) -> State {
    let mut out = State {
        partition,
        jets: Vec::new(),
        panels: state.panels.clone(),
        bands: state.bands.clone(),
        origins: state.origins.clone(),
    };
    out.update(&face.surface);
    out
}
