//! Jobs for `torse shape`: JSON files that say what strips are made of, what holds them together, and what is pulled.
//!
//! The schema is described in `docs/shape.md`. Lengths become mm here; names and indices are not looked up: that is for who
//! sets up the strips. Errors name the place in the file: `$.handles[2].plane`.

use crate::geom::{unit, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::through;
use serde::Deserialize;
use serde_json::Value;

/// A job as written, lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeFile {
    /// Length of the job's unit, mm, which is that of files beside it that do not say theirs.
    pub unit: f64,
    /// Boundary curves: name, curve, whether it stays.
    pub curves: Vec<(String, Curve<3>, bool)>,
    /// Strips.
    pub strips: Vec<StripRecord>,
    /// Strips that other files hold or bound.
    pub from: Vec<FromRecord>,
    /// Planar pieces between ends of curves.
    pub facets: Vec<FacetRecord>,
    /// Joins.
    pub joins: Vec<JoinRecord>,
    /// Handles.
    pub handles: Vec<HandleRecord>,
    /// Distances.
    pub lengths: Vec<LengthRecord>,
    /// Surfaces to be near.
    pub targets: Vec<TargetRecord>,
    /// Moves of handles, one after the other.
    pub moves: Vec<MoveRecord>,
}

/// A strip between two curves.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StripRecord {
    /// Name.
    pub name: String,
    /// Names of its curves.
    pub sides: [String; 2],
    /// Part of a plane instead of a developable; default false.
    #[serde(default)]
    pub planar: bool,
    /// Ruled, whatever its rulings do; default false.
    #[serde(default)]
    pub ruled: bool,
    /// Distance of the regression curve, as a share of the ruling; default 0.05.
    #[serde(default = "default_margin")]
    pub margin: f64,
}

fn default_margin() -> f64 {
    0.05
}

/// Strips taken over from an earlier result, or made between two curves by a loft.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FromRecord {
    /// `panels.step` of an earlier result, beside the job.
    pub panels: Option<String>,
    /// Names of the panels to take; default all.
    #[serde(default)]
    pub names: Vec<String>,
    /// Two files of curves (`name.step#12`), beside the job.
    pub loft: Option<[String; 2]>,
    /// Pieces of the splines that a strip is laid on; default 6.
    #[serde(default = "default_spans")]
    pub spans: usize,
    /// Degree of these, 2, 3 or 5; default 3.
    #[serde(default = "default_degree")]
    pub degree: usize,
}

fn default_spans() -> usize {
    6
}

fn default_degree() -> usize {
    3
}

/// A planar piece.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacetRecord {
    /// Name.
    pub name: String,
    /// Three or four corners in order, ends of curves.
    pub corners: Vec<PlaceRecord>,
    /// For triangles: how far curves leave a corner parallel to the opposite side, in lengths of it.
    pub alpha: Option<f64>,
}

/// How strips, or curves, meet.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JoinRecord {
    /// The strip that ends and the one that begins at a common ruling.
    pub ruling: Option<[String; 2]>,
    /// Ends of two curves that meet.
    pub ends: Option<[PlaceRecord; 2]>,
    /// "G0", "G1", "G2" or "C1" there; default G1.
    pub smoothness: Option<Smooth>,
    /// For C1: length of the first leg after the join in lengths of the last leg before it; default 1.
    pub ratio: Option<f64>,
    /// A curve that two strips share.
    pub curve: Option<String>,
    /// "fold" or "smooth" along the curve.
    pub edge: Option<EdgeKind>,
}

/// Smoothness along a ruling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Smooth {
    /// Position.
    G0,
    /// Tangent plane.
    G1,
    /// Curvature.
    G2,
    /// Direction of the control polygons' legs at a given ratio: linear.
    C1,
}

/// What a common curve is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EdgeKind {
    /// A crease of one sheet.
    Fold,
    /// No edge.
    Smooth,
}

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneRecord {
    /// A point of it.
    pub point: [f64; 3],
    /// Its normal.
    pub normal: [f64; 3],
}

