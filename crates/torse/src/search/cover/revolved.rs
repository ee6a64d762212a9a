//! Faces that are parts of surfaces of revolution, covered with cones about their axis: the meridian becomes a polygon, so that
//! neighbours meet in circles and every panel in itself (docs/algorithms/cover.md, "Surfaces of revolution").

use super::band_range;
use super::covered_face::{grid_lines, Cover};
use super::job::{CoverOptions, Job};
use super::layout::LayoutKind;
use super::limits::Limits;
use super::region::{Density, Region};
use crate::brep::face::Face;
use crate::brep::meridian::Meridian;
use crate::brep::recognised_surface::bounds;
use crate::brep::rulings::Rulings;
use crate::brep::space_curve::SpaceCurve;
use crate::brep::swept::revolve;
use crate::control::Control;
use crate::fit::near::chords::{fewest_chords, Chords, Ends, Place};
use crate::fit::near::exact::{exact, ExactOptions};
use crate::fit::near::samples::{nearest_error, Fit, Sample};
use crate::geom::{Frame, Vec2, Vec3};
use crate::num::hash::HashSet;
use crate::num::parallel;
use crate::patchwork::partition::centroid;
use crate::search::apex::beside_poles;
use crate::search::trims::about_its_circles;
use std::sync::Arc;

/// Share of the tolerance within which a face must be one of revolution.
const SLACK: f64 = 0.02;
/// Share of the tolerance for which chords are laid: what ends of panels and their trims take is left.
const AIM: f64 = 0.97;
/// Places of the meridian looked at, for how dense corners may lie.
const LOOKED_AT: usize = 2000;
/// Places for corners per chord that theory asks for, at least, and at most.
const CORNERS: (f64, f64, f64) = (100.0, 300.0, 5000.0);
/// Share of the places for corners that lie evenly.
const EVEN: f64 = 0.1;
/// Distance between the ends of a meridian, as a share of its extent, up to which it is closed.
const CLOSED: f64 = 1e-9;
/// Share of the range of parameters within which a corner lies on a knot line.
const ON_KNOT: f64 = 1e-7;
/// Chords more than the fewest that are tried where a panel cannot be proven.
const MORE: usize = 2;
/// Share of the least distance that so many chords can keep which takes one more.
const LESS: f64 = 0.998;
/// Distance of a torse from its cone, as a share of the size, below which it needs no more spans.
const GOAL: f64 = 1e-10;
/// Slope of a chord against the axis's planes, below which its cone is about a plane, a ring that no ruled panel goes all round: of
/// 14 chords round a torus two are, which were cut and laid anew in 400 seconds; with 15 all panels meet in themselves.
const FLAT: f64 = 1e-3;
/// Cells between two corners along the meridian at least.
const CELLS: usize = 8;
/// Places per direction at which torses are compared with their cones.
const COMPARED: usize = 65;

/// A face of revolution covered with cones about its axis, proven; the face of the cover ends a hair before its poles, if it has
/// any. `None` where it is no such face, where strips or seams are to run in other ways, or where cones cannot be proven.
pub(in crate::search) fn revolved(
    face: &Face,
    options: &CoverOptions,
    between: &HashSet<(u32, u64)>,
    control: &Control,
) -> Option<Cover> {
    let layout = &options.layout;
    let no_seams = layout.seams.is_empty() && layout.seam_curves.is_empty();
    let is_free = layout.curves.is_empty() && no_seams && layout.guide.is_none();
    if options.facets || !is_free || layout.kind == LayoutKind::Strips {
        return None;
    }
    if let Some(turned) = about_its_circles(face, options.tolerance) {
        // As it is it has no pole, and panels without a slit.
        let most = promised(face, options.tolerance)?.checked_sub(1)?;
        let tolerance = options.tolerance + face.trim_bound() - turned.trim_bound();
        return about_axis(&turned, &CoverOptions { tolerance, ..options.clone() }, Some(most), between, control);
    }
    about_axis(face, options, None, between, control)
}

/// The meridian of a face of revolution, as far as a tolerance (mm) sees it.
pub(in crate::search) fn meridian(face: &Face, tolerance: f64) -> Option<Meridian<'_>> {
    Meridian::of(&face.surface, bounds(face), SLACK * tolerance)
}

