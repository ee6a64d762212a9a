//! What the forms of strips have in common: feet, places on rulings, rows.

use crate::geom::Vec3;
use crate::num::runs::Runs;
use crate::torse::form::Torse;

/// Foot of a point on a strip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub t: f64,
    /// Signed distance, mm, positive on the side of `normal`.
    pub distance: f64,
    /// Unit normal of the strip, on the side of the face's normal.
    pub normal: Vec3,
    /// What must keep its sign: `n''·X − h''` of planes, `1 + y a'` of profiles, at the foot or at the point, where feet fold;
    /// whichever is nearer to losing it.
    pub regular: f64,
    /// Whether that is the point.
    pub above: bool,
}

impl Foot {
    /// Where it is least regular, for a point.
    pub fn least_regular(&self, x: &Vec3) -> Vec3 {
        if self.above {
            *x
        } else {
            x - self.normal * self.distance
        }
    }
}

/// What a form of strips offers.
pub(super) trait Form {
    fn torse(&self) -> &Torse;
    fn unknowns(&self) -> usize;
    /// Change of the distance of a point with each unknown (mm per mm), for its foot.
    fn row(&self, column: usize, x: &Vec3, foot: &Foot, scale: f64, out: &mut Runs);
    /// Rows whose squares are what the linear change leaves out, in units of the tolerance: `(rows, weight)`.
    fn damping(&self, column: usize, tolerance: f64, tie: &mut Tie);
    /// Runs of unknowns that should change evenly.
    fn sequences(&self) -> Vec<Vec<usize>>;
    /// What must keep its sign, see [`Foot::regular`], at a point of the strip.
    fn regular(&self, x: &Vec3, t: f64) -> f64;
    /// Its change with each unknown (per mm) at a foot; the result: with the way of the point.
    fn regular_row(&self, column: usize, foot: &Vec3, t: f64, scale: f64, out: &mut Runs) -> Vec3;
}

/// Where a strip lies on its rulings: for Greville parameters its middle and, for all, its half width, mm.
#[derive(Clone, Debug)]
pub(super) struct Band {
    /// Parameter, point, distance along the ruling's direction to both borders.
    pub rulings: Vec<(f64, [Vec3; 3])>,
    pub half_width: f64,
}

/// Soft rows under way.
pub(super) struct Tie {
    pub rows: Runs,
    pub price: Vec<(f64, f64)>,
    /// Factor on what damps strips.
    pub damping: f64,
}

impl Tie {
    /// Ends a row with its weight and residual.
    pub fn end(&mut self, weight: f64, residual: f64) {
        self.rows.end();
        self.price.push((weight, residual));
    }

    /// No rows.
    pub fn none() -> Self {
        Self { rows: Runs::default(), price: Vec::new(), damping: 0.0 }
    }

    /// Appends the rows of others.
    pub fn append(&mut self, others: &Self) {
        self.rows.append(&others.rows);
        self.price.extend_from_slice(&others.price);
    }

    /// Second differences of unknowns.
    pub fn uneven(&mut self, column: usize, sequence: &[usize], weight: f64) {
        for w in sequence.windows(3) {
            if w[2] == w[0] + 2 {
                self.rows.run(column + w[0], [1.0, -2.0, 1.0]);
            } else {
                w.iter().zip([1.0, -2.0, 1.0]).for_each(|(&j, v)| self.rows.run(column + j, [v]));
            }
            self.end(weight, 0.0);
        }
    }
}
