//! Curves that a designer gives, brought into the parameter plane of a face (\[SE06\], section 2.7).
//!
//! Parameter curves need nothing; sections with planes are followed through the triangles of the face, every crossing of
//! a triangle's side solved for; points of curves in space are projected onto the surface.

use super::covered_face::Cover;
use crate::brep::project::SurfaceProjector;
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::patchwork::partition::edges;

/// A curve along which a panel is to run.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelCurve {
    /// What the user calls it: for reports and messages.
    pub name: String,
    /// The curve.
    pub shape: CurveShape,
}

/// Kinds of curves.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveShape {
    /// `u = const`; as a share of the parameter range of each face, 0 to 1.
    AlongV(f64),
    /// `v = const`; as a share of the parameter range of each face, 0 to 1.
    AlongU(f64),
    /// Section with the plane `normal · x = offset`; `normal` of unit length, mm.
    Section {
        /// Unit normal.
        normal: Vec3,
        /// Distance from the origin along the normal, mm.
        offset: f64,
    },
    /// Points of a curve in space on the surface, mm.
    Points(Vec<Vec3>),
}

/// Why a curve is of no use.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// A curve of no length, or with numbers that are not finite.
    #[error("{name} has no length, or a number that is not finite")]
    Empty {
        /// Curve.
        name: String,
    },
    /// A share outside 0 to 1.
    #[error("{name}: {value} is not a share of the parameter range between 0 and 1")]
    Share {
        /// Curve.
        name: String,
        /// What was given.
        value: f64,
    },
    /// A plane that misses the faces.
    #[error("{name} misses every face: in its direction they lie between {lo:.3} mm and {hi:.3} mm")]
    Misses {
        /// Curve.
        name: String,
        /// Where the face begins, mm.
        lo: f64,
        /// Where it ends, mm.
        hi: f64,
    },
    /// A curve off the surface.
    #[error(
        "{name} is up to {distance:.4} mm away from the surface; only curves within {allowed:.4} mm are projected"
    )]
    Off {
        /// Curve.
        name: String,
        /// Largest distance of its points, mm.
        distance: f64,
        /// Distance up to which curves are projected, mm.
        allowed: f64,
    },
    /// A curve on the surface but outside the trimmed face.
    #[error("{name} lies on the surface but outside the edges of the face")]
    Outside {
        /// Curve.
        name: String,
    },
    /// A curve without envelope.
    #[error("{name}: {source}")]
    Envelope {
        /// Curve.
        name: String,
        /// Why.
        source: crate::fit::near::tangent_envelope::AlongError,
    },
}

impl CurveError {
    /// How near a curve came to being of use: errors of faces that it has nothing to do with come last.
    pub(crate) fn remoteness(&self) -> f64 {
        match self {
            Self::Envelope { .. } | Self::Empty { .. } | Self::Share { .. } => -1.0,
            Self::Outside { .. } => 0.0,
            Self::Off { distance, .. } => *distance,
            Self::Misses { .. } => f64::INFINITY,
        }
    }
}

/// Curves in space up to this share of the face's size, or ten tolerances, from the surface are projected.
const NEAR: f64 = 0.01;
/// Points along a parameter curve.
const POINTS: usize = 161;
/// Normals of sections may differ from unit length by this: six printed digits.
const UNIT_LENGTH: f64 = 1e-6;

impl Cover {
    /// The pieces of a curve on a face, as points of the parameter plane. Pieces whose ends coincide are closed.
    ///
    /// # Errors
    /// See [`CurveError`].
    pub(crate) fn lines_of(&self, curve: &PanelCurve, tolerance: f64) -> Result<Vec<Vec<[f64; 2]>>, CurveError> {
        let name = || curve.name.clone();
        let bounds = self.bounds();
        let at = |a: f64, b: f64, s: f64| a + (b - a) * s;
        let steps = || (0..POINTS).map(|i| i as f64 / (POINTS - 1) as f64);
        match &curve.shape {
            CurveShape::AlongV(s) | CurveShape::AlongU(s) if !(0.0..=1.0).contains(s) => {
                Err(CurveError::Share { name: name(), value: *s })
            }
            CurveShape::AlongV(s) => {
                let u = at(bounds[0], bounds[1], *s);
                Ok(vec![steps().map(|t| [u, at(bounds[2], bounds[3], t)]).collect()])
            }
            CurveShape::AlongU(s) => {
                let v = at(bounds[2], bounds[3], *s);
                Ok(vec![steps().map(|t| [at(bounds[0], bounds[1], t), v]).collect()])
            }
            CurveShape::Section { normal, offset } => {
                if !(offset.is_finite() && (normal.norm() - 1.0).abs() < UNIT_LENGTH) {
                    return Err(CurveError::Empty { name: name() });
                }
                let found = self.section(normal, *offset);
                if found.is_empty() {
                    let (lo, hi) = self
                        .jets
                        .iter()
                        .map(|j| normal.dot(&j.jet.p))
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                    return Err(CurveError::Misses { name: name(), lo, hi });
                }
                Ok(found)
            }
            CurveShape::Points(points) => {
                let finite = points.iter().all(|p| p.iter().all(|x| x.is_finite()));
                if !finite || points.len() < 3 || points.iter().all(|p| p == &points[0]) {
                    return Err(CurveError::Empty { name: name() });
                }
                let surface = &self.face.surface;
                let projector = SurfaceProjector::new(surface);
                let feet: Vec<_> = points.iter().map(|x| projector.nearest(surface, x)).collect();
                let distance = feet.iter().map(|f| f.distance).fold(0.0, f64::max);
                let allowed = (NEAR * surface.bbox().diagonal()).max(10.0 * tolerance);
                if distance > allowed {
                    return Err(CurveError::Off { name: name(), distance, allowed });
                }
                let line: Vec<[f64; 2]> = feet.iter().map(|f| f.at).collect();
                let inside =
                    |p: &[f64; 2]| (0..self.partition.triangles.len()).any(|t| holds(self.partition.corners(t), *p));
                if !line.iter().any(inside) {
                    return Err(CurveError::Outside { name: name() });
                }
                Ok(vec![line])
            }
        }
    }

