//! Boundaries of trimmed and bounded surfaces (141, 142): curves in space, curves in the parameter plane, or both.

use super::curves::{Geometry, Path};
use super::patch::{Chart, Patch};
use super::placing;
use super::records::Fault;
use crate::brep::raw::{PlaneTrace, RawEdge, RawLoop};
use crate::brep::ruled::spline_of;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::SupportSurface;
use crate::geom::placement::Placement;
use crate::geom::{BBox, Vec3};
use crate::spline::curve::Curve;
use crate::spline::image::on_surface;
use nalgebra::Matrix3;

/// The surface that carries a face.
pub(super) struct Base {
    /// Surface without its own transformation.
    pub patch: Patch,
    /// Its own transformation.
    pub own: Placement,
    /// The way back.
    pub back: Placement,
    /// Periods in the parameters of the file.
    pub periods: [Option<f64>; 2],
}

/// Which curves of the file a boundary is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// Curves in the parameter plane, where their images are splines that end where the curves in space do.
    Images,
    /// Curves in the parameter plane, where their images are splines, wherever the curves in space are.
    Preferred,
    /// Curves in space.
    Space,
    /// Curves in the parameter plane, of any sort.
    Plane,
}

/// A boundary as an entity describes it.
pub(super) struct Boundary {
    /// Its entity.
    pub id: u64,
    /// Curves in space with their sense, each with the curves in the parameter plane that go with it.
    uses: Vec<Use>,
    /// Whether the file prefers the curves in the parameter plane.
    prefers_plane: bool,
}

struct Use {
    /// Curve in space; 0 for none.
    space: u64,
    /// Whether it is run backwards.
    reversed: bool,
    /// Curves in the parameter plane.
    plane: Vec<u64>,
}

/// The preference flag that names the parameter plane.
const PLANE_PREFERRED: i64 = 1;
/// Ends of both sorts of curves farther apart than this share of the boundary's extent do not belong together.
pub(super) const CONTRADICTED: f64 = 0.05;
/// Points nearer than this share of an edge's extent are one: edges run there and back.
const SAME_POINT: f64 = 1e-6;
/// A loop of the parameter plane tells its sense where it encloses more than this share of its box.
const CLOSED: f64 = 1e-3;
/// Curves of a loop that are looked through for the ends of others, at most.
const MOST_SORTED: usize = 1000;
/// Places along a curve of the parameter plane that tell the sense of a loop.
const PLACES: usize = 6;

