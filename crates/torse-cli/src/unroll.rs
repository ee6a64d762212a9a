//! `torse unroll`: sheet and developable faces as flat patterns.

use crate::args::{Files, Unroll};
use crate::failure::{os_reason, Failure};
use crate::folder::{remove_surplus, Numbered};
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use crate::shop::fibre_in_sheet;
use crate::terminal::Terminal;
use crate::wiring;
use std::io::Write as _;
use std::path::Path;
use std::rc::Rc;
use torse::develop::unfold::allowance::KFactor;
use torse::io::model::Model;
use torse::pipeline::unroll::groups;
use torse::UnrollOptions;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Unroll) -> Result<bool, Failure> {
    let file = &arguments.file;
    if arguments.surfaces {
        fibre_in_sheet(&arguments.files.shop)?;
    }
    let bytes = contents(file)?;
    if let Some(count) = arguments.split {
        return split(arguments, &bytes, count as usize);
    }
    let terminal = Rc::new(Terminal::new(arguments.files.quiet, arguments.time_limit)?);
    let job = Job::within(&arguments.files, file, &terminal)?;
    job.say("reading");
    let model = read(arguments, &bytes)?;
    drop(bytes);
    one(arguments, model, job)
}

/// Reads what was chosen of the file.
fn read(arguments: &Unroll, bytes: &[u8]) -> Result<Model, Failure> {
    let file = &arguments.file;
    let model = wiring::selected(wiring::read(&file.display().to_string(), bytes)?, &arguments.chosen)?;
    if arguments.strict {
        refuse_left_out(file, &model.skipped)?;
    }
    Ok(model)
}

/// One result; the model is forgotten before it is written.
fn one(arguments: &Unroll, model: Model, job: Job) -> Result<bool, Failure> {
    let file = &arguments.file;
    let options = UnrollOptions {
        k: if arguments.surfaces { KFactor::default() } else { job.k().unwrap_or_default() },
        facets: arguments.files.shop.facets,
        bend_step: arguments.bend_step.to_radians(),
        surfaces: arguments.surfaces,
        sheet: job.sheet(),
        joins: arguments.bends.clone(),
        approximate: arguments.approximate.as_ref().map(|l| l.mm),
        input: arguments.files.job_name(file),
        ..UnrollOptions::new(arguments.tolerance.mm)
    };
    let mut answer = wiring::unroll(&model, &options, job.control())?;
    drop(model);
    if arguments.strict {
        refuse_left_out(file, &answer.skipped)?;
    }
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}

/// Results of so many bodies each, in folders of their own; what is done with is forgotten before the next begins. A group of
/// which nothing can be laid flat is named, and the others go on.
fn split(arguments: &Unroll, bytes: &[u8], count: usize) -> Result<bool, Failure> {
    let files = &arguments.files;
    let terminal = Rc::new(Terminal::new(files.quiet, arguments.time_limit)?);
    terminal.say("reading");
    let groups = groups(read(arguments, bytes)?, count, arguments.tolerance.mm, arguments.surfaces);
    folder(&files.out)?;
    let whole = groups.len();
    let digits = whole.to_string().len().max(LEAST_DIGITS);
    let (mut certified, mut first) = (true, None);
    for (k, model) in groups.into_iter().enumerate() {
        if terminal.control().stopped() {
            return Err(Failure::new(
                format!("stopped after {k} of {whole} folders"),
                "what is in them is complete; begin again with a longer --time-limit",
            ));
        }
        let name = format!("{:0digits$}", k + 1);
        let own = Files { out: files.out.join(&name), ..files.clone() };
        let made = Job::within(&own, &arguments.file, &terminal).and_then(|job| one(arguments, model, job));
        match made {
            Ok(good) => certified &= good,
            Err(failure) if whole == 1 => return Err(failure),
            Err(failure) => {
                // A closed stderr leaves nobody to tell.
                let _ = writeln!(std::io::stderr(), "folder {name}: {failure}");
                if own.out.exists() {
                    let _ =
                        writeln!(std::io::stderr(), "note: what '{}' holds is not of this result", own.out.display());
                }
                first.get_or_insert(failure);
            }
        }
    }
    if files.force {
        let job = files.job_name(&arguments.file);
        let numbered = Numbered { parent: &files.out, digits, count: whole, least: LEAST_DIGITS, job: &job };
        for note in remove_surplus(&numbered, &arguments.file) {
            let _ = writeln!(std::io::stderr(), "note: {note}");
        }
    }
    first.map_or(Ok(certified), Err)
}

/// Least digits of the names of folders.
const LEAST_DIGITS: usize = 3;

/// The folder that holds the others.
fn folder(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(path).map_err(|e| {
        Failure::new(
            format!("cannot create '{}': {}", path.display(), os_reason(&e)),
            "name a new folder inside an existing one, for example --out flat",
        )
    })
}
