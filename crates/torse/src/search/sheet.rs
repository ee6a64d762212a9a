//! Panels that fit the sheets of a shop.
//!
//! *Method.* Panels that are too large are cut: each for itself into equal parts, or all together along common planes
//! across the face, so that joints line up; or the face is cut along such planes first and each section is covered for
//! itself, where strips may run another way. The fewest panels that all fit win. Faces that are developable already are
//! cut along their parameter lines, equally far apart on the flat pattern; cones about the axis of a face of revolution
//! into equal sectors. Pieces of a good panel are good panels: only the cuts are new, and the judge sees all of them again.
//! Where panels are to meet they do before they are cut ([`parted`]), and their parts do too.
//!
//! *Not guaranteed*: the fewest panels that could be; where no way fits, the one that misses the sheet with the fewest
//! panels.

use super::build::{build_on, too_large, Built, Joined};
use super::cover::{cover, exact_regions, exactly, is_developable, meridian, Cover, CoverOptions, SeamPlane};
use super::laid::{Laid, Task};
use super::stitch::parts::Wholes;
use crate::brep::meridian::Meridian;
use crate::brep::recognised_surface::bounds;
use crate::certify;
use crate::geom::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Rounds of cutting panels that are still too large, at most: some no cut makes fit.
const ROUNDS: usize = 8;
/// Numbers of sections that are tried beyond the least: strips are longer than the face is, where they run askew.
const MORE_SECTIONS: usize = 1;
/// Sections of one face, at most.
const MOST_SECTIONS: usize = 64;
/// Cosine of the angle within which an axis of the model is taken for the direction across which sections run: about 15°.
const NEAR_AXIS: f64 = 0.966;

/// Panels that fit.
pub(super) struct Fitted {
    pub laid: Laid,
    /// Covers in panels of which these are parts, or could be: theirs first, each with planes that part it. None where panels are
    /// no parts, or meet anyhow.
    pub wholes: Vec<(Laid, Vec<SeamPlane>)>,
}

impl Fitted {
    fn of(task: &Task, whole: Laid) -> Self {
        Self { laid: cut_until_it_fits(task, whole.clone()), wholes: vec![(whole, Vec::new())] }
    }
}

/// Panels that fit, of a cover some of whose panels do not.
pub(super) fn fitted(task: &Task, laid: Laid) -> Fitted {
    if is_developable(task.face, task.options.tolerance) {
        let laid = gridded(task).unwrap_or_else(|| cut_until_it_fits(task, laid));
        return Fitted { laid, wholes: Vec::new() };
    }
    if let Some(laid) = petals(task, &laid) {
        return Fitted { laid, wholes: Vec::new() };
    }
    let planes = sections(task, &laid);
    let lined_up = planes.iter().find_map(|planes| {
        let surface = &task.face.surface;
        let heights: Vec<_> = planes.iter().map(|p| |uv: [f64; 2]| p.height(&surface.point(uv[0], uv[1]))).collect();
        let cut = task.laid(laid.cover.cut_where(&heights), planes.clone());
        let cut = cut_until_it_fits(task, cut);
        fits(task, &cut).then_some(cut)
    });
    let mut best = Fitted::of(task, laid);
    // Joints in line are worth as many panels.
    if let Some(next) = lined_up {
        if rank(task, &next) <= rank(task, &best.laid) {
            best.wholes.iter_mut().for_each(|w| w.1.clone_from(&next.seams));
            best.laid = next;
        }
    }
    for seams in planes {
        let count = best.laid.built.patchwork.panels.len();
        if task.control.stopped() || (fits(task, &best.laid) && count <= seams.len() + 1) {
            break;
        }
        let options = CoverOptions { max_panels: task.options.max_panels.min(count), ..task.options_with(&seams) };
        let Ok(found) = cover(task.face, &options, task.control) else { break };
        if found.is_complete() {
            let whole = task.laid(found, seams);
            // Parts will be as many at least.
            if fits(task, &best.laid) && least_parts(task, &whole) >= count {
                continue;
            }
            let mut next = Fitted::of(task, whole);
            if rank(task, &next.laid) < rank(task, &best.laid) {
                next.wholes.extend(best.wholes.pop());
                best = next;
            }
        }
    }
    best
}

