//! A map of the panel to the plane that keeps rulings straight, and how far it is from keeping lengths.
//!
//! *The map.* With rails A(t), B(t) of the exported patch, `R = A + λ E`, `E = B − A`, and flat rails a(t), b(t) in the
//! plane, `u = b − a`, it takes `A + λ E` to `a + λ u`: rulings go to lines, λ is kept. The flat rails are polynomials
//! of degree 10 on pieces of the spans, joined exactly.
//!
//! *How they are found* does not matter for the proof: in the tangent plane along a ruling with unit normal m, any
//! vector X' stands for the complex number `g(X') = (X'·E + i m·(E × X'))/E²` times u, so `u' = g(E') u` and
//! `a' = g(A') u` \[DC76\]; this linear equation is solved by its Taylor series about the middle of the piece.
//!
//! *What is proven* \[certificate, 6\]: the first fundamental form of the flat patch minus that of the panel has the six
//! coefficients `u·u − E·E`, `a'·u − A'·E`, `u'·u − E'·E`, `a'·a' − A'·A'`, `a'·u' − A'·E'`, `u'·u' − E'·E'`. Their
//! Taylor coefficients at the middle nearly vanish; the rest is enclosed over the piece (Moore, Kearfott and Cloud, ch. 9).
//! Put into orthonormal coordinates of the tangent plane this bounds |σ² − 1| for the singular values σ of the map, on
//! the part of every ruling that the trimming curves reach. Nothing is assumed of the patch but that it is ruled: a
//! twist shows as a strain.

use crate::certify::curve_model::{span_of, within};
use crate::certify::ruled::{rough, Ruled};
use crate::certify::vector::{cross, dot, length, V3};
use crate::num::bernstein::{from_powers, powers_about_half, Scalar};
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::series::Series;
use crate::num::taylor_model::TaylorModel;

/// Taylor coefficients kept of rails, and of their derivatives.
const M: usize = 11;
const N: usize = M - 1;

/// Half of a piece in its own variable.
const HALF: Interval = Interval { lo: -0.5, hi: 0.5 };

/// Pieces are halved until the strain is below this, a nanometre in a metre,
const STRAIN: f64 = 1e-9;
/// or above this share of the strain before halving: that helps neither against a twist nor against rounding.
const HELPS: f64 = 0.5;

/// Halvings of a span at most.
const DEPTH: usize = 9;

/// Rounded parameters may stick out of the rulings in use by this share of them: the polynomials go on.
const HAIR: f64 = 1e-12;

/// Direction cosines of numbers are unit vectors up to rounding, which this pays for many times over.
const NEARLY_ONE: f64 = 1.0 - 1e-12;

/// Flat rails of a patch over the rulings in use.
pub(super) struct FlatRails {
    pieces: Vec<FlatPiece>,
    /// Ends of the pieces, increasing.
    breaks: Vec<f64>,
    /// Images of both ends of the last ruling, exactly.
    end: [[f64; 2]; 2],
    /// Bound of |σ − 1| for the factor σ by which any length changes.
    pub strain: f64,
    /// See [`FlatRails::length_change`].
    change: Change,
}

/// Flat rails in powers of `x = (t − a)/(b − a) − ½`.
struct FlatPiece {
    a: f64,
    b: f64,
    inverse: Interval,
    /// Components of the first rail, then of the vector to the second.
    rail: [Vec<Interval>; 2],
    vector: [Vec<Interval>; 2],
    /// Weights of both rails in space; empty where they are the same, as those of polynomial patches: r is the share then.
    weights: [Vec<Interval>; 2],
}

/// Rails in space over a piece: Taylor coefficients of A', E and E'.
struct Rails {
    da: V3<Series<N>>,
    e: V3<Series<N>>,
    de: V3<Series<N>>,
}

/// Where flat rails begin, and which of them are points.
#[derive(Clone, Copy, Default)]
pub(super) struct Start {
    /// Images of both ends of the first ruling; none: anywhere.
    pub places: Option<[[f64; 2]; 2]>,
    /// Rails whose control points are all the same, number for number: their images are one point.
    pub points: [bool; 2],
}

impl FlatRails {
    /// Flat rails over the rulings that `used` gives a range of r for; `side` ±1 says from which side the panel is
    /// seen. `None` where nothing could be shown.
    pub fn new(patch: &Ruled, used: &dyn Fn(f64, f64) -> Option<Interval>, side: f64) -> Option<Self> {
        Self::from(patch, used, side, &Start::default())
    }

