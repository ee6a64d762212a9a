//! What distances are taken from: surfaces, or a mesh of triangles
//! \[MKC09\].

use super::region::{BorderPlace, Region};
use crate::brep::project::{refine, SurfaceProjector};
use crate::certify::tensor::{about, Jet2, Tensor};
use crate::certify::vector::length;
use crate::geom::box_tree::{nearest_on_triangle, BoxTree};
use crate::geom::cloud::Cloud;
use crate::geom::{BBox, Vec3};
use crate::num::interval::Interval;
use crate::spline::surface::Surface;

/// A place of the ground near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// Index of the surface or triangle.
    pub of: usize,
    /// Parameters; for triangles the shares of the second and the third corner.
    pub at: [f64; 2],
    /// Distance, mm.
    pub distance: f64,
    /// The place of the border that it is, where what counts of the surface ends there.
    pub border: Option<BorderPlace>,
}

/// A linear map from a cell, about its middle, into the parameters of a piece of the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    /// Image of the middle.
    pub at: [f64; 2],
    /// Derivatives by both parameters of the cell.
    pub slopes: [[f64; 2]; 2],
    /// Half of the cell's extents.
    pub half: [f64; 2],
}

impl Affine {
    /// Image of a box about the middle.
    pub fn image(&self, [x, y]: [Interval; 2]) -> [Interval; 2] {
        let point = |d: usize| Interval::point(self.at[d]);
        let slope = |k: usize, d: usize| Interval::point(self.slopes[k][d]);
        [0, 1].map(|d: usize| point(d) + slope(0, d) * x + slope(1, d) * y)
    }

    /// Range of a form of the parameters over the image of a box about the middle.
    fn form(&self, form: [f64; 2], box_: [Interval; 2]) -> Interval {
        let of = |p: [f64; 2]| Interval::point(p[0]) * form[0] + Interval::point(p[1]) * form[1];
        of(self.at) + of(self.slopes[0]) * box_[0] + of(self.slopes[1]) * box_[1]
    }

    /// How far the image reaches from its middle along a form of the parameters.
    fn reach(&self, form: [f64; 2]) -> f64 {
        (0..2).map(|k| (form[0] * self.slopes[k][0] + form[1] * self.slopes[k][1]).abs() * self.half[k]).sum()
    }
}

/// A surface to be near.
struct GroundFace<'a> {
    surface: &'a Surface,
    tensor: Tensor<'a, 4>,
    projector: SurfaceProjector,
    bbox: BBox,
    /// Least and greatest parameters.
    domain: [[f64; 2]; 2],
    /// What of it counts; none: all of it.
    region: Option<Region<'a>>,
}

/// The ground.
pub(super) struct Ground<'a>(Kind<'a>);

enum Kind<'a> {
    /// Surfaces.
    Surfaces(Vec<GroundFace<'a>>),
    /// Triangles.
    Mesh {
        /// The points and triangles.
        cloud: &'a Cloud,
        /// Boxes of the triangles.
        tree: BoxTree,
        /// Positions are relative to this in proofs.
        origin: [f64; 3],
    },
}

/// The barycentric shares of a triangle as forms of the shares of its second and third corner: a number and two factors;
/// and a direction in which the form falls while both others grow alike.
const SHARES: [(f64, [f64; 2], [f64; 2]); 3] =
    [(1.0, [-1.0, -1.0], [0.5, 0.5]), (0.0, [1.0, 0.0], [-1.0, 0.5]), (0.0, [0.0, 1.0], [0.5, -1.0])];
/// Places may be beyond a side by this share of the parameters: rounding, which is paid for.
const ROUNDING: f64 = 1e-13;
/// Share of that which maps are made to keep to.
const KEPT: f64 = 0.1;

/// Sides of a triangle that bind at once are met one after the other, so many times.
const PASSES: usize = 8;

impl<'a> Ground<'a> {
    /// Surfaces with their whole domains; in proofs positions are relative to `origin`.
    pub fn surfaces(all: Vec<&'a Surface>, origin: [f64; 3]) -> Self {
        Self::faces(all.into_iter().map(|s| (s, &[][..])), origin)
    }

