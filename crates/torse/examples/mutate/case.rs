//! One case: a good file, changed as its number says, given to a reader, and what came of it.

use crate::mutation::mutated;
use crate::random::Random;
use crate::readers::{Reader, READERS};
use crate::specimen::Stock;
use std::panic::{catch_unwind, set_hook};
use std::sync::Mutex;
use std::time::Instant;

/// Share of cases in which pieces of another kind of file come in.
const FOREIGN: usize = 6;

/// What came of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    Read,
    Refused,
    Panicked,
    /// Refused without a word, or with numbers that are none where none may be.
    Unsound,
}

pub struct Outcome {
    pub verdict: Verdict,
    pub seconds: f64,
    /// Where it panicked, what is unsound; in one line.
    pub told: String,
}

/// The last panic's place and message.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Panics are counted, not printed.
pub fn silence() {
    set_hook(Box::new(|panic| {
        let payload = panic.payload();
        let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
        let message = text.unwrap_or("").lines().next().unwrap_or("");
        let at = panic.location().map_or(String::new(), |l| format!("{}:{}", l.file(), l.line()));
        if let Ok(mut told) = PANIC.lock() {
            *told = format!("{at}: {message}");
        }
    }));
}

/// The reader and the file of a case.
pub fn case(stock: &Stock, seed: u64, number: u64) -> (&'static Reader, Vec<u8>) {
    // Numbers lie in the lower half; the lowest bit is lost on the generator.
    let mut random = Random::new(seed.wrapping_shl(40).wrapping_add(2 * number));
    random.unit();
    let reader = &READERS[random.below(READERS.len())];
    let good = stock.any(&mut random, reader.kinds).to_vec();
    let other =
        if random.below(FOREIGN) == 0 { stock.other(&mut random) } else { stock.any(&mut random, reader.kinds) };
    (reader, mutated(&mut random, &good, other))
}

/// Gives a file to a reader.
pub fn tried(reader: &Reader, bytes: &[u8]) -> Outcome {
    let start = Instant::now();
    let answer = catch_unwind(|| (reader.read)(bytes));
    let seconds = start.elapsed().as_secs_f64();
    let (verdict, told) = match answer {
        Ok(Ok(true)) => (Verdict::Read, String::new()),
        Ok(Ok(false)) => (Verdict::Unsound, "numbers that are not finite, or corners that are not there".into()),
        Ok(Err(message)) if message.trim().is_empty() => (Verdict::Unsound, "refused without a word".into()),
        Ok(Err(_)) => (Verdict::Refused, String::new()),
        Err(_) => (Verdict::Panicked, PANIC.lock().map_or(String::new(), |told| told.clone())),
    };
    Outcome { verdict, seconds, told }
}
