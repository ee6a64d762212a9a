//! Tables of materials (CSV or TOML): those that come with the program, and people's own; tables of K-factors.
//!
//! The first line names the columns, in any order: `material` and `density` (kg/m³), and if known `least_radius` (`1.5t` or
//! `4mm`), `k` (a number, `din`, or pairs `R/t:k`), `note` and `source`. `#` begins a comment line. In TOML every material is a table
//! under its name with the same keys; `k` may be an array of pairs there.

mod card;
mod from_toml;

pub use card::MaterialError;

use crate::develop::shop::material::Material;
use card::{card, wrong, COLUMNS};

/// The table that comes with the program.
const SHIPPED: &str = include_str!("materials.csv");
/// Name of that table in messages.
const SHIPPED_NAME: &str = "the table of the program";

/// The materials that come with the program.
///
/// # Errors
/// None: tests read the table.
pub(crate) fn shipped() -> Result<Vec<Material>, MaterialError> {
    read(SHIPPED_NAME, SHIPPED)
}

/// The material of a name: in a table of one's own (its name and its text) if there is one, else in that of the program.
///
/// # Errors
/// A table that cannot be read, with its line; a name that is not there, with those that are.
///
/// # Example
/// ```
/// let own = "material,density,least_radius\nroof zinc,7200,1.75t\n";
/// let zinc = torse::io::materials::material("Roof-Zinc", Some(("own.csv", own)))?;
/// assert!((zinc.weight(1e6, 0.7) - 5.04).abs() < 1e-12, "a square metre of 0.7 mm");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn material(name: &str, own: Option<(&str, &str)>) -> Result<Material, MaterialError> {
    let own = own.map(|(file, text)| read(file, text).map(|all| (file, all))).transpose()?;
    let (file, all) = match own {
        Some((file, all)) if all.iter().any(|m| m.is_called(name)) => (file, all),
        Some((file, mut all)) => {
            all.extend(shipped()?);
            (file, all)
        }
        None => (SHIPPED_NAME, shipped()?),
    };
    let known = all.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", ");
    let missing = MaterialError::Missing { name: name.into(), file: file.into(), known };
    all.into_iter().find(|m| m.is_called(name)).ok_or(missing)
}

/// Reads a table, as TOML if its file is called so; `file` names it in messages.
///
/// # Errors
/// The line, the material and what is wrong with it.
pub fn read(file: &str, text: &str) -> Result<Vec<Material>, MaterialError> {
    if file.to_ascii_lowercase().ends_with(".toml") {
        return from_toml::read(file, text.trim_start_matches('\u{feff}'));
    }
    table(file, text)
}

/// Reads a table of cells.
fn table(file: &str, text: &str) -> Result<Vec<Material>, MaterialError> {
    let mut columns: Option<Vec<String>> = None;
    let mut out: Vec<Material> = Vec::new();
    for (k, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let cells = cells(line);
        let fault = |card: &str, reason: String| wrong((file, k + 1), card, reason);
        let Some(names) = &columns else {
            let names: Vec<String> = cells.iter().map(|c| heading(c)).collect();
            if let Some(missing) = ["material", "density"].iter().find(|n| !names.iter().any(|c| c == *n)) {
                return Err(fault("", format!("there is no column '{missing}'; the first line names the columns")));
            }
            if let Some(unknown) = names.iter().find(|n| !COLUMNS.contains(&n.as_str())) {
                return Err(fault(
                    "",
                    format!("the column '{unknown}' is not known; there are {}", COLUMNS.join(", ")),
                ));
            }
            if let Some(twice) = names.iter().find(|n| names.iter().filter(|m| m == n).count() > 1) {
                return Err(fault("", format!("the column '{twice}' is there twice")));
            }
            columns = Some(names);
            continue;
        };
        let cell = |name: &str| {
            let at = names.iter().position(|n| n == name);
            at.and_then(|i| cells.get(i)).map_or("", |c| c.trim())
        };
        if let Some(beyond) = cells.iter().skip(names.len()).find(|c| !c.trim().is_empty()) {
            return Err(fault(cell("material"), format!("'{}' is in no column", beyond.trim())));
        }
        let found = card(&cell).map_err(|reason| fault(cell("material"), reason))?;
        if out.iter().any(|m| m.is_called(&found.name)) {
            return Err(fault(&found.name, "it is there already".into()));
        }
        out.push(found);
    }
    Ok(out)
}