    /// Surfaces, and what closed polygons of their parameter planes wind about; without polygons all of them.
    pub fn faces(all: impl Iterator<Item = (&'a Surface, &'a [Vec<[f64; 2]>])>, origin: [f64; 3]) -> Self {
        let face = |(surface, polygons): (&'a Surface, &'a [Vec<[f64; 2]>])| {
            let (u, v) = surface.domain();
            GroundFace {
                surface,
                tensor: Tensor::new([&surface.knots_u, &surface.knots_v], about(&surface.control, origin)),
                projector: SurfaceProjector::new(surface),
                bbox: surface.bbox(),
                domain: [[u.0, u.1], [v.0, v.1]],
                region: Region::new(surface, polygons),
            }
        };
        Self(Kind::Surfaces(all.map(face).collect()))
    }

    /// Triangles; `None` where there are none, or one names a point that is not there.
    pub fn mesh(cloud: &'a Cloud, origin: [f64; 3]) -> Option<Self> {
        let n = cloud.points.len();
        if cloud.triangles.is_empty() || cloud.triangles.iter().flatten().any(|&i| i as usize >= n) {
            return None;
        }
        let boxes = |k: usize| BBox::of(corners(cloud, k).iter());
        Some(Self(Kind::Mesh { cloud, tree: BoxTree::new(cloud.triangles.len(), &boxes), origin }))
    }

    /// A place near a point: from a place found near by, or anew where that is farther than `far` (mm).
    pub(super) fn foot(&self, x: &Vec3, near: Option<&Foot>, far: f64) -> Option<Foot> {
        match &self.0 {
            Kind::Surfaces(faces) => {
                let local = near.filter(|n| n.of < faces.len()).map(|n| faces[n.of].counted(n.of, x, n.at));
                if let Some(local) = local.filter(|l| l.distance <= far) {
                    return Some(local);
                }
                let mut order: Vec<(f64, usize)> =
                    faces.iter().enumerate().map(|(k, f)| (outside(&f.bbox, x), k)).collect();
                order.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut best = local;
                for (off, of) in order {
                    if best.is_some_and(|b| off >= b.distance) {
                        break;
                    }
                    let found = faces[of].projector.nearest(faces[of].surface, x);
                    let found = faces[of].counted(of, x, found.at);
                    if best.is_none_or(|b| found.distance < b.distance) {
                        best = Some(found);
                    }
                }
                best
            }
            Kind::Mesh { cloud, tree, .. } => {
                let place = |k: usize| {
                    let c = corners(cloud, k);
                    let s = nearest_on_triangle(x, c);
                    (s, c[0] * s[0] + c[1] * s[1] + c[2] * s[2])
                };
                let (of, sq) = tree.nearest(x, &|k| (place(k).1 - x).norm_squared())?;
                let (s, _) = place(of);
                Some(Foot { of, at: [s[1], s[2]], distance: sq.sqrt(), border: None })
            }
        }
    }

