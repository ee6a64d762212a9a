//! The output folder: written beside its place under a temporary name and moved there when it is complete, so that
//! nobody ever sees half of it.

use crate::failure::{os_reason, Failure};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// File by which an earlier result is recognised; a folder without it is never replaced.
pub const MARK: &str = "report.json";

/// An output folder in the making. Dropped before [`Output::finish`], it leaves no trace.
pub struct Output {
    target: PathBuf,
    staging: tempfile::TempDir,
}

impl Output {
    /// Checks that `target` may be written and creates the temporary folder beside it. Called before the long work,
    /// so that a wrong folder is refused at once. `input` is the file being read, which must not be swept away.
    ///
    /// # Errors
    /// The folder exists and holds something (unless `force` and it is an earlier result), is a file, holds the
    /// input or the working folder, or its parent cannot be written.
    pub fn prepare(target: &Path, input: &Path, force: bool) -> Result<Self, Failure> {
        let shown = target.display();
        let Some(name) = target.file_name().map(|n| n.to_string_lossy().into_owned()) else {
            return Err(Failure::new(
                format!("the output folder '{shown}' has no name of its own"),
                "name a new folder, for example --out panels",
            ));
        };
        let parent = match target.parent() {
            Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
            _ => PathBuf::from("."),
        };
        match fs::metadata(&parent) {
            Ok(m) if m.is_dir() => {}
            Ok(_) => {
                return Err(Failure::new(
                    format!("cannot write '{shown}': '{}' is not a folder", parent.display()),
                    "choose a place inside an existing folder",
                ))
            }
            Err(_) => {
                return Err(Failure::new(
                    format!("cannot write '{shown}': the folder '{}' does not exist", parent.display()),
                    "create it first, or choose another place",
                ))
            }
        }
        if let Ok(metadata) = fs::symlink_metadata(target) {
            may_replace(target, &metadata, input, force)?;
        }
        let staging =
            tempfile::Builder::new().prefix(&format!(".{name}.partial-")).tempdir_in(&parent).map_err(|e| {
                Failure::new(
                    format!("cannot write into '{}': {}", parent.display(), os_reason(&e)),
                    "choose a folder that you may write to",
                )
            })?;
        Ok(Self { target: target.to_path_buf(), staging })
    }

    /// The temporary folder.
    pub fn staging(&self) -> &Path {
        self.staging.path()
    }

    /// Writes one file and makes sure that it has reached the disk.
    ///
    /// # Errors
    /// Whatever the disk says; the temporary folder is then removed with the value.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let written = fs::File::create(self.staging.path().join(name)).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        });
        written.map_err(|e| {
            Failure::new(
                format!(
                    "cannot write {name} ({} kB) for '{}': {}",
                    bytes.len() / 1024 + 1,
                    self.target.display(),
                    os_reason(&e)
                ),
                "nothing was written; free some space or choose another disk",
            )
        })
    }

    /// Moves the complete folder into its place. An earlier result is kept aside until the new one is there.
    ///
    /// # Errors
    /// The move fails; the earlier result is then back in its place.
    pub fn finish(self) -> Result<(), Failure> {
        let failed = |e: &std::io::Error| {
            Failure::new(
                format!("cannot move the results to '{}': {}", self.target.display(), os_reason(e)),
                "check that nobody else uses that folder, then run again",
            )
        };
        open_to_others(self.staging.path()).map_err(|e| failed(&e))?;
        let old = self.staging.path().with_extension("old");
        let replaced = fs::symlink_metadata(&self.target).is_ok();
        if replaced {
            fs::rename(&self.target, &old).map_err(|e| failed(&e))?;
        }
        let staging = self.staging.path().to_path_buf();
        if let Err(e) = fs::rename(&staging, &self.target) {
            if replaced {
                // Best effort: the error below is told in any case.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(failed(&e));
        }
        if replaced {
            // The new result is complete; what cannot be removed of the old one is only in the way.
            let _ = fs::remove_dir_all(&old);
        }
        // The folder has moved away from under its guard, which has nothing left to remove.
        let _ = self.staging.keep();
        Ok(())
    }
}