    /// As [`FlatRails::new`], from a given beginning on.
    ///
    /// Where one rail is a point, map and patch are cones about it: they scale alike along their rulings, and what is
    /// shown of the other rail holds everywhere but in the point itself. Then `used` is to answer for that rail.
    pub fn from(patch: &Ruled, used: &dyn Fn(f64, f64) -> Option<Interval>, side: f64, begin: &Start) -> Option<Self> {
        let change = Change::default();
        let mut out = Self { pieces: Vec::new(), breaks: Vec::new(), end: [[0.0; 2]; 2], strain: 0.0, change };
        let breaks = patch.breaks();
        // Ends, halvings, and the strain before the last of these.
        let mut open: Vec<(f64, f64, usize, f64)> =
            breaks.windows(2).rev().map(|w| (w[0], w[1], 0, f64::INFINITY)).collect();
        let mut start = *begin;
        while let Some((a, b, depth, before)) = open.pop() {
            let Some(r) = used(a, b) else { continue };
            let (piece, end, strain) = developed(patch, (a, b), r, side, &start);
            let m = 0.5 * (a + b);
            let good = strain.is_some_and(|s| s.bound <= STRAIN || s.bound >= HELPS * before);
            if !good && depth < DEPTH && a < m && m < b {
                let here = strain.map_or(f64::INFINITY, |s| s.bound);
                open.extend([(m, b, depth + 1, here), (a, m, depth + 1, here)]);
                continue;
            }
            let strain = strain?;
            out.strain = out.strain.max(strain.bound);
            out.change = out.change.with(&strain);
            out.pieces.push(piece);
            start.places = Some(end);
            out.end = end;
        }
        // Rulings in use are one stretch, without a gap between pieces.
        let whole = out.pieces.windows(2).all(|w| w[0].b.to_bits() == w[1].a.to_bits());
        let end = out.pieces.last()?.b;
        out.breaks = out.pieces.iter().map(|p| p.a).chain([end]).collect();
        whole.then_some(out)
    }

    /// Bound (mm) of the change of the length of any path of at most this length that crosses no ruling twice, as
    /// shortest paths do.
    pub fn length_change(&self, length: f64) -> f64 {
        self.change.of(length)
    }

    /// How lengths change over all of it.
    pub fn change(&self) -> Change {
        self.change
    }

    /// Ends of the pieces, increasing.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Images of both ends of the last ruling, exactly: where a next strip begins.
    pub fn end(&self) -> [[f64; 2]; 2] {
        self.end
    }

    /// The map along `(t(s), r(s))`, and how [`rough`] it is; `None` outside the rulings in use.
    pub fn along_curve(&self, t: Jet, r: Jet) -> Option<([Jet; 2], f64)> {
        let (first, last) = (self.piece(t.v.lo)?, self.piece(t.v.hi)?);
        let on = |i: usize| {
            let p = &self.pieces[i];
            let lo = t.v.lo.max(p.a);
            let t = Jet { v: Interval { lo, hi: t.v.hi.min(p.b).max(lo) }, ..t };
            p.along_curve(t, r)
        };
        let hull = |p: [Jet; 2], i: usize| {
            let q = on(i);
            [0, 1].map(|d: usize| p[d].hull(q[d]))
        };
        Some(((first + 1..=last).fold(on(first), hull), rough(&self.breaks, first..=last, t)))
    }

    /// The map along Bernstein coefficients of t and r: closer than [`FlatRails::along`], but only within one piece, and where
    /// both rails have the same weights.
    pub fn model(&self, theta: &[Vec<Interval>; 2]) -> Option<[TaylorModel; 2]> {
        let p = &self.pieces[span_of(&theta[0], &self.breaks)?];
        if !p.weights[0].is_empty() {
            return None;
        }
        let powers = within(&theta[0], p.a, p.inverse).powers(p.rail[0].len() - 1);
        let r = TaylorModel::of_bernstein(&theta[1]);
        let of = |c: &[Interval]| TaylorModel::combination(c, &powers);
        let point = [0, 1].map(|d: usize| of(&p.rail[d]) + r * of(&p.vector[d]));
        point.iter().all(TaylorModel::is_finite).then_some(point)
    }

