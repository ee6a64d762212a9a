//! All strips of a face with the lines between them, and what is measured of them.

use super::columns::Columns;
use super::form::{Band, Foot};
use super::line::{slide_functions, slide_knots, End, Line, LinePoint, Middle, Width, SLIDES};
use super::strip::{FootGuesses, Strip};
use crate::brep::face::Face;
use crate::fit::panels::line_intersection::LEAST_LEAN;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::torse::form::Torse;
use std::collections::BTreeSet;

/// Share of the least regularity of a strip to begin with below which feet are lost: what steps lead to differs a little from
/// what they expect. With 0.93 the hull at 2 mm finds no step, with 0.15 distances became no smaller.
const LOST: f64 = 0.85;
/// Lines may slide by this share of the median half width per unit.
pub(super) const UNIT: f64 = 0.05;
/// Samples within this share of the median half width of a line may change sides.
const BESIDE: f64 = 0.8;
/// Lines pass no sample that is farther away than so many units, or higher over the tangent plane than this share of the way:
/// a face that bends round has lines behind it.
const PASSED: (f64, f64) = (9.0, 0.7);
/// Samples nearer to a line than so many units, and than this share of the way to the next line, go with it.
const CARRIED: (f64, f64) = (6.0, 0.5);
/// Share of the rulings that strips use by which they go on beyond.
const USED: f64 = 0.02;
/// Corrections of the middle of two strips.
const MIDDLE: usize = 3;
/// Factor on distances for what lines and borders take of the tolerance, at most.
const MOST_TAKEN: f64 = 1.3;
/// Ways up to this share of the tolerance take nothing.
const LEAST_WAY: f64 = 0.05;

/// A strip with what belongs to it.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub label: u32,
    pub strip: Strip,
    /// −1 where the torse's own normals look away from the face's.
    pub side: f64,
    /// Sign of the regularity, and its least size to begin with.
    pub sense: f64,
    pub least: f64,
    /// Share of that which steps may expect to be left.
    pub regular: f64,
}

/// A place on the face where a panel was too far away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Further {
    /// Label of the panel.
    pub label: u32,
    /// Parameters on the face.
    pub uv: [f64; 2],
    /// What its distance counts: the tolerance over what is left of it there.
    pub counts: f64,
}

/// A point of the face.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub x: Vec3,
    pub strip: usize,
    pub foot: Option<Foot>,
    /// Lines beside it.
    pub lines: Vec<u32>,
    /// Normal of the face, on its border: panels end there on it.
    pub up: Option<Vec3>,
    /// What its distance counts besides.
    pub counts: f64,
    /// What lines and borders beside it take of the tolerance, as a factor on its distance: panels end on normals of the
    /// face there and not on their own, and the proof counts both near by.
    pub taken: f64,
}

impl Sample {
    /// What its distance counts.
    pub fn lean(&self, foot: &Foot) -> f64 {
        self.counts.max(self.taken) * self.up.map_or(1.0, |up| lean(&up, foot))
    }
}

/// What a distance from a strip counts, at least, where the strip's panel ends on a normal of the face: its height over the
/// face as a multiple of it.
pub(super) fn lean(up: &Vec3, foot: &Foot) -> f64 {
    foot.normal.dot(up).abs().max(LEAST_LEAN).recip()
}

/// A point to which the strip of a sample on the border should come, so that it meets that of another face there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub sample: usize,
    /// The point, mm.
    pub z: Vec3,
    /// Direction of heights.
    pub up: Vec3,
    /// What a difference of heights counts.
    pub counts: f64,
    /// Distance (mm) within which the strip must be, where it hardly crosses the other one.
    pub within: f64,
}

/// Strips, lines and samples.
#[derive(Clone)]
pub(super) struct Network<'a> {
    pub face: &'a Face,
    pub tolerance: f64,
    pub members: Vec<Member>,
    pub lines: Vec<Line>,
    /// Number of vertices.
    pub vertices: usize,
    pub samples: Vec<Sample>,
    /// What a slide of one means, mm.
    pub unit: f64,
    /// Whether all strips of the face take part: else the nearest line is not always one of the sample's own strip.
    pub is_whole: bool,
    /// Whether it counts what the ends of panels take of the tolerance beside them.
    pub ends_count: bool,
    /// How wide strips should be.
    pub widths: Vec<Width>,
    /// What finer strips keep to besides.
    pub aims: Vec<Aim>,
}

