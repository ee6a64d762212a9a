//! Refolded parts as trimmed ruled surfaces for CAD.

use crate::develop::refold::leaf::{Leaf, Refolded};
use crate::develop::refold::mesh::{ends, lines, spots};
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::io::step::write::{EdgeUse, Sheet, SheetCurve, SheetEdge, SheetFace, SheetSurface, SurfaceForm};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// The regions of a part as trimmed surfaces, moved: straight from ruling to ruling, whose turn is some 2° at most from one to
/// the next. Borders are polylines. Regions that have no such surface are left out.
pub fn surfaces(name: &str, part: &Refolded, motion: &Placement) -> Vec<Sheet> {
    let several = part.leaves.len() > 1;
    let named = |k: usize| if several { format!("{name}-{:02}", k + 1) } else { name.to_owned() };
    part.leaves.iter().enumerate().filter_map(|(k, l)| surface(&named(k), l, motion)).collect()
}

fn surface(name: &str, leaf: &Leaf, motion: &Placement) -> Option<Sheet> {
    let spots = spots(leaf);
    let [[a, b], _] = ends(&spots)?;
    // What lies beyond the rulings that were laid has no surface of its own.
    if leaf.ribbon.spans.len() > 1 && (a < 0.0 || b > leaf.ribbon.end()) {
        return None;
    }
    let lines = lines(leaf, a, b);
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for t in &lines {
        let k = (t.max(0.0) as usize).min(leaf.ribbon.spans.len() - 1);
        let [a, b] = leaf.ribbon.spans[k].reach;
        low.push(a - MARGIN * (b - a));
        high.push(b + MARGIN * (b - a));
    }
    // Between two rulings the outline may reach farther than at them.
    for [t, v] in spots.iter().flatten() {
        let k = lines.partition_point(|x| x <= t).clamp(1, lines.len() - 1);
        for i in [k - 1, k] {
            let breadth = MARGIN * (high[i] - low[i]);
            (low[i], high[i]) = (low[i].min(v - breadth), high[i].max(v + breadth));
        }
    }
    let mut points = Vec::new();
    for ((t, a), b) in lines.iter().zip(&low).zip(&high) {
        let pose = leaf.ribbon.space(*t);
        points.extend([a, b].map(|v| motion.point(&pose.point(*v, 0.0))));
    }
    let surface =
        Surface::new(Knots::clamped(1, &lines).ok()?, Knots::clamped(1, &[0.0, 1.0]).ok()?, &points, None).ok()?;
    // Share of the way between both rails.
    let at = |[t, v]: [f64; 2]| {
        let k = lines.partition_point(|x| *x <= t).clamp(1, lines.len() - 1);
        let s = (t - lines[k - 1]) / (lines[k] - lines[k - 1]);
        let mix = |x: &[f64]| x[k - 1] + (x[k] - x[k - 1]) * s;
        [t.clamp(lines[0], lines[lines.len() - 1]), ((v - mix(&low)) / (mix(&high) - mix(&low))).clamp(0.0, 1.0)]
    };
    let mut sheet = Sheet { name: name.into(), ..Sheet::default() };
    let mut loops = Vec::new();
    for l in spots.iter().filter(|l| l.len() > 2) {
        let mut trim: Vec<[f64; 2]> = l.iter().map(|p| at(*p)).collect();
        trim.push(trim[0]);
        let edge: Vec<[f64; 3]> = trim.iter().map(|p| surface.point(p[0], p[1]).into()).collect();
        let knots: Vec<f64> = (0..trim.len()).map(|k| k as f64).collect();
        let all: Vec<f64> = std::iter::once(0.0).chain(knots).chain([trim.len() as f64 - 1.0]).collect();
        let vertex = sheet.vertices.len();
        sheet.vertices.push(Vec3::from(edge[0]));
        let number = sheet.edges.len();
        let curve = SheetCurve::Spline(Curve::new(1, all.clone(), edge).ok()?);
        sheet.edges.push(SheetEdge { start: vertex, end: vertex, curve });
        loops.push(vec![EdgeUse { edge: number, forward: true, trim: Curve::new(1, all, trim).ok() }]);
    }
    // Across, then along: the surface's own normal looks away from the eye.
    let surface = SheetSurface::Spline { surface, form: SurfaceForm::Ruled };
    sheet.faces.push(SheetFace { name: name.into(), surface, reversed: true, loops });
    Some(sheet)
}

/// By how much surfaces reach beyond the part, as a share of their rulings.
const MARGIN: f64 = 1e-3;
