//! Tables of numbers as people and programs write them, for every reader of tables: rows, separators, decimal signs and
//! the names of columns. What could be read in two ways is refused, never guessed.
//!
//! - Cells of a row are separated by semicolons, else by tabs, else by commas, else by blanks; all rows alike. The last
//!   separator of a line may have nothing behind it; other empty cells stay empty cells. Cells may be in double quotes.
//! - `#` begins a comment, `//` at the start of a line too.
//! - Where semicolons or tabs separate, a comma in a number is its decimal sign; one table has one decimal sign.
//! - A first row without any number names the columns, as does a comment above the first row that names `x`, `y` and `z`
//!   and as many columns as there are. Names may carry a unit: `x [m]`, `y (mm)`, `z_in`.

use crate::geom::unit;
use std::borrow::Cow;
use std::cell::Cell;

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    /// Line, counted from 1.
    pub line: usize,
    /// The reason.
    pub reason: String,
}

/// What stands between the cells of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Separator {
    Semicolon,
    Tab,
    Comma,
    Blank,
}

impl Separator {
    /// That of a line; `None` for a single cell.
    fn of(line: &str) -> Option<Self> {
        let has = |wanted: &dyn Fn(char) -> bool| {
            let mut quoted = false;
            line.chars().any(|c| {
                quoted ^= c == '"';
                !quoted && wanted(c)
            })
        };
        let blank = |c: char| c.is_whitespace();
        let order: [(&dyn Fn(char) -> bool, Self); 4] = [
            (&|c| c == ';', Self::Semicolon),
            (&|c| c == '\t', Self::Tab),
            (&|c| c == ',', Self::Comma),
            (&blank, Self::Blank),
        ];
        order.iter().find(|(wanted, _)| has(wanted)).map(|(_, s)| *s)
    }

    fn splits(self, c: char) -> bool {
        match self {
            Self::Semicolon => c == ';',
            Self::Tab => c == '\t',
            Self::Comma => c == ',',
            Self::Blank => c.is_whitespace(),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Comma => "commas",
            Self::Blank => "blanks",
        }
    }
}

/// A row that holds numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row<'a> {
    /// Line, counted from 1.
    pub line: usize,
    /// Whether an empty line stands between the row before and this one.
    pub gap: bool,
    text: &'a str,
}

/// The name of a column.
#[derive(Clone, Debug, PartialEq)]
struct Heading {
    /// In small letters, without the unit.
    name: String,
    /// As written.
    text: String,
    /// Length of its unit, mm.
    unit: Option<f64>,
}

/// A table.
#[derive(Debug)]
pub(super) struct Table<'a> {
    /// Rows of numbers, in the order of the file.
    pub rows: Vec<Row<'a>>,
    /// Number of rows that a first line with one whole number promises.
    pub promised: Option<usize>,
    headings: Vec<Heading>,
    /// Line of the headings.
    head: usize,
    separator: Option<Separator>,
    width: usize,
    decimal: Cell<Option<char>>,
}

/// The text of a file, without the mark of its byte order; bytes that are no UTF-8 are replaced.
///
/// # Errors
/// Text in two-byte characters, and what is no text at all.
pub(super) fn text(bytes: &[u8]) -> Result<Cow<'_, str>, Fault> {
    let fault = |reason: &str| Err(Fault { line: 1, reason: reason.into() });
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return fault("the text is UTF-16; save it as UTF-8");
    }
    if bytes.contains(&0) {
        return fault("this is no text but a binary file; a table is plain text");
    }
    Ok(String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)))
}

