//! Panels of a covered face as they are exported, their proof and their flat patterns.

use super::cover::{Cover, Limits};
use super::stitch::seams::SharedSeam;
use crate::brep::face::Face;
use crate::certify::{self, Certificate, Known};
use crate::control::Control;
use crate::develop::pattern::{pattern, PatternOptions};
use crate::develop::DevelopError;
use crate::fit::panels::boundary::{self, Assigned, Borders, BoundaryError, BoundaryOptions};
use crate::geom::Vec3;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel, Patchwork};
use crate::patchwork::partition::Partition;
use crate::patchwork::pattern::Pattern;
use crate::reason::{FaceReason, Limit, Reason};
use crate::torse::form::{PanelKind, Torse};
use std::collections::{BTreeMap, BTreeSet};

/// Parts into which a panel is cut at once, at most.
const MOST_PARTS: f64 = 64.0;
/// Share of the tolerance that a trim curve may stray from the region's border.
const TRIM_SHARE: f64 = 1.0 / 250.0;
/// The same as a share of the face's size where borders leave a place side by side: holes of 10 mm that touch on a face of 150 mm
/// needed 4·10⁻⁵ mm, with 2·10⁻³ mm their trimming curves crossed.
const CLOSE_TRIM: f64 = 3e-7;
/// Share of that by which the edge in space may stray from the trim curve on its patch.
const EDGE_SHARE: f64 = 0.1;
/// Distance (mm) of edges in space from trimming curves on cylinders and cones: CAD systems take less for none. Programs that
/// take more for a fault find the trimming curve anew, and at the slit of a pipe they may find it on the other side.
const EXACT_EDGE: f64 = 5e-7;
/// Share of the tolerance that lines and arcs of a flat pattern may stray from the exact outline.
const CONTOUR_SHARE: f64 = 0.05;
/// Bend of a border (share of the tolerance) above which it gets finer; each round leaves about a quarter of it.
const BEND_SHARE: f64 = 0.02;
/// See [`BEND_SHARE`].
const SMOOTHINGS: usize = 4;
/// Rounds of moving vertices out of a border's way before each smoothing.
const RELAXATIONS: usize = 3;

/// One face with its panels, their proof and their flat patterns.
#[derive(Clone)]
pub(crate) struct Built {
    pub patchwork: Patchwork,
    pub certificate: Certificate,
    pub patterns: Vec<Pattern>,
    /// What is missing besides the proof.
    pub missing: Vec<Reason>,
    /// Panels along curves.
    pub along: Vec<AlongCurve>,
}

/// A panel that was laid along a curve of the user, or on the front that set out from it.
#[derive(Clone, Debug, PartialEq)]
pub struct AlongCurve {
    /// Index of the panel.
    pub panel: usize,
    /// Name of the curve.
    pub curve: String,
    /// Strips between the curve and the panel: 0 for the panel along the curve itself.
    pub step: usize,
    /// Distance found by the comparison of the paper on curves (matching points at equal parameters), mm. Sampled.
    pub paper_estimate: f64,
}

/// Panels whose flat patterns are too large: labels, and into how many parts each should be cut, along and across.
pub(crate) fn too_large(built: &Built, limits: &Limits) -> Vec<(u32, [usize; 2])> {
    let parts = |size: f64, limit: Option<f64>| limit.map_or(1, |l| (size / l).ceil().clamp(1.0, MOST_PARTS) as usize);
    let of = |p: &Pattern| {
        let across = parts(p.strip_width(), limits.max_width).max(parts(p.width, limits.widest_pattern()));
        let parts = [parts(p.length, limits.longest()), across];
        (parts != [1, 1]).then(|| Some((built.patchwork.panels[p.panel].label()?, parts)))?
    };
    built.patterns.iter().filter_map(of).collect()
}

/// What panels miss of the limits of sheet and material.
#[derive(Clone, Debug, Default)]
pub(crate) struct LimitsMissed {
    /// The first panel of each limit.
    pub reasons: Vec<Reason>,
    /// Panels that do not keep some limit, in order.
    pub panels: Vec<usize>,
}

