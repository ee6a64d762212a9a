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
    let run = torse(&["map", path(&made), path(&points), "--to", "space", "-o", path(&folder.join("there.DXF"))]);
    assert!(text(&run.stderr).contains("is no name for a table of points"), "{}", text(&run.stderr));
    // Heights above a pattern are nowhere.
    let high = folder.join("high.csv");
    std::fs::write(&high, "x,y,z\n300,200,0\n300,201,4\n").expect("written");
    let run = torse(&["map", path(&made), path(&high), "--to", "space", "-o", path(&folder.join("high-there.csv"))]);
    assert!(text(&run.stdout).contains("z of 1 points is not used, the first in line 3"), "{}", text(&run.stdout));
    let run = torse(&["map", path(&made), path(&points), "--to", "flat", "--part", "Z", "-o", "x.csv"]);
    assert!(text(&run.stderr).contains("there is no part 'Z'; the result has A-01"), "{}", text(&run.stderr));
    let run = torse(&["refold", path(&folder), "-o", path(&folder.join("none"))]);
    assert!(text(&run.stderr).contains("report.json is missing"), "{}", text(&run.stderr));
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Everything of a drawing goes there and back on its layer, in its colour, and what lies beside the parts is named.
#[test]
fn a_drawing_is_carried_there_and_back() {
    let folder = scratch("drawing");
    let made = bracket(&folder);
    let square = "0\nLWPOLYLINE\n5\nA\n8\ncut\n62\n1\n90\n4\n70\n1\n10\n10\n20\n10\n10\n14\n20\n10\n42\n1\n10\n14\n20\n14\n10\n10\n20\n14\n";
    let others =
        "0\nPOINT\n5\nB\n8\nrivets\n10\n12\n20\n12\n0\nTEXT\n5\nC\n8\nnames\n10\n11\n20\n11\n40\n2.5\n1\nP 7\n50\n30\n\
                  0\nCIRCLE\n5\nD\n8\ncut\n10\n-500\n20\n0\n40\n3\n";
    let drawing = format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n0\nLAYER\n2\n\
         rivets\n62\n5\n0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{square}{others}0\nENDSEC\n0\nEOF\n"
    );
    let given = folder.join("given.dxf");
    std::fs::write(&given, drawing).expect("written");
    let (there, back) = (folder.join("there.dxf"), folder.join("back.dxf"));
    let run = torse(&["map", path(&made), path(&given), "--to", "space", "-o", path(&there)]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("CIRCLE D on layer 'cut': about"), "{}", text(&run.stdout));
    let run = torse(&["map", path(&made), path(&there), "--to", "flat", "-o", path(&back)]);
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
    let written = std::fs::read_to_string(&back).expect("a drawing");
    for words in [
        "0\nPOLYLINE\n8\ncut\n62\n1\n66\n1\n70\n1\n",
        "0\nPOINT\n8\nrivets\n10\n12.000000",
        "0\nTEXT\n8\nnames\n10\n11.000000",
        "1\nP 7\n50\n30.000",
        "0\nLAYER\n2\nrivets\n70\n0\n62\n5\n",
        "1001\nTORSE\n1000\n",
    ] {
        assert!(written.contains(words), "{words:?} in {written}");
    }
    // What somebody has changed since is not written over.
    std::fs::write(&back, written.replacen("62\n1\n", "62\n2\n", 1)).expect("written");
    let run = torse(&["map", path(&made), path(&there), "--to", "flat", "-o", path(&back), "--force"]);
    assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
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