    /// About where the map takes a point.
    pub fn place(&self, t: f64, r: f64) -> Option<[f64; 2]> {
        let p = &self.pieces[self.piece(t)?];
        let x = (t - p.a) / (p.b - p.a) - 0.5;
        let value = |c: &[Interval]| c.iter().rev().fold(0.0, |v, c| v * x + c.mid());
        let share = if p.weights[0].is_empty() {
            r
        } else {
            let (a, b) = (value(&p.weights[0]), value(&p.weights[1]));
            r * b / (a + r * (b - a))
        };
        Some([0, 1].map(|d: usize| value(&p.rail[d]) + share * value(&p.vector[d])))
    }

    /// Images of both ends of the ruling at `t`.
    pub fn ruling(&self, t: f64) -> Option<[[Interval; 2]; 2]> {
        let p = &self.pieces[self.piece(t)?];
        let x = p.variable(Jet::constant(Interval::point(t)));
        let [a, v] = [&p.rail, &p.vector].map(|c| [0, 1].map(|d: usize| x.polynomial(&c[d]).v));
        Some([a, [a[0] + v[0], a[1] + v[1]]])
    }

    /// Ends of the pieces: places to begin a search at.
    pub fn places(&self) -> Vec<f64> {
        let mut out: Vec<f64> = self.pieces.iter().flat_map(|p| [p.a, 0.5 * (p.a + p.b)]).collect();
        out.extend(self.pieces.last().map(|p| p.b));
        out
    }

    /// Piece of a ruling; a hair outside the first or last still belongs to it.
    fn piece(&self, t: f64) -> Option<usize> {
        let (first, last) = (self.pieces.first()?, self.pieces.last()?);
        let hair = (last.b - first.a) * HAIR;
        let inside = t >= first.a - hair && t <= last.b + hair;
        inside.then(|| self.pieces[..self.pieces.len() - 1].partition_point(|p| p.b <= t))
    }
}

impl FlatPiece {
    fn variable(&self, t: Jet) -> Jet {
        (t - Jet::from(self.a)) * Jet::constant(self.inverse) - Jet::from(0.5)
    }

    fn along_curve(&self, t: Jet, r: Jet) -> [Jet; 2] {
        let x = self.variable(t);
        let share = if self.weights[0].is_empty() {
            r
        } else {
            let (p, q) = (x.polynomial(&self.weights[0]), x.polynomial(&self.weights[1]));
            let rest = Jet::from(1.0) - r;
            // All the same, but each tight where r is near one end.
            if r.v.lo > 0.5 {
                Jet::from(1.0).over(Jet::from(1.0) + rest.over(r) * p.over(q))
            } else if r.v.hi < 0.5 {
                let k = r.over(rest) * q.over(p);
                k.over(Jet::from(1.0) + k)
            } else {
                (r * q).over(p + r * (q - p))
            }
        };
        [0, 1].map(|d: usize| x.polynomial(&self.rail[d]) + share * x.polynomial(&self.vector[d]))
    }
}

