//! From rulings, tangent planes or a developable face to strips of low degree: fit, prove, develop.

use crate::answer::note::{Became, FaceNote, Note};
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Counted, Status, Subject};
use crate::control::Control;
use crate::fit::elements::gaps::ruling_groups;
use crate::fit::elements::given::{agreeing, of_rulings, only, repeated, square, FEWEST};
use crate::fit::elements::ruling_order::is_ring;
use crate::geom::coarse::{is_tolerance, Coarse, Loose};
use crate::geom::{BBox, Vec3};
use crate::io::words;
use crate::reason::{Item, JobReason, Reason};
use crate::search::strips::ruled_face::{reached, GivenFace};
use crate::search::strips::sequences::{strips_of_face, strips_of_sequence, ElementSequence};
use crate::search::trims::assess_trims;
use crate::torse::contact::{orient, Given};
use crate::torse::zone::RegressionLimits;
use assessed::{assessed, Made, Sort};
use left::{bounds, shortened};
pub use options::{ElementFitError, ElementFitOptions};
use std::time::Instant;

mod assessed;
mod ends;
mod left;
mod options;
#[cfg(test)]
mod tests;

/// Fits developable strips to rulings or tangent planes.
///
/// *Input*: rulings in any order; planes in order along the surface. *Result*: certified if every element is proven to
/// lie within the tolerance; otherwise those that are not are counted and the worst is named. Strips end where
/// rulings end. Nothing is proven between the elements.
///
/// # Errors
/// See [`ElementFitError`].
///
/// # Example
/// ```
/// use torse::{geom::Vec3, torse::contact::Given};
/// let ruling = |k: i32| {
///     let (x, y) = (0.05 * f64::from(k)).sin_cos();
///     [Vec3::new(100.0 * x, 100.0 * y, 0.0), Vec3::new(100.0 * x, 100.0 * y, 80.0)]
/// };
/// let given = Given::Rulings((0..20).map(ruling).collect());
/// let answer = torse::fit_elements(&given, &torse::ElementFitOptions::new(0.1, "hood"), &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.patchwork().panels.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_elements(given: &Given, options: &ElementFitOptions, control: &Control) -> Result<Answer, ElementFitError> {
    let sort = if matches!(given, Given::Rulings(_)) { Sort::Rulings } else { Sort::Planes };
    let what = sort.many();
    if given.len() < FEWEST {
        return Err(ElementFitError::Few(given.len(), what));
    }
    if let Given::Planes(planes) = given {
        if let Some(index) = planes.iter().position(|e| !e.is_usable()) {
            return Err(ElementFitError::Element { index });
        }
    }
    if let Some(index) = repeated(given) {
        return Err(ElementFitError::Repeated { what: sort.one(), index });
    }
    let fitted = |kept: &Given| around(kept, sort, options, control);
    let all = fitted(given);
    // What one strip follows has no outliers.
    let one = |a: &Answer| a.status() == Status::Certified && a.patchwork.panels.len() == 1;
    if !options.robust || all.as_ref().is_ok_and(one) {
        return all;
    }
    let (kept, mut out) = agreeing(given, options.tolerance);
    let mut answer = if out.is_empty() { all? } else { fitted(&kept)? };
    let mut left = bounds(&answer, &out, control);
    // What lies within the tolerance of the strips all the same is taken in, as long as that does no harm.
    while left.iter().any(|away| *away <= options.tolerance) {
        let mut far = left.iter().map(|away| *away > options.tolerance);
        let fewer: Vec<_> = out.iter().copied().filter(|_| far.next() == Some(true)).collect();
        let kept: Vec<usize> = (0..given.len()).filter(|k| fewer.iter().all(|o| o.0 != *k)).collect();
        let again = fitted(&only(given, &kept))?;
        if again.status() != Status::Certified && answer.status() == Status::Certified {
            break;
        }
        (answer, out) = (again, fewer);
        left = bounds(&answer, &out, control);
    }
    if !out.is_empty() {
        let reason = |index, away| JobReason::Outlier { sort: sort.given(), index, away };
        let why = out.iter().zip(&left).map(|((index, _), away)| reason(*index, *away));
        answer.skipped.extend(why.map(Skipped::from));
        let claims = &mut answer.claims;
        claims.insert(claims.len().min(1), Claim::count(Counted::Outliers, Subject::Whole, out.len()));
        answer.notes.extend(shortened(given, &out).map(Note::Fit));
    }
    Ok(answer)
}

