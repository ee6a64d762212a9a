//! Entities: directory entries with their parameter data.

use super::fields::{Delimiters, Field, Reader};
use super::global::Global;
use super::sections::{SectionLine, Sections};
use crate::answer::note::reader::ReaderNote;
use crate::num::parallel;
use std::collections::HashMap;

/// Something in the file that cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    /// Number of the directory entry.
    pub entity: u64,
    /// Why.
    pub reason: String,
}

impl Fault {
    /// A fault of an entity.
    pub fn new(entity: u64, reason: impl Into<String>) -> Self {
        Self { entity, reason: reason.into() }
    }
}

/// An entity.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Sequence number of its first line in the directory, an odd number: the `D` number by which others refer to it.
    pub number: u64,
    /// Type: 100 is a circular arc.
    pub kind: u32,
    /// Form of the type.
    pub form: i64,
    /// Number of its level.
    pub level: i64,
    /// Entry of the transformation matrix; 0 for none.
    pub matrix: u64,
    /// Whether it is hidden.
    pub blanked: bool,
    /// Whether it is marked as a physical part of another entity.
    pub dependent: bool,
    /// What it is for: 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 parameter plane, 6 construction.
    pub purpose: u32,
    /// Label with subscript; empty if it has none.
    pub label: String,
    /// Parameter data; the first field is the type.
    pub fields: Vec<Field>,
    /// Whether the record delimiter was met.
    pub complete: bool,
}

/// Definitions by definitions by definitions…, and assemblies: real files stay below 10.
pub(super) const DEEPEST: u32 = 24;

/// Columns of parameter data before the number of the directory entry.
const DATA: usize = 64;
/// Columns of a field of the directory.
const COLUMNS: usize = 8;
/// Lines of parameter data of one entity at most.
const MOST_LINES: usize = 5_000_000;

impl Entry {
    /// Field `k`; the first after the type is 1. Fields that are left out are zero.
    pub fn number(&self, k: usize) -> Result<f64, Fault> {
        match self.fields.get(k) {
            Some(Field::Number(x)) => Ok(*x),
            Some(Field::Empty) | None => Ok(0.0),
            Some(other) => Err(self.wrong(k, other)),
        }
    }

    /// Whether field `k` is there and not empty.
    pub fn has(&self, k: usize) -> bool {
        !matches!(self.fields.get(k), None | Some(Field::Empty))
    }

    /// A whole number.
    pub fn integer(&self, k: usize) -> Result<i64, Fault> {
        let x = self.number(k)?;
        if x.fract() == 0.0 && x.abs() < WHOLE {
            Ok(x as i64)
        } else {
            Err(Fault::new(self.number, format!("field {k} of D{} is {x}, not a whole number", self.number)))
        }
    }

    /// A number of things that the parameter data list: never more than there are fields.
    pub fn count(&self, k: usize) -> Result<usize, Fault> {
        let n = self.integer(k)?;
        match usize::try_from(n) {
            Ok(n) if n <= self.fields.len() => Ok(n),
            _ => Err(Fault::new(
                self.number,
                format!("D{} is to list {n} items, but its data have {} fields", self.number, self.fields.len()),
            )),
        }
    }

    /// A number of an item in another entity's list.
    pub fn count_any(&self, k: usize) -> Result<usize, Fault> {
        let n = self.integer(k)?;
        usize::try_from(n).map_err(|_| Fault::new(self.number, format!("field {k} of D{} is {n}", self.number)))
    }

    /// A reference to another entity; 0 for none. Some are written negative.
    pub fn optional(&self, k: usize) -> Result<u64, Fault> {
        Ok(self.integer(k)?.unsigned_abs())
    }

    /// A reference to another entity.
    pub fn pointer(&self, k: usize) -> Result<u64, Fault> {
        match self.optional(k)? {
            0 => Err(Fault::new(self.number, format!("D{} names no entity in field {k}", self.number))),
            p => Ok(p),
        }
    }

    /// `n` references from field `k` on.
    pub fn pointers(&self, k: usize, n: usize) -> Result<Vec<u64>, Fault> {
        self.reaches(k, n)?;
        (k..k + n).map(|k| self.pointer(k)).collect()
    }

    /// `n` numbers from field `k` on.
    pub fn numbers(&self, k: usize, n: usize) -> Result<Vec<f64>, Fault> {
        self.reaches(k, n)?;
        (k..k + n).map(|k| self.number(k)).collect()
    }

    /// A string; empty if it is none.
    pub fn text(&self, k: usize) -> &str {
        match self.fields.get(k) {
            Some(Field::Text(t)) => t.trim(),
            _ => "",
        }
    }

    /// Whether the data hold `n` fields from `k` on.
    fn reaches(&self, k: usize, n: usize) -> Result<(), Fault> {
        if k.checked_add(n).is_some_and(|end| end <= self.fields.len()) {
            return Ok(());
        }
        let there = self.fields.len().saturating_sub(k);
        Err(Fault::new(self.number, format!("the data of D{} end early: {there} of {n} fields are there", self.number)))
    }

