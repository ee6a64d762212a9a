//! Measures in a reference plane and the distances between planes that they define.
//!
//! The distance between the graphs of two linear functions of (x, y) is the L² norm of their difference in a measure μ
//! of the xy-plane: a region of interest, point masses, or any sum \[PW99, (6)–(8)\]. All that matters of μ is the Gram
//! matrix of 1, x, y.

use super::Vec2;

/// Symmetric 3×3 matrix of the integrals of products of 1, x and y.
pub(crate) type Gram = [[f64; 3]; 3];

/// Smallest ratio of the principal second moments for which a measure counts as not concentrated in a line: below it,
/// distances along one tilt of a plane are seen only at the level of rounding.
const LINE: f64 = 1e-12;

/// Data that define no measure, or none that measures distances between planes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// A coordinate, radius or mass is not finite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// The total mass is not positive.
    #[error("the total mass {0} is not positive")]
    Mass(f64),
    /// Fewer than three vertices.
    #[error("a polygon needs at least three vertices, {0} are given")]
    Polygon(usize),
    /// Different numbers of points and masses.
    #[error("{points} points but {masses} masses")]
    Count {
        /// Number of points.
        points: usize,
        /// Number of masses.
        masses: usize,
    },
    /// The measure is concentrated in a line, so that planes through that line cannot be told apart (Lemma 4).
    #[error("the measure is concentrated in a line (ratio of second moments {0:e}): add a point or area beside it")]
    OnALine(f64),
}

/// A positive measure of the xy-plane with finite second moments, known by its Gram matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    gram: Gram,
}

impl Measure {
    /// Area of the rectangle `[x0, x1] × [y0, y1]` (mm; ends in any order).
    ///
    /// # Errors
    /// Ends that are not finite, or no area.
    pub fn rectangle(x: [f64; 2], y: [f64; 2]) -> Result<Self, MeasureError> {
        let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        Self::polygon(&corners)
    }

