//! Roots of polynomials in Bernstein form, isolated with certainty by subdivision.
//!
//! *Method.* The number of roots in the open interval is at most the number of sign changes of the Bernstein
//! coefficients and has the same parity \[FR88\]. So no change proves that there is no root and one change that there is
//! exactly one; otherwise the interval is cut. Coefficients are intervals, hence every count holds for the polynomial
//! whose coefficients they enclose, rounding included.

use super::bernstein::split;
use super::interval::Interval;

/// Width below which an undecided part is not cut any further: a root there is known to all digits that matter.
const NARROW: f64 = 1e-14;
/// Parts looked at before the rest is called undecided; simple roots need about 60 each.
const MOST_PARTS: usize = 20_000;
/// Where a part is cut: the middle, or beside it if the sign there is not certain. All are exact in binary.
const CUTS: [f64; 3] = [0.5, 0.4375, 0.578_125];

/// A part of `[0, 1]` with exactly one root, a simple one, in its interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SimpleRoot {
    /// Lower end of the part.
    pub lo: f64,
    /// Upper end of the part.
    pub hi: f64,
    /// Whether the polynomial rises through the root.
    pub rising: bool,
}

/// All roots of a polynomial in `(0, 1)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Roots {
    /// Parts with exactly one root each, in increasing order.
    pub simple: Vec<SimpleRoot>,
    /// Parts `(lo, hi)` for which nothing could be proven: multiple roots, and roots at an end. Increasing order.
    pub undecided: Vec<(f64, f64)>,
}

impl Roots {
    /// Whether the number of roots is proven.
    pub fn is_certain(&self) -> bool {
        self.undecided.is_empty()
    }
}

/// Isolates the roots in `(0, 1)` of the polynomial with Bernstein coefficients in `b`.
///
/// *Guarantee*: every root lies in exactly one of the parts; a part called simple holds exactly one root.
/// *Not guaranteed*: that multiple or nearly multiple roots are told apart.
/// *Cost*: the square of the degree for each of about 5 to 50 cuts per root.
pub(crate) fn isolate(b: &[Interval]) -> Roots {
    let mut roots = Roots::default();
    let mut parts = vec![(0.0, 1.0, b.to_vec())];
    let mut seen = 0;
    while let Some((lo, hi, c)) = parts.pop() {
        seen += 1;
        match changes(&c) {
            Changes::None => {}
            Changes::One { rising } => roots.simple.push(SimpleRoot { lo, hi, rising }),
            Changes::Hopeless => roots.undecided.push((lo, hi)),
            Changes::Several => {
                if hi - lo <= NARROW || seen >= MOST_PARTS {
                    roots.undecided.push((lo, hi));
                    continue;
                }
                let mut halves = split(&c, Interval::point(CUTS[0]));
                let mut cut = CUTS[0];
                for &other in &CUTS[1..] {
                    if halves.1[0].sign() != 0 {
                        break;
                    }
                    cut = other;
                    halves = split(&c, Interval::point(cut));
                }
                let middle = lo + cut * (hi - lo);
                // The left part on top, so that roots come out in increasing order.
                parts.push((middle, hi, halves.1));
                parts.push((lo, middle, halves.0));
            }
        }
    }
    merge(&mut roots.undecided);
    roots
}

/// What the signs of the coefficients prove.
enum Changes {
    None,
    One {
        rising: bool,
    },
    Several,
    /// No coefficient has a certain sign, or some is not finite: cutting cannot help.
    Hopeless,
}

fn changes(c: &[Interval]) -> Changes {
    if c.iter().any(|x| !x.is_finite()) {
        return Changes::Hopeless;
    }
    let zero = |x: &Interval| x.lo >= 0.0 && x.hi <= 0.0;
    if c.iter().all(zero) {
        return Changes::Hopeless;
    }
    // Coefficients that are exactly zero never count; uncertain ones may have either sign.
    let signs: Vec<i32> = c.iter().filter(|x| !zero(x)).map(|x| x.sign()).collect();
    if signs.iter().all(|&s| s == 0) {
        return Changes::Hopeless;
    }
    // Most changes over all choices of the uncertain signs, by the sign chosen last.
    let mut most = [0i32, 0];
    for (i, &s) in signs.iter().enumerate() {
        let (plus, minus) = (most[0], most[1]);
        let never = i32::MIN / 2;
        let step = |here: i32, other: i32| if i == 0 { 0 } else { here.max(other + 1) };
        most = [if s >= 0 { step(plus, minus) } else { never }, if s <= 0 { step(minus, plus) } else { never }];
    }
    let count = most[0].max(most[1]);
    let (first, last) = (signs[0], signs[signs.len() - 1]);
    match count {
        0 => Changes::None,
        1 if first * last < 0 => Changes::One { rising: last > 0 },
        // Two changes at most, and an even number when the ends agree: one is excluded, two are not.
        _ => Changes::Several,
    }
}

