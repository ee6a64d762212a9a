//! Plane quadrilaterals with the least smooth displacement of a strip's points (discrete torses, section 1A of
//! \[W15\]).

use crate::control::Control;
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::torse::quad_strip::{QuadStrip, QuadStripError};

/// Which points keep their places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// None.
    #[default]
    Nothing,
    /// The first polyline.
    First,
    /// The second polyline.
    Second,
    /// The first and the last ruling.
    Ends,
}

/// How [`planarise`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanariseOptions {
    /// Points that keep their places; default none.
    pub hold: Hold,
    /// Warp that counts as plane, a share of the diagonals; default 1e-13, near the rounding of the coordinates.
    pub warp: f64,
    /// Most steps; default 100.
    pub steps: usize,
}

/// Warp that counts as plane, as a share of the diagonals: hundreds of rounding errors of the coordinates.
const WARP: f64 = 1e-13;
impl Default for PlanariseOptions {
    fn default() -> Self {
        Self { hold: Hold::Nothing, warp: WARP, steps: 100 }
    }
}

/// How a planarisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanariseStatus {
    /// Every quadrilateral is plane to the warp asked for.
    Plane,
    /// No step lowers the warp any more: too many points are held, or the rounding of the coordinates is reached.
    Stalled,
    /// The number of steps is used up.
    StepLimit,
    /// Stopped by the caller.
    Cancelled,
}

/// A strip after planarisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Planarised {
    /// The strip, the best found.
    pub strip: QuadStrip,
    /// How it ended.
    pub status: PlanariseStatus,
    /// Steps taken.
    pub steps: usize,
    /// Largest warp before.
    pub warp_before: f64,
    /// Largest warp after, of the strip as it is returned.
    pub warp: f64,
    /// Largest displacement of a point, mm.
    pub largest_move: f64,
}

/// Why a strip could not be treated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscreteError {
    /// The points make no strip.
    #[error(transparent)]
    Strip(#[from] QuadStripError),
    /// A warp that no strip can reach.
    #[error("{0} is no warp: give a positive share of the diagonals, for example 1e-9")]
    Warp(f64),
    /// More levels than memory holds.
    #[error("{levels} levels of {quads} quadrilaterals give more than {most} of them; ask for fewer levels")]
    Levels {
        /// Levels asked for.
        levels: usize,
        /// Quadrilaterals given.
        quads: usize,
        /// Most allowed.
        most: usize,
    },
}

/// Weight of the third differences of the displacement: `1e-10 n⁶` for n rulings, the discrete form of the integral of
/// the squared third derivative. Without it, subdivision with planarisation makes kinks that double with every level.
const SMOOTHNESS: f64 = 1e-10;
/// Largest weight of third differences: beyond it (some 460 rulings) the metric would lose its identity part to
/// rounding, while the displacements are too small to bend the strip.
const SMOOTHEST: f64 = 1e6;
/// Weight of the planarity rows against the metric. Multipliers make the result independent of it; it is as large as
/// leaves half of the digits to displacements that planarity does not see.
const STIFFNESS: f64 = 1e8;
/// Corrections of the multipliers with one factorisation.
const CORRECTIONS: usize = 4;
/// Share of the linearised warp that may be left when the multipliers are no longer corrected.
const LINEAR: f64 = 1e-6;
/// Halvings of a step before none is found.
const HALVINGS: usize = 30;
/// Least relative decrease of the sum of squared gaps for a step to be taken.
const DECREASE: f64 = 1e-4;
/// Steps of less gain than this factor on the largest warp, at a warp that rounding explains, end the work.
const GAIN: f64 = 0.5;
/// Warp, as a multiple of the machine precision over the relative width of the narrowest quadrilateral, that rounding
/// explains.
const ROUNDING: f64 = 8.0;

