//! Which faces of a model a job is for.

use crate::answer::note::{BodyName, Note};
use crate::brep::area::area_estimate;
use crate::brep::body::Body;
use crate::brep::face::Face;
use crate::develop::unfold::sheet as unfolded;
use crate::io::model::Model;
use crate::io::words;
pub use crate::patchwork::skins::Skin;
use crate::patchwork::skins::{sheet, SheetSkins};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// Faces that are wanted; default: all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Entity numbers; none: any.
    pub faces: Vec<u64>,
    /// Names of parts, as the file gives them; none: any.
    pub parts: Vec<String>,
    /// The skin of sheets that are drawn as bodies, which leaves out the other skin and the sides; default everything.
    pub skin: Option<Skin>,
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
    /// A skin of bodies that have none.
    #[error(
        "none of the {bodies} bodies is a sheet of constant thickness, which alone has an outer and an inner skin"
    )]
    NoSheet {
        /// Number of bodies.
        bodies: usize,
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

/// What could be asked for of a model of which everything is taken: a skin of each sheet that is drawn as a body.
pub fn offers(model: &Model) -> Vec<Note> {
    let all = sheets(&model.faces, sheet).into_iter();
    all.map(|(faces, sheet)| offer(&model.faces, &faces, &sheet)).collect()
}

/// The model with the selected faces only. Faces that were not read and are not asked for by number do not count as left
/// out; where parts are asked for they do, for nobody knows whose they are.
///
/// # Errors
/// Faces and parts that are not there.
///
/// # Example
/// ```
/// use torse::pipeline::select::{selected, Selection};
/// let model = torse::read(include_bytes!("../../../../data/cone_holes.step"))?;
/// let faces = vec![model.faces[0].entity];
/// assert_eq!(selected(model, &Selection { faces, ..Selection::default() })?.faces.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
            return Err(SelectError::Lost { entity, reason: words::why(&lost.reason) });
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
    let mut faces: Vec<Face> = faces.into_iter().filter(wanted).collect();
    if faces.is_empty() {
        return Err(SelectError::Nothing);
    }
    if let Some(skin) = selection.skin {
        faces = skins(faces, skin, &mut notes)?;
    }
    if !selection.faces.is_empty() {
        skipped.clear();
    }
    notes.push(Note::Chosen { count: faces.len(), all });
    Ok(Model { faces, skipped, notes, ..model })
}

/// The skins of a body, as `torse unroll` tells them where rays do not: outside, a flange that is narrower than what it joins has
/// one face with the end of that, which bounds one skin and is part of the other. What is neither skin nor side is in none of
/// the lists.
fn sheet_or_flanges(faces: &[&Face]) -> Option<SheetSkins> {
    sheet(faces).or_else(|| {
        let found = unfolded::sheet(&Body::new(faces.to_vec())).ok()?;
        if found.thickness <= 0.0 || found.skins.iter().any(Vec::is_empty) {
            return None;
        }
        let area = |s: &[usize]| s.iter().map(|k| area_estimate(faces[*k])).sum::<f64>();
        let [mut outer, mut inner] = [0, 1].map(|k| found.whole_skin(k));
        if area(&inner) > area(&outer) {
            std::mem::swap(&mut outer, &mut inner);
        }
        let kept: HashSet<usize> = found.others.iter().chain(&outer).chain(&inner).copied().collect();
        let sides = (0..faces.len()).filter(|k| !kept.contains(k)).collect();
        Some(SheetSkins { thickness_estimate: found.thickness, outer, inner, sides })
    })
}

/// Bodies that are sheets, as `of` tells them from their faces: the indices of these, and the skins among them.
fn sheets(faces: &[Face], of: impl Fn(&[&Face]) -> Option<SheetSkins>) -> Vec<(Vec<usize>, SheetSkins)> {
    let mut bodies: BTreeMap<(u32, &str), Vec<usize>> = BTreeMap::new();
    for (k, f) in faces.iter().enumerate() {
        bodies.entry((f.body, f.part.as_str())).or_default().push(k);
    }
    let found = bodies.into_values().filter_map(|body| {
        let faces: Vec<&Face> = body.iter().map(|&k| &faces[k]).collect();
        Some((body, of(&faces)?))
    });
    found.collect()
}

/// What a body is called.
fn named(face: &Face) -> BodyName {
    BodyName { part: face.part.clone(), entity: face.entity }
}

fn offer(faces: &[Face], body: &[usize], sheet: &SheetSkins) -> Note {
    Note::BothSkins {
        body: named(&faces[body[0]]),
        thickness: sheet.thickness_estimate,
        faces: [&sheet.outer, &sheet.inner, &sheet.sides].map(Vec::len),
    }
}

/// The faces of one skin of every sheet; bodies that are none stay whole.
fn skins(faces: Vec<Face>, skin: Skin, notes: &mut Vec<Note>) -> Result<Vec<Face>, SelectError> {
    let found = sheets(&faces, sheet_or_flanges);
    if found.is_empty() {
        let bodies: BTreeSet<(u32, &str)> = faces.iter().map(|f| (f.body, f.part.as_str())).collect();
        return Err(SelectError::NoSheet { bodies: bodies.len() });
    }
    let mut left_out = BTreeSet::new();
    for (body, sheet) in &found {
        let (kept, other) = match skin {
            Skin::Outer => (&sheet.outer, &sheet.inner),
            Skin::Inner => (&sheet.inner, &sheet.outer),
        };
        left_out.extend(other.iter().chain(&sheet.sides).map(|&k| body[k]));
        notes.push(Note::OneSkin {
            body: named(&faces[body[0]]),
            thickness: sheet.thickness_estimate,
            skin,
            kept: kept.len(),
            all: body.len(),
        });
    }
    let kept = faces.into_iter().enumerate().filter(|(k, _)| !left_out.contains(k));
    Ok(kept.map(|(_, f)| f).collect())
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
        let chosen =
            selected(model(), &Selection { faces: vec![entity], parts: vec![part], skin: None }).expect("it is there");
        assert_eq!((chosen.faces.len(), chosen.faces[0].entity), (1, entity));
        assert_eq!(chosen.notes.last(), Some(&Note::Chosen { count: 1, all: whole.faces.len() }));
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
