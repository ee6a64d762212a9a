//! Outlines of which many points are asked where they lie: sides are found by where they are.

use super::box_tree::BoxTree;
use super::inside::Inside;
use super::polygon::sides;
use super::segment::foot;
use super::{BBox, Vec2, Vec3};

/// Closed polygons.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    sides: Vec<[Vec2; 2]>,
    tree: BoxTree,
    inside: Inside,
}

impl Outline {
    /// Of polygons whose last corner is joined to the first.
    pub fn of(loops: &[Vec<Vec2>]) -> Self {
        let all: Vec<[Vec2; 2]> = sides(loops).map(|(p, q)| [p, q]).collect();
        let boxes: Vec<BBox> = all.iter().map(BBox::of_flat).collect();
        let tree = BoxTree::new(all.len(), &|k| boxes[k]);
        Self { sides: all, tree, inside: Inside::of(loops) }
    }

    /// The nearest side whose distance is below one (mm), and the nearest point of that side.
    fn nearest_within(&self, x: &Vec2, distance: f64) -> Option<([Vec2; 2], Vec2)> {
        let on = |k: usize| foot(&self.sides[k][0], &self.sides[k][1], x);
        let off = |k: usize| (x - on(k)).norm_squared();
        let (k, _) = self.tree.nearest_within(&Vec3::new(x.x, x.y, 0.0), distance * distance, &off)?;
        Some((self.sides[k], on(k)))
    }

    /// The nearest side, and the nearest point of it.
    pub fn nearest(&self, x: &Vec2) -> Option<([Vec2; 2], Vec2)> {
        self.nearest_within(x, f64::INFINITY)
    }

    /// Whether some side is nearer than a distance (mm).
    pub fn any_within(&self, x: &Vec2, distance: f64) -> bool {
        self.nearest_within(x, distance).is_some()
    }

    /// Whether a point lies inside.
    pub fn holds(&self, x: &Vec2) -> bool {
        self.inside.holds(x)
    }

    /// Distance (mm) of a point from what lies inside.
    pub fn off(&self, x: &Vec2) -> f64 {
        match self.holds(x) {
            true => 0.0,
            false => self.nearest(x).map_or(f64::INFINITY, |(_, on)| (x - on).norm()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polygon::{distance, tests::ring};

    #[test]
    fn sides_are_as_near_as_among_all() {
        let loops = [(10.0, 700), (4.0, 50)].map(|(r, n)| ring(n, |a| Vec2::new(2.0 * a.cos(), a.sin()) * r));
        let outline = Outline::of(&loops);
        for k in 0..500 {
            let x = Vec2::new((0.37 * f64::from(k)).sin(), (0.73 * f64::from(k)).cos()) * 25.0;
            let far = distance(&loops, &x);
            let (side, on) = outline.nearest(&x).expect("a side");
            assert!(((x - on).norm() - far).abs() < 1e-12 && (foot(&side[0], &side[1], &x) - on).norm() == 0.0);
            assert!(outline.any_within(&x, far + 1e-9) && !outline.any_within(&x, far - 1e-9));
            assert!((outline.off(&x) - if outline.holds(&x) { 0.0 } else { far }).abs() < 1e-12);
        }
        let nothing = Outline::of(&[]);
        assert!(nothing.nearest(&Vec2::zeros()).is_none() && nothing.off(&Vec2::zeros()).is_infinite());
    }
}
