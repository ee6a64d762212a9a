//! The files of a job that makes cone splines: those of strips, with exact cones, cylinders and planes in CAD.

use super::bundle::{BundleError, File};
use super::step::write::{self as step, Header, Sheet};
use super::{glb, png};
use crate::answer::presentation::Presentation;
use crate::answer::sheets::Sheets;
use crate::draw::scene::{titled, Scene};
use crate::draw::sequence::sequence;
use crate::geom::Vec3;
use crate::torse::cone::part::ConeBody;

/// Uncertainty written into the STEP header, mm.
const UNCERTAINTY: f64 = 1e-6;

/// The files that hold geometry: cones.step, patterns.dxf, patterns.svg.
///
/// # Errors
/// Data that a format cannot hold.
pub fn geometry(
    sheets: &Sheets,
    bodies: &[ConeBody],
    shown: &Presentation,
    time: &str,
) -> Result<Vec<File>, BundleError> {
    let mut out = super::sheets::geometry(sheets, shown, time)?;
    let cad = exact(&sheets.input, bodies, shown.marks.any(), time)?;
    match out.iter_mut().find(|f| f.0 == super::sheets::STRIPS) {
        Some(file) => *file = cad,
        None => out.push(cad),
    }
    Ok(out)
}

/// bending.glb, an animation, and bending.png, a strip of pictures, from stages with their captions; `eye` points
/// from the model to the eye.
///
/// # Errors
/// Data that a format cannot hold.
pub fn bending(stages: &[(String, Scene)], eye: &Vec3) -> Result<Vec<File>, BundleError> {
    /// Pictures in the strip.
    const PICTURES: usize = 6;
    let scenes: Vec<Scene> = stages.iter().map(|s| s.1.clone()).collect();
    let last = stages.len().saturating_sub(1);
    let chosen: Vec<(String, Scene)> =
        (0..PICTURES).filter_map(|k| stages.get(last * k / (PICTURES - 1)).cloned()).collect();
    Ok(vec![
        ("bending.glb".into(), glb::moving::write(&scenes)?),
        ("bending.png".into(), png::write(&sequence(&chosen, eye))?),
    ])
}

/// thickness.step and thickness.glb: the surfaces of sheets with thickness.
///
/// # Errors
/// Data that a format cannot hold.
pub fn thickness(name: &str, surfaces: &[ConeBody], scene: &Scene, time: &str) -> Result<Vec<File>, BundleError> {
    let marked = scene.panels.iter().any(|p| p.marked);
    let (_, step) = exact(name, surfaces, marked, time)?;
    Ok(vec![("thickness.step".into(), step), ("thickness.glb".into(), glb::write(scene, 1.0)?)])
}

/// cones.step alone; `marked` if it must not be cut.
///
/// # Errors
/// Those of the writer.
pub fn exact(name: &str, bodies: &[ConeBody], marked: bool, time: &str) -> Result<File, BundleError> {
    let header = Header { name: titled(name, marked), time: time.to_owned(), uncertainty: UNCERTAINTY };
    let bodies: Vec<Sheet> = bodies
        .iter()
        .map(|b| match &b.part {
            Some(part) => Sheet::of_cone_part(&b.name, part),
            None => Sheet::of_cones(&b.name, &b.spline),
        })
        .map(|s| if marked { s.marked() } else { s })
        .collect();
    let mut bytes = Vec::new();
    step::sheets(&mut bytes, &header, &bodies).map_err(|source| BundleError::Write { file: "cones.step", source })?;
    Ok(("cones.step".into(), bytes))
}
