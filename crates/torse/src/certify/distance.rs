//! Distance between a region of a face and a torse, proven at every point.
//!
//! *Method*: certificate, sections 1 and 2 \[certificate\]. On every triangle: one foot per point (opposite signs of
//! the exact foot function at both ends of an interval, one sign of its derivative), second-order Taylor bound
//! with interval Hessian, regular torse, no fold. Triangles that are too large are halved at the edge that is longest
//! in space.
//!
//! *Gluing*. Two triangles that share a vertex have the same foot there when their foot intervals meet: `E_t` keeps
//! its sign on the union, so there is one root in it. Then the feet agree along the whole common edge: the set where
//! two continuous feet agree is closed, and open because the roots are simple. An edge that only one side has halved
//! is a chain of shorter edges with its ends in common; the same argument goes along the chain.
//!
//! *Poles and curls*. Where `S_u × S_v` vanishes at the rim of the region (poles), or a surface curls up there in a space
//! far smaller than the tolerance (faulty files do), the sign of `N·(S_u × S_v)` cannot be shown. Let B be such a
//! triangle with a corner on the rim. A point of the region, anywhere, whose foot is also the foot of a point b of B is at
//! most D, the bound for all points, from that foot, and so at most 2D from b; and a way on the torse leads from there to the
//! foot of the rim corner: the image of the segment from b to the corner, whose length is bounded. It goes on to the trimming
//! curve as from every point of the rim. So the greatest such length is added to the mismatch δ of the trim there, and enters with
//! it, for all points that are no farther than 2D from B. All other points have positive degree as in part (c) of the theorem.

use super::cell::{Bench, CellBound, Good};
use super::family::Family;
use super::prepared::{Patch, Prepared};
use super::vector::{dot, exact};
use super::verdict::{Obstruction, Verdict};
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::torse::form::Torse;
use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

/// Effort allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistanceOptions {
    /// Triangles tried, halves of others among them beyond two per triangle given; default 60 000.
    pub budget: usize,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { budget: 60_000 }
    }
}

/// What was proven about a region and a torse: made here alone, and read like [`JudgementParts`].
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement(JudgementParts);

impl Deref for Judgement {
    type Target = JudgementParts;
    fn deref(&self) -> &JudgementParts {
        &self.0
    }
}

/// What is stated about a region and a torse.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgementParts {
    /// Whether the distance is proven to stay below the tolerance.
    pub verdict: Verdict,
    /// Lower bound of the radius of curvature of the torse over the region, mm; infinite for planes, 0 unless the
    /// distance holds.
    pub min_bend_radius: f64,
    /// Lower bound of the distance along rulings to the regression curve, mm; infinite for cylinders, 0 unless the
    /// distance holds.
    pub regression_clearance: f64,
    /// Triangles accepted.
    pub cells: usize,
    /// Triangles tried, halves of others among them.
    pub tried: usize,
    /// What the foot map may fold over at the rim.
    pub(super) curl: Curl,
}

/// Triangles at the rim on which the foot map may fold: ways on the torse from the feet of their points to that of a
/// point of the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Curl {
    /// Bound of their lengths, mm; 0 where nothing folds.
    pub way: f64,
    /// Bound of the torse's curvature along them, 1/mm.
    pub curvature: f64,
}

impl Curl {
    /// Where nothing folds.
    const NONE: Self = Self { way: 0.0, curvature: 0.0 };

    fn of(accepted: &[Accepted]) -> Self {
        accepted.iter().filter(|a| a.good.fold == 0).fold(Self::NONE, Self::with_part)
    }

    /// The same with a triangle that may fold.
    fn with_part(self, part: &Accepted) -> Self {
        Self {
            way: self.way.max(part.good.way),
            // At most the reciprocal, rounded up; infinite for a radius of 0.
            curvature: self.curvature.max((1.0 / part.good.bend_radius).next_up()),
        }
    }

    /// By given triangle, of those with parts that may fold.
    fn of_each(accepted: &[Accepted]) -> Vec<(usize, Self)> {
        let mut out: BTreeMap<usize, Self> = BTreeMap::new();
        for part in accepted.iter().filter(|a| a.good.fold == 0) {
            let whole = out.entry(part.of).or_insert(Self::NONE);
            *whole = whole.with_part(part);
        }
        out.into_iter().collect()
    }

