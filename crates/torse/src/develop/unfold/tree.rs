//! Faces laid side by side: a spanning tree of joints, the longest first, so that cuts are short; where a face would
//! lie on another, or images of a common edge do not fit, the joint is cut.

use super::allowance::{Fibre, KFactor};
use super::chart::{middle_radius, Chart};
use super::region::{FlatRegion, Motion, POINT};
use crate::brep::body::{Body, Meeting, SMOOTH};
use crate::develop::shop::thickness::SheetSide;
use crate::geom::{BBox, Vec2, Vec3};
use crate::num::parallel;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Over which edges faces are laid beside each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Joins {
    /// All, in sharp bends where faces meet at an angle.
    #[default]
    All,
    /// Those where faces go on smoothly.
    Smooth,
    /// None: every face is a part.
    None,
    /// Those where faces go on smoothly, and in sharp bends those with these entity numbers.
    Named(Vec<u64>),
}

impl Joins {
    /// Whether the faces on both sides of a run may be laid beside each other.
    fn allow(&self, body: &Body, half: usize) -> bool {
        let is_named = |all: &[u64]| {
            let twin = body.halves[half].twin.unwrap_or(half);
            [half, twin].iter().any(|h| all.contains(&body.halves[*h].stretch.entity))
        };
        let smooth = || body.meeting(half).is_some_and(|m| m.angle < SMOOTH);
        match self {
            Self::All => true,
            Self::Smooth => smooth(),
            Self::None => false,
            Self::Named(all) => is_named(all) || smooth(),
        }
    }
}

/// What unfolding is asked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UnfoldOptions {
    /// Where the neutral fibre lies; default 0.44 (ANSI).
    pub k: KFactor,
    /// Distance (mm) allowed between contours drawn and exact outlines; no default.
    pub tolerance: f64,
    /// Thickness at every face of the body, mm; 0 for open surfaces.
    pub thickness: Vec<f64>,
    /// Which side of its sheet an open surface is that was given a thickness; `None` for the faces of a body, which are outer sides.
    pub side: Option<SheetSide>,
    /// Over which edges faces are laid beside each other; default all.
    pub joins: Joins,
}

/// A face in the plane.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    /// Index of the face in the body.
    pub face: usize,
    /// Its own map.
    pub chart: Chart,
    /// Where the map's image lies in the piece.
    pub motion: Motion,
    /// The image, sampled.
    pub region: FlatRegion,
    /// Steps from the root of the tree.
    pub steps: usize,
    /// K used for it (share of the thickness) if it is bent about one axis.
    pub k: f64,
    /// Radius (mm) of a cylinder, and that of the inside of its sheet.
    pub radius: f64,
    /// See `radius`.
    pub inside_radius: f64,
    /// Thickness of the sheet there (mm), and where its neutral fibre lies.
    pub thickness: f64,
    /// See `thickness`.
    pub fibre: Fibre,
    /// Whether it is a surface that was given a thickness, which it has room for: radii of its bend lines are its own then.
    pub is_given: bool,
}

/// A sharp bend between two faces of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fold {
    /// A run along it.
    pub half: usize,
    /// How the faces meet.
    pub meeting: Meeting,
    /// Way (mm) by which the faces are apart in the plane: the allowance.
    pub allowance: f64,
    /// K used for it.
    pub k: f64,
}

/// Why a joint is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CutReason {
    /// The piece closes on itself there.
    Closes,
    /// Faces would lie on each other.
    Overlap,
    /// The images of the edge on both faces differ, as along curved creases.
    Differs,
    /// No bend was asked for there.
    Asked,
}

/// An edge between two skin faces that is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    /// A run along it.
    pub half: usize,
    /// Why.
    pub reason: CutReason,
}

/// One piece of the plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnfoldedPiece {
    /// Its faces; the first is the root.
    pub faces: Vec<Placed>,
    /// Runs (both sides) that lie inside the piece and are not drawn.
    pub inner: HashSet<usize>,
    /// Sharp bends.
    pub folds: Vec<Fold>,
    /// Edges cut, whose other side is in this piece or another.
    pub cuts: Vec<Cut>,
}

