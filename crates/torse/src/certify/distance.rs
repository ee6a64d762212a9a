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
//! triangle with a corner on the rim. A point whose foot is also the foot of a point of B is at most `|d|` from that
//! foot; the foot is at most the diameter of B's feet from the foot of the rim corner, that is at most diam S(B) +
//! variation of d + |d| · variation of N. This is added to the bound. All other points have positive degree as in part
//! (c) of the theorem.

use super::cell::{Bench, Good, Look};
use super::family::Family;
use super::prepared::{Patch, Prepared};
use super::{Resistance, Verdict};
use crate::control::Control;
use crate::surface::torse::Torse;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

/// Effort allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistanceOptions {
    /// Looks at triangles beyond two per triangle given; default 20 000.
    pub budget: usize,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { budget: 20_000 }
    }
}

/// What was found about a region and a torse.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Whether the distance is proven to stay below the tolerance.
    pub verdict: Verdict,
    /// Lower bound of the radius of curvature of the torse over the region, mm; infinite for planes.
    pub min_bend_radius: f64,
    /// Lower bound of the distance along rulings to the regression curve, mm; infinite for cylinders.
    pub regression_clearance: f64,
    /// Triangles accepted.
    pub cells: usize,
    /// Looks at triangles.
    pub looks: usize,
}

/// Halvings of a given triangle at most; corners stay exact enough for that many.
const DEPTH: usize = 40;

/// A triangle smaller than this share of the tolerance in space that still has no regular foot never will.
const HOPELESS: f64 = 0.02;

/// A given triangle is halved at least this often before it counts as hopeless.
const PATIENCE: usize = 6;

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

/// An accepted triangle.
struct Accepted {
    triangle: [[f64; 2]; 3],
    good: Good,
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
    judge(prepared, torse, triangles, tolerance, options, control).0
}

/// Foot intervals proven at the corners of triangles.
pub(super) type Feet = HashMap<Key, (f64, f64)>;

/// As [`distance`], with the feet at the corners.
pub(super) fn judge(
    prepared: &Prepared,
    torse: &Torse,
    triangles: &[[[f64; 2]; 3]],
    tolerance: f64,
    options: &DistanceOptions,
    control: &Control,
) -> (Judgement, Feet) {
    let blank = |verdict| {
        let (min_bend_radius, regression_clearance) = (f64::INFINITY, f64::INFINITY);
        (Judgement { verdict, min_bend_radius, regression_clearance, cells: 0, looks: 0 }, Feet::new())
    };
    let undecided = |uv: [f64; 2], reason| blank(Verdict::Undecided { uv, reason });
    let Some(any) = triangles.first() else {
        return blank(Verdict::Holds { bound: 0.0 });
    };
    let Some(family) = Family::new(torse) else {
        return undecided(centroid(any), Resistance::Foot);
    };

    // Patches and feet of the centroids, in f64: each begins at its neighbour's, because a torse that comes round
    // again has several feet near the tolerance, and those of one region belong to one sheet.
    let mut roots: Vec<(usize, &Patch, f64, f64)> = Vec::with_capacity(triangles.len());
    let first = middlemost(prepared, &family, triangles, tolerance);
    for (i, parent) in walk(triangles, first) {
        let triangle = &triangles[i];
        let Some(patch) = prepared.patch_of(triangle) else {
            return undecided(centroid(triangle), Resistance::Degenerate);
        };
        let bench = Bench::new(&family, patch, tolerance);
        let Some((t, d)) = bench.quick(triangle, parent.map(|place| roots[place].2)) else {
            return undecided(centroid(triangle), Resistance::Foot);
        };
        roots.push((i, patch, t, d.abs()));
    }
    roots.sort_by(|a, b| b.3.total_cmp(&a.3));

    let search = Search {
        family: &family,
        triangles,
        tolerance,
        control,
        budget: options.budget + 2 * triangles.len(),
        looks: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
        failure: Mutex::new(None),
        rim: OnceLock::new(),
    };
    let examine = |r: &(usize, &Patch, f64, f64)| search.examine(r.0, r.1, r.2);
    let (worst, others) = roots.split_at(WORST_FIRST.min(roots.len()));
    let mut accepted: Vec<Accepted> = worst.iter().flat_map(examine).collect();
    if !search.stop.load(Ordering::Relaxed) {
        let rest: Vec<Vec<Accepted>> = others.par_iter().map(examine).collect();
        accepted.extend(rest.into_iter().flatten());
    }
    let looks = search.looks.load(Ordering::Relaxed);
    let failure = search.failure.into_inner().unwrap_or_else(|e| e.into_inner());
    let (feet, disagreement) = glue(&accepted);
    let verdict = failure
        .or(disagreement)
        .unwrap_or_else(|| Verdict::Holds { bound: accepted.iter().fold(0.0, |b, a| a.good.bound.max(b)) });
    let least = |f: &dyn Fn(&Good) -> f64| accepted.iter().fold(f64::INFINITY, |m, a| m.min(f(&a.good)));
    let judgement = Judgement {
        verdict,
        min_bend_radius: least(&|g| g.bend_radius),
        regression_clearance: least(&|g| g.clearance),
        cells: accepted.len(),
        looks,
    };
    (judgement, feet)
}

