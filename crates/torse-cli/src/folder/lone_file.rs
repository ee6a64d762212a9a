//! A single file under a name that the user chose, put there when the work is done. The rules are those of the output
//! folder: only what Torse wrote is replaced, links are not followed, and what appears during the work is left alone.

use super::manifest::{self, Entry, MANIFEST};
use super::workspace::{self, Form, Workspace};
use super::{place_of, workspace_in, OTHER_NAMES};
use crate::failure::{os_reason, Failure};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An output file whose place was looked at.
#[derive(Debug)]
pub struct LoneFile {
    target: PathBuf,
    parent: PathBuf,
    name: String,
    /// The file of an earlier run that is there.
    earlier: Option<Entry>,
}

/// Where a file came to be.
#[derive(Debug)]
struct Delivered {
    file: PathBuf,
    remark: Option<String>,
}

impl LoneFile {
    /// Checks that `target` may be written, before the work; with `force` a plain file may be there if `is_own` says that
    /// this command can have written its contents.
    ///
    /// # Errors
    /// Anything else is there, the name cannot be used, or its folder does not exist.
    pub fn prepare(target: &Path, force: bool, is_own: impl Fn(&[u8]) -> bool) -> Result<Self, Failure> {
        const OTHER: &str = "choose another name with --out";
        let (parent, name) = place_of(target)?;
        let shown = target.display();
        if target.file_name().is_some_and(|n| n.to_str().is_none()) || name == MANIFEST {
            return Err(Failure::new(format!("'{shown}' is no name for a file of this command"), OTHER));
        }
        workspace::clean(&parent, Form::File);
        let earlier = match fs::symlink_metadata(target) {
            Err(_) => None,
            Ok(found) if found.is_symlink() => return Err(Failure::new(format!("'{shown}' is a link"), OTHER)),
            Ok(found) if !found.is_file() => {
                return Err(Failure::new(format!("'{shown}' exists and is not a file"), OTHER))
            }
            Ok(_) if !force => {
                return Err(Failure::new(
                    format!("'{shown}' exists already"),
                    "choose another name, or --force to replace it if this command wrote it",
                ))
            }
            Ok(_) => {
                let bytes = fs::read(target)
                    .map_err(|e| Failure::new(format!("cannot read '{shown}': {}", os_reason(&e)), OTHER))?;
                if !is_own(&bytes) {
                    return Err(Failure::new(
                        format!("'{shown}' is not as this command writes files, so --force does not replace it"),
                        "choose another name with --out, or remove that file by hand",
                    ));
                }
                Some(Entry::of(&name, &bytes))
            }
        };
        Ok(Self { target: target.to_path_buf(), parent, name, earlier })
    }

    /// Writes the file and puts it in its place, or, where that was taken or changed meanwhile, beside it; tells on stderr
    /// what is not as asked. The file that was written.
    ///
    /// # Errors
    /// The disk refuses; then nothing was changed, or the message says where the file is.
    pub fn finish(self, bytes: &[u8]) -> Result<PathBuf, Failure> {
        let delivered = self.deliver(bytes)?;
        if let Some(remark) = delivered.remark {
            // A closed stderr leaves nobody to tell.
            let _ = writeln!(io::stderr(), "note: {remark}");
        }
        Ok(delivered.file)
    }

    fn deliver(self, bytes: &[u8]) -> Result<Delivered, Failure> {
        let shown = self.target.display().to_string();
        let workspace = workspace_in(&self.parent, &self.name, Form::File)?;
        self.fill(&workspace, bytes).map_err(|e| {
            Failure::new(
                format!("cannot write '{shown}' ({} kB): {}", bytes.len() / 1024 + 1, os_reason(&e)),
                "nothing was written; free some space or choose another disk",
            )
        })?;
        let gone = fs::symlink_metadata(&self.target).is_err();
        let own: &[Entry] = if gone { &[] } else { self.earlier.as_slice() };
        let taken = match workspace::replace(workspace.path(), &self.parent, own, Form::File) {
            Ok(()) => return Ok(Delivered { file: self.target, remark: None }),
            Err(reason) => reason,
        };
        for k in OTHER_NAMES {
            let beside = self.parent.join(numbered(&self.name, k));
            match workspace::move_file(&workspace.result().join(&self.name), &beside) {
                Ok(()) => {
                    let remark =
                        format!("'{shown}' was left as it is: {taken}; the result is in '{}'", beside.display());
                    return Ok(Delivered { file: beside, remark: Some(remark) });
                }
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(_) => break,
            }
        }
        let kept = workspace.keep();
        Err(Failure::new(
            format!("cannot move the result to '{shown}': {taken}"),
            format!("it is complete in '{}'; move it from there", kept.display()),
        ))
    }

    /// Writes the contents into the workspace, with the list by which an exchange that is cut off is taken back.
    fn fill(&self, workspace: &Workspace, bytes: &[u8]) -> io::Result<()> {
        let list = manifest::text(&[Entry::of(&self.name, bytes)])?;
        for (name, contents) in [(self.name.as_str(), bytes), (MANIFEST, list.as_bytes())] {
            let mut file = File::create_new(workspace.result().join(name))?;
            file.write_all(contents)?;
            file.sync_all()?;
        }
        Ok(())
    }
}

