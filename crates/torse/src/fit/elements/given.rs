//! Rulings and planes as they are given: in order, with tangent planes \[PW99, 4.3\], without those that the others do not
//! agree with.

use super::outliers::{outliers, MOST_OUTLIERS};
use super::ruling_order::ordered;
pub(crate) use super::sequence::FEWEST;
use crate::fit::planes::estimates::{
    planes_of_noisy_rulings, planes_of_rulings, planes_of_smooth_rulings, Ends, EstimateError,
};
use crate::geom::Vec3;
use crate::torse::contact::{orient, ContactElement, Given};

/// Width of the region of a ruling as a share of its length: its tangent plane counts a little beside it.
pub(crate) const NARROW: f64 = 0.1;
/// Smallest region of a ruling as a share of its length; without extent planes are not compared at all.
const THIN: f64 = 1e-4;

/// Rulings in order with their planes, estimated in several ways: for ends that lie on smooth curves, for ends that do
/// not, and for noisy rulings, whose planes say little beside them.
///
/// # Errors
/// A ruling of no length, or one that is not finite; tangent planes that cannot be estimated.
pub(crate) fn of_rulings(rulings: &[[Vec3; 2]], tolerance: f64) -> Result<Vec<Vec<ContactElement>>, EstimateError> {
    for (index, r) in rulings.iter().enumerate() {
        if !r.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()) || r[0] == r[1] {
            return Err(EstimateError::Ruling { index });
        }
    }
    let sequence = ordered(rulings);
    let (from, to): (Vec<_>, Vec<_>) = sequence.iter().map(|r| (r[0], r[1])).unzip();
    // A ruling speaks for the surface half way to its neighbours.
    let middle = |i: usize| 0.5 * (sequence[i][0] + sequence[i][1]);
    let last = sequence.len() - 1;
    let radius = |i: usize| 0.5 * (middle((i + 1).min(last)) - middle(i.saturating_sub(1))).norm();
    let elements = |normals: &[Vec3], wide: bool| -> Vec<ContactElement> {
        let element = |(i, normal): (usize, &Vec3)| {
            let length = (sequence[i][1] - sequence[i][0]).norm();
            let radius = if wide { NARROW * length } else { radius(i).max(THIN * length) };
            ContactElement { normal: *normal, ends: sequence[i], radius, weight: 1.0 }
        };
        normals.iter().enumerate().map(element).collect()
    };
    let neighbours = planes_of_rulings(&from, &to, Ends::Extrapolated);
    let mut out: Vec<Vec<ContactElement>> = Vec::new();
    out.extend(planes_of_smooth_rulings(&from, &to).ok().map(|n| elements(&n, true)));
    out.extend(planes_of_noisy_rulings(&from, &to, 0.5 * tolerance).ok().map(|n| elements(&n, true)));
    match neighbours {
        Ok(n) => out.extend([elements(&n, true), elements(&n, false)]),
        Err(e) if out.is_empty() => return Err(e),
        Err(_) => {}
    }
    Ok(out)
}

/// Turns the normals of rulings square to them: a plane that is kept must hold its ruling.
pub fn square(elements: &mut [ContactElement]) {
    for e in elements.iter_mut().filter(|e| e.has_ruling()) {
        let d = (e.ends[1] - e.ends[0]).normalize();
        e.normal = (e.normal - d * d.dot(&e.normal)).try_normalize(0.0).unwrap_or(e.normal);
    }
}

/// Some of what is given, by their indices.
pub(crate) fn only(given: &Given, of: &[usize]) -> Given {
    match given {
        Given::Planes(p) => Given::Planes(of.iter().map(|&i| p[i]).collect()),
        Given::Rulings(r) => Given::Rulings(of.iter().map(|&i| r[i]).collect()),
    }
}

/// What is given without its outliers, and these with their indices.
pub(crate) fn agreeing(given: &Given, tolerance: f64) -> (Given, Vec<(usize, ContactElement)>) {
    // Outliers taken out in turn; what is left then has more of them than agreement.
    const ROUNDS: usize = 64;
    let mut left: Vec<usize> = (0..given.len()).collect();
    let mut out: Vec<(usize, ContactElement)> = Vec::new();
    let part = |of: &[usize]| only(given, of);
    for _ in 0..ROUNDS {
        let mut estimates = match part(&left) {
            Given::Planes(p) => vec![p],
            Given::Rulings(r) => of_rulings(&r, tolerance).unwrap_or_default(),
        };
        estimates.iter_mut().for_each(|e| orient(e));
        // What is one estimate's fault, at the ends mostly, is not the ruling's.
        let all: Vec<Vec<usize>> = estimates.iter().map(|e| outliers(e, tolerance)).collect();
        let Some(elements) = estimates.first() else { break };
        let most = |i: &usize| 2 * all.iter().filter(|a| a.contains(i)).count() > all.len();
        let found: Vec<usize> = (0..elements.len()).filter(most).collect();
        if found.is_empty() || left.len() < FEWEST + found.len() {
            break;
        }
        for i in found {
            // Rulings have been put in order: they are known by their ends.
            let own = |k: &usize| match given {
                Given::Planes(_) => left.get(i) == Some(k),
                Given::Rulings(r) => {
                    let [p, q] = elements[i].ends;
                    r[*k] == [p, q] || r[*k] == [q, p]
                }
            };
            if let Some(&k) = left.iter().find(|k| own(k)) {
                out.push((k, elements[i]));
            }
        }
        left.retain(|k| out.iter().all(|o| o.0 != *k));
    }
    // So many do not agree that it is not for the fit to choose.
    if out.len() as f64 > MOST_OUTLIERS * given.len() as f64 {
        return (given.clone(), Vec::new());
    }
    out.sort_by_key(|o| o.0);
    (part(&left), out)
}

/// Index of the first element that is the same as the one before.
pub fn repeated(given: &Given) -> Option<usize> {
    let same = |n: usize, equal: &dyn Fn(usize) -> bool| (1..n).find(|&i| equal(i));
    match given {
        Given::Rulings(r) => same(r.len(), &|i| r[i] == r[i - 1] || r[i] == [r[i - 1][1], r[i - 1][0]]),
        Given::Planes(p) => same(p.len(), &|i| p[i].normal == p[i - 1].normal && p[i].ends == p[i - 1].ends),
    }
}
