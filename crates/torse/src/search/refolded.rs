//! A part that was bent back beside its panels: which rulings belong on which panel, and where; judged by
//! [`crate::certify::refolded`], which relies on nothing that is found here.
//!
//! *Method* (docs/algorithms/refold.md, "What is proven"; the maps are isometric, \[DC76\]). The outline is followed from ruling
//! to ruling of the strip that was laid. Every ruling gets the parameters of its panel by the panel's own flat image. Where a
//! strip runs over several panels, the outline of each is closed along the ruling between them. Borders of panels are
//! matched by their nearest places.

mod shares;

use crate::certify::claim::UpperBound;
use crate::certify::refolded::{distance, Along, SpanChord, Stretch, Unshown};
use crate::control::Control;
use crate::develop::refold::atlas::{Atlas, OnPanel, PlacedPanel};
use crate::develop::refold::drawn::FlatPart;
use crate::develop::refold::leaf::{Leaf, Refolded};
use crate::geom::placement::Placement;
use crate::geom::Vec2;
use crate::num::parallel;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::ribbon::pose::Pose;
use crate::torse::ribbon::{Ribbon, Span, Spot};
use nalgebra::Matrix2;
use shares::{shares, Share, ON_RULING};

/// Turn (rad) over a span that is judged at most.
const FINE: f64 = 4e-3;
/// What enclosures of second derivatives over a span may leave (share of the size of the part): spans of wide bends are finer.
const NEAR: f64 = 1e-6;
/// Times by which they are finer at most.
const FINER: f64 = 4.0;
/// How far (in spans) an outline may lie beyond the rulings that were laid: rounding of tables.
const BEYOND: f64 = 1e-3;
/// Rulings with so little of the part on them (share of its size) are looked at as if it were so much.
const SHORT: f64 = 1e-3;

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

/// The tip of a cone in the plane, where rulings have no places: outlines go around it.
struct Tip {
    at: Vec2,
    /// How far from it they keep, mm.
    around: f64,
}

impl Tip {
    /// Where all rulings of a part on a panel meet, if they do so at an end of the panel.
    fn of(size: f64, ribbon: &Ribbon, atlas: &Atlas, panel: usize) -> Option<Self> {
        let meet = |s: &Span| {
            let (pose, rates) = (&s.flat, &s.in_plane);
            pose.at.xy() - pose.ruling().xy() * (rates.across / rates.spin)
        };
        let at = meet(ribbon.spans.get(ribbon.spans.len() / 2)?);
        // Rulings that are parallel meet nowhere.
        let farther = |most: f64, off: f64| if off.is_nan() { f64::INFINITY } else { most.max(off) };
        let apart = ribbon.spans.iter().map(|s| (meet(s) - at).norm()).fold(0.0, farther);
        let corners = atlas.panels[panel].panel.loops.iter().flatten();
        // Panels end a hair before their tips.
        let hair = corners.map(|uv| (atlas.flat(&OnPanel { panel, uv: *uv, off: 0.0 }) - at).norm());
        let around = (ROOM * hair.fold(f64::INFINITY, f64::min)).max(ONE_POINT * size).max(2.0 * apart);
        (apart <= NEARLY_ONE_POINT * size && around < SHORT * size).then_some(Self { at, around })
    }

    /// Way along the ruling at a place to the tip.
    fn on(&self, ribbon: &Ribbon, t: f64) -> f64 {
        let pose = ribbon.flat(t);
        (self.at - pose.at.xy()).dot(&pose.ruling().xy())
    }

    /// The corners of a polygon from the first one behind the tip to the last one before it, and those between these beside the
    /// tip; `None` where there are not one run of each.
    fn split(&self, polygon: &[Vec2]) -> Option<(Vec<Vec2>, Vec<Vec2>)> {
        let near = |q: &Vec2| (q - self.at).norm() <= self.around;
        let n = polygon.len();
        let first = (0..n).find(|&k| near(&polygon[(k + n - 1) % n]) && !near(&polygon[k]))?;
        let turned: Vec<Vec2> = (0..n).map(|k| polygon[(first + k) % n]).collect();
        let count = turned.iter().take_while(|q| !near(q)).count();
        turned[count..].iter().all(near).then(|| (turned[..count].to_vec(), turned[count..].to_vec()))
    }
}

