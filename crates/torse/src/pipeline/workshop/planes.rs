//! Planes of the stations at which parts are marked.

use super::options::{Stations, WorkshopError, MOST_PLANES};
use crate::answer::Answer;
use crate::develop::shop::sections::SectionPlane;
use crate::geom::BBox;

/// Share of the step within which a plane at the end of a range still counts.
const HAIR: f64 = 1e-9;

/// All planes of all stations that may meet the model.
pub(super) fn planes(answer: &Answer, stations: &[Stations]) -> Result<Vec<SectionPlane>, WorkshopError> {
    let mut bbox = BBox::empty();
    for b in answer.strips().map(|s| s.patch.bbox()) {
        bbox.include(&b.min);
        bbox.include(&b.max);
    }
    let mut out = Vec::new();
    for s in stations {
        let (middle, half) = (0.5 * (bbox.min + bbox.max), 0.5 * (bbox.max - bbox.min));
        let (at, reach) = (s.normal.dot(&middle), s.normal.abs().dot(&half));
        let (lo, hi) = (at - reach, at + reach);
        // Stations count from the first one given, else from the origin.
        let zero = if s.from.is_finite() { s.from } else { 0.0 };
        let first = ((lo.max(s.from) - zero) / s.step - HAIR).ceil();
        let last = ((hi.min(s.to) - zero) / s.step + HAIR).floor();
        let count = last - first + 1.0;
        if count.is_nan() || count < 1.0 {
            return Err(WorkshopError::Nowhere { name: s.name.clone(), from: s.from, to: s.to, lo, hi });
        }
        if count > MOST_PLANES as f64 {
            return Err(WorkshopError::TooMany { step: s.step, count });
        }
        out.extend((0..count as usize).map(|k| {
            let offset = zero + (first + k as f64) * s.step;
            let number = format!("{:.3}", answer.cut.unit.of(offset));
            let number = number.trim_end_matches('0').trim_end_matches('.');
            SectionPlane { normal: s.normal, offset, label: format!("{} {number}", s.name.to_uppercase()) }
        }));
    }
    Ok(out)
}
