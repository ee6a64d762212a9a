//! What is proven and said of elements that were left out.

use crate::answer::note::FitNote;
use crate::answer::Answer;
use crate::certify::elements::elements as certified;
use crate::control::Control;
use crate::torse::contact::{ContactElement, Given};
use crate::torse::strip::Strip;

/// Proven distances (mm) of elements that were left out from the strips of the others.
pub(super) fn bounds(answer: &Answer, out: &[(usize, ContactElement)], control: &Control) -> Vec<f64> {
    let strips: Vec<Strip> = answer.strips().cloned().collect();
    certified(&strips, &out.iter().map(|o| o.1).collect::<Vec<_>>(), control).bounds().to_vec()
}

/// Says by how much a sequence of planes is shorter where those at its ends are left out.
pub(super) fn shortened(given: &Given, out: &[(usize, ContactElement)]) -> Option<FitNote> {
    let Given::Planes(sequence) = given else { return None };
    let is_out = |k: &usize| out.iter().any(|o| o.0 == *k);
    let first = (0..sequence.len()).find(|k| !is_out(k))?;
    let last = (0..sequence.len()).rev().find(|k| !is_out(k))?;
    let count = first + sequence.len() - 1 - last;
    let way =
        |range: &[ContactElement]| -> f64 { range.windows(2).map(|w| (w[1].centre() - w[0].centre()).norm()).sum() };
    let by = way(&sequence[..=first]) + way(&sequence[last..]);
    (count > 0).then(|| FitNote::Shortened { count, by, of: way(sequence) })
}
