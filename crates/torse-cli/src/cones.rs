//! `torse cones`: developable faces as exact cones, cylinders and planes.

use crate::approximate::{contents, refuse_left_out, stem};
use crate::args::Cones;
use crate::failure::Failure;
use crate::folder::Output;
use crate::strips::{counted, left_out, tell};
use crate::terminal::Terminal;
use crate::wiring;
use torse::certify::claim::Status;
use torse::pipeline::cones::counts;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Cones) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, None)?;
    terminal.guard(Some(output.workspace().to_path_buf()));

    terminal.say("reading");
    let model = wiring::read(&file.display().to_string(), &bytes)?;
    drop(bytes);
    let name = arguments.name.clone().unwrap_or_else(|| stem(file));
    let mut outcome = wiring::cones(&model, &name, arguments.tolerance.mm, terminal.control())?;
    if arguments.strict {
        refuse_left_out(file, &outcome.sheets.skipped)?;
    }

    terminal.say("writing");
    for (name, bytes) in wiring::cone_files(&mut outcome)? {
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
    terminal.guard(None);
    terminal.finish();
    let folder = output.finish()?;

    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let counts = counts(&outcome.bodies);
        let made = format!(
            "{}, {} and {} for {}{}",
            counted(counts[0], "cone"),
            counted(counts[1], "cylinder"),
            counted(counts[2], "plane"),
            counted(outcome.bodies.len(), "surface"),
            left_out(&outcome.sheets)
        );
        let _ = tell(&outcome.sheets, &made, &folder);
    }
    Ok(outcome.sheets.status() == Status::Certified)
}
