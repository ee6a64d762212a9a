//! What is near or far: surfaces inside their trims, and triangles \[MKC09\].

use super::ground::Foot;
use crate::certify::polygon::Sides;
use crate::certify::tensor::{about, Jet2, Tensor};
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::spline::surface::Surface;

/// A piece whose points are looked at.
pub(super) struct Piece<'a>(Kind<'a>);

enum Kind<'a> {
    /// A surface; where polygons are given, only what they wind about.
    Surface {
        /// The surface.
        surface: &'a Surface,
        /// The same for proofs.
        tensor: Box<Tensor<'a, 4>>,
        /// Sides of closed polygons of its parameter plane; none: all of it.
        sides: Option<Sides<'a>>,
    },
    /// A flat triangle over the unit square: the first corner is its side `u = 0`.
    Triangle {
        /// The corners.
        corners: [Vec3; 3],
        /// Positions are relative to this in proofs.
        origin: [f64; 3],
        /// Where its nearest points may be.
        hint: Option<Foot>,
    },
}

impl<'a> Piece<'a> {
    /// A surface, or what the polygons of its parameter plane wind about; in proofs positions are relative to `origin`.
    pub fn surface(surface: &'a Surface, origin: [f64; 3], polygons: &'a [Vec<[f64; 2]>]) -> Self {
        let tensor = Tensor::new([&surface.knots_u, &surface.knots_v], about(&surface.control, origin));
        let sides = (!polygons.is_empty()).then(|| Sides::of(polygons));
        Self(Kind::Surface { surface, tensor: Box::new(tensor), sides })
    }

    /// A triangle, with the piece of the ground and the parameters on it where nearest points may be.
    pub fn triangle(corners: [Vec3; 3], origin: [f64; 3], hint: Option<(usize, [f64; 2])>) -> Self {
        let hint = hint.map(|(of, at)| Foot { of, at, distance: f64::INFINITY, border: None });
        Self(Kind::Triangle { corners, origin, hint })
    }

    pub(super) fn hint(&self) -> Option<&Foot> {
        match &self.0 {
            Kind::Triangle { hint, .. } => hint.as_ref(),
            Kind::Surface { .. } => None,
        }
    }

    /// Boxes between knots.
    pub(super) fn cells(&self) -> Vec<[Interval; 2]> {
        match &self.0 {
            Kind::Surface { tensor, .. } => {
                let [s, t] = tensor.breaks();
                let of = |w: &[f64]| Interval::new(w[0], w[1]);
                s.windows(2).flat_map(|s| t.windows(2).map(move |t| [of(s), of(t)])).collect()
            }
            Kind::Triangle { .. } => vec![[Interval::new(0.0, 1.0); 2]],
        }
    }

    /// Whether a box may hold points that count.
    pub(super) fn is_used(&self, box_: &[Interval; 2]) -> bool {
        match &self.0 {
            Kind::Surface { sides: Some(sides), .. } => sides.may_meet(box_) || self.holds(box_.map(Interval::mid)),
            _ => true,
        }
    }

    /// Corners of a polygon that holds all of a box that counts, up to ten digits of the parameters.
    pub(super) fn corners(&self, box_: &[Interval; 2]) -> Vec<[f64; 2]> {
        let [u, v] = box_;
        let all = [[u.lo, v.lo], [u.hi, v.lo], [u.hi, v.hi], [u.lo, v.hi]];
        match &self.0 {
            Kind::Surface { sides: Some(sides), .. } => {
                let held = all.into_iter().filter(|c| sides.winding(*c) != 0);
                held.chain(sides.inside(box_).into_iter().flatten()).collect()
            }
            _ => all.to_vec(),
        }
    }

    /// Whether a place counts, up to the border.
    pub(super) fn holds(&self, at: [f64; 2]) -> bool {
        match &self.0 {
            Kind::Surface { sides: Some(sides), .. } => sides.winding(at) != 0,
            _ => true,
        }
    }

    pub(super) fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        match &self.0 {
            Kind::Surface { surface, .. } => surface.point(u, v),
            Kind::Triangle { corners: [a, b, c], .. } => a + ((b - a) + (c - b) * v) * u,
        }
    }

    pub(super) fn over(&self, box_: &[Interval; 2]) -> Jet2<3> {
        match &self.0 {
            Kind::Surface { tensor, .. } => tensor.over(*box_).affine(),
            Kind::Triangle { corners, origin, .. } => triangle(corners, origin, box_),
        }
    }

    pub(super) fn at(&self, at: [f64; 2]) -> Jet2<3> {
        match &self.0 {
            Kind::Surface { tensor, .. } => tensor.at(at.map(Interval::point)).affine(),
            Kind::Triangle { corners, origin, .. } => triangle(corners, origin, &at.map(Interval::point)),
        }
    }
}

/// `a + u (b − a + v (c − b))` with derivatives.
fn triangle([a, b, c]: &[Vec3; 3], origin: &[f64; 3], [u, v]: &[Interval; 2]) -> Jet2<3> {
    let zero = [Interval::ZERO; 3];
    let mut out = Jet2 { p: zero, du: zero, dv: zero, duu: zero, duv: zero, dvv: zero };
    for d in 0..3 {
        let [a, b, c] = [a, b, c].map(|p| Interval::point(p[d]));
        out.duv[d] = c - b;
        out.du[d] = (b - a) + *v * out.duv[d];
        out.dv[d] = *u * out.duv[d];
        out.p[d] = (a - Interval::point(origin[d])) + *u * out.du[d];
    }
    out
}
