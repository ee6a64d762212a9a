//! What is fitted, what comes out, and the choice of few samples out of many.

use super::power_form::PowerForm;
use crate::geom::{BBox, Vec3};
use crate::num::parallel;
use crate::torse::form::{PanelKind, Torse};

/// A point of the surface to be approximated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Position, mm.
    pub x: Vec3,
    /// Unit normal of the surface, or zero where it is undefined (poles, degenerate edges).
    pub n: Vec3,
    /// Area that the sample stands for, mm²; only the choice of frames uses it.
    pub weight: f64,
}

/// A torse near samples.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The surface; its domain reaches beyond the feet of all samples.
    pub torse: Torse,
    /// What it is.
    pub kind: PanelKind,
    /// Largest distance from a sample to the torse over all samples given, mm. Sampled, not proven.
    pub error: f64,
    /// Index of the sample with that distance.
    pub worst: usize,
}

/// Share of the range of the feet by which domains of fits reach beyond it.
pub(in crate::fit) const MARGIN: f64 = 0.08;

/// Smallest accepted `1 + y a'` of a primal torse over the samples: the distance to the regression curve along a
/// ruling is then at least a twentieth of the ruling's distance from the profile plane.
pub(crate) const REGULAR_PRIMAL: f64 = 0.05;

/// Smallest accepted ratio of `|N''·X − H''|` over the samples of a dual torse to its largest value.
pub(crate) const REGULAR_DUAL: f64 = 1e-6;

/// Largest distance from the samples to the torse (mm), measured at the feet of the perpendiculars, and the index of
/// the sample with it. `None` if there is no sample, a foot is missing (it would leave the domain), or the torse is not
/// regular at a foot.
pub fn error(torse: &Torse, samples: &[Sample]) -> Option<(f64, usize)> {
    let power_form = PowerForm::of(torse)?;
    let guesses = power_form.guesses();
    let mut feet = vec![0.0; samples.len()];
    for (t, s) in feet.iter_mut().zip(samples) {
        let q = power_form.local(&s.x);
        *t = guesses.guess(&q);
    }
    measure(&power_form, samples, &mut feet).or_else(|| {
        // A guess may have led to a foot on another fold.
        for (t, s) in feet.iter_mut().zip(samples) {
            *t = power_form.nearest_foot(&power_form.local(&s.x))?;
        }
        measure(&power_form, samples, &mut feet)
    })
}

/// As [`error`], where a torse comes round again: samples count with the nearest of their feet, since a guess may lead to what goes
/// on beyond its other end.
pub(crate) fn nearest_error(torse: &Torse, samples: &[Sample]) -> Option<(f64, usize)> {
    let power_form = PowerForm::of(torse)?;
    let planes = power_form.plane_table();
    let nearest = |s: &Sample| power_form.nearest_foot_of(&power_form.local(&s.x), &planes);
    let feet: Option<Vec<f64>> = parallel::map(samples.iter(), nearest).into_iter().collect();
    measure(&power_form, samples, &mut feet?)
}

/// The samples farther than `bound` (mm) from the torse; those without a foot are left out.
pub(crate) fn beyond(torse: &Torse, samples: Vec<Sample>, bound: f64) -> Vec<Sample> {
    let Some(power_form) = PowerForm::of(torse) else { return Vec::new() };
    let (guesses, domain) = (power_form.guesses(), power_form.domain());
    let far = |s: &Sample| {
        let q = power_form.local(&s.x);
        power_form.foot(&q, guesses.guess(&q), domain).is_some_and(|t| power_form.distance(&q, t).0.abs() > bound)
    };
    samples.into_iter().filter(far).collect()
}

/// As [`error`], with first guesses of the feet in `feet`; leaves the feet there.
pub(crate) fn measure(power_form: &PowerForm, samples: &[Sample], feet: &mut [f64]) -> Option<(f64, usize)> {
    let domain = power_form.domain();
    let mut worst = (-1.0, 0);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, (s, t)) in samples.iter().zip(feet.iter_mut()).enumerate() {
        let q = power_form.local(&s.x);
        *t = power_form.foot(&q, *t, domain)?;
        let (d, regular) = power_form.distance(&q, *t);
        if !d.is_finite() {
            return None;
        }
        least = least.min(regular);
        most = most.max(regular);
        if d.abs() > worst.0 {
            worst = (d.abs(), i);
        }
    }
    let regular = match power_form {
        PowerForm::Primal { .. } => least > REGULAR_PRIMAL,
        PowerForm::Dual { .. } | PowerForm::Cylinder { .. } => {
            least.min(-most).max(least.max(-most)) > REGULAR_DUAL * least.abs().max(most.abs())
        }
    };
    (worst.0 >= 0.0 && regular).then_some(worst)
}

