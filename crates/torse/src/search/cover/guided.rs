//! Panels along curves that a designer gives, and the front that goes on from their borders (\[SE06\]).
//!
//! *Method.* Along each curve the envelope of the tangent planes; its region between the ends of the minimal ruling
//! intervals, with smoothed borders; what earlier panels cover is left out, since only free regions are cut. The third
//! refinement of the paper (shorter intervals) answers a refusal by the certificate, which stands in the place of the
//! paper's bound; the first and the second (more rulings, more points on each) only sharpen the paper's own comparison,
//! which is kept beside the certified bound. Then the front: the next curve lies ahead of the last border by as much as
//! the intervals on it reach, so that the next strip begins at that border. Where the front stops, the automatic cover
//! goes on.
//!
//! Departures: the dual torse interpolates the tangent planes by least squares, so it is exactly developable, but
//! not through every one of them exactly; curves are carried on straight in the parameter plane until they leave the
//! face; closed curves become two halves.

use super::covered_face::{Cover, Origin};
use super::curve_on_face::{carried_on, CurveError, PanelCurve};
use super::job::{Job, DISTANCE_SHARE};
use super::layout::DirectionField;
use super::march::{TRIALS, UNKNOWN};
use super::region::{Density, Region};
use crate::fit::near::dual::envelope;
use crate::fit::near::samples::{error, Fit};
use crate::fit::near::tangent_envelope::{envelope_along, interval, paper_estimate, smoothed, walked, EnvelopeRuling};
use crate::geom::Vec3;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Rulings of a strip.
const RULINGS: usize = 81;
/// Spans of the spline of planes.
const SPANS: usize = 26;
/// Share of its parameter range by which the torse reaches beyond the line.
const REACH: f64 = 0.1;
/// Weight of the smoothing (19).
const SMOOTHING: f64 = 4.0;
/// Sampled errors up to this share of the allowed distance go to the certificate.
const HOPEFUL: f64 = 0.995;
/// Share of the tolerance for which intervals are measured: planes by least squares and smoothing use up the rest.
const INTERVALS: f64 = 0.97;
/// A front whose strips are shorter along their rulings than this share of the intervals is given up.
const LEAST_SHARE: f64 = 0.2;
/// Strips of the front from one side of a curve at most: they may become narrower without end.
const MOST_STRIPS: usize = 2000;
/// Panels along curves may be this multiple of the strips that only run in their direction.
const MORE: f64 = 1.2;
/// A strip that covers less than this share of the face ends its front: slivers that rounding leaves.
const LEAST_AREA: f64 = 1e-9;

/// A line for a strip.
struct FrontLine {
    points: Vec<[f64; 2]>,
    /// Whether it is carried on beyond the face.
    open: bool,
}

/// A strip that was accepted.
struct Laid {
    cover: Cover,
    /// Borders, backward and forward.
    borders: [Vec<[f64; 2]>; 2],
    labels: Vec<u32>,
}

/// Rulings with a torse through their planes.
struct RuledTorse {
    points: Vec<EnvelopeRuling>,
    ends: Vec<[f64; 2]>,
    torse: crate::torse::form::Torse,
}

