//! Which vertices of a drawn contour stand for the ends of the runs of a flat border, and where the drawing shows it.
//!
//! Numbers only: nothing here is relied upon, any answer is good for the proof. Drawings begin with the border's first
//! run; vertices are sought near the same shares of the whole length (Kabsch in the plane for the motion).

use super::outline::{arc_length, Image, Motion};
use crate::patchwork::pattern::{Contour, ContourVertex};

/// Share of the whole length within which the vertex of the end of a run is sought.
const WINDOW: f64 = 0.02;

/// Samples on every smooth piece of a run.
const SAMPLES: usize = 6;

/// Distances that differ by less than this share of the whole length are the same up to rounding.
const SAME: f64 = 1e-9;

/// A closed border in a plane of its own, sampled.
pub(super) struct Walk {
    /// For every run its parameters and places.
    pub runs: Vec<Vec<(f64, [f64; 2])>>,
    /// Lengths up to the beginning of every run, and in all.
    starts: Vec<f64>,
}

impl Walk {
    /// Walks along runs that follow each other and close up; their images must not be moved.
    pub fn new(images: &[Image]) -> Option<Self> {
        let (mut runs, mut starts, mut length) = (Vec::with_capacity(images.len()), vec![0.0], 0.0);
        for image in images {
            let breaks = image.trim.knots.breaks();
            let mut own = vec![(breaks[0], image.place(breaks[0])?)];
            for w in breaks.windows(2) {
                for k in 1..=SAMPLES {
                    let s = w[0] + (w[1] - w[0]) * k as f64 / SAMPLES as f64;
                    let (p, q) = (image.place(s)?, own[own.len() - 1].1);
                    length += (p[0] - q[0]).hypot(p[1] - q[1]);
                    own.push((s, p));
                }
            }
            runs.push(own);
            starts.push(length);
        }
        (length > 0.0 && length.is_finite()).then_some(Self { runs, starts })
    }

    fn total(&self) -> f64 {
        self.starts[self.starts.len() - 1]
    }

    /// Twice the area inside, positive where the border runs counter-clockwise.
    pub fn turn(&self) -> f64 {
        let all: Vec<[f64; 2]> = self.runs.iter().flatten().map(|s| s.1).collect();
        let o = all[0];
        let cross = |p: &[f64; 2], q: &[f64; 2]| (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
        (0..all.len()).map(|k| cross(&all[k], &all[(k + 1) % all.len()])).sum()
    }

    /// Place at a share of the whole length.
    fn at(&self, share: f64) -> [f64; 2] {
        let length = share * self.total();
        let i = self.starts.partition_point(|s| *s <= length).clamp(1, self.runs.len()) - 1;
        let run = &self.runs[i];
        let mut left = length - self.starts[i];
        for w in run.windows(2) {
            let (p, q) = (w[0].1, w[1].1);
            let step = (q[0] - p[0]).hypot(q[1] - p[1]);
            if left <= step && step > 0.0 {
                let f = (left / step).max(0.0);
                return [p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1])];
            }
            left -= step;
        }
        run[run.len() - 1].1
    }
}

/// The vertices that stand for each run of a border, ends included.
pub(super) struct Matched {
    pub chains: Vec<Vec<ContourVertex>>,
    /// Largest distance of a vertex from the end of a run that it stands for.
    pub off: f64,
}

/// Where a contour that runs the same way shows a border, and how far it is off; `flip` −1 for the border seen from the
/// other side.
pub(super) fn motion_of(walk: &Walk, contour: &[ContourVertex], flip: f64) -> Option<(Motion, f64)> {
    let drawn = Drawn::new(contour);
    let n = drawn.vertices.len() - 1;
    let pairs: Vec<_> = (0..n).map(|i| (flipped(walk.at(drawn.share(i)), flip), place(&drawn.vertices[i]))).collect();
    let rough = Motion::between(&pairs)?;
    let starts: Vec<[f64; 2]> = walk.runs.iter().map(|r| flipped(r[0].1, flip)).collect();
    let pairs_of = |motion: &Motion| -> Option<Vec<([f64; 2], [f64; 2])>> {
        let ends = drawn.ends(walk, &starts, motion)?;
        Some(starts.iter().zip(&ends).map(|(p, &i)| (*p, place(&drawn.vertices[i]))).collect())
    };
    let pairs = pairs_of(&rough)?;
    // Few ends of runs say less than all of the contour.
    let motion = if pairs.len() < FEWEST_ENDS { rough } else { Motion::between(&pairs)? };
    Some((motion, farthest(&motion, &pairs)))
}