/// Whether a face goes all round an axis, as far as a tolerance (mm) sees it: cones about the axis cover it.
pub(crate) fn is_all_round(face: &Face, tolerance: f64) -> bool {
    meridian(face, tolerance).is_some_and(|m| m.is_whole())
}

/// Number of panels that theory promises; `None` where it promises nothing.
fn promised(face: &Face, tolerance: f64) -> Option<usize> {
    band_range(face).map(|range| (range / (4.0 * tolerance.sqrt())).ceil() as usize)
}

/// See [`revolved`], with at most so many cones. Without that, all round the axis it takes as many as it takes; round a part of it
/// strips may run in other ways, and be fewer, or lie better on sheets.
fn about_axis(
    face: &Face,
    options: &CoverOptions,
    most: Option<usize>,
    between: &HashSet<(u32, u64)>,
    control: &Control,
) -> Option<Cover> {
    let meridian = meridian(face, options.tolerance)?;
    let most = match most {
        Some(most) => most,
        None if meridian.is_whole() => usize::MAX,
        None if options.limits == Limits::default() => promised(face, options.tolerance)?,
        None => return None,
    };
    let ended = beside_poles(face, &meridian, options.tolerance).unwrap_or_else(|| face.clone());
    let tolerance = options.tolerance + face.trim_bound() - ended.trim_bound();
    let options = CoverOptions { tolerance, max_panels: options.max_panels.min(most), ..options.clone() };
    let job = Job::new(&ended, &options, control);
    let mut allowed = AIM * tolerance;
    let ends = Ends { held: rims_between(face, &meridian, between), rims: meridian.ends_on_axis().map(|pole| !pole) };
    let mut fewest = usize::MAX;
    loop {
        let (corners, chords) = corners(&meridian, ends, allowed)?;
        fewest = fewest.min(chords.count());
        if chords.count() > (fewest + MORE).min(options.max_panels) || control.stopped() {
            return None;
        }
        if let Some(cover) = job.cones(&meridian, &corners, &chords).filter(|_| !control.stopped()) {
            return Some(cover);
        }
        // What so many chords cannot be near enough for takes one more.
        allowed = LESS * chords.distance;
    }
}

/// Which ends of the meridian are edges between faces.
fn rims_between(face: &Face, meridian: &Meridian, between: &HashSet<(u32, u64)>) -> [bool; 2] {
    let Some(boundary) = &face.boundary else { return [false; 2] };
    let edges = boundary.loops.iter().flatten().filter(|e| between.contains(&(face.body, e.entity)));
    let labels: HashSet<u32> = edges.map(|e| e.label).collect();
    let along = meridian.along();
    let mut out = [false; 2];
    for l in &face.loops {
        for i in (0..l.edge.len()).filter(|&i| labels.contains(&l.edge[i])) {
            let (p, q) = (l.points[i][along], l.points[(i + 1) % l.points.len()][along]);
            for (rim, end) in out.iter_mut().zip([meridian.range.0, meridian.range.1]) {
                *rim |= p == end && q == end;
            }
        }
    }
    out
}

/// The fewest chords of a meridian, and the parameters of their corners.
fn corners(meridian: &Meridian, ends: Ends, distance: f64) -> Option<(Vec<f64>, Chords)> {
    let bends = Bends::of(meridian, distance);
    let count = (CORNERS.0 * bends.theory).clamp(CORNERS.1, CORNERS.2) as usize;
    let parameters = bends.parameters(count);
    let chords = fewest_chords(&places(meridian, &parameters)?, ends, distance)?;
    // Where it bends evenly, chords of one length have their corners among these.
    let even = bends.parameters(CORNERS.0 as usize * chords.count());
    let better = fewest_chords(&places(meridian, &even)?, ends, distance);
    let better = better.filter(|b| (b.count(), b.distance) < (chords.count(), chords.distance));
    let (parameters, chords) = better.map_or((parameters, chords), |better| (even, better));
    Some((chords.corners.iter().map(|c| parameters[c.0]).collect(), chords))
}

/// How a meridian bends.
struct Bends {
    range: (f64, f64),
    /// Chords that theory asks for, ∫ √κ ds / (4 √ε).
    theory: f64,
    /// What comes of it up to each of many places, and a little more that is even.
    sum: Vec<f64>,
}

