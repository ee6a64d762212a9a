//! `torse loft` and `torse hull` as their users run them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

fn data(name: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name);
    path.display().to_string()
}

/// Runs a job and gives its report and what it told.
fn report(folder: &Path, arguments: &[&str], status: i32) -> (serde_json::Value, String) {
    let output = torse(folder, &[arguments, &["--out", "out", "--force"]].concat());
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(status), "{arguments:?} {told}{}", String::from_utf8_lossy(&output.stderr));
    (serde_json::from_slice(&fs::read(folder.join("out/report.json")).expect("a report")).expect("json"), told)
}

fn figure(report: &serde_json::Value, name: &str) -> f64 {
    let all = report["figures"].as_array().expect("figures");
    all.iter().find(|f| f["name"] == name).and_then(|f| f["value"].as_f64()).unwrap_or(f64::NAN)
}

#[test]
fn the_chine_plate_is_exactly_developable_and_the_report_says_how_much_of_the_rails_it_uses() {
    let room = tempfile::tempdir().expect("room");
    let (low, high) = (data("chine_low.csv"), data("chine_high.csv"));
    let plate = ["loft", &low, &high, "--unit", "mm", "-t", "0.05mm", "--rulings", "250mm"];
    let (trimmed, told) = report(room.path(), &[&plate[..], &["--ends", "trim"]].concat(), 3);
    assert!(told.contains("certified in part: 62.5 % of chine_low.csv, 60.6"), "{told}");
    assert!(told.contains("exactly developable splines of planes"), "{told}");
    // A millionth of a degree is rounding.
    assert!(figure(&trimmed, "twist, bound") < 1e-6 && figure(&trimmed, "from chine_low.csv") <= 0.05);
    let used = figure(&trimmed, "used of chine_low.csv");
    assert!((used - 62.55).abs() < 0.01, "{used}");
    // Unasked, both rails are used whole: cones about their ends.
    let (all, _) = report(room.path(), &plate, 0);
    assert!((figure(&all, "used of chine_low.csv") - 100.0).abs() < 1e-6);
    assert!((figure(&all, "used of chine_high.csv") - 100.0).abs() < 1e-6);
    let (extended, told) = report(room.path(), &[&plate[..], &["--ends", "extend"]].concat(), 3);
    assert!(told.contains("past the ends of chine"), "{told}");
    assert!(figure(&extended, "used of chine_low.csv") > 99.0 && told.contains("is extended by"), "{told}");
    // An extension along the tangent leads nowhere, and is not drawn.
    let straight = [&plate[..], &["--ends", "extend", "--extension", "line"]].concat();
    let (straight, _) = report(room.path(), &straight, 3);
    assert!((figure(&straight, "used of chine_low.csv") - used).abs() < 1e-6);
}

#[test]
fn strips_of_least_twist_have_alternatives_and_a_time_limit_keeps_what_is_there() {
    let room = tempfile::tempdir().expect("room");
    let square = |z: f64, r: f64| format!("{r},0,{z}\n0,{r},{z}\n-{r},0,{z}\n0,-{r},{z}\n{r},0,{z}\n");
    fs::write(room.path().join("a.csv"), square(0.0, 100.0)).expect("input");
    fs::write(room.path().join("b.csv"), square(60.0, 80.0)).expect("input");
    let job = ["loft", "a.csv", "b.csv", "--unit", "mm", "--polyline", "-t", "0.1mm", "--least-twist"];
    let output = torse(room.path(), &[&job[..], &["--alternative", "2", "--out", "out"]].concat());
    assert!(matches!(output.status.code(), Some(0 | 3)), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("alternative 2: least twist near here"));
    let (low, high) = (data("chine_low.csv"), data("chine_high.csv"));
    let plate = ["loft", &low, &high, "--unit", "mm", "-t", "0.05mm", "--time-limit", "1ms"];
    let (_, told) = report(room.path(), &plate, 0);
    assert!(told.contains("stopped early"), "{told}");
}

#[test]
fn curves_that_cannot_be_joined_are_refused_by_name_and_place() {
    let room = tempfile::tempdir().expect("room");
    let put = |name: &str, text: &str| fs::write(room.path().join(name), text).expect("input");
    put("a.csv", "0,0,0\n100,10,0\n200,0,0\n");
    put("b.csv", "0,100,0\n100,110,30\n200,100,0\n");
    put("same.csv", "0,0,0\n100,10,0\n200,0,0\n");
    put("touch.csv", "0,100,0\n200,0,0\n300,100,50\n");
    put("point.csv", "5,5,5\n5,5,5\n");
    put("nan.csv", "0,0,0\nnan,1,0\n2,2,2\n");
    put("huge.csv", "0,0,0\n1e300,1,0\n2,2,2\n");
    put("eight.csv", "0,0,0\n200,200,0\n200,0,0\n0,200,0\n");
    put("line.csv", "0,0,0\n100,0,0\n");
    put("on.csv", "150,0,0\n300,0,0\n");
    let header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n5\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
    let line = "0\nLINE\n5\nA1\n8\nrail\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n0\nENDSEC\n0\nEOF\n";
    put("cm.dxf", &format!("{header}{line}"));
    for (arguments, reasons) in [
        (&["loft", "a.csv", "same.csv"][..], &["a.csv runs along same.csv"][..]),
        (&["loft", "a.csv", "touch.csv"], &["a.csv at 1.0000", "touch.csv at 0.59"]),
        (&["loft", "a.csv", "point.csv"], &["point.csv has no length"]),
        (&["loft", "nan.csv", "b.csv"], &["nan.csv, line 2"]),
        (&["loft", "a.csv", "huge.csv"], &["huge.csv: point 1", "check the unit"]),
        (&["loft", "a.csv", "eight.csv", "--polyline"], &["eight.csv meets itself", "0.18", "0.81"]),
        (&["loft", "line.csv", "on.csv"], &["line.csv and on.csv lie in one line"]),
        (&["loft", "a.csv", "cm.dxf"], &["the unit of cm.dxf is the centimetre"]),
        (&["loft", "a.csv"], &["<RAIL_B>"]),
        (&["loft", "a.csv", "b.csv", "--ruling", "0.5,0.5", "--ruling", "0.4,0.6"], &["ruling 1 (0.4, 0.6)"]),
        (&["loft", "a.csv", "b.csv", "--ruling", "2,0"], &["between 0 and 1"]),
        (&["loft", "a.csv", "b.csv", "--exact", "--alternative", "99"], &["alternative 99"]),
        (&["hull", "a.csv"], &["a.csv", "no volume"]),
        (&["hull", "line.csv", "on.csv"], &["line.csv, on.csv", "no volume"]),
        (&["hull", "nan.csv", "b.csv"], &["nan.csv, line 2"]),
    ] {
        let output = torse(room.path(), &[arguments, &["--unit", "mm", "-t", "0.1mm", "--out", "out"]].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.starts_with("error: ") && message.contains("\n  help: "), "{arguments:?}: {message}");
        assert!(reasons.iter().all(|r| message.contains(r)), "{arguments:?}: {message}");
        assert!(!room.path().join("out").exists());
    }
    let output = torse(room.path(), &["loft", "a.csv", "b.csv", "-t", "0.1mm", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("a.csv does not say its unit"));
}
