//! The strip potential whose bands are the strips: shortest range under the eikonal condition in the metric |II|.
//!
//! *Method.* Strips are bands of width `4√ε` of a function φ with `|II⁻¹(dφ, dφ)| ≥ 1` (approximation
//! specification B2–B3, after \[SE06\]); with `q = II(T, T)`, `T = ker dφ`, this reads `s q ≥ |det II|` with one sign
//! `s` over the region. Sequential linear programs shorten the range `W = max φ − min φ`; a floor on `|det II|` keeps
//! rulings away from asymptotic directions and makes parabolic points harmless. Departures: rows are scaled, and the
//! condition is linearised in `q` itself where `q` is small or of the wrong sign.
//!
//! Not guaranteed: a global minimum, or a field without shortfall (the caller looks at `merit`).

use crate::control::Control;
use crate::num::least_squares::BandMatrix;
use crate::num::linear_program::LinearProgram;
use crate::num::parallel;
use crate::spline::field::Field;

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
    pub(crate) fn principal(&self) -> [f64; 2] {
        let [e, f, g] = self.first;
        let [l, m, n] = self.second;
        let det = (e * g - f * f).max(f64::MIN_POSITIVE);
        let h = (e * n - 2.0 * f * m + g * l) / (2.0 * det);
        let k = (l * n - m * m) / det;
        let r = (h * h - k).max(0.0).sqrt();
        [h + r, h - r]
    }
}

/// A strip potential and how good it is.
#[derive(Clone, Debug)]
pub struct StripPotential {
    /// φ in √mm: a band of width `4√ε` can be met within ε.
    pub field: Field,
    /// Sign of `II(T, T)` along the strips.
    pub sign: f64,
    /// Range of φ over the region, √mm.
    pub range: f64,
    /// `range · (1 + 30 · mean shortfall)`: smaller is better; far above `range` when the condition fails somewhere.
    pub merit: f64,
}

/// Knobs of [`strip_potentials`].
#[derive(Clone, Debug)]
pub struct StripPotentialOptions {
    /// Linear starts, evenly spread over the half circle; default 8.
    pub starts: usize,
    /// Starts that go on after their first program; default 2.
    pub keep: usize,
    /// Further programs for each kept start; default 10.
    pub rounds: usize,
    /// Spans of φ per direction; default 2 (5 × 5 coefficients).
    pub spans: usize,
    /// Ends the search early with what was found; default: never.
    pub control: Control,
}

impl Default for StripPotentialOptions {
    fn default() -> Self {
        Self { starts: 8, keep: 2, rounds: 10, spans: 2, control: Control::default() }
    }
}

/// Floor on `√|det II|`, as a share of the region's largest curvature (B3.2).
const FLOOR: f64 = 0.12;
/// Samples at which the square of a speed is below this share of its largest are at a pole, where forms are rounding errors.
const COLLAPSED: f64 = 1e-12;
/// Samples flatter than this share of the 90 % quantile say nothing about φ (C3).
const FLAT: f64 = 0.02;
/// Share of samples whose ratio may stay below one after rescaling.
const QUANTILE: f64 = 0.03;
/// A gain below this share counts as none.
const SMALL: f64 = 1e-3;

/// Conditions, and places for the range of φ, that the first program of a start looks at.
const ROWS: usize = 240;
/// See [`ROWS`].
const WATCHED: usize = 120;
/// Conditions that join after a program, the worst of those that it failed.
const JOINING: usize = 24;
/// Ratio below which a condition counts as failed: with one the hull in strips at 40 mm takes twice the time, for the same panels.
const FAILED: f64 = 0.985;
/// Share of the median by which conditions must be met for their root to be taken linearly: nearer to zero, and below
/// it, the root has no slope to be trusted, and the condition itself is taken.
const NEARLY_MISSED: f64 = 1e-3;
/// Tangent of the angle by which bands may leave a wanted direction.
pub(crate) const TURN: f64 = 0.18;
/// Programs without gain after which a start ends.
const STALLED: usize = 3;

