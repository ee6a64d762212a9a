//! Surfaces of ISO 10303-42.

use super::curves::{expanded, implied_knots, kind_of_knots, too_deep, Geometry, ResolvedCurve, DEEPEST};
use super::records::{as_number, as_reference, Args, Fault};
use super::token::Value;
use super::units::Units;
use crate::brep::offset;
use crate::brep::raw::{SurfaceDeviation, SurfaceKind};
use crate::brep::recast;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::brep::swept;
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// A surface with what its definition says beyond the support.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The unbounded surface.
    pub support: SupportSurface,
    /// Kind for people.
    pub kind: SurfaceKind,
    /// Whether its normal is that of the support.
    pub same_sense: bool,
    /// Rectangle of natural parameters, if the definition bounds it.
    pub rectangle: Option<[(f64, f64); 2]>,
    /// Distance from the file's surface where the support is an approximation, mm.
    pub deviation: SurfaceDeviation,
    /// Whether the support has other natural parameters than the definition.
    pub recast: bool,
}

impl Patch {
    fn exact(support: SupportSurface, kind: SurfaceKind) -> Self {
        Self { support, kind, same_sense: true, rectangle: None, deviation: SurfaceDeviation::NONE, recast: false }
    }

    /// Factors from the parameters that files state to natural ones.
    pub fn parameter_units(&self, units: &Units) -> [f64; 2] {
        match &self.support {
            SupportSurface::Plane(_) => [units.length; 2],
            // The parameter v of a cone is measured along its axis in ISO 10303-42, as here.
            SupportSurface::Cylinder { .. } | SupportSurface::Cone { .. } => [units.angle, units.length],
            SupportSurface::Sphere { .. } | SupportSurface::Torus { .. } => [units.angle; 2],
            SupportSurface::Extrusion { directrix, .. } => [curve_unit(directrix, units), 1.0],
            SupportSurface::Revolution { directrix, .. } => [units.angle, curve_unit(directrix, units)],
            SupportSurface::Spline(_) => [1.0; 2],
        }
    }
}

fn curve_unit(c: &SpaceCurve, units: &Units) -> f64 {
    if matches!(c, SpaceCurve::Ellipse { .. }) {
        units.angle
    } else {
        1.0
    }
}

/// Bounds nearer than this share of the period are one: printed angles of a full turn.
const FULL_TURN: f64 = 1e-9;

/// Whether a keyword is that of a B-spline surface or a part of one.
fn is_spline(name: &str) -> bool {
    name.contains("B_SPLINE_SURFACE") || name == "BEZIER_SURFACE" || name.ends_with("UNIFORM_SURFACE")
}

/// The curve of a swept surface; `false` if it is run backwards; the part of it, if it is trimmed.
type Directrix = (SpaceCurve, bool, Option<(f64, f64)>);

impl<'r, 'a> Geometry<'r, 'a> {
    /// The surface `#id`.
    pub fn surface(&self, id: u64, depth: u32) -> Result<Patch, Fault> {
        self.surface_near(id, &[], depth)
    }

