//! The files of a job that makes cone splines: those of strips, with exact cones, cylinders and planes in CAD.

use super::bundle::{BundleError, File};
use super::step::write::{self as step, Header, Sheet};
use crate::pipeline::presentation::Presentation;
use crate::pipeline::sheets::Sheets;
use crate::surface::cone_spline::ConeSpline;

/// Name of the CAD file that the exact faces replace.
const STRIPS: &str = "strips.step";
/// Uncertainty written into the STEP header, mm.
const UNCERTAINTY: f64 = 1e-6;

/// Makes every file: cones.step, patterns.dxf, patterns.svg, model.glb, pictures, report.html, report.json.
///
/// # Errors
/// Data that a format cannot hold.
pub fn files(
    sheets: &Sheets,
    bodies: &[(String, ConeSpline)],
    shown: &Presentation,
    time: &str,
) -> Result<Vec<File>, BundleError> {
    let mut out = super::sheets::files(sheets, shown, time)?;
    let cad = exact(&sheets.input, bodies, time)?;
    match out.iter_mut().find(|f| f.0 == STRIPS) {
        Some(file) => *file = cad,
        None => out.push(cad),
    }
    Ok(out)
}

/// cones.step alone.
///
/// # Errors
/// Those of the writer.
pub fn exact(name: &str, bodies: &[(String, ConeSpline)], time: &str) -> Result<File, BundleError> {
    let header = Header { name: name.to_owned(), time: time.to_owned(), uncertainty: UNCERTAINTY };
    let bodies: Vec<Sheet> = bodies.iter().map(|(name, spline)| Sheet::of_cones(name, spline)).collect();
    let mut bytes = Vec::new();
    step::sheets(&mut bytes, &header, &bodies).map_err(|source| BundleError::Write { file: "cones.step", source })?;
    Ok(("cones.step".into(), bytes))
}
