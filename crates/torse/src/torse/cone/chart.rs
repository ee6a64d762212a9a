//! Coordinates on a whole cone spline, and segments as blanks with simple patches \[LP98\].
//!
//! A point of the chain is `[x, y]`: `x = i + f` names segment `i` and the share `f` of its turn, `y` is the distance
//! (mm) along the ruling, counted so that it is continuous across joints.

use super::distance::{forward_of, Round};
use super::forms::patches;
use super::spline::{ConeSpline, Segment, Shape};
use crate::geom::Vec3;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// A chain with what its coordinates need.
#[derive(Clone, Debug)]
pub(crate) struct ConeChart<'a> {
    spline: &'a ConeSpline,
    /// `y − r` on every segment.
    slides: Vec<f64>,
}

impl<'a> ConeChart<'a> {
    /// Coordinates of a chain.
    pub fn new(spline: &'a ConeSpline) -> Self {
        let mut slides = Vec::with_capacity(spline.segments.len());
        let mut slide = 0.0;
        for (i, s) in spline.segments.iter().enumerate() {
            if i > 0 {
                let end = spline.segments[i - 1].end();
                slide += (s.start.point - end.point).dot(&end.direction);
            }
            slides.push(slide);
        }
        Self { spline, slides }
    }

    /// Number of the segment and coordinates (f, r) on it; a joint belongs to the segment behind it, except the last.
    pub fn on_segment(&self, [x, y]: [f64; 2]) -> (usize, [f64; 2]) {
        let last = self.spline.segments.len().saturating_sub(1);
        let i = (x.max(0.0) as usize).min(last);
        (i, self.within(i, [x, y]))
    }

    /// Coordinates (f, r) of a point as seen from segment `i`.
    pub fn within(&self, i: usize, [x, y]: [f64; 2]) -> [f64; 2] {
        [x - i as f64, y - self.slides.get(i).copied().unwrap_or(0.0)]
    }

    /// The point.
    pub fn point(&self, place: [f64; 2]) -> Option<Vec3> {
        let (i, [f, r]) = self.on_segment(place);
        self.spline.segments.get(i).map(|s| s.point(f, r))
    }

    /// Coordinates of the foot of `p`: the foot of the perpendicular on the chain, sought from segment `guess` on.
    /// Before the first ruling and behind the last one the nearest ruling is taken. `None` for an empty chain.
    pub fn foot(&self, p: &Vec3, guess: usize) -> Option<[f64; 2]> {
        let segments = &self.spline.segments;
        let last = segments.len().checked_sub(1)?;
        let mut i = guess.min(last);
        // Each joint's normal plane tells on which side the foot is.
        while i > 0 && forward_of(&segments[i].start, p) < 0.0 {
            i -= 1;
        }
        while i < last && forward_of(&segments[i + 1].start, p) > 0.0 {
            i += 1;
        }
        let f = share(&segments[i], p).clamp(0.0, 1.0);
        let g = segments[i].element(f);
        Some([i as f64 + f, (p - g.point).dot(&g.direction) + self.slides[i]])
    }

    /// Coordinates of the nearest of the feet that are found from every segment.
    pub fn nearest(&self, p: &Vec3) -> Option<[f64; 2]> {
        let far = |q: &[f64; 2]| self.point(*q).map_or(f64::INFINITY, |x| (x - p).norm());
        (0..self.spline.segments.len()).filter_map(|i| self.foot(p, i)).min_by(|a, b| far(a).total_cmp(&far(b)))
    }
}

/// Share of the turn at which the normal plane of a segment passes through a point.
pub(crate) fn share(segment: &Segment, p: &Vec3) -> f64 {
    let s = &segment.start;
    if let Shape::Flat { width } = segment.shape {
        return forward_of(s, p) / width;
    }
    let round = Round::of(segment);
    let across = |x: &Vec3| {
        let y = x - round.center;
        y - round.axis * y.dot(&round.axis)
    };
    let (a, b) = (across(&s.point), across(p));
    round.axis.dot(&a.cross(&b)).atan2(a.dot(&b)) / segment.shape.angle()
}

/// A segment between two circular edges as one patch of degree (2, 1): the sheet that a trimmed piece is cut from.
#[derive(Clone, Debug)]
pub struct Blank {
    /// The segment with constant edges.
    pub segment: Segment,
    /// Its patch, domain [0, 1]²: u across, v from the lower edge to the upper.
    pub patch: Surface,
}

/// Room beside the region, as a share of its extent along the rulings.
const ROOM: f64 = 0.02;

impl Blank {
    /// The blank that holds the coordinates r from `lower` to `upper` of a segment that turns less than 120°.
    ///
    /// # Errors
    /// A region that reaches the vertex.
    pub fn new(segment: &Segment, lower: f64, upper: f64) -> Result<Self, SplineError> {
        let mut room = [ROOM * (upper - lower); 2];
        if let Shape::Cone { distance, .. } = segment.shape {
            // Half of the way to the vertex stays free.
            for (room, r) in room.iter_mut().zip([lower, upper]) {
                *room = room.min(0.5 * (distance + r).abs());
            }
        }
        let mut segment = *segment;
        segment.edges = [[lower - room[0]; 3], [upper + room[1]; 3]];
        Self::of(segment)
    }

