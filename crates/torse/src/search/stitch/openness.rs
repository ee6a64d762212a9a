//! How far panels of a face are from meeting, and what the proof has refused of them.

use super::seams::pair;
use crate::certify::flat::flat;
use crate::certify::{PanelCertificate, SeamCertificate, SeamStatus};
use crate::control::Control;
use crate::patchwork::panel::Panel;
use crate::search::build::Built;
use crate::search::joint::Further;

/// Places where less than the reciprocal of this share of the tolerance is left are lost to trimming curves, not to distance.
const MOST_COUNTED: f64 = 3.0;

/// How far panels are from meeting: a gap of the tolerance counts one, every seam that is not exact a little besides.
pub(crate) fn openness(built: &Built) -> f64 {
    const EACH: f64 = 0.1;
    let open = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    open.map(|s| EACH + s.gap_bound / built.certificate.tolerance).sum()
}

/// Labels on both sides of seams that are not one edge.
pub(super) fn open(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    seams.filter_map(|s| labels(built, s)).collect()
}

/// Seams at which panels have one edge.
pub(super) fn exact(built: &Built) -> usize {
    built.certificate.seams.iter().filter(|s| s.status == SeamStatus::Exact).count()
}

/// Labels of panels whose flat patterns are not proven.
pub(crate) fn unproven(built: &Built, control: &Control) -> Vec<u32> {
    let proofs = flat(&built.patchwork, &built.patterns, built.certificate.tolerance, control);
    let open = proofs.iter().filter(|p| !p.holds());
    open.filter_map(|p| built.patchwork.panels.get(p.panel())?.label()).collect()
}

/// Where panels are farther from the face than the proof leaves room for.
pub(super) fn places_too_far(built: &Built) -> Vec<Further> {
    let panels = built.patchwork.panels.iter().zip(&built.certificate.panels);
    let place = |(panel, proof): (&Panel, &PanelCertificate)| {
        let (uv, left) = proof.too_far?;
        let counts = built.certificate.tolerance / left;
        (counts < MOST_COUNTED).then_some(Further { label: panel.label()?, uv, counts })
    };
    panels.filter_map(place).collect()
}

/// Labels on both sides of edges that their panels miss.
pub(super) fn missed(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.patchwork.seams().into_iter().zip(&built.certificate.seams);
    let missed = seams.filter(|(s, c)| s.is_shared() && c.status != SeamStatus::Exact);
    missed.filter_map(|(_, c)| labels(built, c)).collect()
}

fn labels(built: &Built, seam: &SeamCertificate) -> Option<[u32; 2]> {
    both(seam.panels.map(|k| built.patchwork.panels[k].label()))
}

/// Two labels in order, if both panels have one.
pub(super) fn both(labels: [Option<u32>; 2]) -> Option<[u32; 2]> {
    Some(pair([labels[0]?, labels[1]?]))
}
