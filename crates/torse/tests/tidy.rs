//! Keeps the house tidy by reading its sources as plain text: floors, file sizes, solver crates, references.
//!
//! The table below is the whole of the law; `ARCHITECTURE.md` explains it. A module may name only what its row
//! lists, and a row lists only earlier rows, so that the floors cannot grow a cycle.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A module of the library and what it may name besides itself. The longest matching module name counts, so
/// `pipeline::outcome` and `pipeline::presentation`, the nouns that files are made from, are rows of their own below
/// `io`, while the rest of `pipeline` is above it.
const FLOORS: &[(&str, &[&str])] = &[
    ("control", &[]),
    ("num", &[]),
    ("geom", &["num"]),
    ("spline", &["num", "geom"]),
    ("surface", &["num", "geom", "spline"]),
    ("fit", &["control", "num", "geom", "spline", "surface"]),
    ("design", &["control", "num", "geom", "spline", "surface"]),
    ("certify", &["control", "num", "geom", "spline", "surface"]),
    ("develop", &["control", "num", "geom", "spline", "surface"]),
    ("tessellate", &["control", "num", "geom", "spline", "surface"]),
    ("pipeline::outcome", &["num", "geom", "spline", "surface", "certify"]),
    ("pipeline::sheets", &["num", "geom", "spline", "surface", "pipeline::outcome"]),
    ("pipeline::shapes", &["num", "geom", "spline", "surface", "fit", "pipeline::outcome", "pipeline::sheets"]),
    (
        "pipeline::presentation",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "surface",
            "certify",
            "develop",
            "tessellate",
            "pipeline::outcome",
            "pipeline::sheets",
            "pipeline::shapes",
        ],
    ),
    (
        "io",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "surface",
            "certify",
            "develop",
            "tessellate",
            "pipeline::outcome",
            "pipeline::sheets",
            "pipeline::shapes",
            "pipeline::presentation",
        ],
    ),
    (
        "pipeline",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "surface",
            "fit",
            "design",
            "certify",
            "develop",
            "tessellate",
            "pipeline::outcome",
            "pipeline::sheets",
            "pipeline::shapes",
            "pipeline::presentation",
            "io",
        ],
    ),
];

/// Crates that solve systems or programs: named in `num` only, so that one floor decides which solver is used.
const SOLVERS: &[&str] = &["clarabel", "faer"];

/// Longest file, in lines. The style asks for 150 to 400.
const LINE_LIMIT: usize = 800;

/// Floors whose files are algorithms. Where the method comes from is said in the module header by a key of
/// `docs/references.md`, or on a page of `docs/algorithms` that names the file.
const ALGORITHM_FLOORS: &[&str] = &["fit", "design", "certify", "develop", "surface"];

/// Files of those floors that hold data, not methods.
const NOUNS: &[&str] = &["surface/face.rs", "surface/panel.rs", "surface/pattern.rs"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All Rust sources below a folder, in a fixed order.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                if path.file_name().is_some_and(|n| n != "target") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Text without comments (`//` to the end of the line; string literals that hold `//` lose their tail, which
/// does no harm here).
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// Paths that follow `crate::` in a text, two segments at most: `crate::pipeline::outcome::Status` gives
/// `pipeline::outcome`, `crate::{num, geom::Vec3}` gives `num` and `geom::Vec3`.
fn named_modules(code: &str) -> BTreeSet<String> {
    let path = |text: &str| -> String {
        let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(text.len());
        let mut segments = text[..end].split("::").filter(|s| !s.is_empty());
        let first = segments.next().unwrap_or("").to_string();
        segments.next().map_or(first.clone(), |second| format!("{first}::{second}"))
    };
    let mut out = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let Some(list) = rest.strip_prefix('{') else {
            out.insert(path(rest));
            continue;
        };
        // Items of the outermost braces only.
        let mut depth = 0;
        let mut item = String::new();
        for c in list.chars() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    out.insert(path(item.trim()));
                    item.clear();
                    continue;
                }
                _ => {}
            }
            item.push(c);
        }
        out.insert(path(item.trim()));
    }
    out.remove("");
    out
}

/// The row of the table that a module path belongs to.
fn row(path: &str) -> Option<&'static str> {
    FLOORS
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| path == *name || path.starts_with(&format!("{name}::")))
        .max_by_key(|name| name.len())
}

/// Module path of a source file: `src/io/step/mod.rs` is `io::step`.
fn module_of(relative: &Path) -> String {
    let text = relative.with_extension("").to_string_lossy().replace(['/', '\\'], "::");
    text.strip_suffix("::mod").unwrap_or(&text).to_string()
}

/// Complaints about one file's use of other modules.
fn floor_faults(module: &str, code: &str) -> Vec<String> {
    let Some(own) = row(module) else {
        return vec![format!("{module}: no row in the table of floors")];
    };
    let allowed = FLOORS.iter().find(|(name, _)| *name == own).map_or(&[][..], |(_, may)| may);
    let mut faults = Vec::new();
    for named in named_modules(code) {
        match row(&named) {
            Some(other) if other != own && !allowed.contains(&other) => {
                faults.push(format!("{module} names crate::{named}; {own} may name only {allowed:?}"));
            }
            _ => {}
        }
    }
    // Climbing out of the floor with super is a way around the table.
    for (at, _) in code.match_indices("super::super::") {
        let rest = code[at..].trim_start_matches("super::");
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        if FLOORS.iter().any(|(name, _)| *name == &rest[..end] && *name != own) {
            faults.push(format!("{module} climbs to {}; write crate::… so that floors can be seen", &rest[..end]));
        }
    }
    faults
}

