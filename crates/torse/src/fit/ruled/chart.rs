//! Coordinates of a region in which the coming rulings are straight: one function that is constant along the straightest
//! directions, one whose level lines are strip boundaries, and the way back to the parameters of the face.
//!
//! *Method* \[W15, 2C, figure 2.9\]: rulings along asymptotic curves, strip boundaries transversal to them. Departure:
//! the curves are not traced one by one; a spline whose level lines they are is found by least squares, which works on
//! trimmed regions and goes on beyond their border.

use super::directions::Sample;
use super::tensor_fit::{slope_changes, tensor_fit, Target};
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::patchwork::foot_map::FootMap;
use crate::spline::field::Field;
use crate::spline::knots::Knots;

/// Spans of level functions in either parameter.
const SPANS: usize = 16;
/// Room around the region, share of its box.
const ROOM: f64 = 0.05;
/// Weight of the gradient's length against its direction.
const PACE: f64 = 0.05;
/// Rounds in which the length wanted becomes the length found.
const ROUNDS: usize = 8;
/// Weight of changes of slope, which only decide what samples leave open.
const FAIR: f64 = 1e-4;
/// Spans of the way back.
const BACK: [usize; 2] = [20, 14];
/// Weight of its fairness.
const BACK_FAIR: f64 = 1e-7;

/// What strip boundaries follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Boundaries {
    /// Lines of constant u.
    AlongV,
    /// Lines of constant v.
    AlongU,
    /// Curves square to the rulings.
    Square,
}

/// What is constant along rulings.
#[derive(Clone, Debug)]
pub(crate) enum Across {
    /// A function, about the distance across rulings in mm.
    Level(Field),
    /// The height over a plane with this unit normal, mm: rulings are parallel to the plane.
    Height(Vec3),
}

impl Across {
    /// Value at parameters and their place in space.
    fn value(&self, uv: [f64; 2], place: &Vec3) -> f64 {
        match self {
            Self::Level(field) => field.value(uv),
            Self::Height(m) => m.dot(place),
        }
    }

    /// Its slopes along and across the straightest direction.
    fn slopes(&self, s: &Sample) -> [f64; 2] {
        match self {
            Self::Level(field) => slopes(field, s),
            Self::Height(m) => s.axes.map(|a| m.dot(&a)),
        }
    }
}

/// Coordinates of a region.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Constant along rulings.
    pub across: Across,
    /// Level lines are strip boundaries; grows by at most 1 per mm along rulings.
    pub along: Field,
    /// Parameters (u, v) at given values of both.
    pub places: FootMap,
    /// Greatest angle between level lines of `across` and the straightest direction, rad, at the samples that count.
    pub angle_estimate: f64,
    /// Least sine of the angle between rulings and strip boundaries.
    pub least_angle_sine: f64,
}

/// The length of a gradient along the two axes of a sample.
fn slopes(field: &Field, s: &Sample) -> [f64; 2] {
    let [_, x, y] = field.jet(s.uv[0], s.uv[1]);
    [s.along, s.across].map(|d| x * d[0] + y * d[1])
}

/// The box of samples with some room.
fn room(samples: &[Sample]) -> [f64; 4] {
    let b = samples.iter().fold([f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY], |b, s| {
        [b[0].min(s.uv[0]), b[1].max(s.uv[0]), b[2].min(s.uv[1]), b[3].max(s.uv[1])]
    });
    let (x, y) = (ROOM * (b[1] - b[0]), ROOM * (b[3] - b[2]));
    [b[0] - x, b[1] + x, b[2] - y, b[3] + y]
}

/// What is wanted of a sample's gradient: its lengths along and across the ruling, each with a weight.
type Wanted = [(f64, f64); 2];