/// What is held; one of the three.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandleRecord {
    /// Name of the curve.
    pub curve: String,
    /// Parameter on the scale of its knots.
    pub u: f64,
    /// A place.
    pub point: Option<[f64; 3]>,
    /// A direction.
    pub tangent: Option<[f64; 3]>,
    /// A plane.
    pub plane: Option<PlaneRecord>,
    /// Weight of a handle that gives way; default none: it holds exactly.
    pub pull: Option<f64>,
}

/// A place on a curve.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceRecord {
    /// Name of the curve.
    pub curve: String,
    /// Parameter.
    pub u: f64,
}

/// A distance that is kept.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LengthRecord {
    /// Between these places.
    pub between: [PlaceRecord; 2],
    /// Its value.
    pub length: f64,
}

/// A surface to be near: a file, or points with triangles.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TargetRecord {
    /// Name of a STEP file or a file of points, beside the job.
    pub file: Option<String>,
    /// Points.
    #[serde(default)]
    pub points: Vec<[f64; 3]>,
    /// Corners of triangles.
    #[serde(default)]
    pub triangles: Vec<[u32; 3]>,
    /// Names of the strips; default all.
    #[serde(default)]
    pub strips: Vec<String>,
    /// Weight; default 0.3.
    #[serde(default = "default_weight")]
    pub weight: f64,
    /// Distance allowed between strips and target; default the tolerance of the job.
    pub within: Option<f64>,
    /// Whether all of the target must be near the strips, too; default true.
    #[serde(default = "default_covered")]
    pub covered: bool,
}

fn default_covered() -> bool {
    true
}

fn default_weight() -> f64 {
    0.3
}

/// A move of a handle in steps.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MoveRecord {
    /// Index of the handle.
    pub handle: usize,
    /// Where a point handle goes.
    pub point: Option<[f64; 3]>,
    /// Where a tangent handle turns.
    pub tangent: Option<[f64; 3]>,
    /// Where a plane handle goes.
    pub plane: Option<PlaneRecord>,
    /// Number of steps; default 8.
    #[serde(default = "default_steps")]
    pub steps: usize,
}

