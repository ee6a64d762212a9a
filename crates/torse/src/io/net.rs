//! Control nets from JSON files: a B-spline curve by degree, knots and control points, with what decides the net.
//!
//! ```json
//! { "unit": "mm", "degree": 2, "knots": [0, 0, 0, 0.5, 1, 1, 1],
//!   "points": [[0, 0, 0], [100, 50, 0], [200, 50, 30], [300, 0, 50]],
//!   "first_ruling": [0, 120, 40], "last_ruling": [30, 100, 0] }
//! ```
//!
//! Points may have a weight as fourth number. Knots may be all of a kernel, or without the first and last one as
//! \[FJ07\] counts them. Instead of `last_ruling`, `m_star` and `lambda_star` (numbers on the scale of the knots), or `m`
//! and `kappa` (for the parameter from 0 to 1).

use crate::geom::{unit, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::SplineError;
use crate::torse::rail::{Rail, RailError};
use serde::Deserialize;

/// What a file may hold besides the curve; lengths in mm, the curve's parameter from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct NetFile {
    /// The curve.
    pub curve: Rail,
    /// First ruling, from the curve to the opposite edge.
    pub first_ruling: Option<Vec3>,
    /// Last ruling.
    pub last_ruling: Option<Vec3>,
    /// `[M*, Λ*]`.
    pub stars: Option<[f64; 2]>,
    /// `[m, κ]`.
    pub shape: Option<[f64; 2]>,
}

/// Why there is no net in a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetFileError {
    /// Not the JSON that is needed.
    #[error("{name}: {reason}")]
    Json {
        /// Name.
        name: String,
        /// What is wrong, with the line.
        reason: String,
    },
    /// A unit that is not known, or none.
    #[error("{name}: \"unit\" must be mm, cm, m, in or ft{}", if .unit.is_empty() { String::new() } else { format!(", not '{}'", .unit) })]
    Unit {
        /// Name.
        name: String,
        /// As given.
        unit: String,
    },
    /// A number of knots that does not fit.
    #[error("{name}: {points} points of degree {degree} need {} knots, or {} without the first and last, not {knots}", .points.saturating_add(*.degree).saturating_add(1), .points.saturating_add(*.degree).saturating_sub(1))]
    KnotCount {
        /// Name.
        name: String,
        /// Number of control points.
        points: usize,
        /// Degree.
        degree: usize,
        /// Number of knots.
        knots: usize,
    },
    /// A point without three or four coordinates, or a weight that is not positive.
    #[error(
        "{name}: point {index} (counted from 0) has {there} numbers; it must be x, y, z and perhaps a positive weight"
    )]
    Point {
        /// Name.
        name: String,
        /// Index from 0.
        index: usize,
        /// Numbers that it has.
        there: usize,
    },
    /// A ruling without three coordinates.
    #[error("{name}: \"{which}\" has {there} numbers; it must be x, y, z, as points have three coordinates and perhaps a weight")]
    Ruling {
        /// Name.
        name: String,
        /// Which ruling.
        which: &'static str,
        /// Numbers that it has.
        there: usize,
    },
    /// One of two numbers that belong together.
    #[error("{name}: \"{first}\" and \"{second}\" must be given together")]
    Pair {
        /// Name.
        name: String,
        /// First name.
        first: &'static str,
        /// Second name.
        second: &'static str,
    },
    /// No valid spline.
    #[error("{name}: {source}")]
    Spline {
        /// Name.
        name: String,
        /// What is wrong.
        source: SplineError,
    },
    /// No curve.
    #[error(transparent)]
    Rail(#[from] RailError),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    unit: Option<String>,
    degree: usize,
    knots: Vec<f64>,
    points: Vec<Vec<f64>>,
    first_ruling: Option<Vec<f64>>,
    last_ruling: Option<Vec<f64>>,
    m_star: Option<f64>,
    lambda_star: Option<f64>,
    m: Option<f64>,
    kappa: Option<f64>,
}

