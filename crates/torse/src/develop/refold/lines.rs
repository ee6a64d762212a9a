//! The bend lines of a part, from end to end, in order and directed alike.

use super::drawn::{BendLine, FlatPart, ROUNDED};
use super::RefoldError;
use crate::develop::between::LineSide;
use crate::geom::polygon::inside;
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;

/// Share of the part's size within which pieces lie on one line.
const ON_ONE_LINE: f64 = 1e-6;

/// A whole line with what is known of it.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    /// A point of it.
    pub at: Vec2,
    /// Unit direction.
    pub way: Vec2,
    /// Where it begins and ends, from the point on.
    pub reach: [f64; 2],
    /// Radii at both ends, just before the line and behind it, mm.
    pub radii: [[f64; 2]; 2],
    /// Which way the sheet bends before the line and behind it.
    pub signs: [f64; 2],
    /// Turn of the sheet up to the line, before and behind its fold, rad.
    pub turned: [f64; 2],
    /// Whether the sheet folds there.
    pub fold: bool,
    /// Number of its first piece.
    pub number: usize,
}

/// Lines from end to end: pieces of one line between holes as one.
pub(super) fn whole_lines(part: &FlatPart) -> Vec<Whole> {
    let size = part.size();
    let mut out: Vec<Whole> = Vec::new();
    for (k, BendLine { ends: [a, b], bend }) in part.lines.iter().enumerate() {
        let Some(way) = (b - a).try_normalize(0.0) else { continue };
        let sign = match bend.sense {
            BendSense::Up => 1.0,
            BendSense::Down => -1.0,
            BendSense::Flat => 0.0,
        };
        if let Some(last) = out.last_mut() {
            let off = |p: &Vec2| last.way.perp(&(p - last.at)).abs() <= ON_ONE_LINE * size;
            if off(a) && off(b) {
                let along = [a, b].map(|p| last.way.dot(&(p - last.at)));
                // Of pieces, the radii at the far ends are those of the whole.
                let same = last.way.dot(&way) > 0.0;
                let end = |k: usize| [bend.before, bend.radii].map(|r| r[if same { k } else { 1 - k }]);
                let (low, high) = (along[0].min(along[1]), along[0].max(along[1]));
                if low - part.inset < last.reach[0] {
                    last.reach[0] = low - part.inset;
                    (last.radii[0][0], last.radii[1][0]) = (end(0)[0], end(0)[1]);
                }
                if high + part.inset > last.reach[1] {
                    last.reach[1] = high + part.inset;
                    (last.radii[0][1], last.radii[1][1]) = (end(1)[0], end(1)[1]);
                }
                continue;
            }
        }
        let fold = bend.radii == [0.0; 2] && sign != 0.0;
        let half = if fold { 0.5 * sign * bend.angle } else { 0.0 };
        out.push(Whole {
            at: *a,
            way,
            reach: [-part.inset, (b - a).norm() + part.inset],
            radii: [bend.before, bend.radii],
            signs: [sign; 2],
            turned: [bend.turned - half, bend.turned + half],
            fold,
            number: k + 1,
        });
    }
    signed(&mut out);
    out
}

/// Which way the sheet bends at lines: as it turns to the neighbouring line on either side; where it turns differently on
/// both, as the turn goes over the lines around.
fn signed(lines: &mut [Whole]) {
    let n = lines.len();
    let turn = |k: usize| lines[k + 1].turned[0] - lines[k].turned[1];
    let turns: Vec<f64> = (1..n).map(|k| turn(k - 1)).collect();
    for (k, line) in lines.iter_mut().enumerate() {
        let before = k.checked_sub(1).map(|j| turns[j]);
        let behind = turns.get(k).copied();
        let [a, b] = [before.or(behind), behind.or(before)].map(|t| t.unwrap_or(line.signs[0]));
        let even = (a + b).signum();
        line.signs = if !line.joins() && a * b < 0.0 { [even; 2] } else { [a.signum(), b.signum()] };
    }
}

