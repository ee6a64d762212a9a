//! Neighbouring ruled strips between boundary curves that they share, near a face: all boundary curves at once, by least
//! squares.
//!
//! *Method* \[W15, 2, 2C\]: unknown are the control points of the boundary curves. Rows: distances of samples from the
//! tangent planes at their feet, which are found anew in every round; the same rulings of neighbouring strips and their common
//! boundary in one plane, which makes the union smooth as a set; a little of the places where the curves
//! began, so that they do not slide; fairness.

use super::chart::{Across, Chart};
use super::tensor_fit::slope_changes;
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// What is asked for.
#[derive(Clone, Debug)]
pub(crate) struct SolveOptions {
    /// Values of `along` at the boundary curves, increasing.
    pub levels: Vec<f64>,
    /// Spans of the boundary curves.
    pub spans: usize,
    /// Places of the region that must be near the strips besides those on a grid: its border.
    pub border: Vec<[f64; 2]>,
    /// Weight of the rulings' lying in one plane: of half of what the next point of a ruling is off the last one continued.
    pub smooth: f64,
}

/// Boundary curves over common knots in the values of `across`: strip k lies between curves k and k + 1.
#[derive(Clone, Debug)]
pub struct Strips {
    /// The curves, mm.
    pub curves: Vec<Curve<3>>,
    /// Values of `along` there.
    pub levels: Vec<f64>,
    /// Greatest distance of samples from the face, mm.
    pub distance_estimate: f64,
}

/// Rounds of least squares.
const ROUNDS: usize = 4;
/// Samples per span of the curves, and shares of rulings.
const PER_SPAN: usize = 4;
/// See [`PER_SPAN`].
const SHARES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
/// Weight of the places where samples began, along the face.
const HOLD: f64 = 0.03;
/// Weight of changes of slope of the boundary curves.
const FAIR: f64 = 1e-3;
/// Weight of boundary curves beyond the region, and how far beyond the face, share of its parameters.
const BEYOND: f64 = 0.1;
/// See [`BEYOND`].
const NEAR: f64 = 0.08;
/// Steps towards a foot.
const FOOT_STEPS: usize = 8;
/// A foot is found when the step is below this share of the face's size.
const FOOT_FOUND: f64 = 1e-12;

/// Parameters of the foot of `x` on a surface near `guess`, by Newton's method.
pub fn foot(surface: &Surface, x: &Vec3, guess: [f64; 2]) -> [f64; 2] {
    let mut at = guess;
    for _ in 0..FOOT_STEPS {
        let j = surface.extended_jet(at[0], at[1]);
        let off = x - j.p;
        let g = [off.dot(&j.du), off.dot(&j.dv)];
        let (a, b, c) = (
            j.du.norm_squared() - off.dot(&j.duu),
            j.du.dot(&j.dv) - off.dot(&j.duv),
            j.dv.norm_squared() - off.dot(&j.dvv),
        );
        let det = a * c - b * b;
        let step = [(g[0] * c - g[1] * b) / det, (a * g[1] - b * g[0]) / det];
        if !step.iter().all(|s| s.is_finite()) || det <= 0.0 {
            return at;
        }
        at = [at[0] + step[0], at[1] + step[1]];
        let ((u0, u1), (v0, v1)) = surface.domain();
        if (step[0] / (u1 - u0)).abs().max((step[1] / (v1 - v0)).abs()) < FOOT_FOUND {
            break;
        }
    }
    at
}

/// A place on the strips that is compared with the face.
struct Probe {
    strip: usize,
    s: f64,
    t: f64,
    /// Foot on the face.
    uv: [f64; 2],
    /// Where the place began.
    start: Vec3,
    /// On a boundary curve: the direction in the face that leads off its level line.
    off_line: Option<Vec3>,
    /// Whether it belongs to the region; if not, only a boundary curve is held there.
    inside: bool,
}

