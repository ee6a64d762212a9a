//! From boundary curves in space to a trimmed face: loops are traced on the surface, unwrapped over its periods,
//! closed at its poles, cut along a seam where they wind around it, and laid down as polygons of chords.
//!
//! Knows the geometry of a face as a file gives it ([`RawFace`]), but no file.

pub(crate) mod crease;
mod cut;
pub(crate) mod edge;
mod error;
mod pcurve;
mod polygon;
mod sphere;
#[cfg(test)]
mod tests;

pub(crate) use self::error::TrimError;
use self::polygon::Polygon;
use super::face::{Face, FileBoundary, FileEdge, TrimLoop};
use super::parameter_map::ParameterMap;
use super::raw::{RawFace, RawLoop, RawRegion};
use super::recast;
use super::support_surface::SupportSurface;
use crate::geom::placement::Placement;
use crate::geom::{BBox, Frame};
use crate::spline::knots::SAME_PARAMETER;
use crate::spline::surface::Surface;
use pcurve::{TracedLoop, Welds, POINT_SHARE, WHOLE_PERIOD};
use std::sync::Arc as Shared;

/// Share of the boundary's extent below which chords are no closer, whatever is asked for.
const FINEST_SHARE: f64 = 1e-9;
/// Share of the boundary's extent that chords may deviate at most.
pub(crate) const CHORD_SHARE: f64 = 1e-5;
/// Margin around the loops on support surfaces without bounds of their own, as a share of the loops' extent.
const MARGIN: f64 = 0.02;
/// Boundaries count as no smaller than this share of their surface: on a smaller one, shares of the extent would be
/// asked of digits that coordinates of that surface do not have.
const LEAST_EXTENT: f64 = 1e-6;
/// Boxes of natural parameters count as no narrower than this (rad or mm): a boundary along a parameter line has no
/// width to take shares of.
const LEAST_WIDTH: f64 = 1e-9;
/// Sine of the angle between two axes that are one.
const SAME_AXIS: f64 = 1e-6;

/// Builds the trimmed face (or faces, where the loops bound several separate regions).
///
/// *Input*: boundary curves near the support, in loops whose ends meet; `chord_tolerance` in mm, at most
/// `CHORD_SHARE` of the boundary's extent, which is the default. *Guarantee*: every answer's loops are simple polygons that do not touch
/// each other, outer first and counter-clockwise, all corners inside the surface's domain. *Not guaranteed*: the
/// deviation of the polygons from the curves is measured at samples only ([`Face::trim_deviation_estimate`]); the curves go
/// with the face ([`Face::boundary`]), so that a judge can prove it.
///
/// # Errors
/// Loops that do not bound a region; see `TrimError`.
pub(crate) fn faces(raw: &RawFace, chord_tolerance: Option<f64>) -> Result<Vec<Face>, TrimError> {
    let on_plane = on_plane(raw).and_then(|raw| faces_on(&raw, chord_tolerance, sphere::turned).ok());
    on_plane.map_or_else(|| faces_on(raw, chord_tolerance, sphere::turned), Ok)
}

/// A face of a spline that is a triangle on its plane, where it has edges to be bounded by.
fn on_plane(raw: &RawFace) -> Option<RawFace> {
    let RawRegion::Loops(loops) = &raw.region else { return None };
    let (support, off) = recast::plane_of_triangle(&raw.support)?;
    let mut loops: Vec<RawLoop> = loops.iter().cloned().flat_map(without_slits).collect();
    // Traces belong to the spline, and so do edges in its corner.
    loops.iter_mut().flat_map(|l| l.edges.iter_mut()).for_each(|e| e.trace = None);
    let size = extent(&loops);
    loops.retain(|l| extent(std::slice::from_ref(l)) > FINEST_SHARE * size);
    let surface_deviation = raw.surface_deviation.plus(off);
    Some(RawFace { support, region: RawRegion::Loops(loops), surface_deviation, ..raw.clone() })
}

