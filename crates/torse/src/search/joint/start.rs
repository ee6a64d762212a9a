//! What the program starts from: strips on equal spans near those of a cover, lines along the borders of its regions, and
//! points of the face.

use super::asked::Asked;
use super::envelope::Envelope;
use super::form::Foot;
use super::line::{End, Line};
use super::network::{median, nearest, Member, Network, Sample, UNIT};
use super::profile::Profile;
use super::strip::{FootGuesses, Strip};
use crate::fit::panels::boundary::SeamChain;
use crate::geom::Vec3;
use crate::num::hash::HashSet;
use crate::num::parallel;
use crate::patchwork::partition::{centroid, edges};
use crate::search::cover::Cover;
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};

/// Spans of strips to begin with, and at most.
const SPANS: (usize, usize) = (30, 120);
/// Share of the tolerance by which a strip on equal spans may miss what it stands for.
const MISSED: f64 = 0.05;
/// Domains reach beyond the feet by this share.
const BEYOND: f64 = 0.03;
/// Envelopes whose regularity falls below this share of its largest value are near an inflection.
const INFLECTED: f64 = 0.1;

/// The network of the strips of a covered face that can take part. `None` without any line between these.
pub(super) fn network<'a>(cover: &'a Cover, chains: Vec<SeamChain>, asked: &Asked) -> Option<Network<'a>> {
    let chains = whole_borders(chains);
    let mut without = asked.without.clone();
    loop {
        match network_of_others(cover, &chains, asked, &without) {
            Ok(network) => return Some(network),
            Err(labels) if labels.is_empty() => return None,
            Err(labels) => without.extend(labels),
        }
    }
}

/// See [`network`]; without strips that were named. Errors are the labels of those that cannot take part, if there are any.
fn network_of_others<'a>(
    cover: &'a Cover,
    chains: &[SeamChain],
    asked: &Asked,
    without: &BTreeSet<u32>,
) -> Result<Network<'a>, Vec<u32>> {
    let &Asked { held, tolerance, regular, .. } = asked;
    let face = &*cover.face;
    let mut labels: Vec<u32> = cover.partition.distinct_labels();
    labels.retain(|l| !without.contains(l));
    let index: BTreeMap<u32, usize> = labels.iter().enumerate().map(|(k, &l)| (l, k)).collect();
    let alone = asked.borders.is_some() && chains.is_empty();
    let found = if alone { Some((Vec::new(), 0)) } else { lines(cover, chains, &index, held, tolerance) };
    let (lines, vertices) = found.ok_or_else(Vec::new)?;
    let given = given(cover, &index);
    let places: Vec<Vec<Place>> = (0..labels.len()).map(|k| places(k, &given, &lines)).collect();
    let of_label = |k: usize| {
        let torse = &cover.panels.get(&labels[k])?.torse;
        Some(Member { regular, ..member(labels[k], torse, &places[k], tolerance)? })
    };
    let members: Vec<Option<Member>> = parallel::map(0..labels.len(), of_label);
    let lost: Vec<u32> = members.iter().zip(&labels).filter(|m| m.0.is_none()).map(|m| *m.1).collect();
    if !lost.is_empty() {
        return Err(lost);
    }
    let members: Vec<Member> = members.into_iter().flatten().collect();
    let dense = |l: Line| {
        let spans = l.strips.map(|k| members[k].strip.spans()).into_iter().fold(1, usize::max);
        l.for_spans(spans, face, tolerance)
    };
    let lines = lines.into_iter().map(dense).collect::<Option<Vec<Line>>>().ok_or_else(Vec::new)?;
    let sample = |g: &Given| {
        let up = Some(g.normal).filter(|n| g.on_border && *n != Vec3::zeros());
        let counts = asked.borders.filter(|_| g.on_border).map_or(1.0, |counts| counts(&g.x));
        Sample { x: g.x, strip: g.strip, foot: None, lines: Vec::new(), up, counts, taken: 1.0 }
    };
    let samples = given.iter().map(sample).collect();
    let is_whole = cover.partition.distinct_labels().len() == labels.len();
    let mut out = Network {
        face,
        tolerance,
        members,
        lines,
        vertices,
        samples,
        unit: 0.0,
        is_whole,
        ends_count: false,
        widths: Vec::new(),
        aims: Vec::new(),
    };
    // Feet from nothing.
    let guesses: Vec<FootGuesses> = out.members.iter().map(|m| FootGuesses::of(m.strip.torse())).collect();
    let members = &out.members;
    parallel::for_each(out.samples.iter_mut(), |s| s.foot = members[s.strip].foot_anywhere(&guesses[s.strip], &s.x));
    for l in &mut out.lines {
        let strips = l.strips;
        parallel::for_each(l.points.iter_mut(), |p| {
            p.feet = strips.map(|k| members[k].foot_anywhere(&guesses[k], &p.x));
        });
    }
    let lost = out.without_feet();
    if !lost.is_empty() {
        return Err(lost.into_iter().map(|k| labels[k]).collect());
    }
    let widths = out.lie_on_bands();
    out.unit = UNIT * median(widths);
    out.find_neighbours();
    out.find_taken();
    out.find_middles().map_err(|l| out.lines[l].strips.map(|k| labels[k]).to_vec())?;
    out.widths = out.wanted_widths();
    Ok(out)
}

