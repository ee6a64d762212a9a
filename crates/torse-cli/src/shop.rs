//! Arguments about sheet and work in the library's words, with the tables that they name.

use crate::args::{Shop, K};
use crate::failure::Failure;
use crate::input::contents;
use torse::develop::unfold::allowance::KFactor;
use torse::io::materials;
use torse::pipeline::workshop::WorkshopOptions;

/// Sheet and work, with the tables that they name.
pub fn workshop(shop: &Shop) -> Result<WorkshopOptions, Failure> {
    let k = match &shop.k {
        None => None,
        Some(K::Share(k)) => Some(KFactor::Ansi(*k)),
        Some(K::Din) => Some(KFactor::Din),
        Some(K::Table(file)) => {
            let bytes = contents(file).map_err(|e| Failure { message: format!("--k: {}", e.message), ..of_k() })?;
            let name = file.display().to_string();
            let table = materials::k_table(&name, &String::from_utf8_lossy(&bytes));
            Some(KFactor::Table(table.map_err(|e| Failure { message: e.to_string(), ..of_k() })?))
        }
    };
    let read = |f| contents(f).map_err(|e| Failure { message: format!("--materials: {}", e.message), ..e });
    let own = shop.materials.as_ref().map(|f| read(f).map(|b| (f.display().to_string(), b))).transpose()?;
    let own = own.map(|(name, bytes)| (name, String::from_utf8_lossy(&bytes).into_owned()));
    let own = own.as_ref().map(|(name, text)| (name.as_str(), text.as_str()));
    let material = shop.material.as_ref().map(|name| materials::material(name, own)).transpose();
    let help = |e: &materials::MaterialError| {
        match e {
        materials::MaterialError::Missing { .. } => "give one of these names, or a table of your own with --materials",
        materials::MaterialError::Line { .. } => {
            "the columns, or keys, are material, density (kg/m³), and if known least_radius (1.5t or 4mm), k, note and source"
        }
    }
    };
    Ok(WorkshopOptions {
        material: material.map_err(|e| Failure::new(e.to_string(), help(&e)))?,
        thickness: shop.thickness.as_ref().map(|t| t.mm),
        side: shop.side.of_sheet(),
        k,
        kinked: shop.facets.is_some(),
        offsets: shop.offsets,
        stations: shop.mark_sections.clone(),
        ..WorkshopOptions::default()
    })
}

/// Refuses `--k` without a sheet in which it could lie.
pub fn fibre_in_sheet(shop: &Shop) -> Result<(), Failure> {
    if shop.k.is_none() || shop.thickness.is_some() {
        return Ok(());
    }
    Err(Failure::new("--k says where in the sheet the neutral fibre lies, but no thickness is given", OF_SHEET))
}

/// What helps where a neutral fibre has no sheet to lie in.
pub const OF_SHEET: &str = "add --thickness, or leave --k out for the flat pattern of the surface itself";

/// What helps where `--k` is no number and no file.
fn of_k() -> Failure {
    Failure::new("", "give a share such as --k 0.44, --k din, or a table of R/t and K")
}
