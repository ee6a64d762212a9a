//! From strips that are nearly equally high along their lines to edges on both: finer strips where the edges would miss
//! them, and the curve along which two strips intersect.
//!
//! *Method* ([joint](super)). Over every line stands a fixed reference curve between both strips. Least squares make
//! strips of twice the spans equally high there. At each place the edge is the point beside and above the reference for
//! which `φ_A² + φ_B² + λ²x²` is least, with the distances φ from both strips and the way x to the side: the intersection
//! where strips cross at more than λ, the middle of both where they do not.

use super::columns::Columns;
use super::form::Tie;
use super::line::{End, Line};
use super::network::{Member, Network, Sample};

use crate::geom::Vec3;
use crate::num::block_matrix::{BlockMatrix, Structure};
use crate::num::parallel;
use crate::num::runs::{Bundles, Runs};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use std::collections::BTreeSet;

/// What a way to the side counts against a distance.
const SIDEWAYS: f64 = 1e-3;
/// Newton steps for a point of an edge.
const STEPS: usize = 12;
/// Steps end below this share of the tolerance.
const SETTLED: f64 = 1e-9;
/// Samples whose rows are written in one go.
const AT_ONCE: usize = 64;
/// Spans of reference curves.
const REFERENCE: usize = 24;
/// Degree of curves.
const DEGREE: usize = 5;
/// Places of an edge on its line, and share of the line by which it goes on beyond both ends.
const PLACES: (usize, f64) = (1600, 0.01);
/// Share of a line over which its edge turns to the point in which it ends together with others.
const TURNING: f64 = 0.1;
/// Vertices go under the common points of strips that are nearer than this share of the shortest line there.
const NEAR: f64 = 0.25;
/// Distance of an edge's spline from its places as a share of its length, and spans at most.
const FIT: (f64, usize) = (1e-8, 480);
/// Reference points per span of a strip.
const PER_SPAN: usize = 4;
/// Rounds of making finer strips equally high, and of a place between them.
const ROUNDS: usize = 3;
/// Prices of changes there, in turn until no foot is lost, and what damps strips as a multiple of them.
const PRICES: ([f64; 3], f64) = ([1e-3, 3e-2, 1.0], 10.0);
/// What the change of a sample's distance counts there, against the gap of one place at which strips do not cross.
const KEPT: f64 = 1e-2;
/// Where strips cross at more than this angle (rad) gaps count less: edges lie in the intersection, a little to the side.
const CROSSING: f64 = 0.02;

/// The curve over a line at which edges start, with the direction of heights.
struct Reference {
    place: Curve<3>,
    up: Curve<3>,
}

/// An edge of two strips.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    /// Over the line and a little beyond.
    pub curve: Curve<3>,
    /// Largest distance of its places from both strips, as a share of its line's length or of the mean of all lines where that is
    /// more. Sampled.
    missed: f64,
}

impl Reference {
    fn of(line: &Line) -> Option<Self> {
        let at: Vec<f64> = line.points.iter().map(|p| p.share).collect();
        let knots = Knots::uniform(DEGREE, REFERENCE, 0.0, 1.0).ok()?;
        let through = |f: &dyn Fn(&super::line::Middle) -> Vec3| {
            let points: Vec<[f64; 3]> =
                line.points.iter().map(|p| Some(f(p.middle.as_ref()?).into())).collect::<Option<_>>()?;
            let curve = lsq::fit(&points, &at, &knots).ok()?.curve;
            curve.extended(-2.0 * PLACES.1, 1.0 + 2.0 * PLACES.1).ok()
        };
        Some(Self { place: through(&|m| m.z)?, up: through(&|m| m.up)? })
    }

    /// Place, direction of heights, direction to the side.
    fn frame(&self, s: f64) -> Option<[Vec3; 3]> {
        let j = self.place.jet(s).map(Vec3::from);
        let up = Vec3::from(self.up.point(s)).try_normalize(0.0)?;
        Some([j[0], up, up.cross(&j[1]).try_normalize(0.0)?])
    }
}

/// A point of an edge with its feet.
struct Place {
    x: Vec3,
    /// Share of the line.
    share: f64,
    feet: [f64; 2],
    /// Whether it is over the line.
    inside: bool,
}

