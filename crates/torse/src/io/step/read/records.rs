//! The table of records of an exchange structure, and typed, fallible access to their arguments.

use super::token::{Cursor, Value};
use std::collections::hash_map::Entry;
use std::collections::HashMap;

/// Why an entity could not be used.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    /// Number of the entity at fault, 0 if none can be named.
    pub entity: u64,
    /// What is wrong with it.
    pub reason: String,
}

impl Fault {
    /// A fault of entity `entity`.
    pub fn new(entity: u64, reason: impl Into<String>) -> Self {
        Self { entity, reason: reason.into() }
    }
}

/// One keyword with its arguments; a complex instance has several.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part<'a> {
    /// Keyword in upper case as in the file.
    pub name: &'a str,
    /// Arguments.
    pub args: Box<[Value<'a>]>,
}

/// An instance `#id = …;`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record<'a> {
    /// The keyword and arguments, or several for a complex instance.
    pub parts: Vec<Part<'a>>,
}

impl<'a> Record<'a> {
    /// The part with the given keyword.
    pub fn part(&self, name: &str) -> Option<&Part<'a>> {
        self.parts.iter().find(|p| p.name == name)
    }

    /// Keyword of a simple instance; of a complex one the last, which for geometry tells most.
    pub fn name(&self) -> &'a str {
        self.parts.last().map_or("", |p| p.name)
    }

    /// Arguments of the part `name`; this is record `#id`.
    pub fn args(&self, id: u64, name: &str) -> Result<Args<'_, 'a>, Fault> {
        let p = self.part(name).ok_or_else(|| Fault::new(id, format!("#{id} is a {}, not a {name}", self.name())))?;
        Ok(Args { id, values: &p.args })
    }

    /// Arguments of a simple instance, or of the last part of a complex one; this is record `#id`.
    pub fn simple(&self, id: u64) -> Result<Args<'_, 'a>, Fault> {
        let p = self.parts.last().ok_or_else(|| Fault::new(id, format!("#{id} is empty")))?;
        Ok(Args { id, values: &p.args })
    }
}

/// All records of the DATA sections.
#[derive(Debug, Default)]
pub(super) struct Records<'a> {
    by_number: HashMap<u64, Record<'a>>,
    /// Entity numbers in the order of the file.
    pub order: Vec<u64>,
    /// Entity numbers given to two records of different content; the first is used.
    pub repeated: Vec<u64>,
    /// What is no record.
    pub damage: Damage,
}

/// What a text holds that is no record, and how it ends.
#[derive(Debug, Default)]
pub(super) struct Damage {
    /// Number of stretches of text that are not records.
    pub unreadable: usize,
    /// Line of the first of these, counted from 1.
    pub first_unreadable_line: usize,
    /// Whether the text ends without ENDSEC.
    pub truncated: bool,
    /// Line in which the text ends inside a record, counted from 1.
    cut_line: Option<usize>,
}

impl Damage {
    fn add(&mut self, text: &str, at: usize) {
        self.unreadable += 1;
        if self.unreadable == 1 {
            self.first_unreadable_line = line(text, at);
        }
    }
}

/// Hands over every record of the text from its first `DATA;` on, with its number and where it begins. `None` if there is no such
/// section.
pub(super) fn each_record<'a>(text: &'a str, take: &mut dyn FnMut(u64, usize, Record<'a>)) -> Option<Damage> {
    let start = data_section(text)?;
    let mut out = Damage { truncated: true, ..Damage::default() };
    let mut c = Cursor::new(text, start);
    loop {
        c.skip_blanks();
        let Some(b) = c.peek() else { break };
        let statement = c.at;
        if b == b'#' {
            match record(&mut c) {
                Some((id, record)) => take(id, statement, record),
                None => {
                    out.add(text, statement);
                    c.at = resume(text, statement + 1);
                    if c.peek().is_none() {
                        out.cut_line = Some(line(text, text.len()));
                    }
                }
            }
            continue;
        }
        match c.word() {
            "ENDSEC" => {
                out.truncated = false;
                c.take(b';');
            }
            "DATA" => {
                // A further section, possibly with a parameter list.
                out.truncated = true;
                if c.list(0).is_err() {
                    c.skip_blanks();
                }
                c.take(b';');
            }
            word if word.starts_with("END-ISO") => break,
            _ => {
                out.add(text, statement);
                c.at = resume(text, statement + 1);
            }
        }
    }
    Some(out)
}