/// Rows and headings of a text.
///
/// # Errors
/// Rows with another separator than those before, commas that may be separators or decimal signs.
pub(super) fn table(text: &str) -> Result<Table<'_>, Fault> {
    let mut out = Table {
        rows: Vec::new(),
        promised: None,
        headings: Vec::new(),
        head: 1,
        separator: None,
        width: 0,
        decimal: Cell::new(None),
    };
    let (mut gap, mut remark, mut headed) = (false, "", false);
    // Files of old systems end their lines with a return only.
    let ends: &[char] = if text.contains('\n') { &['\n'] } else { &['\r', '\n'] };
    for (k, whole) in text.split(ends).enumerate() {
        let line = k + 1;
        let content = content(whole);
        if content.is_empty() {
            // A line with nothing but a comment separates nothing.
            gap |= whole.trim().is_empty();
            if out.rows.is_empty() && !whole.trim().is_empty() {
                remark = whole.trim().trim_start_matches(['#', '/']).trim();
            }
            continue;
        }
        let own = Separator::of(content);
        if out.rows.is_empty() {
            let mut row = cells(content, own);
            if row.len() > 1 && row.last().is_some_and(|c| c.is_empty()) {
                row.pop();
            }
            if !headed && row.iter().all(|c| number(c).is_none()) && row.iter().any(|c| !c.is_empty()) {
                out.headings = row.iter().map(|c| heading(c)).collect();
                (headed, out.head) = (true, line);
                continue;
            }
            let count: Option<usize> = if row.len() == 1 { row[0].parse().ok() } else { None };
            if !headed && out.promised.is_none() && count.is_some() {
                out.promised = count;
                continue;
            }
            (out.separator, out.width) = (own, row.len());
            gap = false;
        } else if own != out.separator {
            return Err(Fault { line, reason: mixed(own, out.separator) });
        }
        if own == Some(Separator::Comma) && doubtful(content) {
            let reason = "commas are followed by a blank at every second place: if the others are decimal signs, \
                          separate the numbers by semicolons, else remove the blanks";
            return Err(Fault { line, reason: reason.into() });
        }
        out.rows.push(Row { line, gap, text: content });
        gap = false;
    }
    if out.headings.is_empty() {
        out.headings = named_by_remark(remark, out.width);
    }
    if !out.headings.is_empty() {
        out.width = out.headings.len();
    }
    Ok(out)
}

