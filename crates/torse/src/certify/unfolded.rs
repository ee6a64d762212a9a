//! A part laid flat: its faces against the surfaces that their maps are made for, its drawing and its inner edges
//! against the images of edges under these maps.
//!
//! *Theorem.* Faces without a closed map are laid flat through a panel, see [`UnfoldedProof::through_panel`], or in strips
//! between rulings, each a part of a circular cylinder or cone; both images of the ruling between two strips are then among
//! the inner edges. So holds: Every face, or strip of one, and every edge that is drawn of it lies within
//! `map_surface_distance` of the plane, cylinder or cone that its map lays flat. The maps
//! change no length on their surface, or on the neutral surface of a sheet, by more than the factor `1 ± strain`. Every
//! line and arc of the contours is drawn for parts of edges, or across a sharp bend, and keeps to their images within
//! `drawing_distance`, both ways. Both images of every edge inside the part lie within `joint_gap` of each other, across a
//! sharp bend after a move by its allowance. Where `in_one_layer`, the part lies in one layer but, at most, within these
//! distances of its cut and of the edges inside it: every face covers a place as often as the image of its border winds about
//! it, and windings along inner edges cancel (`flat/simple_outline.rs`).
//!
//! *Not shown*: that the contours name every edge of the file that bounds the part, and that parts of one edge follow each
//! other; the developing code takes all of them in order.

use super::claim::UpperBound;
use super::flat::simple_outline::outline_is_simple;
use super::flat::FlatCertificate;
use super::map_surface::{distance_from_map_surface, distance_of_edge, distance_of_strip, Wedge, BESIDE};
use super::strokes::{strain, strokes};
use super::trims::trim_proof;
use super::Certificate;
use crate::brep::face::Face;
use crate::geom::Vec2;
use crate::num::hash::HashMap;
use crate::num::parallel;
use crate::patchwork::image::{ClosedMap, EdgeImage, JointImage, MapStrip, Stroke};
use crate::patchwork::pattern::Pattern;
use crate::spline::curve::Curve;

/// What is judged.
#[derive(Clone, Debug)]
pub(crate) struct Unfolded<'a> {
    /// The faces, as they were read.
    pub faces: Vec<&'a Face>,
    /// Least and greatest parameters `[u0, u1, v0, v1]` of every face.
    pub bounds: Vec<[f64; 4]>,
    /// The map of every face; `None` where it has no closed form.
    pub maps: &'a [Option<ClosedMap>],
    /// Of these faces the strips that have one; of a face without any nothing is shown.
    pub strips: &'a [Vec<MapStrip>],
    /// Thickness of the sheet, mm; 0 for surfaces.
    pub thickness: f64,
    /// The drawing.
    pub pattern: &'a Pattern,
    /// What each of their lines and arcs is drawn for.
    pub strokes: &'a [Stroke],
    /// Edges inside the part.
    pub joints: &'a [JointImage],
    /// Ways (mm) by which faces are apart in the plane along sharp bends.
    pub allowances: &'a [f64],
}

/// What is proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UnfoldedProof {
    map_surface_distance: UpperBound,
    drawing_distance: UpperBound,
    joint_gap: UpperBound,
    strain: UpperBound,
    in_one_layer: bool,
}

impl UnfoldedProof {
    /// That of a part laid flat through one panel: what is proven of the panel against its face, and of the pattern against
    /// the panel.
    pub fn through_panel(panel: &Certificate, flat: &FlatCertificate) -> Self {
        let known = panel.certified && flat.holds();
        let bound = |d: f64| if known { UpperBound::shown(d) } else { UpperBound::UNKNOWN };
        Self {
            map_surface_distance: bound(panel.deviation_bound),
            drawing_distance: bound((flat.drawing_bound() + flat.change_bound()).next_up()),
            joint_gap: bound(flat.gap_bound()),
            strain: bound(flat.strain_bound()),
            // A pattern that holds is simple.
            in_one_layer: true,
        }
    }

    /// Whether everything is shown, distances within a tolerance (mm).
    pub fn is_within(&self, tolerance: f64) -> bool {
        let distances = [self.map_surface_distance, self.drawing_distance, self.joint_gap];
        distances.iter().all(|d| d.value() <= tolerance) && self.strain != UpperBound::UNKNOWN
    }

    /// Distance (mm) of faces and their edges from the surfaces that are laid flat.
    pub fn map_surface_distance(&self) -> UpperBound {
        self.map_surface_distance
    }

    /// Distance (mm) between contours and images.
    pub fn drawing_distance(&self) -> UpperBound {
        self.drawing_distance
    }

    /// Distance (mm) of both images of inner edges.
    pub fn joint_gap(&self) -> UpperBound {
        self.joint_gap
    }

    /// Whether the part is shown to lie in one layer.
    pub fn is_in_one_layer(&self) -> bool {
        self.in_one_layer
    }

