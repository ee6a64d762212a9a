//! Where strips of rulings and faces end, what is proven of that, and what is said of it.

use crate::answer::note::{FitNote, Note};
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Subject, UpperBound, What};
use crate::certify::nearness::panels_from_faces;
use crate::certify::points::points;
use crate::certify::trimmed::{trimmed, Measured, TrimmedCertificate};
use crate::control::Control;
use crate::fit::elements::gaps::{self, gaps, steps};
use crate::fit::elements::ruling_order::WIDE;
use crate::fit::elements::ruling_order::{aligned, opening};
use crate::geom::Vec3;
use crate::patchwork::panel::Panel;
use crate::reason::{Item, Reason, StripReason};
use crate::search::strips::cut::Laid;
use crate::search::strips::given_outline::GivenBorder;
use crate::search::strips::ruled_face::GivenFace;
use crate::search::strips::scan_outline::{outlined, Ended, Followed, GIVEN_CHORD};
use crate::search::strips::sequences::SequenceStrips;
use crate::torse::strip::Strip;
use std::ops::Range;

/// Where what is given ends.
#[derive(Default)]
pub(super) struct Ends {
    /// What each strip should end at; none of tangent planes without rulings.
    borders: Vec<Option<GivenBorder>>,
    /// Given faces with the strips in their place.
    faces: Vec<(Face, Range<usize>)>,
    /// Given rulings, sequence by sequence, as they were put in order.
    sequences: Vec<Vec<[Vec3; 2]>>,
    /// The same as they are given.
    given: Vec<[Vec3; 2]>,
}

impl Ends {
    /// Where rulings end that are given like this; nothing of faces and planes.
    pub fn of(given: &[[Vec3; 2]]) -> Self {
        Self { given: given.to_vec(), ..Self::default() }
    }

    /// Adds the strips of a sequence.
    pub fn add(&mut self, found: &SequenceStrips, face: Option<&GivenFace>, tolerance: f64) {
        let first = self.borders.len();
        let border = |range: &Range<usize>| match face {
            Some(face) => face.border(range, GIVEN_CHORD * tolerance).map(GivenBorder::Face),
            None => found.elements.get(range.clone()).and_then(GivenBorder::of),
        };
        self.borders.extend(found.ranges.iter().map(border));
        match face {
            Some(face) => self.faces.push((face.face.clone(), first..self.borders.len())),
            None => self.sequences.push(found.elements.iter().filter(|e| e.has_ruling()).map(|e| e.ends).collect()),
        }
    }

    /// Strips and their flat patterns cut back to where what is given ends.
    pub fn cut(&self, strips: &[Strip], laid: &mut Laid, side: f64, tolerance: f64, control: &Control) -> Ended {
        match control.stopped() || self.is_open() {
            true => Ended { whole: Vec::new(), ..Ended::whole(strips.to_vec()) },
            false => outlined(strips.to_vec(), laid, Followed::Given(&self.borders), side, tolerance, control),
        }
    }

    /// Whether nothing says where strips should end.
    fn is_open(&self) -> bool {
        self.faces.is_empty() && self.borders.iter().all(Option::is_none)
    }

    /// Whether faces are given.
    pub fn of_faces(&self) -> bool {
        !self.faces.is_empty()
    }

