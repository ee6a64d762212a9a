//! `torse unroll`: sheet and developable faces as flat patterns.

use crate::args::{self, Unroll};
use crate::failure::Failure;
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use crate::wiring;
use torse::develop::unfold::allowance::KFactor;
use torse::UnrollOptions;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Unroll) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let k = match &arguments.k {
        None => KFactor::default(),
        Some(args::K::Share(k)) => KFactor::Ansi(*k),
        Some(args::K::Din) => KFactor::Din,
        Some(args::K::Table(file)) => KFactor::Table(wiring::k_table(&file.display().to_string(), &contents(file)?)?),
    };
    let job = Job::begin(&arguments.files, file, None)?;

    job.say("reading");
    let model = wiring::selected(wiring::read(&file.display().to_string(), &bytes)?, &arguments.chosen)?;
    drop(bytes);
    if arguments.strict {
        refuse_left_out(file, &model.skipped)?;
    }
    let options = UnrollOptions {
        k,
        surfaces: arguments.surfaces,
        input: arguments.files.job_name(file),
        ..UnrollOptions::new(arguments.tolerance.mm)
    };
    job.say("unfolding");
    let mut answer = wiring::unroll(&model, &options)?;
    if arguments.strict {
        refuse_left_out(file, &answer.skipped)?;
    }
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}
