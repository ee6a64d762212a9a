//! Damaged files for every reader: good files of all kinds, changed at random, many a second.
//! `cargo run --release --example mutate -- SECONDS [SEED]` prints what was tried; exit code 1 if a reader panicked, took
//! longer than ten seconds or more memory than two gigabytes, ended its process, refused a file without a word, or
//! answered with numbers that are not finite. Such files are kept in `target/mutate`.
//! `cargo run --release --example mutate -- --again SEED NUMBER` gives one of them to its reader again, aloud.
//!
//! Sums that overflow are panics where the compiler checks them: `CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS=true`.

mod case;
mod mutation;
mod parts;
#[expect(dead_code, reason = "the adversary asks for more sorts of numbers")]
#[path = "../attack/random.rs"]
mod random;
mod readers;
mod specimen;
mod table;
mod worker;

use case::{case, silence, tried, Verdict};
use specimen::Stock;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use table::Table;

/// Files kept of every sort of failure.
const KEPT: usize = 3;
/// Where they are kept.
const FOLDER: &str = "target/mutate";

/// A case that failed, and how.
struct Failure {
    number: u64,
    told: String,
    /// Whether its process ended, so that it is not in the table yet.
    lost: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| arguments.get(k).and_then(|s| s.parse::<u64>().ok());
    match arguments.first().map(String::as_str) {
        Some(worker::WORKER) => {
            silence();
            let seconds = arguments.get(4).and_then(|s| s.parse().ok()).unwrap_or(0.0);
            Ok(worker::work(number(1).unwrap_or(1), number(2).unwrap_or(0), number(3).unwrap_or(1), seconds)?)
        }
        Some("--again") => again(number(1).unwrap_or(1), number(2).unwrap_or(0)),
        first => campaign(first.and_then(|s| s.parse().ok()).unwrap_or(10.0), number(1).unwrap_or(1)),
    }
}

/// Tries as many cases as so many seconds allow, on every processor.
fn campaign(seconds: f64, seed: u64) -> Result<(), Box<dyn Error>> {
    let processes = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let (table, failures) = (Mutex::new(Table::new()), Mutex::new(Vec::new()));
    let done: Vec<Result<(), String>> = std::thread::scope(|scope| {
        let (table, failures) = (&table, &failures);
        let fail = move |number, told, lost| {
            failures.lock().expect("no listener panics").push(Failure { number, told, lost });
        };
        let listen = move |first| {
            let told = |t: worker::Told| {
                table.lock().expect("no listener panics").add(&t);
                if matches!(t.verdict, Verdict::Panicked | Verdict::Unsound) {
                    fail(t.number, t.told, false);
                }
            };
            worker::listen(seed, first, processes, seconds, told, |number, what| fail(number, what, true))
        };
        let threads: Vec<_> = (0..processes).map(|first| scope.spawn(move || listen(first))).collect();
        threads.into_iter().map(|t| t.join().expect("no listener panics")).collect()
    });
    done.into_iter().collect::<Result<(), String>>()?;
    let (mut table, failures) = (table.into_inner()?, failures.into_inner()?);
    keep(seed, &failures, &mut table)?;
    table.write(&mut std::io::stdout().lock())?;
    if !failures.is_empty() {
        std::process::exit(1);
    }
    Ok(())
}

/// Writes the first files of every sort of failure, and tells of them.
fn keep(seed: u64, failures: &[Failure], table: &mut Table) -> Result<(), Box<dyn Error>> {
    if failures.is_empty() {
        return Ok(());
    }
    let stock = Stock::new()?;
    let mut sorts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    fs::create_dir_all(FOLDER)?;
    for f in failures {
        let (reader, bytes) = case(&stock, seed, f.number);
        if f.lost {
            table.lose(reader.name);
        }
        let count = sorts.entry((reader.name, &f.told)).or_default();
        *count += 1;
        if *count <= KEPT {
            let name = reader.name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            let path = Path::new(FOLDER).join(format!("{name}-{seed}-{}", f.number));
            fs::write(&path, bytes)?;
            writeln!(std::io::stderr(), "{}: {}", path.display(), f.told)?;
        }
    }
    for ((reader, told), count) in sorts {
        writeln!(std::io::stderr(), "{count} times, {reader}: {told}")?;
    }
    Ok(())
}

/// One case again.
fn again(seed: u64, number: u64) -> Result<(), Box<dyn Error>> {
    let (reader, bytes) = case(&Stock::new()?, seed, number);
    let outcome = tried(reader, &bytes);
    let mut out = std::io::stdout().lock();
    out.write_all(&bytes)?;
    writeln!(out, "\n{}: {:?} after {:.3} s {}", reader.name, outcome.verdict, outcome.seconds, outcome.told)?;
    Ok(())
}
