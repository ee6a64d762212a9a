//! Files of a sweep over tolerances: `sweep.json` and `sweep.png`.

use super::png::{self, PngError};
use crate::answer::sweep::SweepRow;
use crate::draw::raster::Image;
use serde::Serialize;

/// Why the files could not be made.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Picture.
    #[error(transparent)]
    Png(#[from] PngError),
    /// Table.
    #[error("cannot write sweep.json: {0}")]
    Json(#[from] serde_json::Error),
}

/// The table as written; lengths in mm.
#[derive(Serialize)]
struct Table<'a> {
    schema: &'static str,
    name: &'a str,
    unit: &'static str,
    rows: Vec<SweepRecord>,
}

#[derive(Serialize)]
struct SweepRecord {
    tolerance: f64,
    panels: usize,
    seam_length: f64,
    theory_estimate: Option<f64>,
    status: &'static str,
    seconds: f64,
}

/// Makes the files of a sweep; without a picture the table alone.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn files(name: &str, rows: &[SweepRow], picture: Option<&Image>) -> Result<Vec<(String, Vec<u8>)>, SweepError> {
    let rows = rows.iter().map(|r| SweepRecord {
        tolerance: r.tolerance,
        panels: r.panels,
        seam_length: r.seam_length,
        theory_estimate: r.theory_estimate,
        status: if r.certified { "certified" } else { "uncertified" },
        seconds: r.seconds,
    });
    let table = Table { schema: "torse.sweep/2", name, unit: "mm", rows: rows.collect() };
    let mut out = vec![("sweep.json".to_owned(), serde_json::to_vec_pretty(&table)?)];
    if let Some(image) = picture {
        out.push(("sweep.png".to_owned(), png::write(image)?));
    }
    Ok(out)
}