/// The point of the edge at `s`; `feet` are guesses and become its feet.
fn point(members: [&Member; 2], reference: &Reference, s: f64, feet: &mut [f64; 2], tolerance: f64) -> Option<Vec3> {
    let [y, up, aside] = reference.frame(s)?;
    let (mut x, mut h) = (0.0, 0.0);
    for step in 0..=STEPS {
        let z = y + aside * x + up * h;
        let found = [members[0].foot(&z, feet[0])?, members[1].foot(&z, feet[1])?];
        *feet = found.map(|f| f.t);
        // Normal equations of both distances and the way to the side.
        let (mut m, mut r) = ([SIDEWAYS * SIDEWAYS, 0.0, 0.0], [SIDEWAYS * SIDEWAYS * x, 0.0]);
        for f in &found {
            let (a, b) = (f.normal.dot(&aside), f.normal.dot(&up));
            m = [m[0] + a * a, m[1] + a * b, m[2] + b * b];
            r = [r[0] + a * f.distance, r[1] + b * f.distance];
        }
        let det = m[0] * m[2] - m[1] * m[1];
        let (dx, dh) = ((m[1] * r[1] - m[2] * r[0]) / det, (m[1] * r[0] - m[0] * r[1]) / det);
        if !(dx.is_finite() && dh.is_finite()) {
            return None;
        }
        if step == STEPS || dx.abs().max(dh.abs()) <= SETTLED * tolerance {
            return Some(z);
        }
        (x, h) = (x + dx, h + dh);
    }
    None
}

/// Moves places near the first or the last end of their line to the side, so that they lead through a point there. Where strips
/// hardly cross, places of edges lie anywhere between them, and edges of three strips would end beside each other.
fn turned_to(places: &mut [Place], last: bool, point: &Vec3) {
    let way = |p: &Place| if last { 1.0 - p.share } else { p.share };
    let Some(k) = (1..places.len().saturating_sub(1))
        .min_by(|&i, &j| (places[i].x - point).norm_squared().total_cmp(&(places[j].x - point).norm_squared()))
    else {
        return;
    };
    let along = places[k + 1].x - places[k - 1].x;
    let off = point - places[k].x;
    let aside = off - along * (off.dot(&along) / along.norm_squared());
    if aside.iter().all(|x| x.is_finite()) {
        let there = way(&places[k]).max(0.0);
        for p in places {
            p.x += aside * turning(way(p) - there);
        }
    }
}

