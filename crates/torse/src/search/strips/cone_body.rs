//! Chains of cones \[LP98\] along surfaces: fitted, judged, and fitted more finely until both directions of the proof hold;
//! then cut along the outline, which is judged in its turn.

use super::cone_outline::PlaneOutline;
use crate::certify::claim::UpperBound;
use crate::certify::cones::outline::{astray_bound, outline as certified, Region};
use crate::certify::cones::{cones as certified_cones, ConeJudgeOptions, ConeProof};
use crate::fit::elements::cones::{cones as fit, ConeFit, ConeFitOptions};
use crate::fit::panels::cone_trim::{cone_part, ConeTrimOptions};
use crate::reason::{Reason, StripReason};
use crate::torse::cone::part::ConeBody;
use crate::torse::cone::spline::{ConeSpline, ONCE_AROUND};
use crate::torse::ruled_patch::{RuledPatch, RuledStrip};

/// The tolerance of the fit against that of the job: the proof of the way back adds to the distance fitted.
const SHARES: [f64; 5] = [0.76, 0.6, 0.45, 0.3, 0.15];
/// Distance allowed to edges, as a share of that of the surface: both add up in the proof.
const EDGES: f64 = 0.25;
/// Distance (mm) asked for between trimmed edges and the exact surfaces: CAD systems take less for none. What is reached
/// is proven.
pub(crate) const EDGE_ROUNDING: f64 = 5e-7;
/// Distance allowed between the outline and trimmed edges, as a share of the tolerance.
const OUTLINE_SHARE: f64 = 0.02;
/// Largest turn of a segment in files, rad.
const LARGEST_TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// Something to be approximated.
pub(crate) struct Target {
    /// Name.
    pub name: String,
    /// The strip that the chain is fitted to.
    pub strip: RuledPatch,
    /// The outline that it is cut along.
    pub outline: PlaneOutline,
}

/// What is proven of one chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Proven {
    /// Distance between surface and cones, both ways.
    pub bound: UpperBound,
    /// Mismatch at joints, computed.
    pub joint: f64,
    /// Trimmed edges: way from the outline carried over, and distance from the exact surfaces; none for whole chains.
    pub trimmed: Option<[UpperBound; 2]>,
    /// Why the outline is not proven.
    pub missing: Option<StripReason>,
}

/// The chain of one surface, cut along its outline, and its proof; `tolerance` in mm.
///
/// # Errors
/// Why no chain can be fitted, or judged.
pub fn body(target: &Target, tolerance: f64) -> Result<(ConeBody, Proven), Reason> {
    let (found, proof) = approximated(target, tolerance)?;
    let name = target.name.clone();
    let unmerged = found.spline.with_turns_below(LARGEST_TURN, LARGEST_TURN);
    let joint = proof.mismatch();
    let whole = |spline: ConeSpline, bound: UpperBound, missing: Option<StripReason>| {
        let proven = Proven { bound, joint, trimmed: None, missing };
        (ConeBody { name: name.clone(), spline, part: None }, proven)
    };
    if let Some(share) = target.outline.strays_from_rectangle() {
        let (spline, proof) = match unmerged.has_circular_edges() {
            true => merged(target, &found, proof, tolerance, ONCE_AROUND),
            false => (unmerged, proof),
        };
        return Ok(whole(spline, proof.bound().plus(astray_bound(&target.outline.surface, share)), None));
    }
    // Trimmed edges replace those of the chain, so that its bounds hold for what lies between them.
    let (spline, proof) = merged(target, &found, proof, tolerance, LARGEST_TURN);
    let outline = target.outline.in_space(&found.nodes);
    let wanted = ConeTrimOptions { outline: OUTLINE_SHARE * tolerance, edge: EDGE_ROUNDING };
    let part = match cone_part(&spline, &outline, &wanted) {
        Ok(part) => part,
        Err(e) => return Ok(whole(spline, proof.bound(), Some(StripReason::Blank(Box::new(Reason::error(&e)))))),
    };
    let region = Region { patch: &target.outline.surface, strip: &target.strip, loops: &target.outline.curves };
    let proven = match certified(&region, &part, &spline, &proof, tolerance) {
        Ok(shown) => Proven {
            bound: shown.bound(),
            joint: proof.mismatch(),
            trimmed: Some([shown.path_bound(), shown.edge_bound()]),
            missing: None,
        },
        Err(fault) => {
            let missing = Some(StripReason::NoOutline(Box::new(Reason::error(&fault))));
            Proven { bound: UpperBound::UNKNOWN, joint: proof.mismatch(), trimmed: None, missing }
        }
    };
    Ok((ConeBody { name, spline, part: Some(part) }, proven))
}

/// Fit and proof; the fit aims lower until the proof of both directions holds.
fn approximated(target: &Target, tolerance: f64) -> Result<(ConeFit, ConeProof), Reason> {
    let mut best: Option<(ConeFit, ConeProof)> = None;
    for share in SHARES {
        let wanted = ConeFitOptions { edges: EDGES * share * tolerance, ..ConeFitOptions::new(share * tolerance) };
        let found = fit(&target.strip, &wanted).map_err(|e| Reason::error(&e));
        let found = match (found, best.take()) {
            (Ok(found), _) => found,
            (Err(_), Some(earlier)) => return Ok(earlier),
            (Err(reason), None) => return Err(reason),
        };
        let proof = certified_cones(&target.strip, &found.nodes, &found.spline, &ConeJudgeOptions::new(tolerance))
            .map_err(|e| Reason::error(&e))?;
        let done = proof.holds(tolerance);
        best = Some((found, proof));
        if done {
            break;
        }
    }
    best.ok_or(StripReason::Nothing.into())
}

/// The chain with segments on one cone made one. These cones are not those that were judged, to the last digit:
/// they are judged again, and stay apart where they do not hold. Between circles one is then cut to turn by no more than `circles`
/// (rad).
fn merged(target: &Target, found: &ConeFit, proof: ConeProof, tolerance: f64, circles: f64) -> (ConeSpline, ConeProof) {
    let size = target.strip.jet(target.strip.domain().0).length();
    let merged = found.spline.merged(size, LARGEST_TURN, ONCE_AROUND);
    let again = (merged.segments.len() < found.spline.segments.len())
        .then(|| merged.cut_like(&found.spline))
        .flatten()
        .and_then(|cut| certified_cones(&target.strip, &found.nodes, &cut, &ConeJudgeOptions::new(tolerance)).ok())
        .filter(|again| again.holds(tolerance.max(proof.bound().value())));
    match again {
        Some(again) => (merged.with_turns_below(LARGEST_TURN, circles), again),
        None => (found.spline.with_turns_below(LARGEST_TURN, LARGEST_TURN), proof),
    }
}
