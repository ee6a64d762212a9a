//! Calls of the library that several commands or several steps of one share, with what would help where they refuse. Opens
//! nothing and prints nothing.

use crate::args::Chosen;
use crate::failure::Failure;
use torse::answer::marks::Marks;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::certify::claim::Status;
use torse::develop::view::Drawn;
use torse::io::bundle;
use torse::io::cad::ReadError;
use torse::io::iges::read as iges;
use torse::io::step::read as step;
use torse::io::threedm;
use torse::pipeline::approximate::{self as pipeline, ApproximateError};
use torse::pipeline::cone_shapes;
use torse::pipeline::cones::{self as cone_pipeline, ConesOptions};
use torse::pipeline::select;
use torse::pipeline::sweep;
use torse::pipeline::unroll::UnrollError;
use torse::reason::JobReason;
use torse::{Approximate, Control, Model, UnrollOptions};

/// Reads a CAD file. `name` is for messages.
pub fn read(name: &str, bytes: &[u8]) -> Result<Model, Failure> {
    torse::read(bytes).map_err(|e| Failure::new(format!("{name}: {e}"), reading_hint(&e)))
}

/// The model with the chosen faces.
pub fn selected(model: Model, chosen: &Chosen) -> Result<Model, Failure> {
    select::selected(model, &chosen.selection())
        .map_err(|e| Failure::new(e.to_string(), "'torse info' lists the faces and parts of the file"))
}

/// What would help against a file that cannot be read.
fn reading_hint(error: &ReadError) -> &'static str {
    const CUT_OFF: &str = "compare its size with the original; if that is cut off too, export it again";
    const REPAIR: &str = "repair that face in the CAD program, or export the model again";
    match error {
        ReadError::Step(step::ReadError::Truncated(_)) | ReadError::Iges(iges::ReadError::Truncated(_)) => CUT_OFF,
        ReadError::Step(step::ReadError::NoUsableFaces { .. })
        | ReadError::Iges(iges::ReadError::NoUsableFaces { .. })
        | ReadError::ThreeDm(threedm::ReadError::NoUsableFaces { .. }) => REPAIR,
        ReadError::Step(step::ReadError::Unit { .. }) => {
            "write its unit as SI_UNIT(.MILLI.,.METRE.) or convert from it"
        }
        ReadError::Step(step::ReadError::NotStep(_)) => "give a STEP, IGES or Rhino file",
        ReadError::Step(step::ReadError::Empty) => "export it again, or copy it anew: it holds nothing",
        ReadError::Step(step::ReadError::NoFaces { .. }) => "export the surfaces as STEP (AP203, AP214 or AP242)",
        ReadError::Iges(iges::ReadError::OtherForm(_)) => {
            "save it in the fixed ASCII form, or export the surfaces as STEP"
        }
        ReadError::Iges(_) => "export trimmed surfaces (144) or solids (186), or STEP instead",
        ReadError::ThreeDm(_) => "save it again in Rhino, or as STEP",
    }
}

/// Lays a model flat.
pub fn unroll(model: &Model, options: &UnrollOptions, control: &Control) -> Result<Answer, Failure> {
    torse::unroll(model, options, control).map_err(|e| {
        let hint = match e {
            UnrollError::Tolerance(_) => "give a length with its unit, for example --tolerance 0.01mm",
            UnrollError::Loose(_) => "'torse info' tells unit and size of the model",
            UnrollError::KFactor(_) => "give a share such as --k 0.44, --k din, or a table of R/t and K",
            UnrollError::KWithoutThickness => "leave out --k or --surfaces",
            UnrollError::Edge(_) => "bend_table.csv of a run without --bends names the edges of sharp bends",
            UnrollError::CoversSurfacesOnly => "give --surfaces with --approximate",
            UnrollError::Approximate(_) => "leave out --approximate, or ask for another distance",
            UnrollError::Round(_) => "cover it with 'torse approximate', or cut it into pieces that are less round",
            UnrollError::Nothing { .. } if options.surfaces && options.approximate.is_none() => {
                "--approximate 1mm covers faces that are not developable by panels within that distance"
            }
            UnrollError::Nothing { .. } if options.surfaces => "give it longer with --time-limit, or leave that out",
            UnrollError::Nothing { .. } => {
                "--surfaces takes faces without thickness; with it, --approximate 1mm covers faces that are not developable"
            }
        };
        Failure::new(e.to_string(), hint)
    })
}

/// Runs the main job.
pub fn approximate(model: Model, options: &Approximate, control: &Control) -> Result<Answer, Failure> {
    pipeline::of_faces(model.faces, model.skipped, options, control).map_err(|e| Failure::new(e.to_string(), hint(&e)))
}

