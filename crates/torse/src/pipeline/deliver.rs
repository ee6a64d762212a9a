//! Results into files: what holds geometry is written, read back and compared with what was judged; then pictures and
//! reports, which tell what came of it.

use crate::answer::marks::Marks;
use crate::answer::presentation::present_marked;
use crate::answer::Answer;
use crate::certify::claim::{Claim, Demand, Evidence, Subject, UpperBound, What};
use crate::certify::written::{self, WrittenCertificate};
use crate::certify::{written_cones, written_strips};
use crate::io::bundle::{self, part_files, BundleError, Contents, File, CONES, PANELS};
use crate::io::{drawings, step};
use crate::num::parallel;
use crate::reason::{Item, Reason, WrittenFault};
use crate::torse::strip::Strip;
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

/// All files of an answer. `time` stamps the STEP header: `2026-11-21T14:30:00`.
///
/// *Guarantee*: the answer stays certified only if the bytes of the files, read back, are what was judged.
///
/// # Errors
/// Data that a format cannot hold.
///
/// # Example
/// ```
/// let plate = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let mut answer = torse::approximate(&plate, &torse::Approximate::new(0.5))?;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// assert!(files.iter().any(|(name, bytes)| name == "patterns.dxf" && !bytes.is_empty()));
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn files(answer: &mut Answer, time: &str) -> Result<Vec<File>, BundleError> {
    let out = Mutex::new(BTreeMap::new());
    each_file(answer, time, &|name, contents| {
        let (name, bytes) = bundle::file(name, contents)?;
        out.lock().unwrap_or_else(PoisonError::into_inner).insert(name, bytes);
        Ok::<(), BundleError>(())
    })?;
    Ok(out.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect())
}

/// As [`files`], but hands over the name of each file and what writes its contents, from several threads, so that what is long is
/// never in memory. A file may be handed over twice, the second time with marks of what must not be cut: what comes last counts.
///
/// # Errors
/// As [`files`], and those of `take`.
pub fn each_file<E: From<BundleError> + Send>(
    answer: &mut Answer,
    time: &str,
    take: &(dyn Fn(&str, Contents) -> Result<(), E> + Sync),
) -> Result<(), E> {
    // Marks are no part of what is judged: first as if there were none, then with those that came of it. Where some are sure to
    // come, files without them are not handed over.
    let marked = Marks::of(answer).any();
    let mut shown = present_marked(answer, Marks::none(answer));
    let alone = alone(answer);
    let judged = |name: &str, contents: Contents| {
        let mut back = ReadBack::of(name);
        if marked {
            contents(&mut back).map_err(|source| BundleError::Write { file: name.to_owned(), source })?;
        } else {
            take(name, &mut |out| contents(&mut Both(&mut *out, &mut back)))?;
        }
        Ok::<Found, E>(back.found(answer, &alone, name))
    };
    let written = bundle::each_geometry(answer, &shown, time, &judged)?;
    conclude(answer, written);
    let marks = Marks::of(answer);
    if marks.any() {
        shown = present_marked(answer, marks);
        bundle::each_geometry(answer, &shown, time, take)?;
    }
    bundle::reports(answer, &shown, &mut |name, contents| take(name, contents))
}

/// What a drawing may be off patterns that are only measured, as a share of the tolerance.
const DRAWN_SHARE: f64 = 1e-3;

/// Compares files with what was judged; what does not agree, takes a proven distance beyond its limit, or is off by more
/// than the tolerance leaves, ends the certificate.
pub fn judge(answer: &mut Answer, files: &[File]) {
    let alone = alone(answer);
    let written = parallel::map(files.iter(), |(name, bytes)| {
        let mut back = ReadBack::of(name);
        back.take(bytes);
        back.found(answer, &alone, name)
    });
    conclude(answer, written);
}

/// A file read back, by its name.
type Found = Option<(String, WrittenCertificate)>;

/// The patterns that are alone in files, by the names of these.
fn alone(answer: &Answer) -> HashMap<String, usize> {
    let patterns = answer.patterns.iter().filter(|_| answer.cut.one_per_part);
    part_files(patterns.map(|p| p.name.as_str())).into_iter().zip(0..).collect()
}

/// A file that is read back while it is written.
enum ReadBack {
    Dxf(drawings::Dxf),
    Svg(drawings::Svg),
    /// Panels for CAD, which are read when they are all there.
    Panels(Vec<u8>),
    /// A copy that is not compared.
    Copy,
}

impl ReadBack {
    fn of(name: &str) -> Self {
        if name == PANELS || name == CONES {
            Self::Panels(Vec::new())
        } else if name.ends_with(".dxf") {
            Self::Dxf(drawings::Dxf::default())
        } else if name.ends_with(".svg") {
            Self::Svg(drawings::Svg::default())
        } else {
            Self::Copy
        }
    }

