//! Runs of rulings between two rails with coplanar tangents \[W15, 4B\].

use super::track::Track;

/// Type of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchType {
    /// Twist 0: the regression point lies outside the ruling.
    Regular,
    /// Twist π: the regression point lies between the rails.
    DoubleCone,
}

/// Direction in which the second rail is followed when the first is followed forwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Forwards.
    Same,
    /// Backwards.
    Opposite,
}

/// A run of rulings with coplanar tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Parameters on both tracks, the first not decreasing; beyond the end on closed tracks.
    pub stations: Vec<[f64; 2]>,
    /// Type.
    pub kind: BranchType,
    /// Direction on the second rail.
    pub direction: Direction,
    /// Whether the run closes after going round both rails.
    pub closed: bool,
    /// Shares of the rails' lengths that the run uses.
    pub coverage: [f64; 2],
}

impl Branch {
    /// What the best has most of: coverage of the rail that is used less, then of the other.
    pub(super) fn merit(&self) -> f64 {
        self.coverage[0].min(self.coverage[1]) + 0.01 * self.coverage[0].max(self.coverage[1])
    }
}

/// Share of a track's length between two parameters, at most 1.
pub(crate) fn used_share(t: &Track, x0: f64, x1: f64) -> f64 {
    let total = t.length();
    if x1 - x0 >= t.end() {
        return 1.0;
    }
    let at = |x: f64| {
        let turns = if t.rail.closed { (x / t.end()).floor() } else { 0.0 };
        let rest = x - turns * t.end();
        turns * total + t.length_to(rest)
    };
    ((at(x1) - at(x0)) / total).clamp(0.0, 1.0)
}
