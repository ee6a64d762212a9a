//! `planarise`: plane quadrilaterals from a strip that nearly has them, refined level by level.
//!
//! Reads like the page that describes it: planarise, refine and planarise again, judge every quadrilateral, develop.

use super::cut::cut;
use super::outcome::Status;
use super::sheets::{Basis, FieldMeaning, Figure, FlatPart, Guide, Sheets, StripField};
use crate::certify::quads::gap_bound;
use crate::control::Control;
use crate::design::discrete::planarise::{DiscreteError, Hold, PlanariseStatus};
use crate::design::discrete::subdivide::{subdivide, SubdivideOptions, Subdivided};
use crate::develop::strip::StripOptions;
use crate::geom::Vec3;
use crate::spline::SplineError;
use crate::surface::quad_strip::QuadStrip;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between the diagonals of a quadrilateral, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Levels of subdivision; default 0.
    pub levels: usize,
    /// Points that keep their places; default none.
    pub hold: Hold,
    /// Displacement allowed for given points by planarisation, mm; default none: any.
    pub most_move: Option<f64>,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, input: "strip".into(), levels: 0, hold: Hold::Nothing, most_move: None }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanariseError {
    /// A tolerance that is none.
    #[error("the tolerance {0} is not a positive finite length")]
    Tolerance(f64),
    /// Too much asked.
    #[error(transparent)]
    Discrete(#[from] DiscreteError),
    /// More parts than a report can show.
    #[error("{levels} levels give {quads} quadrilaterals; files are written for at most {MOST}: ask for fewer levels")]
    Many {
        /// Levels asked for.
        levels: usize,
        /// Quadrilaterals there would be.
        quads: usize,
    },
    /// A quadrilateral that is no patch.
    #[error("a quadrilateral could not be made: {0}")]
    Patch(#[from] SplineError),
}

/// Share of the tolerance for outlines; plane quadrilaterals have exact ones.
const CONTOUR_SHARE: f64 = 0.05;
/// Most quadrilaterals for which files are written.
const MOST: usize = 5000;

/// Plane quadrilaterals near a strip, judged and developed.
///
/// *Guarantee.* `Certified` only if the diagonals of every quadrilateral are proven to come within the tolerance of each
/// other ([`gap_bound`]), no regression point lies on the strip, given points moved no further than allowed, and every
/// part has a pattern. Everything else is `Uncertified` with the reason.
///
/// # Errors
/// A tolerance that is not positive, more levels than can be written.
pub fn planarise(strip: &QuadStrip, options: &Options, control: &Control) -> Result<Sheets, PlanariseError> {
    let start = Instant::now();
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(PlanariseError::Tolerance(options.tolerance));
    }
    let shift = u32::try_from(options.levels).unwrap_or(u32::MAX);
    let quads = strip.quads().saturating_mul(1usize.checked_shl(shift).unwrap_or(usize::MAX));
    if quads > MOST {
        return Err(PlanariseError::Many { levels: options.levels, quads });
    }
    control.report("planarising", 0.2, "");
    let done = subdivide(strip, &SubdivideOptions::new(options.levels, options.hold), control)?;
    control.report("developing", 0.6, "");
    judged(strip, done, options, start)
}

fn judged(given: &QuadStrip, done: Subdivided, options: &Options, start: Instant) -> Result<Sheets, PlanariseError> {
    let result = &done.strip;
    let (mut missing, mut notes) = (Vec::new(), Vec::new());
    let (mut strip_figures, mut fields, mut worst_gap) = (Vec::new(), Vec::new(), 0.0f64);
    let strips = result.faces("A")?;
    for (i, s) in strips.iter().enumerate() {
        let gap = gap_bound(result, i);
        worst_gap = worst_gap.max(gap);
        let bends = [result.bend(i).to_degrees(), result.bend(i + 1).to_degrees()];
        strip_figures.push(vec![
            Figure::new("distance of diagonals", gap, "mm", Basis::Proven),
            Figure::new("regression clearance", result.regression_clearance(i), "mm", Basis::Measured),
            Figure::new("bend before", bends[0], "°", Basis::Measured),
            Figure::new("area", s.area_estimate() * 1e-6, "m²", Basis::Measured),
        ]);
        // The ends have no neighbour to bend against; they show the bend of the other side.
        let (first, last) = (i == 0, i + 1 == strips.len());
        let before = if first { bends[1] } else { bends[0] };
        let after = if last { bends[0] } else { bends[1] };
        fields.push(StripField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![before, before, after, after] });
    }
    if worst_gap > options.tolerance {
        missing.push(format!("diagonals up to {worst_gap:.4} mm apart{}", stalled(&done, options.hold)));
    }
    if let Some(i) = result.crossing() {
        missing.push(format!(
            "rulings {} and {} (counted from 1) cross on the strip: regression point inside; give rulings that fan out less there",
            i + 1,
            i + 2
        ));
    }
    let moved = done.levels.first().map_or(0.0, |l| l.largest_move);
    if let Some(most) = options.most_move.filter(|m| moved > *m) {
        missing.push(format!("points moved up to {moved:.4} mm where {most} mm are allowed"));
    }
    if done.levels.len() <= options.levels {
        missing.push(format!("stopped after {} of {} levels", done.levels.len() - 1, options.levels));
    }
    for (k, l) in done.levels.iter().enumerate() {
        notes.push(format!(
            "level {k}: {} quadrilaterals, warp {:.1e} before and {:.1e} after {} steps, points moved up to {:.4} mm, bends jump by {:.1} % of their mean",
            l.quads,
            l.warp_before,
            l.warp,
            l.steps,
            l.largest_move,
            100.0 * l.bend_jump
        ));
    }
    let flat = StripOptions::new(CONTOUR_SHARE * options.tolerance);
    let whole = FlatPart { name: "A".into(), first: 0, count: strips.len(), missing: String::new() };
    let (parts, patterns) = cut(&strips, &[whole], &flat);
    missing.extend(parts.iter().filter(|p| !p.missing.is_empty()).map(|p| format!("part {}: {}", p.name, p.missing)));
    let isometry = patterns.iter().map(|p| p.isometry_error).fold(0.0, f64::max);
    let clearance = (0..result.quads()).map(|i| result.regression_clearance(i)).fold(f64::INFINITY, f64::min);
    let largest_bend = (1..result.quads()).map(|i| result.bend(i).abs().to_degrees()).fold(0.0, f64::max);
    let figures = vec![
        Figure::new("distance of diagonals", worst_gap, "mm", Basis::Proven),
        Figure::new("points moved", moved, "mm", Basis::Measured),
        Figure::new("regression clearance", clearance, "mm", Basis::Measured),
        Figure::new("largest bend", largest_bend, "°", Basis::Measured),
        Figure::new("quadrilaterals", strips.len() as f64, "", Basis::Given),
        Figure::new("flat area", patterns.iter().map(|p| p.area * 1e-6).sum(), "m²", Basis::Measured),
        Figure::new("length error of patterns", isometry, "", Basis::Measured),
    ];
    let guide = |name: &str, points: &[Vec3]| Guide { name: name.into(), points: points.to_vec() };
    Ok(Sheets {
        job: "planarise".into(),
        input: options.input.clone(),
        tolerance: options.tolerance,
        status: if missing.is_empty() { Status::Certified } else { Status::Uncertified(missing.join("; ")) },
        strips,
        strip_figures,
        fields,
        points: Default::default(),
        meaning: FieldMeaning { name: "bend".into(), unit: "°".into(), limit: largest_bend.max(1e-6) },
        parts,
        patterns,
        guides: vec![guide("first polyline", given.a()), guide("second polyline", given.b())],
        figures,
        notes,
        skipped: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Why planarisation did not end with plane quadrilaterals, as the end of a sentence.
fn stalled(done: &Subdivided, hold: Hold) -> &'static str {
    match (done.levels.iter().find(|l| l.status != PlanariseStatus::Plane).map(|l| l.status), hold) {
        (Some(PlanariseStatus::Stalled), Hold::Nothing) => {
            ": no displacement makes them plane; look for rulings that cross"
        }
        (Some(PlanariseStatus::Stalled), _) => ": the held points leave no room; hold fewer",
        (Some(PlanariseStatus::StepLimit), _) => ": the steps are used up",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::shapes::shapes;

    /// A strip between a circle and an ellipse above it, 200 mm wide.
    fn twisted(quads: usize) -> QuadStrip {
        let t = |k: usize| 1.8 * k as f64 / quads as f64;
        let a = (0..=quads).map(t).map(|t| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 0.0)).collect();
        let b = (0..=quads).map(t).map(|t| Vec3::new(150.0 * (t + 0.1).cos(), 120.0 * (t + 0.1).sin(), 90.0)).collect();
        QuadStrip::new(a, b).expect("a strip")
    }

    #[test]
    fn a_strip_is_planarised_refined_proven_and_developed() {
        let options = Options { levels: 2, ..Options::new(1e-6) };
        let s = planarise(&twisted(8), &options, &Control::default()).expect("an answer");
        assert_eq!(s.status, Status::Certified);
        assert_eq!((s.strips.len(), s.patterns.len(), s.notes.len()), (32, 1, 3));
        assert!(s.figures[0].value < 1e-10 && s.figures[0].basis == Basis::Proven);
        assert!(s.patterns[0].isometry_error < 1e-9);
        assert!((s.patterns[0].area - s.patterns[0].area_in_space).abs() < 1e-6);
        assert!(!shapes(&s).is_empty());
    }

    #[test]
    fn what_cannot_be_plane_or_moves_too_far_is_not_certified() {
        let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        // One warped quadrilateral, all of its corners held.
        let held = QuadStrip::new(vec![x(0., 0., 5.), x(50., 0., -5.)], vec![x(0., 50., -5.), x(50., 50., 5.)])
            .expect("strip");
        let options = Options { hold: Hold::Ends, ..Options::new(0.01) };
        let s = planarise(&held, &options, &Control::default()).expect("an answer");
        let Status::Uncertified(reason) = s.status else { panic!("certified") };
        assert!(reason.contains("hold fewer"), "{reason}");
        let options = Options { most_move: Some(1e-3), ..Options::new(0.01) };
        let s = planarise(&twisted(8), &options, &Control::default()).expect("an answer");
        assert!(matches!(s.status, Status::Uncertified(r) if r.contains("moved")));
        let crossed =
            QuadStrip::new(vec![x(50., 0., 0.), x(0., 0., 0.)], vec![x(0., 50., 0.), x(50., 50., 0.)]).expect("strip");
        let s = planarise(&crossed, &Options::new(0.01), &Control::default()).expect("an answer");
        assert!(matches!(s.status, Status::Uncertified(r) if r.contains("cross")));
    }

    #[test]
    fn bad_requests_are_refused() {
        let s = twisted(8);
        let ask = |o: Options| planarise(&s, &o, &Control::default()).expect_err("refused");
        assert!(matches!(ask(Options::new(f64::NAN)), PlanariseError::Tolerance(_)));
        for levels in [10, 70, 5_000_000_000] {
            assert!(matches!(ask(Options { levels, ..Options::new(0.1) }), PlanariseError::Many { .. }));
        }
    }
}
