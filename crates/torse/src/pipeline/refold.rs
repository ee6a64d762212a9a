//! The job of `torse refold`: a result read back, bent back, and compared with the part in space; how far it is from
//! that is proven where it can be.

use super::part_atlas::{atlases, beside_panels, flat_part, panels, read_bound, refolded};
use crate::certify::claim::{Claim, Status, Subject, UpperBound, What};
use crate::control::Control;
use crate::develop::refold::atlas::Atlas;
use crate::develop::refold::compare::{best, compare, Comparison};
use crate::develop::refold::drawn::FlatPart;
use crate::develop::refold::leaf::Refolded;
use crate::develop::refold::mesh::mesh;
use crate::draw::scene::{PanelShape, Scene};
use crate::geom::placement::Placement;
use crate::io::glb;
use crate::io::refold_report::{RefoldPanel, RefoldPart, RefoldReport, SCHEMA};
use crate::io::result_folder::{read, FolderError, ResultFolder, ResultPart};
use crate::io::words;
use crate::num::parallel;
use crate::reason::{Item, Reason};
use crate::search::refolded::{distance_bounds, NotRefolded, PanelBound};
/// Names of the files of the job.
pub const FILES: [&str; 2] = ["refold.json", "refolded.glb"];

/// A part that was bent back.
#[derive(Clone, Debug)]
pub struct PartAnswer {
    /// Name.
    pub name: String,
    /// The drawing.
    pub flat: FlatPart,
    /// The part bent back, where the drawing has its origin.
    pub refolded: Refolded,
    /// Against the panels; the reason where that could not be.
    pub compared: Result<Comparison, NotRefolded>,
    /// The same from the printed digits of the tables alone.
    pub printed: Option<Comparison>,
    /// For every panel its name, and a bound of the distance (mm) between it and what belongs to it, both ways and with the edges;
    /// the reason where none was shown.
    pub proven: Vec<(String, Result<UpperBound, NotRefolded>)>,
    /// The same from the printed digits of the tables alone.
    pub printed_proven: Option<UpperBound>,
    /// Distance of the panels' corners from the outline drawn, mm.
    pub alignment: f64,
    /// How far the neutral fibre, which is drawn, lies at most from panels that were given a sheet, mm; 0 for others.
    pub beside: f64,
}

/// The answer.
#[derive(Clone, Debug)]
pub struct RefoldAnswer {
    /// Distance (mm) within which every part bent back is to lie from its panels.
    pub tolerance: f64,
    /// What was read.
    pub folder: ResultFolder,
    /// Parts bent back.
    pub parts: Vec<PartAnswer>,
    /// Parts that could not be, with the reason.
    pub left: Vec<(String, String)>,
    /// What was noticed.
    pub notes: Vec<String>,
}

/// Bends all parts of a result back. `file` answers the bytes of its files by name; `tolerance` (mm, positive; default that of the
/// result) is within what they are to lie from their panels. Parts whose turn comes after the control said
/// stop are left out, and of those under way nothing more is proven.
///
/// # Errors
/// See [`FolderError`]; what concerns single parts stands in the answer.
///
/// # Example
/// ```
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let mut answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// let file = |name: &str| files.iter().find(|f| f.0 == name).map(|f| f.1.clone());
/// let back = torse::pipeline::refold::refold(&file, None, &torse::Control::default())?;
/// assert_eq!((back.parts.len(), back.left.len()), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refold(
    file: &(dyn Fn(&str) -> Option<Vec<u8>> + Sync),
    tolerance: Option<f64>,
    control: &Control,
) -> Result<RefoldAnswer, FolderError> {
    let folder = read(file)?;
    let in_space = panels(file, &folder.report.job, folder.report.tolerance);
    let made: Vec<_> = parallel::map(folder.parts.iter(), |p| {
        if control.stopped() {
            return Err((p.record.name.clone(), NotRefolded::Stopped.to_string()));
        }
        let flat = flat_part(p, true);
        let back = refolded(&flat).map_err(|e| (p.record.name.clone(), e.to_string()))?;
        let found = match &in_space {
            Ok(all) => atlases(&folder, all, p, &flat),
            Err(e) => Err(e.clone()),
        };
        let aim = AIM * folder.report.tolerance;
        let read = in_space.as_ref().map_or(Some(UpperBound::UNKNOWN), |all| read_bound(all, p, aim));
        Ok(answer(p, (flat, back), found, (read, control)))
    });
    let mut left = folder.left.clone();
    let mut parts = Vec::new();
    for m in made {
        m.map_or_else(|e| left.push(e), |p| parts.push(p));
    }
    let tolerance = tolerance.unwrap_or(folder.report.tolerance);
    Ok(RefoldAnswer { tolerance, notes: folder.notes.clone(), folder, parts, left })
}

