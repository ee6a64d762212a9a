//! Places on a panel by their images in the plane: Newton's method from the nearest of many seeds.

use super::{PlacedPanel, FOUND, SEEDS, STEPS};
use crate::geom::Vec2;
use nalgebra::Matrix2;

/// Share of the distance that is left after a step with which derivatives do for the next one, too.
const AS_STEEP: f64 = 0.1;
/// Share of a panel's rulings by which places may lie beyond its ends: what the digits of drawings leave open.
const EDGE_HAIR: f64 = 1e-7;
/// Share of a panel's parameters by which differences for derivatives are taken: the root of rounding's share.
const DIFFERENCE: f64 = 1e-6;
/// Share of these differences below which a step goes nowhere.
const STANDS: f64 = 1e-9;
/// Share of a patch by which places may lie beyond it.
const MARGIN: f64 = 0.05;
/// Seeds from which places on a patch are looked for where the nearest leads beyond it: at an apex all of one row are one point.
const STARTS: usize = 2 * (SEEDS.0 + 1);

impl PlacedPanel {
    /// Parameters whose image is nearest to a point, and how far it is; those on the patch where there are some: beside an apex
    /// places beyond the patch have the same images, and at it no search leads anywhere.
    pub(super) fn inverse(&self, q: &Vec2, size: f64) -> ([f64; 2], f64) {
        let far = |s: &([f64; 2], Vec2)| (s.1 - q).norm_squared();
        let ((u0, u1), (v0, v1)) = self.panel.surface.domain();
        let [[a, b], [c, d]] = self.slack;
        let on_patch = |uv: [f64; 2]| uv[0] >= u0 - a && uv[0] <= u1 + b && uv[1] >= v0 - c && uv[1] <= v1 + d;
        let found = |(uv, off): ([f64; 2], f64)| on_patch(uv) && off <= FOUND * size;
        let Some(&(near, _)) = self.seeds.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else {
            return ([0.0; 2], f64::INFINITY);
        };
        // A little beyond the patch its last pieces go on; far beyond they mean nothing.
        let first = self.followed(q, near, (size, MARGIN));
        if found(first) {
            return self.at_other_end(q, first.0, size).unwrap_or(first);
        }
        let mut seeds: Vec<_> = self.seeds.iter().collect();
        seeds.sort_by(|a, b| far(a).total_cmp(&far(b)));
        let mut best = first;
        for seed in seeds.iter().take(STARTS) {
            let next = self.followed(q, seed.0, (size, 0.0));
            if next.1 < best.1 {
                best = next;
            }
            if found(next) {
                return next;
            }
        }
        best
    }

    /// The place within the panel's first and last ruling that has the same image as one beyond them: patches go on beyond their
    /// panels, and those of shallow cones all round over the slit.
    fn at_other_end(&self, q: &Vec2, beyond: [f64; 2], size: f64) -> Option<([f64; 2], f64)> {
        let column = |i: usize| &self.seeds[i * (SEEDS.1 + 1)..(i + 1) * (SEEDS.1 + 1)];
        let ([lo, hi], hair) = (self.ends, EDGE_HAIR * (self.ends[1] - self.ends[0]));
        let other = match beyond[0] {
            u if u < lo - hair => column(SEEDS.0),
            u if u > hi + hair => column(0),
            _ => return None,
        };
        // At a tip all rulings have one image: that is no other place.
        let point = |uv: [f64; 2]| self.panel.surface.point(uv[0], uv[1]);
        let is_other = |uv: [f64; 2]| (point(uv) - point(beyond)).norm() > EDGE_HAIR * size;
        let inside = |(uv, off): &([f64; 2], f64)| {
            uv[0] >= lo - hair && uv[0] <= hi + hair && *off <= FOUND * size && is_other(*uv)
        };
        other.iter().map(|seed| self.followed(q, seed.0, (size, 0.0))).find(inside)
    }