/// Flat rails over `[a, b]` that go on from `start`, where they end, and the strain if it could be bounded.
fn developed(
    patch: &Ruled,
    (a, b): (f64, f64),
    r: Interval,
    side: f64,
    start: &Start,
) -> (FlatPiece, [[f64; 2]; 2], Option<Strain>) {
    // Each rail about a point of its own: beside the tip of a cone weights that vary would count with the distance from there.
    let origins = patch.middles(0.5 * (a + b));
    let apart = [0, 1, 2].map(|d: usize| Interval::point(origins[1][d]) - Interval::point(origins[0][d]));
    let ends = [0, 1].map(|end: usize| patch.end(end, a, b, &origins[end]).map(|c| powers_about_half(&c)));
    let weights = if patch.alike { [Vec::new(), Vec::new()] } else { [ends[0][3].clone(), ends[1][3].clone()] };
    let [middle, all] = [Interval::ZERO, HALF].map(|x| rails(&ends, apart, x, patch.rational));
    let shares = shares(&weights, r);
    let mut flat = solved(&middle, 0.5 * (shares.lo + shares.hi), side, start.places);
    for (rail, _) in flat.iter_mut().zip(start.points).filter(|(_, is_point)| *is_point) {
        for c in rail {
            let first = c[0];
            c.fill(first);
        }
    }
    let last = [0, 1].map(|k: usize| [0, 1].map(|d: usize| flat[k][d][flat[k][d].len() - 1]));
    let exact = |c: &[f64]| powers_about_half(&c.iter().map(|&x| Interval::point(x)).collect::<Vec<_>>());
    let rail = [0, 1].map(|d: usize| exact(&flat[0][d]));
    let other = [0, 1].map(|d: usize| exact(&flat[1][d]));
    let vector = [0, 1].map(|d: usize| rail[d].iter().zip(&other[d]).map(|(&p, &q)| q - p).collect::<Vec<_>>());
    let defect = |at: &Rails, x: Interval| -> [Series<N>; 6] {
        let plane = |c: &[Vec<Interval>; 2]| [0, 1].map(|d: usize| taylor::<M>(&c[d], x));
        let (da, v) = (plane(&rail).map(|s| derived(&s)), plane(&vector));
        let (u, du) = (v.map(|s| cut(&s)), v.map(|s| derived(&s)));
        let flat = |p: &[Series<N>; 2], q: &[Series<N>; 2]| p[0] * q[0] + p[1] * q[1];
        [
            flat(&u, &u) - dot(&at.e, &at.e),
            flat(&da, &u) - dot(&at.da, &at.e),
            flat(&du, &u) - dot(&at.de, &at.e),
            flat(&da, &da) - dot(&at.da, &at.da),
            flat(&da, &du) - dot(&at.da, &at.de),
            flat(&du, &du) - dot(&at.de, &at.de),
        ]
    };
    let (here, over) = (defect(&middle, Interval::ZERO), defect(&all, HALF));
    let most: [f64; 6] = std::array::from_fn(|i| remainder(&here[i], &over[i]));
    let strain = strain(&most, &middle, &all, shares);
    let inverse = Interval::ONE / (Interval::point(b) - Interval::point(a));
    (FlatPiece { a, b, inverse, rail, vector, weights }, last, strain)
}

/// Bound over |x| ≤ ½ of a function with these coefficients at 0 and over the whole range.
fn remainder(here: &Series<N>, over: &Series<N>) -> f64 {
    let mut sum = Interval::point(over.0[N - 1].mag());
    for k in (0..N - 1).rev() {
        sum = sum.scale_exact(0.5) + Interval::point(here.0[k].mag());
    }
    sum.hi
}

/// Range of λ for a range of r: increasing in r, as weights are positive.
fn shares(weights: &[Vec<Interval>; 2], r: Interval) -> Interval {
    if weights[0].is_empty() {
        return r;
    }
    let over = |c: &[Interval]| Jet::constant(HALF).polynomial(c).v;
    let (p, q) = (over(&weights[0]), over(&weights[1]));
    let at = |r: f64| {
        let r = Interval::point(r);
        // (1 + (1 − r)/r · p/q)⁻¹ with every interval once, and its value at 0.
        if r.lo <= 0.0 {
            Interval::ZERO
        } else {
            Interval::ONE / (Interval::ONE + (Interval::ONE - r) / r * (p / q))
        }
    };
    Interval { lo: at(r.lo).lo.max(0.0), hi: at(r.hi).hi.min(1.0) }
}

/// Taylor coefficients at the points of `x` of a polynomial given by powers.
fn taylor<const K: usize>(powers: &[Interval], x: Interval) -> Series<K> {
    let n = powers.len();
    Series(std::array::from_fn(|k| {
        if x.lo.to_bits() == x.hi.to_bits() {
            return powers.get(k).copied().unwrap_or(Interval::ZERO);
        }
        (k..n).rev().fold(Interval::ZERO, |v, j| v * x + powers[j] * binomial(j, k))
    }))
}

fn derived(s: &Series<M>) -> Series<N> {
    Series(std::array::from_fn(|k| s.0[k + 1] * (k + 1) as f64))
}

fn cut(s: &Series<M>) -> Series<N> {
    Series(std::array::from_fn(|k| s.0[k]))
}

/// Rails over `x`, of which those at hand begin `apart` from each other.
fn rails(ends: &[[Vec<Interval>; 4]; 2], apart: V3<Interval>, x: Interval, rational: bool) -> Rails {
    let curve = |c: &[Vec<Interval>; 4]| -> V3<Series<M>> {
        let w = taylor::<M>(&c[3], x);
        [0, 1, 2].map(|d: usize| {
            let p = taylor::<M>(&c[d], x);
            if rational {
                p.over(w)
            } else {
                p
            }
        })
    };
    let (a, b) = (curve(&ends[0]), curve(&ends[1]));
    let mut e = [0, 1, 2].map(|d: usize| b[d] - a[d]);
    (0..3).for_each(|d| e[d].0[0] += apart[d]);
    Rails { da: a.map(|s| derived(&s)), e: e.map(|s| cut(&s)), de: e.map(|s| derived(&s)) }
}

