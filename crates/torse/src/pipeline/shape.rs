//! `shape`: strips of splines between curves, pulled by handles, as developable panels.
//!
//! Reads like the page that describes it: set up the composite, settle it, move handles, polish, have it judged, develop.

mod apart;
mod assessed;
mod composite;
mod given;
mod goal;
mod joined;
mod moved;
mod options;
mod rails;
mod targets;
#[cfg(test)]
mod tests;
mod unmet;

use crate::answer::note::Note;
use crate::answer::Answer;
use crate::control::Control;
use crate::design::composite::{Options as SessionOptions, Session};
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::{BBox, Vec3};
use crate::io::shape::ShapeFile;
use crate::reason::JobReason;
use assessed::assessed;
use composite::composite;
use moved::{moved, Moved};
pub use options::Options;
pub use options::ShapeError;
use std::time::Instant;
use targets::Asked;

/// Residual of the polish, as a share of the size: some digits beyond what twist is asked for.
const POLISHED: f64 = 1e-11;

/// Strips between curves that keep what is held, judged and developed.
///
/// `load` answers the contents of files that targets name.
///
/// *Guarantee.* `Certified` only if the twist of every developable strip is proven to stay below `twist_tolerance`, no ruling
/// meets the regression curve within it (proven), pieces that should go on smoothly are proven to do so and joins to have no
/// gap beyond the tolerance, rails of lofts that are taken over to be covered whole, targets are proven to be as near as asked for, both ways, fixed curves are proven to be kept
/// within the tolerance and held places are (measured), and every part has a pattern. Everything else is `Uncertified` with
/// the reason.
///
/// # Errors
/// Anything in the job that does not make sense, with its place: `$.handles[2].curve`.
///
/// # Example
/// ```
/// let job = torse::io::shape::read(include_bytes!("../../../../data/pulled_hull.json"), "hull", None)?;
/// let nothing = |name: &str| Err(format!("no file {name}"));
/// let answer = torse::shape(&job, &torse::Shape::new(0.5), &nothing, &torse::Control::default())?;
/// assert_eq!(answer.patchwork().panels.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn shape(
    job: &ShapeFile,
    options: &Options,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    control: &Control,
) -> Result<Answer, ShapeError> {
    let start = Instant::now();
    if !is_tolerance(options.tolerance) {
        return Err(ShapeError::Tolerance(options.tolerance));
    }
    let points: Vec<Vec3> = job.curves.iter().flat_map(|c| c.1.control.iter().map(|p| Vec3::from(*p))).collect();
    // Strips of other files are no smaller than these are.
    if job.from.is_empty() {
        Loose::check(BBox::of(&points).diagonal(), options.tolerance)?;
    }
    let (composite, goals, taken) = composite(job, load, options.tolerance)?;
    let mut out = Moved { notes: taken.notes.clone(), ..Moved::default() };
    let mut session = Session::new(composite, SessionOptions::default())?;
    control.report("settling", 0.1, "");
    let settled = session.settle(control);
    out.notes.push(Note::Solved { step: None, report: settled });
    if !job.moves.is_empty() {
        moved(&mut session, &job.moves, &mut out, control)?;
    }
    control.report("polishing", 0.6, "");
    if !(session.composite().targets.is_empty() || session.composite().is_ruled()) {
        session.approach(control);
    }
    let polished = session.polish(POLISHED, control)?;
    out.notes.push(Note::Met { residual: polished.residual });
    let unmet = polished.residual.is_nan() || polished.residual * session.size() > options.tolerance;
    if let Some((class, item)) = polished.obstacle.filter(|_| unmet) {
        let left = polished.residual * session.size();
        out.missing.push(JobReason::Unmet { class, left, item }.into());
    }
    if !out.stages.is_empty() {
        out.stage(&session, "result".into())?;
    }
    control.report("judging", 0.7, "");
    // The proof has its own clock: what was made is judged even when time is up.
    let asked = Asked { records: &job.targets, goals: &goals, own: job.curves.len(), taken: &taken, options };
    let answer = assessed(&session, &asked, out, &Control::default())?;
    Ok(Answer { seconds: start.elapsed().as_secs_f64(), ..answer })
}
