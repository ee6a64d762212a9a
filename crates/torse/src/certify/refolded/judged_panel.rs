//! A panel as a part bent back is compared with it: by its own parameters or, where it is plane, by lengths in its plane, however
//! unevenly its parameters run.
//!
//! *Theorem.* Let S be a patch with positive weights and T what closed polygons of its parameters enclose. Where
//! [`JudgedPanel::in_plane`] answers a plane with polygons on it, what these enclose there and S(T) are within
//! [`JudgedPanel::off`] of each other in both directions, and so are both borders, place by place.
//!
//! *Proof.* L is the affine map to the plane, and A the patch whose control points are the coordinates there of those of S. With
//! the same weights `|S − L∘A|` is an average of the distances of control points from the plane, at most ρ. A piece of a border,
//! straight in the parameters, has an image under A that lies in the convex hull of its Bernstein points: these are within η of
//! its chord, and so is the image, since the distance from a segment is a convex function; every place goes straight to its nearest
//! one on the chord. A place off these ways is enclosed by every polygon of chords as often as by the image of its border.
//! The Jacobian of A has one sign on a box around T, so that this number counts the places that A takes there from within the border.
//! The polygons of chords are simple: there is one within the outer border, or none, and what holes enclose are others.
//! Places on the ways are within η of both borders. Together: ρ + η, and what rounding leaves.

use crate::certify::claim::UpperBound;
use crate::certify::simple::polygons_are_simple;
use crate::certify::tensor::{about, Tensor};
use crate::geom::segment::foot;
use crate::geom::{Frame, Vec2, Vec3};
use crate::num::interval::Interval;
use crate::spline::bezier::{Bezier, BezierPatch};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::borrow::Cow;

/// Distance of control points from a plane that is none (share of the size).
const PLANE: f64 = 1e-7;
/// Distance of borders from their chords that is small enough (share of the size).
const STRAIGHT: f64 = 1e-8;
/// Times that a piece of a border is halved at most.
const HALVES: usize = 8;
/// Times that a box is halved at most until the sign of the Jacobian shows.
const DEPTH: usize = 12;
/// Share of the size that rounding may move coordinates, as everywhere where bent parts are judged.
const ROUNDING: f64 = super::ROUNDING;

/// A panel as it is judged.
#[derive(Clone, Debug)]
pub(crate) struct JudgedPanel<'a> {
    surface: Cow<'a, Surface>,
    borders: Cow<'a, [Vec<[f64; 2]>]>,
    off: UpperBound,
    plane: Option<Frame>,
}

impl<'a> JudgedPanel<'a> {
    /// A patch and closed polygons of its parameters that bound the panel, as they are.
    pub fn by_parameters(surface: &'a Surface, borders: &'a [Vec<[f64; 2]>]) -> Self {
        let (surface, borders) = (Cow::Borrowed(surface), Cow::Borrowed(borders));
        Self { surface, borders, off: UpperBound::shown(0.0), plane: None }
    }

    /// The same panel by lengths in its plane; `None` where it is not plane, folds over, or its border crosses itself.
    pub fn in_plane(surface: &Surface, borders: &[Vec<[f64; 2]>]) -> Option<JudgedPanel<'static>> {
        let points: Vec<Vec3> = surface.control.iter().map(|c| Vec3::new(c[0], c[1], c[2]) / c[3]).collect();
        let (plane, size) = plane_through(&points)?;
        let away = points.iter().map(|p| (p - plane.origin).dot(&plane.z).abs()).fold(0.0, f64::max);
        // NaN is no plane.
        if away.partial_cmp(&(PLANE * size)).is_none_or(std::cmp::Ordering::is_gt) {
            return None;
        }
        let flat: Vec<Vec3> = points.iter().map(|p| coordinates(&plane, p).push(0.0)).collect();
        let weights: Vec<f64> = surface.control.iter().map(|c| c[3]).collect();
        let flat = Surface::new(surface.knots_u.clone(), surface.knots_v.clone(), &flat, Some(&weights)).ok()?;
        if !is_regular(&flat, borders) {
            return None;
        }
        let chords = Chords::of(&flat, borders, STRAIGHT * size)?;
        if polygons_are_simple(&chords.polygons).is_err() {
            return None;
        }
        let far = plane.origin.amax() + 2.0 * size;
        let off =
            [away, chords.off, ROUNDING * far].map(Interval::point).into_iter().fold(Interval::ZERO, |s, x| s + x);
        Some(JudgedPanel {
            surface: Cow::Owned(affine_patch(&plane, &chords.polygons)?),
            borders: Cow::Owned(chords.polygons),
            off: UpperBound::shown(off.hi),
            plane: Some(plane),
        })
    }

    /// The patch by whose parameters places are told.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Closed polygons of its parameters that bound the panel.
    pub fn borders(&self) -> &[Vec<[f64; 2]>] {
        &self.borders
    }

    /// How far (mm) this is from the panel, in both directions.
    pub fn off(&self) -> UpperBound {
        self.off
    }

    /// Parameters of the place in the plane below a point; `None` where the panel is judged by parameters of its own.
    pub fn in_its_plane(&self, x: &Vec3) -> Option<[f64; 2]> {
        self.plane.as_ref().map(|plane| coordinates(plane, x).into())
    }
}

