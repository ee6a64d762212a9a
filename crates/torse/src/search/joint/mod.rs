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

mod asked;
mod columns;
mod edge;
mod envelope;
mod fleet;
mod form;
mod line;
mod network;
mod profile;
mod program;
mod start;
mod steps;
mod strip;
#[cfg(test)]
mod tests;
mod width;

use crate::control::Control;
use crate::fit::panels::boundary::SeamChain;
use crate::geom::Vec3;
use crate::search::cover::Cover;
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
pub(crate) use asked::{Asked, BorderCounts};
pub(crate) use edge::turning;
use edge::{Edge, Junction};
use fleet::Fleet;
pub(crate) use fleet::{Meeting, AWAY};
use line::Line;
pub(crate) use network::Further;
use network::Network;
pub(crate) use start::whole_borders;

/// Largest distance of an edge from its strips, as a share of what lines are long: wanted, allowed.
const ON_BOTH: (f64, f64) = (3e-7, 1e-6);
/// Share of the least regularity of samples that strips keep between these.
const BETWEEN: f64 = 0.8;
/// Times that strips get finer for that, and the largest distance of a sample that this may lead to, in tolerances.
const POLISHINGS: usize = 3;
/// See [`POLISHINGS`].
const POLISHED: f64 = 0.97;

/// Edges between faces that are given up where strips come no nearer, at most, and steps after which none is: each costs some.
const LEFT: (usize, usize) = (3, 16);

/// Share of their least regularity that strips which are to meet those of other faces keep: places at their ends are where edges
/// end, and can be less regular than any other.
const LESS: f64 = 0.6;

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

/// The strips of covered faces and the lines between them, as far as they have been changed together.
pub(crate) struct Joint<'a> {
    fleet: Fleet<'a>,
    /// Which of its networks a face has.
    slots: Vec<Option<usize>>,
    /// Largest distance and gap to begin with, in tolerances.
    start: [f64; 2],
    steps: Vec<StepReport>,
    /// See [`Asked::most`].
    most: f64,
}

