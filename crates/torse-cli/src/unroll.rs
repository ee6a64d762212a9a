//! `torse unroll`: sheet and developable faces as flat patterns.

use crate::args::Unroll;
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
    let job = Job::begin(&arguments.files, file, arguments.time_limit)?;

    job.say("reading");
    let model = wiring::selected(wiring::read(&file.display().to_string(), &bytes)?, &arguments.chosen)?;
    drop(bytes);
    if arguments.strict {
        refuse_left_out(file, &model.skipped)?;
    }
    let options = UnrollOptions {
        k: if arguments.surfaces { KFactor::default() } else { job.k().unwrap_or_default() },
        facets: arguments.files.shop.facets,
        surfaces: arguments.surfaces,
        approximate: arguments.approximate.as_ref().map(|l| l.mm),
        input: arguments.files.job_name(file),
        ..UnrollOptions::new(arguments.tolerance.mm)
    };
    let mut answer = wiring::unroll(&model, &options, job.control())?;
    if arguments.strict {
        refuse_left_out(file, &answer.skipped)?;
    }
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}
