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
