//! Questions that the main job refuses, before any work is done for them, and what it tells of curves that were asked for.

use super::error::{ApproximateError, MOST_PANELS};
use super::options::Options;
use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::BBox;
use crate::io::words;
use crate::search::build::AlongCurve;
use crate::search::cover::{
    check_curves, check_seam_curves, is_developable, panels_needed, CurveError, Guide, Layout, Limits,
};
use std::collections::BTreeSet;

/// Share of what a face has by which panels may be wider: they need not follow it exactly.
const ROOMY: f64 = 1.05;
/// Share of the model's size below which no tolerance is accepted (certificate specification, 3).
const PRECISION: f64 = 1e-10;

/// What can be said of the question at once.
pub(super) fn checked(faces: &[Face], skipped: &[Skipped], options: &Options) -> Result<(), ApproximateError> {
    let tolerance = options.tolerance;
    if !is_tolerance(tolerance) {
        return Err(ApproximateError::Tolerance(tolerance));
    }
    if options.max_panels == Some(0) {
        return Err(ApproximateError::MaxPanels);
    }
    checked_limits(&options.limits)?;
    if !(0.0..std::f64::consts::FRAC_PI_2).contains(&options.smooth_angle) {
        return Err(ApproximateError::SmoothAngle(options.smooth_angle.to_degrees()));
    }
    if faces.is_empty() {
        let why = skipped.first().map_or_else(|| "the file holds none".into(), words::left_out);
        return Err(ApproximateError::NoFaces(why));
    }
    let mut bbox = BBox::empty();
    for f in faces {
        let b = f.surface.bbox();
        bbox.include(&b.min);
        bbox.include(&b.max);
    }
    Loose::check(bbox.diagonal(), tolerance)?;
    let size = bbox.diagonal().max(bbox.min.amax().max(bbox.max.amax()));
    if tolerance < PRECISION * size {
        return Err(ApproximateError::Precision { tolerance, size, least: PRECISION * size });
    }
    checked_layout(&options.layout, &bbox)
}

/// Limits that ask for more panels than can be laid on one of the faces.
pub(super) fn checked_number(faces: &[Face], options: &Options) -> Result<(), ApproximateError> {
    let (tolerance, limits) = (options.tolerance, &options.limits);
    if let Some(least) = limits.min_width {
        let area = faces.iter().map(area_estimate).filter(|a| a.is_finite()).fold(0.0, f64::max);
        // The area of a pattern over its length, which is no less than its width, is at most the root of its area.
        let widest = area.sqrt();
        if least > ROOMY * widest {
            return Err(ApproximateError::TooNarrow { least, widest });
        }
    }
    if [limits.min_bend_radius, limits.widest(), limits.longest()].iter().all(Option::is_none) {
        return Ok(());
    }
    for f in faces.iter().filter(|f| !is_developable(f, tolerance)) {
        if let Some((name, count)) = panels_needed(f, &options.limits, tolerance).filter(|n| n.1 > MOST_PANELS) {
            return Err(ApproximateError::TooMany { name, count, entity: f.entity });
        }
    }
    Ok(())
}

/// A curve of the layout that is of use on no face: the error of the face that it comes nearest to.
pub(super) fn checked_curves(faces: &[Face], options: &Options) -> Result<(), ApproximateError> {
    let layout = &options.layout;
    // Faces that cannot be triangulated are reported by the cover.
    of_use(faces, layout.curves.len(), |f| check_curves(f, &layout.curves, options.tolerance).ok())?;
    of_use(faces, layout.seam_curves.len(), |f| check_seam_curves(f, &layout.seam_curves, options.tolerance).ok())
}

/// What became of curves along which panels were asked for, where it is not what was asked.
pub(super) fn told_of_curves(layout: &Layout, along: &[AlongCurve]) -> Vec<Note> {
    let bare = layout.curves.iter().filter(|c| along.iter().all(|a| a.curve != c.name));
    let bare = bare.map(|c| Note::NoPanelAlong { curve: c.name.clone() });
    let directed = along.iter().filter(|a| a.paper_estimate.is_infinite());
    let directed: BTreeSet<&str> = directed.map(|a| a.curve.as_str()).collect();
    bare.chain(directed.into_iter().map(|c| Note::DirectionOf { curve: c.to_owned() })).collect()
}

/// Whether each of so many curves is of use on a face.
fn of_use(
    faces: &[Face],
    count: usize,
    check: impl Fn(&Face) -> Option<Vec<Result<(), CurveError>>>,
) -> Result<(), ApproximateError> {
    let mut least: Vec<Option<CurveError>> = vec![None; count];
    let mut useful = vec![count == 0; count];
    for found in faces.iter().filter(|_| count > 0).filter_map(check) {
        for (i, r) in found.into_iter().enumerate() {
            match r {
                Ok(()) => useful[i] = true,
                Err(e) if least[i].as_ref().is_none_or(|l| e.remoteness() < l.remoteness()) => least[i] = Some(e),
                Err(_) => {}
            }
        }
    }
    match useful.iter().position(|u| !u).and_then(|i| least[i].clone()) {
        Some(e) => Err(e.into()),
        None => Ok(()),
    }
}

/// Limits that nothing can keep.
fn checked_limits(limits: &Limits) -> Result<(), ApproximateError> {
    if let Some((name, value)) = limits.named().into_iter().find(|(_, v)| !v.is_none_or(|v| v > 0.0)) {
        return Err(ApproximateError::Limit { name, value: value.unwrap_or(f64::NAN) });
    }
    match limits.min_width.zip(limits.longest()) {
        // No pattern is wider than long.
        Some((least, longest)) if least >= longest => Err(ApproximateError::WiderThanLong { least, longest }),
        _ => match limits.min_width.zip(limits.widest()) {
            Some((least, greatest)) if least > greatest => Err(ApproximateError::Widths { least, greatest }),
            _ => Ok(()),
        },
    }
}

/// A layout that asks for what cannot be.
fn checked_layout(layout: &Layout, bbox: &BBox) -> Result<(), ApproximateError> {
    for (i, seam) in layout.seams.iter().enumerate() {
        let (middle, half) = (0.5 * (bbox.min + bbox.max), 0.5 * (bbox.max - bbox.min));
        let (at, reach) = (seam.normal.dot(&middle), seam.normal.abs().dot(&half));
        let (lo, hi) = (at - reach, at + reach);
        if !(seam.offset > lo && seam.offset < hi) {
            return Err(ApproximateError::SeamPlane { index: i + 1, at: seam.offset, lo, hi });
        }
    }
    let sound = match &layout.guide {
        None => true,
        Some(Guide::Direction(d)) => d.norm() > 0.0 && d.norm().is_finite(),
        Some(Guide::Curve(points)) => {
            points.iter().all(|p| p.iter().all(|x| x.is_finite())) && points.windows(2).any(|w| w[0] != w[1])
        }
    };
    if sound {
        Ok(())
    } else {
        Err(ApproximateError::Guide)
    }
}
