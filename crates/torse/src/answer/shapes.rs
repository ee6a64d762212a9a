//! What the strips of a job consist of: planes, cylinders, cones and tangent surfaces along every part.

use super::Answer;
use crate::fit::elements::decompose::{decompose, DecomposeOptions};
use crate::geom::BBox;
use crate::torse::form::PanelKind;
use crate::torse::kind::{EnvelopeShape, TangentPlane};
use crate::torse::strip::Strip;

/// A stretch of a part that is of one shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Name of the part.
    pub part: String,
    /// What it is.
    pub shape: EnvelopeShape,
    /// Where it lies: index of a strip and parameters of the first and the last ruling, strip after strip.
    pub pieces: Vec<(usize, f64, f64)>,
    /// Angle through which the tangent plane turns, rad, measured.
    pub turn: f64,
    /// Root mean square of what the shape leaves: angles in rad and distances by the size of the part together.
    pub residual: f64,
    /// Whether another shape would be chosen if the noise were twice or half as great.
    pub ambiguous: bool,
}

/// Tangent planes per part that are aimed at.
const PLANES: usize = 240;
/// Least and greatest number of planes per strip: with fewer, a chain of cones is as well a tangent surface; more would
/// tell no more.
const PER_STRIP: [usize; 2] = [40, 64];
/// Most planes of a part; beyond it the shapes of a part are not looked for.
const MOST_PLANES: usize = 20_000;
/// Noise as a share of the tolerance by the size: strips are fitted to a tenth of the tolerance and better.
const NOISE_SHARE: f64 = 0.1;
/// Least noise of the planes of fitted strips, rad.
const NOISE: f64 = 1e-6;

/// Decomposes all parts of a job; see [`decompose`]. The noise is a tenth of the tolerance as a share of the part's size.
///
/// A part that is a chain of plane strips counts as a discrete torse, one plane per strip. Parts with fewer planes than
/// a shape needs, and those with rulings without tangent plane, are left out.
/// Panels that cover faces are left out: they are trimmed.
pub(crate) fn shapes(answer: &Answer) -> Vec<Shape> {
    let mut out = Vec::new();
    for part in &answer.parts {
        let range = part.first..part.first.saturating_add(part.count);
        let Some(panels) = answer.patchwork.panels.get(range) else { continue };
        if panels.iter().any(|p| p.trim.is_some()) {
            continue;
        }
        let strips: Vec<&Strip> = panels.iter().map(|p| &p.strip).collect();
        out.extend(part_shapes(&part.name, part.first, &strips, answer.tolerance).unwrap_or_default());
    }
    out
}

/// The shapes of one part, or `None` if they cannot be told.
fn part_shapes(name: &str, first: usize, strips: &[&Strip], tolerance: f64) -> Option<Vec<Shape>> {
    if strips.is_empty() {
        return None;
    }
    let discrete = strips.iter().all(|s| s.kind == PanelKind::Plane);
    let per_strip = if discrete { 1 } else { (PLANES / strips.len()).clamp(PER_STRIP[0], PER_STRIP[1]) };
    if per_strip * strips.len() > MOST_PLANES {
        return None;
    }
    let bbox = strips.iter().map(|s| s.patch.bbox()).fold(BBox::empty(), |mut b, o| {
        b.include(&o.min);
        b.include(&o.max);
        b
    });
    let size = bbox.diagonal();
    let at = |k: usize, i: usize| {
        let (a, b) = strips[k].domain();
        a + (b - a) * i as f64 / per_strip as f64
    };
    let mut planes: Vec<TangentPlane> = Vec::with_capacity(per_strip * strips.len());
    for (k, strip) in strips.iter().enumerate() {
        for i in 0..per_strip {
            planes.push(TangentPlane::of(strip, 0.5 * (at(k, i) + at(k, i + 1)))?);
        }
    }
    let options = DecomposeOptions { noise: (NOISE_SHARE * tolerance / size).max(NOISE), centre: bbox.center(), size };
    let runs = decompose(&planes, &options).ok()?;
    let turn = |a: usize, b: usize| -> f64 {
        let n = &planes[a..b];
        let angle = |w: &[TangentPlane]| {
            let (p, q) = (w[0].normal, w[1].normal);
            p.cross(&q).norm().atan2(p.dot(&q).abs())
        };
        n.windows(2).map(angle).sum()
    };
    let shapes = runs.iter().map(|r| {
        let (from, to) = (r.first / per_strip, (r.end - 1) / per_strip);
        let pieces = (from..=to)
            .map(|k| {
                let start = r.first.max(k * per_strip) - k * per_strip;
                let end = r.end.min((k + 1) * per_strip) - k * per_strip;
                (first + k, at(k, start), at(k, end))
            })
            .collect();
        Shape {
            part: name.to_owned(),
            shape: r.shape,
            pieces,
            turn: turn(r.first, r.end),
            residual: r.residual,
            ambiguous: r.ambiguous,
        }
    });
    Some(shapes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::torse::quad_strip::QuadStrip;

    fn discrete(point: impl Fn(usize, f64) -> Vec3, count: usize) -> Vec<Strip> {
        let side = |r: f64| (0..=count).map(|k| point(k, r)).collect();
        QuadStrip::new(side(0.0), side(1.0)).expect("a strip").faces("q").expect("faces")
    }

    #[test]
    fn a_discrete_cone_is_a_cone_and_keeps_its_apex() {
        let apex = Vec3::new(10.0, 0.0, 300.0);
        let cone = |k: usize, r: f64| {
            let (s, c) = (0.08 * k as f64).sin_cos();
            let foot = Vec3::new(100.0 * c, 100.0 * s, 0.0);
            foot + (apex - foot) * (0.5 * r)
        };
        let strips = discrete(cone, 20);
        let s = part_shapes("A", 3, &strips.iter().collect::<Vec<_>>(), 0.001).expect("shapes");
        assert_eq!(s.len(), 1);
        let EnvelopeShape::Cone { apex: found } = s[0].shape else { panic!("{:?}", s[0].shape) };
        assert!((found - apex).norm() < 1e-6 && s[0].residual < 1e-9);
        assert_eq!((s[0].pieces.len(), s[0].pieces[0], s[0].pieces[19]), (20, (3, 0.0, 1.0), (22, 0.0, 1.0)));
        assert!((s[0].turn - 1.45).abs() < 0.05, "{}", s[0].turn);
    }

    #[test]
    fn a_plane_and_a_cylinder_in_one_strip_of_many_rulings_part_at_their_ruling() {
        let c = |k: usize, r: f64| {
            let t = (k as f64 - 20.0) * 0.1;
            let (x, z) = if t < 0.0 { (100.0 * t, 0.0) } else { (100.0 * t.sin(), 100.0 * (1.0 - t.cos())) };
            Vec3::new(x, 80.0 * r, z)
        };
        let s = part_shapes("A", 0, &discrete(c, 38).iter().collect::<Vec<_>>(), 0.001).expect("shapes");
        let names: Vec<&str> = s.iter().map(|s| s.shape.name()).collect();
        assert_eq!(names, ["plane", "cylinder"]);
        assert!(s[0].pieces.len() == 20 && s[1].pieces[0].0 == 20);
        assert!(part_shapes("A", 0, &[], 0.1).is_none());
        assert!(part_shapes("A", 0, &discrete(c, 3).iter().collect::<Vec<_>>(), 0.1).is_none());
    }
}
