//! Two right circular cones between two rulings with tangent planes: the G¹ Hermite interpolant of developables.
//!
//! *Method*: \[LP98\] (5)–(12), by closed forms that need no inscribed sphere: a rotation takes one frame to the other,
//! and the junction ruling is the first ruling turned by a share ψ of it (docs/algorithms/cones.md). ψ is the
//! parameter of the one-parameter family; ψ = 1/2 is the member that \[LP98\] calls practical, with locally least
//! distance of the vertices. Where the paper says that this member has congruent segments on surfaces of constant
//! slope, only its angles and openings are equal.

use super::spline::{Segment, SegmentFault, Shape};
use crate::geom::Vec3;
use crate::torse::g1_element::G1Element;

/// Rotations between elements beyond this lead to pieces that are useless in practice, rad.
pub(crate) const ROTATION_LIMIT: f64 = 2.5;
/// Rulings that enclose less than this angle count as parallel, rad: rounding of the frames is 1e-16, and the cone
/// between them would have its vertex ten orders of magnitude away.
const PARALLEL: f64 = 1e-10;
/// Cosine of rotation axis and ruling below which the construction divides rounding by rounding.
const AXIS_ACROSS: f64 = 1e-8;
/// Parallel tangent planes closer than this share of the size of the data are the same plane.
const SAME_PLANE: f64 = 1e-10;

/// Options of [`cone_pair`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOptions {
    /// Share of the rotation at which the junction ruling lies; in (0, 1); 1/2.
    pub psi: f64,
    /// Largest rotation between the elements; 2.5 rad.
    pub rotation_limit: f64,
    /// Used part of the first ruling: least and greatest distance (mm) along it from its point; both 0.
    pub first: [f64; 2],
    /// Used part of the second ruling; both 0.
    pub second: [f64; 2],
}

impl Default for PairOptions {
    fn default() -> Self {
        Self { psi: 0.5, rotation_limit: ROTATION_LIMIT, first: [0.0; 2], second: [0.0; 2] }
    }
}

/// Why two elements cannot be joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PairError {
    /// Numbers that are not finite.
    #[error("element {element} of the pair has a coordinate that is not finite")]
    NotFinite {
        /// 1 or 2.
        element: usize,
    },
    /// The same ruling twice.
    #[error("both elements of the pair are the same ruling with the same tangent plane")]
    Identical,
    /// The same ruling with opposite orientation, or a rotation by π that has no direction.
    #[error("elements 1 and 2 of the pair have opposite frames; orient the rulings and normals consistently")]
    Opposite,
    /// Too large a rotation.
    #[error("elements 1 and 2 of the pair differ by a rotation of {angle:.3} rad, more than {limit:.3}; give an element in between")]
    Rotation {
        /// Angle, rad.
        angle: f64,
        /// Limit, rad.
        limit: f64,
    },
    /// Parallel planes at a distance.
    #[error("the tangent planes of elements 1 and 2 are parallel, {gap:.3e} mm apart; split at the inflection ruling between them")]
    OffsetPlanes {
        /// Distance, mm.
        gap: f64,
    },
    /// The rotation axis is perpendicular to the rulings.
    #[error("the rotation from element 1 to 2 has its axis across the rulings (cosine {cosine:.1e}): no cone pair; split at the inflection ruling between them")]
    AxisAcross {
        /// Cosine of axis and ruling.
        cosine: f64,
    },
    /// No planar biarc.
    #[error("the parallel rulings of elements 1 and 2 have no cylinder pair; give an element in between")]
    NoCylinders,
    /// No inscribed sphere.
    #[error("the cone pairs of elements 1 and 2 have no inscribed sphere (parallel axes or one vertex)")]
    NoSphere,
    /// A share outside (0, 1).
    #[error("the share psi = {0} of the rotation is not between 0 and 1")]
    Psi(f64),
    /// A segment that does not cover the strip.
    #[error("segment {segment} of the pair cannot be used: {fault}; give an element in between")]
    Segment {
        /// 1 or 2.
        segment: usize,
        /// What is wrong.
        fault: SegmentFault,
    },
}

