//! Rails: given curves of space, cut at their corners into smooth pieces.
//!
//! Where three or more points are joined smoothly: cubic splines by averaged knots \[PT97, 9.2.1\].

use crate::geom::segment::segment_distance;
use crate::geom::{BBox, Vec3};
use crate::num::quadrature::GAUSS_8;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq::{self, LsqError};
use crate::spline::SplineError;

/// A curve of space as a chain of smooth pieces with corners between them. The rail's parameter runs over [0, number
/// of pieces]; every piece has the domain [0, 1]. Lengths in mm.
///
/// # Example
/// ```
/// use torse::{geom::Vec3, torse::rail::Rail};
/// let at = |k: i32| Vec3::new(100.0 * (0.2 * f64::from(k)).cos(), 100.0 * (0.2 * f64::from(k)).sin(), 0.0);
/// let points: Vec<Vec3> = (0..=8).map(at).collect();
/// let arc = Rail::through("arc", &points)?;
/// assert!((arc.length() - 160.0).abs() < 0.1, "1.6 rad of radius 100");
/// assert!(Rail::in_one_plane(&[&arc], 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Rail {
    /// Name, for messages and files.
    pub name: String,
    /// Smooth pieces, homogeneous, each beginning where the one before ends.
    pub pieces: Vec<Curve<4>>,
    /// Whether the last piece ends where the first begins.
    pub closed: bool,
}

/// Length (mm) of a piece between two parameters of one span of its knots (quadrature, about 1e-10 relative).
pub(crate) fn span_length(c: &Curve<4>, a: f64, b: f64) -> f64 {
    let h = (b - a) / 4.0;
    let part = |i: i32| {
        let x = a + h * f64::from(i);
        GAUSS_8.integrate(x, x + h, |t| jet(c, t)[1].norm())
    };
    (0..4).map(part).sum()
}

/// A stretch of a rail's piece, run through by the parameter of a strip.
#[derive(Clone, Debug, PartialEq)]
pub struct RailPart {
    /// Piece of the rail.
    pub piece: usize,
    /// The piece's parameter as a function of the strip's u ∈ [0, 1].
    pub parameter: Curve<1>,
}

/// Data that are no rail.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RailError {
    /// Nothing, or only points that coincide.
    #[error("{rail} has no length; give at least two different points")]
    Empty {
        /// Name.
        rail: String,
    },
    /// Coordinates that are no numbers.
    #[error("{rail}: point {index} has a coordinate that is not a finite number")]
    NotFinite {
        /// Name.
        rail: String,
        /// Index of the (control) point.
        index: usize,
    },
    /// Coordinates whose squares are no numbers any more.
    #[error("{rail}: point {index} lies {value:.1e} mm from the origin; check the unit, and remove the point if it is stray")]
    TooFar {
        /// Name.
        rail: String,
        /// Index of the (control) point.
        index: usize,
        /// Its greatest coordinate, mm.
        value: f64,
    },
    /// Pieces that do not follow each other.
    #[error("{rail}: piece {piece} begins {gap:.3e} mm from the end of the piece before; join the pieces in CAD")]
    Gap {
        /// Name.
        rail: String,
        /// Index of the later piece.
        piece: usize,
        /// Distance, mm.
        gap: f64,
    },
    /// The curve meets itself.
    #[error("{rail} meets itself at the parameters {first:.4} and {second:.4} of its length; split it there")]
    SelfIntersecting {
        /// Name.
        rail: String,
        /// Share of the length.
        first: f64,
        /// Share of the length.
        second: f64,
    },
    /// Points that no curve could be laid through.
    #[error("{rail}: {source}")]
    Fit {
        /// Name.
        rail: String,
        /// What went wrong.
        source: LsqError,
    },
    /// Invalid spline.
    #[error("{rail}: {source}")]
    Spline {
        /// Name.
        rail: String,
        /// What went wrong.
        source: SplineError,
    },
}

