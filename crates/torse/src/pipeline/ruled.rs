//! `ruled`: strips of straight lines over faces, not developable: for formwork, hot wire and straight beams.
//!
//! Reads like the page that describes it: judge the trims, find strips face by face, take their rulings.

use crate::answer::note::Note;
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Job};
use crate::brep::face::Face;
use crate::certify;
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::control::Control;
use crate::draw::picture::{direction, values, Caption};
use crate::draw::raster::Image;
use crate::draw::scene::{PanelShape, Scene};
use crate::geom::coarse::Loose;
use crate::geom::mesh::Mesh;
use crate::geom::{BBox, Vec3};
use crate::io::rulings::StripRuling;
use crate::io::words;
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Panel, Patchwork};
use crate::patchwork::part::Part;
use crate::reason::{FaceReason, Reason};
use crate::search::apex::{beside_apexes, Hair};
use crate::search::ruled::ruled_face;
use crate::search::trims::{assess_trims, AssessedTrims};
use std::time::Instant;

pub use crate::search::ruled::RuledOptions as Strips;

/// What the job is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct RuledOptions {
    /// Tolerance, width and sort of strips; no default tolerance.
    pub strips: Strips,
    /// Name of the input, for the files.
    pub input: String,
    /// Distance of rulings in tables and drawings, mm; default a sixtieth of the model's diagonal.
    pub spacing: Option<f64>,
}

impl RuledOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self { strips: Strips { tolerance, width: None, conoidal: false }, input: "model".into(), spacing: None }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuledError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A length that is none.
    #[error("the {name} must be a positive length, not {value} mm")]
    Length {
        /// Which one.
        name: &'static str,
        /// Asked for, mm.
        value: f64,
    },
    /// Nothing that could have strips.
    #[error("no face has ruled strips; {0}")]
    Nothing(String),
}

/// The answer of the job, with what only it has.
#[derive(Clone, Debug)]
pub struct RuledAnswer {
    /// Strips and their proof.
    pub answer: Answer,
    /// Rulings between the borders of every strip.
    pub rulings: Vec<StripRuling>,
    /// For every conoidal strip the unit normal of the plane that its rulings are parallel to, panel by panel; `None` for
    /// other strips.
    pub directing: Vec<Option<Vec3>>,
    /// All faces coloured by the sign of their curvature, see [`curvature_picture`].
    pub map: Vec<Mesh>,
}

/// Rulings are this many to the diagonal of the model, and on a strip at most so many.
const RULINGS: (f64, usize) = (60.0, 5000);

