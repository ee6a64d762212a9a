//! `torse unroll` and `torse shape`, the options of the files, and what bad input gets.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name)
}

fn torse(arguments: &[&str], input: &Path, out: &Path) -> Output {
    let (command, rest) = arguments.split_first().expect("a command");
    let run =
        Command::new(env!("CARGO_BIN_EXE_torse")).arg(command).arg(input).args(rest).arg("--out").arg(out).output();
    run.expect("torse runs")
}

fn said(run: &Output) -> String {
    String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr)
}

#[test]
fn a_pipe_is_unrolled_with_its_proof_and_its_tables() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let options = ["unroll", "--surfaces", "--tolerance", "0.05mm", "--one-file-per-part", "--also", "iges,3dm"];
    let run = torse(&options, &data("cylinder_holes.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    assert!(said(&run).contains("certified: 1 flat part") && said(&run).contains("cut along edge #"), "{}", said(&run));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect(name);
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).expect("JSON");
    assert_eq!((report["job"].as_str(), report["status"].as_str()), (Some("unroll"), Some("certified")));
    // The pipe has a radius of 250 mm.
    let length = report["parts"][0]["length"].as_f64().expect("a length");
    assert!((length - 500.0 * std::f64::consts::PI).abs() < 1e-6, "{length}");
    assert!(
        read("parts.csv").lines().count() == 2 && out.join("panels.igs").is_file() && out.join("panels.3dm").is_file()
    );
    // A line every 5°, whole or in pieces beside a hole: each turns by that.
    let turns: Vec<String> =
        read("bends.csv").lines().skip(1).filter_map(|l| l.split(',').nth(4).map(String::from)).collect();
    assert!(turns.len() > 72 && turns.iter().all(|t| t == "5.0000"), "{turns:?}");
    let alone = std::fs::read_dir(&out).expect("a folder").flatten();
    assert_eq!(alone.filter(|f| f.file_name().to_string_lossy().starts_with("part-")).count(), 1);
    // What was written as IGES and for Rhino is read again.
    for copy in ["panels.igs", "panels.3dm"] {
        let info =
            Command::new(env!("CARGO_BIN_EXE_torse")).arg("info").arg(out.join(copy)).output().expect("torse runs");
        assert_eq!(info.status.code(), Some(0), "{copy}: {}", said(&info));
    }
}

