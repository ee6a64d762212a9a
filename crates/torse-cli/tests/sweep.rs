//! `torse approximate --sweep` run as its users run it.

use std::fs;
use std::process::Command;

#[test]
fn the_least_tolerance_of_a_sweep_is_that_of_the_files() {
    let room = tempfile::tempdir().expect("room");
    let cone = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cone_holes.step");
    let arguments = ["approximate", cone, "--sweep", "2mm,0.5mm,1mm", "--out", "o", "--quiet"];
    let output = Command::new(env!("CARGO_BIN_EXE_torse"))
        .current_dir(room.path())
        .args(arguments)
        .output()
        .expect("torse runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = |name: &str| fs::read_to_string(room.path().join("o").join(name)).expect("file");
    assert!(text("report.json").contains("\"tolerance\": 0.5"));
    assert!(text("sweep.json").contains("\"seam_length\": 0.0"));
    assert_eq!(text("sweep.json").matches("\"panels\": 1").count(), 3, "a row for every tolerance");
}
