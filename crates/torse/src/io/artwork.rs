//! Artwork: points in tables and curves in drawings, read, and written in the same kind after they were carried over.

use crate::answer::note::reader::ReaderNote;
pub use crate::develop::refold::artwork::PointRow;
use crate::geom::Vec3;
pub use crate::io::artwork_drawing::dxf;
use crate::io::artwork_drawing::is_drawing_as_written;
pub use crate::io::curves::Sketch;
use crate::io::curves::{sketch, CurveError, CurveOptions};
use crate::io::table::{self, Fault};
use std::fmt::Write as _;

/// A file of artwork.
#[derive(Clone, Debug)]
pub enum Artwork {
    /// Points of a table, mm, each with its line, and the lines of rows without a place: points that lay on no part before.
    Points(Vec<(usize, Vec3)>, Vec<usize>),
    /// Curves, points and texts of a drawing, with what was not read of it.
    Drawing(Sketch, Vec<ReaderNote>),
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
        let options = CurveOptions::new(name);
        let (all, notes) = match sketch(bytes, &options) {
            Err(CurveError::NoUnit(_)) => sketch(bytes, &CurveOptions { unit: Some(unit), ..options })?,
            other => other?,
        };
        return Ok(Artwork::Drawing(all, notes));
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

/// Digits of coordinates after the point.
const DIGITS: usize = 9;

/// Whether a file is, to the last line, of the form that [`csv`] writes, or to the last letter as [`dxf`] wrote it. What other programs
/// have written or somebody has changed is not.
pub fn is_as_written(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).is_ok_and(is_table_as_written) || is_drawing_as_written(bytes)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::artwork::{Placed, PlacedShape, Shape, Style, Words};

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

    fn drawing(flat: bool) -> Vec<u8> {
        let style = Style { layer: "Größe 1".into(), colour: Some(3) };
        let points = vec![Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0), Vec3::new(4.0, 9.0, 6.5)];
        let words = Words {
            text: "Spant №7".into(),
            at: Vec3::new(7.0, -8.0, 9.0),
            way: Vec3::new(0.6, 0.0, 0.8),
            normal: Vec3::new(0.8, 0.0, -0.6),
            height: 5.0,
            stretch: 0.9,
            slant: 15.0,
            held: [1, 2],
        };
        let shapes = [
            PlacedShape::Line { points: points.clone(), closed: true },
            PlacedShape::Line { points, closed: false },
            PlacedShape::Point(Vec3::new(0.25, 0.5, -1.0)),
            PlacedShape::Words(words),
        ];
        let placed: Vec<Placed> =
            shapes.map(|shape| Placed { part: "A-01".into(), style: style.clone(), shape }).into_iter().collect();
        dxf(&placed, &[("Größe 1".into(), 5)], flat)
    }

    #[test]
    fn drawings_read_back_as_they_were_written() {
        let Ok(Artwork::Drawing(sketch, notes)) = read("a.dxf", &drawing(false), 1.0) else { panic!("a drawing") };
        assert_eq!((sketch.items.len(), notes.len()), (4, 0), "{notes:?}");
        assert!(sketch.items.iter().all(|i| i.style.layer == "Größe 1" && i.style.colour == Some(3)));
        assert_eq!(sketch.layers, [("Größe 1".to_owned(), 5)]);
        let count = |k: usize| match &sketch.items[k].shape {
            Shape::Curves(all) => all.len(),
            _ => 0,
        };
        assert_eq!([count(0), count(1)], [3, 2], "the closed one goes back");
        assert_eq!(sketch.items[2].shape, Shape::Point(Vec3::new(0.25, 0.5, -1.0)));
        let Shape::Words(words) = &sketch.items[3].shape else { panic!("a text") };
        assert_eq!((words.text.as_str(), words.held), ("Spant №7", [1, 2]));
        assert!((words.at - Vec3::new(7.0, -8.0, 9.0)).norm() < 1e-8);
        assert!((words.way - Vec3::new(0.6, 0.0, 0.8)).norm() < 1e-8);
        assert!((words.normal - Vec3::new(0.8, 0.0, -0.6)).norm() < 1e-8);
    }

    #[test]
    fn only_files_of_the_written_form_are_taken_for_written_ones() {
        let row = |place: Option<Vec3>| PointRow { line: 2, part: "A \"left\", 1".into(), place, distance: 0.25 };
        let rows = [row(Some(Vec3::new(1.0, -2.5, 1e6))), row(None)];
        let files = [true, false].map(|flat| [csv(&rows, flat), csv(&[], flat), drawing(flat)]);
        for file in files.iter().flatten() {
            let text: String = file.iter().map(|b| char::from(*b)).collect();
            assert!(is_as_written(file), "{text}");
            let added = text.clone() + "999\nmine\n";
            let edited = text.replacen("62\n3\n", "62\n4\n", 1).replacen("x_mm", "x", 1);
            let bytes = |text: &str| -> Vec<u8> { text.chars().map(|c| c as u8).collect() };
            assert!(!is_as_written(&bytes(&added)) && !is_as_written(&bytes(&edited)), "{text}");
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
