//! A panel of a part, or a face, with its map to the plane: the image of every ruling, and the rulings through a point.

use crate::develop::map::Development;
use crate::develop::unfold::placed_face::PlacedFace;
use crate::develop::unfold::region::Motion;
use crate::geom::{Vec2, Vec3};
use crate::spline::surface::Surface;

/// Stations over every span of knots at least.
const STATIONS: usize = 6;
/// A panel's rulings are known a little beyond its borders, by this share of their range: trims touch the last ruling.
const BEYOND: f64 = 1e-3;
/// Steps by which the ruling through a point is found: each halves what is left or does better.
const STEPS: usize = 60;

/// How a panel is laid in the plane.
pub(super) enum Image<'a> {
    /// Its patch by its own development, and a motion of the image within the part.
    Developed(&'a Surface, Box<Development>, Motion),
    /// A face as its own map lays it.
    Face(&'a PlacedFace),
}

/// A panel and its map.
pub(super) struct MappedPanel<'a> {
    pub image: Image<'a>,
    /// Rulings at which it begins and ends.
    pub range: (f64, f64),
    /// Parameters of rulings, rising, with the ends of their images; the first and the last lie a little beyond the panel. None of
    /// plane faces.
    pub rows: Vec<(f64, [Vec2; 2])>,
}

impl<'a> MappedPanel<'a> {
    /// A panel whose map has a domain, between two rulings.
    pub fn new(image: Image<'a>, (a, b): (f64, f64), range: (f64, f64), stations: usize) -> Self {
        let mut out = Self { image, range, rows: Vec::new() };
        let more = BEYOND * (range.1 - range.0);
        let (lo, hi) = ((range.0 - more).max(a), (range.1 + more).min(b));
        let mut ends = match &out.image {
            Image::Developed(patch, ..) => patch.knots_u.breaks(),
            Image::Face(f) => f.placed.chart.breaks(),
        };
        ends.retain(|t| *t > range.0 && *t < range.1);
        ends.extend([range.0, range.1]);
        ends.sort_by(f64::total_cmp);
        let parts = STATIONS.max(stations.div_ceil(ends.len()));
        let mut all: Vec<f64> = ends
            .windows(2)
            .flat_map(|w| (0..parts).map(move |k| w[0] + (w[1] - w[0]) * k as f64 / parts as f64))
            .collect();
        all.push(range.1);
        all.extend((hi > range.1).then_some(hi));
        if lo < range.0 {
            all.insert(0, lo);
        }
        out.rows = all.into_iter().map(|t| (t, out.ends(t))).collect();
        out
    }

    /// A face between its first and its last ruling.
    pub fn of_face(face: &'a PlacedFace, stations: usize) -> Self {
        let breaks = face.placed.chart.breaks();
        match (breaks.first(), breaks.last()) {
            (Some(a), Some(b)) => Self::new(Image::Face(face), (*a, *b), (*a, *b), stations),
            _ => Self { image: Image::Face(face), range: (0.0, 0.0), rows: Vec::new() },
        }
    }

    pub fn patch(&self) -> Option<&'a Surface> {
        match self.image {
            Image::Developed(patch, ..) => Some(patch),
            Image::Face(_) => None,
        }
    }

    pub fn face(&self) -> Option<&'a PlacedFace> {
        match self.image {
            Image::Developed(..) => None,
            Image::Face(face) => Some(face),
        }
    }

    /// Both ends of a ruling in space; not numbers where there is none.
    pub fn in_space(&self, t: f64) -> [Vec3; 2] {
        match &self.image {
            Image::Developed(patch, ..) => [patch.point(t, 0.0), patch.point(t, 1.0)],
            Image::Face(f) => {
                let image = f.placed.chart.ruling_image(t, f.region.reach);
                image.map_or([Vec3::repeat(f64::NAN); 2], |i| i.0)
            }
        }
    }

    /// Both ends of its image; not numbers where there is none.
    pub fn ends(&self, t: f64) -> [Vec2; 2] {
        match &self.image {
            Image::Developed(_, development, motion) => [0.0, 1.0].map(|v| motion.apply(&development.map(t, v))),
            Image::Face(f) => {
                let image = f.placed.chart.ruling_image(t, f.region.reach);
                image.map_or([Vec2::repeat(f64::NAN); 2], |i| i.1.map(|p| f.placed.motion.apply(&p)))
            }
        }
    }

    /// Rulings through a point of the plane, with the share along each.
    pub fn through(&self, q: &Vec2, same: f64) -> Vec<(f64, f64)> {
        // Distance from the line of a ruling, with its side.
        let off = |[a, b]: &[Vec2; 2]| {
            let d = b - a;
            d.perp(&(q - a)) / d.norm()
        };
        let share = |[a, b]: &[Vec2; 2]| (b - a).dot(&(q - a)) / (b - a).norm_squared();
        let mut out = Vec::new();
        for w in self.rows.windows(2) {
            let (mut x, mut y) = ((w[0].0, off(&w[0].1)), (w[1].0, off(&w[1].1)));
            if (x.1 > 0.0) == (y.1 > 0.0) {
                continue;
            }
            let mut t = x.0;
            for k in 0..STEPS {
                // Regula falsi, and now and then a halving.
                t = if k % 3 == 2 { 0.5 * (x.0 + y.0) } else { x.0 - x.1 * (y.0 - x.0) / (y.1 - x.1) };
                let here = off(&self.ends(t));
                if here == 0.0 || t <= x.0 || t >= y.0 {
                    break;
                }
                if (here > 0.0) == (x.1 > 0.0) {
                    x = (t, here);
                } else {
                    y = (t, here);
                }
                if y.0 - x.0 <= f64::EPSILON * (x.0.abs() + y.0.abs()) {
                    break;
                }
            }
            out.push((t, share(&self.ends(t))));
        }
        let ends = [self.rows.first(), self.rows.last()].into_iter().flatten();
        out.extend(ends.filter(|r| off(&r.1).abs() <= same).map(|r| (r.0, share(&r.1))));
        out
    }
}
