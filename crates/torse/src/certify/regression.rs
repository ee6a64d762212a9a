//! Proof that the regression curve of a strip keeps its distance and stays out of zones.
//!
//! *Method.* Between rails a(u), b(u) with ruling `r = b − a` the surface is singular where `(1 − λ) a' × r + λ b' × r`
//! vanishes. If its product with a fixed vector keeps its sign at both ends of an interval of λ, no regression point is
//! in it \[PW99, 4.4: the wedge of Lemma 5, in primal form\]. Both ends are enclosed over cells of u in interval
//! arithmetic \[MKC09\], which are halved until the sign is known. Nothing here needs the strip to be developable.
//! *Not guaranteed*: an answer where the curve only just keeps its distance, or anything about regression points farther
//! away than a thousand diagonals of the strip, where rulings are parallel up to rounding.

use super::claim::LowerBound;
use super::ruled::Ruled;
use super::vector::{cross, dot, exact, length, V3};
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::torse::strip::Strip;
use crate::torse::zone::{RegressionLimits, Zone};

/// The answer of [`regression`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RegressionVerdict {
    /// Proven: no regression point is out of bounds.
    Clear,
    /// The regression point of the ruling at `u` is out of bounds.
    Meets {
        /// Parameter of the ruling.
        u: f64,
        /// The regression point, mm.
        at: Vec3,
    },
    /// Neither could be shown around the ruling at `u`.
    Undecided {
        /// Parameter of the ruling.
        u: f64,
    },
}

/// Halvings of a span before the answer is given up.
const DEEPEST: usize = 14;
/// Cells looked at before the answer is given up: where the curve nearly is out of bounds all along, they get ever
/// smaller.
const MOST_CELLS: usize = 60_000;
/// Diagonals of the strip beyond which regression points are as good as at infinity: coordinates of rulings have some
/// 1e-13 of rounding, which moves points out there by themselves.
const FAR: f64 = 1e3;
/// Rulings whose regression points are looked at before the proof.
const LOOKS: usize = 256;

/// Whether the regression curve of a strip keeps to its limits.
pub fn regression(strip: &Strip, limits: &RegressionLimits) -> RegressionVerdict {
    let far = FAR * strip.patch.bbox().diagonal();
    looked_through(strip, &|c| c.is_clear(limits, far), &|u| meeting(strip, u, limits))
}

/// Whether every cell is clear; `meets` finds the regression point of a ruling that is out of bounds.
fn looked_through(
    strip: &Strip,
    is_clear: &dyn Fn(&Cell) -> bool,
    meets: &dyn Fn(f64) -> Option<Vec3>,
) -> RegressionVerdict {
    let (from, to) = strip.domain();
    for k in 0..=LOOKS {
        let u = from + (to - from) * k as f64 / LOOKS as f64;
        if let Some(at) = meets(u) {
            return RegressionVerdict::Meets { u, at };
        }
    }
    let Some(ruled) = Ruled::new(&strip.patch) else { return RegressionVerdict::Undecided { u: from } };
    let breaks = ruled.breaks();
    let mut waiting: Vec<(f64, f64, usize)> = breaks.windows(2).map(|w| (w[0], w[1], 0)).collect();
    let mut cells = 0;
    while let Some((a, b, depth)) = waiting.pop() {
        cells += 1;
        if Cell::over(strip, &ruled, a, b).is_some_and(|c| is_clear(&c)) {
            continue;
        }
        let u = 0.5 * (a + b);
        if depth >= DEEPEST || cells >= MOST_CELLS || u <= a || u >= b {
            return match meets(u) {
                Some(at) => RegressionVerdict::Meets { u, at },
                None => RegressionVerdict::Undecided { u },
            };
        }
        waiting.extend([(a, u, depth + 1), (u, b, depth + 1)]);
    }
    RegressionVerdict::Clear
}

/// What remains of a sampled distance for the proof, in turn.
const SHARES: [f64; 4] = [0.99, 0.95, 0.75, 0.4];
/// Lengths of the rulings beyond which a margin says no more than that they are as good as parallel.
const MOST_MARGIN: f64 = 10.0;

