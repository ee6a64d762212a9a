//! What surface a face lies on, whatever its file calls it: plane, circular cylinder or cone, general cylinder or cone,
//! tangent surface, or no developable at all.
//!
//! Straight parameter lines along which the tangent plane stays the same are looked for at samples
//! (`Rulings`); nothing is proven here.

use crate::brep::face::Face;
use crate::brep::rulings::Rulings;
use crate::geom::{Frame, Vec3};
use crate::spline::surface::{Surface, SurfaceJet};
use nalgebra::Matrix3;

/// The surface of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum RecognisedSurface {
    /// Through the origin, square to z, which is the face's outward normal.
    Plane(Frame),
    /// About the z axis.
    Cylinder {
        /// Axis z.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// About the z axis, with its apex in the origin and the face on the side of positive z.
    Cone {
        /// Apex and axis.
        frame: Frame,
        /// Angle between axis and rulings, rad, below π/2.
        half_angle: f64,
    },
    /// Parallel rulings over any curve.
    GeneralCylinder {
        /// Unit direction of the rulings.
        direction: Vec3,
    },
    /// Rulings through one point.
    GeneralCone {
        /// The point.
        apex: Vec3,
    },
    /// Rulings that touch a curve of space.
    TangentSurface,
    /// Not developable along its parameter lines.
    Curved(Defect),
}

/// By how much a face is not developable: greatest values found at samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defect {
    /// Turn of the normal along a parameter line that is straight, rad; not a number if no lines are straight.
    pub twist_estimate: f64,
    /// Absolute Gaussian curvature, 1/mm².
    pub curvature_estimate: f64,
    /// Share by which lengths have to change to make it flat: a sixteenth of curvature times the square of the face's
    /// smaller breadth, measured on it (the strain at the rim of a flattened cap of that width); half or more where the face
    /// closes on itself.
    pub strain_estimate: f64,
}

impl RecognisedSurface {
    /// Lower-case name used in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::GeneralCylinder { .. } => "general cylinder",
            Self::GeneralCone { .. } => "general cone",
            Self::TangentSurface => "tangent surface",
            Self::Curved(_) => "not developable",
        }
    }

    /// Whether it can be laid flat without stretching.
    pub fn is_developable(&self) -> bool {
        !matches!(self, Self::Curved(_))
    }
}

/// Share of a face's extent within which its points must keep to a recognised surface: what ten printed digits lose, with a margin.
pub(crate) const EXACT: f64 = 1e-7;
/// Places per direction where recognised surfaces are compared with the surface.
const PLACES: usize = 9;
/// Rulings looked at on each span between knots.
const LINES: usize = 8;
/// Share of the greatest squared measure of the parameters' net below which a place is a pole, without curvature of its own.
const POLE: f64 = 1e-12;
/// Chords by which the breadth of a face is measured.
const LENGTHS: usize = 64;
/// Directions that turn by less (rad) count as one.
const PARALLEL: f64 = 1e-7;

/// Box `[u0, u1, v0, v1]` around a face's loops in the parameter plane.
pub(crate) fn bounds(face: &Face) -> [f64; 4] {
    let none = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    let points = face.loops.iter().flat_map(|l| &l.points);
    points.fold(none, |b, p| [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])])
}

/// Where the normal fades towards a place, that of a place beside it is taken: by this share of the way to the middle of the
/// surface …
const INWARDS: f64 = 1e-4;
/// … and if it is longer than that at the place by more than this factor: rounding gives what is left there its direction.
const FADES: f64 = 1e-3;

