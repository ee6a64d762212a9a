//! A ruled developable face that is to become simpler: its rulings, and the face itself as the strip to beat.

use super::cone_strip::ruled;
use super::fewest::count;
use crate::brep::face::Face;
use crate::certify::regression::{regression as regular, RegressionVerdict};
use crate::fit::elements::given::NARROW;
use crate::reason::FaceReason;
use crate::torse::contact::ContactElement;
use crate::torse::form::PanelKind;
use crate::torse::ruled_patch::RuledStrip;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;

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
    /// Its rulings with their planes.
    pub row: Vec<ContactElement>,
    /// The face between its outermost rulings; `None` if it is not developable and regular to the last digit, as fits
    /// are.
    pub strip: Option<Strip>,
    /// Degrees and control points.
    pub size: SplineSize,
}

impl GivenFace {
    /// Takes so many rulings from a face.
    ///
    /// # Errors
    /// Why it is not a ruled developable.
    pub fn of(face: &Face, name: &str, rulings: usize, tolerance: f64) -> Result<Self, FaceReason> {
        let (patch, _) = ruled(face, tolerance)?;
        let (a, b) = patch.domain();
        let last = rulings.max(2) - 1;
        let row = (0..=last)
            .filter_map(|k| {
                let jet = patch.jet(a + (b - a) * k as f64 / last as f64);
                let element = jet.element().ok()?;
                let ends = jet.ends.map(|e| e[0]);
                Some(ContactElement { normal: element.normal, ends, radius: NARROW * jet.length(), weight: 1.0 })
            })
            .collect();
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
        Ok(Self { row, strip, size })
    }
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
