//! `torse approximate`: the main job.

use crate::args::{self, Approximate, Seams};
use crate::failure::{os_reason, Failure};
use crate::folder::Output;
use crate::loft::{rail, rails};
use crate::quantity::{section, Length};
use crate::terminal::Terminal;
use crate::wiring;
use std::io::Write;
use std::path::Path;
use torse::answer::outcome::{Outcome, Skipped};
use torse::certify::claim::Status;
use torse::io::words;
use torse::search::cover::{CurveShape, Guide, Layout, LayoutKind, Limits, PanelCurve, SeamPlane};
use torse::torse::rail::Rail;

/// Share of the tolerance that panels may use if cones follow: the rest is for the cones, which are many where it is
/// small.
const PANELS_OF_CONES: f64 = 0.6;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Approximate) -> Result<bool, Failure> {
    let file = &arguments.file;
    let least = || arguments.sweep.iter().min_by(|a, b| a.mm.total_cmp(&b.mm));
    let tolerance = arguments.tolerance.as_ref().or_else(least);
    let tolerance = tolerance.ok_or_else(|| Failure::new("no tolerance", "give one: --tolerance 2mm"))?;
    let bytes = contents(file)?;
    let (layout, unread) = layout(arguments)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, arguments.time_limit)?;
    terminal.guard(Some(output.workspace().to_path_buf()));

    terminal.say("reading");
    let mut model = wiring::read(&file.display().to_string(), &bytes)?;
    drop(bytes);
    if arguments.strict {
        refuse_skipped(file, &model.skipped)?;
    }
    let job = wiring::Job {
        name: arguments.name.clone().unwrap_or_else(|| stem(file)),
        tolerance: if arguments.cones { PANELS_OF_CONES } else { 1.0 } * tolerance.mm,
        max_panels: arguments.max_panels.map(|n| n as usize),
        limits: limits(arguments),
        layout,
        meet: arguments.seams == Seams::Meet,
        smooth_angle: arguments.smooth_angle.to_radians(),
        drawn: arguments.drawing.drawn(),
    };
    let mut notes = std::mem::take(&mut model.notes);
    notes.extend(unread);
    let swept = if arguments.sweep.is_empty() {
        Vec::new()
    } else {
        let tolerances: Vec<f64> = arguments.sweep.iter().map(|l| l.mm).collect();
        wiring::sweep(&model, &tolerances, &job, terminal.control())?
    };
    let mut outcome = wiring::approximate(model, &job, terminal.control())?;
    if arguments.strict {
        refuse_skipped(file, &outcome.skipped)?;
    }
    let bare = job.layout.curves.iter().filter(|c| outcome.along.iter().all(|a| a.curve != c.name));
    notes.extend(bare.map(|c| format!("no panel along {} could be certified; others took its place", c.name)));

    outcome.notes = notes;
    terminal.say("writing");
    for (name, bytes) in wiring::files(&mut outcome)? {
        output.write(&name, &bytes)?;
    }
    for (name, bytes) in &swept {
        output.write(name, bytes)?;
    }
    let mut cones_hold = true;
    if arguments.cones {
        terminal.say("cones");
        let mut cones = wiring::cones_of_panels(&outcome, tolerance.mm, terminal.control())?;
        cones_hold = cones.sheets.status() == Status::Certified;
        for (name, bytes) in wiring::cone_files(&mut cones)? {
            let name = if name.starts_with("cones") { name } else { format!("cones-{name}") };
            output.write(&name, &bytes)?;
        }
    }
    terminal.guard(None);
    terminal.finish();
    let folder = output.finish()?;

    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = summary(&outcome, tolerance, &folder, terminal.interrupted());
    }
    Ok(outcome.status() == Status::Certified && cones_hold)
}

/// What sheet and material allow, in mm.
fn limits(arguments: &Approximate) -> Limits {
    let mm = |length: &Option<Length>| length.as_ref().map(|l| l.mm);
    Limits {
        min_bend_radius: mm(&arguments.min_bend_radius),
        min_clearance: mm(&arguments.min_clearance),
        max_width: mm(&arguments.max_width),
        max_length: mm(&arguments.max_length),
    }
}

/// Points on a guide curve.
const GUIDE_POINTS: usize = 400;

/// Where strips and seams run, with notes of what was not read.
fn layout(arguments: &Approximate) -> Result<(Layout, Vec<String>), Failure> {
    let mut notes = Vec::new();
    let guide = match (&arguments.direction, &arguments.guide) {
        (Some(d), _) => Some(Guide::Direction(*d)),
        (None, Some(file)) => {
            let (rail, unread) = rail(file, arguments.unit, false)?;
            notes.extend(unread);
            Some(Guide::Curve(rail.samples(GUIDE_POINTS)))
        }
        (None, None) => None,
    };
    let kind = match arguments.layout {
        args::Layout::Auto => LayoutKind::Auto,
        args::Layout::Strips => LayoutKind::Strips,
        args::Layout::Rings => LayoutKind::Rings,
    };
    let seams = arguments.seam_at.iter().map(|s| SeamPlane { normal: s.axis, offset: s.at }).collect();
    let mut all = Vec::new();
    for text in &arguments.curves {
        all.extend(curves(text, arguments.unit, &mut notes)?);
    }
    Ok((Layout { kind, guide, seams, curves: all }, notes))
}

