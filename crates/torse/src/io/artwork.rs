//! Artwork: points in tables and curves in drawings, read, and written in the same kind after they were carried over.

pub use crate::develop::refold::artwork::PointRow;
use crate::geom::Vec3;
use crate::io::curves::{read_all, CurveError, CurveOptions};
use crate::io::table::{self, Fault};
use crate::torse::rail::Rail;
use std::fmt::Write as _;

/// A file of artwork.
#[derive(Clone, Debug)]
pub enum Artwork {
    /// Points of a table, mm, each with its line, and the lines of rows without a place: points that lay on no part before.
    Points(Vec<(usize, Vec3)>, Vec<usize>),
    /// Curves of a drawing, with what was not read of it.
    Curves(Vec<Rail>, Vec<String>),
}

/// Why a file of artwork cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ArtworkError {
    /// A line of a table.
    #[error("{name}, line {line}: {reason}")]
    Line {
        /// File.
        name: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// No points.
    #[error("{0} holds no points")]
    Empty(String),
    /// A drawing.
    #[error(transparent)]
    Curves(#[from] CurveError),
}

/// Reads artwork; a drawing is told by how it begins, all else is a table. Tables without a unit are in `unit` mm; in tables of
/// the plane the third coordinate may be left out.
///
/// # Errors
/// See [`ArtworkError`].
///
/// # Example
/// ```
/// use torse::io::artwork::{read, Artwork};
/// let table = include_bytes!("../../../../data/rivets.csv");
/// let Artwork::Points(points, _) = read("rivets.csv", table, 1.0)? else { panic!("a table") };
/// assert_eq!((points.len(), points[0].1.x), (5, 16.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(name: &str, bytes: &[u8], unit: f64) -> Result<Artwork, ArtworkError> {
    let text = String::from_utf8_lossy(bytes);
    let start = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    let drawing = start.lines().next().is_some_and(|l| matches!(l.trim(), "0" | "999"));
    if drawing {
        let options = CurveOptions { polyline: true, ..CurveOptions::new(name) };
        let all = match read_all(bytes, &options) {
            Err(CurveError::NoUnit(_)) => read_all(bytes, &CurveOptions { unit: Some(unit), ..options })?,
            other => other?,
        };
        return Ok(Artwork::Curves(all.rails, all.notes));
    }
    points(name, bytes, unit)
}

fn points(name: &str, bytes: &[u8], unit: f64) -> Result<Artwork, ArtworkError> {
    let named = |f: Fault| ArtworkError::Line { name: name.into(), line: f.line, reason: f.reason };
    let text = table::text(bytes).map_err(named)?;
    let table = table::table(&text).map_err(named)?;
    let in_space = table.width() != 2 && (!table.is_named() || table.column("z").map_err(named)?.is_some());
    let columns = table.needed(if in_space { &["x", "y", "z"] } else { &["x", "y"] }).map_err(named)?;
    let unit = table.unit(&columns).map_err(named)?.unwrap_or(unit);
    let (mut out, mut blank, mut values) = (Vec::with_capacity(table.rows.len()), Vec::new(), Vec::new());
    for row in &table.rows {
        if table.is_named() && table.is_blank(row, &columns) {
            blank.push(row.line);
            continue;
        }
        table.numbers(row, &columns, &mut values).map_err(named)?;
        let point = Vec3::new(values[0], values[1], values.get(2).copied().unwrap_or(0.0)) * unit;
        if point.iter().any(|x| !x.is_finite()) {
            return Err(named(Fault { line: row.line, reason: "a coordinate is not a finite number of mm".into() }));
        }
        out.push((row.line, point));
    }
    match out.is_empty() && blank.is_empty() {
        true => Err(ArtworkError::Empty(name.into())),
        false => Ok(Artwork::Points(out, blank)),
    }
}

/// Columns of tables of the plane.
const FLAT_COLUMNS: &str = "line,part,x_mm,y_mm,distance_mm";
/// Columns of tables in space.
const SPACE_COLUMNS: &str = "line,part,x_mm,y_mm,z_mm,distance_mm";

