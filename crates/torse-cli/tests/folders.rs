//! What the program does to folders, as its users run it: it replaces what it wrote, and nothing else.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Plane quadrilaterals of a strip, the quickest of all jobs, into `out`.
fn planarise(folder: &Path, out: &str, more: &[&str]) -> Output {
    let strip = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/hood_strip.csv");
    let mut command = Command::new(env!("CARGO_BIN_EXE_torse"));
    command.current_dir(folder).arg("planarise").arg(strip).args(["-t", "0.001mm", "-o", out]).args(more);
    command.output().expect("torse runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").file_name());
    let mut names: Vec<String> = entries.map(|n| n.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn force_replaces_what_torse_wrote_and_nothing_else() {
    let room = tempfile::tempdir().expect("room");
    let out = room.path().join("out");
    let first = planarise(room.path(), "out", &[]);
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let written = names(&out);
    let before = fs::read(out.join("report.json")).expect("a report");
    fs::create_dir(out.join(".git")).expect("folder");
    fs::write(out.join(".git/HEAD"), "ref: refs/heads/main").expect("file");
    fs::write(out.join("main.rs"), "fn main() {}").expect("file");

    // Another result, with other files.
    let second = planarise(room.path(), "out", &["--force", "--levels", "2"]);
    let told = text(&second.stderr);
    assert_eq!(second.status.code(), Some(0), "{told}");
    assert!(told.contains(".git, main.rs") && told.contains("kept"), "{told}");
    assert_eq!(fs::read(out.join(".git/HEAD")).expect("kept"), b"ref: refs/heads/main");
    assert_ne!(fs::read(out.join("report.json")).expect("a report"), before);
    let others = names(&out).into_iter().filter(|n| !written.contains(n)).collect::<Vec<_>>();
    assert_eq!(others, [".git", "main.rs"]);
    assert_eq!(names(room.path()), ["out"]);

    fs::write(out.join("patterns.dxf"), "nested by hand").expect("file");
    let third = planarise(room.path(), "out", &["--force"]);
    assert_eq!(third.status.code(), Some(2));
    assert!(text(&third.stderr).contains("patterns.dxf"), "{}", text(&third.stderr));
    assert_eq!(fs::read(out.join("patterns.dxf")).expect("kept"), b"nested by hand");
}

#[test]
fn a_report_of_others_does_not_make_a_folder_ours() {
    let room = tempfile::tempdir().expect("room");
    let out = room.path().join("out");
    fs::create_dir(&out).expect("folder");
    let names_of_results = ["main.rs", "part-keel.dxf", "parts.csv", "patterns.dxf", "report.json"];
    for report in
        ["{\"title\": \"annual report\"}", "{\"schema\": \"torse-report/2\"}", "{\"schema\": \"torse-report/99\"}"]
    {
        for name in names_of_results {
            fs::write(out.join(name), report).expect("file");
        }
        let run = planarise(room.path(), "out", &["--force"]);
        assert_eq!(run.status.code(), Some(2));
        let told = text(&run.stderr);
        assert!(told.contains("'out' holds no result") && told.contains("--out, or remove"), "{told}");
        assert_eq!(names(&out), names_of_results);
        assert!(names_of_results.iter().all(|n| fs::read(out.join(n)).expect("kept") == report.as_bytes()));
    }
}

#[test]
#[cfg(unix)]
fn a_request_to_end_keeps_what_was_found_and_a_killed_run_is_cleaned_up_after() {
    let room = tempfile::tempdir().expect("room");
    let hull = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/hull.step");
    // Far more than anybody waits for.
    let start = |out: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_torse"));
        command.current_dir(room.path()).arg("approximate").arg(&hull).args(["-t", "0.01mm", "-o", out]);
        let mut run = command
            .stderr(std::process::Stdio::null())
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("torse runs");
        let marked =
            |n: &String| n.starts_with(&format!(".{out}.partial-")) && room.path().join(n).join("result").exists();
        while !names(room.path()).iter().any(marked) {
            assert!(run.try_wait().expect("a state").is_none(), "ended too soon");
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        // The signals are watched from just after the folder is made.
        std::thread::sleep(std::time::Duration::from_millis(200));
        run
    };
    let mut ended = start("ended");
    let request = Command::new("kill").arg(ended.id().to_string()).status().expect("kill runs");
    assert!(request.success());
    let mut killed = start("killed");
    killed.kill().expect("killed");
    killed.wait().expect("gone");
    assert!(names(room.path()).iter().any(|n| n.starts_with(".killed.partial-")));
    assert_eq!(planarise(room.path(), "killed", &[]).status.code(), Some(0));
    // Not certified: it was not allowed to go on.
    assert_eq!(ended.wait().expect("ended").code(), Some(3));
    assert_eq!(names(room.path()), ["ended", "killed"]);
    assert!(room.path().join("ended/report.json").exists());
}

/// Any command in a folder.
fn torse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_torse")).current_dir(folder).args(arguments).output().expect("torse runs")
}

#[test]
fn no_file_that_a_job_reads_is_replaced_by_its_result() {
    let room = tempfile::tempdir().expect("room");
    let rail = |name: &str, z: f64| {
        let row = |k: u32| format!("{},{},{z}\n", 10 * k, f64::from(k * (10 - k)));
        fs::write(room.path().join(name), (0..=10).map(row).collect::<String>()).expect("a rail");
    };
    rail("a.csv", 0.0);
    rail("b.csv", 50.0);
    let loft = |a: &str, b: &str, more: &[&str]| {
        let all = [&["loft", a, b, "--unit", "mm", "-t", "0.1mm", "-o", "out"], more].concat();
        torse(room.path(), &all)
    };
    assert_eq!(loft("a.csv", "b.csv", &[]).status.code(), Some(0));
    let panels = room.path().join("out/panels.step");
    let before = fs::read(&panels).expect("panels");
    // The second of two files, too.
    fs::copy(room.path().join("b.csv"), room.path().join("out/b.csv")).expect("a copy");
    let second = loft("a.csv", "out/b.csv", &["--force"]);
    assert!(second.status.code() == Some(2) && text(&second.stderr).contains("out/b.csv"), "{}", text(&second.stderr));
    // One that is named in a job.
    fs::write(room.path().join("job.json"), r#"{ "unit": "mm", "from": [{ "panels": "out/panels.step" }] }"#)
        .expect("a job");
    let shape = torse(room.path(), &["shape", "job.json", "-t", "0.5mm", "-o", "out", "--force"]);
    let told = text(&shape.stderr);
    assert!(told.contains("out-2") && told.contains("panels.step"), "{told}");
    assert_eq!(fs::read(&panels).expect("panels"), before);
    assert!(room.path().join("out-2/panels.step").exists());
}
