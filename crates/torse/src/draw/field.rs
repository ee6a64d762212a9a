//! Values for colours.

/// Values on a grid of a panel's patch; the panel's triangles follow the same grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelField {
    /// Parameters of the rulings, increasing.
    pub u: Vec<f64>,
    /// Parameters along the rulings, increasing.
    pub v: Vec<f64>,
    /// Values, index `i * v.len() + j`.
    pub values: Vec<f64>,
}

/// What the colours mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldMeaning {
    /// Name: "deviation", "twist".
    pub name: String,
    /// Unit.
    pub unit: String,
    /// End of the scale.
    pub limit: f64,
}
