//! What a job says about its result, and how it is known. A job's status is computed from its claims and from nothing
//! else (docs/algorithms/certificate.md).
//!
//! Only this floor can make an [`UpperBound`] or a [`LowerBound`] that says more than "nothing is known", and a claim
//! is [`Evidence::Proven`] only if it was made of one. Bounds can be joined and weakened anywhere, never strengthened.

use crate::geom::Vec3;
use crate::reason::Reason;

/// A proven upper bound; infinite where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpperBound(f64);

/// A proven lower bound of a quantity that is not negative; 0 where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowerBound(f64);

impl UpperBound {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self(f64::INFINITY);

    /// A bound for tests of what is made of bounds.
    #[cfg(test)]
    pub(crate) fn nothing() -> Self {
        Self(0.0)
    }

    /// What has been shown by enclosing it; not a number and negative numbers show nothing.
    pub(super) fn shown(value: f64) -> Self {
        if value >= 0.0 {
            Self(value)
        } else {
            Self::UNKNOWN
        }
    }

    /// The bound; infinite where nothing is known.
    pub fn value(self) -> f64 {
        self.0
    }

    /// A bound of the larger of both quantities.
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// A bound of the sum of both quantities.
    pub fn plus(self, other: Self) -> Self {
        Self((self.0 + other.0).next_up())
    }

    /// A bound of an angle between two directions in rad as one in degrees.
    pub fn degrees(self) -> Self {
        // No angle stays none, and none is larger than half a turn; what is not known stays so.
        let degrees = if self.0 > 0.0 { self.0.to_degrees().next_up() } else { 0.0 };
        Self(if degrees.is_finite() { degrees.min(180.0) } else { degrees })
    }

    /// A bound of the largest of several quantities; of none, nothing is known.
    pub fn largest(all: impl IntoIterator<Item = Self>) -> Self {
        all.into_iter().reduce(Self::max).unwrap_or(Self::UNKNOWN)
    }
}

impl LowerBound {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self(0.0);

    /// What has been shown by enclosing it; not a number and negative numbers show nothing.
    pub(super) fn shown(value: f64) -> Self {
        if value >= 0.0 {
            Self(value)
        } else {
            Self::UNKNOWN
        }
    }

    /// The bound; infinite where there is nothing that could be near.
    pub fn value(self) -> f64 {
        self.0
    }

    /// A bound of the smaller of both quantities.
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// A bound of the smallest of several quantities; of none, nothing is known.
    pub fn smallest(all: impl IntoIterator<Item = Self>) -> Self {
        all.into_iter().reduce(Self::min).unwrap_or(Self::UNKNOWN)
    }
}

/// How a value is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Shown for every point.
    Proven,
    /// The largest, the smallest or the mean of samples.
    Measured,
    /// Asked for, counted or defined.
    Given,
}

/// What a claim is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// The whole result.
    Whole,
    /// A panel or strip, by its index.
    Panel(usize),
    /// A part as it is cut, by its index.
    Part(usize),
}