    /// What the judge says of where panels end.
    pub fn claims(&self, ended: &Ended, tolerance: f64, control: &Control) -> Vec<Claim> {
        if self.is_open() || ended.panels.is_empty() {
            return Vec::new();
        }
        let (mut given, mut between): (Vec<Vec3>, Vec<[u32; 4]>) = (Vec::new(), Vec::new());
        for (ends, pairs) in self.borders.iter().flatten().map(GivenBorder::points_and_cells) {
            let first = given.len() as u32;
            given.extend(ends);
            between.extend(pairs.into_iter().map(|t| t.map(|k| k + first)));
        }
        let strips: Vec<Strip> = ended.panels.iter().map(|p| p.strip.clone()).collect();
        let places = points(&strips, &given, control);
        let measured = Measured { points: &given, triangles: &[], between: &between, places: &places };
        let proofs = trimmed(&ended.panels, &measured, tolerance, control);
        let mut out = Vec::new();
        let rulings = self.faces.is_empty();
        let whole = Subject::Whole;
        let most = |bound: fn(&TrimmedCertificate) -> UpperBound| UpperBound::largest(proofs.iter().map(bound));
        if rulings {
            out.push(Claim::at_most(What::EndDistance, whole, most(TrimmedCertificate::beyond_bound)));
            out.push(Claim::at_most(What::BeyondRulings, whole, most(TrimmedCertificate::reach_bound)));
            let widest = self.sequences.iter().flat_map(|r| steps(r)).reduce(f64::max);
            out.extend(widest.map(|w| Claim::measured(What::RulingGap, whole, w)));
        }
        out.push(Claim::at_most(What::EdgeDistance, whole, most(TrimmedCertificate::edge_bound)).within(tolerance));
        for (k, proof) in proofs.iter().enumerate() {
            let told = |reason: StripReason| Reason::of(Item::Named(ended.panels[k].strip.name.clone()), reason);
            if let Some((fault, at)) = proof.fault() {
                out.push(Claim::objection(Subject::Panel(k), told(StripReason::Outline(fault, at))));
            }
            if rulings {
                let worst = proof.worst().and_then(|i| given.get(i).copied());
                out.extend(
                    of_panel(k, ended.keeps.get(k).copied().flatten(), proof, worst, tolerance)
                        .map(|(c, r)| c.because(told(r))),
                );
            }
        }
        out.extend(self.face_distances(&ended.panels, tolerance, control));
        out
    }

    /// Two-sided distances between faces and what took their place.
    fn face_distances(&self, panels: &[Panel], tolerance: f64, control: &Control) -> Vec<Claim> {
        let mut out = Vec::new();
        let mut bounds = Vec::new();
        for (face, own) in &self.faces {
            let own: Vec<(usize, &Panel)> = panels.iter().enumerate().take(own.end).skip(own.start).collect();
            let Some((first, panel)) = own.first() else { continue };
            let near: Vec<&Panel> = own.iter().map(|p| p.1).collect();
            let found = panels_from_faces(&near, std::slice::from_ref(face), tolerance, control);
            let bound = found.map_or(UpperBound::UNKNOWN, |f| f.there.max(f.back));
            bounds.push(bound);
            let seen = found.map(|f| (f.seen, f.place));
            let reason =
                Reason::of(Item::Named(panel.strip.name.clone()), StripReason::FromFace { within: tolerance, seen });
            // What is promised is proven at the rulings; a strip that was seen farther away, or of which nothing is known, is refused.
            let refused = !bound.value().is_finite() || found.is_none_or(|f| f.seen > tolerance);
            let claim = |k: usize| {
                let claim = Claim::at_most(What::FaceDistance, Subject::Panel(k), bound);
                if refused {
                    claim.within(tolerance)
                } else {
                    claim
                }
            };
            out.push(claim(*first).because(reason));
            out.extend(own.iter().skip(1).map(|p| claim(p.0)));
        }
        if !self.faces.is_empty() {
            out.insert(0, Claim::at_most(What::FaceDistance, Subject::Whole, UpperBound::largest(bounds)));
        }
        out
    }

    /// What is said of where strips end and, where `rulings` are given, of wide stretches between them.
    pub fn notes(&self, ended: &Ended, rulings: bool, control: &Control) -> Vec<Note> {
        let mut out = Vec::new();
        if !self.is_open() && !ended.panels.is_empty() {
            out.push(FitNote::Given { faces: !self.faces.is_empty(), whole: ended.whole.clone() });
        }
        if rulings {
            out.extend(self.gaps(ended, control));
            out.extend(self.bare(ended, control));
            out.extend(
                self.sequences.iter().filter_map(|r| opening(r)).map(|(apart, at)| FitNote::OpenRing { apart, at }),
            );
        }
        out.into_iter().map(Note::Fit).collect()
    }

