//! Floor 8: what a job answers with: the one record that files, reports and pictures are made from.

pub(crate) mod cone_panels;
pub(crate) mod joints;
pub mod marks;
pub mod note;
pub(crate) mod orders;
pub mod presentation;
pub mod shapes;
pub mod shop;
pub mod skipped;
pub mod sweep;

use crate::certify::claim::{Claim, Status, Subject, What};
use crate::certify::flat::FlatCertificate;
use crate::certify::written::WrittenCertificate;
use crate::certify::Certificate;
use crate::develop::unfold::joints::PartJoint;
use crate::develop::unfold::part::SheetPart;
use crate::develop::unfold::placed_face::PlacedFace;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::unit::LengthUnit;
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::reason::Reason;
use crate::search::build::AlongCurve;
use crate::search::strips::cut::Laid;
use crate::torse::cone::part::ConeBody;
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use note::Note;
use shop::Shop;
use skipped::Skipped;
use std::collections::BTreeSet;

/// Which job answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Job {
    /// Panels over faces.
    Approximate,
    /// Developable faces as cones, cylinders and planes.
    Cones,
    /// Strips near measured points, rulings or planes.
    Fit,
    /// Developables of the convex hull of curves.
    Hull,
    /// The developable between two curves.
    Loft,
    /// The developable through one curve.
    Net,
    /// Plane quadrilaterals.
    Planarise,
    /// Ruled strips, not developable.
    Ruled,
    /// Strips that one can pull on.
    Shape,
    /// Sheet and developable faces laid flat.
    Unroll,
}

impl Job {
    /// All jobs.
    const ALL: [Self; 10] = [
        Self::Approximate,
        Self::Cones,
        Self::Fit,
        Self::Hull,
        Self::Loft,
        Self::Net,
        Self::Planarise,
        Self::Ruled,
        Self::Shape,
        Self::Unroll,
    ];

    /// The job with a [`Job::name`].
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|job| job.name() == name)
    }

    /// Lower-case name, that of the command.
    pub fn name(self) -> &'static str {
        match self {
            Self::Approximate => "approximate",
            Self::Cones => "cones",
            Self::Fit => "fit",
            Self::Hull => "hull",
            Self::Loft => "loft",
            Self::Net => "net",
            Self::Planarise => "planarise",
            Self::Ruled => "ruled",
            Self::Shape => "shape",
            Self::Unroll => "unroll",
        }
    }
}

/// A curve to be seen with the panels: a rail, a given line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guide {
    /// Name.
    pub name: String,
    /// Points along it, mm.
    pub points: Vec<Vec3>,
}

/// A shape on the way to the answer, for an animation.
#[derive(Clone, Debug)]
pub struct Stage {
    /// What it is, in a few words.
    pub caption: String,
    /// Its strips; as many as the answer has panels, in the same order.
    pub strips: Vec<Strip>,
}

/// Measured points with a value each, for a map of all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointMap {
    /// Places, mm.
    pub places: Vec<Vec3>,
    /// Values, in the unit of the colours; one per place.
    pub values: Vec<f64>,
    /// Index of the point that is farthest from the panels.
    pub worst: Option<usize>,
}

/// Chains of cones, cylinders and planes whose patches the panels of an answer are.
#[derive(Clone, Debug, Default)]
pub struct Cones {
    /// The chains, trimmed where faces are, in the order of the parts before cutting.
    pub bodies: Vec<ConeBody>,
    /// Body and piece of every panel.
    pub pieces: Vec<(usize, usize)>,
}

/// How drawings for the cutter are written.
///
/// # Example
/// ```
/// use torse::geom::unit::LengthUnit;
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let mut answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// answer.cut.unit = LengthUnit::Inch;
/// answer.cut.threedm = true;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// assert!(files.iter().any(|(name, _)| name == "panels.3dm"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutFiles {
    /// Unit of drawings and tables; default mm. Reports and models are in mm.
    pub unit: LengthUnit,
    /// Whether every part gets a drawing of its own besides the common one; default no.
    pub one_per_part: bool,
    /// Whether the panels are written as IGES too; default no.
    pub iges: bool,
    /// Whether the panels are written as a Rhino archive too; default no.
    pub threedm: bool,
}

