//! `report.json`: the answer of any job as data (format: `docs/report-json.md`).
//!
//! The same record feeds `report.html`, so both always say the same.

use super::bend_table::SheetBendRecord;
use super::bends::BendRecord;
use super::{marks, words};
use crate::certify::claim::What;
use crate::develop::shop::thickness::SheetSide;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::part::SheetPart;
use serde::{Deserialize, Serialize};

mod of;

/// Name and version of the format.
pub const SCHEMA: &str = "torse-report/2";
/// Basis of a bound that was looked for and could not be shown.
pub(crate) const UNKNOWN: &str = "unknown";

/// The report could not be written or read.
#[derive(Debug, thiserror::Error)]
#[error("report.json: {0}")]
pub struct JsonError(#[from] serde_json::Error);

/// The whole report. Lengths in mm; `None` is written as `null` and stands for an infinite or unknown number.
///
/// # Example
/// ```
/// use torse::io::json::Report;
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let mut answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// let json = files.iter().find(|(name, _)| name == "report.json").expect("every job has one");
/// let report = Report::from_json(std::str::from_utf8(&json.1)?)?;
/// assert!(report.certified() && report.job == "unroll" && report.parts.len() == answer.parts.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    /// Why not certified, in short; empty when certified.
    pub reason: String,
    /// All that stands against the status, in plain words; empty when certified.
    pub objections: Vec<String>,
    /// Those of them that no panel says of itself; not part of the file.
    #[serde(skip)]
    pub beside_panels: Vec<String>,
    /// Unit of all lengths: `mm`.
    pub unit: String,
    /// Name of the input, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Figures of the whole.
    pub figures: Vec<FigureRecord>,
    /// Share of the area of the faces that panels cover; 1 exactly if the cover is proven to be complete. Faces that were
    /// left out count with their areas, as far as these are known. Null where nothing is to be covered.
    pub coverage: Option<f64>,
    /// What people should know.
    pub notes: Vec<String>,
    /// Items of the input that could not be used.
    pub skipped: Vec<SkippedRecord>,
    /// Faces of the input.
    pub faces: Vec<FaceRecord>,
    /// Panels.
    pub panels: Vec<PanelRecord>,
    /// Parts as they are cut.
    pub parts: Vec<PartRecord>,
    /// Seams between panels.
    pub seams: Vec<SeamRecord>,
    /// Joints between parts that marks on their patterns tell of.
    #[serde(default)]
    pub joints: Vec<JointRecord>,
    /// Lines along which pieces of a composite meet, the worst first.
    #[serde(default)]
    pub joins: Vec<JoinRecord>,
    /// Panels that were laid along curves.
    pub along: Vec<AlongRecord>,
    /// Planes, cylinders, cones and tangent surfaces along the parts.
    pub shapes: Vec<ShapeRecord>,
    /// The measured point farthest from the panels; null for jobs without points.
    pub worst_point: Option<PointRecord>,
    /// Files that were read back.
    pub written: Vec<WrittenRecord>,
}

/// A named number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureRecord {
    /// What it is, the same in every report: `deviation`, `bend_radius`.
    pub what: String,
    /// Name for people.
    pub name: String,
    /// Value; null for infinite or unknown.
    pub value: Option<f64>,
    /// Unit; empty for plain numbers.
    pub unit: String,
    /// `proven`, `measured` or `given`; `unknown` for a bound that could not be shown.
    pub basis: String,
    /// `upper` or `lower` for bounds, empty for other figures.
    pub bound: String,
    /// The limit that it has to keep, if there is one.
    pub limit: Option<f64>,
    /// Where it is seen, mm; left out where no place is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 3]>,
}

/// The value of a figure among several; `None` if there is none, or if it is infinite or unknown.
pub(crate) fn value(figures: &[FigureRecord], what: What) -> Option<f64> {
    figures.iter().find(|f| f.what == words::id(what))?.value
}

