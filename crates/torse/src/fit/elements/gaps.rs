//! Where rulings leave much more room between two neighbours than elsewhere, and the groups that belong to sheets of their own.

use super::ruling_order::{ordered, WIDE};
use super::sequence::FEWEST;
use crate::geom::Vec3;

/// Distance of neighbours that belong to two sheets if the sheet between them would not be plane, in median distances.
const APART: f64 = 10.0;
/// Sagitta of an arc as a share of its chord and of the angles (rad) between both at its two ends, added.
const SAGITTA: f64 = 0.125;

/// A wide stretch between neighbouring rulings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gap {
    /// Index of the first of both.
    pub after: usize,
    /// Their distance as [`steps`] has it, mm.
    pub apart: f64,
    /// Median of that over all neighbours, mm.
    pub usual: f64,
}

/// Distances of neighbours, mm: mean ones where they lie beside each other.
pub(crate) fn steps(sequence: &[[Vec3; 2]]) -> Vec<f64> {
    sequence.windows(2).map(|w| apart(&w[0], &w[1]).max(apart(&w[1], &w[0]))).collect()
}

/// Mean distance of the stretch of a ruling that lies beside another from this, mm; without such a stretch that of their nearest
/// ends. Ends that jump along their rulings make these no farther apart.
fn apart([a, b]: &[Vec3; 2], other: &[Vec3; 2]) -> f64 {
    let d = b - a;
    let share = |x: &Vec3| d.dot(&(x - a)) / d.norm_squared();
    let [p, q] = [share(&other[0]), share(&other[1])];
    let (from, to) = (p.min(q).max(0.0), p.max(q).min(1.0));
    if !(from <= to && p != q) {
        let ends = [a, b].into_iter().flat_map(|x| other.iter().map(move |y| (x - y).norm()));
        return ends.fold(f64::INFINITY, f64::min);
    }
    let off = |s: f64| (a + d * s - (other[0] + (other[1] - other[0]) * ((s - p) / (q - p)))).norm();
    0.5 * (off(from) + off(to))
}

/// Median distance of neighbours, mm.
pub(crate) fn usual(sequence: &[[Vec3; 2]]) -> Option<f64> {
    let mut steps = steps(sequence);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// The wide stretches of a sequence in order, the widest first.
pub(crate) fn gaps(sequence: &[[Vec3; 2]]) -> Vec<Gap> {
    let Some(usual) = usual(sequence) else { return Vec::new() };
    let wide = steps(sequence).into_iter().enumerate().filter(|(_, s)| *s > WIDE * usual);
    let mut out: Vec<Gap> = wide.map(|(after, apart)| Gap { after, apart, usual }).collect();
    out.sort_by(|a, b| b.apart.total_cmp(&a.apart));
    out
}

/// A sequence in order, parted where a sheet across a gap would be an invention: it is far wider than others, and the sheets at its
/// sides do not go on into one plane within the tolerance (mm). Groups with too few rulings stay with their neighbours.
pub(crate) fn groups(sequence: &[[Vec3; 2]], tolerance: f64) -> Vec<Vec<[Vec3; 2]>> {
    let mut cuts: Vec<usize> = gaps(sequence)
        .into_iter()
        .filter(|g| g.apart > APART * g.usual && !is_plane(sequence, g.after, tolerance))
        .map(|g| g.after + 1)
        .collect();
    cuts.sort_unstable();
    let (mut out, mut from) = (Vec::new(), 0);
    for to in cuts {
        if to - from >= FEWEST && sequence.len() - to >= FEWEST {
            out.push(sequence[from..to].to_vec());
            from = to;
        }
    }
    out.push(sequence[from..].to_vec());
    out
}

/// Rulings in order, in groups that belong to sheets of their own: see [`groups`].
pub(crate) fn ruling_groups(rulings: &[[Vec3; 2]], tolerance: f64) -> Vec<Vec<[Vec3; 2]>> {
    let usable = rulings.iter().flatten().all(|p| p.iter().all(|x| x.is_finite()));
    if usable {
        groups(&ordered(rulings), tolerance)
    } else {
        vec![rulings.to_vec()]
    }
}

/// Whether the stretch after a ruling is plane with both of its neighbours, as far as the tolerance shows.
fn is_plane(sequence: &[[Vec3; 2]], after: usize, tolerance: f64) -> bool {
    let normal = |k: usize| {
        let [p, q] = [sequence.get(k)?, sequence.get(k + 1)?];
        ((p[1] - p[0]) + (q[1] - q[0])).cross(&((q[0] - p[0]) + (q[1] - p[1]))).try_normalize(0.0)
    };
    let Some(own) = normal(after) else { return false };
    let beside = [after.checked_sub(1), Some(after + 1)];
    let turn: f64 = beside.iter().filter_map(|k| Some(normal((*k)?)?.angle(&own))).sum();
    let wide =
        (sequence[after][0] - sequence[after + 1][0]).norm().max((sequence[after][1] - sequence[after + 1][1]).norm());
    SAGITTA * wide * turn <= tolerance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rulings of a cylinder of radius 100, at angles.
    fn cylinder(angles: impl Iterator<Item = f64>) -> Vec<[Vec3; 2]> {
        angles.map(|a| [0.0, 80.0].map(|z| Vec3::new(100.0 * a.cos(), 100.0 * a.sin(), z))).collect()
    }

    #[test]
    fn two_groups_are_parted_and_a_wide_stretch_of_one_sheet_is_not() {
        let two = cylinder((0..10).map(|k| 0.05 * f64::from(k) + if k < 5 { 0.0 } else { 1.0 }));
        assert_eq!(gaps(&two).iter().map(|g| g.after).collect::<Vec<_>>(), [4]);
        assert_eq!(groups(&two, 0.1).iter().map(Vec::len).collect::<Vec<_>>(), [5, 5]);
        let one = cylinder((0..10).map(|k| 0.05 * f64::from(k)));
        assert!(gaps(&one).is_empty() && groups(&one, 0.1).len() == 1);
        // A plane between two bends is one sheet with them.
        let flat = |k: i32| {
            let (x, z) = (f64::from(k), 0.01 * f64::from(k - 4).powi(2));
            let x = if k < 5 { x } else { x + 60.0 };
            [
                Vec3::new(x, 0.0, if k < 5 { z } else { 0.01 * f64::from(k - 5).powi(2) }),
                Vec3::new(x, 50.0, if k < 5 { z } else { 0.01 * f64::from(k - 5).powi(2) }),
            ]
        };
        let bends: Vec<[Vec3; 2]> = (0..10).map(flat).collect();
        assert_eq!((gaps(&bends).len(), groups(&bends, 0.5).len()), (1, 1));
        // Ends that jump along their rulings by much more than these are apart.
        let mut notched = cylinder((0..10).map(|k| 0.05 * f64::from(k)));
        notched[4..7].iter_mut().for_each(|r| r[0].z = 60.0);
        assert!(gaps(&notched).is_empty() && steps(&notched).iter().all(|s| *s < 5.1), "{:?}", steps(&notched));
        // Too few for a sheet of their own.
        let few = cylinder((0..10).map(|k| 0.05 * f64::from(k) + if k < 8 { 0.0 } else { 1.0 }));
        assert_eq!(groups(&few, 0.1).len(), 1);
    }
}
