//! Outlines of faces and panels, dense enough to be carried to a cone spline.

use crate::fit::cone_trim::OutlinePoint;
use crate::spline::surface::Surface;
use crate::surface::face::Face;
use crate::surface::panel::Panel;

/// A boundary in the parameter plane of a ruled patch: corners, and the number of the edge behind each.
pub struct PlaneOutline {
    /// The ruled patch, u selecting the ruling.
    pub surface: Surface,
    /// Closed loops.
    pub loops: Vec<Vec<([f64; 2], u32)>>,
}

/// Corners to a span of a panel's trimming curves.
const SPAN_CORNERS: usize = 16;
/// Corners to a segment on long chords.
const SEGMENT_CORNERS: usize = 12;

impl PlaneOutline {
    /// The trim of a face on its surface, whose parameters may be exchanged.
    pub fn of_face(face: &Face, surface: Surface, transposed: bool) -> Self {
        let place = |p: &[f64; 2]| if transposed { [p[1], p[0]] } else { *p };
        let loops =
            face.loops.iter().map(|l| l.points.iter().zip(&l.edge).map(|(p, e)| (place(p), *e)).collect()).collect();
        Self { surface, loops }
    }

    /// The boundary of a panel.
    pub fn of_panel(panel: &Panel) -> Self {
        let mut number = 0;
        let mut loops = Vec::new();
        for runs in &panel.loops {
            let mut corners = Vec::new();
            for run in runs {
                let breaks = run.trim.knots.breaks();
                for w in breaks.windows(2) {
                    corners.extend((0..SPAN_CORNERS).map(|k| {
                        let s = w[0] + (w[1] - w[0]) * k as f64 / SPAN_CORNERS as f64;
                        // Ends are shared bit by bit.
                        (if s <= 0.0 { run.trim.control[0] } else { run.trim.point(s) }, number)
                    }));
                }
                number += 1;
            }
            loops.push(corners);
        }
        Self { surface: panel.patch.clone(), loops }
    }

    /// Least and greatest parameters `(u0, u1, v0, v1)`.
    pub fn bounds(&self) -> [f64; 4] {
        self.loops.iter().flatten().fold(
            [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY],
            |b, p| {
                let [u, v] = p.0;
                [b[0].min(u), b[1].max(u), b[2].min(v), b[3].max(v)]
            },
        )
    }

    /// Whether the region is the whole rectangle between its least and greatest parameters.
    pub fn is_rectangle(&self) -> bool {
        /// A boundary that strays from the rectangle by less than this share of it follows it.
        const ASTRAY: f64 = 1e-9;
        let [u0, u1, v0, v1] = self.bounds();
        let (du, dv) = (ASTRAY * (u1 - u0), ASTRAY * (v1 - v0));
        let on = |p: &[f64; 2]| {
            [(p[0] - u0).abs() <= du, (p[0] - u1).abs() <= du, (p[1] - v0).abs() <= dv, (p[1] - v1).abs() <= dv]
        };
        self.loops.len() == 1
            && self.loops.iter().all(|l| {
                (0..l.len()).all(|i| {
                    let (a, b) = (on(&l[i].0), on(&l[(i + 1) % l.len()].0));
                    (0..4).any(|k| a[k] && b[k])
                })
            })
    }

    /// Corners in space, long chords cut; `nodes` are the rulings of a chain, two segments between neighbours.
    pub fn in_space(&self, nodes: &[f64]) -> Vec<Vec<OutlinePoint>> {
        let mut lines = Vec::with_capacity(nodes.len() * 2 * SEGMENT_CORNERS);
        for w in nodes.windows(2) {
            let parts = 2 * SEGMENT_CORNERS;
            lines.extend((0..parts).map(|k| w[0] + (w[1] - w[0]) * k as f64 / parts as f64));
        }
        lines.extend(nodes.last());
        self.loops
            .iter()
            .map(|l| {
                let mut out = Vec::new();
                for i in 0..l.len() {
                    let ((a, edge), (b, _)) = (l[i], l[(i + 1) % l.len()]);
                    let mut put = |q: [f64; 2]| {
                        let point = self.surface.point(q[0], q[1]);
                        out.push(OutlinePoint { point, edge });
                    };
                    put(a);
                    let (lo, hi) = (a[0].min(b[0]), a[0].max(b[0]));
                    let from = lines.partition_point(|x| *x <= lo);
                    let to = lines.partition_point(|x| *x < hi);
                    let mut between: Vec<f64> = lines.get(from..to).unwrap_or(&[]).to_vec();
                    if a[0] > b[0] {
                        between.reverse();
                    }
                    for u in between {
                        let s = (u - a[0]) / (b[0] - a[0]);
                        // A line that all but meets a corner would make a chord without length.
                        if s > 1e-6 && s < 1.0 - 1e-6 {
                            put([u, a[1] + s * (b[1] - a[1])]);
                        }
                    }
                }
                out
            })
            .collect()
    }
}
