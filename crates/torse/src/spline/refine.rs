//! The same curve or surface with other knots, degree, direction or domain.
//!
//! *Method.* A control point of a spline is the blossom of any of its pieces at consecutive knots \[R89\]. So knot
//! insertion, restriction and clamping are one operation: write down the new knots, and take blossoms of the old
//! pieces at them. Degree elevation is the mean of blossoms with one argument left out. All of these are exact up to
//! rounding.

use super::blossom::of_piece;
use super::curve::Curve;
use super::knots::Knots;
use super::surface::Surface;
use super::{SplineError, MAX_DEGREE};

/// Control points over `new` of the spline with control points `control` over `old`. The pieces of `new` must lie
/// inside pieces of `old`, and have at least their continuity freedom; the degree of `new` is that of `old` or one more.
fn over<const D: usize>(old: &Knots, control: &[[f64; D]], new: &Knots) -> Vec<[f64; D]> {
    let (p, q, v) = (old.degree(), new.degree(), new.values());
    let mut net = vec![[0.0; D]; p + 1];
    let mut args = vec![0.0; p];
    (0..new.control_count())
        .map(|i| {
            let span = old.span(middle_of_support(new, i));
            let wanted = &v[i + 1..=i + q];
            if p == q {
                net.copy_from_slice(&control[span - p..=span]);
                return of_piece(old, span, &mut net, wanted);
            }
            let mut sum = [0.0; D];
            for left_out in 0..q {
                for (slot, &x) in
                    args.iter_mut().zip(wanted.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, x)| x))
                {
                    *slot = x;
                }
                net.copy_from_slice(&control[span - p..=span]);
                let b = of_piece(old, span, &mut net, &args);
                for d in 0..D {
                    sum[d] += b[d] / q as f64;
                }
            }
            sum
        })
        .collect()
}

/// A parameter inside the piece on which the blossom for control point `i` is taken: of the pieces that the control
/// point acts on, the one nearest to the mean of its knots, so that little is extrapolated.
fn middle_of_support(knots: &Knots, i: usize) -> f64 {
    let (p, v) = (knots.degree(), knots.values());
    let (a, b) = knots.domain();
    let mean = v[i + 1..=i + p].iter().sum::<f64>() / p as f64;
    let mut best = (f64::INFINITY, mean);
    for k in i..=i + p {
        let (x, y) = (v[k], v[k + 1]);
        if x >= y || x < a || y > b {
            continue;
        }
        let distance = (x - mean).max(mean - y).max(0.0);
        if distance < best.0 {
            best = (distance, 0.5 * (x + y));
        }
    }
    best.1
}

impl Knots {
    /// These knots with `more` inserted, in any order.
    ///
    /// # Errors
    /// A value that is not strictly inside the domain, or would occur more often than the degree.
    pub fn with(&self, more: &[f64]) -> Result<Self, SplineError> {
        let (a, b) = self.domain();
        for (index, &value) in more.iter().enumerate() {
            if !(value > a && value < b) {
                return Err(SplineError::KnotOrder { index, value });
            }
        }
        let mut values = self.values().to_vec();
        values.extend_from_slice(more);
        values.sort_by(f64::total_cmp);
        let control = values.len() - self.degree() - 1;
        Self::new(self.degree(), values, control)
    }

    /// Knots of the same splines seen as splines of one degree more: every value once more.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn elevated(&self) -> Result<Self, SplineError> {
        let q = self.degree() + 1;
        if q > MAX_DEGREE {
            return Err(SplineError::Degree(q));
        }
        let (a, b) = self.domain();
        let raised: Vec<f64> =
            self.distinct().into_iter().flat_map(|(value, m)| std::iter::repeat_n(value, m + 1)).collect();
        // Knots beyond the ends: as many as the new degree needs.
        let start = raised.iter().filter(|&&x| x <= a).count().saturating_sub(q + 1);
        let end = raised.len() - raised.iter().filter(|&&x| x >= b).count().saturating_sub(q + 1);
        let values = raised[start..end].to_vec();
        let control = values.len() - q - 1;
        Self::new(q, values, control)
    }

    /// Clamped knots on `[a, b]`, inside the domain, with the knots between.
    ///
    /// # Errors
    /// `a < b` inside the domain is needed.
    pub fn restricted(&self, a: f64, b: f64) -> Result<Self, SplineError> {
        let (start, end) = self.domain();
        if !(a >= start && a < b && b <= end) {
            return Err(SplineError::KnotOrder { index: 0, value: if a >= start { b } else { a } });
        }
        let p = self.degree();
        let mut values = vec![a; p + 1];
        values.extend(self.values().iter().copied().filter(|&x| x > a && x < b));
        values.extend(std::iter::repeat_n(b, p + 1));
        let control = values.len() - p - 1;
        Self::new(p, values, control)
    }

    /// Clamped knots on `[a, b]`, which may reach beyond the domain, with the interior knots that lie between.
    ///
    /// # Errors
    /// `a < b`, both finite, and a part of the domain between them are needed.
    pub fn extended(&self, a: f64, b: f64) -> Result<Self, SplineError> {
        let (start, end) = self.domain();
        if !(a < b && a < end && b > start && a.is_finite() && b.is_finite()) {
            return Err(SplineError::KnotOrder { index: 0, value: if a < end { b } else { a } });
        }
        let p = self.degree();
        let mut values = vec![a; p + 1];
        values.extend(self.values().iter().copied().filter(|&x| x > a.max(start) && x < b.min(end)));
        values.extend(std::iter::repeat_n(b, p + 1));
        let control = values.len() - p - 1;
        Self::new(p, values, control)
    }
}

