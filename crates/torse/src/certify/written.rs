//! What was judged against what was written: every number of a file, as a reader finds it, is that of the panel or
//! pattern that was judged, up to a bound.
//!
//! *Panels* \[certificate, 7\]. Knots, weights, trimming curves and edges must be the very numbers; control points of
//! rational patches are divided by their weights on writing, and curves that serve two panels run backwards on one of
//! them, with knots `1 − k` rounded. What these move is bounded, and must not exceed `RESERVE`, which the panel's own
//! bound of rounding holds ready. *Drawings*. Outlines, rulings and marks must be those of the pattern moved rigidly: a
//! joint that is off by ε and an arc over the chord c whose bulge is off by β lie within `(1 + |bulge|) ε + c β/2`.
//! (An arc is `τ/(τ + (1 − τ) e^{iψ})`, `ψ` half its sweep, in multiples of its chord: its derivative by the bulge is at
//! most ½, and the shares of both ends add up to `√(1 + bulge²)` at most.)

use super::boundary::trim_piece;
use super::claim::{Claim, Subject, UpperBound, What};
use super::flat::Motion;
use super::ruled::{Ruled, RuledJets};
use super::vector::length_bound;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::num::bernstein::hull;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel, Patchwork};
use crate::patchwork::pattern::{BendSense, Contour, Pattern};
use crate::patchwork::written::{
    WrittenArc, WrittenContour, WrittenEdge, WrittenFace, WrittenJoint, WrittenPiece, WrittenSurface,
};
use crate::reason::{Differs, Drawn, Item, Near, Reason, WrittenFault};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::f64::consts::TAU;

/// What writing may move, as a share of the largest coordinate: held ready in the rounding bound of every panel.
pub(super) const RESERVE: f64 = 1024.0 * f64::EPSILON;

/// Whether a file holds what was judged.
#[derive(Clone, Debug)]
pub struct WrittenCertificate {
    bound: f64,
    reason: Option<Reason>,
}

impl WrittenCertificate {
    /// What is proven, as a claim about the whole.
    pub fn claim(&self) -> Claim {
        Claim::at_most(What::WrittenDistance, Subject::Whole, self.proven())
    }

    /// As a bound.
    pub fn proven(&self) -> UpperBound {
        UpperBound::shown(self.bound)
    }

    /// Bound (mm) of the distance between what the file holds and what was judged. That of panels is part of their
    /// bound of rounding already; infinite if something does not agree.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// What does not agree, with the entity of the file; nothing if all does.
    pub fn reason(&self) -> Option<&Reason> {
        self.reason.as_ref()
    }

    /// Of a file that is not compared, since what it should hold is not what was judged.
    pub(crate) fn refused(fault: WrittenFault) -> Self {
        Self::of(Err(fault.into()))
    }

    pub(super) fn of(found: Result<f64, Reason>) -> Self {
        match found {
            Ok(bound) => Self { bound, reason: None },
            Err(reason) => Self { bound: f64::INFINITY, reason: Some(reason) },
        }
    }
}

/// The comparison of what a reader found, or its complaint.
pub(crate) fn of<T>(read: Result<T, String>, compare: impl FnOnce(&T) -> WrittenCertificate) -> WrittenCertificate {
    match read {
        Ok(found) => compare(&found),
        Err(words) => WrittenCertificate::refused(WrittenFault::Unreadable(words)),
    }
}

/// Compares the faces of a STEP file with the panels that were judged.
pub(crate) fn panels(patchwork: &Patchwork, faces: &[WrittenFace]) -> WrittenCertificate {
    if faces.len() != patchwork.panels.len() {
        let (found, wanted) = (faces.len(), patchwork.panels.len());
        return WrittenCertificate::of(Err(WrittenFault::Number { found, wanted, of: Near::Panels }.into()));
    }
    let found: Vec<Result<f64, Reason>> = parallel::map(patchwork.panels.iter(), |panel| {
        let own: Vec<&WrittenFace> = faces.iter().filter(|f| f.name == panel.strip.name).collect();
        let item = || Item::Panel(panel.strip.name.clone());
        let [face] = own[..] else { return Err(Reason::of(item(), WrittenFault::Faces(own.len()))) };
        let turned = patchwork.face_of(panel).is_some_and(|f| f.reversed);
        panel_moved(panel, face, turned).map_err(|fault| recorded(fault, item()))
    });
    WrittenCertificate::of(found.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))))
}

