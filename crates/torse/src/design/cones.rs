//! Cone splines from a designer's rulings: through given elements, or with osculating cones \[LP98\].
//!
//! *Method*: the chain of practical cone pairs; or osculating cones at the given rulings, each two of them joined by a
//! third cone. Where \[LP98\] (14) asks for the roots of a quartic, two are trivial and the other two those of one
//! trigonometric equation (docs/algorithms/cones.md).

mod arcs;
mod join;

use crate::torse::cone::pair::{cone_pair, PairError, PairOptions, ROTATION_LIMIT};
use crate::torse::cone::spline::{ConeSpline, Segment, SegmentFault, Shape};
use crate::torse::g1_element::G1Element;
use join::{filler, smooth, through, trigonometric, turn_to};
pub use join::{Join, Osculating};

/// Options of [`cone_spline`] and [`osculating_spline`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeOptions {
    /// Share of the rotation at which junction rulings of pairs lie; 1/2.
    pub psi: f64,
    /// Largest rotation between neighbouring elements; 2.5 rad.
    pub rotation_limit: f64,
}

impl Default for ConeOptions {
    fn default() -> Self {
        Self { psi: 0.5, rotation_limit: ROTATION_LIMIT }
    }
}

/// Why there is no chain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConesError {
    /// Fewer than two elements.
    #[error("{0} elements are given; a cone spline needs two or more")]
    TooFew(usize),
    /// A reach is missing.
    #[error("{reaches} reaches are given for {elements} elements; give one for each, or none")]
    Reaches {
        /// Number of reaches.
        reaches: usize,
        /// Number of elements.
        elements: usize,
    },
    /// A pair of neighbours cannot be joined.
    #[error("between elements {index} and {}: {source}", index + 1)]
    Pair {
        /// Index of the first of both, from 0.
        index: usize,
        /// Reason.
        source: PairError,
    },
}

/// The chain of cone pairs through elements, with the part `reach` (from, to along the ruling, mm) of each ruling used;
/// an empty list of reaches stands for none.
///
/// *Guarantee*: takes all elements, smooth to rounding, forward, vertices outside the strip between the reaches.
///
/// # Errors
/// See [`ConesError`]; it names the elements.
/// *Cost*: below 1 µs for a pair.
pub fn cone_spline(
    elements: &[G1Element],
    reach: &[[f64; 2]],
    options: &ConeOptions,
) -> Result<ConeSpline, ConesError> {
    check(elements.len(), reach.len())?;
    let mut segments = Vec::with_capacity(2 * elements.len());
    for index in 0..elements.len() - 1 {
        segments.extend(pair(elements, reach, index, options)?);
    }
    Ok(ConeSpline { segments })
}

fn check(elements: usize, reaches: usize) -> Result<(), ConesError> {
    if elements < 2 {
        return Err(ConesError::TooFew(elements));
    }
    if reaches != 0 && reaches != elements {
        return Err(ConesError::Reaches { reaches, elements });
    }
    Ok(())
}

fn pair(
    elements: &[G1Element],
    reach: &[[f64; 2]],
    index: usize,
    options: &ConeOptions,
) -> Result<[Segment; 2], ConesError> {
    let part = |i: usize| reach.get(i).copied().unwrap_or([0.0; 2]);
    let pair_options = PairOptions {
        psi: options.psi,
        rotation_limit: options.rotation_limit,
        first: part(index),
        second: part(index + 1),
    };
    cone_pair(&elements[index], &elements[index + 1], &pair_options)
        .map(|p| p.segments)
        .map_err(|source| ConesError::Pair { index, source })
}

