//! Tables of points: columns x, y and z in any order if the first line names them, else three columns; see
//! [`crate::io::table`] for separators, decimal commas and comments.

use super::options::{CurveError, CurveOptions};
use crate::geom::Vec3;
use crate::io::table::{self, Fault};

/// Reads the points, mm.
pub(super) fn read(bytes: &[u8], options: &CurveOptions) -> Result<Vec<Vec3>, CurveError> {
    let named = |f: Fault| CurveError::Line { name: options.name.clone(), line: f.line, reason: f.reason };
    let text = table::text(bytes).map_err(named)?;
    let table = table::table(&text).map_err(named)?;
    if table.rows.is_empty() {
        let headed = Fault { line: 1, reason: "there is no row of numbers".into() };
        return if table.is_named() { Err(named(headed)) } else { Ok(Vec::new()) };
    }
    table.counted().map_err(named)?;
    let columns = table.needed(&["x", "y", "z"]).map_err(named)?;
    let unit = table.unit_or(&columns, options.unit).map_err(named)?;
    let Some(unit) = unit else { return Err(CurveError::NoUnit(options.name.clone())) };
    let mut points = Vec::with_capacity(table.rows.len());
    let mut values = Vec::new();
    for row in &table.rows {
        table.numbers(row, &columns, &mut values).map_err(named)?;
        if values.iter().any(|x| !x.is_finite()) {
            return Err(named(Fault { line: row.line, reason: "a coordinate is not a finite number".into() }));
        }
        points.push(Vec3::new(values[0], values[1], values[2]) * unit);
    }
    Ok(points)
}