/// One row of the condition in the coordinates of the unit square.
struct ConditionRow {
    basis: Vec<(usize, f64, f64, f64)>,
    form: [f64; 3],
    need: f64,
}

/// Best strip potential found over the samples of a region, for either sign; `None` if the region is too small or
/// too flat to speak of strips. See [`strip_potentials`].
pub(crate) fn strip_potential(
    samples: &[Forms],
    border: &[[f64; 2]],
    options: &StripPotentialOptions,
) -> Option<StripPotential> {
    strip_potentials(samples, border, options).into_iter().next()
}

/// Strip potentials over the samples of a region from different starts, for either sign, smallest merit first.
///
/// `border` are further points of the region, such as its corners, that count for the range of φ only. Empty if the
/// region is too small or too flat to speak of strips.
pub fn strip_potentials(
    samples: &[Forms],
    border: &[[f64; 2]],
    options: &StripPotentialOptions,
) -> Vec<StripPotential> {
    let Some((problem, field, aspect)) = problem(samples, border, options) else { return Vec::new() };
    let starts: Vec<(f64, usize)> =
        [1.0, -1.0].into_iter().flat_map(|s| (0..options.starts).map(move |k| (s, k))).collect();
    let mut first: Vec<StripPotential> = parallel::map(starts.iter(), |&(sign, k)| {
        let angle = std::f64::consts::PI * k as f64 / options.starts as f64;
        let mut f = field.clone();
        f.set_linear(angle.cos(), angle.sin() * aspect);
        let start = problem.rated(f, sign)?;
        if problem.control.stopped() {
            return Some(start);
        }
        let next = problem.improve(&start, 0.3, &problem.active);
        Some(next.unwrap_or(start))
    })
    .into_iter()
    .flatten()
    .collect();
    first.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    first.truncate(options.keep);
    let mut found: Vec<StripPotential> = parallel::map(first, |start| problem.refined(start, options.rounds));
    found.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    found
}

/// What straight bands need whose levels rise along one direction of the parameters.
#[derive(Clone, Debug)]
pub(crate) struct StraightBands {
    /// √mm: divided by the width `4√ε` it is about their number, their widths varying as the surface allows. Infinite
    /// where nothing can be said.
    pub range: f64,
    /// How dense they must lie in 24 equal parts of the range of their levels, from the lowest on: √mm per unit of the
    /// level, up to a common factor. All ones where nothing can be said.
    pub density: Vec<f64>,
}

/// What straight bands whose levels rise along `gradient` (in parameters) need.
///
/// *Method*: the density of levels that the condition on φ asks for (approximation specification B2, B3.2), the largest
/// across each level, summed over the range. *Not guaranteed*: a bound; bands across which the sign of the condition
/// changes are only guessed.
pub(crate) fn straight_bands(samples: &[Forms], gradient: [f64; 2]) -> StraightBands {
    // Divisions of the range, and the smallest share of the usual slope that counts: bands with inflections exist.
    const BINS: usize = 24;
    const LEAST_SLOPE: f64 = 0.15;
    let Some((problem, mut field, _)) =
        problem(samples, &[], &StripPotentialOptions { spans: 1, ..StripPotentialOptions::default() })
    else {
        return StraightBands { range: f64::INFINITY, density: vec![1.0; BINS] };
    };
    field.set_linear(gradient[0], gradient[1]);
    let (range, [lowest, _]) = problem.extremes(&field);
    let value = |b: &[(usize, f64)]| b.iter().map(|&(i, n)| n * field.coefficients[i]).sum::<f64>();
    let lo = value(&problem.places[lowest]);
    let step = range / BINS as f64;
    let slopes: Vec<(f64, f64)> = problem
        .rows
        .iter()
        .map(|r| {
            let at = r.basis.iter().map(|&(i, n, _, _)| n * field.coefficients[i]).sum::<f64>();
            (at, r.q(r.gradient(&field.coefficients)).0.abs().sqrt() / r.need)
        })
        .collect();
    let mut sorted: Vec<f64> = slopes.iter().map(|s| s.1).collect();
    sorted.sort_by(f64::total_cmp);
    let least = LEAST_SLOPE * sorted[sorted.len() / 2];
    let mut need = vec![0.0_f64; BINS];
    for (at, slope) in slopes {
        let bin = &mut need[(((at - lo) / step) as usize).min(BINS - 1)];
        *bin = bin.max(1.0 / slope.max(least));
    }
    // Bins without a sample need what the nearest others need.
    let seen: Vec<(usize, f64)> = need.iter().copied().enumerate().filter(|n| n.1 > 0.0).collect();
    for (k, n) in need.iter_mut().enumerate() {
        *n = seen.iter().min_by_key(|s| s.0.abs_diff(k)).map_or(f64::INFINITY, |s| s.1);
    }
    let sum = need.iter().sum::<f64>() * step;
    if !sum.is_finite() {
        return StraightBands { range: f64::INFINITY, density: vec![1.0; BINS] };
    }
    StraightBands { range: sum, density: need }
}

