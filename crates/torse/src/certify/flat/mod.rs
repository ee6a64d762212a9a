//! The flat pattern of a panel as drawn, against the panel: a map that keeps lengths, the outline, rulings, marks.
//!
//! *Theorem* \[certificate, 6\]: there is a map of the panel to the plane (`rails`) that changes no length by more than
//! the factor `1 ± strain_bound`, seen from the outside of the face, such that the lines and arcs drawn for every run of
//! the panel's border are within `outline_bound` of its image, and it of them (`outline`); every ruling drawn lies
//! within `ruling_bound` of the image of one; and the marks of both sides of a seam are within `mark_bound` of the images
//! of points with equal parameters; marks on joints of faces are within it of the panel's own border, and that both sides
//! of a joint name the same place is measured. The outline drawn does not meet itself (`simple_outline`). The panel and the drawing are the data; how the drawing was made is not looked at.
//! Chains of untrimmed strips: [`strip_parts`]; of cones: [`cone_parts`].

mod chain;
mod cone_part;
pub(crate) mod fold;
mod matching;
mod outline;
mod rails;
mod senses;
pub(super) mod simple_outline;

use super::claim::{Claim, Subject, UpperBound, What};
use super::developable::trim_boxes;
use super::ruled::Ruled;
use crate::control::Control;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel, Patchwork};
use crate::patchwork::pattern::{Contour, ContourVertex, Mark, MarkPlace, Pattern};
use crate::reason::{FlatFault, Of, Reason};
pub use chain::strip_parts;
pub use cone_part::cone_parts;
use matching::backwards;
pub(super) use outline::Motion;
use outline::{chain_bound, pairs_by_length, Image};
use rails::FlatRails;
use simple_outline::outline_is_simple;

/// What was proven about the flat pattern of a panel or of a chain of strips. Lengths in mm.
#[derive(Clone, Debug)]
pub struct FlatCertificate {
    panel: usize,
    strain_bound: f64,
    outline_bound: f64,
    ruling_bound: f64,
    mark_bound: f64,
    gap_bound: f64,
    change_bound: f64,
    open: Option<FlatFault>,
    faults: Vec<FlatFault>,
}

impl FlatCertificate {
    /// What is proven of all parts of a job, as claims about the whole: lengths, drawings, joints inside parts.
    pub(crate) fn of_parts(all: &[Self]) -> Vec<Claim> {
        let largest = |value: fn(&Self) -> f64| UpperBound::largest(all.iter().map(|c| UpperBound::shown(value(c))));
        let whole = Subject::Whole;
        let claims = [
            Claim::at_most(What::LengthError, whole, largest(Self::strain_bound)),
            Claim::at_most(What::DrawingDistance, whole, largest(Self::drawing_bound)),
            Claim::at_most(What::JointGap, whole, largest(Self::gap_bound)),
        ];
        // What is not known of all parts is told part by part.
        claims.into_iter().filter(|c| !c.is_unknown()).collect()
    }

    /// What is proven, as claims about the panel.
    pub fn claims(&self) -> [Claim; 2] {
        let panel = Subject::Panel(self.panel);
        [
            Claim::at_most(What::LengthError, panel, UpperBound::shown(self.strain_bound)),
            Claim::at_most(What::DrawingDistance, panel, UpperBound::shown(self.drawing_bound())),
        ]
    }

    /// Index of the panel; of chains, of the part.
    pub fn panel(&self) -> usize {
        self.panel
    }

    /// No length on the flat part differs from that on the panel by more than this share of it.
    pub fn strain_bound(&self) -> f64 {
        self.strain_bound
    }

    /// Bound of the distance, both ways, between the outline drawn and the flat image of the panel's border.
    pub fn outline_bound(&self) -> f64 {
        self.outline_bound
    }

    /// Bound of the distance of rulings drawn from flat images of rulings.
    pub fn ruling_bound(&self) -> f64 {
        self.ruling_bound
    }

    /// Bound of the distance of marks from the flat images of the places that both sides of a seam agree on.
    pub fn mark_bound(&self) -> f64 {
        self.mark_bound
    }

    /// Bound of the distance in space between strips of a chain that meet in the plane, where they meet, and of the ends
    /// of rulings that are one point in the plane.
    pub fn gap_bound(&self) -> f64 {
        self.gap_bound
    }

    /// No path over the whole part that is as short as can be changes its length by more than this, gaps included.
    pub fn change_bound(&self) -> f64 {
        self.change_bound
    }