/// Limits of sheet and material that panels do not keep.
pub(crate) fn limits_missed(
    patchwork: &Patchwork,
    certificate: &Certificate,
    patterns: &[Pattern],
    limits: &Limits,
) -> LimitsMissed {
    let mut panels = BTreeSet::new();
    let name = |k: usize| patchwork.panels.get(k).map_or_else(String::new, |p| p.strip.name.clone());
    let below = |missed: &mut BTreeSet<usize>, what: Limit, limit: Option<f64>, value: Proven| {
        let short = |p: &certify::PanelCertificate| limit.is_some_and(|l| value(p) < l);
        let found: Vec<usize> = (0..certificate.panels.len()).filter(|&k| short(&certificate.panels[k])).collect();
        missed.extend(&found);
        let &k = found.first()?;
        Some(missed_limit(name(k), what, [value(&certificate.panels[k]), limit?], found.len()))
    };
    let reasons = [
        below(&mut panels, Limit::BendRadius, limits.min_bend_radius, |p| p.min_bend_radius),
        below(&mut panels, Limit::Clearance, limits.min_clearance, |p| p.regression_clearance),
    ];
    let drawn = drawings_missed(patterns, limits);
    panels.extend(drawn.panels);
    let reasons = reasons.into_iter().flatten().chain(drawn.reasons).collect();
    LimitsMissed { reasons, panels: panels.into_iter().collect() }
}

/// The same of limits on flat patterns alone.
pub(crate) fn drawings_missed<'a>(
    patterns: impl IntoIterator<Item = &'a Pattern> + Clone,
    limits: &Limits,
) -> LimitsMissed {
    let mut panels = BTreeSet::new();
    let mut missed = |what: Limit, limit: Option<f64>, value: Drawn, is_off: fn(f64, f64) -> bool| {
        let off = |p: &&Pattern| limit.is_some_and(|l| is_off(value(p), l));
        let found: Vec<&Pattern> = patterns.clone().into_iter().filter(off).collect();
        panels.extend(found.iter().map(|p| p.panel));
        let p = found.first()?;
        Some(missed_limit(p.name.clone(), what, [value(p), limit?], found.len()))
    };
    let [above, below]: [fn(f64, f64) -> bool; 2] = [|x, l| x > l, |x, l| x < l];
    let reasons = [
        missed(Limit::StripWidth, limits.max_width, Pattern::strip_width, above),
        missed(Limit::Length, limits.max_length, |p| p.length, above),
        missed(Limit::SheetWidth, limits.sheet_width(), |p| p.width, above),
        missed(Limit::SheetLength, limits.sheet_length(), |p| p.length, above),
        missed(Limit::MeanWidth, limits.min_width, Pattern::mean_width, below),
    ];
    let reasons = reasons.into_iter().flatten().collect();
    LimitsMissed { reasons, panels: panels.into_iter().collect() }
}

/// Why `count` panels, of which one is named, miss a limit: what that one has, and what is asked for.
fn missed_limit(panel: String, limit: Limit, [value, asked]: [f64; 2], count: usize) -> Reason {
    FaceReason::Limit { panel, limit, value, asked, more: count.saturating_sub(1) }.into()
}

/// A number of a panel's proof.
type Proven = fn(&certify::PanelCertificate) -> f64;
/// A number of a flat pattern.
type Drawn = fn(&Pattern) -> f64;

/// Borders of a partition.
pub(crate) fn borders<'a>(face: &'a Face, partition: &'a Partition) -> Borders<'a> {
    Borders::new(face, partition, &|a, b| partition.trim_edges.get(&(a, b)).copied().unwrap_or(0), 0)
}

/// Borders of a partition, which end in some vertices besides.
pub(crate) fn borders_cut_at<'a>(face: &'a Face, partition: &'a Partition, cuts: &BTreeSet<u32>) -> Borders<'a> {
    Borders::cut_at(face, partition, &|a, b| partition.trim_edges.get(&(a, b)).copied().unwrap_or(0), 0, cuts)
}

/// Panels, proof and patterns of a covered face; second result: labels of the regions that must be cut.
pub(crate) fn build(index: usize, cover: &Cover, tolerance: f64) -> (Built, Vec<u32>) {
    // The proof has its own clock: what was found is judged even when time is up.
    build_until(index, cover, tolerance, &Control::default())
}

