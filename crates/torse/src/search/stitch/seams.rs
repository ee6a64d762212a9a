//! Strips that meet: after a face is covered, its bands are laid anew between common seam curves.
//!
//! Order of the work: which bands follow each other along one level function, base lines and first offsets of the
//! seams between them ([`fit::seams`](crate::fit::seams)), all strips together, and the stretches of border that both
//! sides share. Nothing is judged here: `meet` keeps a new strip only if it is certified.

use super::relevel::Row;
use crate::brep::face::Face;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::fit::seams::{base_line, network, BaseLine, BasePoint, Laid, NetworkOptions, Seam, StripBetween};
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::search::cover::{Density, State};
use crate::spline::curve::Curve;
use crate::spline::field::Field;
use crate::spline::knots::Knots;
use crate::torse::form::Torse;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Strips rebuilt from seams, and the edges that they share.
#[derive(Default)]
pub(crate) struct Meeting {
    /// New torse of a label.
    pub torses: BTreeMap<u32, Torse>,
    /// Torses that are not good enough, but something to start from.
    pub drafts: BTreeMap<u32, Torse>,
    /// Edges between two labels.
    pub edges: Vec<SharedSeam>,
    /// Sequences of bands that were laid anew between seam curves.
    pub rows: Vec<Row>,
    /// Labels whose torses are better than those before without such edges, too: their panels end together with their
    /// neighbours'.
    pub together: BTreeSet<u32>,
}

/// An edge in space for a chain of the borders.
#[derive(Clone, Debug)]
pub(crate) struct SharedSeam {
    pub chain: usize,
    pub labels: [u32; 2],
    pub edge: Curve<3>,
    pub parameters: Vec<f64>,
}

/// Share of the tolerance that new strips may use before they are judged.
const SHARE: f64 = 0.98;
/// Wanted distance between seams and dual splines, share of the tolerance.
const SEAM_SHARE: f64 = 1e-3;
/// The same as a share of the shortest seam: the lengths of both sides' edges then agree to about 1e-9.
const LENGTH_SHARE: f64 = 1e-7;
/// A border belongs to a level if its values differ by less than this share of a band's theoretical width.
const LEVEL: f64 = 0.05;
/// Place of the free seam of a band at the end, as a share of its range from that end.
const FREE: f64 = 0.2;
/// Seams reach beyond the region by this share of their length, this multiple of the way that rulings lean, and this
/// share of what the neighbours are longer.
const BEYOND: [f64; 3] = [0.12, 1.3, 0.6];
/// Edge offsets from theory stay within this share of the tolerance.
const MOST_OFFSET: f64 = 0.9;

/// Strips that miss the samples by more than this share of the tolerance are nothing to start from.
const MOST_DRAFT: f64 = 1.5;

/// One band in a sequence.
struct Band {
    label: u32,
    lo: f64,
    hi: f64,
    /// Chain to the band after.
    after: Option<usize>,
}

/// Lays the bands of a covered face anew so that they meet. `state` must have the partition of the borders.
pub(crate) fn meet(face: &Face, state: &State, borders: &Borders, tolerance: f64) -> Meeting {
    let chains = borders.seam_chains();
    let mut out = Meeting::default();
    for sequence in sequences(state, &chains, tolerance) {
        laid_anew(face, state, &chains, &sequence, tolerance, &mut out);
    }
    out
}

/// The state with the vertices of borders between bands on their levels, from which smoothing may have moved them:
/// seams are made for the levels. How vertices move: [`settle`].
pub(crate) fn on_levels(face: &Face, state: &State, borders: &Borders, tolerance: f64) -> State {
    let chains = borders.seam_chains();
    let levelled: Vec<(&SeamChain, &Field, f64)> = level_chains(state, &chains, tolerance)
        .iter()
        .filter_map(|c| {
            let (chain, field) = (&chains[c.chain], state.bands.get(&c.low)?);
            Some((chain, &**field, level_of(&state.partition, field, chain)))
        })
        .collect();
    let mut partition = state.partition.clone();
    let along: Vec<&SeamChain> = levelled.iter().map(|l| l.0).collect();
    settle(face, &mut partition, &along, |k, p, fixed| Some(onto(levelled[k].1, p, levelled[k].2, fixed)));
    with_partition(face, state, partition)
}

