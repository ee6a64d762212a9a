//! Discrete torses: strips of quadrilaterals whose successive rulings are coplanar (figure 1.4 of \[W15\]).
//!
//! A strip of plane quadrilaterals is developable exactly, by turning face after face about the edges between them. Its
//! regression polyline is formed by the intersections of successive rulings. Whether the quadrilaterals are plane is a
//! question to be asked ([`QuadStrip::warp`]), not a promise of the type.

use super::form::PanelKind;
use super::strip::Strip;
use crate::geom::{BBox, Vec2, Vec3};
use crate::spline::SplineError;

/// A strip between two polylines; the rulings join points of equal index, the quadrilateral `i` has the corners
/// `a[i]`, `a[i + 1]`, `b[i + 1]`, `b[i]`.
///
/// # Example
/// ```
/// use torse::{geom::Vec3, torse::quad_strip::QuadStrip};
/// let side = |y: f64| [0.0, 30.0, 60.0].map(|x| Vec3::new(x, y, 0.1 * x)).to_vec();
/// let strip = QuadStrip::new(side(0.0), side(100.0))?;
/// let [a, _] = strip.development();
/// assert!(strip.largest_warp() < 1e-12);
/// assert!(((a[1] - a[0]).norm() - (strip.a()[1] - strip.a()[0]).norm()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct QuadStrip {
    a: Vec<Vec3>,
    b: Vec<Vec3>,
}

/// Points that make no strip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuadStripError {
    /// Different numbers of points.
    #[error(
        "the first polyline has {a} points and the second {b}; a strip of quadrilaterals needs as many on both sides"
    )]
    Counts {
        /// On the first polyline.
        a: usize,
        /// On the second polyline.
        b: usize,
    },
    /// Less than one quadrilateral.
    #[error("a strip needs at least two rulings, there are {0}")]
    TooFew(usize),
    /// A coordinate that is not a number.
    #[error("ruling {0} (counted from 1) has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// Two ends of a ruling fall together.
    #[error("ruling {0} (counted from 1) has no length: its two points coincide; end the strip before it, or move one of them")]
    NoLength(usize),
    /// Two successive rulings fall together.
    #[error("rulings {0} and {1} (counted from 1) coincide; leave one of them out")]
    Repeated(usize, usize),
}

/// Points nearer to each other than this share of the size of the strip coincide: twice the rounding of its largest
/// coordinates leaves no direction between them.
const COINCIDE: f64 = 1e-12;
/// Successive rulings that make an angle with a smaller sine than this meet nowhere: their intersection would be lost
/// in rounding.
const PARALLEL: f64 = 1e-12;

impl QuadStrip {
    /// The strip between two polylines (mm).
    ///
    /// # Errors
    /// Different numbers of points, fewer than two, coordinates that are not finite, rulings without length, successive
    /// rulings that coincide. One of the two polylines may stand still.
    pub fn new(a: Vec<Vec3>, b: Vec<Vec3>) -> Result<Self, QuadStripError> {
        if a.len() != b.len() {
            return Err(QuadStripError::Counts { a: a.len(), b: b.len() });
        }
        if a.len() < 2 {
            return Err(QuadStripError::TooFew(a.len()));
        }
        if let Some(i) = a.iter().zip(&b).position(|(p, q)| p.iter().chain(q.iter()).any(|x| !x.is_finite())) {
            return Err(QuadStripError::NotFinite(i + 1));
        }
        let strip = Self { a, b };
        let least = COINCIDE * strip.size();
        for i in 0..strip.rulings() {
            let [p, q] = strip.ruling(i);
            if (q - p).norm() <= least {
                return Err(QuadStripError::NoLength(i + 1));
            }
            if i > 0 {
                let [r, s] = strip.ruling(i - 1);
                if (p - r).norm() <= least && (q - s).norm() <= least {
                    return Err(QuadStripError::Repeated(i, i + 1));
                }
            }
        }
        Ok(strip)
    }

    /// First polyline.
    pub fn a(&self) -> &[Vec3] {
        &self.a
    }

    /// Second polyline.
    pub fn b(&self) -> &[Vec3] {
        &self.b
    }

    /// Number of rulings.
    pub fn rulings(&self) -> usize {
        self.a.len()
    }

    /// Number of quadrilaterals.
    pub fn quads(&self) -> usize {
        self.a.len() - 1
    }

    /// Ends of ruling `i`.
    pub fn ruling(&self, i: usize) -> [Vec3; 2] {
        [self.a[i], self.b[i]]
    }

    /// Diagonal of the box around all points, mm.
    pub fn size(&self) -> f64 {
        BBox::of(self.a.iter().chain(&self.b)).diagonal()
    }

