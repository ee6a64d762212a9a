//! How nearly developable the exported patch is, from its control points alone.
//!
//! *Method* \[certificate, 4\]: with homogeneous boundary curves a(t), b(t), the tangent planes at the two ends of a
//! ruling are `a∧b∧a'` and `a∧b∧b'`; their normals n0, n1 satisfy `n0 × n1 = ± Δ (w_a x_b − w_b x_a)` with
//! `Δ = det(a, a', b, b')`. With the halves α, β of degree p − 1 (`a = (1−s) α + s β`) the line `a∧a'` is `p α∧β` without
//! cancellation, degree 2p − 2. All as interval Bernstein products on quarters of the spans, origin at the middle.
//!
//! Only the trimmed part matters: on every part of the parameter interval, a and b are taken at the ends of the range
//! of r that the trimming curves reach there (a region bounded by curves reaches no farther than they do on any
//! ruling). Outside it the patch may well run into its regression curve.
//!
//! Both normals having a positive component along one direction while being parallel up to a tiny angle, no point of
//! the regression curve lies between A and B.
//!
//! *Clearance*: with c0, c1 these components, points of the ruling's line where `(1−r) c0 + r c1` vanishes may be singular;
//! `|B − A| min(c0 w_b, c1 w_a)/|c0 w_b − c1 w_a|` is the distance of the nearer one from the part between A and B, and no
//! other place is singular. *Bending radius*: normals turn by at most the speed of their central projection u from the
//! sphere to the plane of that direction, `u' = (p/c)'`, and points move across the rulings at
//! `p |n_r|/(w_r |L|)`, where `L = w_a x_b − w_b x_a` is the ruling; the quotient, with what the angle between both
//! ends may add, bounds the larger principal curvature.

use super::boundary::trim_piece;
use super::ruled::Ruled;
use super::vector::{length, length_bound};
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::bernstein::{derivative, difference, hull, product};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::spline::curve::Curve;

/// Angle (rad) up to which a patch counts as developable: two micrometres over a metre, far below anything that can be
/// made; above rounding, which grows near the regression curve.
pub(super) const ANGLE_LIMIT: f64 = 2e-6;

/// Spans are cut into this many parts; hulls of products are then tight.
const PARTS: usize = 4;

/// Parts that show nothing are halved at most this often.
const HALVINGS: usize = 6;

/// Smallest cosine allowed between a normal and the part's middle normal.
const COSINE: f64 = 0.1;

/// The range of r on a part is taken at least this wide: on nearly no ruling at all, rounding would rule.
const LEAST_RANGE: f64 = 0.05;

/// Parts are halved at most this often to make a bound sharper.
const SHARPENINGS: usize = 24;

/// A part is halved for a sharper bound only if that gains as much: both halves multiply the bound by this.
const GAIN: f64 = 1.03;

/// The directions of a frame have unit length and are perpendicular up to rounding, which this share pays for many
/// times over.
const FRAME_ROUNDING: f64 = 1e-12;

/// Trimming curves are enclosed by boxes of this many pieces per span.
const BOXES: usize = 8;

/// What the control points show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Developability {
    /// Bound (rad) of the angle between the tangent planes at both ends of the used part of any ruling.
    pub angle: f64,
    /// Whether no ruling meets the regression curve in its used part.
    pub regular: bool,
    /// Lower bound (mm) of the radius of curvature of the used part; infinite where it is plane.
    pub bend_radius: f64,
    /// Lower bound (mm) of the distance along rulings between the used part and the regression curve; infinite where
    /// all rulings are parallel.
    pub clearance: f64,
    /// Ruling about which the angle is largest, or that is not shown to keep off the regression curve; 0 of no rulings.
    pub worst: f64,
}

impl Developability {
    /// Where nothing could be shown.
    const NOTHING: Self =
        Self { angle: std::f64::consts::FRAC_PI_2, regular: false, bend_radius: 0.0, clearance: 0.0, worst: 0.0 };