impl Whole {
    /// The line as the stretch behind it sees it, or the one before it.
    pub fn side(&self, behind: bool) -> LineSide {
        let k = usize::from(behind);
        LineSide { at: self.at, way: self.way, reach: self.reach, radii: self.radii[k], sign: self.signs[k] }
    }

    /// The ruling at a distance (mm, across the middle) behind the line, or before it where that is negative, if the sheet goes
    /// on as it does there.
    pub fn moved(&self, distance: f64) -> Self {
        let k = usize::from(distance > 0.0);
        let radii = self.radii[k];
        let middle = 0.5 * (radii[0] + radii[1]);
        let rise = (radii[1] - radii[0]) / (self.reach[1] - self.reach[0]);
        let spin = distance * rise / middle;
        let spin = if spin.is_finite() { spin } else { 0.0 };
        let half = 0.5 * (self.reach[1] - self.reach[0]);
        let (s, c) = spin.sin_cos();
        let turned = |w: Vec2| Vec2::new(c * w.x - s * w.y, s * w.x + c * w.y);
        // About the point in which neighbours meet, if they do.
        let left = Vec2::new(-self.way.y, self.way.x);
        let centre = self.point(0.5);
        let at = if spin == 0.0 {
            centre + left * distance
        } else {
            let meet = centre - self.way * (distance / spin);
            meet + turned(centre - meet)
        };
        let turn = if middle > 0.0 { self.signs[k] * distance / middle } else { 0.0 };
        Self {
            at,
            way: turned(self.way),
            reach: [-half, half],
            radii: [radii; 2],
            signs: [self.signs[k]; 2],
            turned: [self.turned[k] + turn; 2],
            fold: false,
            ..self.clone()
        }
    }

    /// Whether the sheet goes on otherwise behind the line than before it.
    pub fn joins(&self) -> bool {
        self.radii[0] != self.radii[1]
    }

    /// The point at a share of the way from end to end.
    pub fn point(&self, share: f64) -> Vec2 {
        self.at + self.way * (self.reach[0] + (self.reach[1] - self.reach[0]) * share)
    }

    fn reversed(&mut self) {
        self.way = -self.way;
        self.reach = [-self.reach[1], -self.reach[0]];
        self.radii.iter_mut().for_each(|r| r.swap(0, 1));
    }
}

/// Directs lines alike and so that they follow each other to their left.
pub(super) fn order(lines: &mut [Whole]) {
    for k in 1..lines.len() {
        if lines[k].way.dot(&lines[k - 1].way) < 0.0 {
            lines[k].reversed();
        }
    }
    let forward: f64 = lines
        .windows(2)
        .map(|w| {
            w[0].way.perp(&(w[1].point(0.5) - w[0].point(0.5))) + w[1].way.perp(&(w[1].point(0.5) - w[0].point(0.5)))
        })
        .map(f64::signum)
        .sum();
    if forward < 0.0 {
        lines.iter_mut().for_each(Whole::reversed);
    }
}

/// Lines run through the part, and neighbours do not cross in it.
pub(super) fn check(part: &FlatPart, lines: &[Whole]) -> Result<(), RefoldError> {
    for l in lines {
        if !inside(&part.loops, &part.lines[l.number - 1].ends.iter().sum::<Vec2>().scale(0.5)) {
            return Err(RefoldError::Outside { line: l.number });
        }
    }
    for w in lines.windows(2) {
        let side = |p: Vec2| w[0].way.perp(&(p - w[0].at));
        let (a, b) = (side(w[1].point(0.0)), side(w[1].point(1.0)));
        let reach = w[0].point(0.0)..w[0].point(1.0);
        // Rulings that nearly meet cross where the drawing is rounded.
        if a * b < 0.0 && a.abs().min(b.abs()) > ROUNDED {
            let cut = w[1].point(a / (a - b));
            let along = w[0].way.dot(&(cut - reach.start));
            let slack = part.inset.max(ON_ONE_LINE * part.size());
            if along > slack && along < (reach.end - reach.start).norm() - slack {
                return Err(RefoldError::Crossing { first: w[0].number, second: w[1].number });
            }
        }
    }
    Ok(())
}