impl UnfoldedPiece {
    /// The placed face of a body's face.
    pub(crate) fn placed(&self, face: usize) -> Option<&Placed> {
        self.faces.iter().find(|p| p.face == face)
    }

    /// Place of a run's point in the piece.
    pub(crate) fn place(&self, body: &Body, half: usize, s: f64) -> Vec2 {
        let h = &body.halves[half];
        let (x, uv) = h.stretch.at(body.faces[h.face], s);
        self.placed(h.face).map_or_else(Vec2::zeros, |p| p.motion.apply(&p.chart.flat(&x, Some(uv))))
    }
}

/// Images of one edge on both faces may differ by this share of its length: what ten printed digits lose many times over.
const CONGRUENT: f64 = 1e-5;
/// Faces may lie on each other by this share of the piece, and by so many tolerances.
const OVERLAP: (f64, f64) = (1e-5, 2.0);
/// Amounts and places whose difference is a smaller share of the body are the same: what is written is rounded, and panels end
/// beside their faces' edges.
const SAME_AMOUNT: f64 = 1e-4;
/// Points along an edge where its images are compared.
const PLACES: usize = 7;

/// A face with its map, ready to be placed.
struct Ready {
    chart: Chart,
    region: FlatRegion,
    /// Of the region, mm².
    area: f64,
    /// Of its border, in space.
    middle: Vec3,
    k: f64,
    radius: f64,
    inside_radius: f64,
    thickness: f64,
    fibre: Fibre,
    is_given: bool,
}

/// Unfolds the skin faces of a body into as few pieces as their joints allow. Faces without a map (thicker than their
/// radius, not developable) are answered in the second list. Surfaces into which the sheet given does not fit everywhere are
/// unfolded as they are, all of them.
pub(crate) fn unfold(body: &Body, skin: &[usize], options: &UnfoldOptions) -> (Vec<UnfoldedPiece>, Vec<usize>) {
    if !have_room(body, skin, options) {
        let thickness = vec![0.0; options.thickness.len()];
        return unfold(body, skin, &UnfoldOptions { thickness, side: None, ..options.clone() });
    }
    let mut ready: BTreeMap<usize, Ready> = BTreeMap::new();
    let mut left = Vec::new();
    for (&f, found) in skin.iter().zip(parallel::map(skin.iter(), |f| prepared(body, *f, options))) {
        match found {
            Some(r) => _ = ready.insert(f, r),
            None => left.push(f),
        }
    }
    let mut pieces = Vec::new();
    let mut cuts: Vec<Cut> = Vec::new();
    let areas = |ready: &BTreeMap<usize, Ready>| {
        let each = ready.iter().map(|(f, r)| (r.area, r.middle, *f));
        foremost(each, None, (body.size * body.size, body.size))
    };
    while let Some(root) = areas(&ready) {
        let mut piece = UnfoldedPiece::default();
        if let Some(r) = ready.remove(&root) {
            piece.faces.push(r.placed(root, Motion::identity(), 0));
        }
        grow(body, &mut piece, &mut ready, &mut cuts, options);
        close(body, &mut piece, &mut cuts, options);
        pieces.push(piece);
    }
    if options.joins != Joins::None {
        let of_skin: HashSet<usize> = skin.iter().copied().collect();
        let laid = pieces.iter().flat_map(|p| &p.faces).flat_map(|p| body.of_face(p.face));
        let asked =
            laid.filter(|h| body.beyond(*h).is_some_and(|g| of_skin.contains(&g)) && !options.joins.allow(body, *h));
        cuts.extend(asked.map(|half| Cut { half, reason: CutReason::Asked }));
    }
    // Each cut is told once, with the first piece that it bounds.
    let piece_of: HashMap<usize, usize> =
        pieces.iter().enumerate().flat_map(|(k, p)| p.faces.iter().map(move |f| (f.face, k))).collect();
    let of_piece = |c: Cut| piece_of.get(&body.halves[c.half].face).map(|k| (*k, c));
    let mut cuts: Vec<(usize, Cut)> = cuts.into_iter().filter_map(of_piece).collect();
    cuts.sort_by_key(|c| c.0);
    let mut told: HashSet<usize> = HashSet::new();
    for (k, cut) in cuts {
        let twin = body.halves[cut.half].twin.unwrap_or(cut.half);
        if !pieces[k].inner.contains(&cut.half) && !told.contains(&twin) {
            told.extend([cut.half, twin]);
            pieces[k].cuts.push(cut);
        }
    }
    (pieces, left)
}

