//! The level function whose bands are the strips: shortest range under the eikonal condition in the metric |II|.
//!
//! *Method.* Strips are bands of width `4√ε` of a function φ with `|II⁻¹(dφ, dφ)| ≥ 1` (approximation
//! specification B2–B3, after \[SE06\]); with `q = II(T, T)`, `T = ker dφ`, this reads `s q ≥ |det II|` with one sign
//! `s` over the region. Sequential linear programs shorten the range `W = max φ − min φ`; a floor on `|det II|` keeps
//! rulings away from asymptotic directions and makes parabolic points harmless. Departures: rows are scaled, and the
//! condition is linearised in `q` itself where `q` is small or of the wrong sign.
//!
//! Not guaranteed: a global minimum, or a field without shortfall (the caller looks at `merit`).

use crate::num::linear_program::LinearProgram;
use crate::spline::field::Field;
use rayon::prelude::*;

/// Fundamental forms of the surface at a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forms {
    /// Parameter (u, v).
    pub uv: [f64; 2],
    /// Coefficients E, F, G of the first form, mm² per parameter².
    pub first: [f64; 3],
    /// Coefficients L, M, N of the second form for the unit normal, mm per parameter².
    pub second: [f64; 3],
}

impl Forms {
    /// Principal curvatures, larger first, 1/mm.
    pub fn principal(&self) -> [f64; 2] {
        let [e, f, g] = self.first;
        let [l, m, n] = self.second;
        let det = (e * g - f * f).max(f64::MIN_POSITIVE);
        let h = (e * n - 2.0 * f * m + g * l) / (2.0 * det);
        let k = (l * n - m * m) / det;
        let r = (h * h - k).max(0.0).sqrt();
        [h + r, h - r]
    }
}

/// A level function and how good it is.
#[derive(Clone, Debug)]
pub struct Level {
    /// φ in √mm: a band of width `4√ε` can be met within ε.
    pub field: Field,
    /// Sign of `II(T, T)` along the strips.
    pub sign: f64,
    /// Range of φ over the region, √mm.
    pub range: f64,
    /// `range · (1 + 30 · mean shortfall)`: smaller is better; far above `range` when the condition fails somewhere.
    pub merit: f64,
}

/// Knobs of [`level`].
#[derive(Clone, Copy, Debug)]
pub struct LevelOptions {
    /// Linear starts, evenly spread over the half circle; default 8.
    pub starts: usize,
    /// Starts that go on after their first program; default 2.
    pub keep: usize,
    /// Further programs for each kept start; default 5.
    pub rounds: usize,
    /// Spans of φ per direction; default 2 (5 × 5 coefficients).
    pub spans: usize,
}

impl Default for LevelOptions {
    fn default() -> Self {
        Self { starts: 8, keep: 2, rounds: 5, spans: 2 }
    }
}

/// Floor on `√|det II|`, as a share of the region's largest curvature (B3.2).
const FLOOR: f64 = 0.12;
/// Samples flatter than this share of the 90 % quantile say nothing about φ (C3).
const FLAT: f64 = 0.02;
/// Share of samples whose ratio may stay below one after rescaling.
const QUANTILE: f64 = 0.03;

/// Places that the first program of a start looks at for the range of φ.
const WATCHED: usize = 120;

/// One row of the condition in the coordinates of the unit square.
struct Row {
    basis: Vec<(usize, f64, f64, f64)>,
    form: [f64; 3],
    need: f64,
}

/// Best level function found over the samples of a region, for either sign; `None` if the region is too small or
/// too flat to speak of strips. See [`levels`].
pub fn level(samples: &[Forms], border: &[[f64; 2]], options: &LevelOptions) -> Option<Level> {
    levels(samples, border, options).into_iter().next()
}

/// Level functions over the samples of a region from different starts, for either sign, smallest merit first.
///
/// `border` are further points of the region, such as its corners, that count for the range of φ only. Empty if the
/// region is too small or too flat to speak of strips.
pub fn levels(samples: &[Forms], border: &[[f64; 2]], options: &LevelOptions) -> Vec<Level> {
    let Some((problem, field, aspect)) = problem(samples, border, options) else { return Vec::new() };
    let starts: Vec<(f64, usize)> =
        [1.0, -1.0].into_iter().flat_map(|s| (0..options.starts).map(move |k| (s, k))).collect();
    let mut first: Vec<Level> = starts
        .par_iter()
        .filter_map(|&(sign, k)| {
            let angle = std::f64::consts::PI * k as f64 / options.starts as f64;
            let mut f = field.clone();
            f.set_linear(angle.cos(), angle.sin() * aspect);
            let start = problem.rated(f, sign)?;
            let next = problem.improve(&start, 0.3, &problem.watched);
            Some(next.unwrap_or(start))
        })
        .collect();
    first.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    first.truncate(options.keep);
    let mut found: Vec<Level> = first.into_par_iter().map(|start| problem.refined(start, options.rounds)).collect();
    found.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    found
}

