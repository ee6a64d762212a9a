//! Faces of one body with their boundary stretches, and which stretches of neighbouring faces are one edge.

use super::boundary_stretch::{boundary_stretches, BoundaryStretch};
use super::recognised_surface::{outward, recognise, RecognisedSurface};
use crate::brep::face::Face;
use crate::geom::{BBox, Vec3};
use crate::num::parallel;
use std::collections::HashMap;
use std::ops::Range;

/// A stretch of a face with its place in the body.
#[derive(Clone, Debug)]
pub struct Half {
    /// Index of the face in the body.
    pub face: usize,
    /// Number of the loop within the face.
    pub lap: usize,
    /// The stretch.
    pub stretch: BoundaryStretch,
    /// The stretch that follows in its loop.
    pub next: usize,
    /// The stretch of the neighbouring face (or of the same one, along a seam) that is the same edge, the other way.
    pub twin: Option<usize>,
    /// Length in space, mm.
    pub length: f64,
}

/// Faces that belong together.
#[derive(Debug)]
pub struct Body<'a> {
    /// The faces.
    pub faces: Vec<&'a Face>,
    /// Their surfaces.
    pub recognised: Vec<RecognisedSurface>,
    /// All stretches, those of the first face first.
    pub halves: Vec<Half>,
    /// Diagonal, mm.
    pub size: f64,
}

/// How two faces meet along an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Angle between the outward normals half way, rad.
    pub angle: f64,
    /// Whether the edge stands out, seen from outside.
    pub convex: bool,
}

/// Share of the body within which ends of edges without common number are the same point: what files print.
const SAME_PLACE: f64 = 1e-6;
/// The same for edges that the file gives one number.
const SAME_EDGE: f64 = 1e-4;
/// Faces that meet at less than this (rad) go on smoothly: half a degree, more than what rounded files lose.
pub(crate) const SMOOTH: f64 = 0.5 * std::f64::consts::PI / 180.0;

impl<'a> Body<'a> {
    /// Finds stretches, surfaces and neighbours of faces.
    pub fn new(faces: Vec<&'a Face>) -> Self {
        Self::joined(faces, SAME_PLACE)
    }

    /// The same, where ends of edges without common number are one point within a share of the body.
    pub fn joined(faces: Vec<&'a Face>, same_place: f64) -> Self {
        let recognised = parallel::map(faces.iter(), |f| recognise(f));
        let mut bounds = BBox::empty();
        for b in faces.iter().map(|f| f.surface.bbox()) {
            bounds.include(&b.min);
            bounds.include(&b.max);
        }
        let mut laps: Vec<(usize, usize, Vec<BoundaryStretch>)> = Vec::new();
        for (k, all) in parallel::map(faces.iter(), |f| boundary_stretches(f)).into_iter().enumerate() {
            laps.extend(all.into_iter().enumerate().map(|(l, r)| (k, l, r)));
        }
        let size = bounds.diagonal();
        let laps = split_alike(&faces, laps, SAME_EDGE * size);
        let mut halves = Vec::new();
        for (face, lap, stretches) in laps {
            let (first, count) = (halves.len(), stretches.len());
            for (k, stretch) in stretches.into_iter().enumerate() {
                let length = stretch.length_estimate(faces[face]);
                halves.push(Half { face, lap, stretch, next: first + (k + 1) % count, twin: None, length });
            }
        }
        let mut body = Self { faces, recognised, halves, size };
        body.pair_by_number();
        body.pair_by_place(same_place * size);
        body
    }

    /// The neighbouring face beyond a stretch.
    pub fn beyond(&self, half: usize) -> Option<usize> {
        self.halves[half].twin.map(|t| self.halves[t].face)
    }

    /// Stretches of a face.
    pub fn of_face(&self, face: usize) -> Range<usize> {
        self.halves.partition_point(|h| h.face < face)..self.halves.partition_point(|h| h.face <= face)
    }

    /// How the faces on both sides of a stretch meet, half way along it.
    pub fn meeting(&self, half: usize) -> Option<Meeting> {
        self.meeting_at(half, 0.5)
    }

    /// The same at a share of the stretch.
    pub fn meeting_at(&self, half: usize, share: f64) -> Option<Meeting> {
        let h = &self.halves[half];
        let other = &self.halves[h.twin?];
        /// Step along the stretch for its direction.
        const STEP: f64 = 1e-4;
        let (x, uv) = h.stretch.at(self.faces[h.face], share);
        let t = h.stretch.at(self.faces[h.face], share + STEP).0 - x;
        let s = other.stretch.nearest(self.faces[other.face], &x).0;
        let (_, there) = other.stretch.at(self.faces[other.face], s);
        let (n, m) = (outward(self.faces[h.face], uv)?, outward(self.faces[other.face], there)?);
        // The way into the other face, at its border.
        let inward = t.cross(&m);
        Some(Meeting { angle: n.angle(&m), convex: inward.dot(&n) < 0.0 })
    }

