//! All strips of a face together: connecting developables between seams, and offsets of the seams that make the largest
//! distance smallest.
//!
//! *Method.* First variation (\[SE06\] carried on): lifting the seams at the ends of a ruling by `da` and `db` along
//! the normal changes the signed distance of a surface point at the fraction λ of the ruling by `−(1 − λ) da − λ db`,
//! and nothing else to first order. So the offsets of all seams enter linearly; Lawson's weights turn least squares
//! into the smallest largest distance. The best state is kept, not the last one.
//!
//! *Not guaranteed*: that the linear step helps (then the start is kept); distances are sampled.

use super::connecting::{connecting, refit, ConnectingRuling};
use super::feet::feet;
use super::seam::{Seam, DEGREE};
use crate::fit::near::power_form::Sheet;
use crate::fit::near::samples::{thin, Sample};
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
use rayon::prelude::*;

/// A strip between two seams.
#[derive(Clone, Debug)]
pub(crate) struct StripBetween {
    /// Index of the seam at lower levels.
    pub lower: usize,
    /// Index of the seam at higher levels.
    pub upper: usize,
    /// Points of the surface that the strip is for.
    pub samples: Vec<Sample>,
}

/// Knobs of [`network`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NetworkOptions {
    /// Wanted distance of the surface from the strips, mm.
    pub tolerance: f64,
    /// Wanted distance of the seams from the strips' dual splines, mm.
    pub seam_tolerance: f64,
    /// Joint steps at most; 8.
    pub rounds: usize,
    /// Largest number of spans of a strip's dual spline; 480.
    pub max_spans: usize,
}

impl NetworkOptions {
    /// The defaults with tolerances in mm.
    pub fn new(tolerance: f64, seam_tolerance: f64) -> Self {
        Self { tolerance, seam_tolerance, rounds: 8, max_spans: 480 }
    }
}

/// A strip that connects its seams.
#[derive(Clone, Debug)]
pub(crate) struct Laid {
    /// The strip as a dual spline.
    pub torse: Torse,
    /// Largest distance of a sample, mm.
    pub error: f64,
    /// Largest distance (mm) between the seams and the dual spline, sampled between the rulings of the fit.
    pub seam_distance: f64,
    /// Largest twist of a computed ruling, rad.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests hold the rulings to it"))]
    pub twist: f64,
}

/// Spans of dual splines while offsets are sought.
const DRAFT_SPANS: usize = 60;
/// Rulings per span of a dual spline.
const PER_SPAN: usize = 4;
/// Samples of a strip that take part in a joint step.
const SAMPLES: usize = 420;
/// Worst samples of a strip that take part besides.
const WORST: usize = 60;
/// Joint steps are made while some strip exceeds this share of the tolerance.
const KEEN: f64 = 0.88;
/// Steps of Lawson's iteration.
const LAWSON: usize = 40;
/// Joint steps in a row that may fail, each with half the trust of the one before.
const PATIENCE: usize = 3;
/// Change of an offset in one step, share of the tolerance, at most.
const TRUST: f64 = 0.6;
/// Weights of second and first differences of the changes, against rows of weight one.
const SMOOTH: (f64, f64) = (0.02, 0.002);
/// Share of the used range of rulings by which the final spline reaches beyond it.
const MARGIN: f64 = 0.05;

/// A sample of a strip: signed distance, and where its ruling ends on both seams.
struct Row {
    distance: f64,
    u: f64,
    v: f64,
    fraction: f64,
}

struct Draft {
    torse: Torse,
    rulings: Vec<ConnectingRuling>,
    parameters: Vec<f64>,
    rows: Vec<Row>,
    error: f64,
}