/// Boundary curves near a face. `inside` tells whether parameters belong to the region; what lies beyond is continued
/// smoothly.
pub fn solve(
    surface: &Surface,
    chart: &Chart,
    inside: &dyn Fn([f64; 2]) -> bool,
    options: &SolveOptions,
) -> Option<Strips> {
    let (lo, hi) = chart.places.knots_s.domain();
    let knots = Knots::uniform(3, options.spans, lo, hi).ok()?;
    let levels = &options.levels;
    let ((u0, u1), (v0, v1)) = surface.domain();
    let near = |[u, v]: [f64; 2]| {
        let (x, y) = (NEAR * (u1 - u0), NEAR * (v1 - v0));
        u >= u0 - x && u <= u1 + x && v >= v0 - y && v <= v1 + y
    };
    let mut probes = Vec::new();
    let count = PER_SPAN * options.spans;
    for i in 0..=count {
        let s = lo + (hi - lo) * i as f64 / count as f64;
        for strip in 0..levels.len() - 1 {
            for t in SHARES {
                let b = levels[strip] + t * (levels[strip + 1] - levels[strip]);
                let places = chart.places.jet(s, b);
                let uv = places.p;
                let (inside, end) = (inside(uv), t == 0.0 || t == 1.0);
                if inside || (end && near(uv)) {
                    let j = surface.extended_jet(uv[0], uv[1]);
                    let line = j.du * places.ds[0] + j.dv * places.ds[1];
                    let off_line = j.normal().cross(&line).try_normalize(0.0).filter(|_| end);
                    probes.push(Probe { strip, s, t, uv, start: j.p, off_line, inside });
                }
            }
        }
    }
    for &uv in &options.border {
        let start = surface.extended_jet(uv[0], uv[1]).p;
        let [s, b] = chart.coordinates(uv, &start);
        if b >= levels[0] && b <= levels[levels.len() - 1] {
            let strip = levels.partition_point(|l| *l <= b).clamp(1, levels.len() - 1) - 1;
            let t = (b - levels[strip]) / (levels[strip + 1] - levels[strip]);
            probes.push(Probe { strip, s: s.clamp(lo, hi), t, uv, start, off_line: None, inside: true });
        }
    }
    if !probes.iter().any(|p| p.inside) {
        return None;
    }
    let height = match &chart.across {
        Across::Height(m) => Some(*m),
        Across::Level(_) => None,
    };
    let mut curves: Option<Vec<Curve<3>>> = None;
    for _ in 0..ROUNDS {
        if let Some(c) = &curves {
            for p in probes.iter_mut().filter(|p| p.inside) {
                let x = point(c, p.strip, p.s, p.t);
                p.uv = foot(surface, &x, p.uv);
            }
        }
        let asked = (levels.len(), options.smooth, height);
        curves = Some(round(surface, &knots, asked, (&probes, curves.as_deref()))?);
    }
    let mut curves = curves?;
    if let Some(m) = &height {
        curves.iter_mut().for_each(|c| at_heights(c, m));
    }
    let distance = |p: &Probe| {
        let x = point(&curves, p.strip, p.s, p.t);
        let uv = foot(surface, &x, p.uv);
        (surface.extended_jet(uv[0], uv[1]).p - x).norm()
    };
    let distance_estimate = probes.iter().filter(|p| p.inside).map(distance).fold(0.0, f64::max);
    Some(Strips { curves, levels: levels.clone(), distance_estimate })
}

/// A point of a strip.
pub(super) fn point(curves: &[Curve<3>], strip: usize, s: f64, t: f64) -> Vec3 {
    let [a, b] = [strip, strip + 1].map(|k| Vec3::from(curves[k].point(s)));
    a * (1.0 - t) + b * t
}

/// Moves control points so that the height of every point of a curve over the plane with this normal is its parameter:
/// those of the parameter itself are the Greville abscissae.
fn at_heights(curve: &mut Curve<3>, m: &Vec3) {
    let (p, values) = (curve.knots.degree(), curve.knots.values());
    for (i, c) in curve.control.iter_mut().enumerate() {
        let wanted = values[i + 1..=i + p].iter().sum::<f64>() / p as f64;
        *c = (Vec3::from(*c) + m * (wanted - m.dot(&Vec3::from(*c)))).into();
    }
}

