//! Bodies of constant thickness: which faces are the two skins of a sheet, which are its edges, and what else there is.
//!
//! *Method*: from places inside every face the nearest face on the other side of the material is sought, as planes,
//! coaxial cylinders and cones, or offsets of other developables; the distance that most area agrees on is the
//! thickness. A skin grows from the largest face over its edges to faces that have a partner at that distance, and
//! leaves out those that also touch the other skin there: these are the edges of the sheet.

use super::chart::Chart;
use super::region::FlatRegion;
use crate::brep::area::area_estimate;
use crate::brep::body::{Body, SMOOTH};
use crate::brep::project::SurfaceProjector;
use crate::brep::recognised_surface::{outward, RecognisedSurface};
use crate::geom::{Frame, Vec3};
use std::collections::HashSet;

/// A sheet found in a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySheet {
    /// Thickness, mm; 0 for open surfaces.
    pub thickness: f64,
    /// Thickness at every face of the body, mm: another one where faces that go on smoothly are thinned.
    pub local: Vec<f64>,
    /// Largest difference of distances found from the thickness, mm.
    pub spread: f64,
    /// Faces of both skins; the second is empty for open surfaces.
    pub skins: [Vec<usize>; 2],
    /// Faces that are neither skin nor edge of the sheet.
    pub others: Vec<usize>,
    /// Further faces that lie opposite others at the thickness and are broader than sides, with these: parts of the sheet that
    /// either skin must have.
    pub broad: Vec<(usize, Vec<usize>)>,
}

/// Why a body is no sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum SheetError {
    /// No distance is that of most of the body.
    #[error("the body has no constant thickness: {}; unroll its faces as open surfaces instead if that is what they are", distances(.0))]
    NoThickness(Vec<[f64; 2]>),
    /// No faces.
    #[error("the body has no faces")]
    Empty,
}

/// The distances found, in words.
fn distances(found: &[[f64; 2]]) -> String {
    match found {
        [] => "no two of its faces lie opposite each other".into(),
        [one] => format!("the only distance between opposite faces, {:.3} mm, holds for {:.0} % of it", one[0], one[1]),
        [a, b, ..] => format!(
            "the most frequent distances between opposite faces are {:.3} mm ({:.0} % of its area) and {:.3} mm ({:.0} %){}",
            a[0],
            a[1],
            b[0],
            b[1],
            if a[1] < 100.0 * ENOUGH_AREA { "" } else { TORN }
        ),
    }
}

/// What is the matter with a body most of which has one thickness.
const TORN: &str =
    "; where it has the first, its sides do not hang together: a bend whose radii differ by something else than \
                    the thickness, or have no common axis, breaks the sheet";
/// Distances that differ by less than this share of themselves are one thickness.
const SAME_THICKNESS: f64 = 1e-3;

/// Whether a distance (mm) between skins is the thickness of a sheet.
pub(crate) fn is_thickness(distance: f64, thickness: f64) -> bool {
    (distance - thickness).abs() <= SAME_THICKNESS * thickness
}
/// Directions that differ by less (rad) are parallel.
const PARALLEL: f64 = 1e-5;
/// Offsets of general faces must look back at the face within this angle, rad.
const FACING: f64 = 1e-3;
/// Axes may be apart by this share of the distance of two round faces: the thickness there then varies by that.
const ECCENTRIC: f64 = 0.02;
/// Areas that differ by less than this share of them are alike.
pub(super) const ALIKE: f64 = 1e-9;
/// Share of the places of a face that must have a partner.
const ENOUGH_PLACES: f64 = 0.25;
/// Share of the body's area that skins and edges must have together …
const ENOUGH_AREA: f64 = 0.7;
/// … and of that the skins alone, or the body is rather a block.
const ENOUGH_SKIN: f64 = 0.4;

/// What lies opposite a face.
#[derive(Clone, Debug, Default)]
struct Opposite {
    /// Faces found with distance, one for each place that found any.
    hits: Vec<(usize, f64)>,
    places: usize,
}