/// A file that was read back and compared with what was judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrittenRecord {
    /// Name of the file.
    pub file: String,
    /// Bound of the distance between what it holds and what was judged, mm; null if it does not agree.
    pub written_bound: Option<f64>,
}

/// A panel along a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlongRecord {
    /// Index of the panel.
    pub panel: usize,
    /// Name of the curve.
    pub curve: String,
    /// Strips between curve and panel; 0 along the curve itself.
    pub step: usize,
    /// Distance by the comparison of matching points, which counts their mismatch along the surface too; sampled, mm.
    pub paper_deviation_estimate: Option<f64>,
}

/// One seam. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeamRecord {
    /// Its number, as on the marks of both patterns: S3 of S3.1, S3.2, …
    #[serde(default)]
    pub number: Option<u32>,
    /// Indices of the panels on both sides.
    pub between: [usize; 2],
    /// `exact` (one common edge), `tolerance` (a gap of at most a quarter of the tolerance) or `open`.
    pub joint: String,
    /// Proven bound on the gap; null if none was shown.
    pub gap_bound: Option<f64>,
    /// Length, measured.
    pub seam_length: Option<f64>,
    /// Bound on the difference between the lengths of its two sides, mm; null if none was shown.
    #[serde(default)]
    pub length_difference_bound: Option<f64>,
    /// Smallest and largest angle between the panels along the seam, degrees, sampled.
    pub kink_deg: [f64; 2],
}

/// A joint: borders of two faces that meet, or both ends of a closed one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointRecord {
    /// Its name, as on the marks of both patterns: J3 of J3.1, J3.2, …
    pub name: String,
    /// Names of the parts; twice the same where a part is joined to itself.
    pub between: [String; 2],
    /// Number of marks on either side.
    pub marks: usize,
    /// Largest distance in space of two marks that belong together, mm: how far the panels are from meeting there. Measured.
    #[serde(default)]
    pub gap_estimate: Option<f64>,
    /// Length of each side in the plane, mm, where parts share an edge of their file; else null. Measured.
    #[serde(default)]
    pub lengths_estimate: Option<[f64; 2]>,
}

/// A line along which two pieces of a composite meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JoinRecord {
    /// Its number, from 0.
    pub number: usize,
    /// Names of the pieces.
    pub between: [String; 2],
    /// Proven bound on the gap, mm; null if none was shown.
    pub gap_bound: Option<f64>,
    /// Proven bound on the angle between the tangent planes, degrees; null if none was shown.
    pub angle_bound_deg: Option<f64>,
    /// Proven bound on how far both sides of a fold are apart in the plane, mm; null if it is no fold or none was shown.
    #[serde(default)]
    pub fold_bound: Option<f64>,
    /// Whether the pieces should go on smoothly.
    pub smooth: bool,
    /// Whether what is asked of it is proven.
    pub certified: bool,
}

/// An item of the input that could not be used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkippedRecord {
    /// Number of the entity in a CAD file; null for items of other files, which the reason names.
    pub entity: Option<u64>,
    /// Why, and what would help.
    pub reason: String,
    /// Its area as far as its surface or edges tell, mm²; null if unknown.
    pub area_estimate: Option<f64>,
}

/// One face of the input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceRecord {
    /// Entity number in the file.
    pub entity: u64,
    /// Name in the file; empty if it has none.
    pub name: String,
    /// Name of the part; empty if unknown.
    pub part: String,
    /// Kind of surface in the file.
    pub kind: String,
    /// Radius of a face that is a cylinder in the file, mm.
    #[serde(default)]
    pub radius: Option<f64>,
    /// Number of panels.
    pub panels: usize,
    /// Share of the area that panels cover.
    pub coverage: f64,
    /// Distance between the file's edge curves and the trim polygons, measured at samples, mm.
    pub trim_deviation_estimate: Option<f64>,
    /// Distance between the file's surface and the spline used for it, measured at samples, mm.
    pub surface_deviation_estimate: Option<f64>,
    /// Bound on that distance, mm, part of `trim_bound`; none where it was only measured.
    #[serde(default)]
    pub surface_bound: Option<f64>,
    /// Faces of the file that were joined to this one, because they go on smoothly; empty for a face of the file.
    #[serde(default)]
    pub joined: Vec<JoinedRecord>,
    /// Bound on what joining moved, mm; part of every panel's deviation bound.
    #[serde(default)]
    pub joint_bound: f64,
    /// Bound on the distance between the face as its file bounds it and the trim, part of `deviation_bound`, mm; null if
    /// none was shown.
    #[serde(default)]
    pub trim_bound: Option<f64>,
}

