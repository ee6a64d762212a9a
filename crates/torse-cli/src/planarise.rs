//! `torse planarise`: plane quadrilaterals from a strip that nearly has them.

use crate::approximate::{contents, stem};
use crate::args::{HeldPoints, Planarise};
use crate::failure::Failure;
use crate::folder::Output;
use crate::strips::{counted, deliver, tell};
use crate::terminal::Terminal;
use torse::certify::claim::Status;
use torse::design::discrete::planarise::Hold;
use torse::io::quads;
use torse::pipeline::planarise::{planarise, Options};

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
    terminal.guard(Some(output.workspace().to_path_buf()));
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
        drawn: arguments.drawing.drawn(),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut outcome = planarise(&strip, &options, terminal.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse planarise --help' for what can be asked instead"))?;
    let folder = deliver(&mut outcome, Vec::new(), output, &terminal)?;
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let made = format!(
            "{} in {}",
            counted(outcome.strips.len(), "quadrilateral"),
            counted(outcome.parts.len(), "flat part")
        );
        let _ = tell(&outcome, &made, &folder);
    }
    Ok(outcome.status() == Status::Certified)
}
