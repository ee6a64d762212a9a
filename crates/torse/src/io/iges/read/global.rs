//! The global section: delimiters, units, names.

use super::fields::{Delimiters, Field, Reader};
use crate::answer::note::reader::UnitNote;
use crate::geom::unit;

/// What the global section says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Global {
    /// Delimiters of parameter data.
    pub delimiters: Delimiters,
    /// Millimetres of the real part per number of the file.
    pub millimetres: f64,
    /// Name of the unit in lower case; empty if the file names none.
    pub unit: String,
    /// Smallest distance (mm) that the sender tells apart; 0 if it does not say.
    pub resolution: f64,
    /// Name of the product, else of the file.
    pub product: String,
    /// Remarks.
    pub notes: Vec<UnitNote>,
}

/// Length units by their flag.
const UNITS: [(i64, &str); 10] = [
    (1, "inch"),
    (2, "millimetre"),
    (4, "foot"),
    (5, "mile"),
    (6, "metre"),
    (7, "kilometre"),
    (8, "mil"),
    (9, "micrometre"),
    (10, "centimetre"),
    (11, "microinch"),
];
/// The flag that leaves the unit to its name.
const NAMED: i64 = 3;
/// What the standard assumes where neither flag nor name is given: inches.
const DEFAULT: i64 = 1;
/// Fields of the section at most.
const MOST_FIELDS: usize = 40;

impl Global {
    /// Reads the section.
    pub fn of(data: &[u8]) -> Self {
        let (fields, delimiters) = fields(data);
        let mut out = Self {
            delimiters,
            millimetres: 1.0,
            unit: String::new(),
            resolution: 0.0,
            product: String::new(),
            notes: Vec::new(),
        };
        let text = |k: usize| match fields.get(k - 1) {
            Some(Field::Text(t)) => t.trim().to_string(),
            _ => String::new(),
        };
        let number = |k: usize| match fields.get(k - 1) {
            Some(Field::Number(x)) => Some(*x),
            _ => None,
        };
        out.product = [3, 12, 4].into_iter().map(text).find(|t| !t.is_empty()).unwrap_or_default();
        out.set_unit(number(14), &text(15));
        match number(13) {
            Some(scale) if scale > 0.0 && scale != 1.0 => {
                out.millimetres /= scale;
                out.notes.push(UnitNote::Scale { scale, millimetres: out.millimetres });
            }
            _ => {}
        }
        out.resolution = number(19).filter(|x| *x > 0.0).map_or(0.0, |x| x * out.millimetres);
        out
    }

    fn set_unit(&mut self, flag: Option<f64>, name: &str) {
        let by_flag = |f: i64| unit::named(UNITS.iter().find(|u| u.0 == f)?.1);
        let by_name = || unit::named(name);
        let stated = flag.map(|f| f as i64);
        let found = match stated {
            Some(NAMED) => by_name(),
            Some(f) => by_flag(f).or_else(by_name),
            None if !name.is_empty() => by_name(),
            None => None,
        };
        match found {
            Some(u) => {
                (self.millimetres, self.unit) = (u.mm, u.name.to_string());
                if by_name().is_some_and(|n| n.name != u.name) {
                    self.notes.push(UnitNote::Differ { flag: u.name.into(), name: name.into() });
                }
            }
            None if name.is_empty() => {
                self.millimetres = by_flag(DEFAULT).map_or(1.0, |u| u.mm);
                self.notes.push(UnitNote::Inches);
            }
            None => self.notes.push(UnitNote::Unknown { name: name.into() }),
        }
    }
}

/// The fields with the delimiters that the first two of them state.
fn fields(data: &[u8]) -> (Vec<Field>, Delimiters) {
    let mut delimiters = Delimiters::default();
    // The first field names its own delimiter: 1Hx followed by that x.
    let start = data.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(data.len());
    let usable = |b: u8| b.is_ascii_punctuation() && !matches!(b, b'+' | b'-' | b'.');
    if let [b'1', b'H' | b'h', c, d, ..] = data[start..] {
        if c == d && usable(c) {
            delimiters.field = c;
        }
    }
    // Until the second field has said which, nothing ends the record.
    let mut reader = Reader::new(data, Delimiters { record: delimiters.field, ..delimiters });
    let mut out = Vec::new();
    for k in 0..MOST_FIELDS {
        reader.ended = reader.ended && k > 1;
        let Some(field) = reader.next() else { break };
        if k == 1 {
            if let Field::Text(t) = &field {
                if let [c] = t.as_bytes() {
                    if usable(*c) && *c != delimiters.field {
                        delimiters.record = *c;
                    }
                }
            }
            reader.delimiters = delimiters;
            reader.ended = false;
        }
        out.push(field);
    }
    (out, delimiters)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn global(unit: &str) -> Global {
        Global::of(format!("1H,,1H;,3Hbox,9Hbox,1.igs,,,32,38,6,308,15,,{unit},1,0.1,,1e-3;").as_bytes())
    }

    #[test]
    fn units_by_flag_and_by_name() {
        for (text, mm, name) in [
            ("1.,2,2HMM", 1.0, "millimetre"),
            ("1.0D0,1,4HINCH", 25.4, "inch"),
            (",3,2HFT", 304.8, "foot"),
            ("1,6,", 1000.0, "metre"),
            ("1,,2HCM", 10.0, "centimetre"),
            ("1,,", 25.4, ""),
            ("0.5,2,2HMM", 2.0, "millimetre"),
        ] {
            let g = global(text);
            assert!((g.millimetres - mm).abs() < 1e-12 && g.unit == name, "{text}: {g:?}");
            assert!((g.resolution - 1e-3 * mm).abs() < 1e-12);
            assert_eq!(g.product, "box");
        }
        let differ = UnitNote::Differ { flag: "inch".into(), name: "MM".into() };
        let unknown = UnitNote::Unknown { name: "CUBIT".into() };
        for (text, note) in [("1,0,", UnitNote::Inches), ("1,3,5HCUBIT", unknown), ("1,1,2HMM", differ)] {
            let g = global(text);
            assert!(g.notes.contains(&note), "{text}: {:?}", g.notes);
        }
    }

    #[test]
    fn other_delimiters_are_taken_over() {
        let g = Global::of(b"1H//1H#/3Hbox/////////3Hbox/1./6/1HM/1/1.#");
        assert_eq!(g.delimiters, Delimiters { field: b'/', record: b'#' });
        assert_eq!((g.unit.as_str(), g.product.as_str()), ("metre", "box"));
        let g = Global::of(b",,3Hbox,9Hbox,1.igs,,,32,38,6,308,15,,1.,2,2HMM;");
        assert_eq!((g.delimiters, g.unit.as_str()), (Delimiters::default(), "millimetre"));
    }
}
