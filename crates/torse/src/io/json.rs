//! `report.json`: the answer of the main job as data (format: `docs/report-json.md`).
//!
//! The same record feeds `report.html`, so both always say the same.

use super::bends::{self, BendRecord};
use super::{marks, words};
use crate::answer::marks::Marks;
use crate::answer::outcome::Outcome;
use crate::brep::face::SurfaceKind;
use crate::certify::claim::Status;
use crate::certify::flat::FlatCertificate;
use crate::certify::PanelCertificate;
use crate::certify::{SeamCertificate, SeamStatus};
use crate::patchwork::pattern::Pattern;
use crate::tessellate::coverage;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const SCHEMA: &str = "torse-report/1";

/// The report could not be written or read.
#[derive(Debug, thiserror::Error)]
#[error("report.json: {0}")]
pub struct JsonError(#[from] serde_json::Error);

/// The whole report. Lengths in mm; `None` is written as `null` and stands for an infinite or unknown number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// `certified` or `uncertified`.
    pub status: String,
    /// Why not certified; empty when certified.
    pub reason: String,
    /// Unit of all lengths: `mm`.
    pub unit: String,
    /// Name of the input file, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// Two-sided bound on the distance between faces and panels, mm; null if none was shown.
    pub deviation_bound: Option<f64>,
    /// Bound on the gap across seams, mm; null if none was shown.
    pub seam_gap_bound: Option<f64>,
    /// Share of the area of the faces that panels cover; 1 exactly if the cover is proven to be complete. Faces that were
    /// left out count with their areas, as far as these are known.
    pub coverage: f64,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Parts of the proof that are missing, in plain words.
    pub missing: Vec<String>,
    /// Items of the file that could not be used.
    pub skipped: Vec<SkippedRecord>,
    /// What people should know of the file and the job.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Faces of the input.
    pub faces: Vec<FaceRecord>,
    /// Panels.
    pub panels: Vec<PanelRecord>,
    /// Seams.
    #[serde(default)]
    pub seams: Vec<SeamRecord>,
    /// Panels that were laid along curves.
    #[serde(default)]
    pub along: Vec<AlongRecord>,
    /// Files that were read back.
    #[serde(default)]
    pub written: Vec<WrittenRecord>,
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

/// An item of the file that could not be used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkippedRecord {
    /// Entity number in the file.
    pub entity: u64,
    /// Why, and what would help.
    pub reason: String,
    /// Its area as far as its surface or edges tell, mm²; null if unknown.
    #[serde(default)]
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
    /// Number of panels.
    pub panels: usize,
    /// Share of the area that panels cover.
    pub coverage: f64,
    /// Distance between the file's edge curves and the trim polygons, measured at samples, mm.
    pub trim_deviation_estimate: Option<f64>,
    /// Distance between the file's surface and the spline used for it, measured at samples, mm.
    pub surface_deviation_estimate: Option<f64>,
    /// Faces of the file that were joined to this one, because they go on smoothly; empty for a face of the file.
    #[serde(default)]
    pub joined: Vec<PartRecord>,
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
pub struct PartRecord {
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
    /// Index into `faces`.
    pub face: usize,
    /// `plane`, `cylinder`, `cone` or `torse`.
    pub kind: String,
    /// Whether all bounds of this panel are proven and within the tolerance.
    pub certified: bool,
    /// Why not; empty when certified.
    pub reason: String,
    /// Place where the tolerance is exceeded, if one was found.
    pub witness: Option<WitnessRecord>,
    /// Two-sided bound between panel and its part of the face, mm.
    pub deviation_bound: Option<f64>,
    /// Largest angle between tangent planes along a ruling, rad.
    pub developability_bound: Option<f64>,
    /// Lower bound of the distance to the regression curve along rulings, mm; null if there is none.
    pub regression_clearance: Option<f64>,
    /// Lower bound of the bending radius, mm; null for planes.
    pub min_bend_radius: Option<f64>,
    /// Area in space, mm².
    pub area: Option<f64>,
    /// Area of the flat pattern, mm².
    pub flat_area: Option<f64>,
    /// Largest relative error of lengths on the flat pattern, measured.
    pub isometry_error: Option<f64>,
    /// Largest distance between the outline drawn and the exact flat outline, mm.
    pub contour_error: Option<f64>,
    /// Bound of the relative change of any length on the flat pattern, proven; null if none was shown.
    #[serde(default)]
    pub strain_bound: Option<f64>,
    /// Bound of the distance of outline, rulings and marks as drawn from the flat image of the panel, mm, proven; null if
    /// none was shown.
    #[serde(default)]
    pub drawing_bound: Option<f64>,
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

/// A place on a face where the tolerance is exceeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WitnessRecord {
    /// Parameters (u, v) on the face.
    pub uv: [f64; 2],
    /// Signed distance there, mm.
    pub distance: Option<f64>,
}

impl Report {
    /// The record of an outcome.
    pub fn of(outcome: &Outcome) -> Self {
        let certificate = &outcome.certificate;
        let status = match outcome.status() {
            Status::Certified => "certified",
            Status::Uncertified => "uncertified",
        };
        let coverages = coverage::faces(&outcome.patchwork);
        let areas: Vec<Option<f64>> = outcome.skipped.iter().map(|s| s.area_estimate).collect();
        Self {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            status: status.into(),
            reason: words::reason(&outcome.claims, &[]),
            unit: "mm".into(),
            input: outcome.input.clone(),
            tolerance: outcome.tolerance,
            deviation_bound: finite(certificate.deviation_bound),
            seam_gap_bound: finite(certificate.seam_gap_bound),
            coverage: covered_share(
                certificate.covered && outcome.skipped.is_empty(),
                coverage::total(&coverages).beside(&areas).share(),
            ),
            seconds: outcome.seconds,
            missing: certificate.missing.clone(),
            skipped: outcome
                .skipped
                .iter()
                .map(|s| SkippedRecord {
                    entity: s.entity,
                    reason: s.reason.clone(),
                    area_estimate: s.area_estimate.and_then(finite),
                })
                .collect(),
            notes: outcome.notes.clone(),
            faces: face_records(outcome, &coverages),
            panels: panel_records(outcome),
            seams: certificate.seams.iter().map(seam_record).collect(),
            along: outcome
                .along
                .iter()
                .map(|a| AlongRecord {
                    panel: a.panel,
                    curve: a.curve.clone(),
                    step: a.step,
                    paper_deviation_estimate: finite(a.paper_estimate),
                })
                .collect(),
            written: outcome
                .written
                .iter()
                .map(|(file, w)| WrittenRecord { file: file.clone(), written_bound: finite(w.bound()) })
                .collect(),
        }
    }

    /// Whether the status is `certified`.
    pub fn certified(&self) -> bool {
        self.status == "certified"
    }

    /// What must not be cut, in words that tell at most so many names; `None` if the result is certified.
    pub fn do_not_cut(&self, most: usize) -> Option<String> {
        let bad: Vec<&str> = self.panels.iter().filter(|p| !p.certified).map(|p| p.name.as_str()).collect();
        (!self.certified()).then(|| marks::do_not_cut(&bad, self.panels.len(), most))
    }

    /// The text of `report.json`.
    ///
    /// # Errors
    /// None in practice: every field has a JSON form.
    pub fn to_json(&self) -> Result<String, JsonError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads a report back.
    ///
    /// # Errors
    /// Text that is not a report of this schema.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Ok(serde_json::from_str(text)?)
    }
}