/// The record that begins at a place where one was found.
pub(super) fn record_at(text: &str, at: usize) -> Option<Record<'_>> {
    record(&mut Cursor::new(text, at)).map(|(_, record)| record)
}

impl<'a> Records<'a> {
    /// Reads every record of the text from its first `DATA;` on. `None` if there is no such section.
    pub fn parse(text: &'a str) -> Option<Self> {
        let mut out = Self::default();
        out.damage = each_record(text, &mut |id, _, record| out.insert(id, record))?;
        Some(out)
    }

    /// Adds a record.
    pub fn insert(&mut self, id: u64, record: Record<'a>) {
        match self.by_number.entry(id) {
            Entry::Vacant(v) => {
                v.insert(record);
                self.order.push(id);
            }
            Entry::Occupied(o) => {
                if *o.get() != record && self.repeated.last() != Some(&id) {
                    self.repeated.push(id);
                }
            }
        }
    }

    /// Where the text was cut off, in words, if something of it is certainly lost: it ends without ENDSEC, and inside a
    /// record or before records that others refer to. A file that lacks no more than its last lines is whole.
    pub fn loss(&self) -> Option<String> {
        if !self.damage.truncated {
            return None;
        }
        let after = self.order.last().map_or(String::new(), |id| format!(" after #{id}"));
        if let Some(line) = self.damage.cut_line {
            return Some(format!("it ends in line {line}, inside the record{after}"));
        }
        let absent = |v: &Value| missing(v, &self.by_number);
        let (from, to) = self.order.iter().find_map(|id| {
            let mut values = self.by_number.get(id)?.parts.iter().flat_map(|p| &p.args);
            values.find_map(absent).map(|to| (*id, to))
        })?;
        Some(format!("it ends{after} without ENDSEC, and #{from} refers to #{to}, which is not there"))
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.by_number.len()
    }

    /// The record `#id`.
    pub fn get(&self, id: u64) -> Result<&Record<'a>, Fault> {
        self.by_number.get(&id).ok_or_else(|| Fault::new(id, format!("#{id} is not in the file")))
    }

    /// Keyword of `#id`, empty if it is missing.
    pub fn name(&self, id: u64) -> &'a str {
        self.by_number.get(&id).map_or("", Record::name)
    }

    /// Arguments of the part `name` of `#id`.
    pub fn args(&self, id: u64, name: &str) -> Result<Args<'_, 'a>, Fault> {
        self.get(id)?.args(id, name)
    }

    /// Arguments of a simple instance, or of the last part of a complex one.
    pub fn simple(&self, id: u64) -> Result<Args<'_, 'a>, Fault> {
        self.get(id)?.simple(id)
    }

    /// Numbers of all records that have a part with one of the keywords, in the order of the file.
    pub fn all(&self, names: &[&str]) -> Vec<u64> {
        self.order
            .iter()
            .copied()
            .filter(|id| self.by_number.get(id).is_some_and(|r| r.parts.iter().any(|p| names.contains(&p.name))))
            .collect()
    }
}

/// Arguments of one part, with the entity for messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Args<'r, 'a> {
    /// Entity number.
    pub id: u64,
    /// The values.
    pub values: &'r [Value<'a>],
}

impl<'r, 'a> Args<'r, 'a> {
    /// The argument with the given index; numbers, references and lists may hide in a typed value.
    pub fn get(&self, index: usize) -> Result<&'r Value<'a>, Fault> {
        self.values.get(index).ok_or_else(|| self.fault(index, "is missing"))
    }

    fn fault(&self, index: usize, what: &str) -> Fault {
        Fault::new(self.id, format!("argument {} of #{} {what}", index + 1, self.id))
    }

    /// A reference.
    pub fn reference(&self, index: usize) -> Result<u64, Fault> {
        as_reference(self.get(index)?).ok_or_else(|| self.fault(index, "is not a reference"))
    }

