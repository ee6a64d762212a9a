//! Networks of several faces, and the places at which these meet.
//!
//! *Method* ([joint](super)). Along an edge between two faces both strips are heights in the direction between the normals of
//! the faces. Turned by κ against each other the faces let strips at distances a and b intersect `(a cos κ − b)/sin κ` away from
//! where the first one ends by itself. The less the faces turn, the more nearly the heights must be equal: what they differ by is
//! paid as gaps of seams are, by its share in that way. Where faces turn far, the way itself counts as a distance; as the proof
//! takes the largest distance and the largest way of all that is near each other, each has its own share of the tolerance.

use super::columns::Columns;
use super::form::{Foot, Tie};
use super::line::Middle;
use super::network::{lean, middle, Aim, Network};
use crate::geom::Vec3;
use crate::num::minimax_program::MinimaxProgram;
use crate::num::parallel;
use std::collections::BTreeSet;

/// Sine of half the turn of two faces from which on the way to where their strips intersect counts as a distance.
const FAR_TURN: f64 = 0.2;
/// Share of the tolerance that a way may be there, and where faces turn farther than the next sine; both with the distance are
/// no more than what a proof leaves.
const WAYS: ([f64; 2], f64) = ([0.5, 0.69], 0.4);
/// Share of the tolerance for ways and distances together: a proof needs a little.
pub(crate) const AWAY: f64 = 0.97;
/// Distances of both strips, and ways on both.
const COUNTED: usize = 4;
/// Where strips would intersect farther away than this share of the tolerance, they are made finer until they are equally high
/// within the next share of the length of the edge.
const HARDLY: (f64, f64) = (0.5, 2e-7);
/// Edges at which differences of heights still count more than this are not looked at any more.
const HOPELESS: f64 = 0.1;
/// A difference of heights counts as a gap of this share of it over the sine of half the turn, and no more than itself: gaps end
/// below a fiftieth of the tolerance, and with it ways below a half.
const AS_GAP: f64 = 0.02;

/// What gaps count beside distances where an edge must be given up.
const BESIDE_FAR: f64 = 3.0;

/// A place at which two faces meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// Numbers of the faces on both sides.
    pub faces: [usize; 2],
    /// Labels of the strips.
    pub labels: [u32; 2],
    /// The place on either face.
    pub places: [Vec3; 2],
    /// Normals of both faces, on one side.
    pub normals: [Vec3; 2],
    /// Share of the edge that it stands for.
    pub share: f64,
    /// Number of the edge.
    pub edge: usize,
    /// Its length, mm.
    pub length: f64,
}

/// The same in networks.
#[derive(Clone, Debug)]
pub(super) struct Crossing {
    /// Networks and numbers of their samples.
    samples: [(usize, usize); 2],
    x: Vec3,
    /// Direction of heights.
    up: Vec3,
    /// Sine and cosine of half the turn of the faces.
    half_turn: (f64, f64),
    /// Whether the strips' normals look to one side.
    alike: bool,
    share: f64,
    middle: Option<Middle>,
    edge: usize,
    length: f64,
    normals: [Vec3; 2],
}

impl Crossing {
    /// What a difference of heights counts as a gap.
    fn as_gap(&self) -> f64 {
        (AS_GAP / self.half_turn.0).min(1.0)
    }
}

/// Networks of faces that meet.
#[derive(Clone)]
pub(super) struct Fleet<'a> {
    pub networks: Vec<Network<'a>>,
    crossings: Vec<Crossing>,
}

impl<'a> Fleet<'a> {
    /// One face alone.
    pub fn of(network: Network<'a>) -> Self {
        Self { networks: vec![network], crossings: Vec::new() }
    }

