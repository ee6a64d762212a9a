//! Sheets drawn as bodies: two skins at one distance, the thickness of the sheet, and sides between them.
//!
//! Rays from every face go into the body, square to the face. Faces behind which others lie opposite, always equally far,
//! are skins; those that are joined along edges of the file are one. Measured on triangles, not proven.

use super::outside::Hull;
use super::triangulate::triangulate;
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::num::hash::HashMap;
use crate::num::parallel;

/// A sheet of constant thickness.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetSkins {
    /// Thickness, mm.
    pub thickness_estimate: f64,
    /// Indices of the faces of the larger skin.
    pub outer: Vec<usize>,
    /// Indices of the faces of the other one.
    pub inner: Vec<usize>,
    /// Indices of all other faces.
    pub sides: Vec<usize>,
}

/// A skin of a sheet of constant thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skin {
    /// The larger one.
    Outer,
    /// The smaller one.
    Inner,
}

/// Lines of the triangulation of a face in each direction: a quarter of a cylinder deviates by a thousandth of its radius.
const LINES: usize = 24;
/// Rays from every face.
const RAYS: usize = 12;
/// Rays begin this share of the face's size inside it.
const BESIDE: f64 = 1e-6;
/// Cosine of the angle between a ray and the face that it meets, above which that is opposite.
const OPPOSITE: f64 = 0.98;
/// Share of the thickness by which distances may differ: triangles are a little off their faces.
const SAME: f64 = 0.05;
/// Share of the rays of a skin's face that must meet the other skin; some leave through holes.
const MET: f64 = 0.5;
/// Share of the body's area that skins have at least.
const LEAST_SKINS: f64 = 0.6;
/// Thickness against the root of a skin's area, at most: what is thicker is no sheet.
const THICKEST: f64 = 0.2;
/// Bodies of more faces are not looked at.
const MOST_FACES: usize = 2000;

/// What the rays of a face say.
struct Seen {
    /// Median distance to what lies opposite, mm.
    distance: f64,
    /// Faces met, with the distance, mm.
    opposite: Vec<(usize, f64)>,
}

/// The skins of a body, from all of its faces; `None` where it is no sheet of constant thickness.
pub fn sheet(faces: &[&Face]) -> Option<SheetSkins> {
    if faces.len() < 3 || faces.len() > MOST_FACES {
        return None;
    }
    // Small faces that cannot be triangulated so coarsely are no skins.
    let hulls: Vec<Hull> = parallel::map(faces.iter(), |f| hull(f).unwrap_or_else(Hull::none));
    // The area of the triangles will do: exact ones would take their time at outlines of many corners.
    let triangles = |h: &Hull| h.sides.iter().map(|s| s.1.norm()).sum::<f64>();
    let area =
        |(face, hull): (&&Face, &Hull)| if hull.sides.is_empty() { area_estimate(face) } else { triangles(hull) };
    let areas: Vec<f64> = parallel::map(faces.iter().zip(&hulls), area);
    let seen: Vec<Option<Seen>> = parallel::map(0..faces.len(), |k| seen(k, faces, &hulls));
    let thickness = thickness(&seen, &areas)?;
    let is_skin = |k: usize| seen[k].as_ref().is_some_and(|s| (s.distance - thickness).abs() <= SAME * thickness);
    let skins: Vec<usize> = (0..faces.len()).filter(|&k| is_skin(k)).collect();
    let total: f64 = areas.iter().sum();
    let covered: f64 = skins.iter().map(|&k| areas[k]).sum();
    if covered < LEAST_SKINS * total || thickness > THICKEST * (0.5 * covered).sqrt() {
        return None;
    }
    let side_of = two_sides(faces, &skins, &seen, thickness)?;
    let of = |side: bool| -> Vec<usize> { skins.iter().copied().filter(|k| side_of[k] == side).collect() };
    let (mut outer, mut inner) = (of(true), of(false));
    let area = |f: &[usize]| f.iter().map(|&k| areas[k]).sum::<f64>();
    if outer.is_empty() || inner.is_empty() {
        return None;
    }
    if area(&inner) > area(&outer) {
        std::mem::swap(&mut outer, &mut inner);
    }
    let sides = (0..faces.len()).filter(|&k| !is_skin(k)).collect();
    Some(SheetSkins { thickness_estimate: thickness, outer, inner, sides })
}

