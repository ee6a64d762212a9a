//! The proof of a whole patchwork: coverage, panels, seams \[certificate, 1 and 5\].

use super::certificate::{Certificate, CertificateParts, PanelCertificate, PanelParts};
use super::certificate::{SeamCertificate, SeamParts, SeamStatus};
use super::coverage::{self, loops_bound_triangles};
use super::fingerprint::{self, Fingerprint};
use super::known::{Known, ProvenPanel};
use super::local::way;
use super::panel::{panel_certificate, place_on, Ground};
use super::prepared::Prepared;
use super::ruled::{Ruled, RuledJets};
use super::ruled_panel::ruled_panel;
use super::seams::{self, SeamSide};
use crate::brep::face::Face;
use crate::control::Control;
use crate::geom::BBox;
use crate::num::parallel;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, Patchwork};
use crate::patchwork::seam::Seam;
use crate::reason::{CoverFault, Item, PanelFault, ProofFault, Reason, SeamFault};
use std::sync::Arc;

/// Tolerances below this share of the model's size cannot be certified in double precision: rounding of the control
/// points alone comes near.
pub(crate) const SMALLEST_RELATIVE_TOLERANCE: f64 = 1e-10;

/// Parameters of a vertex on both sides of a seam must add up to 1 within this.
const MIRROR: f64 = 1e-9;

/// Proves all that is claimed about a patchwork: two-sided deviation, developability, regularity, coverage, seam gaps.
///
/// *Input*: lengths in mm; the tolerance is the deviation allowed between the trimmed faces and the exported panels.
///
/// *Guarantee*: with `certified`, every point of every trimmed face (its polygons are the definition of the trim) is
/// within `deviation_bound ≤ tolerance` of the exported panels and conversely; every panel is regular, and developable
/// up to the angle stated. *Not* guaranteed: the conversion of the file's own representation (see `Face`), watertight
/// seams (their gap is bounded instead). The edges in space that accompany the trimming curves are part of the bound.
///
/// *Cost*: some 10 µs per triangle and 20 µs per side of a boundary; all in parallel.
pub fn patchwork(patchwork: &Patchwork, tolerance: f64, control: &Control) -> Certificate {
    judged(patchwork, tolerance, control, None)
}

/// As [`patchwork()`], after others of the same face: what has not changed is not proven again. Of panels that are not near
/// the tolerance no bound is stated.
pub(crate) fn patchwork_after(known: &Known, patchwork: &Patchwork, tolerance: f64, control: &Control) -> Certificate {
    judged(patchwork, tolerance, control, Some(known))
}

fn judged(patchwork: &Patchwork, tolerance: f64, control: &Control, known: Option<&Known>) -> Certificate {
    let panels = vec![PanelCertificate(PanelParts::blank()); patchwork.panels.len()];
    let mut out = CertificateParts { panels, ..CertificateParts::nothing(tolerance) };
    let of = vec![Fingerprint::of(patchwork)];
    let size = patchwork.faces.iter().fold(BBox::empty(), |mut b, f| {
        let c = f.surface.bbox();
        b.include(&c.min);
        b.include(&c.max);
        b
    });
    let least = SMALLEST_RELATIVE_TOLERANCE * size.diagonal();
    if !(tolerance >= least && tolerance.is_finite()) {
        out.missing.push(ProofFault::Precision { tolerance, least }.into());
        return Certificate { parts: out, of, joints: fingerprint::of_joints(patchwork) };
    }
    for (i, face) in patchwork.faces.iter().enumerate() {
        if !(face.joint_bound() >= 0.0 && face.joint_bound().is_finite()) {
            out.missing.push(ProofFault::Joined { face: i, by: face.joint_bound() }.into());
        }
        if !(face.trim_bound() >= 0.0 && face.trim_bound().is_finite()) {
            out.missing.push(ProofFault::Trimmed { face: i, by: face.trim_bound() }.into());
        }
    }
    let sides = coverage_of(patchwork, &mut out);
    let jets = panels_of(patchwork, &sides, (control, known), &mut out);
    match seam_gaps(patchwork, &jets, tolerance, known) {
        Ok(gaps) => {
            out.seam_gap_bound = gaps.iter().map(|g| g.0).fold(0.0, f64::max);
            let unknown = (f64::INFINITY, f64::INFINITY);
            let record = |s: &Seam| seam_record(s, gaps.get(s.seam as usize).copied().unwrap_or(unknown), tolerance);
            let inside = |s: &&Seam| (s.seam as usize) < patchwork.seam_count;
            out.seams = patchwork.seams().iter().filter(inside).map(record).collect();
        }
        Err((seam, fault)) => out.missing.push(ProofFault::Seams { seam, fault }.into()),
    }
    joints_of(patchwork, &mut out);
    out.certified = out.covered && out.missing.is_empty() && out.deviation_bound <= tolerance;
    Certificate { parts: out, of, joints: fingerprint::of_joints(patchwork) }
}