impl Table<'_> {
    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Refuses another number of rows than a first line promises.
    ///
    /// # Errors
    /// Rows that are missing or too many.
    pub fn counted(&self) -> Result<(), Fault> {
        match self.promised.filter(|n| *n != self.rows.len()) {
            Some(n) => Err(Fault { line: 1, reason: format!("it promises {n} rows, there are {}", self.rows.len()) }),
            None => Ok(()),
        }
    }

    /// Whether the columns have names.
    pub fn is_named(&self) -> bool {
        !self.headings.is_empty()
    }

    /// Place of the column with a name (in small letters).
    ///
    /// # Errors
    /// Two columns of that name.
    pub fn column(&self, name: &str) -> Result<Option<usize>, Fault> {
        let mut found = (0..self.headings.len()).filter(|k| self.headings[*k].name == name);
        let first = found.next();
        match found.next() {
            Some(_) => {
                Err(Fault { line: self.head, reason: format!("two columns are named {name}: rename one of them") })
            }
            None => Ok(first),
        }
    }

    /// Places of all of these columns; `None` if none of them is named.
    ///
    /// # Errors
    /// Some of them, but not all; two columns of one name.
    pub fn group(&self, names: &[&str]) -> Result<Option<Vec<usize>>, Fault> {
        let found = names.iter().map(|n| self.column(n)).collect::<Result<Vec<_>, _>>()?;
        if found.iter().all(Option::is_none) {
            return Ok(None);
        }
        let all: Option<Vec<usize>> = found.iter().copied().collect();
        all.map(Some).ok_or_else(|| Fault {
            line: self.head,
            reason: format!("of the columns {} some are missing; there are {}", names.join(", "), self.names()),
        })
    }

    /// Places of the columns that are needed: by their names, or, in a table of just as many columns without names, or
    /// whose names are those of geodesy for the same, in their order.
    ///
    /// # Errors
    /// Columns that cannot be told.
    pub fn needed(&self, names: &[&str]) -> Result<Vec<usize>, Fault> {
        let list = names.join(", ");
        if !self.is_named() {
            if self.width == names.len() {
                return Ok((0..self.width).collect());
            }
            return Err(self.unnamed(names));
        }
        let found = names.iter().map(|n| self.column(n)).collect::<Result<Vec<_>, _>>()?;
        if found.iter().all(Option::is_none) && self.width == names.len() && self.is_surveyed() {
            return Ok((0..self.width).collect());
        }
        let all: Option<Vec<usize>> = found.into_iter().collect();
        all.ok_or_else(|| Fault {
            line: self.head,
            reason: format!(
                "the columns are named {}; {} of them must be {list}: rename them, or leave the names out if they come in \
                 this order",
                self.names(),
                names.len()
            ),
        })
    }

    /// Whether the columns are those of surveyors for x, y and z, in this order: easting, northing, height.
    fn is_surveyed(&self) -> bool {
        let begins = |k: usize, starts: &[&str]| starts.iter().any(|s| self.headings[k].name.starts_with(s));
        self.width == 3
            && begins(0, &["east", "x"])
            && begins(1, &["north", "y"])
            && begins(2, &["height", "elev", "alt", "up", "z"])
    }

    /// Rows of a number of columns that no line names.
    fn unnamed(&self, names: &[&str]) -> Fault {
        let line = self.rows.first().map_or(1, |r| r.line);
        let list = names.join(", ");
        let mut reason = if self.width < names.len() {
            format!("{list} are needed, {} numbers; there are {}", names.len(), self.width)
        } else {
            format!(
                "there are {} columns, and no first line says which are {list}: name the columns in a first line, or \
                 leave only these {}",
                self.width,
                names.len()
            )
        };
        if self.separator == Some(Separator::Comma) && self.width == 2 * names.len() {
            reason += "; if commas are decimal signs, separate the numbers by semicolons";
        }
        Fault { line, reason }
    }

    /// The unit that headings name for these columns, mm.
    ///
    /// # Errors
    /// Different units, and headings of which only some say one.
    pub fn unit(&self, columns: &[usize]) -> Result<Option<f64>, Fault> {
        let units: Vec<Option<f64>> = columns.iter().filter_map(|k| Some(self.headings.get(*k)?.unit)).collect();
        let first = units.iter().copied().flatten().next();
        if first.is_some() && units.contains(&None) {
            let reason =
                format!("only some of the columns {} name a unit; write it for all lengths, or for none", self.names());
            return Err(Fault { line: self.head, reason });
        }
        if units.iter().any(|u| *u != first) {
            let reason = format!("columns have different units: {}; write all lengths in one", self.names());
            return Err(Fault { line: self.head, reason });
        }
        Ok(first)
    }

    /// The unit (mm) of columns: that of the headings where none is given.
    ///
    /// # Errors
    /// Headings that say another unit than the one given.
    pub fn unit_or(&self, columns: &[usize], given: Option<f64>) -> Result<Option<f64>, Fault> {
        let own = self.unit(columns)?;
        match (own, given) {
            (Some(own), Some(given)) if own != given => Err(Fault {
                line: self.head,
                reason: format!("the headings {} say another unit than --unit; give it as they do", self.names()),
            }),
            _ => Ok(own.or(given)),
        }
    }

    /// Numbers of a row in some columns, into `out`.
    ///
    /// # Errors
    /// Another number of cells than columns, cells that are empty or no numbers.
    pub fn numbers(&self, row: &Row, columns: &[usize], out: &mut Vec<f64>) -> Result<(), Fault> {
        let fault = |reason: String| Fault { line: row.line, reason };
        out.clear();
        let mut cells = cells(row.text, self.separator);
        if cells.len() == self.width + 1 && cells.last().is_some_and(|c| c.is_empty()) {
            cells.pop();
        }
        if cells.len() != self.width {
            let what = if self.is_named() { "are named" } else { "are in the first row" };
            return Err(fault(format!("{} columns {what}, there are {} numbers", self.width, cells.len())));
        }
        for &k in columns {
            let cell = cells[k];
            if cell.is_empty() {
                return Err(fault(format!("column {} is empty", k + 1)));
            }
            let value = number(cell).ok_or_else(|| fault(self.no_number(cell)))?;
            if let Some(sign) = cell.chars().find(|c| *c == '.' || *c == ',') {
                if self.separator == Some(Separator::Comma) && sign == ',' {
                    return Err(fault(format!("'{cell}' has a comma in a table that commas separate: write a point")));
                }
                if *self.decimal.get().get_or_insert(sign) != sign {
                    return Err(fault(format!("'{cell}': numbers before have another decimal sign; write all alike")));
                }
                self.decimal.set(Some(sign));
            }
            out.push(value);
        }
        Ok(())
    }

    /// Whether all of some columns are empty in a row.
    pub fn is_blank(&self, row: &Row, columns: &[usize]) -> bool {
        let cells = cells(row.text, self.separator);
        columns.iter().all(|k| cells.get(*k).is_some_and(|c| c.is_empty()))
    }

    fn no_number(&self, cell: &str) -> String {
        let inner = cell.split(|c: char| c.is_whitespace()).all(|w| number(w).is_some());
        let separators = cell.chars().filter(|c| matches!(c, '.' | ',')).count();
        if self.separator == Some(Separator::Comma) && inner {
            return format!("'{cell}' is not a number; if commas are decimal signs, separate by semicolons");
        }
        if separators > 1 && cell.chars().all(|c| c.is_ascii_digit() || ".,+-".contains(c)) {
            return format!("'{cell}' is not a number: write it without separators of thousands");
        }
        format!("'{cell}' is not a number")
    }

    /// Names of the columns as written.
    fn names(&self) -> String {
        self.headings.iter().map(|h| h.text.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// Whether a line is a row or headings, not empty and no comment.
pub(super) fn is_row(line: &str) -> bool {
    !content(line).is_empty()
}

/// A line without its comment; tabs at its ends stay where tabs separate.
fn content(line: &str) -> &str {
    let line = line.split('#').next().unwrap_or("");
    let trimmed = line.trim();
    if trimmed.starts_with("//") {
        ""
    } else if trimmed.contains('\t') {
        line.trim_matches(|c: char| c.is_whitespace() && c != '\t')
    } else {
        trimmed
    }
}

/// Cells of a line, without blanks and quotes around them.
fn cells(line: &str, separator: Option<Separator>) -> Vec<&str> {
    let Some(separator) = separator else { return vec![bare(line)] };
    let mut quoted = false;
    let mut out: Vec<&str> = line
        .split(|c: char| {
            quoted ^= c == '"';
            !quoted && separator.splits(c)
        })
        .map(bare)
        .collect();
    if separator == Separator::Blank {
        out.retain(|c| !c.is_empty());
    }
    out
}

/// A cell without blanks and quotes around it.
fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).unwrap_or(cell).trim()
}

