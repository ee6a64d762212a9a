//! The hidden folder beside the target in which a result comes into being, how files move from there into a folder
//! that holds others, and how the next run finds what a killed one has left.
//!
//! A workspace holds `run.json`, which the run keeps locked as long as it lives; `result/`, the files to be; and,
//! while files of an earlier result are being replaced, `old/`, those files. Whatever happens in between, the new files
//! that are in place can be taken back and the old ones returned, by the run itself or by the next one.

use super::manifest::{self, Entry, MANIFEST};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The mark by which a workspace is recognised, locked by its run.
const RUN: &str = "run.json";

/// What a run delivers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A folder, with the list of its files.
    Folder,
    /// A single file, beside files of others.
    File,
}

impl Form {
    /// Name and version of the form of the mark.
    fn schema(self) -> &'static str {
        match self {
            Self::Folder => "torse-run/1",
            Self::File => "torse-file-run/1",
        }
    }

    /// The folder in which files of the target `name` are put.
    fn files_in(self, parent: &Path, name: &str) -> PathBuf {
        match self {
            Self::Folder => parent.join(name),
            Self::File => parent.to_path_buf(),
        }
    }
}

/// The files to be.
const RESULT: &str = "result";
/// Files of an earlier result, while they are replaced.
const OLD: &str = "old";
/// Why nothing is put where something is.
pub const TAKEN: &str = "something was put there meanwhile";

/// What the mark says.
#[derive(Serialize, Deserialize)]
struct Mark {
    schema: String,
    /// Name of the target.
    target: String,
    /// For people who wonder whose it is.
    process: u32,
}

/// A workspace of this run. Dropped, it goes with all that it holds.
pub struct Workspace {
    folder: tempfile::TempDir,
    /// Held, not used: the lock ends with the process, however that ends.
    _lock: File,
}

/// What the names of workspaces have in common.
const PARTIAL: &str = ".partial-";

/// How the names of the workspaces for a target begin.
fn prefix(name: &str) -> String {
    format!(".{name}{PARTIAL}")
}

impl Workspace {
    /// A new workspace in `parent` for a target called `name`.
    pub fn new(parent: &Path, name: &str, form: Form) -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix(&prefix(name)).tempdir_in(parent)?;
        let mut lock = File::create_new(folder.path().join(RUN))?;
        match lock.try_lock() {
            // A disk without locks has no dead runs either: nobody can tell, nobody cleans.
            Ok(()) | Err(TryLockError::Error(_)) => {}
            Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::ResourceBusy.into()),
        }
        let says = Mark { schema: form.schema().into(), target: name.to_owned(), process: std::process::id() };
        lock.write_all(serde_json::to_string(&says)?.as_bytes())?;
        lock.sync_all()?;
        fs::create_dir(folder.path().join(RESULT))?;
        Ok(Self { folder, _lock: lock })
    }

    /// The workspace itself.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The folder of the files to be.
    pub fn result(&self) -> PathBuf {
        self.folder.path().join(RESULT)
    }

    /// Leaves the workspace where it is for people to look into, without the mark by which others would clean it.
    pub fn keep(self) -> PathBuf {
        // It stays either way.
        let _ = fs::remove_file(self.folder.path().join(RUN));
        self.folder.keep()
    }

    /// Leaves the workspace as a killed run does.
    #[cfg(test)]
    pub fn abandon(self) -> PathBuf {
        let Self { folder, _lock } = self;
        folder.keep()
    }
}

/// Moves a whole folder to a place where nothing is. Never replaces anything: the place is taken by making an empty
/// folder there, which fails where something is, and moving a folder over another fails unless that is empty.
///
/// # Errors
/// Something is there already (`AlreadyExists`), or the disk refuses.
pub fn move_to_free(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir(to)?;
    let moved = move_to_empty(from, to);
    if moved.is_err() {
        // Still ours if empty; else somebody uses it by now.
        let _ = fs::remove_dir(to);
    }
    moved
}

/// Moves a whole folder over an empty one.
///
/// # Errors
/// It is no longer empty, or the disk refuses.
pub fn move_to_empty(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to).or_else(|refused| {
        // Some systems move no folder over another, not even an empty one.
        fs::remove_dir(to).map_err(|_| refused)?;
        fs::rename(from, to)
    })
}

