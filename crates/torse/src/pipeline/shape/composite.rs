//! The composite that a job's file describes.

use super::options::ShapeError;
use crate::constraint::reference::{FaceReference, PointReference, Reference};
use crate::design::composite::{
    BoundaryCurve, Composite, Edge, Handle, Hold, Join, Length, Place, RuledStrip, Smoothness, Strength, StripShape,
    Target,
};
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::shape::{EdgeKind, HandleRecord, JoinRecord, PlaneRecord, ShapeFile, Smooth, TargetRecord};
use crate::io::{cloud, step};
use crate::spline::curve::Curve;
use std::sync::Arc;

/// The composite that a file describes.
pub(super) fn composite(
    job: &ShapeFile,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Composite, ShapeError> {
    let place = |p: &crate::io::shape::PlaceRecord| Place { curve: p.curve.clone(), u: p.u };
    let strip = |s: &crate::io::shape::StripRecord| RuledStrip {
        name: s.name.clone(),
        sides: s.sides.clone(),
        shape: if s.planar { StripShape::Planar } else { StripShape::Developable { margin: s.margin } },
    };
    let curve = |(name, curve, fixed): &(String, Curve<3>, bool)| BoundaryCurve {
        name: name.clone(),
        curve: curve.clone(),
        fixed: *fixed,
    };
    let target = |(index, t): (usize, &TargetRecord)| {
        let reference = reference(t, load).map_err(|reason| ShapeError::Target { index, reason })?;
        Ok(Target { strips: t.strips.clone(), reference, weight: t.weight })
    };
    Ok(Composite {
        curves: job.curves.iter().map(curve).collect(),
        strips: job.strips.iter().map(strip).collect(),
        joins: job.joins.iter().filter_map(join).collect(),
        handles: job.handles.iter().filter_map(handle).collect(),
        lengths: job
            .lengths
            .iter()
            .map(|l| Length { between: [place(&l.between[0]), place(&l.between[1])], length: l.length })
            .collect(),
        targets: job.targets.iter().enumerate().map(target).collect::<Result<_, ShapeError>>()?,
    })
}

fn join(j: &JoinRecord) -> Option<Join> {
    match (&j.ruling, &j.curve, j.edge) {
        (Some([first, second]), ..) => {
            let smoothness = match j.smoothness {
                Some(Smooth::G0) => Smoothness::G0,
                Some(Smooth::G2) => Smoothness::G2,
                Some(Smooth::G1) | None => Smoothness::G1,
            };
            Some(Join::Ruling { first: first.clone(), second: second.clone(), smoothness })
        }
        (None, Some(curve), Some(edge)) => {
            let edge = if edge == EdgeKind::Fold { Edge::Fold } else { Edge::Smooth };
            Some(Join::Curve { curve: curve.clone(), edge })
        }
        _ => None,
    }
}

fn handle(h: &HandleRecord) -> Option<Handle> {
    Some(Handle {
        place: Place { curve: h.curve.clone(), u: h.u },
        hold: held(h.point, h.tangent, h.plane)?,
        strength: h.pull.map_or(Strength::Exact, Strength::Pull),
    })
}

pub(super) fn held(point: Option<[f64; 3]>, tangent: Option<[f64; 3]>, plane: Option<PlaneRecord>) -> Option<Hold> {
    let plane = plane.map(|p| Hold::Plane { point: p.point.into(), normal: p.normal.into() });
    point.map(|p| Hold::Point(p.into())).or(tangent.map(|t| Hold::Tangent(t.into()))).or(plane)
}

/// A hold on the way from one to another of its kind; of two kinds, the other.
pub(super) fn between(from: &Hold, to: &Hold, share: f64) -> Hold {
    let mix = |a: &Vec3, b: &Vec3| a + (b - a) * share;
    let turn = |a: &Vec3, b: &Vec3| a.normalize() + (b.normalize() - a.normalize()) * share;
    match (from, to) {
        (Hold::Point(a), Hold::Point(b)) => Hold::Point(mix(a, b)),
        (Hold::Tangent(a), Hold::Tangent(b)) => Hold::Tangent(turn(a, b)),
        (Hold::Plane { point: a, normal: n }, Hold::Plane { point: b, normal: m }) => {
            Hold::Plane { point: mix(a, b), normal: turn(n, m) }
        }
        _ => *to,
    }
}

/// The surface that a target names.
fn reference(t: &TargetRecord, load: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> Result<Arc<dyn Reference>, String> {
    let points = |cloud: Cloud| -> Result<Arc<dyn Reference>, String> {
        match PointReference::new(cloud) {
            Some(p) => Ok(Arc::new(p)),
            None => Err("it has no points, or triangles between points that are not there".into()),
        }
    };
    let Some(file) = &t.file else {
        let places = t.points.iter().map(|p| Vec3::from(*p)).collect();
        return points(Cloud { points: places, triangles: t.triangles.clone() });
    };
    let bytes = load(file)?;
    let lower = file.to_ascii_lowercase();
    if lower.ends_with(".step") || lower.ends_with(".stp") {
        let model = step::read::read(&bytes).map_err(|e| e.to_string())?;
        if model.faces.is_empty() {
            return Err(format!("{file} holds no face that can be read"));
        }
        return Ok(Arc::new(FaceReference::new(model.faces.into_iter().map(|f| f.surface).collect())));
    }
    points(cloud::read(file, &bytes, None).map_err(|e| e.to_string())?)
}
