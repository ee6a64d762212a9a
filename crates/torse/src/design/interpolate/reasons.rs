//! Why there is no answer, and what would help, in numbers that were tried.
//!
//! *Method.* The signs of the δ_i bound the number of regular solutions (variation diminishing, \[FR88\]); knots and
//! degree do not change that \[FJ07, section 4\]. End rulings are turned in their tangent planes until an answer exists.

use super::polynomial;
use super::problem::Problem;
use super::solution::Solution;
use super::solvability::{of, Solvability};
use crate::geom::Vec3;
use crate::torse::net::Regularity;
use std::fmt;

/// Largest turn of an end ruling that is proposed, degrees.
const LARGEST_TURN_DEG: i32 = 60;
/// Steps in which it is sought, degrees.
const TURN_STEP_DEG: i32 = 5;

/// A change of one end ruling, in the tangent plane there, for which a regular polynomial answer was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Whether the last ruling is turned, not the first.
    pub last: bool,
    /// Angle towards the curve's forward tangent, radians; negative backwards.
    pub angle: f64,
    /// The new direction, of the same length as the given one.
    pub direction: Vec3,
}

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Reasons {
    /// Counts of the polynomial problem; none for rational curves.
    pub solvability: Option<Solvability>,
    /// What is wrong with each polynomial net whose M* lies outside the domain.
    pub faults: Vec<String>,
    /// Smallest turns of the first or last ruling that give an answer.
    pub turns: Vec<Turn>,
}

pub(super) fn reasons(problem: &Problem, known: Option<&Solvability>, candidates: &[Solution]) -> Reasons {
    let solvability = known.map(|_| of(problem, true));
    let faults = candidates.iter().map(fault).collect();
    let turns = [false, true].iter().filter_map(|&last| turn(problem, last)).collect();
    Reasons { solvability, faults, turns }
}

fn fault(s: &Solution) -> String {
    format!("the net with M* = {:.6} {}", s.strip.net.shape().m_star(), s.quality())
}

/// What a solution is like; displayed in words that follow "the net".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quality {
    /// It is regular and holds both end rulings.
    Regular,
    /// Its end rulings lie on different sides of the curve.
    Sides,
    /// It has no width at one end.
    NoWidth,
    /// It is not regular; never `Regularity::Regular`.
    Faulty(Regularity),
}

impl Solution {
    /// What it is like.
    pub fn quality(&self) -> Quality {
        match self.regularity {
            _ if self.start_reach * self.end_reach < 0.0 => Quality::Sides,
            Regularity::Regular if self.is_good() => Quality::Regular,
            Regularity::Regular => Quality::NoWidth,
            fault => Quality::Faulty(fault),
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sides => write!(f, "has its end rulings on different sides of the curve"),
            Self::NoWidth => write!(f, "has no width at one end"),
            Self::Regular | Self::Faulty(Regularity::Regular) => write!(f, "is regular"),
            Self::Faulty(Regularity::Regression { u, v }) => {
                write!(f, "meets its regression curve on ruling u = {u:.4} at {:.0} % of its length", 100.0 * v)
            }
            Self::Faulty(Regularity::TangentRuling { u }) => {
                write!(f, "has a ruling tangent to the curve at u = {u:.4}")
            }
            Self::Faulty(Regularity::Weight { index, weight }) => {
                write!(f, "has weight {weight:.3} at control point {index}")
            }
        }
    }
}

/// The smallest turn of one end ruling in its tangent plane with an answer.
fn turn(problem: &Problem, last: bool) -> Option<Turn> {
    if !problem.polynomial {
        return None;
    }
    let points = problem.points();
    let (given, tangent) = if last {
        (problem.w, points[points.len() - 1] - points[points.len() - 2])
    } else {
        (problem.v, points[1] - points[0])
    };
    let side = tangent - given * (tangent.dot(&given) / given.norm_squared());
    let side = side.normalize() * given.norm();
    let steps = 1..=LARGEST_TURN_DEG / TURN_STEP_DEG;
    steps.flat_map(|k| [k, -k]).find_map(|k| {
        let angle = f64::from(k * TURN_STEP_DEG).to_radians();
        let direction = given * angle.cos() + side * angle.sin();
        let (v, w) = if last { (problem.v, direction) } else { (direction, problem.w) };
        let trial = problem.part(problem.curve.clone(), v, w, problem.options);
        let good = polynomial::candidates(&trial).1.iter().any(Solution::is_good);
        good.then_some(Turn { last, angle, direction })
    })
}

impl std::error::Error for Reasons {}

impl fmt::Display for Reasons {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no regular developable holds both end rulings")?;
        if let Some(s) = &self.solvability {
            write!(
                f,
                "; the legs of the control polygon cross the plane of the two directions in the pattern {}",
                s.pattern()
            )?;
            match s.sign_changes() {
                0 => write!(f, ", all to one side: no polynomial net exists, of any degree or with any knots")?,
                n => write!(f, ", {n} changes: at most {n} polynomial nets, {} found", s.regular.len())?,
            }
            for m_star in &s.singular {
                write!(f, "; one more has M* = {m_star:.6}, where its regression curve meets the curve")?;
            }
        }
        for fault in &self.faults {
            write!(f, "; {fault}")?;
        }
        if self.turns.is_empty() {
            write!(f, "; turn the end rulings towards each other, or cut the curve and give a ruling in between")?;
        }
        for t in &self.turns {
            let (which, way) =
                (if t.last { "last" } else { "first" }, if t.angle > 0.0 { "forwards" } else { "backwards" });
            write!(
                f,
                "; turning the {which} ruling {way} by {:.0} degrees, to ({:.6}, {:.6}, {:.6}), gives one",
                t.angle.abs().to_degrees(),
                t.direction.x,
                t.direction.y,
                t.direction.z
            )?;
        }
        Ok(())
    }
}
