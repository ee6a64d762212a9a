//! Osculating cones, and the third cone that joins two of them \[LP98\].

use crate::geom::Vec3;
use crate::torse::cone::spline::{Segment, Shape};
use crate::torse::g1_element::G1Element;
use crate::torse::ruled_patch::StripJet;

/// A ruling with the cone or cylinder of revolution that osculates there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Osculating {
    /// The ruling.
    pub element: G1Element,
    /// Cone or cylinder; its angle means nothing.
    pub shape: Shape,
}

/// Sine of the half opening below which an osculating cone counts as cylinder.
pub(super) const CYLINDER: f64 = 1e-6;
/// A candidate whose end misses the second cone by more (rad, share of the distance) is no join: roots are exact to
/// rounding over the fourth power of the spacing, and this is far beyond that.
pub(super) const NOT_SMOOTH: f64 = 1e-8;

impl Osculating {
    /// The osculating cone (cylinder, plane) of a developable strip: frame equations `e' = θ p`, `n' = −η p`; vertex in
    /// the point of regression, axis along `η e + θ n`.
    pub fn of(element: &G1Element, jet: &StripJet) -> Self {
        let [a, b] = &jet.ends;
        let speed = 0.5 * (a[1] + b[1]).dot(&element.forward);
        let theta = (b[1] - a[1]).dot(&element.forward) / jet.length();
        let eta = 0.5 * (a[2] + b[2]).dot(&element.normal) / speed;
        let length = eta.hypot(theta);
        let shape = if theta.abs() < CYLINDER * length {
            Shape::Cylinder { radius: -speed / eta, angle: 0.0 }
        } else if length == 0.0 {
            Shape::Flat { width: 0.0 }
        } else {
            Shape::Cone {
                distance: speed / theta,
                cos_gamma: theta.signum() * eta / length,
                sin_gamma: theta.abs() / length,
                angle: 0.0,
            }
        };
        Self { element: *element, shape }
    }

    /// The piece from the ruling on by a signed angle about the axis.
    pub(super) fn piece(&self, angle: f64) -> Segment {
        let shape = match self.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, .. } => Shape::Cone { distance, cos_gamma, sin_gamma, angle },
            Shape::Cylinder { radius, .. } => Shape::Cylinder { radius, angle },
            Shape::Flat { .. } => Shape::Flat { width: angle },
        };
        Segment::new(self.element, shape)
    }
}

/// A cone between two osculating ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Join {
    /// Turn on the first cone from its element to the filler, rad, signed about its axis.
    pub first_angle: f64,
    /// Turn on the second cone from the filler to its element, rad, signed about its axis.
    pub second_angle: f64,
    /// The cone in between: from a ruling of the first cone to one of the second.
    pub filler: Segment,
}

impl Join {
    /// Pieces of the first cone, of the filler, and of the second cone up to its element.
    pub(super) fn segments(&self, first: &Osculating, second: &Osculating) -> [Segment; 3] {
        let lead = first.piece(self.first_angle);
        let tail = second.piece(-self.second_angle);
        let back = tail.end();
        let shape = match second.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, .. } => {
                Shape::Cone { distance, cos_gamma, sin_gamma, angle: self.second_angle }
            }
            Shape::Cylinder { radius, .. } => Shape::Cylinder { radius, angle: self.second_angle },
            flat @ Shape::Flat { .. } => flat,
        };
        [lead, self.filler, Segment::new(back, shape)]
    }
}

/// The two solutions of `a cos x + b sin x + c = 0` in (−π, π], none if there is none.
pub(super) fn trigonometric(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let r = a.hypot(b);
    let cosine = -c / r;
    if cosine.abs() > 1.0 || cosine.is_nan() {
        return None;
    }
    let (middle, half) = (b.atan2(a), cosine.acos());
    let wrap = |x: f64| x - std::f64::consts::TAU * (x / std::f64::consts::TAU).round();
    Some([wrap(middle - half), wrap(middle + half)])
}

/// Signed turn on a cone from its element to the ruling with the direction `g`.
pub(super) fn turn_to(cone: &Osculating, g: &Vec3) -> f64 {
    let local = cone.element.to_local(g);
    let Shape::Cone { cos_gamma: c, sin_gamma: s, .. } = cone.shape else { return 0.0 };
    // a = s² e − s c n and s p have length s.
    local.y.atan2(local.x * s - local.z * c)
}

/// The join that leaves the first cone after the turn `f`.
pub(super) fn through(first: &Osculating, second: &Osculating, f: f64) -> Option<Join> {
    let at = first.piece(f).end();
    let Shape::Cone { cos_gamma: k2, sin_gamma: s2, .. } = second.shape else { return None };
    let w2 = second.piece(0.0).axis();
    let (g1, p) = (at.direction, at.forward);
    // The partner from the condition of tangency, which has two roots; the lines meet at one of them only.
    let p2 = second.element.forward;
    let a2 = second.element.direction - w2 * k2;
    let roots = trigonometric(p.dot(&a2) + p2.dot(&g1), s2 * p.dot(&p2) - a2.dot(&g1) / s2, k2 * p.dot(&w2))?;
    let found = roots.iter().filter_map(|&turn| filler(f, &at, second, turn));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(smooth)
}

/// The cone between a ruling of the first cone and the ruling of the second after the turn `turn`.
/// With it, how far its last ruling and tangent plane are from those of the second cone.
pub(super) fn filler(first_angle: f64, at: &G1Element, second: &Osculating, turn: f64) -> Option<(Join, f64)> {
    let to = second.piece(turn).end();
    // Where the lines meet.
    let c = at.direction.cross(&to.direction);
    let d = to.point - at.point;
    let distance = -d.cross(&to.direction).dot(&c) / c.norm_squared();
    let delta = at.to_local(&(to.direction - at.direction));
    let n = delta.x.hypot(delta.z);
    let half = n.atan2(delta.y);
    let half = if delta.y < 0.0 { half - std::f64::consts::PI } else { half };
    if !(distance.is_finite() && n > 0.0) {
        return None;
    }
    let shape = Shape::Cone { distance, cos_gamma: delta.z / n, sin_gamma: -delta.x / n, angle: 2.0 * half };
    let filler = Segment::new(*at, shape);
    let off = filler.end().mismatch(&to, d.norm());
    off.is_finite().then_some((Join { first_angle, second_angle: -turn, filler }, off))
}

/// The join, if it is one.
pub(super) fn smooth((join, off): (Join, f64)) -> Option<Join> {
    (off < NOT_SMOOTH).then_some(join)
}
