//! What the job of `torse unroll` is asked, and why there may be no answer.

use crate::develop::bends::{BendSpacing, Facets};
use crate::develop::shop::thickness::Sheet;
use crate::develop::unfold::allowance::{KFactor, KFactorError};
use crate::develop::unfold::tree::Joins;
use crate::geom::coarse::Loose;
use crate::pipeline::approximate::ApproximateError;

/// Share of the work that is done when all bodies are unfolded.
pub(super) const UNFOLDED: f64 = 0.5;

/// What the job is asked.
///
/// # Example
/// ```
/// use torse::develop::unfold::allowance::KFactor;
/// let bracket = torse::read(include_bytes!("../../../../../data/bracket.step"))?;
/// let area = |k: KFactor| {
///     let options = torse::UnrollOptions { k, ..torse::UnrollOptions::new(0.1) };
///     torse::unroll(&bracket, &options, &torse::Control::default()).map(|answer| answer.patterns()[0].area)
/// };
/// assert!(area(KFactor::Ansi(0.5))? > area(KFactor::Ansi(0.33))?, "the neutral fibre lies farther out");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct UnrollOptions {
    /// Distance (mm) between contours drawn and exact outlines; no default. Lines and arcs of the file stay what they are.
    pub tolerance: f64,
    /// Where the neutral fibre lies; default 0.44 (ANSI).
    pub k: KFactor,
    /// Takes all faces as surfaces without thickness; default false.
    pub surfaces: bool,
    /// The sheet that surfaces without thickness are made of: flat patterns are those of its neutral fibre. Default none.
    pub sheet: Option<Sheet>,
    /// Name of the input, for the files; default "model".
    pub input: String,
    /// How rolled faces are kinked; default none.
    pub facets: Option<Facets>,
    /// Turn of the sheet from one line of a rolled face to the next where it is not kinked, rad; default 5°. More are drawn where
    /// the part could not be bent back from these.
    pub bend_step: f64,
    /// Distance (mm) within which surfaces that are not developable are covered by panels; default none: they are left out.
    pub approximate: Option<f64>,
    /// Over which edges faces are laid beside each other; default all.
    pub joins: Joins,
}

impl UnrollOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            k: KFactor::default(),
            surfaces: false,
            sheet: None,
            input: "model".into(),
            facets: None,
            bend_step: BendSpacing::default().step,
            approximate: None,
            joins: Joins::All,
        }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnrollError {
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A K-factor that cannot be meant.
    #[error(transparent)]
    KFactor(#[from] KFactorError),
    /// No thickness, but a K-factor for it.
    #[error("a K-factor is for sheets with thickness; leave it out where faces are surfaces")]
    KWithoutThickness,
    /// A bend is asked for about an edge that is not there.
    #[error("no face has an edge #{0} to bend about")]
    Edge(u64),
    /// Thickness, but panels for faces without one.
    #[error("panels cover surfaces without thickness only")]
    CoversSurfacesOnly,
    /// Faces that are not developable cannot be covered.
    #[error("faces that are not developable cannot be covered: {0}")]
    Approximate(#[from] ApproximateError),
    /// Nothing but faces that are curved all around, about no axis.
    #[error("faces that are not developable cannot be covered: {0}")]
    Round(#[from] TooRound),
    /// Nothing can be laid flat.
    #[error("none of the {bodies} bodies can be unrolled; the first: {reason}")]
    Nothing {
        /// Number of bodies.
        bodies: usize,
        /// Why the first cannot.
        reason: String,
    },
}

/// A face that is curved both ways all around and does not go round an axis, as a whole ellipsoid of three different axes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "face #{entity} is curved both ways all around: its curvature adds up to {turns:.1} times that of a hemisphere; \
     'torse approximate' covers such faces, which takes minutes"
)]
pub struct TooRound {
    /// Entity number of the face.
    pub entity: u64,
    /// What its absolute Gaussian curvature adds up to, in 2π, measured.
    pub turns: f64,
}