/// Relative size of the vector N of the join below which its two roots are rounding.
const NO_JOIN: f64 = 1e-10;
/// Both joins of two osculating cones of revolution; the list is empty where the equation has no real root or says
/// nothing (constant slope, common vertex).
///
/// *Guarantee*: the filler touches both along its end rulings, to 1e-12 for elements 0.01 apart. *Not guaranteed*:
/// that it turns forward; [`osculating_spline`] selects.
pub fn joins(first: &Osculating, second: &Osculating) -> Vec<Join> {
    match (first.shape, second.shape) {
        (Shape::Cone { .. }, Shape::Cone { .. }) if arcs::leave_choice(first, second) => Vec::new(),
        (Shape::Cone { distance: d1, .. }, Shape::Cone { .. }) => {
            let Shape::Cone { cos_gamma: k1, sin_gamma: s1, .. } = first.shape else { return Vec::new() };
            let Shape::Cone { distance: d2, cos_gamma: k2, sin_gamma: s2, .. } = second.shape else {
                return Vec::new();
            };
            let (v1, v2) = (first.element.at(-d1), second.element.at(-d2));
            let w1 = first.piece(0.0).axis();
            let (e1, p1) = (first.element.direction, first.element.forward);
            // Axes cut to normals of length one: W without the common part.
            let big =
                e1 * (k1 / s1) + first.element.normal - second.element.direction * (k2 / s2) - second.element.normal;
            let n = big.cross(&(v1 - v2));
            let least = NO_JOIN * big.norm() * (v1 - v2).norm();
            if n.norm() <= least || least.is_nan() {
                return Vec::new();
            }
            let a1 = e1 - w1 * k1;
            let Some(roots) = trigonometric(a1.dot(&n), s1 * p1.dot(&n), k1 * w1.dot(&n)) else { return Vec::new() };
            roots.iter().filter_map(|&f| through(first, second, f)).collect()
        }
        (Shape::Cylinder { radius, .. }, Shape::Cone { distance, cos_gamma: k2, sin_gamma: s2, .. }) => {
            let v2 = second.element.at(-distance);
            let w2 = second.piece(0.0).axis();
            let g = &first.element;
            let (c0, w1) = (g.point - g.normal * radius, g.direction);
            let m = (c0 - v2).cross(&w1) - w1.cross(&w2) * (radius / s2);
            let det = w1.dot(&w2.cross(&(c0 - v2))) / s2;
            let Some(roots) = trigonometric(g.normal.dot(&m), -g.forward.dot(&m), -det) else { return Vec::new() };
            roots
                .iter()
                .filter_map(|&f| {
                    let at = first.piece(f).end();
                    let sigma = (w1.dot(&w2) - k2) / (s2 - at.normal.dot(&w2));
                    let g2 = w1 + (at.normal - w2 / s2) * sigma;
                    let g2 = g2.try_normalize(0.0)? * (1.0 - sigma * k2 / s2).signum();
                    let turn = turn_to(second, &g2);
                    filler(f, &at, second, turn).and_then(smooth)
                })
                .collect()
        }
        (Shape::Cone { .. }, Shape::Cylinder { .. }) => {
            let turned = |o: &Osculating| {
                let s = o.piece(0.0).reversed();
                Osculating { element: s.start, shape: s.shape }
            };
            joins(&turned(second), &turned(first))
                .into_iter()
                .map(|j| Join {
                    // Passed the other way, turns about the reversed axes keep their sign for cones and change it
                    // for cylinders, whose axis is the ruling itself.
                    first_angle: j.second_angle,
                    second_angle: -j.first_angle,
                    filler: j.filler.reversed(),
                })
                .collect()
        }
        _ => Vec::new(),
    }
}

/// An osculating cone spline and where it had to fall back.
#[derive(Clone, Debug, PartialEq)]
pub struct OsculatingSpline {
    /// The chain; pieces of one osculating cone on both sides of its ruling are one segment.
    pub spline: ConeSpline,
    /// Indices of intervals between neighbouring rulings where a cone pair stands instead of a join.
    pub pairs: Vec<usize>,
}

/// The chain that holds a piece of every osculating cone, with one filler between each two; a cone pair where the join
/// does not exist or turns backwards. On surfaces of constant slope, general cones and cylinders, where the join is not
/// unique, these are osculating arc splines in the plane or on the sphere.
///
/// `reach` as in [`cone_spline`]; edges run evenly between the reaches.
/// *Guarantee*: smooth to about 1e-12; forward.
///
/// # Errors
/// See [`ConesError`].
pub fn osculating_spline(
    cones: &[Osculating],
    reach: &[[f64; 2]],
    options: &ConeOptions,
) -> Result<OsculatingSpline, ConesError> {
    check(cones.len(), reach.len())?;
    let elements: Vec<G1Element> = cones.iter().map(|c| c.element).collect();
    let mut out = OsculatingSpline { spline: ConeSpline::default(), pairs: Vec::new() };
    for index in 0..cones.len() - 1 {
        let part = |i: usize| reach.get(i).copied().unwrap_or([0.0; 2]);
        let mut list = joins(&cones[index], &cones[index + 1]);
        if list.is_empty() {
            list = arcs::arc_joins(&cones[index], &cones[index + 1]);
        }
        let best = list
            .iter()
            .filter_map(|j| {
                let s = edged(j.segments(&cones[index], &cones[index + 1]), part(index), part(index + 1)).ok()?;
                let largest = s.iter().map(|s| s.shape.angle().abs()).fold(0.0, f64::max);
                Some((largest, s))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, [lead, filler, tail])) = best else {
            out.spline.segments.extend(pair(&elements, reach, index, options)?);
            out.pairs.push(index);
            continue;
        };
        let joined = index > 0 && !out.pairs.contains(&(index - 1));
        match out.spline.segments.last_mut() {
            Some(last) if joined => *last = merged(last, &lead),
            _ => out.spline.segments.push(lead),
        }
        out.spline.segments.extend([filler, tail]);
    }
    Ok(out)
}

