//! Closed lines of a plane cut along a line: the border of what lies on one side of it.

/// What a side of a closed line follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// A curve, by its number, from one of its parameters to another.
    Curve(usize, [f64; 2]),
    /// The chord.
    Straight,
}

/// A side of a closed line: a smooth stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side {
    /// What it follows.
    pub way: Way,
    /// First and last point, the latter bit by bit the first of the next side.
    pub ends: [[f64; 2]; 2],
}

/// Places on a side between which it crosses a line once at most.
const PLACES: usize = 64;
/// Halvings towards a crossing: to the last digit.
const DIGITS: usize = 60;

impl Side {
    /// Point at a share of the way; `on` gives points of curves.
    pub fn at(&self, share: f64, on: &impl Fn(usize, f64) -> [f64; 2]) -> [f64; 2] {
        let [a, b] = self.ends;
        match self.way {
            _ if share <= 0.0 => a,
            _ if share >= 1.0 => b,
            Way::Curve(curve, [from, to]) => on(curve, from + (to - from) * share),
            Way::Straight => [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * share),
        }
    }

    /// The part between two shares of the way with their points.
    fn part(&self, [s, t]: [f64; 2], ends: [[f64; 2]; 2]) -> Self {
        let way = match self.way {
            Way::Curve(curve, [from, to]) => Way::Curve(curve, [s, t].map(|x| from + (to - from) * x)),
            Way::Straight => Way::Straight,
        };
        Self { way, ends }
    }

    /// Its parts between crossings of the line of that height, each with whether it lies above.
    fn split(&self, height: f64, on: &impl Fn(usize, f64) -> [f64; 2]) -> Vec<(Self, bool)> {
        let share = |k: usize| k as f64 / PLACES as f64;
        let below = |s: f64| self.at(s, on)[1] < height;
        let mut out = Vec::new();
        let mut from = (0.0, self.ends[0]);
        for k in 0..PLACES {
            let here = below(share(k));
            if here == below(share(k + 1)) {
                continue;
            }
            let [mut lo, mut hi] = [share(k), share(k + 1)];
            for _ in 0..DIGITS {
                let m = 0.5 * (lo + hi);
                if below(m) == here {
                    lo = m;
                } else {
                    hi = m;
                }
            }
            let to = [self.at(hi, on)[0], height];
            out.push((self.part([from.0, hi], [from.1, to]), !here));
            from = (hi, to);
        }
        out.push((self.part([from.0, 1.0], [from.1, self.ends[1]]), !below(1.0)));
        out
    }
}

/// The borders of what closed lines enclose above the line on which the second coordinate is `height`, or below it; ends of
/// sides are not on that line. `None` where crossings do not come in pairs.
pub(crate) fn cut_off(
    loops: &[Vec<Side>],
    (height, above): (f64, bool),
    on: &impl Fn(usize, f64) -> [f64; 2],
) -> Option<Vec<Vec<Side>>> {
    let (mut out, mut chains): (Vec<Vec<Side>>, Vec<Vec<Side>>) = (Vec::new(), Vec::new());
    for l in loops {
        let mut parts: Vec<(Side, bool)> = l.iter().flat_map(|s| s.split(height, on)).collect();
        let n = parts.len();
        let first = (0..n).find(|k| parts[*k].1 == above && parts[(k + n - 1) % n].1 != above);
        if let Some(first) = first {
            parts.rotate_left(first);
            let runs = parts.chunk_by(|a, b| a.1 == b.1).filter(|run| run[0].1 == above);
            chains.extend(runs.map(|run| run.iter().map(|p| p.0).collect()));
        } else if parts.first()?.1 == above {
            out.push(l.clone());
        }
    }
    // Ends of chains along the line: what is enclosed is between the first and the second, the third and the fourth.
    let mut ends: Vec<(f64, usize, bool)> = Vec::new();
    for (k, c) in chains.iter().enumerate() {
        ends.push((c[0].ends[0][0], k, true));
        ends.push((c[c.len() - 1].ends[1][0], k, false));
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut next: Vec<Option<usize>> = vec![None; chains.len()];
    for pair in ends.chunks(2) {
        let [a, b] = pair else { return None };
        let (last, first) = if a.2 { (b, a) } else { (a, b) };
        if last.2 || !first.2 {
            return None;
        }
        next[last.1] = Some(first.1);
    }
    let mut open = vec![true; chains.len()];
    for start in 0..chains.len() {
        let (mut k, mut line) = (start, Vec::new());
        while std::mem::replace(&mut open[k], false) {
            line.extend_from_slice(&chains[k]);
            let then = next[k]?;
            let ends = [line[line.len() - 1].ends[1], chains[then][0].ends[0]];
            line.push(Side { way: Way::Straight, ends });
            k = then;
        }
        if !line.is_empty() {
            out.push(line);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A square of ten with a round hole of radius three in its middle.
    fn holed() -> Vec<Vec<Side>> {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let side = |k: usize| Side { way: Way::Straight, ends: [corners[k], corners[(k + 1) % 4]] };
        let hole = Side { way: Way::Curve(0, [1.0, 0.0]), ends: [circle(0, 1.0), circle(0, 0.0)] };
        vec![(0..4).map(side).collect(), vec![hole]]
    }

    fn circle(_: usize, s: f64) -> [f64; 2] {
        let a = TAU * (s.fract() + 0.1);
        [5.0 + 3.0 * a.cos(), 5.0 + 3.0 * a.sin()]
    }

    fn area(line: &[Side]) -> f64 {
        let places = |s: &Side| (0..400).map(|k| s.at(f64::from(k) / 400.0, &circle)).collect::<Vec<_>>();
        let p: Vec<[f64; 2]> = line.iter().flat_map(places).collect();
        (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
    }

    #[test]
    fn both_sides_of_a_cut_make_up_the_whole() {
        let hole = 9.0 * TAU / 2.0;
        // Below the hole, through it, above it.
        for (height, counts) in [(1.0, [1, 2]), (4.0, [1, 1]), (5.0, [1, 1]), (9.5, [2, 1])] {
            let sides = [false, true].map(|above| cut_off(&holed(), (height, above), &circle).expect("lines"));
            assert_eq!([sides[0].len(), sides[1].len()], counts, "at {height}");
            let areas = sides.each_ref().map(|s| s.iter().map(|l| area(l)).sum::<f64>());
            assert!((areas[0] + areas[1] - (100.0 - hole)).abs() < 1e-2, "at {height}: {areas:?}");
            if height == 5.0 {
                assert!((areas[0] - areas[1]).abs() < 1e-2, "{areas:?}");
            }
            for line in sides.iter().flatten() {
                for (k, s) in line.iter().enumerate() {
                    assert_eq!(s.ends[1], line[(k + 1) % line.len()].ends[0]);
                }
            }
        }
    }

    #[test]
    fn what_the_line_does_not_meet_stays_or_goes_as_it_is() {
        let cut = |height, above| cut_off(&holed(), (height, above), &circle);
        assert_eq!((cut(-1.0, true), cut(-1.0, false)), (Some(holed()), Some(Vec::new())));
        // An open line has a crossing without partner.
        let open = vec![vec![Side { way: Way::Straight, ends: [[0.0, 0.0], [0.0, 2.0]] }]];
        assert_eq!(cut_off(&open, (1.0, true), &circle).map(|l| l.len()), Some(1));
    }
}
