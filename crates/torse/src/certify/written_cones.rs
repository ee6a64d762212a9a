//! Exact cones, cylinders and planes as a STEP file holds them, against the segments that were judged.
//!
//! *Method* \[certificate, 9\]. A surface of revolution has the signed distance `rise z − tilt (ρ − R)`, z along its axis
//! and ρ from it \[LP98\]. With `L = rise z + tilt R` the distance of a point is `|L² − tilt² ρ²|/(L + tilt ρ)`: put into
//! it, the rational patch of a segment gives a polynomial, whose Bernstein coefficients enclose it \[FR88\]. That is done
//! with the file's surface and with the segment's own, and both are added. Edges of whole segments are compared with the
//! borders of these patches; those of trimmed ones must be the numbers that were judged.

use super::vector::{cross, dot, length, sub, V3};
use super::written::{recorded, Fault, WrittenCertificate};
use super::written_strips::{affine, difference, ends_moved, misnamed, off_plane, side_moved, worst};
use crate::geom::Vec3;
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::written::{WrittenBase, WrittenCurve, WrittenExact, WrittenSide};
use crate::reason::{Differs, Item, Near, Reason, WrittenFault};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::cone::distance::Round;
use crate::torse::cone::forms::patches;
use crate::torse::cone::part::{ConeBody, ConePart, PartCurve, PartFace};
use crate::torse::cone::spline::{Segment, ONCE_AROUND};
use std::f64::consts::TAU;

/// Relative error of sine and cosine of the standard library, far above what any platform's library has.
const TRIGONOMETRIC: f64 = 1e-14;

/// What writing may move, as a share of the largest coordinate or radius: centres, radii and angles are computed from the
/// frames of segments in some twenty operations.
const ROUNDING: f64 = 1e-11;

/// Compares the faces of a STEP file with the bodies that were judged. The bound is that of the distance of surfaces,
/// edges and vertices from the segments.
pub fn cones(bodies: &[ConeBody], faces: &[WrittenExact]) -> WrittenCertificate {
    let all: Vec<ExactFace> = bodies.iter().flat_map(ExactFace::of_body).collect();
    if all.len() != faces.len() {
        let (found, wanted) = (faces.len(), all.len());
        return WrittenCertificate::of(Err(WrittenFault::Number { found, wanted, of: Near::Pieces }.into()));
    }
    let one = |(piece, face): (&ExactFace, &WrittenExact)| {
        if face.name != piece.name {
            return Err(misnamed(face.entity, &face.name, &piece.name));
        }
        piece.moved(face).map_err(|fault| recorded(fault, Item::Named(piece.name.clone())))
    };
    let found: Vec<Result<f64, Reason>> = parallel::map(all.iter().zip(faces), one);
    WrittenCertificate::of(found.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))))
}

/// What a face stands for.
struct ExactFace<'a> {
    name: String,
    segment: Segment,
    /// The trimmed chain and the number of the piece in it; none for whole segments.
    part: Option<(&'a ConePart, usize)>,
}

impl<'a> ExactFace<'a> {
    fn of_body(body: &'a ConeBody) -> Vec<Self> {
        let named = |i: usize, s: &Segment| format!("{}-{:02} {}", body.name, i + 1, s.shape.name());
        match &body.part {
            Some(part) => {
                let of = |(i, f): (usize, &PartFace)| {
                    let segment = f.blank.segment;
                    Self { name: named(i, &segment), segment, part: Some((part, i)) }
                };
                part.faces.iter().enumerate().map(of).collect()
            }
            None => {
                let of = |(i, s): (usize, &Segment)| Self { name: named(i, s), segment: *s, part: None };
                body.spline.segments.iter().enumerate().map(of).collect()
            }
        }
    }

