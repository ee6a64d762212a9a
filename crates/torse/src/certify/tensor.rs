//! Tensor-product splines enclosed over boxes of their parameters, with derivatives up to the second.
//!
//! *Method*: blossoms in interval arithmetic give the Bernstein coefficients of every polynomial piece over its part of
//! the box; their hull encloses the piece, those of their differences its derivatives \[FR88, MKC09\]. The outermost
//! pieces go on beyond the domain.

use crate::num::bernstein::SplinePiece;
use crate::num::interval::Interval;
use crate::spline::knots::Knots;

/// Values and derivatives of N components: enclosures over a box, or at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet2<const N: usize> {
    pub p: [Interval; N],
    pub du: [Interval; N],
    pub dv: [Interval; N],
    pub duu: [Interval; N],
    pub duv: [Interval; N],
    pub dvv: [Interval; N],
}

impl<const N: usize> Jet2<N> {
    const ZERO: Self = Self {
        p: [Interval::ZERO; N],
        du: [Interval::ZERO; N],
        dv: [Interval::ZERO; N],
        duu: [Interval::ZERO; N],
        duv: [Interval::ZERO; N],
        dvv: [Interval::ZERO; N],
    };

    /// The six kinds in order.
    fn kinds(&self) -> [[Interval; N]; 6] {
        [self.p, self.du, self.dv, self.duu, self.duv, self.dvv]
    }

    fn of_kinds([p, du, dv, duu, duv, dvv]: [[Interval; N]; 6]) -> Self {
        Self { p, du, dv, duu, duv, dvv }
    }

    /// Component-wise hull.
    fn hull(&self, o: &Self) -> Self {
        let (a, b) = (self.kinds(), o.kinds());
        Self::of_kinds([0, 1, 2, 3, 4, 5].map(|k: usize| std::array::from_fn(|d| a[k][d].hull(b[k][d]))))
    }
}

impl Jet2<4> {
    /// Affine values and derivatives from homogeneous ones.
    pub fn affine(&self) -> Jet2<3> {
        let [h, hu, hv, huu, huv, hvv] = self.kinds();
        let r = Interval::ONE / h[3];
        let of = |f: &dyn Fn(usize) -> Interval| -> [Interval; 3] { [f(0), f(1), f(2)] };
        let two = |x: Interval| x.scale_exact(2.0);
        let p = of(&|d| h[d] * r);
        let du = of(&|d| (hu[d] - p[d] * hu[3]) * r);
        let dv = of(&|d| (hv[d] - p[d] * hv[3]) * r);
        let duu = of(&|d| (huu[d] - two(du[d] * hu[3]) - p[d] * huu[3]) * r);
        let duv = of(&|d| (huv[d] - du[d] * hv[3] - dv[d] * hu[3] - p[d] * huv[3]) * r);
        let dvv = of(&|d| (hvv[d] - two(dv[d] * hv[3]) - p[d] * hvv[3]) * r);
        Jet2 { p, du, dv, duu, duv, dvv }
    }
}

/// A tensor-product spline; control points row-major, index `i · n_v + j`.
pub(super) struct Tensor<'a, const N: usize> {
    u: Axis<'a>,
    v: Axis<'a>,
    control: Vec<[Interval; N]>,
}

impl Tensor<'_, 4> {
    /// Affine values and derivatives over a box: each piece for itself, as homogeneous derivatives jump at creases even where
    /// the surface goes on smoothly.
    pub fn affine_over(&self, [u, v]: [Interval; 2]) -> Jet2<3> {
        self.pieces([u, v], &|net, a, b| net.over([a, b]).affine())
    }

    /// The point alone at a place, known up to the rounding of a narrow box.
    pub fn point_at(&self, [u, v]: [Interval; 2]) -> [Interval; 3] {
        let point = |net: Net<4>, a: &Part, b: &Part| {
            let h = net.value([a.local(u), b.local(v)]);
            Jet2 { p: [0, 1, 2].map(|d: usize| h[d] / h[3]), ..Jet2::ZERO }
        };
        self.pieces([u, v], &point).p
    }
}

/// One direction of a spline.
struct Axis<'a> {
    knots: &'a Knots,
    breaks: Vec<f64>,
    /// First control point of every piece.
    first: Vec<usize>,
}