#[test]
fn a_cone_laid_flat_is_bent_back_with_a_proof() {
    let dir = tempfile::tempdir().expect("a folder");
    let (out, back) = (dir.path().join("flat"), dir.path().join("back"));
    let run = torse(&["unroll", "--surfaces", "--tolerance", "0.05mm"], &data("cone_holes.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let run = torse(&["refold"], &out, &back);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let report = std::fs::read_to_string(back.join("refold.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert!(report["parts"][0]["matched_estimate"].as_f64().is_some_and(|x| x < 0.01), "{report}");
}

#[test]
fn bodies_are_written_so_many_at_a_time() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let options = ["unroll", "--tolerance", "0.05mm", "--split", "1"];
    let run = torse(&options, &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    assert!(out.join("001/patterns.dxf").is_file() && out.join("001/report.json").is_file());
    // A second time nothing is overwritten, and with --force it is.
    let run = torse(&options, &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(2), "{}", said(&run));
    let run = torse(&[&options[..], &["--force"]].concat(), &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    // Folders of an earlier run beyond the new ones would be cut twice.
    std::fs::rename(out.join("001"), out.join("002")).expect("renamed");
    let run = torse(&[&options[..], &["--force"]].concat(), &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    assert!(said(&run).contains("were removed") && !out.join("002").exists(), "{}", said(&run));
    assert!(out.join("001/patterns.dxf").is_file());
    let run = torse(&["unroll", "--tolerance", "0.05mm", "--split", "0"], &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(2), "{}", said(&run));
}

#[test]
fn drawings_have_a_tolerance_where_none_is_given() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let run = torse(&["unroll"], &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    assert!(said(&run).contains("tolerance 0.01mm"), "{}", said(&run));
    let report = std::fs::read_to_string(out.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((report["tolerance"].as_f64(), report["status"].as_str()), (Some(0.01), Some("certified")));
}

#[test]
fn faces_that_are_not_developable_are_named_with_the_command_that_would_help() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let run = torse(&["unroll", "--surfaces", "--tolerance", "0.05mm"], &data("torus_piece.step"), &out);
    assert_eq!(run.status.code(), Some(2), "{}", said(&run));
    assert!(said(&run).contains("--approximate 1mm") && !out.exists(), "{}", said(&run));
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    for (options, words) in [
        (&["unroll", "--tolerance", "0.05mm", "--k", "1.5"][..], "between 0 and 1"),
        (&["unroll", "--tolerance", "0.05mm", "--k", "0.4", "--surfaces"], "no thickness is given"),
        (&["unroll", "--tolerance", "0.05mm", "--k", "0.4"], "add --thickness"),
        (&["approximate", "--tolerance", "1mm", "--k", "0.4"], "add --thickness"),
        (&["unroll", "--tolerance", "0.05"], "no unit"),
        (&["unroll", "--tolerance", "0.05mm", "--face", "#999999"], "no face #999999"),
        (&["unroll", "--tolerance", "0.05mm", "--outer"], "constant thickness"),
        (&["approximate", "--tolerance", "1mm", "--sheet", "1250"], "1250x2550"),
    ] {
        let run = torse(options, &data("cylinder_holes.step"), &out);
        assert!(run.status.code() == Some(2) && said(&run).contains(words), "{options:?}: {}", said(&run));
        assert!(!out.exists());
    }
}

#[test]
fn strips_follow_their_handles_and_stay_developable() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("pulled");
    let run = torse(&["shape", "--tolerance", "0.5mm"], &data("pulled_hull.json"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let report: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("report.json")).expect("a report")).expect("JSON");
    assert_eq!((report["job"].as_str(), report["panels"].as_array().map(Vec::len)), (Some("shape"), Some(2)));
    // The moves are an animation and a row of pictures; the join of both strips is among the proven figures.
    assert!(out.join("moves.glb").is_file() && out.join("moves.png").is_file());
    let figures = report["figures"].as_array().expect("figures");
    let angle = figures.iter().find(|f| f["what"] == "join_angle").expect("an angle");
    assert_eq!(angle["basis"], "proven");
    // A job that names what is not there says where.
    let bad = dir.path().join("bad.json");
    let text = std::fs::read_to_string(data("pulled_hull.json"))
        .expect("the job")
        .replace("\"chine\", \"sheer\"", "\"chine\", \"rail\"");
    std::fs::write(&bad, text).expect("a file");
    let run = torse(&["shape", "--tolerance", "0.5mm"], &bad, &dir.path().join("none"));
    assert!(run.status.code() == Some(2) && said(&run).contains("$.strips[1]"), "{}", said(&run));
}

#[test]
fn a_thickness_that_cannot_be_is_no_proof() {
    let dir = tempfile::tempdir().expect("a folder");
    for (file, options, words) in [
        ("cylinder_holes.step", &["--surfaces", "--thickness", "600mm"][..], "no room inside"),
        ("bracket.step", &["--thickness", "5mm"], "sheet of 2 mm, not of 5 mm"),
    ] {
        let out = dir.path().join(file);
        let run = torse(&[&["unroll", "--tolerance", "0.05mm"][..], options].concat(), &data(file), &out);
        assert!(run.status.code() == Some(3) && said(&run).contains(words), "{}", said(&run));
        // Nothing is on the layer for cutting, which the table of layers names all the same.
        let drawing = std::fs::read_to_string(out.join("patterns.dxf")).expect("a drawing");
        assert_eq!(drawing.matches("\nCUT_OUTER\n").count(), 1);
    }
    let out = dir.path().join("right");
    let run = torse(&["unroll", "--tolerance", "0.05mm", "--thickness", "2mm"], &data("bracket.step"), &out);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
}

/// Options that contradict each other or the model: each refusal names what it is about and says what would help.
#[test]
fn options_that_contradict_are_refused_by_name() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let bracket = data("bracket.step");
    let cases: [(&[&str], &str, &str); 27] = [
        (&["--thickness", "0mm"], "--thickness", "greater than zero"),
        (&["--thickness=-2mm"], "--thickness", "greater than zero"),
        (&["--thickness", "3"], "--thickness", "write 3mm"),
        (&["--k", "1.5"], "--k", "between 0 and 1"),
        (&["--k=-0.1"], "--k", "between 0 and 1"),
        (&["--k", "nan"], "--k", "between 0 and 1"),
        (&["--k", "soft"], "--k: cannot read 'soft'", "--k 0.44"),
        (&["--k", "0.4", "--surfaces"], "--k", "add --thickness"),
        (&["--outer", "--inner"], "--inner", "leave one of both out"),
        (&["--bends", "none,#17"], "--bends", "'#17,#23'"),
        (&["--bends", "#99999"], "#99999", "names the edges of sharp bends"),
        (&["--bends", ""], "--bends", "give all, smooth, none"),
        (&["--facets", "0"], "--facets", "at least 1"),
        (&["--facets", "angle=0deg"], "--facets", "from 0.01deg to 90deg"),
        (&["--approximate", "1mm"], "--surfaces", "another option that was given needs it"),
        (&["--approximate", "0mm", "--surfaces"], "--approximate", "greater than zero"),
        (&["--split", "0"], "--split", "1.."),
        (&["--side", "inside"], "--thickness", "--side asks for it"),
        (&["--side", "top", "--thickness", "2mm"], "--side", "outside"),
        (&["--material", "adamantium"], "adamantium", "--materials"),
        (&["--material", "x", "--materials", "none.csv"], "--materials", "check the name"),
        (&["--mark-sections", "q=3mm"], "--mark-sections", "x=500mm"),
        (&["--mark-sections", "x=0mm..6m/0mm"], "--mark-sections", "greater than zero"),
        (&["--sheet", "10x10"], "--sheet", "is an option of torse approximate"),
        (&["--min-bend-radius", "0mm"], "--min-bend-radius", "is an option of torse approximate"),
        (&["--face", "#999999"], "#999999", "torse info"),
        (&["--time-limit", "0s"], "--time-limit", "--time-limit 5min"),
    ];
    for (options, names, helps) in cases {
        let run = torse(&[&["unroll", "--tolerance", "0.05mm"][..], options].concat(), &bracket, &out);
        let text = said(&run);
        assert_eq!(run.status.code(), Some(2), "{options:?}: {text}");
        assert!(text.contains(names) && text.contains(helps), "{options:?}: {text}");
        assert!(text.matches("  help: ").count() == 1 && !out.exists(), "{options:?}: {text}");
    }
    // A thickness that the body has not costs the proof, not the drawing.
    let run = torse(&["unroll", "--tolerance", "0.05mm", "--thickness", "5mm"], &bracket, &out);
    assert_eq!(run.status.code(), Some(3), "{}", said(&run));
    assert!(said(&run).contains("sheet of 2 mm, not of 5 mm: leave out --thickness"), "{}", said(&run));
    // What another command needs is told with an example of that command.
    for (command, example) in [("unroll", "torse unroll bracket.step"), ("ruled", "torse ruled roof.step")] {
        let run = Command::new(env!("CARGO_BIN_EXE_torse")).args([command, "x.step"]).output().expect("torse runs");
        assert!(said(&run).contains(&format!("for example: {example}")), "{}", said(&run));
    }
    let run = torse(&["refold", "--bend-step", "5deg"], &bracket, &out);
    assert!(said(&run).contains("--bend-step is an option of torse approximate"), "{}", said(&run));
}