/// Two segments that join two elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConePair {
    /// From the first element to the junction, and on to the second.
    pub segments: [Segment; 2],
    /// Rotation from the first frame to the second, rad in [0, π]; 0 for plane sectors and cylinders.
    pub rotation: f64,
    /// Shift of the second point along its ruling that makes the motion a pure rotation, mm.
    pub shift: f64,
    /// Position of the rotation axis: cosines with (e, p, n), the same in both frames.
    pub axis: Vec3,
}

impl ConePair {
    /// The junction ruling with its tangent plane.
    pub fn junction(&self) -> G1Element {
        self.segments[1].start
    }

    /// The first segment that turns backwards or has its vertex in the strip.
    ///
    /// # Errors
    /// [`PairError::Segment`].
    pub fn checked(self) -> Result<Self, PairError> {
        for (i, s) in self.segments.iter().enumerate() {
            if let Some(fault) = s.fault() {
                return Err(PairError::Segment { segment: i + 1, fault });
            }
        }
        Ok(self)
    }

    /// The inscribed sphere of both cones: centre, and signed radius along the normals (mm). `None` for cylinders,
    /// planes, parallel axes (constant slope) and cones with one vertex, where it does not exist or is any of many.
    pub fn inscribed_sphere(&self) -> Option<(Vec3, f64)> {
        let [a, b] = &self.segments;
        let (Shape::Cone { .. }, Shape::Cone { .. }) = (a.shape, b.shape) else { return None };
        // The axes meet: nearest points of two lines.
        let (v, w) = (a.vertex()?, b.vertex()?);
        let (p, q) = (a.axis(), b.axis());
        let c = p.cross(&q);
        if c.norm() < PARALLEL || (w - v).norm() == 0.0 {
            return None;
        }
        let s = (w - v).cross(&q).dot(&c) / c.norm_squared();
        let centre = v + p * s;
        Some((centre, (centre - a.start.point).dot(&a.start.normal)))
    }
}

/// One end of the pair: the chord from its ruling direction to the junction direction, in its own frame, and the
/// cone that it determines.
struct End {
    delta: Vec3,
    cos_gamma: f64,
    sin_gamma: f64,
    angle: f64,
}

impl End {
    /// The unit direction turned by `alpha` about `q` (components in the frame), minus the direction. Without
    /// cancellation for small angles: so the tangent planes match to rounding for elements however close.
    fn new(q: &Vec3, alpha: f64) -> Self {
        let (s, h) = (alpha.sin(), (0.5 * alpha).sin());
        let v = 2.0 * h * h;
        let delta = Vec3::new(-v * (q.y * q.y + q.z * q.z), s * q.z + v * q.x * q.y, -s * q.y + v * q.x * q.z);
        // w ∝ p × δ with n·w > 0; tan(φ/2) from chord components.
        let n = delta.z.hypot(delta.x);
        let half = n.atan2(delta.y);
        let half = if delta.y < 0.0 { half - std::f64::consts::PI } else { half };
        Self { delta, cos_gamma: delta.z / n, sin_gamma: -delta.x / n, angle: 2.0 * half }
    }

    /// Frame of the junction by reflection: (direction, forward) in the frame of this end.
    fn junction(&self) -> (Vec3, Vec3) {
        let d = self.delta / self.delta.norm();
        let p = Vec3::y() - d * (2.0 * d.y);
        (Vec3::x() + self.delta, -p)
    }
}

