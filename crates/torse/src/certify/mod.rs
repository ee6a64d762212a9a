//! Floor 5: the independent judge. Imports nothing from `fit`; only this module can make a [`Certificate`].
//!
//! [`distance()`] judges one torse on one region and is what a covering loop calls; [`patchwork()`] proves everything
//! about what will be exported. Theory: certificate \[certificate\]; the primal torse \[mixed, C1.4\]; plane families
//! \[PW99\].

mod boundary;
mod cell;
pub mod cones;
mod coverage;
mod developable;
pub mod distance;
pub mod elements;
mod family;
mod local;
mod panel;
pub mod points;
pub mod prepared;
mod quadratic;
pub mod quads;
pub mod rails;
pub mod regression;
mod rounding;
mod ruled;
mod seams;
mod simple;
#[cfg(test)]
mod specimens;
mod vector;

pub use distance::{distance, DistanceOptions, Judgement};
pub use prepared::Prepared;

use crate::control::Control;
use crate::geom::BBox;
use crate::surface::panel::{Border, Patchwork, Run};
use crate::surface::seam::Seam;
use rayon::prelude::*;
use ruled::RuledJets;
use seams::Shore;

/// Tolerances below this share of the model's size cannot be certified in double precision: rounding of the control
/// points alone comes near.
pub const SMALLEST_RELATIVE_TOLERANCE: f64 = 1e-10;

/// Parameters of a vertex on both sides of a seam must add up to 1 within this.
const MIRROR: f64 = 1e-9;

/// Whether a statement was proven, or how it failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The distance stays below `bound` (mm) at every point.
    Holds {
        /// Proven bound, mm.
        bound: f64,
    },
    /// At the witness the distance is proven to exceed the tolerance.
    Fails {
        /// Parameters on the face.
        uv: [f64; 2],
        /// Signed distance there, mm.
        distance: f64,
    },
    /// Neither could be shown within the budget.
    Undecided {
        /// Parameters of the place that resisted.
        uv: [f64; 2],
        /// Why.
        reason: Resistance,
    },
}

/// Why a box could not be decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resistance {
    /// No unique foot point could be shown: the regression curve is near, or rulings leave the patch.
    Foot,
    /// The foot map may fold over.
    Fold,
    /// The surface's parametrisation degenerates.
    Degenerate,
    /// The bound stays above the tolerance down to the smallest box.
    Bound,
    /// Too many boxes.
    Budget,
    /// Cancelled or out of time.
    Stopped,
}

/// Can be named in this floor only, so that only this floor can fill a certificate.
#[derive(Clone, Copy, Debug)]
struct Seal;

/// What was proven about one panel. Lengths in mm.
#[derive(Clone, Debug)]
pub struct PanelCertificate {
    /// Whether everything below is proven and within the tolerance.
    pub certified: bool,
    /// Why not, and where; empty when certified.
    pub reason: String,
    /// Witness: parameters on the face, and the distance there, when the tolerance is exceeded.
    pub witness: Option<([f64; 2], f64)>,
    /// Two-sided bound between the panel as exported and its part of the face; infinite if none was shown.
    pub deviation_bound: f64,
    /// Part of the bound: face to (untrimmed) torse along normals.
    pub distance_bound: f64,
    /// Part of the bound: exported trim curves against the images of the region's boundary, along the panel; it enters in
    /// quadrature.
    pub boundary_bound: f64,
    /// Part of the bound: exported patch against the exact torse.
    pub rounding_bound: f64,
    /// Largest angle (rad) between the tangent planes of the exported patch along any ruling, within the trimming
    /// curves.
    pub developability_bound: f64,
    /// Lower bound of the distance along rulings between panel and regression curve; infinite for cylinders.
    pub regression_clearance: f64,
    /// Lower bound of the radius of curvature of the panel; infinite for planes.
    pub min_bend_radius: f64,
    /// Boxes or triangles accepted.
    pub cells: usize,
    _sealed: Seal,
}

/// What is known about a seam. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamCertificate {
    /// Panels on both sides.
    pub panels: [usize; 2],
    /// Proven bound of the distance between its two sides at equal parameters.
    pub gap_bound: f64,
    /// Whether the panels meet.
    pub status: SeamStatus,
    /// Length, measured.
    pub length_estimate: f64,
    /// Smallest and largest angle (rad) between the panels along the seam, sampled.
    pub kink_range_estimate: (f64, f64),
}

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
    fn of(shared: bool, gap: f64, tolerance: f64) -> Self {
        if shared && gap <= EXACT_SHARE * tolerance {
            Self::Exact
        } else if gap <= OPEN_SHARE * tolerance {
            Self::Tolerance
        } else {
            Self::Open
        }
    }
}

