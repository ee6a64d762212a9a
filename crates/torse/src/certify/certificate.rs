//! What was proven, read only: certificates are made by the proofs of this floor and by nothing else \[certificate, 6\].
//!
//! A certificate dereferences to its parts, which can be read. Nobody outside this floor can put parts into a
//! certificate, change those of one, or join several to one that says more.

use super::claim::{Claim, LowerBound, Subject, UpperBound, What};
use super::fingerprint::Fingerprint;
use crate::reason::{ProofFault, Reason};
use std::ops::Deref;

/// What is stated about one panel. Lengths in mm.
#[derive(Clone, Debug)]
pub struct PanelParts {
    /// Whether everything below is proven and within the tolerance.
    pub certified: bool,
    /// Why not, and where; none when certified.
    pub reason: Option<Reason>,
    /// Witness: parameters on the face, and the distance there, when the tolerance is exceeded.
    pub witness: Option<([f64; 2], f64)>,
    /// Place on the face that is farther than boundary, edges and rounding leave of the tolerance, and what they leave there,
    /// mm.
    pub too_far: Option<([f64; 2], f64)>,
    /// Two-sided bound between the panel as exported and its part of the face; infinite if none was shown.
    pub deviation_bound: f64,
    /// Part of the bound: face to (untrimmed) torse along normals.
    pub distance_bound: f64,
    /// Part of the bound: exported trim curves against the images of the region's boundary, along the panel; it enters in
    /// quadrature.
    pub boundary_bound: f64,
    /// Part of the bound: exported patch against the exact torse.
    pub rounding_bound: f64,
    /// Part of the bound: edges in space, which STEP files call the master, against the exported trim curves.
    pub edge_bound: f64,
    /// Largest angle (rad) between the tangent planes of the exported patch along any ruling, within the trimming
    /// curves.
    pub developability_bound: f64,
    /// Lower bound of the distance along rulings between panel and regression curve; infinite for cylinders.
    pub regression_clearance: f64,
    /// Lower bound of the radius of curvature of the panel; infinite for planes.
    pub min_bend_radius: f64,
    /// Boxes or triangles accepted.
    pub cells: usize,
    /// Whether the panel is to be developable; of others neither twist nor bending nor regression is stated.
    pub developable: bool,
}

/// What was proven about one panel; reads like [`PanelParts`].
#[derive(Clone, Debug)]
pub struct PanelCertificate(pub(super) PanelParts);

/// What is stated about a seam. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamParts {
    /// Panels on both sides; twice the same where a panel meets itself.
    pub panels: [usize; 2],
    /// Proven bound of the distance between its two sides at equal parameters.
    pub gap_bound: f64,
    /// Proven bound of the difference between the lengths of its two sides; infinite if none was shown.
    pub length_difference_bound: f64,
    /// Whether the panels meet.
    pub status: SeamStatus,
    /// Length, measured.
    pub length_estimate: f64,
    /// Smallest and largest angle (rad) between the panels along the seam, sampled.
    pub kink_range_estimate: (f64, f64),
}

/// What was proven about a seam; reads like [`SeamParts`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamCertificate(pub(super) SeamParts);

/// Whether the panels of a seam meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeamStatus {
    /// Both panels have the same edge in space, and their sides are within a hundredth of the tolerance.
    Exact,
    /// The gap is within a quarter of the tolerance.
    Tolerance,
    /// The gap is larger.
    Open,
}

/// Share of the tolerance up to which the two sides of a common edge count as one.
const EXACT_SHARE: f64 = 0.01;
/// Share of the tolerance above which a seam counts as open.
const OPEN_SHARE: f64 = 0.25;

impl SeamStatus {
    pub(super) fn of(shared: bool, gap: f64, tolerance: f64) -> Self {
        if shared && gap <= EXACT_SHARE * tolerance {
            Self::Exact
        } else if gap <= OPEN_SHARE * tolerance {
            Self::Tolerance
        } else {
            Self::Open
        }
    }
}

/// What is stated about a whole patchwork. Lengths in mm.
#[derive(Clone, Debug)]
pub struct CertificateParts {
    /// The tolerance asked for.
    pub tolerance: f64,
    /// Whether every panel is certified, the faces are covered, and the bound is within the tolerance.
    pub certified: bool,
    /// Hausdorff bound between the trimmed faces and the union of the exported panels.
    pub deviation_bound: f64,
    /// Largest distance between the two sides of any seam at equal parameters.
    pub seam_gap_bound: f64,
    /// One record per seam, in order; empty if a gap could not be bounded.
    pub seams: Vec<SeamCertificate>,
    /// Whether the panels' regions add up to the faces exactly.
    pub covered: bool,
    /// One record per panel, in order.
    pub panels: Vec<PanelCertificate>,
    /// Parts of the proof that are missing; empty when certified.
    pub missing: Vec<Reason>,
}

