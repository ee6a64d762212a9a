//! Strips of convex hulls \[W15, 5.4\] before their judge: what is bounded is kept, the rest is named.

use super::assessment::{findings, summed, Assessment, Candidate, Found};
use crate::certify::claim::{Claim, Subject, UpperBound, What};
use crate::certify::rails::{tip_bound, twist_bound};
use crate::control::Control;
use crate::design::hull::strips::{HullPart, HullStrip, Tip};
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::unit::SQUARE_METRES;
use crate::patchwork::part::Part;
use crate::reason::{Curves, Item, Reason, StripReason};
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;

/// Strips left out that are named; more are counted.
const NAMED: usize = 12;

/// Strips with bounded errors, as they are written, and the names of the others.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// The strips.
    pub strips: Vec<Strip>,
    /// Colours, one set per strip.
    pub fields: Vec<PanelField>,
    /// What the colours mean.
    pub meaning: FieldMeaning,
    /// Parts as they would be cut if none overlapped itself.
    pub parts: Vec<Part>,
    /// Names of closed parts, which are cut open along their first ruling.
    pub closed: Vec<String>,
    /// Strips that are left out, with the reason.
    pub skipped: Vec<Reason>,
    /// What is said of the whole.
    pub claims: Vec<Claim>,
    /// What is said of strips one by one.
    pub of_strips: Vec<Claim>,
    /// What is missing from the whole.
    pub missing: Vec<Reason>,
    /// How far (mm) curves lie from the last rulings before tips that are cut off.
    pub tips: Vec<UpperBound>,
}

/// Judges parts; `tolerance` is in mm, `twist` (rad) is what counts as developable. A strip of which nothing is proven
/// would be cut from sheet in vain: it is named and not written, and the strips on both sides of it are parts of their
/// own. Towards tips such strips are cut off if the curve is proven to lie within the tolerance of the ruling where the
/// others end; that distance counts as any other.
pub fn kept(curves: &[Rail], mut made: Vec<HullPart>, (tolerance, twist): (f64, f64), control: &Control) -> Kept {
    named(&mut made);
    let reversed: Vec<Rail> = curves.iter().map(Rail::reversed).collect();
    let candidate = |s: &'_ HullStrip| -> [Option<&Rail>; 2] {
        [0, 1].map(|d: usize| Some(if s.turned[d] { &reversed[s.rails[d]] } else { &curves[s.rails[d]] }))
    };
    let all: Vec<Candidate> = made
        .iter()
        .flat_map(|p| &p.strips)
        .map(|s| Candidate { index: 0, built: &s.built, rails: candidate(s) })
        .collect();
    let found = findings(&all, twist, control);
    let mut out = Kept::default();
    let mut written: Vec<(Candidate, &Found)> = Vec::new();
    let judged: Vec<(&Candidate, &Found)> = all.iter().zip(&found).collect();
    let mut judged = &judged[..];
    let mut facets = Vec::new();
    for (k, part) in made.iter().enumerate() {
        let name = part_name(k);
        let mut runs: Vec<(usize, usize)> = Vec::new();
        let mut joined = false;
        let (own, others) = judged.split_at(part.strips.len());
        judged = others;
        let ends = [0, 1].map(|end: usize| tip_cut(part, own, end, curves, (tolerance, twist)));
        out.tips.extend(ends.iter().flatten().map(|e| e.1));
        let [before, behind] = ends.map(|e| e.map_or(0, |e| e.0));
        for &(c, f) in &own[before..own.len() - behind] {
            if !f.is_bounded() {
                let name = Item::Strip(c.built.strip.name.clone());
                out.skipped.push(Reason::of(name, StripReason::Unbounded));
                joined = false;
                continue;
            }
            let index = out.strips.len();
            written.push((Candidate { index, ..*c }, f));
            out.strips.push(c.built.strip.clone());
            out.fields.push(PanelField::default());
            match runs.last_mut().filter(|_| joined) {
                Some(run) => run.1 += 1,
                None => runs.push((index, 1)),
            }
            joined = true;
        }
        if part.closed && runs.len() == 1 && runs[0].1 == part.strips.len() {
            out.closed.push(name.clone());
        }
        if let Some(facet) = &part.facet {
            facets.push((out.strips.len(), facet));
            runs.push((out.strips.len(), 1));
            out.fields.push(PanelField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![0.0; 4] });
            out.strips.push(facet.clone());
        }
        for (i, &(first, count)) in runs.iter().enumerate() {
            let name = if runs.len() > 1 { format!("{name}.{}", i + 1) } else { name.clone() };
            out.parts.push(Part::new(name, first, count));
        }
    }
    out.count_skipped();
    let assessment = summed(&written, [What::FromSide(0), What::FromSide(1)], twist);
    out.missing.extend(assessment.missing.iter().cloned());
    for ((c, _), field) in written.iter().zip(&assessment.fields) {
        out.fields[c.index] = field.clone();
    }
    out.claims.extend((assessment.counts[0] > 0).then(|| from_curves(&out.tips, &assessment, tolerance)));
    out.claims.extend(assessment.whole());
    out.of_strips = assessment.claims;
    for (index, facet) in facets {
        out.of_strips.extend(facet_claims(index, facet, twist));
    }
    out.meaning = assessment.meaning;
    if out.strips.is_empty() {
        out.missing.push(StripReason::NoHull.into());
    }
    out
}