/// Lays strips between seams, and moves the seams' offsets so that the largest distance of all strips gets small.
/// `None` for strips that do not exist: their seams have no regular connecting developable over all their samples.
pub(crate) fn network(seams: &mut [Seam], strips: &[StripBetween], options: &NetworkOptions) -> Vec<Option<Laid>> {
    let mut best = drafts(seams, strips);
    let mut trust = TRUST;
    let mut failures = 0;
    let few: Vec<Vec<usize>> = strips.iter().map(|s| thin(&s.samples, SAMPLES)).collect();
    for _ in 0..options.rounds {
        let (missing, error) = score(&best);
        if error <= KEEN * options.tolerance || 2 * missing > strips.len() {
            break;
        }
        let Some(change) = step(seams, strips, &few, &best, options.tolerance, trust) else { break };
        let before: Vec<Vec<f64>> = seams.iter().map(|s| s.offset.clone()).collect();
        for (s, c) in seams.iter_mut().zip(change.chunks(change.len() / before.len())) {
            s.offset.iter_mut().zip(c).for_each(|(a, d)| *a += d);
        }
        let next = drafts(seams, strips);
        if score(&next) < score(&best) {
            best = next;
            failures = 0;
        } else {
            seams.iter_mut().zip(before).for_each(|(s, o)| s.offset = o);
            trust *= 0.5;
            failures += 1;
            if failures == PATIENCE {
                break;
            }
        }
    }
    let curves: Vec<Option<Curve<3>>> = seams.iter().map(Seam::curve).collect();
    let last: Vec<_> = strips.iter().zip(&best).collect();
    last.into_par_iter()
        .map(|(s, d)| {
            let (a, b) = (curves[s.lower].as_ref()?, curves[s.upper].as_ref()?);
            laid(a, b, d.as_ref()?, s, options)
        })
        .collect()
}

/// Number of strips that do not exist, and the largest distance of the others.
fn score(drafts: &[Option<Draft>]) -> (usize, f64) {
    let missing = drafts.iter().filter(|d| d.is_none()).count();
    (missing, drafts.iter().flatten().map(|d| d.error).fold(0.0, f64::max))
}

fn drafts(seams: &[Seam], strips: &[StripBetween]) -> Vec<Option<Draft>> {
    let curves: Vec<Option<Curve<3>>> = seams.par_iter().map(Seam::curve).collect();
    strips
        .par_iter()
        .map(|s| {
            let (a, b) = (curves[s.lower].as_ref()?, curves[s.upper].as_ref()?);
            let base = &seams[s.lower].base;
            let u0 = 0.5 * (base.inside.0 + base.inside.1);
            let from = base.near(u0);
            let rulings = connecting(a, b, from.s, &from.ruling, &from.n, PER_SPAN * DRAFT_SPANS + 1)?;
            let (torse, parameters) = refit(&rulings, DRAFT_SPANS)?;
            let torse = Torse::Dual(torse);
            let rows = rows(&torse, &rulings, &parameters, &s.samples)?;
            let error = rows.iter().map(|r| r.distance.abs()).fold(0.0, f64::max);
            Some(Draft { torse, rulings, parameters, rows, error })
        })
        .collect()
}

/// Distances of all samples; `None` if one has no regular foot on the strip.
fn rows(torse: &Torse, rulings: &[ConnectingRuling], parameters: &[f64], samples: &[Sample]) -> Option<Vec<Row>> {
    let sheet = Sheet::of(torse)?;
    let guesses = sheet.guesses();
    let points: Vec<Vec3> = samples.iter().map(|s| sheet.local(&s.x)).collect();
    let first: Vec<f64> = points.iter().map(|q| guesses.guess(q)).collect();
    let found = feet(&sheet, &points, &first, sheet.domain());
    samples
        .iter()
        .zip(points.iter().zip(found))
        .map(|(s, (q, t))| {
            let t = t?;
            let d = sheet.distance(q, t).0;
            if !d.is_finite() {
                return None;
            }
            let k = parameters.partition_point(|&p| p < t).clamp(1, parameters.len() - 1);
            let l = ((t - parameters[k - 1]) / (parameters[k] - parameters[k - 1])).clamp(0.0, 1.0);
            let (p, r) = (&rulings[k - 1], &rulings[k]);
            let (a, b) = (p.a + (r.a - p.a) * l, p.b + (r.b - p.b) * l);
            let along = b - a;
            // The distance is counted along the rulings' normal.
            let distance = if sheet.jet(t).n.dot(&p.n) < 0.0 { -d } else { d };
            Some(Row {
                distance,
                u: p.u + (r.u - p.u) * l,
                v: p.v + (r.v - p.v) * l,
                fraction: (s.x - a).dot(&along) / along.norm_squared(),
            })
        })
        .collect()
}

