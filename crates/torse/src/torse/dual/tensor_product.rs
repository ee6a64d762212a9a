//! Conversion to tensor-product form: polynomial (1, k) for type (3), rational (1, 2k−2) for the others.
//!
//! *Method.* Type (3) by \[PW99, Lemma 2 and Corollary 3\]: the section with the plane x = c is
//! `(c, −h', h − t h')` with `h = u0 + c u1`, a polynomial spline of degree k whose interior knots have one more
//! multiplicity. Types (1) and (2): with `U = (1−s) A + s B` on a span, `U ∧ U'` is a constant times `A ∧ B`, so the
//! section with a plane P is `A ∧ B ∧ P` of degree exactly 2k−2; both boundaries carry the same factor, so that equal
//! parameters lie on one ruling and the second parameter runs linearly along it.

use super::assemble::from_pieces;
use super::wedge::{line_of_planes, point_of_line_and_plane};
use super::{DualCurve, DualError, DualKind, Plane};
use crate::geom::Vec3;
use crate::spline::bezier::Bezier;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// Refinements by halving every span that are tried before positive weights are given up.
const REFINEMENTS: usize = 6;

impl DualCurve {
    /// Section of a surface of type (3) with the plane `x = c`: a polynomial spline of the same degree \[PW99, Lemma 2\].
    ///
    /// # Errors
    /// Another type; planes that are only continuous at a knot.
    pub fn section(&self, c: f64) -> Result<Curve<3>, DualError> {
        if self.kind() != DualKind::Slope {
            return Err(DualError::Kind { wanted: DualKind::Slope, kind: self.kind() });
        }
        let knots = self.section_knots(self.knots().degree(), |m| m + 1)?;
        let pieces: Vec<(f64, f64, Bezier<3>)> = self
            .pieces()
            .into_iter()
            .map(|(a, b, u)| {
                // Heights of the planes over y = 0.
                let h =
                    u.component(3).minus(&Bezier::new(u.component(0).control().iter().map(|x| [c * x[0]]).collect()));
                let slope = Bezier::new(h.derivative().control().iter().map(|x| [x[0] / (b - a)]).collect());
                let z = h.minus(&slope.times(&Bezier::new(vec![[a], [b]])));
                let y = slope.elevated(1);
                let points = y.control().iter().zip(z.control()).map(|(y, z)| [c, -y[0], z[0]]).collect();
                (a, b, Bezier::new(points))
            })
            .collect();
        Ok(from_pieces(knots, &pieces)?)
    }

    /// A surface of type (3) between the planes `x = a` and `x = b` as a polynomial tensor-product surface of degree
    /// (k, 1): u selects the ruling, v runs from a to b \[PW99, Corollary 3\].
    ///
    /// # Errors
    /// As [`DualCurve::section`].
    pub fn tensor_product(&self, a: f64, b: f64) -> Result<Surface, DualError> {
        let (from, to) = (self.section(a)?, self.section(b)?);
        let points: Vec<Vec3> =
            from.control.iter().zip(&to.control).flat_map(|(p, q)| [Vec3::from(*p), Vec3::from(*q)]).collect();
        let across = Knots::uniform(1, 1, 0.0, 1.0)?;
        Ok(Surface::new(from.knots, across, &points, None)?)
    }

    /// Homogeneous section `(w x, w y, w z, w)` of degree 2k−2 with a plane. Sections with different planes share
    /// their factor. Weights may be of any sign.
    ///
    /// # Errors
    /// Degree 1; planes that are only continuous at a knot.
    pub fn rational_section(&self, plane: &Plane) -> Result<Curve<4>, DualError> {
        let k = self.knots().degree();
        if k < 2 {
            return Err(DualError::Degree { degree: k, what: "rational section" });
        }
        let knots = self.section_knots(2 * k - 2, |m| k - 1 + m)?;
        let pieces: Vec<(f64, f64, Bezier<4>)> = self
            .pieces()
            .into_iter()
            .map(|(a, b, u)| {
                // U ∧ U' = (k / h) A ∧ B: the length of the span matters where spans join.
                let factor = k as f64 / (b - a);
                let c = u.control();
                let (ua, ub) = (Bezier::new(c[..k].to_vec()), Bezier::new(c[1..].to_vec()));
                let point = point_of_line_and_plane(&line_of_planes(&ua, &ub), &Bezier::constant(*plane));
                (a, b, Bezier::new(point.control().iter().map(|p| p.map(|x| factor * x)).collect()))
            })
            .collect();
        Ok(from_pieces(knots, &pieces)?)
    }

    /// The surface between two planes as a rational tensor-product surface of degree (2k−2, 1): u selects the ruling,
    /// v runs from the first plane to the second. Control weights are made positive by inserting knots.
    ///
    /// # Errors
    /// As [`DualCurve::rational_section`]; a ruling parallel to one of the planes.
    pub fn rational_tensor_product(&self, from: &Plane, to: &Plane) -> Result<Surface, DualError> {
        let (mut p, mut q) = (self.rational_section(from)?, self.rational_section(to)?);
        for _ in 0..REFINEMENTS {
            if same_sign(&p).is_some() && same_sign(&q).is_some() {
                break;
            }
            let middles: Vec<f64> = p.knots.breaks().windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
            (p, q) = (p.with_knots(&middles)?, q.with_knots(&middles)?);
        }
        let sign = |c: &Curve<4>| same_sign(c).ok_or_else(|| DualError::RulingParallel { t: smallest_weight(c) });
        let (sp, sq) = (sign(&p)?, sign(&q)?);
        if sp != sq {
            // The boundary planes would have to be crossed through infinity: one of them has the other orientation.
            q.control.iter_mut().for_each(|c| *c = c.map(|x| -x));
        }
        let control =
            p.control.iter().zip(&q.control).flat_map(|(a, b)| [a.map(|x| sp * x), b.map(|x| sp * x)]).collect();
        Ok(Surface { knots_u: p.knots, knots_v: Knots::uniform(1, 1, 0.0, 1.0)?, control, rational: true })
    }

    /// Knots of the given degree with interior multiplicities changed and clamped ends.
    fn section_knots(&self, degree: usize, multiplicity: impl Fn(usize) -> usize) -> Result<Knots, DualError> {
        let (a, b) = self.domain();
        let mut values = vec![a; degree + 1];
        for (value, m) in self.knots().distinct() {
            if value <= a || value >= b {
                continue;
            }
            if m >= self.knots().degree() {
                return Err(DualError::Facet { value, multiplicity: m });
            }
            values.extend(std::iter::repeat_n(value, multiplicity(m)));
        }
        values.extend(vec![b; degree + 1]);
        let control = values.len() - degree - 1;
        Ok(Knots::new(degree, values, control)?)
    }
}

/// Sign of all weights; `None` if they differ or vanish.
fn same_sign(c: &Curve<4>) -> Option<f64> {
    let first = if c.control[0][3] < 0.0 { -1.0 } else { 1.0 };
    c.control.iter().all(|p| first * p[3] > 0.0).then_some(first)
}

/// Where the weight is smallest in size among the Greville abscissae.
fn smallest_weight(c: &Curve<4>) -> f64 {
    let (p, v) = (c.knots.degree(), c.knots.values());
    let at = |i: usize| v[i + 1..=i + p].iter().sum::<f64>() / p as f64;
    (0..c.control.len()).map(at).min_by(|x, y| c.point(*x)[3].abs().total_cmp(&c.point(*y)[3].abs())).unwrap_or(v[0])
}
