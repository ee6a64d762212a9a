//! Curves of a DXF drawing (ASCII): LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE and SPLINE of the ENTITIES section,
//! in the drawing's unit (`$INSUNITS`) \[DXF2000\].
//!
//! Splines with control points are read as they are. Splines with fit points only (groups 11, 21, 31) are the cubic that
//! AutoCAD draws through them: twice continuously differentiable, with the chords' lengths as parameters, and with the
//! directions of groups 12 and 13 at the ends where the file gives them, else without curvature there
//! ([`through::cubic`]); closed ones go on smoothly where they close.
//! Polylines are read as their segments; of those that are smoothed, the vertices of the frame are passed over.
//! Other entities (texts, dimensions, insertions, meshes) are counted by kind, so that it can be said what was not read.

use super::options::{CurveError, CurveOptions, Found};
use crate::brep::space_curve::SpaceCurve;
use crate::geom::unit::{self, NamedUnit};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::{through, SplineError};

/// Units by `$INSUNITS`, where 0 is "unitless".
const UNITS: [(i64, &str); 9] = [
    (1, "inch"),
    (2, "foot"),
    (4, "millimetre"),
    (5, "centimetre"),
    (6, "metre"),
    (9, "mil"),
    (10, "yard"),
    (13, "micrometre"),
    (14, "decimetre"),
];

/// The unit of a code.
fn unit_of(code: i64) -> Option<&'static NamedUnit> {
    unit::named(UNITS.iter().find(|u| u.0 == code)?.1)
}

/// Turns of polylines below this are straight: a bulge is a quarter of the angle's tangent, and files have fewer digits.
const STRAIGHT: f64 = 1e-12;
/// Share by which a unit given may differ from the drawing's: rounding.
const SAME_UNIT: f64 = 1e-9;
/// Why an entity cannot be read.
#[derive(Debug, thiserror::Error)]
pub(super) enum Fault {
    #[error("group {code} is '{value}', which is not a finite number")]
    Number { code: i32, value: String },
    #[error("group {code} is {value}; it must be greater than zero")]
    Positive { code: i32, value: f64 },
    #[error("group {0} is missing")]
    Missing(i32),
    #[error("{what}: {there} of {wanted}")]
    Count { what: &'static str, there: usize, wanted: usize },
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// One entity: its kind, its groups, and what belongs to it though it is an entity of the file: vertices of an old polyline, attributes
/// of an insertion.
pub(super) struct Entity<'a> {
    pub kind: &'a str,
    groups: Vec<(i32, &'a str)>,
    pub parts: Vec<Entity<'a>>,
}

impl Entity<'_> {
    pub fn text(&self, code: i32) -> &str {
        self.groups.iter().find(|g| g.0 == code).map_or("", |g| g.1)
    }

    /// The number of a group, `None` if there is no such group.
    pub fn number(&self, code: i32) -> Result<Option<f64>, Fault> {
        self.groups.iter().find(|g| g.0 == code).map(finite).transpose()
    }

    pub fn required(&self, code: i32) -> Result<f64, Fault> {
        self.number(code)?.ok_or(Fault::Missing(code))
    }

    pub fn positive(&self, code: i32) -> Result<f64, Fault> {
        let value = self.required(code)?;
        (value > 0.0).then_some(value).ok_or(Fault::Positive { code, value })
    }

    /// All texts of a group.
    pub fn all_texts(&self, code: i32) -> impl Iterator<Item = &str> {
        self.groups.iter().filter(move |g| g.0 == code).map(|g| g.1)
    }

    /// Which of these groups comes last.
    pub fn last_of(&self, codes: [i32; 2]) -> Option<i32> {
        self.groups.iter().rev().map(|g| g.0).find(|c| codes.contains(c))
    }

    /// Bits of a group.
    pub fn flags(&self, code: i32) -> Result<i64, Fault> {
        Ok(self.number(code)?.unwrap_or(0.0) as i64)
    }

    fn all(&self, code: i32) -> Result<Vec<f64>, Fault> {
        self.groups.iter().filter(|g| g.0 == code).map(finite).collect()
    }

    /// The point of a group; only its third coordinate may be left out.
    pub fn point(&self, code: i32) -> Result<Vec3, Fault> {
        let z = self.number(code + 20)?.unwrap_or(0.0);
        Ok(Vec3::new(self.required(code)?, self.required(code + 10)?, z))
    }

    /// All points of a group.
    fn points(&self, code: i32) -> Result<Vec<Vec3>, Fault> {
        let (x, y, z) = (self.all(code)?, self.all(code + 10)?, self.all(code + 20)?);
        let flat = z.is_empty();
        for (k, there) in [(10, y.len()), (20, if flat { x.len() } else { z.len() })] {
            if there != x.len() {
                let what = if k == 10 { "second coordinates" } else { "third coordinates" };
                return Err(Fault::Count { what, there, wanted: x.len() });
            }
        }
        Ok((0..x.len()).map(|i| Vec3::new(x[i], y[i], if flat { 0.0 } else { z[i] })).collect())
    }

    /// The entity's own frame by the arbitrary axis rule.
    pub fn frame(&self) -> Result<Frame, Fault> {
        let z = Vec3::new(
            self.number(210)?.unwrap_or(0.0),
            self.number(220)?.unwrap_or(0.0),
            self.number(230)?.unwrap_or(1.0),
        );
        Ok(frame_of(&z))
    }
}

/// The frame of entities whose planes have this normal, by the arbitrary axis rule.
pub(in crate::io) fn frame_of(normal: &Vec3) -> Frame {
    let z = normal.try_normalize(0.0).unwrap_or_else(Vec3::z);
    // Below a 64th of both, the world's y-axis serves, else its z-axis.
    let base = if z.x.abs() < 1.0 / 64.0 && z.y.abs() < 1.0 / 64.0 { Vec3::y() } else { Vec3::z() };
    let x = base.cross(&z).normalize();
    Frame { origin: Vec3::zeros(), x, y: z.cross(&x), z }
}

fn finite(group: &(i32, &str)) -> Result<f64, Fault> {
    let value = group.1.parse().ok().filter(|x: &f64| x.is_finite());
    value.ok_or_else(|| Fault::Number { code: group.0, value: group.1.to_owned() })
}

/// Curves of a drawing with what was not read.
pub(super) struct Drawing {
    pub found: Vec<Found>,
    /// Kinds of entities that were not read, with their numbers.
    pub unread: Vec<(String, usize)>,
}

/// The groups of a drawing: codes and values.
pub(super) fn groups<'a>(text: &'a str, options: &CurveOptions) -> Result<Vec<(i32, &'a str)>, CurveError> {
    let damaged = |reason: String| CurveError::Damaged { name: options.name.clone(), reason };
    let mut lines = text.lines();
    let mut groups: Vec<(i32, &str)> = Vec::new();
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        let code = code.trim().trim_start_matches('\u{feff}');
        let code =
            code.parse().map_err(|_| damaged(format!("'{code}' is not a group code; is this an ASCII DXF file?")))?;
        groups.push((code, value.trim()));
    }
    Ok(groups)
}

