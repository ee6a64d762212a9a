//! Closed polygons of the plane, the last corner joined to the first: sides, areas, what is inside, what is near.

use super::segment::foot;
use super::Vec2;

/// The sides of polygons.
pub(crate) fn sides<'a, L>(loops: L) -> impl Iterator<Item = (Vec2, Vec2)> + 'a
where
    L: IntoIterator<Item = &'a Vec<Vec2>>,
    L::IntoIter: 'a,
{
    loops.into_iter().flat_map(|l| (0..l.len()).map(move |k| (l[k], l[(k + 1) % l.len()])))
}

/// Signed area of a polygon, positive counter-clockwise.
pub(crate) fn area(l: &[Vec2]) -> f64 {
    let Some(o) = l.first() else { return 0.0 };
    (0..l.len()).map(|k| 0.5 * (l[k] - o).perp(&(l[(k + 1) % l.len()] - o))).sum()
}

/// Whether a side crosses the ray from a point towards +x.
pub(super) fn crosses((p, q): &(Vec2, Vec2), x: &Vec2) -> bool {
    (p.y > x.y) != (q.y > x.y) && x.x < p.x + (q.x - p.x) * (x.y - p.y) / (q.y - p.y)
}

/// Whether a point lies inside polygons (even-odd rule). For many points see [`super::inside::Inside`].
pub(crate) fn inside(loops: &[Vec<Vec2>], x: &Vec2) -> bool {
    sides(loops).filter(|s| crosses(s, x)).count() % 2 == 1
}

/// Distance of a point from the sides of polygons; infinite where there are none. For many points see
/// [`super::outline::Outline`].
pub(crate) fn distance(loops: &[Vec<Vec2>], x: &Vec2) -> f64 {
    sides(loops).map(|(p, q)| (x - foot(&p, &q, x)).norm()).fold(f64::INFINITY, f64::min)
}

/// Corners of the box around polygons.
pub(crate) fn bounds(loops: &[Vec<Vec2>]) -> (Vec2, Vec2) {
    let start = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    loops.iter().flatten().fold(start, |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

/// Where a line crosses polygons: ways along it from `at`, rising; neighbours in pairs bound the stretches inside.
pub(crate) fn crossings(loops: &[Vec<Vec2>], at: &Vec2, way: &Vec2) -> Vec<f64> {
    let mut out: Vec<f64> = sides(loops)
        .filter_map(|(p, q)| {
            let (a, b) = (way.perp(&(p - at)), way.perp(&(q - at)));
            ((a > 0.0) != (b > 0.0)).then(|| way.dot(&(p + (q - p) * (a / (a - b)) - at)))
        })
        .collect();
    out.sort_by(f64::total_cmp);
    out
}

/// The nearest corner of polygons, if one is near (mm), else the place itself.
pub(crate) fn corner_near(loops: &[Vec<Vec2>], q: Vec2, near: f64) -> Vec2 {
    let corner = loops.iter().flatten().min_by(|a, b| (*a - q).norm().total_cmp(&(*b - q).norm()));
    corner.filter(|c| (*c - q).norm() <= near).copied().unwrap_or(q)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Corners of a closed curve at equal angles.
    pub fn ring(count: usize, at: impl Fn(f64) -> Vec2) -> Vec<Vec2> {
        (0..count).map(|k| at(std::f64::consts::TAU * k as f64 / count as f64)).collect()
    }

    #[test]
    fn a_square_with_a_hole() {
        let square = |a: f64| [(-a, -a), (a, -a), (a, a), (-a, a)].map(|(x, y)| Vec2::new(x, y)).to_vec();
        let mut loops = vec![square(5.0), square(2.0)];
        loops[1].reverse();
        assert_eq!((area(&loops[0]), area(&loops[1]), area(&[])), (100.0, -16.0, 0.0));
        assert_eq!(bounds(&loops), (Vec2::repeat(-5.0), Vec2::repeat(5.0)));
        let at = |x: f64| Vec2::new(x, 0.5);
        assert!(inside(&loops, &at(4.9)) && !inside(&loops, &at(5.1)) && !inside(&loops, &at(1.9)));
        assert_eq!((distance(&loops, &at(3.0)), distance(&loops, &at(9.0))), (1.0, 4.0));
        assert!(distance(&[], &at(0.0)).is_infinite());
        assert_eq!(crossings(&loops, &at(1.0), &-Vec2::x()), [-4.0, -1.0, 3.0, 6.0]);
        assert_eq!(crossings(&loops, &at(3.0), &Vec2::y()), [-5.5, 4.5]);
        assert_eq!(corner_near(&loops, Vec2::new(4.9, 5.0), 0.2), Vec2::repeat(5.0));
        assert_eq!(corner_near(&loops, Vec2::new(4.9, 5.0), 0.05), Vec2::new(4.9, 5.0));
    }
}
