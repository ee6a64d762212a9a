//! A part that was bent back beside its panels: which rulings belong on which panel, and where; judged by
//! [`crate::certify::refolded`], which relies on nothing that is found here.
//!
//! *Method* (docs/algorithms/refold.md, "What is proven"; the maps are isometric, \[DC76\]). The outline is followed from ruling
//! to ruling of the strip that was laid. Every ruling gets the parameters of its panel by the panel's own flat image. Where a
//! strip runs over several panels, the outline of each is closed along the ruling between them. Borders of panels are
//! matched by their nearest places.

mod matched;
mod seat;
mod shares;
mod tip;

use crate::certify::claim::UpperBound;
use crate::certify::refolded::{distance, Along, JudgedPanel, SpanChord, Stretch, Unshown};
use crate::control::Control;
use crate::develop::refold::atlas::{Atlas, OnPanel, PlacedPanel};
use crate::develop::refold::drawn::FlatPart;
use crate::develop::refold::leaf::{Leaf, Refolded};
use crate::geom::placement::Placement;
use crate::geom::Vec2;
use crate::num::parallel;
use crate::spline::surface::Surface;
use crate::torse::ribbon::pose::Pose;
use crate::torse::ribbon::{Ribbon, Span, Spot};
use matched::{beside, nearest, Metric};
use seat::{creases, places, Seat, Straight, BEYOND, NOTHING, SAME};
use shares::{shares, Share, ON_RULING};
use tip::Tip;

/// Turn (rad) over a span that is judged at most.
const FINE: f64 = 4e-3;
/// What enclosures of second derivatives over a span may leave (share of the size of the part): spans of wide bends are finer.
const NEAR: f64 = 1e-6;
/// Times by which they are finer at most.
const FINER: f64 = 4.0;

/// Why a part bent back was not compared with its panels, or no bound was shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotRefolded {
    /// Its panels cannot be laid beside its drawing, for a reason that an error gave.
    #[error("{0}")]
    Panels(String),
    /// The job was asked to stop.
    #[error("the job was stopped before it was done")]
    Stopped,
    /// No sample is on both.
    #[error("no sample is on both")]
    NoSample,
    /// It was not compared at all.
    #[error("it was not compared")]
    NotCompared,
    /// A panel that was not read exactly.
    #[error("it was not read exactly")]
    NotExact,
    /// A panel that belongs to several bends.
    #[error("it belongs to several bends")]
    Several,
    /// An outline that leaves the rulings that were laid.
    #[error("its outline reaches beyond the rulings that its bend lines tell of")]
    Beyond,
    /// A panel that belongs to no bend.
    #[error("no bend belongs to it")]
    None,
    /// Panels of which some could not be proven.
    #[error("{open} of its {of} panels could not be proven")]
    Open {
        /// How many.
        open: usize,
        /// Of how many.
        of: usize,
    },
    /// What the judge could not show.
    #[error(transparent)]
    Unshown(#[from] Unshown),
}

/// What is proven of one panel.
#[derive(Clone, Debug)]
pub(crate) struct PanelBound {
    /// Its name.
    pub name: String,
    /// Bound (mm) of the distance between it and what belongs to it of the part bent back, both ways and with the edges; why
    /// none was shown.
    pub found: Result<UpperBound, NotRefolded>,
}