/// Reads all curves, mm; each can be named by its handle or its layer.
pub(super) fn read(text: &str, options: &CurveOptions) -> Result<Drawing, CurveError> {
    let damaged = |reason: String| CurveError::Damaged { name: options.name.clone(), reason };
    let groups = groups(text, options)?;
    let unit = drawn_unit(&groups, options)?;
    let by_layer = |e: &Entity| options.select.eq_ignore_ascii_case(e.text(8)) && !options.select.is_empty();
    let mut out = Drawing { found: Vec::new(), unread: Vec::new() };
    for e in entities(&groups, "ENTITIES").ok_or_else(|| damaged(CUT_OFF.into()))? {
        let label = if by_layer(&e) { e.text(8) } else { e.text(5) };
        match curves(&e, unit).map_err(|x| damaged(format!("{} {}: {x}", e.kind, e.text(5))))? {
            Some(curves) => out.found.push(Found { label: label.to_owned(), curves }),
            None => match out.unread.iter_mut().find(|u| u.0 == e.kind) {
                Some(u) => u.1 += 1,
                None => out.unread.push((e.kind.to_owned(), 1)),
            },
        }
    }
    Ok(out)
}

/// What is the matter with a drawing whose entities have no end.
pub(super) const CUT_OFF: &str = "the section of its entities has no end: it was cut off";

/// Length of a unit of the drawing, mm.
pub(super) fn drawn_unit(groups: &[(i32, &str)], options: &CurveOptions) -> Result<f64, CurveError> {
    let file_unit = groups
        .iter()
        .position(|g| *g == (9, "$INSUNITS"))
        .and_then(|k| groups.get(k + 1))
        .and_then(|g| g.1.parse::<i64>().ok())
        .and_then(unit_of);
    match (file_unit, options.unit) {
        (Some(u), None) => Ok(u.mm),
        (Some(u), Some(given)) if (u.mm - given).abs() > SAME_UNIT * u.mm => {
            Err(CurveError::Unit { name: options.name.clone(), file: u.name.into() })
        }
        (_, Some(given)) => Ok(given),
        (None, None) => Err(CurveError::NoUnit(options.name.clone())),
    }
}

