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
    pub fn check(&self) -> Result<(), KFactorError> {
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

#[cfg(test)]
mod tests {
    use super::*;

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