/// Lays a border on a contour that runs the same way, with a known motion.
pub(super) fn laid_on(walk: &Walk, contour: &[ContourVertex], motion: &Motion) -> Option<Matched> {
    let drawn = Drawn::new(contour);
    let starts: Vec<[f64; 2]> = walk.runs.iter().map(|r| r[0].1).collect();
    let mut ends = drawn.ends(walk, &starts, motion)?;
    let pairs: Vec<_> = starts.iter().zip(&ends).map(|(p, &i)| (*p, place(&drawn.vertices[i]))).collect();
    ends.push(drawn.vertices.len() - 1);
    let chains = ends.windows(2).map(|w| drawn.vertices[w[0]..=w[1]].to_vec()).collect();
    Some(Matched { chains, off: farthest(motion, &pairs) })
}

/// Ends of runs from which on a motion follows from them.
const FEWEST_ENDS: usize = 3;

fn flipped(p: [f64; 2], flip: f64) -> [f64; 2] {
    [p[0], flip * p[1]]
}

fn place(v: &ContourVertex) -> [f64; 2] {
    [v.point.x, v.point.y]
}

fn farthest(motion: &Motion, pairs: &[([f64; 2], [f64; 2])]) -> f64 {
    let far = |(p, q): &([f64; 2], [f64; 2])| {
        let p = motion.about(p);
        (p[0] - q[0]).hypot(p[1] - q[1])
    };
    pairs.iter().map(far).fold(0.0, f64::max)
}

/// A contour with its first vertex again at the end.
struct Drawn {
    vertices: Vec<ContourVertex>,
    lengths: Vec<f64>,
}

impl Drawn {
    fn new(contour: &[ContourVertex]) -> Self {
        // Lines without length are none.
        let mut vertices: Vec<ContourVertex> = Vec::with_capacity(contour.len() + 1);
        for v in contour {
            match vertices.last_mut() {
                Some(last) if last.bulge == 0.0 && last.point == v.point => *last = *v,
                _ => vertices.push(*v),
            }
        }
        vertices.extend(contour.first().copied());
        let mut lengths = vec![0.0];
        for w in vertices.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + arc_length(place(&w[0]), place(&w[1]), w[0].bulge));
        }
        Self { vertices, lengths }
    }

    fn whole(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    fn share(&self, vertex: usize) -> f64 {
        self.lengths[vertex] / self.whole()
    }

    /// The vertex at which each run begins, not decreasing from 0.
    fn ends(&self, walk: &Walk, starts: &[[f64; 2]], motion: &Motion) -> Option<Vec<usize>> {
        let (n, whole) = (self.vertices.len() - 1, self.whole());
        let mut ends = vec![0];
        for (j, start) in starts.iter().enumerate().skip(1) {
            let (p, share) = (motion.about(start), walk.starts[j] / walk.total());
            let from = self.lengths.partition_point(|l| *l < (share - WINDOW) * whole).max(ends[j - 1]);
            let to = self.lengths.partition_point(|l| *l <= (share + WINDOW) * whole).min(n + 1).max(from + 1);
            let far = |i: usize| (self.vertices[i].point.x - p[0]).hypot(self.vertices[i].point.y - p[1]);
            let least = (from..to).map(far).fold(f64::INFINITY, f64::min);
            let same = |i: &usize| far(*i) <= least + SAME * whole;
            let first = (from..to).find(|i| same(i) && *i > ends[j - 1]).or_else(|| (from..to).find(same))?;
            ends.push(first);
        }
        Some(ends)
    }
}

/// The same chain the other way round.
pub(super) fn backwards(chain: &[ContourVertex]) -> Vec<ContourVertex> {
    let n = chain.len();
    (0..n)
        .map(|k| {
            let bulge = if k + 1 < n { -chain[n - 2 - k].bulge } else { 0.0 };
            ContourVertex { bulge, ..chain[n - 1 - k] }
        })
        .collect()
}

/// The vertices of a contour from the first one on, the other way round if asked for.
pub(super) fn directed(contour: &Contour, backwards: bool) -> Vec<ContourVertex> {
    let (v, n) = (&contour.vertices, contour.vertices.len());
    if !backwards {
        return v.clone();
    }
    (0..n).map(|k| ContourVertex { bulge: -v[(2 * n - k - 1) % n].bulge, ..v[(n - k) % n] }).collect()
}
