//! Strips that agree about their seams: control planes (or profiles) of all strips and offsets of all seams together.
//!
//! *Method* (consensus of neighbours, \[SE06\] carried on). A seam is a line on the surface, lifted by an unknown offset
//! along its normals or others near them; its points must have distance zero from both strips. Distances of samples and
//! of seam points are linearised in the strips' coefficients (control planes, or profile and slopes of rulings) and the
//! offsets; the feet stay (envelope theorem). Seam points count so much that they are conditions. Lawson's weights make
//! the largest distance of a sample small. Every strip's coefficients are eliminated by its own factor, banded for planes;
//! what is left is banded in the offsets. Unlike connecting developables this needs no curves beyond the region and bears
//! rulings that lean far, at the price of gaps as large as the splines cannot follow.
//!
//! *Not guaranteed*: that strips agree; gaps and distances are sampled.

use super::feet::feet;
use super::form::Form;
use crate::fit::near::descent::Family;
use crate::fit::near::samples::Sample;
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::knots::Knots;
use crate::torse::form::Torse;
use rayon::prelude::*;

/// A point of the line under a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinePoint {
    /// Parameter along the line, mm.
    pub s: f64,
    /// Position on the surface, mm.
    pub x: Vec3,
    /// Unit direction in which the line is lifted, about normal to surface and strips.
    pub n: Vec3,
}

/// A line on the surface between two strips.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Indices of the strips.
    pub strips: [usize; 2],
    /// At least two points with increasing `s`.
    pub points: Vec<LinePoint>,
}

/// A strip that is to agree with its neighbours.
#[derive(Clone, Debug)]
pub(crate) struct Agreeing<'a> {
    /// Where it starts from.
    pub torse: &'a Torse,
    /// Points of the surface that it is for.
    pub samples: &'a [Sample],
    /// How firmly its planes keep their ways: factor on the fairness of their changes; 1.
    pub firmness: f64,
}

/// Knobs of [`consensus`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ConsensusOptions {
    /// Wanted distance of the surface from the strips, mm.
    pub tolerance: f64,
    /// Spans of the strips' planes; 60. Profiles have half as many, slopes of rulings a quarter.
    pub spans: usize,
    /// Steps at most; 18.
    pub rounds: usize,
    /// Weight of a seam point against a sample; 50. Less leaves wider gaps and smaller distances.
    pub weight: f64,
}

impl ConsensusOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, spans: 60, rounds: 18, weight: 50.0 }
    }
}

/// A strip after consensus.
#[derive(Clone, Debug)]
pub(crate) struct Agreed {
    /// The strip.
    pub torse: Torse,
    /// Largest distance of a sample, mm.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests hold the fit to it"))]
    pub error: f64,
}

/// A seam after consensus.
#[derive(Clone, Debug)]
pub(crate) struct AgreedLine {
    knots: Knots,
    offset: Vec<f64>,
    /// Largest sum of its points' distances from both strips, mm.
    pub gap: f64,
}

impl AgreedLine {
    /// Offset at `s` along the surface's normal, mm.
    pub fn offset_at(&self, s: f64) -> f64 {
        spline_value(&self.knots, &self.offset, s)
    }
}

/// Points per span of an offset, and spans at most.
const OFFSET_SPANS: (usize, usize) = (3, 26);
/// Weight of second differences of an offset's steps.
const SMOOTH: f64 = 1e-3;
/// Lawson's steps on one linearisation.
const LAWSON: usize = 5;
/// Share of its weight that a sample without distance keeps, and the least weight.
const KEPT: (f64, f64) = (0.05, 1e-5);
/// What a gap counts against a distance when steps are judged, share of the weight of seam points.
const GAP: f64 = 0.08;
/// Trials of a step: with every one the damping (share of the normal matrix' diagonal) and the family's fairness, which
/// hold steps back, grow by these factors.
const TRIALS: usize = 5;
/// See [`TRIALS`].
const DAMPING: (f64, f64) = (1e-4, 10.0);
/// See [`TRIALS`].
const FIRM: (f64, f64) = (0.3, 3.0);
/// Trial lengths of a step.
const SHARES: [f64; 2] = [1.0, 0.35];
/// Steps end when they gain less than this share of the tolerance, so many times in a row.
const GAIN: (f64, usize) = (2e-3, 2);

