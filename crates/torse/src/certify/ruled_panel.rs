//! The proof for a ruled panel that need not be developable: two-sided distance through a map between parameter planes.
//!
//! Let T be the region of the patch R inside its trimming loops θ, Ω the region of the face S with the border polygon ∂Ω,
//! and φ the panel's map from T to the parameter plane of S. Shown are
//!
//! - D: `|S(φ(y)) − R(y)| ≤ D` for all y of T;
//! - δ: for the point p of every side of ∂Ω and the point θ of the loop that goes with it, every point q of the segment
//!   from p to φ(θ) has `|S(q) − S(p)| ≤ δ` and `|S(q) − S(φ(θ))| ≤ δ`;
//! - the determinant of φ' has one sign on T, the loops θ are simple, and they run about T in the sense of that sign.
//!
//! *Theorem*. Trimmed panel and face are within D + δ of each other, both ways. *Proof*: off the segments, φ∘θ and ∂Ω
//! have equal winding numbers, which for φ∘θ is the number of places of T that lie over a point (degree theory). A point q
//! of Ω on a segment is within δ of S(φ(θ)), and so within D + δ of R(θ); any other has the winding number 1, so that it
//! is φ(y) for some y of T, within D. Conversely, if φ(y) is on a segment, S(φ(y)) is within δ of the face's border; if
//! not, its winding number is at least 1, so it lies in Ω. φ may leave the domain of S by δ, where its pieces go on.
//!
//! *Enclosure*: D by a Taylor polynomial of degree 2 about the middle of cells, with an interval rest \[MKC09\]; cells are
//! halved until they exceed the greatest distance seen by little. Cells that no trimming curve enters are in T or not by
//! the winding number of their middle. δ by the ends and the second derivative of `φ(θ) − p`. Loops, edges in space and
//! rounding are as for developable panels \[certificate\].

use super::boundary::trim_piece;
use super::certificate::PanelParts;
use super::gap::{Bounded, Gap};
use super::panel::{edges, loop_faults, Ground};
use super::polygon::winding;
use super::ruled::{Ruled, RuledJets};
use super::tensor::{about, Tensor};
use super::vector::length;
use super::written::reserve;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::parallel;
use crate::patchwork::foot_map::FootMap;
use crate::patchwork::panel::{Coedge, Panel, PanelTrim};
use crate::reason::{LoopFault, PanelFault, Reason};
use crate::spline::curve::Curve;

/// Cells may exceed the greatest distance seen by this share of it, or by this share of the tolerance.
const EXCESS: (f64, f64) = (0.03, 0.01);
/// Cells looked at, at most: then what is known of them is the bound.
const MOST_CELLS: usize = 40_000;
/// Cells this many times smaller than the patch are not halved for their distance: where a border runs through them, what
/// is seen inside it may be less than what they hold.
const FINE: f64 = 512.0;
/// Halvings of a cell at most.
const DEPTH: usize = 40;
/// Halvings of a stretch of the border at most.
const BORDER_DEPTH: usize = 14;
/// Widening of boxes around trimming curves, share of their extent: above the rounding of their ends.
const ROUNDING: f64 = 1e-12;

