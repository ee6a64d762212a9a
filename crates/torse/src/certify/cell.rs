//! One triangle of a face against one torse: a unique foot for every point, and a bound of the distance.
//!
//! Second-order Taylor bound with an interval Hessian \[certificate, 2.2–2.4\]: with `N = n/|n|` at the foot,
//! `d_i = N·S_i` and `d_ij = N·S_ij − σ (M·S_i)(M·S_j)/(|n|³ E_t)`. Derivatives are with respect to the coordinates of
//! the bounding box, `[0, 1]²`. Everything follows from linear forms of the control points: their hulls enclose
//! the form over the box.

use super::family::{Family, Plane};
use super::local::Local;
use super::prepared::{BoxNet, Patch, UNIT};
use super::quadratic::Quadratic;
use super::vector::{add, cross, dot, exact, length, length_bound, mid, scale, sub, V3};
use super::verdict::Obstruction;
use crate::num::interval::Interval;

/// What one look at a triangle showed.
#[derive(Clone, Copy, Debug)]
pub(super) enum CellBound {
    /// Everything is proven on the triangle.
    Good(Good),
    /// The distance at a corner or the centre exceeds the tolerance for certain.
    Exceeds {
        /// 0, 1, 2: corner; 3: centroid.
        place: usize,
        /// Signed distance there, mm.
        distance: f64,
    },
    /// The triangle is too large for a decision.
    Large {
        /// What failed.
        reason: Obstruction,
        /// Foot of the centroid, for the next look.
        foot: f64,
        /// Radius of the triangle's box in space, mm.
        radius: f64,
    },
    /// The centroid has no foot inside the torse's domain.
    Lost,
}

/// What was proven on a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Good {
    /// Bound of |d|, mm.
    pub bound: f64,
    /// Interval holding every foot, each unique in it.
    pub feet: Interval,
    /// Sign of `N·(S_u × S_v)/E_t`, or 0 at the region's boundary where it is in doubt.
    pub fold: i32,
    /// Where the sign is in doubt: bound of the length, mm, of a way on the torse from the foot of any point of the
    /// triangle to that of its corner on the region's boundary; else 0.
    pub way: f64,
    /// Lower bound of the radius of curvature at the feet.
    pub bend_radius: f64,
    /// Lower bound of the distance along the ruling to the regression curve.
    pub clearance: f64,
}

/// A torse and a patch, with what all triangles on it share.
pub(super) struct Bench<'a> {
    pub family: &'a Family,
    pub patch: &'a Patch,
    /// Distance bound to be shown, mm.
    pub tolerance: f64,
    /// Centre of the patch relative to the origin of the family, and its f64 image.
    centre: V3<Interval>,
    quick_centre: V3<f64>,
}

/// Margin by which the first guess of the foot interval exceeds the linear estimate: room for E_t to vary.
const FOOT_MARGIN: f64 = 1.15;

/// The way across a triangle at the region's boundary on which the foot map may fold is at most this share of the
/// tolerance: it enters in quadrature, and leaves most of the tolerance to the distance.
const WAY_SHARE: f64 = 1.0 / 2.0;

/// Sign changes are looked for at this many places when a foot must be found from nothing.
const SEARCH_PLACES: usize = 48;
/// Factor by which the size of one value is lowered for the few operations spent on it.
const ROUNDED_DOWN: f64 = 1.0 - 1e-14;

impl<'a> Bench<'a> {
    pub fn new(family: &'a Family, patch: &'a Patch, tolerance: f64) -> Self {
        let centre = sub(&exact(&patch.centre), &exact(&family.origin));
        Self { family, patch, tolerance, centre, quick_centre: mid(&centre) }
    }

