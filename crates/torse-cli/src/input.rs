//! Input files: their bytes and their names.

use crate::failure::{os_reason, Failure};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Files that this run has read, each by its own name: results must not replace them.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The first file that was read so far and for which `holds` is true.
pub fn first_read(holds: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    read.iter().find(|file| holds(file)).cloned()
}

/// Reads an input file, whichever of several it is.
pub fn contents(file: &Path) -> Result<Vec<u8>, Failure> {
    if file.is_dir() {
        return Err(Failure::new(format!("'{}' is a folder", file.display()), "give a file inside it"));
    }
    let bytes = std::fs::read(file).map_err(|e| {
        Failure::new(format!("cannot read '{}': {}", file.display(), os_reason(&e)), "check the name and the rights")
    })?;
    READ.lock().unwrap_or_else(PoisonError::into_inner).push(file.to_path_buf());
    Ok(bytes)
}

/// Name of a file without folder and extension.
pub fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "model".to_string(), |s| s.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_from_files() {
        assert_eq!(stem(Path::new("a/hull.v2.step")), "hull.v2");
        assert_eq!(stem(Path::new("/")), "model");
    }
}
