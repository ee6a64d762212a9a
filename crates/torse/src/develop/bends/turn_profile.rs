//! The tangent planes of a part from one end to the other, and the lines that are drawn along it.

use super::{BendSpacing, Facets};
use crate::patchwork::pattern::{Bend, BendSense};

/// Turn (rad) over the length of the whole pattern below which a sheet of that curvature is flat.
const FLAT: f64 = 1e-3;
/// Turn (rad) about one line, 0.05°, below which it is no bend.
const NO_BEND: f64 = 1e-3;
/// A turn within this share of the pattern's length is a fold.
const FOLD: f64 = 1e-6;
/// Whole numbers of steps may be exceeded by this share of one before another line is drawn.
const HAIR: f64 = 0.01;
/// Most lines drawn.
const MOST_LINES: f64 = 2000.0;
/// Halvings after which a place is known to the last bit.
const HALVINGS: usize = 53;

/// Places across the rulings with what lies between: turn and length since the place before.
#[derive(Clone, Debug, Default)]
pub(crate) struct TurnProfile<K> {
    places: Vec<K>,
    turn: Vec<f64>,
    length: Vec<f64>,
    /// Rates of turn at both ends of every step, times the way; where they are known.
    rates: Vec<Option<[f64; 2]>>,
}

/// A line that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileLine {
    /// Place on the profile: index of the place before it, and share of the way to the next.
    pub after: usize,
    /// See `after`.
    pub share: f64,
    /// Turn of the sheet between the middles to its neighbours (rad, positive towards the eye); of a fold, its own.
    pub turn: f64,
    /// Turn of the sheet from the first ruling on, rad; of a fold, to half of it.
    pub turned: f64,
    /// Whether the turn is a fold in this place.
    pub fold: bool,
}

impl ProfileLine {
    /// Place on the profile: index and share.
    pub(crate) fn place(&self) -> f64 {
        self.after as f64 + self.share
    }

    /// How the sheet bends, with the radii at both ends of the ruling, just before it and behind it, where it is no fold.
    pub fn bend(&self, [before, radii]: [[f64; 2]; 2]) -> Bend {
        let (angle, turned) = (self.turn.abs(), self.turned);
        if angle < NO_BEND {
            return Bend { turned, ..Bend::of(BendSense::Flat, angle, [f64::INFINITY; 2]) };
        }
        let sense = if self.turn > 0.0 { BendSense::Up } else { BendSense::Down };
        if self.fold {
            return Bend { turned, ..Bend::of(sense, angle, [0.0; 2]) };
        }
        Bend { before, turned, ..Bend::of(sense, angle, radii) }
    }
}

impl<K: Copy> TurnProfile<K> {
    /// Nothing yet.
    pub fn new() -> Self {
        Self { places: Vec::new(), turn: Vec::new(), length: Vec::new(), rates: Vec::new() }
    }

    /// Goes on to a place; turn (rad, signed) and length (mm) since the place before, with the rates of turn at both ends
    /// times the way where they are known.
    pub fn push(&mut self, place: K, (turn, rates): (f64, Option<[f64; 2]>), length: f64) {
        let (t, l) = (self.turn.last().copied(), self.length.last().copied());
        self.rates.extend((!self.places.is_empty()).then_some(rates));
        self.places.push(place);
        self.turn.push(t.map_or(0.0, |t| t + turn));
        self.length.push(l.map_or(0.0, |l| l + length));
    }

    /// Turn of the sheet up to a place.
    fn turned(&self, (after, share): (usize, f64)) -> f64 {
        let (a, b) = (self.turn[after], self.turn[after + 1]);
        let Some([p, q]) = self.rates[after] else { return a + (b - a) * share };
        let (x, y) = (share, 1.0 - share);
        a * y * y * (1.0 + 2.0 * x) + b * x * x * (3.0 - 2.0 * x) + x * y * (p * y - q * x)
    }

