//! A file of which something is missing from the result is never certified, whatever is proven of the rest.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use torse::geom::Vec3;
use torse::io::step::write::{shells, Header, Shell};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

/// A plate of the given width (mm) above z.
fn plate(width: f64, z: f64) -> Surface {
    let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
    let points: Vec<Vec3> = corners.iter().map(|c| Vec3::new(width * c[0], width * c[1], z)).collect();
    Surface::new(k.clone(), k, &points, None).expect("a surface")
}

/// A good plate of 100 mm and one of a metre whose surface is not in the file; the number of that face.
fn half_readable() -> (String, u64) {
    let header = Header { name: "plates".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-4 };
    let plates = [plate(100.0, 0.0), plate(1000.0, 50.0)];
    let named: Vec<Shell> = plates.iter().enumerate().map(|(k, s)| Shell::untrimmed(&format!("P{k}"), s)).collect();
    let out = shells(&header, &named).expect("written");
    let text = String::from_utf8(out).expect("text");
    let line = text.lines().filter(|l| l.contains("ADVANCED_FACE")).nth(1).expect("a second face").to_string();
    let entity = line[1..line.find('=').expect("a number")].parse().expect("a number");
    let at = line.rfind('#').expect("a surface");
    let broken = format!("{}#999999{}", &line[..at], line[at + 1..].trim_start_matches(|c: char| c.is_ascii_digit()));
    (text.replace(&line, &broken), entity)
}

fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

#[test]
fn an_unreadable_face_is_part_of_the_question() {
    let room = tempfile::tempdir().expect("room");
    let (text, entity) = half_readable();
    fs::write(room.path().join("plates.step"), text).expect("input");
    let named = format!("#{entity}");
    for job in [&["approximate", "--sweep", "1mm"][..], &["cones"], &["fit"]] {
        let arguments = [&job[..1], &["plates.step", "-t", "0.1mm", "-o", "o", "--force"], &job[1..]].concat();
        let output = torse(room.path(), &arguments);
        let first = String::from_utf8_lossy(&output.stdout).lines().take(2).collect::<Vec<_>>().join("\n");
        assert_eq!(output.status.code(), Some(3), "{job:?}: {first} {}", String::from_utf8_lossy(&output.stderr));
        assert!(
            first.starts_with("NOT certified, its parts may be cut") && first.contains("left out"),
            "{job:?}: {first}"
        );
        let report = fs::read_to_string(room.path().join("o/report.json")).expect("a report");
        let report: serde_json::Value = serde_json::from_str(&report).expect("a report");
        assert_eq!(report["status"], "uncertified", "{job:?}");
        let reason = report["reason"].as_str().expect("a reason");
        assert!(reason.contains("left out") && reason.contains(&named), "{job:?}: {reason}");
        assert!(reason.contains("about 1 m²"), "{job:?}: {reason}");
        if job[0] == "approximate" {
            let coverage = report["coverage"].as_f64().expect("a share");
            assert!((coverage - 1e4 / 1.01e6).abs() < 1e-6, "{coverage}");
            let page = fs::read_to_string(room.path().join("o/report.html")).expect("a page");
            let lead = &page[page.find("class=\"lead\"").expect("a first line")..];
            assert!(lead[..lead.find("</p>").expect("an end")].contains(&named));
            let rows = fs::read_to_string(room.path().join("o/sweep.json")).expect("rows");
            assert!(rows.contains("uncertified") && !rows.contains("\"certified"), "{rows}");
        }
        let strict = [&arguments[..], &["--strict"]].concat();
        let output = torse(room.path(), &strict);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{job:?}: {message}");
        assert!(message.contains(&named), "{job:?}: {message}");
    }
}
