//! Triangles, rulings and borders of untrimmed strips, for pictures and mesh files. Nothing is proven here.

use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::patchwork::panel::{Coedge, Panel};
use crate::patchwork::triangulate::triangulate;
use crate::spline::surface::NO_NORMAL;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Parts of a span in u where no grid is given.
const PARTS: usize = 8;
/// Least number of parts of a strip.
const FEWEST_PARTS: usize = 24;
/// Most parts of a strip.
const MOST_PARTS: usize = 4096;
/// Turn of an edge (rad) that is drawn straight: 2°.
const STRAIGHT: f64 = 0.035;
/// Chords of a span by which its turn is told.
const PROBES: usize = 16;

/// An end of a ruling that moves by less than this share of its middle stands still: an apex, up to rounding.
const STANDS_STILL: f64 = 1e-9;
/// Triangles of less area by their squared edges are edges.
const NO_AREA: f64 = 1e-12;

/// A grid fine enough for pictures: every span in equal parts, one cell along the rulings. One part for each span of a
/// plane between polylines.
pub fn grid(strip: &Strip) -> (Vec<f64>, Vec<f64>) {
    let breaks = strip.patch.knots_u.breaks();
    if strip.kind == PanelKind::Plane && strip.patch.knots_u.degree() == 1 {
        return (breaks, vec![0.0, 1.0]);
    }
    let spans = breaks.len().saturating_sub(1).max(1);
    let least = PARTS.min((MOST_PARTS / spans).max(1)).max(FEWEST_PARTS.div_ceil(spans));
    let most = (MOST_PARTS / spans).max(least);
    let mut u = Vec::with_capacity(spans * least + 1);
    for w in breaks.windows(2) {
        let parts = ((turn(strip, w[0], w[1]) / STRAIGHT).ceil() as usize).clamp(least, most);
        u.extend((0..parts).map(|k| w[0] + (w[1] - w[0]) * k as f64 / parts as f64));
    }
    u.push(breaks[breaks.len() - 1]);
    (u, vec![0.0, 1.0])
}

/// Turn of the edge that turns more over a span, rad, and more where it turns at one place: as if it did so all along.
fn turn(strip: &Strip, from: f64, to: f64) -> f64 {
    let side = |v: f64| {
        let points: Vec<Vec3> =
            (0..=PROBES).map(|k| strip.patch.point(from + (to - from) * k as f64 / PROBES as f64, v)).collect();
        let chords: Vec<Vec3> = points.windows(2).filter_map(|w| (w[1] - w[0]).try_normalize(0.0)).collect();
        let turns = chords.windows(2).map(|w| w[0].cross(&w[1]).norm().atan2(w[0].dot(&w[1])));
        turns.fold(0.0, f64::max) * PROBES as f64
    };
    side(0.0).max(side(1.0))
}

/// The mesh over a grid; `values` belongs to the vertices, index `i * v.len() + j`, or is empty.
pub fn mesh(strip: &Strip, u: &[f64], v: &[f64], values: &[f64]) -> Mesh {
    let mut out = Mesh::default();
    for &s in u {
        for &t in v {
            let (j, middle) = (strip.patch.jet(s, t), strip.patch.jet(s, 0.5));
            out.positions.push(j.p);
            // At an apex the middle of the ruling knows the tangent plane; what moves there is rounding.
            let own = if j.du.norm() > STANDS_STILL * middle.du.norm() { j } else { middle };
            let normal = own.normal().try_normalize(NO_NORMAL * own.du.norm() * own.dv.norm());
            out.normals.push(normal.unwrap_or_else(Vec3::zeros));
        }
    }
    let m = v.len();
    for i in 0..u.len().saturating_sub(1) {
        for j in 0..m.saturating_sub(1) {
            let k = |i: usize, j: usize| (i * m + j) as u32;
            let [a, b, c, d] = [k(i, j), k(i + 1, j), k(i + 1, j + 1), k(i, j + 1)];
            for t in [[a, b, c], [a, c, d]] {
                // Triangles without area, at an apex, would only disturb the shading.
                let [p, q, r] = t.map(|k| out.positions[k as usize]);
                let (e, f) = (q - p, r - p);
                if e.cross(&f).norm() > NO_AREA * (e.norm_squared() + f.norm_squared()) {
                    out.triangles.push(t);
                }
            }
        }
    }
    if values.len() == out.positions.len() {
        out.values = values.to_vec();
    }
    out
}

