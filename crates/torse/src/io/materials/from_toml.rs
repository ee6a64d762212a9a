//! Materials as TOML: a table for every one, under its name.

use super::card::{card, wrong, MaterialError, COLUMNS};
use crate::develop::shop::material::Material;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::{Spanned, Table, Value};

/// Reads all materials of a file, in the order of their names.
///
/// # Errors
/// The line, the material and what is wrong with it.
pub(super) fn read(file: &str, text: &str) -> Result<Vec<Material>, MaterialError> {
    let line = |span: Option<Range<usize>>| {
        let before = span.and_then(|s| text.get(..s.start)).unwrap_or("");
        before.matches('\n').count() + 1
    };
    let all: BTreeMap<String, Spanned<Table>> = toml::from_str(text).map_err(|e| {
        wrong((file, line(e.span())), "", format!("{}; every material is a table: [mild-steel]", e.message()))
    })?;
    let mut out: Vec<Material> = Vec::new();
    for (name, table) in &all {
        let at = (file, line(Some(table.span())));
        let table = table.get_ref();
        if let Some(unknown) = table.keys().find(|k| !COLUMNS[1..].contains(&k.as_str())) {
            let reason = format!("the key '{unknown}' is not known; there are {}", COLUMNS[1..].join(", "));
            return Err(wrong(at, name, reason));
        }
        let mut cells: BTreeMap<&str, String> = BTreeMap::from([("material", name.clone())]);
        for (key, value) in table {
            cells.insert(key, cell(key, value).map_err(|reason| wrong(at, name, reason))?);
        }
        let found = card(&|key| cells.get(key).map_or("", String::as_str)).map_err(|reason| wrong(at, name, reason))?;
        if out.iter().any(|m| m.is_called(&found.name)) {
            return Err(wrong(at, name, "it is there already".into()));
        }
        out.push(found);
    }
    Ok(out)
}

/// A value as a cell of a table has it: pairs of R/t and K as `1:0.38 3:0.44`.
fn cell(key: &str, value: &Value) -> Result<String, String> {
    let number = |v: &Value| v.as_float().or(v.as_integer().map(|i| i as f64));
    match value {
        Value::String(s) => Ok(s.clone()),
        Value::Float(_) | Value::Integer(_) => Ok(number(value).map_or_else(String::new, |x| x.to_string())),
        Value::Array(rows) if key == "k" => {
            let pair = |row: &Value| match row.as_array().map(Vec::as_slice) {
                Some([ratio, k]) => Some(format!("{}:{}", number(ratio)?, number(k)?)),
                _ => None,
            };
            let pairs: Option<Vec<String>> = rows.iter().map(pair).collect();
            pairs.map(|p| p.join(" ")).ok_or_else(|| "k is an array of other than pairs [R/t, K]".into())
        }
        _ => Err(format!("'{key}' is neither a number nor text")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{material, read};
    use crate::develop::shop::material::LeastRadius;
    use crate::develop::unfold::allowance::KFactor;

    #[test]
    fn materials_are_tables_under_their_names() {
        let own = "# ours\n[mild-steel]\ndensity = 7860\nleast_radius = \"1.5t\"\nk = [[1, 0.38], [3.0, 0.44]]\nsource = \"our press\"\n\n\
                   [cork]\ndensity = 640.5\nleast_radius = \"4mm\"\nk = \"din\"\n[\"soft board\"]\ndensity = 300\nk = 0.4\n";
        let steel = material("mild steel", Some(("own.TOML", own))).expect("steel");
        assert_eq!((steel.density, steel.least_radius), (7860.0, Some(LeastRadius::Thicknesses(1.5))));
        assert_eq!(
            (steel.k, steel.source.as_str()),
            (Some(KFactor::Table(vec![[1.0, 0.38], [3.0, 0.44]])), "our press")
        );
        let all = read("own.toml", own).expect("materials");
        assert_eq!(all.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["cork", "mild-steel", "soft board"]);
        assert_eq!((all[0].least_radius, all[0].k.clone()), (Some(LeastRadius::Length(4.0)), Some(KFactor::Din)));
        assert_eq!(all[2].k, Some(KFactor::Ansi(0.4)));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, words) in [
            ("[steel]\ndensity = \n", "own.toml, line 2"),
            ("density = 3\n", "every material is a table"),
            (
                "[a]\ndensity = 7850\n[b]\ndensity = 7850\nweight = 3\n",
                "line 3, material 'b': the key 'weight' is not known",
            ),
            ("[a]\ndensity = true\n", "neither a number nor text"),
            ("[a]\ndensity = 7.85\n", "kg/m³"),
            ("[a]\ndensity = 7850\nk = [0.3, 0.4]\n", "pairs"),
            ("[a]\nk = 0.4\n", "density"),
        ] {
            let said = read("own.toml", text).expect_err(text).to_string();
            assert!(said.contains(words), "{said}");
        }
    }
}