/// Names of the columns of a table of K-factors: inside radius over thickness, and K (ANSI).
const K_COLUMNS: [&[&str]; 2] = [&["r/t", "r_over_t", "ratio", "radius/thickness"], &["k", "k_ansi", "k_factor"]];

/// Reads a table of K-factors (CSV, no unit): inside radius over thickness and K, its columns in either order if headings name them.
/// Its order and range are judged by the job that is given it. `file` names it in messages.
///
/// # Errors
/// The line with other than two numbers, or whose columns are not known.
pub fn k_table(file: &str, text: &str) -> Result<Vec<[f64; 2]>, MaterialError> {
    let fault =
        |k: usize, reason: String| MaterialError::Line { file: file.into(), line: k + 1, card: String::new(), reason };
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let rows = lines.filter(|(_, l)| !l.trim().is_empty() && !l.trim_start().starts_with('#'));
    let (mut out, mut ratio) = (Vec::new(), None);
    for (k, line) in rows {
        let cells = cells(line);
        let numbers: Option<Vec<f64>> = cells.iter().map(|w| w.trim().parse().ok()).collect();
        match (numbers.as_deref(), ratio) {
            (Some(&[a, b]), _) => {
                let first = *ratio.get_or_insert(0);
                out.push(if first == 0 { [a, b] } else { [b, a] });
            }
            (_, None) => {
                let names: Vec<String> = cells.iter().map(|c| heading(c)).collect();
                let is = |at: usize, of: usize| K_COLUMNS[of].contains(&names[at].as_str());
                let found = (0..2).find(|r| names.len() == 2 && is(*r, 0) && is(1 - r, 1));
                let unknown = || {
                    format!(
                        "the columns '{}' are not R/t (inside radius over thickness) and K (half of what DIN calls k)",
                        line.trim()
                    )
                };
                ratio = Some(found.ok_or_else(|| fault(k, unknown()))?);
            }
            _ => return Err(fault(k, format!("'{}' is not two numbers, R/t and K", line.trim()))),
        }
    }
    Ok(out)
}

/// A heading: its unit in parentheses left off, blanks and dashes as underscores.
fn heading(cell: &str) -> String {
    let word = cell.split('(').next().unwrap_or(cell);
    word.trim().to_ascii_lowercase().replace([' ', '-'], "_")
}

/// Cells of a row, separated by commas or semicolons; in double quotes these are text.
fn cells(line: &str) -> Vec<String> {
    let separator = if outside_quotes(line, ';') { ';' } else { ',' };
    let (mut out, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match out.last_mut() {
            _ if c == '"' => quoted = !quoted,
            _ if c == separator && !quoted => out.push(String::new()),
            Some(cell) => cell.push(c),
            None => {}
        }
    }
    out
}