fn spline_value(knots: &Knots, coefficients: &[f64], s: f64) -> f64 {
    let b = knots.basis(s, 0);
    (0..=knots.degree()).map(|j| b.rows[0][j] * coefficients[b.first + j]).sum()
}

/// One strip with its unknowns.
#[derive(Clone)]
struct Member {
    form: Form,
    x: Vec<f64>,
    /// Number of samples; points of seams follow them.
    samples: usize,
    firmness: f64,
    /// Seams and where their points begin.
    seams: Vec<(usize, usize)>,
    weights: Vec<f64>,
    /// Distances in units of the tolerance.
    residual: Vec<f64>,
}

/// One seam with its unknowns, offsets in units of the tolerance.
#[derive(Clone)]
struct Lift<'a> {
    line: &'a Line,
    knots: Knots,
    offset: Vec<f64>,
    /// Column of its first coefficient.
    first: usize,
}

impl Lift<'_> {
    fn point(&self, k: usize, tolerance: f64) -> Vec3 {
        let p = &self.line.points[k];
        p.x + p.n * (spline_value(&self.knots, &self.offset, p.s) * tolerance)
    }
}

impl Member {
    fn factor(&self, tolerance: f64) -> f64 {
        self.form.unit() / tolerance
    }

    fn all(&self) -> Vec<usize> {
        (0..self.form.points().len()).collect()
    }

    /// Puts the seams' points where the seams are.
    fn follow(&mut self, lifts: &[Lift], tolerance: f64) {
        for &(l, first) in &self.seams {
            for k in 0..lifts[l].line.points.len() {
                let x = self.form.point(&lifts[l].point(k, tolerance));
                self.form.points_mut()[first + k] = x;
            }
        }
    }

    /// Distances at the coefficients; `false` if the strip is not regular there.
    fn measured(&mut self, tolerance: f64) -> bool {
        let all = self.all();
        let x = std::mem::take(&mut self.x);
        let mut residual = std::mem::take(&mut self.residual);
        let good = x.iter().all(|c| c.is_finite()) && self.form.residuals(&x, &all, &mut residual);
        if good {
            self.form.adopt(&all);
            let f = self.factor(tolerance);
            residual.iter_mut().for_each(|r| *r *= f);
        }
        (self.x, self.residual) = (x, residual);
        good
    }

    fn finished(&self, samples: &[Sample]) -> Option<Agreed> {
        let (torse, error) = self.form.finished(&self.x, samples)?;
        Some(Agreed { torse, error })
    }

    fn error(&self) -> f64 {
        self.residual[..self.samples].iter().fold(0.0, |m, r| m.max(r.abs()))
    }
}

/// What holds a step back, and the weight of seam points.
#[derive(Clone, Copy)]
struct Hold {
    damping: f64,
    firm: f64,
    weight: f64,
}

/// The linear system of a strip, for changes of its control planes and of its seams' offsets.
struct Linear {
    rows: Rows,
    /// Soft conditions and seam points, ready to be added to.
    base: BandMatrix,
    right: Vec<f64>,
    /// Columns (number, entries) of coefficients of offsets.
    coupling: Vec<(usize, Vec<f64>)>,
    /// `(row, column, value)` in the offsets' own matrix.
    own: Vec<(usize, usize, f64)>,
    own_right: Vec<(usize, f64)>,
}