/// The outward normal of a face at a place, or, where control points coincide, right beside it; `None` where the surface has
/// none.
pub(crate) fn outward(face: &Face, uv: [f64; 2]) -> Option<Vec3> {
    let normal = |[u, v]: [f64; 2]| face.surface.jet(u, v).normal();
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let middle = [0.5 * (u0 + u1), 0.5 * (v0 + v1)];
    let (at, beside) = (normal(uv), normal([0, 1].map(|k: usize| uv[k] + INWARDS * (middle[k] - uv[k]))));
    let n = if at.norm() > FADES * beside.norm() { at } else { beside };
    let n = n.try_normalize(0.0)?;
    Some(if face.reversed { -n } else { n })
}

/// The straight parameter lines of a developable face.
pub(crate) fn rulings(face: &Face) -> Option<Rulings<'_>> {
    Rulings::of(&face.surface, bounds(face), EXACT * face.surface.bbox().diagonal())
}

/// The surface that a face lies on.
///
/// *Guarantee*: at all samples points keep to the recognised surface within [`EXACT`] of the face's extent. *Not guaranteed*: what
/// happens between samples, and developable faces whose rulings are no parameter lines are not found.
pub(crate) fn recognise(face: &Face) -> RecognisedSurface {
    let b = bounds(face);
    let places = grid(b);
    let points: Vec<Vec3> = places.iter().map(|q| face.surface.point(q[0], q[1])).collect();
    let extent = extent(&points);
    let slack = EXACT * extent;
    if let Some(plane) = plane(face, &places, &points, slack) {
        return plane;
    }
    let Some(rulings) = Rulings::of(&face.surface, b, slack) else {
        return RecognisedSurface::Curved(defect(face, &places));
    };
    let lines: Vec<(Vec3, Vec3, Vec3)> = rulings
        .breaks()
        .windows(2)
        .flat_map(|w| (0..LINES).map(move |k| w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / LINES as f64))
        .filter_map(|s| rulings.line(s))
        .map(|l| (l.point, l.direction, l.normal))
        .collect();
    let Some(first) = lines.first() else { return RecognisedSurface::Curved(defect(face, &places)) };
    if lines.iter().all(|l| l.1.cross(&first.1).norm() <= PARALLEL) {
        let direction = first.1;
        return cylinder(&lines, &points, slack).unwrap_or(RecognisedSurface::GeneralCylinder { direction });
    }
    match common_point(&lines).filter(|a| lines.iter().all(|l| (a - l.0).cross(&l.1).norm() <= slack)) {
        Some(apex) => cone(&apex, &lines, slack).unwrap_or(RecognisedSurface::GeneralCone { apex }),
        None => RecognisedSurface::TangentSurface,
    }
}

/// Places of a grid over a box.
fn grid(b: [f64; 4]) -> Vec<[f64; 2]> {
    let at = |k: usize, lo: f64, hi: f64| lo + (hi - lo) * k as f64 / (PLACES - 1) as f64;
    (0..PLACES * PLACES).map(|k| [at(k % PLACES, b[0], b[1]), at(k / PLACES, b[2], b[3])]).collect()
}

fn extent(points: &[Vec3]) -> f64 {
    crate::geom::BBox::of(points).diagonal()
}

fn plane(face: &Face, places: &[[f64; 2]], points: &[Vec3], slack: f64) -> Option<RecognisedSurface> {
    let z = places.iter().find_map(|q| outward(face, *q))?;
    let flat = points.iter().all(|p| (p - points[0]).dot(&z).abs() <= slack);
    flat.then(|| RecognisedSurface::Plane(frame(points[0], z)))
}

/// A frame with a given third axis.
pub(crate) fn frame(origin: Vec3, z: Vec3) -> Frame {
    // Away from the axis that z is nearest to.
    let away = if z.x.abs() <= z.y.abs().min(z.z.abs()) {
        Vec3::x()
    } else if z.y.abs() <= z.z.abs() {
        Vec3::y()
    } else {
        Vec3::z()
    };
    let x = (away - z * z.dot(&away)).normalize();
    Frame { origin, x, y: z.cross(&x), z }
}