    /// Foot and distance of the centroid in f64: from `guess`, or from nothing when that leads nowhere useful.
    pub fn quick(&self, triangle: &[[f64; 2]; 3], guess: Option<f64>) -> Option<(f64, f64)> {
        let c = [0, 1].map(|d| (triangle[0][d] + triangle[1][d] + triangle[2][d]) / 3.0);
        let x = add(&self.patch.quick_point(c[0], c[1]), &self.quick_centre);
        let measure = |t: f64| {
            let p = self.family.quick(t);
            (t, p.f(&x) / p.nn.sqrt())
        };
        let near = guess.and_then(|g| self.family.newton(&x, g)).map(measure);
        match near {
            Some(n) if n.1.abs() <= self.tolerance => Some(n),
            _ => self.family.search(&x, SEARCH_PLACES).map(measure).or(near),
        }
    }

    /// Tries to prove everything on the triangle.
    ///
    /// `rim`: whether a corner lies on the boundary of the region (needed where the parametrisation degenerates or the
    /// surface curls up).
    #[expect(clippy::too_many_lines, reason = "one chain of enclosures, each of which needs those before it")]
    pub fn bound_cell(&self, triangle: &[[f64; 2]; 3], guess: f64, rim: bool) -> CellBound {
        let BoxNet { net, corners } = self.patch.over(triangle);
        let c = [0, 1].map(|d| ((corners[0][d] + corners[1][d] + corners[2][d]).mid() / 3.0).clamp(0.0, 1.0));
        let local = Local::new(&net, c);
        let position = add(&self.quick_centre, &local.z);
        let Some(t) = self.family.newton(&position, guess).or_else(|| self.family.search(&position, SEARCH_PLACES))
        else {
            return CellBound::Lost;
        };
        let large = |reason| CellBound::Large { reason, foot: t, radius: local.norms[0] };

        // The plane at the centroid's foot, at the reference point z and at the centroid itself.
        let family = self.family;
        let plane = family.at(t);
        let z = add(&self.centre, &exact(&crate::geom::Vec3::from(local.z)));
        let (f_z, mu_z) = (plane.f(&z), plane.mu(&z));
        let e_z = plane.foot(f_z, mu_z);
        let slope_z = plane.foot_slope(f_z, mu_z, dot(&plane.dm, &z) - plane.dk);
        let gradient = plane.gradient();
        let along = local.forms(&gradient);
        let up = local.forms(&plane.n);

        // Foot: E has opposite signs at both ends of T for every point of the box.
        let reach = (along.x + e_z).mag() * FOOT_MARGIN / slope_z.mig();
        let (t0, t1) = family.domain();
        let tau = reach + 4.0 * UNIT * t.abs().max(t1 - t0) + f64::MIN_POSITIVE;
        let feet = Interval { lo: t - tau, hi: t + tau };
        if !(feet.lo >= t0 && feet.hi <= t1) {
            return large(Obstruction::Foot);
        }
        let low = self.end_sign(&local, &z, feet.lo);
        if low == 0 || low * self.end_sign(&local, &z, feet.hi) >= 0 {
            return large(Obstruction::Foot);
        }

        // Enclosures over K × T.
        let delta = Interval::symmetric(Interval::point(feet.hi - t).mag().max(t - feet.lo).next_up());
        let ranges = family.ranges(feet, &z);
        let sigma = ranges.sigma;
        let m = add(&plane.m, &scale(&ranges.dm, delta));
        let turn = scale(&m, delta * sigma);
        let n = add(&plane.n, &turn);
        let (nn, nm, mm, ndm) = (self.square(&n), self.product(&n, &m), self.square(&m), self.product(&n, &ranges.dm));
        let m_x = (along.x + plane.nm * up.x) / plane.nn;
        // As a form of the control points it keeps its sign however long the triangle is along the rulings of a cone.
        let coarse = Interval::symmetric(length_bound(&ranges.dm) * local.norms[0]);
        let mu_t = ranges.dmu + local.value_form(&ranges.dm).intersect(coarse).unwrap_or(coarse);
        let mu = mu_z + m_x + delta * mu_t;
        let f = f_z + up.x + delta * sigma * mu;
        let slope = sigma * nm * mu + nn * mu_t - f * (sigma * mm + ndm);
        // Regularity: μ_t at the foot point, and E_t at the foot.
        let regular = mu_t - f * ndm / nn;
        let across = mm - nm.sqr() / nn;
        let across = Interval { lo: across.lo.max(0.0), hi: across.hi };
        let slope_foot = nn * regular - f * sigma * across;
        if slope.sign() == 0 || regular.sign() == 0 || slope_foot.sign() == 0 {
            return large(Obstruction::Foot);
        }

        // Taylor bound at the centroid.
        let len = nn.sqrt();
        let len_c = plane.nn.sqrt();
        let cube = nn * len;
        let slip = length_bound(&gradient) * local.centre_error * 2.0;
        let f_c = f_z.widen(length_bound(&plane.n) * local.centre_error * 2.0);
        let e_c = e_z.widen(slip).abs();
        let drift = Interval::symmetric((e_c / slope.abs()).hi);
        let d0 = f_c / len_c + drift * e_c * sigma / cube;
        // M_t = σ (n·m) m + |n|² m' − (σ |m|² + n·m') n.
        let bend = sub(&add(&scale(&m, sigma * nm), &scale(&ranges.dm, nn)), &scale(&n, sigma * mm + ndm));
        let swing = length_bound(&bend);
        let turn_size = length_bound(&turn);
        let speed = sigma.abs() * across.sqrt() / len; // |N'| = |σ| |M|/|n|³ with |M| = |n|² |m⊥|
        let g = [0, 1].map(|i: usize| {
            dot(&plane.n, &local.d[i]) / len_c + drift * Interval::point(length_bound(&local.d[i])) * speed
        });
        let along1 = along.s1 + delta * Interval::point(swing * local.norms[1]);
        let along2 = along.s2 + delta * Interval::point(swing * local.norms[2]);
        let factor = sigma / (cube * slope_foot);
        let lift = |form: Interval, size: f64| (form + Interval::symmetric(turn_size * size)) / len;
        let h = [
            lift(up.s11, local.norms[3]) - factor * along1.sqr(),
            lift(up.s12, local.norms[4]) - factor * along1 * along2,
            lift(up.s22, local.norms[5]) - factor * along2.sqr(),
        ];
        let quadratic = Quadratic { c: d0.mid(), g: g.map(Interval::mid), h: h.map(Interval::mid) };
        let offsets = corners.map(|y| [y[0].mid() - c[0], y[1].mid() - c[1]]);
        // Corners are intervals: their widths enter through the gradient over the box.
        let width = corners.iter().flatten().fold(0.0f64, |w, y| w.max(y.rad()));
        let reach = offsets.iter().flatten().fold(0.0f64, |w, y| w.max(y.abs())) + width + 4.0 * UNIT;
        let steep = (0..2).fold(0.0, |s, i| s + g[i].mag() + (h[i].mag() + h[i + 1].mag()) * reach);
        // 2|y₁y₂| ≤ y₁² + y₂² keeps it convex in y, so that its maximum is at a corner.
        let rest = |y: [f64; 2]| {
            let y = [y[0].abs() + width + 4.0 * UNIT, y[1].abs() + width + 4.0 * UNIT];
            d0.rad()
                + g[0].rad() * y[0]
                + g[1].rad() * y[1]
                + 0.5 * ((h[0].rad() + h[1].rad()) * y[0] * y[0] + (h[2].rad() + h[1].rad()) * y[1] * y[1])
                + steep * (width + 4.0 * UNIT)
        };
        let remainder = offsets.iter().fold(0.0f64, |r, &y| r.max(rest(y)));
        let bound = (quadratic.magnitude_bound(&offsets) + remainder) * (family.metric + 16.0 * UNIT);
        if !bound.is_finite() {
            return large(Obstruction::Bound);
        }
        if bound > self.tolerance {
            let shrink = 2.0 - family.metric - 16.0 * UNIT;
            for (place, y) in offsets.iter().chain([&[0.0, 0.0]]).enumerate() {
                let value = quadratic.value(*y);
                if (value.abs() * ROUNDED_DOWN - rest(*y)) * shrink > self.tolerance {
                    return CellBound::Exceeds { place, distance: value };
                }
            }
            return large(Obstruction::Bound);
        }

        // Fold: N·(S_u × S_v) keeps its sign.
        let normal = cross(&local.d[0], &local.d[1]);
        let [_, r1, r2, r11, r12, r22] = local.norms;
        let (v1, v2) = ((r11 + r12) * reach, (r12 + r22) * reach);
        let (d1, d2) = (length_bound(&local.d[0]), length_bound(&local.d[1]));
        let vary = v1 * d2 + d1 * v2 + v1 * v2;
        let value = dot(&plane.n, &normal);
        let loss =
            (length_bound(&plane.n) * vary + turn_size * r1.min(d1 + v1) * r2.min(d2 + v2)) * (1.0 + 32.0 * UNIT);
        // Radius of curvature |n| |G| / (|σ| |m⊥|²), clearance |G| / |m'·ê|: least numerator over largest denominator.
        let pessimism = 1.0 - 16.0 * (family.metric - 1.0) - 16.0 * UNIT;
        let e = Family::direction(&Plane { n, m, ..plane });
        // |m⊥| = |n × m|/|n| loses less where n grows along itself.
        let same = self.square(&e) / nn;
        let across = Interval { lo: across.lo.max(same.lo), hi: across.hi.min(same.hi) };
        let bend_radius = (len * regular).least_ratio(sigma * across) * pessimism;
        let clearance = (regular.abs() * length(&e)).least_ratio(self.product(&ranges.dm, &e)) * pessimism;
        let (fold, way) = if value.mig() > loss {
            (value.sign() * slope.sign(), 0.0)
        } else {
            // The surface's normal is in doubt, or turns too far: bound the way to the rim instead. The foot moves by
            // the tangential part of S_i and by −d N' t_i, with t_i = −M·S_i/E_t.
            let turning = Interval::point(bound) * speed / slope_foot.abs();
            let way = (0..2).fold(Interval::ZERO, |sum, i| {
                let (lo, hi) = (corners.iter().map(|y| y[i].lo), corners.iter().map(|y| y[i].hi));
                let across = hi.fold(f64::NEG_INFINITY, f64::max) - lo.fold(f64::INFINITY, f64::min);
                let along = [along1, along2][i];
                sum + (Interval::point(local.norms[1 + i]) + turning * along.abs()) * Interval::point(across)
            });
            let way = way.hi * family.metric * (1.0 + 16.0 * UNIT);
            if !(rim && way <= WAY_SHARE * self.tolerance) {
                let turned = length(&normal).lo > vary * (1.0 + 32.0 * UNIT);
                return large(if turned { Obstruction::Fold } else { Obstruction::Degenerate });
            }
            (0, way)
        };
        CellBound::Good(Good { bound, feet, fold, way, bend_radius, clearance })
    }