/// Ends closer than this share of the rail's size are one point: what ten printed digits give.
const SAME: f64 = 1e-9;
/// Greatest coordinate, mm: a million kilometres; squares and cubes of larger ones leave the numbers.
const FARTHEST: f64 = 1e12;
/// Points beyond both ends of a closed row that its spline runs through too: the influence of a point falls to a
/// quarter with every point, and is rounding after so many.
const WRAP: usize = 26;
/// Largest gap between pieces, share of the size: CAD systems join edges to about this.
const GAP: f64 = 1e-6;
/// Turn of the tangent (rad) above which a joint is a corner: well above what writers of splines lose, well below
/// what anybody calls a corner.
const CORNER: f64 = 1e-4;
/// Turn (rad) between chords from which points joined smoothly make a corner nevertheless: 30°.
const POINT_CORNER: f64 = 0.53;
/// Turn (rad) up to which pieces join smoothly.
const SMOOTH: f64 = 1e-6;
/// Parameters this near the end of a piece are its end.
pub(crate) const SEAM: f64 = 1e-9;
/// Distance (share of the whole) up to which a spline is cut at a knot and not beside it: on a span that is rounding its
/// tangent would be, too.
const AT_KNOT: f64 = 1e-9;
/// Chords per rail for the search of self-intersections.
const CHORDS: usize = 256;

