//! Strips of an exactly developable surface between two curves near it.
//!
//! *Method.* A spline of planes of degree k has its rulings on `U ∧ U'`; a section F with a plane and the directions E
//! are homogeneous splines of degree 2k − 2 with a common factor \[PW99, 2\]. A boundary that follows a rail is F + μ E
//! with a spline μ: cubic Hermite pieces through the points of the rulings next to the rail, with exact derivatives. Both
//! boundaries have equal weights, so rulings are run through evenly, and the strip is developable for any μ.

use crate::geom::{Frame, Vec3};
use crate::spline::bezier::Bezier;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::torse::dual::assemble::from_pieces;
use crate::torse::dual::{plane_through, DualCurve, DualError};
use crate::torse::rail::jet;

/// Newton steps from a ruling to the rail's point next to it.
const STEPS: usize = 12;
/// Step, in the rail's parameter, that is rounding.
const SETTLED: f64 = 1e-15;
/// Parameters by which the point next to a ruling may lie from where it is sought.
const ASTRAY: f64 = 0.1;
/// Halvings of all spans that are tried to make the weights positive.
const REFINEMENTS: usize = 3;
/// The plane at infinity: its section with rulings are their directions.
const FAR: [f64; 4] = [0.0, 0.0, 0.0, -1.0];
/// Degree of μ.
const CUBIC: usize = 3;

/// Two boundaries over the same knots, equal parameters on one ruling, and the parameters of the rails they follow.
#[derive(Clone, Debug)]
pub(crate) struct BetweenRails {
    /// Homogeneous, positive weights, equal on both.
    pub boundaries: [Curve<4>; 2],
    /// The rails' parameters as cubic functions of the boundaries'.
    pub parameters: [Curve<1>; 2],
}

/// Why a surface has no strip between two rails.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum OnTorseError {
    /// A rail leaves the rulings.
    #[error("the ruling at t = {t:.4} passes no point of rail {side}")]
    Astray {
        /// Parameter of the surface.
        t: f64,
        /// 0 or 1.
        side: usize,
    },
    /// Rulings stand still or turn too far from their mean.
    #[error("the rulings turn back or by more than a right angle near t = {t:.4}")]
    Weights {
        /// Parameter of the surface.
        t: f64,
    },
    /// No spline.
    #[error(transparent)]
    Dual(#[from] DualError),
}

/// The strip of `torse`, given in the coordinates of `frame`, between two smooth curves of space; `guess` tells their
/// parameters on the ruling `t`, exactly at both ends. `direction` is the mean direction of the rulings; the frame's
/// origin lies in their midst. `still` says where the planes stand still, at the start or the end: an inflection, at
/// which a factor of rulings vanishes. It is divided out of the span there.
///
/// *Not guaranteed*: that the boundaries are near the rails between the breaks of the surface; see
/// [`crate::certify::rails::rail_bound`].
///
/// # Errors
/// See [`OnTorseError`].
pub(crate) fn between_rails(
    torse: &DualCurve,
    rails: [&Curve<4>; 2],
    guess: impl Fn(f64) -> [f64; 2],
    frame: &Frame,
    direction: &Vec3,
    still: [bool; 2],
) -> Result<BetweenRails, OnTorseError> {
    let mut section = torse.rational_section(&plane_through(&Vec3::zeros(), &frame.vector_to_local(direction)))?;
    let mut along = torse.rational_section(&FAR)?;
    let mut refinements = 0;
    let mut spans = spans(&section, &along, still);
    while let Err(t) = signed(&mut spans) {
        if refinements == REFINEMENTS {
            return Err(OnTorseError::Weights { t });
        }
        refinements += 1;
        let middles: Vec<f64> = section.knots.breaks().windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        section = section.with_knots(&middles).map_err(DualError::from)?;
        along = along.with_knots(&middles).map_err(DualError::from)?;
        spans = self::spans(&section, &along, still);
    }
    let (first, last) = torse.domain();
    let boundary = |side: usize| -> Result<(Curve<4>, Curve<1>), OnTorseError> {
        let mut pieces = Vec::with_capacity(spans.len());
        let mut parameter = Vec::with_capacity(spans.len());
        for Span { from: a, to: b, section, along } in &spans {
            let (a, b) = (*a, *b);
            let side_of = |t: f64, x: f64| {
                let jet = |c: &Bezier<4>| [c.point(x), c.derivative().point(x).map(|d| d / (b - a))];
                let fixed = t == first || t == last;
                let found = node(torse, [jet(section), jet(along)], &(rails[side], frame), guess(t)[side], t, fixed);
                found.ok_or(OnTorseError::Astray { t, side })
            };
            let (p, q) = (side_of(a, 0.0)?, side_of(b, 1.0)?);
            let cubic = |x: [f64; 2], y: [f64; 2]| {
                let h = (b - a) / 3.0;
                Bezier::new(vec![[x[0]], [x[0] + h * x[1]], [y[0] - h * y[1]], [y[0]]])
            };
            pieces.push((a, b, section.elevated(CUBIC).plus(&along.times(&cubic(p.mu, q.mu)))));
            parameter.push((a, b, cubic(p.sigma, q.sigma)));
        }
        // μ has as many continuous derivatives as the section, one at most.
        let knots = |degree: usize| {
            let mut values = vec![first; degree + 1];
            let inner: Vec<_> = section.knots.distinct().into_iter().filter(|(t, _)| *t > first && *t < last).collect();
            for (k, (t, m)) in inner.iter().copied().enumerate() {
                // Where a factor was divided out, only the values still agree.
                let divided = (still[0] && k == 0) || (still[1] && k + 1 == inner.len());
                let smooth = if divided { 0 } else { section.knots.degree().saturating_sub(m).min(1) };
                values.extend(std::iter::repeat_n(t, degree - smooth));
            }
            values.extend(std::iter::repeat_n(last, degree + 1));
            let count = values.len() - degree - 1;
            Knots::new(degree, values, count)
        };
        let degree = section.knots.degree() + CUBIC;
        let mut curve = from_pieces(knots(degree).map_err(DualError::from)?, &pieces).map_err(DualError::from)?;
        let sigma = from_pieces(knots(CUBIC).map_err(DualError::from)?, &parameter).map_err(DualError::from)?;
        for h in &mut curve.control {
            let p = frame.to_world(&(Vec3::new(h[0], h[1], h[2]) / h[3])) * h[3];
            *h = [p.x, p.y, p.z, h[3]];
        }
        Ok((curve, sigma))
    };
    let ((a, x), (b, y)) = (boundary(0)?, boundary(1)?);
    Ok(BetweenRails { boundaries: [a, b], parameters: [x, y] })
}