/// Joins neighbouring parts.
fn merge(parts: &mut Vec<(f64, f64)>) {
    parts.dedup_by(|next, before| {
        let touch = next.0 <= before.1;
        if touch {
            before.1 = before.1.max(next.1);
        }
        touch
    });
}

/// The root of `f` between `lo` and `hi`, to the last digits: Newton steps kept inside the bracket, which is halved
/// where they would leave it. `f` gives value and slope; `rising` says on which side it is negative.
///
/// *Guarantee*: the result lies between `lo` and `hi`. *Not guaranteed*: anything where the sign of `f` is wrong.
pub fn refine(mut f: impl FnMut(f64) -> (f64, f64), lo: f64, hi: f64, rising: bool) -> f64 {
    // Bisection alone would need 60 steps from any bracket of ordinary numbers.
    const STEPS: usize = 100;
    let (mut lo, mut hi) = (lo, hi);
    let mut x = 0.5 * (lo + hi);
    for _ in 0..STEPS {
        let (y, slope) = f(x);
        if y == 0.0 {
            return x;
        }
        if (y > 0.0) == rising {
            hi = x;
        } else {
            lo = x;
        }
        let newton = x - y / slope;
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if (next - x).abs() <= f64::EPSILON * x.abs().max(next.abs()) || next <= lo || next >= hi {
            return next.clamp(lo, hi);
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::bernstein::{elevated, product, value};

    fn from_roots(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |p, &r| product(&p, &[-r, 1.0 - r]))
    }

    fn enclosed(b: &[f64]) -> Vec<Interval> {
        b.iter().map(|&x| Interval::point(x)).collect()
    }

    #[test]
    fn simple_roots_are_found_and_refined() {
        let wanted = [0.1, 0.11, 0.5, 0.75, 0.999];
        let p = from_roots(&[-0.3, 0.1, 0.11, 0.5, 0.75, 0.999, 1.4]);
        let roots = isolate(&enclosed(&p));
        assert!(roots.is_certain());
        assert_eq!(roots.simple.len(), wanted.len());
        for (r, w) in roots.simple.iter().zip(wanted) {
            assert!(r.lo < w && w < r.hi);
            let slope = crate::num::bernstein::derivative(&p);
            let x = refine(|x| (value(&p, x), value(&slope, x)), r.lo, r.hi, r.rising);
            assert!((x - w).abs() < 1e-12, "{x} for {w}");
        }
    }

    #[test]
    fn no_root_is_proven() {
        // (x − 0.5)² + 1e-6 has two sign changes and no root.
        let p = from_roots(&[0.5, 0.5]);
        let p: Vec<f64> = elevated(&p.iter().map(|x| x + 1e-6).collect::<Vec<_>>());
        assert_eq!(isolate(&enclosed(&p)), Roots::default());
    }

    #[test]
    fn double_roots_are_undecided_and_located() {
        let roots = isolate(&enclosed(&from_roots(&[0.3, 0.3, 0.8])));
        assert_eq!(roots.simple.len(), 1);
        assert_eq!(roots.undecided.len(), 1);
        let (lo, hi) = roots.undecided[0];
        assert!(lo <= 0.3 && hi >= 0.3 && hi - lo < 1e-6);
    }

    #[test]
    fn hopeless_data_end_at_once() {
        assert_eq!(isolate(&[Interval::ZERO; 4]).undecided, vec![(0.0, 1.0)]);
        assert_eq!(isolate(&[Interval::EVERYTHING; 4]).undecided, vec![(0.0, 1.0)]);
        assert_eq!(isolate(&[Interval::symmetric(1.0); 9]).undecided, vec![(0.0, 1.0)]);
        assert!(isolate(&[]).undecided.len() == 1);
        let nan = isolate(&[Interval::point(f64::NAN), Interval::ONE]);
        assert!(!nan.is_certain());
    }

    #[test]
    fn zeros_at_the_ends_do_not_count() {
        // x (1 − x) (x − 0.4): only 0.4 lies inside.
        let roots = isolate(&enclosed(&from_roots(&[0.0, 1.0, 0.4])));
        assert_eq!(roots.simple.len(), 1);
        assert!(roots.is_certain());
    }
}
