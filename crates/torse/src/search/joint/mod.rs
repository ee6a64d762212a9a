//! All strips of a face and the lines between them in one program: neighbours become equally high along their seams while
//! the largest distance falls. Nothing is judged here.
//!
//! *Method*: docs/algorithms/seams.md, "All strips together"; independent strips along the level lines of a function
//! \[SE06\] carried on. Unknown are the functions that make up every strip, shifts of the lines between them along the
//! face, and the places where lines meet. One step is a convex program: the smallest largest distance of samples under a
//! price of the squared differences of heights along lines, all to first order; the feet of samples stay (envelope
//! theorem), and a damping of what that leaves out keeps steps as short as they must be. Then feet, regions and rows are
//! found anew. Since heights are compared and nothing is intersected, seams at which strips hardly cross are like all
//! others. Edges come last: points in which both strips intersect, or lie between them where they hardly do.

mod columns;
mod edge;
mod envelope;
mod form;
mod line;
mod network;
mod profile;
mod program;
mod start;
mod strip;
#[cfg(test)]
mod tests;
mod width;

use crate::brep::face::Face;
use crate::control::Control;
use crate::fit::panels::boundary::SeamChain;
use crate::geom::Vec3;
use crate::search::cover::State;
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
use edge::{Edge, Junction};
use line::Line;
use network::Network;
use program::{step, Prices, Step};
pub(crate) use start::whole_borders;
use std::collections::BTreeSet;

/// Largest distance (tolerances) above which strips have far to go after so many steps: slides then grow, and there are more
/// steps.
const FAR: (f64, usize) = (1.05, 2);
/// See [`FAR`].
const FAR_STEPS: usize = 12;
/// There, factors on how far lines may slide in a step, after refused and good ones, and the most.
const SLIDES: (f64, f64, f64) = (0.5, 2.0, 4.0);
/// There, gaps below this count no less than it, in place of the first of [`GAP`]: what the polish closes.
const FAR_GAP: f64 = 0.02;
/// Weights of gaps from step to step; the last one stays.
const WEIGHTS: [f64; 4] = [20.0, 80.0, 320.0, 1200.0];
/// Steps at most; of those with far to go, see [`FAR`], [`FAR_STEPS`].
const STEPS: usize = 8;
/// Trials of a step.
const TRIALS: usize = 5;
/// Largest distance and gap (tolerances) with which nothing more is tried, after so many steps.
const ENOUGH: (f64, f64, usize) = (0.93, 0.03, 2);
/// Steps that gain less end the program once gaps are small enough.
const STALLED: f64 = 2e-3;
/// Gaps below the first of these count no less than it, times the second, beside the largest distance.
const GAP: (f64, f64) = (0.01, 3.0);
/// Parts of a step that are tried, the largest with which no foot is lost is taken.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// Shares of the expected gain: accepted above, damped more below, damped less above.
const GAIN: (f64, f64, f64) = (0.1, 0.3, 0.7);
/// Growth of the merit that is nothing.
const NOTHING: f64 = 1e-3;
/// Factors on the damping after good, poor and refused steps.
const DAMPING: (f64, f64, f64) = (0.25, 2.0, 6.0);
/// See [`DAMPING`]: less changes nothing, and takes trials to be left again.
const LEAST_DAMPING: f64 = 0.1;

/// Largest distance of an edge from its strips, as a share of its length: wanted, allowed.
const ON_BOTH: (f64, f64) = (3e-7, 1e-6);
/// Share of the least regularity of samples that strips keep between these.
const BETWEEN: f64 = 0.8;
/// Times that strips get finer for that, and the largest distance of a sample that this may lead to, in tolerances.
const POLISHINGS: usize = 2;
/// See [`POLISHINGS`].
const MOST: f64 = 0.97;

/// A place on the face where a panel was too far away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Further {
    /// Label of the panel.
    pub label: u32,
    /// Parameters on the face.
    pub uv: [f64; 2],
    /// What its distance counts: the tolerance over what is left of it there.
    pub counts: f64,
}