/// Moves the vertices of borders to places given by border, vertex, and for whether its parameters must stay: vertices on
/// knot lines move along these, ends on a trimming curve that is no knot line stay. Where triangles would turn over, the
/// vertices around are moved out of the way; vertices for which that is not enough stay too, and are the result.
pub(crate) fn settle(
    face: &Face,
    partition: &mut Partition,
    along: &[&SeamChain],
    place: impl Fn(usize, [f64; 2], [bool; 2]) -> Option<[f64; 2]> + Sync,
) -> BTreeSet<u32> {
    let lines = [face.surface.knots_u.breaks(), face.surface.knots_v.breaks()];
    let mut all: Vec<(usize, u32, bool)> = Vec::new();
    for (k, chain) in along.iter().enumerate() {
        let last = chain.vertices.len() - 1;
        all.extend(chain.vertices.iter().enumerate().map(|(i, &v)| (k, v, i == 0 || i == last)));
    }
    let mut waiting: Vec<(u32, [f64; 2])> = all
        .par_iter()
        .filter_map(|&(k, v, is_end)| {
            let old = partition.vertices[v as usize];
            let fixed = [0, 1].map(|d: usize| lines[d].contains(&old[d]));
            let stays = fixed == [true; 2] || (is_end && fixed == [false; 2]);
            if stays {
                None
            } else {
                Some((v, place(k, old, fixed)?))
            }
        })
        .collect();
    let mut around: HashMap<u32, Vec<usize>> = waiting.iter().map(|&(v, _)| (v, Vec::new())).collect();
    for (t, corners) in partition.triangles.iter().enumerate() {
        for v in corners {
            if let Some(a) = around.get_mut(v) {
                a.push(t);
            }
        }
    }
    let area = |p: &Partition, t: usize| {
        let [a, b, c] = p.corners(t);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for _ in 0..SETTLINGS {
        waiting.retain(|&(v, new)| {
            let old = partition.vertices[v as usize];
            let before: Vec<f64> = around[&v].iter().map(|&t| area(partition, t)).collect();
            for share in SETTLING_SHARES {
                let to = |d: usize| if share < 1.0 { old[d] + (new[d] - old[d]) * share } else { new[d] };
                // Coordinates on knot lines are the same in both.
                partition.vertices[v as usize] = [to(0), to(1)];
                if around[&v].iter().zip(&before).all(|(&t, b)| area(partition, t) > LEAST_TRIANGLE * b) {
                    return share < 1.0;
                }
            }
            partition.vertices[v as usize] = old;
            true
        });
        if waiting.is_empty() {
            break;
        }
        partition.relax([&lines[0], &lines[1]]);
    }
    waiting.into_iter().map(|w| w.0).collect()
}

/// Times that vertices try to settle.
const SETTLINGS: usize = 8;
/// Shares of the way that they try each time.
const SETTLING_SHARES: [f64; 3] = [1.0, 0.5, 0.2];
/// Triangles keep this share of their area when vertices move.
const LEAST_TRIANGLE: f64 = 0.05;

/// The level of a chain: the middle one of its vertices' values.
fn level_of(partition: &Partition, field: &Field, chain: &SeamChain) -> f64 {
    let mut values: Vec<f64> = chain.vertices.iter().map(|&v| field.value(partition.vertices[v as usize])).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A chain of the borders on one level between bands of one function.
pub(crate) struct LevelChain {
    /// Index in the list of chains.
    pub chain: usize,
    /// Label at lower levels.
    pub low: u32,
    /// Label at higher levels.
    pub high: u32,
}

/// Ranges of the bands' own level function.
fn ranges(state: &State) -> HashMap<u32, (f64, f64)> {
    let part = &state.partition;
    state
        .bands
        .iter()
        .filter(|(l, _)| state.panels.contains_key(l))
        .map(|(&l, f)| {
            let values = part.region_vertices(l).into_iter().map(|v| f.value(part.vertices[v as usize]));
            (l, values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x))))
        })
        .collect()
}

