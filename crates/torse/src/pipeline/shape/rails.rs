//! Rails that a job takes from other files: those of strips as their files hold them, and those of lofts.

use crate::io::curves::{self, CurveOptions};
use crate::patchwork::written::{WrittenBase, WrittenCurve, WrittenStrip};
use crate::spline::curve::Curve;
use crate::torse::rail::Rail;

/// Both rails of a strip as its file holds them, homogeneous.
pub(super) fn rails(s: &WrittenStrip) -> Option<[Curve<4>; 2]> {
    match &s.surface {
        WrittenBase::Spline(surface) => {
            let [u, v] = &surface.knots;
            if v.degree() != 1 || v.control_count() != 2 || surface.points.len() != 2 * u.control_count() {
                return None;
            }
            let weight = |k: usize| surface.weights.get(k).copied().unwrap_or(1.0);
            let side = |j: usize| {
                let at = |i: usize| {
                    let ([x, y, z], w) = (surface.points[2 * i + j], weight(2 * i + j));
                    [x * w, y * w, z * w, w]
                };
                Curve { knots: u.clone(), control: (0..u.control_count()).map(at).collect() }
            };
            Some([side(0), side(1)])
        }
        // A plane has its rails as edges: the first, and the one before the last, which runs back.
        WrittenBase::Plane { .. } => {
            let along = |k: usize| match &s.sides.get(k)?.curve {
                WrittenCurve::Spline { curve, weights } => {
                    let weight = |i: usize| weights.get(i).copied().unwrap_or(1.0);
                    let lifted = curve.control.iter().enumerate().map(|(i, p)| {
                        let w = weight(i);
                        [p[0] * w, p[1] * w, p[2] * w, w]
                    });
                    Some(Curve { knots: curve.knots.clone(), control: lifted.collect() })
                }
                WrittenCurve::Line { .. } => {
                    let [p, q] = s.sides[k].vertices;
                    let ends = [p, q].map(|p| [p[0], p[1], p[2], 1.0]);
                    Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends.to_vec()).ok()
                }
                WrittenCurve::Circle { .. } => None,
            };
            if s.sides.len() == 3 {
                // A triangle: its second rail is a point.
                let first = along(0)?;
                let tip = s.sides[1].vertices[if s.sides[1].forward { 1 } else { 0 }];
                let point = [tip[0], tip[1], tip[2], 1.0];
                let second = Curve { control: vec![point; first.control.len()], knots: first.knots.clone() };
                return Some([first, second]);
            }
            Some([along(0)?, along(2)?])
        }
        _ => None,
    }
}

/// Places of a homogeneous curve at equal shares of its parameters.
pub(super) fn sampled(c: &Curve<4>, count: usize) -> Vec<[f64; 3]> {
    let (a, b) = c.domain();
    let at = |k: usize| {
        let h = c.point(a + (b - a) * k as f64 / count as f64);
        [h[0] / h[3], h[1] / h[3], h[2] / h[3]]
    };
    (0..=count).map(at).collect()
}

/// The rails of a loft from their files; `unit` (mm) is that of files that do not say theirs.
pub(super) fn rails_of(
    files: &[String; 2],
    unit: f64,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<[Rail; 2], String> {
    let rail = |text: &String| {
        let (file, select) = text.rsplit_once('#').unwrap_or((text, ""));
        let options = CurveOptions { name: text.clone(), select: select.into(), unit: Some(unit), polyline: false };
        let bytes = load(file)?;
        // A unit of the file's own must not be contradicted.
        let given = curves::read(&bytes, &CurveOptions { unit: None, ..options.clone() });
        let read = match given {
            Err(curves::CurveError::NoUnit(_)) => curves::read(&bytes, &options),
            other => other,
        };
        read.map(|r| r.0).map_err(|e| e.to_string())
    };
    Ok([rail(&files[0])?, rail(&files[1])?])
}
