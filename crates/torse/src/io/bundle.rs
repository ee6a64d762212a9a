//! All files of an outcome, in memory: nothing reaches a disk before everything is made.

use super::glb::{self, GlbError};
use super::html::{self, HtmlError, Page};
use super::json::{JsonError, Report};
use super::png::{self, PngError};
use super::step::write::{self as step, Header};
use super::{bends, dxf, marks, svg};
use crate::answer::outcome::Outcome;
use crate::answer::presentation::Presentation;
use crate::certify::claim::Status;
use crate::draw::picture::{self, figure, Caption};

/// A file to be: its name, with `/` between folder and file, and its contents.
pub type File = (String, Vec<u8>);

/// Why a file could not be made.
#[derive(Debug, thiserror::Error)]
pub enum BundleError {
    /// A number that is not finite, or an index out of range, in a drawing or model.
    #[error("cannot write {file}: {source}")]
    Write {
        /// Name of the file.
        file: &'static str,
        /// What went wrong.
        source: std::io::Error,
    },
    /// Model for viewers.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// Picture.
    #[error(transparent)]
    Png(#[from] PngError),
    /// Report.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// Page.
    #[error(transparent)]
    Html(#[from] HtmlError),
}

/// Makes every file, on all cores. `time` stamps the STEP header: `2026-11-21T14:30:00`.
///
/// # Errors
/// Data that a format cannot hold.
pub fn files(outcome: &Outcome, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    with_reports(outcome, shown, geometry(outcome, shown, time)?)
}

/// The files that hold geometry: panels for CAD, drawings for the cutter.
///
/// # Errors
/// As [`files`].
pub fn geometry(outcome: &Outcome, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    let header = Header {
        name: marks::product(&outcome.input, &shown.marks),
        time: time.to_owned(),
        uncertainty: if outcome.certificate.seam_gap_bound.is_finite() {
            outcome.certificate.seam_gap_bound.max(1e-6)
        } else {
            outcome.tolerance
        },
    };
    let (step, (dxf, svg)) = rayon::join(
        || text("panels.step", |b| step::panels(b, &header, &outcome.patchwork, &shown.marks.panels)),
        || {
            rayon::join(
                || text("patterns.dxf", |b| dxf::write(b, &shown.drawing)),
                || text("patterns.svg", |b| svg::write(b, &shown.drawing)),
            )
        },
    );
    Ok(vec![step?, dxf?, svg?])
}

/// Adds pictures, model and reports to the files of [`geometry`].
///
/// # Errors
/// As [`files`].
pub fn with_reports(outcome: &Outcome, shown: &Presentation, mut out: Vec<File>) -> Result<Vec<File>, BundleError> {
    let panels = outcome.patchwork.panels.len();
    let what = format!("{panels} panel{}", if panels == 1 { "" } else { "s" });
    let note = match outcome.status() {
        Status::Certified => {
            format!(
                "{what}, each within {} mm of the surface, certified",
                figure(outcome.certificate.deviation_bound, 3)
            )
        }
        Status::Uncertified => format!("{what}, not certified"),
    };
    let names = outcome.patchwork.panels.iter().map(|p| p.strip.name.as_str());
    let bad = marks::chosen(names, &shown.marks.panels);
    let caption = |note: String| {
        let warning =
            if bad.is_empty() { String::new() } else { format!("; {}", marks::do_not_cut(&bad, panels, marks::FEW)) };
        Caption { title: outcome.input.clone(), note: note + &warning, ..Caption::default() }
    };
    let (distances, all, flat) = (
        caption("distance of the panels from the surface, mm".to_owned()),
        caption(note),
        caption(format!("{what}, flat patterns, 1:1 in patterns.dxf")),
    );
    let ((deviation_png, panels_png), (layout_png, model)) = rayon::join(
        || {
            rayon::join(
                || png::write(&picture::deviation(&shown.scene, &shown.direction, outcome.tolerance, &distances)),
                || png::write(&picture::panels(&shown.scene, &shown.direction, &all)),
            )
        },
        || {
            rayon::join(
                || png::write(&picture::layout(&shown.pieces, &flat)),
                || glb::write(&shown.scene, outcome.tolerance),
            )
        },
    );
    let (deviation_png, panels_png) = (deviation_png?, panels_png?);
    let report = Report::of(outcome);
    let page = html::write(&Page {
        report: &report,
        scene: &shown.scene,
        direction: shown.direction,
        layout: &shown.pieces,
        panels_png: &panels_png,
        deviation_png: &deviation_png,
    })?;
    let json = report.to_json()?;
    out.push(("model.glb".into(), model?));
    out.push(("panels.png".into(), panels_png));
    out.push(("deviation.png".into(), deviation_png));
    out.push(("layout.png".into(), layout_png?));
    out.extend(bends::csv(&outcome.patterns).map(|b| ("bends.csv".into(), b)));
    out.push(("report.html".into(), page.into_bytes()));
    out.push(("report.json".into(), json.into_bytes()));
    Ok(out)
}

/// A file that is written line by line.
fn text(file: &'static str, write: impl Fn(&mut Vec<u8>) -> std::io::Result<()>) -> Result<File, BundleError> {
    let mut bytes = Vec::new();
    write(&mut bytes).map_err(|source| BundleError::Write { file, source })?;
    Ok((file.to_owned(), bytes))
}
