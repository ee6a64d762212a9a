//! Joins of osculating cones that leave a choice: cones with a common vertex (osculating arc splines on the sphere) and
//! cones with parallel axes and equal openings or cylinders with parallel axes (osculating arc splines in the plane)
//! \[LP98\].
//!
//! There (14) says nothing: every ruling of the first cone, within bounds, begins a joining cone. The one after a
//! given share of the rotation is taken.

use super::join::{through, turn_to, Join, Osculating, NOT_SMOOTH};
use crate::geom::Vec3;
use crate::torse::cone::spline::{Segment, Shape};

/// Axes and openings, and vertices against the distance of the rulings, count as equal up to this.
const EQUAL: f64 = 1e-9;
/// Shares of the rotation after which joins are tried: the middle third to half is left to the filler.
const SHARES: [f64; 3] = [0.25, 0.2, 0.3];

/// Whether two cones leave a choice: a common vertex, or parallel axes and equal openings. Then every term of (14) is
/// rounding.
pub(super) fn leave_choice(first: &Osculating, second: &Osculating) -> bool {
    match (first.shape, second.shape) {
        (
            Shape::Cone { distance: d1, cos_gamma: k1, sin_gamma: s1, .. },
            Shape::Cone { distance: d2, cos_gamma: k2, sin_gamma: s2, .. },
        ) => {
            let apart = (first.element.at(-d1) - second.element.at(-d2)).norm();
            let turned = (first.piece(0.0).axis() - second.piece(0.0).axis()).norm();
            apart <= EQUAL * d1.abs().min(d2.abs()) || turned.max((k1 - k2).abs() + (s1 - s2).abs()) <= EQUAL
        }
        _ => false,
    }
}

/// Joins of cones whose join is not unique; none for others.
pub(super) fn arc_joins(first: &Osculating, second: &Osculating) -> Vec<Join> {
    match (first.shape, second.shape) {
        (Shape::Cone { distance: d1, cos_gamma: k1, sin_gamma: s1, .. }, Shape::Cone { distance: d2, .. })
            if leave_choice(first, second) =>
        {
            let (v1, v2) = (first.element.at(-d1), second.element.at(-d2));
            let w1 = first.piece(0.0).axis();
            if (v1 - v2).norm() <= EQUAL * d1.abs().min(d2.abs()) {
                let total = turn_to(first, &second.element.direction);
                return SHARES.iter().filter_map(|x| through(first, second, x * total)).collect();
            }
            // In the plane through v1 across the axis: signed radii, positive where the normals point away.
            // At the height z above its vertex a cone has the signed radius −z tan of its opening.
            let slope = k1.abs() / s1;
            let drop = (v2 - v1).dot(&w1);
            let planar = Planar { axis: w1, radii: [0.0, drop / slope], centres: [v1, v2 - w1 * drop], first, second };
            planar.joins()
        }
        (Shape::Cylinder { radius: r1, .. }, Shape::Cylinder { radius: r2, .. }) => {
            let axis = first.element.direction;
            if (axis - second.element.direction).norm() > EQUAL {
                return Vec::new();
            }
            let centre = |o: &Osculating, r: f64| o.element.point - o.element.normal * r;
            let c1 = centre(first, r1);
            let c2 = centre(second, r2);
            let c2 = c2 - axis * (c2 - c1).dot(&axis);
            Planar { axis, radii: [r1, r2], centres: [c1, c2], first, second }.joins()
        }
        _ => Vec::new(),
    }
}

/// Two circles in a plane that stand for cones with parallel axes.
struct Planar<'a> {
    axis: Vec3,
    radii: [f64; 2],
    centres: [Vec3; 2],
    first: &'a Osculating,
    second: &'a Osculating,
}

