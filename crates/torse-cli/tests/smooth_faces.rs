//! `torse approximate` on a bowl that its file cuts into four patches.

use std::fs;
use std::path::Path;
use std::process::Command;

use torse::geom::Vec3;
use torse::io::step::write::{shells, Header, Shell};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

/// A shallow bowl, 100 mm wide.
fn bowl() -> Surface {
    let k = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
    let square = [0.0, 0.0, 25.0];
    let points: Vec<Vec3> = (0..9)
        .map(|i| Vec3::new(50.0 * (i / 3) as f64, 50.0 * (i % 3) as f64, square[i / 3] + square[i % 3]))
        .collect();
    Surface::new(k.clone(), k, &points, None).expect("a surface")
}

fn step(patches: &[Surface]) -> Vec<u8> {
    let header = Header { name: "bowl".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-4 };
    let named: Vec<Shell> = patches.iter().enumerate().map(|(k, s)| Shell::untrimmed(&format!("P{k}"), s)).collect();
    shells(&header, &named).expect("written")
}

/// Exit status and report of a run.
fn run(folder: &Path, name: &str, patches: &[Surface], more: &[&str]) -> (Option<i32>, serde_json::Value) {
    fs::write(folder.join(name), step(patches)).expect("input");
    let output = Command::new(env!("CARGO_BIN_EXE_torse"))
        .current_dir(folder)
        .args([&["approximate", name, "-t", "0.4mm", "-o", "o", "--force"], more].concat())
        .output()
        .expect("torse runs");
    let report = fs::read_to_string(folder.join("o/report.json")).expect("a report");
    (output.status.code(), serde_json::from_str(&report).expect("a report"))
}

#[test]
fn four_patches_of_a_bowl_take_as_many_panels_as_the_bowl() {
    let room = tempfile::tempdir().expect("room");
    let s = bowl();
    let part = |u: (f64, f64), v: (f64, f64)| s.restricted(u, v).expect("inside");
    let patches = [
        part((0.0, 0.4), (0.0, 0.5)),
        part((0.4, 1.0), (0.0, 0.5)).transposed(),
        part((0.0, 0.4), (0.5, 1.0)).reversed_u(),
        part((0.4, 1.0), (0.5, 1.0)),
    ];
    let count = |r: &serde_json::Value| r["panels"].as_array().expect("panels").len();
    let (code, whole) = run(room.path(), "whole.step", std::slice::from_ref(&s), &["--seams", "independent"]);
    assert_eq!(code, Some(0));
    let (code, joined) =
        run(room.path(), "patches.step", &patches, &["--smooth-angle", "0.5", "--seams", "independent"]);
    assert_eq!(code, Some(0), "{joined}");
    assert!(count(&joined) <= count(&whole) + 1, "{} panels against {}", count(&joined), count(&whole));
    let faces = joined["faces"].as_array().expect("faces");
    assert_eq!(faces.len(), 1);
    assert_eq!(faces[0]["joined"].as_array().expect("parts").len(), 4);
    assert_eq!(faces[0]["name"], "P0 + P1 + P2 + P3");
    let moved = faces[0]["joint_bound"].as_f64().expect("a bound");
    assert!(moved > 0.0 && moved < 1e-6, "{moved}");
    // Kept apart: four faces, at least one panel each. Whether these meet is not asked.
    let (code, apart) = run(room.path(), "patches.step", &patches, &["--smooth-angle", "0", "--seams", "independent"]);
    assert_eq!(code, Some(0));
    assert_eq!(apart["faces"].as_array().expect("faces").len(), 4);
    assert!(count(&apart) >= 4);
}
