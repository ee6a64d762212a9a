//! Numbered folders of an earlier run that had more of them: left where they are, their parts would be cut twice.

use super::workspace::Form;
use super::{inspect, told, workspace, Place};
use crate::failure::os_reason;
use std::fs;
use std::path::Path;

/// The numbered folders that a run wrote.
pub struct Numbered<'a> {
    /// The folder that holds them.
    pub parent: &'a Path,
    /// Digits of their names.
    pub digits: usize,
    /// The highest number.
    pub count: usize,
    /// Least digits that names can have.
    pub least: usize,
    /// Name of the job in their reports: folders of others are somebody's who gave them such names.
    pub job: &'a str,
}

/// What a report says of its job.
#[derive(serde::Deserialize)]
struct Told {
    job: String,
    input: String,
}

impl Numbered<'_> {
    /// Other folders of the parent with such names, in order. Folders of a run with another number of digits are known by the
    /// noughts that such names begin with; a lone `2024` is somebody else's.
    fn others(&self) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.parent) else { return Vec::new() };
        let plain = |n: &String| n.len() >= self.least && n.bytes().all(|b| b.is_ascii_digit());
        let folders = entries.flatten().filter(|e| e.path().is_dir());
        let mut names: Vec<String> = folders.filter_map(|e| e.file_name().into_string().ok()).filter(plain).collect();
        names.sort();
        let padded = |digits: usize| names.iter().any(|n| n.len() == digits && n.starts_with('0'));
        let own = |n: &String| n.len() == self.digits && n.parse().is_ok_and(|k: usize| k <= self.count);
        let of_a_run = |n: &String| n.len() == self.digits || padded(n.len());
        names.iter().filter(|n| of_a_run(n) && !own(n)).cloned().collect()
    }
}

/// Removes the numbered folders beyond those of this run, as far as the same job wrote them and nobody changed them since, by the
/// rule by which `--force` replaces a folder. What is told: the folders that are gone, and those that remain with the reason.
pub fn remove_surplus(numbered: &Numbered<'_>, input: &Path) -> Vec<String> {
    let (mut gone, mut kept) = (Vec::new(), Vec::new());
    for name in numbered.others() {
        match remove(&numbered.parent.join(&name), input, numbered.job) {
            Ok(true) => gone.push(name),
            Ok(false) => {}
            Err(reason) => kept.push(format!("'{}': {reason}", numbered.parent.join(&name).display())),
        }
    }
    let mut out = Vec::new();
    if !gone.is_empty() {
        out.push(format!(
            "folders of an earlier result were removed from '{}': {}",
            numbered.parent.display(),
            told(&gone)
        ));
    }
    out.extend(kept.into_iter().map(|k| format!("a numbered folder that is not of this result was kept: {k}")));
    out
}

/// Removes a folder that Torse wrote; an empty one holds nothing that could be cut, and stays.
fn remove(folder: &Path, input: &Path, job: &str) -> Result<bool, String> {
    let metadata = fs::symlink_metadata(folder).map_err(|e| os_reason(&e))?;
    let found = match inspect(folder, &metadata, input, true).map_err(|failure| failure.message)? {
        Place::Earlier(found) => found,
        Place::Free | Place::Empty => return Ok(false),
    };
    let report = fs::read(folder.join("report.json")).ok().and_then(|b| serde_json::from_slice::<Told>(&b).ok());
    if !report.is_some_and(|t| t.job == "unroll" && t.input == job) {
        return Err("it is the result of another job".into());
    }
    // What a killed run has left beside it goes as well.
    if let Some(parent) = folder.parent() {
        workspace::clean(parent, Form::Folder);
    }
    // The list, by which the others are known, last.
    for entry in found.own.iter().rev() {
        let path = folder.join(&entry.name);
        if !entry.is(&path) {
            return Err(format!("{} was changed meanwhile", entry.name));
        }
        fs::remove_file(&path).map_err(|e| os_reason(&e))?;
    }
    if found.kept.is_empty() {
        return fs::remove_dir(folder).map(|()| true).map_err(|e| os_reason(&e));
    }
    Err(format!("the files of the earlier result were removed, the others are not Torse's: {}", told(&found.kept)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::tests::{names, no_input};
    use crate::folder::Output;

    #[test]
    fn what_an_earlier_run_wrote_beyond_goes_and_all_else_stays() {
        let room = tempfile::tempdir().expect("room");
        let at = |n: &str| room.path().join(n);
        let made = |n: &str, input: &str| {
            let report = format!("{{\"job\": \"unroll\", \"input\": \"{input}\"}}");
            let output = Output::prepare(&at(n), &no_input(), false).expect("a folder");
            output.write("report.json", report.as_bytes()).expect("written");
            output.write("patterns.dxf", b"a drawing").expect("written");
            drop(output.deliver().expect("delivered"));
        };
        for n in ["001", "002", "003", "004", "005", "006", "0001", "0002", "2024x", "20240", "12", "drawings"] {
            made(n, "facade");
        }
        made("009", "bracket");
        fs::write(at("004/patterns.dxf"), "nested by hand").expect("file");
        fs::write(at("005/notes.txt"), "mine").expect("file");
        fs::create_dir(at("007")).expect("folder");
        fs::create_dir(at("008")).expect("folder");
        fs::write(at("008/mine.txt"), "mine").expect("file");
        let numbered = Numbered { parent: room.path(), digits: 3, count: 2, least: 3, job: "facade" };
        let said = remove_surplus(&numbered, &no_input());
        assert_eq!(
            names(room.path()),
            ["001", "002", "004", "005", "007", "008", "009", "12", "20240", "2024x", "drawings"]
        );
        assert!(said[0].ends_with("0001, 0002, 003, 006"), "{said:?}");
        let of = |n: &str| said.iter().filter(|s| s.contains(&format!("{n}'"))).count();
        assert_eq!((said.len(), ["004", "005", "008", "009"].map(of)), (5, [1; 4]), "{said:?}");
        assert!(at("009/report.json").is_file());
        assert_eq!(fs::read(at("004/patterns.dxf")).expect("file"), b"nested by hand");
        assert_eq!(names(&at("005")), ["notes.txt"]);
        assert!(at("001/report.json").is_file() && at("20240/report.json").is_file());
    }
}
