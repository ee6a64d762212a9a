//! What a certificate is about, as a number: all that was judged, bit by bit \[certificate, 6\].
//!
//! A patchwork that differs in any control point, weight, knot, trimming curve, edge, triangle or label has another
//! fingerprint (but for a chance of 2⁻⁶⁴), so that a certificate cannot pass for one about something else. Where a
//! patchwork stands among others (the numbers of its faces and seams) does not count. Not a defence against somebody who
//! looks for collisions: the hash is not cryptographic.

use crate::geom::Frame;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, Patchwork};
use crate::patchwork::partition::Partition;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::form::Torse;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// A patchwork that was judged, or its place among others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fingerprint {
    value: u64,
    /// Numbers of faces, panels and seams.
    counts: [usize; 3],
}

impl Fingerprint {
    /// Of a whole patchwork.
    pub fn of(patchwork: &Patchwork) -> Self {
        let counts = [patchwork.faces.len(), patchwork.panels.len(), patchwork.seam_count];
        Self { value: value(patchwork, [0; 3], counts), counts }
    }

    /// Whether patchworks with these fingerprints, one after the other, are this patchwork.
    pub fn make_up(parts: &[Self], patchwork: &Patchwork) -> bool {
        let mut first = [0; 3];
        let whole = [patchwork.faces.len(), patchwork.panels.len(), patchwork.seam_count];
        for part in parts {
            let next = [0, 1, 2].map(|k: usize| first[k] + part.counts[k]);
            if (0..3).any(|k| next[k] > whole[k]) || value(patchwork, first, part.counts) != part.value {
                return false;
            }
            first = next;
        }
        first == whole && patchwork.partitions.len() == patchwork.faces.len()
    }
}

/// Of which runs are sides of joints along borders of faces.
pub(super) fn of_joints(patchwork: &Patchwork) -> u64 {
    let mut h = DefaultHasher::new();
    patchwork.joint_count.hash(&mut h);
    for (k, panel) in patchwork.panels.iter().enumerate() {
        for (i, run) in panel.loops().iter().flatten().enumerate() {
            if let Border::Joint { .. } = run.border {
                (k, i, run.border).hash(&mut h);
            }
        }
    }
    h.finish()
}

/// Of a surface as it is.
pub(super) fn of_surface(surface: &Surface) -> u64 {
    let mut h = DefaultHasher::new();
    knots(&surface.knots_u, &mut h);
    knots(&surface.knots_v, &mut h);
    points(&surface.control, &mut h);
    h.finish()
}

/// Of all that the proof of a panel is about, given the fingerprint of its surface, whether a bound is stated however far it
/// is, and lengths (what was moved, the tolerance), without any numbers of vertices, panels
/// and seams: which triangles its loops go around is not part of it.
pub(super) fn of_panel(
    panel: &Panel,
    partition: &Partition,
    (surface, far): (u64, bool),
    lengths: [f64; 2],
) -> Option<u64> {
    let trim = panel.trim.as_ref()?;
    let mut h = DefaultHasher::new();
    surface.hash(&mut h);
    far.hash(&mut h);
    lengths.iter().for_each(|x| number(*x, &mut h));
    let vertex = |v: &u32, h: &mut DefaultHasher| match partition.vertices.get(*v as usize) {
        Some(p) => p.iter().for_each(|x| number(*x, h)),
        None => h.write_u8(0),
    };
    let triangles = partition.triangles.iter().zip(&partition.labels);
    triangles.filter(|(_, &l)| l == trim.label).for_each(|(t, _)| t.iter().for_each(|v| vertex(v, &mut h)));
    shape(panel, &trim.form, &mut h);
    for l in &trim.loops {
        l.len().hash(&mut h);
        for r in l {
            r.vertices.len().hash(&mut h);
            r.vertices.iter().for_each(|v| vertex(v, &mut h));
            coedge_curves(r, &mut h);
        }
    }
    Some(h.finish())
}

/// Of all that the proof of a seam is about.
pub(super) fn of_seam(sides: [(&Panel, &Coedge); 2], tolerance: f64) -> u64 {
    let mut h = DefaultHasher::new();
    number(tolerance, &mut h);
    for (panel, run) in sides {
        patch(panel, &mut h);
        curve(&run.trim, &mut h);
    }
    h.finish()
}

