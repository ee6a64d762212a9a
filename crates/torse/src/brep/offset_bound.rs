//! How far a spline is from the offset that it stands for, proven (docs/algorithms/reading.md).
//!
//! With `G = F − S`, the spline F less the surface S of the file, the offset at the distance d is met where G is as long as d
//! and stands square on the surface: `G·S_u`, `G·S_v` and `G·G − d²` are polynomials (over powers of the weight, where S
//! has some), which their Bernstein coefficients enclose over every cell. The part of G along the surface is
//! `g² = aᵀ M⁻¹ a` with `a = (G·S_u, G·S_v)` and the metric M; across it is `n² = G·G − g²`, so that F is within
//! `√(g² + (n − d)²)`, `n − d = (n² − d²)/(n + d)`, of the point at the distance d, on the side of S on which one place of the cell lies.

use crate::num::bernstein::{derivative, difference, halves, hull, product, SplinePiece};
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// Halvings of a cell at most, in each direction.
const DEPTH: u32 = 5;
/// Cells are halved until what is proven exceeds what was seen by less than this factor.
const LOOSE: f64 = 2.0;
/// Distances below this share of the offset, or of the coordinates, are not told apart.
const ROUNDED: f64 = 1e-12;

/// Bound of the distance between `spline` and the offset of `base` by `distance` at equal parameters, in the unit of the
/// surfaces; infinite if none is shown. `seen` is what was found at samples, and says only how fine is fine enough. The spline is
/// polynomial, over the same parameters, and its knots hold those of the base.
pub(super) fn distance_from_offset(spline: &Surface, base: &Surface, distance: f64, seen: f64) -> f64 {
    let (us, vs) = (spline.knots_u.breaks(), spline.knots_v.breaks());
    let size = base.control.iter().flatten().fold(distance.abs(), |m: f64, x| m.max(x.abs()));
    let enough = LOOSE * seen + ROUNDED * size;
    let cells: Vec<[[f64; 2]; 2]> =
        us.windows(2).flat_map(|u| vs.windows(2).map(move |v| [[u[0], u[1]], [v[0], v[1]]])).collect();
    // Over a cell the spline is on one side of the surface, as it never meets it there: that of one place.
    let on_that_side = |[u, v]: &[[f64; 2]; 2]| {
        let (u, v) = (0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
        let j = base.jet(u, v);
        (spline.point(u, v) - j.p).dot(&j.normal()) * distance > 0.0
    };
    let bound = |cell: &[[f64; 2]; 2]| match on_that_side(cell) {
        true => Cell::of(spline, base, cell).bound(distance, enough, DEPTH),
        false => f64::INFINITY,
    };
    parallel::map(cells.iter(), bound).into_iter().fold(0.0, f64::max)
}

/// A polynomial in two variables over a cell, by Bernstein coefficients: rows for the first variable.
#[derive(Clone)]
struct Tensor(Vec<Vec<Interval>>);

impl Tensor {
    /// A component of a spline over a cell inside one of its pieces.
    fn of(knots: [&Knots; 2], net: &dyn Fn(usize, usize) -> f64, cell: &[[f64; 2]; 2]) -> Self {
        let span = |d: usize| knots[d].span(0.5 * (cell[d][0] + cell[d][1]));
        let piece = |d: usize| {
            let (p, k) = (knots[d].degree(), span(d));
            SplinePiece::<Interval>::new(p, &knots[d].values()[k + 1 - p..=k + p], cell[d][0], cell[d][1])
        };
        let (pu, pv) = (knots[0].degree(), knots[1].degree());
        let (along_v, along_u) = (piece(1), piece(0));
        let first = [span(0) - pu, span(1) - pv];
        let rows: Vec<Vec<Interval>> = (0..=pu)
            .map(|i| {
                let row: Vec<Interval> = (0..=pv).map(|j| Interval::point(net(first[0] + i, first[1] + j))).collect();
                along_v.coefficients(&row)
            })
            .collect();
        Self(rows).turned().each(|row| along_u.coefficients(row)).turned()
    }

    /// With both variables exchanged.
    fn turned(&self) -> Self {
        Self((0..self.0[0].len()).map(|j| self.0.iter().map(|row| row[j]).collect()).collect())
    }

    fn each(&self, f: impl Fn(&[Interval]) -> Vec<Interval>) -> Self {
        Self(self.0.iter().map(|row| f(row)).collect())
    }

    /// Derivatives with respect to both variables of the cell, each from 0 to 1.
    fn derivatives(&self) -> [Self; 2] {
        [self.turned().each(derivative).turned(), self.each(derivative)]
    }

    fn times(&self, o: &Self) -> Self {
        // Products along the second variable, added up along the first as the product there is.
        let (p, q) = (self.0.len() - 1, o.0.len() - 1);
        let degree = self.0[0].len() + o.0[0].len() - 1;
        let mut out = vec![vec![Interval::ZERO; degree]; p + q + 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in o.0.iter().enumerate() {
                let share = Interval::point(binomial(p, i) * binomial(q, j)) / Interval::point(binomial(p + q, i + j));
                for (sum, x) in out[i + j].iter_mut().zip(product(a, b)) {
                    *sum += share * x;
                }
            }
        }
        Self(out)
    }

    /// The difference, of the higher degrees of both.
    fn less(&self, o: &Self) -> Self {
        let raised = |t: &Self, like: &Self| {
            let more = |a: usize, b: usize| b.saturating_sub(a) + 1;
            let one = vec![vec![Interval::ONE; more(t.0[0].len(), like.0[0].len())]; more(t.0.len(), like.0.len())];
            t.times(&Self(one))
        };
        let (a, b) = (raised(self, o), raised(o, self));
        Self(a.0.iter().zip(&b.0).map(|(a, b)| difference(a, b)).collect())
    }

    fn hull(&self) -> Interval {
        self.0.iter().map(|row| hull(row)).reduce(Interval::hull).unwrap_or(Interval::EVERYTHING)
    }

    /// Both halves of the cell along a variable.
    fn cut(&self, along: usize) -> [Self; 2] {
        let this = if along == 0 { self.turned() } else { self.clone() };
        let (left, right) = this.0.iter().map(|row| halves(row)).unzip();
        let back = |t: Vec<Vec<Interval>>| if along == 0 { Self(t).turned() } else { Self(t) };
        [back(left), back(right)]
    }
}

/// The scalar product of two vectors of polynomials.
fn dot(a: &[Tensor; 3], b: &[Tensor; 3]) -> Tensor {
    let mut out = a[0].times(&b[0]);
    for d in 1..3 {
        let more = a[d].times(&b[d]);
        out.0.iter_mut().flatten().zip(more.0.into_iter().flatten()).for_each(|(x, y)| *x += y);
    }
    out
}

/// What decides over a cell.
#[derive(Clone)]
struct Cell {
    /// `w G`, with the weight w of the surface, as long as it is.
    length_sq: Tensor,
    weight_sq: Tensor,
    /// `w³ G·S_u` and `w³ G·S_v`.
    along: [Tensor; 2],
    /// `w² S_u` and `w² S_v`.
    tangents: [[Tensor; 3]; 2],
}

impl Cell {
    fn of(spline: &Surface, base: &Surface, cell: &[[f64; 2]; 2]) -> Self {
        let component = |s: &Surface, d: usize| {
            let row = s.row();
            Tensor::of([&s.knots_u, &s.knots_v], &|i, j| s.control[i * row + j][d], cell)
        };
        let points = [0, 1, 2].map(|d| component(base, d));
        let there = [0, 1, 2].map(|d| component(spline, d));
        if !base.rational {
            let way = [0, 1, 2].map(|d: usize| there[d].less(&points[d]));
            let slopes = points.map(|p| p.derivatives());
            let tangents = [0, 1].map(|k: usize| [0, 1, 2].map(|d: usize| slopes[d][k].clone()));
            return Self::with(&way, Tensor(vec![vec![Interval::ONE]]), tangents);
        }
        let weight = component(base, 3);
        let way = [0, 1, 2].map(|d: usize| there[d].times(&weight).less(&points[d]));
        let slopes = weight.derivatives();
        let tangents = [0, 1].map(|k: usize| {
            [0, 1, 2].map(|d: usize| points[d].derivatives()[k].times(&weight).less(&points[d].times(&slopes[k])))
        });
        Self::with(&way, weight, tangents)
    }

    fn with(way: &[Tensor; 3], weight: Tensor, tangents: [[Tensor; 3]; 2]) -> Self {
        let along = [dot(way, &tangents[0]), dot(way, &tangents[1])];
        Self { length_sq: dot(way, way), weight_sq: weight.times(&weight), along, tangents }
    }

    /// Bound over the cell, which is halved up to `depth` times where it is above `enough`.
    fn bound(&self, distance: f64, enough: f64, depth: u32) -> f64 {
        let here = self.direct(distance);
        if here <= enough || depth == 0 {
            return here;
        }
        let mut worst = 0.0_f64;
        for half in self.halves(0) {
            for quarter in half.halves(1) {
                let bound = quarter.bound(distance, enough, depth - 1);
                worst = if worst >= bound { worst } else { bound };
            }
        }
        worst
    }

    fn halves(&self, along: usize) -> [Self; 2] {
        let [l, w] = [&self.length_sq, &self.weight_sq].map(|t| t.cut(along));
        let a = [0, 1].map(|k: usize| self.along[k].cut(along));
        let t = [0, 1].map(|k: usize| [0, 1, 2].map(|d: usize| self.tangents[k][d].cut(along)));
        [0, 1].map(|h: usize| Self {
            length_sq: l[h].clone(),
            weight_sq: w[h].clone(),
            along: [0, 1].map(|k: usize| a[k][h].clone()),
            tangents: [0, 1].map(|k: usize| [0, 1, 2].map(|d: usize| t[k][d][h].clone())),
        })
    }

    /// Bound over the cell as it is; infinite if none is shown.
    fn direct(&self, distance: f64) -> f64 {
        let weight_sq = self.weight_sq.hull();
        if weight_sq.sign() <= 0 {
            return f64::INFINITY;
        }
        let weight = weight_sq.sqrt();
        let d_sq = Interval::point(distance).sqr();
        // What G·G differs from d², as w² (G·G − d²) over w².
        let scaled = Tensor(self.weight_sq.0.iter().map(|r| r.iter().map(|x| *x * d_sq).collect()).collect());
        let longer = self.length_sq.less(&scaled).hull() / weight_sq;
        let cube = weight * weight_sq;
        let [a, b] = [0, 1].map(|k: usize| self.along[k].hull() / cube);
        let [tu, tv] = [0, 1].map(|k: usize| [0, 1, 2].map(|d: usize| self.tangents[k][d].hull() / weight_sq));
        let inner = |p: &[Interval; 3], q: &[Interval; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        let square = |p: &[Interval; 3]| p[0].sqr() + p[1].sqr() + p[2].sqr();
        let cross = [tu[1] * tv[2] - tu[2] * tv[1], tu[2] * tv[0] - tu[0] * tv[2], tu[0] * tv[1] - tu[1] * tv[0]];
        let area_sq = square(&cross);
        if area_sq.sign() <= 0 {
            return f64::INFINITY;
        }
        let two = Interval::point(2.0);
        let beside = square(&tv) * a.sqr() - two * inner(&tu, &tv) * a * b + square(&tu) * b.sqr();
        let beside_sq = Interval { lo: 0.0, hi: (beside / area_sq).hi.max(0.0) };
        let off = longer - beside_sq;
        let normal_sq = d_sq + off;
        if normal_sq.sign() <= 0 {
            return f64::INFINITY;
        }
        let across = off / (normal_sq.sqrt() + Interval::point(distance.abs()));
        let bound = (beside_sq + across.sqr()).sqrt().hi;
        if bound.is_nan() {
            f64::INFINITY
        } else {
            bound
        }
    }
}