    /// A finite number.
    pub fn number(&self, index: usize) -> Result<f64, Fault> {
        let x = as_number(self.get(index)?).ok_or_else(|| self.fault(index, "is not a number"))?;
        if x.is_finite() {
            Ok(x)
        } else {
            Err(self.fault(index, "is not a finite number"))
        }
    }

    /// A non-negative integer below 10⁶, far above any count that a record holds.
    pub fn count(&self, index: usize) -> Result<usize, Fault> {
        let x = self.number(index)?;
        if (0.0..1e6).contains(&x) && x.fract().abs() < f64::EPSILON {
            Ok(x as usize)
        } else {
            Err(self.fault(index, "is not a count"))
        }
    }

    /// A list.
    pub fn list(&self, index: usize) -> Result<&'r [Value<'a>], Fault> {
        match self.get(index)? {
            Value::List(l) => Ok(l),
            Value::Typed(l) => Ok(l),
            _ => Err(self.fault(index, "is not a list")),
        }
    }

    /// A list of references; members of another kind are left out.
    pub fn references(&self, index: usize) -> Result<Vec<u64>, Fault> {
        Ok(self.list(index)?.iter().filter_map(as_reference).collect())
    }

    /// A list of finite numbers.
    pub fn numbers(&self, index: usize) -> Result<Vec<f64>, Fault> {
        let list = self.list(index)?;
        list.iter()
            .map(|v| {
                as_number(v)
                    .filter(|x| x.is_finite())
                    .ok_or_else(|| self.fault(index, "holds what is not a finite number"))
            })
            .collect()
    }

    /// A logical value; `default` for `$` and unknown.
    pub fn logical(&self, index: usize, default: bool) -> bool {
        match self.values.get(index) {
            Some(Value::Enumeration("T" | "t" | "TRUE")) => true,
            Some(Value::Enumeration("F" | "f" | "FALSE")) => false,
            _ => default,
        }
    }

    /// A string; empty if it is something else.
    pub fn text(&self, index: usize) -> &'r str {
        match self.values.get(index) {
            Some(Value::Text(s)) => s,
            _ => "",
        }
    }
}

/// Line of a byte of the text, counted from 1.
fn line(text: &str, at: usize) -> usize {
    1 + text.as_bytes()[..at].iter().filter(|&&b| b == b'\n').count()
}

/// A reference in a value to what is not in the table.
fn missing(v: &Value, table: &HashMap<u64, Record>) -> Option<u64> {
    match v {
        Value::Reference(id) if !table.contains_key(id) => Some(*id),
        Value::List(l) | Value::Typed(l) => l.iter().find_map(|v| missing(v, table)),
        _ => None,
    }
}

/// The reference in a value.
pub(super) fn as_reference(v: &Value) -> Option<u64> {
    match v {
        Value::Reference(id) => Some(*id),
        Value::Typed(l) if l.len() == 1 => as_reference(&l[0]),
        _ => None,
    }
}

/// The number in a value, typed (`LENGTH_MEASURE(1.)`) or bare.
pub(super) fn as_number(v: &Value) -> Option<f64> {
    match v {
        Value::Number(x) => Some(*x),
        Value::Typed(l) if l.len() == 1 => as_number(&l[0]),
        _ => None,
    }
}

/// `#id = NAME(…);` or `#id = ( A(…) B(…) );`. The final semicolon may be missing.
fn record<'a>(c: &mut Cursor<'a>) -> Option<(u64, Record<'a>)> {
    let id = c.number_sign()?;
    if !c.take(b'=') {
        return None;
    }
    c.skip_blanks();
    let mut parts = Vec::with_capacity(1);
    if c.take(b'(') {
        while !c.take(b')') {
            let name = c.word();
            if name.is_empty() {
                return None;
            }
            parts.push(Part { name, args: c.list(0).ok()? });
        }
    } else {
        let name = c.word();
        if name.is_empty() {
            return None;
        }
        parts.push(Part { name, args: c.list(0).ok()? });
    }
    c.take(b';');
    Some((id, Record { parts }))
}

