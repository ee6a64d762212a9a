//! What the user is told when a command cannot be done: one message, and what would help.

use std::fmt;
use torse::io::bundle::BundleError;

/// A refusal in plain words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What is wrong, naming the place.
    pub message: String,
    /// What would help; may be empty.
    pub help: String,
}

impl Failure {
    /// A refusal with advice.
    pub fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { message: message.into(), help: help.into() }
    }

    /// A fault of the program.
    pub fn fault(e: &dyn std::error::Error) -> Self {
        Self::new(e.to_string(), "this is a fault of the program; please report it with the input")
    }
}

/// Files that cannot be made.
impl From<BundleError> for Failure {
    fn from(e: BundleError) -> Self {
        Self::fault(&e)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.message)?;
        if !self.help.is_empty() {
            write!(f, "\n  help: {}", self.help)?;
        }
        Ok(())
    }
}

/// The reason of an operating-system error without its number.
pub fn os_reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    match text.split_once(" (os error") {
        Some((reason, _)) => reason.to_string(),
        None => text,
    }
}
