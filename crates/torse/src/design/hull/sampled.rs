//! Curves as points, and the triangles of their convex hull: where the search for rulings begins \[W15, 4B\].

use super::contact::{on, wrap, OnRail};
use crate::control::Control;
use crate::geom::convex_hull::convex_hull;
use crate::geom::segment::share;
use crate::geom::Vec3;
use crate::spline::SplineError;
use crate::torse::rail::Rail;

/// Why there is no hull.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HullError {
    /// A tolerance larger than the curves.
    #[error(transparent)]
    Loose(#[from] crate::geom::coarse::Loose),
    /// No volume.
    #[error("there is no point off the plane of {curves}: the convex hull has no volume; add a curve off that plane")]
    Flat {
        /// Names of the curves.
        curves: String,
    },
    /// No curve at all.
    #[error("a convex hull needs at least one curve; name the files of the curves")]
    NoCurves,
    /// A curve that comes nowhere near the boundary.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// A strip could not be stored.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// Distance from a plane, as a share of the size, up to which a curve is planar: rounding of points as tables print them.
const PLANAR: f64 = 1e-8;
/// Fewest samples on a piece.
const FEWEST_SAMPLES: usize = 4;

/// Curves as points, and the triangles of their hull.
pub(super) struct Sampled<'a> {
    pub(super) rails: &'a [Rail],
    pub(super) at: Vec<OnRail>,
    /// Neighbours on the curve; a point without neighbour is its own.
    pub(super) next: Vec<[usize; 2]>,
    /// Whether a curve is planar.
    pub(super) planar: Vec<bool>,
    /// Whether the pieces of a curve are planar without being straight.
    flat: Vec<Vec<bool>>,
    /// Parameter between samples of each curve.
    pub(super) step: Vec<f64>,
    pub(super) triangles: Vec<[usize; 3]>,
}

/// What a side of a triangle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SideKind {
    /// Two neighbouring samples of a curve.
    Curve,
    /// A straight piece.
    Straight,
    /// Anything else: a ruling.
    Ruling,
}

impl<'a> Sampled<'a> {
    pub(super) fn new(rails: &'a [Rail], samples: usize, control: &Control) -> Result<Self, HullError> {
        if rails.is_empty() {
            return Err(HullError::NoCurves);
        }
        let mut out = Self {
            rails,
            at: Vec::new(),
            next: Vec::new(),
            planar: Vec::new(),
            flat: Vec::new(),
            step: Vec::new(),
            triangles: Vec::new(),
        };
        for (r, rail) in rails.iter().enumerate() {
            let first = out.at.len();
            let per = samples.div_ceil(rail.pieces.len().max(1)).max(FEWEST_SAMPLES);
            for k in 0..rail.pieces.len() {
                let n = if rail.is_straight(k) { 1 } else { per };
                out.at.extend((0..n).map(|i| on(rails, r, k as f64 + i as f64 / n as f64)));
            }
            if !rail.closed {
                out.at.push(on(rails, r, rail.pieces.len() as f64));
            }
            let n = out.at.len() - first;
            let open = usize::from(!rail.closed);
            out.next.extend((0..n).map(|i| {
                let (next, last) = ((i + 1) % n, (i + n - 1) % n);
                let (next, last) = (
                    if i + 1 == n { next * (1 - open) + i * open } else { next },
                    if i == 0 { last * (1 - open) } else { last },
                );
                [first + next, first + last]
            }));
            let size = rail.bbox().diagonal();
            out.planar.push(is_planar(&out.at[first..], size));
            let is_flat = |k: usize| {
                let points: Vec<OnRail> = (0..=per).map(|i| on(rails, r, k as f64 + i as f64 / per as f64)).collect();
                !rail.is_straight(k) && is_planar(&points, size)
            };
            out.flat.push((0..rail.pieces.len()).map(is_flat).collect());
            out.step.push(1.0 / per as f64);
        }
        let points: Vec<Vec3> = out.at.iter().map(|a| a.point).collect();
        let names = || rails.iter().map(|r| r.name.clone()).collect::<Vec<_>>().join(", ");
        out.triangles =
            convex_hull(&points, &|| control.stopped()).ok_or_else(|| HullError::Flat { curves: names() })?;
        Ok(out)
    }

