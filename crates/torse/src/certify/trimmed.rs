//! Strips cut back to an outline, against what was measured: no point far from the strips, no place of them far from what
//! was measured.
//!
//! *Theorem* \[certificate, 9\]. The loops of a panel are polygons of the parameter plane of its patch, and bound a region of
//! it. No point that a point certificate places on the panel is farther from the image of the region than `beyond`; no
//! place of that image is farther than `reach` from a measured point, or from a triangle between such points; the edges
//! in space are within `edge` of the images of the loops.
//! *Method*. A point inside the loops has its own place on the patch; one outside, a place on the nearest side. The region
//! is covered by cells of the parameter plane, halved until the convex hull of a cell's control points lies near
//! one measured point or triangle, or the hull of two neighbouring rulings, from which distances are convex; where rulings are
//! given, cells begin at these, since each lies beside the next two. Predicates are exact \[S97\], values are intervals. Nothing
//! here knows how outlines were found.

use super::claim::UpperBound;
use super::edges::edge_bound;
use super::points::{distance_bound, PointCertificate, Target};
use super::polygon::{clipped, crossing, meets, ROUNDED};
use super::ruled::{Ruled, RuledJets};
use super::seams::SeamSide;
use super::simple::polygons_are_simple;
use super::vector::{exact, length_bound, sub};
use crate::control::Control;
use crate::geom::box_tree::{nearest_on_triangle, BoxTree};
use crate::geom::{BBox, Vec3};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel};
use crate::reason::LoopFault;
use std::collections::VecDeque;

/// What was measured.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Points, mm.
    pub points: &'a [Vec3],
    /// Corners of triangles that were measured as a whole; empty where points alone count.
    pub triangles: &'a [[u32; 3]],
    /// Ends of two neighbouring rulings each: given is what lies on straight lines between both, the convex hull of the four.
    pub between: &'a [[u32; 4]],
    /// Where the points lie on the strips.
    pub places: &'a PointCertificate,
}

/// What stands against an outline, and where, if that is a place.
pub(crate) type Fault = (LoopFault, Option<Vec3>);

/// What is proven of a panel and its outline. Lengths in mm.
#[derive(Clone, Debug)]
pub struct TrimmedCertificate {
    beyond: UpperBound,
    reach: UpperBound,
    edge: UpperBound,
    worst: Option<usize>,
    farthest: Option<Vec3>,
    fault: Option<Fault>,
    bounds: Vec<(usize, f64)>,
}

impl TrimmedCertificate {
    /// Each point that is placed on the panel, by its number, with the bound of its distance (mm).
    pub(crate) fn bounds(&self) -> &[(usize, f64)] {
        &self.bounds
    }

    /// Bound of the distance of points placed on the panel from what its outline leaves of it; none is farther.
    pub fn beyond_bound(&self) -> UpperBound {
        self.beyond
    }

    /// Bound of the distance of places inside the outline from what was measured.
    pub fn reach_bound(&self) -> UpperBound {
        self.reach
    }

    /// Bound of the distance of the edges in space from the outline on the patch.
    pub fn edge_bound(&self) -> UpperBound {
        self.edge
    }

    /// The point that is farthest from the panel.
    pub fn worst(&self) -> Option<usize> {
        self.worst
    }

    /// About where the panel is farthest from what was measured.
    pub fn farthest(&self) -> Option<Vec3> {
        self.farthest
    }

    /// What could not be shown; nothing if all could.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }
}

/// Rounding of a place on a triangle, as a share of its coordinates: some sums and products of numbers.
const PLACED: f64 = 16.0 * f64::EPSILON;
/// Halvings of the region's extent, at most, in both directions together.
const DEEPEST: usize = 28;
/// What bounds may exceed the greatest distance that was seen by, as a factor.
const EXCESS: f64 = 1.1;
/// Cells of a panel that are looked at, the largest first; what is left then keeps the bound that it has.
const MOST_CELLS: usize = 400_000;
/// Places in each direction at which distances are looked at first.
const LOOKS: [usize; 2] = [64, 16];

