//! A flat part bent back: regions of the drawing with their places in space.

use crate::geom::outline::Outline;
use crate::geom::{Vec2, Vec3};
use crate::torse::ribbon::pose::Pose;
use crate::torse::ribbon::{Ribbon, Spot};
use std::sync::{Arc, OnceLock};

/// Places so near to the border of regions (mm) are on it: what files print.
const BESIDE: f64 = 1e-6;
/// Places (mm) in space that are farther apart are two: far above what edges of bent zones are apart by the digits of tables.
const APART: f64 = 1e-2;

/// A part of the flat sheet with its place in space: a region of a ribbon.
#[derive(Clone, Debug, Default)]
pub struct Leaf {
    /// The rulings.
    pub ribbon: Ribbon,
    /// Closed polygons in the plane that bound the region: the outer one counter-clockwise, holes clockwise.
    pub loops: Vec<Vec<Vec2>>,
    /// What tells where points lie in these; made when it is asked first.
    outline: Arc<OnceLock<Outline>>,
}

impl PartialEq for Leaf {
    fn eq(&self, other: &Self) -> bool {
        self.ribbon == other.ribbon && self.loops == other.loops
    }
}

impl Leaf {
    /// A region of a ribbon.
    pub(super) fn new(ribbon: Ribbon, loops: Vec<Vec<Vec2>>) -> Self {
        Self { ribbon, loops, outline: Arc::default() }
    }

    fn outline(&self) -> &Outline {
        self.outline.get_or_init(|| Outline::of(&self.loops))
    }

    /// Whether it is what a sharp bend takes up inside: in space it is nothing but the edge.
    pub fn is_taken_up(&self) -> bool {
        self.ribbon.spans.iter().all(|s| s.in_space.across == 0.0)
            && self.ribbon.spans.iter().any(|s| s.in_plane.across != 0.0)
    }
}

/// A flat part bent back.
#[derive(Clone, Debug, Default)]
pub struct Refolded {
    /// Its regions: one for parts that bend about one family of rulings, else one for every plane and every bend.
    pub leaves: Vec<Leaf>,
    /// Largest turn (rad) by which the table's angles differ from what its radii give; 0 where they are not compared.
    pub disagreement: f64,
    /// How the turn between the lines was found, in words.
    pub method: &'static str,
}

/// A place on a refolded part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the region.
    pub leaf: usize,
    /// Place on its ribbon.
    pub spot: Spot,
}

impl Refolded {
    /// Whether a place of the drawing belongs to one region, and to one of the skin: what a sharp bend takes up or lacks is on none
    /// or two, and so is a slit without breadth, whose sides come apart.
    pub fn is_of_one(&self, q: &Vec2) -> bool {
        let beside = self.leaves.iter().filter(|l| l.outline().any_within(q, BESIDE));
        let places: Vec<Vec3> = beside.filter_map(|l| Some(l.ribbon.frame(&l.ribbon.locate(q)?).0)).collect();
        if places.iter().any(|p| (p - places[0]).norm() > APART) {
            return false;
        }
        let mut holding = self.leaves.iter().filter(|l| l.outline().holds(q));
        let first = holding.next();
        first.is_none_or(|l| !l.is_taken_up()) && holding.next().is_none()
    }

    /// The place of a point of the plane: on the region that holds it, else on the nearest one. `None` where no ruling runs
    /// through it.
    pub fn locate(&self, q: &Vec2) -> Option<Place> {
        let order = |l: &Leaf| l.outline().off(q);
        let (leaf, _) = (self.leaves.iter().map(order).enumerate()).min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Place { leaf, spot: self.leaves[leaf].ribbon.locate(q)? })
    }

    /// Point in space and frame of a place.
    pub fn frame(&self, place: &Place) -> (Vec3, Pose) {
        self.leaves[place.leaf].ribbon.frame(&place.spot)
    }
}
