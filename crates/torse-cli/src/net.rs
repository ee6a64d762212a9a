//! `torse net`: the developable through one curve.

use crate::args::Net;
use crate::failure::Failure;
use crate::input::contents;
use crate::job::Job;
use crate::loft::{rail, split};
use torse::answer::note::{Note, ReaderNote};
use torse::geom::Vec3;
use torse::io::net::{self as file, NetFile};
use torse::pipeline::net::{net, Condition, Options};

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Net) -> Result<bool, Failure> {
    let (path, _) = split(&arguments.curve);
    let (given, notes) = given(arguments)?;
    let curve = &given.curve;
    let job = Job::begin(&arguments.files, &path, None)?;
    let options = Options {
        input: arguments.files.job_name(&path),
        along: arguments.along,
        alternative: arguments.alternative as usize,
        polynomial: arguments.polynomial,
        ruling_spacing: arguments.rulings.as_ref().map(|l| l.mm),
        mark_spacing: arguments.marks.as_ref().map(|l| l.mm),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
        ..Options::new(arguments.tolerance.mm, first_ruling(arguments, &given)?, condition(arguments, &given)?)
    };
    let mut answer = net(curve, &options, job.control())
        .map_err(|e| Failure::new(e.to_string(), "see 'torse net --help' for what a net is made from"))?;
    answer.notes.extend(notes.into_iter().map(Note::Input));
    job.deliver(&mut answer)?;
    job.finish(&answer, &arguments.tolerance.text)
}

/// The curve, with what a control net says besides, and notes of what was not read.
fn given(arguments: &Net) -> Result<(NetFile, Vec<ReaderNote>), Failure> {
    let (path, select) = split(&arguments.curve);
    let bytes = contents(&path)?;
    if select.is_empty() && file::is_net(&bytes) {
        let name = path.file_name().map_or_else(|| arguments.curve.clone(), |n| n.to_string_lossy().into_owned());
        return file::read(&bytes, &name, arguments.unit)
            .map(|net| (net, Vec::new()))
            .map_err(|e| Failure::new(e.to_string(), "'torse net --help' says what a control net must hold"));
    }
    let (curve, notes) = rail(&arguments.curve, arguments.unit, false)?;
    Ok((NetFile { curve, first_ruling: None, last_ruling: None, stars: None, shape: None }, notes))
}

/// The first ruling, mm: what the arguments say, else the file.
fn first_ruling(arguments: &Net, given: &NetFile) -> Result<Vec3, Failure> {
    let width = arguments.width.as_ref().map(|w| w.mm);
    let from_file = given.first_ruling;
    let direction = arguments.start_ruling.or(from_file.and_then(|r| r.try_normalize(0.0)));
    let width = width.or(from_file.map(|r| r.norm()));
    match (direction, width) {
        (Some(d), Some(w)) => Ok(d * w),
        // A file whose ruling has no direction is refused by name later.
        (None, Some(_)) if from_file.is_some() => Ok(Vec3::zeros()),
        (None, _) => Err(Failure::new(
            format!("{} comes without its first ruling", given.curve.name),
            "give its direction with --start-ruling, for example --start-ruling 0,1,0.3",
        )),
        (_, None) => Err(Failure::new(
            format!("{} comes without the length of its first ruling", given.curve.name),
            "give it with --width, for example --width 400mm",
        )),
    }
}

/// What else decides the net: arguments go before the file.
fn condition(arguments: &Net, given: &NetFile) -> Result<Condition, Failure> {
    let width = arguments.end_width.as_ref().map(|w| w.mm);
    let stars = |s: [f64; 2]| Condition::Stars { m_star: s[0], lambda_star: s[1] };
    let shape = |s: [f64; 2]| Condition::Shape { m: s[0], kappa: s[1] };
    let line = |direction: Vec3| Condition::LastRuling { direction, width };
    let asked = [
        arguments.end_ruling.map(line),
        arguments.stars.map(stars),
        arguments.shape.map(shape),
        given.last_ruling.map(|r| Condition::LastRuling { direction: r, width }),
        given.stars.map(stars),
        given.shape.map(shape),
    ];
    asked.into_iter().flatten().next().ok_or_else(|| {
        Failure::new(
            format!("one ruling does not decide the surface through {}", given.curve.name),
            "give the last ruling with --end-ruling, or the free parameters with --stars or --shape",
        )
    })
}
