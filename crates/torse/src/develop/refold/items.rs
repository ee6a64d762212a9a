//! Things of a drawing carried over one by one: curves, points and texts.

use super::artwork::{ArtworkMap, Carried, Found, Item, Off, Placed, PlacedShape, Shape, Side, Words};
use crate::geom::Vec3;

/// Share of the height of a text at which the direction in which it is read is looked at.
const BESIDE: f64 = 1e-3;

impl ArtworkMap {
    /// Carries one thing of a drawing over.
    pub fn item(&self, item: &Item, to: Side) -> Carried {
        let placed = |(part, shape): (usize, PlacedShape)| Placed {
            part: self.parts[part].name.clone(),
            style: item.style.clone(),
            shape,
        };
        let one = |found: Result<(usize, PlacedShape), f64>| match found {
            Ok(found) => Carried { placed: vec![placed(found)], off: None },
            Err(farthest) => Carried { placed: Vec::new(), off: Some(Off { length: 0.0, farthest }) },
        };
        match &item.shape {
            Shape::Curves(curves) => {
                let (lines, off) = self.followed(curves, to);
                Carried { placed: lines.into_iter().map(placed).collect(), off }
            }
            Shape::Point(x) => one(self.on(x, to).map(|f| (f.part, PlacedShape::Point(f.place)))),
            Shape::Words(words) => one(self.words(words, to)),
        }
    }

    /// The place of a point on a part; how far off it is where it is on none.
    fn on(&self, x: &Vec3, to: Side) -> Result<Found, f64> {
        let found = self.nearest(x, to);
        let off = found.map_or(f64::INFINITY, |f| f.off);
        found.filter(|f| f.off <= self.within).ok_or(off)
    }

    /// A text: its place, and the directions in which places beside it along its line and above it go.
    fn words(&self, words: &Words, to: Side) -> Result<(usize, PlacedShape), f64> {
        let here = self.on(&words.at, to)?;
        let step = BESIDE * words.height;
        let ahead = |way: Vec3| {
            let one = |sign: f64| {
                let there = self.nearest(&(words.at + way * (sign * step)), to).filter(|f| f.part == here.part)?;
                ((there.place - here.place) * sign).try_normalize(BESIDE * step)
            };
            // Beside an edge the other way leads on.
            one(1.0).or_else(|| one(-1.0))
        };
        let level = |v: Vec3| if to == Side::Flat { Vec3::new(v.x, v.y, 0.0) } else { v };
        let way = ahead(words.way).or_else(|| level(words.way).try_normalize(BESIDE)).unwrap_or_else(Vec3::x);
        let up = ahead(words.normal.cross(&words.way));
        let normal = match to {
            Side::Flat => Vec3::z(),
            Side::Space => up.and_then(|up| way.cross(&up).try_normalize(BESIDE)).unwrap_or(words.normal),
        };
        Ok((here.part, PlacedShape::Words(Words { at: here.place, way, normal, ..words.clone() })))
    }
}
