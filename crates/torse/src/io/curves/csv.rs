//! Tables of points: x, y, z on each line, separated by commas, semicolons, tabs or blanks; `#` begins a comment; one
//! line of headings is allowed.

use super::{CurveError, CurveOptions};
use crate::geom::Vec3;

/// Reads the points, mm.
pub(super) fn read(text: &str, options: &CurveOptions) -> Result<Vec<Vec3>, CurveError> {
    let Some(unit) = options.unit else { return Err(CurveError::NoUnit(options.name.clone())) };
    let mut points = Vec::new();
    let mut headed = false;
    for (k, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim().trim_start_matches('\u{feff}');
        if line.is_empty() {
            continue;
        }
        let fields: Vec<&str> =
            line.split(|c: char| ",;\t ".contains(c)).map(str::trim).filter(|f| !f.is_empty()).collect();
        let numbers: Vec<Option<f64>> = fields.iter().map(|f| f.parse::<f64>().ok()).collect();
        if points.is_empty() && !headed && numbers.iter().all(Option::is_none) {
            headed = true;
            continue;
        }
        let fault = |reason: String| CurveError::Line { name: options.name.clone(), line: k + 1, reason };
        let [Some(x), Some(y), Some(z)] = numbers[..] else {
            let why = match numbers.iter().position(Option::is_none) {
                Some(i) => format!("'{}' is not a number", fields[i]),
                None => format!("three coordinates are needed, there are {}", fields.len()),
            };
            return Err(fault(why));
        };
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return Err(fault("a coordinate is not a finite number".into()));
        }
        points.push(Vec3::new(x, y, z) * unit);
    }
    Ok(points)
}