/// Changes of all offsets that make the largest distance smallest, to first order.
#[expect(clippy::too_many_lines, reason = "one linear system, block by block")]
fn step(
    seams: &[Seam],
    strips: &[StripBetween],
    few: &[Vec<usize>],
    drafts: &[Option<Draft>],
    tolerance: f64,
    trust: f64,
) -> Option<Vec<f64>> {
    let per = seams.first()?.offset.len();
    let n = per * seams.len();
    let reach = strips.iter().map(|s| s.lower.abs_diff(s.upper)).max()?;
    let width = ((reach + 1) * per).min(n);
    let mut rows = Rows::new(n, width);
    let mut target = Vec::new();
    for ((s, d), few) in strips.iter().zip(drafts).zip(few) {
        let Some(d) = d else { continue };
        // Those spread evenly and the worst.
        let mut worst: Vec<usize> = (0..d.rows.len()).collect();
        worst.sort_by(|&i, &j| d.rows[j].distance.abs().total_cmp(&d.rows[i].distance.abs()));
        for r in few.iter().chain(worst.iter().take(WORST)).map(|&i| &d.rows[i]) {
            let first = (s.lower.min(s.upper) * per).min(n - width);
            let row = rows.push(first).1;
            for (seam, at, share) in [(s.lower, r.u, 1.0 - r.fraction), (s.upper, r.v, r.fraction)] {
                let b = seams[seam].knots.basis(at, 0);
                for j in 0..=DEGREE {
                    row[seam * per + b.first + j - first] += share * b.rows[0][j];
                }
            }
            target.push(r.distance / tolerance);
        }
    }
    let count = target.len();
    if count < 2 * seams.len() {
        return None;
    }
    let mut smooth = Rows::new(n, width);
    let scale = (count as f64 / n as f64).sqrt();
    let mut weights = Vec::new();
    for k in 0..seams.len() {
        for i in 0..per {
            for (stencil, weight) in
                [(&[1.0, -2.0, 1.0][..], SMOOTH.0), (&[-1.0, 1.0][..], SMOOTH.1), (&[1.0][..], SMOOTH.1)]
            {
                if i + stencil.len() > per {
                    continue;
                }
                let first = (k * per).min(n - width);
                let row = smooth.push(first).1;
                for (j, c) in stencil.iter().enumerate() {
                    row[k * per + i + j - first] = *c;
                }
                weights.push((weight * scale).powi(2));
            }
        }
    }
    let mut w = vec![1.0; count];
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..LAWSON {
        let mut matrix = BandMatrix::zeros(n, width);
        let mut x = vec![0.0; n];
        for i in 0..count {
            matrix.add_row(&rows, i, w[i]);
            rows.scatter(i, w[i] * target[i], &mut x);
        }
        for (i, weight) in weights.iter().enumerate() {
            matrix.add_row(&smooth, i, *weight);
        }
        if !matrix.factorise() {
            break;
        }
        matrix.solve(&mut x);
        let residual: Vec<f64> = (0..count).map(|i| (target[i] - rows.dot(i, &x)).abs()).collect();
        let largest = residual.iter().copied().fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            break;
        }
        if best.as_ref().is_none_or(|b| largest < b.0) {
            best = Some((largest, x));
        }
        let mut total = 0.0;
        for (w, r) in w.iter_mut().zip(&residual) {
            *w *= 0.05 + r / largest;
            total += *w;
        }
        let mean = total / count as f64;
        w.iter_mut().for_each(|w| *w /= mean);
    }
    let (_, mut x) = best?;
    // Coefficients beyond the region are hardly determined and must not hold back the others.
    x.iter_mut().for_each(|c| *c = c.clamp(-trust, trust) * tolerance);
    Some(x)
}

