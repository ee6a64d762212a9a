//! Steps of the program as long as they make the networks better.

use super::fleet::Fleet;
use super::program::{step, Prices, Step, LOW_ENOUGH};
use super::{Joint, StepReport};
use crate::control::Control;

/// Largest distance (tolerances) above which strips have far to go after so many steps: slides then grow, and there are more
/// steps.
const FAR: (f64, usize) = (1.05, 2);
/// See [`FAR`].
const FAR_STEPS: usize = 12;
/// There, factors on how far lines may slide in a step, after refused and good ones, and the most.
const SLIDES: (f64, f64, f64) = (0.5, 2.0, 4.0);
/// Weights of gaps from step to step; the last one stays.
const WEIGHTS: [f64; 4] = [20.0, 80.0, 320.0, 1200.0];
/// Steps at most; of those with far to go, see [`FAR`], [`FAR_STEPS`].
const STEPS: usize = 8;
/// Trials of a step, more and more damped, before parts of one are tried.
const TRIALS: usize = 5;
/// Largest distance and gap (tolerances) with which nothing more is tried, after so many steps.
const SETTLED: (f64, f64, usize) = (0.93, 0.02, 2);
/// Largest gap (tolerances) of strips that meet as they are, as parts of one developable do: no step brings them nearer.
const MET: f64 = 1e-9;
/// Steps that gain less end the program once gaps are small enough; with distances beyond the tolerance, where all hangs on a
/// little more, this part of it.
const STALLED: (f64, f64) = (2e-3, 0.2);
/// Gaps below the first of these count no less than it, times the second, beside the largest distance.
const GAP: (f64, f64) = (0.02, 3.0);
/// Parts of a step that are tried, the largest with which no foot is lost is taken.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// Shares of the expected gain: accepted above, damped more below, damped less above.
const GAIN: (f64, f64, f64) = (0.1, 0.3, 0.7);
/// Growth of the merit that is nothing.
const NOTHING: f64 = 1e-3;
/// Steps whose gains tell what is to be had of others: where these gain nothing, whatever gaps are left stay.
const LAST: usize = 2;
/// Factors on the damping after good, poor and refused steps.
const DAMPING: (f64, f64, f64) = (0.25, 2.0, 6.0);
/// See [`DAMPING`]: less changes nothing, and takes trials to be left again.
const LEAST_DAMPING: f64 = 0.1;

/// Networks after a part of a step.
struct Attempt<'a> {
    fleet: Fleet<'a>,
    /// Largest distance and gap, in tolerances.
    reached: [f64; 2],
    /// Share of the gain that was expected.
    share: f64,
    part: f64,
}

impl<'a> Joint<'a> {
    /// Whether the largest distance remains too far away after so many more steps, each of which gains no more than the best of the
    /// last ones: the first steps gain the most.
    fn is_hopeless(&self, left: usize) -> bool {
        let reached: Vec<f64> = self.steps.iter().rev().take(LAST + 1).map(|s| s.reached[0]).collect();
        let best = reached.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        reached.len() > LAST && reached[0] - left as f64 * best > self.most
    }

    /// Steps as long as they make the networks better, and, where that is asked, as long as these may come near enough.
    pub(super) fn improve(&mut self, control: &Control, near_enough: bool) {
        let begun = !self.steps.is_empty();
        let (mut damping, mut reach, mut far, mut count, mut idle) = (1.0, 1.0, false, 0, 0);
        let most = |far: bool| if far { FAR_STEPS } else { STEPS };
        while count < most(far) && !control.stopped() {
            let now = &self.fleet;
            let at = now.measured();
            far |= count == FAR.1 && at[0] > FAR.0;
            let merit = |[distance, gap]: [f64; 2]| distance.max(LOW_ENOUGH) + GAP.1 * gap.max(GAP.0);
            let is_settled = begun || count >= SETTLED.2 || at[1] <= MET;
            if is_settled && at[0] < SETTLED.0 && at[1] < SETTLED.1 {
                break;
            }
            let columns = now.columns();
            let weight = WEIGHTS[self.steps.len().min(WEIGHTS.len() - 1)];
            let attempt = |found: &Step, part: f64| -> Option<Attempt<'a>> {
                let x: Vec<f64> = found.x.iter().map(|x| part * x).collect();
                let fleet = now.stepped(&columns, &x)?;
                let reached = fleet.measured();
                let hoped = part * (merit(at) - merit(found.expected));
                let share = (merit(at) - merit(reached)) / hoped.max(f64::MIN_POSITIVE);
                Some(Attempt { fleet, reached, share, part })
            };
            let (mut effort, mut refused, mut accepted) = ([0, 0], Vec::new(), None);
            while accepted.is_none() && refused.len() < TRIALS {
                let Some(found) = step(now, &columns, &Prices { gaps: weight, damping, reach }) else { return };
                effort = [effort[0] + 1, effort[1] + found.iterations];
                // Farther away a step may lead to more than it expects, since samples change sides.
                if is_settled && at[0] < 1.0 && at[1] < SETTLED.1 && merit(at) - merit(found.expected) < STALLED.0 {
                    return;
                }
                // Where feet would be lost a part of the step is as good as can be had: what it keeps is linear in it.
                let first = PARTS.iter().find_map(|&part| attempt(&found, part));
                accepted = first.filter(|a| a.share > GAIN.0 || merit(a.reached) < merit(at) + NOTHING);
                match &accepted {
                    Some(a) if a.share > GAIN.2 && a.part == 1.0 => {
                        // Where less was refused just now, it would be the next time.
                        if refused.is_empty() {
                            damping = (damping * DAMPING.0).max(LEAST_DAMPING);
                        }
                        if far {
                            reach = (reach * SLIDES.1).min(SLIDES.2);
                        }
                    }
                    Some(a) if a.share < GAIN.1 => damping *= DAMPING.1,
                    Some(_) => {}
                    None => {
                        refused.push(found);
                        damping *= DAMPING.2;
                        reach = (reach * SLIDES.0).max(1.0);
                    }
                }
            }
            if accepted.is_none() {
                // Whole steps go too far, however much they are damped: a part of one goes the same way.
                let parts = PARTS[1..].iter().flat_map(|&part| refused.iter().rev().map(move |found| (found, part)));
                accepted = parts.filter_map(|(found, part)| attempt(found, part)).find(|a| a.share > GAIN.0);
                damping = 1.0;
            }
            let Some(Attempt { mut fleet, reached, .. }) = accepted else { return };
            let gained = merit(at) - merit(reached);
            let is_part = refused.len() == TRIALS;
            fleet.settle();
            self.fleet = fleet;
            self.steps.push(StepReport { reached, effort });
            count += 1;
            if near_enough && self.is_hopeless(most(far) - count) {
                return;
            }
            let stalled = if reached[0] < 1.0 { STALLED.0 } else { STALLED.0 * STALLED.1 };
            idle = if gained < stalled { idle + 1 } else { 0 };
            let is_near = (begun || count >= SETTLED.2) && reached[1] < SETTLED.1;
            if !is_part && idle > 0 && (is_near || idle == LAST) {
                return;
            }
        }
    }
}
