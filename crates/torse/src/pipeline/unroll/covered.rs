//! Faces that are not developable, covered by panels that are, within a tolerance of their own.

use super::options::UnrollError;
use crate::answer::marks::Marks;
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Subject, What};
use crate::control::Control;
use crate::develop::unfold::part::SheetPart;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Mark, Pattern};
use crate::pipeline::approximate::{of_faces, Options};
use crate::reason::{FaceReason, Reason};

/// Adds panels for `faces`, each a part of its own, with what is proven of them. Names follow those of `torse approximate`.
/// Where that job fails, the faces are left out by name, if there are other parts.
///
/// # Errors
/// As of that job, where there is nothing else.
pub(super) fn add(answer: &mut Answer, faces: Vec<Face>, tolerance: f64, control: &Control) -> Result<(), UnrollError> {
    if faces.is_empty() {
        return Ok(());
    }
    let made = match of_faces(faces.clone(), Vec::new(), &Options::new(tolerance), control) {
        Ok(made) => made,
        Err(e) if answer.parts.is_empty() => return Err(e.into()),
        Err(e) => {
            let skipped: Vec<Skipped> = faces.iter().map(|f| Skipped::of_face(f, Reason::error(&e))).collect();
            answer.claims.extend(left_out(&skipped));
            answer.skipped.extend(skipped);
            return Ok(());
        }
    };
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
    Ok(())
}

/// The label of a mark on a joint whose number goes on after so many others; seams have numbers of their own.
fn renamed(label: &str, before: usize) -> String {
    let number = || -> Option<(usize, &str)> {
        let (number, rest) = label.strip_prefix('J')?.split_once('.')?;
        Some((number.parse().ok()?, rest))
    };
    number().map_or_else(|| label.to_owned(), |(number, rest)| format!("J{}.{rest}", number + before))
}