/// The text of `report.json` for an outcome.
///
/// # Errors
/// None in practice: every field has a JSON form.
pub fn write(outcome: &Outcome) -> Result<String, JsonError> {
    Report::of(outcome).to_json()
}

/// JSON has no infinity; `null` stands for it.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// 1 is kept for covers that the certificate confirms.
fn covered_share(confirmed: bool, share: f64) -> f64 {
    if confirmed {
        1.0
    } else {
        share.min(1.0 - f64::EPSILON)
    }
}

fn seam_record(s: &SeamCertificate) -> SeamRecord {
    let joint = match s.status {
        SeamStatus::Exact => "exact",
        SeamStatus::Tolerance => "tolerance",
        SeamStatus::Open => "open",
    };
    let (least, most) = s.kink_range_estimate;
    SeamRecord {
        between: s.panels,
        joint: joint.into(),
        gap_bound: finite(s.gap_bound),
        seam_length: finite(s.length_estimate),
        length_difference_bound: finite(s.length_difference_bound),
        kink_deg: [least.to_degrees(), most.to_degrees()],
    }
}

fn face_records(outcome: &Outcome, coverages: &[coverage::Coverage]) -> Vec<FaceRecord> {
    let patchwork = &outcome.patchwork;
    let record = |(i, face): (usize, &crate::brep::face::Face)| FaceRecord {
        entity: face.entity,
        name: face.name.clone(),
        part: face.part.clone(),
        kind: kind_name(face.kind).into(),
        panels: patchwork.panels.iter().filter(|p| p.face() == Some(i)).count(),
        coverage: coverages.get(i).map_or(0.0, coverage::Coverage::share),
        trim_deviation_estimate: finite(face.trim_deviation_estimate),
        surface_deviation_estimate: finite(face.surface_deviation_estimate),
        joined: face.parts.iter().map(|p| PartRecord { entity: p.entity, name: p.name.clone() }).collect(),
        joint_bound: face.joint_bound(),
        trim_bound: finite(face.trim_bound()),
    };
    patchwork.faces.iter().enumerate().map(record).collect()
}

