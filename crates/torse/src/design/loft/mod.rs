//! Developables between two rails \[W15, 4A, 4B\]: branches of coplanar tangents, strips along them, and the strip of
//! least twist where there is no branch.

pub(crate) mod alternatives;
pub mod branch;
pub mod branches;
pub mod build;
pub mod least_twist;
mod links;
pub(crate) mod net_strip;
pub(crate) mod on_torse;
pub(crate) mod orientation;
pub mod track;

use crate::geom::segment::segment_distance;
use crate::geom::Vec3;
use crate::spline::SplineError;
use crate::torse::rail::Rail;

/// Why there is nothing between two rails.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoftError {
    /// A tolerance larger than the curves.
    #[error(transparent)]
    Loose(#[from] crate::geom::coarse::Loose),
    /// The rails meet, or are one and the same.
    #[error(
        "{a} at {at_a:.4} of its length and {b} at {at_b:.4} of its length are only {gap:.6} mm apart; \
         trim the rails so that they do not touch"
    )]
    Touch {
        /// First rail.
        a: String,
        /// Second rail.
        b: String,
        /// Share of the first rail's length.
        at_a: f64,
        /// Share of the second rail's length.
        at_b: f64,
        /// Distance, mm.
        gap: f64,
    },
    /// One rail runs along the other.
    #[error("{a} runs along {b}: they coincide, and there is no surface between them; check that the right curves were named")]
    Coincide {
        /// First rail.
        a: String,
        /// Second rail.
        b: String,
    },
    /// All of both rails lies in one line.
    #[error("{a} and {b} lie in one line: there is no surface between them; check that the right curves were named")]
    OneLine {
        /// First rail.
        a: String,
        /// Second rail.
        b: String,
    },
    /// No tangents of the rails are coplanar anywhere, monotonically.
    #[error("no plane touches both {a} and {b} along a run of rulings ({count} branches, none regular and monotone); ask for the strip of least twist")]
    NoBranch {
        /// First rail.
        a: String,
        /// Second rail.
        b: String,
        /// Branches found.
        count: usize,
    },
    /// There are fewer alternatives than asked for.
    #[error("alternative {asked} does not exist; there are {count}")]
    NoAlternative {
        /// Number asked for, from 1.
        asked: usize,
        /// Number there are.
        count: usize,
    },
    /// Fixed rulings that cross or leave the rails.
    #[error("ruling {index} ({at_a}, {at_b}) must lie on both rails (shares from 0 to 1) beyond the ruling before it")]
    Fixed {
        /// Index of the fixed ruling.
        index: usize,
        /// Share of the first rail's length.
        at_a: f64,
        /// Share of the second rail's length.
        at_b: f64,
    },
    /// A tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// A strip could not be stored.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// Breadth of both rails, as a share of their length, below which they are one line.
const THIN: f64 = 1e-9;
/// Share of the size below which rails touch.
const TOUCH: f64 = 1e-7;
/// Share of a rail at which the search for a foot on it ends: the rounding of its parameters, with a margin.
const FOOT: f64 = 1e-12;
/// Share of both rails at which the search for where they touch ends: a thousandth of [`TOUCH`].
const PLACE: f64 = 1e-10;

/// Refuses rails that touch, and rails that lie in one line.
///
/// # Errors
/// [`LoftError::Touch`] with the place; [`LoftError::OneLine`].
pub(crate) fn apart(a: &Rail, b: &Rail) -> Result<(), LoftError> {
    const POINTS: usize = 200;
    let (p, q) = (a.samples(POINTS), b.samples(POINTS));
    let all = || p.iter().chain(&q);
    // The farthest point of all from the first, and the farthest from the line through both.
    let far = all().map(|x| x - p[0]).max_by(|x, y| x.norm_squared().total_cmp(&y.norm_squared())).unwrap_or_default();
    if all().all(|x| (x - p[0]).cross(&far).norm() <= THIN * far.norm_squared()) {
        return Err(LoftError::OneLine { a: a.name.clone(), b: b.name.clone() });
    }
    let size = a.bbox().diagonal().max(b.bbox().diagonal());
    let mut least = (f64::INFINITY, 0, 0);
    for i in 0..p.len() - 1 {
        for j in 0..q.len() - 1 {
            let d = segment_distance([&p[i], &p[i + 1]], [&q[j], &q[j + 1]]);
            if d < least.0 {
                least = (d, i, j);
            }
        }
    }
    // Chords stray from the rails: what they show is checked on the rails themselves.
    let reach = (p[1] - p[0]).norm().max((q[1] - q[0]).norm());
    if least.0 > 0.1 * reach {
        return Ok(());
    }
    let at = |rail: &Rail, i: usize| rail.sample_parameters(POINTS)[i] / rail.pieces.len() as f64;
    let (gap, s, t) = refine(a, b, at(a, least.1), at(b, least.2));
    if gap <= TOUCH * size {
        // Rails that touch at several places, evenly spread over one of them, touch all along.
        const PLACES: [f64; 4] = [0.15, 0.4, 0.65, 0.9];
        let along =
            |r: &Rail, o: &Rail| PLACES.iter().all(|s| nearest(o, &r.point(s * r.pieces.len() as f64)) <= TOUCH * size);
        if along(a, b) || along(b, a) {
            return Err(LoftError::Coincide { a: a.name.clone(), b: b.name.clone() });
        }
        // Rounding goes a hair below zero.
        let share = |rail: &Rail, s: f64| (rail.length_to(s * rail.pieces.len() as f64) / rail.length()).abs();
        let (at_a, at_b) = (share(a, s), share(b, t));
        return Err(LoftError::Touch { a: a.name.clone(), b: b.name.clone(), at_a, at_b, gap });
    }
    Ok(())
}

/// Distance from a point to a rail, by samples and a shrinking search around the nearest.
fn nearest(rail: &Rail, x: &Vec3) -> f64 {
    const SAMPLES: usize = 400;
    let n = rail.pieces.len() as f64;
    let off = |s: f64| (rail.point(s.clamp(0.0, 1.0) * n) - x).norm();
    let first = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64).min_by(|s, t| off(*s).total_cmp(&off(*t)));
    let (mut s, mut h) = (first.unwrap_or(0.0), 1.0 / SAMPLES as f64);
    while h > FOOT {
        for t in [s - h, s - 0.5 * h, s + 0.5 * h, s + h] {
            if off(t) < off(s) {
                s = t;
            }
        }
        h *= 0.7;
    }
    off(s)
}

/// Least distance near two relative parameters, and where, by a shrinking grid.
fn refine(a: &Rail, b: &Rail, s: f64, t: f64) -> (f64, f64, f64) {
    let (na, nb) = (a.pieces.len() as f64, b.pieces.len() as f64);
    let (mut s, mut t, mut h) = (s, t, 0.05);
    let mut best = f64::INFINITY;
    while h > PLACE {
        let (s0, t0) = (s, t);
        for i in -4..=4 {
            for j in -4..=4 {
                let (x, y) =
                    ((s0 + 0.25 * h * f64::from(i)).clamp(0.0, 1.0), (t0 + 0.25 * h * f64::from(j)).clamp(0.0, 1.0));
                let d = (a.point(x * na) - b.point(y * nb)).norm();
                if d < best {
                    (best, s, t) = (d, x, y);
                }
            }
        }
        h *= 0.6;
    }
    (best, s, t)
}
