//! The flat pattern of a chain of cones that is cut along an outline, as drawn, against its pieces.
//!
//! *Theorem* \[certificate, 8\]: every piece has a map to the plane that changes no length by more than the factor
//! `1 ± strain_bound`; where two pieces meet, their images and they themselves are within `gap_bound` of each other. The lines
//! and arcs drawn are within `outline_bound` of the images of the trimming curves of the pieces, and these of them; in
//! space these curves are within it too of the edges that files hold. Every ruling drawn lies within `ruling_bound` of the
//! image of one. Pieces are trimmed patches, one after the other along their joints, found from any of them on.

use super::chain::{self, ruling_bound, GOOD_BOUND, STILL};
use super::matching::{backwards, directed, laid_on, motion_of, Walk};
use super::outline::{chain_bound, Image, Motion};
use super::rails::{Change, FlatRails};
use super::senses::seen;
use super::simple_outline::outline_is_simple;
use super::{DrawnRulings, FlatCertificate};
use crate::certify::edges::edge_bound;
use crate::certify::ruled::{Ruled, RuledJets};
use crate::certify::seams::SeamSide;
use crate::certify::vector::{length_bound, sub, V3};
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::parallel;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::reason::{FlatFault, Of};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::cone::part::{ConeBody, ConePart, PartCurve};
use crate::torse::strip::Strip;

/// A piece in the plane.
struct FlatPatch<'a> {
    patch: &'a Surface,
    rails: FlatRails,
    jets: RuledJets,
    /// Where it lies beside the others.
    motion: Motion,
}

/// A stretch of the border: an edge of a piece.
struct BorderEdge {
    piece: usize,
    trim: Curve<2>,
    /// Whether the border runs along it.
    forward: bool,
}

/// Proves what is claimed about flat patterns of chains of cones: one certificate per pattern, in order, with the number of
/// its part. `pieces` names body and piece of every strip; of whole chains the strips are the pieces. `tolerance` (mm): as
/// for [`super::strip_parts`].
///
/// *Guarantee*: the theorem at the head of this file, for whole chains that of [`super::strip_parts`], for the patches that
/// stand for the pieces; how far these are from the exact cones is bounded by `certify::written_cones`.
pub fn cone_parts(
    (bodies, pieces): (&[ConeBody], &[(usize, usize)]),
    strips: &[Strip],
    parts: &[Part],
    patterns: &[Pattern],
    tolerance: f64,
) -> Vec<FlatCertificate> {
    let one = |pattern: &Pattern| {
        FlatCertificate::judged(pattern.panel, tolerance, |out| {
            let range = parts.get(pattern.panel).map_or(0..0, |p| p.first..p.first.saturating_add(p.count));
            let own = pieces.get(range.clone()).filter(|p| !p.is_empty()).ok_or(FlatFault::NoPieces)?;
            let body = bodies.get(own[0].0).filter(|_| own.iter().all(|p| p.0 == own[0].0));
            let Some(part) = body.ok_or(FlatFault::SeveralChains)?.part.as_ref() else {
                chain::judged(out, strips.get(range).unwrap_or_default(), pattern, tolerance)?;
                return outline_is_simple(pattern, tolerance);
            };
            let segments = || own.iter().filter_map(|p| part.faces.get(p.1)).map(|f| f.segment);
            let (from, to) = (segments().min().unwrap_or(0), segments().max().map_or(0, |m| m + 1));
            let part = part.between(from, to);
            if part.faces.len() != own.len() {
                return Err(FlatFault::Incomplete);
            }
            judged(out, &part, pattern, tolerance)?;
            outline_is_simple(pattern, tolerance)
        })
    };
    parallel::map(patterns.iter(), one)
}

