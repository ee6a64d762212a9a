//! Strips of several faces that are changed together, so that they meet at places between the faces too.

use super::bordering::Refused;
use super::seams::pair;
use super::stitching::Stitching;
use super::together::{Together, REFINEMENTS, REGULAR};
use crate::control::Control;
use crate::num::parallel;
use crate::search::build::Built;
use crate::search::cover::{Cover, CoverOptions};
use crate::search::joint::{self, Asked, BorderCounts, Joint, Meeting};
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// See [`Stitching::most`], of strips that are to meet those of other faces: of places where distances count more some may be
/// too far away, and cost no more than an edge.
const LOW_ENOUGH: f64 = 1.15;

/// A face whose strips are to meet those of others.
pub(crate) struct Side<'a> {
    /// Its number.
    pub index: usize,
    /// Its cover.
    pub cover: &'a Cover,
    /// Its panels.
    pub built: &'a Built,
    /// What was asked for.
    pub wanted: &'a CoverOptions,
    /// What distances count on its border.
    pub borders: &'a BorderCounts<'a>,
}

/// What panels of one face come to: none where it stays as it is.
type Placed = Option<Result<Built, Refused>>;

/// The panels of faces, none for those that stay as they are, laid anew so that they meet at places between faces; `None` for
/// those that cannot be proven, or whose panels would meet in fewer edges.
pub(crate) fn met_together(sides: Vec<Option<Side>>, meetings: &[Meeting], control: &Control) -> Vec<Option<Built>> {
    let faces: Vec<Option<(Stitching, Cover)>> = sides.into_iter().map(|s| stitched(s?, control)).collect();
    let asked = faces.iter().map(|f| {
        let (of, _) = f.as_ref()?;
        Some(move |labels: [u32; 2]| of.is_asked_for(of.built, pair(labels)))
    });
    let held: Vec<_> = asked.collect();
    let without = BTreeSet::new();
    let asked: Vec<Option<Asked>> = faces
        .iter()
        .zip(&held)
        .map(|(f, held)| {
            let &Stitching { tolerance, borders, most, .. } = &f.as_ref()?.0;
            Some(Asked { held: held.as_ref()?, without: &without, regular: REGULAR[0], tolerance, borders, most })
        })
        .collect();
    let given = faces.iter().zip(&asked).map(|(f, asked)| {
        let (_, base) = f.as_ref()?;
        Some((base, base.borders().seam_chains(), asked.as_ref()?))
    });
    let mut joint = Joint::of_faces(given.collect(), meetings);
    for refinement in 0..=REFINEMENTS {
        let joined = joint.joined_all(control);
        if control.stopped() {
            break;
        }
        let placed = |(f, joined): (&Option<(Stitching, Cover)>, Option<joint::Joined>)| {
            let (of, base) = f.as_ref()?;
            let (strips, joined) = (Together { of, base }, joined?);
            if refinement == 0 && strips.is_too_far(&joined) {
                return None;
            }
            Some(strips.placed(joined, refinement == REFINEMENTS))
        };
        let placed: Vec<Placed> = parallel::map(faces.iter().zip(joined), placed);
        let mut again = false;
        for (face, p) in placed.iter().enumerate() {
            if let Some(Err(refused)) = p {
                again |= refused.counted(&mut joint, face);
            }
        }
        if !again {
            let good = |(f, p): (&Option<(Stitching, Cover)>, Placed)| {
                let (of, next) = (&f.as_ref()?.0, p?.ok()?);
                of.is_no_worse(&next).then_some(next)
            };
            return faces.iter().zip(placed).map(good).collect();
        }
    }
    faces.iter().map(|_| None).collect()
}

/// A face that is to meet others, and its panels as a cover.
fn stitched<'a>(side: Side<'a>, control: &'a Control) -> Option<(Stitching<'a>, Cover)> {
    let Side { index, cover, built, wanted, borders } = side;
    let base = cover.as_built(built)?;
    let of = Stitching {
        index,
        cover,
        built,
        tolerance: built.certificate.tolerance,
        wanted,
        control,
        known: Arc::default(),
        unproven: OnceLock::new(),
        most: LOW_ENOUGH,
        borders: Some(borders),
    };
    Some((of, base))
}
