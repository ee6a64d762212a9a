//! The fewest chords, end to end, that keep within a distance of a plane curve.
//!
//! *Method*. Corners lie on normals of the curve, at places dense enough and at a few heights up to the distance. From each of them the
//! lines that pass by all places up to another one within the distance are a wedge of directions, which grows narrower from place to
//! place \[II88\]; the fewest chords are a shortest way from corner to corner. On an arc of a circle of radius R chords of
//! the length 4√(Rε) with ends ε outside are found, as long as those of strips each for itself; where the curve inflects,
//! chords begin on one side of it and end on the other.

use crate::geom::Vec2;

/// Heights of corners, as shares of the distance.
const HEIGHTS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// The height of places on the curve itself.
const ON_CURVE: usize = 2;
/// Halvings of the range in which the least distance is looked for.
const HALVINGS: usize = 12;
/// Slope of chords against the curve where they begin, at most.
const STEEPEST: f64 = 2.5;

/// A place of a plane curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The point, mm.
    pub point: Vec2,
    /// The direction in which a corner may be off it.
    pub normal: Vec2,
}

/// Chords end to end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chords {
    /// The places of their corners, and these.
    pub corners: Vec<(usize, Vec2)>,
    /// Distance (mm) within which they keep to all places.
    pub distance: f64,
}

impl Chords {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.corners.len() - 1
    }
}

/// Which ends of chords lie on the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ends {
    /// Those that must.
    pub held: [bool; 2],
    /// Those that better do, where that takes no more chords; all of them do then, if that takes no more either.
    pub rims: [bool; 2],
}

/// Heights that corners may have at an end.
type Heights = [bool; HEIGHTS.len()];

/// The fewest chords along a curve, given by its places in order, within a `distance` (mm), and as near as so many can be. Curves
/// that close have chords that close. `None` where no chord leads on.
pub(crate) fn fewest_chords(curve: &[Place], ends: Ends, distance: f64) -> Option<Chords> {
    let (first, last) = (curve.first()?, curve.last()?);
    let on_curve = |held: [bool; 2]| held.map(|held| std::array::from_fn(|h| !held || h == ON_CURVE));
    let alike = |h: usize| [std::array::from_fn(|k| k == h); 2];
    let wishes: Vec<Vec<[Heights; 2]>> = if first.point == last.point && ends.held == [false; 2] {
        vec![(0..HEIGHTS.len()).map(alike).collect()]
    } else {
        let rims = [0, 1].map(|k: usize| ends.held[k] || ends.rims[k]);
        [[true; 2], rims, ends.held].map(|held| vec![on_curve(held)]).into()
    };
    let among = |wish: &[[Heights; 2]], distance: f64| {
        wish.iter().filter_map(|heights| chords(curve, heights, distance)).min_by_key(Chords::count)
    };
    let found: Vec<Option<Chords>> = wishes.iter().map(|wish| among(wish, distance)).collect();
    let count = found.iter().flatten().map(Chords::count).min()?;
    let (wish, best) = wishes.iter().zip(found).find(|w| w.1.as_ref().is_some_and(|c| c.count() == count))?;
    let (mut best, mut low, mut high) = (best?, 0.0, distance);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match among(wish, middle).filter(|c| c.count() == count) {
            Some(found) => (best, high) = (found, middle),
            None => low = middle,
        }
    }
    Some(best)
}

/// How many chords lead to a corner at least, and place and height of the one where the last of them begins.
type Way = Option<(usize, [usize; 2])>;

/// The fewest chords within a distance, with some heights at their ends.
fn chords(curve: &[Place], ends: &[Heights; 2], distance: f64) -> Option<Chords> {
    let last = curve.len().checked_sub(1)?;
    let corner = |i: usize, h: usize| curve[i].point + curve[i].normal * (HEIGHTS[h] * distance);
    let may_be = |i: usize, h: usize| match i {
        0 => ends[0][h],
        _ => i < last || ends[1][h],
    };
    // Chords up to every corner, and where the last of them began.
    let mut ways: Vec<[Way; HEIGHTS.len()]> = vec![[None; HEIGHTS.len()]; curve.len()];
    for h in (0..HEIGHTS.len()).filter(|&h| may_be(0, h)) {
        ways[0][h] = Some((0, [0, h]));
    }
    for i in 0..last {
        for h in 0..HEIGHTS.len() {
            let Some((count, _)) = ways[i][h] else { continue };
            let from = corner(i, h);
            let mut wedge = Wedge::new(curve[i + 1].point - curve[i].point);
            for j in i + 1..=last {
                for to in (0..HEIGHTS.len()).filter(|&to| may_be(j, to)) {
                    let is_shorter = ways[j][to].is_none_or(|w| count + 1 < w.0);
                    if is_shorter && wedge.holds(corner(j, to) - from) {
                        ways[j][to] = Some((count + 1, [i, h]));
                    }
                }
                if !wedge.narrowed(curve[j].point - from, distance) {
                    break;
                }
            }
        }
    }
    let end = (0..HEIGHTS.len()).filter_map(|h| Some((ways[last][h]?.0, h))).min()?.1;
    let mut out = vec![(last, corner(last, end))];
    let mut at = [last, end];
    while at[0] > 0 {
        at = ways[at[0]][at[1]]?.1;
        out.push((at[0], corner(at[0], at[1])));
    }
    out.reverse();
    Some(Chords { corners: out, distance })
}

