//! `torse loft` and `torse hull` run as their users run them: results, and refusals of curves that cannot be used.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

/// Checks a refusal: status 2, one error with one line of help, nothing left behind; the message.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = torse(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(message.starts_with("error: ") && message.trim_end().lines().count() == 2, "{arguments:?}: {message}");
    assert!(!message.contains("panicked"), "{message}");
    assert!(!folder.join("o").exists(), "{arguments:?} left something behind");
    message
}

#[test]
fn the_hull_of_a_duct_is_certified_and_its_files_are_there() {
    let room = tempfile::tempdir().expect("room");
    let (a, b) = (format!("{DATA}/duct_square.dxf"), format!("{DATA}/duct_round.dxf"));
    let output = torse(room.path(), &["hull", &a, &b, "-t", "0.01mm", "-o", "o"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.starts_with("certified: ") && text.contains("left open"), "{text}");
    for file in ["panels.step", "patterns.dxf", "patterns.svg", "model.glb", "report.html", "report.json"] {
        assert!(fs::metadata(room.path().join("o").join(file)).expect(file).len() > 100, "{file}");
    }
}

#[test]
fn curves_that_cannot_be_used_are_refused_by_name() {
    let room = tempfile::tempdir().expect("room");
    let write = |name: &str, text: &str| fs::write(room.path().join(name), text).expect("file");
    write("a.csv", "0,0,0\n10,1,0\n20,0,3\n30,2,0\n");
    write("b.csv", "0,20,0\n10,21,4\n20,20,3\n30,22,0\n");
    write("touching.csv", "0,20,0\n10,1,0\n20,20,3\n");
    write("nan.csv", "0,0,0\n1,nan,2\n");
    write("point.csv", "1,2,3\n1,2,3\n");
    write("eight.csv", "0,0,0\n2,2,0\n2,0,0\n0,2,0\n");
    write("empty.csv", "");
    write("insert.dxf", "0\nSECTION\n2\nENTITIES\n0\nINSERT\n8\n0\n2\nB\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n");
    write("flat.csv", "0,0,0\n10,3,0\n20,0,0\n");
    let loft = |a: &str, b: &str| refused(room.path(), &["loft", a, b, "--unit", "mm", "-t", "0.1mm", "-o", "o"]);
    assert!(loft("a.csv", "a.csv").contains("a.csv"));
    let message = refused(
        room.path(),
        &["loft", "a.csv", "touching.csv", "--polyline", "--unit", "mm", "-t", "0.1mm", "-o", "o"],
    );
    assert!(message.contains("a.csv at 0.3") && message.contains("touching.csv at 0.497"), "{message}");
    assert!(loft("a.csv", "nan.csv").contains("nan.csv, line 2"));
    assert!(loft("point.csv", "b.csv").contains("point.csv has no length"));
    let message = loft("a.csv", "insert.dxf");
    assert!(message.contains("no curve that can be read") && message.contains("1 INSERT; explode blocks"), "{message}");
    assert!(loft("a.csv", "empty.csv").contains("empty.csv has no length"));
    let message =
        refused(room.path(), &["loft", "a.csv", "eight.csv", "--polyline", "--unit", "mm", "-t", "0.1mm", "-o", "o"]);
    assert!(message.contains("eight.csv meets itself"), "{message}");
    assert!(refused(room.path(), &["loft", "a.csv", "b.csv", "-t", "0.1mm", "-o", "o"]).contains("--unit"));
    let duct = format!("{DATA}/duct_round.dxf");
    let message = refused(room.path(), &["loft", &duct, "b.csv", "--unit", "in", "-t", "0.1mm", "-o", "o"]);
    assert!(message.contains("the unit of duct_round.dxf is the millimetre"), "{message}");
    assert!(refused(room.path(), &["loft", "a.csv", "-t", "0.1mm", "-o", "o"]).contains("RAIL_B"));
    let fixed = ["loft", "a.csv", "b.csv", "--unit", "mm", "-t", "0.1mm", "-o", "o", "--ruling", "0.5,0.5"];
    let message = refused(room.path(), &[&fixed[..], &["--ruling", "0.4,0.6"]].concat());
    assert!(message.contains("ruling 1"), "{message}");
    assert!(refused(room.path(), &["hull", "-t", "0.1mm", "-o", "o"]).contains("CURVE"));
    let message = refused(room.path(), &["hull", "flat.csv", "--unit", "mm", "-t", "0.1mm", "-o", "o"]);
    assert!(message.contains("off the plane of flat.csv"), "{message}");
}

#[test]
fn panels_run_along_a_section_and_sections_that_miss_are_refused() {
    let room = tempfile::tempdir().expect("room");
    let model = format!("{DATA}/torus_piece.step");
    let message = refused(room.path(), &["approximate", &model, "-t", "10mm", "-o", "o", "--curves", "x=999m"]);
    assert!(message.contains("x=999m misses every face"), "{message}");
    let along = ["--curves", "x=400mm", "--seams", "independent"];
    let output = torse(room.path(), &[&["approximate", &model, "-t", "10mm", "-o", "o"][..], &along].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report = fs::read_to_string(room.path().join("o/report.json")).expect("report");
    assert!(report.contains("\"curve\": \"x=400mm\"") && report.contains("paper_deviation_estimate"));
}

/// A drawing in mm.
fn drawing(entities: &str) -> String {
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

#[test]
fn all_curves_of_a_drawing_get_panels_and_what_is_not_read_is_named() {
    let room = tempfile::tempdir().expect("room");
    let arc = |z: i32| format!("0\nARC\n5\nA\n10\n0\n20\n0\n30\n{z}\n40\n816.5\n50\n10\n51\n80\n");
    let frames = drawing(&(arc(-125) + &arc(125) + "0\nTEXT\n1\nframes\n"));
    fs::write(room.path().join("frames.dxf"), frames).expect("file");
    let model = format!("{DATA}/torus_piece.step");
    let output = torse(room.path(), &["approximate", &model, "-t", "20mm", "-o", "o", "--curves", "frames.dxf"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.code() != Some(2), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("note: not read of frames.dxf: 1 TEXT"), "{text}");
    let report = fs::read_to_string(room.path().join("o/report.json")).expect("report") + &text;
    assert!(report.contains("frames.dxf curve 1") && report.contains("frames.dxf curve 2"), "{text}");
}

#[test]
fn splines_of_fit_points_are_rails() {
    let room = tempfile::tempdir().expect("room");
    for (name, y) in [("a.dxf", 0), ("b.dxf", 100)] {
        let points: String =
            [[0, 0], [100, 10], [200, 0], [300, 5]].map(|[x, z]| format!("11\n{x}\n21\n{y}\n31\n{z}\n")).concat();
        let spline = format!("0\nSPLINE\n5\nF\n70\n8\n71\n3\n72\n0\n73\n0\n74\n4\n{points}0\nPOINT\n10\n0\n20\n0\n");
        fs::write(room.path().join(name), drawing(&spline)).expect("file");
    }
    let output = torse(room.path(), &["loft", "a.dxf", "b.dxf", "-t", "0.1mm", "-o", "o"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("not read of a.dxf: 1 POINT") && text.contains("not read of b.dxf: 1 POINT"), "{text}");
}
