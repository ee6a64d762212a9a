//! Proof that the quadrilaterals of a strip are plane (discrete torses, section 1A of \[W15\]), by interval arithmetic
//! \[MKC09\].

use super::claim::UpperBound;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::torse::quad_strip::QuadStrip;

/// Bound of the distance (mm) between the lines through the diagonals of quadrilateral `i`, with the rounding of its
/// evaluation; unknown for diagonals that may be parallel, and for an index beyond the strip.
///
/// A plane quadrilateral has the distance 0. All four corners lie within half of it of the plane between the
/// diagonals, and so does every point of the bilinear patch.
pub fn gap_bound(strip: &QuadStrip, i: usize) -> UpperBound {
    if i >= strip.quads() {
        return UpperBound::UNKNOWN;
    }
    let ([a, b], [c, d]) = (strip.ruling(i), strip.ruling(i + 1));
    let (d1, d2, side) = (difference(&d, &a), difference(&b, &c), difference(&c, &a));
    let n = [d1[1] * d2[2] - d1[2] * d2[1], d1[2] * d2[0] - d1[0] * d2[2], d1[0] * d2[1] - d1[1] * d2[0]];
    let length = (n[0].sqr() + n[1].sqr() + n[2].sqr()).sqrt();
    if length.lo.is_nan() || length.lo <= 0.0 {
        return UpperBound::UNKNOWN;
    }
    let gap = (side[0] * n[0] + side[1] * n[1] + side[2] * n[2]) / length;
    UpperBound::shown(gap.mag())
}

fn difference(p: &Vec3, q: &Vec3) -> [Interval; 3] {
    [0, 1, 2].map(|k| Interval::point(p[k]) - Interval::point(q[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(z: f64) -> QuadStrip {
        let p = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        QuadStrip::new(vec![p(0.1, 0.0, z), p(70.3, 0.0, -z)], vec![p(0.1, 30.7, -z), p(70.3, 30.7, z)])
            .expect("a strip")
    }

    #[test]
    fn the_bound_is_above_the_distance_of_the_diagonals_and_near_it() {
        for z in [0.0, 1e-9, 0.01, 3.0] {
            let bound = gap_bound(&quad(z), 0).value();
            assert!(bound >= 2.0 * z && bound <= 2.0 * z + 1e-12, "{bound}");
            assert!(bound >= quad(z).gap(0).abs());
        }
    }

    #[test]
    fn a_moved_corner_is_refused() {
        let plane = quad(0.0);
        let mut a = plane.a().to_vec();
        a[1].z += 2e-3;
        let moved = QuadStrip::new(a, plane.b().to_vec()).expect("a strip");
        assert!(gap_bound(&plane, 0).value() < 1e-12 && gap_bound(&moved, 0).value() > 0.9e-3);
        assert_eq!(gap_bound(&plane, 1), UpperBound::UNKNOWN);
    }
}
