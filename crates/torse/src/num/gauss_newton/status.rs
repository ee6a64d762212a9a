//! How a solve ended.

/// Why the solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Hard rows are below the tolerance and the last step was small.
    Converged,
    /// Hard rows do not fall any more: more is asked for than the unknowns can give. [`Outcome::worst`] names the class
    /// of rows that keeps the residual.
    Stalled,
    /// As many iterations as were allowed.
    MaxIterations,
    /// A block says that its unknowns left the side that is meant; see [`Outcome::flipped`].
    Flipped,
    /// The control said stop.
    Cancelled,
}

/// What is left of the hard rows of one class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of the class, see `System::class`.
    pub class: usize,
    /// Largest absolute value of a row.
    pub max: f64,
    /// Index of the block that has it.
    pub block: usize,
}

/// How a solve ended, with its figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Why it stopped.
    pub status: Status,
    /// Linear systems that led to an accepted step.
    pub iterations: usize,
    /// Largest absolute value of a hard row.
    pub residual: f64,
    /// The class of hard rows with the largest value, if there are hard rows at all.
    pub worst: Option<Residual>,
    /// The first block that left its side.
    pub flipped: Option<usize>,
    /// Largest change of an unknown in the last step.
    pub last_step: f64,
}