/// Everything proven about a ruled panel, and its patch ready for the seams.
pub(super) fn ruled_panel(
    panel: &Panel,
    (trim, map): (&PanelTrim, &FootMap),
    ground: &Ground,
    tolerance: f64,
    control: &Control,
) -> (PanelParts, Option<RuledJets>) {
    let mut out = PanelParts { developable: false, ..PanelParts::blank() };
    let Some(ruled) = Ruled::new(&panel.strip.patch) else {
        out.reason = Some(PanelFault::NotRuled.into());
        return (out, None);
    };
    let whole = map.control.len() == map.knots_s.control_count() * map.knots_t.control_count();
    if !(whole && map.control.iter().flatten().all(|x| x.is_finite())) {
        out.reason = Some(PanelFault::NoMap.into());
        return (out, None);
    }
    let origin = ruled.middle(ruled.breaks()[0]);
    let jets = RuledJets::new(&ruled, &origin);
    let mut reasons = Vec::new();
    let judge = Judge::new(panel, trim, map, ground, origin, tolerance);
    reasons.extend(loop_faults(trim, &panel.strip.patch, jets.domain()));
    match judge.border() {
        Ok(bound) => out.boundary_bound = bound,
        Err(fault) => reasons.push(fault),
    }
    match edges(panel, &jets, tolerance) {
        Ok(bound) => out.edge_bound = bound,
        Err(at) => reasons.push(PanelFault::Edge(at)),
    }
    out.rounding_bound = reserve(&panel.strip.patch);
    // Without a sound border the distance shows nothing.
    if reasons.is_empty() {
        match judge.distance(control) {
            Ok(found) => {
                (out.distance_bound, out.cells) = (found.bound, found.cells);
                out.witness = Some(found.farthest);
            }
            Err(fault) => reasons.push(fault),
        }
    }
    if reasons.is_empty() {
        let parts = [out.distance_bound, out.boundary_bound, out.edge_bound, out.rounding_bound, ground.moved];
        let sum = parts.iter().fold(Interval::ZERO, |s, x| s + Interval::point(*x)).hi;
        // What is no number is no bound.
        out.deviation_bound = if sum >= 0.0 { sum } else { f64::INFINITY };
        out.certified = out.deviation_bound <= tolerance;
        let witness = out.witness.take().filter(|_| !out.certified);
        if let Some((uv, _)) = witness {
            let place = ground.prepared.surface.point(uv[0], uv[1]);
            reasons.push(PanelFault::Only(out.deviation_bound, place));
        }
        out.witness = witness.filter(|w| w.1 > tolerance);
    }
    out.reason = Reason::all(reasons.into_iter().map(Reason::from).collect());
    (out, Some(jets))
}

/// What is compared.
struct Judge<'a> {
    patch: Tensor<'a, 4>,
    map: Tensor<'a, 2>,
    face: Tensor<'a, 4>,
    trim: &'a PanelTrim,
    ground: &'a Ground<'a>,
    tolerance: f64,
    /// Boxes around the trimming curves, and the polygon of their ends, loop by loop.
    boxes: Vec<[Interval; 2]>,
    polygons: Vec<Vec<[f64; 2]>>,
}

/// A part of the patch's parameter plane.
#[derive(Clone, Copy)]
struct Cell {
    box_: [Interval; 2],
    depth: usize,
}

/// D, and what was seen on the way.
struct Distance {
    bound: f64,
    cells: usize,
    /// Place on the face that is farthest of those looked at, and its distance.
    farthest: ([f64; 2], f64),
}

/// What is known of a cell.
struct BoundedCell {
    /// Bound of the distance.
    bound: f64,
    /// Distance in the middle, from below.
    seen: f64,
    /// Sign of the determinant; 0 if it is not shown.
    sign: i32,
    /// How much of the bound comes from either direction.
    share: [f64; 2],
}

impl<'a> Judge<'a> {
    fn new(
        panel: &'a Panel,
        trim: &'a PanelTrim,
        map: &'a FootMap,
        ground: &'a Ground<'a>,
        origin: [f64; 3],
        tolerance: f64,
    ) -> Self {
        let surface = ground.prepared.surface;
        let patch = &panel.strip.patch;
        let boxes: Vec<[Interval; 2]> = trim.loops.iter().flatten().flat_map(|r| boxes(&r.trim)).collect();
        let wide = |d: usize| boxes.iter().fold(0.0f64, |m, b| m.max(b[d].mag()));
        let pad = [ROUNDING * wide(0), ROUNDING * wide(1)];
        let boxes = boxes.iter().map(|b| [b[0].widen(pad[0]), b[1].widen(pad[1])]).collect();
        let polygons = trim.loops.iter().map(|l| l.iter().flat_map(|r| ends(&r.trim)).collect()).collect();
        Self {
            patch: Tensor::new([&patch.knots_u, &patch.knots_v], about(&patch.control, origin)),
            map: Tensor::new([&map.knots_s, &map.knots_t], map.control.iter().map(|c| c.map(Interval::point))),
            face: Tensor::new([&surface.knots_u, &surface.knots_v], about(&surface.control, origin)),
            trim,
            ground,
            tolerance,
            boxes,
            polygons,
        }
    }