impl Member {
    /// What is left of the least regularity of the strip at a foot, as a share of that to begin with, and the sign with
    /// which it counts.
    pub fn room(&self, foot: &Foot) -> (f64, f64) {
        (foot.regular * self.sense / self.least - self.regular, self.sense / self.least)
    }

    /// The way (mm) along the strip from the foot of a point, in whose direction `up` the panel ends, to that end: along the
    /// ruling and across it, as the proof goes.
    fn way(&self, foot: &Foot, up: &Vec3) -> f64 {
        let cosine = foot.normal.dot(up);
        let side = if cosine < 0.0 { -1.0 } else { 1.0 };
        let off = (up - foot.normal * cosine) * (foot.distance / (cosine * side).max(LEAST_LEAN));
        let along = off.dot(&self.strip.torse().ruling(foot.t).direction).abs();
        along + (off.norm_squared() - along * along).max(0.0).sqrt()
    }

    /// The nearest foot of a point: where a strip that goes all round overlaps itself, it has one at either end.
    pub fn foot_anywhere(&self, guesses: &FootGuesses, x: &Vec3) -> Option<Foot> {
        nearest(guesses.near(x).into_iter().filter_map(|t| self.foot(x, t)))
    }

    pub fn foot(&self, x: &Vec3, guess: f64) -> Option<Foot> {
        let foot = self.strip.foot(x, guess, self.side)?;
        (foot.regular * self.sense >= LOST * self.least).then_some(foot)
    }
}

/// The foot at the least distance.
pub(super) fn nearest(feet: impl Iterator<Item = Foot>) -> Option<Foot> {
    feet.min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))
}