/// Keys in square brackets that look like a paper's or a specification's: `[PW99]`, `[ISO10303-21]`, and with a
/// place in it or a second key: `[PT97, 9.4.1]`, `[R89, MKC09]`. In sources the brackets may be escaped, so that the
/// documentation does not take them for links.
fn keys(text: &str) -> BTreeSet<String> {
    // Rust links and intervals are not keys: a key starts with a capital, has no space and ends with two digits.
    let shaped = |key: &str| {
        key.starts_with(|c: char| c.is_ascii_uppercase())
            && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '-')
            && key.len() >= 3
            && key[key.len() - 2..].chars().all(|c| c.is_ascii_digit())
    };
    let mut out = BTreeSet::new();
    for (at, _) in text.match_indices('[') {
        let Some(end) = text[at..].find(']') else { continue };
        out.extend(
            text[at + 1..at + end]
                .split(',')
                .map(|key| key.trim().trim_end_matches('\\'))
                .filter(|key| shaped(key))
                .map(str::to_string),
        );
    }
    out
}

/// Keys that `docs/references.md` explains: the lines that begin with `- **[key]**`.
fn known_keys() -> BTreeSet<String> {
    let text = fs::read_to_string(root().join("docs/references.md")).expect("docs/references.md");
    text.lines().filter_map(|l| l.strip_prefix("- **[")?.split(']').next().map(str::to_string)).collect()
}

/// The `//!` header of a source.
fn header(text: &str) -> String {
    text.lines().take_while(|l| l.starts_with("//!") || l.is_empty()).collect::<Vec<_>>().join("\n")
}

#[test]
fn rows_list_only_earlier_rows() {
    for (i, (name, may)) in FLOORS.iter().enumerate() {
        for other in *may {
            assert!(FLOORS[..i].iter().any(|(n, _)| n == other), "{name} lists {other}, which is not below it");
        }
    }
}

#[test]
fn floors_are_kept() {
    let src = root().join("crates/torse/src");
    let mut faults = Vec::new();
    for file in sources(&src) {
        let relative = file.strip_prefix(&src).expect("a file of the library");
        if relative == Path::new("lib.rs") {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable source");
        faults.extend(floor_faults(&module_of(relative), &without_comments(&text)));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn files_stay_short() {
    for file in sources(&root().join("crates")) {
        let lines = fs::read_to_string(&file).expect("readable source").lines().count();
        assert!(lines <= LINE_LIMIT, "{} has {lines} lines; {LINE_LIMIT} are allowed", file.display());
    }
}

#[test]
fn solvers_are_named_in_num_only() {
    let src = root().join("crates/torse/src");
    for file in sources(&root().join("crates")) {
        if file.starts_with(src.join("num")) || file.ends_with("tests/tidy.rs") {
            continue;
        }
        let code = without_comments(&fs::read_to_string(&file).expect("readable source"));
        for solver in SOLVERS {
            assert!(!code.contains(&format!("{solver}::")), "{} names the solver {solver}", file.display());
        }
    }
}

#[test]
fn methods_say_where_they_come_from() {
    let src = root().join("crates/torse/src");
    let known = known_keys();
    let pages: String = fs::read_dir(root().join("docs/algorithms"))
        .expect("docs/algorithms")
        .map(|page| fs::read_to_string(page.expect("page").path()).expect("readable page"))
        .collect();
    for key in keys(&pages) {
        assert!(known.contains(&key), "docs/algorithms: [{key}] is not in docs/references.md");
    }
    assert!(known.len() >= 5, "docs/references.md lists too few keys: {known:?}");
    let mut faults = Vec::new();
    for file in sources(&src) {
        let text = fs::read_to_string(&file).expect("readable source");
        let relative = file.strip_prefix(&src).expect("a file of the library").to_string_lossy().replace('\\', "/");
        let comments: String = text.lines().filter(|l| l.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
        for key in keys(&comments) {
            if !known.contains(&key) {
                faults.push(format!("{relative}: [{key}] is not in docs/references.md"));
            }
        }
        let floor = relative.split('/').next().unwrap_or("");
        let is_method = ALGORITHM_FLOORS.contains(&floor)
            && !relative.ends_with("/mod.rs")
            && !relative.ends_with("/tests.rs")
            && !relative.contains("/tests/")
            && !NOUNS.contains(&relative.as_str());
        if !is_method {
            continue;
        }
        if !pages.contains(&format!("`{relative}`")) && keys(&header(&text)).is_disjoint(&known) {
            faults.push(format!(
                "{relative}: neither a key of docs/references.md in the module header nor a page of docs/algorithms names it"
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_test_itself_can_fail() {
    assert!(!floor_faults("fit::planes", "use crate::certify::Verdict;").is_empty());
    assert!(!floor_faults("certify::distance", "use crate::{num::interval, fit::plane};").is_empty());
    assert!(!floor_faults("io::dxf", "let x = crate::fit::plane(1);").is_empty());
    assert!(!floor_faults("num::roots", "use super::super::geom;").is_empty());
    assert!(!floor_faults("attic", "").is_empty());
    assert!(floor_faults("pipeline::approximate", "use crate::{io::step, fit::plane}; crate::certify::x()").is_empty());
    assert!(floor_faults("io::json", "use crate::pipeline::outcome::Outcome;").is_empty());
    assert!(!floor_faults("io::json", "use crate::pipeline::approximate::Options;").is_empty());
    assert_eq!(keys("see [PW99], [0, 1] and [`Self::new`], [ISO10303-21, MKC09], \\[PT97, 9.4\\], \\[R89\\]").len(), 5);
}
