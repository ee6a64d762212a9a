//! Files that are not as they should be.

use super::area;
use super::file::{entry, Entry, File};
use torse::io::iges::read::{self, ReadError};
use torse::io::words;
use torse::io::words::why;

fn two() -> File {
    let mut f = File::new();
    f.rectangle(entry(128), 3.0, 2.0);
    f.rectangle(entry(128), 1.0, 1.0);
    f
}

#[test]
fn other_files_are_named() {
    assert_eq!(read::read(b" \r\n").expect_err("empty"), ReadError::Empty);
    for (bytes, what) in [
        (&b"ISO-10303-21;\nHEADER;"[..], "STEP"),
        (b"0\nSECTION\n2\nHEADER\n", "DXF"),
        (b"PK\x03\x04 things", "ZIP"),
        (b"3D Geometry File Format ", "3DM"),
        (b"some words\nof nobody\n", "section"),
    ] {
        let e = read::read(bytes).expect_err("foreign");
        assert!(matches!(e, ReadError::NotIges(_)) && e.to_string().contains(what), "{e}");
    }
    let flag = format!("{:<72}C{:>7}\n", "", 1);
    let compressed = [flag.into_bytes(), two().bytes()].concat();
    assert_eq!(read::read(&compressed).expect_err("compressed"), ReadError::OtherForm("compressed ASCII"));
    assert_eq!(read::read(b"B\0\0\0\x30\x01\x02\x03\x04").expect_err("binary"), ReadError::OtherForm("binary"));
}

#[test]
fn truncated_files_are_refused_and_lost_last_lines_are_told() {
    let lines = two().lines();
    let n = lines.len();
    let text = |k: usize| lines[..k].join("\n");
    assert!(matches!(read::read(text(3).as_bytes()), Err(ReadError::Truncated(_))));
    assert!(matches!(read::read(text(7).as_bytes()), Err(ReadError::Truncated(_))));
    let e = read::read(text(n - 3).as_bytes()).expect_err("half of the data");
    assert!(e.to_string().contains("D3"), "{e}");
    let m = read::read(text(n - 1).as_bytes()).expect("a model");
    assert!(m.faces.len() == 2 && m.notes.iter().any(|n| words::note(n).contains("last line")), "{:?}", m.notes);
}

#[test]
fn a_lost_line_costs_what_needs_it() {
    let lines = two().lines();
    // The first line of the second surface's data.
    let lost = lines.iter().rposition(|l| l.starts_with("128,") && &l[72..73] == "P").expect("a line");
    let rest: Vec<&str> = (0..lines.len()).filter(|i| *i != lost).map(|i| lines[i].as_str()).collect();
    let m = read::read(rest.join("\n").as_bytes()).expect("a model");
    assert!((m.faces.len(), m.skipped.len()) == (1, 1) && m.skipped[0].entity == Some(3), "{:?}", m.skipped);
    // A line of the directory takes its entry with it; the others keep their numbers.
    let lost = lines.iter().position(|l| l.ends_with("D      2")).expect("a line");
    let rest: Vec<&str> = (0..lines.len()).filter(|i| *i != lost).map(|i| lines[i].as_str()).collect();
    let m = read::read(rest.join("\n").as_bytes()).expect("a model");
    assert_eq!(m.faces.iter().map(|f| f.entity).collect::<Vec<_>>(), [3]);
    assert!(m.skipped.iter().any(|s| s.entity == Some(1)), "{:?}", m.skipped);
}

#[test]
fn ends_of_lines_and_numbers_of_any_kind_are_read() {
    let mut f = File::new();
    f.add(
        entry(128),
        "1, 1,1,1,0,0,1,0,0,0.D0,0,1.0D+0,1.,,,1E000,1.,1.,1.,1.,1.,0.,0.,0.,3 . 0,0.,0.,0.,2.0E-000,,3.,.2D1,,0.,1.,0.,1.",
    );
    let lines = f.lines();
    for end in ["\n", "\r\n", "\r", "\n\n", ""] {
        let m = read::read(lines.join(end).as_bytes()).expect("a model");
        assert!((area(&m.faces[0]) - 6.0).abs() < 1e-12, "{end:?}");
    }
}

#[test]
fn bad_numbers_are_faults_of_their_entity() {
    for (bad, word) in [
        ("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,-1.,1.,1.,0.,0.,0.,3.,0.,0.,0.,2.,0.,3.,2.,0.", "weight"),
        ("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,x,0.,0.,0.,2.,0.,3.,2.,0.", "not a number"),
        ("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1E300,0.,0.,0.,2.,0.,3.,2.,0.", "absurd"),
        ("999999,999999,1,1,0,0,1,0,0,0.,0.", "999999 items"),
        ("1,1,30,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.", "30 items"),
        ("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.", "end early"),
        ("1,1,1,1,0,0,1,0,0,1.,0.,1.,0.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.,0.,0.,2.,0.,3.,2.,0.", "knot"),
    ] {
        let mut f = two();
        let id = f.add(entry(128), bad);
        let m = read::read(&f.bytes()).expect("a model");
        assert_eq!((m.faces.len(), m.skipped.len()), (2, 1), "{bad}");
        assert_eq!(m.skipped[0].entity, Some(id));
        let reason = why(&m.skipped[0].reason);
        assert!(reason.contains(word), "{reason}");
    }
    let mut f = File::new();
    f.add(entry(128), "1,1");
    assert!(matches!(read::read(&f.bytes()), Err(ReadError::NoUsableFaces { count: 1, entity: 1, .. })));
    let mut f = File::new();
    f.add(entry(110), "0.,0.,0.,1.,1.,1.");
    assert!(matches!(read::read(&f.bytes()), Err(ReadError::NoFaces { entities: 1, .. })));
}

#[test]
fn references_to_nothing_are_faults() {
    for (kind, data) in
        [(144, "77,1,0,79"), (143, "0,77,1,79"), (118, "77,79,0,0"), (120, "1,77,0.,1."), (186, "77,1,0")]
    {
        let mut f = two();
        let id = f.add(Entry { ..entry(kind) }, data);
        let m = read::read(&f.bytes()).expect("a model");
        assert!(m.skipped.iter().any(|s| s.entity == Some(id) || s.entity == Some(77)), "{kind}: {:?}", m.skipped);
    }
}