/// The sheet that a body is.
///
/// # Errors
/// A body without constant thickness, with the two most frequent distances.
pub fn sheet(body: &Body) -> Result<BodySheet, SheetError> {
    if body.faces.is_empty() {
        return Err(SheetError::Empty);
    }
    let count = body.faces.len();
    if is_open(body) {
        return Ok(open(body));
    }
    let areas: Vec<f64> = body.faces.iter().map(|f| area_estimate(f)).collect();
    let whole: f64 = areas.iter().sum();
    let opposite = opposite(body);
    let found = frequent(&opposite, &areas);
    let Some(&[thickness, _]) = found.first() else { return Err(SheetError::NoThickness(Vec::new())) };
    let refused = || {
        let shares = found.iter().take(2).map(|d| [d[0], 100.0 * d[1] / whole]).collect();
        SheetError::NoThickness(shares)
    };
    let near = |d: f64| is_thickness(d, thickness);
    let partners: Vec<Partners> = opposite.iter().map(|o| Partners::of(o, thickness)).collect();
    let paired = (0..count).filter(|k| near(partners[*k].distance));
    // Of faces that are alike the first, so that copies of a body are drawn alike.
    let larger = |a: usize, b: usize| if areas[b] > areas[a] * (1.0 + ALIKE) { b } else { a };
    let Some(start) = paired.reduce(larger) else { return Err(refused()) };
    let first = grown(body, start, &partners, thickness);
    let across = partners[start].faces.iter().copied().max_by(|a, b| areas[*a].total_cmp(&areas[*b]));
    let second = across.map_or_else(Vec::new, |a| grown(body, a, &partners, thickness));
    let skin: HashSet<usize> = first.iter().chain(&second).copied().collect();
    let others: Vec<usize> = (0..count).filter(|k| !skin.contains(k) && !is_edge(body, *k, &first, &second)).collect();
    let area = |faces: &[usize]| faces.iter().map(|k| areas[*k]).sum::<f64>();
    let known = whole - area(&others);
    let skins = area(&first) + area(&second);
    if known < ENOUGH_AREA * whole || skins < ENOUGH_SKIN * known {
        return Err(refused());
    }
    let off = opposite.iter().flat_map(|o| &o.hits).filter(|h| near(h.1)).map(|h| (h.1 - thickness).abs());
    let spread = off.fold(0.0, f64::max);
    let local = partners.iter().map(|p| if p.faces.is_empty() { thickness } else { p.distance }).collect();
    // Sides are no broader than the thickness.
    let is_broad = |k: usize| 2.0 * areas[k] > thickness * body.of_face(k).map(|h| body.halves[h].length).sum::<f64>();
    let broad = (0..count).filter(|k| near(partners[*k].distance) && is_broad(*k) && !others.contains(k));
    let broad = broad.map(|k| (k, partners[k].faces.iter().copied().collect())).collect();
    Ok(BodySheet { thickness, local, spread, skins: [first, second], others, broad })
}

/// Sides that differ from a right angle by less (rad) are square: a degree.
const SQUARE: f64 = std::f64::consts::PI / 180.0;
/// Places along an edge, as shares of it, where sides are looked at.
const LOOKS: [f64; 4] = [0.13, 0.38, 0.63, 0.88];

impl BodySheet {
    /// Faces of the sheet that one skin, of these faces, has on neither side.
    pub fn unreached(&self, skin: &HashSet<usize>) -> Vec<usize> {
        let mut out: Vec<usize> = Vec::new();
        for (face, opposite) in &self.broad {
            let has = |k: &usize| skin.contains(k) || out.contains(k);
            if !has(face) && !opposite.iter().any(has) {
                out.push(*face);
            }
        }
        out
    }

    /// A skin with the broad faces that lie opposite the other one and that it did not grow to, then with those that are on neither
    /// side: all of the sheet, seen from there.
    pub fn whole_skin(&self, side: usize) -> Vec<usize> {
        let [own, other] = [&self.skins[side], &self.skins[1 - side]];
        let beside = |(face, opposite): &&(usize, Vec<usize>)| {
            let is_new = !own.contains(face) && !other.contains(face);
            is_new && opposite.iter().any(|o| other.contains(o)) && !opposite.iter().any(|o| own.contains(o))
        };
        let mut out = own.clone();
        out.extend(self.broad.iter().filter(beside).map(|b| b.0));
        out.extend(self.unreached(&out.iter().copied().collect()));
        out
    }