/// Moves the points of a strip so that all quadrilaterals become plane.
///
/// *Method.* Gauss–Newton steps on the distances between the diagonals of each quadrilateral; among all displacements
/// that annul the linearised distances, each step takes the one that is least in the metric `I + μ D₃ᵀD₃`, where `D₃`
/// takes third differences along the strip. The step solves a banded system with an augmented Lagrangian, whose
/// factorisation serves all corrections of the multipliers; it is halved until the gaps decrease. Departure from the
/// usual guided projection: no weights of closeness that decay, since the least displacement needs none.
///
/// *Guarantee.* The status tells whether all warps are at most `options.warp`, evaluated about the mean of the points;
/// `warp` is that of the returned points, which are rounded where they lie. Held points are returned unchanged, bit by bit.
/// *Not guaranteed*: that the strip is the nearest plane one (it is, up to second
/// order in the displacement), or that rulings do not cross ([`QuadStrip::crossing`]).
///
/// *Cost.* O(n) per step; 5 to 25 steps.
///
/// # Errors
/// A warp that is not positive.
pub fn planarise(
    strip: &QuadStrip,
    options: &PlanariseOptions,
    control: &Control,
) -> Result<Planarised, DiscreteError> {
    if options.warp.is_nan() || options.warp <= 0.0 {
        return Err(DiscreteError::Warp(options.warp));
    }
    let start = State::of(strip);
    let mut work = Work::new(&start, options.hold);
    let mut state = start.clone();
    let warp_before = state.largest_warp();
    let (mut status, mut steps) = (PlanariseStatus::StepLimit, 0);
    while steps <= options.steps {
        let warp = state.largest_warp();
        if warp <= options.warp {
            status = PlanariseStatus::Plane;
            break;
        }
        if control.stopped() {
            status = PlanariseStatus::Cancelled;
            break;
        }
        if steps == options.steps {
            break;
        }
        steps += 1;
        let Some(next) = work.step(&state) else {
            status = PlanariseStatus::Stalled;
            break;
        };
        let gained = next.largest_warp();
        if gained > GAIN * warp && warp < ROUNDING * f64::EPSILON / state.narrowest() {
            status = PlanariseStatus::Stalled;
            break;
        }
        state = next;
    }
    let made = state.strip(strip, &start)?;
    let (warp, largest_move) = (made.largest_warp(), state.largest_move(&start));
    Ok(Planarised { strip: made, status, steps, warp_before, warp, largest_move })
}

/// Points in the order a₀, b₀, a₁, b₁, … about their mean, in units of the size of the strip.
#[derive(Clone, Debug)]
struct State {
    points: Vec<Vec3>,
    centre: Vec3,
    size: f64,
}

impl State {
    fn of(strip: &QuadStrip) -> Self {
        let size = strip.size();
        let all = || strip.a().iter().zip(strip.b()).flat_map(|(p, q)| [*p, *q]);
        let centre = all().sum::<Vec3>() / (2 * strip.rulings()) as f64;
        Self { points: all().map(|p| (p - centre) / size).collect(), centre, size }
    }

    /// The strip where it lies. Points that have not moved from the `start` are those of the `given` strip, bit by bit: on the way
    /// there and back they would be rounded.
    fn strip(&self, given: &QuadStrip, start: &Self) -> Result<QuadStrip, QuadStripError> {
        let side = |k: usize, given: &[Vec3]| {
            let placed = |(i, own): (usize, &Vec3)| {
                let p = self.points[2 * i + k];
                if p == start.points[2 * i + k] {
                    *own
                } else {
                    p * self.size + self.centre
                }
            };
            given.iter().enumerate().map(placed).collect()
        };
        QuadStrip::new(side(0, given.a()), side(1, given.b()))
    }

    fn quads(&self) -> usize {
        self.points.len() / 2 - 1
    }

    /// Diagonals of quadrilateral `i`, the edge from a to the next a, and twice the area between the diagonals.
    fn quad(&self, i: usize) -> (Vec3, Vec3, Vec3, Vec3) {
        let p = &self.points[2 * i..2 * i + 4];
        let (d, e) = (p[3] - p[0], p[1] - p[2]);
        (d, e, p[2] - p[0], d.cross(&e))
    }

    /// Distance between the diagonals of quadrilateral `i`.
    fn gap(&self, i: usize) -> f64 {
        let (_, _, f, n) = self.quad(i);
        n.try_normalize(0.0).map_or(0.0, |n| f.dot(&n))
    }

    fn squared_gaps(&self) -> f64 {
        (0..self.quads()).map(|i| self.gap(i).powi(2)).sum()
    }

    fn largest_warp(&self) -> f64 {
        let warp = |i: usize| {
            let (d, e, _, _) = self.quad(i);
            self.gap(i).abs() / (0.5 * (d.norm() + e.norm()))
        };
        (0..self.quads()).map(warp).fold(0.0, f64::max)
    }

    /// Least sine of the angle between the diagonals of a quadrilateral.
    fn narrowest(&self) -> f64 {
        let sine = |i: usize| {
            let (d, e, _, n) = self.quad(i);
            n.norm() / (d.norm() * e.norm())
        };
        (0..self.quads()).map(sine).fold(1.0, f64::min)
    }

