//! Strips of convex hulls \[W15, 5.4\] before their judge: what is bounded is kept, the rest is named.

use super::judgement::{findings, summed, Candidate, Found, SQUARE_METRES};
use crate::certify::claim::{Claim, Subject, What};
use crate::certify::rails::twist_bound;
use crate::control::Control;
use crate::design::hull::strips::{HullPart, HullStrip};
use crate::draw::field::{FieldMeaning, PanelField};
use crate::patchwork::part::Part;
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
    pub skipped: Vec<String>,
    /// What is said of the whole.
    pub claims: Vec<Claim>,
    /// What is said of strips one by one.
    pub of_strips: Vec<Claim>,
    /// What is missing from the whole.
    pub missing: Vec<String>,
}

/// Judges parts; `tolerance` is in mm, `twist` (rad) is what counts as developable. A strip of which nothing is proven would be cut from sheet in vain: it is named and not written, and
/// the strips on both sides of it are parts of their own.
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
    let mut judged = all.iter().zip(&found);
    let mut facets = Vec::new();
    for (k, part) in made.iter().enumerate() {
        let name = part_name(k);
        let mut runs: Vec<(usize, usize)> = Vec::new();
        let mut joined = false;
        for (c, f) in judged.by_ref().take(part.strips.len()) {
            if !f.is_bounded() {
                let name = &c.built.strip.name;
                out.skipped.push(format!(
                    "strip {name}: nothing bounds its distance from the curves or its twist; not written"
                ));
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
    let judgement = summed(&written, [What::FromSide(0), What::FromSide(1)], twist);
    out.missing.extend(judgement.missing.iter().cloned());
    for ((c, _), field) in written.iter().zip(&judgement.fields) {
        out.fields[c.index] = field.clone();
    }
    if judgement.counts[0] > 0 {
        let off = judgement.off[0].max(judgement.off[1]);
        out.claims.push(
            Claim::at_most(What::FromCurves, Subject::Whole, off)
                .within(tolerance)
                .because(format!("the strips stray up to {:.4} mm from the curves", off.value())),
        );
    }
    out.claims.extend(judgement.whole());
    out.of_strips = judgement.claims;
    for (index, facet) in facets {
        out.of_strips.extend(facet_claims(index, facet, twist));
    }
    out.meaning = judgement.meaning;
    if out.strips.is_empty() {
        out.missing.push("the hull has no developable strips between smooth curves".into());
    }
    out
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
            self.skipped.push(format!("{} more strips: nothing bounds them either", skipped - NAMED));
        }
        if skipped > 0 {
            self.missing.push(match skipped {
                1 => "1 strip has no proof and is not written".to_owned(),
                n => format!("{n} strips have no proof and are not written"),
            });
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