/// What is claimed. The unit belongs to it, see [`What::unit`]; words are made by the writers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum What {
    /// Two-sided distance between surface and panels, mm.
    Deviation,
    /// Distance of the edges from a given curve, by its number, mm.
    FromCurve(usize),
    /// Distance of the edge on the first (0) or the second (1) side from its curve, mm.
    FromSide(usize),
    /// Distance of the edges from all given curves, mm.
    FromCurves,
    /// Distance of a measured point from the strips, mm.
    PointDistance,
    /// Distance of a measured point from the strips as they are cut back to their outlines, mm.
    BeyondOutline,
    /// Distance of a place of the strips from what was measured, mm.
    FromMeasured,
    /// Root mean square of the distances of points, mm.
    MeanPointDistance,
    /// Distance of a given ruling or plane from the strips, mm.
    ElementDistance,
    /// Angle between the plane given with a ruling and the tangent plane of its strip, degrees.
    ElementAngle,
    /// Distance of a place of the strips, as they are cut, from the stretches between neighbouring given rulings, mm.
    BeyondRulings,
    /// Distance of the ends of given rulings from the strips as they are cut, mm.
    EndDistance,
    /// Distance of the centres of given planes' regions from the strips, mm.
    CentreDistance,
    /// Two-sided distance between strips, as they are cut, and the faces that they take the place of, mm.
    FaceDistance,
    /// Distance between neighbouring given rulings, mm.
    RulingGap,
    /// Two-sided distance of strips from those that they were made of, mm.
    FromTaken,
    /// Distance of curves from what they were given as, mm.
    CurvesMoved,
    /// Two-sided distance from a target, by its number, mm.
    TargetDistance(usize),
    /// Gap between both sides of a join, by its number, mm.
    JoinGap(usize),
    /// Angle between the tangent planes along a join, by its number, degrees.
    JoinAngle(usize),
    /// Distance between both flat images of a fold, by the number of the join, mm.
    FoldGap(usize),
    /// Gap between the two sides of a seam, mm.
    SeamGap,
    /// Distance of faces from the planes, cylinders and cones that are laid flat for them, mm.
    MapSurfaceDistance,
    /// Distance between both flat images of an edge inside a part, mm.
    JointGap,
    /// Angle between the tangent planes along a ruling, degrees.
    Twist,
    /// Distance along rulings to the regression curve, mm.
    RegressionClearance,
    /// Distance along rulings to the regression curve, in lengths of the ruling.
    RegressionMargin,
    /// Radius of curvature, mm.
    BendRadius,
    /// Radius of curvature of the inside of a sheet, mm.
    InsideRadius,
    /// Distance between the diagonals of a quadrilateral, mm.
    DiagonalGap,
    /// Way of the given points until they are first plane, before refinement, mm.
    PointsMoved,
    /// Largest distance of the given points from the strip, mm.
    GivenDistance,
    /// Angle between neighbouring quadrilaterals at the first ruling, degrees.
    BendBefore,
    /// Largest angle between neighbouring quadrilaterals, degrees.
    LargestBend,
    /// Angle between neighbouring strips along their seams, degrees.
    Kink,
    /// Length of the longest ruling, mm.
    LongestRuling,
    /// Noise of a measurement, mm.
    Noise,
    /// Angle between the pieces of a chain at their joint, rad.
    JointMismatch,
    /// Way between the outline carried over and the trimmed edges that follow it, mm.
    OutlineDistance,
    /// Distance of the trims that were used from the file's edges, mm.
    TrimDistance,
    /// Distance of edges as written from the exact surfaces that they bound, mm.
    EdgeDistance,
    /// Turn of a piece about its axis, degrees.
    Turn,
    /// Length of the first ruling, mm.
    FirstRuling,
    /// Length of the last ruling, mm.
    LastRuling,
    /// Angle between given and found end rulings, degrees.
    EndRulingError,
    /// Shape number of a control net.
    NetShape(NetNumber),
    /// Share of a given curve that is used, by its number, percent.
    UsedOf(usize),
    /// Share of the faces that is covered, 1 for all.
    Coverage,
    /// Area in space, m².
    Area,
    /// Area of the flat patterns, m².
    FlatArea,
    /// Relative error of lengths on the flat patterns.
    LengthError,
    /// Distance of what is drawn (outline, rulings, marks) from the flat image of a panel, mm.
    DrawingDistance,
    /// Distance between a part bent back from its drawing and its panels, both ways and with the edges, mm.
    RefoldDistance,
    /// Distance between what a written file holds and what was judged, mm.
    WrittenDistance,
    /// A number of things.
    Count(Counted),
    /// What was asked for and is missing from the answer; [`Claim::reason`] says what.
    LeftOut,
    /// Something that stands against the status; [`Claim::reason`] says what.
    Objection,
    /// Something that stands against the status of the whole and says how much of it is certified.
    InPart,
}

/// The unit of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Lengths.
    Millimetre,
    /// Angles that people read.
    Degree,
    /// Angles between pieces of a chain.
    Radian,
    /// Shares of curves.
    Percent,
    /// Areas.
    SquareMetre,
    /// Plain numbers.
    One,
}

