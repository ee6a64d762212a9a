//! A body as flat parts: sheet recognised, the better skin unfolded, drawn.

use super::bends::{bends, SheetBend};
use super::joints::{shared_edges, SharedEdge};
use super::outline::{joint, outlines, placed_strips, strip_joints, Outline};
use super::placed_face::{region, FaceRegion, PlacedChart, PlacedFace};
use super::region::POINT;
use super::sheet::{open, sheet, BodySheet, SheetError, ALIKE};
use super::tree::{unfold, Cut, CutReason, Joins, UnfoldOptions, UnfoldedPiece};
use super::{allowance::KFactor, outline::contour_area};
use crate::brep::body::{oriented, Body};
use crate::brep::face::Face;
use crate::brep::recognised_surface::RecognisedSurface;
use crate::develop::arcs::rectangle_around;
use crate::develop::bends::BendSpacing;
use crate::develop::shop::thickness::Sheet as GivenSheet;
use crate::geom::segment::same_segment;
use crate::num::parallel;
use crate::patchwork::image::{ClosedMap, JointImage, MapStrip, Stroke};
use crate::patchwork::pattern::{Pattern, ViewSide};
use crate::reason::Unlaid;
use std::collections::HashSet;

/// What is known of the sheet that a part is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SheetPart {
    /// Thickness, mm; 0 for surfaces.
    pub thickness: f64,
    /// Thickness at every face of the part, mm: another one where faces that go on smoothly are thinned.
    pub local: Vec<f64>,
    /// Where the neutral fibre lies, which is drawn.
    pub k: KFactor,
    /// The sheet that surfaces were given, if its neutral fibre is drawn.
    pub given: Option<GivenSheet>,
    /// Its bends.
    pub bends: Vec<SheetBend>,
    /// Of every face of the part whether its outside is the other side than its file says.
    pub turned: Vec<bool>,
}

/// A flat part.
#[derive(Clone, Debug)]
pub(crate) struct FlatPart {
    /// The drawing, seen from outside the skin that was unfolded; `panel` is for the caller.
    pub pattern: Pattern,
    /// Thickness and bends.
    pub sheet: SheetPart,
    /// Indices (among the faces given) of the skin faces that it is made of; the first is the root.
    pub faces: Vec<usize>,
    /// Entity numbers of edges of the file that were cut to lay it flat, with the reason.
    pub cuts: Vec<(u64, CutReason)>,
    /// What every line and arc of the outlines is drawn for.
    pub strokes: Vec<Stroke>,
    /// Both images of edges inside the part.
    pub joints: Vec<JointImage>,
    /// The map of every face; `None` where it has no closed form.
    pub maps: Vec<Option<ClosedMap>>,
    /// Strips of every face that has no closed form but is laid flat in strips that have; else none.
    pub strips: Vec<Vec<MapStrip>>,
    /// Ways (mm) by which faces are apart in the plane along sharp bends.
    pub allowances: Vec<f64>,
    /// Entity numbers of sides of the sheet beside it that are not square to it.
    pub slanting: Vec<u64>,
    /// The map of every face, whether it has a closed form or not.
    pub places: Vec<PlacedChart>,
    /// The region of every face in the pattern, in the order of `places`.
    pub regions: Vec<FaceRegion>,
    /// Edges that it shares with itself or a later part of its body; parts are counted within the body.
    pub shared: Vec<SharedEdge>,
}

impl FlatPart {
    /// A face of the part, among the faces given, as it looks out of the sheet, whichever way its file says: the side whose flat image is
    /// drawn.
    pub(crate) fn outside_of(&self, k: usize, faces: &[Face]) -> Face {
        let face = &faces[self.faces[k]];
        if self.sheet.turned.get(k) == Some(&true) {
            turned_over(face)
        } else {
            face.clone()
        }
    }

    /// Its faces where they lie, which it has no more after that.
    pub(crate) fn take_faces(&mut self) -> Vec<PlacedFace> {
        let (places, regions) = (std::mem::take(&mut self.places), std::mem::take(&mut self.regions));
        places.into_iter().zip(regions).map(|(placed, region)| PlacedFace { placed, region }).collect()
    }
}

