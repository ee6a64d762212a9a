//! Points, directions, placements and curves of ISO 10303-42.

use super::records::{as_number, as_reference, Args, Fault, Part, Records};
use super::token::Value;
use super::units::Units;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::geom::placement::Placement;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;

/// Definitions by definitions by definitions…: real files stay below 6.
pub(super) const DEEPEST: u32 = 24;

/// Coordinates above this many mm (a million kilometres) are damage, and their products would overflow.
const FARTHEST: f64 = 1e12;

/// Reads geometry in one representation context; lengths arrive in mm, angles in radians.
#[derive(Clone, Copy)]
pub(super) struct Geometry<'r, 'a> {
    /// The file.
    pub records: &'r Records<'a>,
    /// Units of the context.
    pub units: &'r Units,
}

/// A curve as a definition leaves it.
#[derive(Clone, Debug)]
pub(super) enum ResolvedCurve {
    /// A basis curve, not yet cut; `false` if the definition runs against it.
    Basis(SpaceCurve, bool),
    /// A path of pieces.
    Path(Vec<Arc>),
}

pub(super) fn too_deep(id: u64) -> Fault {
    Fault::new(id, format!("#{id} is defined in a circle or too deeply"))
}

impl<'r, 'a> Geometry<'r, 'a> {
    /// A cartesian point, mm. Two coordinates leave the third 0.
    pub fn point(&self, id: u64) -> Result<Vec3, Fault> {
        let x = self.records.args(id, "CARTESIAN_POINT")?.numbers(1)?;
        let at = |k: usize| x.get(k).copied().unwrap_or(0.0);
        let p = Vec3::new(at(0), at(1), at(2)) * self.units.length;
        if p.amax() <= FARTHEST {
            Ok(p)
        } else {
            Err(Fault::new(id, format!("point #{id} lies {:.3e} mm away from the origin", p.amax())))
        }
    }

    /// A cartesian point of a parameter plane: no units.
    fn plane_point(&self, id: u64) -> Result<Vec3, Fault> {
        let x = self.records.args(id, "CARTESIAN_POINT")?.numbers(1)?;
        let at = |k: usize| x.get(k).copied().unwrap_or(0.0);
        Ok(Vec3::new(at(0), at(1), 0.0))
    }

    /// A unit direction.
    pub fn direction(&self, id: u64) -> Result<Vec3, Fault> {
        let x = self.records.args(id, "DIRECTION")?.numbers(1)?;
        let at = |k: usize| x.get(k).copied().unwrap_or(0.0);
        let d = Vec3::new(at(0), at(1), at(2));
        let n = d.norm();
        if n > 0.0 && n.is_finite() {
            Ok(d / n)
        } else {
            Err(Fault::new(id, format!("direction #{id} has no length")))
        }
    }

    /// A vector, mm.
    pub fn vector(&self, id: u64) -> Result<Vec3, Fault> {
        let a = self.records.args(id, "VECTOR")?;
        let v = self.direction(a.reference(1)?)? * (a.number(2)? * self.units.length);
        if v.norm() > 0.0 && v.norm() <= FARTHEST {
            Ok(v)
        } else {
            Err(Fault::new(id, format!("vector #{id} has no length, or an absurd one")))
        }
    }

    /// A placement: `AXIS2_PLACEMENT_3D`, `AXIS2_PLACEMENT_2D` or `AXIS1_PLACEMENT`.
    pub fn frame(&self, id: u64) -> Result<Frame, Fault> {
        let r = self.records.get(id)?;
        let a = self.records.simple(id)?;
        let origin = self.point(a.reference(1)?)?;
        let given = |k: usize| a.values.get(k).and_then(as_reference).map(|d| self.direction(d)).transpose();
        let (z, x) = match r.name() {
            "AXIS2_PLACEMENT_3D" => (given(2)?, given(3)?),
            "AXIS1_PLACEMENT" => (given(2)?, None),
            "AXIS2_PLACEMENT_2D" => (None, given(2)?),
            other => return Err(Fault::new(id, format!("#{id} is a {other}, not a placement"))),
        };
        Ok(right_handed(origin, z, x))
    }

