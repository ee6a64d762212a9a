//! A seam: a base line on the surface, lifted by a smooth offset along the normal.
//!
//! *Method.* The base line is a level line after \[SE06\]; `y(s) = x(s) + a(s) N(s)` with a quintic spline `a`. The
//! seam itself is the quintic C⁴ spline nearest to samples of that; it *is* the seam from then on, whatever its
//! distance from them.

use super::base_line::{BaseLine, BasePoint};
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;

/// Degree of seams and offsets: C⁴, so that the planes of the strips between them are smooth enough for splines to
/// follow them fast.
pub const DEGREE: usize = 5;
/// Spans of the offset over the whole line.
const OFFSET_SPANS: usize = 10;
/// Spans of the seam curve.
const CURVE_SPANS: usize = 44;
/// Weight of second differences of the offset's coefficients, against data of weight one.
const SMOOTH: f64 = 0.1;

/// A seam in the making.
#[derive(Clone, Debug)]
pub struct Seam {
    /// The line on the surface.
    pub base: BaseLine,
    /// Knots of the offset, over the whole line.
    pub knots: Knots,
    /// Coefficients of the offset, mm along the surface's normal.
    pub offset: Vec<f64>,
}

impl Seam {
    /// A seam with an offset near given ones (mm), one for each point of the line inside the region. `None` for a line
    /// without points there.
    pub fn new(base: BaseLine, wanted: impl Fn(&BasePoint) -> f64) -> Option<Self> {
        let (first, last) = (base.points.first()?.s, base.points.last()?.s);
        let knots = Knots::uniform(DEGREE, OFFSET_SPANS, first, last).ok()?;
        let n = knots.control_count();
        let mut rows = Rows::new(n, DEGREE + 1);
        let mut matrix = BandMatrix::zeros(n, DEGREE + 1);
        let mut right = vec![0.0; n];
        let mut count = 0;
        for p in base.inner() {
            let b = knots.basis(p.s, 0);
            rows.push(b.first).1.copy_from_slice(&b.rows[0][..=DEGREE]);
            matrix.add_row(&rows, rows.len() - 1, 1.0);
            rows.scatter(rows.len() - 1, wanted(p), &mut right);
            count += 1;
        }
        if count == 0 {
            return None;
        }
        let weight = SMOOTH * SMOOTH * f64::from(count) / n as f64;
        for i in 0..n - 2 {
            let first = i.min(n - DEGREE - 1);
            let row = rows.push(first).1;
            row[i - first] = 1.0;
            row[i - first + 1] = -2.0;
            row[i - first + 2] = 1.0;
            matrix.add_row(&rows, rows.len() - 1, weight);
        }
        if !matrix.factorise() {
            return None;
        }
        matrix.solve(&mut right);
        right.iter().all(|a| a.is_finite()).then_some(Self { base, knots, offset: right })
    }

    /// Offset at `s`, mm.
    pub fn offset_at(&self, s: f64) -> f64 {
        let b = self.knots.basis(s, 0);
        (0..=DEGREE).map(|j| b.rows[0][j] * self.offset[b.first + j]).sum()
    }

    /// The curve `y(s)` in space, mm, over the whole line.
    pub fn curve(&self) -> Option<Curve<3>> {
        let points: Vec<[f64; 3]> = self.base.points.iter().map(|p| (p.x + p.n * self.offset_at(p.s)).into()).collect();
        let parameters: Vec<f64> = self.base.points.iter().map(|p| p.s).collect();
        let (a, b) = self.knots.domain();
        let spans = CURVE_SPANS.min(points.len() / 4).max(1);
        let knots = Knots::uniform(DEGREE, spans, a, b).ok()?;
        lsq::fit(&points, &parameters, &knots).ok().map(|f| f.curve)
    }
}