/// Proves what is claimed of panels that end at outlines: one certificate for each, in order. Panels without loops are whole
/// patches. `tolerance` (mm) is that of edges.
///
/// *Cost*: a microsecond for each point and some for every cell; cells are as large as the measured places are apart.
pub fn trimmed(panels: &[Panel], measured: &Measured, tolerance: f64, control: &Control) -> Vec<TrimmedCertificate> {
    let sites = Sites::new(measured);
    let mut own: Vec<Vec<usize>> = vec![Vec::new(); panels.len()];
    for (i, place) in measured.places.places().iter().enumerate().take(measured.points.len()) {
        own.get_mut(place.0 as usize).into_iter().for_each(|o| o.push(i));
    }
    parallel::map(panels.iter().zip(own), |(panel, own)| {
        let blank = TrimmedCertificate {
            beyond: UpperBound::UNKNOWN,
            reach: UpperBound::UNKNOWN,
            edge: UpperBound::UNKNOWN,
            worst: None,
            farthest: None,
            fault: None,
            bounds: Vec::new(),
        };
        one(panel, &own, measured, &sites, tolerance, control)
            .unwrap_or_else(|fault| TrimmedCertificate { fault: Some(fault), ..blank })
    })
}

fn one(
    panel: &Panel,
    own: &[usize],
    measured: &Measured,
    sites: &Sites,
    tolerance: f64,
    control: &Control,
) -> Result<TrimmedCertificate, Fault> {
    let ruled = Ruled::new(&panel.strip.patch).ok_or((LoopFault::NotRuled, None))?;
    let cuts = match measured.between.is_empty() {
        true => Vec::new(),
        false => own.iter().map(|&i| f64::from(measured.places.places()[i].1)).collect(),
    };
    let region = Region { cuts, ..Region::of(panel, &ruled)? };
    let jets = RuledJets::new(&ruled, &ruled.middle(panel.strip.domain().0));
    let mut edge = UpperBound::shown(0.0);
    for run in panel.outline.iter().flatten() {
        let side = SeamSide { jets: &jets, trim: &run.trim };
        let from = run.edge.control.first().map(|p| Vec3::from(*p));
        let bound = edge_bound(side, &run.edge, tolerance).ok_or((LoopFault::OutlineEdge, from))?;
        edge = edge.max(UpperBound::shown(bound));
    }
    let target = Target::of(&panel.strip);
    let sides = region.sides_in_space(panel);
    let bounds: Vec<f64> = parallel::map(own.iter(), |&i| {
        if control.stopped() {
            return f64::INFINITY;
        }
        let (_, u, v) = measured.places.places()[i];
        let (from, to) = panel.strip.domain();
        let at = [f64::from(u).clamp(from, to), f64::from(v).clamp(0.0, 1.0)];
        let x = &measured.points[i];
        if region.holds(at) {
            return distance_bound(&target, at[0], at[1], x);
        }
        region.beside(&jets, &sides, x)
    });
    let worst = (0..own.len()).max_by(|&a, &b| bounds[a].total_cmp(&bounds[b]));
    let (reach, farthest) = region.reach(panel, &ruled, sites, tolerance, control).ok_or((LoopFault::Stopped, None))?;
    Ok(TrimmedCertificate {
        // Of a panel without points nothing is far.
        beyond: worst.map_or(UpperBound::shown(0.0), |k| UpperBound::shown(bounds[k])),
        reach: UpperBound::shown(reach),
        edge,
        worst: worst.map(|k| own[k]),
        farthest,
        fault: None,
        bounds: own.iter().copied().zip(bounds).collect(),
    })
}

/// Points, triangles and what lies between rulings, found by place.
struct Sites<'a> {
    measured: Measured<'a>,
    tree: BoxTree,
}

/// The sides of the convex hull of four points.
const HULL: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

