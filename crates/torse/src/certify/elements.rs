//! How near given rulings and tangent planes are to strips: a proven bound for each of them.
//!
//! *Method.* Each part of a given ruling is compared with a ruling of a strip end by end; between its ends the distance
//! from a segment is convex, so that the bound holds for all points of the given ruling. A given plane is compared over
//! its region of interest, a disc in it, with a tangent plane of a strip: the plane of a ruling and the homogeneous
//! derivative across it, as in \[PW99, 2\]. Of a plane that is given with its ruling the angle is bounded on the nearest
//! ruling. The best parameter is searched with plain numbers; the bound is evaluated
//! in interval arithmetic \[MKC09\] from the numbers of the patch that are written.
//! *Not guaranteed*: that a bound is the distance, or anything about the surface between the given elements.

use super::claim::UpperBound;
use super::joints::angle;
use super::points::{distance_bound, Target};
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::spline::blossom::of_piece;
use crate::spline::curve::Curve;
use crate::torse::contact::ContactElement;
use crate::torse::strip::Strip;

/// Proven distances of rulings and planes from strips.
#[derive(Clone, Debug)]
pub struct ElementCertificate {
    bounds: Vec<f64>,
    places: Vec<(u32, f64)>,
    turns: Vec<Option<f64>>,
}

impl ElementCertificate {
    /// For each element a number that its distance does not exceed, mm: of all points of a ruling from a strip, of a
    /// plane over its region from the nearest tangent plane; infinite without strips.
    pub fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// For each element the strip and the parameter u that give its bound.
    pub fn places(&self) -> &[(u32, f64)] {
        &self.places
    }

    /// Index of the element with the largest bound.
    pub fn worst(&self) -> Option<usize> {
        (0..self.bounds.len()).max_by(|&i, &j| self.bounds[i].total_cmp(&self.bounds[j]))
    }

    /// The element with a ruling whose plane is turned farthest from the tangent plane of its strip on the ruling nearest to its
    /// middle, and a bound of the angle between both, rad; `None` without rulings.
    pub fn most_turned(&self) -> Option<(usize, UpperBound)> {
        let turn = |(i, t): (usize, &Option<f64>)| t.map(|t| (i, t));
        let worst = self.turns.iter().enumerate().filter_map(turn).max_by(|a, b| a.1.total_cmp(&b.1));
        worst.map(|(i, t)| (i, UpperBound::shown(t)))
    }

    /// Bound of the largest distance, mm; unknown without elements.
    pub fn worst_bound(&self) -> UpperBound {
        self.worst().map_or(UpperBound::UNKNOWN, |i| UpperBound::shown(self.bounds[i]))
    }

    /// Bound of the largest distance, mm, of the elements whose bound comes from a strip; unknown if there are none.
    pub fn worst_bound_on(&self, strip: usize) -> UpperBound {
        let own = self.places.iter().zip(&self.bounds).filter(|(p, _)| p.0 as usize == strip);
        UpperBound::largest(own.map(|(_, b)| UpperBound::shown(*b)))
    }

    /// Number of elements whose bound exceeds a tolerance, mm.
    pub fn beyond(&self, tolerance: f64) -> usize {
        self.bounds.iter().filter(|b| b.is_nan() || **b > tolerance).count()
    }
}

/// Parts of a ruling that are compared for themselves: a ruling of the strip that crosses the given one at a small angle
/// is then near enough on each part.
const PARTS: usize = 16;