impl<const D: usize> Curve<D> {
    /// The same curve with more knots.
    ///
    /// # Errors
    /// See [`Knots::with`].
    pub fn with_knots(&self, more: &[f64]) -> Result<Self, SplineError> {
        let knots = self.knots.with(more)?;
        let control = over(&self.knots, &self.control, &knots);
        Ok(Self { knots, control })
    }

    /// The same curve as one of a degree more.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn elevated(&self) -> Result<Self, SplineError> {
        let knots = self.knots.elevated()?;
        let control = over(&self.knots, &self.control, &knots);
        Ok(Self { knots, control })
    }

    /// The same curve as one of this degree, if its own is lower.
    ///
    /// # Errors
    /// The degree is higher than the largest supported one.
    pub fn elevated_to(mut self, degree: usize) -> Result<Self, SplineError> {
        while self.knots.degree() < degree {
            self = self.elevated()?;
        }
        Ok(self)
    }

    /// The part over `[a, b]`, clamped.
    ///
    /// # Errors
    /// `a < b` inside the domain is needed.
    pub fn restricted(&self, a: f64, b: f64) -> Result<Self, SplineError> {
        let knots = self.knots.restricted(a, b)?;
        let control = over(&self.knots, &self.control, &knots);
        Ok(Self { knots, control })
    }

    /// The curve over `[a, b]`, clamped; beyond the domain the first and last pieces are continued.
    ///
    /// # Errors
    /// See [`Knots::extended`].
    pub fn extended(&self, a: f64, b: f64) -> Result<Self, SplineError> {
        let knots = self.knots.extended(a, b)?;
        let control = over(&self.knots, &self.control, &knots);
        Ok(Self { knots, control })
    }

    /// The parts before and after `t`, clamped; their common end is the same point bit for bit.
    ///
    /// # Errors
    /// `t` must lie strictly inside the domain.
    pub fn split(&self, t: f64) -> Result<(Self, Self), SplineError> {
        let (a, b) = self.domain();
        let (left, mut right) = (self.restricted(a, t)?, self.restricted(t, b)?);
        right.control[0] = left.control[left.control.len() - 1];
        Ok((left, right))
    }

    /// The curve run through backwards, on the same domain.
    pub fn reversed(&self) -> Self {
        Self { knots: self.knots.reversed(), control: self.control.iter().rev().copied().collect() }
    }
}

impl Surface {
    /// Replaces the knots in u, column by column.
    fn over_u(&self, knots: Knots) -> Self {
        let (row, count) = (self.row(), knots.control_count());
        let mut control = vec![[0.0; 4]; count * row];
        let mut column = Vec::with_capacity(self.knots_u.control_count());
        for j in 0..row {
            column.clear();
            column.extend(self.control.iter().skip(j).step_by(row).copied());
            for (i, c) in over(&self.knots_u, &column, &knots).into_iter().enumerate() {
                control[i * row + j] = c;
            }
        }
        Self { knots_u: knots, knots_v: self.knots_v.clone(), control, rational: self.rational }
    }

    /// Replaces the knots in v, row by row.
    fn over_v(&self, knots: Knots) -> Self {
        let control = self.control.chunks(self.row()).flat_map(|line| over(&self.knots_v, line, &knots)).collect();
        Self { knots_u: self.knots_u.clone(), knots_v: knots, control, rational: self.rational }
    }

