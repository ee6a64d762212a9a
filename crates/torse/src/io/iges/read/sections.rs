//! The lines of an IGES file, sorted into its sections.

/// Columns of a line before the letter of its section.
pub(super) const LETTER: usize = 72;
/// Columns of a record that has no end of line.
pub(super) const RECORD: usize = 80;
/// Bytes that are searched for an end of line.
const HEAD: usize = 4096;

/// A line of the directory or of the parameter data.
#[derive(Clone, Debug)]
pub(super) struct SectionLine<'a> {
    /// Sequence number as stated; 0 if none can be read.
    pub stated: u64,
    /// What stands before the letter of the section.
    pub data: &'a [u8],
}

/// The sections of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Sections<'a> {
    /// The global section in one piece.
    pub global: Vec<u8>,
    /// Lines of the directory.
    pub directory: Vec<SectionLine<'a>>,
    /// Lines of the parameter data.
    pub parameter: Vec<SectionLine<'a>>,
    /// Whether there is a start section.
    pub started: bool,
    /// Whether the terminating line is there.
    pub terminated: bool,
    /// Letter of a flag section: `C` for the compressed form, `B` for the binary one.
    pub flag: Option<u8>,
    /// Lines that belong to no section.
    pub unreadable: usize,
    /// Number of the first of them, from 1.
    pub first_unreadable: usize,
}

impl<'a> Sections<'a> {
    /// Sorts the lines of a file. Lines end with CR, LF or both; a file without ends of lines has records of 80
    /// columns.
    pub fn of(bytes: &'a [u8]) -> Self {
        let mut out = Self::default();
        let head = &bytes[..bytes.len().min(HEAD)];
        if bytes.first() == Some(&b'B') && head.iter().take(RECORD).filter(|b| b.is_ascii_control()).count() > 4 {
            out.flag = Some(b'B');
            return out;
        }
        if head.iter().any(|b| matches!(b, b'\n' | b'\r')) {
            let lines = bytes.split(|b| matches!(b, b'\n' | b'\r'));
            lines.enumerate().for_each(|(i, line)| out.add(i + 1, line));
        } else {
            bytes.chunks(RECORD).enumerate().for_each(|(i, line)| out.add(i + 1, line));
        }
        if out.stated_badly(|s| &s.directory) {
            number(&mut out.directory);
        }
        if out.stated_badly(|s| &s.parameter) {
            number(&mut out.parameter);
        }
        out
    }

    /// Whether the file is one of this format at all.
    pub fn recognised(&self) -> bool {
        self.flag.is_some()
            || (self.started || !self.global.is_empty()) && !self.directory.is_empty()
            || (self.started && !self.global.is_empty())
    }

    fn add(&mut self, at: usize, line: &'a [u8]) {
        let blank = |b: &u8| b.is_ascii_whitespace() || *b == 0 || *b == CONTROL_Z;
        if line.iter().all(blank) {
            return;
        }
        let Some((letter, data, stated)) = parts(line) else {
            self.unreadable += 1;
            if self.first_unreadable == 0 {
                self.first_unreadable = at;
            }
            return;
        };
        let line = SectionLine { stated, data };
        match letter {
            b'S' => self.started = true,
            b'G' => self.global.extend(padded(data)),
            b'D' => self.directory.push(line),
            b'P' => self.parameter.push(line),
            b'T' => self.terminated = true,
            flag if self.flag.is_none() && !self.started => self.flag = Some(flag),
            _ => {}
        }
    }

    /// Whether the stated numbers cannot be used: they must grow from line to line.
    fn stated_badly(&self, lines: impl Fn(&Self) -> &Vec<SectionLine<'a>>) -> bool {
        let lines = lines(self);
        lines.first().is_some_and(|l| l.stated == 0) || lines.windows(2).any(|w| w[1].stated <= w[0].stated)
    }
}

/// End of a text file on old systems.
const CONTROL_Z: u8 = 0x1a;

/// Numbers lines by their order.
fn number(lines: &mut [SectionLine]) {
    for (i, l) in lines.iter_mut().enumerate() {
        l.stated = i as u64 + 1;
    }
}

/// The columns of a line of the global section; what editors cut off is blanks.
fn padded(data: &[u8]) -> impl Iterator<Item = u8> + '_ {
    data.iter().copied().chain(std::iter::repeat_n(b' ', LETTER.saturating_sub(data.len())))
}

/// Letter of the section, data and sequence number of a line.
fn parts(line: &[u8]) -> Option<(u8, &[u8], u64)> {
    let end = line.iter().rposition(|b| !b.is_ascii_whitespace() && *b != 0)? + 1;
    let number = |from: usize| -> Option<u64> {
        let digits: Vec<u8> = line[from..end].iter().copied().filter(|b| !b.is_ascii_whitespace()).collect();
        if digits.is_empty() {
            return Some(0);
        }
        if digits.len() > 9 || !digits.iter().all(u8::is_ascii_digit) {
            return None;
        }
        Some(digits.iter().fold(0, |n, d| 10 * n + u64::from(d - b'0')))
    };
    let letter = |at: usize| line.get(at).copied().filter(|b| b"SGDPTCB".contains(b));
    if let (Some(l), true) = (letter(LETTER), end > LETTER) {
        if let Some(n) = number(LETTER + 1) {
            return Some((l, &line[..LETTER], n));
        }
    }
    // Columns may be shifted by characters of several bytes, or by blanks that were lost: look from the end.
    let digits = line[..end].iter().rev().take_while(|b| b.is_ascii_digit()).count();
    let before = line[..end - digits].iter().rposition(|b| *b != b' ')?;
    let l = letter(before).filter(|l| digits > 0 && !matches!(l, b'C' | b'B'))?;
    // What comes before the letter is data, a blank, or a number that ends there.
    (before > 0 && end - before <= 8).then_some(())?;
    Some((l, &line[..before], number(before + 1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(data: &str, letter: char, n: usize) -> String {
        format!("{data:<72}{letter}{n:>7}")
    }

    #[test]
    fn every_end_of_line_is_one() {
        let lines = [line("head", 'S', 1), line("1H,,1H;;", 'G', 1), line("110", 'D', 1), line("110,1;", 'P', 1)];
        let text = lines.join("\n");
        let wanted = Sections::of(text.as_bytes());
        assert!(wanted.recognised() && !wanted.terminated && wanted.global.starts_with(b"1H,,1H;;  "));
        for end in ["\r", "\r\n", "\r\r\n\n", " \n", ""] {
            let text = lines.join(end);
            let found = Sections::of(text.as_bytes());
            assert_eq!(found.directory[0].data, wanted.directory[0].data, "{end:?}");
            assert_eq!((found.parameter.len(), found.unreadable), (1, 0), "{end:?}");
        }
    }

    #[test]
    fn shifted_columns_and_bad_numbers_are_read() {
        let text = format!("{}\n110,1,2; 1P      1\n{}\n", line("Größe", 'S', 1), line("110,3;", 'P', 1));
        let found = Sections::of(text.as_bytes());
        assert_eq!(found.parameter.len(), 2);
        assert_eq!(found.parameter[1].stated, 2);
        assert!(found.started);
        let found = Sections::of(b"nothing at all\nof this kind\n");
        assert_eq!((found.unreadable, found.first_unreadable, found.recognised()), (2, 1, false));
    }

    #[test]
    fn other_forms_are_seen() {
        assert_eq!(Sections::of(line("", 'C', 1).as_bytes()).flag, Some(b'C'));
        assert_eq!(Sections::of(b"B\0\0\0\x30\x01\x02\x03\x04\x05").flag, Some(b'B'));
    }
}