/// Entities of a section, as ENTITIES; vertices of old polylines belong to their polyline, attributes to their insertion. `None` if the section does not
/// end.
pub(super) fn entities<'a>(groups: &[(i32, &'a str)], wanted: &str) -> Option<Vec<Entity<'a>>> {
    let mut out: Vec<Entity> = Vec::new();
    let mut section = "";
    let mut k = 0;
    while k < groups.len() {
        let (code, value) = groups[k];
        k += 1;
        if code != 0 {
            continue;
        }
        if value == "SECTION" {
            section = groups.get(k).filter(|g| g.0 == 2).map_or("", |g| g.1);
            continue;
        }
        if value == "ENDSEC" {
            section = "";
        }
        let own: Vec<(i32, &str)> = groups[k..].iter().take_while(|g| g.0 != 0).copied().collect();
        k += own.len();
        if section != wanted {
            continue;
        }
        let entity = Entity { kind: value, groups: own, parts: Vec::new() };
        match (value, out.last_mut()) {
            ("VERTEX", Some(last)) if last.kind == "POLYLINE" => last.parts.push(entity),
            ("ATTRIB", Some(last)) if last.kind == "INSERT" => last.parts.push(entity),
            ("SEQEND", _) => {}
            _ => out.push(entity),
        }
    }
    (section != wanted).then_some(out)
}

/// A string with the letters that it has as \U+ and four digits.
pub(super) fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\U+");
    let mut out = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let letter = part.get(..4).and_then(|d| u32::from_str_radix(d, 16).ok()).and_then(char::from_u32);
        match letter {
            Some(letter) => {
                out.push(letter);
                out.push_str(&part[4..]);
            }
            None => {
                out.push_str("\\U+");
                out.push_str(part);
            }
        }
    }
    out
}

fn straight(p: Vec3, q: Vec3, unit: f64) -> Result<Curve<4>, SplineError> {
    let h = |p: Vec3| [unit * p.x, unit * p.y, unit * p.z, 1.0];
    Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![h(p), h(q)])
}

/// The arc with a centre in its frame from one angle (rad) to another.
fn arc(frame: &Frame, centre: Vec3, radius: f64, angles: (f64, f64), unit: f64) -> Result<Curve<4>, SplineError> {
    let frame = Frame { origin: frame.vector_to_world(&(centre * unit)), ..*frame };
    let (from, to) = angles;
    let to = if to > from { to } else { to + std::f64::consts::TAU };
    SpaceCurve::Ellipse { frame, a: unit * radius, b: unit * radius }.to_spline(from, to).map(|c| c.0)
}

/// The curves of an entity, `None` for kinds that are no curves.
pub(super) fn curves(e: &Entity, unit: f64) -> Result<Option<Vec<Curve<4>>>, Fault> {
    let one = |c: Curve<4>| Ok(Some(vec![c]));
    match e.kind {
        "LINE" => one(straight(e.point(10)?, e.point(11)?, unit)?),
        "CIRCLE" | "ARC" => {
            let angle = |code: i32| Ok::<f64, Fault>(e.required(code)?.to_radians());
            let angles = if e.kind == "ARC" { (angle(50)?, angle(51)?) } else { (0.0, std::f64::consts::TAU) };
            one(arc(&e.frame()?, e.point(10)?, e.positive(40)?, angles, unit)?)
        }
        "ELLIPSE" => one(ellipse(e, unit)?),
        "LWPOLYLINE" | "POLYLINE" => polyline(e, unit),
        "SPLINE" => one(spline(e, unit)?),
        _ => Ok(None),
    }
}

/// An ellipse or a part of one: centre and half the long axis in the world, ratio of the axes, parameters.
fn ellipse(e: &Entity, unit: f64) -> Result<Curve<4>, Fault> {
    let axis = e.point(11)?;
    let z = e.frame()?.z;
    let x = axis.try_normalize(0.0).ok_or(Fault::Positive { code: 11, value: axis.norm() })?;
    let frame = Frame { origin: e.point(10)? * unit, x, y: z.cross(&x), z };
    let (from, to) = (e.number(41)?.unwrap_or(0.0), e.number(42)?.unwrap_or(std::f64::consts::TAU));
    let to = if to > from { to } else { to + std::f64::consts::TAU };
    let a = unit * axis.norm();
    Ok(SpaceCurve::Ellipse { frame, a, b: a * e.positive(40)? }.to_spline(from, to)?.0)
}

