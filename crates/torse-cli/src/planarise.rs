//! `torse planarise`: plane quadrilaterals from a strip that nearly has them.

use crate::args::{HeldPoints, Planarise};
use crate::failure::Failure;
use crate::input::contents;
use crate::job::Job;
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
    let job = Job::begin(&arguments.files, file, None)?;
    let options = Options {
        input: arguments.files.job_name(file),
        levels: arguments.levels as usize,
        hold: match arguments.hold {
            HeldPoints::Nothing => Hold::Nothing,
            HeldPoints::First => Hold::First,
            HeldPoints::Second => Hold::Second,
            HeldPoints::Ends => Hold::Ends,
        },
        most_move: arguments.max_move.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut answer = planarise(&strip, &options, job.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse planarise --help' for what can be asked instead"))?;
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}
