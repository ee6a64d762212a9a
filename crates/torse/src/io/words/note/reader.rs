//! What readers say of their files, in words.

use crate::answer::note::reader::{AnnotationKind, ArchiveTable, EndMark, ReaderNote, UnitNote};
use crate::io::words::reason::left_out;

/// A note of a reader in words.
pub(in crate::io) fn reader_note(note: &ReaderNote) -> String {
    match note {
        ReaderNote::NoEnd(mark) => {
            format!("the file {}: it may be truncated, though nothing is known to be missing", without(*mark))
        }
        ReaderNote::NoRecords { stretches, line } => {
            format!("{stretches} stretches of text are not records and were passed over, the first in line {line}")
        }
        ReaderNote::NoSection { lines, line } => {
            format!("{lines} lines belong to no section and were passed over, the first is line {line}")
        }
        ReaderNote::Repeated { count, first } => format!(
            "{count} entity numbers are given to different records, the first #{first}; the first of each is used"
        ),
        ReaderNote::HalfEntries { lines } => {
            format!("{lines} lines of the directory have lost the other half of their entry")
        }
        ReaderNote::OpenData { entities } => format!("the data of {entities} entities have no end"),
        ReaderNote::Entry { table, number, reason } => format!("{} {number} cannot be read: {reason}", entry(*table)),
        ReaderNote::Object { name, reason } => format!("{name}: {reason}"),
        ReaderNote::LeftOut(skipped) => left_out(skipped),
        ReaderNote::Unit(note) => unit(note),
        ReaderNote::Unplaced { part } => {
            let name = part.as_deref().unwrap_or("a part");
            format!("nothing says where {name} goes in its assembly; it is read where it was drawn")
        }
        ReaderNote::NoTop => "the assembly has no top: every part is placed in another".into(),
        ReaderNote::Strays { faces } => format!(
            "no shape representation leads to a face (is the file complete?); its {faces} faces are read without assembly \
             placements"
        ),
        ReaderNote::Orphans { count } => format!(
            "surfaces that are marked as parts of others, though nothing refers to them, and are read as faces: {count}"
        ),
        ReaderNote::HiddenFaces { count } => {
            format!("faces that are hidden (blanked) in the file, and read all the same: {count}")
        }
        ReaderNote::HiddenObjects { count } => {
            format!("{count} objects are hidden or on layers that are switched off; they are left out")
        }
        ReaderNote::ShiftedAndTurned { first, count } => format!(
            "copies of parts that are both shifted and turned, D{first} first: {count}; the turn is taken last, as the standard \
             says of all data, but some programs take the shift last"
        ),
        ReaderNote::Triangles { entity } => {
            format!("the triangles of #{entity} are not read: annotations are drawn so")
        }
        ReaderNote::NotFinite { item } => format!("the curve {item} is not finite where it is put"),
        ReaderNote::FreeCurve { reason } => format!("a curve beside the faces is not read: {reason}"),
        ReaderNote::TooManyCopies => {
            "the blocks of the file copy too many curves; the last copies are left out".into()
        }
        ReaderNote::EndlessMeshes => "corners of meshes lie endlessly far away".into(),
        ReaderNote::Annotations(kinds) => annotations(kinds),
        ReaderNote::AnnotationsNotRead { count } => format!(
            "{count} annotations (texts, dimensions) are not read, and not carried to flat patterns; points, text dots and curves \
             are"
        ),
        ReaderNote::NotRead { file, kinds } => not_read(file, kinds),
        ReaderNote::NoLines { file, curves } => {
            format!("not read of {file}: {curves} curves that are no single straight lines")
        }
        ReaderNote::NoLength { file, curves } => format!("left out of {file}: {curves} curves without length"),
        ReaderNote::TakenApart { file, insertions } => {
            format!("taken apart in {file}: {insertions} insertions of blocks (INSERT)")
        }
        ReaderNote::DrawnTwice { file, again, first, more } => {
            let more = if *more > 0 { format!(" (and {more} more)") } else { String::new() };
            format!("{file}: #{again} is drawn over #{first}{more}; it counts once")
        }
        ReaderNote::SeveralPlaces { file, edge, places } => {
            format!("#{edge} of {file} lies at {places} places; the first is taken, #{edge}/2 is the next")
        }
    }
}

