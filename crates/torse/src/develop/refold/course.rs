//! Parts that bend about one family of rulings: the family between the lines that are drawn, and the turn of the sheet
//! along it.
//!
//! *Method*. A line of the plane has the coordinates (n, p), its unit normal and distance; the family is the spline through
//! those of the lines drawn. Lines through one point and parallel lines satisfy a linear relation that the spline keeps, so
//! that cones and cylinders stay cones and cylinders. The table's radii ρ at the ends of a line are ds/dθ, and how far
//! neighbouring rulings are apart there is ds: this gives the rate of turn at every line, a second spline. Where this does not
//! give the angles of the table (planes beside bent zones, folds, an apex), the turn of every interval between lines follows
//! from the angles, each of which stands for the halves of two intervals; what they leave open, one alternating number, comes
//! from the radii. Between rulings that are laid close the sheet is exactly a plane, a circular cylinder or a
//! circular cone.

use super::drawn::FlatPart;
use super::family::{reach_near, Family};
use super::leaf::{Leaf, Refolded};
use super::lines::{check, order, whole_lines, Whole};
use super::pose::{Pose, Rates};
use super::ribbon::{Ribbon, Span};
use super::smooth::Smooth;
use super::RefoldError;
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;

/// Rulings laid between two lines: their frames differ from the family by the cube of the step, here below 10⁻⁷ of the
/// turn between lines.
const BETWEEN: usize = 48;
/// Rulings over the size of a part that bends about one line.
const PARALLELS: usize = 512;
/// Share of the whole turn, and of a line's own, by which radii and angles may differ where both come from a smooth sheet.
const AGREE: (f64, f64) = (2e-3, 5e-2);
/// Angles that differ by less (share of the greatest) are equal steps of turn: what tables print.
const EVEN: f64 = 2e-4;
/// Share of the whole turn by which all angles together may differ from what the radii give: beyond, radii jump between
/// lines.
const MISSED: f64 = 0.5;
/// Intervals by which the family may go on beyond the first and last line.
const BEYOND: usize = 24;
/// Neighbouring rulings this near to each other (share of their distance elsewhere) meet.
const MEET: f64 = 1e-3;

/// How the turn is known.
enum Turn {
    /// Turn from line to line is the same, and half of it before the first and behind the last (rolled faces).
    Even(f64),
    /// By the bend table.
    Table,
}

/// Bends a part back about one family of rulings, in the order of its lines. A part without lines is plane.
///
/// # Errors
/// Outlines that cross themselves; lines that cross inside the part or do not run through it.
pub fn refold(part: &FlatPart) -> Result<Refolded, RefoldError> {
    part.check()?;
    let mut lines = whole_lines(part);
    if lines.is_empty() {
        return Ok(plane(part));
    }
    order(&mut lines);
    check(part, &lines)?;
    let turn = match &part.bends[..] {
        [one] if one.rolled => {
            let sign = if one.sense == BendSense::Down { -1.0 } else { 1.0 };
            Turn::Even(sign * one.angle / lines.len() as f64)
        }
        _ => Turn::Table,
    };
    let family = Family::through(part, &lines, matches!(turn, Turn::Even(_)));
    let cells = family.turns(&lines, &turn);
    let ribbon = family.ribbon(part, &lines, &cells);
    let leaf = Leaf { ribbon, loops: part.loops.clone() };
    Ok(Refolded { leaves: vec![leaf], disagreement: cells.disagreement, method: cells.method })
}

/// A part that is not bent.
fn plane(part: &FlatPart) -> Refolded {
    let leaf =
        Leaf { ribbon: plane_ribbon(&part.loops, Pose::flat(Vec2::zeros(), Vec2::x())), loops: part.loops.clone() };
    Refolded { leaves: vec![leaf], disagreement: 0.0, method: "plane" }
}

/// The rulings of a plane region; `frame` is where the frame of the drawing is in space.
pub(super) fn plane_ribbon(loops: &[Vec<Vec2>], frame: Pose) -> Ribbon {
    let (lo, hi) = super::drawn::bounds(loops);
    let flat = Pose::flat(lo, Vec2::x());
    let space = Pose { axes: frame.axes, at: frame.point(lo.x, lo.y) };
    let step = Rates { across: hi.y - lo.y, ..Rates::default() };
    Ribbon { spans: vec![Span { flat, space, in_plane: step, in_space: step, reach: [0.0, hi.x - lo.x] }] }
}