/// The cone pair between two elements, whatever its quality.
///
/// *Input*: orthonormal elements (mm) of one smooth strip, consistently oriented.
/// *Guarantee*: the pair takes both elements and its junction is smooth, all to rounding (1e-15 relative in tests,
/// element distances from 1 down to 1e-4 of the size). Plane sectors and strips for equal tangent planes, cylinders
/// for parallel rulings. *Not guaranteed*: that the segments turn forward and keep their vertices out of the strip:
/// [`ConePair::checked`] says that, [`cone_pair`] does both.
///
/// # Errors
/// Identical or opposite elements, rotations beyond the limit, data for which there is no pair.
/// *Cost*: some 300 operations.
pub fn any_pair(first: &G1Element, second: &G1Element, options: &PairOptions) -> Result<ConePair, PairError> {
    let psi = options.psi;
    if !(psi > 0.0 && psi < 1.0) {
        return Err(PairError::Psi(psi));
    }
    for (element, g) in [first, second].into_iter().enumerate() {
        let sum = g.point + g.direction + g.forward + g.normal;
        if !sum.iter().all(|x| x.is_finite()) {
            return Err(PairError::NotFinite { element: element + 1 });
        }
    }
    let d = second.point - first.point;
    let scale = d.norm();

    // 1. The rotation from frame to frame.
    let (e1, e2) = (first.direction, second.direction);
    let twice_sine = e1.cross(&e2) + first.forward.cross(&second.forward) + first.normal.cross(&second.normal);
    let cosine = 0.5 * (e1.dot(&e2) + first.forward.dot(&second.forward) + first.normal.dot(&second.normal) - 1.0);
    let rotation = (0.5 * twice_sine.norm()).atan2(cosine);
    if rotation > options.rotation_limit {
        return Err(PairError::Rotation { angle: rotation, limit: options.rotation_limit });
    }

    // 2. Special positions of the planes and rulings.
    let parallel = e1.cross(&e2).norm() < PARALLEL;
    if parallel && e1.dot(&e2) < 0.0 {
        return Err(PairError::Opposite);
    }
    let same_direction = first.normal.cross(&second.normal).norm() < PARALLEL && first.normal.dot(&second.normal) > 0.0;
    if same_direction {
        let gap = d.dot(&first.normal);
        if gap.abs() > SAME_PLANE * scale {
            return Err(PairError::OffsetPlanes { gap });
        }
        return planar(first, second, parallel, options);
    }
    if parallel {
        return cylinders(first, second, options);
    }

    // 3. The axis, its components in both frames, and the pure rotation.
    let q = axis(first, second, &twice_sine, cosine).ok_or(PairError::Opposite)?;
    let local = (first.to_local(&q) + second.to_local(&q)) * 0.5;
    if local.x.abs() < AXIS_ACROSS {
        return Err(PairError::AxisAcross { cosine: local.x });
    }
    let shift = -d.dot(&q) / local.x;
    let d = d + e2 * shift;

    // 4. The junction direction seen from both ends, and the vertices.
    let (near, far) = (End::new(&local, psi * rotation), End::new(&local, (psi - 1.0) * rotation));
    let (a, b) = (-first.to_world(&near.delta), -second.to_world(&far.delta));
    let c = a.cross(&b);
    let cc = c.norm_squared();
    let (s1, s2) = (c.dot(&d.cross(&b)) / cc, c.dot(&a.cross(&d)) / cc);
    if !(s1.is_finite() && s2.is_finite()) {
        return Err(PairError::AxisAcross { cosine: local.x });
    }

    // 5. The segments; the junction's point half way between what both ends would choose.
    let slide = -0.5 * shift;
    let one = Segment {
        start: *first,
        shape: Shape::Cone { distance: -s1, cos_gamma: near.cos_gamma, sin_gamma: near.sin_gamma, angle: near.angle },
        edges: edges(options.first, options.second.map(|r| r - shift)),
    };
    let (g, p) = near.junction();
    let (g, p) = (first.to_world(&g), first.to_world(&p));
    let end = one.end();
    let junction = G1Element { point: end.at(slide), direction: g, forward: p, normal: g.cross(&p) };
    let two = Segment {
        start: junction,
        shape: Shape::Cone {
            distance: s2 + slide,
            cos_gamma: far.cos_gamma,
            sin_gamma: far.sin_gamma,
            angle: -far.angle,
        },
        edges: edges(options.first.map(|r| r - slide), options.second.map(|r| r + slide)),
    };
    Ok(halved(one, two, rotation, shift, local))
}

/// The cone pair between two elements of a strip, both segments forward and with their vertices outside the strip.
///
/// See [`any_pair`] for input, method and guarantee.
///
/// # Errors
/// Those of [`any_pair`], and a segment that does not cover the strip.
pub fn cone_pair(first: &G1Element, second: &G1Element, options: &PairOptions) -> Result<ConePair, PairError> {
    any_pair(first, second, options)?.checked()
}

/// The member of the family whose junction ruling has the given turn from the first: the inverse of ψ, for members
/// that are given by a junction direction. In units of the rotation.
fn share_of(pair: &ConePair, first: &G1Element, direction: &Vec3) -> f64 {
    let q = first.to_world(&pair.axis);
    let flat = |v: &Vec3| v - q * v.dot(&q);
    let (a, b) = (flat(&first.direction), flat(direction));
    q.dot(&a.cross(&b)).atan2(a.dot(&b)) / pair.rotation
}