    /// Relative change of lengths.
    pub fn strain(&self) -> UpperBound {
        self.strain
    }
}

/// A neutral surface lies no deeper below its face than this multiple of the sheet's thickness: flanges may be thinned or
/// thickened up to it.
const DEEPEST: f64 = 2.0;
/// Rounding of radii and places in this floor's plain arithmetic, as a share.
const ROUNDING: f64 = 1e-12;

/// Distances of edges from map surfaces below this share of the tolerance are not told apart.
const EDGE_AIM: f64 = 0.01;

/// Judges a part; `tolerance` (mm) says how fine is fine enough.
pub fn unfolded(part: &Unfolded, tolerance: f64) -> UnfoldedProof {
    let off = |face: usize| match &part.maps[face] {
        Some(m) => match distance_from_map_surface(&part.faces[face].surface, &part.bounds[face], m) {
            (bound, true) => bound.plus(UpperBound::shown(part.faces[face].surface_bound())),
            // The file's trim may go beyond the polygons that were read of it, onto what was not looked at.
            (bound, false) => bound.plus(trim_proof(part.faces[face], EDGE_AIM * tolerance).bound()),
        },
        None if are_whole(&part.strips[face], &part.bounds[face]) => {
            let from = part.strips[face].iter().map(|s| distance_of_strip(&part.faces[face].surface, s));
            UpperBound::largest(from).plus(UpperBound::shown(part.faces[face].surface_bound()))
        }
        None => UpperBound::UNKNOWN,
    };
    let count = part.faces.len();
    let map_surface_distance = match [part.maps.len(), part.strips.len(), part.bounds.len()] == [count; 3] {
        true => UpperBound::largest(parallel::map(0..count, off)),
        false => UpperBound::UNKNOWN,
    };
    let sides = || part.joints.iter().flatten().flatten();
    let images = || part.strokes.iter().chain(sides()).flat_map(|s| s.images.iter().flatten());
    // What is drawn are images of edges, which the file may have beside their faces.
    let edges: Vec<&EdgeImage> = images().collect();
    let beside = |i: &&EdgeImage| distance_of_edge(&i.curve, i.part, &i.map, EDGE_AIM * tolerance);
    let beside = UpperBound::largest(parallel::map(edges.iter(), beside));
    let map_surface_distance = map_surface_distance.max(beside);
    // Every image uses its face's map, or that of the strip it lies in, and all of a face lie in one place.
    let mut places: HashMap<usize, ([f64; 2], Vec2)> = HashMap::default();
    let known = images().all(|i| match part.maps.get(i.face) {
        Some(Some(m)) => *m == i.map && *places.entry(i.face).or_insert((i.turn, i.shift)) == (i.turn, i.shift),
        Some(None) => part.strips.get(i.face).is_some_and(|all| all.iter().any(|s| is_of_strip(i, s))),
        None => false,
    });
    let joined = part
        .strips
        .iter()
        .enumerate()
        .all(|(k, all)| all.windows(2).all(|w| has_joint(part.joints, k, [&w[0], &w[1]])));
    let known = known && joined;
    let bound = |d: f64, holds: bool| if holds && d.is_finite() { UpperBound::shown(d) } else { UpperBound::UNKNOWN };
    let maps = part.maps.iter().flatten().chain(part.strips.iter().flatten().map(|s| &s.map));
    let depths = maps.map(|m| depth_strain(m, part.thickness));
    let strained = images().map(strain).chain(depths).fold(0.0, f64::max);
    let joint = |j: &JointImage| joint_gap(j, part.allowances, tolerance);
    // Images by other maps say nothing of the drawing, and lie so far from it that looking would take minutes.
    let [drawn, gap] = match known {
        true => [
            strokes(part.strokes, part.allowances, tolerance),
            parallel::map(part.joints.iter(), joint).into_iter().fold(0.0, f64::max),
        ],
        false => [f64::INFINITY; 2],
    };
    UnfoldedProof {
        map_surface_distance,
        drawing_distance: bound(drawn, known && follows(part)),
        joint_gap: bound(gap, known),
        strain: bound(strained, known),
        in_one_layer: outline_is_simple(part.pattern, tolerance).is_ok(),
    }
}

/// Whether strips follow each other over all of a face between its least and greatest parameters.
fn are_whole(strips: &[MapStrip], bounds: &[f64; 4]) -> bool {
    let (Some(first), Some(last)) = (strips.first(), strips.last()) else { return false };
    let [lo, hi] = if first.swapped { [bounds[2], bounds[3]] } else { [bounds[0], bounds[1]] };
    let follow = |w: &[MapStrip]| w[0].span[1] == w[1].span[0] && w[0].swapped == w[1].swapped;
    first.span[0] <= lo && last.span[1] >= hi && strips.windows(2).all(follow)
}

