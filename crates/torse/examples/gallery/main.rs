//! Makes the pictures of `docs/gallery.md`: `cargo run --release --example gallery`.
//!
//! The page says what is done. Its commands, the blocks marked `sh`, are run one by one from the root of the checkout, with
//! the program in release mode on the path; they write below `target/gallery`. A block marked `text` below a command is
//! what it prints. Then `target/gallery/a/b.png` becomes the small picture `docs/images/gallery/a/b.png` for every picture
//! that the page shows. With `-- pictures` the commands are not run again.

mod page;
mod shrink;

use page::Page;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

type Done<T> = Result<T, Box<dyn Error>>;

/// Where commands write, as the page says it.
const RESULTS: &str = "target/gallery";
/// Where small pictures go.
const PICTURES: &str = "docs/images/gallery";
/// Bytes of one picture, and of all.
const MOST_BYTES: usize = 25_000;
const MOST_OF_ALL: usize = 1_500_000;

fn main() -> Done<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let page = Page::read(&std::fs::read_to_string(root.join("docs/gallery.md"))?)?;
    match std::env::args().nth(1).as_deref() {
        None => run(&root, &page)?,
        Some("pictures") => {}
        Some(other) => return Err(format!("'{other}' is not known; '-- pictures' makes the pictures only").into()),
    }
    let mut total = 0;
    for picture in &page.pictures {
        let from = root.join(RESULTS).join(&picture.file);
        let bytes = std::fs::read(&from).map_err(|e| format!("{}: {e}", from.display()))?;
        let small = shrink::shrink(&bytes, picture.width, MOST_BYTES).map_err(|e| format!("{}: {e}", picture.file))?;
        let to = root.join(PICTURES).join(&picture.file);
        std::fs::create_dir_all(to.parent().unwrap_or(&root))?;
        std::fs::write(to, &small)?;
        total += small.len();
    }
    say(&format!("{} pictures, {} kB in all", page.pictures.len(), total / 1000));
    if total > MOST_OF_ALL {
        return Err(format!("{total} bytes of pictures; {MOST_OF_ALL} are allowed").into());
    }
    Ok(())
}

fn say(line: &str) {
    // A closed pipe is no reason to stop.
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Runs the commands of the page.
fn run(root: &Path, page: &Page) -> Done<()> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let mut build = Command::new(&cargo);
    build.args(["build", "--release", "--workspace", "--bins", "--examples"]).current_dir(root);
    if !build.status()?.success() {
        return Err("the program cannot be built".into());
    }
    let results = root.join(RESULTS);
    if results.exists() {
        std::fs::remove_dir_all(&results)?;
    }
    std::fs::create_dir_all(&results)?;
    let path = path(&root.join("target"))?;
    for step in &page.steps {
        let start = Instant::now();
        let words: Vec<&str> = step.command.split_whitespace().collect();
        let (program, arguments) = words.split_first().ok_or("an empty command")?;
        let mut command = Command::new(if *program == "cargo" { cargo.as_str() } else { program });
        command.args(arguments).env("PATH", &path).current_dir(root);
        let output = command.stderr(Stdio::inherit()).output().map_err(|e| format!("{program}: {e}"))?;
        if !output.status.success() {
            return Err(format!("{}: {}", step.command, output.status).into());
        }
        let printed = String::from_utf8(output.stdout)?;
        if step.prints.as_ref().is_some_and(|p| p.trim() != printed.trim()) {
            return Err(format!("{} prints something else than the page says:\n{printed}", step.command).into());
        }
        say(&format!("{:6.1} s  {}", start.elapsed().as_secs_f64(), step.command));
    }
    Ok(())
}

/// The search path with the program of this checkout in front.
fn path(target: &Path) -> Done<std::ffi::OsString> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(target.to_path_buf(), PathBuf::from);
    let given = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(target.join("release")).chain(std::env::split_paths(&given));
    Ok(std::env::join_paths(folders)?)
}