    /// Distance of the diagonals of quadrilateral `i` by their mean length: 0 if it is plane.
    pub fn warp(&self, i: usize) -> f64 {
        let (d, e) = self.diagonals(i);
        let mean = 0.5 * (d.norm() + e.norm());
        if mean == 0.0 {
            return 0.0;
        }
        self.gap(i).abs() / mean
    }

    /// Largest [`QuadStrip::warp`].
    pub fn largest_warp(&self) -> f64 {
        (0..self.quads()).map(|i| self.warp(i)).fold(0.0, f64::max)
    }

    /// Distance of the lines through the diagonals of quadrilateral `i`, mm, with a sign.
    pub fn gap(&self, i: usize) -> f64 {
        let (d, e) = self.diagonals(i);
        let n = d.cross(&e);
        match n.try_normalize(0.0) {
            Some(n) => (self.a[i + 1] - self.a[i]).dot(&n),
            None => 0.0,
        }
    }

    /// Distance of the lines of rulings `i` and `i + 1`, mm: 0 for a discrete torse. Where they are parallel up to
    /// rounding, 0: they are coplanar.
    pub fn ruling_distance(&self, i: usize) -> f64 {
        let (r, s) = (self.b[i] - self.a[i], self.b[i + 1] - self.a[i + 1]);
        let n = r.cross(&s);
        if n.norm() <= PARALLEL * r.norm() * s.norm() {
            return 0.0;
        }
        ((self.a[i + 1] - self.a[i]).dot(&n) / n.norm()).abs()
    }

    fn diagonals(&self, i: usize) -> (Vec3, Vec3) {
        (self.b[i + 1] - self.a[i], self.b[i] - self.a[i + 1])
    }

    /// Plane of quadrilateral `i`: unit normal and offset of `n·X = h`, through the mean of the corners and along
    /// both diagonals. `None` for a quadrilateral whose diagonals are parallel.
    pub fn plane(&self, i: usize) -> Option<(Vec3, f64)> {
        let (d, e) = self.diagonals(i);
        let n = d.cross(&e);
        if n.norm() <= PARALLEL * d.norm() * e.norm() {
            return None;
        }
        let n = n.normalize();
        let mean = (self.a[i] + self.a[i + 1] + self.b[i] + self.b[i + 1]) * 0.25;
        Some((n, n.dot(&mean)))
    }

    /// Where the lines of rulings `i` and `i + 1` meet, as shares of both (0 on `a`, 1 on `b`): the points nearest to
    /// the other line. `None` for parallel rulings.
    pub fn regression_shares(&self, i: usize) -> Option<[f64; 2]> {
        let (r, s) = (self.b[i] - self.a[i], self.b[i + 1] - self.a[i + 1]);
        let n = r.cross(&s);
        let nn = n.norm_squared();
        if nn.sqrt() <= PARALLEL * r.norm() * s.norm() {
            return None;
        }
        let d = self.a[i + 1] - self.a[i];
        Some([d.cross(&s).dot(&n) / nn, d.cross(&r).dot(&n) / nn])
    }

    /// Regression point of quadrilateral `i`, mm: the middle between the nearest points of its two rulings. `None` for
    /// parallel rulings.
    pub fn regression_point(&self, i: usize) -> Option<Vec3> {
        let [s, t] = self.regression_shares(i)?;
        let at = |i: usize, s: f64| self.a[i] + (self.b[i] - self.a[i]) * s;
        Some((at(i, s) + at(i + 1, t)) * 0.5)
    }

    /// Regression points of all quadrilaterals; the edge between the points `i − 1` and `i` lies on ruling `i` if the
    /// strip is plane.
    pub fn regression_polyline(&self) -> Vec<Option<Vec3>> {
        (0..self.quads()).map(|i| self.regression_point(i)).collect()
    }

    /// The first quadrilateral whose rulings cross between the polylines, so that its regression point lies on the
    /// strip; a quadrilateral that shrinks to a triangle does not count.
    pub fn crossing(&self) -> Option<usize> {
        let inside = |s: f64| s > PARALLEL && s < 1.0 - PARALLEL;
        (0..self.quads()).find(|&i| self.regression_shares(i).is_some_and(|[s, t]| inside(s) && inside(t)))
    }

    /// Distance along the rulings from the strip to the regression point of quadrilateral `i`, mm; infinite for
    /// parallel rulings, 0 where the point lies on the strip.
    pub fn regression_clearance(&self, i: usize) -> f64 {
        let Some(shares) = self.regression_shares(i) else { return f64::INFINITY };
        let beyond = |k: usize, s: f64| (-s).max(s - 1.0).max(0.0) * (self.b[k] - self.a[k]).norm();
        beyond(i, shares[0]).min(beyond(i + 1, shares[1]))
    }