impl What {
    /// The unit in which it is told.
    pub fn unit(self) -> Unit {
        match self {
            Self::Twist
            | Self::BendBefore
            | Self::LargestBend
            | Self::Kink
            | Self::JoinAngle(_)
            | Self::ElementAngle
            | Self::Turn
            | Self::EndRulingError => Unit::Degree,
            Self::JointMismatch => Unit::Radian,
            Self::UsedOf(_) => Unit::Percent,
            Self::Area | Self::FlatArea => Unit::SquareMetre,
            Self::NetShape(_)
            | Self::RegressionMargin
            | Self::Coverage
            | Self::LengthError
            | Self::Count(_)
            | Self::LeftOut
            | Self::Objection
            | Self::InPart => Unit::One,
            Self::Deviation
            | Self::FromCurve(_)
            | Self::FromSide(_)
            | Self::FromCurves
            | Self::PointDistance
            | Self::MeanPointDistance
            | Self::ElementDistance
            | Self::BeyondRulings
            | Self::EndDistance
            | Self::CentreDistance
            | Self::FaceDistance
            | Self::RulingGap
            | Self::FromTaken
            | Self::CurvesMoved
            | Self::TargetDistance(_)
            | Self::JoinGap(_)
            | Self::SeamGap
            | Self::MapSurfaceDistance
            | Self::JointGap
            | Self::RegressionClearance
            | Self::BendRadius
            | Self::InsideRadius
            | Self::DiagonalGap
            | Self::PointsMoved
            | Self::GivenDistance
            | Self::Noise
            | Self::OutlineDistance
            | Self::DrawingDistance
            | Self::WrittenDistance
            | Self::RefoldDistance
            | Self::EdgeDistance
            | Self::BeyondOutline
            | Self::FromMeasured
            | Self::FoldGap(_)
            | Self::TrimDistance
            | Self::FirstRuling
            | Self::LongestRuling
            | Self::LastRuling => Unit::Millimetre,
        }
    }
}

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Counted {
    /// Panels.
    Panels,
    /// Strips.
    Strips,
    /// Strips ruled between the given curves themselves.
    ExactStrips,
    /// Strips whose edges were fitted.
    FittedStrips,
    /// Surfaces that were approximated.
    Surfaces,
    /// Cones.
    Cones,
    /// Cylinders.
    Cylinders,
    /// Planes.
    Planes,
    /// Measured points.
    Points,
    /// Given rulings.
    Rulings,
    /// Given tangent planes.
    TangentPlanes,
    /// Rulings and planes of a strip.
    Elements,
    /// Points, rulings or planes beyond the tolerance.
    Beyond,
    /// Elements left out as outliers.
    Outliers,
    /// Quadrilaterals.
    Quadrilaterals,
    /// Degree along the strip.
    Degree,
    /// Control points along the strip.
    ControlPoints,
    /// Regular polynomial solutions.
    Solutions,
}

/// Shape numbers of control nets (\[FJ07\], spec of nets).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetNumber {
    /// M*.
    MStar,
    /// Λ*.
    LambdaStar,
    /// m.
    M,
    /// κ.
    Kappa,
}

/// What a value must keep to, for the status.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Nothing is asked of it.
    None,
    /// It must not be larger.
    AtMost(f64),
    /// It must not be smaller.
    AtLeast(f64),
}

/// A statement about a result: what, of what, how large, in which unit, how it is known, what was asked of it, and where it is
/// seen.
///
/// # Example
/// ```
/// use torse::certify::claim::{Demand, Evidence, Subject};
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let proven = |c: &&torse::certify::claim::Claim| c.evidence() == Evidence::Proven && c.demand() != Demand::None;
/// assert!(answer.claims_of(Subject::Whole).filter(proven).count() > 0);
/// assert!(answer.claims().iter().all(|c| !c.is_broken()) && answer.status() == torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    what: What,
    subject: Subject,
    value: f64,
    evidence: Evidence,
    demand: Demand,
    reason: Option<Reason>,
    witness: Option<Vec3>,
    unknown: bool,
    lower: bool,
    in_parts: bool,
}

impl Claim {
    fn new(what: What, subject: Subject, value: f64, evidence: Evidence) -> Self {
        Self {
            what,
            subject,
            value,
            evidence,
            demand: Demand::None,
            reason: None,
            witness: None,
            unknown: false,
            lower: false,
            in_parts: false,
        }
    }

    /// A proven upper bound.
    pub(crate) fn at_most(what: What, subject: Subject, bound: UpperBound) -> Self {
        let unknown = bound == UpperBound::UNKNOWN;
        Self { unknown, ..Self::new(what, subject, bound.value(), Evidence::Proven) }
    }

    /// A proven lower bound.
    pub(crate) fn at_least(what: What, subject: Subject, bound: LowerBound) -> Self {
        let unknown = bound == LowerBound::UNKNOWN;
        Self { unknown, lower: true, ..Self::new(what, subject, bound.value(), Evidence::Proven) }
    }

    /// What samples showed.
    pub(crate) fn measured(what: What, subject: Subject, value: f64) -> Self {
        Self::new(what, subject, value, Evidence::Measured)
    }

    /// What was asked for or defined.
    pub(crate) fn given(what: What, subject: Subject, value: f64) -> Self {
        Self::new(what, subject, value, Evidence::Given)
    }