    /// The greatest of the bounds of outline, rulings and marks.
    pub fn drawing_bound(&self) -> f64 {
        self.outline_bound.max(self.ruling_bound).max(self.mark_bound)
    }

    /// Why something is not proven or exceeds the tolerance; nothing if all is well.
    pub fn reason(&self) -> Option<Reason> {
        Reason::all(self.faults.iter().copied().map(Reason::from).collect())
    }

    /// Of parts of strips, what could not be shown of their own map to the plane, whatever is drawn: lengths are only
    /// measured then; nothing if all is well.
    pub fn open(&self) -> Option<FlatFault> {
        self.open
    }

    /// Whether everything is proven and within the tolerance.
    pub fn holds(&self) -> bool {
        self.faults.is_empty() && self.open.is_none()
    }

    /// What is shown by `proof`, and whether drawing and gaps are within the tolerance (mm); how lengths change is told
    /// apart.
    fn judged(panel: usize, tolerance: f64, proof: impl FnOnce(&mut Self) -> Result<(), FlatFault>) -> Self {
        let mut out = Self::blank(panel);
        match proof(&mut out) {
            Err(FlatFault::NoMap) => {
                out.open = Some(FlatFault::NoMap);
                return out;
            }
            Err(fault) => {
                out.faults = vec![fault];
                return out;
            }
            Ok(()) => {}
        }
        let drawn = Interval::point(out.drawing_bound()) + Interval::point(out.gap_bound);
        let total = (drawn + Interval::point(out.change_bound)).hi;
        if drawn.hi > tolerance || drawn.hi.is_nan() {
            out.faults = vec![FlatFault::Drawing(drawn.hi)];
        } else if total > tolerance || total.is_nan() {
            out.open = Some(FlatFault::Lengths(out.change_bound));
        }
        out
    }

    fn blank(panel: usize) -> Self {
        Self {
            panel,
            strain_bound: f64::INFINITY,
            outline_bound: f64::INFINITY,
            ruling_bound: f64::INFINITY,
            mark_bound: f64::INFINITY,
            gap_bound: f64::INFINITY,
            change_bound: f64::INFINITY,
            open: None,
            faults: Vec::new(),
        }
    }
}

/// A panel with its flat map and where the drawing shows it.
struct Flat<'a> {
    pattern: &'a Pattern,
    rails: FlatRails,
    motion: Motion,
    /// For every mark: its run and the place on it.
    marks: Vec<Option<(&'a Coedge, f64)>>,
}

impl Flat<'_> {
    fn image<'b>(&'b self, run: &'b Coedge) -> Image<'b> {
        Image { flat: &self.rails, trim: &run.trim, motion: self.motion }
    }
}

/// Proves what is claimed about flat patterns: one certificate per pattern, in order. `tolerance` (mm): the drawing may
/// be off by that much, strain over the length of the pattern included.
///
/// *Guarantee*: the theorem at the head of this file. *Not* guaranteed: how material bends.
///
/// *Cost*: about 0.1 ms per piece of a span, 20 µs per line or arc.
pub fn flat(patchwork: &Patchwork, patterns: &[Pattern], tolerance: f64, control: &Control) -> Vec<FlatCertificate> {
    proven(patchwork, patterns, tolerance, false, control)
}

/// See [`flat`]; with `apart`, how lengths change is told apart from what is drawn.
fn proven(
    patchwork: &Patchwork,
    patterns: &[Pattern],
    tolerance: f64,
    apart: bool,
    control: &Control,
) -> Vec<FlatCertificate> {
    let found: Vec<(FlatCertificate, Option<Flat>)> =
        parallel::map(patterns.iter(), |p| one(patchwork, p, tolerance, control));
    let (mut out, flats): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    // Partners of marks are unknown where a proof was stopped.
    let unmatched = match out.iter().any(|c| c.faults.contains(&FlatFault::Stopped)) {
        true => FlatFault::Stopped,
        false => FlatFault::Mark,
    };
    for (k, certificate) in out.iter_mut().enumerate() {
        let mut missing = std::mem::take(&mut certificate.faults);
        if let Some(flat) = &flats[k] {
            match marks(flat, &flats) {
                Some(bound) => certificate.mark_bound = bound,
                None => missing.push(unmatched),
            }
            certificate.gap_bound = 0.0;
            certificate.change_bound = flat.rails.length_change(flat.pattern.length);
            let change = Interval::point(certificate.change_bound);
            let total = (Interval::point(certificate.drawing_bound()) + change).hi;
            let far = |x: f64| x > tolerance || x.is_nan();
            if missing.is_empty() && far(total) {
                if apart && !far(certificate.drawing_bound()) {
                    certificate.open = Some(FlatFault::Lengths(certificate.change_bound));
                } else {
                    missing.push(FlatFault::Drawing(total));
                }
            }
        }
        if apart && missing == [FlatFault::NoMap] {
            certificate.open = missing.pop();
        }
        certificate.faults = missing;
    }
    out
}

