//! Strips that a job takes from other files: panels of an earlier result, and lofts between two curves.

use super::options::ShapeError;
use crate::control::Control;
use crate::design::composite::{BoundaryCurve, Join, RuledStrip, Smoothness, StripShape};
use crate::geom::Vec3;
use crate::io::curves::{self, CurveOptions};
use crate::io::shape::{knots, FromRecord, ShapeFile};
use crate::io::step;
use crate::patchwork::written::{WrittenBase, WrittenCourse, WrittenStrip};
use crate::pipeline::loft;
use crate::spline::curve::Curve;
use crate::spline::lsq;
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;

/// Samples per piece where a strip is laid on splines.
const SAMPLES: usize = 16;
/// Rulings that differ by less than this share of the size are one.
const SAME: f64 = 1e-6;
/// Cosine of the angle below which strips with a common ruling go on smoothly: half a degree, as where faces are read.
const SMOOTH: f64 = 0.999_961_9;

/// What a job takes from other files.
#[derive(Debug, Default)]
pub(super) struct Given {
    pub curves: Vec<BoundaryCurve>,
    pub strips: Vec<RuledStrip>,
    pub joins: Vec<Join>,
}

/// Both sides of a strip by places at equal shares, ready to be laid on splines.
struct Sides {
    name: String,
    sides: [Vec<[f64; 3]>; 2],
}

/// Reads and lays on splines what a job takes from other files; `tolerance` (mm) is that of lofts.
pub(super) fn given(
    job: &ShapeFile,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    tolerance: f64,
) -> Result<Given, ShapeError> {
    let mut out = Given::default();
    for (index, record) in job.from.iter().enumerate() {
        let wrong = |reason: String| ShapeError::From { index, reason };
        let sides = match (&record.panels, &record.loft) {
            (Some(file), _) => panels(file, record, load),
            (_, Some(files)) => rails_of(files, job.unit, load).and_then(|r| lofted(&r, record, tolerance, index)),
            _ => Ok(Vec::new()),
        };
        out.add(&sides.map_err(wrong)?, record).map_err(wrong)?;
    }
    Ok(out)
}

/// Number of samples of a side.
fn count(record: &FromRecord) -> usize {
    SAMPLES * record.spans
}

/// Panels of an earlier result.
fn panels(
    file: &str,
    record: &FromRecord,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<Sides>, String> {
    let help = "give the panels.step that torse wrote for a loft, a hull, a fit or a shape";
    let all = step::read::own::strips(&load(file)?).map_err(|e| format!("{file}: {e}; {help}"))?;
    if let Some(name) = record.names.iter().find(|n| !all.iter().any(|s| s.name == **n)) {
        let there: Vec<&str> = all.iter().take(6).map(|s| &s.name[..]).collect();
        return Err(format!("{file} has no panel '{name}'; it has {}", there.join(", ")));
    }
    let wanted = |s: &&WrittenStrip| record.names.is_empty() || record.names.contains(&s.name);
    let made = |s: &WrittenStrip| {
        let sides = rails(s).ok_or_else(|| format!("{file}: panel {} has no two rails; {help}", s.name))?;
        Ok(Sides { name: s.name.clone(), sides: sides.map(|c| sampled(&c, count(record))) })
    };
    all.iter().filter(wanted).map(made).collect()
}

/// Both rails of a strip as its file holds them, homogeneous.
fn rails(s: &WrittenStrip) -> Option<[Curve<4>; 2]> {
    match &s.surface {
        WrittenBase::Spline(surface) => {
            let [u, v] = &surface.knots;
            if v.degree() != 1 || v.control_count() != 2 || surface.points.len() != 2 * u.control_count() {
                return None;
            }
            let weight = |k: usize| surface.weights.get(k).copied().unwrap_or(1.0);
            let side = |j: usize| {
                let at = |i: usize| {
                    let ([x, y, z], w) = (surface.points[2 * i + j], weight(2 * i + j));
                    [x * w, y * w, z * w, w]
                };
                Curve { knots: u.clone(), control: (0..u.control_count()).map(at).collect() }
            };
            Some([side(0), side(1)])
        }
        // A plane has its rails as edges: the first, and the one before the last, which runs back.
        WrittenBase::Plane { .. } => {
            let along = |k: usize| match &s.sides.get(k)?.course {
                WrittenCourse::Spline { curve, weights } => {
                    let weight = |i: usize| weights.get(i).copied().unwrap_or(1.0);
                    let lifted = curve.control.iter().enumerate().map(|(i, p)| {
                        let w = weight(i);
                        [p[0] * w, p[1] * w, p[2] * w, w]
                    });
                    Some(Curve { knots: curve.knots.clone(), control: lifted.collect() })
                }
                WrittenCourse::Line { .. } => {
                    let [p, q] = s.sides[k].vertices;
                    let ends = [p, q].map(|p| [p[0], p[1], p[2], 1.0]);
                    Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends.to_vec()).ok()
                }
                WrittenCourse::Circle { .. } => None,
            };
            if s.sides.len() == 3 {
                // A triangle: its second rail is a point.
                let first = along(0)?;
                let tip = s.sides[1].vertices[if s.sides[1].forward { 1 } else { 0 }];
                let point = [tip[0], tip[1], tip[2], 1.0];
                let second = Curve { control: vec![point; first.control.len()], knots: first.knots.clone() };
                return Some([first, second]);
            }
            Some([along(0)?, along(2)?])
        }
        _ => None,
    }
}