/// Moves a file to a place where nothing is; never replaces anything. What was put in the place of a file may be a folder.
pub fn move_file(from: &Path, to: &Path) -> io::Result<()> {
    if fs::symlink_metadata(from)?.is_dir() {
        return move_to_free(from, to);
    }
    match fs::hard_link(from, to) {
        Ok(()) => {}
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => return Err(e),
        // Not every disk knows links.
        Err(_) => {
            let mut copy = File::create_new(to)?;
            io::copy(&mut File::open(from)?, &mut copy)?;
            copy.sync_all()?;
        }
    }
    fs::remove_file(from)
}

/// Puts the files of `workspace/result` in place of the files `own` in `target`, and touches nothing else. The first of
/// `own` is taken away first and the list of the new files put there last, so that of several runs one gets through. A single
/// file gets no list beside it.
///
/// # Errors
/// Why it cannot be done, in words; then everything is as it was.
pub fn replace(workspace: &Path, target: &Path, own: &[Entry], form: Form) -> Result<(), String> {
    let replaced = exchange(workspace, target, own, form);
    if replaced.is_err() {
        undo(workspace, target).map_err(|e| format!("the earlier files could not be put back: {e}"))?;
    }
    replaced
}

fn exchange(workspace: &Path, target: &Path, own: &[Entry], form: Form) -> Result<(), String> {
    let (result, old) = (workspace.join(RESULT), workspace.join(OLD));
    let failed = |e: io::Error| e.to_string();
    if !fs::symlink_metadata(target).is_ok_and(|m| m.is_dir()) {
        return Err("the folder has gone".into());
    }
    fs::create_dir(&old).map_err(failed)?;
    for (k, entry) in own.iter().enumerate() {
        let (from, to) = (target.join(&entry.name), old.join(&entry.name));
        match fs::rename(&from, &to) {
            Ok(()) if entry.is(&to) => {}
            Ok(()) => return Err(format!("{} was changed meanwhile", entry.name)),
            // Whoever took the other files away wants them away; the first one is taken by another run.
            Err(e) if k > 0 && e.kind() == io::ErrorKind::NotFound => {}
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Err("another run replaced it meanwhile".into()),
            Err(e) => return Err(failed(e)),
        }
    }
    let new = manifest::read(&result).ok_or("its list of files is missing")?;
    let list = (form == Form::Folder).then_some(MANIFEST);
    for name in new.iter().map(|e| e.name.as_str()).chain(list) {
        move_file(&result.join(name), &target.join(name)).map_err(|e| match (e.kind(), form) {
            (io::ErrorKind::AlreadyExists, Form::Folder) => format!("it holds another {name}"),
            (io::ErrorKind::AlreadyExists, Form::File) => TAKEN.to_owned(),
            _ => failed(e),
        })?;
    }
    if form == Form::File {
        fs::remove_file(result.join(MANIFEST)).map_err(failed)?;
    }
    // All that it holds was found to be ours; what resists goes with the workspace.
    let _ = fs::remove_dir_all(&old);
    Ok(())
}

/// Takes back what [`exchange`] did, as far as it came. Does nothing once the list of the new files has left the workspace:
/// then the exchange is complete.
fn undo(workspace: &Path, target: &Path) -> io::Result<()> {
    let (result, old) = (workspace.join(RESULT), workspace.join(OLD));
    let (Some(new), Ok(entries)) = (manifest::read(&result), fs::read_dir(&old)) else { return Ok(()) };
    for entry in &new {
        let (here, there) = (result.join(&entry.name), target.join(&entry.name));
        if !here.exists() && entry.is(&there) {
            fs::rename(&there, &here)?;
        } else if same_file(&here, &there) {
            fs::remove_file(&there)?;
        }
    }
    let mut names: Vec<PathBuf> = entries.map(|e| Ok(e?.file_name().into())).collect::<io::Result<_>>()?;
    if names.is_empty() {
        return fs::remove_dir(&old);
    }
    // The list last: by it other runs see that all is there.
    names.sort_by_key(|n| n == Path::new(MANIFEST));
    if fs::symlink_metadata(target).is_err() {
        fs::create_dir(target)?;
    }
    for name in names {
        move_file(&old.join(&name), &target.join(&name))?;
    }
    fs::remove_dir(&old)
}

