//! The state of the walk through a file: from its representations down to the uses of faces.

use super::records::{Fault, Records};
use super::units::Units;
use crate::answer::note::reader::ReaderNote;
use crate::geom::placement::Placement;
use std::collections::{HashMap, HashSet};

/// One use of a face.
#[derive(Clone, Debug)]
pub(super) struct Occurrence {
    /// Entity number of the face.
    pub face: u64,
    /// Whether a shell turns it round.
    pub flipped: bool,
    /// Index into [`Census::units`].
    pub units: usize,
    /// Name of the part.
    pub part: String,
    /// Where it goes.
    pub placement: Placement,
    /// Number of the body: a solid, or the sheets of one occurrence of a part.
    pub body: u32,
}

/// All uses of faces, and what was found wanting on the way.
#[derive(Debug, Default)]
pub(super) struct Census {
    /// In the order of the representations.
    pub occurrences: Vec<Occurrence>,
    /// Uses of curves and points of sets.
    pub beside: Vec<Occurrence>,
    /// Units of the contexts met.
    pub units: Vec<Units>,
    /// Items that could not be followed.
    pub faults: Vec<Fault>,
    /// Whether no shape representation leads to a face.
    pub unplaced: bool,
    /// Remarks on the file as a whole.
    pub notes: Vec<ReaderNote>,
    /// Names of the products.
    pub products: Vec<String>,
}

/// Levels of assemblies at most; a deeper nesting is a circle.
pub(super) const DEEPEST_ASSEMBLY: u32 = 64;
/// Uses of faces at most; a short file can ask for exponentially many.
pub(super) const MOST_OCCURRENCES: usize = 200_000;
/// Steps along the assembly tree at most, for the same reason.
pub(super) const MOST_STEPS: usize = 1_000_000;

/// A child representation and how its coordinates become those of the parent.
pub(super) struct Child {
    pub representation: u64,
    pub placement: Placement,
}

/// The way through a file.
pub(super) struct Walk<'r, 'a> {
    pub records: &'r Records<'a>,
    /// Representations that share one space.
    pub group: HashMap<u64, u64>,
    pub members: HashMap<u64, Vec<u64>>,
    pub children: HashMap<u64, Vec<Child>>,
    pub part: HashMap<u64, String>,
    pub units_of: HashMap<u64, usize>,
    pub visited: HashSet<u64>,
    /// Where faces are shown.
    pub shown: HashMap<u64, Vec<Placement>>,
    /// Groups that were found to hold faces.
    pub filled: HashSet<u64>,
    /// Copies of other representations that the walk is in.
    pub copies: u32,
    /// Whether a face met again at the same place, or outside of copies, is another occurrence.
    pub repeats_count: bool,
    pub steps: usize,
    /// Bodies met so far, and the one being walked.
    pub bodies: u32,
    pub body: u32,
    pub out: Census,
}

/// Where the walk stands: what holds for the items met there.
#[derive(Clone, Copy)]
pub(super) struct Here<'p> {
    /// Whether shells above turn faces round.
    pub flipped: bool,
    /// Index of the units.
    pub units: usize,
    /// Where items go.
    pub placement: &'p Placement,
    /// Name of the part.
    pub part: &'p str,
    /// Levels above.
    pub depth: u32,
    /// Whether a shell or a solid lists them, whose members are faces, whatever they are called.
    pub of_faces: bool,
}
