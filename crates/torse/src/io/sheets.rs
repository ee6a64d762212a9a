//! `report.json` of jobs that make strips (format: `docs/report-strips-json.md`), and all files of such a job.

use super::bends::{self, BendRecord};
use super::bundle::{BundleError, File};
use super::html::sheets as page;
use super::step::write::{self as step, Header, Sheet};
use super::{dxf, glb, marks, png, svg, words};
use crate::answer::presentation::Presentation;
use crate::answer::shapes::Shape;
use crate::answer::sheets::Sheets;
use crate::certify::claim::{Claim, Status, Subject};
use crate::draw::picture::{self, Caption};
use crate::torse::kind::RunShape;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const SCHEMA: &str = "torse-strips/2";
/// Basis of a bound that was looked for and could not be shown.
pub const UNKNOWN: &str = "unknown";

/// The whole report. Lengths in mm; `None` is written as `null` and stands for an infinite or unknown number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// Name of the job.
    pub job: String,
    /// `certified` or `uncertified`.
    pub status: String,
    /// Why not certified; empty when certified.
    pub reason: String,
    /// Unit of all lengths: `mm`.
    pub unit: String,
    /// Name of the input.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Figures of the whole.
    pub figures: Vec<FigureRecord>,
    /// What people should know.
    pub notes: Vec<String>,
    /// Items of the input that could not be used.
    pub skipped: Vec<String>,
    /// Strips.
    pub strips: Vec<StripRecord>,
    /// Parts as they are cut.
    pub parts: Vec<PartRecord>,
    /// Planes, cylinders, cones and tangent surfaces along the parts.
    #[serde(default)]
    pub shapes: Vec<ShapeRecord>,
    /// The measured point farthest from the strips; null for jobs without points.
    #[serde(default)]
    pub worst_point: Option<PointRecord>,
}

/// A measured point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    /// Index in the input, from 0.
    pub index: usize,
    /// Place, mm.
    pub place: [f64; 3],
    /// Signed distance from the nearest strip, mm; null without strips.
    pub deviation: Option<f64>,
}

impl PointRecord {
    fn worst(sheets: &Sheets) -> Option<Self> {
        let index = sheets.points.worst?;
        let deviation = sheets.points.values.get(index).copied().filter(|d| d.is_finite());
        Some(Self { index, place: (*sheets.points.places.get(index)?).into(), deviation })
    }
}

/// A named number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureRecord {
    /// Name.
    pub name: String,
    /// Value; null for infinite or unknown.
    pub value: Option<f64>,
    /// Unit; empty for plain numbers.
    pub unit: String,
    /// `proven`, `measured` or `given`; `unknown` for a bound that could not be shown.
    pub basis: String,
}

/// One strip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StripRecord {
    /// Name, the same in all files.
    pub name: String,
    /// `plane`, `cylinder`, `cone` or `torse`.
    pub kind: String,
    /// Whether it may be cut; false for all strips of a result that is not certified.
    pub certified: bool,
    /// Its figures.
    pub figures: Vec<FigureRecord>,
}

/// One part as it is cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartRecord {
    /// Name, the same in all files.
    pub name: String,
    /// Names of its strips.
    pub strips: Vec<String>,
    /// Whether it may be cut; false for all parts of a result that is not certified.
    pub certified: bool,
    /// Why there is no pattern; empty if there is one.
    pub missing: String,
    /// Area of the flat pattern, mm².
    pub flat_area: Option<f64>,
    /// Area in space, mm².
    pub area: Option<f64>,
    /// Largest relative error of lengths on the flat pattern, measured.
    pub isometry_error: Option<f64>,
    /// Largest distance between the outline drawn and the exact flat outline, mm.
    pub contour_error: Option<f64>,
    /// Long side of the smallest rectangle around the flat pattern, mm.
    pub length: Option<f64>,
    /// Short side, mm.
    pub width: Option<f64>,
    /// Side of the model from which the pattern is seen: `outside` or `inside`; empty without a pattern.
    #[serde(default)]
    pub view: String,
    /// Its bend lines.
    #[serde(default)]
    pub bends: Vec<BendRecord>,
}

