//! What a shop's sheets and material allow, and about how many panels that asks for.

use super::covered_face::{Cover, SAMPLES};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;

/// What sheet and material allow, mm; default: anything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Smallest radius to which the material bends.
    pub min_bend_radius: Option<f64>,
    /// Smallest distance along rulings between panel and regression curve.
    pub min_clearance: Option<f64>,
    /// Greatest width of a strip, square to its middle line: [`crate::patchwork::pattern::Pattern::strip_width`].
    pub max_width: Option<f64>,
    /// Greatest length of a flat pattern (of its smallest enclosing rectangle).
    pub max_length: Option<f64>,
    /// Sides of the sheet from which patterns are cut, in any order: the smallest enclosing rectangle must fit.
    pub sheet: Option<[f64; 2]>,
    /// Least mean width of a flat pattern, its area over its length; by default panels narrower than a tenth of their
    /// widest neighbour are avoided where that can be proven.
    pub min_width: Option<f64>,
}

impl Limits {
    /// Every limit with its name.
    pub fn named(&self) -> [(&'static str, Option<f64>); 7] {
        [
            ("smallest bending radius", self.min_bend_radius),
            ("smallest distance to the regression curve", self.min_clearance),
            ("greatest width", self.max_width),
            ("greatest length", self.max_length),
            ("width of the sheet", self.sheet_width()),
            ("length of the sheet", self.sheet_length()),
            ("least width", self.min_width),
        ]
    }

    /// Shorter side of the sheet.
    pub fn sheet_width(&self) -> Option<f64> {
        self.sheet.map(|[a, b]| a.min(b))
    }

    /// Longer side of the sheet.
    pub fn sheet_length(&self) -> Option<f64> {
        self.sheet.map(|[a, b]| a.max(b))
    }

    /// Greatest length that anything allows.
    pub fn longest(&self) -> Option<f64> {
        least(self.max_length, self.sheet_length())
    }

    /// Greatest width that anything allows, of strip or pattern: no pattern is wider than long.
    pub fn widest(&self) -> Option<f64> {
        least(self.max_width, self.widest_pattern())
    }

    /// Greatest width of the smallest rectangle around a pattern.
    pub(crate) fn widest_pattern(&self) -> Option<f64> {
        least(self.max_length, self.sheet_width())
    }
}

fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    [a, b].into_iter().flatten().reduce(f64::min)
}

/// Curvatures beyond this multiple of the median are those of a degenerate parametrisation.
const POLAR: f64 = 1e3;

/// The limit that asks for the most panels on a face, with about how many these are; `None` where limits ask for nothing.
///
/// *Method.* A panel within ε of a surface with curvature κ bends with at most 1/R; across a direction it may be
/// `4 √(ε/(|κ| − 1/R))` wide. It may bend in one of the principal directions, so that the product of the widths in both
/// is its area (\[SE06\], carried on to limited bending). Sheets count by their area. Not proven, an estimate.
pub(crate) fn panels_needed(face: &Face, limits: &Limits, tolerance: f64) -> Option<(&'static str, f64)> {
    let area = area_estimate(face);
    let of_radius = |radius| Some(("smallest bending radius", bent_panels(face, radius, tolerance)?.iter().product()));
    let by_radius = limits.min_bend_radius.and_then(of_radius);
    // Where only one side is limited, the other is at most as long as the face is large.
    let size = face.surface.bbox().diagonal();
    let sides = [limits.widest(), limits.longest()];
    let sheet = sides.map(|s| s.unwrap_or(size).min(size));
    let by_sheet = sides.iter().any(Option::is_some).then(|| ("size of the sheet", area / (sheet[0] * sheet[1])));
    [by_radius, by_sheet].into_iter().flatten().filter(|n| n.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// About how many panels a face asks for one after the other where they bend, and beside each other: the first is one where
/// panels that bend with a radius (mm) or more follow the face within the tolerance (mm). See [`panels_needed`].
pub(crate) fn bent_panels(face: &Face, radius: f64, tolerance: f64) -> Option<[f64; 2]> {
    let forms = Cover::of_face(face, f64::INFINITY).ok()?.region(0).forms(SAMPLES);
    let rate = |k: f64| (k.max(0.0) / tolerance).sqrt() / 4.0;
    let curvatures: Vec<[f64; 2]> = forms.iter().map(|f| f.principal().map(f64::abs)).collect();
    // Beside a pole the parametrisation says nothing.
    let mut largest: Vec<f64> = curvatures.iter().map(|c| c[0].max(c[1])).collect();
    largest.sort_by(f64::total_cmp);
    let most = POLAR * largest.get(largest.len() / 2).copied().unwrap_or(f64::INFINITY);
    let sum = curvatures
        .iter()
        .filter(|c| c[0].max(c[1]) <= most)
        .fold([0.0; 2], |[along, across], &[a, b]| [along + rate(a.max(b) - 1.0 / radius), across + rate(a.min(b))]);
    Some(sum.map(|s| (s / forms.len().max(1) as f64 * area_estimate(face).sqrt()).max(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::{knots::Knots, surface::Surface};

    /// A quarter of a cylinder of radius 100 mm and of 300 mm height.
    fn quarter() -> Face {
        let (arc, line) =
            (Knots::clamped(2, &[0.0, 1.0]).expect("knots"), Knots::clamped(1, &[0.0, 1.0]).expect("knots"));
        let points: Vec<Vec3> = [[100.0, 0.0], [100.0, 100.0], [0.0, 100.0]]
            .iter()
            .flat_map(|&[x, y]| [Vec3::new(x, y, 0.0), Vec3::new(x, y, 300.0)])
            .collect();
        let half = 0.5_f64.sqrt();
        let weights = [1.0, 1.0, half, half, 1.0, 1.0];
        Face::untrimmed(Surface::new(arc, line, &points, Some(&weights)).expect("a surface"))
    }

    #[test]
    fn bends_ask_for_several_panels_only_where_the_radius_is_larger_than_the_surface_has() {
        let face = quarter();
        let counts = |radius| bent_panels(&face, radius, 0.1).expect("an estimate");
        assert_eq!(counts(50.0), [1.0, 1.0]);
        // Flat panels of a cylinder may be 4√(εr) wide for bending on both sides of a plane.
        let [along, across] = counts(1e6);
        let width = 4.0 * (0.1_f64 * 100.0).sqrt();
        let root = (std::f64::consts::FRAC_PI_2 * 100.0 * 300.0).sqrt();
        assert!((along - root / width).abs() < 0.01 * along, "{along}");
        assert_eq!(across, 1.0);
        // Neither cuts a radius a little above the surface's own at a coarse tolerance.
        assert!(bent_panels(&face, 101.0, 10.0).expect("an estimate")[0] < 2.0);
    }
}