/// Panels that meet, cut along planes and then each for itself until they fit, as parts that meet where the panels do. `cover` has
/// their torses. `None` where parts do not fit, or cannot be proven.
pub(super) fn parted(task: &Task, (cover, built): (&Cover, &Built), planes: &[SeamPlane]) -> Option<(Cover, Built)> {
    let mut parts = cover.clone();
    for plane in planes {
        for label in parts.partition.distinct_labels() {
            let height = |[u, v]: [f64; 2]| plane.height(&task.face.surface.point(u, v));
            let heights: Vec<f64> = parts.region(label).points().iter().map(|x| plane.height(x)).collect();
            // Panels that end at a plane are not cut.
            let crosses = [1.0, -1.0].iter().all(|side| heights.iter().any(|h| side * h > task.whole));
            if let Some((cut, _)) = crosses.then(|| parts.cut_by(label, height)).flatten() {
                parts = cut;
            }
        }
    }
    let mut counts = Counts::of(&parts);
    parts = counts.base.clone();
    let known = certify::known_of(&built.certificate, &built.patchwork);
    let wholes = Wholes { cover, panels: &built.patchwork };
    if parts.panels.len() == cover.panels.len() {
        let large = too_large(built, &task.options.limits);
        if large.is_empty() {
            return Some((parts, built.clone()));
        }
        parts = counts.more(&parts, &large)?;
    }
    for _ in 0..ROUNDS {
        parts = wholes.in_parts(&parts).settled();
        parts = parts.with_smooth_borders(task.whole, |labels| wholes.in_parts(&parts).is_cut(labels));
        let joined = Joined { edges: &wholes.in_parts(&parts).edges(), known: &known };
        let (next, refused) = build_on(task.index, &parts, (task.whole, task.control), joined);
        if !refused.is_empty() || task.control.stopped() || next.patchwork.panels.len() > task.options.max_panels {
            return None;
        }
        let large = too_large(&next, &task.options.limits);
        if large.is_empty() {
            return Some((parts, next));
        }
        parts = counts.more(&parts, &large)?;
    }
    None
}

/// Into how many parts regions are cut.
struct Counts {
    base: Cover,
    /// Along and across, by region.
    counts: BTreeMap<u32, [usize; 2]>,
}

impl Counts {
    /// Regions in one part.
    fn of(base: &Cover) -> Self {
        // Parts are told by the fit that they share with their region, those that planes have cut too.
        let mut base = base.clone();
        base.panels.values_mut().for_each(|fit| *fit = Arc::new((**fit).clone()));
        Self { base, counts: BTreeMap::new() }
    }

    fn whole_of(&self, parts: &Cover, part: u32) -> Option<u32> {
        let fit = parts.region(part).fit()?;
        self.base.panels.iter().find(|(_, f)| Arc::ptr_eq(f, fit)).map(|(whole, _)| *whole)
    }

    /// The regions in equal parts, more of those whose parts are too large; `None` where such a part is of no region.
    fn more(&mut self, parts: &Cover, large: &[(u32, [usize; 2])]) -> Option<Cover> {
        let mut wanted: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
        for (part, parts_of) in large {
            let most = wanted.entry(self.whole_of(parts, *part)?).or_insert([1, 1]);
            *most = [0, 1].map(|k: usize| most[k].max(parts_of[k]));
        }
        for (whole, wanted) in wanted {
            let count = self.counts.entry(whole).or_insert([1, 1]);
            let k = usize::from(wanted[0] < 2);
            count[k] = if count[k] == 1 { wanted[k] } else { count[k] + 1 };
        }
        let along: Vec<(u32, [usize; 2])> =
            self.counts.iter().map(|(l, n)| (*l, [n[0], 1])).filter(|c| c.1[0] > 1).collect();
        let cut = self.base.cut_large(&along);
        let across = |part: &u32| Some((*part, [1, self.counts.get(&self.whole_of(&cut, *part)?)?[1]]));
        let across: Vec<(u32, [usize; 2])> = cut.panels.keys().filter_map(across).filter(|c| c.1[1] > 1).collect();
        Some(cut.cut_large(&across))
    }
}