/// What the reserve is for a patch, mm.
pub(super) fn reserve(patch: &Surface) -> f64 {
    let b = patch.bbox();
    RESERVE * b.min.amax().max(b.max.amax())
}

/// What is wrong, and the entity where it is.
pub(super) type Fault = (u64, WrittenFault);

/// A fault with the name of what it concerns.
pub(super) fn recorded((entity, fault): Fault, item: Item) -> Reason {
    Reason::of(Item::Record(entity, Box::new(item)), fault)
}

fn panel_moved(panel: &Panel, face: &WrittenFace, turned: bool) -> Result<f64, Fault> {
    let here = |what: Differs| (face.entity, what.into());
    if face.reversed == (panel.mirrored() == turned) {
        return Err(here(Differs::Normal));
    }
    let mut moved = surface_moved(&panel.strip.patch, &face.surface).map_err(here)?;
    if face.loops.len() != panel.loops().len() {
        return Err(here(Differs::Loops));
    }
    let ruled = Ruled::new(&panel.strip.patch).ok_or_else(|| here(Differs::NotRuled))?;
    let mut jets = None;
    for (runs, uses) in panel.loops().iter().zip(&face.loops) {
        let runs: Vec<&Coedge> = runs.iter().filter(|r| !r.is_point()).collect();
        let mut uses: Vec<(&WrittenEdge, bool)> = uses.iter().map(|u| (u, u.forward != turned)).collect();
        if turned {
            uses.reverse();
        }
        if runs.len() != uses.len() {
            return Err(here(Differs::Edges));
        }
        for (k, (run, &(edge, forward))) in runs.iter().zip(&uses).enumerate() {
            let fault = |what: Differs| (edge.entity, what.into());
            let before = &uses[(k + uses.len() - 1) % uses.len()];
            let meet = |u: &(&WrittenEdge, bool), first: bool| u.0.vertices[usize::from(u.1 != first)];
            if meet(&uses[k], true) != meet(before, false) {
                return Err(fault(Differs::Follows));
            }
            let (first, last) = (edge.curve.control.first(), edge.curve.control.last());
            let own = [first, last];
            let next = &uses[(k + 1) % uses.len()];
            // A vertex is the end of one of the two edges that meet there, bit by bit.
            let neighbours = if forward { [before, next] } else { [next, before] };
            for (i, place) in edge.vertices.iter().enumerate() {
                let there = neighbours[i].0;
                let ends = [there.curve.control.first(), there.curve.control.last()];
                if own[i] != Some(place) && !ends.contains(&Some(place)) {
                    return Err(fault(Differs::VertexOff));
                }
            }
            if same_curve(&run.trim, &edge.trim, forward) && same_curve(&run.edge, &edge.curve, forward) {
                continue;
            }
            let jets =
                jets.get_or_insert_with(|| RuledJets::new(&ruled, &ruled.middle(panel.strip.patch.domain().0 .0)));
            let by = curves_moved(run, edge, forward, jets);
            moved = moved.max(by.ok_or_else(|| fault(Differs::EdgeOrTrim))?);
        }
    }
    if moved <= reserve(&panel.strip.patch) {
        Ok(moved)
    } else {
        Err((face.entity, WrittenFault::Moved(moved)))
    }
}

