//! How near panels must be to their faces beside an edge for their intersection to stay within the tolerance of it.
//!
//! With heights a and b of both panels over their faces and the angle κ by which the faces turn at the edge, the intersection is
//! `√(a² + b² − 2ab cos κ)/sin κ` away: for heights up to f at most `f/sin κ` or, if that is more, `f/cos(κ/2)` where both have
//! one sign, and `f/sin(κ/2)` where they have not.

use super::places::{Common, Ground, FINE};
use super::vertices::Torses;
use crate::geom::Vec3;
use crate::search::joint::{Meeting, AWAY};
use nalgebra::Matrix3;

/// Share of all products of heights that have one sign along an edge where heights of that sign are expected.
const ONE_SIGN: f64 = 0.9;
/// Heights that must be less than this share of the tolerance are not asked for: panels would become many.
const LEAST_HEIGHT: f64 = 0.25;
/// Places along an edge at which panels are to be equally high, at most: as along a seam inside a face.
const MOST_MEETINGS: usize = 120;
/// Cosine of half the turn of faces at least, for the panels on both sides to be laid anew together.
const LEAST_MIDDLE: f64 = 0.5;

/// Places along an edge on both of its faces, with their normals, seen from one side: borders run counter-clockwise about them.
struct Along {
    places: Vec<[Vec3; 2]>,
    normals: Vec<[Vec3; 2]>,
}

impl Along {
    fn of(of: &Common, grounds: &[Ground]) -> Option<Self> {
        let [a, b] = [0, 1].map(|k: usize| &grounds[of.faces[k]]);
        let points = a.places(&of.chains[0].vertices, FINE);
        let others = b.places(&of.chains[1].vertices, FINE);
        let normals = [a.normals(&of.chains[0].vertices, FINE), b.normals(&of.chains[1].vertices, FINE)];
        let mut out = Self { places: Vec::new(), normals: Vec::new() };
        for (x, n) in points.iter().zip(&normals[0]) {
            let far = |i: &usize| (others[*i] - x).norm_squared();
            let beside = (0..others.len()).min_by(|i, j| far(i).total_cmp(&far(j)))?;
            let m = normals[1][beside];
            out.places.push([*x, others[beside]]);
            out.normals.push([*n, if of.turned { m } else { -m }]);
        }
        Some(out)
    }
}

/// Places along an edge at which panels on both sides are to be equally high. `None` where faces fold back there.
pub(super) fn meetings(edge: usize, of: &Common, grounds: &[Ground]) -> Option<Vec<Meeting>> {
    let Along { places, normals } = Along::of(of, grounds)?;
    let last = places.len() - 1;
    let every = last.div_ceil(MOST_MEETINGS).max(1);
    let chosen: Vec<usize> = (0..last).step_by(every).chain([last]).collect();
    let share = (chosen.len() as f64).recip();
    let length = of.chains[0].length;
    let (faces, labels) = (of.faces, [0, 1].map(|k: usize| of.chains[k].label));
    let meeting = |k: usize| {
        let (places, normals): ([Vec3; 2], [Vec3; 2]) = (places[k], normals[k]);
        let open = (normals[0] + normals[1]).norm() >= 2.0 * LEAST_MIDDLE;
        open.then_some(Meeting { faces, labels, places, normals, share, edge, length })
    };
    chosen.into_iter().map(meeting).collect()
}

/// What distances count in a corner of three faces with these normals, for the common point of three panels that are as high there,
/// above or below: the proof goes to it along rulings and across them, and takes distances beside the corner, where they may be as
/// much more. `None` where normals are nearly in one plane.
pub(super) fn corner_counts(normals: [Vec3; 3]) -> Option<f64> {
    let matrix = Matrix3::from_rows(&normals.map(|n| n.transpose()));
    let back = matrix.try_inverse()?;
    let point = |signs: u32| {
        let sign = |k: u32| if signs & (1 << k) == 0 { 1.0 } else { -1.0 };
        let x = back * Vec3::new(sign(0), sign(1), sign(2));
        // Twice the squares of the way in a panel and of the height.
        (2.0 * x.norm_squared()).sqrt()
    };
    let away = (0..8).map(point).fold(1.0, f64::max);
    (away * LEAST_HEIGHT <= 1.0).then_some(away / AWAY)
}

/// Places along an edge, and what the distances of panels count there. `None` where faces meet at too small an angle.
pub(super) fn counts(of: &Common, grounds: &[Ground], torses: &Torses) -> Option<Vec<(Vec3, f64)>> {
    let Along { places, normals } = Along::of(of, grounds)?;
    let mut near = [0, 1].map(|k: usize| torses.near((of.faces[k], of.chains[k].label), &places[0][0]));
    let (mut out, mut sums) = (Vec::with_capacity(places.len()), [0.0_f64; 2]);
    for ([x, _], [n, m]) in places.iter().zip(&normals) {
        let height = |near: &mut super::intersection_curve::Near, n: &Vec3| near.height(x, n);
        let [first, second] = &mut near;
        let product = height(first.as_mut()?, n)? * height(second.as_mut()?, m)?;
        sums[usize::from(product < 0.0)] += product.abs();
        out.push((*x, n.cross(m).norm().atan2(n.dot(m))));
    }
    let most = sums[0] + sums[1];
    let (same, other) = (sums[0] >= ONE_SIGN * most, sums[1] >= ONE_SIGN * most);
    let share = |turn: f64| {
        let (cos, sin) = ((0.5 * turn).cos(), (0.5 * turn).sin());
        let both = if other {
            sin
        } else if same {
            cos
        } else {
            cos.min(sin)
        };
        both.min(turn.sin())
    };
    let counts: Vec<(Vec3, f64)> = out.into_iter().map(|(x, turn)| (x, AWAY * share(turn))).collect();
    let least = counts.iter().map(|c| c.1).fold(f64::INFINITY, f64::min);
    (least >= LEAST_HEIGHT).then(|| counts.into_iter().map(|(x, c)| (x, c.min(1.0).recip())).collect())
}