/// Bernstein coefficients of both flat rails from the series at the middle, going on from `start`; see the head of this
/// file. Numbers only: nothing here is relied upon.
fn solved(at: &Rails, share: f64, side: f64, start: Option<[[f64; 2]; 2]>) -> [[Vec<f64>; 2]; 2] {
    let (e, de, da) = (&at.e, &at.de, &at.da);
    let across = [0, 1, 2].map(|d: usize| da[d] + de[d].times(share));
    let normal = cross(e, &across);
    let size = dot(&normal, &normal).sqrt();
    let square = dot(e, e);
    let turned = |x: &V3<Series<N>>| dot(&normal, &cross(e, x)).over(size * square);
    let numbers = |s: Series<N>, k: f64| -> [f64; N] { s.0.map(|c| k * c.mid()) };
    let f = [numbers(dot(de, e).over(square), 1.0), numbers(turned(de), side)];
    let g = [numbers(dot(da, e).over(square), 1.0), numbers(turned(da), side)];
    let times = |p: [f64; 2], q: [f64; 2]| [p[0] * q[0] - p[1] * q[1], p[0] * q[1] + p[1] * q[0]];
    // u' = f u and a' = g u with u = |E| at the middle.
    let mut u = vec![[square.0[0].mid().max(0.0).sqrt(), 0.0]];
    let mut a = vec![[0.0; 2]];
    for k in 0..N {
        let (mut du, mut dv) = ([0.0; 2], [0.0; 2]);
        for j in 0..=k {
            let (p, q) = (times([f[0][j], f[1][j]], u[k - j]), times([g[0][j], g[1][j]], u[k - j]));
            for d in 0..2 {
                du[d] += p[d];
                dv[d] += q[d];
            }
        }
        let per = 1.0 / (k + 1) as f64;
        u.push(du.map(|x| x * per));
        a.push(dv.map(|x| x * per));
    }
    let bernstein = |c: &[[f64; 2]], d: usize| from_powers(&c.iter().map(|x| x[d]).collect::<Vec<f64>>(), -0.5, 0.5);
    let (rail, vector) = ([0, 1].map(|d| bernstein(&a, d)), [0, 1].map(|d| bernstein(&u, d)));
    // Turned and moved so that it begins where the piece before ends.
    let (turn, from, first) = match start {
        None => ([1.0, 0.0], [0.0; 2], [0.0; 2]),
        Some([p, q]) => {
            let (own, want) = ([vector[0][0], vector[1][0]], [q[0] - p[0], q[1] - p[1]]);
            let size = own[0] * own[0] + own[1] * own[1];
            (times(want, [own[0] / size, -own[1] / size]), [rail[0][0], rail[1][0]], p)
        }
    };
    let count = rail[0].len();
    let mut out = [[vec![0.0; count], vec![0.0; count]], [vec![0.0; count], vec![0.0; count]]];
    for i in 0..count {
        let p = times(turn, [rail[0][i] - from[0], rail[1][i] - from[1]]);
        let v = times(turn, [vector[0][i], vector[1][i]]);
        for d in 0..2 {
            out[0][d][i] = first[d] + p[d];
            out[1][d][i] = first[d] + p[d] + v[d];
        }
    }
    if let Some(start) = start {
        for (rail, place) in out.iter_mut().zip(start) {
            for d in 0..2 {
                rail[d][0] = place[d];
            }
        }
    }
    out
}

/// How lengths change over a piece.
#[derive(Clone, Copy)]
struct Strain {
    /// Bound of |σ − 1|.
    bound: f64,
    /// Bound of |σ² − 1|.
    norm: Interval,
    /// Change of squared lengths along rulings,
    along: Interval,
    /// and what across them adds to it, times how far the piece reaches across.
    crossing: Interval,
}

impl Strain {
    /// On both parts of the rulings.
    fn and(&self, o: &Self) -> Self {
        Self {
            bound: self.bound.max(o.bound),
            norm: self.norm.hull(o.norm),
            along: self.along.hull(o.along),
            crossing: self.crossing.hull(o.crossing),
        }
    }
}