/// A piece of an axis and the part of it that is looked at: its ends, and its inverse width.
struct Part {
    first: usize,
    ends: [f64; 2],
    shares: SplinePiece<Interval>,
}

/// Least width of a part as a share of its piece: narrower ones are widened to it, so that derivatives stay sharp.
const NARROWEST: f64 = 1e-5;

impl<'a> Axis<'a> {
    fn new(knots: &'a Knots) -> Self {
        let breaks = knots.breaks();
        let first = breaks.windows(2).map(|w| knots.span(0.5 * (w[0] + w[1])) - knots.degree()).collect();
        Self { knots, breaks, first }
    }

    /// Pieces that meet an interval, first and last.
    fn pieces(&self, x: Interval) -> std::ops::RangeInclusive<usize> {
        let inner = &self.breaks[1..self.breaks.len() - 1];
        // A break at an end of the interval belongs to both of its pieces.
        inner.partition_point(|&b| b < x.lo)..=inner.partition_point(|&b| b <= x.hi)
    }

    fn part(&self, piece: usize, x: Interval) -> Part {
        let (a, b) = (self.breaks[piece], self.breaks[piece + 1]);
        let lo = if piece == 0 { x.lo } else { x.lo.max(a) };
        let hi = if piece + 2 == self.breaks.len() { x.hi } else { x.hi.min(b) };
        let pad = (NARROWEST * (b - a) - (hi - lo)).max(0.0);
        let ends = [lo - pad, hi.max(lo) + pad];
        let (p, first) = (self.knots.degree(), self.first[piece]);
        let local = &self.knots.values()[first + 1..first + 1 + 2 * p];
        Part { first, ends, shares: SplinePiece::new(p, local, ends[0], ends[1]) }
    }

    /// Whether a line of less smoothness than C¹ lies strictly inside an interval.
    fn creased(&self, x: Interval) -> bool {
        let p = self.knots.degree();
        self.knots.distinct().iter().any(|&(t, m)| m >= p && t > x.lo && t < x.hi && self.is_inner(t))
    }

    fn is_inner(&self, t: f64) -> bool {
        t > self.breaks[0] && t < self.breaks[self.breaks.len() - 1]
    }
}

impl Part {
    /// `1 / width`.
    fn inverse(&self) -> Interval {
        Interval::ONE / (Interval::point(self.ends[1]) - Interval::point(self.ends[0]))
    }

    /// Coordinate of a place in the part, 0 to 1.
    fn local(&self, x: Interval) -> Interval {
        (x - Interval::point(self.ends[0])) * self.inverse()
    }
}

