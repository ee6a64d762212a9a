//! Ruled strips over a face: what of it is saddle-shaped, the few strips that do, their proof.
//!
//! *Method* \[W15, 2C\]; page `docs/algorithms/ruled.md`.

mod joins;
pub(crate) mod left_out;
pub(crate) mod region;
mod strips;

use super::build::{build, Built};
use super::cover::{exactly_covered, Cover, CoverOptions};
use crate::brep::face::Face;
use crate::certify::{self, Certificate};
use crate::control::Control;
use crate::fit::panels::boundary::panel_name;
use crate::fit::ruled::directions::Curvatures;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Panel, Patchwork};
use crate::patchwork::partition::Partition;
use crate::patchwork::triangulate::TriangulateError;
use left_out::LeftOut;
use region::{pieces, FacePiece};
use strips::{Found, PlannedPiece};

pub use strips::RuledOptions;

/// A face with its strips.
pub(crate) struct RuledFace {
    /// The parts of the face that have strips, and the strips.
    pub patchwork: Patchwork,
    /// Their proof; `None` where there are no strips.
    pub certificate: Option<Certificate>,
    /// What has no strips, and why, with its area in mm².
    pub left: Vec<(LeftOut, f64)>,
    /// The face coloured by curvature: −1 on saddles, 1 where it bends to one side, in between near zero.
    pub map: Mesh,
    /// Direction to which the rulings of every conoidal strip are square, panel by panel; empty without.
    pub directing: Vec<Option<Vec3>>,
    /// Greatest angle (rad) between strips of different pieces where they meet, sampled.
    pub kink_estimate: f64,
}

/// Strips are fitted to these shares of the tolerance, one after the other, until the proof holds.
const SHARES: [f64; 3] = [0.93, 0.75, 0.5];

/// Times that a piece without proven strips is cut in two.
const DIVISIONS: usize = 5;
/// Cuts after which rulings may follow parameter lines.
const ANY: usize = 3;

/// Ruled strips over one face, judged.
///
/// # Errors
/// Trim loops that cannot be triangulated.
pub(crate) fn ruled_face(
    first: usize,
    face: &Face,
    options: &RuledOptions,
    control: &Control,
) -> Result<RuledFace, TriangulateError> {
    if let Some(done) = straight(first, face, options, control) {
        return Ok(done);
    }
    let rest = options.tolerance - face.joint_bound() - face.trim_bound();
    // What trims miss may be all of the tolerance, or unknown: then strips are for the eye.
    let aim = if rest > 0.5 * options.tolerance { rest } else { options.tolerance };
    let cover = Cover::on_lines(face, region::lines(face, 0, aim), region::lines(face, 1, aim))?;
    let map = curvature_map(face, &cover.partition);
    let (pieces, mut left) = pieces(cover, aim);
    let whole: f64 = pieces.iter().map(|p| p.area).sum();
    let mut done = 0.0;
    let mut out = Patchwork::default();
    let mut certificates = Vec::new();
    let mut directing = Vec::new();
    let mut open: Vec<(FacePiece, usize)> = pieces.into_iter().rev().map(|p| (p, 0)).collect();
    while let Some((piece, depth)) = open.pop() {
        control.report("ruled strips", done / whole, format!("{} panels", out.panels.len()));
        let index = first + out.faces.len();
        let result = match assessed(index, &piece, (depth >= ANY, options), aim, control) {
            Ok((found, certificate)) if certificate.certified => Ok((found, certificate)),
            other => match piece.divided(depth).filter(|_| depth < DIVISIONS && !control.stopped()) {
                Some(parts) => {
                    open.extend(parts.into_iter().map(|p| (p, depth + 1)));
                    continue;
                }
                None => other,
            },
        };
        done += piece.area;
        match result {
            // Strips of which nothing is known take the bound of all others away. Where nothing is known of the trims, none has one.
            Ok((_, certificate)) if rest.is_finite() && !certificate.deviation_bound.is_finite() => {
                left.push((LeftOut::Unbounded { around: piece.around() }, piece.area));
            }
            Ok((found, certificate)) => {
                directing.extend(found.directing);
                out.append(found.patchwork);
                certificates.push(certificate);
            }
            Err(reason) => left.push((reason, piece.area)),
        }
    }
    let any = !certificates.is_empty();
    let certificate = any.then(|| certify::join_pieces(&out, certificates, options.tolerance));
    let kink_estimate = joins::kink_estimate(&out);
    Ok(RuledFace { patchwork: out, certificate, left, map, directing, kink_estimate })
}