/// Of what is longest, or largest, that which is nearest to `root`, and of that the foremost in space, so that a body that was
/// written and read again is unfolded in the same way. `whole` is an amount to compare with.
fn foremost<T: Copy>(
    all: impl Iterator<Item = (f64, Vec3, T)>,
    root: Option<Vec3>,
    (whole, size): (f64, f64),
) -> Option<T> {
    let rank = |amount: f64, at: Vec3| {
        let off = root.map_or(0.0, |r| (at - r).norm());
        [amount / whole, -off / size, at.x / size, at.y / size, at.z / size]
    };
    let mut rest: Vec<([f64; 5], T)> = all.map(|(amount, at, x)| (rank(amount, at), x)).collect();
    for k in 0..5 {
        let most = rest.iter().map(|r| r.0[k]).fold(f64::NEG_INFINITY, f64::max);
        rest.retain(|r| r.0[k] >= most - SAME_AMOUNT);
    }
    rest.first().map(|r| r.1)
}

/// Middle of the box around the border of a face.
fn middle(body: &Body, face: usize) -> Vec3 {
    let mut around = BBox::empty();
    for h in body.of_face(face) {
        [0.0, 0.5].iter().for_each(|s| around.include(&body.halves[h].stretch.at(body.faces[face], *s).0));
    }
    (around.min + around.max) * 0.5
}

impl Ready {
    fn placed(self, face: usize, motion: Motion, steps: usize) -> Placed {
        let region = self.region.moved(&motion);
        let Self { chart, k, radius, inside_radius, thickness, fibre, is_given, .. } = self;
        Placed { face, chart, motion, region, steps, k, radius, inside_radius, thickness, fibre, is_given }
    }
}

fn prepared(body: &Body, face: usize, options: &UnfoldOptions) -> Option<Ready> {
    let (f, recognised, t) = (body.faces[face], &body.recognised[face], options.thickness[face]);
    let skin = Chart::of(f, recognised, 0.0)?;
    let hollow = hollow(body, face, &skin);
    let radius = middle_radius(f, recognised);
    let above = options.side.map_or(0.0, |side| side.extent(t)[1]);
    let fibre = Fibre { k: options.k.clone(), thickness: t, above };
    let inside_radius = fibre.inside(radius, hollow).max(0.0);
    let chart = Chart::in_sheet(f, recognised, &fibre)?;
    let chart = chart.in_strips(recognised, options.tolerance);
    let region = FlatRegion::of(body, face, &chart);
    let k = fibre.share(radius, hollow);
    let is_given = options.side.is_some();
    let (area, middle) = (region.area(), middle(body, face));
    (area > 0.0).then_some(Ready {
        chart,
        region,
        area,
        middle,
        k,
        radius,
        inside_radius,
        thickness: t,
        fibre,
        is_given,
    })
}

/// Rulings that are looked at for room.
const LOOKS: usize = 64;
/// Inside radii below this share of the thickness are those of apexes.
const NO_ROOM: f64 = 1e-6;

/// Whether the sheet that surfaces were given fits into the bends of all of them: there is no room at apexes, whose offset is a
/// curve.
fn have_room(body: &Body, skin: &[usize], options: &UnfoldOptions) -> bool {
    let Some(side) = options.side else { return true };
    skin.iter().all(|&face| {
        let Some(chart) = Chart::of(body.faces[face], &body.recognised[face], 0.0) else { return true };
        let (region, thickness) = (FlatRegion::of(body, face, &chart), options.thickness[face]);
        let fibre = Fibre { k: options.k.clone(), thickness, above: side.extent(thickness)[1] };
        chart.rulings(LOOKS).iter().all(|r| {
            let mut ends = region.own_lines(r).into_iter().flatten();
            ends.all(|p| fibre.inside(r.radius_at(&p), r.hollow) > NO_ROOM * thickness)
        })
    })
}

