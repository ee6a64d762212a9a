//! Changes that a certificate must not survive, or whose effect it must contain.

use crate::random::Random;
use torse::patchwork::panel::{Border, Patchwork};
use torse::spline::knots::Knots;

/// A change of a number, at a size beside the bound: the certificate may hold if its bound then does.
pub const NUMBERS: [&str; 9] = [
    "none",
    "control point of the face",
    "weight of the face",
    "knot of the face",
    "control point of the patch",
    "control point of a trimming curve",
    "knot of a trimming curve",
    "control point of an edge",
    "knot of an edge",
];

/// A change after which nothing may be certified.
pub const FORGERIES: [&str; 11] = [
    "triangle missing",
    "triangle twice",
    "triangle turned over",
    "label of no panel",
    "loop reversed",
    "vertex of a run missing",
    "border called a seam",
    "edge that is no number",
    "one side of a seam called a border",
    "seam that runs the same way on both sides",
    "panel called the other one's",
];

fn moved_knot(knots: &Knots, k: usize, by: f64) -> Option<Knots> {
    let mut values = knots.values().to_vec();
    *values.get_mut(k)? += by;
    let count = knots.control_count();
    Knots::new(knots.degree(), values, count).ok()
}

/// Changes one number; `size` is the tolerance in mm. `None` where there is nothing to change.
pub fn number(p: &mut Patchwork, what: usize, size: f64, random: &mut Random) -> Option<()> {
    let by = random.sign() * size * random.scale(0.3, 4.0);
    let face = &mut p.faces.first_mut()?.surface;
    let which = random.below(p.panels.len());
    let panel = p.panels.get_mut(which)?;
    let runs = panel.loops_mut().first_mut()?;
    let r = random.below(runs.len());
    match what {
        0 => {}
        1 => {
            let k = random.below(face.control.len());
            let w = face.control[k][3];
            face.control[k][random.below(3)] += by * w;
        }
        2 => {
            let k = random.below(face.control.len());
            let factor = 1.0 + by.signum() * random.scale(1e-6, 1e-2);
            face.control[k].iter_mut().for_each(|x| *x *= factor);
            face.rational = true;
        }
        3 => {
            let n = face.knots_u.values().len();
            let inner = 4..n.checked_sub(4)?;
            let k = inner.start + random.below(inner.len().max(1));
            face.knots_u = moved_knot(&face.knots_u, k, random.sign() * random.scale(1e-6, 1e-2))?;
        }
        4 => {
            let k = random.below(panel.strip.patch.control.len());
            let w = panel.strip.patch.control[k][3];
            panel.strip.patch.control[k][random.below(3)] += by * w * random.scale(1e-9, 1.0);
        }
        5 => {
            let c = &mut runs.get_mut(r)?.trim.control;
            let k = 1 + random.below(c.len().checked_sub(2)?);
            c[k][random.below(2)] += by;
        }
        6 => {
            let trim = &mut runs.get_mut(r)?.trim;
            let k = 4 + random.below(trim.knots.values().len().checked_sub(8)?);
            trim.knots = moved_knot(&trim.knots, k, random.sign() * random.scale(1e-4, 1e-2))?;
        }
        7 => {
            let c = &mut runs.get_mut(r)?.edge.control;
            let k = 1 + random.below(c.len().checked_sub(2)?);
            c[k][random.below(3)] += by * random.scale(1e-3, 1.0);
        }
        _ => {
            let edge = &mut runs.get_mut(r)?.edge;
            let k = 4 + random.below(edge.knots.values().len().checked_sub(8)?);
            edge.knots = moved_knot(&edge.knots, k, random.sign() * random.scale(1e-4, 1e-2))?;
        }
    }
    Some(())
}

/// Changes what is counted, not measured. `None` where there is nothing to change: seams are those of two panels.
pub fn forgery(p: &mut Patchwork, what: usize, random: &mut Random) -> Option<()> {
    let seamed = p.seam_count > 0;
    let partition = p.partitions.first_mut()?;
    let panel = p.panels.first_mut()?;
    let k = random.below(partition.triangles.len());
    let runs = panel.loops_mut().first_mut()?;
    let r = random.below(runs.len());
    match what {
        0 => {
            partition.triangles.remove(k);
            partition.labels.remove(k);
        }
        1 => {
            let t = partition.triangles[k];
            partition.triangles.push(t);
            partition.labels.push(0);
        }
        2 => partition.triangles[k].swap(0, 1),
        3 => partition.labels[k] = 3,
        4 => {
            runs.iter_mut().for_each(|r| r.vertices.reverse());
            runs.reverse();
        }
        5 => {
            let run = runs.get_mut(r)?;
            run.vertices.remove(1);
            run.parameters.remove(1);
        }
        6 => {
            let border = &mut runs.get_mut(r)?.border;
            if let Border::Seam { .. } = border {
                return None;
            }
            *border = Border::Seam { seam: 0, forward: true };
            p.seam_count = 1;
        }
        7 => {
            let c = &mut runs.get_mut(r)?.edge.control;
            let k = random.below(c.len());
            c[k][random.below(3)] = f64::NAN;
        }
        8 | 9 if seamed => {
            let side = runs.iter_mut().find(|r| matches!(r.border, Border::Seam { .. }))?;
            side.border = match what {
                8 => Border::Trim { edge: 1 },
                _ => Border::Seam { seam: 0, forward: false },
            };
        }
        10 if seamed => panel.trim.as_mut()?.label = 1,
        _ => return None,
    }
    Some(())
}
