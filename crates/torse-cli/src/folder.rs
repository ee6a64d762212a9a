//! The output folder: written beside its place under a temporary name and moved there when it is complete, so that
//! nobody ever sees half of it. Only what Torse wrote is ever replaced.

mod lone_file;
mod manifest;
mod surplus;
mod workspace;

pub use lone_file::LoneFile;
pub use surplus::{remove_surplus, Numbered};
pub use workspace::discard;

use crate::failure::{os_reason, Failure};
use crate::input::first_read;
use manifest::{Counted, Entry, Inventory, MANIFEST};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use torse::io::bundle::Contents;
use workspace::{Form, Workspace};

/// Names that are tried for a result whose place was taken meanwhile.
const OTHER_NAMES: std::ops::RangeInclusive<usize> = 2..=999;
/// Names of foreign files that are told; the others are counted.
const NAMES_TOLD: usize = 6;

/// What is at the target before the work begins.
enum Place {
    /// Nothing.
    Free,
    /// A folder with nothing in it.
    Empty,
    /// An earlier result, perhaps among other things.
    Earlier(Inventory),
}

/// An output folder in the making. Dropped before [`Output::finish`], it leaves no trace.
pub struct Output {
    target: PathBuf,
    parent: PathBuf,
    name: String,
    place: Place,
    workspace: Workspace,
    /// By name: a file that is written twice counts once.
    written: Mutex<BTreeMap<String, Entry>>,
}

/// A file that is written, and what its list says of it.
struct Listed<'a> {
    out: io::BufWriter<fs::File>,
    counted: &'a mut Counted,
}

