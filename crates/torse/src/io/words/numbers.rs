//! Numbers in sentences: no more digits than people read.

use crate::draw::picture::figure;
use crate::geom::Vec3;

/// Digits of numbers in notes.
const DIGITS: usize = 3;

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
pub(super) fn number(x: f64) -> String {
    plain(x, DIGITS)
}

/// A length (mm).
pub(super) fn length(x: f64) -> String {
    format!("{} mm", number(x))
}

/// A proven bound, rounded up.
pub(super) fn number_bound(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return number(x);
    }
    let unit = 10f64.powf(x.abs().log10().floor() - (DIGITS as f64 - 1.0));
    number((x / unit).ceil() * unit)
}

/// A proven bound (mm), rounded up.
pub(crate) fn length_bound(x: f64) -> String {
    format!("{} mm", number_bound(x))
}

/// An angle (rad), in degrees.
pub(super) fn angle(x: f64) -> String {
    format!("{}°", number(x.to_degrees()))
}

/// A share, in per cent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// A place in space (mm): coordinates to a micrometre, for they are looked up.
pub(super) fn place(p: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3}) mm", p.x, p.y, p.z)
}
