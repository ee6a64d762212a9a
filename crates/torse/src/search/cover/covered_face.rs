//! What is known while a face is being covered: the partition, the surface at its vertices, and the torses found.

use super::seam_line::SeamLine;
use crate::brep::face::Face;
use crate::fit::near::samples::Fit;
use crate::fit::near::tangent_envelope::ROUNDING;
use crate::fit::strip_potential::Forms;
use crate::geom::Vec3;
use crate::patchwork::partition::Partition;
use crate::patchwork::triangulate::{triangulate, TriangulateError};
use crate::spline::field::Field;
use crate::spline::surface::{Surface, SurfaceJet};
use crate::torse::form::Torse;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The surface at a vertex of the partition.
#[derive(Clone, Copy, Debug)]
pub struct VertexJet {
    /// Point and derivatives.
    pub jet: SurfaceJet,
    /// Unit normal; zero where the parametrisation degenerates.
    pub normal: Vec3,
}

/// Where a panel along a curve comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// Name of the curve.
    pub curve: String,
    /// Strips between the curve and the panel: 0 for the panel along the curve itself.
    pub step: usize,
    /// Distance found by the comparison of the paper, mm. Sampled.
    pub paper_estimate: f64,
}

/// A face parted into regions, with the torses found for them; those without one are still to be covered.
#[derive(Clone, Debug)]
pub struct Cover {
    /// The face.
    pub face: Arc<Face>,
    /// Regions.
    pub partition: Partition,
    /// Surface at the partition's vertices.
    pub jets: Vec<VertexJet>,
    /// Torse of each finished label.
    pub panels: BTreeMap<u32, Arc<Fit>>,
    /// Strip potential of each label that was laid as a band of one.
    pub bands: BTreeMap<u32, Arc<Field>>,
    /// Curve along which each label was laid, for labels that follow one.
    pub origins: BTreeMap<u32, Arc<Origin>>,
    /// Lines that seams must follow.
    pub(in crate::search) seam_lines: Arc<Vec<SeamLine>>,
    /// Whether a border touched itself and its region was parted there: two borders then leave that place side by side, and
    /// trimming curves must follow them closely, not to cross.
    pub(in crate::search) touched: bool,
}

/// Samples of curvature of a face: quantiles and means of it hardly depend on how many there are.
pub(super) const SAMPLES: usize = 400;

/// Cells per direction of the first triangulation, by the longer side; enough for some twenty strips.
const CELLS: usize = 64;
/// Largest number of cells of the first triangulation.
const MOST_CELLS: usize = 6000;