/// See [`faces`], with the frame in which spheres are parametrised.
fn faces_on(
    raw: &RawFace,
    chord_tolerance: Option<f64>,
    turned: fn(&Frame, &[RawLoop]) -> Frame,
) -> Result<Vec<Face>, TrimError> {
    let loops = match &raw.region {
        RawRegion::Whole => return natural(raw, None).map(|f| vec![f]),
        RawRegion::Rectangle(r) => return natural(raw, Some(*r)).map(|f| vec![f]),
        RawRegion::Loops(loops) => loops,
    };
    let mut loops = loops.clone();
    let given = loops.iter().any(|l| !l.edges.is_empty());
    if support_has_free_seams(&raw.support) {
        loops = loops.into_iter().flat_map(without_slits).collect();
    }
    if loops.iter().all(|l| l.edges.is_empty()) {
        // Nothing but edges run there and back: seams of a sphere, but on a surface with a border no region at all.
        if given && !matches!(raw.support, SupportSurface::Sphere { .. }) {
            return Err(TrimError::NoArea);
        }
        return natural(raw, None).map(|f| vec![f]);
    }
    if !raw.same_sense {
        loops = loops.iter().map(RawLoop::reversed).collect();
    }
    let size = extent(&loops).max(LEAST_EXTENT * raw.support.size());
    let mut raw = raw.clone();
    if let SupportSurface::Sphere { frame, radius } = raw.support {
        raw.support = SupportSurface::Sphere { frame: turned(&frame, &loops), radius };
        // Traces belong to the file's axis.
        loops.iter_mut().flat_map(|l| l.edges.iter_mut()).for_each(|e| e.trace = None);
    }
    let tolerance = chord_tolerance.map_or(CHORD_SHARE * size, |t| t.min(CHORD_SHARE * size)).max(FINEST_SHARE * size);
    // A loop of the wrong sense shows by a region that is not bounded; the other sense is then tried. On a surface without border
    // both sides of a loop are bounded, and the sense says which is meant.
    let tells = raw.support.is_nearly_closed() && !loops.iter().any(|l| l.outer);
    let made = |loops: &[RawLoop]| match bounded(&raw, loops, size, tolerance, Welds::Straight) {
        // Sides that were left where they are may cross their neighbours.
        Err(first @ TrimError::SelfTouching(_)) => bounded(&raw, loops, size, tolerance, Welds::All).map_err(|_| first),
        other => other,
    };
    match made(&loops) {
        Err(first @ (TrimError::OpenWinding | TrimError::SelfTouching(_) | TrimError::NoArea)) if !tells => {
            let turned: Vec<RawLoop> = loops.iter().map(RawLoop::reversed).collect();
            made(&turned).map_err(|_| first)
        }
        other => other,
    }
}

/// A support on which an edge run in both directions is never a needed seam.
fn support_has_free_seams(c: &SupportSurface) -> bool {
    matches!(c, SupportSurface::Sphere { .. }) || c.periods() == [None, None]
}

/// Removes edges that a loop runs in both directions (seams and slits); the loop falls into several.
fn without_slits(l: RawLoop) -> Vec<RawLoop> {
    let mut done = Vec::new();
    let mut open = vec![l.edges];
    while let Some(edges) = open.pop() {
        let pair = (0..edges.len()).find_map(|i| {
            (i + 1..edges.len())
                .find(|&j| edges[i].entity == edges[j].entity && edges[i].forward != edges[j].forward)
                .map(|j| (i, j))
        });
        match pair {
            Some((i, j)) => {
                open.push(edges[i + 1..j].to_vec());
                open.push(edges[j + 1..].iter().chain(&edges[..i]).cloned().collect());
            }
            None if edges.is_empty() => {}
            None => done.push(RawLoop { edges, outer: l.outer }),
        }
    }
    done
}

/// Diagonal of the box around samples of the loops.
fn extent(loops: &[RawLoop]) -> f64 {
    let mut b = BBox::empty();
    for arc in loops.iter().flat_map(|l| &l.edges).flat_map(|e| &e.path) {
        // Between stations too: a closed curve may have its two ends only.
        for w in arc.curve.stations(arc.from, arc.to).windows(2) {
            for i in 0..=8 {
                b.include(&arc.curve.point(w[0] + (w[1] - w[0]) * f64::from(i) / 8.0));
            }
        }
    }
    b.diagonal()
}

