//! Points as three numbers in a line of text.

use crate::geom::Vec3;

/// Three numbers of a line.
pub(super) fn triple<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let mut next = || words.next()?.trim().parse::<f64>().ok();
    Some(Vec3::new(next()?, next()?, next()?))
}
