//! Inflection rulings: where the curve of planes stands still in projective space \[PW99, Lemma 1\].
//!
//! *Method.* With `U = (1−s) A + s B`, `U ∧ U'` is a constant times `A ∧ B` of degree 2k−2; all six of its components
//! vanish at an inflection. Spans are halved while no component is clear of zero by its Bernstein coefficients.

use super::wedge::line_of_planes;
use super::DualCurve;
use crate::spline::bezier::Bezier;

/// Halvings of a span, unless the cells become a crowd first: parameters are found to 2⁻⁴⁰ of it at best.
const HALVINGS: usize = 40;
/// Share of the largest coefficient that counts as zero: rounding of the products.
const ROUNDING: f64 = 1e-13;
/// Cells followed at once.
const CROWD: usize = 64;
/// Share of a span beyond which a cluster of cells is a stretch of still planes and not one ruling.
const STRETCH: f64 = 1e-2;
/// Share of the domain within which parameters found on both sides of a knot are one inflection ruling: roots near a
/// double one are known to the square root of the rounding only.
const ONE_RULING: f64 = 1e-5;

/// Where planes stand still.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Inflections {
    /// Parameters of inflection rulings, increasing.
    pub at: Vec<f64>,
    /// Spans on a part of which the planes do not move at all: planar pieces.
    pub still: Vec<(f64, f64)>,
}

impl DualCurve {
    /// Inflection rulings. Curves of type (3) have none \[PW99, Lemma 1\].
    ///
    /// *Not guaranteed*: an approach to an inflection closer than rounding counts as one.
    pub fn inflection_rulings(&self) -> Inflections {
        let mut out = Inflections::default();
        let (start, end) = self.domain();
        let merge = ONE_RULING * (end - start);
        for (a, b, u) in self.pieces() {
            let c = u.control();
            let k = c.len() - 1;
            let line = line_of_planes(&Bezier::new(c[..k].to_vec()), &Bezier::new(c[1..].to_vec()));
            let size = line.iter().flat_map(|l| l.control()).fold(0.0f64, |m, x| m.max(x[0].abs()));
            // Scale of the planes themselves, for pieces that stand still altogether.
            let planes = c.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
            if size <= ROUNDING * planes * planes {
                out.still.push((a, b));
                continue;
            }
            let mut cells = vec![(0.0, 1.0, line)];
            for _ in 0..HALVINGS {
                cells = cells
                    .into_iter()
                    .flat_map(|(x, y, l)| {
                        let (mut left, mut right) = (l.clone(), l.clone());
                        for (i, c) in l.iter().enumerate() {
                            (left[i], right[i]) = c.split(0.5);
                        }
                        [(x, 0.5 * (x + y), left), (0.5 * (x + y), y, right)]
                    })
                    .filter(|(_, _, l)| {
                        l.iter().all(|c| {
                            let [(lo, hi)] = c.hull();
                            lo <= ROUNDING * size && hi >= -ROUNDING * size
                        })
                    })
                    .collect();
                if cells.len() > CROWD {
                    break;
                }
            }
            // Neighbouring cells belong together: where planes slow down to higher order, rounding hides the middle.
            let mut clusters: Vec<(f64, f64)> = Vec::new();
            for (x, y, _) in cells {
                match clusters.last_mut() {
                    Some(last) if x <= last.1 => last.1 = y,
                    _ => clusters.push((x, y)),
                }
            }
            for (x, y) in clusters {
                let t = a + (b - a) * 0.5 * (x + y);
                if y - x > STRETCH {
                    out.still.push((a + (b - a) * x, a + (b - a) * y));
                } else if out.at.last().is_none_or(|&last| t - last > merge) {
                    out.at.push(t);
                }
            }
        }
        out
    }
}