    /// Parameters of a place near a point on one piece.
    pub(super) fn on(&self, of: usize, x: &Vec3, start: [f64; 2]) -> [f64; 2] {
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].refined(of, x, start).at,
            Kind::Mesh { cloud, .. } => {
                let s = nearest_on_triangle(x, corners(cloud, of));
                [s[1], s[2]]
            }
        }
    }

    /// The map made narrower, so that its image stays inside the piece.
    pub(super) fn kept(&self, of: usize, mut map: Affine) -> Affine {
        match &self.0 {
            Kind::Surfaces(faces) => {
                for (d, [lo, hi]) in faces[of].domain.into_iter().enumerate() {
                    let reach = map.reach(if d == 0 { [1.0, 0.0] } else { [0.0, 1.0] });
                    let (from, to) = ((map.at[d] - reach).max(lo), (map.at[d] + reach).min(hi));
                    let factor = if reach > 0.0 { (0.5 * (to - from) / reach).clamp(0.0, 1.0) } else { 0.0 };
                    if factor < 1.0 {
                        map.at[d] = (0.5 * (from + to)).clamp(lo, hi);
                        map.slopes.iter_mut().for_each(|s| s[d] *= factor);
                    }
                }
            }
            Kind::Mesh { .. } => {
                for _ in 0..PASSES {
                    for (number, form, away) in SHARES {
                        let here = (number + form[0] * map.at[0] + form[1] * map.at[1]).max(0.0);
                        let reach = map.reach(form);
                        if reach > here {
                            let less = 1.0 - here / reach;
                            for s in &mut map.slopes {
                                let along = form[0] * s[0] + form[1] * s[1];
                                // Along the direction the form falls by one, so that this takes a share of its slope away.
                                (0..2).for_each(|d| s[d] += less * along * away[d]);
                            }
                        }
                    }
                }
                // Where two sides bind and do not agree, as at corners: less of everything.
                for (number, form, _) in SHARES {
                    let here = (number + form[0] * map.at[0] + form[1] * map.at[1]).max(0.0);
                    let reach = map.reach(form);
                    if reach > here + KEPT * ROUNDING {
                        map.slopes.iter_mut().flatten().for_each(|s| *s *= here / reach);
                    }
                }
            }
        }
        map
    }

    /// Whether all places of a box count.
    pub(super) fn contains(&self, of: usize, image: &[Interval; 2]) -> bool {
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].region.as_ref().is_none_or(|r| r.contains(image)),
            Kind::Mesh { .. } => true,
        }
    }

    /// Encloses the parameters of a foot, which counts, and what is to be paid (mm) where they are beyond the surface; `None`
    /// if it does not count surely.
    pub(super) fn alone(&self, foot: &Foot) -> Option<([Interval; 2], f64)> {
        let Kind::Surfaces(faces) = &self.0 else { return None };
        let face = &faces[foot.of];
        let region = face.region.as_ref()?;
        let place = match foot.border {
            Some(place) => region.enclosure(place),
            None => Some(foot.at.map(Interval::point)).filter(|p| region.contains(p))?,
        };
        Some((place, face.beyond(place, &face.tensor.over(place).affine())))
    }

    /// What is to be paid (mm) for places of a cell that are mapped beyond the border, where that is near: `corners` (about the
    /// middle of the cell) are those of a polygon that holds what counts of it. `None` where nothing is known.
    pub(super) fn beside(&self, of: usize, map: &Affine, image: &[Interval; 2], corners: &[[f64; 2]]) -> Option<f64> {
        let Kind::Surfaces(faces) = &self.0 else { return None };
        let face = &faces[of];
        let region = face.region.as_ref()?;
        let place = |c: &[f64; 2]| [0, 1].map(|d: usize| map.at[d] + map.slopes[0][d] * c[0] + map.slopes[1][d] * c[1]);
        let places: Vec<[f64; 2]> = corners.iter().map(place).collect();
        let domain = face.domain.map(|[lo, hi]| Interval { lo, hi });
        let jet = face.tensor.at(map.at.map(Interval::point)).affine();
        let speeds = [length(&jet.du).hi, length(&jet.dv).hi];
        let way = region.beside(image, &places, speeds)?;
        // The way ends in what counts, which is in the domain; it begins in the image.
        let along =
            [0, 1].map(|d: usize| Interval::new(image[d].lo - way[d], image[d].hi + way[d]).intersect(domain[d]));
        let over = face.tensor.over([along[0]?, along[1]?]).affine();
        let paid = Interval::point(way[0]) * length(&over.du) + Interval::point(way[1]) * length(&over.dv);
        Some(paid.hi)
    }

    /// Over a box of parameters.
    pub(super) fn over(&self, of: usize, image: &[Interval; 2]) -> Jet2<3> {
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].tensor.over(*image).affine(),
            Kind::Mesh { cloud, origin, .. } => flat(&corners(cloud, of), origin, image),
        }
    }

    /// At a place.
    pub(super) fn at(&self, of: usize, at: &[f64; 2]) -> Jet2<3> {
        let at = at.map(Interval::point);
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].tensor.at(at).affine(),
            Kind::Mesh { cloud, origin, .. } => flat(&corners(cloud, of), origin, &at),
        }
    }

    /// Whether a box may hold a crease in it.
    pub(super) fn creased(&self, of: usize, image: &[Interval; 2]) -> bool {
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].tensor.creased(*image),
            Kind::Mesh { .. } => false,
        }
    }

    /// What is to be paid (mm) for places of the image of a box that are beyond the piece; infinite where that is no
    /// rounding.
    pub(super) fn beyond(&self, of: usize, map: &Affine, box_: [Interval; 2], over: &Jet2<3>) -> f64 {
        match &self.0 {
            Kind::Surfaces(faces) => faces[of].beyond(map.image(box_), over),
            Kind::Mesh { .. } => {
                let speeds = [length(&over.du).hi, length(&over.dv).hi];
                let way = |(number, form, _): (f64, [f64; 2], [f64; 2])| {
                    let range = map.form(form, box_) + Interval::point(number);
                    paid(-range.lo, speeds[0] + speeds[1], 1.0)
                };
                SHARES.into_iter().map(way).sum()
            }
        }
    }
}