impl Geometry<'_> {
    /// The surface `id` as a base.
    pub fn base(&self, id: u64) -> Result<Base, Fault> {
        let patch = self.surface(id, 0)?;
        let own = placing::of_entry(self.records, self.get(id)?)?;
        let back = own.inverse().ok_or_else(|| Fault::new(id, format!("the transformation of D{id} is singular")))?;
        let periods = stated_periods(&patch);
        Ok(Base { patch, own, back, periods })
    }

    /// A boundary: 142, 141, or a closed curve.
    pub fn boundary(&self, id: u64) -> Result<Boundary, Fault> {
        let e = self.get(id)?;
        match e.kind {
            142 => {
                let (plane, space) = (e.optional(3)?, e.optional(4)?);
                let uses =
                    vec![Use { space, reversed: false, plane: Some(plane).into_iter().filter(|p| *p > 0).collect() }];
                Ok(Boundary { id, uses, prefers_plane: e.integer(5)? == PLANE_PREFERRED })
            }
            141 => {
                let n = e.count(4)?;
                let mut uses = Vec::with_capacity(n);
                let mut at = 5;
                for _ in 0..n {
                    let count = e.count(at + 2)?;
                    let plane = if e.integer(1)? == 0 { Vec::new() } else { e.pointers(at + 3, count)? };
                    uses.push(Use { space: e.optional(at)?, reversed: e.integer(at + 1)? == 2, plane });
                    at += 3 + count;
                }
                Ok(Boundary { id, uses, prefers_plane: e.integer(2)? == 2 })
            }
            _ => Ok(Boundary {
                id,
                uses: vec![Use { space: id, reversed: false, plane: Vec::new() }],
                prefers_plane: false,
            }),
        }
    }

    /// The loop of a boundary, in the coordinates of the base.
    pub fn boundary_loop(&self, b: &Boundary, base: &Base, source: Source, outer: bool) -> Result<RawLoop, Fault> {
        let mut edges = Vec::new();
        for u in &b.uses {
            match source {
                Source::Space => edges.extend(self.in_space(b, u, base)?),
                Source::Images | Source::Preferred | Source::Plane => edges.extend(self.in_plane(b, u, base, source)?),
            }
        }
        if edges.is_empty() {
            return Err(Fault::new(b.id, format!("the boundary D{} has no curves", b.id)));
        }
        // Loops run with the material on their left; which way the file's curves run is free.
        let sense = self.sense(b, base.periods);
        let l = RawLoop { edges: with_slits(edges, &base.patch.support), outer: outer && sense.is_none() };
        Ok(match sense {
            Some(counter_clockwise) if counter_clockwise != outer => l.reversed(),
            _ => l,
        })
    }

    /// Which curves to try, in this order.
    pub fn sources(&self, boundaries: &[Boundary]) -> &'static [Source] {
        let without_space = boundaries.iter().any(|b| b.uses.iter().any(|u| u.space == 0));
        let prefers_plane = boundaries.iter().any(|b| b.prefers_plane);
        match (without_space, prefers_plane) {
            (true, _) => &[Source::Images, Source::Plane],
            (false, true) => &[Source::Images, Source::Space, Source::Preferred, Source::Plane],
            (false, false) => &[Source::Space, Source::Images, Source::Plane],
        }
    }

    /// Curves in space, in the coordinates of the base and the direction of the loop.
    fn space_path(&self, u: &Use, base: &Base) -> Result<Path, Fault> {
        let path = placing::path(self.path(u.space, 0)?, &base.back)?;
        Ok(if u.reversed { path.iter().rev().map(|(id, a)| (*id, a.reversed())).collect() } else { path })
    }

    /// Curves in the parameter plane, in natural parameters.
    fn plane_path(&self, u: &Use, chart: Chart) -> Result<Path, Fault> {
        let mut all = Vec::new();
        for p in &u.plane {
            all.extend(self.path(*p, 0)?);
        }
        placing::path(all, &placement_of(chart))
    }

    /// One curve of the parameter plane, in natural parameters.
    pub fn flat(&self, id: u64, chart: Chart) -> Option<Arc> {
        let path = placing::path(self.path(id, 0).ok()?, &placement_of(chart)).ok()?;
        match path.len() {
            1 => path.into_iter().next().map(|p| p.1),
            _ => None,
        }
    }

    fn in_space(&self, b: &Boundary, u: &Use, base: &Base) -> Result<Vec<RawEdge>, Fault> {
        if u.space == 0 {
            return Err(Fault::new(b.id, format!("the boundary D{} has no curve in space", b.id)));
        }
        let path = self.space_path(u, base)?;
        let plane = base.patch.chart.and_then(|c| self.plane_path(u, c).ok()).filter(|p| p.len() == path.len());
        let trace = |i: usize, arc: &Arc| trace_of(&plane.as_ref()?.get(i)?.1, arc, &base.patch.support);
        let edges = path.into_iter().enumerate().map(|(i, (entity, arc))| {
            let trace = trace(i, &arc);
            RawEdge { entity, forward: true, path: vec![arc], vertices: None, trace }
        });
        Ok(edges.collect())
    }

    fn in_plane(&self, b: &Boundary, u: &Use, base: &Base, source: Source) -> Result<Vec<RawEdge>, Fault> {
        let missing = || Fault::new(b.id, format!("the boundary D{} has no curve in the parameter plane", b.id));
        let chart = base.patch.chart.filter(|_| !u.plane.is_empty()).ok_or_else(missing)?;
        let path = self.plane_path(u, chart)?;
        let support = &base.patch.support;
        if source == Source::Images && self.contradicted(u, &path, base) {
            let what = format!("the curves of D{} in the parameter plane lie far from those in space", b.id);
            return Err(Fault::new(b.id, what));
        }
        path.into_iter()
            .map(|(entity, flat)| match image(entity, &flat, support) {
                Some(edge) => Ok(edge),
                None if source != Source::Plane => {
                    Err(Fault::new(entity, format!("the image of D{entity} is no spline")))
                }
                None => Ok(traced(entity, flat, support)),
            })
            .collect()
    }

    /// Whether the images of curves in the parameter plane end far from the curves in space: then their parameters are
    /// not those of the surface, as some writers have it.
    fn contradicted(&self, u: &Use, plane: &Path, base: &Base) -> bool {
        let Some(space) = (u.space != 0).then(|| self.space_path(u, base).ok()).flatten() else { return false };
        if space.len() != plane.len() {
            return false;
        }
        let mut extent = BBox::empty();
        for (_, a) in &space {
            [0.0, 0.25, 0.5, 0.75, 1.0]
                .iter()
                .for_each(|s| extent.include(&a.curve.point(a.from + s * (a.to - a.from))));
        }
        let far = |p: Vec3, q: Vec3| (p - q).norm() > CONTRADICTED * extent.diagonal();
        space.iter().zip(plane).any(|((_, c), (_, f))| {
            let image = |t: f64| {
                let q = f.curve.point(t);
                base.patch.support.jet([q.x, q.y]).p
            };
            let (p, q) = c.ends();
            let (a, b) = (image(f.from), image(f.to));
            (far(a, p) || far(b, q)) && (far(a, q) || far(b, p))
        })
    }

    /// Whether a boundary runs counter-clockwise in the parameter plane of its surface; `None` where that cannot be
    /// told: it may go round the surface. Where it passes a pole, a side of the polygon may be left out.
    fn sense(&self, b: &Boundary, periods: [Option<f64>; 2]) -> Option<bool> {
        let mut curves: Vec<Vec<[f64; 2]>> = Vec::new();
        for u in &b.uses {
            if u.plane.is_empty() {
                return None;
            }
            for (_, a) in self.plane_path(u, Chart::SAME).ok()? {
                let mut points = Vec::new();
                for w in a.curve.stations(a.from, a.to).windows(2) {
                    points.extend((0..=PLACES).map(|i| {
                        let q = a.curve.point(w[0] + (w[1] - w[0]) * i as f64 / PLACES as f64);
                        [q.x, q.y]
                    }));
                }
                curves.push(points);
            }
        }
        curves.retain(|c| !c.is_empty());
        let points = || curves.iter().flatten();
        let (first, last) = (points().next()?, points().last()?);
        let reach = [0, 1].map(|k| {
            let (lo, hi) = points().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[k]), b.max(p[k])));
            hi - lo
        });
        let beside = |p: &[f64; 2], q: &[f64; 2]| {
            let [p, q] = [p, q].map(|x| [x[0] - first[0], x[1] - first[1]]);
            p[0] * q[1] - q[0] * p[1]
        };
        let along = |c: &[[f64; 2]]| c.windows(2).map(|w| beside(&w[0], &w[1])).sum::<f64>();
        let area = curves.iter().map(|c| along(c)).sum::<f64>();
        // Where all corners of a chart are one point, writers may jump from one to another: the curves as they lie bound
        // the region all the same, in whichever order they come.
        let area = if closed_in_any_order(&curves, reach) {
            area
        } else {
            if (0..2).any(|k| periods[k].is_some_and(|p| (first[k] - last[k]).abs() >= (1.0 - CLOSED) * p)) {
                return None;
            }
            area + curves.windows(2).map(|w| beside(&w[0][w[0].len() - 1], &w[1][0])).sum::<f64>()
        };
        // Twice the area of a loop that runs back along itself is nothing.
        (area.abs() > CLOSED * reach[0] * reach[1]).then_some(area > 0.0)
    }
}

