//! Kinds of cases about developables between curves, ruled surfaces, discrete torses.

use super::value::{Case, Checks};

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    match case.kind.as_str() {
        _ => None,
    }
}
