//! Offset surfaces: exact for the support surfaces whose offsets are of their own kind, interpolated for the rest. The offset of an
//! extruded curve is the extruded offset of it: a stretch is interpolated, and one of its parameter lines extruded anew. So is that of
//! a curve turned about an axis in its plane: across that plane the curve is extruded, and one line turned anew.

use super::offset_bound::distance_from_offset;
use super::raw::SurfaceDeviation;
use super::space_curve::{SpaceCurve, COINCIDENT};
use super::support_surface::{SplineSupport, SupportSurface};
use super::swept;
use crate::geom::{BBox, Frame, Vec3};
use crate::spline::bezier::Bezier;
use crate::spline::curve::bezier_pieces;
use crate::spline::knots::Knots;
use crate::spline::surface::{Surface, NO_NORMAL};
use crate::spline::SplineError;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Why an offset cannot be formed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum OffsetError {
    /// The offset passes the centre of curvature.
    #[error("an offset of {0} mm passes the axis or centre of the surface")]
    Vanishes(f64),
    /// The surface has no own bounds, so it cannot be sampled.
    #[error("the offset of an endless swept surface is read where a spline or a conic is moved, or turned in the plane of its axis, and the edges of the face tell how far a parabola or hyperbola goes")]
    Endless,
    /// The normal is not defined everywhere.
    #[error("the surface has a point without a normal, where its offset is not defined")]
    NoNormal,
    /// The interpolation did not come near.
    #[error("the offset could only be represented to {0:.3e} mm")]
    TooRough(f64),
    /// The spline kernel refused.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// Interpolated offsets are refined until they are this near, as a share of the surface's extent.
const NEAR_SHARE: f64 = 1e-7;
/// The worst share that is still accepted (and reported with the face).
const ACCEPTED_SHARE: f64 = 1e-4;
/// Degree of interpolated offsets at most.
const HIGHEST: usize = 5;
/// Rounds of halving all knot spans.
const ROUNDS: usize = 4;

/// The stretch of the curve that sweeps a surface, in natural parameters, of which an offset is read: all of a spline or an ellipse;
/// of a parabola or hyperbola what reaches a little beyond `places` (mm) of the offset, else what `rectangle` says, which some programs
/// give in parameters of their own. `None` where that is not known, and for surfaces that no such curve sweeps.
pub(crate) fn stretch_of(
    base: &SupportSurface,
    rectangle: Option<[(f64, f64); 2]>,
    places: &[Vec3],
) -> Option<(f64, f64)> {
    let (axis, directrix) = swept_by(base)?;
    match directrix {
        SpaceCurve::Spline(c) => Some(c.domain()),
        SpaceCurve::Ellipse { .. } => Some((0.0, TAU)),
        SpaceCurve::Parabola { .. } | SpaceCurve::Hyperbola { .. } => {
            let feet = places.iter().map(|x| base.foot(x, None)[axis]);
            let (lo, hi) = feet.fold((f64::INFINITY, f64::NEG_INFINITY), |b, t| (b.0.min(t), b.1.max(t)));
            let beyond = BEYOND * (hi - lo);
            (lo < hi).then_some((lo - beyond, hi + beyond)).or_else(|| rectangle.map(|r| r[axis]))
        }
        SpaceCurve::Line { .. } | SpaceCurve::Traced(_) => None,
    }
}

/// The curve that sweeps a surface, and which parameter of the surface is that of the curve.
fn swept_by(base: &SupportSurface) -> Option<(usize, &SpaceCurve)> {
    match base {
        SupportSurface::Extrusion { directrix, .. } => Some((0, directrix)),
        SupportSurface::Revolution { directrix, .. } => Some((1, directrix)),
        _ => None,
    }
}

/// The surface at the signed `distance` (mm) along the normal `S_u × S_v`, with what is known of its deviation (mm); of a swept one
/// over the `stretch` of its curve that [`stretch_of`] tells.
///
/// # Errors
/// See [`OffsetError`].
pub(crate) fn of_support(
    base: &SupportSurface,
    distance: f64,
    stretch: Option<(f64, f64)>,
) -> Result<(SupportSurface, SurfaceDeviation), OffsetError> {
    let positive = |x: f64| if x > 0.0 { Ok(x) } else { Err(OffsetError::Vanishes(distance)) };
    let exact = |c: SupportSurface| Ok((c, SurfaceDeviation::NONE));
    match base {
        SupportSurface::Plane(f) => exact(SupportSurface::Plane(Frame { origin: f.origin + f.z * distance, ..*f })),
        SupportSurface::Cylinder { frame, radius } => {
            exact(SupportSurface::Cylinder { frame: *frame, radius: positive(radius + distance)? })
        }
        SupportSurface::Cone { frame, radius, slope } => {
            // The normal is (cos a, −sin a) in the half plane; the new line has the same slope. The offset keeps the
            // parameter v of its foot up to a shift along the axis.
            let (cos, sin) = (1.0 / slope.hypot(1.0), slope / slope.hypot(1.0));
            let origin = frame.origin - frame.z * (distance * sin);
            exact(SupportSurface::Cone {
                frame: Frame { origin, ..*frame },
                radius: radius + distance * cos,
                slope: *slope,
            })
        }
        SupportSurface::Sphere { frame, radius } => {
            exact(SupportSurface::Sphere { frame: *frame, radius: positive(radius + distance)? })
        }
        SupportSurface::Torus { frame, major, minor } => {
            exact(SupportSurface::Torus { frame: *frame, major: *major, minor: positive(minor + distance)? })
        }
        SupportSurface::Spline(_) if distance == 0.0 => exact(base.clone()),
        SupportSurface::Spline(s) => interpolated(&s.surface, distance),
        SupportSurface::Extrusion { .. } if distance == 0.0 => exact(base.clone()),
        SupportSurface::Extrusion { directrix, direction } => {
            let range = stretch.ok_or(OffsetError::Endless)?;
            let (line, deviation) = beside((directrix, range), direction, distance)?;
            Ok((SupportSurface::Extrusion { directrix: line, direction: *direction }, deviation))
        }
        SupportSurface::Revolution { .. } if distance == 0.0 => exact(base.clone()),
        SupportSurface::Revolution { directrix, frame } => {
            turned((directrix, stretch.ok_or(OffsetError::Endless)?), frame, distance)
        }
    }
}

/// Whether the offset of a surface has its natural parameters: where an ellipse or a hyperbola is swept it has those of a spline.
pub(crate) fn keeps_parameters(base: &SupportSurface) -> bool {
    let is_recast = |c: &SpaceCurve| matches!(c, SpaceCurve::Ellipse { .. } | SpaceCurve::Hyperbola { .. });
    !swept_by(base).is_some_and(|s| is_recast(s.1))
}

/// A rectangle of natural parameters of a surface in those of its offset over a `stretch`.
pub(crate) fn rectangle_of_offset(
    base: &SupportSurface,
    mut rectangle: [(f64, f64); 2],
    stretch: Option<(f64, f64)>,
) -> [(f64, f64); 2] {
    let (Some((axis, curve)), Some((from, to))) = (swept_by(base), stretch) else { return rectangle };
    if keeps_parameters(base) {
        return rectangle;
    }
    let Ok((_, map)) = curve.to_spline(from, to) else { return rectangle };
    let forward = |t: f64| match curve {
        // Turn by turn, as the map is for one.
        SpaceCurve::Ellipse { .. } => map.forward(t.rem_euclid(TAU)) + (t / TAU).floor() * TAU,
        _ => map.forward(t),
    };
    rectangle[axis] = (forward(rectangle[axis].0), forward(rectangle[axis].1));
    rectangle
}

/// Share of the stretch of a parabola or hyperbola along the edges of a face by which its offset goes on: edges reach farther
/// than the places that are looked at, where holes or slanting ends do.
const BEYOND: f64 = 0.25;

/// The curve whose extrusion is the offset of that of `directrix` over a range. Normals are the same all along a ruling, so that what
/// a stretch of the offset is off holds for all of it.
fn beside(
    (directrix, range): (&SpaceCurve, (f64, f64)),
    direction: &Vec3,
    distance: f64,
) -> Result<(SpaceCurve, SurfaceDeviation), OffsetError> {
    let points: Vec<Vec3> = directrix.stations(range.0, range.1).iter().map(|t| directrix.point(*t)).collect();
    // A parabola or hyperbola is one span, whose offset takes a higher degree to come near.
    let raised = match directrix {
        SpaceCurve::Parabola { .. } | SpaceCurve::Hyperbola { .. } => {
            Some(SpaceCurve::Spline(directrix.to_spline(range.0, range.1)?.0.elevated_to(HIGHEST)?))
        }
        _ => None,
    };
    let directrix = raised.as_ref().unwrap_or(directrix);
    // A stretch about as long as the curve.
    let long = BBox::of(&points).diagonal() / direction.norm();
    let (stretch, _) = swept::extrude(directrix, direction, range, (0.0, long))?;
    let (support, deviation) = interpolated(&stretch, distance)?;
    let SupportSurface::Spline(offset) = support else { return Err(OffsetError::Endless) };
    let line = offset.surface.curve_at_v(offset.surface.knots_v.domain().0);
    Ok((SpaceCurve::Spline(line), deviation))
}

/// Share of the size within which a curve lies in the plane of its axis: rounding of coordinates.
const IN_PLANE: f64 = 1e-12;
/// Against what a curve is off that plane, by how much more its offset may be off: normals lean by more than points move. An
/// allowance for rounding, not enclosed.
const LEAN: f64 = 1e3;
/// Halvings of a piece of a curve that is to be on one side of the axis, at most.
const HALVINGS: usize = 8;

/// The offset of a surface of revolution: that of its curve in the plane of the axis, turned.
fn turned(
    (directrix, range): (&SpaceCurve, (f64, f64)),
    frame: &Frame,
    distance: f64,
) -> Result<(SupportSurface, SurfaceDeviation), OffsetError> {
    // The curve is in every plane that holds these.
    let within: Vec<Vec3> = match directrix {
        SpaceCurve::Spline(c) => c.control.iter().map(|h| Vec3::new(h[0], h[1], h[2]) / h[3]).collect(),
        SpaceCurve::Ellipse { frame: own, a, b } => {
            vec![own.origin, own.origin + own.x * *a, own.origin + own.y * *b]
        }
        SpaceCurve::Parabola { .. } | SpaceCurve::Hyperbola { .. } => {
            [range.0, 0.5 * (range.0 + range.1), range.1].map(|t| directrix.point(t)).to_vec()
        }
        _ => return Err(OffsetError::Endless),
    };
    let own: Vec<Vec3> = within.iter().map(|p| frame.to_local(p)).collect();
    let Some(far) = own.iter().max_by(|p, q| p.x.hypot(p.y).total_cmp(&q.x.hypot(q.y))) else {
        return Err(OffsetError::Endless);
    };
    let size = own.iter().fold(distance.abs(), |m: f64, p| m.max(p.amax()));
    // To the side of the axis on which the curve is.
    let middle = frame.to_local(&directrix.point(0.5 * (range.0 + range.1)));
    let side = if far.x * middle.x + far.y * middle.y < 0.0 { -1.0 } else { 1.0 };
    let out = Vec3::new(far.x, far.y, 0.0).normalize() * side;
    let off = own.iter().map(|p| (out.x * p.y - out.y * p.x).abs()).fold(0.0, f64::max);
    let is_flat = off <= IN_PLANE * size;
    if !is_flat {
        return Err(OffsetError::Endless);
    }
    let outward = frame.vector_to_world(&out);
    let is_beside = |curve: &SpaceCurve| is_on_side((curve, range), &frame.origin, &outward, COINCIDENT * size);
    if !is_beside(directrix) {
        return Err(OffsetError::Endless);
    }
    // Turned, the curve moves along z × out first, and the normal is that of the surface moved against it.
    let across = frame.vector_to_world(&Vec3::new(out.y, -out.x, 0.0));
    let (line, deviation) = beside((directrix, range), &across, distance)?;
    if !is_beside(&line) {
        return Err(OffsetError::Vanishes(distance));
    }
    let bound = (deviation.bound + LEAN * off).next_up();
    Ok((SupportSurface::Revolution { directrix: line, frame: *frame }, SurfaceDeviation { bound, ..deviation }))
}

/// Whether a curve is nowhere farther than `least` (mm) behind a plane, by the coefficients of its pieces.
fn is_on_side((curve, range): (&SpaceCurve, (f64, f64)), origin: &Vec3, normal: &Vec3, least: f64) -> bool {
    let curve = match curve {
        SpaceCurve::Spline(c) => Ok(c.clone()),
        other => other.to_spline(range.0, range.1).map(|(c, _)| c),
    };
    fn is_positive(height: &Bezier<1>, halvings: usize) -> bool {
        height.hull()[0].0 >= 0.0
            || halvings > 0 && {
                let (a, b) = height.split(0.5);
                is_positive(&a, halvings - 1) && is_positive(&b, halvings - 1)
            }
    }
    curve.is_ok_and(|c| {
        bezier_pieces(&c).into_iter().all(|(_, _, control)| {
            let height = |h: [f64; 4]| [normal.dot(&(Vec3::new(h[0], h[1], h[2]) - origin * h[3])) + least * h[3]];
            is_positive(&Bezier::new(control.into_iter().map(height).collect()), HALVINGS)
        })
    })
}

/// Interpolates the offset at Greville points over ever finer knots. What it is off is proven, not sampled.
fn interpolated(s: &Surface, distance: f64) -> Result<(SupportSurface, SurfaceDeviation), OffsetError> {
    let size = s.bbox().diagonal();
    let at = |u: f64, v: f64| -> Result<Vec3, OffsetError> {
        let j = s.jet(u, v);
        let n = j.normal();
        let length = n.norm();
        if length > NO_NORMAL * j.du.norm() * j.dv.norm() && length > 0.0 {
            Ok(j.p + n * (distance / length))
        } else {
            Err(OffsetError::NoNormal)
        }
    };
    let mut best: Option<(Surface, f64)> = None;
    for round in 1..=ROUNDS {
        let (ku, kv) = (refined(&s.knots_u, 1 << round)?, refined(&s.knots_v, 1 << round)?);
        if ku.control_count() > 400 || kv.control_count() > 400 {
            break;
        }
        let (gu, gv) = (greville(&ku), greville(&kv));
        let mut samples = Vec::with_capacity(gu.len() * gv.len());
        for &u in &gu {
            for &v in &gv {
                samples.push(at(u, v)?);
            }
        }
        let Some(points) = interpolate(&ku, &kv, &gu, &gv, &samples) else { break };
        let out = Surface::new(ku.clone(), kv.clone(), &points, None)?;
        let mut worst = 0.0_f64;
        for w in middles(&ku) {
            for z in middles(&kv) {
                worst = worst.max((out.point(w, z) - at(w, z)?).norm());
            }
        }
        if best.as_ref().is_none_or(|b| worst < b.1) {
            best = Some((out, worst));
        }
        if worst <= NEAR_SHARE * size {
            break;
        }
    }
    match best {
        Some((out, worst)) if worst <= ACCEPTED_SHARE * size => {
            let bound = distance_from_offset(&out, s, distance, worst);
            Ok((SupportSurface::Spline(SplineSupport::new(out)), SurfaceDeviation { estimate: worst, bound }))
        }
        Some((_, worst)) => Err(OffsetError::TooRough(worst)),
        None => Err(OffsetError::NoNormal),
    }
}

/// Knots of degree at least 3 with the continuity of the old breaks lowered by one, each span cut in `parts`.
fn refined(k: &Knots, parts: usize) -> Result<Knots, SplineError> {
    let degree = k.degree().clamp(3, HIGHEST);
    let (a, b) = k.domain();
    let mut values = vec![a; degree + 1];
    let distinct = k.distinct();
    let breaks = k.breaks();
    for w in breaks.windows(2) {
        values.extend((1..parts).map(|i| w[0] + (w[1] - w[0]) * i as f64 / parts as f64));
        if w[1] < b {
            let m = distinct.iter().find(|d| d.0 >= w[1]).map_or(1, |d| d.1);
            // Normals lose one derivative, and a higher degree keeps the old continuity with more knots.
            values.extend(std::iter::repeat_n(w[1], (m + 1 + degree.saturating_sub(k.degree())).min(degree)));
        }
    }
    values.extend(std::iter::repeat_n(b, degree + 1));
    let control = values.len() - degree - 1;
    Knots::new(degree, values, control)
}

fn greville(k: &Knots) -> Vec<f64> {
    let p = k.degree();
    let (a, b) = k.domain();
    (0..k.control_count()).map(|i| (k.values()[i + 1..=i + p].iter().sum::<f64>() / p as f64).clamp(a, b)).collect()
}

fn middles(k: &Knots) -> Vec<f64> {
    k.breaks().windows(2).flat_map(|w| [0.25, 0.5, 0.8].map(|s| w[0] + s * (w[1] - w[0]))).collect()
}

/// Tensor-product interpolation; `None` if the matrices are singular.
fn interpolate(ku: &Knots, kv: &Knots, gu: &[f64], gv: &[f64], samples: &[Vec3]) -> Option<Vec<Vec3>> {
    let matrix = |k: &Knots, g: &[f64]| {
        let mut m = DMatrix::<f64>::zeros(g.len(), g.len());
        for (r, &t) in g.iter().enumerate() {
            let b = k.basis(t, 0);
            for j in 0..=k.degree() {
                m[(r, b.first + j)] = b.rows[0][j];
            }
        }
        m.lu()
    };
    let (mu, mv) = (matrix(ku, gu), matrix(kv, gv));
    let (n, m) = (gu.len(), gv.len());
    let mut out = vec![Vec3::zeros(); n * m];
    for d in 0..3 {
        let q = DMatrix::from_fn(n, m, |i, j| samples[i * m + j][d]);
        let half = mu.solve(&q)?;
        let full = mv.solve(&half.transpose())?;
        for i in 0..n {
            for j in 0..m {
                out[i * m + j][d] = full[(j, i)];
            }
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;

    /// The offset of a surface whose curve says how far it goes.
    fn offset_of(base: &SupportSurface, distance: f64) -> Result<(SupportSurface, SurfaceDeviation), OffsetError> {
        of_support(base, distance, stretch_of(base, None, &[]))
    }

    #[test]
    fn offsets_lie_at_the_distance() {
        let f = Frame::world();
        let supports = [
            SupportSurface::Plane(f),
            SupportSurface::Cylinder { frame: f, radius: 3.0 },
            SupportSurface::Cone { frame: f, radius: 3.0, slope: 0.5 },
            SupportSurface::Sphere { frame: f, radius: 3.0 },
            SupportSurface::Torus { frame: f, major: 5.0, minor: 2.0 },
        ];
        for c in supports {
            let (o, deviation) = offset_of(&c, -0.5).expect("an offset");
            assert_eq!(deviation, SurfaceDeviation::NONE);
            for q in [[0.3, 0.2], [2.0, -0.7]] {
                let j = c.jet(q);
                let x = j.p - j.du.cross(&j.dv).normalize() * 0.5;
                let foot = o.jet(o.foot(&x, None));
                assert!((foot.p - x).norm() < 1e-12, "{c:?}");
            }
        }
        assert!(offset_of(&SupportSurface::Sphere { frame: f, radius: 1.0 }, -2.0).is_err());
    }

    /// A bicubic over four cells; its weights go from 1 to `heaviest`.
    fn wave(heaviest: f64) -> Surface {
        let k = Knots::uniform(3, 2, 0.0, 1.0).expect("knots");
        let points: Vec<Vec3> =
            (0..25).map(|k| Vec3::new((k / 5) as f64, (k % 5) as f64, ((k * k) as f64 * 0.01).sin())).collect();
        let weights: Vec<f64> = (0..25).map(|k| 1.0 + (heaviest - 1.0) * f64::from(k * 7 % 25) / 24.0).collect();
        Surface::new(k.clone(), k, &points, (heaviest != 1.0).then_some(&weights[..])).expect("surface")
    }

    /// Largest distance of a surface from the offset, at many samples.
    fn seen(o: &Surface, s: &Surface, distance: f64) -> f64 {
        let at = |i: u32| f64::from(i) / 61.0;
        let off = |u: f64, v: f64| {
            let j = s.jet(u, v);
            (o.point(u, v) - j.p - j.normal().normalize() * distance).norm()
        };
        (0..=61).flat_map(|i| (0..=61).map(move |j| off(at(i), at(j)))).fold(0.0, f64::max)
    }

    #[test]
    fn what_a_spline_offset_is_off_is_proven() {
        for (heaviest, distance) in [(1.0, 0.2), (1.0, -0.3), (1.5, 0.2)] {
            let s = wave(heaviest);
            let (o, deviation) =
                offset_of(&SupportSurface::Spline(SplineSupport::new(s.clone())), distance).expect("an offset");
            let SupportSurface::Spline(o) = o else { unreachable!() };
            let worst = seen(&o.surface, &s, distance);
            assert!(worst > 0.0 && deviation.bound < 1e-4);
            assert!(worst <= deviation.bound, "{worst:e} {deviation:?}");
            assert!(deviation.bound <= 3.0 * worst + 1e-11, "{worst:e} {deviation:?}");
        }
    }

    /// Offsets at places of the base are on the offset, within what is proven.
    fn are_beside(
        base: &SupportSurface,
        (o, deviation): (&SupportSurface, SurfaceDeviation),
        distance: f64,
        places: &[[f64; 2]],
    ) {
        for q in places {
            let j = base.jet(*q);
            let x = j.p + j.du.cross(&j.dv).normalize() * distance;
            let off = (o.jet(o.foot(&x, None)).p - x).norm();
            assert!(off <= deviation.bound + 1e-9, "{q:?}: {off:e} {deviation:?}");
        }
    }

    #[test]
    fn the_offset_of_a_turned_curve_is_turned() {
        let f = Frame::world();
        let upright = Frame { origin: Vec3::new(100.0, 0.0, 5.0), x: Vec3::x(), y: Vec3::z(), z: -Vec3::y() };
        let ring = SpaceCurve::Ellipse { frame: upright, a: 40.0, b: 25.0 };
        let knots = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        // A dish from the axis, and the same on the other side of it.
        let dish = |side: f64| {
            let control = [[0.0, 0.0], [20.0, 0.0], [30.0, 5.0], [30.0, 20.0]].map(|[x, z]| [side * x, 0.0, z, 1.0]);
            SpaceCurve::Spline(Curve { knots: knots.clone(), control: control.to_vec() })
        };
        for (directrix, places) in
            [(ring, [0.1, 2.37, 5.8]), (dish(1.0), [0.01, 0.4, 0.9]), (dish(-1.0), [0.01, 0.4, 0.9])]
        {
            let base = SupportSurface::Revolution { directrix, frame: f };
            for distance in [3.0, -5.0] {
                let (o, deviation) = offset_of(&base, distance).expect("an offset");
                assert!(matches!(o, SupportSurface::Revolution { .. }) && deviation.bound < 1e-2, "{deviation:?}");
                let places: Vec<[f64; 2]> = places.iter().map(|v| [7.0 * v, *v]).collect();
                are_beside(&base, (&o, deviation), distance, &places);
            }
        }
        // A tube thinner than its ring goes through the axis when it is made thick; curves through the axis, and those that leave their
        // plane, are no meridians.
        let thick = SupportSurface::Revolution {
            directrix: SpaceCurve::Ellipse { frame: upright, a: 40.0, b: 25.0 },
            frame: f,
        };
        assert!(matches!(offset_of(&thick, 70.0), Err(OffsetError::Vanishes(_))));
        let through = [[30.0, 0.0], [10.0, 5.0], [-40.0, 10.0], [30.0, 20.0]].map(|[x, z]| [x, 0.0, z, 1.0]);
        let directrix = SpaceCurve::Spline(Curve { knots, control: through.to_vec() });
        assert_eq!(offset_of(&SupportSurface::Revolution { directrix, frame: f }, 1.0), Err(OffsetError::Endless));
        let leaning = Frame { x: Vec3::new(0.8, 0.6, 0.0), z: Vec3::new(0.6, -0.8, 0.0), ..upright };
        let directrix = SpaceCurve::Ellipse { frame: leaning, a: 40.0, b: 25.0 };
        assert_eq!(offset_of(&SupportSurface::Revolution { directrix, frame: f }, 1.0), Err(OffsetError::Endless));
    }

    #[test]
    fn the_offset_of_an_extruded_curve_is_as_endless_as_it_is() {
        let knots = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let control = [[0.0, 0.0], [10.0, 8.0], [20.0, -8.0], [30.0, 0.0]].map(|[x, y]| [x, y, 0.0, 1.0]);
        let wave = SpaceCurve::Spline(Curve { knots, control: control.to_vec() });
        let base = SupportSurface::Extrusion { directrix: wave, direction: Vec3::new(0.0, 0.3, 1.0) };
        for distance in [2.0, -1.5] {
            let (o, deviation) = offset_of(&base, distance).expect("an offset");
            assert!(matches!(o, SupportSurface::Extrusion { .. }) && deviation.bound < 1e-3, "{deviation:?}");
            are_beside(&base, (&o, deviation), distance, &[[0.1, -400.0], [0.37, 0.0], [0.8, 3000.0]]);
        }
        let directrix = SpaceCurve::Ellipse { frame: Frame::world(), a: 40.0, b: 25.0 };
        let base = SupportSurface::Extrusion { directrix, direction: Vec3::new(0.0, 0.3, 1.0) };
        for distance in [2.0, -5.0] {
            let (o, deviation) = offset_of(&base, distance).expect("an offset");
            assert!(o.periods()[0].is_some() && deviation.bound < 1e-2 && !keeps_parameters(&base), "{deviation:?}");
            // Ends of a rectangle beyond one turn are at the same places of both.
            let [(from, to), _] =
                rectangle_of_offset(&base, [(2.0, TAU + 1.0), (0.0, 1.0)], stretch_of(&base, None, &[]));
            for (t, u) in [(2.0, from), (TAU + 1.0, to)] {
                let j = base.jet([t, 0.0]);
                let x = j.p + j.du.cross(&j.dv).normalize() * distance;
                assert!((o.jet([u, 0.0]).p - x).norm() < deviation.bound + 1e-9, "{t} {u}");
            }
            assert!((0.0..TAU).contains(&(to - from)));
            are_beside(&base, (&o, deviation), distance, &[[0.1, -400.0], [2.37, 0.0], [5.8, 3000.0]]);
        }
        let directrix = SpaceCurve::Parabola { frame: Frame::world(), focal: 1.0 };
        assert!(offset_of(&SupportSurface::Extrusion { directrix, direction: Vec3::z() }, 1.0).is_err());
    }

    /// Curvature radii from 40 and 26.7 mm up, so that there is room to both sides.
    #[test]
    fn the_offset_of_a_swept_parabola_or_hyperbola_reaches_beyond_the_places_of_its_face() {
        let f = Frame::world();
        for directrix in
            [SpaceCurve::Parabola { frame: f, focal: 20.0 }, SpaceCurve::Hyperbola { frame: f, a: 60.0, b: 40.0 }]
        {
            let base = SupportSurface::Extrusion { directrix, direction: Vec3::new(0.2, 0.0, 1.0) };
            for distance in [5.0, -5.0] {
                let beside = |t: f64| {
                    let j = base.jet([t, 30.0 * t]);
                    j.p + j.du.cross(&j.dv).normalize() * distance
                };
                let stretch = stretch_of(&base, None, &[beside(-1.5), beside(0.5)]).expect("a stretch");
                assert!((stretch.0 + 2.0).abs() < 1e-9 && (stretch.1 - 1.0).abs() < 1e-9, "{stretch:?}");
                let (o, deviation) = of_support(&base, distance, Some(stretch)).expect("an offset");
                assert!(deviation.bound < 1e-3, "{deviation:?}");
                are_beside(&base, (&o, deviation), distance, &[[-1.9, -400.0], [-0.3, 0.0], [0.9, 3000.0]]);
                let [(from, to), _] = rectangle_of_offset(&base, [(-1.5, 0.5), (0.0, 1.0)], Some(stretch));
                for (t, u) in [(-1.5, from), (0.5, to)] {
                    let x = base.jet([t, 0.0]);
                    let x = x.p + x.du.cross(&x.dv).normalize() * distance;
                    assert!((o.jet([u, 0.0]).p - x).norm() < deviation.bound + 1e-9, "{t} {u}");
                }
            }
            // Where there are no places, a rectangle says how far it goes.
            let rectangle = Some([(-100.0, 100.0), (0.0, 1.0)]);
            assert_eq!(stretch_of(&base, rectangle, &[]), Some((-100.0, 100.0)));
            let (from, to) =
                stretch_of(&base, rectangle, &[base.jet([-1.0, 0.0]).p, base.jet([1.0, 0.0]).p]).expect("a stretch");
            assert!((from + 1.5).abs() < 1e-9 && (to - 1.5).abs() < 1e-9, "{from} {to}");
        }
    }

    #[test]
    fn what_is_no_offset_is_not_said_to_be_near() {
        let (s, distance) = (wave(1.0), 0.2);
        let (o, _) = offset_of(&SupportSurface::Spline(SplineSupport::new(s.clone())), distance).expect("an offset");
        let SupportSurface::Spline(o) = o else { unreachable!() };
        // On the other side it is twice the distance away, and a bump counts with its height.
        assert!(distance_from_offset(&o.surface, &s, -distance, 0.0).is_infinite());
        let mut bump = o.surface.clone();
        let middle = bump.control.len() / 2;
        bump.control[middle][2] += 0.01;
        let (worst, bound) = (seen(&bump, &s, distance), distance_from_offset(&bump, &s, distance, 1e-3));
        assert!(worst > 1e-3 && (worst..2.5 * worst).contains(&bound), "{worst:e} {bound:e}");
    }

    #[test]
    fn a_surface_that_folds_back_on_itself_has_its_offset_on_both_sides() {
        let ku = Knots::clamped(1, &[0.0, 0.5, 1.0]).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let plate = |xs: [f64; 3], z: f64| {
            let points: Vec<Vec3> = xs.iter().flat_map(|x| [0.0, 1.0].map(|y| Vec3::new(*x, y, z))).collect();
            Surface::new(ku.clone(), kv.clone(), &points, None).expect("surface")
        };
        let (through, back) = ([0.0, 1.0, 2.0], [0.0, 1.0, 0.4]);
        assert!(distance_from_offset(&plate(through, 0.2), &plate(through, 0.0), 0.2, 0.0) < 1e-10);
        // The normal is turned over behind the fold.
        assert!(distance_from_offset(&plate(back, 0.2), &plate(back, 0.0), 0.2, 0.0).is_infinite());
    }
}
