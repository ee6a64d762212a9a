//! Curves of a DXF drawing (ASCII): LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE and SPLINE of the ENTITIES section, in the
//! drawing's unit (`$INSUNITS`) \[DXF2000\].

use super::{CurveError, CurveOptions, Found};
use crate::brep::space_curve::SpaceCurve;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::SplineError;

/// Millimetres per unit, by `$INSUNITS`; 0 is "unitless".
fn unit_of(code: i64) -> Option<(f64, &'static str)> {
    Some(match code {
        1 => (25.4, "inches"),
        2 => (304.8, "feet"),
        4 => (1.0, "millimetres"),
        5 => (10.0, "centimetres"),
        6 => (1000.0, "metres"),
        _ => return None,
    })
}

/// One entity: its kind and its groups.
struct Entity<'a> {
    kind: &'a str,
    groups: Vec<(i32, &'a str)>,
}

impl Entity<'_> {
    fn text(&self, code: i32) -> &str {
        self.groups.iter().find(|g| g.0 == code).map_or("", |g| g.1)
    }

    fn number(&self, code: i32) -> Option<f64> {
        self.groups.iter().find(|g| g.0 == code).and_then(|g| g.1.parse().ok())
    }

    fn all(&self, code: i32) -> Vec<f64> {
        self.groups.iter().filter(|g| g.0 == code).map(|g| g.1.parse().unwrap_or(f64::NAN)).collect()
    }

    fn point(&self, code: i32) -> Vec3 {
        let at = |k: i32| self.number(code + k).unwrap_or(0.0);
        Vec3::new(at(0), at(10), at(20))
    }

    /// The entity's own frame by the arbitrary axis rule.
    fn frame(&self) -> Frame {
        let z = Vec3::new(
            self.number(210).unwrap_or(0.0),
            self.number(220).unwrap_or(0.0),
            self.number(230).unwrap_or(1.0),
        );
        let z = z.try_normalize(0.0).unwrap_or_else(Vec3::z);
        // Below a 64th of both, the world's y-axis serves, else its z-axis.
        let base = if z.x.abs() < 1.0 / 64.0 && z.y.abs() < 1.0 / 64.0 { Vec3::y() } else { Vec3::z() };
        let x = base.cross(&z).normalize();
        Frame { origin: Vec3::zeros(), x, y: z.cross(&x), z }
    }
}

/// Reads all curves, mm; each can be named by its handle or its layer.
pub(super) fn read(text: &str, options: &CurveOptions) -> Result<Vec<Found>, CurveError> {
    let damaged = |reason: String| CurveError::Damaged { name: options.name.clone(), reason };
    let mut lines = text.lines();
    let mut groups: Vec<(i32, &str)> = Vec::new();
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        let code = code.trim().trim_start_matches('\u{feff}');
        let code =
            code.parse().map_err(|_| damaged(format!("'{code}' is not a group code; is this an ASCII DXF file?")))?;
        groups.push((code, value.trim()));
    }
    let file_unit = groups
        .iter()
        .position(|g| *g == (9, "$INSUNITS"))
        .and_then(|k| groups.get(k + 1))
        .and_then(|g| g.1.parse::<i64>().ok())
        .and_then(unit_of);
    let unit = match (file_unit, options.unit) {
        (Some((u, _)), None) => u,
        (Some((u, name)), Some(given)) if (u - given).abs() > 1e-9 * u => {
            return Err(CurveError::Unit { name: options.name.clone(), file: name.into() })
        }
        (_, Some(given)) => given,
        (None, None) => return Err(CurveError::NoUnit(options.name.clone())),
    };
    let by_layer = |e: &Entity| options.select.eq_ignore_ascii_case(e.text(8)) && !options.select.is_empty();
    let mut out: Vec<Found> = Vec::new();
    for e in entities(&groups) {
        let curves = curves(&e, unit).map_err(|x| damaged(format!("{} {}: {x}", e.kind, e.text(5))))?;
        if curves.is_empty() {
            continue;
        }
        let label = if by_layer(&e) { e.text(8) } else { e.text(5) };
        out.push(Found { label: label.to_owned(), curves });
    }
    Ok(out)
}

/// Entities of the ENTITIES section; vertices of old polylines become groups of their polyline.
fn entities<'a>(groups: &[(i32, &'a str)]) -> Vec<Entity<'a>> {
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
        let own: Vec<(i32, &str)> = groups[k..].iter().take_while(|g| g.0 != 0).copied().collect();
        k += own.len();
        if section != "ENTITIES" {
            continue;
        }
        match (value, out.last_mut()) {
            // Coordinates of vertices are renumbered, so that they differ from the polyline's own.
            ("VERTEX", Some(last)) if last.kind == "POLYLINE" => {
                let bulge = own.iter().find(|g| g.0 == 42).map_or("0", |g| g.1);
                for code in [10, 20, 30] {
                    let x = own.iter().find(|g| g.0 == code).map_or("0", |g| g.1);
                    last.groups.push((1000 + code, x));
                }
                last.groups.push((1042, bulge));
            }
            ("SEQEND", _) => {}
            _ => out.push(Entity { kind: value, groups: own }),
        }
    }
    out
}