    /// Faces, none for those that take no part, and places at which they meet.
    pub fn meeting(networks: Vec<Option<Network<'a>>>, meetings: &[Meeting]) -> (Self, Vec<Option<usize>>) {
        let mut slots = Vec::new();
        let mut out = Self { networks: Vec::new(), crossings: Vec::new() };
        for network in networks {
            slots.push(network.is_some().then_some(out.networks.len()));
            out.networks.extend(network);
        }
        let guesses: Vec<_> = out.networks.iter().map(Network::guesses).collect();
        for m in meetings {
            let [Some(a), Some(b)] = m.faces.map(|f| slots[f]) else { continue };
            let sum = m.normals[0] + m.normals[1];
            let Some(up) = sum.try_normalize(0.0) else { continue };
            let half_turn = ((m.normals[0] - m.normals[1]).norm() * 0.5, sum.norm() * 0.5);
            let mut sample = |k: usize, of: usize| {
                let number = out.networks[of].meets_at(m.labels[k], &guesses[of], (&m.places[k], &up))?;
                Some((of, number))
            };
            let (Some(first), Some(second)) = (sample(0, a), sample(1, b)) else { continue };
            let x = (m.places[0] + m.places[1]) * 0.5;
            let (samples, &Meeting { share, edge, length, normals, .. }) = ([first, second], m);
            let mut crossing =
                Crossing { samples, x, up, half_turn, alike: true, share, middle: None, edge, length, normals };
            let feet = out.feet(&crossing).map(|f| f.normal.dot(&up) > 0.0);
            crossing.alike = feet[0] == feet[1];
            out.crossings.push(crossing);
        }
        for network in &mut out.networks {
            network.find_neighbours();
            network.find_taken();
        }
        out.crossings.retain(|c| c.samples[0].0 != c.samples[1].0);
        out.find_middles();
        (out, slots)
    }

    fn feet(&self, c: &Crossing) -> [Foot; 2] {
        c.samples.map(|(network, sample)| {
            let nowhere = Foot { t: 0.0, distance: f64::INFINITY, normal: c.up, regular: 0.0, above: false };
            self.networks[network].samples[sample].foot.unwrap_or(nowhere)
        })
    }

    /// Middles of strips where faces meet; none where there is no foot.
    fn find_middles(&mut self) {
        let networks = &self.networks;
        parallel::for_each(self.crossings.iter_mut(), |c| {
            let sides = c.samples.map(|(network, sample)| {
                let s = &networks[network].samples[sample];
                Some((&networks[network].members[s.strip], s.foot?))
            });
            let [Some((p, a)), Some((q, b))] = sides else {
                c.middle = None;
                return;
            };
            c.middle = middle([p, q], (&c.x, &c.up), [a, b]);
        });
    }