impl Rail {
    /// The chain of curves. Curves of no length are left out; curves are cut where they have corners.
    ///
    /// # Errors
    /// See [`RailError`]: no length, numbers that are not finite, gaps, a curve that meets itself.
    pub fn new(name: &str, curves: &[Curve<4>]) -> Result<Self, RailError> {
        let rail = || name.to_owned();
        let spline = |source| RailError::Spline { rail: rail(), source };
        let mut bbox = BBox::empty();
        for c in curves {
            for (index, h) in c.control.iter().enumerate() {
                if h.iter().any(|x| !x.is_finite()) || h[3] <= 0.0 {
                    return Err(RailError::NotFinite { rail: rail(), index });
                }
                let value = place(h).amax();
                if value.is_nan() || value > FARTHEST {
                    return Err(RailError::TooFar { rail: rail(), index, value });
                }
                bbox.include(&place(h));
            }
        }
        let size = bbox.diagonal();
        if size <= 0.0 {
            return Err(RailError::Empty { rail: rail() });
        }
        let mut pieces: Vec<Curve<4>> = Vec::new();
        for c in curves {
            let b = BBox::of(c.control.iter().map(place).collect::<Vec<_>>().iter());
            if b.diagonal() <= SAME * size {
                continue;
            }
            for p in smooth_pieces(c).map_err(spline)? {
                if let Some(last) = pieces.last() {
                    let gap = (end_point(&p, 0.0) - end_point(last, 1.0)).norm();
                    if gap > GAP * size {
                        return Err(RailError::Gap { rail: rail(), piece: pieces.len(), gap });
                    }
                }
                pieces.push(p);
            }
        }
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Err(RailError::Empty { rail: rail() });
        };
        let closed = (end_point(first, 0.0) - end_point(last, 1.0)).norm() <= GAP * size;
        let out = Self { name: rail(), pieces, closed };
        out.simple(size)?;
        Ok(out)
    }

    /// Curves put in order, and turned where needed, so that each begins near the end of the one before; starts with an
    /// end that has no neighbour, if there is one. Says nothing about the gaps that remain: [`Rail::new`] does.
    pub fn chain(curves: &[Curve<4>]) -> Vec<Curve<4>> {
        let ends = |c: &Curve<4>| (end_point(c, 0.0), end_point(c, 1.0));
        let mut rest: Vec<Curve<4>> = curves.iter().filter(|c| !c.control.is_empty()).cloned().collect();
        if rest.len() < 2 {
            return rest;
        }
        // The loneliest end begins.
        let lonely = |k: usize, p: &Vec3| {
            let others = rest.iter().enumerate().filter(|(i, _)| *i != k);
            others.map(|(_, c)| ends(c)).map(|(a, b)| (a - p).norm().min((b - p).norm())).fold(f64::INFINITY, f64::min)
        };
        let (mut first, mut turned, mut far) = (0, false, -1.0);
        for (k, c) in rest.iter().enumerate() {
            let (a, b) = ends(c);
            for (p, turn) in [(a, false), (b, true)] {
                let d = lonely(k, &p);
                if d > far {
                    (first, turned, far) = (k, turn, d);
                }
            }
        }
        let start = rest.swap_remove(first);
        let mut out = vec![if turned { start.reversed() } else { start }];
        while !rest.is_empty() {
            let tip = ends(&out[out.len() - 1]).1;
            let (mut best, mut turn, mut near) = (0, false, f64::INFINITY);
            for (k, c) in rest.iter().enumerate() {
                let (a, b) = ends(c);
                for (d, t) in [((a - tip).norm(), false), ((b - tip).norm(), true)] {
                    if d < near {
                        (best, turn, near) = (k, t, d);
                    }
                }
            }
            let next = rest.swap_remove(best);
            out.push(if turn { next.reversed() } else { next });
        }
        out
    }

    /// Curves in groups whose ends meet, each put in order as by [`Rail::chain`], in the order of their first curves.
    pub fn chains(curves: &[Curve<4>]) -> Vec<Vec<Curve<4>>> {
        let curves: Vec<&Curve<4>> = curves.iter().filter(|c| !c.control.is_empty()).collect();
        let ends: Vec<[Vec3; 2]> = curves.iter().map(|c| [end_point(c, 0.0), end_point(c, 1.0)]).collect();
        let near = GAP * BBox::of(ends.iter().flatten()).diagonal();
        let meet = |i: usize, j: usize| ends[i].iter().any(|p| ends[j].iter().any(|q| (p - q).norm() <= near));
        let mut group: Vec<usize> = (0..curves.len()).collect();
        for j in 0..curves.len() {
            for i in 0..j {
                if group[i] != group[j] && meet(i, j) {
                    let (keep, drop) = (group[i].min(group[j]), group[i].max(group[j]));
                    group.iter_mut().filter(|g| **g == drop).for_each(|g| *g = keep);
                }
            }
        }
        let of = |k: usize| (0..curves.len()).filter(|i| group[*i] == k).map(|i| curves[i].clone()).collect::<Vec<_>>();
        (0..curves.len()).filter(|k| group[*k] == *k).map(|k| Self::chain(&of(k))).collect()
    }

    /// The polyline through points; straight pieces with corners.
    ///
    /// # Errors
    /// See [`RailError`].
    pub fn polyline(name: &str, points: &[Vec3]) -> Result<Self, RailError> {
        finite(name, points)?;
        let mut lines = Vec::new();
        for w in points.windows(2).filter(|w| w[0] != w[1]) {
            let control = vec![homogeneous(&w[0]), homogeneous(&w[1])];
            let line = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], control);
            lines.push(line.map_err(|source| RailError::Spline { rail: name.into(), source })?);
        }
        Self::new(name, &lines)
    }

    /// The cubic spline through points with chord-length parameters; corners where chords turn by more than 30°. A
    /// row of points that ends where it begins, and has no corner there or elsewhere, is smooth at its seam too.
    ///
    /// # Errors
    /// See [`RailError`].
    pub fn through(name: &str, points: &[Vec3]) -> Result<Self, RailError> {
        finite(name, points)?;
        let mut points = points.to_vec();
        points.dedup();
        if points.len() < 2 {
            return Err(RailError::Empty { rail: name.into() });
        }
        let mut corners = vec![0];
        for k in 1..points.len() - 1 {
            let (a, b) = (points[k] - points[k - 1], points[k + 1] - points[k]);
            if a.angle(&b) > POINT_CORNER {
                corners.push(k);
            }
        }
        corners.push(points.len() - 1);
        if corners.len() == 2 && seam_is_smooth(&points) {
            // Once more round on both sides; of the spline through all, the one turn is kept.
            let n = points.len() - 1;
            let wrap = WRAP.min(n);
            let row: Vec<Vec3> = (0..=n + 2 * wrap).map(|k| points[(k + n - wrap) % n]).collect();
            let stretch: Vec<[f64; 3]> = row.iter().map(|p| (*p).into()).collect();
            let parameters = lsq::chord_parameters(&stretch);
            let whole = cubic_through(name, &stretch)?;
            let spline = |source| RailError::Spline { rail: name.into(), source };
            let knots = whole.knots.breaks();
            let cut = |t: f64| knots.iter().copied().find(|k| (k - t).abs() <= AT_KNOT).unwrap_or(t);
            let mut once = whole.restricted(cut(parameters[wrap]), cut(parameters[wrap + n])).map_err(spline)?;
            // Both ends exactly at the given point.
            let last = once.control.len() - 1;
            let end = homogeneous(&points[0]);
            (once.control[0], once.control[last]) = (end, end);
            return Self::new(name, &[once]);
        }
        let mut curves = Vec::new();
        for w in corners.windows(2) {
            let stretch: Vec<[f64; 3]> = points[w[0]..=w[1]].iter().map(|p| (*p).into()).collect();
            curves.push(cubic_through(name, &stretch)?);
        }
        Self::new(name, &curves)
    }

    /// Piece and its own parameter.
    fn locate(&self, s: f64) -> (&Curve<4>, f64) {
        let n = self.pieces.len();
        let k = (s.floor().max(0.0) as usize).min(n - 1);
        (&self.pieces[k], (s - k as f64).clamp(0.0, 1.0))
    }

    /// Point at the parameter `s` ∈ [0, number of pieces].
    pub fn point(&self, s: f64) -> Vec3 {
        let (c, t) = self.locate(s);
        place(&c.point(t))
    }

    /// Length of the piece `k` from its start to its parameter `t`, mm (quadrature, about 1e-10 relative).
    pub fn piece_length(&self, k: usize, t: f64) -> f64 {
        let Some(c) = self.pieces.get(k) else { return 0.0 };
        c.knots.breaks().windows(2).filter(|w| w[0] < t).map(|w| span_length(c, w[0], w[1].min(t))).sum()
    }

    /// Length from the start to the parameter `s`, mm.
    pub fn length_to(&self, s: f64) -> f64 {
        let k = (s.floor().max(0.0) as usize).min(self.pieces.len() - 1);
        (0..k).map(|i| self.piece_length(i, 1.0)).sum::<f64>() + self.piece_length(k, s - k as f64)
    }

    /// Length of the whole, mm.
    pub fn length(&self) -> f64 {
        self.length_to(self.pieces.len() as f64)
    }

    /// Box of the control points.
    pub fn bbox(&self) -> BBox {
        let mut b = BBox::empty();
        for h in self.pieces.iter().flat_map(|c| &c.control) {
            b.include(&place(h));
        }
        b
    }

    /// Diagonal of the box around rails, mm.
    pub fn extent(rails: &[&Self]) -> f64 {
        let boxes: Vec<BBox> = rails.iter().map(|r| r.bbox()).collect();
        BBox::of(boxes.iter().flat_map(|b| [&b.min, &b.max])).diagonal()
    }

    /// Whether control points of rails lie within a distance (mm) of the plane through the largest triangle that is easily
    /// found among them.
    pub fn in_one_plane(rails: &[&Self], within: f64) -> bool {
        let control = rails.iter().flat_map(|r| &r.pieces).flat_map(|c| &c.control);
        let points: Vec<Vec3> = control.map(|p| Vec3::new(p[0], p[1], p[2]) / p[3]).collect();
        let farthest = |from: &dyn Fn(&Vec3) -> f64| points.iter().max_by(|p, q| from(p).total_cmp(&from(q)));
        let Some(first) = points.first() else { return true };
        let Some(second) = farthest(&|p| (p - first).norm()) else { return true };
        let line = second - first;
        let Some(third) = farthest(&|p| line.cross(&(p - first)).norm()) else { return true };
        let Some(normal) = line.cross(&(third - first)).try_normalize(0.0) else { return true };
        points.iter().all(|p| normal.dot(&(p - first)).abs() <= within)
    }

    /// The same rail run through backwards.
    pub fn reversed(&self) -> Self {
        let pieces = self.pieces.iter().rev().map(Curve::reversed).collect();
        Self { name: self.name.clone(), pieces, closed: self.closed }
    }

    /// The same closed rail beginning at the parameter `s`; where it began, pieces that join smoothly become one. Open
    /// rails stay as they are.
    ///
    /// # Errors
    /// Pieces that cannot be cut or joined (none for valid rails).
    pub fn started_at(&self, s: f64) -> Result<Self, SplineError> {
        let n = self.pieces.len();
        if !self.closed || !s.is_finite() {
            return Ok(self.clone());
        }
        let s = s.rem_euclid(n as f64);
        let (k, t) = (s.floor() as usize % n, s.fract());
        let mut pieces: Vec<Curve<4>> = self.pieces[k + 1..].to_vec();
        let whole = t <= SEAM || t >= 1.0 - SEAM;
        if t <= SEAM {
            pieces.insert(0, self.pieces[k].clone());
        } else if !whole {
            pieces.insert(0, on_unit(&self.pieces[k].restricted(t, 1.0)?)?);
        }
        // Pieces before the old start end with the index `seam`.
        let seam = pieces.len();
        pieces.extend_from_slice(&self.pieces[..k]);
        if t >= 1.0 - SEAM {
            pieces.push(self.pieces[k].clone());
        } else if !whole {
            pieces.push(on_unit(&self.pieces[k].restricted(0.0, t)?)?);
        }
        if seam > 0 && seam < pieces.len() {
            if let Some(one) = joined(&pieces[seam - 1], &pieces[seam])? {
                pieces[seam - 1] = one;
                pieces.remove(seam);
            }
        }
        Ok(Self { name: self.name.clone(), pieces, closed: true })
    }

    /// The whole rail as one curve over [0, 1]; `None` if it has a corner. Where pieces join, the tangent is continuous
    /// and the speed nearly so; degrees are raised to the highest of all pieces.
    ///
    /// # Errors
    /// Pieces whose degree cannot be raised (none for valid rails).
    pub fn as_one(&self) -> Result<Option<Curve<4>>, SplineError> {
        let degree = self.pieces.iter().map(|p| p.knots.degree()).max().unwrap_or(1);
        let mut whole: Option<Curve<4>> = None;
        for piece in &self.pieces {
            whole = Some(match whole {
                None => piece.clone(),
                Some(before) => match joined(&before.elevated_to(degree)?, &piece.clone().elevated_to(degree)?)? {
                    Some(one) => one,
                    None => return Ok(None),
                },
            });
        }
        Ok(whole)
    }

    /// The first corner: index of the piece behind it, and the turn of the tangent there, rad. The seam of a closed rail
    /// does not count.
    pub fn first_corner(&self) -> Option<(usize, f64)> {
        let turn = |k: usize| tangent(&self.pieces[k - 1], 1.0).angle(&tangent(&self.pieces[k], 0.0));
        (1..self.pieces.len()).map(|k| (k, turn(k))).find(|(_, turn)| *turn > SMOOTH)
    }

    /// `count` points and more along the rail, at least four per piece, corners included.
    pub fn samples(&self, count: usize) -> Vec<Vec3> {
        self.sample_parameters(count).into_iter().map(|s| self.point(s)).collect()
    }

    /// Parameters of [`Rail::samples`].
    pub fn sample_parameters(&self, count: usize) -> Vec<f64> {
        let total = self.length().max(f64::MIN_POSITIVE);
        let mut out = Vec::new();
        for k in 0..self.pieces.len() {
            let parts = ((count as f64 * self.piece_length(k, 1.0) / total).ceil() as usize).max(4);
            out.extend((0..parts).map(|i| k as f64 + i as f64 / parts as f64));
        }
        out.push(self.pieces.len() as f64);
        out
    }

    /// Whether a piece is a straight line, up to rounding.
    pub fn is_straight(&self, k: usize) -> bool {
        self.pieces.get(k).is_some_and(is_straight)
    }

    /// Looks for chords that meet although they are not neighbours: in the order in which they begin along the longest
    /// side of the box, so that only those are compared that lie beside each other there.
    fn simple(&self, size: f64) -> Result<(), RailError> {
        let points = self.samples(CHORDS);
        let n = points.len() - 1;
        let side = {
            let b = BBox::of(points.iter());
            (b.max - b.min).imax()
        };
        let near = SAME * size;
        let reach = |k: usize, d: usize| {
            let (a, b) = (points[k][d], points[k + 1][d]);
            (a.min(b), a.max(b) + near)
        };
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|i, j| reach(*i, side).0.total_cmp(&reach(*j, side).0));
        let apart = |i: usize, j: usize| {
            (0..3).any(|d| {
                let (p, q) = (reach(i, d), reach(j, d));
                p.1 < q.0 || q.1 < p.0
            })
        };
        let mut met: Option<(usize, usize)> = None;
        for (at, &k) in order.iter().enumerate() {
            let end = reach(k, side).1;
            for &l in order[at + 1..].iter().take_while(|l| reach(**l, side).0 <= end) {
                let (i, j) = (k.min(l), k.max(l));
                let neighbours = j <= i + 1 || (self.closed && i == 0 && j == n - 1);
                if neighbours || met.is_some_and(|m| m <= (i, j)) || apart(i, j) {
                    continue;
                }
                if segment_distance([&points[i], &points[i + 1]], [&points[j], &points[j + 1]]) <= near {
                    met = Some((i, j));
                }
            }
        }
        match met {
            Some((i, j)) => Err(RailError::SelfIntersecting {
                rail: self.name.clone(),
                first: i as f64 / n as f64,
                second: j as f64 / n as f64,
            }),
            None => Ok(()),
        }
    }
}