    /// Sign of E(·, t) over the box.
    fn end_sign(&self, local: &Local, z: &V3<Interval>, t: f64) -> i32 {
        let p = self.family.at(t);
        let base = p.foot(p.f(z), p.mu(z));
        (base + local.value_form(&p.gradient())).sign()
    }

    /// Scalar product in the local metric of vectors given in world axes.
    fn product(&self, a: &V3<Interval>, b: &V3<Interval>) -> Interval {
        let world = dot(a, b);
        let skew = self.family.metric - 1.0;
        if skew > 0.0 {
            world.widen(4.0 * skew * length_bound(a) * length_bound(b))
        } else {
            world
        }
    }

    fn square(&self, a: &V3<Interval>) -> Interval {
        let world = a[0].sqr() + a[1].sqr() + a[2].sqr();
        let s = world.widen(8.0 * (self.family.metric - 1.0) * world.hi);
        Interval { lo: s.lo.max(0.0), hi: s.hi }
    }
}

#[cfg(test)]
mod tests {
    use crate::certify::distance::{distance, DistanceOptions, Judgement};
    use crate::certify::specimens::*;
    use crate::certify::{Prepared, Verdict};
    use crate::control::Control;
    use crate::geom::{Frame, Vec3};
    use crate::spline::knots::Knots;
    use crate::torse::form::{DualTorse, PrimalTorse, Torse};