/// Whether an image is that of an edge in a strip: with its map in its place, and all of it between the strip's two rulings.
fn is_of_strip(image: &EdgeImage, strip: &MapStrip) -> bool {
    if (image.map, image.turn, image.shift) != (strip.map, strip.turn, strip.shift) {
        return false;
    }
    let (lo, hi) = (strip.angles[0].min(strip.angles[1]), strip.angles[0].max(strip.angles[1]));
    let slack = BESIDE * (hi - lo);
    let Some(wedge) = Wedge::new(strip.map.frame(), [lo - slack, hi + slack]) else { return false };
    let (a, b) = (image.part[0].min(image.part[1]), image.part[0].max(image.part[1]));
    image.curve.restricted(a, b).is_ok_and(|c| lies_in(&c, &wedge, HALVINGS))
}

/// Whether a curve (homogeneous) lies in a wedge: its control points do, or those of its halves.
fn lies_in(curve: &Curve<4>, wedge: &Wedge, depth: usize) -> bool {
    if curve.control.iter().all(|p| wedge.contains(p)) {
        return true;
    }
    let (a, b) = curve.domain();
    let m = 0.5 * (a + b);
    let half = |a: f64, b: f64| curve.restricted(a, b).is_ok_and(|c| lies_in(&c, wedge, depth - 1));
    depth > 0 && a < m && m < b && half(a, m) && half(m, b)
}

/// Whether an inner edge joins two strips of a face.
fn has_joint(joints: &[JointImage], face: usize, strips: [&MapStrip; 2]) -> bool {
    let uses = |side: &[Stroke], strip: &MapStrip| {
        let mut images = side.iter().flat_map(|s| s.images.iter().flatten()).peekable();
        images.peek().is_some()
            && images.all(|i| i.face == face && (i.map, i.turn, i.shift) == (strip.map, strip.turn, strip.shift))
    };
    joints.iter().any(|[here, there]| uses(here, strips[0]) && uses(there, strips[1]))
}

/// Halvings of an edge until its control points lie in its strip, at most.
const HALVINGS: usize = 8;

/// Whether the lines and arcs of the contours are the strokes, bit by bit.
fn follows(part: &Unfolded) -> bool {
    let mut left = part.strokes.iter();
    let drawn = part.pattern.contours.iter().chain(&part.pattern.formed).all(|c| {
        let v = &c.vertices;
        (0..v.len()).all(|k| {
            let (from, to) = (&v[k], &v[(k + 1) % v.len()]);
            left.next().is_some_and(|s| s.start == from.point && s.end == to.point && s.bulge == from.bulge)
        })
    });
    drawn && left.next().is_none()
}

/// Relative change of lengths by a neutral surface at another depth than the sheet allows: none within the sheet.
fn depth_strain(map: &ClosedMap, thickness: f64) -> f64 {
    let (depth, size) = match map {
        ClosedMap::Plane(_) => return 0.0,
        ClosedMap::Cylinder { radius, reach, .. } => ((radius - reach.abs()).abs(), *radius),
        ClosedMap::Cone { half_angle, behind, .. } => (behind.abs() * half_angle.tan(), behind.abs()),
    };
    if depth <= DEEPEST * thickness {
        return 0.0;
    }
    if thickness > 0.0 {
        return f64::INFINITY;
    }
    match map {
        ClosedMap::Cylinder { .. } => depth / size + ROUNDING,
        // On a cone the share grows without bound towards the apex.
        _ => f64::INFINITY,
    }
}

/// Distance of both images of an inner edge: each from its own strokes, and these from each other after a move square to
/// them by an allowance.
fn joint_gap([here, there]: &JointImage, allowances: &[f64], tolerance: f64) -> f64 {
    let has_images = |s: &Stroke| s.images.as_ref().is_some_and(|i: &Vec<EdgeImage>| !i.is_empty());
    if here.len() != there.len() || here.is_empty() || !here.iter().chain(there).all(has_images) {
        return f64::INFINITY;
    }
    let apart = |(a, b): (&Stroke, &Stroke)| -> f64 {
        let chord = a.end - a.start;
        let Some(way) = chord.try_normalize(0.0) else { return f64::INFINITY };
        let (d, e): (Vec2, Vec2) = (b.end - a.start, b.start - a.end);
        let across = way.perp(&d).abs();
        let off = allowances.iter().map(|x| (x.abs() - across).abs()).fold(across, f64::min);
        // Arcs on one chord with different bulges differ by no more than the difference of their heights and ends.
        let bent = 0.5 * chord.norm() * (a.bulge + b.bulge).abs();
        off + way.dot(&d).abs() + (d - e).norm() + 2.0 * bent + ROUNDING * chord.norm()
    };
    let between = here.iter().zip(there.iter().rev()).map(apart).fold(0.0, f64::max);
    strokes(here, &[], tolerance) + strokes(there, &[], tolerance) + between
}
