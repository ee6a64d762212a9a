//! Developables on the boundary of the convex hull of space curves \[W15, 4B\].

use crate::geom::convex_hull::{convex_hull, sides};
use crate::geom::Vec3;
use crate::surface::rail::{tangent, Rail};

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

/// A ruling of the hull's boundary, or the edge of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullRuling {
    /// Its ends.
    pub ends: [OnRail; 2],
    /// |det| of both unit tangents and the unit ruling; 0 where an end is a corner, about which rulings turn freely.
    pub residual: f64,
}

/// Rulings and planar pieces of the boundary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hull {
    /// Rulings, each once, in no particular order.
    pub rulings: Vec<HullRuling>,
    /// Planar triangles that touch the curves at three places far apart.
    pub facets: Vec<[OnRail; 3]>,
    /// Planar curves that are the boundary of a planar piece.
    pub lids: Vec<usize>,
}

/// Why there is no hull.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HullError {
    /// No volume.
    #[error("the curves lie in one plane, or are none: their convex hull has no volume; add a curve off that plane")]
    Flat,
}

/// Distance from a plane, as a share of the size, up to which a curve is planar: rounding of the points.
const PLANAR: f64 = 1e-10;
/// Halvings of an interval of parameters: down to the last digit.
const HALVINGS: usize = 60;

/// Rulings and facets of the convex hull's boundary; `samples` points per curve begin the search.
///
/// *Method.* Hull of samples; edges between places that are no neighbours on a curve are rulings. With one end kept,
/// the other is moved until tangents and ruling are coplanar \[W15, 4B\], by halving of a bracket. Straight pieces are
/// their ends, so a facet along them is one triangle; its third corner is moved until the curve touches its plane.
///
/// *Not guaranteed.* Rulings whose bracket holds no sign change stay as sampled: their `residual` says so. Facets that
/// touch three smooth curves are not refined. Features finer than the samples are not seen.
///
/// # Errors
/// Curves in one plane.
pub fn hull(rails: &[Rail], samples: usize) -> Result<Hull, HullError> {
    let mut at: Vec<OnRail> = Vec::new();
    let mut next: Vec<[usize; 2]> = Vec::new();
    let mut planar = vec![false; rails.len()];
    for (r, rail) in rails.iter().enumerate() {
        let first = at.len();
        let per = samples.div_ceil(rail.pieces.len().max(1)).max(4);
        for k in 0..rail.pieces.len() {
            let n = if rail.is_straight(k) { 1 } else { per };
            at.extend((0..n).map(|i| on(rails, r, k as f64 + i as f64 / n as f64)));
        }
        if !rail.closed {
            at.push(on(rails, r, rail.pieces.len() as f64));
        }
        let n = at.len() - first;
        next.extend((0..n).map(|i| [first + (i + 1) % n, first + (i + n - 1) % n]));
        planar[r] = is_planar(&at[first..], rail.bbox().diagonal());
    }
    let points: Vec<Vec3> = at.iter().map(|a| a.point).collect();
    let triangles = convex_hull(&points).ok_or(HullError::Flat)?;
    let mut out = Hull::default();
    for f in &triangles {
        let r = at[f[0]].rail;
        if planar[r] && f.iter().all(|&i| at[i].rail == r) {
            if !out.lids.contains(&r) {
                out.lids.push(r);
            }
            continue;
        }
        let near = |e: &[usize; 2]| next[e[0]].contains(&e[1]) && !is_chord(rails, &at[e[0]], &at[e[1]]);
        if !sides(f).iter().any(near) {
            out.facets.push(touched(rails, f.map(|i| at[i]), step(samples, rails, f.map(|i| at[i]))));
            continue;
        }
        for [i, j] in sides(f).into_iter().filter(|e| !near(e) && !next[e[0]].contains(&e[1])) {
            // The edge's other triangle has it the other way round.
            if i < j {
                let h = step(samples, rails, [at[i], at[j], at[j]]);
                out.rulings.push(refined(rails, [at[i], at[j]], h));
            }
        }
    }
    Ok(out)
}

fn on(rails: &[Rail], rail: usize, parameter: f64) -> OnRail {
    OnRail { rail, parameter, point: rails[rail].point(parameter) }
}

/// Twice the parameter step of the samples.
fn step(samples: usize, rails: &[Rail], corners: [OnRail; 3]) -> f64 {
    let pieces = corners.iter().map(|c| rails[c.rail].pieces.len()).max().unwrap_or(1);
    2.0 / samples.div_ceil(pieces).max(4) as f64
}

fn is_planar(points: &[OnRail], size: f64) -> bool {
    let o = points[0].point;
    let normals = points.windows(2).map(|w| (w[0].point - o).cross(&(w[1].point - o)));
    let Some(n) = normals.max_by(|a, b| a.norm().total_cmp(&b.norm())).and_then(|n| n.try_normalize(0.0)) else {
        return true;
    };
    points.iter().all(|p| (p.point - o).dot(&n).abs() <= PLANAR * size)
}

/// Whether two neighbours are joined by a straight piece.
fn is_chord(rails: &[Rail], a: &OnRail, b: &OnRail) -> bool {
    let n = rails[a.rail].pieces.len() as f64;
    let whole = |x: f64| x == x.floor();
    let (x, y) = (a.parameter.min(b.parameter), a.parameter.max(b.parameter));
    let first = if y - x > 1.0 { y } else { x };
    whole(x) && whole(y) && first < n && rails[a.rail].is_straight(first as usize)
}