/// Strips that share seams as nearly as their splines allow, with small largest distances from their samples.
///
/// *Input*: strips as they were fitted, lines between them. *Result*: strips and lines in the same order; no strip where
/// one is not regular at its own samples and seams. `None` for lines without length.
pub(crate) fn consensus(
    strips: &[Agreeing],
    lines: &[Line],
    options: &ConsensusOptions,
) -> Option<(Vec<Option<Agreed>>, Vec<AgreedLine>)> {
    let tolerance = options.tolerance;
    let mut lifts: Vec<Lift> = Vec::new();
    let mut columns = 0;
    for line in lines {
        let (a, b) = (line.points.first()?.s, line.points.last()?.s);
        let spans = (line.points.len() / OFFSET_SPANS.0).clamp(1, OFFSET_SPANS.1);
        let knots = Knots::uniform(3, spans, a, b).ok()?;
        let count = knots.control_count();
        lifts.push(Lift { line, knots, offset: vec![0.0; count], first: columns });
        columns += count;
    }
    // 1. Strips with their seams' points.
    let mut out: Vec<usize> = Vec::new();
    let mut members: Vec<Member> = loop {
        let all: Vec<Option<Member>> = strips
            .par_iter()
            .enumerate()
            .map(|(k, s)| if out.contains(&k) { None } else { member(k, s, &lifts, &out, options) })
            .collect();
        let failed: Vec<usize> = (0..strips.len()).filter(|k| all[*k].is_none()).collect();
        if failed == out {
            break all.into_iter().flatten().collect();
        }
        out = failed;
    };
    started(&members, &mut lifts);
    let (weight, counts) = (options.weight, GAP * options.weight);
    let mut state = judged(&mut members, &lifts, tolerance, counts)?;
    // 2. Steps on all of them.
    let mut idle = 0;
    let (mut damping, mut firm) = (DAMPING.0, FIRM.0);
    for _ in 0..options.rounds {
        let mut better = None;
        for _ in 0..TRIALS {
            let Some((changes, offsets)) =
                step(&mut members, &lifts, columns, tolerance, Hold { damping, firm, weight })
            else {
                break;
            };
            better = SHARES.iter().find_map(|&share| {
                let (mut m, mut l) = (members.clone(), lifts.clone());
                for (m, c) in m.iter_mut().zip(&changes) {
                    m.x.iter_mut().zip(c).for_each(|(x, d)| *x += share * d);
                }
                for l in &mut l {
                    let first = l.first;
                    l.offset.iter_mut().enumerate().for_each(|(i, a)| *a += share * offsets[first + i]);
                }
                let next = judged(&mut m, &l, tolerance, counts);
                let next = next?;
                (next < state).then_some((next, m, l))
            });
            if better.is_some() {
                break;
            }
            (damping, firm) = (damping * DAMPING.1, firm * FIRM.1);
        }
        let Some((next, m, l)) = better else { break };
        (damping, firm) = ((damping / DAMPING.1).max(DAMPING.0), (firm / FIRM.1).max(FIRM.0));
        idle = if state - next < GAIN.0 { idle + 1 } else { 0 };
        (state, members, lifts) = (next, m, l);
        if idle >= GAIN.1 {
            break;
        }
    }
    // 3. Strips and seams in mm.
    let gaps: Vec<f64> = (0..lifts.len()).map(|l| gap(l, &members, &lifts) * tolerance).collect();
    let mut left = members.iter();
    let agreed = strips
        .iter()
        .enumerate()
        .map(|(k, s)| if out.contains(&k) { None } else { left.next()?.finished(s.samples) })
        .collect();
    let lines = lifts.into_iter().zip(gaps).map(|(l, gap)| AgreedLine {
        offset: l.offset.iter().map(|a| a * tolerance).collect(),
        knots: l.knots,
        gap: if l.line.strips.iter().any(|s| out.contains(s)) { f64::INFINITY } else { gap },
    });
    Some((agreed, lines.collect()))
}

/// Feet of all points on one sheet.
fn settle(form: &mut Form, x: &[f64]) {
    let sheet = form.sheet(x);
    let (lo, hi) = sheet.domain();
    let range = (lo - SETTLED * (hi - lo), hi + SETTLED * (hi - lo));
    let found = feet(&sheet, form.points(), form.found(), range);
    form.feet().iter_mut().zip(found).for_each(|(t, f)| *t = f.unwrap_or(*t));
}

/// Multiples of the spans with which strips take part.
const FINER: [usize; 3] = [1, 2, 4];

/// Share of a strip's domain beyond it in which feet are looked for.
const SETTLED: f64 = 0.15;

