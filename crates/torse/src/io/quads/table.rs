//! Tables of rulings or of two polylines.

use super::error::QuadReadError;
use crate::geom::Vec3;
use crate::io::table::{self, Fault, Table};

/// Columns of both ends of a ruling.
const RUNG: [&str; 6] = ["ax", "ay", "az", "bx", "by", "bz"];
/// The same as rulings from p to q.
const RULING: [&str; 6] = ["px", "py", "pz", "qx", "qy", "qz"];

/// Coordinates beyond (mm) are no lengths of a sheet: a million kilometres, where numbers have steps of a tenth of a millimetre.
const FARTHEST: f64 = 1e12;

/// Both polylines in mm; `unit` (mm) is the file's where one is given.
pub(super) fn rulings(bytes: &[u8], unit: Option<f64>) -> Result<[Vec<Vec3>; 2], QuadReadError> {
    let text = table::text(bytes).map_err(told)?;
    let table = table::table(&text).map_err(told)?;
    let mut sides: [Vec<Vec3>; 2] = Default::default();
    if table.rows.is_empty() {
        return Ok(sides);
    }
    table.counted().map_err(told)?;
    let columns = columns(&table).map_err(told)?;
    let unit = table.unit_or(&columns, unit).map_err(told)?.unwrap_or(1.0);
    let (mut side, mut values) = (0, Vec::new());
    for row in &table.rows {
        let fault = |reason: &str| told(Fault { line: row.line, reason: reason.into() });
        table.numbers(row, &columns, &mut values).map_err(told)?;
        if values.iter().any(|x| !x.is_finite()) {
            return Err(fault("a coordinate is not a finite number"));
        }
        if let Some(x) = values.iter().find(|x| (*x * unit).abs() > FARTHEST) {
            return Err(fault(&format!(
                "a coordinate, {x:e}, is farther away than any strip: beside it all others are one point"
            )));
        }
        if columns.len() == 6 {
            sides[0].push(Vec3::new(values[0], values[1], values[2]) * unit);
            sides[1].push(Vec3::new(values[3], values[4], values[5]) * unit);
            continue;
        }
        side += usize::from(row.gap);
        match sides.get_mut(side) {
            Some(s) => s.push(Vec3::new(values[0], values[1], values[2]) * unit),
            None => return Err(fault("a third polyline begins here; a strip has two")),
        }
    }
    if columns.len() == 3 && sides[1].is_empty() {
        let reason = "the second polyline is missing; separate the two by an empty line".into();
        return Err(QuadReadError::Line { line: text.lines().count(), reason });
    }
    Ok(sides)
}

/// Columns of both ends of rulings, or of points.
fn columns(table: &Table) -> Result<Vec<usize>, Fault> {
    for names in [RUNG, RULING] {
        if let Some(found) = table.group(&names)? {
            return Ok(found);
        }
    }
    if table.width() == RUNG.len() && table.column("x")?.is_none() {
        return table.needed(&RUNG);
    }
    if !table.is_named() && table.width() != 3 {
        let line = table.rows.first().map_or(1, |r| r.line);
        let reason = format!("six numbers (both ends of a ruling) or three are needed, there are {}", table.width());
        return Err(Fault { line, reason });
    }
    table.needed(&["x", "y", "z"])
}

fn told(fault: Fault) -> QuadReadError {
    QuadReadError::Line { line: fault.line, reason: fault.reason }
}