/// The face over a rectangle of natural parameters; without one, over all of the support.
fn natural(raw: &RawFace, rectangle: Option<[(f64, f64); 2]>) -> Result<Face, TrimError> {
    let (limits, periods) = (raw.support.limits(), raw.support.periods());
    let side = |k: usize| -> Option<(f64, f64)> {
        match &raw.support {
            SupportSurface::Spline(s) => Some(if k == 0 { s.surface.domain().0 } else { s.surface.domain().1 }),
            _ => limits[k].or_else(|| periods[k].map(|p| (0.0, p))),
        }
    };
    let box_of = match rectangle {
        Some(r) => r,
        None => [side(0).ok_or(TrimError::Unbounded)?, side(1).ok_or(TrimError::Unbounded)?],
    };
    let (surface, map) = raw.support.to_spline(box_of[0], box_of[1])?;
    let [(u0, u1), (v0, v1)] = [0, 1].map(|k| (map[k].forward(box_of[k].0), map[k].forward(box_of[k].1)));
    let mut points = vec![[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
    let domain = surface.domain();
    for p in &mut points {
        *p = [p[0].clamp(domain.0 .0, domain.0 .1), p[1].clamp(domain.1 .0, domain.1 .1)];
    }
    // The sides are lines of the surface, as the file says.
    Ok(face(raw, surface, vec![TrimLoop { points, edge: vec![0, 1, 2, 3] }], 0.0, None))
}

fn face(raw: &RawFace, surface: Surface, loops: Vec<TrimLoop>, deviation: f64, boundary: Option<FileBoundary>) -> Face {
    Face {
        entity: raw.entity,
        name: raw.name.clone(),
        part: raw.part.clone(),
        body: 0,
        kind: raw.kind,
        surface,
        reversed: !raw.same_sense,
        loops,
        trim_deviation_estimate: deviation,
        surface_deviation: raw.surface_deviation,
        parts: Vec::new(),
        joint_bound: 0.0,
        // Nothing is proven of a polygon that was laid by samples.
        trim_bound: if boundary.is_some() { f64::INFINITY } else { raw.surface_deviation.bound },
        boundary: boundary.map(Shared::new),
    }
}

/// Faces from loops, their sense taken as given where it matters.
fn bounded(raw: &RawFace, loops: &[RawLoop], size: f64, tolerance: f64, welds: Welds) -> Result<Vec<Face>, TrimError> {
    let support = &raw.support;
    let periods = support.periods();
    // 1. Trace every loop in the unwrapped parameter plane.
    let mut chains = Vec::new();
    let mut edges: Vec<Vec<FileEdge>> = Vec::new();
    let mut label = 0;
    let ground = pcurve::Ground::new(support, size, raw.uncertainty);
    for l in loops {
        match pcurve::trace(&ground, l, &mut label)? {
            Some(chain) => {
                let chain = match periods {
                    [None, None] => chain,
                    _ => chain.without_slits(periods),
                };
                if chain.pcurves.is_empty() {
                    // Nothing but slits: all of the surface.
                    if loops.len() == 1 && periods.iter().all(Option::is_some) {
                        return natural(raw, None).map(|f| vec![f]);
                    }
                    continue;
                }
                edges.push(chain.edges.clone());
                chains.push(chain);
            }
            None => edges.push(pcurve::vanished(l)),
        }
    }
    edges.retain(|l| !l.is_empty());
    if chains.is_empty() {
        return Err(TrimError::Vanishing(pcurve::POINT_SHARE * size));
    }
    // 2. Bring the loops together, close winding ones at poles, choose the seam.
    let plan = cut::plan(support, &mut chains, loops.iter().any(|l| l.outer), &mut label)?;
    // 3. Choose the box, lay the chords, enlarge the box if a chord left it.
    let mut range = margins(support, &chains, &plan);
    for _ in 0..3 {
        let (surface, map) = support.to_spline(range[0], range[1])?;
        let mut deviation = 0.0;
        let mut polygons = Vec::new();
        for c in &chains {
            let p = pcurve::chords(support, c, &map, (size, tolerance), welds)?;
            deviation = p.deviation.max(deviation);
            polygons.push(p.polygon);
        }
        if let Some(seam) = &plan.seam {
            polygons = cut::cut_polygons(&polygons, &chains, seam, &map, periods, &mut label)?;
        }
        let domain = surface.domain();
        let corners = polygons.iter().flat_map(|p| p.points.iter());
        let grown = outside(corners, [domain.0, domain.1], &map, range);
        if let Some(grown) = grown.filter(|g| can_grow(support, range, *g)) {
            range = grown;
            continue;
        }
        for p in polygons.iter_mut().flat_map(|p| p.points.iter_mut()) {
            *p = [p[0].clamp(domain.0 .0, domain.0 .1), p[1].clamp(domain.1 .0, domain.1 .1)];
        }
        let mut made = regions(raw, &surface, polygons, plan.sense_matters, deviation)?;
        share_edges(&mut made, &edges, tolerance);
        return Ok(made);
    }
    Err(TrimError::Unbounded)
}

/// Box of natural parameters around the chains: a margin where the support goes on, none at its ends and poles.
fn margins(support: &SupportSurface, chains: &[TracedLoop], plan: &cut::Plan) -> [(f64, f64); 2] {
    let (limits, periods, poles) = (support.limits(), support.periods(), support.poles());
    [0, 1].map(|k| {
        if let Some(seam) = plan.seam.as_ref().filter(|s| s.axis == k) {
            return (seam.at, seam.at + periods[k].unwrap_or(0.0));
        }
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for q in chains.iter().flat_map(TracedLoop::nodes) {
            (lo, hi) = (lo.min(q[k]), hi.max(q[k]));
        }
        let width = (hi - lo).max(LEAST_WIDTH);
        let full = periods[k].is_some_and(|p| (width - p).abs() <= WHOLE_PERIOD * p);
        let pad = if full { 0.0 } else { MARGIN * width };
        let (a, b) = (lo, hi);
        (lo, hi) = (lo - pad, hi + pad);
        for p in poles.iter().filter(|p| p.axis == k) {
            let hair = POINT_SHARE * width;
            if a >= p.value - hair && lo < p.value {
                lo = p.value;
            }
            if b <= p.value + hair && hi > p.value {
                hi = p.value;
            }
        }
        match limits[k] {
            Some((a, b)) => (lo.max(a), hi.min(b)),
            None => (lo, hi),
        }
    })
}

/// A larger box if some corner lies outside the domain by more than rounding.
fn outside<'a>(
    corners: impl Iterator<Item = &'a [f64; 2]>,
    domain: [(f64, f64); 2],
    map: &[ParameterMap; 2],
    range: [(f64, f64); 2],
) -> Option<[(f64, f64); 2]> {
    let mut grown = range;
    let mut any = false;
    for c in corners {
        for k in 0..2 {
            let (a, b) = domain[k];
            let hair = SAME_PARAMETER * (b - a);
            if c[k] < a - hair || c[k] > b + hair {
                let (t, _) = map[k].inverse(c[k]);
                let pad = MARGIN * (range[k].1 - range[k].0);
                grown[k] = (grown[k].0.min(t - pad), grown[k].1.max(t + pad));
                any = true;
            }
        }
    }
    any.then_some(grown)
}

/// Whether the larger box still lies on the support.
fn can_grow(support: &SupportSurface, old: [(f64, f64); 2], new: [(f64, f64); 2]) -> bool {
    let limits = support.limits();
    (0..2).all(|k| match limits[k] {
        Some(_) => new[k] == old[k],
        None => true,
    })
}

/// Gives every face the loops of the file that it follows; loops that none follows go to the first, where they are
/// missed.
fn share_edges(faces: &mut [Face], edges: &[Vec<FileEdge>], chords: f64) {
    let labels: Vec<std::collections::HashSet<u32>> =
        faces.iter().map(|f| f.loops.iter().flat_map(|l| l.edge.iter().copied()).collect()).collect();
    let follows = |i: usize, l: &[FileEdge]| l.iter().any(|e| labels[i].contains(&e.label));
    let count = faces.len();
    for (i, f) in faces.iter_mut().enumerate() {
        let Some(b) = f.boundary.as_mut().and_then(Shared::get_mut) else { continue };
        let own = |l: &&Vec<FileEdge>| follows(i, l) || (i == 0 && !(0..count).any(|j| follows(j, l)));
        b.loops = edges.iter().filter(own).cloned().collect();
        (b.index, b.chords) = ([i, count], chords);
    }
}

/// The face with chords that keep to the file's edges within `tolerance` (mm), if those that it has do not and it can be
/// had: the trim as a job asks for it.
pub(crate) fn with_chords(face: &Face, tolerance: f64) -> Option<Face> {
    let b = face.boundary.as_ref().filter(|b| b.chords > tolerance)?;
    let made = faces(&b.source, Some(tolerance / b.placement.scale())).ok()?;
    let [index, count] = b.index;
    let finer = made.get(index).filter(|_| made.len() == count)?;
    Some(finer.placed(&b.placement, &face.part))
}

/// The part of a sphere that a face is, with the sphere's axis through the middles of the circles that bound it, which are parameter
/// lines then; chords keep to the file's edges within `tolerance` (mm). `None` where it is no such face, or has that axis.
pub(crate) fn about_its_circles(face: &Face, tolerance: f64) -> Option<Face> {
    let b = face.boundary.as_ref().filter(|_| face.parts.is_empty())?;
    let (SupportSurface::Sphere { frame, .. }, RawRegion::Loops(loops)) = (&b.source.support, &b.source.region) else {
        return None;
    };
    let loops: Vec<RawLoop> = loops.iter().cloned().flat_map(without_slits).collect();
    let turned = sphere::about_circles(frame, &loops)?;
    if turned.z.cross(&frame.z).norm() <= SAME_AXIS {
        return None;
    }
    let about = |frame: &Frame, loops: &[RawLoop]| sphere::about_circles(frame, loops).unwrap_or(*frame);
    let made = faces_on(&b.source, Some(tolerance.min(b.chords) / b.placement.scale()), about).ok()?;
    let [index, count] = b.index;
    let turned = made.get(index).filter(|_| made.len() == count)?;
    Some(turned.placed(&b.placement, &face.part))
}

/// Nests the polygons and checks them.
fn regions(
    raw: &RawFace,
    surface: &Surface,
    polygons: Vec<Polygon>,
    sense_matters: bool,
    deviation: f64,
) -> Result<Vec<Face>, TrimError> {
    let mut out = Vec::new();
    let cleaned: Vec<Polygon> = polygons.into_iter().filter_map(polygon::cleaned).collect();
    let groups = polygon::nested(cleaned, sense_matters);
    if let Some(at) = polygon::first_overlap(&groups) {
        return Err(TrimError::SelfTouching(surface.point(at[0], at[1])));
    }
    let source = Shared::new(raw.clone());
    for group in groups {
        if let Some(at) = polygon::first_contact(&group) {
            return Err(TrimError::SelfTouching(surface.point(at[0], at[1])));
        }
        let boundary = FileBoundary {
            loops: Vec::new(),
            along: group.iter().map(|p| p.edge.iter().map(|s| [s.from, s.to]).collect()).collect(),
            chords: 0.0,
            source: source.clone(),
            index: [0, 0],
            placement: Placement::identity(),
        };
        let labels = |p: &Polygon| p.edge.iter().map(|s| s.label).collect();
        let loops = group.into_iter().map(|p| TrimLoop { edge: labels(&p), points: p.points }).collect();
        out.push(face(raw, surface.clone(), loops, deviation, Some(boundary)));
    }
    if out.is_empty() {
        return Err(TrimError::NoArea);
    }
    Ok(out)
}
