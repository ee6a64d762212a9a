//! Numbers in sentences: no more digits than people read.

use crate::draw::picture::figure;
use crate::geom::unit::SQUARE_METRES;
use crate::geom::Vec3;

/// Digits of numbers in sentences.
const DIGITS: usize = 3;

/// Bounds (mm, degrees or shares of a length) below which nobody asks how small they are.
const NOTHING: f64 = 1e-12;
/// Radii and distances (mm) from which there is no bend and no edge: a thousand kilometres.
const ENDLESS: f64 = 1e9;

/// Areas (mm²) from which square metres are told.
const SMALL: f64 = 1e4;

/// A number without superfluous zeros.
pub(in crate::io) fn plain(x: f64, digits: usize) -> String {
    let text = figure(x, digits);
    match text.split_once('.') {
        Some((whole, fraction)) if !fraction.contains('e') => {
            let fraction = fraction.trim_end_matches('0');
            if fraction.is_empty() {
                whole.to_string()
            } else {
                format!("{whole}.{fraction}")
            }
        }
        _ => text,
    }
}

/// A plain number.
pub(in crate::io) fn number(x: f64) -> String {
    plain(x, DIGITS)
}

/// A length (mm).
pub(in crate::io) fn length(x: f64) -> String {
    format!("{} mm", number(x))
}

/// A proven bound, rounded up; what is next to nothing is told as [`NOTHING`], which is not below it.
pub(in crate::io) fn number_bound(x: f64) -> String {
    if x > 0.0 && x < NOTHING {
        return format!("{NOTHING:e}").replace('-', "\u{2212}");
    }
    number(rounded_up(x))
}

/// Whether a radius or distance (mm) is so great that there is no bend.
pub(in crate::io) fn is_endless(x: f64) -> bool {
    x >= ENDLESS
}

/// The next number of few digits that is not below.
fn rounded_up(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let unit = 10f64.powf(x.abs().log10().floor() - (DIGITS as f64 - 1.0));
    (x / unit).ceil() * unit
}

/// A proven bound from below, rounded down.
pub(in crate::io) fn number_least(x: f64) -> String {
    number(-rounded_up(-x))
}

/// A proven bound from below (mm), rounded down.
pub(in crate::io) fn length_least(x: f64) -> String {
    format!("{} mm", number_least(x))
}

/// A proven bound (mm), rounded up; what nothing bounds is unknown, not infinite.
pub(crate) fn length_bound(x: f64) -> String {
    if x.is_finite() {
        format!("{} mm", number_bound(x))
    } else {
        "an unknown distance".into()
    }
}

/// An angle (rad), in degrees.
pub(super) fn angle(x: f64) -> String {
    format!("{}°", number(x.to_degrees()))
}

/// A proven bound of an angle (rad), in degrees.
pub(super) fn angle_bound(x: f64) -> String {
    format!("{}°", number_bound(x.to_degrees()))
}

/// An area (mm²), in the unit in which it is neither tiny nor huge.
pub(super) fn area(x: f64) -> String {
    if x < SMALL {
        return format!("{} mm²", number(x));
    }
    format!("{} m²", number(x * SQUARE_METRES))
}

/// A share, in per cent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// A share that there is at least, in per cent.
pub(super) fn percent_least(share: f64) -> String {
    format!("{} %", number_least(100.0 * share))
}

/// A place in space (mm): coordinates to a micrometre, for they are looked up.
pub(super) fn place(p: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3}) mm", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_to_the_safe_side() {
        assert_eq!(number_bound(0.999_71), "1");
        assert_eq!(number_bound(4.978_01), "4.98");
        assert_eq!(number_least(412.799_99), "412");
        assert_eq!(number_bound(1.900_1e-4), "0.000191");
        assert_eq!(number_bound(1.000_01e-9), "1.01e\u{2212}9");
        assert_eq!(number_least(1.999_9e-9), "1.99e\u{2212}9");
        assert_eq!((number_bound(0.0), number_bound(2.0)), ("0".into(), "2".into()));
        assert_eq!((number_bound(3e-306), number_bound(1.01e-12)), ("1e\u{2212}12".into(), "1.01e\u{2212}12".into()));
    }

    #[test]
    fn what_nothing_bounds_is_unknown() {
        assert_eq!(length_bound(f64::INFINITY), "an unknown distance");
        assert_eq!(length_bound(f64::NAN), "an unknown distance");
    }

    #[test]
    fn areas_have_the_unit_of_their_size() {
        assert_eq!((area(12.5), area(6.591e6)), ("12.5 mm²".into(), "6.59 m²".into()));
    }
}
