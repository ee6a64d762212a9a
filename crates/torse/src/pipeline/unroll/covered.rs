//! Faces that are not developable, covered by panels that are, within a tolerance of their own.

use super::options::{TooRound, UnrollError};
use super::targets::of_panel;
use crate::answer::marks::Marks;
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::Answer;
use crate::brep::area::total_curvature_estimate;
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Subject, What};
use crate::control::Control;
use crate::develop::carried::Target;
use crate::develop::unfold::part::SheetPart;
use crate::develop::view::panels_viewed;
use crate::geom::Vec2;
use crate::patchwork::panel::Panel;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Mark, MarkLine, Pattern};
use crate::pipeline::approximate::{of_faces, Options};
use crate::reason::{FaceReason, Reason};
use crate::search::cover::is_all_round;
use std::f64::consts::TAU;

/// What the absolute curvature of a face adds up to, in 2π, above which it is not covered beside what is laid flat, unless it goes all
/// round an axis: a hemisphere has 1, a closed surface 2 and more, and without cones about an axis these take minutes.
const MOST_TURNS: f64 = 1.5;

/// A panel that covers a face, as what curves are carried to.
pub(super) struct Cover {
    /// The panel, and the face below it; none where it has no map.
    pub target: Option<Target>,
    /// Whether its pattern is seen from the other side than it was laid flat from.
    pub is_turned: bool,
}

/// Panels as what curves of the model are carried to, in the order of their patterns; they are within `tolerance` (mm) of their faces.
fn covers(made: &Answer, tolerance: f64) -> Vec<Cover> {
    let cover = |pattern: &Pattern| {
        let panel = made.parts.get(pattern.panel).map_or(pattern.panel, |p| p.first);
        let face = made.patchwork.panels.get(panel).and_then(Panel::face).and_then(|f| made.patchwork.faces.get(f));
        let target = of_panel(&made.patchwork, panel, pattern, 0.0).zip(face);
        // A place beside the axis about which patterns are turned over.
        let probe = MarkLine::straight("", &[Vec2::x()]);
        let probe = Pattern { panel, curves: vec![probe], ..Pattern::default() };
        let seen = panels_viewed(&made.patchwork, vec![probe], pattern.view);
        let is_turned = seen.iter().flat_map(|p| &p.curves).flat_map(|l| &l.joints).any(|j| j.point.x < 0.0);
        Cover { target: target.map(|(t, face)| t.covering(face, tolerance)), is_turned }
    };
    made.patterns.iter().map(cover).collect()
}

/// Adds panels for `faces`, each a part of its own, with what is proven of them; where there are curves to be carried over, the answer
/// is what they are carried to. Names follow those of `torse approximate`.
/// Where that job fails, and where they are curved all around but about no axis, the faces are left out by name, if there are other parts.
///
/// # Errors
/// As of that job, where there is nothing else; [`TooRound`].
pub(super) fn add(
    answer: &mut Answer,
    faces: Vec<Face>,
    (tolerance, curves): (f64, bool),
    control: &Control,
) -> Result<Vec<Cover>, UnrollError> {
    let turns = |f: &Face| if is_all_round(f, tolerance) { 0.0 } else { total_curvature_estimate(f) / TAU };
    let (round, faces): (Vec<_>, Vec<_>) = faces.into_iter().map(|f| (turns(&f), f)).partition(|f| f.0 > MOST_TURNS);
    let faces: Vec<Face> = faces.into_iter().map(|f| f.1).collect();
    let why = |(turns, face): &(f64, Face)| TooRound { entity: face.entity, turns: *turns };
    let refused: Vec<Skipped> = round.iter().map(|f| Skipped::of_face(&f.1, Reason::error(&why(f)))).collect();
    if faces.is_empty() {
        match round.first() {
            Some(first) if answer.parts.is_empty() => return Err(why(first).into()),
            _ => leave(answer, refused),
        }
        return Ok(Vec::new());
    }
    leave(answer, refused);
    let made = match of_faces(faces.clone(), Vec::new(), &Options::new(tolerance), control) {
        Ok(made) => made,
        Err(e) if answer.parts.is_empty() => return Err(e.into()),
        Err(e) => {
            leave(answer, faces.iter().map(|f| Skipped::of_face(f, Reason::error(&e))).collect());
            return Ok(Vec::new());
        }
    };
    let covers = if curves { covers(&made, tolerance) } else { Vec::new() };
    let (panels, parts) = (answer.patchwork.panels.len(), answer.parts.len());
    // What stands against the whole cover concerns the parts that it marks, and no other one if it marks any.
    let marked = Marks::of(&made).parts;
    let blamed = marked.contains(&true);
    let against = |c: &Claim| blamed && c.subject() == Subject::Whole && c.is_broken() && c.what() != What::LeftOut;
    // Covers are drawn to their own tolerance.
    let drawn = |c: Claim| if c.what() == What::DrawingDistance { c.within(tolerance) } else { c };
    answer.claims.extend(made.claims.into_iter().map(|c| match against(&c) {
        true => c.told_of_parts(),
        false => drawn(c.after(panels)),
    }));
    let refused = made.parts.iter().enumerate().filter(|(k, _)| marked.get(*k) != Some(&false));
    answer.claims.extend(
        refused.map(|(k, part)| {
            Claim::objection(Subject::Part(parts + k), FaceReason::NoCover { part: part.name.clone() })
        }),
    );
    answer.parts.extend(made.parts.into_iter().map(|p| Part { first: p.first + panels, ..p }));
    // Panels of covers are parts one by one.
    let joints = answer.joints.len();
    answer.patterns.extend(made.patterns.into_iter().map(|p| Pattern {
        panel: p.panel + parts,
        marks: p.marks.into_iter().map(|m| Mark { label: renamed(&m.label, joints), ..m }).collect(),
        ..p
    }));
    answer.sheets.resize(answer.patterns.len(), SheetPart::default());
    answer.skipped.extend(made.skipped);
    answer.notes.extend(made.notes);
    answer.patchwork.append(made.patchwork);
    Ok(covers)
}

/// Names what is left out.
fn leave(answer: &mut Answer, skipped: Vec<Skipped>) {
    answer.claims.extend(left_out(&skipped));
    answer.skipped.extend(skipped);
}

/// The label of a mark on a joint whose number goes on after so many others; seams have numbers of their own.
fn renamed(label: &str, before: usize) -> String {
    let number = || -> Option<(usize, &str)> {
        let (number, rest) = label.strip_prefix('J')?.split_once('.')?;
        Some((number.parse().ok()?, rest))
    };
    number().map_or_else(|| label.to_owned(), |(number, rest)| format!("J{}.{rest}", number + before))
}
