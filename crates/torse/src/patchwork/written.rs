//! What written files hold, number for number, as a reader finds it: panels of a STEP file, outlines and lines of a
//! cutting drawing. Nothing here is repaired or converted; lengths are mm, in drawings the unit that they name.

use super::pattern::BendSense;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// A face of a STEP file.
#[derive(Clone, Debug)]
pub struct WrittenFace {
    /// Entity number.
    pub entity: u64,
    /// Name.
    pub name: String,
    /// Whether its normal is the opposite of the surface's.
    pub reversed: bool,
    /// Surface.
    pub surface: WrittenSurface,
    /// Loops in the order of the file, each in its own direction.
    pub loops: Vec<Vec<WrittenEdge>>,
}

/// A B-spline surface of a STEP file.
#[derive(Clone, Debug)]
pub struct WrittenSurface {
    /// Knots in both parameters.
    pub knots: [Knots; 2],
    /// Control points, v running fastest.
    pub points: Vec<[f64; 3]>,
    /// Their weights; empty for polynomial surfaces.
    pub weights: Vec<f64>,
}

/// An edge in a loop of a STEP file.
#[derive(Clone, Debug)]
pub struct WrittenEdge {
    /// Entity number of the edge.
    pub entity: u64,
    /// Whether the loop follows the edge's own direction.
    pub forward: bool,
    /// Places of the first and last vertex, in the edge's own direction.
    pub vertices: [[f64; 3]; 2],
    /// The curve in space.
    pub curve: Curve<3>,
    /// The curve in the parameter plane of the face's surface.
    pub trim: Curve<2>,
}

/// An untrimmed strip of a STEP file: a face bounded by its rails and end rulings.
#[derive(Clone, Debug)]
pub struct WrittenStrip {
    /// Entity number.
    pub entity: u64,
    /// Name.
    pub name: String,
    /// Surface.
    pub surface: WrittenBase,
    /// Edges in the order of the loop.
    pub sides: Vec<WrittenSide>,
}

/// A face of a STEP file on an exact surface, with one loop or several.
#[derive(Clone, Debug)]
pub(crate) struct WrittenExact {
    /// Entity number.
    pub entity: u64,
    /// Name.
    pub name: String,
    /// Whether its normal is the opposite of the surface's.
    pub reversed: bool,
    /// Surface.
    pub surface: WrittenBase,
    /// Loops in the order of the file, each in its own direction.
    pub loops: Vec<Vec<WrittenSide>>,
}

/// The surface of an untrimmed strip, or of an exact face.
#[derive(Clone, Debug)]
pub enum WrittenBase {
    /// B-spline surface.
    Spline(WrittenSurface),
    /// Plane.
    Plane {
        /// A point of it.
        point: [f64; 3],
        /// Its normal, of any length.
        normal: [f64; 3],
    },
    /// Circular cylinder.
    Cylinder {
        /// A point of its axis.
        point: [f64; 3],
        /// Direction of the axis, of any length.
        axis: [f64; 3],
        /// Radius, mm.
        radius: f64,
    },
    /// Circular cone that widens along its axis.
    Cone {
        /// A point of its axis.
        point: [f64; 3],
        /// Direction of the axis, of any length.
        axis: [f64; 3],
        /// Radius at that point, mm.
        radius: f64,
        /// Angle between axis and rulings, rad.
        half_angle: f64,
    },
}

/// An edge of an untrimmed strip or of an exact face.
#[derive(Clone, Debug)]
pub struct WrittenSide {
    /// Entity number of the edge.
    pub entity: u64,
    /// Whether the loop follows the edge's own direction.
    pub forward: bool,
    /// Places of the first and last vertex, in the edge's own direction.
    pub vertices: [[f64; 3]; 2],
    /// The curve in space.
    pub curve: WrittenCurve,
}

/// The curve of an edge.
#[derive(Clone, Debug)]
pub enum WrittenCurve {
    /// Straight line.
    Line {
        /// A point of it.
        point: [f64; 3],
        /// Its direction, of any length.
        direction: [f64; 3],
    },
    /// Circle, run counter-clockwise about its axis.
    Circle {
        /// Centre.
        centre: [f64; 3],
        /// Direction of the axis, of any length.
        axis: [f64; 3],
        /// Radius, mm.
        radius: f64,
    },
    /// B-spline curve.
    Spline {
        /// Knots and control points.
        curve: Curve<3>,
        /// Weights of the control points; empty for polynomial curves.
        weights: Vec<f64>,
    },
}

/// The parts of a cutting drawing that belong to one pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenPiece {
    /// Unit of all its numbers.
    pub unit: LengthUnit,
    /// Outer outline, then holes, in the order of the file.
    pub contours: Vec<WrittenContour>,
    /// Rulings.
    pub rulings: Vec<[Vec2; 2]>,
    /// Which way the sheet bends about each of them, in the same order.
    pub senses: Vec<BendSense>,
    /// Lines where bent zones begin and end.
    pub extents: Vec<[Vec2; 2]>,
    /// Outlines of formed features.
    pub formed: Vec<WrittenContour>,
    /// Lines in which planes cut the part.
    pub sections: Vec<WrittenLine>,
    /// Curves of the model that lie on the part.
    pub curves: Vec<WrittenLine>,
    /// Matching marks, from the outline inwards.
    pub marks: Vec<[Vec2; 2]>,
}

impl WrittenPiece {
    /// Every place that the file names.
    pub fn points(&self) -> impl Iterator<Item = &Vec2> {
        let marked = self.sections.iter().chain(&self.curves).map(|l| &l.line);
        let outlines = self.contours.iter().chain(&self.formed).chain(marked).flat_map(|c| match c {
            WrittenContour::Joints(joints) => joints.iter().map(|j| &j.point).collect(),
            WrittenContour::Circle { centre, .. } => vec![centre],
        });
        outlines.chain(self.rulings.iter().chain(&self.extents).chain(&self.marks).flatten())
    }
}

/// A marked line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenLine {
    /// Its lines and arcs; nothing leaves the last joint of an open one.
    pub line: WrittenContour,
    /// Whether it is closed.
    pub closed: bool,
}

/// How files state an outline.
#[derive(Clone, Debug, PartialEq)]
pub enum WrittenContour {
    /// Lines and arcs.
    Joints(Vec<WrittenJoint>),
    /// A whole circle.
    Circle {
        /// Centre, y upwards.
        centre: Vec2,
        /// Radius.
        radius: f64,
    },
}

/// A joint of an outline and what leads from it to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenJoint {
    /// Place, y upwards.
    pub point: Vec2,
    /// The line or arc that follows.
    pub arc: WrittenArc,
}

/// How files state a line or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrittenArc {
    /// tan(sweep/4), positive counter-clockwise, 0 for a line (DXF).
    Bulge(f64),
    /// By its radius (SVG).
    Radius {
        /// Radius, mm.
        radius: f64,
        /// Whether it is the longer of both arcs.
        large: bool,
        /// Whether it runs clockwise with y upwards.
        clockwise: bool,
    },
}