impl Write for Listed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.counted.add(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Where a result came to be.
#[derive(Debug)]
struct Delivered {
    folder: PathBuf,
    remark: Option<String>,
}

impl Output {
    /// Checks that `target` may be written, cleans what killed runs have left, and creates the temporary folder beside
    /// it. Called before the long work, so that a wrong folder is refused at once. `input` is the file being
    /// read; those that were read so far count, too.
    ///
    /// # Errors
    /// The folder exists and holds something (unless `force` and that is an earlier result whose files can be told from
    /// others), is a file or a link, holds the input or the working folder, or its parent cannot be written.
    pub fn prepare(target: &Path, input: &Path, force: bool) -> Result<Self, Failure> {
        let (parent, name) = place_of(target)?;
        workspace::clean(&parent, Form::Folder);
        let place = match fs::symlink_metadata(target) {
            Ok(metadata) => inspect(target, &metadata, input, force)?,
            Err(_) => Place::Free,
        };
        let workspace = workspace_in(&parent, &name, Form::Folder)?;
        Ok(Self { target: target.to_path_buf(), parent, name, place, workspace, written: Mutex::default() })
    }

    /// The temporary folder, to be given to [`discard`] should the program have to end at once.
    pub fn workspace(&self) -> &Path {
        self.workspace.path()
    }

    /// Writes one file, over one of its name, and makes sure that it has reached the disk.
    ///
    /// # Errors
    /// Whatever the disk says; the temporary folder is then removed with the value.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        self.write_by(name, &mut |out| out.write_all(bytes))
    }

    /// As [`Output::write`], of contents that are written piece by piece.
    ///
    /// # Errors
    /// As [`Output::write`], and those of `contents`.
    pub fn write_by(&self, name: &str, contents: Contents) -> Result<(), Failure> {
        let entry = self.put(name, contents)?;
        self.written().insert(name.to_owned(), entry);
        Ok(())
    }

    fn written(&self) -> MutexGuard<'_, BTreeMap<String, Entry>> {
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn put(&self, name: &str, contents: Contents) -> Result<Entry, Failure> {
        let mut counted = Counted::default();
        let written = fs::File::create(self.workspace.result().join(name)).and_then(|file| {
            let mut out = Listed { out: io::BufWriter::new(file), counted: &mut counted };
            contents(&mut out)?;
            out.out.into_inner()?.sync_all()
        });
        let of_disk = |e: &io::Error| !matches!(e.kind(), io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput);
        match written {
            Ok(()) => Ok(counted.entry(name)),
            Err(e) if of_disk(&e) => Err(Failure::new(
                format!("cannot write {name} for '{}': {}", self.target.display(), os_reason(&e)),
                "nothing was written; free some space or choose another disk",
            )),
            Err(e) => Err(Failure::new(format!("cannot write {name}: {e}"), "this is a fault of the program")),
        }
    }

    /// Moves the complete result into its place, or, where that was taken meanwhile, beside it; tells on stderr what
    /// is not as asked. The folder in which the result is.
    ///
    /// # Errors
    /// The result can be moved nowhere; it is then kept where it is, and the message says where.
    pub fn finish(self) -> Result<PathBuf, Failure> {
        let delivered = self.deliver()?;
        if let Some(remark) = delivered.remark {
            // A closed stderr leaves nobody to tell.
            let _ = writeln!(std::io::stderr(), "note: {remark}");
        }
        Ok(delivered.folder)
    }

    fn deliver(self) -> Result<Delivered, Failure> {
        let shown = self.target.display().to_string();
        let written: Vec<Entry> = self.written().values().cloned().collect();
        let list = manifest::text(&written).map_err(|e| {
            Failure::new(format!("cannot list the files of '{shown}': {e}"), "this is a fault of the program")
        })?;
        self.put(MANIFEST, &mut |out| out.write_all(list.as_bytes()))?;
        let taken = match self.settle() {
            Ok(()) => {
                let remark = match &self.place {
                    Place::Earlier(found) if !found.kept.is_empty() => Some(format!(
                        "'{shown}' also holds what Torse did not write or somebody changed; it was kept: {}",
                        told(&found.kept)
                    )),
                    _ => None,
                };
                return Ok(Delivered { folder: self.target, remark });
            }
            Err(reason) => reason,
        };
        let result = self.workspace.result();
        for k in OTHER_NAMES {
            let beside = self.parent.join(format!("{}-{k}", self.name));
            match workspace::move_to_free(&result, &beside) {
                Ok(()) => {
                    let remark =
                        format!("'{shown}' was left as it is: {taken}; the result is in '{}'", beside.display());
                    return Ok(Delivered { folder: beside, remark: Some(remark) });
                }
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(_) => break,
            }
        }
        let kept = self.workspace.keep();
        Err(Failure::new(
            format!("cannot move the results to '{shown}': {taken}"),
            format!("they are complete in '{}'; move them from there", kept.display()),
        ))
    }

    /// Puts the result in its place.
    ///
    /// # Errors
    /// Why that cannot be done, in words; then nothing was changed.
    fn settle(&self) -> Result<(), String> {
        let result = self.workspace.result();
        let in_words = |e: std::io::Error| match e.kind() {
            std::io::ErrorKind::AlreadyExists | std::io::ErrorKind::DirectoryNotEmpty => workspace::TAKEN.to_owned(),
            _ => os_reason(&e),
        };
        let gone = fs::symlink_metadata(&self.target).is_err();
        // Some files are read in the middle of a job, as those that the file of a job names.
        let here = fs::canonicalize(&self.target).ok();
        let inside =
            |file: &Path| here.as_ref().zip(fs::canonicalize(file).ok()).is_some_and(|(h, f)| f.starts_with(h));
        if let Some(file) = first_read(inside).filter(|_| !gone) {
            return Err(format!("it holds '{}', which this job has read", file.display()));
        }
        match &self.place {
            Place::Earlier(found) if !gone => {
                workspace::replace(self.workspace.path(), &self.target, &found.own, Form::Folder)
            }
            Place::Empty if !gone => workspace::move_to_empty(&result, &self.target).map_err(in_words),
            _ => workspace::move_to_free(&result, &self.target).map_err(in_words),
        }
    }
}

/// The existing folder that `target` is to be in, and its name there.
///
/// # Errors
/// It has no name, or there is no such folder.
fn place_of(target: &Path) -> Result<(PathBuf, String), Failure> {
    let shown = target.display();
    let Some(name) = target.file_name().map(|n| n.to_string_lossy().into_owned()) else {
        return Err(Failure::new(
            format!("the output '{shown}' has no name of its own"),
            "give a new name, for example --out panels",
        ));
    };
    let parent = match target.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
        _ => PathBuf::from("."),
    };
    match fs::metadata(&parent) {
        Ok(m) if m.is_dir() => Ok((parent, name)),
        Ok(_) => Err(Failure::new(
            format!("cannot write '{shown}': '{}' is not a folder", parent.display()),
            "choose a place inside an existing folder",
        )),
        Err(_) => Err(Failure::new(
            format!("cannot write '{shown}': the folder '{}' does not exist", parent.display()),
            "create it first, or choose another place",
        )),
    }
}

