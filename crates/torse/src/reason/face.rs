//! Why faces, bodies and panels are left out, or do not keep to what was asked.

use super::Reason;
use crate::geom::Vec3;

/// Of faces and the panels that should cover them.
#[derive(Clone, Debug, PartialEq)]
pub enum FaceReason {
    /// Time was up before it was covered.
    OutOfTime,
    /// The job ended before a face.
    EndedBefore {
        /// Its entity number.
        entity: u64,
    },
    /// It is one with other faces, by their entity numbers.
    Joined(Box<Reason>, Vec<u64>),
    /// Faces or items of a file are left out.
    LeftOut {
        /// How many.
        count: usize,
        /// Their area, mm², as far as it is known.
        area_estimate: f64,
        /// How many of them are of unknown area.
        unknown: usize,
        /// Entity number of the first.
        entity: Option<u64>,
        /// Why it is left out.
        first: Box<Reason>,
    },
    /// Panels are left out.
    PanelsLeftOut {
        /// How many.
        count: usize,
        /// Why the first is.
        first: Box<Reason>,
    },
    /// No cover was found whose panels bend so little.
    TooTight {
        /// Entity number of the face.
        entity: u64,
        /// Attempts given to it; `None`: its share of the time.
        attempts: Option<usize>,
        /// Radius asked for, mm.
        radius: f64,
        /// Panels that it asks for, about.
        panels: f64,
    },
    /// A trim is not shown to keep to the file's edges.
    Trim {
        /// Entity number of the face.
        entity: u64,
        /// Entity number of the edge.
        edge: u64,
        /// Proven distance, mm; infinite where none is.
        bound: f64,
    },
    /// The surface is a spline in place of that of the file, and not shown to be near enough.
    Replaced {
        /// Entity number of the face.
        entity: u64,
        /// Proven distance, mm; infinite where it was only measured.
        bound: f64,
    },
    /// A region has no panel.
    NoPanel {
        /// What the error says.
        error: Box<Reason>,
        /// Where, if that is known.
        at: Option<Vec3>,
    },
    /// Where a seam was asked for, no panel ends.
    SeamLost {
        /// Entity number of the face.
        entity: u64,
        /// How far (mm) the nearest edge of a panel is.
        by: f64,
        /// Where, mm.
        at: Vec3,
    },
    /// A panel has no flat pattern.
    NoPattern {
        /// Name of the panel.
        panel: String,
        /// What the error says.
        error: Box<Reason>,
    },
    /// A panel does not keep a limit of sheet or material.
    Limit {
        /// Name of the panel.
        panel: String,
        /// Which limit.
        limit: Limit,
        /// What it has instead, mm: proven for the radius and the distance to the regression curve.
        value: f64,
        /// What is asked for or allowed, mm.
        asked: f64,
        /// How many more panels do not keep it.
        more: usize,
    },
    /// A part does not cover its face for certain.
    NoCover {
        /// Name of the part.
        part: String,
    },
    /// Not all faces of a part have a flat image that could be proven.
    NoImage,
    /// A loop of edges of a face bounds nothing as it was read.
    LoopLost {
        /// Entity number of the face.
        entity: u64,
        /// That of the loop's first edge.
        edge: u64,
    },
    /// A face of a part has a sharp edge inside, of which no bend line tells.
    Kinked {
        /// Its entity number.
        entity: u64,
        /// Turn of the normal across the edge, rad.
        turn: f64,
        /// A place on the edge.
        at: Vec3,
    },
    /// A part is proven, but not within the tolerance.
    BeyondTolerance {
        /// Name of the part.
        part: String,
    },
    /// An outline leaves its patch.
    OutlineLeaves,
    /// It is of degree 1 in no direction.
    NotRuled,
    /// All rulings meet at its tip, where no sheet bends.
    Tip(Vec3),
    /// A ruling is not usable.
    Unusable {
        /// Which.
        u: f64,
        /// What the error says.
        error: Box<Reason>,
    },
    /// It is twisted along a ruling.
    Twisted {
        /// Which.
        u: f64,
        /// How far (mm) its end is off.
        off: f64,
    },
}

/// Limits of sheet and material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Least bending radius.
    BendRadius,
    /// Least distance to the regression curve.
    Clearance,
    /// Greatest width of the strip.
    StripWidth,
    /// Greatest length of the pattern.
    Length,
    /// Width of the sheet.
    SheetWidth,
    /// Length of the sheet.
    SheetLength,
    /// Least mean width.
    MeanWidth,
}

/// Why a face or a body is in no flat part.
#[derive(Clone, Debug, PartialEq)]
pub enum Unlaid {
    /// The job was stopped before.
    Stopped,
    /// The body is no sheet, as an error says.
    NoSheet(String),
    /// The face is not developable, by greatest values found at samples.
    Curved {
        /// Turn of the normal along a straight parameter line, rad; not a number if none is straight.
        twist_estimate: f64,
        /// Gaussian curvature, 1/mm².
        curvature_estimate: f64,
        /// Strain that flattening it would need.
        strain_estimate: f64,
    },
    /// The face is neither skin nor edge of the sheet.
    Feature {
        /// What it lies on.
        surface: &'static str,
        /// Thickness of the sheet, mm.
        thickness: f64,
    },
    /// The face could not be laid flat.
    Face {
        /// What it lies on.
        surface: &'static str,
    },
    /// The face is so narrow that nothing is left of its outline.
    Narrow {
        /// Tolerance of the drawing, mm.
        tolerance: f64,
    },
    /// So many faces that hang together, and why the first of them is.
    Group(usize, Box<Unlaid>),
    /// A strip could not be developed, as an error says.
    Undeveloped(String),
    /// A panel that could not be.
    Panel,
    /// It names strips that do not exist.
    NoStrips,
    /// The job was stopped before it was laid flat.
    NotBegun,
    /// A ruled strip: it cannot be.
    Ruled,
}
