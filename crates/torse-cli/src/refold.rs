//! `torse refold`: a result bent back and compared with its panels.

use crate::args::Refold;
use crate::failure::Failure;
use crate::folder::Output;
use crate::terminal::Terminal;
use std::io::Write as _;
use std::path::Path;
use torse::pipeline::refold::refold;

/// The bytes of a file of a result, if it is there and can be read.
pub fn file_of(folder: &Path) -> Result<impl Fn(&str) -> Option<Vec<u8>> + Sync + '_, Failure> {
    if !folder.is_dir() {
        return Err(Failure::new(
            format!("'{}' is no folder", folder.display()),
            "give the folder that another command wrote with --out",
        ));
    }
    Ok(move |name: &str| std::fs::read(folder.join(name)).ok())
}

/// Runs the job; `Ok(true)` means that it is certified: no part was left out, and all are proven within the tolerance.
pub fn run(arguments: &Refold) -> Result<bool, Failure> {
    let folder = &arguments.folder;
    let file = file_of(folder)?;
    let output = Output::prepare(&arguments.out, &folder.join("report.json"), arguments.force)?;
    let terminal = Terminal::new(arguments.quiet, None)?;
    terminal.guard(Some(output.workspace().to_path_buf()));
    terminal.say("bending back");
    let answer = refold(&file, arguments.tolerance.as_ref().map(|t| t.mm), terminal.control()).map_err(|e| {
        Failure::new(
            format!("{}: {e}", folder.display()),
            "give a folder as another command wrote it, with all its files",
        )
    })?;
    terminal.say("writing");
    for (name, bytes) in answer.files().map_err(|e| Failure::fault(&std::io::Error::other(e)))? {
        output.write(&name, &bytes)?;
    }
    terminal.guard(None);
    terminal.finish();
    let made = output.finish()?;
    let report = answer.report();
    if !arguments.quiet {
        // A closed pipe is no reason to fail after the work is done.
        let mut out = std::io::stdout().lock();
        let _ = write!(out, "{}", report.words());
        let _ = writeln!(out, "  written {}", made.display());
    }
    Ok(answer.status() == torse::Status::Certified)
}