/// What is asked of strips that are to meet.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    /// Between which labels (left, right) seams must stay where they are.
    pub held: &'a dyn Fn([u32; 2]) -> bool,
    /// Labels whose strips stay as they are, and their borders too.
    pub without: &'a BTreeSet<u32>,
    /// Places that count besides those of the partition.
    pub further: &'a [Further],
    /// Whether distances count more near lines and borders of the face, for what the proof takes of the tolerance where
    /// panels do not end on their own normals. Where panels are thin against that, too little is left for all of it.
    pub ends_count: bool,
    /// mm.
    pub tolerance: f64,
}

/// What one step led to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepReport {
    /// Largest distance of a sample and largest gap, in tolerances.
    pub reached: [f64; 2],
    /// Programs solved and their Newton matrices.
    pub effort: [usize; 2],
}

/// A seam line after the program.
#[derive(Clone, Debug)]
pub(crate) struct JoinedLine {
    /// Labels on the left and on the right.
    pub labels: [u32; 2],
    /// Parameters on the face at equal arc lengths.
    pub uv: Vec<[f64; 2]>,
    /// The edge of both strips, beyond both ends by about a hundredth.
    pub edge: Option<Curve<3>>,
}

/// The point in which three strips meet.
#[derive(Clone, Debug)]
pub(crate) struct JoinedVertex {
    /// Their labels, in order.
    pub labels: Vec<u32>,
    /// The point, mm.
    pub place: Vec3,
}

/// Strips after the program.
#[derive(Clone, Debug)]
pub(crate) struct Joined {
    /// New torse of every label that takes part.
    pub torses: Vec<(u32, Torse)>,
    /// Largest distance of a sample or line from each of them, in tolerances.
    pub distances: Vec<f64>,
    /// Points inside the face in which three strips meet.
    pub vertices: Vec<JoinedVertex>,
    /// Seam lines.
    pub lines: Vec<JoinedLine>,
    /// Largest distance and gap to begin with, in tolerances.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with the end"))]
    pub start: [f64; 2],
    /// Accepted steps.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests follow them"))]
    pub steps: Vec<StepReport>,
}

/// The strips of a covered face and the lines between them, changed together until neighbours are equally high along their
/// seams, with as small a largest distance as that allows, and edges on both.
///
/// *Input*: `state` with the partition to which the chains belong. Strips that cannot take part (without a torse, with a torse
/// of higher degree, with samples without feet) stay as they are, and borders that close. *Result*: the best that was reached,
/// whether strips meet or not; `None` without any border left. *Not guaranteed*: any distance between samples; see `certify`.
/// *Cost*: about as many factorisations as three programs have iterations, each of one block per strip.
pub fn joined(face: &Face, state: &State, chains: Vec<SeamChain>, asked: &Asked, control: &Control) -> Option<Joined> {
    let network = start::network(face, state, chains, asked)?;
    let start = network.measured();
    let (network, steps) = improved(network, control);
    let (network, edges) = edged(network);
    let label = |k: &usize| network.members[*k].label;
    let line = |(l, edge): (&Line, Option<Edge>)| JoinedLine {
        labels: l.strips.map(|k| label(&k)),
        uv: l.points.iter().map(|p| p.uv).collect(),
        edge: edge.filter(|e| e.missed <= ON_BOTH.1 * l.length).map(|e| e.curve),
    };
    let vertex = |j: Junction| JoinedVertex { labels: j.strips.iter().map(label).collect(), place: j.place };
    Some(Joined {
        torses: (0..network.members.len()).map(|k| Some((label(&k), network.used(k)?))).collect::<Option<_>>()?,
        distances: network.largest_of_strips().into_iter().map(|d| d / network.tolerance).collect(),
        lines: network.lines.iter().zip(edges).map(line).collect(),
        vertices: network.junctions().into_iter().map(vertex).collect(),
        start,
        steps,
    })
}

