//! Nearest points of NURBS surfaces with their curvatures \[PT97\].

use super::{principal, Foot, Reference};
use crate::brep::project::{refine, SurfaceProjector};
use crate::geom::Vec3;
use crate::spline::surface::Surface;

/// Some surfaces taken together.
pub(crate) struct FaceReference {
    surfaces: Vec<(Surface, SurfaceProjector)>,
}

/// Share of a domain within which a parameter lies on the border: beyond it, the nearest point says nothing about offsets
/// along the surface.
const BORDER: f64 = 1e-9;
/// A foot found from an old one is looked for anew if the distance has grown by this factor and share of the size.
const GROWN: f64 = 2.0;

impl FaceReference {
    /// The surfaces; lengths in mm.
    pub fn new(surfaces: Vec<Surface>) -> Self {
        let with = |s: Surface| {
            let projector = SurfaceProjector::new(&s);
            (s, projector)
        };
        Self { surfaces: surfaces.into_iter().map(with).collect() }
    }

    fn described(&self, of: usize, at: [f64; 2]) -> Option<Foot> {
        let (surface, _) = self.surfaces.get(of)?;
        let j = surface.jet(at[0], at[1]);
        let normal = j.normal().try_normalize(0.0)?;
        let x = j.du.try_normalize(0.0)?;
        let y = normal.cross(&x);
        // Second fundamental form in the frame x, y: S_u = a x, S_v = b x + c y.
        let (a, b, c) = (j.du.norm(), j.dv.dot(&x), j.dv.dot(&y));
        let [l, m, n] = j.second_form(&normal);
        let xx = l / (a * a);
        let xy = (m / a - b * xx) / c;
        let yy = (n - b * b * xx - 2.0 * b * c * xy) / (c * c);
        let ((u0, u1), (v0, v1)) = surface.domain();
        let inside = |t: f64, a: f64, b: f64| t > a + BORDER * (b - a) && t < b - BORDER * (b - a);
        let (directions, mut curvatures) = principal(xx, xy, yy, [x, y]);
        if !(inside(at[0], u0, u1) && inside(at[1], v0, v1) && curvatures.iter().all(|k| k.is_finite())) {
            curvatures = [0.0; 2];
        }
        Some(Foot { point: j.p, normal, directions, curvatures, at, of })
    }
}

impl Reference for FaceReference {
    fn foot(&self, x: &Vec3, near: Option<&Foot>) -> Option<Foot> {
        if let Some(old) = near {
            let (surface, _) = self.surfaces.get(old.of)?;
            let found = refine(surface, x, old.at);
            // The old foot is a bound that only a wrong start exceeds.
            if found.distance <= GROWN * (x - old.point).norm() && self.surfaces.len() == 1 {
                return self.described(old.of, found.at);
            }
        }
        let nearest = self.surfaces.iter().enumerate().map(|(k, (s, p))| (k, p.nearest(s, x)));
        let (of, foot) = nearest.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))?;
        self.described(of, foot.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;

    #[test]
    fn a_cylinder_has_its_curvatures() {
        let cylinder = SupportSurface::Cylinder { frame: Frame::world(), radius: 2.0 };
        let (s, _) = cylinder.to_spline((0.0, 3.0), (0.0, 5.0)).expect("a surface");
        let reference = FaceReference::new(vec![s]);
        let x = Vec3::new(1.0, 1.0, 2.0);
        let foot = reference.foot(&x, None).expect("a foot");
        assert!((foot.point - Vec3::new(2f64.sqrt(), 2f64.sqrt(), 2.0)).norm() < 1e-9);
        let bent = usize::from(foot.curvatures[1].abs() > foot.curvatures[0].abs());
        let outward = foot.normal.dot(&Vec3::new(1.0, 1.0, 0.0)).signum();
        assert!((foot.curvatures[bent] + outward * 0.5).abs() < 1e-9, "{foot:?}");
        assert!(foot.curvatures[1 - bent].abs() < 1e-9 && foot.directions[bent].z.abs() < 1e-9);
        // From the old foot, and beyond the border, where nothing is known of offsets.
        let again = reference.foot(&Vec3::new(1.1, 0.9, 2.0), Some(&foot)).expect("a foot");
        assert!((again.point.xy().norm() - 2.0).abs() < 1e-9);
        assert_eq!(reference.foot(&Vec3::new(2.0, 0.5, 7.0), None).expect("a foot").curvatures, [0.0; 2]);
    }
}
