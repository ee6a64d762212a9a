//! Flat parts bent back: from outlines, bend lines and bend tables to the part in space, and how far that is from where it
//! belongs.

mod align;
pub(crate) mod artwork;
pub mod atlas;
pub mod compare;
pub(crate) mod cut;
pub mod drawn;
mod family;
mod followed;
mod items;
pub mod leaf;
mod lines;
pub(crate) mod mesh;
pub(crate) mod one_family;
mod ribbon;
mod rolled;
pub(crate) mod sheet;
mod skin;
mod zone;

/// Why a part cannot be bent back. Messages say what of the part is concerned; the caller names the part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RefoldError {
    /// A rolled face that is told apart from no other.
    #[error(
        "where its rolled face of bend lines {line} and on begins and ends is not drawn (BEND_EXTENT); lay the part flat anew"
    )]
    Ends {
        /// Number of the first line, from 1.
        line: usize,
    },
    /// A rolled face of a sheet whose neutral fibre is drawn, it is not known where.
    #[error(
        "its bend lines from {line} on are those of a cone or another rolled face without one radius, in a sheet with thickness, and \
         report.json does not say where the neutral fibre lies that is drawn there; lay it flat anew"
    )]
    Neutral {
        /// Number of the first line, from 1.
        line: usize,
    },
    /// A fold that is not straight.
    #[error("its bend lines from {line} on are chords of a fold along a curve: these are not bent back")]
    Curve {
        /// Number of the first line, from 1.
        line: usize,
    },
    /// An outline that crosses or touches itself.
    #[error("its outline {contour} crosses or touches itself near ({x:.4}, {y:.4}) mm; draw it again without")]
    Outline {
        /// Number of the outline, the outer one first, from 1.
        contour: usize,
        /// Place.
        x: f64,
        /// Place.
        y: f64,
    },
    /// An outline without area.
    #[error("its outlines enclose no area")]
    Empty,
    /// Bend lines that cross inside the part.
    #[error("its bend lines {first} and {second} cross inside the part; no sheet bends about both")]
    Crossing {
        /// Number of a line, from 1.
        first: usize,
        /// Number of another line, from 1.
        second: usize,
    },
    /// A bend line that does not lie in the part.
    #[error("its bend line {line} does not run through the part")]
    Outside {
        /// Number of the line, from 1.
        line: usize,
    },
    /// Bends that leave some of the part without a place.
    #[error("the area around ({x:.2}, {y:.2}) mm is not joined to the rest by bends")]
    Loose {
        /// Place.
        x: f64,
        /// Place.
        y: f64,
    },
    /// Something of the table that cannot be.
    #[error("{0}")]
    Table(String),
}