    /// Sides of a sheet that are not square to it: bevels, countersinks, steps, slanting holes. Its outlines are those of one
    /// skin and say nothing of these.
    pub fn slanting(&self, body: &Body) -> Vec<usize> {
        if self.thickness <= 0.0 {
            return Vec::new();
        }
        let skin = |f: usize| self.skins.iter().position(|s| s.contains(&f));
        let is_side = |f: usize| skin(f).is_none() && !self.others.contains(&f);
        let touched =
            |f: usize| -> HashSet<usize> { body.of_face(f).filter_map(|h| body.beyond(h)).filter_map(skin).collect() };
        let angle = |h: usize, share: f64| body.meeting_at(h, share).map(|m| m.angle);
        let leans = |h: usize| {
            let off = |s: f64| angle(h, s).is_some_and(|a| (a - std::f64::consts::FRAC_PI_2).abs() > SQUARE);
            LOOKS.into_iter().any(off)
        };
        let slants = |f: usize| {
            let own = touched(f);
            body.of_face(f).any(|h| match body.beyond(h) {
                Some(g) if skin(g).is_some() => leans(h),
                // A step: from here the other skin is reached over another side, past an edge.
                Some(g) if is_side(g) => {
                    own.len() == 1 && touched(g).is_disjoint(&own) && angle(h, LOOKS[1]).is_some_and(|a| a >= SMOOTH)
                }
                _ => false,
            })
        };
        (0..body.faces.len()).filter(|f| is_side(*f) && slants(*f)).collect()
    }
}

/// Whether a body has edges beyond which no face of it lies, so that it is no solid.
pub fn is_open(body: &Body) -> bool {
    body.halves.iter().any(|h| h.twin.is_none() && h.length > SAME_THICKNESS * body.size)
}

/// All faces of an open body, as a sheet without thickness.
pub fn open(body: &Body) -> BodySheet {
    let developable = |k: &usize| body.recognised[*k].is_developable();
    let (skin, others) = (0..body.faces.len()).partition(developable);
    BodySheet {
        thickness: 0.0,
        local: vec![0.0; body.faces.len()],
        spread: 0.0,
        skins: [skin, Vec::new()],
        others,
        broad: Vec::new(),
    }
}

/// Faces opposite a face at one distance.
#[derive(Clone, Debug)]
struct Partners {
    faces: HashSet<usize>,
    /// The distance, mm; infinite if there are none.
    distance: f64,
}

impl Partners {
    /// Those at the thickness of the sheet, if enough places of the face find them there; else those at the distance that
    /// most places find, up to twice the thickness: thinned flanges.
    fn of(o: &Opposite, thickness: f64) -> Self {
        let at = |d: f64| -> Vec<&(usize, f64)> {
            o.hits.iter().filter(|h| (h.1 - d).abs() <= SAME_THICKNESS * d).collect()
        };
        let usual = at(thickness);
        let other = o.hits.iter().filter(|h| h.1 <= 2.0 * thickness).map(|h| at(h.1)).max_by_key(Vec::len);
        for there in std::iter::once(usual).chain(other) {
            if !there.is_empty() && there.len() as f64 >= ENOUGH_PLACES * o.places as f64 {
                return Self { distance: there[0].1, faces: there.into_iter().map(|h| h.0).collect() };
            }
        }
        Self { faces: HashSet::new(), distance: f64::INFINITY }
    }
}

