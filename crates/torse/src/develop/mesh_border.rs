//! The border of triangles laid flat, and the parts in which they hang together.

use super::scanned::closed_walks;
use crate::geom::Vec2;
use std::collections::{HashMap, HashSet};

/// Triangles, by index, in parts that hang together along sides; larger parts first.
pub(crate) fn parts(triangles: &[[u32; 3]], chosen: &[u32]) -> Vec<Vec<u32>> {
    let mut beside: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (i, &t) in chosen.iter().enumerate() {
        sides(triangles[t as usize]).for_each(|s| beside.entry(either_way(s)).or_default().push(i));
    }
    let mut seen = vec![false; chosen.len()];
    let mut out = Vec::new();
    for start in 0..chosen.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut part, mut next) = (vec![start], 0);
        while let Some(&i) = part.get(next) {
            next += 1;
            for s in sides(triangles[chosen[i] as usize]) {
                for &j in &beside[&either_way(s)] {
                    if !std::mem::replace(&mut seen[j], true) {
                        part.push(j);
                    }
                }
            }
        }
        part.sort_unstable();
        out.push(part.into_iter().map(|i| chosen[i]).collect::<Vec<u32>>());
    }
    out.sort_by_key(|p| std::cmp::Reverse(p.len()));
    out
}

/// The border of triangles as closed loops of corners, the outer one first, counter-clockwise, then holes. `flat` has the place
/// of every corner in the plane. `None` where a triangle has no area there, sides belong to more than two triangles, or the
/// border falls apart.
pub(crate) fn border(triangles: &[[u32; 3]], flat: &HashMap<u32, Vec2>) -> Option<Vec<Vec<u32>>> {
    let mut directed: HashSet<[u32; 2]> = HashSet::new();
    for t in triangles {
        let [a, b, c] = [flat.get(&t[0])?, flat.get(&t[1])?, flat.get(&t[2])?];
        let turn = (b - a).perp(&(c - a));
        let way = if turn > 0.0 { *t } else { [t[0], t[2], t[1]] };
        // Triangles of meshes may look to either side; laid flat they turn one way.
        if turn == 0.0 || !sides(way).all(|s| directed.insert(s)) {
            return None;
        }
    }
    let mut next: HashMap<usize, Vec<usize>> = HashMap::new();
    let mut open: Vec<&[u32; 2]> = directed.iter().filter(|[a, b]| !directed.contains(&[*b, *a])).collect();
    open.sort_unstable();
    open.iter().for_each(|[a, b]| next.entry(*a as usize).or_default().push(*b as usize));
    let walks = closed_walks(next);
    let mut loops: Vec<(f64, Vec<u32>)> = walks
        .into_iter()
        .map(|w| {
            let w: Vec<u32> = w.into_iter().map(|i| i as u32).collect();
            let place = |k: usize| flat[&w[k % w.len()]];
            let turn = |k: usize| 0.5 * (place(k) - place(0)).perp(&(place(k + 1) - place(0)));
            let area = (0..w.len()).map(turn).sum::<f64>();
            (area, w)
        })
        .collect();
    loops.sort_by(|a, b| b.0.total_cmp(&a.0));
    let outer = loops.iter().filter(|l| l.0 > 0.0).count();
    (outer == 1).then(|| loops.into_iter().map(|l| l.1).collect())
}

fn sides([a, b, c]: [u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[a, b], [b, c], [c, a]].into_iter()
}

fn either_way([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of a grid, each in two triangles, one of which looks the other way; corners are numbered by rows of ten.
    fn squares(of: &[[u32; 2]]) -> Vec<[u32; 3]> {
        of.iter()
            .flat_map(|[x, y]| {
                let at = |i: u32, j: u32| 10 * (y + j) + x + i;
                [[at(0, 0), at(1, 0), at(0, 1)], [at(1, 1), at(1, 0), at(0, 1)]]
            })
            .collect()
    }

    fn flat() -> HashMap<u32, Vec2> {
        (0..100).map(|k| (k, Vec2::new(f64::from(k % 10), f64::from(k / 10)))).collect()
    }

    #[test]
    fn a_ring_has_an_outer_loop_and_a_hole_whichever_way_its_triangles_look() {
        let ring: Vec<[u32; 2]> = (0..9).filter(|k| *k != 4).map(|k| [k % 3, k / 3]).collect();
        let loops = border(&squares(&ring), &flat()).expect("a border");
        assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [12, 4]);
        assert!([11, 12, 21, 22].iter().all(|c| loops[1].contains(c)));
        // The same square twice is no sheet.
        assert_eq!(border(&squares(&[[0, 0], [0, 0]]), &flat()), None);
    }

    #[test]
    fn triangles_that_meet_in_a_corner_only_are_two_parts() {
        let all = squares(&[[0, 0], [1, 1], [2, 1]]);
        let chosen: Vec<u32> = (0..6).collect();
        assert_eq!(parts(&all, &chosen), [vec![2, 3, 4, 5], vec![0, 1]]);
        let corner: Vec<[u32; 3]> = all.clone();
        assert_eq!(border(&corner, &flat()), None);
    }
}
