//! Developable strips given by the curves at the two ends of their rulings: what cone splines are fitted to and
//! judged against \[LP98\]. Whether a strip is developable is not checked here, except through [`StripJet::twist`].

use super::g1_element::{ElementError, G1Element};
use crate::geom::Vec3;
use crate::num::bernstein::{self, Scalar};
use crate::num::interval::Interval;
use crate::spline::bezier::Bezier;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// A boundary curve with its first four derivatives, in intervals.
pub(crate) type EnclosedCurve = [[Interval; 3]; 5];

/// A strip of a developable surface: ruling `u` is the segment between two boundary points.
pub trait RuledStrip {
    /// Interval of u.
    fn domain(&self) -> (f64, f64);
    /// Interior parameters where the boundary curves may not have four continuous derivatives.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }
    /// Both boundary curves with their first two derivatives.
    fn jet(&self, u: f64) -> StripJet;
}

/// A strip whose boundary curves can be enclosed: what a proof needs.
pub trait EnclosedStrip: RuledStrip {
    /// Intervals that contain both boundary curves and their derivatives for all u of `[a, b]`, which may be one number
    /// and contains no break in its interior. At a break they are those of the side on which `inside` lies, a number
    /// that is no break and between which and `[a, b]` there is none.
    fn enclosure(&self, a: f64, b: f64, inside: f64) -> [EnclosedCurve; 2];
}

/// Both boundary curves at one ruling: point, first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripJet {
    /// Lower end (r smallest), upper end.
    pub ends: [[Vec3; 3]; 2],
}

impl StripJet {
    /// The ruling, from the lower to the upper end, with its tangent plane; its point is the middle.
    ///
    /// # Errors
    /// A ruling without length, or a boundary that stands still or runs along the ruling.
    pub fn element(&self) -> Result<G1Element, ElementError> {
        let [a, b] = &self.ends;
        let e = b[0] - a[0];
        let across = a[1] + b[1];
        let ee = e.norm_squared();
        let p = across - e * (across.dot(&e) / ee);
        G1Element::new((a[0] + b[0]) * 0.5, e, p - e * (p.dot(&e) / ee))
    }

    /// Length of the ruling, mm.
    pub fn length(&self) -> f64 {
        (self.ends[1][0] - self.ends[0][0]).norm()
    }

    /// Curvature across the rulings up to a positive factor: changes its sign at inflection rulings. Needs no more than
    /// the middle curve.
    pub fn bend(&self, element: &G1Element) -> f64 {
        (self.ends[0][2] + self.ends[1][2]).dot(&element.normal)
    }

    /// Forward speeds of both ends; of opposite signs where the regression curve runs through the strip.
    pub fn speeds(&self, element: &G1Element) -> [f64; 2] {
        self.ends.map(|c| c[1].dot(&element.forward))
    }

    /// Sine of the angle between the tangent planes at both ends: 0 on a developable.
    pub fn twist(&self, element: &G1Element) -> f64 {
        let [a, b] = self.ends.map(|c| {
            let n = element.direction.cross(&c[1]);
            n.try_normalize(0.0).unwrap_or(element.normal)
        });
        a.cross(&b).norm()
    }
}

/// A strip from functions: domain, breaks, and the jet of both boundary curves.
pub struct StripFn<F> {
    /// Interval of u.
    pub domain: (f64, f64),
    /// Interior parameters of lower smoothness.
    pub breaks: Vec<f64>,
    /// The jet.
    pub jet: F,
}

impl<F: Fn(f64) -> StripJet> RuledStrip for StripFn<F> {
    fn domain(&self) -> (f64, f64) {
        self.domain
    }
    fn breaks(&self) -> Vec<f64> {
        self.breaks.clone()
    }
    fn jet(&self, u: f64) -> StripJet {
        (self.jet)(u)
    }
}

