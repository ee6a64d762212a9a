//! Surfaces: planes, analytic and swept surfaces, offsets.

use super::curves::{vec3, Geometry};
use super::patch::{round, Chart, Patch};
use super::placing;
use super::records::DEEPEST;
use super::records::{Entry, Fault};
use super::splines;
use crate::brep::offset;
use crate::brep::raw::{SurfaceDeviation, SurfaceKind};
use crate::brep::recast;
use crate::brep::ruled::Ruled;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::brep::swept;
use crate::geom::{Frame, Vec3};
use crate::spline::SplineError;
use std::f64::consts::FRAC_PI_2;

/// Types of surfaces.
pub(super) fn is_surface(kind: u32) -> bool {
    matches!(kind, 108 | 114 | 118 | 120 | 122 | 128 | 140 | 190 | 192 | 194 | 196 | 198)
}

/// Directions whose part square to an axis is below this share are along it.
const ALONG: f64 = 1e-9;
/// Cosine of the angle to the normal up to which the indicator of an offset is not one: rounding of files leaves far more.
const NORMAL: f64 = 0.999;

impl Geometry<'_> {
    /// The surface of an entity, without the transformation of its own.
    pub fn surface(&self, id: u64, depth: u32) -> Result<Patch, Fault> {
        if depth > DEEPEST {
            return Err(Fault::new(id, format!("D{id} is defined in a circle or too deeply")));
        }
        let e = self.get(id)?;
        match e.kind {
            108 => plane(e),
            114 => splines::parametric(e),
            118 => self.ruled(e, depth),
            120 => self.turned(e, depth),
            122 => self.tabulated(e, depth),
            128 => splines::rational(e),
            140 => self.offset(e, depth),
            190 | 192 | 194 | 196 | 198 => self.analytic(e),
            143 | 144 => Err(Fault::new(id, format!("the trimmed surface D{id} is trimmed again, which is not read"))),
            other => Err(Fault::new(id, format!("D{id} is of type {other}, not a surface that is read"))),
        }
    }

    /// Surface of revolution: the file's first parameter runs along the generatrix, the second is the angle.
    fn turned(&self, e: &Entry, depth: u32) -> Result<Patch, Fault> {
        let axis = self.single(e.pointer(1)?, depth)?;
        let generatrix = self.single(e.pointer(2)?, depth)?;
        let (start, end) = (e.number(3)?, e.number(4)?);
        let (p, q) = axis.ends();
        let frame = frame_of(p, q - p, None)
            .ok_or_else(|| Fault::new(e.number, format!("the axis of D{} has no direction", e.number)))?;
        if !(end > start && end - start < MOST_TURNS) {
            return Err(Fault::new(e.number, format!("D{} turns from {start} to {end} rad", e.number)));
        }
        let (from, to) = (generatrix.from.min(generatrix.to), generatrix.from.max(generatrix.to));
        let along = generatrix.from <= generatrix.to;
        let round = round(&SupportSurface::Revolution { directrix: generatrix.curve.clone(), frame });
        // A closed curve turned by half a turn covers the surface once.
        let once = end - start <= HALF_TURN;
        let directrix = match swept::meridian(&generatrix.curve, Some((from, to)), &frame) {
            Ok(directrix) => directrix,
            Err(_) if once || round.is_some() => None,
            Err(why) => return Err(Fault::new(e.number, format!("surface of revolution D{}: {why}", e.number))),
        };
        // The part of a curve as a spline has parameters of its own.
        let chart = (along && directrix.is_none()).then_some(Chart { exchanged: true, ..Chart::SAME });
        let range = directrix.as_ref().and_then(SpaceCurve::domain).unwrap_or((from, to));
        let kind = round.as_ref().map_or(SurfaceKind::Revolution, |r| r.1);
        let support = SupportSurface::Revolution { directrix: directrix.unwrap_or(generatrix.curve), frame };
        let rectangle = Some([(start, end), range]);
        Ok(Patch { same_sense: !along, rectangle, chart, round, ..Patch::exact(support, kind) })
    }

    /// Ruled surface: both parameters run from 0 to 1.
    fn ruled(&self, e: &Entry, depth: u32) -> Result<Patch, Fault> {
        let first = self.single(e.pointer(1)?, depth)?;
        let second = self.single(e.pointer(2)?, depth)?;
        let second = if e.integer(3)? == 1 { second.reversed() } else { second };
        let wrong = |why: SplineError| Fault::new(e.number, format!("ruled surface D{}: {why}", e.number));
        let ruled = Ruled::between(&first, &second, e.form == 0).map_err(wrong)?;
        let deviation = SurfaceDeviation::seen(ruled.deviation_estimate);
        let chart = (deviation == SurfaceDeviation::NONE).then_some(Chart::SAME);
        if let Some(direction) = ruled.translation {
            let [directrix, _] = ruled.rails;
            let support = SupportSurface::Extrusion { directrix: SpaceCurve::Spline(directrix), direction };
            let rectangle = Some([(0.0, 1.0); 2]);
            return Ok(Patch { rectangle, chart, deviation, ..Patch::exact(support, SurfaceKind::Extrusion) });
        }
        let support = SupportSurface::Spline(SplineSupport::new(ruled.surface().map_err(wrong)?));
        Ok(Patch { chart, deviation, ..Patch::exact(support, SurfaceKind::Spline) })
    }

    /// Tabulated cylinder: both parameters run from 0 to 1.
    fn tabulated(&self, e: &Entry, depth: u32) -> Result<Patch, Fault> {
        let directrix = self.single(e.pointer(1)?, depth)?;
        let direction = vec3(e, 2)? - directrix.ends().0;
        if !(direction.norm() > 0.0 && direction.norm().is_finite()) {
            return Err(Fault::new(e.number, format!("the tabulated cylinder D{} has no height", e.number)));
        }
        let Arc { curve, from, to } = directrix;
        let rectangle = Some([(from.min(to), from.max(to)), (0.0, 1.0)]);
        let chart = Some(Chart { scale: [to - from, 1.0], shift: [from, 0.0], ..Chart::SAME });
        let same_sense = from <= to;
        let support = SupportSurface::Extrusion { directrix: curve, direction };
        Ok(Patch { same_sense, rectangle, chart, ..Patch::exact(support, SurfaceKind::Extrusion) })
    }

    /// Offset surface: the side is that of an indicated vector.
    fn offset(&self, e: &Entry, depth: u32) -> Result<Patch, Fault> {
        let indicator = vec3(e, 1)?;
        let base_id = e.pointer(5)?;
        let mut base = self.surface(base_id, depth + 1)?;
        let own = placing::of_entry(self.records, self.get(base_id)?)?;
        base.support = placing::support(&base.support, &own).ok_or_else(|| {
            Fault::new(e.number, format!("the base of the offset D{} is moved, which is not read", e.number))
        })?;
        let middle = middle(&base);
        if let Some((support, same)) = recast::elementary(&base.support) {
            // The new form has other parameters; the edges of the file say where it ends.
            let same_sense = base.same_sense == same;
            base = Patch { support, same_sense, rectangle: None, chart: None, ..base };
        }
        let stretch = offset::stretch_of(&base.support, base.rectangle, &[]);
        if !offset::keeps_parameters(&base.support) {
            let rectangle = base.rectangle.map(|r| offset::rectangle_of_offset(&base.support, r, stretch));
            base = Patch { rectangle, chart: None, ..base };
        }
        let jet = base.support.jet(base.support.foot(&middle, None));
        let normal = jet.du.cross(&jet.dv);
        let side = normal.dot(&indicator);
        let is_normal = side.abs() >= NORMAL * normal.norm() * indicator.norm();
        let side = if side == 0.0 && base.same_sense { 1.0 } else { side };
        let distance = e.number(4)? * if side < 0.0 { -1.0 } else { 1.0 };
        let (support, deviation) = offset::of_support(&base.support, distance, stretch)
            .map_err(|why| Fault::new(e.number, format!("offset surface D{}: {why}", e.number)))?;
        // Some writers take the normal at another place than the middle of the base: edges tell then.
        let other = if is_normal { None } else { offset::of_support(&base.support, -distance, stretch).ok() };
        let other = other.map(|(support, off)| (support, off.over(base.deviation)));
        let deviation = deviation.over(base.deviation);
        Ok(Patch { support, kind: SurfaceKind::Offset, deviation, round: None, other, ..base })
    }

    /// Planes, cylinders, cones, spheres and tori by centre, axis and sizes.
    fn analytic(&self, e: &Entry) -> Result<Patch, Fault> {
        let positive = |k: usize| -> Result<f64, Fault> {
            let x = e.number(k)?;
            if x > 0.0 {
                return Ok(x);
            }
            Err(Fault::new(e.number, format!("surface D{} has the size {x}; it must be positive", e.number)))
        };
        let origin = self.point(e.pointer(1)?)?;
        let given = |k: usize| -> Result<Option<Vec3>, Fault> {
            match e.optional(k)? {
                0 => Ok(None),
                id => self.direction(id).map(Some),
            }
        };
        let reference = |k: usize| if e.form == 1 { given(k) } else { Ok(None) };
        let frame = |z: Option<Vec3>, x: Option<Vec3>| {
            frame_of(origin, z.unwrap_or_else(Vec3::z), x)
                .ok_or_else(|| Fault::new(e.number, format!("the axis of D{} has no direction", e.number)))
        };
        let d = Chart::DEGREES;
        let (support, kind, chart) = match e.kind {
            190 => (SupportSurface::Plane(frame(given(2)?, reference(3)?)?), SurfaceKind::Plane, [1.0, 1.0]),
            192 => {
                let frame = frame(given(2)?, reference(4)?)?;
                (SupportSurface::Cylinder { frame, radius: positive(3)? }, SurfaceKind::Cylinder, [d, 1.0])
            }
            194 => {
                let frame = frame(given(2)?, reference(5)?)?;
                let (radius, angle) = (e.number(3)?, e.number(4)? * d);
                if radius < 0.0 || !(angle.abs() > 0.0 && angle.abs() < FRAC_PI_2) {
                    let what = format!("the cone D{} has the half angle {angle} rad and radius {radius}", e.number);
                    return Err(Fault::new(e.number, what));
                }
                (SupportSurface::Cone { frame, radius, slope: angle.tan() }, SurfaceKind::Cone, [d, 1.0])
            }
            196 => {
                let frame = frame(reference(3)?, reference(4)?)?;
                (SupportSurface::Sphere { frame, radius: positive(2)? }, SurfaceKind::Sphere, [d, d])
            }
            _ => {
                let frame = frame(given(2)?, reference(5)?)?;
                let support = SupportSurface::Torus { frame, major: positive(3)?, minor: positive(4)? };
                (support, SurfaceKind::Torus, [d, d])
            }
        };
        let chart = Chart::scaled(chart).filter(|_| e.form == 1);
        Ok(Patch { chart, ..Patch::exact(support, kind) })
    }
}