/// Whether a face is hollow, seen from outside, half way.
fn hollow(body: &Body, face: usize, chart: &Chart) -> bool {
    if chart.bulge() != 0.0 {
        return chart.bulge() < 0.0;
    }
    let f = body.faces[face];
    let [u0, u1, v0, v1] = crate::brep::recognised_surface::bounds(f);
    let j = f.surface.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let n = if f.reversed { -j.normal() } else { j.normal() };
    // The mean of both second derivatives bends towards the normal in a hollow.
    n.dot(&j.duu) / j.du.norm_squared() + n.dot(&j.dvv) / j.dv.norm_squared() > 0.0
}

/// Adds faces over the longest joint at hand, as long as one fits.
fn grow(
    body: &Body,
    piece: &mut UnfoldedPiece,
    ready: &mut BTreeMap<usize, Ready>,
    cuts: &mut Vec<Cut>,
    options: &UnfoldOptions,
) {
    let mut refused: HashSet<usize> = HashSet::new();
    loop {
        let open = piece
            .faces
            .iter()
            .flat_map(|p| body.of_face(p.face))
            .filter(|h| !refused.contains(h) && body.beyond(*h).is_some_and(|g| ready.contains_key(&g)))
            .filter(|h| body.halves[*h].length > CONGRUENT * body.size && options.joins.allow(body, *h));
        let lengths = open.map(|h| (body.halves[h].length, body.middle(h), h));
        let root = piece.faces.first().map(|p| middle(body, p.face));
        let Some(h) = foremost(lengths, root, (body.size, body.size)) else { return };
        let Some((g, twin)) = body.beyond(h).zip(body.halves[h].twin) else { return };
        let Some(there) = ready.get(&g) else { return };
        refused.insert(h);
        let (allowance, k) = fold_allowance(body, h, options);
        let Some(motion) = joined(body, piece, h, twin, (&there.chart, allowance)) else {
            cuts.push(Cut { half: h, reason: CutReason::Differs });
            continue;
        };
        let moved = there.region.moved(&motion);
        let depth = (OVERLAP.0 * body.size).max(OVERLAP.1 * options.tolerance);
        // Outside a sharp bend both faces reach to its edge, beyond what the bend is made of: they overlap by that.
        let shared = |face: usize| if face == body.halves[h].face { (-allowance).max(0.0) } else { 0.0 };
        if piece.faces.iter().any(|p| p.region.overlaps(&moved, depth + shared(p.face))) {
            cuts.push(Cut { half: h, reason: CutReason::Overlap });
            continue;
        }
        let steps = piece.placed(body.halves[h].face).map_or(0, |p| p.steps) + 1;
        piece.inner.extend([h, twin]);
        if let Some(meeting) = body.meeting(h).filter(|m| m.angle >= SMOOTH) {
            piece.folds.push(Fold { half: h, meeting, allowance, k });
        }
        if let Some(r) = ready.remove(&g) {
            piece.faces.push(r.placed(g, motion, steps));
        }
    }
}

/// Way by which faces are apart in the plane along a joint, and K: 0 where they go on smoothly.
fn fold_allowance(body: &Body, half: usize, options: &UnfoldOptions) -> (f64, f64) {
    // Sharp edges of surfaces have no radius, whatever sheet they are made of.
    if options.side.is_some() {
        return (0.0, 0.0);
    }
    let near = options.thickness[body.halves[half].face];
    let t = body.beyond(half).map_or(near, |g| near.min(options.thickness[g]));
    let Some(m) = body.meeting(half).filter(|m| m.angle >= SMOOTH && t > 0.0) else { return (0.0, 0.0) };
    let k = options.k.share(0.0);
    // On the outside of a sharp bend both faces reach farther than the inside by t tan(angle/2).
    let outside = if m.convex { 2.0 * t * (0.5 * m.angle).tan() } else { 0.0 };
    (k * t * m.angle - outside, k)
}