/// What the threads share.
struct Search<'a> {
    family: &'a Family,
    triangles: &'a [[[f64; 2]; 3]],
    tolerance: f64,
    control: &'a Control,
    budget: usize,
    looks: AtomicUsize,
    stop: AtomicBool,
    failure: Mutex<Option<Verdict>>,
    rim: OnceLock<Rim>,
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
        let bench = Bench::new(self.family, patch, self.tolerance);
        let root = self.triangles[index];
        let marks = [0b001_101, 0b010_011, 0b100_110];
        let mut accepted = Vec::new();
        let mut open = vec![Cell { triangle: root, marks, depth: 0, guess }];
        while let Some(cell) = open.pop() {
            if self.stop.load(Ordering::Relaxed) {
                return accepted;
            }
            let uv = centroid(&cell.triangle);
            let looks = self.looks.fetch_add(1, Ordering::Relaxed);
            if looks >= self.budget || (looks % 256 == 255 && self.control.stopped()) {
                let reason = if looks >= self.budget { Resistance::Budget } else { Resistance::Stopped };
                self.fail(Verdict::Undecided { uv, reason });
                return accepted;
            }
            let mut look = bench.look(&cell.triangle, cell.guess, false);
            let doubtful = matches!(look, Look::Large { reason: Resistance::Degenerate | Resistance::Fold, .. });
            if doubtful && self.touches_rim(&root, &cell) {
                look = bench.look(&cell.triangle, cell.guess, true);
            }
            match look {
                Look::Good(good) => accepted.push(Accepted { triangle: cell.triangle, good }),
                Look::Exceeds { place, distance } => {
                    let uv = if place < 3 { cell.triangle[place] } else { uv };
                    self.fail(Verdict::Fails { uv, distance });
                    return accepted;
                }
                Look::Lost => {
                    self.fail(Verdict::Undecided { uv, reason: Resistance::Foot });
                    return accepted;
                }
                Look::Large { reason, foot, radius } => {
                    let foot_or_fold = matches!(reason, Resistance::Foot | Resistance::Fold);
                    let hopeless = foot_or_fold && cell.depth >= PATIENCE && radius < HOPELESS * self.tolerance;
                    if hopeless || cell.depth >= DEPTH {
                        self.fail(Verdict::Undecided { uv, reason });
                        return accepted;
                    }
                    open.extend(cell.halves(patch, foot));
                }
            }
        }
        accepted
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
        let mut edges = HashSet::new();
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
    const SOME: usize = 8;
    let (t0, t1) = family.domain();
    let off = |i: &usize| {
        let triangle = &triangles[*i];
        let foot = prepared.patch_of(triangle).and_then(|p| Bench::new(family, p, tolerance).quick(triangle, None));
        foot.map_or(f64::INFINITY, |(t, _)| (t - 0.5 * (t0 + t1)).abs())
    };
    let step = triangles.len().div_ceil(SOME).max(1);
    (0..triangles.len()).step_by(step).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// All triangles in an order in which they follow neighbours (triangles with a common corner) from the `first` on, each