    /// Of no rulings at all.
    const EMPTY: Self =
        Self { angle: 0.0, regular: true, bend_radius: f64::INFINITY, clearance: f64::INFINITY, worst: 0.0 };

    /// The worse of both in every respect; no field is ever NaN.
    fn and(self, o: &Self) -> Self {
        Self {
            angle: self.angle.max(o.angle),
            regular: self.regular && o.regular,
            bend_radius: self.bend_radius.min(o.bend_radius),
            clearance: self.clearance.min(o.clearance),
            worst: if (!o.regular, o.angle) > (!self.regular, self.angle) { o.worst } else { self.worst },
        }
    }
}

/// Boxes (t, r) that together contain the trimming curves.
pub(super) fn trim_boxes<'a>(curves: impl IntoIterator<Item = &'a Curve<2>>) -> Vec<[Interval; 2]> {
    let boxes = |c: &'a Curve<2>| trim_steps(c).into_iter().map(|[a, b]| trim_piece(c, a, b).map(|b| hull(&b)));
    curves.into_iter().flat_map(boxes).collect()
}

/// The stretches of a trimming curve that have a box each.
pub(super) fn trim_steps(c: &Curve<2>) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    for w in c.knots.breaks().windows(2) {
        let cut = |i: usize| if i == BOXES { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / BOXES as f64 };
        out.extend((0..BOXES).map(|i| [cut(i), cut(i + 1)]));
    }
    out
}

/// Bounds the angle between tangent planes along the rulings inside the trimming curves.
pub(super) fn developability(patch: &Ruled, trims: &[[Interval; 2]]) -> Developability {
    developability_until(patch, trims, ANGLE_LIMIT, &Control::default()).unwrap_or(Developability::NOTHING)
}

/// The same with another angle (rad) up to which a patch counts as developable: parts are halved until they show it;
/// `None` if a control says stop before.
pub(super) fn developability_until(
    patch: &Ruled,
    trims: &[[Interval; 2]],
    limit: f64,
    control: &Control,
) -> Option<Developability> {
    let breaks = patch.breaks();
    let between = |w: &[f64]| {
        let mut found: Vec<(f64, f64, Developability)> = Vec::new();
        let cut = |i: usize| if i == PARTS { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / PARTS as f64 };
        let mut open: Vec<(f64, f64, usize)> = (0..PARTS).map(|i| (cut(i), cut(i + 1), 0)).collect();
        while let Some((a, b, depth)) = open.pop() {
            if control.stopped() {
                return None;
            }
            let Some(r) = used_range(trims, a, b) else { continue };
            let part = on_part(patch, a, b, r, limit);
            if (part.regular && part.angle <= limit) || depth == HALVINGS {
                found.push((a, b, part));
            } else {
                let m = 0.5 * (a + b);
                open.extend([(a, m, depth + 1), (m, b, depth + 1)]);
            }
        }
        Some(found)
    };
    let spans: Option<Vec<Vec<_>>> = parallel::map(breaks.windows(2), between).into_iter().collect();
    let mut found = spans?.concat();
    if found.iter().all(|(_, _, d)| d.regular) {
        for least in [|d: &Developability| d.bend_radius, |d: &Developability| d.clearance] {
            sharpen(patch, trims, limit, &mut found, least);
        }
    }
    Some(found.iter().fold(Developability::EMPTY, |all, (_, _, d)| all.and(d)))
}

/// Halves the part on which a bound is least as long as that gains something.
fn sharpen(
    patch: &Ruled,
    trims: &[[Interval; 2]],
    limit: f64,
    found: &mut Vec<(f64, f64, Developability)>,
    bound: fn(&Developability) -> f64,
) {
    for _ in 0..SHARPENINGS {
        let of = |i: &usize| bound(&found[*i].2);
        let Some(i) = (0..found.len()).min_by(|i, j| of(i).total_cmp(&of(j))) else { return };
        let (a, b, whole) = found[i];
        let m = 0.5 * (a + b);
        let halves: Vec<_> = [(a, m), (m, b)]
            .into_iter()
            .filter_map(|(a, b)| Some((a, b, on_part(patch, a, b, used_range(trims, a, b)?, limit))))
            .collect();
        let gained = halves.iter().all(|(_, _, h)| h.regular && bound(h) >= GAIN * bound(&whole));
        if halves.is_empty() || !gained {
            return;
        }
        found.swap_remove(i);
        found.extend(halves);
    }
}

