//! Flat cutting patterns: the drawing of a developed panel. Lengths in mm, 1:1.

use super::panel::Border;
use crate::geom::Vec2;

/// A closed contour of lines and circular arcs.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Corners and joints in order; the last is joined to the first.
    pub vertices: Vec<ContourVertex>,
}

/// A joint of a contour and the line or arc that leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourVertex {
    /// Place of the joint.
    pub point: Vec2,
    /// Bulge of the piece to the next joint: tan(sweep/4), positive counter-clockwise, 0 for a line (as in DXF).
    pub bulge: f64,
    /// Whether the outline has a real corner here (a change of run), as opposed to a joint of arcs.
    pub corner: bool,
}

/// A matching mark on a seam: both neighbours carry it at the same place of the seam, with the same label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Place on the outline.
    pub point: Vec2,
    /// Unit vector into the panel.
    pub inward: Vec2,
    /// Label, the same on both sides ("S12.3").
    pub label: String,
}

/// A stretch of the outline that follows one run of the panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// What lies beyond.
    pub border: Border,
    /// Middle of the side.
    pub middle: Vec2,
    /// Length of the side on the flat pattern, mm.
    pub length: f64,
}

/// Where a pattern goes in a drawing: turned about the origin, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Turn, counter-clockwise, rad.
    pub angle: f64,
    /// Move after the turn, mm.
    pub offset: Vec2,
}

impl Placement {
    /// The placed point.
    pub fn apply(&self, p: &Vec2) -> Vec2 {
        self.turn(p) + self.offset
    }

    /// The turned direction.
    pub fn turn(&self, v: &Vec2) -> Vec2 {
        let (s, c) = self.angle.sin_cos();
        Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
    }
}

/// A developed panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pattern {
    /// Index of the panel in the patchwork.
    pub panel: usize,
    /// Name of the panel.
    pub name: String,
    /// Closed contours: outer first (counter-clockwise), then holes.
    pub contours: Vec<Contour>,
    /// Rulings as line segments inside the outline.
    pub rulings: Vec<[Vec2; 2]>,
    /// Matching marks.
    pub marks: Vec<Mark>,
    /// Sides of the outer contour in order.
    pub sides: Vec<Side>,
    /// Area of the flat pattern, mm².
    pub area: f64,
    /// Area of the panel in space, mm².
    pub area_in_space: f64,
    /// Largest relative error of lengths between panel and pattern.
    pub isometry_error: f64,
    /// Largest distance (mm) between the contour drawn and the exact outline.
    pub contour_error: f64,
    /// Largest extent across and along (mm): width ≤ length of the smallest enclosing rectangle.
    pub width: f64,
    /// See `width`.
    pub length: f64,
}
