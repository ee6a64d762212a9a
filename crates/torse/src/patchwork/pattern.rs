//! Flat cutting patterns: the drawing of a developed panel. Lengths in mm, 1:1.

use super::panel::Border;
use crate::geom::Vec2;
use std::f64::consts::TAU;

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

/// What a matching mark stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MarkPlace {
    /// A seam within a face.
    #[default]
    Seam,
    /// The border of a face, where a panel of another face joins, or the other end of a closed one.
    Joint,
}

/// A matching mark on a seam or joint: both neighbours carry it at the same place, with the same label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Place on the outline.
    pub point: Vec2,
    /// Unit vector into the panel.
    pub inward: Vec2,
    /// Label, the same on both sides ("S12.3").
    pub label: String,
    /// What it stands on.
    pub on: MarkPlace,
    /// Distance (mm) in space of the place with the same label on the other side of a joint; 0 on seams, whose gaps are proven.
    pub apart: f64,
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

/// Side of the model from which a pattern is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ViewSide {
    /// From outside; what that means for open sheets: `geom::outward`.
    #[default]
    Outside,
    /// From inside.
    Inside,
}

impl ViewSide {
    /// Lower-case name used in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Inside => "inside",
        }
    }

    /// The side with a [`ViewSide::name`].
    pub(crate) fn named(name: &str) -> Option<Self> {
        [Self::Outside, Self::Inside].into_iter().find(|side| side.name() == name)
    }

    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Self::Outside => Self::Inside,
            Self::Inside => Self::Outside,
        }
    }
}

/// Where the sheet goes beside a ruling, as the pattern lies before the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BendSense {
    /// Both sides come up towards the eye.
    Up,
    /// Both sides go down.
    Down,
    /// The sheet stays flat there.
    #[default]
    Flat,
}

impl BendSense {
    /// Lower-case name used in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Up => "up",
            Self::Down => "down",
            Self::Flat => "flat",
        }
    }
}

/// How the sheet bends about a ruling that is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Which way.
    pub sense: BendSense,
    /// Turn of the sheet (rad, not negative) between the middles to the neighbouring rulings; those of a pattern add up
    /// to its whole turn where it bends one way; pieces of one ruling between holes have the same.
    pub angle: f64,
    /// Radius of curvature (mm) at both ends of the ruling; infinite where the sheet is flat, 0 for a fold.
    pub radii: [f64; 2],
    /// The same just before the ruling: other numbers where two pieces of a part join in it.
    pub before: [f64; 2],
    /// Turn of the sheet (rad, positive up) from the first ruling of the part to this one; of a fold, to half of it.
    pub turned: f64,
}

impl Bend {
    /// A bend with the same radii on both sides of its ruling, where the sheet has not turned yet.
    pub(crate) fn of(sense: BendSense, angle: f64, radii: [f64; 2]) -> Self {
        Self { sense, angle, radii, before: radii, turned: 0.0 }
    }
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

/// A line to be marked, not cut: where a plane cuts the part, or a curve of the model that lies on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MarkLine {
    /// Label beside it ("FR 12", "x=1200mm"); empty for none.
    pub label: String,
    /// Joints of its lines and arcs in order, at least two.
    pub joints: Vec<ContourVertex>,
    /// Whether the last joint is joined to the first; where it is not, its bulge is 0.
    pub closed: bool,
}

impl MarkLine {
    /// Straight lines from corner to corner.
    pub(crate) fn straight(label: &str, corners: &[Vec2]) -> Self {
        let joint = |p: &Vec2| ContourVertex { point: *p, bulge: 0.0, corner: true };
        Self { label: label.into(), joints: corners.iter().map(joint).collect(), closed: false }
    }

    /// Its lines and arcs as a contour; of one that is open the line from its end to its beginning is one of these.
    pub(crate) fn contour(&self) -> Contour {
        Contour { vertices: self.joints.clone() }
    }

    /// The same line, its joints moved by a map that keeps shapes, or mirrors them.
    pub(crate) fn moved(&self, map: impl Fn(&Vec2) -> Vec2, mirrored: bool) -> Self {
        let sign = if mirrored { -1.0 } else { 1.0 };
        let joint = |j: &ContourVertex| ContourVertex { point: map(&j.point), bulge: sign * j.bulge, ..*j };
        Self { joints: self.joints.iter().map(joint).collect(), ..self.clone() }
    }

