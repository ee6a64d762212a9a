//! What proofs of flat patterns, and of files that were read back, miss.

/// What the proof of a flat pattern misses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatFault {
    /// No map to the plane could be shown to keep lengths.
    NoMap,
    /// The drawing is only proven to be within so much, mm.
    Drawing(f64),
    /// Lengths are only proven to change by less than so much, mm.
    Lengths(f64),
    /// The proof was stopped.
    Stopped,
    /// There is no such panel.
    NoPanel,
    /// The patch is not ruled.
    NotRuled,
    /// Nothing is drawn.
    Nothing,
    /// The outline drawn is not one closed line.
    NotOneLine,
    /// The outline drawn has no sides.
    NoSides,
    /// The outline drawn does not have the sides of the panel.
    OtherSides,
    /// The outline drawn does not have the loops of the part.
    OtherLoops,
    /// A loop drawn is none of the part's.
    StrangeLoop,
    /// The outline drawn cannot be laid on what it is of.
    Nowhere(Of),
    /// The outline drawn could not be shown to be near the border of what it is of.
    Outline(Of),
    /// The outline drawn could not be shown not to meet itself.
    Meets,
    /// A ruling drawn is none of what it is of.
    Ruling(Of),
    /// A mark has no partner, or is not on a seam.
    Mark,
    /// A mark is not on a rail.
    MarkOffRail,
    /// There are marks where none are expected.
    Marks,
    /// The bends drawn go the other way.
    OtherWay,
    /// The part has no pieces.
    NoPieces,
    /// The pieces belong to several chains.
    SeveralChains,
    /// The part does not have all its pieces.
    Incomplete,
    /// A piece cannot be laid beside the others.
    Beside,
    /// A joint is none of the pieces'.
    Joint,
    /// The pieces do not hang together.
    Apart,
    /// The edges of the pieces do not bound them.
    Edges,
}

/// What is drawn flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A panel.
    Panel,
    /// A chain of strips.
    Strips,
    /// Cones, cylinders and planes.
    Pieces,
}

/// Why a file does not hold what was judged.
#[derive(Clone, Debug, PartialEq)]
pub enum WrittenFault {
    /// The reader's complaint.
    Unreadable(String),
    /// So many faces or pieces for so many others.
    Number {
        /// In the file.
        found: usize,
        /// Judged.
        wanted: usize,
        /// What was judged.
        of: Near,
    },
    /// A panel has so many faces.
    Faces(usize),
    /// A record has the name of another thing.
    Name {
        /// Its number.
        entity: u64,
        /// Its name.
        found: String,
        /// The name of what was judged.
        wanted: String,
    },
    /// So many things of a sort in a drawing instead of others.
    Counted {
        /// What.
        what: Drawn,
        /// In the drawing.
        found: usize,
        /// Judged.
        wanted: usize,
    },
    /// Something is another thing, or is none.
    Differs(Differs),
    /// A face is so far (mm) from what was judged.
    Moved(f64),
    /// A surface is so far (mm) from what was judged.
    SurfaceMoved(f64),
    /// Edges are so far (mm) from what was judged.
    EdgesMoved(f64),
    /// Why a piece has no patch of its own, as an error says it.
    Piece(String),
    /// The panels are not those that were judged.
    OtherPanels,
}

impl From<Differs> for WrittenFault {
    fn from(what: Differs) -> Self {
        Self::Differs(what)
    }
}

/// What faces and pieces of a file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Near {
    /// Panels.
    Panels,
    /// Strips.
    Strips,
    /// Pieces of chains of cones.
    Pieces,
    /// Patterns.
    Patterns,
}

/// What drawings hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// Contours.
    Contours,
    /// Outlines of formed features.
    Formed,
    /// Extents of bends.
    Extents,
    /// Rulings.
    Rulings,
    /// Marks.
    Marks,
    /// Sections.
    Sections,
    /// Curves of the model.
    Curves,
    /// Joints of an outline.
    Joints,
    /// Corners of a section or a curve.
    Corners,
}

/// What in a file is another thing than what was judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Differs {
    /// The normal is on the wrong side.
    Normal,
    /// Loops are missing.
    Loops,
    /// The face has several loops.
    SeveralLoops,
    /// Edges are missing.
    Edges,
    /// The patch is not ruled.
    NotRuled,
    /// An edge does not begin where the one before ends.
    Follows,
    /// An edge runs the other way.
    EdgeSense,
    /// An edge is another one.
    Edge,
    /// An edge or its trimming curve is another one.
    EdgeOrTrim,
    /// An edge is of another kind.
    EdgeKind,
    /// An edge is none.
    NoEdge,
    /// A ruling is none.
    NoRuling,
    /// A vertex is not at the end of its edges.
    VertexOff,
    /// A vertex is another one.
    Vertex,
    /// The knots of a surface are others.
    Knots,
    /// The weights of a surface are others.
    Weights,
    /// A control point is not a finite number.
    ControlPoint,
    /// The surface is another one.
    Surface,
    /// The surface is a spline.
    Spline,
    /// The surface is neither a spline nor a plane.
    SurfaceKind,
    /// The plane is none.
    NoPlane,
    /// The piece is none.
    NoPiece,
    /// The piece turns too far.
    Turns,
    /// The piece does not lie on its own surface.
    OffOwnSurface,
    /// A coordinate is not a finite number.
    Coordinate,
    /// The outline has no extent.
    NoExtent,
    /// A hole is no circle.
    NoCircle,
    /// A bend line goes the other way.
    BendSense,
    /// An arc is none.
    NoArc,
}