/// Coordinates of the place in a plane below a point, mm.
fn coordinates(plane: &Frame, x: &Vec3) -> Vec2 {
    Vec2::new((x - plane.origin).dot(&plane.x), (x - plane.origin).dot(&plane.y))
}

/// A plane through the points that lie farthest apart, about, and the size of all, mm; `None` where they lie on a line.
fn plane_through(points: &[Vec3]) -> Option<(Frame, f64)> {
    let origin = *points.first()?;
    let farthest = |of: &dyn Fn(&Vec3) -> f64| points.iter().copied().max_by(|a, b| of(a).total_cmp(&of(b)));
    let x = farthest(&|p| (p - origin).norm())? - origin;
    let size = x.norm();
    let x = x.try_normalize(0.0)?;
    let off = |p: &Vec3| (p - origin) - x * (p - origin).dot(&x);
    let y = farthest(&|p| off(p).norm()).map(|p| off(&p)).filter(|y| y.norm() > PLANE * size)?;
    let y = (y - x * y.dot(&x)).normalize();
    Some((Frame { origin, x, y, z: x.cross(&y) }, size))
}

/// Whether the Jacobian of a plane patch has one sign on a box around polygons of its parameters.
fn is_regular(flat: &Surface, borders: &[Vec<[f64; 2]>]) -> bool {
    let range = |d: usize| {
        let ends = borders.iter().flatten().map(|p| p[d]);
        ends.fold(None, |r: Option<Interval>, x| Some(r.map_or(Interval::point(x), |r| r.hull(Interval::point(x)))))
    };
    let (Some(u), Some(v)) = (range(0), range(1)) else { return false };
    let tensor = Tensor::new([&flat.knots_u, &flat.knots_v], about(&flat.control, [0.0; 3]));
    let mut open = vec![([u, v], 0)];
    let mut sign = None;
    while let Some((box_, depth)) = open.pop() {
        let jet = tensor.affine_over(box_);
        let here = (jet.du[0] * jet.dv[1] - jet.du[1] * jet.dv[0]).sign();
        if here == 0 && depth < DEPTH {
            let d = depth % 2;
            let m = box_[d].mid();
            for half in [Interval::new(box_[d].lo, m), Interval::new(m, box_[d].hi)] {
                let mut part = box_;
                part[d] = half;
                open.push((part, depth + 1));
            }
        } else if here == 0 || *sign.get_or_insert(here) != here {
            return false;
        }
    }
    sign.is_some()
}

/// The plane as a patch whose parameters are lengths in it, over a box around polygons.
fn affine_patch(plane: &Frame, polygons: &[Vec<[f64; 2]>]) -> Option<Surface> {
    let knots = |d: usize| {
        let all = || polygons.iter().flatten().map(|p| p[d]);
        Knots::clamped(1, &[all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]).ok()
    };
    let (us, vs) = (knots(0)?, knots(1)?);
    let at = |x: f64, y: f64| plane.origin + plane.x * x + plane.y * y;
    let corners: Vec<Vec3> =
        us.breaks().iter().flat_map(|x| vs.breaks().into_iter().map(move |y| (*x, y))).map(|(x, y)| at(x, y)).collect();
    Surface::new(us, vs, &corners, None).ok()
}