/// What is proven of a part bent back and moved: for each of its panels, in their order. Each is judged for itself with its own
/// stretch of the part, so that one that cannot be proven costs no other its proof.
pub(crate) fn distance_bounds(
    part: &FlatPart,
    refolded: &Refolded,
    (atlas, motion): (&Atlas, &Placement),
    control: &Control,
) -> Vec<PanelBound> {
    let mut found: Vec<Option<Result<UpperBound, NotRefolded>>> = vec![None; atlas.panels.len()];
    let assessed = |leaf: &Leaf| -> Vec<(usize, Result<UpperBound, NotRefolded>)> {
        let ribbon = fine(&leaf.ribbon, motion, &joints(&leaf.ribbon, atlas), NEAR * part.size());
        let one = |share: Share| {
            let going = if control.stopped() { Err(NotRefolded::Stopped) } else { Ok(()) };
            (share.panel, going.and_then(|()| assessed(part, share, (atlas, control))))
        };
        parallel::map(shares(part, leaf, &ribbon, atlas), one)
    };
    let leaves: Vec<&Leaf> = refolded.leaves.iter().filter(|l| !l.is_taken_up()).collect();
    for (panel, one) in parallel::map(leaves, assessed).into_iter().flatten() {
        // A panel in two places has no one border.
        found[panel] = Some(if found[panel].is_some() { Err(NotRefolded::Several) } else { one });
    }
    let named = |(found, panel): (Option<_>, &PlacedPanel)| PanelBound {
        name: panel.panel.name.clone(),
        found: found.unwrap_or(Err(NotRefolded::None)),
    };
    found.into_iter().zip(&atlas.panels).map(named).collect()
}

/// Places on the rulings at which panels begin and end, where there are several, and at which their patches are less than C¹.
fn joints(ribbon: &Ribbon, atlas: &Atlas) -> Vec<f64> {
    let turns = ribbon.spans.iter().any(|s| s.in_space.turn != 0.0);
    let several = atlas.panels.len() > 1 && ribbon.spans.len() > 1;
    let mut places = Vec::new();
    for (panel, s) in atlas.panels.iter().enumerate() {
        let on = |uv: [f64; 2]| OnPanel { panel, uv, off: 0.0 };
        if several {
            // In the middle of their sides: a corner may be the tip in which many rulings meet.
            let corners = &s.panel.corners;
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            places.extend(sides.map(|(a, b)| on([0, 1].map(|d: usize| 0.5 * (a[d] + b[d])))));
        }
        let knots = &s.panel.surface.knots_u;
        let ways = || s.panel.loops.iter().flatten().map(|p| p[1]);
        let middle = 0.5 * (ways().fold(f64::INFINITY, f64::min) + ways().fold(f64::NEG_INFINITY, f64::max));
        places.extend(creases(knots).into_iter().filter(|_| turns).map(|(t, _)| on([t, middle])));
    }
    places.iter().filter_map(|on| ribbon.locate(&atlas.flat(on))).map(|spot| spot.t).collect()
}

/// The rulings laid closer, where the part is in space, and cut at given places; `near` (mm) is what wide bends may leave.
fn fine(ribbon: &Ribbon, motion: &Placement, cuts: &[f64], near: f64) -> Ribbon {
    let moved = |p: &Pose| Pose { axes: motion.linear * p.axes, at: motion.point(&p.at) };
    let mut spans = Vec::with_capacity(ribbon.spans.len());
    for (k, s) in ribbon.spans.iter().enumerate() {
        let turn = s.in_space.turn.hypot(s.in_space.spin);
        // A second derivative is about the turn times the way across; twice an eighth of it counts.
        let speed = |v: f64| (s.in_plane.across + v * s.in_plane.spin).abs();
        let wide = speed(s.reach[0]).max(speed(s.reach[1]));
        let least = (s.in_space.turn.abs() * wide / (4.0 * near)).sqrt();
        let least = if least.is_finite() { least } else { 0.0 };
        let n = (turn / FINE).max(least.min(FINER * turn / FINE)).ceil().clamp(1.0, MOST_OF_SPAN) as usize;
        let mut shares: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
        let inner = |c: &f64| shares.iter().all(|x| (x - c).abs() * n as f64 > APART);
        let more: Vec<f64> = cuts.iter().map(|t| t - k as f64).filter(|c| *c > 0.0 && *c < 1.0).filter(inner).collect();
        shares.extend(more);
        shares.sort_by(f64::total_cmp);
        // Corners of neighbours are one place.
        shares.dedup_by(|b, a| (*b - *a) * n as f64 <= APART);
        spans.extend(shares.windows(2).map(|w| {
            let part = s.part([w[0], w[1]]);
            Span { space: moved(&part.space), ..part }
        }));
    }
    Ribbon { spans }
}