/// Bound of the distance between a patch and the surface written for it.
pub(super) fn surface_moved(patch: &Surface, written: &WrittenSurface) -> Result<f64, Differs> {
    if !(same_knots(&patch.knots_u, &written.knots[0]) && same_knots(&patch.knots_v, &written.knots[1])) {
        return Err(Differs::Knots);
    }
    let rational = patch.control.iter().any(|c| c[3].total_cmp(&1.0).is_ne());
    let weights = &written.weights;
    let same = if weights.is_empty() {
        !rational
    } else {
        weights.len() == patch.control.len() && patch.control.iter().zip(weights).all(|(c, w)| c[3] == *w && *w > 0.0)
    };
    if !same || written.points.len() != patch.control.len() {
        return Err(Differs::Weights);
    }
    // A point of the surface is a mean of control points with the same weights: it moves no more than they do.
    let mut most = 0.0f64;
    for (c, p) in patch.control.iter().zip(&written.points) {
        let off = [0, 1, 2].map(|d: usize| {
            let own = if rational { Interval::point(c[d]) / Interval::point(c[3]) } else { Interval::point(c[d]) };
            own - Interval::point(p[d])
        });
        let far = length_bound(&off);
        if !(far <= f64::MAX && p.iter().all(|x| x.is_finite())) {
            return Err(Differs::ControlPoint);
        }
        most = most.max(far);
    }
    Ok(most)
}

fn same_knots(a: &Knots, b: &Knots) -> bool {
    a.degree() == b.degree() && a.values() == b.values()
}

/// Whether a written curve is the judged one, the other way round if it is not `forward`; knots exactly mirrored then.
fn same_curve<const D: usize>(own: &Curve<D>, written: &Curve<D>, forward: bool) -> bool {
    if forward {
        return own == written;
    }
    let (a, b) = (own.knots.values(), written.knots.values());
    // 1 − k is exact for k ≥ ½.
    let mirrored = |x: f64, y: f64| 1.0 - x.max(y) == x.min(y);
    own.knots.degree() == written.knots.degree()
        && a.len() == b.len()
        && a.iter().zip(b.iter().rev()).all(|(&x, &y)| mirrored(x, y))
        && own.control.iter().eq(written.control.iter().rev())
}

/// Bound (mm) of what a written pair of edge and trimming curve differs from the judged one, at places that correspond
/// up to rounding.
fn curves_moved(run: &Coedge, edge: &WrittenEdge, forward: bool, jets: &RuledJets) -> Option<f64> {
    let mut most = 0.0f64;
    for (own, off) in differences(&run.trim, &edge.trim, forward)? {
        // How fast the patch goes in t and in r, where both curves run.
        let (lo, hi) = jets.domain();
        let at = [0, 1].map(|d: usize| own[d].hull(own[d] + off[d]));
        let t = at[0].intersect(Interval { lo, hi })?;
        let speed = |dt: Interval, dr: Interval| {
            let jet = |v: Interval, d: Interval| Jet { v, d, dd: Interval::ZERO };
            Interval::point(length_bound(&jets.along_curve(jet(t, dt), jet(at[1], dr)).0.map(|x| x.d)))
        };
        let (one, none) = (Interval::ONE, Interval::ZERO);
        let far = speed(one, none) * Interval::point(off[0].mag()) + speed(none, one) * Interval::point(off[1].mag());
        most = most.max(far.hi);
    }
    let mut edges = 0.0f64;
    for (_, off) in differences(&run.edge, &edge.curve, forward)? {
        edges = edges.max(length_bound(&off));
    }
    // The edge was judged against its trimming curve: both may have moved.
    let moved = (Interval::point(most) + Interval::point(edges)).hi;
    moved.is_finite().then_some(moved)
}

/// What is known over a piece of two curves: where the first runs, and what the second adds to it.
type Difference<const D: usize> = ([Interval; D], [Interval; D]);

