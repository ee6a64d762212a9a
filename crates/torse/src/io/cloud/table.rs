//! Points as lines of numbers separated by commas, semicolons, tabs or blanks; the first three are x, y, z. One line of
//! names at the start and comments (`#`, `//`) are passed over.

use super::{triple, CloudReadError};
use crate::geom::Vec3;

pub(super) fn points(bytes: &[u8]) -> Result<Vec<Vec3>, CloudReadError> {
    let text = String::from_utf8_lossy(bytes);
    let mut out = Vec::new();
    let mut heading = true;
    for (i, line) in text.lines().enumerate() {
        let line = line.trim().trim_start_matches('\u{feff}');
        if line.is_empty() || line.starts_with('#') || line.starts_with("//") {
            continue;
        }
        let words = line.split([',', ';', '\t', ' ']).map(str::trim).filter(|w| !w.is_empty());
        match triple(words) {
            Some(p) => out.push(p),
            // Headings, and the count that some scanners write first.
            None if heading && out.is_empty() => {}
            None => {
                let reason = "three numbers x, y, z are needed".to_string();
                return Err(CloudReadError::Line { format: "CSV", line: i + 1, reason });
            }
        }
        heading = false;
    }
    Ok(out)
}