/// Places of a homogeneous curve at equal shares of its parameters.
fn sampled(c: &Curve<4>, count: usize) -> Vec<[f64; 3]> {
    let (a, b) = c.domain();
    let at = |k: usize| {
        let h = c.point(a + (b - a) * k as f64 / count as f64);
        [h[0] / h[3], h[1] / h[3], h[2] / h[3]]
    };
    (0..=count).map(at).collect()
}

/// The rails of a loft from their files; `unit` (mm) is that of files that do not say theirs.
fn rails_of(
    files: &[String; 2],
    unit: f64,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<[Rail; 2], String> {
    let rail = |text: &String| {
        let (file, select) = text.rsplit_once('#').unwrap_or((text, ""));
        let options = CurveOptions { name: text.clone(), select: select.into(), unit: Some(unit), polyline: false };
        let bytes = load(file)?;
        // A unit of the file's own must not be contradicted.
        let given = curves::read(&bytes, &CurveOptions { unit: None, ..options.clone() });
        let read = match given {
            Err(curves::CurveError::NoUnit(_)) => curves::read(&bytes, &options),
            other => other,
        };
        read.map(|r| r.0).map_err(|e| e.to_string())
    };
    Ok([rail(&files[0])?, rail(&files[1])?])
}

/// The strips of a loft, one after the other.
fn lofted([a, b]: &[Rail; 2], record: &FromRecord, tolerance: f64, index: usize) -> Result<Vec<Sides>, String> {
    // Fans at the ends have a side that is a point, on which nobody can pull.
    let options = loft::Options { ends: loft::Ends::Trim, ..loft::Options::new(tolerance) };
    let made = loft::loft(a, b, &options, &Control::default()).map_err(|e| e.to_string())?;
    let of = |(k, strip): (usize, &Strip)| {
        let name = format!("L{}-{}", index + 1, k + 1);
        Sides { name, sides: [0, 1].map(|side: usize| sampled(&strip.rail(side), count(record))) }
    };
    Ok(made.strips().enumerate().map(of).collect())
}

impl Given {
    /// Lays strips on splines; curves that are shared become one, and strips that follow each other are joined.
    fn add(&mut self, all: &[Sides], record: &FromRecord) -> Result<(), String> {
        let knots = knots(record.degree, record.spans).map_err(|e| e.1)?;
        let count = count(record);
        let parameters: Vec<f64> = (0..=count).map(|k| k as f64 / count as f64).collect();
        let points: Vec<Vec3> = all.iter().flat_map(|s| s.sides.iter().flatten()).map(|p| Vec3::from(*p)).collect();
        let near = SAME * crate::geom::BBox::of(&points).diagonal();
        let mut known: Vec<(String, &Vec<[f64; 3]>)> = Vec::new();
        for strip in all {
            if strip.sides.iter().any(|s| s.iter().all(|p| (Vec3::from(*p) - Vec3::from(s[0])).norm() <= near)) {
                return Err(format!(
                    "{} ends in a point on one side, on which nobody can pull; take other panels by \"names\", or loft \
                     with --ends trim",
                    strip.name
                ));
            }
            let mut names: [String; 2] = Default::default();
            for (side, places) in strip.sides.iter().enumerate() {
                if let Some((name, _)) = known.iter().find(|(_, other)| same(other, places, near)) {
                    names[side].clone_from(name);
                    continue;
                }
                let name = format!("{}/{side}", strip.name);
                let curve = lsq::fit(places, &parameters, &knots).map_err(|e| e.to_string())?.curve;
                self.curves.push(BoundaryCurve { name: name.clone(), curve, fixed: false });
                known.push((name.clone(), places));
                names[side] = name;
            }
            self.strips.push(RuledStrip {
                name: strip.name.clone(),
                sides: names,
                shape: StripShape::Developable { margin: 0.0 },
            });
        }
        for w in all.windows(2) {
            let (before, after) = (&w[0].sides, &w[1].sides);
            let meet = (0..2).all(|s| (end(&before[s], 0) - end(&after[s], count)).norm() <= near);
            if meet && w[0].name != w[1].name {
                let smoothness = if smooth(before, after) { Smoothness::G1 } else { Smoothness::G0 };
                let [first, second] = [&w[0], &w[1]].map(|s| s.name.clone());
                self.joins.push(Join::Ruling { first, second, smoothness });
            }
        }
        Ok(())
    }
}

/// The place so many samples before the last one.
fn end(places: &[[f64; 3]], before: usize) -> Vec3 {
    Vec3::from(places[places.len() - 1 - before])
}

fn same(a: &[[f64; 3]], b: &[[f64; 3]], near: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(p, q)| (Vec3::from(*p) - Vec3::from(*q)).norm() <= near)
}

/// Whether tangent planes agree at a common ruling, by the samples beside it.
fn smooth(before: &[Vec<[f64; 3]>; 2], after: &[Vec<[f64; 3]>; 2]) -> bool {
    let count = after[0].len() - 1;
    let ruling = end(&before[1], 0) - end(&before[0], 0);
    let middle = |s: &[Vec<[f64; 3]>; 2], k: usize| 0.5 * (end(&s[0], k) + end(&s[1], k));
    let normal = |way: Vec3| way.cross(&ruling).try_normalize(0.0);
    let (n, m) =
        (normal(middle(before, 0) - middle(before, 1)), normal(middle(after, count - 1) - middle(after, count)));
    matches!((n, m), (Some(n), Some(m)) if n.dot(&m) >= SMOOTH)
}
