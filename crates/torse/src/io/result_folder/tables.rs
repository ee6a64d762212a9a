//! Rows of the tables of bends.

use crate::develop::unfold::bends::BendKind;
use crate::patchwork::pattern::{Bend, BendSense};
use std::ops::Range;

/// A row of `bends.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct TableLine {
    /// Which way, turn (rad) and radii (mm, infinite where the sheet is flat).
    pub bend: Bend,
    /// Length, mm.
    pub length: f64,
}

/// A row of `bend_table.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct TableBend {
    /// How the sheet is bent.
    pub kind: BendKind,
    /// Which way.
    pub sense: BendSense,
    /// Turn, rad.
    pub angle: f64,
    /// Inside radius, mm; not a number where there is none.
    pub inside_radius: f64,
    /// Allowance, mm; not a number where there is none.
    pub allowance: f64,
    /// Depth of the neutral fibre as a share of the thickness.
    pub k: f64,
    /// Its lines among those of the part.
    pub lines: Range<usize>,
}

/// What the table leaves open of an angle, degrees.
pub(super) const PRINTED_ANGLE: f64 = 1.1e-4;
