//! Derivatives of blocks against difference quotients.

use crate::num::gauss_newton::Block;

/// Numbers between −1 and 1 that look random.
pub fn noise(count: usize, seed: f64) -> Vec<f64> {
    (0..count)
        .map(|i| ((i as f64 + 1.3) * 12.9898 + seed * 78.233).sin() * 43758.5453)
        .map(|s| 2.0 * (s - s.floor()) - 1.0)
        .collect()
}

/// Panics where the Jacobian of a block differs from central differences.
pub fn check(block: &mut dyn Block, seed: f64) {
    let n = block.unknowns().len();
    let x = noise(n, seed);
    block.refresh(&x);
    let mut own = vec![0.0; block.private()];
    block.begin(&x, &mut own);
    let shift = noise(own.len(), seed + 1.0);
    own.iter_mut().zip(shift).for_each(|(o, s)| *o += 0.1 * s);
    check_at(block, &x, &own);
}

/// As [`check`], at given unknowns.
pub(crate) fn check_at(block: &dyn Block, x: &[f64], own: &[f64]) {
    let (n, rows, width) = (x.len(), block.rows(), x.len() + own.len());
    let mut jacobian = vec![0.0; rows * width];
    let mut residual = vec![0.0; rows];
    block.evaluate(x, own, &mut residual, Some(&mut jacobian));
    // What is written must be written anew each time.
    block.evaluate(x, own, &mut residual, Some(&mut jacobian));
    const H: f64 = 1e-6;
    let all: Vec<f64> = x.iter().chain(own).copied().collect();
    for j in 0..width {
        let side = |h: f64| {
            let mut moved = all.clone();
            moved[j] += h;
            let mut out = vec![0.0; rows];
            block.evaluate(&moved[..n], &moved[n..], &mut out, None);
            out
        };
        let (plus, minus) = (side(H), side(-H));
        for i in 0..rows {
            let quotient = (plus[i] - minus[i]) / (2.0 * H);
            let given = jacobian[i * width + j];
            assert!(
                (quotient - given).abs() < 1e-7 * (1.0 + given.abs()),
                "row {i}, column {j}: {given} against {quotient}"
            );
        }
    }
}