/// Whether an existing `target` may be replaced.
fn may_replace(target: &Path, metadata: &fs::Metadata, input: &Path, force: bool) -> Result<(), Failure> {
    let shown = target.display();
    if !metadata.is_dir() {
        return Err(Failure::new(format!("'{shown}' exists and is not a folder"), "choose another name with --out"));
    }
    let mut entries = fs::read_dir(target)
        .map_err(|e| Failure::new(format!("cannot look into '{shown}': {}", os_reason(&e)), "choose another folder"))?;
    let here = fs::canonicalize(target).ok();
    let inside = |path: &Path| matches!((&here, fs::canonicalize(path).ok()), (Some(folder), Some(path)) if path.starts_with(folder));
    if inside(Path::new(".")) {
        return Err(Failure::new(
            format!("the output folder '{shown}' holds the folder you are working in"),
            "name a new folder, for example --out panels",
        ));
    }
    if entries.next().is_none() {
        return Ok(());
    }
    if !force {
        return Err(Failure::new(
            format!("the output folder '{shown}' exists already"),
            "choose another folder, or add --force to replace an earlier result",
        ));
    }
    if inside(input) {
        return Err(Failure::new(
            format!("the output folder '{shown}' holds the input file '{}'", input.display()),
            "choose another folder with --out",
        ));
    }
    if !target.join(MARK).is_file() {
        return Err(Failure::new(
            format!("'{shown}' is not the result of an earlier run (it has no {MARK}), so --force does not replace it"),
            "choose another folder, or remove that one yourself",
        ));
    }
    Ok(())
}

/// Temporary folders are private to their owner; a result gets the rights that a new folder would have.
#[cfg(unix)]
fn open_to_others(folder: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    // The umask can only be read off a folder made the ordinary way.
    let probe = folder.join(".rights");
    fs::create_dir(&probe)?;
    let mode = fs::metadata(&probe)?.permissions().mode();
    fs::remove_dir(&probe)?;
    fs::set_permissions(folder, fs::Permissions::from_mode(mode))
}

/// Elsewhere the rights are inherited from the parent.
#[cfg(not(unix))]
fn open_to_others(_folder: &Path) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("folder")
            .map(|e| e.expect("entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    fn no_input() -> PathBuf {
        PathBuf::from("no-such-input.step")
    }

    #[test]
    fn a_result_appears_whole_or_not_at_all() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        let output = Output::prepare(&target, &no_input(), false).expect("free place");
        output.write("panels.step", b"ISO-10303-21;").expect("written");
        assert!(!target.exists());
        drop(output);
        assert!(names(room.path()).is_empty());

        let output = Output::prepare(&target, &no_input(), false).expect("free place");
        output.write(MARK, b"{}").expect("written");
        output.finish().expect("moved");
        assert_eq!(names(room.path()), ["panels"]);
        assert_eq!(names(&target), [MARK]);
    }

    #[test]
    fn an_earlier_result_is_replaced_only_by_force_and_only_when_complete() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        fs::create_dir(&target).expect("folder");
        fs::write(target.join(MARK), "old").expect("file");
        assert!(Output::prepare(&target, &no_input(), false).err().expect("refused").help.contains("--force"));

        let output = Output::prepare(&target, &no_input(), true).expect("force");
        output.write(MARK, b"new").expect("written");
        assert_eq!(fs::read(target.join(MARK)).expect("still there"), b"old");
        output.finish().expect("moved");
        assert_eq!(fs::read(target.join(MARK)).expect("replaced"), b"new");
        assert_eq!(names(room.path()), ["panels"]);
    }

    #[test]
    fn a_folder_of_somebody_else_is_never_replaced() {
        let room = tempfile::tempdir().expect("room");
        fs::write(room.path().join("thesis.txt"), "precious").expect("file");
        assert!(Output::prepare(room.path(), &no_input(), true).is_err());
        assert!(Output::prepare(&room.path().join("thesis.txt"), &no_input(), true).is_err());
        assert!(Output::prepare(&room.path().join("thesis.txt/out"), &no_input(), true).is_err());
        assert!(Output::prepare(&room.path().join("missing/out"), &no_input(), true).is_err());
        assert!(Output::prepare(Path::new("/"), &no_input(), true).is_err());
        fs::write(room.path().join(MARK), "{}").expect("file");
        let input = room.path().join("hull.step");
        fs::write(&input, "").expect("file");
        let refusal = Output::prepare(room.path(), &input, true).err().expect("refused");
        assert!(refusal.message.contains("holds the input"));
        assert_eq!(names(room.path()).len(), 3);
    }

    #[test]
    fn an_empty_folder_may_be_used() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        fs::create_dir(&target).expect("folder");
        let output = Output::prepare(&target, &no_input(), false).expect("empty folder");
        output.write(MARK, b"{}").expect("written");
        output.finish().expect("moved");
        assert_eq!(names(&target), [MARK]);
    }

    #[test]
    fn a_write_that_fails_names_the_file() {
        let room = tempfile::tempdir().expect("room");
        let output = Output::prepare(&room.path().join("panels"), &no_input(), false).expect("free place");
        let refusal = output.write("no-such-folder/panels.step", b"").expect_err("cannot be written");
        assert!(refusal.message.contains("panels.step"), "{refusal}");
    }
}