/// A spline by its control points, or by its fit points if it has no others.
fn spline(e: &Entity, unit: f64) -> Result<Curve<4>, Fault> {
    const CLOSED: i64 = 1;
    let count = |code: i32, what: &'static str, there: usize| match e.number(code)? {
        Some(n) if n as usize != there => Err(Fault::Count { what, there, wanted: n as usize }),
        _ => Ok(()),
    };
    let control = e.points(10)?;
    count(73, "control points", control.len())?;
    if control.is_empty() {
        let points: Vec<Vec3> = e.points(11)?.into_iter().map(|p| p * unit).collect();
        count(74, "fit points", points.len())?;
        let end = |code: i32| e.number(code)?.map(|_| e.point(code)).transpose();
        let ends = [end(12)?, end(13)?];
        return Ok(through::cubic(&points, ends, e.flags(70)? & CLOSED != 0)?);
    }
    let weights = e.all(41)?;
    if !weights.is_empty() && weights.len() != control.len() {
        return Err(Fault::Count { what: "weights", there: weights.len(), wanted: control.len() });
    }
    let knots = e.all(40)?;
    count(72, "knots", knots.len())?;
    let homogeneous = |(i, p): (usize, &Vec3)| {
        let w = weights.get(i).copied().unwrap_or(1.0);
        [p.x * unit * w, p.y * unit * w, p.z * unit * w, w]
    };
    let control = control.iter().enumerate().map(homogeneous).collect();
    Ok(Curve::new(e.required(71)?.max(0.0) as usize, knots, control)?)
}

/// Corners of a polyline with the bulge of the segment that follows; `None` for meshes.
fn corners(e: &Entity) -> Result<Option<Vec<(Vec3, f64)>>, Fault> {
    const MESH: i64 = 16 | 64;
    const FRAME: i64 = 16;
    if e.kind == "POLYLINE" {
        if e.flags(70)? & MESH != 0 {
            return Ok(None);
        }
        let mut points = Vec::new();
        for v in &e.parts {
            let number = |code: i32| v.number(code).map(|x| x.unwrap_or(0.0));
            let corner = (Vec3::new(number(10)?, number(20)?, number(30)?), number(42)?);
            // Vertices of the frame are not on a polyline that is smoothed.
            if v.flags(70)? & FRAME == 0 {
                points.push(corner);
            }
        }
        return Ok(Some(points));
    }
    let z = e.number(38)?.unwrap_or(0.0);
    let mut points: Vec<(Vec3, f64)> = Vec::new();
    for group in e.groups.iter().filter(|g| [10, 20, 42].contains(&g.0)) {
        let value = finite(group)?;
        match (group.0, points.last_mut()) {
            (10, _) => points.push((Vec3::new(value, 0.0, z), 0.0)),
            (20, Some(p)) => p.0.y = value,
            (42, Some(p)) => p.1 = value,
            _ => return Err(Fault::Missing(10)),
        }
    }
    Ok(Some(points))
}

/// Lines and arcs of a polyline.
fn polyline(e: &Entity, unit: f64) -> Result<Option<Vec<Curve<4>>>, Fault> {
    let frame = e.frame()?;
    let closed = e.flags(70)? & 1 == 1;
    let Some(points) = corners(e)? else { return Ok(None) };
    let n = points.len();
    let mut out = Vec::new();
    for i in 0..if closed { n } else { n.saturating_sub(1) } {
        let ((p, bulge), q) = (points[i], points[(i + 1) % n].0);
        if p == q {
            continue;
        }
        if bulge.abs() < STRAIGHT {
            // Three-dimensional polylines have world coordinates; their frame is the world's.
            out.push(straight(frame.vector_to_world(&p), frame.vector_to_world(&q), unit)?);
            continue;
        }
        let chord = q - p;
        let left = Vec3::new(-chord.y, chord.x, 0.0);
        let centre = (p + q) * 0.5 + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
        let angle = |x: &Vec3| (x.y - centre.y).atan2(x.x - centre.x);
        let radius = (p - centre).norm();
        out.push(if bulge > 0.0 {
            arc(&frame, centre, radius, (angle(&p), angle(&q)), unit)?
        } else {
            arc(&frame, centre, radius, (angle(&q), angle(&p)), unit)?.reversed()
        });
    }
    Ok(Some(out))
}
