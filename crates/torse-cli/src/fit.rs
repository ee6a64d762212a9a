//! `torse fit`: developable strips from measured points, rulings, tangent planes, and faces of too high a degree.

use crate::approximate::{contents, refuse_left_out, stem};
use crate::args::Fit;
use crate::failure::Failure;
use crate::folder::Output;
use crate::strips::{counted, deliver, left_out, tell};
use crate::terminal::Terminal;
use torse::certify::claim::{Status, Subject};
use torse::io::{elements, words};
use torse::pipeline::fit::{fit, FitOptions};
use torse::pipeline::row::{fit_faces, fit_row, RowFitOptions, RowOutcome};
use torse::torse::zone::RegressionLimits;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Fit) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, arguments.time_limit)?;
    terminal.guard(Some(output.workspace().to_path_buf()));

    terminal.say("reading");
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let lower = name.to_ascii_lowercase();
    if lower.ends_with(".step") || lower.ends_with(".stp") || elements::holds_elements(&name, &bytes) {
        let mut outcome = row(&name, &bytes, arguments, &terminal)?;
        if arguments.strict {
            refuse_left_out(file, &outcome.sheets.skipped)?;
        }
        let folder = deliver(&mut outcome.sheets, Vec::new(), output, &terminal)?;
        if !arguments.quiet {
            // A closed pipe is no reason to fail after the work is done.
            let what =
                outcome.sheets.claims_of(Subject::Whole).next().map_or_else(String::new, |c| words::name(c, &[]));
            let made = format!(
                "{} for {} {what}{}, tolerance {}",
                counted(outcome.sheets.strips.len(), "strip"),
                outcome.elements.len(),
                left_out(&outcome.sheets),
                arguments.tolerance.text
            );
            let _ = tell(&outcome.sheets, &made, &folder);
        }
        return Ok(outcome.sheets.status() == Status::Certified);
    }
    for (given, name) in
        [(arguments.fix_ends, "--fix-ends"), (arguments.smooth.is_some(), "--smooth"), (arguments.robust, "--robust")]
    {
        if given {
            let help = "leave it away: fits of points keep off outliers and noise by themselves";
            return Err(Failure::new(format!("{name} is for rulings, planes and faces, not for points"), help));
        }
    }
    let (cloud, guess) = torse::io::cloud::read_noted(&name, &bytes, arguments.unit)
        .map_err(|e| Failure::new(format!("{}: {e}", file.display()), "export the scan as PLY, CSV, OBJ or STL"))?;
    drop(bytes);
    let mut options = FitOptions::new(arguments.tolerance.mm, &job_name(arguments));
    options.drawn = arguments.drawing.drawn();
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    let mut outcome = fit(&cloud, &options, terminal.control()).map_err(|e| {
        Failure::new(e.to_string(), "give a scan of a sheet with its unit (--unit) and a tolerance above its noise")
    })?;

    outcome.sheets.notes.extend(guess);
    let map = torse::io::cloud::ply::with_values(&cloud.points, outcome.certificate.signed_estimates(), "deviation");
    let folder = deliver(&mut outcome.sheets, vec![("deviation.ply".into(), map)], output, &terminal)?;
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let made = format!(
            "{} for {}, tolerance {}",
            counted(outcome.sheets.strips.len(), "strip"),
            counted(outcome.certificate.bounds().len(), "point"),
            arguments.tolerance.text
        );
        let _ = tell(&outcome.sheets, &made, &folder);
    }
    Ok(outcome.sheets.status() == Status::Certified)
}

/// Fits rulings, planes or faces.
fn row(name: &str, bytes: &[u8], arguments: &Fit, terminal: &Terminal) -> Result<RowOutcome, Failure> {
    let mut options = RowFitOptions::new(arguments.tolerance.mm, &job_name(arguments));
    options.drawn = arguments.drawing.drawn();
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    (options.fix_ends, options.smoothing, options.robust) = (arguments.fix_ends, arguments.smooth, arguments.robust);
    let shown = arguments.file.display();
    if elements::holds_elements(name, bytes) {
        let (given, notes) = elements::read(name, bytes, arguments.unit, arguments.region)
            .map_err(|e| Failure::new(format!("{shown}: {e}"), "see 'torse fit --help' for the columns of a table"))?;
        let mut outcome = fit_row(&given, &options, terminal.control()).map_err(|e| {
            Failure::new(e.to_string(), "give rulings or planes of one developable, in order, and their unit (--unit)")
        })?;
        outcome.sheets.notes.extend(notes);
        return Ok(outcome);
    }
    let model = crate::wiring::read(&shown.to_string(), bytes)?;
    fit_faces(&model.faces, &model.skipped, &options, terminal.control())
        .map_err(|e| Failure::new(e.to_string(), "'torse approximate' covers surfaces that are not developable"))
}

/// What is asked of regression curves; nothing unless an option says so.
fn limits(arguments: &Fit) -> Option<RegressionLimits> {
    let asked = arguments.min_clearance.is_some() || !arguments.clear_zone.is_empty();
    let clearance = arguments.min_clearance.as_ref().map_or(0.0, |l| l.mm);
    asked.then(|| RegressionLimits { clearance, zones: arguments.clear_zone.clone() })
}

/// Name of the job in the files.
fn job_name(arguments: &Fit) -> String {
    arguments.name.clone().unwrap_or_else(|| stem(&arguments.file))
}