    /// Angle between the planes left and right of ruling `i`, `0 < i < quads`, rad, positive where the strip bends to
    /// the side of the normals. 0 at the ends and beside quadrilaterals without a plane.
    pub fn bend(&self, i: usize) -> f64 {
        if i == 0 || i >= self.quads() {
            return 0.0;
        }
        let (Some((m, _)), Some((n, _))) = (self.plane(i - 1), self.plane(i)) else { return 0.0 };
        let axis = self.b[i] - self.a[i];
        let axis = axis.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        m.cross(&n).dot(&axis).atan2(m.dot(&n))
    }

    /// Largest jump between bends of successive rulings by the mean of their sizes: tends to 0 under refinement if the
    /// curvature of the limit is continuous. 0 for fewer than two inner rulings and for plane strips.
    pub fn bend_jump(&self) -> f64 {
        let bends: Vec<f64> = (1..self.quads()).map(|i| self.bend(i)).collect();
        let mean = bends.iter().map(|b| b.abs()).sum::<f64>() / bends.len().max(1) as f64;
        if mean == 0.0 {
            return 0.0;
        }
        bends.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max) / mean
    }

    /// The strip laid flat: both polylines in the plane, mm, the first ruling on the y-axis from the origin on.
    ///
    /// *Guarantee.* Up to rounding, rulings and edges of the polylines keep their lengths in plane quadrilaterals; in
    /// warped ones, the edges and one diagonal do. Nothing is said about overlaps.
    pub fn development(&self) -> [Vec<Vec2>; 2] {
        let n = self.rulings();
        let (mut a, mut b) = (Vec::with_capacity(n), Vec::with_capacity(n));
        a.push(Vec2::zeros());
        b.push(Vec2::new(0.0, (self.b[0] - self.a[0]).norm()));
        for i in 0..self.quads() {
            // Coordinates along the ruling and across it, forward being to the right of the ruling from a to b.
            let place = |from: Vec3, to: Vec3, p: Vec3, f: Vec2, t: Vec2| -> Vec2 {
                let along = (to - from).normalize();
                let d = p - from;
                let s = d.dot(&along);
                let across = (d - along * s).norm();
                let flat = (t - f).normalize();
                f + flat * s + Vec2::new(flat.y, -flat.x) * across
            };
            let next = place(self.a[i], self.b[i], self.b[i + 1], a[i], b[i]);
            // The second triangle stands on the diagonal. A ruling that has met the other side leaves none.
            let behind = if next == a[i] { a[i] } else { place(self.a[i], self.b[i + 1], self.a[i + 1], a[i], next) };
            a.push(behind);
            b.push(next);
        }
        [a, b]
    }

    /// The quadrilaterals as bilinear strips with the names `{name}-001`, …; plane if the strip is.
    ///
    /// # Errors
    /// None for a strip made by [`QuadStrip::new`].
    pub fn faces(&self, name: &str) -> Result<Vec<Strip>, SplineError> {
        (0..self.quads())
            .map(|i| Strip::quad(&format!("{name}-{:03}", i + 1), PanelKind::Plane, self.ruling(i), self.ruling(i + 1)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::strip::Strip;

    /// Chords of the cone z = h (1 − r), between radii 1 and 0.5.
    fn cone(quads: usize) -> QuadStrip {
        let at = |k: usize, r: f64| {
            let (s, c) = (0.1 * k as f64).sin_cos();
            Vec3::new(r * c, r * s, 2.0 * (1.0 - r))
        };
        let side = |r: f64| (0..=quads).map(|k| at(k, r)).collect();
        QuadStrip::new(side(1.0), side(0.5)).expect("a strip")
    }

    #[test]
    fn rulings_of_a_discrete_cone_meet_in_its_apex() {
        let s = cone(6);
        assert!(s.largest_warp() < 1e-15 && s.crossing().is_none());
        for i in 0..6 {
            assert!((s.regression_point(i).expect("a point") - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-13);
            assert!(s.ruling_distance(i) < 1e-15);
            assert!((s.regression_clearance(i) - 1.25f64.sqrt()).abs() < 1e-13);
            let (n, h) = s.plane(i).expect("a plane");
            assert!(s.a().iter().skip(i).take(2).all(|p| (n.dot(p) - h).abs() < 1e-15));
        }
        // All bends of a rotational cone are equal.
        assert!(s.bend(1).abs() > 0.04 && s.bend_jump() < 1e-12);
        assert_eq!(s.bend(0), 0.0);
    }

    #[test]
    fn edges_of_the_regression_polyline_lie_on_the_rulings() {
        // Rulings of a discrete tangent surface: edges of a polygon, cut at two distances.
        let c = |k: usize| {
            let t = 0.2 * k as f64;
            Vec3::new(t.cos(), t.sin(), 0.4 * t)
        };
        let along = |k: usize, d: f64| c(k) + (c(k + 1) - c(k)).normalize() * d;
        let side = |d: f64| (0..8).map(|k| along(k, d)).collect();
        let s = QuadStrip::new(side(1.0), side(2.0)).expect("a strip");
        assert!(s.largest_warp() < 1e-15);
        for (i, p) in s.regression_polyline().into_iter().enumerate() {
            assert!((p.expect("a point") - c(i + 1)).norm() < 1e-12);
        }
    }

    #[test]
    fn the_development_keeps_all_lengths() {
        let s = cone(9);
        let [a, b] = s.development();
        for i in 0..s.quads() {
            let pairs = [
                ((a[i + 1] - a[i]).norm(), (s.a()[i + 1] - s.a()[i]).norm()),
                ((b[i + 1] - b[i]).norm(), (s.b()[i + 1] - s.b()[i]).norm()),
                ((b[i + 1] - a[i + 1]).norm(), (s.b()[i + 1] - s.a()[i + 1]).norm()),
                ((b[i + 1] - a[i]).norm(), (s.b()[i + 1] - s.a()[i]).norm()),
                ((b[i] - a[i + 1]).norm(), (s.b()[i] - s.a()[i + 1]).norm()),
            ];
            for (flat, space) in pairs {
                assert!((flat - space).abs() < 1e-14);
            }
        }
        // Flat rulings of a cone meet as well.
        let apex = b[0] + (b[0] - a[0]);
        assert!((b[9] + (b[9] - a[9]) - apex).norm() < 1e-13);
    }

    #[test]
    fn faces_are_plane_strips_that_share_rulings() {
        let s = cone(4);
        let faces: Vec<Strip> = s.faces("c").expect("faces");
        assert_eq!((faces.len(), faces[3].name.as_str()), (4, "c-004"));
        assert!(faces.iter().all(|f| f.twist(0.5) < 1e-14));
        assert_eq!(faces[0].ruling(1.0), faces[1].ruling(0.0));
    }

    #[test]
    fn warp_is_the_distance_of_the_diagonals() {
        let h = 0.3;
        let s = QuadStrip::new(
            vec![Vec3::new(0.0, 0.0, h), Vec3::new(1.0, 0.0, -h)],
            vec![Vec3::new(0.0, 1.0, -h), Vec3::new(1.0, 1.0, h)],
        )
        .expect("a strip");
        assert!((s.gap(0).abs() - 2.0 * h).abs() < 1e-15);
        assert!((s.warp(0) - 2.0 * h / 2f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn bad_points_are_refused_by_name() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let error = |a: Vec<Vec3>, b: Vec<Vec3>| QuadStrip::new(a, b).expect_err("refused");
        assert_eq!(error(vec![p(0., 0.)], vec![]), QuadStripError::Counts { a: 1, b: 0 });
        assert_eq!(error(vec![p(0., 0.)], vec![p(0., 1.)]), QuadStripError::TooFew(1));
        assert_eq!(error(vec![], vec![]), QuadStripError::TooFew(0));
        let b = vec![p(0., 1.), p(1., 1.), p(2., 1.)];
        assert_eq!(error(vec![p(0., 0.), p(f64::NAN, 0.), p(2., 0.)], b.clone()), QuadStripError::NotFinite(2));
        assert_eq!(error(vec![p(0., 0.), p(1., 0.), p(2., 1.)], b.clone()), QuadStripError::NoLength(3));
        let twice = vec![p(0., 1.), p(0., 1.), p(2., 1.)];
        assert_eq!(error(vec![p(0., 0.), p(0., 0.), p(2., 0.)], twice), QuadStripError::Repeated(1, 2));
        // A fan is no error; a crossing is seen.
        let fan = QuadStrip::new(vec![p(0., 0.); 3], b.clone()).expect("a fan");
        assert!(fan.crossing().is_none() && fan.regression_clearance(0) == 0.0);
        let crossed = QuadStrip::new(vec![p(1., 0.), p(0., 0.)], vec![p(0., 1.), p(1., 1.)]).expect("a strip");
        assert_eq!(crossed.crossing(), Some(0));
    }
}
