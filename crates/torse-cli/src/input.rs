//! Input files: their bytes and their names.

use crate::failure::{os_reason, Failure};
use std::path::Path;

/// Reads the input file.
pub fn contents(file: &Path) -> Result<Vec<u8>, Failure> {
    if file.is_dir() {
        return Err(Failure::new(format!("'{}' is a folder", file.display()), "give a file inside it"));
    }
    std::fs::read(file).map_err(|e| {
        Failure::new(format!("cannot read '{}': {}", file.display(), os_reason(&e)), "check the name and the rights")
    })
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