/// Point and two derivatives of a homogeneous curve.
pub(crate) fn jet(c: &Curve<4>, t: f64) -> [Vec3; 3] {
    let h = c.jet(t);
    let v = h.map(|r| Vec3::new(r[0], r[1], r[2]));
    let (w, r) = (h.map(|r| r[3]), 1.0 / h[0][3]);
    let p = v[0] * r;
    let d = (v[1] - p * w[1]) * r;
    [p, d, (v[2] - d * (2.0 * w[1]) - p * w[2]) * r]
}

/// Unit tangent of a piece; where the derivative vanishes, that of a secant into the piece.
pub(crate) fn tangent(c: &Curve<4>, t: f64) -> Vec3 {
    // A derivative below this share of the chord gives no direction; a secant over this parameter does: it is short
    // against the piece, and where that starts like a parabola its ends still differ by eight digits.
    const STOP: f64 = 1e-6;
    const SECANT: f64 = 1e-4;
    let d = jet(c, t)[1];
    let chord = (place(&c.control[c.control.len() - 1]) - place(&c.control[0])).norm();
    if d.norm() > STOP * chord {
        return d / d.norm();
    }
    let other = if t > 0.5 { t - SECANT } else { t + SECANT };
    let s = (place(&c.point(other)) - place(&c.point(t))) * (other - t);
    s.try_normalize(0.0).unwrap_or_else(Vec3::x)
}