/// Indices of at most `count` samples spread evenly in space: one per cell of a cubic grid, the one farthest from the
/// middle, so that the border is kept. The cells are as small as `count` allows.
///
/// Spread in space and not in parameters: a parametrisation may crowd a quarter of the samples into a sliver.
pub fn thin(samples: &[Sample], count: usize) -> Vec<usize> {
    // Refinements of the cell size; the count is within some percent of the wanted one after these.
    const ROUNDS: usize = 8;
    if samples.len() <= count {
        return (0..samples.len()).collect();
    }
    let bbox = BBox::of(samples.iter().map(|s| &s.x));
    let diagonal = bbox.diagonal();
    if !(diagonal > 0.0 && diagonal.is_finite()) || count == 0 {
        return (0..count.min(samples.len())).collect();
    }
    let center = bbox.center();
    let cells = |size: f64, keys: &mut Vec<(u64, u32)>| {
        keys.clear();
        keys.extend(samples.iter().enumerate().map(|(i, s)| {
            let c = (s.x - bbox.min) / size;
            let at = |v: f64| (v.max(0.0) as u64).min(0x1f_ffff);
            ((at(c.x) << 42) | (at(c.y) << 21) | at(c.z), i as u32)
        }));
        keys.sort_unstable_by_key(|k| k.0);
        1 + keys.windows(2).filter(|w| w[0].0 != w[1].0).count()
    };
    let mut keys = Vec::with_capacity(samples.len());
    // Surfaces fill about (diagonal / size)² cells.
    let (mut lo, mut hi) = (0.0_f64, f64::INFINITY);
    let mut size = diagonal / (count as f64).sqrt();
    let mut best = None;
    for _ in 0..ROUNDS {
        let found = cells(size, &mut keys);
        if found <= count {
            hi = size;
            best = Some(size);
            if found * 20 >= count * 19 {
                break;
            }
        } else {
            lo = size;
        }
        let guess = size * (found as f64 / count as f64).sqrt().clamp(0.25, 4.0);
        size = if guess > lo && guess < hi && guess != size {
            guess
        } else if hi.is_finite() {
            0.5 * (lo + hi)
        } else {
            2.0 * lo
        };
    }
    cells(best.unwrap_or(diagonal), &mut keys);
    let mut chosen = Vec::with_capacity(count);
    let mut i = 0;
    while i < keys.len() {
        let cell = keys[i].0;
        let (mut far, mut pick) = (-1.0, keys[i].1);
        while i < keys.len() && keys[i].0 == cell {
            let d = (samples[keys[i].1 as usize].x - center).norm_squared();
            if d > far {
                far = d;
                pick = keys[i].1;
            }
            i += 1;
        }
        chosen.push(pick as usize);
    }
    chosen.truncate(count);
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: usize) -> Vec<Sample> {
        let at = |i: usize| i as f64 / (n - 1) as f64;
        (0..n * n)
            .map(|k| Sample {
                x: Vec3::new(100.0 * at(k / n).powi(4), 40.0 * at(k % n), 0.0),
                n: Vec3::z(),
                weight: 1.0,
            })
            .collect()
    }

    #[test]
    fn thinning_is_even_in_space() {
        let samples = grid(60);
        let chosen = thin(&samples, 200);
        assert!((150..=200).contains(&chosen.len()), "{}", chosen.len());
        // Half of the area must hold about half of the chosen ones although it holds 84 % of the samples.
        let left = chosen.iter().filter(|&&i| samples[i].x.x < 50.0).count();
        assert!((0.35..0.7).contains(&(left as f64 / chosen.len() as f64)), "{left}");
    }

    #[test]
    fn far_samples_are_found() {
        let mut samples = grid(20);
        let fit = crate::fit::near::plane::plane(&samples).expect("a plane");
        for (i, s) in samples.iter_mut().enumerate().filter(|(i, _)| i % 100 == 7) {
            s.x.z = if i < 200 { 0.5 } else { -0.5 };
        }
        let far = beyond(&fit.torse, samples, 0.4);
        assert!(far.len() == 4 && far.iter().all(|s| s.x.z.abs() == 0.5), "{far:?}");
    }

    #[test]
    fn thinning_of_equal_points_ends() {
        let samples = vec![Sample { x: Vec3::new(1.0, 2.0, 3.0), n: Vec3::z(), weight: 1.0 }; 50];
        assert_eq!(thin(&samples, 10).len(), 10);
    }
}
