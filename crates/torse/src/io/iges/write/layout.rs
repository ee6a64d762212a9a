//! The fixed format: lines of 80 columns in five sections.

use std::fmt::Write;

/// Columns of parameter data before the number of the directory entry.
const DATA: usize = 64;
/// Columns before the letter of the section.
const LINE: usize = 72;

/// The entities of a file in the making.
#[derive(Debug, Default)]
pub(super) struct Layout {
    directory: String,
    parameter: String,
    entries: usize,
    lines: usize,
}

/// What the directory says of an entity.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entity<'a> {
    /// Type.
    pub kind: u32,
    /// Form.
    pub form: u32,
    /// Status: hidden, dependent, use and hierarchy, two digits each.
    pub status: &'a str,
    /// Label, of which eight characters are kept.
    pub label: &'a str,
}

impl Layout {
    /// Adds an entity; answers the number by which others refer to it.
    pub fn push(&mut self, e: Entity, fields: &[String]) -> u64 {
        let number = 2 * self.entries as u64 + 1;
        self.entries += 1;
        let first = self.lines + 1;
        let mut line = e.kind.to_string();
        for field in fields {
            self.delimiter(&mut line, ',', number);
            // Numbers stay on one line with what follows them; strings, which may be longer, go on at its end.
            if line.len() + field.len() + 1 > DATA {
                self.data_line(&line, number);
                line.clear();
            }
            line.push_str(field);
            while line.len() > DATA {
                let rest = line.split_off(DATA);
                self.data_line(&line, number);
                line = rest;
            }
        }
        self.delimiter(&mut line, ';', number);
        self.data_line(&line, number);
        let label: String = e.label.chars().filter(char::is_ascii_graphic).take(8).collect();
        let (kind, status) = (e.kind, e.status);
        let zero = 0;
        self.entry(
            format!("{kind:>8}{first:>8}{zero:>8}{zero:>8}{zero:>8}{zero:>8}{zero:>8}{zero:>8}{status:>8}"),
            number,
        );
        let count = self.lines + 1 - first;
        let form = e.form;
        self.entry(format!("{kind:>8}{zero:>8}{zero:>8}{count:>8}{form:>8}{:>16}{label:>8}{zero:>8}", ""), number + 1);
        number
    }

    fn delimiter(&mut self, line: &mut String, c: char, number: u64) {
        if line.len() >= DATA {
            self.data_line(line, number);
            line.clear();
        }
        line.push(c);
    }

    fn entry(&mut self, line: String, number: u64) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.directory, "{line}D{number:>7}");
    }

    fn data_line(&mut self, line: &str, number: u64) {
        self.lines += 1;
        let _ = writeln!(self.parameter, "{line:<64}{number:>8}P{:>7}", self.lines);
    }

    /// The whole file.
    pub fn file(&self, start: &str, global: &[String]) -> String {
        let mut out = String::new();
        let mut starts = 0;
        for line in start.lines() {
            starts += 1;
            let line: String = line.chars().filter(|c| c.is_ascii() && !c.is_control()).take(LINE).collect();
            let _ = writeln!(out, "{line:<72}S{starts:>7}");
        }
        let text = format!("{};", global.join(","));
        let lines: Vec<&str> = (0..text.len()).step_by(LINE).map(|i| &text[i..text.len().min(i + LINE)]).collect();
        for (i, line) in lines.iter().enumerate() {
            let _ = writeln!(out, "{line:<72}G{:>7}", i + 1);
        }
        out.push_str(&self.directory);
        out.push_str(&self.parameter);
        let counts = format!("S{starts:>7}G{:>7}D{:>7}P{:>7}", lines.len(), 2 * self.entries, self.lines);
        let _ = writeln!(out, "{counts:<72}T{:>7}", 1);
        out
    }
}

/// A string with its count; characters beyond ASCII are left out by a question mark, since counts are of bytes.
pub(super) fn string(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_ascii() && !c.is_control() { c } else { '?' }).collect();
    if plain.is_empty() {
        return plain;
    }
    format!("{}H{plain}", plain.len())
}

/// A number that reads back bit for bit.
pub(super) fn real(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        Some((m, e)) if m.contains('.') => format!("{m}D{e}"),
        Some((m, e)) => format!("{m}.0D{e}"),
        None => text,
    }
}