    /// Bound of the distance of a written face from the piece.
    fn moved(&self, face: &WrittenExact) -> Result<f64, Fault> {
        let here = |what: Differs| (face.entity, what.into());
        let list = patches(&self.segment).map_err(|e| (face.entity, WrittenFault::Piece(e.to_string())))?;
        let [patch, others @ ..] = &list[..] else { return Err(here(Differs::NoPiece)) };
        // Only between circles pieces turn farther than one patch does.
        let round = self.part.is_none() && self.segment.is_between_circles(0.0);
        if !(others.is_empty() || round) {
            return Err(here(Differs::Turns));
        }
        let all = |revolved: &RevolvedSurface| worst(list.iter().map(|p| revolved.off(p).unwrap_or(f64::NAN)));
        let own = all(&RevolvedSurface::of_round(&Round::of(&self.segment)));
        let own = own.ok_or_else(|| here(Differs::OffOwnSurface))?;
        let (off, outwards) = match &face.surface {
            WrittenBase::Spline(_) => return Err(here(Differs::Spline)),
            WrittenBase::Plane { point, normal } => (
                off_plane(patch, point, normal).filter(|_| others.is_empty()),
                dot(&unit(normal), &exact(&self.segment.start.normal)),
            ),
            WrittenBase::Cylinder { point, axis, radius } => {
                let c = RevolvedSurface::new(point, axis, *radius, [Interval::ZERO, Interval::ONE]);
                (all(&c), c.outwards(&self.segment))
            }
            WrittenBase::Cone { point, axis, radius, half_angle } => {
                let c = RevolvedSurface::new(point, axis, *radius, sine_and_cosine(*half_angle));
                (all(&c), c.outwards(&self.segment))
            }
        };
        let off = off.ok_or_else(|| here(Differs::Surface))?;
        let wanted = if face.reversed { -1 } else { 1 };
        if outwards.sign() != wanted {
            return Err(here(Differs::Normal));
        }
        let moved = (Interval::point(own) + Interval::point(off)).hi;
        let sizes = list.iter().map(Surface::bbox).map(|b| b.min.amax().max(b.max.amax()));
        let reach = sizes.fold(Round::of(&self.segment).radius, f64::max);
        if moved.is_nan() || moved > ROUNDING * reach {
            return Err((face.entity, WrittenFault::SurfaceMoved(moved)));
        }
        let edges = match self.part {
            Some((part, k)) => trimmed_moved(part, k, face)?,
            None => whole_moved(&list, face)?,
        };
        // What is written as a whole turn may have been judged as one that fails to close by a little, which is told.
        let turn = self.segment.shape.angle().abs();
        let open = if round && turn >= 2.0 * TAU - ONCE_AROUND { 2.0 * (ONCE_AROUND - TAU) } else { 0.0 };
        if edges > (ROUNDING + open) * reach {
            return Err((face.entity, WrittenFault::EdgesMoved(edges)));
        }
        Ok(moved.max(edges))
    }
}

