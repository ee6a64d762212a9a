//! Gauss–Legendre rules on an interval.

/// Nodes and weights of a rule on `[-1, 1]`, the non-negative half (the rule is symmetric and has no node 0).
#[derive(Clone, Copy, Debug)]
pub struct Rule<const HALF: usize> {
    nodes: [f64; HALF],
    weights: [f64; HALF],
}

/// Four nodes: exact for polynomials of degree 7.
pub const GAUSS_4: Rule<2> = Rule {
    nodes: [0.339_981_043_584_856_26, 0.861_136_311_594_052_6],
    weights: [0.652_145_154_862_546_1, 0.347_854_845_137_453_85],
};

/// Eight nodes: exact for polynomials of degree 15.
pub const GAUSS_8: Rule<4> = Rule {
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

#[cfg(test)]
mod tests {
    use super::*;

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
