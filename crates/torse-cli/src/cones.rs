//! `torse cones`: developable faces as exact cones, cylinders and planes.

use crate::args::Cones;
use crate::failure::Failure;
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use crate::wiring;
use torse::ConesOptions;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Cones) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let job = Job::begin(&arguments.files, file, None)?;

    job.say("reading");
    let model = wiring::selected(wiring::read(&file.display().to_string(), &bytes)?, &arguments.chosen)?;
    drop(bytes);
    let name = arguments.files.job_name(file);
    let options = ConesOptions {
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..ConesOptions::new(arguments.tolerance.mm, name)
    };
    let mut answer = wiring::cones(&model, &options, job.control())?;
    if arguments.strict {
        refuse_left_out(file, &answer.skipped)?;
    }
    job.deliver(&mut answer)?;
    if arguments.bending {
        job.write(wiring::bending_files(&answer)?)?;
    }
    if let Some(thickness) = &arguments.files.shop.thickness {
        job.write(wiring::thickness_files(&answer, thickness.mm)?)?;
    }
    job.finish(&answer, &arguments.tolerance.text)
}
