//! What Torse wrote into a folder: a list of its files with sizes and fingerprints, itself one of the files. By it a
//! later run tells its own files from those of people, and from those that people have changed.

use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Component, Path};
use torse::io::bundle::PART_FILE;

/// The list, beside the files that it names.
pub const MANIFEST: &str = "torse-files.json";
/// Name and version of its form; a list of another form is nobody's.
const SCHEMA: &str = "torse-files/1";

/// Every name that a result's file can have; files of cones made beside panels have `cones-` before it.
const RESULT_NAMES: [&str; 41] = [
    MANIFEST,
    "report.json",
    "report.html",
    "panels.step",
    "panels.igs",
    "panels.3dm",
    "strips.step",
    "cones.step",
    "thickness.step",
    "inside.step",
    "neutral.step",
    "outside.step",
    "patterns.dxf",
    "patterns.svg",
    "bends.csv",
    "bend_table.csv",
    "parts.csv",
    "roll_table.csv",
    "facets.csv",
    "bevels.csv",
    "joints.csv",
    "model.glb",
    "thickness.glb",
    "bending.glb",
    "bending.png",
    "panels.png",
    "deviation.png",
    "field.png",
    "points.png",
    "shapes.png",
    "layout.png",
    "sweep.json",
    "sweep.png",
    "deviation.ply",
    "refold.json",
    "refolded.glb",
    "moves.glb",
    "moves.png",
    "curvature.png",
    "rulings.csv",
    "rulings.dxf",
];

/// Whether a result can have a file of this name.
pub fn is_result_name(name: &str) -> bool {
    let name = name.strip_prefix("cones-").unwrap_or(name);
    RESULT_NAMES.contains(&name) || (name.starts_with(PART_FILE) && name.ends_with(".dxf"))
}

/// One file that Torse wrote.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Name, without folder.
    pub name: String,
    /// Size.
    pub bytes: u64,
    /// That of [`Counted`] contents.
    pub fingerprint: String,
}

impl Entry {
    /// The entry of these contents.
    pub fn of(name: &str, contents: &[u8]) -> Self {
        let mut counted = Counted::default();
        counted.add(contents);
        counted.entry(name)
    }

    /// Whether `path` is a plain file with exactly these contents. Links are not: what they lead to is not ours.
    pub fn is(&self, path: &Path) -> bool {
        let same_size = fs::symlink_metadata(path).is_ok_and(|m| m.is_file() && m.len() == self.bytes);
        same_size && fs::read(path).is_ok_and(|contents| Self::of("", &contents).fingerprint == self.fingerprint)
    }
}

/// Size and fingerprint of contents that come in stretches: 64 bits that change when contents change (FNV-1a), against slips, not
/// against malice.
pub struct Counted {
    bytes: u64,
    hash: u64,
}

impl Default for Counted {
    fn default() -> Self {
        Self { bytes: 0, hash: 0xcbf2_9ce4_8422_2325 }
    }
}

impl Counted {
    /// Adds the next stretch.
    pub fn add(&mut self, contents: &[u8]) {
        const PRIME: u64 = 0x0100_0000_01b3;
        self.bytes += contents.len() as u64;
        self.hash = contents.iter().fold(self.hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(PRIME));
    }

    /// The entry of all of them.
    pub fn entry(&self, name: &str) -> Entry {
        Entry { name: name.to_owned(), bytes: self.bytes, fingerprint: format!("{:016x}", self.hash) }
    }
}

/// The list as a file.
#[derive(Serialize, Deserialize)]
struct Manifest {
    schema: String,
    version: String,
    files: Vec<Entry>,
}

/// The text of a list.
pub fn text(files: &[Entry]) -> io::Result<String> {
    let list = Manifest { schema: SCHEMA.into(), version: env!("CARGO_PKG_VERSION").into(), files: files.to_vec() };
    Ok(serde_json::to_string_pretty(&list)? + "\n")
}

