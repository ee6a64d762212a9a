//! The order of rulings along a surface, for drawings that give lines in any order and direction.
//!
//! *Method.* A chain of nearest neighbours from the outermost ruling, unless the given order makes a shorter one; both
//! ends count in the distance, whichever way it is the smaller one. It prepares sequences for \[PW99, 4.3\].

use crate::geom::Vec3;

/// The rulings in order along the surface, all in the same direction. A ring whose last ruling repeats the first begins and ends
/// with that.
///
/// *Input*: finite ends. *Cost*: quadratic. *Not guaranteed*: the order of rulings that are as near across a gap as along
/// the surface.
pub(crate) fn ordered(rulings: &[[Vec3; 2]]) -> Vec<[Vec3; 2]> {
    let given = opened(aligned_sequence(rulings.to_vec()));
    let Some(start) = outermost(rulings) else { return given };
    if is_ring(&given) {
        let mut around = chain(&given[..given.len() - 1], 0);
        around.extend(given.last());
        let around = aligned_sequence(around);
        return if length(&around) < length(&given) { around } else { given };
    }
    let chain = opened(aligned_sequence(chain(rulings, start)));
    if length(&chain) < length(&given) && !is_around(&given, &chain) {
        chain
    } else {
        given
    }
}

/// Whether the last of some rulings repeats the first, up to the digits of files.
pub(crate) fn is_ring(rulings: &[[Vec3; 2]]) -> bool {
    let [first, .., last] = rulings else { return false };
    rulings.len() > RING && gap(first, last) <= ROUNDED * length(rulings) / rulings.len() as f64
}

/// Share by which distances may differ that are the same up to the digits of files.
const ROUNDED: f64 = 1e-6;

/// Distance of neighbours, in median distances, beyond which they may belong to two sheets, or to the two ends of one, and is
/// told of: rulings of one sheet lie closer where it bends more.
pub(crate) const WIDE: f64 = 5.0;

/// Rulings that are no ring if they are not more: the ends of a sequence of a few are near each other, too.
const RING: usize = 6;

/// Where a sequence of rulings goes around a ring and ends before its first ruling: the distance (mm) between both, and the middle.
pub(crate) fn opening(sequence: &[[Vec3; 2]]) -> Option<(f64, Vec3)> {
    let [first, .., last] = sequence else { return None };
    let middle = first.iter().chain(last).sum::<Vec3>() * 0.25;
    (joins(sequence) && !is_ring(sequence)).then(|| (0.5 * gap(first, last), middle))
}

/// Whether rulings come as they are around a ring which the `chain` of nearest ones only opens elsewhere.
fn is_around(given: &[[Vec3; 2]], chain: &[[Vec3; 2]]) -> bool {
    let (Some(a), Some(b)) = (closing(given), closing(chain)) else { return false };
    length(given) + a <= (length(chain) + b) * (1.0 + ROUNDED) && joins(chain)
}

/// A sequence around a ring opened where it meets one ruling twice, if it does.
fn opened(mut chain: Vec<[Vec3; 2]>) -> Vec<[Vec3; 2]> {
    let twice = (1..chain.len()).find(|&k| gap(&chain[k - 1], &chain[k]) <= 0.0);
    if let Some(k) = twice.filter(|_| joins(&chain)) {
        chain.rotate_left(k);
    }
    aligned_sequence(chain)
}

/// Whether the ends of a chain are as near each other as neighbours in it may be.
fn joins(chain: &[[Vec3; 2]]) -> bool {
    let mut steps: Vec<f64> = chain.windows(2).map(|w| gap(&w[0], &w[1])).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2);
    chain.len() > RING && usual.is_some_and(|usual| closing(chain).is_some_and(|c| c <= WIDE * usual))
}

/// Distance of the last ruling from the first.
fn closing(chain: &[[Vec3; 2]]) -> Option<f64> {
    Some(gap(chain.first()?, chain.last()?))
}

fn length(chain: &[[Vec3; 2]]) -> f64 {
    chain.windows(2).map(|w| gap(&w[0], &w[1])).sum()
}

/// A chain of nearest neighbours.
fn chain(rulings: &[[Vec3; 2]], start: usize) -> Vec<[Vec3; 2]> {
    let mut rest: Vec<[Vec3; 2]> = rulings.to_vec();
    let mut chain = vec![rest.swap_remove(start)];
    while let Some(last) = chain.last().copied() {
        let next = (0..rest.len()).min_by(|&i, &j| gap(&last, &rest[i]).total_cmp(&gap(&last, &rest[j])));
        match next {
            Some(i) => chain.push(rest.swap_remove(i)),
            None => break,
        }
    }
    chain
}

