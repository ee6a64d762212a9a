//! Units in which drawings and figures are written.

/// Square metres in a square millimetre.
pub(crate) const SQUARE_METRES: f64 = 1e-6;

/// A unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// Millimetre.
    #[default]
    Millimetre,
    /// Inch of 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Its length, mm.
    pub fn mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Inch => 25.4,
        }
    }

    /// Its sign in files and headings.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }

    /// A length in this unit, from mm.
    pub fn of(self, mm: f64) -> f64 {
        mm / self.mm()
    }
}