/// The rows of one round, and their solution.
fn round(
    surface: &Surface,
    knots: &Knots,
    (curves, smooth, height): (usize, f64, Option<Vec3>),
    (probes, before): (&[Probe], Option<&[Curve<3>]>),
) -> Option<Vec<Curve<3>>> {
    let n = knots.control_count();
    let block = 3 * curves;
    let (size, width) = (n * block, (4 * block).min(n * block));
    let mut system = System { rows: Rows::new(size, width), weights: Vec::new(), right: vec![0.0; size], block };
    for p in probes {
        let j = surface.extended_jet(p.uv[0], p.uv[1]);
        let normal = j.normal().try_normalize(0.0)?;
        let basis = knots.basis(p.s, 0);
        let shares = [(p.strip, 1.0 - p.t), (p.strip + 1, p.t)];
        let b = (basis.first, &basis.rows[0][..4]);
        if !p.inside {
            system.row(b, &shares, &normal, normal.dot(&p.start), BEYOND * BEYOND);
            if let Some(axis) = &p.off_line {
                system.row(b, &shares, axis, axis.dot(&p.start), 1.0);
            }
            continue;
        }
        system.row(b, &shares, &normal, normal.dot(&j.p), 1.0);
        for axis in [j.du, j.dv] {
            let Some(axis) = axis.try_normalize(0.0) else { continue };
            system.row(b, &shares, &axis, axis.dot(&p.start), HOLD * HOLD);
        }
        // Boundary curves stay over their level lines; along rulings they could slide to no use.
        if let Some(axis) = &p.off_line {
            system.row(b, &shares, axis, axis.dot(&p.start), 1.0);
        }
        // A boundary between two strips: its ruling on either side in one plane with it, that of the strips where it is known.
        if p.t == 0.0 && p.strip > 0 {
            let third = [(p.strip - 1, 1.0), (p.strip, -2.0), (p.strip + 1, 1.0)];
            let plane = before.and_then(|c| common_normal(c, p.strip, p.s)).unwrap_or(normal);
            system.row(b, &third, &plane, 0.0, smooth * smooth * 0.25);
        }
        // Heights over the plane that rulings are parallel to.
        if let Some(m) = height {
            system.row(b, &[(p.strip, 1.0)], &m, p.s, 1.0);
            system.row(b, &[(p.strip + 1, 1.0)], &m, p.s, 1.0);
        }
    }
    let fair = FAIR * FAIR * probes.len() as f64 / (n * curves) as f64;
    for bend in slope_changes(knots) {
        let (first, x) = (bend[0].0, [bend[0].1, bend[1].1, bend[2].1]);
        for k in 0..curves {
            for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                system.row((first, &x), &[(k, 1.0)], &axis, 0.0, fair);
            }
        }
    }
    let solution = system.solve()?;
    let control =
        |k: usize| (0..n).map(|i| [0, 1, 2].map(|d: usize| solution[i * block + 3 * k + d])).collect::<Vec<[f64; 3]>>();
    Some((0..curves).map(|k| Curve { knots: knots.clone(), control: control(k) }).collect())
}

/// Normal of the plane of a boundary curve and the mean of the rulings on both sides.
fn common_normal(curves: &[Curve<3>], k: usize, s: f64) -> Option<Vec3> {
    let at = |k: usize| Vec3::from(curves[k].point(s));
    let along = Vec3::from(curves[k].jet(s)[1]);
    along.cross(&(at(k + 1) - at(k - 1))).try_normalize(0.0)
}

/// Linear equations for control points: index `3 (curves · i + k) + d`.
struct System {
    rows: Rows,
    weights: Vec<f64>,
    right: Vec<f64>,
    block: usize,
}

impl System {
    /// `axis · Σ N_i share_k P_ik = value`.
    fn row(&mut self, (first, basis): (usize, &[f64]), shares: &[(usize, f64)], axis: &Vec3, value: f64, weight: f64) {
        let (start, line) = self.rows.push(first * self.block);
        for (i, n) in basis.iter().enumerate() {
            for &(k, share) in shares {
                for d in 0..3 {
                    let at = (first + i) * self.block + 3 * k + d;
                    let x = n * share * axis[d];
                    line[at - start] += x;
                    self.right[at] += weight * x * value;
                }
            }
        }
        self.weights.push(weight);
    }

    fn solve(mut self) -> Option<Vec<f64>> {
        let mut matrix = BandMatrix::zeros(self.right.len(), 4 * self.block);
        let mut order = Vec::new();
        self.rows.order(&mut order);
        matrix.add_rows(&self.rows, &order, &self.weights);
        if !matrix.factorise() {
            return None;
        }
        matrix.solve(&mut self.right);
        self.right.iter().all(|x| x.is_finite()).then_some(self.right)
    }
}