/// with the place of that neighbour in the order.
fn walk(triangles: &[[[f64; 2]; 3]], first: usize) -> Vec<(usize, Option<usize>)> {
    let mut numbers: HashMap<Key, usize> = HashMap::with_capacity(triangles.len());
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
    let mut common = Feet::with_capacity(accepted.len());
    let mut sign = 0;
    let mut verdict = None;
    for a in accepted {
        let undecided = |reason| Some(Verdict::Undecided { uv: centroid(&a.triangle), reason });
        if a.good.fold * sign < 0 {
            verdict = undecided(Resistance::Fold);
        }
        if a.good.fold != 0 {
            sign = a.good.fold;
        }
        for c in &a.triangle {
            let slot = common.entry(key(c)).or_insert((f64::NEG_INFINITY, f64::INFINITY));
            slot.0 = slot.0.max(a.good.feet.lo);
            slot.1 = slot.1.min(a.good.feet.hi);
            if slot.0 > slot.1 {
                verdict = undecided(Resistance::Foot);
            }
        }
    }
    (common, verdict)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::*;
    use crate::geom::Vec3;
    use crate::spline::surface::Surface;

    fn judged(s: &Surface, torse: &Torse, triangles: &[[[f64; 2]; 3]], tolerance: f64) -> Judgement {
        distance(&Prepared::new(s), torse, triangles, tolerance, &DistanceOptions::default(), &Control::default())
    }

    fn moved(s: &Surface, f: &dyn Fn(Vec3) -> Vec3) -> Surface {
        let mut out = s.clone();
        for c in &mut out.control {
            let p = f(Vec3::new(c[0], c[1], c[2]) / c[3]) * c[3];
            *c = [p.x, p.y, p.z, c[3]];
        }
        out
    }

    /// Certified at 3 % above the sampled supremum, refuted at 3 % below; the bound is never below the samples.
    fn tight(s: &Surface, torse: &Torse, triangles: &[[[f64; 2]; 3]]) -> f64 {
        let sup = brute_sup(s, torse, triangles, 6);
        let yes = judged(s, torse, triangles, sup * 1.03);
        let Verdict::Holds { bound } = yes.verdict else { panic!("{yes:?}, sampled {sup}") };
        assert!(bound >= sup * (1.0 - 1e-12) && bound <= sup * 1.03, "{bound} {sup}");
        let no = judged(s, torse, triangles, sup * 0.97);
        let Verdict::Fails { uv, distance } = no.verdict else { panic!("{no:?}, sampled {sup}") };
        assert!(distance.abs() > sup * 0.97);
        let there = brute_distance(torse, &s.point(uv[0], uv[1]));
        assert!((there - distance.abs()).abs() < 1e-3 * sup, "{there} {distance}");
        sup
    }

    #[test]
    fn torses_over_a_profile_with_an_inflection() {
        let s = near_primal(1e-3);
        let sup = tight(&s, &Torse::Primal(primal()), &grid(&s, 3, 3));
        assert!(sup > 5e-4 && sup < 1e-3);
    }

    #[test]
    fn envelopes_near_a_rational_sphere() {
        let s = sphere_strip(0.05);
        let sup = tight(&s, &Torse::Dual(dual()), &grid(&s, 4, 4));
        // Tangent strip of half-width w = 5 · .05: w²/(2 R) in the first order.
        assert!((sup - 0.25f64.powi(2) / 10.0).abs() < 2e-4, "{sup}");
    }

    #[test]
    fn a_torse_that_comes_round_again_has_one_sheet_over_a_pipe() {
        use crate::spline::knots::Knots;
        use crate::surface::torse::DualTorse;
        use std::f64::consts::TAU;
        // A pipe of a full turn; the torse goes on by a fifth of a turn at both ends, so that points near the slit have
        // feet on both of its ends. The region's triangles come in no order.
        let around = Knots::uniform(3, 24, 0.0, TAU).expect("knots");
        let along = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let s = interpolant(&around, &along, &|u, v| Vec3::new(5.0 * u.cos(), 5.0 * u.sin(), v));
        let longer = Knots::uniform(3, 34, -0.2 * TAU, 1.2 * TAU).expect("knots");
        let torse = Torse::Dual(DualTorse { planes: curve(&longer, &|t| [t.cos(), t.sin(), 0.0, 5.0]) });
        let triangles = grid(&s, 1, 2);
        let n = triangles.len();
        let shuffled: Vec<_> = (0..n).map(|i| triangles[(i * 37) % n]).collect();
        assert!(!n.is_multiple_of(37), "all triangles");
        let j = judged(&s, &torse, &shuffled, 1e-2);
        assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    }

    #[test]
    fn creases_holes_and_reflex_corners() {
        use crate::spline::knots::Knots;
        // A C⁰ knot line with a crease, and a region with a hole and a notch.
        let k = Knots::clamped(3, &[0.0, 0.5, 0.5, 0.5, 1.0]).expect("knots");
        let z = tilted_frame().z;
        let s = interpolant(&k, &k, &|u, v| {
            primal_point(1.3 * u, 0.8 * v - 0.4) + z * (2e-3 * (u - 0.5).abs() + 1e-3 * (5.0 * v + u).sin())
        });
        let middle = |t: &[[f64; 2]; 3]| centroid(t);
        let region: Vec<_> = grid(&s, 4, 4)
            .into_iter()
            .filter(|t| {
                let [u, v] = middle(t);
                let hole = (0.25..0.625).contains(&u) && (0.25..0.5).contains(&v);
                let notch = u > 0.75 && v > 0.625;
                !hole && !notch
            })
            .collect();
        assert!(region.len() < 120);
        tight(&s, &Torse::Primal(primal()), &region);
    }

    #[test]
    fn perturbed_surfaces_are_refused_with_a_witness() {
        let s = near_primal(1e-3);
        let torse = Torse::Primal(primal());
        let triangles = grid(&s, 3, 3);
        let tolerance = 1.02e-3;
        assert!(matches!(judged(&s, &torse, &triangles, tolerance).verdict, Verdict::Holds { .. }));
        let (frame, middle) = (tilted_frame(), primal_point(0.6, 0.0));
        let r = torse.ruling(0.6);
        let turned = |angle: f64| {
            move |p: Vec3| {
                let q = p - middle;
                let e = r.direction;
                middle + q * angle.cos() + e.cross(&q) * angle.sin() + e * (e.dot(&q) * (1.0 - angle.cos()))
            }
        };
        let cases: Vec<(&str, Surface)> = vec![
            ("shift by two tolerances", moved(&s, &|p| p + frame.z * (2.0 * tolerance))),
            ("shift by .3 tolerances", moved(&s, &|p| p + frame.z * (0.3 * tolerance))),
            ("rotation about a ruling", moved(&s, &turned(0.02))),
            ("tilt along the ruling", moved(&s, &|p| p + r.normal * (0.03 * (p - middle).dot(&r.direction)))),
            ("one control point", {
                let mut out = s.clone();
                out.control[14][2] += 6.0 * tolerance;
                out
            }),
        ];
        for (name, surface) in cases {
            let j = judged(&surface, &torse, &triangles, tolerance);
            let Verdict::Fails { uv, distance } = j.verdict else { panic!("{name}: {j:?}") };
            assert!(distance.abs() > tolerance);
            assert!(brute_distance(&torse, &surface.point(uv[0], uv[1])) > tolerance * (1.0 - 1e-9), "{name}");
        }
    }

    #[test]
    fn a_spike_between_samples_is_found() {
        // A knot interval of width .002 with a spike of 1.2 tolerances in it, over a plane region.
        use crate::spline::knots::Knots;
        let k = Knots::clamped(3, &[0.0, 0.4, 0.4005, 0.401, 0.4015, 0.402, 1.0]).expect("knots");
        let q = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let mut s = interpolant(&k, &q, &|u, v| primal_point(1.3 * u, 0.8 * v - 0.4));
        let z = tilted_frame().z * 1.8e-3;
        let row = s.row();
        for c in &mut s.control[4 * row..5 * row] {
            *c = [c[0] + z.x, c[1] + z.y, c[2] + z.z, 1.0];
        }
        let triangles = grid(&s, 1, 1);
        let j = judged(&s, &Torse::Primal(primal()), &triangles, 1e-3);
        assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    }

    #[test]
    fn feet_outside_the_torse_are_not_accepted() {
        let s = near_primal(1e-3);
        let mut p = primal();
        p.profile =
            curve(&crate::spline::knots::Knots::clamped(3, &[-0.3, 1.0]).expect("knots"), &|t| p.profile.point(t));
        let j = judged(&s, &Torse::Primal(p), &grid(&s, 3, 3), 1.0);
        assert!(matches!(j.verdict, Verdict::Undecided { reason: Resistance::Foot, .. }), "{j:?}");
    }

    #[test]
    fn scaling_by_a_power_of_two_scales_the_bound() {
        let s = near_primal(1e-3);
        let (p, factor) = (primal(), 1024.0);
        let mut q = p.clone();
        q.frame.origin *= factor;
        let values = p.profile.knots.values().iter().map(|t| t * factor).collect();
        let control = p.profile.control.iter().map(|c| [c[0] * factor, c[1]]).collect();
        q.profile = crate::spline::curve::Curve::new(3, values, control).expect("profile");
        // f and t grow by the factor; a, g = beta + ∫ f' da and the slopes stay.
        let big = moved(&s, &|x| x * factor);
        let triangles = grid(&s, 3, 3);
        let a = judged(&s, &Torse::Primal(p), &triangles, 1.02e-3);
        let b = judged(&big, &Torse::Primal(q), &triangles, 1.02e-3 * factor);
        let (Verdict::Holds { bound: a }, Verdict::Holds { bound: b }) = (&a.verdict, &b.verdict) else {
            panic!("{a:?} {b:?}")
        };
        assert!((a * factor - b).abs() < 1e-9 * b);
    }

    /// A corner turned over in a space far smaller than the tolerance does not spoil the proof; where the tolerance is
    /// as small as the corner, it does.
    #[test]
    fn a_tiny_curl_at_the_rim_is_certified_within_the_tolerance() {
        use crate::spline::knots::Knots;
        let k = Knots::clamped(3, &[0.0, 1e-3, 2e-3, 0.3, 1.0]).expect("knots");
        let mut s = interpolant(&k, &k, &|u, v| primal_point(1.3 * u, 0.8 * v - 0.4));
        // The corner lies beyond its neighbours.
        let (corner, beside) = (s.control[0], s.control[2 * k.control_count()]);
        for d in 0..3 {
            s.control[0][d] = corner[d] + 3.0 * (beside[d] - corner[d]);
        }
        let torse = Torse::Primal(primal());
        let triangles = grid(&s, 2, 2);
        let normal = |u: f64| s.jet(u, 1e-9).normal();
        assert!(normal(1e-9).dot(&normal(0.5)) < 0.0, "the corner is not turned over");
        let j = judged(&s, &torse, &triangles, 0.05);
        let Verdict::Holds { bound } = j.verdict else { panic!("{j:?}") };
        assert!(bound >= brute_sup(&s, &torse, &triangles, 6) && bound <= 0.05, "{bound}");
        let j = judged(&s, &torse, &triangles, 5e-4);
        assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    }

    #[test]
    fn a_pole_at_the_rim_is_certified_and_a_fold_is_not() {
        use crate::spline::knots::Knots;
        let k = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        // A fan over the primal torse: all of u = 0 is one point.
        let fan = interpolant(&k, &k, &|u, v| primal_point(0.2 + 0.8 * u, 0.5 * u * (v - 0.5)));
        let triangles = grid(&fan, 4, 4);
        let torse = Torse::Primal(primal());
        let sup = brute_sup(&fan, &torse, &triangles, 6);
        let j = judged(&fan, &torse, &triangles, 1e-4 + sup);
        assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
        // The same with the parametrisation folded back: distances are small, but the region doubles.
        let folded = interpolant(&k, &k, &|u, v| primal_point(0.2 + 0.8 * u, 0.5 * (v - 0.4).powi(2)));
        let triangles = grid(&folded, 4, 4);
        let j = judged(&folded, &torse, &triangles, 1e-2);
        assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    }
}
