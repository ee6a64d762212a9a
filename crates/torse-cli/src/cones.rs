//! `torse cones`: developable faces as exact cones, cylinders and planes.

use crate::approximate::{contents, significant, stem};
use crate::args::Cones;
use crate::failure::Failure;
use crate::folder::Output;
use crate::terminal::Terminal;
use crate::wiring;
use std::io::Write;
use torse::pipeline::cones::{counts, ConesOutcome};
use torse::pipeline::outcome::Status;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Cones) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, None)?;
    terminal.guard(Some(output.staging().to_path_buf()));

    terminal.say("reading");
    let model = wiring::read(&file.display().to_string(), &bytes)?;
    drop(bytes);
    let name = arguments.name.clone().unwrap_or_else(|| stem(file));
    let outcome = wiring::cones(&model, &name, arguments.tolerance.mm, terminal.control())?;

    terminal.say("writing");
    for (name, bytes) in wiring::cone_files(&outcome)? {
        output.write(&name, &bytes)?;
    }
    if arguments.bending {
        for (name, bytes) in wiring::bending_files(&outcome)? {
            output.write(&name, &bytes)?;
        }
    }
    if let Some(thickness) = &arguments.thickness {
        for (name, bytes) in wiring::thickness_files(&outcome, thickness.mm)? {
            output.write(&name, &bytes)?;
        }
    }
    output.finish()?;
    terminal.guard(None);
    terminal.finish();

    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = summary(&outcome, arguments);
    }
    Ok(outcome.sheets.status == Status::Certified)
}

/// Tells the result in a few lines.
fn summary(outcome: &ConesOutcome, arguments: &Cones) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let counts = counts(&outcome.bodies);
    let word = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let head = format!(
        "{}, {} and {} for {}",
        word(counts[0], "cone"),
        word(counts[1], "cylinder"),
        word(counts[2], "plane"),
        word(outcome.bodies.len(), "surface")
    );
    match &outcome.sheets.status {
        Status::Certified => {
            let bound = outcome.sheets.figures.iter().filter(|f| f.unit == "mm").map(|f| f.value).fold(0.0, f64::max);
            writeln!(
                out,
                "certified: {head}, at most {} mm apart both ways (tolerance {})",
                significant(bound),
                arguments.tolerance.text
            )?;
        }
        Status::Uncertified(reason) => {
            writeln!(out, "NOT certified: {head}")?;
            writeln!(out, "  reason: {reason}")?;
        }
    }
    for skipped in &outcome.sheets.skipped {
        writeln!(out, "  left out: {skipped}")?;
    }
    for note in &outcome.sheets.notes {
        writeln!(out, "  note: {note}")?;
    }
    writeln!(out, "  open {}", arguments.out.join("report.html").display())
}