/// What was proven about a whole patchwork. Lengths in mm.
#[derive(Clone, Debug)]
pub struct Certificate {
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
    /// Parts of the proof that are missing, in plain words; empty when certified.
    pub missing: Vec<String>,
    _sealed: Seal,
}

impl PanelCertificate {
    /// Nothing is known yet.
    fn blank() -> Self {
        Self {
            certified: false,
            reason: String::new(),
            witness: None,
            deviation_bound: f64::INFINITY,
            distance_bound: f64::INFINITY,
            boundary_bound: f64::INFINITY,
            rounding_bound: f64::INFINITY,
            developability_bound: f64::INFINITY,
            regression_clearance: 0.0,
            min_bend_radius: 0.0,
            cells: 0,
            _sealed: Seal,
        }
    }
}

/// Proves all that is claimed about a patchwork: two-sided deviation, developability, regularity, coverage, seam gaps.
///
/// *Input*: lengths in mm; the tolerance is the deviation allowed between the trimmed faces and the exported panels.
///
/// *Guarantee*: with `certified`, every point of every trimmed face (its polygons are the definition of the trim) is
/// within `deviation_bound ≤ tolerance` of the exported panels and conversely; every panel is regular, and developable
/// up to the angle stated. *Not* guaranteed: the conversion of the file's own representation (see `Face`), watertight
/// seams (their gap is bounded instead), and the curves in space that accompany the trimming curves.
///
/// *Cost*: some 10 µs per triangle and 20 µs per side of a boundary; all in parallel.
pub fn patchwork(patchwork: &Patchwork, tolerance: f64, control: &Control) -> Certificate {
    let mut out = Certificate {
        tolerance,
        certified: false,
        deviation_bound: f64::INFINITY,
        seam_gap_bound: f64::INFINITY,
        seams: Vec::new(),
        covered: false,
        panels: vec![PanelCertificate::blank(); patchwork.panels.len()],
        missing: Vec::new(),
        _sealed: Seal,
    };
    let size = patchwork.faces.iter().fold(BBox::empty(), |mut b, f| {
        let c = f.surface.bbox();
        b.include(&c.min);
        b.include(&c.max);
        b
    });
    let least = SMALLEST_RELATIVE_TOLERANCE * size.diagonal();
    if !(tolerance >= least && tolerance.is_finite()) {
        out.missing.push(format!(
            "everything: a tolerance of {tolerance:e} mm cannot be certified in double precision at this size; \
             at least {least:.1e} mm is needed"
        ));
        return out;
    }

    // Coverage, by counting.
    let mut covered = true;
    if patchwork.partitions.len() == patchwork.faces.len() {
        let found: Vec<_> = patchwork
            .faces
            .par_iter()
            .zip(&patchwork.partitions)
            .map(|(face, partition)| coverage::partition_covers(face, partition))
            .collect();
        for (i, reason) in found.into_iter().enumerate().filter_map(|(i, r)| r.err().map(|e| (i, e))) {
            covered = false;
            out.missing.push(format!("coverage of face {i}: {reason}"));
        }
    } else {
        covered = false;
        out.missing.push("coverage: faces and partitions differ in number".into());
    }
    if let Err(reason) = coverage::labels_have_panels(&patchwork.partitions, &patchwork.panels) {
        covered = false;
        out.missing.push(format!("coverage: {reason}"));
    }
    out.covered = covered;

    // Panels.
    let prepared: Vec<Prepared> = patchwork.faces.par_iter().map(|f| Prepared::new(&f.surface)).collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let total = patchwork.panels.len();
    let found: Vec<(PanelCertificate, Option<RuledJets>)> = patchwork
        .panels
        .par_iter()
        .map(|panel| {
            let moved = patchwork.faces.get(panel.face).map_or(0.0, |f| f.joint_bound);
            let result = match (patchwork.partitions.get(panel.face), prepared.get(panel.face)) {
                (Some(partition), Some(prepared)) => {
                    panel::panel_certificate(panel, partition, prepared, moved, tolerance, control)
                }
                _ => (PanelCertificate::blank(), None),
            };
            let n = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            control.report("certify", n as f64 / total as f64, panel.name.clone());
            result
        })
        .collect();
    let (panels, jets): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    out.panels = panels;
    out.deviation_bound = out.panels.iter().fold(0.0, |m, p| p.deviation_bound.max(m));
    let failing: Vec<usize> = (0..total).filter(|&i| !out.panels[i].certified).collect();
    for &i in failing.iter().take(3) {
        out.missing.push(format!("panel {}: {}", patchwork.panels[i].name, out.panels[i].reason));
    }
    if failing.len() > 3 {
        out.missing.push(format!("{} more panels", failing.len() - 3));
    }

    // Seams.
    match seam_gaps(patchwork, &jets, tolerance) {
        Ok(gaps) => {
            out.seam_gap_bound = gaps.iter().copied().fold(0.0, f64::max);
            let record = |s: &Seam| {
                let gap_bound = gaps.get(s.seam as usize).copied().unwrap_or(f64::INFINITY);
                SeamCertificate {
                    panels: s.sides.map(|s| s.panel),
                    gap_bound,
                    status: SeamStatus::of(s.is_shared(), gap_bound, tolerance),
                    length_estimate: s.length(),
                    kink_range_estimate: s.kink_range_estimate(),
                }
            };
            out.seams = patchwork.seams().iter().map(record).collect();
        }
        Err(reason) => out.missing.push(format!("seams: {reason}")),
    }
    out.certified = covered && out.missing.is_empty() && out.deviation_bound <= tolerance;
    out
}

