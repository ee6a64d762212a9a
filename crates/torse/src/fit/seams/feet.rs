//! Feet of many points that all belong to one sheet of a torse.
//!
//! *Method.* Envelopes continue beyond their regression curve in a second sheet, and rulings of strips that turn far
//! pass near points that belong elsewhere. The regularity of a foot \[SE06\] has one sign on each sheet; feet on the
//! wrong one are looked for again from the foot of the nearest point on the right one.

use crate::fit::near::power_form::Sheet;
use crate::geom::Vec3;

/// Feet of points (in the sheet's coordinates) from first guesses, within a range: `None` for points without one on the
/// sheet to which most points belong.
pub(super) fn feet(sheet: &Sheet, points: &[Vec3], guesses: &[f64], range: (f64, f64)) -> Vec<Option<f64>> {
    let found = |q: &Vec3, guess: f64| sheet.foot(q, guess, range).map(|t| (t, sheet.distance(q, t).1));
    let first: Vec<Option<(f64, f64)>> = points.iter().zip(guesses).map(|(q, &t)| found(q, t)).collect();
    let sign = first.iter().flatten().map(|f| f.1.signum()).sum::<f64>().signum();
    let on_sheet = |f: Option<(f64, f64)>| f.filter(|f| f.1 * sign > 0.0);
    let again = |q: &Vec3| {
        let off = |k: &usize| (points[*k] - q).norm_squared();
        let near = (0..points.len()).filter(|k| on_sheet(first[*k]).is_some());
        let k = near.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        on_sheet(found(q, first[k]?.0))
    };
    let anywhere = |q: &Vec3| on_sheet(found(q, sheet.nearest_foot(q)?));
    let settled = |(q, f): (&Vec3, &Option<(f64, f64)>)| on_sheet(*f).or_else(|| again(q)).or_else(|| anywhere(q));
    points.iter().zip(&first).map(settled).map(|f| f.map(|f| f.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::torse::form::{DualTorse, Torse};

    /// Planes of a cone about the z-axis, as a spline of the angle: points of one half have feet there, whatever the
    /// guess.
    #[test]
    fn points_of_a_cone_keep_to_their_half() {
        let angles: Vec<f64> = (0..=200).map(|i| f64::from(i) / 100.0).collect();
        let planes: Vec<[f64; 4]> = angles.iter().map(|a| [a.cos(), a.sin(), 1.0, 0.0]).collect();
        let knots = Knots::uniform(3, 20, 0.0, 2.0).expect("knots");
        let curve = crate::spline::lsq::fit(&planes, &angles, &knots).expect("planes").curve;
        let curve = Curve::new(3, curve.knots.values().to_vec(), curve.control).expect("a curve");
        let sheet = Sheet::of(&Torse::Dual(DualTorse { planes: curve })).expect("cubic");
        let at: Vec<f64> = (1..20).map(|i| 0.1 * f64::from(i)).collect();
        let points: Vec<Vec3> = at.iter().map(|a| Vec3::new(-50.0 * a.cos(), -50.0 * a.sin(), 50.1)).collect();
        let mut guesses = at.clone();
        guesses[3] = 1.9;
        for (t, a) in feet(&sheet, &points, &guesses, (0.0, 2.0)).into_iter().zip(at) {
            assert!((t.expect("a foot") - a).abs() < 1e-3);
        }
    }
}
