//! Regions of a measured surface without creases and gaps, with normals oriented alike.
//!
//! *Method.* Neighbouring estimates are linked unless their normals differ by a crease's angle or one lies far above the
//! other's plane; connected components are the regions, and orientation spreads along the links, the smoothest first
//! (\[PW99, 4.3\] asks for a segmentation before any fit).

use super::estimates::Estimates;
use crate::geom::Vec3;

/// Cosine between unoriented normals of neighbours, places or facets, below which there is a crease: 35°.
pub(super) const CREASE: f64 = 0.819_152_044_288_991_8;
/// Share of the distance by which a neighbour may lie above the tangent plane.
const STEP: f64 = 0.55;

/// A region.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Region {
    /// Estimates that belong to it.
    pub members: Vec<u32>,
    /// Their unit normals, oriented alike.
    pub normals: Vec<Vec3>,
}

/// Regions, the largest first. Estimates with more noise than `rough` (mm) lie on creases and corners and belong to none.
pub fn regions(estimates: &Estimates, rough: f64) -> Vec<Region> {
    let items = &estimates.items;
    let mut links: Vec<(f64, u32, u32)> = estimates
        .links
        .iter()
        .filter_map(|&(a, b)| {
            let (p, q) = (&items[a as usize], &items[b as usize]);
            if p.noise > rough || q.noise > rough {
                return None;
            }
            let d = q.x - p.x;
            let cosine = p.n.dot(&q.n).abs();
            let above = d.dot(&p.n).abs().max(d.dot(&q.n).abs());
            let noise = 3.0 * (p.noise + q.noise);
            (cosine >= CREASE && above <= STEP * d.norm() + noise).then_some((1.0 - cosine, a, b))
        })
        .collect();
    links.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    // Kruskal's tree: each set knows its members and their signs.
    let n = items.len();
    let mut set: Vec<usize> = (0..n).collect();
    let mut members: Vec<Vec<u32>> = (0..n as u32).map(|i| vec![i]).collect();
    let mut sign = vec![1.0_f64; n];
    for (_, a, b) in links {
        let (a, b) = (a as usize, b as usize);
        let (mut big, mut small) = (set[a], set[b]);
        if big == small {
            continue;
        }
        if members[big].len() < members[small].len() {
            std::mem::swap(&mut big, &mut small);
        }
        let flip = sign[a] * sign[b] * items[a].n.dot(&items[b].n) < 0.0;
        for k in std::mem::take(&mut members[small]) {
            if flip {
                sign[k as usize] = -sign[k as usize];
            }
            set[k as usize] = big;
            members[big].push(k);
        }
    }
    let mut out: Vec<Region> = members
        .into_iter()
        .filter(|m| m.first().is_some_and(|&i| items[i as usize].noise <= rough))
        .map(|mut m| {
            m.sort_unstable();
            let normals = m.iter().map(|&i| items[i as usize].n * sign[i as usize]).collect();
            Region { members: m, normals }
        })
        .collect();
    out.sort_by(|a, b| b.members.len().cmp(&a.members.len()).then(a.members.cmp(&b.members)));
    out
}