/// A face of the file that is part of a joined face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JoinedRecord {
    /// Entity number in the file.
    pub entity: u64,
    /// Name in the file; empty if it has none.
    pub name: String,
}

/// One panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PanelRecord {
    /// Name, the same in all files.
    pub name: String,
    /// Index into `faces`; null for a panel that covers no face.
    pub face: Option<usize>,
    /// `plane`, `cylinder`, `cone` or `torse`.
    pub kind: String,
    /// Whether it may be cut.
    pub certified: bool,
    /// Why not; empty when certified.
    pub reason: String,
    /// Place where the tolerance is exceeded, if one was found.
    pub witness: Option<WitnessRecord>,
    /// Its figures.
    pub figures: Vec<FigureRecord>,
}

/// One part as it is cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartRecord {
    /// Name, the same in all files.
    pub name: String,
    /// Names of its panels.
    pub panels: Vec<String>,
    /// Name of the part of the model in its file, several with `+` between them; empty if there is none.
    #[serde(default)]
    pub source: String,
    /// Whether it may be cut.
    pub certified: bool,
    /// Why there is no pattern; empty if there is one.
    pub missing: String,
    /// Area in space, mm².
    pub area: Option<f64>,
    /// Area of the flat pattern, mm².
    pub flat_area: Option<f64>,
    /// Largest relative error of lengths on the flat pattern, measured.
    pub isometry_error: Option<f64>,
    /// Largest distance between the outline drawn and the exact flat outline, measured, mm; null if unknown.
    pub contour_error: Option<f64>,
    /// Bound of the relative change of any length on the flat pattern, proven; null if none was shown.
    pub strain_bound: Option<f64>,
    /// Bound of the distance of outline, rulings and marks as drawn from the flat image of the part, mm, proven; null if
    /// none was shown.
    pub drawing_bound: Option<f64>,
    /// Long side of the smallest rectangle around the flat pattern, mm.
    pub length: Option<f64>,
    /// Short side, mm.
    pub width: Option<f64>,
    /// Side of the model from which the pattern is seen: `outside` or `inside`; empty without a pattern.
    pub view: String,
    /// Its bend lines.
    pub bends: Vec<BendRecord>,
    /// Thickness of the sheet, mm; null where none is known.
    pub thickness: Option<f64>,
    /// Bends of sheet metal with their allowances.
    pub sheet_bends: Vec<SheetBendRecord>,
    /// Where the neutral fibre of sheet metal lies, whose flat pattern this is; null for surfaces.
    #[serde(default)]
    pub neutral: Option<NeutralRecord>,
    /// Name of the first part whose flat pattern is the same; empty if there is none before it.
    pub same_as: String,
    /// Whether one of the two must be turned over.
    pub mirrored: bool,
    /// Name of the first part of which this one is the mirror image, bent the same way; empty if there is none before it, and for
    /// parts that equal another.
    #[serde(default)]
    pub opposite_hand_of: String,
    /// Parts that are made from this drawing as it is, this one among them; 0 where `same_as` names another drawing.
    #[serde(default)]
    pub quantity: usize,
    /// Lines of curves of the model that lie on it, drawn to be marked.
    #[serde(default)]
    pub curves: usize,
    /// Parts that are made from this drawing turned over.
    #[serde(default)]
    pub quantity_turned_over: usize,
    /// Length of all cuts, mm.
    #[serde(default)]
    pub cut_length: Option<f64>,
    /// Closed outlines to be cut: how often the machine pierces the sheet.
    #[serde(default)]
    pub pierces: usize,
    /// What the sheet is made of; empty where nothing was said.
    #[serde(default)]
    pub material: String,
    /// Where the numbers of the material come from; empty where nothing was said.
    #[serde(default)]
    pub material_source: String,
    /// Weight, kg; null without material or thickness.
    #[serde(default)]
    pub weight_kg: Option<f64>,
    /// Least radius of curvature of the sheet's inside, mm, by the bend lines (measured); null for flat parts and without a
    /// thickness.
    #[serde(default)]
    pub inside_radius: Option<f64>,
    /// Distance of the neutral fibre, whose flat pattern this is, from the panels, mm; positive outwards; null without a
    /// thickness.
    #[serde(default)]
    pub neutral_offset: Option<f64>,
    /// How it is kinked; null where it is not.
    #[serde(default)]
    pub facets: Option<FacetsRecord>,
}