impl<'a> Sites<'a> {
    fn new(measured: &Measured<'a>) -> Self {
        let own = Self { measured: *measured, tree: BoxTree::new(0, &|_| BBox::empty()) };
        let bounds = |i: usize| {
            let mut b = BBox::empty();
            own.corners(i).iter().for_each(|c| b.include(&own.corner(*c)));
            b
        };
        let count = measured.points.len() + measured.triangles.len() + measured.between.len();
        Self { tree: BoxTree::new(count, &bounds), ..own }
    }

    fn corner(&self, k: u32) -> Vec3 {
        self.measured.points.get(k as usize).copied().unwrap_or_else(|| Vec3::repeat(f64::NAN))
    }

    /// Indices of the corners of a site; none of a single point.
    fn hull(&self, i: usize) -> &'a [u32] {
        let Measured { points, triangles, between, .. } = self.measured;
        let Some(k) = i.checked_sub(points.len()) else { return &[] };
        match k.checked_sub(triangles.len()) {
            None => &triangles[k],
            Some(k) => &between[k],
        }
    }

    /// The same with that of a single point.
    fn corners(&self, i: usize) -> Vec<u32> {
        match self.hull(i) {
            [] => vec![i as u32],
            all => all.to_vec(),
        }
    }

    /// The nearest site.
    fn near(&self, x: &Vec3) -> Option<usize> {
        let far = |i: usize| (self.on(i, x).0 - x).norm_squared();
        self.tree.nearest(x, &far).map(|n| n.0)
    }

    /// The place of a site that is nearest to `x`, and how far rounding may have moved it, mm. Inside a hull it is on its border.
    fn on(&self, i: usize, x: &Vec3) -> (Vec3, f64) {
        let hull = self.hull(i);
        let sides = match hull.len() {
            0 => return (self.measured.points[i], 0.0),
            3 => &HULL[..1],
            _ => &HULL[..],
        };
        let mut size = 0.0;
        let places = sides.iter().map(|side| {
            let [a, b, c] = side.map(|k| self.corner(hull[k]));
            size = a.amax().max(b.amax()).max(c.amax()).max(size);
            let s = nearest_on_triangle(x, [a, b, c]);
            a * s[0] + b * s[1] + c * s[2]
        });
        let far = |p: &Vec3| (p - x).norm_squared();
        let place = places.min_by(|p, q| far(p).total_cmp(&far(q))).unwrap_or_else(|| Vec3::repeat(f64::NAN));
        (place, PLACED * (place.amax() + 3.0 * size))
    }
}

/// The region inside the loops.
struct Region {
    loops: Vec<Vec<[f64; 2]>>,
    /// Sides that a line of constant r may cross, by rows of r.
    rows: Vec<Vec<(u32, u32)>>,
    /// Whether it is the whole patch.
    whole: bool,
    /// Values of t at which cells begin, besides those of knots.
    cuts: Vec<f64>,
}

/// Rows of r in which sides are looked up.
const ROWS: usize = 512;

fn row(r: f64) -> usize {
    ((r * ROWS as f64) as usize).min(ROWS - 1)
}

impl Region {
    fn of(panel: &Panel, ruled: &Ruled) -> Result<Self, Fault> {
        let (from, to) = panel.strip.domain();
        let loops: Vec<Vec<[f64; 2]>> = if panel.outline.is_empty() {
            let breaks = ruled.breaks();
            let back = breaks.iter().rev().map(|t| [*t, 1.0]);
            vec![breaks.iter().map(|t| [*t, 0.0]).chain(back).collect()]
        } else {
            panel
                .outline
                .iter()
                .map(|runs| polygon(runs))
                .collect::<Option<_>>()
                .ok_or((LoopFault::OutlineOpen, None))?
        };
        let inside = |p: &[f64; 2]| p[0] >= from && p[0] <= to && p[1] >= 0.0 && p[1] <= 1.0;
        let on = |p: &[f64; 2]| panel.strip.patch.point(p[0].clamp(from, to), p[1].clamp(0.0, 1.0));
        if let Some(out) = loops.iter().flatten().find(|p| !inside(p)) {
            return Err((LoopFault::OutlineLeaves, Some(on(out))));
        }
        // Those who prove it want the first polygon counter-clockwise.
        let turned = if doubled_area(&loops[0]) < 0.0 {
            loops.iter().map(|l| l.iter().rev().copied().collect()).collect()
        } else {
            loops.clone()
        };
        polygons_are_simple(&turned).map_err(|r| (LoopFault::OutlineMeets, r.at.as_ref().map(on)))?;
        let mut rows = vec![Vec::new(); ROWS];
        for (l, polygon) in loops.iter().enumerate() {
            for k in 0..polygon.len() {
                let (a, b) = (row(polygon[k][1]), row(polygon[(k + 1) % polygon.len()][1]));
                (a.min(b)..=a.max(b)).for_each(|r| rows[r].push((l as u32, k as u32)));
            }
        }
        Ok(Self { loops, rows, whole: panel.outline.is_empty(), cuts: Vec::new() })
    }