/// As [`build`], with a proof that ends, and then says nothing, when `control` stops it.
pub(crate) fn build_until(index: usize, cover: &Cover, tolerance: f64, control: &Control) -> (Built, Vec<u32>) {
    assessed(index, &cover.with_smooth_borders(tolerance, |_| true), (tolerance, control), None)
}

/// Strips that are to meet.
pub(crate) struct Joined<'a> {
    /// Their common edges.
    pub edges: &'a [SharedSeam],
    /// What was proven about others of the same face.
    pub known: &'a Known,
}

/// As [`build`], on smooth borders, with strips that meet. Where a panel cannot be proven, none has a pattern.
pub(crate) fn build_on(index: usize, cover: &Cover, limits: (f64, &Control), joined: Joined) -> (Built, Vec<u32>) {
    assessed(index, cover, limits, Some(joined))
}

/// See [`build_on`] and [`build_until`].
fn assessed(
    index: usize,
    cover: &Cover,
    (tolerance, control): (f64, &Control),
    joined: Option<Joined>,
) -> (Built, Vec<u32>) {
    let face = &*cover.face;
    let mut borders = cover.borders();
    let mut assigned: Vec<Assigned> =
        cover.panels.iter().map(|(&label, fit)| Assigned { label, torse: &fit.torse, kind: fit.kind }).collect();
    let order = cover.along_the_model();
    assigned.sort_by_key(|a| order.get(&a.label).copied());
    for e in joined.iter().flat_map(|j| j.edges) {
        borders.share(e.chain, e.edge.clone(), e.parameters.clone());
    }
    let close = if cover.touched { CLOSE_TRIM * face.surface.bbox().diagonal() } else { f64::INFINITY };
    let trim_tolerance = (tolerance * TRIM_SHARE).min(close);
    let made: Vec<Result<Panel, BoundaryError>> = parallel::map(assigned.iter(), |a| {
        borders.panel(0, a, &boundary_options(a.kind, trim_tolerance)).map(|(p, _)| p)
    });
    let seam_count = borders.seam_count;
    let (mut panels, mut missing, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    for (panel, a) in made.into_iter().zip(&assigned) {
        match panel {
            Ok(mut p) => {
                p.strip.name = boundary::panel_name(index, panels.len());
                panels.push(p);
            }
            Err(e) => {
                refused.push(a.label);
                let at = e.uv().map(|[u, v]| face.surface.point(u, v));
                missing.push(FaceReason::NoPanel { error: Box::new(Reason::error(&e)), at }.into());
            }
        }
    }
    let patchwork = Patchwork {
        faces: vec![face.clone()],
        partitions: vec![cover.partition.clone()],
        panels,
        seam_count,
        joint_count: 0,
    };
    missing.extend(cover.stray_seam(&patchwork, tolerance));
    let certificate = match &joined {
        Some(Joined { known, .. }) => certify::patchwork_after(known, &patchwork, tolerance, control),
        None => certify::patchwork(&patchwork, tolerance, control),
    };
    let bad = |k: &usize| !certificate.panels[*k].certified;
    // Attempts that fail are not developed.
    let count =
        if joined.is_some() && (0..patchwork.panels.len()).any(|k| bad(&k)) { 0 } else { patchwork.panels.len() };
    let pattern_options = PatternOptions::new(tolerance * CONTOUR_SHARE);
    let developed: Vec<Result<Pattern, DevelopError>> =
        parallel::map(0..count, |k| pattern(&patchwork, k, &pattern_options));
    let mut patterns = Vec::new();
    let mut without = BTreeSet::new();
    for (k, developed) in developed.into_iter().enumerate() {
        match developed {
            Ok(p) => patterns.push(p),
            Err(e) => {
                without.insert(k);
                let (panel, error) = (patchwork.panels[k].strip.name.clone(), Box::new(Reason::error(&e)));
                missing.push(FaceReason::NoPattern { panel, error }.into());
            }
        }
    }
    let of = (0..patchwork.panels.len()).filter(|k| bad(k) || without.contains(k));
    refused.extend(of.filter_map(|k| patchwork.panels[k].label()));
    let panels = patchwork.panels.iter().enumerate();
    let along = panels.filter_map(|(panel, p)| {
        let o = cover.origins.get(&p.label()?)?;
        Some(AlongCurve { panel, curve: o.curve.clone(), step: o.step, paper_estimate: o.paper_estimate })
    });
    let along = along.collect();
    (Built { patchwork, certificate, patterns, missing, along }, refused)
}

/// How near edges are to be to trimming curves of this tolerance (mm).
fn boundary_options(kind: PanelKind, trim_tolerance: f64) -> BoundaryOptions {
    let usual = trim_tolerance * EDGE_SHARE;
    let exact = matches!(kind, PanelKind::Cylinder | PanelKind::Cone);
    BoundaryOptions { trim_tolerance, edge_tolerance: if exact { usual.min(EXACT_EDGE) } else { usual } }
}

/// What changes of a face that has panels.
pub(crate) struct Rebuilding<'a> {
    /// Its regions, with the same labels and vertices, and more of these on its border.
    pub partition: &'a Partition,
    /// Vertices in which borders end besides.
    pub cuts: &'a BTreeSet<u32>,
    /// All edges that panels share with others.
    pub edges: &'a [SharedSeam],
    /// Torses of the labels whose panels are built anew; the others stay as they are.
    pub torses: &'a BTreeMap<u32, Torse>,
    /// What was proven before.
    pub known: &'a Known,
}