/// How many lengths of its ruling the regression curve of a strip provably keeps off on every ruling, close to the most
/// there is but no more than ten or twice what is `asked`, which is tried, too. 0 if nothing could be shown.
pub(crate) fn margin_bound(strip: &Strip, asked: f64) -> LowerBound {
    let (from, to) = strip.domain();
    let share = |u: f64| {
        let [p, q] = strip.ruling(u);
        strip.regression_clearance(u) / (q - p).norm()
    };
    let sampled = (0..=LOOKS)
        .map(|k| share(from + (to - from) * k as f64 / LOOKS as f64))
        .fold(MOST_MARGIN.max(2.0 * asked), f64::min);
    let proven = |m: f64| {
        let clear = |c: &Cell| c.is_clear_on(-Interval::point(m), Interval::ONE + Interval::point(m));
        looked_through(strip, &clear, &|_| None) == RegressionVerdict::Clear
    };
    let mut tried: Vec<f64> = SHARES.iter().map(|s| s * sampled).chain([asked]).filter(|m| *m <= sampled).collect();
    tried.sort_by(|a, b| b.total_cmp(a));
    tried.into_iter().find(|&m| m > 0.0 && proven(m)).map_or(LowerBound::UNKNOWN, LowerBound::shown)
}

/// A distance (mm) along the rulings that the regression curve of a strip provably keeps, close to the largest there is
/// but no more than some ten diagonals of the strip; 0 if none could be shown.
pub(crate) fn clearance_bound(strip: &Strip) -> LowerBound {
    // More than this many diagonals says no more than that rulings are as good as parallel, and takes long to prove.
    const MOST_DIAGONALS: f64 = 10.0;
    let (from, to) = strip.domain();
    let sampled = (0..=LOOKS)
        .map(|k| strip.regression_clearance(from + (to - from) * k as f64 / LOOKS as f64))
        .fold(MOST_DIAGONALS * strip.patch.bbox().diagonal(), f64::min);
    let proven = |c: f64| {
        let limits = RegressionLimits { clearance: c, zones: Vec::new() };
        regression(strip, &limits) == RegressionVerdict::Clear
    };
    SHARES.iter().map(|s| s * sampled).find(|&c| c > 0.0 && proven(c)).map_or(LowerBound::UNKNOWN, LowerBound::shown)
}

/// The regression point at `u` if it is out of bounds.
fn meeting(strip: &Strip, u: f64, limits: &RegressionLimits) -> Option<Vec3> {
    let (p, q) = (strip.patch.jet(u, 0.0), strip.patch.jet(u, 1.0));
    let r = q.p - p.p;
    let n = strip.patch.jet(u, 0.5).normal();
    let (f0, f1) = (p.du.cross(&r).dot(&n), q.du.cross(&r).dot(&n));
    let (share, size) = (f0 / (f0 - f1), r.norm());
    if !share.is_finite() {
        // Parallel rulings, unless there is no ruling at all.
        return (size <= 0.0).then_some(p.p);
    }
    let s = share * size;
    if s.abs() > FAR * strip.patch.bbox().diagonal() {
        return None;
    }
    limits.forbid(&p.p, &(r / size), (0.0, size), s).then(|| p.p + r * share)
}

/// Enclosures over an interval of u.
struct Cell {
    /// End a of the rulings.
    a: V3<Interval>,
    /// Rulings b − a.
    r: V3<Interval>,
    /// Length of the rulings.
    size: Interval,
    /// Products of `a' × r` and `b' × r` with a fixed normal.
    ends: [Interval; 2],
    /// Their difference, the product of `r' × r`: narrow where rulings are nearly parallel.
    gap: Interval,
}