    fn side(&self, (l, k): (u32, u32)) -> [[f64; 2]; 2] {
        let polygon = &self.loops[l as usize];
        [polygon[k as usize], polygon[(k as usize + 1) % polygon.len()]]
    }

    /// Whether a place is inside; on a side either answer is right.
    fn holds(&self, at: [f64; 2]) -> bool {
        if self.whole {
            return true;
        }
        let around = |s: &(u32, u32)| {
            let [a, b] = self.side(*s);
            crossing(a, b, at)
        };
        self.rows[row(at[1])].iter().map(around).sum::<i32>() != 0
    }

    /// Every side with the places of its ends in space.
    fn sides_in_space(&self, panel: &Panel) -> Vec<([[f64; 2]; 2], [Vec3; 2])> {
        let all = self.loops.iter().enumerate().flat_map(|(l, p)| (0..p.len()).map(move |k| (l as u32, k as u32)));
        all.map(|s| {
            let ends = self.side(s);
            (ends, ends.map(|q| panel.strip.patch.point(q[0], q[1])))
        })
        .collect()
    }

    /// Bound of the distance of a point from a place on the side whose chord is nearest.
    fn beside(&self, jets: &RuledJets, sides: &[([[f64; 2]; 2], [Vec3; 2])], x: &Vec3) -> f64 {
        let mut best = (f64::INFINITY, [[0.0; 2]; 2], 0.0);
        for (ends, [p, q]) in sides {
            let d = q - p;
            let dd = d.norm_squared();
            let s = if dd > 0.0 { (d.dot(&(x - p)) / dd).clamp(0.0, 1.0) } else { 0.0 };
            let far = (p + d * s - x).norm_squared();
            if far < best.0 {
                best = (far, *ends, s);
            }
        }
        let (_, [a, b], s) = best;
        let s = Interval::point(s);
        let at = [0, 1].map(|d: usize| Interval::point(a[d]) + (Interval::point(b[d]) - Interval::point(a[d])) * s);
        let (lo, hi) = jets.domain();
        let (Some(t), Some(r)) = (at[0].intersect(Interval { lo, hi }), at[1].intersect(Interval::new(0.0, 1.0)))
        else {
            return f64::INFINITY;
        };
        let relative = sub(&exact(x), &jets.origin.map(Interval::point));
        length_bound(&sub(&jets.at(t, r), &relative))
    }

