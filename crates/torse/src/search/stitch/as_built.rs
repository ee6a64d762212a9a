//! Covers of the panels that were built on them.

use crate::fit::near::samples::Fit;
use crate::patchwork::panel::Panel;
use crate::search::build::Built;
use crate::search::cover::Cover;
use std::sync::Arc;

impl Cover {
    /// The cover of panels that may have other labels than this one.
    pub(crate) fn of_panels(&self, built: &Built) -> Option<Cover> {
        let mut out = self.with_partition(built.patchwork.partitions.first()?.clone());
        out.bands.clear();
        let fit = |p: &Panel| {
            let (trim, kind, error) = (p.trim.as_ref()?, p.strip.kind, built.certificate.tolerance);
            Some((trim.label, Arc::new(Fit { torse: trim.form.torse()?.clone(), kind, error, worst: 0 })))
        };
        out.panels = built.patchwork.panels.iter().map(fit).collect::<Option<_>>()?;
        Some(out)
    }

    /// The cover with the torses and the partition of panels.
    pub(super) fn as_built(&self, built: &Built) -> Option<Cover> {
        let mut out = self.with_partition(built.patchwork.partitions.first()?.clone());
        for p in &built.patchwork.panels {
            let trim = p.trim.as_ref()?;
            let fit = Fit {
                torse: trim.form.torse()?.clone(),
                kind: p.strip.kind,
                ..(**out.panels.get(&trim.label)?).clone()
            };
            out.panels.insert(trim.label, Arc::new(fit));
        }
        Some(out)
    }
}