/// What lies opposite every face.
fn opposite(body: &Body) -> Vec<Opposite> {
    let charts: Vec<Option<Chart>> =
        body.faces.iter().zip(&body.recognised).map(|(f, c)| Chart::of(f, c, 0.0)).collect();
    let regions: Vec<Option<FlatRegion>> =
        charts.iter().enumerate().map(|(k, c)| c.as_ref().map(|c| FlatRegion::of(body, k, c))).collect();
    let projectors: Vec<Option<SurfaceProjector>> = (body.faces.iter().zip(&body.recognised))
        .map(|(f, c)| (c.is_developable() && !is_elementary(c)).then(|| SurfaceProjector::new(&f.surface)))
        .collect();
    (0..body.faces.len())
        .map(|i| {
            let mut out = Opposite::default();
            if !body.recognised[i].is_developable() {
                return out;
            }
            for uv in places(body, i) {
                let Some(n) = outward(body.faces[i], uv) else { continue };
                let x = body.faces[i].surface.point(uv[0], uv[1]);
                out.places += 1;
                let mut best: Option<(usize, f64)> = None;
                for j in (0..body.faces.len()).filter(|j| *j != i) {
                    let (Some(chart), Some(region)) = (&charts[j], &regions[j]) else { continue };
                    let distance = match &projectors[j] {
                        Some(p) => offset_of_spline(body, j, p, (&x, &n)),
                        None => offset_of_elementary(&body.recognised[i], &body.recognised[j], chart.bulge(), (&x, &n)),
                    };
                    let Some(d) = distance.filter(|d| *d > SAME_THICKNESS * SAME_THICKNESS * body.size) else {
                        continue;
                    };
                    if best.is_none_or(|b| d < b.1) && region.contains(&chart.flat(&(x - n * d), None)) {
                        best = Some((j, d));
                    }
                }
                out.hits.extend(best);
            }
            out
        })
        .collect()
}

fn is_elementary(c: &RecognisedSurface) -> bool {
    matches!(c, RecognisedSurface::Plane(_) | RecognisedSurface::Cylinder { .. } | RecognisedSurface::Cone { .. })
}

/// Places inside a face, in its parameter plane.
fn places(body: &Body, face: usize) -> Vec<[f64; 2]> {
    let loops = body.faces[face].loops.iter();
    let loops = loops.map(|l| l.points.iter().map(|p| crate::geom::Vec2::new(p[0], p[1])).collect()).collect();
    FlatRegion::from_loops(loops).inner_points().into_iter().map(|p| [p.x, p.y]).collect()
}

/// Distance (mm) into the material from a point of a face with its outward normal to another elementary surface, if the
/// two are offsets of each other and look away from each other. `bulge` is that of the other.
fn offset_of_elementary(
    a: &RecognisedSurface,
    b: &RecognisedSurface,
    bulge: f64,
    (x, n): (&Vec3, &Vec3),
) -> Option<f64> {
    let coaxial = |f: &Frame, g: &Frame, allowed: f64| {
        f.z.cross(&g.z).norm() <= PARALLEL && f.z.cross(&(f.origin - g.origin)).norm() <= allowed
    };
    match (a, b) {
        (RecognisedSurface::Plane(_), RecognisedSurface::Plane(g)) => {
            ((n + g.z).norm() <= PARALLEL).then(|| (x - g.origin).dot(n))
        }
        (RecognisedSurface::Cylinder { frame: f, radius: r }, RecognisedSurface::Cylinder { frame: g, radius: s }) => {
            let q = f.to_local(x);
            let outside = f.vector_to_world(&crate::geom::Vec3::new(q.x, q.y, 0.0)).dot(n) > 0.0;
            let away = if outside { bulge < 0.0 } else { bulge > 0.0 };
            (coaxial(f, g, ECCENTRIC * (r - s).abs()) && away).then(|| if outside { r - s } else { s - r })
        }
        (RecognisedSurface::Cone { frame: f, half_angle: p }, RecognisedSurface::Cone { frame: g, half_angle: q }) => {
            let local = f.to_local(x);
            let outside = f.vector_to_world(&crate::geom::Vec3::new(local.x, local.y, 0.0)).dot(n) > 0.0;
            let away = if outside { bulge < 0.0 } else { bulge > 0.0 };
            let apart = (f.origin - g.origin).norm() * p.sin();
            let same = coaxial(f, g, ECCENTRIC * apart) && f.z.dot(&g.z) > 0.0;
            let out = (g.origin - f.origin).dot(&f.z) * p.sin();
            (same && (p - q).abs() <= PARALLEL && away).then_some(if outside { out } else { -out })
        }
        _ => None,
    }
}