/// How lengths change over all pieces.
///
/// Of a path with the components dx along and dy across rulings, ds'² − ds² is at most `f dx² + 2 s |dx dy| + t dy²` with
/// the parts f, s, t of the strain; with `ds' + ds ≥ (2 − n) ds` and n the norm of these, ds' − ds is at most
/// `(f |dx| + (2 s + t) |dy|)/(2 − n)`. A path that crosses every ruling once has no more dy in a piece than its reach.
/// That is far less than the largest strain of all times the length, where a panel bends sharply in a short stretch.
#[derive(Clone, Copy)]
pub(super) struct Change {
    norm: Interval,
    along: Interval,
    crossing: Interval,
}

impl Default for Change {
    fn default() -> Self {
        Self { norm: Interval::ZERO, along: Interval::ZERO, crossing: Interval::ZERO }
    }
}

impl Change {
    fn with(&self, s: &Strain) -> Self {
        let Strain { norm, along, crossing, .. } = *s;
        self.and(&Self { norm, along, crossing })
    }

    /// Over what follows, too.
    pub fn and(&self, o: &Self) -> Self {
        Self { norm: self.norm.hull(o.norm), along: self.along.hull(o.along), crossing: self.crossing + o.crossing }
    }

    /// See [`FlatRails::length_change`].
    pub fn of(&self, length: f64) -> f64 {
        let Self { norm, along, crossing } = self;
        let least = Interval::point(2.0) - Interval::point(norm.hi);
        ((Interval::point(along.hi) * Interval::point(length) + Interval::point(crossing.hi)) / least).hi
    }
}

/// Breadth of a part of the rulings at its narrow end, as a share of that at the other, from which on it is taken in two: what
/// is off at the wide end would else count at the narrow one.
const NARROW: f64 = 0.25;
/// Parts of the rulings are taken in two so often at most.
const PARTS: usize = 6;

/// How lengths change, from bounds of the six coefficients, on all parts of the rulings.
fn strain(most: &[f64; 6], middle: &Rails, all: &Rails, share: Interval) -> Option<Strain> {
    let mut open = vec![(share, 0)];
    let mut out: Option<Strain> = None;
    while let Some((part, depth)) = open.pop() {
        match narrowed(middle, &part).filter(|_| depth < PARTS) {
            Some(cut) => {
                open.extend([(Interval { hi: cut, ..part }, depth + 1), (Interval { lo: cut, ..part }, depth + 1)]);
            }
            None => {
                let here = strain_on(most, middle, all, part)?;
                out = Some(out.map_or(here, |o| o.and(&here)));
            }
        }
    }
    out
}

/// Where a part of the rulings that is much narrower at one end than at the other should be cut: where it is as wide as both
/// ends in the geometric mean.
fn narrowed(middle: &Rails, share: &Interval) -> Option<f64> {
    let at = |v: &V3<Series<N>>| [0, 1, 2].map(|d: usize| v[d].0[0].mid());
    let (e, de, da) = (at(&middle.e), at(&middle.de), at(&middle.da));
    let breadth = |l: f64| {
        let n = cross(&e, &[0, 1, 2].map(|d: usize| da[d] + l * de[d]));
        dot(&n, &n).sqrt()
    };
    let [a, b] = [breadth(share.lo), breadth(share.hi)];
    let cut = share.lo + (share.hi - share.lo) * ((a * b).sqrt() - a) / (b - a);
    (a.min(b) < NARROW * a.max(b) && share.lo < cut && cut < share.hi).then_some(cut)
}

