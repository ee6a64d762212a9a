//! Binomial coefficients.

/// Rows of Pascal's triangle that are at hand: degrees of products of splines stay below.
const ROWS: usize = 32;

const PASCAL: [[f64; ROWS]; ROWS] = {
    let mut out = [[0.0; ROWS]; ROWS];
    let mut n = 0;
    while n < ROWS {
        out[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            out[n][k] = out[n - 1][k - 1] + out[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    out
};

/// `n` over `k` as f64; exact while below 2⁵³ (n ≤ 56), zero for `k > n`.
#[inline]
pub fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    if n < ROWS {
        return PASCAL[n][k];
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