/// Share of the size of a part within which rulings that were laid meet in one point, which is known to what lines of files are.
const NEARLY_ONE_POINT: f64 = 1e-5;
/// Least way around it, as a share of the size; twice what rulings miss it by, if that is more.
const ONE_POINT: f64 = 1e-6;
/// Way around a tip, in lengths of what a panel leaves of it: that the line goes around it counts once as distance from the outline, and
/// what it is farther off than the panel as distance from its border.
const ROOM: f64 = 1.1;

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
        near.then_some((spot.t.clamp(0.0, end), spot.v, *q))
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

/// Shares of a span that are one place.
const SAME: f64 = 1e-9;

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

/// Whether rulings of a part are straight in the parameters of their panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Straight {
    /// They are taken for straight.
    Taken,
    /// They are not where rulings of the panel lie across them.
    Not,
}

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
        (atlas, panel): (&Atlas, usize),
        straight: Straight,
    ) -> Result<Self, NotRefolded> {
        let tip = Tip::of(size, &ribbon, atlas, panel);
        let lines = loops.iter().map(|l| lifted(&ribbon, l, tip.as_ref())).collect::<Option<Vec<_>>>();
        let mut lines = lines.ok_or(NotRefolded::Beyond)?;
        let ribbon = ended(ribbon, &mut lines);
        let places = places(&ribbon.spans, &lines, (atlas, panel), (tip.as_ref(), straight));
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

/// Judges the spans of one panel; where places on it fold that are quadratic along rulings, with linear ones.
fn assessed(part: &FlatPart, share: Share, given: (&Atlas, &Control)) -> Result<UpperBound, NotRefolded> {
    match assessed_as(part, share.clone(), given, Straight::Not) {
        Err(NotRefolded::Unshown(Unshown::Folds)) => assessed_as(part, share, given, Straight::Taken),
        found => found,
    }
}

fn assessed_as(
    part: &FlatPart,
    Share { ribbon, panel, loops }: Share,
    (atlas, control): (&Atlas, &Control),
    straight: Straight,
) -> Result<UpperBound, NotRefolded> {
    let size = part.size();
    let ribbon = reaching(ribbon, &loops, REACHES * size);
    let mut seated = Seated::new(ribbon, (&loops, size), (atlas, panel), straight)?;
    let parts = seated.parts(&atlas.panels[panel].panel.surface, UNEVEN * size);
    if parts.iter().any(|n| *n > 1) && !control.stopped() {
        seated = Seated::new(seated.ribbon.parted(&parts), (&loops, size), (atlas, panel), straight)?;
    }
    let Seated { ribbon, lines, places } = seated;
    let spans = &ribbon.spans[..];
    let panel = &atlas.panels[panel].panel;
    let on_patch = |p: &SpanChord, [s, v]: [f64; 2]| {
        let [a, b] = [0, 1].map(|k: usize| places[p.span + k].place(v));
        let of = |d: usize| (1.0 - s) * a[d] + s * b[d];
        Vec2::new(of(0), of(1))
    };
    let polygon = |l: &Vec<[f64; 2]>| l.iter().map(|p| Vec2::new(p[0], p[1])).collect();
    let borders: Vec<Vec<Vec2>> = panel.loops.iter().map(polygon).collect();
    let metric = Metric::of(&panel.surface);
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
    let (surface, borders, chords) = (&panel.surface, &panel.loops[..], part.chords);
    Ok(distance(&Stretch { spans, places, lines: matched, surface, borders, chords }, control)?)
}

/// Share of a piece within which a corner of the border is at its end.
const AT_END: f64 = 1e-6;

/// Lengths on a patch.
struct Metric<'a> {
    surface: &'a Surface,
    /// In the middle of the patch.
    even: Matrix2<f64>,
}

/// Share of the lengths in the middle of a patch that count everywhere: at a tip all rulings are one point.
const EVEN: f64 = 1e-6;

impl<'a> Metric<'a> {
    fn of(surface: &'a Surface) -> Self {
        let ((u0, u1), (v0, v1)) = surface.domain();
        Self { surface, even: first_form(surface, &Vec2::new(0.5 * (u0 + u1), 0.5 * (v0 + v1))) }
    }