/// Share of a part of a span within which places are one.
const APART: f64 = 1e-3;
/// Parts of one span at most.
const MOST_OF_SPAN: f64 = 4096.0;

/// A place on a ribbon, and on the drawing.
type Seen = (f64, f64, Vec2);

/// Pieces from ruling to ruling through places that follow each other.
fn pieces(places: &[Seen], end: f64) -> impl Iterator<Item = SpanChord> + '_ {
    places.windows(2).map(move |pair| {
        let ((t, v, p), (u, w, q)) = (pair[0], pair[1]);
        let span = (0.5 * (t + u)).floor().clamp(0.0, end - 1.0);
        let ends = [[(t - span).clamp(0.0, 1.0), v], [(u - span).clamp(0.0, 1.0), w]];
        SpanChord { span: span as usize, ends, border: [0.0; 2], drawn: Some([p, q]) }
    })
}

/// Rulings between two places, in the order from one to the other.
fn crossed(t: f64, u: f64) -> Vec<f64> {
    let (low, high) = (t.min(u), t.max(u));
    let mut out: Vec<f64> = (low.floor() as usize + 1..).map(|k| k as f64).take_while(|x| *x < high).collect();
    if u < t {
        out.reverse();
    }
    out
}

/// Diagonal of the box around a polygon, mm.
fn size(polygon: &[Vec2]) -> f64 {
    let first = polygon.first().copied().unwrap_or_else(Vec2::zeros);
    let (lo, hi) = polygon.iter().fold((first, first), |(lo, hi), q| (lo.inf(q), hi.sup(q)));
    (hi - lo).norm()
}

/// A closed polygon of the plane on the rulings: pieces from ruling to ruling, without their borders; around the tip of a
/// cone, if it has one.
fn lifted(ribbon: &Ribbon, polygon: &[Vec2], tip: Option<&Tip>) -> Option<Vec<SpanChord>> {
    let end = ribbon.end();
    let slack = ON_RULING * size(polygon);
    let split = tip.and_then(|tip| Some((tip, tip.split(polygon)?)));
    let corners = split.as_ref().map_or(polygon, |s| &s.1 .0);
    let spots: Vec<Seen> = parallel::map(corners.iter(), |q| {
        let spot = ribbon.locate(q)?;
        let beyond = (-spot.t).max(spot.t - end).max(0.0);
        let rates = &ribbon.span(spot.t).0.in_plane;
        let near = beyond <= BEYOND || beyond * (rates.across + spot.v * rates.spin).abs() <= slack;
        // By less beside a ruling the next piece would begin on its other side; what is drawn is judged where it is.
        let t = Some(spot.t.round()).filter(|on| (spot.t - on).abs() <= SAME).unwrap_or(spot.t);
        near.then_some((t.clamp(0.0, end), spot.v, *q))
    })
    .into_iter()
    .collect::<Option<_>>()?;
    let mut out = Vec::with_capacity(2 * polygon.len());
    let sides = if split.is_some() { spots.len() - 1 } else { spots.len() };
    for k in 0..sides {
        let (first, last) = (spots[k], spots[(k + 1) % spots.len()]);
        let ((t, _, from), (u, _, to)) = (first, last);
        let on_ruling = |x: f64| -> Seen {
            let pose = ribbon.flat(x);
            let side = |q: &Vec2| (q - pose.at.xy()).dot(&pose.across().xy());
            let (p, q) = (side(&from), side(&to));
            let at = from + (to - from) * (p / (p - q)).clamp(0.0, 1.0);
            (x, (at - pose.at.xy()).dot(&pose.ruling().xy()), at)
        };
        let mut places = vec![first];
        for next in crossed(t, u).into_iter().map(on_ruling).chain([last]) {
            let before = places[places.len() - 1];
            let n = straight_pieces(ribbon, before, next, NEAR * size(polygon));
            places.extend((1..n).map(|i| on_ruling(before.0 + (next.0 - before.0) * i as f64 / n as f64)));
            places.push(next);
        }
        out.extend(pieces(&places, end));
    }
    if let Some((tip, (_, beside))) = split {
        // To the tip, from ruling to ruling beside it, and back.
        let (before, behind) = (*spots.last()?, *spots.first()?);
        // Ways count from another point on every ruling, but the part is on one side of the tip.
        let side = (before.1 - tip.on(ribbon, before.0)).signum();
        let way = |t: f64| tip.on(ribbon, t) + tip.around * side;
        let mut drawn = beside.iter().copied();
        let mut at = drawn.next()?;
        let mut places = vec![before, (before.0, way(before.0), at)];
        for x in crossed(before.0, behind.0) {
            at = drawn.next().unwrap_or(at);
            places.push((x, way(x), at));
        }
        // What is left of the corners beside the tip lies at its last ruling.
        places.extend(drawn.map(|q| (behind.0, way(behind.0), q)));
        places.push((behind.0, way(behind.0), *beside.last()?));
        places.push(behind);
        out.extend(pieces(&places, end));
    }
    Some(out)
}