/// A ruling's point next to the rail: its place μ on the ruling and the rail's parameter σ, with derivatives.
struct Node {
    mu: [f64; 2],
    sigma: [f64; 2],
}

fn node(
    torse: &DualCurve,
    [f, e]: [[[f64; 4]; 2]; 2],
    rail: &(&Curve<4>, &Frame),
    guess: f64,
    t: f64,
    fixed: bool,
) -> Option<Node> {
    let vector = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]);
    let u = torse.jet(t);
    let (w, dw) = (f[0][3], f[1][3]);
    let p = vector(&f[0]) / w;
    let dp = (vector(&f[1]) - p * dw) / w;
    let (e, de) = (vector(&e[0]), vector(&e[1]));
    let (n, dn) = (vector(&u[0]), vector(&u[1]));
    // The plane through the ruling, square to the surface, meets the rail.
    let k = e.cross(&n);
    let dk = de.cross(&n) + e.cross(&dn);
    let mut sigma = guess;
    for _ in 0..if fixed { 0 } else { STEPS } {
        let r = local(rail, sigma);
        let step = k.dot(&(r[0] - p)) / k.dot(&r[1]);
        sigma = (sigma - step).clamp(0.0, 1.0);
        if step.abs() <= SETTLED {
            break;
        }
    }
    if (sigma - guess).abs() > ASTRAY || sigma.is_nan() {
        return None;
    }
    let r = local(rail, sigma);
    let off = r[0] - p;
    let dsigma = (k.dot(&dp) - dk.dot(&off)) / k.dot(&r[1]);
    let ee = e.norm_squared();
    let lambda = off.dot(&e) / ee;
    let dlambda = ((r[1] * dsigma - dp).dot(&e) + off.dot(&de) - 2.0 * lambda * e.dot(&de)) / ee;
    let mu = [lambda * w, dlambda * w + lambda * dw];
    let all = [mu[0], mu[1], dsigma];
    all.iter().all(|x| x.is_finite()).then_some(Node { mu, sigma: [sigma, dsigma] })
}

/// Point and two derivatives of a rail in the frame.
fn local((rail, frame): &(&Curve<4>, &Frame), t: f64) -> [Vec3; 3] {
    let [p, d, s] = jet(rail, t);
    [frame.to_local(&p), frame.vector_to_local(&d), frame.vector_to_local(&s)]
}

/// A span of the surface: its section and the directions of its rulings, with a common factor.
struct Span {
    from: f64,
    to: f64,
    section: Bezier<4>,
    along: Bezier<4>,
}

/// The spans, without the factors that vanish where planes stand still.
fn spans(section: &Curve<4>, along: &Curve<4>, still: [bool; 2]) -> Vec<Span> {
    let (f, e) = (bezier_pieces(section), bezier_pieces(along));
    let last = f.len() - 1;
    let divided = |k: usize, c: &[[f64; 4]]| {
        let mut c = c.to_vec();
        if still[0] && k == 0 {
            c = without_factor(&c);
        }
        if still[1] && k == last {
            c.reverse();
            c = without_factor(&c);
            c.reverse();
        }
        Bezier::new(c)
    };
    f.iter()
        .zip(&e)
        .enumerate()
        .map(|(k, (f, e))| Span { from: f.0, to: f.1, section: divided(k, &f.2), along: divided(k, &e.2) })
        .collect()
}

/// The polynomial, which vanishes at 0, divided by its variable, in Bernstein form of the same degree.
fn without_factor(c: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let n = c.len() - 1;
    let lower: Vec<[f64; 4]> = (0..n).map(|i| c[i + 1].map(|x| x * n as f64 / (i + 1) as f64)).collect();
    Bezier::new(lower).elevated(1).control().to_vec()
}

/// Makes all weights positive, the largest 1, if they have one sign; else a parameter near which they do not.
fn signed(spans: &mut [Span]) -> Result<(), f64> {
    let weights = || spans.iter().flat_map(|s| s.section.control().iter().map(move |c| (s.from, c[3])));
    let most = weights().map(|w| w.1).fold(0.0, |m: f64, w| if w.abs() > m.abs() { w } else { m });
    if let Some((t, _)) = weights().find(|w| w.1 * most <= 0.0 || w.1.is_nan()) {
        return Err(t);
    }
    for s in spans {
        let scaled = |c: &Bezier<4>| Bezier::new(c.control().iter().map(|h| h.map(|x| x / most)).collect());
        (s.section, s.along) = (scaled(&s.section), scaled(&s.along));
    }
    Ok(())
}