/// What is known of a seam, given the bounds of its gap and of the difference of lengths.
fn seam_record(s: &Seam, (gap_bound, length_difference_bound): (f64, f64), tolerance: f64) -> SeamCertificate {
    SeamCertificate(SeamParts {
        panels: s.sides.map(|s| s.panel),
        gap_bound,
        length_difference_bound,
        status: SeamStatus::of(s.is_shared(), gap_bound, tolerance),
        length_estimate: s.length(),
        kink_range_estimate: s.kink_range_estimate(),
    })
}

/// Adds what is known of the joints along borders of faces: each must have two sides, and its gap is bounded as that of a seam.
fn joints_of(patchwork: &Patchwork, out: &mut CertificateParts) {
    let joints: Vec<Seam> =
        patchwork.seams().into_iter().filter(|s| (s.seam as usize) >= patchwork.seam_count).collect();
    let sides = patchwork.panels.iter().flat_map(|p| p.loops().iter().flatten());
    let sides = sides.filter(|r| matches!(r.border, Border::Joint { .. })).count();
    if joints.len() != patchwork.joint_count || sides != 2 * patchwork.joint_count {
        out.missing.push(ProofFault::Seams { seam: patchwork.seam_count, fault: SeamFault::Sides(sides) }.into());
        return;
    }
    let tolerance = out.tolerance;
    let found: Vec<Result<(SeamCertificate, f64), (usize, SeamFault)>> = parallel::map(joints.iter(), |s| {
        let patches = s.sides.map(|side| Ruled::new(&side.of.strip.patch));
        let [Some(p), Some(q)] = &patches else { return Err((s.seam as usize, SeamFault::NoPatch)) };
        let jets = [p, q].map(|r| RuledJets::new(r, place_on(r).as_ref()));
        let sides = [0, 1].map(|k: usize| SeamSide { jets: &jets[k], trim: &s.sides[k].run.trim });
        let gap = seams::gap_bound(sides, s.turned, tolerance).ok_or((s.seam as usize, SeamFault::Leaves))?;
        let lengths = seams::length_difference(sides, s.turned, tolerance).unwrap_or(f64::INFINITY);
        Ok((seam_record(s, (gap, lengths), tolerance), gap))
    });
    for joint in found {
        match joint {
            Ok((record, gap)) => {
                out.seam_gap_bound = out.seam_gap_bound.max(gap);
                out.seams.push(record);
            }
            Err((seam, fault)) => out.missing.push(ProofFault::Seams { seam, fault }.into()),
        }
    }
}

/// Coverage, by counting. For every face how far, in each parameter, the partition's vertices lie off the trimming
/// polygons' sides; `None` where the partition is not that of the face: its regions may lie anywhere.
fn coverage_of(patchwork: &Patchwork, out: &mut CertificateParts) -> Vec<Option<[f64; 2]>> {
    let mut sides = vec![None; patchwork.faces.len()];
    out.covered = true;
    if patchwork.partitions.len() == patchwork.faces.len() {
        let found: Vec<_> = parallel::map(patchwork.faces.iter().zip(&patchwork.partitions), |(face, partition)| {
            coverage::partition_covers(face, partition)
        });
        for (i, found) in found.into_iter().enumerate() {
            match found {
                Ok(off) => sides[i] = Some(off),
                Err(fault) => {
                    out.covered = false;
                    out.missing.push(ProofFault::Cover { face: Some(i), fault }.into());
                }
            }
        }
    } else {
        out.covered = false;
        out.missing.push(ProofFault::Cover { face: None, fault: CoverFault::Partitions }.into());
    }
    if let Err(fault) = coverage::labels_have_panels(&patchwork.partitions, &patchwork.panels) {
        out.covered = false;
        out.missing.push(ProofFault::Cover { face: None, fault }.into());
    }
    sides
}