fn place(h: &[f64; 4]) -> Vec3 {
    Vec3::new(h[0], h[1], h[2]) / h[3]
}

fn homogeneous(p: &Vec3) -> [f64; 4] {
    [p.x, p.y, p.z, 1.0]
}

fn end_point(c: &Curve<4>, t: f64) -> Vec3 {
    place(&c.control[if t > 0.5 { c.control.len() - 1 } else { 0 }])
}

fn is_straight(c: &Curve<4>) -> bool {
    // Distance of control points from the chord, as a share of it, that is rounding.
    const STRAIGHT: f64 = 1e-12;
    let (a, b) = (end_point(c, 0.0), end_point(c, 1.0));
    let chord = b - a;
    let l = chord.norm();
    l > 0.0 && c.control.iter().all(|h| (place(h) - a).cross(&chord).norm() <= STRAIGHT * l * l)
}

fn finite(name: &str, points: &[Vec3]) -> Result<(), RailError> {
    if let Some(index) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(RailError::NotFinite { rail: name.into(), index });
    }
    match points.iter().position(|p| p.amax() > FARTHEST) {
        Some(index) => Err(RailError::TooFar { rail: name.into(), index, value: points[index].amax() }),
        None => Ok(()),
    }
}

/// The cubic spline through points with chord-length parameters; of lower degree through fewer than four.
fn cubic_through(name: &str, stretch: &[[f64; 3]]) -> Result<Curve<4>, RailError> {
    let parameters = lsq::chord_parameters(stretch);
    let degree = 3.min(stretch.len() - 1);
    let n = stretch.len();
    let mut values = vec![0.0; degree + 1];
    values.extend((1..n - degree).map(|j| parameters[j..j + degree].iter().sum::<f64>() / degree as f64));
    values.extend(std::iter::repeat_n(1.0, degree + 1));
    let fitted = Knots::new(degree, values, n)
        .map_err(LsqError::from)
        .and_then(|knots| lsq::fit(stretch, &parameters, &knots))
        .map_err(|source| RailError::Fit { rail: name.into(), source })?;
    Ok(super::strip::homogeneous(&fitted.curve))
}