/// As [`strip_potentials`], for bands that run along given directions: `along[i]` is the one wanted at `samples[i]`, in
/// parameters; zero where there is none. Fields turn from it by at most [`TURN`], or by as much as the least-squares
/// start already does.
pub(crate) fn directed_strip_potentials(
    samples: &[Forms],
    along: &[[f64; 2]],
    border: &[[f64; 2]],
    options: &StripPotentialOptions,
) -> Vec<StripPotential> {
    let Some((mut problem, field, _)) = problem(samples, border, options) else { return Vec::new() };
    let wanted: Vec<Wanted> =
        samples.iter().zip(along).filter_map(|(s, &a)| Wanted::new(s, a, field.basis(s.uv[0], s.uv[1]))).collect();
    let Some(start) = follow(&wanted, field) else { return Vec::new() };
    let step = wanted.len().div_ceil(WATCHED).max(1);
    problem.wanted = wanted.into_iter().step_by(step).collect();
    let mut found: Vec<StripPotential> =
        parallel::map([1.0, -1.0], |sign| Some(problem.refined(problem.rated(start.clone(), sign)?, options.rounds)))
            .into_iter()
            .flatten()
            .collect();
    found.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    found
}

/// A direction that bands are wanted to follow.
struct Wanted {
    basis: Vec<(usize, f64, f64, f64)>,
    /// The direction and, square to it, the one in which the field should rise; both of unit length on the surface.
    along: [f64; 2],
    across: [f64; 2],
}

impl Wanted {
    /// `None` without a direction, or where the parametrisation collapses.
    fn new(s: &Forms, [a, b]: [f64; 2], basis: Vec<(usize, f64, f64, f64)>) -> Option<Self> {
        let [e, f, g] = s.first;
        let length = (e * a * a + 2.0 * f * a * b + g * b * b).sqrt();
        let area = (e * g - f * f).sqrt();
        if !(length > 0.0 && area > 0.0 && length.is_finite()) {
            return None;
        }
        let (a, b) = (a / length, b / length);
        Some(Self { basis, along: [a, b], across: [-(f * a + g * b) / area, (e * a + f * b) / area] })
    }

    /// Coefficients of the slope in a direction.
    fn slope<'a>(&'a self, [a, b]: &'a [f64; 2]) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.basis.iter().map(move |&(i, _, du, dv)| (i, du * a + dv * b))
    }

    /// Slopes of a field along and across.
    fn slopes(&self, c: &[f64]) -> [f64; 2] {
        [&self.along, &self.across].map(|d| self.slope(d).map(|(i, x)| x * c[i]).sum())
    }
}