/// Range of r that the trimming curves reach over `[a, b]`; `None` when they do not come there.
fn used_range(trims: &[[Interval; 2]], a: f64, b: f64) -> Option<Interval> {
    let r = trims.iter().filter(|[t, _]| t.lo <= b && t.hi >= a).map(|[_, r]| *r).reduce(Interval::hull)?;
    let missing = (0.5 * (LEAST_RANGE - (r.hi - r.lo))).max(0.0);
    Some(Interval { lo: (r.lo - missing).max(0.0), hi: (r.hi + missing).min(1.0) })
}

type Poly = Vec<Interval>;

/// `x y − z w` of polynomials.
fn minor(x: &Poly, y: &Poly, z: &Poly, w: &Poly) -> Poly {
    product(x, y).into_iter().zip(product(z, w)).map(|(a, b)| a - b).collect()
}

/// `a∧a'/p`: the six minors 01, 02, 03, 12, 13, 23 of the halves.
fn tangent_line(a: &[Poly; 4]) -> [Poly; 6] {
    let low = |d: usize| a[d][..a[d].len() - 1].to_vec();
    let high = |d: usize| a[d][1..].to_vec();
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| minor(&low(i), &high(j), &low(j), &high(i)))
}

/// Normal of the plane through a line (six minors) and a point.
fn plane_normal(l: &[Poly; 6], b: &[Poly; 4]) -> [Poly; 3] {
    // 3×3 minors of rows (line, point) in the columns (y z w), (z x w), (x y w): coefficients of x, y, z.
    let three = |ij: &Poly, k: &Poly, ik: &Poly, j: &Poly, jk: &Poly, i: &Poly| -> Poly {
        let (p, q, r) = (product(ij, k), product(ik, j), product(jk, i));
        (0..p.len()).map(|n| p[n] - q[n] + r[n]).collect()
    };
    let [xy, xz, xw, yz, yw, zw] = l;
    let minus = |p: Poly| -> Poly { p.into_iter().map(|x| -x).collect() };
    [
        three(yz, &b[3], yw, &b[2], zw, &b[1]),
        minus(three(xz, &b[3], xw, &b[2], zw, &b[0])),
        three(xy, &b[3], xw, &b[1], yw, &b[0]),
    ]
}