/// Differences of a written curve, run backwards if it is not `forward`, from the judged one on all pieces of both.
/// `1 − s` is rounded, which shifts what corresponds by a unit in the last place and never leaves a gap.
fn differences<const D: usize>(own: &Curve<D>, written: &Curve<D>, forward: bool) -> Option<Vec<Difference<D>>> {
    for c in [own, written] {
        let whole = c.domain() == (0.0, 1.0) && c.control.len() == c.knots.control_count();
        if !whole || c.knots.degree() == 0 || c.control.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
    }
    let mut cuts = own.knots.breaks();
    cuts.extend(written.knots.breaks().into_iter().map(|t| if forward { t } else { 1.0 - t }));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|a, b| a.to_bits() == b.to_bits());
    let out = cuts.windows(2).map(|w| {
        let p = trim_piece(own, w[0], w[1]);
        let mut q = if forward { trim_piece(written, w[0], w[1]) } else { trim_piece(written, 1.0 - w[1], 1.0 - w[0]) };
        if !forward {
            q.iter_mut().for_each(|c| c.reverse());
        }
        let off = std::array::from_fn(|d| {
            // Degrees may differ in files that are not ours: then nothing is known.
            let same = p[d].len() == q[d].len();
            let all: Vec<Interval> = q[d].iter().zip(&p[d]).map(|(&a, &b)| a - b).collect();
            if same {
                hull(&all)
            } else {
                Interval::EVERYTHING
            }
        });
        (std::array::from_fn(|d| hull(&p[d])), off)
    });
    Some(out.collect())
}

/// Compares the pieces of a drawing with the patterns that were judged.
pub(crate) fn drawing(patterns: &[Pattern], pieces: &[WrittenPiece]) -> WrittenCertificate {
    let drawn: Vec<&Pattern> = patterns.iter().filter(|p| !p.contours.is_empty()).collect();
    if drawn.len() != pieces.len() {
        let (found, wanted) = (pieces.len(), drawn.len());
        return WrittenCertificate::of(Err(WrittenFault::Number { found, wanted, of: Near::Patterns }.into()));
    }
    let found: Vec<Result<f64, Reason>> = parallel::map(drawn.iter().zip(pieces), |(pattern, piece)| {
        piece_moved(pattern, piece).map_err(|fault| Reason::of(Item::Pattern(pattern.name.clone()), fault))
    });
    WrittenCertificate::of(found.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))))
}