fn member(index: usize, strip: &Agreeing, lifts: &[Lift], out: &[usize], options: &ConsensusOptions) -> Option<Member> {
    let mut points: Vec<Vec3> = strip.samples.iter().map(|s| s.x).collect();
    let mut seams = Vec::new();
    for (l, lift) in lifts.iter().enumerate() {
        if lift.line.strips.iter().any(|s| out.contains(s)) {
            continue;
        }
        for _ in lift.line.strips.iter().filter(|s| **s == index) {
            seams.push((l, points.len()));
            points.extend(lift.line.points.iter().map(|p| p.x));
        }
    }
    let all: Vec<usize> = (0..points.len()).collect();
    let (mut form, x) = Form::of(strip.torse, strip.samples, &points)?;
    let mut residual = Vec::new();
    settle(&mut form, &x);
    if !form.residuals(&x, &all, &mut residual) {
        return None;
    }
    form.adopt(&all);
    // As few spans as it takes for the strip to stay regular.
    let (mut form, x) = FINER.iter().find_map(|finer| {
        let (mut even, y) = form.refitted(&x, options.spans * finer)?;
        even.residuals(&y, &all, &mut residual).then_some((even, y))
    })?;
    form.adopt(&all);
    let f = form.unit() / options.tolerance;
    residual.iter_mut().for_each(|r| *r *= f);
    let samples = strip.samples.len();
    Some(Member { form, x, samples, firmness: strip.firmness, seams, weights: vec![1.0; samples], residual })
}

/// First offsets: the mean of both strips along the normal.
fn started(members: &[Member], lifts: &mut [Lift]) {
    for l in 0..lifts.len() {
        let mut sum = vec![0.0; lifts[l].line.points.len()];
        for m in members {
            let sheet = m.form.sheet(&m.x);
            for &(_, first) in m.seams.iter().filter(|s| s.0 == l) {
                for (k, sum) in sum.iter_mut().enumerate() {
                    let n = m.form.normal(&sheet, first + k);
                    *sum -= 0.5 * m.residual[first + k] / n.dot(&lifts[l].line.points[k].n);
                }
            }
        }
        let (knots, line) = (lifts[l].knots.clone(), lifts[l].line);
        let n = knots.control_count();
        let mut rows = Rows::new(n, 4);
        let mut matrix = BandMatrix::zeros(n, 4);
        let mut right = vec![0.0; n];
        for (p, a) in line.points.iter().zip(&sum) {
            let b = knots.basis(p.s, 0);
            rows.push(b.first).1.copy_from_slice(&b.rows[0][..4]);
            matrix.add_row(&rows, rows.len() - 1, 1.0);
            rows.scatter(rows.len() - 1, *a, &mut right);
        }
        for (first, stencil) in seconds(n) {
            rows.push(first).1.copy_from_slice(&stencil);
            matrix.add_row(&rows, rows.len() - 1, SMOOTH);
        }
        if matrix.factorise() {
            matrix.solve(&mut right);
            lifts[l].offset = right;
        }
    }
}

/// Second differences of `n ≥ 4` coefficients, as rows of four.
fn seconds(n: usize) -> impl Iterator<Item = (usize, [f64; 4])> {
    (0..n - 2).map(move |i| {
        let first = i.min(n - 4);
        let mut row = [0.0; 4];
        row[i - first..i - first + 3].copy_from_slice(&[1.0, -2.0, 1.0]);
        (first, row)
    })
}

/// Largest sum of distances of a seam's points from both strips, in units of the tolerance.
fn gap(l: usize, members: &[Member], lifts: &[Lift]) -> f64 {
    let mut sum = vec![0.0; lifts[l].line.points.len()];
    for m in members {
        for &(_, first) in m.seams.iter().filter(|s| s.0 == l) {
            sum.iter_mut().enumerate().for_each(|(k, s)| *s += m.residual[first + k].abs());
        }
    }
    sum.into_iter().fold(0.0, f64::max)
}