    fn wrong(&self, k: usize, field: &Field) -> Fault {
        let what = match field {
            Field::Text(t) | Field::Unreadable(t) => t.as_ref(),
            Field::Number(_) | Field::Empty => "",
        };
        Fault::new(self.number, format!("field {k} of D{} is {what:?}, not a number", self.number))
    }
}

/// Largest whole number that a reference or a count can be: sequence numbers have seven digits.
const WHOLE: f64 = 1e9;

/// The entities of a file.
#[derive(Debug)]
pub(super) struct Records {
    /// The global section.
    pub global: Global,
    /// Numbers of the entities in the order of the directory.
    pub order: Vec<u64>,
    /// What was found wrong with the file as a whole.
    pub notes: Vec<ReaderNote>,
    /// Entities whose parameter data are not there.
    pub lost: Vec<u64>,
    /// Numbers and types of entities that have parameter data but no entry in the directory.
    pub unlisted: Vec<(u64, u32)>,
    entries: HashMap<u64, Entry>,
}

impl Records {
    /// Reads directory and parameter data.
    pub fn of(sections: &Sections) -> Self {
        let global = Global::of(&sections.global);
        let mut notes: Vec<ReaderNote> = global.notes.iter().cloned().map(ReaderNote::Unit).collect();
        let mut entries = directory(&sections.directory, &mut notes);
        let data = Data::of(sections, global.delimiters.record);
        let delimiters = global.delimiters;
        parallel::for_each(entries.iter_mut(), |(entry, place)| {
            let text = data.text(entry, *place);
            (entry.fields, entry.complete) = parameters(&text, entry.kind, delimiters);
        });
        let order: Vec<u64> = entries.iter().map(|e| e.0.number).collect();
        let lost: Vec<u64> = entries.iter().filter(|e| e.0.fields.is_empty()).map(|e| e.0.number).collect();
        let open = entries.iter().filter(|e| !e.0.complete && !e.0.fields.is_empty()).count();
        if open > 0 {
            notes.push(ReaderNote::OpenData { entities: open });
        }
        let entries: HashMap<u64, Entry> = entries.into_iter().map(|(e, _)| (e.number, e)).collect();
        let unlisted = data.unlisted(&entries);
        Self { global, order, notes, lost, unlisted, entries }
    }

    /// The entity with a number.
    pub fn get(&self, number: u64) -> Result<&Entry, Fault> {
        let entry = self.entries.get(&number);
        let entry = entry.ok_or_else(|| Fault::new(number, format!("D{number} is not in the directory")))?;
        if entry.fields.is_empty() {
            return Err(Fault::new(number, format!("the parameter data of D{number} are missing")));
        }
        Ok(entry)
    }

    /// The entity with a number, with its data or without.
    pub fn entry(&self, number: u64) -> Option<&Entry> {
        self.entries.get(&number)
    }

    /// The type of an entity; 0 if there is none.
    pub fn kind(&self, number: u64) -> u32 {
        self.entries.get(&number).map_or(0, |e| e.kind)
    }

    /// All entities in the order of the directory.
    pub fn all(&self) -> impl Iterator<Item = &Entry> {
        self.order.iter().filter_map(|n| self.entries.get(n))
    }
}

/// Sequence number of the first line of an entity's data, and how many lines it has.
type Place = (u64, usize);

fn directory(lines: &[SectionLine], notes: &mut Vec<ReaderNote>) -> Vec<(Entry, Place)> {
    let mut out = Vec::with_capacity(lines.len() / 2);
    let mut broken = 0;
    let mut i = 0;
    while i < lines.len() {
        let first = &lines[i];
        match lines.get(i + 1).filter(|second| first.stated % 2 == 1 && second.stated == first.stated + 1) {
            Some(second) => {
                out.push(entry(first, second));
                i += 2;
            }
            None => {
                broken += 1;
                i += 1;
            }
        }
    }
    if broken > 0 {
        notes.push(ReaderNote::HalfEntries { lines: broken });
    }
    out
}

fn entry(first: &SectionLine, second: &SectionLine) -> (Entry, Place) {
    let whole = |line: &SectionLine, k: usize| -> i64 {
        let text = column(line, k);
        text.parse::<i64>().unwrap_or(0)
    };
    // Leading zeros may be blanks.
    let status: Vec<u8> = {
        let text = column(first, 8).replace(' ', "0");
        format!("{text:0>8}").bytes().map(|b| if b.is_ascii_digit() { b - b'0' } else { 0 }).collect()
    };
    let pair = |k: usize| status.get(k..k + 2).map_or(0, |d| 10 * u32::from(d[0]) + u32::from(d[1]));
    let (label, subscript) = (column(second, 7), whole(second, 8));
    let label = if subscript > 0 { format!("{label} {subscript}") } else { label };
    let entry = Entry {
        number: first.stated,
        kind: u32::try_from(whole(first, 0)).unwrap_or(0),
        form: whole(second, 4),
        level: whole(first, 4),
        matrix: whole(first, 6).unsigned_abs(),
        blanked: pair(0) == 1,
        dependent: matches!(pair(2), 1 | 3),
        purpose: pair(4),
        label: label.trim().to_string(),
        fields: Vec::new(),
        complete: false,
    };
    let lines = usize::try_from(whole(second, 3)).unwrap_or(0).min(MOST_LINES);
    (entry, (whole(first, 1).unsigned_abs(), lines))
}