    /// A transformation: a placement (to be read as a map from its coordinates) or a transformation operator.
    pub fn placement(&self, id: u64) -> Result<Placement, Fault> {
        let r = self.records.get(id)?;
        let Some(part) = r.parts.iter().find(|p| p.name.starts_with("CARTESIAN_TRANSFORMATION_OPERATOR")) else {
            return self.frame(id).map(|f| Placement::of_frame(&f));
        };
        // (…, axis1, axis2, origin, scale, axis3), after up to three names; in complex instances axis3 has a part of its own.
        let own = r.part("CARTESIAN_TRANSFORMATION_OPERATOR_3D").filter(|_| r.parts.len() > 1);
        let own = own.filter(|p| !std::ptr::eq(*p, part)).map(|p| &p.args);
        let after_names = |n: usize| part.args.len().saturating_sub(n);
        let named = |v: &&Value| matches!(v, Value::Text(_));
        let first = match (own, part.name) {
            (Some(_), _) => after_names(4),
            (None, "CARTESIAN_TRANSFORMATION_OPERATOR_3D") => after_names(5),
            (None, _) => part.args.iter().take_while(named).count(),
        };
        let a = Args { id, values: &part.args };
        let direction = |v: Option<&Value>| v.and_then(as_reference).map(|d| self.direction(d)).transpose();
        let [x, y] = [0, 1].map(|k| direction(a.values.get(first + k)));
        let (x, y) = (x?, y?);
        let z = direction(own.map_or(a.values.get(first + 4), |args| args.last()))?;
        let origin = self.point(a.reference(first + 2)?)?;
        let scale = a.values.get(first + 3).and_then(as_number).unwrap_or(1.0);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Fault::new(id, format!("the scale of #{id} is not a positive number")));
        }
        let mut f = right_handed(origin, z, x);
        if y.is_some_and(|y| y.dot(&f.y) < 0.0) {
            f.y = -f.y;
        }
        let mut out = Placement::of_frame(&f);
        out.linear *= scale;
        Ok(out)
    }

    /// A curve with bounds resolved as far as its definition gives them.
    pub fn resolved_curve(&self, id: u64, depth: u32) -> Result<ResolvedCurve, Fault> {
        if depth > DEEPEST {
            return Err(too_deep(id));
        }
        let r = self.records.get(id)?;
        // The kind is that of a part that says what the curve is made of; others only say that it is one.
        let telling =
            |name: &str| name.contains("SURFACE_CURVE") || name.contains("COMPOSITE") || name.contains("TRIMMED");
        let telling = |p: &&Part| telling(p.name) && !p.args.is_empty();
        let part = r.parts.iter().rev().find(telling).filter(|_| r.parts.len() > 1);
        match part.map_or(r.name(), |p| p.name) {
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "BOUNDED_SURFACE_CURVE" => {
                let args = part.or(r.parts.last()).map_or(&[][..], |p| &p.args);
                let curve = args.iter().find_map(as_reference);
                self.resolved_curve(curve.ok_or_else(|| Fault::new(id, format!("#{id} names no curve")))?, depth + 1)
            }
            "TRIMMED_CURVE" => self.trimmed(id, depth).map(|a| ResolvedCurve::Path(vec![a])),
            "COMPOSITE_CURVE" | "COMPOSITE_CURVE_ON_SURFACE" | "BOUNDARY_CURVE" | "OUTER_BOUNDARY_CURVE" => {
                self.composite(id, depth).map(ResolvedCurve::Path)
            }
            "ORIENTED_CURVE" | "CURVE_REPLICA" => {
                Err(Fault::new(id, format!("a curve of kind {} is not read", r.name())))
            }
            "PCURVE" | "DEGENERATE_PCURVE" => self.traced(id, depth),
            _ => self.basis(id, depth).map(|c| ResolvedCurve::Basis(c, true)),
        }
    }

    /// A basis curve: line, conic, polyline or spline.
    pub fn basis(&self, id: u64, depth: u32) -> Result<SpaceCurve, Fault> {
        self.basis_with(id, depth, &|p| self.point(p), self.units.length)
    }

    /// A basis curve of a parameter plane: numbers as they stand, third coordinate 0.
    pub fn plane_curve(&self, id: u64) -> Result<SpaceCurve, Fault> {
        self.basis_with(id, 0, &|p| self.plane_point(p), 1.0)
    }

    /// A basis curve with points read by `point`, and lengths scaled by `length`.
    fn basis_with(
        &self,
        id: u64,
        depth: u32,
        point: &dyn Fn(u64) -> Result<Vec3, Fault>,
        length: f64,
    ) -> Result<SpaceCurve, Fault> {
        if depth > DEEPEST {
            return Err(too_deep(id));
        }
        let r = self.records.get(id)?;
        let a = self.records.simple(id)?;
        let positive = |k: usize| -> Result<f64, Fault> {
            let x = a.number(k)? * length;
            if x > 0.0 {
                Ok(x)
            } else {
                Err(Fault::new(id, format!("#{id} ({}) has the size {x}; it must be positive", r.name())))
            }
        };
        let frame = |k: usize| -> Result<Frame, Fault> {
            let f = a.reference(k)?;
            let mut frame = self.frame(f)?;
            frame.origin = point(self.records.simple(f)?.reference(1)?)?;
            Ok(frame)
        };
        match r.name() {
            "LINE" => {
                let v = self.records.args(a.reference(2)?, "VECTOR")?;
                let direction = self.direction(v.reference(1)?)? * (v.number(2)? * length);
                if direction.norm() <= 0.0 || direction.norm() > FARTHEST {
                    return Err(Fault::new(id, format!("line #{id} has no direction, or an absurd one")));
                }
                Ok(SpaceCurve::Line { origin: point(a.reference(1)?)?, direction })
            }
            "CIRCLE" => {
                let r = positive(2)?;
                Ok(SpaceCurve::Ellipse { frame: frame(1)?, a: r, b: r })
            }
            "ELLIPSE" => Ok(SpaceCurve::Ellipse { frame: frame(1)?, a: positive(2)?, b: positive(3)? }),
            "PARABOLA" => Ok(SpaceCurve::Parabola { frame: frame(1)?, focal: positive(2)? }),
            "HYPERBOLA" => Ok(SpaceCurve::Hyperbola { frame: frame(1)?, a: positive(2)?, b: positive(3)? }),
            "POLYLINE" => {
                let points = a.references(1)?.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
                self.polyline(id, points)
            }
            _ if r.parts.iter().any(|p| {
                p.name.contains("B_SPLINE_CURVE") || p.name == "BEZIER_CURVE" || p.name.ends_with("UNIFORM_CURVE")
            }) =>
            {
                self.spline_curve(id, point)
            }
            other => Err(Fault::new(id, format!("a curve of kind {other} is not read"))),
        }
    }

    /// A chain of straight pieces, parametrised by the numbers of its corners.
    pub fn polyline(&self, id: u64, mut points: Vec<Vec3>) -> Result<SpaceCurve, Fault> {
        points.dedup();
        let n = points.len();
        if n < 2 {
            return Err(Fault::new(id, format!("polyline #{id} has fewer than two different points")));
        }
        let mut knots = vec![0.0];
        knots.extend((0..n).map(|i| i as f64));
        knots.push((n - 1) as f64);
        let control = points.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect();
        Curve::new(1, knots, control).map(SpaceCurve::Spline).map_err(|e| Fault::new(id, e.to_string()))
    }

    fn spline_curve(&self, id: u64, point: &dyn Fn(u64) -> Result<Vec3, Fault>) -> Result<SpaceCurve, Fault> {
        let r = self.records.get(id)?;
        // Simple: (name, degree, points, form, closed, self_intersect, multiplicities, knots, form).
        // Complex: B_SPLINE_CURVE(degree, points, …), B_SPLINE_CURVE_WITH_KNOTS(multiplicities, knots, form).
        let (body, first) = match r.part("B_SPLINE_CURVE") {
            Some(p) => (Args { id, values: &p.args }, named(&p.args)),
            None => (self.records.simple(id)?, 1),
        };
        let degree = body.count(first)?;
        let points = body.references(first + 1)?.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
        let knots = match r.part("B_SPLINE_CURVE_WITH_KNOTS") {
            Some(p) => {
                let a = Args { id, values: &p.args };
                let k = 6 * named(&p.args);
                expanded(id, &a.numbers(k)?, &a.numbers(k + 1)?)?
            }
            None => implied_knots(id, kind_of_knots(r.parts.iter().map(|p| p.name)), degree, points.len())?,
        };
        let weights = match r.part("RATIONAL_B_SPLINE_CURVE") {
            Some(p) => {
                let a = Args { id, values: &p.args };
                Some(a.numbers(p.args.len().saturating_sub(1))?)
            }
            None => None,
        };
        let mut control = Vec::with_capacity(points.len());
        for (i, p) in points.iter().enumerate() {
            let w = weights.as_ref().map_or(Ok(1.0), |w| {
                w.get(i).copied().filter(|w| *w > 0.0).ok_or_else(|| {
                    Fault::new(id, format!("weight {} of curve #{id} is missing or not positive", i + 1))
                })
            })?;
            control.push([w * p.x, w * p.y, w * p.z, w]);
        }
        Curve::new(degree, knots, control)
            .map(SpaceCurve::Spline)
            .map_err(|e| Fault::new(id, format!("B-spline curve #{id}: {e}")))
    }

    /// The piece of a basis curve between two trims, which are parameters or points.
    fn trimmed(&self, id: u64, depth: u32) -> Result<Arc, Fault> {
        let a = self.records.args(id, "TRIMMED_CURVE")?;
        let basis_id = a.reference(1)?;
        let curve = match self.resolved_curve(basis_id, depth + 1)? {
            ResolvedCurve::Basis(c, _) => c,
            ResolvedCurve::Path(mut p) if p.len() == 1 => p.remove(0).curve,
            ResolvedCurve::Path(_) => {
                return Err(Fault::new(id, format!("#{id} trims a composite curve, which is not read")))
            }
        };
        self.cut(&a, curve, &|p| self.point(p))
    }

    /// The piece of a curve that the arguments of a `TRIMMED_CURVE` state; points are read by `point`.
    fn cut(&self, a: &Args, curve: SpaceCurve, point: &dyn Fn(u64) -> Result<Vec3, Fault>) -> Result<Arc, Fault> {
        let (id, along) = (a.id, a.logical(4, true));
        // Angles of conics come in the unit of the context; lines in their own.
        let factor = if matches!(curve, SpaceCurve::Ellipse { .. }) { self.units.angle } else { 1.0 };
        let trim = |k: usize| -> Result<f64, Fault> {
            let list = a.list(k)?;
            let stated = list.iter().find_map(as_number).filter(|t| t.is_finite()).map(|t| t * factor);
            match (stated, list.iter().find_map(as_reference)) {
                (Some(t), None) => Ok(t),
                (None, Some(p)) => Ok(curve.nearest(&point(p)?)),
                (Some(t), Some(p)) => {
                    // Both are given: where they disagree, by degrees against radians for instance, the point is right.
                    let p = point(p)?;
                    let other = curve.nearest(&p);
                    let [stated, found] = [t, other].map(|t| (curve.point(t) - p).norm());
                    Ok(if stated > TRIMS_DISAGREE && found < 0.1 * stated { other } else { t })
                }
                (None, None) => Err(Fault::new(id, format!("trim {k} of #{id} is neither a point nor a parameter"))),
            }
        };
        let (from, mut to) = (trim(2)?, trim(3)?);
        if let Some(period) = curve.period() {
            // The way round is that of the sense; equal trims are a full turn.
            let way = if along { to - from } else { from - to };
            let way = way.rem_euclid(period);
            let way = if way <= WHOLE_TURN * period { period } else { way };
            to = if along { from + way } else { from - way };
        }
        Ok(Arc { curve, from, to })
    }

    fn composite(&self, id: u64, depth: u32) -> Result<Vec<Arc>, Fault> {
        self.segments(id, depth).map(|s| s.into_iter().map(|s| s.1).collect())
    }

    /// The pieces of a composite curve, each with the number of its segment.
    pub fn segments(&self, id: u64, depth: u32) -> Result<Vec<(u64, Arc)>, Fault> {
        let (mut numbers, mut out): (Vec<u64>, Vec<Arc>) = (Vec::new(), Vec::new());
        let parts = &self.records.get(id)?.parts;
        let list = parts.iter().flat_map(|p| &p.args).find_map(|v| match v {
            Value::List(l) => Some(l.iter().filter_map(as_reference).collect::<Vec<u64>>()),
            _ => None,
        });
        let segments = list.ok_or_else(|| Fault::new(id, format!("composite curve #{id} lists no segments")))?;
        for s in &segments {
            let r = self.records.get(*s)?;
            let part = r.parts.iter().find(|p| p.name == "COMPOSITE_CURVE_SEGMENT");
            let part = part.ok_or_else(|| Fault::new(*s, format!("#{s} is not a segment of a composite curve")))?;
            let a = Args { id: *s, values: &part.args };
            let mut path = match self.resolved_curve(a.reference(2)?, depth + 1)? {
                ResolvedCurve::Path(p) => p,
                ResolvedCurve::Basis(c, along) => {
                    let (from, to) =
                        c.domain().ok_or_else(|| Fault::new(*s, format!("segment #{s} is an endless curve")))?;
                    let arc = Arc { curve: c, from, to };
                    vec![if along { arc } else { arc.reversed() }]
                }
            };
            if !a.logical(1, true) {
                path = path.iter().rev().map(Arc::reversed).collect();
            }
            numbers.extend(path.iter().map(|_| *s));
            out.extend(path);
        }
        if out.is_empty() {
            return Err(Fault::new(id, format!("composite curve #{id} has no segments")));
        }
        Ok(numbers.into_iter().zip(following(out)).collect())
    }

    /// A curve given only in the parameter plane of a surface.
    fn traced(&self, id: u64, depth: u32) -> Result<ResolvedCurve, Fault> {
        let a = self.records.simple(id)?;
        let support = self.surface(a.reference(1)?, depth + 1)?;
        if support.recast {
            let what = format!("the parameter curve #{id} on an offset of a swept surface is not read");
            return Err(Fault::new(id, what));
        }
        let definition = self.records.simple(a.reference(2)?)?;
        let item = definition.references(1)?.first().copied();
        let item = item.ok_or_else(|| Fault::new(id, format!("#{id} has no curve")))?;
        let scale = support.parameter_units(self.units);
        if self.records.name(item) != "TRIMMED_CURVE" {
            let flat = self.plane_curve(item)?;
            return Ok(ResolvedCurve::Basis(SpaceCurve::traced(flat, support.support, scale), true));
        }
        let Arc { curve, from, to } = self.trimmed_in_plane(item)?;
        Ok(ResolvedCurve::Path(vec![Arc { curve: SpaceCurve::traced(curve, support.support, scale), from, to }]))
    }

    /// The piece of a curve of a parameter plane between two trims.
    fn trimmed_in_plane(&self, id: u64) -> Result<Arc, Fault> {
        let a = self.records.args(id, "TRIMMED_CURVE")?;
        let curve = self.plane_curve(a.reference(1)?)?;
        self.cut(&a, curve, &|p| self.plane_point(p))
    }
}