/// Strips for what is given: a ring of rulings that one strip would go around, up to where it begins, becomes two halves.
fn around(
    given: &Given,
    sort: Sort,
    options: &ElementFitOptions,
    control: &Control,
) -> Result<Answer, ElementFitError> {
    let sequence = |estimates| ElementSequence { name: sort.many().to_string(), estimates, face: None };
    let rulings = match given {
        Given::Planes(p) => return run(vec![sequence(vec![p.clone()])], Vec::new(), sort, &[], (options, control)),
        Given::Rulings(r) => r,
    };
    let found = |sheets: &[&[[Vec3; 2]]]| {
        let all = sheets.iter().map(|r| of_rulings(r, options.tolerance).map(sequence)).collect::<Result<_, _>>()?;
        run(all, Vec::new(), sort, rulings, (options, control))
    };
    let sheets = ruling_groups(rulings, options.tolerance);
    let answer = found(&sheets.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
    match &sheets[..] {
        [ring] if is_ring(ring) && ring.len() >= 2 * FEWEST && answer.patchwork.panels.len() == 1 => {
            let middle = ring.len() / 2;
            found(&[&ring[..=middle], &ring[middle..]])
        }
        _ => Ok(answer),
    }
}

/// Lowers the degree of developable faces and thins out their knots: each ruled developable face becomes strips from
/// cubic splines that end at its border, within the tolerance at its rulings; how far strips and faces are apart elsewhere, both
/// ways, is proven and told. Faces that are not ruled developables are named as skipped.
///
/// # Errors
/// See [`ElementFitError`].
///
/// # Example
/// ```
/// let pipe = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let options = torse::ElementFitOptions { rulings_of_face: 24, ..torse::ElementFitOptions::new(0.5, "pipe") };
/// assert!(torse::fit_faces(&pipe.faces, &[], &options, &torse::Control::default())?.patchwork().panels.len() > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_faces(
    faces: &[Face],
    skipped: &[Skipped],
    options: &ElementFitOptions,
    control: &Control,
) -> Result<Answer, ElementFitError> {
    let mut left = skipped.to_vec();
    let before = left.len();
    // How far their trims keep from the file's edges is part of what is proven.
    let faces = &assess_trims(faces.to_vec(), options.tolerance).faces[..];
    let mut sequences = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        let name = if face.name.is_empty() { format!("F{:02}", i + 1) } else { face.name.clone() };
        match GivenFace::of(face, &name, options.rulings_of_face.max(FEWEST), options.tolerance) {
            Ok(mut given) => {
                let estimates = vec![std::mem::take(&mut given.elements)];
                sequences.push(ElementSequence { name, estimates, face: Some(given) });
            }
            Err(reason) => left.push(Skipped::of_face(face, Reason::of(Item::Named(name), reason))),
        }
    }
    if sequences.is_empty() {
        let reason = left.get(before).map_or_else(|| "no faces".into(), words::left_out);
        return Err(ElementFitError::NoFace { count: faces.len(), reason });
    }
    let mut out = run(sequences, left.clone(), Sort::Rulings, &[], (options, control))?;
    out.claims.extend(left_out(&left));
    Ok(out)
}

/// Fits strips to sequences, has them judged and lays them flat; `rulings` are those that are given, in their order.
fn run(
    sequences: Vec<ElementSequence>,
    skipped: Vec<Skipped>,
    sort: Sort,
    rulings: &[[Vec3; 2]],
    (options, control): (&ElementFitOptions, &Control),
) -> Result<Answer, ElementFitError> {
    let clock = Instant::now();
    let what = sort.many();
    if !is_tolerance(options.tolerance) {
        return Err(ElementFitError::Tolerance(options.tolerance));
    }
    options.limits.as_ref().map_or(Ok(()), RegressionLimits::check)?;
    Loose::check(extent(&sequences), options.tolerance)?;
    let asked = options.asked();
    let mut made = Made { skipped, ends: ends::Ends::of(rulings), ..Made::default() };
    let count = sequences.len();
    for (k, mut sequence) in sequences.into_iter().enumerate() {
        checked(&mut sequence, options)?;
        control.report("fitting", k as f64 / count as f64, sequence.name.clone());
        let left = options.max_strips.saturating_sub(made.strips.len());
        let strips = if sequence.face.is_some() { strips_of_face } else { strips_of_sequence };
        let mut found = strips(&mut sequence, left, &asked, control);
        let offset = made.all.len();
        for (i, strip) in found.strips.iter_mut().enumerate() {
            strip.name = format!("A-{:02}", made.strips.len() + i + 1);
        }
        made.ends.add(&found, sequence.face.as_ref(), options.tolerance);
        let of = (sequence.name != what).then(|| sequence.name.clone());
        made.became.extend(sequence.face.map(|face| {
            let became = match found.strips.first() {
                Some(only) if found.is_face => Became::Itself(only.name.clone()),
                Some(_) => Became::Strips(reached(&found.strips)),
                None => Became::Nothing,
            };
            FaceNote { face: sequence.name, given: face.size, became }
        }));
        let missed = found.missed.into_iter();
        made.skipped.extend(missed.map(|(range, reason)| {
            let range = if of.is_none() { range.start + offset..range.end + offset } else { range };
            let item = Item::Elements { row: of.clone(), sort: sort.given(), range };
            Skipped::from(Reason::of(item, reason))
        }));
        made.strips.append(&mut found.strips);
        made.all.append(&mut found.elements);
    }
    Ok(assessed(made, sort, options, control, clock))
}

/// Refuses elements that cannot be used; the others are oriented alike, and hold their rulings where these are to be kept.
fn checked(sequence: &mut ElementSequence, options: &ElementFitOptions) -> Result<(), ElementFitError> {
    for elements in &mut sequence.estimates {
        if let Some(index) = elements.iter().position(|e| !e.is_usable()) {
            return Err(ElementFitError::Element { index });
        }
        let largest = elements.iter().flat_map(|e| e.ends).map(|x| x.amax()).fold(0.0, f64::max);
        if let Some(fault) = Coarse::of(largest, options.tolerance) {
            return Err(fault.into());
        }
        orient(elements);
        if options.fix_ends {
            square(elements);
        }
    }
    Ok(())
}

/// Diagonal of the box around all that sequences hold, regions of interest included, mm.
fn extent(sequences: &[ElementSequence]) -> f64 {
    let mut b = BBox::empty();
    for e in sequences.iter().flat_map(|r| r.estimates.iter().flatten()) {
        for p in e.ends {
            b.include(&p.add_scalar(e.radius));
            b.include(&p.add_scalar(-e.radius));
        }
    }
    b.diagonal()
}
