//! Binomial coefficients.

/// `n` over `k` as f64; exact while below 2⁵³ (n ≤ 56), zero for `k > n`.
pub fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    let k = k.min(n - k);
    // Each partial product is itself a binomial coefficient, so the division is exact.
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pascal() {
        for n in 1..50 {
            for k in 1..n {
                let sum = binomial(n - 1, k - 1) + binomial(n - 1, k);
                assert!((binomial(n, k) - sum).abs() <= 0.0, "{n} over {k}");
            }
        }
        assert!(binomial(3, 4) == 0.0 && binomial(0, 0) == 1.0);
    }
}
