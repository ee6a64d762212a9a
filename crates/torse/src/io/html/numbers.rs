//! Numbers for people, with the digits that the terminal has; nothing in a line breaks.

use crate::io::words::numbers::{length, length_bound, length_least, number_bound, number_least};
pub(super) use crate::io::words::numbers::{number, plain};

/// Digits of numbers that were given.
const GIVEN_DIGITS: usize = 9;
/// Sizes (mm) from which a tenth of a millimetre is told, and no more.
const LARGE: f64 = 100.0;

/// A measured length.
pub(super) fn millimetres(x: f64) -> String {
    unbroken(&length(x))
}

/// A length that was given: as it was given.
pub(super) fn given(x: f64) -> String {
    format!("{}&nbsp;mm", plain(x, GIVEN_DIGITS))
}

/// A size (mm) that a shop works with, without its unit.
pub(super) fn size(x: f64) -> String {
    if x.abs() < LARGE {
        plain(x, 4)
    } else {
        format!("{x:.1}")
    }
}

/// An upper bound, rounded up so that the text stays true.
pub(super) fn upper(x: Option<f64>) -> String {
    x.map_or_else(|| "none shown".into(), number_bound)
}

/// A lower bound, rounded down.
pub(super) fn lower(x: Option<f64>) -> String {
    x.map_or_else(|| "\u{2014}".into(), number_least)
}

/// An upper bound with its unit.
pub(super) fn bound_with_unit(x: Option<f64>) -> String {
    x.map_or_else(|| upper(None), |x| unbroken(&length_bound(x)))
}

/// A lower bound with its unit.
pub(super) fn least_with_unit(x: f64) -> String {
    unbroken(&length_least(x))
}

/// A share in per cent.
pub(super) fn percent(share: f64) -> String {
    // Rounded down: an incomplete cover must not read 100 %.
    format!("{}&nbsp;%", plain((share * 10_000.0).floor() / 100.0, 4))
}

fn unbroken(text: &str) -> String {
    text.replace(' ', "&nbsp;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_to_the_safe_side() {
        assert_eq!(upper(Some(0.987_61)), "0.988");
        assert_eq!(bound_with_unit(Some(9.998)), "10&nbsp;mm");
        assert_eq!(lower(Some(412.79)), "412");
        assert_eq!(upper(Some(1.0)), "1");
        assert_eq!(upper(None), "none shown");
        assert_eq!(percent(0.999_999), "99.99&nbsp;%");
        assert_eq!(least_with_unit(412.79), "412&nbsp;mm");
    }

    #[test]
    fn tiny_bounds_are_told_in_one_style_and_never_as_nothing() {
        assert_eq!(upper(Some(2.401e-9)), "2.41e\u{2212}9");
        assert_eq!(upper(Some(0.0)), "0");
        assert_eq!(upper(Some(4.9e-306)), "1e\u{2212}12");
        assert_eq!(upper(Some(f64::from_bits(1))), "1e\u{2212}12");
    }

    #[test]
    fn sizes_for_the_shop_keep_a_tenth_of_a_millimetre() {
        assert_eq!(
            (size(5135.414), size(12.345_6), size(0.486_095)),
            ("5135.4".into(), "12.35".into(), "0.4861".into())
        );
        assert_eq!(given(0.5), "0.5&nbsp;mm");
    }
}