fn piece_moved(pattern: &Pattern, piece: &WrittenPiece) -> Result<f64, WrittenFault> {
    let counted = |what: Drawn, wanted: usize, found: usize| {
        if wanted == found {
            Ok(())
        } else {
            Err(WrittenFault::Counted { what, found, wanted })
        }
    };
    counted(Drawn::Contours, pattern.contours.len(), piece.contours.len())?;
    counted(Drawn::Formed, pattern.formed.len(), piece.formed.len())?;
    counted(Drawn::Extents, pattern.extents.len(), piece.extents.len())?;
    counted(Drawn::Rulings, pattern.rulings.len(), piece.rulings.len())?;
    counted(Drawn::Marks, pattern.marks.len(), piece.marks.len())?;
    counted(Drawn::Sections, pattern.sections.len(), piece.sections.len())?;
    counted(Drawn::Curves, pattern.curves.len(), piece.curves.len())?;
    let outlines = || {
        let own = pattern.contours.iter().chain(&pattern.formed);
        own.zip(piece.contours.iter().chain(&piece.formed))
    };
    if piece.points().any(|p| !(p.x.is_finite() && p.y.is_finite())) {
        return Err(Differs::Coordinate.into());
    }
    let mut pairs = Vec::new();
    for (own, written) in outlines() {
        let WrittenContour::Joints(joints) = written else { continue };
        counted(Drawn::Joints, own.vertices.len(), joints.len())?;
        let mm = |p: &Vec2| place(&(p * piece.unit.mm()));
        pairs.extend(own.vertices.iter().zip(joints).map(|(a, b)| (place(&a.point), mm(&b.point))));
    }
    let motion = Motion::between(&pairs).ok_or(Differs::NoExtent)?;
    let unit = length_of(piece.unit);
    let far = |a: &Vec2, b: &Vec2| {
        let p = motion.point(&place(a).map(Interval::point));
        let w = [p[0] - Interval::point(b.x) * unit, p[1] - Interval::point(b.y) * unit];
        (w[0].sqr() + w[1].sqr()).sqrt().hi
    };
    let mut offs: Vec<f64> = Vec::new();
    for (own, written) in outlines() {
        offs.push(line_moved(own, written, unit, &far)?);
    }
    for (a, b) in pattern.extents.iter().zip(&piece.extents) {
        offs.extend([far(&a[0], &b[0]), far(&a[1], &b[1])]);
    }
    for ((a, b), sense) in in_order(pattern).into_iter().zip(&piece.rulings).zip(&piece.senses) {
        if a.1 != *sense {
            return Err(Differs::BendSense.into());
        }
        let a = a.0;
        offs.extend([far(&a[0], &b[0]), far(&a[1], &b[1])]);
    }
    for (own, line) in pattern.sections.iter().chain(&pattern.curves).zip(piece.sections.iter().chain(&piece.curves)) {
        let closed = usize::from(line.closed);
        let joints = match &line.line {
            WrittenContour::Joints(joints) => joints.len(),
            WrittenContour::Circle { .. } => own.joints.len(),
        };
        counted(Drawn::Corners, own.joints.len() + usize::from(own.closed), joints + closed)?;
        // The chord that an open line lacks is there on both sides.
        offs.push(line_moved(&own.contour(), &line.line, unit, &far)?);
    }
    for (a, b) in pattern.marks.iter().zip(&piece.marks) {
        // How long ticks are drawn is the drawing's affair, where they point to is not.
        let tip = a.point + a.inward * ((b[1] - b[0]).norm() * piece.unit.mm());
        offs.extend([far(&a.point, &b[0]), far(&tip, &b[1])]);
    }
    if offs.iter().any(|x| !x.is_finite()) {
        return Err(Differs::NoArc.into());
    }
    Ok(offs.into_iter().fold(0.0, f64::max))
}

/// What lines and arcs are off, joined to the first joint again, or a circle that is written for them.
fn line_moved(
    own: &Contour,
    written: &WrittenContour,
    unit: Interval,
    far: &dyn Fn(&Vec2, &Vec2) -> f64,
) -> Result<f64, WrittenFault> {
    match written {
        WrittenContour::Joints(joints) => Ok(contour_moved(own, joints, unit, far).into_iter().fold(0.0, greater)),
        WrittenContour::Circle { centre, radius } => {
            let radius = Interval::point(*radius) * unit;
            Ok(circle_moved(own, radius, |p| far(p, centre)).ok_or(Differs::NoCircle)?)
        }
    }
}

/// The greater of both; what is no number is greatest.
fn greater(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::INFINITY
    } else {
        a.max(b)
    }
}

/// A unit's length, mm: an inch is 127/5 mm exactly, which no double is.
fn length_of(unit: LengthUnit) -> Interval {
    match unit {
        LengthUnit::Millimetre => Interval::ONE,
        LengthUnit::Inch => Interval::point(127.0) / Interval::point(5.0),
    }
}

fn place(p: &Vec2) -> [f64; 2] {
    [p.x, p.y]
}

/// What every piece of an outline is off.
fn contour_moved(
    own: &Contour,
    written: &[WrittenJoint],
    unit: Interval,
    far: &dyn Fn(&Vec2, &Vec2) -> f64,
) -> Vec<f64> {
    let n = written.len();
    (0..n)
        .map(|k| {
            let (a, b) = (&own.vertices[k], &own.vertices[(k + 1) % n]);
            let (p, q) = (&written[k], &written[(k + 1) % n]);
            let joint = Interval::point(far(&a.point, &p.point).max(far(&b.point, &q.point)));
            let w = [q.point.x, q.point.y].map(Interval::point);
            let w = [w[0] - Interval::point(p.point.x), w[1] - Interval::point(p.point.y)];
            let chord = (w[0].sqr() + w[1].sqr()).sqrt();
            let bulge = Interval::point(a.bulge);
            let off = (bulge_of(p.arc, chord) - bulge).abs();
            (joint * (Interval::ONE + bulge.abs()) + (chord * unit * off).scale_exact(0.5)).hi
        })
        .collect()
}