    fn take(&mut self, bytes: &[u8]) {
        match self {
            Self::Dxf(dxf) => dxf.take(bytes),
            Self::Svg(svg) => svg.take(bytes),
            Self::Panels(all) => all.extend_from_slice(bytes),
            Self::Copy => {}
        }
    }

    /// What is in the file, against what was judged.
    fn found(self, answer: &Answer, alone: &HashMap<String, usize>, name: &str) -> Found {
        let pieces = match self {
            Self::Panels(bytes) => return Some((name.to_owned(), panels(answer, &bytes))),
            Self::Dxf(dxf) => dxf.end(),
            Self::Svg(svg) => svg.end(),
            Self::Copy => return None,
        };
        let patterns = match alone.get(name) {
            Some(&part) => &answer.patterns[part..=part],
            None => &answer.patterns,
        };
        Some((name.to_owned(), written::of(pieces, |pieces| written::drawing(patterns, pieces))))
    }
}

impl Write for ReadBack {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.take(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes to a file, and reads back what was written.
struct Both<'a>(&'a mut dyn Write, &'a mut ReadBack);

impl Write for Both<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.0.write(bytes)?;
        self.1.take(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// What came of all files: what does not agree, or is off too far, ends the certificate.
fn conclude(answer: &mut Answer, written: Vec<Found>) {
    answer.written = written.into_iter().flatten().collect();
    // What the patterns are off already leaves of what each may be; panels that cover faces have what writing moves among their
    // bounds. What is beyond its limit anyway is told of its part.
    let of_panels = answer.flat.iter().map(|f| answer.tolerance - f.drawing_bound());
    let proven = |c: &&Claim| c.what() == What::DrawingDistance && c.evidence() == Evidence::Proven && !c.is_broken();
    let left_of = |c: &Claim| match c.demand() {
        Demand::AtMost(limit) => limit - c.value(),
        _ => answer.tolerance - c.value(),
    };
    let of_parts = answer.claims.iter().filter(proven).map(left_of);
    let left = of_panels.chain(of_parts).filter(|d| d.is_finite()).reduce(f64::min);
    let left = left.unwrap_or(DRAWN_SHARE * answer.tolerance);
    let mut objections = Vec::new();
    for (name, found) in &answer.written {
        let off = Reason::from(WrittenFault::Moved(found.bound()));
        let reason = if let Some(reason) = found.reason() {
            Some(reason.clone())
        } else if name == PANELS || name == CONES {
            answer.claims.iter().any(|c| breaks(c, found.bound(), answer.cones.is_some())).then_some(off)
        } else {
            (found.bound() > left).then_some(off)
        };
        let file = || Item::Named(name.clone());
        objections.extend(reason.map(|r| Claim::objection(Subject::Whole, Reason::of(file(), r))));
    }
    let worst = UpperBound::largest(answer.written.iter().map(|(_, found)| found.proven()));
    answer.claims.push(Claim::at_most(What::WrittenDistance, Subject::Whole, worst));
    answer.claims.extend(objections);
}

/// The file of panels against what was judged.
fn panels(answer: &Answer, bytes: &[u8]) -> WrittenCertificate {
    if let Some(cones) = &answer.cones {
        return written::of(step::read::own::exact(bytes), |faces| written_cones::cones(&cones.bodies, faces));
    }
    if answer.certificate.as_ref().is_some_and(|c| !c.is_of(&answer.patchwork)) {
        return WrittenCertificate::refused(WrittenFault::OtherPanels);
    }
    if answer.patchwork.panels.iter().any(|p| !p.loops().is_empty()) {
        return written::of(step::read::own::faces(bytes), |faces| written::panels(&answer.patchwork, faces));
    }
    let strips: Vec<&Strip> = answer.patchwork.panels.iter().map(|p| &p.strip).collect();
    written::of(step::read::own::strips(bytes), |faces| written_strips::strips(&strips, faces))
}

/// Whether a proven distance that keeps to its limit would not any more if strips, or `cones`, moved by `off` (mm).
fn breaks(claim: &Claim, off: f64, cones: bool) -> bool {
    let distance = match claim.what() {
        What::FromCurve(_) | What::FromSide(_) | What::FromCurves | What::PointDistance | What::ElementDistance => true,
        What::TargetDistance(_) | What::BeyondOutline | What::FromMeasured => true,
        What::BeyondRulings | What::EndDistance | What::CentreDistance | What::FaceDistance => true,
        // Both sides may move.
        What::JoinGap(_) => return moved_beyond(claim, 2.0 * off),
        // Panels that cover faces have what writing moves among their bounds.
        What::Deviation => cones,
        _ => false,
    };
    distance && moved_beyond(claim, off)
}

/// Whether a proven distance that keeps to its limit would not if it grew by `off` (mm).
fn moved_beyond(claim: &Claim, off: f64) -> bool {
    match claim.demand() {
        Demand::AtMost(limit) if claim.evidence() == Evidence::Proven && !claim.is_broken() => {
            claim.value() + off > limit
        }
        _ => false,
    }
}
