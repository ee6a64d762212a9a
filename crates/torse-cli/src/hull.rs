//! `torse hull`: developables on the boundary of the convex hull of curves.

use crate::args::Hull;
use crate::failure::Failure;
use crate::job::Job;
use crate::loft::{rails, split};
use torse::answer::note::{Note, ReaderNote};
use torse::pipeline::hull::{hull, Options};
use torse::torse::rail::Rail;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Hull) -> Result<bool, Failure> {
    let (file, _) = split(&arguments.curves[0]);
    let (mut curves, mut notes): (Vec<Rail>, Vec<ReaderNote>) = Default::default();
    for text in &arguments.curves {
        let found = rails(text, arguments.unit, arguments.polyline)?;
        curves.extend(found.rails);
        notes.extend(found.notes);
    }
    let job = Job::begin(&arguments.files, &file, arguments.time_limit)?;
    let options = Options {
        input: arguments.files.job_name(&file),
        ruling_spacing: arguments.rulings.as_ref().map(|l| l.mm),
        mark_spacing: arguments.marks.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut answer = hull(&curves, &options, job.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse hull --help' for what the curves must be"))?;
    answer.notes.extend(notes.into_iter().map(Note::Input));
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}