/// Proves what is claimed about flat patterns of panels that cover no faces but end at outlines: one certificate per
/// pattern, in order, with the number of its part, which is that of its panel.
pub(crate) fn outlined_parts(
    panels: Vec<Panel>,
    patterns: &[Pattern],
    tolerance: f64,
    control: &Control,
) -> Vec<FlatCertificate> {
    proven(&Patchwork { panels, ..Patchwork::default() }, patterns, tolerance, true, control)
}

fn one<'a>(
    patchwork: &'a Patchwork,
    pattern: &'a Pattern,
    tolerance: f64,
    control: &Control,
) -> (FlatCertificate, Option<Flat<'a>>) {
    let mut out = FlatCertificate::blank(pattern.panel);
    let refuse = |mut out: FlatCertificate, fault: FlatFault| {
        out.faults = vec![fault];
        (out, None)
    };
    if control.stopped() {
        return refuse(out, FlatFault::Stopped);
    }
    let Some(panel) = patchwork.panels.get(pattern.panel) else { return refuse(out, FlatFault::NoPanel) };
    let Some(ruled) = Ruled::new(&panel.strip.patch) else { return refuse(out, FlatFault::NotRuled) };
    let reversed = patchwork.face_of(panel).is_some_and(|f| f.reversed);
    let side = if panel.mirrored() == reversed { -1.0 } else { 1.0 };
    let boxes = trim_boxes(panel.loops().iter().flatten().map(|r| &r.trim));
    let used = |a: f64, b: f64| {
        let range = boxes.iter().filter(|[t, _]| t.lo <= b && t.hi >= a).map(|[_, r]| *r).reduce(Interval::hull)?;
        range.intersect(Interval { lo: 0.0, hi: 1.0 })
    };
    let Some(rails) = FlatRails::new(&ruled, &used, side) else {
        return refuse(out, FlatFault::NoMap);
    };
    out.strain_bound = rails.strain;
    let Some(chains) = chains(panel, pattern, reversed) else {
        return refuse(out, FlatFault::OtherSides);
    };
    let Some(motion) = motion(&rails, &chains) else {
        return refuse(out, FlatFault::Nowhere(Of::Panel));
    };
    let flat = Flat { pattern, rails, motion, marks: Vec::new() };
    let bounds: Vec<_> = chains.iter().map(|(run, chain)| chain_bound(&flat.image(run), chain, tolerance)).collect();
    match bounds.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))) {
        Some(bound) => out.outline_bound = bound,
        None => out.faults = vec![FlatFault::Outline(Of::Panel)],
    }
    if let Err(fault) = outline_is_simple(pattern, tolerance) {
        out.faults = vec![fault];
    }
    let drawn = DrawnRulings::new(&flat.rails, motion);
    let rulings = pattern.rulings.iter().map(|r| drawn.bound(&r.map(|p| [p.x, p.y])));
    match rulings.into_iter().try_fold(0.0f64, |m, b| b.map(|b| m.max(b))) {
        Some(bound) => out.ruling_bound = bound,
        None => out.faults = vec![FlatFault::Ruling(Of::Panel)],
    }
    let runs = || panel.loops().iter().flatten().filter(|r| !r.is_point());
    let (seams, borders): (Vec<&Coedge>, Vec<&Coedge>) = runs().partition(|r| r.border.has_neighbour());
    let on = |m: &Mark| match m.on {
        MarkPlace::Seam => &seams,
        MarkPlace::Joint => &borders,
    };
    let marks = pattern.marks.iter().map(|m| marked(on(m), &flat, &[m.point.x, m.point.y])).collect();
    (out, Some(Flat { marks, ..flat }))
}

/// Runs of the panel with the lines and arcs drawn for them, in the direction of the run.
fn chains<'a>(panel: &'a Panel, pattern: &Pattern, reversed: bool) -> Option<Vec<(&'a Coedge, Vec<ContourVertex>)>> {
    if panel.loops().len() != pattern.contours.len() {
        return None;
    }
    let mut out = Vec::new();
    for (runs, contour) in panel.loops().iter().zip(&pattern.contours) {
        let runs: Vec<&Coedge> = runs.iter().filter(|r| !r.is_point()).collect();
        let mut pieces = between_corners(contour);
        if pieces.len() != runs.len() || runs.is_empty() {
            return None;
        }
        if reversed {
            // Seen from the other side the outline runs backwards, from the same first corner.
            pieces.reverse();
            pieces.iter_mut().for_each(|p| *p = backwards(p));
        }
        out.extend(runs.into_iter().zip(pieces));
    }
    Some(out)
}