/// Rows and extremes, a field over the region's box, and the ratio of the speeds along v and u.
fn problem(samples: &[Forms], border: &[[f64; 2]], options: &LevelOptions) -> Option<(Problem, Field, f64)> {
    let mut b = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    for p in samples.iter().map(|s| &s.uv).chain(border) {
        b = [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])];
    }
    let field = Field::bicubic(b, options.spans).ok()?;
    let curvature = |s: &Forms| s.principal().map(f64::abs).into_iter().fold(0.0, f64::max);
    let mut sorted: Vec<f64> = samples.iter().map(curvature).filter(|k| k.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let high = *sorted.get(sorted.len() * 9 / 10)?;
    if high <= 0.0 {
        return None;
    }
    let mut rows = Vec::new();
    let mut speed = [0.0, 0.0];
    for s in samples {
        let k = curvature(s);
        let [e, f, g] = s.first;
        let metric = e * g - f * f;
        if !(k.is_finite() && metric > 0.0) || k < FLAT * high {
            continue;
        }
        let det = s.second[0] * s.second[2] - s.second[1] * s.second[1];
        let floor = (FLOOR * k.min(high)).powi(2) * metric;
        speed[0] += e;
        speed[1] += g;
        rows.push(Row { basis: field.basis(s.uv[0], s.uv[1]), form: s.second, need: det.abs().max(floor).sqrt() });
    }
    if rows.len() < 12 {
        return None;
    }
    let value = |p: &[f64; 2]| field.basis(p[0], p[1]).into_iter().map(|(i, n, _, _)| (i, n)).collect();
    let places: Vec<Vec<(usize, f64)>> = samples.iter().map(|s| &s.uv).chain(border).map(value).collect();
    let step = places.len().div_ceil(WATCHED).max(1);
    let watched = (0..places.len()).step_by(step).collect();
    Some((Problem { rows, places, watched }, field, (speed[1] / speed[0]).sqrt()))
}

struct Problem {
    rows: Vec<Row>,
    /// Values of the basis where φ counts for the range.
    places: Vec<Vec<(usize, f64)>>,
    /// Places that the first program looks at; later ones add those where φ was found to be extreme.
    watched: Vec<usize>,
}

impl Row {
    fn gradient(&self, c: &[f64]) -> [f64; 2] {
        self.basis.iter().fold([0.0; 2], |g, &(i, _, du, dv)| [g[0] + du * c[i], g[1] + dv * c[i]])
    }

    /// `q = L φ_v² − 2 M φ_u φ_v + N φ_u²` and its gradient in `(φ_u, φ_v)`.
    fn q(&self, [p, r]: [f64; 2]) -> (f64, [f64; 2]) {
        let [l, m, n] = self.form;
        (n * p * p - 2.0 * m * p * r + l * r * r, [2.0 * (n * p - m * r), 2.0 * (l * r - m * p)])
    }
}

impl Problem {
    /// Rescales a field so that a small quantile of the ratios is one, and rates it.
    fn rated(&self, mut field: Field, sign: f64) -> Option<Level> {
        let ratios = |f: &Field| -> Vec<f64> {
            self.rows.iter().map(|r| (sign * r.q(r.gradient(&f.coefficients)).0).max(0.0).sqrt() / r.need).collect()
        };
        let mut sorted = ratios(&field);
        sorted.sort_by(f64::total_cmp);
        let good: Vec<f64> = sorted.iter().copied().filter(|&r| r > 0.0).collect();
        if good.len() * 2 < sorted.len() {
            return None;
        }
        let scale = 1.0 / good[(good.len() as f64 * QUANTILE) as usize];
        if !scale.is_finite() {
            return None;
        }
        field.coefficients.iter_mut().for_each(|c| *c *= scale);
        let shortfall: f64 =
            sorted.iter().map(|r| (1.0 - r * scale).max(0.0)).sum::<f64>() / sorted.len().max(1) as f64;
        let range = self.extremes(&field).0;
        Some(Level { field, sign, range, merit: range * (1.0 + 30.0 * shortfall) })
    }

    /// A start carried on by at most `rounds` programs, with a trust region that shrinks where nothing is gained.
    fn refined(&self, mut best: Level, rounds: usize) -> Level {
        let mut trust = 0.3;
        let mut watched = self.watched.clone();
        for _ in 0..rounds {
            watched.extend(self.extremes(&best.field).1);
            let next = self.improve(&best, trust, &watched);
            if let Some(next) = &next {
                watched.extend(self.extremes(&next.field).1);
            }
            match next {
                Some(next) if next.merit < best.merit => {
                    let gain = (best.merit - next.merit) / best.merit;
                    best = next;
                    if gain < 1e-3 {
                        break;
                    }
                }
                _ => trust /= 2.5,
            }
        }
        best
    }

