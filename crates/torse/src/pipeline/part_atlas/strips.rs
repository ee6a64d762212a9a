//! Untrimmed strips of a result as panels.

use crate::develop::refold::atlas::PanelPatch;
use crate::draw::scene::NOT_CERTIFIED;
use crate::geom::{Frame, Vec3};
use crate::patchwork::written::{WrittenBase, WrittenStrip};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// A name without the words that warn of cutting.
pub(super) fn plain(name: &str) -> String {
    name.strip_suffix(NOT_CERTIFIED).map_or(name, str::trim_end).to_owned()
}

/// An untrimmed strip as a panel.
pub(super) fn panel_of(s: &WrittenStrip) -> Result<PanelPatch, String> {
    let named = |e: String| format!("face {}: {e}", s.name);
    match &s.surface {
        WrittenBase::Spline(w) => {
            let points: Vec<Vec3> = w.points.iter().map(|p| Vec3::from(*p)).collect();
            let weights = (!w.weights.is_empty()).then_some(&w.weights[..]);
            let [u, v] = w.knots.clone();
            let surface = Surface::new(u, v, &points, weights).map_err(|e| named(e.to_string()))?;
            let ((a, b), (c, d)) = surface.domain();
            let breaks = surface.knots_u.breaks();
            // Rails bend: enough corners that chords tell inside from outside.
            let mut along: Vec<f64> = breaks
                .windows(2)
                .flat_map(|w| (0..RAIL).map(|k| w[0] + (w[1] - w[0]) * k as f64 / RAIL as f64))
                .collect();
            along.push(b);
            let rail: Vec<[f64; 2]> = along.iter().map(|u| [*u, c]).collect();
            let back = along.iter().rev().map(|u| [*u, d]);
            let loops = vec![rail.into_iter().chain(back).collect()];
            Ok(PanelPatch { name: plain(&s.name), surface, loops, corners: vec![[a, c], [b, c], [b, d], [a, d]] })
        }
        WrittenBase::Plane { point, normal } => {
            let vertices: Vec<Vec3> = s.sides.iter().map(|e| Vec3::from(e.vertices[usize::from(!e.forward)])).collect();
            plane_panel(&plain(&s.name), Vec3::from(*point), Vec3::from(*normal), &vertices)
                .ok_or_else(|| named("the plane has no corners".into()))
        }
        WrittenBase::Cylinder { .. } | WrittenBase::Cone { .. } => Err(named("it is no strip".into())),
    }
}

/// Points on a rail from knot to knot.
const RAIL: usize = 24;

/// A plane polygon as a panel.
fn plane_panel(name: &str, point: Vec3, normal: Vec3, vertices: &[Vec3]) -> Option<PanelPatch> {
    let z = normal.try_normalize(0.0)?;
    let x = (vertices.get(1)? - vertices.first()?).try_normalize(0.0)?;
    let x = (x - z * z.dot(&x)).try_normalize(0.0)?;
    let frame = Frame { origin: point, x, y: z.cross(&x), z };
    let local: Vec<[f64; 2]> = vertices.iter().map(|v| frame.to_local(v)).map(|q| [q.x, q.y]).collect();
    let span =
        |k: usize| local.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |b, p| [b[0].min(p[k]), b[1].max(p[k])]);
    let ([a, b], [c, d]) = (span(0), span(1));
    let corner = |x: f64, y: f64| frame.to_world(&Vec3::new(x, y, 0.0));
    let points = [corner(a, c), corner(a, d), corner(b, c), corner(b, d)];
    let knots = |lo: f64, hi: f64| Knots::clamped(1, &[lo, hi]).ok();
    let surface = Surface::new(knots(a, b)?, knots(c, d)?, &points, None).ok()?;
    Some(PanelPatch { name: name.into(), surface, loops: vec![local.clone()], corners: local })
}
