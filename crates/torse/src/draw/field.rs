//! Values for colours.

use crate::torse::strip::Strip;

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

/// A value at a place of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Index of the strip.
    pub strip: usize,
    /// Parameter of the ruling.
    pub u: f64,
    /// Parameter along it, 0 to 1.
    pub v: f64,
    /// The value.
    pub value: f64,
}

/// Steps of the grid of means along a strip and across it.
const GRID: [usize; 2] = [48, 24];

/// Means of the samples around the places of a grid on every strip; empty places take their neighbours' mean.
pub(crate) fn means(strips: &[Strip], samples: impl Iterator<Item = Sample>) -> Vec<PanelField> {
    let [along, across] = GRID;
    let (nu, nv) = (along + 1, across + 1);
    let mut sums = vec![vec![(0.0_f64, 0.0_f64); nu * nv]; strips.len()];
    for Sample { strip, u, v, value } in samples {
        let Some(s) = strips.get(strip) else { continue };
        let (a, b) = s.domain();
        let at = |x: f64, n: usize| ((x * n as f64).round().clamp(0.0, n as f64)) as usize;
        let cell = at((u - a) / (b - a), along) * nv + at(v, across);
        sums[strip][cell].0 += value;
        sums[strip][cell].1 += 1.0;
    }
    let grid = |n: usize, a: f64, b: f64| (0..=n).map(|i| a + (b - a) * i as f64 / n as f64).collect::<Vec<f64>>();
    let field = |(s, sums): (&Strip, Vec<(f64, f64)>)| {
        let mut values: Vec<Option<f64>> = sums.iter().map(|(d, n)| (*n > 0.0).then(|| d / n)).collect();
        filled(&mut values, [nu, nv]);
        let (a, b) = s.domain();
        let values = values.into_iter().map(|v| v.unwrap_or(0.0)).collect();
        PanelField { u: grid(along, a, b), v: grid(across, 0.0, 1.0), values }
    };
    strips.iter().zip(sums).map(field).collect()
}

/// Fills the holes of a grid ring by ring, each with the mean of its neighbours.
fn filled(values: &mut [Option<f64>], [nu, nv]: [usize; 2]) {
    while values.iter().any(Option::is_none) && values.iter().any(Option::is_some) {
        let before = values.to_vec();
        for (k, value) in values.iter_mut().enumerate().filter(|(_, v)| v.is_none()) {
            let (i, j) = (k / nv, k % nv);
            let around: Vec<f64> = (i.saturating_sub(1)..(i + 2).min(nu))
                .flat_map(|p| (j.saturating_sub(1)..(j + 2).min(nv)).map(move |q| p * nv + q))
                .filter_map(|k| before[k])
                .collect();
            if !around.is_empty() {
                *value = Some(around.iter().sum::<f64>() / around.len() as f64);
            }
        }
    }
}
