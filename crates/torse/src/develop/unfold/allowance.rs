//! Where the neutral fibre of a bend lies: K-factors.

/// How the depth of the neutral fibre is given.
#[derive(Clone, Debug, PartialEq)]
pub enum KFactor {
    /// Depth from the inside of the bend as a share of the thickness, 0 to 1 (ANSI): 0.5 is the middle.
    Ansi(f64),
    /// The formula of DIN 6935: `k = 0.65 + 0.5 log10(R/t)`, between 0 and 1; the depth is `k t/2`.
    Din,
    /// ANSI values at ratios of inside radius to thickness, rising; between them on straight lines, beyond them the nearest.
    Table(Vec<[f64; 2]>),
}

impl Default for KFactor {
    /// ANSI, 0.44: what sheet-metal programs begin with.
    fn default() -> Self {
        Self::Ansi(0.44)
    }
}

/// A K-factor that cannot be meant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KFactorError {
    /// A share outside 0 to 1.
    #[error("the K-factor {0} is not between 0 and 1; K is the depth of the neutral fibre from the inside, as a share of the thickness (DIN values are twice as large: give them as `din`)")]
    Share(f64),
    /// A table that does not rise.
    #[error("row {row} of the K table has R/t = {ratio}, which is not above the row before")]
    Order {
        /// Row, counted from 1.
        row: usize,
        /// Its ratio.
        ratio: f64,
    },
    /// A table without rows.
    #[error("the K table has no rows")]
    Empty,
}

impl KFactor {
    /// Checks ranges.
    ///
    /// # Errors
    /// See [`KFactorError`].
    pub(crate) fn check(&self) -> Result<(), KFactorError> {
        let share = |k: f64| if (0.0..=1.0).contains(&k) { Ok(()) } else { Err(KFactorError::Share(k)) };
        match self {
            Self::Ansi(k) => share(*k),
            Self::Din => Ok(()),
            Self::Table(rows) if rows.is_empty() => Err(KFactorError::Empty),
            Self::Table(rows) => {
                rows.iter().try_for_each(|r| share(r[1]))?;
                match rows.windows(2).position(|w| w[0][0].partial_cmp(&w[1][0]) != Some(std::cmp::Ordering::Less)) {
                    Some(k) => Err(KFactorError::Order { row: k + 2, ratio: rows[k + 1][0] }),
                    None => Ok(()),
                }
            }
        }
    }

    /// Depth of the neutral fibre from the inside as a share of the thickness, for an inside radius that is `ratio` times
    /// the thickness.
    pub fn share(&self, ratio: f64) -> f64 {
        match self {
            Self::Ansi(k) => *k,
            Self::Din if ratio > 0.0 => 0.5 * (0.65 + 0.5 * ratio.log10()).clamp(0.0, 1.0),
            Self::Din => 0.0,
            Self::Table(rows) => {
                let k = rows.partition_point(|r| r[0] <= ratio);
                match (k.checked_sub(1).and_then(|b| rows.get(b)), rows.get(k)) {
                    (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (ratio - a[0]) / (b[0] - a[0]),
                    (Some(only), None) | (None, Some(only)) => only[1],
                    (None, None) => 0.5,
                }
            }
        }
    }
}

/// Where the neutral fibre lies below a face of a sheet, which depends on how the face is bent.
#[derive(Clone, Debug, PartialEq)]
pub struct Fibre {
    /// The K-factor.
    pub k: KFactor,
    /// Thickness of the sheet, mm; 0 where the depth is the same everywhere.
    pub thickness: f64,
    /// How far (mm) the outer side of the sheet lies above the face.
    pub above: f64,
}

impl Fibre {
    /// The same depth (mm) everywhere.
    pub(crate) fn fixed(depth: f64) -> Self {
        Self { k: KFactor::Ansi(0.0), thickness: 0.0, above: -depth }
    }

    /// Whether the depth depends on the bend.
    pub fn varies(&self) -> bool {
        self.thickness > 0.0
    }

    /// Whether the face itself is laid flat.
    pub fn is_face(&self) -> bool {
        self.thickness == 0.0 && self.above == 0.0
    }

    /// Inside radius (mm) of the sheet where the face has this radius and is hollow or not, seen from outside; not positive where the
    /// sheet has no room.
    pub fn inside(&self, radius: f64, hollow: bool) -> f64 {
        if hollow {
            radius - self.above
        } else {
            radius + self.above - self.thickness
        }
    }

    /// K where the face has this radius.
    pub fn share(&self, radius: f64, hollow: bool) -> f64 {
        match self.varies() {
            true => self.k.share(self.inside(radius, hollow).max(0.0) / self.thickness),
            false => 0.0,
        }
    }

    /// Depth (mm) of the neutral fibre below the face where this has such a radius.
    pub fn depth(&self, radius: f64, hollow: bool) -> f64 {
        let share = self.share(radius, hollow);
        self.thickness * (if hollow { share } else { 1.0 - share }) - self.above
    }

    /// K where the neutral fibre lies at a depth (mm).
    pub fn share_at(&self, depth: f64, hollow: bool) -> f64 {
        let share = if self.varies() { (depth + self.above) / self.thickness } else { 0.0 };
        if hollow || !self.varies() {
            share
        } else {
            1.0 - share
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fibre_lies_by_its_share_from_the_inside_of_the_bend() {
        // The face is the middle of the sheet: either way the inside is 1 mm nearer to the centre.
        let middle = Fibre { k: KFactor::Ansi(0.3), thickness: 2.0, above: 1.0 };
        assert_eq!((middle.inside(10.0, true), middle.inside(10.0, false)), (9.0, 9.0));
        assert!((middle.depth(10.0, true) + 0.4).abs() < 1e-15 && (middle.depth(10.0, false) - 0.4).abs() < 1e-15);
        // The face is the outside.
        let outside = Fibre { above: 0.0, ..middle.clone() };
        assert!((outside.depth(10.0, true) - 0.6).abs() < 1e-15 && (outside.depth(10.0, false) - 1.4).abs() < 1e-15);
        assert!([true, false].iter().all(|h| (outside.share_at(outside.depth(10.0, *h), *h) - 0.3).abs() < 1e-15));
        assert_eq!((Fibre::fixed(1.5).depth(3.0, true), Fibre::fixed(1.5).depth(3.0, false)), (1.5, 1.5));
    }

    #[test]
    fn din_is_half_of_its_own_factor_and_tables_are_interpolated() {
        // R = t: k = 0.65, so that the fibre lies 0.325 t deep.
        assert!((KFactor::Din.share(1.0) - 0.325).abs() < 1e-15);
        assert_eq!((KFactor::Din.share(0.0), KFactor::Din.share(1e9)), (0.0, 0.5));
        let table = KFactor::Table(vec![[1.0, 0.3], [3.0, 0.4]]);
        assert!((table.share(2.0) - 0.35).abs() < 1e-15);
        assert_eq!((table.share(0.1), table.share(9.0)), (0.3, 0.4));
        assert!(table.check().is_ok() && KFactor::default().check().is_ok());
    }

    #[test]
    fn what_cannot_be_meant_is_refused() {
        assert_eq!(KFactor::Ansi(1.3).check(), Err(KFactorError::Share(1.3)));
        assert_eq!(KFactor::Table(vec![]).check(), Err(KFactorError::Empty));
        let falling = KFactor::Table(vec![[2.0, 0.3], [1.0, 0.4]]);
        assert_eq!(falling.check(), Err(KFactorError::Order { row: 2, ratio: 1.0 }));
    }
}
