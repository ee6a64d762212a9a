//! Chains of cones in an answer: panels, parts, and patterns of true arcs.

use crate::answer::Answer;
use crate::certify::claim::{Claim, Subject, What};
use crate::develop::cone_bends::draw_bends;
use crate::develop::cone_part::{overlaps as part_overlaps, part_pattern};
use crate::develop::cones::{cone_pattern, overlaps};
use crate::develop::view::{cones_viewed, Drawn};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::reason::{Item, Reason, StripReason};
use crate::search::strips::cone_body::Proven;
use crate::torse::cone::forms::whole_patch;
use crate::torse::cone::part::ConeBody;
use crate::torse::cone::spline::{ConeSpline, Segment};
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Contours stay within this share of the tolerance.
const CONTOUR_SHARE: f64 = 0.1;
/// Parts that fall together in the plane are apart in space by more than this share of the size.
const APART: f64 = 1e-3;

/// Cones, cylinders and planes in bodies: pieces of one count once.
pub fn counts(bodies: &[ConeBody]) -> [usize; 3] {
    let mut out = [0; 3];
    for b in bodies {
        let n = match &b.part {
            Some(p) => {
                ConeSpline { segments: p.faces.iter().map(|f| f.blank.segment).collect() }.counts(size(&b.spline))
            }
            None => b.spline.counts(size(&b.spline)),
        };
        out.iter_mut().zip(n).for_each(|(o, n)| *o += n);
    }
    out
}

/// Length of the rulings of a chain, mm.
fn size(spline: &ConeSpline) -> f64 {
    spline.segments.first().map_or(1.0, |s| (s.edges[1][0] - s.edges[0][0]).abs())
}

/// Strips, figures, parts and patterns of one chain; the pieces that the strips show.
pub(super) fn strips_of(answer: &mut Answer, body: &ConeBody, proven: &Proven, drawn: &Drawn) -> Vec<usize> {
    let first = answer.patchwork.panels.len();
    let mut shown = Vec::new();
    let pieces: Vec<Segment> = match &body.part {
        Some(part) => part.faces.iter().map(|f| f.blank.segment).collect(),
        None => body.spline.segments.clone(),
    };
    for (k, s) in pieces.iter().enumerate() {
        let kind = match s.shape.name() {
            "cone" => PanelKind::Cone,
            "cylinder" => PanelKind::Cylinder,
            _ => PanelKind::Plane,
        };
        let name = format!("{}-{:02}", body.name, k + 1);
        let Ok(patch) = whole_patch(s) else {
            answer.skipped.push(Reason::of(Item::Named(name), StripReason::Vertex).into());
            continue;
        };
        shown.push(k);
        answer.patchwork.panels.push(Strip { name, kind, patch }.into());
        let subject = Subject::Panel(answer.patchwork.panels.len() - 1);
        answer.claims.extend([
            Claim::measured(What::Turn, subject, s.shape.angle().abs().to_degrees()),
            Claim::at_most(What::Deviation, subject, proven.bound),
        ]);
    }
    // One part for the chain, halved while it overlaps itself in the plane.
    let spline = &body.spline;
    let size = size(spline);
    let mut waiting = vec![(body.name.clone(), 0, spline.segments.len())];
    while let Some((name, from, count)) = waiting.pop() {
        let chain = ConeSpline { segments: spline.segments[from..from + count].to_vec() };
        let part = body.part.as_ref().map(|p| p.between(from, from + count));
        let overlapping = match &part {
            Some(part) => part_overlaps(spline, part, APART * size),
            None => overlaps(&chain, APART * size),
        };
        if count > 1 && overlapping {
            let half = count / 2;
            waiting.push((format!("{name}b"), from + half, count - half));
            waiting.push((format!("{name}a"), from, half));
            continue;
        }
        let (contour, bends) = (CONTOUR_SHARE * answer.tolerance, drawn.bends.of_job(answer.tolerance));
        let (mut pattern, strips): (Pattern, (usize, usize)) = match &part {
            Some(part) => {
                let before = body.part.iter().flat_map(|p| &p.faces).take_while(|f| f.segment < from).count();
                (part_pattern(spline, part, &name, contour), (before, part.faces.len()))
            }
            None => (cone_pattern(&chain, &name, contour), (from, count)),
        };
        if pattern.contours.is_empty() {
            continue;
        }
        pattern.panel = answer.parts.len();
        let own = if part.is_some() { spline } else { &chain };
        draw_bends(&mut pattern, own, part.as_ref(), &bends);
        answer.patterns.push(cones_viewed(pattern, own, drawn.view));
        answer.parts.push(Part::new(name, first + strips.0, strips.1));
    }
    shown
}