impl Cover {
    /// Triangulates a face: along its knot lines, and fine enough to tell strips of width `strip` (mm) apart.
    ///
    /// # Errors
    /// Trim loops that cross or enclose nothing.
    pub fn of_face(face: &Face, strip: f64) -> Result<Self, TriangulateError> {
        let s = &face.surface;
        let mut b = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for p in face.loops.iter().flat_map(|l| &l.points) {
            b = [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])];
        }
        let (lines_u, lines_v) = grid_lines(s, b, strip);
        Self::on_lines(face, lines_u, lines_v)
    }

    /// Triangulates a face along lines of constant u and v, from end to end of its box, and along its knot lines.
    ///
    /// # Errors
    /// Trim loops that cross or enclose nothing.
    pub(crate) fn on_lines(
        face: &Face,
        mut lines_u: Vec<f64>,
        mut lines_v: Vec<f64>,
    ) -> Result<Self, TriangulateError> {
        let s = &face.surface;
        for (lines, knots) in [(&mut lines_u, s.knots_u.breaks()), (&mut lines_v, s.knots_v.breaks())] {
            if let (Some(&lo), Some(&hi)) = (lines.first(), lines.last()) {
                lines.extend(knots.into_iter().filter(|&k| k > lo && k < hi));
                lines.sort_by(f64::total_cmp);
                lines.dedup();
            }
        }
        give_way(&mut lines_u, &s.knots_u.breaks(), face.loops.iter().flat_map(|l| &l.points).map(|p| p[0]));
        give_way(&mut lines_v, &s.knots_v.breaks(), face.loops.iter().flat_map(|l| &l.points).map(|p| p[1]));
        let loops: Vec<(Vec<[f64; 2]>, Vec<u32>)> =
            face.loops.iter().map(|l| (l.points.clone(), l.edge.clone())).collect();
        let partition = triangulate(&loops, &lines_u, &lines_v)?;
        let mut cover = Self {
            face: Arc::new(face.clone()),
            partition,
            jets: Vec::new(),
            panels: BTreeMap::new(),
            bands: BTreeMap::new(),
            origins: BTreeMap::new(),
            seam_lines: Arc::default(),
            touched: false,
        };
        cover.update();
        Ok(cover)
    }

    /// The cover with another partition of the same labels.
    pub(in crate::search) fn with_partition(&self, partition: Partition) -> Self {
        let mut out = Self {
            face: Arc::clone(&self.face),
            partition,
            jets: Vec::new(),
            panels: self.panels.clone(),
            bands: self.bands.clone(),
            origins: self.origins.clone(),
            seam_lines: self.seam_lines.clone(),
            touched: self.touched,
        };
        out.update();
        out
    }

    /// All torses, by label.
    pub(in crate::search) fn torses(&self) -> BTreeMap<u32, &Torse> {
        self.panels.iter().map(|(&label, fit)| (label, &fit.torse)).collect()
    }

    /// Box of all regions in the parameter plane: least and greatest u, least and greatest v.
    pub(super) fn bounds(&self) -> [f64; 4] {
        let none = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let join = |a: [f64; 4], b: [f64; 4]| [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])];
        self.regions().map(|r| r.bounds()).fold(none, join)
    }

    /// Evaluates the surface at new vertices.
    pub(crate) fn update(&mut self) {
        for v in self.jets.len()..self.partition.vertices.len() {
            let [u, w] = self.partition.vertices[v];
            let jet = self.face.surface.jet(u, w);
            self.jets.push(VertexJet { jet, normal: unit_normal(&jet) });
        }
    }

    /// Cuts a label; see [`Partition::cut`].
    pub(crate) fn cut(&mut self, label: u32, positive: u32, value: impl Fn([f64; 2]) -> f64) {
        self.partition.cut(label, positive, value);
        self.update();
    }

    /// Area of triangles in space by their corners, mm².
    pub(crate) fn triangle_area(&self, t: usize) -> f64 {
        let [a, b, c] = self.partition.triangles[t].map(|v| self.point(v));
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// Middle of a triangle in space, mm.
    pub(in crate::search) fn middle(&self, t: usize) -> Vec3 {
        self.partition.triangles[t].iter().map(|&v| self.point(v)).sum::<Vec3>() / 3.0
    }

    /// A vertex in space, mm.
    pub(in crate::search) fn point(&self, v: u32) -> Vec3 {
        self.jets[v as usize].jet.p
    }

    /// Whether the parametrisation is regular at a vertex.
    pub(super) fn is_regular(&self, v: u32) -> bool {
        self.jets[v as usize].normal.norm_squared() > 0.5
    }

    /// Principal curvatures at a vertex, larger first, 1/mm; `None` at poles.
    pub(super) fn curvatures(&self, v: u32) -> Option<[f64; 2]> {
        self.is_regular(v).then(|| self.forms_at(v).principal())
    }

    /// Fundamental forms at a vertex.
    pub(super) fn forms_at(&self, v: u32) -> Forms {
        let j = &self.jets[v as usize];
        let (s, n) = (&j.jet, &j.normal);
        Forms {
            uv: self.partition.vertices[v as usize],
            first: [s.du.dot(&s.du), s.du.dot(&s.dv), s.dv.dot(&s.dv)],
            second: s.second_form(n),
        }
    }
}