    /// The judgement of a torse about points of itself, with a large tolerance so that triangles stay large.
    fn of_itself(torse: &Torse, from: f64, to: f64, half: f64) -> Judgement {
        let k = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let many = Knots::uniform(3, 40, 0.0, 1.0).expect("knots");
        let s = interpolant(&many, &k, &|u, v| {
            let r = torse.ruling(from + u * (to - from));
            r.point + r.direction * (half * (2.0 * v - 1.0))
        });
        let j =
            distance(&Prepared::new(&s), torse, &grid(&s, 1, 1), 2.0, &DistanceOptions::default(), &Control::default());
        assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
        j
    }

    fn primal_with(f: &dyn Fn(f64) -> [f64; 2]) -> Torse {
        let knots = Knots::uniform(3, 320, -0.5, 3.5).expect("knots");
        Torse::Primal(PrimalTorse::new(Frame::world(), curve(&knots, f), 0.0))
    }

    /// The judgement of a torse about a plane square of width .1 around (x, 0), with so large a tolerance that no
    /// triangle is halved.
    fn of_the_ground(torse: &Torse) -> Judgement {
        let k = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let s = interpolant(&k, &k, &|u, v| Vec3::new(1.0 + u, 0.1 * v - 0.05, 0.0));
        let options = DistanceOptions::default();
        let j = distance(&Prepared::new(&s), torse, &grid(&s, 1, 1), 0.5, &options, &Control::default());
        assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
        j
    }

