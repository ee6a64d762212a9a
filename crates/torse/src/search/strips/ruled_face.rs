//! A ruled developable face that is to become simpler: its rulings, and the face itself as the strip to beat.

use super::cone_outline::PlaneOutline;
use super::cone_strip::ruled;
use super::fewest::count;
use crate::brep::face::Face;
use crate::certify::points::points;
use crate::certify::regression::{regression as regular, RegressionVerdict};
use crate::control::Control;
use crate::fit::elements::given::NARROW;
use crate::geom::Vec3;
use crate::reason::FaceReason;
use crate::torse::contact::ContactElement;
use crate::torse::form::PanelKind;
use crate::torse::ruled_patch::RuledStrip;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;
use std::ops::Range;

/// Largest twist of a face that may stay as it is, sine times diagonal as a share of the tolerance.
const TWIST: f64 = 0.01;
/// Control points along, and degree, of the simplest strips that fits make; nothing below gets simpler.
const SIMPLEST: (usize, usize) = (4, 3);

/// How large a spline surface is, in both directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplineSize {
    /// Degrees.
    pub degree: [usize; 2],
    /// Control points.
    pub control: [usize; 2],
}

/// What a face gives to the fit.
pub(crate) struct GivenFace {
    /// The face.
    pub face: Face,
    /// Its rulings with their planes.
    pub elements: Vec<ContactElement>,
    /// The face between its outermost rulings; `None` if it is not developable and regular to the last digit, as fits
    /// are.
    pub strip: Option<Strip>,
    /// Degrees and control points.
    pub size: SplineSize,
    /// Places half way between neighbouring rulings.
    between: Vec<Vec3>,
    /// Its border where u selects the ruling.
    outline: PlaneOutline,
    /// The parameter u of every ruling of the sequence.
    at: Vec<f64>,
}

/// Shares of rulings at which strips are compared with the face between its rulings.
const BETWEEN: [f64; 3] = [0.0, 0.5, 1.0];
/// Sides of the border are cut in so many parts before it is looked whether that is enough, …
const PARTS: usize = 4;
/// … and these in halves, so often at most.
const HALVINGS: usize = 10;

impl GivenFace {
    /// Takes so many rulings from a face.
    ///
    /// # Errors
    /// Why it is not a ruled developable.
    pub fn of(face: &Face, name: &str, rulings: usize, tolerance: f64) -> Result<Self, FaceReason> {
        let (patch, outline) = ruled(face, tolerance)?;
        let (a, b) = patch.domain();
        let last = rulings.max(2) - 1;
        let middle = |k: usize| {
            let jet = patch.jet(a + (b - a) * (k as f64 + 0.5) / last as f64);
            let [p, q] = jet.ends.map(|e| e[0]);
            BETWEEN.map(|s| p + (q - p) * s)
        };
        let between = (0..last).flat_map(middle).collect();
        let (at, elements) = (0..=last)
            .filter_map(|k| {
                let u = a + (b - a) * k as f64 / last as f64;
                let jet = patch.jet(u);
                let element = jet.element().ok()?;
                let ends = jet.ends.map(|e| e[0]);
                Some((u, ContactElement { normal: element.normal, ends, radius: NARROW * jet.length(), weight: 1.0 }))
            })
            .unzip();
        let (u, v) = (&face.surface.knots_u, &face.surface.knots_v);
        let size = SplineSize { degree: [u.degree(), v.degree()], control: [u.control_count(), v.control_count()] };
        let [lower, upper] = patch.sides();
        let developable = |s: &Strip| {
            s.twist_bound().is_some_and(|t| t * s.patch.bbox().diagonal() <= TWIST * tolerance)
                && (s.is_point(0)
                    || s.is_point(1)
                    || regular(s, &RegressionLimits::default()) == RegressionVerdict::Clear)
        };
        let strip = Strip::between(name, PanelKind::Torse, lower, upper).ok().filter(developable);
        Ok(Self { face: face.clone(), elements, strip, size, between, outline, at })
    }

    /// The border of what some rulings of the sequence cover of the face, as closed loops of places in space whose chords lie within
    /// `chord` (mm) of it. `None` where the last of these rulings cut it into pieces, or through a hole.
    pub fn border(&self, rulings: &Range<usize>, chord: f64) -> Option<Vec<Vec<Vec3>>> {
        let (first, last) = (rulings.start, rulings.end.checked_sub(1)?);
        let from = if first == 0 { f64::NEG_INFINITY } else { *self.at.get(first)? };
        let to = if last + 1 == self.at.len() { f64::INFINITY } else { *self.at.get(last)? };
        let mut out = Vec::new();
        for l in &self.outline.loops {
            let corners: Vec<[f64; 2]> = l.iter().map(|c| c.0).collect();
            let Some(kept) = between(between(Some(corners.clone()), from, 1.0)?, -to, -1.0)? else { continue };
            if !out.is_empty() && kept != corners {
                return None;
            }
            let n = kept.len();
            let mut places = Vec::new();
            for k in 0..n {
                self.places_along_side(kept[k], kept[(k + 1) % n], chord, &mut places);
            }
            out.push(places);
        }
        (!out.is_empty()).then_some(out)
    }