    /// Bound of the distance of places of the region from the nearest site, and about where it is greatest; `None` if it was
    /// stopped.
    fn reach(
        &self,
        panel: &Panel,
        ruled: &Ruled,
        sites: &Sites,
        tolerance: f64,
        control: &Control,
    ) -> Option<(f64, Option<Vec3>)> {
        let all: Vec<[[f64; 2]; 2]> = self.sides_in_space(panel).into_iter().map(|s| s.0).collect();
        let seen = self.seen(panel, sites).max(tolerance);
        let mut breaks = ruled.breaks();
        let (from, to) = panel.strip.domain();
        breaks.extend(self.cuts.iter().filter(|t| **t > from && **t < to));
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        let most = MOST_CELLS / breaks.len();
        let span = |w: &[f64]| {
            let t = Interval::new(w[0], w[1]);
            let sides = (0..all.len()).filter(|k| meets(all[*k][0], all[*k][1], &[t, UNIT])).collect();
            let mut open = VecDeque::from([Cell { t, r: UNIT, sides, depth: 0 }]);
            let (mut worst, mut seen, mut looks) = ((0.0f64, Vec3::zeros()), seen, 0);
            while let Some(cell) = open.pop_front() {
                if control.stopped() {
                    return None;
                }
                let cell = if cell.sides.is_empty() { cell } else { cell.shrunk(self, &all) };
                let middle = [cell.t.mid(), cell.r.mid()];
                let held = self.holds(middle);
                if cell.sides.is_empty() && !held {
                    continue;
                }
                looks += 1;
                let look = cell.reach(panel, ruled, sites);
                if held {
                    seen = seen.max(look.at_middle);
                }
                let done = look.bound <= worst.0.max(EXCESS * seen) || cell.depth >= DEEPEST || looks > most;
                if done {
                    if look.bound > worst.0 || look.bound.is_nan() {
                        worst = (look.bound, look.middle);
                    }
                    continue;
                }
                open.extend(cell.halves(look.extents[0] >= look.extents[1], &all));
            }
            Some(worst)
        };
        let found: Vec<Option<(f64, Vec3)>> = parallel::map(breaks.windows(2), span);
        let mut worst = (0.0, None);
        for (bound, place) in found.into_iter().collect::<Option<Vec<_>>>()? {
            if bound > worst.0 || bound.is_nan() {
                worst = (bound, Some(place));
            }
        }
        Some(worst)
    }

    /// Greatest distance of some places of the region from the nearest site.
    fn seen(&self, panel: &Panel, sites: &Sites) -> f64 {
        let (from, to) = panel.strip.domain();
        let share = |k: usize, d: usize| (k as f64 + 0.5) / LOOKS[d] as f64;
        let far = |k: usize| {
            let at = [from + (to - from) * share(k / LOOKS[1], 0), share(k % LOOKS[1], 1)];
            let x = panel.strip.patch.point(at[0], at[1]);
            if self.holds(at) {
                sites.near(&x).map_or(0.0, |i| (sites.on(i, &x).0 - x).norm())
            } else {
                0.0
            }
        };
        parallel::map(0..LOOKS[0] * LOOKS[1], far).into_iter().fold(0.0, f64::max)
    }
}

const UNIT: Interval = Interval { lo: 0.0, hi: 1.0 };

/// A cell of the parameter plane inside one span, with the sides that may meet it.
struct Cell {
    t: Interval,
    r: Interval,
    sides: Vec<usize>,
    depth: usize,
}

/// What is known of a cell, mm.
struct Reach {
    /// Bound of the distance of its places from one site.
    bound: f64,
    /// Its middle, and how far about that is from the site.
    middle: Vec3,
    at_middle: f64,
    /// Its extents along both parameters.
    extents: [f64; 2],
}

