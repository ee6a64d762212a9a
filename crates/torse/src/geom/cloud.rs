//! Measured points.

use super::Vec3;

/// Points as measured, in no order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions, mm.
    pub points: Vec<Vec3>,
}