fn value(patchwork: &Patchwork, first: [usize; 3], counts: [usize; 3]) -> u64 {
    let mut h = DefaultHasher::new();
    counts.hash(&mut h);
    for face in patchwork.faces.iter().skip(first[0]).take(counts[0]) {
        of_surface(&face.surface).hash(&mut h);
        face.loops.len().hash(&mut h);
        for l in &face.loops {
            points(&l.points, &mut h);
        }
        number(face.joint_bound(), &mut h);
    }
    for p in patchwork.partitions.iter().skip(first[0]).take(counts[0]) {
        partition(p, &mut h);
    }
    for p in patchwork.panels.iter().skip(first[1]).take(counts[1]) {
        panel(p, first, &mut h);
    }
    h.finish()
}

fn partition(p: &Partition, h: &mut DefaultHasher) {
    points(&p.vertices, h);
    p.triangles.hash(h);
    p.labels.hash(h);
}

fn panel(p: &Panel, first: [usize; 3], h: &mut DefaultHasher) {
    let Some(trim) = &p.trim else { return patch(p, h) };
    shape(p, &trim.form, h);
    trim.face.wrapping_sub(first[0]).hash(h);
    trim.label.hash(h);
    for l in &trim.loops {
        l.len().hash(h);
        l.iter().for_each(|r| run(r, first[2], h));
    }
}

fn patch(p: &Panel, h: &mut DefaultHasher) {
    knots(&p.strip.patch.knots_u, h);
    knots(&p.strip.patch.knots_v, h);
    points(&p.strip.patch.control, h);
}

fn axes(frame: &Frame, h: &mut DefaultHasher) {
    for v in [frame.origin, frame.x, frame.y, frame.z] {
        v.iter().for_each(|x| number(*x, h));
    }
}

/// The patch and what it is for the comparison with its face.
fn shape(p: &Panel, form: &PanelForm, h: &mut DefaultHasher) {
    patch(p, h);
    match form {
        PanelForm::Torse(Torse::Primal(t)) => {
            0u8.hash(h);
            axes(&t.frame, h);
            curve(t.profile(), h);
            number(t.beta(), h);
        }
        PanelForm::Torse(Torse::Dual(t)) => {
            1u8.hash(h);
            curve(&t.planes, h);
        }
        PanelForm::Torse(Torse::Cylinder(t)) => {
            3u8.hash(h);
            axes(&t.frame, h);
            curve(&t.profile, h);
        }
        PanelForm::Ruled(map) => {
            2u8.hash(h);
            knots(&map.knots_s, h);
            knots(&map.knots_t, h);
            points(&map.control, h);
        }
    }
}

fn run(r: &Coedge, first_seam: usize, h: &mut DefaultHasher) {
    match r.border {
        Border::Seam { seam, forward } => (0u8, (seam as usize).wrapping_sub(first_seam), forward).hash(h),
        // What is beyond the border of a face is another patchwork: see `of_joints`.
        Border::Trim { edge } | Border::Joint { edge, .. } => (1u8, edge).hash(h),
    }
    r.vertices.hash(h);
    coedge_curves(r, h);
}

/// Where a run goes.
fn coedge_curves(r: &Coedge, h: &mut DefaultHasher) {
    r.parameters.iter().for_each(|x| number(*x, h));
    curve(&r.trim, h);
    curve(&r.edge, h);
}

fn curve<const D: usize>(c: &Curve<D>, h: &mut DefaultHasher) {
    knots(&c.knots, h);
    points(&c.control, h);
}

fn knots(k: &Knots, h: &mut DefaultHasher) {
    k.degree().hash(h);
    k.values().len().hash(h);
    k.values().iter().for_each(|x| number(*x, h));
}

fn points<const D: usize>(p: &[[f64; D]], h: &mut DefaultHasher) {
    p.len().hash(h);
    p.iter().flatten().for_each(|x| number(*x, h));
}

fn number(x: f64, h: &mut DefaultHasher) {
    x.to_bits().hash(h);
}
