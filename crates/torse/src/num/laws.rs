//! Laws of numbers: what is enclosed, isolated and solved, for numbers that come near to what is hardest.

use super::bernstein::product;
use super::interval::Interval;
use super::least_squares::{BandMatrix, Rows};
use super::roots::isolate;
use proptest::prelude::*;

/// A whole number of up to 53 digits, of any length alike.
fn whole() -> impl Strategy<Value = i64> {
    (1u32..54, any::<u64>(), any::<bool>()).prop_map(|(length, bits, minus)| {
        let x = (bits >> (64 - length)) as i64;
        if minus {
            -x
        } else {
            x
        }
    })
}

/// Whether an interval holds a whole number, exactly, and is no wider than a few roundings of something so large.
fn holds(found: Interval, exact: i128, size: f64) -> bool {
    // Ends are numbers of binary digits: so far from zero that they have no fraction, or converted without loss.
    let (lo, hi) = (found.lo.ceil() as i128, found.hi.floor() as i128);
    lo <= exact && exact <= hi && found.width() <= 16.0 * f64::EPSILON * size + 1e-300
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn intervals_hold_the_exact_result(x in whole(), y in whole(), z in whole()) {
        let [a, b, c] = [x, y, z].map(|k| Interval::point(k as f64));
        let (p, q, r) = (i128::from(x), i128::from(y), i128::from(z));
        let size = (p * q).abs().max(r.abs()) as f64;
        prop_assert!(holds(a + b, p + q, (p.abs() + q.abs()) as f64));
        prop_assert!(holds(a - b, p - q, (p.abs() + q.abs()) as f64));
        prop_assert!(holds(a * b, p * q, size));
        prop_assert!(holds(a.sqr(), p * p, (p * p) as f64));
        prop_assert!(holds(c - a * b, r - p * q, 2.0 * size));
        prop_assert!(holds(Interval::less_product(z as f64, x as f64, y as f64), r - p * q, 2.0 * size));
        // Back from what is not exact.
        prop_assert!(a.sqr().sqrt().contains((x as f64).abs()));
        prop_assert!(y == 0 || (a / b * b).contains(x as f64));
        prop_assert!(y == 0 || b.recip().recip().contains(y as f64));
    }

    #[test]
    fn a_product_that_nearly_cancels_keeps_its_digits(x in whole(), y in whole(), off in -3i128..4) {
        // The nearest number to the product, a few units away: what is left is small beside it, and known to all digits.
        let exact = i128::from(x) * i128::from(y);
        let near = (exact + off) as f64;
        let left = near as i128 - exact;
        let found = Interval::less_product(near, x as f64, y as f64);
        let (lo, hi) = (found.lo.ceil() as i128, found.hi.floor() as i128);
        prop_assert!(lo <= left && left <= hi, "{found:?} {left}");
        prop_assert!(found.width() <= 16.0 * f64::EPSILON * left.abs() as f64 + 1e-300, "{found:?} {left}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn planted_roots_lie_in_one_part_each(
        mut roots in proptest::collection::vec(0.0..1.0f64, 1..4),
        beside in -12.0..-1.0f64, outside in 1.0..3.0f64, at_half in any::<bool>(),
    ) {
        // One root nearly doubled, one where the first cut falls, one outside or at the very end.
        roots.push((roots[0] + 10f64.powf(beside)).min(1.0 - f64::EPSILON));
        if at_half {
            roots.push(0.5);
        }
        roots.retain(|r| *r > 0.0);
        let factor = |r: &f64| [-Interval::point(*r), Interval::ONE - Interval::point(*r)];
        let b = roots.iter().chain([&outside]).fold(vec![Interval::ONE], |p, r| product(&p, &factor(r)));
        let found = isolate(&b);
        for r in &roots {
            let simple = found.simple.iter().filter(|p| p.lo < *r && *r < p.hi).count();
            let undecided = found.undecided.iter().filter(|p| p.0 <= *r && *r <= p.1).count();
            prop_assert!(simple + undecided >= 1 && simple <= 1, "{r} in {found:?}");
        }
        for p in &found.simple {
            prop_assert_eq!(roots.iter().filter(|r| p.lo < **r && **r < p.hi).count(), 1);
        }
        prop_assert!(!found.is_certain() || found.simple.len() == roots.len());
        // Roots that are well apart are told apart.
        let apart = roots.iter().enumerate().all(|(i, r)| roots[..i].iter().all(|s| (r - s).abs() > 1e-3));
        let inside = roots.iter().all(|r| *r > 1e-3 && *r < 1.0 - 1e-3) && outside > 1.0 + 1e-3;
        prop_assert!(!(apart && inside) || found.is_certain(), "{roots:?} {found:?}");
    }

    #[test]
    fn what_solves_a_band_gives_its_right_side_back(
        (columns, width) in (1usize..24).prop_flat_map(|n| (Just(n), 1..=n.min(9))),
        numbers in proptest::collection::vec(-1.0..1.0f64, 40 * 10), shift in -9.0..0.0f64,
    ) {
        let mut rows = Rows::new(columns, width);
        let mut next = numbers.iter().cycle();
        for i in 0..2 * columns {
            let (_, row) = rows.push((7 * i) % columns);
            row.iter_mut().for_each(|v| *v = next.next().copied().unwrap_or_default());
        }
        let weights: Vec<f64> = (0..rows.len()).map(|i| 0.5 + (i % 3) as f64).collect();
        let (mut order, mut a, mut one) =
            (Vec::new(), BandMatrix::zeros(columns, width), BandMatrix::zeros(columns, width));
        rows.order(&mut order);
        a.add_rows(&rows, &order, &weights);
        (0..rows.len()).for_each(|i| one.add_row(&rows, i, weights[i]));
        (0..columns).for_each(|i| [&mut a, &mut one].into_iter().for_each(|m| m.add_diagonal(i, 10f64.powf(shift))));
        let x: Vec<f64> = next.clone().take(columns).copied().collect();
        let (mut right, mut again, mut singly) = (vec![0.0; columns], vec![0.0; columns], vec![0.0; columns]);
        a.product(&x, &mut right);
        one.product(&x, &mut singly);
        let mut factor = a.clone();
        prop_assert!(factor.factorise());
        let mut found = right.clone();
        factor.solve(&mut found);
        a.product(&found, &mut again);
        for i in 0..columns {
            prop_assert!((again[i] - right[i]).abs() < 1e-11 * columns as f64, "{} {}", again[i], right[i]);
            prop_assert!((singly[i] - right[i]).abs() < 1e-12 * columns as f64);
        }
    }
}
