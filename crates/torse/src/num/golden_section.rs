//! Least values of functions of one variable by golden section.

/// Share of a bracket at which the function is looked at: its square is what is left of one.
const SHARE: f64 = 0.618_033_988_749_894_9;

/// The place between `a` and `b` with the least value, and that value, by so many `steps`, each of which leaves 0.618 of the bracket;
/// 40 leave the root of rounding, where a smooth minimum stops changing. *Not guaranteed*: that it is the least where the
/// function has more than one minimum between both.
pub(crate) fn least(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], steps: usize) -> (f64, f64) {
    let (mut x, mut y) = (b - SHARE * (b - a), a + SHARE * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..steps {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - SHARE * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + SHARE * (b - a);
            fy = f(y);
        }
    }
    if fx < fy {
        (x, fx)
    } else {
        (y, fy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bottom_of_a_parabola_and_the_end_of_a_slope_are_found() {
        let (x, value) = least(|t| (t - 0.3).powi(2) + 2.0, [-1.0, 4.0], 40);
        assert!((x - 0.3).abs() < 1e-7 && (value - 2.0).abs() < 1e-14);
        assert!((least(|t| -t, [-1.0, 4.0], 40).0 - 4.0).abs() < 1e-7);
    }
}