    /// The surface `#id`, of an offset without ends as far as it goes near `places` (mm).
    pub fn surface_near(&self, id: u64, places: &[Vec3], depth: u32) -> Result<Patch, Fault> {
        if depth > DEEPEST {
            return Err(too_deep(id));
        }
        let r = self.records.get(id)?;
        let a = self.records.simple(id)?;
        match r.name() {
            "PLANE"
            | "CYLINDRICAL_SURFACE"
            | "CONICAL_SURFACE"
            | "SPHERICAL_SURFACE"
            | "TOROIDAL_SURFACE"
            | "DEGENERATE_TOROIDAL_SURFACE" => self.quadric_or_torus(id, r.name(), &a),
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let (directrix, along, _) = self.directrix(a.reference(1)?, depth)?;
                let direction = self.vector(a.reference(2)?)?;
                let support = SupportSurface::Extrusion { directrix, direction };
                Ok(Patch { same_sense: along, ..Patch::exact(support, SurfaceKind::Extrusion) })
            }
            "SURFACE_OF_REVOLUTION" => {
                let (directrix, along, part) = self.directrix(a.reference(1)?, depth)?;
                let frame = self.frame(a.reference(2)?)?;
                let turned = swept::meridian(&directrix, part, &frame)
                    .map_err(|why| Fault::new(id, format!("surface of revolution #{id}: {why}")))?;
                let directrix = turned.unwrap_or(directrix);
                let support = SupportSurface::Revolution { directrix, frame };
                Ok(Patch { same_sense: along, ..Patch::exact(support, SurfaceKind::Revolution) })
            }
            "OFFSET_SURFACE" => self.offset(id, &a, places, depth),
            "RECTANGULAR_TRIMMED_SURFACE" => {
                self.rectangle_of(self.surface_near(a.reference(1)?, places, depth + 1)?, &a)
            }
            "CURVE_BOUNDED_SURFACE" => self.surface_near(a.reference(1)?, places, depth + 1),
            "ORIENTED_SURFACE" => Err(Fault::new(id, format!("the oriented surface #{id} is not read"))),
            "SURFACE_REPLICA" => {
                let mut base = self.surface(a.reference(1)?, depth + 1)?;
                let placement = self.placement(a.reference(2)?)?;
                base.support = moved(&base.support, &placement)
                    .ok_or_else(|| Fault::new(id, format!("the replica #{id} of an analytic surface is not read")))?;
                Ok(base)
            }
            _ if r.parts.iter().any(|p| is_spline(p.name)) => {
                let s = self.spline_surface(id)?;
                Ok(Patch::exact(SupportSurface::Spline(SplineSupport::new(s)), SurfaceKind::Spline))
            }
            other => Err(Fault::new(id, format!("a surface of kind {other} is not read"))),
        }
    }

    /// An offset surface.
    fn offset(&self, id: u64, a: &Args, places: &[Vec3], depth: u32) -> Result<Patch, Fault> {
        let mut base = self.surface_near(a.reference(1)?, places, depth + 1)?;
        if let Some((support, same)) = recast::elementary(&base.support).filter(|_| base.rectangle.is_none()) {
            base = Patch { support, same_sense: base.same_sense == same, recast: true, ..base };
        }
        let distance = a.number(2)? * self.units.length * if base.same_sense { 1.0 } else { -1.0 };
        let stretch = offset::stretch_of(&base.support, base.rectangle, places);
        if !offset::keeps_parameters(&base.support) {
            base.rectangle = base.rectangle.map(|r| offset::rectangle_of_offset(&base.support, r, stretch));
            base.recast = true;
        }
        let (support, deviation) = offset::of_support(&base.support, distance, stretch)
            .map_err(|e| Fault::new(id, format!("offset surface #{id}: {e}")))?;
        Ok(Patch { support, kind: SurfaceKind::Offset, deviation: deviation.over(base.deviation), ..base })
    }

    /// An elementary surface.
    fn quadric_or_torus(&self, id: u64, name: &str, a: &Args) -> Result<Patch, Fault> {
        let length = self.units.length;
        let frame = self.frame(a.reference(1)?)?;
        let positive = |k: usize, what: &str| -> Result<f64, Fault> {
            let x = a.number(k)?;
            if x > 0.0 {
                Ok(x * length)
            } else {
                Err(Fault::new(id, format!("surface #{id} has the {what} {x}; it must be positive")))
            }
        };
        match name {
            "PLANE" => Ok(Patch::exact(SupportSurface::Plane(frame), SurfaceKind::Plane)),
            "CYLINDRICAL_SURFACE" => Ok(Patch::exact(
                SupportSurface::Cylinder { frame, radius: positive(2, "radius")? },
                SurfaceKind::Cylinder,
            )),
            "CONICAL_SURFACE" => {
                let radius = a.number(2)? * length;
                let angle = a.number(3)? * self.units.angle;
                if radius < 0.0 || !(angle.abs() > 0.0 && angle.abs() < std::f64::consts::FRAC_PI_2) {
                    return Err(Fault::new(
                        id,
                        format!("cone #{id} has the half angle {angle} rad and radius {radius} mm"),
                    ));
                }
                Ok(Patch::exact(SupportSurface::Cone { frame, radius, slope: angle.tan() }, SurfaceKind::Cone))
            }
            "SPHERICAL_SURFACE" => {
                Ok(Patch::exact(SupportSurface::Sphere { frame, radius: positive(2, "radius")? }, SurfaceKind::Sphere))
            }
            _ => {
                let (major, minor) = (positive(2, "major radius")?, positive(3, "minor radius")?);
                if name.starts_with("DEGENERATE") && major < minor && !a.logical(4, true) {
                    return Err(Fault::new(id, format!("the inner part of the self-crossing torus #{id} is not read")));
                }
                Ok(Patch::exact(SupportSurface::Torus { frame, major, minor }, SurfaceKind::Torus))
            }
        }
    }

    /// A surface bounded by the parameter lines that the arguments of a `RECTANGULAR_TRIMMED_SURFACE` state.
    fn rectangle_of(&self, mut base: Patch, a: &Args) -> Result<Patch, Fault> {
        if base.recast {
            let what = format!("the rectangle #{} of an offset of a swept surface is not read", a.id);
            return Err(Fault::new(a.id, what));
        }
        let unit = base.parameter_units(self.units);
        let senses = [a.logical(6, true), a.logical(7, true)];
        let periods = base.support.periods();
        let mut rectangle = [(0.0, 0.0); 2];
        for k in 0..2 {
            let (mut t1, mut t2) = (a.number(2 + 2 * k)? * unit[k], a.number(3 + 2 * k)? * unit[k]);
            if !senses[k] {
                std::mem::swap(&mut t1, &mut t2);
            }
            match periods[k] {
                Some(p) => {
                    let way = (t2 - t1).rem_euclid(p);
                    t2 = t1 + if way <= FULL_TURN * p { p } else { way };
                }
                None if t2 < t1 => std::mem::swap(&mut t1, &mut t2),
                None => {}
            }
            rectangle[k] = (t1, t2);
        }
        base.same_sense = base.same_sense == (senses[0] == senses[1]);
        base.rectangle = Some(rectangle);
        Ok(base)
    }

    /// The curve that a swept surface is made from.
    fn directrix(&self, id: u64, depth: u32) -> Result<Directrix, Fault> {
        match self.resolved_curve(id, depth + 1)? {
            ResolvedCurve::Basis(c, along) => Ok((c, along, None)),
            ResolvedCurve::Path(mut p) if p.len() == 1 => {
                let Arc { curve, from, to } = p.remove(0);
                Ok((curve, to >= from, Some((from.min(to), from.max(to)))))
            }
            ResolvedCurve::Path(_) => {
                Err(Fault::new(id, format!("the composite curve #{id} as profile of a surface is not read")))
            }
        }
    }

    fn spline_surface(&self, id: u64) -> Result<Surface, Fault> {
        let r = self.records.get(id)?;
        // A name may be `$`; the parts of complex instances have none.
        let named = |v: &[Value]| usize::from(matches!(v.first(), Some(Value::Text(_) | Value::Null | Value::Derived)));
        let (body, first) = match r.part("B_SPLINE_SURFACE") {
            Some(p) => (Args { id, values: &p.args }, named(&p.args)),
            None => (self.records.simple(id)?, 1),
        };
        let degree = [body.count(first)?, body.count(first + 1)?];
        let rows = body.list(first + 2)?;
        let nu = rows.len();
        let mut points: Vec<Vec3> = Vec::new();
        let mut nv = 0;
        for (i, row) in rows.iter().enumerate() {
            let Value::List(row) = row else {
                return Err(Fault::new(id, format!("row {} of the control points of #{id} is not a list", i + 1)));
            };
            if i == 0 {
                nv = row.len();
            } else if row.len() != nv {
                return Err(Fault::new(id, format!("the rows of control points of #{id} differ in length")));
            }
            for p in row {
                let p = as_reference(p)
                    .ok_or_else(|| Fault::new(id, format!("#{id} has a control point that is no reference")))?;
                points.push(self.point(p)?);
            }
        }
        let knots = match r.part("B_SPLINE_SURFACE_WITH_KNOTS") {
            Some(p) => {
                let a = Args { id, values: &p.args };
                let k = if named(&p.args) == 1 { 8 } else { 0 };
                [
                    expanded(id, &a.numbers(k)?, &a.numbers(k + 2)?)?,
                    expanded(id, &a.numbers(k + 1)?, &a.numbers(k + 3)?)?,
                ]
            }
            None => {
                let kind = kind_of_knots(r.parts.iter().map(|p| p.name));
                [implied_knots(id, kind, degree[0], nu)?, implied_knots(id, kind, degree[1], nv)?]
            }
        };
        let weights = match r.part("RATIONAL_B_SPLINE_SURFACE") {
            Some(p) => {
                let a = Args { id, values: &p.args };
                let rows = a.list(p.args.len().saturating_sub(1))?;
                let mut w = Vec::with_capacity(points.len());
                for row in rows {
                    let Value::List(row) = row else {
                        return Err(Fault::new(id, format!("the weights of #{id} are not a table")));
                    };
                    for x in row {
                        let x = as_number(x).filter(|x| *x > 0.0 && x.is_finite());
                        w.push(x.ok_or_else(|| {
                            Fault::new(id, format!("weight {} of surface #{id} is not a positive number", w.len() + 1))
                        })?);
                    }
                }
                Some(w)
            }
            None => None,
        };
        let [u, v] = knots;
        let wrong = |e: crate::spline::SplineError| Fault::new(id, format!("B-spline surface #{id}: {e}"));
        let knots_u = Knots::new(degree[0], u, nu).map_err(wrong)?;
        let knots_v = Knots::new(degree[1], v, nv).map_err(wrong)?;
        Surface::new(knots_u, knots_v, &points, weights.as_deref()).map_err(wrong)
    }
}

/// A spline support moved by a placement.
fn moved(c: &SupportSurface, placement: &Placement) -> Option<SupportSurface> {
    let SupportSurface::Spline(s) = c else { return None };
    let mut surface = s.surface.clone();
    surface.place(placement);
    Some(SupportSurface::Spline(SplineSupport::new(surface)))
}
