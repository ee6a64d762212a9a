//! `torse fit` run as its users run it: scans with noise and outliers, pieces, shapes that are no developables, rulings,
//! planes, and files that cannot be used.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Evenly distributed numbers in −1..1, the same on every machine.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

fn room(name: &str, content: &str) -> tempfile::TempDir {
    let room = tempfile::tempdir().expect("room");
    fs::write(room.path().join(name), content).expect("input");
    room
}

/// Runs `torse fit`: exit status, what it says, report.
fn fit(name: &str, content: &str, more: &[&str]) -> (Option<i32>, String, serde_json::Value) {
    let room = room(name, content);
    let output = torse(room.path(), &[&["fit", name, "--out", "o"], more].concat());
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    let report = fs::read_to_string(room.path().join("o/report.json")).unwrap_or_else(|_| "null".into());
    for file in ["strips.step", "patterns.dxf", "report.html"] {
        assert!(report == "null" || room.path().join("o").join(file).exists(), "{file}: {said}");
    }
    (output.status.code(), said, serde_json::from_str(&report).expect("a report"))
}

/// A figure of the report.
fn figure(report: &serde_json::Value, name: &str) -> f64 {
    let all = report["figures"].as_array().expect("figures");
    all.iter().find(|f| f["name"] == name).and_then(|f| f["value"].as_f64()).unwrap_or(f64::NAN)
}

/// A developable sheet of 1 m: point and normal.
fn sheet(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    let (a, f, df) = (0.25 * u, 0.15 * (2.2 * u).sin(), 0.33 * (2.2 * u).cos());
    let n = [-df, a * df - 0.25 * f, 1.0];
    let size = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    ([1000.0 * (u + v * a), 1000.0 * v, 1000.0 * (f + v * 0.25 * f)], n.map(|x| x / size))
}

fn scan(count: usize, noise: f64, outliers: usize) -> String {
    let mut random = Random(88_172_645_463_325_252);
    let mut out = String::from("x,y,z\n");
    for i in 0..count {
        let (x, n) = sheet(0.5 * random.number(), 0.4 * random.number());
        let off = if i < outliers { 30.0 + 20.0 * random.number() } else { noise * random.number() };
        let _ = writeln!(out, "{:.5},{:.5},{:.5}", x[0] + off * n[0], x[1] + off * n[1], x[2] + off * n[2]);
    }
    out
}