fn hull(face: &Face) -> Option<Hull> {
    let loops: Vec<_> = face.loops.iter().map(|l| (l.points.clone(), l.edge.clone())).collect();
    let lines = |d: usize| {
        let along = face.loops.iter().flat_map(|l| &l.points).map(|p| p[d]);
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let at = |k: usize| if k == LINES { hi } else { lo + (hi - lo) * k as f64 / LINES as f64 };
        (0..=LINES).map(at).collect::<Vec<f64>>()
    };
    Some(Hull::new(&face.surface, &triangulate(&loops, &lines(0), &lines(1)).ok()?))
}

/// Rays from a face into its body; `None` where too few meet a face opposite.
fn seen(k: usize, faces: &[&Face], hulls: &[Hull]) -> Option<Seen> {
    let sides = &hulls[k].sides;
    let size = faces[k].surface.bbox().diagonal();
    // A face's normal points out of its body.
    let out = if faces[k].reversed { -1.0 } else { 1.0 };
    let mut distances = Vec::new();
    let mut opposite = Vec::new();
    let count = RAYS.min(sides.len());
    for probe in 0..count {
        let (x, n) = &sides[(2 * probe + 1) * sides.len() / (2 * count)];
        let Some(way) = (n * -out).try_normalize(0.0) else { continue };
        let from = x + way * (BESIDE * size);
        let first = (0..hulls.len()).filter_map(|j| hulls[j].first_hit(&from, &way).map(|(far, m)| (far, m, j)));
        let Some((far, m, j)) = first.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if m.dot(&way).abs() > OPPOSITE {
            let far = far + BESIDE * size;
            distances.push(far);
            opposite.push((j, far));
        }
    }
    if (distances.len() as f64) < MET * count as f64 || distances.is_empty() {
        return None;
    }
    distances.sort_by(f64::total_cmp);
    Some(Seen { distance: distances[distances.len() / 2], opposite })
}

/// The distance at which most area has something opposite.
fn thickness(seen: &[Option<Seen>], areas: &[f64]) -> Option<f64> {
    let mut all: Vec<(f64, f64)> =
        seen.iter().zip(areas).filter_map(|(s, a)| Some((s.as_ref()?.distance, *a))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let within = |t: f64| all.iter().filter(|(d, _)| (d - t).abs() <= SAME * t).map(|d| d.1).sum::<f64>();
    // Of equals the least: widths of narrow parts are larger than thicknesses.
    let best = all.iter().map(|d| (d.0, within(d.0))).reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let near: Vec<&(f64, f64)> = all.iter().filter(|(d, _)| (d - best.0).abs() <= SAME * best.0).collect();
    Some(near[near.len() / 2].0)
}

/// Which of two sides every skin face is on: joined faces on the same, opposite faces on the other. `None` where these
/// contradict each other.
fn two_sides(faces: &[&Face], skins: &[usize], seen: &[Option<Seen>], thickness: f64) -> Option<HashMap<usize, bool>> {
    let mut by_edge: HashMap<u64, Vec<usize>> = HashMap::default();
    for &k in skins {
        let edges = faces[k].boundary.iter().flat_map(|b| b.loops.iter().flatten()).map(|e| e.entity);
        edges.filter(|&e| e != 0).for_each(|e| by_edge.entry(e).or_default().push(k));
    }
    let mut links: HashMap<usize, Vec<(usize, bool)>> = HashMap::default();
    for joined in by_edge.values() {
        for &a in joined {
            links.entry(a).or_default().extend(joined.iter().filter(|b| **b != a).map(|b| (*b, true)));
        }
    }
    for &k in skins {
        // Rays that leave through a hole may meet another flange of the same skin, farther away.
        let through =
            seen[k].iter().flat_map(|s| &s.opposite).filter(|(_, far)| (far - thickness).abs() <= SAME * thickness);
        for &(j, _) in through.filter(|(j, _)| skins.contains(j)) {
            links.entry(k).or_default().push((j, false));
            links.entry(j).or_default().push((k, false));
        }
    }
    let mut side: HashMap<usize, bool> = HashMap::default();
    for &start in skins {
        if side.contains_key(&start) {
            continue;
        }
        side.insert(start, true);
        let mut open = vec![start];
        while let Some(k) = open.pop() {
            let here = side[&k];
            for &(j, same) in links.get(&k).into_iter().flatten() {
                let there = if same { here } else { !here };
                match side.insert(j, there) {
                    None => open.push(j),
                    Some(before) if before != there => return None,
                    Some(_) => {}
                }
            }
        }
    }
    Some(side)
}
