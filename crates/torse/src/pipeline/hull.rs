//! `hull`: developables on the boundary of the convex hull of curves.
//!
//! Reads like the page that describes it: find the rulings on which the hull rests, make exact strips along them, have
//! rails and twist judged, develop.

use super::cut::{cut, stretched};
use super::judgement::judge;
use super::outcome::Status;
use super::sheets::{Basis, Figure, FlatPart, Guide, Sheets, StripField};
use crate::control::Control;
use crate::design::hull::strips::{strips, HullStrip};
use crate::design::hull::{hull as rulings_of_hull, HullError};
use crate::design::loft::build::BuildOptions;
use crate::develop::strip::StripOptions;
use crate::surface::rail::Rail;
use crate::surface::strip::Strip;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and curves, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Points per curve with which the search begins; default 256.
    pub samples: usize,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the curves, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "hull".into(),
            samples: 256,
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: 1e-5,
        }
    }
}

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;

/// The developables on the boundary of the convex hull of curves, judged and developed. Planar pieces bounded by a
/// single planar curve are left open, and named.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the curves, its twist
/// is proven to stay below `twist_tolerance`, no ruling meets the regression curve between its ends (proven), and every
/// part has a pattern. *Not guaranteed*: that features finer than the samples are seen.
///
/// # Errors
/// No curves, curves in one plane, a tolerance that is not positive.
pub fn hull(curves: &[Rail], options: &Options, control: &Control) -> Result<Sheets, HullError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(HullError::Tolerance(tolerance));
    }
    control.report("looking for rulings", 0.1, "");
    let found = rulings_of_hull(curves, options.samples)?;
    control.report("fitting", 0.4, "");
    let mut build = BuildOptions::new(RAIL_SHARE * tolerance);
    build.twist_tolerance = TWIST_SHARE * options.twist_tolerance;
    let mut made = strips(curves, &found, tolerance, &build)?;
    for (k, part) in made.iter_mut().enumerate() {
        for (i, s) in part.strips.iter_mut().enumerate() {
            s.built.strip.name = format!("{}-{:02}", part_name(k), i + 1);
        }
        if let Some(facet) = &mut part.facet {
            facet.name = format!("{}-01", part_name(k));
        }
    }

    control.report("judging", 0.7, "");
    let mut notes: Vec<String> = Vec::new();
    for &r in &found.lids {
        notes.push(format!(
            "{} lies in a plane on which the hull rests; that planar piece is left open",
            curves[r].name
        ));
    }
    let used = |r: usize| made.iter().flat_map(|p| &p.strips).any(|s| s.rails.contains(&r));
    for (_, c) in curves.iter().enumerate().filter(|(r, _)| !used(*r)) {
        notes.push(format!("{} bounds no developable strip: it lies inside the hull of the others", c.name));
    }
    let tips: usize = made.iter().map(|p| p.tips).sum();
    if tips > 0 {
        notes
            .push(format!("{tips} tips are cut off where rulings become shorter than the tolerance of {tolerance} mm"));
    }
    let reversed: Vec<Rail> = curves.iter().map(Rail::reversed).collect();
    let (mut all, mut parts): (Vec<Strip>, Vec<FlatPart>) = (Vec::new(), Vec::new());
    let judgement = {
        let rails = |s: &HullStrip| {
            [0, 1].map(|d: usize| Some(if s.turned[d] { &reversed[s.rails[d]] } else { &curves[s.rails[d]] }))
        };
        let built: Vec<_> = made.iter().flat_map(|p| &p.strips).map(|s| (&s.built, rails(s))).collect();
        judge(&built, &["first curve", "second curve"].map(String::from), options.twist_tolerance)
    };
    let mut missing = judgement.missing.clone();
    let off = judgement.off[0].max(judgement.off[1]);
    if off > tolerance {
        missing.push(format!("the strips stray up to {off:.4} mm from the curves"));
    }
    let (mut strip_figures, mut fields) = (Vec::new(), Vec::new());
    let mut judged = judgement.strip_figures.iter().zip(&judgement.fields);
    for (k, part) in made.iter().enumerate() {
        let name = part_name(k);
        let first = all.len();
        for (s, (figures, field)) in part.strips.iter().zip(&mut judged) {
            all.push(s.built.strip.clone());
            strip_figures.push(figures.clone());
            fields.push(field.clone());
        }
        if let Some(facet) = &part.facet {
            strip_figures.push(facet_figures(facet.area_estimate() * 1e-6));
            fields.push(StripField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![0.0; 4] });
            all.push(facet.clone());
        }
        if part.closed {
            notes.push(format!("part {name} is closed; it is cut open along its first ruling"));
        }
        parts.push(FlatPart { name, first, count: all.len() - first, missing: String::new() });
    }
    if all.is_empty() {
        missing.push("the hull has no developable strips between smooth curves".into());
    }
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        ..StripOptions::new(CONTOUR_SHARE * tolerance)
    };
    let (parts, patterns) = cut(&all, &parts, &flat);
    missing.extend(parts.iter().filter(|p| !p.missing.is_empty()).map(|p| format!("part {}: {}", p.name, p.missing)));
    let isometry = patterns.iter().map(|p| p.isometry_error).fold(0.0, f64::max);
    missing.extend(stretched(&parts, &patterns, tolerance));
    let mut figures = vec![Figure::new("from the curves", off, "mm", Basis::Proven)];
    figures.extend(judgement.figures());
    figures.push(Figure::new("strips", all.len() as f64, "", Basis::Given));
    figures.push(Figure::new("flat area", patterns.iter().map(|p| p.area * 1e-6).sum(), "m²", Basis::Measured));
    figures.push(Figure::new("length error of patterns", isometry, "", Basis::Measured));
    Ok(Sheets {
        job: "hull".into(),
        input: options.input.clone(),
        tolerance,
        status: match missing.is_empty() {
            true => Status::Certified,
            false => Status::Uncertified(missing.join("; ")),
        },
        strips: all,
        strip_figures,
        fields,
        points: Default::default(),
        meaning: judgement.meaning.clone(),
        parts,
        patterns,
        guides: curves.iter().map(|r| Guide { name: r.name.clone(), points: r.samples(200) }).collect(),
        figures,
        notes,
        skipped: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Figures of a triangle whose corners lie on curves: plane by construction.
fn facet_figures(area: f64) -> Vec<Figure> {
    vec![
        Figure::new("from first curve", 0.0, "mm", Basis::Given),
        Figure::new("from second curve", 0.0, "mm", Basis::Given),
        Figure::new("twist, bound", 0.0, "°", Basis::Proven),
        Figure::new("twist", 0.0, "°", Basis::Measured),
        Figure::new("regression clearance", f64::INFINITY, "mm", Basis::Measured),
        Figure::new("area", area, "m²", Basis::Measured),
    ]
}

/// A, B, …, Z, then numbers.
fn part_name(k: usize) -> String {
    match u8::try_from(k) {
        Ok(k) if k < 26 => char::from(b'A' + k).to_string(),
        _ => format!("P{}", k + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Frame, Vec3};
    use crate::spline::space_curve::SpaceCurve;
    use std::f64::consts::TAU;

    fn ellipse(name: &str, origin: Vec3, a: f64, b: f64) -> Rail {
        let frame = Frame { origin, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new(name, &[c]).expect("rail")
    }

    #[test]
    fn circle_and_ellipse_are_joined_and_certified() {
        let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
        let sheets = hull(&curves, &Options::new(0.1), &Control::default()).expect("sheets");
        assert_eq!(sheets.status, Status::Certified, "{:?}", sheets.figures);
        assert_eq!(sheets.notes.iter().filter(|n| n.contains("left open")).count(), 2);
        assert!(!sheets.patterns.is_empty());
    }

    #[test]
    fn three_circles_leave_two_planar_triangles() {
        let curves = [0.0, 1.0, 2.0].map(|k: f64| {
            let a = k * TAU / 3.0;
            // Circles about the middle of a triangle's corners, standing upright, turned towards it.
            let frame = Frame {
                origin: Vec3::new(a.cos(), a.sin(), 0.0) * 300.0,
                x: Vec3::new(-a.sin(), a.cos(), 0.0),
                y: Vec3::z(),
                z: Vec3::new(a.cos(), a.sin(), 0.0),
            };
            let (c, _) = SpaceCurve::Ellipse { frame, a: 100.0, b: 100.0 }.to_spline(0.0, TAU).expect("spline");
            Rail::new(&format!("circle {k}"), &[c]).expect("rail")
        });
        let sheets = hull(&curves, &Options::new(0.1), &Control::default()).expect("sheets");
        assert_eq!(sheets.status, Status::Certified, "{:?} {:?}", sheets.figures, sheets.notes);
        let upright = |s: &&Strip| {
            let p = s.patch.control.iter().map(|c| c[2] / c[3]).collect::<Vec<_>>();
            p.iter().all(|z| (z.abs() - 100.0).abs() < 1e-9)
        };
        // Planes z = ±100 touch all three circles at their tops and bottoms.
        assert_eq!(sheets.strips.iter().filter(upright).count(), 2);
    }

    #[test]
    fn what_has_no_hull_is_refused() {
        let control = Control::default();
        assert_eq!(hull(&[], &Options::new(0.1), &control).err(), Some(HullError::NoCurves));
        let flat = [ellipse("a", Vec3::zeros(), 1.0, 1.0), ellipse("b", Vec3::x() * 5.0, 1.0, 1.0)];
        let e = hull(&flat, &Options::new(0.1), &control).expect_err("flat");
        assert!(e.to_string().contains("a, b"), "{e}");
        assert!(matches!(hull(&flat, &Options::new(f64::NAN), &control), Err(HullError::Tolerance(_))));
    }
}