/// Pieces into which a side between two places of one span is to be cut so that what is straight in the parameters of the span lies within
/// `near` (mm) of each.
fn straight_pieces(ribbon: &Ribbon, (t, v, _): Seen, (u, w, _): Seen, near: f64) -> usize {
    let rates = &ribbon.span(0.5 * (t + u)).0.in_plane;
    let speed = rates.along.hypot(rates.across) + v.abs().max(w.abs()) * rates.spin.abs();
    let (ds, dv) = ((u - t).abs(), (w - v).abs());
    let beside = 0.125 * ds * rates.spin.abs() * (ds * speed + 2.0 * dv);
    (beside / near).sqrt().ceil().clamp(1.0, MOST_PARTS) as usize
}

/// Share of the size of a part by which its outline may go beyond the rulings that its bend lines tell of: what drawings may be off.
const REACHES: f64 = 1e-3;

/// The rulings with what goes on beyond the first and last one as they do, as far as polygons reach, at most so far (mm).
fn reaching(ribbon: Ribbon, loops: &[Vec<Vec2>], most: f64) -> Ribbon {
    let end = ribbon.end();
    let mut beyond = [0.0_f64; 2];
    let places: Vec<&Vec2> = loops.iter().flatten().collect();
    let spots: Vec<Spot> = parallel::map(places, |q| ribbon.locate(q)).into_iter().flatten().collect();
    for spot in spots {
        let rates = &ribbon.span(spot.t).0.in_plane;
        let over = [-spot.t, spot.t - end];
        for (all, x) in beyond.iter_mut().zip(over) {
            if x > BEYOND && x * (rates.across + spot.v * rates.spin).abs() <= most {
                *all = all.max(x);
            }
        }
    }
    let mut spans = ribbon.spans;
    if let Some(first) = spans.first().copied().filter(|_| beyond[0] > 0.0) {
        spans.insert(0, first.part([-beyond[0], 0.0]));
    }
    if let Some(last) = spans.last().copied().filter(|_| beyond[1] > 0.0) {
        spans.push(last.part([1.0, 1.0 + beyond[1]]));
    }
    Ribbon { spans }
}

/// The rulings no farther than the part reaches: its bend lines tell of rulings beyond, which are on no panel.
fn ended(ribbon: Ribbon, lines: &mut [Vec<SpanChord>]) -> Ribbon {
    let all = || lines.iter().flatten();
    let Some((first, last)) = all().map(|p| p.span).min().zip(all().map(|p| p.span).max()) else { return ribbon };
    let shares = |k: usize| all().filter(move |p| p.span == k).flat_map(|p| p.ends).map(|e| e[0]);
    let (low, high) = (shares(first).fold(1.0, f64::min), shares(last).fold(0.0, f64::max));
    let mut spans = ribbon.spans[first..=last].to_vec();
    let ends = |k: usize| [if k == first { low } else { 0.0 }, if k == last { high } else { 1.0 }];
    let cut = |k: usize, turn: f64| {
        let [from, to] = ends(k);
        let wide = to - from;
        (turn != 0.0 && wide > SAME && wide < 1.0 - SAME).then_some([from, to])
    };
    let cuts: Vec<Option<[f64; 2]>> = (first..).zip(&spans).map(|(k, s)| cut(k, s.in_space.turn)).collect();
    for (span, cut) in spans.iter_mut().zip(&cuts) {
        *span = cut.map_or(*span, |cut| span.part(cut));
    }
    for p in lines.iter_mut().flatten() {
        p.span -= first;
        if let Some([from, to]) = cuts[p.span] {
            p.ends = p.ends.map(|[s, v]| [((s - from) / (to - from)).clamp(0.0, 1.0), v]);
        }
    }
    Ribbon { spans }
}