    /// The same line, run through the other way.
    pub(crate) fn reversed(&self) -> Self {
        let (v, n) = (&self.joints, self.joints.len());
        // Of an open line nothing leaves the last joint; of a closed one what came to the first one.
        let bulge = |k: usize| if k > 0 || self.closed { -v[(k + n - 1) % n].bulge } else { 0.0 };
        let joints = (0..n).rev().map(|k| ContourVertex { bulge: bulge(k), ..v[k] }).collect();
        Self { joints, ..self.clone() }
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
    /// Side of the model from which it is seen.
    pub view: ViewSide,
    /// Rulings as line segments inside the outline.
    pub rulings: Vec<[Vec2; 2]>,
    /// How the sheet bends about each ruling, in the same order; empty where that is not known.
    pub bends: Vec<Bend>,
    /// Lines where bent zones begin and end.
    pub extents: Vec<[Vec2; 2]>,
    /// Outlines of features formed into the sheet: not cut.
    pub formed: Vec<Contour>,
    /// Lines in which planes cut the part.
    pub sections: Vec<MarkLine>,
    /// Curves of the model that lie on the part; points and texts are crosses of two lines.
    pub curves: Vec<MarkLine>,
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
    /// Largest distance (mm) between the contour drawn and the exact outline; not a number where it is unknown.
    pub contour_error: f64,
    /// Largest extent across and along (mm): width ≤ length of the smallest enclosing rectangle.
    pub width: f64,
    /// See `width`.
    pub length: f64,
}

impl Contour {
    /// Centre and radius (mm) of the circle that it is, to rounding; `None` if it is none.
    pub fn circle(&self) -> Option<(Vec2, f64)> {
        /// Share of the radius within which arcs are of one circle: rounding of their ends.
        const SAME: f64 = 1e-9;
        let v = &self.vertices;
        let n = v.len();
        let of = |k: usize| -> Option<(Vec2, f64)> {
            let (a, b, bulge) = (v[k].point, v[(k + 1) % n].point, v[k].bulge);
            let chord = b - a;
            let centre = (a + b) * 0.5 + Vec2::new(-chord.y, chord.x) * ((1.0 / bulge - bulge) * 0.25);
            let radius = (a - centre).norm();
            (bulge != 0.0 && radius > 0.0 && radius.is_finite()).then_some((centre, radius))
        };
        n.checked_sub(2)?;
        let first = of(0)?;
        let (centre, radius) = first;
        let same = |(c, r): (Vec2, f64)| (c - centre).norm() + (r - radius).abs() <= SAME * radius;
        let sweep: f64 = v.iter().map(|v| 4.0 * v.bulge.atan()).sum();
        let round = (0..n).all(|k| of(k).is_some_and(same) && v[k].bulge * v[0].bulge > 0.0);
        (round && (sweep.abs() - TAU).abs() <= SAME).then_some(first)
    }
}

impl Pattern {
    /// The same pattern seen from the other side.
    pub fn turned_over(&self) -> Self {
        let flip = |p: &Vec2| Vec2::new(-p.x, p.y);
        let contour = |c: &Contour| {
            let (v, n) = (&c.vertices, c.vertices.len());
            let vertex = |k: usize| {
                let (here, before) = (&v[(n - k) % n], &v[(2 * n - k - 1) % n]);
                // The piece that left the vertex before now leaves this one, the other way round: reversed and mirrored,
                // its bulge stays.
                ContourVertex { point: flip(&here.point), bulge: before.bulge, corner: here.corner }
            };
            Contour { vertices: (0..n).map(vertex).collect() }
        };
        let bend = |b: &Bend| {
            let sense = match b.sense {
                BendSense::Up => BendSense::Down,
                BendSense::Down => BendSense::Up,
                BendSense::Flat => BendSense::Flat,
            };
            Bend { sense, turned: -b.turned, ..*b }
        };
        let line = |s: &MarkLine| s.moved(flip, true);
        let mark = |m: &Mark| Mark { point: flip(&m.point), inward: flip(&m.inward), ..m.clone() };
        Self {
            contours: self.contours.iter().map(contour).collect(),
            view: self.view.opposite(),
            rulings: self.rulings.iter().map(|r| r.map(|p| flip(&p))).collect(),
            bends: self.bends.iter().map(bend).collect(),
            extents: self.extents.iter().map(|r| r.map(|p| flip(&p))).collect(),
            formed: self.formed.iter().map(contour).collect(),
            sections: self.sections.iter().map(line).collect(),
            curves: self.curves.iter().map(line).collect(),
            marks: self.marks.iter().map(mark).collect(),
            sides: self.sides.iter().rev().map(|s| Side { middle: flip(&s.middle), ..s.clone() }).collect(),
            ..self.clone()
        }
    }

    /// The pattern of the part's mirror image, bent the same way and seen from the same side.
    pub fn mirror_image(&self) -> Self {
        Self { view: self.view, bends: self.bends.clone(), ..self.turned_over() }
    }

    /// Area over length, mm.
    pub fn mean_width(&self) -> f64 {
        self.area / self.length.max(f64::MIN_POSITIVE)
    }