    /// A number of things.
    pub(crate) fn count(what: Counted, subject: Subject, number: usize) -> Self {
        Self::new(What::Count(what), subject, number as f64, Evidence::Given)
    }

    /// Something that stands against the status.
    pub(crate) fn objection(subject: Subject, reason: impl Into<Reason>) -> Self {
        Self::new(What::Objection, subject, 1.0, Evidence::Given).within(0.0).because(reason.into())
    }

    /// An objection that says how much of the whole is certified.
    pub(crate) fn in_part(reason: impl Into<Reason>) -> Self {
        Self { what: What::InPart, ..Self::objection(Subject::Whole, reason) }
    }

    /// Something that was asked for and is missing from the answer; what was made is as good as it is.
    pub(crate) fn left_out(reason: impl Into<Reason>) -> Self {
        Self { what: What::LeftOut, ..Self::objection(Subject::Whole, reason) }
    }

    /// Asks that the value be no larger than `limit`.
    pub(crate) fn within(mut self, limit: f64) -> Self {
        self.demand = Demand::AtMost(limit);
        self
    }

    /// Asks that the value be no smaller than `limit`.
    pub(crate) fn not_below(mut self, limit: f64) -> Self {
        self.demand = Demand::AtLeast(limit);
        self
    }

    /// Says what is the matter if the demand is not met.
    pub(crate) fn because(mut self, reason: impl Into<Option<Reason>>) -> Self {
        self.reason = reason.into();
        self
    }

    /// Says where it is seen, mm: a place where the value was found, or which resisted the proof.
    pub(crate) fn seen_at(mut self, place: Option<Vec3>) -> Self {
        self.witness = place;
        self
    }

    /// Says that what is claimed of the whole is no more than what is claimed of single parts: where it is broken, only those of
    /// which something of their own is broken are to blame.
    pub(crate) fn told_of_parts(mut self) -> Self {
        self.in_parts = true;
        self
    }

    /// The same about a panel that stands behind so many others now.
    pub(crate) fn after(mut self, panels: usize) -> Self {
        if let Subject::Panel(k) = self.subject {
            self.subject = Subject::Panel(k + panels);
        }
        self
    }

    /// What is claimed.
    pub fn what(&self) -> What {
        self.what
    }

    /// The unit of the value.
    pub fn unit(&self) -> Unit {
        self.what.unit()
    }

    /// Of what it is claimed.
    pub fn subject(&self) -> Subject {
        self.subject
    }

    /// The value, in its [`unit`](Self::unit); an infinite upper bound says that nothing is known, an infinite
    /// lower bound that nothing is near.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Whether a bound was looked for and nothing could be shown.
    pub fn is_unknown(&self) -> bool {
        self.unknown
    }

    /// Whether it is a lower bound; else what is proven is an upper one.
    pub fn is_lower_bound(&self) -> bool {
        self.lower
    }

    /// Whether a claim about the whole is no more than claims about single parts.
    pub(crate) fn is_told_of_parts(&self) -> bool {
        self.in_parts
    }

    /// How it is known.
    pub fn evidence(&self) -> Evidence {
        self.evidence
    }

    /// What was asked of it.
    pub fn demand(&self) -> Demand {
        self.demand
    }

    /// What is the matter if the demand is not met, where more is known than the number.
    pub fn reason(&self) -> Option<&Reason> {
        self.reason.as_ref()
    }

    /// Where it is seen, mm, if a place is known: its own, else that of the reason.
    pub fn witness(&self) -> Option<Vec3> {
        self.witness.or_else(|| self.reason.as_ref().and_then(Reason::place))
    }

    /// Whether what was asked of it is not shown: the value is beyond the limit, is no number, or was only measured.
    pub fn is_broken(&self) -> bool {
        let kept = match self.demand {
            Demand::None => return false,
            Demand::AtMost(limit) => self.value <= limit,
            Demand::AtLeast(limit) => self.value >= limit,
        };
        !kept || self.evidence == Evidence::Measured
    }
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Everything that was asked for is proven.
    Certified,
    /// Finished, but something is not proven or not kept.
    Uncertified,
}