/// The edges of a whole segment against the borders of its patches, which follow each other.
fn whole_moved(list: &[Surface], face: &WrittenExact) -> Result<f64, Fault> {
    let [sides] = &face.loops[..] else { return Err((face.entity, Differs::SeveralLoops.into())) };
    let across = |patch: &Surface, last: bool| {
        let first = if last { patch.control.len() - 2 } else { 0 };
        vec![Curve { knots: patch.knots_v.clone(), control: patch.control[first..first + 2].to_vec() }]
    };
    let along = |side: usize| -> Vec<Curve<4>> {
        let of = |p: &Surface| {
            let control = p.control.iter().skip(side).step_by(2).copied().collect();
            Curve { knots: p.knots_u.clone(), control }
        };
        list.iter().map(of).collect()
    };
    let (first, last) = (&list[0], &list[list.len() - 1]);
    let wanted = [(across(first, false), true), (along(1), true), (across(last, true), false), (along(0), false)];
    if sides.len() != wanted.len() {
        return Err((face.entity, Differs::Edges.into()));
    }
    let mut moved = 0.0f64;
    for (k, ((curves, forward), side)) in wanted.iter().zip(sides).enumerate() {
        let fault = |what: Differs| (side.entity, what.into());
        if side.forward != *forward {
            return Err(fault(Differs::EdgeSense));
        }
        follows(sides, k)?;
        let off = match (&side.curve, &curves[..]) {
            (WrittenCurve::Circle { centre, axis, radius }, _) => {
                let arcs = curves.iter().map(|c| off_circle(c, centre, axis, *radius).unwrap_or(f64::NAN));
                whole_ends(curves).and_then(|c| ends_moved(&c, side)).zip(worst(arcs)).map(|(a, b)| a.max(b))
            }
            // Edges of planes may be lines where the patch has three control points in a row.
            (WrittenCurve::Line { .. }, [curve]) => {
                let chord = ends_of(curve).and_then(|line| side_moved(&line, side));
                chord.zip(off_chord(curve)).map(|(a, b)| a.max(b))
            }
            (WrittenCurve::Spline { .. }, [curve]) => side_moved(curve, side),
            _ => None,
        };
        moved = moved.max(off.ok_or_else(|| fault(Differs::Edge))?);
    }
    Ok(moved)
}

/// The line between the ends of curves that follow each other.
fn whole_ends(curves: &[Curve<4>]) -> Option<Curve<4>> {
    line([*curves.first()?.control.first()?, *curves.last()?.control.last()?])
}

/// The edges of a trimmed piece: the very numbers that were judged.
fn trimmed_moved(part: &ConePart, piece: usize, face: &WrittenExact) -> Result<f64, Fault> {
    let loops = &part.faces[piece].loops;
    if loops.len() != face.loops.len() {
        return Err((face.entity, Differs::Loops.into()));
    }
    let mut moved = 0.0f64;
    for (uses, sides) in loops.iter().zip(&face.loops) {
        if uses.len() != sides.len() {
            return Err((face.entity, Differs::Edges.into()));
        }
        for (k, (&(e, forward), side)) in uses.iter().zip(sides).enumerate() {
            let fault = |what: Differs| (side.entity, what.into());
            if side.forward != forward {
                return Err(fault(Differs::EdgeSense));
            }
            follows(sides, k)?;
            let edge = part.edges.get(e).ok_or_else(|| fault(Differs::NoEdge))?;
            let own = [edge.start, edge.end].map(|v| part.vertices.get(v).copied().unwrap_or(Vec3::repeat(f64::NAN)));
            if side.vertices != own.map(<[f64; 3]>::from) {
                return Err(fault(Differs::Vertex));
            }
            match (&edge.curve, &side.curve) {
                (PartCurve::Ruling, WrittenCurve::Line { .. }) => {
                    let line = line(own.map(|p| [p.x, p.y, p.z, 1.0]));
                    let off = line.and_then(|line| side_moved(&line, side));
                    moved = moved.max(off.ok_or_else(|| fault(Differs::Edge))?);
                }
                (PartCurve::Free { space, .. }, WrittenCurve::Spline { curve, weights }) => {
                    if !weights.is_empty() || curve != space {
                        return Err(fault(Differs::Edge));
                    }
                }
                _ => return Err(fault(Differs::EdgeKind)),
            }
        }
    }
    Ok(moved)
}

/// Whether an edge of a loop begins where the one before ends.
fn follows(sides: &[WrittenSide], k: usize) -> Result<(), Fault> {
    let (side, before) = (&sides[k], &sides[(k + sides.len() - 1) % sides.len()]);
    if side.vertices[usize::from(!side.forward)] == before.vertices[usize::from(before.forward)] {
        Ok(())
    } else {
        Err((side.entity, Differs::Follows.into()))
    }
}

/// The line between the ends of a curve.
fn ends_of(c: &Curve<4>) -> Option<Curve<4>> {
    line([*c.control.first()?, *c.control.last()?])
}