    /// Bound of the distance between points of the region and the torse over the region, as in the theorem.
    fn with(&self, distance: f64) -> f64 {
        if self.way > 0.0 {
            way_total(distance, self.way, sag(self.way, self.curvature), 0.0)
        } else {
            distance
        }
    }
}

/// `√((D + s)² + δ²) + η`, rounded up: how far a point at most D off the torse is from the end of a way of length δ on it that
/// begins at its foot and leaves the tangent plane by at most s; and η farther.
pub(super) fn way_total(distance: f64, way: f64, sag: f64, more: f64) -> f64 {
    let normal = Interval::point(distance) + Interval::point(sag);
    ((normal.sqr() + Interval::point(way).sqr()).sqrt() + Interval::point(more)).hi
}

/// `κδ²/2`, rounded up: how far a way of length δ on a surface of curvature κ leaves the tangent plane where it begins.
pub(super) fn sag(way: f64, curvature: f64) -> f64 {
    (Interval::point(way).sqr() * curvature).scale_exact(0.5).hi
}

/// Halvings of a given triangle at most; corners stay exact enough for that many.
const DEPTH: usize = 40;

/// A triangle smaller than this share of the tolerance in space that still has no regular foot never will.
const HOPELESS: f64 = 0.02;

/// A given triangle is halved at least this often before it counts as hopeless.
const PATIENCE: usize = 6;

/// Triangles at the rim that may fold are halved until the way across them is at most this share of the tolerance, which
/// is then hardly seen; they are taken as they are if the foot map folds on the halves away from the rim.
const FINE_WAY: f64 = 1.0 / 64.0;

/// The worst triangles by quick look are examined first, one after the other, because refusals are found there.
const WORST_FIRST: usize = 6;

/// Corner of a triangle, comparable.
type Key = (u64, u64);

pub(super) fn key(p: &[f64; 2]) -> Key {
    // Adding zero turns −0 into 0.
    ((p[0] + 0.0).to_bits(), (p[1] + 0.0).to_bits())
}

/// A triangle under examination. Bits of `marks`: on edge k of the given triangle (0–2), is its corner k (3–5).
#[derive(Clone, Copy)]
struct Cell {
    triangle: [[f64; 2]; 3],
    marks: [u8; 3],
    depth: usize,
    guess: f64,
}

/// A triangle at the rim that would do as it is, if its halves do not: it, and how many triangles were open and accepted.
struct Fallback {
    whole: Accepted,
    open: usize,
    accepted: usize,
}

impl Fallback {
    /// Takes the triangle instead of what came of its halves.
    fn restore(self, open: &mut Vec<Cell>, accepted: &mut Vec<Accepted>) {
        open.truncate(self.open);
        accepted.truncate(self.accepted);
        accepted.push(self.whole);
    }
}

/// An accepted triangle.
struct Accepted {
    triangle: [[f64; 2]; 3],
    good: Good,
    /// Number of the given triangle that it is a part of.
    of: usize,
}

/// Bounds the distance from a region of a face to a torse along the torse's normals.
///
/// *Input*: triangles in the parameter plane, corners exact, none crossing a knot line of the surface; torse of at
/// most degree 3 and C¹, whose domain contains all feet with a margin; tolerance in mm.
///
/// *Guarantee*: with [`Verdict::Holds`], every point of the region has exactly one foot near by, continuous over the
/// region, at a regular place of the torse, at most `bound` away, and the region does not fold over under the foot
/// map, except for triangles at the rim that are so small that the bound contains the way to the rim besides; the bound
/// includes rounding. With [`Verdict::Fails`] the distance from the face's point at `uv` to the ruling at its foot is
/// proven to exceed the tolerance. *Not* guaranteed: anything about the exported patch and its trimming curves; see
/// [`patchwork`](super::patchwork()).
///
/// *Cost*: some 10 µs per triangle for bicubic polynomial surfaces; in parallel over triangles.
pub fn distance(
    prepared: &Prepared,
    torse: &Torse,
    triangles: &[[[f64; 2]; 3]],
    tolerance: f64,
    options: &DistanceOptions,
    control: &Control,
) -> Judgement {
    let mut judgement = judge(prepared, torse, triangles, &vec![tolerance; triangles.len()], options, control).parts;
    if let Verdict::Holds { bound } = judgement.verdict {
        let bound = judgement.curl.with(bound);
        judgement.verdict = match triangles.first() {
            Some(t) if bound > tolerance => Verdict::Undecided { uv: centroid(t), reason: Obstruction::Fold },
            _ => Verdict::Holds { bound },
        };
    }
    Judgement(judgement)
}

