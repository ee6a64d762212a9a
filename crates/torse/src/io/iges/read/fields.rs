//! Free format: numbers, strings and empty fields between delimiters.

/// A field of the global section or of parameter data.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Field {
    /// Nothing between two delimiters: the default of that field.
    Empty,
    /// A number.
    Number(f64),
    /// A string.
    Text(Box<str>),
    /// Neither.
    Unreadable(Box<str>),
}

/// The characters that end fields and records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Delimiters {
    /// After a field.
    pub field: u8,
    /// After the last field of a record.
    pub record: u8,
}

impl Default for Delimiters {
    fn default() -> Self {
        Self { field: b',', record: b';' }
    }
}

/// Reads the fields of a record one by one.
pub(super) struct Reader<'a> {
    data: &'a [u8],
    at: usize,
    /// The delimiters.
    pub delimiters: Delimiters,
    /// Whether the end of the record was met.
    pub ended: bool,
}

/// Longest run of digits before the H of a string.
const LONGEST_COUNT: usize = 6;
/// Words that are no numbers are kept to this length, for messages.
const LONGEST_WORD: usize = 24;

impl<'a> Reader<'a> {
    /// A reader at the start of `data`.
    pub fn new(data: &'a [u8], delimiters: Delimiters) -> Self {
        Self { data, at: 0, delimiters, ended: false }
    }

    /// The next field; `None` at the end of the record or of the data.
    pub fn next(&mut self) -> Option<Field> {
        if self.ended {
            return None;
        }
        self.skip_blanks();
        if self.at >= self.data.len() {
            return None;
        }
        if let Some(text) = self.string() {
            return Some(Field::Text(text));
        }
        let rest = &self.data[self.at..];
        let Delimiters { field, record } = self.delimiters;
        let length = rest.iter().position(|b| *b == field || *b == record).unwrap_or(rest.len());
        let word = &rest[..length];
        self.at += length;
        self.close();
        Some(value(word))
    }

    /// All fields up to the end of the record.
    pub fn all(mut self) -> (Vec<Field>, bool) {
        let mut out = Vec::new();
        while let Some(f) = self.next() {
            out.push(f);
        }
        (out, self.ended)
    }

    fn skip_blanks(&mut self) {
        while self.data.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    /// Passes the delimiter.
    fn close(&mut self) {
        if let Some(b) = self.data.get(self.at) {
            self.ended = *b == self.delimiters.record;
            self.at += 1;
        }
    }

    /// A string `nH…`. Where no delimiter follows the n characters, the count is wrong and the string ends at the first
    /// delimiter instead.
    fn string(&mut self) -> Option<Box<str>> {
        let rest = &self.data[self.at..];
        let digits = rest.iter().take(LONGEST_COUNT + 1).take_while(|b| b.is_ascii_digit()).count();
        if digits == 0 || digits > LONGEST_COUNT || !matches!(rest.get(digits), Some(b'H' | b'h')) {
            return None;
        }
        let count = rest[..digits].iter().fold(0, |n, d| 10 * n + usize::from(d - b'0'));
        let start = self.at + digits + 1;
        let Delimiters { field, record } = self.delimiters;
        let is_end = |b: &u8| *b == field || *b == record;
        let body = &self.data[start..];
        let follows = body.get(count..).and_then(|after| after.iter().position(|b| !b.is_ascii_whitespace()));
        let right = match follows {
            Some(k) => is_end(&body[count + k]),
            None => count <= body.len(),
        };
        let length = if right { count } else { body.iter().position(is_end).unwrap_or(body.len()) };
        let text = decoded(&body[..length]);
        self.at = start + length;
        self.skip_blanks();
        self.close();
        Some(text)
    }
}

/// UTF-8 where it is, else Latin-1.
fn decoded(bytes: &[u8]) -> Box<str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect::<String>().into(),
    }
}

fn value(word: &[u8]) -> Field {
    if word.iter().all(u8::is_ascii_whitespace) {
        return Field::Empty;
    }
    match number(word) {
        Some(x) => Field::Number(x),
        None => Field::Unreadable(decoded(&word[..word.len().min(LONGEST_WORD)]).trim().into()),
    }
}

/// A number as FORTRAN writes it: blanks anywhere, D or no letter at all before the exponent. `None` if it is none or
/// not finite.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let mut text = String::with_capacity(word.len() + 1);
    for b in word.iter().filter(|b| !b.is_ascii_whitespace()) {
        match b {
            b'0'..=b'9' | b'.' => text.push(char::from(*b)),
            b'D' | b'd' | b'E' | b'e' => text.push('e'),
            b'+' | b'-' => {
                if text.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
                    text.push('e');
                }
                text.push(char::from(*b));
            }
            _ => return None,
        }
    }
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Vec<Field> {
        Reader::new(text.as_bytes(), Delimiters::default()).all().0
    }

    #[test]
    fn numbers_in_every_spelling() {
        for (text, x) in [
            ("1.0D0", 1.0),
            ("1E-008", 1e-8),
            (" - 1 . 5 ", -1.5),
            ("2.5+3", 2500.0),
            ("-.5d-1", -0.05),
            ("7.", 7.0),
            ("+3", 3.0),
        ] {
            assert_eq!(number(text.as_bytes()), Some(x), "{text}");
        }
        for text in ["nan", "1e999", "", "--1", "1,2", "1.2.3"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn empty_fields_and_wrong_counts_do_not_lose_the_rest() {
        let n = Field::Number;
        let t = |s: &str| Field::Text(s.into());
        assert_eq!(fields("1,,  ,2 ; 9,9"), [n(1.0), Field::Empty, Field::Empty, n(2.0)]);
        assert_eq!(fields("3Ha,b,1;"), [t("a,b"), n(1.0)]);
        assert_eq!(fields("38HC:\\part.igs,        26HA,5;"), [t("C:\\part.igs"), t("A"), n(5.0)]);
        assert_eq!(fields("2Habcd,5;"), [t("abcd"), n(5.0)]);
        assert_eq!(fields("99999H;"), [t("")]);
        assert_eq!(fields("x1,5;"), [Field::Unreadable("x1".into()), n(5.0)]);
    }
}
