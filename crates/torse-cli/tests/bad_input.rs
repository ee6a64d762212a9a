//! The program run as its users run it, on input that cannot be used: exit status 2, one clear message, no trace on
//! the disk.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

/// Runs `torse approximate` and checks that it refuses in good style; the message.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let mut before: Vec<_> = fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").file_name()).collect();
    let output = torse(folder, arguments);
    let mut after: Vec<_> = fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").file_name()).collect();
    before.sort();
    after.sort();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(message.starts_with("error: "), "{arguments:?}: {message}");
    assert_eq!(message.matches("error:").count(), 1, "{arguments:?}: {message}");
    assert!(!message.contains("panicked") && !message.contains("Error {"), "{arguments:?}: {message}");
    assert_eq!(message.matches("  help: ").count(), 1, "{arguments:?}: {message}");
    assert_eq!(message.trim_end().lines().count(), 2, "{arguments:?}: {message}");
    assert!(output.stdout.is_empty());
    assert_eq!(before, after, "{arguments:?} left something behind");
    message
}

fn room(name: &str, content: &[u8]) -> tempfile::TempDir {
    let room = tempfile::tempdir().expect("room");
    fs::write(room.path().join(name), content).expect("input");
    room
}

fn step(data: &str) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n"
    )
}

#[test]
fn tolerances_are_refused_with_the_reason() {
    let room = room("a.step", step("").as_bytes());
    for (tolerance, reason) in [
        ("2", "no unit"),
        ("0", "greater than zero"),
        ("0mm", "greater than zero"),
        ("-1mm", "greater than zero"),
        ("nan mm", "no number"),
        ("infmm", "no number"),
        ("3furlong", "unknown unit"),
        ("", "nothing"),
    ] {
        let message = refused(room.path(), &["approximate", "a.step", "--tolerance", tolerance, "--out", "o"]);
        assert!(message.contains(reason), "{tolerance}: {message}");
    }
    let message = refused(room.path(), &["approximate", "a.step", "--out", "o"]);
    assert!(message.contains("--tolerance"), "{message}");
}

#[test]
fn wrong_usage_is_refused_with_the_reason() {
    let room = room("a.step", step("").as_bytes());
    let whole = ["approximate", "a.step", "-t", "1mm", "-o", "o"];
    for (more, reason) in [
        (&["--max-panels", "0"][..], "at least 1"),
        (&["--max-panels", "-3"], "at least 1"),
        (&["--max-panels", "many"], "whole number"),
        (&["--time-limit", "0s"], "greater than zero"),
        (&["--time-limit", "5"], "no unit"),
        (&["--bogus"], "--bogus"),
    ] {
        let message = refused(room.path(), &[&whole[..], more].concat());
        assert!(message.contains(reason), "{more:?}: {message}");
    }
    assert!(refused(room.path(), &whole[..2]).contains("--out"));
    assert!(refused(room.path(), &["fold"]).contains("fold"));
}

