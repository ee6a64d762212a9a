//! Sentences on flat parts.

use super::super::counted;
use super::super::numbers::length;
use crate::answer::note::{OffFaces, UnrollNote};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::tree::CutReason;

/// So many of all faces of a part of sheet have one thickness instead of the other.
fn thinned(part: &str, [faces, of]: [usize; 2], [local, thickness]: [String; 2]) -> String {
    format!(
        "{part}: the sheet is not {thickness} thick at {faces} of its {of} faces, but {local}, where it differs most: it must be \
         formed or milled there."
    )
}

/// Edges or parts named in one sentence at most.
const NAMED: usize = 20;

pub(super) fn words(note: &UnrollNote) -> String {
    match note {
        UnrollNote::NeutralFibre(k) => format!("Bent zones have the length of the neutral fibre: {}.", factor(k)),
        UnrollNote::Sheet { part, thickness, bends } => {
            format!("{part}: sheet of {}, {}.", length(*thickness), counted(*bends, "bend"))
        }
        UnrollNote::SideOfBodies => {
            "--side is for surfaces: bodies of sheet have both sides in the file, and it changes nothing of them.".into()
        }
        UnrollNote::Thinned { part, faces, of, local, thickness } => {
            thinned(part, [*faces, *of], [*local, *thickness].map(length))
        }
        UnrollNote::Cut { part, edge, reason } => {
            let why = match reason {
                CutReason::Closes => "the piece closes on itself there",
                CutReason::Overlap => "faces would lie on each other",
                CutReason::Differs => "its images on both faces differ",
                CutReason::Asked => "no bend was asked for there",
            };
            // Formats whose edges have no numbers.
            let edge = if *edge == 0 { "an edge".into() } else { format!("edge #{edge}") };
            format!("{part}: cut along {edge}, because {why}.")
        }
        UnrollNote::NotBent { part, edges } => {
            let named = listed(edges.iter().map(|e| format!("#{e}")));
            format!("{part}: cut along edges where faces meet at an angle, as asked: {named}.")
        }
        UnrollNote::Touching { parts } => format!(
            "Outlines touch themselves, or come too near to tell: that these parts do not lie over themselves is measured, not \
             proven: {}.",
            listed(parts.iter().cloned())
        ),
        UnrollNote::NotInSpace { part, faces } => format!(
            "{part}: faces are in the flat pattern, but not in the models and pictures, as no panel could be laid to their border: \
             {}.",
            listed(faces.iter().map(|f| format!("#{f}")))
        ),
        UnrollNote::Slanting { part, faces } => format!(
            "{part}: sides that are not square to the sheet (bevels, countersinks, steps, slanting holes): the outline is that of \
             the skin that is drawn, and says nothing of {}.",
            listed(faces.iter().map(|f| format!("#{f}")))
        ),
        UnrollNote::Carried { curves, points, distance, deviation } => {
            carried([*curves, *points], [*distance, *deviation].map(length))
        }
        UnrollNote::OtherSide { curves } => format!(
            "On the other side of the sheet than that from which its part is seen, and labelled so: {}.",
            listed(curves.iter().cloned())
        ),
        UnrollNote::OnPanels { curves } => format!(
            "On faces that panels cover, and drawn at the nearest places of these: {}.",
            listed(curves.iter().cloned())
        ),
        UnrollNote::AlongEdges { curves } => {
            format!("Not marked, as they run along outlines, which are cut: {}.", listed(curves.iter().cloned()))
        }
        UnrollNote::OffFaces { curves } => {
            let told = |c: &OffFaces| match c.length {
                0.0 => format!("{} ({} away)", c.curve, length(c.farthest)),
                whole if c.off < whole => format!(
                    "{} ({} of {}, up to {} away)",
                    c.curve,
                    length(c.off),
                    length(whole),
                    length(c.farthest)
                ),
                _ => format!("{} (up to {} away)", c.curve, length(c.farthest)),
            };
            format!("Curves and points that lie on no face laid flat here: {}.", listed(curves.iter().map(told)))
        }
        UnrollNote::Formed { part, count } => format!("{part}: {count} outlines of formed features are not cut."),
    }
}

/// Curves and points of the model on flat patterns.
fn carried([curves, points]: [usize; 2], [distance, deviation]: [String; 2]) -> String {
    let told = |n: usize, one: &str| (n > 0).then(|| counted(n, one));
    let what: Vec<String> = [told(curves, "curve"), told(points, "point")].into_iter().flatten().collect();
    format!(
        "On the flat patterns, to be marked (layer MARK_CURVE): {} of the model, at most {distance} from the faces; the lines keep \
         within {deviation} of their images. Both are measured.",
        what.join(" and ")
    )
}

/// Names, of many the first.
fn listed(all: impl ExactSizeIterator<Item = String>) -> String {
    let more = all.len().saturating_sub(NAMED);
    let mut named: Vec<String> = all.take(NAMED).collect();
    if more > 0 {
        named.push(format!("and {more} more"));
    }
    named.join(", ")
}

pub(super) fn factor(k: &KFactor) -> String {
    match k {
        KFactor::Ansi(k) => format!("K = {k} (ANSI: share of the thickness from the inside)"),
        KFactor::Din => "K by DIN 6935".into(),
        KFactor::Table(rows) => format!("K from a table of {} rows (ANSI)", rows.len()),
    }
}