/// A number with a decimal point, or one decimal comma.
fn number(cell: &str) -> Option<f64> {
    match cell.split_once(',') {
        None => cell.parse().ok(),
        Some((_, rest)) if rest.contains([',', '.']) => None,
        Some((whole, _)) if whole.contains('.') => None,
        Some((whole, rest)) => format!("{whole}.{rest}").parse().ok(),
    }
}

/// Whether the commas of a line come in turns tight and followed by a blank, as in `1,5, 2,5, 3,0`, and no number has
/// a point.
fn doubtful(line: &str) -> bool {
    let loose: Vec<bool> = line.match_indices(',').map(|(at, _)| line[at + 1..].starts_with(' ')).collect();
    loose.len() >= 3
        && loose.len() % 2 == 1
        && !line.contains('.')
        && loose.iter().enumerate().all(|(k, l)| *l == (k % 2 == 1))
}

fn mixed(own: Option<Separator>, before: Option<Separator>) -> String {
    let name = |s: Option<Separator>| s.map_or("nothing", Separator::name);
    format!("numbers are separated by {}, in the rows before by {}; write all rows alike", name(own), name(before))
}

/// The heading in a cell: `X [mm]`, `"y (m)"`, `z_in`.
fn heading(cell: &str) -> Heading {
    let small = cell.to_ascii_lowercase();
    let marked = small.split_once(['[', '(']).and_then(|(name, rest)| {
        let unit = unit::millimetres(rest.trim_end_matches([']', ')']).trim())?;
        Some((name.trim().to_owned(), unit))
    });
    let joined = || {
        let (name, unit) = small.rsplit_once(['_', ' '])?;
        Some((name.trim().to_owned(), unit::millimetres(unit)?))
    };
    match marked.or_else(joined) {
        Some((name, unit)) => Heading { name, text: cell.to_owned(), unit: Some(unit) },
        None => Heading { name: small, text: cell.to_owned(), unit: None },
    }
}

