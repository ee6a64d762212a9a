//! A trimmed face of the input model, ready for approximation.

use super::raw::{RawFace, SurfaceDeviation, SurfaceKind};
use super::support_surface::SupportSurface;
use crate::geom::placement::Placement;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use std::sync::Arc;

/// A face: a surface in B-spline form and a trimmed region of its parameter plane.
///
/// Whatever the file's representation was, `surface` is an exact (rational) B-spline of it in millimetres, in the
/// coordinates of the whole model (assembly placements applied), parametrised so that the region is one
/// connected polygon with holes inside the surface's domain: surfaces that close on themselves are cut along a seam.
///
/// # Example
/// ```
/// use torse::geom::{placement::Placement, Vec3};
/// let model = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let face = &model.faces[0];
/// assert!(face.loops.len() > 1, "an outline and holes");
/// let up = Placement { shift: Vec3::z() * 50.0, ..Placement::identity() };
/// let moved = face.placed(&up, "second copy");
/// let (a, b) = (torse::measure(&[moved]), torse::measure(&model.faces));
/// assert!((a[0].area_estimate - b[0].area_estimate).abs() < 1e-6 * b[0].area_estimate);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Face {
    /// Number of the entity in the file (`#123`).
    pub entity: u64,
    /// Name in the file; empty if it has none.
    pub name: String,
    /// Name of the part (product) that the face belongs to; empty if unknown.
    pub part: String,
    /// Body that the face belongs to: faces of one solid, or of the sheets of one occurrence of a part, have one number;
    /// 0 if unknown.
    pub body: u32,
    /// Kind of the surface in the file.
    pub kind: SurfaceKind,
    /// The surface, mm.
    pub surface: Surface,
    /// Whether the face's normal is −S_u × S_v.
    pub reversed: bool,
    /// Outer loop first (counter-clockwise in the parameter plane), then holes (clockwise).
    pub loops: Vec<TrimLoop>,
    /// Distance (mm) between the file's edge curves and the polygons' images, measured at samples.
    pub trim_deviation_estimate: f64,
    /// The faces of the file that were joined to this one; empty for a face of the file.
    pub parts: Vec<FacePart>,
    /// How far `surface` is from that of the file: see [`Face::surface_bound`].
    pub(super) surface_deviation: SurfaceDeviation,
    /// See [`Face::joint_bound`].
    pub(super) joint_bound: f64,
    /// See [`Face::trim_bound`].
    pub(super) trim_bound: f64,
    /// The file's edges, for that proof; `None` where there is nothing to prove.
    pub boundary: Option<Arc<FileBoundary>>,
}

/// The boundary of a face as its file gives it, and what of it each side of the trim follows.
#[derive(Clone, Debug)]
pub struct FileBoundary {
    /// The edges, loop by loop, in order and in the direction of the loop.
    pub loops: Vec<Vec<FileEdge>>,
    /// For every loop of the face and every side of it: where along its edge it begins and ends. A place is the number of
    /// a piece and the share of its parameters; 0 and 0 on sides that the reader added.
    pub along: Vec<Vec<[f64; 2]>>,
    /// Distance (mm) that chords were allowed to keep from the edges.
    pub chords: f64,
    /// What the face was made from: see [`super::trim::with_chords`].
    pub(super) source: Arc<RawFace>,
    /// Number of the face among those made from the source, and how many these are.
    pub(super) index: [usize; 2],
    /// Where the source was placed since.
    pub(super) placement: Placement,
}

/// The label of edges that are shorter than a point: no side has it.
pub(crate) const VANISHED: u32 = u32::MAX;

/// An edge of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileEdge {
    /// Number of the entity in the file.
    pub entity: u64,
    /// The label of its sides in [`TrimLoop::edge`].
    pub label: u32,
    /// Its curve in pieces; `None` if it has no spline form (curves given in a parameter plane only).
    pub pieces: Option<Vec<FilePiece>>,
}

/// A piece of an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct FilePiece {
    /// The curve, homogeneous, mm.
    pub curve: Curve<4>,
    /// Parameter where the loop enters the piece.
    pub from: f64,
    /// Parameter where it leaves it; less than `from` if the loop runs against the curve.
    pub to: f64,
}

impl FileBoundary {
    /// The boundary where `placement` puts it.
    fn placed(&self, placement: &Placement) -> Self {
        let mut out = self.clone();
        out.placement = placement.after(&self.placement);
        out.chords *= placement.scale();
        let pieces = out.loops.iter_mut().flatten().filter_map(|e| e.pieces.as_mut()).flatten();
        for h in pieces.flat_map(|p| &mut p.curve.control) {
            let p = placement.linear * crate::geom::Vec3::new(h[0], h[1], h[2]) + placement.shift * h[3];
            *h = [p.x, p.y, p.z, h[3]];
        }
        out
    }
}