/// A point with the normal of the face where it is known.
type Place = (Vec3, Vec3);

/// Points that a strip is for.
fn places(k: usize, samples: &[Given], lines: &[Line]) -> Vec<Place> {
    let of_samples = samples.iter().filter(|s| s.strip == k).map(|s| (s.x, s.normal));
    let of_lines = lines.iter().filter(|l| l.strips.contains(&k)).flat_map(|l| &l.points).map(|p| (p.x, p.normal));
    of_samples.chain(of_lines).collect()
}

/// The strip near a torse of the cover, on as many equal spans as it takes, in the form that bears them.
fn member(label: u32, torse: &Torse, places: &[Place], tolerance: f64) -> Option<Member> {
    let ((lo, hi), distances) = feet_on(torse, places, tolerance)?;
    let margin = BEYOND * (hi - lo);
    let range = (lo - margin, hi + margin);
    let mut best: Option<(f64, Member)> = None;
    let mut spans = SPANS.0;
    while spans <= SPANS.1 {
        let forms = match torse {
            Torse::Dual(d) => [
                Envelope::new(d, range, spans).map(Strip::Planes),
                Profile::of_planes(d, range, spans).map(Strip::Profile),
            ],
            Torse::Primal(p) => [Profile::new(p, range, spans).map(Strip::Profile), None],
            Torse::Cylinder(_) => return None,
        };
        for strip in forms.into_iter().flatten() {
            let Some(start) = Start::of(label, strip, places) else { continue };
            let off = start.feet.iter().zip(&distances).map(|(f, d)| (f.distance.abs() - d.abs()).abs());
            let missed = off.fold(0.0, f64::max).max(MISSED * tolerance);
            if missed <= MISSED * tolerance && !start.is_inflected {
                return Some(start.member);
            }
            // Planes near an inflection are better than nothing.
            if best.as_ref().is_none_or(|b| missed < b.0) {
                best = Some((missed, start.member));
            }
        }
        spans *= 2;
    }
    best.map(|b| b.1)
}

/// A strip with the feet of its points.
struct Start {
    member: Member,
    feet: Vec<Foot>,
    /// Whether it consists of planes near an inflection.
    is_inflected: bool,
}

