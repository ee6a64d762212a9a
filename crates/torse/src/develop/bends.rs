//! Which rulings are drawn on a pattern, and how the sheet bends about each: sense, angle and radius.
//!
//! *Method* (docs/algorithms/panels.md, "Bend lines"). The tangent plane is followed across the rulings. Lines lie at
//! equal turns, but no nearer and no farther than asked for, and none where the sheet is flat. Where the part is to be kinked
//! on a press brake, lines are the kinks (docs/algorithms/shop.md, "Facets").

use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::{Bend, BendSense};
use crate::spline::surface::Surface;

/// How far apart rulings are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendSpacing {
    /// Turn of the sheet from one line to the next, rad; default 5°.
    pub step: f64,
    /// Distance between lines at least, as a share of the pattern's length; default 1/100.
    pub least: f64,
    /// And at most; default 1/20.
    pub greatest: f64,
    /// Kinks in place of evenly drawn lines; default none.
    pub facets: Option<Facets>,
}

/// How a curved part is kinked: every kink takes the turn of a stretch of the part in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facets {
    /// So many kinks over the turn of the part.
    Count(usize),
    /// A kink for every such turn, rad.
    Turn(f64),
    /// As many that the arcs rise no higher above the facets than so many mm.
    Chord(f64),
    /// A kink for every such length along the curved stretches, mm.
    Length(f64),
}

impl Facets {
    /// Kinks (a fraction) for a stretch of a turn (rad, not negative) and a length (mm) of a part whose whole turn is `whole`.
    pub fn needed(self, turn: f64, length: f64, whole: f64) -> f64 {
        match self {
            Self::Count(n) => n as f64 * turn / whole,
            Self::Turn(step) => turn / step,
            // An arc of radius R rises by about R θ²/8 over a chord that it turns by θ on; R is length over turn.
            Self::Chord(height) => (turn * length / (8.0 * height)).sqrt(),
            Self::Length(step) => length / step,
        }
    }
}

impl Default for BendSpacing {
    fn default() -> Self {
        Self { step: 5.0f64.to_radians(), least: 0.01, greatest: 0.05, facets: None }
    }
}

/// Lines drawn and how the sheet bends about each.
pub type Lines = (Vec<[Vec2; 2]>, Vec<Bend>);

/// Height (mm) of the arc over the facets at a kink, with the greater of its radii.
pub(crate) fn sagitta(bend: &Bend) -> f64 {
    let radius = bend.radii.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    radius * (1.0 - (0.5 * bend.angle).cos())
}

/// Draws lines; where kinks are to keep arcs low, again with more of them until they are low at both ends of all rulings: the
/// first count looks at their middles.
pub(crate) fn kept_low(spacing: &BendSpacing, draw: impl Fn(&BendSpacing) -> Lines) -> Lines {
    let Some(Facets::Chord(height)) = spacing.facets else { return draw(spacing) };
    let mut asked = height;
    let mut out = draw(spacing);
    for _ in 0..ROUNDS {
        let worst = out.1.iter().map(sagitta).fold(0.0, f64::max);
        if worst <= height {
            break;
        }
        asked *= LOWER * height / worst;
        out = draw(&BendSpacing { facets: Some(Facets::Chord(asked)), ..*spacing });
    }
    out
}

/// Times that kinks are drawn again.
const ROUNDS: usize = 4;
/// Share of what is needed that is asked for then, so that few rounds do.
const LOWER: f64 = 0.98;
/// Turn (rad) over the length of the whole pattern below which a sheet of that curvature is flat.
const FLAT: f64 = 1e-3;
/// Turn (rad) about one line, 0.05°, below which it is no bend.
const NO_BEND: f64 = 1e-3;
/// A turn within this share of the pattern's length is a fold.
const FOLD: f64 = 1e-6;
/// Whole numbers of steps may be exceeded by this share of one before another line is drawn.
const HAIR: f64 = 0.01;
/// Most lines drawn.
const MOST: f64 = 2000.0;

/// The tangent plane in a place of the sheet, as seen from the side of the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal towards the eye.
    pub normal: Vec3,
    /// Unit vector square to the ruling, onwards.
    pub across: Vec3,
}

impl Plane {
    /// The plane of a ruled patch at `(t, r)`; `side` as in [`super::map::Development::new`]. `None` where it is not
    /// regular.
    pub fn of(patch: &Surface, t: f64, r: f64, side: f64) -> Option<Self> {
        let j = patch.jet(t, r);
        let normal = (j.dv.cross(&j.du) * side).try_normalize(0.0)?;
        let along = j.dv.try_normalize(0.0)?;
        Some(Self { normal, across: (j.du - along * along.dot(&j.du)).try_normalize(0.0)? })
    }

    /// Turn of the sheet (rad) on the way to another plane; positive towards the eye.
    pub fn turn(&self, other: &Self) -> f64 {
        let angle = self.normal.angle(&other.normal);
        if (other.normal - self.normal).dot(&(self.across + other.across)) > 0.0 {
            -angle
        } else {
            angle
        }
    }
}

/// Share of the speed at the other end of a ruling below which an end stands still: the apex of a cone.
const APEX: f64 = 1e-9;

/// Radius of curvature of a ruled patch across its rulings at `(t, r)`, mm; 0 in the apex of a cone.
pub fn radius(patch: &Surface, t: f64, r: f64) -> f64 {
    let j = patch.jet(t, r);
    // In an apex nothing is left but rounding.
    if r != 0.5 && j.du.norm() <= APEX * patch.jet(t, 1.0 - r).du.norm() {
        return 0.0;
    }
    let (Some(n), Some(along)) = (j.normal().try_normalize(0.0), j.dv.try_normalize(0.0)) else { return 0.0 };
    let across = j.du - along * along.dot(&j.du);
    across.norm_squared() / n.dot(&j.duu).abs()
}