    /// D: sharp, unless cells become too many or a control says stop; a bound in any case.
    fn distance(&self, control: &Control) -> Result<Distance, PanelFault> {
        let mut open = self.cells();
        let fine = [0, 1].map(|d: usize| {
            let breaks = self.patch.breaks()[d];
            (breaks[breaks.len() - 1] - breaks[0]) / FINE
        });
        let mut out = Distance { bound: 0.0, cells: 0, farthest: self.farthest_on_border() };
        let mut sign = 0;
        while !open.is_empty() {
            out.cells += open.len();
            let last = out.cells >= MOST_CELLS || control.stopped();
            let seen: Vec<(Cell, Option<BoundedCell>)> =
                parallel::map(open.iter(), |c| (*c, self.used(&c.box_).then(|| self.bound_cell(&c.box_))));
            for (cell, bounded) in &seen {
                if let Some(bounded) = bounded.as_ref().filter(|l| l.seen > out.farthest.1) {
                    out.farthest = (self.image(middle(&cell.box_)), bounded.seen);
                }
            }
            let goal = out.farthest.1 * (1.0 + EXCESS.0) + EXCESS.1 * self.tolerance;
            open = Vec::new();
            for (cell, bounded) in seen {
                let Some(bounded) = bounded else { continue };
                let small = (0..2).all(|d| cell.box_[d].width() <= fine[d]);
                if bounded.sign != 0 && (bounded.bound <= goal || small || last) {
                    if sign != 0 && sign != bounded.sign {
                        return Err(PanelFault::Folds(self.place(&cell)));
                    }
                    sign = bounded.sign;
                    out.bound = out.bound.max(bounded.bound);
                } else if last || cell.depth == DEPTH {
                    return Err(PanelFault::MayFold(self.place(&cell)));
                } else {
                    open.extend(self.halves(&cell, &bounded));
                }
            }
        }
        let area: f64 = self.polygons.first().map_or(0.0, |p| signed_area(p));
        if (area > 0.0) != (sign > 0) || sign == 0 {
            return Err(PanelFault::WrongSide);
        }
        Ok(out)
    }

    /// The place on the face that goes with the middle of a cell, about.
    fn place(&self, cell: &Cell) -> Vec3 {
        let [u, v] = self.image([cell.box_[0].mid(), cell.box_[1].mid()]);
        self.ground.prepared.surface.point(u, v)
    }

    /// Parameters on the face, about.
    fn image(&self, at: [f64; 2]) -> [f64; 2] {
        self.map.at(at.map(Interval::point)).p.map(|x| x.mid())
    }

    /// The farthest of the places on the trimming curves that are looked at, on the face.
    fn farthest_on_border(&self) -> ([f64; 2], f64) {
        let mut farthest = ([0.0; 2], 0.0);
        for &at in self.polygons.iter().flatten() {
            let place = at.map(Interval::point);
            let (map, patch) = (self.map.at(place), self.patch.at(place).affine());
            let far = length(&Gap::of(&self.face.at(map.p).affine(), &map, &patch).value).lo;
            if far > farthest.1 {
                farthest = (self.image(at), far);
            }
        }
        farthest
    }

    /// Cells between the knots of patch and map.
    fn cells(&self) -> Vec<Cell> {
        let lines = |d: usize| {
            let (a, b) = (self.patch.breaks()[d], self.map.breaks()[d]);
            super::ruled::common_breaks(a, b, a[0], a[a.len() - 1])
        };
        let (s, t) = (lines(0), lines(1));
        let cells = s.windows(2).flat_map(|s| t.windows(2).map(move |t| (s, t)));
        cells.map(|(s, t)| Cell { box_: [Interval::new(s[0], s[1]), Interval::new(t[0], t[1])], depth: 0 }).collect()
    }

