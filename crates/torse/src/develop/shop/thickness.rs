//! Where a sheet lies beside the surface that was given, and what that makes of radii and of the neutral fibre
//! (docs/algorithms/shop.md, "Thickness").

use super::material::{LeastRadius, Material};
use crate::develop::unfold::allowance::KFactor;
use crate::patchwork::pattern::{BendSense, Pattern, ViewSide};

/// Which side of the sheet the given surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SheetSide {
    /// Its inside: the sheet lies outwards.
    Inside,
    /// The middle of the sheet.
    #[default]
    Middle,
    /// Its outside: the sheet lies inwards.
    Outside,
}

impl SheetSide {
    /// Where a sheet of a thickness (mm) begins and ends, from the surface outwards, mm.
    pub fn extent(self, thickness: f64) -> [f64; 2] {
        match self {
            Self::Inside => [0.0, thickness],
            Self::Middle => [-0.5 * thickness, 0.5 * thickness],
            Self::Outside => [-thickness, 0.0],
        }
    }

    /// Words for reports.
    pub fn words(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::Middle => "middle",
            Self::Outside => "outside",
        }
    }
}

/// A sheet beside a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Thickness, mm.
    pub thickness: f64,
    /// Which side of it the surface is.
    pub side: SheetSide,
    /// Where the neutral fibre lies.
    pub k: KFactor,
}

/// Which way a part is hollow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hollow {
    /// Somewhere towards the outside of the model.
    pub outwards: bool,
    /// Somewhere towards its inside, as round hulls are.
    pub inwards: bool,
}

impl Hollow {
    /// Which way the lines of a pattern say.
    pub(crate) fn of(pattern: &Pattern) -> Self {
        let any = |sense| pattern.bends.iter().any(|b| b.sense == sense);
        let (up, down) = (any(BendSense::Up), any(BendSense::Down));
        match pattern.view {
            ViewSide::Outside => Self { outwards: up, inwards: down },
            ViewSide::Inside => Self { outwards: down, inwards: up },
        }
    }
}

/// What a thickness makes of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartSheet {
    /// Least inside radius, mm: that of the bend lines less the depth of the inside; measured. Folds and apexes, where the
    /// surface has no radius, do not count. Infinite for flat parts, not positive where a sheet of that thickness does not
    /// fit into the curve.
    pub inside_radius: f64,
    /// Depth of the neutral fibre from the inside of bends as a share of the thickness.
    pub k: f64,
    /// Distance of the neutral fibre from the given surface, mm; positive outwards.
    pub neutral: f64,
}

impl Sheet {
    /// Where the sheet begins and ends, from the surface outwards, mm.
    pub fn extent(&self) -> [f64; 2] {
        self.side.extent(self.thickness)
    }

    /// By how much the inside radius is less than the radius of the surface, mm, for either way a part may be hollow.
    pub fn depth(&self, hollow: Hollow) -> f64 {
        let [low, high] = self.extent();
        let outwards = if hollow.outwards { high } else { f64::NEG_INFINITY };
        let inwards = if hollow.inwards { -low } else { f64::NEG_INFINITY };
        match outwards.max(inwards) {
            d if d.is_finite() => d,
            _ => 0.0,
        }
    }

    /// The greatest depth that there can be, mm: holds whichever way parts are hollow.
    pub fn greatest_depth(&self) -> f64 {
        self.depth(Hollow { outwards: true, inwards: true })
    }

    /// What the sheet makes of a part. A part that is hollow both ways has its neutral fibre in the middle.
    pub(crate) fn of(&self, pattern: &Pattern) -> PartSheet {
        let hollow = Hollow::of(pattern);
        let radius = |sense: BendSense| {
            let of = pattern.bends.iter().filter(move |b| b.sense == sense && b.angle > 0.0);
            of.flat_map(|b| b.radii).filter(|r| *r > 0.0 && r.is_finite()).fold(f64::INFINITY, f64::min)
        };
        let (outwards, inwards) = match pattern.view {
            ViewSide::Outside => (radius(BendSense::Up), radius(BendSense::Down)),
            ViewSide::Inside => (radius(BendSense::Down), radius(BendSense::Up)),
        };
        let [low, high] = self.extent();
        let inside_radius = (outwards - high).min(inwards + low);
        let share = self.k.share((inside_radius / self.thickness).max(0.0));
        let (k, neutral) = match (hollow.outwards, hollow.inwards) {
            (true, false) => (share, high - share * self.thickness),
            (false, true) => (share, low + share * self.thickness),
            _ => (0.5, 0.5 * (low + high)),
        };
        PartSheet { inside_radius, k, neutral }
    }
}

