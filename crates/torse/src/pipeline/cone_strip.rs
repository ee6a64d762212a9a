//! The strip that a cone spline is fitted to: the rulings of a region, as long as the region needs.
//!
//! The rectangle between the least and greatest parameters of a slanting region can contain the regression curve
//! though the region does not. The ends of the rulings then follow the outline: v is a polynomial of u at either side,
//! so that the strip stays smooth and remains one chain \[LP98\].

use super::cone_outline::PlaneOutline;
use crate::num::linear_program::LinearProgram;
use crate::spline::bezier::Bezier;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::surface::ruled_strip::{RuledPatch, RuledStrip};

/// Rulings at which a strip is tested for the regression curve.
const TESTED: usize = 257;
/// Space between the outline and the ends of the rulings, as shares of the height of the region in v: a wide one first,
/// because rulings need some length where the region has a corner.
const MARGINS: [f64; 3] = [0.05, 0.02, 0.005];
/// Greatest degree of the ends in u.
const MOST_DEGREE: usize = 5;
/// Places on a chord of the outline at which the ends are kept outside.
const CHORD: usize = 4;

/// The strip of the region within an outline: between its least and greatest v if the regression curve stays outside,
/// else between polynomials of u near the outline. `None` if the outline leaves the patch.
pub fn strip_of(outline: &PlaneOutline) -> Option<RuledPatch> {
    let whole = between(&outline.surface, outline.bounds())?;
    if outline.is_rectangle() || clear(&whole) {
        return Some(whole);
    }
    // The lowest degree is the smoothest; what no degree achieves is refused by the fit, which names the ruling.
    let followed = MARGINS
        .iter()
        .find_map(|margin| (1..=MOST_DEGREE).find_map(|degree| following(outline, degree, *margin).filter(clear)));
    Some(followed.unwrap_or(whole))
}

/// The strip of a patch of degree 1 in v between parameters.
fn between(surface: &Surface, [u0, u1, v0, v1]: [f64; 4]) -> Option<RuledPatch> {
    let ((a, b), (c, d)) = surface.domain();
    let strip = RuledPatch::new(surface, v0.max(c), v1.min(d))?;
    let (u0, u1) = (u0.max(a), u1.min(b));
    if u0 <= a && u1 >= b {
        return Some(strip);
    }
    strip.restricted(u0, u1)
}

/// Whether all rulings tested run forward at both ends.
fn clear(strip: &RuledPatch) -> bool {
    let (a, b) = strip.domain();
    (0..TESTED).all(|k| {
        let jet = strip.jet(a + (b - a) * k as f64 / (TESTED - 1) as f64);
        jet.element().is_ok_and(|g| jet.speeds(&g).iter().all(|s| *s > 0.0))
    })
}

/// The strip whose ends are polynomials of u just outside the outline.
fn following(outline: &PlaneOutline, degree: usize, margin: f64) -> Option<RuledPatch> {
    let ((a, b), (c, d)) = outline.surface.domain();
    let [u0, u1, v0, v1] = outline.bounds();
    let (u0, u1) = (u0.max(a), u1.min(b));
    let height = v1 - v0;
    if !(u1 > u0 && height > 0.0) {
        return None;
    }
    // Heights are counted from below, from 0 to 1, so that tolerances of the program are shares of the region.
    let mut places = Vec::new();
    for l in &outline.loops {
        for (i, (p, _)) in l.iter().enumerate() {
            let q = l[(i + 1) % l.len()].0;
            places.extend((0..CHORD).map(|k| {
                let s = k as f64 / CHORD as f64;
                let [u, v] = [0, 1].map(|k| p[k] + (q[k] - p[k]) * s);
                [((u - u0) / (u1 - u0)).clamp(0.0, 1.0), (v - v0) / height]
            }));
        }
    }
    let floor = below(&places, degree, margin)?;
    let turned: Vec<[f64; 2]> = places.iter().map(|[x, y]| [*x, 1.0 - y]).collect();
    let ceiling: Vec<f64> = below(&turned, degree, margin)?.iter().map(|y| 1.0 - y).collect();
    // The patch is linear in v: its rulings go on beyond the domain.
    let sides = [c, d].map(|v| outline.surface.curve_at_v(v).restricted(u0, u1));
    let [Ok(lower), Ok(upper)] = sides else { return None };
    let end = |heights: &[f64]| {
        let shares = Bezier::new(heights.iter().map(|y| [(v0 + y * height - c) / (d - c)]).collect());
        blended(&lower, &upper, &shares)
    };
    RuledPatch::between(end(&floor)?, end(&ceiling)?)
}

/// Bernstein coefficients on `[0, 1]` of the polynomial with the greatest integral that lies by a margin below places
/// `[x, y]`.
fn below(places: &[[f64; 2]], degree: usize, margin: f64) -> Option<Vec<f64>> {
    let mut program = LinearProgram::new(degree + 1);
    program.cost = vec![-1.0; degree + 1];
    for [x, y] in places {
        let basis = (0..=degree).map(|j| {
            let mut unit = vec![[0.0]; degree + 1];
            unit[j] = [1.0];
            (j, Bezier::new(unit).point(*x)[0])
        });
        program.at_most(basis, y - margin);
    }
    program.solve().filter(|x| x.iter().all(|y| y.is_finite()))
}

