//! Elements of a row that most of the others do not agree with.
//!
//! *Method*: a robust fit of planes \[PW99, (9)\] (Huber's, then Tukey's weights) with corrected parameters; an element
//! is an outlier if the fit does not trust it, it is beyond the tolerance, and none of its neighbours is farther:
//! estimates of neighbours suffer from an outlier, so that the worst is to be taken out first and the rest looked at
//! again.
//! *Not guaranteed*: that outliers that agree with each other, side by side, are found.

use super::sequence::{axes, data, distance, knots_wanted, parameters, RowOptions};
use crate::fit::planes::correction::{joint, JointOptions};
use crate::geom::Vec3;
use crate::torse::contact::ContactElement;

/// Elements of a part of a row without which no fit is looked at.
const FEWEST: usize = 8;
/// Weight below which an element is not trusted.
const TRUSTED: f64 = 0.1;
/// Neighbours on either side whose estimates an outlier touches.
const REACH: usize = 2;
/// Share of the largest distance up to which others may come from the same outlier.
const RINGING: f64 = 0.6;
/// Share of a row that can be outliers; beyond, there is nothing to agree on.
pub(crate) const MOST: f64 = 0.25;

/// Indices of the outliers of a row that show at once, in order; look again without them. Empty where they are more than
/// [`MOST`] of the row.
///
/// *Input*: usable elements, neighbours oriented alike; `tolerance` in mm.
pub fn outliers(elements: &[ContactElement], tolerance: f64) -> Vec<usize> {
    let mut out = Vec::new();
    search(elements, 0, tolerance, &mut out);
    if out.len() as f64 > MOST * elements.len() as f64 {
        out.clear();
    }
    out
}

/// Looks through a part of a row that begins at `from`, in halves where planes turn too far for one fit.
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
    let last = far.len() - 1;
    let least = tolerance.max(RINGING * far.iter().map(|f| f.0).fold(0.0, f64::max));
    let worst = |i: usize| far[i.saturating_sub(REACH)..=(i + REACH).min(last)].iter().all(|f| f.0 <= far[i].0);
    out.extend((0..far.len()).filter(|&i| far[i].0 > least && far[i].1 < TRUSTED && worst(i)).map(|i| from + i));
}

/// Distances of the elements from a robust fit, mm, with its trust in them.
fn distances(elements: &[ContactElement], tolerance: f64) -> Option<Vec<(f64, f64)>> {
    let normals: Vec<Vec3> = elements.iter().map(|e| e.normal).collect();
    let along = parameters(elements)?;
    let frame = axes(&normals, elements.iter().map(ContactElement::centre))?;
    let data = data(elements, &along, &frame)?;
    let wanted = knots_wanted(elements.len(), &RowOptions { robust: true, ..RowOptions::new(tolerance) });
    let few = crate::fit::planes::knot_choice::planes_within(&data, &wanted).ok()?;
    let found = joint(&data, few.curve.knots(), &wanted.fit, &JointOptions::default()).ok()?;
    let far = |(e, t): (&ContactElement, &f64)| {
        let [u0, u1, u2, _] = found.fit.curve.planes().point(*t);
        // The plane z = u0 + u1 x + u2 y of the frame, as n·X = h in the world.
        let local = Vec3::new(-u1, -u2, 1.0);
        let n = frame.vector_to_world(&local);
        distance(e, &n, (u0 + n.dot(&frame.origin)) / n.norm())
    };
    Some(elements.iter().zip(&found.parameters).map(far).zip(found.fit.trust.iter().copied()).collect())
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

    #[test]
    fn short_rows_have_no_outliers() {
        assert!(outliers(&[], 0.1).is_empty());
        assert!(outliers(&cone(&[3])[..FEWEST - 1], 0.1).is_empty());
    }
}