/// Edges along three segments, evenly by rotation from the first reach to the last; both are given in the coordinates
/// of their own elements.
fn edged(mut s: [Segment; 3], first: [f64; 2], last: [f64; 2]) -> Result<[Segment; 3], SegmentFault> {
    let slides: [f64; 2] = std::array::from_fn(|i| {
        let end = s[i].end();
        (s[i + 1].start.point - end.point).dot(&end.direction)
    });
    // The tail ends in the second element's point, so that its own coordinates are those of the last reach.
    let total: f64 = s.iter().map(|s| s.shape.flat_angle().abs().max(f64::MIN_POSITIVE)).sum();
    let offset: f64 = slides.iter().sum();
    for k in 0..2 {
        let (a, b) = (first[k], last[k] + offset);
        let (mut done, mut slid) = (0.0, 0.0);
        for i in 0..3 {
            let share = s[i].shape.flat_angle().abs().max(f64::MIN_POSITIVE) / total;
            let at = |x: f64| a + (b - a) * (done + share * x) - slid;
            s[i].edges[k] = [at(0.0), at(0.5), at(1.0)];
            done += share;
            slid += slides.get(i).copied().unwrap_or(0.0);
        }
    }
    match s.iter().find_map(Segment::fault) {
        Some(fault) => Err(fault),
        None => Ok(s),
    }
}

