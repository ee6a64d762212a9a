//! One piece of an outline: how far an edge in space strays along a cone from the boundary of a ruled patch.
//!
//! *Method* (docs/algorithms/cones.md): both are polynomials of one parameter, the boundary after composition with the
//! patch \[FR88\]. Angle about the axis and distance along the ruling between their feet are enclosed with four
//! derivatives over the piece and sharply at its ends, like the distances from the cone.

use super::super::vector::{dot, V3};
use super::{ahead, component, Prepared, Quantity, Seen};
use crate::geom::Vec3;
use crate::num::bernstein::{self, difference, elevated, from_spline_over, hull, product, Scalar};
use crate::num::interval::Interval;
use crate::num::series::{hermite_range, Series};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::cone::spline::Shape;
use crate::torse::g1_element::G1Element;
use crate::torse::ruled_patch::{RuledPatch, RuledStrip};

/// Parameters by which a piece may pass a knot of the patch or an end of the strip, as a share of the interval: rounding
/// of what cut it there. It is paid for.
const PAST: f64 = 1e-9;

/// The boundary's patch and the strip that it was judged as.
pub(super) struct Ground<'a> {
    pub patch: &'a Surface,
    pub strip: &'a RuledPatch,
}

/// A piece: the boundary's curve over `[t, t']` and the edge over `[s, s']`, in this correspondence.
pub(super) struct SidePiece<'a> {
    pub border: (&'a Curve<2>, [f64; 2]),
    pub edge: (&'a EdgeCurve, [f64; 2]),
}

/// An edge as it stands in files.
pub(super) enum EdgeCurve {
    /// Straight.
    Line([Vec3; 2]),
    /// A polynomial spline.
    Spline(Curve<3>),
}

/// What was shown of a piece.
pub(super) struct Side {
    /// Every point on the paths along the cone between the feet of both is within this distance (mm) of the boundary.
    pub bound: f64,
    /// The same at both ends of the piece.
    pub at_ends: f64,
    /// Length of the paths, mm.
    pub path: f64,
    /// Distance of the edge from the cone, mm.
    pub off: f64,
}

/// A cone with the normal planes of its joints (`None` at the ends of the chain).
pub(super) struct ConeSegment {
    pub prepared: Prepared,
    pub front: Option<G1Element>,
    pub back: Option<G1Element>,
}

/// Polynomial coefficients over a piece.
type Form = Vec<Interval>;

/// Three coordinates enclosed over a piece, and at both its ends.
struct Enclosed {
    all: V3<Series<5>>,
    ends: [V3<Series<2>>; 2],
}

/// Bounds one piece; `None` where nothing can be said.
pub(super) fn side(ground: &Ground, cone: &ConeSegment, piece: &SidePiece) -> Option<Side> {
    let (x, slack) = boundary(ground, piece.border.0, piece.border.1)?;
    let y = piece.edge.0.enclosed(piece.edge.1);
    let p = &cone.prepared;
    // 1. Beyond the joints.
    let beyond = |e: &Enclosed| {
        let past = |g: &G1Element, sign: f64| {
            let [all] = [component(&super::from_point(&e.all, &g.point), &g.forward)];
            let [a, b] = e.ends.each_ref().map(|v| component(&super::from_point(v, &g.point), &g.forward));
            let range = hermite_range(&a, &b, &all).0;
            (range * sign).hi.max(0.0)
        };
        let front = cone.front.as_ref().map_or(0.0, |g| past(g, -1.0));
        front.max(cone.back.as_ref().map_or(0.0, |g| past(g, 1.0)))
    };
    let outside = beyond(&x) + beyond(&y);
    // 2. Feet.
    let seen = |e: &Enclosed| (p.seen(&e.all), e.ends.each_ref().map(|v| p.seen(v)));
    let ((xs, x_ends), (ys, y_ends)) = (seen(&x), seen(&y));
    let all = apart(p, (&xs, &x.all), (&ys, &y.all))?;
    let [a, b] = [0, 1].map(|k: usize| apart(p, (&x_ends[k], &x.ends[k]), (&y_ends[k], &y.ends[k])));
    let (a, b) = (a?, b?);
    let ranges: [Interval; 2] = std::array::from_fn(|k| hermite_range(&a[k], &b[k], &all[k]).0);
    let at_ends: [f64; 2] = std::array::from_fn(|k| a[k].0[0].mag().max(b[k].0[0].mag()));
    let distance = |s: &Seen<Series<5>>, e: &[Seen<Series<2>>; 2]| {
        hermite_range(&e[0].distance, &e[1].distance, &s.distance).0.mag()
    };
    let (from_x, from_y) = (distance(&xs, &x_ends), distance(&ys, &y_ends));
    let flat = matches!(p.segment.shape, Shape::Flat { .. });
    let rho = if flat { 1.0 } else { xs.rho.0[0].hi + from_x };
    let total = |turn: f64, slide: f64| -> Option<(f64, f64)> {
        let i = Interval::point;
        // On planes the first number is a length.
        let angle = if flat { 0.0 } else { turn };
        let path = i(turn) * i(rho) + i(slide);
        let d = i(from_x);
        // The path leaves the tangent plane at its beginning by at most half its length times its turn.
        let sum = (d.sqr() + path.sqr() + d * path * i(angle)).sqrt();
        // A step back to a joint's plane changes the distance and the place by its length at most.
        let bound = (sum + i(outside) * 2.0 + i(slack) * 2.0).hi;
        (angle <= 1.0 && bound.is_finite()).then_some((bound, path.hi))
    };
    let (bound, path) = total(ranges[0].mag(), ranges[1].mag())?;
    let (ends, _) = total(at_ends[0], at_ends[1])?;
    Some(Side { bound, at_ends: ends, path, off: from_y })
}

/// Turn about the axis (its tangent; a length on planes) and distance along the rulings between the feet of two points.
/// `None` where they may be a right angle apart.
fn apart<S: Quantity + Head>(p: &Prepared, x: (&Seen<S>, &V3<S>), y: (&Seen<S>, &V3<S>)) -> Option<[S; 2]> {
    if let Shape::Flat { .. } = p.segment.shape {
        let d: V3<S> = std::array::from_fn(|k| x.1[k] - y.1[k]);
        return Some([component(&d, &p.middle.forward), component(&d, &p.middle.direction)]);
    }
    let facing = dot(&x.0.q, &y.0.q);
    if facing.head().lo <= 0.0 {
        return None;
    }
    let turn = p.twist(x.0, y.0).over(facing);
    let z = x.0.z - y.0.z;
    let slide = match p.segment.shape {
        Shape::Cone { distance, cos_gamma, sin_gamma, .. } => {
            z.times(cos_gamma) + (x.0.rho - y.0.rho).times(distance.signum() * sin_gamma)
        }
        _ => z,
    };
    Some([turn, slide])
}

/// The value of something with derivatives.
trait Head {
    fn head(&self) -> Interval;
}

impl<const N: usize> Head for Series<N> {
    fn head(&self) -> Interval {
        self.0[0]
    }
}

/// Taylor coefficients over [0, 1] of a polynomial.
fn series(b: &[Interval]) -> Series<5> {
    let mut form = b.to_vec();
    let mut factorial = 1.0;
    Series(std::array::from_fn(|k| {
        if k > 0 {
            form = bernstein::derivative(&form);
            factorial *= k as f64;
        }
        hull(&form) / Interval::point(factorial)
    }))
}

/// Value and derivative of a polynomial at both ends of [0, 1].
fn at_ends(b: &[Interval]) -> [Series<2>; 2] {
    let n = b.len() - 1;
    if n == 0 {
        return [Series([b[0], Interval::ZERO]); 2];
    }
    [(b[0], b[1] - b[0]), (b[n], b[n] - b[n - 1])].map(|(v, d)| Series([v, d * n as f64]))
}

impl EdgeCurve {
    /// The point at a parameter, for matching.
    pub(super) fn point(&self, s: f64) -> Vec3 {
        match self {
            Self::Line([a, b]) => a + (b - a) * s,
            Self::Spline(c) => Vec3::from(c.point(s)),
        }
    }

    /// Parameters between which it is one polynomial.
    pub(super) fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Line(_) => vec![0.0, 1.0],
            Self::Spline(c) => c.knots.breaks(),
        }
    }

    fn enclosed(&self, [a, b]: [f64; 2]) -> Enclosed {
        let i = Interval::point;
        let forms: V3<Form> = match self {
            Self::Line(ends) => std::array::from_fn(|d| {
                [a, b].map(|s| i(ends[0][d]) * (Interval::ONE - i(s)) + i(ends[1][d]) * i(s)).to_vec()
            }),
            Self::Spline(c) => std::array::from_fn(|d| form_over(&c.knots, |k| i(c.control[k][d]), a, b)),
        };
        let ends = forms.each_ref().map(|f| at_ends(f));
        Enclosed { all: forms.each_ref().map(|f| series(f)), ends: [0, 1].map(|k: usize| ends.map(|e| e[k])) }
    }
}