fn outside_quotes(line: &str, wanted: char) -> bool {
    let mut quoted = false;
    line.chars().any(|c| {
        quoted ^= c == '"';
        !quoted && c == wanted
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::shop::material::LeastRadius;
    use crate::develop::unfold::allowance::KFactor;

    #[test]
    fn the_table_of_the_program_is_sound() {
        let all = shipped().expect("a table");
        assert!(all.len() >= 12);
        for m in &all {
            assert!((500.0..9000.0).contains(&m.density) && !m.note.is_empty(), "{m:?}");
            assert!(!m.source.is_empty(), "{} names no source", m.name);
            let k = m.k.as_ref().expect("a K-factor");
            // Gentle bends have their neutral fibre in the middle.
            assert!((k.share(1000.0) - 0.5).abs() < 1e-12 && k.share(0.5) <= 0.5, "{m:?}");
            assert!(m.least_radius.is_some_and(|r| r.of(1.0) > 0.0));
        }
        let steel = material("Mild Steel", None).expect("steel");
        assert_eq!((steel.density, steel.least_radius), (7850.0, Some(LeastRadius::Thicknesses(1.0))));
        // As EN 10088-1 has them.
        for (name, density) in [("stainless-304", 7900.0), ("stainless-316", 8000.0)] {
            let steel = material(name, None).expect("stainless steel");
            assert!(steel.density == density && steel.source.contains("EN 10088-1"), "{steel:?}");
        }
    }

    #[test]
    fn own_tables_go_first_and_the_others_stay() {
        let own = "note;Density;material;k\n\"a; b\";7777;mild steel;din\n;640;cork;\n";
        let steel = material("mild-steel", Some(("own.csv", own))).expect("steel");
        assert_eq!((steel.density, steel.k, steel.note.as_str()), (7777.0, Some(KFactor::Din), "a; b"));
        let cork = material("cork", Some(("own.csv", own))).expect("cork");
        assert_eq!((cork.least_radius, cork.k), (None, None));
        assert_eq!(material("copper", Some(("own.csv", own))).expect("copper").density, 8940.0);
    }

    #[test]
    fn headings_say_in_which_order_a_table_of_k_factors_is() {
        let read = |text: &str| k_table("k.csv", text);
        let rows = vec![[0.5, 0.3], [0.9, 0.4]];
        for text in ["0.5,0.3\n0.9,0.4\n", "# ours\nR/t;K\n0.5;0.3\n0.9;0.4\n", "k,r_over_t\n0.3,0.5\n0.4,0.9\n"] {
            assert_eq!(read(text), Ok(rows.clone()), "{text}");
        }
        for (text, words) in [
            ("r_mm,k\n3,0.3\n", "line 1: the columns 'r_mm,k'"),
            ("R/t,K DIN\n1,0.7\n", "the columns"),
            ("R/t,K\n1,a\n", "line 2: '1,a' is not two numbers"),
            ("0.5,0.3\nR/t,K\n", "line 2"),
        ] {
            let fault = read(text).expect_err(text).to_string();
            assert!(fault.contains(words), "{fault}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_file_line_and_material() {
        let refused = |text: &str| read("own.csv", text).expect_err(text).to_string();
        assert_eq!(
            refused("material,density\n\nsteel,heavy\n"),
            "own.csv, line 3, material 'steel': the density 'heavy' is no positive number"
        );
        assert!(refused("name,density\nsteel,1\n").contains("line 1: there is no column 'material'"));
        for (row, words) in [
            ("steel,7850,2x,", "2x"),
            ("steel,7850,,1:a", "1:a"),
            ("steel,7850,,1.7", "1.7"),
            ("steel,7850,,3:0.4 1:0.3", "row 2"),
            (",7850,,", "no name"),
            ("steel,nan,,", "nan"),
            ("a,7850,,\nA,7850,,", "already"),
            ("steel,7.85,,", "kg/m³"),
            ("steel,7850,,,3", "in no column"),
        ] {
            let found = refused(&format!("material,density,least_radius,k\n{row}\n"));
            assert!(found.contains(words), "{found}");
        }
        assert!(refused("material,density,min_radius\nsteel,7850,9t\n").contains("column 'min_radius' is not known"));
        assert!(refused("material,density,density\nsteel,7850,1\n").contains("'density' is there twice"));
        assert!(read("own.csv", "Material,density (kg/m³),least radius\nsteel,7850,9t\n").is_ok());
        let missing = material("unobtainium", None).expect_err("no such material").to_string();
        assert!(missing.contains("unobtainium") && missing.contains("birch-plywood"), "{missing}");
    }
}
