//! Which points lie inside polygons, for many points: sides are found by their heights.

use super::polygon::{crosses, sides};
use super::Vec2;

/// Sides in a row of heights, about.
const IN_ROW: usize = 4;
/// Rows at most.
const ROWS: usize = 512;

/// Polygons for the even-odd rule.
#[derive(Clone, Debug)]
pub(crate) struct Inside {
    low: f64,
    step: f64,
    /// Sides row by row; one that passes several is in each of them.
    sides: Vec<(Vec2, Vec2)>,
    /// Where every row begins, and the last one ends.
    starts: Vec<usize>,
}

impl Inside {
    /// Closed polygons: the last corner is joined to the first.
    pub fn of<'a>(polygons: impl IntoIterator<Item = &'a Vec<Vec2>, IntoIter: 'a>) -> Self {
        let all: Vec<(Vec2, Vec2)> = sides(polygons).collect();
        let heights = || all.iter().map(|side| side.0.y);
        let (low, high) = heights().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        let count = (all.len() / IN_ROW).clamp(1, ROWS);
        let mut out = Self {
            low,
            step: ((high - low) / count as f64).max(f64::MIN_POSITIVE),
            sides: vec![],
            starts: vec![0; count + 1],
        };
        let mut rows: Vec<Vec<(Vec2, Vec2)>> = vec![Vec::new(); count];
        for side in all {
            let [a, b] = [side.0, side.1].map(|p| out.row(p.y));
            rows[a.min(b)..=a.max(b)].iter_mut().for_each(|r| r.push(side));
        }
        for (k, row) in rows.into_iter().enumerate() {
            out.sides.extend(row);
            out.starts[k + 1] = out.sides.len();
        }
        out
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low) / self.step).max(0.0) as usize).min(self.starts.len() - 2)
    }

    /// Whether a point lies inside.
    pub fn holds(&self, x: &Vec2) -> bool {
        let row = self.row(x.y);
        self.sides[self.starts[row]..self.starts[row + 1]].iter().filter(|s| crosses(s, x)).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polygon::{self, tests::ring};

    #[test]
    fn rows_tell_what_all_sides_tell() {
        let wave = |radius: f64, a: f64| Vec2::new(a.cos(), a.sin()) * (radius * (1.0 + 0.3 * (7.0 * a).sin()));
        let waves = |radius: f64, count: usize| ring(count, |a| wave(radius, a));
        // A body with a hole, a triangle, and polygons of no height and of nothing.
        let flat = vec![Vec2::new(0.0, 9.0), Vec2::new(4.0, 9.0)];
        let all = [waves(10.0, 3000), waves(4.0, 50), waves(1.0, 3), flat, Vec::new()];
        let inside = Inside::of(&all);
        let mut held = 0;
        for k in 0..4000 {
            let x = Vec2::new((0.37 * f64::from(k)).sin(), (0.73 * f64::from(k)).cos()) * 15.0;
            assert_eq!(inside.holds(&x), polygon::inside(&all, &x), "{x}");
            held += usize::from(inside.holds(&x));
        }
        assert!((500..3500).contains(&held), "{held}");
        assert!(!Inside::of(&[]).holds(&Vec2::zeros()) && !inside.holds(&Vec2::new(f64::NAN, f64::NAN)));
    }
}
