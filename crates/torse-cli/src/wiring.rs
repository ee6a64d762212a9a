//! The one place where the program calls the library: read, approximate, files. Opens nothing and prints nothing.

use crate::failure::Failure;
use torse::control::Control;
use torse::pipeline::outcome::{Outcome, Skipped};
use torse::surface::face::Face;

/// A model as read from a file.
pub struct Model {
    /// Usable faces.
    pub faces: Vec<Face>,
    /// What could not be used.
    pub skipped: Vec<Skipped>,
    /// Length unit of the file, as found.
    pub unit: String,
    /// Remarks of the reader.
    pub notes: Vec<String>,
}

/// What the main job is asked.
pub struct Job {
    /// Name of the job.
    pub name: String,
    /// Tolerance, mm.
    pub tolerance: f64,
    /// Largest number of panels.
    pub max_panels: Option<usize>,
}

/// Reads a STEP file. `name` is for messages.
pub fn read(name: &str, _bytes: &[u8]) -> Result<Model, Failure> {
    Err(Failure::new(format!("{name}: the STEP reader is not connected yet"), ""))
}

/// Runs the main job.
pub fn approximate(_model: Model, _job: &Job, _control: &Control) -> Result<Outcome, Failure> {
    Err(Failure::new("the approximation is not connected yet", ""))
}

/// The files of a result, by name.
pub fn files(_outcome: &Outcome) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    Err(Failure::new("the writers are not connected yet", ""))
}
