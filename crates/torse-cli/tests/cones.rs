//! `torse cones` and `torse approximate --cones` run as their users run them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

fn data(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name);
    path.to_string_lossy().into_owned()
}

fn text(path: PathBuf) -> String {
    String::from_utf8_lossy(&fs::read(path).expect("file")).into_owned()
}

#[test]
fn a_cone_with_holes_stays_one_exact_cone_with_its_holes() {
    let room = tempfile::tempdir().expect("room");
    let arguments = ["cones", &data("cone_holes.step"), "-t", "0.5mm", "-o", "o", "--bending", "--thickness", "2mm"];
    let output = torse(room.path(), &arguments);
    let message = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{message} {}", String::from_utf8_lossy(&output.stderr));
    assert!(message.starts_with("certified:"), "{message}");
    let folder = room.path().join("o");
    let step = text(folder.join("cones.step"));
    assert!(step.contains("CONICAL_SURFACE") && step.contains("FACE_BOUND("), "holes are inner bounds");
    assert!(!step.contains("B_SPLINE_SURFACE"));
    // Inner, neutral and outer surface.
    let thick = text(folder.join("thickness.step"));
    assert_eq!(thick.matches("=CONICAL_SURFACE").count(), 3 * step.matches("=CONICAL_SURFACE").count());
    for name in ["inner", "neutral", "outer"] {
        assert!(thick.contains(name), "{name}");
    }
    for name in ["patterns.dxf", "patterns.svg", "model.glb", "report.html", "bending.png", "thickness.glb"] {
        assert!(fs::metadata(folder.join(name)).is_ok_and(|m| m.len() > 100), "{name}");
    }
    let glb = text(folder.join("bending.glb"));
    assert!(glb.contains("\"targets\"") && glb.contains("\"animations\""));
    // Its own result is read again, and stays what it is.
    let again = torse(room.path(), &["cones", "o/cones.step", "-t", "0.5mm", "-o", "again"]);
    assert_eq!(again.status.code(), Some(0), "{}", String::from_utf8_lossy(&again.stderr));
}

#[test]
fn panels_come_out_as_certified_cones() {
    let room = tempfile::tempdir().expect("room");
    let arguments = ["approximate", &data("cylinder_holes.step"), "-t", "0.5mm", "-o", "o", "--cones", "--quiet"];
    let output = torse(room.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report = text(room.path().join("o/cones-report.json"));
    assert!(report.contains("\"status\": \"certified\""), "{report}");
    // Which of the two depends on the panels.
    let step = text(room.path().join("o/cones.step"));
    assert!(step.contains("=CONICAL_SURFACE") || step.contains("=CYLINDRICAL_SURFACE"));
    assert!(!step.contains("B_SPLINE_SURFACE"));
}

#[test]
fn input_that_cannot_be_used_is_refused_with_the_reason() {
    let room = tempfile::tempdir().expect("room");
    let refused = |arguments: &[&str], reason: &str| {
        let output = torse(room.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.starts_with("error: ") && message.contains("  help: "), "{message}");
        assert!(message.contains(reason), "{message}");
        assert!(fs::metadata(room.path().join("o")).is_err(), "nothing is left behind");
    };
    let cone = data("cone_holes.step");
    refused(&["cones", &cone, "-t", "2", "-o", "o"], "no unit");
    refused(&["cones", &cone, "-t", "0.5mm", "-o", "o", "--thickness", "-1mm"], "greater than zero");
    refused(&["cones", &cone, "-t", "0.5mm", "-o", "o", "--thickness", "100m"], "thinner sheet");
    refused(&["cones", &data("half_bowl.step"), "-t", "1mm", "-o", "o"], "ruled");
    refused(&["cones", "missing.step", "-t", "1mm", "-o", "o"], "missing.step");
}