impl<'a, const N: usize> Tensor<'a, N> {
    /// A spline with given components.
    pub fn new(knots: [&'a Knots; 2], control: impl Iterator<Item = [Interval; N]>) -> Self {
        Self { u: Axis::new(knots[0]), v: Axis::new(knots[1]), control: control.collect() }
    }

    /// Breaks in both directions.
    pub fn breaks(&self) -> [&[f64]; 2] {
        [&self.u.breaks, &self.v.breaks]
    }

    /// Whether the spline may have a crease strictly inside a box.
    pub fn creased(&self, [u, v]: [Interval; 2]) -> bool {
        self.u.creased(u) || self.v.creased(v)
    }

    /// How far (in the first parameter) a box that one crease runs through reaches beyond it, to the side where it reaches less;
    /// `None` where there are more creases, or any in the second parameter.
    pub fn beside_crease(&self, [u, v]: [Interval; 2]) -> Option<f64> {
        if self.v.creased(v) {
            return None;
        }
        let p = self.u.knots.degree();
        let inside = self.u.knots.distinct().into_iter().filter(|&(t, m)| m >= p && t > u.lo && t < u.hi);
        let all: Vec<f64> = inside.map(|k| k.0).filter(|t| self.u.is_inner(*t)).collect();
        let [t] = all[..] else { return None };
        let t = Interval::point(t);
        Some((Interval::point(u.hi) - t).hi.min((t - Interval::point(u.lo)).hi))
    }

    /// Over a box.
    pub fn over(&self, [u, v]: [Interval; 2]) -> Jet2<N> {
        self.pieces([u, v], &|net, a, b| net.over([a, b]))
    }

    /// At a place, known up to the rounding of a narrow box.
    pub fn at(&self, [u, v]: [Interval; 2]) -> Jet2<N> {
        self.pieces([u, v], &|net, a, b| net.at([a.local(u), b.local(v)], [a, b]))
    }

    fn pieces<const M: usize>(
        &self,
        [u, v]: [Interval; 2],
        on_net: &dyn Fn(Net<N>, &Part, &Part) -> Jet2<M>,
    ) -> Jet2<M> {
        let mut out: Option<Jet2<M>> = None;
        for i in self.u.pieces(u) {
            let a = self.u.part(i, u);
            for j in self.v.pieces(v) {
                let b = self.v.part(j, v);
                let found = on_net(self.net(&a, &b), &a, &b);
                out = Some(out.map_or(found, |o| o.hull(&found)));
            }
        }
        out.unwrap_or(Jet2::ZERO)
    }

    /// Bernstein coefficients over two parts.
    fn net(&self, a: &Part, b: &Part) -> Net<N> {
        let (p, q) = (self.u.knots.degree(), self.v.knots.degree());
        let row = self.v.knots.control_count();
        let mut data = vec![[Interval::ZERO; N]; (p + 1) * (q + 1)];
        let mut line = vec![[Interval::ZERO; N]; p + 1];
        for j in 0..=q {
            for (i, x) in line.iter_mut().enumerate() {
                *x = self.control[(a.first + i) * row + b.first + j];
            }
            for (i, x) in a.shares.of_points(&line).into_iter().enumerate() {
                data[i * (q + 1) + j] = x;
            }
        }
        for along in data.chunks_exact_mut(q + 1) {
            let found = b.shares.of_points(along);
            along.copy_from_slice(&found);
        }
        Net { p, q, data }
    }
}

/// Bernstein coefficients over a box, index `i (q + 1) + j`.
#[derive(Clone)]
struct Net<const N: usize> {
    p: usize,
    q: usize,
    data: Vec<[Interval; N]>,
}

impl<const N: usize> Net<N> {
    /// Derivatives by box coordinates: the six kinds as nets.
    fn kinds(&self) -> [Self; 6] {
        let (u, v) = (self.along_u(), self.along_v());
        [self.clone(), u.clone(), v.clone(), u.along_u(), u.along_v(), v.along_v()]
    }

    fn along_u(&self) -> Self {
        let row = self.q + 1;
        let of = |i: usize, j: usize| -> [Interval; N] {
            let (a, b) = (&self.data[i * row + j], &self.data[(i + 1) * row + j]);
            std::array::from_fn(|d| (b[d] - a[d]) * self.p as f64)
        };
        if self.p == 0 {
            return Self { p: 0, q: self.q, data: vec![[Interval::ZERO; N]; row] };
        }
        let data = (0..self.p).flat_map(|i| (0..row).map(move |j| (i, j))).map(|(i, j)| of(i, j)).collect();
        Self { p: self.p - 1, q: self.q, data }
    }

    fn along_v(&self) -> Self {
        let row = self.q + 1;
        let of = |i: usize, j: usize| -> [Interval; N] {
            let (a, b) = (&self.data[i * row + j], &self.data[i * row + j + 1]);
            std::array::from_fn(|d| (b[d] - a[d]) * self.q as f64)
        };
        if self.q == 0 {
            return Self { p: self.p, q: 0, data: vec![[Interval::ZERO; N]; self.p + 1] };
        }
        let data = (0..=self.p).flat_map(|i| (0..self.q).map(move |j| (i, j))).map(|(i, j)| of(i, j)).collect();
        Self { p: self.p, q: self.q - 1, data }
    }

    fn hull(&self) -> [Interval; N] {
        self.data.iter().skip(1).fold(self.data[0], |h, c| std::array::from_fn(|d| h[d].hull(c[d])))
    }

    fn value(mut self, [x, y]: [Interval; 2]) -> [Interval; N] {
        let row = self.q + 1;
        for i in 0..=self.p {
            self.data[i] = casteljau(&mut self.data[i * row..(i + 1) * row], y);
        }
        casteljau(&mut self.data[..=self.p], x)
    }