/// Whether a file begins like one of these.
pub fn is_net(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    text.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{')
}

/// Reads a net. `given` is the length of the file's unit (mm) where the file does not say.
///
/// # Errors
/// See [`NetFileError`].
pub fn read(bytes: &[u8], name: &str, given: Option<f64>) -> Result<NetFile, NetFileError> {
    let named = || name.to_owned();
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let r: Record = serde_json::from_slice(text)
        .map_err(|e| NetFileError::Json { name: named(), reason: format!("it is no control net: {e}") })?;
    let Some(scale) = unit::agreed(r.unit.as_deref(), given) else {
        return Err(NetFileError::Unit { name: named(), unit: r.unit.unwrap_or_default() });
    };
    let mut control = Vec::with_capacity(r.points.len());
    for (index, p) in r.points.iter().enumerate() {
        let w = match p.len() {
            3 => 1.0,
            4 if p[3] > 0.0 => p[3],
            there => return Err(NetFileError::Point { name: named(), index, there }),
        };
        control.push([p[0] * scale * w, p[1] * scale * w, p[2] * scale * w, w]);
    }
    let mut knots = r.knots;
    let (points, degree) = (control.len(), r.degree);
    // A degree may be any number that a file can hold.
    let sum = points.saturating_add(degree);
    let short = sum.checked_sub(1) == Some(knots.len()) && !knots.is_empty();
    if short {
        knots.insert(0, knots[0]);
        knots.push(knots[knots.len() - 1]);
    }
    if knots.len() != sum.saturating_add(1) {
        let knots = if short { knots.len() - 2 } else { knots.len() };
        return Err(NetFileError::KnotCount { name: named(), points, degree, knots });
    }
    let spline = |source| NetFileError::Spline { name: named(), source };
    let curve = Curve { knots: Knots::new(degree, knots, points).map_err(spline)?, control };
    let (a, b) = curve.domain();
    let pair = |x: Option<f64>, y: Option<f64>, first, second| match (x, y) {
        (Some(x), Some(y)) => Ok(Some([x, y])),
        (None, None) => Ok(None),
        _ => Err(NetFileError::Pair { name: named(), first, second }),
    };
    let vector = |v: Option<Vec<f64>>, which| match v.as_deref() {
        None => Ok(None),
        Some(&[x, y, z]) => Ok(Some(Vec3::new(x, y, z) * scale)),
        Some(v) => Err(NetFileError::Ruling { name: named(), which, there: v.len() }),
    };
    Ok(NetFile {
        curve: Rail::new(name, &[curve])?,
        first_ruling: vector(r.first_ruling, "first_ruling")?,
        last_ruling: vector(r.last_ruling, "last_ruling")?,
        stars: pair(r.m_star, r.lambda_star, "m_star", "lambda_star")?.map(|s| s.map(|x| (x - a) / (b - a))),
        shape: pair(r.m, r.kappa, "m", "kappa")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NET: &str = r#"{ "unit": "cm", "degree": 2, "knots": [0, 0, 2, 4, 4],
        "points": [[0, 0, 0], [1, 2, 0], [2, 2, 1], [4, 0, 1, 1.0]], "m_star": 8, "lambda_star": 10 }"#;

    #[test]
    fn the_knots_of_the_paper_and_of_a_kernel_are_the_same_curve_and_numbers_go_to_the_unit_parameter() {
        let short = read(NET.as_bytes(), "n", None).expect("net");
        let long = read(NET.replace("[0, 0, 2, 4, 4]", "[0, 0, 0, 2, 4, 4, 4]").as_bytes(), "n", None).expect("net");
        assert_eq!(short, long);
        assert_eq!(short.stars, Some([2.0, 2.5]));
        assert!((short.curve.point(1.0) - Vec3::new(40.0, 0.0, 10.0)).norm() < 1e-12);
        assert!(is_net(NET.as_bytes()) && !is_net(b"0,0,0\n"));
    }

    #[test]
    fn what_is_no_net_is_refused_with_the_place() {
        let told = |from: &str, to: &str| read(NET.replace(from, to).as_bytes(), "n", None).expect_err(to).to_string();
        assert!(told("[0, 0, 2, 4, 4]", "[0, 0, 2, 4]").contains("need 7 knots, or 5"));
        assert!(told("\"degree\": 2", "\"degree\": 18446744073709551615").contains("of degree 18446744073709551615"));
        assert!(told("\"cm\"", "\"furlong\"").contains("furlong"));
        assert!(told("\"unit\": \"cm\",", "").contains("unit"));
        assert!(told("[1, 2, 0]", "[1, 2]").contains("point 1"));
        assert!(told("[1, 2, 0]", "[1, 2, 0, 1, 2, 3]").contains("point 1 (counted from 0) has 6 numbers"));
        assert!(told("[1, 2, 0]", "[]").contains("point 1 (counted from 0) has 0 numbers"));
        let six = told("\"m_star\"", "\"first_ruling\": [0, 1, 0, 0, 0, 1], \"m_star\"");
        assert!(six.contains("\"first_ruling\" has 6 numbers; it must be x, y, z"), "{six}");
        assert!(told("1.0]", "0.0]").contains("point 3"));
        assert!(told(", \"lambda_star\": 10", "").contains("together"));
        assert!(told("\"degree\"", "\"order\"").contains("line 1"));
        assert!(told("[0, 0, 2, 4, 4]", "[0, 0, 5, 4, 4]").contains("n: "));
        assert!(told("[1, 2, 0], [2, 2, 1], [4, 0, 1, 1.0]", "[0, 0, 0], [0, 0, 0], [0, 0, 0]").contains("no length"));
        assert!(read(b"", "n", None).is_err());
    }
}