    /// The square of a length about a place, as a form in the parameters.
    fn at(&self, uv: &Vec2) -> Matrix2<f64> {
        first_form(self.surface, uv) + self.even * EVEN
    }
}

/// Scalar products of both derivatives of a patch.
fn first_form(surface: &Surface, uv: &Vec2) -> Matrix2<f64> {
    let jet = surface.jet(uv.x, uv.y);
    let mixed = jet.du.dot(&jet.dv);
    Matrix2::new(jet.du.norm_squared(), mixed, mixed, jet.dv.norm_squared())
}

/// A closed line with its places on the border of its panel, a polygon: cut where the border turns, because sides of the border
/// are as long as they are, and pieces that went around a corner would be compared with the wrong side of it.
fn beside(
    line: Vec<SpanChord>,
    border: &[Vec2],
    metric: &Metric,
    on_patch: &(impl Fn(&SpanChord, [f64; 2]) -> Vec2 + Sync),
) -> Vec<SpanChord> {
    let (n, corners) = (line.len(), border.len() as f64);
    let place = |q: Vec2| nearest(border, &q, &metric.at(&q)).0;
    let mut at = vec![place(on_patch(&line[0], line[0].ends[0]))];
    let behind: Vec<f64> = parallel::map(line.iter(), |p| place(on_patch(p, p.ends[1])));
    for here in behind {
        let last = at[at.len() - 1];
        // The shorter way.
        let step = (here - last).rem_euclid(corners);
        at.push(last + if step > 0.5 * corners { step - corners } else { step });
    }
    let share = |p: &SpanChord, corner: f64| {
        let [a, b] = p.ends.map(|e| on_patch(p, e));
        let x = border[(corner as i64).rem_euclid(border.len() as i64) as usize];
        let way = metric.at(&a) * (b - a);
        way.dot(&(x - a)) / way.dot(&(b - a))
    };
    // Corners between the places of both ends, in the direction of the piece.
    let between = |a: f64, b: f64| {
        let mut all: Vec<f64> =
            (a.min(b).floor() as i64 + 1..).map(|k| k as f64).take_while(|x| *x < a.max(b)).collect();
        if b < a {
            all.reverse();
        }
        all
    };
    for (k, p) in line.iter().enumerate() {
        for c in between(at[k], at[k + 1]) {
            let x = share(p, c);
            if x <= AT_END {
                // The first place is the last one too.
                if k == 0 {
                    at[n] += c - at[0];
                }
                at[k] = c;
            } else if x >= 1.0 - AT_END {
                if k + 1 == n {
                    at[0] += c - at[n];
                }
                at[k + 1] = c;
                break;
            }
        }
    }
    let mut out = Vec::with_capacity(n);
    for (k, p) in line.into_iter().enumerate() {
        let mut rest = SpanChord { border: [at[k], at[k + 1]], ..p };
        let mut done = 0.0;
        for c in between(at[k], at[k + 1]) {
            let x = share(&p, c);
            if !(x > done + AT_END && x < 1.0 - AT_END) {
                continue;
            }
            let part = |a: f64, b: f64| a + (b - a) * (x - done) / (1.0 - done);
            let [[s, v], [t, w]] = rest.ends;
            let place = [part(s, t), part(v, w)];
            let drawn = rest.drawn.map(|[a, b]| (a, a + (b - a) * ((x - done) / (1.0 - done)), b));
            out.push(SpanChord {
                ends: [rest.ends[0], place],
                border: [rest.border[0], c],
                drawn: drawn.map(|(a, m, _)| [a, m]),
                ..rest
            });
            rest = SpanChord {
                ends: [place, rest.ends[1]],
                border: [c, rest.border[1]],
                drawn: drawn.map(|(_, m, b)| [m, b]),
                ..rest
            };
            done = x;
        }
        out.push(rest);
    }
    out
}

/// Place on a closed polygon nearest to a point (number of a corner and share of the way to the next), and its distance, with
/// lengths as they are about the point.
fn nearest(polygon: &[Vec2], q: &Vec2, metric: &Matrix2<f64>) -> (f64, f64) {
    let mut best = (0.0, f64::INFINITY);
    for (k, p) in polygon.iter().enumerate() {
        let d = polygon[(k + 1) % polygon.len()] - p;
        let way = metric * d;
        let share = way.dot(&(q - p)) / way.dot(&d);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let away = q - p - d * share;
        let off = (metric * away).dot(&away);
        if off < best.1 {
            best = (k as f64 + share, off);
        }
    }
    (best.0, best.1.max(0.0).sqrt())
}

