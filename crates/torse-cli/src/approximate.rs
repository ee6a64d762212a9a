//! `torse approximate`: the main job.

use crate::args::{self, Approximate, Seams};
use crate::failure::Failure;
use crate::input::contents;
use crate::job::{refuse_left_out, Job};
use crate::loft::{rail, rails};
use crate::quantity::{section, Length};
use crate::wiring;
use torse::answer::note::{Note, ReaderNote};
use torse::certify::claim::Status;
use torse::io::bundle;
use torse::pipeline::select::{offers, Selection};
use torse::search::cover::{CurveShape, Guide, Layout, LayoutKind, Limits, PanelCurve, SeamPlane};
use torse::torse::rail::Rail;

/// Share of the tolerance that panels may use if cones follow: the rest is for the cones, which are many where it is
/// small.
const PANELS_OF_CONES: f64 = 0.6;

/// Runs the job; `Ok(true)` means certified.
pub fn run(arguments: &Approximate) -> Result<bool, Failure> {
    let file = &arguments.file;
    let least = || arguments.sweep.iter().min_by(|a, b| a.mm.total_cmp(&b.mm));
    let tolerance = arguments.tolerance.as_ref().or_else(least);
    let tolerance = tolerance.ok_or_else(|| Failure::new("no tolerance", "give one: --tolerance 2mm"))?;
    let bytes = contents(file)?;
    let (layout, unread) = layout(arguments)?;
    let mut job = Job::begin(&arguments.files, file, arguments.time_limit)?;

    job.say("reading");
    let model = wiring::read(&file.display().to_string(), &bytes)?;
    let mut model = wiring::selected(model, &arguments.chosen)?;
    drop(bytes);
    if arguments.strict {
        refuse_left_out(file, &model.skipped)?;
    }
    let options = torse::Approximate {
        input: arguments.files.job_name(file),
        tolerance: if arguments.cones { PANELS_OF_CONES } else { 1.0 } * tolerance.mm,
        max_panels: arguments.max_panels.map(|n| n as usize),
        limits: limits(arguments, job.least_panel_radius()),
        layout,
        meet: arguments.seams == Seams::Meet,
        smooth_angle: arguments.smooth_angle.to_radians(),
        drawn: arguments.drawing.drawn(&arguments.files.shop),
    };
    job.keep(options.limits);
    let mut notes = std::mem::take(&mut model.notes);
    if arguments.chosen.selection() == Selection::default() {
        notes.extend(offers(&model));
    }
    notes.extend(unread.into_iter().map(Note::Input));
    let swept = if arguments.sweep.is_empty() {
        Vec::new()
    } else {
        let tolerances: Vec<f64> = arguments.sweep.iter().map(|l| l.mm).collect();
        wiring::sweep(&model, &tolerances, &options, job.control())?
    };
    let mut answer = wiring::approximate(model, &options, job.control())?;
    if arguments.strict {
        refuse_left_out(file, &answer.skipped)?;
    }
    answer.notes.splice(0..0, notes);
    job.deliver(&mut answer)?;
    job.write(swept)?;
    let mut cones_hold = true;
    if arguments.cones {
        job.say("cones");
        let mut cones = wiring::cones_of_panels(&answer, tolerance.mm, options.drawn, job.control())?;
        job.write_answer(&mut cones, |name| if name == bundle::CONES { name } else { format!("cones-{name}") })?;
        cones_hold = cones.status() == Status::Certified;
    }
    Ok(job.finish(&answer, &tolerance.text)? && cones_hold)
}

/// What sheet and material allow, in mm; `least_radius` is what the material and its thickness say.
fn limits(arguments: &Approximate, least_radius: Option<f64>) -> Limits {
    let mm = |length: &Option<Length>| length.as_ref().map(|l| l.mm);
    Limits {
        min_bend_radius: mm(&arguments.min_bend_radius).into_iter().chain(least_radius).reduce(f64::max),
        min_clearance: mm(&arguments.min_clearance),
        max_width: mm(&arguments.max_width),
        max_length: mm(&arguments.max_length),
        sheet: arguments.sheet,
        min_width: mm(&arguments.min_width),
    }
}

/// Points on a guide curve.
const GUIDE_POINTS: usize = 400;

/// Where strips and seams run, with notes of what was not read.
fn layout(arguments: &Approximate) -> Result<(Layout, Vec<ReaderNote>), Failure> {
    let mut notes = Vec::new();
    let guide = match (&arguments.direction, &arguments.guide) {
        (Some(d), _) => Some(Guide::Direction(*d)),
        (None, Some(file)) => {
            let (rail, unread) = rail(file, arguments.unit, false)?;
            notes.extend(unread);
            Some(Guide::Curve(rail.samples(GUIDE_POINTS)))
        }
        (None, None) => None,
    };
    let kind = match arguments.layout {
        args::Layout::Auto => LayoutKind::Auto,
        args::Layout::Strips => LayoutKind::Strips,
        args::Layout::Rings => LayoutKind::Rings,
    };
    let seams = arguments.seam_at.iter().map(|s| SeamPlane { normal: s.axis, offset: s.at }).collect();
    let mut all = Vec::new();
    for text in &arguments.curves {
        all.extend(curves(text, arguments.unit, &mut notes)?);
    }
    let mut seam_curves = Vec::new();
    for text in &arguments.seam_along {
        seam_curves.extend(curves(text, arguments.unit, &mut notes)?);
    }
    Ok((Layout { kind, guide, seams, seam_curves, curves: all }, notes))
}

/// Curves that panels or seams run along: one, or all of a drawing. What was not read of it goes into `notes`.
fn curves(text: &str, unit: Option<f64>, notes: &mut Vec<ReaderNote>) -> Result<Vec<PanelCurve>, Failure> {
    let shape = match text.split_once('=').map(|(axis, place)| (axis.trim(), place.trim())) {
        Some((axis @ ("u" | "v"), place)) => {
            let share = place.parse::<f64>().ok().filter(|s| (0.0..=1.0).contains(s)).ok_or_else(|| {
                Failure::new(
                    format!("'{text}' is no parameter curve"),
                    "write u or v and a share of its range, such as u=0.5",
                )
            })?;
            if axis == "u" {
                CurveShape::AlongV(share)
            } else {
                CurveShape::AlongU(share)
            }
        }
        Some(("x" | "X" | "y" | "Y" | "z" | "Z", _)) => {
            let s = section(text).map_err(|e| Failure::new(e, "give the plane of the section with its unit"))?;
            CurveShape::Section { normal: s.axis, offset: s.at }
        }
        _ => {
            let found = rails(text, unit, false)?;
            notes.extend(found.notes);
            let name = |r: &Rail| if found.rails.len() > 1 { r.name.clone() } else { text.to_owned() };
            let points = |r: &Rail| CurveShape::Points(r.samples(GUIDE_POINTS));
            return Ok(found.rails.iter().map(|r| PanelCurve { name: name(r), shape: points(r) }).collect());
        }
    };
    Ok(vec![PanelCurve { name: text.to_owned(), shape }])
}