#[test]
fn places_are_refused_with_the_reason() {
    let room = room("a.step", step("").as_bytes());
    let run = |file: &str, out: &str| refused(room.path(), &["approximate", file, "-t", "1mm", "-o", out]);
    assert!(run("missing.step", "o").contains("missing.step"));
    assert!(run(".", "o").contains("is a folder"));
    assert!(run("a.step", "missing/o").contains("does not exist"));
    assert!(run("a.step", "a.step/o").contains("not a folder"));
    assert!(run("a.step", "a.step").contains("not a folder"));
    assert!(run("a.step", ".").contains("folder you are working in") || run("a.step", ".").contains("no name"));
    fs::create_dir(room.path().join("o")).expect("folder");
    fs::write(room.path().join("o/report.json"), "{}").expect("file");
    assert!(run("a.step", "o").contains("--force"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_cannot_be_written_is_named() {
    let room = room("a.step", step("").as_bytes());
    let message = refused(room.path(), &["approximate", "a.step", "-t", "1mm", "-o", "/proc/torse-out"]);
    assert!(message.contains("/proc"), "{message}");
}

#[test]
fn files_that_hold_no_model_are_refused() {
    let point = "#1=CARTESIAN_POINT('',(0.,0.,0.));\n";
    let whole = step(point);
    let hull = include_bytes!("../../../data/hull.step");
    let text = String::from_utf8_lossy(hull).into_owned();
    // A control point of the surface, in many bad states.
    let (before, rest) = text.split_once("#89=CARTESIAN_POINT('',(6000.,").expect("a corner of the hull");
    let spoilt = |x: &str| format!("{before}#89=CARTESIAN_POINT('',({x},{rest}").into_bytes();
    let cases: &[(&str, Vec<u8>)] = &[
        ("empty", Vec::new()),
        ("text", b"solid hull\n facet normal 0 0 1\n".to_vec()),
        ("binary", (0..=255u8).cycle().take(4000).collect()),
        ("zip", b"PK\x03\x04aaaaaaaaaaaaaaa".to_vec()),
        ("no faces", whole.clone().into_bytes()),
        ("header only", step("").into_bytes()),
        ("truncated", whole.as_bytes()[..whole.len() / 3].to_vec()),
        ("hull cut off", hull[..4000].to_vec()),
        ("not a number", spoilt("NaN")),
        ("infinite", spoilt("1.E999")),
        ("absurdly far", spoilt("1.E300")),
        ("half a record", b"ISO-10303-21;\nDATA;\n#1=CARTESIAN_POINT('',(0.,".to_vec()),
    ];
    for (name, bytes) in cases {
        let room = room("model.step", bytes);
        let message = refused(room.path(), &["approximate", "model.step", "-t", "1mm", "-o", "o"]);
        assert!(message.contains("model.step"), "{name}: {message}");
        let message = refused(room.path(), &["info", "model.step"]);
        assert!(message.contains("model.step"), "{name}: {message}");
    }
}

#[test]
fn help_has_examples_and_is_no_error() {
    let room = room("a.step", b"");
    for command in [&["--help"][..], &["approximate", "--help"], &["info", "--help"]] {
        let output = torse(room.path(), command);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(0));
        assert!(text.contains("Example") && text.contains("torse "), "{text}");
    }
    assert_eq!(torse(room.path(), &["fold"]).status.code(), Some(2));
}

/// Points of a piece of a cylinder as x, y and z.
fn sheet() -> Vec<[f64; 3]> {
    let place = |k: u32| {
        let (s, c) = (0.025 * f64::from(k / 50)).sin_cos();
        [100.0 * s, 100.0 * c, 2.5 * f64::from(k % 50)]
    };
    (0..1200).map(place).collect()
}

/// The sheet as lines of a table.
fn rows(line: impl Fn(usize, [String; 3]) -> String) -> String {
    sheet().iter().enumerate().map(|(k, p)| line(k, p.map(|x| format!("{x:.4}"))) + "\n").collect()
}

#[test]
fn tables_are_read_by_their_headings_and_decimal_signs_or_refused() {
    let german = |x: String| x.replace('.', ",");
    for (name, table) in [
        ("ids", "id,x,y,z\n".to_string() + &rows(|k, [x, y, z]| format!("P{k},{x},{y},{z}"))),
        ("turned", "\u{feff}z;y;x\r\n".to_string() + &rows(|_, [x, y, z]| [z, y, x].map(german).join(";"))),
    ] {
        let room = room("a.csv", table.as_bytes());
        let output = torse(room.path(), &["fit", "a.csv", "-t", "0.1mm", "-o", "o"]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(0) && said.contains("for 1200 points"), "{name}: {said}");
    }
    for (table, reason) in [
        (rows(|k, [x, y, z]| format!("{k},{x},{y},{z}")), "line 1: there are 4 columns"),
        ("a,b,c,e\n1,2,3,4\n".into(), "the columns are named a, b, c, e; 3 of them must be x, y, z"),
        (rows(|_, p| p.map(german).join(",")), "separate the numbers by semicolons"),
        ("x [m],y [m],z [m]\n1,2,3\n".into(), "another unit than --unit"),
        ("1,2,3\n1,,2,3\n".into(), "line 2"),
        ("1,x,3\n".into(), "'x' is not a number"),
    ] {
        let room = room("a.csv", table.as_bytes());
        let message = refused(room.path(), &["fit", "a.csv", "--unit", "mm", "-t", "0.1mm", "-o", "o"]);
        assert!(message.contains("a.csv") && message.contains(reason), "{reason}: {message}");
    }
}

#[test]
fn points_of_control_nets_have_three_or_four_numbers() {
    for (point, count) in [("[1,2]", 2), ("[1,2,3,4,5,6]", 6)] {
        let net =
            format!("{{\"unit\":\"mm\",\"degree\":2,\"knots\":[0,0,0,1,1,1],\"points\":[[0,0,0],{point},[2,0,0]]}}");
        let room = room("net.json", net.as_bytes());
        let message = refused(room.path(), &["net", "net.json", "-t", "0.1mm", "-o", "o"]);
        assert!(message.contains(&format!("point 1 (counted from 0) has {count} numbers")), "{message}");
    }
}

#[test]
fn a_tolerance_larger_than_the_model_is_refused_by_every_job() {
    const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/");
    let data = |name: &str| format!("{DATA}{name}");
    let room = room("scan.csv", rows(|_, p| p.join(",")).as_bytes());
    let (square, round) = (data("duct_square.dxf"), data("duct_round.dxf"));
    for arguments in [
        vec!["approximate".into(), data("torus_piece.step")],
        vec!["cones".into(), data("cone_holes.step")],
        vec!["fit".into(), "scan.csv".into()],
        vec!["fit".into(), data("hood_strip.csv")],
        vec!["loft".into(), square.clone(), round.clone()],
        vec!["hull".into(), square, round],
        vec!["net".into(), data("keel_net.json")],
        vec!["planarise".into(), data("hood_strip.csv")],
    ] {
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(["-t", "90m", "-o", "o"]).collect();
        let message = refused(room.path(), &all);
        assert!(message.contains("90000 mm") && message.contains("half the diagonal"), "{message}");
    }
}

#[test]
fn files_of_another_kind_behind_a_right_name_are_named() {
    for (content, words) in [
        (&b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n"[..], "DXF drawing"),
        (b"\x1f\x8b\x08\x00\x01\x02\xff\xfe", "gzip"),
        (b"\x89PNG\r\n\x1a\n\x00\xff", "picture"),
        (b"{\"format\": 1}", "JSON"),
        (b"PK\x03\x04\x14", "ZIP archive"),
        (b"%PDF-1.4", "PDF"),
    ] {
        for name in ["a.step", "a.igs", "a.3dm"] {
            let room = room(name, content);
            let message = refused(room.path(), &["unroll", name, "--surfaces", "--tolerance", "0.1mm", "--out", "o"]);
            assert!(message.contains(words) && message.contains(name), "{name} {words}: {message}");
        }
    }
}

#[test]
fn archives_that_are_damaged_or_of_a_version_to_come_are_refused() {
    let begun = |version: &str| [b"3D Geometry File Format ", version.as_bytes()].concat();
    for (content, words) in [
        (begun("      80"), "damaged"),
        (begun("       8"), "version 8, which is not known"),
        (begun("      99"), "version 99"),
        (begun("        "), "is no number"),
        (begun(""), "3DM"),
        ([begun("      70"), (0..=255).cycle().take(4000).collect()].concat(), "damaged at byte"),
    ] {
        let room = room("a.3dm", &content);
        let message = refused(room.path(), &["unroll", "a.3dm", "--surfaces", "--tolerance", "0.1mm", "--out", "o"]);
        assert!(message.contains(words), "{words}: {message}");
    }
}
