//! A developable face as a panel: on its own rulings, to be seen in space and written for CAD; and, where its map to the plane
//! has no closed form, as a torse near it, to be laid flat through that with a proof of both steps.

use super::super::build::build;
use crate::brep::face::Face;
use crate::brep::recognised_surface::{bounds, recognise, RecognisedSurface};
use crate::brep::rulings::Rulings;
use crate::certify::flat::{flat, FlatCertificate};
use crate::certify::Certificate;
use crate::control::Control;
use crate::fit::near::exact::{exact, ExactOptions};
use crate::fit::panels::on_rulings::OnRulings;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::pattern::Pattern;
use crate::search::cover::Cover;
use crate::torse::form::PanelKind;
use std::sync::Arc;

/// Turn of the normal (rad) from line to line of the triangles, about 3°.
const TURN: f64 = 0.05;
/// Share of the face's extent within which parameter lines must be straight.
const STRAIGHT: f64 = 1e-6;
/// Share of the face's extent that trims may be off on the panel and in space.
const TRIM: f64 = 5e-8;

/// Turn of the normal (rad) of one panel at most: a little below half a turn.
const MOST_TURN: f64 = 2.5;
/// Shares of the tolerance: closer than the first a panel that is laid flat need not be, farther than the second it may not
/// be; trims and the proof's own slack need the rest.
const CLOSE: (f64, f64) = (0.01, 0.5);

/// A face with its panel. `None` where the face has no straight parameter lines or no triangles, and where its border cannot be
/// carried over.
pub(crate) fn face_panel(face: &Face, name: &str) -> Option<Patchwork> {
    let (cover, rulings, _) = triangles(face)?;
    let kind = match recognise(face) {
        RecognisedSurface::Plane(_) => PanelKind::Plane,
        RecognisedSurface::Cylinder { .. } | RecognisedSurface::GeneralCylinder { .. } => PanelKind::Cylinder,
        RecognisedSurface::Cone { .. } | RecognisedSurface::GeneralCone { .. } => PanelKind::Cone,
        RecognisedSurface::TangentSurface | RecognisedSurface::Curved(_) => PanelKind::Torse,
    };
    let panel = OnRulings::new(face, &rulings)?.panel(name, kind, TRIM * face.surface.bbox().diagonal())?;
    Some(Patchwork {
        faces: vec![face.clone()],
        partitions: vec![cover.partition],
        panels: vec![panel],
        seam_count: 0,
        joint_count: 0,
    })
}

/// A face laid flat through its panel.
pub(crate) struct LaidFace {
    /// The face with its one panel.
    pub patchwork: Patchwork,
    /// The panel against the face, proven.
    pub certificate: Certificate,
    /// The panel laid flat.
    pub pattern: Pattern,
    /// The pattern against the panel, proven.
    pub flat: FlatCertificate,
}

/// A developable face laid flat through one panel, both proven within `tolerance` (mm). `None` where it is not ruled by
/// parameter lines, turns too far for one panel, or one of the proofs fails.
pub(crate) fn laid_face(face: &Face, name: &str, tolerance: f64) -> Option<LaidFace> {
    let asked = ExactOptions { goal: CLOSE.0 * tolerance, accepted: CLOSE.1 * tolerance };
    let (mut cover, rulings, turn) = triangles(face)?;
    let fit = (turn <= MOST_TURN).then(|| exact(&rulings, &cover.region(0).samples(), &asked))??;
    cover.panels.insert(0, Arc::new(fit));
    let mut built = build(0, &cover, tolerance).0;
    let [pattern] = <[Pattern; 1]>::try_from(built.patterns).ok()?;
    let pattern = Pattern { name: name.to_owned(), ..pattern };
    built.patchwork.panels.iter_mut().for_each(|p| name.clone_into(&mut p.strip.name));
    let flat = flat(&built.patchwork, std::slice::from_ref(&pattern), tolerance, &Control::default()).pop()?;
    let proven = built.certificate.certified && flat.holds();
    proven.then_some(LaidFace { patchwork: built.patchwork, certificate: built.certificate, pattern, flat })
}

/// Triangles of a face along its rulings, these, and by how much the normal turns over them (rad).
fn triangles(face: &Face) -> Option<(Cover, Rulings<'_>, f64)> {
    let extent = face.surface.bbox().diagonal();
    let rulings = Rulings::of(&face.surface, bounds(face), STRAIGHT * extent)?;
    let (mut across, mut whole): (Vec<f64>, f64) = (Vec::new(), 0.0);
    for w in rulings.breaks().windows(2) {
        let hair = STRAIGHT * (w[1] - w[0]);
        let turn = match (rulings.line(w[0] + hair), rulings.line(0.5 * (w[0] + w[1])), rulings.line(w[1] - hair)) {
            (Some(a), Some(m), Some(b)) => a.normal.angle(&m.normal) + m.normal.angle(&b.normal),
            _ => 0.0,
        };
        whole += turn;
        // Two angles: no more than a whole turn.
        let count = ((turn / TURN).ceil() as usize).max(1);
        across.extend((0..count).map(|k| w[0] + (w[1] - w[0]) * k as f64 / count as f64));
    }
    across.push(rulings.range().1);
    let (lo, hi) = rulings.reach();
    let [u, v] = rulings.lines(across, vec![lo, hi]);
    let cover = Cover::on_lines(face, u, v).ok()?;
    Some((cover, rulings, whole))
}