/// The curves of an entity, none for kinds that are no curves.
fn curves(e: &Entity, unit: f64) -> Result<Vec<Curve<4>>, SplineError> {
    let frame = e.frame();
    let line = |p: Vec3, q: Vec3| {
        let h = |p: Vec3| [unit * p.x, unit * p.y, unit * p.z, 1.0];
        Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![h(p), h(q)])
    };
    let arc = |centre: Vec3, radius: f64, from: f64, to: f64| {
        let frame = Frame { origin: frame.vector_to_world(&(centre * unit)), ..frame };
        let to = if to > from { to } else { to + std::f64::consts::TAU };
        SpaceCurve::Ellipse { frame, a: unit * radius, b: unit * radius }.to_spline(from, to).map(|c| c.0)
    };
    let radians = |code: i32| e.number(code).unwrap_or(0.0).to_radians();
    match e.kind {
        "LINE" => Ok(vec![line(e.point(10), e.point(11))?]),
        "CIRCLE" => Ok(vec![arc(e.point(10), e.number(40).unwrap_or(f64::NAN), 0.0, std::f64::consts::TAU)?]),
        "ARC" => Ok(vec![arc(e.point(10), e.number(40).unwrap_or(f64::NAN), radians(50), radians(51))?]),
        "LWPOLYLINE" | "POLYLINE" => polyline(e, &frame, &line, &arc),
        "SPLINE" => {
            let (x, y, z) = (e.all(10), e.all(20), e.all(30));
            let weights = e.all(41);
            let control = (0..x.len())
                .map(|i| {
                    let w = weights.get(i).copied().unwrap_or(1.0);
                    let at = |v: &[f64]| v.get(i).copied().unwrap_or(0.0) * unit * w;
                    [at(&x), at(&y), at(&z), w]
                })
                .collect();
            let degree = e.number(71).unwrap_or(3.0).max(0.0) as usize;
            Ok(vec![Curve::new(degree, e.all(40), control)?])
        }
        _ => Ok(Vec::new()),
    }
}

/// Lines and arcs of a polyline.
fn polyline(
    e: &Entity,
    frame: &Frame,
    line: &dyn Fn(Vec3, Vec3) -> Result<Curve<4>, SplineError>,
    arc: &dyn Fn(Vec3, f64, f64, f64) -> Result<Curve<4>, SplineError>,
) -> Result<Vec<Curve<4>>, SplineError> {
    let closed = e.number(70).unwrap_or(0.0) as i64 & 1 == 1;
    let mut points: Vec<(Vec3, f64)> = Vec::new();
    if e.kind == "LWPOLYLINE" {
        let z = e.number(38).unwrap_or(0.0);
        for (code, value) in &e.groups {
            let value: f64 = value.parse().unwrap_or(f64::NAN);
            match (code, points.last_mut()) {
                (10, _) => points.push((Vec3::new(value, 0.0, z), 0.0)),
                (20, Some(p)) => p.0.y = value,
                (42, Some(p)) => p.1 = value,
                _ => {}
            }
        }
    } else {
        let (x, y, z, bulge) = (e.all(1010), e.all(1020), e.all(1030), e.all(1042));
        points = (0..x.len()).map(|i| (Vec3::new(x[i], y[i], z[i]), bulge[i])).collect();
    }
    let n = points.len();
    let mut out = Vec::new();
    for i in 0..if closed { n } else { n.saturating_sub(1) } {
        let ((p, bulge), q) = (points[i], points[(i + 1) % n].0);
        if p == q {
            continue;
        }
        if bulge.abs() < 1e-12 {
            // Three-dimensional polylines have world coordinates; their frame is the world's.
            out.push(line(frame.vector_to_world(&p), frame.vector_to_world(&q))?);
            continue;
        }
        let chord = q - p;
        let left = Vec3::new(-chord.y, chord.x, 0.0);
        let centre = (p + q) * 0.5 + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
        let angle = |x: &Vec3| (x.y - centre.y).atan2(x.x - centre.x);
        let radius = (p - centre).norm();
        out.push(if bulge > 0.0 {
            arc(centre, radius, angle(&p), angle(&q))?
        } else {
            arc(centre, radius, angle(&q), angle(&p))?.reversed()
        });
    }
    Ok(out)
}
