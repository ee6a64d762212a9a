//! Surfaces that strips should be near, for solving and for the proof.

use crate::brep::face::{Face, TrimLoop};
use crate::constraint::border::Border;
use crate::constraint::reference::{FaceReference, PointReference, Reference};
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::shape::TargetRecord;
use crate::io::{cloud, step};
use crate::search::trims::assess_trims;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a target is.
pub(super) enum Goal {
    /// Faces of a CAD file.
    Faces(Vec<Face>),
    /// Points, with triangles between them or without.
    Cloud(Cloud),
}

impl Goal {
    /// The surface that a target names; `unit` (mm) is that of files that do not say theirs, `tolerance` (mm) that of the job.
    pub fn read(
        t: &TargetRecord,
        unit: f64,
        load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
        tolerance: f64,
    ) -> Result<Self, String> {
        let Some(file) = &t.file else {
            let places = t.points.iter().map(|p| Vec3::from(*p)).collect();
            return Ok(Self::Cloud(Cloud { points: places, triangles: t.triangles.clone() }));
        };
        let bytes = load(file)?;
        let lower = file.to_ascii_lowercase();
        if lower.ends_with(".step") || lower.ends_with(".stp") {
            let model = step::read::read(&bytes).map_err(|e| e.to_string())?;
            if model.faces.is_empty() {
                return Err(format!("{file} holds no face that can be read"));
            }
            return Ok(Self::Faces(assess_trims(model.faces, tolerance).faces));
        }
        let read = |unit| cloud::read_noted(file, &bytes, unit).map_err(|e| e.to_string());
        Ok(Self::Cloud(match read(None)? {
            (_, Some(_)) => read(Some(unit))?.0,
            (cloud, None) => cloud,
        }))
    }

    /// The lines at which it ends, in straight pieces: sides of one triangle, outer loops of faces where no other face goes on
    /// within `tolerance` (mm). Points without triangles have none.
    pub fn border(&self, tolerance: f64) -> Vec<[Vec3; 2]> {
        match self {
            Self::Cloud(cloud) => {
                let sides = cloud.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
                let mut uses: BTreeMap<[u32; 2], usize> = BTreeMap::new();
                sides.for_each(|[a, b]| *uses.entry([a.min(b), a.max(b)]).or_default() += 1);
                let place = |i: u32| cloud.points.get(i as usize).copied();
                let once = uses.into_iter().filter(|u| u.1 == 1);
                once.filter_map(|([a, b], _)| Some([place(a)?, place(b)?])).collect()
            }
            Self::Faces(faces) => {
                let each: Vec<Vec<[Vec3; 2]>> = faces.iter().map(outline).collect();
                let lines: Vec<Option<Border>> = each.iter().map(|e| Border::new(e.clone())).collect();
                let alone = |k: usize, [p, q]: &[Vec3; 2]| {
                    let middle = 0.5 * (p + q);
                    let near = |b: &Option<Border>| b.as_ref().is_some_and(|b| b.distance(&middle) <= tolerance);
                    !lines.iter().enumerate().any(|(j, b)| j != k && near(b))
                };
                let kept = |(k, e): (usize, Vec<[Vec3; 2]>)| e.into_iter().filter(move |s| alone(k, s));
                each.into_iter().enumerate().flat_map(kept).collect()
            }
        }
    }

    /// For solving: nearest points with their curvatures.
    pub fn reference(&self) -> Result<Arc<dyn Reference>, String> {
        match self {
            Self::Faces(faces) => Ok(Arc::new(FaceReference::new(faces.iter().map(|f| f.surface.clone()).collect()))),
            Self::Cloud(cloud) => match PointReference::new(cloud.clone()) {
                Some(p) => Ok(Arc::new(p)),
                None => Err("it has no points, or triangles between points that are not there".into()),
            },
        }
    }
}

/// The outer loop of a face in space, in straight pieces.
fn outline(face: &Face) -> Vec<[Vec3; 2]> {
    let twice_area = |l: &TrimLoop| -> f64 {
        let n = l.points.len();
        (0..n).map(|k| l.points[k][0] * l.points[(k + 1) % n][1] - l.points[(k + 1) % n][0] * l.points[k][1]).sum()
    };
    let outer = face.loops.iter().max_by(|a, b| twice_area(a).abs().total_cmp(&twice_area(b).abs()));
    let Some(outer) = outer else { return Vec::new() };
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let n = outer.points.len();
    let side = |k: usize| {
        let (a, b) = (outer.points[k], outer.points[(k + 1) % n]);
        let share = ((b[0] - a[0]) / (u1 - u0)).abs().max(((b[1] - a[1]) / (v1 - v0)).abs());
        let parts = ((share * PIECES).ceil() as usize).clamp(1, PIECES as usize);
        let at = move |i: usize| {
            let t = i as f64 / parts as f64;
            face.surface.point(a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t)
        };
        (0..parts).map(move |i| [at(i), at(i + 1)])
    };
    (0..n).flat_map(side).collect()
}

/// Straight pieces over the whole domain of a face.
const PIECES: f64 = 64.0;
