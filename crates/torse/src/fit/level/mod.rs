//! Functions whose level curves bound strips.

pub mod strip_potential;
