//! A folder of results read back: parts with their drawings and bend tables, as `report.json`, `patterns.dxf` (or
//! `patterns.svg`), `bends.csv` and `bend_table.csv` have them.

mod agreement;
mod tables;

use crate::answer::Job;
use crate::develop::unfold::bends::BendKind;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::io::bends::FLAT;
use crate::io::drawings;
use crate::io::json::{PartRecord, Report, SCHEMA};
use crate::patchwork::pattern::{Bend, BendSense, ViewSide};
use crate::patchwork::written::{WrittenArc, WrittenContour, WrittenPiece};
use std::f64::consts::TAU;
use tables::PRINTED_ANGLE;
pub use tables::{TableBend, TableLine};

/// Why a folder cannot be used at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FolderError {
    /// No result.
    #[error("report.json is missing: this is no folder of a result")]
    NoReport,
    /// A file that says something else than it should.
    #[error("{file}: {reason}")]
    File {
        /// Its name.
        file: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A result of another version.
    #[error("report.json has the schema '{0}'; this program reads {SCHEMA}")]
    Schema(String),
    /// No drawing.
    #[error("patterns.dxf and patterns.svg are missing")]
    NoDrawing,
    /// No part that can be used.
    #[error("no part can be used; the first, {name}: {reason}")]
    Nothing {
        /// Name of the first part.
        name: String,
        /// Why it cannot.
        reason: String,
    },
}

/// A part of a result.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultPart {
    /// What the report says of it.
    pub record: PartRecord,
    /// The side from which it is drawn, where the report says one.
    pub view: Option<ViewSide>,
    /// Outlines in mm: places and bulges.
    pub contours: Vec<Vec<(Vec2, f64)>>,
    /// Bend lines in the order of the table, mm, with what `bends.csv` says.
    pub lines: Vec<([Vec2; 2], TableLine)>,
    /// The same lines with the unrounded numbers of the report, where these agree with the table.
    pub exact: Option<Vec<Bend>>,
    /// Bends of sheet metal.
    pub bends: Vec<TableBend>,
    /// Lines where these begin and end, mm.
    pub extents: Vec<[Vec2; 2]>,
    /// The last digit that `bend_table.csv` prints of lengths, mm.
    pub printed: f64,
}

/// A result.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    /// The report.
    pub report: Report,
    /// The job that made it.
    pub job: Job,
    /// Parts that can be used.
    pub parts: Vec<ResultPart>,
    /// Parts that cannot, with the reason.
    pub left: Vec<(String, String)>,
    /// What was noticed.
    pub notes: Vec<String>,
}

