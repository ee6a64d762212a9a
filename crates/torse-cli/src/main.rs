//! `torse`: the command line.
fn main() {}