/// The curve `(1 - s(u)) lower(u) + s(u) upper(u)` in homogeneous coordinates; `s` is given over the whole domain.
fn blended(lower: &Curve<4>, upper: &Curve<4>, s: &Bezier<1>) -> Option<Curve<4>> {
    let (a, b) = lower.domain();
    let across = |u: f64| (u - a) / (b - a);
    let degree = lower.knots.degree() + s.degree();
    let (mut values, mut control) = (vec![a], Vec::new());
    for ((from, to, low), (_, _, high)) in bezier_pieces(lower).into_iter().zip(bezier_pieces(upper)) {
        let (low, high) = (Bezier::new(low), Bezier::new(high));
        let share = s.restricted(across(from), across(to));
        let piece = low.elevated(s.degree()).plus(&high.minus(&low).times(&share));
        // Pieces share their ends.
        control.extend(piece.control().iter().skip(usize::from(!control.is_empty())));
        if values.len() == 1 {
            values.extend(vec![a; degree]);
        }
        values.extend(vec![to; degree]);
    }
    values.push(b);
    let knots = Knots::new(degree, values, control.len()).ok()?;
    Some(Curve { knots, control })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Control;
    use crate::geom::Vec3;
    use crate::pipeline::cones::{of_faces, ConesOptions};
    use crate::pipeline::outcome::Status;
    use crate::surface::face::{Face, TrimLoop};

    /// The tangent surface of `100 (u, u², u³)`, u from 0.2 to 1, whose rulings are reckoned so that the regression
    /// curve is the line v = 0.6 - 0.5 u.
    fn tangent_surface() -> Surface {
        // Cubics are determined by their blossoms: products of linear blossoms, averaged.
        let points: Vec<Vec3> = (0..4)
            .flat_map(|i| {
                let args: [f64; 3] = std::array::from_fn(|k| if k < i { 1.0 } else { 0.2 });
                let [x, y, z] = args;
                let e1 = (x + y + z) / 3.0;
                let e2 = (x * y + y * z + z * x) / 3.0;
                let e3 = x * y * z;
                // r(u) c'(u) with r = v + 0.5 u - 0.6.
                let along = |v: f64| {
                    let k = v - 0.6;
                    Vec3::new(k + 0.5 * e1, 2.0 * (k * e1 + 0.5 * e2), 3.0 * (k * e2 + 0.5 * e3))
                };
                [0.0, 1.0].map(|v| (Vec3::new(e1, e2, e3) + along(v)) * 100.0)
            })
            .collect();
        let knots = |p, a: f64| Knots::clamped(p, &[a, 1.0]).expect("knots");
        Surface::new(knots(3, 0.2), knots(1, 0.0), &points, None).expect("surface")
    }

    fn slanting() -> Face {
        let mut face = Face::untrimmed(tangent_surface());
        let corners = [[0.2, 0.6], [1.0, 0.2], [1.0, 0.45], [0.2, 0.85]];
        let mut points = Vec::new();
        let mut edge = Vec::new();
        for i in 0..4 {
            let (a, b): ([f64; 2], [f64; 2]) = (corners[i], corners[(i + 1) % 4]);
            for k in 0..40 {
                let s = f64::from(k) / 40.0;
                points.push([0, 1].map(|d| a[d] + (b[d] - a[d]) * s));
                edge.push(i as u32);
            }
        }
        face.loops = vec![TrimLoop { points, edge }];
        face
    }

    #[test]
    fn strips_follow_outlines_whose_rectangle_meets_the_regression_curve() {
        let face = slanting();
        let outline = PlaneOutline::of_face(&face, face.surface.clone(), false);
        let whole = between(&outline.surface, outline.bounds()).expect("strip");
        assert!(!clear(&whole), "the rectangle meets the regression curve");
        let strip = strip_of(&outline).expect("strip");
        assert!(clear(&strip));
        // Same rulings, and longer than the outline needs by the margin.
        for k in 0..=20 {
            let u = 0.2 + 0.04 * f64::from(k);
            let ends = strip.jet(u).ends.map(|e| e[0]);
            for (end, v) in ends.iter().zip([0.7 - 0.5 * u - 0.05 * 0.65, 0.95 - 0.5 * u + 0.05 * 0.65]) {
                assert!((end - face.surface.point(u, v)).norm() < 1e-3, "u = {u}");
            }
        }
    }

    #[test]
    fn slanting_parts_beside_the_regression_curve_are_certified_and_trimmed() {
        let options = ConesOptions { tolerance: 0.2, input: "test".into() };
        let out = of_faces(&[slanting()], &[], &options, &Control::default()).expect("outcome");
        assert_eq!(out.sheets.status, Status::Certified);
        let part = out.bodies[0].part.as_ref().expect("trimmed");
        assert!(part.faces.len() > 1 && part.outline_estimate < 0.01, "{}", part.outline_estimate);
        // The area of the part is that of the region: |c' x (c' + ...)| by the midpoint rule.
        let area: f64 = out.sheets.patterns.iter().map(|p| p.area).sum();
        let n = 200;
        let mut expected = 0.0;
        for i in 0..n {
            let u = 0.2 + 0.8 * (f64::from(i) + 0.5) / f64::from(n);
            for j in 0..20 {
                let v = 0.7 - 0.5 * u + 0.25 * (f64::from(j) + 0.5) / 20.0;
                let h = 1e-5;
                let s = |u, v| face_point(u, v);
                let (du, dv) = (s(u + h, v) - s(u - h, v), s(u, v + h) - s(u, v - h));
                expected += du.cross(&dv).norm() / (4.0 * h * h) * (0.8 / f64::from(n)) * (0.25 / 20.0);
            }
        }
        assert!((area - expected).abs() < 5e-3 * expected, "{area} {expected}");
    }

    /// The tangent surface by its formula.
    fn face_point(u: f64, v: f64) -> Vec3 {
        let r = v + 0.5 * u - 0.6;
        Vec3::new(u + r, u * u + 2.0 * r * u, u * u * u + 3.0 * r * u * u) * 100.0
    }
}