/// The parts of one body.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyParts {
    /// The parts; empty if there are none, then `left` says why.
    pub parts: Vec<FlatPart>,
    /// Faces left out with the reason: index among the faces given, `None` for the body as a whole.
    pub left: Vec<(Option<usize>, Unlaid)>,
}

/// How bodies are laid flat.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartOptions {
    /// Distance (mm) between contours drawn and exact outlines; no default.
    pub tolerance: f64,
    /// Where the neutral fibre lies; default 0.44 (ANSI).
    pub k: KFactor,
    /// Takes all faces as surfaces without thickness; default false.
    pub surfaces: bool,
    /// The sheet that surfaces without thickness are made of, whose neutral fibre is laid flat; default none.
    pub sheet: Option<GivenSheet>,
    /// How far apart lines of rolled faces are drawn, or how these are kinked; default lines every 5°.
    pub spacing: BendSpacing,
    /// Over which edges faces are laid beside each other; default all.
    pub joins: Joins,
}

impl PartOptions {
    /// Defaults with a tolerance (mm).
    pub(crate) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            k: KFactor::default(),
            surfaces: false,
            sheet: None,
            spacing: BendSpacing::default(),
            joins: Joins::All,
        }
    }
}

/// The flat parts of the faces of one body.
///
/// *Input*: faces of one solid or sheet, mm. *Guarantee*: every face is in a part, an edge of the sheet, or named in
/// `left`. Contours are closed, the outer one first and counter-clockwise. *Measured, not proven*: that surfaces are
/// exact, that parts do not overlap themselves.
pub(crate) fn flat_parts(faces: &[&Face], name: &str, options: &PartOptions) -> BodyParts {
    let mut out = BodyParts::default();
    let given = Body::new(faces.to_vec());
    let turned = oriented(&given);
    let body = turned.as_ref().map_or(given, |all| Body::new(all.iter().collect()));
    let inside_out: Vec<Face>;
    let (body, found) = match options.surfaces {
        true => {
            let found = open(&body);
            (body, found)
        }
        false => match sheet(&body) {
            Ok(found) => (body, found),
            Err(e) => {
                // Solids whose faces all look inwards have nothing opposite in their material.
                inside_out = body.faces.iter().map(|f| turned_over(f)).collect();
                let other = Body::new(inside_out.iter().collect());
                let Some(found) =
                    sheet(&other).ok().filter(|_| matches!(e, SheetError::NoThickness(ref d) if d.is_empty()))
                else {
                    out.left.push((None, Unlaid::NoSheet(e.to_string())));
                    return out;
                };
                (other, found)
            }
        },
    };
    let given = options.sheet.as_ref().filter(|_| found.thickness <= 0.0);
    let asked = UnfoldOptions {
        k: given.map_or(&options.k, |s| &s.k).clone(),
        tolerance: options.tolerance,
        thickness: given.map_or_else(|| found.local.clone(), |s| vec![s.thickness; faces.len()]),
        side: given.map(|s| s.side),
        joins: options.joins.clone(),
    };
    let sides = found.skins.iter().filter(|s| !s.is_empty()).map(|skin| Side::of(&body, skin, &asked));
    let best = sides.reduce(|a, b| if b.is_better(&a) { b } else { a });
    let of_best =
        |b: &Side| b.pieces.iter().flat_map(|p| &p.faces).map(|f| f.face).chain(b.left.iter().copied()).collect();
    let unreached = best.as_ref().map_or_else(Vec::new, |b| found.unreached(&of_best(b)));
    let left: Vec<usize> = best.iter().flat_map(|b| &b.left).chain(&found.others).copied().chain(unreached).collect();
    for group in groups(&body, &left) {
        out.left.push((Some(group[0]), Unlaid::Group(group.len(), Box::new(why(&body, group[0], &found)))));
    }
    let Some(best) = best else { return out };
    let (drawn, empty): (Vec<_>, Vec<_>) =
        best.pieces.iter().zip(best.outlines).partition(|(_, o)| o.iter().any(|o| o.contour.vertices.len() > 1));
    for face in empty.iter().flat_map(|(piece, _)| &piece.faces) {
        out.left.push((Some(face.face), Unlaid::Narrow { tolerance: options.tolerance }));
    }
    let count = drawn.len();
    let slanting = found.slanting(&body);
    let shared = shared_edges(&body, &drawn.iter().map(|d| d.0).collect::<Vec<_>>(), options.tolerance);
    out.parts = parallel::map(drawn.into_iter().enumerate(), |(k, (piece, outlines))| {
        let name = if count > 1 { format!("{name}-{}", k + 1) } else { name.to_owned() };
        let mut made = part(&body, piece, outlines, (&found, &name), options);
        let touches = |f: &usize| body.of_face(*f).any(|h| body.beyond(h).is_some_and(|g| made.faces.contains(&g)));
        made.sheet.turned = made.faces.iter().map(|f| body.faces[*f].reversed != faces[*f].reversed).collect();
        made.slanting = slanting.iter().filter(|f| touches(f)).map(|f| body.faces[*f].entity).collect();
        made
    });
    for edge in shared {
        out.parts[edge.parts[0].min(edge.parts[1])].shared.push(edge);
    }
    out
}