/// As [`strain`], of a part of the rulings over which they do not become much narrower.
fn strain_on(most: &[f64; 6], middle: &Rails, all: &Rails, share: Interval) -> Option<Strain> {
    let value = |v: &V3<Series<N>>| [0, 1, 2].map(|d: usize| v[d].0[0]);
    let (e, de, da) = (value(&all.e), value(&all.de), value(&all.da));
    let square = e[0].sqr() + e[1].sqr() + e[2].sqr();
    // What the flat velocity across the ruling is at least: E × (A' + λ E') along a fixed direction, linear in λ.
    let (p, q) = (cross(&e, &da), cross(&e, &de));
    let (m, n) = (value(&middle.e), [0, 1, 2].map(|d: usize| middle.da[d].0[0] + middle.de[d].0[0] * share.mid()));
    let direction = cross(&m, &n).map(Interval::mid);
    let size = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = direction.map(|x| Interval::point(x / size));
    let (p, q) = (dot(&unit, &p), dot(&unit, &q));
    let across = [share.lo, share.hi].map(|l| (p + q * l).lo).into_iter().fold(f64::INFINITY, f64::min) * NEARLY_ONE;
    if !(across > 0.0 && square.lo > 0.0 && square.is_finite()) {
        return None;
    }
    let ruling = length(&e);
    let across = Interval::point(across) / ruling;
    let velocity = [0, 1, 2].map(|d: usize| da[d] + de[d] * share);
    let along = (dot(&velocity, &e) / square).abs();
    let [uu, au, duu, aa, adu, dudu] = most.map(|x| Interval::symmetric(x).abs());
    let l = share.abs();
    // |form| of t and λ together, then in directions across and along the ruling.
    let mixed = au + l * duu;
    let tt = aa + (l * adu).scale_exact(2.0) + l.sqr() * dudu;
    let first = uu / square;
    let second = (mixed + along * uu) / (ruling * Interval::point(across.lo));
    let third = (tt + (along * mixed).scale_exact(2.0) + along.sqr() * uu) / Interval::point(across.lo).sqr();
    let norm = (first.sqr() + second.sqr().scale_exact(2.0) + third.sqr()).sqrt();
    // |σ − 1| ≤ |σ² − 1| (1 + |σ² − 1|)/2 up to ½.
    let bound = (norm * (Interval::ONE + norm)).scale_exact(0.5).hi;
    let reach = length(&cross(&e, &velocity)) / ruling;
    let crossing = (second.scale_exact(2.0) + third) * reach;
    (bound <= 0.5 && crossing.hi.is_finite()).then_some(Strain { bound, norm, along: first, crossing })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::{dual_patch, primal_patch};
    use crate::spline::surface::Surface;

    fn rails_of(patch: &Surface) -> Option<FlatRails> {
        FlatRails::new(&Ruled::new(patch).expect("ruled"), &|_, _| Some(Interval::new(0.0, 1.0)), 1.0)
    }

    #[test]
    fn exact_patches_keep_lengths_and_lengths_are_those_of_the_patch() {
        for patch in [primal_patch(), dual_patch()] {
            let flat = rails_of(&patch).expect("flat rails");
            assert!(flat.strain < 1e-8, "{:e}", flat.strain);
            // A curve across all rulings, by chords in space and in the plane.
            let ((t0, t1), _) = patch.domain();
            let at = |i: u32| (t0 + (t1 - t0) * f64::from(i) / 4000.0, 0.5 + 0.4 * (f64::from(i) * 0.002).sin());
            let place = |i: u32| {
                let (t, r) = at(i);
                let [x, y] = flat.along_curve(Jet::from(t), Jet::from(r)).expect("inside").0;
                [x.v.mid(), y.v.mid()]
            };
            let point = |i: u32| patch.point(at(i).0, at(i).1);
            let (mut space, mut plane) = (0.0, 0.0);
            for i in 0..4000 {
                space += (point(i + 1) - point(i)).norm();
                let (p, q) = (place(i), place(i + 1));
                plane += (q[0] - p[0]).hypot(q[1] - p[1]);
            }
            assert!((space / plane - 1.0).abs() < 1e-6, "{space} {plane}");
        }
    }

    #[test]
    fn what_lengths_change_adds_up_to_no_more_than_the_greatest_strain_of_all() {
        let mut patch = primal_patch();
        let length = 2.0 * patch.bbox().diagonal();
        let exact = rails_of(&patch).expect("flat rails");
        assert!(exact.length_change(length) <= exact.strain * length * 4.0, "{:e}", exact.length_change(length));
        // A twist in one of its spans only is felt there.
        patch.control[8][2] += 0.02;
        let twisted = rails_of(&patch).expect("flat rails");
        let change = twisted.length_change(length);
        assert!(change > exact.length_change(length) && change < twisted.strain * length, "{change:e}");
    }

    #[test]
    fn a_twisted_patch_has_a_strain() {
        let mut patch = primal_patch();
        patch.control[8][2] += 0.02;
        let strain = rails_of(&patch).map_or(f64::INFINITY, |f| f.strain);
        assert!(strain > 1e-7, "{strain:e}");
    }
}