/// The strip of the tangent surface of a curve between the distances `r[0] < r[1]` from it, of one sign.
///
/// `curve` holds the point and the first three derivatives; the first two are not parallel.
pub fn tangent_strip(curve: &[Vec3; 4], r: [f64; 2]) -> StripJet {
    let speed = curve[1].norm();
    let t = curve[1] / speed;
    let ds = t.dot(&curve[2]);
    let dt = (curve[2] - t * ds) / speed;
    let dds = dt.dot(&curve[2]) + t.dot(&curve[3]);
    let ddt = (curve[3] - dt * (2.0 * ds) - t * dds) / speed;
    let mut ends = r.map(|r| [curve[0] + t * r, curve[1] + dt * r, curve[2] + ddt * r]);
    // Rulings run so that forward is the direction of growing parameter on either side of the curve.
    if r[0] > r[1] {
        ends.reverse();
    }
    StripJet { ends }
}

/// Strip of the tangent surface of the helix `(a cos u, a sin u, b u)`: a screw flight of constant slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelicalStrip {
    /// Radius of the helix, mm.
    pub radius: f64,
    /// Rise per radian, mm.
    pub rise: f64,
    /// Distances from the helix along the tangents, mm.
    pub reach: [f64; 2],
    /// Interval of u, rad.
    pub domain: (f64, f64),
}

impl RuledStrip for HelicalStrip {
    fn domain(&self) -> (f64, f64) {
        self.domain
    }

    fn jet(&self, u: f64) -> StripJet {
        let (s, c) = u.sin_cos();
        let (a, b) = (self.radius, self.rise);
        let k = 1.0 / a.hypot(b);
        let ends = self.reach.map(|r| {
            let (x, y) = (a, a * r * k);
            [
                Vec3::new(x * c - y * s, x * s + y * c, b * u + b * k * r),
                Vec3::new(-x * s - y * c, x * c - y * s, b),
                Vec3::new(-x * c + y * s, -x * s - y * c, 0.0),
            ]
        });
        StripJet { ends }
    }
}

/// Sine and cosine over `[a, b]`: value in the middle, and how far it can be left.
fn sine_cosine(a: f64, b: f64) -> [Interval; 2] {
    let m = 0.5 * (a + b);
    let h = Interval::new(a, b).rad();
    let (s, c) = m.sin_cos();
    // sin(m + d) = s cos d + c sin d; the library functions are good to an ulp, two are allowed.
    let slack = 2.0 * f64::EPSILON;
    let around = |x: f64, slope: f64| Interval::point(x).widen(h * (slope.abs() + slack) + 0.5 * h * h + slack);
    [around(s, c), around(c, s)]
}

impl EnclosedStrip for HelicalStrip {
    fn enclosure(&self, a: f64, b: f64, _: f64) -> [EnclosedCurve; 2] {
        let [s, c] = sine_cosine(a, b);
        let u = Interval::new(a, b);
        let i = Interval::point;
        let k = Interval::ONE / (i(self.radius).sqr() + i(self.rise).sqr()).sqrt();
        self.reach.map(|r| {
            let x = i(self.radius);
            let y = x * k * r;
            let height = u * self.rise + k * i(self.rise) * r;
            [
                [x * c - y * s, x * s + y * c, height],
                [-(x * s) - y * c, x * c - y * s, i(self.rise)],
                [y * s - x * c, -(x * s) - y * c, Interval::ZERO],
                [x * s + y * c, y * s - x * c, Interval::ZERO],
                [x * c - y * s, x * s + y * c, Interval::ZERO],
            ]
        })
    }
}

/// A region of a ruled patch of degree 1 in v as a strip: its rulings between two ends given as polynomials of u.
///
/// What is enclosed is the patch itself, not a copy of it: the rulings are taken from the patch's control points by
/// interval arithmetic. The curves kept beside them, for evaluation, differ from it by rounding.
#[derive(Clone, Debug)]
pub struct RuledPatch {
    sides: [Curve<4>; 2],
    /// Bernstein coefficients of v at both ends of the rulings, over the domain.
    heights: [Vec<f64>; 2],
    /// Both ends in homogeneous Bernstein form over every span.
    spans: Vec<[[Vec<Interval>; 4]; 2]>,
}