/// Share of the size by which the places of a span on its panel may be uneven.
const UNEVEN: f64 = 5e-6;
/// Parts of a span, and pieces of a side between two rulings, at most.
const MOST_PARTS: f64 = 64.0;

/// Rulings with what is on them of the part, and where they are on their panel.
struct Seated {
    ribbon: Ribbon,
    lines: Vec<Vec<SpanChord>>,
    places: Vec<Along>,
}

impl Seated {
    fn new(
        ribbon: Ribbon,
        (loops, size): (&[Vec<Vec2>], f64),
        seat: &Seat,
        straight: Straight,
    ) -> Result<Self, NotRefolded> {
        let tip = Tip::of(size, &ribbon, seat.atlas, seat.panel);
        let lines = loops.iter().map(|l| lifted(&ribbon, l, tip.as_ref())).collect::<Option<Vec<_>>>();
        let mut lines = lines.ok_or(NotRefolded::Beyond)?;
        let ribbon = ended(ribbon, &mut lines);
        let places = places(&ribbon.spans, &lines, seat, (tip.as_ref(), straight));
        Ok(Self { ribbon, lines, places })
    }

    /// Into how many parts spans are to be cut so that what is between their first and last ruling lies on the panel as evenly as on
    /// them, within `near` (mm): patches may have parameters that are not.
    fn parts(&self, surface: &Surface, near: f64) -> Vec<usize> {
        let mut reach = vec![NOTHING; self.ribbon.spans.len()];
        for p in self.lines.iter().flatten() {
            let own = &mut reach[p.span];
            p.ends.iter().for_each(|e| *own = [own[0].min(e[1]), own[1].max(e[1])]);
        }
        let count = |(k, span): (usize, &Span)| {
            let off = |share: f64, v: f64| {
                let [a, b] = [&self.places[k], &self.places[k + 1]];
                let (a, b) = (a.place(v), b.place(v));
                let at = |d: usize| (1.0 - share) * a[d] + share * b[d];
                surface.point(at(0), at(1)) - span.space.moved(&span.in_space, share).point(v, 0.0)
            };
            let sag = |v: f64| (off(0.5, v) - (off(0.0, v) + off(1.0, v)) * 0.5).norm();
            let worst = reach[k].into_iter().filter(|v| v.is_finite()).map(sag).fold(0.0, f64::max);
            (worst / near).sqrt().ceil().clamp(1.0, MOST_PARTS) as usize
        };
        parallel::map(self.ribbon.spans.iter().enumerate(), count)
    }
}

/// Judges the spans of one panel: in its plane where it is plane, else by its parameters; where places on it fold that are quadratic
/// along rulings, with linear ones.
fn assessed(part: &FlatPart, share: Share, (atlas, control): (&Atlas, &Control)) -> Result<UpperBound, NotRefolded> {
    let panel = &atlas.panels[share.panel].panel;
    let judge = |judged: &JudgedPanel, straight: Straight| {
        let seat = Seat::new(atlas, share.panel, judged);
        assessed_as(part, share.clone(), (&seat, control), straight)
    };
    let in_plane = JudgedPanel::in_plane(&panel.surface, &panel.loops);
    if let Some(found) = in_plane.and_then(|judged| judge(&judged, Straight::Taken).ok()) {
        return Ok(found);
    }
    let judged = JudgedPanel::by_parameters(&panel.surface, &panel.loops);
    match judge(&judged, Straight::Not) {
        Err(NotRefolded::Unshown(Unshown::Folds)) => judge(&judged, Straight::Taken),
        found => found,
    }
}