/// Whether every curve ends where some other begins, each with its own.
fn closed_in_any_order(curves: &[Vec<[f64; 2]>], reach: [f64; 2]) -> bool {
    let mut starts: Vec<[f64; 2]> = curves.iter().map(|c| c[0]).collect();
    curves.len() <= MOST_SORTED
        && curves.iter().all(|c| {
            let end = c[c.len() - 1];
            let meets = |p: &[f64; 2]| (0..2).all(|k| (p[k] - end[k]).abs() <= CLOSED * reach[k]);
            starts.iter().position(meets).map(|i| starts.swap_remove(i)).is_some()
        })
}

/// Periods in the parameters of the file.
fn stated_periods(patch: &Patch) -> [Option<f64>; 2] {
    let Some(chart) = patch.chart else { return [None; 2] };
    let natural = patch.support.periods();
    let stated = [0, 1].map(|k| natural[k].map(|p| p / chart.scale[k].abs()));
    if chart.exchanged {
        [stated[1], stated[0]]
    } else {
        stated
    }
}

/// The chart as a placement of the parameter plane.
fn placement_of(c: Chart) -> Placement {
    let [a, b] = c.scale;
    let linear = if c.exchanged {
        Matrix3::new(0.0, a, 0.0, b, 0.0, 0.0, 0.0, 0.0, 1.0)
    } else {
        Matrix3::new(a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, 1.0)
    };
    Placement { linear, shift: Vec3::new(c.shift[0], c.shift[1], 0.0) }
}

