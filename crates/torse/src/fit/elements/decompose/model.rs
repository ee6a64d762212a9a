//! Costs of the four shapes of a run from the moment of its planes (section 1C of \[W15\], Proposition 1.12).

use crate::geom::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// The four shapes, before their parameters are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Model {
    Plane,
    Cylinder,
    Cone,
    Tangent,
}

impl Model {
    /// Conditions on each plane of a run.
    fn conditions(self) -> f64 {
        match self {
            Self::Plane => 3.0,
            Self::Cylinder | Self::Cone => 1.0,
            Self::Tangent => 0.0,
        }
    }

    /// Parameters of a run of `length` planes: those of the shape and a share per plane for its free functions, one of
    /// a cylinder and a cone, and a little more for a curve of space.
    fn parameters(self, length: f64) -> f64 {
        match self {
            Self::Plane => 3.0,
            Self::Cylinder => 2.0 + 0.25 * length,
            Self::Cone => 3.0 + 0.25 * length,
            Self::Tangent => 6.0 + 0.375 * length,
        }
    }

    /// Whether noise alone explains what the shape leaves.
    pub(super) fn fits(self, moment: &Moment, variance: f64) -> bool {
        moment.left(self, variance).is_some_and(|chi| chi <= EXPLAINED * self.conditions() * moment.length * variance)
    }
}

/// Multiple of the expected sum of squares that noise explains: free up to here, so that the choice between shapes
/// does not depend on how well the noise is known.
const EXPLAINED: f64 = 1.5;
/// Normals of a cone leave every plane by at least this many times the noise; otherwise the apex is not determined.
const OUT_OF_PLANE: f64 = 4.0;

/// Sums of products of the coordinates `(n, h)` of planes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moment {
    length: f64,
    sum: [f64; 4],
    /// xx, xy, xz, yy, yz, zz of the normals.
    normals: [f64; 6],
    /// Normals times offset, and offset squared.
    offsets: [f64; 4],
}

impl Moment {
    pub(super) fn of(planes: &[[f64; 4]]) -> Self {
        let mut out = Self { length: planes.len() as f64, ..Self::default() };
        for p in planes {
            let [x, y, z, d] = *p;
            for (s, v) in out.sum.iter_mut().zip(p) {
                *s += v;
            }
            for (s, v) in out.normals.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
                *s += v;
            }
            for (s, v) in out.offsets.iter_mut().zip([x * d, y * d, z * d, d * d]) {
                *s += v;
            }
        }
        out
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.length += other.length;
        let pairs = [
            (&mut self.sum[..], &other.sum[..]),
            (&mut self.normals, &other.normals),
            (&mut self.offsets, &other.offsets),
        ];
        for (a, b) in pairs {
            for (x, y) in a.iter_mut().zip(b) {
                *x += y;
            }
        }
    }

    pub(super) fn mean(&self) -> [f64; 4] {
        self.sum.map(|s| s / self.length)
    }

    fn matrix(&self) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.normals;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Least eigenvalue of the moment of the normals, not below 0.
    ///
    /// The closed form; its error is some rounding errors of the largest eigenvalue, the number of planes, which the
    /// least noise covers.
    fn flatness(&self) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.normals;
        let off = xy * xy + xz * xz + yz * yz;
        let q = (xx + yy + zz) / 3.0;
        let (a, b, c) = (xx - q, yy - q, zz - q);
        let p = ((a * a + b * b + c * c + 2.0 * off) / 6.0).sqrt();
        if p == 0.0 {
            return q.max(0.0);
        }
        let det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
        let half = (0.5 * det / (p * p * p)).clamp(-1.0, 1.0);
        let angle = half.acos() / 3.0 + std::f64::consts::TAU / 3.0;
        (q + 2.0 * p * angle.cos()).max(0.0)
    }

    /// Unit direction nearest to orthogonal to all normals.
    pub(super) fn axis(&self) -> Vec3 {
        let e = SymmetricEigen::new(self.matrix());
        let i = e.eigenvalues.imin();
        e.eigenvectors.column(i).into_owned()
    }

    /// The point nearest to all planes, by least squares of `n·X − h`.
    pub(super) fn apex(&self) -> Option<Vec3> {
        let [x, y, z, _] = self.offsets;
        // Cramer's rule without pivots loses digits only where the guard of `left` refuses a cone.
        let m = self.matrix();
        let apex = m.try_inverse()? * Vec3::new(x, y, z);
        apex.iter().all(|c| c.is_finite()).then_some(apex)
    }

    /// Sum of squares that a model leaves; `None` where it is not determined.
    fn left(&self, model: Model, variance: f64) -> Option<f64> {
        match model {
            Model::Plane => {
                let squares = self.normals[0] + self.normals[3] + self.normals[5] + self.offsets[3];
                let mean: f64 = self.sum.iter().map(|s| s * s).sum::<f64>() / self.length;
                Some((squares - mean).max(0.0))
            }
            Model::Cylinder => Some(self.flatness()),
            Model::Cone => {
                if self.flatness() <= OUT_OF_PLANE * self.length * variance {
                    return None;
                }
                let p = self.apex()?;
                let [x, y, z, d] = self.offsets;
                let chi = p.dot(&(self.matrix() * p)) - 2.0 * p.dot(&Vec3::new(x, y, z)) + d;
                Some(chi.max(0.0) / (1.0 + p.norm_squared()))
            }
            Model::Tangent => Some(0.0),
        }
    }

    /// Cost of the run as this model; infinite where the model is not determined.
    pub(super) fn cost(&self, model: Model, variance: f64, per_parameter: f64) -> f64 {
        let Some(chi) = self.left(model, variance) else { return f64::INFINITY };
        let data = (chi / variance - EXPLAINED * model.conditions() * self.length).max(0.0);
        data + self.least_cost(model, per_parameter)
    }

    /// What the parameters of a model cost, whatever it leaves.
    pub(super) fn least_cost(&self, model: Model, per_parameter: f64) -> f64 {
        per_parameter * model.parameters(self.length)
    }

    /// Root mean square of what a model leaves per plane.
    pub(super) fn residual(&self, model: Model) -> f64 {
        self.left(model, 0.0).map_or(0.0, |chi| (chi / self.length).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_finds_the_least_eigenvalue() {
        let planes: Vec<[f64; 4]> = (0..9)
            .map(|k| {
                let (s, c) = (0.1 * f64::from(k)).sin_cos();
                let n = Vec3::new(c, s, 0.02 * f64::from(k % 3)).normalize();
                [n.x, n.y, n.z, 0.3]
            })
            .collect();
        let m = Moment::of(&planes);
        let eigen = SymmetricEigen::new(m.matrix()).eigenvalues.min();
        assert!((m.flatness() - eigen).abs() < 1e-14);
        let axis = m.axis();
        assert!(
            (planes.iter().map(|p| axis.dot(&Vec3::new(p[0], p[1], p[2])).powi(2)).sum::<f64>() - eigen).abs() < 1e-14
        );
        let equal = Moment::of(&[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        assert!((equal.flatness() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn moments_add_up() {
        let planes = [[1.0, 0.0, 0.0, 2.0], [0.0, 1.0, 0.0, -1.0], [0.6, 0.8, 0.0, 0.5]];
        let mut sum = Moment::of(&planes[..1]);
        sum.add(&Moment::of(&planes[1..]));
        let whole = Moment::of(&planes);
        assert_eq!((sum.normals, sum.offsets, sum.sum), (whole.normals, whole.offsets, whole.sum));
    }
}
