//! Keeps the house tidy by reading its sources as plain text: floors, circles, sizes, solvers, references, thresholds.
//!
//! The table below is the whole of the law; `ARCHITECTURE.md` explains it. A module may name only what its row
//! lists, and a row lists only earlier rows, so that the floors cannot grow a cycle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module of the library and what it may name besides itself.
const FLOORS: &[(&str, &[&str])] = &[
    ("control", &[]),
    ("num", &["control"]),
    ("geom", &["num"]),
    ("spline", &["num", "geom"]),
    ("reason", &["num", "geom"]),
    ("brep", &["num", "geom", "spline"]),
    ("torse", &["num", "geom", "spline"]),
    ("patchwork", &["num", "geom", "spline", "brep", "torse", "reason"]),
    ("constraint", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    ("fit", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    ("design", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork", "constraint"]),
    ("certify", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    ("develop", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    ("tessellate", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    ("draw", &["control", "num", "geom", "spline", "brep", "torse", "reason", "patchwork"]),
    (
        "search",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "brep",
            "torse",
            "reason",
            "patchwork",
            "constraint",
            "fit",
            "design",
            "certify",
            "develop",
            "draw",
        ],
    ),
    (
        "answer",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "brep",
            "torse",
            "reason",
            "patchwork",
            "fit",
            "design",
            "certify",
            "develop",
            "tessellate",
            "draw",
            "search",
        ],
    ),
    (
        "io",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "brep",
            "torse",
            "reason",
            "patchwork",
            "certify",
            "develop",
            "tessellate",
            "draw",
            "answer",
        ],
    ),
    (
        "pipeline",
        &[
            "control",
            "num",
            "geom",
            "spline",
            "brep",
            "torse",
            "reason",
            "patchwork",
            "constraint",
            "fit",
            "design",
            "certify",
            "develop",
            "tessellate",
            "draw",
            "search",
            "answer",
            "io",
        ],
    ),
];

/// Crates that solve systems or programs: named in `num` only, so that one floor decides which solver is used.
const SOLVERS: &[&str] = &["clarabel", "faer"];

/// Longest file, in lines. The style asks for 150 to 400.
const LINE_LIMIT: usize = 800;

/// Longest file of a job, in lines, tests beside it left out: a job is a page that is read at once.
const JOB_LIMIT: usize = 250;

/// Floors whose files are algorithms. Where the method comes from is said in the module header by a key of
/// `docs/references.md`, or on a page of `docs/algorithms` that names the file.
const ALGORITHM_FLOORS: &[&str] =
    &["brep", "torse", "patchwork", "constraint", "fit", "design", "certify", "develop", "search"];

/// Files of those floors that hold data, not methods.
const NOUNS: &[&str] = &[
    "brep/face.rs",
    "brep/raw.rs",
    "fit/cloud/error.rs",
    "patchwork/panel.rs",
    "patchwork/image.rs",
    "patchwork/part.rs",
    "patchwork/pattern.rs",
    "patchwork/written.rs",
];

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

/// Paths that follow `crate::` in a text, two segments at most: `crate::answer::marks::Marks` gives
/// `answer::marks`, `crate::{num, geom::Vec3}` gives `num` and `geom::Vec3`.
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
            // The root hands types on to users; within the house they are named where they are.
            None if named.starts_with(|c: char| c.is_ascii_uppercase()) => {
                faults.push(format!("{module} takes {named} from the root; name its own module"));
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

/// The part of a source before its tests, without comments.
fn without_tests(text: &str) -> String {
    let code = without_comments(text);
    // Modules in files of their own are declared anywhere; tests that are written here end the code.
    let here = |(at, mark): &(usize, &str)| code[at + mark.len()..].lines().next().is_some_and(|l| l.ends_with('{'));
    let end = code.match_indices("#[cfg(test)]\n").find(here).map_or(code.len(), |(at, _)| at);
    code[..end].to_string()
}

/// Paths in the braces of an import, in full: `a::{b, c::{d}}` gives `a::b` and `a::c::d`.
fn branches(prefix: &str, tree: &str, out: &mut Vec<String>) {
    let tree = tree.trim();
    let Some((head, rest)) = tree.split_once('{') else {
        out.push(format!("{prefix}{}", tree.split(" as ").next().unwrap_or("").trim()));
        return;
    };
    let inner = rest.rsplit_once('}').map_or(rest, |(inner, _)| inner);
    let (mut depth, mut item) = (0, String::new());
    for c in inner.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches(&format!("{prefix}{head}"), &std::mem::take(&mut item), out);
                continue;
            }
            _ => {}
        }
        item.push(c);
    }
    if !item.trim().is_empty() {
        branches(&format!("{prefix}{head}"), &item, out);
    }
}

/// Paths of two segments and more that a module's code names outside its imports, as they are written.
fn paths_in_code(code: &str) -> Vec<String> {
    let mut out = Vec::new();
    for statement in code.split(';') {
        // What comes before an import, if the statement ends with one.
        let body = statement.rfind("use ").map_or(statement, |at| {
            let line = statement[..at].rfind('\n').map_or(0, |n| n + 1);
            let before = statement[line..at].trim();
            let is_import = before.is_empty() || before == "pub" || before.starts_with("pub(");
            &statement[..if is_import { line } else { statement.len() }]
        });
        let named = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        for path in body.split(|c: char| !named(c)) {
            let path = path.trim_end_matches(':');
            // `a: b::c` is a path behind a name.
            let path = path.rsplit_once(": ").map_or(path, |(_, p)| p);
            if path.contains("::") && path.starts_with(|c: char| c.is_lowercase() || c == '_') {
                out.push(path.to_string());
            }
        }
    }
    out
}

/// Modules of the library that a module's code needs, as full paths: those that it imports, and those that it names.
fn imports(module: &str, code: &str, modules: &BTreeSet<String>) -> BTreeSet<String> {
    // Who may see a thing is no need of it.
    let mut visible = code.split("pub(in ");
    let mut bare = visible.next().unwrap_or("").to_string();
    visible.for_each(|rest| bare.push_str(&format!("pub {}", rest.split_once(')').map_or("", |(_, r)| r))));
    let mut paths = paths_in_code(&bare);
    for statement in code.split(';') {
        let Some(at) = statement.rfind("use ") else { continue };
        let before = statement[..at].trim_end();
        // Re-exports make the face of a room; they are no need of it.
        if before.ends_with("pub") || before.ends_with(')') {
            continue;
        }
        branches("", &statement[at + "use ".len()..], &mut paths);
    }
    let mut out = BTreeSet::new();
    for path in paths {
        let mut segments: Vec<&str> = path.split("::").map(str::trim).collect();
        let mut full: Vec<&str> = module.split("::").collect();
        match segments[0] {
            "crate" => full.clear(),
            "self" => {}
            "super" => {
                while segments.first() == Some(&"super") {
                    full.pop();
                    segments.remove(0);
                }
                segments.insert(0, "super");
            }
            _ => segments.insert(0, "self"),
        }
        full.extend(segments.into_iter().skip(1).filter(|s| *s != "self"));
        let known = (1..=full.len()).rev().map(|n| full[..n].join("::")).find(|p| modules.contains(p));
        out.extend(known.filter(|k| k != module));
    }
    out
}

/// Groups of modules that need each other in a circle, each sorted.
fn circles(graph: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let reached = |from: &String| -> BTreeSet<String> {
        let mut seen = BTreeSet::new();
        let mut open = vec![from.clone()];
        while let Some(m) = open.pop() {
            open.extend(graph.get(&m).into_iter().flatten().filter(|n| seen.insert((*n).clone())).cloned());
        }
        seen
    };
    let all: BTreeMap<&String, BTreeSet<String>> = graph.keys().map(|m| (m, reached(m))).collect();
    let mut out: Vec<Vec<String>> = Vec::new();
    for (m, to) in &all {
        if to.contains(*m) && !out.iter().flatten().any(|k| k == *m) {
            out.push(to.iter().filter(|n| all.get(n).is_some_and(|back| back.contains(*m))).cloned().collect());
        }
    }
    out
}

#[test]
fn files_need_each_other_one_way() {
    for source in ["torse", "torse-cli"] {
        let src = root().join("crates").join(source).join("src");
        let files: Vec<(String, String)> = sources(&src)
            .iter()
            .map(|file| {
                let relative = file.strip_prefix(&src).expect("a file of the crate");
                (module_of(relative), without_tests(&fs::read_to_string(file).expect("readable source")))
            })
            .filter(|(module, _)| module != "lib")
            .collect();
        let modules: BTreeSet<String> = files.iter().map(|(m, _)| m.clone()).collect();
        let graph = files.iter().map(|(m, code)| (m.clone(), imports(m, code, &modules))).collect();
        let found = circles(&graph);
        assert!(found.is_empty(), "files of {source} that need each other in a circle: {found:?}");
    }
}

#[test]
fn the_test_of_circles_can_fail() {
    let modules: BTreeSet<String> = ["a", "a::b", "a::c", "d"].map(String::from).into();
    let named = imports("a::b", "use super::c::{X, Y};\nuse crate::d::{self, e::F};\nuse std::fmt;", &modules);
    assert_eq!(named, ["a::c", "d"].map(String::from).into());
    assert!(imports("a", "pub use b::X;", &modules).is_empty());
    // Paths in code count like imports; who may see a thing does not.
    let inline =
        "fn f() -> super::c::X {\n    let x: u8 = crate::d::g(b);\n    c::nothing(x)\n}\npub(in crate::a) fn h() {}";
    assert_eq!(imports("a::b", inline, &modules), ["a::c", "d"].map(String::from).into());
    assert_eq!(
        imports("a", "fn f() {\n    b::g();\n    c::h()\n}", &modules),
        ["a::b", "a::c"].map(String::from).into()
    );
    let graph = [("a::b", vec!["a::c"]), ("a::c", vec!["a::b", "d"]), ("d", vec![])]
        .map(|(m, to)| (m.to_string(), to.into_iter().map(String::from).collect()))
        .into();
    assert_eq!(circles(&graph), [["a::b", "a::c"]]);
}

#[test]
fn files_stay_short() {
    for file in sources(&root().join("crates")) {
        let lines = fs::read_to_string(&file).expect("readable source").lines().count();
        assert!(lines <= LINE_LIMIT, "{} has {lines} lines; {LINE_LIMIT} are allowed", file.display());
    }
}

#[test]
fn jobs_are_pages() {
    for file in sources(&root().join("crates/torse/src/pipeline")).iter().filter(|f| !f.ends_with("tests.rs")) {
        let lines = fs::read_to_string(file).expect("readable source").lines().count();
        assert!(lines <= JOB_LIMIT, "{} has {lines} lines; {JOB_LIMIT} are allowed for a job", file.display());
    }
}

/// Ways in which prose could get among the notes of an answer, or what stands against it.
const PROSE: &[&str] = &[
    "Note::Input",
    "notes.push(format!",
    "notes.push(\"",
    "Reason::Input",
    "Reason::Error(",
    "WrittenFault::Unreadable(",
];

/// Floors that name facts; the sentences are made in `io`.
const WORDLESS: &[&str] = &["search", "answer", "pipeline"];

#[test]
fn notes_are_worded_in_io_only() {
    let src = root().join("crates/torse/src");
    let mut faults = Vec::new();
    for file in WORDLESS.iter().flat_map(|floor| sources(&src.join(floor))) {
        let code = without_tests(&fs::read_to_string(&file).expect("readable source"));
        let found = PROSE.iter().filter(|p| code.contains(**p));
        faults.extend(found.map(|p| format!("{} makes words of a note: {p}", file.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
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
            && !relative.ends_with("/laws.rs")
            && !relative.ends_with("/generated.rs")
            && !relative.contains("/tests/")
            && !NOUNS.contains(&relative.as_str());
        if !is_method {
            continue;
        }
        let folder = relative.rsplit_once('/').map_or("", |(folder, _)| folder);
        let on_a_page = pages.contains(&format!("`{relative}`")) || pages.contains(&format!("`{folder}/*.rs`"));
        if !on_a_page && keys(&header(&text)).is_disjoint(&known) {
            faults.push(format!(
                "{relative}: neither a key of docs/references.md in the module header nor a page of docs/algorithms names it"
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Files that are read for tests alone, by what their paths contain.
const TEST_FILES: &[&str] = &[
    "/tests.rs",
    "/tests/",
    "/laws.rs",
    "/generated.rs",
    "/specimens.rs",
    "/spline/sample.rs",
    "/derivative_check.rs",
];

/// Lines of code with a number like `1e-9` outside strings and definitions of constants.
fn unnamed_numbers(code: &str) -> Vec<&str> {
    let defines = |line: &str| {
        let (before, after) = line.split_once("const ").unwrap_or(("-", ""));
        (before.is_empty() || before.starts_with("pub")) && !before.contains('<') && !after.starts_with("fn ")
    };
    let small = |line: &str| {
        let line = line.split('"').step_by(2).collect::<String>().to_lowercase();
        let digit = |c: char| c.is_ascii_digit();
        line.match_indices("e-").any(|(at, _)| {
            let before = line[..at].trim_end_matches(|c| digit(c) || c == '.' || c == '_');
            let number = line[before.len()..at].starts_with(digit) && line[at + 2..].starts_with(digit);
            number && !before.ends_with(char::is_alphabetic)
        })
    };
    let mut inside = false;
    let unnamed = |line: &&str| {
        let constant = inside || defines(line);
        inside = constant && !line.ends_with(';');
        !constant && small(line)
    };
    code.lines().map(str::trim).filter(unnamed).collect()
}

#[test]
fn thresholds_have_names() {
    let crates = root().join("crates");
    let mut faults = Vec::new();
    for file in sources(&crates) {
        let path = file.strip_prefix(&crates).expect("a file of the workspace").to_string_lossy().replace('\\', "/");
        if path.contains("/src/") && !TEST_FILES.iter().any(|part| path.contains(part)) {
            let code = without_tests(&fs::read_to_string(&file).expect("readable source"));
            faults
                .extend(unnamed_numbers(&code).iter().map(|line| format!("{path}: a constant and its reason: {line}")));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_test_of_thresholds_can_fail() {
    let code = "if x < 1e-9 {\nh = 2.5E-3 * w;\nf(-1_0.e-7)\nconst fn f() -> f64 { 1e-3 }\nconst A: f64 = B;\nA * 1e-3";
    assert_eq!(unnamed_numbers(code).len(), 5, "{code}");
    assert!(unnamed_numbers("pub(super) const A: [f64; 2] = [\n1e-3,\n];\nx1e-3 + 0x1e-3\n\"1e-3\"").is_empty());
}

/// Files below a folder, as paths from there with slashes.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            found.extend(files(&entry.path()).iter().map(|f| format!("{name}/{f}")));
        } else {
            found.insert(name);
        }
    }
    found
}

#[test]
fn the_gallery_shows_its_pictures_and_no_others() {
    let page = fs::read_to_string(root().join("docs/gallery.md")).expect("docs/gallery.md");
    let shown: Vec<&str> = page.split("src=\"images/gallery/").skip(1).filter_map(|t| t.split('"').next()).collect();
    let folder = root().join("docs/images/gallery");
    assert_eq!(shown.iter().map(|s| s.to_string()).collect::<BTreeSet<_>>(), files(&folder));
    assert!(page.matches("images/gallery/").count() == shown.len(), "a picture that the gallery would not make");
    let sizes: Vec<u64> = shown.iter().map(|f| fs::metadata(folder.join(f)).expect("a picture").len()).collect();
    assert!(sizes.iter().all(|s| *s <= 25_000) && sizes.iter().sum::<u64>() <= 1_500_000, "pictures too large");
}

/// Names of the constants that code defines, in functions too.
fn constants(code: &str) -> Vec<String> {
    let name = |line: &str| {
        let (before, after) = line.split_once("const ")?;
        let name = after.split_once(':')?.0;
        let is_name = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
        let is_item = before.is_empty() || before.starts_with("pub") && !before.contains('<');
        (is_name && is_item).then(|| name.to_owned())
    };
    code.lines().map(str::trim).filter_map(name).collect()
}

/// Constants by file as `docs/tuning.md` has them: rows below the name of a file, and the lists of what has no row.
fn tuned(page: &str) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut file = None;
    for line in page.lines() {
        if line.starts_with('#') {
            file = None;
        }
        if let Some(name) = line.strip_prefix("**").and_then(|l| l.strip_suffix("**")) {
            file = Some(name.to_owned());
        }
        let mut cells = line.split('|').map(str::trim).skip(1);
        let (Some(first), Some(second)) = (cells.next(), cells.next()) else { continue };
        if first.ends_with(".rs") {
            let names =
                second.trim_end_matches(" (since)").split(", ").map(|n| n.trim_end_matches(" (since)").to_owned());
            found.entry(first.to_owned()).or_default().extend(names);
        } else if let Some(file) = file.as_ref().filter(|_| first != "constant" && !first.starts_with('-')) {
            found.entry(file.clone()).or_default().push(first.trim_end_matches('†').to_owned());
        }
    }
    found
}

#[test]
fn the_page_of_constants_has_those_that_there_are() {
    let src = root().join("crates/torse/src");
    let mut page = tuned(&fs::read_to_string(root().join("docs/tuning.md")).expect("docs/tuning.md"));
    let mut faults = Vec::new();
    for file in ["fit", "search"].iter().flat_map(|floor| sources(&src.join(floor))) {
        let path = file.strip_prefix(&src).expect("a file of the library").to_string_lossy().replace('\\', "/");
        if TEST_FILES.iter().any(|part| path.contains(part)) {
            continue;
        }
        let mut there = constants(&without_tests(&fs::read_to_string(&file).expect("readable source")));
        let mut told = page.remove(&path).unwrap_or_default();
        there.sort();
        told.sort();
        if there != told {
            let beside = |a: &[String], b: &[String]| a.iter().filter(|n| !b.contains(n)).cloned().collect::<Vec<_>>();
            let (missing, gone) = (beside(&there, &told), beside(&told, &there));
            faults.push(format!("{path}: without a row {missing:?}, with one but gone {gone:?}"));
        }
    }
    faults.extend(page.keys().map(|path| format!("{path}: has no constants, or is gone")));
    assert!(faults.is_empty(), "docs/tuning.md: {}", faults.join("\n"));
}

#[test]
fn the_test_of_the_page_of_constants_can_fail() {
    let code = "const A: f64 = 1.0;\npub(crate) const B_2: [f64; 2] = C;\nconst fn f(x: u8) {}\npub fn g<const N: usize>(x: u8) {}";
    assert_eq!(constants(code), ["A", "B_2"]);
    let page = "**fit/a.rs**\n\n| constant | value |\n|---|---|\n| A† | 1 |\n| B_2 | 2 |\n## More\n| C | 3 |\n| fit/b.rs | D, E (since) |";
    let told: Vec<(String, Vec<String>)> = tuned(page).into_iter().collect();
    let names = |all: &[&str]| all.iter().map(|n| n.to_string()).collect::<Vec<_>>();
    assert_eq!(told, [("fit/a.rs".into(), names(&["A", "B_2"])), ("fit/b.rs".into(), names(&["D", "E"]))]);
}

#[test]
fn the_test_itself_can_fail() {
    assert!(!floor_faults("fit::planes", "use crate::certify::Verdict;").is_empty());
    assert!(!floor_faults("certify::distance", "use crate::{num::interval, fit::plane};").is_empty());
    assert!(!floor_faults("io::dxf", "let x = crate::fit::plane(1);").is_empty());
    assert!(!floor_faults("num::roots", "use super::super::geom;").is_empty());
    assert!(!floor_faults("num::roots", "use crate::Control;").is_empty());
    assert!(!floor_faults("attic", "").is_empty());
    assert!(floor_faults("pipeline::approximate", "use crate::{io::step, fit::plane}; crate::certify::x()").is_empty());
    assert!(floor_faults("io::json", "use crate::answer::marks::Marks;").is_empty());
    assert!(!floor_faults("io::json", "use crate::pipeline::approximate::Options;").is_empty());
    assert_eq!(keys("see [PW99], [0, 1] and [`Self::new`], [ISO10303-21, MKC09], \\[PT97, 9.4\\], \\[R89\\]").len(), 5);
}