/// The field that rises by one per length square to the wanted directions, as nearly as can be.
fn follow(wanted: &[Wanted], mut field: Field) -> Option<Field> {
    // Keeps coefficients that no sample sees near each other's mean.
    const WEAK: f64 = 1e-9;
    let n = field.coefficients.len();
    let mut matrix = BandMatrix::zeros(n, n);
    let mut right = vec![0.0; n];
    for w in wanted {
        for (direction, rise) in [(&w.along, 0.0), (&w.across, 1.0)] {
            let row: Vec<(usize, f64)> = w.slope(direction).collect();
            for &(i, x) in &row {
                right[i] += x * rise;
                row.iter().filter(|t| t.0 <= i).for_each(|&(j, y)| matrix.add_entry(i, j, x * y));
            }
        }
    }
    let weak = WEAK * (0..n).map(|i| matrix.diagonal(i)).fold(0.0, f64::max);
    (0..n).for_each(|i| matrix.add_diagonal(i, weak));
    if wanted.is_empty() || !matrix.factorise() {
        return None;
    }
    matrix.solve(&mut right);
    field.coefficients = right;
    Some(field)
}

/// Rows and extremes, a field over the region's box, and the ratio of the speeds along v and u.
fn problem(samples: &[Forms], border: &[[f64; 2]], options: &StripPotentialOptions) -> Option<(Problem, Field, f64)> {
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
    let most = |of: usize| samples.iter().map(|s| s.first[of]).fold(0.0, f64::max);
    let [most_e, most_g] = [most(0), most(2)];
    for s in samples {
        let k = curvature(s);
        let [e, f, g] = s.first;
        let metric = e * g - f * f;
        if !(k.is_finite() && metric > 0.0 && e > COLLAPSED * most_e && g > COLLAPSED * most_g) || k < FLAT * high {
            continue;
        }
        let det = s.second[0] * s.second[2] - s.second[1] * s.second[1];
        let floor = (FLOOR * k.min(high)).powi(2) * metric;
        speed[0] += e;
        speed[1] += g;
        rows.push(ConditionRow {
            basis: field.basis(s.uv[0], s.uv[1]),
            form: s.second,
            need: det.abs().max(floor).sqrt(),
        });
    }
    if rows.len() < 12 {
        return None;
    }
    let every = |count: usize, most: usize| (0..count).step_by(count.div_ceil(most).max(1)).collect();
    let value = |p: &[f64; 2]| field.basis(p[0], p[1]).into_iter().map(|(i, n, _, _)| (i, n)).collect();
    let places: Vec<Vec<(usize, f64)>> = samples.iter().map(|s| &s.uv).chain(border).map(value).collect();
    let active = Active { rows: every(rows.len(), ROWS), places: every(places.len(), WATCHED) };
    let control = options.control.clone();
    Some((Problem { rows, places, active, wanted: Vec::new(), control }, field, (speed[1] / speed[0]).sqrt()))
}

struct Problem {
    rows: Vec<ConditionRow>,
    /// Values of the basis where φ counts for the range.
    places: Vec<Vec<(usize, f64)>>,
    /// What the first program looks at.
    active: Active,
    /// Directions that the bands must follow.
    wanted: Vec<Wanted>,
    /// Programs are given up when it says so: what was found stands.
    control: Control,
}

/// Conditions and places that a program looks at; more join where its answer fails the others.
#[derive(Clone)]
struct Active {
    rows: Vec<usize>,
    places: Vec<usize>,
}

impl ConditionRow {
    fn gradient(&self, c: &[f64]) -> [f64; 2] {
        self.basis.iter().fold([0.0; 2], |g, &(i, _, du, dv)| [g[0] + du * c[i], g[1] + dv * c[i]])
    }

    /// Share of the slope that is needed; 0 where `q` has the wrong sign.
    fn ratio(&self, c: &[f64], sign: f64) -> f64 {
        (sign * self.q(self.gradient(c)).0).max(0.0).sqrt() / self.need
    }