/// Distance (mm) between a point and a parameter of one trim above which they disagree: more than printing loses.
const TRIMS_DISAGREE: f64 = 1e-3;
/// Ways round shorter than this share of the period are whole turns: equal trims, up to rounding.
const WHOLE_TURN: f64 = 1e-12;
/// A segment is turned round where that brings it nearer by this factor to the one before.
const CLEARLY: f64 = 1e-2;

/// Segments that begin nearer to where the one before ends than this share of their extent do follow it.
const TOUCHES: f64 = 1e-6;

/// Segments that follow each other: senses in files are not reliable, so a segment that ends where it should begin is
/// turned round.
fn following(mut path: Vec<Arc>) -> Vec<Arc> {
    for i in 1..path.len() {
        let (start, end) = path[i].ends();
        let last = path[i - 1].ends().1;
        let (there, back) = ((start - last).norm(), (end - last).norm());
        let middle = path[i].curve.point(0.5 * (path[i].from + path[i].to));
        if there <= TOUCHES * (middle - start).norm() {
            // A closed piece begins and ends there: which way it runs is for the file to say.
            continue;
        }
        if i == 1 {
            // The first has nothing before it: it is turned if that alone makes the second fit.
            let first = path[0].ends().0;
            let turned = (start - first).norm().min((end - first).norm());
            if turned < CLEARLY * there.min(back) {
                path[0] = path[0].reversed();
                if (end - first).norm() < CLEARLY * (start - first).norm() {
                    path[1] = path[1].reversed();
                }
                continue;
            }
        }
        if back < CLEARLY * there {
            path[i] = path[i].reversed();
        }
    }
    path
}

