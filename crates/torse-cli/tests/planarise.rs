//! `torse planarise` as its users run it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

fn hood() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/hood_strip.csv")
}

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(folder.join("report.json")).expect("a report")).expect("json")
}

#[test]
fn the_hood_becomes_plane_is_refined_and_all_files_are_written() {
    let room = tempfile::tempdir().expect("room");
    let file = hood().display().to_string();
    let output = torse(room.path(), &["planarise", &file, "--levels", "2", "--tolerance", "0.001mm", "--out", "out"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.starts_with("certified: 40 quadrilaterals in 1 flat part") && told.contains("level 2: 40"), "{told}");
    let out = room.path().join("out");
    for name in ["panels.step", "patterns.dxf", "patterns.svg", "model.glb", "panels.png", "field.png", "shapes.png"] {
        assert!(fs::metadata(out.join(name)).expect(name).len() > 500, "{name}");
    }
    let report = report(&out);
    assert_eq!((report["status"].as_str(), report["job"].as_str()), (Some("certified"), Some("planarise")));
    assert_eq!(report["panels"].as_array().map(Vec::len), Some(40));
    assert!(!report["shapes"].as_array().expect("shapes").is_empty());
    assert!(report["parts"][0]["isometry_error"].as_f64().expect("a number") < 1e-9);
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("id=\"shapes\"") && !page.contains("{{"));
}

#[test]
fn a_displacement_beyond_what_is_allowed_ends_with_status_3() {
    let room = tempfile::tempdir().expect("room");
    let file = hood().display().to_string();
    let arguments = ["planarise", &file, "-t", "0.001mm", "-o", "out", "--max-move", "0.01mm", "--hold", "first"];
    let output = torse(room.path(), &arguments);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stdout).contains("points moved up to"));
    assert_eq!(report(&room.path().join("out"))["status"].as_str(), Some("uncertified"));
}

#[test]
fn what_is_no_strip_is_refused_without_a_trace() {
    let room = tempfile::tempdir().expect("room");
    for (name, text, reason) in [
        ("a.csv", "0,0,0,0,1,0\n1,0,0,1,1\n", "line 2"),
        ("b.csv", "0,0,0,0,1,0\n", "two rulings"),
        ("c.csv", "0,0,0,0,0,0\n1,0,0,1,1,0\n", "no length"),
        ("d.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "3 corners"),
        ("e.csv", "", "no rulings"),
    ] {
        fs::write(room.path().join(name), text).expect("input");
        let output = torse(room.path(), &["planarise", name, "--tolerance", "1mm", "--out", "out"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(message.starts_with("error: ") && message.contains(reason), "{name}: {message}");
        assert!(message.contains("  help: ") && !room.path().join("out").exists());
    }
    let output = torse(room.path(), &["planarise", "e.csv", "--tolerance", "1", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2));
}