/// The turn of the sheet along a family.
struct Turns {
    /// Rate at which the sheet turns.
    rate: Rate,
    /// Folds: place and turn.
    folds: Vec<(f64, f64)>,
    disagreement: f64,
    method: &'static str,
}

enum Rate {
    /// The rate, and what it is multiplied with from each line to the next.
    Smooth(RateSpline, Vec<f64>),
    /// One rate from each line to the next; the first goes before the first line, the last behind the last.
    Steps(Vec<f64>),
}

impl Family {
    /// How the sheet turns along the family.
    fn turns(&self, lines: &[Whole], turn: &Turn) -> Turns {
        if let Turn::Even(step) = turn {
            let steps: Vec<f64> = self.at.windows(2).map(|w| step / (w[1] - w[0])).collect();
            return Turns {
                rate: Rate::Steps(steps),
                folds: Vec::new(),
                disagreement: 0.0,
                method: "even turn from line to line",
            };
        }
        let folds: Vec<(f64, f64)> =
            lines.iter().zip(&self.at).filter(|(l, _)| l.fold).map(|(l, t)| (*t, l.angle)).collect();
        if folds.len() == lines.len() {
            let rate = Rate::Steps(vec![0.0; lines.len().max(2) - 1]);
            return Turns { rate, folds, disagreement: 0.0, method: "folds" };
        }
        let rates: Vec<[f64; 1]> = lines.iter().zip(&self.at).map(|(l, t)| [self.rate(l, *t)]).collect();
        let smooth = RateSpline::through(&self.at[..lines.len()], &rates);
        // Turn by the radii between the middles to the neighbours, against the table.
        let middle = |k: usize| 0.5 * (self.at[k] + self.at[k - 1]);
        let whole: f64 = lines.iter().map(|l| l.angle.abs()).sum();
        let mut disagreement = 0.0_f64;
        let (mut near, mut compared, mut missed) = (0, 0, 0.0);
        for (k, line) in lines.iter().enumerate().skip(1).take(lines.len().saturating_sub(2)) {
            let found = integral(&smooth, middle(k), middle(k + 1));
            let off = (found - line.angle).abs();
            disagreement = disagreement.max(off);
            compared += 1;
            missed += off;
            near += usize::from(off <= AGREE.0 * whole + AGREE.1 * line.angle.abs());
        }
        // Short rulings are not drawn, and what they turn is in no row: radii tell what gaps hold, angles do not.
        if folds.is_empty() && 2 * near >= compared && missed <= MISSED * whole {
            let share = self.shares(lines, &smooth);
            let rate = Rate::Smooth(smooth, share);
            return Turns { rate, folds, disagreement, method: "rate of turn from radii and angles" };
        }
        let steps = self.steps(lines, &rates);
        Turns { rate: Rate::Steps(steps), folds, disagreement, method: "turn between lines from angles" }
    }

    /// What the rates between neighbouring lines are to be multiplied with, so that they give the turn that the table knows.
    /// Where lines are spaced by equal turns they have the greatest angle of all, and from one of them to the next the sheet
    /// turns just by that.
    fn shares(&self, lines: &[Whole], rate: &RateSpline) -> Vec<f64> {
        let most = lines.iter().map(|l| l.angle.abs()).fold(0.0, f64::max);
        let even = |l: &Whole| l.angle.abs() >= most * (1.0 - EVEN);
        let share = |k: usize| {
            let (a, b) = (&lines[k], &lines[k + 1]);
            let share = 0.5 * (a.angle + b.angle) / integral(rate, self.at[k], self.at[k + 1]);
            let known = even(a) && even(b) && a.angle * b.angle > 0.0;
            if known && (share - 1.0).abs() <= AGREE.1 {
                share
            } else {
                1.0
            }
        };
        (0..lines.len().saturating_sub(1)).map(share).collect()
    }

