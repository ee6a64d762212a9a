//! `torse fit`: developable strips from measured points, rulings, tangent planes, and faces of too high a degree.

use crate::approximate::{contents, significant, stem};
use crate::args::Fit;
use crate::failure::Failure;
use crate::folder::Output;
use crate::strips::deliver;
use crate::terminal::Terminal;
use std::io::Write;
use torse::io::elements;
use torse::pipeline::fit::{fit, FitOptions, FitOutcome};
use torse::pipeline::outcome::Status;
use torse::pipeline::row::{fit_faces, fit_row, RowFitOptions, RowOutcome};
use torse::surface::zone::RegressionLimits;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Fit) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, arguments.time_limit)?;
    terminal.guard(Some(output.staging().to_path_buf()));

    terminal.say("reading");
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let lower = name.to_ascii_lowercase();
    if lower.ends_with(".step") || lower.ends_with(".stp") || elements::holds_elements(&name, &bytes) {
        let outcome = row(&name, &bytes, arguments, &terminal)?;
        deliver(&outcome.sheets, Vec::new(), output, &terminal)?;
        if !arguments.quiet {
            // A closed pipe is no reason to fail after the work is done.
            let _ = summary_of_row(&outcome, arguments);
        }
        return Ok(outcome.sheets.status == Status::Certified);
    }
    for (given, name) in
        [(arguments.fix_ends, "--fix-ends"), (arguments.smooth.is_some(), "--smooth"), (arguments.robust, "--robust")]
    {
        if given {
            let help = "leave it away: fits of points keep off outliers and noise by themselves";
            return Err(Failure::new(format!("{name} is for rulings, planes and faces, not for points"), help));
        }
    }
    let cloud = torse::io::cloud::read(&name, &bytes, millimetres(&arguments.unit))
        .map_err(|e| Failure::new(format!("{}: {e}", file.display()), "export the scan as PLY, CSV, OBJ or STL"))?;
    drop(bytes);
    let mut options = FitOptions::new(arguments.tolerance.mm, &job_name(arguments));
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    let outcome = fit(&cloud, &options, terminal.control()).map_err(|e| {
        Failure::new(e.to_string(), "give a scan of a sheet with its unit (--unit) and a tolerance above its noise")
    })?;

    let map = torse::io::cloud::ply::with_values(&cloud.points, outcome.certificate.signed_estimates(), "deviation");
    deliver(&outcome.sheets, vec![("deviation.ply".into(), map)], output, &terminal)?;
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = summary(&outcome, arguments);
    }
    Ok(outcome.sheets.status == Status::Certified)
}

/// Fits rulings, planes or faces.
fn row(name: &str, bytes: &[u8], arguments: &Fit, terminal: &Terminal) -> Result<RowOutcome, Failure> {
    let mut options = RowFitOptions::new(arguments.tolerance.mm, &job_name(arguments));
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    (options.fix_ends, options.smoothing, options.robust) = (arguments.fix_ends, arguments.smooth, arguments.robust);
    let shown = arguments.file.display();
    if elements::holds_elements(name, bytes) {
        let unit = millimetres(&arguments.unit);
        let region = arguments.region.map(|r| r.map(|v| v * unit));
        let given = elements::read(name, bytes, unit, region)
            .map_err(|e| Failure::new(format!("{shown}: {e}"), "see 'torse fit --help' for the columns of a table"))?;
        return fit_row(&given, &options, terminal.control()).map_err(|e| {
            Failure::new(e.to_string(), "give rulings or planes of one developable, in order, and their unit (--unit)")
        });
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

/// Tells the result of rulings, planes or faces in a few lines.
fn summary_of_row(outcome: &RowOutcome, arguments: &Fit) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let sheets = &outcome.sheets;
    let strips = format!("{} strip{}", sheets.strips.len(), if sheets.strips.len() == 1 { "" } else { "s" });
    let what = sheets.figures.first().map_or("elements", |f| f.name.as_str());
    let count = outcome.elements.len();
    match &sheets.status {
        Status::Certified => writeln!(
            out,
            "certified: {strips} for {count} {what}, none farther than {} mm (tolerance {}), {:.1} s",
            significant(outcome.certificate.worst_bound()),
            arguments.tolerance.text,
            sheets.seconds
        )?,
        Status::Uncertified(reason) => {
            writeln!(out, "NOT certified: {strips} for {count} {what}, {:.1} s", sheets.seconds)?;
            writeln!(out, "  reason: {reason}")?;
        }
    }
    for s in &sheets.skipped {
        writeln!(out, "  left out: {s}")?;
    }
    writeln!(out, "  open {}", arguments.out.join("report.html").display())
}

/// Millimetres of a unit that the arguments allow.
fn millimetres(unit: &str) -> f64 {
    match unit {
        "cm" => 10.0,
        "m" => 1000.0,
        "in" => 25.4,
        "ft" => 304.8,
        _ => 1.0,
    }
}

/// Tells the result in a few lines.
fn summary(outcome: &FitOutcome, arguments: &Fit) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let sheets = &outcome.sheets;
    let strips = format!("{} strip{}", sheets.strips.len(), if sheets.strips.len() == 1 { "" } else { "s" });
    let points = outcome.certificate.bounds().len();
    match &sheets.status {
        Status::Certified => writeln!(
            out,
            "certified: {strips} for {points} points, none farther than {} mm (tolerance {}), noise about {} mm, {:.1} s",
            significant(outcome.certificate.worst_bound()),
            arguments.tolerance.text,
            significant(outcome.noise_estimate),
            sheets.seconds
        )?,
        Status::Uncertified(reason) => {
            writeln!(out, "NOT certified: {strips} for {points} points, {:.1} s", sheets.seconds)?;
            writeln!(out, "  reason: {reason}")?;
        }
    }
    for s in &sheets.skipped {
        writeln!(out, "  left out: {s}")?;
    }
    writeln!(out, "  open {}", arguments.out.join("report.html").display())
}
