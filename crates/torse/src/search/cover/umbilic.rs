//! Cuts through flat points of saddle-shaped regions (mixed-curvature specification, C4b, carried on).
//!
//! Around a monkey saddle the principal directions turn once backwards: their field has the index −1/2, and no level
//! function serves all sides of the flat point. Lines of curvature of either kind run into it in three directions.
//! Between two neighbours of one kind the surface is like a half plane of the saddle `z = xy`: its bands run along both
//! of them and bend around the flat point. Halves through the flat point need about a fifth more.
//!
//! Cuts are straight in the parameters, in the directions that lines of curvature have near the flat point; farther out
//! they only come near these. Of several flat points the flattest is served; the others are found in the parts.

use super::covered_face::{Cover, SAMPLES};
use super::region::Region;
use crate::spline::surface::Surface;
use std::f64::consts::{PI, TAU};

/// Radius of the circle around a flat point on which directions are followed, as a share of the region's size.
const RADIUS: f64 = 0.08;
/// Places on that circle.
const PLACES: usize = 120;
/// Share of them that must be saddles.
const SADDLES: f64 = 0.9;

/// A flat point and the directions of three cuts that end there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Star {
    /// Parameters of the flat point.
    centre: [f64; 2],
    /// Rows: parameters to coordinates of equal lengths in the tangent plane.
    metric: [[f64; 2]; 2],
    /// Angles of the cuts there, rising.
    angles: [f64; 3],
}

impl Star {
    fn local(&self, p: [f64; 2]) -> [f64; 2] {
        let d = [p[0] - self.centre[0], p[1] - self.centre[1]];
        self.metric.map(|m| m[0] * d[0] + m[1] * d[1])
    }

    /// Cuts a region into its three sectors; labels of all parts. `None` where fewer than three are left.
    pub(super) fn cut(&self, cover: &mut Cover, label: u32) -> Option<Vec<u32>> {
        let mut parts = Vec::new();
        for k in 0..2 {
            let [a, b] = [self.angles[k], self.angles[k + 1]].map(|t| [t.cos(), t.sin()]);
            let inside = |p: [f64; 2]| {
                let q = self.local(p);
                (a[0] * q[1] - a[1] * q[0]).min(q[0] * b[1] - q[1] * b[0])
            };
            let fresh = cover.partition.fresh_label();
            cover.cut(label, fresh, inside);
            parts.extend(cover.partition.split_components(fresh));
        }
        parts.extend(cover.partition.split_components(label));
        parts.retain(|p| cover.partition.labels.contains(p));
        (parts.len() >= 3).then_some(parts)
    }
}

impl Region<'_> {
    /// The cuts of both kinds through the flattest point, if directions around it turn as around a monkey
    /// saddle.
    pub(super) fn stars(&self) -> Vec<Star> {
        let bend = |k: [f64; 2]| k[0].abs().max(k[1].abs());
        let forms = self.forms(SAMPLES);
        let bent = forms.iter().map(|f| (bend(f.principal()), f.uv)).filter(|f| f.0.is_finite());
        let Some(least) = bent.min_by(|a, b| a.0.total_cmp(&b.0)) else { return Vec::new() };
        let size = self.bbox().diagonal();
        let surface = &self.cover.face.surface;
        let centre = flattest(surface, least.1, size);
        let Some((saddle, circle)) = around(surface, centre, RADIUS * size) else { return Vec::new() };
        // A flat point at the border, as cuts leave it, is in nobody's way.
        let triangles = self.triangles();
        let inside = |p: &[f64; 2]| triangles.iter().any(|t| contains(t, p));
        if circle.iter().step_by(PLACES / 12).all(inside) {
            saddle
        } else {
            Vec::new()
        }
    }
}