    #[test]
    fn the_bending_radius_of_a_ripple_is_not_infinite_at_its_inflections() {
        // Curvature 4/5 at the crests, where the slope is 0.
        let ripple = primal_with(&|t| [0.8 / 1600.0 * (40.0 * t).sin(), 0.0]);
        let j = of_the_ground(&ripple);
        assert!(j.min_bend_radius <= 1.26 && j.min_bend_radius > 0.4, "{}", j.min_bend_radius);
    }

    #[test]
    fn the_clearance_is_not_infinite_where_rulings_are_parallel_in_passing() {
        // Rulings y = s, x = t − a s: regression points at s = −1/a', with a' between −1.2 and 1.2.
        let fan = primal_with(&|t| [1e-3 * t * t, 0.03 * (40.0 * t).sin()]);
        let j = of_the_ground(&fan);
        assert!(j.regression_clearance <= 0.84 && j.regression_clearance > 0.05, "{}", j.regression_clearance);
    }

    #[test]
    fn a_cylinder_has_its_radius_however_its_planes_are_scaled() {
        let knots = Knots::uniform(3, 40, -0.2, 1.4).expect("knots");
        let planes = curve(&knots, &|t| {
            let s = (2.0 * t).exp();
            [s * t.cos(), s * t.sin(), 0.0, 5.0 * s]
        });
        let j = of_itself(&Torse::Dual(DualTorse { planes }), 0.0, 1.2, 0.1);
        assert!(j.min_bend_radius <= 5.0 + 1e-3 && j.min_bend_radius > 1.5, "{}", j.min_bend_radius);
        let x = Vec3::new(5.0, 0.0, 0.0);
        assert!(x.norm() >= j.min_bend_radius);
    }
}