    /// Area of a simple polygon (mm), vertices in either direction.
    ///
    /// *Method*: Green's formula, the sign taken from the signed area.
    ///
    /// # Errors
    /// Fewer than three vertices, coordinates that are not finite, no area.
    pub fn polygon(vertices: &[[f64; 2]]) -> Result<Self, MeasureError> {
        if vertices.len() < 3 {
            return Err(MeasureError::Polygon(vertices.len()));
        }
        if vertices.iter().flatten().any(|x| !x.is_finite()) {
            return Err(MeasureError::NotFinite("a vertex of the polygon"));
        }
        // About the first vertex, where the cancellation of far away polygons does no harm.
        let o = vertices[0];
        let (mut m, mut mx, mut my, mut mxx, mut mxy, mut myy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (i, a) in vertices.iter().enumerate() {
            let b = vertices[(i + 1) % vertices.len()];
            let (ax, ay, bx, by) = (a[0] - o[0], a[1] - o[1], b[0] - o[0], b[1] - o[1]);
            let cross = ax * by - bx * ay;
            m += cross / 2.0;
            mx += cross * (ax + bx) / 6.0;
            my += cross * (ay + by) / 6.0;
            mxx += cross * (ax * ax + ax * bx + bx * bx) / 12.0;
            myy += cross * (ay * ay + ay * by + by * by) / 12.0;
            mxy += cross * (2.0 * ax * ay + ax * by + bx * ay + 2.0 * bx * by) / 24.0;
        }
        let sign = if m < 0.0 { -1.0 } else { 1.0 };
        let local = Self::checked([[m, mx, my], [mx, mxx, mxy], [my, mxy, myy]].map(|r| r.map(|v| sign * v)))?;
        Ok(local.transformed([[1.0, 0.0], [0.0, 1.0]], o))
    }

    /// Area of a disc (mm).
    ///
    /// # Errors
    /// Numbers that are not finite, a radius that is not positive.
    pub fn disc(centre: [f64; 2], radius: f64) -> Result<Self, MeasureError> {
        let area = std::f64::consts::PI * radius * radius;
        let [x, y] = centre;
        let q = radius * radius / 4.0;
        Self::checked([[1.0, x, y], [x, x * x + q, x * y], [y, x * y, y * y + q]].map(|r| r.map(|v| area * v)))
    }

    /// Point masses (mm; masses not negative, not all zero).
    ///
    /// # Errors
    /// Counts that differ, numbers that are not finite, negative masses.
    pub fn masses(points: &[[f64; 2]], masses: &[f64]) -> Result<Self, MeasureError> {
        if points.len() != masses.len() {
            return Err(MeasureError::Count { points: points.len(), masses: masses.len() });
        }
        let mut gram = [[0.0; 3]; 3];
        for (p, &w) in points.iter().zip(masses) {
            if w < 0.0 {
                return Err(MeasureError::Mass(w));
            }
            let v = [1.0, p[0], p[1]];
            for i in 0..3 {
                for j in 0..3 {
                    gram[i][j] += w * v[i] * v[j];
                }
            }
        }
        Self::checked(gram)
    }

    /// The measure with a given Gram matrix of 1, x, y: any measure with these second moments.
    ///
    /// # Errors
    /// Entries that are not finite, no mass, negative second moments, or an asymmetric matrix.
    pub fn of_gram(gram: Gram) -> Result<Self, MeasureError> {
        Self::checked(gram)
    }

    fn checked(gram: Gram) -> Result<Self, MeasureError> {
        if gram.iter().flatten().any(|x| !x.is_finite()) {
            return Err(MeasureError::NotFinite("a moment of the measure"));
        }
        if gram[0][0] <= 0.0 || gram[1][1] < 0.0 || gram[2][2] < 0.0 {
            return Err(MeasureError::Mass(gram[0][0]));
        }
        Ok(Self { gram })
    }

    /// Integrals of products of 1, x and y.
    pub fn gram(&self) -> &Gram {
        &self.gram
    }

    /// Total mass.
    pub fn mass(&self) -> f64 {
        self.gram[0][0]
    }

    /// Centre of mass.
    pub fn centre(&self) -> [f64; 2] {
        [self.gram[0][1] / self.gram[0][0], self.gram[0][2] / self.gram[0][0]]
    }

    /// Central second moments per mass.
    fn covariance(&self) -> [[f64; 2]; 2] {
        let (c, g) = (self.centre(), &self.gram);
        std::array::from_fn(|i| std::array::from_fn(|j| g[i + 1][j + 1] / g[0][0] - c[i] * c[j]))
    }

    /// The measure with all masses multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { gram: self.gram.map(|r| r.map(|v| factor * v)) }
    }

    /// The sum of two measures.
    pub fn plus(&self, other: &Self) -> Self {
        Self { gram: std::array::from_fn(|i| std::array::from_fn(|j| self.gram[i][j] + other.gram[i][j])) }
    }