    /// The place on a step up to which the sheet has turned by a share of the step's turn.
    fn level(&self, (after, share): (usize, f64)) -> (usize, f64) {
        let (a, b) = (self.turn[after], self.turn[after + 1]);
        if self.rates[after].is_none() || a == b {
            return (after, share);
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (self.turned((after, middle)) - a) / (b - a) < share {
                low = middle;
            } else {
                high = middle;
            }
        }
        (after, 0.5 * (low + high))
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The place before an index and the one after it.
    pub fn around(&self, after: usize) -> Option<[K; 2]> {
        Some([*self.places.get(after)?, *self.places.get(after + 1)?])
    }

    /// Length of the profile up to a line.
    pub fn length_at(&self, line: &ProfileLine) -> f64 {
        self.at(&self.length, (line.after, line.share))
    }

    /// Length of the profile.
    pub fn length(&self) -> f64 {
        self.length.last().copied().unwrap_or(0.0)
    }

    /// Lines at equal turns within the distances asked for; `size` is the length of the pattern (mm).
    pub fn lines(&self, spacing: &BendSpacing, size: f64) -> Vec<ProfileLine> {
        if let Some(facets) = spacing.facets {
            return self.kinks(facets, size);
        }
        let mut need = vec![0.0];
        for (t, l) in self.turn.windows(2).zip(self.length.windows(2)) {
            let (turn, length) = ((t[1] - t[0]).abs(), l[1] - l[0]);
            let flat = turn * size <= FLAT * length;
            let most = (length / (spacing.least * size)).max(if length <= FOLD * size { 1.0 } else { 0.0 });
            let wanted = (turn / spacing.step).max(length / (spacing.greatest * size)).min(most);
            need.push(need[need.len() - 1] + if flat { 0.0 } else { wanted });
        }
        let total = need[need.len() - 1];
        if total.is_nan() || total <= 0.0 {
            return Vec::new();
        }
        let count = (total - HAIR).ceil().clamp(1.0, MOST_LINES) as usize;
        let places: Vec<(usize, f64)> =
            (0..count).map(|k| self.level(between(&need, total * (k as f64 + 0.5) / count as f64))).collect();
        let edge = |k: usize| match k {
            0 => self.turn[0],
            k if k == count => self.turn[self.turn.len() - 1],
            k => self.turned(self.level(between(&need, total * k as f64 / count as f64))),
        };
        places.iter().enumerate().map(|(k, &p)| self.line(p, edge(k + 1) - edge(k), size)).collect()
    }

    /// Kinks in the middles of stretches of equal need, and in every fold; none where the sheet is flat.
    fn kinks(&self, facets: Facets, size: f64) -> Vec<ProfileLine> {
        let count = self.turn.len().saturating_sub(1);
        let step = |i: usize| ((self.turn[i + 1] - self.turn[i]).abs(), self.length[i + 1] - self.length[i]);
        let fold = |i: usize| step(i).1 <= FOLD * size && step(i).0 > NO_BEND;
        let curved = |i: usize| !fold(i) && step(i).0 * size > FLAT * step(i).1;
        let whole: f64 = (0..count).filter(|i| curved(*i)).map(|i| step(i).0).sum();
        let mut out = Vec::new();
        let mut from = 0;
        while from < count {
            if fold(from) {
                out.push(self.line((from, 0.5), self.turn[from + 1] - self.turn[from], size));
                from += 1;
                continue;
            }
            let to = (from..count).find(|i| fold(*i)).unwrap_or(count);
            let mut need = vec![0.0];
            for i in from..to {
                let (turn, length) = step(i);
                let more = if curved(i) { facets.needed(turn, length, whole) } else { 0.0 };
                need.push(need[need.len() - 1] + more);
            }
            let total = need[need.len() - 1];
            if total > 0.0 {
                let kinks = (total - HAIR).ceil().clamp(1.0, MOST_LINES) as usize;
                let place = |share: f64| {
                    let (after, share) = between(&need, total * share);
                    self.level((from + after, share))
                };
                let turned = |k: usize| self.turned(place(k as f64 / kinks as f64));
                out.extend((0..kinks).map(|k| {
                    let at = place((k as f64 + 0.5) / kinks as f64);
                    ProfileLine { fold: false, ..self.line(at, turned(k + 1) - turned(k), size) }
                }));
            }
            from = to;
        }
        out
    }

    /// Lines at given lengths along the profile.
    pub fn lines_at(&self, lengths: &[f64], size: f64) -> Vec<ProfileLine> {
        let middle = |k: usize| 0.5 * (lengths[k] + lengths[k - 1]);
        let turn = |k: usize| match k {
            0 => self.turn[0],
            k if k == lengths.len() => self.turn[self.turn.len() - 1],
            k => self.turned(between(&self.length, middle(k))),
        };
        let place = |l: f64| {
            let (after, share) = between(&self.length, l);
            // A length in which the sheet folds is both the end of one stretch and the start of the next.
            let folds = after + 2 < self.length.len() && self.length[after + 2] - l <= FOLD * size;
            if folds && self.length[after + 1] - l <= FOLD * size {
                (after + 1, 0.5)
            } else {
                (after, share)
            }
        };
        lengths.iter().enumerate().map(|(k, &l)| self.line(place(l), turn(k + 1) - turn(k), size)).collect()
    }

    /// Length between two places of the profile.
    pub(super) fn length_between(&self, ends: [f64; 2]) -> f64 {
        let [a, b] = ends.map(|x| self.at(&self.length, self.split(x)));
        (b - a).abs()
    }

    /// Turn of the sheet between two lines, without their folds.
    pub(super) fn turn_between(&self, a: &ProfileLine, b: &ProfileLine) -> f64 {
        let half = |l: &ProfileLine| if l.fold { 0.5 * l.turn } else { 0.0 };
        b.turned - a.turned - half(a) - half(b)
    }

    /// An end of the profile as if there were a line.
    pub(super) fn end(&self, last: bool) -> ProfileLine {
        self.bare(if last { (self.places.len() - 2, 1.0) } else { (0, 0.0) })
    }

    /// A line half way between two places; its turn is found by [`TurnProfile::parted`].
    pub(super) fn halfway(&self, [a, b]: [f64; 2]) -> ProfileLine {
        self.bare(self.split(0.5 * (a + b)))
    }

    /// A line within a step, such as one from a piece of the part to the next; its turn is found by [`TurnProfile::parted`].
    pub(crate) fn within(&self, step: usize) -> ProfileLine {
        self.bare((step, 0.5))
    }

    fn bare(&self, (after, share): (usize, f64)) -> ProfileLine {
        ProfileLine { after, share, turn: 0.0, turned: self.turned((after, share)), fold: false }
    }

    /// A place as the index before it and a share.
    fn split(&self, x: f64) -> (usize, f64) {
        let after = (x as usize).min(self.places.len() - 2);
        (after, x - after as f64)
    }

    /// Lines in their order that share the turn: each has that from half way after the line before to half way to the next.
    pub(crate) fn parted(&self, lines: Vec<ProfileLine>, size: f64) -> Vec<ProfileLine> {
        let lengths: Vec<f64> = lines.iter().map(|l| self.length_at(l)).collect();
        let edge = |k: usize| match k {
            0 => self.turn[0],
            k if k == lengths.len() => self.turn[self.turn.len() - 1],
            // Between lines that lie in one step without length, half way is there.
            k if lines[k].after == lines[k - 1].after => 0.5 * (lines[k].turned + lines[k - 1].turned),
            k => self.turned(between(&self.length, 0.5 * (lengths[k - 1] + lengths[k]))),
        };
        lines.iter().enumerate().map(|(k, l)| self.line((l.after, l.share), edge(k + 1) - edge(k), size)).collect()
    }

    fn line(&self, (after, share): (usize, f64), turn: f64, size: f64) -> ProfileLine {
        let own = self.turn[after + 1] - self.turn[after];
        // Most of the turn at once: an edge between facets.
        let at_once = self.length[after + 1] - self.length[after] <= FOLD * size;
        if at_once && own.abs() > 0.5 * turn.abs() {
            return ProfileLine { after, share, turn: own, turned: self.turn[after] + 0.5 * own, fold: true };
        }
        ProfileLine { after, share, turn, turned: self.turned((after, share)), fold: false }
    }

    fn at(&self, values: &[f64], (after, share): (usize, f64)) -> f64 {
        values[after] + (values[after + 1] - values[after]) * share
    }
}

/// Index before a value among increasing ones and the share of the way to the next.
fn between(values: &[f64], value: f64) -> (usize, f64) {
    let k = values.partition_point(|&x| x < value).clamp(1, values.len() - 1);
    let step = values[k] - values[k - 1];
    (k - 1, if step > 0.0 { ((value - values[k - 1]) / step).clamp(0.0, 1.0) } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat stretch, a bend through `turn` on 10 mm, a flat stretch; 110 mm long.
    fn bent(turn: f64) -> TurnProfile<f64> {
        let mut c = TurnProfile::new();
        c.push(0.0, (0.0, None), 0.0);
        for k in 1..=220 {
            let x = 0.5 * k as f64;
            let inside = x > 50.0 && x <= 60.0;
            c.push(x, (if inside { turn / 20.0 } else { 0.0 }, None), 0.5);
        }
        c
    }

    #[test]
    fn bend_lines_lie_in_the_bend_alone_and_their_angles_add_up() {
        for turn in [1.5, -1.5] {
            let c = bent(turn);
            let lines = c.lines(&BendSpacing { least: 0.001, ..BendSpacing::default() }, 110.0);
            assert_eq!(lines.len(), 18);
            assert!(lines.iter().all(|l| (100..120).contains(&l.after)));
            let sum: f64 = lines.iter().map(|l| l.turn).sum();
            assert!((sum - turn).abs() < 1e-12);
            let up = lines.iter().all(|l| l.bend([[6.0; 2]; 2]).sense == BendSense::Up);
            assert_eq!(up, turn > 0.0);
            // No nearer than 1/100 of 110 mm: nine or ten lines on 10 mm.
            assert!((9..=10).contains(&c.lines(&BendSpacing::default(), 110.0).len()));
        }
        assert!(bent(0.0).lines(&BendSpacing::default(), 110.0).is_empty());
    }

    #[test]
    fn kinks_are_as_many_as_asked_for_and_take_the_whole_turn() {
        // 90 degrees on 10 mm: the radius is 6.366 mm.
        let turn = std::f64::consts::FRAC_PI_2;
        let c = bent(turn);
        let radius = 10.0 / turn;
        let kinks = |facets| c.lines(&BendSpacing { facets: Some(facets), ..BendSpacing::default() }, 110.0);
        let step = (8.0 * 0.05 / radius).sqrt();
        let many = |x: f64| x.ceil() as usize;
        for (facets, count) in [
            (Facets::Count(7), 7),
            (Facets::Turn(turn / 4.0), 4),
            (Facets::Chord(0.05), many(turn / step)),
            (Facets::Length(3.0), 4),
        ] {
            let found = kinks(facets);
            assert_eq!(found.len(), count, "{facets:?}");
            assert!((found.iter().map(|l| l.turn).sum::<f64>() - turn).abs() < 1e-12);
            assert!(found.iter().all(|l| (l.turn - turn / count as f64).abs() < 1e-9 && !l.fold));
            // The first kink stands in the middle of the first stretch.
            assert!((c.length_at(&found[0]) - (50.0 + 5.0 / count as f64)).abs() < 1e-9);
        }
        assert!(bent(0.0)
            .lines(&BendSpacing { facets: Some(Facets::Count(3)), ..BendSpacing::default() }, 110.0)
            .is_empty());
    }

    #[test]
    fn facets_fold_in_their_common_edge() {
        let mut c = TurnProfile::new();
        for (x, turn, length) in [(0.0, 0.0, 0.0), (1.0, 0.0, 50.0), (1.0, 0.4, 0.0), (2.0, 0.0, 50.0)] {
            c.push(x, (turn, None), length);
        }
        let lines = c.lines_at(&[50.0], 100.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].fold && (lines[0].turn - 0.4).abs() < 1e-15);
        assert_eq!(lines[0].bend([[1.0; 2]; 2]).radii, [0.0; 2]);
        let kinks = c.lines(&BendSpacing { facets: Some(Facets::Count(9)), ..BendSpacing::default() }, 100.0);
        assert_eq!(kinks, lines, "a fold stays one kink");
    }
}
