//! Parts for the tests of this room.

use crate::develop::bends::{BendSpacing, Facets};
use crate::develop::strip::{pattern, StripOptions};
use crate::develop::view::Drawn;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// An arc of radius `radius` about the z-axis at height `z` between two angles, at most a half turn apart; rational.
pub fn arc(radius: f64, z: f64, from: f64, to: f64) -> Curve<4> {
    let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
    let w = half.cos();
    let at = |angle: f64, r: f64, w: f64| [w * r * angle.cos(), w * r * angle.sin(), w * z, w];
    let points = vec![at(from, radius, 1.0), at(middle, radius / w, w), at(to, radius, 1.0)];
    Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], points).expect("an arc")
}

/// A piece of a cone: radius 100 mm at the bottom, 50 at the height of 100.
pub fn cone(name: &str, from: f64, to: f64) -> Strip {
    Strip::between(name, PanelKind::Cone, &arc(100.0, 0.0, from, to), &arc(50.0, 100.0, from, to)).expect("strip")
}

/// A piece of a cylinder of radius 100 mm and height 80.
pub fn cylinder(name: &str, from: f64, to: f64) -> Strip {
    Strip::between(name, PanelKind::Cylinder, &arc(100.0, 0.0, from, to), &arc(100.0, 80.0, from, to)).expect("strip")
}

/// The only part of so many strips.
pub(crate) fn part_of(count: usize) -> Part {
    Part { name: "A".into(), first: 0, count, missing: None }
}

/// Strips as a patchwork with the pattern of the chain, seen from a side.
pub(crate) fn pattern_of(strips: Vec<Strip>, side: f64) -> (Patchwork, Pattern) {
    faceted_pattern(strips, side, None)
}

/// The same with kinks.
pub(crate) fn faceted_pattern(strips: Vec<Strip>, side: f64, facets: Option<Facets>) -> (Patchwork, Pattern) {
    let drawn = Drawn { bends: BendSpacing { facets, ..BendSpacing::default() }, ..Drawn::default() };
    let options = StripOptions { side, drawn, ..StripOptions::new(1e-3) };
    let all: Vec<&Strip> = strips.iter().collect();
    let flat = pattern(&all, 0, "A", &options).expect("a pattern");
    (Patchwork::of_strips(strips), flat)
}
