//! Minimum cuts of graphs with terminal capacities, by Dinic's blocking flows.

use std::collections::VecDeque;

/// Flow below this share of the largest capacity counts as none.
const NEGLIGIBLE: f64 = 1e-9;

/// A two-label energy `Σ unary + Σ pairwise` with non-negative costs.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabelGraph {
    unary: Vec<[f64; 2]>,
    pairs: Vec<(usize, usize, f64)>,
}

struct Arc {
    to: usize,
    capacity: f64,
}

impl LabelGraph {
    /// A graph of `n` nodes; `unary[i] = [cost of label 0, cost of label 1]`.
    pub fn new(unary: Vec<[f64; 2]>) -> Self {
        Self { unary, pairs: Vec::new() }
    }

    /// Adds the cost of giving two nodes different labels.
    pub fn pair(&mut self, a: usize, b: usize, cost: f64) {
        self.pairs.push((a, b, cost));
    }

    /// A labelling of least cost: `true` for label 1.
    #[expect(clippy::too_many_lines, reason = "one algorithm with its state")]
    pub fn labelling(&self) -> Vec<bool> {
        let n = self.unary.len();
        let (source, sink) = (n, n + 1);
        let mut arcs: Vec<Arc> = Vec::new();
        let mut out: Vec<Vec<usize>> = vec![Vec::new(); n + 2];
        let mut connect = |a: usize, b: usize, forward: f64, backward: f64| {
            out[a].push(arcs.len());
            arcs.push(Arc { to: b, capacity: forward });
            out[b].push(arcs.len());
            arcs.push(Arc { to: a, capacity: backward });
        };
        let mut largest: f64 = 0.0;
        for (i, &[zero, one]) in self.unary.iter().enumerate() {
            // On the source's side: label 0. Cutting source → i costs label 1, cutting i → sink costs label 0.
            let common = zero.min(one);
            if one > common {
                connect(source, i, one - common, 0.0);
            }
            if zero > common {
                connect(i, sink, zero - common, 0.0);
            }
            largest = largest.max(zero.max(one) - common);
        }
        for &(a, b, c) in &self.pairs {
            connect(a, b, c, c);
        }
        let least = NEGLIGIBLE * largest;
        let mut level = vec![0u32; n + 2];
        loop {
            level.fill(u32::MAX);
            level[source] = 0;
            let mut queue = VecDeque::from([source]);
            while let Some(v) = queue.pop_front() {
                for &k in &out[v] {
                    let a = &arcs[k];
                    if a.capacity > least && level[a.to] == u32::MAX {
                        level[a.to] = level[v] + 1;
                        queue.push_back(a.to);
                    }
                }
            }
            if level[sink] == u32::MAX {
                return (0..n).map(|i| level[i] == u32::MAX).collect();
            }
            // Blocking flow by depth-first search along levels, without recursion.
            let mut next = vec![0usize; n + 2];
            let mut path: Vec<usize> = Vec::new();
            let mut v = source;
            loop {
                if v == sink {
                    let flow = path.iter().map(|&k| arcs[k].capacity).fold(f64::INFINITY, f64::min);
                    let mut back = 0;
                    for (i, &k) in path.iter().enumerate().rev() {
                        arcs[k].capacity -= flow;
                        arcs[k ^ 1].capacity += flow;
                        if arcs[k].capacity <= least {
                            back = i;
                        }
                    }
                    v = arcs[path[back] ^ 1].to;
                    path.truncate(back);
                    continue;
                }
                let mut advanced = false;
                while next[v] < out[v].len() {
                    let k = out[v][next[v]];
                    let a = &arcs[k];
                    if a.capacity > least && level[a.to] == level[v] + 1 {
                        path.push(k);
                        v = a.to;
                        advanced = true;
                        break;
                    }
                    next[v] += 1;
                }
                if advanced {
                    continue;
                }
                match path.pop() {
                    Some(k) => {
                        v = arcs[k ^ 1].to;
                        next[v] += 1;
                    }
                    None => break,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cheapest_labelling_of_small_graphs() {
        // All labellings of random graphs on eight nodes are tried.
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / (1u64 << 24) as f64
        };
        for _ in 0..20 {
            let mut g = LabelGraph::new((0..8).map(|_| [random(), random()]).collect());
            for a in 0..8 {
                for b in a + 1..8 {
                    if random() < 0.5 {
                        g.pair(a, b, 0.5 * random());
                    }
                }
            }
            let cost = |l: &dyn Fn(usize) -> bool| {
                (0..8).map(|i| g.unary[i][usize::from(l(i))]).sum::<f64>()
                    + g.pairs.iter().filter(|p| l(p.0) != l(p.1)).map(|p| p.2).sum::<f64>()
            };
            let found = g.labelling();
            let best = (0..256).map(|m| cost(&|i| m >> i & 1 == 1)).fold(f64::INFINITY, f64::min);
            assert!(cost(&|i| found[i]) <= best + 1e-6);
        }
    }
}
