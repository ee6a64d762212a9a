//! What is seen of cone splines: the presentation with trimmed pieces, the bending into the plane, the surfaces of a
//! sheet with thickness.

use crate::answer::presentation::Presentation;
use crate::answer::Cones;
use crate::develop::cones::{bent, Bending};
use crate::draw::scene::{PanelShape, Scene};
use crate::fit::panels::cone_trim::{offset, ConeTrimError};
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::search::strips::cone_body::EDGE_ROUNDING;
use crate::tessellate::strip;
use crate::torse::cone::chart::share;
use crate::torse::cone::forms::patches;
use crate::torse::cone::part::ConeBody;
use crate::torse::cone::spline::SegmentFault;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Why a sheet cannot have a thickness.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ThicknessError {
    /// A thickness that is not positive.
    #[error("the thickness {0} is not a positive number of mm")]
    Thickness(f64),
    /// A piece that is bent too sharply.
    #[error("{name}, piece {piece}: half the thickness is {delta} mm, and {fault}; a thinner sheet would help")]
    Sharp {
        /// Name of the body.
        name: String,
        /// Number of the piece, from 1.
        piece: usize,
        /// The offset, mm.
        delta: f64,
        /// What is wrong.
        fault: SegmentFault,
    },
    /// A trimmed piece.
    #[error("{name}: {source}")]
    Trimmed {
        /// Name of the body.
        name: String,
        /// What is wrong.
        source: ConeTrimError,
    },
}

/// The chains at evenly spaced stages of their bending, from the shape in space to the plane: for every stage its share
/// in per cent and a scene whose panels have the same triangles throughout. The first ruling of every body stays.
///
/// *Guarantee*: vertices move isometrically (exact at every stage).
pub fn bending(cones: &Cones, shown: &Presentation, stages: usize) -> Vec<(String, Scene)> {
    let last = stages.max(2) - 1;
    // Coordinates on the segments, once.
    let mut places: Vec<(usize, usize, Vec<[f64; 2]>)> = Vec::new();
    for (shape, &(body, piece)) in shown.scene.panels.iter().zip(&cones.pieces) {
        let Some(b) = cones.bodies.get(body) else { continue };
        let index = b.part.as_ref().map_or(Some(piece), |p| p.faces.get(piece).map(|f| f.segment));
        let Some((index, s)) = index.and_then(|i| Some((i, b.spline.segments.get(i)?))) else { continue };
        let place = |p: &Vec3| {
            let f = share(s, p);
            let g = s.element(f);
            [f, (p - g.point).dot(&g.direction)]
        };
        places.push((body, index, shape.mesh.positions.iter().map(place).collect()));
    }
    (0..=last)
        .map(|k| {
            let stage = k as f64 / last as f64;
            let chains: Vec<_> = cones.bodies.iter().map(|b| bent(&b.spline, stage, Bending::Curvature)).collect();
            let panels = shown
                .scene
                .panels
                .iter()
                .zip(&places)
                .filter_map(|(shape, (body, index, places))| {
                    let s = chains.get(*body)?.segments.get(*index)?;
                    let mut mesh = shape.mesh.clone();
                    for (i, &[f, r]) in places.iter().enumerate() {
                        let g = s.element(f);
                        mesh.positions[i] = g.at(r);
                        mesh.normals[i] = g.normal;
                    }
                    Some(PanelShape { name: shape.name.clone(), mesh, marked: shape.marked, ..PanelShape::default() })
                })
                .collect();
            (format!("{} %", 100 * k / last), Scene { panels, ..Scene::default() })
        })
        .collect()
}

/// A direction from which both the shape in space and the plane that it bends into show: mostly along the normal of the
/// first ruling, which stays, on the side from which the model shows best.
pub fn bending_direction(cones: &Cones, shown: &Presentation) -> Vec3 {
    let first = cones.bodies.iter().flat_map(|b| b.spline.segments.first()).next();
    first.map_or(shown.direction, |s| {
        let g = &s.start;
        let side = if g.normal.dot(&shown.direction) < 0.0 { -1.0 } else { 1.0 };
        g.normal * (0.7 * side) + shown.direction * 0.4
    })
}

/// Inner, neutral and outer surface of sheets whose neutral surfaces are the bodies: exact offsets by half the
/// thickness (mm), against the normals and along them.
///
/// # Errors
/// A piece whose offset would reach its vertex.
pub fn thick(bodies: &[ConeBody], thickness: f64) -> Result<Vec<ConeBody>, ThicknessError> {
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Err(ThicknessError::Thickness(thickness));
    }
    let mut out = Vec::with_capacity(3 * bodies.len());
    for b in bodies {
        for (side, delta) in [("inner", -0.5 * thickness), ("neutral", 0.0), ("outer", 0.5 * thickness)] {
            let name = format!("{} {side}", b.name);
            let (spline, part) = match &b.part {
                None => {
                    let moved = b.spline.offset(delta).map_err(|(i, fault)| ThicknessError::Sharp {
                        name: b.name.clone(),
                        piece: i + 1,
                        delta,
                        fault,
                    })?;
                    (moved, None)
                }
                Some(part) => {
                    let moved = offset(part, delta, EDGE_ROUNDING)
                        .map_err(|source| ThicknessError::Trimmed { name: b.name.clone(), source })?;
                    (b.spline.clone(), Some(moved))
                }
            };
            out.push(ConeBody { name, spline, part });
        }
    }
    Ok(out)
}

/// Triangles of bodies, one shape for each; `marked` if they must not be cut.
pub fn scene(bodies: &[ConeBody], marked: bool) -> Scene {
    let mut scene = Scene::default();
    for b in bodies {
        let mut shape = PanelShape { name: b.name.clone(), marked, ..PanelShape::default() };
        let mut add = |mesh: &Mesh| {
            let from = shape.mesh.positions.len() as u32;
            shape.mesh.positions.extend(&mesh.positions);
            shape.mesh.normals.extend(&mesh.normals);
            shape.mesh.triangles.extend(mesh.triangles.iter().map(|t| t.map(|k| k + from)));
        };
        match &b.part {
            Some(part) => {
                part.faces.iter().for_each(|f| add(&f.mesh));
                shape.borders = part.outline().iter().map(|l| part.polyline(l)).collect();
            }
            None => {
                for patch in b.spline.segments.iter().filter_map(|s| patches(s).ok()).flatten() {
                    let strip = Strip { name: String::new(), kind: PanelKind::Cone, patch };
                    let (u, v) = strip::grid(&strip);
                    add(&strip::mesh(&strip, &u, &v, &[]));
                    shape.borders.push(strip::border_line(&strip));
                }
            }
        }
        scene.panels.push(shape);
    }
    scene
}