impl Start {
    /// The strip with the side and the sign of the regularity that most of its points have. `None` if some point has no such
    /// foot.
    fn of(label: u32, strip: Strip, places: &[Place]) -> Option<Self> {
        let guesses = FootGuesses::of(strip.torse());
        let feet_of = |(x, n): &Place| -> Vec<Foot> {
            facing(guesses.near(x).into_iter().filter_map(|t| strip.foot(x, t, 1.0)).collect(), n, |f| f.normal)
        };
        let near: Vec<Vec<Foot>> = places.iter().map(feet_of).collect();
        let sense = near.iter().filter_map(|f| f.first()).map(|f| f.regular.signum()).sum::<f64>().signum();
        let on_sheet = |f: &Vec<Foot>| nearest(f.iter().copied().filter(|f| f.regular * sense > 0.0));
        let feet: Vec<Foot> = near.iter().map(on_sheet).collect::<Option<_>>()?;
        let side = feet.iter().zip(places).map(|(f, p)| f.normal.dot(&p.1).signum()).sum::<f64>().signum();
        let sizes = feet.iter().map(|f| f.regular.abs());
        let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        let is_inflected = matches!(strip, Strip::Planes(_)) && least < INFLECTED * most;
        Some(Self { member: Member { label, strip, side, sense, least, regular: 1.0 }, feet, is_inflected })
    }
}

/// Least cosines between the normals of face and strip at a foot: usual, and where there is no such foot. A crest of 9 mm radius has
/// normals at all angles to those of a strip 13 mm beside it.
const FACING: [f64; 2] = [0.5, 0.2];

/// Feet whose `normal` is near that of the face, where it has one.
fn facing<T>(mut feet: Vec<T>, of_face: &Vec3, normal: impl Fn(&T) -> Vec3) -> Vec<T> {
    let cosine = |f: &T| if *of_face == Vec3::zeros() { 1.0 } else { normal(f).dot(of_face).abs() };
    let least = FACING.into_iter().find(|least| feet.iter().any(|f| cosine(f) > *least));
    feet.retain(|f| least.is_some_and(|least| cosine(f) > least));
    feet
}

/// Share of the domain up to which feet of a point are one.
const ONE_FOOT: f64 = 1e-3;

/// Range of the feet of points on a torse, and their distances from it, mm. Beyond a fold at its end a torse may come as near to
/// points again (`tolerance`): of several feet those count that are nearest to the rulings of points with one.
fn feet_on(torse: &Torse, places: &[Place], tolerance: f64) -> Option<((f64, f64), Vec<f64>)> {
    let guesses = FootGuesses::of(torse);
    let feet_of = |(x, n): &Place| {
        let feet = guesses.near(x).into_iter().filter_map(|t| torse.foot(x, t)).collect();
        let feet = facing(feet, n, |t| torse.ruling(*t).normal).into_iter();
        let mut feet: Vec<(f64, f64)> = feet.map(|t| (t, torse.plane_distance(x, t))).collect();
        feet.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let least = feet.first()?.1.abs();
        feet.retain(|f| f.1.abs() <= least + tolerance);
        Some(feet)
    };
    let feet: Vec<Vec<(f64, f64)>> = places.iter().map(feet_of).collect::<Option<_>>()?;
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let range_of = |range: (f64, f64), t: f64| (range.0.min(t), range.1.max(t));
    let (a, b) = torse.domain();
    let spread = |feet: &Vec<(f64, f64)>| feet.iter().fold(none, |r, f| range_of(r, f.0));
    let sure = feet
        .iter()
        .map(spread)
        .filter(|r| r.1 - r.0 <= ONE_FOOT * (b - a))
        .fold(none, |r, (lo, hi)| (r.0.min(lo), r.1.max(hi)));
    let off = |t: f64| if sure.0 <= sure.1 { (sure.0 - t).max(t - sure.1).max(0.0) } else { 0.0 };
    // The first of those that are equally far off is the nearest.
    let chosen: Vec<(f64, f64)> =
        feet.into_iter().filter_map(|f| f.into_iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)))).collect();
    let range = chosen.iter().fold(none, |r, f| range_of(r, f.0));
    Some((range, chosen.into_iter().map(|f| f.1).collect()))
}

/// Shares of an edge on the border of the face at which it is sampled besides its ends: distances peak there, and few edges
/// cross a strip.
const ON_BORDER: [f64; 5] = [0.125, 0.25, 0.5, 0.75, 0.875];

/// A point of the face.
struct Given {
    x: Vec3,
    /// Of the face, zero where it has none.
    normal: Vec3,
    /// In whose region it lies.
    strip: usize,
    on_border: bool,
}