impl Cell {
    fn reach(&self, panel: &Panel, ruled: &Ruled, sites: &Sites) -> Reach {
        let middle = panel.strip.patch.point(self.t.mid(), self.r.mid());
        let Some(nearest) = sites.near(&middle) else {
            return Reach { bound: f64::INFINITY, middle, at_middle: 0.0, extents: [0.0; 2] };
        };
        let site = sites.on(nearest, &middle).0;
        // The distance from a point or a triangle is convex: the greatest of the coefficients' own bounds that of every place.
        let origin = [site.x, site.y, site.z];
        let rails = [0, 1].map(|end: usize| ruled.end(end, self.t.lo, self.t.hi, &origin));
        let mut most = 0.0f64;
        let mut corners = [[Vec3::zeros(); 2]; 2];
        let last = rails[0][0].len() - 1;
        for (j, r) in [self.r.lo, self.r.hi].into_iter().enumerate() {
            let (s, r) = (Interval::ONE - Interval::point(r), Interval::point(r));
            for i in 0..=last {
                let h = [0, 1, 2, 3].map(|d: usize| s * rails[0][d][i] + r * rails[1][d][i]);
                let p = if ruled.rational { [0, 1, 2].map(|d: usize| h[d] / h[3]) } else { [h[0], h[1], h[2]] };
                let (own, moved) = sites.on(nearest, &(site + Vec3::from(p.map(Interval::mid))));
                let off = [0, 1, 2].map(|d: usize| p[d] - (Interval::point(own[d]) - Interval::point(site[d])));
                let far = (Interval::point(length_bound(&off)) + Interval::point(moved)).hi;
                most = if far.is_nan() { f64::INFINITY } else { most.max(far) };
                if i == 0 || i == last {
                    corners[usize::from(i > 0)][j] = Vec3::from(p.map(Interval::mid));
                }
            }
        }
        let [[a, b], [c, d]] = corners;
        let extents = [(c - a).norm().max((d - b).norm()), (b - a).norm().max((d - c).norm())];
        Reach { bound: most, middle, at_middle: (site - middle).norm(), extents }
    }

    /// The cell about what of it is inside: that lies between sides, as far as they are in it, and corners that are inside.
    fn shrunk(self, region: &Region, all: &[[[f64; 2]; 2]]) -> Self {
        let corners = [[self.t.lo, self.r.lo], [self.t.lo, self.r.hi], [self.t.hi, self.r.lo], [self.t.hi, self.r.hi]];
        let held = corners.into_iter().filter(|c| region.holds(*c));
        let places: Vec<[f64; 2]> =
            held.chain(self.sides.iter().flat_map(|s| clipped(all[*s], &[self.t, self.r]))).collect();
        let far = self.sides.iter().flat_map(|s| all[*s]).flatten().map(f64::abs).fold(0.0, f64::max);
        let range = |d: usize, own: Interval| {
            let (lo, hi) =
                places.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[d]), h.max(p[d])));
            Interval { lo: lo - ROUNDED * far, hi: hi + ROUNDED * far }.intersect(own).unwrap_or(own)
        };
        Self { t: range(0, self.t), r: range(1, self.r), ..self }
    }

    fn halves(&self, along: bool, all: &[[[f64; 2]; 2]]) -> [Self; 2] {
        let cut = |i: Interval| [Interval::new(i.lo, i.mid()), Interval::new(i.mid(), i.hi)];
        let (t, r) = if along { (cut(self.t), [self.r; 2]) } else { ([self.t; 2], cut(self.r)) };
        [0, 1].map(|k: usize| {
            let sides = self.sides.iter().copied().filter(|s| meets(all[*s][0], all[*s][1], &[t[k], r[k]])).collect();
            Self { t: t[k], r: r[k], sides, depth: self.depth + 1 }
        })
    }
}

/// The corners of a closed loop of polylines of the parameter plane; `None` if it is none.
pub(super) fn polygon(runs: &[Coedge]) -> Option<Vec<[f64; 2]>> {
    let mut out = Vec::new();
    for (k, run) in runs.iter().enumerate() {
        let (c, before) = (&run.trim.control, &runs[(k + runs.len() - 1) % runs.len()].trim.control);
        let straight = run.trim.knots.degree() == 1 && run.trim.knots.breaks().len() == c.len();
        let joined = c.first()?.map(f64::to_bits) == before.last()?.map(f64::to_bits);
        if !straight || !joined || c.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        out.extend_from_slice(&c[..c.len() - 1]);
    }
    (out.len() > 2).then_some(out)
}

