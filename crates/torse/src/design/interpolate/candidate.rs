//! A net that holds both lines, measured: reaches, clearance, regularity.
//! The quantities are those of \[FJ07\], section 4.

use super::problem::{affine, Problem};
use super::solution::Solution;
use crate::geom::Vec3;
use crate::torse::net::{Net, Regularity, TaperedNet};

/// Share of a reach by which it may differ from the one wanted: rounding, for which no taper is worth it.
const SAME_REACH: f64 = 1e-12;

/// The solution with this net, tapered if the last reach is prescribed. `None` if the last ruling points away from
/// the side given and a reach is prescribed there.
pub(super) fn measured(problem: &Problem, net: Net) -> Option<Solution> {
    let last = net.rulings().len() - 1;
    let (c_0, c_l) = (net.curve().control[0], net.curve().control[last]);
    let (e_0, e_l) = (net.rulings()[0], net.rulings()[last]);
    let start_reach = reach(&c_0, &e_0, &problem.v);
    let mut end_reach = reach(&c_l, &e_l, &problem.w);
    let angle = |x: Vec3, line: &Vec3| x.cross(line).norm().atan2(x.dot(line).abs());
    let end_error = angle(direction(&c_0, &e_0), &problem.v).max(angle(direction(&c_l, &e_l), &problem.w));
    let mut taper = (1.0, 1.0);
    if let Some(wanted) = problem.options.end_reach {
        if (end_reach - wanted).abs() > SAME_REACH * wanted {
            let factor = factor(&c_l, &e_l, &problem.w, wanted)?;
            if !(factor > 0.0 && factor.is_finite()) {
                return None;
            }
            taper.1 = factor;
            end_reach = wanted;
        }
    }
    let strip = TaperedNet { net, taper };
    let clearance_estimate = strip.net.clearance_estimate();
    let regularity = regularity(&strip);
    Some(Solution { strip, start_reach, end_reach, clearance_estimate, regularity, end_error })
}

fn regularity(strip: &TaperedNet) -> Regularity {
    if strip.is_constant() {
        strip.net.regularity()
    } else {
        strip.regularity()
    }
}

/// Direction of the ruling at the homogeneous point `c` with the ruling vector `e`, times the weight of `c`.
fn direction(c: &[f64; 4], e: &[f64; 4]) -> Vec3 {
    Vec3::new(e[0], e[1], e[2]) - affine(c) * e[3]
}

/// Length of the ruling from `c` to `c + e` in the vector `unit`.
fn reach(c: &[f64; 4], e: &[f64; 4], unit: &Vec3) -> f64 {
    direction(c, e).dot(unit) / unit.norm_squared() / (c[3] + e[3])
}

/// `β` for which `c + β e` lies at `wanted` times `unit` from `c`.
fn factor(c: &[f64; 4], e: &[f64; 4], unit: &Vec3, wanted: f64) -> Option<f64> {
    let along = direction(c, e).dot(unit) / unit.norm_squared();
    let below = along - wanted * e[3];
    (below != 0.0).then(|| wanted * c[3] / below)
}