/// A curve of the parameter plane with the parameters of the curve in space that it goes with.
pub(super) fn trace_of(flat: &Arc, space: &Arc, support: &SupportSurface) -> Option<PlaneTrace> {
    let mut spline = spline_of(flat).ok()?;
    let at = |h: [f64; 4]| support.jet([h[0] / h[3], h[1] / h[3]]).p;
    let (a, b) = spline.domain();
    let (p, q) = space.ends();
    let (start, end) = (at(spline.point(a)), at(spline.point(b)));
    if (start - q).norm() + (end - p).norm() < (start - p).norm() + (end - q).norm() {
        spline = spline.reversed();
    }
    if space.from > space.to {
        spline = spline.reversed();
    }
    let (lo, hi) = (space.from.min(space.to), space.from.max(space.to));
    let moved = |t: &f64| if *t >= b { hi } else { lo + (t - a) / (b - a) * (hi - lo) };
    let knots = spline.knots.values().iter().map(moved).collect();
    let curve = Curve::new(spline.knots.degree(), knots, spline.control).ok()?;
    Some(PlaneTrace { curve: SpaceCurve::Spline(curve), scale: [1.0; 2] })
}

/// An edge that the file gives in the parameter plane: its image, where that is a spline.
fn image(entity: u64, flat: &Arc, support: &SupportSurface) -> Option<RawEdge> {
    let SupportSurface::Spline(s) = support else { return None };
    let plane = spline_of(flat).ok()?;
    let plane = evenly(plane);
    let polynomial = plane.control.iter().all(|h| h[3] == plane.control[0][3]);
    let control = plane.control.iter().map(|h| [h[0] / h[3], h[1] / h[3]]).collect();
    let curve = polynomial.then_some(Curve { knots: plane.knots.clone(), control })?;
    let image = on_surface(&s.surface, &curve)?;
    let (from, to) = image.domain();
    let path = vec![Arc { curve: SpaceCurve::Spline(image), from, to }];
    let trace = Some(PlaneTrace { curve: SpaceCurve::Spline(plane), scale: [1.0; 2] });
    Some(RawEdge { entity, forward: true, path, vertices: None, trace })
}

