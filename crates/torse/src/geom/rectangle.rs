//! Smallest enclosing rectangles of plane point sets.

use super::Vec2;

/// A rectangle around points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
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
pub fn smallest_rectangle(points: &[Vec2]) -> Option<Rectangle> {
    let hull = convex_hull(points);
    let first = *hull.first()?;
    let mut best: Option<Rectangle> = None;
    for k in 0..hull.len() {
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

/// Convex hull, counter-clockwise, by Andrew's monotone chain.
pub fn convex_hull(points: &[Vec2]) -> Vec<Vec2> {
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
}