/// The circular cylinder through lines with one direction, if there is one.
fn cylinder(lines: &[(Vec3, Vec3, Vec3)], points: &[Vec3], slack: f64) -> Option<RecognisedSurface> {
    let z = lines[0].1;
    // The axis is where the normals meet: least squares of (c − p) × n = 0 square to z.
    let (mut sum, mut right) = (Matrix3::zeros(), Vec3::zeros());
    for (p, _, n) in lines {
        let m = Matrix3::identity() - n * n.transpose() - z * z.transpose();
        sum += m;
        right += m * p;
    }
    sum += z * z.transpose();
    right += z * z.dot(&lines[0].0);
    let centre = sum.try_inverse()? * right;
    let away = |p: &Vec3| {
        let d = p - centre;
        (d - z * z.dot(&d)).norm()
    };
    let radius = lines.iter().map(|l| away(&l.0)).sum::<f64>() / lines.len() as f64;
    let holds = radius.is_finite() && points.iter().all(|p| (away(p) - radius).abs() <= slack);
    holds.then(|| RecognisedSurface::Cylinder { frame: frame(centre, z), radius })
}

/// The point nearest to all lines.
fn common_point(lines: &[(Vec3, Vec3, Vec3)]) -> Option<Vec3> {
    let (mut sum, mut right) = (Matrix3::zeros(), Vec3::zeros());
    for (p, d, _) in lines {
        let m = Matrix3::identity() - d * d.transpose();
        sum += m;
        right += m * p;
    }
    Some(sum.try_inverse()? * right).filter(|a| a.iter().all(|x| x.is_finite()))
}

/// The circular cone of lines through one point, if it is one: the axis makes one angle with all of them.
fn cone(apex: &Vec3, lines: &[(Vec3, Vec3, Vec3)], slack: f64) -> Option<RecognisedSurface> {
    let unit: Vec<Vec3> = lines.iter().filter_map(|l| (l.0 - apex).try_normalize(0.0)).collect();
    let (n, mean) = (unit.len(), unit.iter().sum::<Vec3>() / unit.len() as f64);
    // Ends of unit vectors of a circular cone lie in a plane: its normal is the axis.
    let spread: Matrix3<f64> = unit.iter().map(|w| (w - mean) * (w - mean).transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let least = (0..3).min_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]))?;
    let mut z: Vec3 = eigen.eigenvectors.column(least).into_owned();
    if z.dot(&mean) < 0.0 {
        z = -z;
    }
    let cos = unit.iter().map(|w| w.dot(&z)).sum::<f64>() / n as f64;
    let reach = lines.iter().map(|l| (l.0 - apex).norm()).fold(0.0, f64::max);
    let holds = cos > 0.0 && unit.iter().all(|w| (w.dot(&z) - cos).abs() * reach <= slack);
    holds.then(|| RecognisedSurface::Cone { frame: frame(*apex, z), half_angle: cos.clamp(0.0, 1.0).acos() })
}

/// How far a surface is from developable, at places.
fn defect(face: &Face, places: &[[f64; 2]]) -> Defect {
    let jets: Vec<_> = places.iter().map(|q| face.surface.jet(q[0], q[1])).collect();
    let measure = |j: &SurfaceJet| j.du.norm_squared() * j.dv.norm_squared() - j.du.dot(&j.dv).powi(2);
    let least = POLE * jets.iter().map(measure).fold(0.0, f64::max);
    let mut curvature = 0.0_f64;
    for j in jets.iter().filter(|j| measure(j) > least) {
        let n = j.normal();
        let [l, m, k] = j.second_form(&n);
        let k = (l * k - m.powi(2)) / n.norm_squared() / measure(j);
        curvature = curvature.max(k.abs());
    }
    let b = bounds(face);
    let at = |k: usize, lo: f64, hi: f64| lo + (hi - lo) * k as f64 / LENGTHS as f64;
    let length =
        |point: &dyn Fn(usize) -> Vec3| -> f64 { (0..LENGTHS).map(|k| (point(k + 1) - point(k)).norm()).sum() };
    let (u, v) = (0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]));
    let along_u = length(&|k| face.surface.point(at(k, b[0], b[1]), v));
    let along_v = length(&|k| face.surface.point(u, at(k, b[2], b[3])));
    let width = along_u.min(along_v);
    Defect {
        twist_estimate: twist(&face.surface, b),
        curvature_estimate: curvature,
        strain_estimate: curvature * width * width / 16.0,
    }
}

