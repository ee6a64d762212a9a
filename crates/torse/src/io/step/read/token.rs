//! Tokens and values of ISO 10303-21 ("STEP physical file") exchange structures.
//!
//! Tolerant where real files are careless: control bytes count as blanks, comments and print control directives may
//! stand anywhere, numbers may lack digits around the point. Knows nothing of what the records mean.

/// One value in the argument list of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// `$`: not given.
    Null,
    /// `*`: derived.
    Derived,
    /// Integer or real number.
    Number(f64),
    /// String, escapes decoded.
    Text(String),
    /// `.WORD.`, without the points.
    Enumeration(&'a str),
    /// `#123`.
    Reference(u64),
    /// `(…)`.
    List(Box<[Value<'a>]>),
    /// `NAME(…)`: a value of a named type; no reader needs the name.
    Typed(Box<[Value<'a>]>),
    /// `"…"`: bits, of no interest here.
    Binary,
}

/// A place and a reason why the text is not a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SyntaxFault {
    /// Byte offset in the text.
    pub at: usize,
    /// What was expected.
    pub reason: &'static str,
}

/// Deepest nesting of lists that is followed; real files need 4.
const DEEPEST_LIST: usize = 40;

/// A cursor over the text.
pub(super) struct Cursor<'a> {
    text: &'a str,
    bytes: &'a [u8],
    /// Offset of the next byte.
    pub at: usize,
    /// Values of lists that have not ended, so that each list takes no more memory than it needs.
    open: Vec<Value<'a>>,
}

impl<'a> Cursor<'a> {
    /// Starts at byte `at`.
    pub fn new(text: &'a str, at: usize) -> Self {
        Self { text, bytes: text.as_bytes(), at, open: Vec::new() }
    }

    /// The next byte, without moving.
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// A fault at the present place.
    pub fn fault(&self, reason: &'static str) -> SyntaxFault {
        SyntaxFault { at: self.at, reason }
    }

    /// Skips blanks, control bytes, comments and print control directives.
    pub fn skip_blanks(&mut self) {
        while let Some(b) = self.peek() {
            if b <= b' ' || b == 0x7f {
                self.at += 1;
            } else if b == b'/' && self.bytes.get(self.at + 1) == Some(&b'*') {
                self.at = match self.text.get(self.at + 2..).and_then(|rest| rest.find("*/")) {
                    Some(n) => self.at + 2 + n + 2,
                    None => self.bytes.len(),
                };
            } else if b == b'\\' && self.bytes.get(self.at + 2) == Some(&b'\\') {
                self.at += 3; // \N\ and \F\: page and line feeds for printing
            } else {
                break;
            }
        }
    }

    /// Whether the byte `b` comes next after blanks; takes it if so.
    pub fn take(&mut self, b: u8) -> bool {
        self.skip_blanks();
        let hit = self.peek() == Some(b);
        if hit {
            self.at += 1;
        }
        hit
    }

    /// An entity number after `#`, the `#` included.
    pub fn number_sign(&mut self) -> Option<u64> {
        self.skip_blanks();
        if self.peek() != Some(b'#') {
            return None;
        }
        let start = self.at + 1;
        let mut end = start;
        while self.bytes.get(end).is_some_and(u8::is_ascii_digit) {
            end += 1;
        }
        let n = self.text.get(start..end)?.parse().ok()?;
        self.at = end;
        Some(n)
    }

    /// A keyword: letters, digits, `_`, `-`, a leading `!` for user-defined ones.
    pub fn word(&mut self) -> &'a str {
        self.skip_blanks();
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-' || b == b'!') {
            self.at += 1;
        }
        self.text.get(start..self.at).unwrap_or("")
    }

    /// A parenthesised argument list.
    pub fn list(&mut self, depth: usize) -> Result<Box<[Value<'a>]>, SyntaxFault> {
        let first = self.open.len();
        let read = self.members(depth);
        let members = self.open.drain(first..);
        read.map(|()| members.collect())
    }

    /// Puts the values of a list among the open ones.
    fn members(&mut self, depth: usize) -> Result<(), SyntaxFault> {
        if depth > DEEPEST_LIST {
            return Err(self.fault("lists are nested too deeply"));
        }
        if !self.take(b'(') {
            return Err(self.fault("'(' expected"));
        }
        if self.take(b')') {
            return Ok(());
        }
        loop {
            let value = self.value(depth)?;
            self.open.push(value);
            if self.take(b')') {
                return Ok(());
            }
            if !self.take(b',') {
                return Err(self.fault("',' or ')' expected"));
            }
            // A stray comma before the closing bracket.
            if self.take(b')') {
                return Ok(());
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value<'a>, SyntaxFault> {
        self.skip_blanks();
        match self.peek() {
            None => Err(self.fault("the text ends inside a record")),
            Some(b'$') => {
                self.at += 1;
                Ok(Value::Null)
            }
            Some(b'*') => {
                self.at += 1;
                Ok(Value::Derived)
            }
            Some(b'#') => {
                self.number_sign().map(Value::Reference).ok_or_else(|| self.fault("entity number expected after '#'"))
            }
            Some(b'\'') => self.string().map(Value::Text),
            Some(b'"') => {
                let rest = self.text.get(self.at + 1..).unwrap_or("");
                let n = rest.find('"').ok_or_else(|| self.fault("a binary value does not end"))?;
                self.at += n + 2;
                Ok(Value::Binary)
            }
            Some(b'(') => self.list(depth + 1).map(Value::List),
            Some(b'.') if self.bytes.get(self.at + 1).is_some_and(|b| b.is_ascii_alphabetic() || *b == b'_') => {
                self.at += 1;
                let word = self.word();
                if self.peek() == Some(b'.') {
                    self.at += 1;
                }
                Ok(Value::Enumeration(word))
            }
            Some(b'0'..=b'9' | b'+' | b'-' | b'.') => self.number(),
            Some(b) if b.is_ascii_alphabetic() || b == b'_' || b == b'!' => {
                let name = self.word();
                self.skip_blanks();
                if self.peek() == Some(b'(') {
                    return self.list(depth + 1).map(Value::Typed);
                }
                match name.to_ascii_uppercase().as_str() {
                    "NAN" | "QNAN" | "SNAN" => Ok(Value::Number(f64::NAN)),
                    "INF" | "INFINITY" => Ok(Value::Number(f64::INFINITY)),
                    _ => Err(self.fault("a value expected")),
                }
            }
            Some(_) => Err(self.fault("a value expected")),
        }
    }

    /// A number; what some writers print for "not a number" and "infinite" arrives as such, to be refused by name.
    fn number(&mut self) -> Result<Value<'a>, SyntaxFault> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.' | b'#')) {
            self.at += 1;
        }
        let raw = self.text.get(start..self.at).unwrap_or("");
        if let Ok(x) = raw.parse::<f64>() {
            return Ok(Value::Number(x));
        }
        let upper = raw.to_ascii_uppercase();
        if let Ok(x) = upper.replace('D', "E").parse::<f64>() {
            return Ok(Value::Number(x));
        }
        if upper.contains("INF") {
            return Ok(Value::Number(if upper.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY }));
        }
        if upper.contains("NAN") || upper.contains("IND") {
            return Ok(Value::Number(f64::NAN));
        }
        Err(SyntaxFault { at: start, reason: "not a number" })
    }

    /// A string in apostrophes, escapes of ISO 10303-21 decoded.
    fn string(&mut self) -> Result<String, SyntaxFault> {
        let open = self.at;
        self.at += 1;
        let start = self.at;
        loop {
            match self.peek() {
                None => return Err(SyntaxFault { at: open, reason: "a string does not end" }),
                Some(b'\'') if self.bytes.get(self.at + 1) == Some(&b'\'') => self.at += 2,
                Some(b'\'') => break,
                Some(_) => self.at += 1,
            }
        }
        let raw = self.text.get(start..self.at).unwrap_or("");
        self.at += 1;
        Ok(decode(raw))
    }
}