/// Unit tangents before and behind a parameter.
fn tangents(rail: &Rail, s: f64) -> [Vec3; 2] {
    let n = rail.pieces.len();
    let s = if rail.closed { s.rem_euclid(n as f64) } else { s.clamp(0.0, n as f64) };
    let k = (s.floor() as usize).min(n - 1);
    let t = s - k as f64;
    let behind = tangent(&rail.pieces[k], t);
    let before = if t == 0.0 && (k > 0 || rail.closed) { tangent(&rail.pieces[(k + n - 1) % n], 1.0) } else { behind };
    [before, behind]
}

/// Turn (rad) above which a joint, and always an open end, is a corner: rulings turn about it.
const CORNER: f64 = 1e-6;

fn is_corner(rail: &Rail, s: f64) -> bool {
    let [a, b] = tangents(rail, s);
    let end = !rail.closed && (s <= 0.0 || s >= rail.pieces.len() as f64);
    end || a.angle(&b) > CORNER
}

/// Moves the parameter within `h` until `f` of point and tangent changes its sign.
fn moved(rails: &[Rail], from: OnRail, h: f64, f: &dyn Fn(&Vec3, &Vec3) -> f64) -> OnRail {
    let rail = &rails[from.rail];
    let n = rail.pieces.len() as f64;
    let wrap = |s: f64| if rail.closed { s.rem_euclid(n) } else { s.clamp(0.0, n) };
    let value = |s: f64| f(&rail.point(wrap(s)), &tangents(rail, wrap(s))[1]);
    let (mut a, mut b) = (from.parameter - h, from.parameter + h);
    let fa = value(a);
    if fa * value(b) > 0.0 {
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
    on(rails, from.rail, wrap(0.5 * (a + b)))
}

fn refined(rails: &[Rail], ends: [OnRail; 2], h: f64) -> HullRuling {
    if ends.iter().any(|e| is_corner(&rails[e.rail], e.parameter)) {
        return HullRuling { ends, residual: 0.0 };
    }
    let (p, t) = (ends[0].point, tangents(&rails[ends[0].rail], ends[0].parameter)[1]);
    let f = |q: &Vec3, d: &Vec3| (q - p).try_normalize(0.0).map_or(0.0, |r| t.cross(d).dot(&r));
    let end = moved(rails, ends[1], h, &f);
    let residual = f(&end.point, &tangents(&rails[end.rail], end.parameter)[1]).abs();
    HullRuling { ends: [ends[0], end], residual }
}

/// A facet with one smooth corner touches the curve there.
fn touched(rails: &[Rail], corners: [OnRail; 3], h: f64) -> [OnRail; 3] {
    let smooth: Vec<usize> = (0..3).filter(|&k| !is_corner(&rails[corners[k].rail], corners[k].parameter)).collect();
    let mut out = corners;
    if let [k] = smooth[..] {
        let (p, q) = (corners[(k + 1) % 3].point, corners[(k + 2) % 3].point);
        out[k] = moved(rails, corners[k], h, &|c, d| d.cross(&(c - p)).dot(&(q - p)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;

    fn circle(r: f64, z: f64, turn: f64) -> Rail {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let arcs: Vec<Curve<4>> = (0..4)
            .map(|k| {
                let a = turn + f64::from(k) * std::f64::consts::FRAC_PI_2;
                let m = a + std::f64::consts::FRAC_PI_4;
                let e = |a: f64| [r * a.cos(), r * a.sin(), z, 1.0];
                let b = a + std::f64::consts::FRAC_PI_2;
                let control = vec![e(a), [r * m.cos(), r * m.sin(), h * z, h], e(b)];
                Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], control).expect("arc")
            })
            .collect();
        Rail::new("circle", &arcs).expect("circle")
    }

    #[test]
    fn rulings_between_two_parallel_circles_meet_at_the_apex() {
        let hull = hull(&[circle(1.0, 0.0, 0.0), circle(0.5, 1.0, 0.1)], 64).expect("hull");
        assert_eq!(hull.lids.len(), 2);
        assert!(hull.rulings.len() >= 64 && hull.facets.is_empty());
        for r in &hull.rulings {
            let [a, b] = if r.ends[0].rail == 0 { r.ends } else { [r.ends[1], r.ends[0]] };
            assert!(r.residual < 1e-14);
            assert!((a.point * 0.5 + Vec3::new(0.0, 0.0, 1.0) - b.point).norm() < 1e-13);
        }
    }

    #[test]
    fn a_circle_and_a_square_have_four_facets_that_touch_the_circle() {
        let c = 0.8;
        let corners = [[c, c], [-c, c], [-c, -c], [c, -c], [c, c]].map(|p| Vec3::new(p[0], p[1], 1.5));
        let square = Rail::polyline("square", &corners).expect("square");
        let hull = hull(&[circle(1.0, 0.0, 0.123), square], 64).expect("hull");
        assert_eq!((hull.facets.len(), hull.lids.len()), (4, 2));
        for f in &hull.facets {
            let p = f.iter().find(|p| p.rail == 0).expect("on the circle").point;
            assert!((p.x.abs().max(p.y.abs()) - 1.0).abs() < 1e-13, "{p}");
        }
    }

    #[test]
    fn curves_of_a_plane_have_no_hull() {
        assert_eq!(hull(&[circle(1.0, 0.0, 0.0)], 64), Err(HullError::Flat));
    }
}