/// Foot intervals proven at the corners of triangles.
pub(super) type Feet = HashMap<Key, (f64, f64)>;

/// A judgement with what lies behind it.
pub(super) struct Judged {
    /// The judgement; its bound does not know of [`JudgementParts::curl`].
    pub parts: JudgementParts,
    /// Feet at the corners.
    pub feet: Feet,
    /// Bound of the distance over each given triangle; empty unless it holds.
    pub bounds: Vec<f64>,
    /// Given triangles, by number, of which a part at the rim may fold.
    pub folds: Vec<(usize, Curl)>,
}

/// As [`distance`], with a tolerance for every triangle.
pub(super) fn judge(
    prepared: &Prepared,
    torse: &Torse,
    triangles: &[[[f64; 2]; 3]],
    tolerances: &[f64],
    options: &DistanceOptions,
    control: &Control,
) -> Judged {
    let tolerance = tolerances.iter().copied().fold(f64::INFINITY, f64::min);
    let blank = |verdict: Verdict| {
        // Of no points at all anything is true; of points that were not looked at nothing is known.
        let least = if matches!(verdict, Verdict::Holds { .. }) { f64::INFINITY } else { 0.0 };
        let (min_bend_radius, regression_clearance) = (least, least);
        let parts =
            JudgementParts { verdict, min_bend_radius, regression_clearance, cells: 0, tried: 0, curl: Curl::NONE };
        Judged { parts, feet: Feet::default(), bounds: Vec::new(), folds: Vec::new() }
    };
    let undecided = |uv: [f64; 2], reason| blank(Verdict::Undecided { uv, reason });
    let Some(any) = triangles.first() else {
        return blank(Verdict::Holds { bound: 0.0 });
    };
    let Some(family) = Family::about(torse, &middle(prepared, triangles)) else {
        return undecided(centroid(any), Obstruction::Foot);
    };

    // Patches and feet of the centroids, in f64: each begins at its neighbour's, because a torse that comes round
    // again has several feet near the tolerance, and those of one region belong to one sheet.
    let mut roots: Vec<(usize, &Patch, f64, f64)> = Vec::with_capacity(triangles.len());
    let first = middlemost(prepared, &family, triangles, tolerance);
    for (i, parent) in walk(triangles, first) {
        let triangle = &triangles[i];
        let Some(patch) = prepared.patch_of(triangle) else {
            return undecided(centroid(triangle), Obstruction::Degenerate);
        };
        let bench = Bench::new(&family, patch, tolerance);
        let Some((t, d)) = bench.quick(triangle, parent.map(|place| roots[place].2)) else {
            return undecided(centroid(triangle), Obstruction::Foot);
        };
        roots.push((i, patch, t, d.abs()));
    }
    roots.sort_by(|a, b| b.3.total_cmp(&a.3));

    let search = Search {
        prepared,
        family: &family,
        triangles,
        tolerances,
        tolerance,
        control,
        budget: options.budget + 2 * triangles.len(),
        tried: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
        failure: Mutex::new(None),
        rim: OnceLock::new(),
        orientation: OnceLock::new(),
    };
    let examine = |r: &(usize, &Patch, f64, f64)| search.examine(r.0, r.1, r.2);
    let (worst, others) = roots.split_at(WORST_FIRST.min(roots.len()));
    let mut accepted: Vec<Accepted> = worst.iter().flat_map(examine).collect();
    if !search.stop.load(Ordering::Relaxed) {
        let rest: Vec<Vec<Accepted>> = parallel::map(others.iter(), examine);
        accepted.extend(rest.into_iter().flatten());
    }
    let tried = search.tried.load(Ordering::Relaxed);
    let failure = search.failure.into_inner().unwrap_or_else(|e| e.into_inner());
    let (feet, disagreement) = glue(&accepted);
    let verdict = failure
        .or(disagreement)
        .unwrap_or_else(|| Verdict::Holds { bound: accepted.iter().fold(0.0, |b, a| a.good.bound.max(b)) });
    let all = matches!(verdict, Verdict::Holds { .. });
    let least = |f: &dyn Fn(&Good) -> f64| {
        if all {
            accepted.iter().fold(f64::INFINITY, |m, a| m.min(f(&a.good)))
        } else {
            0.0
        }
    };
    let mut bounds = Vec::new();
    if all {
        bounds.resize(triangles.len(), 0.0f64);
        accepted.iter().for_each(|a| bounds[a.of] = bounds[a.of].max(a.good.bound));
    }
    let parts = JudgementParts {
        verdict,
        min_bend_radius: least(&|g| g.bend_radius),
        regression_clearance: least(&|g| g.clearance),
        cells: accepted.len(),
        tried,
        curl: Curl::of(&accepted),
    };
    Judged { parts, feet, bounds, folds: Curl::of_each(&accepted) }
}