    pub(super) fn side(&self, e: [usize; 2]) -> SideKind {
        if !self.next[e[0]].contains(&e[1]) {
            SideKind::Ruling
        } else if is_chord(self.rails, &self.at[e[0]], &self.at[e[1]]) {
            SideKind::Straight
        } else {
            SideKind::Curve
        }
    }

    /// The curve with a triangle within its plane, or within that of one of its pieces, and whether it is the first.
    pub(super) fn lid(&self, f: &[usize; 3]) -> Option<(usize, bool)> {
        let r = self.at[f[0]].rail;
        if !f.iter().all(|&i| self.at[i].rail == r) {
            return None;
        }
        let n = self.flat[r].len();
        let on_piece = |k: usize| {
            let own =
                |s: f64| (s >= k as f64 && s <= (k + 1) as f64) || (s == 0.0 && k + 1 == n && self.rails[r].closed);
            self.flat[r][k] && f.iter().all(|&i| own(self.at[i].parameter))
        };
        match self.planar[r] {
            true => Some((r, true)),
            false => (0..n).any(on_piece).then_some((r, false)),
        }
    }

    /// Step of the parameter from one place of a curve to another, the shorter way round on closed ones.
    pub(super) fn step_between(&self, from: &OnRail, to: &OnRail) -> f64 {
        let (rail, step) = (&self.rails[from.rail], to.parameter - from.parameter);
        let n = rail.pieces.len() as f64;
        step - if rail.closed { (step / n).round() * n } else { 0.0 }
    }

    /// Greatest distance (mm) of the curves from the chords between samples, measured half way.
    pub(super) fn sagitta(&self) -> f64 {
        let off = |i: usize| {
            let (a, b) = (&self.at[i], &self.at[self.next[i][0]]);
            let step = if b.parameter > a.parameter { b.parameter - a.parameter } else { self.step[a.rail] };
            let x = on(self.rails, a.rail, wrap(&self.rails[a.rail], a.parameter + 0.5 * step)).point;
            (x - a.point - (b.point - a.point) * share(&a.point, &b.point, &x)).norm()
        };
        let curved = |i: &usize| {
            let next = self.next[*i][0];
            next != *i && !is_chord(self.rails, &self.at[*i], &self.at[next])
        };
        (0..self.at.len()).filter(curved).map(off).fold(0.0, f64::max)
    }

    /// Bracket of the search about a sample: two steps.
    pub(super) fn reach(&self, i: usize) -> f64 {
        2.0 * self.step[self.at[i].rail]
    }
}

fn is_planar(points: &[OnRail], size: f64) -> bool {
    let o = points[0].point;
    let normals = points.windows(2).map(|w| (w[0].point - o).cross(&(w[1].point - o)));
    let Some(n) = normals.max_by(|a, b| a.norm().total_cmp(&b.norm())).and_then(|n| n.try_normalize(0.0)) else {
        return true;
    };
    points.iter().all(|p| (p.point - o).dot(&n).abs() <= PLANAR * size)
}

/// Whether two neighbours are joined by a straight piece.
fn is_chord(rails: &[Rail], a: &OnRail, b: &OnRail) -> bool {
    let n = rails[a.rail].pieces.len() as f64;
    let whole = |x: f64| x == x.floor();
    let (x, y) = (a.parameter.min(b.parameter), a.parameter.max(b.parameter));
    let first = if y - x > 1.0 { y } else { x };
    whole(x) && whole(y) && first < n && rails[a.rail].is_straight(first as usize)
}
