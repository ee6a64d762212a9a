//! `torse shape`: strips between curves that one can pull on.

use crate::args::Shape;
use crate::failure::Failure;
use crate::input::contents;
use crate::job::Job;
use torse::io::shape::read;
use torse::pipeline::shape::{shape, Options};

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Shape) -> Result<bool, Failure> {
    let path = &arguments.job;
    let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
    let hint = "docs/shape.md describes jobs";
    let file = read(&contents(path)?, &name, arguments.unit).map_err(|e| Failure::new(e.to_string(), hint))?;
    let job = Job::begin(&arguments.files, path, None)?;
    let folder = path.parent().map(std::path::Path::to_path_buf).unwrap_or_default();
    let load = |name: &str| contents(&folder.join(name)).map_err(|e| format!("{name}: {}", e.message));
    let options = Options {
        input: arguments.files.job_name(path),
        ruling_spacing: arguments.rulings.as_ref().map(|l| l.mm),
        mark_spacing: arguments.marks.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut answer = shape(&file, &options, &load, job.control()).map_err(|e| Failure::new(e.to_string(), hint))?;
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}
