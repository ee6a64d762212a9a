//! Which rulings are drawn on a pattern, and how the sheet bends about each: sense, angle and radius.
//!
//! *Method* (docs/algorithms/panels.md, "Bend lines"). The tangent plane is followed across the rulings. Lines lie at
//! equal turns, but no nearer and no farther than asked for, and none where the sheet is flat. Where the part is to be kinked
//! on a press brake, lines are the kinks (docs/algorithms/shop.md, "Facets").

mod dense;
mod turn_profile;

use crate::geom::{Vec2, Vec3};
use crate::num::quadrature::GAUSS_4;
use crate::patchwork::pattern::Bend;
use crate::spline::surface::Surface;
pub(crate) use dense::{dense, dense_cells, Cell, DevelopedRuling};
pub(crate) use turn_profile::{ProfileLine, TurnProfile};

/// How far apart rulings are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendSpacing {
    /// Turn of the sheet from one line to the next, rad; default 5°.
    pub step: f64,
    /// Distance between lines at least, as a share of the pattern's length; default 1/100.
    pub least: f64,
    /// And at most; default 1/20.
    pub greatest: f64,
    /// Kinks in place of evenly drawn lines; default none.
    pub facets: Option<Facets>,
    /// Whether more lines are drawn where the sheet bends too unevenly for the part to be bent back from them; default yes.
    pub dense: bool,
    /// How near (mm) the part that is bent back from its lines is to come; a job's own share of its tolerance, default
    /// infinite: no line is drawn for that.
    pub within: f64,
}

impl BendSpacing {
    /// The same for a job with a tolerance (mm).
    pub(crate) fn of_job(self, tolerance: f64) -> Self {
        let within = if self.dense { REFOLDS * tolerance } else { f64::INFINITY };
        Self { within, ..self }
    }
}

/// Share of a job's tolerance within which its parts are to come back from their lines.
const REFOLDS: f64 = 0.25;

/// How a curved part is kinked: every kink takes the turn of a stretch of the part in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facets {
    /// So many kinks over the turn of the part.
    Count(usize),
    /// A kink for every such turn, rad.
    Turn(f64),
    /// As many that the arcs rise no higher above the facets than so many mm.
    Chord(f64),
    /// A kink for every such length along the curved stretches, mm.
    Length(f64),
}

impl Facets {
    /// Kinks (a fraction) for a stretch of a turn (rad, not negative) and a length (mm) of a part whose whole turn is `whole`.
    pub(crate) fn needed(self, turn: f64, length: f64, whole: f64) -> f64 {
        match self {
            Self::Count(n) => n as f64 * turn / whole,
            Self::Turn(step) => turn / step,
            // An arc of radius R rises by about R θ²/8 over a chord that it turns by θ on; R is length over turn.
            Self::Chord(height) => (turn * length / (8.0 * height)).sqrt(),
            Self::Length(step) => length / step,
        }
    }
}

impl Default for BendSpacing {
    fn default() -> Self {
        Self {
            step: 5.0f64.to_radians(),
            least: 0.01,
            greatest: 0.05,
            facets: None,
            dense: true,
            within: f64::INFINITY,
        }
    }
}

/// Lines drawn and how the sheet bends about each.
pub(crate) type Lines = (Vec<[Vec2; 2]>, Vec<Bend>);

/// Height (mm) of the arc over the facets at a kink, with the greater of its radii.
pub(crate) fn sagitta(bend: &Bend) -> f64 {
    let radius = bend.radii.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    radius * (1.0 - (0.5 * bend.angle).cos())
}

/// Draws lines; where kinks are to keep arcs low, again with more of them until they are low at both ends of all rulings: the
/// first count looks at their middles.
pub(crate) fn kept_low(spacing: &BendSpacing, draw: impl Fn(&BendSpacing) -> Lines) -> Lines {
    let Some(Facets::Chord(height)) = spacing.facets else { return draw(spacing) };
    let mut asked = height;
    let mut out = draw(spacing);
    for _ in 0..ROUNDS {
        let worst = out.1.iter().map(sagitta).fold(0.0, f64::max);
        if worst <= height {
            break;
        }
        asked *= LOWER * height / worst;
        out = draw(&BendSpacing { facets: Some(Facets::Chord(asked)), ..*spacing });
    }
    out
}

/// Times that kinks are drawn again.
const ROUNDS: usize = 4;
/// Share of what is needed that is asked for then, so that few rounds do.
const LOWER: f64 = 0.98;

/// The tangent plane in a place of the sheet, as seen from the side of the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// Unit normal towards the eye.
    pub normal: Vec3,
    /// Unit vector square to the ruling, onwards.
    pub across: Vec3,
}

impl Plane {
    /// The plane of a ruled patch at `(t, r)`; `side` as in [`super::map::Development::new`]. `None` where it is not
    /// regular.
    pub(crate) fn of(patch: &Surface, t: f64, r: f64, side: f64) -> Option<Self> {
        let j = patch.jet(t, r);
        let normal = (j.dv.cross(&j.du) * side).try_normalize(0.0)?;
        let along = j.dv.try_normalize(0.0)?;
        Some(Self { normal, across: (j.du - along * along.dot(&j.du)).try_normalize(0.0)? })
    }

    /// Turn of the sheet (rad) on the way to another plane; positive towards the eye.
    pub(crate) fn turn(&self, other: &Self) -> f64 {
        let angle = self.normal.angle(&other.normal);
        if (other.normal - self.normal).dot(&(self.across + other.across)) > 0.0 {
            -angle
        } else {
            angle
        }
    }
}

/// Rate at which a ruled patch turns by its rulings at `t`, rad; positive towards the eye, `side` as for [`Plane::of`].
fn rate(patch: &Surface, t: f64, side: f64) -> f64 {
    let Some(plane) = Plane::of(patch, t, 0.5, side) else { return f64::NAN };
    let j = patch.jet(t, 0.5);
    j.duu.dot(&plane.normal) / j.du.dot(&plane.across)
}

/// Turn of a patch between two of its rulings, with its rates at both ends times the way: by quadrature where that is what
/// planes seen at both ends say, else what these say.
pub(crate) fn turn_between(patch: &Surface, [a, b]: [f64; 2], side: f64, seen: f64) -> (f64, Option<[f64; 2]>) {
    let found = GAUSS_4.integrate(a, b, |t| rate(patch, t, side));
    if (found - seen).abs() <= SEEN * seen.abs() + f64::EPSILON.sqrt() {
        (found, Some([a, b].map(|t| rate(patch, t, side) * (b - a))))
    } else {
        (seen, None)
    }
}

/// Share by which turns seen in planes may differ from those found by quadrature: beyond, something folds between.
const SEEN: f64 = 0.05;

/// Share of the speed at the other end of a ruling below which an end stands still: the apex of a cone.
const APEX: f64 = 1e-9;

/// Radius of curvature of a ruled patch across its rulings at `(t, r)`, mm; 0 in the apex of a cone.
pub(crate) fn radius(patch: &Surface, t: f64, r: f64) -> f64 {
    let j = patch.jet(t, r);
    // In an apex nothing is left but rounding.
    if r != 0.5 && j.du.norm() <= APEX * patch.jet(t, 1.0 - r).du.norm() {
        return 0.0;
    }
    let (Some(n), Some(along)) = (j.normal().try_normalize(0.0), j.dv.try_normalize(0.0)) else { return 0.0 };
    let across = j.du - along * along.dot(&j.du);
    across.norm_squared() / n.dot(&j.duu).abs()
}