/// The strip on the rulings that it needs, with as many spans as its seams ask for.
fn laid(
    lower: &Curve<3>,
    upper: &Curve<3>,
    draft: &Draft,
    strip: &StripBetween,
    options: &NetworkOptions,
) -> Option<Laid> {
    let (mut u0, mut u1) = (f64::INFINITY, f64::NEG_INFINITY);
    // All samples, not the few that steered.
    for r in rows(&draft.torse, &draft.rulings, &draft.parameters, &strip.samples)? {
        u0 = u0.min(r.u);
        u1 = u1.max(r.u);
    }
    let (a, b) = lower.domain();
    let margin = MARGIN * (u1 - u0);
    let (u0, u1) = ((u0 - margin).max(a), (u1 + margin).min(b));
    let middle =
        draft.rulings.iter().min_by(|x, y| (x.u - 0.5 * (u0 + u1)).abs().total_cmp(&(y.u - 0.5 * (u0 + u1)).abs()))?;
    let mut best: Option<Laid> = None;
    let mut spans = DRAFT_SPANS;
    while spans <= options.max_spans.max(DRAFT_SPANS) {
        let count = (PER_SPAN as f64 * spans as f64 * (b - a) / (u1 - u0)).ceil() as usize + 1;
        let direction = (middle.b - middle.a).normalize();
        let all = connecting(lower, upper, middle.u, &direction, &middle.n, count)?;
        let used: Vec<ConnectingRuling> = all.into_iter().filter(|r| r.u >= u0 && r.u <= u1).collect();
        let (torse, parameters) = refit(&used, spans)?;
        let torse = Torse::Dual(torse);
        let seam_distance = seam_distance(&torse, &used, &parameters, lower, upper)?;
        let better = best.as_ref().is_none_or(|b| seam_distance < b.seam_distance);
        if better {
            let (error, _) = crate::fit::near::samples::error(&torse, &strip.samples)?;
            let twist = used.iter().map(|r| r.twist).fold(0.0, f64::max);
            best = Some(Laid { torse, error, seam_distance, twist });
        }
        if !better || seam_distance <= options.seam_tolerance {
            break;
        }
        spans *= 2;
    }
    best
}