    fn over(&self, parts: [&Part; 2]) -> Jet2<N> {
        scaled(self.kinds().map(|k| k.hull()), parts)
    }

    fn at(&self, place: [Interval; 2], parts: [&Part; 2]) -> Jet2<N> {
        scaled(self.kinds().map(|k| k.value(place)), parts)
    }
}

/// De Casteljau's scheme; nothing is left of the coefficients.
fn casteljau<const N: usize>(b: &mut [[Interval; N]], x: Interval) -> [Interval; N] {
    let y = Interval::ONE - x;
    for r in 1..b.len() {
        for i in 0..b.len() - r {
            let next = b[i + 1];
            for (c, n) in b[i].iter_mut().zip(next) {
                *c = y * *c + x * n;
            }
        }
    }
    b[0]
}

/// Derivatives by parameters from those by box coordinates.
fn scaled<const N: usize>(kinds: [[Interval; N]; 6], [a, b]: [&Part; 2]) -> Jet2<N> {
    let (u, v) = (a.inverse(), b.inverse());
    let by = [Interval::ONE, u, v, u.sqr(), u * v, v.sqr()];
    Jet2::of_kinds(std::array::from_fn(|k| kinds[k].map(|x| x * by[k])))
}

/// Homogeneous control points about an origin: `(x − w o, w)`.
pub(super) fn about<'c>(control: &'c [[f64; 4]], origin: [f64; 3]) -> impl Iterator<Item = [Interval; 4]> + 'c {
    control.iter().map(move |c| {
        let moved = |d: usize| Interval::less_product(c[d], c[3], origin[d]);
        [moved(0), moved(1), moved(2), Interval::from(c[3])]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::surface::Surface;

    fn wavy() -> Surface {
        let (k, l) = (Knots::uniform(3, 3, 0.0, 3.0), Knots::uniform(2, 2, -1.0, 1.0));
        let (k, l) = (k.expect("knots"), l.expect("knots"));
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..6 {
            for j in 0..4 {
                points.push(Vec3::new(f64::from(i), f64::from(j), f64::from(i * 2 + j).sin()));
                weights.push(1.0 + 0.1 * f64::from((i + j) % 3));
            }
        }
        Surface::new(k, l, &points, Some(&weights)).expect("surface")
    }

    #[test]
    fn boxes_hold_what_is_in_them_and_places_are_sharp() {
        let s = wavy();
        let origin = [1.0, 2.0, 3.0];
        let tensor = Tensor::new([&s.knots_u, &s.knots_v], about(&s.control, origin));
        let boxes = [[(0.2, 0.4), (-0.9, -0.7)], [(0.9, 1.2), (-0.1, 0.1)], [(2.0, 3.0), (0.5, 1.0)]];
        for [(a, b), (c, d)] in boxes {
            let over = tensor.over([Interval::new(a, b), Interval::new(c, d)]).affine().kinds();
            for k in 0..=6 {
                for l in 0..=6 {
                    let (u, v) = (a + (b - a) * f64::from(k) / 6.0, c + (d - c) * f64::from(l) / 6.0);
                    let j = s.jet(u, v);
                    let at = tensor.at([Interval::point(u), Interval::point(v)]).affine().kinds();
                    let all = [j.p - Vec3::from(origin), j.du, j.dv, j.duu, j.duv, j.dvv];
                    for (n, x) in all.iter().enumerate() {
                        for e in 0..3 {
                            assert!(over[n][e].widen(1e-9).contains(x[e]), "{n} {e} {u} {v}");
                            assert!(at[n][e].widen(1e-6).contains(x[e]));
                            // Second derivatives of the quadratic direction jump at knots.
                            assert!(n > 2 || at[n][e].width() < 1e-6, "{n} {:?}", at[n][e]);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn pieces_go_on_beyond_the_domain() {
        let s = wavy();
        let tensor = Tensor::new([&s.knots_u, &s.knots_v], about(&s.control, [0.0; 3]));
        let out = tensor.over([Interval::new(2.9, 3.1), Interval::new(0.9, 1.05)]).affine();
        let p = s.jet(3.08, 1.03).p;
        assert!((0..3).all(|d| out.p[d].contains(p[d]) && out.p[d].width() < 2.0));
    }
}
