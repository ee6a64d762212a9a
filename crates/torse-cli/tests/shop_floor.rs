//! Sheet and work at the command line: materials, thickness, kinks, sections.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn data(name: &str) -> String {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).display().to_string()
}

fn torse(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_torse"));
    command.args(arguments).arg("--out").arg(out).output().expect("the program runs")
}

fn said(run: &Output) -> String {
    String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr)
}

/// Cells of a table by the names of its columns.
fn column(table: &str, name: &str) -> Vec<String> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().expect("names").split(',').collect();
    let k = names.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no column {name} in {names:?}"));
    lines.map(|l| l.split(',').nth(k).expect("a cell").to_owned()).collect()
}

/// The panel of the pipe is 1571 mm long, its neutral fibre 1583 mm.
#[test]
fn a_part_that_fits_the_sheet_only_without_its_thickness_is_not_certified() {
    let dir = tempfile::tempdir().expect("a folder");
    for (longest, fits) in [("1575mm", false), ("1590mm", true)] {
        let out = dir.path().join(longest);
        let sheet = ["--thickness", "4mm", "--side", "inside", "--k", "0.5", "--max-length", longest];
        let run = torse(&[&["approximate", &data("cylinder_holes.step"), "-t", "0.5mm"], &sheet[..]].concat(), &out);
        assert_eq!(run.status.code(), Some(if fits { 0 } else { 3 }), "{}", said(&run));
        assert!(fits || said(&run).contains("1583 mm") && said(&run).contains("do not cut A-01"), "{}", said(&run));
    }
}

#[test]
fn a_pipe_of_steel_is_weighed_kinked_marked_and_stays_certified() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("pipe");
    let options = [
        "approximate",
        &data("cylinder_holes.step"),
        "--tolerance",
        "0.5mm",
        "--material",
        "mild steel",
        "--thickness",
        "3mm",
        "--facets",
        "angle=10deg",
        "--mark-sections",
        "z=../100mm",
    ];
    let run = torse(&options, &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let parts = read("parts.csv");
    let area: f64 = column(&parts, "area_mm2")[0].parse().expect("an area");
    let weight: f64 = column(&parts, "weight_kg")[0].parse().expect("a weight");
    assert!((weight - area * 3.0 * 7850e-9).abs() < 1e-3 * weight && column(&parts, "quantity")[0] == "1");
    let holes: usize = column(&parts, "holes")[0].parse().expect("a number");
    assert_eq!(column(&parts, "pierces")[0], (holes + 1).to_string());
    // Kinks take the whole turn of the pipe, and each no more than was asked for.
    let facets = read("facets.csv");
    let angles: Vec<f64> = column(&facets, "angle_deg").iter().map(|a| a.parse().expect("an angle")).collect();
    assert!(angles.iter().all(|a| *a <= 10.1) && angles.len() >= 10, "{angles:?}");
    assert!(read("patterns.dxf").contains("\nMARK_SECTION\n") && read("patterns.svg").contains("mark-section"));
    assert!(read("roll_table.csv").lines().count() > 20 && read("report.html").contains("facets.csv"));
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).expect("JSON");
    let figure = report["figures"].as_array().expect("figures").iter().find(|f| f["what"] == "inside_radius");
    assert_eq!(figure.expect("a figure")["basis"], "proven");
}