/// A place in the middle of a region, about: enclosures over intervals of parameters widen with the distance from the origin.
fn middle(prepared: &Prepared, triangles: &[[[f64; 2]; 3]]) -> Vec3 {
    let of = |t: &[[f64; 2]; 3]| {
        let [u, v] = centroid(t);
        Some(Vec3::from(prepared.patch_of(t)?.quick_point(u, v)) + prepared.patch_of(t)?.centre)
    };
    let places = triangles.iter().filter_map(of).filter(|p| p.iter().all(|x| x.is_finite()));
    let mut around: Option<[Vec3; 2]> = None;
    for p in places {
        around = Some(around.map_or([p, p], |[low, high]| [low.inf(&p), high.sup(&p)]));
    }
    around.map_or_else(Vec3::zeros, |[low, high]| 0.5 * (low + high))
}

/// What the threads share.
struct Search<'a> {
    prepared: &'a Prepared<'a>,
    family: &'a Family,
    triangles: &'a [[[f64; 2]; 3]],
    /// Of each triangle, mm.
    tolerances: &'a [f64],
    /// The least of them.
    tolerance: f64,
    control: &'a Control,
    budget: usize,
    tried: AtomicUsize,
    stop: AtomicBool,
    failure: Mutex<Option<Verdict>>,
    rim: OnceLock<Rim>,
    orientation: OnceLock<i32>,
}

/// Edges and corners on the boundary of the region.
struct Rim {
    edges: HashSet<(Key, Key)>,
    corners: HashSet<Key>,
}