/// Proves what is claimed about the pattern of a trimmed chain: see the head of this file.
fn judged(out: &mut FlatCertificate, part: &ConePart, pattern: &Pattern, tolerance: f64) -> Result<(), FlatFault> {
    let lay = |side: f64| Laid::new(part, side, tolerance);
    let outer = pattern.contours.first().ok_or(FlatFault::Nothing)?;
    let fit = |laid: &Laid, flip: f64| -> Option<(Motion, f64)> {
        let walk = &laid.walks.first()?.1;
        motion_of(walk, &directed(outer, walk.turn() * flip < 0.0), flip)
    };
    let mut laid = lay(1.0)?;
    let off = |side: f64| fit(&laid, side).map_or(f64::INFINITY, |m| m.1);
    let patches = part.faces.iter().map(|f| &f.blank.patch);
    let side = seen(patches, pattern, tolerance, &off).ok_or(FlatFault::OtherWay)?;
    if side < 0.0 {
        laid = lay(side)?;
    }
    let (motion, _) = fit(&laid, 1.0).ok_or(FlatFault::Nowhere(Of::Pieces))?;
    out.strain_bound = laid.pieces.iter().map(|p| p.rails.strain).fold(0.0, f64::max);
    for p in &mut laid.pieces {
        p.motion = p.motion.then(&motion).ok_or(FlatFault::Beside)?;
    }
    let gaps = laid.gaps(part).ok_or(FlatFault::Joint)?;
    out.gap_bound = gaps.iter().copied().fold(0.0, f64::max);
    if pattern.contours.len() != laid.walks.len() {
        return Err(FlatFault::OtherLoops);
    }
    let mut worst = laid.edges;
    let reversed = laid.walks[0].1.turn() < 0.0;
    let mut left: Vec<usize> = (0..laid.walks.len()).collect();
    for contour in &pattern.contours {
        let vertices = directed(contour, reversed);
        // Of loops that are left, the one on which it lies.
        let fits = left.iter().filter_map(|&k| Some((k, laid_on(&laid.walks[k].1, &vertices, &motion)?)));
        let (k, fit) = fits.min_by(|a, b| a.1.off.total_cmp(&b.1.off)).ok_or(FlatFault::StrangeLoop)?;
        left.retain(|x| *x != k);
        for (run, chain) in laid.walks[k].0.iter().zip(&fit.chains) {
            let piece = &laid.pieces[run.piece];
            let image = Image { flat: &piece.rails, trim: &run.trim, motion: piece.motion };
            let chain = if run.forward { chain.clone() } else { backwards(chain) };
            let off = chain_bound(&image, &chain, tolerance);
            worst = worst.max(off.ok_or(FlatFault::Outline(Of::Pieces))?);
        }
    }
    out.outline_bound = worst;
    let drawn: Vec<DrawnRulings> = laid.pieces.iter().map(|p| DrawnRulings::new(&p.rails, p.motion)).collect();
    let mut rulings = 0.0f64;
    for r in &pattern.rulings {
        let off = ruling_bound(&drawn, &r.map(|p| [p.x, p.y]), GOOD_BOUND * tolerance);
        rulings = rulings.max(off.ok_or(FlatFault::Ruling(Of::Pieces))?);
    }
    out.ruling_bound = rulings;
    out.mark_bound = 0.0;
    if !pattern.marks.is_empty() {
        return Err(FlatFault::Marks);
    }
    let change = laid.pieces.iter().map(|p| p.rails.change()).reduce(|a: Change, b| a.and(&b));
    let change = change.map_or(f64::INFINITY, |c| c.of(pattern.length));
    out.change_bound = gaps.iter().fold(Interval::point(change), |s, g| s + Interval::point(*g)).hi;
    Ok(())
}

/// All pieces side by side.
struct Laid<'a> {
    pieces: Vec<FlatPatch<'a>>,
    /// Loops of the border, the greatest first, walked along.
    walks: Vec<(Vec<BorderEdge>, Walk)>,
    /// Distance in space of trimming curves from the edges of files.
    edges: f64,
}

impl<'a> Laid<'a> {
    fn new(part: &'a ConePart, side: f64, tolerance: f64) -> Result<Self, FlatFault> {
        let flat = |patch: &'a Surface| -> Option<FlatPatch<'a>> {
            let ruled = Ruled::new(patch)?;
            let rails = FlatRails::new(&ruled, &|_, _| Some(Interval::new(0.0, 1.0)), side)?;
            let jets = RuledJets::new(&ruled, &[0.0; 3]);
            Some(FlatPatch { patch, rails, jets, motion: STILL })
        };
        let pieces: Option<Vec<FlatPatch>> = part.faces.iter().map(|f| flat(&f.blank.patch)).collect();
        let pieces = pieces.ok_or(FlatFault::NoMap)?;
        let mut out = Self { pieces, walks: Vec::new(), edges: 0.0 };
        out.join(part).ok_or(FlatFault::Apart)?;
        out.border(part, tolerance).ok_or(FlatFault::Edges)?;
        Ok(out)
    }

    /// Lays every piece beside one that is laid already, along a joint.
    fn join(&mut self, part: &ConePart) -> Option<()> {
        let joints = joints(part)?;
        let mut laid = vec![false; self.pieces.len()];
        *laid.first_mut()? = true;
        while let Some((e, [a, b])) = joints.iter().find(|j| laid[j.1[0]] != laid[j.1[1]]) {
            let (known, new) = if laid[*a] { (*a, *b) } else { (*b, *a) };
            let mut pairs = Vec::new();
            for v in [part.edges[*e].start, part.edges[*e].end] {
                let about = |k: usize| -> Option<[f64; 2]> {
                    let [u, v] = self.pieces[k].seen(part, k, v)?;
                    self.pieces[k].rails.place(u, v)
                };
                pairs.push((about(new)?, self.pieces[known].motion.about(&about(known)?)));
            }
            self.pieces[new].motion = Motion::between(&pairs)?;
            laid[new] = true;
        }
        (!laid.contains(&false)).then_some(())
    }