impl Network<'_> {
    /// Strips some foot of which is not known, in order.
    pub fn without_feet(&self) -> BTreeSet<usize> {
        let of_samples = self.samples.iter().filter(|s| s.foot.is_none()).map(|s| s.strip);
        let of_line = |l: &Line| {
            let strips = l.strips;
            let lost = move |e: usize| l.points.iter().any(|p| p.feet[e].is_none());
            [0, 1].into_iter().filter(move |&e| lost(e)).map(move |e| strips[e]).collect::<Vec<_>>()
        };
        of_samples.chain(self.lines.iter().flat_map(of_line)).collect()
    }

    /// Columns of its unknowns, from `first` on.
    pub fn columns(&self, first: usize) -> Columns {
        let unknowns: Vec<usize> = self.members.iter().map(|m| m.strip.unknowns()).collect();
        Columns::of(&unknowns, &self.lines, self.vertices, first)
    }

    /// The torse of a strip over the rulings on which its points have their feet, and a little beyond: nothing holds it
    /// farther out.
    pub fn used(&self, k: usize) -> Option<Torse> {
        let of_lines = self.lines.iter().flat_map(|l| {
            let sides = (0..2).filter(move |&e| l.strips[e] == k);
            sides.flat_map(|e| l.points.iter().filter_map(move |p| p.feet[e]))
        });
        let feet = self.samples.iter().filter(|s| s.strip == k).filter_map(|s| s.foot).chain(of_lines);
        let (lo, hi) = feet.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), f| (a.min(f.t), b.max(f.t)));
        let more = USED * (hi - lo);
        self.members[k].strip.torse().restricted(lo - more, hi + more)
    }

    /// Tells strips where they lie on their rulings; their half widths, mm.
    pub fn lie_on_bands(&mut self) -> Vec<f64> {
        let bands: Vec<Band> = parallel::map(0..self.members.len(), |k| self.band(k));
        for (m, b) in self.members.iter_mut().zip(&bands) {
            m.strip = m.strip.clone().on_band(b);
        }
        bands.iter().map(|b| b.half_width).collect()
    }

    fn band(&self, k: usize) -> Band {
        let strip = &self.members[k].strip;
        let of_lines = self.lines.iter().flat_map(|l| {
            let points = l.points.iter();
            points.flat_map(move |p| (0..2).filter(move |&e| l.strips[e] == k).filter_map(|e| Some((p.x, p.feet[e]?))))
        });
        let of_samples = self.samples.iter().filter(|s| s.strip == k).filter_map(|s| Some((s.x, s.foot?)));
        let feet: Vec<(f64, Vec3)> =
            of_samples.chain(of_lines).map(|(x, f)| (f.t, x - f.normal * f.distance)).collect();
        let centre = feet.iter().map(|f| f.1).sum::<Vec3>() / feet.len().max(1) as f64;
        let at = match strip {
            Strip::Planes(e) => e.greville(),
            Strip::Profile(_) => vec![strip.torse().domain().0, strip.torse().domain().1],
        };
        let torse = strip.torse();
        let mut extents = vec![(f64::INFINITY, f64::NEG_INFINITY); at.len()];
        for (t, x) in feet {
            let k = at.partition_point(|a| *a < t).clamp(1, at.len() - 1);
            let k = if t - at[k - 1] < at[k] - t { k - 1 } else { k };
            let y = (x - centre).dot(&torse.ruling(t).direction);
            extents[k] = (extents[k].0.min(y), extents[k].1.max(y));
        }
        let known: Vec<usize> = (0..at.len()).filter(|&k| extents[k].0 <= extents[k].1).collect();
        let half: Vec<f64> = known.iter().map(|&k| 0.5 * (extents[k].1 - extents[k].0)).filter(|w| *w > 0.0).collect();
        let half_width = median(half).max(f64::MIN_POSITIVE);
        let ruling = |k: usize| {
            let near = known.iter().min_by_key(|j| j.abs_diff(k)).copied();
            let (lo, hi) = near.map_or((0.0, 0.0), |j| extents[j]);
            let r = torse.ruling(at[k]);
            let point = |y: f64| r.point + r.direction * (y - (r.point - centre).dot(&r.direction));
            (at[k], [point(0.5 * (lo + hi)), point(lo), point(hi)])
        };
        Band { rulings: (0..at.len()).map(ruling).collect(), half_width }
    }

    /// Adds a place on the border at which the face meets another one, whose panels are to end on `up` there; its number.
    pub fn meets_at(&mut self, label: u32, guesses: &[FootGuesses], (x, up): (&Vec3, &Vec3)) -> Option<usize> {
        let strip = self.members.iter().position(|m| m.label == label)?;
        let foot = self.members[strip].foot_anywhere(&guesses[strip], x)?;
        self.samples.push(Sample {
            x: *x,
            strip,
            foot: Some(foot),
            lines: Vec::new(),
            up: Some(*up),
            counts: 1.0,
            taken: 1.0,
        });
        Some(self.samples.len() - 1)
    }

    /// First guesses of feet on its strips.
    pub fn guesses(&self) -> Vec<FootGuesses> {
        self.members.iter().map(|m| FootGuesses::of(m.strip.torse())).collect()
    }

    /// Adds samples where panels were too far away; places without a foot count for nothing.
    pub fn add(&mut self, places: &[Further]) {
        let guesses = self.guesses();
        let sample = |f: &Further| {
            let strip = self.members.iter().position(|m| m.label == f.label)?;
            let x = self.face.surface.point(f.uv[0], f.uv[1]);
            let foot = Some(self.members[strip].foot_anywhere(&guesses[strip], &x)?);
            Some(Sample { x, strip, foot, lines: Vec::new(), up: None, counts: f.counts, taken: 1.0 })
        };
        let added: Vec<Sample> = places.iter().filter_map(sample).collect();
        self.samples.extend(added);
        self.find_neighbours();
        self.find_taken();
    }

    /// Lines near samples.
    pub fn find_neighbours(&mut self) {
        let reach = BESIDE * self.unit / UNIT;
        let lines = &self.lines;
        parallel::for_each(self.samples.iter_mut(), |s| {
            let near = |l: &Line| l.points.iter().any(|p| (p.x - s.x).norm_squared() < reach * reach);
            s.lines = (0..lines.len()).filter(|&l| near(&lines[l])).map(|l| l as u32).collect();
        });
    }

    /// The line, and its point, with which a sample goes in the program, and by which share of its ways: what is linear in
    /// slides is the largest distance over all that lies between lines, and not at places which lines may pass.
    pub fn carried(&self, s: &Sample) -> Option<(usize, &LinePoint, f64)> {
        let of_strip = s.lines.iter().map(|&l| l as usize).filter(|&l| self.lines[l].strips.contains(&s.strip));
        let near = |l: usize| {
            let away = self.lines[l].points.iter().map(|p| ((p.x - s.x).norm_squared(), p));
            away.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(d, p)| (d.sqrt(), l, p))
        };
        let mut all: Vec<(f64, usize, &LinePoint)> = of_strip.filter_map(near).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(away, l, p) = all.first()?;
        let next = all.get(1).map_or(f64::INFINITY, |n| n.0);
        let reach = (CARRIED.0 * self.unit).min(CARRIED.1 * (away + next));
        (away < reach).then(|| (l, p, 1.0 - away / reach))
    }

    /// What lines, and borders of the face, take of the tolerance of the samples beside them. It stays for the length of a
    /// step.
    pub fn find_taken(&mut self) {
        if !self.ends_count {
            return;
        }
        let (members, tolerance) = (&self.members, self.tolerance);
        // By strip: places on lines and borders, and the way there.
        let mut ends: Vec<Vec<(Vec3, f64)>> = vec![Vec::new(); members.len()];
        let mut end = |k: usize, x: &Vec3, up: &Vec3, foot: Option<Foot>| {
            let Some(foot) = foot else { return };
            let way = members[k].way(&foot, up);
            if way > LEAST_WAY * tolerance {
                ends[k].push((*x, way));
            }
        };
        for l in &self.lines {
            l.points.iter().for_each(|p| (0..2).for_each(|e| end(l.strips[e], &p.x, &p.normal, p.feet[e])));
        }
        for s in &self.samples {
            s.up.iter().for_each(|up| end(s.strip, &s.x, up, s.foot));
        }
        parallel::for_each(self.samples.iter_mut(), |s| {
            let near = ends[s.strip].iter().filter(|(x, way)| {
                let reach = 2.0 * tolerance + way;
                (x - s.x).norm_squared() <= reach * reach
            });
            let most = near.fold(0.0_f64, |m, (_, way)| m.max(*way)) / tolerance;
            s.taken = (1.0 - most * most).max(MOST_TAKEN.powi(-2)).sqrt().recip();
        });
    }

    /// Middles of strips over all lines; the error is a line that has none.
    pub fn find_middles(&mut self) -> Result<(), usize> {
        let members = &self.members;
        for (k, l) in self.lines.iter_mut().enumerate() {
            let strips = l.strips;
            let found: Option<Vec<Middle>> =
                parallel::map(l.points.iter(), |p| middle_over(strips.map(|k| &members[k]), p)).into_iter().collect();
            l.points.iter_mut().zip(found.ok_or(k)?).for_each(|(p, m)| p.middle = Some(m));
        }
        Ok(())
    }

    /// Largest distance of a sample or line from each strip, mm.
    pub fn largest_of_strips(&self) -> Vec<f64> {
        let mut out = vec![0.0_f64; self.members.len()];
        for s in &self.samples {
            out[s.strip] = s.foot.map_or(f64::INFINITY, |f| s.lean(&f) * f.distance.abs()).max(out[s.strip]);
        }
        for l in &self.lines {
            for (&k, e) in l.strips.iter().zip(0..2) {
                let far = l
                    .points
                    .iter()
                    .map(|p| p.feet[e].map_or(f64::INFINITY, |f| lean(&p.normal, &f) * f.distance.abs()));
                out[k] = far.fold(out[k], f64::max);
            }
        }
        out
    }

    /// Largest gap of every line, mm.
    pub fn gaps(&self) -> Vec<f64> {
        let gap = |p: &LinePoint| p.middle.as_ref().map_or(f64::INFINITY, |m| m.gap().abs());
        self.lines.iter().map(|l| l.points.iter().map(gap).fold(0.0, f64::max)).collect()
    }

    /// Largest distance and largest gap, in tolerances.
    pub fn measured(&self) -> [f64; 2] {
        let most = |v: Vec<f64>| v.into_iter().fold(0.0, f64::max) / self.tolerance;
        [most(self.largest_of_strips()), most(self.gaps())]
    }

    /// The network after a step; `None` where a foot is lost or a strip comes near its regression curve.
    pub fn stepped(&self, columns: &Columns, x: &[f64]) -> Option<Self> {
        let mut out = self.clone();
        let knots = slide_knots()?;
        for (line, &c) in out.lines.iter_mut().zip(&columns.slides) {
            let way = |p: &LinePoint| {
                let (first, values) = slide_functions(&knots, p.share);
                let slide: f64 = values.iter().zip(&x[c + first..c + SLIDES]).map(|(v, x)| v * x).sum();
                let mut way = p.slide * slide;
                for (v, axes) in line.vertex_ways(p) {
                    let at = columns.vertices[v];
                    way += axes[0] * x[at] + axes[1] * x[at + 1];
                }
                way * self.unit
            };
            let mut next = line.moved(self.face, way, self.tolerance)?;
            // The feet of the points before are guesses.
            for (p, old) in next.points.iter_mut().zip(&line.points) {
                p.feet = old.feet;
            }
            *line = next;
        }
        out.changed(columns, x)
    }

    /// The network after a step of its strips.
    pub fn changed(&self, columns: &Columns, x: &[f64]) -> Option<Self> {
        let mut out = self.clone();
        for (m, &c) in out.members.iter_mut().zip(&columns.strips) {
            let change: Vec<f64> = x[c..c + m.strip.unknowns()].iter().map(|v| v * self.tolerance).collect();
            m.strip = m.strip.moved(&change)?;
        }
        let members = &out.members;
        for l in &mut out.lines {
            let strips = l.strips;
            parallel::for_each(l.points.iter_mut(), |p| {
                p.feet = [0, 1].map(|e: usize| members[strips[e]].foot(&p.x, p.feet[e]?.t));
            });
        }
        let (lines, is_whole, most) = (&out.lines, out.is_whole, PASSED.0 * out.unit);
        parallel::for_each(out.samples.iter_mut(), |s| {
            let before = s.foot.map(|f| f.t);
            let (strip, guess) = placed(lines, s, is_whole, most).unwrap_or((s.strip, before));
            s.foot = guess.and_then(|t| members[strip].foot(&s.x, t));
            s.strip = strip;
        });
        if !out.without_feet().is_empty() {
            return None;
        }
        out.find_middles().ok()?;
        Some(out)
    }
}