/// Share of a result's tolerance below which distances of trims are not told apart.
const AIM: f64 = 1e-4;

fn answer(
    part: &ResultPart,
    (flat, refolded): (FlatPart, Refolded),
    found: Result<Vec<Atlas>, String>,
    (read, control): (Option<UpperBound>, &Control),
) -> PartAnswer {
    let mut out = PartAnswer {
        name: part.record.name.clone(),
        compared: Err(NotRefolded::NoSample),
        printed: None,
        proven: Vec::new(),
        printed_proven: None,
        alignment: f64::NAN,
        beside: beside_panels(part),
        flat,
        refolded,
    };
    let all = match found {
        Err(e) => {
            out.compared = Err(NotRefolded::Panels(e));
            return out;
        }
        Ok(all) => all,
    };
    let Some(atlas) = best(&out.flat, &out.refolded, &all) else { return out };
    let Some(c) = compare(&out.flat, &out.refolded, atlas) else { return out };
    let bounds = |flat: &FlatPart, back: &Refolded, c: &Comparison| -> Vec<(String, Result<UpperBound, NotRefolded>)> {
        let of = |p: PanelBound| {
            let found = p.found.map(|b| read.map_or(b, |read| b.plus(read)));
            (p.name, found.and_then(|b| if b.value().is_finite() { Ok(b) } else { Err(NotRefolded::NotExact) }))
        };
        distance_bounds(flat, back, (atlas, &c.motion), control).into_iter().map(of).collect()
    };
    let printed = flat_part(part, false);
    let back = super::part_atlas::refolded(&printed).ok();
    // Of most sheet metal the digits change nothing.
    let same = back.as_ref().is_some_and(|b| b.leaves == out.refolded.leaves);
    let from_digits = || {
        let back = back.filter(|_| !same)?;
        let c = compare(&printed, &back, atlas)?;
        Some((largest(&bounds(&printed, &back, &c)).ok(), c))
    };
    let (proven, digits) = parallel::join(|| bounds(&out.flat, &out.refolded, &c), from_digits);
    let digits = if same { Some((largest(&proven).ok(), c.clone())) } else { digits };
    (out.printed_proven, out.printed) = digits.map_or((None, None), |(bound, c)| (bound, Some(c)));
    (out.alignment, out.proven, out.compared) = (atlas.alignment, proven, Ok(c));
    out
}

/// The largest of what is proven of the panels of a part; the reason where that is not known of all.
fn largest(panels: &[(String, Result<UpperBound, NotRefolded>)]) -> Result<UpperBound, NotRefolded> {
    let open: Vec<&NotRefolded> = panels.iter().filter_map(|p| p.1.as_ref().err()).collect();
    match (open.first(), panels.len()) {
        (None, 0) => Err(NotRefolded::NotCompared),
        (None, _) => Ok(UpperBound::largest(panels.iter().filter_map(|p| p.1.as_ref().ok()).copied())),
        (Some(why), 1) => Err((*why).clone()),
        (Some(_), of) => Err(NotRefolded::Open { open: open.len(), of }),
    }
}