    /// Whether a cell may hold points of T.
    fn used(&self, cell: &[Interval; 2]) -> bool {
        let meets = |b: &[Interval; 2]| (0..2).all(|d| b[d].lo <= cell[d].hi && b[d].hi >= cell[d].lo);
        self.boxes.iter().any(meets) || {
            let m = middle(cell);
            self.polygons.iter().map(|p| winding(p, m)).sum::<i32>() != 0
        }
    }

    fn bound_cell(&self, cell: &[Interval; 2]) -> BoundedCell {
        let map = self.map.over(*cell);
        let face = self.face.over(map.p).affine();
        let patch = self.patch.over(*cell).affine();
        let gap = Gap::of(&face, &map, &patch);
        let m = middle(cell).map(Interval::point);
        let (map_m, patch_m) = (self.map.at(m), self.patch.at(m).affine());
        let at = Gap::of(&self.face.at(map_m.p).affine(), &map_m, &patch_m);
        let (x, y) = (cell[0] - m[0], cell[1] - m[1]);
        let Bounded { bound, share } = gap.bounded(&at, [x, y], self.face.creased(map.p));
        let det = map.du[0] * map.dv[1] - map.du[1] * map.dv[0];
        // Beyond the trim the distance does not matter.
        let inside = self.polygons.iter().map(|p| winding(p, middle(cell))).sum::<i32>() != 0;
        let seen = if inside { length(&at.value).lo } else { 0.0 };
        // What is no number is no bound.
        let bound = if bound >= 0.0 { bound } else { f64::INFINITY };
        BoundedCell { bound, seen, sign: det.sign(), share }
    }

    fn halves(&self, cell: &Cell, bounded: &BoundedCell) -> [Cell; 2] {
        let d = usize::from(bounded.share[1] > bounded.share[0]);
        let m = cell.box_[d].mid();
        [0, 1].map(|k: usize| {
            let mut box_ = cell.box_;
            box_[d] = if k == 0 { Interval { hi: m, ..box_[d] } } else { Interval { lo: m, ..box_[d] } };
            Cell { box_, depth: cell.depth + 1 }
        })
    }

    /// δ: the greatest over all runs.
    fn border(&self) -> Result<f64, PanelFault> {
        let runs: Vec<&Coedge> = self.trim.loops.iter().flatten().collect();
        let found: Result<Vec<f64>, PanelFault> = parallel::map(runs.iter(), |r| self.run(r)).into_iter().collect();
        Ok(found?.into_iter().fold(0.0, f64::max))
    }

    fn run(&self, run: &Coedge) -> Result<f64, PanelFault> {
        let place = |i: usize| {
            let v = run.vertices.get(i).and_then(|&v| self.ground.partition.vertices.get(v as usize));
            v.copied().ok_or(PanelFault::Trim(LoopFault::NoVertex))
        };
        let on_face = |uv: [f64; 2]| self.ground.prepared.surface.point(uv[0], uv[1]);
        if !super::boundary::well_formed(run) {
            return Err(place(0).map_or_else(|fault| fault, |uv| PanelFault::TrimAt(LoopFault::Malformed, on_face(uv))));
        }
        let knots = run.trim.knots.breaks();
        let mut bound = 0.0f64;
        for k in 0..run.vertices.len() - 1 {
            let side = [place(k)?, place(k + 1)?];
            let (s0, s1) = (run.parameters[k], run.parameters[k + 1]);
            let mut cuts = vec![(0.0, s0)];
            let inner = knots.iter().filter(|&&t| t > s0 && t < s1);
            cuts.extend(inner.map(|&t| (((t - s0) / (s1 - s0)).clamp(0.0, 1.0), t)));
            cuts.push((1.0, s1));
            let mut open: Vec<([f64; 2], [f64; 2], usize)> =
                cuts.windows(2).map(|w| ([w[0].0, w[1].0], [w[0].1, w[1].1], 0)).collect();
            while let Some((f, s, depth)) = open.pop() {
                let (here, at_ends) = self.stretch(&side, &run.trim, f, s);
                let goal = bound.max(at_ends * (1.0 + EXCESS.0) + EXCESS.1 * self.tolerance);
                if here <= goal {
                    bound = bound.max(here);
                    continue;
                }
                let (fm, sm) = (0.5 * (f[0] + f[1]), 0.5 * (s[0] + s[1]));
                if depth == BORDER_DEPTH || !(sm > s[0] && sm < s[1]) {
                    return Err(PanelFault::TrimAt(LoopFault::Strays, on_face(side[0])));
                }
                open.extend([([f[0], fm], [s[0], sm], depth + 1), ([fm, f[1]], [sm, s[1]], depth + 1)]);
            }
        }
        Ok(bound)
    }