/// A function whose gradient at samples, numbered, has the lengths wanted.
fn level(samples: &[Sample], wanted: impl Fn(usize) -> Wanted) -> Option<Field> {
    let mut field = Field::bicubic(room(samples), SPANS).ok()?;
    let (n, row) = (field.knots_u.control_count(), field.knots_v.control_count());
    let size = n * row;
    let mut rows = Rows::new(size, 3 * row + 4);
    let mut weights = Vec::new();
    let mut right = vec![0.0; size];
    let mut one = |entries: &[(usize, f64)], value: f64, weight: f64| {
        let (start, line) = rows.push(entries.iter().map(|e| e.0).min().unwrap_or(0));
        entries.iter().for_each(|&(k, x)| line[k - start] += x);
        weights.push(weight);
        entries.iter().for_each(|&(k, x)| right[k] += weight * x * value);
    };
    let count = samples.len().max(1) as f64;
    for (k, s) in samples.iter().enumerate() {
        let basis = field.basis(s.uv[0], s.uv[1]);
        for (d, (value, weight)) in [s.along, s.across].iter().zip(wanted(k)) {
            let entries: Vec<(usize, f64)> = basis.iter().map(|b| (b.0, b.2 * d[0] + b.3 * d[1])).collect();
            one(&entries, value, s.weight * weight * weight / count);
        }
    }
    // Coefficients are lengths, slopes numbers: bends are measured against the size of a cell.
    let size_mm = crate::geom::BBox::of(samples.iter().map(|s| &s.place)).diagonal() / SPANS as f64;
    let fair = (FAIR / size_mm.max(f64::MIN_POSITIVE)).powi(2) / size as f64;
    for (knots, step, lines, next) in [(&field.knots_u, row, row, 1), (&field.knots_v, 1, n, row)] {
        for bend in slope_changes(knots) {
            for l in 0..lines {
                one(&bend.map(|(k, x)| (k * step + l * next, x)), 0.0, fair);
            }
        }
    }
    // The constant is free: the first sample has the value 0.
    let first: Vec<(usize, f64)> =
        samples.first().map(|s| field.basis(s.uv[0], s.uv[1]).iter().map(|b| (b.0, b.1)).collect())?;
    one(&first, 0.0, size_mm.max(f64::MIN_POSITIVE).powi(-2));
    let mut matrix = BandMatrix::zeros(size, 3 * row + 4);
    for (i, w) in weights.iter().enumerate() {
        matrix.add_row(&rows, i, *w);
    }
    if !matrix.factorise() {
        return None;
    }
    matrix.solve(&mut right);
    right.iter().all(|x| x.is_finite()).then(|| field.coefficients = right)?;
    Some(field)
}

/// The function that is constant along rulings.
pub fn across(samples: &[Sample]) -> Option<Field> {
    let mut pace = vec![1.0; samples.len()];
    let mut field = None;
    for _ in 0..ROUNDS {
        let found = level(samples, |k| [(0.0, 1.0), (pace[k], PACE)])?;
        pace.iter_mut().zip(samples).for_each(|(p, s)| *p = slopes(&found, s)[1]);
        field = Some(found);
    }
    field
}

/// A function whose level lines are strip boundaries, not yet to scale.
fn boundary_function(samples: &[Sample], boundaries: Boundaries) -> Option<Field> {
    let linear = |a: f64, b: f64| {
        let mut field = Field::bicubic(room(samples), 1).ok()?;
        field.set_linear(a, b);
        Some(field)
    };
    match boundaries {
        Boundaries::AlongV => linear(1.0, 0.0),
        Boundaries::AlongU => linear(0.0, 1.0),
        Boundaries::Square => level(samples, |_| [(1.0, 1.0), (0.0, 0.3)]),
    }
}

impl Chart {
    /// Coordinates from a function that is constant along rulings, with strip boundaries of one sort; `None` where they
    /// are none: where either function stands still or both have the same level lines.
    pub fn new(samples: &[Sample], across: Across, boundaries: Boundaries) -> Option<Self> {
        let along = boundary_function(samples, boundaries)?;
        let (along, least_angle_sine) = to_scale(samples, along)?;
        Self::of(samples, across, along, least_angle_sine)
    }

    /// Coordinates with rulings parallel to a plane: heights over it, and strip boundaries of another chart.
    pub fn parallel(&self, samples: &[Sample], normal: Vec3) -> Option<Self> {
        let turned = samples.iter().map(|s| normal.dot(&s.axes[1])).sum::<f64>();
        let across = Across::Height(if turned < 0.0 { -normal } else { normal });
        Self::of(samples, across, self.along.clone(), self.least_angle_sine)
    }

    /// Both coordinates at parameters and their place in space.
    pub fn coordinates(&self, uv: [f64; 2], place: &Vec3) -> [f64; 2] {
        [self.across.value(uv, place), self.along.value(uv)]
    }