impl RuledPatch {
    /// The patch between `v = lower` and `v = upper`; `None` if it is not of degree 1 with a single span in v.
    pub fn new(patch: &Surface, lower: f64, upper: f64) -> Option<Self> {
        let (domain, _) = patch.domain();
        Self::of_region(patch, domain, [vec![lower], vec![upper]])
    }

    /// The rulings of a patch over an interval of u, between heights v given by their Bernstein coefficients over that
    /// interval; `None` if the patch is not of degree 1 with a single span in v, or the interval not within its own.
    pub fn of_region(patch: &Surface, (a, b): (f64, f64), heights: [Vec<f64>; 2]) -> Option<Self> {
        let ((u0, u1), (c, d)) = patch.domain();
        let above = heights[0].iter().zip(&heights[1]).all(|(l, u)| l < u);
        let alike = heights[0].len() == heights[1].len();
        if patch.knots_v.degree() != 1 || patch.row() != 2 || a < u0 || b > u1 || a >= b || !alike || !above {
            return None;
        }
        let rows = [0, 1].map(|k| Curve::<4> {
            knots: patch.knots_u.clone(),
            control: patch.control.iter().skip(k).step_by(2).copied().collect(),
        });
        let whole = a <= u0 && b >= u1;
        let side = |h: &[f64]| match h {
            [v] if whole => Some(patch.curve_at_v(*v)),
            [v] => patch.curve_at_v(*v).restricted(a, b).ok(),
            _ => {
                let [lower, upper] = [c, d].map(|v| patch.curve_at_v(v).restricted(a, b));
                blended(&lower.ok()?, &upper.ok()?, &Bezier::new(h.iter().map(|y| [(y - c) / (d - c)]).collect()))
            }
        };
        let sides = [side(&heights[0])?, side(&heights[1])?];
        let breaks = sides[0].knots.breaks();
        let spans = breaks
            .windows(2)
            .map(|w| [0, 1].map(|k: usize| enclosed_side(&rows, (c, d), &heights[k], (a, b), (w[0], w[1]))))
            .collect();
        Some(Self { sides, heights, spans })
    }

    /// Between two curves with the same knots, homogeneous.
    pub fn between(lower: Curve<4>, upper: Curve<4>) -> Option<Self> {
        if lower.knots != upper.knots {
            return None;
        }
        let control: Vec<[f64; 4]> = lower.control.iter().zip(&upper.control).flat_map(|(l, u)| [*l, *u]).collect();
        let knots_v = Knots::clamped(1, &[0.0, 1.0]).ok()?;
        let rational = control.iter().any(|c| c[3] != 1.0);
        Self::new(&Surface { knots_u: lower.knots, knots_v, control, rational }, 0.0, 1.0)
    }

    /// Both ends of the rulings as homogeneous curves over the same knots.
    pub fn sides(&self) -> &[Curve<4>; 2] {
        &self.sides
    }

    /// Bernstein coefficients of v at both ends of the rulings, over the domain of u.
    pub fn heights(&self) -> &[Vec<f64>; 2] {
        &self.heights
    }
}

/// The curve `v = h(u)` on a patch between rows of control points at `v = c` and `v = d`, over `[a, b]` inside one
/// span: homogeneous Bernstein coefficients. `h` is given over `whole`.
fn enclosed_side(
    rows: &[Curve<4>; 2],
    (c, d): (f64, f64),
    h: &[f64],
    whole: (f64, f64),
    (a, b): (f64, f64),
) -> [Vec<Interval>; 4] {
    let point = Interval::point;
    let n = h.len() - 1;
    let ends: Vec<f64> = [vec![whole.0; n], vec![whole.1; n]].concat();
    let height: Vec<Interval> = h.iter().map(|y| point(*y)).collect();
    let height = if n == 0 { height } else { bernstein::from_spline_over(&height, &ends, a, b) };
    let share: Vec<Interval> = height.iter().map(|y| (*y - point(c)) / (point(d) - point(c))).collect();
    let knots = &rows[0].knots;
    let (p, span) = (knots.degree(), knots.span(0.5 * (a + b)));
    let local = &knots.values()[span + 1 - p..=span + p];
    std::array::from_fn(|k| {
        let [lower, upper] = [0, 1].map(|r: usize| {
            let net: Vec<Interval> = (span - p..=span).map(|i| point(rows[r].control[i][k])).collect();
            bernstein::from_spline_over(&net, local, a, b)
        });
        let across = bernstein::product(&share, &bernstein::difference(&upper, &lower));
        let base = (0..n).fold(lower, |l, _| bernstein::elevated(&l));
        bernstein::sum(&base, &across)
    })
}

