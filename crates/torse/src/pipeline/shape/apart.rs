//! How far a shape is from what it was made of: strips that were taken over, and curves as they were given. Nothing is asked of
//! that, since what is not held goes where it is fair.

use super::targets::Asked;
use crate::certify::claim::{Claim, Subject, UpperBound, What};
use crate::certify::nearness::{distance_from, Target};
use crate::control::Control;
use crate::design::composite::Session;
use crate::geom::segment::share;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::torse::strip::Strip;

/// Places of a curve at which it is compared with another one.
const PLACES: usize = 200;

/// Proven distances of strips from those that they were made of, both ways: of each, and the largest.
pub(super) fn from_taken(strips: &[Strip], session: &Session, asked: &Asked, control: &Control) -> Vec<Claim> {
    let faces = &asked.taken.faces;
    // Strips of the job itself come first.
    let own = session.composite().strips.len().saturating_sub(faces.len());
    let taken = session.composite().strips.iter().skip(own).zip(faces);
    let bound = |(k, face): (usize, &Option<_>)| {
        let Some(face) = face else { return UpperBound::UNKNOWN };
        let target = Target::Faces(std::slice::from_ref(face));
        let found = distance_from(&[&strips[k]], target, asked.options.tolerance, control);
        found.there.max(found.back)
    };
    let place = |name: &str| strips.iter().position(|s| s.name == name);
    let taken = taken.filter_map(|(s, face)| Some((place(&s.name)?, face)));
    let bounds: Vec<(usize, UpperBound)> = taken.map(|(k, face)| (k, bound((k, face)))).collect();
    let whole = (!bounds.is_empty())
        .then(|| Claim::at_most(What::FromTaken, Subject::Whole, UpperBound::largest(bounds.iter().map(|b| b.1))));
    let of = |(k, bound): &(usize, UpperBound)| Claim::at_most(What::FromTaken, Subject::Panel(*k), *bound);
    whole.into_iter().chain(bounds.iter().map(of)).collect()
}

/// The largest measured distance, both ways, of the curves from what the job gives them as; nothing where all are fixed.
pub(super) fn curves_moved(session: &Session, asked: &Asked) -> Option<Claim> {
    let own = session.composite().curves.iter().take(asked.own).enumerate().filter(|(_, c)| !c.fixed);
    let moved = own.filter_map(|(k, given)| Some(apart(&given.curve, &session.curve(k)?)));
    moved.reduce(f64::max).map(|far| Claim::measured(What::CurvesMoved, Subject::Whole, far))
}

/// Largest distance (mm) of places of either curve from chords of the other.
fn apart(a: &Curve<3>, b: &Curve<3>) -> f64 {
    let places = |c: &Curve<3>| -> Vec<Vec3> {
        let (from, to) = c.domain();
        (0..=PLACES).map(|k| Vec3::from(c.point(from + (to - from) * k as f64 / PLACES as f64))).collect()
    };
    let (a, b) = (places(a), places(b));
    let away = |p: &Vec3, others: &[Vec3]| others.windows(2).map(|w| to_chord(p, w)).fold(f64::INFINITY, f64::min);
    let farthest = |these: &[Vec3], others: &[Vec3]| these.iter().map(|p| away(p, others)).fold(0.0, f64::max);
    farthest(&a, &b).max(farthest(&b, &a))
}

/// Distance of a place from a chord.
fn to_chord(p: &Vec3, chord: &[Vec3]) -> f64 {
    (p - chord[0] - (chord[1] - chord[0]) * share(&chord[0], &chord[1], p)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_as_far_apart_as_their_farthest_place() {
        let line = |y: f64, to: f64| {
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0, 0.0, 0.0], [to, y, 0.0]]).expect("a line")
        };
        assert_eq!(apart(&line(0.0, 10.0), &line(0.0, 10.0)), 0.0);
        assert!((apart(&line(0.0, 10.0), &line(0.0, 13.0)) - 3.0).abs() < 1e-12);
        assert!((apart(&line(4.0, 10.0), &line(0.0, 10.0)) - 4.0).abs() < 1e-3);
    }
}