fn line(ends: [[f64; 4]; 2]) -> Option<Curve<4>> {
    Some(Curve { knots: Knots::clamped(1, &[0.0, 1.0]).ok()?, control: ends.to_vec() })
}

/// Bound of the distance of a curve's points from the line through its ends.
fn off_chord(c: &Curve<4>) -> Option<f64> {
    let (first, last) = (affine(c.control.first()?), affine(c.control.last()?));
    let chord = sub(&last, &first);
    let size = length(&chord);
    worst(c.control.iter().map(|p| (length(&cross(&sub(&affine(p), &first), &chord)) / size).hi))
}

/// Bound of the distance of an arc from the circle about an axis; `None` if it does not run counter-clockwise about it.
fn off_circle(own: &Curve<4>, centre: &[f64; 3], axis: &[f64; 3], radius: f64) -> Option<f64> {
    let revolved = RevolvedSurface::new(centre, axis, radius, [Interval::ZERO, Interval::ONE]);
    let out: Vec<V3<Interval>> = own.control.iter().map(|c| difference(&affine(c), centre)).collect();
    let turns = |w: &[V3<Interval>]| dot(&revolved.axis, &cross(&w[0], &w[1])).sign() > 0;
    if own.control.len() != 3 || own.knots.degree() != 2 || !out.windows(2).all(turns) {
        return None;
    }
    let above = worst(out.iter().map(|p| dot(&revolved.axis, p).mag()))?;
    let beside = revolved.off_net(&own.control, (2, 0))?;
    let (above, beside) = (Interval::point(above), Interval::point(beside));
    Some((above.sqr() + beside.sqr()).sqrt().hi)
}

fn exact(v: &Vec3) -> V3<Interval> {
    [v.x, v.y, v.z].map(Interval::point)
}

fn unit(v: &[f64; 3]) -> V3<Interval> {
    let v = v.map(Interval::point);
    let size = length(&v);
    v.map(|x| x / size)
}

/// Sine and cosine of an angle between 0 and a right angle.
fn sine_and_cosine(angle: f64) -> [Interval; 2] {
    if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&angle) {
        return [Interval::EVERYTHING; 2];
    }
    let (s, c) = angle.sin_cos();
    [s, c].map(|x| Interval::point(x).widen(x.abs() * TRIGONOMETRIC))
}

/// A control point as a surface of revolution sees it, homogeneous: off the axis, the linear form L, and its weight.
#[derive(Clone, Copy)]
struct Seen {
    out: V3<Interval>,
    form: Interval,
    weight: Interval,
}

/// Cuts at most: L changes by no more than numbers have digits.
const MOST_CUTS: i32 = 40;

/// A net of degree `q` along the rulings in pieces, each half as far from the tip as the one before, until L is what it is at the
/// narrow end: what rounding does to large values at the wide end would be too much there.
fn towards_tip(seen: Vec<Seen>, q: usize) -> Vec<Vec<Seen>> {
    if q != 1 {
        return vec![seen];
    }
    let least = |j: usize| seen.iter().skip(j).step_by(2).map(|s| (s.form / s.weight).lo).fold(f64::INFINITY, f64::min);
    let ends = [least(0), least(1)];
    let narrow = usize::from(ends[1] < ends[0]);
    let cuts = (ends[1 - narrow] / ends[narrow]).log2();
    let cuts = if cuts > 1.0 { (cuts.ceil() as i32).min(MOST_CUTS) } else { 0 };
    // Shares of the way from the narrow end to the wide one; they and their rests are exact.
    let mut at: Vec<f64> = (0..=cuts).map(|k| 0.5_f64.powi(k)).collect();
    at.push(0.0);
    let between = |pair: &[Seen], x: f64| {
        let (a, b) = (&pair[narrow], &pair[1 - narrow]);
        let mix = |p: Interval, q: Interval| p * Interval::point(1.0 - x) + q * Interval::point(x);
        Seen {
            out: std::array::from_fn(|d| mix(a.out[d], b.out[d])),
            form: mix(a.form, b.form),
            weight: mix(a.weight, b.weight),
        }
    };
    let piece = |w: &[f64]| seen.chunks_exact(2).flat_map(|pair| [w[1], w[0]].map(|x| between(pair, x))).collect();
    at.windows(2).map(piece).collect()
}