/// Places that the table prints of a length, and what the last of them leaves open, mm.
const PRINTED: f64 = 1.1e-3;
/// As much where lengths are measured in a drawing, which another program may have rounded to three decimals, mm.
const DRAWN: f64 = 2e-3;
/// The last digit of lengths in `bend_table.csv`.
const LAST_DIGIT: f64 = 1e-4;
/// Reads a folder; `file` answers the bytes of a file by its name, if it is there.
///
/// # Errors
/// See [`FolderError`]: what concerns single parts stands in `left`.
pub fn read(file: &dyn Fn(&str) -> Option<Vec<u8>>) -> Result<ResultFolder, FolderError> {
    let bytes = file("report.json").ok_or(FolderError::NoReport)?;
    let fault = |file: &'static str, reason: String| FolderError::File { file, reason };
    let value: serde_json::Value =
        serde_json::from_slice(&bytes).map_err(|e| fault("report.json", format!("it is no JSON: {e}")))?;
    let schema = value.get("schema").and_then(|s| s.as_str()).unwrap_or("").to_owned();
    if schema != SCHEMA {
        return Err(FolderError::Schema(schema));
    }
    let report: Report = serde_json::from_value(value).map_err(|e| fault("report.json", e.to_string()))?;
    let job = Job::named(&report.job)
        .ok_or_else(|| fault("report.json", format!("'{}' is no job of this program", report.job)))?;
    let mut notes = Vec::new();
    let pieces = drawing(file, &mut notes)?;
    let drawn: Vec<&PartRecord> = report.parts.iter().filter(|p| p.missing.is_empty()).collect();
    if pieces.len() != drawn.len() {
        let reason = format!("it holds {} parts, but report.json {}", pieces.len(), drawn.len());
        return Err(fault("patterns.dxf", reason));
    }
    let lines = match file("bends.csv") {
        Some(bytes) => Some(bend_lines(&String::from_utf8_lossy(&bytes)).map_err(|r| fault("bends.csv", r))?),
        None => None,
    };
    let bends = match file("bend_table.csv") {
        Some(bytes) => sheet_bends(&String::from_utf8_lossy(&bytes)).map_err(|r| fault("bend_table.csv", r))?,
        // Panels that cover faces have bend lines and no bends of sheet.
        None if drawn.iter().any(|p| !p.sheet_bends.is_empty()) => {
            return Err(fault("bend_table.csv", "it is missing; report.json has bends of sheet".into()));
        }
        None => Vec::new(),
    };
    let mut out = ResultFolder { report: report.clone(), job, parts: Vec::new(), left: Vec::new(), notes };
    for p in report.parts.iter().filter(|p| !p.missing.is_empty()) {
        out.left.push((p.name.clone(), format!("it has no flat pattern: {}", p.missing)));
    }
    for (piece, record) in pieces.iter().zip(drawn) {
        let own = |name: &str| lines.as_ref().map(|l| of_part(l, name));
        match part(piece, record, own(&record.name), of_part(&bends, &record.name)) {
            Ok(p) => {
                if p.exact.is_none() && !p.lines.is_empty() {
                    out.notes.push(format!("{}: report.json and bends.csv differ; the table is used", p.record.name));
                }
                out.parts.push(p);
            }
            Err(reason) => out.left.push((record.name.clone(), reason)),
        }
    }
    match (out.parts.is_empty(), out.left.first()) {
        (true, Some((name, reason))) => Err(FolderError::Nothing { name: name.clone(), reason: reason.clone() }),
        (true, None) => Err(FolderError::Nothing { name: "parts".into(), reason: "the report lists none".into() }),
        _ => Ok(out),
    }
}

/// The cutting drawing: DXF, else SVG.
fn drawing(file: &dyn Fn(&str) -> Option<Vec<u8>>, notes: &mut Vec<String>) -> Result<Vec<WrittenPiece>, FolderError> {
    let dxf = file("patterns.dxf");
    // Not damaged but changed: the other drawing is not what somebody may cut by.
    if let Some(reason) = dxf.as_deref().and_then(drawings::turned_over) {
        return Err(FolderError::File { file: "patterns.dxf", reason });
    }
    match (dxf, file("patterns.svg")) {
        (Some(dxf), svg) => match (drawings::dxf(&dxf), svg.map(|s| drawings::svg(&s))) {
            (Ok(pieces), _) => Ok(pieces),
            (Err(reason), Some(Ok(pieces))) => {
                notes.push(format!("patterns.dxf is damaged ({reason}); patterns.svg is used"));
                Ok(pieces)
            }
            (Err(reason), _) => Err(FolderError::File { file: "patterns.dxf", reason }),
        },
        (None, Some(svg)) => drawings::svg(&svg).map_err(|reason| FolderError::File { file: "patterns.svg", reason }),
        (None, None) => Err(FolderError::NoDrawing),
    }
}

/// Rows of one part.
fn of_part<T: Clone>(rows: &[(String, T)], name: &str) -> Vec<T> {
    rows.iter().filter(|r| r.0 == name).map(|r| r.1.clone()).collect()
}

