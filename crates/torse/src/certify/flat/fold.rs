//! Whether two strips unfold to one sheet along their common rail: how far the flat images of the rail are apart.
//!
//! *Method.* Both strips are laid in the plane by maps whose strain is proven (`rails`), on both sides of the rail. Some motion
//! takes the image of the rail as a side of the second strip near that as a side of the first: any is good for the proof. On
//! every piece the difference of both is bounded by its ends and by what it can leave its chord \[MKC09\].
//! *Guaranteed*: at equal parameters both images are no farther apart than the bound. How far the outlines as drawn are from
//! the images is bounded by the certificates of both patterns.

use super::outline::Motion;
use super::rails::{FlatRails, Start};
use crate::certify::claim::UpperBound;
use crate::certify::ruled::Ruled;
use crate::num::greatest::greatest;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::torse::strip::Strip;

/// The bound may exceed the greatest distance by this share of the length of the rail's image.
const EXCESS: f64 = 1e-7;
/// The bound may exceed the greatest distance by this share of what is asked for.
const SHARE: f64 = 0.01;

/// A rail of a strip: the strip, and 0 or 1.
pub(crate) type RailOf<'a> = (&'a Strip, usize);

/// Distance (mm) of the flat images of a common rail of two strips, which runs the same way in both; `enough` (mm) is what
/// is asked for. Unknown where a strip cannot be laid flat, or its rail is a point.
pub(crate) fn fold_apart(a: RailOf, b: RailOf, enough: f64) -> UpperBound {
    bound(a, b, enough).map_or(UpperBound::UNKNOWN, UpperBound::shown)
}

fn bound(a: RailOf, b: RailOf, enough: f64) -> Option<f64> {
    // Seen from one side, a strip lies on one side of its rail 0 and on the other side of its rail 1.
    let side = if a.1 == b.1 { -1.0 } else { 1.0 };
    let (first, second) = (laid(a.0, 1.0)?, laid(b.0, side)?);
    let [p, q] = [(&first, a.1), (&second, b.1)].map(|(flat, rail)| Image { flat, rail: rail as f64 });
    let cuts: Vec<f64> = p.flat.breaks().iter().chain(q.flat.breaks()).copied().collect();
    let place = |t: &f64| Some((q.flat.place(*t, q.rail)?, p.flat.place(*t, p.rail)?));
    let middles = cuts.windows(2).map(|w| 0.5 * (w[0] + w[1]));
    let pairs: Vec<_> = cuts.iter().copied().chain(middles).map(|t| place(&t)).collect::<Option<_>>()?;
    let motion = Motion::between(&pairs)?;
    let size = pairs.iter().fold(0.0f64, |m, (_, x)| m.max((x[0] - motion.to[0]).hypot(x[1] - motion.to[1])));
    greatest(cuts, EXCESS * size + SHARE * enough, |t0, t1| {
        let at = |t: f64| -> Option<Interval> {
            let [x, y] = apart(&p, &q, &motion, Jet::from(t))?.0;
            Some((x.v.sqr() + y.v.sqr()).sqrt())
        };
        let share = Jet { v: Interval::new(t0, t1), d: Interval::point(t1) - Interval::point(t0), dd: Interval::ZERO };
        let ([x, y], rough) = apart(&p, &q, &motion, share)?;
        let beside = [x, y].map(|j| Interval::point(j.chord_deviation(rough)));
        let (from, to) = (at(t0)?, at(t1)?);
        let ends = from.hi.max(to.hi);
        Some(((Interval::point(ends) + (beside[0].sqr() + beside[1].sqr()).sqrt()).hi, from.lo.max(to.lo)))
    })
}

/// The flat image of a rail.
struct Image<'a> {
    flat: &'a FlatRails,
    rail: f64,
}

/// Difference of both images, and how rough it is.
fn apart(p: &Image, q: &Image, motion: &Motion, t: Jet) -> Option<([Jet; 2], f64)> {
    let (on, rough) = p.flat.along_curve(t, Jet::from(p.rail))?;
    let (other, rougher) = q.flat.along_curve(t, Jet::from(q.rail))?;
    let other = motion.jet(&other);
    // Shares at the ends that may be without derivatives add up.
    let rough = (Interval::point(rough) + Interval::point(rougher)).hi;
    Some(([0, 1].map(|d: usize| on[d] - other[d]), rough))
}

