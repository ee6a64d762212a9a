//! `torse fit`: developable strips from measured points, rulings, tangent planes, and faces of too high a degree.

use crate::args::Fit;
use crate::failure::Failure;
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use torse::answer::note::Note;
use torse::answer::Answer;
use torse::control::Control;
use torse::io::cad::{self, Format};
use torse::io::elements;
use torse::io::threedm;
use torse::pipeline::elements::{fit_elements, fit_faces, ElementFitOptions};
use torse::pipeline::fit::{fit, FitOptions};
use torse::torse::zone::RegressionLimits;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Fit) -> Result<bool, Failure> {
    let file = &arguments.file;
    let bytes = contents(file)?;
    let job = Job::begin(&arguments.files, file, arguments.time_limit)?;

    job.say("reading");
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    // Rhino files with meshes are scans.
    let faces = match cad::recognised(&bytes) {
        Some(Format::ThreeDm) => threedm::meshes::read(&bytes).is_err(),
        format => format.is_some(),
    };
    let of_elements = faces || elements::holds_elements(&name, &bytes);
    let mut answer = match of_elements {
        true => row(&name, &bytes, arguments, job.control())?,
        false => points(&name, &bytes, arguments, job.control())?,
    };
    drop(bytes);
    if arguments.strict && of_elements {
        refuse_left_out(file, &answer.skipped)?;
    }
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}

/// Fits points.
fn points(name: &str, bytes: &[u8], arguments: &Fit, control: &Control) -> Result<Answer, Failure> {
    let file = &arguments.file;
    for (given, name) in
        [(arguments.fix_ends, "--fix-ends"), (arguments.smooth.is_some(), "--smooth"), (arguments.robust, "--robust")]
    {
        if given {
            let help = "leave it away: fits of points keep off outliers and noise by themselves";
            return Err(Failure::new(format!("{name} is for rulings, planes and faces, not for points"), help));
        }
    }
    let (cloud, guess) = torse::io::cloud::read_noted(name, bytes, arguments.unit).map_err(|e| {
        Failure::new(format!("{}: {e}", file.display()), "export the scan as PLY, CSV, OBJ, STL or 3DM")
    })?;
    let mut options = FitOptions::new(arguments.tolerance.mm, &arguments.files.job_name(file));
    options.drawn = arguments.drawing.drawn(&arguments.files.shop);
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    let mut answer = fit(&cloud, &options, control).map_err(|e| {
        Failure::new(e.to_string(), "give a scan of a sheet with its unit (--unit) and a tolerance above its noise")
    })?;
    answer.notes.extend(guess.map(Note::Input));
    Ok(answer)
}

/// Fits rulings, planes or faces.
fn row(name: &str, bytes: &[u8], arguments: &Fit, control: &Control) -> Result<Answer, Failure> {
    let mut options = ElementFitOptions::new(arguments.tolerance.mm, &arguments.files.job_name(&arguments.file));
    options.drawn = arguments.drawing.drawn(&arguments.files.shop);
    if let Some(n) = arguments.max_strips {
        options.max_strips = n as usize;
    }
    options.limits = limits(arguments);
    (options.fix_ends, options.smoothing, options.robust) = (arguments.fix_ends, arguments.smooth, arguments.robust);
    let shown = arguments.file.display();
    if elements::holds_elements(name, bytes) {
        let (given, notes) = elements::read(name, bytes, arguments.unit, arguments.region)
            .map_err(|e| Failure::new(format!("{shown}: {e}"), "see 'torse fit --help' for the columns of a table"))?;
        let mut answer = fit_elements(&given, &options, control).map_err(|e| {
            Failure::new(e.to_string(), "give rulings or planes of one developable, in order, and their unit (--unit)")
        })?;
        answer.notes.extend(notes.into_iter().map(Note::Input));
        return Ok(answer);
    }
    let model = crate::wiring::read(&shown.to_string(), bytes)?;
    fit_faces(&model.faces, &model.skipped, &options, control)
        .map_err(|e| Failure::new(e.to_string(), "'torse approximate' covers surfaces that are not developable"))
}

/// What is asked of regression curves; nothing unless an option says so.
fn limits(arguments: &Fit) -> Option<RegressionLimits> {
    let asked = arguments.min_clearance.is_some() || !arguments.clear_zone.is_empty();
    let clearance = arguments.min_clearance.as_ref().map_or(0.0, |l| l.mm);
    asked.then(|| RegressionLimits { clearance, zones: arguments.clear_zone.clone() })
}