/// A face with some of its panels built anew, and the labels of those that cannot be proven, or developed; without patterns then.
pub(crate) fn rebuilt(old: &Built, to: &Rebuilding, control: &Control) -> (Built, BTreeSet<u32>) {
    let (face, tolerance) = (&old.patchwork.faces[0], old.certificate.tolerance);
    let mut borders = borders_cut_at(face, to.partition, to.cuts);
    for e in to.edges {
        borders.share(e.chain, e.edge.clone(), e.parameters.clone());
    }
    let made: Vec<Result<Panel, u32>> = parallel::map(old.patchwork.panels.iter(), |p| {
        let new = p.label().and_then(|label| Some((label, to.torses.get(&label)?)));
        let Some((label, torse)) = new else { return Ok(p.clone()) };
        let assigned = Assigned { label, torse, kind: p.strip.kind };
        let options = boundary_options(p.strip.kind, tolerance * TRIM_SHARE);
        let (mut panel, _) = borders.panel(0, &assigned, &options).map_err(|_| label)?;
        panel.strip.name.clone_from(&p.strip.name);
        Ok(panel)
    });
    let mut refused: BTreeSet<u32> = made.iter().filter_map(|m| m.as_ref().err()).copied().collect();
    let panels = made.into_iter().zip(&old.patchwork.panels).map(|(m, p)| m.unwrap_or_else(|_| p.clone())).collect();
    let patchwork = Patchwork {
        faces: vec![face.clone()],
        partitions: vec![to.partition.clone()],
        panels,
        seam_count: old.patchwork.seam_count,
        joint_count: 0,
    };
    let nothing = |patchwork, certificate| Built {
        patchwork,
        certificate,
        patterns: Vec::new(),
        missing: old.missing.clone(),
        along: old.along.clone(),
    };
    if !refused.is_empty() {
        return (nothing(patchwork, old.certificate.clone()), refused);
    }
    let certificate = certify::patchwork_after(to.known, &patchwork, tolerance, control);
    let label = |k: usize| patchwork.panels[k].label();
    refused.extend((0..patchwork.panels.len()).filter(|&k| !certificate.panels[k].certified).filter_map(label));
    if !refused.is_empty() {
        return (nothing(patchwork, certificate), refused);
    }
    let options = PatternOptions::new(tolerance * CONTOUR_SHARE);
    let anew = |k: usize| label(k).is_some_and(|l| to.torses.contains_key(&l));
    let developed: Vec<Result<Pattern, usize>> = parallel::map(old.patterns.iter(), |p| {
        if anew(p.panel) {
            pattern(&patchwork, p.panel, &options).map_err(|_| p.panel)
        } else {
            Ok(p.clone())
        }
    });
    refused.extend(developed.iter().filter_map(|p| p.as_ref().err()).filter_map(|&k| label(k)));
    let patterns = developed.into_iter().flatten().collect();
    (Built { patterns, ..nothing(patchwork, certificate) }, refused)
}