fn on_part(patch: &Ruled, a: f64, b: f64, used: Interval, limit: f64) -> Developability {
    let worst = 0.5 * (a + b);
    let nothing = Developability { worst, ..Developability::NOTHING };
    let origin = patch.middle(worst);
    let (first, last) = (patch.end(0, a, b, &origin), patch.end(1, a, b, &origin));
    let at = |r: f64| -> [Poly; 4] {
        let (r, s) = (Interval::point(r), Interval::ONE - Interval::point(r));
        [0, 1, 2, 3].map(|d: usize| first[d].iter().zip(&last[d]).map(|(&x, &y)| x * s + y * r).collect())
    };
    let (pa, pb) = (at(used.lo), at(used.hi));
    let (la, lb) = (tangent_line(&pa), tangent_line(&pb));
    // Laplace expansion of det(α_a, β_a, α_b, β_b) by pairs of rows.
    let mut delta: Poly = Vec::new();
    for (i, j, sign) in [(0, 5, 1.0), (1, 4, -1.0), (2, 3, 1.0), (3, 2, 1.0), (4, 1, -1.0), (5, 0, 1.0)] {
        let term = product(&la[i], &lb[j]);
        if delta.is_empty() {
            delta = vec![Interval::ZERO; term.len()];
        }
        for (d, t) in delta.iter_mut().zip(term) {
            *d += t * sign;
        }
    }
    // a∧b∧a' and a∧b∧b' have the same orientation where the patch is regular: −(a∧a')∧b and (b∧b')∧a.
    let n0 = plane_normal(&la, &pb).map(|p| p.into_iter().map(|x| -x).collect::<Poly>());
    let n1 = plane_normal(&lb, &pa);
    let ruling = [0, 1, 2].map(|d: usize| hull(&minor(&pa[3], &pb[d], &pb[3], &pa[d])));
    let middle = Vec3::from([0, 1, 2].map(|d: usize| n0[d][n0[d].len() / 2].mid()));
    let Some(middle) = middle.try_normalize(0.0) else { return nothing };
    let frame = frame_about(middle);
    let (first, last) = (Side::new(&n0, &pa, &frame), Side::new(&n1, &pb, &frame));
    let (low0, low1) = (Interval::point(first.least()), Interval::point(last.least()));
    if !(low0.lo > 0.0 && low1.lo > 0.0) {
        return nothing;
    }
    let top = Interval::point(hull(&delta).mag()) * Interval::point(length_bound(&ruling));
    let sine = (top / (low0 * low1)).hi;
    // asin x ≤ x (1 + x²) for x ≤ ½.
    let angle = if sine <= 0.5 { sine * (1.0 + sine * sine) } else { std::f64::consts::FRAC_PI_2 };
    let regular = angle <= limit && first.steep() && last.steep();
    if !regular {
        return Developability { angle, ..nothing };
    }
    let shape = Shape { ends: [&first, &last], ruling: length(&ruling), twist: sine, degree: (pa[0].len() - 1) as f64 };
    Developability { angle, regular, bend_radius: shape.bend_radius(), clearance: shape.clearance(), worst }
}

/// Three perpendicular directions, the last one given.
fn frame_about(z: Vec3) -> [Vec3; 3] {
    let mut axis = Vec3::zeros();
    axis[z.iamin()] = 1.0;
    let x = axis.cross(&z);
    let x = x / x.norm();
    [x, z.cross(&x), z]
}

/// One end of the rulings of a part.
struct Side {
    /// Component of the normals along the middle normal, and its polynomial.
    up: Interval,
    up_form: Poly,
    /// Length of the normals.
    size: f64,
    /// Bound of the speed at which the normals' central projection moves, per part.
    turn: f64,
    /// Bound of `|c'|/c`, per part.
    growth: f64,
    /// Bound of `|w'|/w`, per part.
    growth_of_weight: f64,
    /// Weight, and its polynomial.
    weight: Interval,
    weight_form: Poly,
    /// Bound of the speed of the end, mm per part.
    speed: f64,
}

impl Side {
    fn new(normal: &[Poly; 3], point: &[Poly; 4], frame: &[Vec3; 3]) -> Self {
        let component = |e: &Vec3| -> Poly {
            (0..normal[0].len())
                .map(|i| (0..3).fold(Interval::ZERO, |s, d| s + normal[d][i] * Interval::point(e[d])))
                .collect()
        };
        let slope = |c: &Poly| hull(&derivative(c)).abs();
        let (x, y, up_form) = (component(&frame[0]), component(&frame[1]), component(&frame[2]));
        let up = hull(&up_form);
        let growth = slope(&up_form) / up;
        // (p/c)' = (p' − p c'/c)/c.
        let turn = |c: &Poly| (slope(c) + hull(c).abs() * growth) / up;
        let weight = hull(&point[3]);
        let change = slope(&point[3]);
        let speed = [0, 1, 2].map(|d: usize| (slope(&point[d]) + hull(&point[d]).abs() * change / weight) / weight);
        Self {
            size: length_bound(&[0, 1, 2].map(|d: usize| hull(&normal[d]))),
            turn: length_bound(&[turn(&x), turn(&y), Interval::ZERO]),
            growth: growth.mag(),
            growth_of_weight: (change / weight).hi,
            speed: length_bound(&speed),
            weight,
            weight_form: point[3].clone(),
            up,
            up_form,
        }
    }

