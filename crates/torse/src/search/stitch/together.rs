//! Strips of a cover that are changed together, in one program, and the panels that they come to.

use super::bordering::{Bordering, Moving, Refused};
use super::intersection::Intersections;
use super::openness::places_too_far;
use super::seams::pair;
use super::stitching::Stitching;
use crate::fit::near::samples::Fit;
use crate::patchwork::redraw::NewBorder;
use crate::search::build::Built;
use crate::search::cover::{Cover, Job};
use crate::search::joint::{self, Asked, JoinedLine, Joint};
use crate::torse::form::PanelKind;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Shares of their regularity that strips keep in the program, in turn until all seams are closed. Alone the first closes 7 of 7
/// on the hull at 5 mm and 8 of 9 on the monkey saddle at 10 mm, the second 5 and 9.
pub(super) const REGULAR: [f64; 2] = [1.0, 0.9];
/// Times that the program over all strips is solved with other places where panels were too far away, at most.
pub(super) const REFINEMENTS: usize = 2;
/// Times that it is solved without strips that were refused, at most.
const EXCLUSIONS: usize = 4;
/// Where a larger share of the strips is refused, only the worst is left out.
const REFUSED_SHARE: f64 = 1.0 / 3.0;

/// Strips of a cover that are changed together.
pub(super) struct Together<'a> {
    pub of: &'a Stitching<'a>,
    /// The cover, with the torses to begin with.
    pub base: &'a Cover,
}

