//! Unknowns and blocks of rows before they are solved.

use super::block::{Block, Role, MOST_PRIVATE, MOST_ROWS};

/// A block in its place.
pub(super) struct Placed {
    pub block: Box<dyn Block>,
    pub role: Role,
    pub class: usize,
}

/// Unknowns, rows, and what counts as a small displacement.
pub(crate) struct System {
    pub(super) frozen: Vec<bool>,
    pub(super) blocks: Vec<Placed>,
    pub(super) classes: Vec<String>,
    pub(super) metric: Vec<(f64, Vec<(u32, f64)>)>,
}

/// A system that cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SystemError {
    /// A block names an unknown that does not exist, or one twice.
    #[error("block {block}: unknown {unknown} is named twice or does not exist (there are {count})")]
    Unknown {
        /// Index of the block.
        block: usize,
        /// Index of the unknown.
        unknown: u32,
        /// Number of unknowns.
        count: usize,
    },
    /// A block that is too large.
    #[error(
        "block {block} has {rows} rows and {private} unknowns of its own; at most {MOST_ROWS} and {MOST_PRIVATE} go"
    )]
    Size {
        /// Index of the block.
        block: usize,
        /// Rows.
        rows: usize,
        /// Private unknowns.
        private: usize,
    },
    /// Starting values that do not fit or are not finite.
    #[error("{given} starting values are given for {count} unknowns, or one is not a finite number")]
    Start {
        /// Values given.
        given: usize,
        /// Number of unknowns.
        count: usize,
    },
    /// No memory, or more unknowns than the matrix can index.
    #[error("the matrix of {unknowns} unknowns could not be set up")]
    Matrix {
        /// Number of free unknowns.
        unknowns: usize,
    },
}

impl System {
    /// A system of `unknowns` shared unknowns without rows.
    pub fn new(unknowns: usize) -> Self {
        Self { frozen: vec![false; unknowns], blocks: Vec::new(), classes: Vec::new(), metric: Vec::new() }
    }

    /// Number of shared unknowns, frozen ones included.
    pub fn len(&self) -> usize {
        self.frozen.len()
    }

    /// Adds an unknown; answers its index.
    pub fn unknown(&mut self) -> u32 {
        self.frozen.push(false);
        (self.frozen.len() - 1) as u32
    }

    /// The unknown keeps its value: it is eliminated from all rows. Values of frozen unknowns may be changed between
    /// solves, so they also serve as given numbers of the rows (targets of handles).
    pub fn freeze(&mut self, unknown: u32) {
        if let Some(f) = self.frozen.get_mut(unknown as usize) {
            *f = true;
        }
    }

    /// Whether an unknown is frozen.
    pub fn is_frozen(&self, unknown: u32) -> bool {
        self.frozen.get(unknown as usize).copied().unwrap_or(false)
    }

    /// Number of unknowns that are free.
    pub fn free(&self) -> usize {
        self.frozen.iter().filter(|f| !**f).count()
    }

    /// The index of a class of rows; classes are what a stalled solve names.
    pub fn class(&mut self, name: &str) -> usize {
        self.classes.iter().position(|c| c == name).unwrap_or_else(|| {
            self.classes.push(name.into());
            self.classes.len() - 1
        })
    }

    /// Adds a block; answers its index.
    pub fn add(&mut self, block: impl Block + 'static, role: Role, class: usize) -> usize {
        self.blocks.push(Placed { block: Box::new(block), role, class });
        self.blocks.len() - 1
    }

    /// Adds `(weight · Σ cᵢ Δxᵢ)²` to the squared length of a displacement Δx, which is `|Δx|²` otherwise.
    pub fn measure(&mut self, weight: f64, combination: Vec<(u32, f64)>) {
        self.metric.push((weight, combination));
    }

    /// For every block the number of its hard rows less its private unknowns: what it takes from the free unknowns if rows
    /// are independent.
    pub fn conditions(&self) -> impl Iterator<Item = usize> + '_ {
        self.blocks.iter().map(|p| match p.role {
            Role::Hard => p.block.rows().saturating_sub(p.block.private()),
            _ => 0,
        })
    }

    /// Checks indices and sizes.
    pub(super) fn check(&self) -> Result<(), SystemError> {
        let count = self.len();
        let mut seen = vec![usize::MAX; count];
        for (k, placed) in self.blocks.iter().enumerate() {
            let (rows, private) = (placed.block.rows(), placed.block.private());
            if rows > MOST_ROWS || private > MOST_PRIVATE {
                return Err(SystemError::Size { block: k, rows, private });
            }
            for &unknown in placed.block.unknowns() {
                match seen.get_mut(unknown as usize) {
                    Some(s) if *s != k => *s = k,
                    _ => return Err(SystemError::Unknown { block: k, unknown, count }),
                }
            }
        }
        Ok(())
    }
}