/// Where the neutral fibre of a part of sheet metal lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeutralRecord {
    /// How its depth is given.
    pub k: KRecord,
    /// Thickness at every panel of the part, mm.
    pub thickness: Vec<f64>,
    /// Which side of the sheet the panels are (`inside`, `middle`, `outside`), of surfaces that were given a thickness; null for bodies,
    /// whose panels are outer sides.
    #[serde(default)]
    pub side: Option<String>,
}

impl NeutralRecord {
    /// Of a part; `None` where its surfaces are drawn as they are.
    fn of(sheet: &SheetPart) -> Option<Self> {
        let of_body = || Self { k: KRecord::of(&sheet.k), thickness: sheet.local.clone(), side: None };
        let given = sheet.given.as_ref().map(|g| Self {
            k: KRecord::of(&g.k),
            thickness: vec![g.thickness; sheet.local.len()],
            side: Some(g.side.words().into()),
        });
        given.or_else(|| (sheet.thickness > 0.0).then(of_body))
    }

    /// The side, if there is one; an unknown word is an error.
    ///
    /// # Errors
    /// The word.
    pub fn sheet_side(&self) -> Result<Option<SheetSide>, &str> {
        let Some(word) = self.side.as_deref() else { return Ok(None) };
        let all = [SheetSide::Inside, SheetSide::Middle, SheetSide::Outside];
        all.into_iter().find(|s| s.words() == word).map(Some).ok_or(word)
    }
}

/// A K-factor: depth of the neutral fibre as a share of the thickness; `"din"`; or rows of inside radius over thickness and
/// share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum KRecord {
    /// The share.
    Share(f64),
    /// `din`.
    Name(String),
    /// Rows.
    Table(Vec<[f64; 2]>),
}

impl KRecord {
    /// As it is written.
    fn of(k: &KFactor) -> Self {
        match k {
            KFactor::Ansi(share) => Self::Share(*share),
            KFactor::Din => Self::Name(DIN.into()),
            KFactor::Table(rows) => Self::Table(rows.clone()),
        }
    }

    /// The factor; `None` for an unknown name or numbers that cannot be.
    pub fn factor(&self) -> Option<KFactor> {
        let k = match self {
            Self::Share(share) => KFactor::Ansi(*share),
            Self::Name(name) if name == DIN => KFactor::Din,
            Self::Name(_) => return None,
            Self::Table(rows) => KFactor::Table(rows.clone()),
        };
        k.check().is_ok().then_some(k)
    }
}

/// The formula of DIN 6935 by name.
const DIN: &str = "din";

/// A part that is kinked on a press brake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FacetsRecord {
    /// Number of kinks.
    pub kinks: usize,
    /// Greatest distance of a place of the kinked part from where it is on the curved one, after the best rigid motion, mm.
    pub displacement_estimate: Option<f64>,
    /// Greatest height of an arc over its facet, mm.
    pub sagitta_estimate: Option<f64>,
}