/// Parts of a closed contour from corner to corner, both included.
fn between_corners(contour: &Contour) -> Vec<Vec<ContourVertex>> {
    let v = &contour.vertices;
    let corners: Vec<usize> = (0..v.len()).filter(|&k| v[k].corner).collect();
    (0..corners.len())
        .map(|i| {
            let (a, b) = (corners[i], corners.get(i + 1).map_or(corners[0] + v.len(), |&b| b));
            (a..=b).map(|k| v[k % v.len()]).collect()
        })
        .collect()
}

/// Where the drawing shows the panel: by its corners, or by the whole outline where these are too few.
fn motion(rails: &FlatRails, chains: &[(&Coedge, Vec<ContourVertex>)]) -> Option<Motion> {
    const FEWEST_CORNERS: usize = 3;
    let still = Motion { turn: [1.0, 0.0], from: [0.0; 2], to: [0.0; 2] };
    let mut pairs = Vec::new();
    for (run, chain) in chains {
        let image = Image { flat: rails, trim: &run.trim, motion: still };
        if chains.len() < FEWEST_CORNERS {
            pairs.extend(pairs_by_length(&image, chain)?);
        } else {
            pairs.push((image.place(0.0)?, [chain[0].point.x, chain[0].point.y]));
        }
    }
    Motion::between(&pairs)
}

/// Rulings of the flat panel as the drawing shows them.
struct DrawnRulings<'a> {
    rails: &'a FlatRails,
    motion: Motion,
    /// Places to begin a search at, with numbers near the images of both ends of their rulings.
    known: Vec<(f64, Option<[[f64; 2]; 2]>)>,
}

impl<'a> DrawnRulings<'a> {
    fn new(rails: &'a FlatRails, motion: Motion) -> Self {
        let mut out = Self { rails, motion, known: Vec::new() };
        out.known = rails.places().into_iter().map(|t| (t, out.numbers(t))).collect();
        out
    }

    fn numbers(&self, t: f64) -> Option<[[f64; 2]; 2]> {
        Some(self.rails.ruling(t)?.map(|q| self.motion.point(&q).map(Interval::mid)))
    }

    /// About how far a segment is from the rulings at known places.
    fn about(&self, ends: &[[f64; 2]; 2]) -> f64 {
        let far = |line: &[[f64; 2]; 2]| {
            let v = [line[1][0] - line[0][0], line[1][1] - line[0][1]];
            let off = |p: &[f64; 2]| (v[0] * (p[1] - line[0][1]) - v[1] * (p[0] - line[0][0])).abs();
            off(&ends[0]).max(off(&ends[1])) / v[0].hypot(v[1])
        };
        let all = self.known.iter().filter_map(|k| k.1.as_ref()).map(far);
        all.filter(|d| !d.is_nan()).fold(f64::INFINITY, f64::min)
    }

    /// Bound of the distance of a segment from the image of the ruling that is nearest to both its ends.
    fn bound(&self, ends: &[[f64; 2]; 2]) -> Option<f64> {
        // How far the line of a ruling passes an end, left or right: that which lines pass farther, as all may meet in
        // the other one.
        let passed = |line: &Option<[[f64; 2]; 2]>, end: &[f64; 2]| -> Option<f64> {
            let [a, b] = (*line)?;
            let (v, w) = ([b[0] - a[0], b[1] - a[1]], [end[0] - a[0], end[1] - a[1]]);
            Some((v[0] * w[1] - v[1] * w[0]) / v[0].hypot(v[1]))
        };
        let most =
            |end: &[f64; 2]| self.known.iter().filter_map(|k| passed(&k.1, end)).map(f64::abs).fold(0.0, f64::max);
        let seen = if most(&ends[1]) > most(&ends[0]) { &ends[1] } else { &ends[0] };
        let off = |line: &Option<[[f64; 2]; 2]>| passed(line, seen);
        let far = |t: f64| -> Option<f64> {
            let line = self.rails.ruling(t)?.map(|q| self.motion.point(&q));
            Some(ends.iter().map(|p| from_line(&line, p).hi).fold(0.0, f64::max))
        };
        let values: Vec<(f64, f64)> = self.known.iter().map(|(t, line)| (*t, off(line).unwrap_or(f64::NAN))).collect();
        // Planes have the same ruling everywhere up to a move, and ends may lie a hair outside.
        let mut best = f64::INFINITY;
        for (t, _) in [values.first()?, values.last()?] {
            best = best.min(far(*t)?);
        }
        for w in values.windows(2).filter(|w| w[0].1 * w[1].1 <= 0.0) {
            best = best.min(far(root(w[0], w[1], &|t| off(&self.numbers(t)))?)?);
        }
        best.is_finite().then_some(best)
    }
}

