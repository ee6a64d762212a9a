//! Floor 2: why something is left out, missing or not proven, as data: names, numbers and places, no prose.
//! [`crate::io::words::why`] makes the sentences. Proofs, searches and jobs each have their own sort; what errors and readers
//! say comes in as it is.

mod face;
mod flat;
mod place;
mod proof;
mod strip;

pub use face::{FaceReason, Limit, Unlaid};
pub use flat::{Differs, Drawn, FlatFault, Near, Of, WrittenFault};
pub use proof::{CoverFault, LoopFault, Obstruction, PanelFault, ProofFault, SeamFault};
pub use strip::{Covered, Curves, JobReason, Sort, Stalled, StripReason, Witness};

use std::error::Error;
use std::ops::Range;

/// Why something is left out, missing or not proven.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// What a reader says of its file, in its words.
    Input(String),
    /// What an error says.
    Error(String),
    /// A reason that is one of a named thing.
    Of(Item, Box<Reason>),
    /// Several at once.
    Several(Vec<Reason>),
    /// Of the proof of panels that cover faces.
    Proof(ProofFault),
    /// Of the flat pattern of a part.
    Flat(FlatFault),
    /// Of a file that was read back.
    Written(WrittenFault),
    /// Of faces and the panels that should cover them.
    Face(FaceReason),
    /// Of strips.
    Strip(StripReason),
    /// Of a job as a whole.
    Job(JobReason),
    /// Why a face or a body is in no flat part.
    Unlaid(Unlaid),
}

/// What a reason is one of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// A thing with a name that says all: a surface, a body, a file.
    Named(String),
    /// A panel.
    Panel(String),
    /// A strip.
    Strip(String),
    /// A flat pattern.
    Pattern(String),
    /// A part.
    Part(String),
    /// A record of a CAD file, and what it stands for.
    Record(u64, Box<Item>),
    /// A handle of a composite, by its number and curve.
    Handle(usize, String),
    /// A length that is asked for in a composite, by its number.
    Length(usize),
    /// Given rulings or planes.
    Elements {
        /// Name of their row; `None` where there is only one.
        row: Option<String>,
        /// Which.
        sort: Sort,
        /// From and to, the last one not among them.
        range: Range<usize>,
    },
}

impl Reason {
    /// What an error says.
    pub(crate) fn error(e: &dyn Error) -> Self {
        Self::Error(e.to_string())
    }

    /// The reason, as one of a thing.
    pub(crate) fn of(item: Item, reason: impl Into<Self>) -> Self {
        Self::Of(item, Box::new(reason.into()))
    }

    /// All reasons as one; `None` if there are none.
    pub(crate) fn all(mut reasons: Vec<Self>) -> Option<Self> {
        match reasons.len() {
            0 | 1 => reasons.pop(),
            _ => Some(Self::Several(reasons)),
        }
    }
}

macro_rules! sorts {
    ($($sort:ident of $name:ident),*) => {
        $(impl From<$name> for Reason {
            fn from(reason: $name) -> Self {
                Self::$sort(reason)
            }
        })*
    };
}

sorts!(Proof of ProofFault, Flat of FlatFault, Written of WrittenFault, Face of FaceReason, Strip of StripReason);
sorts!(Job of JobReason, Unlaid of Unlaid);

impl From<PanelFault> for Reason {
    fn from(fault: PanelFault) -> Self {
        Self::Proof(ProofFault::Panel(fault))
    }
}