fn panel_records(outcome: &Outcome) -> Vec<PanelRecord> {
    let panels = outcome.patchwork.panels.iter().enumerate();
    let marks = Marks::of(outcome);
    panels
        .map(|(i, panel)| {
            let proof: Option<&PanelCertificate> = outcome.certificate.panels.get(i);
            let pattern: Option<&Pattern> = outcome.patterns.iter().find(|p| p.panel == i);
            let flat = outcome.flat.iter().find(|f| f.panel() == i);
            let shown = |value: fn(&FlatCertificate) -> f64| flat.map(value).and_then(finite);
            let proven = |value: fn(&PanelCertificate) -> f64| proof.map(value).and_then(finite);
            let drawn = |value: fn(&Pattern) -> f64| pattern.map(value).and_then(finite);
            PanelRecord {
                name: panel.strip.name.clone(),
                face: panel.face().unwrap_or_default(),
                kind: panel.strip.kind.name().into(),
                certified: !marks.panels[i],
                reason: if marks.panels[i] { reason(outcome, i) } else { String::new() },
                witness: proof
                    .and_then(|p| p.witness)
                    .map(|(uv, distance)| WitnessRecord { uv, distance: finite(distance) }),
                deviation_bound: proven(|p| p.deviation_bound),
                developability_bound: proven(|p| p.developability_bound),
                regression_clearance: proven(|p| p.regression_clearance),
                min_bend_radius: proven(|p| p.min_bend_radius),
                area: drawn(|p| p.area_in_space),
                flat_area: drawn(|p| p.area),
                isometry_error: drawn(|p| p.isometry_error),
                contour_error: drawn(|p| p.contour_error),
                strain_bound: shown(FlatCertificate::strain_bound),
                drawing_bound: shown(FlatCertificate::drawing_bound),
                length: drawn(|p| p.length),
                width: drawn(|p| p.width),
                view: pattern.map_or_else(String::new, |p| p.view.name().into()),
                bends: pattern.map_or_else(Vec::new, bends::records),
            }
        })
        .collect()
}

/// Why a panel is not certified: its own proof, else what the whole asks of it.
fn reason(outcome: &Outcome, panel: usize) -> String {
    match outcome.certificate.panels.get(panel) {
        None => "not examined".into(),
        Some(p) if !p.certified => p.reason.clone(),
        Some(p) if p.deviation_bound > outcome.tolerance => {
            format!("proven for {:.6} mm only, which exceeds the tolerance", p.deviation_bound)
        }
        Some(_) if outcome.beyond_limits.contains(&panel) => "it does not keep the limits of sheet and material".into(),
        Some(_) if !outcome.patterns.iter().any(|p| p.panel == panel) => "it has no flat pattern".into(),
        Some(_) => format!("the whole is not certified: {}", words::reason(&outcome.claims, &[])),
    }
}