/// Surfaces ready for proofs, and how far their panels' regions were moved by what was before, mm.
fn grounds_of<'a>(patchwork: &'a Patchwork, sides: &[Option<[f64; 2]>]) -> Vec<(Prepared<'a>, f64)> {
    let of = |(f, off): (&'a Face, &Option<[f64; 2]>)| {
        let prepared = Prepared::new(&f.surface);
        let moved = way(&prepared, off.unwrap_or([0.0; 2])) + f.joint_bound() + f.trim_bound();
        // Rounded up, and no bound at all if one of both is none.
        (prepared, if moved >= f.joint_bound() { moved.next_up().next_up() } else { f64::INFINITY })
    };
    parallel::map(patchwork.faces.iter().zip(sides), of)
}

/// What a certificate says of panels and seams, ready to be taken over by proofs of others on the same faces: of panels that are
/// certified. Nothing where it is about another patchwork.
pub(crate) fn known_of(certificate: &Certificate, patchwork: &Patchwork) -> Known {
    let (out, tolerance) = (Known::default(), certificate.tolerance);
    if !certificate.is_of(patchwork) {
        return out;
    }
    let sides = coverage_of(patchwork, &mut CertificateParts::nothing(tolerance));
    let grounds = grounds_of(patchwork, &sides);
    let surfaces: Vec<u64> = patchwork.faces.iter().map(|f| fingerprint::of_surface(&f.surface)).collect();
    parallel::for_each(
        patchwork.panels.iter().zip(&certificate.panels).filter(|(_, c)| c.certified),
        |(panel, proof)| {
            let of = panel.trim.as_ref().filter(|t| t.form.torse().is_some()).zip(patchwork.partition_of(panel));
            let Some((trim, partition)) = of else { return };
            let (Some((_, moved)), Some(ruled)) = (grounds.get(trim.face), Ruled::new(&panel.strip.patch)) else {
                return;
            };
            let key = fingerprint::of_panel(panel, partition, (surfaces[trim.face], false), [*moved, tolerance]);
            let jets = RuledJets::new(&ruled, place_on(&ruled).as_ref());
            if let Some(key) = key {
                out.panel(key, || (proof.0.clone(), Some(Arc::new(jets))));
            }
        },
    );
    let inside = patchwork.seams().into_iter().zip(&certificate.seams);
    for (s, proof) in inside.filter(|(s, _)| (s.seam as usize) < patchwork.seam_count) {
        // In the order in which proofs find them.
        let mut sides = s.sides;
        sides.sort_by_key(|side| side.panel);
        let key = fingerprint::of_seam(sides.map(|side| (side.of, side.run)), tolerance);
        out.seam(key, || Some((proof.gap_bound, proof.length_difference_bound)));
    }
    out
}