/// Bounds the distance of every element from the nearest strip. Stopped early, elements not reached keep infinite
/// bounds.
pub fn elements(strips: &[Strip], elements: &[ContactElement], control: &Control) -> ElementCertificate {
    let targets: Vec<Target> = strips.iter().map(Target::of).collect();
    let found: Vec<(f64, (u32, f64))> = parallel::map(elements.iter(), |e| {
        let mut best = (f64::INFINITY, (0, 0.0));
        // Rulings are at least as far from a strip as their ends are from its box: the nearest boxes come first.
        let away = |t: &Target| if e.has_ruling() { t.outside(&e.ends[0]).max(t.outside(&e.ends[1])) } else { 0.0 };
        let mut order: Vec<(f64, usize)> = targets.iter().map(away).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (outside, k) in order {
            if control.stopped() || outside > best.0 {
                break;
            }
            let t = &targets[k];
            let (bound, u) = if e.has_ruling() { of_ruling(t, e) } else { of_plane(t, e) };
            if bound < best.0 {
                best = (bound, (k as u32, u));
            }
        }
        best
    });
    let turn = |(e, (bound, (k, u))): (&ContactElement, &(f64, (u32, f64)))| {
        let on = targets.get(*k as usize).filter(|_| bound.is_finite());
        e.has_ruling().then(|| on.map_or(f64::INFINITY, |t| plane_turn(t, *u, e)))
    };
    ElementCertificate {
        turns: elements.iter().zip(&found).map(turn).collect(),
        bounds: found.iter().map(|f| f.0).collect(),
        places: found.iter().map(|f| f.1).collect(),
    }
}

/// The parameter with the least value: best of the table, then golden sections around it.
fn least(t: &Target, value: impl Fn(f64) -> f64) -> f64 {
    // Enough to narrow a table's spacing to the square root of rounding, where the value is flat.
    const SECTIONS: usize = 50;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let at: Vec<(f64, f64)> = t.table.iter().map(|r| (value(r.0), r.0)).collect();
    let i = (0..at.len()).min_by(|&i, &j| at[i].0.total_cmp(&at[j].0)).unwrap_or(0);
    let (mut a, mut b) = (at[i.saturating_sub(1)].1, at[(i + 1).min(at.len() - 1)].1);
    let (mut best, mut u) = at[i];
    let mut tried = |x: f64| {
        let v = value(x);
        if v < best {
            (best, u) = (v, x);
        }
        (v, x)
    };
    let (mut p, mut q) = (tried(b - GOLDEN * (b - a)), tried(a + GOLDEN * (b - a)));
    for _ in 0..SECTIONS {
        // One of both divides what is left in the same ratio.
        if p.0 < q.0 {
            (b, q) = (q.1, p);
            p = tried(b - GOLDEN * (b - a));
        } else {
            (a, p) = (p.1, q);
            q = tried(a + GOLDEN * (b - a));
        }
    }
    u
}

