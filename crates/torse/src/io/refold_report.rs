//! The answer of `torse refold` for people and as data: `refold.json`.

use super::words::{
    self,
    numbers::{length, length_bound},
};
use crate::certify::claim::{Status, UpperBound};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Name and version of the format.
pub const SCHEMA: &str = "torse-refold/5";

/// The whole answer. Lengths in mm, angles in degrees. What is called a bound is proven, what is
/// called an estimate is measured at samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefoldReport {
    /// [`SCHEMA`].
    pub schema: String,
    /// `certified` if every part was bent back and is proven to lie within the tolerance, else `uncertified`.
    pub status: String,
    /// The command that made the result.
    pub job: String,
    /// Its input.
    pub input: String,
    /// Distance within which parts are to lie from their panels: twice the tolerance of the result, or what was asked for.
    pub tolerance: f64,
    /// Parts.
    pub parts: Vec<RefoldPart>,
    /// Parts that could not be bent back or compared, with the reason.
    pub left: Vec<[String; 2]>,
    /// What was noticed.
    pub notes: Vec<String>,
}

/// One part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefoldPart {
    /// Name.
    pub name: String,
    /// Whether `distance_bound` is within the tolerance.
    pub certified: bool,
    /// How the turn between the bend lines was found.
    pub method: String,
    /// Bend lines.
    pub lines: usize,
    /// Largest distance of a sample from the place where it belongs, after the best rigid motion.
    pub matched_estimate: f64,
    /// Root mean square of these distances.
    pub matched_mean_estimate: f64,
    /// Largest distance of a sample of either surface from the other surface.
    pub distance_estimate: f64,
    /// Bound of the distance between the part bent back and the part in space, both ways and with their edges, proven: the
    /// largest of its panels; null if it was not shown for all of them.
    pub distance_bound: Option<f64>,
    /// Why not; empty where there is one.
    pub not_proven: String,
    /// What is proven of its panels, one by one.
    pub panels: Vec<RefoldPanel>,
    /// `distance_bound` with the digits that the tables print, without the numbers of `report.json`; null if none was shown.
    pub printed_bound: Option<f64>,
    /// `matched_estimate` with the digits that the tables print, without the numbers of `report.json`; null if not known.
    pub printed_estimate: Option<f64>,
    /// Largest difference between the angles of the table and what its radii give.
    pub disagreement_deg: f64,
    /// Distance between the corners of the panels laid flat and those of the outline as drawn.
    pub alignment: f64,
    /// How far the neutral fibre, which is drawn, lies at most from panels that were given a sheet; 0 for others. What is bent back and
    /// compared is their surface, as far from the fibre of the bent sheet.
    pub beside: f64,
    /// Place on the drawing of the sample farthest from where it belongs.
    pub worst: [f64; 2],
    /// Samples compared.
    pub samples: usize,
}

/// What is proven of one panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefoldPanel {
    /// Name.
    pub name: String,
    /// Bound of the distance between it and what belongs to it of the part bent back, both ways and with the edges, proven; null
    /// if none was shown.
    pub distance_bound: Option<f64>,
    /// Why not; empty where there is one.
    pub not_proven: String,
}

impl RefoldPanel {
    /// A panel with its bound (mm), or why there is none.
    pub(crate) fn new(name: &str, found: &Result<UpperBound, impl std::fmt::Display>) -> Self {
        let not_proven = found.as_ref().err().map_or_else(String::new, |e| e.to_string());
        Self { name: name.to_owned(), distance_bound: found.as_ref().ok().map(|b| b.value()), not_proven }
    }
}

impl RefoldPart {
    /// Whether some place of it is farther from its part in space than a tolerance (mm), as measured: what is proven is an upper
    /// bound, often far above it.
    fn is_beyond(&self, tolerance: f64) -> bool {
        self.distance_estimate > tolerance
    }
}

impl RefoldReport {
    /// Notes that a part is missing from one of the files; `reason` names it.
    pub(crate) fn note_missing(&mut self, file: &str, reason: &str) {
        self.notes.push(format!("not in {file}: {reason}"));
    }

    /// The report as JSON.
    ///
    /// # Errors
    /// Numbers that JSON cannot hold are written as null; nothing else can fail.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|s| s + "\n")
    }

    /// A few lines for the terminal.
    pub fn words(&self) -> String {
        let panels = || self.parts.iter().flat_map(|p| &p.panels);
        let proven = panels().filter(|p| p.distance_bound.is_some()).count();
        let mut out = format!(
            "{}{} of {} parts bent back; {proven} of {} panels within a proven distance, the others measured\n",
            if self.status == words::status(Status::Certified) { "certified: " } else { "NOT CERTIFIED: " },
            self.parts.len(),
            self.parts.len() + self.left.len(),
            panels().count(),
        );
        for p in &self.parts {
            let printed = |x: Option<f64>, told: fn(f64) -> String| x.map_or_else(|| "unknown".into(), told);
            // Writing to a string cannot fail.
            _ = match p.distance_bound {
                Some(bound) => writeln!(
                    out,
                    "  {}: part and panels within {} of each other, edges too (proven; {} by the printed digits); measured {}",
                    p.name,
                    length_bound(bound),
                    printed(p.printed_bound, length_bound),
                    length(p.distance_estimate),
                ),
                None => writeln!(
                    out,
                    "  {}: within {} of the part, every point within {} of where it belongs ({} by the printed digits); \
                     measured at samples, not proven: {}",
                    p.name,
                    length(p.distance_estimate),
                    length(p.matched_estimate),
                    printed(p.printed_estimate, length),
                    p.not_proven,
                ),
            };
            for panel in p.panels.iter().filter(|_| p.panels.len() > 1) {
                _ = match panel.distance_bound {
                    Some(bound) => {
                        writeln!(out, "    panel {}: within {} (proven)", panel.name, length_bound(bound))
                    }
                    None => writeln!(out, "    panel {}: not proven: {}", panel.name, panel.not_proven),
                };
            }
        }
        let fibres: Vec<&RefoldPart> = self.parts.iter().filter(|p| p.beside > 0.0).collect();
        if !fibres.is_empty() {
            let most = fibres.iter().map(|p| p.beside).fold(0.0, f64::max);
            _ = writeln!(
                out,
                "  drawn is the neutral fibre, up to {} from the panels that were given a sheet: {}. What is compared of the sheet bent back \
                 is the surface of the panels, as far from its fibre",
                length(most),
                fibres.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", "),
            );
        }
        let beyond: Vec<&str> =
            self.parts.iter().filter(|p| p.is_beyond(self.tolerance)).map(|p| p.name.as_str()).collect();
        if !beyond.is_empty() {
            _ = writeln!(
                out,
                "  beyond the tolerance, {}: {}. If no file was changed, the parts may still be right: between the lines that \
                 are drawn the turn of the sheet is not in the files. More lines (--bend-step) bring them nearer.",
                length(self.tolerance),
                beyond.join(", "),
            );
        }
        let open = |p: &&RefoldPart| !p.certified && !p.is_beyond(self.tolerance);
        let open: Vec<&str> = self.parts.iter().filter(open).map(|p| p.name.as_str()).collect();
        if !open.is_empty() {
            _ = writeln!(
                out,
                "  not proven to lie within {} of their panels with their edges: {}",
                length(self.tolerance),
                open.join(", "),
            );
        }
        for [name, reason] in &self.left {
            _ = writeln!(out, "  left out: {name}: {reason}");
        }
        for note in &self.notes {
            _ = writeln!(out, "  note: {note}");
        }
        out
    }
}
