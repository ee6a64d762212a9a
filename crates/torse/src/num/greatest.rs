//! A bound of the greatest value of a function of one variable from bounds over pieces (branch and bound; Moore, Kearfott
//! and Cloud, ch. 5).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Halvings of a piece at most.
const DEPTH: usize = 10;
/// Pieces looked at after which no more are halved, and that as a multiple of those at first: enclosures that do not narrow
/// would be halved everywhere. Curves of 900 pieces stay ten times above what they reach with twice as many.
const MOST_PIECES: (usize, usize) = (2048, 16);

/// Bound of the greatest value of a function between the first and the last of some cuts, within `excess` of what it
/// reaches or as near as halving can bring it. `piece` bounds it between two places, and at these places; `None` where
/// it cannot, or where the bound is not finite.
///
/// The piece with the greatest bound is halved first: what is left when no more pieces are looked at is the bound of the
/// one that needs it most.
pub fn greatest(mut cuts: Vec<f64>, excess: f64, piece: impl Fn(f64, f64) -> Option<(f64, f64)>) -> Option<f64> {
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|x, y| x.to_bits() == y.to_bits());
    let mut open = BinaryHeap::with_capacity(2 * cuts.len());
    let mut seen = 0.0f64;
    let mut looks = 0;
    // Pieces still to be looked at, with the halvings that made them.
    let mut next: Vec<([f64; 2], usize)> = cuts.windows(2).map(|w| ([w[0], w[1]], 0)).collect();
    let most = MOST_PIECES.0.max(MOST_PIECES.1 * next.len());
    loop {
        looks += next.len();
        for (ends, depth) in next.drain(..) {
            let found = piece(ends[0], ends[1]).filter(|f| f.0.is_finite() && f.1.is_finite());
            seen = found.map_or(seen, |(_, reached)| seen.max(reached));
            open.push(Bounded { bound: found.map_or(f64::INFINITY, |(all, _)| all), ends, depth });
        }
        let Some(Bounded { bound, ends: [a, b], depth }) = open.pop() else { return Some(0.0) };
        let m = 0.5 * (a + b);
        if bound <= seen + excess || depth >= DEPTH || looks >= most || !(a < m && m < b) {
            return bound.is_finite().then_some(bound.max(0.0));
        }
        next.extend([([a, m], depth + 1), ([m, b], depth + 1)]);
    }
}

/// A piece between two places, ordered by the bound over it.
struct Bounded {
    bound: f64,
    ends: [f64; 2],
    depth: usize,
}

impl Ord for Bounded {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Bounded {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Bounded {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Bounded {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// x(1 − x) with an enclosure that is too wide by a multiple of the piece's length.
    fn hill(slack: f64, looks: &Cell<usize>) -> impl Fn(f64, f64) -> Option<(f64, f64)> + '_ {
        move |a, b| {
            looks.set(looks.get() + 1);
            let f = |x: f64| x * (1.0 - x);
            let top = if a <= 0.5 && b >= 0.5 { 0.25 } else { f(a).max(f(b)) };
            Some((top + slack * (b - a), f(a).max(f(b))))
        }
    }

    #[test]
    fn the_bound_is_one_and_as_near_as_was_asked() {
        let looks = Cell::new(0);
        let bound = greatest(vec![0.0, 0.3, 1.0], 1e-2, hill(2.0, &looks)).expect("a bound");
        assert!((0.25..=0.26).contains(&bound), "{bound}");
        assert!(looks.get() < 200, "{}", looks.get());
    }

    #[test]
    fn many_pieces_leave_the_worst_one_halved() {
        // As many pieces as are looked at would not do for halving all of them even twice.
        let cuts: Vec<f64> = (0..=600).map(|k| f64::from(k) / 600.0).collect();
        let wide =
            |a: f64, b: f64| Some((if a < 0.2512 && b > 0.2512 { 1.0 + 9000.0 * (b - a) } else { 1.0 + (b - a) }, 1.0));
        let bound = greatest(cuts, 1e-4, wide).expect("a bound");
        assert!(bound < 1.1, "{bound}");
    }

    #[test]
    fn many_pieces_at_first_get_as_many_looks_each() {
        let cuts = (0..=1500).map(|i| f64::from(i) / 1500.0).collect();
        // Every piece is to be halved three times.
        let wide = |a: f64, b: f64| Some((1.0 + 1500.0 * (b - a), 1.0));
        let bound = greatest(cuts, 0.13, wide).expect("a bound");
        assert!(bound <= 1.13, "{bound}");
    }

    #[test]
    fn what_cannot_be_bounded_has_no_bound() {
        assert_eq!(greatest(vec![0.0, 1.0], 1e-3, |a, _| (a > 0.0).then_some((1.0, 1.0))), None);
        assert_eq!(greatest(vec![0.0, 1.0], 1e-3, |_, _| Some((f64::NAN, 0.0))), None);
    }
}