/// Images of polygons of parameters on a plane patch, as polygons there.
struct Chords {
    polygons: Vec<Vec<[f64; 2]>>,
    /// How far (mm) images are from their chords.
    off: f64,
}

impl Chords {
    fn of(flat: &Surface, borders: &[Vec<[f64; 2]>], near: f64) -> Option<Self> {
        let (patches, breaks) = (flat.bezier_patches(), [flat.knots_u.breaks(), flat.knots_v.breaks()]);
        let mut out = Self { polygons: Vec::with_capacity(borders.len()), off: 0.0 };
        for border in borders {
            let mut polygon = Vec::with_capacity(border.len());
            for (k, p) in border.iter().enumerate() {
                let q = &border[(k + 1) % border.len()];
                if p == q {
                    continue;
                }
                let shares = shares_between_knots([p, q], &breaks);
                for w in shares.windows(2) {
                    let ends = [w[0], w[1]].map(|s| [0, 1].map(|d: usize| p[d] * (1.0 - s) + q[d] * s));
                    let image = image(&patches, &breaks, ends)?;
                    out.follow(&image, (near, HALVES), &mut polygon);
                }
            }
            out.polygons.push(polygon);
        }
        out.off.is_finite().then_some(out)
    }

    /// Adds the first ends of chords of a piece that are near enough to it.
    fn follow(&mut self, image: &Bezier<4>, (near, halves): (f64, usize), polygon: &mut Vec<[f64; 2]>) {
        let places: Vec<Vec2> = image.control().iter().map(|c| Vec2::new(c[0], c[1]) / c[3]).collect();
        let (first, last) = (&places[0], &places[places.len() - 1]);
        let off = places.iter().map(|p| (foot(first, last, p) - p).norm()).fold(0.0, super::worse);
        if off > near && halves > 0 {
            let (one, other) = image.split(0.5);
            self.follow(&one, (near, halves - 1), polygon);
            self.follow(&other, (near, halves - 1), polygon);
            return;
        }
        self.off = super::worse(self.off, off);
        polygon.push((*first).into());
    }
}

/// Shares of a segment of the parameter plane at which it crosses knot lines, with both ends.
fn shares_between_knots([p, q]: [&[f64; 2]; 2], breaks: &[Vec<f64>; 2]) -> Vec<f64> {
    let mut out = vec![0.0, 1.0];
    for (d, all) in breaks.iter().enumerate() {
        let crossed = all.iter().filter(|t| **t > p[d].min(q[d]) && **t < p[d].max(q[d]));
        out.extend(crossed.map(|t| (t - p[d]) / (q[d] - p[d])));
    }
    out.sort_by(f64::total_cmp);
    out.dedup();
    out
}