/// A field of a line of the directory.
fn column(line: &SectionLine, k: usize) -> String {
    let (from, to) = ((k * COLUMNS).min(line.data.len()), ((k + 1) * COLUMNS).min(line.data.len()));
    line.data[from..to].iter().map(|&b| char::from(b)).collect::<String>().trim().to_string()
}

/// The lines of the parameter data.
struct Data<'a> {
    lines: &'a [SectionLine<'a>],
    /// Entity that each line belongs to, as it says itself.
    owner: Vec<u64>,
    /// First line of each owner.
    first: HashMap<u64, usize>,
    /// Delimiter of records.
    record: u8,
}

impl<'a> Data<'a> {
    fn of(sections: &'a Sections<'a>, record: u8) -> Self {
        let lines = &sections.parameter[..];
        let owner: Vec<u64> = lines.iter().map(owner).collect();
        let mut first = HashMap::new();
        for (i, o) in owner.iter().enumerate() {
            first.entry(*o).or_insert(i);
        }
        Self { lines, owner, first, record }
    }

    /// Owners of lines that are not in the directory, with the type that their data begin with.
    fn unlisted(&self, entries: &HashMap<u64, Entry>) -> Vec<(u64, u32)> {
        let missing = self.first.iter().filter(|(owner, _)| **owner > 0 && !entries.contains_key(owner));
        let kind = |i: usize| {
            let data = data_of(&self.lines[i]);
            let digits = data.iter().copied().skip_while(|b| *b == b' ').take_while(u8::is_ascii_digit).take(5);
            digits.fold(0, |n, d| 10 * n + u32::from(d - b'0'))
        };
        let mut out: Vec<(u64, u32)> = missing.map(|(owner, i)| (*owner, kind(*i))).collect();
        out.sort_unstable();
        out
    }

    /// The data of an entity: where the directory says, unless the lines there say that they belong to another.
    fn text(&self, entry: &Entry, (start, count): Place) -> Vec<u8> {
        let stated = self.lines.binary_search_by_key(&start, |l| l.stated).ok();
        let own = |i: usize| self.owner[i] == entry.number;
        let at = match (stated, self.first.get(&entry.number)) {
            (Some(i), _) if own(i) => i,
            (_, Some(&i)) => i,
            (Some(i), None) if self.owner[i] == 0 => i,
            _ => return Vec::new(),
        };
        let mut out = Vec::new();
        for i in at..self.lines.len() {
            let inside = i < at + count && self.owner[i] == self.owner[at];
            if !inside && !own(i) {
                break;
            }
            let line = data_of(&self.lines[i]);
            let last = line.iter().rfind(|b| !b.is_ascii_whitespace());
            out.extend_from_slice(line);
            // Strings run on over the end of a line, whose blanks count.
            out.extend(std::iter::repeat_n(b' ', DATA.saturating_sub(line.len())));
            // Lines without owner may all be asked for by everyone: the first end of a record is enough.
            if self.owner[i] == 0 && last == Some(&self.record) {
                break;
            }
        }
        out
    }
}

/// Data columns of a line.
fn data_of<'a>(line: &SectionLine<'a>) -> &'a [u8] {
    match line.data.len() {
        n if n >= DATA + COLUMNS => &line.data[..DATA],
        // Blanks were lost: the last word is the number of the entity.
        n => &line.data[..line.data.iter().rposition(u8::is_ascii_whitespace).unwrap_or(n)],
    }
}

fn owner(line: &SectionLine) -> u64 {
    let text: Vec<u8> = match line.data.len() {
        n if n >= DATA + COLUMNS => line.data[DATA..].to_vec(),
        _ => line.data.rsplit(u8::is_ascii_whitespace).next().unwrap_or_default().to_vec(),
    };
    std::str::from_utf8(&text).ok().and_then(|t| t.trim().parse().ok()).unwrap_or(0)
}

/// Fields of parameter data, if they are those of an entity of this type.
fn parameters(text: &[u8], kind: u32, delimiters: Delimiters) -> (Vec<Field>, bool) {
    let (fields, ended) = Reader::new(text, delimiters).all();
    match fields.first() {
        Some(Field::Number(x)) if *x == f64::from(kind) => (fields, ended),
        _ => (Vec::new(), ended),
    }
}