/// Offset just after the first `DATA;` (or `DATA(…);`) that is not part of a longer word, in a string or in a comment. Where that
/// finds none, as behind a string that does not end, strings do not count.
fn data_section(text: &str) -> Option<usize> {
    let all = || std::iter::successors(text.find("DATA"), |at| Some(at + 4 + text.get(at + 4..)?.find("DATA")?));
    let mut apart = Apart { text, at: 0 };
    all()
        .find_map(|at| section(text, at).filter(|_| apart.leaves(at)))
        .or_else(|| all().find_map(|at| section(text, at)))
}

/// The words `DATA;` or `DATA(…);` at an offset: the offset behind them.
fn section(text: &str, at: usize) -> Option<usize> {
    let before = text.as_bytes().get(at.wrapping_sub(1)).copied().unwrap_or(b' ');
    let mut c = Cursor::new(text, at + 4);
    c.skip_blanks();
    let whole = !(before.is_ascii_alphanumeric() || before == b'_' || before == b'\'');
    let named = c.peek() != Some(b'(') || whole && c.list(0).is_ok();
    (whole && named && c.take(b';')).then_some(c.at)
}

/// Strings and comments of a text, passed over from its beginning on.
struct Apart<'a> {
    text: &'a str,
    /// Up to here they are passed over.
    at: usize,
}

impl Apart<'_> {
    /// Whether an offset, none before the last one asked for, is outside strings and comments.
    fn leaves(&mut self, offset: usize) -> bool {
        let bytes = self.text.as_bytes();
        while self.at < offset {
            let end = match (bytes[self.at], bytes.get(self.at + 1)) {
                (b'\'', _) => Some("'"),
                (b'/', Some(b'*')) => Some("*/"),
                _ => None,
            };
            let Some(end) = end else {
                self.at += 1;
                continue;
            };
            let from = self.at + end.len();
            let length = self.text.get(from..).and_then(|rest| rest.find(end));
            self.at = length.map_or(bytes.len(), |n| from + n + end.len());
        }
        self.at == offset
    }
}

/// Where reading goes on after damage: the next line that starts with `#`, or the next `;`, whichever is nearer.
fn resume(text: &str, from: usize) -> usize {
    let bytes = text.as_bytes();
    let mut i = from.min(bytes.len());
    while i < bytes.len() {
        match bytes[i] {
            b';' => return i + 1,
            b'\n' | b'\r' if bytes.get(i + 1) == Some(&b'#') => return i + 1,
            _ => i += 1,
        }
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_does_not_spread() {
        let text = "HEADER;ENDSEC;\nDATA;\n#1=A(1.);\n#2=B('open,\n#3=C(#1);\n#4=(X(1)Y(2,'a;b'));\n#4=Z();garbage;\n\0#5=D((#1,#2),$)";
        let r = Records::parse(text).expect("a data section");
        // The open string of #2 runs to the next apostrophe; that loses #3 but nothing later.
        assert!(r.get(1).is_ok() && r.get(4).is_ok() && r.get(5).is_ok());
        assert_eq!(r.get(4).expect("4").parts.len(), 2);
        assert_eq!(r.repeated, vec![4]);
        assert!(r.damage.truncated && r.damage.unreadable >= 1);
        assert_eq!(r.args(5, "D").expect("args").references(0).expect("list"), vec![1, 2]);
    }

    #[test]
    fn names_may_hold_the_word_data() {
        let r = Records::parse("FILE_NAME('DATA; x');META_DATA;DATA;#1=A();ENDSEC;").expect("section");
        assert_eq!(r.len(), 1);
        assert!(!r.damage.truncated);
        for header in [
            "'see DATA; #1=B();#2=C();'",
            "'it''s DATA; #1=B();'",
            "/* old DATA; #1=B();' */",
            "'a' /* b */, ' DATA;#1=B();'",
        ] {
            let text = format!("HEADER;FILE_NAME({header});ENDSEC;\nDATA;#1=A();ENDSEC;");
            let r = Records::parse(&text).expect("section");
            assert_eq!((r.len(), r.name(1), r.damage.unreadable), (1, "A", 0), "{header}");
        }
        // A string that does not end hides no data.
        let r = Records::parse("HEADER;FILE_NAME('it's);ENDSEC;\nDATA;\n#1=A('x');ENDSEC;").expect("section");
        assert_eq!(r.len(), 1);
    }
}