/// The same for a face of any form: its nearest point, if it looks away from the first.
fn offset_of_spline(body: &Body, j: usize, projector: &SurfaceProjector, (x, n): (&Vec3, &Vec3)) -> Option<f64> {
    let face = body.faces[j];
    let foot = projector.nearest(&face.surface, x);
    let p = face.surface.point(foot.at[0], foot.at[1]);
    let way = (x - p).try_normalize(0.0)?;
    let m = outward(face, foot.at)?;
    ((way - n).norm() <= FACING && (m + n).norm() <= FACING).then_some(foot.distance)
}

/// Distances with the area that agrees on each, the most frequent first.
fn frequent(opposite: &[Opposite], areas: &[f64]) -> Vec<[f64; 2]> {
    let mut votes: Vec<(f64, f64)> = (opposite.iter().zip(areas))
        .flat_map(|(o, area)| o.hits.iter().map(move |h| (h.1, area / o.places as f64)))
        .collect();
    votes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<Vec<(f64, f64)>> = Vec::new();
    for v in votes {
        match groups.last_mut() {
            Some(g) if v.0 - g[0].0 <= SAME_THICKNESS * v.0 => g.push(v),
            _ => groups.push(vec![v]),
        }
    }
    let mut out: Vec<[f64; 2]> = groups
        .iter()
        .map(|g| {
            let weight: f64 = g.iter().map(|v| v.1).sum();
            [g.iter().map(|v| v.0 * v.1).sum::<f64>() / weight, weight]
        })
        .collect();
    out.sort_by(|a, b| b[1].total_cmp(&a[1]));
    out
}

/// The skin that a face belongs to.
fn grown(body: &Body, start: usize, partners: &[Partners], thickness: f64) -> Vec<usize> {
    let usual = |d: f64| (d - thickness).abs() <= SAME_THICKNESS * thickness;
    // A bend with no radius inside has no inner face.
    let around_edge = |c: &RecognisedSurface| matches!(c, RecognisedSurface::Cylinder { radius, .. } if usual(*radius));
    let mut skin = vec![start];
    let mut across: HashSet<usize> = partners[start].faces.clone();
    let mut k = 0;
    while k < skin.len() {
        let f = skin[k];
        k += 1;
        for h in body.of_face(f).collect::<Vec<_>>() {
            let Some(g) = body.beyond(h).filter(|g| !skin.contains(g) && !across.contains(g)) else { continue };
            let touches = body.of_face(g).any(|e| body.beyond(e).is_some_and(|b| partners[f].faces.contains(&b)));
            let smooth = || body.meeting(h).is_some_and(|m| m.angle < SMOOTH);
            let thinned = || !partners[g].faces.is_empty() || around_edge(&body.recognised[g]);
            if !touches && (usual(partners[g].distance) || (thinned() && smooth())) {
                skin.push(g);
                across.extend(partners[g].faces.iter().copied());
            }
        }
    }
    skin
}

/// Whether a face joins both skins, directly or over other faces of the edge: it then bounds the sheet.
fn is_edge(body: &Body, face: usize, first: &[usize], second: &[usize]) -> bool {
    let beside = |k: usize| body.of_face(k).filter_map(|h| body.beyond(h)).collect::<HashSet<usize>>();
    let near = beside(face);
    let touches = |skin: &[usize]| near.iter().any(|g| skin.contains(g));
    if touches(first) && touches(second) {
        return true;
    }
    // Edges in two steps: chamfers, and the two halves of stepped holes.
    let reach = |skin: &[usize]| {
        touches(skin)
            || near
                .iter()
                .any(|g| !first.contains(g) && !second.contains(g) && beside(*g).iter().any(|h| skin.contains(h)))
    };
    (touches(first) || touches(second)) && reach(first) && reach(second)
}
