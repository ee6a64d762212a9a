//! Cards of sheet materials: what they weigh, how tightly they bend, where their neutral fibre lies
//! (docs/algorithms/shop.md, "Materials").

use crate::develop::unfold::allowance::KFactor;

/// Least inside radius to which a material bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LeastRadius {
    /// So many thicknesses.
    Thicknesses(f64),
    /// A length, mm.
    Length(f64),
}

impl LeastRadius {
    /// The radius (mm) of a sheet of a thickness (mm).
    pub fn of(self, thickness: f64) -> f64 {
        match self {
            Self::Thicknesses(n) => n * thickness,
            Self::Length(mm) => mm,
        }
    }
}

/// What is known of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Density, kg/m³.
    pub density: f64,
    /// Least inside radius of bends; `None` where nothing is said.
    pub least_radius: Option<LeastRadius>,
    /// Depth of the neutral fibre; `None` where nothing is said.
    pub k: Option<KFactor>,
    /// What is meant by it, in words.
    pub note: String,
    /// Where the numbers come from; empty where that is not said.
    pub source: String,
}

/// Cubic millimetres of a cubic metre.
const MM3: f64 = 1e9;

impl Material {
    /// Weight (kg) of a flat part by its area (mm²) and thickness (mm).
    pub fn weight(&self, area: f64, thickness: f64) -> f64 {
        area * thickness * self.density / MM3
    }

    /// Whether a name means this material: capitals do not count, and blanks, hyphens and underscores are alike.
    pub fn is_called(&self, name: &str) -> bool {
        let plain =
            |s: &str| s.trim().chars().map(|c| if " _".contains(c) { '-' } else { c.to_ascii_lowercase() }).collect();
        let (a, b): (String, String) = (plain(&self.name), plain(name));
        a == b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_metre_of_steel_weighs_what_it_weighs() {
        let steel = Material {
            name: "Mild-Steel".into(),
            density: 7850.0,
            least_radius: Some(LeastRadius::Thicknesses(1.5)),
            k: None,
            note: String::new(),
            source: String::new(),
        };
        assert!((steel.weight(1e6, 2.0) - 15.7).abs() < 1e-12);
        assert!(steel.is_called("mild steel") && steel.is_called("MILD_STEEL") && !steel.is_called("steel"));
        assert_eq!((LeastRadius::Thicknesses(1.5).of(2.0), LeastRadius::Length(4.0).of(2.0)), (3.0, 4.0));
    }
}