/// Greatest turn of the normal along straight parameter lines; not a number where there are none.
fn twist(surface: &Surface, b: [f64; 4]) -> f64 {
    let families = [false, true].map(|swapped| {
        let (across, along) = if swapped { ((b[2], b[3]), (b[0], b[1])) } else { ((b[0], b[1]), (b[2], b[3])) };
        let at = |k: usize, (lo, hi): (f64, f64)| lo + (hi - lo) * k as f64 / (PLACES - 1) as f64;
        let place = |s: f64, r: f64| if swapped { (r, s) } else { (s, r) };
        let mut most = 0.0_f64;
        for k in 0..PLACES {
            let jets: Vec<_> =
                (0..PLACES).map(|i| place(at(k, across), at(i, along))).map(|(u, v)| surface.jet(u, v)).collect();
            let chord = jets[PLACES - 1].p - jets[0].p;
            let off = |p: Vec3| (p - jets[0].p).cross(&chord).norm();
            // Lines that come back to where they began are not straight either.
            let length = chord.norm() * (1.0 + EXACT);
            if jets.iter().any(|j| off(j.p) > EXACT * chord.norm_squared() || (j.p - jets[0].p).norm() > length) {
                return f64::NAN;
            }
            for w in [[0, PLACES - 1], [0, PLACES / 2], [PLACES / 2, PLACES - 1]] {
                let angle = jets[w[0]].normal().angle(&jets[w[1]].normal());
                most = most.max(if angle.is_finite() { angle } else { 0.0 });
            }
        }
        most
    });
    families.into_iter().fold(f64::NAN, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::spline::knots::Knots;

    fn on(support: &SupportSurface, u: (f64, f64), v: (f64, f64)) -> RecognisedSurface {
        recognise(&Face::untrimmed(support.to_spline(u, v).expect("a spline").0))
    }

    fn ruled(a: &[Vec3], b: &[Vec3]) -> RecognisedSurface {
        let points: Vec<Vec3> = a.iter().zip(b).flat_map(|(p, q)| [*p, *q]).collect();
        let across = Knots::clamped(a.len() - 1, &[0.0, 1.0]).expect("knots");
        let along = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        recognise(&Face::untrimmed(Surface::new(across, along, &points, None).expect("a surface")))
    }

    #[test]
    fn elementary_surfaces_are_found_in_their_splines_with_their_sizes() {
        let z = Vec3::new(1.0, 2.0, 2.0) / 3.0;
        let frame = frame(Vec3::new(5.0, -3.0, 8.0), z);
        assert!(matches!(on(&SupportSurface::Plane(frame), (0.0, 3.0), (0.0, 9.0)), RecognisedSurface::Plane(_)));
        let RecognisedSurface::Cylinder { frame: f, radius } =
            on(&SupportSurface::Cylinder { frame, radius: 7.0 }, (0.3, 1.1), (0.0, 40.0))
        else {
            panic!("a cylinder")
        };
        assert!((radius - 7.0).abs() < 1e-9 && f.z.cross(&z).norm() < 1e-10);
        let RecognisedSurface::Cone { frame: f, half_angle } =
            on(&SupportSurface::Cone { frame, radius: 7.0, slope: 0.25 }, (0.3, 2.9), (0.0, 10.0))
        else {
            panic!("a cone")
        };
        assert!((half_angle - 0.25_f64.atan()).abs() < 1e-9);
        assert!((f.origin - (frame.origin - z * 28.0)).norm() < 1e-7);
        let torus = SupportSurface::Torus { frame, major: 20.0, minor: 4.0 };
        let RecognisedSurface::Curved(d) = on(&torus, (0.0, 1.0), (-0.5, 0.5)) else { panic!("a torus") };
        // Greatest where the ring is outermost: cos 0 / (4 · 24).
        assert!((d.curvature_estimate - 1.0 / 96.0).abs() < 2e-3 && d.twist_estimate.is_nan());
    }

    #[test]
    fn what_closes_on_itself_is_told_with_its_true_defect() {
        let frame = frame(Vec3::new(5.0, -3.0, 8.0), Vec3::z());
        let turn = std::f64::consts::TAU;
        let torus = SupportSurface::Torus { frame, major: 100.0, minor: 20.0 };
        let sphere = SupportSurface::Sphere { frame, radius: 100.0 };
        for (support, v, curvature) in
            [(torus, (0.0, turn), 1.0 / (20.0 * 80.0)), (sphere.clone(), (-0.25 * turn, 0.25 * turn), 1e-4)]
        {
            let RecognisedSurface::Curved(d) = on(&support, (0.0, turn), v) else { panic!("{support:?}") };
            assert!((d.curvature_estimate / curvature - 1.0).abs() < 1e-3, "{d:?}");
            assert!((0.5..1.0).contains(&d.strain_estimate), "{d:?}");
            assert!(d.twist_estimate.is_nan(), "circles are no rulings: {d:?}");
        }
        // A cap of small breadth: what its rim is too short by.
        let RecognisedSurface::Curved(d) = on(&sphere, (0.0, 0.2), (-0.1, 0.1)) else { panic!("a sphere") };
        assert!((d.strain_estimate / (0.2_f64.powi(2) / 16.0) - 1.0).abs() < 0.01, "{d:?}");
    }

    #[test]
    fn ruled_surfaces_are_told_apart_and_twist_is_measured() {
        let c = [Vec3::zeros(), Vec3::new(30.0, 0.0, 40.0), Vec3::new(90.0, 10.0, 0.0)];
        let moved = c.map(|p| p + Vec3::new(0.0, 70.0, 20.0));
        assert!(matches!(ruled(&c, &moved), RecognisedSurface::GeneralCylinder { .. }));
        let apex = Vec3::new(10.0, 200.0, -30.0);
        assert!(
            matches!(ruled(&c, &c.map(|p| p + (apex - p) * 0.5)), RecognisedSurface::GeneralCone { apex: a } if (a - apex).norm() < 1e-6)
        );
        // Tangents of a cubic: from the curve's own points along its derivative.
        let cubic = [Vec3::zeros(), Vec3::x() * 10.0, Vec3::new(20.0, 10.0, 0.0), Vec3::new(30.0, 30.0, 10.0)];
        let hodograph: Vec<Vec3> = cubic.windows(2).map(|w| w[1] - w[0]).collect();
        let elevated = |k: usize| match k {
            0 => hodograph[0],
            3 => hodograph[2],
            k => (hodograph[k - 1] * k as f64 + hodograph[k] * (3 - k) as f64) / 3.0,
        };
        let along = |s: f64| (0..4).map(|k| cubic[k] + elevated(k) * s).collect::<Vec<_>>();
        assert_eq!(ruled(&along(1.0), &along(3.0)), RecognisedSurface::TangentSurface);
        let mut before = 0.0;
        for lift in [1e-3, 1e-2, 1e-1, 1.0] {
            let mut twisted = moved;
            twisted[2].z += 100.0 * lift;
            let RecognisedSurface::Curved(d) = ruled(&c, &twisted) else { panic!("twisted by {lift}") };
            assert!(d.twist_estimate > before, "monotone with the twist");
            before = d.twist_estimate;
        }
    }
}