/// What stands against bending a part.
#[derive(Clone, Debug, PartialEq)]
pub enum TooTight {
    /// The sheet does not fit inside its tightest bend.
    NoRoom {
        /// Thickness, mm.
        thickness: f64,
    },
    /// A radius below the least of the material.
    BelowLeast {
        /// Least inside radius of the part, mm.
        radius: f64,
        /// Least of the material, mm.
        needed: f64,
        /// The material.
        material: String,
        /// What its least radius is made from.
        least: LeastRadius,
    },
}

/// What stands against bending a part to an inside radius (mm); `None` if nothing does.
pub(crate) fn too_tight(inside_radius: f64, thickness: f64, material: Option<&Material>) -> Option<TooTight> {
    if inside_radius <= 0.0 {
        return Some(TooTight::NoRoom { thickness });
    }
    below_least(inside_radius, thickness, material)
}

/// Share by which radii of files may fall short of a least one: they are rounded.
const ROUNDED: f64 = 1e-9;

/// What the material has against an inside radius (mm), of a sheet that is known to have room there.
pub(crate) fn below_least(inside_radius: f64, thickness: f64, material: Option<&Material>) -> Option<TooTight> {
    let material = material?;
    let least = material.least_radius?;
    let needed = least.of(thickness);
    let name = material.name.clone();
    (inside_radius < needed * (1.0 - ROUNDED)).then_some(TooTight::BelowLeast {
        radius: inside_radius,
        needed,
        material: name,
        least,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::shop::material::LeastRadius;
    use crate::patchwork::pattern::Bend;

    fn sheet(side: SheetSide, k: f64) -> Sheet {
        Sheet { thickness: 4.0, side, k: KFactor::Ansi(k) }
    }

    fn part(senses: &[(BendSense, f64)], view: ViewSide) -> Pattern {
        let bends = senses.iter().map(|(sense, r)| Bend::of(*sense, 0.1, [*r, 2.0 * r])).collect();
        Pattern { bends, view, ..Pattern::default() }
    }

    #[test]
    fn inside_radius_and_neutral_fibre_follow_from_the_side() {
        let down = part(&[(BendSense::Down, 100.0)], ViewSide::Outside);
        // A round hull whose outside is given: the sheet lies inwards, its inside is 4 mm deeper.
        let of = |side, k, p: &Pattern| sheet(side, k).of(p);
        assert_eq!(of(SheetSide::Outside, 0.4, &down), PartSheet { inside_radius: 96.0, k: 0.4, neutral: -4.0 + 1.6 });
        assert_eq!(of(SheetSide::Inside, 0.4, &down), PartSheet { inside_radius: 100.0, k: 0.4, neutral: 1.6 });
        assert_eq!(of(SheetSide::Middle, 0.5, &down).neutral, 0.0);
        // The same seen from inside, and a hollow one.
        let inside = part(&[(BendSense::Up, 100.0)], ViewSide::Inside);
        assert_eq!(of(SheetSide::Outside, 0.4, &inside), of(SheetSide::Outside, 0.4, &down));
        let hollow = part(&[(BendSense::Up, 100.0)], ViewSide::Outside);
        assert_eq!(of(SheetSide::Outside, 0.4, &hollow), PartSheet { inside_radius: 100.0, k: 0.4, neutral: -1.6 });
        // Both ways: the fibre stays in the middle.
        let both = part(&[(BendSense::Up, 50.0), (BendSense::Down, 100.0)], ViewSide::Outside);
        assert_eq!(of(SheetSide::Outside, 0.4, &both), PartSheet { inside_radius: 50.0, k: 0.5, neutral: -2.0 });
        assert_eq!(sheet(SheetSide::Outside, 0.5).greatest_depth(), 4.0);
        let flat = of(SheetSide::Middle, 0.4, &Pattern::default());
        assert!(flat.inside_radius.is_infinite() && flat.neutral == 0.0);
    }

    #[test]
    fn what_is_too_tight_is_said() {
        let steel = Material {
            name: "steel".into(),
            density: 7850.0,
            least_radius: Some(LeastRadius::Thicknesses(2.0)),
            k: None,
            note: String::new(),
            source: String::new(),
        };
        assert!(too_tight(8.1, 4.0, Some(&steel)).is_none() && too_tight(0.1, 4.0, None).is_none());
        assert!(
            matches!(too_tight(7.9, 4.0, Some(&steel)), Some(TooTight::BelowLeast { needed, .. }) if (needed - 8.0).abs() < 1e-12)
        );
        // The tip of a rolled cone.
        assert!(below_least(8.0 - 1e-14, 4.0, Some(&steel)).is_none());
        assert!(matches!(below_least(0.0, 4.0, Some(&steel)), Some(TooTight::BelowLeast { .. })));
        assert!(below_least(0.0, 4.0, None).is_none());
        assert!(too_tight(-1.0, 4.0, None) == Some(TooTight::NoRoom { thickness: 4.0 }));
    }
}