/// Directions of lines through a point, as slopes against one of them.
struct Wedge {
    ahead: Vec2,
    low: f64,
    high: f64,
}

impl Wedge {
    fn new(ahead: Vec2) -> Self {
        Self { ahead: ahead / ahead.norm(), low: -STEEPEST, high: STEEPEST }
    }

    /// A way along the direction and to its left.
    fn seen(&self, way: Vec2) -> [f64; 2] {
        [self.ahead.dot(&way), self.ahead.perp(&way)]
    }

    fn holds(&self, way: Vec2) -> bool {
        let [along, left] = self.seen(way);
        self.low * along <= left && left <= self.high * along
    }

    /// Leaves directions that pass by a place, seen from the point, within a distance; whether there are any. Slopes m with
    /// |left − m along| ≤ distance √(1 + m²).
    fn narrowed(&mut self, place: Vec2, distance: f64) -> bool {
        let [along, left] = self.seen(place);
        let beyond = along * along + left * left - distance * distance;
        if beyond > 0.0 {
            let (leading, root) = (along * along - distance * distance, distance * beyond.sqrt());
            let [a, b] = [(left * along - root) / leading, (left * along + root) / leading];
            if leading > 0.0 {
                self.low = self.low.max(a);
                self.high = self.high.min(b);
            } else if left > 0.0 {
                // Beside the point, not ahead of it: on one side only.
                self.low = self.low.max(a.max(b));
            } else {
                self.high = self.high.min(a.min(b));
            }
        }
        self.low <= self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const FREE: Ends = Ends { held: [false; 2], rims: [true; 2] };

    /// A curve given by its point, with corners square to it.
    fn places(count: usize, at: impl Fn(f64) -> Vec2) -> Vec<Place> {
        let place = |k: usize| {
            let t = k as f64 / count as f64;
            let d = at(t + 1e-6) - at(t - 1e-6);
            Place { point: at(t), normal: Vec2::new(-d.y, d.x).normalize() }
        };
        (0..=count).map(place).collect()
    }

    /// Largest distance of a place from the chord over it.
    fn farthest(curve: &[Place], chords: &Chords) -> f64 {
        let of = |w: &[(usize, Vec2)]| {
            let along = (w[1].1 - w[0].1).normalize();
            curve[w[0].0..=w[1].0].iter().map(|p| along.perp(&(p.point - w[0].1)).abs()).fold(0.0, f64::max)
        };
        chords.corners.windows(2).map(of).fold(0.0, f64::max)
    }

    #[test]
    fn arcs_take_as_many_chords_as_strips() {
        // Half a circle of radius 500: chords within 1 mm are 4 √500 = 89.4 mm long, 17.6 of them.
        let arc = places(2000, |t| 500.0 * Vec2::new((PI * t).cos(), (PI * t).sin()));
        let chords = fewest_chords(&arc, FREE, 1.0).expect("chords");
        assert_eq!(chords.count(), 18);
        let far = farthest(&arc, &chords);
        assert!(far <= 1.0 && far > 0.9, "{far}");
        // There is enough to spare for both ends on the arc.
        assert_eq!(chords.corners[0].1, arc[0].point);
    }

    #[test]
    fn waves_are_crossed() {
        let wave = places(1500, |t| Vec2::new(1000.0 * t, 30.0 * (12.0 * t).sin()));
        let chords = fewest_chords(&wave, FREE, 3.0).expect("chords");
        let far = farthest(&wave, &chords);
        assert!(far <= 3.0 + 1e-9, "{far}");
        // Theory: ∫√κ ds / (4√ε) = 7.6, and a few for inflections.
        assert!((7..=10).contains(&chords.count()), "{}", chords.count());
        // With both ends on the wave it may take one more.
        let held = fewest_chords(&wave, Ends { held: [true; 2], rims: [false; 2] }, 3.0).expect("chords");
        assert!((0..=1).contains(&(held.count() - chords.count())));
        assert_eq!((held.corners[0].1, held.corners[held.count()].1), (wave[0].point, wave[1500].point));
        // A distance that takes all of it in one.
        assert_eq!(fewest_chords(&wave, FREE, 40.0).expect("a chord").count(), 1);
    }

    #[test]
    fn chords_of_closed_curves_close() {
        let mut ring = places(3000, |t| {
            let angle = TAU * t;
            Vec2::new(500.0 + 150.0 * angle.cos(), 150.0 * angle.sin())
        });
        ring[3000].point = ring[0].point;
        let chords = fewest_chords(&ring, FREE, 5.0).expect("chords");
        // Regular: r within ε of both circles about it has n sides if cos(π/n) ≥ (150 − 5)/(150 + 5).
        assert_eq!(chords.count(), 9);
        assert!((chords.corners[0].1 - chords.corners[9].1).norm() < 1e-9);
        let far = farthest(&ring, &chords);
        assert!(far < 4.75 && far > 4.5, "{far}");
    }
}