impl Job<'_> {
    /// A cover along curves: panels along these and fronts from there on, and what they leave free, unless strips that run in
    /// the direction of the nearest curve are clearly fewer. Envelopes lie on one side of the face, so their strips are
    /// narrower than those that lie on both, and a front begins where the last one ended whatever is left at its end.
    pub(super) fn along_curves(&mut self, cover: Cover, curves: &[PanelCurve]) -> Cover {
        let tolerance = self.options.tolerance;
        let found = |c: &PanelCurve| cover.lines_of(c, tolerance).unwrap_or_default();
        let found: Vec<Vec<Vec<[f64; 2]>>> = curves.iter().map(found).collect();
        let in_space = |l: &Vec<[f64; 2]>| l.iter().map(|p| self.face.surface.point(p[0], p[1])).collect();
        let beside: Vec<Vec<Vec3>> = found.iter().flatten().map(in_space).collect();
        if beside.is_empty() {
            return self.covered(cover, &DirectionField::Free);
        }
        let directions = DirectionField::Beside(beside);
        let promised = self.promised(&cover, &directions);
        if let Some(found) = promised.and_then(|n| self.within(&cover, curves, MORE * n)) {
            return found;
        }
        let directed = self.covered(cover.clone(), &directions);
        let count = directed.panels.len() as f64;
        if !directed.is_complete() || promised.is_none_or(|n| count > n) {
            let most = if directed.is_complete() { MORE * count } else { f64::INFINITY };
            if let Some(found) = self.within(&cover, curves, most).filter(|_| !self.control.stopped()) {
                return found;
            }
        }
        let named = curves.iter().map(|c| c.name.as_str()).zip(&found);
        named.fold(directed, |cover, (name, lines)| cover.named(name, lines))
    }

    /// Number of strips that theory promises along a direction field; `None` where it says nothing.
    fn promised(&self, cover: &Cover, directions: &DirectionField<'_>) -> Option<f64> {
        let along = |region: Region| {
            let potential = self.directed_strip_potentials(directions, region, (700, 2)).into_iter().next()?;
            Some(self.bands_predicted(region, &potential).max(1.0))
        };
        cover.regions().map(along).sum()
    }

    /// At most so many panels along curves, on from there, and in what is left free.
    fn within(&mut self, cover: &Cover, curves: &[PanelCurve], most: f64) -> Option<Cover> {
        let whole = self.options.max_panels;
        self.options.max_panels = whole.min(most.ceil() as usize);
        let found = self.guided(cover.clone(), curves);
        let found = self.covered(found, &DirectionField::Free);
        self.options.max_panels = whole;
        found.is_complete().then_some(found)
    }

    /// Lays the panels along all curves of the layout, then the fronts; what stays free has no torse.
    pub(super) fn guided(&self, mut cover: Cover, curves: &[PanelCurve]) -> Cover {
        let bounds = cover.bounds();
        let mut fronts: Vec<(String, usize, FrontLine, f64)> = Vec::new();
        for c in curves {
            let Ok(found) = cover.lines_of(c, self.options.tolerance) else { continue };
            for line in found.into_iter().flat_map(opened) {
                let Some(ruled) = self.ruled_torse(&line, bounds) else { continue };
                if let Some(laid) = self.strip(&cover, &ruled, None, &c.name, 0) {
                    cover = laid.cover;
                    let [back, forth] = laid.borders;
                    fronts.push((c.name.clone(), 1, FrontLine { points: back, open: line.open }, -1.0));
                    fronts.push((c.name.clone(), 1, FrontLine { points: forth, open: line.open }, 1.0));
                }
            }
        }
        // All fronts advance in turn.
        let mut fronts = std::collections::VecDeque::from(fronts);
        while let Some((name, step, border, side)) = fronts.pop_front() {
            let full = cover.panels.len() >= self.options.max_panels;
            if self.control.stopped() || full || step > MOST_STRIPS || cover.free().is_empty() {
                break;
            }
            if let Some((laid, next)) = self.advanced(&cover, &border, side, bounds, (&name, step)) {
                cover = laid;
                fronts.push_back((name, step + 1, FrontLine { points: next, open: border.open }, side));
            }
        }
        cover
    }

    /// The strip ahead of a border, and its far border.
    fn advanced(
        &self,
        cover: &Cover,
        border: &FrontLine,
        side: f64,
        bounds: [f64; 4],
        (name, step): (&str, usize),
    ) -> Option<(Cover, Vec<[f64; 2]>)> {
        let surface = &self.face.surface;
        let on_border = self.ruled_torse(border, bounds)?;
        let forward = usize::from(side > 0.0);
        let mut share = 1.0;
        for _ in 0..TRIALS {
            let ahead: Option<Vec<[f64; 2]>> = on_border
                .points
                .iter()
                .zip(&on_border.ends)
                .map(|(p, e)| walked(surface, p, side * share * e[forward]))
                .collect();
            let line = FrontLine { points: ahead?, open: border.open };
            if let Some(ruled) = self.ruled_torse(&line, bounds) {
                let limit = Ahead { side: forward, share };
                if let Some(laid) = self.strip(cover, &ruled, Some(limit), name, step) {
                    if laid.labels.is_empty() {
                        return None;
                    }
                    let [back, forth] = laid.borders;
                    return Some((laid.cover, if side > 0.0 { forth } else { back }));
                }
            }
            share *= 0.8;
            if self.control.stopped() {
                break;
            }
        }
        None
    }

    /// Rulings, intervals and torse along a line.
    fn ruled_torse(&self, line: &FrontLine, bounds: [f64; 4]) -> Option<RuledTorse> {
        let surface = &self.face.surface;
        let mut points = resampled(surface, &line.points);
        if line.open {
            points = resampled(surface, &carried_on(&points, bounds));
        }
        let all = regular(surface, &points)?;
        let torse = envelope(&all.iter().map(|r| r.ruling).collect::<Vec<_>>(), SPANS, REACH)?;
        let size = surface.bbox().diagonal();
        let allowed = self.options.tolerance * DISTANCE_SHARE * INTERVALS;
        let ends = all.iter().map(|p| interval(surface, p, allowed, size)).collect();
        Some(RuledTorse { points: all, ends, torse })
    }

    /// The widest strip around the line that the certificate accepts, out of what is free.
    fn strip(&self, cover: &Cover, ruled: &RuledTorse, ahead: Option<Ahead>, name: &str, step: usize) -> Option<Laid> {
        let surface = &self.face.surface;
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let mut share = ahead.map_or(1.0, |a| a.share);
        let least = LEAST_SHARE * share;
        let centre: Vec<[f64; 2]> = ruled.points.iter().map(|p| p.uv).collect();
        for _ in 0..TRIALS {
            if self.control.stopped() {
                return None;
            }
            // A strip ahead of a border reaches back over it; what is covered there is left out by itself.
            let behind = |k: usize| ahead.filter(|a| a.side != k).map(|a| 1.3 * a.share);
            let mut borders: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                let rest = behind(k).unwrap_or(share);
                let raw: Option<Vec<[f64; 2]>> =
                    ruled.points.iter().zip(&ruled.ends).map(|(p, e)| walked(surface, p, sign * rest * e[k])).collect();
                borders[k] = smoothed(&centre, &raw?, SMOOTHING);
            }
            let polygon: Vec<[f64; 2]> = borders[0].iter().chain(borders[1].iter().rev()).copied().collect();
            let (mut trial, labels) = cover.cut_out(&polygon);
            let mut worst: f64 = 0.0;
            for &label in &labels {
                let samples = trial.region(label).dense_samples(Density::Usual);
                let Some((e, at)) = error(&ruled.torse, &samples) else {
                    worst = f64::INFINITY;
                    break;
                };
                worst = worst.max(e);
                if e <= allowed * HOPEFUL {
                    let fit = Fit { torse: ruled.torse.clone(), kind: PanelKind::Torse, error: e, worst: at };
                    match self.proven(trial.region(label), fit, samples).accepted {
                        Some(fit) => {
                            trial.panels.insert(label, fit);
                        }
                        None => worst = worst.max(allowed * 1.02),
                    }
                }
                if worst > allowed * HOPEFUL {
                    break;
                }
            }
            if worst <= allowed * HOPEFUL {
                let cut: Vec<[f64; 2]> = ruled.ends.iter().map(|e| [e[0] * share, e[1] * share]).collect();
                let estimate =
                    (1..=3).map(|m| paper_estimate(surface, &ruled.points, &cut, m)).fold(f64::INFINITY, f64::min);
                for &label in &labels {
                    let origin = Origin { curve: name.to_owned(), step, paper_estimate: estimate };
                    trial.origins.insert(label, Arc::new(origin));
                }
                return Some(Laid { cover: trial, borders, labels });
            }
            let factor = if worst.is_finite() { (0.97 * allowed / worst).sqrt().clamp(0.5, 0.97) } else { UNKNOWN };
            share *= factor;
            if share < least {
                break;
            }
        }
        None
    }
}