fn default_steps() -> usize {
    8
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveRecord {
    name: String,
    #[serde(default)]
    fixed: bool,
    degree: Option<usize>,
    knots: Option<Vec<f64>>,
    points: Option<Vec<[f64; 3]>>,
    through: Option<Vec<[f64; 3]>>,
    spans: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    unit: Option<String>,
    #[serde(default)]
    curves: Vec<Value>,
    #[serde(default)]
    strips: Vec<Value>,
    #[serde(default)]
    from: Vec<Value>,
    #[serde(default)]
    facets: Vec<Value>,
    #[serde(default)]
    joins: Vec<Value>,
    #[serde(default)]
    handles: Vec<Value>,
    #[serde(default)]
    lengths: Vec<Value>,
    #[serde(default)]
    targets: Vec<Value>,
    #[serde(default)]
    moves: Vec<Value>,
}

/// Why there is no job in a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name}: {path}: {reason}")]
pub struct ShapeFileError {
    /// Name of the file.
    pub name: String,
    /// Place in the file.
    pub path: String,
    /// What is wrong, and what would help.
    pub reason: String,
}

/// Degrees of curves through points, with the multiplicity of their inner knots: enough control points for developability.
const DEGREES: [(usize, usize); 3] = [(2, 1), (3, 2), (5, 3)];
/// Most spans of a curve through points.
const MOST_SPANS: usize = 1000;
/// Samples per span where a curve through points is laid on its knots.
const SAMPLES: usize = 12;
/// Most steps of a move: more than an hour of dragging.
const MOST_STEPS: usize = 10_000;

/// Reads a job. `given` is the length of the file's unit (mm) where the file does not say.
///
/// # Errors
/// See [`ShapeFileError`].
pub fn read(bytes: &[u8], name: &str, given: Option<f64>) -> Result<ShapeFile, ShapeFileError> {
    let fail = |path: &str, reason: String| ShapeFileError { name: name.into(), path: path.into(), reason };
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let record: Record =
        serde_json::from_slice(text).map_err(|e| fail("$", format!("it is no job for shapes: {e}")))?;
    let Some(scale) = unit::agreed(record.unit.as_deref(), given) else {
        return Err(fail("$.unit", "it must be mm, cm, m, in or ft, and agree with the unit given".into()));
    };
    let mut out = ShapeFile { unit: scale, ..ShapeFile::default() };
    for (k, c) in items::<CurveRecord>(record.curves, "curves").map_err(|(p, r)| fail(&p, r))?.into_iter().enumerate() {
        let curve = curve(&c, scale).map_err(|(field, reason)| fail(&format!("$.curves[{k}].{field}"), reason))?;
        out.curves.push((c.name, curve, c.fixed));
    }
    let at = |(p, r): (String, String)| fail(&p, r);
    out.strips = items(record.strips, "strips").map_err(at)?;
    out.from = items(record.from, "from").map_err(at)?;
    out.facets = items(record.facets, "facets").map_err(at)?;
    out.joins = items(record.joins, "joins").map_err(at)?;
    out.handles = items(record.handles, "handles").map_err(at)?;
    out.lengths = items(record.lengths, "lengths").map_err(at)?;
    out.targets = items(record.targets, "targets").map_err(at)?;
    out.moves = items(record.moves, "moves").map_err(at)?;
    scaled(&mut out, scale);
    said_once(&out).map_err(at)?;
    Ok(out)
}

/// All items of a list, or the path of the first that is none.
fn items<T: serde::de::DeserializeOwned>(values: Vec<Value>, list: &str) -> Result<Vec<T>, (String, String)> {
    let read = |(k, v)| serde_json::from_value(v).map_err(|e| (format!("$.{list}[{k}]"), e.to_string()));
    values.into_iter().enumerate().map(read).collect()
}

fn scaled(file: &mut ShapeFile, scale: f64) {
    let vector = |v: &mut [f64; 3]| v.iter_mut().for_each(|x| *x *= scale);
    for h in &mut file.handles {
        h.point.iter_mut().for_each(vector);
        h.plane.iter_mut().for_each(|p| vector(&mut p.point));
    }
    for m in &mut file.moves {
        m.point.iter_mut().for_each(vector);
        m.plane.iter_mut().for_each(|p| vector(&mut p.point));
    }
    for t in &mut file.targets {
        t.points.iter_mut().for_each(vector);
        t.within.iter_mut().for_each(|w| *w *= scale);
    }
    file.lengths.iter_mut().for_each(|l| l.length *= scale);
}

/// Of things that exclude each other, one must be given.
fn said_once(file: &ShapeFile) -> Result<(), (String, String)> {
    let one = "give one of point, tangent and plane";
    for (k, h) in file.handles.iter().enumerate() {
        if [h.point.is_some(), h.tangent.is_some(), h.plane.is_some()].iter().filter(|g| **g).count() != 1 {
            return Err((format!("$.handles[{k}]"), one.into()));
        }
    }
    for (k, m) in file.moves.iter().enumerate() {
        if [m.point.is_some(), m.tangent.is_some(), m.plane.is_some()].iter().filter(|g| **g).count() != 1 {
            return Err((format!("$.moves[{k}]"), one.into()));
        }
        if m.handle >= file.handles.len() {
            let reason = format!("there is no handle {} (they count from 0)", m.handle);
            return Err((format!("$.moves[{k}].handle"), reason));
        }
        if m.steps == 0 || m.steps > MOST_STEPS {
            return Err((format!("$.moves[{k}].steps"), format!("it must be 1 to {MOST_STEPS}, not {}", m.steps)));
        }
    }
    strips_said_once(file)?;
    for (k, j) in file.joins.iter().enumerate() {
        let right = match (&j.ruling, &j.ends, &j.curve) {
            (Some(_), None, None) | (None, Some(_), None) => j.edge.is_none(),
            (None, None, Some(_)) => j.edge.is_some() && j.smoothness.is_none(),
            _ => false,
        };
        if !right {
            let reason = "give \"ruling\" or \"ends\" with \"smoothness\", or \"curve\" with \"edge\"".into();
            return Err((format!("$.joins[{k}]"), reason));
        }
        if j.ratio.is_some() && j.smoothness != Some(Smooth::C1) {
            return Err((format!("$.joins[{k}].ratio"), "only \"smoothness\": \"C1\" has a ratio".into()));
        }
    }
    for (k, t) in file.targets.iter().enumerate() {
        if t.file.is_some() != t.points.is_empty() {
            return Err((format!("$.targets[{k}]"), "give \"file\" or \"points\"".into()));
        }
        if let Some(w) = t.within.filter(|w| !(*w > 0.0 && w.is_finite())) {
            return Err((format!("$.targets[{k}].within"), format!("it must be a positive length, not {w}")));
        }
    }
    Ok(())
}

/// The same of strips, whether described or taken from files.
fn strips_said_once(file: &ShapeFile) -> Result<(), (String, String)> {
    if let Some(k) = file.strips.iter().position(|s| s.planar && s.ruled) {
        return Err((format!("$.strips[{k}]"), "a strip is \"planar\" or \"ruled\", not both".into()));
    }
    for (k, f) in file.from.iter().enumerate() {
        if f.panels.is_some() == f.loft.is_some() {
            return Err((format!("$.from[{k}]"), "give \"panels\" or \"loft\"".into()));
        }
        knots(f.degree, f.spans).map_err(|(field, reason)| (format!("$.from[{k}].{field}"), reason))?;
    }
    Ok(())
}

/// The curve of a record, or the field that is wrong and why.
fn curve(c: &CurveRecord, scale: f64) -> Result<Curve<3>, (&'static str, String)> {
    let place = |p: &[f64; 3]| p.map(|x| x * scale);
    match (&c.points, &c.through) {
        (Some(points), None) => {
            let Some(knots) = &c.knots else { return Err(("knots", "control points need knots".into())) };
            let degree = c.degree.ok_or(("degree", "control points need a degree".to_string()))?;
            Curve::new(degree, knots.clone(), points.iter().map(place).collect()).map_err(|e| ("points", e.to_string()))
        }
        (None, Some(points)) => {
            let spans = c.spans.unwrap_or_else(default_spans);
            let knots = knots(c.degree.unwrap_or_else(default_degree), spans)?;
            if c.knots.is_some() {
                return Err(("knots", "curves through points have knots of their own".into()));
            }
            if points.len() < 2 {
                return Err(("through", "give at least two points".into()));
            }
            let points: Vec<Vec3> = points.iter().map(|p| Vec3::from(place(p))).collect();
            through::on_knots(&points, &knots, SAMPLES * spans).map_err(|e| ("through", e.to_string()))
        }
        _ => Err(("points", "give \"points\" with \"knots\", or \"through\"".into())),
    }
}

/// Clamped knots over [0, 1] with so many equal pieces and inner knots repeated as often as developability needs; or the
/// field that is wrong and why.
pub(crate) fn knots(degree: usize, spans: usize) -> Result<Knots, (&'static str, String)> {
    let Some((_, multiplicity)) = DEGREES.iter().find(|d| d.0 == degree) else {
        return Err(("degree", format!("curves through points have degree 2, 3 or 5, not {degree}")));
    };
    if spans == 0 || spans > MOST_SPANS {
        return Err(("spans", format!("it must be 1 to {MOST_SPANS}, not {spans}")));
    }
    let mut values = vec![0.0; degree + 1];
    (1..spans).for_each(|i| values.extend(std::iter::repeat_n(i as f64 / spans as f64, *multiplicity)));
    values.extend(vec![1.0; degree + 1]);
    let control = values.len() - degree - 1;
    Knots::new(degree, values, control).map_err(|e| ("spans", e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOB: &str = r#"{ "unit": "cm",
        "curves": [
            { "name": "a", "through": [[0, 0, 0], [5, 0, 1], [10, 0, 0]], "spans": 4 },
            { "name": "b", "degree": 1, "knots": [0, 0, 1, 1], "points": [[0, 5, 0], [10, 5, 0]], "fixed": true } ],
        "strips": [ { "name": "s", "sides": ["a", "b"] } ],
        "joins": [ { "ruling": ["s", "s"], "smoothness": "G2" } ],
        "handles": [ { "curve": "a", "u": 0.5, "point": [5, 0, 2] } ],
        "lengths": [ { "between": [ { "curve": "a", "u": 0 }, { "curve": "b", "u": 1 } ], "length": 11 } ],
        "moves": [ { "handle": 0, "point": [5, 0, 3] } ] }"#;

    #[test]
    fn a_job_is_read_in_millimetres() {
        let job = read(JOB.as_bytes(), "job", None).expect("a job");
        let (name, a, fixed) = &job.curves[0];
        assert!(name == "a" && !fixed && a.control.len() == 4 + 3 * 2);
        assert!((Vec3::from(a.point(0.5)) - Vec3::new(50.0, 0.0, 10.0)).norm() < 0.01);
        assert_eq!(job.curves[1].1.control, [[0.0, 50.0, 0.0], [100.0, 50.0, 0.0]]);
        assert_eq!((job.handles[0].point, job.moves[0].point), (Some([50.0, 0.0, 20.0]), Some([50.0, 0.0, 30.0])));
        assert_eq!(job.unit, 10.0);
        assert_eq!((job.lengths[0].length, job.moves[0].steps), (110.0, 8));
    }

    #[test]
    fn what_is_no_job_is_refused_with_its_place() {
        let told = |from: &str, to: &str| {
            assert!(JOB.contains(from), "{from}");
            read(JOB.replace(from, to).as_bytes(), "job", None).expect_err(to).to_string()
        };
        assert!(told("\"cm\"", "\"furlong\"").starts_with("job: $.unit: "));
        assert!(told("\"sides\"", "\"side\"").starts_with("job: $.strips[0]: unknown field `side`"));
        assert!(told("\"u\": 0.5,", "").starts_with("job: $.handles[0]: missing field `u`"));
        assert!(told("\"spans\": 4", "\"spans\": 0").starts_with("job: $.curves[0].spans: "));
        assert!(told("\"spans\": 4", "\"degree\": 4").starts_with("job: $.curves[0].degree: "));
        assert!(told("[0, 0, 1, 1]", "[0, 0, 1]").starts_with("job: $.curves[1].points: "));
        assert!(told("\"handle\": 0", "\"handle\": 3").starts_with("job: $.moves[0].handle: there is no handle 3"));
        assert!(told("\"point\": [5, 0, 2]", "\"pull\": 1").starts_with("job: $.handles[0]: give one of"));
        assert!(told("\"smoothness\": \"G2\"", "\"edge\": \"fold\"").starts_with("job: $.joins[0]: give "));
        assert!(told("\"G2\"", "\"G2\", \"ratio\": 2").starts_with("job: $.joins[0].ratio: only "));
        let both = "\"b\"], \"ruled\": true, \"planar\": true } ]";
        assert!(told("\"b\"] } ]", both).starts_with("job: $.strips[0]: a strip is "));
        let from = |x: &str| format!("\"from\": [ {{ {x} }} ], \"moves\"");
        assert!(told("\"moves\"", &from("\"spans\": 3")).starts_with("job: $.from[0]: give \"panels\" or"));
        let m = told("\"moves\"", &from("\"panels\": \"p.step\", \"degree\": 4"));
        assert!(m.starts_with("job: $.from[0].degree: "), "{m}");
        let target = "\"targets\": [ { \"file\": \"a.ply\", \"within\": 0 } ], \"moves\"";
        assert!(told("\"moves\"", target).starts_with("job: $.targets[0].within: "));
        assert!(
            told("\"through\": [[0, 0, 0], [5, 0, 1], [10, 0, 0]]", "\"through\": []").contains("at least two points")
        );
        assert!(told("\"strips\"", "\"stripes\"").starts_with("job: $: "));
    }
}