/// The proofs of all panels; result: their patches, ready for the seams.
fn panels_of(
    patchwork: &Patchwork,
    sides: &[Option<[f64; 2]>],
    (control, known): (&Control, Option<&Known>),
    out: &mut CertificateParts,
) -> Vec<Option<Arc<RuledJets>>> {
    let surfaces: Vec<u64> = match known {
        Some(_) => patchwork.faces.iter().map(|f| fingerprint::of_surface(&f.surface)).collect(),
        None => Vec::new(),
    };
    let grounds = grounds_of(patchwork, sides);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let total = patchwork.panels.len();
    let tolerance = out.tolerance;
    let one = |panel: &Panel| -> ProvenPanel {
        let of = panel.trim.as_ref().zip(patchwork.partition_of(panel)).and_then(|(trim, partition)| {
            let (prepared, moved) = grounds.get(trim.face)?;
            Some((trim, Ground { partition, prepared, moved: *moved, far: known.is_none() }))
        });
        let Some((trim, ground)) = of else {
            return (PanelParts { reason: Some(PanelFault::NoFace.into()), ..PanelParts::blank() }, None);
        };
        let prove = || {
            let (parts, jets) = match &trim.form {
                PanelForm::Ruled(map) => ruled_panel(panel, (trim, map), &ground, tolerance, control),
                PanelForm::Torse(torse) => panel_certificate(panel, (trim, torse), &ground, tolerance, control),
            };
            (parts, jets.map(Arc::new))
        };
        let lengths = [ground.moved, tolerance];
        let key = surfaces
            .get(trim.face)
            .and_then(|s| fingerprint::of_panel(panel, ground.partition, (*s, ground.far), lengths));
        let (mut parts, jets) = match (known, key) {
            (Some(known), Some(key)) if !control.stopped() => known.panel(key, prove),
            _ => prove(),
        };
        // What is around the region is never taken over.
        if let Err(fault) = loops_bound_triangles(ground.partition, trim) {
            parts.certified = false;
            parts.reason = Reason::all(parts.reason.into_iter().chain([PanelFault::Cover(fault).into()]).collect());
        }
        // However near a panel is to its region: where that is no part of the face nothing is known of the distance from it.
        if sides.get(trim.face).is_none_or(Option::is_none) {
            parts.certified = false;
            parts.deviation_bound = f64::INFINITY;
            parts.reason = Reason::all(parts.reason.into_iter().chain([PanelFault::OffFace.into()]).collect());
        }
        (parts, jets)
    };
    let found: Vec<ProvenPanel> = parallel::map(patchwork.panels.iter(), |panel| {
        let result = one(panel);
        let n = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        control.report("proving panels", n as f64 / total as f64, format!("{n} of {total}"));
        result
    });
    let (panels, jets): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    out.panels = panels.into_iter().map(PanelCertificate).collect();
    out.deviation_bound = out.panels.iter().fold(0.0, |m, p| p.deviation_bound.max(m));
    let failing: Vec<usize> = (0..total).filter(|&i| !out.panels[i].certified).collect();
    for &i in failing.iter().take(3) {
        let reason = out.panels[i].reason.clone();
        let name = Item::Panel(patchwork.panels[i].strip.name.clone());
        out.missing.push(Reason::of(name, reason.unwrap_or(ProofFault::SomePanel.into())));
    }
    if failing.len() > 3 {
        out.missing.push(ProofFault::MorePanels(failing.len() - 3).into());
    }
    jets
}

/// The certificate of a patchwork whose parts, one after the other, were proven one by one (the faces of a model).
///
/// *Guarantee*: it is certified only if the parts are those of the patchwork, bit by bit, all of them and nothing else,
/// and each was certified within the tolerance; bounds are the largest of the parts'.
pub fn join(whole: &Patchwork, parts: Vec<Certificate>, tolerance: f64) -> Certificate {
    let mut out = CertificateParts {
        certified: !parts.is_empty(),
        deviation_bound: 0.0,
        seam_gap_bound: 0.0,
        covered: true,
        ..CertificateParts::nothing(tolerance)
    };
    let of: Vec<Fingerprint> = parts.iter().flat_map(|p| p.of.iter().copied()).collect();
    for Certificate { parts: p, .. } in parts {
        out.certified &= p.certified && p.deviation_bound <= tolerance;
        out.deviation_bound = out.deviation_bound.max(p.deviation_bound);
        out.seam_gap_bound = out.seam_gap_bound.max(p.seam_gap_bound);
        out.covered &= p.covered;
        let first = out.panels.len();
        let moved = |s: SeamCertificate| SeamCertificate(SeamParts { panels: s.panels.map(|k| k + first), ..s.0 });
        out.seams.extend(p.seams.into_iter().map(moved));
        out.panels.extend(p.panels);
        out.missing.extend(p.missing);
    }
    if !Fingerprint::make_up(&of, whole) {
        (out.certified, out.covered) = (false, false);
        out.missing.push(ProofFault::Another.into());
    }
    let before = out.missing.len();
    joints_of(whole, &mut out);
    out.certified &= out.missing.len() == before;
    if !out.certified && out.missing.is_empty() {
        out.missing.push(ProofFault::Larger.into());
    }
    Certificate { parts: out, of, joints: fingerprint::of_joints(whole) }
}

/// As [`join`], of pieces that were cut out of one face: along a cut each side ends within its deviation of the same line, and
/// both are no farther apart than the sum. *Not checked*: that the parts are such pieces.
pub fn join_pieces(whole: &Patchwork, parts: Vec<Certificate>, tolerance: f64) -> Certificate {
    let mut bounds: Vec<f64> = parts.iter().map(|p| p.deviation_bound).collect();
    bounds.sort_by(|a, b| b.total_cmp(a));
    let mut out = join(whole, parts, tolerance);
    if let [first, second, ..] = bounds[..] {
        out.parts.seam_gap_bound = out.parts.seam_gap_bound.max((first + second).next_up());
    }
    out
}