    fn largest_move(&self, from: &Self) -> f64 {
        self.points.iter().zip(&from.points).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max) * self.size
    }

    fn moved(&self, by: &[f64], share: f64) -> Self {
        let points =
            self.points.iter().zip(by.chunks_exact(3)).map(|(p, d)| p + Vec3::new(d[0], d[1], d[2]) * share).collect();
        Self { points, ..*self }
    }
}

/// Unknowns of a ruling.
const PER_RULING: usize = 6;
/// Unknowns that one planarity row touches: two rulings.
const ROW: usize = 2 * PER_RULING;
/// Reach of a third difference: from a coordinate to the same one three rulings on.
const BAND: usize = 3 * PER_RULING + 1;

/// Matrices of one strip, kept from step to step.
struct Work {
    metric: BandMatrix,
    normal: BandMatrix,
    rows: Rows,
    held: Vec<bool>,
}

impl Work {
    fn new(state: &State, hold: Hold) -> Self {
        let n = state.points.len() / 2;
        let held: Vec<bool> = (0..2 * n)
            .map(|k| match hold {
                Hold::Nothing => false,
                Hold::First => k % 2 == 0,
                Hold::Second => k % 2 == 1,
                Hold::Ends => k < 2 || k + 2 >= 2 * n,
            })
            .collect();
        let size = PER_RULING * n;
        let mut metric = BandMatrix::zeros(size, BAND);
        for k in 0..size {
            metric.add_diagonal(k, 1.0);
        }
        if n > 3 {
            let weight = (SMOOTHNESS * (n as f64).powi(6)).min(SMOOTHEST);
            let mut third = Rows::new(size, BAND);
            for k in 0..size - 3 * PER_RULING {
                let (_, row) = third.push(k);
                for (j, c) in [-1.0, 3.0, -3.0, 1.0].into_iter().enumerate() {
                    if !held[(k + j * PER_RULING) / 3] {
                        row[j * PER_RULING] = c;
                    }
                }
                metric.add_row(&third, k, weight);
            }
        }
        Self { normal: metric.clone(), metric, rows: Rows::new(size, ROW), held }
    }

    /// The next points, or `None` if no share of the step lowers the gaps.
    fn step(&mut self, state: &State) -> Option<State> {
        let quads = state.quads();
        self.normal.assign(&self.metric);
        self.rows.clear();
        let mut gaps = Vec::with_capacity(quads);
        for i in 0..quads {
            let (d, e, f, n) = state.quad(i);
            let (_, row) = self.rows.push(i * PER_RULING);
            let area = n.norm();
            let scale = if area > 0.0 { 1.0 / area } else { 0.0 };
            gaps.push(f.dot(&n) * scale);
            // Volume f·(d × e) with d = b' − a, e = b − a', f = a' − a; the area counts as constant.
            let (by_d, by_e, by_f) = (e.cross(&f) * scale, f.cross(&d) * scale, n * scale);
            let gradients = [-by_d - by_f, by_e, by_f - by_e, by_d];
            for (k, g) in gradients.iter().enumerate() {
                if !self.held[2 * i + k] {
                    row[3 * k..3 * k + 3].copy_from_slice(g.as_slice());
                }
            }
            self.normal.add_row(&self.rows, i, STIFFNESS);
        }
        if !self.normal.factorise() {
            return None;
        }
        // Least displacement dx with J dx + F = 0: multipliers are corrected until the linear gaps vanish.
        let mut dx = vec![0.0; self.metric.size()];
        let mut multipliers: Vec<f64> = gaps.iter().map(|g| STIFFNESS * g).collect();
        let whole = gaps.iter().fold(0.0, |m: f64, g| m.max(g.abs()));
        for _ in 0..=CORRECTIONS {
            dx.fill(0.0);
            for (i, m) in multipliers.iter().enumerate() {
                self.rows.scatter(i, -m, &mut dx);
            }
            self.normal.solve(&mut dx);
            let mut left = 0.0f64;
            for (i, m) in multipliers.iter_mut().enumerate() {
                let rest = gaps[i] + self.rows.dot(i, &dx);
                left = left.max(rest.abs());
                *m += STIFFNESS * rest;
            }
            if left <= LINEAR * whole {
                break;
            }
        }
        if dx.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let before = state.squared_gaps();
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let next = state.moved(&dx, share);
            if next.squared_gaps() < before * (1.0 - DECREASE * share) {
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }
}