/// How far the strips are from the curves, tips that are cut off included.
fn from_curves(tips: &[UpperBound], assessment: &Assessment, tolerance: f64) -> Claim {
    let off = UpperBound::largest(tips.iter().copied().chain(assessment.off));
    // Of tips that are cut off no strip is the witness.
    let most = (0..2).find(|&side| assessment.off[side] == off).and_then(|side| assessment.farthest[side].clone());
    Claim::at_most(What::FromCurves, Subject::Whole, off).within(tolerance).because(Reason::from(StripReason::Stray {
        by: off.value(),
        from: Curves::All,
        most,
    }))
}

/// How many strips are cut off before the tip at an end of a part, and how far the curve then lies from the last ruling;
/// `None` where there is no tip, or no strip is left that is written.
fn tip_cut(
    part: &HullPart,
    own: &[(&Candidate, &Found)],
    end: usize,
    curves: &[Rail],
    (tolerance, twist): (f64, f64),
) -> Option<(usize, UpperBound)> {
    let tip = part.tips[end]?;
    let from_tip = |k: usize| if end == 0 { Some(k) } else { own.len().checked_sub(k + 1) };
    let off = |cut: usize, arc: [f64; 2]| {
        let k = from_tip(cut)?;
        let (c, f) = own.get(k)?;
        f.is_bounded().then(|| tip_bound(&c.built.strip, end == 1, &curves[tip.rail], arc))
    };
    let good = |k: &usize| from_tip(*k).is_some_and(|k| own[k].1.is_within(tolerance, twist));
    if let Some(cut) = (0..own.len()).find(good).filter(|cut| *cut > 0) {
        let strip = &part.strips[from_tip(cut)?];
        let arc = wider(&curves[tip.rail], &tip, ends_of(strip, end == 1, curves));
        if let Some(bound) = off(cut, arc).filter(|b| b.value() <= tolerance) {
            return Some((cut, bound));
        }
    }
    Some((0, off(0, tip.arc)?))
}

/// Parameters on the curves of the first or the last ruling of a strip.
fn ends_of(strip: &HullStrip, last: bool, curves: &[Rail]) -> [f64; 2] {
    [0, 1].map(|d: usize| {
        let part = &strip.built.rails[d];
        let control = &part.parameter.control;
        let at = part.piece as f64 + control[if last { control.len() - 1 } else { 0 }][0];
        if strip.turned[d] {
            curves[strip.rails[d]].pieces.len() as f64 - at
        } else {
            at
        }
    })
}

/// The arc between two places on both sides of a tip.
fn wider(rail: &Rail, tip: &Tip, [x, y]: [f64; 2]) -> [f64; 2] {
    let [lo, hi] = tip.arc;
    if !rail.closed {
        return [x.min(y).min(lo), x.max(y).max(hi)];
    }
    let n = rail.pieces.len() as f64;
    // Forwards from the one place to the arc, and from the arc to the other.
    let ways = |x: f64, y: f64| [(lo - x).rem_euclid(n), (y - hi).rem_euclid(n)];
    let (one, other) = (ways(x, y), ways(y, x));
    let [before, behind] = if one[0] + one[1] <= other[0] + other[1] { one } else { other };
    [lo - before, hi + behind]
}

