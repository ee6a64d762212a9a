//! An order of the unknowns in which the matrix is a narrow band.
//!
//! Method: reverse Cuthill–McKee from an unknown far away \[CM69\]; the order as given is kept where it is as good.

use std::collections::BTreeSet;

/// Groups of unknowns that occur together, each once, sorted.
pub(super) fn cliques<'a>(columns: impl Iterator<Item = &'a [u32]>) -> Vec<Vec<u32>> {
    let all: BTreeSet<Vec<u32>> = columns
        .map(|c| {
            let mut c = c.to_vec();
            c.sort_unstable();
            c
        })
        .collect();
    all.into_iter().collect()
}

/// Neighbours of every unknown, sorted, without itself.
pub(super) fn neighbours(count: usize, cliques: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut out: Vec<Vec<u32>> = vec![Vec::new(); count];
    for clique in cliques {
        for &i in clique {
            out[i as usize].extend(clique.iter().copied().filter(|&j| j != i));
        }
        // Long lists of repeats would fill the memory.
        for &i in clique {
            let list = &mut out[i as usize];
            if list.len() > 16 * clique.len() {
                list.sort_unstable();
                list.dedup();
            }
        }
    }
    for list in &mut out {
        list.sort_unstable();
        list.dedup();
    }
    out
}

/// Half bandwidth, diagonal included, of an order: `place[i]` is the place of unknown `i`.
pub(super) fn width(cliques: &[Vec<u32>], place: &[u32]) -> usize {
    let mut most = 1;
    for c in cliques {
        let (mut lo, mut hi) = (u32::MAX, 0);
        for &i in c {
            lo = lo.min(place[i as usize]);
            hi = hi.max(place[i as usize]);
        }
        if lo <= hi {
            most = most.max((hi - lo + 1) as usize);
        }
    }
    most
}

/// Places of the unknowns in a narrow order.
pub(super) fn narrow(neighbours: &[Vec<u32>]) -> Vec<u32> {
    let n = neighbours.len();
    let mut order: Vec<u32> = Vec::with_capacity(n);
    let mut seen = vec![false; n];
    let mut starts: Vec<usize> = (0..n).collect();
    starts.sort_by_key(|&i| neighbours[i].len());
    for start in starts {
        if seen[start] {
            continue;
        }
        let from = far_from(start, neighbours);
        let first = order.len();
        seen[from] = true;
        order.push(from as u32);
        let mut next = first;
        while next < order.len() {
            let here = order[next] as usize;
            next += 1;
            let begin = order.len();
            for &j in &neighbours[here] {
                if !seen[j as usize] {
                    seen[j as usize] = true;
                    order.push(j);
                }
            }
            order[begin..].sort_by_key(|&j| neighbours[j as usize].len());
        }
    }
    let mut place = vec![0; n];
    for (k, &i) in order.iter().rev().enumerate() {
        place[i as usize] = k as u32;
    }
    place
}

/// An unknown far from the given one: a few times the last one that a walk by levels meets.
fn far_from(start: usize, neighbours: &[Vec<u32>]) -> usize {
    const WALKS: usize = 3;
    let mut at = start;
    let mut level = vec![usize::MAX; neighbours.len()];
    for _ in 0..WALKS {
        level.iter_mut().for_each(|l| *l = usize::MAX);
        let mut queue = vec![at];
        level[at] = 0;
        let mut next = 0;
        while next < queue.len() {
            let here = queue[next];
            next += 1;
            for &j in &neighbours[here] {
                if level[j as usize] == usize::MAX {
                    level[j as usize] = level[here] + 1;
                    queue.push(j as usize);
                }
            }
        }
        let deepest = queue.last().map_or(0, |&q| level[q]);
        let far = queue.iter().copied().filter(|&q| level[q] == deepest).min_by_key(|&q| neighbours[q].len());
        match far {
            Some(f) if f != at => at = f,
            _ => break,
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shuffled_chain_becomes_a_band() {
        // A chain whose links are numbered at random: 7 is a unit modulo 40.
        let link = |k: usize| ((7 * k) % 40) as u32;
        let pairs: Vec<[u32; 2]> = (0..39).map(|k| [link(k), link(k + 1)]).collect();
        let cliques = cliques(pairs.iter().map(|p| &p[..]));
        let given: Vec<u32> = (0..40).collect();
        assert!(width(&cliques, &given) > 5);
        let place = narrow(&neighbours(40, &cliques));
        assert_eq!(width(&cliques, &place), 2);
        let mut sorted = place.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, given);
    }
}