/// Control points nearer to a line than this share of its length are on it, up to rounding.
const STRAIGHT: f64 = 1e-12;

/// A spline of the parameter plane that is a straight line, as a line that is run through evenly; others as they are. Where it runs
/// to and fro on its line it bounds nothing more than the way between its ends.
fn evenly(c: Curve<4>) -> Curve<4> {
    let points: Vec<[f64; 2]> = c.control.iter().map(|h| [h[0] / h[3], h[1] / h[3]]).collect();
    let (p, q) = (points[0], points[points.len() - 1]);
    let d = [q[0] - p[0], q[1] - p[1]];
    let square = d[0] * d[0] + d[1] * d[1];
    let beside = |x: &[f64; 2]| ((x[0] - p[0]) * d[1] - (x[1] - p[1]) * d[0]).abs() <= STRAIGHT * square;
    let straight = square > 0.0 && points.iter().all(beside);
    let (a, b) = c.domain();
    let ends = || vec![[p[0], p[1], 0.0, 1.0], [q[0], q[1], 0.0, 1.0]];
    match Curve::new(1, vec![a, a, b, b], if straight { ends() } else { Vec::new() }) {
        Ok(line) => line,
        Err(_) => c,
    }
}

/// An edge of the parameter plane as it is, of which nothing can be proven.
fn traced(entity: u64, flat: Arc, support: &SupportSurface) -> RawEdge {
    let trace = Some(PlaneTrace { curve: flat.curve.clone(), scale: [1.0; 2] });
    let curve = SpaceCurve::traced(flat.curve, support.clone(), [1.0; 2]);
    let path = vec![Arc { curve, from: flat.from, to: flat.to }];
    RawEdge { entity, forward: true, path, vertices: None, trace }
}

/// Edges that run along each other in opposite directions, in space and on the surface, are one edge used twice.
fn with_slits(mut edges: Vec<RawEdge>, support: &SupportSurface) -> Vec<RawEdge> {
    let places = |e: &RawEdge| -> Option<[Vec3; 3]> {
        let [a] = &e.path[..] else { return None };
        Some([0.0, 0.5, 1.0].map(|s| a.curve.point(a.from + s * (a.to - a.from))))
    };
    let flat = |e: &RawEdge| -> Option<[Vec3; 3]> {
        let (t, [a]) = (e.trace.as_ref()?, &e.path[..]) else { return None };
        Some([a.from, 0.5 * (a.from + a.to), a.to].map(|x| t.curve.point(x)))
    };
    let along = |[a, m, b]: [Vec3; 3], [c, n, d]: [Vec3; 3]| {
        let near = SAME_POINT * (b - a).norm().max((m - a).norm());
        (a - d).norm() <= near && (b - c).norm() <= near && (m - n).norm() <= near
    };
    // The two sides of a seam are one curve in space, but not on the surface.
    let simple = matches!(support, SupportSurface::Plane(_) | SupportSurface::Sphere { .. });
    let one = |e: &RawEdge, f: &RawEdge| {
        let same = |p: Option<[Vec3; 3]>, q: Option<[Vec3; 3]>| p.zip(q).is_some_and(|(p, q)| along(p, q));
        same(places(e), places(f)) && (simple || same(flat(e), flat(f)))
    };
    for i in 0..edges.len().min(MOST_SLITS) {
        if let Some(j) = (i + 1..edges.len().min(MOST_SLITS)).find(|&j| one(&edges[i], &edges[j])) {
            edges[j].entity = edges[i].entity;
            edges[j].forward = !edges[i].forward;
        }
    }
    edges
}

/// Edges of a loop among which slits are looked for, each with each.
const MOST_SLITS: usize = 200;
