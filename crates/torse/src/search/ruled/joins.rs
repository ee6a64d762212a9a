//! How sharply strips of different pieces of a face meet where it was cut \[W15, 2\].

use crate::geom::Vec3;
use crate::num::hash::HashMap;
use crate::patchwork::panel::{PanelForm, Patchwork};

/// Greatest angle (rad) between panels of different pieces at the vertices that their borders have in common: 0 where they
/// are smooth as a set. *Not guaranteed*: what is between vertices.
pub(super) fn kink_estimate(patchwork: &Patchwork) -> f64 {
    let mut at: HashMap<[u64; 2], Vec<(usize, Vec3)>> = HashMap::default();
    for panel in &patchwork.panels {
        let (Some(trim), Some(partition)) = (&panel.trim, patchwork.partition_of(panel)) else { continue };
        let PanelForm::Ruled(_) = trim.form else { continue };
        for run in trim.loops.iter().flatten() {
            for (v, s) in run.vertices.iter().zip(&run.parameters) {
                let [x, y] = run.trim.point(*s);
                let Some(normal) = panel.strip.patch.jet(x, y).normal().try_normalize(0.0) else { continue };
                at.entry(partition.vertices[*v as usize].map(f64::to_bits)).or_default().push((trim.face, normal));
            }
        }
    }
    let angle = |all: &Vec<(usize, Vec3)>| {
        let others = |k: usize| all[k + 1..].iter().filter(move |o| o.0 != all[k].0).map(move |o| (k, o));
        let pairs = (0..all.len()).flat_map(others);
        // Which side of a strip is up is a matter of its parameters.
        pairs.map(|(k, o)| all[k].1.cross(&o.1).norm().atan2(all[k].1.dot(&o.1).abs())).fold(0.0, f64::max)
    };
    at.values().map(angle).fold(0.0, f64::max)
}
