//! Which faces of a model a job is for.

use crate::brep::face::Face;
use crate::io::step::read::Model;
use std::collections::BTreeSet;

/// Faces that are wanted; default: all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Entity numbers; none: any.
    pub faces: Vec<u64>,
    /// Names of parts, as the file gives them; none: any.
    pub parts: Vec<String>,
}

/// A selection that names what the model does not have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SelectError {
    /// No such face.
    #[error("the file has no face #{entity}; its faces are {there}")]
    Face {
        /// Asked for.
        entity: u64,
        /// Some that there are.
        there: String,
    },
    /// A face that was not read.
    #[error("face #{entity} could not be read: {reason}")]
    Lost {
        /// Asked for.
        entity: u64,
        /// Why.
        reason: String,
    },
    /// No such part.
    #[error("the file has no part '{name}'; {there}")]
    Part {
        /// Asked for.
        name: String,
        /// Those that there are.
        there: String,
    },
    /// Faces and parts that have nothing in common.
    #[error("none of the faces belongs to one of the parts that were asked for")]
    Nothing,
}

/// Names that an error lists.
const LISTED: usize = 12;

fn some_of(names: &BTreeSet<String>) -> String {
    let more = names.len().saturating_sub(LISTED);
    let listed: Vec<&str> = names.iter().take(LISTED).map(String::as_str).collect();
    match more {
        0 => listed.join(", "),
        n => format!("{} and {n} more", listed.join(", ")),
    }
}

/// The model with the selected faces only. Faces that were not read and are not asked for by number do not count as left
/// out; where parts are asked for they do, for nobody knows whose they are.
///
/// # Errors
/// Faces and parts that are not there.
pub fn selected(model: Model, selection: &Selection) -> Result<Model, SelectError> {
    if *selection == Selection::default() {
        return Ok(model);
    }
    let Model { faces, mut skipped, mut notes, .. } = model;
    for &entity in &selection.faces {
        if faces.iter().any(|f| f.entity == entity) {
            continue;
        }
        if let Some(lost) = skipped.iter().find(|s| s.entity == Some(entity)) {
            return Err(SelectError::Lost { entity, reason: lost.reason.clone() });
        }
        let there = some_of(&faces.iter().map(|f| format!("#{}", f.entity)).collect());
        return Err(SelectError::Face { entity, there });
    }
    for name in &selection.parts {
        if !faces.iter().any(|f| f.part == *name) {
            let there: BTreeSet<String> = faces.iter().map(|f| f.part.clone()).filter(|p| !p.is_empty()).collect();
            let there = match there.is_empty() {
                true => "its parts have no names".into(),
                false => format!("its parts are {}", some_of(&there)),
            };
            return Err(SelectError::Part { name: name.clone(), there });
        }
    }
    let wanted = |f: &Face| {
        (selection.faces.is_empty() || selection.faces.contains(&f.entity))
            && (selection.parts.is_empty() || selection.parts.contains(&f.part))
    };
    let all = faces.len();
    let faces: Vec<Face> = faces.into_iter().filter(wanted).collect();
    if faces.is_empty() {
        return Err(SelectError::Nothing);
    }
    if !selection.faces.is_empty() {
        skipped.clear();
    }
    notes.push(format!("{} of the {all} faces of the file, as chosen", faces.len()));
    Ok(Model { faces, skipped, notes, ..model })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> Model {
        crate::io::step::read::read(include_bytes!("../../../../data/cone_holes.step")).expect("our own file")
    }

    #[test]
    fn faces_are_chosen_by_number_and_by_part() {
        let whole = model();
        let (entity, part) = (whole.faces[0].entity, whole.faces[0].part.clone());
        let chosen = selected(model(), &Selection { faces: vec![entity], parts: vec![part] }).expect("it is there");
        assert_eq!((chosen.faces.len(), chosen.faces[0].entity), (1, entity));
        assert!(chosen.notes.last().is_some_and(|n| n.contains("as chosen")));
    }

    #[test]
    fn what_is_not_there_is_named_with_what_is() {
        let e =
            selected(model(), &Selection { faces: vec![999_999], ..Selection::default() }).expect_err("no such face");
        let number = format!("#{}", model().faces[0].entity);
        assert!(e.to_string().contains("no face #999999") && e.to_string().contains(&number), "{e}");
        let e = selected(model(), &Selection { parts: vec!["keel".into()], ..Selection::default() });
        assert!(e.expect_err("no such part").to_string().contains("no part 'keel'"));
    }
}
