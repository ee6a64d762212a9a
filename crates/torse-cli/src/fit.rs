//! `torse fit`: developable strips from measured points.

use crate::approximate::{contents, significant, stem};
use crate::args::Fit;
use crate::failure::Failure;
use crate::folder::Output;
use crate::terminal::Terminal;
use std::io::Write;
use torse::pipeline::fit::{fit, FitOptions, FitOutcome};
use torse::pipeline::outcome::Status;
use torse::pipeline::presentation::present_sheets;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Fit) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let output = Output::prepare(&arguments.out, file, arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, arguments.time_limit)?;
    terminal.guard(Some(output.staging().to_path_buf()));

    terminal.say("reading");
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let cloud = torse::io::cloud::read(&name, &bytes, millimetres(&arguments.unit))
        .map_err(|e| Failure::new(format!("{}: {e}", file.display()), "export the scan as PLY, CSV, OBJ or STL"))?;
    drop(bytes);
    let mut options = FitOptions::new(arguments.tolerance.mm, &arguments.name.clone().unwrap_or_else(|| stem(file)));
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    let outcome = fit(&cloud, &options, terminal.control()).map_err(|e| {
        Failure::new(e.to_string(), "give a scan of a sheet with its unit (--unit) and a tolerance above its noise")
    })?;

    terminal.say("writing");
    let fault = "this is a fault of the program; please report it with the file";
    let files = torse::io::sheets::files(&outcome.sheets, &present_sheets(&outcome.sheets), &crate::clock::stamp())
        .map_err(|e| Failure::new(e.to_string(), fault))?;
    for (name, bytes) in files {
        output.write(&name, &bytes)?;
    }
    let map = torse::io::cloud::ply::with_values(&cloud.points, outcome.certificate.signed_estimates(), "deviation");
    output.write("deviation.ply", &map)?;
    output.finish()?;
    terminal.guard(None);
    terminal.finish();
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let _ = summary(&outcome, arguments);
    }
    Ok(outcome.sheets.status == Status::Certified)
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
