//! `torse ruled`: strips of straight lines for formwork, hot wire and straight beams.

use crate::args::{Files, Ruled};
use crate::failure::Failure;
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use crate::wiring;
use torse::io::{png, rulings};
use torse::pipeline::ruled::{curvature_picture, of_faces, RuledError, RuledOptions, Strips};

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Ruled) -> Result<bool, Failure> {
    let file = &arguments.file;
    if let Some(option) = of_sheet(&arguments.files) {
        return Err(Failure::new(
            format!("{option} is about flat parts, and ruled strips cannot be laid flat"),
            "leave it out; 'torse approximate' makes panels of sheet",
        ));
    }
    let bytes = contents(file)?;
    let job = Job::begin(&arguments.files, file, arguments.time_limit)?;

    job.say("reading");
    let model = wiring::selected(wiring::read(&file.display().to_string(), &bytes)?, &arguments.chosen)?;
    drop(bytes);
    let options = RuledOptions {
        strips: Strips {
            tolerance: arguments.tolerance.mm,
            width: arguments.width.as_ref().map(|l| l.mm),
            conoidal: arguments.conoidal,
        },
        input: arguments.files.job_name(file),
        spacing: arguments.spacing.as_ref().map(|l| l.mm),
    };
    let mut found = of_faces(model.faces, model.skipped, &options, job.control()).map_err(|e| {
        let hint = match e {
            RuledError::Loose(_) => "'torse info' tells unit and size of the model",
            RuledError::Length { .. } => "give a length with its unit, for example --tolerance 10mm",
            RuledError::Nothing(_) => {
                "'torse info' tells size and curvature of the faces; 'torse approximate' covers any of them"
            }
        };
        Failure::new(e.to_string(), hint)
    })?;
    found.answer.notes.splice(0..0, model.notes);
    if arguments.strict {
        refuse_left_out(file, &found.answer.skipped)?;
    }
    job.deliver(&mut found.answer)?;
    let unit = arguments.files.cut().unit;
    let picture = png::write(&curvature_picture(&found)).map_err(|e| Failure::fault(&e))?;
    job.write(vec![
        ("rulings.csv".into(), rulings::csv(&found.rulings, unit)),
        ("rulings.dxf".into(), rulings::dxf(&found.rulings, unit)),
        ("curvature.png".into(), picture),
    ])?;
    job.finish(&found.answer, &arguments.tolerance.text)
}

/// An option that was given, and that only parts of sheet have.
fn of_sheet(files: &Files) -> Option<&'static str> {
    let shop = &files.shop;
    let given = [
        ("--material", shop.material.is_some()),
        ("--thickness", shop.thickness.is_some()),
        ("--k", shop.k.is_some()),
        ("--facets", shop.facets.is_some()),
        ("--mark-sections", !shop.mark_sections.is_empty()),
        ("--one-file-per-part", files.one_file_per_part),
    ];
    given.into_iter().find(|g| g.1).map(|g| g.0)
}