/// Half a turn and a hair, rad.
const HALF_TURN: f64 = 3.2;

/// Turns of a surface of revolution at most, rad; a hair more than one is rounding.
const MOST_TURNS: f64 = 6.5;

/// Plane by its equation.
fn plane(e: &Entry) -> Result<Patch, Fault> {
    let k = e.numbers(1, 4)?;
    let normal = Vec3::new(k[0], k[1], k[2]);
    let square = normal.norm_squared();
    if !(square > 0.0 && square.is_finite()) {
        return Err(Fault::new(e.number, format!("the plane D{} has no normal", e.number)));
    }
    let frame = frame_of(normal * (k[3] / square), normal, None);
    let frame = frame.ok_or_else(|| Fault::new(e.number, format!("the plane D{} has no normal", e.number)))?;
    Ok(Patch { chart: None, ..Patch::exact(SupportSurface::Plane(frame), SurfaceKind::Plane) })
}

/// The frame with these axes, completed and made square; `None` if the axis has no length.
fn frame_of(origin: Vec3, z: Vec3, x: Option<Vec3>) -> Option<Frame> {
    let z = z.try_normalize(0.0)?;
    let square = |x: Vec3| (x - z * z.dot(&x)).try_normalize(ALONG);
    let other = if z.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() };
    let x = x.and_then(square).or_else(|| square(other))?;
    Some(Frame { origin, x, y: z.cross(&x), z })
}

/// A point in the middle of a surface.
fn middle(patch: &Patch) -> Vec3 {
    let limits = patch.support.limits();
    let mid = |k: usize| match (patch.rectangle, limits[k], patch.support.periods()[k]) {
        (Some(r), _, _) => 0.5 * (r[k].0 + r[k].1),
        (None, Some((a, b)), _) => 0.5 * (a + b),
        (None, None, Some(p)) => 0.5 * p,
        (None, None, None) => 0.0,
    };
    patch.support.jet([mid(0), mid(1)]).p
}
