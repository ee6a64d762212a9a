//! Proven distances between the rails of a strip and the rails that were asked for.
//!
//! *Method.* On every piece, the strip's rail R(u) and the given rail at its parameter, H(σ(u)), are polynomials in
//! homogeneous coordinates; `R.xyz H.w − H.xyz R.w` divided by the least weights bounds the distance, all by Bernstein
//! coefficients \[FR88\]. Rounding of the composition is added as a share of the size of the coefficients.

use crate::spline::bezier::Bezier;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::surface::rail::{Rail, RailPart};
use crate::surface::strip::Strip;

/// Rounding of the composition of polynomials of degree 5 and below 10, as a share of the largest coefficient: some
/// hundred operations of 1.1e-16 each.
const ROUNDING: f64 = 4e-14;

/// Bound on the distance (mm) between a strip's rail and the part of the given rail that it stands for, point by
/// point; both are run through from end to end, so it bounds the distance in both directions. `None` if the parts do
/// not belong together (a piece that does not exist, weights that are not positive).
///
/// *Guarantee*: the bound holds at every parameter, rounding included.
pub fn rail_bound(strip: &Strip, side: usize, rail: &Rail, part: &RailPart) -> Option<f64> {
    let given = rail.pieces.get(part.piece)?;
    let pieces = bezier_pieces(given);
    // Both the strip's spans and those of the parameter.
    let edge = strip.rail(side);
    let mut worst = 0.0_f64;
    let mut breaks = edge.knots.breaks();
    breaks.extend(part.parameter.knots.breaks());
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    for w in breaks.windows(2).filter(|w| w[1] - w[0] > 1e-12) {
        let r = Bezier::new(single(&edge, w[0], w[1])?);
        let sigma = Bezier::new(single(&part.parameter, w[0], w[1])?);
        let middle = sigma.point(0.5)[0];
        let (a, b, net) = pieces.iter().find(|p| middle <= p.1).or(pieces.last())?;
        let shift = Bezier::constant([-a / (b - a)]);
        let local = sigma.times(&Bezier::constant([1.0 / (b - a)])).plus(&shift);
        let h = Bezier::new(net.clone()).compose(&local);
        let difference = r.times(&h.component(3)).minus(&h.times(&r.component(3)));
        let (rw, hw) = (r.component(3).hull()[0], h.component(3).hull()[0]);
        if rw.0 <= 0.0 || hw.0 <= 0.0 {
            return None;
        }
        let largest = difference.control().iter().map(|c| c[0].hypot(c[1]).hypot(c[2])).fold(0.0, f64::max);
        let size = |c: &Bezier<4>| c.control().iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let rounding = ROUNDING * size(&r) * size(&h);
        worst = worst.max((largest + rounding) / (rw.0 * hw.0));
    }
    worst.is_finite().then_some(worst)
}

/// Bézier points of a curve over a stretch without knots inside.
fn single<const D: usize>(c: &Curve<D>, a: f64, b: f64) -> Option<Vec<[f64; D]>> {
    let (lo, hi) = c.domain();
    c.restricted(a.max(lo), b.min(hi)).ok().map(|c| c.control)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::surface::torse::PanelKind;

    #[test]
    fn the_bound_exceeds_every_sample_and_sees_what_is_moved() {
        let rail = Rail::through(
            "r",
            &(0..9).map(|k| f64::from(k) * 0.4).map(|t| Vec3::new(10.0 * t, t.sin(), t.cos())).collect::<Vec<_>>(),
        )
        .expect("rail");
        let sigma = Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![[0.0], [0.6], [1.0]]).expect("σ");
        // The given rail at σ(u), sampled and joined by a polygon: near, but not on it.
        let n = 200;
        let at = |u: f64| rail.point(sigma.point(u)[0]);
        let control: Vec<[f64; 3]> = (0..=n).map(|k| at(f64::from(k) / f64::from(n)).into()).collect();
        let mut knots = vec![0.0];
        knots.extend((0..=n).map(|k| f64::from(k) / f64::from(n)));
        knots.push(1.0);
        let a = Curve::<3>::new(1, knots, control).expect("polygon");
        let far = Curve::<3>::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0, 50.0, 0.0], [32.0, 50.0, 0.0]]).expect("far");
        let strip = Strip::polynomial("s", PanelKind::Torse, &a, &far).expect("strip");
        // Knots of the rail between breaks of the polygon would spoil the pieces: the spline has its own breaks.
        let part = RailPart { piece: 0, parameter: sigma.clone() };
        let sampled =
            (0..=1000).map(|k| f64::from(k) / 1000.0).map(|u| (strip.ruling(u)[0] - at(u)).norm()).fold(0.0, f64::max);
        let bound = rail_bound(&strip, 0, &rail, &part).expect("bound");
        assert!(sampled > 0.0 && bound >= sampled && bound < 0.05, "{sampled} {bound}");
        assert!(rail_bound(&strip, 0, &rail, &RailPart { piece: 4, parameter: sigma }).is_none());
    }
}
