//! How near measured points are to strips: a proven bound for each of them.
//!
//! *Method.* Any point of a strip gives an upper bound of the distance. It is looked for among sampled rulings, improved
//! by Gauss–Newton steps on the patch, and evaluated once more in interval arithmetic \[MKC09\] from the numbers of the
//! patch, which are those that are written. Nothing here knows how the strips were found.
//! *Guaranteed*: no point is farther from the strips than its bound. *Not guaranteed*: that the bound is the distance
//! (a nearer place may have been missed), or anything about places of the strips without points.

use super::claim::UpperBound;
use crate::control::Control;
use crate::geom::{BBox, Vec3};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::spline::blossom::of_piece;
use crate::spline::curve::Curve;
use crate::torse::strip::Strip;
use std::collections::BTreeSet;

/// Rulings of the table of a strip.
const RULINGS: usize = 96;
/// Gauss–Newton steps; the last ones change nothing any more.
const STEPS: usize = 5;
/// Share of the product of both squared speeds below which their determinant is rounding: then one direction is
/// followed.
const DEPENDENT: f64 = 1e-12;
/// Steps end when the squared distance falls by less than this share: the bound of the distance would show no more of
/// it.
const LEAST_GAIN: f64 = 1e-9;

/// Proven distances of points from strips.
#[derive(Clone, Debug)]
pub struct PointCertificate {
    bounds: Vec<f64>,
    places: Vec<(u32, f32, f32)>,
    signed: Vec<f64>,
    worst: Option<usize>,
}

impl PointCertificate {
    /// For each point, a number that its distance from the strips does not exceed, mm; infinite without strips.
    pub fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// For each point the strip and the parameters (u, v) of the place that gives its bound.
    pub fn places(&self) -> &[(u32, f32, f32)] {
        &self.places
    }

    /// Signed distances: the bounds with the side of the strip as sign, mm.
    pub fn signed_estimates(&self) -> &[f64] {
        &self.signed
    }

    /// Bound of the largest distance, mm; unknown without points.
    pub fn worst_bound(&self) -> UpperBound {
        self.worst.map_or(UpperBound::UNKNOWN, |i| UpperBound::shown(self.bounds[i]))
    }

    /// Bound of the largest distance, mm, of the points whose bound comes from a strip and is at most `within`; unknown
    /// if there are none.
    pub fn worst_bound_on(&self, strip: usize, within: f64) -> UpperBound {
        let own = self.places.iter().zip(&self.bounds).filter(|(p, b)| p.0 as usize == strip && **b <= within);
        UpperBound::largest(own.map(|(_, b)| UpperBound::shown(*b)))
    }

    /// Index of the point with the largest bound.
    pub fn worst(&self) -> Option<usize> {
        self.worst
    }

    /// Number of points whose bound exceeds a tolerance, mm.
    pub fn beyond(&self, tolerance: f64) -> usize {
        self.bounds.iter().filter(|b| b.is_nan() || **b > tolerance).count()
    }
}

/// A strip made ready.
pub(super) struct Target<'a> {
    pub strip: &'a Strip,
    pub rails: [Curve<4>; 2],
    pub table: Vec<(f64, Vec3, Vec3)>,
    bbox: BBox,
}

impl<'a> Target<'a> {
    /// Distance of a point from the box of the control points, mm: no place of the strip is nearer, up to rounding.
    pub fn outside(&self, x: &Vec3) -> f64 {
        (self.bbox.min - x).sup(&(x - self.bbox.max)).sup(&Vec3::zeros()).norm()
    }

    /// The strip with sampled rulings.
    pub fn of(strip: &'a Strip) -> Self {
        let (a, b) = strip.domain();
        let table: Vec<(f64, Vec3, Vec3)> = (0..=RULINGS)
            .map(|i| {
                let u = a + (b - a) * i as f64 / RULINGS as f64;
                let [p, q] = strip.ruling(u);
                (u, p, q - p)
            })
            .collect();
        Self { strip, rails: [strip.rail(0), strip.rail(1)], bbox: strip.patch.bbox(), table }
    }
}

/// Bounds the distance of every point from the nearest strip. Stopped early, the points not reached keep infinite
/// bounds.
pub fn points(strips: &[Strip], points: &[Vec3], control: &Control) -> PointCertificate {
    const CHUNK: usize = 20_000;
    let targets: Vec<Target> = strips.iter().map(Target::of).collect();
    let mut bounds = Vec::with_capacity(points.len());
    let mut places = Vec::with_capacity(points.len());
    let mut signed = Vec::with_capacity(points.len());
    for (k, chunk) in points.chunks(CHUNK).enumerate() {
        if control.stopped() {
            bounds.extend(vec![f64::INFINITY; chunk.len()]);
            places.extend(vec![(0, 0.0, 0.0); chunk.len()]);
            signed.extend(vec![f64::INFINITY; chunk.len()]);
            continue;
        }
        control.report("proving", (k * CHUNK) as f64 / points.len() as f64, format!("{} points", points.len()));
        let found: Vec<(f64, (u32, f32, f32), f64)> = parallel::map(chunk.iter(), |x| nearest(&targets, x));
        for (b, p, s) in found {
            bounds.push(b);
            places.push(p);
            signed.push(s);
        }
    }
    let worst = (0..bounds.len()).max_by(|&i, &j| bounds[i].total_cmp(&bounds[j]));
    PointCertificate { bounds, places, signed, worst }
}