impl Search<'_> {
    fn fail(&self, verdict: Verdict) {
        let mut slot = self.failure.lock().unwrap_or_else(|e| e.into_inner());
        if slot.is_none() || matches!(verdict, Verdict::Fails { .. }) {
            *slot = Some(verdict);
        }
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Halves one given triangle until everything is proven, or reports the failure.
    fn examine(&self, index: usize, patch: &Patch, guess: f64) -> Vec<Accepted> {
        let tolerance = self.tolerances[index];
        let bench = Bench::new(self.family, patch, tolerance);
        let root = self.triangles[index];
        let marks = [0b001_101, 0b010_011, 0b100_110];
        let mut accepted = Vec::new();
        let mut open = vec![Cell { triangle: root, marks, depth: 0, guess }];
        let mut fallbacks: Vec<Fallback> = Vec::new();
        while let Some(cell) = open.pop() {
            // Of those all of whose halves are done nothing is needed any more.
            while fallbacks.last().is_some_and(|f| open.len() < f.open) {
                fallbacks.pop();
            }
            if self.stop.load(Ordering::Relaxed) {
                return accepted;
            }
            let uv = centroid(&cell.triangle);
            let tried = self.tried.fetch_add(1, Ordering::Relaxed);
            if tried >= self.budget || (tried % 256 == 255 && self.control.stopped()) {
                let reason = if tried >= self.budget { Obstruction::Budget } else { Obstruction::Stopped };
                self.fail(Verdict::Undecided { uv, reason });
                return accepted;
            }
            let mut found = bench.bound_cell(&cell.triangle, cell.guess, false);
            let doubtful =
                matches!(found, CellBound::Large { reason: Obstruction::Degenerate | Obstruction::Fold, .. });
            if doubtful && self.touches_rim(&root, &cell) {
                found = bench.bound_cell(&cell.triangle, cell.guess, true);
            }
            match found {
                CellBound::Good(good) if good.way > FINE_WAY * tolerance && cell.depth < DEPTH => {
                    let whole = Accepted { triangle: cell.triangle, good, of: index };
                    fallbacks.push(Fallback { whole, open: open.len(), accepted: accepted.len() });
                    open.extend(cell.halves(patch, good.feet.mid()));
                }
                CellBound::Good(good) => match fallbacks.pop() {
                    Some(f) if good.fold * self.orientation() < 0 => f.restore(&mut open, &mut accepted),
                    fallback => {
                        fallbacks.extend(fallback);
                        accepted.push(Accepted { triangle: cell.triangle, good, of: index });
                    }
                },
                CellBound::Exceeds { place, distance } => {
                    let uv = if place < 3 { cell.triangle[place] } else { uv };
                    self.fail(Verdict::Fails { uv, distance });
                    return accepted;
                }
                CellBound::Lost => {
                    self.fail(Verdict::Undecided { uv, reason: Obstruction::Foot });
                    return accepted;
                }
                CellBound::Large { reason, foot, radius } => {
                    let foot_or_fold = matches!(reason, Obstruction::Foot | Obstruction::Fold);
                    let hopeless = foot_or_fold && cell.depth >= PATIENCE && radius < HOPELESS * tolerance;
                    if hopeless || cell.depth >= DEPTH {
                        if let Some(f) = fallbacks.pop().filter(|_| foot_or_fold || reason == Obstruction::Degenerate) {
                            f.restore(&mut open, &mut accepted);
                            continue;
                        }
                        self.fail(Verdict::Undecided { uv, reason });
                        return accepted;
                    }
                    open.extend(cell.halves(patch, foot));
                }
            }
        }
        accepted
    }

    /// Orientation of the foot map on most of the region, see [`Good::fold`]; sampled. Which triangles are taken whole
    /// depends on it, what is proven about them does not.
    fn orientation(&self) -> i32 {
        const TRIANGLES_SEEN: usize = 32;
        let signed_area = |triangle: &[[f64; 2]; 3]| -> Option<f64> {
            let patch = self.prepared.patch_of(triangle)?;
            let (t, _) = Bench::new(self.family, patch, self.tolerance).quick(triangle, None)?;
            let [u, v] = centroid(triangle);
            let jet = self.prepared.surface.jet(u, v);
            let plane = self.family.quick(t);
            let across = dot(&plane.n, &exact(&jet.normal()));
            let (_, slope) = self.family.quick_foot(&exact(&(jet.p - self.family.origin)), t);
            let [a, b, c] = triangle;
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            Some(across * slope.signum() * area)
        };
        *self.orientation.get_or_init(|| {
            let step = self.triangles.len().div_ceil(TRIANGLES_SEEN).max(1);
            let sum: f64 = self.triangles.iter().step_by(step).filter_map(signed_area).sum();
            if sum < 0.0 {
                -1
            } else {
                1
            }
        })
    }

    /// Whether a corner of the cell lies on the boundary of the region.
    fn touches_rim(&self, root: &[[f64; 2]; 3], cell: &Cell) -> bool {
        let rim = self.rim.get_or_init(|| Rim::of(self.triangles));
        let mut bits = 0u8;
        for k in 0..3 {
            let (a, b) = (key(&root[k]), key(&root[(k + 1) % 3]));
            if rim.edges.contains(&(a, b)) {
                bits |= 1 << k;
            }
            if rim.corners.contains(&a) {
                bits |= 8 << k;
            }
        }
        cell.marks.iter().any(|m| m & bits != 0)
    }
}

impl Rim {
    fn of(triangles: &[[[f64; 2]; 3]]) -> Self {
        let mut edges = HashSet::default();
        for t in triangles {
            for k in 0..3 {
                let (a, b) = (key(&t[k]), key(&t[(k + 1) % 3]));
                if !edges.remove(&(b, a)) {
                    edges.insert((a, b));
                }
            }
        }
        let corners = edges.iter().flat_map(|&(a, b)| [a, b]).collect();
        Self { edges, corners }
    }
}