    /// The same surface with more knots.
    ///
    /// # Errors
    /// See [`Knots::with`].
    pub fn with_knots(&self, more_u: &[f64], more_v: &[f64]) -> Result<Self, SplineError> {
        Ok(self.over_u(self.knots_u.with(more_u)?).over_v(self.knots_v.with(more_v)?))
    }

    /// The same surface of one degree more in u.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn elevated_u(&self) -> Result<Self, SplineError> {
        Ok(self.over_u(self.knots_u.elevated()?))
    }

    /// The same surface of one degree more in v.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn elevated_v(&self) -> Result<Self, SplineError> {
        Ok(self.over_v(self.knots_v.elevated()?))
    }

    /// The same surface of these degrees in u and v, where its own are lower.
    ///
    /// # Errors
    /// A degree is higher than the largest supported one.
    pub fn elevated_to(mut self, [degree_u, degree_v]: [usize; 2]) -> Result<Self, SplineError> {
        while self.knots_u.degree() < degree_u {
            self = self.elevated_u()?;
        }
        while self.knots_v.degree() < degree_v {
            self = self.elevated_v()?;
        }
        Ok(self)
    }

    /// The part over `[u0, u1] × [v0, v1]`, clamped.
    ///
    /// # Errors
    /// Both intervals must lie inside the domain and have positive length.
    pub fn restricted(&self, u: (f64, f64), v: (f64, f64)) -> Result<Self, SplineError> {
        Ok(self.over_u(self.knots_u.restricted(u.0, u.1)?).over_v(self.knots_v.restricted(v.0, v.1)?))
    }

    /// The surface run through backwards in u; the normal turns round.
    pub fn reversed_u(&self) -> Self {
        let control = self.control.chunks(self.row()).rev().flatten().copied().collect();
        Self { knots_u: self.knots_u.reversed(), knots_v: self.knots_v.clone(), control, rational: self.rational }
    }

    /// The surface with u and v exchanged; the normal turns round.
    pub fn transposed(&self) -> Self {
        let row = self.row();
        let control = (0..row).flat_map(|j| self.control.iter().skip(j).step_by(row).copied()).collect();
        Self { knots_u: self.knots_v.clone(), knots_v: self.knots_u.clone(), control, rational: self.rational }
    }

    /// The curve of constant `u` in homogeneous coordinates, with parameter v.
    pub fn curve_at_u(&self, u: f64) -> Curve<4> {
        let (row, p) = (self.row(), self.knots_u.degree());
        let basis = self.knots_u.basis(u, 0);
        let mut control = vec![[0.0; 4]; row];
        for i in 0..=p {
            let line = &self.control[(basis.first + i) * row..];
            for (c, l) in control.iter_mut().zip(line) {
                for d in 0..4 {
                    c[d] += basis.rows[0][i] * l[d];
                }
            }
        }
        Curve { knots: self.knots_v.clone(), control }
    }

    /// The curve of constant `v` in homogeneous coordinates, with parameter u.
    pub fn curve_at_v(&self, v: f64) -> Curve<4> {
        let q = self.knots_v.degree();
        let basis = self.knots_v.basis(v, 0);
        let control = self
            .control
            .chunks(self.row())
            .map(|line| {
                let mut c = [0.0; 4];
                for j in 0..=q {
                    for d in 0..4 {
                        c[d] += basis.rows[0][j] * line[basis.first + j][d];
                    }
                }
                c
            })
            .collect();
        Curve { knots: self.knots_u.clone(), control }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::sample::{any_curve, any_surface};
    use proptest::prelude::*;

    /// Largest difference at a grid of parameters of `b`'s domain.
    fn apart(a: &Curve<3>, b: &Curve<3>, map: impl Fn(f64) -> f64) -> f64 {
        let (t0, t1) = b.domain();
        let mut worst: f64 = 0.0;
        for i in 0..=40 {
            let t = t0 + (t1 - t0) * i as f64 / 40.0;
            let (x, y) = (a.point(map(t)), b.point(t));
            for d in 0..3 {
                worst = worst.max((x[d] - y[d]).abs());
            }
        }
        worst
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn insertion_leaves_the_curve_unchanged(curve in any_curve(), more in prop::collection::vec(0.03..0.97f64, 1..5)) {
            let finer = curve.with_knots(&more).expect("inside the domain");
            prop_assert_eq!(finer.control.len(), curve.control.len() + more.len());
            prop_assert!(apart(&curve, &finer, |t| t) < 1e-10);
        }

        #[test]
        fn elevation_leaves_the_curve_unchanged(curve in any_curve()) {
            let higher = curve.elevated().expect("degree allowed");
            prop_assert_eq!(higher.knots.degree(), curve.knots.degree() + 1);
            prop_assert!(apart(&curve, &higher, |t| t) < 1e-9);
            let degree = curve.knots.degree();
            prop_assert_eq!(&curve.clone().elevated_to(degree).expect("as it is"), &curve);
            prop_assert_eq!(curve.elevated_to(degree + 2).expect("degree"), higher.elevated().expect("degree"));
        }

        #[test]
        fn parts_and_reversal_follow_the_curve(curve in any_curve(), x in 0.05..0.95f64, y in 0.05..0.95f64) {
            let (a, b) = (x.min(y), x.max(y));
            prop_assume!(b - a > 1e-3);
            let part = curve.restricted(a, b).expect("inside");
            prop_assert!(apart(&curve, &part, |t| t) < 1e-8);
            let (left, right) = curve.split(x).expect("inside");
            prop_assert!(apart(&curve, &left, |t| t) < 1e-8 && apart(&curve, &right, |t| t) < 1e-8);
            prop_assert_eq!(left.control.last(), right.control.first());
            prop_assert!(apart(&curve, &curve.reversed(), |t| 1.0 - t) < 1e-9);
        }

        #[test]
        fn surfaces_are_unchanged(s in any_surface(), x in 0.1..0.9f64, y in 0.1..0.9f64) {
            let finer = s.with_knots(&[x], &[y]).expect("inside");
            let higher = s.elevated_u().expect("degree").elevated_v().expect("degree");
            let degrees = [higher.knots_u.degree(), higher.knots_v.degree()];
            prop_assert_eq!(&s.clone().elevated_to(degrees).expect("degree"), &higher);
            let turned = s.transposed();
            let part = s.restricted((0.0, x), (y, 1.0)).expect("inside");
            let back = s.reversed_u();
            for (u, v) in [(0.03, 0.98), (0.5, 0.31), (0.77, 0.6), (1.0, 0.0)] {
                let p = s.point(u, v);
                prop_assert!((finer.point(u, v) - p).norm() < 1e-8);
                prop_assert!((higher.point(u, v) - p).norm() < 1e-8);
                prop_assert!((turned.point(v, u) - p).norm() < 1e-9);
                prop_assert!((back.point(1.0 - u, v) - p).norm() < 1e-8);
                let c = s.curve_at_u(u).point(v);
                prop_assert!((crate::geom::Vec3::new(c[0], c[1], c[2]) / c[3] - p).norm() < 1e-9);
                let c = s.curve_at_v(v).point(u);
                prop_assert!((crate::geom::Vec3::new(c[0], c[1], c[2]) / c[3] - p).norm() < 1e-9);
                let (pu, pv) = (x * u, y + (1.0 - y) * v);
                prop_assert!((part.point(pu, pv) - s.point(pu, pv)).norm() < 1e-7);
            }
        }
    }

    #[test]
    fn clamping_keeps_an_unclamped_curve() {
        let values: Vec<f64> = (0..9).map(f64::from).collect();
        let control = vec![[0., 0., 1.], [1., 2., 0.], [3., 1., 1.], [4., 4., 0.], [5., 0., 2.]];
        let c = Curve::<3>::new(3, values, control).expect("curve");
        let (a, b) = c.domain();
        let clamped = c.restricted(a, b).expect("whole domain");
        assert!(apart(&c, &clamped, |t| t) < 1e-13);
        assert!((c.point(a)[0] - clamped.control[0][0]).abs() < 1e-14);
        assert!(apart(&c, &c.elevated().expect("degree"), |t| t) < 1e-12);
        assert!(apart(&c, &c.reversed(), |t| a + b - t) < 1e-12);
    }

    #[test]
    fn knots_outside_or_too_often_are_refused() {
        let c = Curve::<1>::new(2, vec![0., 0., 0., 0.5, 1., 1., 1.], vec![[0.], [1.], [0.], [2.]]).expect("curve");
        assert!(c.with_knots(&[1.5]).is_err() && c.with_knots(&[f64::NAN]).is_err());
        assert!(c.with_knots(&[0.5]).is_ok() && c.with_knots(&[0.5, 0.5]).is_err());
        assert!(c.restricted(0.5, 0.5).is_err() && c.restricted(-1.0, 0.5).is_err() && c.split(0.0).is_err());
    }
}
