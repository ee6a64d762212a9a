//! Where the strips' normal curvature must be positive and where negative: labelling by minimum cut, and a smooth
//! cut between the two (mixed-curvature specification, C2).
//!
//! Hills force one sign, valleys the other, saddles may take either; all costs are lengths in the metric |II|, so
//! the labelling does not depend on the tolerance.

use super::covered_face::Cover;
use crate::num::hash::HashMap;
use crate::num::max_flow::LabelGraph;
use crate::patchwork::partition::edges;
use crate::spline::field::Field;
use nalgebra as na;

/// Weight of strips lost against strips cut (μ of C2).
const LOSS: f64 = 8.0;
/// Extra weight where both principal curvatures have one sign.
const FORCED: f64 = 4.0;
/// Length of a straight cut over the length of its staircase of edges, about.
const STAIRS: f64 = 0.8;
/// Spans per direction of the smooth function whose zero line becomes the cut.
const SPANS: usize = 7;
/// Weight of the second differences of that function, in samples per coefficient: they lead where samples are few.
const SMOOTHNESS: f64 = 1e-2;
/// A labelling with less than this share of the area on one side is no cut.
const LEAST_SHARE: f64 = 0.02;

impl Cover {
    /// Cuts a region between the parts that want different signs; labels of all parts, or `None` if one sign serves
    /// the whole region.
    pub(super) fn cut_by_sign(&mut self, label: u32) -> Option<Vec<u32>> {
        let region = self.region(label);
        let (tris, size) = (region.cells(), region.bbox().diagonal());
        let mut index: HashMap<(u32, u32), usize> = HashMap::default();
        let mut density = Vec::with_capacity(tris.len());
        let mut unary = Vec::with_capacity(tris.len());
        for &t in &tris {
            let area = self.triangle_area(t);
            let (mut x, mut k, mut elliptic, mut count) = (0.0, 0.0, false, 0.0);
            for v in self.partition.triangles[t] {
                let Some([k1, k2]) = self.curvatures(v) else { continue };
                let (a, b) = (k1.max(0.0), (-k2).max(0.0));
                if a + b > 0.0 {
                    x += b / (a + b);
                    k += k1.abs().max(k2.abs());
                    elliptic |= k1 * k2 > 0.0;
                    count += 1.0;
                }
            }
            if count > 0.0 {
                x /= count;
                k /= count;
            } else {
                x = 0.5;
            }
            let c = 2.0 * LOSS / size * area * k.sqrt() * if elliptic { FORCED } else { 1.0 };
            unary.push([c * (x - 0.5).max(0.0), c * (0.5 - x).max(0.0)]);
            density.push(k.sqrt());
        }
        let mut graph = LabelGraph::new(unary);
        for (i, &t) in tris.iter().enumerate() {
            for (a, b) in edges(self.partition.triangles[t]) {
                let key = (a.min(b), a.max(b));
                if let Some(j) = index.insert(key, i) {
                    let length = (self.point(a) - self.point(b)).norm();
                    graph.pair(i, j, STAIRS * 0.5 * (density[i] + density[j]) * length);
                }
            }
        }
        let labels = graph.labelling();
        let area = |want: bool| -> f64 {
            tris.iter().zip(&labels).filter(|(_, l)| **l == want).map(|(&t, _)| self.triangle_area(t)).sum()
        };
        let (zero, one) = (area(false), area(true));
        if zero.min(one) < LEAST_SHARE * (zero + one) {
            return None;
        }
        let places: Vec<([f64; 2], f64)> = tris
            .iter()
            .zip(&labels)
            .map(|(&t, &l)| {
                (crate::patchwork::partition::centroid(self.partition.corners(t)), if l { -1.0 } else { 1.0 })
            })
            .collect();
        let field = smooth(self.region(label).bounds(), &places)?;
        self.parted(label, |p| field.value(p))
    }
}

/// A bicubic field near the given values in the sense of least squares, with a little smoothing.
fn smooth(bounds: [f64; 4], values: &[([f64; 2], f64)]) -> Option<Field> {
    let mut field = Field::bicubic(bounds, SPANS).ok()?;
    let n = field.coefficients.len();
    let row = field.knots_v.control_count();
    let mut a = na::DMatrix::<f64>::zeros(n, n);
    let mut b = na::DVector::<f64>::zeros(n);
    for (p, value) in values {
        let basis = field.basis(p[0], p[1]);
        for &(i, x, _, _) in &basis {
            b[i] += x * value;
            for &(j, y, _, _) in &basis {
                a[(i, j)] += x * y;
            }
        }
    }
    // Second differences of neighbouring coefficients.
    let weight = SMOOTHNESS * values.len() as f64 / n as f64;
    for i in 0..n {
        for (step, inside) in [(1, i % row + 2 < row), (row, i + 2 * row < n)] {
            if inside {
                let d = [(i, 1.0), (i + step, -2.0), (i + 2 * step, 1.0)];
                for (p, x) in d {
                    for (q, y) in d {
                        a[(p, q)] += weight * x * y;
                    }
                }
            }
        }
    }
    let c = na::Cholesky::new(a)?.solve(&b);
    field.coefficients.copy_from_slice(c.as_slice());
    Some(field)
}