/// All chains on one level.
pub(crate) fn level_chains(state: &State, chains: &[SeamChain], tolerance: f64) -> Vec<LevelChain> {
    let (part, ranges) = (&state.partition, ranges(state));
    let of = |(chain, c): (usize, &SeamChain)| {
        let [a, b] = c.labels;
        let (fa, fb, ra, rb) = (state.bands.get(&a)?, state.bands.get(&b)?, ranges.get(&a)?, ranges.get(&b)?);
        if !Arc::ptr_eq(fa, fb) || c.length <= 0.0 || c.vertices.len() < 3 {
            return None;
        }
        let values = c.vertices.iter().map(|&v| fa.value(part.vertices[v as usize]));
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let (low, high) = if ra.0 + ra.1 < rb.0 + rb.1 { (a, b) } else { (b, a) };
        (hi - lo <= LEVEL * 4.0 * tolerance.sqrt()).then_some(LevelChain { chain, low, high })
    };
    chains.iter().enumerate().filter_map(of).collect()
}

/// Bands that follow each other along one level function, each sequence in the order of levels.
fn sequences(state: &State, chains: &[SeamChain], tolerance: f64) -> Vec<Vec<Band>> {
    let ranges = ranges(state);
    // Chains on one level between bands of one function: (lower, upper).
    let mut above: HashMap<u32, Vec<(usize, u32)>> = HashMap::new();
    let mut below: HashMap<u32, Vec<(usize, u32)>> = HashMap::new();
    let mut between: HashMap<[u32; 2], usize> = HashMap::new();
    for c in chains {
        *between.entry(c.labels).or_insert(0) += 1;
    }
    for c in level_chains(state, chains, tolerance).iter().filter(|c| between[&chains[c.chain].labels] == 1) {
        above.entry(c.low).or_default().push((c.chain, c.high));
        below.entry(c.high).or_default().push((c.chain, c.low));
    }
    let single = |m: &HashMap<u32, Vec<(usize, u32)>>, l: u32| match m.get(&l).map(Vec::as_slice) {
        Some([one]) => Some(*one),
        _ => None,
    };
    // A step is taken if it is the only one from below and from above.
    let next = |l: u32| single(&above, l).filter(|&(_, h)| single(&below, h).is_some());
    let previous = |l: u32| single(&below, l).filter(|&(_, w)| single(&above, w).is_some());
    let mut labels: Vec<u32> = ranges.keys().copied().collect();
    labels.sort_unstable();
    let mut out = Vec::new();
    for first in labels.into_iter().filter(|&l| previous(l).is_none() && next(l).is_some()) {
        let mut sequence = Vec::new();
        let mut label = first;
        loop {
            let (lo, hi) = ranges[&label];
            let step = next(label);
            sequence.push(Band { label, lo, hi, after: step.map(|s| s.0) });
            match step {
                Some((_, l)) if sequence.len() <= ranges.len() => label = l,
                _ => break,
            }
        }
        out.push(sequence);
    }
    out
}

/// What a seam starts from.
pub(crate) struct Origin {
    pub seed: [f64; 2],
    pub inside: (f64, f64),
    pub level: f64,
}