/// Lower-case name of a kind of surface.
fn kind_name(kind: SurfaceKind) -> &'static str {
    match kind {
        SurfaceKind::Plane => "plane",
        SurfaceKind::Cylinder => "cylinder",
        SurfaceKind::Cone => "cone",
        SurfaceKind::Sphere => "sphere",
        SurfaceKind::Torus => "torus",
        SurfaceKind::Extrusion => "extrusion",
        SurfaceKind::Revolution => "revolution",
        SurfaceKind::Offset => "offset",
        SurfaceKind::Spline => "spline",
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A certified report of two panels on one face.
    pub(crate) fn sample() -> Report {
        let panel = |name: &str, bound: f64| PanelRecord {
            name: name.into(),
            face: 0,
            kind: "torse".into(),
            certified: true,
            reason: String::new(),
            witness: None,
            deviation_bound: Some(bound),
            developability_bound: Some(3.2e-9),
            regression_clearance: Some(412.7),
            min_bend_radius: Some(240.5),
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
        };
        Report {
            schema: SCHEMA.into(),
            version: "0.1.0".into(),
            status: "certified".into(),
            reason: String::new(),
            unit: "mm".into(),
            input: "sample.step".into(),
            tolerance: 1.0,
            deviation_bound: Some(0.987_654_3),
            seam_gap_bound: Some(0.0042),
            coverage: 1.0,
            seconds: 1.25,
            missing: vec![],
            skipped: vec![],
            notes: vec![],
            faces: vec![FaceRecord {
                entity: 42,
                name: "side".into(),
                part: "hull".into(),
                kind: "spline".into(),
                panels: 2,
                coverage: 1.0,
                trim_deviation_estimate: Some(0.0),
                surface_deviation_estimate: Some(0.0),
                joined: Vec::new(),
                joint_bound: 0.0,
                trim_bound: Some(0.0),
            }],
            panels: vec![panel("A-01", 0.95), panel("A-02", 0.987_654_3)],
            along: vec![AlongRecord {
                panel: 0,
                curve: "x=1200mm".into(),
                step: 0,
                paper_deviation_estimate: Some(0.5),
            }],
            seams: vec![SeamRecord {
                between: [0, 1],
                joint: "exact".into(),
                gap_bound: Some(0.0042),
                seam_length: Some(1280.0),
                length_difference_bound: Some(0.5),
                kink_deg: [6.1, 6.9],
            }],
            written: vec![WrittenRecord { file: "panels.step".into(), written_bound: Some(0.0) }],
        }
    }

    #[test]
    fn what_is_written_is_read_back_and_infinity_is_null() {
        let mut report = sample();
        report.panels[1].regression_clearance = finite(f64::INFINITY);
        report.panels[1].witness = Some(WitnessRecord { uv: [0.25, 0.5], distance: Some(-1.5) });
        let text = report.to_json().expect("text");
        assert_eq!(Report::from_json(&text).expect("a report"), report);
        let value: serde_json::Value = serde_json::from_str(&text).expect("json");
        assert!(value["panels"][1]["regression_clearance"].is_null());
        assert_eq!(value["panels"][0]["deviation_bound"], 0.95);
    }

    #[test]
    fn every_promised_field_is_there_under_its_name() {
        let value = serde_json::to_value(sample()).expect("json");
        for field in
            "schema status unit tolerance deviation_bound seam_gap_bound coverage seconds faces panels".split(' ')
        {
            assert!(value.get(field).is_some(), "{field}");
        }
        let panel = "name face kind deviation_bound developability_bound regression_clearance area flat_area \
                     isometry_error length width min_bend_radius";
        for field in panel.split_whitespace() {
            assert!(value["panels"][0].get(field).is_some(), "{field}");
        }
    }

    #[test]
    fn the_documentation_names_every_field() {
        let doc = include_str!("../../../../docs/report-json.md");
        let mut report = sample();
        report.skipped.push(SkippedRecord { entity: 7, reason: "offset of an offset".into(), area_estimate: None });
        report.panels[0].witness = Some(WitnessRecord { uv: [0.0, 0.0], distance: None });
        let value = serde_json::to_value(report).expect("json");
        let records = [
            &value,
            &value["seams"][0],
            &value["along"][0],
            &value["written"][0],
            &value["panels"][0],
            &value["faces"][0],
            &value["skipped"][0],
            &value["panels"][0]["witness"],
        ];
        for key in records.iter().filter_map(|r| r.as_object()).flat_map(|r| r.keys()) {
            assert!(doc.contains(&format!("`{key}`")), "{key} is not documented");
        }
    }
}