fn contains([a, b, c]: &[[f64; 2]; 3], p: &[f64; 2]) -> bool {
    let side = |a: &[f64; 2], b: &[f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// Second form of the surface in given tangent directions (pairs of parameters), `[II(a, a), II(a, b), II(b, b)]`.
fn bends(surface: &Surface, uv: [f64; 2], [a, b]: [[f64; 2]; 2]) -> Option<[f64; 3]> {
    let j = surface.jet(uv[0], uv[1]);
    let n = j.normal().try_normalize(0.0)?;
    let [l, m, k] = j.second_form(&n);
    let form = |a: [f64; 2], b: [f64; 2]| l * a[0] * b[0] + m * (a[0] * b[1] + a[1] * b[0]) + k * a[1] * b[1];
    Some([form(a, a), form(a, b), form(b, b)])
}

/// Tangent directions of unit length, square to each other, in parameters.
fn frame(surface: &Surface, uv: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let j = surface.jet(uv[0], uv[1]);
    let (e, f, g) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
    let area = (e * g - f * f).sqrt();
    let a = 1.0 / e.sqrt();
    let b = [-f * a / area, e * a / area];
    (area > 0.0 && area.is_finite()).then_some([[a, 0.0], b])
}

/// The flattest point near another one: a search with shrinking steps.
fn flattest(surface: &Surface, start: [f64; 2], size: f64) -> [f64; 2] {
    // Steps, most of them halvings: what is left of the first one then is rounding.
    const STEPS: usize = 40;
    let curvature = |p: [f64; 2]| {
        let bends = frame(surface, p).and_then(|f| bends(surface, p, f));
        bends.map_or(f64::INFINITY, |[a, b, c]| a * a + 2.0 * b * b + c * c)
    };
    let Some(axes) = frame(surface, start) else { return start };
    let mut step = 0.02 * size;
    let mut best = (curvature(start), start);
    for _ in 0..STEPS {
        let before = best.0;
        for k in 0..8 {
            let (sin, cos) = (TAU * f64::from(k) / 8.0).sin_cos();
            let p = [0, 1].map(|d| best.1[d] + step * (cos * axes[0][d] + sin * axes[1][d]));
            if within(surface, p) && curvature(p) < best.0 {
                best = (curvature(p), p);
            }
        }
        if best.0 >= before {
            step *= 0.5;
        }
    }
    best.1
}

fn within(surface: &Surface, p: [f64; 2]) -> bool {
    let (du, dv) = surface.domain();
    (du.0..=du.1).contains(&p[0]) && (dv.0..=dv.1).contains(&p[1])
}

/// The cuts through a flat point, from what the second form does on a circle around it, and the parameters of that
/// circle.
fn around(surface: &Surface, centre: [f64; 2], radius: f64) -> Option<(Vec<Star>, Vec<[f64; 2]>)> {
    let axes = frame(surface, centre)?;
    let det = axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0];
    let metric = [[axes[1][1] / det, -axes[1][0] / det], [-axes[0][1] / det, axes[0][0] / det]];
    let (mut saddles, mut turned, mut before) = (0, 0.0, None::<f64>);
    // Angle, twist II(r, t) and bend II(r, r) along the ray r.
    let mut rays: Vec<[f64; 3]> = Vec::with_capacity(PLACES + 1);
    let mut circle = Vec::with_capacity(PLACES + 1);
    for k in 0..=PLACES {
        let angle = TAU * k as f64 / PLACES as f64;
        let (sin, cos) = angle.sin_cos();
        let p = [0, 1].map(|d| centre[d] + radius * (cos * axes[0][d] + sin * axes[1][d]));
        if !within(surface, p) {
            return None;
        }
        circle.push(p);
        let [a, b, c] = bends(surface, p, axes)?;
        saddles += usize::from(a * c < b * b);
        // Twice the angle of a principal direction.
        let twice = (2.0 * b).atan2(a - c);
        if let Some(before) = before {
            turned += (twice - before + PI).rem_euclid(TAU) - PI;
        }
        before = Some(twice);
        let twist = (c - a) * sin * cos + b * (cos * cos - sin * sin);
        rays.push([angle, twist, a * cos * cos + 2.0 * b * sin * cos + c * sin * sin]);
    }
    if (turned / TAU).round() as i32 != -1 || (saddles as f64) < SADDLES * PLACES as f64 {
        return None;
    }
    let mut of_kind: [Vec<f64>; 2] = Default::default();
    for w in rays.windows(2) {
        if (w[0][1] < 0.0) != (w[1][1] < 0.0) {
            let s = w[0][1] / (w[0][1] - w[1][1]);
            of_kind[usize::from(w[0][2] < 0.0)].push(w[0][0] + s * (w[1][0] - w[0][0]));
        }
    }
    let star = |angles: Vec<f64>| {
        let angles: [f64; 3] = angles.try_into().ok()?;
        // Sectors of less than a half turn.
        let gaps = [angles[1] - angles[0], angles[2] - angles[1], angles[0] + TAU - angles[2]];
        gaps.iter().all(|g| *g < PI).then_some(Star { centre, metric, angles })
    };
    Some((of_kind.into_iter().filter_map(star).collect(), circle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::Face;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;

    /// The graph over [−1, 1]² with the control heights of one bicubic span.
    fn graph(height: impl Fn(f64, f64) -> f64) -> Face {
        let knots = Knots::uniform(3, 1, -1.0, 1.0).expect("knots");
        let at = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0];
        let points: Vec<Vec3> = at.iter().flat_map(|&x| at.map(|y| Vec3::new(x, y, height(x, y)))).collect();
        Face::untrimmed(Surface::new(knots.clone(), knots, &points, None).expect("a surface"))
    }

    /// Control values of x³ and x².
    fn cube(x: f64) -> f64 {
        4.5 * x * x * x - 3.5 * x
    }
    fn square(x: f64) -> f64 {
        1.5 * x * x - 0.5
    }

    #[test]
    fn a_monkey_saddle_has_three_cuts_of_either_kind() {
        let face = graph(|x, y| 0.05 * (cube(x) - 3.0 * x * square(y)));
        let mut cover = Cover::of_face(&face, f64::INFINITY).expect("a cover");
        let found = cover.region(0).stars();
        // z = r³ cos 3θ: lines of curvature leave the middle where 3θ is a multiple of π.
        let degrees: Vec<[f64; 3]> = found.iter().map(|s| s.angles.map(f64::to_degrees)).collect();
        assert_eq!(degrees.len(), 2);
        for (angles, want) in degrees.iter().zip([[0.0, 120.0, 240.0], [60.0, 180.0, 300.0]]) {
            let off = |(a, b): (&f64, f64)| ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs();
            let fits = (0..3).any(|k| (0..3).all(|i| off((&angles[(i + k) % 3], want[i])) < 0.5));
            assert!(fits, "{angles:?}");
        }
        assert!(found[0].centre.iter().all(|x| x.abs() < 1e-6), "{:?}", found[0].centre);
        let before = cover.region(0).area();
        let parts = found[1].cut(&mut cover, 0).expect("parts");
        assert_eq!(parts.len(), 3);
        let areas: Vec<f64> = parts.iter().map(|&p| cover.region(p).area()).collect();
        assert!((areas.iter().sum::<f64>() - before).abs() < 1e-3 * before);
        assert!(areas.iter().all(|a| *a > 0.25 * before), "{areas:?}");
        // Each part has the flat point at its border.
        assert!(parts.iter().all(|&p| cover.region(p).stars().is_empty()));
    }

    #[test]
    fn other_surfaces_have_none() {
        let shapes: [&dyn Fn(f64, f64) -> f64; 4] = [
            &|x, y| x * y,
            &|x, y| square(x) + square(y),
            &|x, y| 0.1 * cube(x) + 0.1 * square(y),
            // The flat point lies beyond the border.
            &|x, y| 0.05 * (cube(x) - 3.0 * x * square(y)) + 0.8 * x * y,
        ];
        for (i, f) in shapes.into_iter().enumerate() {
            let face = graph(f);
            let cover = Cover::of_face(&face, f64::INFINITY).expect("a cover");
            assert_eq!(cover.region(0).stars(), [], "{i}");
        }
    }
}