/// One part: its drawing and its tables brought together.
fn part(
    piece: &WrittenPiece,
    record: &PartRecord,
    table: Option<Vec<TableLine>>,
    mut bends: Vec<TableBend>,
) -> Result<ResultPart, String> {
    let mm = piece.unit.mm();
    let contours = piece.contours.iter().map(|c| contour(c, mm)).collect();
    let count = piece.rulings.len();
    let table = match table {
        Some(t) => t,
        None if count == 0 => Vec::new(),
        None => return Err(format!("bends.csv is missing; the drawing has {count} bend lines")),
    };
    if table.len() != count {
        return Err(format!("bends.csv has {} lines for it, the drawing {count}", table.len()));
    }
    // Drawings have the lines by layer, each layer in the order of the table.
    let mut lines = Vec::with_capacity(count);
    let mut used = vec![false; count];
    for (k, row) in table.iter().enumerate() {
        let next = (0..count).find(|i| !used[*i] && piece.senses[*i] == row.bend.sense);
        let i = next.ok_or_else(|| {
            format!(
                "line {} of bends.csv bends {}, but the drawing has no further line of this kind",
                k + 1,
                row.bend.sense.name()
            )
        })?;
        used[i] = true;
        let ends = piece.rulings[i].map(|p| p * mm);
        let length = (ends[1] - ends[0]).norm();
        if (length - row.length).abs() > DRAWN * mm {
            return Err(format!(
                "line {} is {} mm long in bends.csv, but {length:.3} mm in the drawing",
                k + 1,
                row.length
            ));
        }
        lines.push((ends, row.clone()));
    }
    let exact = exact(record, &table, mm);
    let mut first = 0;
    for b in &mut bends {
        b.lines = first..first + b.lines.len();
        first = b.lines.end;
    }
    if !bends.is_empty() && first != count {
        return Err(format!("bend_table.csv counts {first} lines, the drawing {count}"));
    }
    agreement::sheet(&table, &bends)?;
    agreement::report(&table, &record.bends, !bends.is_empty())?;
    let extents = piece.extents.iter().map(|e| e.map(|p| p * mm)).collect();
    let view = ViewSide::named(&record.view);
    Ok(ResultPart { record: record.clone(), view, contours, lines, exact, bends, extents, printed: LAST_DIGIT * mm })
}

/// The report's numbers for the lines, if they are those of the table up to its digits.
fn exact(record: &PartRecord, table: &[TableLine], mm: f64) -> Option<Vec<Bend>> {
    if record.bends.len() != table.len() {
        return None;
    }
    let near = |a: f64, b: f64| (a.is_infinite() && b.is_infinite()) || (a - b).abs() <= PRINTED * mm;
    let pairs = record.bends.iter().zip(table).map(|(r, t)| {
        let radii = r.radii.map(|r| r.unwrap_or(f64::INFINITY));
        let same = (r.angle_deg - t.bend.angle.to_degrees()).abs() <= PRINTED_ANGLE
            && r.sense == t.bend.sense.name()
            && (0..2).all(|k| near(radii[k], t.bend.radii[k]));
        let before = r.radii_before.map_or(radii, |b| b.map(|r| r.unwrap_or(f64::INFINITY)));
        let same = same
            && (r.turned_deg - t.bend.turned.to_degrees()).abs() <= PRINTED_ANGLE
            && (0..2).all(|k| near(before[k], t.bend.before[k]));
        let turned = r.turned_deg.to_radians();
        same.then(|| Bend { before, turned, ..Bend::of(t.bend.sense, r.angle_deg.to_radians(), radii) })
    });
    pairs.collect()
}

/// An outline in mm.
fn contour(written: &WrittenContour, mm: f64) -> Vec<(Vec2, f64)> {
    let joints = match written {
        WrittenContour::Joints(joints) => joints,
        // A hole, clockwise, in three arcs.
        WrittenContour::Circle { centre, radius } => {
            let third = |k: usize| -TAU * k as f64 / 3.0;
            let at = |k: usize| centre + Vec2::new(third(k).cos(), third(k).sin()) * *radius;
            return (0..3).map(|k| (at(k) * mm, -(TAU / 12.0).tan())).collect();
        }
    };
    (0..joints.len())
        .map(|k| {
            let (a, b) = (joints[k].point, joints[(k + 1) % joints.len()].point);
            let bulge = match joints[k].arc {
                WrittenArc::Bulge(b) => b,
                WrittenArc::Radius { radius, large, clockwise } => {
                    let half = (0.5 * (b - a).norm() / radius).clamp(0.0, 1.0).asin();
                    let sweep = if large { 2.0 * std::f64::consts::PI - 2.0 * half } else { 2.0 * half };
                    (0.25 * sweep).tan() * if clockwise { -1.0 } else { 1.0 }
                }
            };
            (a * mm, bulge)
        })
        .collect()
}

