//! Runs a file of test vectors through the public interface: `cargo run --release --example vectors -- FILE.json`.
//!
//! The file is `{format, convention, cases: [{kind, input, output, tol?, note?} or {kind, data}]}`. Every case whose
//! kind is known here is run; for each kind the program prints how many passed, failed and were unknown, and the
//! worst error as a share of what the case allows. Exit status 1 if a case failed, 2 if the file cannot be used.

mod composite;
mod cones;
mod curves;
mod discrete;
mod dual;
mod nets;
mod value;

use std::collections::BTreeMap;
use std::io::Write;
use std::process::ExitCode;
use value::{Case, Checks};

/// Runs a case, if its kind is known there.
type Group = fn(&Case) -> Option<Result<Checks, String>>;

/// One group of cases per capability: the first that knows a kind runs the case; `None` where it knows nothing of it.
const GROUPS: &[Group] = &[nets::run, composite::run, curves::run, dual::run, cones::run, discrete::run];

/// What became of the cases of one kind.
#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    unknown: usize,
    worst: f64,
    reasons: Vec<String>,
}

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("name a file of vectors: cargo run --release --example vectors -- FILE.json");
        return ExitCode::from(2);
    };
    let cases = match value::read(&path) {
        Ok(cases) => cases,
        Err(reason) => {
            eprintln!("{path}: {reason}");
            return ExitCode::from(2);
        }
    };
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    for (number, case) in cases.iter().enumerate() {
        let tally = tallies.entry(case.kind.clone()).or_default();
        let answer = GROUPS.iter().find_map(|run| run(case));
        let outcome = match answer {
            None => {
                tally.unknown += 1;
                continue;
            }
            Some(Ok(checks)) => {
                tally.worst = tally.worst.max(checks.worst());
                checks.verdict()
            }
            Some(Err(reason)) => Err(reason),
        };
        match outcome {
            Ok(()) => tally.passed += 1,
            Err(reason) => {
                tally.failed += 1;
                tally.reasons.push(format!("case {number}: {reason}"));
            }
        }
    }
    let mut out = std::io::stdout().lock();
    // A closed pipe leaves nobody to tell.
    let _ = writeln!(out, "{:<28} {:>6} {:>6} {:>7}  worst error / allowed", "kind", "passed", "failed", "unknown");
    for (kind, t) in &tallies {
        let _ = writeln!(out, "{kind:<28} {:>6} {:>6} {:>7}  {:.1e}", t.passed, t.failed, t.unknown, t.worst);
        for reason in &t.reasons {
            let _ = writeln!(out, "    {reason}");
        }
    }
    if tallies.values().any(|t| t.failed > 0) {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