/// Vertices of a partition and middles of its edges and triangles.
fn given(cover: &Cover, index: &BTreeMap<u32, usize>) -> Vec<Given> {
    let partition = &cover.partition;
    let mut of_vertex = vec![None; partition.vertices.len()];
    let mut of_edge: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (t, label) in partition.triangles.iter().zip(&partition.labels) {
        let Some(&k) = index.get(label) else { continue };
        for (a, b) in edges(*t) {
            of_vertex[a as usize] = Some(k);
            of_edge.insert((a.min(b), a.max(b)), k);
        }
    }
    let border = |a: u32, b: u32| [(a, b), (b, a)].iter().any(|e| partition.trim_edges.contains_key(e));
    let on_border: HashSet<u32> = partition.trim_edges.keys().flat_map(|&(a, b)| [a, b]).collect();
    let of_vertex = cover.jets.iter().zip(of_vertex).zip(0u32..);
    let mut out: Vec<Given> = of_vertex
        .filter_map(|((j, k), v)| {
            Some(Given { x: j.jet.p, normal: j.normal, strip: k?, on_border: on_border.contains(&v) })
        })
        .collect();
    let at = |[u, v]: [f64; 2], strip: usize, on_border: bool| {
        let j = cover.face.surface.jet(u, v);
        let normal = j.normal().try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        Given { x: j.p, normal, strip, on_border }
    };
    let on_edges = parallel::map(of_edge, |((a, b), k)| {
        let [p, q] = [a, b].map(|v| partition.vertices[v as usize]);
        let is_border = border(a, b);
        let shares: &[f64] = if is_border { &ON_BORDER } else { &[0.5] };
        let on = |s: &f64| at([p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])], k, is_border);
        shares.iter().map(on).collect::<Vec<_>>()
    });
    out.extend(on_edges.into_iter().flatten());
    let within = parallel::map(0..partition.triangles.len(), |t| {
        let k = *index.get(&partition.labels[t])?;
        Some(at(centroid(partition.corners(t)), k, false))
    });
    out.extend(within.into_iter().flatten());
    out
}

/// Borders between two labels from end to end: chains that follow each other, and nothing else, are one.
pub(crate) fn whole_borders(chains: Vec<SeamChain>) -> Vec<SeamChain> {
    let mut count: BTreeMap<u32, usize> = BTreeMap::new();
    for c in &chains {
        c.vertices.first().into_iter().chain(c.vertices.last()).for_each(|&v| *count.entry(v).or_insert(0) += 1);
    }
    let mut out: Vec<SeamChain> = Vec::new();
    let mut left = chains;
    while let Some(mut whole) = left.pop() {
        loop {
            let follows = |c: &SeamChain| {
                let ends = [(whole.vertices.last(), c.vertices.first()), (c.vertices.last(), whole.vertices.first())];
                c.labels == whole.labels && ends.iter().any(|(a, b)| a == b && a.is_some_and(|v| count[v] == 2))
            };
            let Some(k) = left.iter().position(follows) else { break };
            let next = left.swap_remove(k);
            whole.length += next.length;
            let (mut first, second) = if whole.vertices.last() == next.vertices.first() {
                (std::mem::take(&mut whole.vertices), next.vertices)
            } else {
                (next.vertices, std::mem::take(&mut whole.vertices))
            };
            first.extend(second.into_iter().skip(1));
            whole.vertices = first;
        }
        out.push(whole);
    }
    out.reverse();
    out
}

