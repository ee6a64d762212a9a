//! What a judge needs to know of a flat part: edges of the file, the closed maps that lay them flat, and what is drawn
//! for them. Plain data.

use crate::geom::{Frame, Vec2, Vec3};
use crate::spline::curve::Curve;

/// A map of an elementary surface to the plane that keeps lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosedMap {
    /// Coordinates along x and y.
    Plane(Frame),
    /// Angle about z times `reach`, height along z. A negative reach mirrors.
    Cylinder {
        /// Axis z.
        frame: Frame,
        /// Radius of the face, mm.
        radius: f64,
        /// Radius of the cylinder that keeps its lengths, mm, with its sign.
        reach: f64,
    },
    /// Polar coordinates about the apex: slant plus `behind`, angle about z times `turn`.
    Cone {
        /// Apex, axis z.
        frame: Frame,
        /// Angle between axis and rulings, rad.
        half_angle: f64,
        /// Way (mm) by which the apex of the cone that keeps its lengths lies behind.
        behind: f64,
        /// Sine of the half angle, with the sign of the sense.
        turn: f64,
    },
}

impl ClosedMap {
    /// Frame of the face's surface.
    pub(crate) fn frame(&self) -> &Frame {
        match self {
            Self::Plane(frame) | Self::Cylinder { frame, .. } | Self::Cone { frame, .. } => frame,
        }
    }
}

impl ClosedMap {
    /// Angle (rad) about the axis, between −π and π, by which a point stands; any for planes.
    pub(crate) fn angle(&self, x: &Vec3) -> f64 {
        let q = self.frame().to_local(x);
        q.y.atan2(q.x)
    }

    /// Place in the plane of a point; its angle about the axis tells turns apart.
    pub(crate) fn flat(&self, x: &Vec3, angle: f64) -> Vec2 {
        let q = self.frame().to_local(x);
        match self {
            Self::Plane(_) => Vec2::new(q.x, q.y),
            Self::Cylinder { reach, .. } => Vec2::new(reach * angle, q.z),
            Self::Cone { half_angle, behind, turn, .. } => {
                let reach = q.z * half_angle.cos() + q.x.hypot(q.y) * half_angle.sin() + behind;
                let (sin, cos) = (turn * angle).sin_cos();
                Vec2::new(cos, sin) * reach
            }
        }
    }
}

/// A face, or a strip of it between two rulings, with its map and its place in the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapStrip {
    /// The map.
    pub map: ClosedMap,
    /// Turn of the plane after the map (cosine and sine).
    pub turn: [f64; 2],
    /// Move after that, mm.
    pub shift: Vec2,
    /// Parameters of the two rulings.
    pub span: [f64; 2],
    /// Whether rulings run along the first parameter of the surface.
    pub swapped: bool,
    /// Angles (rad) about the map's axis of the two rulings.
    pub angles: [f64; 2],
}

/// A part of an edge and its map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EdgeImage {
    /// Number of the face in its part.
    pub face: usize,
    /// The edge, homogeneous, mm.
    pub curve: Curve<4>,
    /// The map of its face.
    pub map: ClosedMap,
    /// Turn of the plane after the map (cosine and sine).
    pub turn: [f64; 2],
    /// Move after that, mm.
    pub shift: Vec2,
    /// Parameters of the part, in the direction drawn.
    pub part: [f64; 2],
    /// Angles about the axis at both ends, which tell turns apart; any for planes.
    pub angles: [f64; 2],
}

/// A line or arc drawn for parts of edges that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Start.
    pub start: Vec2,
    /// End.
    pub end: Vec2,
    /// tan(sweep/4), positive counter-clockwise, 0 for a line.
    pub bulge: f64,
    /// What it is drawn for, in order; empty for a line across a sharp bend, `None` where an image has no closed form.
    pub images: Option<Vec<EdgeImage>>,
}

impl Stroke {
    /// A line of which nothing is known.
    pub(crate) fn unknown(start: Vec2, end: Vec2) -> Self {
        Self { start, end, bulge: 0.0, images: None }
    }
}

/// Both images of an edge inside a part: as many lines and arcs on either side, the second side's the other way round.
pub(crate) type JointImage = [Vec<Stroke>; 2];