/// The certificate of several patchworks together, one after the other (the faces of a model, proven one by one).
pub fn join(parts: Vec<Certificate>, tolerance: f64) -> Certificate {
    let mut out = Certificate {
        tolerance,
        certified: !parts.is_empty(),
        deviation_bound: 0.0,
        seam_gap_bound: 0.0,
        seams: Vec::new(),
        covered: true,
        panels: Vec::new(),
        missing: Vec::new(),
        _sealed: Seal,
    };
    for p in parts {
        out.certified &= p.certified && p.deviation_bound <= tolerance;
        out.deviation_bound = out.deviation_bound.max(p.deviation_bound);
        out.seam_gap_bound = out.seam_gap_bound.max(p.seam_gap_bound);
        out.covered &= p.covered;
        let first = out.panels.len();
        out.seams.extend(p.seams.into_iter().map(|s| SeamCertificate { panels: s.panels.map(|k| k + first), ..s }));
        out.panels.extend(p.panels);
        out.missing.extend(p.missing);
    }
    if !out.certified && out.missing.is_empty() {
        out.missing.push("a part was proven for a larger tolerance only".into());
    }
    out
}

/// Bounds of the gaps of all seams.
fn seam_gaps(patchwork: &Patchwork, jets: &[Option<RuledJets>], tolerance: f64) -> Result<Vec<f64>, String> {
    let mut sides: Vec<Vec<(usize, bool, &Run)>> = vec![Vec::new(); patchwork.seam_count];
    for (i, panel) in patchwork.panels.iter().enumerate() {
        for run in panel.loops.iter().flatten() {
            if let Border::Seam { seam, forward } = run.border {
                let slot = sides.get_mut(seam as usize).ok_or_else(|| format!("seam {seam} is not counted"))?;
                slot.push((i, forward, run));
            }
        }
    }
    sides
        .par_iter()
        .enumerate()
        .map(|(seam, sides)| {
            let [(i, f, a), (j, g, b)] = sides.as_slice() else {
                return Err(format!("seam {seam} has {} sides", sides.len()));
            };
            let mirrored = f != g
                && a.vertices.iter().eq(b.vertices.iter().rev())
                && a.parameters.iter().zip(b.parameters.iter().rev()).all(|(s, r)| (s + r - 1.0).abs() <= MIRROR);
            if !mirrored {
                return Err(format!("the two sides of seam {seam} do not mirror each other"));
            }
            let (Some(Some(p)), Some(Some(q))) = (jets.get(*i), jets.get(*j)) else {
                return Err(format!("seam {seam} has a side without a patch"));
            };
            seams::gap_bound(Shore { jets: p, run: a }, Shore { jets: q, run: b }, tolerance)
                .ok_or_else(|| format!("seam {seam} leaves a patch"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::specimens::two_panels;
    use super::*;

    fn prove(p: &Patchwork, tolerance: f64) -> Certificate {
        patchwork(p, tolerance, &Control::default())
    }

    #[test]
    fn a_good_patchwork_is_certified_and_samples_stay_below() {
        let p = two_panels(1e-3, 4);
        let c = prove(&p, 1.05e-3);
        assert!(c.certified && c.missing.is_empty(), "{c:?}");
        assert!(c.deviation_bound <= 1.05e-3 && c.covered);
        assert!(c.seam_gap_bound < 2e-5, "{}", c.seam_gap_bound);
        for panel in &c.panels {
            assert!(panel.rounding_bound < 1e-10 && panel.developability_bound < 1e-8);
            assert!(panel.boundary_bound < 3e-5, "{}", panel.boundary_bound);
            assert!(panel.min_bend_radius > 0.3 && panel.regression_clearance > 1.0, "{panel:?}");
        }
    }

    #[test]
    fn points_of_the_exported_panels_are_near_the_face() {
        // The other direction: points of the patch inside the trimming curves against the surface, by Newton steps.
        let p = two_panels(1e-3, 4);
        let c = prove(&p, 1.05e-3);
        let surface = &p.faces[0].surface;
        let mut tried = 0;
        for (panel, proof) in p.panels.iter().zip(&c.panels) {
            let outline: Vec<[f64; 2]> = panel.loops[0]
                .iter()
                .flat_map(|r| (0..200).map(|i| r.trim.point(i as f64 / 200.0)).collect::<Vec<_>>())
                .collect();
            for i in 0..40 {
                for j in 0..40 {
                    let (t, r) = (-0.1 + 1.6 * (i as f64 + 0.37) / 40.0, (j as f64 + 0.41) / 40.0);
                    let crossings = (0..outline.len())
                        .filter(|&k| {
                            let (a, b) = (outline[k], outline[(k + 1) % outline.len()]);
                            (a[1] > r) != (b[1] > r) && t < a[0] + (r - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                        })
                        .count();
                    if crossings % 2 == 0 {
                        continue;
                    }
                    tried += 1;
                    let x = panel.patch.point(t, r);
                    let (mut u, mut v) = (t / 1.3, r);
                    for _ in 0..20 {
                        let s = surface.jet(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
                        let d = x - s.p;
                        let (e, f, g) = (s.du.dot(&s.du), s.du.dot(&s.dv), s.dv.dot(&s.dv));
                        let (a, b) = (s.du.dot(&d), s.dv.dot(&d));
                        let det = e * g - f * f;
                        u = (u + (g * a - f * b) / det).clamp(0.0, 1.0);
                        v = (v + (e * b - f * a) / det).clamp(0.0, 1.0);
                    }
                    let off = (x - surface.point(u, v)).norm();
                    assert!(off <= proof.deviation_bound, "{off} {}", proof.deviation_bound);
                }
            }
        }
        assert!(tried > 700, "{tried}");
    }

    #[test]
    fn what_is_wrong_is_said() {
        let good = two_panels(1e-3, 4);
        let refused = |name: &str, word: &str, change: &dyn Fn(&mut Patchwork)| {
            let mut p = good.clone();
            change(&mut p);
            let c = prove(&p, 1.05e-3);
            assert!(!c.certified && c.missing.iter().any(|m| m.contains(word)), "{name}: {:?}", c.missing);
        };
        refused("a vertex of the patch off by 1e-8", "rad", &|p| p.panels[0].patch.control[10][2] += 1e-5);
        refused("a piece of the region gone", "coverage", &|p| {
            p.partitions[0].triangles.pop();
            p.partitions[0].labels.pop();
        });
        refused("a loop reversed", "region", &|p| {
            for run in p.panels[0].loops[0].iter_mut() {
                run.vertices.reverse();
            }
            p.panels[0].loops[0].reverse();
        });
        refused("a corner of the trim dropped", "panel A-0", &|p| {
            let n = p.panels[0].loops[0][0].trim.control.len();
            p.panels[0].loops[0][0].trim.control[n / 2][1] += 0.1;
        });
        refused("a panel gone", "belongs to no panel", &|p| {
            p.panels.pop();
        });
        refused("trimming curves that do not join", "join", &|p| p.panels[1].loops[0][0].trim.control[0][0] += 1e-12);
        refused("a seam of one side only", "seam", &|p| p.panels[1].loops[0][1].border = Border::Trim { edge: 7 });
    }

    #[test]
    fn the_witness_exceeds_the_tolerance() {
        let p = two_panels(1e-3, 4);
        let c = prove(&p, 5e-4);
        assert!(!c.certified);
        let panel = c.panels.iter().find(|p| p.witness.is_some()).expect("a witness");
        let (uv, distance) = panel.witness.expect("a witness");
        let there = specimens::brute_distance(&p.panels[0].torse, &p.faces[0].surface.point(uv[0], uv[1]));
        assert!(distance.abs() > 4.9e-4 && (there - distance.abs()).abs() < 1e-5);
        // A bound is stated all the same.
        assert!(c.deviation_bound > 5e-4 && c.deviation_bound < 2e-3, "{}", c.deviation_bound);
    }

    #[test]
    fn joining_keeps_the_worst() {
        let good = prove(&two_panels(1e-4, 2), 1e-3);
        let bad = prove(&two_panels(1e-3, 2), 5e-4);
        let both = join(vec![good.clone(), bad.clone()], 1e-3);
        assert!(!both.certified && both.panels.len() == 4);
        assert!(both.deviation_bound >= bad.deviation_bound && both.missing == bad.missing);
        assert!(join(vec![good.clone()], 1e-3).certified);
        let stricter = join(vec![good], 1e-5);
        assert!(!stricter.certified && !stricter.missing.is_empty());
    }

    #[test]
    fn absurd_tolerances_are_refused() {
        let p = two_panels(0.0, 2);
        for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-13] {
            let c = prove(&p, tolerance);
            assert!(!c.certified && !c.missing.is_empty());
        }
    }
}
