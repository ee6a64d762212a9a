//! More lines where the sheet bends so unevenly that the part could not be bent back from those that there are.
//!
//! *Method*. Between two lines the sheet is laid as who bends it back will lay it (`develop::between`), from the one ruling to
//! the other, whose true places in space are known. What is left there, as a turn and a move, is carried on to all that
//! follows: the turn by half the size of the part. Where all of this is more than asked for, the stretches that leave most
//! get a line in their middle, again and again; the error of the cubic between two lines falls with the fourth power of
//! their distance (docs/algorithms/refold.md).
//! *Not guaranteed*: any distance. What comes of the lines is proven when the part is bent back.

use super::turn_profile::{ProfileLine, TurnProfile};
use super::BendSpacing;
use crate::develop::between::{Between, LineSide};
use crate::geom::{Vec2, Vec3};
use crate::torse::ribbon::pose::{Pose, Rates};
use nalgebra::Matrix3;

/// A ruling of a part with its development: in the plane and in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DevelopedRuling {
    /// Ends in the plane.
    pub flat: [Vec2; 2],
    /// Ends in space.
    pub space: [Vec3; 2],
    /// Unit vector across it in the sheet, onwards.
    pub across: Vec3,
    /// Unit normal towards the eye.
    pub normal: Vec3,
    /// Radii of the sheet at both ends, mm.
    pub radii: [f64; 2],
}

/// A ruling at a place of a profile; `true` for what lies behind it where two pieces join.
pub(crate) type Exact<'a> = dyn Fn(&ProfileLine, bool) -> Option<DevelopedRuling> + 'a;

/// Rounds of new lines at most: each halves stretches.
const ROUNDS: usize = 8;
/// Lines are no nearer than this share of the least distance for evenly drawn ones.
const NEARER: f64 = 0.2;
/// Lines of a part at most.
const MOST_LINES: usize = 400;
/// Steps in which a stretch is laid.
const STEPS: usize = 12;
/// Stretches that leave less than this share of an even part of what is allowed stay as they are.
const EVEN: f64 = 0.5;
/// Steps towards the place beyond the last line at which a part ends.
const NEWTON: usize = 6;
/// How many stretches beyond the last line a part may end.
const BEYOND: f64 = 4.0;

/// Lines with those that are needed between them.
pub(crate) fn dense<K: Copy>(
    profile: &TurnProfile<K>,
    mut lines: Vec<ProfileLine>,
    spacing: &BendSpacing,
    size: f64,
    exact: &Exact,
) -> Vec<ProfileLine> {
    if !spacing.within.is_finite() || spacing.facets.is_some() || lines.is_empty() {
        return lines;
    }
    let near = NEARER * spacing.least * size;
    for _ in 0..ROUNDS {
        let gaps = gaps(profile, &lines, size, exact);
        let whole: f64 = gaps.iter().map(|g| g.left).sum();
        if whole <= spacing.within || lines.len() >= MOST_LINES {
            break;
        }
        let even = EVEN * spacing.within / gaps.len() as f64;
        let more: Vec<ProfileLine> = gaps
            .iter()
            .filter(|g| g.left > even && profile.length_between(g.ends) > 2.0 * near)
            .map(|g| profile.halfway(g.ends))
            .collect();
        if more.is_empty() {
            break;
        }
        lines.extend(more);
        lines.sort_by(|a, b| a.place().total_cmp(&b.place()));
    }
    profile.parted(lines, size)
}

/// A part of the turn of a sheet that one line stands for, which lies in the middle of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// Shares of the whole turn, whichever way, between which it lies.
    pub turn: [f64; 2],
    /// Turn of the sheet over it, rad, positive towards the eye.
    pub angle: f64,
}

impl Cell {
    /// The share at which its line lies.
    pub fn middle(&self) -> f64 {
        0.5 * (self.turn[0] + self.turn[1])
    }

    fn halves(self) -> [Self; 2] {
        let [a, b] = self.turn;
        [[a, self.middle()], [self.middle(), b]].map(|turn| Self { turn, angle: 0.5 * self.angle })
    }
}