impl Cell {
    fn over(strip: &Strip, ruled: &Ruled, from: f64, to: f64) -> Option<Self> {
        let origin = ruled.middle(0.5 * (from + to));
        let normal = strip.patch.jet(0.5 * (from + to), 0.5).normal();
        let normal = exact(&(normal / normal.norm()));
        let h = Interval::point(to) - Interval::point(from);
        let rails = [0, 1].map(|end: usize| ruled.end(end, from, to, &origin));
        let side = |end: usize| -> (V3<Interval>, V3<Interval>) {
            let c = &rails[end];
            let p = c[0].len() - 1;
            let hull = |d: usize| c[d].iter().skip(1).fold(c[d][0], |a, b| a.hull(*b));
            let slope = |d: usize| {
                let all = c[d].windows(2).map(|w| w[1] - w[0]);
                all.reduce(Interval::hull).unwrap_or(Interval::ZERO) * Interval::point(p as f64) / h
            };
            let (w, dw) = (hull(3), slope(3));
            let place = [0, 1, 2].map(|d| hull(d) / w);
            // Derivative of a quotient, with the quotient at hand.
            let speed = [0, 1, 2].map(|d| (slope(d) - place[d] * dw) / w);
            (place, speed)
        };
        let ((a, da), (b, db)) = (side(0), side(1));
        let r = [0, 1, 2].map(|d| b[d] - a[d]);
        let ends = [da, db].map(|v| dot(&cross(&v, &r), &normal));
        // Without weights the difference of the rails is a polynomial itself.
        let gap = if ruled.rational {
            ends[1] - ends[0]
        } else {
            let [p, q] = &rails;
            let slope = [0, 1, 2].map(|d: usize| {
                let c: Vec<Interval> = p[d].iter().zip(&q[d]).map(|(x, y)| *y - *x).collect();
                let degree = Interval::point((c.len() - 1) as f64);
                c.windows(2).map(|w| w[1] - w[0]).reduce(Interval::hull).unwrap_or(Interval::ZERO) * degree / h
            });
            dot(&cross(&slope, &r), &normal)
        };
        let a = [0, 1, 2].map(|d| a[d] + Interval::point(origin[d]));
        let size = length(&r);
        (ends.iter().all(|e| e.is_finite()) && size.lo > 0.0).then_some(Self { a, r, size, ends, gap })
    }

    /// Whether no regression point with a share λ in `[from, to]` of the ruling exists.
    fn is_clear_on(&self, from: Interval, to: Interval) -> bool {
        let at = |l: Interval| (self.ends[0] + l * self.gap).sign();
        // Written with each product once, whichever is tighter.
        let other = |l: Interval| ((Interval::ONE - l) * self.ends[0] + l * self.ends[1]).sign();
        let sign = |l: Interval| if at(l) == 0 { other(l) } else { at(l) };
        let (s, t) = (sign(from), sign(to));
        s != 0 && s == t
    }

    fn is_clear(&self, limits: &RegressionLimits, far: f64) -> bool {
        let reach = Interval::point(limits.clearance) / self.size;
        if !self.is_clear_on(-reach, Interval::ONE + reach) {
            return false;
        }
        limits.zones.iter().all(|z| match self.shares(z, far) {
            None => true,
            Some((from, to)) => self.is_clear_on(Interval::point(from), Interval::point(to)),
        })
    }