/// A face whose strips are to be joined: its cover, the lines between them and what is asked.
pub(crate) type Beside<'a, 'b> = (&'a Cover, Vec<SeamChain>, &'b Asked<'a>);

impl<'a> Joint<'a> {
    /// *Input*: `cover` with the partition to which the chains belong. Strips that cannot take part (without a torse, with a
    /// torse of higher degree, with samples without feet) stay as they are, and borders that close. `None` without any border
    /// left.
    pub fn new(cover: &'a Cover, chains: Vec<SeamChain>, asked: &Asked) -> Option<Self> {
        let fleet = Fleet::of(start::network(cover, chains, asked)?);
        let (start, most) = (fleet.measured(), asked.most);
        Some(Self { start, fleet, slots: vec![Some(0)], steps: Vec::new(), most })
    }

    /// The same of several faces, which are to meet at places besides; `None` for faces that take no part, as above.
    pub fn of_faces(faces: Vec<Option<Beside<'a, '_>>>, meetings: &[Meeting]) -> Self {
        let most = faces.iter().flatten().map(|f| f.2.most).fold(0.0, f64::max);
        let networks: Vec<Option<Network<'a>>> = faces
            .into_iter()
            .map(|f| f.and_then(|(cover, chains, asked)| start::network(cover, chains, asked)))
            .collect();
        let (mut fleet, slots) = Fleet::meeting(networks, meetings);
        fleet.networks.iter_mut().flat_map(|n| &mut n.members).for_each(|m| m.least *= LESS);
        Self { start: fleet.measured(), fleet, slots, steps: Vec::new(), most }
    }

    /// Places of a face that count from now on.
    pub fn count(&mut self, face: usize, places: &[Further]) {
        if let Some(k) = self.slots[face] {
            self.fleet.networks[k].add(places);
        }
    }

    /// From now on distances count more near lines and borders of the face, for what the proof takes of the tolerance where
    /// panels do not end on their own normals. Where panels are thin against that, too little is left for all of it.
    pub fn count_ends(&mut self, face: usize) {
        if let Some(k) = self.slots[face] {
            self.fleet.networks[k].ends_count = true;
            self.fleet.networks[k].find_taken();
        }
    }

    /// See [`Joint::joined_all`], of the only face.
    pub fn joined(&mut self, control: &Control) -> Option<Joined> {
        self.joined_all(control).pop()?
    }

    /// Strips and lines changed together until neighbours are equally high along their seams, with as small a largest
    /// distance as that allows, and edges on both. Asked again, it goes on from there with what counts since.
    ///
    /// *Result*: for every face the best that was reached, whether strips meet or not; `None` where a strip has become nothing,
    /// and for faces that take no part. *Not
    /// guaranteed*: any distance between samples; see `certify`. *Cost*: about as many factorisations as three programs have
    /// iterations, each of one block per strip.
    pub fn joined_all(&mut self, control: &Control) -> Vec<Option<Joined>> {
        let (alone, begun) = (self.fleet.networks.len() == 1, !self.steps.is_empty());
        self.improve(control, alone || !begun);
        // What cannot be had at one edge must not cost the others.
        for left in (0..LEFT.0).rev() {
            let done = self.fleet.measured()[0] <= 1.0 || self.steps.len() >= LEFT.1;
            if done || control.stopped() || !self.fleet.leave_worst() {
                break;
            }
            // Some faces may be near enough in the end where others are not.
            self.improve(control, left > 0 && !begun);
        }
        let found: Vec<Option<Joined>> =
            (0..self.fleet.networks.len()).map(|k| self.made(self.fleet.aimed(k))).collect();
        self.slots.iter().map(|k| found[(*k)?].clone()).collect()
    }

    fn made(&self, network: Network<'a>) -> Option<Joined> {
        let (network, edges) = edged(network);
        let label = |k: &usize| network.members[*k].label;
        let line = |(l, edge): (&Line, Option<Edge>)| JoinedLine {
            labels: l.strips.map(|k| label(&k)),
            uv: l.points.iter().map(|p| p.uv).collect(),
            edge: edge.filter(|e| !e.misses(ON_BOTH.1)).map(|e| e.curve),
        };
        let vertex = |j: Junction| JoinedVertex { labels: j.strips.iter().map(label).collect(), place: j.place };
        Some(Joined {
            torses: (0..network.members.len()).map(|k| Some((label(&k), network.used(k)?))).collect::<Option<_>>()?,
            distances: network.largest_of_strips().into_iter().map(|d| d / network.tolerance).collect(),
            lines: network.lines.iter().zip(edges).map(line).collect(),
            vertices: network.junctions().into_iter().map(vertex).collect(),
            start: self.start,
            steps: self.steps.clone(),
        })
    }
}

/// Edges along all lines, on finer strips where they would miss these, and with vertices where edges meet. Strips may be a little
/// less regular between their samples than at these.
fn edged(mut now: Network<'_>) -> (Network<'_>, Vec<Option<Edge>>) {
    let missing = |edges: &[Option<Edge>], share: f64| {
        edges.iter().filter(|e| e.as_ref().is_none_or(|e| e.misses(share))).count()
    };
    now.members.iter_mut().for_each(|m| m.least *= BETWEEN);
    let most = now.measured()[0].max(POLISHED);
    now = settled(now, most);
    let edges = now.edges();
    let mut best = (now, edges);
    let mut finer: Option<(Network, Vec<Option<Edge>>)> = None;
    for _ in 0..POLISHINGS {
        if missing(&best.1, ON_BOTH.0) == 0 && best.0.meets_aims() {
            break;
        }
        let (last, edges) = finer.as_ref().unwrap_or(&best);
        let Some(next) = last.polished(edges, ON_BOTH.0).filter(|n| n.measured()[0] <= most) else { break };
        let edges = next.edges();
        if missing(&edges, ON_BOTH.1) <= missing(&best.1, ON_BOTH.1) {
            best = (next, edges);
            finer = None;
        } else {
            finer = Some((next, edges));
        }
    }
    best
}

/// The network with vertices where edges meet, if distances (tolerances) stay below `most`.
fn settled(network: Network<'_>, most: f64) -> Network<'_> {
    network.under_junctions().filter(|n| n.measured()[0] <= most).unwrap_or(network)
}
