//! `torse planarise`: plane quadrilaterals from a strip that nearly has them.

use crate::approximate::{contents, stem};
use crate::args::{HeldPoints, Planarise};
use crate::failure::Failure;
use crate::folder::Output;
use crate::strips::deliver;
use crate::terminal::Terminal;
use std::io::Write;
use torse::design::discrete::planarise::Hold;
use torse::io::quads;
use torse::pipeline::outcome::Status;
use torse::pipeline::planarise::{planarise, Options};
use torse::pipeline::sheets::Sheets;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Planarise) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let strip = quads::read(&name, &bytes, arguments.unit).map_err(|e| {
        Failure::new(format!("{}: {e}", file.display()), "see 'torse planarise --help' for the form of a strip")
    })?;
    drop(bytes);
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, None)?;
    terminal.guard(Some(output.staging().to_path_buf()));
    let options = Options {
        input: arguments.name.clone().unwrap_or_else(|| stem(file)),
        levels: arguments.levels as usize,
        hold: match arguments.hold {
            HeldPoints::Nothing => Hold::Nothing,
            HeldPoints::First => Hold::First,
            HeldPoints::Second => Hold::Second,
            HeldPoints::Ends => Hold::Ends,
        },
        most_move: arguments.max_move.as_ref().map(|l| l.mm),
        ..Options::new(arguments.tolerance.mm)
    };
    let outcome = planarise(&strip, &options, terminal.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse planarise --help' for what can be asked instead"))?;
    deliver(&outcome, Vec::new(), output, &terminal)?;
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = summary(&outcome, arguments);
    }
    Ok(outcome.status == Status::Certified)
}

/// Tells the result in a few lines.
fn summary(outcome: &Sheets, arguments: &Planarise) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let word = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let head = format!(
        "{} in {}, {:.1} s",
        word(outcome.strips.len(), "quadrilateral"),
        word(outcome.parts.len(), "flat part"),
        outcome.seconds
    );
    match &outcome.status {
        Status::Certified => writeln!(out, "certified: {head}, plane within {}", arguments.tolerance.text)?,
        Status::Uncertified(reason) => {
            writeln!(out, "NOT certified: {head}")?;
            writeln!(out, "  reason: {reason}")?;
        }
    }
    for f in outcome.figures.iter().filter(|f| f.value.is_finite()) {
        writeln!(out, "  {}: {:.3e} {} ({})", f.name, f.value, f.unit, f.basis.name())?;
    }
    for n in &outcome.notes {
        writeln!(out, "  note: {n}")?;
    }
    writeln!(out, "  open {}", arguments.out.join("report.html").display())
}