impl Certificate {
    /// Whether this is about the very patchwork, bit by bit.
    pub fn is_of(&self, patchwork: &Patchwork) -> bool {
        Fingerprint::make_up(&self.of, patchwork) && self.joints == fingerprint::of_joints(patchwork)
    }
}

/// Bounds of gap and of difference in length of both sides, for all seams.
fn seam_gaps(
    patchwork: &Patchwork,
    jets: &[Option<Arc<RuledJets>>],
    tolerance: f64,
    known: Option<&Known>,
) -> Result<Vec<(f64, f64)>, (usize, SeamFault)> {
    let mut sides: Vec<Vec<(usize, bool, &Coedge)>> = vec![Vec::new(); patchwork.seam_count];
    for (i, panel) in patchwork.panels.iter().enumerate() {
        for run in panel.loops().iter().flatten() {
            if let Border::Seam { seam, forward } = run.border {
                let slot = sides.get_mut(seam as usize).ok_or((seam as usize, SeamFault::Uncounted))?;
                slot.push((i, forward, run));
            }
        }
    }
    let found = parallel::map(sides.iter().enumerate(), |(seam, sides)| {
        let [(i, f, a), (j, g, b)] = sides.as_slice() else {
            return Err((seam, SeamFault::Sides(sides.len())));
        };
        let mirrored = f != g
            && a.vertices.iter().eq(b.vertices.iter().rev())
            && a.parameters.iter().zip(b.parameters.iter().rev()).all(|(s, r)| (s + r - 1.0).abs() <= MIRROR);
        if !mirrored {
            return Err((seam, SeamFault::NotMirrored));
        }
        if patchwork.panels[*i].face() != patchwork.panels[*j].face() {
            return Err((seam, SeamFault::Faces));
        }
        let (Some(Some(p)), Some(Some(q))) = (jets.get(*i), jets.get(*j)) else {
            return Err((seam, SeamFault::NoPatch));
        };
        let prove = || {
            let sides = [SeamSide { jets: p, trim: &a.trim }, SeamSide { jets: q, trim: &b.trim }];
            let gap = seams::gap_bound(sides, true, tolerance)?;
            Some((gap, seams::length_difference(sides, true, tolerance).unwrap_or(f64::INFINITY)))
        };
        let of = [(*i, a), (*j, b)].map(|(k, run)| (&patchwork.panels[k], *run));
        let found = match known {
            Some(known) => known.seam(fingerprint::of_seam(of, tolerance), prove),
            None => prove(),
        };
        found.ok_or((seam, SeamFault::Leaves))
    });
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::{self, two_panels};
    use crate::reason::LoopFault;

    fn prove(p: &Patchwork, tolerance: f64) -> Certificate {
        patchwork(p, tolerance, &Control::default())
    }

    /// What one side of a seam is longer than the other: never less than measured, and not much more.
    #[test]
    fn lengths_of_both_sides_of_a_seam_are_bounded_sharply() {
        let p = two_panels(1e-3, 4);
        let tolerance = 1.05e-3;
        let c = prove(&p, tolerance);
        let lengths: Vec<f64> = p
            .panels
            .iter()
            .flat_map(|panel| panel.loops().iter().flatten().map(move |run| (panel, run)))
            .filter(|(_, run)| matches!(run.border, Border::Seam { .. }))
            .map(|(panel, run)| {
                let at = |k: u32| {
                    let [u, v] = run.trim.point(f64::from(k) / 4000.0);
                    panel.strip.patch.point(u, v)
                };
                (0..4000).map(|k| (at(k + 1) - at(k)).norm()).sum()
            })
            .collect();
        let off = (lengths[0] - lengths[1]).abs();
        let bound = c.seams[0].length_difference_bound;
        assert!(lengths.len() == 2 && off <= bound + 1e-7 && bound < off + 0.06 * tolerance, "{off:e} {bound:e}");
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
            let outline: Vec<[f64; 2]> = panel.loops()[0]
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
                    let x = panel.strip.patch.point(t, r);
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

    /// Nearest distance (mm) from a point to the whole surface.
    fn off_surface(surface: &crate::spline::surface::Surface, x: &crate::geom::Vec3) -> f64 {
        let grid = (0..=40).flat_map(|i| (0..=40).map(move |j| [i as f64 / 40.0, j as f64 / 40.0]));
        let far = |p: &[f64; 2]| (surface.point(p[0], p[1]) - x).norm_squared();
        let mut p = grid.fold([0.0; 2], |best, p| if far(&p) < far(&best) { p } else { best });
        let mut step = 1.0 / 40.0;
        for _ in 0..60 {
            let around = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
            let near = around.map(|d| [0, 1].map(|k: usize| (p[k] + d[k]).clamp(0.0, 1.0)));
            match near.into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).filter(|q| far(q) < far(&p)) {
                Some(q) => p = q,
                None => step *= 0.5,
            }
        }
        far(&p).sqrt()
    }

    #[test]
    fn a_trim_that_strays_at_one_place_counts_there_and_samples_stay_below() {
        const TOLERANCE: f64 = 1.6e-3;
        let plain = prove(&two_panels(1e-3, 6), TOLERANCE);
        // The outer border of the second panel bulges beyond the face, and so does its edge.
        let mut p = two_panels(1e-3, 6);
        let patch = p.panels[1].strip.patch.clone();
        let run = &mut p.panels[1].loops_mut()[0][3];
        for (k, way) in [(8, 0.6), (9, 1.0), (10, 1.0), (11, 0.6)] {
            let t = run.trim.control[k][0];
            let ruling = patch.point(t, 1.0) - patch.point(t, 0.0);
            let more = way * 1e-3 / ruling.norm();
            run.trim.control[k][1] += more;
            (0..3).for_each(|d| run.edge.control[k][d] += more * ruling[d]);
        }
        let run = run.clone();
        let found = prove(&p, TOLERANCE);
        assert!(found.certified, "{:?}", found.missing);
        let panel = &found.panels[1];
        assert!(panel.boundary_bound > 0.8e-3 && panel.deviation_bound > plain.panels[1].deviation_bound);
        // Less than if the largest distance stood where the largest mismatch is.
        let both = panel.distance_bound.hypot(panel.boundary_bound);
        assert!(panel.deviation_bound < both, "{} {both}", panel.deviation_bound);
        let surface = &p.faces[0].surface;
        let mut most = 0.0f64;
        for i in 0..=300 {
            let q = run.trim.point(f64::from(i) / 300.0);
            let off = off_surface(surface, &patch.point(q[0], q[1]));
            assert!(off <= panel.deviation_bound, "{off} {}", panel.deviation_bound);
            most = most.max(off);
        }
        assert!(most > 0.8e-3, "{most}");
    }

    /// Whether a fault is among what is said.
    fn says(reason: &Reason, fault: fn(&ProofFault) -> bool) -> bool {
        match reason {
            Reason::Of(_, reason) => says(reason, fault),
            Reason::Several(all) => all.iter().any(|r| says(r, fault)),
            Reason::Proof(found) => fault(found),
            _ => false,
        }
    }

    #[test]
    fn what_is_wrong_is_said() {
        let of_panel = |f: &ProofFault| matches!(f, ProofFault::Panel(_));
        let good = two_panels(1e-3, 4);
        let known = Known::default();
        assert!(patchwork_after(&known, &good, 1.05e-3, &Control::default()).certified);
        let refused = |name: &str, said: fn(&ProofFault) -> bool, change: &dyn Fn(&mut Patchwork)| {
            let mut p = good.clone();
            change(&mut p);
            let c = prove(&p, 1.05e-3);
            // Proofs of what was good are not taken over.
            assert!(!patchwork_after(&known, &p, 1.05e-3, &Control::default()).certified, "{name}");
            assert!(!c.certified && c.missing.iter().any(|m| says(m, said)), "{name}: {:?}", c.missing);
        };
        refused(
            "a vertex of the patch off by 1e-8",
            |f| matches!(f, ProofFault::Panel(PanelFault::Twisted(..))),
            &|p| p.panels[0].strip.patch.control[10][2] += 1e-5,
        );
        refused("a piece of the region gone", |f| matches!(f, ProofFault::Cover { .. }), &|p| {
            p.partitions[0].triangles.pop();
            p.partitions[0].labels.pop();
        });
        refused("a loop reversed", of_panel, &|p| {
            for run in p.panels[0].loops_mut()[0].iter_mut() {
                run.vertices.reverse();
            }
            p.panels[0].loops_mut()[0].reverse();
        });
        refused("a corner of the trim dropped", of_panel, &|p| {
            let n = p.panels[0].loops()[0][0].trim.control.len();
            p.panels[0].loops_mut()[0][0].trim.control[n / 2][1] += 0.1;
        });
        refused("a panel gone", |f| matches!(f, ProofFault::Cover { fault: CoverFault::NoPanel(..), .. }), &|p| {
            p.panels.pop();
        });
        refused(
            "trimming curves that do not join",
            |f| matches!(f, ProofFault::Panel(PanelFault::TrimAt(LoopFault::Apart, _))),
            &|p| p.panels[1].loops_mut()[0][0].trim.control[0][0] += 1e-12,
        );
        refused(
            "a seam of one side only",
            |f| matches!(f, ProofFault::Seams { fault: SeamFault::Sides(1), .. }),
            &|p| p.panels[1].loops_mut()[0][1].border = Border::Trim { edge: 7 },
        );
    }

    #[test]
    fn a_proof_that_is_taken_over_is_the_same_proof() {
        let (first, mut next) = (two_panels(1e-3, 4), two_panels(1e-3, 4));
        let known = Known::default();
        let again = |p: &Patchwork| patchwork_after(&known, p, 1.05e-3, &Control::default());
        again(&first);
        let bounds = |c: &Certificate| c.panels.iter().map(|p| p.deviation_bound).collect::<Vec<_>>();
        // One panel of two is another, and its neighbour and their seam keep what they have.
        next.panels[1].strip.patch.control[10][2] += 1e-9;
        let (taken, fresh) = (again(&next), prove(&next, 1.05e-3));
        assert_eq!(bounds(&taken), bounds(&fresh));
        assert_eq!(taken.seams, fresh.seams);
        // From a certificate as it is, too, if it is about the same patchwork.
        let known = known_of(&fresh, &next);
        assert_eq!(known.counts(), [2, 1]);
        assert_eq!(bounds(&patchwork_after(&known, &next, 1.05e-3, &Control::default())), bounds(&fresh));
        assert_eq!(known.counts(), [2, 1]);
        assert_eq!(known_of(&fresh, &first).counts(), [0, 0]);
        assert_ne!(bounds(&taken)[1], bounds(&prove(&first, 1.05e-3))[1]);
    }

    #[test]
    fn the_witness_exceeds_the_tolerance() {
        let p = two_panels(1e-3, 4);
        let c = prove(&p, 5e-4);
        assert!(!c.certified);
        let panel = c.panels.iter().find(|p| p.witness.is_some()).expect("a witness");
        let (uv, distance) = panel.witness.expect("a witness");
        let there = specimens::brute_distance(
            p.panels[0].trim.as_ref().and_then(|t| t.form.torse()).expect("a torse"),
            &p.faces[0].surface.point(uv[0], uv[1]),
        );
        assert!(distance.abs() > 4.9e-4 && (there - distance.abs()).abs() < 1e-5);
        // A bound is stated all the same.
        assert!(c.deviation_bound > 5e-4 && c.deviation_bound < 2e-3, "{}", c.deviation_bound);
    }

    #[test]
    fn joining_keeps_the_worst() {
        let (first, second) = (two_panels(1e-4, 2), two_panels(1e-3, 2));
        let (good, bad) = (prove(&first, 1e-3), prove(&second, 5e-4));
        let both = join(&one_after_the_other(&first, &second), vec![good.clone(), bad.clone()], 1e-3);
        assert!(!both.certified && both.panels.len() == 4);
        assert!(both.deviation_bound >= bad.deviation_bound && both.missing == bad.missing);
        assert!(join(&first, vec![good.clone()], 1e-3).certified);
        let stricter = join(&first, vec![good], 1e-5);
        assert!(!stricter.certified && !stricter.missing.is_empty());
    }

    fn one_after_the_other(a: &Patchwork, b: &Patchwork) -> Patchwork {
        let mut out = a.clone();
        out.faces.extend(b.faces.iter().cloned());
        out.partitions.extend(b.partitions.iter().cloned());
        for mut p in b.panels.iter().cloned() {
            p.trim.iter_mut().for_each(|t| t.face += a.faces.len());
            for run in p.loops_mut().iter_mut().flatten() {
                if let Border::Seam { seam, .. } = &mut run.border {
                    *seam += a.seam_count as u32;
                }
            }
            out.panels.push(p);
        }
        out.seam_count += b.seam_count;
        out
    }

    #[test]
    fn certificates_of_something_else_are_worth_nothing() {
        let (first, second) = (two_panels(1e-4, 2), two_panels(2e-4, 2));
        let (a, b) = (prove(&first, 1e-3), prove(&second, 1e-3));
        let both = one_after_the_other(&first, &second);
        assert!(a.certified && b.certified && a.is_of(&first) && !a.is_of(&second));
        let all = join(&both, vec![a.clone(), b.clone()], 1e-3);
        assert!(all.certified && all.is_of(&both) && all.seams.len() == 2, "{:?}", all.missing);
        for (name, parts) in [
            ("one left out", vec![a.clone()]),
            ("swapped", vec![b.clone(), a.clone()]),
            ("twice", vec![a.clone(), a.clone()]),
        ] {
            let forged = join(&both, parts, 1e-3);
            assert!(!forged.certified && !forged.covered && !forged.missing.is_empty(), "{name}");
        }
        let mut changed = first.clone();
        changed.panels[0].loops_mut()[0][0].edge.control[3][0] += 1e-12;
        assert!(!a.is_of(&changed) && !join(&changed, vec![a], 1e-3).certified);
    }

    #[test]
    fn a_gap_that_is_hidden_is_found() {
        // Both sides of the seam say that they are borders of the face.
        let mut p = two_panels(1e-3, 4);
        for (panel, run) in [(0, 3), (1, 1)] {
            p.panels[panel].loops_mut()[0][run].border = Border::Trim { edge: 7 };
        }
        p.seam_count = 0;
        let c = prove(&p, 1.05e-3);
        let miscalled = |f: &ProofFault| {
            matches!(f, ProofFault::Panel(PanelFault::Cover(CoverFault::Miscalled { seam: false, .. })))
        };
        assert!(!c.certified && c.missing.iter().any(|m| says(m, miscalled)), "{:?}", c.missing);
    }

    #[test]
    fn what_joining_moved_is_a_bound_or_refused() {
        for moved in [-1e-3, f64::NAN, f64::INFINITY] {
            let mut p = two_panels(1e-3, 4);
            p.faces[0].set_joint_bound(moved);
            let c = prove(&p, 1.05e-3);
            assert!(!c.certified && !c.missing.is_empty(), "{moved}");
        }
    }

    #[test]
    fn panels_on_more_than_the_face_have_no_distance_from_it() {
        let mut p = two_panels(1e-3, 4);
        let good = prove(&p, 1.05e-3);
        assert!(good.certified && good.deviation_bound <= 1.05e-3);
        // The face ends before its triangles do: both panels are as near to these as before.
        let points = &mut p.faces[0].loops[0].points;
        let last = points.iter().map(|q| q[1]).fold(f64::NEG_INFINITY, f64::max);
        points.iter_mut().filter(|q| q[1] >= last).for_each(|q| q[1] *= 0.9);
        let c = prove(&p, 1.05e-3);
        assert!(!c.certified && !c.covered && c.deviation_bound.is_infinite());
        assert!(c.panels.iter().all(|p| !p.certified && p.deviation_bound.is_infinite()));
    }

    #[test]
    fn an_edge_with_other_knots_is_not_the_same_edge() {
        let mut p = two_panels(1e-4, 4);
        let edge = p.panels[0].loops()[0][3].edge.clone();
        p.panels[1].loops_mut()[0][1].edge = edge.reversed();
        assert_eq!(prove(&p, 1e-2).seams[0].status, SeamStatus::Exact);
        let mut values = edge.reversed().knots.values().to_vec();
        let middle = values.len() / 2;
        values[middle] += 1e-3;
        let other = &mut p.panels[1].loops_mut()[0][1].edge;
        *other = crate::spline::curve::Curve::new(3, values, other.control.clone()).expect("edge");
        assert_ne!(prove(&p, 1e-2).seams[0].status, SeamStatus::Exact);
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