/// Two pieces of the same cone as one.
fn merged(a: &Segment, b: &Segment) -> Segment {
    let total = a.shape.angle() + b.shape.angle();
    let shape = match a.shape {
        Shape::Cone { distance, cos_gamma, sin_gamma, .. } => {
            Shape::Cone { distance, cos_gamma, sin_gamma, angle: total }
        }
        Shape::Cylinder { radius, .. } => Shape::Cylinder { radius, angle: total },
        flat @ Shape::Flat { .. } => flat,
    };
    let slide = (b.start.point - a.end().point).dot(&b.start.direction);
    let edges = [0, 1].map(|k| [a.edges[k][0], a.edges[k][2], b.edges[k][2] + slide]);
    Segment { start: a.start, shape, edges }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::torse::ruled_patch::tangent_strip;
    use crate::torse::ruled_patch::StripJet;

    fn jet(u: f64) -> StripJet {
        let c = [
            Vec3::new(u, u * u, u * u * u),
            Vec3::new(1.0, 2.0 * u, 3.0 * u * u),
            Vec3::new(0.0, 2.0, 6.0 * u),
            Vec3::new(0.0, 0.0, 6.0),
        ];
        tangent_strip(&c, [1.0, 2.0])
    }

    fn osculating(u: f64) -> Osculating {
        let j = jet(u);
        Osculating::of(&j.element().expect("element"), &j)
    }

    #[test]
    fn osculating_cones_have_their_vertex_on_the_regression_curve() {
        for u in [0.1, 0.5] {
            let o = osculating(u);
            let v = o.piece(0.1).vertex().expect("vertex");
            assert!((v - Vec3::new(u, u * u, u * u * u)).norm() < 1e-13);
            // Contact of second order: the distance of neighbouring rulings falls with the third power.
            let off =
                |h: f64| crate::torse::cone::distance::Round::of(&o.piece(0.1)).distance(&jet(u + h).ends[1][0]).abs();
            let order = (off(0.02) / off(0.01)).log2();
            assert!((2.7..3.3).contains(&order), "{order}");
        }
    }

    #[test]
    fn joins_are_smooth_and_forward() {
        for h in [0.34, 0.17, 0.085] {
            let cones: Vec<Osculating> = (0..4).map(|i| osculating(0.18 + h * f64::from(i))).collect();
            let s = osculating_spline(&cones, &[[-0.5, 0.5]; 4], &ConeOptions::default()).expect("spline");
            assert!(s.pairs.is_empty() && s.spline.segments.len() == 7, "{h}: {:?}", s.pairs);
            assert!(s.spline.mismatch(1.0) < 1e-11, "{h}: {:e}", s.spline.mismatch(1.0));
            assert!(s.spline.segments.iter().all(|s| s.fault().is_none()));
            let (a, b) = (s.spline.segments[0].start, s.spline.segments[6].end());
            assert!(a.mismatch(&cones[0].element, 1.0) < 1e-14 && b.mismatch(&cones[3].element, 1.0) < 1e-13);
        }
    }

    #[test]
    fn osculating_cylinders_are_joined_too() {
        // A strip whose ruling has its regression point at infinity at u = 0.
        let j = jet(0.4);
        let cone = osculating(0.4);
        let g = jet(0.15).element().expect("element");
        let cylinder = Osculating { element: g, shape: Shape::Cylinder { radius: -1.5, angle: 0.0 } };
        let both = [joins(&cylinder, &cone), joins(&cone, &cylinder)];
        assert!(both.iter().any(|b| !b.is_empty()), "{j:?}");
        for (pair, list) in [(&[cylinder, cone], &both[0]), (&[cone, cylinder], &both[1])] {
            for join in list {
                let s = ConeSpline { segments: join.segments(&pair[0], &pair[1]).to_vec() };
                assert!(s.mismatch(1.0) < 1e-12, "{:e}", s.mismatch(1.0));
                assert!(s.segments[2].end().mismatch(&pair[1].element, 1.0) < 1e-12);
            }
        }
    }

    #[test]
    fn the_helical_surface_of_constant_slope_gets_an_osculating_arc_spline() {
        let helix =
            crate::torse::ruled_patch::HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.0, 2.0) };
        use crate::torse::ruled_patch::RuledStrip;
        let cones: Vec<Osculating> = (0..4)
            .map(|i| helix.jet(0.3 * f64::from(i)))
            .map(|j| Osculating::of(&j.element().expect("element"), &j))
            .collect();
        // (14) says nothing here.
        assert!(joins(&cones[0], &cones[1]).is_empty());
        let s = osculating_spline(&cones, &[], &ConeOptions::default()).expect("spline");
        assert!(s.pairs.is_empty() && s.spline.segments.len() == 7, "{:?}", s.pairs);
        assert!(s.spline.segments.iter().all(|s| s.fault().is_none()) && s.spline.mismatch(1.0) < 1e-12);
        assert!(s.spline.segments[6].end().mismatch(&cones[3].element, 1.0) < 1e-12);
        // Fillers have the slope of the surface and vertical axes.
        for s in &s.spline.segments {
            assert!((s.axis().z.abs() - 1.0).abs() < 1e-12, "{s:?}");
        }
    }

    #[test]
    fn joins_that_do_not_exist_are_replaced_by_pairs() {
        // Near u = 0 the conical curvature has an extremum, and joins turn backwards.
        let jet = |u: f64| {
            let c = [
                Vec3::new(u, u * u, u.powi(4)),
                Vec3::new(1.0, 2.0 * u, 4.0 * u.powi(3)),
                Vec3::new(0.0, 2.0, 12.0 * u * u),
                Vec3::new(0.0, 0.0, 24.0 * u),
            ];
            tangent_strip(&c, [1.0, 2.0])
        };
        let cones: Vec<Osculating> =
            [-0.4, -0.2, 0.35, 0.5].map(|u| Osculating::of(&jet(u).element().expect("element"), &jet(u))).to_vec();
        let s = osculating_spline(&cones, &[], &ConeOptions::default()).expect("spline");
        let forward = |j: &Join, i: usize| j.segments(&cones[i], &cones[i + 1]).iter().all(|s| s.fault().is_none());
        let without: Vec<usize> =
            (0..3).filter(|&i| !joins(&cones[i], &cones[i + 1]).iter().any(|j| forward(j, i))).collect();
        assert!(!without.is_empty() && without.len() < 3, "{without:?}");
        assert_eq!(s.pairs, without);
        assert!(s.spline.segments.iter().all(|s| s.fault().is_none()) && s.spline.mismatch(1.0) < 1e-12);
    }

    #[test]
    fn errors_name_the_elements() {
        let elements: Vec<G1Element> = [0.1, 0.3, 0.3, 0.5].map(|u| jet(u).element().expect("element")).to_vec();
        let error = cone_spline(&elements, &[], &ConeOptions::default()).expect_err("identical");
        assert_eq!(error, ConesError::Pair { index: 1, source: PairError::Identical });
        assert!(error.to_string().contains("elements 1 and 2"));
        assert_eq!(cone_spline(&elements[..1], &[], &ConeOptions::default()), Err(ConesError::TooFew(1)));
        assert!(cone_spline(&elements, &[[0.0; 2]], &ConeOptions::default()).is_err());
    }
}
