//! Which side of an open sheet is its outside: a rule that asks for the shape alone, not for the order or direction in
//! which it was drawn.

use super::Vec3;

/// Share of what could be, below which a sheet is not called convex to either side.
const CONVEX: f64 = 0.05;
/// Share of the area that must look along an axis for that axis to decide.
const ALONG: f64 = 0.1;

/// +1 if the normals of a sheet point outwards, −1 if they point inwards.
///
/// *Rule*: outside is away from `centre`, the middle of all sheets (their convex side); where a sheet does not face away
/// from it on the whole, as plane sheets and saddles do not, outside is where z grows, for upright ones where y grows,
/// else where x grows. *Input*: points of the sheet (mm) with normals as long as the area that they stand for.
pub fn outward(sheet: &[(Vec3, Vec3)], centre: &Vec3) -> f64 {
    let (mut flux, mut most, mut area) = (0.0, 0.0, 0.0);
    let mut normal = Vec3::zeros();
    for (x, n) in sheet {
        let d = x - centre;
        flux += n.dot(&d);
        most += n.norm() * d.norm();
        area += n.norm();
        normal += n;
    }
    if flux.abs() > CONVEX * most {
        return flux.signum();
    }
    [normal.z, normal.y, normal.x].into_iter().find(|c| c.abs() > ALONG * area).map_or(1.0, f64::signum)
}

/// Middle of all sheets: the mean of their points, weighted by area. The origin where there is no area.
pub fn middle<'a>(sheets: impl IntoIterator<Item = &'a (Vec3, Vec3)>) -> Vec3 {
    let (mut sum, mut area) = (Vec3::zeros(), 0.0);
    for (x, n) in sheets {
        sum += x * n.norm();
        area += n.norm();
    }
    if area > 0.0 {
        sum / area
    } else {
        Vec3::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domes_look_away_from_their_middle_and_planes_upwards() {
        let dome: Vec<(Vec3, Vec3)> = (0..40)
            .map(|k| {
                let (s, c) = (k as f64 * 0.7).sin_cos();
                let n = Vec3::new(c * 0.5, s * 0.5, -0.75f64.sqrt());
                (n * 10.0, n)
            })
            .chain([(Vec3::z() * -10.0, -Vec3::z() * 20.0)])
            .collect();
        let turned: Vec<_> = dome.iter().map(|(x, n)| (*x, -n)).collect();
        assert_eq!(outward(&dome, &middle(&dome)), 1.0);
        assert_eq!(outward(&turned, &middle(&turned)), -1.0);
        let plane = |n: Vec3| vec![(Vec3::zeros(), n), (n.cross(&Vec3::new(1.0, 2.0, 3.0)), n)];
        for (n, sign) in [(Vec3::z(), 1.0), (-Vec3::z(), -1.0), (-Vec3::y(), -1.0), (Vec3::x(), 1.0)] {
            let p = plane(n);
            assert_eq!(outward(&p, &middle(&p)), sign, "{n:?}");
        }
    }
}
