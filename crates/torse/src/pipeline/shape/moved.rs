//! The moves of a job, step by step.

use super::composite::{between, held, opposite};
use super::options::ShapeError;
use crate::answer::note::Note;
use crate::answer::Stage;
use crate::control::Control;
use crate::design::composite::Session;
use crate::io::shape::MoveRecord;
use crate::num::gauss_newton::Status;
use crate::reason::{JobReason, Reason};

/// Stages of the animation at most.
const MOST_STAGES: usize = 60;

/// What came of the moves.
#[derive(Default)]
pub(super) struct Moved {
    pub notes: Vec<Note>,
    pub stages: Vec<Stage>,
    /// Moves that could not be made to their end.
    pub missing: Vec<Reason>,
}

impl Moved {
    /// Keeps the shape as a stage of the animation.
    pub fn stage(&mut self, session: &Session, caption: String) -> Result<(), ShapeError> {
        let mut strips = session.strips()?;
        strips.extend(session.facets()?);
        self.stages.push(Stage { caption, strips });
        Ok(())
    }
}

/// Makes all moves, in steps. Where a step cannot be made, the last shape that met all conditions is kept, the rest of
/// the move is left out, and the others go on from there.
pub(super) fn moved(
    session: &mut Session,
    moves: &[MoveRecord],
    out: &mut Moved,
    control: &Control,
) -> Result<(), ShapeError> {
    let all: usize = moves.iter().map(|m| m.steps).sum();
    let shown = all.div_ceil(MOST_STAGES).max(1);
    let mut made = 0;
    out.stage(session, "first shape".into())?;
    for (index, m) in moves.iter().enumerate() {
        let source = |source| ShapeError::Move { index, source };
        let from = session.composite().handles.get(m.handle).map(|h| h.hold);
        let to = held(m.point, m.tangent, m.plane);
        let (Some(from), Some(to)) = (from, to) else { continue };
        if opposite(&from, &to) {
            return Err(ShapeError::Opposite { index });
        }
        let mut told = false;
        for k in 1..=m.steps {
            if control.stopped() {
                break;
            }
            session.set_handle(m.handle, between(&from, &to, k as f64 / m.steps as f64)).map_err(source)?;
            let report = session.step(control);
            let failed = report.status != Status::Converged;
            if failed && !std::mem::replace(&mut told, true) {
                out.notes.push(Note::Solved { step: Some((index, k)), report });
            }
            if failed && session.back() {
                out.missing.push(JobReason::Move { index, made: k - 1, steps: m.steps }.into());
                break;
            }
            made += 1;
            if made % shown == 0 || k == m.steps {
                out.stage(session, format!("move {index}, step {k} of {}", m.steps))?;
            }
        }
        control.report("moving", 0.1 + 0.5 * (index + 1) as f64 / moves.len() as f64, "");
    }
    Ok(())
}