/// Unit normal; zero where the parametrisation collapses.
pub(super) fn unit_normal(jet: &SurfaceJet) -> Vec3 {
    let n = jet.normal();
    let size = jet.du.norm() * jet.dv.norm();
    if n.norm() > ROUNDING * size && size > 0.0 {
        n.normalize()
    } else {
        Vec3::zeros()
    }
}

/// Moves grid lines that are no knot lines onto corners of the trims that they nearly meet, or drops them where they
/// nearly meet several: corners are the definition of the face and stay where they are.
fn give_way(lines: &mut Vec<f64>, knots: &[f64], corners: impl Iterator<Item = f64> + Clone) {
    let (Some(&first), Some(&last)) = (lines.first(), lines.last()) else { return };
    let near = NEAR * (last - first);
    let mut kept = Vec::with_capacity(lines.len());
    for &l in lines.iter() {
        let mut close: Vec<f64> = corners.clone().filter(|c| (c - l).abs() <= near).collect();
        close.sort_by(f64::total_cmp);
        close.dedup();
        match close[..] {
            [] => kept.push(l),
            _ if knots.contains(&l) => kept.push(l),
            // The box ends where corners do: ends that were computed miss them by rounding.
            [c, ..] if l <= first => kept.push(c),
            [.., c] if l >= last => kept.push(c),
            [c] => kept.push(c),
            _ => {}
        }
    }
    kept.dedup();
    *lines = kept;
}

/// Share of the extent within which a grid line counts as meeting a corner.
const NEAR: f64 = 1e-7;

/// Grid lines of the first triangulation within the box `[u0, u1, v0, v1]`: every knot line, and between them
/// lines about equally spaced in space.
pub(super) fn grid_lines(s: &Surface, b: [f64; 4], strip: f64) -> (Vec<f64>, Vec<f64>) {
    const ISO: usize = 5;
    let breaks = |all: Vec<f64>, lo: f64, hi: f64| {
        let mut l: Vec<f64> = all.into_iter().filter(|&x| x > lo && x < hi).collect();
        l.insert(0, lo);
        l.push(hi);
        l
    };
    let (bu, bv) = (breaks(s.knots_u.breaks(), b[0], b[1]), breaks(s.knots_v.breaks(), b[2], b[3]));
    // Length of each knot interval: the largest over some iso-curves.
    let lengths = |own: &[f64], other: (f64, f64), point: &dyn Fn(f64, f64) -> Vec3| -> Vec<f64> {
        own.windows(2)
            .map(|w| {
                (0..ISO)
                    .map(|k| {
                        let c = other.0 + (other.1 - other.0) * k as f64 / (ISO - 1) as f64;
                        let pts: Vec<Vec3> = (0..=8).map(|i| point(w[0] + (w[1] - w[0]) * i as f64 / 8.0, c)).collect();
                        pts.windows(2).map(|p| (p[1] - p[0]).norm()).sum::<f64>()
                    })
                    .fold(0.0, f64::max)
            })
            .collect()
    };
    let lu = lengths(&bu, (b[2], b[3]), &|u, v| s.point(u, v));
    let lv = lengths(&bv, (b[0], b[1]), &|v, u| s.point(u, v));
    let (tu, tv) = (lu.iter().sum::<f64>().max(f64::MIN_POSITIVE), lv.iter().sum::<f64>().max(f64::MIN_POSITIVE));
    let mut h = (tu.max(tv) / CELLS as f64).min(strip / 6.0).max((tu * tv / MOST_CELLS as f64).sqrt());
    if !(h.is_finite() && h > 0.0) {
        h = 1.0;
    }
    let subdivide = |own: &[f64], len: &[f64]| {
        let mut out = vec![own[0]];
        for (w, l) in own.windows(2).zip(len) {
            let n = ((l / h).ceil() as usize).clamp(1, 4 * CELLS);
            for i in 1..=n {
                out.push(if i == n { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / n as f64 });
            }
        }
        out
    };
    (subdivide(&bu, &lu), subdivide(&bv, &lv))
}