/// A place on a face where the tolerance is exceeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WitnessRecord {
    /// Parameters (u, v) on the face.
    pub uv: [f64; 2],
    /// Signed distance there, mm.
    pub distance: Option<f64>,
}

/// A measured point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    /// Index in the input, from 0.
    pub index: usize,
    /// Place, mm.
    pub place: [f64; 3],
    /// Signed distance from the nearest panel, mm; null without panels.
    pub deviation: Option<f64>,
}

/// A stretch of a part that is of one shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeRecord {
    /// Name of the part.
    pub part: String,
    /// `plane`, `cylinder`, `cone` or `tangent`.
    pub shape: String,
    /// Name of the panel in which it begins.
    pub first: String,
    /// Name of the panel in which it ends.
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

impl Report {
    /// Whether the status is `certified`.
    pub fn certified(&self) -> bool {
        self.status == "certified"
    }

    /// Whether panels cover faces.
    pub fn covers_faces(&self) -> bool {
        !self.faces.is_empty()
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
    pub fn to_json(&self) -> Result<String, JsonError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Writes that text.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn std::io::Write) -> std::io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        out.write_all(b"\n")
    }

    /// Reads a report back.
    ///
    /// # Errors
    /// Text that is not a report of this schema.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Ok(serde_json::from_str(text)?)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn figure(what: What, value: f64, unit: &str, limit: Option<f64>) -> FigureRecord {
        let id = words::id(what);
        FigureRecord {
            what: id.into(),
            name: id.replace('_', " "),
            value: Some(value),
            unit: unit.into(),
            basis: "proven".into(),
            bound: if matches!(what, What::RegressionClearance | What::BendRadius) { "lower" } else { "upper" }.into(),
            limit,
            at: None,
        }
    }

    /// Changes the value of a figure.
    pub(crate) fn set(figures: &mut [FigureRecord], what: What, value: Option<f64>) {
        figures.iter_mut().find(|f| f.what == words::id(what)).expect("a figure").value = value;
    }

    /// A certified report of two panels on one face.
    #[expect(clippy::too_many_lines, reason = "one record, member by member")]
    pub(crate) fn sample() -> Report {
        let panel = |name: &str, bound: f64| PanelRecord {
            name: name.into(),
            face: Some(0),
            kind: "torse".into(),
            certified: true,
            reason: String::new(),
            witness: None,
            figures: vec![
                figure(What::Deviation, bound, "mm", Some(1.0)),
                figure(What::Twist, 1.8e-7, "°", None),
                figure(What::RegressionClearance, 412.7, "mm", None),
                figure(What::BendRadius, 240.5, "mm", None),
            ],
        };
        let part = |name: &str| PartRecord {
            name: name.into(),
            panels: vec![name.into()],
            source: "hull".into(),
            certified: true,
            missing: String::new(),
            area: Some(81_520.4),
            flat_area: Some(81_520.3),
            isometry_error: Some(2.4e-9),
            contour_error: Some(0.081),
            strain_bound: Some(3.1e-10),
            drawing_bound: Some(0.082),
            length: Some(1281.3),
            width: Some(90.2),
            view: "outside".into(),
            bends: Vec::new(),
            thickness: None,
            sheet_bends: Vec::new(),
            neutral: None,
            same_as: String::new(),
            mirrored: false,
            opposite_hand_of: String::new(),
            quantity: 1,
            quantity_turned_over: 0,
            cut_length: Some(2742.9),
            pierces: 1,
            material: String::new(),
            material_source: String::new(),
            curves: 0,
            weight_kg: None,
            inside_radius: None,
            neutral_offset: None,
            facets: Some(FacetsRecord { kinks: 3, displacement_estimate: Some(0.2), sagitta_estimate: Some(0.3) }),
        };
        Report {
            schema: SCHEMA.into(),
            version: "0.1.0".into(),
            job: "approximate".into(),
            status: "certified".into(),
            reason: String::new(),
            objections: vec![],
            beside_panels: vec![],
            unit: "mm".into(),
            input: "sample.step".into(),
            tolerance: 1.0,
            seconds: 1.25,
            figures: vec![
                figure(What::Deviation, 0.987_654_3, "mm", Some(1.0)),
                figure(What::SeamGap, 0.0042, "mm", None),
            ],
            coverage: Some(1.0),
            skipped: vec![],
            notes: vec![],
            faces: vec![FaceRecord {
                entity: 42,
                name: "side".into(),
                part: "hull".into(),
                kind: "spline".into(),
                radius: None,
                panels: 2,
                coverage: 1.0,
                trim_deviation_estimate: Some(0.0),
                surface_deviation_estimate: Some(0.0),
                surface_bound: Some(0.0),
                joined: Vec::new(),
                joint_bound: 0.0,
                trim_bound: Some(0.0),
            }],
            panels: vec![panel("A-01", 0.95), panel("A-02", 0.987_654_3)],
            parts: vec![part("A-01"), part("A-02")],
            along: vec![AlongRecord {
                panel: 0,
                curve: "x=1200mm".into(),
                step: 0,
                paper_deviation_estimate: Some(0.5),
            }],
            joints: vec![JointRecord {
                name: "J1".into(),
                between: ["A-01".into(), "A-02".into()],
                marks: 3,
                gap_estimate: Some(0.25),
                lengths_estimate: Some([80.0, 80.5]),
            }],
            joins: vec![],
            seams: vec![SeamRecord {
                number: Some(1),
                between: [0, 1],
                joint: "exact".into(),
                gap_bound: Some(0.0042),
                seam_length: Some(1280.0),
                length_difference_bound: Some(0.5),
                kink_deg: [6.1, 6.9],
            }],
            shapes: vec![],
            worst_point: None,
            written: vec![WrittenRecord { file: "panels.step".into(), written_bound: Some(0.0) }],
        }
    }

    #[test]
    fn what_is_written_is_read_back_and_infinity_is_null() {
        let mut report = sample();
        set(&mut report.panels[1].figures, What::RegressionClearance, None);
        report.panels[1].witness = Some(WitnessRecord { uv: [0.25, 0.5], distance: Some(-1.5) });
        let text = report.to_json().expect("text");
        assert_eq!(Report::from_json(&text).expect("a report"), report);
        let value: serde_json::Value = serde_json::from_str(&text).expect("json");
        assert!(value["panels"][1]["figures"][2]["value"].is_null());
        assert_eq!(value["panels"][0]["figures"][0]["value"], 0.95);
    }

    #[test]
    fn the_documentation_names_every_field() {
        let doc = include_str!("../../../../docs/report-json.md");
        let mut report = sample();
        report.skipped.push(SkippedRecord { entity: None, reason: "offset".into(), area_estimate: None });
        report.panels[0].witness = Some(WitnessRecord { uv: [0.0, 0.0], distance: None });
        report.worst_point = Some(PointRecord { index: 0, place: [0.0; 3], deviation: None });
        report.shapes.push(ShapeRecord {
            part: "A".into(),
            shape: "cone".into(),
            first: "A-01".into(),
            last: "A-02".into(),
            turn: 1.0,
            vector: None,
            residual: 0.0,
            ambiguous: false,
        });
        let value = serde_json::to_value(report).expect("json");
        let mut keys = Vec::new();
        collect(&value, &mut keys);
        for key in keys {
            assert!(doc.contains(&format!("`{key}`")), "{key} is not documented");
        }
    }

    fn collect(value: &serde_json::Value, keys: &mut Vec<String>) {
        match value {
            serde_json::Value::Object(o) => o.iter().for_each(|(k, v)| {
                keys.push(k.clone());
                collect(v, keys);
            }),
            serde_json::Value::Array(a) => a.iter().for_each(|v| collect(v, keys)),
            _ => {}
        }
    }
}
