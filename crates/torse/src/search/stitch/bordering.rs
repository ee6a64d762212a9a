//! Borders of a cover that are brought under edges, as far as its panels can be proven with them.

use super::intersection::Intersections;
use super::openness::{missed, places_too_far};
use super::seams::{self, clashing};
use super::stitching::Stitching;
use crate::search::build::Built;
use crate::search::cover::Cover;
use crate::search::joint::{Further, Joint};

/// Places that count more than this have lost part of the tolerance to ends of panels.
const ENDS: f64 = 1.02;
/// Rounds of moving borders to edges, without those that were refused.
const INTERSECTIONS: usize = 8;

/// Panels that cannot be proven.
#[derive(Default)]
pub(super) struct Refused {
    pub labels: Vec<u32>,
    /// Where they are too far from the face, if that is why, and it is worth another try.
    pub too_far: Vec<Further>,
}

impl Refused {
    /// Lets places that were too far away count in the program over strips; whether there are any.
    pub fn counted(&self, joint: &mut Joint, face: usize) -> bool {
        if self.too_far.is_empty() {
            return false;
        }
        // Where too little is left at ends of panels, they count everywhere.
        if self.too_far.iter().any(|f| f.counts > ENDS) {
            joint.count_ends(face);
        }
        joint.count(face, &self.too_far);
        true
    }
}

/// How borders come under edges.
#[derive(Clone, Copy)]
pub(super) enum Moving<'a> {
    /// They are there.
    Done,
    /// Regions are cut along edges.
    Cut,
    /// Regions of strips that were accepted are cut where these intersect.
    Accepted(&'a Built),
}

/// Borders of a cover that are brought under edges.
pub(super) struct Bordering<'a> {
    pub of: &'a Stitching<'a>,
    /// Strips that intersect, and edges that are known.
    pub strips: &'a Intersections<'a>,
    /// The cover.
    pub base: &'a Cover,
    pub how: Moving<'a>,
}

impl Bordering<'_> {
    /// The panels of the cover with borders between these labels where strips intersect, and the edges that panels share already.
    /// Errors where that is not possible, or cannot be proven. Panels that are refused keep their borders if they were accepted
    /// before; else nothing more is tried.
    pub fn panels(&self, mut wanted: Vec<[u32; 2]>) -> Result<Built, Refused> {
        let built = match self.how {
            Moving::Accepted(built) => Some(built),
            _ => None,
        };
        for _ in 0..INTERSECTIONS {
            if self.of.control.stopped() {
                break;
            }
            let (now, moved) = match self.how {
                Moving::Done => (self.base.clone(), wanted),
                _ => self.strips.on(self.base).cut(&wanted),
            };
            if moved.is_empty() {
                break;
            }
            wanted = moved;
            // Borders with edges that are kept stay as they are.
            let moves = |p: [u32; 2]| built.is_none() || wanted.contains(&p);
            let smooth = now.with_smooth_borders(self.of.tolerance, moves);
            let now = self.strips.on(&smooth).settled(&wanted);
            let traced = self.strips.on(&now);
            let (mut edges, spoilt) = traced.edges(&wanted);
            if !spoilt.is_empty() {
                wanted.retain(|p| !spoilt.contains(p));
                continue;
            }
            edges.extend(built.into_iter().flat_map(|b| seams::kept(&b.patchwork, &traced.borders)));
            let clashing = clashing(&edges, &traced.borders);
            let before = wanted.len();
            wanted.retain(|p| !clashing.contains(p));
            if wanted.len() < before {
                continue;
            }
            let (next, bad) = self.of.built_on(&now, &edges);
            let missed = missed(&next);
            if bad.is_empty() && missed.is_empty() {
                return Ok(next);
            }
            if built.is_none() && !bad.is_empty() {
                return Err(Refused { labels: bad, too_far: places_too_far(&next) });
            }
            wanted.retain(|p| !missed.contains(p) && !p.iter().any(|l| bad.contains(l)));
            if wanted.len() == before {
                break;
            }
        }
        Err(Refused::default())
    }
}
