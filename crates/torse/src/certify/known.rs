//! Proofs that are taken over where nothing they are about has changed \[certificate, 6\].
//!
//! The proof of a panel is about its patch, its torse, its trimming curves and edges, the triangles and vertices of its
//! region, its surface, what joining and trimming moved, and the tolerance: nothing else goes into it. Where all of these are
//! the same bit by bit as in a patchwork that was judged before, so is the proof. The same holds for seams and what is on
//! both sides of them. Numbers of vertices, panels and seams may differ.

use super::certificate::PanelParts;
use super::ruled::RuledJets;
use crate::num::hash::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// What was proven about a panel, and its patch ready for the seams.
pub(super) type ProvenPanel = (PanelParts, Option<Arc<RuledJets>>);

/// What was proven about panels and seams of one face, by their fingerprints.
#[derive(Default)]
pub(crate) struct Known {
    panels: Mutex<HashMap<u64, ProvenPanel>>,
    seams: Mutex<HashMap<u64, (f64, f64)>>,
}

impl Known {
    /// Numbers of panels and seams.
    #[cfg(test)]
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.panels.lock().map_or(0, |p| p.len()), self.seams.lock().map_or(0, |s| s.len())]
    }

    /// The proof of a panel, made if it is not known.
    pub(super) fn panel(&self, key: u64, prove: impl FnOnce() -> ProvenPanel) -> ProvenPanel {
        taken_over(&self.panels, key, prove)
    }

    /// Bounds of gap and difference in length of a seam, made if they are not known.
    pub(super) fn seam(&self, key: u64, prove: impl FnOnce() -> Option<(f64, f64)>) -> Option<(f64, f64)> {
        let unknown = (f64::NAN, f64::NAN);
        Some(taken_over(&self.seams, key, || prove().unwrap_or(unknown))).filter(|s| !s.0.is_nan())
    }
}

fn taken_over<T: Clone>(of: &Mutex<HashMap<u64, T>>, key: u64, prove: impl FnOnce() -> T) -> T {
    let lock = || of.lock().unwrap_or_else(PoisonError::into_inner);
    let found = lock().get(&key).cloned();
    found.unwrap_or_else(|| {
        let proven = prove();
        lock().insert(key, proven.clone());
        proven
    })
}