/// A face that looks the other way.
fn turned_over(face: &Face) -> Face {
    let mut out = face.clone();
    out.reversed = !face.reversed;
    out
}

/// One skin of a sheet, unfolded.
struct Side {
    pieces: Vec<UnfoldedPiece>,
    outlines: Vec<Vec<Outline>>,
    left: Vec<usize>,
}

impl Side {
    fn of(body: &Body, skin: &[usize], asked: &UnfoldOptions) -> Self {
        let (pieces, left) = unfold(body, skin, asked);
        let outlines = parallel::map(pieces.iter(), |p| outlines(body, p, asked.tolerance));
        Self { pieces, outlines, left }
    }

    /// Less is better: faces left out, pieces, sharp bends seen from outside.
    fn rank(&self) -> [usize; 3] {
        let outside = self.pieces.iter().flat_map(|p| &p.folds).filter(|f| f.meeting.convex).count();
        [self.left.len(), self.pieces.len(), outside]
    }

    /// Whether this skin is the better one by its rank, else by more area, which is the side without countersinks.
    fn is_better(&self, other: &Self) -> bool {
        let area = |s: &Self| s.outlines.iter().flatten().map(|o| o.area).sum::<f64>();
        match self.rank().cmp(&other.rank()) {
            std::cmp::Ordering::Equal => area(self) > area(other) * (1.0 + ALIKE),
            less => less.is_lt(),
        }
    }
}

/// Faces in groups that hang together; one that is not developable comes first in its group.
fn groups(body: &Body, faces: &[usize]) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = faces.to_vec();
    open.sort_unstable();
    let mut out = Vec::new();
    while let Some(first) = open.first().copied() {
        let mut group = vec![first];
        open.remove(0);
        let mut k = 0;
        while k < group.len() {
            let near: Vec<usize> = body.of_face(group[k]).filter_map(|h| body.beyond(h)).collect();
            let (mut joined, rest) = open.iter().partition(|f| near.contains(f));
            group.append(&mut joined);
            open = rest;
            k += 1;
        }
        group.sort_by_key(|f| (body.recognised[*f].is_developable(), *f));
        out.push(group);
    }
    out
}

/// Why a face is not part of a flat pattern.
fn why(body: &Body, face: usize, found: &BodySheet) -> Unlaid {
    match &body.recognised[face] {
        RecognisedSurface::Curved(d) => Unlaid::Curved {
            twist_estimate: d.twist_estimate,
            curvature_estimate: d.curvature_estimate,
            strain_estimate: d.strain_estimate,
        },
        c if found.thickness > 0.0 => Unlaid::Feature { surface: c.name(), thickness: found.thickness },
        c => Unlaid::Face { surface: c.name() },
    }
}