/// Steps as long as they make the network better.
fn improved<'a>(mut now: Network<'a>, control: &Control) -> (Network<'a>, Vec<StepReport>) {
    let (mut damping, mut reach, mut far) = (1.0, 1.0, false);
    let mut steps: Vec<StepReport> = Vec::new();
    'steps: while steps.len() < (if far { FAR_STEPS } else { STEPS }) && !control.stopped() {
        let at = now.measured();
        far |= steps.len() == FAR.1 && at[0] > FAR.0;
        let least = if far { FAR_GAP } else { GAP.0 };
        let merit = |[distance, gap]: [f64; 2]| distance + GAP.1 * gap.max(least);
        if steps.len() >= ENOUGH.2 && at[0] < ENOUGH.0 && at[1] < ENOUGH.1 {
            break;
        }
        let columns = now.columns();
        let weight = WEIGHTS[steps.len().min(WEIGHTS.len() - 1)];
        let (mut effort, mut refused) = ([0, 0], Vec::new());
        for _ in 0..TRIALS {
            let Some(found) = step(&now, &columns, &Prices { gaps: weight, damping, reach }) else { break 'steps };
            effort = [effort[0] + 1, effort[1] + found.iterations];
            // Where feet would be lost a part of the step is as good as can be had: what it keeps is linear in it.
            let of_step = |part: &f64| {
                let x: Vec<f64> = found.x.iter().map(|x| part * x).collect();
                Some((*part, now.stepped(&columns, &x)?))
            };
            let (part, next) = PARTS.iter().find_map(of_step).map_or((1.0, None), |(part, next)| (part, Some(next)));
            let reached = next.as_ref().map_or([f64::INFINITY; 2], Network::measured);
            let hoped = part * (merit(at) - merit(found.expected));
            let share = (merit(at) - merit(reached)) / hoped.max(f64::MIN_POSITIVE);
            let accepted = share > GAIN.0 || merit(reached) < merit(at) + NOTHING;
            let Some(mut next) = next.filter(|_| accepted) else {
                refused.push(found);
                damping *= DAMPING.2;
                reach = (reach * SLIDES.0).max(1.0);
                continue;
            };
            if share > GAIN.2 && part == 1.0 {
                damping = (damping * DAMPING.0).max(LEAST_DAMPING);
                if far {
                    reach = (reach * SLIDES.1).min(SLIDES.2);
                }
            } else if share < GAIN.1 {
                damping *= DAMPING.1;
            }
            next.lie_on_bands();
            next.find_taken();
            now = next;
            steps.push(StepReport { reached, effort });
            if steps.len() >= ENOUGH.2 && reached[1] < ENOUGH.1 && merit(at) - merit(reached) < STALLED {
                break 'steps;
            }
            continue 'steps;
        }
        // Whole steps go too far, however much they are damped: a part of one goes the same way.
        let part_of = |(found, part): (&Step, f64)| {
            let x: Vec<f64> = found.x.iter().map(|x| part * x).collect();
            let next = now.stepped(&columns, &x)?;
            let reached = next.measured();
            let gained = merit(at) - merit(reached);
            (gained > GAIN.0 * part * (merit(at) - merit(found.expected))).then_some((next, reached))
        };
        let mut parts = PARTS[1..].iter().flat_map(|&part| refused.iter().rev().map(move |found| (found, part)));
        let Some((mut next, reached)) = parts.find_map(part_of) else { break };
        damping = 1.0;
        next.lie_on_bands();
        next.find_taken();
        now = next;
        steps.push(StepReport { reached, effort });
    }
    (now, steps)
}

/// Edges along all lines, on finer strips where they would miss these. Strips may be a little less regular between their
/// samples than at these.
fn edged(mut now: Network) -> (Network, Vec<Option<Edge>>) {
    now.members.iter_mut().for_each(|m| m.least *= BETWEEN);
    let most = now.measured()[0].max(MOST);
    let mut edges = now.edges();
    for _ in 0..POLISHINGS {
        let good = |(l, e): (&Line, &Option<Edge>)| e.as_ref().is_some_and(|e| e.missed <= ON_BOTH.0 * l.length);
        if now.lines.iter().zip(&edges).all(good) {
            break;
        }
        let Some(next) = now.polished().filter(|n| n.measured()[0] <= most) else { break };
        now = next;
        edges = now.edges();
    }
    (now, edges)
}