/// The same for one strip and some of the points, by their numbers; the others are on no strip.
pub(crate) fn on_strip(strip: &Strip, all: &[Vec3], own: &BTreeSet<u32>, control: &Control) -> PointCertificate {
    let of: Vec<usize> = own.iter().map(|i| *i as usize).filter(|i| *i < all.len()).collect();
    let some: Vec<Vec3> = of.iter().map(|i| all[*i]).collect();
    let found = points(std::slice::from_ref(strip), &some, control);
    let none = f64::INFINITY;
    let mut out = PointCertificate {
        bounds: vec![none; all.len()],
        places: vec![(u32::MAX, 0.0, 0.0); all.len()],
        signed: vec![none; all.len()],
        worst: found.worst.map(|k| of[k]),
    };
    for (k, i) in of.into_iter().enumerate() {
        (out.bounds[i], out.places[i], out.signed[i]) = (found.bounds[k], found.places[k], found.signed[k]);
    }
    out
}

fn nearest(targets: &[Target], x: &Vec3) -> (f64, (u32, f32, f32), f64) {
    let mut best = (f64::INFINITY, (0, 0.0, 0.0), f64::INFINITY);
    for (k, t) in targets.iter().enumerate() {
        let outside = t.outside(x);
        if outside >= best.0 {
            continue;
        }
        let (u, v) = place(t, x);
        let bound = distance_bound(t, u, v, x);
        if bound < best.0 {
            let jet = t.strip.patch.jet(u, v);
            let side = if jet.normal().dot(&(x - jet.p)) < 0.0 { -1.0 } else { 1.0 };
            best = (bound, (k as u32, u as f32, v as f32), side * bound);
        }
    }
    best
}

/// Parameters of a place of the strip near `x`.
fn place(t: &Target, x: &Vec3) -> (f64, f64) {
    let mut best = (f64::INFINITY, 0.0, 0.0);
    for (u, p, d) in &t.table {
        let w = x - p;
        let dd = d.norm_squared();
        let v = if dd > 0.0 { (w.dot(d) / dd).clamp(0.0, 1.0) } else { 0.0 };
        let sq = (w - d * v).norm_squared();
        if sq < best.0 {
            best = (sq, *u, v);
        }
    }
    let (from, to) = t.strip.domain();
    let (mut here, mut u, mut v) = best;
    for _ in 0..STEPS {
        let j = t.strip.patch.jet(u, v);
        let w = x - j.p;
        let (a, b, c) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
        let (p, q) = (w.dot(&j.du), w.dot(&j.dv));
        let det = a * c - b * b;
        let (mut du, dv) =
            if det > DEPENDENT * a * c { ((c * p - b * q) / det, (a * q - b * p) / det) } else { (p / a, 0.0) };
        let next_v = (v + dv).clamp(0.0, 1.0);
        if next_v != v + dv && a > 0.0 {
            du = (p - b * (next_v - v)) / a;
        }
        let next_u = (u + du).clamp(from, to);
        if !(next_u.is_finite() && next_v.is_finite()) {
            break;
        }
        let sq = (x - t.strip.patch.point(next_u, next_v)).norm_squared();
        if sq >= here {
            break;
        }
        let gain = here - sq;
        (here, u, v) = (sq, next_u, next_v);
        if gain <= LEAST_GAIN * here {
            break;
        }
    }
    (u, v)
}

/// Upper bound of the distance from `x` to the point (u, v) of the strip, rounding included.
pub(super) fn distance_bound(t: &Target, u: f64, v: f64, x: &Vec3) -> f64 {
    let knots = &t.rails[0].knots;
    let p = knots.degree();
    let span = knots.span(u);
    let args = vec![Interval::from(u); p];
    let ends = [0, 1].map(|side| {
        let mut net: Vec<[Interval; 4]> =
            t.rails[side].control[span - p..=span].iter().map(|c| c.map(Interval::from)).collect();
        of_piece(knots, span, &mut net, &args)
    });
    // Homogeneous blend: some point of the ruling, whatever the weights.
    let (s, r) = (Interval::from(v), Interval::ONE - Interval::from(v));
    let h: [Interval; 4] = std::array::from_fn(|d| r * ends[0][d] + s * ends[1][d]);
    let mut sum = Interval::ZERO;
    for d in 0..3 {
        let e = h[d] / h[3] - Interval::from(x[d]);
        sum += e * e;
    }
    let bound = sum.hi.max(0.0).sqrt();
    // The square root is correctly rounded; one step up covers it.
    if bound.is_finite() {
        bound.next_up()
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::form::PanelKind;

    #[test]
    fn bounds_are_distances_on_a_plane_and_never_less() {
        let strip = Strip::quad(
            "A",
            PanelKind::Plane,
            [Vec3::zeros(), Vec3::new(0.0, 10.0, 0.0)],
            [Vec3::new(20.0, 0.0, 0.0), Vec3::new(20.0, 10.0, 0.0)],
        )
        .expect("a strip");
        let x = [
            Vec3::new(5.0, 5.0, 0.3),
            Vec3::new(-3.0, 5.0, 4.0),
            Vec3::new(7.3, 10.0, -0.1),
            Vec3::new(23.0, 14.0, 0.0),
        ];
        let c = points(&[strip], &x, &Control::default());
        for (b, d) in c.bounds().iter().zip([0.3, 5.0, 0.1, 5.0]) {
            assert!(*b >= d - 1e-15 && *b <= d + 1e-9, "{b} {d}");
        }
        assert!(c.worst_bound().value() >= 5.0);
        assert_eq!(c.beyond(0.2), 3);
        assert!(points(&[], &x, &Control::default()).bounds()[0].is_infinite());
    }
}