    /// `q = L φ_v² − 2 M φ_u φ_v + N φ_u²` and its gradient in `(φ_u, φ_v)`.
    fn q(&self, [p, r]: [f64; 2]) -> (f64, [f64; 2]) {
        let [l, m, n] = self.form;
        (n * p * p - 2.0 * m * p * r + l * r * r, [2.0 * (n * p - m * r), 2.0 * (l * r - m * p)])
    }
}

impl Problem {
    /// Rescales a field so that a small quantile of the ratios is one, and rates it.
    fn rated(&self, mut field: Field, sign: f64) -> Option<StripPotential> {
        let mut sorted: Vec<f64> = self.rows.iter().map(|r| r.ratio(&field.coefficients, sign)).collect();
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
        Some(StripPotential { field, sign, range, merit: range * (1.0 + 30.0 * shortfall) })
    }

    /// A start carried on by at most `rounds` programs, with a trust region that shrinks where nothing is gained.
    fn refined(&self, mut best: StripPotential, rounds: usize) -> StripPotential {
        let mut trust = 0.3;
        let mut active = self.active.clone();
        let mut stalled = 0;
        for _ in 0..rounds {
            if self.control.stopped() {
                break;
            }
            self.join(&best, &mut active);
            let next = self.improve(&best, trust, &active);
            if let Some(next) = &next {
                self.join(next, &mut active);
            }
            match next {
                Some(next) if next.merit < best.merit => {
                    stalled = if (best.merit - next.merit) < SMALL * best.merit { stalled + 1 } else { 0 };
                    best = next;
                }
                _ => {
                    stalled += 1;
                    trust /= 2.5;
                }
            }
            if stalled == STALLED {
                break;
            }
        }
        best
    }