#[test]
fn the_sheet_beside_the_surface_has_another_area() {
    let dir = tempfile::tempdir().expect("a folder");
    let area = |side: &str| -> f64 {
        let out = dir.path().join(side);
        let loft = [
            "loft",
            &data("chine_low.csv"),
            &data("chine_high.csv"),
            "--unit",
            "mm",
            "--ends",
            "trim",
            "--tolerance",
            "0.05mm",
            "--thickness",
            "20mm",
            "--side",
            side,
        ];
        let run = torse(&loft, &out);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{}", said(&run));
        let parts = std::fs::read_to_string(out.join("parts.csv")).expect("parts");
        column(&parts, "area_mm2")[0].parse().expect("an area")
    };
    let (inside, outside) = (area("inside"), area("outside"));
    let report = std::fs::read_to_string(dir.path().join("inside/report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let middle = report["parts"][0]["area"].as_f64().expect("the area in space");
    assert!((inside - middle).abs() > 1e3 && (outside - middle).abs() > 1e3);
    // Areas of offsets of a developable go with the distance.
    let uneven = (inside - middle) + (outside - middle);
    assert!(uneven.abs() < 1e-3 * (inside - middle).abs(), "{inside} {middle} {outside}");
}

#[test]
fn what_cannot_be_meant_is_said_before_anything_is_done() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("none");
    let own = dir.path().join("own.csv");
    std::fs::write(&own, "material,density\nmud,-1\n").expect("a file");
    let own = own.display().to_string();
    let pipe = data("cylinder_holes.step");
    for (options, words) in [
        (&["--material", "unobtainium"][..], "birch-plywood"),
        (&["--material", "mud", "--materials", &own], "line 2, material 'mud'"),
        (&["--side", "outside"], "--thickness"),
        (&["--thickness", "3"], "no unit"),
        (&["--facets", "many"], "chord=0.5mm"),
        (&["--mark-sections", "x=5"], "no unit"),
        (&["--mark-sections", "x=90m"], "meets the model"),
    ] {
        let mut all = vec!["approximate", &pipe, "--tolerance", "0.5mm"];
        all.extend(options);
        let run = torse(&all, &out);
        assert!(run.status.code() == Some(2) && said(&run).contains(words), "{options:?}: {}", said(&run));
        assert!(!out.exists());
    }
}

/// Lines of a bend table as turn up to the line and turn about the line, degrees with their sense, without doubles: a line
/// beside a hole is in pieces.
fn turns(table: &str) -> Vec<(f64, f64)> {
    let number =
        |name: &str| column(table, name).iter().map(|t| t.parse::<f64>().expect("a number")).collect::<Vec<_>>();
    let signed = |(sense, angle): (String, f64)| if sense == "down" { -angle } else { angle };
    let about = column(table, "sense").into_iter().zip(number("angle_deg")).map(signed);
    let mut all: Vec<(f64, f64)> = number("turned_deg").into_iter().zip(about).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-3);
    all
}

#[test]
fn the_turn_up_to_a_line_grows_by_what_the_sheet_turns_about_the_lines() {
    let dir = tempfile::tempdir().expect("a folder");
    for (job, file) in
        [("unroll", "cylinder_holes.step"), ("unroll", "cone_holes.step"), ("approximate", "cone_holes.step")]
    {
        let out = dir.path().join(format!("{job}-{file}"));
        let input = data(file);
        let more: &[&str] = if job == "unroll" { &["--surfaces"] } else { &[] };
        let run = torse(&[&[job, &input, "--tolerance", "0.5mm"][..], more].concat(), &out);
        assert_eq!(run.status.code(), Some(0), "{}", said(&run));
        let table = std::fs::read_to_string(out.join("bends.csv")).expect("bends.csv");
        let parts = std::collections::BTreeSet::from_iter(column(&table, "part"));
        for part in parts {
            let head = table.lines().next().expect("names");
            let of_part = table.lines().filter(|l| l.starts_with(&part) || *l == head).collect::<Vec<_>>().join("\n");
            let lines = turns(&of_part);
            assert!(lines.len() > 5, "{job} {file} {part}: {lines:?}");
            for w in lines.windows(3) {
                // About a line the sheet turns from half way to the one before to half way to the one behind.
                let [(before, _), (_, about), (behind, _)] = w else { continue };
                let wanted = 0.5 * (behind - before);
                let said = about.abs();
                // Both have four digits.
                assert!((said - wanted).abs() < 2e-4 + 0.02 * wanted, "{job} {file} {part}: {w:?}");
            }
            let sum: f64 = lines.iter().map(|l| l.1.abs()).sum();
            let (first, last) = (lines[0], lines[lines.len() - 1]);
            let between = last.0 - first.0;
            // The ends of the part lie no farther out than a whole line's turn.
            assert!(
                sum >= between - 1e-2 && sum <= between + first.1.abs() + last.1.abs() + 1e-2,
                "{job} {file} {part}: {sum} {between}"
            );
        }
    }
}