/// A developable face cut along parameter lines, in the fewest fields that fit; `None` if none do.
fn gridded(task: &Task) -> Option<Laid> {
    let limits = &task.options.limits;
    let lines = [ParameterLine::measured(task, 0), ParameterLine::measured(task, 1)];
    let mut counts: Vec<[usize; 2]> = Vec::new();
    for sides in [[limits.longest(), limits.widest()], [limits.widest(), limits.longest()]] {
        let least = |k: usize| sides[k].map_or(1.0, |limit| (lines[k].length() / limit).ceil().max(1.0));
        let [a, b] = [least(0), least(1)];
        if a * b <= (MOST_SECTIONS * MOST_SECTIONS) as f64 {
            let [a, b] = [a as usize, b as usize];
            counts.extend((0..=MORE_SECTIONS).flat_map(|k| (0..=MORE_SECTIONS).map(move |m| [a + k, b + m])));
        }
    }
    counts.sort_by_key(|c| (c[0] * c[1], *c));
    counts.dedup();
    counts.into_iter().filter(|c| c[0] * c[1] <= task.options.max_panels).find_map(|counts| {
        if task.control.stopped() {
            return None;
        }
        let wanted = [0, 1]
            .map(|k: usize| -> Vec<f64> { (1..counts[k]).map(|i| lines[k].at(i as f64 / counts[k] as f64)).collect() });
        // Cuts run along lines of the triangulation: beside them they would leave triangles that are too thin to be judged.
        let cover = exact_regions(task.face, &task.options, [&wanted[0], &wanted[1]])?;
        let drawn = [0, 1].map(|k| drawn_lines(cover.partition.vertices.iter().map(|v| v[k])));
        let places = (0..2).flat_map(|k| wanted[k].iter().map(move |at| (k, *at)));
        let places: Vec<(usize, f64)> = places.map(|(k, at)| (k, nearest(&drawn[k], at))).collect();
        let heights: Vec<_> = places.iter().map(|&(k, at)| move |uv: [f64; 2]| uv[k] - at).collect();
        let cut = exactly(cover.cut_where(&heights), &task.options, task.control)?;
        let cut = task.laid(cut, Vec::new());
        fits(task, &cut).then_some(cut)
    })
}

