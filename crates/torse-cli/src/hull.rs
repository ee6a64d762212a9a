//! `torse hull`: developables on the boundary of the convex hull of curves.

use crate::approximate::stem;
use crate::args::Hull;
use crate::failure::Failure;
use crate::folder::Output;
use crate::loft::{rails, split};
use crate::strips::{deliver, made, tell};
use crate::terminal::Terminal;
use torse::certify::claim::Status;
use torse::pipeline::hull::{hull, Options};
use torse::torse::rail::Rail;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Hull) -> Result<bool, Failure> {
    let (file, _) = split(&arguments.curves[0]);
    let (mut curves, mut notes): (Vec<Rail>, Vec<String>) = Default::default();
    for text in &arguments.curves {
        let found = rails(text, arguments.unit, arguments.polyline)?;
        curves.extend(found.rails);
        notes.extend(found.notes);
    }
    let output = Output::prepare(&arguments.out, &file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, arguments.time_limit)?;
    terminal.guard(Some(output.workspace().to_path_buf()));
    let options = Options {
        input: arguments.name.clone().unwrap_or_else(|| stem(&file)),
        ruling_spacing: arguments.rulings.as_ref().map(|l| l.mm),
        mark_spacing: arguments.marks.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut outcome = hull(&curves, &options, terminal.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse hull --help' for what the curves must be"))?;
    outcome.notes.extend(notes);
    let folder = deliver(&mut outcome, Vec::new(), output, &terminal)?;
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = tell(&outcome, &made(&outcome), &folder);
    }
    Ok(outcome.status() == Status::Certified)
}
