//! Triangles of the samples' hull one after the other: what chains of rulings are made of \[W15, 5.1\].

use super::sampled::Sampled;

/// How a chain ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// At a facet.
    Facet(usize),
    /// At a triangle with two sides on one curve.
    Tip,
    /// At something else.
    Other,
    /// Where the ends of rulings on this side turn round; those on the other one may be off by so much (parameter).
    Turn { side: usize, reach: f64 },
    /// It does not.
    Closed,
}

/// Triangles in order: edges `[first side, second side]`, between them moves.
pub(super) struct Walk {
    pub(super) edges: Vec<[usize; 2]>,
    /// Side that moves, and whether along a straight piece.
    pub(super) moves: Vec<(usize, bool)>,
    pub(super) ends: [End; 2],
}

impl Walk {
    /// Whether the last edge is the first one again.
    pub(super) fn is_closed(&self) -> bool {
        self.ends[1] == End::Closed && self.edges.first() == self.edges.last()
    }

    /// Parameters of the samples at all edges of it, which on closed curves go on beyond the domain.
    pub(super) fn unwrapped(&self, sampled: &Sampled) -> Vec<[f64; 2]> {
        let at = |edge: usize| self.edges[edge].map(|i| sampled.at[i]);
        let mut out = vec![at(0).map(|p| p.parameter)];
        for k in 0..self.moves.len() {
            let (here, there, last) = (at(k), at(k + 1), out[k]);
            out.push([0, 1].map(|d| last[d] + sampled.step_between(&here[d], &there[d])));
        }
        out
    }
}
