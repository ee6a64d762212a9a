//! Why strips and jobs are not what was asked for.

use super::{Item, Reason};
use crate::geom::unit::LengthUnit;
use crate::geom::Vec3;

/// A strip, and a place on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// Name of the strip.
    pub strip: String,
    /// Where, mm.
    pub at: Vec3,
}

/// Of strips.
#[derive(Clone, Debug, PartialEq)]
pub enum StripReason {
    /// No strip could be made.
    None,
    /// Nothing bounds its distance from the curves or its twist.
    Unbounded,
    /// Nor of so many more strips.
    MoreUnbounded(usize),
    /// So many strips are not written.
    NotWritten(usize),
    /// The hull has no developable strips.
    NoHull,
    /// Strips and the hull of points on the curves are farther apart than these and the tolerance explain.
    NotTheHull {
        /// How far, mm.
        by: f64,
        /// Where, mm.
        at: Vec3,
    },
    /// So many strips are too many after a stop.
    TooMany(usize),
    /// Strips stray from curves.
    Stray {
        /// How far at most, mm.
        by: f64,
        /// From which.
        from: Curves,
        /// Which strip does by most.
        most: Option<Witness>,
    },
    /// Strips of a loft stray from a rail; a larger tolerance is met.
    OffRail {
        /// How far at most, mm.
        by: f64,
        /// Name of the rail.
        rail: String,
        /// Which strip does by most.
        most: Option<Witness>,
    },
    /// Rails, by name, are covered in part, or strips run past their ends.
    InPart(Vec<(String, Covered)>),
    /// The strip is narrower than asked for: wider, it would meet its regression curve.
    Narrower {
        /// Length of the first ruling, mm.
        width: f64,
        /// That was asked for, mm.
        asked: f64,
    },
    /// Strips are twisted.
    Twist {
        /// Measured, rad.
        measured: f64,
        /// Proven, rad.
        bound: f64,
        /// What counts as developable, rad.
        limit: f64,
        /// Where the greatest twist was measured.
        most: Option<Witness>,
    },
    /// A strip has regression points between its rails.
    Regression {
        /// Its name.
        strip: String,
        /// Middle of the ruling that was found to have them.
        at: Vec3,
    },
    /// A strip was not shown to keep off its regression curve.
    MayRegress {
        /// Its name.
        strip: String,
        /// Middle of the ruling that comes nearest to it, as measured.
        at: Vec3,
    },
    /// A regression curve that is not known to keep to what was asked.
    OutOfBounds {
        /// Name of the strip.
        strip: String,
        /// Where, or near which ruling's middle that is undecided, mm.
        at: Vec3,
        /// Whether it is out of bounds there.
        proven: bool,
    },
    /// A strip keeps off its regression curve by less than was asked.
    Margin {
        /// Its name.
        strip: String,
        /// Shown, in lengths of the ruling.
        shown: f64,
        /// Asked for, in lengths of the ruling.
        asked: f64,
    },
    /// A net meets its regression curve.
    NetRegression {
        /// Name of the strip.
        strip: String,
        /// On which ruling.
        u: f64,
        /// At which share of its length.
        v: f64,
        /// Where that is.
        at: Vec3,
    },
    /// A net has a ruling tangent to its curve.
    TangentRuling {
        /// Name of the strip.
        strip: String,
        /// Name of the curve.
        curve: String,
        /// Which ruling.
        u: f64,
        /// Where that is.
        at: Vec3,
    },
    /// A net has a weight that it must not have.
    Weight {
        /// Name of the strip.
        strip: String,
        /// The weight.
        weight: f64,
        /// Of which control point.
        index: usize,
    },
    /// No developable is near enough.
    NotFollowed {
        /// Tolerance, mm.
        tolerance: f64,
        /// Whether the first and the last element were to be kept.
        fixed_ends: bool,
        /// Weight of smoothing.
        smoothing: Option<f64>,
        /// How near one comes that keeps to the limits of its regression curve, mm, infinite if none does; `None` where
        /// that is not the matter.
        kept_off: Option<f64>,
    },
    /// Points around a place have no strip.
    PointsAround {
        /// How many.
        count: f64,
        /// Where.
        at: Vec3,
        /// Why.
        why: Box<Reason>,
    },
    /// So many points have no strip, and why if that is known.
    Points(usize, Option<Box<Reason>>),
    /// A developable that was found gives no strip.
    NoStrip {
        /// Which kind.
        kind: &'static str,
        /// What the error says.
        error: Box<Reason>,
    },
    /// The outline is not cut.
    Blank(Box<Reason>),
    /// Nothing is proven of the outline.
    NoOutline(Box<Reason>),
    /// Edges run through the vertex of their cone.
    Vertex,
    /// Nothing was tried.
    Nothing,
    /// No chain of cones was found.
    NoCones,
    /// Nothing is proven of how an outline was cut.
    NoProof,
    /// A chain of cones is not proven to keep within the tolerance.
    Beyond(f64),
    /// Pieces of a chain are missing.
    NotComplete,
    /// A point is not shown to lie near what an outline leaves of the strip.
    PointOutside {
        /// How near it should, mm.
        within: f64,
        /// Number and place of the farthest.
        worst: Option<(usize, Vec3)>,
    },
    /// An end of a given ruling is not shown to lie near what an outline leaves of the strip.
    EndOutside {
        /// How near it should, mm.
        within: f64,
        /// The farthest.
        worst: Option<Vec3>,
    },
    /// A strip as it is cut and its face are not shown to lie near each other.
    FromFace {
        /// How near they should, mm.
        within: f64,
        /// The greatest distance that was seen, mm, and where.
        seen: Option<(f64, Vec3)>,
    },
    /// An outline is not shown to keep to the points.
    OutlineOutside {
        /// How near it should, mm.
        within: f64,
        /// About where it is farthest.
        at: Option<Vec3>,
    },
    /// An outline of which something is missing.
    Outline(super::LoopFault, Option<Vec3>),
}

