//! A cover whose strips are to meet, and what is asked of them.

use super::openness::{both, exact, openness, unproven};
use super::seams::SharedSeam;
use crate::certify::Known;
use crate::control::Control;
use crate::geom::Vec3;
use crate::patchwork::panel::Coedge;
use crate::search::build::{build_on, limits_missed, Built, Joined};
use crate::search::cover::{Cover, CoverOptions};
use crate::search::joint::BorderCounts;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// A cover whose strips are to meet, and what is asked of them.
pub(super) struct Stitching<'a> {
    /// Number of the face.
    pub index: usize,
    /// Its cover.
    pub cover: &'a Cover,
    /// Its panels as they are at first.
    pub built: &'a Built,
    pub tolerance: f64,
    /// Limits of sheet and material, seams that must stay.
    pub wanted: &'a CoverOptions,
    pub control: &'a Control,
    /// What was proven on the way.
    pub known: Arc<Known>,
    /// Labels whose flat patterns are not proven without common edges either, once they are asked for.
    pub unproven: OnceLock<BTreeSet<u32>>,
    /// Largest distance (tolerances) of a sample with which strips of the program are worth being built.
    pub most: f64,
    /// What distances count on the border of the face.
    pub borders: Option<&'a BorderCounts<'a>>,
}

impl Stitching<'_> {
    /// Whether panels are nearer to meeting than others, and miss no more limits.
    pub fn is_better(&self, next: &Built, than: &Built) -> bool {
        let is_nearer = openness(next) < openness(than) && exact(next) >= exact(than);
        is_nearer && self.limits_missed(next) <= self.limits_missed(than)
    }

    /// Whether panels meet as those did that there were at first, and miss no more limits.
    pub fn is_no_worse(&self, next: &Built) -> bool {
        exact(next) >= exact(self.built)
            && openness(next) <= openness(self.built)
            && self.limits_missed(next) <= self.limits_missed(self.built)
    }

    /// Limits of sheet and material that are missed.
    fn limits_missed(&self, b: &Built) -> usize {
        limits_missed(&b.patchwork, &b.certificate, &b.patterns, &self.wanted.limits).reasons.len()
    }

    /// Panels with common edges, and the labels of those that are refused: also for a flat pattern that is not proven, but is
    /// without these edges.
    pub fn built_on(&self, cover: &Cover, edges: &[SharedSeam]) -> (Built, Vec<u32>) {
        let joined = Joined { edges, known: &self.known };
        let (next, mut bad) = build_on(self.index, cover, (self.tolerance, self.control), joined);
        if bad.is_empty() {
            bad = unproven(&next, self.control);
            if !bad.is_empty() {
                let before = self.unproven.get_or_init(|| unproven(self.built, self.control).into_iter().collect());
                bad.retain(|l| !before.contains(l));
            }
        }
        (next, bad)
    }

    /// Whether the border between two labels lies in a plane or on a line in which a seam must run: such borders stay.
    pub fn is_asked_for(&self, built: &Built, labels: [u32; 2]) -> bool {
        let (planes, lines) = (&self.wanted.layout.seams, &self.cover.seam_lines);
        let any = !planes.is_empty() || !lines.is_empty();
        let Some(partition) = built.patchwork.partitions.first().filter(|_| any) else { return false };
        let seams = built.patchwork.seams();
        let mut runs =
            seams.iter().filter(|s| both(s.sides.map(|s| s.of.label())) == Some(labels)).map(|s| s.sides[0].run);
        let place = |v: &u32| {
            let [a, b] = partition.vertices[*v as usize];
            self.cover.face.surface.point(a, b)
        };
        let along = |r: &Coedge, height: &dyn Fn(&Vec3) -> f64| {
            r.vertices.iter().all(|v| height(&place(v)).abs() <= self.tolerance)
        };
        runs.any(|r| {
            planes.iter().any(|p| along(r, &|x| p.height(x))) || lines.iter().any(|l| along(r, &|x| l.height(x)))
        })
    }
}
