//! The main job at several tolerances: how many panels, and how much seam, each of them costs.

use super::approximate::{of_faces, ApproximateError, Options};
use crate::answer::skipped::Skipped;
use crate::answer::sweep::SweepRow;
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::draw::chart::{chart, Chart, Series};
use crate::draw::raster::Image;
use crate::num::parallel;
use crate::patchwork::panel::Border;
use crate::search::cover::band_range;
use crate::search::smooth::smoothly_joined;
use crate::search::trims::assess_trims;

/// Chords per span of an edge curve when its length is measured.
const CHORDS: usize = 4;

/// Runs the main job once for every tolerance (mm), finest last so that early rows come soon. `skipped` are the faces
/// that were left out before.
///
/// *Estimate of theory*: `Σ W/(4√ε)` over the faces, with W the range of the best strip potential found, at least one panel per face
/// (approximation specification B2), for surfaces of one curvature sign; where curvature is mixed there is
/// none. *Not guaranteed*: that no cover needs fewer; some do, and W is a numerical optimum.
///
/// # Errors
/// As [`of_faces`], for the first tolerance that cannot be used.
pub fn sweep(
    faces: &[Face],
    skipped: &[Skipped],
    tolerances: &[f64],
    options: &Options,
    control: &Control,
) -> Result<Vec<SweepRow>, ApproximateError> {
    // Joined once for all tolerances, as the finest allows.
    let finest = tolerances.iter().copied().filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    let faces = assess_trims(faces.to_vec(), finest).faces;
    let faces = &smoothly_joined(faces, finest, (options.smooth_angle, options.meet), control);
    let ranges: Vec<Option<f64>> = parallel::map(faces.iter(), band_range);
    let mut sorted = tolerances.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted.dedup();
    let mut rows = Vec::new();
    for tolerance in sorted {
        if control.stopped() {
            break;
        }
        let answer = of_faces(faces.to_vec(), skipped.to_vec(), &Options { tolerance, ..options.clone() }, control)?;
        let bands = |range: &Option<f64>| range.map(|w| (w / (4.0 * tolerance.sqrt())).max(1.0));
        rows.push(SweepRow {
            tolerance,
            panels: answer.patchwork.panels.len(),
            seam_length: seam_length(&answer),
            theory_estimate: ranges.iter().map(bands).sum(),
            certified: answer.status() == Status::Certified,
            seconds: answer.seconds,
        });
    }
    Ok(rows)
}

/// Length of all seams of a result, common edges of faces included, each counted once, mm.
pub(crate) fn seam_length(answer: &Answer) -> f64 {
    let runs = answer.patchwork.panels.iter().flat_map(|p| p.loops().iter().flatten());
    let seams = runs.filter(|r| matches!(r.border, Border::Seam { .. } | Border::Joint { .. }));
    let length = |r: &crate::patchwork::panel::Coedge| {
        let point = |s: f64| crate::geom::Vec3::from(r.edge.point(s));
        let spans = r.edge.knots.breaks();
        let chord = |w: &[f64], k: usize| {
            let at = |k: usize| point(w[0] + (w[1] - w[0]) * k as f64 / CHORDS as f64);
            (at(k + 1) - at(k)).norm()
        };
        spans.windows(2).map(|w| (0..CHORDS).map(|k| chord(w, k)).sum::<f64>()).sum::<f64>()
    };
    0.5 * seams.map(length).fold(0.0, |sum, l| sum + l)
}

/// Panels, seam length and estimate of theory over the tolerance; `None` without rows.
pub fn picture(title: &str, rows: &[SweepRow]) -> Option<Image> {
    let series = |name: &str, measured: bool, value: &dyn Fn(&SweepRow) -> Option<f64>| Series {
        name: name.to_owned(),
        measured,
        points: rows.iter().filter_map(|r| Some([r.tolerance, value(r)?])).collect(),
    };
    chart(&Chart {
        title: title.to_owned(),
        x: "tolerance, mm".to_owned(),
        y: "panels; seam length, m".to_owned(),
        series: vec![
            series("panels", true, &|r| Some(r.panels as f64)),
            series("estimate of theory", false, &|r| r.theory_estimate),
            series("seam length, m", true, &|r| Some(r.seam_length / 1000.0)),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    /// Shallow bowl z = (x² + y²)/400 over a square of side 100 mm.
    fn bowl() -> Face {
        let k = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
        // Bernstein coefficients of (100 t)²/400 are 0, 0, 25.
        let square = [0.0, 0.0, 25.0];
        let points: Vec<Vec3> = (0..9)
            .map(|i| Vec3::new(50.0 * (i / 3) as f64, 50.0 * (i % 3) as f64, square[i / 3] + square[i % 3]))
            .collect();
        Face::untrimmed(Surface::new(k.clone(), k, &points, None).expect("a surface"))
    }

    #[test]
    fn finer_tolerances_take_more_panels_and_hardly_fewer_than_theory_estimates() {
        let options = Options { input: "bowl".into(), smooth_angle: 0.0, meet: false, ..Options::new(1.0) };
        let rows = sweep(&[bowl()], &[], &[0.4, 1.6], &options, &Control::default()).expect("rows");
        assert_eq!(rows.iter().map(|r| r.tolerance).collect::<Vec<_>>(), vec![1.6, 0.4]);
        assert!(rows.iter().all(|r| r.certified));
        assert!(rows[1].panels > rows[0].panels && rows[1].seam_length > rows[0].seam_length);
        for r in &rows {
            // Straight bands in the shallow bowl: W = 100 √(1/200); slopes of one half make it a little less.
            let estimate = r.theory_estimate.expect("an estimate");
            assert!(estimate <= (100.0 * (1.0f64 / 200.0).sqrt() / (4.0 * r.tolerance.sqrt())).max(1.0) * 1.02);
            assert!(r.panels as f64 >= 0.9 * estimate);
        }
        assert!(picture("bowl", &rows).is_some());
    }
}
