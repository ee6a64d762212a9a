//! Strips that a job takes from other files: panels of an earlier result, and lofts between two curves.

use super::options::ShapeError;
use super::rails::{rails, rails_of, sampled};
use crate::answer::note::{LoftNote, Note};
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Status, What};
use crate::control::Control;
use crate::design::composite::{BoundaryCurve, Join, RuledStrip, Smoothness, StripShape};
use crate::draw::scene::untitled;
use crate::geom::Vec3;
use crate::io::shape::{knots, FromRecord, ShapeFile};
use crate::io::step;
use crate::patchwork::written::WrittenStrip;
use crate::pipeline::loft;
use crate::spline::lsq;
use crate::torse::form::PanelKind;
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
    pub taken: Taken,
}

/// What was taken over as it was, and what is to be said of it.
#[derive(Debug, Default)]
pub(super) struct Taken {
    /// The strips as faces, in the order of the strips that are made of them; `None` for one of which there is no face.
    pub faces: Vec<Option<Face>>,
    /// What stands against the status of the whole: rails that lofts cover in part.
    pub against: Vec<Claim>,
    pub notes: Vec<Note>,
    /// Names of strips that had no certificate.
    pub uncertified: Vec<String>,
}

/// Both sides of a strip by places at equal shares, ready to be laid on splines; and the strip.
struct Sides {
    name: String,
    sides: [Vec<[f64; 3]>; 2],
    face: Option<Face>,
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
            (Some(file), _) => panels(file, record, load, &mut out.taken),
            (_, Some(files)) => {
                let rails = rails_of(files, job.unit, load);
                rails.and_then(|r| lofted(&r, record, tolerance, index, &mut out.taken))
            }
            _ => Ok(Vec::new()),
        };
        let sides = sides.map_err(wrong)?;
        out.add(&sides, record).map_err(wrong)?;
        out.taken.faces.extend(sides.into_iter().map(|s| s.face));
    }
    if !out.taken.uncertified.is_empty() {
        let names = std::mem::take(&mut out.taken.uncertified);
        out.taken.notes.push(Note::TakenUncertified { names });
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
    taken: &mut Taken,
) -> Result<Vec<Sides>, String> {
    let help = "give the panels.step that torse wrote for a loft, a hull, a fit or a shape";
    let all = step::read::own::strips(&load(file)?).map_err(|e| format!("{file}: {e}; {help}"))?;
    // What files say of certificates belongs to those results, and to no name.
    let is = |s: &WrittenStrip, name: &str| untitled(&s.name).0 == untitled(name).0;
    if let Some(name) = record.names.iter().find(|n| !all.iter().any(|s| is(s, n))) {
        let there: Vec<&str> = all.iter().take(6).map(|s| untitled(&s.name).0).collect();
        return Err(format!("{file} has no panel '{name}'; it has {}", there.join(", ")));
    }
    let wanted = |s: &&WrittenStrip| record.names.is_empty() || record.names.iter().any(|n| is(s, n));
    let made = |s: &WrittenStrip| {
        let (name, uncertified) = untitled(&s.name);
        let [a, b] = rails(s).ok_or_else(|| format!("{file}: panel {name} has no two rails; {help}"))?;
        taken.uncertified.extend(uncertified.then(|| name.to_owned()));
        let face = Strip::between(name, PanelKind::Torse, &a, &b).ok().map(|s| Face::untrimmed(s.patch));
        Ok(Sides { name: name.into(), sides: [a, b].map(|c| sampled(&c, count(record))), face })
    };
    all.iter().filter(wanted).map(made).collect()
}

/// The strips of a loft, one after the other. What it covers of its rails is told as `loft` tells it.
fn lofted(
    [a, b]: &[Rail; 2],
    record: &FromRecord,
    tolerance: f64,
    index: usize,
    taken: &mut Taken,
) -> Result<Vec<Sides>, String> {
    // Fans at the ends have a side that is a point, on which nobody can pull.
    let options = loft::Options { ends: loft::Ends::Trim, ..loft::Options::new(tolerance) };
    let made = loft::loft(a, b, &options, &Control::default()).map_err(|e| e.to_string())?;
    let of = |(k, strip): (usize, &Strip)| {
        let name = format!("L{}-{}", index + 1, k + 1);
        let sides = [0, 1].map(|side: usize| sampled(&strip.rail(side), count(record)));
        Sides { name, sides, face: Some(Face::untrimmed(strip.patch.clone())) }
    };
    let sides: Vec<Sides> = made.strips().enumerate().map(of).collect();
    let (part, rest): (Vec<Claim>, Vec<Claim>) = made.claims.into_iter().partition(|c| c.what() == What::InPart);
    if Status::of(&rest) != Status::Certified {
        taken.uncertified.extend(sides.iter().map(|s| s.name.clone()));
    }
    taken.against.extend(part);
    taken.notes.extend(made.notes.into_iter().filter(|n| matches!(n, Note::Loft(LoftNote::Ends(_)))));
    Ok(sides)
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
