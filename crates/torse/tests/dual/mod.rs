//! Fits in dual space: statements of the paper, closed forms, bad input, measured points.

mod cloud;
mod levels;
mod planes;
mod regression;
mod rows;
mod simple;

use torse::answer::Answer;
use torse::certify::claim::What;
use torse::torse::strip::Strip;

/// What an answer says of the whole.
pub fn value(answer: &Answer, what: What) -> f64 {
    answer.claim(what).map_or(f64::NAN, |c| c.value())
}

/// The strips of an answer.
pub fn strips(answer: &Answer) -> Vec<Strip> {
    answer.strips().cloned().collect()
}

/// Evenly distributed numbers in −1..1, the same on every machine.
pub struct Random(u64);

impl Random {
    /// A sequence.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// The next number.
    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
