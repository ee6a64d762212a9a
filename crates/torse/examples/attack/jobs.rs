//! One job of the adversary: a specimen, a change, a certificate, and what is true.

use crate::measure::{measure, Measured};
use crate::mutation::{forgery, number, FORGERIES, NUMBERS};
use crate::random::Random;
use crate::specimen::{specimen, KINDS};
use std::collections::BTreeMap;
use std::io::Write;
use torse::certify::{self, Certificate};
use torse::control::Control;

/// What was tried of one sort, and what came of it.
#[derive(Default)]
pub struct Row {
    pub tried: usize,
    pub certified: usize,
    pub refuted: usize,
    pub violations: usize,
    /// Largest quotient of what was measured and what was certified.
    pub nearest: f64,
}

impl Row {
    pub fn add(&mut self, o: &Self) {
        self.tried += o.tried;
        self.certified += o.certified;
        self.refuted += o.refuted;
        self.violations += o.violations;
        self.nearest = self.nearest.max(o.nearest);
    }
}

/// By sort: surfaces, numbers, forgeries.
pub type Rows = BTreeMap<(usize, usize, String), Row>;

/// Measured distances contain the sampling of the outline, and rounding of large coordinates.
const SLACK: f64 = 1e-4;

/// Share by which a sampled radius or clearance may be below the proven one: rounding of second derivatives.
const SHAPE_SLACK: f64 = 1e-6;

/// Places in each direction at which a specimen is measured to find a tolerance, and to check a certificate.
const COARSE: usize = 6;
const FINE: usize = 24;

/// In what a certificate is contradicted by what was measured.
fn contradicted(c: &Certificate, m: &Measured, size: f64) -> Option<String> {
    let more = c.deviation_bound * (1.0 + SLACK) + 1e-14 * size;
    if m.distance() > more {
        return Some(format!("{:.9} mm apart, certified {:.9}", m.distance(), c.deviation_bound));
    }
    if m.gap > c.seam_gap_bound * (1.0 + SLACK) + 1e-14 * size {
        return Some(format!("sides of the seam {:.9} mm apart, certified {:.9}", m.gap, c.seam_gap_bound));
    }
    for (panel, seen) in c.panels.iter().zip(&m.panels) {
        // Curvatures below rounding of the points say nothing.
        if seen.radius < panel.min_bend_radius * (1.0 - SHAPE_SLACK) && seen.radius < 1e6 {
            return Some(format!("radius {:.6}, certified {:.6}", seen.radius, panel.min_bend_radius));
        }
        if seen.clearance < panel.regression_clearance * (1.0 - SHAPE_SLACK) && seen.clearance < 1e6 {
            return Some(format!("clearance {:.6}, certified {:.6}", seen.clearance, panel.regression_clearance));
        }
    }
    None
}

/// One job: its sort, and whether it was certified, refuted, contradicted.
pub fn job(random: &mut Random, rows: &mut Rows) -> Option<()> {
    let kind = random.below(KINDS.len());
    let (mut patchwork, size) = specimen(random, kind)?;
    let forged = random.below(6) == 0;
    let (key, tolerance) = if forged {
        let what = random.below(FORGERIES.len());
        forgery(&mut patchwork, what, random)?;
        ((2, what, FORGERIES[what].to_string()), 4.0 * size)
    } else {
        let what = if random.below(2) == 0 { 0 } else { random.below(NUMBERS.len()) };
        number(&mut patchwork, what, size, random)?;
        let key = match what {
            0 if patchwork.seam_count > 0 => (0, KINDS.len(), "two panels with a seam".to_string()),
            0 => (0, kind, KINDS[kind].to_string()),
            _ => (1, what, NUMBERS[what].to_string()),
        };
        (key, 0.0)
    };
    let distance = measure(&patchwork, COARSE).map_or(size, |m| m.distance());
    // Beside what is true: hardly room enough, or hardly too little; at times more, for what needs it.
    let room = if random.below(4) == 0 { random.between(1.3, 4.0) } else { random.between(0.9, 1.3) };
    let tolerance = if forged { tolerance } else { distance.max(0.01 * size) * room };
    let certificate = certify::patchwork(&patchwork, tolerance, &Control::default());
    let row = rows.entry(key).or_default();
    row.tried += 1;
    row.refuted += usize::from(certificate.panels.iter().any(|p| p.witness.is_some()));
    if !certificate.certified {
        return Some(());
    }
    row.certified += 1;
    let fault = match &measure(&patchwork, FINE) {
        _ if forged => Some("a forgery".to_string()),
        None => Some("the outline leaves the patch".to_string()),
        Some(m) => {
            row.nearest = row.nearest.max(m.distance() / certificate.deviation_bound);
            contradicted(&certificate, m, patchwork.faces[0].surface.bbox().max.amax())
        }
    };
    if let Some(fault) = fault {
        row.violations += 1;
        let _ = writeln!(std::io::stderr(), "{}, tolerance {tolerance:.3e}: {fault}", KINDS[kind]);
    }
    Some(())
}
