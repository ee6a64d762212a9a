//! A developable face as panels: to be seen in space and written for CAD, and, where its map to the plane has no closed
//! form, to be laid flat through its panel with a proof of both steps.

use super::super::build::build;
use crate::brep::face::Face;
use crate::brep::rulings::Rulings;
use crate::certify::flat::{flat, FlatCertificate};
use crate::certify::Certificate;
use crate::control::Control;
use crate::fit::near::exact::{exact, ExactOptions};
use crate::fit::near::samples::Fit;
use crate::fit::panels::boundary::{panels, Assigned, BoundaryOptions};
use crate::patchwork::panel::{Panel, Patchwork};
use crate::patchwork::partition::Partition;
use crate::patchwork::pattern::Pattern;
use crate::search::cover::State;
use std::sync::Arc;

/// Turn of the normal (rad) from line to line of the triangles, about 3°.
const TURN: f64 = 0.05;
/// Lines across one span between knots at most.
const MOST_LINES: usize = 128;
/// Share of the face's extent within which parameter lines must be straight.
const STRAIGHT: f64 = 1e-6;
/// Shares of the face's extent: below the first a finer panel is of no use, up to the second it is one.
const NEAR: (f64, f64) = (1e-7, 1e-3);
/// Shares of the face's extent that trims may be off on the panel and in space.
const TRIM: (f64, f64) = (1e-5, 1e-7);

/// Turn of the normal (rad) of one panel at most: a little below half a turn.
const MOST_TURN: f64 = 2.5;
/// Shares of the tolerance: closer than the first a panel that is laid flat need not be, farther than the second it may not
/// be; trims and the proof's own slack need the rest.
const CLOSE: (f64, f64) = (0.01, 0.5);

/// Triangles of a face and its panels: one, or several where it turns far. `None` where the face has no straight parameter
/// lines or no triangles; panels are missing where their border cannot be carried over.
pub(crate) fn face_panels(face: &Face, name: &str) -> Option<(Partition, Vec<Panel>)> {
    let extent = face.surface.bbox().diagonal();
    let asked = ExactOptions { goal: NEAR.0 * extent, accepted: NEAR.1 * extent };
    let (state, fits) = fitted(face, &asked)?;
    let assigned: Vec<Assigned> =
        fits.iter().map(|(label, fit)| Assigned { label: *label, torse: &fit.torse, kind: fit.kind }).collect();
    let options = BoundaryOptions { trim_tolerance: TRIM.0 * extent, edge_tolerance: TRIM.1 * extent };
    let trim_edge = |a: u32, b: u32| state.partition.trim_edges.get(&(a, b)).copied().unwrap_or(0);
    let made = panels((0, face), &state.partition, &assigned, &trim_edge, 0, &options);
    let mut made = made.map_or_else(|_| Vec::new(), |p| p.panels);
    let several = made.len() > 1;
    for (k, p) in made.iter_mut().enumerate() {
        p.strip.name = if several { format!("{name}.{}", k + 1) } else { name.to_owned() };
    }
    Some((state.partition, made))
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
    let (mut state, fits) = fitted(face, &asked)?;
    if fits.len() != 1 {
        return None;
    }
    state.panels.extend(fits.into_iter().map(|(label, fit)| (label, Arc::new(fit))));
    let mut built = build(0, face, &state, tolerance).0;
    let [pattern] = <[Pattern; 1]>::try_from(built.patterns).ok()?;
    let pattern = Pattern { name: name.to_owned(), ..pattern };
    built.patchwork.panels.iter_mut().for_each(|p| name.clone_into(&mut p.strip.name));
    let flat = flat(&built.patchwork, std::slice::from_ref(&pattern), tolerance, &Control::default()).pop()?;
    let proven = built.certificate.certified && flat.holds();
    proven.then_some(LaidFace { patchwork: built.patchwork, certificate: built.certificate, pattern, flat })
}

/// Triangles of a face and the torse of every region.
fn fitted(face: &Face, asked: &ExactOptions) -> Option<(State, Vec<(u32, Fit)>)> {
    let extent = face.surface.bbox().diagonal();
    let rulings = Rulings::of(&face.surface, crate::brep::carrier::bounds(face), STRAIGHT * extent)?;
    let (mut across, mut whole): (Vec<f64>, f64) = (Vec::new(), 0.0);
    for w in rulings.breaks().windows(2) {
        let hair = STRAIGHT * (w[1] - w[0]);
        let turn = match (rulings.line(w[0] + hair), rulings.line(0.5 * (w[0] + w[1])), rulings.line(w[1] - hair)) {
            (Some(a), Some(m), Some(b)) => a.normal.angle(&m.normal) + m.normal.angle(&b.normal),
            _ => 0.0,
        };
        whole += turn;
        let count = ((turn / TURN).ceil() as usize).clamp(1, MOST_LINES);
        across.extend((0..count).map(|k| w[0] + (w[1] - w[0]) * k as f64 / count as f64));
    }
    let ((first, last), (lo, hi)) = (rulings.range(), rulings.reach());
    across.push(last);
    let swapped = rulings.lines(vec![0.0], vec![1.0])[0][0] == 1.0;
    let [u, v] = rulings.lines(across, vec![lo, hi]);
    let mut state = State::on_lines(face, u, v).ok()?;
    let count = (whole / MOST_TURN).ceil().max(1.0) as u32;
    for k in 1..count {
        let at = first + (last - first) * f64::from(k) / f64::from(count);
        state.cut(&face.surface, k - 1, k, |q| q[usize::from(swapped)] - at);
    }
    let fits: Vec<_> = (0..count)
        .filter_map(|label| {
            let rulings = Rulings::of(&face.surface, state.partition.bounds(label), STRAIGHT * extent)?;
            exact(&rulings, &state.samples(label), asked).map(|fit| (label, fit))
        })
        .collect();
    Some((state, fits))
}
