//! Panels that meet, cut into parts that still do: a part keeps the torse of its panel and its share of the panel's edges, and
//! the cut is an edge of both its sides, as one torse goes through it. Nothing is judged here.

use super::intersection::Intersections;
use super::seams::{clashing, kept, pair, SharedSeam};
use crate::fit::panels::boundary::SeamChain;
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::search::cover::Cover;
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};

/// Panels that are cut.
pub(crate) struct Wholes<'a> {
    /// The regions of a face.
    pub cover: &'a Cover,
    /// Panels on them.
    pub panels: &'a Patchwork,
}

impl Wholes<'_> {
    /// The panels in parts: a cover whose regions share the torses of those that they are parts of.
    pub fn in_parts<'b>(&'b self, cover: &'b Cover) -> Parts<'b> {
        Parts { of: self, cover }
    }

    /// The region with a torse.
    fn with_torse(&self, torse: &Torse) -> Option<u32> {
        self.cover.panels.iter().find(|(_, fit)| fit.torse == *torse).map(|(whole, _)| *whole)
    }

    /// The edges of the panels, by their regions; none of those that have several with a neighbour.
    fn known(&self) -> BTreeMap<[u32; 2], Curve<3>> {
        let mut out: BTreeMap<[u32; 2], Option<Curve<3>>> = BTreeMap::new();
        for e in kept(self.panels, &self.cover.borders()) {
            out.entry(pair(e.labels)).and_modify(|known| *known = None).or_insert(Some(e.edge));
        }
        out.into_iter().filter_map(|(labels, edge)| Some((labels, edge?))).collect()
    }
}

/// Panels in parts.
pub(crate) struct Parts<'a> {
    of: &'a Wholes<'a>,
    /// The regions of the parts.
    cover: &'a Cover,
}

impl Parts<'_> {
    /// The regions on both sides of a border between parts.
    fn beside(&self, labels: [u32; 2]) -> Option<[u32; 2]> {
        let [a, b] = labels.map(|label| self.of.with_torse(&self.cover.panels.get(&label)?.torse));
        Some(pair([a?, b?]))
    }

    /// Whether the border between two parts is a cut through one region.
    pub fn is_cut(&self, labels: [u32; 2]) -> bool {
        self.beside(labels).is_some_and(|[a, b]| a == b)
    }

    /// The cover of the parts with the vertices in which they are cut under the edges of the panels.
    pub fn settled(&self) -> Cover {
        let whole_of = |label: &u32| self.beside([*label; 2]).map_or(*label, |[whole, _]| whole);
        let mut partition = self.cover.partition.clone();
        partition.labels = partition.labels.iter().map(whole_of).collect();
        let whole = self.of.cover.with_partition(partition);
        let known = self.of.known();
        let along: Vec<[u32; 2]> = known.keys().copied().collect();
        let intersections =
            Intersections::new(&whole.torses()).with_known_edges(known.into_iter().collect(), Vec::new());
        let settled = intersections.on(&whole).settled(&along);
        let vertices = settled.partition.vertices;
        self.cover.with_partition(Partition { vertices, ..self.cover.partition.clone() })
    }

    /// The edges of the parts: cuts, and shares of those of the panels.
    pub fn edges(&self) -> Vec<SharedSeam> {
        let before = self.of.cover.borders();
        let old = kept(self.of.panels, &before);
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
        let after = self.cover.borders();
        let mut edges = kept(self.of.panels, &after);
        let chains = after.seam_chains();
        let is_new = |c: &&SeamChain| edges.iter().all(|e| e.chain != c.chain);
        let new: BTreeSet<[u32; 2]> = chains.iter().filter(is_new).map(|c| pair(c.labels)).collect();
        let is_edge = |p: &[u32; 2]| {
            self.is_cut(*p) || self.beside(*p).is_some_and(|of| old.iter().any(|e| pair(e.labels) == of))
        };
        let wanted: Vec<[u32; 2]> = new.into_iter().filter(is_edge).collect();
        // Where a panel has several edges with a neighbour its parts intersect those of that anew.
        let known = self.of.known();
        let known = wanted.iter().filter_map(|p| Some((*p, known.get(&self.beside(*p)?)?.clone()))).collect();
        let intersections = Intersections::new(&self.cover.torses()).with_known_edges(known, Vec::new());
        let (found, _) = intersections.on(self.cover).edges_through(&ends, &wanted);
        let found = found.into_iter().filter(|e| edges.iter().all(|k| k.chain != e.chain));
        edges.extend(found.collect::<Vec<_>>());
        let clashing = clashing(&edges, &after);
        edges.retain(|e| !clashing.contains(&pair(e.labels)));
        edges
    }
}