/// Decodes `''`, `\\`, `\X\hh`, `\X2\…\X0\`, `\X4\…\X0\`, `\S\c` and drops `\Pc\` and line breaks.
fn decode(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(c) = rest.chars().next() {
        if let Some(after) = rest.strip_prefix("''") {
            out.push('\'');
            rest = after;
        } else if let Some((text, after)) = rest.strip_prefix("\\X2\\").and_then(|r| r.split_once("\\X0\\")) {
            let units: Vec<u16> = hex_groups(text, 4).map(|x| x as u16).collect();
            out.extend(char::decode_utf16(units).map(|r| r.unwrap_or(char::REPLACEMENT_CHARACTER)));
            rest = after;
        } else if let Some((text, after)) = rest.strip_prefix("\\X4\\").and_then(|r| r.split_once("\\X0\\")) {
            out.extend(hex_groups(text, 8).map(|x| char::from_u32(x).unwrap_or(char::REPLACEMENT_CHARACTER)));
            rest = after;
        } else if let Some(after) = rest.strip_prefix("\\X\\") {
            let code = after.get(..2).and_then(|h| u8::from_str_radix(h, 16).ok());
            out.push(code.map_or(char::REPLACEMENT_CHARACTER, char::from));
            rest = after.get(2..).unwrap_or("");
        } else if let Some(after) = rest.strip_prefix("\\S\\") {
            // The upper half of Latin-1, the default code page.
            if let Some(c) = after.chars().next() {
                out.push(char::from_u32(c as u32 + 128).unwrap_or(char::REPLACEMENT_CHARACTER));
                rest = &after[c.len_utf8()..];
            } else {
                rest = after;
            }
        } else if let Some(after) = rest.strip_prefix("\\\\") {
            out.push('\\');
            rest = after;
        } else if rest.starts_with("\\P") && rest.as_bytes().get(3) == Some(&b'\\') && rest.is_char_boundary(4) {
            rest = &rest[4..];
        } else {
            if !c.is_control() {
                out.push(c);
            }
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

fn hex_groups(text: &str, width: usize) -> impl Iterator<Item = u32> + '_ {
    text.as_bytes()
        .chunks(width)
        .filter_map(|c| std::str::from_utf8(c).ok().and_then(|h| u32::from_str_radix(h, 16).ok()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_every_kind() {
        let text = "( 1., -.5E+1, $, *, #12, .T., 'it''s', (1,2), LENGTH_MEASURE(3.), \"0AF\" /* note */ , nan )";
        let list = Cursor::new(text, 0).list(0).expect("a list");
        assert_eq!(list.len(), 11);
        assert_eq!(list[0], Value::Number(1.0));
        assert_eq!(list[1], Value::Number(-5.0));
        assert_eq!(list[4], Value::Reference(12));
        assert_eq!(list[5], Value::Enumeration("T"));
        assert_eq!(list[6], Value::Text("it's".into()));
        assert_eq!(list[8], Value::Typed([Value::Number(3.0)].into()));
        assert!(matches!(list[10], Value::Number(x) if x.is_nan()));
    }

    #[test]
    fn escapes_are_decoded() {
        assert_eq!(decode("K\\X2\\00F6\\X0\\rper \\S\\d \\X\\E9 \\\\ a''b"), "Körper ä é \\ a'b");
        assert_eq!(decode("\\X4\\0001F600\\X0\\"), "😀");
        assert_eq!(decode("\\X2\\00"), "\\X2\\00");
    }

    #[test]
    fn deep_lists_are_refused() {
        let text = "(".repeat(100_000);
        assert!(Cursor::new(&text, 0).list(0).is_err());
    }
}