impl GroundFace<'_> {
    fn refined(&self, of: usize, x: &Vec3, start: [f64; 2]) -> Foot {
        let mut at = refine(self.surface, x, start).at;
        for (d, [lo, hi]) in self.domain.into_iter().enumerate() {
            at[d] = at[d].clamp(lo, hi);
        }
        Foot { of, at, distance: (self.surface.point(at[0], at[1]) - x).norm(), border: None }
    }

    /// The same, on the border if it is not inside what counts of the surface.
    fn counted(&self, of: usize, x: &Vec3, start: [f64; 2]) -> Foot {
        let found = self.refined(of, x, start);
        match &self.region {
            Some(region) if !region.contains(&found.at.map(Interval::point)) => match region.nearest(self.surface, x) {
                Some((place, at, distance)) => Foot { of, at, distance, border: Some(place) },
                None => found,
            },
            _ => found,
        }
    }

    /// What is to be paid (mm) for places of a box that are beyond the domain; infinite where that is no rounding.
    fn beyond(&self, ranges: [Interval; 2], over: &Jet2<3>) -> f64 {
        let speeds = [length(&over.du).hi, length(&over.dv).hi];
        let way = |d: usize| {
            let [lo, hi] = self.domain[d];
            paid((lo - ranges[d].lo).max(ranges[d].hi - hi), speeds[d], (hi - lo).max(lo.abs().max(hi.abs())))
        };
        way(0) + way(1)
    }
}

/// What is to be paid (mm) for being beyond a limit by some `way` of parameters that are `size` large.
fn paid(way: f64, speed: f64, size: f64) -> f64 {
    match way {
        w if w <= 0.0 => 0.0,
        w if w <= ROUNDING * size => (2.0 * w * speed).next_up(),
        _ => f64::INFINITY,
    }
}

/// Distance of a point from a box.
fn outside(b: &BBox, x: &Vec3) -> f64 {
    (b.min - x).sup(&(x - b.max)).sup(&Vec3::zeros()).norm()
}

fn corners(cloud: &Cloud, k: usize) -> [Vec3; 3] {
    cloud.triangles[k].map(|i| cloud.points[i as usize])
}

/// `a + s (b − a) + t (c − a)` with derivatives.
fn flat([a, b, c]: &[Vec3; 3], origin: &[f64; 3], [s, t]: &[Interval; 2]) -> Jet2<3> {
    let zero = [Interval::ZERO; 3];
    let mut out = Jet2 { p: zero, du: zero, dv: zero, duu: zero, duv: zero, dvv: zero };
    for d in 0..3 {
        let [a, b, c] = [a, b, c].map(|p| Interval::point(p[d]));
        (out.du[d], out.dv[d]) = (b - a, c - a);
        out.p[d] = (a - Interval::point(origin[d])) + *s * out.du[d] + *t * out.dv[d];
    }
    out
}