impl Cover {
    /// Checks curves along which panels are to run: one result for each.
    pub(super) fn checked(&self, curves: &[PanelCurve], tolerance: f64) -> Vec<Result<(), CurveError>> {
        curves
            .iter()
            .map(|c| {
                for line in self.lines_of(c, tolerance)? {
                    let points = resampled(&self.face.surface, &line);
                    envelope_along(&self.face.surface, &points)
                        .map_err(|source| CurveError::Envelope { name: c.name.clone(), source })?;
                }
                Ok(())
            })
            .collect()
    }

    /// Names the panel in which most of a curve lies after it.
    fn named(mut self, name: &str, lines: &[Vec<[f64; 2]>]) -> Self {
        let middles: Vec<Vec3> = (0..self.partition.triangles.len()).map(|t| self.middle(t)).collect();
        let mut within: BTreeMap<u32, usize> = BTreeMap::new();
        for p in lines.iter().flatten() {
            let x = self.face.surface.point(p[0], p[1]);
            let away = |t: &usize| (middles[*t] - x).norm_squared();
            let nearest = (0..middles.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.into_iter().for_each(|t| *within.entry(self.partition.labels[t]).or_default() += 1);
        }
        if let Some((label, _)) = within.into_iter().max_by_key(|w| w.1) {
            let origin = Origin { curve: name.to_owned(), step: 0, paper_estimate: f64::INFINITY };
            self.origins.insert(label, Arc::new(origin));
        }
        self
    }

    /// Cuts the inside of a polygon out of the free regions: its components.
    fn cut_out(&self, polygon: &[[f64; 2]]) -> (Self, Vec<u32>) {
        let mut trial = self.clone();
        let mut labels = Vec::new();
        for label in self.free() {
            let fresh = trial.partition.fresh_label();
            trial.cut(label, fresh, |p| inside_by(polygon, p));
            if trial.partition.labels.contains(&fresh) {
                labels.extend(trial.partition.split_components(fresh));
            }
            if trial.partition.labels.contains(&label) {
                trial.partition.split_components(label);
            }
        }
        let total: f64 = labels.iter().map(|&l| trial.region(l).area()).sum();
        let whole: f64 = (0..trial.partition.triangles.len()).map(|t| trial.triangle_area(t)).sum();
        if total <= LEAST_AREA * whole {
            labels.clear();
        }
        (trial, labels)
    }
}

/// A strip ahead of a border.
#[derive(Clone, Copy)]
struct Ahead {
    /// Index of the border that is ahead.
    side: usize,
    /// Share of the intervals by which its line lies ahead.
    share: f64,
}

/// The longest part of a line along which the envelope is regular and bends to one side.
fn regular(surface: &Surface, line: &[[f64; 2]]) -> Option<Vec<EnvelopeRuling>> {
    // Rulings that a strip has at least.
    const FEWEST: usize = 8;
    if let Ok(all) = envelope_along(surface, line) {
        if all.windows(2).all(|w| w[0].curvature * w[1].curvature > 0.0) {
            return Some(all);
        }
    }
    // Some place fails: triples of neighbours tell where.
    let each: Vec<Option<EnvelopeRuling>> =
        line.windows(3).map(|w| envelope_along(surface, w).ok().map(|p| p[1])).collect();
    let mut best: Vec<EnvelopeRuling> = Vec::new();
    let mut run: Vec<EnvelopeRuling> = Vec::new();
    for p in each.into_iter().chain([None]) {
        match p {
            Some(p) if run.last().is_none_or(|l| l.curvature * p.curvature > 0.0) => run.push(p),
            other => {
                if run.len() > best.len() {
                    best = std::mem::take(&mut run);
                }
                run = other.into_iter().collect();
            }
        }
    }
    (best.len() >= FEWEST).then_some(best)
}

/// Points equally spaced in space along a line of the parameter plane.
fn resampled(surface: &Surface, line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut lengths = vec![0.0];
    for w in line.windows(2) {
        let d = (surface.extended_jet(w[1][0], w[1][1]).p - surface.extended_jet(w[0][0], w[0][1]).p).norm();
        lengths.push(lengths[lengths.len() - 1] + d);
    }
    let total = lengths[lengths.len() - 1];
    if !(total > 0.0 && total.is_finite()) {
        return line.to_vec();
    }
    let mut k = 0;
    (0..RULINGS)
        .map(|i| {
            let s = total * i as f64 / (RULINGS - 1) as f64;
            while k + 2 < lengths.len() && lengths[k + 1] < s {
                k += 1;
            }
            let part = (s - lengths[k]) / (lengths[k + 1] - lengths[k]).max(f64::MIN_POSITIVE);
            std::array::from_fn(|d| line[k][d] + part.clamp(0.0, 1.0) * (line[k + 1][d] - line[k][d]))
        })
        .collect()
}

/// Open lines of a line: two halves of a closed one.
fn opened(line: Vec<[f64; 2]>) -> Vec<FrontLine> {
    let closed = line.len() > 6 && line.first() == line.last();
    if !closed {
        return vec![FrontLine { points: line, open: true }];
    }
    let middle = line.len() / 2;
    [line[..=middle].to_vec(), line[middle..].to_vec()].map(|points| FrontLine { points, open: false }).into()
}

/// Signed distance from the border of a polygon, positive inside.
fn inside_by(polygon: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let mut inside = false;
    let mut best = f64::INFINITY;
    for i in 0..polygon.len() {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
        let d = [b[0] - a[0], b[1] - a[1]];
        let q = [p[0] - a[0], p[1] - a[1]];
        let length = d[0] * d[0] + d[1] * d[1];
        let s = if length > 0.0 { ((q[0] * d[0] + q[1] * d[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
        best = best.min((q[0] - s * d[0]).powi(2) + (q[1] - s * d[1]).powi(2));
    }
    if inside {
        best.sqrt()
    } else {
        -best.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_tell_inside_from_outside() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        assert!((inside_by(&square, [1.0, 0.4]) - 0.4).abs() < 1e-15);
        assert!((inside_by(&square, [3.0, 0.5]) + 1.0).abs() < 1e-15);
    }

    #[test]
    fn closed_lines_become_two_halves() {
        let mut ring: Vec<[f64; 2]> =
            (0..12).map(|i| (f64::from(i) * std::f64::consts::FRAC_PI_6).sin_cos().into()).collect();
        ring.push(ring[0]);
        let halves = opened(ring);
        assert!(halves.len() == 2 && halves.iter().all(|l| !l.open));
        assert_eq!(halves[0].points.last(), halves[1].points.first());
    }
}