/// The curve `(1 - s(u)) lower(u) + s(u) upper(u)` in homogeneous coordinates; `s` is given over the whole domain.
fn blended(lower: &Curve<4>, upper: &Curve<4>, s: &Bezier<1>) -> Option<Curve<4>> {
    let (a, b) = lower.domain();
    let across = |u: f64| (u - a) / (b - a);
    let degree = lower.knots.degree() + s.degree();
    let (mut values, mut control) = (vec![a], Vec::new());
    for ((from, to, low), (_, _, high)) in bezier_pieces(lower).into_iter().zip(bezier_pieces(upper)) {
        let (low, high) = (Bezier::new(low), Bezier::new(high));
        let share = s.restricted(across(from), across(to));
        let piece = low.elevated(s.degree()).plus(&high.minus(&low).times(&share));
        // Pieces share their ends.
        control.extend(piece.control().iter().skip(usize::from(!control.is_empty())));
        if values.len() == 1 {
            values.extend(vec![a; degree]);
        }
        values.extend(vec![to; degree]);
    }
    values.push(b);
    let knots = Knots::new(degree, values, control.len()).ok()?;
    Some(Curve { knots, control })
}

/// Affine derivatives from homogeneous ones: Leibniz's rule for `h = w x`.
fn affine<S: Scalar, const N: usize>(h: &[[S; 4]; N]) -> [[S; 3]; N] {
    let mut out = [[S::from(0.0); 3]; N];
    for k in 0..N {
        for d in 0..3 {
            let mut rest = h[k][d];
            let mut binomial = 1.0;
            for i in 1..=k {
                binomial *= (k + 1 - i) as f64 / i as f64;
                rest = rest - S::from(binomial) * h[i][3] * out[k - i][d];
            }
            out[k][d] = rest.over(h[0][3]);
        }
    }
    out
}

impl RuledStrip for RuledPatch {
    fn domain(&self) -> (f64, f64) {
        self.sides[0].domain()
    }

    fn breaks(&self) -> Vec<f64> {
        let b = self.sides[0].knots.breaks();
        b[1..b.len() - 1].to_vec()
    }

    fn jet(&self, u: f64) -> StripJet {
        let ends = [0, 1].map(|k| affine(&self.sides[k].jet(u)).map(Vec3::from));
        StripJet { ends }
    }
}

