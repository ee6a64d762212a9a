//! What a CAD file holds, whatever its format.

use crate::answer::note::reader::{AnnotationKind, ReaderNote};
use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::brep::face::Face;
use crate::brep::free_curve::FreeCurve;
use crate::reason::Reason;

/// The faces of a CAD file.
///
/// # Example
/// ```
/// let model = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// assert!(model.skipped.is_empty() && model.unit == "millimetre");
/// let planes = torse::measure(&model.faces).iter().filter(|face| face.character() == "flat").count();
/// assert!(planes > 0 && planes < model.faces.len(), "the others are bends and holes");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    /// Trimmed faces in millimetres, in the coordinates of the whole model; one for each occurrence in an assembly.
    pub faces: Vec<Face>,
    /// Faces and other items that could not be read, by entity number.
    pub skipped: Vec<Skipped>,
    /// Name of the file's length unit in lower case ("millimetre", "foot"); empty if the file names none.
    pub unit: String,
    /// Remarks on the file as a whole (damage, repeated numbers, truncation), and on what was chosen of it.
    pub notes: Vec<Note>,
    /// Names of the products.
    pub products: Vec<String>,
    /// Curves, points and texts beside the faces, in the coordinates of the whole model; those that could not be read are told in
    /// the notes.
    pub curves: Vec<FreeCurve>,
}

/// Knobs of the reader.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Largest distance between a trimming curve and the image of its chords, never above 10⁻⁵ of the extent of each
    /// face's boundary, which is the default (`None`). mm.
    pub chord_tolerance: Option<f64>,
}

/// A reason as the end of a message; nothing where there is none.
pub(super) fn first_of(reason: &str) -> String {
    if reason.is_empty() {
        String::new()
    } else {
        format!("; {reason}")
    }
}

/// What is said of annotations that are not carried to flat patterns: the kinds that there are.
pub(super) fn not_carried(counts: impl IntoIterator<Item = (AnnotationKind, usize)>) -> Option<ReaderNote> {
    let kinds: Vec<_> = counts.into_iter().filter(|c| c.1 > 0).collect();
    (!kinds.is_empty()).then_some(ReaderNote::Annotations(kinds))
}

/// A face or item of a file that its reader leaves out, with what the reader says of it.
pub(crate) fn unread(entity: u64, words: impl Into<String>, area_estimate: Option<f64>) -> Skipped {
    Skipped::of_file(entity, Reason::Input(words.into()), area_estimate)
}