/// Share by which an edge turns to the point in which it ends, at a share of its way from there: all at the point and beyond, none
/// from [`TURNING`] on, smooth to second order at both ends.
pub(crate) fn turning(way: f64) -> f64 {
    let t = (way / TURNING).clamp(0.0, 1.0);
    1.0 - t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

/// Lets places that end a little before a point ahead of them end there: a strip may end just beyond its line, and three strips
/// meet a hair further.
fn reach(places: &mut Vec<Place>, last: bool, point: &Vec3, most: f64) {
    let count = places.len();
    let (end, before) = if last { (count.wrapping_sub(1), count.wrapping_sub(2)) } else { (0, 1) };
    let (Some(e), Some(b)) = (places.get(end), places.get(before)) else { return };
    let off = point - e.x;
    if off.dot(&(e.x - b.x)) > 0.0 && off.norm() <= most {
        let share = if last { 1.0 + PLACES.1 } else { -PLACES.1 };
        let added = Place { x: *point, share, feet: e.feet, inside: false };
        places.insert(if last { count } else { 0 }, added);
    }
}

/// The point in which strips meet near the ends of their lines.
#[derive(Clone, Debug)]
pub(super) struct Junction {
    /// The vertex of the lines.
    vertex: usize,
    /// Indices of the strips, in order.
    pub strips: Vec<usize>,
    pub place: Vec3,
}

impl Edge {
    /// Whether it is farther from its strips than a share of what lines are long.
    pub fn misses(&self, share: f64) -> bool {
        self.missed > share
    }
}

impl Network<'_> {
    /// The common points of the three strips around every vertex; none where others meet, or they do so in no point.
    pub fn junctions(&self) -> Vec<Junction> {
        (0..self.vertices).filter_map(|v| self.junction(v)).collect()
    }

    fn junction(&self, vertex: usize) -> Option<Junction> {
        let end = |l: &Line| l.ends.iter().position(|e| *e == End::Vertex(vertex));
        let ends: Vec<(&Line, usize)> = self.lines.iter().filter_map(|l| Some((l, end(l)?))).collect();
        let at = |l: &Line, e: usize| l.points[if e == 0 { 0 } else { l.points.len() - 1 }].middle;
        let mut around: Vec<(usize, f64)> = Vec::new();
        for (l, e) in &ends {
            let middle = at(l, *e)?;
            around.extend(l.strips.into_iter().zip(middle.feet.map(|f| f.t)));
        }
        around.sort_by_key(|a| a.0);
        around.dedup_by_key(|a| a.0);
        if around.len() != 3 {
            return None;
        }
        let (l, e) = ends.first()?;
        let mut z = at(l, *e)?.z;
        for _ in 0..STEPS {
            let mut matrix = nalgebra::Matrix3::zeros();
            let mut right = Vec3::zeros();
            for (i, (k, t)) in around.iter_mut().enumerate() {
                let foot = self.members[*k].foot(&z, *t)?;
                *t = foot.t;
                matrix.set_row(i, &foot.normal.transpose());
                right[i] = -foot.distance;
            }
            let step = matrix.lu().solve(&right)?;
            z += step;
            if step.norm() <= SETTLED * self.tolerance {
                break;
            }
        }
        z.iter().all(|x| x.is_finite()).then(|| Junction {
            vertex,
            strips: around.iter().map(|a| a.0).collect(),
            place: z,
        })
    }

    /// The network with its vertices under the common points of the strips around them, as far as these are near: neighbours that
    /// hardly cross may be equally high along their lines, and meet the third some way off. `None` where none moves, or a foot is
    /// lost.
    pub fn under_junctions(&self) -> Option<Self> {
        let columns = self.columns(0);
        let mut x = vec![0.0; columns.limits.len()];
        for j in self.junctions() {
            let column = columns.vertices[j.vertex];
            let ends = |l: &&Line| l.ends.contains(&End::Vertex(j.vertex));
            let shortest = self.lines.iter().filter(ends).fold(f64::INFINITY, |m, l| m.min(l.length));
            let line = self.lines.iter().find(ends)?;
            let end = &line.points[if line.ends[0] == End::Vertex(j.vertex) { 0 } else { line.points.len() - 1 }];
            let off = j.place - end.x;
            let along = end.axes.map(|a| a.dot(&off));
            if column != usize::MAX && along[0].hypot(along[1]) < NEAR * shortest {
                (x[column], x[column + 1]) = (along[0] / self.unit, along[1] / self.unit);
            }
        }
        if x.iter().all(|x| *x == 0.0) {
            return None;
        }
        self.stepped(&columns, &x)
    }

    /// Edges along all lines; `None` for lines along which there is none.
    pub fn edges(&self) -> Vec<Option<Edge>> {
        let junctions = self.junctions();
        parallel::map(self.lines.iter(), |l| self.edge(l, &junctions))
    }

    fn edge(&self, line: &Line, junctions: &[Junction]) -> Option<Edge> {
        let reference = Reference::of(line)?;
        let members = line.strips.map(|k| &self.members[k]);
        let at = |i: usize| (1.0 + 2.0 * PLACES.1) * i as f64 / PLACES.0 as f64 - PLACES.1;
        // From the middle outwards: every place starts from the feet of the one before.
        let middle = PLACES.0 / 2;
        let m = line.points[line.points.len() / 2].middle.as_ref()?;
        let mut places: Vec<Place> = Vec::with_capacity(PLACES.0 + 1);
        for backwards in [true, false] {
            let mut feet = m.feet.map(|f| f.t);
            let range: Vec<usize> = if backwards { (0..middle).rev().collect() } else { (middle..=PLACES.0).collect() };
            for i in range {
                let found = point(members, &reference, at(i), &mut feet, self.tolerance);
                match found {
                    Some(x) => places.push(Place { x, share: at(i), feet, inside: (0.0..=1.0).contains(&at(i)) }),
                    // Beyond the line strips may end; on it they may not.
                    None if (0.0..=1.0).contains(&at(i)) => return None,
                    None => break,
                }
            }
            if backwards {
                places.reverse();
            }
        }
        for (end, last) in line.ends.iter().zip([false, true]) {
            if let Some(common) = junctions.iter().find(|j| *end == End::Vertex(j.vertex)) {
                turned_to(&mut places, last, &common.place);
                reach(&mut places, last, &common.place, PLACES.1 * line.length);
            }
        }
        let points: Vec<[f64; 3]> = places.iter().map(|p| p.x.into()).collect();
        let parameters = lsq::chord_parameters(&points);
        let curve = lsq::fit_within(&points, &parameters, DEGREE, FIT.0 * line.length, FIT.1).ok()?.curve;
        // What counts is how far the curve is from both strips, between its places too: to the side both are alike.
        let mut missed: f64 = 0.0;
        for (p, t) in places.windows(2).zip(parameters.windows(2)).filter(|(p, _)| p.iter().all(|p| p.inside)) {
            for x in [curve.point(t[0]), curve.point(0.5 * (t[0] + t[1]))] {
                for (m, &guess) in members.iter().zip(&p[0].feet) {
                    missed = missed.max(m.foot(&Vec3::from(x), guess)?.distance.abs());
                }
            }
        }
        // A short line among long ones need not be nearer than these.
        let mean = self.lines.iter().map(|l| l.length).sum::<f64>() / self.lines.len() as f64;
        Some(Edge { curve, missed: missed / line.length.max(mean) })
    }

    /// The coarser strips beside lines with edges that are farther from these than they should be (`wanted` of what lines are long), or
    /// all where they miss what they should meet of other faces, on twice the spans, and all as equally high over their lines as
    /// these allow. `None` where a foot is lost.
    pub fn polished(&self, edges: &[Option<Edge>], wanted: f64) -> Option<Self> {
        let references: Vec<Reference> = self.lines.iter().map(Reference::of).collect::<Option<_>>()?;
        let misses = |(_, e): &(&Line, &Option<Edge>)| e.as_ref().is_none_or(|e| e.misses(wanted));
        let spans = |k: usize| self.members[k].strip.spans();
        // The coarser of two strips first: rows of strips with inflections are as wide as these have spans.
        let coarser = |l: &Line| {
            let fewest = l.strips.map(spans).into_iter().fold(usize::MAX, usize::min);
            l.strips.into_iter().filter(move |&k| spans(k) == fewest)
        };
        let beside: BTreeSet<usize> =
            self.lines.iter().zip(edges).filter(misses).flat_map(|(l, _)| coarser(l)).collect();
        let all = !self.meets_aims();
        let mut now = self.clone();
        for (k, m) in now.members.iter_mut().enumerate() {
            if all || beside.contains(&k) {
                m.strip = m.strip.refined()?;
            }
        }
        now.lie_on_bands();
        let spans: Vec<usize> = now.members.iter().map(|m| m.strip.spans()).collect();
        // Feet of all reference points, the nearest of the line to begin with.
        let count = |l: &Line| PER_SPAN * l.strips.map(|k| spans[k]).into_iter().fold(1, usize::max);
        let share = |i: usize, count: usize| (1.0 + 2.0 * PLACES.1) * i as f64 / count as f64 - PLACES.1;
        let mut guesses: Vec<Vec<[f64; 2]>> = now
            .lines
            .iter()
            .map(|l| {
                let (last, count) = (l.points.len() - 1, count(l));
                let near = |i: usize| (share(i, count).clamp(0.0, 1.0) * last as f64).round() as usize;
                (0..=count).map(|i| Some(l.points[near(i)].middle.as_ref()?.feet.map(|f| f.t))).collect()
            })
            .collect::<Option<_>>()?;
        for _ in 0..ROUNDS {
            let columns = now.columns(0);
            // Of every line its rows, those beyond its ends, and the largest gap.
            let of_line = |((line, reference), guesses): ((&Line, &Reference), &mut Vec<[f64; 2]>)| {
                let count = guesses.len() - 1;
                let (mut gaps, mut beyond, mut largest) = (Tie::none(), Vec::new(), 0.0_f64);
                for (i, guess) in guesses.iter_mut().enumerate() {
                    let at = share(i, count);
                    let [y, up, _] = reference.frame(at)?;
                    let inside = (0.0..=1.0).contains(&at);
                    match now.height_row(line, (&y, &up), guess, &columns, &mut gaps.rows) {
                        Some((gap, weight)) => {
                            if inside {
                                largest = largest.max(weight.sqrt() * gap.abs());
                            } else {
                                beyond.push(gaps.price.len());
                            }
                            gaps.end(weight, gap);
                        }
                        None if inside => return None,
                        None => {}
                    }
                }
                Some((gaps, beyond, largest))
            };
            let of_lines = parallel::map(now.lines.iter().zip(&references).zip(&mut guesses), of_line);
            let (mut gaps, mut beyond, mut largest) = (Tie::none(), Vec::new(), 0.0_f64);
            for (of_line, behind, most) in of_lines.into_iter().collect::<Option<Vec<_>>>()? {
                beyond.extend(behind.into_iter().map(|k| k + gaps.price.len()));
                gaps.append(&of_line);
                largest = largest.max(most);
            }
            // Beyond the ends of lines strips may part: places there count no more than the worst on a line.
            for k in beyond {
                let (weight, gap) = &mut gaps.price[k];
                *weight = weight.min((largest / gap.abs().max(f64::MIN_POSITIVE)).powi(2));
            }
            now.aim_rows(&columns, &mut gaps)?;
            now.kept_rows(&columns, &mut gaps);
            now = PRICES.0.iter().find_map(|&price| now.changed(&columns, &now.closed(&columns, &gaps, price)?))?;
        }
        now.lie_on_bands();
        Some(now)
    }

    /// Whether strips come as near to the points at which they meet those of other faces as they must.
    pub fn meets_aims(&self) -> bool {
        self.aims.iter().filter(|a| a.within.is_finite()).all(|aim| {
            let s = &self.samples[aim.sample];
            let foot = s.foot.and_then(|f| self.members[s.strip].foot(&aim.z, f.t));
            foot.is_some_and(|f| f.distance.abs() <= aim.within)
        })
    }

    /// Writes the rows of the heights of strips over the points at which they meet those of other faces.
    fn aim_rows(&self, columns: &Columns, out: &mut Tie) -> Option<()> {
        for aim in &self.aims {
            let s = &self.samples[aim.sample];
            let m = &self.members[s.strip];
            let foot = m.foot(&aim.z, s.foot?.t)?;
            let scale = foot.normal.dot(&aim.up).recip();
            m.strip.row(columns.strips[s.strip], &aim.z, &foot, scale, &mut out.rows);
            out.end(aim.counts * aim.counts, foot.distance * scale / self.tolerance);
        }
        Some(())
    }

    /// Writes rows that keep the distances of samples from their strips: what closes gaps and costs little in unknowns may move strips
    /// by more than the gaps are wide.
    fn kept_rows(&self, columns: &Columns, out: &mut Tie) {
        let some = |samples: &[Sample]| {
            let mut out = Tie::none();
            for s in samples {
                if let Some(foot) = &s.foot {
                    self.members[s.strip].strip.row(columns.strips[s.strip], &s.x, foot, 1.0, &mut out.rows);
                    out.end(KEPT, 0.0);
                }
            }
            out
        };
        let all: Vec<Tie> = parallel::map(self.samples.chunks(AT_ONCE), some);
        all.iter().for_each(|t| out.append(t));
    }

    /// The change of all strips that closes gaps in the sense of least squares, at a price.
    fn closed(&self, columns: &Columns, gaps: &Tie, price: f64) -> Option<Vec<f64>> {
        let mut tie = Tie { rows: gaps.rows.clone(), price: gaps.price.clone(), damping: PRICES.1 * price };
        for (m, &c) in self.members.iter().zip(&columns.strips) {
            m.strip.damping(c, self.tolerance, &mut tie);
        }
        let structure = Structure::new(&columns.groups, &[&tie.rows]);
        let mut matrix = BlockMatrix::zeros(&structure);
        let mut x = vec![0.0; structure.columns()];
        let rows = Bundles::new(&tie.rows);
        let (weights, right): (Vec<f64>, Vec<f64>) =
            rows.ordered(&tie.price).into_iter().map(|(w, g)| (w, -w * g)).unzip();
        matrix.add(&rows, &weights);
        rows.scatter(&right, &mut x);
        (0..x.len()).for_each(|j| matrix.add_diagonal(j, price));
        matrix.factorise().then(|| matrix.solve(&mut x))?;
        Some(x)
    }

    /// Writes the row of the difference of heights of two strips over a place; the difference in tolerances, and its weight.
    fn height_row(
        &self,
        line: &Line,
        (place, up): (&Vec3, &Vec3),
        guess: &mut [f64; 2],
        columns: &Columns,
        rows: &mut Runs,
    ) -> Option<(f64, f64)> {
        let members = line.strips.map(|k| &self.members[k]);
        let mut z = *place;
        for round in 0..ROUNDS {
            let feet = [members[0].foot(&z, guess[0])?, members[1].foot(&z, guess[1])?];
            *guess = feet.map(|f| f.t);
            let heights = feet.map(|f| f.distance / f.normal.dot(up));
            if round + 1 == ROUNDS {
                for ((foot, &k), sign) in feet.iter().zip(&line.strips).zip([1.0, -1.0]) {
                    let scale = sign / foot.normal.dot(up);
                    self.members[k].strip.row(columns.strips[k], &z, foot, scale, rows);
                }
                let across = feet[0].normal.cross(&feet[1].normal).norm() / CROSSING;
                return Some(((heights[0] - heights[1]) / self.tolerance, (1.0 + across * across).recip()));
            }
            z -= up * (0.5 * (heights[0] + heights[1]));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places along x lead through a point beside their end after they are turned to it; those beyond the turn stay.
    #[test]
    fn edges_turn_to_a_point_beside_their_end() {
        let count = 400;
        let place = |i: usize| {
            let share = 1.02 * i as f64 / count as f64 - 0.01;
            Place { x: Vec3::new(100.0 * share, 0.0, 0.0), share, feet: [0.0; 2], inside: true }
        };
        let points = [
            (false, [0.02, 0.02, -0.01]),
            (true, [99.98, -0.03, 0.0]),
            (true, [98.5, 0.02, 0.01]),
            (false, [1.1, 0.1, 0.0]),
        ];
        for (last, point) in points.map(|(last, p)| (last, Vec3::from(p))) {
            let mut places: Vec<Place> = (0..=count).map(place).collect();
            turned_to(&mut places, last, &point);
            let near = places.windows(2).map(|w| {
                let (a, d) = (w[0].x, w[1].x - w[0].x);
                (a + d * ((point - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0) - point).norm()
            });
            assert!(near.fold(f64::INFINITY, f64::min) < 1e-4 * (point.y.abs() + point.z.abs()));
            let end = if last { 100.0 - point.x } else { point.x } / 100.0 + 1e-2;
            let stay = |p: &&Place| if last { p.share < 1.0 - TURNING - end } else { p.share > TURNING + end };
            assert!(places.iter().filter(stay).all(|p| p.x.y == 0.0 && p.x.z == 0.0));
        }
    }

    /// A point a little beyond the last place is the new last one; one far beyond, or before it, is not.
    #[test]
    fn edges_reach_a_point_just_beyond_their_end() {
        let place = |x: f64| Place { x: Vec3::new(x, 0.0, 0.0), share: x / 100.0, feet: [x; 2], inside: true };
        for (last, x, added) in
            [(true, 100.1, true), (false, -0.2, true), (true, 102.0, false), (true, 99.7, false), (false, 0.3, false)]
        {
            let mut places: Vec<Place> = (0..=200).map(|i| place(f64::from(i) / 2.0)).collect();
            reach(&mut places, last, &Vec3::new(x, 0.0, 0.0), 1.0);
            assert_eq!(places.len(), 201 + usize::from(added), "{x}");
            let end = if last { places.last() } else { places.first() };
            assert_eq!(end.map(|p| (p.x.x - x).abs() < 1e-12 && !p.inside), Some(added), "{x}");
        }
    }
}
