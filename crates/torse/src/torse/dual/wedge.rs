//! Joins and meets of planes: lines and points as minors of plane coordinates \[PW99, 2\].
//!
//! The point common to three planes `n·X = h` has the coordinates `(D₁, −D₂, D₃, D₀)`, `D_j` being the minor without column
//! `j` of the rows `(h, n_x, n_y, n_z)`. Points are returned in the house's order `(w x, w y, w z, w)`.

use crate::spline::bezier::Bezier;

/// Homogeneous coordinates `(n_x, n_y, n_z, h)` of the plane `n·X = h`.
pub type Plane = [f64; 4];

/// Coordinates of planes in the order of the columns of minors.
const COLUMNS: [usize; 4] = [3, 0, 1, 2];

/// The columns of a minor without column `skip`.
fn without(skip: usize) -> [usize; 3] {
    [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][skip]
}

/// The point common to three planes, homogeneous.
pub(super) fn point_of_planes(a: &Plane, b: &Plane, c: &Plane) -> [f64; 4] {
    let minor = |skip: usize| {
        let [i, j, l] = without(skip).map(|k| COLUMNS[k]);
        a[i] * (b[j] * c[l] - b[l] * c[j]) - a[j] * (b[i] * c[l] - b[l] * c[i]) + a[l] * (b[i] * c[j] - b[j] * c[i])
    };
    [minor(1), -minor(2), minor(3), minor(0)]
}

/// Six Plücker coordinates `a_i b_j − a_j b_i`, columns `(i, j)` = 01, 02, 03, 12, 13, 23, of the line common to two planes.
pub(super) fn line_of_planes(a: &Bezier<4>, b: &Bezier<4>) -> [Bezier<1>; 6] {
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| {
        let (i, j) = (COLUMNS[i], COLUMNS[j]);
        a.component(i).times(&b.component(j)).minus(&a.component(j).times(&b.component(i)))
    })
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
        let [i, j, l] = without(skip);
        let [p, q, r] = [i, j, l].map(|k| plane.component(COLUMNS[k]));
        p.times(&line[index(j, l)]).minus(&q.times(&line[index(i, l)])).plus(&r.times(&line[index(i, j)]))
    };
    let c = [minor(1), Bezier::constant([0.0]).minus(&minor(2)), minor(3), minor(0)];
    Bezier::new((0..c[0].control().len()).map(|i| std::array::from_fn(|d| c[d].control()[i][0])).collect())
}