#[expect(clippy::too_many_lines, reason = "one story of a seam, attempt by attempt")]
fn laid_anew(
    face: &Face,
    state: &State,
    chains: &[SeamChain],
    sequence: &[Band],
    tolerance: f64,
    out: &mut Meeting,
) -> Option<()> {
    let surface = &face.surface;
    let field: &Field = state.bands.get(&sequence[0].label)?;
    // 1. Seeds: the free seam of the first band, the seams between, the free seam of the last band.
    let real: Vec<(&SeamChain, Origin)> = sequence
        .iter()
        .filter_map(|b| b.after)
        .map(|k| Some((&chains[k], origin(face, state, field, &chains[k])?)))
        .collect::<Option<_>>()?;
    let free = |o: &Origin, level: f64| Origin {
        seed: onto(field, o.seed, level, [false; 2]),
        inside: (0.5 * (o.inside.0 + o.inside.1), 0.5 * (o.inside.0 + o.inside.1)),
        level,
    };
    let (first, last) = (sequence.first()?, sequence.last()?);
    let (start, end) = (&real.first()?.1, &real.last()?.1);
    let bottom = free(start, first.lo + FREE * (start.level - first.lo));
    let top = free(end, last.hi - FREE * (last.hi - end.level));
    let mut levels: Vec<f64> = real.iter().map(|r| r.1.level).collect();
    levels.insert(0, first.lo);
    levels.push(last.hi);
    let origins: Vec<&Origin> =
        std::iter::once(&bottom).chain(real.iter().map(|r| &r.1)).chain(std::iter::once(&top)).collect();
    // 2. Base lines, long enough for the rulings of both neighbours.
    let short: Vec<Option<BaseLine>> =
        origins.par_iter().map(|o| base_line(surface, field, o.seed, o.inside, [0.0; 2])).collect();
    let length = |k: usize| origins[k].inside.0 + origins[k].inside.1;
    let width = |k: usize| {
        let step = |i: usize| levels.get(i + 1).zip(levels.get(i)).map_or(0.0, |(b, a)| b - a);
        if k == 0 {
            step(0)
        } else {
            step(k - 1).max(step(k))
        }
    };
    let n = origins.len();
    let mut seams = Vec::new();
    for (k, o) in origins.iter().enumerate() {
        let around = [k.checked_sub(1), Some(k), (k + 1 < n).then_some(k + 1)];
        let lean = around
            .iter()
            .flatten()
            .filter_map(|&i| short[i].as_ref())
            .flat_map(|b| b.points.iter().map(|p| p.lean.abs() * width(k) / p.slope))
            .fold(0.0, f64::max);
        let longer = around.iter().flatten().map(|&i| length(i) - length(k)).fold(0.0, f64::max);
        let beyond = BEYOND[0] * length(k) + (BEYOND[1] * lean).min(0.5 * length(k)) + BEYOND[2] * longer;
        let line = base_line(surface, field, o.seed, o.inside, [beyond; 2])?;
        // 3. Offsets from theory.
        let sagitta = |p: &BasePoint, i: usize| {
            let width = (levels[i + 1] - levels[i]) / p.slope;
            p.curvature.abs() * width * width / 8.0
        };
        let wanted = |p: &BasePoint| {
            let sign = -p.curvature.signum();
            if k == 0 || k + 1 == n {
                let h = sagitta(p, if k == 0 { 0 } else { n - 2 });
                // Between middle and edge of the band: κ (s²/2 − ω²/16) at s = (1/2 − FREE) ω.
                let share = 4.0 * (0.5 - FREE).powi(2) - 0.5;
                return (sign * h * share).clamp(-MOST_OFFSET * tolerance, MOST_OFFSET * tolerance);
            }
            let (a, b) = (sagitta(p, k - 1), sagitta(p, k));
            let most = MOST_OFFSET * tolerance;
            sign * (0.25 * (a + b)).max(a.max(b) - most).min(most)
        };
        seams.push(Seam::new(line, wanted)?);
    }
    // 4. All strips together.
    let strips: Vec<StripBetween> = sequence
        .iter()
        .enumerate()
        .map(|(k, b)| StripBetween {
            lower: k,
            upper: k + 1,
            samples: state.dense_samples(surface, b.label, Density::Band),
        })
        .collect();
    let shortest = real.iter().map(|(chain, _)| chain.length).fold(f64::INFINITY, f64::min);
    let wanted = (tolerance * SEAM_SHARE).min(LENGTH_SHARE * shortest);
    let options = NetworkOptions::new(tolerance * SHARE, wanted);
    let laid = network(&mut seams, &strips, &options);
    let good = |k: usize| {
        laid[k].as_ref().filter(|l: &&Laid| l.error <= tolerance && l.seam_distance <= 10.0 * SEAM_SHARE * tolerance)
    };
    for (k, band) in sequence.iter().enumerate() {
        if let Some(l) = laid[k].as_ref().filter(|l| l.error <= MOST_DRAFT * tolerance) {
            out.drafts.insert(band.label, l.torse.clone());
        }
        if let Some(l) = good(k) {
            out.torses.insert(band.label, l.torse.clone());
        }
    }
    out.rows.push(Row {
        labels: sequence.iter().map(|b| b.label).collect(),
        levels,
        shares: laid.iter().map(|l| l.as_ref().map_or(f64::INFINITY, |l| l.error / tolerance)).collect(),
    });
    // 5. Edges for the borders whose both sides are good.
    for (k, (chain, _)) in real.iter().enumerate() {
        if good(k).is_none() || good(k + 1).is_none() {
            continue;
        }
        let places: Vec<Vec3> = chain.vertices.iter().map(|&v| state.jets[v as usize].jet.p).collect();
        if let Some((edge, parameters)) = seams[k + 1].curve().and_then(|c| stretch(&c, &seams[k + 1].base, &places)) {
            let labels = [sequence[k].label, sequence[k + 1].label];
            out.edges.push(SharedSeam { chain: chain.chain, labels, edge, parameters });
        }
    }
    Some(())
}