/// The name with a number before its extension.
fn numbered(name: &str, k: usize) -> String {
    match name.rsplit_once('.') {
        Some((stem, extension)) if !stem.is_empty() => format!("{stem}-{k}.{extension}"),
        _ => format!("{name}-{k}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::tests::names;

    /// What this command writes begins so, for these tests.
    fn own(bytes: &[u8]) -> bool {
        bytes.starts_with(b"torse")
    }

    fn read(path: &Path) -> String {
        fs::read_to_string(path).expect("a file")
    }

    #[test]
    fn a_file_appears_at_once_and_is_replaced_only_by_force_and_only_if_it_is_ours() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("m.csv");
        let made = LoneFile::prepare(&target, false, own).expect("free").finish(b"torse 1").expect("written");
        assert_eq!((made.as_path(), read(&target).as_str()), (target.as_path(), "torse 1"));
        assert!(LoneFile::prepare(&target, false, own).expect_err("refused").message.contains("exists already"));
        let delivered = LoneFile::prepare(&target, true, own).expect("ours").deliver(b"torse 2").expect("written");
        assert!(delivered.remark.is_none(), "{delivered:?}");
        assert_eq!(read(&target), "torse 2");
        assert_eq!(names(room.path()), ["m.csv"]);

        let thesis = room.path().join("thesis.docx");
        fs::write(&thesis, "precious").expect("file");
        let refusal = LoneFile::prepare(&thesis, true, own).expect_err("refused");
        assert!(refusal.message.contains("thesis.docx") && refusal.help.contains("by hand"), "{refusal}");
        assert!(LoneFile::prepare(room.path(), true, own).expect_err("refused").message.contains("not a file"));
        assert!(LoneFile::prepare(&room.path().join("missing/m.csv"), true, own).is_err());
        assert_eq!(read(&thesis), "precious");
    }

    #[test]
    fn what_appears_or_changes_meanwhile_is_left_alone() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("m.csv");
        let file = LoneFile::prepare(&target, false, own).expect("free");
        fs::write(&target, "precious").expect("file");
        let delivered = file.deliver(b"torse 1").expect("beside");
        assert_eq!((read(&target).as_str(), read(&delivered.file).as_str()), ("precious", "torse 1"));
        assert_eq!(delivered.file, room.path().join("m-2.csv"));
        assert!(delivered.remark.expect("said").contains("m.csv' was left as it is"));

        let target = room.path().join("n.csv");
        let changes: [fn(&Path) -> io::Result<()>; 2] =
            [|p| fs::write(p, "torse, and mine"), |p| fs::remove_file(p).and_then(|()| fs::create_dir(p))];
        for (change, beside) in changes.into_iter().zip(["n-2.csv", "n-3.csv"]) {
            fs::write(&target, "torse 0").expect("file");
            let file = LoneFile::prepare(&target, true, own).expect("ours");
            change(&target).expect("changed");
            let delivered = file.deliver(b"torse 1").expect("beside");
            assert_eq!(delivered.file, room.path().join(beside));
            assert_eq!(read(&delivered.file), "torse 1");
            assert!(target.is_dir() || read(&target) == "torse, and mine");
        }
        fs::remove_dir(&target).expect("removed");
        // One that is gone leaves its place free.
        fs::write(&target, "torse 0").expect("file");
        let file = LoneFile::prepare(&target, true, own).expect("ours");
        fs::remove_file(&target).expect("removed");
        assert_eq!(file.deliver(b"torse 1").expect("written").file, target);
        assert_eq!(names(room.path()), ["m-2.csv", "m.csv", "n-2.csv", "n-3.csv", "n.csv"]);
    }

    #[test]
    #[cfg(unix)]
    fn links_are_refused_and_never_written_through() {
        use std::os::unix::fs::symlink;
        let room = tempfile::tempdir().expect("room");
        let (link, victim) = (room.path().join("link.csv"), room.path().join("victim.csv"));
        symlink(&victim, &link).expect("link");
        for force in [false, true] {
            assert!(LoneFile::prepare(&link, force, own).expect_err("refused").message.contains("is a link"));
        }
        let target = room.path().join("m.csv");
        let file = LoneFile::prepare(&target, true, own).expect("free");
        symlink(&victim, &target).expect("link");
        assert_eq!(file.deliver(b"torse 1").expect("beside").file, room.path().join("m-2.csv"));
        assert!(!victim.exists());
        assert_eq!(names(room.path()), ["link.csv", "m-2.csv", "m.csv"]);
    }

    /// A run killed at any moment of an exchange: the next one finds the earlier file.
    #[test]
    fn an_exchange_that_is_cut_off_is_taken_back() {
        for stage in 0..3 {
            let room = tempfile::tempdir().expect("room");
            let target = room.path().join("m.csv");
            fs::write(&target, "torse 0").expect("file");
            let file = LoneFile::prepare(&target, true, own).expect("ours");
            let workspace = Workspace::new(room.path(), "m.csv", Form::File).expect("workspace");
            file.fill(&workspace, b"torse 1").expect("written");
            let (result, old) = (workspace.result(), workspace.path().join("old"));
            workspace.abandon();
            fs::create_dir(&old).expect("folder");
            if stage > 0 {
                fs::rename(&target, old.join("m.csv")).expect("taken away");
            }
            if stage > 1 {
                fs::rename(result.join("m.csv"), &target).expect("put");
            }
            // A folder of that name would be another run's business.
            workspace::clean(room.path(), Form::Folder);
            assert_eq!(names(room.path()).len(), if stage == 1 { 1 } else { 2 });
            workspace::clean(room.path(), Form::File);
            assert_eq!(names(room.path()), ["m.csv"], "stage {stage}");
            assert_eq!(read(&target), "torse 0", "stage {stage}");
        }
    }
}