/// How much of a rail is covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Covered {
    /// A share of it.
    Share(f64),
    /// All of it, and so much past its ends, mm.
    Past(f64),
}

/// Curves that strips should keep to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Curves {
    /// All that are given.
    All,
    /// Those that are fixed.
    Fixed,
    /// The one of a name.
    One(String),
}

/// What strips are fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// Measured points.
    Points,
    /// Rulings.
    Rulings,
    /// Tangent planes.
    Planes,
}

/// Of a job as a whole.
#[derive(Clone, Debug, PartialEq)]
pub enum JobReason {
    /// It ended early; what was found is proven within so much (mm), if that is known and more than was asked.
    EndedEarly(Option<f64>),
    /// It was stopped early.
    Stopped,
    /// It was stopped before all surfaces were done.
    StoppedCones,
    /// It was stopped after so many of so many levels.
    Levels(usize, usize),
    /// It was stopped before all points, rulings or planes were judged.
    NotAllJudged(Sort),
    /// No developable strip follows them.
    Unfollowed(Sort),
    /// Some are farther than the tolerance.
    Beyond {
        /// Which.
        sort: Sort,
        /// How many.
        beyond: usize,
        /// Of how many.
        all: usize,
        /// Tolerance, mm.
        tolerance: f64,
        /// Number of the worst.
        worst: usize,
        /// Its place.
        at: Vec3,
        /// How far it is away, mm.
        away: f64,
    },
    /// The others agree on a surface without it.
    Outlier {
        /// What it is.
        sort: Sort,
        /// Its number.
        index: usize,
        /// How far away it is, mm.
        away: f64,
    },
    /// The plane given with a ruling is not the tangent plane there.
    Turned {
        /// Number of the ruling.
        index: usize,
        /// The angle between both, rad.
        angle: f64,
        /// What counts as the same plane, rad.
        limit: f64,
    },
    /// The strips end before the place that is given with a plane.
    Before {
        /// Number of the plane.
        index: usize,
        /// Its place.
        at: Vec3,
        /// How far that is from the strips, mm.
        away: f64,
    },
    /// A share of the places on a mesh have no strip near them, for example one.
    Bare(f64, Vec3),
    /// Conditions ask for more than there is.
    Unmet {
        /// Which conditions.
        class: String,
        /// What is left, mm.
        left: f64,
        /// Where most of it is.
        item: String,
    },
    /// A move was not made to its end.
    Move {
        /// Its number.
        index: usize,
        /// Steps that were made.
        made: usize,
        /// Steps that were asked for.
        steps: usize,
    },
    /// A condition is off by so much, mm.
    Off(Item, f64),
    /// A curve runs against the direction that it is held to.
    Backwards(Item),
    /// Nothing is asked that could be proven.
    NothingAsked,
    /// The gap of a join is not shown to keep within the tolerance.
    JoinGap {
        /// Its number.
        index: usize,
        /// Names of both pieces.
        between: [String; 2],
    },
    /// Pieces that should go on smoothly meet at an angle.
    JoinAngle {
        /// Number of the join.
        index: usize,
        /// Names of both pieces.
        between: [String; 2],
        /// Largest angle seen, rad.
        seen: f64,
        /// What counts as none, rad.
        limit: f64,
    },
    /// Both sides of a fold do not fit together in the plane.
    Fold {
        /// Number of the join.
        index: usize,
        /// Names of both pieces.
        between: [String; 2],
        /// How far the edges are shown to be apart at most, mm.
        apart: f64,
    },
    /// A target is not met.
    Target {
        /// Its number.
        index: usize,
        /// Its file, if it has one.
        file: Option<String>,
        /// Distance seen, mm.
        apart: f64,
        /// Where.
        at: Vec3,
        /// Distance allowed, mm.
        within: f64,
        /// Whether all of it should be covered.
        covered: bool,
    },
    /// A ruling, counted from 1, and the next one cross.
    Crossing(usize),
    /// Points moved farther (mm) than allowed.
    Moved(f64, f64),
    /// Diagonals are so far (mm) apart, and why.
    Diagonals(f64, Option<Stalled>),
    /// A part is sheet of another thickness than was asked for.
    Thickness {
        /// Name of the part.
        part: String,
        /// Its thickness, mm.
        own: f64,
        /// Asked for, mm.
        asked: f64,
        /// In which unit that is told.
        unit: LengthUnit,
    },
    /// A part bends so tightly that a sheet has no room inside.
    NoRoom {
        /// Name of the part.
        part: String,
        /// Thickness asked for, mm.
        asked: f64,
        /// In which unit that is told.
        unit: LengthUnit,
    },
    /// A part is not drawn as the neutral fibre of its sheet lies, although that has another length.
    NotNeutral {
        /// Name of the part.
        part: String,
    },
    /// The panels that cones were made of are not certified, and why.
    Panels(Vec<Reason>),
}

/// Why planarisation did not end with plane quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stalled {
    /// No displacement makes them plane.
    Rulings,
    /// The held points leave no room.
    Held,
    /// The steps are used up.
    Steps,
}
