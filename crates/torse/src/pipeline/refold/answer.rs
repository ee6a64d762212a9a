//! The answer of `torse refold`: what it claims, and itself as data and files.

use crate::certify::claim::{Claim, Status, Subject, UpperBound, What};
use crate::develop::refold::compare::Comparison;
use crate::develop::refold::drawn::FlatPart;
use crate::develop::refold::leaf::Refolded;
use crate::develop::refold::mesh::mesh;
use crate::draw::scene::{PanelShape, Scene};
use crate::geom::placement::Placement;
use crate::io::glb;
use crate::io::refold_report::{RefoldPanel, RefoldPart, RefoldReport, SCHEMA};
use crate::io::result_folder::ResultFolder;
use crate::io::words;
use crate::num::parallel;
use crate::reason::{Item, Reason};
use crate::search::refolded::NotRefolded;

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

/// The largest of what is proven of the panels of a part; the reason where that is not known of all.
pub(super) fn largest(panels: &[(String, Result<UpperBound, NotRefolded>)]) -> Result<UpperBound, NotRefolded> {
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
        let left = self.left.iter().map(|(name, why)| {
            Claim::left_out(Reason::of(Item::Part(name.clone()), Reason::error(&NotRefolded::Panels(why.clone()))))
        });
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