/// Cells halved where the part could not be bent back from their lines within `within` (mm); `size` is the length of the part, mm.
/// Faces of which a ruling is not known keep theirs.
pub(crate) fn dense_cells(
    mut cells: Vec<Cell>,
    (within, size): (f64, f64),
    exact: &dyn Fn(f64) -> Option<DevelopedRuling>,
) -> Vec<Cell> {
    let near = NEARER * BendSpacing::default().least * size;
    let ends = [0.0, 1.0].map(exact);
    let [Some(first), Some(last)] = ends else { return cells };
    for _ in 0..ROUNDS {
        let rulings: Option<Vec<DevelopedRuling>> = cells.iter().map(|c| exact(c.middle())).collect();
        let Some(rulings) = rulings.filter(|r| !r.is_empty()) else { return cells };
        let count = cells.len();
        let stretch = |k: usize| {
            let [a, b] = [cells.get(k)?.angle, cells.get(k + 1)?.angle];
            Stretch::signed(rulings.get(k)?, rulings.get(k + 1)?, 0.5 * (a + b), [a.signum(), b.signum()])
        };
        // A single line tells of no change.
        let tip = |end: &DevelopedRuling, k: usize, behind| {
            stretch(k).and_then(|s| s.beyond(end, behind)).unwrap_or(f64::INFINITY)
        };
        let mut left = vec![tip(&first, 0, false)];
        left.extend((0..count - 1).map(|k| stretch(k).map_or(0.0, |s| s.left(0.5 * size))));
        left.push(tip(&last, count.saturating_sub(2), true));
        if left.iter().sum::<f64>() <= within || count >= MOST_LINES {
            break;
        }
        let even = EVEN * within / left.len() as f64;
        let middle = |r: &DevelopedRuling| (r.flat[0] + r.flat[1]) * 0.5;
        let apart = |a: &DevelopedRuling, b: &DevelopedRuling| (middle(a) - middle(b)).norm();
        let is_wide = |k: usize| match k {
            0 => apart(&first, &rulings[0]) > near,
            k if k == count => apart(&rulings[count - 1], &last) > near,
            k => apart(&rulings[k - 1], &rulings[k]) > 2.0 * near,
        };
        let is_bad: Vec<bool> = (0..=count).map(|k| left[k] > even && is_wide(k)).collect();
        if !is_bad.contains(&true) {
            break;
        }
        let halved = |(k, c): (usize, &Cell)| if is_bad[k] || is_bad[k + 1] { c.halves().to_vec() } else { vec![*c] };
        cells = cells.iter().enumerate().flat_map(halved).collect();
    }
    cells
}

/// What lies between two lines, or between one and an end of the part.
struct Gap {
    /// Places on the profile.
    ends: [f64; 2],
    /// By how much it moves the rest of the part, mm.
    left: f64,
}

fn gaps<K: Copy>(profile: &TurnProfile<K>, lines: &[ProfileLine], size: f64, exact: &Exact) -> Vec<Gap> {
    let mut out = Vec::with_capacity(lines.len() + 1);
    let rulings: Vec<[Option<DevelopedRuling>; 2]> = lines.iter().map(|l| [false, true].map(|b| exact(l, b))).collect();
    let stretch = |k: usize| -> Option<Stretch> {
        let (a, b) = (rulings.get(k)?[1].as_ref()?, rulings.get(k + 1)?[0].as_ref()?);
        Stretch::new(a, b, profile.turn_between(&lines[k], &lines[k + 1]))
    };
    let [first, last] = [profile.end(false), profile.end(true)];
    let tip = |end: &ProfileLine, k: usize, behind: bool| -> f64 {
        let Some(ruling) = exact(end, !behind) else { return 0.0 };
        // A single line tells of no change.
        stretch(k).and_then(|s| s.beyond(&ruling, behind)).unwrap_or(f64::INFINITY)
    };
    let count = lines.len();
    out.push(Gap { ends: [first.place(), lines[0].place()], left: tip(&first, 0, false) });
    for k in 0..count - 1 {
        let left = stretch(k).map_or(0.0, |s| s.left(0.5 * size));
        out.push(Gap { ends: [lines[k].place(), lines[k + 1].place()], left });
    }
    let left = tip(&last, count.saturating_sub(2), true);
    out.push(Gap { ends: [lines[count - 1].place(), last.place()], left });
    out
}

/// The stretch between two rulings, laid from lines and turn alone, beside where both are.
struct Stretch {
    between: Between,
    /// Poses in space of both rulings.
    poses: [Pose; 2],
    origin: Vec2,
    /// Whether rulings were turned over so that the family goes on to their left.
    turned_over: bool,
    /// Middle of the second ruling, along it from the foot of the origin.
    middle: f64,
    turn: f64,
}

impl Stretch {
    fn new(first: &DevelopedRuling, last: &DevelopedRuling, turn: f64) -> Option<Self> {
        Self::signed(first, last, turn, [turn.signum(); 2])
    }

