//! Where the pieces of a composite meet, and what is proven of it.

use super::options::Options;
use crate::answer::note::Note;
use crate::certify::claim::{Claim, Subject, What};
use crate::certify::flat::fold::fold_apart;
use crate::certify::joints::{joint, Side};
use crate::design::composite::{Composite, Edge, Join, Smoothness};
use crate::reason::{JobReason, Reason};
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use std::collections::BTreeMap;

/// Which side of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Rail(usize),
    First,
    Last,
}

/// A side of a strip, by its index.
type Place = (usize, Which);

/// Two sides that are one line.
struct Meeting {
    places: [Place; 2],
    /// Whether the second runs the other way.
    reversed: bool,
}

/// Claims about gap and angle along every line that two pieces share, and notes that name them. Smooth joins are asked for
/// their angle, folds for how far both sides are apart in the plane, all for their gap.
pub(super) fn joins(composite: &Composite, strips: &[Strip], options: &Options) -> (Vec<Claim>, Vec<Note>) {
    let (mut claims, mut notes) = (Vec::new(), Vec::new());
    for (index, Meeting { places: [a, b], reversed }) in meetings(strips).into_iter().enumerate() {
        let found = joint(&side(strips, a), &side(strips, b), reversed);
        let (first, second) = (&strips[a.0].name, &strips[b.0].name);
        let smooth = is_smooth(composite, strips, a, b);
        let between = [first.clone(), second.clone()];
        let gap = Claim::at_most(What::JoinGap(index), Subject::Whole, found.gap).within(options.tolerance);
        claims.push(gap.because(Reason::from(JobReason::JoinGap { index, between: between.clone() })));
        let angle = Claim::at_most(What::JoinAngle(index), Subject::Whole, found.angle.degrees());
        let limit = options.smooth_angle;
        let seen = found.seen.iter().map(|s| s.1).fold(0.0, f64::max);
        let reason = Reason::from(JobReason::JoinAngle { index, between: between.clone(), seen, limit });
        claims.push(if smooth { angle.within(limit.to_degrees()).because(reason) } else { angle });
        if let Some(sides) = folds(composite, strips, [a, b]) {
            let [p, q] = [(a, sides[0]), (b, sides[1])].map(|(place, side)| (&strips[place.0], side));
            let apart = fold_apart(p, q, options.tolerance);
            let reason = JobReason::Fold { index, between: between.clone(), apart: apart.value() };
            let claim = Claim::at_most(What::FoldGap(index), Subject::Whole, apart);
            claims.push(claim.within(options.tolerance).because(Reason::from(reason)));
        }
        notes.push(Note::Joint { index, between, gap: found.gap, angle: found.angle, smooth });
    }
    (claims, notes)
}

fn side(strips: &[Strip], (k, which): Place) -> Side<'_> {
    match which {
        Which::Rail(side) => Side::Rail(&strips[k], side),
        Which::First => Side::First(&strips[k]),
        Which::Last => Side::Last(&strips[k]),
    }
}

/// Control points of a side, number for number.
fn key(strip: &Strip, which: Which) -> Vec<[u64; 3]> {
    let bits = |c: &[f64; 4]| [c[0], c[1], c[2]].map(|x| (x + 0.0).to_bits());
    let (net, row) = (&strip.patch.control, strip.patch.row());
    match which {
        Which::Rail(side) => net.iter().skip(if side == 0 { 0 } else { row - 1 }).step_by(row).map(bits).collect(),
        Which::First => net[..row].iter().map(bits).collect(),
        Which::Last => net[net.len() - row..].iter().map(bits).collect(),
    }
}

/// Pairs of sides with the same control points, which common unknowns are, in either direction.
fn meetings(strips: &[Strip]) -> Vec<Meeting> {
    let mut seen: BTreeMap<Vec<[u64; 3]>, Vec<(Place, bool)>> = BTreeMap::new();
    let mut out = Vec::new();
    for (k, strip) in strips.iter().enumerate() {
        for which in [Which::Rail(0), Which::Rail(1), Which::First, Which::Last] {
            let own = key(strip, which);
            // A side that is a point joins nothing.
            if own.windows(2).all(|w| w[0] == w[1]) {
                continue;
            }
            let back: Vec<[u64; 3]> = own.iter().rev().copied().collect();
            let turned = back < own;
            let here = seen.entry(if turned { back } else { own }).or_default();
            out.extend(
                here.iter().map(|(other, way)| Meeting { places: [*other, (k, which)], reversed: *way != turned }),
            );
            here.push(((k, which), turned));
        }
    }
    out
}

/// The rails of two pieces of which it is asked that they unfold to one sheet along them.
fn folds(composite: &Composite, strips: &[Strip], places: [Place; 2]) -> Option<[usize; 2]> {
    let [(k, Which::Rail(side)), (_, Which::Rail(other))] = places else { return None };
    let curve = composite.strips[composite.strip(&strips[k].name)?].sides.get(side)?;
    let fold = |j: &Join| matches!(j, Join::Curve { curve: c, edge: Edge::Fold } if c == curve);
    composite.joins.iter().any(fold).then_some([side, other])
}

/// Whether two pieces are asked to go on smoothly where they meet.
fn is_smooth(composite: &Composite, strips: &[Strip], a: Place, b: Place) -> bool {
    let piece = |p: Place| composite.strip(&strips[p.0].name);
    let is_facet = |p: Place| piece(p).is_none();
    if is_facet(a) || is_facet(b) {
        // A planar piece and a strip whose end ruling is a side of it.
        let ruling = |p: Place| !is_facet(p) && matches!(p.1, Which::First | Which::Last);
        return ruling(a) || ruling(b);
    }
    let name = |p: Place| &strips[p.0].name;
    match (a.1, b.1) {
        (Which::Rail(side), Which::Rail(_)) => {
            let curve = piece(a).map(|k| &composite.strips[k].sides[side]);
            let planes = strips[a.0].kind == PanelKind::Plane && strips[b.0].kind == PanelKind::Plane;
            !planes
                && composite
                    .joins
                    .iter()
                    .any(|j| matches!(j, Join::Curve { curve: c, edge: Edge::Smooth } if Some(c) == curve))
        }
        (Which::First | Which::Last, Which::First | Which::Last) => composite.joins.iter().any(|j| {
            matches!(j, Join::Ruling { first, second, smoothness }
                if *smoothness != Smoothness::G0
                    && ((first == name(a) && second == name(b)) || (first == name(b) && second == name(a))))
        }),
        _ => false,
    }
}