/// Seed, lengths and level of the seam on a chain, lengths along the direction of base lines.
pub(crate) fn origin(face: &Face, state: &State, field: &Field, chain: &SeamChain) -> Option<Origin> {
    let at = |v: u32| state.partition.vertices[v as usize];
    let level = level_of(&state.partition, field, chain);
    let place = |v: u32| state.jets[v as usize].jet.p;
    let lengths: Vec<f64> = chain.vertices.windows(2).map(|w| (place(w[1]) - place(w[0])).norm()).collect();
    let mut covered = 0.0;
    let mut middle = 0;
    while middle + 1 < lengths.len() && covered + lengths[middle] < 0.5 * chain.length {
        covered += lengths[middle];
        middle += 1;
    }
    let seed = onto(field, at(chain.vertices[middle]), level, [false; 2]);
    let j = face.surface.extended_jet(seed[0], seed[1]);
    let [_, fu, fv] = field.jet(seed[0], seed[1]);
    let next = place(*chain.vertices.get(middle + 1)?) - place(chain.vertices[middle]);
    let total: f64 = lengths.iter().sum();
    let forward = (j.du * fv - j.dv * fu).dot(&next) > 0.0;
    let inside = if forward { (covered, total - covered) } else { (total - covered, covered) };
    Some(Origin { seed, inside, level })
}

/// The point of a level near `p`, by Newton steps along the gradient; fixed parameters stay.
fn onto(field: &Field, mut p: [f64; 2], level: f64, fixed: [bool; 2]) -> [f64; 2] {
    const STEPS: usize = 12;
    for _ in 0..STEPS {
        let [f, fu, fv] = field.jet(p[0], p[1]);
        let (fu, fv) = (if fixed[0] { 0.0 } else { fu }, if fixed[1] { 0.0 } else { fv });
        let g = fu * fu + fv * fv;
        if g <= 0.0 {
            break;
        }
        p = [p[0] + (level - f) / g * fu, p[1] + (level - f) / g * fv];
    }
    p
}

