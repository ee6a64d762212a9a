//! The axis of a sphere is free: it is turned so that the poles keep away from the boundary, and where the face is
//! small, from the face.

use crate::brep::raw::RawLoop;
use crate::geom::{Frame, Vec3};

/// Unit vectors that differ by less are one axis: a normalisation costs a few units in the last place.
const SAME_AXIS: f64 = 1e-12;
/// Length of the samples' sum, and share of it square to the axis, below which the boundary has no side: it lies evenly
/// around the centre or the axis, up to what printed coordinates say.
const SIDEWAYS: f64 = 1e-6;

/// Cosines of the angles between an axis and the places of a circle about it differ by less.
const CIRCLE: f64 = 1e-7;

/// Unit vectors from the centre to places of a loop.
fn directions(frame: &Frame, l: &RawLoop) -> Vec<Vec3> {
    let mut out = Vec::new();
    for arc in l.edges.iter().flat_map(|e| &e.path) {
        let st = arc.curve.stations(arc.from, arc.to);
        for w in st.windows(2) {
            for i in 0..4 {
                let x = arc.curve.point(w[0] + (w[1] - w[0]) * f64::from(i) / 4.0) - frame.origin;
                out.extend(x.try_normalize(0.0));
            }
        }
    }
    out
}

/// A frame at the same centre about whose axis all loops are circles; its seam goes through the first place of the first of them.
/// `None` where there is none.
pub(super) fn about_circles(frame: &Frame, loops: &[RawLoop]) -> Option<Frame> {
    let places: Vec<Vec<Vec3>> = loops.iter().map(|l| directions(frame, l)).collect();
    let first = places.first()?;
    let third = first.len() / 3;
    let [p, q, r] = [first.first()?, first.get(third)?, first.get(2 * third)?];
    let z = (q - p).cross(&(r - p)).try_normalize(0.0)?;
    let is_circle = |l: &Vec<Vec3>| l.iter().all(|x| (x.dot(&z) - l[0].dot(&z)).abs() <= CIRCLE);
    let x = -(p - z * z.dot(p)).try_normalize(0.0)?;
    let z = if z.dot(&frame.z) < 0.0 { -z } else { z };
    places.iter().all(is_circle).then(|| Frame { origin: frame.origin, x, y: z.cross(&x), z })
}

/// A frame at the same centre whose axis stays away from the loops.
pub(super) fn turned(frame: &Frame, loops: &[RawLoop]) -> Frame {
    let samples: Vec<Vec3> = loops.iter().flat_map(|l| directions(frame, l)).collect();
    let middle: Vec3 = samples.iter().sum();
    // The file's own axis first, then the axes of its cube, edges and corners, and those square to the middle.
    let mut candidates = vec![frame.z, frame.x, frame.y];
    for a in [-1.0, 1.0] {
        candidates.extend([
            frame.x + frame.y * a,
            frame.y + frame.z * a,
            frame.z + frame.x * a,
            frame.x + frame.y * a + frame.z,
            frame.x + frame.y * a - frame.z,
        ]);
    }
    if middle.norm() > 0.0 {
        let m = middle.normalize();
        let helper = if m.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
        let (a, b) = (m.cross(&helper).normalize(), m.cross(&m.cross(&helper)).normalize());
        for i in 0..8 {
            let (s, c) = (f64::from(i) * std::f64::consts::PI / 8.0).sin_cos();
            candidates.push(a * c + b * s);
        }
    }
    // Angle between the axis line and the nearest sample.
    let clearance = |axis: &Vec3| {
        let worst = samples.iter().map(|s| s.dot(axis).abs()).fold(0.0_f64, f64::max);
        worst.min(1.0).acos()
    };
    let mut best = (frame.z, clearance(&frame.z));
    for c in candidates {
        let c = c.normalize();
        let d = clearance(&c);
        // A turned axis must be clearly better than the file's.
        if d > best.1 + 0.05 {
            best = (c, d);
        }
    }
    let z = best.0;
    if (z - frame.z).norm() < SAME_AXIS {
        return *frame;
    }
    // The seam opposite to the middle of the boundary.
    let lateral = middle - z * z.dot(&middle);
    let x = if lateral.norm() > SIDEWAYS * middle.norm() && middle.norm() > SIDEWAYS {
        lateral.normalize()
    } else {
        let helper = if z.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
        (helper - z * z.dot(&helper)).normalize()
    };
    Frame { origin: frame.origin, x, y: z.cross(&x), z }
}