impl Cell {
    /// The two halves, cut at the middle of the edge that is longest in space.
    fn halves(&self, patch: &Patch, guess: f64) -> [Self; 2] {
        let t = &self.triangle;
        let points = t.map(|c| patch.quick_point(c[0], c[1]));
        let length = |i: usize, j: usize| (0..3).map(|d| (points[i][d] - points[j][d]).powi(2)).sum::<f64>();
        let lengths = [length(0, 1), length(1, 2), length(2, 0)];
        let mut k = 0;
        for i in 1..3 {
            if lengths[i] > lengths[k] {
                k = i;
            }
        }
        let (i, j, l) = (k, (k + 1) % 3, (k + 2) % 3);
        let m = [0.5 * (t[i][0] + t[j][0]), 0.5 * (t[i][1] + t[j][1])];
        let mark = self.marks[i] & self.marks[j] & 0b111;
        let depth = self.depth + 1;
        [
            Self { triangle: [t[i], m, t[l]], marks: [self.marks[i], mark, self.marks[l]], depth, guess },
            Self { triangle: [m, t[j], t[l]], marks: [mark, self.marks[j], self.marks[l]], depth, guess },
        ]
    }
}

/// Of some triangles the one whose foot is nearest to the middle of the torse's domain: should the torse come round
/// again, it does so near its ends.
fn middlemost(prepared: &Prepared, family: &Family, triangles: &[[[f64; 2]; 3]], tolerance: f64) -> usize {
    const TRIANGLES_SEEN: usize = 8;
    let (t0, t1) = family.domain();
    let off = |i: &usize| {
        let triangle = &triangles[*i];
        let foot = prepared.patch_of(triangle).and_then(|p| Bench::new(family, p, tolerance).quick(triangle, None));
        foot.map_or(f64::INFINITY, |(t, _)| (t - 0.5 * (t0 + t1)).abs())
    };
    let step = triangles.len().div_ceil(TRIANGLES_SEEN).max(1);
    (0..triangles.len()).step_by(step).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// All triangles in an order in which they follow neighbours (triangles with a common corner) from the `first` on, each
/// with the place of that neighbour in the order.
fn walk(triangles: &[[[f64; 2]; 3]], first: usize) -> Vec<(usize, Option<usize>)> {
    let mut numbers: HashMap<Key, usize> = HashMap::with_capacity_and_hasher(triangles.len(), Default::default());
    let mut at_corner: Vec<Vec<usize>> = Vec::with_capacity(triangles.len());
    let mut corners: Vec<[usize; 3]> = Vec::with_capacity(triangles.len());
    for (i, t) in triangles.iter().enumerate() {
        corners.push([0, 1, 2].map(|k| {
            let number = *numbers.entry(key(&t[k])).or_insert(at_corner.len());
            if number == at_corner.len() {
                at_corner.push(Vec::new());
            }
            at_corner[number].push(i);
            number
        }));
    }
    let mut seen = vec![false; triangles.len()];
    let mut order: Vec<(usize, Option<usize>)> = Vec::with_capacity(triangles.len());
    let mut next = 0;
    for start in std::iter::once(first).chain(0..triangles.len()) {
        if !seen[start] {
            seen[start] = true;
            order.push((start, order.len().checked_sub(1)));
        }
        while let Some(&(i, _)) = order.get(next) {
            for number in corners[i] {
                for j in std::mem::take(&mut at_corner[number]) {
                    if !seen[j] {
                        seen[j] = true;
                        order.push((j, Some(next)));
                    }
                }
            }
            next += 1;
        }
    }
    order
}

/// Middle of a triangle.
fn centroid(t: &[[f64; 2]; 3]) -> [f64; 2] {
    [(t[0][0] + t[1][0] + t[2][0]) / 3.0, (t[0][1] + t[1][1] + t[2][1]) / 3.0]
}

/// Gluing: foot intervals of triangles with a common corner must meet, and all must have the same orientation.
fn glue(accepted: &[Accepted]) -> (Feet, Option<Verdict>) {
    let mut common = Feet::with_capacity_and_hasher(accepted.len(), Default::default());
    let mut sign = 0;
    let mut verdict = None;
    for a in accepted {
        let undecided = |reason| Some(Verdict::Undecided { uv: centroid(&a.triangle), reason });
        if a.good.fold * sign < 0 {
            verdict = undecided(Obstruction::Fold);
        }
        if a.good.fold != 0 {
            sign = a.good.fold;
        }
        for c in &a.triangle {
            let slot = common.entry(key(c)).or_insert((f64::NEG_INFINITY, f64::INFINITY));
            slot.0 = slot.0.max(a.good.feet.lo);
            slot.1 = slot.1.min(a.good.feet.hi);
            if slot.0 > slot.1 {
                verdict = undecided(Obstruction::Foot);
            }
        }
    }
    (common, verdict)
}

#[cfg(test)]
mod tests;