/// Where the face beyond a run comes to lie; `None` if the edge has two different images.
fn joined(body: &Body, piece: &UnfoldedPiece, h: usize, twin: usize, (chart, apart): (&Chart, f64)) -> Option<Motion> {
    let (near, far) = (&body.halves[h], &body.halves[twin]);
    let here = |s: f64| piece.place(body, h, s);
    let nearest = |x: &crate::geom::Vec3| {
        let s = far.stretch.nearest(body.faces[far.face], x).0;
        far.stretch.at(body.faces[far.face], s)
    };
    let there = |x: &crate::geom::Vec3| {
        let (y, uv) = nearest(x);
        chart.flat(&y, Some(uv))
    };
    let point = |s: f64| near.stretch.at(body.faces[near.face], s).0;
    let closed = (point(0.0) - point(1.0)).norm() <= CONGRUENT * near.length;
    let last = if closed { 0.5 } else { 1.0 };
    // Of an edge that begins before the other one, as where a face ends beside its apex, what lies on both.
    let common = [0.0, last].map(|s| {
        let (x, y) = (point(s), nearest(&point(s)).0);
        let short = (y - x).norm() > POINT * body.size;
        if short {
            near.stretch.nearest(body.faces[near.face], &y).0
        } else {
            s
        }
    });
    let mut to = common.map(here);
    let mut gap = Vec2::zeros();
    if apart != 0.0 {
        // Material is on the left of the run: the neighbour moves to the right.
        let way = (to[1] - to[0]).try_normalize(0.0)?;
        gap = Vec2::new(way.y, -way.x) * apart;
        to = to.map(|p| p + gap);
    }
    let motion = Motion::between(common.map(|s| there(&point(s))), to)?;
    let fits = (0..PLACES).all(|k| {
        let s = common[0] + (common[1] - common[0]) * k as f64 / (PLACES - 1) as f64;
        (motion.apply(&there(&point(s))) - here(s) - gap).norm() <= CONGRUENT * near.length.max(CONGRUENT * body.size)
    });
    fits.then_some(motion)
}

/// Finds the other edges that lie inside the piece, because both images fall together, and cuts the rest.
fn close(body: &Body, piece: &mut UnfoldedPiece, cuts: &mut Vec<Cut>, options: &UnfoldOptions) {
    let halves: Vec<usize> = piece.faces.iter().flat_map(|p| body.of_face(p.face)).collect();
    for h in halves {
        let Some((g, twin)) = body.beyond(h).zip(body.halves[h].twin) else { continue };
        if piece.inner.contains(&h) || piece.placed(g).is_none() || !options.joins.allow(body, h) {
            continue;
        }
        let (allowance, k) = fold_allowance(body, h, options);
        let here = [piece.place(body, h, 0.0), piece.place(body, h, 0.5), piece.place(body, h, 1.0)];
        let Some(way) = (here[2] - here[0]).try_normalize(0.0) else { continue };
        let gap = Vec2::new(way.y, -way.x) * allowance;
        let other = &body.halves[twin];
        let near = &body.halves[h];
        let apart = [0.0, 0.5, 1.0].into_iter().zip(here).map(|(s, p)| {
            let x = near.stretch.at(body.faces[near.face], s).0;
            let t = other.stretch.nearest(body.faces[other.face], &x).0;
            (piece.place(body, twin, t) - p - gap).norm()
        });
        if apart.fold(0.0, f64::max) <= CONGRUENT * body.size {
            piece.inner.extend([h, twin]);
            // About an apex nothing is bent.
            let long = near.length > CONGRUENT * body.size;
            if let Some(meeting) = body.meeting(h).filter(|m| long && m.angle >= SMOOTH) {
                piece.folds.push(Fold { half: h, meeting, allowance, k });
            }
        } else if !cuts.iter().any(|c| c.half == h || c.half == twin) {
            cuts.push(Cut { half: h, reason: CutReason::Closes });
        }
    }
}