/// Bernstein coefficients over `[a, b]`, in either order, inside one span.
fn form_over(knots: &Knots, value: impl Fn(usize) -> Interval, a: f64, b: f64) -> Form {
    let p = knots.degree();
    let span = knots.span(0.5 * (a + b));
    let net: Form = (span - p..=span).map(value).collect();
    from_spline_over(&net, &knots.values()[span + 1 - p..=span + p], a, b)
}

/// The polynomial `c` at the polynomial `x`: de Casteljau's algorithm with polynomials.
fn compose(c: &[Interval], x: &[Interval]) -> Form {
    let rest: Form = x.iter().map(|x| Interval::ONE - *x).collect();
    let mut level: Vec<Form> = c.iter().map(|c| vec![*c]).collect();
    while level.len() > 1 {
        level = level.windows(2).map(|w| bernstein::sum(&product(&rest, &w[0]), &product(x, &w[1]))).collect();
    }
    level.pop().unwrap_or_default()
}

/// The boundary over `[t, t']` in space, and by how much (mm) it may differ from what lies on the strip.
fn boundary(ground: &Ground, curve: &Curve<2>, [t0, t1]: [f64; 2]) -> Option<(Enclosed, f64)> {
    let i = Interval::point;
    let [u, v] = [0, 1].map(|d: usize| form_over(&curve.knots, |k| i(curve.control[k][d]), t0, t1));
    let patch = ground.patch;
    let knots = &patch.knots_u;
    let at = (hull(&u).mid()).clamp(patch.domain().0 .0, patch.domain().0 .1);
    let breaks = knots.breaks();
    let k = breaks[1..breaks.len() - 1].partition_point(|b| *b <= at);
    let (k0, k1) = (breaks[k], breaks[k + 1]);
    let local: Form = u.iter().map(|u| (*u - i(k0)) / (i(k1) - i(k0))).collect();
    let past = outside(hull(&local), Interval::ZERO, Interval::ONE);
    // On the strip?
    let (first, last) = ground.strip.domain();
    let width = i(last) - i(first);
    let over: Form = u.iter().map(|u| (*u - i(first)) / width).collect();
    let sideways = outside(hull(&over), Interval::ZERO, Interval::ONE);
    let [floor, ceiling] = ground.strip.heights().each_ref().map(|h| {
        let h: Form = h.iter().map(|y| i(*y)).collect();
        compose(&h, &over)
    });
    let room = |top: &Form, bottom: &Form| {
        let degree = top.len().max(bottom.len()) - 1;
        let raised = |f: &Form| (f.len() - 1..degree).fold(f.clone(), |f, _| elevated(&f));
        hull(&difference(&raised(top), &raised(bottom)))
    };
    let out = (-room(&v, &floor).lo).max(-room(&ceiling, &v).lo).max(0.0);
    let (c, d) = patch.domain().1;
    let off = (i(out) / (i(d) - i(c))).hi;
    if [past, sideways, off].iter().any(|x| *x > PAST || x.is_nan()) {
        return None;
    }
    // In space.
    let span = knots.span(0.5 * (k0 + k1));
    let p = knots.degree();
    let row = |r: usize, e: usize| -> Form {
        let net: Form = (span - p..=span).map(|j| i(patch.control[2 * j + r][e])).collect();
        from_spline_over(&net, &knots.values()[span + 1 - p..=span + p], k0, k1)
    };
    let share: Form = v.iter().map(|v| (*v - i(c)) / (i(d) - i(c))).collect();
    let forms: [Form; 4] = std::array::from_fn(|e| {
        let [lower, upper] = [0, 1].map(|r: usize| compose(&row(r, e), &local));
        let across = product(&share, &difference(&upper, &lower));
        let base = (1..share.len()).fold(lower, |l, _| elevated(&l));
        bernstein::sum(&base, &across)
    });
    let all: [Series<5>; 4] = forms.each_ref().map(|f| series(f));
    let both = forms.each_ref().map(|f| at_ends(f));
    if all[3].0[0].lo <= 0.0 {
        return None;
    }
    let ends = [0, 1].map(|k: usize| -> V3<Series<2>> { std::array::from_fn(|e| both[e][k].over(both[3][k])) });
    let slack = (past + sideways * ((last - first) / (k1 - k0)) + off) * speed(patch, span);
    Some((Enclosed { all: std::array::from_fn(|e| all[e].over(all[3])), ends }, slack))
}