/// The two members of the family with congruent cones, as shares ψ of the rotation (possibly outside (0, 1), where
/// the segments are useless); nearest to 1/2 first.
///
/// *Method*: \[LP98\] (9) with μ₁ = μ₂, counted from the points where the inscribed sphere touches the rulings.
///
/// # Errors
/// Those of [`any_pair`]; [`PairError::NoSphere`] where there is none.
pub fn congruent_shares(first: &G1Element, second: &G1Element) -> Result<[f64; 2], PairError> {
    let whole = PairOptions { rotation_limit: std::f64::consts::PI, ..Default::default() };
    let pair = any_pair(first, second, &whole)?;
    let (centre, _) = pair.inscribed_sphere().ok_or(PairError::NoSphere)?;
    let touch = (centre - first.point).dot(&first.direction);
    let mut shares = congruent_distances(first, second)?.map(|mu| {
        let between = second.at(pair.shift + touch - mu) - first.at(touch + mu);
        let g = if between.dot(&pair.junction().direction) < 0.0 { -between } else { between };
        share_of(&pair, first, &g)
    });
    shares.sort_by(|a, b| (a - 0.5).abs().total_cmp(&(b - 0.5).abs()));
    Ok(shares)
}

/// Distances μ₁ = μ₂ of the vertices of the two congruent members from the points where the inscribed sphere touches.
///
/// # Errors
/// See [`congruent_shares`].
pub fn congruent_distances(first: &G1Element, second: &G1Element) -> Result<[f64; 2], PairError> {
    let whole = PairOptions { rotation_limit: std::f64::consts::PI, ..Default::default() };
    let pair = any_pair(first, second, &whole)?;
    let (centre, _) = pair.inscribed_sphere().ok_or(PairError::NoSphere)?;
    let touch = (centre - first.point).dot(&first.direction);
    let d = second.at(pair.shift + touch) - first.at(touch);
    let (e1, e2) = (first.direction, second.direction);
    let (sum, b, c) = (-2.0 * d.dot(&(e1 + e2)), d.norm_squared(), (e1 - e2).norm_squared());
    let root = (sum * sum + 4.0 * b * c).sqrt();
    Ok([(sum + root) / (2.0 * c), (sum - root) / (2.0 * c)])
}

/// Coefficients (A, B, C, D) of \[LP98\] (11), distances of vertices counted from the points of the pure rotation.
fn bilinear(first: &G1Element, second: &G1Element) -> Result<[f64; 4], PairError> {
    let pair = any_pair(first, second, &PairOptions { rotation_limit: std::f64::consts::PI, ..Default::default() })?;
    let d = second.at(pair.shift) - first.point;
    let (e1, e2) = (first.direction, second.direction);
    Ok([-2.0 * d.dot(&e1), d.norm_squared(), (e1 - e2).norm_squared(), 2.0 * d.dot(&e2)])
}

/// Distances (μ₁, μ₂) of the two members with locally least distance of the vertices, \[LP98\] (12); the second is the
/// practical one where `practical` is 1.
pub fn least_distances(first: &G1Element, second: &G1Element) -> Result<([[f64; 2]; 2], usize), PairError> {
    let [a, b, c, d] = bilinear(first, second)?;
    let root = (b * c - a * d).max(0.0).sqrt();
    let members = [root, -root].map(|r| [(-d + r) / c, (a + r) / c]);
    let practical = usize::from((members[1][0] + members[1][1]).abs() > (members[0][0] + members[0][1]).abs());
    Ok((members, practical))
}