    /// Shares of the rulings between which they may be in a zone, `far` (mm) at most; `None` if none is.
    fn shares(&self, zone: &Zone, far: f64) -> Option<(f64, f64)> {
        let most = (Interval::point(far) / self.size).hi + 1.0;
        let (mut from, mut to) = (-most, most);
        // Ranges that rulings cross bound the shares; then all ranges together may exclude them.
        for (k, (lo, hi)) in zone.ranges.iter().enumerate().filter(|(k, _)| self.r[*k].sign() != 0) {
            let share = |x: f64| (Interval::point(x) - self.a[k]) / self.r[k];
            let up = self.r[k].lo > 0.0;
            for (x, start) in [(*lo, up), (*hi, !up)].into_iter().filter(|x| x.0.is_finite()) {
                if start {
                    from = from.max(share(x).lo);
                } else {
                    to = to.min(share(x).hi);
                }
            }
        }
        let reached = |k: usize, (lo, hi): &(f64, f64)| {
            let x = self.a[k] + self.r[k] * Interval { lo: from, hi: to };
            x.hi >= *lo && x.lo <= *hi
        };
        (from <= to && zone.ranges.iter().enumerate().all(|(k, range)| reached(k, range))).then_some((from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::form::PanelKind;

    /// A cone with apex at the origin between spheres of radius 2 and 3 (mm), as a strip with rational rails.
    fn cone() -> Strip {
        let w = (0.5_f64).sqrt();
        let rail = |s: f64| {
            let h = [[s, 0.0, s, 1.0], [s * w, s * w, s * w, w], [0.0, s, s, 1.0]];
            crate::spline::curve::Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], h.to_vec()).expect("a rail")
        };
        Strip::between("A", PanelKind::Cone, &rail(2.0), &rail(3.0)).expect("a strip")
    }

    #[test]
    fn the_apex_of_a_cone_is_as_far_as_it_is() {
        let far = 8.0_f64.sqrt();
        let bound = clearance_bound(&cone()).value();
        assert!(bound <= far && bound >= 0.98 * far, "{bound}");
        let ask = |clearance: f64| regression(&cone(), &RegressionLimits { clearance, zones: Vec::new() });
        assert_eq!(ask(0.97 * far), RegressionVerdict::Clear);
        assert!(matches!(ask(1.01 * far), RegressionVerdict::Meets { at, .. } if at.norm() < 1e-9));
    }

    #[test]
    fn margins_are_counted_in_lengths_of_the_ruling() {
        // The apex is two lengths of every ruling before its nearer end.
        let bound = margin_bound(&cone(), 0.05).value();
        assert!((1.96..=2.0).contains(&bound), "{bound}");
        // What is asked for is shown where it is nearly all there is.
        assert_eq!(margin_bound(&cone(), 1.99).value(), 1.99);
        assert!(margin_bound(&cone(), 2.001).value() < 2.0);
    }

    #[test]
    fn zones_are_kept_clear_or_met() {
        let ask = |z: Zone| regression(&cone(), &RegressionLimits { clearance: 0.0, zones: vec![z] });
        assert_eq!(ask(Zone::slab(2, 0.1, 9.0)), RegressionVerdict::Clear);
        assert!(matches!(ask(Zone::slab(2, -0.1, 0.1)), RegressionVerdict::Meets { .. }));
        assert_eq!(ask(Zone::slab(2, -9.0, -0.1)), RegressionVerdict::Clear);
        let cube = |z: f64| Zone { ranges: [(-1.0, 1.0), (-1.0, 1.0), (z, z + 1.0)] };
        assert_eq!(ask(cube(0.2)), RegressionVerdict::Clear);
        assert!(matches!(ask(cube(-0.5)), RegressionVerdict::Meets { .. }));
        // Rulings that miss a zone leave it alone.
        let beside = Zone { ranges: [(-5.0, -4.0), (-5.0, -4.0), (4.0, 5.0)] };
        assert_eq!(ask(beside), RegressionVerdict::Clear);
    }

    #[test]
    fn parallel_rulings_keep_their_curve_far_away() {
        let x = |u: f64, v: f64| Vec3::new(100.0 * u, 50.0 * v, 30.0 * u * u);
        let strip = Strip::quad("A", PanelKind::Cylinder, [x(0.0, 0.0), x(0.0, 1.0)], [x(1.0, 0.0), x(1.0, 1.0)]);
        let strip = strip.expect("a strip");
        assert!(clearance_bound(&strip).value() > 9.0 * strip.patch.bbox().diagonal());
        let limits = |z: Zone| RegressionLimits { clearance: 0.0, zones: vec![z] };
        assert_eq!(regression(&strip, &limits(Zone::slab(1, 60.0, 1e6))), RegressionVerdict::Clear);
        assert_eq!(regression(&strip, &limits(Zone::slab(0, -1e6, 1e6))), RegressionVerdict::Clear);
    }

    #[test]
    fn a_strip_through_its_regression_point_is_never_clear() {
        let x = |p: [f64; 3]| Vec3::from(p);
        let bow = Strip::quad(
            "A",
            PanelKind::Torse,
            [x([0.0, 0.0, 0.0]), x([1.0, 1.0, 0.0])],
            [x([1.0, 0.0, 0.0]), x([0.0, 1.0, 0.0])],
        );
        let bow = bow.expect("a strip");
        assert_ne!(regression(&bow, &RegressionLimits::default()), RegressionVerdict::Clear);
        assert!(clearance_bound(&bow).value() <= 0.0);
    }
}