    /// The blank of a segment whose edges are constant.
    ///
    /// # Errors
    /// A segment that turns by 120° or more, or an edge that runs through its vertex.
    pub fn of(segment: Segment) -> Result<Self, SplineError> {
        let index = 0;
        let refused = || SplineError::Control { index, reason: "the piece turns too far or reaches its vertex".into() };
        let mut list = patches(&segment)?;
        let patch = list.pop().filter(|_| list.is_empty()).ok_or_else(refused)?;
        Ok(Self { segment, patch })
    }

    /// (u, v) on the patch of the coordinates (f, r).
    pub fn place(&self, [f, r]: [f64; 2]) -> [f64; 2] {
        let [lower, upper] = [self.segment.edges[0][0], self.segment.edges[1][0]];
        let v = (r - lower) / (upper - lower);
        let a = self.segment.shape.angle();
        if a == 0.0 {
            return [f, v];
        }
        // On a rational arc with end weights 1 the tangent of half the angle is linear in the parameter.
        [0.5 + 0.5 * ((0.5 * a * (f - 0.5)).tan() / (0.25 * a).tan()), v]
    }

    /// (f, r) of a place on the patch, and their derivatives by u and v (they depend on u and v alone).
    pub fn coordinates(&self, [u, v]: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let [lower, upper] = [self.segment.edges[0][0], self.segment.edges[1][0]];
        let a = self.segment.shape.angle();
        let r = (lower + (upper - lower) * v, upper - lower);
        if a == 0.0 {
            return ([u, r.0], [1.0, r.1]);
        }
        let k = (0.25 * a).tan();
        let t = k * (2.0 * u - 1.0);
        ([0.5 + 2.0 * t.atan() / a, r.0], [4.0 * k / (a * (1.0 + t * t)), r.1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::g1_element::G1Element;

    fn chain() -> ConeSpline {
        let g = G1Element::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.2, -0.3), Vec3::new(0.3, 0.0, 1.0))
            .expect("element");
        let mut out = ConeSpline::default();
        let mut start = g;
        for shape in [
            Shape::Cone { distance: 4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 },
            Shape::Cylinder { radius: -2.0, angle: 0.9 },
            Shape::Cone { distance: -5.0, cos_gamma: 0.6, sin_gamma: 0.8, angle: -0.6 },
            Shape::Cone { distance: 5.0, cos_gamma: 0.0, sin_gamma: 1.0, angle: 0.5 },
            Shape::Flat { width: 0.7 },
        ] {
            let s = Segment::new(start, shape);
            start = s.end();
            // Joints slide along their ruling.
            start.point = start.at(0.3);
            out.segments.push(s);
        }
        out
    }

    #[test]
    fn feet_are_found_from_anywhere_and_coordinates_are_continuous() {
        let spline = chain();
        let chart = ConeChart::new(&spline);
        for i in 0..5 {
            for (f, y) in [(0.2, 0.3), (0.9, -0.4), (0.5, 0.0)] {
                let place = [i as f64 + f, y];
                let p = chart.point(place).expect("point");
                let g = spline.segments[i].element(f);
                for guess in 0..5 {
                    // The wedges of such a chain are narrow only near it.
                    let q = chart.foot(&(p + g.normal * 0.05), guess).expect("foot");
                    if guess.abs_diff(i) <= 1 {
                        assert_eq!(chart.nearest(&p).map(|q| q[0] as usize), Some(i));
                        assert!((q[0] - place[0]).abs() + (q[1] - place[1]).abs() < 1e-12, "{place:?} {q:?}");
                    }
                }
            }
            if i > 0 {
                let x = i as f64;
                let (a, b) = (chart.point([x - 1e-13, 0.2]), chart.point([x, 0.2]));
                assert!((a.expect("before") - b.expect("behind")).norm() < 1e-11);
            }
        }
    }

    #[test]
    fn places_on_the_blank_are_the_same_points() {
        for s in &chain().segments {
            let blank = Blank::new(s, -0.5, 0.8).expect("blank");
            for (f, r) in [(0.0, -0.5), (0.3, 0.2), (0.5, 0.8), (1.0, 0.1)] {
                let q = blank.place([f, r]);
                assert!((blank.patch.point(q[0], q[1]) - s.point(f, r)).norm() < 1e-12, "{s:?} {f}");
                let (c, d) = blank.coordinates(q);
                assert!((c[0] - f).abs() + (c[1] - r).abs() < 1e-12);
                let (e, _) = blank.coordinates([q[0] + 1e-6, q[1]]);
                assert!(((e[0] - c[0]) / 1e-6 - d[0]).abs() < 1e-5);
            }
        }
    }
}