/// A new workspace for the target `name` in `parent`.
///
/// # Errors
/// Nothing can be written there.
fn workspace_in(parent: &Path, name: &str, form: Form) -> Result<Workspace, Failure> {
    Workspace::new(parent, name, form).map_err(|e| {
        Failure::new(
            format!("cannot write into '{}': {}", parent.display(), os_reason(&e)),
            "choose a folder that you may write to",
        )
    })
}

/// Whether two names lead to one file that is there.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    let real = |p: &Path| fs::canonicalize(p).ok();
    real(a).is_some_and(|r| real(b).is_some_and(|s| r == s || workspace::same_file(&r, &s)))
}

/// Whether a path is that of a file of the result in a folder, or would be taken for one of its files there.
pub fn is_of_result(path: &Path, folder: &Path) -> bool {
    let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let parent = real.parent().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p });
    let beside = parent.is_some_and(|p| is_same_file(p, folder));
    let name = real.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    if beside && manifest::is_result_name(&name) {
        return true;
    }
    let listed = manifest::read(folder).unwrap_or_default();
    listed.iter().any(|e| (beside && e.name == name) || is_same_file(&real, &folder.join(&e.name)))
}

/// Names for people, the first few of them.
fn told(names: &[String]) -> String {
    let mut text = names.iter().take(NAMES_TOLD).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > NAMES_TOLD {
        text += &format!(" and {} more", names.len() - NAMES_TOLD);
    }
    text
}