/// Measures all strips; how good they are, less is better. `None` if one is not regular.
fn judged(members: &mut [Member], lifts: &[Lift], tolerance: f64, counts: f64) -> Option<f64> {
    let good = members
        .par_iter_mut()
        .map(|m| {
            m.follow(lifts, tolerance);
            m.measured(tolerance)
        })
        .reduce(|| true, |a, b| a && b);
    if !good {
        return None;
    }
    let error = members.iter().map(Member::error).fold(0.0, f64::max);
    let gap = (0..lifts.len()).map(|l| gap(l, members, lifts)).fold(0.0, f64::max);
    let merit = error + counts * gap;
    merit.is_finite().then_some(merit)
}

/// Changes of all control planes and offsets.
fn step(
    members: &mut [Member],
    lifts: &[Lift],
    columns: usize,
    tolerance: f64,
    hold: Hold,
) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
    let linear: Vec<Linear> = members.par_iter_mut().map(|m| linearised(m, lifts, tolerance, hold)).collect();
    let reach = linear.iter().filter_map(|l| Some(l.coupling.last()?.0 - l.coupling.first()?.0 + 1)).max()?;
    let mut out = None;
    for _ in 0..LAWSON {
        // Every strip with its weights: factor, and what the offsets see of it.
        let parts: Vec<(Vec<f64>, Vec<Vec<f64>>)> = members
            .par_iter()
            .zip(&linear)
            .map(|(m, l)| {
                let mut matrix = l.base.clone();
                let mut right = l.right.clone();
                for (i, w) in m.weights.iter().enumerate() {
                    matrix.add_row(&l.rows, i, *w);
                    l.rows.scatter(i, w * m.residual[i], &mut right);
                }
                if !matrix.factorise() {
                    return None;
                }
                matrix.solve(&mut right);
                let solved = l.coupling.iter().map(|(_, c)| {
                    let mut c = c.clone();
                    matrix.solve(&mut c);
                    c
                });
                Some((right, solved.collect()))
            })
            .collect::<Option<_>>()?;
        let mut matrix = BandMatrix::zeros(columns, reach);
        let mut alpha = vec![0.0; columns];
        for (l, (right, solved)) in linear.iter().zip(&parts) {
            l.own.iter().filter(|o| o.1 <= o.0).for_each(|&(i, j, v)| matrix.add_entry(i, j, v));
            l.own_right.iter().for_each(|&(i, v)| alpha[i] -= v);
            for (i, ci) in &l.coupling {
                alpha[*i] += dot(ci, right);
                for ((j, _), sj) in l.coupling.iter().zip(solved) {
                    if j <= i {
                        matrix.add_entry(*i, *j, -dot(ci, sj));
                    }
                }
            }
        }
        for lift in lifts {
            let n = lift.offset.len();
            for (first, row) in seconds(n) {
                for p in 0..4 {
                    for q in 0..=p {
                        let at = lift.first + first;
                        matrix.add_entry(at + p, at + q, SMOOTH * row[p] * row[q]);
                    }
                }
            }
        }
        for i in 0..columns {
            matrix.add_diagonal(i, STEADY);
        }
        if !matrix.factorise() {
            break;
        }
        matrix.solve(&mut alpha);
        let changes: Vec<Vec<f64>> = linear
            .iter()
            .zip(&parts)
            .map(|(l, (right, solved))| {
                let mut d: Vec<f64> = right.iter().map(|r| -r).collect();
                for ((i, _), s) in l.coupling.iter().zip(solved) {
                    d.iter_mut().zip(s).for_each(|(d, s)| *d -= s * alpha[*i]);
                }
                d
            })
            .collect();
        reweight(members, &linear, &changes);
        out = Some((changes, alpha));
    }
    out
}

