//! How far a patch is from another surface at places that a map of parameters says \[MKC09\].

use super::tensor::Jet2;
use super::vector::{length_bound, V3};
use crate::num::interval::Interval;

/// `S(φ(y)) − R(y)` with derivatives.
pub(super) struct Gap {
    pub value: V3<Interval>,
    ds: V3<Interval>,
    dt: V3<Interval>,
    dss: V3<Interval>,
    dst: V3<Interval>,
    dtt: V3<Interval>,
}

/// A bound of the gap over a cell.
pub(super) struct Bounded {
    /// No point of the cell is farther, mm.
    pub bound: f64,
    /// How much of it comes from either direction.
    pub share: [f64; 2],
}

impl Gap {
    /// By the chain rule, for a map of parameters.
    pub fn of(face: &Jet2<3>, map: &Jet2<2>, patch: &Jet2<3>) -> Self {
        let bend = |c: &[Interval; 2], d: usize| face.du[d] * c[0] + face.dv[d] * c[1];
        let mut out = Self::linear(face, [&map.du, &map.dv], patch);
        for d in 0..3 {
            out.dss[d] += bend(&map.duu, d);
            out.dst[d] += bend(&map.duv, d);
            out.dtt[d] += bend(&map.dvv, d);
        }
        out
    }

    /// The same for a linear map with these slopes.
    pub fn linear(face: &Jet2<3>, [a, b]: [&[Interval; 2]; 2], patch: &Jet2<3>) -> Self {
        let first = |a: &[Interval; 2], d: usize| face.du[d] * a[0] + face.dv[d] * a[1];
        let second = |a: &[Interval; 2], b: &[Interval; 2], d: usize| {
            face.duu[d] * (a[0] * b[0]) + face.duv[d] * (a[0] * b[1] + a[1] * b[0]) + face.dvv[d] * (a[1] * b[1])
        };
        let of = |f: &dyn Fn(usize) -> Interval| -> V3<Interval> { [f(0), f(1), f(2)] };
        Self {
            value: of(&|d| face.p[d] - patch.p[d]),
            ds: of(&|d| first(a, d) - patch.du[d]),
            dt: of(&|d| first(b, d) - patch.dv[d]),
            dss: of(&|d| second(a, a, d) - patch.duu[d]),
            dst: of(&|d| second(a, b, d) - patch.duv[d]),
            dtt: of(&|d| second(b, b, d) - patch.dvv[d]),
        }
    }

    /// Bounds the gap over a cell, whose enclosure this is, by Taylor polynomials about a place: of degree 1, and of degree 2
    /// unless the surface has a `creased` knot line there. `at` is the gap at that place, `x` and `y` the cell about it.
    pub fn bounded(&self, at: &Self, [x, y]: [Interval; 2], creased: bool) -> Bounded {
        let step = |du: &V3<Interval>, dv: &V3<Interval>, d: usize| du[d] * x + dv[d] * y;
        let first: V3<Interval> = [0, 1, 2].map(|d: usize| at.value[d] + step(&self.ds, &self.dt, d));
        let mut bound = length_bound(&first);
        if !creased {
            let bend =
                |d: usize| (self.dss[d] * x.sqr()) + (self.dst[d] * x * y).scale_exact(2.0) + (self.dtt[d] * y.sqr());
            let second = [0, 1, 2].map(|d: usize| at.value[d] + step(&at.ds, &at.dt, d) + bend(d).scale_exact(0.5));
            bound = bound.min(length_bound(&second));
        }
        // Distance unknown where the second derivatives are: what the cell does in either direction decides.
        let reach = |a: &V3<Interval>, b: &V3<Interval>, h: Interval| {
            h.mag() * (length_bound(a) + 0.5 * h.mag() * length_bound(b))
        };
        Bounded { bound, share: [reach(&at.ds, &self.dss, x), reach(&at.dt, &self.dtt, y)] }
    }
}