/// What an outline of arcs is off from a circle of a radius, given how far places are from its centre; `None` where it
/// does not go round once.
///
/// Every arc lies on a circle of its own; two circles are apart by no more than their centres and radii are, and arcs that
/// go round once pass every direction.
fn circle_moved(own: &Contour, radius: Interval, from_centre: impl Fn(&Vec2) -> f64) -> Option<f64> {
    /// Sums of a few angles are exact to this (rad).
    const TURN: f64 = 1e-9;
    let v = &own.vertices;
    let sweep: f64 = v.iter().map(|v| 4.0 * v.bulge.atan()).sum();
    if (sweep.abs() - TAU).abs() > TURN || v.iter().any(|w| w.bulge * v[0].bulge <= 0.0) {
        return None;
    }
    let mut bound = 0.0_f64;
    for k in 0..v.len() {
        let [a, b] = [&v[k].point, &v[(k + 1) % v.len()].point].map(|p| [p.x, p.y].map(Interval::point));
        let bulge = Interval::point(v[k].bulge);
        let up = (Interval::ONE / bulge - bulge).scale_exact(0.25);
        let middle = [0, 1].map(|d| (a[d] + b[d]).scale_exact(0.5));
        let chord = [b[0] - a[0], b[1] - a[1]];
        let o = [middle[0] - chord[1] * up, middle[1] + chord[0] * up];
        let own_radius = ((a[0] - o[0]).sqr() + (a[1] - o[1]).sqr()).sqrt();
        let at = Vec2::new(o[0].mid(), o[1].mid());
        let off = Interval::point(from_centre(&at)) + Interval::point(o[0].rad()) + Interval::point(o[1].rad());
        bound = bound.max((off + (own_radius - radius).abs()).hi);
    }
    Some(bound)
}

/// The bulge of a written arc over a chord.
fn bulge_of(arc: WrittenArc, chord: Interval) -> Interval {
    match arc {
        WrittenArc::Bulge(b) if !b.is_finite() => Interval::EVERYTHING,
        WrittenArc::Bulge(b) => Interval::point(b),
        WrittenArc::Radius { radius, .. } if !radius.is_finite() => Interval::EVERYTHING,
        WrittenArc::Radius { radius, large, clockwise } => {
            // Readers enlarge a radius that is too small for its chord: half a circle then.
            let (r, half) = (Interval::point(radius), chord.scale_exact(0.5));
            let r = Interval { lo: r.lo.max(half.lo), hi: r.hi.max(half.hi) };
            let height = (r.sqr() - half.sqr()).sqrt();
            let b = if large { (r + height) / half } else { half / (r + height) };
            if clockwise {
                -b
            } else {
                b
            }
        }
    }
}

