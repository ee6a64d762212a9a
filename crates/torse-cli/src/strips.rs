//! What the jobs that make strips have in common: their files and what the terminal says.

use crate::failure::Failure;
use crate::folder::Output;
use crate::terminal::Terminal;
use crate::wiring::sheets_warning;
use std::io::Write;
use std::path::{Path, PathBuf};
use torse::answer::sheets::Sheets;
use torse::certify::claim::{Claim, Status, Subject, What};
use torse::io::words;
use torse::pipeline::deliver::strip_files;

/// Writes what strips give, with further files of the job, and moves the folder into place, which it names.
pub fn deliver(
    outcome: &mut Sheets,
    further: Vec<(String, Vec<u8>)>,
    output: Output,
    terminal: &Terminal,
) -> Result<PathBuf, Failure> {
    terminal.say("writing");
    let files = strip_files(outcome, &crate::clock::stamp())
        .map_err(|e| Failure::new(e.to_string(), "this is a fault of the program; please report it with the input"))?;
    for (name, bytes) in files.into_iter().chain(further) {
        output.write(&name, &bytes)?;
    }
    terminal.guard(None);
    terminal.finish();
    output.finish()
}

/// So many things of one sort.
pub fn counted(n: usize, word: &str) -> String {
    format!("{n} {word}{}", if n == 1 { "" } else { "s" })
}

/// How much was left out, to follow what was made; nothing if nothing was.
pub fn left_out(outcome: &Sheets) -> String {
    match outcome.skipped.len() {
        0 => String::new(),
        n => format!(", {n} left out"),
    }
}

/// What a job made.
pub fn made(outcome: &Sheets) -> String {
    format!("{} in {}", counted(outcome.strips.len(), "strip"), counted(outcome.parts.len(), "flat part"))
}

/// Tells the result in a few lines: status with what was made, reason, claims of the whole, what was left out, notes.
pub fn tell(outcome: &Sheets, made: &str, folder: &Path) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let curves: Vec<String> = outcome.guides.iter().map(|g| g.name.clone()).collect();
    match outcome.status() {
        Status::Certified => writeln!(out, "certified: {made}, {:.1} s", outcome.seconds)?,
        Status::Uncertified => {
            writeln!(out, "NOT certified, {}: {made}, {:.1} s", sheets_warning(outcome), outcome.seconds)?;
            writeln!(out, "  reason: {}", words::reason(&outcome.claims, &curves))?;
        }
    }
    for c in outcome.claims_of(Subject::Whole) {
        writeln!(out, "  {}: {} ({})", words::name(c, &curves), value(c), words::evidence(c.evidence()))?;
    }
    for s in &outcome.skipped {
        writeln!(out, "  left out: {s}")?;
    }
    for n in &outcome.notes {
        writeln!(out, "  note: {n}")?;
    }
    writeln!(out, "  open {}", folder.join("report.html").display())
}

/// What a claim says, with its unit: "unknown" where nothing is known, "none" of what does not exist.
fn value(c: &Claim) -> String {
    let unit = words::unit(c.what());
    match c.value() {
        _ if c.is_unknown() => "unknown".into(),
        x if x.is_infinite() => match c.what() {
            // Of planes, or of cylinders.
            What::RegressionClearance | What::BendRadius => "none".into(),
            _ => "unknown".into(),
        },
        x if unit.is_empty() => number(x),
        x => format!("{} {unit}", number(x)),
    }
}

/// Four digits, powers of ten where they are needed.
fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{x:.3e}")
}