/// Lines along borders between regions of strips, and the number of vertices in which they end inside the face. Borders that
/// close, and those beside other regions, stay as they are, and so do vertices on these.
fn lines(
    cover: &Cover,
    chains: &[SeamChain],
    index: &BTreeMap<u32, usize>,
    held: &dyn Fn([u32; 2]) -> bool,
    tolerance: f64,
) -> Option<(Vec<Line>, usize)> {
    let on_border: HashSet<u32> = cover.partition.trim_edges.keys().flat_map(|&(a, b)| [a, b]).collect();
    let mut count: BTreeMap<u32, usize> = BTreeMap::new();
    let ends = |c: &SeamChain| Some([*c.vertices.first()?, *c.vertices.last()?]);
    for c in chains {
        ends(c)?.into_iter().for_each(|v| *count.entry(v).or_insert(0) += 1);
    }
    let inner: BTreeMap<u32, usize> =
        count.keys().filter(|v| !on_border.contains(v)).enumerate().map(|(k, &v)| (v, k)).collect();
    let takes_part = |c: &SeamChain| {
        let differ = c.labels[0] != c.labels[1] && c.vertices.first() != c.vertices.last();
        differ && c.length > 0.0 && c.labels.iter().all(|l| index.contains_key(l))
    };
    let mut stays: HashSet<usize> = HashSet::default();
    let mut out = Vec::new();
    for c in chains {
        let [first, last] = ends(c)?;
        if !takes_part(c) {
            stays.extend([first, last].iter().filter_map(|v| inner.get(v)));
            continue;
        }
        let end = |v: u32| match inner.get(&v) {
            Some(&k) => End::Vertex(k),
            None if count[&v] > 1 => End::Fixed,
            None => End::Border,
        };
        let strips = [*index.get(&c.labels[0])?, *index.get(&c.labels[1])?];
        let held = held(c.labels);
        let bare = Line::bare(strips, [end(first), end(last)], held);
        let uv: Vec<[f64; 2]> = c.vertices.iter().map(|&v| cover.partition.vertices[v as usize]).collect();
        out.push(bare.through(&cover.face, &uv, tolerance)?);
    }
    // Vertices of lines that stay must stay.
    stays.extend(out.iter().filter(|l| l.held).flat_map(|l| l.ends).filter_map(vertex));
    for l in &mut out {
        for e in 0..2 {
            if vertex(l.ends[e]).is_some_and(|v| stays.contains(&v)) {
                l.ends[e] = End::Fixed;
            }
        }
    }
    (!out.is_empty()).then_some((out, inner.len()))
}

fn vertex(end: End) -> Option<usize> {
    match end {
        End::Vertex(v) => Some(v),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;
    use crate::spline::lsq;
    use crate::torse::form::DualTorse;

    /// A general cylinder along z of radius 100 that runs back between the angles 0.8 and 1, and forward again: to points beside the
    /// first sheet the last is as near.
    #[test]
    fn feet_lie_on_the_sheet_that_points_with_one_foot_have() {
        let radius = |t: f64| if (0.8..1.0).contains(&t) { -100.0 } else { 100.0 };
        let (count, length) = (1400, 1.4);
        let at = |i: usize| length * i as f64 / count as f64;
        let tangent = |t: f64| Vec3::new(-t.sin(), t.cos(), 0.0);
        let mut points = vec![Vec3::new(100.0, 0.0, 0.0)];
        for i in 0..count {
            let t = 0.5 * (at(i) + at(i + 1));
            points.push(points[i] + tangent(t) * (radius(t) * length / count as f64));
        }
        let planes: Vec<[f64; 4]> = (0..=count)
            .map(|i| [at(i).cos(), at(i).sin(), 0.0, points[i].x * at(i).cos() + points[i].y * at(i).sin()])
            .collect();
        let parameters: Vec<f64> = (0..=count).map(at).collect();
        let knots = Knots::uniform(3, 70, 0.0, length).expect("knots");
        let torse = Torse::Dual(DualTorse { planes: lsq::fit(&planes, &parameters, &knots).expect("planes").curve });
        let mut places: Vec<Place> = (50..500).step_by(50).map(|i| (points[i], Vec3::zeros())).collect();
        // On the last sheet, and four millimetres off the first.
        places.push((points[1050], Vec3::zeros()));
        let nearest = feet_on(&torse, &places, 0.1).expect("feet");
        assert!((nearest.0 .1 - 1.05).abs() < 0.02, "{:?}", nearest.0);
        let ((_, last), distances) = feet_on(&torse, &places, 10.0).expect("feet");
        assert!(last < 0.8 && distances[9].abs() > 1.0 && distances[9].abs() < 10.0, "{last} {distances:?}");
    }
}
