//! One material: what its cells may hold, and what is wrong with them.

use crate::develop::shop::material::{LeastRadius, Material};
use crate::develop::unfold::allowance::KFactor;

/// Columns of a table.
pub(super) const COLUMNS: [&str; 6] = ["material", "density", "least_radius", "k", "note", "source"];
/// The lightest foam, kg/m³: smaller numbers are meant in another unit.
const LIGHTEST: f64 = 15.0;
/// Density of the heaviest metal, kg/m³.
const HEAVIEST: f64 = 23_000.0;

/// A table that cannot be used, or a material that is not in it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A line that says nothing that can be meant.
    #[error("{file}, line {line}{card}: {reason}")]
    Line {
        /// Name of the table.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The material, with words before it; empty where the line has none.
        card: String,
        /// What is wrong.
        reason: String,
    },
    /// No such material.
    #[error("there is no material '{name}'; {file} has {known}")]
    Missing {
        /// Name asked for.
        name: String,
        /// Name of the table.
        file: String,
        /// Names that there are.
        known: String,
    },
}

/// A material from the cells of its row.
pub(super) fn card<'a>(cell: &impl Fn(&str) -> &'a str) -> Result<Material, String> {
    let name = cell("material").to_owned();
    if name.is_empty() {
        return Err("the material has no name".into());
    }
    let density =
        positive(cell("density")).ok_or(format!("the density '{}' is no positive number", cell("density")))?;
    if !(LIGHTEST..=HEAVIEST).contains(&density) {
        return Err(format!("the density {density} is none of a solid in kg/m³ (steel has 7850)"));
    }
    let k = k_factor(cell("k"))?;
    if let Some(k) = &k {
        k.check().map_err(|e| e.to_string())?;
    }
    let least_radius = least_radius(cell("least_radius"))?;
    Ok(Material { name, density, least_radius, k, note: cell("note").to_owned(), source: cell("source").to_owned() })
}

fn positive(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite())
}

fn least_radius(text: &str) -> Result<Option<LeastRadius>, String> {
    let fault =
        || format!("the least radius '{text}' is neither a multiple of the thickness (1.5t) nor a length (4mm)");
    let number = |s: &str| s.trim().parse::<f64>().ok().filter(|x| *x >= 0.0 && x.is_finite()).ok_or_else(fault);
    match text {
        "" => Ok(None),
        t => match (t.strip_suffix('t'), t.strip_suffix("mm")) {
            (Some(n), _) => Ok(Some(LeastRadius::Thicknesses(number(n)?))),
            (_, Some(n)) => Ok(Some(LeastRadius::Length(number(n)?))),
            _ => Err(fault()),
        },
    }
}

fn k_factor(text: &str) -> Result<Option<KFactor>, String> {
    let fault =
        || format!("k '{text}' is no share of the thickness (0.44), not 'din', and no pairs R/t:k (1:0.38 3:0.44)");
    if text.is_empty() {
        return Ok(None);
    }
    if text.eq_ignore_ascii_case("din") {
        return Ok(Some(KFactor::Din));
    }
    if !text.contains(':') {
        return text.parse().map(KFactor::Ansi).map(Some).map_err(|_| fault());
    }
    let pair = |w: &str| {
        let (a, b) = w.split_once(':')?;
        Some([a.parse::<f64>().ok()?, b.parse::<f64>().ok()?])
    };
    let rows: Option<Vec<[f64; 2]>> = text.split_whitespace().map(pair).collect();
    rows.map(|rows| Some(KFactor::Table(rows))).ok_or_else(fault)
}

/// What is wrong in a line of a file, with the material, if one is meant.
pub(super) fn wrong((file, line): (&str, usize), card: &str, reason: String) -> MaterialError {
    let card = if card.is_empty() { String::new() } else { format!(", material '{card}'") };
    MaterialError::Line { file: file.into(), line, card, reason }
}
