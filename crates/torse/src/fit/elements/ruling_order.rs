//! The order of rulings along a surface, for drawings that give lines in any order and direction.
//!
//! *Method.* A chain of nearest neighbours from the outermost ruling, unless the given order makes a shorter one; both
//! ends count in the distance, whichever way it is the smaller one. It prepares rows for \[PW99, 4.3\].

use crate::geom::Vec3;

/// The rulings in order along the surface, all in the same direction.
///
/// *Input*: finite ends. *Cost*: quadratic. *Not guaranteed*: the order of rulings that are as near across a gap as along
/// the surface.
pub(crate) fn ordered(rulings: &[[Vec3; 2]]) -> Vec<[Vec3; 2]> {
    let given = aligned(rulings.to_vec());
    let Some(start) = outermost(rulings) else { return given };
    let mut rest: Vec<[Vec3; 2]> = rulings.to_vec();
    let mut chain = vec![rest.swap_remove(start)];
    while let Some(last) = chain.last().copied() {
        let next = (0..rest.len()).min_by(|&i, &j| gap(&last, &rest[i]).total_cmp(&gap(&last, &rest[j])));
        match next {
            Some(i) => chain.push(rest.swap_remove(i)),
            None => break,
        }
    }
    let chain = aligned(chain);
    let length = |c: &[[Vec3; 2]]| c.windows(2).map(|w| gap(&w[0], &w[1])).sum::<f64>();
    if length(&chain) < length(&given) {
        chain
    } else {
        given
    }
}

/// Distance of rulings as segments without direction.
fn gap(a: &[Vec3; 2], b: &[Vec3; 2]) -> f64 {
    let same = (a[0] - b[0]).norm() + (a[1] - b[1]).norm();
    same.min((a[0] - b[1]).norm() + (a[1] - b[0]).norm())
}

/// Turned so that neighbours point the same way.
fn aligned(mut chain: Vec<[Vec3; 2]>) -> Vec<[Vec3; 2]> {
    for i in 1..chain.len() {
        let (a, b) = (chain[i - 1], chain[i]);
        if (a[0] - b[0]).norm() + (a[1] - b[1]).norm() > (a[0] - b[1]).norm() + (a[1] - b[0]).norm() {
            chain[i].swap(0, 1);
        }
    }
    chain
}

/// The ruling farthest from the one that is farthest from the middle: an end of the row.
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
}
