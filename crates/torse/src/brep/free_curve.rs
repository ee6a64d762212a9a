//! What files hold beside faces: curves, points and texts that bound nothing, in millimetres.

use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::spline::curve::Curve;

/// A curve, a point or a text of a file that belongs to no face.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeCurve {
    /// How the file counts it: "object 12", "D15", "#123".
    pub item: String,
    /// Its name, or the words of a text; empty where it has none.
    pub name: String,
    /// Name of its layer; empty where it has none.
    pub layer: String,
    /// What it is.
    pub shape: FreeShape,
}

/// The shape of a [`FreeCurve`], mm.
#[derive(Clone, Debug, PartialEq)]
pub enum FreeShape {
    /// Pieces in order, homogeneous.
    Curve(Vec<Curve<4>>),
    /// A point, or where a text without a direction stands.
    Point(Vec3),
    /// A text, whose words are its name.
    Text {
        /// Where its base line begins.
        at: Vec3,
        /// Direction of its base line, a unit vector but for what a placement makes of it.
        along: Vec3,
        /// From the base line up to the top of its capitals.
        up: Vec3,
    },
}

impl FreeShape {
    /// The shape moved.
    pub(crate) fn placed(self, place: &Placement) -> Self {
        if *place == Placement::identity() {
            return self;
        }
        let moved = |h: &[f64; 4]| {
            let p = place.linear * Vec3::new(h[0], h[1], h[2]) + place.shift * h[3];
            [p.x, p.y, p.z, h[3]]
        };
        let curve = |c: Curve<4>| Curve { control: c.control.iter().map(moved).collect(), knots: c.knots };
        match self {
            Self::Curve(pieces) => Self::Curve(pieces.into_iter().map(curve).collect()),
            Self::Point(x) => Self::Point(place.point(&x)),
            Self::Text { at, along, up } => {
                Self::Text { at: place.point(&at), along: place.linear * along, up: place.linear * up }
            }
        }
    }

    /// Whether it consists of numbers, and has weights that are positive.
    pub(crate) fn is_sound(&self) -> bool {
        match self {
            Self::Curve(pieces) => {
                let sound = |h: &[f64; 4]| h.iter().all(|x| x.is_finite()) && h[3] > 0.0;
                !pieces.is_empty() && pieces.iter().all(|c| c.control.iter().all(sound))
            }
            Self::Point(x) => x.iter().all(|x| x.is_finite()),
            Self::Text { at, along, up } => [at, along, up].into_iter().flatten().all(|x| x.is_finite()),
        }
    }
}

impl FreeCurve {
    /// What people know it by: its name, else how the file counts it.
    pub fn called(&self) -> String {
        match self.name.as_str() {
            "" => self.item.clone(),
            name => format!("{} '{name}'", self.item),
        }
    }
}
