//! `torse map`: artwork carried between parts in space and their flat patterns.

use crate::args::{Map, To};
use crate::failure::Failure;
use crate::folder::{is_of_result, is_same_file, LoneFile};
use crate::input::contents;
use crate::refold::file_of;
use std::io::Write as _;
use torse::answer::note::{Note, ReaderNote};
use torse::io::artwork::{self, Artwork, PointRow, Sketch};
use torse::io::words;
use torse::pipeline::map_artwork::{read_map, ArtworkMap, Carried, Item, MapError, Off, Side};

/// Points on no part that are told one by one.
const TOLD: usize = 20;

/// Runs the job; `Ok(true)` means that all was carried over.
pub fn run(arguments: &Map) -> Result<bool, Failure> {
    refuse_own(arguments)?;
    let output = LoneFile::prepare(&arguments.out, arguments.force, artwork::is_as_written)?;
    let name = arguments.artwork.display().to_string();
    let artwork = artwork::read(&name, &contents(&arguments.artwork)?, arguments.unit.unwrap_or(1.0))
        .map_err(|e| Failure::new(e.to_string(), "give a table of points (x, y, z) or a drawing of curves (DXF)"))?;
    refuse_kind(arguments, &artwork)?;
    let file = file_of(&arguments.folder)?;
    let mut map = read_map(&file, arguments.part.as_deref(), arguments.within.as_ref().map(|l| l.mm)).map_err(|e| {
        let hint = match &e {
            MapError::Part { .. } => "name one of these",
            _ => "give a folder as another command wrote it, with all its files",
        };
        Failure::new(format!("{}: {e}", arguments.folder.display()), hint)
    })?;
    map.chord = arguments.chord.as_ref().map_or(map.chord, |l| l.mm);
    let to = match arguments.to {
        To::Flat => Side::Flat,
        To::Space => Side::Space,
    };
    let (notes, (bytes, mut told)) = match artwork {
        Artwork::Points(points, blank) => {
            let notes = passed_on(&blank).into_iter().chain(heights(&points, to)).collect();
            (notes, carried_points(&map, &points, &blank, to))
        }
        Artwork::Drawing(sketch, notes) => (worded(notes), carried_drawing(&map, &sketch, to)),
    };
    told.extend(map.left.iter().map(|(name, reason)| format!("left out: {name}: {reason}")));
    let written = output.finish(&bytes)?;
    // A closed pipe is no reason to fail after the work is done.
    let mut out = std::io::stdout().lock();
    for note in &notes {
        let _ = writeln!(out, "  note: {note}");
    }
    for line in &told {
        let _ = writeln!(out, "  {line}");
    }
    let _ = writeln!(out, "  written {}", written.display());
    Ok(told.is_empty())
}

/// What was said of a drawing, in words.
fn worded(notes: Vec<ReaderNote>) -> Vec<String> {
    words::notes(&notes.into_iter().map(Note::Input).collect::<Vec<_>>())
}

/// Refuses a place that is the artwork itself or a file of the result, under whatever name.
fn refuse_own(arguments: &Map) -> Result<(), Failure> {
    let (out, help) = (&arguments.out, "choose another name with --out");
    if is_same_file(out, &arguments.artwork) {
        return Err(Failure::new(
            format!("'{}' is the input file '{}'", out.display(), arguments.artwork.display()),
            help,
        ));
    }
    if is_of_result(out, &arguments.folder) {
        return Err(Failure::new(
            format!(
                "'{}' is a file of the result in '{}', or has a name of one",
                out.display(),
                arguments.folder.display()
            ),
            help,
        ));
    }
    Ok(())
}

/// Refuses a name that says that it is of the other kind: tables of points stay tables, drawings drawings.
fn refuse_kind(arguments: &Map, artwork: &Artwork) -> Result<(), Failure> {
    let (wanted, other) = match artwork {
        Artwork::Points(..) => (("a table of points", "csv"), "dxf"),
        Artwork::Drawing(..) => (("a drawing", "dxf"), "csv"),
    };
    if !arguments.out.extension().is_some_and(|e| e.eq_ignore_ascii_case(other)) {
        return Ok(());
    }
    let (kind, ending) = wanted;
    let (out, given) = (arguments.out.display(), arguments.artwork.display());
    Err(Failure::new(
        format!("'{out}' is no name for {kind}, which comes of '{given}'"),
        format!("choose a name that ends in .{ending}"),
    ))
}

/// A note on third coordinates in the plane.
fn heights(points: &[(usize, torse::geom::Vec3)], to: Side) -> Option<String> {
    let high = || points.iter().filter(|p| to == Side::Space && p.1.z != 0.0);
    let (line, _) = high().next()?;
    Some(format!("patterns are plane: z of {} points is not used, the first in line {line}", high().count()))
}

/// A note on rows without a place.
fn passed_on(blank: &[usize]) -> Vec<String> {
    let lines: Vec<String> = blank.iter().take(TOLD).map(ToString::to_string).collect();
    let more = if blank.len() > TOLD { " and more" } else { "" };
    let note = || format!("passed on as they are, without a place: lines {}{more}", lines.join(", "));
    (!blank.is_empty()).then(note).into_iter().collect()
}

fn carried_points(
    map: &ArtworkMap,
    points: &[(usize, torse::geom::Vec3)],
    blank: &[usize],
    to: Side,
) -> (Vec<u8>, Vec<String>) {
    let mut rows = map.points(points, to);
    let off: Vec<_> = rows.iter().filter(|r| r.place.is_none()).collect();
    let mut told: Vec<String> = off
        .iter()
        .take(TOLD)
        .map(|r| format!("line {}: the point lies on no part; the nearest is {:.4} mm away", r.line, r.distance))
        .collect();
    if off.len() > TOLD {
        told.push(format!("and {} more points lie on no part", off.len() - TOLD));
    }
    rows.extend(blank.iter().map(|&line| PointRow { line, part: String::new(), place: None, distance: f64::NAN }));
    rows.sort_by_key(|r| r.line);
    (artwork::csv(&rows, to == Side::Flat), told)
}

fn carried_drawing(map: &ArtworkMap, sketch: &Sketch, to: Side) -> (Vec<u8>, Vec<String>) {
    let carried: Vec<Carried> = sketch.items.iter().map(|item| map.item(item, to)).collect();
    let off: Vec<String> = sketch.items.iter().zip(&carried).filter_map(|(i, c)| Some(told(i, &c.off?))).collect();
    let mut lines: Vec<String> = off.iter().take(TOLD).cloned().collect();
    if off.len() > TOLD {
        lines.push(format!("and {} more lie on no part, in whole or in part", off.len() - TOLD));
    }
    let placed: Vec<_> = carried.into_iter().flat_map(|c| c.placed).collect();
    (artwork::dxf(&placed, &sketch.layers, to == Side::Flat), lines)
}

/// What is said of something that lies on no part.
fn told(item: &Item, off: &Off) -> String {
    let (name, layer) = (&item.name, &item.style.layer);
    if off.length > 0.0 {
        let (length, away) = (off.length, off.farthest);
        return format!("{name} on layer '{layer}': about {length:.3} mm lie on no part, up to {away:.4} mm away");
    }
    format!("{name} on layer '{layer}': it lies on no part; the nearest is {:.4} mm away", off.farthest)
}