/// The names that a comment above the first row gives to columns, if it names x, y and z and as many as there are.
fn named_by_remark(remark: &str, width: usize) -> Vec<Heading> {
    let found: Vec<Heading> = cells(remark, Separator::of(remark)).into_iter().map(heading).collect();
    let has = |name: &str| found.iter().any(|h| h.name == name);
    if found.len() == width && has("x") && has("y") && has("z") {
        found
    } else {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x, y and z of every row, or the reason why not.
    fn points(text: &str) -> Result<Vec<[f64; 3]>, String> {
        let told = |f: Fault| format!("line {}: {}", f.line, f.reason);
        let t = table(text).map_err(told)?;
        let columns = t.needed(&["x", "y", "z"]).map_err(told)?;
        let mut out = Vec::new();
        let mut values = Vec::new();
        for row in &t.rows {
            t.numbers(row, &columns, &mut values).map_err(told)?;
            out.push([values[0], values[1], values[2]]);
        }
        Ok(out)
    }

    #[test]
    fn columns_are_read_by_their_names() {
        for text in [
            "z,y,x\n3,2,1\n",
            "id,x,y,z\nP1,1,2,3\n",
            "\"X\";\"Y\";\"Z\";\"Name\"\n1;2;3;\"a;b\"\n",
            "x [mm]\ty [mm]\tz [mm]\n1\t2\t3\n",
            "# x y z i\n1 2 3 7\n",
            "// z, y, x\n3,2,1\n",
            "East,North,Height\n1,2,3\n",
            "1, 2, 3,\n",
            "id\tx\ty\tz\n\t1\t2\t3\n",
            "x,y,z,remark\n1,2,3,\n",
            " 1   2\u{a0}3 # here\r\n",
            "x,y,z\r1,2,3\r",
            "x;y;z\n1,0;2,0;3,0\n",
            "x,y,z,remark\n1,2,3,\"a, b\"\n",
        ] {
            assert_eq!(points(text), Ok(vec![[1.0, 2.0, 3.0]]), "{text}");
        }
    }

    #[test]
    fn decimal_commas_need_another_separator() {
        let halves = Ok(vec![[1.5, 2.5, 3.0], [-1e3, 0.25, 4.0]]);
        assert_eq!(points("1,5;2,5;3,0\n-1e3;0,25;4\n"), halves);
        assert_eq!(points("x\ty\tz\n\"1,5\"\t2,5\t3,0\n-1e3\t,25\t4\n"), halves);
        for (text, reason) in [
            ("1,5,2,5,3,0\n", "separate the numbers by semicolons"),
            ("1,5, 2,5, 3,0\n", "decimal signs"),
            ("1,5 2,5 3,0\n", "line 1"),
            ("\"1,5\",\"2,5\",\"3,0\"\n", "write a point"),
            ("1,5;2.5;3\n", "another decimal sign"),
            ("1;2;3\n1.234,5;2;3\n", "separators of thousands"),
            ("1;2;3\n1,234,567;2;3\n", "separators of thousands"),
        ] {
            let told = points(text).expect_err(text);
            assert!(told.contains(reason), "{text}: {told}");
        }
    }

    #[test]
    fn what_could_be_read_in_two_ways_is_refused() {
        for (text, reason) in [
            ("a,b,c,d\n1,2,3,4\n", "named a, b, c, d; 3 of them must be x, y, z"),
            ("a,b,c\n1,2,3\n", "named a, b, c; 3 of them must be x, y, z: rename them"),
            ("North,East,Height\n1,2,3\n", "named North, East, Height"),
            ("z,north,east\n1,2,3\n", "named z, north, east"),
            ("x,y,z,x\n1,2,3,4\n", "two columns are named x"),
            ("1,2,3,4\n", "4 columns, and no first line"),
            ("1,2\n", "there are 2"),
            ("1,,3\n", "column 2 is empty"),
            ("1,2,3\n1,2,3,4\n", "line 2: 3 columns are in the first row, there are 4"),
            ("x,y,z\n1,2,3,4\n", "3 columns are named, there are 4"),
            ("1,2,3\n1;2;3\n", "line 2: numbers are separated by semicolons, in the rows before by commas"),
            ("P1 1 2 3\n", "4 columns"),
            ("1,five,3\n", "'five' is not a number"),
            ("x,y,z\na,b,c\n1,2,3\n", "line 2: 'a' is not a number"),
        ] {
            let told = points(text).expect_err(text);
            assert!(told.contains(reason), "{text}: {told}");
        }
    }

    #[test]
    fn units_of_headings_and_binary_files_are_noticed() {
        let t = table("id;x [m];y (m);z_m\n1;2;3;4\n").expect("a table");
        let columns = t.needed(&["x", "y", "z"]).expect("columns");
        assert_eq!((columns.clone(), t.unit_or(&columns, None)), (vec![1, 2, 3], Ok(Some(1000.0))));
        assert!(t.unit_or(&columns, Some(1.0)).is_err());
        assert!(table("x_mm,y_in,z_mm\n1,2,3\n").expect("a table").unit(&[0, 1, 2]).is_err());
        let some = table("x [m],y,z\n1,2,3\n").expect("a table");
        assert!(some.unit(&[0, 1, 2]).expect_err("which?").reason.contains("only some of the columns x [m], y, z"));
        assert_eq!((some.unit(&[1, 2]), some.unit(&[0])), (Ok(None), Ok(Some(1000.0))));
        assert!(text(&[0xff, 0xfe, 0x31, 0]).expect_err("UTF-16").reason.contains("UTF-8"));
        assert!(text(b"1,2\0,3").is_err());
        assert_eq!(text(b"\xef\xbb\xbf1,2,3").expect("text"), "1,2,3");
    }
}