    /// Chains of points of the section of a face with a plane.
    fn section(&self, normal: &Vec3, offset: f64) -> Vec<Vec<[f64; 2]>> {
        const BISECTIONS: usize = 50;
        let partition = &self.partition;
        let height = |p: [f64; 2]| normal.dot(&self.face.surface.point(p[0], p[1])) - offset;
        // Vertices on the plane count as above it: every triangle is crossed on none or two of its sides.
        let above: Vec<bool> = self.jets.iter().map(|j| normal.dot(&j.jet.p) >= offset).collect();
        let mut places: HashMap<(u32, u32), [f64; 2]> = HashMap::default();
        let mut next: HashMap<(u32, u32), Vec<(u32, u32)>> = HashMap::default();
        for t in &partition.triangles {
            let crossed: Vec<(u32, u32)> = edges(*t)
                .into_iter()
                .filter(|&(a, b)| above[a as usize] != above[b as usize])
                .map(|(a, b)| (a.min(b), a.max(b)))
                .collect();
            let [e, f] = crossed[..] else { continue };
            for k in [e, f] {
                places.entry(k).or_insert_with(|| {
                    let (a, b) = (partition.vertices[k.0 as usize], partition.vertices[k.1 as usize]);
                    let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
                    let (mut lo, mut hi) = (0.0, 1.0);
                    for _ in 0..BISECTIONS {
                        let middle = 0.5 * (lo + hi);
                        if (height(at(middle)) >= 0.0) == above[k.0 as usize] {
                            lo = middle;
                        } else {
                            hi = middle;
                        }
                    }
                    at(0.5 * (lo + hi))
                });
            }
            next.entry(e).or_default().push(f);
            next.entry(f).or_default().push(e);
        }
        let mut keys: Vec<(u32, u32)> = next.keys().copied().collect();
        // Open chains from their ends first.
        keys.sort_unstable_by_key(|k| (next[k].len(), *k));
        let mut used: HashSet<(u32, u32)> = HashSet::default();
        let mut out = Vec::new();
        for start in keys {
            if !used.insert(start) {
                continue;
            }
            let closed = next[&start].len() == 2;
            let mut chain = vec![places[&start]];
            let mut here = start;
            while let Some(&k) = next[&here].iter().find(|k| !used.contains(k)) {
                used.insert(k);
                chain.push(places[&k]);
                here = k;
            }
            if closed && chain.len() > 3 {
                chain.push(places[&start]);
            }
            if chain.len() >= 3 {
                out.push(chain);
            }
        }
        out
    }
}

/// Share of the box of the region by which lines are carried on beyond it.
const BEYOND: f64 = 0.25;

/// The line, carried on straight at both ends until it leaves the box `[u0, u1, v0, v1]` by a margin; what lies beyond
/// that is left out.
pub(super) fn carried_on(line: &[[f64; 2]], b: [f64; 4]) -> Vec<[f64; 2]> {
    const MOST_STEPS: usize = 400;
    let (mu, mv) = (BEYOND * (b[1] - b[0]), BEYOND * (b[3] - b[2]));
    let inside = |p: &[f64; 2]| p[0] > b[0] - mu && p[0] < b[1] + mu && p[1] > b[2] - mv && p[1] < b[3] + mv;
    let (Some(first), Some(last)) = (line.iter().position(inside), line.iter().rposition(inside)) else {
        return line.to_vec();
    };
    let mut out: Vec<[f64; 2]> = line[first..=last].to_vec();
    for _ in 0..2 {
        out.reverse();
        let n = out.len();
        if n < 4 {
            continue;
        }
        let step: [f64; 2] = std::array::from_fn(|d| (out[n - 1][d] - out[n - 4][d]) / 3.0);
        for _ in 0..MOST_STEPS {
            let p = out[out.len() - 1];
            if !inside(&p) || step[0].abs() + step[1].abs() <= 0.0 {
                break;
            }
            out.push([p[0] + step[0], p[1] + step[1]]);
        }
    }
    out
}

/// Whether a triangle of the parameter plane contains a point.
fn holds(c: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let s = [side(c[0], c[1]), side(c[1], c[2]), side(c[2], c[0])];
    s.iter().all(|&x| x >= 0.0) || s.iter().all(|&x| x <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_carried_on_until_they_leave_the_box() {
        let line: Vec<[f64; 2]> = (0..5).map(|i| [0.4 + 0.05 * i as f64, 0.5]).collect();
        let on = carried_on(&line, [0.0, 1.0, 0.0, 1.0]);
        let (lo, hi) = on.iter().fold((1.0, 0.0), |(a, b): (f64, f64), p| (a.min(p[0]), b.max(p[0])));
        assert!(lo <= -0.25 && hi >= 1.25 && on.iter().all(|p| p[1] == 0.5), "{lo} {hi}");
    }
}
