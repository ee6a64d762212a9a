//! Developables on the boundary of the convex hull of space curves \[W15, 4B\].
//!
//! [`hull`] finds rulings, planar triangles and chains of both; [`strips::strips`] makes exact strips along the chains.

pub mod chains;
mod contact;
pub(crate) mod needless;
mod sampled;
pub(crate) mod sparse;
pub mod strips;
mod tip;
mod turning;
mod walk;

use crate::control::Control;
use crate::geom::convex_hull::sides;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::torse::rail::Rail;
use chains::RulingChain;
pub(crate) use contact::OnRail;
use contact::{coplanarity, is_corner, opposite, tangent_plane, tangents};
pub use sampled::HullError;
use sampled::{Sampled, SideKind};

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
    /// Curves with the boundary of a planar piece of the hull, and whether all of the curve lies in its plane.
    pub lids: Vec<(usize, bool)>,
    /// Runs of rulings that follow each other; facets along a straight piece of a curve belong to them.
    pub chains: Vec<RulingChain>,
    /// Facets (indices) that belong to no chain: those with three rulings as sides, or one.
    pub single: Vec<usize>,
    /// The triangles of the samples' own hull, without planar pieces inside one curve: what all of the above is about.
    pub triangles: Vec<[Vec3; 3]>,
    /// Greatest distance (mm) of the curves from the chords between samples, measured: the hull of the samples is that near.
    pub sagitta: f64,
}

/// Rulings, facets and chains of the convex hull's boundary; `samples` points per curve begin the search.
///
/// *Method.* Hull of samples; edges between places that are no neighbours on a curve are rulings. With one end kept,
/// the other is moved until tangents and ruling are coplanar \[W15, 4B\], by halving of a bracket. Straight pieces are
/// their ends, so a facet along them is one triangle; its corners are moved until the curves touch its plane.
///
/// *Not guaranteed.* Rulings whose bracket holds no sign change stay as sampled: their `residual` says so. Features
/// finer than the samples are not seen. A control that says stop leaves the rest out. *Cost*: the square of the number
/// of samples, on all cores.
///
/// # Errors
/// No curves; curves in one plane.
pub fn hull(rails: &[Rail], samples: usize, control: &Control) -> Result<Hull, HullError> {
    let sampled = Sampled::new(rails, samples, control)?;
    let mut out = Hull { sagitta: sampled.sagitta(), ..Hull::default() };
    // Indices of facets, by triangle.
    let mut facet_of = vec![None; sampled.triangles.len()];
    let mut rulings = Vec::new();
    for (t, f) in sampled.triangles.iter().enumerate() {
        if control.stopped() {
            return Ok(out);
        }
        if let Some(r) = sampled.lid(f) {
            if !out.lids.contains(&r) {
                out.lids.push(r);
            }
            continue;
        }
        out.triangles.push(f.map(|i| sampled.at[i].point));
        if !sides(f).iter().any(|e| sampled.side(*e) == SideKind::Curve) {
            facet_of[t] = Some(out.facets.len());
            out.facets.push(tangent_plane(rails, f.map(|i| sampled.at[i]), f.map(|i| sampled.reach(i))));
            continue;
        }
        for [i, j] in sides(f).into_iter().filter(|e| sampled.side(*e) == SideKind::Ruling) {
            // The edge's other triangle has it the other way round.
            if i < j {
                rulings.push([i, j]);
            }
        }
    }
    let rulings = parallel::map(&rulings, |e| (!control.stopped()).then(|| refined(&sampled, *e)));
    out.rulings = rulings.into_iter().flatten().collect();
    (out.chains, out.single) = chains::chains(&sampled, &facet_of, &out.facets, control);
    Ok(out)
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
        let hull = hull(&[circle(1.0, 0.0, 0.0), circle(0.5, 1.0, 0.1)], 64, &Control::default()).expect("hull");
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
        let hull = hull(&[circle(1.0, 0.0, 0.123), square], 64, &Control::default()).expect("hull");
        assert_eq!((hull.facets.len(), hull.lids.len()), (4, 2));
        for f in &hull.facets {
            let p = f.iter().find(|p| p.rail == 0).expect("on the circle").point;
            assert!((p.x.abs().max(p.y.abs()) - 1.0).abs() < 1e-13, "{p}");
        }
    }

    #[test]
    fn curves_of_a_plane_have_no_hull() {
        assert_eq!(
            hull(&[circle(1.0, 0.0, 0.0)], 64, &Control::default()),
            Err(HullError::Flat { curves: "circle".into() })
        );
    }
}