impl EnclosedStrip for RuledPatch {
    fn enclosure(&self, a: f64, b: f64, inside: f64) -> [EnclosedCurve; 2] {
        let breaks = self.sides[0].knots.breaks();
        let k = breaks[1..breaks.len() - 1].partition_point(|t| *t <= inside);
        let (from, to) = (Interval::point(breaks[k]), Interval::point(breaks[k + 1]));
        self.spans[k].each_ref().map(|side| {
            // About a point near by: what the weights vary would count with the distance from the origin, which near the tip of a
            // cone is large against everything there.
            let last = side[3].len() - 1;
            let end = |d: usize, i: usize| side[d][i].mid() / side[3][i].mid();
            let centre = [0, 1, 2].map(|d| 0.5 * (end(d, 0) + end(d, last)));
            let mut rows = [[Interval::ZERO; 4]; 5];
            for (d, net) in side.iter().enumerate() {
                let mut net = match centre.get(d) {
                    Some(&c) => net.iter().zip(&side[3]).map(|(x, w)| *x - *w * c).collect(),
                    None => net.clone(),
                };
                for row in &mut rows {
                    let degree = net.len() - 1;
                    let ends = [vec![from.lo; degree], vec![to.lo; degree]].concat();
                    row[d] = bernstein::hull(&bernstein::from_spline_over(&net, &ends, a, b));
                    if degree == 0 {
                        break;
                    }
                    net = bernstein::derivative(&net).into_iter().map(|x| x / (to - from)).collect();
                }
            }
            let mut out = affine(&rows);
            (0..3).for_each(|d| out[0][d] += Interval::point(centre[d]));
            out
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helix() -> HelicalStrip {
        HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.0, 6.0) }
    }

    fn patch() -> RuledPatch {
        let knots = Knots::clamped(3, &[0.0, 0.4, 1.0]).expect("knots");
        let side = |z: f64| {
            (0..5)
                .map(|i| {
                    let (x, w) = (i as f64 * 0.3, 1.0 + 0.1 * (i % 2) as f64);
                    [x * w, (x * x + z) * w, z * w, w]
                })
                .collect()
        };
        RuledPatch::between(Curve { knots: knots.clone(), control: side(0.0) }, Curve { knots, control: side(1.0) })
            .expect("strip")
    }

    #[test]
    fn derivatives_agree_with_differences_and_enclosures_contain_them() {
        fn check(strip: &impl EnclosedStrip, a: f64, b: f64) {
            let boxes = strip.enclosure(a, b, 0.5 * (a + b));
            for i in 0..=4 {
                let u = a + (b - a) * f64::from(i) / 4.0;
                let jet = strip.jet(u);
                let (less, more) = (strip.jet(u - 1e-5), strip.jet(u + 1e-5));
                for side in 0..2 {
                    for d in 0..3 {
                        // Third and fourth derivatives by differences of the second.
                        let [x, y, z] = [&less, &jet, &more].map(|j| j.ends[side][2][d]);
                        assert!(boxes[side][3][d].widen(1e-4).contains((z - x) / 2e-5));
                        let (x, z) = (strip.jet(u - 1e-3).ends[side][2][d], strip.jet(u + 1e-3).ends[side][2][d]);
                        assert!(boxes[side][4][d].widen(1e-4).contains((x - 2.0 * y + z) / 1e-6));
                    }
                    for order in 0..3 {
                        for d in 0..3 {
                            assert!(boxes[side][order][d].widen(1e-13).contains(jet.ends[side][order][d]));
                        }
                        if order > 0 {
                            let slope = (more.ends[side][order - 1] - less.ends[side][order - 1]) / 2e-5;
                            assert!((slope - jet.ends[side][order]).norm() < 1e-8);
                        }
                    }
                }
            }
            assert!(boxes[0][0][0].width() < 20.0 * (b - a), "useful");
            // At a single ruling all derivatives are sharp.
            for rows in strip.enclosure(a, a, b) {
                assert!(rows.iter().flatten().all(|x| x.width() < 1e-10));
            }
        }
        check(&helix(), 0.7, 0.8);
        check(&patch(), 0.41, 0.45);
    }

    #[test]
    fn tangent_strips_are_developable() {
        let u: f64 = 0.3;
        let c = [
            Vec3::new(u, u * u, u * u * u),
            Vec3::new(1.0, 2.0 * u, 3.0 * u * u),
            Vec3::new(0.0, 2.0, 6.0 * u),
            Vec3::new(0.0, 0.0, 6.0),
        ];
        let jet = tangent_strip(&c, [1.0, 2.0]);
        let g = jet.element().expect("element");
        assert!(jet.twist(&g) < 1e-14 && jet.speeds(&g).iter().all(|s| *s > 0.0));
        assert!((g.direction - c[1].normalize()).norm() < 1e-14);
        let h = helix().jet(0.3);
        assert!(h.twist(&h.element().expect("element")) < 1e-14);
    }
}
