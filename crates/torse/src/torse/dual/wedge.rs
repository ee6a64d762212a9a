//! Joins and meets of planes: lines and points as minors of plane coordinates \[PW99, 2\].
//!
//! The point common to three planes has the coordinates `x_j = (−1)^j det(minor without column j)` of the rows of
//! plane coordinates. Points are returned in the house's order `(w x, w y, w z, w)`.

use crate::spline::bezier::Bezier;

/// Homogeneous coordinates `(u0, u1, u2, u3)` of a plane.
pub type Plane = [f64; 4];

/// The point common to three planes, homogeneous.
pub(super) fn point_of_planes(a: &Plane, b: &Plane, c: &Plane) -> [f64; 4] {
    let minor = |skip: usize| {
        let k: Vec<usize> = (0..4).filter(|i| *i != skip).collect();
        let (i, j, l) = (k[0], k[1], k[2]);
        let det = a[i] * (b[j] * c[l] - b[l] * c[j]) - a[j] * (b[i] * c[l] - b[l] * c[i])
            + a[l] * (b[i] * c[j] - b[j] * c[i]);
        if skip.is_multiple_of(2) {
            det
        } else {
            -det
        }
    };
    [minor(1), minor(2), minor(3), minor(0)]
}

/// Six Plücker coordinates `a_i b_j − a_j b_i`, `(i, j)` = 01, 02, 03, 12, 13, 23, of the line common to two planes.
pub(super) fn line_of_planes(a: &Bezier<4>, b: &Bezier<4>) -> [Bezier<1>; 6] {
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
        .map(|(i, j)| a.component(i).times(&b.component(j)).minus(&a.component(j).times(&b.component(i))))
}

/// The point common to a line (Plücker coordinates of [`line_of_planes`]) and a plane.
pub(super) fn point_of_line_and_plane(line: &[Bezier<1>; 6], plane: &Bezier<4>) -> Bezier<4> {
    let index = |i: usize, j: usize| match (i, j) {
        (0, 1) => 0,
        (0, 2) => 1,
        (0, 3) => 2,
        (1, 2) => 3,
        (1, 3) => 4,
        _ => 5,
    };
    // Laplace expansion of the minor along the row of the plane.
    let minor = |skip: usize| {
        let k: Vec<usize> = (0..4).filter(|i| *i != skip).collect();
        let (i, j, l) = (k[0], k[1], k[2]);
        let sum = plane.component(i).times(&line[index(j, l)]).minus(&plane.component(j).times(&line[index(i, l)]));
        let sum = sum.plus(&plane.component(l).times(&line[index(i, j)]));
        if skip.is_multiple_of(2) {
            sum
        } else {
            Bezier::constant([0.0]).minus(&sum)
        }
    };
    let c = [minor(1), minor(2), minor(3), minor(0)];
    Bezier::new((0..c[0].control().len()).map(|i| std::array::from_fn(|d| c[d].control()[i][0])).collect())
}