/// Rulings with their senses in the order of drawings: those that bend up, down, and not at all.
fn in_order(pattern: &Pattern) -> Vec<(&[Vec2; 2], BendSense)> {
    let all: Vec<_> = pattern.rulings.iter().enumerate().map(|(k, r)| (r, pattern.bend(k).sense)).collect();
    let of = |sense| all.iter().filter(move |r| r.1 == sense).copied();
    [BendSense::Up, BendSense::Down, BendSense::Flat].into_iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::two_panels;
    use crate::patchwork::pattern::{ContourVertex, Mark, MarkPlace};

    /// The faces that a writer makes of a patchwork, without a writer.
    fn faces(p: &Patchwork) -> Vec<WrittenFace> {
        let edge = |run: &Coedge, next: &Coedge| WrittenEdge {
            entity: 7,
            forward: true,
            vertices: [run.edge.control[0], next.edge.control[0]],
            curve: run.edge.clone(),
            trim: run.trim.clone(),
        };
        p.panels
            .iter()
            .map(|panel| WrittenFace {
                entity: 3,
                name: panel.strip.name.clone(),
                reversed: panel.mirrored(),
                surface: WrittenSurface {
                    knots: [panel.strip.patch.knots_u.clone(), panel.strip.patch.knots_v.clone()],
                    points: panel.strip.patch.control.iter().map(|c| [c[0], c[1], c[2]]).collect(),
                    weights: Vec::new(),
                },
                loops: panel
                    .loops()
                    .iter()
                    .map(|l| (0..l.len()).map(|k| edge(&l[k], &l[(k + 1) % l.len()])).collect())
                    .collect(),
            })
            .collect()
    }

    #[test]
    fn the_same_numbers_agree_and_any_other_is_seen() {
        let p = two_panels(1e-3, 4);
        let good = faces(&p);
        assert_eq!(panels(&p, &good).reason(), None);
        type Damage = fn(&mut WrittenFace);
        let damages: [Damage; 8] = [
            |f| f.surface.points[3][1] += 1e-9,
            |f| f.surface.points[3][1] = f64::NAN,
            |f| f.loops[0][1].curve.control[2][0] += 1000.0,
            |f| f.loops[0][1].curve.control[2][0] = f64::NAN,
            |f| f.loops[0][2].trim.control[3][1] += 1e-9,
            |f| f.loops[0][0].vertices[0][2] += 1e-6,
            |f| f.reversed = !f.reversed,
            |f| {
                f.loops[0].remove(1);
            },
        ];
        for (k, damage) in damages.iter().enumerate() {
            let mut bad = good.clone();
            damage(&mut bad[1]);
            let found = panels(&p, &bad);
            assert!(found.reason().is_some() && found.bound().is_infinite(), "damage {k}");
        }
        assert!(panels(&p, &good[..1]).reason().is_some());
    }

    #[test]
    fn curves_that_run_backwards_agree_although_their_knots_were_rounded() {
        let p = two_panels(1e-3, 4);
        let mut backwards = faces(&p);
        for face in &mut backwards {
            for edge in face.loops.iter_mut().flatten() {
                edge.forward = false;
                edge.vertices.reverse();
                edge.curve = edge.curve.reversed();
                edge.trim = edge.trim.reversed();
            }
        }
        let found = panels(&p, &backwards);
        assert!(found.reason().is_none() && found.bound() < 1e-12, "{:?} {:e}", found.reason(), found.bound());
    }

    fn upward_mark() -> Mark {
        let (point, inward) = (Vec2::new(30.0, 0.0), Vec2::y());
        Mark { point, inward, label: "S1.1".into(), on: MarkPlace::Seam, apart: 0.0 }
    }

    #[test]
    fn drawings_agree_up_to_a_rigid_motion_and_arcs_up_to_their_bulge() {
        let corner = |x: f64, y: f64, bulge: f64| ContourVertex { point: Vec2::new(x, y), bulge, corner: true };
        let vertices =
            vec![corner(0.0, 0.0, 0.0), corner(100.0, 0.0, 0.4), corner(100.0, 80.0, 0.0), corner(0.0, 80.0, 0.0)];
        let pattern = Pattern {
            contours: vec![Contour { vertices: vertices.clone() }],
            rulings: vec![[Vec2::new(50.0, 0.0), Vec2::new(50.0, 80.0)]],
            ..Pattern::default()
        };
        let (s, c) = 0.3f64.sin_cos();
        let moved = |p: &Vec2| Vec2::new(c * p.x - s * p.y + 500.0, s * p.x + c * p.y - 20.0);
        // Radius of the arc over the chord of 80: 20 (0.4 + 1/0.4).
        let radius = WrittenArc::Radius { radius: 58.0, large: false, clockwise: false };
        let piece = |arc: WrittenArc| WrittenPiece {
            unit: LengthUnit::Millimetre,
            contours: vec![WrittenContour::Joints(
                vertices
                    .iter()
                    .map(|v| WrittenJoint {
                        point: moved(&v.point),
                        arc: if v.bulge > 0.0 { arc } else { WrittenArc::Bulge(0.0) },
                    })
                    .collect(),
            )],
            rulings: pattern.rulings.iter().map(|r| [moved(&r[0]), moved(&r[1])]).collect(),
            senses: vec![BendSense::Flat; pattern.rulings.len()],
            ..WrittenPiece::default()
        };
        let all = [pattern.clone()];
        for arc in [WrittenArc::Bulge(0.4), radius] {
            let found = drawing(&all, &[piece(arc)]);
            assert!(found.bound() < 1e-11, "{:?} {:e}", found.reason(), found.bound());
        }
        // The height of the arc changes by half the chord times the bulge.
        let off = drawing(&all, &[piece(WrittenArc::Bulge(0.41))]).bound();
        assert!((off - 0.4).abs() < 1e-9, "{off}");
        let mut wrong = piece(radius);
        wrong.rulings[0][1].x += 0.5;
        assert!(drawing(&all, &[wrong.clone()]).bound() > 0.49);
        wrong.rulings[0][1].x = f64::NAN;
        assert!(drawing(&all, &[wrong]).reason().is_some());
        assert!(drawing(&all, &[]).reason().is_some());
        // A mark that points out of the part.
        let marked = Pattern { marks: vec![upward_mark()], ..pattern.clone() };
        let ticked = |to: Vec2| {
            let marks = vec![[moved(&Vec2::new(30.0, 0.0)), moved(&to)]];
            drawing(std::slice::from_ref(&marked), &[WrittenPiece { marks, ..piece(WrittenArc::Bulge(0.4)) }]).bound()
        };
        assert!(ticked(Vec2::new(30.0, 3.0)) < 1e-11 && ticked(Vec2::new(30.0, 2.0)) < 1e-11);
        assert!(ticked(Vec2::new(30.0, -3.0)) > 5.9 && ticked(Vec2::new(32.0, 2.0)) > 1.9);
        // A hole of three arcs is a circle, and only that circle.
        let third = (TAU / 12.0).tan();
        let at = |k: usize| {
            Vec2::new(2.0, 1.0) + Vec2::new((TAU * k as f64 / 3.0).cos(), -(TAU * k as f64 / 3.0).sin()) * 0.5
        };
        let hole = (0..3).map(|k| ContourVertex { point: at(k), bulge: -third, corner: false }).collect();
        let mut with_hole = pattern.clone();
        with_hole.contours.push(Contour { vertices: hole });
        let (centre, size) = with_hole.contours[1].circle().expect("a circle");
        assert!((centre - Vec2::new(2.0, 1.0)).norm() < 1e-12 && (size - 0.5).abs() < 1e-12);
        assert!(with_hole.contours[0].circle().is_none());
        let written = |radius: f64, beside: f64| {
            let mut p = piece(WrittenArc::Bulge(0.4));
            let centre = moved(&Vec2::new(2.0 + beside, 1.0));
            p.contours.push(WrittenContour::Circle { centre, radius });
            drawing(&[with_hole.clone()], &[p])
        };
        assert!(written(0.5, 0.0).bound() < 1e-11, "{:e}", written(0.5, 0.0).bound());
        assert!((0.01..0.0101).contains(&written(0.51, 0.0).bound()));
        assert!((0.01..0.0101).contains(&written(0.5, 0.01).bound()));
        with_hole.contours[1].vertices[1].bulge = third;
        let turned = drawing(
            &[with_hole],
            &[{
                let mut p = piece(WrittenArc::Bulge(0.4));
                p.contours.push(WrittenContour::Circle { centre: moved(&Vec2::new(2.0, 1.0)), radius: 0.5 });
                p
            }],
        );
        assert!(turned.reason().is_some());
    }
}
