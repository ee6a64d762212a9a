//! Images under the map of a cone by the sectors in which they lie: of edges that run along rulings, and of what is about
//! the apex.
//!
//! *Theorem.* Where the angles of a part's Bézier points about the axis are within β < π/2 of one angle, so are those of all its
//! points, for a wedge is convex; slant heights lie between a linear function and a convex one of the points, and so between
//! what these are at the Bézier points. The image lies in the sector of a ring between these two radii and angles,
//! which a quadrilateral encloses; distance from a segment is convex, and greatest in a corner. No image is farther
//! from that of the apex than its point is from the apex.

use super::guide::{widened, Guide};
use super::motion::{hull, turns};
use crate::num::interval::Interval;
use crate::patchwork::image::{ClosedMap, EdgeImage};

/// Share of a part's greatest distance from the apex below which its least one counts as none.
const INSIDE: f64 = 0.25;

/// What is known about an apex.
#[derive(Clone, Copy)]
pub(super) struct Apex {
    /// Bound of the distance from the stroke, mm.
    pub bound: f64,
    /// Whether the part begins or ends near the apex, against its length, so that halving it helps.
    pub is_inside: bool,
}

/// Distance from a line of the image of Bézier points (homogeneous, in the frame) about the point at `t`, by the
/// sector in which it lies; `None` for arcs and other maps than a cone's.
pub(super) fn ruling(guide: &Guide, image: &EdgeImage, net: &[[Interval; 4]], t: f64) -> Option<f64> {
    let ClosedMap::Cone { half_angle, behind, turn, .. } = &image.map else { return None };
    if guide.circle.is_some() {
        return None;
    }
    let middle: [f64; 2] = [0, 1].map(|d| net.iter().map(|q| q[d].mid()).sum());
    let near = middle[1].atan2(middle[0]);
    let (c, s) = (widened(near.cos()), widened(near.sin()));
    let (sin, cos) = (widened(half_angle.sin()), widened(half_angle.cos()));
    let (mut beta, mut out, mut inner) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
    for &[x, y, z, w] in net {
        let ahead = x * c + y * s;
        if ahead.lo <= 0.0 || w.lo <= 0.0 {
            return None;
        }
        beta = beta.max(widened(((y * c - x * s) / ahead).mag().atan()).hi);
        out = out.max(((z * cos + (x.sqr() + y.sqr()).sqrt() * sin) / w + Interval::point(*behind)).hi);
        inner = inner.min(((z * cos + ahead * sin) / w + Interval::point(*behind)).lo);
    }
    let angle =
        (Interval::point(near) + Interval::point(turns(image, near, t)) * widened(std::f64::consts::TAU)) * *turn;
    let beta = angle.rad() + (Interval::point(beta) * *turn).mag();
    let narrow = widened(beta.cos());
    if inner < 0.0 || beta > 1.0 || narrow.lo <= 0.0 {
        return None;
    }
    let corner = |r: Interval, side: f64| -> Option<f64> {
        let f = Interval::point(angle.mid()) + Interval::point(side * beta);
        let way = [widened(f.mid().cos()).widen(f.rad()), widened(f.mid().sin()).widen(f.rad())];
        let [off, _, ahead, _] = guide.measure(way.map(|w| w * r), [Interval::ZERO; 2])?;
        Some(guide.distance(off, ahead))
    };
    let (outer, inner) = (Interval::point(out) / narrow, Interval::point(inner));
    let corners = [(outer, 1.0), (outer, -1.0), (inner, 1.0), (inner, -1.0)];
    corners.into_iter().try_fold(0.0_f64, |m, (r, side)| Some(m.max(corner(r, side)?)))
}

/// Distance of the image of Bézier points from a stroke by how far they are from the apex; `None` for other maps than a
/// cone's.
pub(super) fn apex(guide: &Guide, image: &EdgeImage, net: &[[Interval; 4]]) -> Option<Apex> {
    let ways = ways(image, net)?;
    let [off, _, ahead, _] = guide.measure([Interval::ZERO; 2], [Interval::ZERO; 2])?;
    let far = ways.iter().map(|w| w.hi).fold(0.0, f64::max);
    let near = ways.iter().map(|w| w.lo).fold(f64::INFINITY, f64::min);
    let bound = (Interval::point(guide.distance(off, ahead)) + Interval::point(far)).hi;
    Some(Apex { bound, is_inside: near <= INSIDE * far })
}

/// A box around the image of Bézier points under the map alone by how far they are from the apex; `None` for other maps than
/// a cone's.
pub(super) fn about_apex(image: &EdgeImage, net: &[[Interval; 4]]) -> Option<[Interval; 2]> {
    let far = hull(ways(image, net)?.into_iter()).hi;
    Some([Interval::symmetric(far); 2])
}

/// Distances of Bézier points from the apex, and by how much the flat apex lies behind it.
fn ways(image: &EdgeImage, net: &[[Interval; 4]]) -> Option<Vec<Interval>> {
    let ClosedMap::Cone { behind, .. } = &image.map else { return None };
    let way = |h: &[Interval; 4]| {
        (h[3].lo > 0.0).then(|| (h[0].sqr() + h[1].sqr() + h[2].sqr()).sqrt() / h[3] + Interval::point(behind.abs()))
    };
    net.iter().map(way).collect()
}
