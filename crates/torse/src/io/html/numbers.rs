//! Numbers for people: digits that say no more than is known.

use crate::io::json::PanelRecord;
pub(super) use crate::io::words::numbers::plain;

/// A length for people: four digits.
pub(super) fn millimetres(x: f64) -> String {
    format!("{}&nbsp;mm", plain(x, 4))
}

/// An upper bound for people: rounded up, so that the text stays true.
pub(super) fn upper(x: Option<f64>) -> String {
    x.map_or_else(|| "none shown".into(), |x| plain(rounded(x, f64::ceil), 4))
}

/// A lower bound for people: rounded down.
pub(super) fn lower(x: Option<f64>) -> String {
    x.map_or_else(|| "\u{2014}".into(), |x| plain(rounded(x, f64::floor), 4))
}

fn rounded(x: f64, round: fn(f64) -> f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let unit = 10f64.powi(x.abs().log10().floor() as i32 - 3);
    let y = round(x / unit) * unit;
    if y.is_finite() {
        y
    } else {
        x
    }
}

/// A tiny number in powers of ten, rounded up.
pub(super) fn exponent(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    // Powers of ten have no more room than normal numbers.
    let x = x.abs().max(f64::MIN_POSITIVE);
    let mut power = x.log10().floor() as i32;
    let mut mantissa = (x / 10f64.powi(power) * 10.0).ceil() / 10.0;
    if mantissa >= 10.0 {
        (mantissa, power) = (1.0, power + 1);
    }
    if power >= -2 {
        return upper(Some(x));
    }
    format!("{mantissa:.1}\u{b7}10<sup>{}</sup>", power.to_string().replace('-', "\u{2212}"))
}

/// Where a panel exceeds the tolerance.
pub(super) fn witness(panel: &PanelRecord) -> String {
    panel.witness.as_ref().map_or_else(String::new, |w| {
        let distance = w.distance.map_or_else(String::new, |d| format!(", distance {}", millimetres(d)));
        format!(" <span class=\"quiet\">(at u = {}, v = {}{distance})</span>", plain(w.uv[0], 6), plain(w.uv[1], 6))
    })
}

/// An upper bound with its unit.
pub(super) fn bound_with_unit(x: Option<f64>) -> String {
    if x.is_some() {
        format!("{}&nbsp;mm", upper(x))
    } else {
        upper(x)
    }
}

/// A share in per cent.
pub(super) fn percent(share: f64) -> String {
    // Rounded down: an incomplete cover must not read 100 %.
    format!("{}&nbsp;%", plain((share * 10_000.0).floor() / 100.0, 4))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_to_the_safe_side() {
        assert_eq!(upper(Some(0.987_61)), "0.9877");
        assert_eq!(upper(Some(0.987_600_01)), "0.9877");
        assert_eq!(lower(Some(412.79)), "412.7");
        assert_eq!(upper(Some(1.0)), "1");
        assert_eq!(upper(None), "none shown");
        assert_eq!(percent(0.999_999), "99.99&nbsp;%");
    }

    #[test]
    fn tiny_numbers_are_written_with_powers_and_rounded_up() {
        assert_eq!(exponent(2.41e-9), "2.5\u{b7}10<sup>\u{2212}9</sup>");
        assert_eq!(exponent(0.0), "0");
        assert_eq!(exponent(9.97e-10), "1.0\u{b7}10<sup>\u{2212}9</sup>");
        assert_eq!(exponent(5e-324), "2.3\u{b7}10<sup>\u{2212}308</sup>");
    }
}
