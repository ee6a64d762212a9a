//! Spline developables, ruled strips and their composites: strips between boundary curves, joined along curves and rulings,
//! that one can pull on \[W15, TBWP16\].
//!
//! A [`Composite`] says what belongs together; a [`Session`] holds it while handles move. Common boundary curves are common
//! unknowns, and so are common rulings. Strips are developable at as many rulings as make them exactly so; that the regression
//! curve keeps off is an equation, too. See `docs/algorithms/constraint.md`.

mod build;
mod built;
mod check;
mod facet;
mod freedom;
mod handle;
mod identify;
mod join;
mod session;
#[cfg(test)]
mod tests;

pub use check::{At, CompositeError};
pub use handle::{Handle, Hold, Place, Strength};
pub use session::{Report, Session};

use crate::constraint::border::Border;
use crate::constraint::reference::Reference;
use crate::spline::curve::Curve;
use std::sync::Arc;

/// How a session solves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest row that counts as zero while editing, as a share of the size of all curves; default 1e-6.
    pub tolerance: f64,
    /// Weight of differences of control points, which regularise; default 1.
    pub fairness: f64,
    /// How much smoother displacements are preferred to rough ones; default 0. With more, steps
    /// are slower: control points of splines are smooth by themselves.
    pub smoothness: f64,
    /// Whether more conditions than free coordinates are allowed, which may still be met where they depend on each other, as
    /// in many narrow strips along conjugate curves; default false.
    pub redundant: bool,
}

/// Largest row that counts as zero while editing, as a share of the size of all curves: a micrometre over a metre.
const TOLERANCE: f64 = 1e-6;
impl Default for Options {
    fn default() -> Self {
        Self { tolerance: TOLERANCE, fairness: 1.0, smoothness: 0.0, redundant: false }
    }
}

/// A boundary curve of one strip or two; the same curve in two strips joins them.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryCurve {
    /// Name, unique among the curves.
    pub name: String,
    /// Degree, knots and control points, mm. Knots are clamped.
    pub curve: Curve<3>,
    /// Whether all its control points stay.
    pub fixed: bool,
}

/// What a strip must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StripShape {
    /// Developable, with the regression curve away from the strip by at least `margin` times the ruling's length.
    Developable {
        /// Share of the ruling, 0 or more. Asked for at the rulings where developability is asked for; what lies between is for
        /// the judge.
        margin: f64,
    },
    /// Part of a plane.
    Planar,
    /// Ruled, whatever its rulings do: nothing is asked of them.
    Ruled,
}

/// A ruled strip between two boundary curves over the same knots.
#[derive(Clone, Debug, PartialEq)]
pub struct RuledStrip {
    /// Name, unique among the strips.
    pub name: String,
    /// Names of the curves `v = 0` and `v = 1`.
    pub sides: [String; 2],
    /// What it must be.
    pub shape: StripShape,
}

/// How smoothly two strips meet along a ruling, or two curves at their ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothness {
    /// They meet.
    G0,
    /// The boundary curves go on in their direction, and there is one tangent plane at every place of the ruling.
    G1,
    /// Normal curvatures of developables are equal, too.
    G2,
    /// The first leg of the control polygon goes on in the direction of the last one, so many times as long: linear, and
    /// with one ratio for both sides of a strip, the tangent planes of ruled strips agree all along the ruling.
    C1 {
        /// Length of the first leg after the join, in lengths of the last leg before it.
        ratio: f64,
    },
}

/// How two strips that share a boundary curve meet there. Without any of these they meet at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// They unfold to one sheet: the curve is a crease.
    Fold,
    /// They have one tangent plane along it.
    Smooth,
}

/// A condition where strips meet.
#[derive(Clone, Debug, PartialEq)]
pub enum Join {
    /// The last ruling of one strip is the first of another.
    Ruling {
        /// Name of the strip that ends.
        first: String,
        /// Name of the strip that begins; may be the same one, which is then closed.
        second: String,
        /// How smoothly.
        smoothness: Smoothness,
    },
    /// Along a boundary curve that two strips share.
    Curve {
        /// Its name.
        curve: String,
        /// How they meet.
        edge: Edge,
    },
    /// Two curves meet at their ends.
    Ends {
        /// An end of one curve and an end of the other.
        ends: [Place; 2],
        /// How smoothly; not G2.
        smoothness: Smoothness,
    },
}

/// A planar piece, straight from corner to corner; all curves that end at a corner leave it within the plane, so that
/// strips whose last ruling is a side of it go on smoothly \[W15, figure 2.4\].
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Name, unique among strips and facets.
    pub name: String,
    /// Three or four corners in order, each an end of a curve.
    pub corners: Vec<Place>,
    /// For triangles: curves leave a corner parallel to the opposite side, so many times as far as it is long, in the way
    /// that they do at the start. Linear, but nothing else is left to choose. Default none: any direction within the plane.
    pub alpha: Option<f64>,
}

/// A surface that strips should be near.
#[derive(Clone)]
pub struct Target {
    /// Names of the strips; none: all.
    pub strips: Vec<String>,
    /// The surface, mm.
    pub reference: Arc<dyn Reference>,
    /// Its border, if all of it must be near the strips: their border is drawn to it. Default none.
    pub border: Option<Arc<Border>>,
    /// Weight at the beginning of a solve, from which it falls.
    pub weight: f64,
}

/// Two points of curves at a given distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Length {
    /// The places.
    pub between: [Place; 2],
    /// Distance, mm; positive.
    pub length: f64,
}

/// Strips and what holds them together.
#[derive(Clone, Default)]
pub struct Composite {
    /// Boundary curves.
    pub curves: Vec<BoundaryCurve>,
    /// Strips between them.
    pub strips: Vec<RuledStrip>,
    /// Planar pieces between ends of curves.
    pub facets: Vec<Facet>,
    /// Conditions where strips meet.
    pub joins: Vec<Join>,
    /// What is held.
    pub handles: Vec<Handle>,
    /// Distances that are kept.
    pub lengths: Vec<Length>,
    /// Surfaces that strips should be near.
    pub targets: Vec<Target>,
}

impl Composite {
    /// Index of a curve.
    pub fn curve(&self, name: &str) -> Option<usize> {
        self.curves.iter().position(|c| c.name == name)
    }

    /// Index of a strip.
    pub fn strip(&self, name: &str) -> Option<usize> {
        self.strips.iter().position(|s| s.name == name)
    }

    /// Whether nothing has to be developable: then rows are linear, or nearly so, and weighted least squares solve them.
    pub fn is_ruled(&self) -> bool {
        !self.strips.iter().any(|s| matches!(s.shape, StripShape::Developable { .. }))
    }
}