/// What is said of a file without its end.
fn without(mark: EndMark) -> &'static str {
    match mark {
        EndMark::Endsec => "ends without ENDSEC",
        EndMark::LastLine => "has no last line (T)",
    }
}

/// What an entry of a table is called.
fn entry(table: ArchiveTable) -> &'static str {
    match table {
        ArchiveTable::Layer => "layer",
        ArchiveTable::Block => "block",
    }
}

fn unit(note: &UnitNote) -> String {
    match note {
        UnitNote::Missing => "the file states no length unit; millimetres are assumed".into(),
        UnitNote::Inches => "the file states no length unit, which means inches by the standard".into(),
        UnitNote::Unknown { name } => format!("the length unit {name:?} is not known; millimetres are assumed"),
        UnitNote::Differ { flag, name } => {
            format!("the unit's flag says {flag}, its name {name:?}; the flag is used")
        }
        UnitNote::Mixed => "the parts of the file have different length units".into(),
        UnitNote::NoSettings => "the file has no settings of units".into(),
        UnitNote::Scale { scale, millimetres } => format!(
            "the file is drawn at the scale {scale}; lengths are those of the real part, {millimetres} mm for each number"
        ),
        UnitNote::Guessed { file } => {
            format!("{file} does not say its unit: its numbers were taken as mm; --unit says what they are")
        }
    }
}

fn annotations(kinds: &[(AnnotationKind, usize)]) -> String {
    let told = kinds.iter().map(|(kind, count)| {
        let (one, many) = annotation(*kind);
        format!("{count} {}", if *count == 1 { one } else { many })
    });
    let told: Vec<String> = told.collect();
    let list = match told.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => told.concat(),
    };
    format!("annotations are not carried to flat patterns: {list}")
}

/// What people call an annotation, and several.
fn annotation(kind: AnnotationKind) -> (&'static str, &'static str) {
    match kind {
        AnnotationKind::Text => ("text", "texts"),
        AnnotationKind::Drawn => ("drawn annotation", "drawn annotations"),
        AnnotationKind::LeaderLine => ("leader line", "leader lines"),
        AnnotationKind::DimensionLine => ("dimension line", "dimension lines"),
        AnnotationKind::Symbol => ("symbol", "symbols"),
        AnnotationKind::FilledArea => ("filled area", "filled areas"),
        AnnotationKind::Line => ("annotation line", "annotation lines"),
        AnnotationKind::Dimension => ("dimension", "dimensions"),
        AnnotationKind::Label => ("label", "labels"),
        AnnotationKind::Note => ("note", "notes"),
    }
}

fn not_read(file: &str, kinds: &[(String, usize)]) -> String {
    let list: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let blocks =
        if kinds.iter().any(|k| k.0 == "INSERT") { "; explode blocks (INSERT) to have their curves" } else { "" };
    format!("not read of {file}: {}{blocks}", list.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn annotations_are_counted_by_kinds() {
        let told = |kinds: &[(AnnotationKind, usize)]| reader_note(&ReaderNote::Annotations(kinds.to_vec()));
        let one = told(&[(AnnotationKind::Text, 1)]);
        assert_eq!(one, "annotations are not carried to flat patterns: 1 text");
        let three = told(&[(AnnotationKind::Text, 2), (AnnotationKind::Symbol, 1), (AnnotationKind::Note, 3)]);
        assert!(three.ends_with(": 2 texts, 1 symbol and 3 notes"), "{three}");
    }

    #[test]
    fn blocks_that_are_not_read_can_be_exploded() {
        let told =
            |kind: &str| reader_note(&ReaderNote::NotRead { file: "a.dxf".into(), kinds: vec![(kind.into(), 2)] });
        assert_eq!(told("MTEXT"), "not read of a.dxf: 2 MTEXT");
        assert_eq!(told("INSERT"), "not read of a.dxf: 2 INSERT; explode blocks (INSERT) to have their curves");
    }
}