/// A stretch of a part that is of one shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeRecord {
    /// Name of the part.
    pub part: String,
    /// `plane`, `cylinder`, `cone` or `tangent`.
    pub shape: String,
    /// Name of the strip in which it begins.
    pub first: String,
    /// Name of the strip in which it ends.
    pub last: String,
    /// Angle through which the tangent plane turns, degrees.
    pub turn: f64,
    /// Normal of a plane, direction of a cylinder's rulings, apex of a cone (mm); null for tangent surfaces.
    pub vector: Option<[f64; 3]>,
    /// Root mean square of what the shape leaves: angles in rad and distances by the size of the part together.
    pub residual: f64,
    /// Whether another shape would be chosen if the noise were twice or half as great.
    pub ambiguous: bool,
}

impl ShapeRecord {
    fn of(shape: &Shape, sheets: &Sheets) -> Self {
        let name = |k: Option<&(usize, f64, f64)>| {
            k.and_then(|k| sheets.strips.get(k.0)).map_or_else(String::new, |s| s.name.clone())
        };
        let vector = match shape.shape {
            RunShape::Plane { plane } => Some(plane.normal),
            RunShape::Cylinder { direction } => Some(direction),
            RunShape::Cone { apex } => Some(apex),
            RunShape::Tangent => None,
        };
        Self {
            part: shape.part.clone(),
            shape: shape.shape.name().into(),
            first: name(shape.pieces.first()),
            last: name(shape.pieces.last()),
            turn: shape.turn.to_degrees(),
            vector: vector.map(Into::into),
            residual: shape.residual,
            ambiguous: shape.ambiguous,
        }
    }
}

impl Report {
    /// The record of an outcome; `shown` knows its shapes.
    pub fn of(sheets: &Sheets, shown: &Presentation) -> Self {
        let curves: Vec<String> = sheets.guides.iter().map(|g| g.name.clone()).collect();
        let status = match sheets.status() {
            Status::Certified => "certified",
            Status::Uncertified => "uncertified",
        };
        Self {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            job: sheets.job.clone(),
            status: status.into(),
            reason: words::reason(&sheets.claims, &curves),
            unit: "mm".into(),
            input: sheets.input.clone(),
            tolerance: sheets.tolerance,
            seconds: sheets.seconds,
            figures: sheets.claims_of(Subject::Whole).map(|c| record(c, &curves)).collect(),
            notes: sheets.notes.clone(),
            skipped: sheets.skipped.clone(),
            strips: sheets
                .strips
                .iter()
                .enumerate()
                .map(|(k, s)| StripRecord {
                    name: s.name.clone(),
                    kind: s.kind.name().into(),
                    certified: !shown.marks.panels.get(k).copied().unwrap_or(true),
                    figures: sheets.claims_of(Subject::Panel(k)).map(|c| record(c, &curves)).collect(),
                })
                .collect(),
            parts: part_records(sheets, shown),
            shapes: shown.shapes.iter().map(|s| ShapeRecord::of(s, sheets)).collect(),
            worst_point: PointRecord::worst(sheets),
        }
    }

    /// Whether the status is `certified`.
    pub fn certified(&self) -> bool {
        self.status == "certified"
    }

    /// What must not be cut, in words that tell at most so many names; `None` if the result is certified.
    pub fn do_not_cut(&self, most: usize) -> Option<String> {
        let bad: Vec<&str> = self.parts.iter().filter(|p| !p.certified).map(|p| p.name.as_str()).collect();
        (!self.certified()).then(|| marks::do_not_cut(&bad, self.parts.len(), most))
    }

