//! The composite that a job's file describes.

use super::given::{given, Taken};
use super::goal::Goal;
use super::options::ShapeError;
use crate::constraint::border::Border;
use crate::design::composite::{
    BoundaryCurve, Composite, Edge, Facet, Handle, Hold, Join, Length, Place, RuledStrip, Smoothness, Strength,
    StripShape, Target,
};
use crate::geom::Vec3;
use crate::io::shape::{
    EdgeKind, HandleRecord, JoinRecord, PlaceRecord, PlaneRecord, ShapeFile, Smooth, StripRecord, TargetRecord,
};
use crate::spline::curve::Curve;
use std::sync::Arc;

/// The composite that a file describes, with what its targets are and what was taken over; `tolerance` (mm) is that of the job.
pub(super) fn composite(
    job: &ShapeFile,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    tolerance: f64,
) -> Result<(Composite, Vec<Goal>, Taken), ShapeError> {
    let strip = |s: &StripRecord| RuledStrip {
        name: s.name.clone(),
        sides: s.sides.clone(),
        shape: match (s.planar, s.ruled) {
            (true, _) => StripShape::Planar,
            (_, true) => StripShape::Ruled,
            _ => StripShape::Developable { margin: s.margin },
        },
    };
    let curve = |(name, curve, fixed): &(String, Curve<3>, bool)| BoundaryCurve {
        name: name.clone(),
        curve: curve.clone(),
        fixed: *fixed,
    };
    let facet = |f: &crate::io::shape::FacetRecord| Facet {
        name: f.name.clone(),
        corners: f.corners.iter().map(place).collect(),
        alpha: f.alpha,
    };
    let (mut goals, mut targets) = (Vec::new(), Vec::new());
    for (index, t) in job.targets.iter().enumerate() {
        let wrong = |reason| ShapeError::Target { index, reason };
        let goal = Goal::read(t, job.unit, load, tolerance).map_err(wrong)?;
        targets.push(target(t, &goal, tolerance).map_err(wrong)?);
        goals.push(goal);
    }
    // Items of the file itself come first: errors name them by their indices.
    let given = given(job, load, tolerance)?;
    let composite = Composite {
        curves: job.curves.iter().map(curve).chain(given.curves).collect(),
        strips: job.strips.iter().map(strip).chain(given.strips).collect(),
        facets: job.facets.iter().map(facet).collect(),
        joins: job.joins.iter().filter_map(join).chain(given.joins).collect(),
        handles: job.handles.iter().filter_map(handle).collect(),
        lengths: job
            .lengths
            .iter()
            .map(|l| Length { between: [place(&l.between[0]), place(&l.between[1])], length: l.length })
            .collect(),
        targets,
    };
    Ok((composite, goals, given.taken))
}

fn place(p: &PlaceRecord) -> Place {
    Place { curve: p.curve.clone(), u: p.u }
}

fn target(t: &TargetRecord, goal: &Goal, tolerance: f64) -> Result<Target, String> {
    let border = t.covered.then(|| Border::new(goal.border(tolerance)).map(Arc::new)).flatten();
    Ok(Target { strips: t.strips.clone(), reference: goal.reference()?, border, weight: t.weight })
}

fn join(j: &JoinRecord) -> Option<Join> {
    let smoothness = match j.smoothness {
        Some(Smooth::G0) => Smoothness::G0,
        Some(Smooth::G2) => Smoothness::G2,
        Some(Smooth::C1) => Smoothness::C1 { ratio: j.ratio.unwrap_or(1.0) },
        Some(Smooth::G1) | None => Smoothness::G1,
    };
    if let Some([p, q]) = &j.ends {
        return Some(Join::Ends { ends: [place(p), place(q)], smoothness });
    }
    match (&j.ruling, &j.curve, j.edge) {
        (Some([first, second]), ..) => Some(Join::Ruling { first: first.clone(), second: second.clone(), smoothness }),
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
    let turn = |a: &Vec3, b: &Vec3| mix(&a.normalize(), &b.normalize());
    match (from, to) {
        (Hold::Point(a), Hold::Point(b)) => Hold::Point(mix(a, b)),
        (Hold::Tangent(a), Hold::Tangent(b)) => Hold::Tangent(turn(a, b)),
        (Hold::Plane { point: a, normal: n }, Hold::Plane { point: b, normal: m }) => {
            // Turned round, a normal is one of the same plane.
            let m = if n.dot(m) < 0.0 { -m } else { *m };
            Hold::Plane { point: mix(a, b), normal: turn(n, &m) }
        }
        _ => *to,
    }
}

/// Cosine of the angle between directions that are opposite: there is no telling which way round one turns to the other.
const OPPOSITE: f64 = -1.0 + 1e-9;

/// Whether a hold is the direction opposite to another.
pub(super) fn opposite(from: &Hold, to: &Hold) -> bool {
    matches!((from, to), (Hold::Tangent(a), Hold::Tangent(b)) if a.normalize().dot(&b.normalize()) <= OPPOSITE)
}