/// Points as a table, mm; `flat` leaves out the third coordinate.
pub fn csv(rows: &[PointRow], flat: bool) -> Vec<u8> {
    let mut out = format!("{}\n", if flat { FLAT_COLUMNS } else { SPACE_COLUMNS });
    for r in rows {
        let name = r.part.replace('"', "\"\"");
        let place = r.place.map_or_else(
            || if flat { ",".to_owned() } else { ",,".to_owned() },
            |p| {
                if flat {
                    format!("{:.DIGITS$},{:.DIGITS$}", p.x, p.y)
                } else {
                    format!("{:.DIGITS$},{:.DIGITS$},{:.DIGITS$}", p.x, p.y, p.z)
                }
            },
        );
        // Rows without a place have no distance either.
        let distance = if r.distance.is_finite() { format!("{:.6}", r.distance) } else { String::new() };
        // Writing to a string cannot fail.
        _ = writeln!(out, "{},\"{name}\",{place},{distance}", r.line);
    }
    out.into_bytes()
}

/// How drawings begin.
const DRAWING_BEGINS: &str =
    "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
/// How drawings end.
const DRAWING_ENDS: &str = "0\nENDSEC\n0\nEOF\n";
/// Digits of coordinates after the point.
const DIGITS: usize = 9;

/// Polylines with the names of their layers as a DXF drawing (AC1009) in mm; `flat` for drawings of the plane.
pub fn dxf(lines: &[(String, Vec<Vec3>)], flat: bool) -> Vec<u8> {
    let mut out = String::from(DRAWING_BEGINS);
    for (name, points) in lines {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-_$".contains(c) { c } else { '_' };
        let layer: String = name.chars().map(plain).collect();
        let flags = if flat { 0 } else { 8 };
        // Writing to a string cannot fail.
        _ = write!(out, "0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n{flags}\n10\n0.0\n20\n0.0\n30\n0.0\n");
        for p in points {
            _ = write!(
                out,
                "0\nVERTEX\n8\n{layer}\n10\n{:.DIGITS$}\n20\n{:.DIGITS$}\n30\n{:.DIGITS$}\n",
                p.x, p.y, p.z
            );
            if !flat {
                out.push_str("70\n32\n");
            }
        }
        _ = write!(out, "0\nSEQEND\n8\n{layer}\n");
    }
    out.push_str(DRAWING_ENDS);
    out.into_bytes()
}

/// Whether a file is, to the last line, of the form that [`csv`] and [`dxf`] write. What other programs have written or
/// somebody has added to is not.
pub fn is_as_written(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).is_ok_and(|text| is_table_as_written(text) || is_drawing_as_written(text))
}

fn is_table_as_written(text: &str) -> bool {
    let mut lines = text.strip_suffix('\n').unwrap_or(text).split('\n');
    let Some(columns) = lines.next().filter(|l| [FLAT_COLUMNS, SPACE_COLUMNS].contains(l)) else { return false };
    // All but the number of the line and the quoted name of the part.
    let width = columns.split(',').count() - 2;
    lines.all(|line| {
        let parts = line.split_once(",\"").and_then(|(of, rest)| Some((of, rest.rsplit_once("\",")?.1)));
        parts.is_some_and(|(of, numbers)| {
            let number = |x: &str| x.is_empty() || x.parse::<f64>().is_ok();
            of.parse::<usize>().is_ok() && numbers.split(',').count() == width && numbers.split(',').all(number)
        })
    })
}