/// Whether two names are one file: a file that is linked to its new place but not yet gone from the old one.
#[cfg(unix)]
pub fn same_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |p: &Path| fs::symlink_metadata(p).ok().map(|m| (m.dev(), m.ino()));
    id(a).is_some() && id(a) == id(b)
}

/// Elsewhere it is not known, and then nothing is taken away.
#[cfg(not(unix))]
pub fn same_file(_a: &Path, _b: &Path) -> bool {
    false
}

/// Removes a workspace whose run ends at once or is dead; the mark goes last, so that what remains is recognised.
pub fn discard(workspace: &Path) -> io::Result<()> {
    let gone = |r: io::Result<()>| r.or_else(|e| if e.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(e) });
    gone(fs::remove_dir_all(workspace.join(RESULT)))?;
    // Not with its contents: files of an earlier result are put back, not removed.
    gone(fs::remove_dir(workspace.join(OLD)))?;
    gone(fs::remove_file(workspace.join(RUN)))?;
    fs::remove_dir(workspace)
}

/// Cleans what killed runs, whatever their targets, have left in `parent`: earlier files go back to their place, half of a
/// result goes away. What belongs to a run that lives is left alone, and so is what is not understood.
pub fn clean(parent: &Path, form: Form) {
    let Ok(entries) = fs::read_dir(parent) else { return };
    for entry in entries.flatten() {
        let Some(name) = entry.file_name().to_str().map(str::to_owned).filter(|n| n.contains(PARTIAL)) else {
            continue;
        };
        if !entry.file_type().is_ok_and(|t| t.is_dir()) {
            continue;
        }
        let path = entry.path();
        let Some((target, _lock)) = dead(&path, form).filter(|(target, _)| name.starts_with(&prefix(target))) else {
            continue;
        };
        let target = form.files_in(parent, &target);
        // What resists stays, with its mark, for the next run.
        let _ = undo(&path, &target).and_then(|()| finished(&path)).and_then(|()| discard(&path));
    }
}

/// Removes the earlier files of a replacement that was complete when its run was killed.
fn finished(workspace: &Path) -> io::Result<()> {
    let old = workspace.join(OLD);
    if !workspace.join(RESULT).join(MANIFEST).exists() && old.is_dir() {
        fs::remove_dir_all(old)?;
    }
    Ok(())
}