    /// The image of the measure under `p ↦ linear p + shift`.
    pub fn transformed(&self, linear: [[f64; 2]; 2], shift: [f64; 2]) -> Self {
        let t = [[1.0, 0.0, 0.0], [shift[0], linear[0][0], linear[0][1]], [shift[1], linear[1][0], linear[1][1]]];
        let gram = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let mut sum = 0.0;
                for a in 0..3 {
                    for b in 0..3 {
                        sum += t[i][a] * self.gram[a][b] * t[j][b];
                    }
                }
                sum
            })
        });
        Self { gram }
    }

    /// Whether distances in this measure are a Euclidean metric of the planes: exactly if the measure is not
    /// concentrated in a line \[PW99, Lemma 4\]. Judged after centring and scaling.
    ///
    /// # Errors
    /// [`MeasureError::OnALine`] with the ratio of the principal moments.
    pub fn is_metric(&self) -> Result<(), MeasureError> {
        let [[a, b], [_, d]] = self.covariance();
        let (mean, half) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * b).sqrt());
        let large = mean + half;
        // The determinant gives the small eigenvalue without cancellation against the large one.
        let ratio = if large > 0.0 { (a * d - b * b) / (large * large) } else { 0.0 };
        if ratio > LINE {
            Ok(())
        } else {
            Err(MeasureError::OnALine(ratio.max(0.0)))
        }
    }

    /// Squared distance of two planes `z = u0 + u1 x + u2 y` whose coordinates differ by `difference`.
    pub fn distance_sq(&self, difference: &[f64; 3]) -> f64 {
        (0..3).map(|i| (0..3).map(|j| difference[i] * self.gram[i][j] * difference[j]).sum::<f64>()).sum()
    }

    /// Upper triangular `R` with `RᵀR` = Gram matrix: the distance is the Euclidean norm of `R · difference`.
    ///
    /// # Errors
    /// The measure is concentrated in a line.
    pub fn root(&self) -> Result<Gram, MeasureError> {
        self.is_metric()?;
        let g = &self.gram;
        let r00 = g[0][0].sqrt();
        let (r01, r02) = (g[0][1] / r00, g[0][2] / r00);
        let r11 = (g[1][1] - r01 * r01).max(f64::MIN_POSITIVE).sqrt();
        let r12 = (g[1][2] - r01 * r02) / r11;
        let r22 = (g[2][2] - r02 * r02 - r12 * r12).max(0.0).sqrt();
        Ok([[r00, r01, r02], [0.0, r11, r12], [0.0, 0.0, r22]])
    }

    /// Three points whose unit masses define the same distances up to a factor: `(3 / mass) ·` Gram matrix. One of a
    /// family with the angle `turn` (radians).
    ///
    /// *Method*: `p_j = c + √2 L (cos θ_j, sin θ_j)` with the centre `c`, `L Lᵀ` the central moments per mass and
    /// angles 120° apart. Where \[PW99, 4.1\] says that the problem is quadratic: it has this closed form.
    pub fn three_masses(&self, turn: f64) -> [Vec2; 3] {
        let ([[a, b], [_, d]], c) = (self.covariance(), self.centre());
        let l00 = a.max(0.0).sqrt();
        let l10 = if l00 > 0.0 { b / l00 } else { 0.0 };
        let l11 = (d - l10 * l10).max(0.0).sqrt();
        std::array::from_fn(|j| {
            let angle = turn + std::f64::consts::TAU * j as f64 / 3.0;
            let (x, y) = (std::f64::consts::SQRT_2 * angle.cos(), std::f64::consts::SQRT_2 * angle.sin());
            Vec2::new(c[0] + l00 * x, c[1] + l10 * x + l11 * y)
        })
    }
}

/// A positive measure of the x-axis: for distances between rulings in their ground plan \[PW99, (11)\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineMeasure {
    /// Integrals of products of 1 and x.
    pub gram: [[f64; 2]; 2],
}

impl LineMeasure {
    /// Length of the interval `[a, b]`, mm.
    ///
    /// # Errors
    /// Ends that are not finite or do not increase.
    pub fn interval(a: f64, b: f64) -> Result<Self, MeasureError> {
        if !(a.is_finite() && b.is_finite()) {
            return Err(MeasureError::NotFinite("an end of the interval"));
        }
        if a >= b {
            return Err(MeasureError::Mass(b - a));
        }
        let m1 = (b * b - a * a) / 2.0;
        Ok(Self { gram: [[b - a, m1], [m1, (b * b * b - a * a * a) / 3.0]] })
    }