/// Names strips by part and number.
fn named(made: &mut [HullPart]) {
    for (k, part) in made.iter_mut().enumerate() {
        for (i, s) in part.strips.iter_mut().enumerate() {
            s.built.strip.name = format!("{}-{:02}", part_name(k), i + 1);
        }
        if let Some(facet) = &mut part.facet {
            facet.name = format!("{}-01", part_name(k));
        }
    }
}

impl Kept {
    /// Names the first strips that are left out, and counts the others.
    fn count_skipped(&mut self) {
        let skipped = self.skipped.len();
        if skipped > NAMED {
            self.skipped.truncate(NAMED);
            self.skipped.push(StripReason::MoreUnbounded(skipped - NAMED).into());
        }
        if skipped > 0 {
            // Those that are written are proven all the same.
            self.claims.push(Claim::left_out(StripReason::NotWritten(skipped)));
        }
    }
}

/// What is said of a triangle whose corners lie on curves: plane by construction.
fn facet_claims(index: usize, facet: &Strip, limit: f64) -> Vec<Claim> {
    let subject = Subject::Panel(index);
    vec![
        Claim::given(What::FromSide(0), subject, 0.0),
        Claim::given(What::FromSide(1), subject, 0.0),
        Claim::at_most(What::Twist, subject, twist_bound(facet, limit, &Control::default()).angle().degrees())
            .within(limit.to_degrees()),
        Claim::measured(What::Twist, subject, 0.0),
        Claim::measured(What::RegressionClearance, subject, f64::INFINITY),
        Claim::measured(What::Area, subject, facet.area_estimate() * SQUARE_METRES),
    ]
}

/// A, B, …, Z, then numbers.
fn part_name(k: usize) -> String {
    match u8::try_from(k) {
        Ok(k) if k < 26 => char::from(b'A' + k).to_string(),
        _ => format!("P{}", k + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::certify::claim::Status;
    use crate::design::hull::hull;
    use crate::design::hull::strips::strips;
    use crate::design::loft::build::BuildOptions;
    use crate::geom::{Frame, Vec3};
    use std::f64::consts::TAU;

    /// A strip whose second rail runs backwards has no tangent planes: its neighbours are kept, it is not.
    #[test]
    fn strips_without_a_proof_are_left_out_and_named() {
        let circle = |r: f64, z: f64| {
            let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
            let arc =
                |k: f64| SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(k * TAU / 4.0, (k + 1.0) * TAU / 4.0);
            Rail::new("circle", &[0.0, 1.0, 2.0, 3.0].map(|k| arc(k).expect("an arc").0)).expect("a rail")
        };
        let curves = [circle(300.0, 0.0), circle(200.0, 400.0)];
        let control = Control::default();
        let found = hull(&curves, 96, &control).expect("a hull");
        let mut made = strips(&curves, &found, 0.01, &BuildOptions::new(0.01), &control).expect("strips");
        let before = kept(&curves, made.clone(), (0.1, 1e-5), &control);
        assert_eq!((made.len(), before.skipped.len(), before.parts.len(), before.strips.len()), (1, 0, 1, 4));
        let strip = &mut made[0].strips[1].built.strip;
        let turned = strip.rail(1).reversed();
        *strip = Strip::between(&strip.name, strip.kind, &strip.rail(0), &turned).expect("a strip");
        let after = kept(&curves, made, (0.1, 1e-5), &control);
        let name = Item::Strip("A-02".into());
        assert_eq!(after.skipped, [Reason::of(name, StripReason::Unbounded)]);
        assert_eq!((after.strips.len(), after.parts.len()), (3, 2));
        assert_eq!(Status::of(after.claims.iter().chain(&after.of_strips)), Status::Uncertified);
        assert!(after.claims.iter().any(|c| *c == Claim::left_out(StripReason::NotWritten(1))));
    }
}