fn is_drawing_as_written(text: &str) -> bool {
    let Some(entities) = text.strip_prefix(DRAWING_BEGINS).and_then(|t| t.strip_suffix(DRAWING_ENDS)) else {
        return false;
    };
    let lines: Vec<&str> = entities.lines().collect();
    let coordinate =
        |x: &str| x == "0.0" || (x.parse::<f64>().is_ok() && x.split_once('.').is_some_and(|(_, d)| d.len() == DIGITS));
    lines.chunks(2).all(|group| match *group {
        ["0", value] => ["POLYLINE", "VERTEX", "SEQEND"].contains(&value),
        ["8", _] | ["66", "1"] | ["70", "0" | "8" | "32"] => true,
        ["10" | "20" | "30", value] => coordinate(value),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_need_two_columns_in_the_plane_and_name_their_faults() {
        let Ok(Artwork::Points(p, _)) = read("a.csv", b"name,x_in,y_in\nhole,1,2\n", 1.0) else { panic!("points") };
        assert_eq!(p, vec![(2, Vec3::new(25.4, 50.8, 0.0))]);
        let Ok(Artwork::Points(p, _)) = read("a.csv", b"1;2;3\n", 10.0) else { panic!("points") };
        assert_eq!(p[0].1, Vec3::new(10.0, 20.0, 30.0));
        for (text, what) in [
            ("x,z\n1,2\n", "must be x, y"),
            ("x,y\n1,a\n", "line 2: 'a' is not a number"),
            ("x,y\n", "no points"),
            ("x_m,y_m\n1,1e308\n", "line 2: a coordinate is not a finite number of mm"),
        ] {
            let e = read("a.csv", text.as_bytes(), 1.0).expect_err(text).to_string();
            assert!(e.contains(what), "{e}");
        }
    }

    #[test]
    fn rows_without_a_place_are_read_as_they_were_written() {
        let row = |line, part: &str, place, distance| PointRow { line, part: part.into(), place, distance };
        let rows =
            [row(2, "A", Some(Vec3::new(1.0, 2.0, 0.0)), 0.0), row(3, "A", None, 5.25), row(4, "", None, f64::NAN)];
        for flat in [true, false] {
            let Ok(Artwork::Points(p, blank)) = read("a.csv", &csv(&rows, flat), 1.0) else { panic!("points") };
            assert_eq!((p, blank), (vec![(2, Vec3::new(1.0, 2.0, 0.0))], vec![3, 4]));
        }
        assert!(read("a.csv", b"x,y,z\n1,,3\n", 1.0).is_err());
    }

    #[test]
    fn drawings_read_back_as_they_were_written() {
        let line = vec![Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0), Vec3::new(4.0, 9.0, 6.5)];
        let bytes = dxf(&[("a b".into(), line.clone())], false);
        let Ok(Artwork::Curves(rails, _)) = read("a.dxf", &bytes, 1.0) else { panic!("curves") };
        assert_eq!(rails.len(), 1);
        assert!((rails[0].length() - (27.0_f64.sqrt() + 16.25_f64.sqrt())).abs() < 1e-9);
    }

    #[test]
    fn only_files_of_the_written_form_are_taken_for_written_ones() {
        let row = |place: Option<Vec3>| PointRow { line: 2, part: "A \"left\", 1".into(), place, distance: 0.25 };
        let rows = [row(Some(Vec3::new(1.0, -2.5, 1e6))), row(None)];
        let line = vec![Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 5e7, 6.0)];
        let files =
            [true, false].map(|flat| [csv(&rows, flat), csv(&[], flat), dxf(&[("a b".into(), line.clone())], flat)]);
        for file in files.iter().flatten() {
            let text = String::from_utf8(file.clone()).expect("text");
            assert!(is_as_written(file), "{text}");
            let added = text.clone() + "999\nmine\n";
            let edited = text.replacen("8\na_b\n", "8\na_b\n62\n5\n", 1).replacen("x_mm", "x", 1);
            assert!(!is_as_written(added.as_bytes()) && !is_as_written(edited.as_bytes()), "{text}");
        }
        let others = [
            "",
            "precious",
            "x,y,z\n1,2,3\n",
            "line,part,x_mm,y_mm,distance_mm\nmy own notes\n",
            "0\nSECTION\n0\nEOF\n",
        ];
        assert!(others.iter().all(|text| !is_as_written(text.as_bytes())));
    }
}