    fn pair_by_number(&mut self) {
        let mut of: HashMap<u64, Vec<usize>> = HashMap::new();
        for (k, h) in self.halves.iter().enumerate().filter(|(_, h)| h.stretch.entity > 0) {
            of.entry(h.stretch.entity).or_default().push(k);
        }
        let mut groups: Vec<Vec<usize>> = of.into_values().collect();
        groups.sort();
        for group in groups {
            self.pair(&group, SAME_EDGE * self.size);
        }
    }

    /// Stretches that have no neighbour by number: sheets whose faces are not sewn.
    fn pair_by_place(&mut self, tolerance: f64) {
        let open: Vec<usize> = (0..self.halves.len()).filter(|k| self.halves[*k].twin.is_none()).collect();
        let open = self.in_order(open);
        for i in 0..open.len() {
            if self.halves[open[i].1].twin.is_none() {
                let near: Vec<usize> = within(&open[i + 1..], open[i].0 + tolerance).map(|o| o.1).collect();
                self.pair_one(open[i].1, &near, tolerance);
            }
        }
    }

    /// Stretches by where the middle between their ends is along a direction that edges of buildings and sheets are not square to:
    /// where both ends are the same within a tolerance, so is that.
    fn in_order(&self, stretches: Vec<usize>) -> Vec<(f64, usize)> {
        let oblique = Vec3::new(0.62, 0.29, 0.47);
        let place = |k: usize| {
            let [a, b] = self.ends(k);
            (0.5 * oblique.dot(&(a + b)), k)
        };
        let mut all: Vec<(f64, usize)> = stretches.into_iter().map(place).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all
    }

    fn pair(&mut self, group: &[usize], tolerance: f64) {
        for (i, k) in group.iter().enumerate() {
            if self.halves[*k].twin.is_none() {
                self.pair_one(*k, &group[i + 1..], tolerance);
            }
        }
    }

    /// The nearest of the others that runs the other way between the same ends.
    fn pair_one(&mut self, k: usize, others: &[usize], tolerance: f64) {
        let [a, b] = self.ends(k);
        let middle = self.middle(k);
        let apart = |o: usize| {
            let [p, q] = self.ends(o);
            let h = &self.halves[o];
            // Middles of parameters need not agree: the nearest point does.
            let beside = h.stretch.nearest(self.faces[h.face], &middle).1;
            (a - q).norm().max((b - p).norm()).max(beside)
        };
        let free = others.iter().copied().filter(|o| self.halves[*o].twin.is_none());
        let free = free.filter(|o| self.runs_same_way(k, *o, tolerance) != Some(true));
        let best = free.map(|o| (apart(o), o)).min_by(|x, y| x.0.total_cmp(&y.0)).filter(|b| b.0 <= tolerance);
        if let Some((_, o)) = best {
            self.halves[k].twin = Some(o);
            self.halves[o].twin = Some(k);
        }
    }

    /// Whether a stretch that ends where it begins is run through the same way by another one of the same place; `None` for runs with
    /// two ends, which tell it.
    fn runs_same_way(&self, k: usize, other: usize, tolerance: f64) -> Option<bool> {
        let [h, o] = [k, other].map(|i| &self.halves[i]);
        let [a, b] = self.ends(k);
        if (a - b).norm() > tolerance || h.length.min(o.length) <= tolerance {
            return None;
        }
        let share = |s: f64| o.stretch.nearest(self.faces[o.face], &h.stretch.at(self.faces[h.face], s).0).0;
        Some(share(0.25) < share(0.75))
    }

    fn ends(&self, k: usize) -> [Vec3; 2] {
        let h = &self.halves[k];
        h.stretch.ends(self.faces[h.face])
    }

    /// The point half way along a stretch.
    pub(crate) fn middle(&self, k: usize) -> Vec3 {
        let h = &self.halves[k];
        h.stretch.at(self.faces[h.face], 0.5).0
    }
}

/// Those at the front that are not beyond `last`.
fn within(ordered: &[(f64, usize)], last: f64) -> impl Iterator<Item = &(f64, usize)> {
    ordered.iter().take_while(move |o| o.0 <= last)
}

