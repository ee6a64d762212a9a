//! Tables of rulings or of two polylines.

use super::QuadReadError;
use crate::geom::Vec3;

/// Both polylines in units of the file.
pub(super) fn rulings(text: &str) -> Result<[Vec<Vec3>; 2], QuadReadError> {
    let mut sides: [Vec<Vec3>; 2] = Default::default();
    // Columns of the table, and the polyline being read where there are three.
    let (mut columns, mut side, mut gap, mut headed) = (0, 0, false, false);
    for (k, line) in text.lines().enumerate() {
        let fault = |reason: String| QuadReadError::Line { line: k + 1, reason };
        let content = line.split('#').next().unwrap_or("").trim().trim_start_matches('\u{feff}');
        if content.is_empty() {
            // A line with nothing but a comment separates nothing.
            gap |= line.trim().is_empty();
            continue;
        }
        let fields: Vec<&str> = content.split(|c: char| ",;\t ".contains(c)).filter(|f| !f.is_empty()).collect();
        let numbers: Vec<Option<f64>> = fields.iter().map(|f| f.parse::<f64>().ok()).collect();
        if columns == 0 && !headed && !fields.is_empty() && numbers.iter().all(Option::is_none) {
            headed = true;
            gap = false;
            continue;
        }
        if let Some(i) = numbers.iter().position(Option::is_none) {
            return Err(fault(format!("'{}' is not a number", fields[i])));
        }
        let row: Vec<f64> = numbers.into_iter().flatten().collect();
        if row.iter().any(|x| !x.is_finite()) {
            return Err(fault("a coordinate is not a finite number".into()));
        }
        if columns == 0 && (row.len() == 3 || row.len() == 6) {
            columns = row.len();
            gap = false;
        }
        if row.len() != columns {
            let wanted = if columns == 0 { "six (both ends of a ruling) or three".into() } else { columns.to_string() };
            return Err(fault(format!("{wanted} numbers are needed, there are {}", row.len())));
        }
        if columns == 6 {
            sides[0].push(Vec3::new(row[0], row[1], row[2]));
            sides[1].push(Vec3::new(row[3], row[4], row[5]));
            continue;
        }
        if gap {
            side += 1;
            gap = false;
        }
        match sides.get_mut(side) {
            Some(s) => s.push(Vec3::new(row[0], row[1], row[2])),
            None => return Err(fault("a third polyline begins here; a strip has two".into())),
        }
    }
    if columns == 3 && sides[1].is_empty() {
        let reason = "the second polyline is missing; separate the two by an empty line".into();
        return Err(QuadReadError::Line { line: text.lines().count(), reason });
    }
    Ok(sides)
}