    /// A network that keeps to the middles of strips where it meets others.
    pub fn aimed(&self, network: usize) -> Network<'a> {
        let mut out = self.networks[network].clone();
        let tolerance = out.tolerance;
        let is_open =
            |c: &Crossing| c.middle.as_ref().is_none_or(|m| c.as_gap() * m.gap().abs() > HOPELESS * tolerance);
        let open: BTreeSet<usize> = self.crossings.iter().filter(|c| is_open(c)).map(|c| c.edge).collect();
        for c in self.crossings.iter().filter(|c| !open.contains(&c.edge)) {
            let sides = c.samples.iter().filter(|s| s.0 == network);
            let Some(m) = &c.middle else { continue };
            let [n, o] = m.feet.map(|f| f.normal);
            let hardly = m.gap().abs() > HARDLY.0 * tolerance * n.cross(&o).norm();
            let within = if hardly { HARDLY.1 * c.length } else { f64::INFINITY };
            out.aims.extend(sides.map(|s| Aim { sample: s.1, z: m.z, up: c.up, counts: c.as_gap(), within }));
        }
        out
    }

    /// Columns of all unknowns, by network.
    pub fn columns(&self) -> Vec<Columns> {
        let mut first = 0;
        let of = |n: &Network| {
            let columns = n.columns(first);
            first += columns.limits.len();
            columns
        };
        self.networks.iter().map(of).collect()
    }

    /// Number of strips.
    pub fn strips(&self) -> usize {
        self.networks.iter().map(|n| n.members.len()).sum()
    }

    /// Largest distance and largest gap, in tolerances.
    pub fn measured(&self) -> [f64; 2] {
        let mut out = [0.0; 2];
        for n in &self.networks {
            let [distance, gap] = n.measured();
            out = [f64::max(out[0], distance), f64::max(out[1], gap)];
        }
        for c in &self.crossings {
            let tolerance = self.networks[c.samples[0].0].tolerance;
            let gap = c.middle.as_ref().map_or(f64::INFINITY, |m| m.gap().abs());
            out[1] = f64::max(out[1], c.as_gap() * gap / tolerance);
            if c.half_turn.0 >= FAR_TURN {
                out[0] = ways(c, &self.feet(c)).iter().fold(out[0], |m, w| m.max(w.abs() / tolerance));
            }
        }
        out
    }

    /// The networks after a step; `None` where a foot is lost or a strip comes near its regression curve.
    pub fn stepped(&self, columns: &[Columns], x: &[f64]) -> Option<Self> {
        let networks: Option<Vec<Network<'a>>> =
            self.networks.iter().zip(columns).map(|(n, c)| n.stepped(c, x)).collect();
        let mut out = Self { networks: networks?, crossings: self.crossings.clone() };
        out.find_middles();
        Some(out)
    }

    /// Gives up the edge at which strips are farthest away or least equally high; whether there was one.
    pub fn leave_worst(&mut self) -> bool {
        let badness = |c: &Crossing| {
            let tolerance = self.networks[c.samples[0].0].tolerance;
            let feet = self.feet(c);
            let mut far = feet.iter().map(|f| lean(&c.up, f) * f.distance.abs()).fold(0.0, f64::max);
            if c.half_turn.0 >= FAR_TURN {
                far = ways(c, &feet).iter().fold(far, |m, w| m.max(w.abs()));
            }
            let gap = c.middle.as_ref().map_or(f64::INFINITY, |m| m.gap().abs());
            (far + BESIDE_FAR * c.as_gap() * gap) / tolerance
        };
        let worst = self.crossings.iter().map(|c| (badness(c), c.edge)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, edge)) = worst else { return false };
        for c in self.crossings.iter().filter(|c| c.edge == edge) {
            for (&(network, sample), normal) in c.samples.iter().zip(c.normals) {
                self.networks[network].samples[sample].up = Some(normal);
            }
        }
        self.crossings.retain(|c| c.edge != edge);
        true
    }

    /// After a step: where strips lie on their rulings, and what ends of panels take.
    pub fn settle(&mut self) {
        for n in &mut self.networks {
            n.lie_on_bands();
            n.find_taken();
        }
    }

    /// The rows of places at which faces meet: ways as distances, differences of heights as gaps.
    pub fn meeting_rows(&self, columns: &[Columns], weight: f64, (program, tie): (&mut MinimaxProgram, &mut Tie)) {
        for c in &self.crossings {
            let strips = c.samples.map(|(network, sample)| {
                let s = &self.networks[network].samples[sample];
                (&self.networks[network].members[s.strip], columns[network].strips[s.strip])
            });
            let tolerance = self.networks[c.samples[0].0].tolerance;
            if c.half_turn.0 >= FAR_TURN {
                let feet = self.feet(c);
                for (k, way) in ways(c, &feet).into_iter().enumerate() {
                    let shares = shares(c, k);
                    for e in 0..2 {
                        strips[e].0.strip.row(strips[e].1, &c.x, &feet[e], shares[e], &mut program.hard);
                    }
                    program.hard.end();
                    program.distances.push(way / tolerance);
                }
            }
            let Some(middle) = &c.middle else { continue };
            for (e, sign) in [1.0, -1.0].into_iter().enumerate() {
                let scale = sign * c.as_gap() / middle.feet[e].normal.dot(&c.up);
                strips[e].0.strip.row(strips[e].1, &middle.z, &middle.feet[e], scale, &mut tie.rows);
            }
            tie.end(weight * c.share, c.as_gap() * middle.gap() / tolerance);
        }
    }
}

/// What the distances of both strips count in one of what is counted.
fn shares(c: &Crossing, counted: usize) -> [f64; 2] {
    let (half_sine, half_cosine) = c.half_turn;
    let ([least, most], far) = WAYS;
    let way = least + (most - least) * ((half_sine - FAR_TURN) / (far - FAR_TURN)).clamp(0.0, 1.0);
    let distance = (1.0 - way * way).sqrt();
    let (sine, cosine) = (2.0 * half_sine * half_cosine, half_cosine * half_cosine - half_sine * half_sine);
    let sign = if c.alike { 1.0 } else { -1.0 };
    let [a, b] = match counted {
        0 => [distance.recip(), 0.0],
        1 => [0.0, distance.recip()],
        2 => [cosine / (sine * way), -1.0 / (sine * way)],
        _ => [-1.0 / (sine * way), cosine / (sine * way)],
    };
    [a / AWAY, sign * b / AWAY]
}

/// Distances and ways, mm.
fn ways(c: &Crossing, feet: &[Foot; 2]) -> [f64; COUNTED] {
    std::array::from_fn(|k| {
        let [a, b] = shares(c, k);
        a * feet[0].distance + b * feet[1].distance
    })
}