    /// Rate of turn at a line from its radii: from the end where neighbouring rulings are farther apart.
    fn rate(&self, line: &Whole, t: f64) -> f64 {
        let (pose, spin, across) = self.ruling(t);
        let apart = [0.0, 1.0].map(|share| {
            let v = (line.point(share) - pose.at.xy()).dot(&pose.ruling().xy());
            (across + v * spin).abs()
        });
        let k = usize::from(apart[1] > apart[0]);
        let rate = apart[k] / line.radii[k];
        // Both ends where both tell: rounding of the table counts less.
        let other = apart[1 - k] / line.radii[1 - k];
        let both = apart[1 - k] > MEET * apart[k] && other.is_finite() && rate.is_finite() && rate > 0.0;
        let weight = apart.map(|a| a * a);
        let rate = if both { (rate * weight[k] + other * weight[1 - k]) / (weight[0] + weight[1]) } else { rate };
        if rate.is_finite() {
            rate * line.angle.signum()
        } else {
            0.0
        }
    }

    /// Rates in the intervals between lines from the angles; see the head of this file.
    fn steps(&self, lines: &[Whole], rates: &[[f64; 1]]) -> Vec<f64> {
        let n = lines.len();
        if n < 2 {
            return vec![rates.first().map_or(0.0, |r| r[0])];
        }
        let length: Vec<f64> = self.at.windows(2).map(|w| w[1] - w[0]).collect();
        let wanted: Vec<f64> = (0..n - 1).map(|k| 0.5 * (rates[k][0] + rates[k + 1][0]) * length[k]).collect();
        // turn[k] + turn[k + 1] = 2 angle[k + 1] for the inner lines that do not fold.
        let angle = |k: usize| if lines[k].fold { 0.0 } else { lines[k].angle };
        let mut turn = vec![0.0; n - 1];
        for k in 1..n - 1 {
            turn[k] = 2.0 * angle(k) - turn[k - 1];
        }
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut left: Vec<f64> = (0..n - 1).map(|k| sign(k) * (wanted[k] - turn[k])).collect();
        left.sort_by(f64::total_cmp);
        let shift = left[left.len() / 2];
        (0..n - 1).map(|k| (turn[k] + sign(k) * shift) / length[k]).collect()
    }

    /// Rulings laid close, over the whole part.
    fn ribbon(&self, part: &FlatPart, lines: &[Whole], turns: &Turns) -> Ribbon {
        let end = lines.len();
        let step = |h: f64| if end == 1 { part.size() / PARALLELS as f64 } else { h / BETWEEN as f64 };
        let n = self.at.len();
        let steps = [-step(self.at[1] - self.at[0]), step(self.at[n - 1] - self.at[n - 2])];
        let most = if end == 1 { PARALLELS } else { BEYOND * BETWEEN };
        let mut before = self.beyond(part, self.at[0], steps[0], (most, self.reach[0]));
        before.reverse();
        let mut places = before;
        for (w, l) in self.at[..end].windows(2).zip(lines) {
            let mut like = l.reach.map(|v| v + l.way.dot(&(l.at - self.origin)));
            for k in 0..BETWEEN {
                let t = w[0] + (w[1] - w[0]) * k as f64 / BETWEEN as f64;
                like = reach_near(part, &self.ruling(t).0, like).unwrap_or(like);
                places.push((t, like));
            }
        }
        places.push((self.at[end - 1], self.reach[1]));
        places.extend(self.beyond(part, self.at[end - 1], steps[1], (most, self.reach[1])));
        self.laid(turns, &places)
    }

    /// Places beyond an end, until no ruling meets the part any more.
    fn beyond(
        &self,
        part: &FlatPart,
        from: f64,
        step: f64,
        (most, mut like): (usize, [f64; 2]),
    ) -> Vec<(f64, [f64; 2])> {
        let mut out = Vec::new();
        for k in 1..=most {
            let t = from + step * k as f64;
            let found = reach_near(part, &self.ruling(t).0, like);
            let regular = self.is_regular(part, t, like);
            like = found.unwrap_or(like);
            out.push((t, like));
            if found.is_none() || !regular {
                break;
            }
        }
        out
    }

