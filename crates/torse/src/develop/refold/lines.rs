//! The bend lines of a part, from end to end, in order and directed alike.

use super::drawn::{inside, BendLine, FlatPart};
use super::RefoldError;
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
    /// Towards the eye positive.
    pub angle: f64,
    /// Radii at both ends, mm.
    pub radii: [f64; 2],
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
                let radii = if same { bend.radii } else { [bend.radii[1], bend.radii[0]] };
                let (low, high) = (along[0].min(along[1]), along[0].max(along[1]));
                if low - part.inset < last.reach[0] {
                    (last.reach[0], last.radii[0]) = (low - part.inset, radii[0]);
                }
                if high + part.inset > last.reach[1] {
                    (last.reach[1], last.radii[1]) = (high + part.inset, radii[1]);
                }
                continue;
            }
        }
        out.push(Whole {
            at: *a,
            way,
            reach: [-part.inset, (b - a).norm() + part.inset],
            angle: sign * bend.angle,
            radii: bend.radii,
            fold: bend.radii == [0.0; 2] && sign != 0.0,
            number: k + 1,
        });
    }
    out
}

impl Whole {
    /// The point at a share of the way from end to end.
    pub fn point(&self, share: f64) -> Vec2 {
        self.at + self.way * (self.reach[0] + (self.reach[1] - self.reach[0]) * share)
    }

    fn turned(&mut self) {
        self.way = -self.way;
        self.reach = [-self.reach[1], -self.reach[0]];
        self.radii.swap(0, 1);
    }
}

/// Directs lines alike and so that they follow each other to their left.
pub(super) fn order(lines: &mut [Whole]) {
    for k in 1..lines.len() {
        if lines[k].way.dot(&lines[k - 1].way) < 0.0 {
            lines[k].turned();
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
        lines.iter_mut().for_each(Whole::turned);
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
        if a * b < 0.0 {
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