    /// Newton's method towards a point from given parameters, which keep to the patch and a share of it beyond.
    fn followed(&self, q: &Vec2, mut uv: [f64; 2], (size, margin): (f64, f64)) -> ([f64; 2], f64) {
        let ((u0, u1), (v0, v1)) = self.panel.surface.domain();
        let h = [DIFFERENCE * (u1 - u0), DIFFERENCE * (v1 - v0)];
        let (du, dv) = (margin * (u1 - u0), margin * (v1 - v0));
        let mut best = (uv, f64::INFINITY);
        let mut inverse: Option<Matrix2<f64>> = None;
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            let off = q - self.own_flat(uv);
            if off.norm() < best.1 {
                best = (uv, off.norm());
            }
            if off.norm() <= FOUND * size {
                break;
            }
            // Derivatives are taken anew where those of the last step lead on no more.
            if inverse.is_none() || off.norm() > AS_STEEP * before {
                let slope = |k: usize| {
                    let (mut a, mut b) = (uv, uv);
                    a[k] -= h[k];
                    b[k] += h[k];
                    (self.own_flat(b) - self.own_flat(a)) / (2.0 * h[k])
                };
                inverse = Matrix2::from_columns(&[slope(0), slope(1)]).try_inverse();
            }
            before = off.norm();
            let Some(step) = inverse.map(|i| i * off) else { break };
            if !(step.x.is_finite() && step.y.is_finite()) {
                break;
            }
            let next = [(uv[0] + step.x).clamp(u0 - du, u1 + du), (uv[1] + step.y).clamp(v0 - dv, v1 + dv)];
            // At a border beyond which the point lies, or at what rounding leaves.
            if (0..2).all(|k| (next[k] - uv[k]).abs() <= STANDS * h[k]) {
                break;
            }
            uv = next;
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Atlas, OnPanel, PanelPatch};
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::{Frame, Vec3};
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use std::f64::consts::TAU;

    /// A cone of 85° between axis and rulings all round, whose patch goes on over the slit by more than what is open there.
    #[test]
    fn places_beside_the_slit_of_a_shallow_cone_are_on_its_panel() {
        let circle = SpaceCurve::Ellipse { frame: Frame::world(), a: 1.0, b: 1.0 };
        let (arc, map) = circle.to_spline(-0.05, TAU + 0.05).expect("an arc");
        let slope = 85.0_f64.to_radians().tan().recip();
        let place = |h: &[f64; 4], r: f64| Vec3::new(h[0] / h[3], h[1] / h[3], slope) * r;
        let points: Vec<Vec3> = arc.control.iter().flat_map(|h| [place(h, 0.1), place(h, 90.0)]).collect();
        let weights: Vec<f64> = arc.control.iter().flat_map(|h| [h[3]; 2]).collect();
        let across = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let surface = Surface::new(arc.knots, across, &points, Some(&weights)).expect("a patch");
        let [lo, hi] = [0.0, TAU].map(|a| map.forward(a));
        let loops = vec![vec![[lo, 0.0], [hi, 0.0], [hi, 1.0], [lo, 1.0]]];
        let corners = loops[0].clone();
        let panel = PanelPatch { name: "A".into(), surface, loops, corners };
        let atlas = Atlas::developed(vec![panel], 0.0).expect("an atlas");
        let mut beyond = 0;
        for k in 1..400 {
            for v in [0.003, 0.01, 0.04, 0.1, 0.5, 0.95] {
                let uv = [lo + (hi - lo) * f64::from(k) / 400.0, v];
                let q = atlas.flat(&OnPanel { panel: 0, uv, off: 0.0 });
                let found = atlas.on_panel(0, &q);
                assert!((found[0] - uv[0]).abs() < 1e-6 && (found[1] - v).abs() < 1e-6, "{uv:?} {found:?}");
                let placed = &atlas.panels[0];
                let own = placed.own_flat(uv);
                let far = |s: &&([f64; 2], Vec2)| (s.1 - own).norm_squared();
                let near = placed.seeds.iter().min_by(|a, b| far(a).total_cmp(&far(b))).expect("seeds");
                let (first, off) = placed.followed(&own, near.0, (atlas.size, MARGIN));
                beyond += usize::from(off < 1e-9 && (first[0] < lo - 1e-3 || first[0] > hi + 1e-3));
            }
        }
        assert!(beyond > 0, "no search led beyond the slit");
    }
}