/// Whether a row of points ends where it begins, with chords that do not turn by a corner there.
fn seam_is_smooth(points: &[Vec3]) -> bool {
    let n = points.len() - 1;
    let size = BBox::of(points.iter()).diagonal();
    n >= 4
        && (points[n] - points[0]).norm() <= SAME * size
        && (points[n] - points[n - 1]).angle(&(points[1] - points[0])) <= POINT_CORNER
}

/// Cuts a curve at knots where its tangent turns; the pieces on [0, 1].
fn smooth_pieces(c: &Curve<4>) -> Result<Vec<Curve<4>>, SplineError> {
    let (a, b) = c.domain();
    let mut cuts = vec![a];
    for (t, m) in c.knots.distinct() {
        if t > a && t < b && m >= c.knots.degree() {
            let (left, right) = c.split(t)?;
            let turn = tangent(&left, t).angle(&tangent(&right, t));
            if turn > CORNER {
                cuts.push(t);
            }
        }
    }
    cuts.push(b);
    cuts.windows(2)
        .map(|w| {
            let piece = c.restricted(w[0], w[1])?;
            let on_unit = |t: f64| if t >= w[1] { 1.0 } else { ((t - w[0]) / (w[1] - w[0])).clamp(0.0, 1.0) };
            let values = piece.knots.values().iter().map(|&t| on_unit(t)).collect();
            Ok(Curve { knots: Knots::new(piece.knots.degree(), values, piece.control.len())?, control: piece.control })
        })
        .collect()
}