    /// Takes in the conditions that a field fails worst, and the places where it is extreme.
    fn join(&self, l: &StripPotential, active: &mut Active) {
        active.places.extend(self.extremes(&l.field).1);
        let mut failed: Vec<(f64, usize)> = self
            .rows
            .iter()
            .map(|r| r.ratio(&l.field.coefficients, l.sign))
            .enumerate()
            .filter(|(k, ratio)| *ratio < FAILED && !active.rows.contains(k))
            .map(|(k, ratio)| (ratio, k))
            .collect();
        failed.sort_by(|a, b| a.0.total_cmp(&b.0));
        active.rows.extend(failed.iter().take(JOINING).map(|f| f.1));
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

    /// One linear program around `from` with a trust region of `trust` times the range; it looks at the
    /// `active` conditions and places.
    fn improve(&self, from: &StripPotential, trust: f64, active: &Active) -> Option<StripPotential> {
        let c0 = &from.field.coefficients;
        let n = c0.len();
        let (hi, lo, slack) = (n, n + 1, n + 2);
        let rows: Vec<&ConditionRow> = active.rows.iter().map(|&k| &self.rows[k]).collect();
        let mut lp = LinearProgram::new(n + 2 + rows.len());
        lp.cost[hi] = 1.0;
        lp.cost[lo] = -1.0;
        let penalty = 60.0 * from.range / rows.len() as f64;
        let mut typical: Vec<f64> = rows.iter().map(|r| r.q(r.gradient(c0)).0.abs() / r.need.powi(2)).collect();
        typical.sort_by(f64::total_cmp);
        let small = NEARLY_MISSED * typical[typical.len() / 2];
        for (k, r) in rows.iter().enumerate() {
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
        for &k in &active.places {
            let b = &self.places[k];
            lp.at_most(b.iter().copied().chain([(hi, -1.0)]), 0.0);
            lp.at_most(b.iter().map(|&(i, v)| (i, -v)).chain([(lo, 1.0)]), 0.0);
        }
        for w in &self.wanted {
            let [a, b] = w.slopes(c0);
            if b > 0.0 {
                let turn = TURN.max(a.abs() / b);
                for side in [1.0, -1.0] {
                    let terms: Vec<(usize, f64)> = w
                        .slope(&w.along)
                        .zip(w.slope(&w.across))
                        .map(|(x, y)| (x.0, side * x.1 - turn * y.1))
                        .collect();
                    let largest = terms.iter().map(|t| t.1.abs()).fold(f64::MIN_POSITIVE, f64::max);
                    lp.at_most(terms.into_iter().map(|(i, x)| (i, x / largest)), 0.0);
                }
            }
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
        let l = strip_potential(&s, &[], &StripPotentialOptions::default()).expect("a strip potential");
        assert!(l.merit < 1.05 * 8f64.sqrt(), "{}", l.merit);
        assert!(l.range > 0.93 * 8f64.sqrt(), "{}", l.range);
    }

    /// Straight bands across a paraboloid need the root of its curvature across them, the larger where it varies.
    #[test]
    fn straight_bands_need_what_curves_across_them() {
        let s = grid(|_, _| ([1.0, 0.0, 1.0], [4.0, 0.0, 1.0]));
        let range = |s: &[Forms], gradient| straight_bands(s, gradient).range;
        assert!((range(&s, [1.0, 0.0]) - 2.0).abs() < 1e-9, "{}", range(&s, [1.0, 0.0]));
        assert!((range(&s, [0.0, 1.0]) - 1.0).abs() < 1e-9, "{}", range(&s, [0.0, 1.0]));
        let half = grid(|u, _| ([1.0, 0.0, 1.0], [if u < 0.5 { 4.0 } else { 1.0 }, 0.0, 1.0]));
        let r = range(&half, [1.0, 0.0]);
        // Seven of fifteen rows of samples lie in the first half.
        assert!((r - 1.5).abs() < 0.08, "{r}");
        let density = straight_bands(&half, [1.0, 0.0]).density;
        assert!((density[2] / density[20] - 2.0).abs() < 1e-9, "{density:?}");
    }

    /// At a pole forms are rounding errors, which say nothing about the bands elsewhere.
    #[test]
    fn collapsed_samples_do_not_count() {
        let mut s = grid(|_, _| ([1.0, 0.0, 1.0], [4.0, 0.0, 1.0]));
        s[7].first = [1e-30, 0.0, 1.0];
        s[7].second = [1e-16, 0.0, 1.0];
        let range = straight_bands(&s, [0.0, 1.0]).range;
        assert!((range - 1.0).abs() < 1e-9, "{range}");
    }

    /// Bands wanted at 40° to the sides of a paraboloid follow that direction; where none is wanted there is no field.
    #[test]
    fn bands_follow_a_wanted_direction() {
        let s = grid(|_, _| ([1.0, 0.0, 1.0], [1.0, 0.0, 1.0]));
        let (sin, cos) = 40f64.to_radians().sin_cos();
        let found = directed_strip_potentials(&s, &vec![[cos, sin]; s.len()], &[], &StripPotentialOptions::default());
        let l = found.first().expect("a strip potential");
        for p in [[0.1, 0.1], [0.5, 0.5], [0.9, 0.2]] {
            let [_, du, dv] = l.field.jet(p[0], p[1]);
            assert!((du * cos + dv * sin).abs() <= 1.05 * TURN * (dv * cos - du * sin), "{du} {dv}");
        }
        // Bands square to a direction at an angle are as many as that direction's extent asks for.
        assert!(l.range < 1.02 * (sin + cos), "{}", l.range);
        assert!(
            directed_strip_potentials(&s, &vec![[0.0; 2]; s.len()], &[], &StripPotentialOptions::default()).is_empty()
        );
    }

    /// Shallow paraboloid z = (x² + y²)/2 over the unit square: bands of straight lines, W = 1.
    #[test]
    fn shallow_paraboloid_is_banded_along_a_side() {
        let s = grid(|_, _| ([1.0, 0.0, 1.0], [1.0, 0.0, 1.0]));
        let l = strip_potential(&s, &[], &StripPotentialOptions::default()).expect("a strip potential");
        assert!((l.merit - 1.0).abs() < 0.02, "{}", l.merit);
    }
}