/// Cones and cylinders that go all round an axis, each cut along rulings into as few equal sectors as fit; `None` for other covers,
/// and where none fit or some cannot be proven.
fn petals(task: &Task, laid: &Laid) -> Option<Laid> {
    let limits = &task.options.limits;
    let meridian = meridian(task.face, task.options.tolerance).filter(Meridian::is_whole)?;
    let (around, bounds) = (1 - meridian.along(), bounds(task.face));
    let goes_round = |ring: &u32| {
        let places: Vec<f64> = laid.cover.region(*ring).places().into_iter().map(|p| p[around]).collect();
        [bounds[2 * around], bounds[2 * around + 1]].iter().all(|end| places.contains(end))
    };
    // Sectors are as wide along their rulings as rings.
    let too_wide = limits.max_width.is_some_and(|most| laid.built.patterns.iter().any(|p| p.strip_width() > most));
    if too_wide || !laid.cover.panels.keys().all(goes_round) {
        return None;
    }
    let drawn = drawn_lines(laid.cover.partition.vertices.iter().map(|v| v[around]));
    let mut counts: BTreeMap<u32, usize> = laid.cover.panels.keys().map(|ring| (*ring, 1)).collect();
    let mut large: Vec<(u32, usize)> =
        too_large(&laid.built, limits).into_iter().map(|(ring, parts)| (ring, parts[0].max(parts[1]))).collect();
    for _ in 0..ROUNDS {
        for (ring, least) in large {
            counts.insert(ring, least.max(counts.get(&ring)? + 1));
        }
        if counts.values().sum::<usize>() > task.options.max_panels || task.control.stopped() {
            return None;
        }
        let (mut cover, mut rings) = (laid.cover.clone(), BTreeMap::new());
        for (&ring, &count) in &counts {
            let mut petals = vec![ring];
            for k in 1..count {
                let at = nearest(&drawn, meridian.around(k as f64 / count as f64));
                for petal in petals.clone() {
                    if let Some((cut, parts)) = cover.cut_by(petal, |uv| uv[around] - at) {
                        petals.retain(|p| *p != petal);
                        petals.extend(parts);
                        cover = cut;
                    }
                }
            }
            rings.extend(petals.into_iter().map(|petal| (petal, ring)));
        }
        let next = task.laid(cover, laid.seams.clone());
        if !next.accepted {
            return None;
        }
        let of_rings: BTreeSet<u32> =
            too_large(&next.built, limits).iter().map(|l| rings.get(&l.0).copied()).collect::<Option<_>>()?;
        if of_rings.is_empty() {
            return Some(next);
        }
        large = of_rings.into_iter().map(|ring| (ring, 1)).collect();
    }
    None
}

/// Vertices with the same parameter that make a line of the triangulation.
const LINE_OF: usize = 3;

/// Parameters of the lines of a triangulation, increasing, from one parameter of its vertices.
fn drawn_lines(parameters: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = parameters.collect();
    all.sort_by(f64::total_cmp);
    all.chunk_by(|a, b| a == b).filter(|c| c.len() >= LINE_OF).map(|c| c[0]).collect()
}

/// The line nearest to a place; the place itself where there is none.
fn nearest(lines: &[f64], at: f64) -> f64 {
    lines.iter().copied().min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs())).unwrap_or(at)
}

/// The longest of some parameter lines of one direction over the trim, as a polyline.
struct ParameterLine {
    /// Parameter and length up to there, mm.
    points: Vec<[f64; 2]>,
}

/// Parameter lines that are measured, and their pieces.
const LINES: [usize; 2] = [9, 200];

impl ParameterLine {
    fn measured(task: &Task, direction: usize) -> Self {
        let surface = &task.face.surface;
        let mut b = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in task.face.loops.iter().flat_map(|l| &l.points) {
            for (b, x) in b.iter_mut().zip(p) {
                *b = [b[0].min(*x), b[1].max(*x)];
            }
        }
        let at = |b: [f64; 2], k: usize, n: usize| b[0] + (b[1] - b[0]) * k as f64 / n as f64;
        let line = |across: f64| {
            let mut points: Vec<[f64; 2]> = Vec::with_capacity(LINES[1] + 1);
            let mut before = None;
            for k in 0..=LINES[1] {
                let t = at(b[direction], k, LINES[1]);
                let [u, v] = if direction == 0 { [t, across] } else { [across, t] };
                let x: Vec3 = surface.point(u, v);
                let length = points.last().map_or(0.0, |p| p[1]) + before.map_or(0.0, |y: Vec3| (x - y).norm());
                points.push([t, length]);
                before = Some(x);
            }
            Self { points }
        };
        let lines = (0..=LINES[0]).map(|k| line(at(b[1 - direction], k, LINES[0])));
        lines.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(Self { points: vec![[0.0; 2]] })
    }

    fn length(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p[1])
    }

    /// Parameter at a share of the length.
    fn at(&self, share: f64) -> f64 {
        let wanted = share * self.length();
        let k = self.points.partition_point(|p| p[1] < wanted).clamp(1, self.points.len() - 1);
        let ([t, l], [s, m]) = (self.points[k - 1], self.points[k]);
        t + (s - t) * if m > l { (wanted - l) / (m - l) } else { 0.0 }
    }
}