impl RefoldAnswer {
    /// What is claimed: every part, by its index among those bent back, lies within the tolerance; and what is left
    /// out.
    pub fn claims(&self) -> Vec<Claim> {
        let of = |(k, p): (usize, &PartAnswer)| {
            let bound = p.compared.clone().and_then(|_| largest(&p.proven));
            let reason = bound.as_ref().err().map(|e| Reason::error(e));
            let bound = bound.unwrap_or(UpperBound::UNKNOWN);
            Claim::at_most(What::RefoldDistance, Subject::Part(k), bound).within(self.tolerance).because(reason)
        };
        let parts = self.parts.iter().enumerate().map(of);
        let left = self
            .left
            .iter()
            .map(|(name, why)| Claim::left_out(Reason::of(Item::Part(name.clone()), Reason::Input(why.clone()))));
        parts.chain(left).collect()
    }

    /// Certified if every part was bent back and is proven to lie within the tolerance.
    pub fn status(&self) -> Status {
        Status::of(&self.claims())
    }

    /// The answer as data.
    pub fn report(&self) -> RefoldReport {
        let broken: Vec<usize> = self
            .claims()
            .iter()
            .filter(|c| c.is_broken())
            .filter_map(|c| if let Subject::Part(k) = c.subject() { Some(k) } else { None })
            .collect();
        let mut left: Vec<[String; 2]> = self.left.iter().map(|(n, r)| [n.clone(), r.clone()]).collect();
        let mut parts = Vec::new();
        for (k, p) in self.parts.iter().enumerate() {
            match &p.compared {
                Err(reason) => left.push([p.name.clone(), format!("bent back, but not compared: {reason}")]),
                Ok(c) => parts.push(RefoldPart {
                    name: p.name.clone(),
                    method: p.refolded.method.into(),
                    lines: p.flat.lines.len(),
                    matched_estimate: c.matched_estimate,
                    matched_mean_estimate: c.matched_mean_estimate,
                    distance_estimate: c.distance_estimate,
                    certified: !broken.contains(&k),
                    distance_bound: largest(&p.proven).ok().map(UpperBound::value),
                    not_proven: largest(&p.proven).err().map_or_else(String::new, |e| e.to_string()),
                    panels: p.proven.iter().map(|(name, found)| RefoldPanel::new(name, found)).collect(),
                    printed_bound: p.printed_proven.map(UpperBound::value),
                    printed_estimate: p.printed.as_ref().map(|c| c.matched_estimate),
                    disagreement_deg: p.refolded.disagreement.to_degrees(),
                    alignment: p.alignment,
                    beside: p.beside,
                    worst: [c.worst.x, c.worst.y],
                    samples: c.samples,
                }),
            }
        }
        RefoldReport {
            schema: SCHEMA.into(),
            status: words::status(self.status()).into(),
            job: self.folder.report.job.clone(),
            input: self.folder.report.input.clone(),
            tolerance: self.tolerance,
            parts,
            left,
            notes: self.notes.clone(),
        }
    }

    /// All files of the job: report and model for viewers.
    ///
    /// # Errors
    /// In plain words: outlines that cannot be triangulated, numbers that a format cannot hold.
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>, String> {
        let shape = |p: &PartAnswer| {
            let motion = p.compared.as_ref().map_or_else(|_| Placement::identity(), |c| c.motion);
            let (mesh, borders) = mesh(&p.refolded, &motion).map_err(|e| format!("{}: {e}", p.name))?;
            Ok(PanelShape { name: p.name.clone(), mesh, rulings: Vec::new(), borders, marked: false })
        };
        let made: Vec<Result<PanelShape, String>> = parallel::map(self.parts.iter(), shape);
        let mut report = self.report();
        let mut scene = Scene::default();
        for shape in made {
            match shape {
                Ok(s) => scene.panels.push(s),
                Err(e) => report.note_missing(FILES[1], &e),
            }
        }
        let limit = self.tolerance;
        let glb = glb::write(&scene, limit).map_err(|e| e.to_string())?;
        let json = report.to_json().map_err(|e| e.to_string())?;
        let [report, model] = FILES.map(String::from);
        Ok(vec![(report, json.into_bytes()), (model, glb)])
    }
}

#[cfg(test)]
mod tests;