impl Together<'_> {
    /// Strips of the program over all of them, with their borders under their edges; strips that are refused all the same
    /// stay as they are, with their borders. So do borders of the panels at hand that were asked for.
    pub fn joined(&self, regular: f64, at_hand: &Built) -> Option<Built> {
        let stays = |labels: [u32; 2]| self.of.is_asked_for(at_hand, pair(labels));
        let mut without = BTreeSet::new();
        for _ in 0..=EXCLUSIONS {
            let &Stitching { tolerance, borders: on_border, most, .. } = self.of;
            let asked = Asked { held: &stays, without: &without, regular, tolerance, borders: on_border, most };
            let mut joint = Joint::new(self.base, self.base.borders().seam_chains(), &asked)?;
            match self.refined(&mut joint) {
                Ok(found) => return Some(found),
                Err(labels) if labels.iter().all(|l| without.contains(l)) => return None,
                Err(labels) => without.extend(labels),
            }
        }
        None
    }

    /// Panels of strips that were changed together. Places where they are too far away count the next time. Errors are the
    /// labels to do without.
    fn refined(&self, joint: &mut Joint) -> Result<Built, Vec<u32>> {
        for refinement in 0..=REFINEMENTS {
            let joined = joint.joined(self.of.control).filter(|_| !self.of.control.stopped()).ok_or_else(Vec::new)?;
            if refinement == 0 && self.is_too_far(&joined) {
                return Err(Vec::new());
            }
            match self.placed(joined, refinement == REFINEMENTS) {
                Ok(found) => return Ok(found),
                Err(refused) if refused.counted(joint, 0) => {}
                Err(refused) => return Err(refused.labels),
            }
        }
        Err(Vec::new())
    }

    /// Where many strips are too far away all are as near as they get: no proof will find them nearer.
    pub fn is_too_far(&self, joined: &joint::Joined) -> bool {
        if self.of.most.is_finite() {
            return joined.distances.iter().any(|d| *d > self.of.most);
        }
        let far = joined.distances.iter().filter(|d| **d > 1.0).count();
        far as f64 > REFUSED_SHARE * joined.distances.len() as f64
    }

    /// Panels of strips that were changed together. The `last` time a few strips that are refused are laid anew each for itself.
    /// Errors are the labels to do without, or places that should count the next time.
    pub fn placed(&self, joined: joint::Joined, last: bool) -> Result<Built, Refused> {
        let without = |labels: Vec<u32>| Refused { labels, too_far: Vec::new() };
        let worst = joined.torses.iter().zip(&joined.distances).max_by(|a, b| a.1.total_cmp(b.1)).map(|w| w.0 .0);
        let mut next = self.base.clone();
        for (label, torse) in joined.torses {
            let fit = next.panels.get(&label).ok_or_else(Refused::default)?;
            let fit = Fit { torse, kind: PanelKind::Torse, ..(**fit).clone() };
            next.panels.insert(label, Arc::new(fit));
        }
        if joined.lines.is_empty() {
            // A strip that has no neighbours in its face.
            let (built, labels) = self.of.built_on(&next, &[]);
            let too_far = if last { Vec::new() } else { places_too_far(&built) };
            return if labels.is_empty() { Ok(built) } else { Err(Refused { labels, too_far }) };
        }
        let along_lines = next.redrawn(&joined.lines);
        if let Some(crossing) = along_lines.as_ref().err().filter(|c| !c.is_empty()) {
            // Lines cross where a strip has become nothing: the smaller of both.
            let area = |label: u32| self.base.region(label).area();
            let smaller = |[a, b]: &[u32; 2]| if area(*a) < area(*b) { *a } else { *b };
            return Err(without(crossing.iter().map(smaller).collect()));
        }
        let along_lines = along_lines.ok();
        let edges: Vec<_> = joined.lines.into_iter().filter_map(|l| Some((pair(l.labels), l.edge?))).collect();
        let wanted: Vec<[u32; 2]> = edges.iter().map(|e| e.0).collect();
        let vertices = joined.vertices.into_iter().map(|v| (v.labels, v.place)).collect();
        let torses = next.torses();
        let strips = Intersections::new(&torses).with_known_edges(edges, vertices);
        let moved = |cover: &Cover, wanted: &[[u32; 2]], how: Moving| {
            let base = strips.on(cover).with_vertices();
            Bordering { of: self.of, strips: &strips, base: &base, how }.panels(wanted.to_vec())
        };
        let mut refused = match along_lines.as_ref().map(|s| moved(s, &wanted, Moving::Done)) {
            Some(Ok(found)) => return Ok(found),
            Some(Err(refused)) => refused,
            None => Refused::default(),
        };
        let at_first = refused.labels.clone();
        if refused.too_far.is_empty() {
            // Borders may be at fault; cut out of the old ones they are others.
            match moved(&next, &wanted, Moving::Cut) {
                Ok(found) => return Ok(found),
                Err(other) if refused.labels.is_empty() || other.labels.len() < refused.labels.len() => refused = other,
                Err(_) => {}
            }
        }
        if !last && !refused.too_far.is_empty() {
            return Err(refused);
        }
        if let Some(mended) = along_lines.and_then(|s| self.mended(s, &at_first)) {
            let others = |p: &[u32; 2]| !p.iter().any(|l| at_first.contains(l));
            let wanted: Vec<_> = wanted.into_iter().filter(others).collect();
            if let Ok(found) = moved(&mended, &wanted, Moving::Done) {
                return Ok(found);
            }
        }
        let few = refused.labels.len() as f64 <= REFUSED_SHARE * next.panels.len() as f64;
        let is_kept = few || refused.labels.is_empty();
        Err(without(if is_kept { refused.labels } else { worst.into_iter().collect() }))
    }

    /// The cover with a few strips that were refused laid anew on their regions, each for itself.
    fn mended(&self, mut cover: Cover, labels: &[u32]) -> Option<Cover> {
        if labels.is_empty() || labels.len() as f64 > REFUSED_SHARE * cover.panels.len() as f64 {
            return None;
        }
        for label in labels {
            let fits = [self.base, &cover].map(|s| s.panels.get(label).cloned());
            let found = Job::new(&self.of.cover.face, self.of.wanted, self.of.control)
                .laid_anew(cover.region(*label), fits.iter().flatten())?;
            cover.panels.insert(*label, found);
        }
        Some(cover)
    }
}

impl Cover {
    /// The cover with its borders along lines. The errors of [`Partition::redrawn`](crate::patchwork::partition::Partition::redrawn).
    fn redrawn(&self, lines: &[JoinedLine]) -> Result<Cover, Vec<[u32; 2]>> {
        let lines: Vec<NewBorder> = lines.iter().map(|l| NewBorder { labels: l.labels, uv: &l.uv }).collect();
        let (u, v) = (self.face.surface.knots_u.breaks(), self.face.surface.knots_v.breaks());
        Ok(self.with_partition(self.partition.redrawn(&lines, [&u, &v])?))
    }
}