    /// Range of a field over all places, and the places where it is smallest and largest.
    fn extremes(&self, field: &Field) -> (f64, [usize; 2]) {
        let (mut lo, mut hi) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
        for (k, b) in self.places.iter().enumerate() {
            let x = b.iter().map(|&(i, n)| n * field.coefficients[i]).sum::<f64>();
            if x < lo.0 {
                lo = (x, k);
            }
            if x > hi.0 {
                hi = (x, k);
            }
        }
        (hi.0 - lo.0, [lo.1, hi.1])
    }

    /// One linear program around `from` with a trust region of `trust` times the range; the range counts at the
    /// `watched` places.
    fn improve(&self, from: &Level, trust: f64, watched: &[usize]) -> Option<Level> {
        let c0 = &from.field.coefficients;
        let n = c0.len();
        let (hi, lo, slack) = (n, n + 1, n + 2);
        let mut lp = LinearProgram::new(n + 2 + self.rows.len());
        lp.cost[hi] = 1.0;
        lp.cost[lo] = -1.0;
        let penalty = 60.0 * from.range / self.rows.len() as f64;
        let mut typical: Vec<f64> = self.rows.iter().map(|r| r.q(r.gradient(c0)).0.abs() / r.need.powi(2)).collect();
        typical.sort_by(f64::total_cmp);
        let small = 1e-3 * typical[typical.len() / 2];
        for (k, r) in self.rows.iter().enumerate() {
            lp.cost[slack + k] = penalty;
            let (q0, dq) = r.q(r.gradient(c0));
            let relative = from.sign * q0 / r.need.powi(2);
            // Conditions divided by what is needed: `gradient · p + slack ≥ bound`.
            let (weight, bound) = if relative > small {
                (from.sign / (2.0 * (from.sign * q0).sqrt() * r.need), 1.0)
            } else {
                (from.sign / r.need.powi(2), 1.0 + relative)
            };
            let mut terms: Vec<(usize, f64)> =
                r.basis.iter().map(|&(i, _, du, dv)| (i, -weight * (dq[0] * du + dq[1] * dv))).collect();
            let largest = terms.iter().map(|t| t.1.abs()).fold(0.0, f64::max);
            if !(largest > 0.0 && largest.is_finite()) {
                continue;
            }
            // Coefficients are about `range`: bring rows to order one there.
            terms.iter_mut().for_each(|t| t.1 /= largest);
            terms.push((slack + k, -1.0 / largest));
            lp.at_most(terms, -bound / largest);
            lp.at_most([(slack + k, -1.0)], 0.0);
        }
        for &k in watched {
            let b = &self.places[k];
            lp.at_most(b.iter().copied().chain([(hi, -1.0)]), 0.0);
            lp.at_most(b.iter().map(|&(i, v)| (i, -v)).chain([(lo, 1.0)]), 0.0);
        }
        let radius = trust * from.range;
        for (i, &c) in c0.iter().enumerate() {
            lp.at_most([(i, 1.0)], c + radius);
            lp.at_most([(i, -1.0)], radius - c);
        }
        let x = lp.solve()?;
        let mut field = from.field.clone();
        field.coefficients.copy_from_slice(&x[..n]);
        self.rated(field, from.sign)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(form: impl Fn(f64, f64) -> ([f64; 3], [f64; 3])) -> Vec<Forms> {
        let n = 15;
        (0..n * n)
            .map(|k| {
                let uv = [(k / n) as f64 / (n - 1) as f64, (k % n) as f64 / (n - 1) as f64];
                let (first, second) = form(uv[0], uv[1]);
                Forms { uv, first, second }
            })
            .collect()
    }

    /// Saddle z = x y over the square of side 2 at small slopes: W = √(2·2·2) (B2).
    #[test]
    fn shallow_saddle_reaches_the_causal_diameter() {
        let s = grid(|_, _| ([4.0, 0.0, 4.0], [0.0, 4.0, 0.0]));
        let l = level(&s, &[], &LevelOptions::default()).expect("a level function");
        assert!(l.merit < 1.05 * 8f64.sqrt(), "{}", l.merit);
        assert!(l.range > 0.93 * 8f64.sqrt(), "{}", l.range);
    }

    /// Shallow paraboloid z = (x² + y²)/2 over the unit square: bands of straight lines, W = 1.
    #[test]
    fn shallow_paraboloid_is_banded_along_a_side() {
        let s = grid(|_, _| ([1.0, 0.0, 1.0], [1.0, 0.0, 1.0]));
        let l = level(&s, &[], &LevelOptions::default()).expect("a level function");
        assert!((l.merit - 1.0).abs() < 0.02, "{}", l.merit);
    }
}