    /// The ribbon over given places.
    fn laid(&self, turns: &Turns, places: &[(f64, [f64; 2])]) -> Ribbon {
        let mut spans = Vec::with_capacity(places.len());
        let mut flat = self.ruling(places[0].0).0;
        let mut space = flat;
        for w in places.windows(2) {
            let (a, b) = (w[0].0, w[1].0);
            let next = self.ruling(b).0;
            let in_plane = flat.flat_rates_to(&next);
            let fold: f64 = turns.folds.iter().filter(|f| f.0 >= a && f.0 < b).map(|f| f.1).sum();
            space = space.moved(&Rates { turn: fold, ..Rates::default() }, 1.0);
            let in_space = Rates { turn: turns.between(&self.at, a, b), ..in_plane };
            spans.push(Span { flat, space, in_plane, in_space, reach: w[0].1 });
            space = space.moved(&in_space, 1.0);
            flat = next;
        }
        Ribbon { spans }
    }
}

impl Turns {
    /// Turn of the sheet between two places that no line separates.
    fn between(&self, at: &[f64], a: f64, b: f64) -> f64 {
        match &self.rate {
            Rate::Smooth(s, share) => {
                let k = at.partition_point(|t| *t <= 0.5 * (a + b));
                let share = k.checked_sub(1).and_then(|k| share.get(k)).copied().unwrap_or(1.0);
                integral(s, a, b) * share
            }
            Rate::Steps(steps) => {
                let k = at.partition_point(|t| *t <= 0.5 * (a + b)).clamp(1, steps.len()) - 1;
                steps[k] * (b - a)
            }
        }
    }
}

/// Rates along the family: where all bend one way, the spline is that of their logarithms, which stays positive however
/// much they differ.
struct RateSpline {
    spline: Smooth<1>,
    /// Sign of all rates; 0 where they differ, and the spline is that of the rates themselves.
    sign: f64,
}

impl RateSpline {
    fn through(at: &[f64], rates: &[[f64; 1]]) -> Self {
        let sign = rates.first().map_or(0.0, |r| r[0].signum());
        if rates.iter().all(|r| r[0] * sign > 0.0) {
            let logarithms: Vec<[f64; 1]> = rates.iter().map(|r| [(r[0] * sign).ln()]).collect();
            return Self { spline: Smooth::through(at, &logarithms), sign };
        }
        Self { spline: Smooth::through(at, rates), sign: 0.0 }
    }

    fn at(&self, t: f64) -> f64 {
        let x = self.spline.jet(t).0[0];
        if self.sign == 0.0 {
            x
        } else {
            self.sign * x.exp()
        }
    }
}

