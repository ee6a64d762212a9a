//! What a shop is told besides the flat patterns.

use crate::develop::shop::material::Material;

/// Sheet and work of an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shop {
    /// What the sheet is made of.
    pub material: Option<Material>,
    /// Thickness (mm) of parts whose input has none of its own.
    pub thickness: Option<f64>,
}