    /// Upper triangular root as in [`Measure::root`].
    pub fn root(&self) -> [[f64; 2]; 2] {
        let r00 = self.gram[0][0].sqrt();
        let r01 = self.gram[0][1] / r00;
        [[r00, r01], [0.0, (self.gram[1][1] - r01 * r01).max(0.0).sqrt()]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rectangle_disc_and_masses_have_their_moments() {
        let r = Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).expect("area");
        let third = 4.0 / 3.0;
        for (got, wanted) in r.gram().iter().flatten().zip([4.0, 0.0, 0.0, 0.0, third, 0.0, 0.0, 0.0, third]) {
            assert!((got - wanted).abs() < 1e-14);
        }
        // A disc as a polygon of many sides.
        let d = Measure::disc([0.3, -0.2], 0.7).expect("area");
        let many: Vec<[f64; 2]> = (0..2000)
            .map(|i| {
                let a = -std::f64::consts::TAU * f64::from(i) / 2000.0;
                [0.3 + 0.7 * a.cos(), -0.2 + 0.7 * a.sin()]
            })
            .collect();
        let p = Measure::polygon(&many).expect("area, clockwise");
        for (a, b) in d.gram().iter().flatten().zip(p.gram().iter().flatten()) {
            assert!((a - b).abs() < 1e-5);
        }
    }

    #[test]
    fn lemma_4_metric_unless_on_a_line() {
        let line = Measure::masses(&[[0.0, 1.0], [1.0, 2.0], [5.0, 6.0]], &[1.0, 2.0, 3.0]).expect("mass");
        assert!(matches!(line.is_metric(), Err(MeasureError::OnALine(_))));
        // The plane through the line over y = x + 1 is not told apart from the zero plane.
        assert!(line.distance_sq(&[1.0, 1.0, -1.0]).abs() < 1e-12);
        let off = Measure::masses(&[[0.0, 1.0], [1.0, 2.0], [5.0, 6.001]], &[1.0, 2.0, 3.0]).expect("mass");
        assert!(off.is_metric().is_ok() && off.distance_sq(&[1.0, 1.0, -1.0]) > 0.0);
        assert!(Measure::disc([1e4, 1e4], 1.0).expect("disc").is_metric().is_ok());
    }

    #[test]
    fn bad_measures_are_refused() {
        assert!(matches!(Measure::polygon(&[[0.0, 0.0], [1.0, 0.0]]), Err(MeasureError::Polygon(2))));
        assert!(matches!(Measure::disc([0.0, f64::NAN], 1.0), Err(MeasureError::NotFinite(_))));
        assert!(matches!(Measure::masses(&[[0.0, 0.0]], &[-1.0]), Err(MeasureError::Mass(_))));
        assert!(matches!(Measure::masses(&[[0.0, 0.0]], &[]), Err(MeasureError::Count { .. })));
        assert!(matches!(Measure::rectangle([0.0, 0.0], [0.0, 1.0]), Err(MeasureError::Mass(_))));
        assert!(LineMeasure::interval(1.0, 1.0).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn three_masses_reproduce_the_distances(
            points in proptest::collection::vec((-5.0..5.0f64, -5.0..5.0f64, 0.1..2.0f64), 3..8), turn in 0.0..3.0f64,
        ) {
            let p: Vec<[f64; 2]> = points.iter().map(|t| [t.0, t.1]).collect();
            let w: Vec<f64> = points.iter().map(|t| t.2).collect();
            let m = Measure::masses(&p, &w).expect("mass");
            let three = m.three_masses(turn).map(|v| [v.x, v.y]);
            let again = Measure::masses(&three, &[1.0; 3]).expect("mass");
            let scaled = m.scaled(3.0 / m.mass());
            for (a, b) in again.gram().iter().flatten().zip(scaled.gram().iter().flatten()) {
                prop_assert!((a - b).abs() < 1e-11);
            }
        }

        #[test]
        fn roots_give_the_distance(x in -3.0..3.0f64, y in -3.0..3.0f64, z in -3.0..3.0f64) {
            let m = Measure::rectangle([-1.2, 0.7], [0.1, 2.0]).expect("area");
            let r = m.root().expect("a metric");
            let e = [x, y, z];
            let norm: f64 = r.iter().map(|row| (0..3).map(|i| row[i] * e[i]).sum::<f64>().powi(2)).sum();
            prop_assert!((norm - m.distance_sq(&e)).abs() < 1e-11);
        }
    }
}
