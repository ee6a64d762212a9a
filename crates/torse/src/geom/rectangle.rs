//! Smallest enclosing rectangles of plane point sets.

use super::Vec2;

/// A rectangle around points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rectangle {
    /// Angle (rad) from the x-axis to the long side.
    pub angle: f64,
    /// Length of the long side, mm.
    pub length: f64,
    /// Length of the short side, mm.
    pub width: f64,
    /// Corner with the smallest coordinates after turning by `−angle`, in turned coordinates.
    pub corner: Vec2,
}

/// Rectangle of least area around `points`: one of its sides lies on an edge of the convex hull, so all edges are
/// tried. `None` without points.
pub(crate) fn smallest_rectangle(points: &[Vec2]) -> Option<Rectangle> {
    let hull = convex_hull(points);
    let first = *hull.first()?;
    let mut best: Option<Rectangle> = None;
    let few = if hull.len() > MANY_CORNERS { vec![least_edge(&hull)] } else { (0..hull.len()).collect() };
    for k in few {
        let d = hull[(k + 1) % hull.len()] - hull[k];
        let n = d.norm();
        let x = if n > 0.0 { d / n } else { Vec2::x() };
        let (mut lo, mut hi) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for p in &hull {
            let q = p - first;
            let q = Vec2::new(x.dot(&q), x.perp(&q));
            (lo, hi) = (lo.inf(&q), hi.sup(&q));
        }
        let size = hi - lo;
        if best.is_none_or(|b| size.x * size.y < b.length * b.width) {
            let turn = if size.x >= size.y { x } else { Vec2::new(-x.y, x.x) };
            best = Some(Rectangle {
                angle: turn.y.atan2(turn.x),
                length: size.x.max(size.y),
                width: size.x.min(size.y),
                corner: Vec2::zeros(),
            });
        }
    }
    let mut r = best?;
    let x = Vec2::new(r.angle.cos(), r.angle.sin());
    r.corner = hull.iter().map(|p| Vec2::new(x.dot(p), x.perp(p))).fold(Vec2::repeat(f64::INFINITY), |c, p| c.inf(&p));
    Some(r)
}

/// Corners of a convex hull from which on trying every corner with every edge takes longer than anything else.
const MANY_CORNERS: usize = 512;

/// The edge of a convex polygon on which the rectangle of least area lies: the farthest corners go round with the edges
/// \[T83\].
fn least_edge(hull: &[Vec2]) -> usize {
    let n = hull.len();
    let along = |k: usize| (hull[(k + 1) % n] - hull[k]).try_normalize(0.0).unwrap_or_else(Vec2::x);
    // Farthest ahead, to the left, and behind.
    let heights: [fn(Vec2, Vec2) -> f64; 3] = [|x, p| x.dot(&p), |x, p| x.perp(&p), |x, p| -x.dot(&p)];
    let first = along(0);
    let farthest = |h: &fn(Vec2, Vec2) -> f64| {
        (0..n).max_by(|i, j| h(first, hull[*i]).total_cmp(&h(first, hull[*j]))).unwrap_or(0)
    };
    let mut at = heights.each_ref().map(farthest);
    let mut best = (f64::INFINITY, 0);
    for k in 0..n {
        let x = along(k);
        let mut most = [0.0; 3];
        for (i, h) in heights.iter().enumerate() {
            let of = |c: usize| h(x, hull[c % n] - hull[k]);
            // Once round at most.
            for _ in 0..n {
                if of(at[i] + 1) <= of(at[i]) {
                    break;
                }
                at[i] = (at[i] + 1) % n;
            }
            most[i] = of(at[i]);
        }
        let area = (most[0] + most[2]) * most[1];
        if area < best.0 {
            best = (area, k);
        }
    }
    best.1
}

/// Convex hull, counter-clockwise, by Andrew's monotone chain.
pub(crate) fn convex_hull(points: &[Vec2]) -> Vec<Vec2> {
    let mut p = points.to_vec();
    p.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    p.dedup();
    if p.len() < 3 {
        return p;
    }
    let mut hull: Vec<Vec2> = Vec::with_capacity(2 * p.len());
    for pass in 0..2 {
        let base = hull.len();
        for q in &p {
            while hull.len() >= base + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp(&(q - a)) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*q);
        }
        hull.pop();
        if pass == 0 {
            p.reverse();
        }
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_is_found_again() {
        let (a, c) = (0.4_f64, Vec2::new(7.0, -3.0));
        let (x, y) = (Vec2::new(a.cos(), a.sin()), Vec2::new(-a.sin(), a.cos()));
        let mut p = Vec::new();
        for i in 0..=10 {
            for j in 0..=4 {
                p.push(c + x * (2.0 * f64::from(i)) + y * (1.5 * f64::from(j)));
            }
        }
        let r = smallest_rectangle(&p).expect("a rectangle");
        assert!((r.length - 20.0).abs() < 1e-12 && (r.width - 6.0).abs() < 1e-12);
        assert!(((r.angle - a).sin()).abs() < 1e-12);
        assert!(convex_hull(&p).len() < 20);
        assert!(smallest_rectangle(&[]).is_none());
    }

    #[test]
    fn many_corners_give_the_rectangle_that_all_edges_would() {
        let n = 4000;
        let ellipse = |k: usize| {
            let (s, c) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
            let p = Vec2::new(30.0 * c, 10.0 * s + 2.0 * c * c);
            Vec2::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y)
        };
        let points: Vec<Vec2> = (0..n).map(ellipse).collect();
        let hull = convex_hull(&points);
        assert!(hull.len() > MANY_CORNERS);
        let area = |k: usize| {
            let x = (hull[(k + 1) % hull.len()] - hull[k]).normalize();
            let extent = |f: &dyn Fn(&Vec2) -> f64| {
                let (lo, hi) =
                    hull.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                hi - lo
            };
            extent(&|p| x.dot(p)) * extent(&|p| x.perp(p))
        };
        let least = (0..hull.len()).step_by(7).map(area).fold(f64::INFINITY, f64::min);
        let r = smallest_rectangle(&points).expect("a rectangle");
        assert!(r.length * r.width <= least * (1.0 + 1e-12), "{} {least}", r.length * r.width);
    }
}