/// A surface of revolution: `tilt ρ = rise z + tilt R`, z and ρ along and from the axis through a point.
struct RevolvedSurface {
    point: [f64; 3],
    axis: V3<Interval>,
    radius: f64,
    rise: Interval,
    tilt: Interval,
}

impl RevolvedSurface {
    fn new(point: &[f64; 3], axis: &[f64; 3], radius: f64, [rise, tilt]: [Interval; 2]) -> Self {
        Self { point: *point, axis: unit(axis), radius, rise, tilt }
    }

    fn of_round(r: &Round) -> Self {
        // Signs only say on which side the normals are.
        let sign = if r.tilt < 0.0 { -1.0 } else { 1.0 };
        let [rise, tilt] = [r.rise * sign, r.tilt * sign].map(Interval::point);
        Self::new(&r.center.into(), &r.axis.into(), r.radius, [rise, tilt])
    }

    /// Bound of the distance of a patch's points.
    fn off(&self, patch: &Surface) -> Option<f64> {
        let degree = (patch.knots_u.degree(), patch.knots_v.degree());
        self.off_net(&patch.control, degree)
    }

    /// Bound of the distance of the points of a Bézier net; `None` where one is not on the near side of the vertex.
    fn off_net(&self, net: &[[f64; 4]], (p, q): (usize, usize)) -> Option<f64> {
        if net.len() != (p + 1) * (q + 1) || net.iter().any(|c| !(c[3] > 0.0 && c.iter().all(|x| x.is_finite()))) {
            return None;
        }
        let seen: Vec<Seen> = net
            .iter()
            .map(|c| {
                let w = Interval::point(c[3]);
                let y: V3<Interval> = std::array::from_fn(|d| Interval::less_product(c[d], c[3], self.point[d]));
                let z = dot(&self.axis, &y);
                let out = std::array::from_fn(|d| y[d] - z * self.axis[d]);
                Seen { out, form: self.rise * z + self.tilt * (w * Interval::point(self.radius)), weight: w }
            })
            .collect();
        if self.tilt.mag() <= 0.0 {
            let least = net.iter().map(|c| c[3]).fold(f64::INFINITY, f64::min);
            return worst(seen.iter().map(|s| (s.form.abs() / Interval::point(least)).hi));
        }
        worst(towards_tip(seen, q).iter().map(|piece| self.off_piece(piece, (p, q)).unwrap_or(f64::NAN)))
    }

    /// As [`RevolvedSurface::off_net`], of a net over which L does not change by much.
    fn off_piece(&self, seen: &[Seen], (p, q): (usize, usize)) -> Option<f64> {
        let least = Interval::point(seen.iter().map(|s| s.weight.lo).fold(f64::INFINITY, f64::min));
        let floor = seen.iter().map(|s| (s.form / s.weight).lo).fold(f64::INFINITY, f64::min);
        let form = |a: usize, b: usize| {
            let (a, b) = (&seen[a], &seen[b]);
            a.form * b.form - self.tilt.sqr() * dot(&a.out, &b.out)
        };
        let share = |n: usize, i: usize, k: usize| {
            Interval::point(binomial(n, i) * binomial(n, k - i)) / Interval::point(binomial(2 * n, k))
        };
        let mut most = 0.0f64;
        for k in 0..=2 * p {
            for l in 0..=2 * q {
                let mut sum = Interval::ZERO;
                for i in k.saturating_sub(p)..=k.min(p) {
                    for j in l.saturating_sub(q)..=l.min(q) {
                        sum += share(p, i, k) * share(q, j, l) * form(i * (q + 1) + j, (k - i) * (q + 1) + l - j);
                    }
                }
                most = most.max(sum.mag());
            }
        }
        // d (L + tilt ρ) is at most this, and L + tilt ρ at least 2 L − d: once with d below L, then with what that gives.
        let most = Interval::point(most) / least.sqr();
        let crude = (most / Interval::point(floor)).hi;
        if !(floor > 0.0 && crude < floor) {
            return None;
        }
        let bound = most / (Interval::point(floor).scale_exact(2.0) - Interval::point(crude));
        bound.hi.is_finite().then_some(bound.hi)
    }

