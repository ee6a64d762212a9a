//! Elements of a sequence that most of the others do not agree with.
//!
//! *Method*: a robust fit of planes \[PW99, (9)\] (Huber's, then Tukey's weights) with corrected parameters tells suspects: the
//! fit does not trust them and they are beyond the tolerance. Far from the middle of its axes, or over few spans, that fit may
//! be wrong itself; so a suspect is compared with its neighbours: it is an outlier if a cubic of planes through these, in axes
//! of their own, does not lead to it either, or where they agree on no cubic, if the robust fit follows most of them. Of
//! outliers near each other the worst is taken out first and the rest looked at again, since estimates of neighbours suffer
//! from it. Where the robust fit tells of none, every element is compared with its neighbours.
//! *Not guaranteed*: that outliers that agree with each other, side by side, are found; that the last two elements of a sequence
//! that turn off together are no outliers.

use super::sequence::{axes, data, distance, extended_by, knots_wanted, least, parameters, SequenceOptions};
use crate::fit::planes::correction::{joint, JointOptions};
use crate::fit::planes::linear_system::PlanesOptions;
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use crate::torse::contact::ContactElement;
use crate::torse::dual::DualCurve;
use crate::torse::form::DualTorse;

/// Elements of a part of a sequence without which no fit is looked at.
const FEWEST: usize = 8;
/// Weight below which an element is not trusted.
const TRUSTED: f64 = 0.1;
/// Neighbours on either side whose estimates an outlier touches.
const REACH: usize = 2;
/// Share of the largest distance up to which others may come from the same outlier.
const RINGING: f64 = 0.6;
/// Share of a sequence that can be outliers; beyond, there is nothing to agree on.
pub(crate) const MOST_OUTLIERS: f64 = 0.25;
/// Neighbours that a suspect is compared with, fewer where so many do not follow one cubic.
const NEIGHBOURS: [usize; 3] = [12, 9, 6];
/// Share of its domain by which a fit of neighbours is continued: a suspect at the end of a sequence is one or two of them away.
const BEYOND: f64 = 0.5;

/// Indices of the outliers of a sequence that show at once, in order; look again without them. Empty where they are more than
/// [`MOST_OUTLIERS`] of the sequence.
///
/// *Input*: usable elements, neighbours oriented alike; `tolerance` in mm.
pub fn outliers(elements: &[ContactElement], tolerance: f64) -> Vec<usize> {
    let mut out = Vec::new();
    search(elements, 0, tolerance, &mut out);
    if out.len() as f64 > MOST_OUTLIERS * elements.len() as f64 {
        out.clear();
    }
    out
}

/// Looks through a part of a sequence that begins at `from`, in halves where planes turn too far for one fit.
fn search(elements: &[ContactElement], from: usize, tolerance: f64, out: &mut Vec<usize>) {
    if elements.len() < FEWEST {
        return;
    }
    let Some(far) = distances(elements, tolerance) else {
        let (a, b) = elements.split_at(elements.len() / 2);
        search(a, from, tolerance, out);
        search(b, from + a.len(), tolerance, out);
        return;
    };
    let suspects: Vec<usize> = (0..far.len()).filter(|&i| far[i].0 > tolerance && far[i].1 < TRUSTED).collect();
    let followed = |around: &[usize]| 2 * around.iter().filter(|&&k| far[k].0 <= tolerance).count() > around.len();
    let away = |i: usize, others: &[usize]| {
        let (away, around) = beside(elements, i, others, tolerance);
        away.or_else(|| followed(&around).then_some(far[i].0))
    };
    let mut found = disagreeing(suspects, tolerance, &away);
    if found.is_empty() {
        let alone = |i: usize| Some((i, beside(elements, i, &[], tolerance).0?));
        found = (0..far.len()).filter_map(alone).filter(|f| f.1 > tolerance).collect();
    }
    let least = tolerance.max(RINGING * found.iter().map(|f| f.1).fold(0.0, f64::max));
    let worst = |f: &&(usize, f64)| found.iter().filter(|o| o.0.abs_diff(f.0) <= REACH).all(|o| o.1 <= f.1);
    out.extend(found.iter().filter(|f| f.1 > least).filter(worst).map(|f| from + f.0));
}

/// Those of the suspects that do not agree with the others, with their distances, mm: suspects that agree are others to
/// the rest then. `away` says how far an element is from others than some, where that is known.
fn disagreeing(
    mut suspects: Vec<usize>,
    tolerance: f64,
    away: &dyn Fn(usize, &[usize]) -> Option<f64>,
) -> Vec<(usize, f64)> {
    loop {
        let far = |&i: &usize| Some((i, away(i, &suspects)?)).filter(|f| f.1 > tolerance);
        let left: Vec<(usize, f64)> = suspects.iter().filter_map(far).collect();
        if left.len() == suspects.len() {
            return left;
        }
        suspects = left.into_iter().map(|f| f.0).collect();
    }
}

/// Distances of the elements from a robust fit, mm, with its trust in them.
fn distances(elements: &[ContactElement], tolerance: f64) -> Option<Vec<(f64, f64)>> {
    let normals: Vec<Vec3> = elements.iter().map(|e| e.normal).collect();
    let along = parameters(elements)?;
    let frame = axes(&normals, elements.iter().map(ContactElement::centre))?;
    let data = data(elements, &along, &frame)?;
    let wanted = knots_wanted(elements.len(), &SequenceOptions { robust: true, ..SequenceOptions::new(tolerance) });
    let few = crate::fit::planes::knot_choice::planes_within(&data, &wanted).ok()?;
    let found = joint(&data, few.curve.knots(), &wanted.fit, &JointOptions::default()).ok()?;
    // The plane of the frame in the world.
    let far = |(e, t): (&ContactElement, &f64)| {
        let [x, y, _, height] = found.fit.curve.planes().point(*t);
        let n = frame.vector_to_world(&Vec3::new(x, y, 1.0));
        distance(e, &n, (height + n.dot(&frame.origin)) / n.norm())
    };
    Some(elements.iter().zip(&found.parameters).map(far).zip(found.fit.trust.iter().copied()).collect())
}