    /// δ on the stretch of a side between fractions `f`, which goes with `s` on the trimming curve; and δ at its ends.
    fn stretch(&self, side: &[[f64; 2]; 2], trim: &Curve<2>, f: [f64; 2], s: [f64; 2]) -> (f64, f64) {
        let theta = trim_piece(trim, s[0], s[1]);
        let jets = [Jet::of_bernstein(&theta[0]), Jet::of_bernstein(&theta[1])];
        let over = self.map.over([jets[0].v, jets[1].v]);
        let last = theta[0].len() - 1;
        let corner = |f: f64, d: usize| {
            let (a, b) = (Interval::point(side[0][d]), Interval::point(side[1][d]));
            a + (b - a) * f
        };
        let ends = [(0, f[0]), (last, f[1])].map(|(k, f)| {
            let image = self.map.at([theta[0][k], theta[1][k]]).p;
            [0, 1].map(|d: usize| image[d] - corner(f, d))
        });
        let [x, y] = &jets;
        let off = [0, 1].map(|d: usize| {
            let bend = over.duu[d] * x.d.sqr()
                + (over.duv[d] * x.d * y.d).scale_exact(2.0)
                + over.dvv[d] * y.d.sqr()
                + over.du[d] * x.dd
                + over.dv[d] * y.dd;
            ends[0][d].hull(ends[1][d]).widen(0.125 * bend.mag())
        });
        // All segments lie between the side and the image of the curve.
        let sides = [0, 1].map(|d: usize| corner(f[0], d).hull(corner(f[1], d)));
        let box_ = [0, 1].map(|d: usize| over.p[d].hull(sides[d]).hull(sides[d] + off[d]));
        let face = self.face.over(box_).affine();
        let (du, dv) = (length(&face.du), length(&face.dv));
        let way = |off: &[Interval; 2]| (du * off[0].abs() + dv * off[1].abs()).hi;
        (way(&off), way(&ends[0]).max(way(&ends[1])))
    }
}

fn middle(cell: &[Interval; 2]) -> [f64; 2] {
    [cell[0].mid(), cell[1].mid()]
}

/// The stretches of a trimming curve that have a box each: short, so that few cells beside the border are in one.
fn steps(curve: &Curve<2>) -> Vec<[f64; 2]> {
    let quarters = |[a, b]: [f64; 2]| {
        let cut = move |k: u32| if k == 4 { b } else { a + (b - a) * 0.25 * f64::from(k) };
        (0..4).map(move |k| [cut(k), cut(k + 1)])
    };
    super::developable::trim_steps(curve).into_iter().flat_map(quarters).collect()
}

/// Their boxes.
fn boxes(curve: &Curve<2>) -> Vec<[Interval; 2]> {
    let hull = |c: Vec<Interval>| c.iter().skip(1).fold(c[0], |h, x| h.hull(*x));
    steps(curve).into_iter().map(|[a, b]| trim_piece(curve, a, b).map(hull)).collect()
}

/// The first end of every step, as its boxes have them.
fn ends(curve: &Curve<2>) -> Vec<[f64; 2]> {
    steps(curve).into_iter().map(|[a, b]| trim_piece(curve, a, b).map(|c| c[0].mid())).collect()
}

fn signed_area(polygon: &[[f64; 2]]) -> f64 {
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    (0..polygon.len()).map(|k| polygon[k][0] * next(k)[1] - polygon[k][1] * next(k)[0]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_have_the_sign_of_their_sense() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let back: Vec<_> = square.iter().rev().copied().collect();
        assert!(signed_area(&square) > 0.0 && signed_area(&back) < 0.0);
    }
}