/// Distance of rulings as segments without direction.
fn gap(a: &[Vec3; 2], b: &[Vec3; 2]) -> f64 {
    let same = (a[0] - b[0]).norm() + (a[1] - b[1]).norm();
    same.min((a[0] - b[1]).norm() + (a[1] - b[0]).norm())
}

/// Turned so that neighbours point the same way.
fn aligned_sequence(mut chain: Vec<[Vec3; 2]>) -> Vec<[Vec3; 2]> {
    for i in 1..chain.len() {
        chain[i] = aligned(chain[i - 1], chain[i])[1];
    }
    chain
}

/// Two rulings, the second turned so that it points the same way.
pub(crate) fn aligned(a: [Vec3; 2], b: [Vec3; 2]) -> [[Vec3; 2]; 2] {
    if (a[0] - b[0]).norm() + (a[1] - b[1]).norm() > (a[0] - b[1]).norm() + (a[1] - b[0]).norm() {
        [a, [b[1], b[0]]]
    } else {
        [a, b]
    }
}

/// The ruling farthest from the one that is farthest from the middle: an end of the sequence.
fn outermost(rulings: &[[Vec3; 2]]) -> Option<usize> {
    let centre = |r: &[Vec3; 2]| 0.5 * (r[0] + r[1]);
    let middle = rulings.iter().map(centre).sum::<Vec3>() / rulings.len() as f64;
    let far = |from: Vec3| {
        (0..rulings.len())
            .max_by(|&i, &j| (centre(&rulings[i]) - from).norm().total_cmp(&(centre(&rulings[j]) - from).norm()))
    };
    far(centre(&rulings[far(middle)?]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shuffled_and_turned_rulings_are_put_in_order() {
        let line = |i: usize| {
            let t = i as f64 * 0.2;
            [Vec3::new(10.0 * t, 0.0, t.sin()), Vec3::new(10.0 * t, 30.0, t.sin())]
        };
        let mixed: Vec<[Vec3; 2]> = (0..20)
            .map(|i| {
                let k = (7 * i) % 20;
                let [p, q] = line(k);
                if k % 3 == 0 {
                    [q, p]
                } else {
                    [p, q]
                }
            })
            .collect();
        let got = ordered(&mixed);
        let up = got[0][0].x < got[19][0].x;
        for (i, r) in got.iter().enumerate() {
            let want = line(if up { i } else { 19 - i });
            assert!(*r == want || *r == [want[1], want[0]]);
            assert!((r[0].y - got[0][0].y).abs() < 1e-12);
        }
        assert!(ordered(&[]).is_empty());
    }

    /// Rulings of a cone of revolution at shares of a turn.
    fn cone(shares: impl Iterator<Item = f64>) -> Vec<[Vec3; 2]> {
        let ray = |t: f64| {
            let (s, c) = (std::f64::consts::TAU * t).sin_cos();
            Vec3::new(c, s, 2.0)
        };
        shares.map(|t| [ray(t) * 100.0, ray(t) * 200.0]).collect()
    }

    #[test]
    fn a_ring_stays_as_it_is_given() {
        let closed = cone((0..24).map(|k| f64::from(k % 23) / 23.0));
        assert!(is_ring(&closed) && ordered(&closed) == closed);
        // One way around and back again in files: another first ruling, and turned rulings.
        let open = cone((0..23).map(|k| f64::from((k + 9) % 23) / 23.0));
        assert!(!is_ring(&open) && ordered(&open) == open);
        let [p, q] = closed[23];
        let turned: Vec<[Vec3; 2]> = closed[..23].iter().copied().chain([[q, p]]).collect();
        assert_eq!(ordered(&turned), closed);
        // Mixed: still once around, and from one end to the other where nothing repeats.
        let mixed: Vec<[Vec3; 2]> = (0..24).map(|k| closed[if k < 23 { 7 * k % 23 } else { 0 }]).collect();
        let around = ordered(&mixed);
        assert!(around[0] == around[23] && (length(&around) / length(&closed) - 1.0).abs() < 1e-9);
        let twice: Vec<[Vec3; 2]> = (0..24).map(|k| closed[(k + 5) % 24]).collect();
        let opened = ordered(&twice);
        assert!(opened[0] == opened[23] && (length(&opened) / length(&closed) - 1.0).abs() < 1e-9, "{opened:?}");
    }
}