fn doubled_area(p: &[[f64; 2]]) -> f64 {
    (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::points::points;
    use crate::patchwork::panel::Border;
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::torse::form::PanelKind;
    use crate::torse::strip::Strip;

    /// A quarter of a parabolic cylinder of 100 by 60, points 2 apart over its middle, and a panel that ends at the border of
    /// these: `shift` (in parameters) pulls one corner of the outline.
    fn scan(shift: [f64; 2]) -> (Panel, Vec<Vec3>) {
        let rail = |y: f64| {
            let control = vec![[0.0, y, 0.0], [50.0, y, 0.0], [100.0, y, 30.0]];
            Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], control).expect("a rail")
        };
        let strip = Strip::polynomial("A", PanelKind::Cylinder, &rail(0.0), &rail(60.0)).expect("a strip");
        let grid = (5..=45).flat_map(|i| (3..=27).map(move |j| [f64::from(i) / 50.0, f64::from(j) / 30.0]));
        let places = grid.filter(|q| (q[0] - 0.5).hypot(0.6 * (q[1] - 0.5)) >= 0.12);
        let x = places.map(|q| strip.patch.point(q[0], q[1])).collect();
        let mut corners = [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]];
        corners[2] = [corners[2][0] + shift[0], corners[2][1] + shift[1]];
        let hole: Vec<[f64; 2]> = (0..24)
            .map(|k| (f64::from(k) * -std::f64::consts::TAU / 24.0).sin_cos())
            .map(|(s, c)| [0.5 + 0.12 * c, 0.5 + 0.2 * s])
            .collect();
        let outline = [corners.to_vec(), hole].iter().map(|l| vec![run(&strip, l)]).collect();
        (Panel { outline, ..Panel::from(strip) }, x)
    }

    /// A closed polygon as one run.
    fn run(strip: &Strip, corners: &[[f64; 2]]) -> Coedge {
        const PARTS: usize = 40;
        let n = corners.len();
        let all = (0..=n * PARTS).map(|k| {
            let (a, b, s) = (corners[k / PARTS % n], corners[(k / PARTS + 1) % n], (k % PARTS) as f64 / PARTS as f64);
            [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * s)
        });
        let control: Vec<[f64; 2]> = all.collect();
        let at: Vec<f64> = (0..control.len()).map(|k| k as f64 / (control.len() - 1) as f64).collect();
        let knots = Knots::clamped(1, &at).expect("knots");
        let edge = control.iter().map(|q| strip.patch.point(q[0], q[1])).map(|p| [p.x, p.y, p.z]).collect();
        Coedge {
            border: Border::Trim { edge: 0 },
            vertices: Vec::new(),
            parameters: Vec::new(),
            edge: Curve { knots: knots.clone(), control: edge },
            trim: Curve { knots, control },
        }
    }

    fn judged(panel: &Panel, x: &[Vec3]) -> TrimmedCertificate {
        let places = points(std::slice::from_ref(&panel.strip), x, &Control::default());
        let measured = Measured { points: x, triangles: &[], between: &[], places: &places };
        trimmed(std::slice::from_ref(panel), &measured, 0.01, &Control::default()).remove(0)
    }

    #[test]
    fn an_outline_along_the_points_keeps_to_them_both_ways() {
        let (panel, x) = scan([0.0; 2]);
        let c = judged(&panel, &x);
        assert_eq!(c.fault(), None);
        assert!(c.beyond_bound().value() < 1e-3 && c.edge_bound().value() < 0.01, "{c:?}");
        // Cells of points 2 to 2.4 apart, and the straight sides of the hole.
        let reach = c.reach_bound().value();
        assert!((1.5..2.6).contains(&reach), "{reach}");
        // No place that is looked at is farther than the bound.
        let near = |p: &Vec3| x.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
        let outside = |q: &[f64; 2]| ((q[0] - 0.5) / 0.12).hypot((q[1] - 0.5) / 0.2) > 1.0;
        let looks = (0..4000).map(|k| [0.1 + 0.8 * f64::from(k % 80) / 79.0, 0.1 + 0.8 * f64::from(k / 80) / 49.0]);
        let seen = looks.filter(outside).map(|q| near(&panel.strip.patch.point(q[0], q[1]))).fold(0.0, f64::max);
        assert!(seen <= reach && seen > 0.7 * reach, "{seen} {reach}");
    }

    #[test]
    fn outlines_pulled_out_or_in_are_seen() {
        let (panel, x) = scan([0.1, 0.1]);
        let out = judged(&panel, &x);
        assert!(out.beyond_bound().value() < 1e-3 && out.reach_bound().value() > 8.0, "{out:?}");
        let (panel, x) = scan([-0.1, -0.1]);
        let within = judged(&panel, &x);
        assert!(within.reach_bound().value() < 2.6 && within.beyond_bound().value() > 5.0, "{within:?}");
        assert!(within.worst().is_some_and(|i| (x[i] - panel.strip.patch.point(0.9, 0.9)).norm() < 1e-6));
    }

    #[test]
    fn outlines_that_are_none_are_refused() {
        let (good, x) = scan([0.0; 2]);
        let mut panel = good.clone();
        panel.outline[0][0].trim.control[7][1] = -0.01;
        assert_eq!(judged(&panel, &x).fault().map(|f| f.0), Some(LoopFault::OutlineLeaves));
        assert!(judged(&panel, &x).reach_bound() == UpperBound::UNKNOWN);
        let mut panel = good.clone();
        panel.outline[0][0].trim.control[0][1] += 0.01;
        assert_eq!(judged(&panel, &x).fault().map(|f| f.0), Some(LoopFault::OutlineOpen));
        let (crossed, _) = scan([-0.85, -0.4]);
        assert_eq!(judged(&crossed, &x).fault().map(|f| f.0), Some(LoopFault::OutlineMeets));
        // An edge in space beside its outline.
        let mut panel = good;
        panel.outline[0][0].edge.control[9][2] += 1.0;
        assert!(judged(&panel, &x).edge_bound().value() >= 1.0);
    }

    #[test]
    fn a_whole_strip_is_judged_against_points_and_triangles() {
        let (panel, x) = scan([0.0; 2]);
        let whole = Panel::from(panel.strip);
        let c = judged(&whole, &x);
        // From a corner of the strip to the outermost point.
        let off = (whole.strip.patch.point(1.0, 1.0) - whole.strip.patch.point(0.9, 0.9)).norm();
        assert!(c.reach_bound().value() >= off && c.reach_bound().value() < 1.2 * off, "{c:?}");
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|q| whole.strip.patch.point(q[0], q[1]));
        let places = points(std::slice::from_ref(&whole.strip), &corners, &Control::default());
        let measured = Measured { points: &corners, triangles: &[[0, 1, 2], [0, 2, 3]], between: &[], places: &places };
        let c = trimmed(&[whole], &measured, 0.01, &Control::default()).remove(0);
        // The chord of the parabola lies 7.5 beside it in z.
        assert!((6.5..8.6).contains(&c.reach_bound().value()), "{c:?}");
    }

    #[test]
    fn what_lies_between_rulings_is_told_sharply() {
        let (panel, _) = scan([0.0; 2]);
        let whole = Panel::from(panel.strip);
        // Rulings whose ends jump, twelve over the strip.
        let place = |k: u32| {
            [f64::from(k / 2) / 12.0, if k.is_multiple_of(2) { 0.05 } else { 0.8 + 0.1 * f64::from(k / 2 % 2) }]
        };
        let ends: Vec<Vec3> = (0..26).map(place).map(|q| whole.strip.patch.point(q[0], q[1])).collect();
        let between: Vec<[u32; 4]> = (0..12).map(|k| [0, 1, 2, 3].map(|i| 2 * k + i)).collect();
        let places = points(std::slice::from_ref(&whole.strip), &ends, &Control::default());
        let measured = Measured { points: &ends, triangles: &[], between: &between, places: &places };
        let corners: Vec<[f64; 2]> =
            (0..13).map(|k| place(2 * k)).chain((0..13).rev().map(|k| place(2 * k + 1))).collect();
        let cut = Panel { outline: vec![vec![run(&whole.strip, &corners)]], ..whole };
        let c = trimmed(&[cut], &measured, 0.01, &Control::default()).remove(0);
        // The parabola bulges by 30/4/144 at most, square to chords of no slope.
        assert!(c.reach_bound().value() >= 0.0515 && c.reach_bound().value() < 0.06, "{c:?}");
    }
}