/// Added to the diagonal of the offsets' matrix, and share of the mean diagonal added to the strips'.
const STEADY: f64 = 1e-6;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Lawson's rule on the distances that a step is expected to leave, for all strips together.
fn reweight(members: &mut [Member], linear: &[Linear], changes: &[Vec<f64>]) {
    let expected: Vec<Vec<f64>> = members
        .iter()
        .zip(linear)
        .zip(changes)
        .map(|((m, l), c)| (0..m.samples).map(|i| (m.residual[i] + l.rows.dot(i, c)).abs()).collect())
        .collect();
    let largest = expected.iter().flatten().fold(0.0, |m: f64, r| m.max(*r));
    if !(largest > 0.0 && largest.is_finite()) {
        return;
    }
    let (mut sum, mut count) = (0.0, 0);
    for (m, e) in members.iter_mut().zip(&expected) {
        for (w, r) in m.weights.iter_mut().zip(e) {
            *w *= KEPT.0 + r / largest;
            sum += *w;
            count += 1;
        }
    }
    let scale = count as f64 / sum;
    members.iter_mut().flat_map(|m| &mut m.weights).for_each(|w| *w = (*w * scale).max(KEPT.1));
}

fn linearised(m: &mut Member, lifts: &[Lift], tolerance: f64, hold: Hold) -> Linear {
    let Hold { damping, firm, weight: heavy } = hold;
    let firm = firm * m.firmness;
    let f = m.factor(tolerance);
    let all = m.all();
    let scaled: Vec<f64> = m.residual.iter().map(|r| r / f).collect();
    let (n, width) = (m.form.unknowns(), m.form.width());
    let mut raw = Rows::new(n, width);
    m.form.jacobian(&m.x, &all, &scaled, &mut raw);
    let mut rows = Rows::new(n, width);
    for i in 0..raw.len() {
        let (first, row) = raw.row(i);
        rows.push(first).1.iter_mut().zip(row).for_each(|(o, v)| *o = f * v);
    }
    let mut base = BandMatrix::zeros(n, width);
    let mut right = vec![0.0; n];
    // 1. Gauges and smoothness.
    let (mut soft, mut rest) = (Rows::new(n, width), Vec::new());
    m.form.soft(&m.x, m.samples, m.error() / f, &mut soft, &mut rest);
    for (i, r) in rest.iter().enumerate() {
        base.add_row(&soft, i, f * f);
        soft.scatter(i, f * f * r, &mut right);
    }
    soft.clear();
    m.form.fairness(&mut soft);
    for i in 0..soft.len() {
        base.add_row(&soft, i, f * f * firm * firm * m.samples as f64);
    }
    let mut squares = vec![0.0; n];
    for i in 0..m.samples {
        let (first, row) = rows.row(i);
        squares[first..].iter_mut().zip(row).for_each(|(s, v)| *s += v * v);
    }
    let mean = squares.iter().sum::<f64>() / n as f64;
    squares.iter().enumerate().for_each(|(i, s)| base.add_diagonal(i, damping * s + STEADY * mean));
    // 2. Seam points.
    let sheet = m.form.sheet(&m.x);
    let (mut coupling, mut own, mut own_right) = (Vec::new(), Vec::new(), Vec::new());
    let mut seams = m.seams.clone();
    seams.sort_by_key(|s| lifts[s.0].first);
    for (l, first) in seams {
        let lift = &lifts[l];
        let count = lift.line.points.len();
        let weight = heavy * heavy * m.samples as f64 / count as f64;
        let mut block = vec![vec![0.0; n]; lift.offset.len()];
        for (k, p) in lift.line.points.iter().enumerate() {
            let i = first + k;
            base.add_row(&rows, i, weight);
            rows.scatter(i, weight * m.residual[i], &mut right);
            let normal = m.form.normal(&sheet, i);
            let lever = normal.dot(&p.n);
            let b = lift.knots.basis(p.s, 0);
            for j in 0..4 {
                let value = lever * b.rows[0][j];
                rows.scatter(i, weight * value, &mut block[b.first + j]);
                own_right.push((lift.first + b.first + j, weight * value * m.residual[i]));
                for q in 0..4 {
                    let other = lever * b.rows[0][q];
                    own.push((lift.first + b.first + j, lift.first + b.first + q, weight * value * other));
                }
            }
        }
        coupling.extend(block.into_iter().enumerate().map(|(j, c)| (lift.first + j, c)));
    }
    Linear { rows, base, right, coupling, own, own_right }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::lsq;
    use crate::torse::form::{DualTorse, PrimalTorse};

    const RADIUS: f64 = 500.0;

    /// Point of the sphere with longitude a and latitude b; also its normal.
    fn radial(a: f64, b: f64) -> Vec3 {
        Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin())
    }

    /// The cone tangent to the sphere along a parallel.
    fn tangent_cone(b: f64) -> Torse {
        let angles: Vec<f64> = (0..=200).map(|i| -0.1 + 1.2 * f64::from(i) / 200.0).collect();
        let planes: Vec<[f64; 4]> = angles.iter().map(|&a| radial(a, b)).map(|n| [n.x, n.y, n.z, RADIUS]).collect();
        let knots = Knots::uniform(3, 20, angles[0], angles[200]).expect("knots");
        Torse::Dual(DualTorse { planes: lsq::fit(&planes, &angles, &knots).expect("planes").curve })
    }

    fn zone(b0: f64, b1: f64) -> Vec<Sample> {
        let at = |i: u32| radial(f64::from(i / 15) / 24.0, b0 + (b1 - b0) * f64::from(i % 15) / 14.0);
        (0..375).map(at).map(|n| Sample { x: n * RADIUS, n, weight: 1.0 }).collect()
    }

    /// A wide and a narrow zone of a sphere: tangent cones are apart by the difference of their sagittas; strips that
    /// agree are not, and the wide one is off by about half its sagitta, as it is alone.
    #[test]
    fn zones_of_unequal_width_agree() {
        let levels = [0.0, 0.12, 0.2];
        let cones = [tangent_cone(0.06), tangent_cone(0.16)];
        let samples = [zone(levels[0], levels[1]), zone(levels[1], levels[2])];
        let sagitta = RADIUS * (1.0 - 0.06_f64.cos());
        let points = (0..=100).map(|i| f64::from(i) / 100.0).map(|a| {
            let n = radial(a, levels[1]);
            LinePoint { s: RADIUS * levels[1].cos() * a, x: n * RADIUS, n }
        });
        let lines = [Line { strips: [0, 1], points: points.collect() }];
        let strips: Vec<Agreeing> =
            cones.iter().zip(&samples).map(|(torse, samples)| Agreeing { torse, samples, firmness: 1.0 }).collect();
        let options = ConsensusOptions { spans: 24, ..ConsensusOptions::new(sagitta) };
        let (agreed, lines) = consensus(&strips, &lines, &options).expect("agreement");
        let error = agreed.iter().map(|a| a.as_ref().expect("a strip").error).fold(0.0, f64::max);
        assert!(lines[0].gap < 2e-3 * sagitta, "{}", lines[0].gap / sagitta);
        assert!(error < 0.56 * sagitta, "{}", error / sagitta);
        // The surface is convex: seams lie outside of it.
        assert!(lines[0].offset_at(200.0) > 0.1 * sagitta, "{}", lines[0].offset_at(200.0));
    }

    /// A strip whose samples ripple follows them; a firm one does much less.
    #[test]
    fn firm_strips_keep_their_ways() {
        let cones = [tangent_cone(0.06), tangent_cone(0.16)];
        let sagitta = RADIUS * (1.0 - 0.06_f64.cos());
        let ripple = |s: Sample| Sample { x: s.x + s.n * (0.1 * sagitta * (25.0 * s.n.y).sin()), ..s };
        let samples = [zone(0.0, 0.12).into_iter().map(ripple).collect(), zone(0.12, 0.2)];
        let points = (0..=100).map(|i| f64::from(i) / 100.0).map(|a| {
            let n = radial(a, 0.12);
            LinePoint { s: RADIUS * 0.12_f64.cos() * a, x: n * RADIUS, n }
        });
        let lines = [Line { strips: [0, 1], points: points.collect() }];
        let roughness = |firmness: f64| {
            let strip = |k: usize| Agreeing {
                torse: &cones[k],
                samples: &samples[k],
                firmness: if k == 0 { firmness } else { 1.0 },
            };
            let options = ConsensusOptions { spans: 24, ..ConsensusOptions::new(sagitta) };
            let (agreed, _) = consensus(&[0, 1].map(strip), &lines, &options).expect("agreement");
            let Torse::Dual(d) = &agreed[0].as_ref().expect("a strip").torse else { panic!("planes") };
            let third = |w: &[[f64; 4]]| w[3][3] - 3.0 * w[2][3] + 3.0 * w[1][3] - w[0][3];
            d.planes.control.windows(4).map(|w| third(w).abs()).sum::<f64>()
        };
        let (usual, firm) = (roughness(1.0), roughness(100.0));
        assert!(firm < 0.5 * usual, "{firm} {usual}");
    }

    /// Strips of a corrugated bowl, which bend to both sides: no envelope of planes does.
    #[test]
    fn strips_with_inflections_agree() {
        const LENGTH: f64 = 60.0;
        let height = |x: f64, y: f64| 15.0 * (x / LENGTH).sin() + y * y / (2.0 * RADIUS);
        let normal = |x: f64, y: f64| Vec3::new(-0.25 * (x / LENGTH).cos(), -y / RADIUS, 1.0).normalize();
        let at = |x: f64, y: f64| (Vec3::new(x, y, height(x, y)), normal(x, y));
        // Tangent along y = b.
        let cylinder = |b: f64| {
            let t: Vec<f64> = (0..=240).map(|i| -20.0 + f64::from(i)).collect();
            let profile: Vec<[f64; 2]> = t.iter().map(|&t| [height(t, 0.0) - b * b / (2.0 * RADIUS), 0.0]).collect();
            let knots = Knots::uniform(3, 24, t[0], t[240]).expect("knots");
            let profile = lsq::fit(&profile, &t, &knots).expect("a profile").curve;
            Torse::Primal(PrimalTorse::new(Frame::world(), profile, b / RADIUS))
        };
        let zone = |y0: f64, y1: f64| -> Vec<Sample> {
            let of = |i: u32| at(200.0 * f64::from(i / 11) / 40.0, y0 + (y1 - y0) * f64::from(i % 11) / 10.0);
            (0..451).map(of).map(|(x, n)| Sample { x, n, weight: 1.0 }).collect()
        };
        let torses = [cylinder(30.0), cylinder(80.0)];
        let samples = [zone(0.0, 60.0), zone(60.0, 100.0)];
        let sagitta = 30.0 * 30.0 / (2.0 * RADIUS);
        let points = (0..=100).map(|i| at(2.0 * f64::from(i), 60.0));
        let points = points.map(|(x, n)| LinePoint { s: x.x, x, n }).collect();
        let strips: Vec<Agreeing> =
            torses.iter().zip(&samples).map(|(torse, samples)| Agreeing { torse, samples, firmness: 1.0 }).collect();
        let lines = [Line { strips: [0, 1], points }];
        let (agreed, lines) = consensus(&strips, &lines, &ConsensusOptions::new(sagitta)).expect("agreement");
        assert!(lines[0].gap < 0.01 * sagitta, "{}", lines[0].gap / sagitta);
        for a in &agreed {
            let a = a.as_ref().expect("a strip");
            assert!(matches!(a.torse, Torse::Primal(_)) && a.error < 0.7 * sagitta, "{}", a.error / sagitta);
        }
    }

    #[test]
    fn strips_without_sheet_are_left_out() {
        let cone = tangent_cone(0.06);
        // A quarter turn further on, far beyond the cone's ends, points have no foot.
        let turned = |s: Sample| Sample { x: Vec3::new(-s.x.y, s.x.x, s.x.z), ..s };
        let (good, bad) = (zone(0.0, 0.12), zone(0.12, 0.2).into_iter().map(turned).collect::<Vec<_>>());
        let points = (0..=20).map(|i| radial(f64::from(i) / 20.0, 0.12));
        let points = points.enumerate().map(|(i, n)| LinePoint { s: i as f64, x: n * RADIUS, n }).collect();
        let strips = [&good, &bad].map(|samples| Agreeing { torse: &cone, samples, firmness: 1.0 });
        let lines = [Line { strips: [0, 1], points }];
        let (agreed, lines) = consensus(&strips, &lines, &ConsensusOptions::new(1.0)).expect("a result");
        assert!(agreed[0].is_some() && agreed[1].is_none() && lines[0].gap.is_infinite());
    }
}