/// One piece with fewer or more strips, until the proof holds; else the try that looked best. `any`: rulings may follow
/// parameter lines.
fn assessed(
    index: usize,
    piece: &FacePiece,
    (any, options): (bool, &RuledOptions),
    aim: f64,
    control: &Control,
) -> Result<(Found, Certificate), LeftOut> {
    // As in the main job the proof has its own clock.
    let prove = |found: &Found| certify::patchwork(&found.patchwork, options.tolerance, &Control::default());
    let mut planned = PlannedPiece::new(piece, options, any, control)?;
    let mut best: Option<(Found, Option<Certificate>)> = None;
    for share in SHARES {
        if control.stopped() && best.is_some() {
            break;
        }
        let mut found = match planned.strips(share * aim, aim, control) {
            Ok(found) => found,
            Err(reason) if best.is_none() => return Err(reason),
            Err(_) => break,
        };
        for (k, panel) in found.patchwork.panels.iter_mut().enumerate() {
            panel.strip.name = panel_name(index, k);
        }
        // A look at samples spares proofs that cannot hold.
        let certificate = (found.distance_estimate <= aim).then(|| prove(&found));
        if let Some(certificate) = certificate.as_ref().filter(|c| c.certified) {
            return Ok((found, certificate.clone()));
        }
        if best.as_ref().is_none_or(|b| found.distance_estimate < b.0.distance_estimate) {
            best = Some((found, certificate));
        }
    }
    let (found, certificate) = best.ok_or_else(|| LeftOut::Stopped { around: piece.around() })?;
    let certificate = certificate.unwrap_or_else(|| prove(&found));
    Ok((found, certificate))
}

/// A developable face as strips on its own rulings, proven as in the main job; `None` for other faces, where a ruling is longer
/// than asked for or the proof fails, and for conoidal strips.
fn straight(first: usize, face: &Face, options: &RuledOptions, control: &Control) -> Option<RuledFace> {
    /// Rulings that are looked at for their length.
    const LOOKS: usize = 64;
    if options.conoidal {
        return None;
    }
    let cover = exactly_covered(face, &CoverOptions::new(options.tolerance), control)?;
    let Built { patchwork, certificate, .. } = build(first, &cover, options.tolerance).0;
    let longest = |panel: &Panel| {
        let clipped = ClippedRulings::new(panel);
        let (a, b) = clipped.range();
        let at = |k: usize| a + (b - a) * (k as f64 + 0.5) / LOOKS as f64;
        let ends = (0..LOOKS).flat_map(|k| clipped.at(at(k)).into_iter().map(move |r| (at(k), r)));
        let length =
            |(s, (t, r)): (f64, (f64, f64))| (panel.strip.patch.point(s, r) - panel.strip.patch.point(s, t)).norm();
        ends.map(length).fold(0.0, f64::max)
    };
    let narrow = options.width.is_none_or(|w| patchwork.panels.iter().all(|p| longest(p) <= w));
    (certificate.certified && narrow).then(|| RuledFace {
        map: curvature_map(face, &patchwork.partitions[0]),
        directing: vec![None; patchwork.panels.len()],
        patchwork,
        certificate: Some(certificate),
        left: Vec::new(),
        kink_estimate: 0.0,
    })
}

/// The sign of the Gauss curvature all over a face, steep near its change.
fn curvature_map(face: &Face, partition: &Partition) -> Mesh {
    let size = face.surface.bbox().diagonal();
    let mut mesh = Mesh { triangles: partition.triangles.clone(), ..Mesh::default() };
    for [u, v] in &partition.vertices {
        let j = face.surface.jet(*u, *v);
        let n = j.normal().try_normalize(0.0).unwrap_or_default();
        mesh.positions.push(j.p);
        mesh.normals.push(if face.reversed { -n } else { n });
        let value = Curvatures::of(&j).map_or(0.0, |c| region::shade(&c, size));
        mesh.values.push(value);
    }
    mesh
}