/// Cells of a line of a table that this program wrote: names stand in quotation marks.
fn cells(line: &str) -> Vec<String> {
    let (mut out, mut cell, mut quoted) = (Vec::new(), String::new(), false);
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' if quoted && rest.peek() == Some(&'"') => {
                cell.push('"');
                rest.next();
            }
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(std::mem::take(&mut cell)),
            _ => cell.push(c),
        }
    }
    out.push(cell);
    out
}

/// A table by the names of its columns; the unit of lengths stands in these.
struct Columns {
    names: Vec<String>,
    mm: f64,
}

impl Columns {
    fn of(head: &str) -> Self {
        let names = cells(head);
        let inch = names.iter().any(|n| n.ends_with("_in"));
        Self { names, mm: if inch { LengthUnit::Inch.mm() } else { 1.0 } }
    }

    /// The cell of a row by the beginning of its column's name.
    fn text<'a>(&self, row: &'a [String], name: &str) -> Result<&'a str, String> {
        let k = self.names.iter().position(|n| n.starts_with(name)).ok_or(format!("it has no column '{name}'"))?;
        row.get(k).map(|s| s.trim()).ok_or(format!("a row has no cell for '{name}'"))
    }

    fn number(&self, row: &[String], name: &str, empty: f64) -> Result<f64, String> {
        match self.text(row, name)? {
            "" => Ok(empty),
            t => t.parse().ok().filter(|x: &f64| x.is_finite()).ok_or(format!("'{t}' in column '{name}' is no number")),
        }
    }

    fn kind(&self, row: &[String]) -> Result<BendKind, String> {
        let name = self.text(row, "kind")?;
        BendKind::named(name).ok_or_else(|| format!("'{name}' is no kind of bend: bend, fold, hem or rolled"))
    }

    fn sense(&self, row: &[String]) -> Result<BendSense, String> {
        match self.text(row, "sense")? {
            "up" => Ok(BendSense::Up),
            "down" => Ok(BendSense::Down),
            "flat" => Ok(BendSense::Flat),
            other => Err(format!("'{other}' is no way to bend: up, down or flat")),
        }
    }
}

/// Rows of a table, each with the name of its part.
fn rows<T>(text: &str, row: impl Fn(&Columns, &[String]) -> Result<T, String>) -> Result<Vec<(String, T)>, String> {
    let mut lines = text.lines();
    let columns = Columns::of(lines.next().ok_or("it is empty")?);
    let each = |(k, line): (usize, &str)| {
        let cells = cells(line);
        let named = |e: String| format!("line {}: {e}", k + 2);
        Ok((columns.text(&cells, "part").map_err(named)?.to_owned(), row(&columns, &cells).map_err(named)?))
    };
    lines.enumerate().filter(|(_, l)| !l.trim().is_empty()).map(each).collect()
}