fn assessed_as(
    part: &FlatPart,
    Share { ribbon, loops, .. }: Share,
    (seat, control): (&Seat, &Control),
    straight: Straight,
) -> Result<UpperBound, NotRefolded> {
    let size = part.size();
    let surface = seat.judged.surface();
    let ribbon = reaching(ribbon, &loops, REACHES * size);
    let mut seated = Seated::new(ribbon, (&loops, size), seat, straight)?;
    let parts = seated.parts(surface, UNEVEN * size);
    if parts.iter().any(|n| *n > 1) && !control.stopped() {
        seated = Seated::new(seated.ribbon.parted(&parts), (&loops, size), seat, straight)?;
    }
    let Seated { ribbon, lines, places } = seated;
    let spans = &ribbon.spans[..];
    let on_patch = |p: &SpanChord, [s, v]: [f64; 2]| {
        let [a, b] = [0, 1].map(|k: usize| places[p.span + k].place(v));
        let of = |d: usize| (1.0 - s) * a[d] + s * b[d];
        Vec2::new(of(0), of(1))
    };
    let polygon = |l: &Vec<[f64; 2]>| l.iter().map(|p| Vec2::new(p[0], p[1])).collect();
    let borders: Vec<Vec<Vec2>> = seat.judged.borders().iter().map(polygon).collect();
    let metric = Metric::of(surface);
    let mut matched = Vec::new();
    for line in lines {
        let first = on_patch(&line[0], line[0].ends[0]);
        let here = metric.at(&first);
        let off = |k: usize| nearest(&borders[k], &first, &here).1;
        let border = (0..borders.len()).min_by(|a, b| off(*a).total_cmp(&off(*b))).ok_or(Unshown::Lines)?;
        matched.push((border, beside(line, &borders[border], &metric, &on_patch)));
    }
    if control.stopped() {
        return Err(NotRefolded::Stopped);
    }
    Ok(distance(&Stretch { spans, places, lines: matched, panel: seat.judged, chords: part.chords }, control)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::ribbon::pose::Rates;

    /// Corners that lie beside a ruling by rounding alone are on it: every piece begins where the one before ends, on its span.
    #[test]
    fn pieces_follow_each_other_past_corners_that_hardly_miss_a_ruling() {
        let rates = Rates { turn: 0.0, spin: 0.0, along: 0.0, across: 1.0 };
        let first = Pose::flat(Vec2::zeros(), Vec2::x());
        let span = |k: i32| {
            let pose = first.moved(&rates, f64::from(k));
            Span { flat: pose, space: pose, in_plane: rates, in_space: rates, reach: [0.0, 5.0] }
        };
        let ribbon = Ribbon { spans: (0..1800).map(span).collect() };
        let place = |t: f64, v: f64| ribbon.flat(t).point(v, 0.0).xy();
        let spacing = 1729.0 * f64::EPSILON;
        for hair in (-4..=4).map(|k| f64::from(k) * 0.5 * spacing) {
            let at = 1729.0 + hair;
            let polygon = [place(1700.0, 0.0), place(at, 0.0), place(1750.0, 1.0), place(at, 4.0), place(1700.0, 5.0)];
            let pieces = lifted(&ribbon, &polygon, None).expect("pieces");
            for (p, q) in pieces.iter().zip(pieces.iter().cycle().skip(1)) {
                let here = |p: &SpanChord, k: usize| (p.span as f64 + p.ends[k][0], p.ends[k][1]);
                let same_span = p.span == q.span || [p.ends[1][0], q.ends[0][0]].iter().all(|s| *s == 0.0 || *s == 1.0);
                assert!(here(p, 1) == here(q, 0) && same_span, "{hair:e}: {p:?} {q:?}");
            }
        }
    }
}
