//! What was tried, by reader.

use crate::case::Verdict;
use crate::readers::READERS;
use crate::worker::Told;
use std::io::{self, Write};

#[derive(Clone, Copy, Default)]
struct Row {
    tried: usize,
    read: usize,
    refused: usize,
    panics: usize,
    others: usize,
    slowest: f64,
    /// Number of the slowest case.
    slow: u64,
    memory: u64,
}

/// A row for every reader.
pub struct Table([Row; READERS.len()]);

impl Table {
    pub fn new() -> Self {
        Self([Row::default(); READERS.len()])
    }

    pub fn add(&mut self, told: &Told) {
        let row = &mut self.0[told.reader];
        row.tried += 1;
        match told.verdict {
            Verdict::Read => row.read += 1,
            Verdict::Refused => row.refused += 1,
            Verdict::Panicked => row.panics += 1,
            Verdict::Unsound => row.others += 1,
        }
        if told.seconds > row.slowest {
            (row.slowest, row.slow) = (told.seconds, told.number);
        }
        row.memory = row.memory.max(told.memory);
    }

    /// A case of a reader that ended its process.
    pub fn lose(&mut self, reader: &str) {
        for (row, r) in self.0.iter_mut().zip(&READERS) {
            if r.name == reader {
                row.tried += 1;
                row.others += 1;
            }
        }
    }

    /// Writes it for a page of the documentation.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "| reader | files tried | read | refused with a message | panics | other failures | slowest (s) | largest memory (MB) |\n\
             |---|---|---|---|---|---|---|---|"
        )?;
        let mut all = Row::default();
        for (r, reader) in self.0.iter().zip(&READERS) {
            line(out, reader.name, r)?;
            all.tried += r.tried;
            all.read += r.read;
            all.refused += r.refused;
            all.panics += r.panics;
            all.others += r.others;
            if r.slowest > all.slowest {
                (all.slowest, all.slow) = (r.slowest, r.slow);
            }
            all.memory = all.memory.max(r.memory);
        }
        line(out, "all", &all)?;
        writeln!(out, "\nThe slowest is case {}.", all.slow)
    }
}

fn line(out: &mut dyn Write, name: &str, r: &Row) -> io::Result<()> {
    writeln!(
        out,
        "| {name} | {} | {} | {} | {} | {} | {:.3} | {:.0} |",
        r.tried,
        r.read,
        r.refused,
        r.panics,
        r.others,
        r.slowest,
        r.memory as f64 / 1024.0
    )
}