fn bend_lines(text: &str) -> Result<Vec<(String, TableLine)>, String> {
    rows(text, |c, row| {
        let radius = |name: &str| Ok::<f64, String>(c.number(row, name, f64::INFINITY)? * c.mm);
        let radii = [radius("radius_start")?, radius("radius_end")?];
        let angle = c.number(row, "angle_deg", f64::NAN)?.to_radians();
        if angle.is_nan() || angle < 0.0 {
            return Err("the angle is missing or negative".into());
        }
        let mut bend = Bend::of(c.sense(row)?, angle, radii);
        bend.turned = c.number(row, "turned_deg", f64::NAN)?.to_radians();
        if bend.turned.is_nan() {
            return Err("turned_deg, the turn up to the line, is missing".into());
        }
        for (k, name) in ["before_start", "before_end"].into_iter().enumerate() {
            bend.before[k] = match c.text(row, name)? {
                FLAT => f64::INFINITY,
                _ => c.number(row, name, radii[k] / c.mm)? * c.mm,
            };
        }
        let length = c.number(row, "length", f64::NAN)? * c.mm;
        if length.is_nan() {
            return Err("the length is missing".into());
        }
        Ok(TableLine { bend, length })
    })
}

fn sheet_bends(text: &str) -> Result<Vec<(String, TableBend)>, String> {
    rows(text, |c, row| {
        let count = c.text(row, "lines")?.parse::<u32>().ok().filter(|n| *n > 0);
        let count = count.ok_or("the number of lines is missing, or no whole number")?;
        Ok(TableBend {
            kind: c.kind(row)?,
            sense: c.sense(row)?,
            angle: c.number(row, "angle_deg", f64::NAN)?.to_radians(),
            inside_radius: c.number(row, "inside_radius", f64::NAN)? * c.mm,
            allowance: c.number(row, "allowance", f64::NAN)? * c.mm,
            k: c.number(row, "k_ansi", f64::NAN)?,
            lines: 0..count as usize,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_by_the_names_of_their_columns() {
        let text =
            "part,seen_from,line,sense,angle_deg,radius_start_in,radius_end_in,length_in,turned_deg,before_start_in,\
                    before_end_in\n\"a \"\"b\"\", c\",outside,1,down,0.5000,10.000,,2.000,-0.7500,flat,\n";
        let rows = bend_lines(text).expect("a row");
        assert_eq!(rows[0].0, "a \"b\", c");
        let line = &rows[0].1;
        assert_eq!((line.bend.sense, line.length), (BendSense::Down, 50.8));
        assert!(line.bend.radii[0] == 254.0 && line.bend.radii[1].is_infinite());
        assert!(line.bend.before[0].is_infinite() && line.bend.before[1].is_infinite());
        assert_eq!(line.bend.turned, -0.75f64.to_radians());
        assert!(bend_lines(&text.replace("-0.7500", "")).expect_err("no turn").contains("turned_deg"));
        assert!(bend_lines(&text.replace("2.000", "")).expect_err("no length").contains("length"));
        let fault = bend_lines(&text.replace("0.5000", "x")).expect_err("no number");
        assert!(fault.contains("line 2") && fault.contains("'x'"), "{fault}");
        assert!(bend_lines(&text.replace("down", "left")).is_err());
        assert!(bend_lines(&text.replace("angle_deg", "turn")).expect_err("a column").contains("'angle_deg'"));
    }

    #[test]
    fn bends_have_whole_numbers_of_lines() {
        let table = |lines: &str| {
            let head = "part,kind,sense,angle_deg,inside_radius_mm,allowance_mm,k_ansi,lines\n";
            sheet_bends(&format!("{head}a,bend,up,90,2,5,0.44,{lines}\n"))
        };
        assert_eq!(table("2").expect("a row")[0].1.lines, 0..2);
        for lines in ["", "0", "-1", "1.5", "1e300", "18446744073709551615"] {
            assert!(table(lines).expect_err(lines).contains("number of lines"), "{lines}");
        }
    }

    #[test]
    fn folders_without_a_result_are_refused_by_name() {
        assert_eq!(read(&|_| None).expect_err("nothing"), FolderError::NoReport);
        let other = |name: &str| (name == "report.json").then(|| b"{\"schema\": \"torse-report/9\"}".to_vec());
        assert_eq!(read(&other).expect_err("another"), FolderError::Schema("torse-report/9".into()));
        let broken = |name: &str| (name == "report.json").then(|| b"{".to_vec());
        assert!(matches!(read(&broken), Err(FolderError::File { file: "report.json", .. })));
    }
}
