//! `torse`: the command line. Arguments, progress, folders and exit status; no geometry.
//!
//! Exit status: 0 finished and certified (or the information asked for), 2 bad input or usage, 3 finished but not
//! certified (files are written and say so), 130 (129, 143) stopped at once by a second Ctrl-C
//! (SIGHUP, SIGTERM).

mod approximate;
mod args;
mod clock;
mod cones;
mod failure;
mod fit;
mod folder;
mod hull;
mod info;
mod input;
mod job;
mod loft;
mod map;
mod net;
mod planarise;
mod quantity;
mod refold;
mod ruled;
mod shape;
mod shop;
mod signals;
mod terminal;
mod unroll;
mod usage;
mod wiring;

use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

/// Exit status of bad input and bad usage (clap uses the same one).
const BAD_INPUT: u8 = 2;
/// Exit status of a finished job whose result is not certified.
const NOT_CERTIFIED: u8 = 3;

fn main() -> ExitCode {
    match args::Arguments::try_parse().map_err(usage::refusal).and_then(|a| run(&a)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(NOT_CERTIFIED),
        Err(failure) => {
            // A closed stderr leaves nobody to tell.
            let _ = writeln!(std::io::stderr(), "{failure}");
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// Runs the command; `Ok(true)` unless a result is not certified.
fn run(arguments: &args::Arguments) -> Result<bool, failure::Failure> {
    match &arguments.command {
        args::Command::Approximate(a) => approximate::run(a),
        args::Command::Cones(a) => cones::run(a),
        args::Command::Fit(a) => fit::run(a),
        args::Command::Hull(a) => hull::run(a),
        args::Command::Loft(a) => loft::run(a),
        args::Command::Net(a) => net::run(a),
        args::Command::Planarise(a) => planarise::run(a),
        args::Command::Ruled(a) => ruled::run(a),
        args::Command::Shape(a) => shape::run(a),
        args::Command::Unroll(a) => unroll::run(a),
        args::Command::Refold(a) => refold::run(a),
        args::Command::Map(a) => map::run(a),
        args::Command::Info(a) => info::run(a),
    }
}