impl Bends {
    fn of(meridian: &Meridian, distance: f64) -> Self {
        let (lo, hi) = meridian.range;
        let jets: Vec<[Vec2; 2]> =
            (0..=LOOKED_AT).map(|k| meridian.jet(lo + (hi - lo) * k as f64 / LOOKED_AT as f64)).collect();
        let step = |w: &[[Vec2; 2]]| (w[1][0] - w[0][0]).norm();
        let length: f64 = jets.windows(2).map(step).sum();
        let needed = |w: &[[Vec2; 2]]| (w[0][1].angle(&w[1][1]) * step(w) / distance).sqrt() / 4.0;
        let theory: f64 = jets.windows(2).map(needed).sum();
        let mut sum = vec![0.0];
        for w in jets.windows(2) {
            sum.push(sum[sum.len() - 1] + needed(w) + EVEN * theory.max(1.0) * step(w) / length);
        }
        Self { range: (lo, hi), theory, sum }
    }

    /// Parameters of places so that from each to the next as much comes.
    fn parameters(&self, count: usize) -> Vec<f64> {
        let ((lo, hi), whole) = (self.range, self.sum[LOOKED_AT]);
        let parameter = |k: usize| {
            if k == count {
                return hi;
            }
            let wanted = whole * k as f64 / count as f64;
            let i = self.sum.partition_point(|x| *x < wanted).clamp(1, LOOKED_AT);
            let share = ((wanted - self.sum[i - 1]) / (self.sum[i] - self.sum[i - 1])).clamp(0.0, 1.0);
            lo + (hi - lo) * ((i - 1) as f64 + share) / LOOKED_AT as f64
        };
        (0..=count).map(parameter).collect()
    }
}

/// Places of a meridian where corners may be.
fn places(meridian: &Meridian, parameters: &[f64]) -> Option<Vec<Place>> {
    let (on_axis, last) = (meridian.ends_on_axis(), parameters.len() - 1);
    let place = |(k, t): (usize, &f64)| {
        let [point, d] = meridian.jet(*t);
        let is_pole = (k == 0 && on_axis[0]) || (k == last && on_axis[1]);
        if is_pole {
            return Some(Place { point: Vec2::new(0.0, point.y), normal: Vec2::y() });
        }
        Some(Place { point, normal: Vec2::new(-d.y, d.x).try_normalize(0.0)? })
    };
    let mut places = parameters.iter().enumerate().map(place).collect::<Option<Vec<Place>>>()?;
    let extent = places.iter().map(|p| (p.point - places[0].point).norm()).fold(0.0, f64::max);
    if (places[0].point - places[last].point).norm() <= CLOSED * extent {
        places[last] = places[0];
    }
    Some(places)
}

impl Job<'_> {
    /// The face parted along circles at parameters of its meridian, with a cone over the chord between two of these, all of them proven.
    fn cones(&self, meridian: &Meridian, corners: &[f64], chords: &Chords) -> Option<Cover> {
        let (face, along) = (self.face, meridian.along());
        // The face ends a hair before poles; corners on knot lines miss them by rounding.
        let (bounds, knots) = (bounds(face), [&face.surface.knots_u, &face.surface.knots_v][along].breaks());
        let (lo, hi) = (bounds[2 * along], bounds[2 * along + 1]);
        let place = |t: &f64| {
            let t = t.clamp(lo, hi);
            knots.iter().copied().find(|k| (k - t).abs() <= ON_KNOT * (hi - lo)).unwrap_or(t)
        };
        let ends: Vec<f64> = corners.iter().map(place).collect();
        let mut cover = parted(face, meridian, &ends)?;
        let cones: Vec<(Fit, Vec<u32>)> = chords
            .corners
            .windows(2)
            .zip(ends.windows(2))
            .map(|(c, t)| Some((cone(meridian, [c[0].1, c[1].1])?, cover.ring(meridian, [t[0], t[1]]))))
            .collect::<Option<_>>()?;
        let regions: Vec<(u32, &Fit)> =
            cones.iter().flat_map(|(fit, labels)| labels.iter().map(move |l| (*l, fit))).collect();
        let proven: Vec<(u32, Arc<Fit>)> =
            parallel::map(regions.iter(), |(l, fit)| Some((*l, self.proven_cone(cover.region(*l), fit)?)))
                .into_iter()
                .collect::<Option<_>>()?;
        if proven.len() > self.options.max_panels {
            return None;
        }
        cover.panels.extend(proven);
        cover.is_complete().then_some(cover)
    }

    /// The fit of a region, if it is proven and keeps to the limits.
    fn proven_cone(&self, region: Region, fit: &Fit) -> Option<Arc<Fit>> {
        let samples = region.dense_samples(Density::Usual);
        let (error, worst) = nearest_error(&fit.torse, &samples)?;
        self.keeps(region, &fit.torse, 0.0).then(|| Arc::new(Fit { error, worst, ..fit.clone() }))
    }
}

