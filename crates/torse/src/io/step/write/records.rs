//! The text of an exchange file: numbered records, real numbers and strings (ISO 10303-21, clauses 5 and 6).

use std::fmt::Write as _;

/// Lines are broken after this column where the grammar allows; some old readers stop at 80.
const LINE_WIDTH: usize = 76;

/// A file while its data section grows. Records are numbered from 1 in order of writing, referents first.
#[derive(Debug)]
pub(crate) struct Records {
    text: String,
    count: u64,
}

impl Records {
    /// No record yet, behind the text of a header.
    pub fn after(header: String) -> Self {
        Self { text: header, count: 0 }
    }

    /// Appends the record `#n = body;` and answers n.
    pub fn push(&mut self, body: &str) -> u64 {
        self.count += 1;
        let record = format!("#{}={body};", self.count);
        wrap(&record, &mut self.text);
        self.count
    }

    /// All of the text, records in one or more lines each.
    pub fn into_text(self) -> String {
        self.text
    }
}

/// Appends `record` in lines, broken after commas and blanks outside strings.
pub(crate) fn wrap(record: &str, out: &mut String) {
    let (mut start, mut last_break, mut quoted) = (0, 0, false);
    for (i, c) in record.char_indices() {
        if c == '\'' {
            quoted = !quoted;
        }
        if i - start >= LINE_WIDTH && last_break > start {
            out.push_str(&record[start..last_break]);
            out.push('\n');
            start = last_break;
        }
        if !quoted && (c == ',' || c == ' ') {
            last_break = i + 1;
        }
    }
    out.push_str(&record[start..]);
    out.push('\n');
}

/// The shortest decimal that reads back as exactly `x`, with the decimal point that the grammar asks for.
/// Data that are not finite cannot be written and become 0.
pub fn real(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return "0.".into();
    }
    let s = format!("{x:?}");
    match s.split_once('e') {
        Some((mantissa, exponent)) if mantissa.contains('.') => format!("{mantissa}E{exponent}"),
        Some((mantissa, exponent)) => format!("{mantissa}.E{exponent}"),
        None => s.strip_suffix('0').filter(|t| t.ends_with('.')).map_or_else(|| s.clone(), Into::into),
    }
}

/// A quoted string: apostrophes and backslashes doubled, everything outside printable ASCII as `\X2\` or `\X4\`.
pub fn string(s: &str) -> String {
    let mut out = String::from("'");
    for c in s.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            // Writing to a string cannot fail.
            c if (c as u32) < 0x1_0000 => _ = write!(out, "\\X2\\{:04X}\\X0\\", c as u32),
            c => _ = write!(out, "\\X4\\{:08X}\\X0\\", c as u32),
        }
    }
    out.push('\'');
    out
}

/// `(a,b,c)`.
pub fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("({})", items.into_iter().collect::<Vec<_>>().join(","))
}

/// `(#1,#2,#3)`.
pub fn references(ids: impl IntoIterator<Item = u64>) -> String {
    list(ids.into_iter().map(|i| format!("#{i}")))
}

/// `.T.` or `.F.`.
pub(crate) fn boolean(b: bool) -> &'static str {
    if b {
        ".T."
    } else {
        ".F."
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_numbers_keep_every_bit_and_have_a_point() {
        for x in [1.0, -2.5, 1e-7, 1.0 / 3.0, 1e22, 123456789.0, f64::MIN_POSITIVE, 0.1 + 0.2, 6000.0] {
            let s = real(x);
            assert!(s.contains('.') && !s.contains('e'), "{s}");
            assert_eq!(s.parse::<f64>().expect("a number").to_bits(), x.to_bits(), "{s}");
        }
        assert_eq!((real(6000.0), real(-0.0), real(1e-7)), ("6000.".into(), "0.".into(), "1.E-7".into()));
    }

    #[test]
    fn strings_are_escaped() {
        assert_eq!(string("Müller's \\ 船"), r"'M\X2\00FC\X0\ller''s \\ \X2\8239\X0\'");
        assert_eq!(string("𝄞"), r"'\X4\0001D11E\X0\'");
    }

    #[test]
    fn long_records_are_broken_outside_strings_only() {
        let record = format!("#1=X('{}',{});", "a, ".repeat(40), "1.5,".repeat(60));
        let mut out = String::new();
        wrap(&record, &mut out);
        assert_eq!(out.replace('\n', ""), record);
        assert!(out.lines().skip(1).all(|l| l.len() <= LINE_WIDTH));
        assert!(out.lines().next().expect("a line").contains(&"a, ".repeat(40)));
    }
}