/// 1 if arguments begin with a name, be it `$`; the parts of complex instances have none.
fn named(args: &[Value]) -> usize {
    usize::from(matches!(args.first(), Some(Value::Text(_) | Value::Null | Value::Derived)))
}

/// Which implied knots a spline without knots of its own has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ImpliedKnots {
    Uniform,
    QuasiUniform,
    Bezier,
}

/// The kind of knots that the keywords of an instance imply.
pub(super) fn kind_of_knots<'x>(names: impl Iterator<Item = &'x str>) -> ImpliedKnots {
    let mut out = ImpliedKnots::QuasiUniform;
    for n in names {
        if n.starts_with("BEZIER") {
            out = ImpliedKnots::Bezier;
        } else if n.starts_with("UNIFORM") {
            out = ImpliedKnots::Uniform;
        }
    }
    out
}

/// Knots of ISO 10303-42 for uniform, quasi-uniform and piecewise Bézier splines.
pub(super) fn implied_knots(id: u64, kind: ImpliedKnots, degree: usize, control: usize) -> Result<Vec<f64>, Fault> {
    if degree == 0 || control <= degree {
        return Err(Fault::new(id, format!("#{id}: {control} control points are too few for degree {degree}")));
    }
    let ends = |inner: Vec<f64>, last: f64| {
        let mut k = vec![0.0; degree + 1];
        k.extend(inner);
        k.extend(std::iter::repeat_n(last, degree + 1));
        k
    };
    match kind {
        ImpliedKnots::Uniform => Ok((0..=control + degree).map(|i| i as f64 - degree as f64).collect()),
        ImpliedKnots::QuasiUniform => {
            let spans = control - degree;
            Ok(ends((1..spans).map(|i| i as f64).collect(), spans as f64))
        }
        ImpliedKnots::Bezier => {
            if !(control - 1).is_multiple_of(degree) {
                return Err(Fault::new(
                    id,
                    format!("#{id}: {control} control points do not make Bézier pieces of degree {degree}"),
                ));
            }
            let pieces = (control - 1) / degree;
            Ok(ends((1..pieces).flat_map(|i| std::iter::repeat_n(i as f64, degree)).collect(), pieces as f64))
        }
    }
}