impl Status {
    /// The status that claims give: certified if no demand is broken and at least one is met by proof.
    pub fn of<'a>(claims: impl IntoIterator<Item = &'a Claim>) -> Self {
        let proven = |c: &Claim| c.evidence == Evidence::Proven && c.demand != Demand::None;
        let (mut any, mut broken) = (false, false);
        for c in claims {
            any |= proven(c);
            broken |= c.is_broken();
        }
        if any && !broken {
            Self::Certified
        } else {
            Self::Uncertified
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reason::Unlaid;

    fn within(value: f64, limit: f64) -> Claim {
        Claim::at_most(What::Deviation, Subject::Whole, UpperBound::shown(value)).within(limit)
    }

    #[test]
    fn only_proofs_certify() {
        assert_eq!(Status::of(&[within(0.9, 1.0)]), Status::Certified);
        assert_eq!(Status::of(&[]), Status::Uncertified);
        assert_eq!(Status::of(&[within(1.1, 1.0)]), Status::Uncertified);
        assert_eq!(Status::of(&[within(f64::NAN, 1.0)]), Status::Uncertified);
        // Neither a number that was measured nor one that was given is a proof.
        let measured = Claim::measured(What::Deviation, Subject::Whole, 0.1);
        assert_eq!(Status::of(std::slice::from_ref(&measured)), Status::Uncertified);
        assert_eq!(Status::of(&[measured.clone(), within(0.9, 1.0)]), Status::Certified);
        assert_eq!(Status::of(&[measured.within(1.0), within(0.9, 1.0)]), Status::Uncertified);
        let given = Claim::given(What::Deviation, Subject::Whole, 0.1).within(1.0);
        assert_eq!(Status::of(&[given]), Status::Uncertified);
    }

    #[test]
    fn one_objection_is_enough() {
        let claims = [within(0.9, 1.0), Claim::objection(Subject::Panel(3), Unlaid::Panel)];
        assert_eq!(Status::of(&claims), Status::Uncertified);
        assert!(claims[1].is_broken() && claims[1].reason() == Some(&Unlaid::Panel.into()));
        assert_eq!(
            Status::of(&[within(0.9, 1.0), Claim::count(Counted::Beyond, Subject::Whole, 0).within(0.0)]),
            Status::Certified
        );
    }

    #[test]
    fn claims_tell_their_unit_and_where_they_are_seen() {
        let (own, of_reason) = (Vec3::x(), Vec3::y());
        let folds = crate::reason::PanelFault::Folds(of_reason);
        let claim = within(1.1, 1.0).because(crate::reason::Reason::from(folds));
        assert_eq!((claim.unit(), claim.witness()), (Unit::Millimetre, Some(of_reason)));
        assert_eq!(claim.seen_at(Some(own)).witness(), Some(own));
        assert_eq!(within(1.1, 1.0).witness(), None);
        let turned = Claim::at_most(What::Twist, Subject::Whole, UpperBound::shown(0.1).degrees());
        assert_eq!((turned.unit(), Claim::count(Counted::Panels, Subject::Whole, 3).unit()), (Unit::Degree, Unit::One));
    }

    #[test]
    fn bounds_are_joined_and_weakened_never_strengthened() {
        let (a, b) = (UpperBound::shown(0.25), UpperBound::shown(0.5));
        assert_eq!(a.max(b).value(), 0.5);
        assert!(a.plus(b).value() >= 0.75 && a.plus(UpperBound::UNKNOWN).value().is_infinite());
        assert_eq!(UpperBound::shown(-1.0), UpperBound::UNKNOWN);
        assert_eq!(UpperBound::shown(f64::NAN), UpperBound::UNKNOWN);
        assert_eq!(UpperBound::largest([a, b]), b);
        assert_eq!(UpperBound::largest([]), UpperBound::UNKNOWN);
        assert!(UpperBound::shown(std::f64::consts::PI).degrees().value() >= 180.0);
        assert_eq!(UpperBound::shown(0.0).degrees().value(), 0.0);
        assert!(UpperBound::UNKNOWN.degrees().value().is_infinite());
        let (a, b) = (LowerBound::shown(2.0), LowerBound::shown(3.0));
        assert_eq!(a.min(b).value(), 2.0);
        assert_eq!(a.min(LowerBound::UNKNOWN).value(), 0.0);
        assert!(Claim::at_least(What::BendRadius, Subject::Whole, LowerBound::shown(2.0)).is_lower_bound());
        assert!(!Claim::at_most(What::Deviation, Subject::Whole, UpperBound::shown(2.0)).is_lower_bound());
        assert_eq!(LowerBound::smallest([]), LowerBound::UNKNOWN);
        assert_eq!(LowerBound::shown(f64::NAN), LowerBound::UNKNOWN);
    }
}