/// The face triangulated, with lines along the circles at the given parameters of its meridian, and parted there. Towards poles cells
/// become smaller as the circles do: feet turn there as fast as the place goes round.
fn parted(face: &Face, meridian: &Meridian, ends: &[f64]) -> Option<Cover> {
    let [u, v] = grid_lines(&face.surface, bounds(face), f64::INFINITY).into();
    let [mut along, around] = meridian.lines(u, v);
    let (poles, last) = (meridian.ends_on_axis(), ends.len() - 2);
    for (k, w) in ends.windows(2).enumerate() {
        let beside = ON_KNOT * (w[1] - w[0]);
        along.retain(|t| *t <= w[0] - beside || *t >= w[1] + beside);
        let even = (1..CELLS).map(|k| k as f64 / CELLS as f64);
        along.extend(even.map(|share| w[0] + (w[1] - w[0]) * share));
        for (is_pole, pole, circle) in [(poles[0] && k == 0, w[0], w[1]), (poles[1] && k == last, w[1], w[0])] {
            if is_pole {
                let least = meridian.jet(pole)[0].x / meridian.jet(circle)[0].x;
                let shares = std::iter::successors(Some(0.5 / CELLS as f64), |s| Some(0.5 * s));
                along.extend(shares.take_while(|s| *s > least).map(|share| pole + (circle - pole) * share));
            }
        }
    }
    // Knot lines are lines anyhow.
    let knots = [&face.surface.knots_u, &face.surface.knots_v][meridian.along()].breaks();
    let beside = ON_KNOT * (ends[ends.len() - 1] - ends[0]);
    along.retain(|t| knots.iter().all(|k| (k - t).abs() > beside));
    along.extend_from_slice(ends);
    along.sort_by(f64::total_cmp);
    along.dedup();
    let [u, v] = meridian.lines(along, around);
    let mut cover = Cover::on_lines(face, u, v).ok()?;
    for (k, w) in ends.windows(2).enumerate() {
        let partition = &mut cover.partition;
        for t in 0..partition.triangles.len() {
            let place = centroid(partition.corners(t))[meridian.along()];
            if (w[0]..=w[1]).contains(&place) {
                partition.labels[t] = k as u32;
            }
        }
    }
    for label in cover.partition.distinct_labels() {
        cover.partition.split_components(label);
    }
    Some(cover)
}

impl Cover {
    /// Labels between two parameters of the meridian.
    fn ring(&self, meridian: &Meridian, [from, to]: [f64; 2]) -> Vec<u32> {
        let inside = |region: &Region| {
            let t = region.cells()[0];
            (from..=to).contains(&centroid(self.partition.corners(t))[meridian.along()])
        };
        self.regions().filter(inside).map(|r| r.label).collect()
    }
}