/// Knots with multiplicities written out.
pub(super) fn expanded(id: u64, multiplicities: &[f64], knots: &[f64]) -> Result<Vec<f64>, Fault> {
    if multiplicities.len() != knots.len() {
        let (m, k) = (multiplicities.len(), knots.len());
        return Err(Fault::new(id, format!("#{id} has {k} knots but {m} multiplicities")));
    }
    let mut out = Vec::new();
    for (&m, &k) in multiplicities.iter().zip(knots) {
        if !(1.0..=1000.0).contains(&m) {
            return Err(Fault::new(id, format!("#{id} has a knot of multiplicity {m}")));
        }
        out.extend(std::iter::repeat_n(k, m as usize));
    }
    Ok(out)
}

/// Sine of the angle between given axes below which they are parallel: ten printed digits.
const PARALLEL: f64 = 1e-9;

/// The frame with the given axes, completed and made square as ISO 10303-42 prescribes.
fn right_handed(origin: Vec3, z: Option<Vec3>, x: Option<Vec3>) -> Frame {
    let z = z.unwrap_or_else(Vec3::z);
    let start = x.unwrap_or_else(Vec3::x);
    let mut x = start - z * z.dot(&start);
    // Any direction square to z serves.
    if x.norm() < PARALLEL {
        let other = if z.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() };
        x = other - z * z.dot(&other);
    }
    let x = x.normalize();
    Frame { origin, x, y: z.cross(&x), z }
}
