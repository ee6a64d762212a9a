//! Where a ruled strip lies on its face: a map from the parameter plane of the strip to that of the face.

use crate::spline::knots::Knots;

/// A tensor-product spline from the parameters (s, t) of a ruled patch to parameters (u, v) of a face: near the foot of
/// the patch's point, but any place near by does. Distances are proven between the patch at (s, t) and the face at its
/// image, so that no foot has to be found.
#[derive(Clone, Debug, PartialEq)]
pub struct FootMap {
    /// Knots in s, across the rulings; clamped.
    pub knots_s: Knots,
    /// Knots in t, along the rulings; clamped.
    pub knots_t: Knots,
    /// Control points (u, v), row-major: index `i * n_t + j`.
    pub control: Vec<[f64; 2]>,
}

/// Place on the face with its first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootJet {
    /// The place (u, v).
    pub p: [f64; 2],
    /// Derivative by s.
    pub ds: [f64; 2],
    /// Derivative by t.
    pub dt: [f64; 2],
}

impl FootMap {
    /// Place on the face and derivatives at (s, t).
    pub fn jet(&self, s: f64, t: f64) -> FootJet {
        let (a, b) = (self.knots_s.basis(s, 1), self.knots_t.basis(t, 1));
        let row = self.knots_t.control_count();
        let mut out = FootJet { p: [0.0; 2], ds: [0.0; 2], dt: [0.0; 2] };
        for i in 0..=self.knots_s.degree() {
            for j in 0..=self.knots_t.degree() {
                let c = &self.control[(a.first + i) * row + b.first + j];
                for (d, c) in c.iter().enumerate() {
                    out.p[d] += a.rows[0][i] * b.rows[0][j] * c;
                    out.ds[d] += a.rows[1][i] * b.rows[0][j] * c;
                    out.dt[d] += a.rows[0][i] * b.rows[1][j] * c;
                }
            }
        }
        out
    }

    /// Parameters (s, t) near `guess` whose image is `place`, by Newton's method; `None` where it does not converge.
    pub fn inverse(&self, place: [f64; 2], guess: [f64; 2]) -> Option<[f64; 2]> {
        let size = self.size();
        let (s0, s1) = self.knots_s.domain();
        let (t0, t1) = self.knots_t.domain();
        let mut at = guess;
        for _ in 0..STEPS {
            let j = self.jet(at[0], at[1]);
            let off = [0, 1].map(|d: usize| place[d] - j.p[d]);
            if (0..2).all(|d| off[d].abs() <= FOUND * size[d]) {
                return Some(at);
            }
            let det = j.ds[0] * j.dt[1] - j.ds[1] * j.dt[0];
            let step = [(off[0] * j.dt[1] - off[1] * j.dt[0]) / det, (j.ds[0] * off[1] - j.ds[1] * off[0]) / det];
            // A step farther than the domain is no step towards a place in it.
            let far = (step[0] / (s1 - s0)).abs().max((step[1] / (t1 - t0)).abs());
            if !far.is_finite() {
                return None;
            }
            let share = (LARGEST_STEP / far).min(1.0);
            at = [at[0] + share * step[0], at[1] + share * step[1]];
        }
        None
    }

    /// Parameters in the domain whose image is nearest to `place`, as shares of the image's extent, down from `guess`; and
    /// how near. *Not guaranteed*: the nearest of all.
    pub fn nearest(&self, place: [f64; 2], guess: [f64; 2]) -> ([f64; 2], f64) {
        let size = self.size();
        let (s, t) = (self.knots_s.domain(), self.knots_t.domain());
        let off = |j: &FootJet| [0, 1].map(|d: usize| (place[d] - j.p[d]) / size[d]);
        let mut at = [guess[0].clamp(s.0, s.1), guess[1].clamp(t.0, t.1)];
        let mut here = self.jet(at[0], at[1]);
        let mut far = off(&here)[0].hypot(off(&here)[1]);
        let mut damping = DAMPING;
        for _ in 0..STEPS {
            let o = off(&here);
            let [a, b] = [here.ds, here.dt].map(|x| [x[0] / size[0], x[1] / size[1]]);
            // Steps are shares of the domain, so that damping means the same in both directions.
            let [a, b] = [a.map(|x| x * (s.1 - s.0)), b.map(|x| x * (t.1 - t.0))];
            let dot = |x: [f64; 2], y: [f64; 2]| x[0] * y[0] + x[1] * y[1];
            let (aa, ab, bb) = (dot(a, a) + damping, dot(a, b), dot(b, b) + damping);
            let det = aa * bb - ab * ab;
            let step = [(dot(a, o) * bb - dot(b, o) * ab) / det, (dot(b, o) * aa - dot(a, o) * ab) / det];
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            let next =
                [(at[0] + step[0] * (s.1 - s.0)).clamp(s.0, s.1), (at[1] + step[1] * (t.1 - t.0)).clamp(t.0, t.1)];
            let there = self.jet(next[0], next[1]);
            let o = off(&there);
            if o[0].hypot(o[1]) < far {
                let gain = far - o[0].hypot(o[1]);
                (at, here, far) = (next, there, o[0].hypot(o[1]));
                damping *= DAMPING;
                if gain <= FOUND {
                    break;
                }
            } else {
                damping /= DAMPING;
            }
        }
        (at, far)
    }

    /// Extent of the image in u and v.
    fn size(&self) -> [f64; 2] {
        [0, 1].map(|d: usize| {
            let all = self.control.iter().map(|c| c[d]);
            let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
            hi - lo
        })
    }
}

/// Newton steps at most; a handful are needed.
const STEPS: usize = 40;
/// Share of the image within which a place counts as found: a little above rounding.
const FOUND: f64 = 1e-12;
/// Damping of steps to the nearest place: first value, and factor after good and bad steps (Levenberg's rule).
const DAMPING: f64 = 0.1;
/// Longest step as a share of the domain.
const LARGEST_STEP: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_again() {
        let knots_s = Knots::uniform(3, 2, 0.0, 2.0).expect("knots");
        let knots_t = Knots::uniform(2, 1, 0.0, 1.0).expect("knots");
        let mut control = Vec::new();
        for i in 0..5 {
            for j in 0..3 {
                let (x, y) = (f64::from(i), f64::from(j));
                control.push([x + 0.1 * y * y, 0.5 * y - 0.05 * x * x]);
            }
        }
        let map = FootMap { knots_s, knots_t, control };
        for at in [[0.3, 0.2], [1.9, 0.9], [1.0, 0.5]] {
            let found = map.inverse(map.jet(at[0], at[1]).p, [1.2, 0.4]).expect("a place");
            assert!((found[0] - at[0]).hypot(found[1] - at[1]) < 1e-10);
        }
        let (at, far) = map.nearest(map.jet(1.2, 0.8).p, [0.1, 0.1]);
        assert!((at[0] - 1.2).hypot(at[1] - 0.8) < 1e-6 && far < 1e-6);
        // Of a place beside the image the nearest is on its border.
        let (at, far) = map.nearest([-1.0, 0.5], [1.0, 0.5]);
        assert!(at[0] == 0.0 && far > 0.1, "{at:?} {far}");
        let (j, h) = (map.jet(0.7, 0.3), 1e-6);
        let (p, q) = (map.jet(0.7 + h, 0.3).p, map.jet(0.7, 0.3 + h).p);
        for d in 0..2 {
            assert!(((p[d] - j.p[d]) / h - j.ds[d]).abs() < 1e-5 && ((q[d] - j.p[d]) / h - j.dt[d]).abs() < 1e-5);
        }
    }
}