/// The answer of a job: what was made, what is said of it, and what is missing. Lengths in mm.
///
/// # Example
/// ```
/// use torse::certify::claim::What;
/// let model = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let answer = torse::approximate(&model, &torse::Approximate::new(0.5))?;
/// let deviation = answer.claim(What::Deviation).expect("covers have one");
/// assert!(deviation.value() <= answer.tolerance() && answer.status() == torse::Status::Certified);
/// for (part, flat) in answer.parts.iter().zip(answer.patterns()) {
///     assert_eq!(part.name, flat.name);
///     assert!((flat.area - flat.area_in_space).abs() < 1e-3 * flat.area, "sheet is bent, not stretched");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Answer {
    /// The job.
    pub job: Job,
    /// Name of the input, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub(crate) tolerance: f64,
    /// What is said of the whole and of single panels; the status is computed from these and from nothing else.
    pub(crate) claims: Vec<Claim>,
    /// Panels, and the faces that they cover if there are any: then every panel covers a part of one. Neighbours within a
    /// part follow each other.
    pub(crate) patchwork: Patchwork,
    /// Proof of panels that cover faces.
    pub(crate) certificate: Option<Certificate>,
    /// Parts as they are cut, in the order of their panels.
    pub parts: Vec<Part>,
    /// Flat patterns, not yet laid out side by side (each near its own origin); `panel` is the index of the part.
    pub(crate) patterns: Vec<Pattern>,
    /// Thickness and bends of sheet metal, one for each pattern; empty for jobs that know no thickness.
    pub sheets: Vec<SheetPart>,
    /// Faces of the input where they lie in parts that are laid flat by the faces' own maps, in the order of the patterns; none of others.
    pub laid_faces: Vec<Vec<PlacedFace>>,
    /// Joints of parts that were laid flat, which share an edge of their file.
    pub joints: Vec<PartJoint>,
    /// What was proven about flat patterns, in the same order; empty where lengths were only measured.
    pub(crate) flat: Vec<FlatCertificate>,
    /// Files that were read back, by name, and whether they hold what was judged; empty before anything is written.
    pub(crate) written: Vec<(String, WrittenCertificate)>,
    /// Exact surfaces for CAD in place of the panels' patches.
    pub(crate) cones: Option<Cones>,
    /// Values for colours, one set per panel; empty if there are none, or if panels show their distance from faces.
    pub fields: Vec<PanelField>,
    /// What the colours mean.
    pub meaning: FieldMeaning,
    /// Measured points; none for jobs that have no points.
    pub points: PointMap,
    /// Rails and other given curves.
    pub guides: Vec<Guide>,
    /// Shapes on the way to the answer, of jobs that move.
    pub stages: Vec<Stage>,
    /// Panels that were laid along curves, in order of the panels.
    pub along: Vec<AlongCurve>,
    /// Panels that do not keep the limits of sheet and material, in order.
    pub beyond_limits: Vec<usize>,
    /// Items of the input that could not be used.
    pub skipped: Vec<Skipped>,
    /// What people should know of the input and the job.
    pub notes: Vec<Note>,
    /// What the shop is told of sheet and work.
    pub shop: Shop,
    /// How drawings are written.
    pub cut: CutFiles,
    /// Wall time of reading, fitting and proving, seconds.
    pub seconds: f64,
}

impl Guide {
    /// A rail, by points along it.
    pub(crate) fn of(rail: &Rail) -> Self {
        Self { name: rail.name.clone(), points: rail.samples(GUIDE_POINTS) }
    }
}

/// Points of a guide.
const GUIDE_POINTS: usize = 200;

impl Answer {
    /// An answer that holds strips laid flat and nothing else yet.
    pub(crate) fn of_flat(job: Job, input: &str, tolerance: f64, laid: Laid) -> Self {
        let Laid { parts, patterns, proofs, .. } = laid;
        Self { parts, patterns, flat: proofs, ..Self::new(job, input, tolerance) }
    }

    /// An answer of strips and patterns that are only shown: nothing is said of them.
    pub fn shown(job: Job, input: &str, tolerance: f64, strips: Vec<Strip>, patterns: Vec<Pattern>) -> Self {
        Self { patchwork: Patchwork::of_strips(strips), patterns, ..Self::new(job, input, tolerance) }
    }

    /// An answer that holds nothing yet. `input` names the input without folder, `tolerance` is in mm.
    pub(crate) fn new(job: Job, input: &str, tolerance: f64) -> Self {
        Self {
            job,
            input: input.into(),
            tolerance,
            claims: Vec::new(),
            patchwork: Patchwork::default(),
            certificate: None,
            parts: Vec::new(),
            patterns: Vec::new(),
            sheets: Vec::new(),
            laid_faces: Vec::new(),
            joints: Vec::new(),
            flat: Vec::new(),
            written: Vec::new(),
            cones: None,
            fields: Vec::new(),
            meaning: FieldMeaning::default(),
            points: PointMap::default(),
            guides: Vec::new(),
            stages: Vec::new(),
            along: Vec::new(),
            beyond_limits: Vec::new(),
            skipped: Vec::new(),
            notes: Vec::new(),
            shop: Shop::default(),
            cut: CutFiles::default(),
            seconds: 0.0,
        }
    }