/// The strip on whose side of the nearest line a sample lies, and the foot of the line there, if it is another one; not for samples
/// that are farther away than `most` (mm), or that the face bends away from, see [`PASSED`].
fn placed(lines: &[Line], s: &Sample, is_whole: bool, most: f64) -> Option<(usize, Option<f64>)> {
    // Of lines that meet in one point the one that leaves it most nearly towards the sample.
    const TIE: f64 = 1e-6;
    let mut best: Option<(f64, usize, usize)> = None;
    for &l in &s.lines {
        let points = &lines[l as usize].points;
        let off = |k: &usize| (points[*k].x - s.x).norm_squared();
        let k = (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        // Distance from the chords on both sides.
        let off_chord = |i: usize| {
            let (chord, way) = (points[i + 1].x - points[i].x, s.x - points[i].x);
            (way - chord * (way.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0)).norm()
        };
        let distance = (k.saturating_sub(1)..=k.min(points.len() - 2)).map(off_chord).fold(f64::INFINITY, f64::min);
        let inward = match k {
            0 => points[0].tangent,
            _ if k + 1 == points.len() => -points[k].tangent,
            _ => Vec3::zeros(),
        };
        let way = s.x - points[k].x;
        let key = distance * (1.0 - TIE * way.dot(&inward) / way.norm().max(f64::MIN_POSITIVE));
        if best.is_none_or(|b| key < b.0) {
            best = Some((key, l as usize, k));
        }
    }
    let (_, l, k) = best.filter(|b| b.0 <= most)?;
    let (line, p) = (&lines[l], &lines[l].points[k]);
    let way = s.x - p.x;
    if p.normal.dot(&way).abs() > PASSED.1 * way.norm() {
        return None;
    }
    if !is_whole && !line.strips.contains(&s.strip) {
        return None;
    }
    // Beyond an end that stays other borders go on that stay.
    let beyond = |end: usize, sign: f64| line.ends[end] == End::Fixed && sign * p.tangent.dot(&way) < 0.0;
    if !is_whole && ((k == 0 && beyond(0, 1.0)) || (k + 1 == line.points.len() && beyond(1, -1.0))) {
        return None;
    }
    let left = p.normal.cross(&p.tangent).dot(&way) >= 0.0;
    let side = usize::from(!left);
    let strip = line.strips[side];
    (strip != s.strip).then(|| (strip, p.feet[side].map(|f| f.t)))
}

/// The middle of two strips over a point of the line between them.
fn middle_over(members: [&Member; 2], p: &LinePoint) -> Option<Middle> {
    let feet = [p.feet[0]?, p.feet[1]?];
    let up = (feet[0].normal + feet[1].normal).try_normalize(0.0)?;
    middle(members, (&p.x, &up), feet)
}

/// The middle of two strips over a point, in a direction, from their feet near by.
pub(super) fn middle(members: [&Member; 2], (x, up): (&Vec3, &Vec3), mut feet: [Foot; 2]) -> Option<Middle> {
    let (mut z, mut height) = (*x, 0.0);
    for round in 0..=MIDDLE {
        if round > 0 {
            for e in 0..2 {
                feet[e] = members[e].foot(&z, feet[e].t)?;
            }
        }
        if round == MIDDLE {
            break;
        }
        height -= 0.5 * feet.iter().map(|f| f.distance / f.normal.dot(up)).sum::<f64>();
        z = x + up * height;
    }
    height.is_finite().then_some(Middle { z, feet, up: *up })
}

/// The middle one of values, 0 if there are none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