/// Curves that panels run along: one, or all of a drawing. What was not read of it goes into `notes`.
fn curves(text: &str, unit: Option<f64>, notes: &mut Vec<String>) -> Result<Vec<PanelCurve>, Failure> {
    let shape = match text.split_once('=').map(|(axis, place)| (axis.trim(), place.trim())) {
        Some((axis @ ("u" | "v"), place)) => {
            let share = place.parse::<f64>().ok().filter(|s| (0.0..=1.0).contains(s)).ok_or_else(|| {
                Failure::new(
                    format!("'{text}' is no parameter curve"),
                    "write u or v and a share of its range, such as u=0.5",
                )
            })?;
            if axis == "u" {
                CurveShape::AlongV(share)
            } else {
                CurveShape::AlongU(share)
            }
        }
        Some(("x" | "X" | "y" | "Y" | "z" | "Z", _)) => {
            let s = section(text).map_err(|e| Failure::new(e, "give the plane of the section with its unit"))?;
            CurveShape::Section { normal: s.axis, offset: s.at }
        }
        _ => {
            let found = rails(text, unit, false)?;
            notes.extend(found.notes);
            let name = |r: &Rail| if found.rails.len() > 1 { r.name.clone() } else { text.to_owned() };
            let points = |r: &Rail| CurveShape::Points(r.samples(GUIDE_POINTS));
            return Ok(found.rails.iter().map(|r| PanelCurve { name: name(r), shape: points(r) }).collect());
        }
    };
    Ok(vec![PanelCurve { name: text.to_owned(), shape }])
}

/// Reads the input file.
pub fn contents(file: &Path) -> Result<Vec<u8>, Failure> {
    if file.is_dir() {
        return Err(Failure::new(format!("'{}' is a folder", file.display()), "give a file inside it"));
    }
    std::fs::read(file).map_err(|e| {
        Failure::new(format!("cannot read '{}': {}", file.display(), os_reason(&e)), "check the name and the rights")
    })
}

/// Name of a file without folder and extension.
pub fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "model".to_string(), |s| s.to_string_lossy().into_owned())
}

/// `--strict`: a face that is left out, by the reader or by the job, is an error.
pub fn refuse_skipped(file: &Path, skipped: &[Skipped]) -> Result<(), Failure> {
    let words: Vec<String> = skipped.iter().map(|s| format!("#{} cannot be used: {}", s.entity, s.reason)).collect();
    refuse_left_out(file, &words)
}

/// As [`refuse_skipped`], for what is left out in words.
pub fn refuse_left_out(file: &Path, left_out: &[String]) -> Result<(), Failure> {
    let Some(first) = left_out.first() else { return Ok(()) };
    let more = match left_out.len() {
        1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    };
    Err(Failure::new(
        format!("{}: {first}{more}", file.display()),
        "repair it in CAD, or leave out --strict to go on with the other faces",
    ))
}

/// Tells the result in a few lines.
fn summary(outcome: &Outcome, tolerance: &Length, folder: &Path, interrupted: bool) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let panels = outcome.patchwork.panels.len();
    let faces = outcome.patchwork.faces.len();
    let word = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let left_out = match outcome.skipped.len() {
        0 => String::new(),
        n => format!(", {n} left out"),
    };
    let head = format!("{} for {}{left_out}", word(panels, "panel"), word(faces, "face"));
    match outcome.status() {
        Status::Certified => writeln!(
            out,
            "certified: {head}, at most {} mm from the surface (tolerance {}), {:.1} s",
            significant(outcome.certificate.deviation_bound),
            tolerance.text,
            outcome.seconds
        )?,
        Status::Uncertified => {
            writeln!(out, "NOT certified, {}: {head}, {:.1} s", wiring::warning(outcome), outcome.seconds)?;
            writeln!(out, "  reason: {}", words::reason(&outcome.claims, &[]))?;
        }
    }
    if interrupted {
        writeln!(out, "  stopped early by Ctrl-C")?;
    }
    for face in outcome.patchwork.faces.iter().filter(|f| !f.parts.is_empty()) {
        let parts: Vec<String> = face.parts.iter().map(|p| format!("#{}", p.entity)).collect();
        writeln!(out, "  covered as one: {}", parts.join(" + "))?;
    }
    for skipped in &outcome.skipped {
        writeln!(out, "  left out: #{}: {}", skipped.entity, skipped.reason)?;
    }
    for note in &outcome.notes {
        writeln!(out, "  note: {note}")?;
    }
    writeln!(out, "  open {}", folder.join("report.html").display())
}

/// A bound to three significant digits, rounded up: it must not look better than it is.
pub fn significant(value: f64) -> String {
    if value <= 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = 2 - value.log10().floor() as i32;
    let scale = 10f64.powi(digits);
    let rounded = (value * scale).ceil() / scale;
    format!("{rounded:.*}", digits.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_up() {
        assert_eq!(significant(0.98212), "0.983");
        assert_eq!(significant(1.9e-4), "0.000190");
        assert_eq!(significant(12.341), "12.4");
        assert_eq!(significant(1234.1), "1240");
        assert_eq!(significant(f64::INFINITY), "inf");
    }

    #[test]
    fn names_come_from_files() {
        assert_eq!(stem(Path::new("a/hull.v2.step")), "hull.v2");
        assert_eq!(stem(Path::new("/")), "model");
    }
}