    /// Positive where the segment's normal points away from the axis.
    fn outwards(&self, segment: &Segment) -> Interval {
        let y = difference(&exact(&segment.start.point), &self.point);
        let z = dot(&self.axis, &y);
        let out: V3<Interval> = std::array::from_fn(|d| y[d] - z * self.axis[d]);
        dot(&out, &exact(&segment.start.normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::cone::spline::Shape;
    use crate::torse::g1_element::G1Element;

    fn segment(shape: Shape) -> Segment {
        let start = G1Element::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.2, -0.3), Vec3::new(0.3, 0.0, 1.0));
        Segment { edges: [[-20.0; 3], [30.0; 3]], ..Segment::new(start.expect("element"), shape) }
    }

    #[test]
    fn patches_lie_on_their_surfaces_and_by_as_much_off_others() {
        for shape in [
            Shape::Cone { distance: 100.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 },
            Shape::Cone { distance: -100.0, cos_gamma: 0.6, sin_gamma: 0.8, angle: -0.6 },
            Shape::Cylinder { radius: -40.0, angle: 0.9 },
            Shape::Cone { distance: 100.0, cos_gamma: 0.0, sin_gamma: 1.0, angle: 0.5 },
            Shape::Flat { width: 60.0 },
        ] {
            let s = segment(shape);
            let list = patches(&s).expect("patches");
            let own = RevolvedSurface::of_round(&Round::of(&s));
            let off = own.off(&list[0]).expect("a bound");
            assert!(off < 1e-11, "{shape:?} {off:e}");
            // Wider by a tenth: the greatest distance is that of the radius, times the cosine of the half angle.
            if !s.shape.is_plane() {
                let wide = RevolvedSurface { radius: own.radius + 0.1, ..own };
                let (off, least) = (wide.off(&list[0]).expect("a bound"), 0.1 * wide.tilt.lo);
                assert!(off >= least && off < 2.2 * least, "{shape:?} {off} {least}");
            }
        }
    }

    #[test]
    fn cones_that_end_beside_their_tip_are_followed_as_closely_as_others() {
        for beside in [1e-2, 1e-4, 1e-6] {
            let s = segment(Shape::Cone { distance: 300.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 });
            let s = Segment { edges: [[300.0 * (beside - 1.0); 3], [30.0; 3]], ..s };
            let list = patches(&s).expect("patches");
            let own = RevolvedSurface::of_round(&Round::of(&s));
            let off = own.off(&list[0]).expect("a bound");
            assert!(off < 1e-10, "{beside} {off:e}");
        }
    }

    #[test]
    fn angles_that_are_none_show_nothing() {
        let list = patches(&segment(Shape::Cylinder { radius: 40.0, angle: -0.9 })).expect("patches");
        for angle in [f64::NAN, -0.1, 2.0] {
            let c = RevolvedSurface::new(&[0.0; 3], &[0.0, 0.0, 1.0], 10.0, sine_and_cosine(angle));
            assert_eq!(c.off(&list[0]), None);
        }
        let nowhere = RevolvedSurface::new(&[0.0; 3], &[0.0; 3], 10.0, sine_and_cosine(0.3));
        assert_eq!(nowhere.off(&list[0]), None);
    }
}