/// Largest distance of both seams from a strip, between its rulings.
fn seam_distance(
    torse: &Torse,
    rulings: &[ConnectingRuling],
    parameters: &[f64],
    lower: &Curve<3>,
    upper: &Curve<3>,
) -> Option<f64> {
    let sheet = Sheet::of(torse)?;
    let mut worst: f64 = 0.0;
    for (w, t) in rulings.windows(2).zip(parameters.windows(2)) {
        let guess = 0.5 * (t[0] + t[1]);
        for x in [lower.point(0.5 * (w[0].u + w[1].u)), upper.point(0.5 * (w[0].v + w[1].v))] {
            let q = sheet.local(&Vec3::from(x));
            let t = sheet.foot(&q, guess, sheet.domain())?;
            worst = worst.max(sheet.distance(&q, t).0.abs());
        }
    }
    Some(worst)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::fit::seams::base_line;
    use crate::geom::Frame;
    use crate::spline::field::Field;

    const RADIUS: f64 = 500.0;

    /// Zones of a sphere about the equator: seams between parallels, samples between them.
    fn zones(levels: &[f64], offset: f64) -> (Vec<Seam>, Vec<StripBetween>) {
        let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: RADIUS };
        let (surface, map) = sphere.to_spline((0.0, 1.0), (-0.6, 0.6)).expect("a spline");
        let ((u0, u1), (v0, v1)) = surface.domain();
        let mut field = Field::bicubic([u0, u1, v0, v1], 1).expect("a field");
        field.set_linear(0.0, 1.0);
        let middle = 0.5 * (u0 + u1);
        let seams = levels
            .iter()
            .map(|&b| {
                let length = 0.5 * RADIUS * b.cos();
                let line = base_line(&surface, &field, [middle, map[1].forward(b)], (length, length), [0.0; 2]);
                Seam::new(line.expect("a line"), |p| -p.curvature.signum() * offset).expect("a seam")
            })
            .collect();
        let strips = levels
            .windows(2)
            .enumerate()
            .map(|(k, w)| {
                let samples = (0..=400)
                    .map(|i| {
                        let (a, b) =
                            (0.2 + 0.6 * f64::from(i / 21) / 19.0, w[0] + (w[1] - w[0]) * f64::from(i % 21) / 20.0);
                        let n = Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin());
                        Sample { x: n * RADIUS, n, weight: 1.0 }
                    })
                    .collect();
                StripBetween { lower: k, upper: k + 1, samples }
            })
            .collect();
        (seams, strips)
    }

    /// A cone through both parallels lifted by half the sagitta is off by half the sagitta at edges and middle.
    #[test]
    fn offset_of_sphere_zones_is_half_the_sagitta() {
        let beta: f64 = 0.12;
        let half = RADIUS * (1.0 - (0.5 * beta).cos()) / 2.0;
        let (mut seams, strips) = zones(&[-beta, 0.0, beta, 2.0 * beta], half);
        let options = NetworkOptions { rounds: 0, ..NetworkOptions::new(half, 1e-3 * half) };
        for l in network(&mut seams, &strips, &options) {
            let l = l.expect("a strip");
            assert!((l.error - half).abs() < 0.02 * half, "{} {half}", l.error);
            assert!(l.twist < 1e-9 && l.seam_distance < 1e-3 * half);
        }
    }

    #[test]
    fn joint_steps_find_the_best_offsets_of_sphere_zones() {
        let beta: f64 = 0.12;
        let half = RADIUS * (1.0 - (0.5 * beta).cos()) / 2.0;
        let (mut seams, strips) = zones(&[-beta, 0.0, beta, 2.0 * beta], 0.4 * half);
        let worst = |laid: Vec<Option<Laid>>| laid.into_iter().map(|l| l.expect("a strip").error).fold(0.0, f64::max);
        let options = NetworkOptions::new(half, 1e-3 * half);
        let before = worst(network(&mut seams.clone(), &strips, &NetworkOptions { rounds: 0, ..options.clone() }));
        let after = worst(network(&mut seams, &strips, &options));
        assert!(before > 1.3 * half && after < 1.03 * half, "{before} {after} {half}");
    }

    /// First variation: distances change by `−(1 − λ) da − λ db`.
    #[test]
    fn distances_follow_the_first_variation() {
        let (seams, strips) = zones(&[0.0, 0.12], 0.4);
        let distances = |seams: &[Seam]| {
            drafts(seams, &strips)[0].as_ref().map(|d| d.rows.iter().map(|r| r.distance).collect::<Vec<_>>())
        };
        let before = drafts(&seams, &strips);
        let rows = &before[0].as_ref().expect("a strip").rows;
        let mut moved = seams.clone();
        let change = |s: f64| 1e-3 * (0.8 + (0.004 * s).sin());
        for (k, sign) in [(0, 1.0), (1, -0.6)] {
            let base = moved[k].base.clone();
            let old = seams[k].clone();
            moved[k] = Seam::new(base, |p| old.offset_at(p.s) + sign * change(p.s)).expect("a seam");
        }
        let after = distances(&moved).expect("a strip");
        for (r, d) in rows.iter().zip(after) {
            let (da, db) =
                (moved[0].offset_at(r.u) - seams[0].offset_at(r.u), moved[1].offset_at(r.v) - seams[1].offset_at(r.v));
            let expected = -(1.0 - r.fraction) * da - r.fraction * db;
            assert!((d - r.distance - expected).abs() < 1e-2 * 1e-3, "{} {expected}", d - r.distance);
        }
    }
}
