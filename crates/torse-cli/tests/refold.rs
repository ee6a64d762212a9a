//! `torse refold` and `torse map` as people call them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn torse(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).args(arguments).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("torse-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn path(p: &Path) -> &str {
    p.to_str().expect("a plain name")
}

#[test]
fn a_result_is_bent_back_and_carries_points() {
    let folder = scratch("refold");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cylinder_holes.step");
    let (made, back) = (folder.join("made"), folder.join("back"));
    let run = torse(&["approximate", path(&model), "-t", "0.5mm", "-o", path(&made), "-q"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let run = torse(&["refold", path(&made), "-o", path(&back)]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("1 of 1 parts bent back"), "{}", text(&run.stdout));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(back.join("refold.json")).expect("a report")).expect("JSON");
    let part = &report["parts"][0];
    assert!(part["matched_estimate"].as_f64().is_some_and(|x| x < 0.01), "{part}");
    assert!(part["distance_bound"].as_f64().is_some_and(|x| x < 1.0), "{part}");
    assert!(text(&run.stdout).contains("(proven;"), "{}", text(&run.stdout));
    assert!(back.join("refolded.glb").is_file());

    let points = folder.join("points.csv");
    std::fs::write(&points, "x,y\n300,200\n-5000,0\n").expect("written");
    let there = folder.join("there.csv");
    let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(&there)]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("line 3: the point lies on no part"), "{}", text(&run.stdout));
    let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(&there)]);
    assert!(text(&run.stderr).contains("exists already"));
    let run = torse(&["map", path(&made), path(&points), "--to", "flat", "--part", "Z", "-o", "x.csv"]);
    assert!(text(&run.stderr).contains("there is no part 'Z'; the result has A-01"), "{}", text(&run.stderr));
    let run = torse(&["refold", path(&folder), "-o", path(&folder.join("none"))]);
    assert!(text(&run.stderr).contains("report.json is missing"), "{}", text(&run.stderr));
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// A result of the bracket, made by the program.
fn bracket(folder: &Path) -> PathBuf {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/bracket.step");
    let made = folder.join("made");
    let run = torse(&["unroll", path(&model), "-t", "0.05mm", "-o", path(&made), "-q"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    made
}

/// Writes a file of a result anew with some words exchanged; what it held before.
fn edit(file: &Path, from: &str, to: &str) -> String {
    let before = std::fs::read_to_string(file).expect("a file");
    assert!(before.contains(from), "{before}");
    std::fs::write(file, before.replacen(from, to, 1)).expect("written");
    before
}

#[test]
fn tables_that_contradict_each_other_are_not_bent_back() {
    let folder = scratch("tables");
    let made = bracket(&folder);
    let refolded = |n: &str| torse(&["refold", path(&made), "-o", path(&folder.join(n))]);
    let table = made.join("bends.csv");
    let before = edit(&table, ",down,90.0000,", ",down,180.0000,");
    let run = refolded("angle");
    assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
    let said = text(&run.stderr);
    assert!(said.contains("line 1 of bends.csv has angle_deg 180.0000") && said.contains("90.0000"), "{said}");
    std::fs::write(&table, before).expect("written");
    edit(&made.join("bend_table.csv"), ",down,", ",up,");
    let said = text(&refolded("sense").stderr);
    assert!(said.contains("line 1 of bends.csv bends down, but bend 1 of bend_table.csv says up"), "{said}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn artwork_is_never_written_over_itself_or_a_file_of_the_result() {
    let folder = scratch("own");
    let made = bracket(&folder);
    let points = folder.join("points.csv");
    std::fs::write(&points, "x,y\n10,20\n").expect("written");
    let parts = made.join("parts.csv");
    let before = std::fs::read(&parts).expect("a table");
    for (out, words) in [
        (&points, "is the input file"),
        (&parts, "is a file of the result"),
        (&made.join("../made/parts.csv"), "is a file of"),
    ] {
        let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(out), "--force"]);
        assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains(words), "{}", text(&run.stderr));
    }
    assert_eq!(std::fs::read(&points).expect("points"), b"x,y\n10,20\n");
    assert_eq!(std::fs::read(&parts).expect("a table"), before);
    // Nor over files of others, whatever --force says, nor through links.
    let thesis = folder.join("thesis.docx");
    std::fs::write(&thesis, "precious").expect("written");
    let mut refused = vec![(thesis.clone(), "is not as this command writes files")];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.join("victim.csv"), folder.join("link.csv")).expect("a link");
        refused.push((folder.join("link.csv"), "is a link"));
    }
    for (out, words) in &refused {
        let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(out), "--force"]);
        assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains(words), "{}", text(&run.stderr));
    }
    assert_eq!(std::fs::read(&thesis).expect("a thesis"), b"precious");
    assert!(!folder.join("victim.csv").exists());
    // A name of its own may be used there, again and again.
    let own = made.join("marks.csv");
    for _ in 0..2 {
        let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(&own), "--force"]);
        assert!(own.is_file(), "{}", text(&run.stderr));
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn a_drawing_that_was_turned_over_is_refused_by_name() {
    let folder = scratch("mirrored");
    let made = bracket(&folder);
    let points = folder.join("points.csv");
    std::fs::write(&points, "x,y\n10,20\n").expect("written");
    let drawing = std::fs::read_to_string(made.join("patterns.dxf")).expect("a drawing");
    let at = drawing.find("AcDbPolyline").expect("an outline") + "AcDbPolyline".len();
    let mirrored = format!("{}\n210\n0.0\n220\n0.0\n230\n-1.0{}", &drawing[..at], &drawing[at..]);
    std::fs::write(made.join("patterns.dxf"), mirrored).expect("written");
    // The other drawing is there, but it is not the one that was turned over.
    assert!(made.join("patterns.svg").is_file());
    let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(&folder.join("there.csv"))]);
    assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
    let said = text(&run.stderr);
    assert!(said.contains("patterns.dxf: LWPOLYLINE") && said.contains("(0.0, 0.0, -1.0)"), "{said}");
    std::fs::remove_dir_all(&folder).expect("removed");
}