/// The faces of a sheet with their outsides on one side, where the file turns some of them round; `None` if all agree
/// already, or no agreement is possible (one-sided surfaces keep what they have).
pub(crate) fn oriented(body: &Body) -> Option<Vec<Face>> {
    let open = body.in_order((0..body.halves.len()).filter(|h| body.halves[*h].twin.is_none()).collect());
    let tolerance = SAME_PLACE * body.size;
    // Neighbours whose common edge runs the same way in both.
    let mut against: Vec<(usize, usize)> = Vec::new();
    for (i, &(at, h)) in open.iter().enumerate() {
        let ([a, b], middle) = (body.ends(h), body.middle(h));
        let alike = within(&open[i + 1..], at + tolerance).map(|o| o.1).find(|&g| {
            let [p, q] = body.ends(g);
            let near = (a - p).norm().max((b - q).norm()) <= tolerance;
            let beside = || body.halves[g].stretch.nearest(body.faces[body.halves[g].face], &middle).1 <= tolerance;
            near && beside() && body.runs_same_way(h, g, tolerance) != Some(false)
        });
        against.extend(alike.map(|g| (body.halves[h].face, body.halves[g].face)));
    }
    if against.is_empty() {
        return None;
    }
    let count = body.faces.len();
    let mut turned: Vec<Option<bool>> = vec![None; count];
    for start in 0..count {
        let mut queue = Vec::new();
        if turned[start].is_none() {
            turned[start] = Some(false);
            queue.push(start);
        }
        while let Some(f) = queue.pop() {
            let with = body.of_face(f).filter_map(|h| body.beyond(h)).map(|g| (g, false));
            let other =
                |(p, q): &(usize, usize)| [(*p, *q), (*q, *p)].into_iter().find(|e| e.0 == f).map(|e| (e.1, true));
            for (g, turn) in with.chain(against.iter().filter_map(other)) {
                if turned[g].is_none() {
                    turned[g] = Some(turned[f].unwrap_or(false) != turn);
                    queue.push(g);
                }
            }
        }
    }
    let face = |(f, turn): (&&Face, &Option<bool>)| {
        let mut out = (*f).clone();
        out.reversed = f.reversed != turn.unwrap_or(false);
        out
    };
    Some(body.faces.iter().zip(&turned).map(face).collect())
}

/// Stretches with one number, split where any of them ends: where the reader cut a closed face along a seam, its edges fall
/// into more pieces than those of the neighbours.
fn split_alike(
    faces: &[&Face],
    laps: Vec<(usize, usize, Vec<BoundaryStretch>)>,
    tolerance: f64,
) -> Vec<(usize, usize, Vec<BoundaryStretch>)> {
    let mut ends: HashMap<u64, Vec<Vec3>> = HashMap::new();
    let mut count: HashMap<u64, usize> = HashMap::new();
    for (face, _, runs) in &laps {
        for r in runs.iter().filter(|r| r.entity > 0) {
            ends.entry(r.entity).or_default().extend(r.ends(faces[*face]));
            *count.entry(r.entity).or_default() += 1;
        }
    }
    let split = |face: usize, run: BoundaryStretch| {
        // Two runs with equal ends are what one expects: nothing to be done.
        let Some(ends) = ends.get(&run.entity).filter(|_| count.get(&run.entity) != Some(&1)) else { return vec![run] };
        let mut out = vec![run];
        for x in ends {
            let mut next = Vec::with_capacity(out.len() + 1);
            for r in out {
                let [a, b] = r.ends(faces[face]);
                let (s, off) = r.nearest(faces[face], x);
                if off <= tolerance && (x - a).norm() > tolerance && (x - b).norm() > tolerance && s > 0.0 && s < 1.0 {
                    next.extend(r.split(s));
                } else {
                    next.push(r);
                }
            }
            out = next;
        }
        out
    };
    laps.into_iter().map(|(f, l, runs)| (f, l, runs.into_iter().flat_map(|r| split(f, r)).collect())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;

    /// A pipe in two lengths: the circle between them ends where it begins, so that only its direction tells that one of both
    /// looks inwards.
    #[test]
    fn closed_edges_tell_which_faces_are_turned() {
        let support = SupportSurface::Cylinder { frame: Frame::world(), radius: 10.0 };
        let length = |lo: f64, hi: f64| {
            Face::untrimmed(support.to_spline((0.0, std::f64::consts::TAU), (lo, hi)).expect("a spline").0)
        };
        let (low, mut high) = (length(0.0, 5.0), length(5.0, 9.0));
        let body = Body::new(vec![&low, &high]);
        assert!(oriented(&body).is_none() && (0..body.halves.len()).any(|h| body.beyond(h) == Some(1)));
        high.reversed = true;
        let body = Body::new(vec![&low, &high]);
        let turned = oriented(&body).expect("one is turned");
        assert_eq!(turned.iter().map(|f| f.reversed).collect::<Vec<_>>(), [false, false]);
    }
}