    /// How far strips are from the face half way between the rulings of its sequence, mm, sampled.
    pub fn off_between(&self, strips: &[Strip], control: &Control) -> f64 {
        points(strips, &self.between, control).worst_bound().value()
    }

    /// Places along a side of the border, without its end.
    fn places_along_side(&self, a: [f64; 2], b: [f64; 2], chord: f64, out: &mut Vec<Vec3>) {
        let at = |s: f64| self.outline.surface.point(a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s);
        let mut open: Vec<(f64, f64, usize)> =
            (0..PARTS).rev().map(|k| (k as f64 / PARTS as f64, (k + 1) as f64 / PARTS as f64, 0)).collect();
        // Sides along rulings are straight.
        if a[0] == b[0] {
            open = vec![(0.0, 1.0, HALVINGS)];
        }
        while let Some((s, t, depth)) = open.pop() {
            let m = 0.5 * (s + t);
            if depth < HALVINGS && (at(m) - (at(s) + at(t)) * 0.5).norm() > chord {
                open.extend([(m, t, depth + 1), (s, m, depth + 1)]);
            } else {
                out.push(at(s));
            }
        }
    }
}

/// The part of a closed polygon with `sign` times its first coordinate not below `from`; no polygon if there is no such part.
/// `None` where the line cuts it more than twice: it falls apart there.
fn between(polygon: Option<Vec<[f64; 2]>>, from: f64, sign: f64) -> Option<Option<Vec<[f64; 2]>>> {
    let Some(polygon) = polygon else { return Some(None) };
    let n = polygon.len();
    let above = |k: usize| sign * polygon[k % n][0] - from;
    let crossings = (0..n).filter(|k| (above(*k) < 0.0) != (above(k + 1) < 0.0)).count();
    match crossings {
        0 if above(0) < 0.0 => return Some(None),
        0 => return Some(Some(polygon)),
        2 => {}
        _ => return None,
    }
    let mut out = Vec::new();
    for k in 0..n {
        let (p, q) = (polygon[k], polygon[(k + 1) % n]);
        if above(k) >= 0.0 {
            out.push(p);
        }
        if (above(k) < 0.0) != (above(k + 1) < 0.0) {
            let s = above(k) / (above(k) - above(k + 1));
            out.push([sign * from, p[1] + s * (q[1] - p[1])]);
        }
    }
    out.dedup();
    Some((out.len() > 2).then_some(out))
}

/// Whether a strip is as simple as fits can be.
pub(crate) fn is_simplest(strip: &Strip) -> bool {
    count(strip) <= SIMPLEST.0 && strip.patch.knots_u.degree() <= SIMPLEST.1
}

/// Whether fitted strips are no simpler than a given one: neither of lower degree nor with fewer control points.
pub(crate) fn no_simpler(found: &[Strip], given: &Strip) -> bool {
    let control: usize = found.iter().map(count).sum();
    let degree = found.iter().map(|s| s.patch.knots_u.degree()).max().unwrap_or(usize::MAX);
    control >= count(given) && degree >= given.patch.knots_u.degree()
}

/// Names, degrees and control points of the strips that took the place of a face.
pub(crate) fn reached(strips: &[Strip]) -> Vec<(String, SplineSize)> {
    let size = |s: &Strip| SplineSize { degree: [s.patch.knots_u.degree(), 1], control: [count(s), 2] };
    strips.iter().map(|s| (s.name.clone(), size(s))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cone_strip::tests::slanting;
    use super::*;
    use crate::brep::face::TrimLoop;

    #[test]
    fn borders_of_parts_of_a_face_end_at_rulings_and_holes_are_not_cut() {
        let mut face = slanting();
        let ring = |k: u32| (f64::from(k) * -std::f64::consts::TAU / 32.0).sin_cos();
        let points: Vec<[f64; 2]> = (0..32).map(ring).map(|(s, c)| [0.4 + 0.05 * c, 0.625 + 0.04 * s]).collect();
        face.loops.push(TrimLoop { edge: vec![9; points.len()], points });
        let given = GivenFace::of(&face, "f", 81, 0.1).expect("a ruled face");
        let loops = |range: Range<usize>| given.border(&range, 0.01).map(|b| b.len());
        // Rulings run from u = 0.2 to 1, a hundredth from each other; the hole lies between 0.35 and 0.45.
        assert_eq!((loops(0..81), loops(0..41), loops(30..81)), (Some(2), Some(2), Some(1)));
        assert_eq!((loops(0..21), loops(20..81)), (None, None));
        let part = given.border(&(30..81), 0.01).expect("a border");
        let cut = face.surface.point(0.5, 0.6);
        let near = part[0].iter().map(|p| (p - cut).norm()).fold(f64::INFINITY, f64::min);
        let others = part[0].iter().map(|p| (p - face.surface.point(0.2, 0.7)).norm()).fold(f64::INFINITY, f64::min);
        assert!(near < 5.0 && others > 20.0, "{near} {others}");
    }
}