/// The part of a seam beside a border's vertices, over [0, 1] in their direction, and the parameter of each: the
/// point of the seam nearest to it. `None` if these do not follow each other.
pub(crate) fn stretch(curve: &Curve<3>, base: &BaseLine, places: &[Vec3]) -> Option<(Curve<3>, Vec<f64>)> {
    const STEPS: usize = 20;
    // Steps below this share of the domain are rounding.
    const STILL: f64 = 1e-15;
    let (a, b) = curve.domain();
    let nearest = |x: &Vec3| {
        let start = base.points.iter().min_by(|p, q| (p.x - x).norm_squared().total_cmp(&(q.x - x).norm_squared()))?;
        let mut s = start.s;
        for _ in 0..STEPS {
            let j = curve.jet(s).map(Vec3::from);
            let off = j[0] - x;
            let step = -off.dot(&j[1]) / (j[1].norm_squared() + off.dot(&j[2]));
            if !step.is_finite() {
                return None;
            }
            s = (s + step).clamp(a, b);
            if step.abs() <= STILL * (b - a) {
                break;
            }
        }
        Some(s)
    };
    let mut s: Vec<f64> = places.iter().map(nearest).collect::<Option<_>>()?;
    let (first, last) = (*s.first()?, *s.last()?);
    let forward = last > first;
    let (low, high) = if forward { (first, last) } else { (last, first) };
    let part = curve.restricted(low, high).ok()?;
    let part = if forward { part } else { part.reversed() };
    for s in &mut s {
        *s = if forward { (*s - low) / (high - low) } else { (high - *s) / (high - low) };
    }
    if !s.windows(2).all(|w| w[0] < w[1]) {
        return None;
    }
    let values = part.knots.values().iter().map(|&k| ((k - low) / (high - low)).clamp(0.0, 1.0)).collect();
    let count = part.control.len();
    let knots = Knots::new(part.knots.degree(), values, count).ok()?;
    let last = s.len() - 1;
    (s[0], s[last]) = (0.0, 1.0);
    Some((Curve { knots, control: part.control }, s))
}

/// Shared edges whose both labels are still new, without those between labels in `dropped`.
pub(crate) fn apply<'a>(
    meeting: &'a Meeting,
    refused: &'a [u32],
    dropped: &'a [[u32; 2]],
) -> impl Iterator<Item = &'a SharedSeam> {
    let between = |e: &SharedSeam, [a, b]: [u32; 2]| e.labels == [a, b] || e.labels == [b, a];
    meeting
        .edges
        .iter()
        .filter(move |e| !e.labels.iter().any(|l| refused.contains(l)) && !dropped.iter().any(|d| between(e, *d)))
}

/// The edges that panels of a patchwork share, for those borders that are still the same.
pub(crate) fn kept(patchwork: &Patchwork, borders: &Borders) -> Vec<SharedSeam> {
    let seams = patchwork.seams();
    let sides: Vec<_> = seams.iter().filter(|s| s.is_shared()).flat_map(|s| s.sides).collect();
    let same = |c: SeamChain| {
        let run = sides.iter().map(|s| s.run).find(|r| r.vertices == c.vertices)?;
        let (edge, parameters) = (run.edge.clone(), run.parameters.clone());
        Some(SharedSeam { chain: c.chain, labels: c.labels, edge, parameters })
    };
    borders.seam_chains().into_iter().filter_map(same).collect()
}

/// The state with another partition of the same labels.
pub(crate) fn with_partition(face: &Face, state: &State, partition: Partition) -> State {
    let mut out = State {
        partition,
        jets: Vec::new(),
        panels: state.panels.clone(),
        bands: state.bands.clone(),
        origins: state.origins.clone(),
    };
    out.update(&face.surface);
    out
}