/// Share along the ruling of the point nearest `x`.
fn share(p: &Vec3, d: &Vec3, x: &Vec3) -> f64 {
    let dd = d.norm_squared();
    if dd > 0.0 {
        ((x - p).dot(d) / dd).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The largest bound of the parts of a ruling, and the parameter for its middle part.
fn of_ruling(t: &Target, e: &ContactElement) -> (f64, f64) {
    let at = |k: usize| {
        let s = k as f64 / PARTS as f64;
        // The last part ends where the ruling ends, to the last digit.
        if k == PARTS {
            e.ends[1]
        } else {
            e.ends[0] * (1.0 - s) + e.ends[1] * s
        }
    };
    let parts = (0..PARTS).map(|k| of_part(t, &[at(k), at(k + 1)]));
    let (mut worst, mut middle) = (0.0_f64, 0.0);
    for (k, (bound, u)) in parts.enumerate() {
        worst = worst.max(bound);
        if k == PARTS / 2 {
            middle = u;
        }
    }
    // Inner points are rounded: they lie off the segment by less than this.
    let size = e.ends.iter().map(|x| x.amax()).fold(0.0, f64::max);
    ((worst + 4.0 * f64::EPSILON * size).next_up(), middle)
}

fn of_part(t: &Target, ends: &[Vec3; 2]) -> (f64, f64) {
    let u = least(t, |u| {
        let [p, q] = t.strip.ruling(u);
        let d = q - p;
        let off = |x: &Vec3| (p + d * share(&p, &d, x) - x).norm_squared();
        off(&ends[0]).max(off(&ends[1]))
    });
    let [p, q] = t.strip.ruling(u);
    let d = q - p;
    // The homogeneous parameter of an affine share, with the weights of both rails.
    let weights = [0, 1].map(|k| t.rails[k].point(u)[3]);
    let bound = |x: &Vec3| {
        let l = share(&p, &d, x);
        let v = l * weights[0] / (l * weights[0] + (1.0 - l) * weights[1]);
        distance_bound(t, u, v, x)
    };
    (bound(&ends[0]).max(bound(&ends[1])), u)
}

fn of_plane(t: &Target, e: &ContactElement) -> (f64, f64) {
    let c = e.centre();
    let normal = e.normal.normalize();
    let u = least(t, |u| {
        let jet = t.strip.patch.jet(u, 0.5);
        let n = jet.normal().normalize();
        n.dot(&(c - jet.p)).abs() + e.radius * n.cross(&normal).norm()
    });
    (plane_bound(t, u, e, &c), u)
}

/// Coordinates `(n, −h)` of the tangent plane at `u`, with the origin moved to `c`: near the region, so that large
/// coordinates do not cancel in the determinants.
fn tangent_plane(t: &Target, u: f64, c: &Vec3) -> [Interval; 4] {
    let jets = [0, 1].map(|k| jet(&t.rails[k], u, c));
    let across: [Interval; 4] = std::array::from_fn(|d| jets[0].1[d] + jets[1].1[d]);
    through(&jets[0].0, &jets[1].0, &across)
}

/// Length of a vector.
fn norm(v: &[Interval; 3]) -> Interval {
    root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
}

/// Cross product of a vector and a given one.
fn cross(n: &[Interval; 3], given: &Vec3) -> [Interval; 3] {
    let given = given.map(Interval::from);
    std::array::from_fn(|i| n[(i + 1) % 3] * given[(i + 2) % 3] - n[(i + 2) % 3] * given[(i + 1) % 3])
}

/// Upper bound (rad) of the angle between the element's plane and the tangent plane at `u`, whichever sides they show.
fn plane_turn(t: &Target, u: f64, e: &ContactElement) -> f64 {
    let [x, y, z, _] = tangent_plane(t, u, &e.centre());
    let n = [x, y, z];
    let given = e.normal.map(Interval::from);
    let cosine = n[0] * given[0] + n[1] * given[1] + n[2] * given[2];
    let turn = angle(norm(&cross(&n, &e.normal)), if cosine.hi < 0.0 { -cosine } else { cosine });
    // Planes are never more than a right angle apart.
    turn.min(std::f64::consts::FRAC_PI_2.next_up())
}

/// Upper bound of the distance between the element's plane, over its disc, and the tangent plane at `u`.
fn plane_bound(t: &Target, u: f64, e: &ContactElement, c: &Vec3) -> f64 {
    let [x, y, z, off] = tangent_plane(t, u, c);
    let n = [x, y, z];
    let length = norm(&n);
    let own = norm(&e.normal.map(Interval::from).into());
    let sine = norm(&cross(&n, &e.normal)) / (length * own);
    let bound = (off / length).abs().hi + (Interval::from(e.radius) * sine).hi;
    // One sum of two numbers, rounded to nearest.
    if bound.is_finite() {
        bound.next_up()
    } else {
        f64::INFINITY
    }
}

/// Enclosure of the square root; the root of a double is correctly rounded.
fn root(x: Interval) -> Interval {
    Interval { lo: x.lo.max(0.0).sqrt().next_down().max(0.0), hi: x.hi.max(0.0).sqrt().next_up() }
}

/// Value and derivative of a homogeneous curve, with the origin moved to a point.
fn jet(curve: &Curve<4>, u: f64, origin: &Vec3) -> ([Interval; 4], [Interval; 4]) {
    let knots = &curve.knots;
    let p = knots.degree();
    let span = knots.span(u);
    let (a, b) = (knots.values()[span], knots.values()[span + 1]);
    let blossom = |last: f64| {
        let mut args = vec![Interval::from(u); p];
        args[p - 1] = Interval::from(last);
        let mut net: Vec<[Interval; 4]> =
            curve.control[span - p..=span].iter().map(|c| c.map(Interval::from)).collect();
        for h in &mut net {
            (0..3).for_each(|d| h[d] = h[d] - h[3] * Interval::from(origin[d]));
        }
        of_piece(knots, span, &mut net, &args)
    };
    let (value, low, high) = (blossom(u), blossom(a), blossom(b));
    let scale = Interval::from(p as f64) / (Interval::from(b) - Interval::from(a));
    (value, std::array::from_fn(|d| scale * (high[d] - low[d])))
}

/// Coordinates `(n, −h)` of the plane through three homogeneous points.
fn through(a: &[Interval; 4], b: &[Interval; 4], c: &[Interval; 4]) -> [Interval; 4] {
    let minor = |i: usize, j: usize, k: usize| {
        a[i] * (b[j] * c[k] - b[k] * c[j]) - a[j] * (b[i] * c[k] - b[k] * c[i]) + a[k] * (b[i] * c[j] - b[j] * c[i])
    };
    [minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::form::PanelKind;

    fn quad() -> Strip {
        Strip::quad(
            "A",
            PanelKind::Plane,
            [Vec3::zeros(), Vec3::new(0.0, 10.0, 0.0)],
            [Vec3::new(20.0, 0.0, 0.0), Vec3::new(20.0, 10.0, 0.0)],
        )
        .expect("a strip")
    }

    #[test]
    fn rulings_and_planes_above_a_plane_have_their_distance() {
        let z = Vec3::new(0.0, 0.0, 1.0);
        let ruling = ContactElement {
            normal: z,
            ends: [Vec3::new(5.0, 1.0, 0.2), Vec3::new(5.0, 8.0, 0.5)],
            radius: 1.0,
            weight: 1.0,
        };
        let level = ContactElement { normal: z, ends: [Vec3::new(5.0, 5.0, 0.3); 2], radius: 2.0, weight: 1.0 };
        let tilted = ContactElement {
            normal: Vec3::new(0.6, 0.0, 0.8),
            ends: [Vec3::new(5.0, 5.0, 0.0); 2],
            radius: 2.0,
            weight: 1.0,
        };
        let got = elements(&[quad()], &[ruling, level, tilted], &Control::default());
        for (b, d) in got.bounds().iter().zip([0.5, 0.3, 1.2]) {
            assert!(*b >= d - 1e-12 && *b <= d + 1e-6, "{b} {d}");
        }
        assert_eq!((got.worst(), got.beyond(0.4)), (Some(2), 2));
        assert!(elements(&[], &[ruling], &Control::default()).bounds()[0].is_infinite());
    }

    #[test]
    fn planes_of_rulings_have_their_angle_from_the_strip() {
        let turned = |angle: f64| ContactElement {
            normal: Vec3::new(angle.sin(), 0.0, angle.cos()),
            ends: [Vec3::new(5.0, 1.0, 0.0), Vec3::new(5.0, 8.0, 0.0)],
            radius: 1.0,
            weight: 1.0,
        };
        let half_turn = std::f64::consts::PI;
        for (given, is) in
            [(0.2, 0.2), (-0.3, 0.3), (half_turn, 0.0), (half_turn - 0.1, 0.1), (0.5 * half_turn, 0.5 * half_turn)]
        {
            let found = elements(&[quad()], &[turned(0.0), turned(given)], &Control::default());
            let (index, bound) = found.most_turned().expect("rulings");
            assert!(index == 1 || is == 0.0, "{given}: {index}");
            assert!(bound.value() >= is && bound.value() <= is + 1e-9, "{given}: {bound:?}");
        }
        let level = ContactElement { ends: [Vec3::new(5.0, 5.0, 0.0); 2], ..turned(0.2) };
        assert_eq!(elements(&[quad()], &[level], &Control::default()).most_turned(), None);
        let nothing = elements(&[], &[turned(0.2)], &Control::default()).most_turned().expect("a ruling").1;
        assert_eq!(nothing, UpperBound::UNKNOWN);
    }
}
