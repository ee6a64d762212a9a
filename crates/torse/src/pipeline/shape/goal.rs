//! Surfaces that strips should be near, for solving and for the proof.

use crate::brep::face::Face;
use crate::constraint::reference::{FaceReference, PointReference, Reference};
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::shape::TargetRecord;
use crate::io::{cloud, step};
use crate::search::trims::trims_judged;
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
            return Ok(Self::Faces(trims_judged(model.faces, tolerance).faces));
        }
        let read = |unit| cloud::read_noted(file, &bytes, unit).map_err(|e| e.to_string());
        Ok(Self::Cloud(match read(None)? {
            (_, Some(_)) => read(Some(unit))?.0,
            (cloud, None) => cloud,
        }))
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