/// Seams asked for may move by a tolerance in the face, and panels lie within one of it.
const SEAM_STRAYS: f64 = 2.0;
/// Places on every span of an edge at which it is compared with seams that were asked for.
const EDGE_PLACES: usize = 8;

impl Cover {
    /// Borders between regions.
    pub(super) fn borders(&self) -> Borders<'_> {
        borders(&self.face, &self.partition)
    }

    /// The cover with borders between panels as smooth as the tolerance asks for, those between labels (in order) that `among`
    /// names.
    pub(super) fn with_smooth_borders(&self, tolerance: f64, among: impl Fn([u32; 2]) -> bool) -> Self {
        let (s, mut partition) = (&self.face.surface, self.partition.clone());
        let (u, v) = (s.knots_u.breaks(), s.knots_v.breaks());
        let distance = |p: [f64; 2], q: [f64; 2]| {
            let j = s.jet(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]));
            (j.du * (q[0] - p[0]) + j.dv * (q[1] - p[1])).norm()
        };
        for _ in 0..SMOOTHINGS {
            for _ in 0..RELAXATIONS {
                partition.relax([&u, &v]);
            }
            if partition.smooth_seams([&u, &v], tolerance * BEND_SHARE, distance, &among) == 0 {
                break;
            }
        }
        self.with_partition(partition)
    }

    /// A seam asked for beside which no edge of a panel runs.
    fn stray_seam(&self, patchwork: &Patchwork, tolerance: f64) -> Option<Reason> {
        if self.seam_lines.is_empty() {
            return None;
        }
        let polyline = |c: &Coedge| {
            let count = EDGE_PLACES * (c.edge.knots.breaks().len() - 1);
            (0..=count).map(|k| Vec3::from(c.edge.point(k as f64 / count as f64))).collect::<Vec<_>>()
        };
        let edges: Vec<Vec<Vec3>> = patchwork.panels.iter().flat_map(Panel::loops).flatten().map(polyline).collect();
        let strays = self.seam_lines.iter().filter_map(|l| l.farthest_from(&self.face, &edges));
        let (by, at) = strays.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|f| f.0 > SEAM_STRAYS * tolerance)?;
        Some(FaceReason::SeamLost { entity: self.face.entity, by, at }.into())
    }

    /// The order in which panels are numbered: along the axis of the model over which their middles spread most, towards its
    /// positive end, then along the other axes.
    fn along_the_model(&self) -> BTreeMap<u32, usize> {
        let mut sums: BTreeMap<u32, (Vec3, f64)> = BTreeMap::new();
        for (t, label) in self.partition.labels.iter().enumerate() {
            let area = self.triangle_area(t);
            let middle = self.middle(t);
            let sum = sums.entry(*label).or_insert((Vec3::zeros(), 0.0));
            *sum = (sum.0 + middle * area, sum.1 + area);
        }
        let middles: Vec<(u32, Vec3)> = sums.into_iter().map(|(l, (x, a))| (l, x / a.max(f64::MIN_POSITIVE))).collect();
        let (low, high) =
            middles.iter().fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(lo, hi), (_, x)| {
                (lo.inf(x), hi.sup(x))
            });
        let spread = high - low;
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| spread[b].total_cmp(&spread[a]));
        // Steps of the first axis, so that panels side by side are numbered across and not at random.
        let step = (SIDE_BY_SIDE * spread[axes[0]]).max(f64::MIN_POSITIVE);
        let mut keys: Vec<(i64, [f64; 3], u32)> = middles
            .iter()
            .map(|(l, x)| {
                (((x[axes[0]] - low[axes[0]]) / step).round() as i64, [x[axes[1]], x[axes[2]], x[axes[0]]], *l)
            })
            .collect();
        let less = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| a[k].total_cmp(&b[k])).find(|o| o.is_ne());
        keys.sort_by(|a, b| a.0.cmp(&b.0).then(less(&a.1, &b.1).unwrap_or(a.2.cmp(&b.2))));
        keys.into_iter().enumerate().map(|(k, key)| (key.2, k)).collect()
    }
}

/// Middles of panels within this share of their spread count as side by side.
const SIDE_BY_SIDE: f64 = 0.04;