/// The member with a cylinder at the first element, and a cone that ends in the second.
///
/// *Method*: \[LP98\] (10).
///
/// # Errors
/// Those of [`any_pair`]; rulings or planes in a special position.
pub fn cylinder_first(first: &G1Element, second: &G1Element, options: &PairOptions) -> Result<ConePair, PairError> {
    let pair = any_pair(first, second, &PairOptions { psi: 0.5, ..*options })?;
    if pair.rotation == 0.0 {
        return Ok(pair);
    }
    let (e1, e2) = (first.direction, second.direction);
    let d = second.at(pair.shift) - first.point;
    let far = End::new(&pair.axis, -pair.rotation);
    let mu = d.dot(&e1) / (-0.5 * (e1 - e2).norm_squared());
    let (_, p) = far.junction();
    let p = second.to_world(&p);
    let normal = e1.cross(&p);
    let vertex = second.at(pair.shift - mu);
    let across = first.to_local(&(vertex - first.point));
    let (y, z) = (across.y, across.z);
    let radius = -0.5 * (y * y + z * z) / z;
    let angle = (-normal.dot(&first.forward)).atan2(normal.dot(&first.normal));
    let slide = -0.5 * pair.shift;
    let one = Segment {
        start: *first,
        shape: Shape::Cylinder { radius, angle },
        edges: edges(options.first, options.second.map(|r| r - pair.shift)),
    };
    let end = one.end();
    let junction = G1Element { point: end.at(slide), direction: e1, forward: p, normal };
    let two = Segment {
        start: junction,
        shape: Shape::Cone {
            distance: (junction.point - vertex).dot(&e1),
            cos_gamma: far.cos_gamma,
            sin_gamma: far.sin_gamma,
            angle: -far.angle,
        },
        edges: edges(options.first.map(|r| r - slide), options.second.map(|r| r + slide)),
    };
    Ok(halved(one, two, pair.rotation, pair.shift, pair.axis))
}

/// The member with a cylinder at the second element: [`cylinder_first`] backwards.
///
/// # Errors
/// See there.
pub fn cylinder_last(first: &G1Element, second: &G1Element, options: &PairOptions) -> Result<ConePair, PairError> {
    let turned = PairOptions { first: options.second, second: options.first, ..*options };
    let pair = cylinder_first(&second.reversed(), &first.reversed(), &turned)?;
    let [a, b] = pair.segments;
    Ok(ConePair { segments: [b.reversed(), a.reversed()], ..pair })
}

/// Edge coordinates that run evenly from the first ruling of the pair to its last.
fn edges(first: [f64; 2], last: [f64; 2]) -> [[f64; 3]; 2] {
    [0, 1].map(|k| [first[k], 0.5 * (first[k] + last[k]), last[k]])
}

/// The edges, so far those of the whole pair given in the coordinates of either segment, cut at the junction.
fn halved(mut one: Segment, mut two: Segment, rotation: f64, shift: f64, axis: Vec3) -> ConePair {
    for k in 0..2 {
        let [a, m, _] = one.edges[k];
        one.edges[k] = [a, 0.5 * (a + m), m];
        let [_, m, b] = two.edges[k];
        two.edges[k] = [m, 0.5 * (m + b), b];
    }
    ConePair { segments: [one, two], rotation, shift, axis }
}

/// Unit axis of the rotation, by the larger of its two sources: the antisymmetric part, or near a half turn the
/// symmetric part.
fn axis(first: &G1Element, second: &G1Element, twice_sine: &Vec3, cosine: f64) -> Option<Vec3> {
    if cosine > -0.5 {
        return twice_sine.try_normalize(0.0);
    }
    // (R + Rᵀ)/2 = cos θ I + (1 − cos θ) q qᵀ applied to the basis vector that keeps most.
    let turn = |v: &Vec3| second.to_world(&first.to_local(v));
    let back = |v: &Vec3| first.to_world(&second.to_local(v));
    let columns = [Vec3::x(), Vec3::y(), Vec3::z()].map(|v| (turn(&v) + back(&v)) * 0.5 - v * cosine);
    let q = columns.into_iter().max_by(|a, b| a.norm().total_cmp(&b.norm()))?.try_normalize(0.0)?;
    Some(if q.dot(twice_sine) < 0.0 { -q } else { q })
}