/// Turn between two places by Simpson's rule in a few parts.
fn integral(s: &RateSpline, a: f64, b: f64) -> f64 {
    const PARTS: usize = 4;
    let h = (b - a) / PARTS as f64;
    (0..PARTS)
        .map(|k| {
            let x = a + h * k as f64;
            h / 6.0 * (s.at(x) + 4.0 * s.at(x + 0.5 * h) + s.at(x + h))
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::drawn::BendLine;
    use crate::geom::Vec3;
    use crate::patchwork::pattern::Bend;

    /// A sector of a ring between two radii with `count` lines at equal turns: a piece of a cone of half angle `alpha`, or
    /// with `alpha` = 0 a rectangle that bends to a cylinder of radius 100.
    fn part(alpha: f64, count: usize) -> (FlatPart, f64) {
        let turn = 2.0_f64;
        let at = |s: f64, r: f64| {
            if alpha == 0.0 {
                Vec2::new(100.0 * turn * s, r - 100.0)
            } else {
                let a = turn * alpha.tan() * s;
                Vec2::new(a.cos(), a.sin()) * r
            }
        };
        let radius = |r: f64| if alpha == 0.0 { 100.0 } else { r * alpha.tan() };
        let n = 400;
        let side = |r: f64| (0..=n).map(|k| at(k as f64 / n as f64, r)).collect::<Vec<_>>();
        let mut outline = side(if alpha == 0.0 { 100.0 } else { 200.0 });
        outline.extend(side(if alpha == 0.0 { 200.0 } else { 100.0 }).into_iter().rev());
        if super::super::drawn::area(&outline) < 0.0 {
            outline.reverse();
        }
        let line = |k: usize| {
            let s = (k as f64 + 0.5) / count as f64;
            let bend = Bend { sense: BendSense::Up, angle: turn / count as f64, radii: [radius(100.0), radius(200.0)] };
            BendLine { ends: [at(s, 100.0), at(s, 200.0)], bend }
        };
        let lines = (0..count).map(line).collect();
        (FlatPart { joints: vec![outline.clone()], loops: vec![outline], lines, ..FlatPart::default() }, turn)
    }

    #[test]
    fn a_rectangle_becomes_a_cylinder() {
        for count in [1, 2, 3, 12] {
            let (flat, turn) = part(0.0, count);
            let back = refold(&flat).expect("a part");
            let place = |x: f64, y: f64| back.frame(&back.locate(&Vec2::new(x, y)).expect("a place")).0;
            for x in [0.0, 30.0, 111.0, 200.0] {
                // The chord of the arc between two points.
                let chord = (place(x, 20.0) - place(3.0, 20.0)).norm();
                let wanted = 200.0 * (0.5 * (x - 3.0_f64).abs() / 100.0).sin();
                assert!((chord - wanted).abs() < 1e-6, "{count} {x}: {chord} {wanted}");
            }
            // Both sides come up towards the eye.
            let (middle, end) = (back.locate(&Vec2::new(100.0, 50.0)), back.locate(&Vec2::new(199.0, 50.0)));
            let (m, normal) = back.frame(&middle.expect("a place"));
            assert!((back.frame(&end.expect("a place")).0 - m).dot(&normal.normal()) > 10.0);
            assert!(turn > 0.0);
        }
    }

    #[test]
    fn a_sector_becomes_a_cone() {
        let alpha = 0.5_f64;
        let (flat, turn) = part(alpha, 16);
        let back = refold(&flat).expect("a part");
        let full = turn * alpha.tan();
        let place = |s: f64, r: f64| {
            let a = full * s;
            back.frame(&back.locate(&(Vec2::new(a.cos(), a.sin()) * r)).expect("a place")).0
        };
        // Around the axis by the flat angle over the sine of the half angle.
        let around = full / alpha.sin();
        for (s, r) in [(0.0, 120.0), (0.4, 150.0), (1.0, 199.0)] {
            let (a, b): (Vec3, Vec3) = (place(s, r), place(0.13, r));
            let wanted = 2.0 * r * alpha.sin() * (0.5 * around * (s - 0.13_f64).abs()).sin();
            assert!(((a - b).norm() - wanted).abs() < 1e-4, "{s}: {} {wanted}", (a - b).norm());
        }
    }

    #[test]
    fn a_wrong_angle_or_sense_is_another_shape() {
        let (flat, _) = part(0.0, 12);
        let chord = |f: &FlatPart| {
            let back = refold(f).expect("a part");
            let place = |x: f64| back.frame(&back.locate(&Vec2::new(x, 50.0)).expect("a place")).0;
            (place(200.0) - place(0.0)).norm()
        };
        let right = chord(&flat);
        let mut other = flat.clone();
        for l in &mut other.lines[6..] {
            l.bend.sense = BendSense::Down;
        }
        assert!(chord(&other) > right + 10.0);
        let mut sharper = flat.clone();
        for l in &mut sharper.lines {
            (l.bend.angle, l.bend.radii) = (1.1 * l.bend.angle, l.bend.radii.map(|r| r / 1.1));
        }
        assert!((chord(&sharper) - right).abs() > 1.0);
    }

    #[test]
    fn lines_that_cross_or_lie_outside_are_named() {
        let (mut flat, _) = part(0.0, 3);
        flat.lines[2].ends = [Vec2::new(80.0, 5.0), Vec2::new(150.0, 95.0)];
        flat.lines[1].ends = [Vec2::new(80.0, 95.0), Vec2::new(150.0, 5.0)];
        assert_eq!(refold(&flat).map(|_| ()), Err(RefoldError::Crossing { first: 2, second: 3 }));
        let (mut flat, _) = part(0.0, 3);
        flat.lines[1].ends = [Vec2::new(80.0, 195.0), Vec2::new(80.0, 300.0)];
        assert_eq!(refold(&flat).map(|_| ()), Err(RefoldError::Outside { line: 2 }));
    }
}