    /// The text of `report.json`.
    ///
    /// # Errors
    /// None in practice: every field has a JSON form.
    pub fn to_json(&self) -> Result<String, super::json::JsonError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

/// A claim for the report. `null` stands for infinite and for unknown; the basis tells them apart.
fn record(claim: &Claim, curves: &[String]) -> FigureRecord {
    let value = claim.value();
    FigureRecord {
        name: words::name(claim, curves),
        value: (value.is_finite() && !claim.is_unknown()).then_some(value),
        unit: words::unit(claim.what()).into(),
        basis: if claim.is_unknown() { UNKNOWN } else { words::evidence(claim.evidence()) }.into(),
    }
}

fn part_records(sheets: &Sheets, shown: &Presentation) -> Vec<PartRecord> {
    let finite = |x: f64| x.is_finite().then_some(x);
    sheets
        .parts
        .iter()
        .enumerate()
        .map(|(k, part)| {
            let p = sheets.patterns.iter().find(|p| p.panel == k);
            let strips = sheets.strips.iter().skip(part.first).take(part.count);
            PartRecord {
                name: part.name.clone(),
                strips: strips.map(|s| s.name.clone()).collect(),
                certified: !(part.first..part.first + part.count)
                    .any(|k| shown.marks.panels.get(k).copied().unwrap_or(true)),
                missing: part.missing.clone(),
                flat_area: p.and_then(|p| finite(p.area)),
                area: p.and_then(|p| finite(p.area_in_space)),
                isometry_error: p.and_then(|p| finite(p.isometry_error)),
                contour_error: p.and_then(|p| finite(p.contour_error)),
                length: p.and_then(|p| finite(p.length)),
                width: p.and_then(|p| finite(p.width)),
                view: p.map_or_else(String::new, |p| p.view.name().into()),
                bends: p.map_or_else(Vec::new, bends::records),
            }
        })
        .collect()
}

/// Least uncertainty written into STEP headers, mm: below it CAD systems take edges for open.
const LEAST_UNCERTAINTY: f64 = 1e-6;

/// Name of the file of strips for CAD.
pub const STRIPS: &str = "strips.step";

/// Makes every file: those of [`geometry`] and of [`with_reports`].
///
/// # Errors
/// Data that a format cannot hold.
pub fn files(sheets: &Sheets, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    with_reports(sheets, shown, geometry(sheets, shown, time)?)
}

/// The files that hold geometry: strips.step, patterns.dxf, patterns.svg. `time` stamps the STEP header:
/// `2026-11-21T14:30:00`.
///
/// # Errors
/// As [`files`].
pub fn geometry(sheets: &Sheets, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    let mut out: Vec<File> = Vec::new();
    let header = Header {
        name: marks::product(&sheets.input, &shown.marks),
        time: time.to_owned(),
        uncertainty: LEAST_UNCERTAINTY,
    };
    let bodies = sheets.strips.iter().zip(&shown.marks.panels);
    let bodies = bodies.map(|(s, m)| if *m { Sheet::of_strip(s).marked() } else { Sheet::of_strip(s) });
    let bodies: Vec<Sheet> = bodies.collect();
    let mut put = |file: &'static str, write: &dyn Fn(&mut Vec<u8>) -> std::io::Result<()>| {
        let mut bytes = Vec::new();
        write(&mut bytes).map_err(|source| BundleError::Write { file, source })?;
        out.push((file.to_owned(), bytes));
        Ok::<(), BundleError>(())
    };
    put(STRIPS, &|b| step::sheets(b, &header, &bodies))?;
    put("patterns.dxf", &|b| dxf::write(b, &shown.drawing))?;
    put("patterns.svg", &|b| svg::write(b, &shown.drawing))?;
    Ok(out)
}