/// Ruled strips over faces.
///
/// *Guarantee*. `Certified` only if faces and strips are proven to be within the tolerance of each other, both ways, the
/// strips as exported and inside their trimming curves. What bends to one side is left out and named with its area; its
/// strips are then as good as they are proven, but the whole is not certified. *Not* guaranteed: a fewest number of
/// strips; kinks, which are measured.
///
/// # Errors
/// See [`RuledError`].
///
/// # Example
/// ```
/// use torse::brep::face::Face;
/// use torse::{geom::Vec3, spline::{knots::Knots, surface::Surface}};
/// let line = Knots::clamped(1, &[0.0, 1.0])?;
/// let point = |x: f64, y: f64| Vec3::new(2000.0 * x, 2000.0 * y, 800.0 * x * y);
/// let corners = [point(0.0, 0.0), point(0.0, 1.0), point(1.0, 0.0), point(1.0, 1.0)];
/// let face = Face::untrimmed(Surface::new(line.clone(), line, &corners, None)?);
/// let found = torse::ruled(vec![face], vec![], &torse::RuledOptions::new(10.0), &torse::Control::default())?;
/// assert_eq!((found.answer.status(), found.answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of_faces(
    faces: Vec<Face>,
    mut skipped: Vec<Skipped>,
    options: &RuledOptions,
    control: &Control,
) -> Result<RuledAnswer, RuledError> {
    let start = Instant::now();
    let tolerance = options.strips.tolerance;
    let lengths = [("tolerance", Some(tolerance)), ("width", options.strips.width), ("spacing", options.spacing)];
    for (name, value) in lengths {
        if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
            return Err(RuledError::Length { name, value });
        }
    }
    let boxes: Vec<BBox> = faces.iter().map(|f| f.surface.bbox()).collect();
    let bbox = BBox::of(boxes.iter().flat_map(|b| [&b.min, &b.max]));
    Loose::check(bbox.diagonal(), tolerance)?;
    let AssessedTrims { faces, missed, .. } = assess_trims(faces, tolerance);
    let faces = beside_apexes(faces, Hair::FINE, tolerance);
    let (mut patchwork, mut certificates) = (Patchwork::default(), Vec::new());
    let (mut missing, mut map, mut directing, mut first) = (missed, Vec::new(), Vec::new(), None);
    let mut kink = 0.0f64;
    for (k, face) in faces.iter().enumerate() {
        control.report("ruled strips", k as f64 / faces.len() as f64, format!("face {} of {}", k + 1, faces.len()));
        if control.stopped() && k > 0 {
            missing.push(FaceReason::EndedBefore { entity: face.entity }.into());
            break;
        }
        match ruled_face(patchwork.faces.len(), face, &options.strips, control) {
            Ok(found) => {
                for (reason, area) in found.left {
                    first.get_or_insert_with(|| reason.to_string());
                    let reason = Reason::error(&reason);
                    skipped.push(Skipped::of_file(face.entity, reason, Some(area)));
                }
                kink = kink.max(found.kink_estimate);
                map.push(found.map);
                directing.extend(found.directing);
                patchwork.append(found.patchwork);
                // A face that was left out altogether has nothing to prove.
                certificates.extend(found.certificate);
            }
            Err(e) => skipped.push(Skipped::of_face(face, Reason::error(&e))),
        }
    }
    if patchwork.panels.is_empty() {
        let why =
            first.or_else(|| skipped.first().map(words::left_out)).unwrap_or_else(|| "the file holds no face".into());
        return Err(RuledError::Nothing(why));
    }
    let certificate = certify::join(&patchwork, certificates, tolerance);
    let spacing = options.spacing.unwrap_or(bbox.diagonal() / RULINGS.0);
    let rulings: Vec<StripRuling> =
        patchwork.panels.iter().zip(&directing).flat_map(|(p, m)| rulings_of(p, spacing, *m)).collect();
    let longest = rulings.iter().map(|r| (r.ends[1] - r.ends[0]).norm()).fold(0.0, f64::max);
    let kink = certificate.seams.iter().map(|s| s.kink_range_estimate.1).fold(kink, f64::max).to_degrees();
    let whole = Subject::Whole;
    let mut claims: Vec<Claim> = left_out(&skipped).into_iter().collect();
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(certificate.claims());
    claims.extend([
        Claim::count(Counted::Strips, whole, patchwork.panels.len()),
        Claim::measured(What::Kink, whole, kink),
        Claim::measured(What::LongestRuling, whole, longest),
    ]);
    let part = |(k, p): (usize, &Panel)| Part { name: p.strip.name.clone(), first: k, count: 1, missing: None };
    let parts = patchwork.panels.iter().enumerate().map(part).collect();
    let answer = Answer {
        claims,
        patchwork,
        certificate: Some(certificate),
        parts,
        skipped,
        notes: vec![Note::NotDevelopable],
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Ruled, &options.input, tolerance)
    };
    Ok(RuledAnswer { answer, rulings, directing, map })
}

/// Rulings of a panel between its borders, about `spacing` (mm) apart.
fn rulings_of(panel: &Panel, spacing: f64, parallel_to: Option<Vec3>) -> Vec<StripRuling> {
    let clipped = ClippedRulings::new(panel);
    let (a, b) = clipped.range();
    let patch = &panel.strip.patch;
    // Counted along the middle of the strip.
    const NODES: usize = 200;
    let node = |k: usize| a + (b - a) * k as f64 / NODES as f64;
    let length: f64 = (0..NODES).map(|k| (patch.point(node(k + 1), 0.5) - patch.point(node(k), 0.5)).norm()).sum();
    let count = ((length / spacing).ceil() as usize).clamp(2, RULINGS.1);
    let ends = (0..count).flat_map(|k| {
        let s = a + (b - a) * (k as f64 + 0.5) / count as f64;
        clipped.at(s).into_iter().map(move |(t, r)| [t, r].map(|t| patch.point(s, t)))
    });
    let name = &panel.strip.name;
    ends.enumerate().map(|(k, ends)| StripRuling { strip: name.clone(), number: k + 1, ends, parallel_to }).collect()
}

/// The map of curvature: blue where faces are saddle-shaped and straight lines lie near, red where they bend to one side.
pub fn curvature_picture(found: &RuledAnswer) -> Image {
    let panels = found.map.iter().map(|mesh| PanelShape { mesh: mesh.clone(), ..PanelShape::default() }).collect();
    let scene = Scene { panels, ..Scene::default() };
    let caption = Caption {
        title: found.answer.input.clone(),
        note: "Gauss curvature: blue saddles (-1), red domes (+1)".into(),
        ..Caption::default()
    };
    values(&scene, &direction(&scene), 1.0, "curvature", &caption)
}