/// Panels, and into how many parts each must be cut, as far as their sizes tell.
fn least_parts(task: &Task, laid: &Laid) -> usize {
    let more = too_large(&laid.built, &task.options.limits).into_iter().map(|l| l.1[0] * l.1[1] - 1);
    laid.built.patchwork.panels.len() + more.sum::<usize>()
}

fn fits(task: &Task, laid: &Laid) -> bool {
    laid.accepted && too_large(&laid.built, &task.options.limits).is_empty()
}

/// What is wrong with panels, the worst first: whether they were refused, how many do not fit, how many there are.
fn rank(task: &Task, laid: &Laid) -> (bool, usize, usize) {
    (!laid.accepted, too_large(&laid.built, &task.options.limits).len(), laid.built.patchwork.panels.len())
}

/// Cuts panels that are too large, each into equal parts.
fn cut_until_it_fits(task: &Task, mut laid: Laid) -> Laid {
    let mut counts = Counts::of(&laid.cover);
    laid.cover = counts.base.clone();
    for _ in 0..ROUNDS {
        let large = too_large(&laid.built, &task.options.limits);
        let more: usize = large.iter().map(|l| l.1.iter().max().map_or(0, |m| m - 1)).sum();
        let panels = laid.built.patchwork.panels.len() + more;
        if large.is_empty() || !laid.accepted || task.control.stopped() || panels > task.options.max_panels {
            break;
        }
        // Parts that were refused, and have torses of their own now, are cut each for itself.
        let cut = counts.more(&laid.cover, &large).unwrap_or_else(|| laid.cover.cut_large(&large));
        laid = task.laid(cut, laid.seams);
    }
    laid
}

/// Planes that cut the face into equal sections: across its length where panels are too long, along it where they are
/// too wide. The fewest sections first.
fn sections(task: &Task, laid: &Laid) -> Vec<Vec<SeamPlane>> {
    let limits = &task.options.limits;
    let large = too_large(&laid.built, limits);
    let axes = laid.cover.axes();
    let mut out = Vec::new();
    for (k, limit) in [limits.longest(), limits.widest()].into_iter().enumerate() {
        let normal = near_axis(axes[k]);
        let reach = laid.cover.reach(&normal);
        let Some(limit) = limit.filter(|_| large.iter().any(|l| l.1[k] > 1)) else { continue };
        let least = ((reach[1] - reach[0]) / limit).ceil();
        if least.is_nan() || least > MOST_SECTIONS as f64 {
            continue;
        }
        let least = (least as usize).max(2);
        out.extend((least..=least + MORE_SECTIONS).map(|n| planes(normal, reach, n)));
    }
    out.sort_by_key(Vec::len);
    out
}

/// An axis, or the axis of the model that is near to it, towards its positive end.
fn near_axis(axis: Vec3) -> Vec3 {
    match axis.iamax() {
        k if axis[k].abs() > NEAR_AXIS => Vec3::ith(k, 1.0),
        _ => axis,
    }
}

/// Planes between equal sections.
fn planes(normal: Vec3, reach: [f64; 2], sections: usize) -> Vec<SeamPlane> {
    let at = |k: usize| reach[0] + (reach[1] - reach[0]) * k as f64 / sections as f64;
    (1..sections).map(|k| SeamPlane { normal, offset: at(k) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_equal_and_square_to_a_near_axis_of_the_model() {
        assert_eq!(near_axis(Vec3::new(-1.0, 0.1, 0.0).normalize()), Vec3::x());
        let found = planes(-Vec3::x(), [-30.0, 30.0], 3);
        assert_eq!(found.iter().map(|p| p.offset).collect::<Vec<_>>(), [-10.0, 10.0]);
        let skew = Vec3::new(1.0, 1.0, 0.0).normalize();
        assert_eq!(near_axis(skew), skew);
    }
}