/// What was proven about a whole patchwork; reads like `CertificateParts`.
#[derive(Clone, Debug)]
pub struct Certificate {
    pub(super) parts: CertificateParts,
    /// Of the patchworks that were judged, in order.
    pub(super) of: Vec<Fingerprint>,
    /// Of the joints between them.
    pub(super) joints: u64,
}

impl Deref for PanelCertificate {
    type Target = PanelParts;
    fn deref(&self) -> &PanelParts {
        &self.0
    }
}

impl Deref for SeamCertificate {
    type Target = SeamParts;
    fn deref(&self) -> &SeamParts {
        &self.0
    }
}

impl Deref for Certificate {
    type Target = CertificateParts;
    fn deref(&self) -> &CertificateParts {
        &self.parts
    }
}

impl Certificate {
    /// What is proven, as claims: distance, coverage and gaps of the whole, and what is known of each panel.
    pub fn claims(&self) -> Vec<Claim> {
        let whole = Subject::Whole;
        let mut out: Vec<Claim> = self.missing.iter().map(|m| Claim::objection(whole, m.clone())).collect();
        let deviation = UpperBound::shown(self.deviation_bound);
        // Where the panel that keeps least of the tolerance shows it.
        let worst =
            self.panels.iter().filter(|p| !p.certified).max_by(|a, b| a.deviation_bound.total_cmp(&b.deviation_bound));
        let seen = worst.and_then(|p| p.reason.as_ref()).and_then(Reason::place);
        out.push(Claim::at_most(What::Deviation, whole, deviation).within(self.tolerance).seen_at(seen));
        let covered = LowerBound::shown(if self.covered { 1.0 } else { 0.0 });
        out.push(Claim::at_least(What::Coverage, whole, covered).not_below(1.0));
        out.push(Claim::at_most(What::SeamGap, whole, UpperBound::shown(self.seam_gap_bound)));
        for (k, p) in self.panels.iter().enumerate() {
            let panel = Subject::Panel(k);
            let bound = UpperBound::shown(p.deviation_bound);
            let seen = p.reason.as_ref().and_then(Reason::place);
            out.push(Claim::at_most(What::Deviation, panel, bound).within(self.tolerance).seen_at(seen));
            let developable = [
                Claim::at_most(What::Twist, panel, UpperBound::shown(p.developability_bound).degrees()),
                Claim::at_least(What::RegressionClearance, panel, LowerBound::shown(p.regression_clearance)),
                Claim::at_least(What::BendRadius, panel, LowerBound::shown(p.min_bend_radius)),
            ];
            out.extend(developable.into_iter().filter(|_| p.developable));
            if !p.certified {
                out.push(Claim::objection(panel, p.reason.clone().unwrap_or(ProofFault::SomePanel.into())));
            }
        }
        if !self.certified && !out.iter().any(Claim::is_broken) {
            out.push(Claim::objection(whole, ProofFault::SomePanel));
        }
        out
    }
}

impl Certificate {
    /// The least inside radius of sheets whose inside lies at most `depth` (mm) nearer to the centre of any bend than the
    /// panels, proven.
    pub fn inside_radius(&self, depth: f64) -> Claim {
        let of = |p: &PanelCertificate| LowerBound::shown((p.min_bend_radius - depth).next_down());
        let least = LowerBound::smallest(self.panels.iter().map(of));
        Claim::at_least(What::InsideRadius, Subject::Whole, least)
    }
}

impl CertificateParts {
    /// Nothing is known yet.
    pub(super) fn nothing(tolerance: f64) -> Self {
        Self {
            tolerance,
            certified: false,
            deviation_bound: f64::INFINITY,
            seam_gap_bound: f64::INFINITY,
            seams: Vec::new(),
            covered: false,
            panels: Vec::new(),
            missing: Vec::new(),
        }
    }
}

impl PanelParts {
    /// Nothing is known yet.
    pub(super) fn blank() -> Self {
        Self {
            certified: false,
            reason: None,
            witness: None,
            too_far: None,
            deviation_bound: f64::INFINITY,
            distance_bound: f64::INFINITY,
            boundary_bound: f64::INFINITY,
            rounding_bound: f64::INFINITY,
            edge_bound: f64::INFINITY,
            developability_bound: f64::INFINITY,
            regression_clearance: 0.0,
            min_bend_radius: 0.0,
            cells: 0,
            developable: true,
        }
    }
}