/// The torse of the cone over a chord of the meridian, as far round as the part goes.
fn cone(meridian: &Meridian, [p, q]: [Vec2; 2]) -> Option<Fit> {
    if (q - p).y.abs() <= FLAT * (q - p).norm() {
        return None;
    }
    let frame = &meridian.frame;
    let [from, to] = [p, q].map(|c| frame.to_world(&Vec3::new(c.x, 0.0, c.y)));
    let line = SpaceCurve::Line { origin: from, direction: to - from };
    // What is turned the other way is so about the axis upside down.
    let frame = if meridian.turn > 0.0 { *frame } else { Frame { y: -frame.y, z: -frame.z, ..*frame } };
    let surface = revolve(&line, &frame, (0.0, meridian.turn.abs()), (0.0, 1.0)).ok()?.0;
    let ((u0, u1), (v0, v1)) = surface.domain();
    let size = surface.bbox().diagonal();
    let rulings = Rulings::of(&surface, [u0, u1, v0, v1], GOAL.sqrt() * size)?;
    let at = |k: usize, (lo, hi): (f64, f64)| lo + (hi - lo) * k as f64 / (COMPARED - 1) as f64;
    let samples: Vec<Sample> = (0..COMPARED * COMPARED)
        .filter_map(|k| {
            let j = surface.jet(at(k / COMPARED, (u0, u1)), at(k % COMPARED, (v0, v1)));
            Some(Sample { x: j.p, n: j.normal().try_normalize(0.0)?, weight: 1.0 })
        })
        .collect();
    exact(&rulings, &samples, &ExactOptions { goal: GOAL * size, accepted: GOAL.sqrt() * size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::recognised_surface::frame;
    use std::f64::consts::{FRAC_PI_2, TAU};

    /// Part of a sphere of radius 100 mm between two latitudes and over an angle (rad).
    fn zone(latitudes: (f64, f64), turn: f64) -> Face {
        let axis = frame(Vec3::new(5.0, -3.0, 20.0), Vec3::new(2.0, -1.0, 2.0).normalize());
        let circle = SpaceCurve::Ellipse { frame: Frame { y: axis.z, z: -axis.y, ..axis }, a: 100.0, b: 100.0 };
        Face::untrimmed(revolve(&circle, &axis, (0.0, turn), latitudes).expect("a surface").0)
    }

    fn cones(face: &Face, tolerance: f64) -> Option<Cover> {
        revolved(face, &CoverOptions::new(tolerance), &HashSet::default(), &Control::default())
    }

    #[test]
    fn faces_that_go_all_round_become_cones() {
        // Zones between 0.6 rad on both sides of the equator: 120 mm, and cones within 1 mm are 4 √100 = 40 mm wide.
        let face = zone((-0.6, 0.6), TAU);
        let cover = cones(&face, 1.05).expect("cones");
        assert!(
            cover.is_complete() && cover.panels.len() == 3 && cover.face.trim_bound() <= 0.0,
            "{}",
            cover.panels.len()
        );
        for fit in cover.panels.values() {
            assert!(fit.error < 1.05 && fit.error > 0.7, "{}", fit.error);
        }
    }

    #[test]
    fn poles_lie_under_the_tip_of_a_cone() {
        let face = zone((0.9, FRAC_PI_2), TAU);
        let cover = cones(&face, 2.0).expect("cones");
        let bound = cover.face.trim_bound();
        // A cap 67 mm from rim to pole; what ends beside the pole counts.
        assert!(cover.is_complete() && cover.panels.len() <= 2, "{}", cover.panels.len());
        assert!(bound > 0.0 && bound < 0.05, "{bound}");
    }

    #[test]
    fn no_cone_is_a_flat_ring() {
        // Six chords round a circle of radius 50 mm keep within 50 tan² 15° = 3.59 mm of it, but two would be square to the axis; seven
        // keep within 2.61 mm.
        let axis = frame(Vec3::zeros(), Vec3::z());
        let centre = Frame { origin: axis.x * 150.0, y: axis.z, z: -axis.y, ..axis };
        let circle = SpaceCurve::Ellipse { frame: centre, a: 50.0, b: 50.0 };
        let face = Face::untrimmed(revolve(&circle, &axis, (0.0, TAU), (0.0, TAU)).expect("a surface").0);
        let cover = cones(&face, 3.8).expect("cones");
        assert!(cover.is_complete() && cover.panels.len() == 7, "{}", cover.panels.len());
        assert!(cover.panels.values().all(|fit| fit.error < 2.7));
    }

    #[test]
    fn faces_round_a_part_of_the_axis_are_left_to_fewer_strips() {
        // Far less round than high: strips that run up it are fewer.
        assert!(cones(&zone((-0.8, 0.8), 0.3), 1.05).is_none());
        let face = zone((-0.15, 0.15), 6.0);
        assert!(cones(&face, 1.05).is_some_and(|cover| cover.is_complete()));
        let mut options = CoverOptions::new(1.05);
        options.limits.max_length = Some(300.0);
        assert!(revolved(&face, &options, &HashSet::default(), &Control::default()).is_none());
    }

    #[test]
    fn strips_that_are_asked_for_stay_strips() {
        let mut options = CoverOptions::new(1.05);
        options.layout.kind = LayoutKind::Strips;
        assert!(revolved(&zone((-0.6, 0.6), TAU), &options, &HashSet::default(), &Control::default()).is_none());
    }
}