    /// Stretches between rulings that come one after the other, here or as they are given, which no strip covers as it is cut.
    /// Knows nothing of what strips were fitted to.
    fn bare(&self, ended: &Ended, control: &Control) -> Option<FitNote> {
        let all: Vec<[Vec3; 2]> = self.sequences.iter().flatten().copied().collect();
        let usual = gaps::usual(&all).or_else(|| gaps::usual(&self.given))?;
        let sequences = self.sequences.iter().map(Vec::as_slice).chain([&self.given[..]]);
        let of_sequence = |sequence: &[[Vec3; 2]]| {
            let pairs = sequence.windows(2).map(|w| aligned(w[0], w[1])).zip(steps(sequence));
            pairs.filter(|(_, s)| *s > 0.0 && *s <= WIDE * usual).collect::<Vec<_>>()
        };
        let stretches: Vec<([[Vec3; 2]; 2], f64)> = sequences.flat_map(of_sequence).collect();
        let middles: Vec<Vec3> = stretches.iter().map(|(p, _)| p.iter().flatten().sum::<Vec3>() * 0.25).collect();
        let mut off = vec![f64::INFINITY; middles.len()];
        for panel in &ended.panels {
            let places = points(std::slice::from_ref(&panel.strip), &middles, control);
            let measured = Measured { points: &middles, triangles: &[], between: &[], places: &places };
            // Nothing is asked of the way back here.
            let proofs = trimmed(std::slice::from_ref(panel), &measured, f64::MAX, control);
            for (i, bound) in proofs.iter().flat_map(TrimmedCertificate::bounds) {
                off[*i] = off[*i].min(*bound);
            }
        }
        let mut found: Vec<(Vec3, f64)> = Vec::new();
        for ((middle, off), (_, apart)) in middles.iter().zip(&off).zip(&stretches) {
            let told = found.iter().any(|(m, _)| (m - middle).norm() < APART * apart);
            if *off > APART * apart && !told {
                found.push((*middle, *off));
            }
        }
        let (at, off) = found.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(FitNote::NoStrip { count: found.len(), at: *at, off: *off })
    }

    /// The widest stretch between neighbouring rulings, if it is much wider than others.
    fn gaps(&self, ended: &Ended, control: &Control) -> Option<FitNote> {
        let all: Vec<[Vec3; 2]> = self.sequences.iter().flatten().copied().collect();
        let found = gaps(&all);
        let gap = found.first()?;
        let pair = [all.get(gap.after)?, all.get(gap.after + 1)?];
        // The first ruling of a sequence has none before it.
        let mut last = 0;
        let parted = self.sequences.iter().any(|r| {
            last += r.len();
            last == gap.after + 1
        });
        let middle = pair.iter().flat_map(|r| r.iter()).sum::<Vec3>() * 0.25;
        let strips: Vec<Strip> = ended.panels.iter().map(|p| p.strip.clone()).collect();
        let bulge_estimate = (!parted).then(|| points(&strips, &[middle], control).worst_bound().value());
        let at = pair.map(|r| (r[0] + r[1]) * 0.5);
        Some(FitNote::Gap { apart: gap.apart, usual: gap.usual, at, count: found.len(), bulge_estimate })
    }
}

/// What is claimed of where a strip of rulings ends, each with what is the matter if it does not hold. `keeps` is what it should
/// keep to, see [`Ended::keeps`].
fn of_panel(
    k: usize,
    keeps: Option<[f64; 2]>,
    proof: &TrimmedCertificate,
    worst: Option<Vec3>,
    tolerance: f64,
) -> impl Iterator<Item = (Claim, StripReason)> {
    let keeps = keeps.unwrap_or([tolerance; 2]);
    let [ends, reach] = keeps.map(|x| (1.0 + SLACK) * x);
    let subject = Subject::Panel(k);
    let beyond = Claim::at_most(What::EndDistance, subject, proof.beyond_bound()).within(ends);
    let far = StripReason::EndOutside { within: ends, worst };
    let reached = Claim::at_most(What::BeyondRulings, subject, proof.reach_bound()).within(reach);
    let farther = StripReason::OutlineOutside { within: reach, at: proof.farthest() };
    [(beyond, far), (reached, farther)].into_iter()
}

/// Share of the distance of two rulings from which on the middle between them has no strip: a sheet that bends by a right angle
/// between them bulges by less.
const APART: f64 = 0.25;
/// What bounds may exceed what outlines are made to keep to by, as a share: they are up to a tenth above distances, and chords of
/// the outline take a little.
const SLACK: f64 = 0.15;
