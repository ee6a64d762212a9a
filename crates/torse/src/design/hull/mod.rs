//! Developables on the boundary of the convex hull of space curves \[W15, 4B\].
//!
//! [`hull`] finds rulings, planar triangles and chains of both; [`strips::strips`] makes exact strips along the chains.

pub mod chains;
mod contact;
pub mod strips;

use crate::geom::convex_hull::{convex_hull, sides};
use crate::geom::Vec3;
use crate::spline::SplineError;
use crate::surface::rail::Rail;
use chains::Chain;
use contact::{coplanarity, is_corner, on, opposite, tangent_plane, tangents};

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnRail {
    /// Index of the curve.
    pub rail: usize,
    /// Its parameter, in [0, number of pieces].
    pub parameter: f64,
    /// Place, mm.
    pub point: Vec3,
}

/// A ruling of the hull's boundary, or the edge of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullRuling {
    /// Its ends.
    pub ends: [OnRail; 2],
    /// |det| of both unit tangents and the unit ruling; 0 where an end is a corner, about which rulings turn freely.
    pub residual: f64,
}

/// Rulings and planar pieces of the boundary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hull {
    /// Rulings, each once, in no particular order.
    pub rulings: Vec<HullRuling>,
    /// Planar triangles that touch the curves at three places far apart.
    pub facets: Vec<[OnRail; 3]>,
    /// Planar curves that are the boundary of a planar piece.
    pub lids: Vec<usize>,
    /// Runs of rulings that follow each other; facets along a straight piece of a curve belong to them.
    pub chains: Vec<Chain>,
    /// Facets (indices) that belong to no chain: those with three rulings as sides, or one.
    pub single: Vec<usize>,
}

/// Why there is no hull.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HullError {
    /// No volume.
    #[error("there is no point off the plane of {curves}: the convex hull has no volume; add a curve off that plane")]
    Flat {
        /// Names of the curves.
        curves: String,
    },
    /// No curve at all.
    #[error("a convex hull needs at least one curve; name the files of the curves")]
    NoCurves,
    /// A curve that comes nowhere near the boundary.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// A strip could not be stored.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// Distance from a plane, as a share of the size, up to which a curve is planar: rounding of the points.
const PLANAR: f64 = 1e-10;
/// Fewest samples on a piece.
const LEAST: usize = 4;

/// Curves as points, and the triangles of their hull.
struct Sampled<'a> {
    rails: &'a [Rail],
    at: Vec<OnRail>,
    /// Neighbours on the curve; a point without neighbour is its own.
    next: Vec<[usize; 2]>,
    /// Whether a curve is planar.
    planar: Vec<bool>,
    /// Parameter between samples of each curve.
    step: Vec<f64>,
    triangles: Vec<[usize; 3]>,
}

/// What a side of a triangle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SideKind {
    /// Two neighbouring samples of a curve.
    Curve,
    /// A straight piece.
    Straight,
    /// Anything else: a ruling.
    Ruling,
}

impl<'a> Sampled<'a> {
    fn new(rails: &'a [Rail], samples: usize) -> Result<Self, HullError> {
        if rails.is_empty() {
            return Err(HullError::NoCurves);
        }
        let mut out = Self {
            rails,
            at: Vec::new(),
            next: Vec::new(),
            planar: Vec::new(),
            step: Vec::new(),
            triangles: Vec::new(),
        };
        for (r, rail) in rails.iter().enumerate() {
            let first = out.at.len();
            let per = samples.div_ceil(rail.pieces.len().max(1)).max(LEAST);
            for k in 0..rail.pieces.len() {
                let n = if rail.is_straight(k) { 1 } else { per };
                out.at.extend((0..n).map(|i| on(rails, r, k as f64 + i as f64 / n as f64)));
            }
            if !rail.closed {
                out.at.push(on(rails, r, rail.pieces.len() as f64));
            }
            let n = out.at.len() - first;
            let open = usize::from(!rail.closed);
            out.next.extend((0..n).map(|i| {
                let (next, last) = ((i + 1) % n, (i + n - 1) % n);
                let (next, last) = (
                    if i + 1 == n { next * (1 - open) + i * open } else { next },
                    if i == 0 { last * (1 - open) } else { last },
                );
                [first + next, first + last]
            }));
            out.planar.push(is_planar(&out.at[first..], rail.bbox().diagonal()));
            out.step.push(1.0 / per as f64);
        }
        let points: Vec<Vec3> = out.at.iter().map(|a| a.point).collect();
        let names = || rails.iter().map(|r| r.name.clone()).collect::<Vec<_>>().join(", ");
        out.triangles = convex_hull(&points).ok_or_else(|| HullError::Flat { curves: names() })?;
        Ok(out)
    }

    fn side(&self, e: [usize; 2]) -> SideKind {
        if !self.next[e[0]].contains(&e[1]) {
            SideKind::Ruling
        } else if is_chord(self.rails, &self.at[e[0]], &self.at[e[1]]) {
            SideKind::Straight
        } else {
            SideKind::Curve
        }
    }

    /// The planar curve that a triangle lies within.
    fn lid(&self, f: &[usize; 3]) -> Option<usize> {
        let r = self.at[f[0]].rail;
        (self.planar[r] && f.iter().all(|&i| self.at[i].rail == r)).then_some(r)
    }

    /// Bracket of the search about a sample: two steps.
    fn reach(&self, i: usize) -> f64 {
        2.0 * self.step[self.at[i].rail]
    }
}