/// Runs the main job at several tolerances (mm): the files with the table and its picture.
pub fn sweep(
    model: &Model,
    tolerances: &[f64],
    options: &Approximate,
    control: &Control,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let rows = sweep::sweep(&model.faces, &model.skipped, tolerances, options, control)
        .map_err(|e| Failure::new(e.to_string(), hint(&e)))?;
    torse::io::sweep::files(&options.input, &rows, sweep::picture(&options.input, &rows).as_ref())
        .map_err(|e| Failure::fault(&e))
}

/// Runs the job of cone splines on faces.
pub fn cones(model: &Model, options: &ConesOptions, control: &Control) -> Result<Answer, Failure> {
    cone_pipeline::of_faces(&model.faces, &model.skipped, options, control).map_err(|e| {
        Failure::new(
            e.to_string(),
            "see 'torse info' on the file; 'torse approximate' covers other surfaces with panels",
        )
    })
}

/// Runs the job of cone splines on the panels of the main job: what the panels leave of the whole tolerance (mm) is
/// theirs, so that cones keep the whole tolerance to the surface.
pub fn cones_of_panels(answer: &Answer, whole: f64, drawn: Drawn, control: &Control) -> Result<Answer, Failure> {
    let used = answer.certificate().map_or(f64::INFINITY, |c| c.deviation_bound);
    let tolerance = if used < whole { whole - used } else { whole - answer.tolerance() };
    let options = ConesOptions { drawn, ..ConesOptions::new(tolerance, answer.input.clone()) };
    let mut cones = cone_pipeline::of_panels(answer.patchwork(), &answer.skipped, &options, control)
        .map_err(|e| Failure::new(e.to_string(), "leave out --cones to keep the panels"))?;
    // Cones near panels are no nearer to the surface than these.
    if answer.status() == Status::Uncertified {
        let why = answer.claims().iter().filter(|c| c.is_broken()).filter_map(|c| c.reason().cloned());
        cones.object(JobReason::Panels(why.collect()));
    }
    Ok(cones)
}

/// The bending of cone splines into the plane: an animation and a strip of pictures.
pub fn bending_files(answer: &Answer) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    const STAGES: usize = 16;
    let Some(cones) = answer.cones() else { return Ok(Vec::new()) };
    let shown = present(answer);
    let stages = cone_shapes::bending(cones, &shown, STAGES);
    let eye = cone_shapes::bending_direction(cones, &shown);
    bundle::bending(&stages, &eye).map_err(|e| Failure::fault(&e))
}

/// Inner, neutral and outer surfaces of sheets with a thickness (mm).
pub fn thickness_files(answer: &Answer, thickness: f64) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let Some(cones) = answer.cones() else { return Ok(Vec::new()) };
    let surfaces = cone_shapes::thick(&cones.bodies, thickness)
        .map_err(|e| Failure::new(e.to_string(), "give a smaller --thickness, or leave it out"))?;
    let scene = cone_shapes::scene(&surfaces, Marks::of(answer).any());
    bundle::thickness(&answer.input, &surfaces, &scene, &crate::clock::stamp()).map_err(|e| Failure::fault(&e))
}

/// What would help against a refusal of the main job.
fn hint(error: &ApproximateError) -> &'static str {
    match error {
        ApproximateError::NoFaces(_) => {
            "see 'torse info' on the file; export surfaces or solids, not only curves or meshes"
        }
        ApproximateError::Loose(_) => "'torse info' tells unit and size of the model",
        ApproximateError::Tolerance(_) => "give a length with its unit, for example --tolerance 2mm",
        ApproximateError::Precision { .. } => {
            "give a larger tolerance; if the size of the model looks wrong, check its unit with 'torse info'"
        }
        ApproximateError::Limit { .. } => "give a positive length, or leave the limit out",
        ApproximateError::SmoothAngle(_) => "give degrees, for example --smooth-angle 0.5; 0 keeps faces apart",
        ApproximateError::SeamPlane { .. } => "give a plane through the model; 'torse info' tells its size",
        ApproximateError::Curve(_) => {
            "give a curve on the surface, or a plane through it; 'torse info' tells the size of the model"
        }
        ApproximateError::Guide => "give a direction such as x or 1,0,0.5, or a curve of at least two different points",
        ApproximateError::TooMany { .. } => "'torse info' tells the radii of curvature and sizes of the faces",
        ApproximateError::WiderThanLong { .. } => "give a smaller --min-width, or a larger --max-length or --sheet",
        ApproximateError::TooNarrow { .. } => "give a smaller --min-width; 'torse info' tells the sizes of the faces",
        ApproximateError::Widths { .. } => "give a smaller --min-width, or a larger --max-width or --sheet",
        ApproximateError::MaxPanels => "give --max-panels 1 or more, or leave it out",
    }
}
