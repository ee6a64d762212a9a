//! The strip that a cone spline is fitted to: the rulings of a region, as long as the region needs.
//!
//! The rectangle between the least and greatest parameters of a slanting region can contain the regression curve
//! though the region does not. The ends of the rulings then follow the outline: v is a polynomial of u at either side,
//! so that the strip stays smooth and remains one chain \[LP98\].

use super::cone_outline::{PlaneOutline, NOTHING};
use crate::brep::face::Face;
use crate::geom::Vec3;
use crate::num::linear_program::LinearProgram;
use crate::reason::{FaceReason, Reason};
use crate::spline::bezier::Bezier;
use crate::spline::surface::Surface;
use crate::torse::ruled_patch::{RuledPatch, RuledStrip};

/// Rulings at which a face is tested for developability.
const TWIST_TESTED: usize = 33;
/// Sine of the turn of its normals up to which a strip is plane.
const PLANE: f64 = 1e-9;
/// Largest deviation of a ruled face from a developable one that still counts as none, as a share of the tolerance:
/// the sine of the twist times the length of the ruling. It only decides what is tried: the proof takes the face as it
/// is, with its twist, at every ruling.
const TWISTED: f64 = 0.05;

/// Rulings at which a strip is tested for the regression curve.
const TESTED: usize = 257;
/// Space between the outline and the ends of the rulings, as shares of the height of the region in v: a wide one first,
/// because rulings need some length where the region has a corner.
const MARGINS: [f64; 3] = [0.05, 0.02, 0.005];
/// Room beyond a ruling that an outline only touches, as a share of its extent across the rulings.
const END_ROOM: f64 = 0.01;
/// Greatest degree of the ends in u.
const MOST_DEGREE: usize = 5;
/// Places on a chord of the outline at which the ends are kept outside.
const CHORD: usize = 4;

/// The strip of the region within an outline: between its least and greatest v if the regression curve stays outside,
/// else between polynomials of u near the outline. `None` if the outline leaves the patch.
pub(crate) fn strip_of(outline: &PlaneOutline) -> Option<RuledPatch> {
    let whole = between(&outline.surface, with_ends(outline))?;
    if outline.is_rectangle() || clear(&whole) {
        return Some(whole);
    }
    // The lowest degree is the smoothest; what no degree achieves is refused by the fit, which names the ruling.
    let followed = MARGINS
        .iter()
        .find_map(|margin| (1..=MOST_DEGREE).find_map(|degree| following(outline, degree, *margin).filter(clear)));
    Some(followed.unwrap_or(whole))
}

/// Least and greatest parameters of an outline, wider where it only touches a ruling at its end, as a disc does: edges that
/// are fitted to it may pass that ruling by a little.
fn with_ends(outline: &PlaneOutline) -> [f64; 4] {
    let [u0, u1, v0, v1] = outline.bounds();
    let room = END_ROOM * (u1 - u0);
    let along = |u: f64| {
        let on = |p: &[f64; 2]| (p[0] - u).abs() <= NOTHING * (u1 - u0);
        outline.loops.iter().any(|l| (0..l.len()).any(|i| on(&l[i].0) && on(&l[(i + 1) % l.len()].0)))
    };
    let open = |u: f64| if along(u) { 0.0 } else { room };
    [u0 - open(u0), u1 + open(u1), v0, v1]
}

/// The strip of a patch of degree 1 in v between parameters.
fn between(surface: &Surface, [u0, u1, v0, v1]: [f64; 4]) -> Option<RuledPatch> {
    let ((a, b), (c, d)) = surface.domain();
    RuledPatch::of_region(surface, (u0.max(a), u1.min(b)), [vec![v0.max(c)], vec![v1.min(d)]])
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
    let ((a, b), _) = outline.surface.domain();
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
    let place = |heights: Vec<f64>| heights.iter().map(|y| v0 + y * height).collect();
    RuledPatch::of_region(&outline.surface, (u0, u1), [place(floor), place(ceiling)])
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

/// The strip of a ruled developable face.
pub(crate) fn ruled(face: &Face, tolerance: f64) -> Result<(RuledPatch, PlaneOutline), FaceReason> {
    let candidates = [Some(face.surface.clone()), Some(face.surface.transposed())];
    let mut reason = FaceReason::NotRuled;
    for (k, surface) in candidates.into_iter().flatten().enumerate() {
        let Some(outline) = PlaneOutline::of_face(face, surface, k == 1) else { continue };
        let Some(strip) = strip_of(&outline) else { continue };
        match faulty(&strip, tolerance) {
            None => return Ok((strip, outline)),
            Some(fault) => reason = bent_tip(&strip, &outline).unwrap_or(fault),
        }
    }
    Err(reason)
}

/// Why a strip that bends cannot be made of cones up to the end of its outline: all rulings meet there. Plane faces may end
/// in a corner.
pub(crate) fn bent_tip(strip: &RuledPatch, outline: &PlaneOutline) -> Option<FaceReason> {
    let p = outline.tip()?;
    let (a, b) = strip.domain();
    let at = |k: usize| a + (b - a) * k as f64 / (TWIST_TESTED - 1) as f64;
    let normals: Vec<Vec3> =
        (0..TWIST_TESTED).filter_map(|k| strip.jet(at(k)).element().ok()).map(|e| e.normal).collect();
    let bends = |n: &Vec3| n.cross(&normals[0]).norm() > PLANE;
    normals.iter().any(bends).then_some(FaceReason::Tip(p))
}

/// What keeps a ruled strip from being developable.
fn faulty(strip: &RuledPatch, tolerance: f64) -> Option<FaceReason> {
    let (a, b) = strip.domain();
    for k in 0..TWIST_TESTED {
        let u = a + (b - a) * k as f64 / (TWIST_TESTED - 1) as f64;
        let jet = strip.jet(u);
        let element = match jet.element() {
            Ok(e) => e,
            Err(e) => return Some(FaceReason::Unusable { u, error: Box::new(Reason::error(&e)) }),
        };
        let off = jet.twist(&element) * jet.length();
        if off > TWISTED * tolerance || off.is_nan() {
            return Some(FaceReason::Twisted { u, off });
        }
    }
    None
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::brep::face::{Face, TrimLoop};
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;

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

    /// The part of that surface between two slanting lines.
    pub(crate) fn slanting() -> Face {
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
        let outline = PlaneOutline::of_face(&face, face.surface.clone(), false).expect("outline");
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

    /// The tangent surface by its formula.
    pub(crate) fn face_point(u: f64, v: f64) -> Vec3 {
        let r = v + 0.5 * u - 0.6;
        Vec3::new(u + r, u * u + 2.0 * r * u, u * u * u + 3.0 * r * u * u) * 100.0
    }
}