/// The curve with the domain [0, 1].
fn on_unit(c: &Curve<4>) -> Result<Curve<4>, SplineError> {
    let (a, b) = c.domain();
    let unit = |t: f64| if t >= b { 1.0 } else { ((t - a) / (b - a)).clamp(0.0, 1.0) };
    let values = c.knots.values().iter().map(|&t| unit(t)).collect();
    Ok(Curve { knots: Knots::new(c.knots.degree(), values, c.control.len())?, control: c.control.clone() })
}

/// Two pieces as one, if they join smoothly and have the same degree, or are straight.
fn joined(a: &Curve<4>, b: &Curve<4>) -> Result<Option<Curve<4>>, SplineError> {
    let (x, y) = (tangent(a, 1.0), tangent(b, 0.0));
    if x.angle(&y) > SMOOTH {
        return Ok(None);
    }
    let ends = |c: &Curve<4>| (end_point(c, 0.0), end_point(c, 1.0));
    if is_straight(a) && is_straight(b) {
        let control = vec![homogeneous(&ends(a).0), homogeneous(&ends(b).1)];
        return Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], control).map(Some);
    }
    let p = a.knots.degree();
    if p != b.knots.degree() {
        return Ok(None);
    }
    // Parameters in proportion to the control polygons, so that the speed hardly jumps.
    let long = |c: &Curve<4>| c.control.windows(2).map(|w| (place(&w[1]) - place(&w[0])).norm()).sum::<f64>();
    let r = long(a) / (long(a) + long(b));
    let (va, vb) = (a.knots.values(), b.knots.values());
    let mut values: Vec<f64> = va[..va.len() - 1].iter().map(|t| if *t >= 1.0 { r } else { r * t }).collect();
    values.extend(vb[p + 1..].iter().map(|t| if *t >= 1.0 { 1.0 } else { r + (1.0 - r) * t }));
    let scale = a.control[a.control.len() - 1][3] / b.control[0][3];
    let mut control = a.control.clone();
    control.extend(b.control[1..].iter().map(|h| h.map(|x| x * scale)));
    Curve::new(p, values, control).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec3> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec()
    }

    #[test]
    fn a_square_is_closed_and_has_four_straight_pieces() {
        let r = Rail::polyline("square", &square()).expect("rail");
        assert!(r.closed && r.pieces.len() == 4 && (0..4).all(|k| r.is_straight(k)));
        assert!((r.length() - 4.0).abs() < 1e-12 && (r.length_to(2.5) - 2.5).abs() < 1e-12);
        assert!((r.point(1.5) - Vec3::new(1.0, 0.5, 0.0)).norm() < 1e-14);
    }

    #[test]
    fn points_are_joined_smoothly_and_corners_kept() {
        let arc: Vec<Vec3> =
            (0..=20).map(|k| f64::from(k) * 0.05).map(|t| Vec3::new(t.sin(), t.cos(), 0.1 * t)).collect();
        let r = Rail::through("arc", &arc).expect("rail");
        assert_eq!(r.pieces.len(), 1);
        for p in &arc {
            assert!(r.samples(4000).iter().any(|q| (p - q).norm() < 1e-3));
        }
        let mut bent = arc.clone();
        bent.extend((1..10).map(|k| arc[20] + Vec3::z() * f64::from(k)));
        assert_eq!(Rail::through("bent", &bent).expect("rail").pieces.len(), 2);
    }

    #[test]
    fn evenly_spaced_points_of_a_loop_are_joined_smoothly_at_the_seam() {
        for n in [48, 96, 250, 500, 1000] {
            // As printed with nine decimals.
            let round = |x: f64| (x * 1e9).round() / 1e9;
            let at = |k: usize| {
                let (s, c) = (std::f64::consts::TAU * (k % n) as f64 / n as f64).sin_cos();
                Vec3::new(round(300.0 * c), round(300.0 * s), 0.0)
            };
            let r = Rail::through("circle", &(0..=n).map(at).collect::<Vec<_>>()).expect("rail");
            let turn = tangent(&r.pieces[0], 1.0).angle(&tangent(&r.pieces[0], 0.0));
            assert!(r.closed && r.pieces.len() == 1 && turn < 1e-6, "{n}: {turn:e}");
        }
    }

    #[test]
    fn a_closed_rail_may_begin_anywhere() {
        let points = [(0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (0.5, 0.0)];
        let r = Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 0.0))).expect("rail");
        let turned = r.started_at(1.0).expect("rail");
        assert!(turned.pieces.len() == 4 && turned.closed && (0..4).all(|k| turned.is_straight(k)));
        assert!((turned.point(0.0) - Vec3::x()).norm() < 1e-15 && (turned.length() - 4.0).abs() < 1e-12);
        let round: Vec<Vec3> = (0..=40)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 40.0)
            .map(|a| Vec3::new(a.cos(), a.sin(), 0.2 * (2.0 * a).sin()))
            .collect();
        let r = Rail::through("loop", &round).expect("rail");
        let turned = r.started_at(0.3).expect("rail");
        assert!((turned.point(0.0) - r.point(0.3)).norm() < 1e-12 && (turned.length() - r.length()).abs() < 1e-9);
        // The spline is smooth at its seam: the turned rail is one piece again.
        assert_eq!((r.pieces.len(), turned.pieces.len()), (1, 1));
        let (end, start) = (tangent(&r.pieces[0], 1.0), tangent(&r.pieces[0], 0.0));
        assert!(end.angle(&start) < 1e-9, "{:e}", end.angle(&start));
    }

    #[test]
    fn pieces_without_corners_become_one_curve() {
        let line = |a: [f64; 3], b: [f64; 3]| {
            let control = vec![[a[0], a[1], a[2], 1.0], [b[0], b[1], b[2], 1.0]];
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], control).expect("line")
        };
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let arc = Curve::<4>::new(
            2,
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            vec![[2.0, 0.0, 0.0, 1.0], [3.0 * h, 0.0, 0.0, h], [3.0, 1.0, 0.0, 1.0]],
        )
        .expect("arc");
        let pieces = [line([0.0; 3], [1.0, 0.0, 0.0]), line([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]), arc];
        let rail = Rail::new("r", &pieces).expect("rail");
        let one = rail.as_one().expect("spline").expect("no corner");
        assert_eq!((rail.pieces.len(), one.knots.degree(), rail.first_corner()), (3, 2, None));
        let whole = Rail::new("one", &[one]).expect("rail");
        assert!(whole.pieces.len() == 1 && (whole.length() - rail.length()).abs() < 1e-9);
        let square = Rail::polyline("square", &square()).expect("rail");
        let (piece, turn) = square.first_corner().expect("corner");
        assert!(square.as_one().expect("spline").is_none() && piece == 1);
        assert!((turn - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_rail_is_refused_by_name() {
        let p = Vec3::new(1.0, 2.0, 3.0);
        assert!(matches!(Rail::polyline("a", &[p, p]), Err(RailError::Empty { .. })));
        let far = Vec3::new(1e300, 0.0, 0.0);
        assert!(matches!(Rail::through("a", &[p, far]), Err(RailError::TooFar { index: 1, .. })));
        assert!(matches!(Rail::polyline("a", &[p, far]), Err(RailError::TooFar { index: 1, .. })));
        assert!(matches!(Rail::through("a", &[]), Err(RailError::Empty { .. })));
        let nan = Vec3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(Rail::through("a", &[p, nan]), Err(RailError::NotFinite { rail: "a".into(), index: 1 }));
        let eight = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        assert!(matches!(Rail::polyline("a", &eight), Err(RailError::SelfIntersecting { .. })));
    }

    #[test]
    fn rails_in_one_plane_are_told_from_others() {
        let line = |p: [f64; 3], q: [f64; 3]| Rail::polyline("r", &[Vec3::from(p), Vec3::from(q)]).expect("rail");
        let low = line([0.0, 0.0, 0.0], [10.0, 0.0, 0.0]);
        let beside = line([0.0, 5.0, 1.0], [9.0, 5.0, 1.0]);
        let askew = line([0.0, 5.0, 0.0], [9.0, 5.0, 1.0]);
        assert!(Rail::in_one_plane(&[&low, &beside], 1e-9) && !Rail::in_one_plane(&[&low, &askew], 0.1));
        assert!(Rail::in_one_plane(&[&low, &askew], 1.0) && Rail::in_one_plane(&[&low, &low], 1e-9));
    }
}
