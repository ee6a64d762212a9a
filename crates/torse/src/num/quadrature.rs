//! Gauss–Legendre rules on an interval.

/// Nodes and weights of a rule on `[-1, 1]`, the non-negative half (the rule is symmetric and has no node 0).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule<const HALF: usize> {
    nodes: [f64; HALF],
    weights: [f64; HALF],
}

/// Four nodes: exact for polynomials of degree 7.
pub(crate) const GAUSS_4: Rule<2> = Rule {
    nodes: [0.339_981_043_584_856_26, 0.861_136_311_594_052_6],
    weights: [0.652_145_154_862_546_1, 0.347_854_845_137_453_85],
};

/// Eight nodes: exact for polynomials of degree 15.
pub(crate) const GAUSS_8: Rule<4> = Rule {
    nodes: [0.183_434_642_495_649_8, 0.525_532_409_916_329, 0.796_666_477_413_626_7, 0.960_289_856_497_536_2],
    weights: [0.362_683_783_378_362, 0.313_706_645_877_887_3, 0.222_381_034_453_374_48, 0.101_228_536_290_376_26],
};

impl<const HALF: usize> Rule<HALF> {
    /// Approximate integral of `f` over `[a, b]`.
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (mid, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut sum = 0.0;
        for (x, w) in self.nodes.iter().zip(&self.weights) {
            sum += w * (f(mid - half * x) + f(mid + half * x));
        }
        half * sum
    }
}

/// Nodes and weights of the rule with `count` nodes (at least 1) on `[0, 1]`: exact for polynomials of degree
/// `2 count − 1`.
///
/// *Method*: Newton's iteration on the Legendre polynomial by its three-term recurrence, started at Chebyshev nodes.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    // Newton converges quadratically from these starts; 12 steps are far more than needed.
    const STEPS: usize = 12;
    let n = count.max(1);
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..STEPS {
                let (mut before, mut here) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
                }
                slope = n as f64 * (x * here - before) / (x * x - 1.0);
                x -= here / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_any_length_are_exact_up_to_their_degree() {
        for count in 1..=12 {
            let rule = gauss_legendre(count);
            for degree in 0..2 * count {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((sum * (degree + 1) as f64 - 1.0).abs() < 1e-13, "{count} nodes, degree {degree}");
            }
            let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(2 * count as i32)).sum();
            assert!((sum * (2 * count + 1) as f64 - 1.0).abs() > 1e-15 * 4f64.powi(-(count as i32)));
        }
    }

    #[test]
    fn exact_up_to_the_stated_degree_and_not_beyond() {
        for degree in 0..=16 {
            let exact = (3f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
            let e8 = GAUSS_8.integrate(1.0, 3.0, |x| x.powi(degree)) / exact - 1.0;
            let e4 = GAUSS_4.integrate(1.0, 3.0, |x| x.powi(degree)) / exact - 1.0;
            if degree <= 15 {
                assert!(e8.abs() < 1e-14, "{degree}: {e8}");
            }
            assert!((e4.abs() < 1e-14) == (degree <= 7), "{degree}: {e4}");
        }
    }
}
