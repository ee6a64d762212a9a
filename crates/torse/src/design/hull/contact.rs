//! Places where a plane touches curves, moved from samples to where they belong \[W15, 4B\].

use crate::geom::Vec3;
use crate::torse::rail::{tangent, Rail};

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnRail {
    /// Index of the curve.
    pub rail: usize,
    /// Its parameter, in [0, number of pieces].
    pub parameter: f64,
    /// Place, mm.
    pub point: Vec3,
}

/// Turn (rad) above which a joint, and always an open end, is a corner: rulings turn about it.
const CORNER: f64 = 1e-6;
/// Halvings of an interval of parameters: down to the last digit.
const HALVINGS: usize = 60;
/// Values of unit vectors' determinants that are rounding: where both ends of a bracket are as small, all places are
/// as good.
const ROUNDING: f64 = 1e-13;
/// Steps of Newton's method, and the change of parameters at which it has arrived.
const STEPS: usize = 20;
/// See [`STEPS`].
const ARRIVED: f64 = 1e-15;
/// Step of difference quotients, share of the bracket.
const DIFFERENCE: f64 = 1e-5;

/// The place with a parameter.
pub(super) fn on(rails: &[Rail], rail: usize, parameter: f64) -> OnRail {
    OnRail { rail, parameter, point: rails[rail].point(parameter) }
}

/// The parameter inside the rail's domain.
pub(super) fn wrap(rail: &Rail, s: f64) -> f64 {
    let n = rail.pieces.len() as f64;
    if rail.closed {
        s.rem_euclid(n)
    } else {
        s.clamp(0.0, n)
    }
}

/// Unit tangents before and behind a parameter.
pub(super) fn tangents(rail: &Rail, s: f64) -> [Vec3; 2] {
    let n = rail.pieces.len();
    let s = wrap(rail, s);
    let k = (s.floor() as usize).min(n - 1);
    let t = s - k as f64;
    let behind = tangent(&rail.pieces[k], t);
    let before = if t == 0.0 && (k > 0 || rail.closed) { tangent(&rail.pieces[(k + n - 1) % n], 1.0) } else { behind };
    [before, behind]
}

/// Whether rulings may turn about the place.
pub(super) fn is_corner(rail: &Rail, s: f64) -> bool {
    let [a, b] = tangents(rail, s);
    let end = !rail.closed && (s <= 0.0 || s >= rail.pieces.len() as f64);
    end || a.angle(&b) > CORNER
}

/// Moves the parameter within `h` until `f` of point and tangent changes its sign; a place without a change stays.
pub(super) fn moved(rails: &[Rail], from: OnRail, h: f64, f: &dyn Fn(&Vec3, &Vec3) -> f64) -> OnRail {
    let rail = &rails[from.rail];
    let value = |s: f64| f(&rail.point(wrap(rail, s)), &tangents(rail, wrap(rail, s))[1]);
    let (mut a, mut b) = (from.parameter - h, from.parameter + h);
    let (fa, fb) = (value(a), value(b));
    if fa * fb > 0.0 || fa.abs().max(fb.abs()) < ROUNDING {
        return from;
    }
    for _ in 0..HALVINGS {
        let m = 0.5 * (a + b);
        if value(m) * fa > 0.0 {
            a = m;
        } else {
            b = m;
        }
    }
    on(rails, from.rail, wrap(rail, 0.5 * (a + b)))
}

/// Determinant of both tangents and the unit ruling.
pub(super) fn coplanarity(p: &Vec3, t: &Vec3, q: &Vec3, d: &Vec3) -> f64 {
    (q - p).try_normalize(0.0).map_or(0.0, |r| t.cross(d).dot(&r))
}

/// The second place moved until its tangent is coplanar with the ruling and the tangent `t` at the first.
pub(super) fn opposite(rails: &[Rail], kept: &OnRail, t: &Vec3, other: OnRail, h: f64) -> OnRail {
    moved(rails, other, h, &|q, d| coplanarity(&kept.point, t, q, d))
}

/// The place moved until its tangent lies in a plane with two points.
pub(super) fn touching(rails: &[Rail], place: OnRail, p: &Vec3, q: &Vec3, h: f64) -> OnRail {
    if is_corner(&rails[place.rail], place.parameter) {
        return place;
    }
    let size = (q - p).norm();
    moved(rails, place, h, &|c, d| {
        let l = size * (c - p).norm();
        if l > 0.0 {
            d.cross(&(c - p)).dot(&(q - p)) / l
        } else {
            0.0
        }
    })
}

/// The plane through three places, moved until it touches the curves where they are smooth: Newton's method in one to
/// three parameters. `steps` are the greatest moves. Corners that do not converge stay where they were.
pub(super) fn tangent_plane(rails: &[Rail], corners: [OnRail; 3], steps: [f64; 3]) -> [OnRail; 3] {
    let smooth: Vec<usize> = (0..3).filter(|&k| !is_corner(&rails[corners[k].rail], corners[k].parameter)).collect();
    if smooth.is_empty() {
        return corners;
    }
    let place = |x: &[f64; 3]| [0, 1, 2].map(|k| on(rails, corners[k].rail, wrap(&rails[corners[k].rail], x[k])));
    let residual =
        |x: &[f64; 3]| -> [f64; 3] {
            let c = place(x);
            let n = (c[1].point - c[0].point).cross(&(c[2].point - c[0].point)).try_normalize(0.0);
            let n = n.unwrap_or_else(Vec3::zeros);
            [0, 1, 2].map(|k| {
                if smooth.contains(&k) {
                    tangents(&rails[c[k].rail], c[k].parameter)[1].dot(&n)
                } else {
                    0.0
                }
            })
        };
    let start = corners.map(|c| c.parameter);
    let mut x = start;
    for _ in 0..STEPS {
        let r = residual(&x);
        // Corners have the equation dx = 0.
        let mut m = nalgebra::Matrix3::<f64>::identity();
        for &k in &smooth {
            let e = DIFFERENCE * steps[k];
            let (mut lo, mut hi) = (x, x);
            lo[k] -= e;
            hi[k] += e;
            let (a, b) = (residual(&lo), residual(&hi));
            for &i in &smooth {
                m[(i, k)] = (b[i] - a[i]) / (2.0 * e);
            }
        }
        let Some(dx) = m.lu().solve(&nalgebra::Vector3::from(r)) else { return corners };
        for k in 0..3 {
            x[k] -= dx[k];
        }
        if (0..3).any(|k| !x[k].is_finite() || (x[k] - start[k]).abs() > steps[k]) {
            return corners;
        }
        if dx.norm() <= ARRIVED {
            break;
        }
    }
    place(&x)
}