    /// Tolerance asked for, mm.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Panels, and the faces that they cover if there are any.
    pub fn patchwork(&self) -> &Patchwork {
        &self.patchwork
    }

    /// Proof of panels that cover faces.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.certificate.as_ref()
    }

    /// Flat patterns, not yet laid out side by side; `panel` of each is the index of its part.
    pub fn patterns(&self) -> &[Pattern] {
        &self.patterns
    }

    /// What was proven about the flat patterns, in the same order; empty where lengths were only measured.
    pub fn flat(&self) -> &[FlatCertificate] {
        &self.flat
    }

    /// Files that were read back, by name, and whether they hold what was judged; empty before anything is written.
    pub fn written(&self) -> &[(String, WrittenCertificate)] {
        &self.written
    }

    /// Exact surfaces for CAD in place of the panels' patches.
    pub fn cones(&self) -> Option<&Cones> {
        self.cones.as_ref()
    }

    /// How the job ended.
    pub fn status(&self) -> Status {
        Status::of(&self.claims)
    }

    /// Everything that is said of the whole and of single panels.
    pub fn claims(&self) -> &[Claim] {
        &self.claims
    }

    /// Says what is wrong with the whole: the answer is not certified any more.
    pub fn object(&mut self, reason: impl Into<Reason>) {
        self.claims.push(Claim::objection(Subject::Whole, reason));
    }

    /// What is said of the whole or of a panel, without objections.
    pub fn claims_of(&self, subject: Subject) -> impl Iterator<Item = &Claim> {
        self.claims.iter().filter(move |c| {
            c.subject() == subject && !matches!(c.what(), What::Objection | What::InPart | What::LeftOut)
        })
    }

    /// The claim about something of the whole, if there is one.
    pub fn claim(&self, what: What) -> Option<&Claim> {
        self.claims_of(Subject::Whole).find(|c| c.what() == what)
    }

    /// The patches of all panels, with names and kinds.
    pub fn strips(&self) -> impl Iterator<Item = &Strip> {
        self.patchwork.panels.iter().map(|p| &p.strip)
    }

    /// The part that a panel belongs to, by its index.
    pub fn part_of(&self, panel: usize) -> Option<usize> {
        self.parts.iter().position(|p| (p.first..p.first + p.count).contains(&panel))
    }

    /// The flat pattern of a part.
    pub fn pattern_of(&self, part: usize) -> Option<&Pattern> {
        self.patterns.iter().find(|p| p.panel == part)
    }

    /// The names that the parts of the model have in its file from which a part is made, each once; none where they have none.
    pub fn sources_of(&self, part: usize) -> Vec<&str> {
        let panels = self.parts.get(part).map_or(0..0, |p| p.first..p.first + p.count);
        let faces = panels.filter_map(|k| self.patchwork.face_of(self.patchwork.panels.get(k)?));
        let names: BTreeSet<&str> = faces.map(|f| f.part.as_str()).filter(|name| !name.is_empty()).collect();
        names.into_iter().collect()
    }

    /// Whether the model consists of several parts with names of their own.
    pub fn has_named_parts(&self) -> bool {
        let names: BTreeSet<&str> =
            self.patchwork.faces.iter().map(|f| f.part.as_str()).filter(|name| !name.is_empty()).collect();
        names.len() > 1
    }

    /// What was proven of the flat pattern of a part.
    pub fn flat_of(&self, part: usize) -> Option<&FlatCertificate> {
        self.flat.iter().find(|f| f.panel() == part)
    }

    /// Whether the panels are a cover of faces, judged against these. Those of parts that were only laid flat are not.
    pub fn covers_faces(&self) -> bool {
        !self.patchwork.faces.is_empty() && self.job != Job::Unroll
    }

    /// Whether anything of it is laid flat.
    pub fn lays_flat(&self) -> bool {
        match self.job {
            Job::Ruled => false,
            Job::Shape => self.parts.is_empty() || !self.patterns.is_empty(),
            _ => true,
        }
    }

    /// End of the colour scale.
    pub fn colour_limit(&self) -> f64 {
        if self.meaning.limit > 0.0 {
            self.meaning.limit
        } else {
            self.tolerance
        }
    }
}

#[cfg(test)]
mod laws;
