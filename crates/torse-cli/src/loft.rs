//! `torse loft`: the developable between two rails.

use crate::args::{Loft, LoftEnds, LoftExtension};
use crate::failure::Failure;
use crate::input::contents;
use crate::job::Job;
use std::path::{Path, PathBuf};
use torse::answer::note::{Note, ReaderNote};
use torse::io::curves::{self, CurveError, CurveOptions, Curves};
use torse::pipeline::loft::{loft, Choice, Ends, Extension, Options};
use torse::torse::rail::Rail;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Loft) -> Result<bool, Failure> {
    let (file, _) = split(&arguments.a);
    let (a, mut notes) = rail(&arguments.a, arguments.unit, arguments.polyline)?;
    let (b, more) = rail(&arguments.b, arguments.unit, arguments.polyline)?;
    notes.extend(more);
    let job = Job::begin(&arguments.files, &file, arguments.time_limit)?;
    let options = Options {
        input: arguments.files.job_name(&file),
        ends: match arguments.ends {
            LoftEnds::Trim => Ends::Trim,
            LoftEnds::Fan => Ends::Fan,
            LoftEnds::Extend => Ends::Extend,
        },
        extension: match arguments.extension {
            LoftExtension::Curve => Extension::Curve,
            LoftExtension::Line => Extension::Line,
        },
        choice: match (arguments.exact, arguments.least_twist) {
            (true, _) => Choice::Exact,
            (_, true) => Choice::LeastTwist,
            _ => Choice::Auto,
        },
        alternative: arguments.alternative as usize,
        fixed: arguments.fixed.clone(),
        ruling_spacing: arguments.rulings.as_ref().map(|l| l.mm),
        mark_spacing: arguments.marks.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..Options::new(arguments.tolerance.mm)
    };
    let mut answer = loft(&a, &b, &options, job.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse loft --help' for what can be asked instead"))?;
    answer.notes.extend(notes.into_iter().map(Note::Input));
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}

/// File and curve of `FILE#CURVE`. A file whose name holds the sign is taken as it is.
pub fn split(text: &str) -> (PathBuf, String) {
    match text.rsplit_once('#') {
        Some((file, curve)) if !Path::new(text).exists() => (PathBuf::from(file), curve.to_owned()),
        _ => (PathBuf::from(text), String::new()),
    }
}

/// Reads one rail; returned with notes of what was not read.
pub fn rail(text: &str, unit: Option<f64>, polyline: bool) -> Result<(Rail, Vec<ReaderNote>), Failure> {
    let (bytes, options) = source(text, unit, polyline)?;
    curves::read(&bytes, &options).map_err(|e| refusal(&e))
}

/// Reads all curves of a drawing or table, or the edge named of a STEP file.
pub fn rails(text: &str, unit: Option<f64>, polyline: bool) -> Result<Curves, Failure> {
    let (bytes, options) = source(text, unit, polyline)?;
    curves::read_all(&bytes, &options).map_err(|e| refusal(&e))
}

/// Contents of a file of curves and what the reader is told.
fn source(text: &str, unit: Option<f64>, polyline: bool) -> Result<(Vec<u8>, CurveOptions), Failure> {
    let (file, select) = split(text);
    let bytes = contents(&file)?;
    let name = file.file_name().map_or_else(|| text.to_owned(), |n| n.to_string_lossy().into_owned());
    let name = if select.is_empty() { name } else { format!("{name}#{select}") };
    Ok((bytes, CurveOptions { name, select, unit, polyline }))
}

fn refusal(e: &CurveError) -> Failure {
    let help = match e {
        CurveError::NoUnit(_) => "guessing a unit could ruin material",
        CurveError::Several { .. } | CurveError::Missing { .. } => "write FILE#NUMBER (STEP) or FILE#LAYER (DXF)",
        CurveError::Line { .. } => "a table has columns x, y, z; a first line may name and order them among others",
        _ => "check the file in the program that made it",
    };
    Failure::new(e.to_string(), help)
}