/// Inner parameters at which a patch is less than C¹, and how near to one is on it.
fn creases(knots: &Knots) -> Vec<(f64, f64)> {
    let (first, last) = knots.domain();
    let inner = knots.distinct().into_iter().filter(|(t, m)| *m >= knots.degree() && *t > first && *t < last);
    inner.map(|(t, _)| (t, SAME * (last - first))).collect()
}

/// No stretch of a ruling.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Where the rulings of spans are on their panel: by the flat image of two of their points, and of the one between them.
fn places(
    spans: &[Span],
    lines: &[Vec<SpanChord>],
    (atlas, panel): (&Atlas, usize),
    (tip, along): (Option<&Tip>, Straight),
) -> Vec<Along> {
    let n = spans.len();
    let (mut reach, mut beside) = (vec![NOTHING; n + 1], vec![NOTHING; n + 1]);
    for p in lines.iter().flatten() {
        // A plane is one wide span: what the part has on its first and last ruling is all that is surely on the panel.
        let plane = spans[p.span].in_space.turn == 0.0;
        for (end, k) in [p.span, p.span + 1].into_iter().enumerate() {
            for e in &p.ends {
                let on = !plane || (e[0] - end as f64).abs() <= BEYOND;
                for all in [&mut beside].into_iter().chain(on.then_some(&mut reach)) {
                    all[k] = [all[k][0].min(e[1]), all[k][1].max(e[1])];
                }
            }
        }
    }
    // Where the part ends before a ruling, what is beside that.
    for (own, beside) in reach.iter_mut().zip(beside).filter(|(own, _)| own[0] > own[1]) {
        *own = beside;
    }
    let ways = || lines.iter().flatten().flat_map(|p| p.ends).map(|e| e[1]);
    let size = ways().fold(f64::NEG_INFINITY, f64::max) - ways().fold(f64::INFINITY, f64::min);
    let creases = creases(&atlas.panels[panel].panel.surface.knots_u);
    let place = |k: usize| {
        let pose = if k < n { spans[k].flat } else { spans[n - 1].flat.moved(&spans[n - 1].in_plane, 1.0) };
        let [mut a, mut b] = reach[k];
        if b.is_nan() || a.is_nan() || b - a < SHORT * size {
            let middle = if a.is_finite() { 0.5 * (a + b) } else { 0.0 };
            (a, b) = (middle - 0.5 * SHORT * size, middle + 0.5 * SHORT * size);
        }
        // Beside a tip the least shift of the drawing is another ruling.
        let beside_tip = tip.map(|tip| (tip.at - pose.at.xy()).dot(&pose.ruling().xy()));
        if let Some(t) = beside_tip {
            let far = if (a - t).abs() > (b - t).abs() { a } else { b };
            (a, b) = (far, 0.5 * (far + t));
        }
        let middle = 0.5 * (a + b);
        let [p, m, q] = [a, middle, b].map(|v| atlas.on_panel(panel, &pose.point(v, 0.0).xy()));
        // What is on a crease but for rounding must not cross it.
        let crease = creases.iter().find(|(t, hair)| (p[0] - t).abs() <= *hair && (q[0] - t).abs() <= *hair);
        let slope = [0, 1].map(|d: usize| (q[d] - p[d]) / (b - a));
        let rest = |d: usize| 4.0 * (0.5 * (p[d] + q[d]) - m[d]) / ((b - a) * (b - a));
        let bend = if along == Straight::Not && beside_tip.is_none() { [0, 1].map(rest) } else { [0.0; 2] };
        // Through the places at both ends and in the middle.
        let slope = [0, 1].map(|d: usize| slope[d] - bend[d] * (a + b));
        let found = Along { at: [0, 1].map(|d: usize| p[d] - (slope[d] + bend[d] * a) * a), slope, bend };
        let on_crease = |t: f64| Along { at: [t, found.at[1]], slope: [0.0, slope[1]], bend: [0.0, found.bend[1]] };
        crease.map_or(found, |(t, _)| on_crease(*t))
    };
    parallel::map(0..=n, place)
}