/// What an existing `target` is, if it may be used.
fn inspect(target: &Path, metadata: &fs::Metadata, input: &Path, force: bool) -> Result<Place, Failure> {
    let shown = target.display();
    if metadata.is_symlink() {
        return Err(Failure::new(format!("'{shown}' is a link"), "name the folder itself with --out"));
    }
    if !metadata.is_dir() {
        return Err(Failure::new(format!("'{shown}' exists and is not a folder"), "choose another name with --out"));
    }
    let found = manifest::inspect(target)
        .map_err(|e| Failure::new(format!("cannot look into '{shown}': {}", os_reason(&e)), "choose another folder"))?;
    let here = fs::canonicalize(target).ok();
    let inside = |path: &Path| matches!((&here, fs::canonicalize(path).ok()), (Some(folder), Some(path)) if path.starts_with(folder));
    if inside(Path::new(".")) {
        return Err(Failure::new(
            format!("the output folder '{shown}' holds the folder you are working in"),
            "name a new folder, for example --out panels",
        ));
    }
    if found.own.is_empty() && found.kept.is_empty() {
        return Ok(Place::Empty);
    }
    if !force {
        return Err(Failure::new(
            format!("the output folder '{shown}' exists already"),
            "choose another folder, or add --force to replace the files of an earlier result in it",
        ));
    }
    if let Some(file) = inside(input).then(|| input.to_path_buf()).or_else(|| first_read(inside)) {
        return Err(Failure::new(
            format!("the output folder '{shown}' holds the input file '{}'", file.display()),
            "choose another folder with --out",
        ));
    }
    if found.own.is_empty() {
        return Err(Failure::new(
            format!(
                "'{shown}' holds no result of an earlier run that has a list of its files (no {MANIFEST} of Torse), so \
                 --force replaces nothing there"
            ),
            "choose another folder with --out, or remove that one by hand",
        ));
    }
    let in_the_way: Vec<String> = found.kept.iter().filter(|n| manifest::is_result_name(n)).cloned().collect();
    if !in_the_way.is_empty() {
        return Err(Failure::new(
            format!(
                "'{shown}' holds files that were changed after Torse wrote them, or that it never wrote: {}",
                told(&in_the_way)
            ),
            "--force does not replace them; move them away, or choose another folder",
        ));
    }
    Ok(Place::Earlier(found))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a folder holds.
    pub fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("folder")
            .map(|e| e.expect("entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    pub fn no_input() -> PathBuf {
        PathBuf::from("no-such-input.step")
    }

    /// A result of these files, delivered.
    fn result(target: &Path, force: bool, files: &[&str]) -> Result<Delivered, Failure> {
        let output = Output::prepare(target, &no_input(), force)?;
        for f in files {
            output.write(f, f.as_bytes())?;
        }
        output.deliver()
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

        result(&target, false, &["report.json"]).expect("moved");
        assert_eq!(names(room.path()), ["panels"]);
        assert_eq!(names(&target), ["report.json", MANIFEST]);
    }

    #[test]
    #[cfg(unix)]
    fn a_result_has_the_rights_of_a_new_folder() {
        use std::os::unix::fs::PermissionsExt;
        let room = tempfile::tempdir().expect("room");
        fs::create_dir(room.path().join("new")).expect("folder");
        result(&room.path().join("panels"), false, &["a.dxf"]).expect("moved");
        let mode = |n: &str| fs::metadata(room.path().join(n)).expect("folder").permissions().mode();
        assert_eq!(mode("panels"), mode("new"));
    }

    #[test]
    fn an_earlier_result_is_replaced_only_by_force_and_only_when_complete() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        result(&target, false, &["report.json", "sweep.png"]).expect("moved");
        assert!(Output::prepare(&target, &no_input(), false).err().expect("refused").help.contains("--force"));

        let output = Output::prepare(&target, &no_input(), true).expect("force");
        output.write("report.json", b"new").expect("written");
        assert_eq!(fs::read(target.join("report.json")).expect("still there"), b"report.json");
        let delivered = output.deliver().expect("moved");
        assert!(delivered.remark.is_none(), "{delivered:?}");
        assert_eq!(fs::read(target.join("report.json")).expect("replaced"), b"new");
        assert_eq!(names(room.path()), ["panels"]);
        assert_eq!(names(&target), ["report.json", MANIFEST]);
    }

    #[test]
    fn what_others_keep_beside_a_result_is_kept_and_named() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        result(&target, false, &["report.json", "patterns.dxf", "sweep.png"]).expect("moved");
        fs::create_dir_all(target.join(".git/objects")).expect("folder");
        fs::write(target.join(".git/HEAD"), "ref").expect("file");
        fs::write(target.join("main.rs"), "fn main() {}").expect("file");
        let delivered = result(&target, true, &["report.json", "patterns.dxf"]).expect("moved");
        assert_eq!(delivered.folder, target);
        let remark = delivered.remark.expect("said");
        assert!(remark.contains(".git") && remark.contains("main.rs"), "{remark}");
        assert_eq!(names(&target), [".git", "main.rs", "patterns.dxf", "report.json", MANIFEST]);
        assert_eq!(names(&target.join(".git")), ["HEAD", "objects"]);
        assert_eq!(names(room.path()), ["panels"]);
    }

    #[test]
    fn a_file_that_somebody_changed_is_never_replaced() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        result(&target, false, &["report.json", "patterns.dxf"]).expect("moved");
        fs::write(target.join("patterns.dxf"), "nested by hand").expect("file");
        let refusal = Output::prepare(&target, &no_input(), true).err().expect("refused");
        assert!(refusal.message.contains("patterns.dxf"), "{refusal}");
        // Or that has a name of a result but is of nobody's list.
        let target = room.path().join("ruled");
        result(&target, false, &["report.json"]).expect("moved");
        fs::write(target.join("rulings.csv"), "mine").expect("file");
        let refusal = Output::prepare(&target, &no_input(), true).err().expect("refused");
        assert!(refusal.message.contains("rulings.csv"), "{refusal}");

        // Changed while the work goes on, under a name that nobody foresaw.
        let target = room.path().join("more");
        result(&target, false, &["report.json", "a.txt"]).expect("moved");
        let output = Output::prepare(&target, &no_input(), true).expect("force");
        output.write("a.txt", b"new").expect("written");
        fs::write(target.join("a.txt"), "mine").expect("file");
        let delivered = output.deliver().expect("moved");
        assert_eq!(delivered.folder, room.path().join("more-2"));
        assert!(delivered.remark.expect("said").contains("a.txt"));
        assert_eq!(fs::read(target.join("a.txt")).expect("file"), b"mine");
        assert_eq!(fs::read(target.join("report.json")).expect("put back"), b"report.json");
        assert_eq!(names(room.path()), ["more", "more-2", "panels", "ruled"]);
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
        fs::write(room.path().join("report.json"), "{}").expect("file");
        let refusal = Output::prepare(room.path(), &no_input(), true).err().expect("refused");
        assert!(refusal.message.contains("no result") && refusal.help.contains("by hand"), "{refusal}");
        let input = room.path().join("hull.step");
        fs::write(&input, "").expect("file");
        let refusal = Output::prepare(room.path(), &input, true).err().expect("refused");
        assert!(refusal.message.contains("holds the input"));
        assert_eq!(names(room.path()).len(), 3);
    }

    #[test]
    #[cfg(unix)]
    fn links_are_not_followed() {
        let room = tempfile::tempdir().expect("room");
        let (target, link) = (room.path().join("panels"), room.path().join("link"));
        result(&target, false, &["report.json", "a.txt"]).expect("moved");
        std::os::unix::fs::symlink(&target, &link).expect("link");
        assert!(Output::prepare(&link, &no_input(), true).err().expect("refused").message.contains("link"));
        fs::rename(target.join("a.txt"), room.path().join("elsewhere")).expect("moved");
        std::os::unix::fs::symlink(room.path().join("elsewhere"), target.join("a.txt")).expect("link");
        let delivered = result(&target, true, &["report.json"]).expect("moved");
        assert!(delivered.remark.expect("said").contains("a.txt"));
        assert!(room.path().join("elsewhere").exists());
    }

    #[test]
    fn an_empty_folder_may_be_used() {
        let room = tempfile::tempdir().expect("room");
        let target = room.path().join("panels");
        fs::create_dir(&target).expect("folder");
        result(&target, false, &["report.json"]).expect("moved");
        assert_eq!(names(&target), ["report.json", MANIFEST]);
    }

    #[test]
    fn of_two_runs_into_one_folder_one_wins_and_the_other_keeps_its_result() {
        let room = tempfile::tempdir().expect("room");
        for (name, before) in [("free", None), ("empty", Some(false)), ("earlier", Some(true))] {
            let target = room.path().join(name);
            match before {
                Some(true) => drop(result(&target, false, &["report.json"]).expect("moved")),
                Some(false) => fs::create_dir(&target).expect("folder"),
                None => {}
            }
            let first = Output::prepare(&target, &no_input(), true).expect("place");
            let second = Output::prepare(&target, &no_input(), true).expect("place");
            first.write("report.json", b"first").expect("written");
            second.write("report.json", b"second").expect("written");
            assert!(second.deliver().expect("moved").remark.is_none());
            let beside = first.deliver().expect("moved");
            assert_eq!(beside.folder, room.path().join(format!("{name}-2")));
            assert!(beside.remark.expect("said").contains(name));
            assert_eq!(fs::read(target.join("report.json")).expect("file"), b"second");
            assert_eq!(fs::read(beside.folder.join("report.json")).expect("file"), b"first");
        }
        assert_eq!(names(room.path()).len(), 6);
    }

    #[test]
    fn what_appears_at_the_target_is_never_replaced() {
        let room = tempfile::tempdir().expect("room");
        for (name, make) in [
            ("file", (|p: &Path| fs::write(p, "mine")) as fn(&Path) -> std::io::Result<()>),
            ("folder", |p| fs::create_dir(p)),
        ] {
            let target = room.path().join(name);
            let output = Output::prepare(&target, &no_input(), true).expect("place");
            output.write("report.json", b"{}").expect("written");
            make(&target).expect("made");
            let delivered = output.deliver().expect("moved");
            assert_eq!(delivered.folder, room.path().join(format!("{name}-2")));
            assert_eq!(fs::symlink_metadata(&target).expect("still there").is_file(), name == "file");
        }
    }

    #[test]
    fn a_write_that_fails_names_the_file() {
        let room = tempfile::tempdir().expect("room");
        let output = Output::prepare(&room.path().join("panels"), &no_input(), false).expect("free place");
        let refusal = output.write("no-such-folder/panels.step", b"").expect_err("cannot be written");
        assert!(refusal.message.contains("panels.step"), "{refusal}");
    }
}