    /// Greatest width of the strip (mm) square to its middle line, which joins the middles of the rulings drawn: what
    /// remains of `width` for a strip that is curved in the plane. As fine as rulings are drawn.
    pub fn strip_width(&self) -> f64 {
        let rulings = whole_rulings(&self.rulings);
        let middles: Vec<Vec2> = rulings.iter().map(|[a, b]| 0.5 * (a + b)).collect();
        let across = |k: usize| {
            let along = middles[(k + 1).min(middles.len() - 1)] - middles[k.saturating_sub(1)];
            let [a, b] = rulings[k];
            (b - a).perp(&along).abs() / along.norm()
        };
        // Rulings at the ends belong to what lies beyond them as well.
        let widest = (0..rulings.len()).map(across).filter(|w| w.is_finite()).fold(0.0, f64::max);
        if rulings.len() < LEAST_RULINGS || widest <= 0.0 {
            return self.width;
        }
        widest.min(self.width)
    }

    /// How the sheet bends about a ruling.
    pub fn bend(&self, ruling: usize) -> Bend {
        self.bends.get(ruling).copied().unwrap_or_default()
    }
}

/// Fewer rulings say too little about the shape of a strip.
const LEAST_RULINGS: usize = 5;
/// Sine of the angle below which two pieces lie on one line: rulings of a strip that are this near to parallel and to
/// each other are one, interrupted by a hole.
const ON_ONE_LINE: f64 = 1e-6;

/// Rulings from end to end: pieces of one line between holes as one.
fn whole_rulings(pieces: &[[Vec2; 2]]) -> Vec<[Vec2; 2]> {
    let mut out: Vec<[Vec2; 2]> = Vec::new();
    for &[c, d] in pieces {
        if let Some([a, b]) = out.last_mut() {
            let (whole, reach) = (*b - *a, (d - *a).norm().max((c - *a).norm()));
            let off = |p: &Vec2| whole.perp(&(p - *a)).abs() <= ON_ONE_LINE * whole.norm() * reach;
            if off(&c) && off(&d) && whole.dot(&(d - c)) > 0.0 {
                *b = d;
                continue;
            }
        }
        out.push([c, d]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_is_as_wide_as_across_its_middle_line_holes_or_not() {
        // A quarter of a ring between the radii 9 and 10, rulings every 3 degrees, one interrupted.
        let mut rulings = Vec::new();
        for k in 0..=30 {
            let e = Vec2::new((3.0 * f64::from(k)).to_radians().cos(), (3.0 * f64::from(k)).to_radians().sin());
            match k {
                12 => rulings.extend([[e * 9.0, e * 9.3], [e * 9.5, e * 10.0]]),
                _ => rulings.push([e * 9.0, e * 10.0]),
            }
        }
        let ring = Pattern { rulings, width: 3.6, length: 14.1, ..Pattern::default() };
        assert!((ring.strip_width() - 1.0).abs() < 1e-3, "{}", ring.strip_width());
        // Without rulings nothing is known but the rectangle.
        assert_eq!(Pattern { width: 3.6, length: 14.1, ..Pattern::default() }.strip_width(), 3.6);
    }

    #[test]
    fn turned_over_twice_is_the_same_and_once_mirrors() {
        let v = |x: f64, y: f64, bulge: f64| ContourVertex { point: Vec2::new(x, y), bulge, corner: bulge == 0.0 };
        let p = Pattern {
            contours: vec![Contour { vertices: vec![v(1.0, 0.0, 0.0), v(5.0, 0.0, 0.3), v(3.0, 4.0, -0.1)] }],
            rulings: vec![[Vec2::new(2.0, 0.0), Vec2::new(3.0, 3.0)]],
            bends: vec![Bend { turned: 0.3, ..Bend::of(BendSense::Up, 0.1, [3.0, 4.0]) }],
            ..Pattern::default()
        };
        let q = p.turned_over();
        assert_eq!((q.view, q.bend(0).sense), (ViewSide::Inside, BendSense::Down));
        // The arc still joins the same two corners, and bulges out of the part as before.
        let arc = q.contours[0].vertices.iter().position(|v| v.bulge == 0.3).expect("the arc");
        assert_eq!(q.contours[0].vertices[arc].point, Vec2::new(-3.0, 4.0));
        let area = |c: &Contour| -> f64 {
            let v = &c.vertices;
            (0..3).map(|k| v[k].point.perp(&v[(k + 1) % 3].point)).sum()
        };
        assert_eq!(area(&q.contours[0]), area(&p.contours[0]));
        let back = q.turned_over();
        assert_eq!(back.contours[0].vertices.len(), 3);
        assert_eq!((back.rulings, back.bends, back.contours), (p.rulings, p.bends, p.contours));
    }
}