#[test]
fn a_noisy_sheet_is_recovered_within_twice_the_noise() {
    let (code, said, report) = fit("scan.csv", &scan(6000, 0.1, 0), &["-t", "0.3mm"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(report["strips"].as_array().map(Vec::len), Some(1), "{said}");
    // Points carry their own noise of 0.1 mm; the strip lies within as much of the true sheet.
    assert!(figure(&report, "largest distance of a point") <= 0.2, "{said}");
}

#[test]
fn outliers_do_not_pull_and_are_counted() {
    let (code, said, report) = fit("scan.csv", &scan(6000, 0.1, 12), &["-t", "0.5mm"]);
    assert_eq!(code, Some(3), "{said}");
    assert!((figure(&report, "points beyond the tolerance") - 12.0).abs() < 0.5, "{said}");
    assert!(said.contains("12 of 6000 points") && said.contains("the worst is point"), "{said}");
}

#[test]
fn two_pieces_make_two_strips() {
    let mut random = Random(7);
    let mut out = String::new();
    for _ in 0..4000 {
        let (a, y) = (0.5 * random.number(), 200.0 * random.number());
        let (s, c) = (400.0 * a.sin(), 400.0 * a.cos());
        let _ = writeln!(out, "{s:.5} {y:.5} {c:.5}");
        let _ = writeln!(out, "{:.5} {y:.5} {:.5}", 1000.0 + s, 0.3 * s);
    }
    let (code, said, report) = fit("two.xyz", &out, &["-t", "0.2mm"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(report["strips"].as_array().map(Vec::len), Some(2), "{said}");
}

#[test]
fn a_sphere_is_named_as_what_nothing_fits() {
    let mut random = Random(5);
    let mut out = String::new();
    for _ in 0..3000 {
        let (a, b) = (0.5 * random.number(), 0.5 * random.number());
        let z = (1.0 - a * a - b * b).sqrt();
        let _ = writeln!(out, "{:.6},{:.6},{:.6}", 300.0 * a, 300.0 * b, 300.0 * z);
    }
    let (code, said, _) = fit("ball.csv", &out, &["-t", "0.05mm", "--max-strips", "4"]);
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("NOT certified") && said.contains("no developable strip follows them"), "{said}");
}

/// Rulings of the tangent surface of a helix as a table, and as planes.
fn helix() -> (String, String) {
    let (mut rulings, mut planes) = (String::from("px,py,pz,qx,qy,qz\n"), String::from("a,b,c,d\n"));
    for i in 0..50 {
        let t = f64::from(i) / 49.0;
        let c = [500.0 * t.cos(), 500.0 * t.sin(), 300.0 * t];
        let length = 500.0_f64.hypot(300.0);
        let d = [-500.0 * t.sin() / length, 500.0 * t.cos() / length, 300.0 / length];
        let k = [-t.cos(), -t.sin(), 0.0];
        let n = [d[1] * k[2] - d[2] * k[1], d[2] * k[0] - d[0] * k[2], d[0] * k[1] - d[1] * k[0]];
        let end = |r: f64| [0, 1, 2].map(|j| c[j] + r * d[j]);
        let (p, q) = (end(200.0), end(500.0));
        let _ = writeln!(rulings, "{:.7},{:.7},{:.7},{:.7},{:.7},{:.7}", p[0], p[1], p[2], q[0], q[1], q[2]);
        let h = (0..3).map(|j| n[j] * c[j]).sum::<f64>();
        let _ = writeln!(planes, "{:.12},{:.12},{:.12},{h:.9}", n[0], n[1], n[2]);
    }
    (rulings, planes)
}

#[test]
fn rulings_and_planes_come_as_tables() {
    let (rulings, planes) = helix();
    let (code, said, _) = fit("r.csv", &rulings, &["-t", "0.1mm"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("1 strip for 50 rulings"), "{said}");
    let (code, said, _) = fit("p.csv", &planes, &["-t", "0.2mm", "--region", "150,650,320,100"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("50 planes"), "{said}");
    let (code, said, _) = fit("p.csv", &planes, &["-t", "0.1mm"]);
    assert!(code == Some(2) && said.contains("--region"), "{said}");
}

#[test]
fn files_that_cannot_be_used_are_refused_in_two_lines() {
    let line: String = (0..50).map(|i| format!("{i},{},{}\n", 2 * i, 3 * i)).collect();
    for (content, reason) in [
        ("", "no points"),
        ("1,2,3\n4,5,6\n7,8,8\n", "3 points: at least 30 are needed"),
        (&line, "all points lie in one line"),
        ("1,2,3\n4,nan,6\n", "point 1 has a coordinate that is not a finite number"),
        ("1,2,3\n4,five,6\n", "line 2"),
        ("px,py,pz,qx,qy,qz\n0,0,0,1,0,inf\n", "not a finite number"),
        ("px,py,pz,qx,qy,qz\n0,0,0,1,0,0\n0,1,0,1,1,0\n", "2 rulings: at least 4 are needed"),
    ] {
        let room = room("a.csv", content);
        let output = torse(room.path(), &["fit", "a.csv", "-t", "1mm", "-o", "o"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.starts_with("error: ") && message.contains(reason), "{reason}: {message}");
        assert_eq!(message.trim_end().lines().count(), 2, "{message}");
        assert!(!room.path().join("o").exists(), "{message}");
    }
}