/// A face of the file that is part of a joined face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FacePart {
    /// Number of the entity in the file.
    pub entity: u64,
    /// Name in the file; empty if it has none.
    pub name: String,
}

/// A closed polygon of the parameter plane: the definition of the trim from here on.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimLoop {
    /// Corners (u, v); the last is joined to the first, which is not repeated.
    pub points: Vec<[f64; 2]>,
    /// For the side from `points[i]` to `points[i + 1]`: number of the file's edge that it belongs to, counted
    /// within the face; sides along a seam that the reader cut have numbers of their own.
    pub edge: Vec<u32>,
}

/// A distance as it is; infinite if it is none.
fn distance(bound: f64) -> f64 {
    if bound >= 0.0 {
        bound
    } else {
        f64::INFINITY
    }
}

impl Face {
    /// Radius (mm) of the cylinder that the file says the face lies on; `None` where it says no such thing, and of joined faces.
    pub fn cylinder_radius(&self) -> Option<f64> {
        let boundary =
            self.boundary.as_ref().filter(|_| self.parts.is_empty() && self.kind == SurfaceKind::Cylinder)?;
        let SupportSurface::Cylinder { radius, .. } = boundary.source.support else { return None };
        // Placements keep angles.
        Some(radius * boundary.placement.linear.column(0).norm())
    }

    /// The face that covers the whole domain of a surface.
    pub fn untrimmed(surface: Surface) -> Self {
        let ((u0, u1), (v0, v1)) = surface.domain();
        Self {
            entity: 0,
            name: String::new(),
            part: String::new(),
            body: 0,
            kind: SurfaceKind::Spline,
            surface,
            reversed: false,
            loops: vec![TrimLoop { points: vec![[u0, v0], [u1, v0], [u1, v1], [u0, v1]], edge: vec![0, 1, 2, 3] }],
            trim_deviation_estimate: 0.0,
            surface_deviation: SurfaceDeviation::NONE,
            parts: Vec::new(),
            joint_bound: 0.0,
            trim_bound: 0.0,
            boundary: None,
        }
    }

    /// Bound (mm) on the distance between points of the faces that were joined and the same points of `surface`: what
    /// joining moved. 0 for a face of the file, infinite where nothing is known.
    pub fn joint_bound(&self) -> f64 {
        self.joint_bound
    }

    /// Bound (mm) on the distance between the file's surface and `surface`: 0 where they are the same, infinite where it was
    /// only measured. Part of the bound that [`Face::trim_bound`] states.
    pub fn surface_bound(&self) -> f64 {
        self.surface_deviation.bound
    }

    /// Distance (mm) between the file's surface and `surface` as seen at samples; 0 where they are the same.
    pub fn surface_deviation_estimate(&self) -> f64 {
        self.surface_deviation.estimate
    }

    /// Bound (mm) on the distance between the face as its file bounds it and the region of the polygons: what the trim
    /// misses, and what the surface is off. Infinite until it is proven (by `certify::trims`); 0 where the polygons are the file's own boundary.
    pub fn trim_bound(&self) -> f64 {
        self.trim_bound
    }

    /// States what joining moved, mm. What is no distance (negative, NaN) is no bound: infinite.
    pub(crate) fn set_joint_bound(&mut self, bound: f64) {
        self.joint_bound = distance(bound);
    }

    /// States what the trim misses, mm. What is no distance (negative, NaN) is no bound: infinite.
    pub(crate) fn set_trim_bound(&mut self, bound: f64) {
        self.trim_bound = distance(bound);
    }

    /// The face where `placement` puts it; `part` names the part there.
    pub fn placed(&self, placement: &Placement, part: &str) -> Self {
        let mut out = self.clone();
        out.part = part.to_string();
        if *placement == Placement::identity() {
            return out;
        }
        out.surface.place(placement);
        out.reversed = self.reversed != placement.reflects();
        out.trim_deviation_estimate *= placement.scale();
        out.surface_deviation = out.surface_deviation.scaled(placement.scale());
        out.joint_bound *= placement.scale();
        out.trim_bound *= placement.scale();
        out.boundary = self.boundary.as_ref().map(|b| Arc::new(b.placed(placement)));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;

    #[test]
    fn what_is_no_distance_is_no_bound() {
        let k = Knots::new(1, vec![0., 0., 1., 1.], 2).expect("knots");
        let p = [Vec3::zeros(), Vec3::y(), Vec3::x(), Vec3::x() + Vec3::y()];
        let mut face = Face::untrimmed(Surface::new(k.clone(), k, &p, None).expect("surface"));
        for (given, kept) in [(0.25, 0.25), (0.0, 0.0), (-1e-3, f64::INFINITY), (f64::NAN, f64::INFINITY)] {
            face.set_trim_bound(given);
            face.set_joint_bound(given);
            assert_eq!((face.trim_bound(), face.joint_bound()), (kept, kept), "{given}");
        }
    }
}