/// The drawing of a piece.
fn part(
    body: &Body,
    piece: &UnfoldedPiece,
    outlines: Vec<Outline>,
    (found, name): (&BodySheet, &str),
    options: &PartOptions,
) -> FlatPart {
    let tolerance = options.tolerance;
    let others: HashSet<usize> = found.others.iter().copied().collect();
    let formed =
        |o: &Outline| o.area < 0.0 && o.halves.iter().all(|h| body.beyond(*h).is_some_and(|g| others.contains(&g)));
    let bends = bends(body, piece, found.thickness, &options.spacing.of_job(tolerance), tolerance);
    let (marks, contours): (Vec<Outline>, Vec<Outline>) = outlines.into_iter().partition(formed);
    let mut pattern = Pattern {
        name: name.to_owned(),
        view: ViewSide::Outside,
        area: contours.iter().map(|o| contour_area(&o.contour)).sum(),
        contour_error: contours.iter().map(|o| o.error).fold(0.0, f64::max),
        ..Pattern::default()
    };
    // The neutral surface keeps its area.
    pattern.area_in_space = pattern.area;
    let strokes = contours.iter().chain(&marks).flat_map(|o| o.strokes.iter().cloned()).collect();
    pattern.contours = contours.into_iter().map(|o| o.contour).collect();
    if let Some(r) = rectangle_around(&pattern.contours) {
        (pattern.width, pattern.length) = (r.width, r.length);
    }
    pattern.formed = marks.into_iter().map(|o| o.contour).collect();
    // Where one bend ends and the next begins is one line.
    for l in bends.iter().flat_map(|b| &b.extents) {
        if !pattern.extents.iter().any(|k| same_segment(k, l, POINT * body.size).is_some()) {
            pattern.extents.push(*l);
        }
    }
    for b in &bends {
        pattern.rulings.extend(&b.lines);
        pattern.bends.extend(&b.bends);
    }
    let twins = piece.inner.iter().filter_map(|h| Some([*h, body.halves[*h].twin?]));
    let mut pairs: Vec<[usize; 2]> =
        twins.filter(|[h, t]| h < t && body.halves[*h].length > POINT * body.size).collect();
    pairs.sort_unstable();
    let unknown =
        |edge: [usize; 2]| edge.map(|h| vec![Stroke::unknown(piece.place(body, h, 0.0), piece.place(body, h, 1.0))]);
    let joints = pairs.into_iter().map(|edge| joint(body, piece, edge, tolerance).unwrap_or_else(|| unknown(edge)));
    let between = (0..piece.faces.len()).flat_map(|face| strip_joints(piece, face));
    let joints = joints.chain(between).collect();
    let number = |c: &Cut| (body.halves[c.half].stretch.entity, c.reason);
    FlatPart {
        pattern,
        sheet: SheetPart {
            thickness: found.thickness,
            local: piece.faces.iter().map(|p| if p.is_given { 0.0 } else { p.thickness }).collect(),
            k: options.k.clone(),
            given: options.sheet.clone().filter(|_| piece.faces.iter().all(|p| p.is_given)),
            bends,
            turned: Vec::new(),
        },
        faces: piece.faces.iter().map(|p| p.face).collect(),
        cuts: piece.cuts.iter().map(number).collect(),
        strokes,
        joints,
        maps: piece.faces.iter().map(|p| p.chart.closed()).collect(),
        strips: piece.faces.iter().map(placed_strips).collect(),
        allowances: piece.folds.iter().map(|f| f.allowance).filter(|a| *a != 0.0).collect(),
        slanting: Vec::new(),
        places: piece.faces.iter().map(|p| PlacedChart { chart: p.chart.clone(), motion: p.motion }).collect(),
        regions: piece.faces.iter().map(|p| region(body, piece, p, found.thickness, tolerance)).collect(),
        shared: Vec::new(),
    }
}