/// Places across the rulings with what lies between: turn and length since the place before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Course<K> {
    places: Vec<K>,
    turn: Vec<f64>,
    length: Vec<f64>,
}

/// A line that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Place on the course: index of the place before it, and share of the way to the next.
    pub after: usize,
    /// See `after`.
    pub share: f64,
    /// Turn of the sheet between the middles to its neighbours, rad; positive towards the eye.
    pub turn: f64,
    /// Whether the turn is a fold in this place.
    pub fold: bool,
}

impl Line {
    /// How the sheet bends, with the radii at both ends of the ruling where it is no fold.
    pub fn bend(&self, radii: [f64; 2]) -> Bend {
        let angle = self.turn.abs();
        if angle < NO_BEND {
            return Bend { sense: BendSense::Flat, angle, radii: [f64::INFINITY; 2] };
        }
        let sense = if self.turn > 0.0 { BendSense::Up } else { BendSense::Down };
        Bend { sense, angle, radii: if self.fold { [0.0; 2] } else { radii } }
    }
}

impl<K: Copy> Course<K> {
    /// Nothing yet.
    pub fn new() -> Self {
        Self { places: Vec::new(), turn: Vec::new(), length: Vec::new() }
    }

    /// Goes on to a place; turn (rad, signed) and length (mm) since the place before.
    pub fn push(&mut self, place: K, turn: f64, length: f64) {
        let (t, l) = (self.turn.last().copied(), self.length.last().copied());
        self.places.push(place);
        self.turn.push(t.map_or(0.0, |t| t + turn));
        self.length.push(l.map_or(0.0, |l| l + length));
    }

    /// The place before an index and the one after it.
    pub fn around(&self, after: usize) -> Option<[K; 2]> {
        Some([*self.places.get(after)?, *self.places.get(after + 1)?])
    }

    /// Length of the course up to a line.
    pub fn length_at(&self, line: &Line) -> f64 {
        self.at(&self.length, (line.after, line.share))
    }

    /// Length of the course.
    pub fn length(&self) -> f64 {
        self.length.last().copied().unwrap_or(0.0)
    }

    /// Lines at equal turns within the distances asked for; `size` is the length of the pattern (mm).
    pub fn lines(&self, spacing: &BendSpacing, size: f64) -> Vec<Line> {
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
        let count = (total - HAIR).ceil().clamp(1.0, MOST) as usize;
        let places: Vec<(usize, f64)> =
            (0..count).map(|k| between(&need, total * (k as f64 + 0.5) / count as f64)).collect();
        let edge = |k: usize| match k {
            0 => self.turn[0],
            k if k == count => self.turn[self.turn.len() - 1],
            k => self.at(&self.turn, between(&need, total * k as f64 / count as f64)),
        };
        places.iter().enumerate().map(|(k, &p)| self.line(p, edge(k + 1) - edge(k), size)).collect()
    }

    /// Kinks in the middles of stretches of equal need, and in every fold; none where the sheet is flat.
    fn kinks(&self, facets: Facets, size: f64) -> Vec<Line> {
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
                let kinks = (total - HAIR).ceil().clamp(1.0, MOST) as usize;
                let place = |share: f64| {
                    let (after, share) = between(&need, total * share);
                    (from + after, share)
                };
                let turned = |k: usize| self.at(&self.turn, place(k as f64 / kinks as f64));
                out.extend((0..kinks).map(|k| {
                    let at = place((k as f64 + 0.5) / kinks as f64);
                    Line { fold: false, ..self.line(at, turned(k + 1) - turned(k), size) }
                }));
            }
            from = to;
        }
        out
    }

    /// Lines at given lengths along the course.
    pub fn lines_at(&self, lengths: &[f64], size: f64) -> Vec<Line> {
        let middle = |k: usize| 0.5 * (lengths[k] + lengths[k - 1]);
        let turn = |k: usize| match k {
            0 => self.turn[0],
            k if k == lengths.len() => self.turn[self.turn.len() - 1],
            k => self.at(&self.turn, between(&self.length, middle(k))),
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

    fn line(&self, (after, share): (usize, f64), turn: f64, size: f64) -> Line {
        let own = self.turn[after + 1] - self.turn[after];
        // Most of the turn at once: an edge between facets.
        let at_once = self.length[after + 1] - self.length[after] <= FOLD * size;
        Line { after, share, turn, fold: at_once && own.abs() > 0.5 * turn.abs() }
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
    fn bent(turn: f64) -> Course<f64> {
        let mut c = Course::new();
        c.push(0.0, 0.0, 0.0);
        for k in 1..=220 {
            let x = 0.5 * k as f64;
            let inside = x > 50.0 && x <= 60.0;
            c.push(x, if inside { turn / 20.0 } else { 0.0 }, 0.5);
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
            let up = lines.iter().all(|l| l.bend([6.0; 2]).sense == BendSense::Up);
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
        let mut c = Course::new();
        for (x, turn, length) in [(0.0, 0.0, 0.0), (1.0, 0.0, 50.0), (1.0, 0.4, 0.0), (2.0, 0.0, 50.0)] {
            c.push(x, turn, length);
        }
        let lines = c.lines_at(&[50.0], 100.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].fold && (lines[0].turn - 0.4).abs() < 1e-15);
        assert_eq!(lines[0].bend([1.0; 2]).radii, [0.0; 2]);
        let kinks = c.lines(&BendSpacing { facets: Some(Facets::Count(9)), ..BendSpacing::default() }, 100.0);
        assert_eq!(kinks, lines, "a fold stays one kink");
    }
}