/// The mesh of a panel that covers no face but ends at an outline, over a grid as [`mesh`]; `values` are interpolated. The
/// whole strip where its outline cannot be filled.
pub(crate) fn trimmed_mesh(panel: &Panel, u: &[f64], v: &[f64], values: &[f64]) -> Mesh {
    let strip = &panel.strip;
    let corners = |runs: &Vec<Coedge>| -> Vec<[f64; 2]> {
        runs.iter().flat_map(|r| r.trim.control.iter().take(r.trim.control.len() - 1).copied()).collect()
    };
    let loops: Vec<(Vec<[f64; 2]>, Vec<u32>)> =
        panel.outline.iter().map(corners).map(|l| (l.clone(), vec![0; l.len()])).collect();
    let Ok(found) = triangulate(&loops, u, v) else { return mesh(strip, u, v, values) };
    let mut out = Mesh::default();
    for &[s, t] in &found.vertices {
        let (j, middle) = (strip.patch.jet(s, t), strip.patch.jet(s, 0.5));
        let own = if j.du.norm() > STANDS_STILL * middle.du.norm() { j } else { middle };
        let normal = own.normal().try_normalize(NO_NORMAL * own.du.norm() * own.dv.norm());
        out.positions.push(j.p);
        out.normals.push(normal.unwrap_or_else(Vec3::zeros));
        if values.len() == u.len() * v.len() {
            out.values.push(value(u, v, values, [s, t]));
        }
    }
    out.triangles = found.triangles;
    out
}

/// A value between those of a grid.
fn value(u: &[f64], v: &[f64], values: &[f64], at: [f64; 2]) -> f64 {
    let cell = |g: &[f64], x: f64| {
        let k = g.partition_point(|y| *y <= x).clamp(1, g.len() - 1);
        (k - 1, ((x - g[k - 1]) / (g[k] - g[k - 1])).clamp(0.0, 1.0))
    };
    let ((i, s), (j, t)) = (cell(u, at[0]), cell(v, at[1]));
    let m = v.len();
    let along = |i: usize| values[i * m + j] * (1.0 - t) + values[i * m + j + 1] * t;
    along(i) * (1.0 - s) + along(i + 1) * s
}

/// Rulings about `spacing` (mm) apart in the middle; none inside planes.
pub fn ruling_lines(strip: &Strip, spacing: f64) -> Vec<[Vec3; 2]> {
    if strip.kind == PanelKind::Plane || spacing.is_nan() || spacing <= 0.0 {
        return Vec::new();
    }
    let (u, _) = grid(strip);
    let mut out = Vec::new();
    let (mut since, mut last) = (0.5 * spacing, strip.patch.point(u[0], 0.5));
    for w in u.windows(2) {
        let p = strip.patch.point(w[1], 0.5);
        let step = (p - last).norm();
        // Several rulings may fall into one cell.
        let mut x = spacing - since;
        while x <= step && step > 0.0 && out.len() < MOST_PARTS {
            out.push(strip.ruling(w[0] + (w[1] - w[0]) * x / step));
            x += spacing;
        }
        since = step - (x - spacing);
        last = p;
    }
    out
}

/// The border as one closed polyline.
pub fn border_line(strip: &Strip) -> Vec<Vec3> {
    let (u, _) = grid(strip);
    let mut line: Vec<Vec3> = u.iter().map(|&s| strip.patch.point(s, 0.0)).collect();
    line.extend(u.iter().rev().map(|&s| strip.patch.point(s, 1.0)));
    line.extend(line.first().copied());
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_strip_has_its_area_its_rulings_and_its_border() {
        let x = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let s = Strip::quad("s", PanelKind::Cylinder, [x(0.0, 0.0), x(0.0, 50.0)], [x(100.0, 0.0), x(100.0, 50.0)])
            .expect("strip");
        let (u, v) = grid(&s);
        let m = mesh(&s, &u, &v, &vec![1.0; u.len() * v.len()]);
        let area: f64 = m
            .triangles
            .iter()
            .map(|t| {
                let [p, q, r] = t.map(|k| m.positions[k as usize]);
                0.5 * (q - p).cross(&(r - p)).norm()
            })
            .sum();
        assert!((area - 5000.0).abs() < 1e-9 && m.values.len() == m.positions.len());
        let rulings = ruling_lines(&s, 10.0);
        assert_eq!(rulings.len(), 10);
        assert!((rulings[3][0].x - 35.0).abs() < 1e-9);
        assert_eq!(border_line(&s).len(), 2 * u.len() + 1);
    }
}