impl Planar<'_> {
    fn joins(&self) -> Vec<Join> {
        let radial = |o: &Osculating| {
            let n = o.element.normal;
            (n - self.axis * n.dot(&self.axis)).normalize()
        };
        let (a, b) = (radial(self.first), radial(self.second));
        let total = self.axis.dot(&a.cross(&b)).atan2(a.dot(&b));
        SHARES.iter().filter_map(|x| self.join(x * total)).collect()
    }

    /// The join after the turn `f`: a circle that touches both.
    fn join(&self, f: f64) -> Option<Join> {
        let at = self.first.piece(f).end();
        let n = at.normal;
        let u = (n - self.axis * n.dot(&self.axis)).try_normalize(0.0)?;
        let [r1, r2] = self.radii;
        // Centre c1 + x u with the radius r1 − x; its distance from c2 is r1 − x − r2.
        let d = self.centres[0] - self.centres[1];
        let gap = r1 - r2;
        let x = (gap * gap - d.norm_squared()) / (2.0 * (d.dot(&u) + gap));
        let (c, r) = (self.centres[0] + u * x, r1 - x);
        let towards = (c - self.centres[1]) / (r2 - r);
        let towards = towards.try_normalize(0.0)?;
        let turn = self.axis.dot(&u.cross(&towards)).atan2(u.dot(&towards));
        let shape = match self.first.shape {
            Shape::Cylinder { .. } => Shape::Cylinder { radius: r, angle: turn },
            Shape::Cone { cos_gamma, sin_gamma, .. } => {
                let vertex = c + self.axis * ((r - r1) * cos_gamma.abs() / sin_gamma);
                let along = (at.point - vertex).dot(&at.direction);
                Shape::Cone { distance: along, cos_gamma, sin_gamma, angle: turn }
            }
            Shape::Flat { .. } => return None,
        };
        let filler_segment = Segment::new(at, shape);
        let end = filler_segment.end();
        let second_turn = match self.second.shape {
            Shape::Cylinder { .. } => {
                let g = &self.second.element;
                g.direction.dot(&g.normal.cross(&end.normal)).atan2(g.normal.dot(&end.normal))
            }
            _ => turn_to(self.second, &end.direction),
        };
        let to = self.second.piece(second_turn).end();
        let length = (self.second.element.point - self.first.element.point).norm();
        let off = end.mismatch(&to, length);
        (off < NOT_SMOOTH).then_some(Join { first_angle: f, second_angle: -second_turn, filler: filler_segment })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{osculating_spline, ConeOptions};
    use super::*;
    use crate::torse::g1_element::G1Element;
    use crate::torse::ruled_patch::StripJet;

    fn cones(jet: impl Fn(f64) -> StripJet, us: [f64; 4]) -> Vec<Osculating> {
        us.map(jet).iter().map(|j| Osculating::of(&j.element().expect("element"), j)).collect()
    }

    fn check(cones: &[Osculating]) {
        let s = osculating_spline(cones, &[], &ConeOptions::default()).expect("spline");
        assert!(s.pairs.is_empty(), "{:?}", s.pairs);
        assert_eq!(s.spline.segments.len(), 7);
        assert!(s.spline.mismatch(1.0) < 1e-10, "{:e}", s.spline.mismatch(1.0));
        assert!(s.spline.segments.iter().all(|s| s.fault().is_none()));
        let (a, b): (G1Element, G1Element) = (s.spline.segments[0].start, s.spline.segments[6].end());
        assert!(a.mismatch(&cones[0].element, 1.0) < 1e-13 && b.mismatch(&cones[3].element, 1.0) < 1e-10);
    }

    /// A strip over the plane curve `(x, x²)`, whose rulings end there and in `top`.
    fn over_parabola(top: impl Fn(f64) -> [Vec3; 3]) -> impl Fn(f64) -> StripJet {
        move |u: f64| {
            let c = [Vec3::new(u, u * u, 0.0), Vec3::new(1.0, 2.0 * u, 0.0), Vec3::new(0.0, 2.0, 0.0)];
            StripJet { ends: [c, top(u)] }
        }
    }

    const US: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

    #[test]
    fn general_cylinders_get_planar_osculating_arc_splines() {
        let lift = |u: f64| [Vec3::new(u, u * u, 1.0), Vec3::new(1.0, 2.0 * u, 0.0), Vec3::new(0.0, 2.0, 0.0)];
        check(&cones(over_parabola(lift), US));
    }

    /// Rulings at equal slopes of `y = x³` on both sides of its inflection: neither a rotation to take a share of, nor
    /// a pair. Both elements are named.
    #[test]
    fn across_an_inflection_without_rotation_the_elements_are_named() {
        let jet = |u: f64| {
            let c = [Vec3::new(u, u.powi(3), 0.0), Vec3::new(1.0, 3.0 * u * u, 0.0), Vec3::new(0.0, 6.0 * u, 0.0)];
            StripJet { ends: [c, [c[0] + Vec3::z(), c[1], c[2]]] }
        };
        let cones = cones(jet, [-0.6, -0.3, 0.3, 0.6]);
        let error = osculating_spline(&cones, &[], &ConeOptions::default()).expect_err("no chain").to_string();
        assert!(error.contains("elements 1 and 2") && error.contains("inflection"), "{error}");
    }

    #[test]
    fn general_cones_get_spherical_osculating_arc_splines() {
        // Half way to the vertex (0, 0, 4).
        let lift = |u: f64| [Vec3::new(0.5 * u, 0.5 * u * u, 2.0), Vec3::new(0.5, u, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        check(&cones(over_parabola(lift), US));
    }

    #[test]
    fn surfaces_of_constant_slope_get_planar_osculating_arc_splines() {
        // Rulings rise at 45° across the parabola, whose radius falls on the inner side.
        let lift = |u: f64| {
            // Unit normal of the parabola times 0.2, and its derivatives.
            let q = 1.0 + 4.0 * u * u;
            let (s, ds, dds) =
                (q.powf(-0.5), -4.0 * u * q.powf(-1.5), -4.0 * q.powf(-1.5) + 48.0 * u * u * q.powf(-2.5));
            let n = Vec3::new(-2.0 * u * s, s, 0.0);
            let dn = Vec3::new(-2.0 * s - 2.0 * u * ds, ds, 0.0);
            let ddn = Vec3::new(-4.0 * ds - 2.0 * u * dds, dds, 0.0);
            let h = 0.2;
            [
                Vec3::new(u, u * u, 0.0) + n * h + Vec3::z() * h,
                Vec3::new(1.0, 2.0 * u, 0.0) + dn * h,
                Vec3::new(0.0, 2.0, 0.0) + ddn * h,
            ]
        };
        check(&cones(over_parabola(lift), US));
    }
}