    /// The least component of the normals along the middle normal.
    fn least(&self) -> f64 {
        self.up.lo * (1.0 - FRAME_ROUNDING)
    }

    /// Whether all normals are within a safe angle of the middle normal.
    fn steep(&self) -> bool {
        self.least() > COSINE * self.size
    }
}

/// A part with normals that agree.
struct Shape<'a> {
    ends: [&'a Side; 2],
    /// |L|.
    ruling: Interval,
    /// Bound of the sine of the angle between the normals at both ends.
    twist: f64,
    degree: f64,
}

impl Shape<'_> {
    /// Bound of `(c_r / w_r)` from below: between both ends it lies between its values there.
    fn least_speed(&self) -> f64 {
        let [a, b] = self.ends.map(|s| Interval::point(s.least()).least_ratio(s.weight));
        a.min(b)
    }

    /// See the head of the file.
    fn clearance(&self) -> f64 {
        let [a, b] = self.ends;
        let gap = difference(&product(&a.up_form, &b.weight_form), &product(&b.up_form, &a.weight_form));
        let gap = hull(&gap).abs() * Interval::point(1.0 + FRAME_ROUNDING);
        (Interval::point(self.ruling.lo) * Interval::point(self.least_speed())).least_ratio(gap)
    }

    /// The shape operator in the direction across the rulings has at most the length `|N_t|/|X_t⊥|`. Where the normals
    /// at both ends differ by the angle ε, it may have `|X_t| τ/|X_t⊥|` more, and τ along the rulings, with τ the speed
    /// at which normals turn along them: at most `ε w²/|L| max(c0/c1, c1/c0)`.
    fn bend_radius(&self) -> f64 {
        let [a, b] = self.ends;
        let twist = Interval::point(self.twist);
        let uneven = (a.up / b.up).hi.max((b.up / a.up).hi);
        let weight = Interval::point(a.weight.hi.max(b.weight.hi));
        let along = twist * Interval::point(uneven) * weight.sqr() / self.ruling;
        // The projection of the normal between both ends is λ u1 + (1 − λ) u0 with |λ'| ≤ (|c0'|/c0 + |c1'|/c1)/4.
        let turn = Interval::point(a.turn.max(b.turn)) + twist * Interval::point(a.growth + b.growth);
        // So is the point between both ends, with the weights in place of c: its speed has λ' (X_b − X_a) besides.
        let spread = Interval::point(self.ruling.hi) * Interval::point(a.growth_of_weight + b.growth_of_weight)
            / (a.weight * b.weight);
        let speed = Interval::point(a.speed.max(b.speed)) + spread;
        let across = Interval::point(self.least_speed()) * self.degree / Interval::point(self.ruling.hi);
        let curvature = (turn + speed * along) / across + along;
        Interval::ONE.least_ratio(curvature * Interval::point(1.0 + FRAME_ROUNDING))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::*;

    /// Everything between two values of r.
    fn all(lo: f64, hi: f64) -> Vec<[Interval; 2]> {
        vec![[Interval::EVERYTHING, Interval::new(lo, hi)]]
    }

    #[test]
    fn exact_patches_are_developable_and_tampered_ones_are_not() {
        for patch in [primal_patch(), dual_patch()] {
            let good = developability(&Ruled::new(&patch).expect("ruled"), &all(0.0, 1.0));
            assert!(good.regular && good.angle < ANGLE_LIMIT, "{good:?}");
            let mut bad = patch;
            bad.control[8][2] += 1e-5;
            let bad = developability(&Ruled::new(&bad).expect("ruled"), &all(0.0, 1.0));
            assert!(bad.angle > ANGLE_LIMIT, "{bad:?}");
        }
    }

    #[test]
    fn angles_are_bounded_on_a_doubly_ruled_surface() {
        // z = x y with rulings y = const: tangent planes turn by atan 1 from x = 0 to x = 1 on every ruling near y = 0.
        let saddle = ruled_patch(1, &[0.0, 1.0], &|t, e| [e as f64, t, t * e as f64, 1.0]);
        let d = developability(&Ruled::new(&saddle).expect("ruled"), &all(0.0, 1.0));
        assert!(d.angle >= std::f64::consts::FRAC_PI_4 && !d.regular, "{d:?}");
    }

    #[test]
    fn the_regression_curve_between_the_ends_is_noticed() {
        // Tangents of a twisted cubic on both sides of their points of contact.
        let tangents = ruled_patch(4, &[0.2, 1.0], &|t, e| {
            let s = [-0.5, 0.5][e];
            [t + s, t * t + 2.0 * s * t, t * t * t + 3.0 * s * t * t, 1.0]
        });
        let d = developability(&Ruled::new(&tangents).expect("ruled"), &all(0.0, 1.0));
        assert!(!d.regular, "{d:?}");
        let upper = developability(&Ruled::new(&tangents).expect("ruled"), &all(0.7, 0.9));
        assert!(upper.regular && upper.angle < ANGLE_LIMIT, "{upper:?}");
    }

    #[test]
    fn clearance_and_bending_radius_of_a_tangent_surface() {
        let one_side = ruled_patch(4, &[0.2, 1.0], &|t, e| {
            let s = [0.3, 0.8][e];
            [t + s, t * t + 2.0 * s * t, t * t * t + 3.0 * s * t * t, 1.0]
        });
        let d = developability(&Ruled::new(&one_side).expect("ruled"), &all(0.0, 1.0));
        assert!(d.regular && d.angle < ANGLE_LIMIT, "{d:?}");
        // At the length v of tangent from a curve of curvature κ and torsion τ the radius is κ v/τ.
        let of = |t: f64| {
            let (a, b) = (9.0 * t.powi(4) + 4.0 * t * t + 1.0, 9.0 * t.powi(4) + 9.0 * t * t + 1.0);
            (0.3 * a.sqrt(), 2.0 * b.sqrt() / a.powf(1.5) * 0.3 * a.sqrt() * b / 3.0)
        };
        let (mut clearance, mut radius) = (f64::INFINITY, f64::INFINITY);
        for i in 0..=1000 {
            let (c, r) = of(0.2 + 0.8 * f64::from(i) / 1000.0);
            (clearance, radius) = (clearance.min(c), radius.min(r));
        }
        assert!(d.clearance <= clearance * (1.0 + 1e-9) && d.clearance > 0.8 * clearance, "{d:?} {clearance}");
        assert!(d.bend_radius <= radius * (1.0 + 1e-9) && d.bend_radius > 0.8 * radius, "{d:?} {radius}");
    }

    #[test]
    fn cylinders_have_their_radius_and_no_regression_curve_near() {
        // A quarter of a cylinder of radius 5 with rational rails; the other rail with twice the weights.
        let arc = ruled_patch(2, &[0.0, 1.0], &|t, e| {
            let (c, s) = (1.0 - t * t, 2.0 * t);
            let w = (1.0 + t * t) * (1 + e) as f64;
            let k = (1 + e) as f64;
            [5.0 * c * k, 5.0 * s * k, e as f64 * 3.0 * w, w]
        });
        let d = developability(&Ruled::new(&arc).expect("ruled"), &all(0.0, 1.0));
        assert!(d.regular && d.bend_radius <= 5.0 && d.bend_radius > 4.0, "{d:?}");
        assert!(d.clearance > 1e9, "{d:?}");
    }

    #[test]
    fn what_cannot_be_shown_is_never_infinite() {
        let mut patch = primal_patch();
        patch.control[8][2] += 1e-3;
        let d = developability(&Ruled::new(&patch).expect("ruled"), &all(0.0, 1.0));
        assert!(!d.regular && d.bend_radius == 0.0 && d.clearance == 0.0, "{d:?}");
    }
}