/// How far (mm) an element is from a cubic through its nearest neighbours that are not suspected, where these, or all but one
/// of them, follow one within the tolerance; and the neighbours.
fn beside(elements: &[ContactElement], own: usize, suspected: &[usize], tolerance: f64) -> (Option<f64>, Vec<usize>) {
    let mut others: Vec<usize> = (0..elements.len()).filter(|i| *i != own && !suspected.contains(i)).collect();
    others.sort_by_key(|i| i.abs_diff(own));
    let nearest = |count: usize| {
        let mut some: Vec<usize> = others.iter().take(count).copied().collect();
        some.sort_unstable();
        some
    };
    let led = |sequence: &[ContactElement]| {
        let torse = cubic(sequence)?;
        let far = |e: &ContactElement| away(e, &torse);
        sequence.iter().all(|e| far(e) <= tolerance).then(|| far(&elements[own]))
    };
    let away = NEIGHBOURS.iter().filter(|&&n| n <= others.len()).find_map(|&n| {
        let sequence: Vec<ContactElement> = nearest(n).iter().map(|&i| elements[i]).collect();
        let without = |k: usize| {
            let mut fewer = sequence.clone();
            fewer.remove(k);
            led(&fewer)
        };
        led(&sequence).or_else(|| (0..sequence.len()).filter(|_| sequence.len() > FEWEST).find_map(without))
    });
    (away, nearest(NEIGHBOURS[0]))
}

/// The torse of one cubic of planes near a short sequence, continued beyond both of its ends.
fn cubic(sequence: &[ContactElement]) -> Option<DualTorse> {
    let normals: Vec<Vec3> = sequence.iter().map(|e| e.normal).collect();
    let frame = axes(&normals, sequence.iter().map(ContactElement::centre))?;
    let data = data(sequence, &parameters(sequence)?, &frame)?;
    let knots = Knots::clamped(3, &[0.0, 1.0]).ok()?;
    let found = joint(&data, &knots, &PlanesOptions::default(), &JointOptions::default()).ok()?;
    let curve: &DualCurve = &found.fit.curve;
    extended_by(BEYOND, curve, &frame)
}

/// Distance (mm) of an element from the nearest tangent plane of a torse.
fn away(e: &ContactElement, torse: &DualTorse) -> f64 {
    let (a, b) = torse.planes.domain();
    least(a, b, |t| {
        let u = torse.planes.jet(t)[0];
        let n = Vec3::new(u[0], u[1], u[2]);
        distance(e, &n, u[3] / n.norm())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tangent planes of a cone, some of them lifted.
    fn cone(lifted: &[usize]) -> Vec<ContactElement> {
        (0..40)
            .map(|i| {
                let ((s, c), (p, q)) = ((0.03 * i as f64 - 0.6).sin_cos(), 0.5_f64.sin_cos());
                let normal = Vec3::new(q * c, q * s, -p);
                let ray = Vec3::new(p * c, p * s, q);
                let lift = if lifted.contains(&i) { 6.0 } else { 0.0 };
                let ends = [400.0, 900.0].map(|r| ray * r + normal * lift);
                ContactElement { normal, ends, radius: 50.0, weight: 1.0 }
            })
            .collect()
    }

    #[test]
    fn lifted_rulings_are_found_and_no_others() {
        assert_eq!(outliers(&cone(&[7, 23]), 0.1), vec![7, 23]);
        assert!(outliers(&cone(&[]), 0.1).is_empty());
        // A tolerance that takes them in leaves nothing to find.
        assert!(outliers(&cone(&[7, 23]), 10.0).is_empty());
    }

    /// Tangent planes of a cone over 2 rad, in discs beside its tip, some of them lifted.
    fn wide_cone(lifted: &[(usize, f64)]) -> Vec<ContactElement> {
        let plane = |i: usize| {
            let ((s, c), (p, q)) = ((2.0 * i as f64 / 29.0).sin_cos(), 0.5_f64.sin_cos());
            let normal = Vec3::new(q * c, q * s, -p);
            let lift = lifted.iter().find(|l| l.0 == i).map_or(0.0, |l| l.1);
            let ends = [Vec3::new(p * c, p * s, q) * 200.0 + normal * lift; 2];
            ContactElement { normal, ends, radius: 60.0, weight: 1.0 }
        };
        (0..30).map(plane).collect()
    }

    #[test]
    fn planes_that_turn_far_are_no_outliers_at_the_ends_of_their_row() {
        assert!(outliers(&wide_cone(&[]), 0.2).is_empty());
        for (k, lift) in [(12, 20.0), (5, 20.0), (20, 5.0), (0, 5.0), (29, 20.0)] {
            assert_eq!(outliers(&wide_cone(&[(k, lift)]), 0.2), vec![k], "{k} lifted by {lift}");
        }
    }

    #[test]
    fn short_rows_have_no_outliers() {
        assert!(outliers(&[], 0.1).is_empty());
        assert!(outliers(&cone(&[3])[..FEWEST - 1], 0.1).is_empty());
    }
}