    /// The same where it is known which way the sheet bends at either ruling.
    fn signed(first: &DevelopedRuling, last: &DevelopedRuling, turn: f64, signs: [f64; 2]) -> Option<Self> {
        let middle = |r: &DevelopedRuling| (r.flat[0] + r.flat[1]) * 0.5;
        let ahead = middle(last) - middle(first);
        let turned_over = (first.flat[1] - first.flat[0]).perp(&ahead) < 0.0;
        let origin = middle(first);
        let side = |r: &DevelopedRuling, sign: f64| line(r, turned_over, sign);
        let poses = [pose(first, turned_over, &origin)?, pose(last, turned_over, &origin)?];
        let sides = [side(first, signs[0])?, side(last, signs[1])?];
        let between = Between::new(&sides[0], &sides[1], turn, origin);
        let foot = sides[1].way.dot(&(sides[1].at - origin));
        let middle = foot + 0.5 * (sides[1].reach[0] + sides[1].reach[1]);
        Some(Self { between, poses, origin, turned_over, middle, turn })
    }

    /// By how much the rest of the part is moved, mm; turns count by the lever.
    fn left(&self, lever: f64) -> f64 {
        let end = self.between.steps(STEPS).iter().fold(self.poses[0], |p, r| p.moved(r, 1.0));
        off(&end, &self.poses[1], self.middle, lever)
    }

    /// By how much an end of the part is off that lies before the first ruling or behind the second one, mm; `None` where the
    /// rulings laid do not reach it.
    fn beyond(&self, end: &DevelopedRuling, behind: bool) -> Option<f64> {
        let target = pose(end, self.turned_over, &self.origin)?;
        let side = line(end, self.turned_over, self.turn.signum())?;
        let foot = side.way.dot(&(side.at - self.origin));
        let reach = side.reach.map(|v| v + foot);
        let middle = side.at + side.way * (0.5 * (side.reach[0] + side.reach[1]));
        let from = if behind { 1.0 } else { 0.0 };
        let mut x = from;
        for _ in 0..NEWTON {
            let (p, spin, across) = self.between.ruling(x);
            let away = middle - p.at.xy();
            x += away.dot(&p.across().xy()) / (across + away.dot(&p.ruling().xy()) * spin);
            if !x.is_finite() || (x - from).abs() > BEYOND {
                return None;
            }
        }
        let at = |k: usize| from + (x - from) * k as f64 / STEPS as f64;
        let mut here = self.poses[usize::from(behind)];
        for k in 0..STEPS {
            let [a, b] = [k, k + 1].map(|k| self.between.ruling(at(k)));
            let turn = 0.5 * (self.between.rate(at(k), &a) + self.between.rate(at(k + 1), &b));
            let rates = Rates { turn: turn * (at(k + 1) - at(k)), ..a.0.flat_rates_to(&b.0) };
            here = here.moved(&rates, 1.0);
        }
        Some(reach.map(|v| (here.point(v, 0.0) - target.point(v, 0.0)).norm()).into_iter().fold(0.0, f64::max))
    }
}

/// Difference of two poses as a move: where rulings have their middle, and the turn by a lever.
fn off(a: &Pose, b: &Pose, middle: f64, lever: f64) -> f64 {
    let turn = (a.axes.transpose() * b.axes - Matrix3::identity()).norm() / std::f64::consts::SQRT_2;
    (a.point(middle, 0.0) - b.point(middle, 0.0)).norm() + turn * lever
}

/// A ruling as a line that is drawn.
fn line(r: &DevelopedRuling, turned_over: bool, sign: f64) -> Option<LineSide> {
    let ([a, b], radii) =
        if turned_over { ([r.flat[1], r.flat[0]], [r.radii[1], r.radii[0]]) } else { (r.flat, r.radii) };
    let way = (b - a).try_normalize(0.0)?;
    Some(LineSide { at: a, way, reach: [0.0, (b - a).norm()], radii, sign })
}

/// The pose in space of a ruling, at the foot of a point.
fn pose(r: &DevelopedRuling, turned_over: bool, origin: &Vec2) -> Option<Pose> {
    let ([a, b], [p, q]) =
        if turned_over { ([r.space[1], r.space[0]], [r.flat[1], r.flat[0]]) } else { (r.space, r.flat) };
    let (e, way) = ((b - a).try_normalize(0.0)?, (q - p).try_normalize(0.0)?);
    let foot = way.dot(&(origin - p));
    // Seen by the eye, the family goes on to the left of rulings.
    let across = r.normal.cross(&e);
    Some(Pose { axes: Matrix3::from_columns(&[e, across, r.normal]), at: a + e * foot })
}