/// The list in a folder; `None` if there is none of a known form.
pub fn read(folder: &Path) -> Option<Vec<Entry>> {
    let list: Manifest = serde_json::from_slice(&fs::read(folder.join(MANIFEST)).ok()?).ok()?;
    let plain = |e: &Entry| {
        let mut parts = Path::new(&e.name).components();
        matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None)) && e.name != MANIFEST
    };
    (list.schema == SCHEMA && list.files.iter().all(plain)).then_some(list.files)
}

/// What a folder holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inventory {
    /// Files of Torse, unchanged. The first is the list itself.
    pub own: Vec<Entry>,
    /// Names of all else: files of people, files that people have changed, folders, links.
    pub kept: Vec<String>,
}

/// Looks through a folder; nothing is `own` where there is no list of Torse's files.
///
/// # Errors
/// The folder cannot be listed.
pub fn inspect(folder: &Path) -> io::Result<Inventory> {
    let mut names: Vec<OsString> = fs::read_dir(folder)?.map(|e| Ok(e?.file_name())).collect::<io::Result<_>>()?;
    names.sort();
    let own = listed(folder);
    let kept = names.iter().filter(|n| own.iter().all(|e| **n != *e.name));
    Ok(Inventory { kept: kept.map(|n| n.to_string_lossy().into_owned()).collect(), own })
}

/// The files that the list names and that are as it says, with the list.
fn listed(folder: &Path) -> Vec<Entry> {
    let plain = fs::symlink_metadata(folder.join(MANIFEST)).is_ok_and(|m| m.is_file());
    let (true, Some(files), Ok(list)) = (plain, read(folder), fs::read(folder.join(MANIFEST))) else {
        return Vec::new();
    };
    let mut own = vec![Entry::of(MANIFEST, &list)];
    own.extend(files.into_iter().filter(|e| e.is(&folder.join(&e.name))));
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_unchanged_plain_files_of_the_list_are_own() {
        let room = tempfile::tempdir().expect("room");
        let files: Vec<Entry> = ["a.dxf", "b.svg", "c.png"].iter().map(|n| Entry::of(n, n.as_bytes())).collect();
        for e in &files {
            fs::write(room.path().join(&e.name), &e.name).expect("file");
        }
        fs::write(room.path().join(MANIFEST), text(&files).expect("text")).expect("list");
        fs::write(room.path().join("b.svg"), "B.svg").expect("changed, of the same size");
        fs::write(room.path().join("notes.txt"), "mine").expect("file");
        let found = inspect(room.path()).expect("listed");
        let own: Vec<&str> = found.own.iter().map(|e| e.name.as_str()).collect();
        assert_eq!(own, [MANIFEST, "a.dxf", "c.png"]);
        assert_eq!(found.kept, ["b.svg", "notes.txt"]);
    }

    #[test]
    fn lists_of_other_forms_and_with_paths_are_nobodys() {
        let room = tempfile::tempdir().expect("room");
        fs::write(room.path().join(MANIFEST), "{}").expect("file");
        assert!(inspect(room.path()).expect("listed").own.is_empty());
        for name in ["../a", "/etc/passwd", "a/b", "..", ""] {
            let list = text(&[Entry::of(name, b"")]).expect("text");
            fs::write(room.path().join(MANIFEST), list).expect("file");
            assert!(read(room.path()).is_none(), "{name}");
        }
    }

    /// Reports and times of files say nothing of who wrote the files beside them.
    #[test]
    fn nothing_is_own_where_there_is_no_list() {
        let room = tempfile::tempdir().expect("room");
        let files = ["panels.step", "part-keel.dxf", "parts.csv", "report.json"];
        for schema in ["torse-report/1", "torse-report/2", "torse-report/99", "torse-strips/1"] {
            for name in files {
                fs::write(room.path().join(name), format!("{{\"schema\": \"{schema}\"}}")).expect("file");
            }
            let found = inspect(room.path()).expect("listed");
            assert!(found.own.is_empty(), "{schema}");
            assert_eq!(found.kept, files);
        }
    }
}
