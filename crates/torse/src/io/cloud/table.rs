//! Points as rows of numbers: columns x, y and z in any order if the first line names them, else three columns; see
//! [`crate::io::table`] for separators, decimal commas and comments. A first line with one number is the count that
//! some scanners write. Leica's PTS files may have intensity, or intensity and colour, behind the coordinates.

use super::error::CloudReadError;
use crate::geom::Vec3;
use crate::io::table::{self, Fault};

const FORMAT: &str = "CSV";

/// Numbers on a line of a PTS file: coordinates, with colour, with intensity, with both.
const PTS_WIDTHS: [usize; 4] = [3, 4, 6, 7];

/// Points in mm, and whether that is a guess; `unit` (mm) is that of the file unless its headings say one, mm if none is
/// given. `pts` says that the
/// name of the file promises Leica's order of columns.
pub(super) fn points(bytes: &[u8], unit: Option<f64>, pts: bool) -> Result<(Vec<Vec3>, bool), CloudReadError> {
    let told = |f: Fault| CloudReadError::Line { format: FORMAT, line: f.line, reason: f.reason };
    let text = table::text(bytes).map_err(told)?;
    let table = table::table(&text).map_err(told)?;
    if table.rows.is_empty() {
        return Ok((Vec::new(), false));
    }
    let leica = pts && !table.is_named() && PTS_WIDTHS.contains(&table.width());
    let columns = if leica { vec![0, 1, 2] } else { table.needed(&["x", "y", "z"]).map_err(told)? };
    let unit = table.unit_or(&columns, unit).map_err(told)?;
    let (guessed, unit) = (unit.is_none(), unit.unwrap_or(1.0));
    let mut out = Vec::with_capacity(table.rows.len());
    let mut values = Vec::new();
    for row in &table.rows {
        table.numbers(row, &columns, &mut values).map_err(told)?;
        out.push(Vec3::new(values[0], values[1], values[2]) * unit);
    }
    match table.promised {
        Some(promised) if promised > out.len() => {
            Err(CloudReadError::Short { format: FORMAT, read: out.len(), promised, what: "points" })
        }
        _ => table.counted().map(|()| (out, guessed)).map_err(told),
    }
}