/// The target of a workspace whose run has ended, a name without folders, and its lock.
fn dead(workspace: &Path, form: Form) -> Option<(String, File)> {
    let mark = workspace.join(RUN);
    let says: Mark = serde_json::from_slice(&fs::read(&mark).ok()?).ok()?;
    let plain = Path::new(&says.target).file_name().is_some_and(|n| n == says.target.as_str());
    let lock = File::options().write(true).open(&mark).ok()?;
    (says.schema == form.schema() && plain && lock.try_lock().is_ok()).then_some((says.target, lock))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::tests::names;

    /// A workspace with a result of these files, their list included, as a killed run leaves it.
    fn killed(parent: &Path, files: &[&str]) -> PathBuf {
        let workspace = Workspace::new(parent, "panels", Form::Folder).expect("workspace");
        let entries: Vec<Entry> = files.iter().map(|n| Entry::of(n, b"new")).collect();
        for n in files {
            fs::write(workspace.result().join(n), "new").expect("file");
        }
        fs::write(workspace.result().join(MANIFEST), manifest::text(&entries).expect("text")).expect("list");
        workspace.abandon()
    }

    #[test]
    fn leftovers_of_the_dead_go_and_those_of_the_living_stay() {
        let room = tempfile::tempdir().expect("room");
        killed(room.path(), &["a"]);
        let living = Workspace::new(room.path(), "panels", Form::Folder).expect("workspace");
        fs::create_dir(room.path().join(".panels.partial-mine")).expect("a folder of somebody else");
        fs::create_dir(room.path().join(".other.partial-x")).expect("a folder of somebody else");
        assert_eq!(names(room.path()).len(), 4);
        clean(room.path(), Form::Folder);
        assert_eq!(names(room.path()).len(), 3);
        assert!(living.path().is_dir());
        // Whatever the target was.
        let other = Workspace::new(room.path(), "other", Form::Folder).expect("workspace").abandon();
        clean(room.path(), Form::Folder);
        assert!(names(room.path()).len() == 3 && !other.exists());
    }

    /// A run killed at any moment of an exchange: the next one finds either the old files or the new ones, all of them.
    #[test]
    fn an_exchange_that_is_cut_off_anywhere_is_taken_back() {
        for stage in 0..6 {
            let room = tempfile::tempdir().expect("room");
            let target = room.path().join("panels");
            fs::create_dir(&target).expect("folder");
            fs::write(target.join("mine.txt"), "mine").expect("file");
            for n in ["a", "b", MANIFEST] {
                fs::write(target.join(n), "old").expect("file");
            }
            let workspace = killed(room.path(), &["a", "c"]);
            let (result, old) = (workspace.join(RESULT), workspace.join(OLD));
            fs::create_dir(&old).expect("folder");
            let steps: [&dyn Fn() -> io::Result<()>; 6] = [
                &|| fs::rename(target.join(MANIFEST), old.join(MANIFEST)),
                &|| fs::rename(target.join("a"), old.join("a")),
                &|| fs::rename(target.join("b"), old.join("b")),
                &|| move_file(&result.join("a"), &target.join("a")),
                &|| fs::hard_link(result.join("c"), target.join("c")),
                &|| fs::remove_file(result.join("c")),
            ];
            for step in &steps[..=stage] {
                step().expect("a step");
            }
            clean(room.path(), Form::Folder);
            assert_eq!(names(room.path()), ["panels"], "stage {stage}");
            assert_eq!(names(&target), ["a", "b", "mine.txt", MANIFEST], "stage {stage}");
            assert_eq!(fs::read(target.join("a")).expect("file"), b"old");
        }
    }

    #[test]
    fn earlier_files_return_even_if_their_folder_has_gone() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        let workspace = killed(room.path(), &["a"]);
        fs::create_dir(workspace.join(OLD)).expect("folder");
        fs::write(workspace.join(OLD).join("a"), "old").expect("file");
        clean(room.path(), Form::Folder);
        assert_eq!(names(room.path()), ["panels"]);
        assert_eq!(fs::read(target.join("a")).expect("file"), b"old");
    }

    #[test]
    fn a_file_that_came_in_between_stops_the_exchange_and_is_kept() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        fs::create_dir(&target).expect("folder");
        fs::write(target.join("a"), "old").expect("file");
        fs::write(target.join("c"), "mine").expect("file");
        let workspace = killed(room.path(), &["a", "c"]);
        let own = [Entry::of("a", b"old")];
        assert!(replace(&workspace, &target, &own, Form::Folder).expect_err("stopped").contains('c'));
        assert_eq!(fs::read(target.join("a")).expect("file"), b"old");
        assert_eq!(fs::read(target.join("c")).expect("file"), b"mine");
        assert_eq!(names(&workspace.join(RESULT)), ["a", "c", MANIFEST]);
        let own = [Entry::of("a", b"other")];
        assert!(replace(&workspace, &target, &own, Form::Folder).expect_err("stopped").contains("changed"));
        assert_eq!(fs::read(target.join("a")).expect("file"), b"old");
    }

    #[test]
    fn a_place_that_is_taken_stays_taken() {
        let room = tempfile::tempdir().expect("room");
        let (from, to) = (room.path().join("from"), room.path().join("to"));
        fs::create_dir(&from).expect("folder");
        fs::create_dir(&to).expect("folder");
        assert_eq!(move_to_free(&from, &to).expect_err("taken").kind(), io::ErrorKind::AlreadyExists);
        fs::write(to.join("mine"), "mine").expect("file");
        assert!(move_to_empty(&from, &to).is_err());
        assert_eq!(names(&to), ["mine"]);
    }
}
