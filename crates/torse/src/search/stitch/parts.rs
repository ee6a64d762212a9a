//! Panels that meet, cut into parts that still do: a part keeps the torse of its panel and its share of the panel's edges, and
//! the cut is an edge of both its sides, as one torse goes through it. Nothing is judged here.

use super::attempts::clashing;
use super::intersection::{pair, Intersections};
use super::seams::{kept, SharedSeam};
use crate::fit::panels::boundary::SeamChain;
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::search::cover::Cover;
use crate::spline::curve::Curve;
use std::collections::{BTreeMap, BTreeSet};

/// Panels that are cut.
pub(crate) struct Wholes<'a> {
    /// The regions of a face.
    pub cover: &'a Cover,
    /// Panels on them.
    pub panels: &'a Patchwork,
}

impl Wholes<'_> {
    /// The regions on both sides of a border between parts, which share the torses of their regions.
    fn beside(&self, parts: &Cover, labels: [u32; 2]) -> Option<[u32; 2]> {
        let whole_of = |label: u32| {
            let torse = &parts.panels.get(&label)?.torse;
            self.cover.panels.iter().find(|(_, fit)| fit.torse == *torse).map(|(whole, _)| *whole)
        };
        let [a, b] = labels.map(whole_of);
        Some(pair([a?, b?]))
    }

    /// Whether the border between two parts is a cut through one region.
    pub fn is_cut(&self, parts: &Cover, labels: [u32; 2]) -> bool {
        self.beside(parts, labels).is_some_and(|[a, b]| a == b)
    }

    /// The edges of the panels, by their regions; none of those that have several with a neighbour.
    fn known(&self) -> BTreeMap<[u32; 2], Curve<3>> {
        let mut out: BTreeMap<[u32; 2], Option<Curve<3>>> = BTreeMap::new();
        for e in kept(self.panels, &self.cover.borders()) {
            out.entry(pair(e.labels)).and_modify(|known| *known = None).or_insert(Some(e.edge));
        }
        out.into_iter().filter_map(|(labels, edge)| Some((labels, edge?))).collect()
    }

    /// The parts with the vertices in which they are cut under the edges of the panels.
    pub fn settled(&self, parts: &Cover) -> Cover {
        let whole_of = |label: &u32| self.beside(parts, [*label; 2]).map_or(*label, |[whole, _]| whole);
        let mut partition = parts.partition.clone();
        partition.labels = partition.labels.iter().map(whole_of).collect();
        let known = self.known();
        let along: Vec<[u32; 2]> = known.keys().copied().collect();
        let intersections = Intersections::new(&self.cover.face, &self.cover.torses())
            .with_known_edges(known.into_iter().collect(), Vec::new());
        let settled = intersections.settled(&self.cover.with_partition(partition), &along);
        parts.with_partition(Partition { vertices: settled.partition.vertices, ..parts.partition.clone() })
    }

    /// The edges of the parts: cuts, and shares of those of the panels.
    pub fn edges(&self, parts: &Cover) -> Vec<SharedSeam> {
        let before = self.cover.borders();
        let old = kept(self.panels, &before);
        // Points in which edges end already, by vertex.
        let chains = before.seam_chains();
        let mut ends: BTreeMap<u32, Vec3> = BTreeMap::new();
        for e in &old {
            let Some(SeamChain { vertices, .. }) = chains.iter().find(|c| c.chain == e.chain) else { continue };
            let control = &e.edge.control;
            for (v, x) in [(vertices.first(), control.first()), (vertices.last(), control.last())] {
                ends.extend(v.zip(x).map(|(v, x)| (*v, Vec3::from(*x))));
            }
        }
        // Edges beside which nothing is cut stay.
        let after = parts.borders();
        let mut edges = kept(self.panels, &after);
        let chains = after.seam_chains();
        let is_new = |c: &&SeamChain| edges.iter().all(|e| e.chain != c.chain);
        let new: BTreeSet<[u32; 2]> = chains.iter().filter(is_new).map(|c| pair(c.labels)).collect();
        let is_edge = |p: &[u32; 2]| {
            self.is_cut(parts, *p) || self.beside(parts, *p).is_some_and(|of| old.iter().any(|e| pair(e.labels) == of))
        };
        let wanted: Vec<[u32; 2]> = new.into_iter().filter(is_edge).collect();
        // Where a panel has several edges with a neighbour its parts intersect those of that anew.
        let known = self.known();
        let known = wanted.iter().filter_map(|p| Some((*p, known.get(&self.beside(parts, *p)?)?.clone()))).collect();
        let intersections = Intersections::new(&parts.face, &parts.torses()).with_known_edges(known, Vec::new());
        let (found, _) = intersections.edges_through(&ends, parts, &after, &wanted);
        let found = found.into_iter().filter(|e| edges.iter().all(|k| k.chain != e.chain));
        edges.extend(found.collect::<Vec<_>>());
        let clashing = clashing(&edges, &after);
        edges.retain(|e| !clashing.contains(&pair(e.labels)));
        edges
    }
}
