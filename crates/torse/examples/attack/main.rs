//! An adversary of the judge: random surfaces near torses, with panels made by hand, changed at sizes beside the
//! tolerance, and measured by dense sampling that shares nothing with the proof.
//! `cargo run --release --example attack -- SECONDS [SEED]` prints what was tried; exit code 1 if anything that was
//! certified is not so.

mod jobs;
mod measure;
mod mutation;
mod random;
mod specimen;

use jobs::{job, Row, Rows};
use random::Random;
use std::io::Write;
use std::time::Instant;

/// Jobs done at a time.
const THREADS: u64 = 3;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seconds: f64 = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(10.0);
    let seed: u64 = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(1);
    let start = Instant::now();
    let work = |thread: u64| {
        let (mut rows, mut random) = (Rows::new(), Random::new(seed * THREADS + thread));
        while start.elapsed().as_secs_f64() < seconds {
            // Specimens without a panel are no jobs.
            let _ = job(&mut random, &mut rows);
        }
        rows
    };
    let found: Vec<Rows> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS)
            .map(|k| {
                scope.spawn({
                    let work = &work;
                    move || work(k)
                })
            })
            .collect();
        threads.into_iter().map(|t| t.join().expect("a job does not panic")).collect()
    });
    let mut rows = Rows::new();
    for (key, row) in found.into_iter().flatten() {
        rows.entry(key).or_default().add(&row);
    }
    let mut out = std::io::stdout().lock();
    let _ = writeln!(
        out,
        "| tried | jobs | certified | refuted | measured/bound | violations |\n|---|---|---|---|---|---|"
    );
    let mut total = Row::default();
    for ((_, _, name), r) in &rows {
        let _ = writeln!(
            out,
            "| {name} | {} | {} | {} | {:.3} | {} |",
            r.tried, r.certified, r.refuted, r.nearest, r.violations
        );
        total.add(r);
    }
    let _ = writeln!(
        out,
        "| all | {} | {} | {} | {:.3} | {} |",
        total.tried, total.certified, total.refuted, total.nearest, total.violations
    );
    if total.violations > 0 {
        std::process::exit(1);
    }
}