/// How far an interval reaches out of `[lo, hi]`.
fn outside(x: Interval, lo: Interval, hi: Interval) -> f64 {
    (lo - x).hi.max((x - hi).hi).max(0.0)
}

/// Bound of the patch's derivatives over a span, by parameters that run from 0 to 1: its size times its degree, twice
/// for what is continued beyond a knot, and the ratio of its weights.
pub(super) fn speed(patch: &Surface, span: usize) -> f64 {
    let p = patch.knots_u.degree();
    let control = &patch.control[2 * (span - p)..2 * (span + 1)];
    let (least, most) = control.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), c| (l.min(c[3]), m.max(c[3])));
    let points: Vec<Vec3> = control.iter().map(|c| Vec3::new(c[0], c[1], c[2]) / c[3]).collect();
    let reach = points.iter().map(|q| (q - points[0]).norm()).fold(0.0, f64::max);
    8.0 * (p.max(1) as f64) * reach * (most / least).powi(2)
}

/// Distance of the points of a line's ends from a ruling: of all its points.
pub(super) fn off_ruling(ruling: &G1Element, ends: &[Vec3; 2]) -> f64 {
    ends.iter()
        .map(|x| {
            let d: V3<Interval> = super::from_point(&super::super::vector::exact(x), &ruling.point);
            let across = component(&d, &ruling.forward);
            let above = component(&d, &ruling.normal);
            (across.sqr() + above.sqr()).sqrt().hi
        })
        .fold(0.0, f64::max)
}

/// Where a point lies before the normal plane of an element, for matching.
pub(super) fn before(g: &G1Element, x: &Vec3) -> f64 {
    let here: V3<Interval> = super::super::vector::exact(x);
    ahead(g, &[here, here])[0].mid()
}