/// Equal tangent planes: a plane sector about the common point of the rulings, or a strip between parallel ones, in
/// two halves.
fn planar(first: &G1Element, second: &G1Element, parallel: bool, options: &PairOptions) -> Result<ConePair, PairError> {
    let d = first.to_local(&(second.point - first.point));
    let e = first.to_local(&second.direction);
    let (shape, shift) = if parallel {
        if d.y == 0.0 {
            return Err(PairError::Identical);
        }
        (Shape::Flat { width: d.y }, -d.x)
    } else {
        // l₁ − t₁ e₁ = l₂ − t₂ e₂ in the plane.
        let t2 = d.y / e.y;
        let t1 = t2 * e.x - d.x;
        (Shape::Cone { distance: t1, cos_gamma: 0.0, sin_gamma: 1.0, angle: e.y.atan2(e.x) }, t1 - t2)
    };
    let whole = Segment { start: *first, shape, edges: edges(options.first, options.second.map(|r| r - shift)) };
    // Cut at the middle of the edge coordinates, which are not sections of one plane here.
    let mut one = whole.part(0.0, 0.5);
    let mut two = whole.part(0.5, 1.0);
    for k in 0..2 {
        let [a, m, b] = whole.edges[k];
        one.edges[k] = [a, 0.5 * (a + m), m];
        two.edges[k] = [m, 0.5 * (m + b), b];
    }
    Ok(ConePair { segments: [one, two], rotation: 0.0, shift, axis: Vec3::z() })
}

/// Parallel rulings: the biarc with legs of equal length in a plane across them, \[LP98\] (7) and (8), \[MW95\].
fn cylinders(first: &G1Element, second: &G1Element, options: &PairOptions) -> Result<ConePair, PairError> {
    let d = first.to_local(&(second.point - first.point));
    let (shift, flat) = (-d.x, Vec3::new(0.0, d.y, d.z));
    let (p1, p2) = (Vec3::y(), first.to_local(&second.forward));
    let dd = flat.norm_squared();
    let sum = flat.dot(&(p1 + p2));
    let root = (sum * sum + 2.0 * (1.0 - p1.dot(&p2)) * dd).sqrt();
    let leg = dd / (sum + root);
    if !(leg > 0.0 && leg.is_finite()) {
        return Err(PairError::NoCylinders);
    }
    let (b1, b2) = (p1 * leg, flat - p2 * leg);
    let c = (b1 + b2) * 0.5;
    // Both arcs touch the line of the legs in c.
    let Some(tangent) = (b2 - b1).try_normalize(0.0) else { return Err(PairError::NoCylinders) };
    let p = first.to_world(&tangent);
    let slide = -0.5 * shift;
    // Turns about e; then the radii that close the chain d = ρ₁ chord₁ + ρ₂ chord₂ exactly.
    let whole = p2.z.atan2(p2.y);
    let turn1 = tangent.z.atan2(tangent.y);
    let turn2 = whole - turn1;
    let chord = |from: f64, by: f64| {
        let (s, c) = (from + 0.5 * by).sin_cos();
        Vec3::new(0.0, c, s) * (2.0 * (0.5 * by).sin())
    };
    let (k1, k2) = (chord(0.0, turn1), chord(turn1, turn2));
    let area = k1.cross(&k2).x;
    let (r1, r2) = (flat.cross(&k2).x / area, k1.cross(&flat).x / area);
    let regular = turn1.abs() > PARALLEL && turn2.abs() > PARALLEL && r1.is_finite() && r2.is_finite();
    let (shape1, shape2) = if regular {
        (Shape::Cylinder { radius: -r1, angle: turn1 }, Shape::Cylinder { radius: -r2, angle: turn2 })
    } else {
        let at = |v: &Vec3| first.point + first.to_world(v);
        let middle =
            G1Element { point: at(&c), direction: first.direction, forward: p, normal: first.direction.cross(&p) };
        (arc(first, &middle), arc(&middle, second))
    };
    let one = Segment { start: *first, shape: shape1, edges: edges(options.first, options.second.map(|r| r - shift)) };
    let end = one.end();
    let two = Segment {
        start: G1Element { point: end.at(slide), ..end },
        shape: shape2,
        edges: edges(options.first.map(|r| r - slide), options.second.map(|r| r + slide)),
    };
    Ok(halved(one, two, whole.abs(), shift, Vec3::x()))
}

/// The cylinder (or plane strip) that starts in an element and ends in another one with parallel ruling.
fn arc(from: &G1Element, to: &G1Element) -> Shape {
    let d = from.to_local(&(to.point - from.point));
    let n = from.to_local(&to.normal);
    let (y, z) = (d.y, d.z);
    // A bow below rounding of the chord is a line.
    if z.abs() <= f64::EPSILON * y.abs() {
        Shape::Flat { width: y }
    } else {
        Shape::Cylinder { radius: -0.5 * (y * y + z * z) / z, angle: (-n.y).atan2(n.z) }
    }
}

#[cfg(test)]
mod tests;