/// Zero of a function between two places with values of opposite sign (regula falsi, Illinois form).
fn root(a: (f64, f64), b: (f64, f64), f: &dyn Fn(f64) -> Option<f64>) -> Option<f64> {
    const STEPS: usize = 24;
    let ((mut a, mut fa), (mut b, mut fb)) = (a, b);
    for _ in 0..STEPS {
        if fa.abs() <= f64::MIN_POSITIVE || (b - a).abs() <= f64::EPSILON * (a.abs() + b.abs()) {
            return Some(a);
        }
        let m = (a * fb - b * fa) / (fb - fa);
        if !m.is_finite() {
            return Some(a);
        }
        let fm = f(m)?;
        if fm * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (m, fm);
    }
    Some(b)
}

/// Distance of a point from the line through two points.
fn from_line(line: &[[Interval; 2]; 2], p: &[f64; 2]) -> Interval {
    let [a, b] = line;
    let v = [0, 1].map(|d: usize| b[d] - a[d]);
    let w = [0, 1].map(|d: usize| Interval::point(p[d]) - a[d]);
    ((v[0] * w[1] - v[1] * w[0]) / (v[0].sqr() + v[1].sqr()).sqrt()).abs()
}

/// The run and place that a mark stands at: the nearest among runs along seams.
fn marked<'a>(seams: &[&'a Coedge], flat: &Flat, at: &[f64; 2]) -> Option<(&'a Coedge, f64)> {
    const SAMPLES: usize = 4;
    let mut best: Option<(f64, &Coedge, f64)> = None;
    for &run in seams {
        let image = flat.image(run);
        let mut nearest = (f64::INFINITY, 0.0);
        for w in run.trim.knots.breaks().windows(2) {
            for k in 0..SAMPLES {
                let s = w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / SAMPLES as f64;
                let p = image.place(s)?;
                let far = (p[0] - at[0]).hypot(p[1] - at[1]);
                if far < nearest.0 {
                    nearest = (far, s);
                }
            }
        }
        let s = image.nearest(at, nearest.1, 0.0);
        let p = image.place(s)?;
        let far = (p[0] - at[0]).hypot(p[1] - at[1]);
        if best.is_none_or(|b| far < b.0) {
            best = Some((far, run, s));
        }
    }
    best.map(|(_, run, s)| (run, s))
}

/// Bound of the distance of all marks of a pattern from the images of the places of their partners, which carry the
/// same label on the other side of the seam.
fn marks(flat: &Flat, all: &[Option<Flat>]) -> Option<f64> {
    let mut bound = 0.0f64;
    for (mark, at) in flat.pattern.marks.iter().zip(&flat.marks) {
        let (run, s) = (*at)?;
        let far = |s: f64| -> Option<f64> {
            let p = flat.image(run).point(s)?;
            let w = [p[0] - Interval::point(mark.point.x), p[1] - Interval::point(mark.point.y)];
            Some((w[0].sqr() + w[1].sqr()).sqrt().hi)
        };
        if !run.border.has_neighbour() {
            // Faces do not know of each other: that both sides name the same place is measured.
            let same = |m: &Mark| m.label == mark.label && m.on == MarkPlace::Joint;
            let named = all.iter().flatten().flat_map(|f| &f.pattern.marks).filter(|m| same(m)).count();
            bound = bound.max(far(s)?);
            if named == 2 {
                continue;
            }
            return None;
        }
        let partner = all.iter().flatten().find_map(|other| {
            let k = other.pattern.marks.iter().zip(&other.marks).find(|(m, at)| {
                m.label == mark.label && at.is_some_and(|(r, _)| run.border.across(&r.border).is_some())
            })?;
            *k.1
        });
        let (other, opposite) = partner?;
        let turned = run.border.across(&other.border)?;
        bound = bound.max(far(s)?).max(far(if turned { 1.0 - opposite } else { opposite })?);
    }
    Some(bound)
}

#[cfg(test)]
mod tests;