/// The image of a segment that crosses no knot line.
fn image(patches: &[BezierPatch], breaks: &[Vec<f64>; 2], [p, q]: [[f64; 2]; 2]) -> Option<Bezier<4>> {
    let piece = |d: usize| {
        let inner = &breaks[d][1..breaks[d].len() - 1];
        inner.partition_point(|t| *t <= 0.5 * (p[d] + q[d]))
    };
    let patch = patches.get(piece(0) * (breaks[1].len() - 1) + piece(1))?;
    let local = |x: &[f64; 2]| {
        let share = |x: f64, (a, b): (f64, f64)| (x - a) / (b - a);
        [share(x[0], patch.u), share(x[1], patch.v)]
    };
    Some(patch.compose(&Bezier::new(vec![local(&p), local(&q)])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A plane whose parameters run unevenly, in a rational net with an inner knot in each direction.
    fn net(steps: [f64; 4], weights: &[f64], bend: f64) -> Surface {
        let knots = || Knots::clamped(2, &[0.0, 0.3, 1.0]).expect("knots");
        let at = |x: f64, y: f64| Vec3::new(x + 0.2 * y, y - 0.1 * x, 0.5 * x + 0.2 * y + bend * x * y);
        let points: Vec<Vec3> = steps.iter().flat_map(|x| steps.map(|y| at(*x, y))).collect();
        Surface::new(knots(), knots(), &points, Some(weights)).expect("a surface")
    }

    fn uneven(bend: f64) -> Surface {
        let weights: Vec<f64> = (0..16).map(|k| 1.0 + 0.1 * f64::from(k % 5)).collect();
        net([0.0, 5.0, 60.0, 100.0], &weights, bend)
    }

    fn borders() -> [Vec<[f64; 2]>; 2] {
        let outer = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.2, 0.9], [0.0, 0.5]];
        [outer, vec![[0.3, 0.3], [0.3, 0.6], [0.7, 0.4]]]
    }

    /// Greatest distance (mm) of places of borders from those that they are judged by, and of places from the plane.
    fn farthest(surface: &Surface, judged: &JudgedPanel) -> [f64; 2] {
        let on_border = |x: &Vec3, border: &[[f64; 2]]| {
            let corner = |p: &[f64; 2]| judged.surface().point(p[0], p[1]);
            let sides = border.iter().zip(border.iter().cycle().skip(1));
            sides.map(|(p, q)| (foot(&corner(p), &corner(q), x) - x).norm()).fold(f64::INFINITY, f64::min)
        };
        let mut out = [0.0_f64; 2];
        for (border, polygon) in borders().iter().zip(judged.borders()) {
            for (p, q) in border.iter().zip(border.iter().cycle().skip(1)) {
                for k in 0..=20 {
                    let s = f64::from(k) / 20.0;
                    let x = surface.point(p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s);
                    let [a, b] = judged.in_its_plane(&x).expect("its plane");
                    let beside = (judged.surface().extended_jet(a, b).p - x).norm();
                    out = [out[0].max(on_border(&x, polygon)), out[1].max(beside)];
                }
            }
        }
        out
    }

    #[test]
    fn a_plane_is_told_by_lengths_whatever_its_parameters() {
        let surface = uneven(0.0);
        let judged = JudgedPanel::in_plane(&surface, &borders()).expect("a plane");
        assert!(judged.off().value() < 1e-4, "{:?}", judged.off());
        let [far, beside] = farthest(&surface, &judged);
        assert!(far <= judged.off().value() && beside < 1e-9, "{far:e} {beside:e} {:?}", judged.off());
        assert!(judged.borders()[0].len() > 5, "slanted sides of an uneven plane are no straight lines");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Whatever the net, and the plane be it bent by a little: borders are as near as is said.
        #[test]
        fn borders_are_within_what_is_said(
            gaps in prop::array::uniform3(1.0..60.0f64),
            weights in prop::collection::vec(0.7..1.4f64, 16),
            bend in 0.0..1e-9f64,
        ) {
            let steps = [0.0, gaps[0], gaps[0] + gaps[1], gaps[0] + gaps[1] + gaps[2]];
            let surface = net(steps, &weights, bend);
            if let Some(judged) = JudgedPanel::in_plane(&surface, &borders()) {
                let [far, beside] = farthest(&surface, &judged);
                let off = judged.off().value();
                prop_assert!(far <= off && beside <= off, "{far:e} {beside:e} {off:e}");
            }
        }
    }

    #[test]
    fn what_is_not_plane_or_folds_is_told_by_parameters_alone() {
        let square = [vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        assert!(JudgedPanel::in_plane(&uneven(1e-6), &square).is_none());
        assert!(JudgedPanel::in_plane(&uneven(1e-12), &square).is_some());
        let surface = uneven(1e-6);
        let as_it_is = JudgedPanel::by_parameters(&surface, &square);
        assert!(as_it_is.off().value() == 0.0 && as_it_is.in_its_plane(&Vec3::zeros()).is_none());
        // A net that runs back over itself.
        let knots = || Knots::clamped(1, &[0.0, 0.5, 1.0]).expect("knots");
        let points: Vec<Vec3> =
            [0.0, 10.0, 4.0].iter().flat_map(|x| [0.0, 5.0, 10.0].map(|y| Vec3::new(*x, y, 0.0))).collect();
        let folded = Surface::new(knots(), knots(), &points, None).expect("a surface");
        assert!(JudgedPanel::in_plane(&folded, &square).is_none());
        // A border that crosses itself.
        let crossed = [vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]];
        assert!(JudgedPanel::in_plane(&uneven(0.0), &crossed).is_none());
    }
}