/// A strip laid flat over all its rulings.
fn laid(strip: &Strip, side: f64) -> Option<FlatRails> {
    let used = Interval::new(0.0, 1.0);
    FlatRails::from(&Ruled::new(&strip.patch)?, &|_, _| Some(used), side, &Start::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::strip;
    use crate::geom::Vec3;

    const CREASE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [40.0, 0.0, 25.0], [70.0, 0.0, 30.0], [120.0, 0.0, 0.0]];

    /// A cylinder from the crease into a direction.
    fn beside(d: Vec3) -> [[f64; 3]; 4] {
        CREASE.map(|p| (Vec3::from(p) + d).into())
    }

    #[test]
    fn mirrored_cylinders_unfold_to_one_sheet_and_others_do_not() {
        let down = Vec3::new(10.0, 50.0, -30.0);
        // It goes on beyond the plane of the crease, and is mirrored in it.
        let mirrored = Vec3::new(-down.x, down.y, -down.z);
        let left = strip(&CREASE, &beside(down));
        let right = strip(&CREASE, &beside(mirrored));
        let found = fold_apart((&left, 0), (&right, 0), 0.01).value();
        assert!(found < 2e-4, "{found}");
        // With the crease as the other rail of one of them, and of both.
        let other = strip(&beside(mirrored), &CREASE);
        assert!(fold_apart((&left, 0), (&other, 1), 0.01).value() < 2e-4);
        assert!(fold_apart((&strip(&beside(down), &CREASE), 1), (&other, 1), 0.01).value() < 2e-4);
        // The same strip twice is folded upon itself: it is no sheet.
        assert!(fold_apart((&left, 0), (&left, 0), 0.01).value() > 1.0);
        // A steeper one has another geodesic curvature.
        let steep = strip(&CREASE, &beside(Vec3::new(-10.0, 50.0, 40.0)));
        let far = fold_apart((&left, 0), (&steep, 0), 0.01).value();
        let little = strip(&CREASE, &beside(mirrored + Vec3::z()));
        let near = fold_apart((&left, 0), (&little, 0), 0.01).value();
        assert!(far > 0.5 && near > 0.05 && near < far, "{near} {far}");
    }

    #[test]
    fn the_bound_is_above_what_is_seen_and_little_more() {
        let left = strip(&CREASE, &beside(Vec3::new(10.0, 50.0, -30.0)));
        let steep = strip(&CREASE, &beside(Vec3::new(-10.0, 50.0, 40.0)));
        let (p, q) = (laid(&left, 1.0).expect("flat"), laid(&steep, -1.0).expect("flat"));
        let at = |k: usize| k as f64 / 500.0;
        let pairs: Vec<_> =
            (0..=500).map(|k| (q.place(at(k), 0.0).expect("in"), p.place(at(k), 0.0).expect("in"))).collect();
        let motion = Motion::between(&pairs).expect("a motion");
        let far = |(x, y): &([f64; 2], [f64; 2])| {
            let x = motion.about(x);
            (x[0] - y[0]).hypot(x[1] - y[1])
        };
        let seen = pairs.iter().map(far).fold(0.0, f64::max);
        let found = fold_apart((&left, 0), (&steep, 0), 0.01).value();
        // The motion is another one: both come near the least that there is.
        assert!(found > 0.5 * seen && found < 1.5 * seen, "{found} {seen}");
    }

    #[test]
    fn a_strip_that_cannot_be_laid_flat_shows_nothing() {
        let left = strip(&CREASE, &beside(Vec3::new(10.0, 50.0, -30.0)));
        let mut twisted = beside(Vec3::new(-10.0, 50.0, 30.0));
        twisted[3][2] += 80.0;
        assert_eq!(fold_apart((&left, 0), (&strip(&CREASE, &twisted), 0), 0.01), UpperBound::UNKNOWN);
    }
}
