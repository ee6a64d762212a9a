//! `torse net` as its users run it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

fn keel() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/keel_net.json")
}

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(folder.join("report.json")).expect("a report")).expect("json")
}

#[test]
fn a_control_net_with_end_rulings_becomes_a_certified_strip_with_all_files() {
    let room = tempfile::tempdir().expect("room");
    let file = keel().display().to_string();
    let output = torse(room.path(), &["net", &file, "--end-width", "200mm", "-t", "0.01mm", "--out", "out"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.starts_with("certified: 1 strip in 1 flat part"), "{told}");
    assert!(told.contains("M* = 1.369416") && told.contains("the only regular polynomial one"), "{told}");
    let out = room.path().join("out");
    for name in ["panels.step", "patterns.dxf", "patterns.svg", "model.glb", "panels.png", "field.png"] {
        assert!(fs::metadata(out.join(name)).expect(name).len() > 500, "{name}");
    }
    let report = report(&out);
    assert_eq!((report["status"].as_str(), report["job"].as_str()), (Some("certified"), Some("net")));
    assert!(report["parts"][0]["isometry_error"].as_f64().expect("a number") < 1e-9);
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("regression curve") && !page.contains("{{"));
}

#[test]
fn a_curve_from_a_table_takes_free_parameters_and_may_be_continued() {
    let room = tempfile::tempdir().expect("room");
    fs::write(room.path().join("c.csv"), "0,0,0\n1,0.2,0\n2,0.3,0.1\n3,0.3,0.3\n").expect("input");
    let base = ["net", "c.csv", "--unit", "m", "--start-ruling", "0,1,0.5", "--width", "40cm", "-t", "0.1mm"];
    for more in
        [&["--stars", "1.6,1.7"][..], &["--shape", "0,0", "--along", "-0.1,1.1"], &["--end-ruling", "-0.1,1,0.5"]]
    {
        let output = torse(room.path(), &[&base[..], more, &["--out", "out", "--force"]].concat());
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(0), "{more:?} {told}{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn rulings_without_a_regular_surface_end_with_status_3_and_the_signs() {
    let room = tempfile::tempdir().expect("room");
    let file = keel().display().to_string();
    let output =
        torse(room.path(), &["net", &file, "--end-ruling", "0,-1,0.5", "--polynomial", "-t", "0.01mm", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stdout).contains("pattern ++++"));
    let report = report(&room.path().join("out"));
    assert!(report["reason"].as_str().expect("a reason").contains("no polynomial net exists"));
    assert_eq!(report["panels"].as_array().map(Vec::len), Some(0));
}

#[test]
fn what_is_no_net_is_refused_without_a_trace() {
    let room = tempfile::tempdir().expect("room");
    let file = keel().display().to_string();
    let text = fs::read_to_string(keel()).expect("data");
    fs::write(room.path().join("knots.json"), text.replace("0.5, ", "")).expect("input");
    fs::write(room.path().join("nan.json"), text.replace("250, 125, 75", "250, NaN, 75")).expect("input");
    fs::write(room.path().join("plain.csv"), "0,0,0\n1,0,0\n2,0,1\n").expect("input");
    fs::write(room.path().join("bent.csv"), "0,0,0\n1,0,0\n1,1,0\n").expect("input");
    let ruled = ["--start-ruling", "z", "--width", "1mm", "--end-ruling", "z"];
    for (arguments, reason) in [
        (&["knots.json"][..], "need 9 knots, or 7 without the first and last, not 6"),
        (&["nan.json"], "line 5"),
        (&["missing.json"], "missing.json"),
        (&[&file, "--start-ruling", "250,125,75"], "first ruling is tangent to the curve at u = 0"),
        (&[&file, "--end-ruling", "250,-125,-93.75"], "last ruling is tangent to the curve at u = 1"),
        (&[&file, "--stars", "0.5,2"], "M* = 0.5"),
        (&[&file, "--stars", "nan,2"], "not a finite number"),
        (&[&file, "--stars", "2"], "two numbers"),
        (&[&file, "--along", "2,3"], "keel_net.json: the stretch from 2 to 3"),
        (&[&file, "--alternative", "7"], "alternative 7 does not exist; there are 1"),
        (&["plain.csv"], "does not say its unit"),
        (&["plain.csv", "--unit", "mm"], "without its first ruling"),
        (&["plain.csv", "--unit", "mm", "--start-ruling", "y"], "length of its first ruling"),
        (&["plain.csv", "--unit", "mm", "--start-ruling", "y", "--width", "5mm"], "one ruling does not decide"),
        (&["plain.csv", "--unit", "mm", "--start-ruling", "0,0,0"], "no direction"),
        (&[], "<CURVE>"),
    ] {
        let output = torse(room.path(), &[&["net"], arguments, &["-t", "1mm", "--out", "out"]].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.starts_with("error: ") && message.contains(reason), "{arguments:?}: {message}");
        assert!(message.contains("  help: ") && !room.path().join("out").exists(), "{arguments:?}: {message}");
    }
    let bent = [&["net", "bent.csv", "--unit", "mm", "-t", "1mm", "--out", "out"][..], &ruled].concat();
    let message = String::from_utf8_lossy(&torse(room.path(), &bent).stderr).into_owned();
    assert!(message.contains("bent.csv has a corner of 90.000° at 0.5000"), "{message}");
}
