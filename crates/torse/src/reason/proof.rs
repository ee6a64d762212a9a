//! What proofs of panels that cover faces miss.

use crate::geom::Vec3;

/// What the proof of a patchwork misses.
#[derive(Clone, Debug, PartialEq)]
pub enum ProofFault {
    /// A tolerance that no double can prove at the size of the model.
    Precision {
        /// Tolerance asked for, mm.
        tolerance: f64,
        /// The smallest that can be proven, mm.
        least: f64,
    },
    /// What joining moved of a face is no bound.
    Joined {
        /// Index of the face.
        face: usize,
        /// What is said instead, mm.
        by: f64,
    },
    /// What a trim keeps from the file's edges is no bound.
    Trimmed {
        /// Index of the face.
        face: usize,
        /// What is said instead, mm.
        by: f64,
    },
    /// The regions of panels do not make up the faces.
    Cover {
        /// Index of the face, if it is one.
        face: Option<usize>,
        /// What is wrong.
        fault: CoverFault,
    },
    /// The gaps along seams are not known.
    Seams {
        /// Number of the seam.
        seam: usize,
        /// What is wrong.
        fault: SeamFault,
    },
    /// A panel is not proven.
    Panel(PanelFault),
    /// So many more panels are not.
    MorePanels(usize),
    /// The patchwork is another one.
    Another,
    /// A part was proven for a larger tolerance only.
    Larger,
    /// Some panel is not proven.
    SomePanel,
}

/// What the proof of a panel misses.
#[derive(Clone, Debug, PartialEq)]
pub enum PanelFault {
    /// Its torse is no C¹ spline of degree at most 3, or its patch not ruled with positive weights.
    NoTorse,
    /// Its patch is not ruled with positive weights.
    NotRuled,
    /// Its map to the face is no spline of finite numbers.
    NoMap,
    /// It covers no face.
    NoFace,
    /// It has no region.
    NoRegion,
    /// Its region and its loops do not go together.
    Cover(CoverFault),
    /// The regions of its face are not known to make up the face.
    OffFace,
    /// An edge in space, which begins at a place, cannot be compared with its trimming curve.
    Edge(Vec3),
    /// A trimming curve belongs to another foot.
    OtherFoot(Vec3),
    /// The bound (mm) exceeds the tolerance.
    TooLarge(f64),
    /// Its patch cannot be compared with its torse.
    OffTorse,
    /// Tangent planes along a ruling, the middle of which is given, may differ by so much, rad.
    Twisted(f64, Vec3),
    /// Its regression curve may lie inside, on the ruling whose middle is given.
    Regression(Vec3),
    /// Something of its trimming curves.
    Trim(LoopFault),
    /// Something of its trimming curves at a place.
    TrimAt(LoopFault, Vec3),
    /// Rounding and trimming curves use up the tolerance.
    UsedUp,
    /// The face is too far away.
    TooFar {
        /// How far, mm.
        away: f64,
        /// Where.
        at: Vec3,
        /// What rounding and trimming curves leave of the tolerance, mm, where it is within the tolerance.
        left: Option<f64>,
    },
    /// A box stands in the way of the proof.
    Obstructed(Obstruction, Vec3),
    /// The map to the face folds over, at a place.
    Folds(Vec3),
    /// It could not be shown that the map to the face does not fold over, at a place.
    MayFold(Vec3),
    /// The loops run about the wrong side.
    WrongSide,
    /// A bound (mm) above the tolerance is all that is proven; the panel is farthest at a place.
    Only(f64, Vec3),
}

/// Why a box could not be decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstruction {
    /// No unique foot point could be shown: the regression curve is near, or rulings leave the patch.
    Foot,
    /// The foot map may fold over.
    Fold,
    /// The surface's parametrisation degenerates.
    Degenerate,
    /// The bound stays above the tolerance down to the smallest box.
    Bound,
    /// Too many boxes.
    Budget,
    /// Cancelled or out of time.
    Stopped,
}

/// What is wrong with trimming curves, or could not be shown of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopFault {
    /// A curve leaves its patch.
    Leaves,
    /// A curve is no clamped cubic.
    NotCubic,
    /// A curve is no clamped cubic over `[0, 1]` with increasing vertex parameters.
    Malformed,
    /// A curve is empty.
    Empty,
    /// A run names a vertex that does not exist.
    NoVertex,
    /// A side of the region crosses a knot line.
    KnotLine,
    /// A curve is farther than the tolerance from the region's boundary.
    TooFar,
    /// A curve strays from the region's boundary.
    Strays,
    /// Curves do not join.
    Apart,
    /// There are none.
    None,
    /// A loop has no extent.
    NoExtent,
    /// A polygon has no extent.
    PolygonNoExtent,
    /// A polygon has no sides.
    NoSides,
    /// A loop meets itself or another one, or comes too near to tell.
    Meets,
    /// A hole turns like the outer loop.
    HoleSense,
    /// A hole lies outside.
    HoleOutside,
    /// A hole lies inside another.
    HoleInHole,
    /// The patch is not ruled.
    NotRuled,
    /// An edge could not be compared with its outline.
    OutlineEdge,
    /// An outline is no closed polygon.
    OutlineOpen,
    /// An outline leaves its patch.
    OutlineLeaves,
    /// An outline could not be shown not to meet itself.
    OutlineMeets,
    /// The proof was stopped.
    Stopped,
}

/// What keeps regions from making up a face. Numbers are indices.
#[derive(Clone, Debug, PartialEq)]
pub enum CoverFault {
    /// Faces and partitions differ in number.
    Partitions,
    /// Triangles and labels differ in number.
    Labels,
    /// A triangle names a vertex that does not exist.
    NoVertex(usize),
    /// A triangle with a first corner is not positively oriented.
    Orientation(usize, [f64; 2]),
    /// A triangle repeats an edge of another.
    Repeats(usize),
    /// Two vertices are at one place.
    SamePlace,
    /// A corner of a loop is no vertex.
    NoCorner(usize, usize),
    /// The boundary ends at a side of a loop.
    Ends(usize, usize),
    /// The boundary leaves a side of a loop.
    Leaves(usize, usize),
    /// So many edges lie on no loop.
    Open(usize),
    /// A panel belongs to no face.
    NoFace(String),
    /// A panel shares its region with another.
    Shared(String),
    /// A triangle of a face belongs to no panel.
    NoPanel(usize, usize),
    /// The panel has no triangles.
    NoTriangles,
    /// A loop is not closed after a run.
    NotClosed {
        /// Loop.
        of: usize,
        /// Run.
        run: usize,
    },
    /// A run leaves the boundary of the panel's triangles.
    RunLeaves {
        /// Loop.
        of: usize,
        /// Run.
        run: usize,
    },
    /// A run is called a seam and is a border, or the other way round.
    Miscalled {
        /// Loop.
        of: usize,
        /// Run.
        run: usize,
        /// Whether it is called a seam.
        seam: bool,
    },
    /// So many edges of the panel's triangles belong to no run.
    NoRun(usize),
}

/// Why the gap of a seam is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeamFault {
    /// It is not counted.
    Uncounted,
    /// It has so many sides.
    Sides(usize),
    /// Its sides do not mirror each other.
    NotMirrored,
    /// It lies between different faces.
    Faces,
    /// A side has no patch.
    NoPatch,
    /// It leaves a patch.
    Leaves,
}