/// Rulings, facets and chains of the convex hull's boundary; `samples` points per curve begin the search.
///
/// *Method.* Hull of samples; edges between places that are no neighbours on a curve are rulings. With one end kept,
/// the other is moved until tangents and ruling are coplanar \[W15, 4B\], by halving of a bracket. Straight pieces are
/// their ends, so a facet along them is one triangle; its corners are moved until the curves touch its plane.
///
/// *Not guaranteed.* Rulings whose bracket holds no sign change stay as sampled: their `residual` says so. Features
/// finer than the samples are not seen. *Cost*: the square of the number of samples.
///
/// # Errors
/// No curves; curves in one plane.
pub fn hull(rails: &[Rail], samples: usize) -> Result<Hull, HullError> {
    let sampled = Sampled::new(rails, samples)?;
    let mut out = Hull::default();
    // Indices of facets, by triangle.
    let mut facet_of = vec![None; sampled.triangles.len()];
    for (t, f) in sampled.triangles.iter().enumerate() {
        if let Some(r) = sampled.lid(f) {
            if !out.lids.contains(&r) {
                out.lids.push(r);
            }
            continue;
        }
        if !sides(f).iter().any(|e| sampled.side(*e) == SideKind::Curve) {
            facet_of[t] = Some(out.facets.len());
            out.facets.push(tangent_plane(rails, f.map(|i| sampled.at[i]), f.map(|i| sampled.reach(i))));
            continue;
        }
        for [i, j] in sides(f).into_iter().filter(|e| sampled.side(*e) == SideKind::Ruling) {
            // The edge's other triangle has it the other way round.
            if i < j {
                out.rulings.push(refined(&sampled, [i, j]));
            }
        }
    }
    (out.chains, out.single) = chains::chains(&sampled, &facet_of, &out.facets);
    Ok(out)
}

fn is_planar(points: &[OnRail], size: f64) -> bool {
    let o = points[0].point;
    let normals = points.windows(2).map(|w| (w[0].point - o).cross(&(w[1].point - o)));
    let Some(n) = normals.max_by(|a, b| a.norm().total_cmp(&b.norm())).and_then(|n| n.try_normalize(0.0)) else {
        return true;
    };
    points.iter().all(|p| (p.point - o).dot(&n).abs() <= PLANAR * size)
}

/// Whether two neighbours are joined by a straight piece.
fn is_chord(rails: &[Rail], a: &OnRail, b: &OnRail) -> bool {
    let n = rails[a.rail].pieces.len() as f64;
    let whole = |x: f64| x == x.floor();
    let (x, y) = (a.parameter.min(b.parameter), a.parameter.max(b.parameter));
    let first = if y - x > 1.0 { y } else { x };
    whole(x) && whole(y) && first < n && rails[a.rail].is_straight(first as usize)
}

fn refined(sampled: &Sampled, e: [usize; 2]) -> HullRuling {
    let rails = sampled.rails;
    let ends = e.map(|i| sampled.at[i]);
    if ends.iter().any(|e| is_corner(&rails[e.rail], e.parameter)) {
        return HullRuling { ends, residual: 0.0 };
    }
    let t = tangents(&rails[ends[0].rail], ends[0].parameter)[1];
    let end = opposite(rails, &ends[0], &t, ends[1], sampled.reach(e[1]));
    let d = tangents(&rails[end.rail], end.parameter)[1];
    HullRuling { ends: [ends[0], end], residual: coplanarity(&ends[0].point, &t, &end.point, &d).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;

    fn circle(r: f64, z: f64, turn: f64) -> Rail {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let arcs: Vec<Curve<4>> = (0..4)
            .map(|k| {
                let a = turn + f64::from(k) * std::f64::consts::FRAC_PI_2;
                let m = a + std::f64::consts::FRAC_PI_4;
                let e = |a: f64| [r * a.cos(), r * a.sin(), z, 1.0];
                let b = a + std::f64::consts::FRAC_PI_2;
                let control = vec![e(a), [r * m.cos(), r * m.sin(), h * z, h], e(b)];
                Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], control).expect("arc")
            })
            .collect();
        Rail::new("circle", &arcs).expect("circle")
    }

    #[test]
    fn rulings_between_two_parallel_circles_meet_at_the_apex() {
        let hull = hull(&[circle(1.0, 0.0, 0.0), circle(0.5, 1.0, 0.1)], 64).expect("hull");
        assert_eq!(hull.lids.len(), 2);
        assert!(hull.rulings.len() >= 64 && hull.facets.is_empty());
        for r in &hull.rulings {
            let [a, b] = if r.ends[0].rail == 0 { r.ends } else { [r.ends[1], r.ends[0]] };
            assert!(r.residual < 1e-14);
            assert!((a.point * 0.5 + Vec3::new(0.0, 0.0, 1.0) - b.point).norm() < 1e-13);
        }
    }

    #[test]
    fn a_circle_and_a_square_have_four_facets_that_touch_the_circle() {
        let c = 0.8;
        let corners = [[c, c], [-c, c], [-c, -c], [c, -c], [c, c]].map(|p| Vec3::new(p[0], p[1], 1.5));
        let square = Rail::polyline("square", &corners).expect("square");
        let hull = hull(&[circle(1.0, 0.0, 0.123), square], 64).expect("hull");
        assert_eq!((hull.facets.len(), hull.lids.len()), (4, 2));
        for f in &hull.facets {
            let p = f.iter().find(|p| p.rail == 0).expect("on the circle").point;
            assert!((p.x.abs().max(p.y.abs()) - 1.0).abs() < 1e-13, "{p}");
        }
    }

    #[test]
    fn curves_of_a_plane_have_no_hull() {
        assert_eq!(hull(&[circle(1.0, 0.0, 0.0)], 64), Err(HullError::Flat { curves: "circle".into() }));
    }
}