    fn of(samples: &[Sample], across: Across, along: Field, least_angle_sine: f64) -> Option<Self> {
        let mut angle_estimate = 0.0f64;
        for s in samples {
            let [d, n] = across.slopes(s);
            if n <= 0.0 {
                return None;
            }
            if s.weight >= 1.0 {
                angle_estimate = angle_estimate.max(d.abs().atan2(n));
            }
        }
        let a: Vec<f64> = samples.iter().map(|s| across.value(s.uv, &s.place)).collect();
        let b: Vec<f64> = samples.iter().map(|s| along.value(s.uv)).collect();
        let knots = |x: &[f64], spans: usize| {
            let (lo, hi) = range(x);
            let pad = ROOM * (hi - lo);
            Knots::uniform(3, spans, lo - pad, hi + pad).ok()
        };
        let (knots_s, knots_t) = (knots(&a, BACK[0])?, knots(&b, BACK[1])?);
        let targets: Vec<Target<2>> = samples
            .iter()
            .zip(a.iter().zip(&b))
            .map(|(s, (a, b))| Target { at: [*a, *b], value: s.uv, weight: 1.0 })
            .collect();
        let control = tensor_fit([&knots_s, &knots_t], &targets, BACK_FAIR)?;
        let places = FootMap { knots_s, knots_t, control };
        Some(Self { across, along, places, angle_estimate, least_angle_sine })
    }

    /// Extent of strip boundaries: least and greatest value of `along` at samples.
    pub fn reach(&self, samples: &[Sample]) -> (f64, f64) {
        range(&samples.iter().map(|s| self.along.value(s.uv)).collect::<Vec<_>>())
    }
}

/// The function of strip boundaries growing along rulings, by at most 1 per mm, and the least sine of the angle between
/// both.
fn to_scale(samples: &[Sample], mut along: Field) -> Option<(Field, f64)> {
    let sign = slopes(&along, samples.first()?)[0].signum();
    let mut most = 0.0f64;
    let mut least_angle_sine = f64::INFINITY;
    for s in samples {
        let [d, n] = slopes(&along, s);
        most = most.max(d.abs());
        least_angle_sine = least_angle_sine.min(sign * d / d.hypot(n).max(f64::MIN_POSITIVE));
    }
    if !(least_angle_sine > 0.0 && most > 0.0) {
        return None;
    }
    along.coefficients.iter_mut().for_each(|c| *c *= sign / most);
    Some((along, least_angle_sine))
}

/// Least and greatest of numbers.
pub(super) fn range(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(*x), hi.max(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::ruled::directions::{samples, Family};
    use crate::spline::surface::SurfaceJet;

    /// The inner part of a torus with the radii 3 and 1.
    fn torus(u: f64, v: f64) -> SurfaceJet {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        let e = Vec3::new(cu, su, 0.0);
        let f = Vec3::new(-su, cu, 0.0);
        let r = 3.0 - cv;
        SurfaceJet {
            p: e * r + Vec3::z() * sv,
            du: f * r,
            dv: e * sv + Vec3::z() * cv,
            duu: -e * r,
            duv: f * sv,
            dvv: e * cv - Vec3::z() * sv,
        }
    }

    #[test]
    fn level_lines_follow_the_asymptotic_curves_of_a_torus() {
        let n = 24usize;
        let at = |i: usize, j: usize| [1.5 * i as f64 / n as f64, 1.4 * j as f64 / n as f64 - 0.7];
        let places: Vec<_> =
            (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).map(|uv| (uv, torus(uv[0], uv[1]))).collect();
        let index = |i: usize, j: usize| i * (n + 1) + j;
        let mut edges = Vec::new();
        for i in 0..=n {
            for j in 0..n {
                edges.extend([[index(i, j), index(i, j + 1)], [index(j, i), index(j + 1, i)]]);
            }
        }
        let s = samples(&places, &edges, Family::Left).expect("samples");
        let a = across(&s).expect("a function");
        for boundaries in [Boundaries::AlongU, Boundaries::Square] {
            let chart = Chart::new(&s, Across::Level(a.clone()), boundaries).expect("a chart");
            assert!(chart.angle_estimate < 2e-3, "{}", chart.angle_estimate);
            assert!(chart.least_angle_sine > 0.3);
            for s in &s {
                let [x, y] = chart.coordinates(s.uv, &s.place);
                let back = chart.places.jet(x, y).p;
                assert!((back[0] - s.uv[0]).hypot(back[1] - s.uv[1]) < 2e-3);
            }
        }
    }
}