/// Adds bends.csv, model.glb, pictures, report.html and report.json to the files of [`geometry`].
///
/// # Errors
/// As [`files`].
pub fn with_reports(sheets: &Sheets, shown: &Presentation, mut out: Vec<File>) -> Result<Vec<File>, BundleError> {
    let limit = if sheets.meaning.limit > 0.0 { sheets.meaning.limit } else { sheets.tolerance };
    out.push(("model.glb".into(), glb::write(&shown.scene, limit)?));
    let word = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let what = word(sheets.strips.len(), "strip");
    let note = match sheets.status() {
        Status::Certified => format!("{what}, certified"),
        Status::Uncertified => format!("{what}, not certified"),
    };
    let report = Report::of(sheets, shown);
    let warning = report.do_not_cut(marks::FEW).map_or_else(String::new, |w| format!("; {w}"));
    let caption = |note: String| Caption { title: sheets.input.clone(), note: note + &warning, ..Caption::default() };
    let panels_png = png::write(&picture::panels(&shown.scene, &shown.direction, &caption(note)))?;
    let flat = caption(format!("{}, flat, 1:1 in patterns.dxf", word(sheets.patterns.len(), "part")));
    let layout_png = png::write(&picture::layout(&shown.pieces, &flat))?;
    let field_png = if sheets.fields.is_empty() {
        None
    } else {
        let what = format!("{}, {}", sheets.meaning.name, sheets.meaning.unit);
        let image =
            picture::values(&shown.scene, &shown.direction, limit, &what, &caption(sheets.meaning.name.clone()));
        Some(png::write(&image)?)
    };
    let mut outside = 0;
    let points_png = if sheets.points.places.is_empty() {
        None
    } else {
        let what = format!("{}, {}", sheets.meaning.name, sheets.meaning.unit);
        let words = caption(format!("{} of every point", sheets.meaning.name));
        let map = (&sheets.points.places[..], &sheets.points.values[..]);
        let image = picture::points(&shown.scene, map, &shown.direction, limit, &what, &words);
        outside = image.1;
        Some(png::write(&image.0)?)
    };
    let shapes_png = if shown.shapes.is_empty() {
        None
    } else {
        let words = caption("planes, cylinders, cones and tangent surfaces".into());
        Some(png::write(&picture::shapes(&shown.scene, &shown.shape_patches, &shown.direction, &words))?)
    };
    let html = page::write(&page::Page {
        report: &report,
        scene: &shown.scene,
        direction: shown.direction,
        layout: &shown.pieces,
        panels_png: &panels_png,
        field: field_png.as_ref().map(|png| (&sheets.meaning, png.as_slice())),
        points: points_png.as_ref().map(|png| (png.as_slice(), outside)),
        shapes_png: shapes_png.as_deref(),
        limit,
    })?;
    let json = report.to_json()?;
    out.push(("panels.png".into(), panels_png));
    if let Some(png) = field_png {
        out.push(("field.png".into(), png));
    }
    if let Some(png) = points_png {
        out.push(("points.png".into(), png));
    }
    if let Some(png) = shapes_png {
        out.push(("shapes.png".into(), png));
    }
    out.push(("layout.png".into(), layout_png));
    out.extend(bends::csv(&sheets.patterns).map(|b| ("bends.csv".into(), b)));
    out.push(("report.html".into(), html.into_bytes()));
    out.push(("report.json".into(), json.into_bytes()));
    Ok(out)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::answer::presentation::present_sheets;
    use crate::answer::sheets::{FieldMeaning, FlatPart, Guide, PointMap, StripField};
    use crate::certify::claim::What;
    use crate::develop::strip::{pattern, StripOptions};
    use crate::geom::Vec3;
    use crate::torse::form::PanelKind;
    use crate::torse::strip::Strip;

    /// One plane quadrilateral and one triangle on it.
    pub(crate) fn sample() -> Sheets {
        let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let strips = vec![
            Strip::quad("A-01", PanelKind::Plane, [x(0., 0., 0.), x(0., 50., 0.)], [x(90., 0., 0.), x(80., 50., 0.)])
                .expect("strip"),
            Strip::quad(
                "A-02",
                PanelKind::Plane,
                [x(90., 0., 0.), x(80., 50., 0.)],
                [x(120., 0., 40.), x(80., 50., 0.)],
            )
            .expect("strip"),
        ];
        let patterns = vec![pattern(&[&strips[0], &strips[1]], 0, "A", &StripOptions::new(0.01)).expect("pattern")];
        Sheets {
            job: "loft".into(),
            input: "plate <1>".into(),
            tolerance: 0.1,
            claims: vec![
                Claim::measured(What::RegressionClearance, Subject::Whole, f64::INFINITY),
                Claim::measured(What::Twist, Subject::Panel(0), 1e-9),
                Claim::measured(What::Twist, Subject::Panel(1), 1e-9),
            ],
            fields: vec![StripField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![0.0, 0.1, 0.2, -0.1] }; 2],
            points: PointMap {
                places: vec![x(20., 20., 0.1), x(40., 20., 9.)],
                values: vec![0.1, 9.0],
                worst: Some(1),
            },
            meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: 0.2 },
            parts: vec![FlatPart { name: "A".into(), first: 0, count: 2, missing: String::new() }],
            patterns,
            guides: vec![Guide { name: "rail".into(), points: vec![x(0., 0., 0.), x(90., 0., 0.)] }],
            notes: vec!["a & b".into()],
            skipped: vec![],
            seconds: 0.1,
            strips,
        }
    }

    /// Triangles with a common corner: a discrete cone.
    fn fan(count: usize) -> Vec<Strip> {
        let at = |k: usize| {
            let (s, c) = (0.2 * k as f64).sin_cos();
            [Vec3::new(100.0 * c, 80.0 * s, 0.0), Vec3::new(0.0, 0.0, 90.0)]
        };
        (0..count)
            .map(|k| Strip::quad(&format!("F-{}", k + 1), PanelKind::Plane, at(k), at(k + 1)).expect("strip"))
            .collect()
    }

    #[test]
    fn all_files_are_made_and_the_report_says_the_same_as_the_data() {
        let sheets = sample();
        let all = files(&sheets, &present_sheets(&sheets), "2026-11-21T14:30:00").expect("files");
        let names: Vec<&str> = all.iter().map(|f| f.0.as_str()).collect();
        for name in
            "strips.step patterns.dxf patterns.svg model.glb panels.png field.png points.png layout.png bends.csv report.html report.json"
                .split(' ')
        {
            assert!(names.contains(&name), "{name}");
        }
        let json = &all.iter().find(|f| f.0 == "report.json").expect("json").1;
        let report: Report = serde_json::from_slice(json).expect("a report");
        assert_eq!(report, Report::of(&sheets, &present_sheets(&sheets)));
        assert!(report.figures[0].value.is_none() && report.parts[0].strips == ["A-01", "A-02"]);
        let step = String::from_utf8_lossy(&all[0].1).into_owned();
        assert_eq!(step.matches("ADVANCED_FACE").count(), 2);
        // The triangle has three edges, the quadrilateral four.
        assert_eq!(step.matches("EDGE_CURVE").count(), 7);
    }

    #[test]
    fn every_file_of_an_uncertified_result_says_so() {
        let count = |files: &[File], name: &str, words: &str| {
            let bytes = &files.iter().find(|f| f.0 == name).expect(name).1;
            String::from_utf8_lossy(bytes).matches(words).count()
        };
        let mut sheets = sample();
        let made = |s: &Sheets| files(s, &present_sheets(s), "2026-11-21T14:30:00").expect("files");
        sheets.claims.push(Claim::left_out("a rail is missing"));
        let good = made(&sheets);
        for name in ["strips.step", "patterns.svg", "model.glb"] {
            assert_eq!(count(&good, name, "NOT CERTIFIED"), 0, "{name}");
        }
        assert_eq!(count(&good, "report.html", "class=\"stop\""), 1);
        sheets.claims.push(Claim::objection(Subject::Whole, "too far"));
        let bad = made(&sheets);
        // Product, its representations and shapes carry it, and so do nodes.
        assert!(count(&bad, "strips.step", "A-01 NOT CERTIFIED") >= 3);
        assert!(count(&bad, "strips.step", "PRODUCT('plate <1> NOT CERTIFIED'") == 1);
        assert!(count(&bad, "model.glb", "A-02 NOT CERTIFIED") >= 2);
        assert_eq!(count(&bad, "patterns.dxf", "\nCUT_OUTER\n"), 1, "the table of layers alone");
        assert!(count(&bad, "patterns.dxf", "\nNOT_CERTIFIED\n") > 3);
        assert!(count(&bad, "patterns.svg", "not-certified") > 0 && count(&bad, "patterns.svg", "cut-outer") == 0);
        assert_eq!(count(&bad, "report.html", "<p class=\"stop\" role=\"alert\">Not certified: do not cut A.</p>"), 1);
        assert_eq!(count(&bad, "report.json", "\"certified\": false"), 3);
        for name in ["panels.png", "field.png", "points.png", "layout.png"] {
            let of = |files: &[File]| files.iter().find(|f| f.0 == name).expect(name).1.clone();
            assert!(of(&good) != of(&bad), "{name}");
        }
    }

    #[test]
    fn the_documentation_names_every_field() {
        let doc = include_str!("../../../../docs/report-strips-json.md");
        let mut sheets = sample();
        sheets.strips = fan(8);
        sheets.parts[0].count = 8;
        let value = serde_json::to_value(Report::of(&sheets, &present_sheets(&sheets))).expect("json");
        assert!(value["shapes"][0]["shape"] == "cone" && value["shapes"][0]["last"] == "F-8");
        let records = [
            &value,
            &value["strips"][0],
            &value["parts"][0],
            &value["figures"][0],
            &value["shapes"][0],
            &value["worst_point"],
        ];
        for key in records.iter().filter_map(|r| r.as_object()).flat_map(|r| r.keys()) {
            assert!(doc.contains(&format!("`{key}`")), "{key} is not documented");
        }
    }
}
