//! Outlines of faces and panels, dense enough to be carried to a cone spline.

use crate::brep::face::Face;
use crate::fit::panels::cone_trim::OutlinePoint;
use crate::geom::Vec3;
use crate::patchwork::panel::Panel;
use crate::spline::bezier::Bezier;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::surface::Surface;

/// A boundary in the parameter plane of a ruled patch.
pub(crate) struct PlaneOutline {
    /// The ruled patch, u selecting the ruling.
    pub surface: Surface,
    /// Closed loops of corners on it, each with the number of the edge behind it.
    pub loops: Vec<Vec<([f64; 2], u32)>>,
    /// The same loops as curves, exactly.
    pub curves: Vec<Vec<Curve<2>>>,
    /// Places of each loop in sets whose hulls hold the stretches of the boundary.
    hulls: Vec<Vec<Vec<[f64; 2]>>>,
}

/// Corners to a span of a panel's trimming curves.
const SPAN_CORNERS: usize = 16;
/// Corners to a segment on long chords.
const SEGMENT_CORNERS: usize = 12;
/// Share of an extent below which a length is none: a boundary that strays so little from a rectangle follows it, which is paid
/// for, an edge so near to the last ruling runs along it, and a border that is so short against the rulings is a point.
pub(super) const NOTHING: f64 = 1e-9;
/// Share of a side within which a line meets its corner: beside it, it would make a chord without length.
const AT_CORNER: f64 = 1e-6;

/// Places along a border at which it is looked whether that is a point.
const TIP_PLACES: usize = 16;

impl PlaneOutline {
    /// The trim of a face on its surface, whose parameters may be exchanged. `None` for a loop without corners.
    pub fn of_face(face: &Face, surface: Surface, transposed: bool) -> Option<Self> {
        let place = |p: &[f64; 2]| if transposed { [p[1], p[0]] } else { *p };
        let loops: Vec<Vec<([f64; 2], u32)>> =
            face.loops.iter().map(|l| l.points.iter().zip(&l.edge).map(|(p, e)| (place(p), *e)).collect()).collect();
        let curves = loops.iter().map(|l| Some(vec![polygon(l)?])).collect::<Option<_>>()?;
        let chords = |l: &Vec<([f64; 2], u32)>| (0..l.len()).map(|i| vec![l[i].0, l[(i + 1) % l.len()].0]).collect();
        let hulls = loops.iter().map(chords).collect();
        Some(Self { surface, loops, curves, hulls })
    }

    /// The boundary of a panel.
    pub fn of_panel(panel: &Panel) -> Self {
        let mut number = 0;
        let (mut loops, mut hulls) = (Vec::new(), Vec::new());
        for runs in panel.loops() {
            let (mut corners, mut sets) = (Vec::new(), Vec::new());
            for run in runs {
                for (a, _, control) in bezier_pieces(&run.trim) {
                    let span = Bezier::new(control);
                    for k in 0..SPAN_CORNERS {
                        let share = |k: usize| k as f64 / SPAN_CORNERS as f64;
                        // Ends are shared bit by bit.
                        let first = k == 0 && a <= run.trim.domain().0;
                        corners.push((if first { run.trim.control[0] } else { span.point(share(k)) }, number));
                        sets.push(span.restricted(share(k), share(k + 1)).control().to_vec());
                    }
                }
                number += 1;
            }
            loops.push(corners);
            hulls.push(sets);
        }
        let curves = panel.loops().iter().map(|runs| runs.iter().map(|r| r.trim.clone()).collect()).collect();
        Self { surface: panel.strip.patch.clone(), loops, curves, hulls }
    }

    /// Least and greatest parameters `(u0, u1, v0, v1)`.
    pub fn bounds(&self) -> [f64; 4] {
        self.hulls
            .iter()
            .flatten()
            .flatten()
            .fold([f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY], |b, [u, v]| {
                [b[0].min(*u), b[1].max(*u), b[2].min(*v), b[3].max(*v)]
            })
    }

    /// Where all rulings meet at an end of the region, as at the tip of a cone.
    pub fn tip(&self) -> Option<Vec3> {
        let [u0, u1, v0, v1] = self.bounds();
        let at = |k: usize, v: f64| self.surface.point(u0 + (u1 - u0) * k as f64 / TIP_PLACES as f64, v);
        let length = (0..=TIP_PLACES).map(|k| (at(k, v1) - at(k, v0)).norm()).fold(0.0, f64::max);
        let wide = |v: f64| (1..=TIP_PLACES).map(|k| (at(k, v) - at(0, v)).norm()).fold(0.0, f64::max);
        [v0, v1].into_iter().find(|v| wide(*v) <= NOTHING * length).map(|v| at(0, v))
    }

    /// How far the boundary strays from that of the rectangle between its least and greatest parameters, as a share of
    /// it; `None` if it is not that rectangle.
    pub fn strays_from_rectangle(&self) -> Option<f64> {
        let [u0, u1, v0, v1] = self.bounds();
        let off = |p: &[f64; 2]| {
            let (u, v) = ((p[0] - u0) / (u1 - u0), (p[1] - v0) / (v1 - v0));
            [u.abs(), (u - 1.0).abs(), v.abs(), (v - 1.0).abs()]
        };
        let mut worst = 0.0_f64;
        for set in self.hulls.iter().flatten() {
            let side = (0..4).map(|k| set.iter().map(|p| off(p)[k]).fold(0.0, f64::max)).fold(f64::INFINITY, f64::min);
            worst = worst.max(side);
        }
        (self.hulls.len() == 1 && worst <= NOTHING).then_some(worst)
    }

    /// Whether the region is the whole rectangle between its least and greatest parameters.
    pub fn is_rectangle(&self) -> bool {
        self.strays_from_rectangle().is_some()
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
                        if s > AT_CORNER && s < 1.0 - AT_CORNER {
                            put([u, a[1] + s * (b[1] - a[1])]);
                        }
                    }
                }
                out
            })
            .collect()
    }
}

/// A closed polygon as a curve of degree 1.
fn polygon(corners: &[([f64; 2], u32)]) -> Option<Curve<2>> {
    let mut control: Vec<[f64; 2]> = corners.iter().map(|c| c.0).collect();
    control.push(*control.first()?);
    let last = (control.len() - 1) as f64;
    let mut knots = vec![0.0];
    knots.extend((0..control.len()).map(|k| k as f64));
    knots.push(last);
    Curve::new(1, knots, control).ok()
}