    /// Bounds of the distance of both images and both pieces at every joint: along rulings it is greatest at the ends.
    fn gaps(&self, part: &ConePart) -> Option<Vec<f64>> {
        let gap = |e: usize, [a, b]: [usize; 2]| -> Option<f64> {
            let mut gap = 0.0f64;
            for v in [part.edges[e].start, part.edges[e].end] {
                let (p, q) = (self.pieces[a].seen(part, a, v)?, self.pieces[b].seen(part, b, v)?);
                let (p2, q2) = (self.pieces[a].exactly(&p)?, self.pieces[b].exactly(&q)?);
                let w = [0, 1].map(|d: usize| p2[d] - q2[d]);
                let space = length_bound(&sub(&self.pieces[a].point(&p), &self.pieces[b].point(&q)));
                gap = gap.max(((w[0].sqr() + w[1].sqr()).sqrt() + Interval::point(space)).hi);
            }
            Some(gap)
        };
        joints(part)?.into_iter().map(|(e, both)| gap(e, both)).collect()
    }

    /// The loops of the border, and how far trimming curves are from the edges of files.
    fn border(&mut self, part: &ConePart, tolerance: f64) -> Option<()> {
        for cycle in part.outline() {
            let mut runs = Vec::with_capacity(cycle.len());
            for (e, forward) in cycle {
                let edge = part.edges.get(e)?;
                let owner = part.faces.iter().position(|f| f.loops.iter().flatten().any(|u| u.0 == e))?;
                let piece = &self.pieces[owner];
                let (trim, off) = match &edge.curve {
                    PartCurve::Free { face, trim, space } => {
                        let own = *face == owner && trim.domain() == (0.0, 1.0);
                        let side = SeamSide { jets: &piece.jets, trim };
                        (trim.clone(), own.then(|| edge_bound(side, space, tolerance))??)
                    }
                    PartCurve::Ruling => {
                        let mut control = Vec::new();
                        let mut off = 0.0f64;
                        for v in [edge.start, edge.end] {
                            let x = part.vertices.get(v)?;
                            let q = piece.seen(part, owner, v)?;
                            let own = piece.point(&q);
                            off = off.max(length_bound(&std::array::from_fn(|d| own[d] - Interval::point(x[d]))));
                            control.push(q);
                        }
                        (Curve { knots: Knots::clamped(1, &[0.0, 1.0]).ok()?, control }, off)
                    }
                };
                self.edges = self.edges.max(off);
                runs.push(BorderEdge { piece: owner, trim, forward });
            }
            let seen: Vec<Curve<2>> =
                runs.iter().map(|r| if r.forward { r.trim.clone() } else { r.trim.reversed() }).collect();
            let images: Vec<Image> = runs
                .iter()
                .zip(&seen)
                .map(|(r, trim)| Image { flat: &self.pieces[r.piece].rails, trim, motion: self.pieces[r.piece].motion })
                .collect();
            let walk = Walk::new(&images)?;
            self.walks.push((runs, walk));
        }
        self.walks.sort_by(|a, b| b.1.turn().abs().total_cmp(&a.1.turn().abs()));
        (!self.walks.is_empty()).then_some(())
    }
}

/// Edges between two pieces, with these.
fn joints(part: &ConePart) -> Option<Vec<(usize, [usize; 2])>> {
    let users = |e: usize| -> Vec<usize> {
        let uses = |f: usize| part.faces[f].loops.iter().flatten().any(|u| u.0 == e);
        (0..part.faces.len()).filter(|f| uses(*f)).collect()
    };
    part.joints().into_iter().map(|e| <[usize; 2]>::try_from(users(e)).ok().map(|both| (e, both))).collect()
}

impl FlatPatch<'_> {
    /// Parameters of a vertex on the patch: those of its place where that is on this piece's segment, else those of the
    /// nearest point of the nearer end ruling. Numbers only: how far they are off is bounded.
    fn seen(&self, part: &ConePart, face: usize, vertex: usize) -> Option<[f64; 2]> {
        let x = part.vertices.get(vertex)?;
        let (segment, place) = *part.places.get(vertex)?;
        let own = part.faces.get(face)?;
        if segment == own.segment {
            return Some(own.blank.place(place));
        }
        let ends = |u: f64| [self.patch.point(u, 0.0), self.patch.point(u, 1.0)];
        let share = |u: f64| {
            let [a, b] = ends(u);
            let v = (x - a).dot(&(b - a)) / (b - a).norm_squared();
            ((a + (b - a) * v - x).norm(), [u, v])
        };
        let (a, b) = (share(0.0), share(1.0));
        Some(if a.0 <= b.0 { a.1 } else { b.1 })
    }

    /// Where a place of the patch exactly is beside the other pieces.
    fn exactly(&self, q: &[f64; 2]) -> Option<[Interval; 2]> {
        let p = self.rails.along_curve(Jet::from(q[0]), Jet::from(q[1]))?.0;
        Some(self.motion.point(&[p[0].v, p[1].v]))
    }

    /// The same in space.
    fn point(&self, q: &[f64; 2]) -> V3<Interval> {
        self.jets.at(Interval::point(q[0]), Interval::point(q[1]))
    }
}
