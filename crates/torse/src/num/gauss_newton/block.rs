//! A group of equations that share their unknowns.

/// What the rows of a block are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// They must vanish.
    Hard,
    /// They pull. Their square enters with `weight²`; if `fades`, the weight falls with the regulariser.
    Soft {
        /// Factor of the rows.
        weight: f64,
        /// Whether the weight falls as the regulariser does.
        fades: bool,
    },
    /// They regularise: their factor is `weight` times the regulariser's ε.
    Fair {
        /// Factor of the rows besides ε.
        weight: f64,
    },
}

/// Equations in a few shared unknowns and in unknowns of their own.
///
/// A block is asked again and again, so none of its methods should allocate. `x` are the values of
/// [`Block::unknowns`] in their order, `own` those of the private unknowns.
pub(crate) trait Block: Send + Sync {
    /// Indices of the shared unknowns, each once. They never change.
    fn unknowns(&self) -> &[u32];

    /// Number of rows; at most `MOST_ROWS`.
    fn rows(&self) -> usize;

    /// Number of unknowns that no other block has; at most `MOST_PRIVATE`.
    fn private(&self) -> usize {
        0
    }

    /// Starting values of the private unknowns.
    fn begin(&self, _x: &[f64], _own: &mut [f64]) {}

    /// Looks anew at what the rows are about (nearest points) after an accepted step.
    fn refresh(&mut self, _x: &[f64]) {}

    /// Values of the rows and, if asked for, their derivatives: row-major, `unknowns + private` numbers a row. Entries
    /// that are never written are zero; all others must be written each time.
    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>);

    /// Whether the unknowns are on the side of the equations that is meant, where rows cannot tell.
    fn keeps_side(&self, _x: &[f64], _own: &[f64]) -> bool {
        true
    }
}

/// Most rows of a block.
pub(crate) const MOST_ROWS: usize = 32;
/// Most private unknowns of a block.
pub(crate) const MOST_PRIVATE: usize = 12;
