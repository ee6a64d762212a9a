//! Bands between other levels, for strips that meet: strips between common seams err otherwise than strips that were
//! laid for themselves, mostly more at the ends of a sequence and less in its middle (B3.6 of the dual method).

use crate::brep::face::Face;
use crate::search::cover::{Rise, State};
use crate::spline::field::Field;
use std::collections::HashMap;
use std::sync::Arc;

/// Bands that follow each other along one level function, laid anew.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Labels in the order of levels.
    pub labels: Vec<u32>,
    /// Levels between which they lie, one more than labels.
    pub levels: Vec<f64>,
    /// Error of every strip as a share of the tolerance; infinite where there is none.
    pub shares: Vec<f64>,
}

/// Strips whose shares stay below this have room enough for the proof.
const ENOUGH: f64 = 0.97;

impl Row {
    /// Largest share.
    pub fn worst(&self) -> f64 {
        self.shares.iter().copied().fold(0.0, f64::max)
    }

    /// Levels between which all strips would have the same share by the square law, where that is enough and they have
    /// not.
    fn even(&self) -> Option<Vec<f64>> {
        if self.worst() <= ENOUGH || !self.worst().is_finite() {
            return None;
        }
        let bands: Vec<[f64; 3]> =
            self.levels.windows(2).zip(&self.shares).map(|(w, share)| [w[0], w[1], *share]).collect();
        let mean = self.shares.iter().map(|s| s.sqrt()).sum::<f64>() / self.shares.len() as f64;
        (mean * mean <= ENOUGH).then(|| Rise::of_bands(&bands).levels(self.labels.len()))
    }
}

/// The state with the bands of uneven rows between levels for which they would be even. The torses stay those of the old
/// bands. `None` where there is no such row, or where bands would come out in pieces.
pub(crate) fn evened(face: &Face, state: &State, rows: &[Row]) -> Option<State> {
    let mut out = state.clone();
    let mut any = false;
    for (row, levels) in rows.iter().filter_map(|r| Some((r, r.even()?))) {
        let field = Arc::clone(state.bands.get(row.labels.first()?)?);
        cut_anew(face, &mut out, row, &levels, &field);
        any = true;
        if row.labels.iter().any(|&l| out.partition.components(&out.partition.region(l), |_, _| true).len() != 1) {
            return None;
        }
    }
    any.then_some(out)
}

/// Gives the bands of a row other levels.
fn cut_anew(face: &Face, state: &mut State, row: &Row, levels: &[f64], field: &Field) {
    let whole = row.labels[row.labels.len() - 1];
    for l in &mut state.partition.labels {
        if row.labels.contains(l) {
            *l = whole;
        }
    }
    let mut named: HashMap<u32, u32> = HashMap::new();
    for (&level, &label) in levels[1..].iter().zip(&row.labels[..row.labels.len() - 1]) {
        let fresh = state.partition.fresh_label();
        state.cut(&face.surface, whole, fresh, |p| level - field.value(p));
        named.insert(fresh, label);
    }
    for l in &mut state.partition.labels {
        if let Some(label) = named.get(l) {
            *l = *label;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_even_where_that_is_enough() {
        let row =
            |shares: &[f64]| Row { labels: vec![3, 1, 2], levels: vec![0.0, 1.0, 2.0, 3.0], shares: shares.into() };
        let levels = row(&[0.64, 0.64, 1.21]).even().expect("levels");
        // Rise 0.8, 0.8, 1.1: each a third of 2.7.
        let want = [0.0, 0.9 / 0.8, 2.0 + 0.2 / 1.1, 3.0];
        assert!(levels.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-3), "{levels:?}");
        assert_eq!(row(&[0.9, 0.9, 0.9]).even(), None);
        assert_eq!(row(&[1.1, 0.9, 1.0]).even(), None);
        assert_eq!(row(&[0.5, 0.5, f64::INFINITY]).even(), None);
    }
}
