//! What the jobs that make strips have in common: their files.

use crate::failure::Failure;
use crate::folder::Output;
use crate::terminal::Terminal;
use torse::io::sheets;
use torse::pipeline::presentation::present_sheets;
use torse::pipeline::sheets::Sheets;

/// Writes what strips give, with further files of the job, and moves the folder into place.
pub fn deliver(
    outcome: &Sheets,
    further: Vec<(String, Vec<u8>)>,
    output: Output,
    terminal: &Terminal,
) -> Result<(), Failure> {
    terminal.say("writing");
    let files = sheets::files(outcome, &present_sheets(outcome), &crate::clock::stamp())
        .map_err(|e| Failure::new(e.to_string(), "this is a fault of the program; please report it with the input"))?;
    for (name, bytes) in files.into_iter().chain(further) {
        output.write(&name, &bytes)?;
    }
    output.finish()?;
    terminal.guard(None);
    terminal.finish();
    Ok(())
}
